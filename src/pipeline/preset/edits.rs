//! Edits of the wood in documents: tables headed `[[edit]]`.

use linden_base::document::{Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{did_you_mean, excerpt, nearest};
use linden_skeleton::edit::{EDIT_KNOBS, EDIT_PATHS, Edit, MOST_EDITS, Operation};
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::Preset;
use super::write::Plain;

/// The key of the list of edits.
pub const EDITS: &str = "edit";

/// The key of an edit that names its operation.
pub const EDIT_OPERATION: &str = "do";

const LIST: List = List { key: EDITS, heading: "[[edit]]", one: "edit", most: (MOST_EDITS, "a tree") };

/// A mistake in an edit that is given in short.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("edit '{}': {problem}", excerpt(.text))]
pub struct ShortEditError {
    /// As it was given.
    pub text: String,
    /// What is wrong, and what was expected.
    pub problem: String,
}

impl Preset {
    /// Adds an edit of the wood, as `--edit text` does: `remove stem/12`, `bend stem/4 30 towards=0,-1,0`.
    ///
    /// ```
    /// let mut oak = linden_pipeline::preset::builtin("oak")?.load()?;
    /// oak.edit("cut stem/4 0.5")?;
    /// assert_eq!(oak.edits[0].to_string(), "cut stem/4");
    /// let error = oak.edit("bemd stem/4 30").unwrap_err();
    /// assert!(error.to_string().contains("did you mean 'bend'"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// What is wrong with the text; more edits than a tree may have.
    pub fn edit(&mut self, text: &str) -> Result<(), ShortEditError> {
        let refused = |problem| ShortEditError { text: text.to_owned(), problem };
        let edit: Edit = text.parse().map_err(refused)?;
        if self.edits.len() >= MOST_EDITS {
            return Err(refused(format!(
                "there are {MOST_EDITS} edits already, the most that a tree may have"
            )));
        }
        self.edits.push(edit);
        Ok(())
    }

    /// Whether another preset grows the same tree before its wood is edited and covered, from the same files: then
    /// [`reedit`](crate::grow::reedit) makes its tree of this one's.
    ///
    /// ```
    /// let oak = linden_pipeline::preset::builtin("oak")?.load()?;
    /// let mut other = oak.clone();
    /// other.edit("cut stem 0.5")?;
    /// other.set("leaf_form", "none")?;
    /// assert!(oak.grows_as(&other));
    /// other.set("seed", "7")?;
    /// assert!(!oak.grows_as(&other));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn grows_as(&self, other: &Self) -> bool {
        let Self { seed, generator, refinement, wood, .. } = self;
        *seed == other.seed
            && *generator == other.generator
            && *refinement == other.refinement
            && *wood == other.wood
    }
}

/// Reads the list of edits.
pub(super) fn read(node: &Node) -> Result<Vec<Edit>, Fault> {
    LIST.read(node, read_one)
}

fn read_one(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<Edit, Fault> {
    let words = Operation::WORDS;
    let Some(entry) = entries.iter().find(|entry| entry.key == EDIT_OPERATION) else {
        let words = words.join(", ");
        return Err(Fault::new(
            place,
            format!("edit {number} has no '{EDIT_OPERATION}'; give it one of: {words}"),
        ));
    };
    let word = entry.node.text(EDIT_OPERATION)?;
    let Some(mut edit) = Edit::named(word) else {
        let instead = match nearest(word, words.iter().copied()) {
            meant @ Some(_) => did_you_mean(meant),
            None => format!("; expected one of: {}", words.join(", ")),
        };
        let word = excerpt(word);
        return Err(Fault::new(
            entry.node.place,
            format!("edit {number}: nothing is called '{word}'{instead}"),
        ));
    };
    for entry in entries.iter().filter(|entry| entry.key != EDIT_OPERATION) {
        take(number, &mut edit, entry)?;
    }
    edit.check().map_err(|problem| Fault::new(place, format!("edit {number}: {problem}")))?;
    Ok(edit)
}

/// Takes what an entry says into an edit.
fn take(number: usize, edit: &mut Edit, entry: &Entry) -> Result<(), Fault> {
    let key = entry.key.as_str();
    if EDIT_PATHS.iter().any(|row| row.name == key && row.is_of(&edit.operation)) {
        let text = entry.node.text(key)?;
        let path = text
            .parse()
            .map_err(|problem| Fault::new(entry.node.place, format!("edit {number}: {problem}")))?;
        edit.set_path(key, path);
        return Ok(());
    }
    let row = EDIT_KNOBS.iter().find(|row| row.knob.is_called(key) && row.is_of(&edit.operation));
    let Some(row) = row else {
        return Err(Fault::new(entry.place, format!("edit {number}: {}", edit.unknown(key))));
    };
    let value = entry.node.value(key, &row.knob.kind)?;
    edit.set(key, value);
    Ok(())
}

/// An edit as documents have it: all keys, also those that stand at their default.
pub(super) struct WrittenEdit<'a>(pub &'a Edit);

impl Serialize for WrittenEdit<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(EDIT_OPERATION, self.0.operation.word())?;
        for (key, path) in self.0.paths() {
            map.serialize_entry(key, &path.to_string())?;
        }
        for (knob, value) in self.0.knobs() {
            map.serialize_entry(knob.name, &Plain(value))?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::builtin;
    use crate::recipe::Recipe;

    const BUSH: &str = "id = \"bush\" # mine\n\n[colonization]\ncrown = \"sphere\"\npoints = 500 # enough\n";
    const EDITS: &str = "
# the ugly one
[[edit]]
do = \"remove\"
axis = \"stem/12\"
near = [0.5, 4, -0.25]
branching = 7

[[edit]]
do = \"bend\" # towards the path
axis = \"stem/4\"
angle = 40
towards = [0, -1, 0]

[[edit]]
do = \"copy\"
axis = \"stem\"
from = \"stem/4\"
at_m = 1.5

[[edit]]
do = \"curve\"
axis = \"new\"
points = [0, 1, 0, 0.5, 2, 0]
";

    fn fault(text: &str) -> String {
        Preset::from_toml(&format!("{BUSH}{text}")).unwrap_err().to_string()
    }

    #[test]
    fn edits_are_read_written_and_part_of_the_recipe() {
        let text = format!("{BUSH}{EDITS}");
        let preset = Preset::from_toml(&text).unwrap();
        let said: Vec<String> = preset.edits.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "remove stem/12",
                "bend stem/4 40 towards=0,-1,0",
                "copy stem stem/4 at_m=1.5",
                "curve new 0,1,0,0.5,2,0"
            ]
        );
        assert_eq!((preset.edits[0].near, preset.edits[0].branching), (Some([0.5, 4.0, -0.25]), Some(7)));
        for written in [preset.to_toml().unwrap(), preset.to_toml_changed().unwrap()] {
            assert_eq!(Preset::from_toml(&written).unwrap(), preset, "{written}");
        }
        assert_eq!(preset.edit_toml(&text).unwrap(), text);
        let recipe = Recipe::new(preset.clone());
        assert_eq!(Preset::from_json(&recipe.to_line()).unwrap(), preset);
        let bare = Recipe::new(Preset::from_toml(BUSH).unwrap());
        assert_ne!(recipe.hash(), bare.hash());
        assert!(!bare.to_line().contains("\"edit\""));
        let mut without = preset;
        without.edits.clear();
        assert_eq!(
            (without.edit_toml(BUSH).unwrap(), Recipe::new(without).hash()),
            (BUSH.to_owned(), bare.hash())
        );
    }

    #[test]
    fn saving_adds_changes_and_takes_out_edits_and_leaves_the_rest() {
        let text = format!("{BUSH}{EDITS}");
        let mut preset = Preset::from_toml(&text).unwrap();
        preset.edit("cut stem/7 0.25").unwrap();
        let more = preset.edit_toml(&text).unwrap();
        assert!(more.starts_with(&text), "{more}");
        assert_eq!(&more[text.len()..], "\n[[edit]]\ndo = \"cut\"\naxis = \"stem/7\"\nat = 0.25\n");
        preset.edits.truncate(2);
        preset.edits[1] = "bend stem/4 50 towards=0,-1,0".parse().unwrap();
        let fewer = preset.edit_toml(&more).unwrap();
        assert_eq!(Preset::from_toml(&fewer).unwrap(), preset);
        assert!(fewer.contains("# the ugly one") && fewer.contains("# towards the path\naxis"), "{fewer}");
        preset.edits.clear();
        let none = preset.edit_toml(&fewer).unwrap();
        assert_eq!(Preset::from_toml(&none).unwrap(), Preset::from_toml(BUSH).unwrap());
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let head = "[[edit]]\ndo = \"cut\"\naxis = \"stem/1\"\n";
        let cases = [
            ("[[edit]]\naxis = \"stem\"\n", "7:1: edit 1 has no 'do'; give it one of: remove, cut"),
            ("[[edit]]\ndo = \"remov\"\n", "7:6: edit 1: nothing is called 'remov' (did you mean 'remove'?)"),
            ("[[edit]]\ndo = \"remove\"\n", "7:1: edit 1: it has no 'axis'"),
            ("[[edit]]\ndo = \"remove\"\naxis = \"trunk\"\n", "8:8: edit 1: 'trunk' is no axis"),
            (&format!("{head}at = 2\n"), "9:6: knob 'at': 2 is outside the range: 0 to 1"),
            (&format!("{head}at = nan\n"), "9:6: "),
            (&format!("{head}att = 0.5\n"), "9:1: edit 1: 'cut' has no 'att' (did you mean 'at'?)"),
            (&format!("{head}angle = 5\n"), "9:1: edit 1: 'cut' has no 'angle', which is for: bend"),
            ("[[edit]]\ndo = \"curve\"\naxis = \"stem\"\npoints = [0, 1]\n", "7:1: edit 1: each of 'points'"),
            ("[edit]\ndo = \"cut\"\n", "'edit' is a table, expected tables, each headed [[edit]]"),
            (
                "[[edits]]\ndo = \"cut\"\n",
                "there is no 'edits' at the top of a preset (did you mean 'edit'?)",
            ),
        ];
        for (text, expected) in cases {
            let said = fault(text);
            assert!(said.contains(expected), "{text}: {said}");
        }
    }

    #[test]
    fn short_edits_are_what_they_print() {
        for text in [
            "remove stem/12/3",
            "cut stem2 0.25",
            "cut stem at_m=2",
            "bend stem/4 -30 at=0.5 towards=0,-1,0 over=0",
            "bend stem/4 45 round=0,1,0",
            "scale stem/1 2 thickness=0.5",
            "add stem 3 at=0.7 towards=1,0.5,0 thickness=0.25 lift=-10",
            "copy stem new2/1 towards=1,0,0 size=0.5 turn=90",
            "curve stem 0,1,0,1,2,0.5",
        ] {
            let edit: Edit = text.parse().unwrap();
            assert_eq!(edit.to_string(), text);
        }
        let mut oak = builtin("oak").unwrap().load().unwrap();
        for (text, expected) in [
            ("", "expected an operation and an axis"),
            ("remove", "'remove' needs an axis"),
            ("remove stem 3", "'remove' has no value that '3' could be"),
            ("copy stem", "it has no 'from'"),
            ("cut stem at=inf", "outside the range"),
            ("cut stem/1/0", "is no axis"),
            ("curve stem", "it has no 'points'"),
        ] {
            let said = oak.edit(text).unwrap_err().to_string();
            assert!(said.contains(expected), "{text}: {said}");
        }
        assert!(oak.edits.is_empty());
    }
}
