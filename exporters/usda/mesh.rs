//! A mesh with its normals and texture coordinates.

use super::indexed::indexed;
use super::layer::Layer;
use super::syntax::{quoted, tuple};
use super::{nanite, wind};
use linden_pipeline::scene::Mesh;
use linden_pipeline::wind::PartWind;

use crate::ExportError;
use crate::writing::distinct::{DistinctMeshes, MeshPart};

/// The second set of texture coordinates, and how the line begins that has it.
pub(super) const LIGHTMAP: &str = "primvars:st1";
pub(super) const LIGHTMAP_TRACE: &str = "texCoord2f[] primvars:st1";

/// What a mesh is as a prim.
pub(super) struct MeshPrim<'a> {
    /// The path of the prim that it is below.
    pub parent: &'a str,
    /// An identifier.
    pub name: &'a str,
    /// The path of the material that is bound.
    pub material: &'a str,
    /// How it swings.
    pub wind: Option<&'a PartWind>,
    /// The path of a `SkelRoot` with a `Rig` of one joint that all of it is bound to.
    pub rig: Option<&'a str>,
    /// Its class (`UsdSemantics`).
    pub label: Option<&'a str>,
}

/// A mesh.
pub(super) fn write(
    layer: &mut Layer<'_, '_>,
    distinct: &DistinctMeshes<'_>,
    piece: &MeshPart<'_>,
    &MeshPrim { parent, name, material, wind, rig, label }: &MeshPrim<'_>,
) -> Result<(), ExportError> {
    let &MeshPart { ref mesh, bounds, material: named, .. } = piece;
    let material_of = distinct.materials[named].material;
    let head = format!(
        r#"uniform bool doubleSided = {}
float3[] extent = [{}, {}]
uniform token orientation = "rightHanded"
uniform token subdivisionScheme = "none"
rel material:binding = <{material}>
color3f[] primvars:displayColor = [{}] (
    interpolation = "constant"
)"#,
        u8::from(material_of.double_sided),
        tuple(bounds.min.to_array()),
        tuple(bounds.max.to_array()),
        tuple(material_of.base_color),
    );
    let schemas = wind::schemas(wind, rig.is_some());
    let labelled = label.map_or("", |_| ", \"SemanticsLabelsAPI:class\"");
    layer.open(&format!("def Mesh \"{name}\" (\n    prepend apiSchemas = [{schemas}{labelled}]\n)"))?;
    layer.lines(&head)?;
    if let Some(label) = label {
        layer.lines(&format!("token[] semantics:labels:class = [{}]", quoted(label)))?;
    }
    let vertex = Some("vertex");
    let count = mesh.positions.len();
    let uvs = bytemuck::cast_slice(&mesh.uvs);
    // Which values repeat is found one after the other, while the rest is formatted.
    let (written, repeats) = rayon::join(
        || {
            layer.repeated("int[] faceVertexCounts", mesh.triangles.len(), 3)?;
            layer.array("int[] faceVertexIndices", mesh.triangles.len(), None, |i| mesh.triangles[i])?;
            layer.array("point3f[] points", count, None, |i| mesh.positions[i].to_array())?;
            layer.array("normal3f[] normals", count, vertex, |i| mesh.normals[i].to_array())
        },
        || indexed(uvs),
    );
    written?;
    coordinates(layer, "texCoord2f[] primvars:st", mesh, uvs, repeats)?;
    if let Some(set) = &piece.lightmap {
        let values = bytemuck::cast_slice(set);
        coordinates(layer, LIGHTMAP_TRACE, mesh, values, indexed(values))?;
    }
    if let Some(wind) = wind {
        wind::write(layer, wind, count, parent, &format!("{parent}/{name}"))?;
    }
    if let Some(rig) = rig {
        nanite::write_part_binding(layer, count, rig)?;
    }
    layer.close()?;
    layer.lines("\n")
}

/// Texture coordinates, each different pair once where `repeats` has them (of [`indexed`]), with an index for each corner of
/// a face. One for each vertex would say the same in fewer bytes, but three.js takes indices for those of corners whatever
/// `interpolation` says.
fn coordinates(
    layer: &mut Layer<'_, '_>,
    declaration: &str,
    mesh: &Mesh,
    values: &[[f32; 2]],
    repeats: Option<(Vec<[f32; 2]>, Vec<u32>)>,
) -> Result<(), ExportError> {
    let Some((once, indices)) = repeats else {
        return layer.array(declaration, values.len(), Some("vertex"), |i| values[i]);
    };
    layer.array(declaration, once.len(), Some("faceVarying"), |i| once[i])?;
    layer.array(&indices_of(declaration), mesh.triangles.len(), None, |i| {
        let [a, b, c] = mesh.triangles[i];
        [indices[a as usize], indices[b as usize], indices[c as usize]]
    })
}

/// The declaration of the indices into a primvar's values.
fn indices_of(declaration: &str) -> String {
    format!("int[] {}:indices", declaration.rsplit(' ').next().unwrap_or_default())
}

/// A primvar with a value for each vertex, each different one once.
pub(super) fn primvar<const N: usize>(
    layer: &mut Layer<'_, '_>,
    declaration: &str,
    values: &[[f32; N]],
) -> Result<(), ExportError> {
    let vertex = Some("vertex");
    let Some((once, indices)) = indexed(values) else {
        return layer.array(declaration, values.len(), vertex, |i| values[i]);
    };
    layer.array(declaration, once.len(), vertex, |i| once[i])?;
    layer.array(&indices_of(declaration), indices.len(), None, |i| indices[i])
}
