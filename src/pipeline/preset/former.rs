//! Documents of earlier versions, read as what they mean today.
//!
//! A knob that was renamed has its earlier name as an alias in its row. What was moved as a whole stands here.

use linden_base::document::{Datum, Entry, Node};
use toml_edit::DocumentMut;

/// Points stood in `[colonization]` under this key.
const POINTS: &str = "scan";

/// What else a crown may be: with one of these, the points are an error as they ever were.
const CROWNS: [&str; 2] = ["crown", "envelope"];

/// Makes today's document of an earlier one.
pub(super) fn renew(document: &mut Node) {
    let Datum::Table(entries) = &mut document.datum else { return };
    if entries.iter().any(|entry| entry.key == POINTS) {
        return;
    }
    let Some(table) = entries.iter_mut().find(|entry| entry.key == "colonization") else { return };
    let Datum::Table(keys) = &mut table.node.datum else { return };
    let is_crown = |entry: &Entry| CROWNS.contains(&entry.key.as_str());
    if keys.iter().any(is_crown) {
        return;
    }
    if let Some(points) = keys.iter_mut().find(|entry| entry.key == POINTS) {
        "file".clone_into(&mut points.key);
        POINTS.clone_into(&mut table.key);
    }
}

/// The same for a document that is to be edited.
pub(super) fn renew_text(document: &mut DocumentMut) {
    let is_former = document.get("colonization").and_then(|item| item.as_table_like()).is_some_and(|table| {
        table.contains_key(POINTS) && !CROWNS.iter().any(|crown| table.contains_key(crown))
    });
    if !is_former || document.contains_key(POINTS) {
        return;
    }
    let Some(mut item) = document.remove("colonization") else { return };
    if let Some(table) = item.as_table_like_mut()
        && let Some(file) = table.remove(POINTS)
    {
        table.insert("file", file);
    }
    document.insert(POINTS, item);
}
