//! `[[colonization.part]]`: what stands beside, in or around the crown.
//!
//! Parts are no flat knobs, but they are read, checked and written by a table of the same kind: a new
//! key is a field and a row of [`PART_KNOBS`].

use linden_base::document::{Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{Field, FieldValue, Kind, Knob, Value, excerpt, real, real_or_auto};
use linden_base::{field, words};
use linden_growth::Meet;

use crate::crown::solid::SHAPE_IDS;
pub use crate::crown::solid::Solid;

words! {
    /// What a part of a crown does.
    Role {
        /// Its inside belongs to the crown of the tree above it in the document.
        Add = "add",
        /// Its inside does not.
        Subtract = "subtract",
        /// Another tree with a root of its own, which competes for the same points.
        Tree = "tree",
        /// A solid without points, which branches do not enter.
        Obstacle = "obstacle",
        /// A place where fewer points are.
        Shade = "shade"
    }
}

/// A part of a crown, or a solid near it. Places are metres from the tree's foot, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct CrownPart {
    /// Its role.
    pub role: Role,
    /// Its solid.
    pub solid: Solid,
    /// Where the centre of its base stands; `None`: a tree's crown on its trunk, a mesh where its
    /// file has it, anything else at the tree's foot.
    pub at: Option<[f64; 3]>,
    /// Turn about the upright through its base centre, degrees.
    pub turn_deg: f64,
    /// Its size ÷ that of its dimensions or its file.
    pub scale: f64,
    /// For a tree: where it stands; `None`: on the ground below its crown.
    pub root: Option<[f64; 3]>,
    /// For a tree: height of its bare trunk, metres; `None`: until the first point is in reach.
    pub trunk_m: Option<f64>,
    /// For an obstacle: what a branch does there.
    pub meet: Meet,
    /// For shade: how many of the points in it are taken away, of 1.
    pub share: f64,
}

/// More parts would make every question for a place slow.
pub const MOST_PARTS: usize = 256;

/// The key of the list of parts in `[colonization]`.
pub(crate) const PART: &str = "part";

const LIST: List =
    List { key: PART, heading: "[[colonization.part]]", one: "part", most: (MOST_PARTS, "a crown") };

/// A row of the table.
#[derive(Clone, Copy)]
pub struct PartKnob {
    /// Name, kind, unit, help, and the way to the part's field.
    pub field: Field<CrownPart>,
    /// The roles that have it; empty: all.
    pub roles: &'static [Role],
}

macro_rules! row {
    ($name:literal, $kind:expr, $unit:literal, $roles:expr, $help:literal, $field:ident) => {
        PartKnob { field: field!($name, $kind, $unit, $help, $field), roles: $roles }
    };
}

/// What a part is; the key `mesh` names a file instead.
pub const PART_CROWN: Knob = Knob::new(
    "crown",
    Kind::Choice(&SHAPE_IDS),
    "",
    "the part's shape, with the dimensions of a crown of that shape",
);

/// All keys of a part but what it is and its dimensions.
pub const PART_KNOBS: &[PartKnob] = &[
    row!(
        "role",
        Kind::Choice(Role::WORDS),
        "",
        &[],
        "what it does: add to or subtract from the crown of the tree above it, grow another tree, stand in the way, take points away",
        role
    ),
    row!(
        "at",
        Kind::Vector { auto: true },
        "m",
        &[],
        "where the centre of its base stands, from the first tree's foot; auto: a tree's crown on its trunk, a mesh where its file has it, else 0,0,0",
        at
    ),
    row!("turn", real(-360.0, 360.0), "deg", &[], "turn about the upright through its base centre", turn_deg),
    row!("scale", real(1e-3, 1e3), "", &[], "its size, as a multiple of its dimensions or its file", scale),
    row!(
        "root",
        Kind::Vector { auto: true },
        "m",
        &[Role::Tree],
        "where the tree stands, from the first tree's foot; auto: on the ground below its crown",
        root
    ),
    row!(
        "trunk",
        real_or_auto(0.0, 1e3),
        "m",
        &[Role::Tree],
        "height of the tree's bare trunk; auto: until the first point is in reach",
        trunk_m
    ),
    row!(
        "meet",
        Kind::Choice(Meet::WORDS),
        "",
        &[Role::Obstacle],
        "what a branch does that meets the obstacle: turn aside, or end",
        meet
    ),
    row!(
        "share",
        real(0.0, 1.0),
        "",
        &[Role::Shade],
        "how many of the points inside are taken away; 1: all of them",
        share
    ),
];

impl CrownPart {
    /// A part with everything else at its default.
    pub fn of(role: Role, solid: Solid) -> Self {
        Self {
            role,
            solid,
            at: None,
            turn_deg: 0.0,
            scale: 1.0,
            root: None,
            trunk_m: None,
            meet: Meet::Around,
            share: 1.0,
        }
    }

    /// The mesh that is needed beside the preset.
    pub fn file(&self) -> Option<&str> {
        self.solid.file()
    }

    /// Role and solid, as messages have them: `subtract sphere`, `obstacle 'rock.obj'`.
    pub fn describe(&self) -> String {
        format!("{} {}", self.role.to_value(), self.solid.describe())
    }

    /// The dimensions and keys that this part has, with their values, in the order of a document.
    pub fn knobs(&self) -> Vec<(Knob, Value)> {
        let mut all = Vec::new();
        for row in PART_KNOBS {
            if row.fits(self.role) {
                all.push((row.field.knob, (row.field.read)(self)));
            }
            if row.field.knob.name == "role"
                && let Solid::Shape { shape, .. } = &self.solid
            {
                all.push((PART_CROWN, Value::Word(shape.clone())));
                all.extend(self.solid.dimensions());
            }
        }
        all
    }
}

impl CrownPart {
    /// As documents have it.
    pub(crate) fn written(&self) -> Vec<(&'static str, Value)> {
        let values = self.knobs().into_iter().map(|(knob, value)| (knob.name, value));
        values.chain(self.file().map(|file| ("mesh", Value::Word(file.to_owned())))).collect()
    }
}

impl PartKnob {
    fn fits(&self, role: Role) -> bool {
        self.roles.is_empty() || self.roles.contains(&role)
    }
}

/// For a mesh that was taken for a shape of a part.
const MESH_INSTEAD: &str = "; a part that is a mesh names it in place of a shape: mesh = \"rock.obj\"";

/// Reads the list of parts.
pub(crate) fn read(node: &Node) -> Result<Vec<CrownPart>, Fault> {
    LIST.read(node, read_one)
}

fn read_one(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<CrownPart, Fault> {
    let find = |key: &str| entries.iter().find(|entry| entry.key == key);
    let role = find("role").ok_or_else(|| {
        let words = Role::WORDS.join(", ");
        Fault::new(place, format!("part {number} has no 'role'; give it one of: {words}"))
    })?;
    let role = role.node.value("role", &Kind::Choice(Role::WORDS))?;
    let role = Role::from_value(role).unwrap_or(Role::Add);
    let solid = Solid::read(entries, place, ("part", number), MESH_INSTEAD)?;
    let is_shape = solid.file().is_none();
    let mut part = CrownPart::of(role, solid);
    for entry in entries.iter().filter(|entry| !["crown", "mesh"].contains(&entry.key.as_str())) {
        turn(&mut part, number, entry)?;
    }
    part.solid = part.solid.complete();
    if part.role == Role::Tree && part.root.is_none() && part.at.is_none() && is_shape {
        let message = format!("part {number} is a tree without a place: give it a 'root' like [6, 0, 0]");
        return Err(Fault::new(place, message));
    }
    Ok(part)
}

/// Sets the key or dimension that an entry names.
fn turn(part: &mut CrownPart, number: usize, entry: &Entry) -> Result<(), Fault> {
    if part.solid.set(entry)? {
        return Ok(());
    }
    let Some(row) = PART_KNOBS.iter().find(|row| row.field.knob.name == entry.key) else {
        let fitting = PART_KNOBS.iter().filter(|row| row.fits(part.role)).map(|row| row.field.knob.name);
        let known = ["crown", "mesh"].into_iter().chain(fitting);
        let dimensions = part.solid.dimensions();
        let known: Vec<&str> = known.chain(dimensions.iter().map(|(knob, _)| knob.name)).collect();
        return Err(LIST.unknown(number, entry, &known));
    };
    let key = excerpt(&entry.key);
    if !row.fits(part.role) {
        let roles: Vec<String> = row.roles.iter().map(|role| role.to_value().to_string()).collect();
        let role = part.role.to_value();
        let message = format!(
            "'{key}' means nothing in part {number} of role {role}; it belongs to: {}",
            roles.join(", ")
        );
        return Err(Fault::new(entry.place, message));
    }
    (row.field.write)(part, entry.node.value(&entry.key, &row.field.knob.kind)?);
    Ok(())
}
