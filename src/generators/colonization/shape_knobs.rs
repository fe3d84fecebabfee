//! The knob that names a crown's shape.

use linden_base::knob::{Kind, Knob};

use crate::crown::solid::SHAPE_IDS;

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
