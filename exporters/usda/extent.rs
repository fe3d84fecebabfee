//! How large a plant is while it moves in the wind: a box for each frame of the sway loop.

use glam::Vec3;
use linden_pipeline::scene::Bounds;
use linden_pipeline::wind::{Motion, Sway};

use crate::writing::distinct::MeshPart;

/// A vertex that may be the outermost one in some frame.
struct Outer {
    /// Where it is while all weights but that of [`Motion::Begin`] are 0.
    at: Vec3,
    /// How far each motion moves it, in the order of [`Motion::ALL`].
    ways: [Vec3; Motion::ALL.len()],
}

impl Outer {
    /// Vertex `index` of a part that moves.
    fn of(piece: &MeshPart<'_>, index: usize) -> Self {
        let mut outer = Self { at: piece.mesh.positions[index], ways: [Vec3::ZERO; Motion::ALL.len()] };
        for target in piece.wind.iter().flat_map(|wind| &wind.targets) {
            let offset = target.offsets[index];
            match Motion::ALL.iter().position(|motion| *motion == target.motion) {
                // Its weight is 1 all the time.
                _ if target.motion == Motion::Begin => outer.at += offset,
                Some(way) => outer.ways[way] += offset,
                None => {}
            }
        }
        outer
    }

    /// The box that it never leaves: weights are between 0 and 1.
    fn reach(&self) -> Bounds {
        let sum = |of: fn(Vec3, Vec3) -> Vec3| {
            self.ways.iter().fold(self.at, |sum, way| sum + of(*way, Vec3::ZERO))
        };
        Bounds { min: sum(Vec3::min), max: sum(Vec3::max) }
    }

    fn at(&self, weights: &[f32; Motion::ALL.len()]) -> Vec3 {
        self.ways.iter().zip(weights).fold(self.at, |sum, (way, weight)| sum + *way * *weight)
    }
}

/// The box round some parts in each frame of a loop, the last one included; none where there is no vertex.
///
/// Most vertices are never outermost, whatever the weights: they are looked at once, the others in each frame.
pub(super) fn of_frames(pieces: &[&MeshPart<'_>], sway: &Sway) -> Vec<Bounds> {
    let moves = |piece: &&&MeshPart<'_>| piece.wind.is_some_and(|wind| !wind.targets.is_empty());
    let still = pieces.iter().filter(|piece| !moves(piece));
    let still = still.map(|piece| piece.copies.as_ref().map_or(piece.bounds, |copies| copies.seen));
    let still = still.reduce(Bounds::union);
    let all = || {
        let moving = pieces.iter().filter(moves);
        moving.flat_map(|piece| (0..piece.mesh.positions.len()).map(|index| Outer::of(piece, index)))
    };
    // What is surely reached in each frame: a vertex that stays within counts for nothing.
    let sure =
        all().map(|outer| outer.reach()).fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), reach| {
            (low.min(reach.max), high.max(reach.min))
        });
    let outermost: Vec<Outer> = all()
        .filter(|outer| {
            let Bounds { min, max } = outer.reach();
            min.cmple(sure.0).any() || max.cmpge(sure.1).any()
        })
        .collect();
    let of_frame = |frame: u32| {
        let weights =
            Motion::ALL.map(|motion| if motion == Motion::Begin { 0.0 } else { sway.weight(motion, frame) });
        let moved = Bounds::of(outermost.iter().map(|outer| outer.at(&weights)));
        still.into_iter().chain(moved).reduce(Bounds::union)
    };
    (0..=sway.frames()).map_while(of_frame).collect()
}
