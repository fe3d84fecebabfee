//! A forest's document with other values of its knobs: what its author wrote stays.

use toml_edit::{DocumentMut, Item, Value};

use linden_base::document::Fault;

use super::{ForestDocument, Layout};

impl ForestDocument {
    /// The TOML document `text` with the knobs of `layout`: only those that differ are changed or added. Comments,
    /// order and everything else stay. With a `name` the forest is called so.
    ///
    /// ```
    /// use linden_pipeline::forest::ForestDocument;
    /// let text = "area = 30 # the meadow\n\n[[tree]]\npreset = \"fir\"\n";
    /// let mut layout = ForestDocument::parse(text)?.layout;
    /// layout.set("area", "40.5").unwrap();
    /// assert_eq!(ForestDocument::edit_toml(text, &layout, None)?, text.replace("30", "40.5"));
    /// # Ok::<(), linden_base::document::Fault>(())
    /// ```
    ///
    /// # Errors
    /// Why `text` is no forest's document in TOML.
    pub fn edit_toml(text: &str, layout: &Layout, name: Option<&str>) -> Result<String, Fault> {
        let before = Self::parse(text)?;
        let fault = |error: toml_edit::TomlError| Fault { place: None, message: error.to_string() };
        let mut document: DocumentMut = text.parse().map_err(fault)?;
        for ((row, had), (_, wanted)) in before.layout.knobs().zip(layout.knobs()) {
            if had != wanted {
                put(&mut document, row.knob.name, number(&wanted.to_string()));
            }
        }
        if let Some(name) = name.filter(|name| *name != before.name) {
            put(&mut document, "name", name.into());
        }
        Ok(document.to_string())
    }

    /// The TOML document `text` with another id, and with that for a name where the id was its name too. One without an
    /// id, which has that of its file, stays as it is.
    ///
    /// ```
    /// use linden_pipeline::forest::ForestDocument;
    /// let text = "id = \"wood\" # mine\n\n[[tree]]\npreset = \"fir\"\n";
    /// assert_eq!(ForestDocument::rename_toml(text, "copse")?, text.replace("wood", "copse"));
    /// # Ok::<(), linden_base::document::Fault>(())
    /// ```
    ///
    /// # Errors
    /// Why `text` is no forest's document in TOML.
    pub fn rename_toml(text: &str, id: &str) -> Result<String, Fault> {
        let before = Self::parse(text)?;
        let mut document: DocumentMut = text
            .parse()
            .map_err(|error: toml_edit::TomlError| Fault { place: None, message: error.to_string() })?;
        if let Some(known) = before.id {
            put(&mut document, "id", id.into());
            if before.name == known {
                put(&mut document, "name", id.into());
            }
        }
        Ok(document.to_string())
    }
}

/// Puts a value in the place of the one that is there, with the comment behind it.
fn put(document: &mut DocumentMut, key: &str, mut value: Value) {
    if let Some(there) = document.get(key).and_then(Item::as_value) {
        *value.decor_mut() = there.decor().clone();
    }
    document.insert(key, Item::Value(value));
}

/// A knob's value as TOML has it; text where TOML has no such number: a seed beyond 2^63.
fn number(text: &str) -> Value {
    let whole = || text.parse::<i64>().ok().map(Value::from);
    let real = || text.parse::<f64>().ok().filter(|x| !is_whole(text) && x.is_finite()).map(Value::from);
    let switch = || text.parse::<bool>().ok().map(Value::from);
    whole().or_else(real).or_else(switch).unwrap_or_else(|| Value::from(text))
}

fn is_whole(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::{FOREST_KNOBS, builtin_forests};

    #[test]
    fn what_was_turned_is_read_again_and_the_rest_stays() {
        for builtin in builtin_forests() {
            let text = builtin.text;
            let mut layout = ForestDocument::parse(text).unwrap().layout;
            assert_eq!(ForestDocument::edit_toml(text, &layout, None).unwrap(), text);
            for (name, value) in [("seed", "18446744073709551615"), ("area", "41.5"), ("spacing", "5")] {
                layout.set(name, value).unwrap();
            }
            let edited = ForestDocument::edit_toml(text, &layout, Some("Mine \"2\"")).unwrap();
            let read = ForestDocument::parse(&edited).unwrap();
            assert_eq!((read.layout, read.name.as_str()), (layout, "Mine \"2\""));
            let trees = |text: &str| text[text.find("[[tree]]").unwrap()..].to_owned();
            assert_eq!(trees(&edited), trees(text));
        }
    }

    #[test]
    fn another_id_is_written_where_there_was_one() {
        let trees = "# trees\n[[tree]]\npreset = \"fir\"\n";
        for (head, renamed) in [
            ("id = \"a\"\nname = \"a\" # b\n", "id = \"c\"\nname = \"c\" # b\n"),
            ("id = \"a\"\nname = \"Mixed\"\n", "id = \"c\"\nname = \"Mixed\"\n"),
            ("name = \"a\"\n", "name = \"a\"\n"),
        ] {
            let text = ForestDocument::rename_toml(&format!("{head}{trees}"), "c").unwrap();
            assert_eq!(text, format!("{renamed}{trees}"));
        }
        assert!(ForestDocument::rename_toml("area = 3", "c").is_err());
    }

    #[test]
    fn every_knob_is_written_as_it_is_read() {
        let text = "[[tree]]\npreset = \"fir\"\n";
        let plain = ForestDocument::parse(text).unwrap().layout;
        let mut turned = 0;
        for row in FOREST_KNOBS {
            for value in ["0.5", "2", "true", "false", "grid"] {
                let mut layout = plain;
                if layout.set(row.knob.name, value).is_err() {
                    continue;
                }
                let edited = ForestDocument::edit_toml(text, &layout, None).unwrap();
                assert_eq!(ForestDocument::parse(&edited).unwrap().layout, layout, "{edited}");
                turned += 1;
            }
        }
        assert!(turned > FOREST_KNOBS.len());
    }

    #[test]
    fn what_is_no_document_is_refused() {
        let layout = Layout::default();
        assert!(ForestDocument::edit_toml("area = 3", &layout, None).is_err());
        assert!(ForestDocument::edit_toml("{\"tree\": [{\"preset\": \"fir\"}]}", &layout, None).is_err());
    }
}
