//! The settings of a format: a table of knobs, and values checked against it.

use linden_pipeline::knob::{Kind, Knob, Value, nearest};

use crate::{ExportError, Format};

/// A setting of a format.
#[derive(Clone, Copy, Debug)]
pub struct OptionSpec {
    /// Name, kind and help.
    pub knob: Knob,
    /// The value when nothing is said, as a user would type it.
    pub default: &'static str,
    /// Whether it is about what a plant has once: where each level of detail has a file, the finest alone has it.
    pub is_once_a_plant: bool,
}

impl OptionSpec {
    /// A setting of any kind.
    pub const fn new(knob: Knob, default: &'static str) -> Self {
        Self { knob, default, is_once_a_plant: false }
    }

    /// The same for what a plant has once, whatever its levels of detail.
    #[must_use]
    pub const fn once_a_plant(self) -> Self {
        Self { is_once_a_plant: true, ..self }
    }

    /// `true` or `false`.
    pub const fn switch(name: &'static str, default: bool, help: &'static str) -> Self {
        let knob = Knob::new(name, Kind::Switch, "", help);
        Self::new(knob, if default { "true" } else { "false" })
    }

    /// A whole number between two, both included.
    pub const fn count(
        name: &'static str,
        (min, max): (u64, u64),
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self::new(Knob::new(name, Kind::Integer { min, max }, "", help), default)
    }

    /// One of some words, the first by default; at least one.
    pub const fn choice(name: &'static str, words: &'static [&'static str], help: &'static str) -> Self {
        Self::new(Knob::new(name, Kind::Choice(words), "", help), words[0])
    }
}

/// One value for each setting of a format.
///
/// ```
/// use linden_exporters::{Options, find};
///
/// let mut options = Options::new(find("ply")?.format());
/// assert!(options.is_word("encoding", "binary"));
/// options.set("encoding", "ascii")?;
/// assert!(options.is_word("encoding", "ascii"));
/// # Ok::<(), linden_exporters::ExportError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Options {
    format: &'static Format,
    /// As many as `format.options`, in its order.
    values: Vec<Value>,
    /// Which of them a user set, in the same order.
    asked: Vec<bool>,
}

impl Options {
    /// The format's defaults.
    pub fn new(format: &'static Format) -> Self {
        let default = |spec: &OptionSpec| {
            // A default that its own kind refuses is a fault in a table; the tests parse them all.
            spec.knob.kind.parse(spec.default).unwrap_or(Value::Auto)
        };
        let values: Vec<Value> = format.options.iter().map(default).collect();
        let asked = vec![false; values.len()];
        Self { format, values, asked }
    }

    /// Sets an option from what a user typed.
    ///
    /// # Errors
    /// [`ExportError::UnknownOption`] with the nearest name, [`ExportError::OptionValue`] with the range.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), ExportError> {
        let index = self.change(name, text)?;
        self.asked[index] = true;
        Ok(())
    }

    /// Sets an option that no user asked for, as that of a program: where it has no effect, nothing is said. One that
    /// was [`set`](Self::set) before still counts as asked for.
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn suit(&mut self, name: &str, text: &str) -> Result<(), ExportError> {
        self.change(name, text).map(|_| ())
    }

    /// Gives an option its default back, as if it had never been set. What the format lacks is left out.
    pub fn reset(&mut self, name: &str) {
        let defaults = Self::new(self.format).values;
        let places = self.format.options.iter().zip(defaults).enumerate();
        for (index, (_, default)) in places.filter(|(_, (spec, _))| spec.knob.name == name) {
            self.values[index] = default;
            self.asked[index] = false;
        }
    }

    /// Puts what a plant has once back to what is said of it without a word.
    pub(crate) fn reset_once_a_plant(&mut self) {
        let defaults = Self::new(self.format).values;
        let places = self.format.options.iter().zip(defaults).enumerate();
        for (index, (_, default)) in places.filter(|(_, (spec, _))| spec.is_once_a_plant) {
            self.values[index] = default;
            self.asked[index] = false;
        }
    }

    /// Whether an option was [`set`](Self::set).
    pub fn is_asked(&self, name: &str) -> bool {
        self.format.options.iter().zip(&self.asked).any(|(spec, asked)| *asked && spec.knob.name == name)
    }

    /// Changes an option; gives its place in the table.
    fn change(&mut self, name: &str, text: &str) -> Result<usize, ExportError> {
        let names = || self.format.options.iter().map(|spec| spec.knob.name);
        let Some(index) = names().position(|known| known == name) else {
            return Err(ExportError::UnknownOption {
                format: self.format.id,
                typed: name.to_owned(),
                nearest: nearest(&name.to_lowercase(), names()),
                known: names().collect(),
            });
        };
        let knob = &self.format.options[index].knob;
        self.values[index] = knob.kind.parse(text).map_err(|problem| ExportError::OptionValue {
            format: self.format.id,
            option: knob.name,
            problem,
        })?;
        Ok(index)
    }

    /// Names and values, in the table's order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.format.options.iter().map(|spec| spec.knob.name).zip(&self.values)
    }

    /// Whether a [`linden_pipeline::knob::Kind::Switch`] is on; an option that the format lacks is off.
    pub fn is_on(&self, name: &str) -> bool {
        self.value(name) == Some(&Value::Switch(true))
    }

    /// Whether a [`linden_pipeline::knob::Kind::Choice`] has this word.
    pub fn is_word(&self, name: &str, word: &str) -> bool {
        matches!(self.value(name), Some(Value::Word(set)) if set == word)
    }

    /// The number of an [`OptionSpec::count`]; 0 where the format lacks the option.
    pub fn number(&self, name: &str) -> usize {
        match self.value(name) {
            Some(&Value::Integer(number)) => usize::try_from(number).unwrap_or(usize::MAX),
            _ => 0,
        }
    }

    /// The value of an option; `None` where the format has no such option.
    pub fn value(&self, name: &str) -> Option<&Value> {
        self.iter().find(|&(known, _)| known == name).map(|(_, value)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{REGISTRY, find};

    #[test]
    fn every_default_is_a_value_of_its_kind() {
        for exporter in REGISTRY {
            for spec in exporter.format().options {
                let parsed = spec.knob.kind.parse(spec.default);
                assert!(parsed.is_ok(), "{} {}: {parsed:?}", exporter.format().id, spec.knob.name);
            }
        }
    }

    #[test]
    fn values_are_checked_against_the_table() {
        let mut options = Options::new(find("ply").unwrap().format());
        assert!(options.is_word("encoding", "binary"));
        options.set("encoding", "ascii").unwrap();
        assert!(options.is_word("encoding", "ascii"));
        let said = options.set("encoding", "utf8").unwrap_err().to_string();
        assert_eq!(said, "option encoding of format ply: 'utf8' is not binary | ascii");
        let said = options.set("encodin", "ascii").unwrap_err().to_string();
        assert_eq!(said, "format ply has no option 'encodin' (did you mean 'encoding'?); it has: encoding");
        let mut options = Options::new(find("obj").unwrap().format());
        assert!(!options.is_on("lines") && options.is_on("pictures"));
        options.set("lines", "true").unwrap();
        assert!(options.is_on("lines"));
        assert!(options.set("lines", "yes").is_err());
        assert!(options.is_asked("lines"));
        options.reset("lines");
        options.suit("pictures", "false").unwrap();
        assert!(!options.is_on("lines") && !options.is_on("pictures"));
        assert!(!options.is_asked("lines") && !options.is_asked("pictures"));
    }
}
