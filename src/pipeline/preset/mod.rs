//! Presets: a document ⇄ what the pipeline needs, and the table of knobs between them.

mod ages;
#[cfg(test)]
mod declared_knob_tests;
mod define;
mod edit;
mod edits;
#[cfg(test)]
mod foliage_tests;
mod former;
mod idle;
#[cfg(test)]
mod kind_tests;
mod kinds;
mod knobs;
mod library;
mod mention;
mod parameters;
#[cfg(test)]
mod part_tests;
mod read;
mod source_kind;
mod spreads;
#[cfg(test)]
mod stand_tests;
mod tags;
mod write;

use std::collections::BTreeMap;
use std::fmt;

use linden_base::document::NamesFiles;
use linden_base::input::Inputs;
use linden_base::knob::{Kind, Knob, Spread, Value, nearest, printable};
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_plant::settings::Dressing;
use linden_skeleton::Wood;
use linden_skeleton::edit::Edit as WoodEdit;
use linden_skeleton::generator::{Asked, Generator, GeneratorError, Settings};
use linden_skeleton::refine::Refinement;

pub use ages::{AGES, Age, AgeError, MOST_AGES};
pub use define::DefineError;
pub use edit::EditError;
pub use edits::{EDIT_OPERATION, EDITS, ShortEditError};
pub use kinds::{KindError, is_kind_knob, knob_named};
pub use knobs::{KNOBS, PresetKnob, Section};
pub use library::{Builtin, BuiltinSize, RecipeError, UnknownPreset, builtin, builtin_file, builtins};
pub use linden_base::document::{Fault, FileKey, TextPlace};
pub use linden_base::knob::Length;
pub use linden_colonization::{
    Colonization, CrownDraft, CrownHandle, CrownPart, HandleMoves, MESH_HAS_NO_PROFILE, MOST_PARTS,
    PART_CROWN, PART_KNOBS, PartKnob, Role, Solid, Space,
};
pub use linden_growth::{GrowthSettings, Origin, UpAxis};
pub use linden_lsystem::{LSystem, StemHabit};
pub use linden_plant::settings::{
    Arrangement, BarkSettings, Cluster, DetailSettings, Edge, FoliageSettings, Form, KIND_NAME,
    KIND_NAME_HELP, LEAF_KNOBS, LeafKind, MOST_KINDS, Normals, WindSettings,
};
pub use linden_qsm::QsmSettings;
pub use linden_scan::{ScanRadius, ScanSettings};
pub use linden_self_organizing::{
    MOST_NODES, MOST_OBSTACLES, MOST_TREES, Neighbour, Obstacle, ObstacleSolid, SelfOrganizing,
};
pub use linden_skeleton::generator::InputTrees;
pub use linden_weber_penn::WeberPenn;
pub use mention::mention;
pub use read::Heading;
pub use source_kind::{DataKind, SourceKind};
pub use tags::{MOST_TAGS, check_tag};

use spreads::KnobSpread;

/// Everything that says how a tree grows and looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Its name in commands and files: `fir`. Lower-case letters, digits and `-`.
    pub id: String,
    /// Its name for people.
    pub name: String,
    /// Where it is listed: `abop`, `crowns`, `older`, or a group that the user names.
    pub group: String,
    /// One line: what it is.
    pub summary: String,
    /// Where it comes from: a paper and figure, a program.
    pub source: String,
    /// A paragraph about what to look for: what a book's picture of it shows, say. May be empty.
    pub about: String,
    /// Words that it is found by. See [`check_tag`].
    pub tags: Vec<String>,
    /// See [`Preset::seed`].
    seed: u64,
    /// How it grows.
    pub generator: Box<dyn Settings>,
    /// Refinement of its axes after growth.
    pub refinement: Refinement,
    /// How thick it is.
    pub wood: Wood,
    /// Edits of single axes of the grown tree, in their order.
    pub edits: Vec<WoodEdit>,
    /// How it looks.
    pub dressing: Dressing,
    /// Ages that have names.
    ages: Vec<Age>,
    /// Of knobs that each seed draws anew.
    spreads: Vec<KnobSpread>,
}

/// A mistake in turning a knob.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnobError {
    /// No preset has such a knob.
    #[error(
        "there is no knob '{name}'{}{}; 'linden show' lists the {} of '{preset}'",
        Meant(.nearest.as_deref()),
        Alike(.alike),
        .known.len()
    )]
    Unknown {
        /// What was typed, printable.
        name: String,
        /// What may have been meant.
        nearest: Option<Box<Knob>>,
        /// Where nothing is near: those that begin alike.
        alike: Box<[&'static str]>,
        /// Whose knobs were looked through.
        preset: String,
        /// All that it has.
        known: Vec<&'static str>,
    },
    /// Other presets have it, this one does not.
    #[error("'{preset}' has no knob '{name}' ({help}); 'linden show' lists the {} that it has", .known.len())]
    NotHere {
        /// The knob.
        name: &'static str,
        /// What it does where it exists.
        help: &'static str,
        /// The preset.
        preset: String,
        /// All that it has.
        known: Vec<&'static str>,
    },
    /// It names a kind of foliage that is not there, or a knob that no kind has.
    #[error("{name}: {problem}")]
    Kind {
        /// What was typed, printable.
        name: String,
        /// What is wrong, and what there is.
        problem: String,
    },
    /// Not a value of the knob.
    #[error("knob '{name}'{}: {problem}", InUnit(.unit))]
    Value {
        /// The knob.
        name: &'static str,
        /// Its unit.
        unit: &'static str,
        /// What was found and what was expected.
        problem: String,
    },
}

/// Knobs that begin as a name does, but for an `s` at its end: `leaf_length` for `leafs`.
fn alike(name: &str, known: &[&'static str]) -> Vec<&'static str> {
    const LEAST_LETTERS: usize = 3;
    let name = name.to_lowercase();
    let stem = name.strip_suffix('s').unwrap_or(&name);
    let begins = |knob: &&'static str| stem.chars().count() >= LEAST_LETTERS && knob.starts_with(stem);
    known.iter().copied().filter(begins).collect()
}

/// When a kind of foliage is there, if it is not all the year: its name, and a season that shows it.
fn season_of(kind: &LeafKind) -> Option<String> {
    let &[from, to] = kind.season_range.as_slice() else { return None };
    let name = kind.name.as_deref()?;
    if (from, to) == (0.0, 1.0) || kind.form == Form::None {
        return None;
    }
    let middle = if to < from { (from + to + 1.0) / 2.0 % 1.0 } else { f64::midpoint(from, to) };
    Some(format!("{name} is there from {from} to {to}, as at {middle:.2}"))
}

struct Meant<'a>(Option<&'a Knob>);

impl fmt::Display for Meant<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |knob| {
            write!(f, " (did you mean '{}'{}: {}?)", knob.name, InUnit(knob.unit), knob.kind)
        })
    }
}

/// How a number is written whose unit was typed behind it, as in `8cm`.
fn unit_hint(knob: &Knob, text: &str) -> Option<String> {
    let text = text.trim();
    let number =
        text.trim_end_matches(|c: char| c.is_alphabetic() || matches!(c, '°' | '%' | '²')).trim_end();
    let has_unit = number.len() < text.len() && number.parse::<f64>().is_ok();
    match (&knob.kind, knob.unit) {
        _ if !has_unit => None,
        (Kind::Real { .. } | Kind::Integer { .. }, "") => Some("write the number alone".to_owned()),
        (Kind::Real { .. } | Kind::Integer { .. } | Kind::Length { .. }, unit) if !unit.is_empty() => {
            Some(format!("write the number alone, in {unit}"))
        }
        _ => None,
    }
}

/// The first of some names, and how many more there are.
struct Alike<'a>(&'a [&'static str]);

/// How many names a message has room for.
const MOST_ALIKE: usize = 6;

impl fmt::Display for Alike<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return Ok(());
        }
        let shown = &self.0[..self.0.len().min(MOST_ALIKE)];
        write!(f, " (alike are {}", shown.join(", "))?;
        match self.0.len() - shown.len() {
            0 => f.write_str(")"),
            more => write!(f, " and {more} more)"),
        }
    }
}

struct InUnit<'a>(&'a str);

impl fmt::Display for InUnit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " (in {})", self.0) }
    }
}

impl Preset {
    /// The settings of the generator, if they are of this type.
    ///
    /// ```
    /// use linden_pipeline::preset::{Colonization, LSystem, builtin};
    /// let fir = builtin("fir")?.load()?;
    /// assert!(fir.settings::<Colonization>().is_some() && fir.settings::<LSystem>().is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn settings<T: Settings>(&self) -> Option<&T> {
        self.generator.downcast_ref()
    }

    /// The same, to be changed.
    pub fn settings_mut<T: Settings>(&mut self) -> Option<&mut T> {
        self.generator.downcast_mut()
    }

    /// Whether something stands in the tree's way or takes light from it.
    pub fn has_obstructions(&self) -> bool {
        let is_one = |part: &CrownPart| matches!(part.role, Role::Obstacle | Role::Shade);
        let by_light = self.settings::<SelfOrganizing>();
        self.settings::<Colonization>().is_some_and(|settings| settings.parts.iter().any(is_one))
            || by_light.is_some_and(|settings| !settings.obstacles.is_empty())
    }

    /// The key of what radii draw.
    pub fn wood_key(&self) -> Key {
        Key::new(self.seed).named("wood")
    }

    /// The files that are needed beside the preset, each once, relative to it: what the tree grows in,
    /// then what leaves are made of, then the bark's pictures.
    /// [`crate::recipe::Recipe::inputs`] has them by these names.
    pub fn files(&self) -> Vec<&str> {
        let mut files: Vec<&str> = Vec::new();
        let leaves = self.dressing.foliage.kinds().flat_map(NamesFiles::named_files);
        let looks = leaves.chain(self.dressing.bark.named_files()).map(|(_, file)| file);
        for file in self.generator.inputs().into_iter().chain(looks) {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    /// Gives files other names: `names` has the new ones by the old.
    pub(crate) fn rename_files(&mut self, names: &BTreeMap<String, String>) {
        let renamed = |file: &str| names.get(file).cloned();
        self.generator.rename_inputs(&renamed);
        self.dressing.foliage.kinds_mut().for_each(|kind| kind.rename(&renamed));
        self.dressing.bark.rename(&renamed);
    }

    /// The keys of the bark and of the first kind of leaves that name files: section, key, help.
    pub fn file_keys() -> impl Iterator<Item = (Section, &'static str, &'static str)> {
        let bark = BarkSettings::FILES.into_iter().map(|row| (Section::Bark, row.key, row.help));
        bark.chain(LeafKind::FILES.into_iter().map(|row| (Section::Foliage, row.key, row.help)))
    }

    /// The file that such a key names.
    pub fn file(&self, key: &str) -> Option<&str> {
        let mut all = self.dressing.bark.named_files().chain(self.dressing.foliage.first.named_files());
        all.find(|(known, _)| *known == key).map(|(_, file)| file)
    }

    /// Gives such a key a file; whether there is such a key.
    pub(crate) fn put_file(&mut self, key: &str, file: &str) -> bool {
        self.dressing.foliage.first.put_file(key, file)
            || self.dressing.bark.put_file(key, file)
            || self.put_kind_file(key, file)
    }

    /// The knobs that this preset has, with their values, in the order of the table.
    pub fn knobs(&self) -> Vec<(PresetKnob, Value)> {
        let id = self.generator.generator().id();
        let of_generator = self.generator.knobs();
        let mut all = Vec::with_capacity(knobs::before().len() + of_generator.len() + knobs::behind().len());
        let with_value = |row: &PresetKnob| row.read(self).map(|value| (*row, value));
        all.extend(knobs::before().iter().filter_map(with_value));
        all.extend(of_generator.into_iter().map(|(knob, value)| (PresetKnob::of_generator(id, knob), value)));
        all.extend(knobs::behind().iter().filter_map(with_value));
        all
    }

    /// The first row of [`knobs`](Self::knobs) that is as asked for, found without reading values.
    fn find_row(&self, is_meant: impl Fn(Section, &Knob) -> bool) -> Option<PresetKnob> {
        let in_table =
            |rows: &[PresetKnob]| rows.iter().find(|row| is_meant(row.section, &row.knob)).copied();
        in_table(knobs::before())
            .or_else(|| {
                let id = self.generator.generator().id();
                let mut own = self.generator.knobs().into_iter().map(|(knob, _)| knob);
                own.find(|knob| is_meant(Section::Generator(id), knob))
                    .map(|knob| PresetKnob::of_generator(id, knob))
            })
            .or_else(|| in_table(knobs::behind()))
    }

    /// Turns a knob, as `--set name=text` does. The preset is unchanged when it fails. A knob of a further kind of
    /// foliage is named by its kind: `also.1.leaf_keep`, or by what that is called: `blossom.leaf_keep`. A knob of
    /// numbers takes a [`Spread`], from which each seed draws: `9 ± 1`, `2..5`.
    ///
    /// ```
    /// let mut fir = linden_pipeline::preset::builtin("fir")?.load()?;
    /// fir.set("points", "500")?;
    /// let error = fir.set("pionts", "500").unwrap_err();
    /// assert!(error.to_string().contains("did you mean 'points'"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name, or a value that the knob does not take.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), KnobError> {
        let of_kind =
            self.kind_knob(name).map_err(|problem| KnobError::Kind { name: printable(name), problem })?;
        let Some(knob) = self.find_row(|_, knob| knob.is_called(name)).or(of_kind) else {
            if self.generator.set_text(name, text) {
                return Ok(());
            }
            return Err(self.no_such_knob(name));
        };
        let fault = |problem| KnobError::Value { name: knob.knob.name, unit: knob.knob.unit, problem };
        if Spread::is_meant(text) {
            let spread = knob.parse_spread(text).map_err(fault)?;
            self.put_spread(&knob, spread);
            return Ok(());
        }
        let value = knob
            .knob
            .kind
            .parse(text)
            .map_err(|problem| fault(problem + &self.hint(&knob, text, Asked::Directly)))?;
        self.drop_spread(&knob);
        knob.write(self, value);
        Ok(())
    }

    fn no_such_knob(&self, name: &str) -> KnobError {
        let known: Vec<&'static str> = self.knobs().iter().map(|(row, _)| row.knob.name).collect();
        let preset = printable(&self.id);
        if let Some(PresetKnob { knob, .. }) = KNOBS.iter().find(|row| row.knob.is_called(name)) {
            return KnobError::NotHere { name: knob.name, help: knob.help, preset, known };
        }
        let nearest = nearest(name, known.iter().copied())
            .and_then(|nearest| self.find_row(|_, knob| knob.name == nearest))
            .map(|row| Box::new(row.knob));
        let alike = if nearest.is_none() { alike(name, &known) } else { Vec::new() };
        KnobError::Unknown { name: printable(name), nearest, alike: alike.into(), preset, known }
    }

    /// What the generator advises where `text` is no value of its knob: an end for the message.
    fn hint(&self, knob: &PresetKnob, text: &str, asked: Asked) -> String {
        let generator = self.generator.generator();
        let is_its = knob.section == Section::Generator(generator.id());
        let hint = is_its.then(|| generator.value_hint(knob.knob.name, text, asked)).flatten();
        let hint = hint.map(str::to_owned).or_else(|| self.season_hint(&knob.knob, text));
        let hint = hint.or_else(|| unit_hint(&knob.knob, text));
        hint.map_or_else(String::new, |hint| format!("; {hint}"))
    }

    /// When the kinds of foliage are there that have a time of their own: for words like `bloom`.
    fn season_hint(&self, knob: &Knob, text: &str) -> Option<String> {
        let is_near = nearest(&text.trim().to_lowercase(), knob.kind.words()).is_some();
        if knob.name != "season" || is_near || text.trim().parse::<f64>().is_ok() {
            return None;
        }
        let foliage = &self.dressing.foliage;
        let times: Vec<String> = foliage.kinds().filter_map(season_of).collect();
        (!times.is_empty()).then(|| format!("on '{}' {}", printable(&self.id), times.join(", ")))
    }

    /// The trees that its input tells apart, where a knob picks one of them and is not turned.
    ///
    /// # Errors
    /// [`GeneratorError`]: the input cannot be divided as is asked for, memory, cancelled.
    pub fn trees(
        &self,
        inputs: &Inputs,
        monitor: &dyn Monitor,
    ) -> Result<Option<InputTrees>, GeneratorError> {
        self.generator.trees(inputs, monitor)
    }

    /// The way it grows.
    pub fn grows_by(&self) -> &'static dyn Generator {
        self.generator.generator()
    }
}
