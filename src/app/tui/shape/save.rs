//! A tree saved as a preset of the user's, with the files that it needs.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use linden::Quiet;
use linden::knob::excerpt;
use linden::preset::{Preset, builtin, builtin_file};
use linden::recipe::{Input, Recipe};
use linden_exporters::{Bundle, ExportError, commit_all};

use crate::config::files::{self, Existing, Readers};
use crate::config::presets;
use crate::paths::{self, expand, show};
use crate::reading;
use crate::trust;
use crate::tui::merge::merged;
use crate::tui::model::Model;
use crate::tui::tree::TreePlace;

/// No document that people write is larger.
const MOST_BYTES: u64 = 16 << 20;

/// What saving proposes for what has an id and comes from a place, a tree or a forest: one of the user's keeps its id,
/// an opened document its path; of any other it is the id of a copy, with the first number that is free.
pub fn proposed(model: &Model, id: &str, from: &TreePlace) -> String {
    if file_of(model, id).is_some_and(|path| *from == TreePlace::File(path)) {
        return id.to_owned();
    }
    // One that was removed is put back where it was.
    if let TreePlace::File(path) = from
        && let Some(before) = presets::before_put_away(path)
    {
        let id = before.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_owned();
        return if file_of(model, &id).as_ref() == Some(&before) { id } else { typed(&before) };
    }
    // A document that was opened elsewhere is saved where it is.
    if let TreePlace::File(path) = from
        && file_of(model, &typed(path)).as_ref() == Some(path)
    {
        return typed(path);
    }
    // What was numbered already goes on counting: fir-2, fir-3.
    let stem = match id.rsplit_once('-') {
        Some((stem, number)) if !stem.is_empty() && number.parse::<u32>().is_ok() => stem,
        _ => id,
    };
    let is_free = |id: &String| model.library.places().all(|(taken, _)| taken != id);
    // A user who has more copies than that chooses a name.
    (2..100_000).map(|n: u32| format!("{stem}-{n}")).find(is_free).unwrap_or_default()
}

/// Where something is saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The folder; `None` for that of the user's presets.
    pub dir: Option<PathBuf>,
    /// Its id, which names its file there.
    pub id: String,
}

impl Destination {
    /// Reads what was typed: an id, or a path, which begins like one or ends in `.toml`.
    ///
    /// # Errors
    /// Why nothing can be saved there.
    pub fn read(typed: &str) -> Result<Self, String> {
        let check = |id: &str, what: &str| {
            presets::check_id(id).map_err(|why| format!("'{}' cannot be {what}: {why}", excerpt(id)))
        };
        if !is_path(typed) {
            check(typed, "a preset's id")?;
            return Ok(Self { dir: None, id: typed.to_owned() });
        }
        let path = expand(typed)?;
        let name = path.file_name().filter(|_| !typed.ends_with(std::path::is_separator));
        let name = name.ok_or("the name of the file is missing")?;
        let stem = path.file_stem().filter(|_| is_document(&path)).unwrap_or(name);
        let id = stem.to_str().ok_or("the name of the file is not Unicode")?;
        check(id, "the name of a document")?;
        Ok(Self { dir: Some(path.parent().unwrap_or(Path::new("")).to_owned()), id: id.to_owned() })
    }
}

/// Whether what was typed is a path, and no id.
fn is_path(typed: &str) -> bool {
    paths::begins_path(typed) || is_document(Path::new(typed))
}

/// What is typed for a path.
fn typed(path: &Path) -> String {
    paths::typed(&show(path))
}

/// The file that something is saved in under what was typed.
fn file_of(model: &Model, typed: &str) -> Option<PathBuf> {
    let Destination { dir, id } = Destination::read(typed).ok()?;
    Some(dir.or_else(|| model.config.dirs.presets())?.join(format!("{id}.toml")))
}

/// Why nothing can be saved under what was typed.
pub fn problem(typed: &str) -> Option<String> {
    Destination::read(typed).err()
}

/// What saving under an id would mean, for who is typing it.
pub fn consequence(model: &Model, id: &str) -> String {
    if replaces(model, id) && is_path(id) {
        "the file is there; you will be asked before it is replaced".to_owned()
    } else if replaces(model, id) {
        "there is one of that name; you will be asked before it is replaced".to_owned()
    } else if builtin(id).is_ok() {
        "a built-in preset has that name; on a command line it means the built-in one".to_owned()
    } else {
        match file_of(model, id) {
            Some(path) => format!("goes to {}", show(&path)),
            None => String::new(),
        }
    }
}

/// Whether a preset of the user's would be replaced.
pub fn replaces(model: &Model, id: &str) -> bool {
    let Some(path) = file_of(model, id) else { return false };
    let place = TreePlace::File(path);
    model.library.entries.iter().any(|entry| entry.place == place && !entry.is_gone)
}

/// A recipe as the preset `id` has it, saved in the file `path`: a copy has its id for a name, a document keeps what it
/// says where it is saved back, and the files that it needs stand beside it under its name.
pub fn renamed(recipe: &Recipe, from: &TreePlace, id: &str, path: &Path) -> Recipe {
    let mut recipe = recipe.clone();
    if recipe.preset.id != id && *from != TreePlace::File(path.to_owned()) {
        id.clone_into(&mut recipe.preset.id);
        id.clone_into(&mut recipe.preset.name);
    }
    if let Some(names) = beside(&recipe, from, id, path) {
        recipe.rename_files(&names);
    }
    recipe
}

/// The names that the files beside a saved preset get, by those that they have; `None` when they lie
/// there already.
fn beside(recipe: &Recipe, from: &TreePlace, id: &str, path: &Path) -> Option<BTreeMap<String, String>> {
    if matches!(from, TreePlace::File(other) if other.parent() == path.parent()) {
        return None;
    }
    let name = |(i, file): (usize, &str)| {
        // No id has a dot in it, so these are no other preset's.
        let number = if i == 0 { String::new() } else { format!(".{}", i + 1) };
        let ending = Path::new(file).extension().and_then(|ending| ending.to_str());
        let name = |ending| format!("{id}{number}.{ending}");
        (file.to_owned(), ending.map_or_else(|| format!("{id}{number}-input"), name))
    };
    Some(recipe.preset.files().into_iter().enumerate().map(name).collect())
}

/// The files of a preset, by name: those that it needs, if they are not there already, then the
/// document. Reads the former where the recipe's document named them.
///
/// # Errors
/// What cannot be written as TOML, and a file that is gone or is not the one that grew.
pub fn documents(
    dir: &Path,
    id: &str,
    from: &TreePlace,
    recipe: &Recipe,
) -> Result<Vec<(String, Vec<u8>)>, String> {
    let name = format!("{id}.toml");
    let path = dir.join(&name);
    let mut found = Vec::new();
    for (file, name) in beside(recipe, from, id, &path).unwrap_or_default() {
        let bytes = input(from, &file)?;
        // A file may have changed since it was read; what is saved is what is on screen.
        let now = Input::read(&name, &bytes, &Quiet).map_err(|error| error.to_string())?;
        if recipe.input(&file).is_some_and(|input| input.hash != now.hash) {
            return Err(format!(
                "{} is not the file any more that the tree on screen grew into; nothing was saved, open it again",
                excerpt(&file)
            ));
        }
        found.push((name, bytes));
    }
    let preset = renamed(recipe, from, id, &path).preset;
    let text = match document_of(from) {
        Some(text) => preset.edit_toml(&text).map_err(|error| error.to_string()),
        None => preset.to_toml().map_err(|error| error.to_string()),
    };
    let text = text.map_err(|error| format!("writing the preset: {error}"))?;
    found.push((name, text.into_bytes()));
    Ok(found)
}

/// The document that a tree comes from, as it stands now: what its author wrote stays where nothing was changed.
/// `None` for what is no preset's document, like a grammar or a mesh.
fn document_of(from: &TreePlace) -> Option<String> {
    match from {
        TreePlace::Builtin(id) => builtin(id).ok().map(|builtin| builtin.text.to_owned()),
        TreePlace::File(path) => files::read_text(path, MOST_BYTES)
            .ok()
            .flatten()
            .filter(|text| linden::preset::Preset::from_toml(text).is_ok()),
    }
}

/// What is saved of a recipe into its own document: what was changed since that was read as `base`, made to what the
/// document says now. Elsewhere it is saved as it is on screen.
///
/// # Errors
/// What was changed does not go with what others made of the document.
pub fn over(
    dir: &Path,
    id: &str,
    from: &TreePlace,
    base: &Recipe,
    recipe: &Arc<Recipe>,
) -> Result<Arc<Recipe>, String> {
    let path = dir.join(format!("{id}.toml"));
    let is_its_own = *from == TreePlace::File(path.clone());
    let theirs = document_of(from).filter(|_| is_its_own).and_then(|text| Preset::from_toml(&text).ok());
    let Some(theirs) = theirs.filter(|theirs| *theirs != base.preset) else {
        return Ok(Arc::clone(recipe));
    };
    match merged(&base.preset, &recipe.preset, &theirs) {
        Some(preset) => Ok(Arc::new(recipe.with_preset(preset))),
        None => Err(format!(
            "what you changed does not go with what {} says now; nothing was saved, save under another name",
            show(&path)
        )),
    }
}

/// What replacing a preset of the user's does to its file.
pub fn loss(model: &Model, id: &str) -> &'static str {
    let own = file_of(model, id)
        .and_then(|path| model.tree.as_ref().filter(|tree| tree.place == TreePlace::File(path)));
    if own.is_some_and(|tree| tree.is_overtaken) {
        "it changed on disk since you opened it: what you changed goes in, the rest stays as it is there"
    } else if own.is_some() {
        "only what was changed is written; comments stay"
    } else {
        "the file is replaced by another document; what it says is lost"
    }
}

/// The bytes of a file that a preset names.
fn input(from: &TreePlace, file: &str) -> Result<Vec<u8>, String> {
    let built_in = || builtin_file(file).map(<[u8]>::to_vec);
    let path = match from {
        TreePlace::Builtin(id) => {
            let input = builtin(id).ok().and_then(|input| input.input(file)).map(<[u8]>::to_vec);
            return input
                .or_else(built_in)
                .ok_or_else(|| format!("there is no built-in file '{}'", excerpt(file)));
        }
        TreePlace::File(path) => trust::beside(Some(path), file).map_err(|error| error.to_string())?,
    };
    let is_missing = |error: &anyhow::Error| {
        error.downcast_ref::<std::io::Error>().is_some_and(|error| error.kind() == ErrorKind::NotFound)
    };
    match reading::regular(&path, &Quiet) {
        Ok(bytes) => Ok(bytes),
        Err(error)
            if is_missing(&error)
                && let Some(bytes) = built_in() =>
        {
            Ok(bytes)
        }
        Err(error) => Err(format!("reading {}, which the preset needs: {error}", show(&path))),
    }
}

/// Saves a preset into a directory, which is made if need be, and gives what `Msg::Saved` says: its id
/// and where its document is. There is never a document without the files that it needs.
///
/// # Errors
/// What is wrong. A document of that id is as it was.
pub fn write(
    dir: &Path,
    id: &str,
    from: &TreePlace,
    recipe: &Recipe,
    overwrite: bool,
) -> Result<(String, PathBuf), String> {
    if let Err(why) = presets::check_id(id) {
        return Err(format!("'{}' cannot be a preset's id: {why}", excerpt(id)));
    }
    let path = dir.join(format!("{id}.toml"));
    if !overwrite && fs::symlink_metadata(&path).is_ok() {
        return Err(format!(
            "there is a preset '{}' already ({}); choose another id",
            excerpt(id),
            show(&path)
        ));
    }
    let mut found = documents(dir, id, from, recipe)?;
    if overwrite {
        replace_all(dir, &found)?;
        return Ok((id.to_owned(), path));
    }
    let Some((_, document)) = found.pop() else { return Err("there is nothing to save".to_owned()) };
    let document = String::from_utf8(document).map_err(|error| error.to_string())?;
    let mut added = Vec::new();
    for (name, bytes) in found {
        let file = dir.join(name);
        match files::write(&file, &bytes, Readers::Umask, Existing::Keep) {
            Ok(()) => added.push(file),
            // The same file is there from the last time.
            Err(error) if error.kind() == ErrorKind::AlreadyExists && holds(&file, &bytes) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                return Err(format!("there is another file {} already; choose another id", show(&file)));
            }
            Err(error) => return Err(format!("writing {}: {error}", show(&file))),
        }
    }
    match presets::save(dir, id, &document, false) {
        Ok(path) => Ok((id.to_owned(), path)),
        Err(error) => {
            for file in added {
                // Nothing names it.
                let _ = fs::remove_file(file);
            }
            Err(error.to_string())
        }
    }
}

/// Whether a file is a preset's document by its name.
pub fn is_document(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Writes what was changed of a preset into the file that it was read from, and gives what `Msg::Saved` says.
///
/// # Errors
/// What is wrong. The file is as it was.
pub fn write_back(path: &Path, recipe: &Recipe) -> Result<(String, PathBuf), String> {
    let failed = |why: String| format!("saving into {}: {why}; it was not opened", show(path));
    let text = document_of(&TreePlace::File(path.to_owned()))
        .ok_or_else(|| failed("it cannot be read as a preset".to_owned()))?;
    let text = recipe.preset.edit_toml(&text).map_err(|error| failed(error.to_string()))?;
    files::write(path, text.as_bytes(), Readers::Umask, Existing::Replace)
        .map_err(|error| failed(error.to_string()))?;
    Ok((recipe.preset.id.clone(), path.to_owned()))
}

/// Writes all files or none; their owner has agreed that they replace those that are there.
fn replace_all(dir: &Path, found: &[(String, Vec<u8>)]) -> Result<(), String> {
    let failed = |error: ExportError| error.to_string();
    fs::create_dir_all(dir).map_err(|error| format!("making the directory {}: {error}", show(dir)))?;
    let mut bundles = Vec::new();
    for (name, bytes) in found {
        let file = dir.join(name);
        if !holds(&file, bytes) {
            let mut bundle = Bundle::create(&file).map_err(failed)?;
            bundle.write_main(Some(bytes.len() as u64), &Quiet, |out| out.write(bytes)).map_err(failed)?;
            bundles.push(bundle);
        }
    }
    commit_all(bundles).map_err(failed)?;
    Ok(())
}

fn holds(file: &Path, bytes: &[u8]) -> bool {
    reading::regular(file, &Quiet).is_ok_and(|there| there == bytes)
}
