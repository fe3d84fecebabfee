//! Trees that linden grew are scanned, grown back from their scans, and compared with what they were.
//!
//! The large table, as `docs/scans.md` has it (some minutes in release):
//!
//! ```sh
//! cargo test --release -p linden-tests --test scans table -- --ignored --nocapture
//! ```

#![allow(clippy::print_stdout, reason = "the table is what the documentation quotes")]

use std::sync::Arc;

use linden::Quiet;
use linden::grow::grow;
use linden::input::{Cloud, Up};
use linden::preset::{Preset, ScanSettings, builtin};
use linden::recipe::{Geometry, Input, Recipe};
use linden::scanner::sizes::{CLASS_NAMES, TreeSizes};
use linden::scanner::{ScannerSettings, Target, scan};
use linden_tests::presets::recipe;

/// What a tree of the table is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Constants of the reconstruction may be chosen by it.
    Tuning,
    /// It is looked at and nothing else: other species, other seeds.
    Judging,
}

/// A tree of the table.
pub struct Subject {
    pub preset: &'static str,
    pub seed: u64,
    pub purpose: Use,
}

pub const fn subject(preset: &'static str, seed: u64, purpose: Use) -> Subject {
    Subject { preset, seed, purpose }
}

/// Those of the large table. No species and no seed is in both halves.
const SUBJECTS: [Subject; 10] = [
    subject("simple", 6, Use::Tuning),
    subject("fir", 5, Use::Tuning),
    subject("drawn-oak", 1, Use::Tuning),
    subject("drawn-ash", 2, Use::Tuning),
    subject("sphere", 11, Use::Judging),
    subject("cylinder", 12, Use::Judging),
    subject("flame", 13, Use::Judging),
    subject("abop-ternary-a", 14, Use::Judging),
    subject("drawn-apple", 15, Use::Judging),
    subject("cypress", 16, Use::Judging),
];

/// How a subject is scanned.
#[derive(Clone, Copy)]
struct Survey {
    positions: u32,
    distance: f64,
    step_deg: f64,
}

/// A row of the table.
struct Row {
    points: usize,
    truth: TreeSizes,
    back: TreeSizes,
}

fn row(subject: &Subject, survey: Survey) -> Row {
    let mut recipe = recipe(builtin(subject.preset).unwrap());
    recipe.preset.set("seed", &subject.seed.to_string()).unwrap();
    let grown = grow(&recipe, &Quiet).unwrap();
    let mut tubes = recipe.preset.dressing.tubes;
    tubes.sides = 64;
    tubes.features.twig_taper = 0.0;
    tubes.width_smoothing = 0.0;
    let mut target = Target::default();
    target.add(&grown, &tubes, false, &Quiet).unwrap();
    let mut settings = ScannerSettings::default();
    settings.positions = survey.positions;
    settings.distance = survey.distance;
    settings.step_deg = survey.step_deg;
    settings.seed = subject.seed;
    let scan = scan(&target, &settings, &Quiet).unwrap();
    let points: Vec<_> = scan.points.iter().map(|point| point.position.as_dvec3()).collect();
    Row { points: points.len(), truth: TreeSizes::of(&grown.skeleton), back: grown_back(points, "auto") }
}

/// What a scan grows back to.
pub fn grown_back(cloud: impl Into<Cloud>, leaf_points: &str) -> TreeSizes {
    let mut preset = Preset::of("scan", ScanSettings::of("scan.ply".to_owned()));
    preset.set("origin", "keep").unwrap();
    preset.set("leaf_points", leaf_points).unwrap();
    let input = Input { hash: 0, up: Up::Y, geometry: Geometry::Points(Arc::new(cloud.into())) };
    let back = Recipe::with_files(preset, [("scan.ply", input)].into_iter().collect());
    TreeSizes::of(&grow(&back, &Quiet).unwrap().skeleton)
}

/// How far off, in per cent; a dash where there was nothing.
pub fn percent(back: f64, truth: f64) -> String {
    if truth > 0.0 { format!("{:+.1}", 1e2 * (back / truth - 1.0)) } else { "–".to_owned() }
}

fn head() -> String {
    let mut classes = CLASS_NAMES.map(|name| name.replace('_', "–")).join(" | ");
    classes = format!(" {classes} |");
    format!(
        "| tree | seed | for | stands | distance | step | points | height | DBH | volume | length |{0}{0}\n|{1}\n",
        classes,
        "---|".repeat(11 + 2 * CLASS_NAMES.len())
    )
}

/// Errors of height, diameter, volume and length in per cent; then of length, then of volume by class of diameter.
fn line(subject: &Subject, survey: Survey, row: &Row) -> String {
    let Row { points, truth, back } = row;
    let mut cells = vec![
        subject.preset.to_owned(),
        subject.seed.to_string(),
        if subject.purpose == Use::Tuning { "tuning" } else { "judging" }.to_owned(),
        survey.positions.to_string(),
        survey.distance.to_string(),
        format!("{}°", survey.step_deg),
        points.to_string(),
        percent(back.height_m, truth.height_m),
        percent(back.dbh_m, truth.dbh_m),
        percent(back.volume_m3(), truth.volume_m3()),
        percent(back.length_m(), truth.length_m()),
    ];
    let classes = || back.classes.iter().zip(&truth.classes);
    cells.extend(classes().map(|(back, truth)| percent(back.length_m, truth.length_m)));
    cells.extend(classes().map(|(back, truth)| percent(back.volume_m3, truth.volume_m3)));
    format!("| {} |", cells.join(" | "))
}

/// Of an even number the mean of the two in the middle.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let (low, high) = ((values.len() - 1) / 2, values.len() / 2);
    f64::midpoint(values[low], values[high])
}

/// Within what a user can rely on; the table has the figures.
#[test]
fn small_trees_come_back() {
    let survey = Survey { positions: 4, distance: 1.2, step_deg: 0.15 };
    print!("{}", head());
    for subject in [subject("fir", 5, Use::Tuning), subject("flame", 13, Use::Judging)] {
        let row = row(&subject, survey);
        println!("{}", line(&subject, survey, &row));
        let within = |name: &str, back: f64, truth: f64, low: f64, high: f64| {
            let part = back / truth;
            assert!((low..=high).contains(&part), "{}: {name} {back} of {truth}", subject.preset);
        };
        let Row { truth, back, .. } = row;
        within("height", back.height_m, truth.height_m, 0.93, 1.05);
        within("dbh", back.dbh_m, truth.dbh_m, 0.85, 1.15);
        within("volume", back.volume_m3(), truth.volume_m3(), 0.5, 2.0);
        within("length", back.length_m(), truth.length_m(), 0.2, 1.15);
    }
}

/// Nothing that is tuned by is judged by.
#[test]
fn tuning_and_judging_share_no_species_and_no_seed() {
    let of = |purpose: Use| SUBJECTS.iter().filter(move |subject| subject.purpose == purpose);
    for (a, b) in of(Use::Tuning).flat_map(|a| of(Use::Judging).map(move |b| (a, b))) {
        assert!(a.preset != b.preset && a.seed != b.seed, "{} {}", a.preset, b.preset);
    }
}

#[test]
#[ignore = "minutes: prints the table of docs/scans.md"]
fn table() {
    let survey = |positions, distance, step_deg| Survey { positions, distance, step_deg };
    let surveys = [survey(4, 1.0, 0.12), survey(1, 1.0, 0.12), survey(4, 1.0, 0.24), survey(4, 2.0, 0.12)];
    print!("{}", head());
    for survey in surveys {
        let mut rows = Vec::new();
        for subject in &SUBJECTS {
            let row = row(subject, survey);
            println!("{}", line(subject, survey, &row));
            if subject.purpose == Use::Judging {
                rows.push(row);
            }
        }
        let off = |of: fn(&TreeSizes) -> f64| {
            let off = rows.iter().map(|row| (of(&row.back) / of(&row.truth) - 1.0).abs());
            1e2 * median(off.collect())
        };
        println!(
            "| median of judging, either way | | | {} | {} | {}° | | {:.1} | {:.1} | {:.1} | {:.1} |{}",
            survey.positions,
            survey.distance,
            survey.step_deg,
            off(|sizes| sizes.height_m),
            off(|sizes| sizes.dbh_m),
            off(TreeSizes::volume_m3),
            off(TreeSizes::length_m),
            " |".repeat(2 * CLASS_NAMES.len())
        );
    }
}
