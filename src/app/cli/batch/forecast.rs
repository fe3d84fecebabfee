//! What a batch will take, from a look at some of its trees.

use anyhow::bail;
use indicatif::{BinaryBytes, HumanCount};
use linden::Monitor;
use linden::settings::{BarkSettings, FoliageSettings};
use serde::Serialize;

use super::part::Part;
use super::plan::Plan;
use crate::forecast::Outlook;
use crate::progress::Progress;

/// Trees of which a small one grows: spread evenly over the part.
const MOST_SAMPLES: usize = 24;
/// Trees whose bark and leaves are compared.
const MOST_COMPARED: usize = 2000;

/// What the trees of a part will take.
#[derive(Default)]
pub struct Forecast {
    trees: usize,
    /// Files that stand alone, with the pictures in them.
    bytes: f64,
    /// Pictures beside files, which trees share.
    picture_bytes: f64,
    /// Work of one thread.
    seconds: f64,
    /// Drawing what trees share.
    picture_seconds: f64,
    /// What a tree holds while it is written, at least.
    memory: u64,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
pub struct ForecastRow {
    trees: usize,
    bytes: u64,
    /// Of one thread.
    work_seconds: f64,
    /// With so many trees at a time.
    seconds: f64,
    jobs: usize,
    /// At least, for each tree at a time.
    memory_bytes: u64,
}

impl Forecast {
    pub fn of(plan: &Plan, part: &Part, progress: &Progress) -> anyhow::Result<Self> {
        let numbers: Vec<usize> = part.numbers().collect();
        let mut forecast = Self { trees: numbers.len(), ..Self::default() };
        let samples = from_the_middles(&numbers, MOST_SAMPLES);
        let share = numbers.len() as f64 / samples.len().max(1) as f64;
        let looks = looks(plan, &numbers, progress)? / samples.len().max(1) as f64;
        for number in samples {
            progress.check()?;
            let tree = plan.tree(number)?;
            let Some(outlook) = Outlook::of(&tree.recipe, progress) else {
                bail!("tree {number} cannot grow: --only {number} says why");
            };
            let formats = tree.formats();
            let without = outlook.estimate.without_pictures();
            forecast.seconds += share * outlook.export_alike_s(&tree.recipe, &formats);
            forecast.picture_seconds += looks * outlook.pictures_s(&tree.recipe);
            for (format, options) in &formats {
                let all = outlook.estimate.bytes(format, options).unwrap_or(0);
                let own =
                    if format.self_contained { all } else { without.bytes(format, options).unwrap_or(0) };
                forecast.bytes += share * own as f64;
                forecast.picture_bytes += looks * all.saturating_sub(own) as f64;
            }
            forecast.memory = forecast.memory.max(outlook.held_bytes(&formats));
        }
        Ok(forecast)
    }

    /// For scripts.
    pub fn row(&self, jobs: usize) -> ForecastRow {
        ForecastRow {
            trees: self.trees,
            bytes: (self.bytes + self.picture_bytes) as u64,
            work_seconds: self.seconds + self.picture_seconds,
            seconds: (self.seconds + self.picture_seconds) / jobs as f64,
            jobs,
            memory_bytes: self.memory,
        }
    }

    /// For people, with so many trees at a time.
    pub fn text(&self, jobs: usize) -> String {
        let seconds = self.seconds + self.picture_seconds;
        format!(
            "trees    {}\nbytes    {}\nseconds  {seconds:.0} of work, {:.0} with {jobs} at a time\nmemory   at \
             least {} for each tree at a time\n",
            HumanCount(self.trees as u64),
            BinaryBytes((self.bytes + self.picture_bytes) as u64),
            seconds / jobs as f64,
            BinaryBytes(self.memory),
        )
    }
}

/// From the middle of each of so many stretches.
fn from_the_middles(numbers: &[usize], most: usize) -> Vec<usize> {
    let count = numbers.len().min(most);
    (0..count).map(|look| numbers[(2 * look + 1) * numbers.len() / (2 * count)]).collect()
}

/// How many different barks and foliages there are. Where nearly each tree has its own, those that were not
/// compared have, too.
fn looks(plan: &Plan, numbers: &[usize], progress: &Progress) -> anyhow::Result<f64> {
    let compared = from_the_middles(numbers, MOST_COMPARED);
    let mut known: Vec<(BarkSettings, FoliageSettings)> = Vec::new();
    for &number in &compared {
        progress.check()?;
        let dressing = plan.tree(number)?.recipe.preset.dressing;
        if !known.iter().any(|(bark, foliage)| *bark == dressing.bark && *foliage == dressing.foliage) {
            known.push((dressing.bark, dressing.foliage));
        }
    }
    let found = known.len() as f64;
    let is_each_another = 2 * known.len() > compared.len();
    Ok(if is_each_another { found * numbers.len() as f64 / compared.len() as f64 } else { found })
}
