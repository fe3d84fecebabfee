//! Whether units are right.

use super::{Rule, limit};
use crate::asset::Aspect;
use crate::finding::Severity;
use crate::mesh::bounds;

pub(super) const RULE: Rule = Rule {
    id: "height",
    checks: "the height of the tree in metres, Y up",
    why: "trees of 2000 m were centimetres; flat ones lie on their side",
    mend: "export in metres with Y up, or set the limits for grass and sequoias",
    severity: Severity::Warn,
    limits: &[
        limit("min", 0.05, "m", "lowest tree"),
        limit("max", 130.0, "m", "highest tree; the highest that is known has 116 m"),
    ],
    needs: &[Aspect::Geometry, Aspect::Places],
    check: |asset, limits, found| {
        let Some([low, high]) = bounds(asset, asset.finest()) else { return };
        let (height, min, max) = (f64::from(high.y - low.y), limits.of("min"), limits.of("max"));
        if height < min {
            found.over(None, format!("{height:.4} m high, less than {min}"), height, min);
        } else if height > max {
            found.over(None, format!("{height:.1} m high, more than {max}"), height, max);
        }
    },
};
