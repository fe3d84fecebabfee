//! The user's presets and grammars: the files of `presets/` and of the folders in it.
//!
//! Listing reads and checks documents; the meshes and point clouds that they name are read when a tree
//! is grown (see [`crate::source::resolve`], which takes an entry's path), here it is only seen to that
//! they are there. What cannot be read is listed too, with its complaint.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use linden::Monitor;
use linden::forest::ForestDocument;
use linden::input::sniff;
use linden::knob::excerpt;
use linden::lsystem::text;
use linden::preset::{Preset, SourceKind, TextPlace, builtin_file};

use super::files::{self, Existing, Readers};
use super::{Complaint, of_fault};
use crate::paths::show;
use crate::trust;

/// Larger than any document; scans are larger, but are not listed by their content.
const MAX_BYTES: u64 = 64 << 20;
/// More are no library that a person looks through.
const MAX_ENTRIES: usize = 10_000;
/// The group of what lies in `presets/` itself and names none.
const OWN: &str = "own";
/// The folder of removed presets.
const REMOVED: &str = ".removed";
/// What makes a forest, where a preset names its generator.
pub const FOREST: &str = "forest";

/// A file that may grow. Its texts are from outside: show them through `printable`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UserPreset {
    /// What [`crate::source::resolve`] takes.
    pub path: PathBuf,
    /// The file's name without its ending, as for built-in presets.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// The folder it lies in; else what the document says, else `own`.
    pub group: String,
    /// One line: what it is.
    pub summary: String,
    /// Where it comes from.
    pub source: String,
    /// Words that its document is found by.
    pub tags: Vec<String>,
    /// What makes the tree; empty for what cannot be read.
    pub generator: &'static str,
    /// Whether it can be read.
    pub state: Result<(), Complaint>,
}

/// Lists the presets and grammars in a directory (`*.toml`, `*.txt`, `*.l`) and in the folders in it,
/// by group and id. Hidden files are left out, folders in folders too. No directory, no presets.
///
/// The complaints are about directories; a file's own is with its entry. When the monitor cancels, the
/// list is what was read until then.
pub fn list(dir: &Path, monitor: &dyn Monitor) -> (Vec<UserPreset>, Vec<Complaint>) {
    let mut complaints = Vec::new();
    let mut paths = Vec::new();
    for path in names(dir, &mut complaints) {
        // A link that leads in a circle is no directory, and complained about when it is read.
        if has_ending(&path) {
            paths.push((path, None));
        } else if path.is_dir() {
            let group = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let files = names(&path, &mut complaints).into_iter().filter(|path| has_ending(path));
            paths.extend(files.map(|path| (path, Some(group.clone()))));
        }
    }
    if paths.len() > MAX_ENTRIES {
        let message = format!("has {} files, and {MAX_ENTRIES} are listed; move some away", paths.len());
        complaints.push(Complaint::new(dir, message));
        paths.truncate(MAX_ENTRIES);
    }
    let mut presets = Vec::new();
    for (path, folder) in paths {
        if monitor.is_cancelled() {
            break;
        }
        presets.push(entry(path, folder));
    }
    presets.sort_by(|a, b| (&a.group, &a.id, &a.path).cmp(&(&b.group, &b.id, &b.path)));
    (presets, complaints)
}

/// The files of an id, in the order of their names.
pub fn find(dir: &Path, id: &str) -> Vec<PathBuf> {
    if check_id(id).is_err() {
        return Vec::new();
    }
    files_of(dir).into_iter().filter(|path| path.file_stem().is_some_and(|stem| stem == id)).collect()
}

/// The ids that there are, of what can be read and of what cannot.
pub fn ids(dir: &Path) -> Vec<String> {
    let id = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    files_of(dir).into_iter().filter_map(id).collect()
}

/// The files of [`list`], by names alone: none of them is read.
fn files_of(dir: &Path) -> Vec<PathBuf> {
    let all = names(dir, &mut Vec::new());
    // What has an ending is a file to `list` too.
    let folders = all.iter().filter(|path| !has_ending(path) && path.is_dir());
    let below: Vec<PathBuf> = folders.flat_map(|folder| names(folder, &mut Vec::new())).collect();
    all.into_iter().chain(below).filter(|path| has_ending(path)).collect()
}

/// Puts a preset's file into a hidden folder beside it, which is not listed, and gives where it is; `None` when it is
/// gone already. Files that the preset needs stay where they are.
///
/// # Errors
/// Why it is still there.
pub fn put_away(path: &Path) -> Result<Option<PathBuf>, Complaint> {
    let failed = |error: std::io::Error| Complaint::new(path, format!("cannot be removed: {error}"));
    let folder = path.with_file_name(REMOVED);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    let numbered =
        |n: u32| folder.join(if n == 1 { format!("{stem}{ending}") } else { format!("{stem}-{n}{ending}") });
    if fs::symlink_metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
        return Ok(None);
    }
    fs::create_dir_all(&folder).map_err(failed)?;
    let is_free = |path: &PathBuf| fs::symlink_metadata(path).is_err();
    let kept = (1..MAX_ENTRIES as u32).map(numbered).find(is_free);
    let kept = kept.ok_or_else(|| Complaint::new(&folder, "is full; empty it"))?;
    fs::rename(path, &kept).map_err(failed)?;
    Ok(Some(kept))
}

/// Puts a file back that was [put away](put_away).
///
/// # Errors
/// Why it is still where it was put, as when there is another one in its place.
pub fn put_back(kept: &Path, path: &Path) -> Result<(), Complaint> {
    let failed = |why: String| Complaint::new(kept, format!("cannot be put back as {}: {why}", show(path)));
    if fs::symlink_metadata(path).is_ok() {
        return Err(failed("there is a file of that name now".to_owned()));
    }
    fs::rename(kept, path).map_err(|error| failed(error.to_string()))
}

/// Gives a preset another name: its file in its folder, which keeps its ending, and its document, where that has an id.
/// Gives where it is then. No other file is written over.
///
/// # Errors
/// Why it is called as before, as when there is a file of that name.
pub fn rename(path: &Path, id: &str) -> Result<PathBuf, Complaint> {
    let failed = |why: &str| Complaint::new(path, format!("cannot be renamed to '{}': {why}", excerpt(id)));
    check_id(id).map_err(failed)?;
    let to = renamed_path(path, id);
    let bytes = files::read(path, MAX_BYTES)?.ok_or_else(|| failed("it is gone"))?;
    let bytes = renamed_document(&bytes, id).map_err(|why| failed(&why))?.map_or(bytes, String::into_bytes);
    files::write(&to, &bytes, Readers::Umask, Existing::Keep).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            failed("there is a file of that name; choose another name, or remove that one first")
        }
        _ => failed(&error.to_string()),
    })?;
    if let Ok(about) = fs::metadata(path) {
        // Who may read it stays; where that cannot be set, it is as any new file.
        let _ = fs::set_permissions(&to, about.permissions());
    }
    if let Err(error) = fs::remove_file(path) {
        // One preset, not two.
        let _ = fs::remove_file(&to);
        return Err(failed(&format!("the file of the old name cannot be removed: {error}")));
    }
    Ok(to)
}

/// Where a preset's file is when it is called `id`.
pub fn renamed_path(path: &Path, id: &str) -> PathBuf {
    let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    path.with_file_name(format!("{id}{ending}"))
}

/// A document with another id, and with that for a name where the old one was its name too. `None` for what is no
/// document, like a grammar: it is called as its file is.
fn renamed_document(bytes: &[u8], id: &str) -> Result<Option<String>, String> {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(None) };
    if has_trees(text) {
        return Ok(ForestDocument::rename_toml(text, id).ok());
    }
    let Ok(mut preset) = Preset::from_toml(text) else { return Ok(None) };
    if preset.name == preset.id {
        id.clone_into(&mut preset.name);
    }
    id.clone_into(&mut preset.id);
    preset.edit_toml(text).map(Some).map_err(|error| error.to_string())
}

/// The file that one which was put away was before, by its name; `None` for any other.
pub fn before_put_away(kept: &Path) -> Option<PathBuf> {
    let folder = kept.parent()?;
    (folder.file_name()? == REMOVED).then(|| folder.with_file_name(kept.file_name().unwrap_or_default()))
}

/// What is in a directory, in order, without what is hidden.
fn names(dir: &Path, complaints: &mut Vec<Complaint>) -> Vec<PathBuf> {
    let mut failed = |error: &std::io::Error| {
        complaints.push(Complaint::new(dir, format!("cannot be listed: {error}")));
    };
    let read = match fs::read_dir(dir) {
        Ok(read) => read,
        Err(error) => {
            if error.kind() != ErrorKind::NotFound {
                failed(&error);
            }
            return Vec::new();
        }
    };
    let mut paths = Vec::new();
    for entry in read {
        match entry {
            Ok(entry) if entry.file_name().as_encoded_bytes().starts_with(b".") => {}
            Ok(entry) => paths.push(entry.path()),
            Err(error) => {
                failed(&error);
                break;
            }
        }
    }
    paths.sort();
    paths
}

/// Whether a file is a preset or a grammar by its name.
pub fn has_ending(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ["toml", "txt", "l"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

fn entry(path: PathBuf, folder: Option<String>) -> UserPreset {
    let id = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(read) = forest(&path) {
        let (name, summary, state) = match read {
            Ok(document) => (document.name, document.summary, Ok(())),
            Err(complaint) => (String::new(), String::new(), Err(complaint)),
        };
        return UserPreset {
            name: if name.is_empty() { id.clone() } else { name },
            group: folder.unwrap_or_else(|| OWN.to_owned()),
            summary,
            source: String::new(),
            tags: Vec::new(),
            generator: FOREST,
            id,
            path,
            state,
        };
    }
    let (read, state) = match read(&path, &id) {
        Ok((preset, state)) => (Some(preset), state),
        Err(complaint) => (None, Err(complaint)),
    };
    let of = |field: fn(&Preset) -> &str| read.as_ref().map(|preset| field(preset).to_owned());
    UserPreset {
        name: of(|preset| &preset.name).unwrap_or_else(|| id.clone()),
        group: folder.or_else(|| of(|preset| &preset.group)).unwrap_or_else(|| OWN.to_owned()),
        summary: of(|preset| &preset.summary).unwrap_or_default(),
        source: of(|preset| &preset.source).unwrap_or_default(),
        tags: read.as_ref().map_or_else(Vec::new, |preset| preset.tags.clone()),
        generator: read.as_ref().map_or("", |preset| preset.grows_by().id()),
        id,
        path,
        state,
    }
}

/// Reads the document of a forest; `None` where it is none.
fn forest(path: &Path) -> Option<Result<ForestDocument, Complaint>> {
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        return None;
    }
    // What cannot be read is said where presets are.
    let text = files::read_text(path, MAX_BYTES).ok().flatten().filter(|text| has_trees(text))?;
    Some(ForestDocument::parse(&text).map_err(|fault| of_fault(path, &fault)))
}

/// Whether a document lists trees, which tells a forest's from a preset's.
pub fn has_trees(text: &str) -> bool {
    text.lines().any(|line| line.trim_start().starts_with("[[tree]]"))
}

/// Reads a document as [`crate::source::resolve`] will, but for the files that it names.
fn read(path: &Path, id: &str) -> Result<(Preset, Result<(), Complaint>), Complaint> {
    let gone = || Complaint::new(path, "is gone");
    let bytes = files::read(path, MAX_BYTES)?.ok_or_else(gone)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let kind = sniff(&bytes, &name).map_err(|error| Complaint::new(path, error.to_string()))?;
    let preset = match SourceKind::from(kind) {
        SourceKind::Preset => {
            let text = files::into_text(path, bytes)?;
            Preset::from_toml(&text).map_err(|fault| of_fault(path, &fault))?
        }
        SourceKind::Recipe => {
            let text = files::into_text(path, bytes)?;
            Preset::from_json(&text).map_err(|fault| of_fault(path, &fault))?
        }
        SourceKind::Grammar => {
            let text = files::into_text(path, bytes)?;
            let parsed = text::parse(&text).map_err(|error| {
                let place = TextPlace { line: error.line, column: error.column };
                Complaint::at(path, Some(place), error.problem.to_string())
            })?;
            let mut preset = Preset::of_grammar(id, parsed.grammar, parsed.angle_deg, parsed.derivations);
            preset.summary = parsed.comments.into_iter().find(|line| !line.is_empty()).unwrap_or_default();
            return Ok((preset, Ok(())));
        }
        SourceKind::TreeParameters => {
            let text = files::into_text(path, bytes)?;
            let read = Preset::of_tree_parameters(id, &text).map_err(|fault| of_fault(path, &fault))?;
            return Ok((read.0, Ok(())));
        }
        SourceKind::Data(kind) => return Ok((Preset::of_data(id, &name, kind), Ok(()))),
    };
    let problem = |file: &str| match trust::beside(Some(path), file) {
        Err(refused) => Some(refused.to_string()),
        Ok(real) if builtin_file(file).is_some() || real.is_file() => None,
        Ok(_) => {
            let beside = path.with_file_name("").join(file);
            Some(format!("needs the file {}, which is not there", show(&beside)))
        }
    };
    let state = preset.files().into_iter().find_map(problem);
    let state = state.map_or(Ok(()), |message| Err(Complaint::new(path, message)));
    Ok((preset, state))
}

/// Why a preset was not saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The id cannot be the name of a file.
    #[error("'{0}' cannot be a preset's id: {1}; use letters, digits, '-' and '_'")]
    Id(String, &'static str),
    /// There is a preset of that id.
    #[error("there is a preset '{id}' already ({}); save under another id, or overwrite it", show(.path))]
    Exists {
        /// The id, printable.
        id: String,
        /// Its file.
        path: PathBuf,
    },
    /// It is no preset.
    #[error("{0}")]
    Document(Complaint),
    /// The file could not be written; what was there before still is.
    #[error("writing {}: {source}", show(.path))]
    Write {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
}

/// Saves a document as `ID.toml` in a directory, which is made if need be: the whole file or nothing.
/// Returns where it is.
pub fn save(dir: &Path, id: &str, toml: &str, overwrite: bool) -> Result<PathBuf, SaveError> {
    check_id(id).map_err(|why| SaveError::Id(excerpt(id), why))?;
    let path = dir.join(format!("{id}.toml"));
    // What could not be listed and grown afterwards is no preset.
    Preset::from_toml(toml).map_err(|fault| SaveError::Document(of_fault(&path, &fault)))?;
    let existing = if overwrite { Existing::Replace } else { Existing::Keep };
    match files::write(&path, toml.as_bytes(), Readers::Umask, existing) {
        Ok(()) => Ok(path),
        Err(error) if error.kind() == ErrorKind::AlreadyExists && !overwrite => {
            Err(SaveError::Exists { id: excerpt(id), path })
        }
        Err(source) => Err(SaveError::Write { path, source }),
    }
}

/// Whether an id is a file's name on every system that a preset may be copied to; else why not.
pub fn check_id(id: &str) -> Result<(), &'static str> {
    if id.is_empty() {
        return Err("it is empty");
    }
    if id.len() > 100 {
        return Err("it is too long");
    }
    if id.starts_with(['.', '-']) {
        return Err("it begins with a dot or a dash");
    }
    if id.ends_with(['.', ' ']) || id.starts_with(' ') {
        return Err("it begins or ends with a blank or a dot");
    }
    if id.chars().any(|c| "/\\:*?\"<>|".contains(c)) {
        return Err("it has characters that file names cannot have");
    }
    if linden::knob::printable(id) != id {
        return Err("it has characters that cannot be seen");
    }
    // Devices of Windows, whatever their ending.
    let stem = id.split('.').next().unwrap_or(id).to_ascii_lowercase();
    let numbered =
        |name: &str| stem.strip_prefix(name).is_some_and(|rest| matches!(rest.as_bytes(), [b'1'..=b'9']));
    if ["con", "prn", "aux", "nul"].contains(&stem.as_str()) || numbered("com") || numbered("lpt") {
        return Err("it is the name of a device");
    }
    Ok(())
}

#[cfg(test)]
#[path = "presets_tests.rs"]
mod tests;
