//! The wood that a root leaves, and the fillet between both.

use glam::Vec3;

use crate::surface::features::Flare;
use crate::surface::path::Ring;
use linden_base::memory::bytes_of;

/// Some rings of a stem at its foot, or of a root.
#[derive(Clone, Debug)]
pub(in crate::surface) struct Host {
    pub rings: Vec<Ring>,
    pub flare: Option<Flare>,
}

/// How deep under the host's bark a root's fillet is covered, in radii of the fillet.
const COVERED: f32 = 0.3;

/// A corner of a root as if there was nothing else.
pub(in crate::surface) struct Bare {
    pub center: Vec3,
    /// Unit vector across the root.
    pub out: Vec3,
    pub width_m: f32,
    pub normal: Vec3,
}

impl Host {
    /// Where a corner goes in a fillet of a radius, and its normal.
    ///
    /// It stays on its ray. The fillet is the round union of two distances (Mercury, *`hg_sdf`*: `fOpUnionRound`),
    /// narrower the more alike both surfaces look; on the host's side of it the root goes on below the bark.
    pub fn lay(&self, bare: &Bare, fillet_m: f32, sunk_m: f32) -> (Vec3, Vec3) {
        /// Each halves what is left to find.
        const ROUNDS: u32 = 10;
        let Bare { center, out, width_m, normal } = *bare;
        let surface = center + out * width_m;
        let (_, hosts) = self.near(surface);
        // Where it comes out at a tangent there is no corner to fill.
        let alike = hosts.dot(normal).clamp(0.0, 1.0);
        let fillet = fillet_m * (1.0 - alike * alike).sqrt();
        if fillet < 1e-3 * width_m {
            return (surface, normal);
        }
        let field = |wide: f32| {
            let (host_m, _) = self.near(surface + out * wide);
            let (x, y) = ((fillet - host_m).max(0.0), (fillet - wide).max(0.0));
            fillet.max(host_m.min(wide)) - (x * x + y * y).sqrt()
        };
        let (mut least, mut most) = (0.0_f32, fillet);
        for _ in 0..ROUNDS {
            let wide = f32::midpoint(least, most);
            if field(wide) < 0.0 {
                least = wide;
            } else {
                most = wide;
            }
        }
        let wide = f32::midpoint(least, most);
        let place = surface + out * wide;
        let (host_m, hosts) = self.near(place);
        let (x, y) = ((fillet - host_m).max(0.0), (fillet - wide).max(0.0));
        let share = (x / fillet).min(1.0);
        // Where it is covered it looks as if there was no host.
        let covered = (-host_m / (COVERED * fillet)).clamp(0.0, 1.0);
        let turned = (normal * y + hosts * x).normalize_or(normal).lerp(normal, covered).normalize_or(normal);
        (place - hosts * (sunk_m * share * share * share), turned)
    }

    pub fn bytes(&self) -> u64 {
        bytes_of::<Self>(1) + bytes_of::<Ring>(self.rings.capacity())
    }

    /// Signed distance from the surface, metres, about, and the surface's normal.
    pub fn near(&self, point: Vec3) -> (f32, Vec3) {
        let mut nearest = (f32::INFINITY, Vec3::Y);
        for (i, pair) in self.rings.windows(2).enumerate() {
            let (from, to) = (&pair[0], &pair[1]);
            let course = to.center - from.center;
            let length = course.length();
            if !(length > 0.0) {
                continue;
            }
            let along = course / length;
            let off = point - from.center;
            let t = (off.dot(along) / length).clamp(0.0, 1.0);
            // Below the foot wood goes straight on.
            let away = if i == 0 && off.dot(along) < 0.0 {
                off.reject_from_normalized(along)
            } else {
                off - course * t
            };
            let width = away.length();
            let out = away.normalize_or(from.side);
            let mut radius = from.onward + (to.radius - from.onward) * t;
            let slope = (from.onward - to.radius) / length;
            let mut normal = out + along * slope;
            if let Some(flare) = &self.flare {
                let across = from.tangent.cross(from.side);
                let corner = (out.dot(from.side), out.dot(across));
                let (factor, by_angle) = flare.ridge(from.along + length * t, corner);
                radius *= factor;
                normal -= from.tangent.cross(out) * (by_angle / factor);
            }
            // Across the slopes of flare and ridges the surface is nearer than straight out.
            let distance = (width - radius) / normal.length().max(1.0);
            if distance < nearest.0 {
                nearest = (distance, normal.normalize_or(out));
            }
        }
        nearest
    }

    /// How far the surface of a stem is from its axis at a height over its foot, in a direction, metres.
    pub fn reach_m(&self, height_m: f32, direction: Vec3) -> f32 {
        let Some(first) = self.rings.first() else { return 0.0 };
        self.reach_along_m(first.center + Vec3::Y * height_m, direction)
    }

    /// How far the surface is from a place within, in a direction, metres.
    pub fn reach_along_m(&self, at: Vec3, direction: Vec3) -> f32 {
        let widest_m = self.rings.iter().map(|ring| ring.onward).fold(0.0, f32::max);
        let (mut least, mut most) = (0.0, 20.0 * widest_m);
        for _ in 0..24 {
            let middle = f32::midpoint(least, most);
            if self.near(at + direction * middle).0 < 0.0 { least = middle } else { most = middle }
        }
        f32::midpoint(least, most)
    }
}
