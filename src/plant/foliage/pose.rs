//! How a leaf stands at its place: where its foot is, where it points to and which way it looks.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Quat, Vec3};

use super::axis::Place;
use crate::settings::{Arrangement, LeafKind};
use linden_base::random::{GOLDEN_ANGLE, Key};

/// Where a leaf is, metres, and its unit vectors: along it, and square to that off its upper side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub foot: Vec3,
    pub heading: Vec3,
    pub up: Vec3,
}

/// Leaves at one node, and how far each is turned round the twig.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phyllotaxis {
    arrangement: Arrangement,
    /// Leaves a node.
    pub members: u32,
}

impl Phyllotaxis {
    pub fn of(kind: &LeafKind) -> Self {
        let members = match kind.arrangement {
            Arrangement::Alternate | Arrangement::Spiral => 1,
            Arrangement::Opposite | Arrangement::Decussate => 2,
            Arrangement::Whorled => kind.whorl.max(1),
        };
        Self { arrangement: kind.arrangement, members }
    }

    /// Whether the first leaves of an axis stand at its sides, to the left and the right of a slanting
    /// twig; those of other arrangements begin anywhere.
    pub fn is_flat(self) -> bool {
        matches!(self.arrangement, Arrangement::Alternate | Arrangement::Opposite | Arrangement::Decussate)
    }

    /// The azimuth of a leaf of a node, from the axis' side, radians.
    pub fn azimuth(self, node: u64, member: u32) -> f32 {
        // Exact however far along the axis: all but the spiral come round after two nodes.
        let odd = (node % 2) as f32;
        match self.arrangement {
            Arrangement::Alternate => PI * odd,
            Arrangement::Opposite => PI * member as f32,
            Arrangement::Decussate => FRAC_PI_2 * odd + PI * member as f32,
            Arrangement::Whorled => TAU * (member as f32 + odd / 2.0) / self.members as f32,
            Arrangement::Spiral => {
                let turns = node as f64 * (GOLDEN_ANGLE / std::f64::consts::TAU);
                TAU * (turns - libm::floor(turns)) as f32
            }
        }
    }
}

/// Unit vectors of a leaf before anything is bent.
struct Frame {
    /// From the twig's axis.
    out: Vec3,
    heading: Vec3,
    up: Vec3,
}

/// Places the `copy`-th of the leaves that spring from one place, at an azimuth in radians.
pub(super) fn pose(kind: &LeafKind, place: &Place, azimuth: f32, copy: u32, key: Key) -> Pose {
    let Frame { out, heading, up } = frame(kind, place, azimuth, copy);
    let jitter = (kind.jitter_deg as f32).to_radians();
    let draw = |n: u64| key.child(n).between(-1.0, 1.0) as f32 * jitter;
    let turn = Quat::from_scaled_axis(Vec3::new(draw(0), draw(1), draw(2)));
    let (heading, up) = (turn * heading, turn * up);
    let pull = kind.up as f32;
    let heading = heading.lerp(Vec3::Y * pull.signum(), pull.abs()).normalize_or(heading);
    let heading = droop(heading, (kind.droop_deg as f32).to_radians());
    let side_up = up.reject_from_normalized(heading).normalize_or(heading.any_orthonormal_vector());
    let sky = Vec3::Y.reject_from_normalized(heading);
    let level = kind.level as f32 * sky.length().min(0.2) / 0.2;
    let up = side_up.lerp(sky.normalize_or(side_up), level);
    let up = up.reject_from_normalized(heading).normalize_or(side_up);
    let off = place.radius_m + kind.offset_m as f32;
    Pose { foot: place.center + out * off, heading, up }
}

fn frame(kind: &LeafKind, place: &Place, azimuth: f32, copy: u32) -> Frame {
    let across = place.tangent.cross(place.side);
    let (sin, cos) = libm::sincosf(azimuth);
    let radial = place.side * cos + across * sin;
    let (sin, cos) = libm::sincosf((kind.angle_deg as f32).to_radians());
    if kind.count > 1 {
        // A rosette about the way out: what the angle is measured from.
        let out = if place.is_apex { place.tangent } else { radial };
        let (first, second) = (out.any_orthonormal_vector(), out.cross(out.any_orthonormal_vector()));
        let (s, c) = libm::sincosf(azimuth + TAU * copy as f32 / kind.count as f32);
        let spoke = first * c + second * s;
        return Frame { out, heading: out * cos + spoke * sin, up: out * sin - spoke * cos };
    }
    if place.is_apex {
        return Frame { out: place.tangent, heading: place.tangent, up: radial };
    }
    // The upper side looks to the apex of the axis, where the leaf stood in the bud.
    Frame { out: radial, heading: place.tangent * cos + radial * sin, up: place.tangent * sin - radial * cos }
}

/// Turns a direction down, never past it; up for less than 0.
fn droop(heading: Vec3, angle: f32) -> Vec3 {
    let down = Vec3::NEG_Y * angle.signum();
    let square = down.reject_from_normalized(heading);
    let Some(towards) = square.try_normalize() else { return heading };
    let most = libm::acosf(heading.dot(down).clamp(-1.0, 1.0));
    let (sin, cos) = libm::sincosf(angle.abs().min(most));
    (heading * cos + towards * sin).normalize_or(heading)
}
