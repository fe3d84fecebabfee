//! A forest's text: TOML as people write it, JSON as files carry it.
//!
//! ```toml
//! id = "wood"          # what files are called; without, the document's own name
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

use super::{Layout, LayoutError};
use linden_base::document::{Datum, Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{Kind, excerpt, printable};

/// The keys of a forest that are no knobs.
const HEADINGS: [&str; 4] = ["id", "name", "summary", "linden"];

/// The list of kinds.
const TREES: List = List { key: "tree", heading: "[[tree]]", one: "tree", most: (1000, "a forest") };

/// What a kind of trees may say.
const TREE_KEYS: [&str; 4] = ["preset", "share", "size", "set"];

/// Parts of a whole, by their sum.
const SHARE: Kind = Kind::Real { min: 1e-9, max: 1e9, auto: false, names: &[] };

/// As the scale of a part of a crown.
const SIZE: Kind = Kind::Real { min: 1e-3, max: 1e3, auto: false, names: &[] };

/// A forest as its document has it: the presets are still names.
#[derive(Clone, Debug)]
pub struct ForestDocument {
    /// What its files are called after; `None`: after the document's file.
    pub id: Option<String>,
    /// Its name for people; may be empty.
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
    /// Where the tree is described.
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
            return Self::from_json(text);
        }
        let document = Node::from_toml(text)?;
        let Datum::Table(entries) = &document.datum else {
            return Err(Fault { place: document.place, message: "a forest is a table of keys".to_owned() });
        };
        let mut forest = Self { trees: Vec::new(), ..Self::empty() };
        for entry in entries {
            match entry.key.as_str() {
                "id" => forest.id = Some(entry.node.text("id")?.to_owned()),
                "name" => entry.node.text("name")?.clone_into(&mut forest.name),
                "summary" => entry.node.text("summary")?.clone_into(&mut forest.summary),
                "tree" => forest.trees = TREES.read(&entry.node, tree_line)?,
                name if HEADINGS.contains(&name) => drop(typed(entry)?),
                name => {
                    // A name that is no knob's is wrong whatever it holds.
                    Layout::find(name).map_err(|error| fault_at(entry, &error))?;
                    forest.layout.set(name, &typed(entry)?).map_err(|error| fault_at(entry, &error))?;
                }
            }
        }
        forest.checked()
    }

    /// Reads what a file carries: JSON.
    fn from_json(text: &str) -> Result<Self, Fault> {
        let raw: Json<'_> = serde_json::from_str(text).map_err(|error| Fault {
            place: Some(TextPlace { line: error.line(), column: error.column() }),
            message: format!("not a forest: {}", printable(&error.to_string())),
        })?;
        let fault = |message: String| Fault { place: None, message };
        let mut forest = Self { id: raw.id, name: raw.name, summary: raw.summary, ..Self::empty() };
        // Which version wrote it decides nothing.
        for (name, value) in raw.knobs.iter().filter(|(name, _)| !HEADINGS.contains(&name.as_str())) {
            forest.layout.set(name, &value.text()).map_err(|error| fault(error.to_string()))?;
        }
        for (number, tree) in (1..).zip(raw.tree) {
            let source = match (tree.preset, tree.recipe) {
                (None, Some(recipe)) => TreeSource::Recipe(recipe.get().to_owned()),
                (Some(preset), _) => TreeSource::Named(preset),
                (None, None) => return Err(fault(needs_preset(number))),
            };
            for (name, kind, x) in [("share", &SHARE, tree.share), ("size", &SIZE, tree.size)] {
                let value = linden_base::knob::Value::Real(x);
                kind.check(&value)
                    .map_err(|problem| fault(format!("'{name}' of tree {number}: {problem}")))?;
            }
            let set = tree.set.into_iter().map(|(name, value)| (name, value.text())).collect();
            forest.trees.push(TreeLine { source, share: tree.share, size: tree.size, set });
        }
        forest.checked()
    }

    fn empty() -> Self {
        let (name, summary) = (String::new(), String::new());
        Self { id: None, name, summary, layout: Layout::default(), trees: Vec::new() }
    }

    fn checked(self) -> Result<Self, Fault> {
        if self.id.as_ref().is_some_and(|id| id.trim().is_empty()) {
            let message = "'id' is empty: name the forest, like id = \"park\", or leave it out".to_owned();
            return Err(Fault { place: None, message });
        }
        if self.trees.is_empty() {
            let message = "a forest needs at least one [[tree]] with its preset".to_owned();
            return Err(Fault { place: None, message });
        }
        Ok(self)
    }
}

fn fault_at(entry: &Entry, error: &LayoutError) -> Fault {
    Fault { place: entry.place, message: error.to_string() }
}

fn needs_preset(number: usize) -> String {
    format!("tree {number} needs a preset: preset = \"fir\"")
}

/// One `[[tree]]`.
fn tree_line(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<TreeLine, Fault> {
    let mut preset = String::new();
    let (mut share, mut size, mut set) = (1.0, 1.0, BTreeMap::new());
    let real = |entry: &Entry, kind: &Kind| match entry.node.value(&entry.key, kind)? {
        linden_base::knob::Value::Real(x) => Ok(x),
        _ => Err(entry.node.mismatch(&entry.key, &kind.to_string())),
    };
    for entry in entries {
        match entry.key.as_str() {
            "preset" => entry.node.text("preset")?.clone_into(&mut preset),
            "share" => share = real(entry, &SHARE)?,
            "size" => size = real(entry, &SIZE)?,
            "set" => {
                let Datum::Table(knobs) = &entry.node.datum else {
                    return Err(entry.node.mismatch("set", "a table of knobs like { points = 500 }"));
                };
                for knob in knobs {
                    set.insert(knob.key.clone(), typed(knob)?);
                }
            }
            _ => return Err(TREES.unknown(number, entry, &TREE_KEYS)),
        }
    }
    if preset.trim().is_empty() {
        return Err(Fault { place, message: needs_preset(number) });
    }
    Ok(TreeLine { source: TreeSource::Named(preset), share, size, set })
}

/// A knob's value as it would be typed.
fn typed(entry: &Entry) -> Result<String, Fault> {
    match &entry.node.datum {
        Datum::Text(text) => Ok(text.clone()),
        Datum::Real(x) => Ok(x.to_string()),
        Datum::Integer(n) => Ok(n.to_string()),
        Datum::Switch(on) => Ok(on.to_string()),
        Datum::List(_) | Datum::Table(_) => {
            Err(entry.node.mismatch(&excerpt(&entry.key), "a number, text, true or false"))
        }
    }
}

/// As JSON has it; a recipe is kept letter by letter, which only JSON's reader can.
struct Json<'a> {
    id: Option<String>,
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
                let mut json = Json { id: None, name, summary, tree: Vec::new(), knobs: BTreeMap::new() };
                while let Some(key) = map.next_key::<String>()? {
                    match key.as_str() {
                        "id" => json.id = map.next_value()?,
                        "name" => json.name = map.next_value()?,
                        "summary" => json.summary = map.next_value()?,
                        "tree" => json.tree = map.next_value()?,
                        "hash" => drop(map.next_value::<serde::de::IgnoredAny>()?),
                        _ => drop(json.knobs.insert(key, map.next_value()?)),
                    }
                }
                Ok(json)
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
    use crate::provenance::document_hash;
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
        assert_eq!(
            document_hash(&line),
            Some(forest.hash()),
            "who wrote it and what it is called count for nothing"
        );
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
            ("[[tree]]\n", "tree 1 needs a preset"),
            (
                "[[tree]]\npreset = \"fir\"\nshares = 2\n",
                "3:1: tree 1 has no 'shares' (did you mean 'share'?)",
            ),
            (
                "arae = 3\n[[tree]]\npreset = \"fir\"\n",
                "1:1: a forest has no knob 'arae' (did you mean 'area'?)",
            ),
            ("id = \" \"\n[[tree]]\npreset = \"fir\"\n", "'id' is empty"),
            ("\narea = 0\n[[tree]]\npreset = \"fir\"\n", "2:1: knob 'area'"),
            ("[[tree]]\npreset = \"fir\"\n[[obstacle]]\nx = 1\n", "a forest has no knob 'obstacle'"),
            ("area = [1]\n[[tree]]\npreset = \"fir\"\n", "1:8: 'area' is a list"),
            ("area = 1e60\n[[tree]]\npreset = \"fir\"\n", "1:1: knob 'area' of a forest"),
            ("[[tree]]\npreset = \"fir\"\nsize = 1e60\n", "3:8: knob 'size'"),
            ("[[tree]]\npreset = \"fir\"\nshare = 0\n", "3:9: knob 'share'"),
            ("[[tree]]\npreset = \"fir\"\nset = { root = [1] }\n", "3:16: 'root' is a list"),
            ("tree = 3\n", "1:8: 'tree' is a number, expected tables, each headed [[tree]]"),
            ("{\"tree\": [{\"preset\": \"fir\", \"size\": 1e60}]}", "'size' of tree 1"),
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
