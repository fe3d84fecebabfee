//! Roots on the ground round the foot of a stem, each a tube of its stem.
//!
//! A root leaves the trunk within it and below its bark, on a buttress where there is one, comes out at a small
//! angle, runs outward half in the soil and dives before it ends (`course`). What is not yet clear of the trunk is laid
//! against it in a fillet (`host`), so that no crease shows where the two meet. Roots are surface: no skeleton has
//! them, nothing that is measured of axes counts them, and wind does not move them.

mod course;
mod host;

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use super::features::{Features, Flare};
use super::path::Ring;
use super::tube;
use linden_base::memory::bytes_of;
use linden_base::random::Key;
use linden_skeleton::{NO_PARENT, Skeleton};

pub(super) use course::{Laid, MOST_RINGS, most_roots};
pub(super) use host::Host;

/// Roots on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceRoots {
    /// Round the thickest stem; a thinner one has fewer. 0: none.
    pub count: u32,
    /// How far they run from the middle of the foot until they are gone, in radii of the trunk there.
    pub reach: f32,
    /// How much of them the soil shows: at 0 they crop out here and there, at 1 they lie on it.
    pub rise: f32,
    /// Thinner ones are left out, radius in metres: levels of detail do that.
    pub smallest_m: f32,
}

impl Default for SurfaceRoots {
    fn default() -> Self {
        Self { count: 0, reach: 5.0, rise: 0.5, smallest_m: 0.0 }
    }
}

/// What makes a tube a root.
#[derive(Clone, Debug)]
pub(super) struct Root {
    /// The wood that it leaves: a stem, or another root.
    host: Arc<Host>,
    /// Radius of the fillet between both, metres.
    fillet_m: f32,
    /// Up to where along the root the host is near, metres.
    clear_m: f32,
    /// How far it lies under the host's bark where that covers it, metres.
    sunk_m: f32,
    /// How long it is, metres.
    length_m: f32,
    /// Height of the cross-section over its width, at the base and at the tip.
    upright: [f32; 2],
    /// Where the lumps of the cross-section are, radians.
    phases: [f32; 2],
    /// Radius at the base, metres.
    base_m: f32,
    /// Sides in the fillet.
    sides: u32,
}

impl Root {
    /// Something short on a host, in a fillet of a radius; from `clear_m` on it is clear of the host, it lies `sunk_m`
    /// under the host's bark and has a radius of `base_m`. `None` without rings.
    pub fn on(
        host: Arc<Host>,
        [fillet_m, clear_m, sunk_m, base_m]: [f32; 4],
        key: Key,
        rings: &[Ring],
    ) -> Option<Self> {
        let length_m = rings.last()?.along;
        let phases = ["lump", "second lump"].map(|name| key.named(name).between(0.0, f64::from(TAU)) as f32);
        let upright = [1.1, 1.0];
        Some(Self { host, fillet_m, clear_m, sunk_m, length_m, upright, phases, base_m, sides: STUB_SIDES })
    }

    /// Place and normal of a corner, where `out` leaves a ring of a radius; the radius shrinks by `slope`. `ease` is
    /// the share of the fillet that is laid.
    pub fn place(&self, ring: &Ring, out: Vec3, radius_m: f32, slope: f32, ease: f32) -> (Vec3, Vec3) {
        let (width_m, normal) = self.cross_section(ring, out, radius_m, slope);
        if ring.along >= self.clear_m {
            return (ring.center + out * width_m, normal);
        }
        self.host.lay(
            &host::Bare { center: ring.center, out, width_m, normal },
            self.fillet_m * ease,
            self.sunk_m,
        )
    }

    /// Sides that its fillet needs, where the thickest wood has `sides`.
    pub fn least_sides(&self, along_m: f32, sides: u32) -> u32 {
        if along_m < self.clear_m { sides.min(self.sides) } else { 0 }
    }

    /// Pictures round the girth where it has a radius.
    pub fn wraps(&self, radius_m: f32, tile_m: f32) -> f32 {
        let mut wraps = tube::wraps(0.8 * self.base_m, tile_m);
        let mut thinner_m = 0.36 * self.base_m;
        while radius_m < thinner_m {
            wraps *= 0.5;
            thinner_m *= 0.5;
        }
        wraps
    }

    pub fn bytes(&self) -> u64 {
        bytes_of::<Self>(1) + self.host.bytes() / Arc::strong_count(&self.host).max(1) as u64
    }

    /// How far the bare root reaches in a direction, metres, and its normal there.
    fn cross_section(&self, ring: &Ring, out: Vec3, radius_m: f32, slope: f32) -> (f32, Vec3) {
        let along = (ring.along / self.length_m).clamp(0.0, 1.0);
        let [base, tip] = self.upright;
        let tall = tip + (base - tip) * (1.0 - along) * (1.0 - along);
        let up = Vec3::Y.reject_from_normalized(ring.tangent).normalize_or(ring.side);
        let height = out.dot(up);
        let across = out - up * height;
        // An ellipse, with lumps.
        let ellipse = 1.0 / (height * height / (tall * tall) + across.length_squared()).sqrt();
        let angle = libm::atan2f(height, out.dot(up.cross(ring.tangent)));
        let turned = ring.along / self.base_m;
        let [first, second] = self.phases;
        let (sin2, cos2) = libm::sincosf(2.0 * angle + first + 0.7 * turned);
        let (sin3, cos3) = libm::sincosf(3.0 * angle + second - 0.9 * turned);
        let lump = 1.0 + 0.07 * sin2 + 0.05 * sin3;
        let lump_by_angle = 0.14 * cos2 + 0.15 * cos3;
        let around = ring.tangent.cross(out);
        let round = (up * (height / (tall * tall)) + across).normalize_or(out);
        let normal = (round - around * (lump_by_angle / lump) + ring.tangent * slope).normalize_or(out);
        (radius_m * ellipse * lump, normal)
    }
}

/// Sides of a root in its fillet, and of what is left of a limb.
const FILLET_SIDES: u32 = 24;
const STUB_SIDES: u32 = 14;

/// A stem that may have roots.
#[derive(Clone, Copy, Debug)]
struct Stem {
    axis: u32,
    foot: Vec3,
    radius_m: f32,
}

/// Which stems of a plant have roots.
#[derive(Clone, Debug, Default)]
pub(super) struct Stools {
    /// The thickest first.
    stems: Vec<Stem>,
}

/// No more stems than these have roots: what has more is a meadow.
const MOST_STEMS: usize = 64;
/// Stems of a smaller share of the thickest one's radius have none.
const THINNEST: f32 = 0.3;
/// Stems that lean more have none: the sine of the angle over the ground.
const FLATTEST: f32 = 0.4;

impl Stools {
    /// Finds the stems that stand apart: of several from one stool the thickest has the roots.
    pub fn new(skeleton: &Skeleton, roots: &SurfaceRoots) -> Self {
        if roots.count == 0 {
            return Self::default();
        }
        let stem = |(axis, root): (u32, &linden_skeleton::Axis)| {
            let nodes = skeleton.nodes_of(root);
            let [foot, next] = [nodes.first()?, nodes.get(1)?].map(|&node| skeleton.positions[node as usize]);
            let radius_m = skeleton.radii[*nodes.first()? as usize];
            let stands = (next - foot).normalize_or_zero().y >= FLATTEST && radius_m > 0.0;
            stands.then_some(Stem { axis, foot, radius_m })
        };
        let stems = (0..).zip(&skeleton.axes).filter(|(_, axis)| axis.parent == NO_PARENT);
        let mut stems: Vec<Stem> = stems.filter_map(stem).collect();
        stems.sort_by(|a, b| b.radius_m.total_cmp(&a.radius_m).then(a.axis.cmp(&b.axis)));
        stems.truncate(MOST_STEMS);
        let thickest_m = stems.first().map_or(0.0, |stem| stem.radius_m);
        let mut apart: Vec<Stem> = Vec::new();
        for stem in stems {
            let joins =
                |other: &Stem| flat(other.foot - stem.foot).length() < 1.2 * (other.radius_m + stem.radius_m);
            if stem.radius_m >= THINNEST * thickest_m && !apart.iter().any(joins) {
                apart.push(stem);
            }
        }
        Self { stems: apart }
    }

    /// How many stems have roots at most, whatever stands there.
    pub const fn most(stems: usize) -> usize {
        if stems < MOST_STEMS { stems } else { MOST_STEMS }
    }

    /// The roots of a stem over its rings, to be laid one after another: thinner ones than the settings want are not
    /// among them. `sides` are those of the thickest wood.
    pub fn roots_of(
        &self,
        skeleton: &Skeleton,
        axis: u32,
        rings: &[Ring],
        flare: Option<Flare>,
        (features, sides): (&Features, u32),
    ) -> Vec<Laid> {
        let roots = &features.roots;
        let Some(stem) = self.stems.iter().find(|stem| stem.axis == axis) else { return Vec::new() };
        if rings.len() < 2 {
            return Vec::new();
        }
        let thickest_m = self.stems.first().map_or(stem.radius_m, |stem| stem.radius_m);
        let count = (roots.count as f32 * (stem.radius_m / thickest_m).sqrt()).round().max(1.0) as u32;
        let is_free = |direction: Vec3, reach_m: f32| {
            self.stems.iter().filter(|other| other.axis != axis).all(|other| {
                let way = flat(other.foot - stem.foot);
                let ahead = way.dot(direction);
                ahead < 0.0
                    || ahead > reach_m + other.radius_m
                    || way.reject_from_normalized(direction).length() > 2.0 * other.radius_m
            })
        };
        let foot = course::Foot::new(rings, flare, [stem.radius_m, features.fall()], key(skeleton, axis));
        foot.roots(count, roots, sides, &is_free)
    }
}

/// The same in all levels of detail: the foot and the tip of an axis stay in each.
fn key(skeleton: &Skeleton, axis: u32) -> Key {
    stem_key(skeleton, axis).named("roots")
}

/// What differs from stem to stem, and is the same in all levels of detail of one.
pub(super) fn stem_key(skeleton: &Skeleton, axis: u32) -> Key {
    let nodes = skeleton.nodes_of(&skeleton.axes[axis as usize]);
    let ends = [nodes.first(), nodes.last()].into_iter().flatten().map(|&node| node as usize);
    let numbers = ends.flat_map(|node| {
        let [x, y, z] = skeleton.positions[node].to_array();
        [x, y, z, skeleton.radii[node]]
    });
    numbers.fold(Key::new(0), |key, number| key.child(number.to_bits().into()))
}

/// Without its height.
fn flat(way: Vec3) -> Vec3 {
    way.with_y(0.0)
}

/// A direction along the ground.
fn heading(angle: f32) -> Vec3 {
    let (sin, cos) = libm::sincosf(angle);
    Vec3::new(cos, 0.0, -sin)
}

/// From one angle to another, the short way, radians.
fn turn(from: f32, to: f32) -> f32 {
    let turn = to - from;
    turn - TAU * (turn / TAU).round()
}

#[cfg(test)]
mod tests;
