//! A forest's text: TOML as people write it, JSON as files carry it.
//!
//! ```toml
//! name = "Mixed wood"
//! area = 70            # and the other knobs of a forest
//! spacing = 6
//!
//! [[tree]]
//! preset = "fir"       # a preset's id, or a file beside this one
//! share = 3
//! size = 1.2
//! set = { points = 500 }
//! ```

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::Layout;
use crate::knob::printable;
use crate::preset::{Fault, Place};

/// A forest as its document has it: the presets are still names.
#[derive(Clone, Debug)]
pub struct ForestDocument {
    /// What people call it; may be empty.
    pub name: String,
    /// One line: what it is; may be empty.
    pub summary: String,
    /// How the trees stand.
    pub layout: Layout,
    /// The kinds of trees.
    pub trees: Vec<TreeLine>,
}

/// A kind of trees as its document has it.
#[derive(Clone, Debug)]
pub struct TreeLine {
    /// What grows.
    pub source: TreeSource,
    /// Its part of the trees.
    pub share: f64,
    /// How much larger it stands than it grows.
    pub size: f64,
    /// Knobs that are turned: name, value as typed.
    pub set: BTreeMap<String, String>,
}

/// Where a kind of trees is described.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TreeSource {
    /// A preset's id, or a file beside the document.
    Named(String),
    /// A recipe, JSON.
    Recipe(String),
}

impl ForestDocument {
    /// Reads a document: JSON where it begins with `{`, else TOML.
    ///
    /// # Errors
    /// What is wrong and where.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        if text.trim_start().starts_with('{') {
            let raw: Json<'_> = serde_json::from_str(text).map_err(|error| Fault {
                place: Some(Place { line: error.line(), column: error.column() }),
                message: format!("not a forest: {}", printable(&error.to_string())),
            })?;
            let trees = raw.tree.into_iter().map(|own| {
                let source = match (own.preset, own.recipe) {
                    (None, Some(recipe)) => TreeSource::Recipe(recipe.get().to_owned()),
                    (preset, _) => TreeSource::Named(preset.unwrap_or_default()),
                };
                (source, own.share, own.size, own.set)
            });
            return Self::of(raw.name, raw.summary, &raw.knobs, trees.collect());
        }
        let raw: Toml = toml::from_str(text).map_err(|error| Fault {
            place: error.span().map(|span| Place::at(text, span.start)),
            message: format!("not a forest: {}", printable(error.message())),
        })?;
        let trees = raw.tree.into_iter();
        let trees = trees.map(|own| (TreeSource::Named(own.preset), own.share, own.size, own.set));
        Self::of(raw.name, raw.summary, &raw.knobs, trees.collect())
    }

    fn of(
        name: String,
        summary: String,
        knobs: &BTreeMap<String, Scalar>,
        trees: Vec<(TreeSource, f64, f64, BTreeMap<String, Scalar>)>,
    ) -> Result<Self, Fault> {
        let fault = |message: String| Fault { place: None, message };
        let mut layout = Layout::default();
        // Which version wrote it decides nothing.
        for (name, value) in knobs.iter().filter(|(name, _)| *name != "linden") {
            layout.set(name, &value.text()).map_err(|error| fault(error.to_string()))?;
        }
        if trees.is_empty() {
            return Err(fault("a forest needs at least one [[tree]] with its preset".to_owned()));
        }
        let trees = trees.into_iter().map(|(source, share, size, set)| {
            if source == TreeSource::Named(String::new()) {
                return Err(fault("a [[tree]] needs a preset: preset = \"fir\"".to_owned()));
            }
            let set = set.into_iter().map(|(name, value)| (name, value.text())).collect();
            Ok(TreeLine { source, share, size, set })
        });
        Ok(Self { name, summary, layout, trees: trees.collect::<Result<_, _>>()? })
    }
}

#[derive(Deserialize)]
struct Toml {
    #[serde(default)]
    name: String,
    #[serde(default)]
    summary: String,
    #[serde(default)]
    tree: Vec<TomlTree>,
    #[serde(flatten)]
    knobs: BTreeMap<String, Scalar>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TomlTree {
    preset: String,
    #[serde(default = "one")]
    share: f64,
    #[serde(default = "one")]
    size: f64,
    #[serde(default)]
    set: BTreeMap<String, Scalar>,
}

/// As [`Toml`]; a recipe is kept letter by letter, which only JSON's reader can.
struct Json<'a> {
    name: String,
    summary: String,
    tree: Vec<JsonTree<'a>>,
    knobs: BTreeMap<String, Scalar>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonTree<'a> {
    preset: Option<String>,
    #[serde(borrow)]
    recipe: Option<&'a RawValue>,
    #[serde(default = "one")]
    share: f64,
    #[serde(default = "one")]
    size: f64,
    #[serde(default)]
    set: BTreeMap<String, Scalar>,
}

// `flatten` would buffer the values, and raw ones with them: so by hand.
impl<'de: 'a, 'a> Deserialize<'de> for Json<'a> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Json<'de>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a forest")
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let (name, summary) = (String::new(), String::new());
                let mut own = Json { name, summary, tree: Vec::new(), knobs: BTreeMap::new() };
                while let Some(key) = map.next_key::<String>()? {
                    match key.as_str() {
                        "name" => own.name = map.next_value()?,
                        "summary" => own.summary = map.next_value()?,
                        "tree" => own.tree = map.next_value()?,
                        _ => drop(own.knobs.insert(key, map.next_value()?)),
                    }
                }
                Ok(own)
            }
        }
        deserializer.deserialize_map(Visitor)
    }
}

fn one() -> f64 {
    1.0
}

/// A knob's value as TOML and JSON have it.
#[derive(Deserialize)]
#[serde(untagged)]
enum Scalar {
    Switch(bool),
    Integer(u64),
    Real(f64),
    Text(String),
}

impl Scalar {
    /// As it would be typed.
    fn text(&self) -> String {
        match self {
            Self::Switch(on) => on.to_string(),
            Self::Integer(n) => n.to_string(),
            Self::Real(x) => x.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::Forest;
    use crate::preset::{Preset, builtin};
    use crate::recipe::Recipe;

    #[test]
    fn a_forest_comes_back_from_its_line() {
        let recipe = |id: &str| Recipe::new(builtin(id).unwrap().load().unwrap());
        let mut forest = Forest::of(vec![recipe("fir"), recipe("abop-a")]);
        forest.name = "Fünf \"Tannen\"".to_owned();
        forest.layout.set("seed", "18446744073709551615").unwrap();
        forest.layout.set("spacing", "0.30000000000000004").unwrap();
        forest.kinds[1].share = 0.1;
        let line = forest.to_line();
        assert!(line.bytes().all(|byte| (b' '..=b'~').contains(&byte)));
        let back = ForestDocument::parse(&line).unwrap();
        assert_eq!((&back.name, back.layout), (&forest.name, forest.layout));
        for (kind, tree) in forest.kinds.iter().zip(&back.trees) {
            assert_eq!((kind.share, kind.size), (tree.share, tree.size));
            let TreeSource::Recipe(json) = &tree.source else { panic!("{:?}", tree.source) };
            assert_eq!(Preset::from_json(json).unwrap(), kind.recipe.preset);
        }
    }

    #[test]
    fn faults_are_told_with_their_place() {
        for (text, expected) in [
            ("area = 3\n", "at least one [[tree]]"),
            ("[[tree]]\n", "missing field `preset`"),
            ("[[tree]]\npreset = \"fir\"\nshares = 2\n", "3:1: not a forest: unknown field `shares`"),
            ("arae = 3\n[[tree]]\npreset = \"fir\"\n", "did you mean 'area'"),
            ("area = 0\n[[tree]]\npreset = \"fir\"\n", "knob 'area'"),
            ("area = [1]\n[[tree]]\npreset = \"fir\"\n", "not a forest"),
            ("{\"tree\": 3}", "1:10: not a forest"),
            ("{\"tree\": [{}]}", "needs a preset"),
            ("{\"tree\": [{\"preset\": \"\\u001b[2J\"}], \"x\": 1}", "no knob 'x'"),
        ] {
            let said = ForestDocument::parse(text).unwrap_err().to_string();
            assert!(said.contains(expected), "{text:?}: {said}");
            assert!(!said.contains('\u{1b}'));
        }
    }
}
