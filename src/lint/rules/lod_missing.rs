//! Trees without levels of detail.

use super::{Rule, limit};
use crate::asset::Aspect;
use crate::finding::Severity;

pub(super) const RULE: Rule = Rule {
    id: "lod-missing",
    checks: "large trees without levels of detail",
    why: "at a distance most triangles are smaller than a pixel, and cost as much as near",
    mend: "write levels; or turn this off where the engine makes them (Godot, Nanite)",
    severity: Severity::Info,
    limits: &[limit("triangles", 5000.0, "triangles", "most triangles of a tree of one level")],
    needs: &[Aspect::Levels],
    check: |asset, limits, found| {
        let [only] = asset.levels.as_slice() else { return };
        let (count, max) = (asset.triangles_of(only) as f64, limits.of("triangles"));
        if count > max {
            found.over(None, format!("{count} triangles in one level of detail"), count, max);
        }
    },
};
