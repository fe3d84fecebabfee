//! The recipe out of a glTF document: `extras.linden` of the first node that has it. All else is passed
//! over while it is read: buffers inside a `.gltf` are never held.

use std::fmt;
use std::io::{self, Read};

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use crate::recipe::{Readable, begins, word};

/// The type of the chunk that holds the document: `JSON`.
const JSON: u32 = 0x4e4f_534a;

/// Of a `.glb`, whose first chunk is the document.
pub(super) fn in_binary(file: &mut dyn Readable) -> io::Result<Option<String>> {
    match document_bytes(file)? {
        Some(bytes) => in_document(&mut file.take(bytes)),
        None => Ok(None),
    }
}

/// The length of a `.glb`'s document, where the file then stands; `None` where it is no `.glb`.
pub(super) fn document_bytes(file: &mut dyn Readable) -> io::Result<Option<u64>> {
    if !begins(file, b"glTF\x02\0\0\0")? {
        return Ok(None);
    }
    let _length = word(file)?;
    let bytes = word(file)?;
    Ok((word(file)? == JSON).then_some(bytes.into()))
}

/// Of a `.gltf`.
pub(super) fn in_text(file: &mut dyn Readable) -> io::Result<Option<String>> {
    if file.fill_buf()?.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        return Ok(None);
    }
    in_document(file)
}

fn in_document(json: &mut dyn Read) -> io::Result<Option<String>> {
    let mut deserializer = serde_json::Deserializer::from_reader(json);
    match Document::deserialize(&mut deserializer) {
        Ok(Document(found)) => Ok(found),
        Err(error) if error.is_io() => Err(error.into()),
        Err(_) => Ok(None),
    }
}

struct Document(Option<String>);

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = Document;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a glTF document")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut found = None;
                while let Some(key) = map.next_key::<String>()? {
                    if key == "nodes" {
                        found = map.next_value::<Nodes>()?.0;
                    } else {
                        map.next_value::<IgnoredAny>()?;
                    }
                }
                Ok(Document(found))
            }
        }
        deserializer.deserialize_map(Keys)
    }
}

/// The first recipe of a list of nodes.
struct Nodes(Option<String>);

impl<'de> Deserialize<'de> for Nodes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Each;
        impl<'de> Visitor<'de> for Each {
            type Value = Nodes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of nodes")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut nodes: A) -> Result<Self::Value, A::Error> {
                let mut found = None;
                while found.is_none() {
                    let Some(node) = nodes.next_element::<Node>()? else { return Ok(Nodes(None)) };
                    found = node.extras.and_then(|extras| recipe_of(extras.get()));
                }
                while nodes.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Nodes(found))
            }
        }
        deserializer.deserialize_seq(Each)
    }
}

#[derive(Deserialize)]
struct Node {
    /// Other programs' may be anything.
    extras: Option<Box<RawValue>>,
}

fn recipe_of(extras: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Extras<'a> {
        #[serde(borrow)]
        linden: &'a RawValue,
    }
    let Extras { linden } = serde_json::from_str(extras).ok()?;
    // What is no object was written as a string, and importers make strings of objects too.
    let text = linden.get();
    if text.starts_with('"') { serde_json::from_str(text).ok() } else { Some(text.to_owned()) }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn read(json: &str) -> Option<String> {
        in_text(&mut Cursor::new(json)).unwrap()
    }

    #[test]
    fn the_first_node_that_has_one_counts() {
        let recipe = r#"{"z":0.30000000000000004,"id":"\u00f6"}"#;
        let with = |extras: &str| {
            format!(r#" {{"asset":{{}},"nodes":[{{"name":"Camera","extras":7}},{extras}],"x":[1]}}"#)
        };
        assert_eq!(
            read(&with(&format!(r#"{{"extras":{{"a":[],"linden":{recipe}}}}}"#))).as_deref(),
            Some(recipe)
        );
        let string = serde_json::to_string(recipe).unwrap();
        assert_eq!(read(&with(&format!(r#"{{"extras":{{"linden":{string}}}}}"#))).as_deref(), Some(recipe));
        assert_eq!(read(&with(r#"{"extras":{"other":1}},{"mesh":0}"#)), None);
        for none in ["{}", "{\"nodes\":3}", "{\"nodes\":[", "[]", "", "{\"id\":\"fir\",\"lsystem\":{}}"] {
            assert_eq!(read(none), None, "{none}");
        }
    }
}
