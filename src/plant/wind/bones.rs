//! Joints that carry the sway of a tree: a hundredth of what its morph targets take.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::{PartWind, Sway};
use linden_base::memory::bytes_of;

/// Joints that a vertex is bound to at most: what glTF keeps in one attribute.
pub const INFLUENCES: usize = 4;

/// How many joints a tree has, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoneSettings {
    /// The most joints.
    pub most: u32,
    /// The deepest order of axes with joints of their own: 0 stems alone, 1 their branches too.
    pub order: u32,
}

impl Default for BoneSettings {
    fn default() -> Self {
        Self { most: 256, order: 8 }
    }
}

/// A place of the wood that turns, and everything with it that is bound to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// `joint_AXIS_NUMBER`, both counted from 0; `joint` is what all others hang on.
    pub name: String,
    /// The joint that carries it: one before it.
    pub parent: Option<usize>,
    /// Where it is at rest, metres.
    pub place: Vec3,
    /// The order of its axis: 0 of a stem, one more on each branching. The ground has that of stems.
    pub order: u32,
}

/// The joints of a tree and how they turn over the loop. The first is the ground: it never moves, and all others hang
/// on it.
///
/// A joint's turn takes those of its parents away, so that the wood of an axis goes where the wind model moves that
/// axis, whatever bears it. Lengths between joints stay as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Bones {
    /// Parents come first.
    pub joints: Vec<Joint>,
    /// The loop.
    pub sway: Arc<Sway>,
    /// Frame by frame, the turn of each joint within its parent.
    pub(super) turns: Vec<Quat>,
}

/// What a vertex is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Indices of joints, those of the largest weights first; 0 where the weight is 0.
    pub joints: [u16; INFLUENCES],
    /// Shares, in 255ths: their sum is 255.
    pub weights: [u8; INFLUENCES],
}

impl Binding {
    /// To the ground.
    pub const STILL: Self = Self { joints: [0; INFLUENCES], weights: [255, 0, 0, 0] };
}

impl Bones {
    /// The turn of a joint within its parent at a frame of the loop, of unit length; none of them is half a turn.
    pub fn turn(&self, joint: usize, frame: u32) -> Quat {
        let frame = (frame % self.sway.frames()) as usize;
        self.turns.get(frame * self.joints.len() + joint).copied().unwrap_or(Quat::IDENTITY)
    }

    /// Whether a joint turns at all.
    pub fn turns(&self, joint: usize) -> bool {
        (0..self.sway.frames()).any(|frame| self.turn(joint, frame) != Quat::IDENTITY)
    }

    /// How far the axes of an order bend at most, from their first joint to their last: angles between joints, added up,
    /// in the frame where this is most; on average over those that have joints. By order, radians.
    pub fn bends_rad(&self) -> Vec<f32> {
        let orders = self.joints.iter().map(|joint| joint.order as usize + 1).max().unwrap_or(0);
        let mut sums = vec![(0.0, 0); orders];
        let mut first = 0;
        while first < self.joints.len() {
            let goes_on = |next: &usize| {
                let Joint { parent, order, .. } = self.joints[*next];
                parent == Some(next - 1) && order == self.joints[first].order
            };
            let last = (first + 1..self.joints.len()).take_while(goes_on).last().unwrap_or(first);
            let bend = |frame| (first..=last).map(|joint| angle_rad(self.turn(joint, frame))).sum::<f32>();
            let most = (0..self.sway.frames()).map(bend).fold(0.0, f32::max);
            let (sum, axes) = &mut sums[self.joints[first].order as usize];
            *sum += most;
            *axes += 1;
            first = last + 1;
        }
        sums.into_iter().map(|(sum, axes)| sum / (axes.max(1) as f32)).collect()
    }

    /// Where a joint is from its parent, at rest and ever after, metres.
    pub fn arm(&self, joint: usize) -> Vec3 {
        let Joint { parent, place, .. } = self.joints[joint];
        parent.map_or(place, |parent| place - self.joints[parent].place)
    }

    /// Turn and place of each joint at a frame, among all of the tree.
    pub fn pose(&self, frame: u32) -> Vec<(Quat, Vec3)> {
        let mut pose: Vec<(Quat, Vec3)> = Vec::with_capacity(self.joints.len());
        for (index, joint) in self.joints.iter().enumerate() {
            let (turn, place) = joint.parent.map_or((Quat::IDENTITY, Vec3::ZERO), |parent| pose[parent]);
            pose.push((turn * self.turn(index, frame), place + turn * self.arm(index)));
        }
        pose
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Quat>(self.turns.capacity()) + bytes_of::<(Joint, [u8; 16])>(self.joints.capacity())
    }
}

/// By how much something turns.
fn angle_rad(turn: Quat) -> f32 {
    2.0 * libm::atan2f(turn.xyz().length(), turn.w.abs())
}

impl PartWind {
    /// Where bound vertices are at a frame.
    pub(super) fn posed(&self, bones: &Bones, positions: &[Vec3], frame: u32) -> Vec<Vec3> {
        let pose = bones.pose(frame);
        let moved = |(&place, binding): (&Vec3, &Binding)| {
            let each = binding.joints.iter().zip(binding.weights).filter(|(_, weight)| *weight > 0);
            let sum: Vec3 = each
                .map(|(&joint, weight)| {
                    let (turn, at) = pose[usize::from(joint)];
                    (at + turn * (place - bones.joints[usize::from(joint)].place)) * f32::from(weight)
                })
                .sum();
            sum / 255.0
        };
        positions.iter().zip(&self.bindings).map(moved).collect()
    }
}
