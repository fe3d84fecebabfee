//! Triangles in the same place.

use super::{Limits, Rule};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::{distinct_triangles, welded};

pub(super) const RULE: Rule = Rule {
    id: "duplicates",
    checks: "triangles twice with the same corners, facing the same or the other way",
    why: "both are drawn into the same place and flicker, or double what leaves cost",
    mend: "remove doubles; for two sides make the material double-sided",
    severity: Severity::Warn,
    limits: &[],
    needs: &[Aspect::Geometry],
    check,
};

fn check(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    for (mesh, geometry) in asset.drawn() {
        let welded = welded(geometry);
        let is_whole = |triangle: &&[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            a != b && b != c && a != c
        };
        let whole = geometry.triangles.iter().filter(is_whole).count();
        let doubles = whole - distinct_triangles(geometry, &welded).len();
        if doubles > 0 {
            let all = geometry.triangles.len();
            let message = format!("{doubles} of {all} triangles lie where another one does");
            found.over(Some(&mesh.name), message, doubles as f64, 0.0);
        }
    }
}
