//! What a document says of the program and of the tree that it is from, and whether they are these.
//!
//! A recipe carries the version that wrote it and hashes: of itself, and, in a file, of the whole tree that was
//! grown, whatever level of it the file holds:
//! `"linden":"0.2.0 (abc1234)","hash":{"recipe":"…","skeleton":"…","organs":"…"}`, each of 32 hexadecimal digits.

use std::fmt;

use linden_base::knob::excerpt;
use serde::Deserialize;
use serde_json::Value;
use xxhash_rust::xxh3::xxh3_128;

use crate::grow::Grown;
use crate::preset::AGES;
use crate::recipe::{Recipe, VERSION};

/// Keys of a document that decide nothing of a tree: who wrote it, what it is called, what it could be turned to.
const ASIDE: [&str; 9] = ["linden", "hash", "id", "name", "group", "summary", "source", "about", AGES];

/// The fingerprints of a grown tree: [`Skeleton::hash`](crate::Skeleton::hash) and
/// [`Organs::hash`](crate::foliage::Organs::hash).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeHash {
    /// Of nodes, parents, radii, births and axes.
    pub skeleton: u128,
    /// Of all that grows on them.
    pub organs: u128,
}

/// As documents have them: `skeleton …, organs …`, 32 hexadecimal digits each.
impl fmt::Display for TreeHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "skeleton {}, organs {}", hash_text(self.skeleton), hash_text(self.organs))
    }
}

/// Where a recipe comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// The version of linden that wrote it, as [`VERSION`] is this one.
    pub version: Option<String>,
    /// The tree that it grew then; `None` where its document says nothing of that, or was changed by hand since.
    pub tree: Option<TreeHash>,
    /// The recipe as it was read.
    recipe_hash: u128,
}

/// What documents say of themselves.
#[derive(Deserialize)]
struct Said {
    linden: Option<String>,
    hash: Option<SaidHashes>,
}

#[derive(Deserialize)]
struct SaidHashes {
    recipe: String,
    skeleton: Option<String>,
    organs: Option<String>,
}

impl Provenance {
    /// What the document (JSON) that a recipe was read from says; nothing where it is none of linden's.
    pub fn of(json: &str, recipe: &Recipe) -> Self {
        let said = serde_json::from_str(json).unwrap_or(Said { linden: None, hash: None });
        let is_unchanged = |hash: &SaidHashes| number(&hash.recipe) == document_hash(json);
        let tree = said.hash.filter(is_unchanged).and_then(|hash| {
            Some(TreeHash { skeleton: number(&hash.skeleton?)?, organs: number(&hash.organs?)? })
        });
        Self { version: said.linden, tree, recipe_hash: recipe.hash() }
    }

    /// The version that wrote it, where that is not this one.
    pub fn other_version(&self) -> Option<&str> {
        self.version.as_deref().filter(|&version| version != VERSION)
    }

    /// Says so for people, of the document.
    pub fn version_note(&self) -> Option<String> {
        Some(format!("made by linden {}, this is linden {VERSION}", excerpt(self.other_version()?)))
    }

    /// Says for people whether a tree that was grown is the one that was grown then. Nothing is said of a tree that
    /// is the same by the same version, where that is not known, and where `recipe` was changed since it was read.
    pub fn tree_note(&self, recipe: &Recipe, grown: &Grown) -> Option<String> {
        let then = self.tree?;
        if recipe.hash() != self.recipe_hash {
            return None;
        }
        let now = grown.hash();
        let what = match (now.skeleton == then.skeleton, now.organs == then.organs) {
            (true, true) => {
                let other = excerpt(self.other_version()?);
                return Some(format!("the same tree as linden {other} grew, bit for bit"));
            }
            (false, true) => "its skeleton differs",
            (true, false) => "its leaves and other organs differ",
            (false, false) => "its skeleton and its organs differ",
        };
        Some(format!("not the tree that the recipe was made with: {what}"))
    }
}

/// As documents have it: 32 hexadecimal digits.
pub fn hash_text(hash: u128) -> String {
    format!("{hash:032x}")
}

fn number(hash: &str) -> Option<u128> {
    u128::from_str_radix(hash, 16).ok().filter(|&number| hash_text(number) == hash)
}

/// The hash of a document's recipe or forest; `None` for what is no JSON.
pub(crate) fn document_hash(json: &str) -> Option<u128> {
    let document = serde_json::from_str(json).ok()?;
    Some(xxh3_128(canonical(&document, true).as_bytes()))
}

/// A value without white space, its keys sorted; of a document only what decides.
fn canonical(value: &Value, is_document: bool) -> String {
    match value {
        Value::Object(map) => {
            let mut entries: Vec<_> =
                map.iter().filter(|(key, _)| !(is_document && ASIDE.contains(&key.as_str()))).collect();
            // Whether the map itself is sorted is up to how serde_json was built.
            entries.sort_unstable_by_key(|(key, _)| key.as_str());
            // Forests have the recipes of their trees.
            let entry = |(key, value): (&String, &Value)| {
                format!("{}:{}", Value::from(key.as_str()), canonical(value, key == "recipe"))
            };
            format!("{{{}}}", entries.into_iter().map(entry).collect::<Vec<_>>().join(","))
        }
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(|value| canonical(value, false)).collect();
            format!("[{}]", values.join(","))
        }
        plain => plain.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;
    use linden_plant::season::Season;

    use super::*;
    use crate::dress::year;
    use crate::grow::grow;
    use crate::preset::{Preset, builtin};

    fn recipe(knobs: &[(&str, &str)]) -> Recipe {
        let mut preset = builtin("dressed-simple").unwrap().load().unwrap();
        for (name, value) in [("points", "60"), ("bark_size", "64")].iter().chain(knobs) {
            preset.set(name, value).unwrap();
        }
        Recipe::new(preset)
    }

    fn read(line: &str) -> Recipe {
        Recipe::new(Preset::from_json(line).unwrap())
    }

    /// Another letter at the end of a hash.
    fn tampered(line: &str, hash: u128) -> String {
        assert_eq!(line.matches(&hash_text(hash)).count(), 1, "{line}");
        line.replace(&hash_text(hash), &hash_text(hash ^ 1))
    }

    #[test]
    fn a_hash_is_of_what_decides_and_of_nothing_else() {
        let fir = recipe(&[]);
        let line = fir.to_line();
        assert_eq!(document_hash(&line), Some(fir.hash()));
        assert_eq!(read(&line).hash(), fir.hash());
        // Written by another program: other white space, another order.
        let mut entries: Vec<_> = serde_json::from_str::<std::collections::BTreeMap<String, Value>>(&line)
            .unwrap()
            .into_iter()
            .collect();
        entries.reverse();
        let entries: Vec<String> =
            entries.iter().map(|(key, value)| format!("{key:?} :\n {value:#}")).collect();
        let foreign = format!("{{ {} }}", entries.join(" ,\n"));
        assert_ne!(foreign, line);
        assert_eq!(document_hash(&foreign), Some(fir.hash()));
        let mut named = fir.clone();
        (named.preset.id, named.preset.name) = ("other".to_owned(), "Other".to_owned());
        (named.preset.about, named.preset.source) = ("long".to_owned(), "a paper".to_owned());
        assert_eq!(named.hash(), fir.hash());
        for (name, value) in
            [("seed", "2"), ("points", "61"), ("lods", "2"), ("season", "0.1"), ("wind", "sway")]
        {
            assert_ne!(recipe(&[(name, value)]).hash(), fir.hash(), "{name}");
        }
    }

    #[test]
    fn what_files_hold_counts() {
        let heart = builtin("heart").unwrap().recipe(&Quiet).unwrap();
        let (file, other) = (heart.preset.files()[0].to_owned(), b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let mut changed = heart.clone();
        changed.inputs.insert(&file, crate::recipe::Input::read(&file, other, &Quiet).unwrap());
        assert_ne!(changed.hash(), heart.hash());
    }

    #[test]
    fn another_version_is_named_and_the_tree_is_compared() {
        let simple = recipe(&[]);
        let grown = grow(&simple, &Quiet).unwrap();
        let line = simple.to_line_of(grown.hash());
        let said = |line: &str| {
            let recipe = read(line);
            let provenance = Provenance::of(line, &recipe);
            (provenance.version_note(), provenance.tree_note(&recipe, &grown))
        };
        assert_eq!(said(&line), (None, None));
        assert_eq!(said(&simple.to_line()), (None, None), "nothing grew yet");
        let older = line.replace(&format!("\"linden\":\"{VERSION}\""), "\"linden\":\"0.0.9\\u001b[2J\"");
        let (version, tree) = said(&older);
        let version = version.unwrap();
        assert!(version.starts_with("made by linden 0.0.9") && version.ends_with(VERSION), "{version}");
        assert!(!version.contains('\u{1b}'));
        assert!(tree.unwrap().starts_with("the same tree as linden 0.0.9"));
        let TreeHash { skeleton, organs } = grown.hash();
        for (line, expected) in [
            (tampered(&line, skeleton), "not the tree that the recipe was made with: its skeleton differs"),
            (
                tampered(&older, organs),
                "not the tree that the recipe was made with: its leaves and other organs differ",
            ),
            (
                tampered(&tampered(&line, organs), skeleton),
                "not the tree that the recipe was made with: its skeleton and its organs differ",
            ),
        ] {
            assert_eq!(said(&line).1.as_deref(), Some(expected));
        }
        // Changed by hand, or by a knob: it is another recipe, whose tree was not grown before.
        let edited = tampered(&line, skeleton).replace("\"points\":60", "\"points\":61");
        assert_eq!(said(&edited), (None, None));
        let provenance = Provenance::of(&tampered(&line, skeleton), &simple);
        assert_eq!(provenance.tree_note(&recipe(&[("lods", "2")]), &grown), None);
        assert!(provenance.tree_note(&simple, &grown).is_some());
        // None of linden's, or of before there were hashes.
        let none = Provenance { version: None, tree: None, recipe_hash: simple.hash() };
        for json in ["{\"id\":\"fir\"}", "{\"linden\":3}", "no json", "{\"hash\":{\"recipe\":\"\"}}"] {
            assert_eq!(Provenance::of(json, &simple), none, "{json}");
        }
    }

    /// A file of one season says how that season's tree grows again, and its hashes.
    #[test]
    fn each_season_says_the_hashes_of_its_tree() {
        let recipe = recipe(&[("triangles", "3000"), ("lods", "2")]);
        let whole = grow(&recipe, &Quiet).unwrap();
        let year = year(&recipe, &whole, &Season::parse_list("summer,bare").unwrap(), &Quiet).unwrap();
        let mut seen = Vec::new();
        for (season, levels) in &year.seasons {
            for line in levels.iter().map(|level| &level.scene.recipe) {
                let of_season = read(line);
                let grown = grow(&of_season, &Quiet).unwrap();
                let provenance = Provenance::of(line, &of_season);
                assert_eq!(provenance.tree, Some(grown.hash()), "{}", season.name);
            }
            seen.push(Provenance::of(&levels[0].scene.recipe, &recipe).tree.unwrap());
            assert_eq!((levels.len(), seen.last().unwrap().skeleton), (2, whole.hash().skeleton));
        }
        assert!(seen.len() == 2 && seen[0].organs != seen[1].organs);
        assert_eq!(Provenance::of(&year.stage().recipe, &recipe).tree, Some(whole.hash()));
    }
}
