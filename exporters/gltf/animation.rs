//! The animation `Wind`: the weights of morph targets over time, or the turns of joints.

use linden_pipeline::wind::{Motion, Sway};

use super::bones::{self, Rig};
use super::buffer::Layout;
use super::document::{Animation, AnimationSampler, Channel, ChannelTarget, Mesh, Node};
use crate::writing::distinct::DistinctMeshes;

/// The loop, if there is one: a channel for each node of a mesh with targets, a sampler for each loop and
/// set of motions; a channel for each joint that turns.
pub(super) fn animation(
    distinct: &DistinctMeshes<'_>,
    meshes: &[Mesh],
    nodes: &[Node],
    rigs: &[Rig],
    layout: &mut Layout,
) -> Option<Animation> {
    // A mesh has a primitive per piece, in the order of all pieces.
    let mut pieces = distinct.parts().zip(&layout.primitives);
    let loops: Vec<Option<(&Sway, Vec<Motion>)>> = meshes
        .iter()
        .map(|mesh| {
            let of_mesh = pieces.by_ref().take(mesh.primitives.len());
            let sways: Vec<_> = of_mesh
                .filter_map(|(piece, arrays)| Some((piece.wind?.sway.as_deref()?, &arrays.wind.motions)))
                .filter(|(_, motions)| !motions.is_empty())
                .collect();
            sways.first().map(|(sway, motions)| (*sway, (*motions).clone()))
        })
        .collect();
    let mut animation = Animation { name: "Wind", channels: Vec::new(), samplers: Vec::new() };
    let mut known: Vec<&(&Sway, Vec<Motion>)> = Vec::new();
    for (node, mesh) in nodes.iter().enumerate().filter_map(|(index, node)| Some((index, node.mesh?))) {
        let Some(motion_loop) = loops.get(mesh).and_then(Option::as_ref) else { continue };
        let sampler = known.iter().position(|known| *known == motion_loop).unwrap_or_else(|| {
            known.push(motion_loop);
            animation.samplers.push(sampler(motion_loop.0, &motion_loop.1, layout));
            known.len() - 1
        });
        animation.channels.push(Channel { sampler, target: ChannelTarget { node, path: "weights" } });
    }
    bones::animate(distinct, rigs, layout, (&mut animation.channels, &mut animation.samplers));
    (!animation.channels.is_empty()).then_some(animation)
}

/// A loop's times and the weights of some motions at each.
fn sampler(sway: &Sway, motions: &[Motion], layout: &mut Layout) -> AnimationSampler {
    let rate = sway.frames_per_second() as f32;
    let times: Vec<f32> = (0..=sway.frames()).map(|frame| frame as f32 / rate).collect();
    let weights: Vec<f32> = (0..=sway.frames())
        .flat_map(|frame| motions.iter().map(move |&motion| sway.weight(motion, frame)))
        .collect();
    AnimationSampler {
        input: layout.push_numbers(&times, true),
        interpolation: "LINEAR",
        output: layout.push_numbers(&weights, false),
    }
}
