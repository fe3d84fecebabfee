//! USD: one layer of text or binary, by itself or as the first file of a package (`.usdz`).
//!
//! The crate openusd parses the text. Its reader of binary layers reserves what a file announces, so that a broken one
//! could ask for all memory: [`binary`] reads them instead, into what text becomes. Layers are not composed: of a layer
//! without meshes the one payload that it shows is read in its place, what else a file refers to is noted as unseen.

mod binary;
mod layer;
mod material;
mod mesh;
mod package;
mod payload;

use std::collections::BTreeMap;

use glam::{Affine3A, Quat, Vec3};
use linden_base::monitor::Monitor;

use self::binary::Room;
use self::layer::{Layer, Levels};
use self::package::Package;
use super::arrange::{Drawn, arrange};
use super::{Beside, MOST_PLACES, ReadError};
use crate::asset::{Aspect, Asset};

pub(super) fn read(
    asset: &mut Asset,
    bytes: &[u8],
    beside: &dyn Beside,
    monitor: &dyn Monitor,
) -> Result<(), ReadError> {
    let package = bytes.starts_with(b"PK").then(|| Package::read(bytes)).transpose()?;
    let layer = package.as_ref().map_or(Some(bytes), Package::first).unwrap_or_default();
    let layer = parse(layer, monitor)?;
    match &package {
        Some(package) => payload::read(asset, layer, package, monitor),
        None => payload::read(asset, layer, beside, monitor),
    }
}

/// A layer of text or binary.
fn parse(layer: &[u8], monitor: &dyn Monitor) -> Result<Layer, ReadError> {
    if layer.starts_with(binary::MAGIC) {
        return Ok(Layer::of(binary::parse(layer, &mut Room::new(layer.len(), monitor))?));
    }
    Layer::parse(std::str::from_utf8(layer).map_err(|_| broken("its layer is no UTF-8 text"))?)
}

pub(super) fn broken(problem: impl AsRef<str>) -> ReadError {
    ReadError::broken("USD", problem)
}

pub(super) fn beyond(problem: impl AsRef<str>) -> ReadError {
    ReadError::beyond("USD", problem)
}

/// Meshes and materials of one layer.
fn read_layer(asset: &mut Asset, layer: &Layer, beside: &dyn Beside) -> Result<(), ReadError> {
    let root = root(layer);
    let materials = material::read(asset, layer, beside);
    let (mut drawn, mut left) = (Vec::new(), MOST_PLACES);
    for prim in layer.prims_of("Mesh") {
        let level = match layer.level(&prim) {
            Levels::Hidden => {
                asset.note(
                    Aspect::Geometry,
                    "variants that are not chosen are not looked at, but for levels of detail",
                );
                continue;
            }
            Levels::All => None,
            Levels::One(number) => Some(number),
        };
        let mut read = mesh::read(layer, &prim)?;
        if read.triangles == 0 {
            continue;
        }
        let bound = layer.binding(&prim);
        read.material = bound.and_then(|material| materials.get(&material).copied());
        let places: Vec<Affine3A> =
            layer.places(&prim, asset)?.into_iter().map(|place| root * place).collect();
        left = left.checked_sub(places.len()).ok_or_else(layer::too_many)?;
        let above = layer::above(&prim).filter_map(|above| above.name().map(str::to_owned)).collect();
        drawn.push(Drawn { mesh: asset.meshes.len(), node: read.name.clone(), places, level, above });
        asset.meshes.push(read);
    }
    arrange(asset, drawn);
    Ok(())
}

/// Notes what of a layer is not looked at.
fn note_unseen(asset: &mut Asset, layer: &Layer) {
    for field in ["references", "payload", "inheritPaths", "subLayers"] {
        if layer.has_any(field) {
            asset.note(
                Aspect::Geometry,
                format!("what it takes from other layers and prims ({field}) is not followed"),
            );
        }
    }
    if layer.prims_of("GeomSubset").next().is_some() {
        asset.note(
            Aspect::Materials,
            "parts of meshes with materials of their own (GeomSubset) are not told apart",
        );
    }
}

/// Metres and Y up.
fn root(layer: &Layer) -> Affine3A {
    let metres = layer.root_number("metersPerUnit").unwrap_or(0.01);
    let turn = if layer.root_word("upAxis").as_deref() == Some("Z") {
        Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
    } else {
        Quat::IDENTITY
    };
    Affine3A::from_scale_rotation_translation(Vec3::splat(metres as f32), turn, Vec3::ZERO)
}

/// Materials by their paths, without variants.
type Materials = BTreeMap<String, usize>;
