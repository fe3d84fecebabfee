//! Which files are looked at: those that were named, and in folders those that carry a recipe.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::formats::for_path;
use linden::Monitor;
use linden::input::{InputKind, sniff};

use super::row::{Outcome, Row};
use crate::cli::batch::listed_files;
use crate::cli::walk::files_below;
use crate::exit::sentence;
use crate::paths::show;
use crate::progress::Progress;
use crate::{reading, source};

/// Files of the same recipe in the same folder, where the files that the recipe names lie too.
pub struct Group {
    pub json: String,
    pub files: Vec<PathBuf>,
}

/// What there is to check.
#[derive(Default)]
pub struct Found {
    pub groups: Vec<Group>,
    /// What is already known not to be good.
    pub rows: Vec<Row>,
    /// Files in folders without a recipe.
    pub others: Vec<PathBuf>,
    pub listed: Listed,
    /// How many of the paths that were named are not there.
    pub absent: usize,
}

/// The files that the indices of batches list, with their lengths.
#[derive(Default)]
pub struct Listed(BTreeMap<PathBuf, u64>);

impl Listed {
    /// Rows of those of `others` that hold no recipe and should. Which pictures and libraries belong to a file is seen when
    /// its bytes are compared: none of them is missed where that was not done with all files.
    pub fn unchecked(&self, others: &[PathBuf], are_all_compared: bool) -> Vec<Row> {
        let is_listed = |path: &&PathBuf| self.0.contains_key(*path);
        let rows = others.iter().filter(is_listed).filter_map(|path| {
            let reason = match for_path(path).map(|exporter| exporter.format().holds.recipe) {
                Ok(true) => "its recipe is not in it",
                Ok(false) => "its format holds no recipe",
                Err(_) if are_all_compared => "it belongs to no file that is verified",
                Err(_) => return None,
            };
            Some(Row::new(path, Outcome::Unchecked).because(reason))
        });
        rows.collect()
    }
}

/// Looks at files and folders; each file counts once, however often it is named.
pub fn find(paths: &[PathBuf], progress: &Progress) -> anyhow::Result<Found> {
    let mut found = Found::default();
    let mut groups: BTreeMap<(PathBuf, String), BTreeSet<PathBuf>> = BTreeMap::new();
    for path in paths {
        let is_folder = path.is_dir();
        if !is_folder && matches!(path.try_exists(), Ok(false)) {
            found.absent += 1;
            found.rows.push(Row::new(path, Outcome::Missing).because("there is no such file or folder"));
            continue;
        }
        let files = if is_folder {
            files_below(path, progress, &mut |folder| found.list(folder))?
        } else {
            vec![path.clone()]
        };
        for file in files {
            progress.check()?;
            match recipe(&file, !is_folder, progress) {
                Ok(Some(json)) => {
                    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
                    groups.entry((folder, json)).or_default().insert(file);
                }
                Ok(None) if is_folder => found.others.push(file),
                Ok(None) => {
                    found.rows.push(Row::new(&file, Outcome::Unchecked).because("it carries no recipe"));
                }
                Err(error) => {
                    progress.check()?;
                    found.rows.push(Row::new(&file, Outcome::Failed).because(sentence(&error)));
                }
            }
        }
    }
    let groups = groups.into_iter();
    found.groups =
        groups.map(|((_, json), files)| Group { json, files: files.into_iter().collect() }).collect();
    Ok(found)
}

/// The recipe that a file carries, or is; what is in a folder by the way is not read for the latter.
fn recipe(path: &Path, is_named: bool, progress: &Progress) -> anyhow::Result<Option<String>> {
    let mut content = reading::open(path, progress)?;
    if let Some(json) = content.recipe(progress)? {
        return Ok(Some(json));
    }
    if !is_named {
        return Ok(None);
    }
    let bytes = content.bytes(progress)?;
    if sniff(&bytes, "").is_ok_and(|kind| kind == InputKind::Recipe) {
        let text = source::document(&bytes, &show(path), progress)?;
        return Ok(Some(text.trim().to_owned()));
    }
    Ok(None)
}

impl Found {
    /// What the index of a batch in this folder lists.
    fn list(&mut self, folder: &Path) -> anyhow::Result<()> {
        for (name, bytes) in listed_files(folder)? {
            let path = folder.join(name.split('/').collect::<PathBuf>());
            match fs::metadata(&path) {
                Ok(about) if about.len() == bytes => drop(self.listed.0.insert(path, bytes)),
                Ok(about) => {
                    let reason = format!("{} bytes, where the index lists {bytes}", about.len());
                    self.rows.push(Row::new(&path, Outcome::OtherBytes).because(reason));
                }
                Err(_) => self.rows.push(Row::new(&path, Outcome::Missing).because("the index lists it")),
            }
        }
        Ok(())
    }
}
