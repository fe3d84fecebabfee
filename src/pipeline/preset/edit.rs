//! A preset's document with little in it: edited in place, or with what differs from the defaults alone.
//!
//! Whole documents ([`Preset::to_toml`]) name every knob, so that they mean the same when a default changes.
//! People write a dozen of them, with their reasons beside them; what they wrote stays.

use std::mem;

use toml_edit::{Array, ArrayOfTables, DocumentMut, Formatted, Item, TableLike, Value};

use linden_plant::settings::LeafKind;
use linden_skeleton::edit::Edit as WoodEdit;
use linden_skeleton::generator::KeyContent;

use super::ages::AGES;
use super::edits::EDIT_OPERATION;
use super::{Preset, former};
use crate::generators;

/// Why a document cannot be edited.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A number is too large for TOML: a seed beyond 2^63.
    #[error("a number of the preset is too large for TOML: {0}")]
    Number(#[from] toml::ser::Error),
    /// It is no TOML, which it was a moment ago.
    #[error("the document is no TOML: {0}")]
    Toml(#[from] toml_edit::TomlError),
}

/// Keys that say what a preset, a part, a kind of leaves or an edit is: never a default.
const ALWAYS: [&str; 7] = ["id", "crown", "role", "mesh", EDIT_OPERATION, "axis", "from"];

/// Whether a key says what something is: one of [`ALWAYS`], or a generator's that is no knob.
fn is_always(key: &str) -> bool {
    let mut of_generators = generators::all().iter().flat_map(|generator| generator.keys());
    ALWAYS.contains(&key)
        || of_generators.any(|known| known.name == key && !matches!(known.content, KeyContent::Tables(_)))
}

impl Preset {
    /// The document `text` with the values of this preset: only keys whose values differ are changed, added
    /// or taken out. Comments, order and everything else stay. What is no preset's document is written as a
    /// whole.
    ///
    /// ```
    /// let text = "id = \"bush\" # mine\n\n[colonization]\ncrown = \"sphere\"\npoints = 500 # enough\n";
    /// let mut bush = linden_pipeline::preset::Preset::from_toml(text)?;
    /// bush.set("points", "800")?;
    /// assert_eq!(bush.edit_toml(text)?, text.replace("500", "800"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError`].
    pub fn edit_toml(&self, text: &str) -> Result<String, EditError> {
        let Ok(before) = Self::from_toml(text) else { return Ok(self.to_toml()?) };
        let mut document: DocumentMut = text.parse()?;
        former::renew_text(&mut document);
        let [before, after, plain] = [&before, self, &self.plain()].map(Self::to_document);
        edit(document.as_table_mut(), before?.as_table(), after?.as_table(), plain?.as_table());
        let edited = document.to_string();
        // The reader has the last word.
        if Self::from_toml(&edited).is_ok_and(|read| read == *self) {
            Ok(edited)
        } else {
            Ok(self.to_toml()?)
        }
    }

    /// The document with what differs from the defaults, and no more.
    ///
    /// ```
    /// let mut bush = linden_pipeline::preset::Preset::from_toml("id = \"bush\"\n[colonization]\ncrown = \"sphere\"")?;
    /// bush.set("points", "800")?;
    /// assert_eq!(bush.to_toml_changed()?, "id = \"bush\"\n\n[colonization]\ncrown = \"sphere\"\npoints = 800\n");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError`].
    pub fn to_toml_changed(&self) -> Result<String, EditError> {
        let mut document = self.to_document()?;
        let plain = self.plain().to_document()?;
        strip(document.as_table_mut(), plain.as_table());
        let text = document.to_string().trim_start().to_owned();
        if Self::from_toml(&text).is_ok_and(|read| read == *self) { Ok(text) } else { Ok(self.to_toml()?) }
    }

    /// The same kind of preset with everything at its default: what a document means that says no more than
    /// what grows.
    #[must_use]
    pub fn plain(&self) -> Self {
        let mut plain = Self::of_boxed(&self.id, self.generator.plain());
        plain.dressing.foliage.also = vec![LeafKind::default(); self.dressing.foliage.also.len()];
        plain.edits = self.edits.iter().map(WoodEdit::plain).collect();
        plain
    }

    /// As [`Preset::to_toml`], as a tree, with whole numbers as people write them.
    fn to_document(&self) -> Result<DocumentMut, EditError> {
        let mut document: DocumentMut = self.to_toml()?.parse()?;
        plainly(document.as_table_mut());
        Ok(document)
    }
}

/// Writes 4 for 4.0, in all values.
fn plainly(table: &mut dyn TableLike) {
    for (_, item) in table.iter_mut() {
        match item {
            Item::Value(value) => plain_value(value),
            Item::Table(inner) => plainly(inner),
            Item::ArrayOfTables(list) => list.iter_mut().for_each(|inner| plainly(inner)),
            Item::None => {}
        }
    }
}

fn plain_value(value: &mut Value) {
    /// Beyond, neighbouring numbers are farther apart than whole ones.
    const WHOLE: f64 = 1e15;
    match value {
        Value::Float(x) if x.value().fract() == 0.0 && x.value().abs() < WHOLE => {
            let decor = x.decor().clone();
            let mut whole = Formatted::new(*x.value() as i64);
            *whole.decor_mut() = decor;
            *value = Value::Integer(whole);
        }
        Value::Array(items) => items.iter_mut().for_each(plain_value),
        Value::InlineTable(inner) => plainly(inner),
        _ => {}
    }
}

/// What an item says, without the blanks and comments around it.
fn meaning(item: &Item) -> String {
    fn bare(value: &Value) -> Value {
        let mut value = value.clone();
        if let Value::Array(items) = &value {
            value = Value::Array(items.iter().map(bare).collect::<Array>());
        }
        value.decor_mut().clear();
        value
    }
    match item {
        Item::Value(value) => bare(value).to_string(),
        other => other.to_string(),
    }
}

fn is_same(a: Option<&Item>, b: Option<&Item>) -> bool {
    a.map(meaning) == b.map(meaning)
}

/// Takes `document` from the values of `before` to those of `after`; `plain` has the defaults.
fn edit(document: &mut dyn TableLike, before: &dyn TableLike, after: &dyn TableLike, plain: &dyn TableLike) {
    for (key, wanted) in after.iter() {
        let had = before.get(key);
        match (wanted, had, plain.get(key)) {
            (Item::Table(wanted), Some(Item::Table(had)), default) => {
                let none = toml_edit::Table::new();
                let default = default.and_then(Item::as_table).unwrap_or(&none);
                if let Some(table) = document.get_mut(key).and_then(Item::as_table_like_mut) {
                    edit(table, had, wanted, default);
                    continue;
                }
                let mut new = toml_edit::Table::new();
                edit(&mut new, had, wanted, default);
                if !new.is_empty() {
                    document.insert(key, Item::Table(new));
                }
            }
            (Item::ArrayOfTables(wanted), _, default) => {
                let none = ArrayOfTables::new();
                let had = had.and_then(Item::as_array_of_tables).unwrap_or(&none);
                let default = default.and_then(Item::as_array_of_tables).unwrap_or(&none);
                edit_list(document, key, [had, wanted, default]);
            }
            // What does not stand there is at its default, which another crown may have changed.
            (wanted, _, default) if !document.contains_key(key) => {
                if is_always(key) || !is_same(Some(wanted), default) {
                    document.insert(key, wanted.clone());
                }
            }
            (wanted, had, _) if is_same(Some(wanted), had) => {}
            (wanted, ..) => put(document, key, wanted),
        }
    }
    for (key, _) in before.iter() {
        if after.get(key).is_none() {
            document.remove(key);
        }
    }
}

/// The same for a list of tables, one by one in their order.
fn edit_list(document: &mut dyn TableLike, key: &str, [had, wanted, plain]: [&ArrayOfTables; 3]) {
    if had.to_string() == wanted.to_string() {
        return;
    }
    let none = toml_edit::Table::new();
    if !matches!(document.get(key), Some(Item::ArrayOfTables(_))) {
        // One in brackets, or none: written anew.
        document.insert(key, Item::ArrayOfTables(ArrayOfTables::new()));
    }
    let Some(list) = document.get_mut(key).and_then(Item::as_array_of_tables_mut) else { return };
    // What was taken out goes with its comments; what comes behind it keeps its own.
    let mut had: Vec<&toml_edit::Table> = had.iter().collect();
    had.truncate(list.len());
    while list.len() > wanted.len() {
        let same = |(a, b): (&&toml_edit::Table, &toml_edit::Table)| a.to_string() == b.to_string();
        let gone = had.iter().zip(wanted.iter()).take_while(|pair| same(*pair)).count();
        let is_known = gone < had.len()
            && had.get(gone + 1).zip(wanted.get(gone)).is_none_or(|(a, b)| a.to_string() == b.to_string());
        let gone = if is_known { gone } else { list.len() - 1 };
        list.remove(gone);
        if gone < had.len() {
            had.remove(gone);
        }
    }
    for (i, wanted) in wanted.iter().enumerate() {
        let default = plain.get(i).unwrap_or(&none);
        match list.get_mut(i) {
            Some(table) => edit(table, had.get(i).copied().unwrap_or(&none), wanted, default),
            None => {
                let mut new = wanted.clone();
                strip(&mut new, default);
                list.push(new);
            }
        }
    }
}

/// Gives a key a value; what stands around the one before stays.
fn put(document: &mut dyn TableLike, key: &str, wanted: &Item) {
    let mut wanted = wanted.clone();
    match (document.get_mut(key), &mut wanted) {
        (Some(Item::Value(old)), Item::Value(new)) => {
            *new.decor_mut() = mem::take(old.decor_mut());
            *old = new.clone();
        }
        (_, wanted) => {
            document.insert(key, mem::take(wanted));
        }
    }
}

/// Takes out what is as in `plain`.
fn strip(document: &mut dyn TableLike, plain: &dyn TableLike) {
    let keys: Vec<String> = document.iter().map(|(key, _)| key.to_owned()).collect();
    for key in keys {
        let default = plain.get(&key);
        let is_gone = match document.get_mut(&key) {
            // An age that turns nothing has its name.
            Some(Item::Table(_)) if key == AGES => false,
            Some(Item::Table(table)) => {
                let none = toml_edit::Table::new();
                strip(table, default.and_then(Item::as_table).unwrap_or(&none));
                table.is_empty()
            }
            Some(Item::ArrayOfTables(list)) => {
                let none = ArrayOfTables::new();
                let default = default.and_then(Item::as_array_of_tables).unwrap_or(&none);
                for (table, default) in list.iter_mut().zip(default.iter()) {
                    strip(table, default);
                }
                false
            }
            Some(item) => is_same(Some(item), default) && !is_always(&key) || is_empty_text(item),
            None => false,
        };
        if is_gone {
            document.remove(&key);
        }
    }
}

/// A heading that says nothing.
fn is_empty_text(item: &Item) -> bool {
    item.as_str().is_some_and(str::is_empty)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::{Colonization, builtins};

    /// Lines of one text that are not in the other.
    fn only_in<'a>(one: &'a str, other: &str) -> Vec<&'a str> {
        one.lines().filter(|line| other.lines().all(|other_line| other_line != *line)).collect()
    }

    #[test]
    fn a_document_that_is_what_it_says_stays_to_the_letter() {
        for builtin in builtins() {
            let preset = builtin.load().unwrap();
            assert_eq!(preset.edit_toml(builtin.text).unwrap(), builtin.text, "{}", builtin.id);
        }
    }

    #[test]
    fn what_is_left_of_a_document_without_defaults_means_the_same() {
        for builtin in builtins() {
            let preset = builtin.load().unwrap();
            let short = preset.to_toml_changed().unwrap();
            assert_eq!(Preset::from_toml(&short).unwrap(), preset, "{}: {short}", builtin.id);
            let [full, lines] = [preset.to_toml().unwrap(), short].map(|text| text.lines().count());
            assert!(lines * 2 < full + 20, "{}: {lines} of {full}", builtin.id);
            // Each line that is left counts: without it another preset is read, or none.
            let text = preset.to_toml_changed().unwrap();
            let values = text.lines().enumerate().filter(|(_, line)| line.contains(" = "));
            for (index, line) in values {
                let without: Vec<&str> =
                    text.lines().enumerate().filter(|(i, _)| *i != index).map(|(_, line)| line).collect();
                let read = Preset::from_toml(&without.join("\n"));
                assert!(read.as_ref() != Ok(&preset), "{}: {line} is a default", builtin.id);
            }
        }
    }

    #[test]
    fn turning_a_knob_changes_its_line_alone() {
        let oak = builtins().iter().find(|builtin| builtin.id == "drawn-oak").unwrap();
        let mut preset = oak.load().unwrap();
        for (knob, value) in
            [("base_radius", "0.5"), ("points", "9000"), ("seed", "7"), ("wind_strength", "0.9")]
        {
            preset.set(knob, value).unwrap();
        }
        let text = preset.edit_toml(oak.text).unwrap();
        assert_eq!(Preset::from_toml(&text).unwrap(), preset);
        let gone = ["base_radius = 0.38 # C: 18.4 m / 25.5 = 0.72 m through", "points = 11000"];
        assert_eq!(only_in(oak.text, &text), [gone[1], gone[0]]);
        let new = ["points = 9000", "base_radius = 0.5 # C: 18.4 m / 25.5 = 0.72 m through"];
        let added = only_in(&text, oak.text);
        assert!(
            new.iter().chain(&["seed = 7", "wind_strength = 0.9"]).all(|line| added.contains(line)),
            "{added:?}"
        );
        assert!(added.len() <= 5, "{added:?}");
        // And back: what was added stands there at its default, the rest is as it was.
        let back = oak.load().unwrap().edit_toml(&text).unwrap();
        assert_eq!(Preset::from_toml(&back).unwrap(), oak.load().unwrap());
        assert!(only_in(oak.text, &back).is_empty(), "{back}");
    }

    #[test]
    fn parts_and_kinds_are_changed_in_place_added_and_taken_out() {
        let oak = builtins().iter().find(|builtin| builtin.id == "drawn-oak").unwrap();
        let mut preset = oak.load().unwrap();
        let colonization = preset.settings_mut::<Colonization>().unwrap();
        colonization.parts[1].turn_deg = 30.0;
        let copy = colonization.parts[0].clone();
        colonization.parts.push(copy);
        let text = preset.edit_toml(oak.text).unwrap();
        assert_eq!(Preset::from_toml(&text).unwrap(), preset);
        assert!(only_in(oak.text, &text).is_empty(), "{text}");
        assert_eq!(only_in(&text, oak.text), ["turn = 30"]);
        preset.settings_mut::<Colonization>().unwrap().parts.truncate(1);
        let text = preset.edit_toml(oak.text).unwrap();
        assert_eq!(Preset::from_toml(&text).unwrap(), preset);
        assert!(
            text.contains("# Great limbs with heads of their own")
                && text.contains("# leaves are where the light is")
        );
    }

    #[test]
    fn another_crown_takes_its_dimensions_along() {
        let text = "id = \"a\"\n[colonization]\ncrown = \"cone\" # tall\ncrown_height = 9 # m\n";
        let mut preset = Preset::from_toml(text).unwrap();
        preset.set("crown", "sphere").unwrap();
        let edited = preset.edit_toml(text).unwrap();
        assert_eq!(Preset::from_toml(&edited).unwrap(), preset);
        assert!(edited.contains("crown = \"sphere\" # tall") && !edited.contains("crown_height"), "{edited}");
    }

    #[test]
    fn what_is_no_preset_is_written_as_a_whole() {
        let preset = builtins()[0].load().unwrap();
        assert_eq!(preset.edit_toml("axiom=F").unwrap(), preset.to_toml().unwrap());
    }
}
