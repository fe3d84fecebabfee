//! The options of a glTF out of its document.

use std::fmt;
use std::io::{self, Read};

use linden_pipeline::stage::Surroundings;
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, Visitor};

use super::recipe::document_bytes;
use super::{DIFFUSE_TRANSMISSION, GLB, GLTF, WEBP};
use crate::writing::lightmap::LIGHTMAP_UV;
use crate::{Format, Readable, Traces};

/// Of a `.glb`.
pub(super) fn in_binary(file: &mut dyn Readable) -> io::Result<Traces> {
    match document_bytes(file)? {
        Some(bytes) => in_document(&GLB, &mut file.take(bytes)),
        None => Ok(Traces::none(&GLB)),
    }
}

/// Of a `.gltf`.
pub(super) fn in_text(file: &mut dyn Readable) -> io::Result<Traces> {
    in_document(&GLTF, file)
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Document {
    extensions_used: Vec<String>,
    buffers: Vec<Buffer>,
    images: Vec<Image>,
    cameras: Vec<IgnoredAny>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Mesh {
    extras: Option<WindExtras>,
    primitives: Vec<Primitive>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Primitive {
    attributes: Attributes,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Attributes {
    #[serde(rename = "TEXCOORD_1")]
    second: Option<IgnoredAny>,
}

#[derive(Deserialize)]
struct WindExtras {
    linden_wind_cube: Option<IgnoredAny>,
    linden_pivot_painter: Option<IgnoredAny>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Node {
    name: String,
    extras: Option<ToldExtras>,
}

#[derive(Deserialize)]
struct ToldExtras {
    linden_setting: Option<String>,
    linden_collision: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Buffer {
    uri: Option<Uri>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Image {
    mime_type: Option<String>,
    uri: Option<Uri>,
}

/// How a URI begins and ends: data may be all of a file.
struct Uri {
    is_data: bool,
    is_jpeg: bool,
}

impl<'de> Deserialize<'de> for Uri {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl Visitor<'_> for Text {
            type Value = Uri;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a URI")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Ok(Uri {
                    is_data: text.starts_with("data:"),
                    is_jpeg: text.rsplit('.').next() == Some("jpg"),
                })
            }
        }
        deserializer.deserialize_str(Text)
    }
}

fn in_document(format: &'static Format, json: &mut dyn Read) -> io::Result<Traces> {
    let document = match serde_json::from_reader::<_, Document>(json) {
        Ok(document) => document,
        Err(error) if error.is_io() => return Err(error.into()),
        Err(_) => return Ok(Traces::none(format)),
    };
    let uses = |name: &str| document.extensions_used.iter().any(|used| used == name);
    let is_jpeg = |image: &Image| {
        image.mime_type.as_deref() == Some("image/jpeg") || image.uri.as_ref().is_some_and(|uri| uri.is_jpeg)
    };
    let picture_format = match document.images.iter().any(is_jpeg) {
        _ if uses(WEBP) => "webp",
        true => "jpeg",
        false => "png",
    };
    let embed = document.buffers.iter().any(|buffer| buffer.uri.as_ref().is_some_and(|uri| uri.is_data));
    let mut traces = Traces::none(format)
        .with_switch("pictures", !document.images.is_empty())
        .with("picture_format", picture_format)
        .with_switch("instances", uses("EXT_mesh_gpu_instancing"))
        .with_switch("quantize", uses("KHR_mesh_quantization"))
        .with("compress", if uses("EXT_meshopt_compression") { "meshopt" } else { "none" });
    let is_packed = |mesh: &Mesh| mesh.extras.as_ref().is_some_and(|told| told.linden_wind_cube.is_some());
    let has_pivots =
        |mesh: &Mesh| mesh.extras.as_ref().is_some_and(|told| told.linden_pivot_painter.is_some());
    if document.meshes.iter().any(is_packed) {
        traces = traces.with("wind_as", "packed");
    } else if document.meshes.iter().any(has_pivots) {
        traces = traces.with("wind_as", "pivot-painter");
    } else {
        let mut primitives = document.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let has_second = primitives.any(|primitive| primitive.attributes.second.is_some());
        traces = traces.with_switch(LIGHTMAP_UV.knob.name, has_second);
    }
    // Of one level nothing shows; a file for each is told by its name.
    let has_levels = document.nodes.iter().any(|node| node.name.ends_with("_LOD1"));
    if has_levels && !uses("MSFT_lod") {
        traces = traces.with("lods", "siblings");
    }
    // Without leaves it does not show.
    traces = traces.with_shown("translucency", uses(DIFFUSE_TRANSMISSION));
    if format.id == GLTF.id {
        traces = traces.with_switch("embed", embed);
    }
    let collision = document.nodes.iter().find_map(|node| node.extras.as_ref()?.linden_collision.clone());
    if let Some((shapes, most)) = collision.as_deref().and_then(|told| told.split_once(' ')) {
        let has = |of: fn(&str) -> bool| document.nodes.iter().any(|node| of(&node.name));
        let way = match () {
            () if has(|name| name.starts_with("UCX_")) => "unreal",
            () if has(|name| name.ends_with("-convcolonly")) => "godot",
            () => "omi",
        };
        traces = traces.with("collision", shapes).with("collision_most", most).with("collision_as", way);
    }
    let told = document.nodes.into_iter().rev().find_map(|node| node.extras?.linden_setting);
    let surroundings = told.map_or(Ok(Surroundings::default()), |text| Surroundings::parse(&text));
    let setting = surroundings.ok().filter(|_| !document.cameras.is_empty());
    Ok(Traces { setting, ..traces })
}
