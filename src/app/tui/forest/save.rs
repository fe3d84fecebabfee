//! A changed forest saved as one of the user's own.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use linden::forest::{Forest, ForestDocument, TreeSource, builtin_forest};
use linden::knob::excerpt;
use linden::preset::builtin;

use crate::config::files::{self, Existing, Readers};
use crate::config::presets;
use crate::paths::show;
use crate::tui::shape::save::is_document;
use crate::tui::tree::TreePlace;

/// No document that people write is larger.
const MOST_BYTES: u64 = 16 << 20;

/// Saves a forest into a directory and gives what `Msg::ForestSaved` says: where its document is. The document that
/// it comes from is the model: what its author wrote stays.
///
/// # Errors
/// What is wrong. A document of that id is as it was.
pub fn write(
    dir: &Path,
    id: &str,
    from: &TreePlace,
    forest: &Forest,
    overwrite: bool,
) -> Result<PathBuf, String> {
    if let Err(why) = presets::check_id(id) {
        return Err(format!("'{}' cannot be a forest's id: {why}", excerpt(id)));
    }
    let path = dir.join(format!("{id}.toml"));
    if !overwrite && fs::symlink_metadata(&path).is_ok() {
        return Err(format!("there is {} already; choose another id", show(&path)));
    }
    let text = document_of(from)?;
    let is_own = matches!(from, TreePlace::File(own) if *own == path);
    if let TreePlace::File(own) = from
        && own.parent() != Some(dir)
    {
        stays_whole(&text, own, dir)?;
    }
    let name = (!is_own).then_some(id);
    let text = ForestDocument::edit_toml(&text, &forest.layout, name).map_err(|fault| fault.to_string())?;
    let existing = if overwrite { Existing::Replace } else { Existing::Keep };
    files::write(&path, text.as_bytes(), Readers::Umask, existing)
        .map_err(|error| format!("writing {}: {error}", show(&path)))?;
    Ok(path)
}

/// The document that a forest comes from.
fn document_of(from: &TreePlace) -> Result<String, String> {
    match from {
        TreePlace::Builtin(id) => builtin_forest(id)
            .map(|builtin| builtin.text.to_owned())
            .map_err(|_| format!("there is no built-in forest '{id}'")),
        TreePlace::File(path) if !is_document(path) => Err(format!(
            "{} carries its forest with it and is no document; 'Copy recipe' gives what it says",
            show(path)
        )),
        TreePlace::File(path) => files::read_text(path, MOST_BYTES)
            .map_err(|complaint| complaint.to_string())?
            .ok_or_else(|| format!("{} is gone, and with it what the forest consists of", show(path))),
    }
}

/// Refuses a copy in another folder of a document that names files beside it.
fn stays_whole(text: &str, own: &Path, dir: &Path) -> Result<(), String> {
    let document = ForestDocument::parse(text).map_err(|fault| fault.to_string())?;
    let named = document.trees.iter().filter_map(|tree| match &tree.source {
        TreeSource::Named(name) => Some(name.as_str()),
        TreeSource::Recipe(_) => None,
    });
    let known = presets::ids(dir).into_iter().collect::<BTreeSet<_>>();
    match named.into_iter().find(|name| builtin(name).is_err() && !known.contains(*name)) {
        None => Ok(()),
        Some(name) => Err(format!(
            "{} names the file '{}' beside it, which a copy in {} would not have; change {} in an editor instead",
            show(own),
            excerpt(name),
            show(dir),
            show(own)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::forest::AnySource;

    fn read(source: &Path) -> Forest {
        match AnySource::read(source, &linden::Quiet).unwrap() {
            AnySource::Forest(source) => source.forest,
            AnySource::Tree(_) => panic!("a tree"),
        }
    }

    #[test]
    fn a_forest_is_saved_as_it_is_on_screen_and_over_itself() {
        let dir = tempfile::tempdir().unwrap();
        let mut forest = read(Path::new("orchard"));
        forest.layout.set("area", "25").unwrap();
        let from = TreePlace::Builtin("orchard");
        let path = write(dir.path(), "mine", &from, &forest, false).unwrap();
        assert!(read(&path).layout == forest.layout);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("name = \"mine\"") && text.contains("spacing = 6"), "{text}");
        let error = write(dir.path(), "mine", &from, &forest, false).unwrap_err();
        assert!(error.contains("already"), "{error}");
        fs::write(&path, format!("# my trees\n{text}")).unwrap();
        forest.layout.set("seed", "7").unwrap();
        write(dir.path(), "mine", &TreePlace::File(path.clone()), &forest, true).unwrap();
        assert!(read(&path).layout == forest.layout);
        assert!(fs::read_to_string(&path).unwrap().starts_with("# my trees\n"));
    }

    #[test]
    fn what_would_not_grow_elsewhere_is_not_copied() {
        let dir = tempfile::tempdir().unwrap();
        let own = dir.path().join("grove.toml");
        fs::write(dir.path().join("bush.toml"), builtin("fir").unwrap().text).unwrap();
        fs::write(&own, "area = 12\nspacing = 6\n[[tree]]\npreset = \"bush.toml\"\n").unwrap();
        let forest = read(&own);
        let from = TreePlace::File(own);
        let error = write(&dir.path().join("presets"), "copy", &from, &forest, false).unwrap_err();
        assert!(error.contains("bush.toml"), "{error}");
        assert!(!dir.path().join("presets").exists());
    }
}
