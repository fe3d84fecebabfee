//! What is to be framed: a solid of revolution around a tree.

use glam::{Vec2, Vec3};
use linden_pipeline::Skeleton;
use linden_pipeline::grow::Obstruction;

use crate::person::Person;

/// A tree without any extent is framed as if it were this large, metres.
const SMALLEST_EXTENT_M: f32 = 1e-7;

/// How many rings of equal height an [`Extent`] has.
pub const RINGS: usize = 24;

/// A solid of revolution around a tree, metres: upright rings, each as wide as the tree is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Where its axis stands.
    pub x: f32,
    /// Where its axis stands.
    pub z: f32,
    /// The lower end.
    pub bottom: f32,
    /// The upper end.
    pub top: f32,
    /// The radius of each ring, from the lowest to the highest.
    pub radii: [f32; RINGS],
    /// The person beside the tree who is framed with it.
    pub person: Option<Person>,
}

impl Extent {
    /// The solid around a skeleton's nodes (as balls of their radii) and some points.
    /// `None` when there is neither.
    pub fn of(skeleton: &Skeleton, points: &[Vec3]) -> Option<Self> {
        let balls = || {
            let nodes = skeleton.positions.iter().copied().zip(skeleton.radii.iter().copied());
            nodes.chain(points.iter().filter(|p| p.is_finite()).map(|&p| (p, 0.0)))
        };
        let (min, max) = balls().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), (p, r)| {
            (min.min(p - Vec3::splat(r)), max.max(p + Vec3::splat(r)))
        });
        if min.cmpgt(max).any() {
            return None;
        }
        let middle = min + (max - min) / 2.0;
        let mut radii = [0.0_f32; RINGS];
        let per_metre = RINGS as f32 / (max.y - min.y).max(SMALLEST_EXTENT_M);
        let ring = |y: f32| (((y - min.y) * per_metre) as usize).min(RINGS - 1);
        let reach = |p: Vec3, r: f32| Vec2::new(p.x - middle.x, p.z - middle.z).length() + r;
        let mut widen = |low: f32, high: f32, reach: f32| {
            for radius in &mut radii[ring(low)..=ring(high)] {
                *radius = radius.max(reach);
            }
        };
        for (p, r) in balls() {
            widen(p.y - r, p.y + r, reach(p, r));
        }
        // An internode may cross rings in which no node lies. The distance from an axis is convex
        // along it, so no place of it reaches farther than the farther end.
        let tips = skeleton.positions.iter().zip(&skeleton.radii);
        for (&parent, (&tip, r)) in skeleton.parents.iter().zip(tips) {
            let parent = parent as usize;
            let (Some(&base), Some(base_r)) = (skeleton.positions.get(parent), skeleton.radii.get(parent))
            else {
                continue;
            };
            let r = r.max(*base_r);
            if ring(base.y) != ring(tip.y) {
                widen(base.y.min(tip.y), base.y.max(tip.y), reach(base, r).max(reach(tip, r)));
            }
        }
        Some(Self { x: middle.x, z: middle.z, bottom: min.y, top: max.y, radii, person: None })
    }

    /// The corners of what stands beside the tree that this extent is of, metres, but none farther away from it than
    /// half of its longest side: a house behind a shrub must not make it a speck.
    pub fn in_reach(self, obstructions: &[Obstruction]) -> impl Iterator<Item = Vec3> {
        let margin = Vec3::splat(self.height().max(2.0 * self.radius()) / 2.0);
        let low = Vec3::new(self.x - self.radius(), self.bottom, self.z - self.radius()) - margin;
        let high = Vec3::new(self.x + self.radius(), self.top, self.z + self.radius()) + margin;
        obstructions.iter().flat_map(|solid| &solid.positions).map(move |place| place.clamp(low, high))
    }

    /// The widest ring's radius, metres.
    pub fn radius(&self) -> f32 {
        self.radii.iter().copied().fold(0.0, f32::max)
    }

    /// From the lower end to the upper one, metres.
    pub fn height(&self) -> f32 {
        self.top - self.bottom
    }

    /// The widest ring's radius between two heights, metres.
    pub(crate) fn radius_within(&self, low: f32, high: f32) -> f32 {
        (0..RINGS)
            .filter(|&i| self.rim(i) < high && self.rim(i + 1) > low)
            .map(|i| self.radii[i])
            .fold(0.0, f32::max)
    }

    /// With a cylinder around the same axis, from one height to another.
    pub(crate) fn with_cylinder(self, low: f32, high: f32, radius: f32) -> Self {
        let mut all = Self { bottom: self.bottom.min(low), top: self.top.max(high), ..self };
        for i in 0..RINGS {
            let (from, to) = (all.rim(i), all.rim(i + 1));
            let radius_before = if (all.bottom, all.top) == (self.bottom, self.top) {
                self.radii[i]
            } else {
                self.radius_within(from, to)
            };
            all.radii[i] = if from < high && to > low { radius_before.max(radius) } else { radius_before };
        }
        all
    }

    /// The height of a ring's lower rim.
    fn rim(&self, i: usize) -> f32 {
        self.bottom + self.height() * i as f32 / RINGS as f32
    }

    pub(crate) fn middle(&self) -> Vec3 {
        Vec3::new(self.x, self.bottom + (self.top - self.bottom) / 2.0, self.z)
    }

    /// The lens' distance from the middle, and how far the aim is lifted in the picture's plane, so
    /// that the whole solid lies within `slope` and touches it.
    ///
    /// A point (x, y, z) in the camera's axes around the aim is inside where |x| ≤ kx (d - z) and
    /// |y| ≤ ky (d - z): linear, so the rings' rims decide, and the largest value of a linear form
    /// over a circle of radius R is R times its length. Solved for the smallest d.
    pub(crate) fn fit(&self, slope: Vec2, sin_pitch: f32, cos_pitch: f32) -> (f32, f32) {
        let half_height = ((self.top - self.bottom) / 2.0).max(SMALLEST_EXTENT_M);
        let (kx, ky) = (1.0 / slope.x, 1.0 / slope.y);
        let (mut sideways, mut upper, mut lower) = (0.0_f32, f32::NEG_INFINITY, f32::NEG_INFINITY);
        for (i, radius) in self.radii.iter().enumerate() {
            let radius = radius.max(SMALLEST_EXTENT_M);
            for rim in [i, i + 1] {
                let y = half_height * (2.0 * rim as f32 / RINGS as f32 - 1.0);
                sideways = sideways.max(y * sin_pitch + radius * Vec2::new(kx, cos_pitch).length());
                let (near, far) = (cos_pitch - ky * sin_pitch, cos_pitch + ky * sin_pitch);
                upper = upper.max(y * (sin_pitch + ky * cos_pitch) + radius * near.abs());
                lower = lower.max(y * (sin_pitch - ky * cos_pitch) + radius * far.abs());
            }
        }
        // Lifting the aim by c lowers the upper need by ky c and raises the lower one as much.
        (sideways.max(f32::midpoint(upper, lower)), (upper - lower) / (2.0 * ky))
    }
}
