//! Tags: words that presets are found by.

use linden_base::document::{Datum, Entry, Fault};
use linden_base::knob::excerpt;

/// The key of a document's tags.
pub(super) const TAGS: &str = "tags";

/// Tags of one preset.
pub const MOST_TAGS: usize = 32;

/// Letters of a tag.
const LONGEST: usize = 32;

/// Whether a word may be a tag: letters, digits, `-` and `_`, no capitals.
///
/// ```
/// use linden_pipeline::preset::check_tag;
/// assert!(check_tag("in-bloom").is_ok() && check_tag("In bloom").is_err());
/// ```
///
/// # Errors
/// What is wrong with it.
pub fn check_tag(tag: &str) -> Result<(), String> {
    let is_one = |c: char| (c.is_alphanumeric() && !c.is_uppercase()) || c == '-' || c == '_';
    if tag.is_empty() || !tag.chars().all(is_one) {
        return Err(format!("'{}' is no tag: it takes small letters, digits, - and _", excerpt(tag)));
    }
    if tag.chars().count() > LONGEST {
        return Err(format!("'{}' is longer than {LONGEST} letters, the most of a tag", excerpt(tag)));
    }
    Ok(())
}

/// Reads a document's tags, each once.
pub(super) fn read(entries: &[Entry]) -> Result<Vec<String>, Fault> {
    let Some(entry) = entries.iter().find(|entry| entry.key == TAGS) else { return Ok(Vec::new()) };
    let Datum::List(items) = &entry.node.datum else {
        return Err(entry.node.mismatch(TAGS, "a list of words, like [\"conifer\", \"evergreen\"]"));
    };
    if items.len() > MOST_TAGS {
        let problem = format!("{} tags are more than the {MOST_TAGS} that a preset may have", items.len());
        return Err(Fault::new(entry.node.place, problem));
    }
    let mut tags: Vec<String> = Vec::new();
    for item in items {
        let tag = item.text(TAGS)?;
        check_tag(tag).map_err(|problem| Fault::new(item.place.or(entry.node.place), problem))?;
        if tags.iter().all(|known| known != tag) {
            tags.push(tag.to_owned());
        }
    }
    Ok(tags)
}

#[cfg(test)]
mod tests {
    use crate::preset::Preset;

    fn document(tags: &str) -> String {
        format!("id = \"a\"\ntags = {tags} # mine\n\n[colonization]\ncrown = \"sphere\"\n")
    }

    #[test]
    fn tags_are_read_written_and_edited_in_place() {
        let text = document("[\"hedge\", \"in-bloom\", \"hedge\"]");
        let mut preset = Preset::from_toml(&text).unwrap();
        assert_eq!(preset.tags, ["hedge", "in-bloom"]);
        for text in [preset.to_toml().unwrap(), preset.to_toml_changed().unwrap()] {
            assert_eq!(Preset::from_toml(&text).unwrap(), preset, "{text}");
        }
        assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
        preset.tags = vec!["old".to_owned()];
        assert_eq!(preset.edit_toml(&text).unwrap(), document("[\"old\"]"));
        preset.tags.clear();
        let none = preset.edit_toml(&text).unwrap();
        assert!(!none.contains("tags") && Preset::from_toml(&none).unwrap() == preset, "{none}");
    }

    #[test]
    fn what_is_no_tag_is_said_with_its_place() {
        let many = format!("[{}]", "\"a\", ".repeat(33));
        for (tags, place, said) in [
            ("\"hedge\"", "2:8", "expected a list of words"),
            ("[\"Hedge\"]", "2:9", "'Hedge' is no tag"),
            ("[\"a b\"]", "2:9", "small letters"),
            ("[3]", "2:9", "text in quotes"),
            (&many, "2:8", "33 tags are more than the 32"),
        ] {
            let message = Preset::from_toml(&document(tags)).unwrap_err().to_string();
            assert!(message.starts_with(place) && message.contains(said), "{tags}: {message}");
        }
    }
}
