//! The distance from the wood's surface, from all axes at once.

use glam::Vec3;

use crate::surface::features::Flare;
use crate::surface::path::Ring;

/// A round cone between two rings of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub from: Ring,
    pub to: Vec3,
    pub to_radius_m: f32,
    pub length_m: f32,
    /// Which tube it is of: an axis, or a root.
    pub tube: u32,
    /// Whether it ends flat below, or above.
    pub is_flat: [bool; 2],
    pub flare: Option<Flare>,
    /// A place and the direction upward of the ground that a stem stands on, where the piece would bulge into it.
    pub floor: Option<[Vec3; 2]>,
}

/// How near a piece is to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Signed, metres.
    pub distance_m: f32,
    /// Away from the axis; not a unit vector on it.
    pub out: Vec3,
    /// Of the wood there, metres.
    pub radius_m: f32,
    /// Metres from the axis' base.
    pub along_m: f32,
}

impl Piece {
    pub fn near(&self, point: Vec3) -> Near {
        let course = self.to - self.from.center;
        let squared = course.length_squared();
        let from = point - self.from.center;
        let t = if squared > 0.0 { from.dot(course) / squared } else { 0.0 };
        let within = t.clamp(0.0, 1.0);
        let away = from - course * within;
        let length = away.length();
        let out = if length > 0.0 { away / length } else { Vec3::ZERO };
        let along_m = self.from.along + self.length_m * within;
        let mut radius_m = self.from.radius + (self.to_radius_m - self.from.radius) * within;
        if let Some(flare) = &self.flare {
            let across = self.from.tangent.cross(self.from.side);
            radius_m *= flare.ridge(along_m, (away.dot(self.from.side), away.dot(across))).0;
        }
        let mut near = Near { distance_m: length - radius_m, out, radius_m, along_m };
        for (is_flat, beyond, way) in [(self.is_flat[0], -t, -1.0), (self.is_flat[1], t - 1.0, 1.0)] {
            let beyond_m = beyond * self.length_m;
            if is_flat && beyond_m > near.distance_m {
                near = Near { distance_m: beyond_m, out: course.normalize_or_zero() * way, ..near };
            }
        }
        if let Some([foot, up]) = self.floor {
            let below_m = (foot - point).dot(up);
            if below_m > near.distance_m {
                near = Near { distance_m: below_m, out: -up, ..near };
            }
        }
        near
    }

    /// Distance up to which it has a say, metres: beyond it no fillet reaches.
    pub fn reach_m(&self, collar: f32, cell_m: f32) -> f32 {
        2.0 * collar * self.from.radius.max(self.to_radius_m) + 3.0 * cell_m
    }

    /// A sphere around it and its reach.
    pub fn sphere(&self) -> (Vec3, f32) {
        let ridges = self.flare.map_or(1.0, |_| 1.5);
        let radius = self.from.radius.max(self.to_radius_m) * ridges;
        (self.from.center.midpoint(self.to), 0.5 * self.from.center.distance(self.to) + radius)
    }
}

/// The nearest pieces of two axes to a point, and the field that both make there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Nearest {
    first: Option<(u32, Near)>,
    second: Option<(u32, Near)>,
}

impl Nearest {
    /// Counts a piece in, `index` of `pieces`. The order of pieces decides among equals.
    pub fn meet(&mut self, pieces: &[Piece], index: u32, near: Near) {
        let tube = |found: &Option<(u32, Near)>| found.map(|(index, _)| pieces[index as usize].tube);
        let is_nearer =
            |found: &Option<(u32, Near)>| found.is_none_or(|(_, other)| near.distance_m < other.distance_m);
        let piece_tube = Some(pieces[index as usize].tube);
        if tube(&self.first) == piece_tube {
            if is_nearer(&self.first) {
                self.first = Some((index, near));
            }
        } else if is_nearer(&self.first) {
            self.second = self.first;
            self.first = Some((index, near));
        } else if is_nearer(&self.second) {
            self.second = Some((index, near));
        }
    }

    /// The nearest piece.
    pub fn piece(&self) -> Option<(u32, Near)> {
        self.first
    }

    /// Signed distance from the surface, metres, and its gradient, about; far outside where nothing is
    /// near. Two axes meet in a fillet as wide as collars are, on one circle (Mercury, *`hg_sdf`*:
    /// `fOpUnionRound`); where both look the same way there is none.
    pub fn field(&self, collar: f32) -> (f32, Vec3) {
        let Some((_, a)) = self.first else { return (f32::INFINITY, Vec3::ZERO) };
        let Some((_, b)) = self.second.filter(|_| collar > 0.0) else { return (a.distance_m, a.out) };
        let (thin, thick) = (a.radius_m.min(b.radius_m), a.radius_m.max(b.radius_m));
        let alike = a.out.dot(b.out).clamp(0.0, 1.0);
        let fillet = collar * thick.min(2.0 * thin) * (1.0 - alike * alike).sqrt();
        let (x, y) = ((fillet - a.distance_m).max(0.0), (fillet - b.distance_m).max(0.0));
        if x <= 0.0 || y <= 0.0 {
            return (a.distance_m, a.out);
        }
        let deep = (x * x + y * y).sqrt();
        let distance = fillet.max(a.distance_m) - deep;
        // Where the union of both is deeper than the fillet, it is the union.
        (distance.min(a.distance_m), ((a.out * x + b.out * y) / deep).normalize_or(a.out))
    }
}
