//! Where a document names a file, for messages about that file.

use linden_base::document::{Datum, Node, TextPlace};
use linden_plant::settings::{BarkSettings, LeafKind};

/// Keys that name files outside of the tables of [`FileKey`](super::FileKey)s; `preset` is a forest's.
const KEYS: [&str; 5] = ["envelope", "file", "scan", "mesh", "preset"];

/// The first key in a document (a preset, a recipe, a forest) that names a file, and its place where the
/// text has lines to speak of.
///
/// ```
/// let text = "id = \"a\"\n[colonization]\nenvelope = \"hull.obj\"\n";
/// let (key, place) = linden_pipeline::preset::mention(text, "hull.obj").unwrap();
/// assert_eq!((key.as_str(), place.unwrap().to_string().as_str()), ("envelope", "3:1"));
/// ```
pub fn mention(text: &str, file: &str) -> Option<(String, Option<TextPlace>)> {
    let is_json = text.trim_start().starts_with('{');
    let document = if is_json { Node::from_json(text) } else { Node::from_toml(text) };
    let (key, place) = search(&document.ok()?, file)?;
    Some((key, place.filter(|_| !is_json)))
}

fn search(node: &Node, file: &str) -> Option<(String, Option<TextPlace>)> {
    match &node.datum {
        Datum::Table(entries) => entries.iter().find_map(|entry| match &entry.node.datum {
            Datum::Text(text) if text.trim() == file && names_files(&entry.key) => {
                Some((entry.key.clone(), entry.place))
            }
            _ => search(&entry.node, file),
        }),
        Datum::List(items) => items.iter().find_map(|item| search(item, file)),
        _ => None,
    }
}

fn names_files(key: &str) -> bool {
    let rows = BarkSettings::FILES.iter().map(|row| row.key).chain(LeafKind::FILES.iter().map(|row| row.key));
    KEYS.into_iter().chain(rows).any(|known| known == key)
}
