//! Ages of a preset that have names: tables headed `[age.young]`, of knobs that are turned then.

use std::collections::BTreeMap;

use linden_base::document::{Datum, Entry, Fault, Node};
use linden_base::knob::{Spread, Value, did_you_mean, excerpt, nearest};
use linden_plant::season::is_name;
use serde::ser::{Serialize, SerializeMap, Serializer};

use super::write::Plain;
use super::{KnobError, Preset};

/// The key of the table of ages.
pub const AGES: &str = "age";

/// Ages of one preset.
pub const MOST_AGES: usize = 16;

/// The knob that is turned by `half=0.5`.
const SHARE: &str = "age";

/// The knob that is turned by `10y`.
const YEARS: &str = "years";

/// An age that a plant is shown at: a name, and the knobs that are turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Age {
    /// Lower-case ASCII identifier: `young`.
    pub name: String,
    turns: Vec<Turn>,
}

/// A knob that is turned.
#[derive(Clone, Debug, PartialEq)]
struct Turn {
    knob: String,
    to: To,
}

/// What a knob is turned to.
#[derive(Clone, Debug, PartialEq)]
enum To {
    Value(Value),
    Spread(Spread),
}

impl To {
    fn text(&self) -> String {
        match self {
            Self::Value(value) => value.to_string(),
            Self::Spread(spread) => spread.to_string(),
        }
    }
}

/// Why a list of ages is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AgeError {
    /// Nothing is listed, or the preset names none.
    #[error("no age is named: '{preset}' names {known}; or give one as a share of its growth, like half=0.5{years}", years = OrYears(*.has_years))]
    Empty {
        /// The preset.
        preset: String,
        /// The ages that it names.
        known: String,
        /// Whether it grows by years.
        has_years: bool,
    },
    /// Neither a named age nor a name with a share.
    #[error(
        "'{preset}' has no age '{}'{}; it names {known}; or give one as a share of its growth, like half=0.5{years}",
        excerpt(.name),
        did_you_mean(.nearest.as_deref()),
        years = OrYears(*.has_years)
    )]
    Unknown {
        /// As typed.
        name: String,
        /// What may have been meant.
        nearest: Option<String>,
        /// The preset.
        preset: String,
        /// The ages that it names.
        known: String,
        /// Whether it grows by years.
        has_years: bool,
    },
    /// Files could not call it so.
    #[error(
        "'{}' cannot name an age: take a lower-case letter, then lower-case letters, digits or _, at most 32",
        excerpt(.0)
    )]
    Name(String),
    /// Two of the same name.
    #[error("age {0} is named twice; give each a name of its own")]
    Twice(String),
    /// It turns a knob that the preset does not have, or to what it does not take.
    #[error("age {name}: {problem}")]
    Knob {
        /// The age.
        name: String,
        /// What is wrong.
        problem: KnobError,
    },
}

struct OrYears(bool);

impl std::fmt::Display for OrYears {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 { f.write_str(", or in years, like 10y") } else { Ok(()) }
    }
}

impl Preset {
    /// The ages that it names, from the youngest to the oldest.
    pub fn ages(&self) -> &[Age] {
        &self.ages
    }

    /// Reads a list of ages like `young,half=0.5,30y`: names of its own, names with a share of its growth, and years
    /// where it grows by them. `all` are those that it names.
    ///
    /// ```
    /// let birch = linden_pipeline::preset::builtin("silver-birch")?.load()?;
    /// let ages = birch.ages_of("half=0.5,5y")?;
    /// assert_eq!([&ages[0].name, &ages[1].name], ["half", "year_5"]);
    /// assert_ne!(birch.at_age(&ages[1])?, birch);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AgeError`].
    pub fn ages_of(&self, list: &str) -> Result<Vec<Age>, AgeError> {
        let mut ages: Vec<Age> = Vec::new();
        for item in list.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let more = if item == "all" { self.ages.clone() } else { vec![self.age_of(item)?] };
            for age in more {
                if ages.iter().any(|before| before.name == age.name) {
                    return Err(AgeError::Twice(age.name));
                }
                self.at_age(&age)?;
                ages.push(age);
            }
        }
        if ages.is_empty() {
            let (preset, known, has_years) = self.known();
            return Err(AgeError::Empty { preset, known, has_years });
        }
        Ok(ages)
    }

    /// Its id, the ages that it names, in words, and whether it grows by years.
    fn known(&self) -> (String, String, bool) {
        let names: Vec<&str> = self.ages.iter().map(|age| age.name.as_str()).collect();
        let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        (self.id.clone(), known, self.find_knob(YEARS).is_some())
    }

    fn age_of(&self, item: &str) -> Result<Age, AgeError> {
        let turned = |name: &str, knob: &str, to: &str| {
            let mut turned = self.clone();
            let refused = |problem| AgeError::Knob { name: name.to_owned(), problem };
            turned.set(knob, to).map_err(refused)?;
            let value = turned.find_knob(knob).and_then(|row| row.read(&turned)).unwrap_or(Value::Auto);
            Ok(Age {
                name: name.to_owned(),
                turns: vec![Turn { knob: knob.to_owned(), to: To::Value(value) }],
            })
        };
        let years = item.strip_suffix('y').filter(|years| years.bytes().all(|digit| digit.is_ascii_digit()));
        if let Some(years) = years.filter(|years| !years.is_empty()) {
            return turned(&format!("year_{years}"), YEARS, years);
        }
        if let Some((name, share)) = item.split_once('=') {
            let (name, share) = (name.trim(), share.trim());
            if !is_name(name) {
                return Err(AgeError::Name(name.to_owned()));
            }
            return match share.strip_suffix('y') {
                Some(years) => turned(name, YEARS, years),
                None => turned(name, SHARE, share),
            };
        }
        let found = self.ages.iter().find(|age| age.name == item);
        found.cloned().ok_or_else(|| {
            let (preset, known, has_years) = self.known();
            let names = self.ages.iter().map(|age| age.name.as_str());
            let nearest = nearest(&item.to_lowercase(), names).map(str::to_owned);
            AgeError::Unknown { name: item.to_owned(), nearest, preset, known, has_years }
        })
    }

    /// How far its growth has come: steps, else a share.
    fn growth(&self) -> f64 {
        let share = || match self.find_knob(SHARE).and_then(|row| row.read(self)) {
            Some(Value::Real(share)) => share,
            _ => 1.0,
        };
        self.generator.steps().map_or_else(share, |steps| f64::from(steps.count))
    }

    /// The preset with the knobs turned that an age turns. It names no ages: it is one of them.
    ///
    /// # Errors
    /// [`AgeError::Knob`]: not one of its ages.
    pub fn at_age(&self, age: &Age) -> Result<Self, AgeError> {
        let mut preset = Self { ages: Vec::new(), ..self.clone() };
        for Turn { knob, to } in &age.turns {
            let refused = |problem| AgeError::Knob { name: age.name.clone(), problem };
            preset.set(knob, &to.text()).map_err(refused)?;
        }
        Ok(preset)
    }
}

impl Age {
    /// The knobs that it turns, with what to.
    ///
    /// ```
    /// let birch = linden_pipeline::preset::builtin("silver-birch")?.load()?;
    /// let ages = birch.ages_of("half=0.5")?;
    /// let turns: Vec<_> = ages[0].turns().collect();
    /// assert_eq!(turns, [("age", "0.5".to_owned())]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn turns(&self) -> impl Iterator<Item = (&str, String)> {
        self.turns.iter().map(|turn| (turn.knob.as_str(), turn.to.text()))
    }
}

/// Reads the table of ages, of a preset that is read but for it.
pub(super) fn read(preset: &Preset, node: &Node) -> Result<Vec<Age>, Fault> {
    let Datum::Table(entries) = &node.datum else {
        return Err(node.mismatch(AGES, "a table of ages, like [age.young]"));
    };
    if entries.len() > MOST_AGES {
        let problem = format!("{} ages are more than the {MOST_AGES} that a preset may have", entries.len());
        return Err(Fault::new(node.place, problem));
    }
    let mut ages =
        entries.iter().map(|entry| read_one(preset, entry)).collect::<Result<Vec<Age>, Fault>>()?;
    // Documents do not keep the order of tables.
    let growth = |age: &Age| preset.at_age(age).map_or(0.0, |aged| aged.growth());
    ages.sort_by(|a, b| growth(a).total_cmp(&growth(b)).then_with(|| a.name.cmp(&b.name)));
    Ok(ages)
}

fn read_one(preset: &Preset, entry: &Entry) -> Result<Age, Fault> {
    let name = &entry.key;
    if !is_name(name) || name == "all" {
        return Err(Fault::new(entry.place, AgeError::Name(name.clone()).to_string()));
    }
    let Datum::Table(entries) = &entry.node.datum else {
        return Err(entry.node.mismatch(name, "a table of knobs, like age = 0.25"));
    };
    let mut all = Vec::new();
    addressed("", entries, &mut all);
    // Documents do not keep the order of keys. Knobs of kinds of foliage come last, as in what is written.
    all.sort_by(|(a, _), (b, _)| a.contains('.').cmp(&b.contains('.')).then_with(|| a.cmp(b)));
    // Turned one after the other: a crown's shape decides which dimensions there are.
    let mut turned = preset.clone();
    let turns = all.into_iter().map(|(knob, entry)| read_turn(&mut turned, name, knob, entry));
    Ok(Age { name: name.clone(), turns: turns.collect::<Result<Vec<Turn>, Fault>>()? })
}

/// Entries by the names of their knobs: `blossom.leaf_keep` is a table in a table.
fn addressed<'a>(of: &str, entries: &'a [Entry], all: &mut Vec<(String, &'a Entry)>) {
    for entry in entries {
        let name = format!("{of}{}", entry.key);
        match &entry.node.datum {
            Datum::Table(inner) => addressed(&format!("{name}."), inner, all),
            _ => all.push((name, entry)),
        }
    }
}

fn read_turn(preset: &mut Preset, age: &str, knob: String, entry: &Entry) -> Result<Turn, Fault> {
    let said = |problem: KnobError| Fault::new(entry.place, format!("age {age}: {problem}"));
    let Some(row) = preset.find_knob(&knob).filter(|row| row.knob.name != "seed") else {
        if knob == "seed" {
            return Err(Fault::new(entry.place, format!("age {age}: every age has the seed of the preset")));
        }
        // What `--set` says of it.
        return match preset.set(&knob, "") {
            Err(problem) => Err(said(problem)),
            Ok(()) => Err(Fault::new(entry.place, format!("age {age}: '{knob}' is no knob"))),
        };
    };
    let to = match &entry.node.datum {
        Datum::Text(text) if Spread::is_meant(text) => {
            To::Spread(row.parse_spread(text).map_err(|problem| {
                Fault::new(entry.node.place, format!("age {age}: knob '{knob}': {problem}"))
            })?)
        }
        _ => To::Value(entry.node.value(&knob, &row.knob.kind)?),
    };
    preset.set(&knob, &to.text()).map_err(said)?;
    Ok(Turn { knob, to })
}

/// The ages of a preset as documents have them.
pub(super) struct WrittenAges<'a>(pub &'a [Age]);

impl Serialize for WrittenAges<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let table =
            |age: &Age| Turns(age.turns.iter().map(|turn| (turn.knob.clone(), turn.to.clone())).collect());
        serializer.collect_map(self.0.iter().map(|age| (&age.name, table(age))))
    }
}

/// Knobs that are turned, those of kinds in tables of their own.
struct Turns(Vec<(String, To)>);

impl Serialize for Turns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let mut kinds: BTreeMap<&str, Self> = BTreeMap::new();
        for (knob, to) in &self.0 {
            match (knob.split_once('.'), to) {
                (Some((kind, knob)), to) => {
                    kinds.entry(kind).or_insert(Self(Vec::new())).0.push((knob.to_owned(), to.clone()));
                }
                (None, To::Value(value)) => map.serialize_entry(knob, &Plain(value.clone()))?,
                (None, To::Spread(spread)) => map.serialize_entry(knob, &spread.to_string())?,
            }
        }
        for (kind, turns) in kinds {
            map.serialize_entry(kind, &turns)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::SelfOrganizing;

    const DOCUMENT: &str = "id = \"a\"\n\n[self-organizing]\nyears = 30\n\n[foliage]\nleaf_form = \"card\"\n\n\
                            [[foliage.also]]\nname = \"blossom\"\nleaf_form = \"card\"\n\n[age.young]\n\
                            age = 0.3 # a third\nleaves_per_m = \"20 ± 2\"\nblossom.leaf_keep = 0\nalso.1.leaf_length = 0.02\n\n\
                            [age.old]\nyears = 60\nleaf_form = \"none\"\n\n[age.whole]\n";

    #[test]
    fn ages_are_read_written_and_edited_in_place() {
        let preset = Preset::from_toml(DOCUMENT).unwrap();
        let names: Vec<&str> = preset.ages().iter().map(|age| age.name.as_str()).collect();
        assert_eq!(names, ["young", "whole", "old"]);
        let turns: Vec<_> = preset.ages()[0].turns().collect();
        let expected = [
            ("age", "0.3"),
            ("leaves_per_m", "20 ± 2"),
            ("also.1.leaf_length", "0.02"),
            ("blossom.leaf_keep", "0"),
        ];
        assert_eq!(turns, expected.map(|(knob, to)| (knob, to.to_owned())));
        // What is at its default is left out, and an age that turns nothing is not.
        let [whole, short] = [preset.to_toml().unwrap(), preset.to_toml_changed().unwrap()];
        assert!(5 * short.lines().count() < whole.lines().count(), "{short}");
        for text in [preset.to_toml().unwrap(), preset.to_toml_changed().unwrap()] {
            assert_eq!(Preset::from_toml(&text).unwrap(), preset, "{text}");
        }
        assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
        assert_eq!(preset.edit_toml(DOCUMENT).unwrap(), DOCUMENT);
        let mut other = preset.clone();
        other.set("years", "40").unwrap();
        assert_eq!(other.edit_toml(DOCUMENT).unwrap(), DOCUMENT.replace("years = 30", "years = 40"));
    }

    #[test]
    fn an_age_is_the_preset_with_its_knobs_turned() {
        let preset = Preset::from_toml(DOCUMENT).unwrap();
        let years = |preset: &Preset| preset.settings::<SelfOrganizing>().unwrap().years_grown();
        let at = |list: &str| {
            preset.ages_of(list).unwrap().iter().map(|age| preset.at_age(age).unwrap()).collect::<Vec<_>>()
        };
        let ages = at("all,half=0.5,12y,ten=10y");
        assert_eq!(ages.iter().map(years).collect::<Vec<_>>(), [9, 30, 60, 15, 12, 10]);
        assert!(ages.iter().all(|age| age.ages().is_empty() && age.seed() == preset.seed()));
        let mut by_hand = preset.clone();
        for (knob, to) in [
            ("age", "0.3"),
            ("leaves_per_m", "20 ± 2"),
            ("blossom.leaf_keep", "0"),
            ("also.1.leaf_length", "0.02"),
        ] {
            by_hand.set(knob, to).unwrap();
        }
        by_hand.ages.clear();
        assert_eq!(ages[0], by_hand);
        // They draw with the seed.
        let mut other = ages[0].clone();
        other.set_seed(99);
        let per_m = |preset: &Preset| preset.find_knob("leaves_per_m").unwrap().read(preset);
        assert_ne!(per_m(&other), per_m(&ages[0]));
    }

    #[test]
    fn what_is_no_age_is_said() {
        for (table, said) in [
            ("[age]\nyoung = 0.3", "young"),
            ("[age.Young]\nage = 0.3", "'Young' cannot name an age"),
            ("[age.all]\nage = 0.3", "'all' cannot name"),
            ("[age.young]\nage = 3", "age"),
            ("[age.young]\nagw = 0.3", "did you mean 'age'"),
            ("[age.young]\nseed = 3", "the seed of the preset"),
            ("[age.young]\npoints = 30", "has no knob 'points'"),
            ("[age.young]\npetal.leaf_keep = 0", "petal"),
            ("[age.young]\nleaves_per_m = \"20 ± x\"", "leaves_per_m"),
        ] {
            let error = Preset::from_toml(&format!("id = \"a\"\n[self-organizing]\n{table}\n")).unwrap_err();
            assert!(error.place.is_some() && error.to_string().contains(said), "{table}: {error}");
        }
        let preset = Preset::from_toml(DOCUMENT).unwrap();
        for (list, said) in [
            ("", "'a' names young, whole, old"),
            ("yung", "did you mean 'young'"),
            ("0.5", "like half=0.5, or in years, like 10y"),
            ("young,young=0.4", "young is named twice"),
            ("all,old", "old is named twice"),
            ("half=1.5", "age half: knob 'age'"),
            ("0y", "age year_0: knob 'years'"),
            ("Half=0.5", "'Half' cannot name"),
            ("\u{1b}[2J", "\\u{1b}"),
        ] {
            let error = preset.ages_of(list).unwrap_err().to_string();
            assert!(error.contains(said) && !error.contains('\u{1b}'), "{list}: {error}");
        }
        let sphere = Preset::from_toml("id = \"a\"\n[colonization]\ncrown = \"sphere\"").unwrap();
        let error = sphere.ages_of("10y").unwrap_err().to_string();
        assert!(error.contains("has no knob 'years'"), "{error}");
        assert!(sphere.ages_of("all").unwrap_err().to_string().contains("names none"));
    }
}
