//! Where the origin is.

use glam::Vec3;

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};
use crate::mesh::bounds;

pub(super) const RULE: Rule = Rule {
    id: "pivot",
    checks: "the origin at the foot of the tree: what is lowest is at its height, and around it",
    why: "engines place, turn and scale trees about the origin: others float, sink or swing",
    mend: "move the origin to the middle of the trunk where it leaves the ground, and apply the transform",
    severity: Severity::Warn,
    limits: &[
        limit("aside", 5.0, "%", "most that the foot's middle may be beside the origin, of the height"),
        limit("above", 1.0, "%", "most that the lowest point may be above the origin, of the height"),
        limit("below", 10.0, "%", "most that it may be below, of the height: roots and the ground's slope"),
    ],
    needs: &[Aspect::Geometry, Aspect::Places],
    check,
};

/// The part of the height that is the foot.
const FOOT: f32 = 0.02;

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let Some([low, high]) = bounds(asset, asset.finest()) else { return };
    let height = high.y - low.y;
    if !(height > 0.0) {
        return;
    }
    let share = |length: f32| f64::from(length / height) * 100.0;
    let (above, below) = (share(low.y), share(-low.y));
    if above > limits.of("above") {
        let message =
            format!("the lowest point is {:.3} m above the origin ({above:.1} % of the height)", low.y);
        found.over(None, message, above, limits.of("above"));
    }
    if below > limits.of("below") {
        let message =
            format!("the lowest point is {:.3} m below the origin ({below:.1} % of the height)", -low.y);
        found.over(None, message, below, limits.of("below"));
    }
    let Some([low, high]) = foot(asset, low.y + FOOT * height) else { return };
    let middle = (low + high) / 2.0;
    let aside = share(Vec3::new(middle.x, 0.0, middle.z).length());
    if aside > limits.of("aside") {
        let message = format!(
            "the foot is {:.3} m beside the origin, at x {:.3} and z {:.3} ({aside:.1} % of the height)",
            middle.x.hypot(middle.z),
            middle.x,
            middle.z
        );
        found.over(None, message, aside, limits.of("aside"));
    }
}

/// The corners of what is below a height.
fn foot(asset: &Asset, top: f32) -> Option<[Vec3; 2]> {
    let mut foot: Option<[Vec3; 2]> = None;
    for piece in asset.finest() {
        let Some(geometry) = &asset.meshes[piece.mesh].geometry else { continue };
        let placed = piece
            .places
            .iter()
            .flat_map(|place| geometry.positions.iter().map(|&at| place.transform_point3(at)));
        for at in placed.filter(|at| at.y <= top) {
            let [low, high] = foot.unwrap_or([at, at]);
            foot = Some([low.min(at), high.max(at)]);
        }
    }
    foot
}
