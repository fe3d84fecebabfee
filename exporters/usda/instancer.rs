//! A few prototypes in many places, as a `PointInstancer`.

use linden_pipeline::foliage::Placement;
use linden_pipeline::scene::Bounds;

use super::layer::Layer;
use super::syntax::tuple;
use crate::ExportError;

/// Digits that readers keep: a half has eleven bits.
fn to_half(x: f32) -> f32 {
    libm::roundf(x * 1e5) / 1e5
}

/// What stands within the instancer's braces before its prototypes, whose paths are given: which of
/// them is where.
pub(super) fn write(
    layer: &mut Layer<'_, '_>,
    bounds: Option<Bounds>,
    prototypes: &[String],
    placed: &[(u32, Placement)],
) -> Result<(), ExportError> {
    if let Some(Bounds { min, max }) = bounds {
        layer.lines(&format!("float3[] extent = [{}, {}]", tuple(min.to_array()), tuple(max.to_array())))?;
    }
    let paths: Vec<String> = prototypes.iter().map(|path| format!("<{path}>")).collect();
    layer.lines(&format!("rel prototypes = [{}]", paths.join(", ")))?;
    let count = placed.len();
    layer.array("int[] protoIndices", count, None, |i| placed[i].0)?;
    layer.array("point3f[] positions", count, None, |i| placed[i].1.position.to_array())?;
    layer.array("quath[] orientations", count, None, |i| {
        let turn = placed[i].1.rotation;
        [turn.w, turn.x, turn.y, turn.z].map(to_half)
    })?;
    layer.array("float3[] scales", count, None, |i| [placed[i].1.scale; 3])?;
    layer.lines("\n")
}
