//! Wind in glTF: attributes of our own, morph targets, and the animation `Wind`.
//!
//! `_WIND` is level, phase, sway and flutter; `_WINDPIVOT` the pivot and how far the vertex is from it
//! (see [`PartWind`]). `COLOR_0` would tint the bark.

use linden::scene::{self, Bounds};
use linden::wind::{Motion, PartWind, Sway};
use serde::Serialize;

use super::buffer::{Chunk, Layout};
use super::document::{Mesh, Node};
use crate::ExportError;
use crate::cast::Cast;

/// Accessors of a mesh's wind.
#[derive(Clone, Default)]
pub(super) struct WindArrays {
    /// `_WIND` and `_WINDPIVOT`.
    pub attributes: Option<[usize; 2]>,
    /// The positions of each target.
    pub targets: Vec<usize>,
    /// What they are called.
    pub names: Vec<&'static str>,
}

/// A morph target.
#[derive(Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct MorphTarget {
    pub position: usize,
}

#[derive(Serialize)]
pub(super) struct Animation {
    pub name: &'static str,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Serialize)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: ChannelTarget,
}

#[derive(Serialize)]
pub(super) struct ChannelTarget {
    pub node: usize,
    pub path: &'static str,
}

#[derive(Serialize)]
pub(super) struct AnimationSampler {
    pub input: usize,
    pub interpolation: &'static str,
    pub output: usize,
}

/// Lays out a mesh's wind behind its other arrays. All primitives of a glTF mesh have the same targets
/// (3.7.2.2), and in a forest a plant is one mesh: what a part lacks is an accessor without a buffer,
/// which is all zero.
pub(super) fn lay_out(layout: &mut Layout, mesh: &scene::Mesh, wind: &PartWind) -> WindArrays {
    let count = mesh.positions.len();
    let attributes = [layout.push_vertices(count, "VEC4", 16), layout.push_vertices(count, "VEC4", 16)];
    let mut arrays = WindArrays { attributes: Some(attributes), ..WindArrays::default() };
    if wind.targets.is_empty() {
        return arrays;
    }
    for motion in Motion::ALL {
        let target = wind.targets.iter().find(|own| own.motion == motion);
        let accessor = match target {
            Some(own) => {
                let bounds = Bounds::of(own.offsets.iter().copied());
                let accessor = layout.push_vertices(count, "VEC3", 12);
                layout.accessors[accessor].min = bounds.map(|own| own.min.to_array().to_vec());
                layout.accessors[accessor].max = bounds.map(|own| own.max.to_array().to_vec());
                accessor
            }
            None => layout.push_zeros(count),
        };
        arrays.targets.push(accessor);
        arrays.names.push(motion.name());
    }
    arrays
}

/// Writes what [`lay_out`] has laid out.
pub(super) fn write(wind: &PartWind, out: &mut impl Chunk) -> Result<(), ExportError> {
    out.put(bytemuck::cast_slice(&wind.motions))?;
    out.put(bytemuck::cast_slice(&wind.pivots))?;
    // In the order in which a part has them, which is that of `Motion::ALL`.
    wind.targets.iter().try_for_each(|target| out.put(bytemuck::cast_slice(&target.offsets)))
}

/// The loop, if there is one: a channel for each node of a mesh with targets, a sampler for each loop.
pub(super) fn animation(
    cast: &Cast<'_>,
    meshes: &[Mesh],
    nodes: &[Node],
    layout: &mut Layout,
) -> Option<Animation> {
    // A mesh has a primitive per piece, in the order of all pieces.
    let mut pieces = cast.pieces();
    let sways: Vec<Option<&Sway>> = meshes
        .iter()
        .map(|mesh| {
            let own = pieces.by_ref().take(mesh.primitives.len());
            let sways: Vec<_> = own.filter_map(|piece| piece.wind?.sway.as_deref()).collect();
            sways.first().copied()
        })
        .collect();
    let mut animation = Animation { name: "Wind", channels: Vec::new(), samplers: Vec::new() };
    let mut known: Vec<&Sway> = Vec::new();
    for (node, mesh) in nodes.iter().enumerate().filter_map(|(index, node)| Some((index, node.mesh?))) {
        let Some(sway) = sways.get(mesh).copied().flatten() else { continue };
        let sampler = known.iter().position(|own| *own == sway).unwrap_or_else(|| {
            known.push(sway);
            animation.samplers.push(sampler(sway, layout));
            known.len() - 1
        });
        animation.channels.push(Channel { sampler, target: ChannelTarget { node, path: "weights" } });
    }
    (!animation.channels.is_empty()).then_some(animation)
}

/// A loop's times and the weights of all motions at each.
fn sampler(sway: &Sway, layout: &mut Layout) -> AnimationSampler {
    let rate = sway.frames_per_second() as f32;
    let times: Vec<f32> = (0..=sway.frames()).map(|frame| frame as f32 / rate).collect();
    let weights: Vec<f32> =
        (0..=sway.frames()).flat_map(|frame| Motion::ALL.map(|motion| sway.weight(motion, frame))).collect();
    AnimationSampler {
        input: layout.push_numbers(&times, true),
        interpolation: "LINEAR",
        output: layout.push_numbers(&weights, false),
    }
}
