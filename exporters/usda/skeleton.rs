//! The skeleton as curves.

use glam::Vec3;
use linden_pipeline::scene::Bounds;
use linden_pipeline::skeleton::{Axis, NO_PARENT, Skeleton};

use super::layer::Layer;
use super::syntax::tuple;
use crate::ExportError;

/// Each axis as a chain of straight pieces from the node that it leaves from, as wide as the wood.
pub(super) fn write(layer: &mut Layer<'_, '_>, skeleton: &Skeleton, name: &str) -> Result<(), ExportError> {
    // Foot (where the axis leaves its parent) and nodes; a curve needs two points.
    let foot = |axis: &Axis| (axis.parent != NO_PARENT).then_some(axis.parent);
    let mut axes = Vec::with_capacity(skeleton.axes.len());
    let mut nodes = Vec::with_capacity(skeleton.positions.len() + skeleton.axes.len());
    let mut radii = Vec::with_capacity(nodes.capacity());
    for axis in &skeleton.axes {
        let nodes_of_axis = skeleton.nodes_of(axis);
        if nodes_of_axis.len() + usize::from(foot(axis).is_some()) < 2 || nodes_of_axis.is_empty() {
            continue;
        }
        axes.push((axis, (nodes_of_axis.len() + usize::from(foot(axis).is_some())) as u32));
        nodes.extend(foot(axis));
        nodes.extend(nodes_of_axis);
        // At its foot an axis is as thick as itself, not as the trunk that it leaves.
        let thickness = nodes_of_axis.iter().map(|&node| skeleton.radii[node as usize]);
        radii.extend(foot(axis).and(thickness.clone().next()).into_iter().chain(thickness));
    }
    let points = nodes.iter().map(|&node| skeleton.positions[node as usize]);
    let Some(Bounds { min, max }) = Bounds::of(points) else { return Ok(()) };
    // By the widest curve all round, as UsdGeomCurves computes it.
    let reach = Vec3::splat(radii.iter().copied().fold(0.0, f32::max));
    let head = format!(
        r#"float3[] extent = [{}, {}]
uniform token purpose = "guide"
uniform token type = "linear"
uniform token wrap = "nonperiodic""#,
        tuple((min - reach).to_array()),
        tuple((max + reach).to_array()),
    );
    layer.open(&format!("def BasisCurves \"{name}\""))?;
    layer.lines(&head)?;
    let node = |i: usize| nodes[i] as usize;
    layer.array("int[] curveVertexCounts", axes.len(), None, |i| axes[i].1)?;
    layer.array("point3f[] points", nodes.len(), None, |i| skeleton.positions[node(i)].to_array())?;
    layer.array("float[] widths", nodes.len(), Some("vertex"), |i| 2.0 * radii[i])?;
    layer.array("int[] primvars:linden:order", axes.len(), Some("uniform"), |i| axes[i].0.order)?;
    layer.array("int[] primvars:linden:birth", nodes.len(), Some("vertex"), |i| {
        skeleton.births[node(i)].min(i32::MAX as u32)
    })?;
    layer.close()?;
    layer.lines("\n")
}
