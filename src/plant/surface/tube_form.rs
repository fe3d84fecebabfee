//! What turns the rings of an axis into its tube: how round they are, and what shapes its ends.

use std::f32::consts::{PI, TAU};

use super::collar::Collar;
use super::features::{Ends, Flare};
use super::path::Ring;

/// Side counts that rings take. Few distinct ones, so that neighbouring rings mostly agree.
const SIDES: [u32; 14] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 128];

/// How many sides a radius deserves, and a circle for each such number: equal absolute deviation from
/// the circle on thick and thin wood, set by the sides of the thickest.
#[derive(Clone, Debug)]
pub(super) struct Roundness {
    pub thickest_m: f32,
    circles: Vec<Circle>,
}

#[derive(Clone, Debug)]
struct Circle {
    /// Thicker rings deviate too far from it.
    largest_radius_m: f32,
    /// Unit vectors `(cos, sin)` at equal angles, the first one again at the end: the seam.
    corners: Vec<(f32, f32)>,
}

impl Roundness {
    /// Circles of up to `sides` sides for radii, and of more for those who need them.
    pub(super) fn new(sides: u32, thickest_m: f32) -> Self {
        // Between circle and polygon, in radii.
        let sagitta = |sides: u32| 1.0 - libm::cosf(PI / sides as f32);
        let circle = |n: u32| Circle {
            // The last one takes whatever is left, however it was rounded.
            largest_radius_m: if n >= sides {
                f32::INFINITY
            } else {
                thickest_m * sagitta(sides) / sagitta(n)
            },
            corners: (0..=n)
                .map(|k| {
                    let (sin, cos) = libm::sincosf(TAU * (k % n) as f32 / n as f32);
                    (cos, sin)
                })
                .collect(),
        };
        let fewer = SIDES.into_iter().filter(|&n| n < sides);
        let more = SIDES.into_iter().filter(|&n| n > sides);
        Self { thickest_m, circles: fewer.chain([sides]).chain(more).map(circle).collect() }
    }

    /// The circle for a radius, with at least `least_sides` sides where there is one.
    fn circle(&self, radius_m: f32, least_sides: u32) -> &[(f32, f32)] {
        let is_enough = |circle: &&Circle| {
            radius_m <= circle.largest_radius_m && circle.corners.len() as u32 > least_sides
        };
        let enough = self.circles.iter().find(is_enough).or(self.circles.last());
        enough.map_or(&[], |circle| &circle.corners)
    }

    pub(super) fn sides(&self, radius_m: f32) -> u32 {
        self.circle(radius_m, 0).len() as u32 - 1
    }
}

/// What turns the rings of one axis into its tube.
#[derive(Clone, Debug, Default)]
pub(super) struct TubeForm {
    /// Of a stem.
    pub flare: Option<Flare>,
    /// Of a lateral.
    pub collar: Option<Box<Collar>>,
    pub ends: Ends,
    /// Which axis of the skeleton it is: splinters differ from one to the next.
    pub axis: u32,
    /// Whether it stands on the ground.
    pub is_stem: bool,
}

impl TubeForm {
    pub fn circle<'a>(&self, ring: &Ring, roundness: &'a Roundness) -> &'a [(f32, f32)] {
        let least = self.flare.map_or(0, |flare| flare.least_sides(ring.along));
        let wider = match &self.collar {
            Some(collar) if collar.shapes(ring.along) => 0.5 * collar.fillet_m,
            _ => 0.0,
        };
        roundness.circle(ring.radius + wider, least)
    }
}
