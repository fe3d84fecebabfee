//! Crown shapes as knobs have them: their names, their dimensions, and meshes that are taken for one.

use linden_base::knob::{Kind, Knob, Value};

use crate::crown::{self, SHAPES};

/// The ids of all crown shapes.
pub(crate) const SHAPE_IDS: [&str; SHAPES.len()] = {
    let mut ids = [""; SHAPES.len()];
    let mut i = 0;
    while i < ids.len() {
        ids[i] = SHAPES[i].id;
        i += 1;
    }
    ids
};

/// The knob that names the crown's shape.
pub(crate) const CROWN: Knob =
    Knob::new("crown", Kind::Choice(&SHAPE_IDS), "", "shape that the attraction points fill")
        .details(
            "Points are drawn evenly in its volume, unless shell_density, top_density or clumps gather them. \
             Each shape has dimensions of its own; another shape keeps those that it shares with the one \
             before. In a document the key envelope names a closed mesh in its place, and parts add to it, cut \
             into it or stand beside it.",
        )
        .see_also(&["points", "crown_base", "shell_density"]);

/// The dimensions of a shape with their values.
pub(crate) fn dimensions_of(shape: &str, set: &[(&'static str, Value)]) -> Vec<(Knob, Value)> {
    let knobs = crown::shape(shape).into_iter().flat_map(|shape| shape.knobs);
    let value = |dimension: &crown::ShapeKnob| {
        let found = set.iter().find(|(name, _)| *name == dimension.knob.name);
        found.map_or_else(dimension.default, |(_, value)| value.clone())
    };
    knobs.map(|dimension| (dimension.knob, value(dimension))).collect()
}

/// Whether a word that stands for a crown's shape means a mesh.
pub(crate) fn means_mesh(word: &str) -> bool {
    let word = word.trim().to_ascii_lowercase();
    [".obj", ".ply"].iter().any(|ending| word.ends_with(ending))
        || ["mesh", "envelope", "file", "obj", "ply"].contains(&word.as_str())
}
