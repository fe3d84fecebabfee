//! What turns the rings of an axis into its tube: how round they are, and what shapes its ends.

use std::f32::consts::{PI, TAU};

use glam::Vec4;

use super::collar::Collar;
use super::features::{Ends, Flare};
use super::path::Ring;
use super::roots::Root;

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
pub(super) struct Circle {
    /// Thicker rings deviate too far from it.
    largest_radius_m: f32,
    /// Unit vectors `(cos, sin)` at equal angles, the first one again at the end: the seam.
    pub corners: Vec<(f32, f32)>,
    /// The same, cosines and sines of [`Circle::LANES`] corners at a time; the last ones go on round the circle.
    pub lanes: Vec<[Vec4; 2]>,
    /// How far from the centre the corners of the polygon stand, in radii of the circle that it is for.
    pub reach: f32,
}

impl Circle {
    /// Corners that are looked at at once.
    pub const LANES: usize = 4;

    pub fn sides(&self) -> u32 {
        self.corners.len() as u32 - 1
    }
}

/// How far out a polygon's corners stand for a circle of radius 1. The polygon has the circle's area, so that
/// wood has its volume whatever its sides; of fewer than 8 sides its girth, so that twigs are seen as wide as
/// they are: by Cauchy's formula a girth is π times the mean width. Corners on the circle would make a twig of
/// three sides a fifth too thin.
fn reach(sides: u32) -> f32 {
    let half = PI / sides as f32;
    if sides < 8 { half / libm::sinf(half) } else { (2.0 * half / libm::sinf(2.0 * half)).sqrt() }
}

impl Roundness {
    /// Circles of up to `sides` sides for radii, and of more for those who need them.
    pub(super) fn new(sides: u32, thickest_m: f32) -> Self {
        // Between circle and polygon, in radii.
        let sagitta = |sides: u32| 1.0 - libm::cosf(PI / sides as f32);
        let corner = |k: u32, n: u32| {
            let (sin, cos) = libm::sincosf(TAU * (k % n) as f32 / n as f32);
            (cos, sin)
        };
        let circle = |n: u32| Circle {
            // The last one takes whatever is left, however it was rounded.
            largest_radius_m: if n >= sides {
                f32::INFINITY
            } else {
                thickest_m * sagitta(sides) / sagitta(n)
            },
            corners: (0..=n).map(|k| corner(k, n)).collect(),
            lanes: (0..=n / Circle::LANES as u32)
                .map(|some| {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|lane| corner(some * Circle::LANES as u32 + lane, n));
                    [Vec4::new(a.0, b.0, c.0, d.0), Vec4::new(a.1, b.1, c.1, d.1)]
                })
                .collect(),
            reach: reach(n),
        };
        let fewer = SIDES.into_iter().filter(|&n| n < sides);
        let more = SIDES.into_iter().filter(|&n| n > sides);
        Self { thickest_m, circles: fewer.chain([sides]).chain(more).map(circle).collect() }
    }

    /// The circle for a radius, with at least `least_sides` sides where there is one.
    pub(super) fn circle(&self, radius_m: f32, least_sides: u32) -> &Circle {
        let is_enough =
            |circle: &Circle| radius_m <= circle.largest_radius_m && circle.sides() >= least_sides;
        let enough = self.circles.iter().position(is_enough);
        // There is always one: that of the sides that were asked for.
        &self.circles[enough.unwrap_or(self.circles.len() - 1)]
    }

    pub(super) fn sides(&self, radius_m: f32) -> u32 {
        self.circle(radius_m, 0).sides()
    }

    /// How far the corners of a ring of a radius stand from its centre, in that radius.
    pub(super) fn reach(&self, radius_m: f32) -> f32 {
        self.circle(radius_m, 0).reach
    }
}

/// What turns the rings of one axis into its tube.
#[derive(Clone, Debug, Default)]
pub(super) struct TubeForm {
    /// Of a stem.
    pub flare: Option<Flare>,
    /// Of a lateral.
    pub collar: Option<Box<Collar>>,
    /// Of a root.
    pub root: Option<Box<Root>>,
    pub ends: Ends,
    /// Which axis of the skeleton it is: splinters differ from one to the next.
    pub axis: u32,
    /// Whether it bends so much that it could fold.
    pub is_bent: bool,
    /// Whether it stands on the ground.
    pub is_stem: bool,
    /// The fewest sides that it has from a radius on, metres.
    pub stout: (u32, f32),
}

impl TubeForm {
    /// The circle for a ring, or for what is below or above it, of a radius.
    pub fn circle<'a>(&self, ring: &Ring, radius_m: f32, roundness: &'a Roundness) -> &'a Circle {
        let least = match (&self.flare, &self.root) {
            (Some(flare), _) => flare.least_sides(ring.along),
            (_, Some(root)) => root.least_sides(ring.along, roundness.sides(roundness.thickest_m)),
            _ => 0,
        };
        let (sides, from_m) = self.stout;
        let least = if radius_m >= from_m { least.max(sides) } else { least };
        let wider = match &self.collar {
            Some(collar) if collar.shapes(ring.along) => 0.5 * collar.fillet_m,
            _ => 0.0,
        };
        roundness.circle(radius_m + wider, least)
    }
}
