//! What the user insists on.

use super::capabilities::{Graphics, Told};
use super::environment::{Environment, printable};
use crate::cells::Glyphs;
use crate::color::ColorDepth;

/// The variable that says how pictures are drawn.
pub(super) const GRAPHICS: &str = "LINDEN_GRAPHICS";
/// The variable that says how many colours there are.
pub(super) const COLORS: &str = "LINDEN_COLORS";

/// Ways to draw pictures, by name.
const GRAPHICS_NAMES: [(&str, (Graphics, Option<Glyphs>)); 7] = [
    ("kitty", (Graphics::Kitty, None)),
    ("sixel", (Graphics::Sixel, None)),
    ("iterm2", (Graphics::Iterm2, None)),
    ("quadrants", (Graphics::Cells, Some(Glyphs::Quadrants))),
    ("halves", (Graphics::Cells, Some(Glyphs::Halves))),
    ("braille", (Graphics::Cells, Some(Glyphs::Braille))),
    ("ascii", (Graphics::Cells, Some(Glyphs::Ascii))),
];

/// Numbers of colours, by name.
const COLOR_NAMES: [(&str, ColorDepth); 4] = [
    ("truecolor", ColorDepth::True),
    ("256", ColorDepth::Ansi256),
    ("16", ColorDepth::Ansi16),
    ("none", ColorDepth::None),
];

/// Leaves it to what is found.
const AUTO: &str = "auto";

/// Settings of the user that override what is found. The default overrides nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    pub(super) graphics: Option<Told<(Graphics, Option<Glyphs>)>>,
    pub(super) colors: Option<Told<ColorDepth>>,
}

/// A value that means nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{from}: '{value}' is none of {allowed}")]
pub struct OverrideError {
    /// Where it stood.
    pub from: String,
    /// The value as it stood there, safe to show.
    pub value: String,
    /// A list of the values that may stand there.
    pub allowed: String,
}

impl Overrides {
    /// `LINDEN_GRAPHICS` and `LINDEN_COLORS`; see [`Self::set_graphics`] and [`Self::set_colors`].
    ///
    /// # Errors
    /// [`OverrideError`] names the variable and what may stand there.
    pub fn from_environment(environment: &Environment) -> Result<Self, OverrideError> {
        let mut overrides = Self::default();
        if let Some(value) = environment.get(GRAPHICS) {
            overrides.set_graphics(value, GRAPHICS)?;
        }
        if let Some(value) = environment.get(COLORS) {
            overrides.set_colors(value, COLORS)?;
        }
        Ok(overrides)
    }

    /// The words that [`Self::set_graphics`] takes.
    pub fn graphics_words() -> Vec<String> {
        words(&GRAPHICS_NAMES)
    }

    /// The words that [`Self::set_colors`] takes.
    pub fn colors_words() -> Vec<String> {
        words(&COLOR_NAMES)
    }

    /// How pictures are drawn, and of which characters; `None` for what is found.
    pub fn graphics(&self) -> Option<(Graphics, Option<Glyphs>)> {
        self.graphics.as_ref().map(|told| told.value)
    }

    /// How many colours there are; `None` for what is found.
    pub fn colors(&self) -> Option<ColorDepth> {
        self.colors.as_ref().map(|told| told.value)
    }

    /// These settings, completed by those of `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { graphics: self.graphics.or(other.graphics), colors: self.colors.or(other.colors) }
    }

    /// How pictures are drawn: `kitty`, `sixel`, `iterm2`, `quadrants`, `halves`, `braille`, `ascii` (the
    /// rest of the screen too), or `auto` for
    /// what is found. `from` says where that stood: a flag, a variable, a key of a file. The last
    /// call counts.
    ///
    /// # Errors
    /// [`OverrideError`] names what is allowed; nothing has changed then.
    pub fn set_graphics(&mut self, value: &str, from: &str) -> Result<(), OverrideError> {
        self.graphics = named(&GRAPHICS_NAMES, value, from)?;
        Ok(())
    }

    /// How many colours there are: `truecolor`, `256`, `16`, `none`, or `auto` for what is found.
    /// `from` says where that stood. The last call counts.
    ///
    /// # Errors
    /// [`OverrideError`] names what is allowed; nothing has changed then.
    pub fn set_colors(&mut self, value: &str, from: &str) -> Result<(), OverrideError> {
        self.colors = named(&COLOR_NAMES, value, from)?;
        Ok(())
    }
}

fn words<T>(names: &[(&str, T)]) -> Vec<String> {
    names.iter().map(|(name, _)| *name).chain([AUTO]).map(str::to_owned).collect()
}

fn named<T: Copy>(names: &[(&str, T)], value: &str, from: &str) -> Result<Option<Told<T>>, OverrideError> {
    if value == AUTO {
        return Ok(None);
    }
    let found = names.iter().find(|(name, _)| *name == value);
    let why = || format!("{} asks for it", printable(from));
    found.map(|(_, value)| Some(Told { value: *value, why: why() })).ok_or_else(|| OverrideError {
        from: printable(from),
        value: printable(value),
        allowed: words(names).join(", "),
    })
}
