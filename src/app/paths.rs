//! Paths as messages show them.

use std::path::Path;

use linden::knob::printable;

/// A path in a message: what a terminal would obey in it is made visible.
pub fn show(path: &Path) -> String {
    printable(&path.to_string_lossy())
}
