//! Growth beside brute force and beside kd-trees that are rebuilt in every iteration: `kd-tree` is
//! kiddo's, built at once and the fastest to ask, `by points` its other one, to which nodes are added one
//! by one, as is common.
//!
//! `cargo bench -p linden-tests --bench growth` fills the table in about a minute and a half; `-- --quick`
//! leaves out all above 10 000 points, `-- --large` adds ten million and the kd-trees at a million,
//! `-- --only N` leaves out all but N points.
//!
//! Points are uniform in the unit ball, the root is its centre, the step half the mean spacing of the
//! points, the kill distance two steps. Each time is the median of several runs. With one thread it
//! is CPU time where the system tells it (Linux), so that a busy machine does not count; with two it
//! is time on the wall, and `x 1` compares it with one thread's on the wall, run in turn. Of the two
//! peers only the search for nearest nodes is timed, not their other bookkeeping.

#![allow(clippy::print_stdout, reason = "a table on standard output is what this program is for")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot run has nothing better to do than to stop")]

#[path = "../colonization/naive.rs"]
mod naive;
mod timing;

use std::cell::Cell;

use kiddo::{ImmutableKdTree, MutableKdTree, SquaredEuclidean};
use linden::growth::{GrowthHabit, GrowthRule, grow};
use linden::random::Key;
use linden::{Branching, NO_PARENT, Quiet, Vec3};
use multiversion::multiversion;
use peak_alloc::PeakAlloc;
use rayon::ThreadPool;
use timing::{Timed, median, timed};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

thread_local! {
    /// CPU seconds that a peer spent on searching.
    static SEARCHING: Cell<f64> = const { Cell::new(0.0) };
}

struct Setting {
    points: usize,
    /// In steps.
    influence: f32,
    runs: usize,
    brute_force: bool,
    kd_tree: bool,
}

fn main() {
    let asked = |flag: &str| std::env::args().any(|arg| arg == flag);
    let setting = |points, influence, runs, brute_force, kd_tree| Setting {
        points,
        influence,
        runs,
        brute_force,
        kd_tree,
    };
    let mut settings = vec![setting(10_000, 8.0, 15, true, true), setting(10_000, 20.0, 15, true, true)];
    if !asked("--quick") {
        settings.extend([
            setting(100_000, 8.0, 7, false, true),
            setting(100_000, 20.0, 7, false, true),
            setting(100_000, f32::INFINITY, 7, false, false),
            // The peer needs minutes for each of these.
            setting(1_000_000, 8.0, 5, false, asked("--large")),
            setting(1_000_000, 20.0, 3, false, asked("--large")),
        ]);
    }
    if asked("--large") {
        settings.push(setting(10_000_000, 8.0, 1, false, false));
    }
    println!(
        "{:>9} {:>4} {:>8} {:>5} | {:>8} {:>8} {:>4} {:>7} {:>7} | {:^14} | {:^14} | {:^14} | {:^14}",
        "points",
        "di/D",
        "nodes",
        "iter.",
        "1 thread",
        "2",
        "x 1",
        "ns/node",
        "B/point",
        "each pair",
        "by eights",
        "kd-tree",
        "by points"
    );
    let only: Option<usize> =
        std::env::args().skip_while(|arg| arg != "--only").nth(1).map(|points| points.parse().unwrap());
    for setting in settings.iter().filter(|setting| only.is_none_or(|points| setting.points == points)) {
        row(setting);
    }
}

fn row(setting: &Setting) {
    let &Setting { points: n, influence, runs, .. } = setting;
    let points = ball(n);
    let step = 0.5 * libm::cbrtf(4.0 / 3.0 * std::f32::consts::PI / n as f32);
    let rule = GrowthRule {
        step,
        influence: influence * step,
        kill: 2.0 * step,
        tropism: Vec3::ZERO,
        max_iterations: u32::MAX,
        max_nodes: u32::MAX,
        habit: GrowthHabit::PLAIN,
    };
    let root = Branching {
        positions: vec![Vec3::ZERO],
        parents: vec![NO_PARENT],
        births: vec![0],
        radii: None,
        edges: None,
    };
    let [one, two] =
        [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let ours = |pool: &ThreadPool| pool.install(|| timed(|| grow(&points, &root, &rule, &Quiet).unwrap()));

    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let Timed { value: growth, .. } = ours(&one);
    let bytes = MEMORY.peak_usage() - before;
    let nodes = growth.branching.positions.len();
    let (mut cpu, mut wall, mut shared) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..runs {
        let alone = ours(&one);
        cpu.push(alone.cpu);
        wall.push(alone.wall);
        let both = ours(&two);
        shared.push(both.wall);
        assert_eq!(both.value, growth, "threads must not matter");
    }
    let (cpu, wall, shared) = (median(cpu), median(wall), median(shared));
    print!(
        "{n:>9} {influence:>4} {nodes:>8} {:>5} | {cpu:>8.4} {shared:>8.4} {:>4.2} {:>7.0} {:>7.1}",
        growth.iterations,
        wall / shared,
        cpu / nodes as f64 * 1e9,
        bytes as f64 / n as f64,
    );
    let peers: [(bool, naive::Nearest); 4] = [
        (setting.brute_force, each_pair),
        (setting.brute_force, by_eights),
        (setting.kd_tree, kd_tree),
        (setting.kd_tree, kd_tree_by_points),
    ];
    for (wanted, search) in peers {
        if wanted {
            SEARCHING.set(0.0);
            let grown = naive::grow(&points, &root, &rule, &[], search);
            // A kd-tree may break ties otherwise, and then a few nodes differ.
            assert!(grown.branching.positions.len().abs_diff(nodes) <= nodes / 100);
            print!(" | {:>8.3} {:>4.0}x", SEARCHING.get(), SEARCHING.get() / cpu);
        } else {
            print!(" | {:>14}", "-");
        }
    }
    println!();
}

fn ball(points: usize) -> Vec<Vec3> {
    let key = Key::new(1).named("ball");
    (0..)
        .map(|i| {
            let k = key.child(i);
            Vec3::from([0, 1, 2].map(|axis| k.child(axis).between(-1.0, 1.0) as f32))
        })
        .filter(|p| p.length_squared() <= 1.0)
        .take(points)
        .collect()
}

/// Brute force as the definition has it.
fn each_pair(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    searched(|| naive::each_pair(points, nodes))
}

/// Brute force as good as it gets.
fn by_eights(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    searched(|| points.chunks(8).flat_map(|eight| nearest_of_eight(eight, nodes)).collect())
}

/// Adds to [`SEARCHING`].
fn searched(search: impl FnOnce() -> Vec<(usize, f32)>) -> Vec<(usize, f32)> {
    let found = timed(search);
    SEARCHING.set(SEARCHING.get() + found.cpu);
    found.value
}

/// Eight points at a time, with AVX2 where there is any.
#[multiversion(targets("x86_64+avx2"))]
fn nearest_of_eight(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    let lanes =
        |axis: usize| -> [f32; 8] { std::array::from_fn(|lane| points[lane.min(points.len() - 1)][axis]) };
    let (xs, ys, zs) = (lanes(0), lanes(1), lanes(2));
    let (mut d2, mut nearest) = ([f32::INFINITY; 8], [0_u32; 8]);
    for (index, node) in nodes.iter().enumerate() {
        for lane in 0..8 {
            let (x, y, z) = (xs[lane] - node.x, ys[lane] - node.y, zs[lane] - node.z);
            let distance2 = x * x + y * y + z * z;
            let nearer = distance2 < d2[lane];
            d2[lane] = if nearer { distance2 } else { d2[lane] };
            nearest[lane] = if nearer { index as u32 } else { nearest[lane] };
        }
    }
    (0..points.len()).map(|lane| (nearest[lane] as usize, d2[lane])).collect()
}

/// A tree over the nodes, built for this iteration, and a query for each point.
fn kd_tree(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    searched(|| {
        let nodes: Vec<[f32; 3]> = nodes.iter().map(Vec3::to_array).collect();
        let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(&nodes).unwrap();
        points
            .iter()
            .map(|point| {
                let found = tree.query(&point.to_array()).nearest_one::<SquaredEuclidean<f32>>().execute();
                (found.item as usize, found.distance)
            })
            .collect()
    })
}

/// The same with a tree that is built by adding nodes.
fn kd_tree_by_points(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    searched(|| {
        let mut tree: MutableKdTree<f32, 3> = MutableKdTree::default();
        for (index, node) in nodes.iter().enumerate() {
            tree.add(&node.to_array(), index as u32).unwrap();
        }
        points
            .iter()
            .map(|point| {
                let found = tree.query(&point.to_array()).nearest_one::<SquaredEuclidean<f32>>().execute();
                (found.item as usize, found.distance)
            })
            .collect()
    })
}
