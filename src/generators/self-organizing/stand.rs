//! `[[self-organizing.tree]]`: the further trees of a stand.

use linden_base::document::{Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{Kind, Knob, Value, integer};
use linden_skeleton::generator::{KeyContent, TableKey, Tables};

/// The most trees of a stand, the first included.
pub const MOST_TREES: usize = 10_000;

/// The key of the list in `[self-organizing]`.
pub(crate) const TREE: &str = "tree";

const LIST: List = List {
    key: TREE,
    heading: "[[self-organizing.tree]]",
    one: "further tree",
    most: (MOST_TREES - 1, "a stand"),
};

/// Where a tree stands.
const AT: Knob = Knob::new(
    "at",
    Kind::Vector { auto: false },
    "m",
    "where the tree stands, from the first tree's foot; y is 0: all stand on the ground",
);

/// When it goes.
const FELLED: Knob = Knob::new(
    "felled",
    integer(0, 1000),
    "years",
    "the year in which the tree is felled, and its light is the others'; 0: never",
);

/// A further tree of a stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Neighbour {
    /// Where it stands, x and z from the first tree in metres.
    pub at: [f64; 2],
    /// The year in which it is felled; 0: never.
    pub felled_in: u32,
}

impl Neighbour {
    /// One that stands for good.
    pub const fn at(at: [f64; 2]) -> Self {
        Self { at, felled_in: 0 }
    }

    /// Whether it still stands behind so many years.
    pub const fn stands_after(&self, years: u32) -> bool {
        self.felled_in == 0 || self.felled_in > years
    }

    /// As documents have it.
    pub(crate) fn written(&self) -> Vec<(&'static str, Value)> {
        let [x, z] = self.at;
        let felled = (FELLED.name, Value::Integer(self.felled_in.into()));
        [(AT.name, Value::Vector([x, 0.0, z]))]
            .into_iter()
            .chain((self.felled_in > 0).then_some(felled))
            .collect()
    }

    /// In a list of trees.
    pub(crate) fn describe(&self) -> String {
        let [x, z] = self.at;
        match self.felled_in {
            0 => format!("at {x}, {z}"),
            year => format!("at {x}, {z}, felled in year {year}"),
        }
    }
}

/// The key as schemas have it.
pub(crate) const TREES: TableKey = TableKey {
    name: TREE,
    help: "further trees, which grow by the same rules and take each other's light",
    content: KeyContent::Tables(Tables {
        knobs: || vec![AT, FELLED],
        required: &["at"],
        one_of: &[],
        files: &[],
        most: MOST_TREES - 1,
    }),
};

/// Reads the further trees.
pub(crate) fn read(node: &Node) -> Result<Vec<Neighbour>, Fault> {
    LIST.read(node, read_one)
}

fn read_one(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<Neighbour, Fault> {
    let known = [AT.name, FELLED.name];
    if let Some(entry) = entries.iter().find(|entry| !known.contains(&entry.key.as_str())) {
        return Err(LIST.unknown(number, entry, &known));
    }
    let find = |knob: &Knob| entries.iter().find(|entry| entry.key == knob.name);
    let Some(entry) = find(&AT) else {
        let message = format!("further tree {number} has no 'at': say where it stands, like at = [3, 0, -1]");
        return Err(Fault::new(place, message));
    };
    let at = match entry.node.value(AT.name, &AT.kind)? {
        Value::Vector([x, 0.0, z]) => [x, z],
        value => {
            let message =
                format!("further tree {number} is at {value}, but trees stand on the ground: y must be 0");
            return Err(Fault::new(entry.node.place, message));
        }
    };
    let felled = find(&FELLED).map(|entry| entry.node.value(FELLED.name, &FELLED.kind)).transpose()?;
    let felled_in = match felled {
        Some(Value::Integer(year)) => year as u32,
        _ => 0,
    };
    Ok(Neighbour { at, felled_in })
}
