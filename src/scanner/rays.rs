//! The first triangle on a ray.
//!
//! The tree of boxes is of the crate obvhs, in single precision; its boxes are made wider by what its arithmetic may be
//! off, and the triangles themselves are met in double precision (Möller & Trumbore 1997). So the nearest
//! triangle is found, whatever the order in which boxes are visited.

use glam::{DVec3, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};

use crate::ScannerError;
use crate::stand::Stand;
use crate::target::{Ground, Target};

/// Share of the largest coordinate by which boxes are made wider: some steps of single precision.
const SLACK: f32 = 1e-6;

/// Of all branches of the tree of boxes, those that are moved to a better place.
const REINSERTED: f32 = 0.05;

/// A target to cast rays at.
pub struct Rays<'a> {
    target: &'a Target,
    ground: Option<Ground>,
    boxes: Bvh2,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayEnd {
    /// From the ray's origin, metres.
    pub range_m: f64,
    /// Which triangle; `None`: the ground.
    pub triangle: Option<u32>,
    /// Of the angle between the ray and the surface's normal.
    pub cos_incidence: f64,
}

impl<'a> Rays<'a> {
    /// Builds the tree of boxes. Rays begin at one of the `stands`, or nearer.
    ///
    /// # Errors
    /// [`ScannerError`]: memory, cancelled.
    pub fn new(
        target: &'a Target,
        ground: Option<Ground>,
        stands: &[Stand],
        monitor: &dyn Monitor,
    ) -> Result<Self, ScannerError> {
        monitor.check()?;
        let count = target.triangles.len();
        monitor.admit(
            "scanning a surface",
            bytes_of::<[u8; 300]>(count),
            "lower sides or scan without leaves",
        )?;
        let corners = target.triangles.iter().flatten().copied();
        let far = corners.chain(stands.iter().map(|stand| stand.eye.as_vec3()));
        let slack = Vec3::splat(SLACK * far.map(|p| p.abs().max_element()).fold(1.0, f32::max));
        let around: Vec<Aabb> = target
            .triangles
            .iter()
            .map(|[a, b, c]| {
                let (min, max) = (a.min(*b).min(*c) - slack, a.max(*b).max(*c) + slack);
                Aabb::new(min.into(), max.into())
            })
            .collect();
        // Not by the crate's `build_bvh2`, which reads the clock.
        let indices = (0..count as u32).collect();
        let (search, precision) = (PlocSearchDistance::Low, SortPrecision::U64);
        let mut boxes = PlocBuilder::with_capacity(count).build(search, &around, indices, precision, 2);
        ReinsertionOptimizer::default().run(&mut boxes, REINSERTED, None);
        monitor.check()?;
        Ok(Self { target, ground, boxes })
    }

    /// Bytes that it holds, the target's among them.
    pub fn bytes(&self) -> u64 {
        let Target { triangles, owners, .. } = self.target;
        let boxes = bytes_of::<[f32; 8]>(self.boxes.nodes.len());
        boxes + bytes_of::<u32>(owners.len() + triangles.len()) + bytes_of::<[Vec3; 3]>(triangles.len())
    }

    /// What the triangle's truth is, as an index: the one behind the target's is the ground's.
    pub fn truth(&self, end: &RayEnd) -> u32 {
        end.triangle.map_or(self.target.truths.len() as u32, |triangle| self.target.owners[triangle as usize])
    }

    /// Where a ray first meets the target from either side, or the ground; of triangles that are met at the very same place,
    /// the first. `direction` is a unit vector.
    pub fn first(&self, origin: DVec3, direction: DVec3) -> Option<RayEnd> {
        let mut best: Option<(f64, u32)> = None;
        let ray = Ray::new_inf(origin.as_vec3().into(), direction.as_vec3().into());
        self.boxes.ray_traverse(ray, &mut RayHit::none(), |_, slot| {
            let triangle = self.boxes.primitive_indices[slot];
            let Some(range_m) = meet(origin, direction, self.corners(triangle)) else { return f32::INFINITY };
            if best.is_none_or(|found| (range_m, triangle) < found) {
                best = Some((range_m, triangle));
            }
            // Never shorter than it is: nothing in front of it is passed over.
            (range_m as f32).next_up()
        });
        let wood = best.map(|(range_m, triangle)| {
            let [a, b, c] = self.corners(triangle);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            RayEnd { range_m, triangle: Some(triangle), cos_incidence: normal.dot(direction).abs() }
        });
        let ground = self.ground.and_then(|ground| meet_ground(origin, direction, ground));
        match (wood, ground) {
            (Some(wood), Some(ground)) => Some(if ground.range_m < wood.range_m { ground } else { wood }),
            (wood, ground) => wood.or(ground),
        }
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.target.triangles[triangle as usize].map(Vec3::as_dvec3)
    }
}

/// How far along the ray a triangle is met; `None` where it is not (Möller & Trumbore 1997, *Fast, minimum storage
/// ray-triangle intersection*).
pub fn meet(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(ab);
    let v = direction.dot(q) / determinant;
    let range_m = ac.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range_m > 0.0).then_some(range_m)
}

fn meet_ground(origin: DVec3, direction: DVec3, ground: Ground) -> Option<RayEnd> {
    // Up from the ground, not of unit length.
    let up = DVec3::new(-ground.rise, 1.0, 0.0);
    let falls = -direction.dot(up);
    if falls <= 0.0 {
        return None;
    }
    let range_m = (origin - ground.middle).dot(up) / falls;
    let off = origin + direction * range_m - ground.middle;
    let is_within = off.x * off.x + off.z * off.z <= ground.radius_m * ground.radius_m;
    let end = RayEnd { range_m, triangle: None, cos_incidence: falls / up.length() };
    (range_m > 0.0 && is_within).then_some(end)
}
