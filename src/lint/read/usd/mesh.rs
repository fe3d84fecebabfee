//! A mesh: polygons become triangles, and what is said for each corner divides vertices whose corners differ.

use std::collections::HashMap;
use std::hash::Hash;

use glam::{Vec2, Vec3};
use openusd::sdf::{Path, Value};

use super::layer::Layer;
use super::{ReadError, broken};
use crate::asset::{Geometry, Mesh};

/// Values of a mesh.
struct Primvar<T> {
    values: Vec<T>,
    indices: Option<Vec<i32>>,
    /// A value for each corner rather than for each vertex.
    is_of_corners: bool,
}

impl<T: Copy + Default> Primvar<T> {
    /// The value of a vertex and a corner.
    fn at(&self, vertex: usize, corner: usize) -> T {
        let index = if self.is_of_corners { corner } else { vertex };
        let index =
            self.indices.as_ref().map_or(Some(index), |indices| usize::try_from(*indices.get(index)?).ok());
        index.and_then(|index| self.values.get(index).copied()).unwrap_or_default()
    }
}

pub(super) fn read(layer: &Layer, prim: &Path) -> Result<Mesh, ReadError> {
    let name = prim.name().unwrap_or_default().to_owned();
    let integers = |name: &str| match layer.value(prim, name).as_deref() {
        Some(Value::IntVec(list)) => list.clone(),
        _ => Vec::new(),
    };
    let points = layer.value(prim, "points").and_then(|value| vectors(&value)).unwrap_or_default();
    let (counts, named) = (integers("faceVertexCounts"), integers("faceVertexIndices"));
    let vertices: Option<Vec<u32>> = named
        .iter()
        .map(|&corner| u32::try_from(corner).ok().filter(|&corner| (corner as usize) < points.len()))
        .collect();
    let vertices =
        vertices.ok_or_else(|| broken(format!("{name}: a face names a vertex that is not there")))?;
    let normals = primvar(layer, prim, "primvars:normals", vectors)
        .or_else(|| primvar(layer, prim, "normals", vectors));
    let [first, second] = uvs(layer, prim);
    let split = normals.as_ref().is_some_and(|normals| normals.is_of_corners)
        || [&first, &second].into_iter().flatten().any(|uvs| uvs.is_of_corners);
    // Which vertex and which corner each of ours is, and which of ours each corner is.
    let (sources, corners) = if split {
        divided(&vertices, |vertex, corner| {
            let normal =
                normals.as_ref().map(|normals| normals.at(vertex, corner).to_array().map(f32::to_bits));
            let uv = |uvs: &Option<Primvar<Vec2>>| {
                uvs.as_ref().map(|uvs| uvs.at(vertex, corner).to_array().map(f32::to_bits))
            };
            (normal, uv(&first), uv(&second))
        })
    } else {
        ((0..points.len()).map(|vertex| (vertex, vertex)).collect(), vertices)
    };
    let is_left = layer
        .value(prim, "orientation")
        .is_some_and(|value| super::layer::word(&value).as_deref() == Some("leftHanded"));
    let (mut triangles, mut at) = (Vec::new(), 0_usize);
    for count in counts {
        let count = usize::try_from(count).unwrap_or(0);
        let end = at.checked_add(count).filter(|&end| end <= corners.len());
        let end = end.ok_or_else(|| broken(format!("{name}: faces have more corners than are listed")))?;
        for i in 1..count.saturating_sub(1) {
            let [a, b, c] = [at, at + i, at + i + 1].map(|corner| corners[corner]);
            triangles.push(if is_left { [a, c, b] } else { [a, b, c] });
        }
        at = end;
    }
    let pairs = |uvs: Option<Primvar<Vec2>>| {
        uvs.map(|uvs| sources.iter().map(|&(vertex, corner)| uvs.at(vertex, corner)).collect())
    };
    let geometry = Geometry {
        normals: normals
            .map(|normals| sources.iter().map(|&(vertex, corner)| normals.at(vertex, corner)).collect()),
        uvs: [pairs(first), pairs(second)],
        positions: sources.iter().map(|&(vertex, _)| points[vertex]).collect(),
        triangles,
    };
    Ok(Mesh {
        name,
        material: None,
        vertices: geometry.positions.len(),
        triangles: geometry.triangles.len(),
        geometry: Some(geometry),
    })
}

/// A vertex for each that corners name with the same values: the vertex and the first corner that each is, and the one of
/// each corner.
fn divided<V: Eq + Hash>(
    vertices: &[u32],
    values: impl Fn(usize, usize) -> V,
) -> (Vec<(usize, usize)>, Vec<u32>) {
    let mut sources = Vec::new();
    let mut known = HashMap::new();
    let corners = vertices.iter().enumerate().map(|(corner, &vertex)| {
        let vertex = vertex as usize;
        *known.entry((vertex, values(vertex, corner))).or_insert_with(|| {
            sources.push((vertex, corner));
            sources.len() as u32 - 1
        })
    });
    let corners = corners.collect();
    (sources, corners)
}

/// The first two sets of texture coordinates: `st` before all others.
fn uvs(layer: &Layer, prim: &Path) -> [Option<Primvar<Vec2>>; 2] {
    let mut names: Vec<&str> = layer
        .attributes(prim)
        .filter(|name| name.starts_with("primvars:") && !name.ends_with(":indices"))
        .filter(|name| layer.value(prim, name).and_then(|value| pairs(&value)).is_some())
        .collect();
    names.sort_unstable_by_key(|name| (*name != "primvars:st", *name));
    let mut sets = names.into_iter().filter_map(|name| primvar(layer, prim, name, pairs));
    [sets.next(), sets.next()]
}

fn primvar<T>(
    layer: &Layer,
    prim: &Path,
    name: &str,
    read: fn(&Value) -> Option<Vec<T>>,
) -> Option<Primvar<T>> {
    let values = layer.value(prim, name).and_then(|value| read(&value))?;
    let indices = match layer.value(prim, &format!("{name}:indices")).as_deref() {
        Some(Value::IntVec(indices)) => Some(indices.clone()),
        _ => None,
    };
    let is_of_corners = match layer.interpolation(prim, name).as_deref() {
        Some("faceVarying") => true,
        Some("vertex" | "varying") => false,
        None => name == "normals",
        Some(_) => return None,
    };
    // The schema's default is a value for each vertex.
    let is_of_corners = is_of_corners && layer.interpolation(prim, name).is_some();
    Some(Primvar { values, indices, is_of_corners })
}

pub(super) fn vectors(value: &Value) -> Option<Vec<Vec3>> {
    Some(match value {
        Value::Vec3fVec(list) => list.iter().map(|v| Vec3::new(v.x, v.y, v.z)).collect(),
        Value::Vec3dVec(list) => list.iter().map(|v| Vec3::new(v.x as f32, v.y as f32, v.z as f32)).collect(),
        Value::Vec3hVec(list) => {
            list.iter().map(|v| Vec3::new(v.x.to_f32(), v.y.to_f32(), v.z.to_f32())).collect()
        }
        Value::Vec3f(v) => vec![Vec3::new(v.x, v.y, v.z)],
        Value::Vec3d(v) => vec![Vec3::new(v.x as f32, v.y as f32, v.z as f32)],
        _ => return None,
    })
}

pub(super) fn pairs(value: &Value) -> Option<Vec<Vec2>> {
    Some(match value {
        Value::Vec2fVec(list) => list.iter().map(|v| Vec2::new(v.x, v.y)).collect(),
        Value::Vec2dVec(list) => list.iter().map(|v| Vec2::new(v.x as f32, v.y as f32)).collect(),
        Value::Vec2hVec(list) => list.iter().map(|v| Vec2::new(v.x.to_f32(), v.y.to_f32())).collect(),
        Value::Vec2f(v) => vec![Vec2::new(v.x, v.y)],
        _ => return None,
    })
}
