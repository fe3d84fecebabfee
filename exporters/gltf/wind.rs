//! Wind in glTF: attributes of our own, morph targets, and the animation `Wind`.
//!
//! `_WIND` is level, phase, sway and flutter; `_WINDPIVOT` the pivot and how far the vertex is from it
//! (see [`PartWind`]). `COLOR_0` would tint the bark.

use linden::scene::{self, Bounds};
use linden::stage::Stage;
use linden::wind::{Motion, PartWind, Sway};
use serde::Serialize;

use super::buffer::{Chunk, Layout};
use super::document::{Mesh, Node};
use super::quantize::Cube;
use crate::ExportError;
use crate::cast::{Cast, Model, Piece};

/// Accessors of a mesh's wind.
#[derive(Clone, Default)]
pub(super) struct WindArrays {
    /// `_WIND` and `_WINDPIVOT`.
    pub attributes: Option<[usize; 2]>,
    /// The positions of each target.
    pub targets: Vec<usize>,
    /// What they are.
    pub motions: Vec<Motion>,
}

impl WindArrays {
    /// What the targets are called.
    pub fn names(&self) -> Vec<&'static str> {
        self.motions.iter().map(|motion| motion.name()).collect()
    }
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

/// For each piece the motions that its mesh has targets for. All primitives of a glTF mesh have the same
/// targets (3.7.2.2), and in a forest a plant is one mesh; a tree alone has a mesh for each part.
pub(super) fn motions(stage: &Stage<'_>, cast: &Cast<'_>) -> Vec<Vec<Motion>> {
    let has = |pieces: &[Piece<'_>]| -> Vec<Motion> {
        let mut targets = pieces.iter().filter_map(|piece| piece.wind).flat_map(|wind| &wind.targets);
        let targets: Vec<Motion> = targets.by_ref().map(|target| target.motion).collect();
        Motion::ALL.into_iter().filter(|motion| targets.contains(motion)).collect()
    };
    let of_model = |model: &Model<'_>| -> Vec<Vec<Motion>> {
        if stage.is_single() {
            model.pieces.iter().map(|piece| has(std::slice::from_ref(piece))).collect()
        } else {
            vec![has(&model.pieces); model.pieces.len()]
        }
    };
    let mut all: Vec<Vec<Motion>> = cast.models.iter().flat_map(of_model).collect();
    // Nothing around the plants moves.
    all.resize(cast.pieces().count(), Vec::new());
    all
}

/// Lays out a mesh's wind behind its other arrays, with targets for some motions: one that this part lacks
/// is an accessor without a buffer, which is all zero.
pub(super) fn lay_out(
    layout: &mut Layout,
    mesh: &scene::Mesh,
    wind: &PartWind,
    motions: Vec<Motion>,
) -> WindArrays {
    let count = mesh.positions.len();
    let attributes = [layout.push_vertices(count, "VEC4", 16), layout.push_vertices(count, "VEC4", 16)];
    let mut arrays = WindArrays { attributes: Some(attributes), ..WindArrays::default() };
    for &motion in &motions {
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
    }
    WindArrays { motions, ..arrays }
}

/// Writes what [`lay_out`] has laid out; pivots in the units of the positions, which are those of a cube
/// where they are in fewer bits.
pub(super) fn write(wind: &PartWind, cube: Option<Cube>, out: &mut impl Chunk) -> Result<(), ExportError> {
    out.put(bytemuck::cast_slice(&wind.motions))?;
    match cube {
        None => out.put(bytemuck::cast_slice(&wind.pivots))?,
        Some(cube) => {
            let pivots: Vec<[f32; 4]> = wind.pivots.iter().map(|&pivot| cube.pivot(pivot)).collect();
            out.put(bytemuck::cast_slice(&pivots))?;
        }
    }
    // In the order in which a part has them, which is that of `Motion::ALL`.
    wind.targets.iter().try_for_each(|target| out.put(bytemuck::cast_slice(&target.offsets)))
}

/// The loop, if there is one: a channel for each node of a mesh with targets, a sampler for each loop and
/// set of motions.
pub(super) fn animation(
    cast: &Cast<'_>,
    meshes: &[Mesh],
    nodes: &[Node],
    layout: &mut Layout,
) -> Option<Animation> {
    // A mesh has a primitive per piece, in the order of all pieces.
    let mut pieces = cast.pieces().zip(&layout.primitives);
    let loops: Vec<Option<(&Sway, Vec<Motion>)>> = meshes
        .iter()
        .map(|mesh| {
            let own = pieces.by_ref().take(mesh.primitives.len());
            let sways: Vec<_> = own
                .filter_map(|(piece, arrays)| Some((piece.wind?.sway.as_deref()?, &arrays.wind.motions)))
                .filter(|(_, motions)| !motions.is_empty())
                .collect();
            sways.first().map(|(sway, motions)| (*sway, (*motions).clone()))
        })
        .collect();
    let mut animation = Animation { name: "Wind", channels: Vec::new(), samplers: Vec::new() };
    let mut known: Vec<&(&Sway, Vec<Motion>)> = Vec::new();
    for (node, mesh) in nodes.iter().enumerate().filter_map(|(index, node)| Some((index, node.mesh?))) {
        let Some(own) = loops.get(mesh).and_then(Option::as_ref) else { continue };
        let sampler = known.iter().position(|known| *known == own).unwrap_or_else(|| {
            known.push(own);
            animation.samplers.push(sampler(own.0, &own.1, layout));
            known.len() - 1
        });
        animation.channels.push(Channel { sampler, target: ChannelTarget { node, path: "weights" } });
    }
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
