//! Wind in USD: primvars for shaders, and blend shapes that a `SkelAnimation` drives.
//!
//! `primvars:wind` is level, phase, sway and flutter; `primvars:windPivot` the pivot and how far the
//! vertex is from it (see [`PartWind`]). Where there is a sway loop, the plant's `Geometry` is a
//! `SkelRoot` with a rig of one joint that moves nothing: `UsdSkel` has blend shapes on such prims only.

use linden_pipeline::scene::Bounds;
use linden_pipeline::wind::{Motion, PartWind, Sway};

use super::layer::{Layer, vector};
use super::syntax::tuple;
use crate::ExportError;
use crate::writing::distinct::MeshPart;

/// The loop of some meshes.
pub(super) fn sway<'a>(pieces: &[&MeshPart<'a>]) -> Option<&'a Sway> {
    pieces.iter().find_map(|piece| piece.wind?.sway.as_deref())
}

/// What stands before the braces of the prim that carries a plant's meshes, and within them before
/// everything else. `pieces` are all that it will carry.
pub(super) fn open_geometry(layer: &mut Layer<'_, '_>, pieces: &[&MeshPart<'_>]) -> Result<(), ExportError> {
    if sway(pieces).is_none() {
        return layer.open("def Scope \"Geometry\"");
    }
    layer.open("def SkelRoot \"Geometry\"")?;
    let Some(Bounds { min, max }) = pieces.iter().map(|piece| piece.bounds).reduce(Bounds::union) else {
        return Ok(());
    };
    layer.lines(&format!("float3[] extent = [{}, {}]", tuple(min.to_array()), tuple(max.to_array())))
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
    let motions = motions(pieces);
    layer.open("def Skeleton \"WindRig\" (\n    prepend apiSchemas = [\"SkelBindingAPI\"]\n)")?;
    let still = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))";
    layer.lines(&format!(
        r#"uniform matrix4d[] bindTransforms = [{still}]
uniform token[] joints = ["foot"]
uniform token purpose = "guide"
uniform matrix4d[] restTransforms = [{still}]
rel skel:animationSource = <{path}/Wind>"#
    ))?;
    layer.close()?;
    layer.open("def SkelAnimation \"Wind\"")?;
    let mut text = format!(
        "uniform token[] blendShapes = [{}]\nfloat[] blendShapeWeights.timeSamples = {{\n",
        motions.iter().map(|motion| format!("\"{}\"", motion.name())).collect::<Vec<_>>().join(", ")
    );
    for frame in 0..=sway.frames() {
        let weights: Vec<String> =
            motions.iter().map(|&motion| sway.weight(motion, frame).to_string()).collect();
        text += &format!("    {frame}: [{}],\n", weights.join(", "));
    }
    text += "}\nuniform token[] joints = [\"foot\"]\nquatf[] rotations = [(1, 0, 0, 0)]\n";
    text += "half3[] scales = [(1, 1, 1)]\nfloat3[] translations = [(0, 0, 0)]";
    layer.lines(&text)?;
    layer.close()
}

/// What a layer with a loop says about time.
pub(super) fn time(sway: &Sway) -> String {
    let rate = sway.frames_per_second();
    format!(
        "    endTimeCode = {}\n    framesPerSecond = {rate}\n    startTimeCode = 0\n    timeCodesPerSecond = {rate}\n",
        sway.frames()
    )
}

/// The schemas that a mesh has.
pub(super) fn schemas(wind: Option<&PartWind>) -> &'static str {
    if wind.is_some_and(|wind| !wind.targets.is_empty()) {
        r#""MaterialBindingAPI", "SkelBindingAPI""#
    } else {
        r#""MaterialBindingAPI""#
    }
}

/// What a mesh has of wind; `geometry` is the path of what carries it, `mesh` its own.
pub(super) fn write(
    layer: &mut Layer<'_, '_>,
    wind: &PartWind,
    geometry: &str,
    mesh: &str,
) -> Result<(), ExportError> {
    let vertex = Some("vertex");
    let count = wind.motions.len();
    layer.array("float4[] primvars:wind", count, vertex, |text, i| vector(text, wind.motions[i]))?;
    layer.array("float4[] primvars:windPivot", count, vertex, |text, i| vector(text, wind.pivots[i]))?;
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
            (0..).zip(&target.offsets).filter(|(_, o)| **o != glam::Vec3::ZERO).map(|(i, _)| i).collect();
        layer.array("uniform vector3f[] offsets", moved.len(), None, |text, i| {
            vector(text, target.offsets[moved[i] as usize].to_array());
        })?;
        layer.array("uniform int[] pointIndices", moved.len(), None, |text, i| text.integer(moved[i]))?;
        layer.close()?;
    }
    Ok(())
}
