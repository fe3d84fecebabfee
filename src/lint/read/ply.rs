//! PLY: one mesh, with normals and texture coordinates where the vertices have them.

use glam::{Affine3A, Vec2, Vec3};
use linden_base::input::read_ply_with;
use linden_base::monitor::Monitor;

use super::ReadError;
use super::arrange::{Drawn, arrange};
use crate::asset::{Aspect, Asset, Geometry, Mesh};

/// Properties as writers call them: normals, then texture coordinates.
const NAMES: [&str; 9] = ["nx", "ny", "nz", "s", "t", "u", "v", "texture_u", "texture_v"];

pub(super) fn read(asset: &mut Asset, bytes: &[u8], monitor: &dyn Monitor) -> Result<(), ReadError> {
    let (data, columns) = read_ply_with(bytes, &NAMES, monitor)?;
    let column = |index: usize| columns.get(index).and_then(Option::as_ref);
    let normals = match (column(0), column(1), column(2)) {
        (Some(x), Some(y), Some(z)) => {
            Some(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vec3::new(x, y, z)).collect())
        }
        _ => None,
    };
    let uvs = [3, 5, 7].into_iter().find_map(|first| Some((column(first)?, column(first + 1)?)));
    let uvs = uvs.map(|(u, v)| u.iter().zip(v).map(|(&u, &v)| Vec2::new(u, v)).collect());
    let geometry = Geometry {
        positions: data.positions.iter().map(|at| at.as_vec3()).collect(),
        normals,
        uvs: [uvs, None],
        triangles: data.faces,
    };
    if geometry.triangles.is_empty() {
        return Ok(());
    }
    asset.meshes.push(Mesh {
        name: "mesh".to_owned(),
        material: None,
        vertices: geometry.positions.len(),
        triangles: geometry.triangles.len(),
        geometry: Some(geometry),
    });
    let stem = asset.name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let drawn =
        Drawn { mesh: 0, node: stem, places: vec![Affine3A::IDENTITY], level: None, above: Vec::new() };
    arrange(asset, vec![drawn]);
    for (aspect, what) in [
        (Aspect::Materials, "materials"),
        (Aspect::Alpha, "alpha modes: which part is foliage is not known"),
        (Aspect::Pictures, "pictures"),
        (Aspect::Names, "names"),
        (Aspect::SecondUvs, "second set of texture coordinates"),
        (Aspect::Colliders, "parts"),
    ] {
        asset.note(aspect, format!("PLY has no {what}"));
    }
    Ok(())
}
