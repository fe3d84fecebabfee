//! What is known of each tree: rows of JSON in `parts`, a file for each call, and the index over them.

use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::plan::Tree;
use crate::paths::show;

/// The index over all parts.
pub const INDEX: &str = "index.jsonl";
const PARTS: &str = "parts";
/// The folder of the pictures of all trees, within the output folder.
pub const PICTURES: &str = "pictures";

/// What became of a tree.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Row {
    pub index: usize,
    pub source: String,
    pub seed: u64,
    /// As the manifest names it; none where it names none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub age: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub set: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub define: BTreeMap<String, String>,
    /// The addresses of all main files: which recipe, by which linden, in which formats.
    pub key: String,
    #[serde(default)]
    pub files: Vec<WrittenFile>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skeleton_hash: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nodes: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// The least and the largest corner of a box around the whole tree; none where nothing is seen of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounds_m: Option<[[f32; 3]; 2]>,
    /// The last frame of its loop of wind, and frames a second; none where it does not sway.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind_loop: Option<[u32; 2]>,
    /// What the user should know about it: what has no effect, what its formats leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// How long it took; in parts alone, since it differs from run to run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// A file of a tree, pictures beside main files too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrittenFile {
    /// Within the output folder, with slashes.
    pub path: String,
    pub bytes: u64,
    /// Whether it was there before; of this call alone.
    #[serde(skip)]
    pub kept: bool,
}

impl WrittenFile {
    /// Where it lies among the pictures that trees share; `None` for the tree's own files.
    pub fn shared(&self) -> Option<&str> {
        self.path.strip_prefix(PICTURES)?.strip_prefix('/')
    }
}

impl Row {
    /// A row of a tree of which nothing is known yet.
    pub fn of(tree: &Tree) -> Self {
        Self {
            index: tree.index,
            source: tree.source.clone(),
            seed: tree.recipe.preset.seed(),
            age: tree.age.clone(),
            set: tree.set.clone(),
            define: tree.define.clone(),
            key: key(tree),
            ..Self::default()
        }
    }

    /// The main file that has the first of these endings that there is.
    pub fn main_file(&self, endings: &[&str]) -> Option<&str> {
        let of = |ending: &&str| self.key.split(' ').find(|path| path.rsplit('.').next() == Some(ending));
        endings.iter().find_map(of)
    }

    /// Notes each of these once.
    pub fn note(&mut self, notes: impl IntoIterator<Item = String>) {
        for note in notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// A row of a tree that no recipe was made of.
    pub fn unreadable(index: usize, error: String) -> Self {
        Self { index, error: Some(error), ..Self::default() }
    }

    fn line(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Without what differs from run to run.
    pub fn line_of_index(&self) -> String {
        let row = Self { seconds: None, ..self.clone() };
        // Numbers and texts have no way to fail.
        row.line().unwrap_or_default()
    }
}

fn key(tree: &Tree) -> String {
    tree.outputs.iter().map(|(_, _, path)| path.as_str()).collect::<Vec<_>>().join(" ")
}

/// Rows of all parts, by number: those that say files, and those that say an error.
#[derive(Default)]
pub struct Rows {
    written: HashMap<usize, Vec<Row>>,
    failed: HashMap<usize, Vec<Row>>,
}

impl Rows {
    /// Reads all parts of an output folder. A line that was cut off says nothing.
    pub fn read(out: &Path) -> anyhow::Result<Self> {
        let folder = out.join(PARTS);
        let mut rows = Self::default();
        if !folder.is_dir() {
            return Ok(rows);
        }
        let reading = || format!("reading {}", show(&folder));
        let mut paths: Vec<PathBuf> = Vec::new();
        for entry in fs::read_dir(&folder).with_context(reading)? {
            paths.push(entry.with_context(reading)?.path());
        }
        paths.sort_unstable();
        for path in paths.iter().filter(|path| path.extension().is_some_and(|ending| ending == "jsonl")) {
            let text = fs::read_to_string(path).with_context(|| format!("reading {}", show(path)))?;
            for row in text.split_inclusive('\n').filter_map(|line| serde_json::from_str::<Row>(line).ok()) {
                let list = if row.error.is_none() { &mut rows.written } else { &mut rows.failed };
                list.entry(row.index).or_default().push(row);
            }
        }
        Ok(rows)
    }

    /// The row of a tree whose files are all there.
    pub fn whole(&self, tree: &Tree, out: &Path) -> Option<&Row> {
        let key = key(tree);
        let is_there = |file: &WrittenFile| {
            fs::metadata(out.join(&file.path)).is_ok_and(|found| found.len() == file.bytes)
        };
        let rows = self.written.get(&tree.index)?;
        rows.iter().find(|row| row.key == key && row.files.iter().all(is_there))
    }

    /// The last row that says why a tree failed.
    pub fn failure(&self, tree: &Tree) -> Option<&Row> {
        let key = key(tree);
        self.failed.get(&tree.index)?.iter().rfind(|row| row.key == key)
    }
}

/// The files that the index of an output folder lists, or where there is none its parts, with their lengths; none for
/// a folder that no batch wrote.
pub fn listed_files(out: &Path) -> anyhow::Result<BTreeMap<String, u64>> {
    let path = out.join(INDEX);
    let rows: Vec<Row> = if path.is_file() {
        let text = fs::read_to_string(&path).with_context(|| format!("reading {}", show(&path)))?;
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    } else {
        Rows::read(out)?.written.into_values().flatten().collect()
    };
    Ok(rows.into_iter().flat_map(|row| row.files).map(|file| (file.path, file.bytes)).collect())
}

/// The part that this call writes, a line at a time. Each call has a file of its own, so that no two get into each
/// other's lines.
pub struct Journal {
    file: File,
    shown: String,
}

impl Journal {
    pub fn begin(out: &Path) -> anyhow::Result<Self> {
        let folder = out.join(PARTS);
        fs::create_dir_all(&folder).with_context(|| format!("making the folder {}", show(&folder)))?;
        let process = std::process::id();
        for try_number in 0_u32.. {
            let path = folder.join(format!("part-{process}-{try_number}.jsonl"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Self { file, shown: show(&path) }),
                // Of another machine, or of a process long ago.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error).with_context(|| format!("making {}", show(&path))),
            }
        }
        anyhow::bail!("no name is left for a part in {}", show(&folder))
    }

    pub fn write(&mut self, row: &Row) -> anyhow::Result<()> {
        self.file.write_all(row.line()?.as_bytes()).with_context(|| format!("writing {}", self.shown))
    }
}

/// Writes the index, whole or not at all.
pub fn write_index(out: &Path, text: &str) -> anyhow::Result<()> {
    let path = out.join(INDEX);
    let writing = || format!("writing {}", show(&path));
    linden_exporters::write_file(&path, text.as_bytes(), 0o666, true).with_context(writing)
}
