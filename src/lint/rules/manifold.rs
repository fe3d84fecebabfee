//! Edges: where more than two faces meet, and where one is alone.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::{distinct_triangles, edges, percent, welded};

pub(super) const NON_MANIFOLD: Rule = Rule {
    id: "non-manifold",
    checks: "edges of three or more faces in meshes that are no foliage; vertices in one place count as one",
    why: "no surface has them: reducing, baking, smoothing and physics go wrong there",
    mend: "separate what only touches, or join it properly; faces inside the wood can go",
    severity: Severity::Warn,
    limits: &[
        limit("max", 0.0, "edges", "most such edges of a mesh"),
        limit("foliage", 0.0, "", "1: look at foliage, too, where crossed cards share an edge by design"),
    ],
    needs: &[Aspect::Geometry, Aspect::Alpha],
    check: non_manifold,
};

pub(super) const OPEN_EDGES: Rule = Rule {
    id: "open-edges",
    checks: "edges of one face in meshes that are no foliage: tubes without an end, holes",
    why: "from some side one looks into them, and shadows leak; printing and physics need closed solids. Leaf cards are open \
          by design and not looked at",
    mend: "cap branches, fill holes",
    severity: Severity::Off,
    limits: &[limit("max", 0.0, "edges", "most such edges of a mesh")],
    needs: &[Aspect::Geometry, Aspect::Alpha],
    check: open_edges,
};

fn non_manifold(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let with_foliage = limits.of("foliage") != 0.0;
    for (mesh, geometry) in asset.geometries().filter(|(mesh, _)| with_foliage || !asset.is_foliage(mesh)) {
        let edges = edges(&distinct_triangles(geometry, &welded(geometry)));
        let count = edges.chunk_by(|a, b| a.ends == b.ends).filter(|faces| faces.len() > 2).count();
        if count as f64 > limits.of("max") {
            let message = format!("{count} edges have three faces or more");
            found.over(Some(&mesh.name), message, count as f64, limits.of("max"));
        }
    }
}

fn open_edges(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    for (mesh, geometry) in asset.drawn().filter(|(mesh, _)| !asset.is_foliage(mesh)) {
        let edges = edges(&distinct_triangles(geometry, &welded(geometry)));
        let shared = edges.chunk_by(|a, b| a.ends == b.ends);
        let (mut open, mut all) = (0, 0);
        for faces in shared {
            all += 1;
            open += usize::from(faces.len() == 1);
        }
        if open as f64 > limits.of("max") {
            let share = percent(open, all);
            let message = format!("{open} edges have one face ({share:.1} % of all)");
            found.over(Some(&mesh.name), message, open as f64, limits.of("max"));
        }
    }
}
