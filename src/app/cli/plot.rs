//! `linden export PLOT -o FOLDER/`: each tree that an input tells apart, in files of its own, with one table of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow, bail};
use linden::dress::levels;
use linden::grow::grow;
use linden::monitor::Holding;
use linden::preset::InputTrees;
use linden::recipe::Recipe;
use linden::report::{NUMBERS, Reading, Report};
use linden::texture::DrawnPictures;
use linden_exporters::{Written, make_folders};

use super::crew::{Crew, Share, room_for_pictures};
use super::outputs::{Files, Outputs};
use super::placing::explained;
use super::scene::SceneFlags;
use super::timings::{File, Subject, Telling, Timings};
use crate::cache;
use crate::exit::sentence;
use crate::paths::show;
use crate::progress::Progress;
use crate::source::Source;

/// The table's name within the folder.
const TABLE: &str = "trees.csv";

/// The format of trees where none is named.
pub const USUAL_FORMAT: &str = "glb";

/// Trees of one input and how they are written.
pub struct Plot<'a> {
    pub source: Source,
    pub trees: InputTrees,
    pub folder: &'a Path,
    pub outputs: &'a Outputs,
    /// `FORMAT.OPTION` and value.
    pub of_formats: &'a [(String, String)],
    /// Knobs that were turned.
    pub turned: Vec<&'a str>,
    pub scene: &'a SceneFlags,
    /// What is said of them.
    pub telling: &'a Telling,
}

/// What became of a tree.
struct Row {
    number: u32,
    /// Points, cylinders: what it is made of.
    parts: usize,
    written: anyhow::Result<PlotTree>,
}

/// A tree that was written.
struct PlotTree {
    report: Report,
    /// In the input's axes and units.
    foot: Option<[f64; 3]>,
    files: Vec<Written>,
    notes: Vec<String>,
}

impl Plot<'_> {
    /// Grows and writes all of them, one on each thread. A tree that fails is noted in the table and stops no other.
    ///
    /// # Errors
    /// What hinders all of them; at the end that some failed.
    pub fn write(mut self, mut timings: Timings, progress: &Progress) -> anyhow::Result<()> {
        timings.lap("read");
        let drawn = Arc::new(cache::pictures(DrawnPictures::new(room_for_pictures(progress))));
        self.source.recipe = self.source.recipe.drawn_into(&drawn);
        let table = self.folder.join(TABLE);
        let folders = make_folders(&table).map_err(explained)?;
        // What is wrong with formats or options is said once, before anything grows.
        let (batch, notes) = self.batch(self.trees.numbers[0].0)?;
        super::notes(&notes, progress);
        self.telling.ensure_free(batch.streams())?;
        drop(batch);
        let count = self.trees.numbers.len();
        let InputTrees { told_by, .. } = &self.trees;
        let said = match count {
            1 => format!("{told_by} tells one tree from other points; it is grown by itself"),
            _ => format!("{told_by} tells {count} trees apart; each is grown by itself"),
        };
        super::notes(&[said], progress);
        let mut rows = Vec::new();
        let crew = Crew::of_threads(progress);
        let crew = Crew { memory: crew.memory - room_for_pictures(progress), in_order: true, ..crew };
        let work = |at: usize, share: &Share<'_>| {
            let (number, parts) = self.trees.numbers[at];
            Row { number, parts, written: caught(|| self.tree(number, share, progress)) }
        };
        crew.run(0..count, work, |row| {
            if let Err(error) = &row.written {
                super::notes(&[format!("tree {}: {}", row.number, sentence(error))], progress);
            }
            rows.push(row);
            Ok(true)
        })?;
        let writing = || format!("writing {}", show(&table));
        let text = self.table(&rows).with_context(writing)?;
        linden_exporters::write_file(&table, &text, 0o666, true).with_context(writing)?;
        folders.keep();
        progress.clear();
        timings.lap("grow");
        let written = rows.iter().filter_map(|row| row.written.as_ref().ok());
        let mut files = File::all(&written.flat_map(|tree| tree.files.clone()).collect::<Vec<_>>());
        files.push(File { path: show(&table), bytes: text.len() as u64, kept: false });
        let subject = Subject::of([self.source.shown.clone()]);
        let failed = rows.iter().filter(|row| row.written.is_err()).count();
        let line = if failed == 0 { self.line(&table) } else { String::new() };
        self.telling.tell_in_a_line(&timings, &subject, &files, &line)?;
        if failed > 0 {
            bail!("{failed} of {count} trees failed; {} says why", show(&table));
        }
        Ok(())
    }

    /// What was written, in place of a list of files.
    fn line(&self, table: &Path) -> String {
        let count = self.trees.numbers.len();
        let trees = if count == 1 { "tree" } else { "trees" };
        format!("{count} {trees} written into {}, with {}\n", show(self.folder), show(table))
    }

    fn recipe(&self, number: u32) -> anyhow::Result<Recipe> {
        let mut recipe = self.source.recipe.clone();
        recipe.preset.set(self.trees.knob, &number.to_string())?;
        Ok(recipe)
    }

    /// The files of a tree, tried, with notes about them.
    fn batch(&self, number: u32) -> anyhow::Result<(linden_exporters::Batch, Vec<String>)> {
        let levels = self.source.recipe.preset.dressing.detail.levels();
        let files = self.source.files.clone();
        self.outputs.opened(&number.to_string(), "", self.of_formats, Files::in_levels(levels), files)
    }

    fn tree(&self, number: u32, share: &Share<'_>, progress: &Progress) -> anyhow::Result<PlotTree> {
        let (mut batch, _) = self.batch(number)?;
        let recipe = self.recipe(number)?.wanting(batch.wanted());
        let grown = grow(&recipe, share)?;
        let foot = grown.foot;
        let mut notes = grown.notes.clone();
        let report = Report::of(&recipe, &grown, share)?;
        let shapes = levels(&recipe, &grown, share)?;
        notes.extend(shapes.notes.iter().cloned());
        drop(grown);
        let stage = shapes.stage().turned_by(self.turned.iter().copied());
        let stage = self.scene.around(stage, progress)?;
        let holding = Holding::new(share, recipe.inputs.bytes());
        batch.write(&stage, &holding, |said| notes.extend(said.iter().cloned()))?;
        let files = batch.commit()?;
        Ok(PlotTree { report, foot: foot.map(|foot| foot.to_array()), files, notes })
    }

    /// CSV (RFC 4180), a row for each tree: its number, parts, foot, files, the numbers of `linden stats`, and what was
    /// said of it.
    fn table(&self, rows: &[Row]) -> anyhow::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let parts = format!("input_{}", self.trees.made_of);
        let before = ["number", &parts, "foot_x", "foot_y", "foot_z"].into_iter();
        let numbers = NUMBERS.iter().map(|number| number.name);
        writer.write_record(before.chain(numbers).chain(["files", "notes", "error"]))?;
        for Row { number, parts, written } in rows {
            let grown = written.as_ref().ok();
            let foot = grown.and_then(|grown| grown.foot);
            let foot = (0..3).map(|axis| foot.map_or_else(String::new, |foot| format!("{:.3}", foot[axis])));
            let reading = |number: &linden::report::Number| {
                grown.map_or(Reading::Nothing, |grown| (number.reading)(&grown.report)).field()
            };
            let name = |path: &PathBuf| {
                path.strip_prefix(self.folder).unwrap_or(path).to_string_lossy().into_owned()
            };
            let files: Vec<String> = grown
                .map_or_else(Vec::new, |grown| grown.files.iter().map(|file| name(&file.path)).collect());
            let notes = grown.map_or_else(String::new, |grown| grown.notes.join("; "));
            let error = written.as_ref().err().map_or_else(String::new, sentence);
            let record = [number.to_string(), parts.to_string()].into_iter().chain(foot);
            let record = record.chain(NUMBERS.iter().map(reading)).chain([files.join(" "), notes, error]);
            writer.write_record(record)?;
        }
        Ok(writer.into_inner()?)
    }
}

/// Does a piece of work; a panic in it is an error like another. A fault of the program that one cloud in a hundred shows must
/// not cost the other trees of a plot, which take hours, and their table. Nothing broken is left behind: what a tree changes is
/// its own, what trees share are caches that take in nothing before it is whole, and files that were begun are not committed.
fn caught<T>(work: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        let said = text.map_or_else(String::new, |text| format!(" ({text})"));
        Err(anyhow!(
            "a fault of linden stopped it{said}; report it with this tree's points, and try scan_radius=pipe"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_the_error_of_one_tree() {
        let work =
            |number: i32| caught(|| if number == 2 { panic!("min > max at {number}") } else { Ok(number) });
        let rows: Vec<anyhow::Result<i32>> = (1..=3).map(work).collect();
        assert_eq!(rows.iter().filter_map(|row| row.as_ref().ok()).collect::<Vec<_>>(), [&1, &3]);
        let error = rows[1].as_ref().unwrap_err().to_string();
        assert!(error.contains("a fault of linden") && error.contains("min > max at 2"), "{error}");
        // On threads of a pool, too.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let of_pool = pool.install(|| caught(|| Ok(rayon::join(|| 1_i32, || -> i32 { panic!("there") }))));
        assert!(of_pool.unwrap_err().to_string().contains("(there)"));
    }
}
