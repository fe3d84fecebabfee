//! Materials: networks of shaders with a `UsdPreviewSurface`.

use std::collections::BTreeMap;

use glam::Vec2;
use openusd::sdf::{Path, Value};

use super::Materials;
use super::layer::{Layer, number, word};
use super::mesh::pairs;
use crate::asset::{Alpha, Aspect, Asset, Material, Texture, TextureUse};
use crate::read::{Beside, picture, shown};

/// Reads all materials; gives their indices by path.
pub(super) fn read(asset: &mut Asset, layer: &Layer, beside: &dyn Beside) -> Materials {
    let mut materials = Materials::new();
    let mut pictures = BTreeMap::new();
    // The first of each name: all others of it are called by their paths.
    let mut named_first = BTreeMap::new();
    let shaders: Vec<Path> = layer.prims_of("Shader").collect();
    for prim in layer.prims_of("Material") {
        let path = prim.strip_all_variant_selections().as_str().to_owned();
        if materials.contains_key(&path) {
            continue;
        }
        let inside = format!("{prim}/");
        let first = shaders.partition_point(|shader| shader.as_str() < inside.as_str());
        let own: Vec<&Path> =
            shaders[first..].iter().take_while(|shader| shader.as_str().starts_with(&inside)).collect();
        let is = |shader: &&&Path, id: &str| {
            layer.value(shader, "info:id").and_then(|value| word(&value)).as_deref() == Some(id)
        };
        let scale = own.iter().find(|shader| is(shader, "UsdTransform2d"));
        let scale = scale.and_then(|shader| pairs(&*layer.value(shader, "inputs:scale")?)?.first().copied());
        let mut used = BTreeMap::new();
        for shader in own.iter().filter(|shader| is(shader, "UsdUVTexture")) {
            let Some(file) = file(layer, shader) else { continue };
            let texture = *pictures.entry(file.clone()).or_insert_with(|| {
                let texture = texture(asset, &file, beside);
                asset.textures.push(texture);
                asset.textures.len() - 1
            });
            let used_here = TextureUse { texture, set: 0, scale: scale.unwrap_or(Vec2::ONE) };
            used.insert(shader.strip_all_variant_selections().as_str().to_owned(), used_here);
        }
        let mut material =
            Material { name: prim.name().unwrap_or_default().to_owned(), ..Material::default() };
        match own.iter().find(|shader| is(shader, "UsdPreviewSurface")) {
            None => asset.note(Aspect::Alpha, "materials without a UsdPreviewSurface are not read"),
            Some(surface) => {
                let connected = |name: &str| {
                    let path = layer.target(surface, name, "connectionPaths")?;
                    Some(path.split('.').next().unwrap_or_default().to_owned())
                };
                let of = |name: &str| number(&*layer.value(surface, name)?);
                let color = connected("inputs:diffuseColor");
                material.color = color.and_then(|color| used.remove(&color));
                let cutoff = of("inputs:opacityThreshold").unwrap_or(0.0);
                let is_seen_through = connected("inputs:opacity").is_some()
                    || of("inputs:opacity").is_some_and(|opacity| opacity < 1.0);
                material.alpha = Some(match is_seen_through {
                    false => Alpha::Opaque,
                    true if cutoff > 0.0 => Alpha::Mask,
                    true => Alpha::Blend,
                });
            }
        }
        material.others = used.into_values().collect();
        // Names are within a prim: what only looks the same is the same.
        let named = named_first.get(&material.name).copied();
        let known = named.filter(|&known| asset.materials[known] == material);
        if named.is_none() {
            named_first.insert(material.name.clone(), asset.materials.len());
        } else if known.is_none() {
            material.name.clone_from(&path);
        }
        materials.insert(path, known.unwrap_or(asset.materials.len()));
        if known.is_none() {
            asset.materials.push(material);
        }
    }
    materials
}

fn file(layer: &Layer, shader: &Path) -> Option<String> {
    match &*layer.value(shader, "inputs:file")? {
        Value::AssetPath(path) => Some(path.authored_path.clone()),
        other => word(other),
    }
}

fn texture(asset: &mut Asset, file: &str, beside: &dyn Beside) -> Texture {
    match beside.read(file) {
        Ok(Some(bytes)) => picture::texture(asset, file, &bytes),
        Ok(None) => Texture { name: shown(file), size: None, problem: Some("it is not there".to_owned()) },
        Err(why) => Texture { name: shown(file), size: None, problem: Some(why) },
    }
}
