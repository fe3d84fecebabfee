//! Exporting what is on screen: `dress` → write → all files into their places, or none.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use anyhow::Context as _;
use linden::Monitor;
use linden::dress::{levels, year};
use linden::forest::{Forest, GrownForest};
use linden::grow::{Grown, grow};
use linden::monitor::Phase;
use linden::recipe::Recipe;
use linden::season::Season;
use linden::stage::Stage;
use linden_exporters::{Bundle, Estimate, Existing, examine, make_folders};

use super::{Done, Findings, HowFar, ShownTree};
use crate::exit;
use crate::paths::expand;
use crate::paths::show;
use crate::portrait::{Sitters, is_apart, write_apart};
use crate::triangles;
use linden_exporters::{Batch, Output};

/// What to export.
#[derive(Debug)]
pub struct ExportOrder {
    /// Tells it from other orders: its news carry it.
    pub number: u64,
    /// What of.
    pub subject: ExportSubject,
    /// Whether with camera, sun, sky and ground, in formats that hold them.
    pub scene: bool,
    /// The seasons that a tree is written in; none: in the one that it is in.
    pub seasons: Vec<Season>,
    /// The ages that a tree is written at, each by its name and with what it grows from; none: at the one that it has.
    pub ages: Vec<(String, Arc<Recipe>)>,
    /// What is written where; `~/` may still stand before a path.
    pub outputs: Vec<Output>,
    /// Files that may be replaced, `~/` expanded: those that the user was asked about.
    pub replaces: Vec<PathBuf>,
    /// Whether directories that are missing are made: the user was asked about them.
    pub makes_folders: bool,
    /// Files that it is grown from, which are never replaced.
    pub sources: Vec<PathBuf>,
    /// The knobs that differ from the document: it is noted where they change nothing.
    pub turned: Vec<&'static str>,
}

/// What is exported.
#[derive(Clone, Debug)]
pub enum ExportSubject {
    /// A tree.
    Tree {
        /// What it grows from.
        recipe: Arc<Recipe>,
        /// As it grew, so that it need not grow again.
        shown: Option<Arc<ShownTree>>,
    },
    /// A forest, whose trees are grown for the file: those on screen are simpler.
    Forest(Arc<Forest>),
}

impl ExportSubject {
    /// How many levels of detail are asked for.
    fn levels(&self) -> usize {
        match self {
            Self::Tree { recipe, .. } => recipe.preset.dressing.detail.levels(),
            Self::Forest(forest) => {
                let levels = forest.kinds.iter().map(|kind| kind.recipe.preset.dressing.detail.levels());
                levels.max().unwrap_or(1)
            }
        }
    }
}

/// What an export says, and what was found out for the dialog.
#[derive(Debug)]
pub enum ExportNews {
    /// How far the export under way is.
    Progress {
        /// What is being done.
        doing: Phase,
        /// Of the whole, in parts of [`WHOLE`].
        done: u64,
    },
    /// The files are in their places.
    Done {
        /// The order's number.
        number: u64,
        /// Absolute paths, as far as the system tells, and lengths in bytes.
        files: Vec<(PathBuf, u64)>,
        /// Triangles of each level of a tree that was written, finest first; none of a forest, nor of pictures alone.
        triangles: Vec<u64>,
        /// What the user should know.
        notes: Vec<String>,
    },
    /// It failed, and nothing was left behind.
    Failed {
        /// The order's number.
        number: u64,
        /// Why, and what to do.
        why: String,
    },
    /// It was cancelled, and nothing was left behind.
    Cancelled {
        /// The order's number.
        number: u64,
    },
    /// The export under way panicked, which is our fault.
    Broken(String),
    /// What a tree will amount to.
    Estimated(Arc<ShownTree>, Estimate),
    /// What the dialog wanted to know.
    Found(Box<Findings>),
}

impl ExportNews {
    /// What the lane of exports says, as news.
    pub fn heard(said: Done<Self>) -> Option<Self> {
        match said {
            Done::Value(news) => Some(news),
            Done::Progress(HowFar { stage, done, .. }) => Some(Self::Progress { doing: stage, done }),
            Done::Broken(why) => Some(Self::Broken(why)),
            Done::Finished => None,
        }
    }
}

/// A whole export, for [`ExportNews::Progress`].
pub const WHOLE: u64 = 1000;
/// The share of the whole that growing takes where the tree has not grown yet, and that the surface
/// takes of what is left then. Rough: what they take beside writing depends on the disk.
const GROWING: f64 = 0.4;
const DRESSING: f64 = 0.3;

/// Carries an order out, on its lane. Progress goes through the watcher, everything else is said;
/// the last that is said of an order is `Done`, `Failed` or `Cancelled`.
pub fn run(order: ExportOrder, watcher: &dyn Monitor, say: &dyn Fn(ExportNews)) {
    let number = order.number;
    say(match export(order, watcher) {
        Ok(Exported { files, triangles, notes }) => ExportNews::Done { number, files, triangles, notes },
        // Whatever failed then, failed because of it.
        Err(_) if watcher.is_cancelled() => ExportNews::Cancelled { number },
        Err(error) => ExportNews::Failed { number, why: exit::sentence(&error) },
    });
}

/// What [`ExportNews::Done`] says.
struct Exported {
    files: Vec<(PathBuf, u64)>,
    triangles: Vec<u64>,
    notes: Vec<String>,
}

fn export(order: ExportOrder, watcher: &dyn Monitor) -> anyhow::Result<Exported> {
    let ExportOrder {
        subject,
        scene,
        seasons,
        ages,
        mut outputs,
        replaces,
        makes_folders,
        sources,
        turned,
        ..
    } = order;
    // They go again when the export fails.
    let mut folders = Vec::new();
    for output in &mut outputs {
        if let Some(typed) = output.path.to_str() {
            output.path = expand(typed).map_err(anyhow::Error::msg)?;
        }
        if makes_folders {
            folders.push(make_folders(&output.path)?);
        }
    }
    let levels = subject.levels();
    let names: Vec<&str> = ages.iter().map(|(name, _)| name.as_str()).collect();
    outputs = outputs.into_iter().flat_map(|output| files_of(output, &names, &seasons, levels)).collect();
    for output in &outputs {
        ensure_expected(output, replaces.contains(&output.path))?;
    }
    let targets: Vec<PathBuf> = outputs.iter().map(|output| output.path.clone()).collect();
    let replaced: Vec<bool> =
        targets.iter().map(|path| matches!(examine(path), Ok(Existing::File))).collect();
    let planned: Vec<Output> =
        outputs.iter().filter(|output| !is_apart(output.exporter.format())).cloned().collect();
    let mut batch =
        Batch::open(outputs, sources, |output| Bundle::create(&output.path))?.with_folders(folders);
    let gauge = Gauge::new(watcher);
    let how = HowExported { planned: &planned, scene, turned: &turned, seasons: &seasons, age: None };
    let mut notes = draw_apart(&subject, planned.is_empty(), &mut batch, &gauge)?;
    let mut triangles = Vec::new();
    if !batch.is_written() {
        match &subject {
            ExportSubject::Tree { recipe, shown } if ages.is_empty() => {
                let told;
                (told, triangles) = write_tree(recipe, shown.as_deref(), &how, &mut batch, &gauge)?;
                notes.extend(told);
            }
            ExportSubject::Tree { .. } => notes.extend(write_ages(&ages, &how, &mut batch, &gauge)?),
            ExportSubject::Forest(forest) => notes.extend(write_forest(forest, &how, &mut batch, &gauge)?),
        }
    }
    // What came to be there meanwhile was not asked about.
    for (path, replaced) in targets.iter().zip(replaced) {
        if !replaced && !matches!(examine(path), Ok(Existing::Nothing)) {
            anyhow::bail!(
                "{} came to be there while it was exported; export again to replace it",
                show(path)
            );
        }
    }
    // After this there is no way back.
    watcher.check()?;
    let files = batch.commit()?.into_iter().map(|file| (absolute(file.path), file.bytes)).collect();
    notes.dedup();
    Ok(Exported { files, triangles, notes })
}

/// What a subject is exported with.
struct HowExported<'o> {
    planned: &'o [Output],
    scene: bool,
    turned: &'o [&'static str],
    seasons: &'o [Season],
    /// The age that is written, where there are several.
    age: Option<&'o str>,
}

impl HowExported<'_> {
    /// Notes of knobs that were turned and change nothing, in none of the seasons.
    fn idle(&self, recipe: &Recipe) -> Vec<String> {
        let mut idle = recipe.preset.idle_notes(self.turned.iter().copied());
        for season in self.seasons {
            let mut preset = recipe.preset.clone();
            preset.dressing.foliage.season = season.season;
            let of_one = preset.idle_notes(self.turned.iter().copied());
            idle.retain(|note| of_one.contains(note));
        }
        idle
    }

    fn stage<'s>(&self, stage: Stage<'s>) -> Stage<'s> {
        let stage = stage.turned_by(self.turned.iter().copied());
        if self.scene { stage.in_setting() } else { stage }
    }
}

/// Draws the pictures that grow what they show; gives the notes.
fn draw_apart(
    subject: &ExportSubject,
    is_all: bool,
    batch: &mut Batch,
    gauge: &Gauge<'_>,
) -> anyhow::Result<Vec<String>> {
    let sitters = match subject {
        ExportSubject::Tree { recipe, .. } => Sitters::Tree(recipe),
        ExportSubject::Forest(forest) => Sitters::Forest(forest),
    };
    let mut notes = Vec::new();
    batch.write_apart(|output, bundle| {
        if !is_apart(output.exporter.format()) {
            return Ok(false);
        }
        gauge.begin(if is_all { 1.0 } else { GROWING }, None);
        let is_written = write_apart(output, &sitters, bundle, gauge)?;
        notes.extend_from_slice(bundle.notes());
        anyhow::Ok(is_written)
    })?;
    Ok(notes)
}

/// Grows a tree where that is still to be done, dresses and writes it; gives the notes, and its triangles by levels.
fn write_tree(
    recipe: &Recipe,
    shown: Option<&ShownTree>,
    how: &HowExported<'_>,
    batch: &mut Batch,
    gauge: &Gauge<'_>,
) -> anyhow::Result<(Vec<String>, Vec<u64>)> {
    let again: Grown;
    let grown = match shown {
        Some(shown) => &shown.grown,
        None => {
            gauge.begin(GROWING, None);
            again = grow(recipe, gauge)?;
            &again
        }
    };
    let estimate = Estimate::new(recipe, grown, gauge.watcher)?;
    gauge.begin(DRESSING, None);
    let dressed = recipe.clone().wanting(batch.wanted());
    let (one, several);
    let (stage, said) = if how.seasons.is_empty() {
        one = levels(&dressed, grown, gauge)?;
        (one.stage(), &one.notes)
    } else {
        several = year(&dressed, grown, how.seasons, gauge)?;
        (several.stage(), &several.notes)
    };
    let bytes = |output: &Output| {
        let format = output.exporter.format();
        match output.level {
            Some(level) => estimate.level_bytes(level, format, &output.options),
            None => estimate.bytes(format, &output.options),
        }
    };
    let planned = how.planned.iter().filter(|output| output.age.as_deref() == how.age);
    let bytes: Vec<u64> = planned.map(|output| bytes(output).unwrap_or(0).max(1)).collect();
    let mut notes = grown.notes.clone();
    notes.extend_from_slice(said);
    notes.extend(how.idle(recipe));
    let triangles = triangles::of_levels(&stage);
    write_files(&how.stage(stage), how.age, &bytes, batch, gauge, &mut notes)?;
    Ok((notes, triangles))
}

/// Grows a tree at several ages and writes each; gives the notes of all.
fn write_ages(
    ages: &[(String, Arc<Recipe>)],
    how: &HowExported<'_>,
    batch: &mut Batch,
    gauge: &Gauge<'_>,
) -> anyhow::Result<Vec<String>> {
    let mut notes = Vec::new();
    for (name, recipe) in ages {
        let how = HowExported { age: Some(name), ..*how };
        let (told, _) = write_tree(recipe, None, &how, batch, gauge).with_context(|| name.clone())?;
        notes.extend(told.into_iter().map(|note| format!("{name}: {note}")));
    }
    batch.gather(gauge)?;
    Ok(notes)
}

/// Grows a forest and writes it; gives the notes.
fn write_forest(
    forest: &Forest,
    how: &HowExported<'_>,
    batch: &mut Batch,
    gauge: &Gauge<'_>,
) -> anyhow::Result<Vec<String>> {
    let plan = forest.plan(gauge)?.wanting(batch.wanted());
    // Of each tree its growth and its surface; what is left is for writing.
    let mut trees = plan.trees.len();
    let share = |trees: usize| (GROWING + DRESSING) / trees.max(1) as f64;
    gauge.begin(share(trees), None);
    let mut notes = Vec::new();
    let grown = GrownForest::grow(forest, plan, gauge, &mut |tree| {
        notes.extend(tree.said());
        trees -= 1;
        if trees > 0 {
            gauge.begin(share(trees), None);
        }
    })?;
    // How much a forest's file will be is not known before; its scenes tell the order.
    let each = vec![grown.bytes().max(1); how.planned.len()];
    write_files(&how.stage(grown.stage()), None, &each, batch, gauge, &mut notes)?;
    Ok(notes)
}

/// The files that an output is written in. Pictures show what is on screen, at whatever ages the others are.
pub fn files_of(output: Output, ages: &[&str], seasons: &[Season], levels: usize) -> Vec<Output> {
    let ages = if is_apart(output.exporter.format()) { &[] } else { ages };
    // What is a stream is refused as such.
    let at_ages = output.clone().in_ages(ages).unwrap_or_else(|| vec![output]);
    at_ages.into_iter().flat_map(|output| output.in_files(seasons, levels)).collect()
}

/// Writes all files, of one age where there are several; each takes its share of what is left of the whole, by its bytes.
fn write_files(
    stage: &Stage<'_>,
    age: Option<&str>,
    bytes: &[u64],
    batch: &mut Batch,
    gauge: &Gauge<'_>,
    notes: &mut Vec<String>,
) -> anyhow::Result<()> {
    let mut left: u64 = bytes.iter().sum();
    let mut rest = bytes.iter();
    let mut next = || {
        if let Some(&share) = rest.next() {
            gauge.begin(share as f64 / left.max(1) as f64, Some(share));
            left -= share;
        }
    };
    next();
    batch.write_age(age, stage, gauge, |told| {
        notes.extend_from_slice(told);
        next();
    })?;
    Ok(())
}

/// Refuses what the user does not expect to be there.
fn ensure_expected(output: &Output, may_replace: bool) -> anyhow::Result<()> {
    match examine(&output.path)? {
        Existing::Stream => anyhow::bail!(NO_STREAM),
        Existing::File if !may_replace => {
            anyhow::bail!("{} is there already; export again to replace it", show(&output.path))
        }
        Existing::File | Existing::Nothing => Ok(()),
    }
}

/// Opening a pipe waits until a program reads from it, and nothing would say why.
pub const NO_STREAM: &str = "that is a pipe or a device; 'linden export' writes to those";

fn absolute(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

/// Makes one gauge of all steps.
struct Gauge<'w> {
    watcher: &'w dyn Monitor,
    step: Mutex<Step>,
}

/// The step under way.
struct Step {
    /// Where it begins and ends, of 1.
    from: f64,
    to: f64,
    /// Bytes that it will write, where it writes.
    bytes: Option<u64>,
    /// Bytes of its files that are written, and of the one being written.
    before: u64,
    last: u64,
}

impl<'w> Gauge<'w> {
    fn new(watcher: &'w dyn Monitor) -> Self {
        Self { watcher, step: Mutex::new(Step { from: 0.0, to: 0.0, bytes: None, before: 0, last: 0 }) }
    }

    /// Begins the next step, which takes a share of what is left of the whole.
    fn begin(&self, share: f64, bytes: Option<u64>) {
        let mut step = self.step.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let from = step.to;
        *step = Step { from, to: from + share * (1.0 - from), bytes, before: 0, last: 0 };
    }
}

impl Monitor for Gauge<'_> {
    fn is_cancelled(&self) -> bool {
        self.watcher.is_cancelled()
    }

    fn memory_limit(&self) -> u64 {
        self.watcher.memory_limit()
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        // A thread that finds another one reporting has nothing to add.
        let Ok(mut step) = self.step.try_lock() else { return };
        let (done, total) = match step.bytes {
            Some(bytes) if stage == Phase::Write => {
                // Each file counts from 0.
                if done < step.last {
                    step.before += step.last;
                }
                step.last = done;
                (step.before + done, bytes)
            }
            _ => (done, total.unwrap_or(0)),
        };
        let share = if total == 0 { 0.0 } else { (done as f64 / total as f64).min(1.0) };
        let whole = step.from + share * (step.to - step.from);
        self.watcher.advance(stage, (whole * WHOLE as f64) as u64, Some(WHOLE));
    }
}

#[cfg(test)]
#[path = "export_tests.rs"]
mod tests;
