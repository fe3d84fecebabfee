//! From a document to a preset.

use super::colonization::mesh_hint;
use super::document::{Datum, Entry, Fault, Node, Place};
use super::files::NamesFiles;
use super::foliage;
use super::knobs::{KNOBS, PresetKnob, Section, shape_knobs};
use super::part::{self, PART};
use super::{
    BarkLook, Colonization, DetailLook, FoliageLook, Generator, LSystem, LeafKind, Preset, Space, WindLook,
};
use crate::knob::{did_you_mean, excerpt, nearest};
use crate::lsystem::{Grammar, Part};
use crate::skeleton::Wood;
use crate::skeleton::refine::Refinement;
use crate::surface::Tubes;

/// Keys before all tables that are no knobs.
const HEADINGS: [&str; 9] =
    ["id", "name", "group", "summary", "source", "about", "linden", "input", "inputs"];

impl Preset {
    /// Reads a preset document (TOML).
    ///
    /// # Errors
    /// What is wrong, where, and what was expected.
    pub fn from_toml(text: &str) -> Result<Self, Fault> {
        read(&Node::from_toml(text)?, Some(text))
    }

    /// Reads a preset out of a recipe (JSON).
    ///
    /// # Errors
    /// What is wrong and what was expected.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        read(&Node::from_json(text)?, None)
    }

    /// The preset for a grammar that comes without one.
    pub fn of_grammar(id: &str, grammar: Grammar, angle_deg: f64, derivations: u32) -> Self {
        Self::of(id, Generator::LSystem(LSystem { angle_deg, derivations, ..LSystem::of(grammar) }))
    }

    /// The preset for a crown envelope or points that come without one.
    pub fn of_space(id: &str, space: Space) -> Self {
        Self::of(id, Generator::Colonization(Colonization::of(space)))
    }

    pub(super) fn of(id: &str, generator: Generator) -> Self {
        Self {
            id: id.to_owned(),
            name: id.to_owned(),
            group: "own".to_owned(),
            summary: String::new(),
            source: String::new(),
            about: String::new(),
            seed: 1,
            generator,
            refinement: Refinement::default(),
            wood: Wood::default(),
            tubes: Tubes::default(),
            bark: BarkLook::default(),
            foliage: FoliageLook::default(),
            detail: DetailLook::default(),
            wind: WindLook::default(),
        }
    }
}

/// What a list shows of a preset.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heading {
    /// As [`Preset::name`].
    pub name: String,
    /// As [`Preset::group`]; empty where the document names none.
    pub group: String,
    /// As [`Preset::summary`].
    pub summary: String,
    /// As [`Preset::source`].
    pub source: String,
}

impl Heading {
    /// Reads what stands before a document's first table: for documents without brackets at the start
    /// of a line there, which the built-in ones are.
    pub(super) fn from_toml(text: &str) -> Result<Self, Fault> {
        let end = text.find("\n[").map_or(text.len(), |at| at + 1);
        match Node::from_toml(&text[..end])?.datum {
            Datum::Table(entries) => Self::read(&entries),
            _ => Ok(Self::default()),
        }
    }

    fn read(entries: &[Entry]) -> Result<Self, Fault> {
        let of = |key| Ok(text_of(entries, key)?.unwrap_or_default());
        Ok(Self {
            name: text_of(entries, "name")?.or(text_of(entries, "id")?).unwrap_or_default(),
            group: of("group")?,
            summary: of("summary")?,
            source: of("source")?,
        })
    }
}

fn text_of(entries: &[Entry], key: &str) -> Result<Option<String>, Fault> {
    let found = entries.iter().find(|entry| entry.key == key);
    found.map(|entry| entry.node.text(key).map(str::to_owned)).transpose()
}

fn read(document: &Node, text: Option<&str>) -> Result<Preset, Fault> {
    let Datum::Table(entries) = &document.datum else {
        return Err(Fault::new(
            document.place,
            format!("a preset is a table of keys, this is {}", document.kind()),
        ));
    };
    let generator = match (table(entries, "lsystem")?, table(entries, "colonization")?) {
        (Some(own), None) => Generator::LSystem(read_lsystem(own, text)?),
        (None, Some(own)) => Generator::Colonization(read_space(own)?),
        (Some((_, place)), Some(_)) => {
            return Err(Fault::new(
                place,
                "both [lsystem] and [colonization]: a preset grows one way; keep one",
            ));
        }
        (None, None) => {
            return Err(Fault::new(
                None,
                "neither [lsystem] nor [colonization]: add the one that grows the tree",
            ));
        }
    };
    let mut preset = Preset::of("", generator);
    preset.id = text_of(entries, "id")?
        .ok_or_else(|| Fault::new(None, "no 'id': add a line like id = \"my-tree\""))?;
    if preset.id.trim().is_empty() {
        let place = entries.iter().find(|entry| entry.key == "id").and_then(|entry| entry.node.place);
        return Err(Fault::new(place, "'id' is empty: name the preset, like id = \"my-tree\""));
    }
    let Heading { name, group, summary, source } = Heading::read(entries)?;
    (preset.name, preset.summary, preset.source) = (name, summary, source);
    preset.group = if group.is_empty() { preset.group } else { group };
    preset.about = text_of(entries, "about")?.unwrap_or_default();
    for entry in entries {
        match Section::ALL.iter().find(|section| section.key() == entry.key) {
            Some(&section) => {
                if let Datum::Table(own) = &entry.node.datum {
                    // The crown comes first: its shape decides which dimensions there are.
                    let (crown, rest): (Vec<&Entry>, Vec<&Entry>) =
                        own.iter().partition(|e| e.key == "crown");
                    for entry in crown.into_iter().chain(rest) {
                        turn(&mut preset, section, entry)?;
                    }
                } else {
                    return Err(entry.node.mismatch(&entry.key, "a table"));
                }
            }
            None if HEADINGS.contains(&entry.key.as_str()) => {}
            None => turn(&mut preset, Section::Tree, entry)?,
        }
    }
    Ok(preset)
}

/// A table's entries and where it stands.
type Table<'a> = (&'a [Entry], Option<Place>);

fn table<'a>(entries: &'a [Entry], key: &str) -> Result<Option<Table<'a>>, Fault> {
    let Some(entry) = entries.iter().find(|entry| entry.key == key) else { return Ok(None) };
    match &entry.node.datum {
        Datum::Table(own) => Ok(Some((own, entry.place))),
        _ => Err(entry.node.mismatch(key, "a table")),
    }
}

/// What a section's table may hold besides knobs.
fn materials(section: Section) -> Vec<&'static str> {
    match section {
        Section::LSystem => vec!["axiom", "rules"],
        Section::Colonization => vec!["envelope", "scan", PART],
        Section::Bark => BarkLook::FILES.map(|row| row.key).to_vec(),
        Section::Foliage => LeafKind::FILES.map(|row| row.key).into_iter().chain([foliage::ALSO]).collect(),
        _ => Vec::new(),
    }
}

/// For who takes a mesh for a shape of crowns.
const ENVELOPE_INSTEAD: &str =
    "a mesh that the crown fills is named in place of a shape: envelope = \"crown.obj\"";

/// Sets the knob that an entry names.
fn turn(preset: &mut Preset, section: Section, entry: &Entry) -> Result<(), Fault> {
    let is_taken = match section {
        Section::Bark => preset.bark.take_file(entry)?,
        Section::Foliage => foliage::read(&mut preset.foliage, entry)?,
        _ => false,
    };
    if is_taken {
        return Ok(());
    }
    if materials(section).contains(&entry.key.as_str()) {
        return Ok(());
    }
    let own = preset.knobs();
    let found = own.iter().find(|(knob, _)| knob.section == section && knob.knob.name == entry.key);
    if let Some((knob, _)) = found {
        let value =
            entry.node.value(&entry.key, &knob.knob.kind).map_err(|fault| match &entry.node.datum {
                Datum::Text(word) if entry.key == "crown" => {
                    let hint = mesh_hint(word, ENVELOPE_INSTEAD);
                    Fault { message: fault.message + &hint, ..fault }
                }
                _ => fault,
            })?;
        knob.write(preset, value);
        return Ok(());
    }
    Err(Fault::new(entry.place, unknown(preset, section, &entry.key)))
}

/// Says why a key is none, and what to do.
fn unknown(preset: &Preset, section: Section, key: &str) -> String {
    if section == Section::Colonization && ["mesh", "crown_mesh", "obj"].contains(&key) {
        return format!("there is no '{key}' in [colonization]; {ENVELOPE_INSTEAD}");
    }
    let key = excerpt(key);
    let place = match section {
        Section::Tree => "at the top of a preset".to_owned(),
        own => format!("in [{}]", own.key()),
    };
    let anywhere: Vec<PresetKnob> = KNOBS.iter().copied().chain(shape_knobs()).collect();
    if let Some(known) = anywhere.iter().find(|knob| knob.knob.name == key) {
        return if known.section == section {
            format!("'{key}' does not belong to this crown; it is a dimension of another shape")
        } else {
            let name = known.section.key();
            format!(
                "'{key}' stands {place}, but belongs {}",
                if name.is_empty() { "at the top".into() } else { format!("in [{name}]") }
            )
        };
    }
    let own = preset.knobs();
    let mut names: Vec<&str> =
        own.iter().filter(|(knob, _)| knob.section == section).map(|(knob, _)| knob.knob.name).collect();
    names.extend(materials(section));
    if section == Section::Tree {
        names.extend(HEADINGS);
        names.extend(Section::ALL.iter().map(|s| s.key()).filter(|s| !s.is_empty()));
    }
    match nearest(&key, names.iter().copied()) {
        found @ Some(_) => format!("there is no '{key}' {place}{}", did_you_mean(found)),
        None => format!("there is no '{key}' {place}; expected one of: {}", names.join(", ")),
    }
}

fn read_lsystem((entries, place): Table<'_>, text: Option<&str>) -> Result<LSystem, Fault> {
    let missing = |what: &str| Fault::new(place, format!("[lsystem] has no '{what}'"));
    let find = |key: &str| entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node);
    let axiom = find("axiom").ok_or_else(|| missing("axiom"))?;
    let rules = find("rules").ok_or_else(|| missing("rules"))?;
    let Datum::List(items) = &rules.datum else {
        return Err(rules.mismatch("rules", "a list of texts like [\"F -> F[+F]F\"]"));
    };
    let axiom_text = axiom.text("axiom")?.to_owned();
    let texts =
        items.iter().map(|item| item.text("rules").map(str::to_owned)).collect::<Result<Vec<_>, _>>()?;
    let grammar = Grammar::new(&axiom_text, &texts).map_err(|error| {
        let node = match error.part {
            Part::Axiom => axiom,
            Part::Rule(index) => items.get(index).unwrap_or(rules),
        };
        let place = match (node.place, text) {
            (Some(start), Some(text)) => Some(inside(text, start, error.column)),
            (place, _) => place,
        };
        Fault::new(place, format!("{}: {}", error.part, error.problem))
    })?;
    Ok(LSystem::of(grammar))
}

/// The place of a string's `column`-th character, where the string's opening quote is at `start`.
/// Strings over several lines are pointed at as a whole.
fn inside(text: &str, start: Place, column: usize) -> Place {
    let line = text.lines().nth(start.line - 1).unwrap_or_default();
    let mut raw = line.chars().skip(start.column - 1);
    let quote = raw.next().unwrap_or('"');
    let rest: Vec<char> = raw.collect();
    if rest.starts_with(&[quote, quote]) {
        return start;
    }
    let mut at = 0;
    for _ in 1..column {
        // An escape is several characters of the file and one of the string.
        at += match (quote, rest.get(at), rest.get(at + 1)) {
            ('"', Some('\\'), Some('u')) => 6,
            ('"', Some('\\'), Some('U')) => 10,
            ('"', Some('\\'), _) => 2,
            _ => 1,
        };
    }
    Place { line: start.line, column: start.column + 1 + at }
}

fn read_space((entries, place): Table<'_>) -> Result<Colonization, Fault> {
    let file = |key: &str| -> Result<Option<String>, Fault> {
        let found = entries.iter().find(|entry| entry.key == key);
        found.map(|entry| entry.node.text(key).map(str::to_owned)).transpose()
    };
    let has_crown = entries.iter().any(|entry| entry.key == "crown");
    let space = match (has_crown, file("envelope")?, file("scan")?) {
        // The knob `crown` names the shape; until it is read any will do.
        (true, None, None) => Space::Shape { shape: "dome".to_owned(), dimensions: Vec::new() },
        (false, Some(file), None) => Space::Envelope { file },
        (false, None, Some(file)) => Space::Points { file },
        (false, None, None) => {
            // What was written instead says best what was meant.
            if let Some(entry) = entries.iter().find(|entry| entry.key == "mesh") {
                return Err(Fault::new(entry.place, format!("there is no 'mesh' here; {ENVELOPE_INSTEAD}")));
            }
            return Err(Fault::new(
                place,
                "[colonization] has none of 'crown' (a shape), 'envelope' (a mesh) and 'scan' (points)",
            ));
        }
        _ => {
            let spaces = ["crown", "envelope", "scan"];
            let mut given: Vec<&Entry> =
                entries.iter().filter(|entry| spaces.contains(&entry.key.as_str())).collect();
            given.sort_by_key(|entry| entry.place.map(|place| (place.line, place.column)));
            let names: Vec<String> = given.iter().map(|entry| format!("'{}'", entry.key)).collect();
            let message =
                format!("[colonization] has {}; a crown is one of them: keep one", names.join(" and "));
            return Err(Fault::new(given.last().and_then(|entry| entry.place).or(place), message));
        }
    };
    let mut own = Colonization::of(space);
    if let Some(entry) = entries.iter().find(|entry| entry.key == PART) {
        if matches!(own.space, Space::Points { .. }) {
            return Err(Fault::new(entry.place, "parts need a 'crown' or an 'envelope'; a scan has neither"));
        }
        own.parts = part::read(&entry.node)?;
    }
    Ok(own)
}
