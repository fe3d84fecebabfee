//! Trees that compete for light beside two plain ways to know the light: each node with each other one in every year,
//! and pyramids of shade that are added voxel by voxel to a hash map.
//!
//! `cargo bench -p linden-tests --bench light` fills the table in half a minute. Both baselines get the nodes that
//! stand in the end, in the years in which they grew; linden has grown and shed two to four times as many, and has
//! shared, bent and turned them besides. Times are CPU time of one thread where the system tells it (Linux), medians.

#![allow(clippy::print_stdout, reason = "a table on standard output is what this program is for")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot run has nothing better to do than to stop")]

mod timing;

use std::collections::HashMap;
use std::hint::black_box;

use linden::random::Key;
use linden::self_organizing::{Grown, SelfOrganizing, grow_stand};
use linden::{Quiet, Vec3};
use peak_alloc::PeakAlloc;
use rayon::ThreadPool;
use timing::{median, timed};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Births in a year, as [`Grown::branching`] has them.
const PARTS: u32 = 16;

struct Setting {
    name: &'static str,
    years: u32,
    depth: u32,
    /// Trees on a side of the square.
    side: u16,
    runs: usize,
    is_small: bool,
}

fn main() {
    let setting =
        |name, years, depth, side, runs, is_small| Setting { name, years, depth, side, runs, is_small };
    println!(
        "{:14} {:>9} {:>9} | {:>8} {:>6} {:>10} {:>9} | {:^14} | {:^16}",
        "trees", "grown", "standing", "1 thread", "x 2", "grown/s", "B/node", "each pair", "hash of voxels"
    );
    for setting in [
        setting("one, 20 years", 20, 6, 1, 15, true),
        setting("one, 32 years", 32, 6, 1, 9, false),
        setting("49, depth 4", 32, 4, 7, 3, false),
        setting("49, depth 6", 32, 6, 7, 3, false),
    ] {
        row(&setting);
    }
}

fn row(setting: &Setting) {
    let mut settings = SelfOrganizing::default();
    (settings.years, settings.shade_depth) = (setting.years, setting.depth);
    let feet: Vec<Vec3> = (0..setting.side)
        .flat_map(|x| (0..setting.side).map(move |z| 3.0 * Vec3::new(x.into(), 0.0, z.into())))
        .collect();
    let [one, two] =
        [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let ours = |pool: &ThreadPool| {
        pool.install(|| timed(|| grow_stand(&settings, &feet, Key::new(7), &Quiet).unwrap()))
    };
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let grown = ours(&one).value;
    let bytes = MEMORY.peak_usage() - before;
    let (mut cpu, mut wall, mut shared) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..setting.runs {
        let alone = ours(&one);
        cpu.push(alone.cpu);
        wall.push(alone.wall);
        let both = ours(&two);
        shared.push(both.wall);
        assert_eq!(both.value.branching, grown.branching, "threads must not matter");
    }
    let (cpu, wall, shared) = (median(cpu), median(wall), median(shared));
    let standing = grown.branching.positions.len();
    print!(
        "{:14} {:>9} {standing:>9} | {cpu:>8.3} {:>6.2} {:>10.0} {:>9.0}",
        setting.name,
        grown.ever(),
        wall / shared,
        grown.ever() as f64 / cpu,
        bytes as f64 / standing as f64,
    );
    let years = years(&grown, &settings);
    let pairs = setting.is_small.then(|| timed(|| each_pair(&years, &settings)));
    let hashed = timed(|| hash_of_voxels(&years, &settings));
    match pairs {
        Some(pairs) => {
            let (a, b) = (pairs.value, hashed.value);
            assert!((a - b).abs() < 1e-3 * a.abs(), "the same light: {a} {b}");
            print!(" | {:>8.3} {:>4.0}x", pairs.cpu, pairs.cpu / cpu);
        }
        None => print!(" | {:>14}", "-"),
    }
    println!(" | {:>10.3} {:>4.1}x", hashed.cpu, hashed.cpu / cpu);
}

type Voxel = [i32; 3];

/// The voxels of the nodes that grew in each year.
fn years(grown: &Grown, settings: &SelfOrganizing) -> Vec<Vec<Voxel>> {
    let mut years = vec![Vec::new(); settings.years as usize + 1];
    for (place, birth) in grown.branching.positions.iter().zip(&grown.branching.births) {
        let voxel = (*place / settings.internode_m as f32).floor().as_ivec3().to_array();
        years[((birth / PARTS) as usize).min(settings.years as usize)].push(voxel);
    }
    years
}

/// Shade of a layer of a pyramid.
fn layer(settings: &SelfOrganizing, below: u32) -> f64 {
    settings.shade / libm::pow(settings.shade_falloff, below.into())
}

/// The shade of all nodes in all years, summed: each node with each other one.
fn each_pair(years: &[Vec<Voxel>], settings: &SelfOrganizing) -> f64 {
    let mut standing: Vec<Voxel> = Vec::new();
    let mut sum = 0.0;
    for new in years {
        standing.extend(new);
        for &[x, y, z] in &standing {
            for &[above_x, above_y, above_z] in &standing {
                let below = above_y - y;
                let reaches = (0..=settings.shade_depth as i32).contains(&below);
                if reaches && (above_x - x).abs() <= below && (above_z - z).abs() <= below {
                    sum += layer(settings, below as u32);
                }
            }
        }
    }
    sum
}

/// The same from pyramids that are added to a hash map when a node grows.
fn hash_of_voxels(years: &[Vec<Voxel>], settings: &SelfOrganizing) -> f64 {
    let mut shade: HashMap<Voxel, f64> = HashMap::new();
    let mut standing: Vec<Voxel> = Vec::new();
    let mut sum = 0.0;
    for new in years {
        for &[x, y, z] in new {
            for below in 0..=settings.shade_depth as i32 {
                let shaded = layer(settings, below as u32);
                for x in x - below..=x + below {
                    for z in z - below..=z + below {
                        *shade.entry([x, y - below, z]).or_default() += shaded;
                    }
                }
            }
        }
        standing.extend(new);
        sum += standing.iter().map(|voxel| shade.get(voxel).copied().unwrap_or_default()).sum::<f64>();
    }
    black_box(sum)
}
