//! A person beside the tree, for scale.

use glam::{Vec2, Vec3};

use crate::{Extent, View};

/// How tall the person is, metres: about the mean of adults.
pub const PERSON_M: f32 = 1.75;
/// The person stands beside plants that are not lower than this share of them: beside anything
/// smaller the picture would show a person and hardly a plant.
const LEAST_TREE: f32 = 1.0 / 3.0;
/// Between the tree and the person's middle, metres.
const GAP_M: f32 = 0.55;
/// Half of the person's width, metres.
const HALF_WIDTH_M: f32 = 0.32;

/// Where a person stands, seen from the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// The height of the ground, metres.
    pub ground_m: f32,
    /// From the tree's axis, metres, to the right in any picture.
    pub away_m: f32,
}

impl Extent {
    /// With a person who stands on the ground (its height in metres) just beside whatever the tree
    /// has below head height: the trunk, or a crown that reaches the ground.
    ///
    /// The same without a person when the plant is too small for one; [`Extent::person`] tells.
    #[must_use]
    pub fn with_person(self, ground_m: f32) -> Self {
        let above_m = self.top - ground_m;
        if !(above_m >= PERSON_M * LEAST_TREE) {
            return Self { person: None, ..self };
        }
        let head_m = ground_m + PERSON_M;
        let away_m = self.radius_within(ground_m, head_m) + GAP_M;
        let person = Some(Person { ground_m, away_m });
        Self { person, ..self.with_cylinder(ground_m, head_m, away_m + HALF_WIDTH_M) }
    }
}

impl Person {
    /// Between the feet, metres: at the tree's depth, to its right.
    pub(crate) fn place(self, extent: &Extent, view: &View) -> Vec3 {
        Vec3::new(extent.x, self.ground_m, extent.z) + view.right() * self.away_m
    }
}

/// A limb: its ends (right and up from between the feet) and the radii there, metres.
pub(crate) struct Limb {
    pub ends: [Vec2; 2],
    pub radii: [f32; 2],
}

const fn limb(from: [f32; 2], to: [f32; 2], radii: [f32; 2]) -> Limb {
    Limb { ends: [Vec2::from_array(from), Vec2::from_array(to)], radii }
}

/// The silhouette of somebody who stands and waits. The head is a little large: it is what makes
/// eight pixels a person.
pub(crate) const LIMBS: [Limb; 8] = [
    limb([0.0, PERSON_M - 0.13], [0.0, PERSON_M - 0.135], [0.13, 0.12]),
    limb([-0.12, 1.37], [0.12, 1.37], [0.075, 0.075]),
    limb([0.0, 1.33], [0.0, 0.92], [0.165, 0.135]),
    limb([-0.20, 1.36], [-0.245, 0.84], [0.055, 0.04]),
    limb([0.20, 1.36], [0.245, 0.84], [0.055, 0.04]),
    limb([-0.075, 0.90], [-0.10, 0.055], [0.09, 0.055]),
    limb([0.075, 0.90], [0.10, 0.055], [0.09, 0.055]),
    limb([0.0, 1.46], [0.0, 1.40], [0.06, 0.07]),
];
