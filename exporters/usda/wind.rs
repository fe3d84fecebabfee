//! Wind in USD: primvars for shaders, and blend shapes or joints that a `SkelAnimation` drives.
//!
//! `primvars:wind` is level, phase, sway and flutter; `primvars:windPivot` the pivot and how far the
//! vertex is from it (see [`PartWind`]). Where there is a sway loop, the plant's `Geometry` is a
//! `SkelRoot`. With joints its rig is theirs ([`bones`]); with blend shapes the joints of the rig move no vertex: `UsdSkel` has blend shapes on such prims only. What computes the
//! extent of a `SkelRoot` looks at its joints and not at blend shapes, so that the two joints are the corners of the
//! box in each frame, and all who ask get the same.

use glam::Vec3;
use linden_pipeline::scene::Bounds;
use linden_pipeline::wind::{Motion, PartWind, Sway};

use super::layer::Layer;
use super::mesh::primvar;
use super::syntax::tuple;
use super::{bones, extent};
use crate::ExportError;
use crate::assembly::{WindLoop, swaying};
use crate::writing::distinct::MeshPart;

/// The joints of the rig: the corners of the box round the plant.
const JOINTS: &str = "\"low\", \"high\"";

/// The loop of some meshes.
pub(super) fn sway<'a>(pieces: &[&MeshPart<'a>]) -> Option<&'a Sway> {
    pieces.iter().find_map(|piece| swaying(piece.wind?))
}

/// What stands before the braces of the prim that carries a plant's meshes, and within them before
/// everything else. `pieces` are all that it will carry.
pub(super) fn open_geometry(layer: &mut Layer<'_, '_>, pieces: &[&MeshPart<'_>]) -> Result<(), ExportError> {
    if sway(pieces).is_none() {
        return layer.open("def Scope \"Geometry\"");
    }
    layer.open("def SkelRoot \"Geometry\"")?;
    rest_extent(layer, pieces)
}

/// The extent of a `SkelRoot` at rest.
pub(super) fn rest_extent(layer: &mut Layer<'_, '_>, pieces: &[&MeshPart<'_>]) -> Result<(), ExportError> {
    let Some(rest) = at_rest(pieces) else { return Ok(()) };
    layer.lines(&format!("float3[] extent = {}", corners(rest)))
}

/// The box round some parts at rest.
fn at_rest(pieces: &[&MeshPart<'_>]) -> Option<Bounds> {
    pieces.iter().map(|piece| piece.bounds).reduce(Bounds::union)
}

/// `[(x, y, z), (x, y, z)]`.
pub(super) fn corners(Bounds { min, max }: Bounds) -> String {
    format!("[{}, {}]", tuple(min.to_array()), tuple(max.to_array()))
}

/// A line for each frame from 0 on.
pub(super) fn samples(declaration: &str, of_frames: impl Iterator<Item = String>) -> String {
    let mut text = format!("{declaration}.timeSamples = {{\n");
    for (frame, value) in (0..).zip(of_frames) {
        text += &format!("    {frame}: {value},\n");
    }
    text + "}\n"
}

/// The motions that some mesh has a target for.
fn motions(pieces: &[&MeshPart<'_>]) -> Vec<Motion> {
    let targets = || pieces.iter().filter_map(|piece| piece.wind).flat_map(|wind| &wind.targets);
    Motion::ALL.into_iter().filter(|&motion| targets().any(|target| target.motion == motion)).collect()
}

/// The rig of some meshes and its animation, below `path`.
pub(super) fn write_rig(
    layer: &mut Layer<'_, '_>,
    path: &str,
    sway: &Sway,
    pieces: &[&MeshPart<'_>],
) -> Result<(), ExportError> {
    if let Some(bones) = bones::of(pieces) {
        return bones::write_rig(layer, path, bones, pieces, false);
    }
    let motions = motions(pieces);
    let frames = extent::of_frames(pieces, sway);
    let Some(rest) = at_rest(pieces) else { return Ok(()) };
    layer.lines(&samples("float3[] extent", frames.iter().map(|bounds| corners(*bounds))))?;
    layer.lines("\n")?;
    layer.open("def Skeleton \"WindRig\" (\n    prepend apiSchemas = [\"SkelBindingAPI\"]\n)")?;
    let moved = |at: Vec3| {
        // Doubles: all digits of the floats that the extent has.
        let [x, y, z] = at.to_array().map(f64::from);
        format!("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, {y}, {z}, 1))")
    };
    let still = format!("{}, {}", moved(rest.min), moved(rest.max));
    layer.lines(&format!(
        r#"uniform matrix4d[] bindTransforms = [{still}]
uniform token[] joints = [{JOINTS}]
uniform token purpose = "guide"
uniform matrix4d[] restTransforms = [{still}]
rel skel:animationSource = <{path}/Wind>"#
    ))?;
    layer.close()?;
    layer.open("def SkelAnimation \"Wind\"")?;
    let names: Vec<String> = motions.iter().map(|motion| format!("\"{}\"", motion.name())).collect();
    let weights = (0..=sway.frames()).map(|frame| {
        let weights: Vec<String> =
            motions.iter().map(|&motion| sway.weight(motion, frame).to_string()).collect();
        format!("[{}]", weights.join(", "))
    });
    layer.lines(&format!("uniform token[] blendShapes = [{}]", names.join(", ")))?;
    layer.lines(&samples("float[] blendShapeWeights", weights))?;
    layer.lines(&format!(
        "uniform token[] joints = [{JOINTS}]\nquatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0)]\n\
         half3[] scales = [(1, 1, 1), (1, 1, 1)]"
    ))?;
    layer.lines(&samples("float3[] translations", frames.iter().map(|bounds| corners(*bounds))))?;
    layer.close()
}

/// What a layer with a loop says about time.
pub(super) fn time(WindLoop { frames, frames_per_second: rate }: WindLoop) -> String {
    format!(
        "    endTimeCode = {frames}\n    framesPerSecond = {rate}\n    startTimeCode = 0\n    timeCodesPerSecond = {rate}\n"
    )
}

/// The schemas that a mesh has, also where a joint holds all of it.
pub(super) fn schemas(wind: Option<&PartWind>, has_rig: bool) -> &'static str {
    if has_rig || wind.is_some_and(|wind| !wind.targets.is_empty() || wind.bones.is_some()) {
        r#""MaterialBindingAPI", "SkelBindingAPI""#
    } else {
        r#""MaterialBindingAPI""#
    }
}

/// What a mesh of `count` vertices has of wind; `geometry` is the path of what carries it, `mesh` its own.
pub(super) fn write(
    layer: &mut Layer<'_, '_>,
    wind: &PartWind,
    count: usize,
    geometry: &str,
    mesh: &str,
) -> Result<(), ExportError> {
    if wind.bones.is_some() {
        // Copies behind the mesh's own vertices may have been taken off.
        return bones::write_bindings(layer, &wind.bindings[..count.min(wind.bindings.len())], geometry);
    }
    primvar(layer, "float4[] primvars:wind", &wind.motions)?;
    primvar(layer, "float4[] primvars:windPivot", &wind.pivots)?;
    if wind.targets.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = wind.targets.iter().map(|target| target.motion.name()).collect();
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let paths: Vec<String> = names.iter().map(|name| format!("<{mesh}/{name}>")).collect();
    layer.lines(&format!(
        "rel skel:animationSource = <{geometry}/Wind>
uniform token[] skel:blendShapes = [{}]
rel skel:blendShapeTargets = [{}]
rel skel:skeleton = <{geometry}/WindRig>\n",
        quoted.join(", "),
        paths.join(", ")
    ))?;
    for target in &wind.targets {
        layer.open(&format!("def BlendShape \"{}\"", target.motion.name()))?;
        // What stays where it is (the foot, the wood's inner ends) need not be said.
        let moved: Vec<u32> =
            (0..).zip(&target.offsets).filter(|(_, o)| **o != Vec3::ZERO).map(|(i, _)| i).collect();
        layer.array("uniform vector3f[] offsets", moved.len(), None, |i| {
            target.offsets[moved[i] as usize].to_array()
        })?;
        layer.array("uniform int[] pointIndices", moved.len(), None, |i| moved[i])?;
        layer.close()?;
    }
    Ok(())
}
