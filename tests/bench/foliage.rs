//! Leaves beside what one writes first: `cargo bench -p linden-tests --bench foliage`.
//!
//! Growing places and poses leaves, baking makes triangles of them. Naive: a mesh of its own for every
//! leaf, its vertices turned by a matrix, appended to one that grows by pushing. All in turn on one
//! thread, round after round; medians of processor time where the system tells. The last column is the
//! whole way to a GLB, pictures of 256 pixels included.
//!
//! Meshes are as large as what a leaf costs in memory that was never touched: the system clears each page
//! of it first. Without that share (Linux, glibc):
//! `MALLOC_MMAP_THRESHOLD_=1000000000 MALLOC_TRIM_THRESHOLD_=4000000000 cargo bench …`

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints and stops at the first surprise"
)]

use std::time::Instant;

use glam::{Mat3, Vec3};
use linden::Quiet;
use linden::dress::dress;
use linden::foliage::{Organs, meshes};
use linden::grow::{grow, sprout};
use linden::preset::builtin;
use linden::scene::Mesh;
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;

const ROUNDS: usize = 9;

fn main() {
    println!("form     leaves   triangles   grow ns/leaf   bake M tri/s   naive M tri/s   GLB, s of CPU");
    for (form, per_m) in
        [("card", "150"), ("card", "900"), ("curved", "150"), ("curved", "900"), ("twig", "30")]
    {
        let mut recipe = recipe(builtin("sphere").unwrap());
        for (knob, value) in
            [("leaf_form", form), ("leaves_per_m", per_m), ("leaf_size", "256"), ("bark_size", "256")]
        {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let organs = &grown.organs;
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let median = |work: &dyn Fn()| {
            let mut times: Vec<f64> = (0..ROUNDS)
                .map(|_| {
                    let (started, on_cpu) = (Instant::now(), cpu_s());
                    work();
                    match (on_cpu, cpu_s()) {
                        (Some(before), Some(after)) => after - before,
                        _ => started.elapsed().as_secs_f64(),
                    }
                })
                .collect();
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2]
        };
        let sprouting = median(&|| {
            one.install(|| drop(sprout(&recipe, &grown.skeleton, &grown.given, &Quiet).unwrap()));
        });
        let baking = median(&|| one.install(|| drop(meshes(organs, 1, &Quiet).unwrap())));
        let first = median(&|| drop(naive(organs)));
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("tree.glb");
        let whole = median(&|| {
            one.install(|| {
                let scene = dress(&recipe, &grown, &Quiet).unwrap();
                export(&scene, "glb", &[], &target).unwrap();
            });
        });
        let triangles = organs.amount().1 as f64;
        println!(
            "{form:7} {:>7} {triangles:>11} {:>14.0} {:>14.1} {:>15.1} {whole:>15.2}",
            organs.len(),
            sprouting / organs.len() as f64 * 1e9,
            triangles / baking / 1e6,
            triangles / first / 1e6,
        );
    }
}

/// Seconds that all threads were on a processor, where the system tells (Linux).
fn cpu_s() -> Option<f64> {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    Some(sum / 1e9)
}

fn naive(organs: &Organs) -> Mesh {
    let mut all = Mesh::default();
    let placed = &organs.placed;
    for i in 0..placed.len() {
        let mesh = organs.mesh(i).clone();
        let (heading, up) = (placed.headings[i], placed.ups[i]);
        let turn = Mat3::from_cols(heading.cross(up), heading, up);
        let first = all.positions.len() as u32;
        for (&p, &n) in mesh.positions.iter().zip(&mesh.normals) {
            all.positions.push(placed.positions[i] + turn * p * placed.sizes_m[i]);
            all.normals.push((turn * n).normalize_or(Vec3::Y));
        }
        all.uvs.extend(&mesh.uvs);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}
