//! The tube sweep beside what one writes first: `cargo bench -p linden-tests --bench surface`.
//!
//! Naive: a cylinder for every segment, each with rings of its own, sines and cosines anew for every
//! vertex, a mesh that grows by pushing. Both run in turn on one thread, round after round; medians.
//! The naive surface has neither joined rings nor closed ends, so it has less to do for a vertex.
//!
//! Then what collars and flares cost, for a vertex of theirs; and one solid, for a triangle. At last whether all tubes
//! are closed: tube by tube, beside the whole mesh with all its edges, for a triangle.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints and stops at the first surprise"
)]

use std::f32::consts::TAU;
use std::time::Instant;

use glam::{Vec2, Vec3};
use linden::grow::grow;
use linden::preset::builtin;
use linden::scene::Mesh;
use linden::surface::{Features, Junction, Tubes, survey, sweep, topology};
use linden::{NO_PARENT, Quiet, Skeleton};
use linden_tests::presets::recipe;

const ROUNDS: usize = 15;

fn main() {
    let trees = [("sphere", "points", "2000"), ("sphere", "points", "60000"), ("abop-a", "derivations", "7")];
    println!("tree                     nodes   vertices   ours ns/vertex   2 threads   naive ns/vertex");
    for (id, knob, value) in trees {
        let mut recipe = recipe(builtin(id).unwrap());
        recipe.preset.set(knob, value).unwrap();
        let skeleton = grow(&recipe, &Quiet).unwrap().skeleton;
        let tubes = Tubes::default();
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut times = [const { Vec::new() }; 3];
        let (mut ours, mut theirs) = (0, 0);
        for _ in 0..ROUNDS {
            let started = Instant::now();
            ours = one.install(|| sweep(&skeleton, &tubes, &Quiet).unwrap()).positions.len();
            times[0].push(started.elapsed().as_secs_f64());
            let started = Instant::now();
            two.install(|| sweep(&skeleton, &tubes, &Quiet).unwrap());
            times[1].push(started.elapsed().as_secs_f64());
            let started = Instant::now();
            theirs = naive(&skeleton).positions.len();
            times[2].push(started.elapsed().as_secs_f64());
        }
        let per_vertex = |times: &mut Vec<f64>, vertices: usize| {
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2] / vertices as f64 * 1e9
        };
        let [a, b, c] = &mut times;
        println!(
            "{:22} {:>7} {ours:>10} {:>16.1} {:>11.1} {:>17.1}",
            format!("{id} {knob}={value}"),
            skeleton.positions.len(),
            per_vertex(a, ours),
            per_vertex(b, ours),
            per_vertex(c, theirs)
        );
    }
    features();
    checks();
}

/// Both sweep the tubes; the survey gives the volumes of their stretches, too.
fn checks() {
    println!("\nclosed?                  triangles   survey ns/triangle   whole mesh ns/triangle");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (id, knob, value) in [("abop-a", "derivations", "7"), ("sphere", "points", "20000")] {
        let mut recipe = recipe(builtin(id).unwrap());
        recipe.preset.set(knob, value).unwrap();
        let skeleton = grow(&recipe, &Quiet).unwrap().skeleton;
        let tubes = Tubes::default();
        let mut times = [const { Vec::new() }; 2];
        let mut triangles = 0;
        for _ in 0..ROUNDS {
            let started = Instant::now();
            let found = one.install(|| survey(&skeleton, &tubes, &mut |_| (), &Quiet).unwrap());
            times[0].push(started.elapsed().as_secs_f64());
            let started = Instant::now();
            let whole = one.install(|| topology(&sweep(&skeleton, &tubes, &Quiet).unwrap(), &Quiet).unwrap());
            times[1].push(started.elapsed().as_secs_f64());
            assert_eq!(found.topology, whole);
            triangles = found.triangles;
        }
        let [ours, whole] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2] / triangles as f64 * 1e9
        });
        println!("{:22} {triangles:>11} {ours:>20.1} {whole:>24.1}", format!("{id} {knob}={value}"));
    }
}

fn features() {
    let mut recipe = recipe(builtin("sphere").unwrap());
    recipe.preset.set("points", "8000").unwrap();
    let skeleton = grow(&recipe, &Quiet).unwrap().skeleton;
    let bare = Tubes::default();
    let collar = Features { collar: 0.6, ..Features::default() };
    let flare = Features { flare: 0.9, flare_ridges: 6, ..Features::default() };
    let solid = Tubes { junction: Junction::Watertight, junction_detail: 32, ..bare };
    let ways = [
        ("bare", bare),
        ("flare", Tubes { features: flare, ..bare }),
        ("collar", Tubes { features: collar, ..bare }),
        ("both", Tubes { features: Features { collar: 0.6, ..flare }, ..bare }),
        ("solid", solid),
        ("solid, collar", Tubes { features: collar, ..solid }),
    ];
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut times = vec![Vec::new(); ways.len()];
    let mut sizes = vec![(0, 0); ways.len()];
    for _ in 0..ROUNDS {
        for (i, (_, tubes)) in ways.iter().enumerate() {
            let started = Instant::now();
            let mesh = one.install(|| sweep(&skeleton, tubes, &Quiet).unwrap());
            times[i].push(started.elapsed().as_secs_f64());
            sizes[i] = (mesh.positions.len(), mesh.triangles.len());
        }
    }
    println!("\nsphere points=8000        vertices  triangles    ms   ns/vertex   ns/triangle");
    for (i, (name, _)) in ways.iter().enumerate() {
        times[i].sort_by(f64::total_cmp);
        let seconds = times[i][ROUNDS / 2];
        let (vertices, triangles) = sizes[i];
        println!(
            "{name:22} {vertices:>11} {triangles:>10} {:>5.0} {:>11.1} {:>13.1}",
            seconds * 1e3,
            seconds / vertices as f64 * 1e9,
            seconds / triangles as f64 * 1e9
        );
    }
}

#[expect(clippy::disallowed_methods, reason = "the naive way")]
fn naive(skeleton: &Skeleton) -> Mesh {
    const SIDES: u32 = 8;
    let mut mesh = Mesh::default();
    for (node, &parent) in skeleton.parents.iter().enumerate() {
        if parent == NO_PARENT {
            continue;
        }
        let (from, to) = (skeleton.positions[parent as usize], skeleton.positions[node]);
        let axis = (to - from).normalize_or(Vec3::Y);
        let side = axis.any_orthonormal_vector();
        let first = mesh.positions.len() as u32;
        for (end, at, radius) in
            [(0.0, from, skeleton.radii[parent as usize]), (1.0, to, skeleton.radii[node])]
        {
            for k in 0..=SIDES {
                let angle = TAU * k as f32 / SIDES as f32;
                let out = side * angle.cos() + axis.cross(side) * angle.sin();
                mesh.positions.push(at + out * radius);
                mesh.normals.push(out);
                mesh.uvs.push(Vec2::new(k as f32 / SIDES as f32, end));
            }
        }
        for k in 0..SIDES {
            let (a, b) = (first + k, first + SIDES + 1 + k);
            mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    mesh
}
