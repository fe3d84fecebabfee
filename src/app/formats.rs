//! Formats of this program: linden's, and those of plug-ins on the search path, which the library does not run unasked.

use std::path::Path;

use linden_exporters::{ExportError, Exporter, Registry};

fn registry() -> Registry {
    Registry::new().with_plugins()
}

/// All formats, those of plug-ins last.
pub fn exporters() -> Vec<&'static dyn Exporter> {
    registry().exporters()
}

/// The exporter that scripts call `id`.
///
/// # Errors
/// [`ExportError::UnknownFormat`].
pub fn find(id: &str) -> Result<&'static dyn Exporter, ExportError> {
    registry().find(id)
}

/// The exporter for a file's ending.
///
/// # Errors
/// [`ExportError::UnknownExtension`].
pub fn for_path(path: &Path) -> Result<&'static dyn Exporter, ExportError> {
    registry().for_path(path)
}
