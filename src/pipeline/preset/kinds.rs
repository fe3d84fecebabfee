//! The kinds of foliage of a preset: what each is called, its knobs by name, added and taken away.
//!
//! A knob of a further kind is named by its kind and its own name: `also.1.leaf_keep`, where the number counts the
//! tables `[[foliage.also]]` from 1, or by the kind's label, `blossom.leaf_keep`. The label is the name that the
//! document gives the kind, else its outline where that is of one kind alone. Knobs of the first kind go by their names.

use std::sync::LazyLock;

use linden_base::document::NamesFiles;
use linden_base::knob::{Field, Kind, Knob, Value, did_you_mean, excerpt, nearest, printable};
use linden_plant::settings::{ALSO, Form, LEAF_KNOBS, LeafKind, MOST_KINDS, check_kind_name};

use super::knobs::{KNOBS, PresetKnob, Section};
use super::{KnobError, Preset};

/// What a further kind is made of: anything but nothing, which a document could not say.
const FORMS: &[&str] = Form::WORDS.split_at(1).1;

/// All addresses: of each further kind those of its knobs, in the order of [`LEAF_KNOBS`].
static ADDRESSES: LazyLock<Vec<Vec<String>>> = LazyLock::new(|| {
    let of_kind = |kind: usize| {
        LEAF_KNOBS.iter().map(|row| format!("{}.{}", number_label(kind), row.knob.name)).collect()
    };
    (0..MOST_KINDS - 1).map(of_kind).collect()
});

/// The rows of all further kinds that there can be.
static ROWS: LazyLock<Vec<Vec<PresetKnob>>> = LazyLock::new(|| {
    let row = |kind: usize, (name, field): (&'static String, &Field<LeafKind>)| {
        let is_form = field.knob.name == LEAF_KNOBS[0].knob.name;
        let range = if is_form { Kind::Choice(FORMS) } else { field.knob.kind };
        PresetKnob::of_kind(kind, Knob { name, kind: range, aliases: &[], ..field.knob }, *field)
    };
    let rows = |(kind, names): (usize, &'static Vec<String>)| {
        names.iter().zip(&LEAF_KNOBS).map(|pair| row(kind, pair)).collect()
    };
    ADDRESSES.iter().enumerate().map(rows).collect()
});

/// The rows of a further kind by its number from 0, in the order of [`LEAF_KNOBS`].
pub(super) fn kind_rows(kind: usize) -> &'static [PresetKnob] {
    ROWS.get(kind).map_or(&[], Vec::as_slice)
}

/// Why a kind of foliage was not added, named or taken away.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KindError {
    /// A plant has no more kinds.
    #[error("there are {MOST_KINDS} kinds of foliage already, the most that a plant may have")]
    TooMany,
    /// There is no further kind of this number.
    #[error("there is no further kind {0} of foliage")]
    Unknown(usize),
    /// It cannot be called so.
    #[error("a kind of foliage cannot be called '{}': {problem}", excerpt(.name))]
    Name {
        /// What was typed.
        name: String,
        /// Why not.
        problem: String,
    },
}

/// `also.1` of the further kind 0.
fn number_label(kind: usize) -> String {
    format!("{ALSO}.{}", kind + 1)
}

/// Whether a name is that of a knob of some kind of foliage, as far as can be told without the preset: no option of a
/// format, which are written with a dot too.
///
/// ```
/// use linden_pipeline::preset::is_kind_knob;
/// assert!(is_kind_knob("blossom.leaf_keep") && is_kind_knob("also.2.leaf_keep"));
/// assert!(!is_kind_knob("leaf_keep") && !is_kind_knob("glb.instances"));
/// ```
pub fn is_kind_knob(name: &str) -> bool {
    let Some((kind, knob)) = name.rsplit_once('.') else { return false };
    let is_numbered = || kind.split('.').next() == Some(ALSO);
    LEAF_KNOBS.iter().any(|row| row.knob.is_called(knob)) || is_leaf_file(knob) || is_numbered()
}

/// What a knob of this name is, in whatever preset has one: also that of a kind of foliage, by its address.
pub fn knob_named(name: &str) -> Option<Knob> {
    let of_kind = || {
        let (_, short) = name.rsplit_once('.')?;
        ROWS[0].iter().map(|row| row.knob).zip(&LEAF_KNOBS).find(|(_, field)| field.knob.is_called(short))
    };
    let plain = KNOBS.iter().map(|row| row.knob).find(|knob| knob.is_called(name));
    plain.or_else(|| of_kind().map(|(knob, _)| knob))
}

fn is_leaf_file(key: &str) -> bool {
    LeafKind::FILES.iter().any(|row| row.key == key)
}

impl Preset {
    /// What the further kinds of foliage are called, in their order: the name that the document gives each, else its
    /// outline where no other kind has that, else its number, as `also.2`.
    ///
    /// ```
    /// let apple = linden_pipeline::preset::builtin("apple")?.load()?;
    /// assert_eq!(apple.kind_labels()[0], "blossom");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn kind_labels(&self) -> Vec<String> {
        let all: Vec<&LeafKind> = self.dressing.foliage.kinds().collect();
        let outline = |kind: &LeafKind| Value::to_string(&(LEAF_KNOBS[1].read)(kind));
        let label = |(i, kind): (usize, &&LeafKind)| {
            if let Some(name) = &kind.name {
                return name.clone();
            }
            let shape = outline(kind);
            let is_taken = |(j, other): (usize, &&LeafKind)| {
                j != i && (other.name.as_ref() == Some(&shape) || outline(other) == shape)
            };
            let has_outline = kind.form != Form::Mesh && kind.picture.is_none();
            if has_outline && !all.iter().enumerate().any(is_taken) { shape } else { number_label(i - 1) }
        };
        all.iter().enumerate().skip(1).map(label).collect()
    }

    /// The knobs of the further kinds of foliage with their values, kind by kind. Their names are addresses, as
    /// `also.1.leaf_keep`, which [`set`](Self::set) takes.
    pub fn kind_knobs(&self) -> Vec<(PresetKnob, Value)> {
        let kinds = ROWS.iter().take(self.dressing.foliage.also.len()).flatten();
        kinds.filter_map(|row| Some((*row, row.read(self)?))).collect()
    }

    /// All knobs with their values: [`knobs`](Self::knobs), and behind them those of the further kinds of foliage.
    pub fn all_knobs(&self) -> Vec<(PresetKnob, Value)> {
        let mut all = self.knobs();
        all.extend(self.kind_knobs());
        all
    }

    /// The row of the knob that a name means: also one that it had before, or one with the label of a kind of foliage.
    ///
    /// ```
    /// let apple = linden_pipeline::preset::builtin("apple")?.load()?;
    /// let row = apple.find_knob("blossom.leaf_keep").ok_or("none")?;
    /// assert_eq!((row.knob.name, row.short_name()), ("also.1.leaf_keep", "leaf_keep"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn find_knob(&self, name: &str) -> Option<PresetKnob> {
        let of_kind = || self.kind_knob(name).ok().flatten();
        self.find_row(|_, knob| knob.is_called(name)).or_else(of_kind)
    }

    /// The row that an address means; `None` where it is no address.
    ///
    /// # Errors
    /// What is wrong with the address.
    pub(super) fn kind_knob(&self, name: &str) -> Result<Option<PresetKnob>, String> {
        let Some((kind, knob)) = name.rsplit_once('.').filter(|_| is_kind_knob(name)) else {
            return Ok(None);
        };
        let kind = self.kind_number(kind)?;
        let Some(row) = LEAF_KNOBS.iter().position(|row| row.knob.is_called(knob)) else {
            let meant = nearest(knob, LEAF_KNOBS.iter().map(|row| row.knob.name));
            return Err(format!("a kind of foliage has no knob '{}'{}", excerpt(knob), did_you_mean(meant)));
        };
        match kind.checked_sub(1) {
            Some(also) => Ok(ROWS.get(also).and_then(|rows| rows.get(row)).copied()),
            None => {
                let name = LEAF_KNOBS[row].knob.name;
                Ok(self.find_row(|_, knob| knob.name == name))
            }
        }
    }

    /// The number of the kind that the first part of an address names, as
    /// [`FoliageSettings::kinds`](super::FoliageSettings::kinds) counts them: 0 is the first kind, by its name.
    ///
    /// # Errors
    /// That there is no such kind, and which there are.
    pub(super) fn kind_number(&self, kind: &str) -> Result<usize, String> {
        let labels = self.kind_labels();
        let number = kind.strip_prefix(ALSO).and_then(|rest| rest.strip_prefix('.')?.parse::<usize>().ok());
        let is_first = self.dressing.foliage.first.name.as_deref() == Some(kind);
        number
            .filter(|number| (1..=labels.len()).contains(number))
            .or_else(|| is_first.then_some(0))
            .or_else(|| Some(labels.iter().position(|label| label == kind)? + 1))
            .ok_or_else(|| self.no_kind(kind, &labels))
    }

    /// Says that there is no such kind, and which there are.
    fn no_kind(&self, typed: &str, labels: &[String]) -> String {
        let preset = printable(&self.id);
        let typed_kind = excerpt(typed);
        if labels.is_empty() {
            return format!(
                "there is no kind of foliage '{typed_kind}': '{preset}' has one kind alone, whose knobs go by their names"
            );
        }
        let meant = nearest(typed, labels.iter().map(String::as_str));
        let numbered = labels.iter().enumerate().map(|(i, label)| match number_label(i) {
            number if number == *label => number,
            number => format!("{label} ({number})"),
        });
        let known: Vec<String> = numbered.collect();
        let meant = did_you_mean(meant);
        format!("there is no kind of foliage '{typed_kind}'{meant}; '{preset}' has: {}", known.join(", "))
    }

    /// Gives a key that names a file (`leaf_picture`) of a further kind, as `blossom.leaf_picture`, a file; whether it
    /// is one.
    pub(super) fn put_kind_file(&mut self, name: &str, file: &str) -> bool {
        let Some((kind, key)) = name.rsplit_once('.') else { return false };
        let Ok(number) = self.kind_number(kind) else { return false };
        self.dressing.foliage.kinds_mut().nth(number).is_some_and(|kind| kind.put_file(key, file))
    }

    /// The files that a further kind of foliage names, by its number from 0, with their keys.
    pub fn kind_files(&self, kind: usize) -> Vec<(&'static str, &str)> {
        self.dressing.foliage.also.get(kind).map_or_else(Vec::new, |kind| kind.named_files().collect())
    }

    /// Whether a key names a file, also of a kind of foliage: `leaf_picture`, `blossom.leaf_picture`.
    pub fn is_file_key(name: &str) -> bool {
        let of_kind = name.rsplit_once('.').is_some_and(|(_, key)| is_leaf_file(key));
        of_kind || Self::file_keys().any(|(_, key, _)| key == name)
    }

    /// Whether the preset has the kind of foliage that a key or the name of a knob is of.
    ///
    /// # Errors
    /// [`KnobError::Kind`].
    pub fn check_kind_of(&self, name: &str) -> Result<(), KnobError> {
        let Some((kind, _)) = name.rsplit_once('.').filter(|_| is_kind_knob(name)) else { return Ok(()) };
        let refused = |problem| KnobError::Kind { name: printable(name), problem };
        self.kind_number(kind).map(|_| ()).map_err(refused)
    }

    /// Adds a kind of foliage behind the others; gives its number among the further kinds, from 0.
    ///
    /// # Errors
    /// [`KindError::TooMany`].
    pub fn add_kind(&mut self, kind: LeafKind) -> Result<usize, KindError> {
        let also = &mut self.dressing.foliage.also;
        if also.len() + 1 >= MOST_KINDS {
            return Err(KindError::TooMany);
        }
        also.push(kind);
        Ok(also.len() - 1)
    }

    /// Takes a further kind of foliage away, by its number from 0.
    ///
    /// # Errors
    /// [`KindError::Unknown`].
    pub fn remove_kind(&mut self, kind: usize) -> Result<LeafKind, KindError> {
        let also = &mut self.dressing.foliage.also;
        if kind < also.len() { Ok(also.remove(kind)) } else { Err(KindError::Unknown(kind + 1)) }
    }

    /// Gives a further kind of foliage a name, by its number from 0; an empty one takes its name away.
    ///
    /// # Errors
    /// [`KindError`]: no such kind; no name of a kind, or that of another.
    pub fn name_kind(&mut self, kind: usize, name: &str) -> Result<(), KindError> {
        let name = name.trim();
        let foliage = &mut self.dressing.foliage;
        if kind >= foliage.also.len() {
            return Err(KindError::Unknown(kind + 1));
        }
        let refused = |problem: String| Err(KindError::Name { name: name.to_owned(), problem });
        if !name.is_empty() {
            if let Err(problem) = check_kind_name(name) {
                return refused(problem);
            }
            let mut others = foliage.kinds().enumerate().filter(|(i, _)| *i != kind + 1);
            if others.any(|(_, other)| other.name.as_deref() == Some(name)) {
                return refused("another kind has that name".to_owned());
            }
        }
        foliage.also[kind].name = Some(name.to_owned()).filter(|name| !name.is_empty());
        Ok(())
    }
}

impl PresetKnob {
    /// Its name without that of its kind of foliage: `leaf_keep` of `also.1.leaf_keep`.
    pub fn short_name(&self) -> &'static str {
        match self.section {
            Section::Kind(_) => self.knob.name.rsplit('.').next().unwrap_or(self.knob.name),
            _ => self.knob.name,
        }
    }
}
