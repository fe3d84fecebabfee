//! Axes, radii and refinement of a large branching, in nanoseconds a node:
//! `cargo bench -p linden-tests --bench skeleton`.
//!
//! The first row copies the branching, which every other row does too: what is over is the work.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints and stops at the first surprise"
)]

use std::hint::black_box;
use std::time::Instant;

use linden::lsystem::{self, TurtleSettings};
use linden::preset::{LSystem, builtin};
use linden::skeleton::refine::{Refinement, Room, STEPS, refine};
use linden::skeleton::{Width, Wood};
use linden::{Branching, Quiet, Skeleton};

const ROUNDS: usize = 7;

fn main() {
    let preset = builtin("abop-a").unwrap().load().unwrap();
    let Some(lsystem_settings) = preset.settings::<LSystem>() else { return };
    // 5^8 segments.
    let settings = TurtleSettings { derivations: 8, ..TurtleSettings::default() };
    let all = lsystem::grow(&lsystem_settings.grammar, &settings, &Quiet).unwrap().branching;
    let nodes = all.parents.len();
    println!("abop-a at n = 8, {nodes} nodes, ns a node");
    let row = |name: &str, work: &dyn Fn(Branching)| {
        let mut times: Vec<f64> = (0..ROUNDS)
            .map(|_| {
                let started = Instant::now();
                work(all.clone());
                started.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!("{name:24} {:>8.1}", times[ROUNDS / 2] / nodes as f64 * 1e9);
    };
    row("copy", &|all| {
        black_box(all);
    });
    for (name, wood) in [
        ("build, pipe", Wood::default()),
        ("build, pipe by angle", Wood { angle_share: 0.5, ..Wood::default() }),
        ("build, order", Wood { width: Width::Order, ..Wood::default() }),
        ("build, taper", Wood { width: Width::Taper, ..Wood::default() }),
    ] {
        row(name, &|all| {
            black_box(Skeleton::build(all, &wood).unwrap());
        });
    }
    for step in STEPS {
        let rule = Refinement { steps: vec![step], ..Refinement::default() };
        row(step.name, &|all| {
            black_box(refine(all, None, &mut [], &rule, Room::open(u64::MAX), &Quiet).unwrap());
        });
    }
}
