//! Pictures, drafts beside full ones: `cargo bench -p linden-tests --bench picture`.
//!
//! All ways of drawing run in turn, round after round; medians. `draft` and `full` draw the skeleton,
//! `surface` and `surface draft` the triangles, all on one thread; `full x 2` has two threads. What
//! the workbench promises: a draft of 100 000 nodes at 128 × 144 pixels within 15 ms on one core.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints and stops at the first surprise"
)]

use std::time::Instant;

use linden::Quiet;
use linden::dress::dress;
use linden::grow::grow;
use linden::preset::builtin;
use linden_raster::{Camera, Size, Style, Surface, draw_skeleton, draw_surface};
use linden_tests::presets::recipe;

const SIZES: [(u32, u32); 3] = [(64, 72), (128, 144), (400, 480)];
const TREES: [(&str, &str, &str); 6] = [
    ("fir", "points", "auto"),
    ("heart", "points", "auto"),
    ("abop-e", "derivations", "auto"),
    ("sphere", "points", "20000"),
    ("sphere", "points", "60000"),
    ("abop-e", "derivations", "10"),
];

fn main() {
    // `cargo test --benches` only wants to know whether it runs.
    let is_bench = std::env::args().any(|arg| arg == "--bench");
    let (rounds, trees) = if is_bench { (15, &TREES[..]) } else { (1, &TREES[..1]) };
    println!(
        "{:24} {:>7} {:>9}  {:>7} {:>9} {:>9} {:>9} {:>9} {:>13}",
        "tree", "nodes", "triangles", "pixels", "draft ms", "full ms", "full x 2", "surface", "surface draft"
    );
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, two) = (pool(1), pool(2));
    for &(id, knob, value) in trees {
        let mut recipe = recipe(builtin(id).unwrap());
        if value != "auto" {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        let surface = Surface::from(&scene);
        let triangles: usize = scene.parts.iter().map(|part| part.mesh.triangles.len()).sum();
        for (width, height) in SIZES {
            let size = Size::new(width, height).unwrap();
            let full = Style::over_dark();
            let draft = Style { draft: true, ..full };
            let camera = Camera::default();
            let skeleton = |style: &Style| {
                draw_skeleton(&grown.skeleton, &camera, style, size, &Quiet).unwrap();
            };
            let shaded = |style: &Style| {
                draw_surface(&surface, &camera, style, size, &Quiet).unwrap();
            };
            let ways: [&dyn Fn(); 5] = [
                &|| one.install(|| skeleton(&draft)),
                &|| one.install(|| skeleton(&full)),
                &|| two.install(|| skeleton(&full)),
                &|| one.install(|| shaded(&full)),
                &|| one.install(|| shaded(&draft)),
            ];
            let mut times = ways.map(|_| Vec::with_capacity(rounds));
            for _ in 0..rounds {
                for (way, times) in ways.iter().zip(&mut times) {
                    let started = Instant::now();
                    way();
                    times.push(started.elapsed().as_secs_f64() * 1e3);
                }
            }
            let [a, b, c, d, e] = times.map(|mut times| {
                times.sort_by(f64::total_cmp);
                times[rounds / 2]
            });
            println!(
                "{:24} {:>7} {triangles:>9}  {width:>3}x{height:<3} {a:>9.1} {b:>9.1} {c:>9.1} {d:>9.1} {e:>13.1}",
                if value == "auto" { id.to_owned() } else { format!("{id} {knob}={value}") },
                grown.skeleton.positions.len(),
            );
        }
    }
}
