//! Trees in leaf are scanned, wood is told from leaves, and they come back as they do from scans of them bare.
//!
//! The table of `docs/scans.md` (some minutes in release):
//!
//! ```sh
//! cargo test --release -p linden-tests --test scans leaf_table -- --ignored --nocapture
//! ```

#![allow(clippy::print_stdout, reason = "the table is what the documentation quotes")]

use std::collections::BTreeSet;

use linden::Quiet;
use linden::glam::DVec3;
use linden::grow::{Grown, grow};
use linden::input::{Cloud, LeafColumn};
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scan::{LeafPoints, ScanRule, prepare};
use linden::scanner::sizes::TreeSizes;
use linden::scanner::{ScannerSettings, Target, WhatIsHit, scan};
use linden_tests::presets::recipe;

use crate::closed_loop::{Subject, Use, grown_back, median, percent, subject};

/// Those of the table. No species and no seed is in both halves.
const SUBJECTS: [Subject; 8] = [
    subject("drawn-apple", 3, Use::Tuning),
    subject("ash", 1, Use::Tuning),
    subject("horse-chestnut", 2, Use::Tuning),
    subject("beech", 21, Use::Judging),
    subject("silver-birch", 22, Use::Judging),
    subject("linden", 23, Use::Judging),
    subject("drawn-rowan", 24, Use::Judging),
    subject("norway-spruce", 25, Use::Judging),
];

/// For trees in leaf.
const BY_PATHS: ScanRule =
    ScanRule { step_m: None, noise_filter: true, stems: None, leaf_points: LeafPoints::Paths };

/// Points, and which of them lie on leaves.
struct Seen {
    points: Vec<DVec3>,
    is_leaf: Vec<bool>,
}

fn grown(subject: &Subject) -> (Recipe, Grown) {
    let mut recipe = recipe(builtin(subject.preset).unwrap());
    recipe.preset.set("seed", &subject.seed.to_string()).unwrap();
    let grown = grow(&recipe, &Quiet).unwrap();
    (recipe, grown)
}

fn seen((recipe, grown): &(Recipe, Grown), step_deg: f64, leaves: bool) -> Seen {
    let mut tubes = recipe.preset.dressing.tubes;
    tubes.sides = 32;
    tubes.features.twig_taper = 0.0;
    tubes.width_smoothing = 0.0;
    let mut target = Target::default();
    target.add(grown, &tubes, leaves, &Quiet).unwrap();
    let mut settings = ScannerSettings::default();
    settings.step_deg = step_deg;
    let scan = scan(&target, &settings, &Quiet).unwrap();
    let is_leaf = scan.points.iter().map(|point| scan.truth(point).what == WhatIsHit::Leaf).collect();
    Seen { points: scan.points.iter().map(|point| point.position.as_dvec3()).collect(), is_leaf }
}

/// How well wood is told from leaves, as shares.
#[derive(Debug)]
struct Told {
    /// Of all points.
    right: f64,
    /// Of those on wood, those that were taken for wood.
    wood: f64,
    /// The same of leaves.
    leaf: f64,
}

fn told(seen: &Seen, rule: &ScanRule) -> Told {
    let scan = prepare(&seen.points, rule, &Quiet).unwrap();
    // Bark stands in an order of its own.
    let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
    let bark: BTreeSet<[u64; 3]> = scan.bark.iter().map(bits).collect();
    // By what they are, leaf or not: all, and those that were told so.
    let mut counts = [[0_u32; 2]; 2];
    for (point, &is_leaf) in seen.points.iter().zip(&seen.is_leaf) {
        let is_bark = bark.contains(&bits(point));
        counts[usize::from(is_leaf)][0] += 1;
        counts[usize::from(is_leaf)][1] += u32::from(is_bark != is_leaf);
    }
    let share = |of: u32, all: u32| f64::from(of) / f64::from(all.max(1));
    let [[wood, wood_right], [leaf, leaf_right]] = counts;
    Told {
        right: share(wood_right + leaf_right, wood + leaf),
        wood: share(wood_right, wood),
        leaf: share(leaf_right, leaf),
    }
}

#[test]
#[ignore = "minutes: prints the table of docs/scans.md"]
fn leaf_table() {
    println!(
        "| tree | seed | for | points | on leaves | right | wood right | leaves right | DBH bare | in leaf | volume bare | in leaf | in leaf of bare | \
         length bare | in leaf | in leaf of bare |"
    );
    println!("|{}", " --- |".repeat(16));
    let chosen = std::env::var("LEAF_TREES").ok();
    let mut off = Vec::new();
    for subject in SUBJECTS.iter().filter(|s| chosen.as_ref().is_none_or(|c| c.contains(s.preset))) {
        let tree = grown(subject);
        let truth = TreeSizes::of(&tree.1.skeleton);
        let bare = grown_back(seen(&tree, 0.1, false).points, "auto");
        let in_leaf = seen(&tree, 0.1, true);
        let told = told(&in_leaf, &BY_PATHS);
        let leaves = in_leaf.is_leaf.iter().filter(|leaf| **leaf).count() as f64;
        let count = in_leaf.points.len();
        let back = grown_back(in_leaf.points, "paths");
        let cells = [
            subject.preset.to_owned(),
            subject.seed.to_string(),
            if subject.purpose == Use::Tuning { "tuning" } else { "judging" }.to_owned(),
            count.to_string(),
            format!("{:.0} %", 1e2 * leaves / count as f64),
            format!("{:.1} %", 1e2 * told.right),
            format!("{:.0} %", 1e2 * told.wood),
            format!("{:.0} %", 1e2 * told.leaf),
            percent(bare.dbh_m, truth.dbh_m),
            percent(back.dbh_m, truth.dbh_m),
            percent(bare.volume_m3(), truth.volume_m3()),
            percent(back.volume_m3(), truth.volume_m3()),
            percent(back.volume_m3(), bare.volume_m3()),
            percent(bare.length_m(), truth.length_m()),
            percent(back.length_m(), truth.length_m()),
            percent(back.length_m(), bare.length_m()),
        ];
        println!("| {} |", cells.join(" | "));
        if subject.purpose == Use::Judging {
            let volumes = [&bare, &back].map(|sizes| (sizes.volume_m3() / truth.volume_m3() - 1.0).abs());
            off.push((told.right, volumes, (back.volume_m3() / bare.volume_m3() - 1.0).abs()));
        }
    }
    if !off.is_empty() {
        println!(
            "median of judging, either way: right {:.1} %, volume bare {:.1} %, in leaf {:.1} %, in leaf of bare {:.1} %",
            1e2 * median(off.iter().map(|row| row.0).collect()),
            1e2 * median(off.iter().map(|row| row.1[0]).collect()),
            1e2 * median(off.iter().map(|row| row.1[1]).collect()),
            1e2 * median(off.iter().map(|row| row.2).collect())
        );
    }
}

/// Within what a user can rely on; the table has the figures.
#[test]
fn a_small_tree_in_leaf_comes_back() {
    let tree = grown(&subject("drawn-apple", 3, Use::Tuning));
    let truth = TreeSizes::of(&tree.1.skeleton);
    let (bare, in_leaf) = (seen(&tree, 0.3, false), seen(&tree, 0.3, true));
    let on_leaves = in_leaf.is_leaf.iter().filter(|leaf| **leaf).count();
    assert!(2 * on_leaves > in_leaf.points.len());
    // Unasked nothing is taken for a leaf; asked most points are told right, on either kind.
    let of_bare = prepare(&bare.points, &ScanRule::default(), &Quiet).unwrap();
    assert_eq!(of_bare.report.leaf_points, 0);
    let found = told(&in_leaf, &BY_PATHS);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let of_threads = [pool.install(rayon::current_num_threads), rayon::current_num_threads()];
    let on_one = pool.install(|| prepare(&in_leaf.points, &BY_PATHS, &Quiet).unwrap());
    assert_eq!(on_one, prepare(&in_leaf.points, &BY_PATHS, &Quiet).unwrap(), "{of_threads:?}");
    assert!(found.right > 0.8 && found.wood > 0.45 && found.leaf > 0.8, "{found:?}");
    assert!(told(&in_leaf, &ScanRule::default()).leaf < 0.05);
    let within = |back: f64, of: f64, part: f64| (back / of - 1.0).abs() < part;
    let (bare, back) = (grown_back(bare.points, "auto"), grown_back(in_leaf.points.clone(), "paths"));
    let volumes = [truth, bare, back].map(|sizes| sizes.volume_m3());
    assert!(within(volumes[2], volumes[1], 0.15) && within(volumes[2], volumes[0], 0.25), "{volumes:?}");
    assert!(within(back.dbh_m, truth.dbh_m, 0.1) && within(back.length_m(), bare.length_m(), 0.3));
    // What the file says of its points counts before what is found.
    let column = LeafColumn { name: "part".to_owned(), is_leaf: in_leaf.is_leaf };
    let cloud = Cloud { leaves: Some(column), ..Cloud::from(in_leaf.points) };
    let by_column = grown_back(cloud, "auto");
    assert!(by_column != back && within(by_column.volume_m3(), volumes[0], 0.25), "{by_column:?}");
}

/// Nothing that is tuned by is judged by.
#[test]
fn tuning_and_judging_trees_in_leaf_share_no_species_and_no_seed() {
    let of = |purpose: Use| SUBJECTS.iter().filter(move |subject| subject.purpose == purpose);
    for (a, b) in of(Use::Tuning).flat_map(|a| of(Use::Judging).map(move |b| (a, b))) {
        assert!(a.preset != b.preset && a.seed != b.seed, "{} {}", a.preset, b.preset);
    }
}
