//! From a preset to a document: TOML to edit, JSON to carry along.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use linden_base::document::NamesFiles;
use linden_base::knob::{Spread, Value};
use linden_plant::settings::{ALSO, KIND_NAME, LeafKind};
use linden_skeleton::generator::Written;

use super::Preset;
use super::ages::{AGES, WrittenAges};
use super::edits::{EDITS, WrittenEdit};
use super::kinds::kind_rows;
use super::knobs::Section;
use super::tags::TAGS;

impl Serialize for Preset {
    /// All headings and all knobs, also those that stand at their default: what is written does not
    /// change when a default does. A default that the document itself has, as in its rules, is not written again.
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
        if !self.tags.is_empty() {
            map.serialize_entry(TAGS, &self.tags)?;
        }
        for section in Section::all() {
            let knobs = Knobs { preset: self, section };
            if section == Section::Tree {
                knobs.serialize_into(map)?;
            } else if !knobs.is_empty() {
                map.serialize_entry(section.key(), &knobs)?;
            }
        }
        if !self.ages.is_empty() {
            map.serialize_entry(AGES, &WrittenAges(&self.ages))?;
        }
        if !self.edits.is_empty() {
            map.serialize_entry(EDITS, &self.edits.iter().map(WrittenEdit).collect::<Vec<_>>())?;
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
        let generator = self.preset.grows_by();
        let written =
            if self.section.key() == generator.id() { self.preset.generator.written() } else { Vec::new() };
        for (key, written) in &written {
            match written {
                Written::Text(text) => map.serialize_entry(key, text)?,
                Written::Texts(texts) => map.serialize_entry(key, texts)?,
                Written::Tables(_) => {}
            }
        }
        match self.section {
            Section::Foliage => {
                if let Some(name) = &self.preset.dressing.foliage.first.name {
                    map.serialize_entry(KIND_NAME, name)?;
                }
                for (key, file) in self.preset.dressing.foliage.first.named_files() {
                    map.serialize_entry(key, file)?;
                }
            }
            Section::Bark => {
                for (key, file) in self.preset.dressing.bark.named_files() {
                    map.serialize_entry(key, file)?;
                }
            }
            _ => {}
        }
        for (knob, value) in self.preset.knobs() {
            if knob.section == self.section {
                let spread = self.preset.spread_of(&knob, &value);
                let is_of_generator = self.section.key() == generator.id();
                if is_of_generator && spread.is_none() && self.preset.generator.is_written(knob.knob.name) {
                    continue;
                }
                map.serialize_entry(knob.knob.name, &Turned { spread, value: &value })?;
            }
        }
        // Tables come after values.
        for (key, written) in &written {
            if let Written::Tables(tables) = written {
                map.serialize_entry(key, &tables.iter().map(|table| Rows(table)).collect::<Vec<_>>())?;
            }
        }
        let kinds = &self.preset.dressing.foliage.also;
        if self.section == Section::Foliage && !kinds.is_empty() {
            let kind = |(number, leaves)| Kind { preset: self.preset, number, leaves };
            map.serialize_entry(ALSO, &kinds.iter().enumerate().map(kind).collect::<Vec<_>>())?;
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

/// A table of names and values.
struct Rows<'a>(&'a [(&'static str, Value)]);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, Plain(value.clone()))))
    }
}

/// A further kind of leaves, with its number from 0.
struct Kind<'a> {
    preset: &'a Preset,
    number: usize,
    leaves: &'a LeafKind,
}

impl Serialize for Kind<'_> {
    /// All keys, also those that stand at their default.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let Self { preset, number, leaves } = self;
        if let Some(name) = &leaves.name {
            map.serialize_entry(KIND_NAME, name)?;
        }
        for (row, (knob, value)) in kind_rows(*number).iter().zip(leaves.knobs()) {
            let spread = preset.spread_of(row, &value);
            map.serialize_entry(knob.name, &Turned { spread, value: &value })?;
        }
        for (key, file) in leaves.named_files() {
            map.serialize_entry(key, file)?;
        }
        map.end()
    }
}

/// A knob as documents have it: its spread, or its value.
struct Turned<'a> {
    spread: Option<&'a Spread>,
    value: &'a Value,
}

impl Serialize for Turned<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.spread {
            Some(spread) => serializer.collect_str(spread),
            None => Plain(self.value.clone()).serialize(serializer),
        }
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
