//! Wind in glTF: attributes that linden defines, morph targets, and what vertices are bound to.
//!
//! `_WIND` is level, phase, sway and flutter; `_WINDPIVOT` the pivot and how far the vertex is from it
//! (see [`PartWind`]).
//!
//! Packed, for engines that read no attributes of others: `COLOR_0` is phase, sway, flutter and 1 in bytes (an alpha
//! below 1 would cut leaves away), `TEXCOORD_1` x and z of the pivot, `TEXCOORD_2` its y and a sixteenth of the level,
//! in 16 bits of a cube that the mesh's extras tell. Viewers without a shader for it tint what they show by `COLOR_0`.
//!
//! As pivots in pictures, for Unreal: see [`pivots`](super::pivots).

use linden_pipeline::stage::Stage;
use linden_pipeline::wind::{Binding, Bones, Motion, PartWind};

use super::byte_sink::ByteSink;
use super::document::ComponentType;
use super::pivots::{PivotExtras, Pivots};
use super::quantize::Cube;
use crate::ExportError;
use crate::writing::distinct::{DistinctMeshes, MeshPart, PlantModel};

/// Accessors of a mesh's wind.
#[derive(Clone, Default)]
pub(super) struct WindArrays {
    /// `_WIND` and `_WINDPIVOT`.
    pub attributes: Option<[usize; 2]>,
    /// `COLOR_0`, `TEXCOORD_1` and `TEXCOORD_2`.
    pub packed: Option<[usize; 3]>,
    /// `TEXCOORD_1`, of texels with pivots.
    pub texels: Option<usize>,
    /// `JOINTS_0` and `WEIGHTS_0`.
    pub bindings: Option<[usize; 2]>,
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

/// How vertices are told the wind.
pub(super) enum WindAs {
    /// By vectors of numbers.
    Attributes,
    /// By bytes.
    Packed,
    /// By texels.
    Pivots(Pivots),
}

impl WindAs {
    /// The pictures whose texels a part of a plant names, and which plant it is.
    pub fn pivots(&self, plant: Option<usize>, wind: &PartWind) -> Option<(&Pivots, usize)> {
        match (self, plant) {
            (Self::Pivots(pivots), Some(plant)) if pivots.has(plant, wind) => Some((pivots, plant)),
            _ => None,
        }
    }

    /// What meshes of a plant tell of its pictures.
    pub fn told(&self, plant: usize) -> Option<PivotExtras> {
        match self {
            Self::Pivots(pivots) => pivots.told(plant).cloned(),
            Self::Attributes | Self::Packed => None,
        }
    }
}

/// For each piece the motions that its mesh has targets for. All primitives of a glTF mesh have the same
/// targets (3.7.2.2), and in a forest a plant is one mesh; a tree alone has a mesh for each part.
pub(super) fn motions(stage: &Stage<'_>, distinct: &DistinctMeshes<'_>) -> Vec<Vec<Motion>> {
    let has = |pieces: &[MeshPart<'_>]| -> Vec<Motion> {
        let mut targets = pieces.iter().filter_map(|piece| piece.wind).flat_map(|wind| &wind.targets);
        let targets: Vec<Motion> = targets.by_ref().map(|target| target.motion).collect();
        Motion::ALL.into_iter().filter(|motion| targets.contains(motion)).collect()
    };
    let of_model = |model: &PlantModel<'_>| -> Vec<Vec<Motion>> {
        if stage.is_single() {
            model.parts.iter().map(|piece| has(std::slice::from_ref(piece))).collect()
        } else {
            vec![has(&model.parts); model.parts.len()]
        }
    };
    let mut all: Vec<Vec<Motion>> = distinct.models.iter().flat_map(of_model).collect();
    // Nothing around the plants moves.
    all.resize(distinct.parts().count(), Vec::new());
    all
}

/// Writes the arrays of a part in the order in which the buffer lays them out; pivots in the units of the positions, which are those of a cube
/// where they are in fewer bits.
pub(super) fn write(
    wind: &PartWind,
    cube: Option<Cube>,
    packed: Option<Cube>,
    pivots: Option<(&Pivots, usize)>,
    out: &mut impl ByteSink,
) -> Result<(), ExportError> {
    if let Some(bones) = &wind.bones {
        return write_bindings(bones, &wind.bindings, out);
    }
    match (pivots, packed) {
        (Some((pivots, plant)), _) => pivots.write_uvs(plant, wind, cube.is_some(), out)?,
        (None, Some(cube)) => write_packed(wind, cube, out)?,
        (None, None) => write_whole(wind, cube, out)?,
    }
    // In the order in which a part has them, which is that of `Motion::ALL`.
    wind.targets.iter().try_for_each(|target| out.put(bytemuck::cast_slice(&target.offsets)))
}

/// In which numbers vertices name joints, and bytes of each vertex's.
pub(super) fn joint_type(bones: &Bones) -> (ComponentType, u64) {
    if bones.joints.len() <= 256 { (ComponentType::U8, 4) } else { (ComponentType::U16, 8) }
}

fn write_bindings(bones: &Bones, bindings: &[Binding], out: &mut impl ByteSink) -> Result<(), ExportError> {
    const PIECE: usize = 1 << 15;
    let is_short = joint_type(bones).0 == ComponentType::U8;
    for bindings in bindings.chunks(PIECE) {
        if is_short {
            let joints: Vec<[u8; 4]> =
                bindings.iter().map(|binding| binding.joints.map(|joint| joint as u8)).collect();
            out.put(bytemuck::cast_slice(&joints))?;
        } else {
            let joints: Vec<[u16; 4]> = bindings.iter().map(|binding| binding.joints).collect();
            out.put(bytemuck::cast_slice(&joints))?;
        }
    }
    for bindings in bindings.chunks(PIECE) {
        let weights: Vec<[u8; 4]> = bindings.iter().map(|binding| binding.weights).collect();
        out.put(bytemuck::cast_slice(&weights))?;
    }
    Ok(())
}

/// The largest level that packing tells apart.
const LEVELS: f32 = 16.0;

fn write_packed(wind: &PartWind, cube: Cube, out: &mut impl ByteSink) -> Result<(), ExportError> {
    let byte = |x: f32| libm::roundf(x.clamp(0.0, 1.0) * 255.0) as u8;
    let short = |x: f32| libm::roundf(x.clamp(0.0, 1.0) * 65535.0) as u16;
    let motions: Vec<[u8; 4]> = wind
        .motions
        .iter()
        .map(|&[_, phase, sway, flutter]| [byte(phase), byte(sway), byte(flutter), 255])
        .collect();
    out.put(bytemuck::cast_slice(&motions))?;
    let pivots = || wind.pivots.iter().map(|&pivot| cube.pivot(pivot).map(short));
    let flat: Vec<[u16; 2]> = pivots().map(|[x, _, z, _]| [x, z]).collect();
    out.put(bytemuck::cast_slice(&flat))?;
    let levels = wind.motions.iter().map(|&[level, ..]| short(level / LEVELS));
    let high: Vec<[u16; 2]> = pivots().zip(levels).map(|([_, y, ..], level)| [y, level]).collect();
    out.put(bytemuck::cast_slice(&high))
}

fn write_whole(wind: &PartWind, cube: Option<Cube>, out: &mut impl ByteSink) -> Result<(), ExportError> {
    out.put(bytemuck::cast_slice(&wind.motions))?;
    match cube {
        None => out.put(bytemuck::cast_slice(&wind.pivots)),
        Some(cube) => {
            let pivots: Vec<[f32; 4]> = wind.pivots.iter().map(|&pivot| cube.pivot(pivot)).collect();
            out.put(bytemuck::cast_slice(&pivots))
        }
    }
}
