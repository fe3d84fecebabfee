//! A scan of a million points: `cargo bench -p linden-tests --bench scan`.
//!
//! Points lie on the bark of the dome's tree, with an error of 3 mm. Medians on the wall, with one thread and with two.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints and stops at the first surprise"
)]

use std::sync::Arc;
use std::time::Instant;

use linden::grow::grow;
use linden::input::Up;
use linden::preset::{Preset, builtin};
use linden::random::Key;
use linden::recipe::{Geometry, Input, Recipe};
use linden::scan::{ScanRule, gaps, prepare};
use linden::surface::sweep;
use linden::{DVec3, Quiet, Vec3};
use linden_tests::presets::recipe;

const ROUNDS: usize = 5;
const POINTS: f64 = 1e6;

/// Uniform by area.
fn scan() -> Vec<DVec3> {
    let recipe = recipe(builtin("simple").unwrap());
    let mesh =
        sweep(&grow(&recipe, &Quiet).unwrap().skeleton, &recipe.preset.dressing.tubes, &Quiet).unwrap();
    let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize].as_dvec3());
    let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
    let total: f64 = mesh.triangles.iter().map(|t| area(corners(t))).sum();
    let (mut points, mut owed) = (Vec::new(), 0.0);
    for (i, triangle) in (0..).zip(&mesh.triangles) {
        let [a, b, c] = corners(triangle);
        owed += POINTS * area([a, b, c]) / total;
        for k in 0..owed as u64 {
            let key = Key::new(1).child(i).child(k);
            let (u, v) = (key.child(0).unit(), key.child(1).unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let error = DVec3::from([2, 3, 4].map(|axis| key.child(axis).between(-5e-3, 5e-3)));
            points.push(a + (b - a) * u + (c - a) * v + error);
        }
        owed = owed.fract();
    }
    points
}

fn main() {
    let points = scan();
    let placed: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    let mut preset = Preset::of("scan", linden::preset::ScanSettings::of("scan.ply".to_owned()));
    preset.set("origin", "keep").unwrap();
    let geometry = Geometry::Points(Arc::new(points.clone().into()));
    let input = Input { hash: 0, up: Up::Y, geometry };
    let recipe = Recipe::with_files(preset, [("scan.ply", input)].into_iter().collect());
    let grown = grow(&recipe, &Quiet).unwrap();
    println!("{} points, {} nodes; seconds", points.len(), grown.skeleton.positions.len());
    println!("threads   prepare   distances   all of grow");
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let median = |work: &(dyn Fn() + Sync)| {
            let mut times: Vec<f64> = (0..ROUNDS)
                .map(|_| {
                    let started = Instant::now();
                    pool.install(work);
                    started.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2]
        };
        let prepared = median(&|| {
            prepare(&points, &ScanRule::default(), &Quiet).unwrap();
        });
        let measured = median(&|| {
            gaps(&placed, &grown.skeleton, &Quiet).unwrap();
        });
        let all = median(&|| {
            grow(&recipe, &Quiet).unwrap();
        });
        println!("{threads:7} {prepared:9.2} {measured:11.2} {all:13.2}");
    }
}
