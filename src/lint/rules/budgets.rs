//! Counts against budgets.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const TRIANGLES: Rule = Rule {
    id: "triangles",
    checks: "triangles of the finest level against a budget",
    why: "triangles are what a tree costs first, and a forest has hundreds of it",
    mend: "fewer sides and twigs; leaves as cards; levels of detail for the distance",
    severity: Severity::Warn,
    limits: &[limit("max", 60_000.0, "triangles", "most triangles of the finest level")],
    needs: &[],
    check: |asset, limits, found| {
        let Some(level) = asset.levels.first() else { return };
        over(found, asset.triangles_of(level), limits.of("max"), "triangles");
    },
};

pub(super) const DRAW_CALLS: Rule = Rule {
    id: "draw-calls",
    checks: "pieces of one mesh and one material that are drawn at once",
    why: "each is a call to the graphics card, whatever its size",
    mend: "join meshes of one material; one atlas for all leaves",
    severity: Severity::Warn,
    limits: &[limit("max", 8.0, "calls", "most draw calls of the finest level")],
    needs: &[],
    check: |asset, limits, found| over(found, asset.finest().len() as u64, limits.of("max"), "draw calls"),
};

pub(super) const MATERIALS: Rule = Rule {
    id: "materials",
    checks: "materials that are in use",
    why: "each is a change of state and a set of pictures in memory",
    mend: "share materials; one for bark, one for leaves, one for the billboard",
    severity: Severity::Warn,
    limits: &[limit("max", 6.0, "materials", "most materials of all levels, each name counted once")],
    needs: &[Aspect::Materials],
    check: |asset, limits, found| {
        let used: usize = asset.materials_by_name().values().sum();
        over(found, used as u64, limits.of("max"), "materials");
    },
};

pub(super) const MESH_VERTICES: Rule = Rule {
    id: "mesh-vertices",
    checks: "meshes of more vertices than indices of 16 bits reach",
    why: "32-bit indices are slower on phones, and some importers split such meshes",
    mend: "divide the mesh, or reduce it",
    severity: Severity::Off,
    limits: &[limit("max", 65_535.0, "vertices", "most vertices of a mesh")],
    needs: &[],
    check: mesh_vertices,
};

fn mesh_vertices(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let max = limits.of("max");
    for mesh in asset.meshes.iter().filter(|mesh| mesh.vertices as f64 > max) {
        let message = format!("{} vertices, more than {max}", mesh.vertices);
        found.over(Some(&mesh.name), message, mesh.vertices as f64, max);
    }
}

fn over(found: &mut Findings<'_>, count: u64, max: f64, what: &str) {
    if count as f64 > max {
        found.over(None, format!("{count} {what}, the budget is {max}"), count as f64, max);
    }
}
