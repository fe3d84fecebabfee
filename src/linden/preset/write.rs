//! From a preset to a document: TOML to edit, JSON to carry along.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::files::NamesFiles;
use super::foliage::ALSO;
use super::knobs::Section;
use super::part::PART;
use super::{Generator, LeafKind, Part, Preset, Space};
use crate::knob::Value;

impl Serialize for Preset {
    /// All headings and all knobs, also those that stand at their default: what is written does not
    /// change when a default does.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.serialize_into(&mut map)?;
        map.end()
    }
}

impl Preset {
    /// The same, into a map that holds more.
    pub(crate) fn serialize_into<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        let headings = [
            ("id", &self.id),
            ("name", &self.name),
            ("group", &self.group),
            ("summary", &self.summary),
            ("source", &self.source),
        ];
        for (key, value) in headings {
            map.serialize_entry(key, value)?;
        }
        if !self.about.is_empty() {
            map.serialize_entry("about", &self.about)?;
        }
        for section in Section::ALL {
            let own = Knobs { preset: self, section };
            if section == Section::Tree {
                own.serialize_into(map)?;
            } else if !own.is_empty() {
                map.serialize_entry(section.key(), &own)?;
            }
        }
        Ok(())
    }

    /// The preset as a document that people edit.
    ///
    /// # Errors
    /// When a number is too large for TOML (a seed beyond 2^63).
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

/// One section's table.
struct Knobs<'a> {
    preset: &'a Preset,
    section: Section,
}

impl Knobs<'_> {
    fn is_empty(&self) -> bool {
        self.preset.knobs().iter().all(|(knob, _)| knob.section != self.section)
    }

    fn serialize_into<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        match (&self.preset.generator, self.section) {
            (Generator::LSystem(own), Section::LSystem) => {
                // The grammar shows its axiom, then its rules, a line each.
                let text = own.grammar.to_string();
                let mut lines = text.lines();
                map.serialize_entry("axiom", lines.next().unwrap_or_default())?;
                map.serialize_entry("rules", &lines.collect::<Vec<_>>())?;
            }
            (Generator::Colonization(own), Section::Colonization) => match &own.space {
                Space::Shape { .. } => {}
                Space::Envelope { file } => map.serialize_entry("envelope", file)?,
                Space::Points { file } => map.serialize_entry("scan", file)?,
            },
            (_, Section::Foliage) => {
                for (key, file) in self.preset.foliage.first.named_files() {
                    map.serialize_entry(key, file)?;
                }
            }
            (_, Section::Bark) => {
                for (key, file) in self.preset.bark.named_files() {
                    map.serialize_entry(key, file)?;
                }
            }
            _ => {}
        }
        for (knob, value) in self.preset.knobs() {
            if knob.section == self.section {
                map.serialize_entry(knob.knob.name, &Plain(value))?;
            }
        }
        // Tables come after values.
        let parts = self.preset.parts();
        if self.section == Section::Colonization && !parts.is_empty() {
            map.serialize_entry(PART, parts)?;
        }
        let kinds = &self.preset.foliage.also;
        if self.section == Section::Foliage && !kinds.is_empty() {
            map.serialize_entry(ALSO, kinds)?;
        }
        Ok(())
    }
}

impl Serialize for Knobs<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.serialize_into(&mut map)?;
        map.end()
    }
}

impl Serialize for Part {
    /// All keys that its role has, also those that stand at their default.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (knob, value) in self.knobs() {
            map.serialize_entry(knob.name, &Plain(value))?;
        }
        if let Some(file) = self.file() {
            map.serialize_entry("mesh", file)?;
        }
        map.end()
    }
}

impl Serialize for LeafKind {
    /// All keys, also those that stand at their default.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (knob, value) in self.knobs() {
            map.serialize_entry(knob.name, &Plain(value))?;
        }
        for (key, file) in self.named_files() {
            map.serialize_entry(key, file)?;
        }
        map.end()
    }
}

/// A value as documents have it: numbers and lists as such, everything else as text.
pub(crate) struct Plain(pub Value);

impl Serialize for Plain {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            Value::Real(x) if x.is_finite() => serializer.serialize_f64(*x),
            Value::Integer(n) => serializer.serialize_u64(*n),
            Value::Switch(on) => serializer.serialize_bool(*on),
            Value::Vector(v) => v.serialize(serializer),
            Value::Profile(pairs) => pairs.serialize(serializer),
            Value::Reals(numbers) => numbers.serialize(serializer),
            Value::Words(words) => words.serialize(serializer),
            Value::Colors(colors) => {
                serializer.collect_seq(colors.iter().map(|&color| Value::Color(color).to_string()))
            }
            other => serializer.collect_str(other),
        }
    }
}
