//! The presets in the program.

use super::{Fault, Preset, Space};
use crate::knob::nearest;

/// A file of `presets/`, as it was when the program was built.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// The file's name without `.toml`: the preset's id.
    pub id: &'static str,
    /// The document.
    pub text: &'static str,
    /// The other files of the folder it stands in, by name: crown envelopes.
    pub beside: &'static [(&'static str, &'static [u8])],
}

include!(concat!(env!("OUT_DIR"), "/builtins.rs"));

/// All built-in presets, by folder and id.
pub fn builtins() -> &'static [Builtin] {
    BUILTINS
}

/// A built-in preset by its id.
///
/// # Errors
/// The nearest id, if one may be meant.
pub fn builtin(id: &str) -> Result<&'static Builtin, Option<&'static str>> {
    BUILTINS
        .iter()
        .find(|preset| preset.id == id)
        .ok_or_else(|| nearest(id, BUILTINS.iter().map(|preset| preset.id)))
}

/// A file that stands beside a built-in preset. A recipe or a copy of such a preset names it, and it
/// need not lie beside that too.
pub fn builtin_file(name: &str) -> Option<&'static [u8]> {
    BUILTINS.iter().flat_map(|preset| preset.beside).find(|(own, _)| *own == name).map(|&(_, bytes)| bytes)
}

impl Builtin {
    /// Reads the document.
    ///
    /// # Errors
    /// None that the tests let pass: each built-in document is read there.
    pub fn load(&self) -> Result<Preset, Fault> {
        Preset::from_toml(self.text)
    }

    /// The bytes of the file that the preset needs beside it, if it needs one.
    pub fn input(&self, space: &Space) -> Option<&'static [u8]> {
        let file = space.file()?;
        self.beside.iter().find(|(name, _)| *name == file).map(|&(_, bytes)| bytes)
    }
}
