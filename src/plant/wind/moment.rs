//! The tree at a moment of the loop: for pictures that move.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use super::field::{LEAF_SWING, PER_CHECK};
use super::{Blow, Field, Motion, PartWind, Sway, Wind};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_skeleton::Skeleton;
use linden_skeleton::organs::Organs;

/// How far each motion is out at a moment, -1 to 1 without gusts, in the order of [`Motion::ALL`]
/// without the begin.
pub(super) struct Swing([f32; 5]);

impl Swing {
    pub fn at(sway: &Sway, frame: u32) -> Self {
        let [_, motions @ ..] = Motion::ALL;
        Self(motions.map(|motion| sway.swing(motion, frame)))
    }

    pub fn moved(&self, [stem, with_sine, with_cosine]: [Vec3; 3]) -> Vec3 {
        let Self([lean, sine, cosine, ..]) = *self;
        stem * lean + with_sine * sine + with_cosine * cosine
    }

    /// How far a leaf of this phase is out.
    fn leaf(&self, phase: f32) -> f32 {
        let Self([.., sine, cosine]) = *self;
        let (sin, cos) = libm::sincosf(TAU * phase);
        cos * sine + sin * cosine
    }
}

/// A tree's wood and leaves as they are at a frame of the loop that this wind blows them in
/// ([`Sway`]), whether exports carry it or not. Leaves keep their shape and turn about where they are
/// attached. Takes some 100 ns a node and leaf.
///
/// # Errors
/// [`Cancelled`].
pub fn blown(
    blow: &Blow,
    seed: u64,
    skeleton: &Skeleton,
    organs: &Organs,
    frame: u32,
    monitor: &dyn Monitor,
) -> Result<(Skeleton, Organs), Cancelled> {
    let field = Field::new(skeleton, blow, Wind::Sway, Key::new(seed).named("wind"));
    let swing = Swing::at(&Sway::new(blow), frame);
    let mut wood = skeleton.clone();
    for (node, place) in wood.positions.iter_mut().enumerate() {
        if node.is_multiple_of(PER_CHECK) {
            monitor.check()?;
        }
        *place += swing.moved(field.of_node(node as u32).moved(*place));
    }
    let mut leaves = organs.clone();
    let polygons = &mut leaves.polygons;
    let mut first = 0;
    for (polygon, &end) in polygons.ends.iter().enumerate() {
        if polygon.is_multiple_of(PER_CHECK) {
            monitor.check()?;
        }
        let corners = &mut polygons.corners[first..end as usize];
        first = end as usize;
        let Some(&foot) = corners.first() else { continue };
        let carried = swing.moved(field.of_node(polygons.growth.nodes[polygon]).moved(foot));
        let up = polygons.ups[polygon];
        let flap = up * (LEAF_SWING * field.strength * swing.leaf(field.phase(foot, up)));
        for corner in corners {
            *corner += carried + flap * corner.distance(foot);
        }
    }
    let placed = &mut leaves.placed;
    for organ in 0..placed.positions.len() {
        if organ.is_multiple_of(PER_CHECK) {
            monitor.check()?;
        }
        let (foot, up, heading) = (placed.positions[organ], placed.ups[organ], placed.headings[organ]);
        placed.positions[organ] += swing.moved(field.of_node(placed.growth.nodes[organ]).moved(foot));
        // The tip goes up by a share of the leaf's length: heading and up turn about their normal.
        let out = LEAF_SWING * field.strength * swing.leaf(field.phase(foot, up));
        placed.headings[organ] = (heading + up * out).normalize_or(heading);
        placed.ups[organ] = (up - heading * out).normalize_or(up);
    }
    Ok((wood, leaves))
}

impl PartWind {
    /// Where the vertices of a part are at a frame of its loop; `None` for a part that has no loop.
    pub fn moved(&self, positions: &[Vec3], frame: u32) -> Option<Vec<Vec3>> {
        if let Some(bones) = &self.bones {
            return Some(self.posed(bones, positions, frame));
        }
        let sway: &Arc<Sway> = self.sway.as_ref()?;
        let mut moved = positions.to_vec();
        for target in &self.targets {
            let weight = sway.weight(target.motion, frame);
            for (place, &offset) in moved.iter_mut().zip(&target.offsets) {
                *place += offset * weight;
            }
        }
        Some(moved)
    }
}
