//! Presets: a document ⇄ what the pipeline needs, and the table of knobs between them.

mod bark;
mod colonization;
mod detail;
mod document;
mod edit;
mod files;
mod foliage;
mod idle;
mod item;
mod knobs;
mod leaf_knobs;
mod library;
mod lsystem;
mod mention;
mod part;
mod read;
mod setting;
mod surface;
mod wind;
mod wood;
mod write;

use std::collections::BTreeMap;
use std::fmt;

use self::files::NamesFiles;
use crate::knob::{Knob, Value, nearest, printable};
use crate::skeleton::Wood;
use crate::skeleton::refine::Refinement;
use crate::surface::Tubes;

pub use bark::BarkLook;
pub use colonization::{Colonization, Space};
pub use detail::DetailLook;
pub(crate) use document::{Datum, Entry, Node};
pub use document::{Fault, Place};
pub use edit::EditError;
pub use files::FileKey;
pub use foliage::{Arrangement, Edge, FoliageLook, Form, LeafKind, MOST_KINDS, Normals};
pub use item::Field;
pub(crate) use item::List;
pub use knobs::{KNOBS, PresetKnob, Section, shape_knobs};
pub use leaf_knobs::LEAF_KNOBS;
pub use library::{Builtin, BuiltinSize, RecipeError, builtin, builtin_file, builtins};
pub use lsystem::LSystem;
pub use mention::mention;
pub use part::{MOST_PARTS, PART_CROWN, PART_KNOBS, Part, PartKnob, Solid};
pub use read::Heading;
pub use setting::{Habit, Length, Origin, Pull, Role, ScanRadius, UpAxis};
pub use wind::WindLook;

/// Everything that says how a tree grows and looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// What scripts call it: `fir`. Lower-case letters, digits and `-`.
    pub id: String,
    /// What people call it.
    pub name: String,
    /// Where it is listed: `abop`, `crowns`, `older`, or the user's own.
    pub group: String,
    /// One line: what it is.
    pub summary: String,
    /// Where it comes from: a paper and figure, a program.
    pub source: String,
    /// What to look for, in a paragraph: what a book's picture of it shows, say. May be empty.
    pub about: String,
    /// The root of all random choices.
    pub seed: u64,
    /// How it grows.
    pub generator: Generator,
    /// What is done to it after growth.
    pub refinement: Refinement,
    /// How thick it is.
    pub wood: Wood,
    /// How its surface is made.
    pub tubes: Tubes,
    /// How its bark looks.
    pub bark: BarkLook,
    /// How its leaves look.
    pub foliage: FoliageLook,
    /// How much of it is shown.
    pub detail: DetailLook,
    /// How it moves.
    pub wind: WindLook,
}

/// How a tree grows.
#[allow(clippy::large_enum_variant, reason = "a preset has one, and there are few presets")]
#[derive(Clone, Debug, PartialEq)]
pub enum Generator {
    /// By rewriting.
    LSystem(LSystem),
    /// By competing for space.
    Colonization(Colonization),
}

impl Generator {
    /// `lsystem` or `colonization`.
    pub const fn id(&self) -> &'static str {
        match self {
            Self::LSystem(_) => "lsystem",
            Self::Colonization(_) => "colonization",
        }
    }
}

/// What is wrong with a knob that somebody turned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KnobError {
    /// No preset has such a knob.
    #[error("there is no knob '{name}'{}; '{preset}' has: {}", Meant(.nearest.as_deref()), .known.join(", "))]
    Unknown {
        /// What was typed, printable.
        name: String,
        /// What may have been meant.
        nearest: Option<Box<Knob>>,
        /// Whose knobs were looked through.
        preset: String,
        /// All that it has.
        known: Vec<&'static str>,
    },
    /// Other presets have it, this one does not.
    #[error("'{preset}' has no knob '{name}' ({help}); it has: {}", .known.join(", "))]
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

struct Meant<'a>(Option<&'a Knob>);

impl fmt::Display for Meant<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |knob| {
            write!(f, " (did you mean '{}'{}: {}?)", knob.name, InUnit(knob.unit), knob.kind)
        })
    }
}

struct InUnit<'a>(&'a str);

impl fmt::Display for InUnit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " (in {})", self.0) }
    }
}

impl Preset {
    /// What the crown fills, `None` for an L-system.
    pub fn space(&self) -> Option<&Space> {
        self.colonization().map(|own| &own.space)
    }

    /// The parts of the crown and the solids near it; none for an L-system.
    pub fn parts(&self) -> &[Part] {
        self.colonization().map_or(&[], |own| &own.parts)
    }

    /// The files that are needed beside the preset, each once, relative to it: what the crown fills,
    /// then the meshes of the parts, then what leaves are made of, then the bark's pictures.
    /// [`crate::recipe::Recipe::inputs`] has them by these names.
    pub fn files(&self) -> Vec<&str> {
        let mut files: Vec<&str> = Vec::new();
        let parts = self.parts().iter().filter_map(Part::file);
        let leaves = self.foliage.kinds().flat_map(NamesFiles::named_files);
        let looks = leaves.chain(self.bark.named_files()).map(|(_, file)| file);
        for file in self.space().and_then(Space::file).into_iter().chain(parts).chain(looks) {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    /// Gives files other names: `names` has the new ones by the old.
    pub(crate) fn rename_files(&mut self, names: &BTreeMap<String, String>) {
        let (space, parts) = match &mut self.generator {
            Generator::LSystem(_) => (None, None),
            Generator::Colonization(own) => (Some(&mut own.space), Some(&mut own.parts)),
        };
        let space = space.and_then(|space| match space {
            Space::Shape { .. } => None,
            Space::Envelope { file } | Space::Points { file } => Some(file),
        });
        let parts = parts.into_iter().flatten().filter_map(|part| match &mut part.solid {
            Solid::Shape { .. } => None,
            Solid::Mesh { file } => Some(file),
        });
        let renamed = |file: &str| names.get(file).cloned();
        for file in space.into_iter().chain(parts) {
            if let Some(name) = renamed(file) {
                *file = name;
            }
        }
        self.foliage.kinds_mut().for_each(|kind| kind.rename(&renamed));
        self.bark.rename(&renamed);
    }

    /// The keys of the bark and of the first kind of leaves that name files: section, key, help.
    pub fn file_keys() -> impl Iterator<Item = (Section, &'static str, &'static str)> {
        let bark = BarkLook::FILES.into_iter().map(|row| (Section::Bark, row.key, row.help));
        bark.chain(LeafKind::FILES.into_iter().map(|row| (Section::Foliage, row.key, row.help)))
    }

    /// The file that such a key names.
    pub fn file(&self, key: &str) -> Option<&str> {
        let mut all = self.bark.named_files().chain(self.foliage.first.named_files());
        all.find(|(own, _)| *own == key).map(|(_, file)| file)
    }

    /// Gives such a key a file; whether there is such a key.
    pub(crate) fn put_file(&mut self, key: &str, file: &str) -> bool {
        self.foliage.first.put_file(key, file) || self.bark.put_file(key, file)
    }

    /// The knobs that this preset has, with their values, in the order of the table.
    pub fn knobs(&self) -> Vec<(PresetKnob, Value)> {
        let own = KNOBS.iter().copied().chain(self.shape_knobs());
        own.filter_map(|knob| knob.read(self).map(|value| (knob, value))).collect()
    }

    /// Turns a knob, as `--set name=text` does. The preset is unchanged when it fails.
    ///
    /// ```
    /// let mut fir = linden::preset::builtin("fir").unwrap().load()?;
    /// fir.set("points", "500")?;
    /// let error = fir.set("pionts", "500").unwrap_err();
    /// assert!(error.to_string().contains("did you mean 'points'"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An unknown name, or a value that the knob does not take.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), KnobError> {
        let own = self.knobs();
        let Some((knob, _)) = own.iter().find(|(knob, _)| knob.knob.name == name) else {
            let known: Vec<&'static str> = own.iter().map(|(knob, _)| knob.knob.name).collect();
            let preset = printable(&self.id);
            let elsewhere = KNOBS.iter().copied().chain(shape_knobs());
            return Err(match elsewhere.into_iter().find(|knob| knob.knob.name == name) {
                Some(PresetKnob { knob, .. }) => {
                    KnobError::NotHere { name: knob.name, help: knob.help, preset, known }
                }
                None => {
                    let nearest = nearest(name, known.iter().copied());
                    let meant = own.iter().find(|(knob, _)| Some(knob.knob.name) == nearest);
                    let nearest = meant.map(|(knob, _)| Box::new(knob.knob));
                    KnobError::Unknown { name: printable(name), nearest, preset, known }
                }
            });
        };
        let bad = |problem| KnobError::Value { name: knob.knob.name, unit: knob.knob.unit, problem };
        let value = knob.knob.kind.parse(text).map_err(|problem| {
            // No knob names a file: a mesh is what a tree grows into from the start.
            let hint = colonization::mesh_hint(text, "a mesh is a SOURCE of its own, like crown.obj");
            bad(if name == "crown" { problem + &hint } else { problem })
        })?;
        knob.write(self, value);
        Ok(())
    }

    /// The knobs of the crown's shape, none without one.
    fn shape_knobs(&self) -> impl Iterator<Item = PresetKnob> + use<> {
        let own = match &self.generator {
            Generator::Colonization(Colonization { space: Space::Shape { shape, .. }, .. }) => {
                crate::colonization::crown::shape(shape).ok()
            }
            _ => None,
        };
        own.into_iter().flat_map(|shape| shape.knobs).map(PresetKnob::of_shape)
    }
}
