//! Forecasts: how large trees and files will be and how long they take, said before the work is done.

use std::time::{Duration, Instant};

use indicatif::HumanCount;
use linden::Monitor;
use linden::forecast::{Sample, sample};
use linden::forest::PlannedTree;
use linden::recipe::Recipe;
use linden_exporters::{Estimate, Format, Options};

use crate::exit;
use crate::system::cpu_time;

/// What takes longer is announced.
const LONG: Duration = Duration::from_secs(10);

// Set by estimate, for two shared cores (Xeon, 2.0 GHz) and a release build: they tell seconds from minutes.

/// Drawing a stroke, a triangle.
const STROKE_S: f64 = 400e-9;
const DRAWN_TRIANGLE_S: f64 = 60e-9;
/// Painting a pixel and compressing it; the same where each has several samples.
const PIXEL_S: f64 = 70e-9;
const SAMPLED_PIXEL_S: f64 = 140e-9;
/// The rest of a pixel of an impostor of a plant with leaves, of which many lie one behind another: processor time of `linden
/// impostor` of oak, Scots pine, apple, hazel and `dressed-simple` with `--size` 1024 and 2048, 1.4 to 2.4 µs. A triangle takes
/// [`DRAWN_TRIANGLE_S`] in each view: the oak with `--frames` 8 and 16.
const LEAFY_PIXEL_S: f64 = 1.7e-6;

/// A tree that has not grown.
pub struct Outlook {
    /// A small one like it.
    pub sample: Sample,
    /// What its surface and its files will have.
    pub estimate: Estimate,
    /// How long growing takes, as long as the sample took.
    pub grow_s: f64,
}

impl Outlook {
    /// Grows a sample of a recipe. `None` where it cannot grow: why is said when the tree is to.
    pub fn of(recipe: &Recipe, monitor: &dyn Monitor) -> Option<Self> {
        let (started, worked) = (Instant::now(), cpu_time());
        let sample = sample(recipe, monitor).ok()?;
        // The less of both: a busy machine stretches the one, idle threads that wait for work the other.
        let worked = worked.zip(cpu_time()).map(|(before, now)| now.saturating_sub(before));
        let took_s = started.elapsed().min(worked.unwrap_or(Duration::MAX)).as_secs_f64();
        let estimate = Estimate::of_sample(recipe, &sample, monitor).ok()?;
        let grow_s = took_s * sample.work_times();
        Some(Self { sample, estimate, grow_s })
    }

    /// From the recipe to files in these formats, in a number of seasons; writing those without an estimate is
    /// left out.
    pub fn export_s(&self, recipe: &Recipe, formats: &[(&'static Format, &Options)], looks: usize) -> f64 {
        let each = self.shape_and_write_s(recipe, formats) + self.estimate.draw_seconds(recipe);
        self.grow_s + each * looks.max(1) as f64 + self.estimate.compress_seconds(recipe)
    }

    /// The same where the pictures of bark and leaves are there already.
    pub fn export_alike_s(&self, recipe: &Recipe, formats: &[(&'static Format, &Options)]) -> f64 {
        self.grow_s + self.shape_and_write_s(recipe, formats)
    }

    /// Pictures of bark and leaves, drawn and compressed.
    pub fn pictures_s(&self, recipe: &Recipe) -> f64 {
        self.estimate.draw_seconds(recipe) + self.estimate.compress_seconds(recipe)
    }

    fn shape_and_write_s(&self, recipe: &Recipe, formats: &[(&'static Format, &Options)]) -> f64 {
        let written =
            formats.iter().filter_map(|(format, options)| self.estimate.write_seconds(format, options));
        self.estimate.shape_seconds(recipe) + written.sum::<f64>()
    }

    /// Of the files in each of these formats; none for formats without an estimate.
    pub fn file_bytes<'a>(
        &'a self,
        formats: &'a [(&'static Format, &'a Options)],
    ) -> impl Iterator<Item = u64> + Clone + 'a {
        formats.iter().map(|(format, options)| self.estimate.bytes(format, options).unwrap_or(0))
    }

    /// What is held at least while it is written: the tree with what its largest file is written from.
    pub fn held_bytes(&self, formats: &[(&'static Format, &Options)]) -> u64 {
        self.sample.skeleton_bytes().unwrap_or(0) + self.file_bytes(formats).max().unwrap_or(0)
    }

    /// From the recipe to a picture.
    pub fn picture_s(&self, recipe: &Recipe, pixels: f64, shows_surface: bool) -> f64 {
        if !shows_surface {
            return self.grow_s + self.sample.nodes() * STROKE_S + pixels * PIXEL_S;
        }
        let drawn = self.estimate.triangles as f64 * DRAWN_TRIANGLE_S;
        self.grow_s + self.estimate.dress_seconds(recipe) + drawn + pixels * SAMPLED_PIXEL_S
    }

    /// From the recipe to views from all around, which have so many pixels together.
    pub fn impostor_s(&self, recipe: &Recipe, views: f64, pixels: f64) -> f64 {
        let drawn = views * self.estimate.triangles as f64 * DRAWN_TRIANGLE_S;
        let leafy = if self.sample.leaves() > 0.0 { LEAFY_PIXEL_S } else { 0.0 };
        self.grow_s + self.estimate.dress_seconds(recipe) + drawn + pixels * (SAMPLED_PIXEL_S + leafy)
    }

    /// From the recipe to its measures.
    pub fn stats_s(&self, recipe: &Recipe) -> f64 {
        self.grow_s + self.estimate.survey_seconds(recipe)
    }

    /// Says how long the work on it will take, where that is long; not of a tree for which there is no memory: that is what
    /// growing says.
    pub fn announce(&self, seconds: f64) {
        self.announce_with(seconds, "");
    }

    /// The same with more behind the amounts.
    pub fn announce_with(&self, seconds: f64, more: &str) {
        if self.sample.skeleton_bytes().unwrap_or(u64::MAX) <= crate::memory::limit() {
            announce(seconds, &format!("{}{more}", self.amount()));
        }
    }

    /// What there will be: `about 3,100,000 nodes, 20,000,000 triangles`.
    pub fn amount(&self) -> String {
        let [nodes, triangles] = [self.sample.nodes(), self.estimate.triangles as f64].map(round);
        format!("{} nodes, {} triangles", HumanCount(nodes), HumanCount(triangles))
    }
}

/// A forest that has not grown: each of its different trees.
pub struct ForestOutlook {
    trees: Vec<(Recipe, Outlook, f64)>,
}

impl ForestOutlook {
    /// One tree of each kind stands for the others; each has at most its budget of triangles, as many times as it
    /// has stems.
    pub fn of(trees: &[PlannedTree], triangles: u64, monitor: &dyn Monitor) -> Self {
        let mut kinds: Vec<(&PlannedTree, f64)> = Vec::new();
        for tree in trees {
            match kinds.iter_mut().find(|(first, _)| first.kind == tree.kind) {
                Some((_, count)) => *count += 1.0,
                None => kinds.push((tree, 1.0)),
            }
        }
        let outlook = |(tree, count): (&PlannedTree, f64)| {
            let mut recipe = tree.recipe.clone();
            let budget = triangles.saturating_mul(tree.stems);
            let budgeted = &mut recipe.preset.dressing.detail.triangles;
            *budgeted = if *budgeted == 0 { budget } else { budget.min(*budgeted) };
            let outlook = Outlook::of(&recipe, monitor)?;
            Some((recipe, outlook, count))
        };
        Self { trees: kinds.into_iter().filter_map(outlook).collect() }
    }

    fn sum(&self, of: impl Fn(&Recipe, &Outlook) -> f64) -> f64 {
        self.trees.iter().map(|(recipe, outlook, count)| of(recipe, outlook) * count).sum()
    }

    /// Nodes of all different trees.
    pub fn nodes(&self) -> f64 {
        self.sum(|_, outlook| outlook.sample.nodes())
    }

    /// Leaves of all different trees, before any budget.
    pub fn leaves(&self) -> f64 {
        self.sum(|_, outlook| outlook.sample.leaves())
    }

    /// Triangles of all different trees.
    pub fn triangles(&self) -> f64 {
        self.sum(|_, outlook| outlook.estimate.triangles as f64)
    }

    /// Bytes of all files in a format with its usual options, each tree once; `None` where the format has no
    /// estimate.
    pub fn bytes(&self, format: &'static Format) -> Option<f64> {
        let options = Options::new(format);
        let of_tree = |(_, outlook, count): &(Recipe, Outlook, f64)| {
            Some(outlook.estimate.bytes(format, &options)? as f64 * count)
        };
        self.trees.iter().map(of_tree).sum()
    }

    /// From the recipes to files in these formats.
    pub fn export_s(&self, formats: &[(&'static Format, &Options)]) -> f64 {
        self.sum(|recipe, outlook| outlook.export_s(recipe, formats, 1))
    }

    /// What there will be.
    pub fn amount(&self) -> String {
        let trees: f64 = self.trees.iter().map(|(.., count)| count).sum();
        let [nodes, triangles] = [self.nodes(), self.triangles()].map(|n| HumanCount(round(n)));
        format!("{trees} trees, {nodes} nodes, {triangles} triangles")
    }
}

/// Says how long work will take, where that is long; whether it was.
pub fn announce(seconds: f64, amount: &str) -> bool {
    let line = announcement(seconds, amount);
    if let Some(line) = &line {
        exit::say(line);
    }
    line.is_some()
}

fn announcement(seconds: f64, amount: &str) -> Option<String> {
    (seconds > LONG.as_secs_f64()).then(|| format!("note: this will take about {}: {amount}", time(seconds)))
}

/// A count to two digits: the others would be made up.
pub fn round(count: f64) -> u64 {
    let power = exponent(count);
    let unit: f64 = (1..power).map(|_| 10.0).product();
    if power < 2 { count.round() as u64 } else { ((count / unit).round() * unit) as u64 }
}

/// The exponent of a number in scientific notation.
fn exponent(count: f64) -> i32 {
    if count >= 1.0 { count.log10().floor() as i32 } else { 0 }
}

/// A time as people say it: `0.4 s`, `40 s`, `3 min`, `2 h`.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 0.095 => format!("{s:.2} s"),
        s if s < 9.5 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 99.5 * 60.0 => format!("{:.0} min", s / 60.0),
        s if s < 99.5 * 3600.0 => format!("{:.0} h", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_work_is_announced_and_short_work_is_not() {
        assert_eq!(announcement(9.0, ""), None);
        assert_eq!(announcement(41.3, "5 nodes").unwrap(), "note: this will take about 41 s: 5 nodes");
    }

    #[test]
    fn times_and_counts_have_the_digits_that_are_known() {
        let times = [0.02, 0.44, 12.0, 250.0, 20_000.0, 1e6].map(time);
        assert_eq!(times, ["0.02 s", "0.4 s", "12 s", "4 min", "6 h", "12 days"]);
        assert_eq!([7.4, 99.0, 1234.0, 987_654.0].map(round), [7, 99, 1200, 990_000]);
    }
}
