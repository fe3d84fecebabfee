//! Joints in USD: a `Skeleton`, a `SkelAnimation` with their turns, and meshes that are bound to them.
//!
//! All of it is within the `SkelRoot` that a plant's `Geometry` is.

use glam::{DQuat, DVec3, Vec3};
use linden_pipeline::scene::Bounds;
use linden_pipeline::wind::{Binding, Bones, INFLUENCES};

use super::layer::Layer;
use super::syntax::tuple;
use super::wind::{corners, samples};
use crate::ExportError;
use crate::writing::distinct::MeshPart;

/// Bytes of a turn in a frame, as statements that are read again where a layer is binary.
pub(super) const TURN_BYTES: u64 = 400;

/// The joints of some meshes.
pub(super) fn of<'a>(pieces: &[&MeshPart<'a>]) -> Option<&'a Bones> {
    pieces.iter().find_map(|piece| piece.wind?.bones.as_deref())
}

/// The rig of some meshes and its animation, below `path`; `is_named`, with names besides paths.
pub(super) fn write_rig(
    layer: &mut Layer<'_, '_>,
    path: &str,
    bones: &Bones,
    pieces: &[&MeshPart<'_>],
    is_named: bool,
) -> Result<(), ExportError> {
    let frames = extents(bones, pieces);
    layer.lines(&samples("float3[] extent", frames.map(corners)))?;
    layer.lines("\n")?;
    layer.open("def Skeleton \"WindRig\" (\n    prepend apiSchemas = [\"SkelBindingAPI\"]\n)")?;
    let moved = |at: Vec3| {
        // Doubles: all digits of the floats that they are.
        let [x, y, z] = at.to_array().map(f64::from);
        format!("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1))")
    };
    let listed = |item: &dyn Fn(usize) -> String| -> String {
        (0..bones.joints.len()).map(item).collect::<Vec<_>>().join(", ")
    };
    let mut paths: Vec<String> = Vec::with_capacity(bones.joints.len());
    for joint in &bones.joints {
        let above = joint.parent.map_or_else(String::new, |parent| format!("{}/", paths[parent]));
        paths.push(format!("{above}{}", joint.name));
    }
    let joints = listed(&|joint| format!("\"{}\"", paths[joint]));
    let names = listed(&|joint| format!("\"{}\"", bones.joints[joint].name));
    let names = if is_named { format!("uniform token[] jointNames = [{names}]\n") } else { String::new() };
    let bind = listed(&|joint| moved(bones.joints[joint].place));
    let rest = listed(&|joint| moved(bones.arm(joint)));
    layer.lines(&format!(
        "uniform matrix4d[] bindTransforms = [{bind}]
{names}uniform token[] joints = [{joints}]
uniform token purpose = \"guide\"
uniform matrix4d[] restTransforms = [{rest}]
rel skel:animationSource = <{path}/Wind>"
    ))?;
    layer.close()?;
    layer.open("def SkelAnimation \"Wind\"")?;
    layer.lines(&format!("uniform token[] joints = [{joints}]"))?;
    let turns = (0..=bones.sway.frames()).map(|frame| {
        let turn = |joint: usize| {
            let [x, y, z, w] = bones.turn(joint, frame).to_array();
            format!("({w}, {x}, {y}, {z})")
        };
        format!("[{}]", listed(&turn))
    });
    layer.lines(&samples("quatf[] rotations", turns))?;
    let arms = listed(&|joint| tuple(bones.arm(joint).to_array()));
    let scales = listed(&|_| "(1, 1, 1)".to_owned());
    layer.lines(&format!("half3[] scales = [{scales}]\nfloat3[] translations = [{arms}]"))?;
    layer.close()
}

/// The box round what is bound, in each frame: that of the joints, and as much around it as there is at rest. What
/// computes the extent of a `SkelRoot` does the same (`ComputeExtentsPadding`), so that all who ask get one box.
fn extents(bones: &Bones, pieces: &[&MeshPart<'_>]) -> impl Iterator<Item = Bounds> {
    let rest = Bounds::of(places(bones, None));
    let bound = pieces.iter().filter(|piece| piece.wind.is_some()).map(|piece| piece.bounds);
    let around = |piece: Bounds| {
        let rest = rest.unwrap_or(piece);
        (rest.min - piece.min).max(piece.max - rest.max).max_element()
    };
    let around_m = bound.map(around).fold(0.0, f32::max);
    let still = pieces.iter().filter(|piece| piece.wind.is_none()).map(|piece| piece.bounds);
    let still = still.reduce(Bounds::union);
    (0..=bones.sway.frames()).filter_map(move |frame| {
        let joints = Bounds::of(places(bones, Some(frame)))?;
        let padded = Bounds { min: joints.min - around_m, max: joints.max + around_m };
        Some(still.map_or(padded, |still| still.union(padded)))
    })
}

/// Where the joints are at a frame, or at rest: along their arms as readers of the file go, in double precision.
fn places(bones: &Bones, frame: Option<u32>) -> Vec<Vec3> {
    let mut pose: Vec<(DQuat, DVec3)> = Vec::with_capacity(bones.joints.len());
    for (index, joint) in bones.joints.iter().enumerate() {
        let (turn, place) = joint.parent.map_or((DQuat::IDENTITY, DVec3::ZERO), |parent| pose[parent]);
        let own = frame.map_or(DQuat::IDENTITY, |frame| bones.turn(index, frame).as_dquat().normalize());
        pose.push((turn * own, place + turn * bones.arm(index).as_dvec3()));
    }
    pose.iter().map(|(_, place)| place.as_vec3()).collect()
}

/// How many joints a vertex is bound to at most.
pub(super) fn influences(bindings: &[Binding]) -> usize {
    let count = |binding: &Binding| binding.weights.iter().rposition(|weight| *weight > 0).unwrap_or(0) + 1;
    bindings.iter().map(count).max().unwrap_or(1).min(INFLUENCES)
}

/// What binds a mesh; `geometry` is the path of what carries it.
pub(super) fn write_bindings(
    layer: &mut Layer<'_, '_>,
    bindings: &[Binding],
    geometry: &str,
) -> Result<(), ExportError> {
    let each = influences(bindings);
    let count = bindings.len() * each;
    layer.elements("int[] primvars:skel:jointIndices", count, each as u32, |i| {
        u32::from(bindings[i / each].joints[i % each])
    })?;
    layer.elements("float[] primvars:skel:jointWeights", count, each as u32, |i| {
        f32::from(bindings[i / each].weights[i % each]) / 255.0
    })?;
    layer.lines(&format!(
        "matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
rel skel:skeleton = <{geometry}/WindRig>"
    ))
}
