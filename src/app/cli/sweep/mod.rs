//! `linden sweep`: many trees of one source, a row of numbers each.

mod effects;
mod rows;
mod work;

use std::io::IsTerminal;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use linden::knob::Kind;
use linden::manifest::values;
use linden::preset::knob_named;
use linden::recipe::Recipe;

use self::effects::Effects;
use self::rows::{Existing, Opened, Table, TableKind};
use super::GrowArgs;
use super::placing::is_dash;
use crate::exit::usage;
use crate::progress::Progress;
use crate::source;

/// The most trees of one sweep.
const MOST: usize = 10_000_000;

/// Grow and measure a source with all combinations of some values, a row of a table each
///
/// --set and --define take a range from:to:step (inclusive, like 0.5:0.9:0.1), a list a,b,c, or one value.
/// The columns are those of 'linden stats', which 'linden schema --stats' defines. A knob, a constant or seeds that
/// change nothing in any tree are named at the end.
#[derive(Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct Sweep {
    #[command(flatten)]
    growing: GrowArgs,

    #[command(flatten)]
    budget: super::Budget,

    /// So many trees of each combination, with the seed and those that follow
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: u64,

    /// Write this table: .csv, or .jsonl for a JSON object a line; - is standard output, as CSV
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Keep the rows that the file has already, and add those that are missing
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,

    /// Begin a file anew that is there already
    #[arg(long)]
    overwrite: bool,

    /// Stop at the first tree that fails; without, its row says why, and the exit code is 1 at the end
    #[arg(long)]
    fail_fast: bool,

    /// With columns for the seconds that each tree took, which differ from run to run
    #[arg(long)]
    timings: bool,
}

/// What is varied.
struct Axis {
    /// The column.
    column: String,
    what: Varied,
    values: Vec<String>,
}

enum Varied {
    /// A constant of the grammar.
    Constant(String),
    Knob(String),
}

impl Varied {
    /// The name of the constant or knob.
    fn name(&self) -> &str {
        match self {
            Self::Constant(name) | Self::Knob(name) => name,
        }
    }
}

/// One tree of a sweep.
#[derive(Clone)]
pub struct Item {
    /// From 1.
    number: usize,
    /// A value for each axis.
    values: Vec<String>,
    seed: u64,
}

impl Item {
    /// Its key columns: number, values, seed.
    fn keys(&self) -> impl Iterator<Item = String> {
        let values = self.values.iter().cloned();
        std::iter::once(self.number.to_string()).chain(values).chain([self.seed.to_string()])
    }
}

/// All trees of a sweep, in their order: the last axis runs fastest, then seeds.
struct Plan {
    base: Recipe,
    axes: Vec<Axis>,
    seeds: u64,
}

impl Plan {
    fn len(&self) -> usize {
        let trees = |count: usize, axis: &Axis| count.saturating_mul(axis.values.len());
        self.axes.iter().fold(usize::try_from(self.seeds).unwrap_or(usize::MAX), trees)
    }

    /// The names of the key columns.
    fn keys(&self) -> Vec<String> {
        let axes = self.axes.iter().map(|axis| axis.column.clone());
        std::iter::once("item".to_owned()).chain(axes).chain(["seed".to_owned()]).collect()
    }

    fn item(&self, index: usize) -> Item {
        let seeds = self.seeds as usize;
        let (mut rest, step) = (index / seeds, index % seeds);
        let mut values = Vec::with_capacity(self.axes.len());
        for axis in self.axes.iter().rev() {
            values.push(axis.values[rest % axis.values.len()].clone());
            rest /= axis.values.len();
        }
        values.reverse();
        Item { number: index + 1, values, seed: self.base.preset.seed().wrapping_add(step as u64) }
    }

    /// The recipe of an item.
    fn recipe(&self, item: &Item) -> anyhow::Result<Recipe> {
        let mut recipe = self.base.clone();
        for (axis, value) in self.axes.iter().zip(&item.values) {
            axis.turn(&mut recipe, value)?;
        }
        recipe.preset.set_seed(item.seed);
        Ok(recipe)
    }
}

impl Axis {
    fn turn(&self, recipe: &mut Recipe, value: &str) -> anyhow::Result<()> {
        match &self.what {
            Varied::Constant(name) => recipe.preset.define(name, value).map_err(usage),
            Varied::Knob(name) => recipe.preset.set(name, value).map_err(usage),
        }
    }
}

/// Whether commas belong to a knob's values.
fn is_list(name: &str) -> bool {
    let has_commas = |kind: Kind| {
        matches!(
            kind,
            Kind::Vector { .. }
                | Kind::Profile { .. }
                | Kind::Reals { .. }
                | Kind::Words(_)
                | Kind::Sequence { .. }
                | Kind::Colors { .. }
        )
    };
    knob_named(name).is_some_and(|knob| has_commas(knob.kind))
}

impl Sweep {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let kind = match TableKind::of(&self.output) {
            Some(kind) => kind,
            None if is_dash(&self.output) => TableKind::Csv,
            None => {
                let shown = crate::paths::show(&self.output);
                return Err(usage(format!("{shown}: a table's name ends in .csv or .jsonl")));
            }
        };
        let plan = self.plan(&progress)?;
        let trees = plan.len();
        if trees > MOST {
            return Err(usage(format!("{trees} trees are more than {MOST}; take fewer values")));
        }
        let keys = plan.keys();
        let header = kind.header(&keys, self.timings);
        let existing = match (self.resume, self.overwrite) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Replace,
            _ => Existing::Keep,
        };
        let expected = (0..trees).map(|index| {
            let item = plan.item(index);
            let recipe = plan.recipe(&item).map_or_else(|_| plan.base.to_line(), |recipe| recipe.to_line());
            (item, recipe)
        });
        let Opened { mut table, done, mut failed } =
            Table::open(&self.output, kind, (&keys, &header), existing, expected)?;
        let work = work::Work { plan: &plan, first: done };
        // Of rows that were there already nothing is known any more.
        let mut effects = (done == 0).then(|| Effects::of(&plan));
        let mut stopped = None;
        let on_screen = is_dash(&self.output) && std::io::stdout().is_terminal();
        work.run(&progress, |item, row, times| {
            let line = kind.line(&keys, item, &row, self.timings.then_some(times));
            if on_screen {
                progress.beside(|| table.write(&line))?;
            } else {
                table.write(&line)?;
            }
            if let Some(effects) = &mut effects {
                effects.take(row.measured.as_ref().ok());
            }
            if let Err(error) = row.measured {
                failed += 1;
                let said = format!("tree {}: {error}", item.number);
                if self.fail_fast {
                    stopped = Some(said);
                    return Ok(false);
                }
                super::notes(&[said], &progress);
            }
            Ok(true)
        })?;
        table.finish()?;
        progress.clear();
        if stopped.is_none() {
            super::notes(&effects.map_or_else(Vec::new, |effects| effects.notes()), &progress);
        }
        match (stopped, failed) {
            (Some(said), _) => bail!("{said}"),
            (None, 0) => Ok(()),
            (None, failed) => bail!("{failed} of {trees} trees failed; the column 'error' says why"),
        }
    }

    /// Reads the source, and checks each value by itself.
    fn plan(&self, progress: &Progress) -> anyhow::Result<Plan> {
        let (files, settings): (Vec<_>, Vec<_>) = super::pairs(&self.growing.settings)?
            .into_iter()
            .partition(|(name, _)| source::is_file_key(name));
        let fixed: Vec<_> = files.into_iter().chain(self.budget.pair()).collect();
        let mut found = source::resolve(&self.growing.source, &fixed, progress)?;
        if crate::paths::is_one_of(&self.output, &found.files) {
            let shown = crate::paths::show(&self.output);
            return Err(usage(format!("{shown}: the tree is grown from that file; choose another name")));
        }
        super::notes(&found.notes, progress);
        if let Some(age) = &self.growing.age {
            super::ages::ensure_one_age("--age", &settings)?;
            found = super::ages::at(&found, age, &fixed)?;
        }
        let mut base = found.recipe;
        for edit in &self.growing.edits {
            base.preset.edit(edit).map_err(usage)?;
        }
        if let Some(seed) = self.growing.seed {
            base.preset.set_seed(seed);
        }
        let mut axes = Vec::new();
        for (name, text) in super::defines(&self.growing.defines)? {
            let values =
                values::values(&text).map_err(|problem| usage(format!("--define {name}: {problem}")))?;
            axes.push(Axis { column: format!("define.{name}"), what: Varied::Constant(name), values });
        }
        for (name, text) in settings {
            if name == "seed" {
                return Err(usage("seeds are varied by --seed N, the first, and --seeds N, how many"));
            }
            let values = if is_list(&name) { Ok(vec![text]) } else { values::values(&text) };
            let values = values.map_err(|problem| usage(format!("--set {name}: {problem}")))?;
            axes.push(Axis { column: format!("set.{name}"), what: Varied::Knob(name), values });
        }
        for (i, axis) in axes.iter().enumerate() {
            if axes[..i].iter().any(|other| other.column == axis.column) {
                return Err(usage(format!(
                    "{} is varied twice; name all of its values at once",
                    axis.column
                )));
            }
        }
        // Values that no tree can have are mistakes of the command line. Others of the same line may have to stand
        // first: a knob that only a certain crown has.
        for axis in &axes {
            for value in &axis.values {
                let mut tried = base.clone();
                for other in &axes {
                    let value = if other.column == axis.column { Some(value) } else { other.values.first() };
                    if let Some(value) = value {
                        other.turn(&mut tried, value)?;
                    }
                }
            }
        }
        Ok(Plan { base, axes, seeds: self.seeds })
    }
}
