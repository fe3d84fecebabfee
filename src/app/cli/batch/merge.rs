//! `--merge`: what is made of all parts together. Nothing grows here.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use linden::Monitor;
use linden_exporters::ExportError;

use super::NO_MERGE;
use super::assembly::{Assembled, AssemblyKind};
use super::contact::Contact;
use super::part::{Part, ranges};
use super::plan::Plan;
use super::report::{Merging, Report};
use super::rows::{self, Row, Rows};
use super::table::Table;
use crate::cli::timings::File;
use crate::exit::{sentence, usage};
use crate::paths::show;
use crate::progress::Progress;

/// What `--merge` writes beside the index.
#[derive(Args)]
pub struct Merged {
    /// With --merge: a contact sheet (.png, .jpg, .webp) of at most 240 trees, evenly chosen. The manifest's formats
    /// must have "thumbnail"
    #[arg(long, value_name = "FILE", requires = "merge", conflicts_with_all = NO_MERGE)]
    sheet: Option<PathBuf>,

    /// With --merge: one USD file (.usda) that names those of all trees as payloads, side by side or by --places
    #[arg(long, value_name = "FILE", requires = "merge", conflicts_with_all = NO_MERGE)]
    usd: Option<PathBuf>,

    /// With --merge: a tileset of 3D Tiles (.json) over the glTF files of all trees, side by side or by --places
    #[arg(long, value_name = "FILE", requires = "merge", conflicts_with_all = NO_MERGE)]
    tiles: Option<PathBuf>,

    /// For --usd and --tiles: where trees stand. CSV with the columns x and z (metres, Y is up), and if they are there y,
    /// turn (degrees), scale, tree (its number), source
    #[arg(long, value_name = "TABLE", requires = "merge", conflicts_with_all = NO_MERGE)]
    places: Option<PathBuf>,
}

/// All rows, and what is known of the rest.
#[derive(Default)]
struct Found<'a> {
    index: String,
    /// Trees whose files are all there.
    whole: Vec<&'a Row>,
    failed: usize,
    missing: Vec<usize>,
}

impl Merged {
    /// Writes the index of a folder, and what is asked for of all its trees or a part of them.
    pub fn write(
        &self,
        plan: &Plan,
        part: Option<&Part>,
        mut report: Report<'_>,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        let out = report.out;
        self.check(part.is_some())?;
        if !out.is_dir() {
            let folder = show(out);
            return Err(usage(format!(
                "merging the trees in {folder}: there is no such folder; leave --merge out to grow them there first"
            )));
        }
        let table = self.places.as_deref().map(|path| Table::read(path, plan, progress)).transpose()?;
        let rows = Rows::read(out)?;
        let found = Found::of(plan, &rows, out, progress)?;
        let numbers: Option<BTreeSet<usize>> = part.map(|part| part.numbers().collect());
        let is_shown = |row: &&Row| numbers.as_ref().is_none_or(|numbers| numbers.contains(&row.index));
        let shown: Vec<&Row> = found.whole.iter().copied().filter(is_shown).collect();
        // What cannot be written is found before anything is.
        let sheet = self.sheet.as_deref().map(|path| Contact::new(path, &shown)).transpose()?;
        let assembled = [(AssemblyKind::Usd, &self.usd), (AssemblyKind::Tiles, &self.tiles)];
        let assembled = assembled.into_iter().filter_map(|(kind, path)| Some((kind, path.as_deref()?)));
        let sources = plan.files();
        let assembled = assembled
            .map(|(kind, path)| Assembled::new(kind, path, out, &shown, table.as_ref(), &sources))
            .collect::<anyhow::Result<Vec<_>>>()?;
        rows::write_index(out, &found.index)?;
        let path = out.join(rows::INDEX);
        let mut said = format!("{} of {} trees in {}\n", found.whole.len(), plan.len(), show(&path));
        if let Some(sheet) = sheet {
            said += &sheet.write(out, progress)?;
        }
        for assembled in assembled {
            said += &assembled.write(progress)?;
        }
        progress.clear();
        if report.is_json {
            let files =
                std::iter::once(&path).chain([&self.sheet, &self.usd, &self.tiles].into_iter().flatten());
            let files = files.map(|path| {
                let bytes = path.metadata().with_context(|| format!("looking at {}", show(path)))?.len();
                Ok(File { path: show(path), bytes, kept: false })
            });
            let files = files.collect::<anyhow::Result<_>>()?;
            let (whole, failed, missing) = (found.whole.len(), found.failed, found.missing.clone());
            report.merged(Merging { whole, failed, missing, files })?;
        } else {
            super::super::print(&said)?;
        }
        found.verdict()
    }

    fn check(&self, is_part: bool) -> anyhow::Result<()> {
        let has_assembly = self.usd.is_some() || self.tiles.is_some();
        if self.places.is_some() && !has_assembly {
            return Err(usage("--places says where trees of --usd and --tiles stand: name one of these too"));
        }
        if is_part && self.sheet.is_none() && !has_assembly {
            return Err(usage(
                "--merge makes the index of all trees; --only is for those of --sheet, --usd and --tiles",
            ));
        }
        let files = [&self.sheet, &self.usd, &self.tiles];
        for path in files.into_iter().flatten() {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
                return Err(ExportError::NoFolder { path: path.clone(), folder: folder.to_owned() }.into());
            }
        }
        Ok(())
    }
}

impl<'a> Found<'a> {
    fn of(plan: &Plan, rows: &'a Rows, out: &Path, progress: &Progress) -> anyhow::Result<Self> {
        let mut found = Self::default();
        for number in 0..plan.len() {
            progress.check()?;
            let unreadable;
            let row = match plan.tree(number) {
                Ok(tree) => {
                    let whole = rows.whole(&tree, out);
                    found.whole.extend(whole);
                    whole.or_else(|| rows.failure(&tree))
                }
                Err(error) => {
                    unreadable = Row::unreadable(number, sentence(&error));
                    Some(&unreadable)
                }
            };
            match row {
                Some(row) => {
                    found.failed += usize::from(row.error.is_some());
                    found.index += &row.line_of_index();
                }
                None => found.missing.push(number),
            }
        }
        Ok(found)
    }

    fn verdict(&self) -> anyhow::Result<()> {
        match (self.failed, self.missing.as_slice()) {
            (0, []) => Ok(()),
            (failed, []) => bail!("{failed} trees failed; the index says why"),
            (failed, missing) => {
                bail!("{failed} trees failed, {} are missing: --only {}", missing.len(), ranges(missing))
            }
        }
    }
}
