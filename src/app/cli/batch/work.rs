//! Grows and writes trees, some at a time.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use linden::Monitor;
use linden::dress::levels;
use linden::grow::grow;
use linden::monitor::Holding;
use linden_exporters::{Batch, Bundle, Output, WindLoop};

use super::plan::{Plan, Tree};
use super::rows::{PICTURES, Row, WrittenFile};
use crate::cli::crew::{Crew, Share, room_for_pictures};
use crate::exit::sentence;
use crate::progress::Progress;

/// What is to be done.
pub struct Work<'a> {
    pub plan: &'a Plan,
    pub numbers: &'a [usize],
    pub out: &'a Path,
    /// Whether to wait for the disk.
    pub sync: bool,
}

impl Work<'_> {
    /// Does it, and gives each row to `take` as it comes, until that says false or fails.
    pub fn run(
        &self,
        jobs: Option<usize>,
        progress: &Progress,
        take: impl FnMut(Row) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let crew = Crew::of_threads(progress);
        let memory = crew.memory - room_for_pictures(progress);
        let crew = Crew { jobs: jobs.unwrap_or(crew.jobs), memory, ..crew };
        crew.run(0..self.numbers.len(), |at, share| self.tree(self.numbers[at], share), take)
    }

    fn tree(&self, number: usize, share: &Share<'_>) -> Row {
        let tree = match self.plan.tree(number) {
            Ok(tree) => tree,
            Err(error) => return Row::unreadable(number, sentence(&error)),
        };
        let mut row = Row::of(&tree);
        let started = Instant::now();
        if let Err(error) = self.write(&tree, &mut row, share) {
            row.files.clear();
            row.error = Some(sentence(&error).replace(['\n', '\r'], " "));
        }
        row.seconds = Some((started.elapsed().as_secs_f64() * 1e4).round() / 1e4);
        row
    }

    fn write(&self, tree: &Tree, row: &mut Row, share: &Share<'_>) -> anyhow::Result<()> {
        let count = tree.recipe.preset.dressing.detail.levels();
        let outputs: Vec<Output> = tree
            .outputs
            .iter()
            .map(|(exporter, options, path)| Output::new(*exporter, options.clone(), self.out.join(path)))
            .collect();
        let notes: Vec<String> =
            outputs.iter().filter_map(|output| output.note_on_levels(count)).map(str::to_owned).collect();
        let outputs: Vec<Output> = outputs.into_iter().flat_map(|output| output.in_levels(count)).collect();
        for folder in outputs.iter().filter_map(|output| output.path.parent()) {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("making the folder {}", crate::paths::show(folder)))?;
        }
        let bundle = |output: &Output| {
            let bundle = Bundle::create(&output.path)?;
            let bundle = bundle.with_pictures_in(&self.out.join(PICTURES), &format!("../{PICTURES}"));
            Ok(if self.sync { bundle } else { bundle.unsynced() })
        };
        let mut batch = Batch::open(outputs, tree.files.clone(), bundle)?;
        let turned = || tree.set.keys().map(String::as_str);
        row.note(tree.recipe.preset.idle_notes(turned()));
        row.note(notes);
        let grown = grow(&tree.recipe, share)?;
        row.note(grown.notes.iter().cloned());
        row.skeleton_hash = Some(format!("{:032x}", grown.skeleton.hash()));
        row.nodes = Some(grown.skeleton.positions.len());
        row.height_m = Some(grown.skeleton.measures().height_m);
        let levels = levels(&tree.recipe, &grown, share)?;
        drop(grown);
        let holding = Holding::new(share, tree.recipe.inputs.bytes());
        row.note(levels.notes.iter().cloned());
        let stage = levels.stage().turned_by(turned());
        row.bounds_m = stage.bounds().map(|bounds| [bounds.min.to_array(), bounds.max.to_array()]);
        let sways = batch.formats().iter().any(|(format, _)| format.holds.wind);
        let wind_loop = WindLoop::of_stage(&stage).filter(|_| sways);
        row.wind_loop = wind_loop.map(|wind| [wind.frames, wind.frames_per_second]);
        batch.write(&stage, &holding, |notes| row.note(notes.iter().cloned()))?;
        share.check()?;
        for file in batch.commit()? {
            let within = file.path.strip_prefix(self.out).unwrap_or(&file.path);
            let parts: Vec<_> = within.iter().map(|part| part.to_string_lossy()).collect();
            row.files.push(WrittenFile { path: parts.join("/"), bytes: file.bytes, kept: file.kept });
        }
        // Pictures come last and once, in an order that does not depend on who wrote them.
        row.files.sort_by_cached_key(|file| file.shared().map(str::to_owned));
        row.files.dedup_by(|a, b| a.path == b.path);
        Ok(())
    }
}
