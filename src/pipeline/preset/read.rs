//! From a document to a preset.

use linden_base::document::{Datum, Entry, Fault, NamesFiles, Node, Table};
use linden_base::knob::{Spread, did_you_mean, excerpt, nearest};
use linden_lsystem::Grammar;
use linden_plant::settings::{self, BarkSettings, Dressing, LEAF_KNOBS, LeafKind};
use linden_skeleton::generator::{Asked, Generator, Settings};
use linden_skeleton::refine::Refinement;
use linden_skeleton::{WidthSteps, Wood};

use super::ages::{self, AGES};
use super::edits::{self, EDITS};
use super::kinds::kind_rows;
use super::knobs::{KNOBS, PresetKnob, Section};
use super::tags::{self, TAGS};
use super::{Colonization, LSystem, Preset, QsmSettings, ScanSettings, Space, former};
use crate::generators;

/// Keys before all tables that are no knobs.
const HEADINGS: [&str; 11] =
    ["id", "name", "group", "summary", "source", "about", TAGS, "linden", "hash", "input", "inputs"];

impl Preset {
    /// Reads a preset document (TOML).
    ///
    /// # Errors
    /// What is wrong, where, and what was expected.
    pub fn from_toml(text: &str) -> Result<Self, Fault> {
        read(Node::from_toml(text)?, Some(text))
    }

    /// Reads a preset out of a recipe (JSON).
    ///
    /// # Errors
    /// What is wrong and what was expected.
    pub fn from_json(text: &str) -> Result<Self, Fault> {
        read(Node::from_json(text)?, None)
    }

    /// The preset for a grammar that comes without one.
    pub fn of_grammar(id: &str, grammar: Grammar, angle_deg: f64, derivations: u32) -> Self {
        Self::of(id, LSystem { angle_deg, derivations, ..LSystem::of(grammar) })
    }

    /// The preset for a mesh that comes without one: a crown fills it.
    pub fn of_mesh(id: &str, file: &str) -> Self {
        Self::of(id, Colonization::of(Space::Envelope { file: file.to_owned() }))
    }

    /// The preset for points that come without one: a scan.
    pub fn of_points(id: &str, file: &str) -> Self {
        Self::of(id, ScanSettings::of(file))
    }

    /// The preset for a table of cylinders that comes without one. Where it has a radius for each end (`tapered`) wood goes evenly
    /// from one to the other, else each segment stays the cylinder that it is.
    pub fn of_cylinders(id: &str, file: &str, tapered: bool) -> Self {
        let mut preset = Self::of(id, QsmSettings::of(file));
        if !tapered {
            preset.wood.width_steps = WidthSteps::Cylinder;
        }
        preset
    }

    /// The preset for settings of a generator that come without one, everything else at its default.
    pub fn of(id: &str, settings: impl Settings) -> Self {
        Self::of_boxed(id, Box::new(settings))
    }

    pub(super) fn of_boxed(id: &str, generator: Box<dyn Settings>) -> Self {
        Self {
            id: id.to_owned(),
            name: id.to_owned(),
            group: "own".to_owned(),
            summary: String::new(),
            source: String::new(),
            about: String::new(),
            tags: Vec::new(),
            seed: 1,
            generator,
            refinement: Refinement::default(),
            wood: Wood::default(),
            edits: Vec::new(),
            dressing: Dressing::default(),
            ages: Vec::new(),
            spreads: Vec::new(),
        }
    }
}

/// The entry of a preset in a list.
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
    /// As [`Preset::tags`].
    pub tags: Vec<String>,
    /// The id of what grows it.
    pub generator: Option<&'static str>,
}

impl Heading {
    /// Reads what stands before a document's first table: for documents without brackets at the start
    /// of a line there, which the built-in ones are.
    pub(crate) fn from_toml(text: &str) -> Result<Self, Fault> {
        let end = text.find("\n[").map_or(text.len(), |at| at + 1);
        match Node::from_toml(&text[..end])?.datum {
            Datum::Table(entries) => {
                Ok(Self { generator: generator_in(&text[end..]), ..Self::read(&entries)? })
            }
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
            tags: tags::read(entries)?,
            generator: None,
        })
    }
}

/// The first generator whose table begins at the start of a line.
fn generator_in(tables: &str) -> Option<&'static str> {
    let mut names = tables.lines().filter_map(|line| line.strip_prefix('['));
    names.find_map(|name| {
        let (name, _) = name.trim_start_matches('[').split_once([']', '.'])?;
        generators::find(name).map(Generator::id)
    })
}

fn text_of(entries: &[Entry], key: &str) -> Result<Option<String>, Fault> {
    let found = entries.iter().find(|entry| entry.key == key);
    found.map(|entry| entry.node.text(key).map(str::to_owned)).transpose()
}

fn read(mut document: Node, text: Option<&str>) -> Result<Preset, Fault> {
    former::renew(&mut document);
    let Datum::Table(entries) = &document.datum else {
        return Err(Fault::new(
            document.place,
            format!("a preset is a table of keys, this is {}", document.kind()),
        ));
    };
    let mut preset = Preset::of_boxed("", generator(entries, text)?);
    preset.id = text_of(entries, "id")?
        .ok_or_else(|| Fault::new(None, "no 'id': add a line like id = \"my-tree\""))?;
    if preset.id.trim().is_empty() {
        let place = entries.iter().find(|entry| entry.key == "id").and_then(|entry| entry.node.place);
        return Err(Fault::new(place, "'id' is empty: name the preset, like id = \"my-tree\""));
    }
    let Heading { name, group, summary, source, tags, .. } = Heading::read(entries)?;
    preset.tags = tags;
    (preset.name, preset.summary, preset.source) = (name, summary, source);
    preset.group = if group.is_empty() { preset.group } else { group };
    preset.about = text_of(entries, "about")?.unwrap_or_default();
    let sections = Section::all();
    for entry in entries {
        match sections.iter().find(|section| section.key() == entry.key) {
            Some(&section) => {
                if let Datum::Table(entries) = &entry.node.datum {
                    // A section's first knob comes first: a crown's shape decides which dimensions there are.
                    let knob = KNOBS.iter().find(|row| row.section == section).map(|row| row.knob);
                    let (first, rest): (Vec<&Entry>, Vec<&Entry>) =
                        entries.iter().partition(|entry| knob.is_some_and(|knob| knob.is_called(&entry.key)));
                    for entry in first.into_iter().chain(rest) {
                        turn(&mut preset, section, entry)?;
                    }
                } else {
                    return Err(entry.node.mismatch(&entry.key, "a table"));
                }
            }
            None if entry.key == EDITS => preset.edits = edits::read(&entry.node)?,
            // They turn what all other tables have set.
            None if entry.key == AGES => {}
            None if HEADINGS.contains(&entry.key.as_str()) => {}
            None => turn(&mut preset, Section::Tree, entry)?,
        }
    }
    // The seed may have come last.
    preset.redraw();
    if let Some(entry) = entries.iter().find(|entry| entry.key == AGES) {
        preset.ages = ages::read(&preset, &entry.node)?;
    }
    Ok(preset)
}

/// The settings of the one generator that has a table.
fn generator(entries: &[Entry], text: Option<&str>) -> Result<Box<dyn Settings>, Fault> {
    let mut found: Option<(&dyn Generator, Table<'_>)> = None;
    for generator in generators::all() {
        let Some(table) = table(entries, generator.id(), text)? else { continue };
        if let Some((first, before)) = found {
            // Pointed at: the one that stands first.
            let line = |table: &Table<'_>| table.place.map(|place| (place.line, place.column));
            let place = if line(&before) <= line(&table) { before.place } else { table.place };
            let (a, b) = (first.id(), generator.id());
            return Err(Fault::new(place, format!("both [{a}] and [{b}]: a preset grows one way; keep one")));
        }
        found = Some((*generator, table));
    }
    match found {
        Some((generator, table)) => {
            let settings = generator.read(&table)?;
            check_names(&*settings, &table)?;
            Ok(settings)
        }
        None => {
            let names: Vec<&str> = generators::all().iter().map(|generator| generator.id()).collect();
            // A table that was meant to be one of them.
            let is_unknown = |key: &str| {
                HEADINGS.iter().chain(&[EDITS, AGES]).all(|name| *name != key)
                    && Section::all().iter().all(|section| section.key() != key)
            };
            let mut tables = entries.iter().filter(|entry| matches!(entry.node.datum, Datum::Table(_)));
            if let Some(entry) = tables.find(|entry| is_unknown(&entry.key)) {
                let sections = Section::all();
                let sections = sections.iter().map(|section| section.key());
                let known = names.iter().copied().chain(sections).chain([EDITS, AGES]);
                let (key, meant) = (excerpt(&entry.key), did_you_mean(nearest(&entry.key, known)));
                return Err(Fault::new(entry.place, format!("a preset has no [{key}]{meant}")));
            }
            let tables: Vec<String> = names.iter().map(|name| format!("[{name}]")).collect();
            let message = format!("none of {}: add the one that grows the tree", tables.join(", "));
            Err(Fault::new(None, message))
        }
    }
}

/// Refuses knobs that a document brings along by the names of knobs, or of other keys, that presets have anyway.
fn check_names(settings: &dyn Settings, table: &Table<'_>) -> Result<(), Fault> {
    let generator = settings.generator();
    let usual: Vec<&str> = generator.knobs().iter().map(|knob| knob.name).collect();
    let own = settings.knobs().into_iter().map(|(knob, _)| knob.name).filter(|name| !usual.contains(name));
    for name in own {
        let is_key = generator.keys().iter().any(|key| key.name == name);
        if is_key || HEADINGS.contains(&name) || KNOBS.iter().any(|row| row.knob.is_called(name)) {
            let message = format!(
                "'{name}' cannot be a knob: it is the name of another one; give the constant another"
            );
            return Err(Fault::new(table.place, message));
        }
    }
    Ok(())
}

fn table<'a>(entries: &'a [Entry], key: &str, text: Option<&'a str>) -> Result<Option<Table<'a>>, Fault> {
    let Some(entry) = entries.iter().find(|entry| entry.key == key) else { return Ok(None) };
    match &entry.node.datum {
        Datum::Table(entries) => Ok(Some(Table { entries, place: entry.place, text })),
        _ => Err(entry.node.mismatch(key, "a table")),
    }
}

/// What a section's table may hold besides knobs.
fn materials(preset: &Preset, section: Section) -> Vec<&'static str> {
    match section {
        Section::Generator(id) if id == preset.grows_by().id() => {
            preset.grows_by().keys().iter().map(|key| key.name).collect()
        }
        Section::Bark => BarkSettings::FILES.map(|row| row.key).to_vec(),
        Section::Foliage => {
            let others = [settings::ALSO, settings::KIND_NAME];
            LeafKind::FILES.map(|row| row.key).into_iter().chain(others).collect()
        }
        _ => Vec::new(),
    }
}

/// Sets the knob that an entry names.
fn turn(preset: &mut Preset, section: Section, entry: &Entry) -> Result<(), Fault> {
    let is_taken = match section {
        Section::Bark => preset.dressing.bark.take_file(entry)?,
        Section::Foliage if entry.key == settings::ALSO => {
            let mut entry = entry.clone();
            let spreads = take_spreads(&mut entry.node)?;
            let is_taken = settings::read(&mut preset.dressing.foliage, &entry)?;
            for (row, spread) in spreads {
                preset.put_spread(&row, spread);
            }
            is_taken
        }
        Section::Foliage => settings::read(&mut preset.dressing.foliage, entry)?,
        _ => false,
    };
    if is_taken || materials(preset, section).contains(&entry.key.as_str()) {
        return Ok(());
    }
    let found = preset.find_row(|stands, knob| stands == section && knob.is_called(&entry.key));
    if let Some(knob) = &found {
        if let Some(spread) = spread(knob, entry)? {
            preset.put_spread(knob, spread);
            return Ok(());
        }
        let value =
            entry.node.value(&entry.key, &knob.knob.kind).map_err(|fault| match &entry.node.datum {
                Datum::Text(word) => {
                    let hint = preset.hint(knob, word, Asked::InDocument);
                    Fault { message: fault.message + &hint, ..fault }
                }
                _ => fault,
            })?;
        knob.write(preset, value);
        return Ok(());
    }
    let generator = preset.grows_by();
    if section.key() == generator.id() && generator.former_knobs().contains(&entry.key.as_str()) {
        return Ok(());
    }
    Err(Fault::new(entry.place, unknown(preset, section, &entry.key)))
}

/// The spread of a knob that an entry gives it, if it is one.
fn spread(knob: &PresetKnob, entry: &Entry) -> Result<Option<Spread>, Fault> {
    let Datum::Text(text) = &entry.node.datum else { return Ok(None) };
    if !Spread::is_meant(text) {
        return Ok(None);
    }
    let fault = |problem| Fault::new(entry.node.place, format!("knob '{}': {problem}", entry.key));
    knob.parse_spread(text).map(Some).map_err(fault)
}

/// Takes the spreads out of the further kinds of foliage, and leaves the values in their middles.
fn take_spreads(kinds: &mut Node) -> Result<Vec<(PresetKnob, Spread)>, Fault> {
    let mut taken = Vec::new();
    let Datum::List(kinds) = &mut kinds.datum else { return Ok(taken) };
    for (number, kind) in kinds.iter_mut().enumerate() {
        let Datum::Table(entries) = &mut kind.datum else { continue };
        for entry in entries {
            let rows = kind_rows(number).iter().zip(&LEAF_KNOBS);
            let mut named = rows.filter(|(_, field)| field.knob.is_called(&entry.key));
            let Some((row, _)) = named.next() else { continue };
            if let Some(spread) = spread(row, entry)? {
                entry.node.datum = Datum::Text(spread.middle().to_string());
                taken.push((*row, spread));
            }
        }
    }
    Ok(taken)
}

/// Says why a key is none, and what to do.
fn unknown(preset: &Preset, section: Section, key: &str) -> String {
    let generator = preset.grows_by();
    if let Some(hint) = generator.key_hint(key).filter(|_| section.key() == generator.id()) {
        return format!("there is no '{key}' in [{}]; {hint}", generator.id());
    }
    let key = excerpt(key);
    let place = match section {
        Section::Tree => "at the top of a preset".to_owned(),
        table => format!("in [{}]", table.key()),
    };
    let mut known = KNOBS.iter().filter(|knob| knob.knob.name == key);
    // Of several tables that have it, this one says most.
    let known = known.clone().find(|knob| knob.section == section).or_else(|| known.next());
    if let Some(known) = known {
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
    let knobs = preset.knobs();
    let mut names: Vec<&str> =
        knobs.iter().filter(|(knob, _)| knob.section == section).map(|(knob, _)| knob.knob.name).collect();
    names.extend(materials(preset, section));
    if section == Section::Tree {
        names.extend(HEADINGS);
        names.extend([EDITS, AGES]);
        names.extend(Section::all().iter().map(|s| s.key()).filter(|s| !s.is_empty()));
    }
    match nearest(&key, names.iter().copied()) {
        found @ Some(_) => format!("there is no '{key}' {place}{}", did_you_mean(found)),
        None => format!("there is no '{key}' {place}; expected one of: {}", names.join(", ")),
    }
}
