//! Several plants, or one with what stands around it, as an assembly.
//!
//! ```text
//! /wood                  Xform, assembly, the recipe
//!     /Prototypes/oak_1     class: each distinct plant once
//!     /Trees                Xform, group
//!         /oak_1_1            instanceable reference to a prototype
//!     /Setting              Xform, group: Camera, Ground and what covers it, Sun, Sky
//! ```
//!
//! With `instances`, `Trees` is a `PointInstancer` that holds its prototypes.

use std::collections::BTreeMap;

use linden_pipeline::foliage::Placement;
use linden_pipeline::scene::Bounds;
use linden_pipeline::stage::{Camera, Place, Setting};

use super::layer::Layer;
use super::mesh::MeshPrim;
use super::plant::{Component, Head, Variants};
use super::syntax::{Names, beside, identifier, quoted, tuple};
use super::{Writing, instancer, material, mesh};
use crate::ExportError;
use crate::batch::whole_bounds;
use crate::writing::distinct::MeshPart;

/// Lux by unit of intensity. USD leaves the unit to the renderer's exposure: with this one, hazy sunshine
/// on white paper is a little above 1 where nobody has set one.
const LUX_PER_UNIT: f32 = 2732.0;

/// How the line begins that tells what the setting was asked for with.
pub(super) const SETTING_TRACE: &str = "custom string userProperties:linden:setting = ";
/// How the instancers of the ground's cover begin, which are there whatever the options.
pub(super) const COVER_TRACE: &str = "def PointInstancer \"Ground_";
/// What is written last where there is a setting.
pub(super) const LAST_TRACE: &str = "def DomeLight ";

/// Everything below the layer's metadata.
pub(super) fn write(layer: &mut Layer<'_, '_>, writing: &Writing<'_>, root: &str) -> Result<(), ExportError> {
    let stage = writing.stage;
    let variants = Variants::default();
    Head {
        prim: root,
        name: &stage.name,
        recipe: &stage.recipe,
        kind: "assembly",
        nanite: None,
        variants,
        // Without the ground, which reaches to the horizon: who frames all wants to see the plants.
        bounds: whole_bounds(stage),
        is_labelled: false,
        foot_in_file: crate::recipe::foot_in_file(stage),
    }
    .open(layer)?;
    let mut names = Names::default();
    let prims: Vec<String> = stage.plants.iter().map(|plant| names.unique(&plant.name)).collect();
    if let [place] = stage.places.as_slice() {
        open_group(layer, "Trees")?;
        let path = format!("/{root}/Trees/{}", prims[place.plant]);
        write_plant(layer, writing, place.plant, &prims[place.plant], path, Some(place))?;
        layer.close()?;
    } else if writing.with_instances {
        write_instancer(layer, writing, root, &prims)?;
    } else {
        layer.open("class \"Prototypes\"")?;
        for (plant, prim) in prims.iter().enumerate() {
            write_plant(layer, writing, plant, prim, format!("/{root}/Prototypes/{prim}"), None)?;
        }
        layer.close()?;
        layer.lines("\n")?;
        open_group(layer, "Trees")?;
        for (number, place) in (1..).zip(&stage.places) {
            let prim = &prims[place.plant];
            let name = names.unique(&format!("{prim}_{number}"));
            layer.open(&format!(
                "def Xform \"{name}\" (\n    instanceable = true\n    prepend references = \
                 </{root}/Prototypes/{prim}>\n)"
            ))?;
            layer.lines(&transform(place))?;
            layer.close()?;
            layer.lines("\n")?;
        }
        layer.close()?;
    }
    if let Some(setting) = &stage.setting {
        layer.lines("\n")?;
        write_setting(layer, writing, setting, root)?;
    }
    layer.close()
}

fn open_group(layer: &mut Layer<'_, '_>, name: &str) -> Result<(), ExportError> {
    layer.open(&format!("def Xform \"{name}\" (\n    kind = \"group\"\n)"))
}

fn write_plant(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    plant: usize,
    prim: &str,
    path: String,
    place: Option<&Place>,
) -> Result<(), ExportError> {
    let stage_plant = &writing.stage.plants[plant];
    let component = Component::new(writing, plant, path);
    let recipe = stage_plant.levels().first().map_or("", |level| level.scene.recipe.as_str());
    let variants = component.variants();
    Head {
        prim,
        name: &stage_plant.name,
        recipe,
        kind: "component",
        nanite: None,
        variants,
        bounds: component.bounds(),
        is_labelled: writing.said.labels,
        foot_in_file: None,
    }
    .open(layer)?;
    if let Some(place) = place.filter(|place| !place.is_origin()) {
        layer.lines(&transform(place))?;
        layer.lines("\n")?;
    }
    component.write(layer)?;
    layer.close()?;
    layer.lines("\n")
}

/// Where a plant stands.
fn transform(place: &Place) -> String {
    format!(
        r#"double3 xformOp:translate = {}
float xformOp:rotateY = {}
float3 xformOp:scale = {}
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY", "xformOp:scale"]"#,
        tuple(place.position.to_array()),
        place.turn_rad.to_degrees(),
        tuple([place.scale; 3]),
    )
}

fn write_instancer(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    root: &str,
    prims: &[String],
) -> Result<(), ExportError> {
    let placed = writing.stage.places.iter().map(|place| {
        let Place { position, scale, .. } = *place;
        (place.plant as u32, Placement { position, rotation: place.rotation(), scale })
    });
    layer.open("def PointInstancer \"Trees\" (\n    kind = \"group\"\n)")?;
    let paths: Vec<String> = prims.iter().map(|prim| format!("/{root}/Trees/Prototypes/{prim}")).collect();
    instancer::write(layer, writing.stage.bounds(), &paths, &placed.collect::<Vec<_>>())?;
    // Models stand below groups, without a gap.
    layer.open("def Scope \"Prototypes\" (\n    kind = \"group\"\n)")?;
    for (plant, prim) in prims.iter().enumerate() {
        write_plant(layer, writing, plant, prim, format!("/{root}/Trees/Prototypes/{prim}"), None)?;
    }
    layer.close()?;
    layer.close()
}

fn write_setting(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    setting: &Setting,
    root: &str,
) -> Result<(), ExportError> {
    open_group(layer, "Setting")?;
    if !setting.surroundings.is_usual() {
        let told = quoted(&setting.surroundings.to_string());
        layer.lines(&format!("{SETTING_TRACE}{told}\n\n"))?;
    }
    write_camera(layer, &setting.camera)?;
    for cover in writing.distinct.cover.chunk_by(|a, b| a.copied_part() == b.copied_part()) {
        write_cover(layer, writing, cover, root)?;
    }
    if let Some(piece) = &writing.distinct.ground {
        layer.open("def Xform \"Ground\" (\n    kind = \"component\"\n)")?;
        write_pieces(layer, writing, std::slice::from_ref(piece), &format!("/{root}/Setting/Ground"))?;
        layer.close()?;
        layer.lines("\n")?;
    }
    write_lights(layer, writing, setting)?;
    layer.close()
}

/// The patches of a kind of cover as the prototypes of an instancer.
fn write_cover(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    patches: &[MeshPart<'_>],
    root: &str,
) -> Result<(), ExportError> {
    let copies = || patches.iter().filter_map(|patch| patch.copies.as_ref());
    let kind = patches.first().and_then(MeshPart::copied_part).unwrap_or_default();
    let name = format!("Ground_{kind}");
    let path = format!("/{root}/Setting/{name}/Prototypes");
    let seen = copies().map(|copies| copies.seen).reduce(Bounds::union);
    let paths: Vec<String> =
        patches.iter().map(|patch| format!("{path}/Geometry/{}", identifier(&patch.name))).collect();
    let placed: Vec<(u32, Placement)> = (0..)
        .zip(copies())
        .flat_map(|(index, copies)| copies.placements.iter().map(move |at| (index, *at)))
        .collect();
    layer.open(&format!("def PointInstancer \"{name}\" (\n    kind = \"group\"\n)"))?;
    instancer::write(layer, seen, &paths, &placed)?;
    layer.open("def Scope \"Prototypes\"")?;
    write_pieces(layer, writing, patches, &path)?;
    layer.close()?;
    layer.close()?;
    layer.lines("\n")
}

/// Meshes and their materials below the prim at a path.
fn write_pieces(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    pieces: &[MeshPart<'_>],
    path: &str,
) -> Result<(), ExportError> {
    let mut names = Names::default();
    let mut materials: BTreeMap<usize, String> = BTreeMap::new();
    for piece in pieces {
        let material = &writing.distinct.materials[piece.material].name;
        materials.entry(piece.material).or_insert_with(|| names.unique(material));
    }
    layer.open("def Scope \"Geometry\"")?;
    for piece in pieces {
        let binding = format!("{path}/Materials/{}", materials[&piece.material]);
        let name = identifier(&piece.name);
        let prim = MeshPrim {
            parent: "",
            name: &name,
            material: &binding,
            wind: piece.wind,
            rig: None,
            label: None,
        };
        mesh::write(layer, &writing.distinct, piece, &prim)?;
    }
    layer.close()?;
    layer.lines("\n")?;
    layer.open("def Scope \"Materials\"")?;
    for (&index, name) in &materials {
        let look = writing.distinct.materials[index].material;
        let of = format!("{path}/Materials/{name}");
        let text =
            material::describe(look, name, &of, writing.with_materialx, |picture| writing.file(picture));
        layer.lines(&text)?;
    }
    layer.close()
}

fn write_camera(layer: &mut Layer<'_, '_>, camera: &Camera) -> Result<(), ExportError> {
    // Tenths of a unit, as for film of 24 mm height where a unit is a centimetre.
    const APERTURE: f32 = 24.0;
    let focal_length = 0.5 * APERTURE / libm::tanf(0.5 * camera.fov_y_rad);
    let turn = camera.rotation();
    layer.open("def Camera \"Camera\"")?;
    layer.lines(&format!(
        r#"float2 clippingRange = ({}, {})
float focalLength = {focal_length}
float focusDistance = {}
float horizontalAperture = {}
token projection = "perspective"
float verticalAperture = {APERTURE}
quatf xformOp:orient = ({}, {}, {}, {})
double3 xformOp:translate = {}
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]"#,
        camera.near_m,
        camera.far_m,
        camera.position.distance(camera.target),
        APERTURE * camera.aspect,
        turn.w,
        turn.x,
        turn.y,
        turn.z,
        tuple(camera.position.to_array()),
    ))?;
    layer.close()?;
    layer.lines("\n")
}

fn write_lights(
    layer: &mut Layer<'_, '_>,
    writing: &Writing<'_>,
    setting: &Setting,
) -> Result<(), ExportError> {
    let Setting { sun, sky, .. } = setting;
    let turn = sun.rotation();
    layer.open("def DistantLight \"Sun\"")?;
    layer.lines(&format!(
        r#"float inputs:angle = {}
color3f inputs:color = {}
float inputs:intensity = {}
bool inputs:normalize = 1
quatf xformOp:orient = ({}, {}, {}, {})
uniform token[] xformOpOrder = ["xformOp:orient"]"#,
        sun.diameter_rad.to_degrees(),
        tuple(sun.color),
        sun.illuminance_lux / LUX_PER_UNIT,
        turn.w,
        turn.x,
        turn.y,
        turn.z,
    ))?;
    layer.close()?;
    layer.lines("\n")?;
    layer.open("def DomeLight \"Sky\"")?;
    // An even dome gives level ground π times its radiance.
    let radiance = sky.illuminance_lux / LUX_PER_UNIT / std::f32::consts::PI;
    match writing.sky.as_deref() {
        Some(file) => layer.lines(&format!(
            r#"float inputs:intensity = {}
asset inputs:texture:file = {}
token inputs:texture:format = "latlong""#,
            radiance / sky.mean,
            beside(file),
        ))?,
        None => layer.lines(&format!(
            "color3f inputs:color = {}\nfloat inputs:intensity = {radiance}",
            tuple(sky.color)
        ))?,
    }
    layer.close()?;
    layer.lines("\n")
}
