//! Triangles without area.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const RULE: Rule = Rule {
    id: "degenerate",
    checks: "triangles without area: two corners in one place, or three on a line",
    why: "they cost what others do, show nothing, and have no normal: lights and bakes get black spots",
    mend: "merge by distance and dissolve degenerate faces before exporting",
    severity: Severity::Warn,
    limits: &[limit(
        "sliver",
        0.000_001,
        "",
        "height of a triangle / its longest side, up to which it is a line",
    )],
    needs: &[Aspect::Geometry],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let sliver = limits.of("sliver");
    for (mesh, geometry) in asset.geometries() {
        let is_flat = |triangle: &&[u32; 3]| {
            let [a, b, c] = geometry.corners(**triangle).map(glam::Vec3::as_dvec3);
            let longest =
                (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            // Twice the area is the height times the side.
            !((b - a).cross(c - a).length() > sliver * longest)
        };
        let count = geometry.triangles.iter().filter(is_flat).count();
        if count > 0 {
            let all = geometry.triangles.len();
            found.over(
                Some(&mesh.name),
                format!("{count} of {all} triangles have no area"),
                count as f64,
                0.0,
            );
        }
        let broken = geometry.positions.iter().filter(|at| !at.is_finite()).count();
        if broken > 0 {
            found.over(Some(&mesh.name), format!("{broken} positions are no numbers"), broken as f64, 0.0);
        }
    }
}
