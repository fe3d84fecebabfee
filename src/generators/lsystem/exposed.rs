//! Constants of a grammar that are knobs: with a range, a unit and a line of help, so that nobody has to read the rules to
//! turn them.
//!
//! A document declares them beside its rules, a text each: `"limb_angle 20..80 deg: angle of the limbs to the trunk"`. What the
//! rules define is the knob's default, and stays written there; the knob's value stands under its name.

use std::fmt;

use linden_base::knob::{Kind, Knob, excerpt, kept, printable, real};

use crate::{DefineError, Grammar, LSystem};

/// A grammar has no more of them.
pub const MOST_EXPOSED: usize = 64;

/// The longest line of help, and the longest unit, in characters.
const LONGEST_HELP: usize = 200;
const LONGEST_UNIT: usize = 12;

/// A constant that is a knob.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposed {
    /// Name of the constant, range, unit, help.
    pub knob: Knob,
    /// What the rules define it as: the default, as it is written there.
    pub written: String,
}

/// Why a constant is no knob.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExposeError {
    /// Not the form of a declaration.
    #[error("'{text}' {problem}; write it like \"limb_angle 20..80 deg: angle of the limbs to the trunk\"")]
    Form {
        /// What was written, printable and cut off.
        text: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// The constant is defined by others, from which it follows.
    #[error(
        "'{name}' is defined as '{written}', which follows from other constants; only a number can be a knob"
    )]
    Follows {
        /// The constant.
        name: String,
        /// Its definition.
        written: String,
    },
    /// The constant has a number outside of the range.
    #[error(
        "'{name}' is defined as {value}, outside of its range {min} to {max}; widen one or change the other"
    )]
    Outside {
        /// The constant.
        name: String,
        /// Its number.
        value: f64,
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// The name of a knob that every L-system has, or of another constant that is declared already.
    #[error("'{name}' is the name of another knob; give the constant another one")]
    Taken {
        /// The constant.
        name: String,
    },
    /// More than [`MOST_EXPOSED`].
    #[error("there are more than {MOST_EXPOSED} constants that are knobs; declare those that people turn")]
    TooMany,
    /// There is no such constant, or an end of the range is no value of it.
    #[error(transparent)]
    Define(#[from] DefineError),
}

impl Exposed {
    /// Reads a declaration, `NAME LEAST..MOST UNIT: HELP`, for a constant of a grammar. The unit may be left out.
    ///
    /// ```
    /// use linden_lsystem::{Exposed, Grammar};
    /// let grammar = Grammar::new("F", &["#define a 45", "F -> F[+(a)F]F"])?;
    /// let angle = Exposed::read("a 10..80 deg: angle of the branches", &grammar)?;
    /// assert_eq!((angle.knob.name, angle.knob.unit, &*angle.written), ("a", "deg", "45"));
    /// assert!(Exposed::read("b 10..80 deg: no constant", &grammar).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ExposeError`], but for [`ExposeError::Taken`] among several.
    pub fn read(text: &str, grammar: &Grammar) -> Result<Self, ExposeError> {
        let form = |problem| ExposeError::Form { text: excerpt(text), problem };
        let Declared { name, range: [min, max], unit, help } = declared(text).map_err(form)?;
        if LSystem::FIELDS.iter().any(|field| field.knob.is_called(name)) {
            return Err(ExposeError::Taken { name: name.to_owned() });
        }
        // Whether it can be defined so at all, and what follows from it.
        for end in [min, max] {
            grammar.defining(name, &end.to_string())?;
        }
        let mut constants = grammar.constants().into_iter();
        let Some((_, written, value)) = constants.find(|(known, ..)| *known == name) else {
            return Err(form("names no constant"));
        };
        if written.parse::<f64>().is_err() {
            return Err(ExposeError::Follows { name: name.to_owned(), written });
        }
        if !(min..=max).contains(&value) {
            return Err(ExposeError::Outside { name: name.to_owned(), value, min, max });
        }
        // What is no knob is not kept.
        Ok(Self { knob: Knob::new(kept(name), real(min, max), kept(unit), kept(help)), written })
    }

    /// Whether a value is what the rules define.
    pub(crate) fn is_default(&self, value: f64) -> bool {
        self.written.parse() == Ok(value)
    }

    /// The number that the constants of a grammar have for it, where it is one that the knob can have.
    fn value(&self, constants: &[(&str, String, f64)]) -> Option<f64> {
        let (_, written, value) = constants.iter().find(|(name, ..)| *name == self.knob.name)?;
        let Kind::Real { min, max, .. } = self.knob.kind else { return None };
        (written.parse::<f64>().is_ok() && (min..=max).contains(value)).then_some(*value)
    }
}

/// As [`Exposed::read`] takes it.
impl fmt::Display for Exposed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Knob { name, kind, unit, help, .. } = self.knob;
        let Kind::Real { min, max, .. } = kind else { return f.write_str(name) };
        let gap = if unit.is_empty() { "" } else { " " };
        write!(f, "{name} {min}..{max}{gap}{unit}: {help}")
    }
}

/// What a text declares.
struct Declared<'a> {
    name: &'a str,
    range: [f64; 2],
    unit: &'a str,
    help: &'a str,
}

/// What a text declares, or what is wrong with it. The grammar says whether there is such a name.
fn declared(text: &str) -> Result<Declared<'_>, &'static str> {
    let (head, help) = text.split_once(':').ok_or("has no ':' before the line of help")?;
    let help = help.trim();
    if help.is_empty() {
        return Err("has nothing behind its ':': say what turning the knob does");
    }
    if help.chars().count() > LONGEST_HELP || printable(help) != help {
        return Err("has more than 200 characters of help, or some that cannot be seen");
    }
    let mut words = head.split_whitespace();
    let (Some(name), Some(range)) = (words.next(), words.next()) else {
        return Err("has no name and range before its ':'");
    };
    let unit = words.next().unwrap_or_default();
    if words.next().is_some() {
        return Err("has more than a name, a range and a unit before its ':'");
    }
    if unit.chars().count() > LONGEST_UNIT || printable(unit) != unit {
        return Err("has more than 12 characters for a unit, or some that cannot be seen");
    }
    let (min, max) = range.split_once("..").ok_or("has no range LEAST..MOST behind the name")?;
    let number = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite());
    let (Some(min), Some(max)) = (number(min), number(max)) else {
        return Err("has a range whose ends are no numbers");
    };
    if min >= max {
        return Err("has an empty range: the first number must be the smaller one");
    }
    Ok(Declared { name, range: [min, max], unit, help })
}

impl LSystem {
    /// Makes constants of the grammar knobs, by their declarations.
    ///
    /// # Errors
    /// The number of the declaration from 0, and what is wrong with it.
    pub fn expose<T: AsRef<str>>(&mut self, declarations: &[T]) -> Result<(), (usize, ExposeError)> {
        let mut exposed: Vec<Exposed> = Vec::new();
        if declarations.len() > MOST_EXPOSED {
            return Err((MOST_EXPOSED, ExposeError::TooMany));
        }
        for (i, text) in declarations.iter().enumerate() {
            let one = Exposed::read(text.as_ref(), &self.grammar).map_err(|error| (i, error))?;
            if exposed.iter().any(|known| known.knob.name == one.knob.name) {
                return Err((i, ExposeError::Taken { name: one.knob.name.to_owned() }));
            }
            exposed.push(one);
        }
        self.exposed = exposed;
        Ok(())
    }

    /// The constants that are knobs, with the numbers that they have. Those are left out that the grammar, having been edited,
    /// does not define any more, or as no number within the range.
    pub(crate) fn exposed_values(&self) -> impl Iterator<Item = (&Exposed, f64)> {
        let constants = if self.exposed.is_empty() { Vec::new() } else { self.grammar.constants() };
        self.exposed.iter().filter_map(move |one| Some((one, one.value(&constants)?)))
    }

    /// The grammar with every constant that is a knob as the rules define it.
    pub(crate) fn grammar_as_written(&self) -> Grammar {
        let mut grammar = self.grammar.clone();
        for (one, value) in self.exposed_values() {
            if one.is_default(value) {
                continue;
            }
            // It was defined so when it was declared; where others make that impossible now, the value stays.
            if let Ok(defaulted) = grammar.defining(one.knob.name, &one.written) {
                grammar = defaulted;
            }
        }
        grammar
    }

    /// Turns a constant that is a knob; `false` where there is none of this name.
    pub(crate) fn set_exposed(&mut self, name: &str, value: f64) -> bool {
        let Some(name) = self.exposed_values().map(|(one, _)| one.knob.name).find(|known| *known == name)
        else {
            return false;
        };
        match self.grammar.defining(name, &value.to_string()) {
            Ok(grammar) => {
                self.grammar = grammar;
                self.unfit.remove(name);
            }
            Err(error) => {
                self.unfit.insert(name, error);
            }
        }
        true
    }
}
