//! OBJ with its material library, by the crate `tobj`.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::Path;

use glam::{Affine3A, Vec2, Vec3};
use tobj::{LoadError, LoadOptions};

use super::arrange::{Drawn, arrange};
use super::{Beside, ReadError, picture, shown};
use crate::asset::{Aspect, Asset, Geometry, Material, Mesh, Texture, TextureUse};

pub(super) fn read(asset: &mut Asset, bytes: &[u8], beside: &dyn Beside) -> Result<(), ReadError> {
    let options =
        LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let problems = RefCell::new(Vec::new());
    let library = |path: &Path| {
        let name = path.to_string_lossy();
        match beside.read(&name) {
            Ok(Some(bytes)) => tobj::load_mtl_buf(&mut BufReader::new(bytes.as_slice())),
            Ok(None) => {
                problems.borrow_mut().push(format!("{} is not there", shown(&name)));
                Err(LoadError::OpenFileFailed)
            }
            Err(why) => {
                problems.borrow_mut().push(format!("{}: {why}", shown(&name)));
                Err(LoadError::OpenFileFailed)
            }
        }
    };
    let (models, materials) = tobj::load_obj_buf(&mut BufReader::new(bytes), &options, library)
        .map_err(|error| ReadError::broken("OBJ", error.to_string()))?;
    let problems = problems.into_inner();
    match materials {
        Ok(materials) => add_materials(asset, &materials, beside),
        Err(error) if problems.is_empty() => {
            asset.note(Aspect::Materials, format!("its material library: {error}"));
        }
        Err(_) => {}
    }
    for problem in problems {
        asset.note(Aspect::Materials, format!("its material library {problem}"));
    }
    let mut drawn = Vec::new();
    for model in models {
        let mesh = mesh(model.name, &model.mesh, asset.materials.len())?;
        if mesh.triangles == 0 {
            continue;
        }
        let index = asset.meshes.len();
        let places = vec![Affine3A::IDENTITY];
        drawn.push(Drawn { mesh: index, node: mesh.name.clone(), places, level: None, above: Vec::new() });
        asset.meshes.push(mesh);
    }
    arrange(asset, drawn);
    asset.note(
        Aspect::Alpha,
        "OBJ has no alpha modes: foliage is known by names, and by pictures that cut holes (map_d)",
    );
    asset.note(Aspect::SecondUvs, "OBJ has no second set of texture coordinates");
    Ok(())
}

fn mesh(name: String, mesh: &tobj::Mesh, materials: usize) -> Result<Mesh, ReadError> {
    let triples = |values: &[f32]| values.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<Vec3>>();
    let positions = triples(&mesh.positions);
    let count = positions.len();
    let triangles: Vec<[u32; 3]> = mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    if triangles.iter().flatten().any(|&index| index as usize >= count) {
        return Err(ReadError::broken("OBJ", "a face names a vertex that is not there"));
    }
    let normals = Some(triples(&mesh.normals)).filter(|normals| normals.len() == count);
    let uvs: Vec<Vec2> = mesh.texcoords.chunks_exact(2).map(Vec2::from_slice).collect();
    let uvs = [Some(uvs).filter(|uvs| uvs.len() == count), None];
    Ok(Mesh {
        name,
        material: mesh.material_id.filter(|&material| material < materials),
        vertices: count,
        triangles: triangles.len(),
        geometry: Some(Geometry { positions, normals, uvs, triangles }),
    })
}

fn add_materials(asset: &mut Asset, materials: &[tobj::Material], beside: &dyn Beside) {
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    for material in materials {
        let mut used = |file: Option<&String>| {
            let name = file_name(file?);
            let texture = *known.entry(name.to_owned()).or_insert_with(|| {
                let texture = match beside.read(name) {
                    Ok(Some(bytes)) => picture::texture(asset, name, &bytes),
                    Ok(None) => missing(name, "it is not there".to_owned()),
                    Err(why) => missing(name, why),
                };
                asset.textures.push(texture);
                asset.textures.len() - 1
            });
            Some(TextureUse { texture, set: 0, scale: Vec2::ONE })
        };
        let color = used(material.diffuse_texture.as_ref());
        let dissolve = used(material.dissolve_texture.as_ref());
        let others = [&material.normal_texture, &material.specular_texture, &material.ambient_texture];
        let others = others.into_iter().filter_map(|file| used(file.as_ref())).chain(dissolve).collect();
        asset.materials.push(Material {
            name: material.name.clone(),
            alpha: None,
            is_cut: dissolve.is_some(),
            double_sided: None,
            color,
            others,
        });
    }
}

/// The file of a map, behind its options.
fn file_name(map: &str) -> &str {
    let map = map.trim();
    if map.starts_with('-') { map.rsplit(char::is_whitespace).next().unwrap_or(map) } else { map }
}

pub(super) fn missing(name: &str, why: String) -> Texture {
    Texture { name: shown(name), size: None, problem: Some(why) }
}
