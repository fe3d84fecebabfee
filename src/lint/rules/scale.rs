//! Scales of nodes.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const RULE: Rule = Rule {
    id: "scale",
    checks: "nodes that mirror, or scale differently along their axes; not where one mesh has many places",
    why: "mirrors turn faces inside out, and unequal scales bend normals and colliders",
    mend: "apply the transforms before exporting",
    severity: Severity::Warn,
    limits: &[limit("unequal", 1.01, "", "most that one axis' scale may be of another's")],
    needs: &[Aspect::Places],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let unequal = limits.of("unequal");
    for piece in asset.pieces().filter(|piece| piece.places.len() == 1) {
        for place in &piece.places {
            if place.matrix3.determinant() < 0.0 {
                found.at(&piece.node, "its transform mirrors");
            }
            let lengths =
                [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis].map(glam::Vec3A::length);
            let low = lengths.iter().copied().fold(f32::MAX, f32::min);
            let ratio = f64::from(lengths.iter().copied().fold(0.0, f32::max) / low);
            if !(ratio <= unequal) {
                let [x, y, z] = lengths;
                found.over(
                    Some(&piece.node),
                    format!("it is scaled by {x:.3}, {y:.3}, {z:.3}"),
                    ratio,
                    unequal,
                );
            }
        }
    }
}
