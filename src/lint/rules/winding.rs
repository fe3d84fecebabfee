//! Which way faces look.

use super::{Limits, Rule};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::{distinct_triangles, edges, six_volumes, welded};

pub(super) const RULE: Rule = Rule {
    id: "winding",
    checks: "neighbours that look to opposite sides, and closed meshes that are inside out; foliage is left out",
    why: "one of the two is not drawn, or is lit from the wrong side",
    mend: "recalculate the faces' orientation to the outside",
    severity: Severity::Error,
    limits: &[],
    needs: &[Aspect::Geometry, Aspect::Alpha],
    check,
};

fn check(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    for (mesh, geometry) in asset.drawn().filter(|(mesh, _)| !asset.is_foliage(mesh)) {
        let edges = edges(&distinct_triangles(geometry, &welded(geometry)));
        let (mut against, mut is_closed) = (0, !edges.is_empty());
        for faces in edges.chunk_by(|a, b| a.ends == b.ends) {
            match faces {
                [a, b] => against += usize::from(a.is_rising == b.is_rising),
                _ => is_closed = false,
            }
        }
        if against > 0 {
            let message = format!("at {against} edges neighbours look to opposite sides");
            found.over(Some(&mesh.name), message, against as f64, 0.0);
        } else if is_closed && six_volumes(geometry) < 0.0 {
            found.at(&mesh.name, "it is closed and inside out");
        }
    }
}
