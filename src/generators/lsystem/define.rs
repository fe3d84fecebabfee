//! The constants of a grammar, and grammars with other ones.

use linden_base::knob::{did_you_mean, excerpt, nearest, printable};

use super::error::GrammarError;
use super::grammar::Grammar;

/// A constant that a grammar has not, or a value that it cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefineError {
    /// The grammar does not define it.
    #[error(
        "the grammar defines no '{name}'{}; {}",
        did_you_mean(.nearest.as_deref()),
        if .known.is_empty() { "it has no '#define'".to_owned() } else { format!("it defines: {}", .known.join(", ")) }
    )]
    Unknown {
        /// What was asked for, printable.
        name: String,
        /// What may have been meant.
        nearest: Option<String>,
        /// What it defines.
        known: Vec<String>,
    },
    /// Not a value, or one with which the grammar is none.
    #[error("{name}={value}: {error}")]
    Value {
        /// The constant.
        name: String,
        /// What was asked for, printable.
        value: String,
        /// What is wrong with the grammar then, and where.
        #[source]
        error: Box<GrammarError>,
    },
}

impl Grammar {
    /// The constants of `#define` lines: name, value as it is written, and its number.
    ///
    /// ```
    /// let tree = linden_lsystem::Grammar::new("A(1)", &["#define r 0.9", "#define s r*2", "A(x) -> F(x*s)"])?;
    /// assert_eq!(tree.constants(), [("r", "0.9".to_owned(), 0.9), ("s", "r*2".to_owned(), 1.8)]);
    /// # Ok::<(), linden_lsystem::GrammarError>(())
    /// ```
    pub fn constants(&self) -> Vec<(&str, String, f64)> {
        let all = self.definitions.iter();
        // A grammar is valid by construction: the value of a constant needs neither parameters nor chance.
        all.map(|d| (&*d.name, d.value.to_string(), d.value.constant().unwrap_or(f64::NAN))).collect()
    }

    /// The same grammar with another value of a constant, a number or an expression of numbers and of constants that
    /// are defined before; those that are defined by it follow.
    ///
    /// ```
    /// let tree = linden_lsystem::Grammar::new("A(1)", &["#define r 0.9", "A(x) -> F(x*r)"])?;
    /// let other = tree.defining("r", "0.5")?;
    /// assert_eq!(other.to_string(), "A(1)\n#define r 0.5\nA(x) -> F(x*r)\n");
    /// let error = tree.defining("R", "0.5").unwrap_err().to_string();
    /// assert_eq!(error, "the grammar defines no 'R' (did you mean 'r'?); it defines: r");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`DefineError`]: a name that it does not define, no constant, or one with which it is no grammar.
    pub fn defining(&self, name: &str, value: &str) -> Result<Self, DefineError> {
        let known = || self.definitions.iter().map(|definition| definition.name.as_str());
        let Some(index) = known().position(|known| known == name) else {
            // Names are short: another case is as far away as any other letter.
            let alike = known().find(|known| known.eq_ignore_ascii_case(name));
            return Err(DefineError::Unknown {
                name: excerpt(name),
                nearest: alike.or(nearest(name, known())).map(str::to_owned),
                known: known().map(str::to_owned).collect(),
            });
        };
        // Written and read again, so that whatever depends on it is checked and computed anew.
        let text = self.to_string();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let axiom = lines.remove(0);
        // The definitions come first, in their order.
        lines[index] = format!("#define {name} {value}");
        Self::new(&axiom, &lines).map_err(|error| DefineError::Value {
            name: name.to_owned(),
            value: printable(value),
            error: Box::new(error),
        })
    }
}
