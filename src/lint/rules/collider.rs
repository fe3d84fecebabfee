//! Meshes for collisions.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::{distinct_triangles, edges, welded};

pub(super) const RULE: Rule = Rule {
    id: "collider",
    checks: "meshes for collisions, which names tell (UCX_, UBX_, UCP_, USP_, -col, _collider): few triangles, closed, and with \
             `required` that there is one",
    why: "physics looks at each triangle, each frame; what is open lets bodies through",
    mend: "a capsule or a convex hull of the trunk, without twigs and leaves",
    severity: Severity::Warn,
    limits: &[
        limit("triangles", 256.0, "triangles", "most triangles of all colliders"),
        limit("required", 0.0, "", "1: there must be one"),
    ],
    needs: &[Aspect::Colliders],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    if asset.colliders.is_empty() && limits.of("required") != 0.0 {
        found.add("there is no mesh for collisions");
    }
    let mut count = 0;
    for piece in &asset.colliders {
        let mesh = &asset.meshes[piece.mesh];
        count += mesh.triangles * piece.places.len();
        let Some(geometry) = &mesh.geometry else { continue };
        let edges = edges(&distinct_triangles(geometry, &welded(geometry)));
        let open = edges.chunk_by(|a, b| a.ends == b.ends).filter(|faces| faces.len() == 1).count();
        if open > 0 {
            let message = format!("a mesh for collisions is open at {open} edges");
            found.over(Some(&piece.node), message, open as f64, 0.0);
        }
    }
    let max = limits.of("triangles");
    if count as f64 > max {
        found.over(None, format!("{count} triangles for collisions, more than {max}"), count as f64, max);
    }
}
