//! The presets in the program.

use linden_base::input::{Input, InputError};
use linden_base::knob::{did_you_mean, excerpt, nearest};
use linden_base::monitor::Monitor;

use super::{Fault, Heading, Preset};
use crate::recipe::Recipe;

/// A file of `presets/`, as it was when the program was built.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// The file's name without `.toml`: the preset's id.
    pub id: &'static str,
    /// The document.
    pub text: &'static str,
    /// The other files of the folder it stands in, by name: crown envelopes and meshes of parts.
    pub beside: &'static [(&'static str, &'static [u8])],
    /// How large the tree is; `None` for a new preset that is not measured yet.
    pub size: Option<BuiltinSize>,
}

/// The size that a built-in preset grows to: measured when it was last changed, and told without growing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuiltinSize {
    /// From the lowest to the highest node, to a centimetre.
    pub height_m: f64,
    /// Leaves, needles, blossoms and fruit.
    pub leaves: u64,
}

include!(concat!(env!("OUT_DIR"), "/builtins.rs"));

/// All built-in presets, by folder and id.
pub fn builtins() -> &'static [Builtin] {
    BUILTINS
}

/// There is no built-in preset of that id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no preset '{}'{}{}",
    excerpt(.id),
    did_you_mean(*.nearest),
    if BUILTINS.is_empty() { ": linden was built without its feature 'presets'" } else { "" }
)]
pub struct UnknownPreset {
    /// As it was asked for.
    pub id: String,
    /// The nearest id, which may have been meant.
    pub nearest: Option<&'static str>,
}

/// A built-in preset by its id.
///
/// # Errors
/// [`UnknownPreset`], with the nearest id.
pub fn builtin(id: &str) -> Result<&'static Builtin, UnknownPreset> {
    BUILTINS.iter().find(|preset| preset.id == id).ok_or_else(|| UnknownPreset {
        id: id.to_owned(),
        nearest: nearest(id, BUILTINS.iter().map(|preset| preset.id)),
    })
}

/// A file that stands beside a built-in preset. A recipe or a copy of such a preset names it, and it
/// need not lie beside that too.
pub fn builtin_file(name: &str) -> Option<&'static [u8]> {
    BUILTINS
        .iter()
        .flat_map(|preset| preset.beside)
        .find(|(known, _)| *known == name)
        .map(|&(_, bytes)| bytes)
}

impl Builtin {
    /// Reads the document.
    ///
    /// # Errors
    /// None that the tests let pass: each built-in document is read there.
    pub fn load(&self) -> Result<Preset, Fault> {
        Preset::from_toml(self.text)
    }

    /// What a list shows of it: reads a few lines instead of the whole document.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn heading(&self) -> Result<Heading, Fault> {
        Heading::from_toml(self.text)
    }

    /// The bytes of a file that the preset needs beside it.
    pub fn input(&self, file: &str) -> Option<&'static [u8]> {
        self.beside.iter().find(|(name, _)| *name == file).map(|&(_, bytes)| bytes)
    }

    /// The preset with its files: what grows.
    ///
    /// # Errors
    /// None that the tests let pass, and [`RecipeError::Input`] when the monitor cancelled.
    pub fn recipe(&self, monitor: &dyn Monitor) -> Result<Recipe, RecipeError> {
        let preset = self.load()?;
        let inputs = preset
            .files()
            .into_iter()
            .filter_map(|file| Some((file, self.input(file)?)))
            .map(|(file, bytes)| Ok((file, Input::read(file, bytes, monitor)?)))
            .collect::<Result<_, InputError>>()?;
        Ok(Recipe::with_files(preset, inputs))
    }
}

/// Why a built-in preset cannot be had.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeError {
    /// Its document.
    #[error(transparent)]
    Document(#[from] Fault),
    /// A file beside it.
    #[error(transparent)]
    Input(#[from] InputError),
}
