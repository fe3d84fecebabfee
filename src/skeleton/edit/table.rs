//! The table of what edits have: documents, the command line's short form, the schema and checks are made from it.

use std::fmt;
use std::str::FromStr;

use linden_base::knob::{
    FARTHEST, Kind, Knob, Value, did_you_mean, excerpt, integer, nearest, real, real_or_auto,
};

use super::path::{AxisPath, AxisRoot};
use super::{Along, Edit, MOST_POINTS, Operation};

/// What an edit has besides its operation and paths.
#[derive(Clone, Copy)]
pub struct EditKnob {
    /// Name, kind, unit, help.
    pub knob: Knob,
    /// The words of the operations that have it; empty: all.
    pub operations: &'static [&'static str],
    /// Its value; `None` where the edit has none.
    pub read: fn(&Edit) -> Option<Value>,
    write: fn(&mut Edit, Value),
}

/// A path that an edit has.
#[derive(Clone, Copy)]
pub struct EditPath {
    /// Its key.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// The words of the operations that have it; empty: all.
    pub operations: &'static [&'static str],
}

/// All paths that edits have.
pub const EDIT_PATHS: [EditPath; 2] = [
    EditPath {
        name: "axis",
        help: "the axis that is edited, or that bears a new one: stem/12",
        operations: &[],
    },
    EditPath {
        name: "from",
        help: "for do=copy: the axis that is copied, with all that it bears",
        operations: &["copy"],
    },
];

/// What stands for a path that was not given.
const UNSET: AxisPath = AxisPath { root: AxisRoot::New(0), laterals: Vec::new() };

/// An operation: its word, a line of help, what its bare value in the short form means, and the operation with
/// everything at its default.
struct OperationRow {
    word: &'static str,
    main: Option<&'static str>,
    plain: fn() -> Operation,
}

const HALFWAY: Along = Along::share(0.5);

const OPERATIONS: [OperationRow; 7] = [
    OperationRow { word: "remove", main: None, plain: || Operation::Remove },
    OperationRow { word: "cut", main: Some("at"), plain: || Operation::Cut { at: HALFWAY } },
    OperationRow {
        word: "bend",
        main: Some("angle"),
        plain: || Operation::Bend {
            at: Along::share(0.0),
            angle_deg: 30.0,
            towards: None,
            round: None,
            over: 0.25,
        },
    },
    OperationRow {
        word: "scale",
        main: Some("length"),
        plain: || Operation::Scale { length: 1.0, thickness: 1.0 },
    },
    OperationRow {
        word: "add",
        main: Some("length_m"),
        plain: || Operation::Add {
            at: HALFWAY,
            towards: None,
            length_m: 1.0,
            thickness: 0.5,
            radius_m: None,
            lift_deg: 20.0,
        },
    },
    OperationRow {
        word: "copy",
        main: Some("from"),
        plain: || Operation::Copy {
            at: HALFWAY,
            from: UNSET,
            from_near: None,
            towards: None,
            size: 1.0,
            turn_deg: 0.0,
        },
    },
    OperationRow { word: "curve", main: Some("points"), plain: || Operation::Curve { points: Vec::new() } },
];

impl Operation {
    /// The words of all operations.
    pub const WORDS: &[&'static str] = &["remove", "cut", "bend", "scale", "add", "copy", "curve"];

    /// The word that documents and command lines have for it.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Remove => "remove",
            Self::Cut { .. } => "cut",
            Self::Bend { .. } => "bend",
            Self::Scale { .. } => "scale",
            Self::Add { .. } => "add",
            Self::Copy { .. } => "copy",
            Self::Curve { .. } => "curve",
        }
    }

    /// The operation of a word, with everything at its default.
    pub fn named(word: &str) -> Option<Self> {
        OPERATIONS.iter().find(|row| row.word == word).map(|row| (row.plain)())
    }

    fn along(&self) -> Option<Along> {
        match self {
            Self::Cut { at } | Self::Bend { at, .. } | Self::Add { at, .. } | Self::Copy { at, .. } => {
                Some(*at)
            }
            _ => None,
        }
    }

    fn along_mut(&mut self) -> Option<&mut Along> {
        match self {
            Self::Cut { at } | Self::Bend { at, .. } | Self::Add { at, .. } | Self::Copy { at, .. } => {
                Some(at)
            }
            _ => None,
        }
    }
}

fn place(value: Option<[f64; 3]>) -> Value {
    value.map_or(Value::Auto, Value::Vector)
}

fn of_place(value: &Value) -> Option<[f64; 3]> {
    if let Value::Vector(place) = value { Some(*place) } else { None }
}

fn of_real(value: &Value) -> Option<f64> {
    if let Value::Real(number) = value { Some(*number) } else { None }
}

/// A row for a number that some operations have.
macro_rules! number {
    ($name:literal, $min:expr, $max:expr, $unit:literal, $help:literal, $words:expr, $($pattern:pat_param)|+ => $field:ident) => {
        EditKnob {
            knob: Knob::new($name, real($min, $max), $unit, $help),
            operations: $words,
            read: |edit| match &edit.operation {
                $($pattern)|+ => Some(Value::Real(*$field)),
                _ => None,
            },
            write: |edit, value| {
                if let ($($pattern)|+, Some(number)) = (&mut edit.operation, of_real(&value)) {
                    *$field = number;
                }
            },
        }
    };
}

/// A row for a direction that some operations have.
macro_rules! way {
    ($name:literal, $help:literal, $words:expr, $($pattern:pat_param)|+ => $field:ident) => {
        EditKnob {
            knob: Knob::new($name, Kind::Vector { auto: true }, "", $help),
            operations: $words,
            read: |edit| match &edit.operation {
                $($pattern)|+ => Some(place(*$field)),
                _ => None,
            },
            write: |edit, value| {
                if let $($pattern)|+ = &mut edit.operation {
                    *$field = of_place(&value);
                }
            },
        }
    };
}

const PLACED: &[&str] = &["cut", "bend", "add", "copy"];

/// All rows, in the order of a document.
pub static EDIT_KNOBS: [EditKnob; 17] = [
    EditKnob {
        knob: Knob::new(
            "at",
            real(0.0, 1.0),
            "",
            "where along the axis, as a share of its length: 0 where it leaves, 1 its tip",
        ),
        operations: PLACED,
        read: |edit| edit.operation.along().map(|at| Value::Real(at.share)),
        write: |edit, value| {
            if let (Some(at), Some(share)) = (edit.operation.along_mut(), of_real(&value)) {
                at.share = share;
            }
        },
    },
    EditKnob {
        knob: Knob::new(
            "at_m",
            real_or_auto(0.0, FARTHEST),
            "m",
            "where along the axis, in metres from where it leaves; auto: by at",
        ),
        operations: PLACED,
        read: |edit| edit.operation.along().map(|at| at.metres.map_or(Value::Auto, Value::Real)),
        write: |edit, value| {
            if let Some(at) = edit.operation.along_mut() {
                at.metres = of_real(&value);
            }
        },
    },
    number!("angle", -180.0, 180.0, "deg", "for do=bend: how far it turns; towards a direction, no farther than to it",
        &["bend"], Operation::Bend { angle_deg, .. } => angle_deg),
    way!("towards", "for do=bend, add, copy: the direction to turn to, or to point in; auto: down for bend, into the widest gap for add, as the other stands for copy",
        &["bend", "add", "copy"],
        Operation::Bend { towards, .. } | Operation::Add { towards, .. } | Operation::Copy { towards, .. } => towards),
    way!("round", "for do=bend: the direction to turn around by the right hand, instead of towards; auto: none",
        &["bend"], Operation::Bend { round, .. } => round),
    number!("over", 0.0, 1.0, "", "for do=bend: the share of the axis' length over which it turns; 0 is a kink",
        &["bend"], Operation::Bend { over, .. } => over),
    number!("length", 0.01, 100.0, "", "for do=scale: new length / old one, of the axis and all that it bears",
        &["scale"], Operation::Scale { length, .. } => length),
    number!("thickness", 0.01, 100.0, "", "for do=scale: new thickness / old one; for do=add: radius at the base / that of the axis there",
        &["scale", "add"], Operation::Scale { thickness, .. } | Operation::Add { thickness, .. } => thickness),
    number!("length_m", 0.001, 1000.0, "m", "for do=add: how long the new axis is",
        &["add"], Operation::Add { length_m, .. } => length_m),
    EditKnob {
        knob: Knob::new(
            "radius_m",
            real_or_auto(1e-6, 1000.0),
            "m",
            "for do=add: radius at the base, up to that of the axis there; auto: by thickness",
        ),
        operations: &["add"],
        read: |edit| match &edit.operation {
            Operation::Add { radius_m, .. } => Some(radius_m.map_or(Value::Auto, Value::Real)),
            _ => None,
        },
        write: |edit, value| {
            if let Operation::Add { radius_m, .. } = &mut edit.operation {
                *radius_m = of_real(&value);
            }
        },
    },
    number!("lift", -180.0, 180.0, "deg", "for do=add: how far it turns up over its length; below 0: down",
        &["add"], Operation::Add { lift_deg, .. } => lift_deg),
    number!("size", 0.01, 100.0, "", "for do=copy: size / that of what is copied",
        &["copy"], Operation::Copy { size, .. } => size),
    number!("turn", -360.0, 360.0, "deg", "for do=copy: how far it is turned around the axis that bears it; with towards, around that",
        &["copy"], Operation::Copy { turn_deg, .. } => turn_deg),
    EditKnob {
        knob: Knob::new(
            "points",
            Kind::Reals { min: -FARTHEST, max: FARTHEST, most: 3 * MOST_POINTS },
            "m",
            "for do=curve: x y z of the points that the axis runs through after its base, from there",
        ),
        operations: &["curve"],
        read: |edit| match &edit.operation {
            Operation::Curve { points } if !points.is_empty() => Some(Value::Reals(points.concat())),
            _ => None,
        },
        write: |edit, value| {
            if let (Operation::Curve { points }, Value::Reals(numbers)) = (&mut edit.operation, value) {
                // What is left over makes a point that no check lets through.
                let point = |xyz: &[f64]| [0, 1, 2].map(|i| xyz.get(i).copied().unwrap_or(f64::NAN));
                *points = numbers.chunks(3).map(point).collect();
            }
        },
    },
    EditKnob {
        knob: Knob::new(
            "near",
            Kind::Vector { auto: true },
            "m",
            "where the axis began when the edit was made: finds it again when other knobs have changed the tree; auto: by its path alone",
        ),
        operations: &[],
        read: |edit| edit.near.map(Value::Vector),
        write: |edit, value| edit.near = of_place(&value),
    },
    EditKnob {
        knob: Knob::new(
            "from_near",
            Kind::Vector { auto: true },
            "m",
            "for do=copy: as near, of the axis that is copied",
        ),
        operations: &["copy"],
        read: |edit| match &edit.operation {
            Operation::Copy { from_near, .. } => from_near.map(Value::Vector),
            _ => None,
        },
        write: |edit, value| {
            if let Operation::Copy { from_near, .. } = &mut edit.operation {
                *from_near = of_place(&value);
            }
        },
    },
    EditKnob {
        knob: Knob::new(
            "branching",
            integer(0, u32::MAX as u64),
            "",
            "fingerprint of the branching when the edit was made ('linden show --axes'): while the tree has it, the path alone decides",
        ),
        operations: &[],
        read: |edit| edit.branching.map(|branching| Value::Integer(branching.into())),
        write: |edit, value| {
            if let Value::Integer(branching) = value {
                edit.branching = branching.try_into().ok();
            }
        },
    },
];

impl EditKnob {
    /// Whether an operation has it.
    pub fn is_of(&self, operation: &Operation) -> bool {
        self.operations.is_empty() || self.operations.contains(&operation.word())
    }
}

impl EditPath {
    /// Whether an operation has it.
    pub fn is_of(&self, operation: &Operation) -> bool {
        self.operations.is_empty() || self.operations.contains(&operation.word())
    }
}

impl Edit {
    /// The edit of an operation's word with everything at its default and no axis yet; `None` for no such word.
    pub fn named(word: &str) -> Option<Self> {
        Some(Self::new(UNSET, Operation::named(word)?))
    }

    /// The same with everything at its default, but for what it is done to.
    #[must_use]
    pub fn plain(&self) -> Self {
        let mut plain = Self::new(self.axis.clone(), self.operation.clone());
        if let Some(operation) = Operation::named(self.operation.word()) {
            plain.operation = operation;
        }
        plain
    }

    /// The paths that it has, by their keys.
    pub fn paths(&self) -> Vec<(&'static str, &AxisPath)> {
        let from = match &self.operation {
            Operation::Copy { from, .. } => Some(("from", from)),
            _ => None,
        };
        [Some(("axis", &self.axis)), from].into_iter().flatten().collect()
    }

    /// What it has besides, by the rows of the table.
    pub fn knobs(&self) -> Vec<(Knob, Value)> {
        let rows = EDIT_KNOBS.iter().filter(|row| row.is_of(&self.operation));
        rows.filter_map(|row| Some((row.knob, (row.read)(self)?))).collect()
    }

    /// Sets a path by its key; whether the edit has such a path.
    pub fn set_path(&mut self, key: &str, path: AxisPath) -> bool {
        match (key, &mut self.operation) {
            ("axis", _) => self.axis = path,
            ("from", Operation::Copy { from, .. }) => *from = path,
            _ => return false,
        }
        true
    }

    /// Sets what a row of the table is for to a value that its kind has checked; whether the edit has it.
    pub fn set(&mut self, key: &str, value: Value) -> bool {
        let row = EDIT_KNOBS.iter().find(|row| row.knob.is_called(key) && row.is_of(&self.operation));
        row.inspect(|row| (row.write)(self, value)).is_some()
    }

    /// The keys that an edit of this operation has.
    pub fn keys(&self) -> Vec<&'static str> {
        let paths = EDIT_PATHS.iter().filter(|row| row.is_of(&self.operation)).map(|row| row.name);
        let knobs = EDIT_KNOBS.iter().filter(|row| row.is_of(&self.operation)).map(|row| row.knob.name);
        paths.chain(knobs).collect()
    }

    /// Whether everything is given and within its range.
    ///
    /// # Errors
    /// What is missing or out of range.
    pub fn check(&self) -> Result<(), String> {
        if let Operation::Curve { points } = &self.operation {
            if points.is_empty() {
                return Err("it has no 'points'; give it some, like 0 1 0 0.5 2 0".to_owned());
            }
            if points.iter().flatten().any(|x| x.is_nan()) {
                return Err("each of 'points' needs three numbers: x y z, metres from the base of the axis"
                    .to_owned());
            }
        }
        for (key, path) in self.paths() {
            if *path == UNSET {
                return Err(format!("it has no '{key}'; name an axis, like stem/12"));
            }
        }
        for (knob, value) in self.knobs() {
            knob.kind.check(&value).map_err(|problem| format!("'{}': {problem}", knob.name))?;
        }
        Ok(())
    }
}

impl fmt::Display for Edit {
    /// The short form, without what finds its axis again: `bend stem/4 45 at=0.5`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.operation.word(), self.axis)?;
        let main = OPERATIONS.iter().find(|row| row.word == self.operation.word()).and_then(|row| row.main);
        let plain = self.plain();
        let shown = |value: Value| value.to_string().replace(' ', ",");
        let mut parts: Vec<(&str, String)> = Vec::new();
        let others = self.paths().into_iter().filter(|(key, _)| *key != "axis");
        parts.extend(others.map(|(key, path)| (key, path.to_string())));
        for row in EDIT_KNOBS.iter().filter(|row| row.is_of(&self.operation)) {
            let name = row.knob.name;
            let is_witness = matches!(name, "near" | "from_near" | "branching");
            let (value, default) = ((row.read)(self), (row.read)(&plain));
            if let Some(value) = value.filter(|value| !is_witness && Some(value) != default.as_ref()) {
                parts.push((name, shown(value)));
            }
        }
        // What needs no name comes first.
        if let Some((_, value)) = parts.iter().find(|(key, _)| main == Some(*key)) {
            write!(f, " {value}")?;
        }
        for (key, value) in parts.iter().filter(|(key, _)| main != Some(*key)) {
            write!(f, " {key}={value}")?;
        }
        Ok(())
    }
}

impl FromStr for Edit {
    type Err = String;

    /// Reads the short form: an operation, an axis, and then values by their names; what an operation is mostly told
    /// needs no name: `cut stem/4 0.5`, `bend stem/4 30 at=0.5 towards=0,-1,0`, `copy stem stem/4 at=0.7`.
    fn from_str(text: &str) -> Result<Self, String> {
        let example = "like 'remove stem/12' or 'bend stem/4 30 at=0.5 towards=0,-1,0'";
        let mut words = text.split_whitespace();
        let operation =
            words.next().ok_or_else(|| format!("expected an operation and an axis, {example}"))?;
        let mut edit = Self::named(operation).ok_or_else(|| {
            let words = Operation::WORDS;
            let meant = did_you_mean(nearest(operation, words.iter().copied()));
            format!(
                "there is no operation '{}'{meant}; expected one of: {}",
                excerpt(operation),
                words.join(", ")
            )
        })?;
        let axis = words.next().ok_or_else(|| format!("'{operation}' needs an axis, {example}"))?;
        edit.axis = axis.parse()?;
        let main = OPERATIONS.iter().find(|row| row.word == operation).and_then(|row| row.main);
        for word in words {
            let (key, value) = match (word.split_once('='), main) {
                (Some((key, value)), _) => (key, value),
                (None, Some(main)) => (main, word),
                (None, None) => {
                    return Err(format!("'{operation}' has no value that '{}' could be", excerpt(word)));
                }
            };
            edit.parse_key(key, value)?;
        }
        edit.check()?;
        Ok(edit)
    }
}

impl Edit {
    fn parse_key(&mut self, key: &str, value: &str) -> Result<(), String> {
        if EDIT_PATHS.iter().any(|row| row.name == key && row.is_of(&self.operation)) {
            self.set_path(key, value.parse()?);
            return Ok(());
        }
        let Some(row) = EDIT_KNOBS.iter().find(|row| row.knob.is_called(key) && row.is_of(&self.operation))
        else {
            return Err(self.unknown(key));
        };
        let value =
            row.knob.kind.parse(value).map_err(|problem| format!("'{}': {problem}", row.knob.name))?;
        (row.write)(self, value);
        Ok(())
    }

    /// Why it has no such key, and what was meant.
    pub fn unknown(&self, key: &str) -> String {
        let (word, known) = (self.operation.word(), self.keys());
        let others = EDIT_KNOBS.iter().map(|row| (row.knob.name, row.operations));
        let others = others.chain(EDIT_PATHS.iter().map(|row| (row.name, row.operations)));
        let key = excerpt(key);
        if let Some((_, operations)) = others.into_iter().find(|(name, _)| *name == key) {
            return format!("'{word}' has no '{key}', which is for: {}", operations.join(", "));
        }
        match nearest(&key, known.iter().copied()) {
            meant @ Some(_) => format!("'{word}' has no '{key}'{}", did_you_mean(meant)),
            None => format!("'{word}' has no '{key}'; it may have: {}", known.join(", ")),
        }
    }
}
