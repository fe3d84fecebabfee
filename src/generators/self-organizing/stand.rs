//! `[[self-organizing.tree]]`: the further trees of a stand.

use linden_base::document::{Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{Kind, Knob, Value};
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

/// The key as schemas have it.
pub(crate) const TREES: TableKey = TableKey {
    name: TREE,
    help: "further trees, which grow by the same rules and take each other's light",
    content: KeyContent::Tables(Tables {
        knobs: || vec![AT],
        required: &["at"],
        one_of: &[],
        files: &[],
        most: MOST_TREES - 1,
    }),
};

/// Reads where further trees stand: x and z, metres.
pub(crate) fn read(node: &Node) -> Result<Vec<[f64; 2]>, Fault> {
    LIST.read(node, read_one)
}

fn read_one(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<[f64; 2], Fault> {
    if let Some(entry) = entries.iter().find(|entry| entry.key != AT.name) {
        return Err(LIST.unknown(number, entry, &[AT.name]));
    }
    let Some(entry) = entries.first() else {
        let message = format!("further tree {number} has no 'at': say where it stands, like at = [3, 0, -1]");
        return Err(Fault::new(place, message));
    };
    match entry.node.value(AT.name, &AT.kind)? {
        Value::Vector([x, 0.0, z]) => Ok([x, z]),
        value => {
            let message =
                format!("further tree {number} is at {value}, but trees stand on the ground: y must be 0");
            Err(Fault::new(entry.node.place, message))
        }
    }
}

/// As documents have it.
pub(crate) fn written([x, z]: [f64; 2]) -> Vec<(&'static str, Value)> {
    vec![(AT.name, Value::Vector([x, 0.0, z]))]
}
