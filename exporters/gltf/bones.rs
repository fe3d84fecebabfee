//! Joints in glTF: a skin for each tree that stands, its nodes, and how these turn.
//!
//! A mesh that is bound goes where its joints are, whatever node it stands on: such nodes are roots of the scene, and
//! the joints hang on the node that stands where the tree does. What vertices in fewer bits mean (their cube) is in the
//! inverse bind matrices.

use glam::Vec3;
use linden_pipeline::wind::Bones;

use super::buffer::Layout;
use super::document::{AnimationSampler, Channel, ChannelTarget, Node, Skin};
use super::quantize::Cube;
use crate::writing::distinct::DistinctMeshes;

/// The joints of each plant that has some, in the order of all plants.
pub(super) fn of_plants<'a>(distinct: &DistinctMeshes<'a>) -> Vec<Option<&'a Bones>> {
    let bones = |plant: usize| {
        let pieces = distinct.models_of(plant).iter().flat_map(|model| &model.parts);
        pieces.filter_map(|piece| piece.wind).find_map(|wind| wind.bones.as_deref())
    };
    (0..distinct.plants()).map(bones).collect()
}

/// Lays out where the joints of each plant are at rest: an accessor of inverse bind matrices.
pub(super) fn lay_out(distinct: &DistinctMeshes<'_>, layout: &mut Layout) -> Vec<Option<usize>> {
    let mut of_plant = |(plant, bones): (usize, Option<&Bones>)| {
        let stored = Cube { corner: Vec3::ZERO, side: 1.0 };
        let Cube { corner, side } = layout.quanta.as_ref().map_or(stored, |quanta| quanta.cube(plant));
        let matrix = |place: Vec3| {
            let Vec3 { x, y, z } = corner - place;
            [side, 0.0, 0.0, 0.0, 0.0, side, 0.0, 0.0, 0.0, 0.0, side, 0.0, x, y, z, 1.0]
        };
        let matrices: Vec<[f32; 16]> = bones?.joints.iter().map(|joint| matrix(joint.place)).collect();
        Some(layout.push_vectors(&matrices, "MAT4"))
    };
    of_plants(distinct).into_iter().enumerate().map(&mut of_plant).collect()
}

/// A tree with joints.
pub(super) struct Rig {
    pub plant: usize,
    /// The node of the joint that all others hang on; those of the others follow it.
    pub first: usize,
}

impl Rig {
    /// Adds the nodes of a plant's joints, which are called `name` and then as the joint is.
    pub fn add(plant: usize, bones: &Bones, name: impl Fn(&str) -> String, nodes: &mut Vec<Node>) -> Self {
        let first = nodes.len();
        nodes.extend(bones.joints.iter().enumerate().map(|(index, joint)| Node {
            name: name(&joint.name),
            translation: Some(bones.arm(index).to_array()),
            ..Node::default()
        }));
        for (index, joint) in bones.joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                nodes[first + parent].children.push(first + index);
            }
        }
        Self { plant, first }
    }

    /// The skin of its joints, whose inverse bind matrices are laid out.
    pub fn skin(&self, bones: &Bones, name: String, inverse_bind_matrices: usize) -> Skin {
        let joints = (self.first..self.first + bones.joints.len()).collect();
        Skin { name, skeleton: self.first, inverse_bind_matrices, joints }
    }
}

/// Adds to an animation how the joints of all trees turn: a sampler for each joint of a plant, a channel for each of a
/// tree.
pub(super) fn animate(
    distinct: &DistinctMeshes<'_>,
    rigs: &[Rig],
    layout: &mut Layout,
    (channels, samplers): (&mut Vec<Channel>, &mut Vec<AnimationSampler>),
) {
    for (plant, bones) in of_plants(distinct).into_iter().enumerate() {
        let Some(bones) = bones else { continue };
        let turning: Vec<usize> = (0..bones.joints.len()).filter(|&joint| bones.turns(joint)).collect();
        let first = samplers.len();
        if !turning.is_empty() {
            let sway = &bones.sway;
            let rate = sway.frames_per_second() as f32;
            let times: Vec<f32> = (0..=sway.frames()).map(|frame| frame as f32 / rate).collect();
            let input = layout.push_numbers(&times, true);
            let turns =
                |joint: usize| (0..=sway.frames()).map(move |frame| bones.turn(joint, frame).to_array());
            let outputs = layout.push_turns(turning.iter().map(|&joint| turns(joint)), times.len());
            let sampler = |output| AnimationSampler { input, interpolation: "LINEAR", output };
            samplers.extend(outputs.map(sampler));
        }
        for rig in rigs.iter().filter(|rig| rig.plant == plant) {
            channels.extend((first..).zip(&turning).map(|(sampler, joint)| Channel {
                sampler,
                target: ChannelTarget { node: rig.first + joint, path: "rotation" },
            }));
        }
    }
}
