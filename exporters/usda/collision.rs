//! Shapes for physics (`UsdPhysics`): capsules, and the crown as a mesh whose convex hull counts. Static: what they
//! belong to is no rigid body. They are guides, which nothing draws unless asked.

use linden_pipeline::Vec3;
use linden_pipeline::scene::Bounds;

use super::layer::Layer;
use super::syntax::{quoted, tuple};
use crate::ExportError;
use crate::collision::{Capsule, Colliders, Solid};

/// How the prim begins that has them.
pub(super) const PRIM_TRACE: &str = "def Scope \"Collision\"";
/// How the line begins that tells the options.
pub(super) const TOLD_TRACE: &str = "custom string userProperties:linden:collision = ";

/// All shapes of a plant; `told` says with which options.
pub(super) fn write(
    layer: &mut Layer<'_, '_>,
    Colliders { capsules, crown }: &Colliders,
    told: &str,
) -> Result<(), ExportError> {
    layer.open(PRIM_TRACE)?;
    layer.lines(&format!("{TOLD_TRACE}{}\n\n", quoted(told)))?;
    for (number, capsule) in capsules.iter().enumerate() {
        write_capsule(layer, number, capsule)?;
    }
    if let Some(crown) = crown {
        write_crown(layer, crown)?;
    }
    layer.close()?;
    layer.lines("\n")
}

fn write_capsule(layer: &mut Layer<'_, '_>, number: usize, capsule: &Capsule) -> Result<(), ExportError> {
    // Readers compute the box from doubles; the float's digits are all of them.
    let (height, radius) = (f64::from(capsule.length_m()), f64::from(capsule.radius_m));
    let (flat, high) = (capsule.radius_m, (0.5 * height + radius) as f32);
    let (at, [x, y, z, w]) = (tuple(capsule.middle().to_array()), capsule.rotation().to_array());
    layer.open(&format!(
        "def Capsule \"capsule_{number:02}\" (\n    prepend apiSchemas = [\"PhysicsCollisionAPI\"]\n)"
    ))?;
    layer.lines(&format!(
        r#"uniform token axis = "Y"
float3[] extent = [{}, {}]
double height = {height}
uniform token purpose = "guide"
double radius = {radius}
quatf xformOp:orient = ({w}, {x}, {y}, {z})
double3 xformOp:translate = {at}
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]"#,
        tuple([-flat, -high, -flat]),
        tuple([flat, high, flat]),
    ))?;
    layer.close()?;
    layer.lines("\n")
}

fn write_crown(layer: &mut Layer<'_, '_>, solid: &Solid) -> Result<(), ExportError> {
    let Some(Bounds { min, max }) = solid.bounds() else { return Ok(()) };
    let Solid { points, triangles } = solid;
    layer.open(
        "def Mesh \"crown\" (\n    prepend apiSchemas = [\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]\n)",
    )?;
    layer.lines(&format!(
        r#"float3[] extent = [{}, {}]
uniform token orientation = "rightHanded"
uniform token physics:approximation = "convexHull"
uniform token purpose = "guide"
uniform token subdivisionScheme = "none""#,
        tuple(min.to_array()),
        tuple(max.to_array()),
    ))?;
    layer.repeated("int[] faceVertexCounts", triangles.len(), 3)?;
    let corners = triangles.as_flattened();
    layer.array("int[] faceVertexIndices", corners.len(), None, |i| corners[i])?;
    layer.array("point3f[] points", points.len(), None, |i| points[i].to_array())?;
    // Flat sides: a normal each.
    layer.array("normal3f[] normals", triangles.len(), Some("uniform"), |i| {
        let [a, b, c] = triangles[i].map(|corner| points[corner as usize]);
        (b - a).cross(c - a).normalize_or(Vec3::Y).to_array()
    })?;
    layer.close()?;
    layer.lines("\n")
}
