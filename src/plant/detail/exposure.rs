//! How much of each axis is seen through the foliage.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::cards::rods;
use super::forms::LevelForms;
use crate::Body;
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};

/// Directions of sight, level, over half a turn: a line of sight is the same from both of its ends.
const DIRECTIONS: usize = 4;
/// Squares along the longest side of what is seen.
const SQUARES: usize = 48;
/// What a leaf covers, on average over how it may lie, as a share of the square of its length: leaves are half as wide
/// as long, or twigs half full of them, and half of that is seen.
const COVERED: f32 = 0.25;
/// Of the foliage on a line of sight, this share is in front.
const IN_FRONT: f32 = 0.5;

/// For each axis the share of its lower half that is seen past the foliage, from level all around; the upper half has
/// leaves of its own. Nothing on a bare tree, where wood hides no less than it is hidden.
#[derive(Clone, Debug, Default)]
pub(super) struct Exposure(Arc<[f32]>);

impl Exposure {
    /// Foliage is thrown onto upright planes. What is left of the light behind so much of it, by the law of Beer and
    /// Lambert (Monsi & Saeki 1953), is the share of the wood there that is seen.
    pub fn of(body: Body<'_>, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let Body { skeleton, organs, .. } = body;
        let bounds = Bounds::of(skeleton.positions.iter().copied());
        let Some(bounds) = bounds.filter(|_| !organs.is_empty()) else {
            return Ok(Self::default());
        };
        let mut seen = vec![0.0; skeleton.axes.len()];
        let forms = LevelForms::plain(organs);
        for direction in 0..DIRECTIONS {
            monitor.check()?;
            let plane = Plane::new(bounds, direction);
            let mut covers = vec![0.0_f32; SQUARES * SQUARES];
            for rod in rods(skeleton, organs, &forms, &[]) {
                covers[plane.square(rod.from.midpoint(rod.to))] += COVERED * rod.weight;
            }
            let through = |place: Vec3| {
                let layers = covers[plane.square(place)] / (plane.square_m * plane.square_m);
                libm::expf(-IN_FRONT * layers)
            };
            for (axis, seen) in skeleton.axes.iter().zip(&mut seen) {
                let nodes = skeleton.nodes_of(axis);
                let nodes = &nodes[..nodes.len().div_ceil(2)];
                let sum: f32 = nodes.iter().map(|&node| through(skeleton.positions[node as usize])).sum();
                *seen += sum / (nodes.len().max(1) * DIRECTIONS) as f32;
            }
        }
        Ok(Self(seen.into()))
    }

    /// Of an axis.
    pub fn at(&self, axis: usize) -> f32 {
        self.0.get(axis).copied().unwrap_or(0.0)
    }
}

/// An upright plane, in squares.
struct Plane {
    right: Vec2,
    low: Vec2,
    square_m: f32,
}

impl Plane {
    fn new(bounds: Bounds, direction: usize) -> Self {
        let turn = std::f32::consts::PI * direction as f32 / DIRECTIONS as f32;
        let (middle, half) = (bounds.min.midpoint(bounds.max), bounds.size() / 2.0);
        let right = Vec2::new(libm::cosf(turn), libm::sinf(turn));
        let reach = Vec2::new(half.x, half.z).length();
        let longest = (2.0 * reach.max(half.y)).max(f32::MIN_POSITIVE);
        let low = Vec2::new(Vec2::new(middle.x, middle.z).dot(right), middle.y) - longest / 2.0;
        Self { right, low, square_m: longest / SQUARES as f32 }
    }

    /// The square of a place; what is beside the plane is on its rim.
    fn square(&self, place: Vec3) -> usize {
        let at = Vec2::new(Vec2::new(place.x, place.z).dot(self.right), place.y) - self.low;
        let at = (at / self.square_m).clamp(Vec2::ZERO, Vec2::splat(SQUARES as f32 - 1.0));
        at.y as usize * SQUARES + at.x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::leaves::selected;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;
    use linden_pipeline::grow::Grown;
    use linden_skeleton::organs::Organs;

    /// The foliage of a beech, as far as it is higher than a share of its height; with where that begins, metres.
    fn from(share: f32) -> (Grown, Organs, f32) {
        let grown = Subject::builtin("beech", &[]).grow();
        let place = |organ: usize| grown.skeleton.positions[grown.organs.growth(organ).node as usize];
        let top_m = grown.skeleton.positions.iter().map(|place| place.y).fold(0.0, f32::max);
        let from_m = share * top_m;
        let organs = selected(&grown.organs, |organ| place(organ).y > from_m, |_| 1.0);
        (grown, organs, from_m)
    }

    fn exposure(grown: &Grown, organs: Organs) -> Exposure {
        let organs = Arc::new(organs);
        Exposure::of(Body { organs: &organs, ..body(grown) }, &Quiet).unwrap()
    }

    #[test]
    fn axes_below_the_foliage_are_seen_and_those_amid_it_are_not() {
        let (grown, organs, from_m) = from(0.5);
        let exposure = exposure(&grown, organs);
        let skeleton = &grown.skeleton;
        let (mut below, mut amid) = (Vec::new(), Vec::new());
        for (index, axis) in skeleton.axes.iter().enumerate() {
            let places = skeleton.nodes_of(axis).iter().map(|&node| skeleton.positions[node as usize]);
            if places.clone().all(|place| place.y < from_m - 2.0) {
                below.push(exposure.at(index));
            } else if places
                .clone()
                .all(|place| place.y > from_m + 1.0 && Vec2::new(place.x, place.z).length() < 2.0)
            {
                amid.push(exposure.at(index));
            }
        }
        assert!(below.len() > 100 && below.iter().all(|&seen| seen == 1.0));
        let mean = amid.iter().sum::<f32>() / amid.len() as f32;
        assert!(amid.len() > 100 && mean < 0.25, "{} {mean}", amid.len());
    }

    #[test]
    fn more_leaves_hide_more_and_none_hide_nothing() {
        let (grown, half, _) = from(0.5);
        let (_, all, _) = from(0.0);
        let (half, all) = (exposure(&grown, half), exposure(&grown, all));
        let count = grown.skeleton.axes.len();
        assert!((0..count).all(|axis| all.at(axis) <= half.at(axis)));
        assert!((0..count).any(|axis| all.at(axis) < 0.5 * half.at(axis)));
        let bare = self::exposure(&grown, Organs::default());
        assert!((0..count).all(|axis| bare.at(axis) == 0.0), "by thickness alone");
    }
}
