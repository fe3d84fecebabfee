//! `[[self-organizing.obstacle]]`: solids that nothing grows into, and that take the light.

use glam::DVec3;
use linden_base::document::{Entry, Fault, List, Node, TextPlace};
use linden_base::field;
use linden_base::knob::{Field, FieldValue, Kind, Knob, Value, excerpt, real, values};
use linden_crown::solid::{CROWN_KEY, MESH_KEY, SHAPE_IDS, Solid, all_dimensions};
use linden_growth::Meet;
use linden_skeleton::generator::{KeyContent, TableKey, Tables};

/// More obstacles would make every question for a place slow.
pub const MOST_OBSTACLES: usize = 256;

/// The key of the list in `[self-organizing]`.
pub(crate) const OBSTACLE: &str = "obstacle";

/// The key of a box.
const BOX_KEY: &str = "box";

const LIST: List = List {
    key: OBSTACLE,
    heading: "[[self-organizing.obstacle]]",
    one: "obstacle",
    most: (MOST_OBSTACLES, "a tree"),
};

/// For a mesh that was taken for a shape.
const MESH_INSTEAD: &str = "; an obstacle that is a mesh names it in place of a shape: mesh = \"rock.obj\"";

/// The smallest edge of a box, metres.
const LEAST_EDGE_M: f64 = 0.001;

/// A solid beside a tree. Places are metres from the first tree's foot, Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Which solid.
    pub solid: ObstacleSolid,
    /// Where the centre of its base stands; `None`: a mesh where its file has it, anything else at the foot.
    pub at: Option<[f64; 3]>,
    /// Turn about the upright through its base centre, degrees.
    pub turn_deg: f64,
    /// Its size ÷ that of its dimensions or its file.
    pub scale: f64,
    /// What a shoot does there.
    pub meet: Meet,
}

/// The solid of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleSolid {
    /// A box by its edges along x, y and z, metres.
    Box([f64; 3]),
    /// A shape of crowns, or a mesh.
    Solid(Solid),
}

const BOX: Knob = Knob::new(
    BOX_KEY,
    Kind::Vector { auto: false },
    "m",
    "a box by its width, height and depth, like a wall: 0.3,3,8",
);

const SHAPE: Knob = Knob::new(
    CROWN_KEY,
    Kind::Choice(&SHAPE_IDS),
    "",
    "in place of box: a shape, with the dimensions of a crown of that shape",
);

/// What every obstacle has.
const FIELDS: &[Field<Obstacle>] = &[
    field!(
        "at",
        Kind::Vector { auto: true },
        "m",
        "where the centre of its base stands, from the first tree's foot; auto: a mesh where its file has it, else 0,0,0",
        at
    ),
    field!("turn", real(-360.0, 360.0), "deg", "turn about the upright through its base centre", turn_deg),
    field!("scale", real(1e-3, 1e3), "", "its size, as a multiple of its dimensions or its file", scale),
    field!(
        "meet",
        Kind::Choice(Meet::WORDS),
        "",
        "what a shoot does that meets the obstacle: turn aside, or end",
        meet
    ),
];

/// The key as schemas have it.
pub(crate) const OBSTACLES: TableKey = TableKey {
    name: OBSTACLE,
    help: "solids that nothing grows into, and that take the light",
    content: KeyContent::Tables(Tables {
        knobs: || {
            let fields = FIELDS.iter().map(|field| field.knob);
            [BOX, SHAPE].into_iter().chain(fields).chain(all_dimensions()).collect()
        },
        required: &[],
        one_of: &[BOX_KEY, CROWN_KEY, MESH_KEY],
        files: &[(MESH_KEY, "in place of box: a mesh, relative to the preset")],
        most: MOST_OBSTACLES,
    }),
};

impl Obstacle {
    /// A solid with everything else at its default.
    pub const fn of(solid: ObstacleSolid) -> Self {
        Self { solid, at: None, turn_deg: 0.0, scale: 1.0, meet: Meet::Around }
    }

    /// The mesh that is needed beside the preset.
    pub fn file(&self) -> Option<&str> {
        match &self.solid {
            ObstacleSolid::Box(_) => None,
            ObstacleSolid::Solid(solid) => solid.file(),
        }
    }

    pub(crate) fn file_mut(&mut self) -> Option<&mut String> {
        match &mut self.solid {
            ObstacleSolid::Box(_) => None,
            ObstacleSolid::Solid(solid) => solid.file_mut(),
        }
    }

    /// The solid, as messages have it: `box`, `sphere`, `'rock.obj'`.
    pub fn describe(&self) -> String {
        match &self.solid {
            ObstacleSolid::Box(_) => BOX_KEY.to_owned(),
            ObstacleSolid::Solid(solid) => solid.describe(),
        }
    }

    /// The same with every knob at its default.
    pub(crate) fn plain(&self) -> Self {
        Self::of(match &self.solid {
            ObstacleSolid::Box(size) => ObstacleSolid::Box(*size),
            ObstacleSolid::Solid(solid) => ObstacleSolid::Solid(solid.plain()),
        })
    }

    /// The dimensions and keys that it has, with their values, in the order of a document.
    pub(crate) fn knobs(&self) -> Vec<(Knob, Value)> {
        let mut all = match &self.solid {
            ObstacleSolid::Box(size) => vec![(BOX, Value::Vector(*size))],
            ObstacleSolid::Solid(Solid::Shape { shape, .. }) => vec![(SHAPE, Value::Word(shape.clone()))],
            ObstacleSolid::Solid(Solid::Mesh { .. }) => Vec::new(),
        };
        if let ObstacleSolid::Solid(solid) = &self.solid {
            all.extend(solid.dimensions());
        }
        all.extend(values(FIELDS, self));
        all
    }

    /// As documents have it.
    pub(crate) fn written(&self) -> Vec<(&'static str, Value)> {
        let file = self.file().map(|file| (MESH_KEY, Value::Word(file.to_owned())));
        file.into_iter().chain(self.knobs().into_iter().map(|(knob, value)| (knob.name, value))).collect()
    }

    /// The same beside another tree, x and z from the first one in metres.
    #[must_use]
    pub fn beside(&self, [dx, dz]: [f64; 2]) -> Self {
        let [x, y, z] = self.at.unwrap_or_default();
        Self { at: Some([x + dx, y, z + dz]), ..self.clone() }
    }
}

/// Reads the list.
pub(crate) fn read(node: &Node) -> Result<Vec<Obstacle>, Fault> {
    LIST.read(node, read_one)
}

fn read_one(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<Obstacle, Fault> {
    let find = |key: &str| entries.iter().find(|entry| entry.key == key);
    let solid = if let Some(entry) = find(BOX_KEY) {
        if let Some(second) = find(CROWN_KEY).or(find(MESH_KEY)) {
            let message = format!("obstacle {number} has both 'box' and '{}'; keep one", second.key);
            return Err(Fault::new(second.place, message));
        }
        ObstacleSolid::Box(box_edges(number, entry)?)
    } else if find(CROWN_KEY).is_none() && find(MESH_KEY).is_none() {
        let message = format!("obstacle {number} has neither 'box', 'crown' nor 'mesh': say what it is");
        return Err(Fault::new(place, message));
    } else {
        ObstacleSolid::Solid(Solid::read(entries, place, (OBSTACLE, number), MESH_INSTEAD)?)
    };
    let mut obstacle = Obstacle::of(solid);
    let is_named = |entry: &&Entry| ![BOX_KEY, CROWN_KEY, MESH_KEY].contains(&entry.key.as_str());
    for entry in entries.iter().filter(is_named) {
        if let ObstacleSolid::Solid(solid) = &mut obstacle.solid
            && solid.set(entry)?
        {
            continue;
        }
        let Some(field) = FIELDS.iter().find(|field| field.knob.name == entry.key) else {
            let knobs = obstacle.knobs();
            let known: Vec<&str> = [BOX_KEY, CROWN_KEY, MESH_KEY]
                .into_iter()
                .chain(knobs.iter().map(|(knob, _)| knob.name))
                .collect();
            return Err(LIST.unknown(number, entry, &known));
        };
        (field.write)(&mut obstacle, entry.node.value(&entry.key, &field.knob.kind)?);
    }
    if let ObstacleSolid::Solid(solid) = obstacle.solid {
        obstacle.solid = ObstacleSolid::Solid(solid.complete());
    }
    Ok(obstacle)
}

fn box_edges(number: usize, entry: &Entry) -> Result<[f64; 3], Fault> {
    let value = entry.node.value(BOX_KEY, &BOX.kind)?;
    let edges = <[f64; 3]>::from_value(value.clone()).unwrap_or_default();
    if !DVec3::from(edges).cmpge(DVec3::splat(LEAST_EDGE_M)).all() {
        let value = excerpt(&value.to_string());
        let message = format!(
            "the box of obstacle {number} is {value} m; its width, height and depth must be at least {LEAST_EDGE_M} m"
        );
        return Err(Fault::new(entry.node.place, message));
    }
    Ok(edges)
}
