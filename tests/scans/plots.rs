//! Plots are scanned and their trees told apart again without the numbers that the scan has.
//!
//! The table of `docs/scans.md` (some minutes in release):
//!
//! ```sh
//! cargo test --release -p linden-tests --test scans plots -- --ignored --nocapture
//! ```

#![allow(clippy::print_stdout, reason = "the table is what the documentation quotes")]

use std::collections::BTreeMap;

use linden::Quiet;
use linden::forest::Forest;
use linden::glam::Vec3;
use linden::grow::grow;
use linden::input::Up;
use linden::preset::builtin;
use linden::scan::plot::{PlotRule, tell_apart};
use linden::scanner::{Scan, ScannerSettings, Target, WhatIsHit, scan};
use linden_tests::presets::recipe;

/// A plot of the table.
struct Plot {
    name: &'static str,
    purpose: &'static str,
    /// Presets, and how much larger they stand there than they grow.
    kinds: &'static [(&'static str, f64)],
    seed: u64,
    area_m: f64,
    spacing_m: f64,
    slope_deg: f64,
    stands: u32,
    step_deg: f64,
    leaves: bool,
}

/// Constants may be chosen by those for tuning; those for judging are of other species and seeds and are only looked at. (That
/// stems show in two slices was decided after the beeches in leaf had been seen.)
const PLOTS: [Plot; 8] = [
    Plot {
        name: "firs and round crowns",
        purpose: "tuning",
        kinds: &[("fir", 2.0), ("simple", 2.0)],
        seed: 1,
        area_m: 30.0,
        spacing_m: 4.0,
        slope_deg: 8.0,
        stands: 9,
        step_deg: 0.18,
        leaves: false,
    },
    Plot {
        name: "dense ashes",
        purpose: "tuning",
        kinds: &[("drawn-ash", 1.0)],
        seed: 2,
        area_m: 24.0,
        spacing_m: 3.0,
        slope_deg: 0.0,
        stands: 9,
        step_deg: 0.18,
        leaves: false,
    },
    Plot {
        name: "ashes and chestnuts in leaf",
        purpose: "tuning",
        kinds: &[("drawn-horse-chestnut", 1.0), ("drawn-ash", 1.0)],
        seed: 3,
        area_m: 32.0,
        spacing_m: 6.0,
        slope_deg: 15.0,
        stands: 9,
        step_deg: 0.18,
        leaves: true,
    },
    Plot {
        name: "cypresses and flames",
        purpose: "judging",
        kinds: &[("cypress", 1.5), ("flame", 2.0)],
        seed: 11,
        area_m: 30.0,
        spacing_m: 3.0,
        slope_deg: 5.0,
        stands: 9,
        step_deg: 0.18,
        leaves: false,
    },
    Plot {
        name: "spheres, one stand",
        purpose: "judging",
        kinds: &[("sphere", 2.0), ("cylinder", 2.0)],
        seed: 12,
        area_m: 24.0,
        spacing_m: 5.0,
        slope_deg: 0.0,
        stands: 1,
        step_deg: 0.09,
        leaves: false,
    },
    Plot {
        name: "birches",
        purpose: "judging",
        kinds: &[("silver-birch", 1.0)],
        seed: 13,
        area_m: 28.0,
        spacing_m: 4.0,
        slope_deg: 20.0,
        stands: 9,
        step_deg: 0.18,
        leaves: false,
    },
    Plot {
        name: "beeches in leaf",
        purpose: "judging",
        kinds: &[("drawn-beech", 1.0)],
        seed: 14,
        area_m: 28.0,
        spacing_m: 5.0,
        slope_deg: 10.0,
        stands: 9,
        step_deg: 0.18,
        leaves: true,
    },
    Plot {
        name: "apples and cypresses",
        purpose: "judging",
        kinds: &[("drawn-apple", 1.0), ("cypress", 1.0)],
        seed: 15,
        area_m: 30.0,
        spacing_m: 5.0,
        slope_deg: 3.0,
        stands: 9,
        step_deg: 0.18,
        leaves: false,
    },
];

/// Points with the numbers of their trees, and the feet of these.
fn scanned(plot: &Plot) -> (Scan, Vec<Vec3>) {
    let mut forest = Forest::of(plot.kinds.iter().map(|(name, _)| recipe(builtin(name).unwrap())).collect());
    for (kind, (_, size)) in forest.kinds.iter_mut().zip(plot.kinds) {
        kind.size = *size;
    }
    forest.layout.seed = plot.seed;
    forest.layout.area_m = plot.area_m;
    forest.layout.spacing_m = plot.spacing_m;
    forest.layout.distinct = 2;
    let plan = forest.plan(&Quiet).unwrap();
    let grown: Vec<_> = plan.trees.iter().map(|tree| grow(&tree.recipe, &Quiet).unwrap()).collect();
    let mut settings = ScannerSettings::default();
    settings.positions = plot.stands;
    settings.step_deg = plot.step_deg;
    settings.ground = true;
    settings.slope_deg = plot.slope_deg;
    settings.seed = plot.seed;
    let mut target = Target::default();
    for place in &plan.places {
        let mut tubes = plan.trees[place.plant].recipe.preset.dressing.tubes;
        tubes.sides = 12;
        target.add_at(&settings.on_slope(*place), &grown[place.plant], &tubes, plot.leaves, &Quiet).unwrap();
    }
    (scan(&target, &settings, &Quiet).unwrap(), target.feet().to_vec())
}

/// How well trees are told apart.
#[derive(Debug)]
struct Found {
    points: usize,
    /// Trees that were seen by as many points as a tree needs.
    trees: usize,
    /// Of these, those that share more than half of all points of both with a tree that was found.
    matched: usize,
    /// Trees that were found and match none.
    wrong: usize,
    /// Of the points on trees, those in the tree that matches theirs.
    right: f64,
    /// The same if each point went to the stem that is nearest, seen from above, of all true stems.
    by_nearest: f64,
    /// Ground that went to trees, of all ground.
    ground: f64,
}

/// A tree that fewer points lie on is not asked for.
const LEAST_POINTS: usize = 200;

fn found(scan: &Scan, feet: &[Vec3]) -> Found {
    let positions: Vec<_> = scan.points.iter().map(|point| point.position.as_dvec3()).collect();
    let column = tell_apart(&positions, &PlotRule { up: Up::Y, scale: None }, &Quiet).unwrap();
    assert_eq!(column.numbers.len(), scan.points.len());
    let mut shared: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    let (mut of_truth, mut of_found) = (BTreeMap::<u32, usize>::new(), BTreeMap::<u32, usize>::new());
    let (mut ground, mut ground_taken, mut by_nearest) = (0_usize, 0_usize, 0_usize);
    for (point, &number) in scan.points.iter().zip(&column.numbers) {
        let truth = scan.truth(point);
        if truth.what == WhatIsHit::Ground {
            ground += 1;
            ground_taken += usize::from(number != 0);
            continue;
        }
        *shared.entry((truth.tree, number)).or_default() += 1;
        *of_truth.entry(truth.tree).or_default() += 1;
        *of_found.entry(number).or_default() += 1;
        let off = |foot: &Vec3| {
            let off = *foot - point.position;
            off.x * off.x + off.z * off.z
        };
        let nearest = (1..).zip(feet).min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
        by_nearest += usize::from(nearest.is_some_and(|(number, _)| number == truth.tree));
    }
    of_found.remove(&0);
    let is_match = |&(&(truth, number), &both): &(&(u32, u32), &usize)| {
        number != 0 && 2 * both > of_truth[&truth] + of_found[&number] - both
    };
    let matches: Vec<_> = shared.iter().filter(is_match).collect();
    let right: usize = matches.iter().map(|(_, both)| **both).sum();
    let trees = of_truth.values().filter(|&&count| count >= LEAST_POINTS).count();
    let of_seen = |((truth, _), _): &&(&(u32, u32), &usize)| of_truth[truth] >= LEAST_POINTS;
    Found {
        points: scan.points.len(),
        trees,
        matched: matches.iter().filter(of_seen).count(),
        wrong: of_found.len() - matches.len(),
        right: right as f64 / of_truth.values().sum::<usize>() as f64,
        by_nearest: by_nearest as f64 / of_truth.values().sum::<usize>() as f64,
        ground: ground_taken as f64 / ground.max(1) as f64,
    }
}

#[test]
#[ignore = "minutes: prints the table of docs/scans.md"]
fn plots() {
    println!(
        "| plot | for | stands | step | slope | points | trees | found | wrong | points right | by the nearest stem | ground taken |"
    );
    println!("|{}", " --- |".repeat(12));
    for plot in &PLOTS {
        let Plot { name, purpose, slope_deg, stands, step_deg, .. } = plot;
        let (scan, feet) = scanned(plot);
        let Found { points, trees, matched, wrong, right, by_nearest, ground } = found(&scan, &feet);
        println!(
            "| {name} | {purpose} | {stands} | {step_deg}° | {slope_deg}° | {points} | {trees} | {matched} | {wrong} | {:.1} % | {:.1} % | {:.1} % |",
            1e2 * right,
            1e2 * by_nearest,
            1e2 * ground,
        );
    }
}

/// Within what a user can rely on; the table has the figures.
#[test]
fn trees_of_a_small_plot_are_told_apart() {
    let plot = Plot { area_m: 14.0, spacing_m: 5.0, stands: 4, step_deg: 0.3, seed: 5, ..PLOTS[0] };
    let (scan, feet) = scanned(&plot);
    let found = found(&scan, &feet);
    assert!(found.trees >= 5 && found.matched == found.trees && found.wrong == 0, "{found:?}");
    assert!(found.right > 0.8 && found.right > found.by_nearest && found.ground < 0.05, "{found:?}");
}

/// Nothing that is tuned by is judged by.
#[test]
fn tuning_and_judging_plots_share_no_species_and_no_seed() {
    let of = |purpose: &'static str| PLOTS.iter().filter(move |plot| plot.purpose == purpose);
    assert!(of("tuning").count() >= 3 && of("judging").count() >= 5);
    for (a, b) in of("tuning").flat_map(|a| of("judging").map(move |b| (a, b))) {
        assert!(
            a.seed != b.seed && a.kinds.iter().all(|kind| !b.kinds.iter().any(|other| other.0 == kind.0))
        );
    }
}
