//! How much of each axis is seen past the foliage.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::cards::organ_rods;
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
pub(super) const COVERED: f32 = 0.25;
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
        monitor.check()?;
        let mut projections: [Projection; DIRECTIONS] =
            std::array::from_fn(|direction| Projection::new(bounds, direction));
        for rod in organ_rods(organs, &LevelForms::plain(organs)) {
            let middle = rod.from.midpoint(rod.to);
            for projection in &mut projections {
                projection.cover(middle, COVERED * rod.weight);
            }
        }
        monitor.check()?;
        let mut seen = vec![0.0; skeleton.axes.len()];
        for projection in &projections {
            for (axis, seen) in skeleton.axes.iter().zip(&mut seen) {
                let nodes = skeleton.nodes_of(axis);
                let nodes = &nodes[..nodes.len().div_ceil(2)];
                let sum: f32 =
                    nodes.iter().map(|&node| projection.seen(skeleton.positions[node as usize])).sum();
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

/// An upright plane with the foliage thrown onto it, in squares.
struct Projection {
    right: Vec2,
    low: Vec2,
    square_m: f32,
    /// Foliage by square, square metres.
    covers: Vec<f32>,
}

impl Projection {
    fn new(bounds: Bounds, direction: usize) -> Self {
        let turn = std::f32::consts::PI * direction as f32 / DIRECTIONS as f32;
        let (middle, half) = (bounds.min.midpoint(bounds.max), bounds.size() / 2.0);
        let right = Vec2::new(libm::cosf(turn), libm::sinf(turn));
        let reach = Vec2::new(half.x, half.z).length();
        let longest = (2.0 * reach.max(half.y)).max(f32::MIN_POSITIVE);
        let low = Vec2::new(Vec2::new(middle.x, middle.z).dot(right), middle.y) - longest / 2.0;
        Self { right, low, square_m: longest / SQUARES as f32, covers: vec![0.0; SQUARES * SQUARES] }
    }

    /// The square of a place; what is beside the plane is on its rim.
    fn square(&self, place: Vec3) -> usize {
        let at = Vec2::new(Vec2::new(place.x, place.z).dot(self.right), place.y) - self.low;
        let at = (at / self.square_m).clamp(Vec2::ZERO, Vec2::splat(SQUARES as f32 - 1.0));
        at.y as usize * SQUARES + at.x as usize
    }

    fn cover(&mut self, place: Vec3, area_m2: f32) {
        let square = self.square(place);
        self.covers[square] += area_m2;
    }

    /// The share of what is at a place that is seen.
    fn seen(&self, place: Vec3) -> f32 {
        let layers = self.covers[self.square(place)] / (self.square_m * self.square_m);
        libm::expf(-IN_FRONT * layers)
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

    fn exposed(grown: &Grown, organs: Organs) -> Exposure {
        let organs = Arc::new(organs);
        Exposure::of(Body { organs: &organs, ..body(grown) }, &Quiet).unwrap()
    }

    #[test]
    fn axes_below_the_foliage_are_seen_and_those_amid_it_are_not() {
        let (grown, organs, from_m) = from(0.5);
        let exposure = exposed(&grown, organs);
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
        let (half, all) = (exposed(&grown, half), exposed(&grown, all));
        let count = grown.skeleton.axes.len();
        assert!((0..count).all(|axis| all.at(axis) <= half.at(axis)));
        assert!((0..count).any(|axis| all.at(axis) < 0.5 * half.at(axis)));
        let bare = exposed(&grown, Organs::default());
        assert!((0..count).all(|axis| bare.at(axis) == 0.0), "by thickness alone");
    }
}
