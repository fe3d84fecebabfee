//! Levels of detail among themselves.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::bounds;

pub(super) const RULE: Rule = Rule {
    id: "lod-chain",
    checks: "levels of detail: none missing, each with clearly fewer triangles, all of the same size",
    why: "a level that saves nothing costs memory; one of another size jumps when it is changed to",
    mend: "reduce further or leave the level out; number levels from 0; keep the outline",
    severity: Severity::Warn,
    limits: &[
        limit("ratio", 0.8, "", "most triangles of a level / triangles of the one before"),
        limit("pop", 10.0, "%", "most that a side of the bounding box may change from level to level"),
    ],
    needs: &[Aspect::Levels, Aspect::Geometry],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let (ratio, pop) = (limits.of("ratio"), limits.of("pop"));
    let numbers: Vec<u32> = asset.levels.iter().map(|level| level.number).collect();
    let last = numbers.last().copied().unwrap_or(0);
    // A file that says it has a level of four thousand millions misses as many.
    let missing: Vec<String> = (0..last)
        .filter(|number| !numbers.contains(number))
        .take(9)
        .map(|number| number.to_string())
        .collect();
    if !missing.is_empty() {
        found.add(format!("level {} is missing: the last is {last}", missing.join(", ")));
    }
    for pair in asset.levels.windows(2) {
        let [before, level] = pair else { continue };
        let place = format!("level {}", level.number);
        let counts = [before, level].map(|level| asset.triangles_of(level) as f64);
        if counts[1] > ratio * counts[0] {
            let (a, b) = (counts[0], counts[1]);
            let share = if a > 0.0 { b / a } else { f64::MAX };
            let message = format!("{b} triangles after {a}: {share:.2} of them, more than {ratio}");
            found.over(Some(&place), message, share, ratio);
        }
        let boxes = [before, level].map(|level| bounds(asset, &level.pieces));
        let [Some([low, high]), Some([other_low, other_high])] = boxes else { continue };
        let (size, other) = (high - low, other_high - other_low);
        // Against the longest side: a trunk's width is nothing at a distance.
        let change = f64::from(((other - size).abs() / size.max_element().max(1e-6)).max_element()) * 100.0;
        if change > pop {
            let message = format!(
                "its bounding box is {:.2} x {:.2} x {:.2} m after {:.2} x {:.2} x {:.2}: {change:.1} % of the longest side, more than {pop}",
                other.x, other.y, other.z, size.x, size.y, size.z
            );
            found.over(Some(&place), message, change, pop);
        }
    }
}
