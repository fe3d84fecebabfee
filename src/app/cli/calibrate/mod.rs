//! `linden calibrate`: trees of many seeds beside trees that were measured.

mod measured;

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use linden::Monitor;
use linden::grow::grow;
use linden::report::{Number, Parting, Report, Sample};
use serde::Serialize;

use self::measured::Measured;
use super::GrowArgs;
use super::crew::{Crew, Share};
use crate::exit::{say, sentence, usage};
use crate::forecast::{Outlook, announce};
use crate::numbers::rounded;
use crate::progress::Progress;

/// Two samples part where so large a distance is less probable than this, over all numbers that are compared.
const LEAST_P: f64 = 0.05;

/// What is said of a number of which no p is small enough.
const TOO_FEW: &str = "too few trees to tell";

/// Grown where no number is asked for: as many as were measured, within these.
const USUAL_TREES: std::ops::RangeInclusive<u64> = 20..=200;

/// Compare trees of many seeds with trees that were measured, number by number
///
/// The table is CSV with a header, a line for each tree; between its columns are commas, semicolons or tabs, and where
/// these are no commas, numbers may have decimal commas. Columns are compared whose names are those of 'linden stats'
/// ('linden schema --stats' lists them). Lengths end in their unit: m, cm, mm, ft or in. Where trees differ too little
/// from each other, give knobs a spread: --set internode='0.17 ± 0.01'.
#[derive(Args)]
pub struct Calibrate {
    #[command(flatten)]
    growing: GrowArgs,

    /// The table of measured trees, - for standard input
    #[arg(long, value_name = "TABLE.csv")]
    against: PathBuf,

    /// Grow so many trees, with the seed and those that follow; without, as many as were measured, 20 to 200
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: Option<u64>,

    /// Machine-readable
    #[arg(long)]
    json: bool,
}

/// The names and meanings of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Calibration {
    source: String,
    /// Trees that were grown, and lines of the table.
    grown: usize,
    measured: usize,
    numbers: Vec<Row>,
    /// Columns of the table that are no number of 'linden stats'.
    left_out: Vec<String>,
}

/// One number.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    unit: &'static str,
    measured: Moments,
    /// Lines of the table without a value.
    missing: usize,
    grown: Option<Moments>,
    /// The mean that was grown ÷ the mean that was measured, less 1.
    differs_by: Option<f64>,
    /// See [`Parting`].
    distance: Option<f64>,
    p: Option<f64>,
    /// The smallest p that so many trees reach.
    least_p: Option<f64>,
    /// Whether p is below 0.05 ÷ the numbers that are compared (Bonferroni); null where it cannot be.
    parts: Option<bool>,
}

impl Row {
    /// Whether these are too few trees to part, however far apart they are.
    fn is_too_few(&self) -> bool {
        self.p.is_some() && self.parts.is_none()
    }
}

#[derive(Serialize)]
struct Moments {
    trees: usize,
    mean: f64,
    deviation: Option<f64>,
    /// A tenth, half and nine tenths of the trees have less.
    quantiles: [f64; 3],
}

impl Moments {
    fn of(sample: &Sample) -> Self {
        Self {
            trees: sample.len(),
            mean: sample.mean(),
            deviation: sample.deviation(),
            quantiles: [0.1, 0.5, 0.9].map(|share| sample.quantile(share)),
        }
    }

    /// `16.2 ± 1.1`.
    fn text(&self) -> String {
        let deviation = self.deviation.map(|deviation| format!(" ± {}", rounded(deviation)));
        rounded(self.mean) + &deviation.unwrap_or_default()
    }
}

impl Calibrate {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let source = self.growing.resolve(&progress)?;
        let measured = Measured::read(&self.against, &progress)?;
        super::notes(&measured.notes, &progress);
        let preset = &source.recipe.preset;
        let trees = self
            .seeds
            .unwrap_or_else(|| (measured.trees as u64).clamp(*USUAL_TREES.start(), *USUAL_TREES.end()));
        if let Some(outlook) = Outlook::of(&source.recipe, &progress) {
            let at_a_time = (trees as f64).min(rayon::current_num_threads() as f64);
            let all = outlook.stats_s(&source.recipe) * trees as f64 / at_a_time;
            announce(all, &format!("{trees} trees, {} each", outlook.amount()));
        }
        let reports = grown(&source.recipe, trees, &progress)?;
        let compared = measured
            .columns
            .iter()
            .filter(|(number, _)| reports.iter().any(|report| (number.reading)(report).number().is_some()));
        let level = LEAST_P / compared.count().max(1) as f64;
        let row = |(number, sample): &(&'static Number, Sample)| {
            row((number, sample), measured.trees, &reports, level)
        };
        let calibration = Calibration {
            source: preset.id.clone(),
            grown: reports.len(),
            measured: measured.trees,
            numbers: measured.columns.iter().map(row).collect(),
            left_out: measured.left_out,
        };
        progress.clear();
        if self.json {
            return super::print_json(&calibration);
        }
        if !calibration.left_out.is_empty() {
            say(&format!("note: not compared: {}", calibration.left_out.join(", ")));
        }
        super::print(&calibration.page())
    }
}

/// Grows and measures so many trees of a recipe, with its seed and those that follow.
fn grown(base: &linden::recipe::Recipe, trees: u64, progress: &Progress) -> anyhow::Result<Vec<Report>> {
    let first = base.preset.seed();
    let work = |index: usize, job: &Share<'_>| -> anyhow::Result<Report> {
        let mut recipe = base.clone();
        recipe.preset.set_seed(first.wrapping_add(index as u64));
        let grown = grow(&recipe, job)?;
        Ok(Report::of(&recipe, &grown, job)?)
    };
    let crew = Crew { in_order: true, ..Crew::of_threads(progress) };
    let (mut reports, mut failed, mut seed) = (Vec::new(), 0, first);
    crew.run(0..trees as usize, work, |result| {
        match result {
            Ok(report) => reports.push(report),
            Err(error) => {
                failed += 1;
                super::notes(&[format!("seed {seed}: {}", sentence(&error))], progress);
            }
        }
        seed = seed.wrapping_add(1);
        Ok(true)
    })?;
    progress.check()?;
    if reports.len() < 2 {
        bail!("{failed} of {trees} trees failed: there is nothing to compare");
    }
    Ok(reports)
}

/// What is said of a number of `trees` that were measured; samples part at a p below `level`.
fn row((number, measured): (&'static Number, &Sample), trees: usize, reports: &[Report], level: f64) -> Row {
    let values = reports.iter().filter_map(|report| (number.reading)(report).number());
    let grown = Sample::of(values);
    let parting = grown.as_ref().map(|grown| grown.parting(measured));
    let least_p = grown.as_ref().map(|grown| grown.least_p(measured));
    let mean = measured.mean();
    let differs_by = grown.as_ref().filter(|_| mean != 0.0).map(|grown| grown.mean() / mean - 1.0);
    Row {
        name: number.name,
        unit: number.unit,
        measured: Moments::of(measured),
        missing: trees - measured.len(),
        grown: grown.as_ref().map(Moments::of),
        differs_by,
        distance: parting.map(|Parting { distance, .. }| distance),
        p: parting.map(|Parting { p, .. }| p),
        least_p,
        parts: parting.filter(|_| least_p.is_some_and(|p| p < level)).map(|Parting { p, .. }| p < level),
    }
}

impl Calibration {
    fn page(&self) -> String {
        let header = ["", "measured", "grown", "differs", "D", "p", ""].map(str::to_owned);
        let mut rows = vec![header];
        for row in &self.numbers {
            let two = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.2}"));
            let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
            rows.push([
                row.name.to_owned(),
                row.measured.text() + &unit,
                row.grown.as_ref().map_or_else(|| "none has it".to_owned(), |grown| grown.text() + &unit),
                row.differs_by.map_or_else(String::new, |share| format!("{:+.0} %", 100.0 * share)),
                two(row.distance),
                two(row.p),
                match row.parts {
                    Some(true) => "parts",
                    None if row.is_too_few() => TOO_FEW,
                    _ => "",
                }
                .to_owned(),
            ]);
        }
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..7).map(width).collect();
        let mut text = format!(
            "{} trees of {}, {} measured\n\n",
            self.grown,
            linden::knob::printable(&self.source),
            self.measured
        );
        for row in &rows {
            let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}"));
            text += cells.collect::<Vec<_>>().join("  ").trim_end();
            text.push('\n');
        }
        let parted: Vec<&Row> = self.numbers.iter().filter(|row| row.parts == Some(true)).collect();
        text.push('\n');
        let too_few: Vec<&str> =
            self.numbers.iter().filter(|row| row.is_too_few()).map(|row| row.name).collect();
        let is_compared = self.numbers.iter().any(|row| row.p.is_some());
        let is_told = self.numbers.iter().any(|row| row.parts.is_some());
        text += match (is_told, parted.is_empty(), too_few.is_empty()) {
            (_, true, true) if !is_compared => {
                "Nothing was compared: none of the trees that were grown has these numbers.\n"
            }
            (_, true, true) => "Nothing parts: as far as this many trees can tell, they are of one kind.\n",
            (true, true, false) => {
                "Nothing else parts: in the rest, as far as this many trees can tell, they are of one kind.\n"
            }
            (false, _, false) => {
                "Nothing can part: p of so few trees is never small enough, however far apart they are. Measure more, or \
                 grow more with --seeds.\n"
            }
            _ => "",
        };
        if is_told && !too_few.is_empty() {
            text += &format!("Too few trees to tell: {}\n", too_few.join(", "));
        }
        for row in parted {
            let Some(grown) = &row.grown else { continue };
            let [low, middle, high] = [0, 1, 2].map(|i| {
                format!("{} of {}", rounded(grown.quantiles[i]), rounded(row.measured.quantiles[i]))
            });
            text += &format!(
                "{}: a tenth of the trees have less than {low}, half less than {middle}, nine tenths less than {high} {}\n",
                row.name, row.unit
            );
        }
        text += "\nD: the largest distance of the two distributions (Kolmogorov–Smirnov); p: how often samples of one kind \
                 are so far apart.\n";
        text
    }
}

/// What may be said of a table that holds none of the numbers.
fn no_columns(shown: &str) -> anyhow::Error {
    usage(format!(
        "{shown} has no column that is a number of 'linden stats': name columns like height_m, dbh_cm, crown_width_m \
         ('linden schema --stats' lists all)"
    ))
}
