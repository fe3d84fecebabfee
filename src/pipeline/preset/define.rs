//! Constants of a preset's grammar.

use linden_base::knob::printable;
use linden_lsystem::{DefineError as GrammarDefineError, LSystem};

use super::{KnobError, Preset};

/// Why a constant was not set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefineError {
    /// It grows by no grammar.
    #[error("'{preset}' grows by no grammar, which alone has constants; its knobs are turned by --set")]
    NoGrammar {
        /// The preset's id, printable.
        preset: String,
    },
    /// Its grammar has no such constant, or no such value of it.
    #[error(transparent)]
    Grammar(#[from] GrammarDefineError),
    /// The constant is a knob, and this is no value of it.
    #[error(transparent)]
    Knob(#[from] KnobError),
}

impl Preset {
    /// Gives a constant of the grammar (`#define`) another value, as `--define name=value` does. The preset's rules
    /// then say so, and its recipe with them. A constant that is a knob is turned, within its range.
    ///
    /// ```
    /// let mut honda = linden_pipeline::preset::builtin("abop-honda-a")?.load()?;
    /// honda.define("r1", "0.8")?;
    /// assert!(honda.define("r9", "0.8").is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`DefineError`].
    pub fn define(&mut self, name: &str, value: &str) -> Result<(), DefineError> {
        let no_grammar = DefineError::NoGrammar { preset: printable(&self.id) };
        let settings = self.settings_mut::<LSystem>().ok_or(no_grammar)?;
        if settings.exposed.iter().any(|exposed| exposed.knob.name == name) {
            return Ok(self.set(name, value)?);
        }
        settings.grammar = settings.grammar.defining(name, value)?;
        Ok(())
    }
}
