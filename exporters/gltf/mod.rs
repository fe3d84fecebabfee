//! glTF 2.0, as `.gltf` with its files beside and as a single `.glb`.
//!
//! The recipe is a JSON object under `linden` in the extras of the tree's root node: node extras are
//! what importers keep (as custom properties in Blender, `userData` in three.js).
//!
//! Parts with a normal picture carry TANGENTs: see [`tangents`].

mod animation;
mod bones;
mod buffer;
mod byte_sink;
mod collision;
mod document;
mod estimate;
mod facts;
mod meshopt;
mod nodes;
mod options;
mod pivots;
mod quantize;
mod recipe;
mod setting;
mod tangents;
mod traces;
mod wind;

use std::borrow::Cow;
use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::picture::PictureFormat;
use linden_pipeline::scene::{Translucency, Wrap};
use linden_pipeline::stage::Stage;
use serde_json::value::RawValue;

pub(crate) use self::byte_sink::Base64;
use self::byte_sink::ByteSink;
pub(crate) use self::estimate::bytes as estimate;

use self::buffer::Layout;
use self::document::{
    Asset, Buffer, BufferExtensions, DiffuseTransmission, Document, DocumentExtensions, Fallback, Image,
    ImageSource, LightList, Material, MaterialExtensions, PbrMetallicRoughness, Sampler, SceneRoot,
    ShapeList, Texture, TextureExtensions, TextureInfo, TextureTransform,
};
use self::nodes::{SceneGraph, Standing};
use self::options::{
    COMPRESS, INSTANCES, LODS, PICTURE_FORMAT, PICTURES, QUANTIZE, TRANSLUCENCY, WIND_AS, is_quantized,
    is_wind_packed, levels_by, note_translucency, sways, with_lightmap,
};
use self::pivots::Pivots;
use self::quantize::{Quanta, Range};
use self::wind::WindAs;
use crate::collision::{COLLISION, MOST};
use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, NamedMaterial};
use crate::writing::lightmap::{self, LIGHTMAP_UV, Sharing};
use crate::writing::pictures::{self, NamedPicture};
use crate::writing::{fit, instances, memory, note_asked};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, LooksIn, Readable, Traces};

/// JSON, with a buffer and pictures beside it.
pub(crate) struct Gltf;

/// One binary file.
pub(crate) struct Glb;

/// What lets light through. Never required: without it foliage is reflective alone.
const DIFFUSE_TRANSMISSION: &str = "KHR_materials_diffuse_transmission";

/// Marks textures that are WebP. Required: a second picture for readers without it would double the file.
const WEBP: &str = "EXT_texture_webp";

/// Variants of glTF change materials alone, and leaves have other shapes each season.
const HOLDS: Holds = Holds { seasons: LooksIn::Files, ..Holds::SCENE };

static GLTF: Format = Format {
    id: "gltf",
    name: "glTF 2.0 (JSON)",
    extensions: &["gltf"],
    media_type: "model/gltf+json",
    self_contained: false,
    help: "for engines and the web; geometry (.bin) and pictures lie beside it",
    options: &[
        PICTURES,
        PICTURE_FORMAT,
        OptionSpec::switch("embed", false, "buffer and pictures inside the file, as data URIs"),
        INSTANCES,
        QUANTIZE,
        COMPRESS,
        LODS,
        WIND_AS,
        LIGHTMAP_UV,
        TRANSLUCENCY,
        COLLISION,
        MOST,
        collision::AS,
    ],
    holds: HOLDS,
    levels_by: Some(levels_by),
    encoding,
    estimate: Some(estimate),
};

static GLB: Format = Format {
    id: "glb",
    name: "glTF 2.0 (binary)",
    extensions: &["glb"],
    media_type: "model/gltf-binary",
    self_contained: true,
    help: "for engines and the web: everything in one file",
    options: &[
        PICTURES,
        PICTURE_FORMAT,
        INSTANCES,
        QUANTIZE,
        COMPRESS,
        LODS,
        WIND_AS,
        LIGHTMAP_UV,
        TRANSLUCENCY,
        COLLISION,
        MOST,
        collision::AS,
    ],
    holds: HOLDS,
    levels_by: Some(levels_by),
    encoding,
    estimate: Some(estimate),
};

pub(crate) fn encoding(options: &Options) -> Encoding {
    if options.is_word("compress", "meshopt") { Encoding::Packed } else { Encoding::Binary }
}

impl Exporter for Gltf {
    fn format(&self) -> &'static Format {
        &GLTF
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_text(file)
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        traces::in_text(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &GLTF, bundle);
        let Prepared { distinct, pictures, mut layout } = Prepared::new(stage, options, bundle, monitor)?;
        let embed = options.is_on("embed") || !bundle.takes_side_files();
        if embed && !options.is_on("embed") {
            bundle
                .note("a single stream has no files beside it: buffer and pictures are inside, as data URIs");
        }
        if embed {
            let sources = embedded(&pictures, &mut layout)?;
            let mut document = document(stage, &distinct, &pictures, sources, options, &mut layout, monitor)?;
            document.buffers[0].uri = Some(DATA_URI.to_owned());
            let json = json(&document)?;
            let hole = find(&json, DATA_URI.as_bytes()) + DATA_URI.len();
            let bytes = json.len() as u64 + layout.bytes().div_ceil(3) * 4;
            return bundle.write_main(Some(bytes), monitor, |out| {
                out.write(&json[..hole])?;
                let mut encoder = Base64::new(out);
                layout.write(&distinct, &mut encoder)?;
                encoder.finish()?;
                out.write(&json[hole..])
            });
        }
        let mut sources = Vec::with_capacity(pictures.len());
        for (named, bytes) in pictures.iter().zip(pictures::compress(&pictures)?) {
            let file = bundle.write_picture(&named.suffix, &bytes, monitor)?;
            sources.push(ImageSource::Uri(percent_encoded(&file)));
        }
        let mut document = document(stage, &distinct, &pictures, sources, options, &mut layout, monitor)?;
        document.buffers[0].uri = Some(percent_encoded(&bundle.side_name(".bin")));
        let json = json(&document)?;
        bundle.write_side(".bin", Some(layout.bytes()), monitor, |out| layout.write(&distinct, out))?;
        bundle.write_main(Some(json.len() as u64), monitor, |out| out.write(&json))
    }
}

/// What a file of either form begins with: meshes and pictures, and the buffer that is laid out for them.
struct Prepared<'a> {
    distinct: DistinctMeshes<'a>,
    pictures: Vec<NamedPicture<'a>>,
    layout: Layout,
}

impl<'a> Prepared<'a> {
    /// Prepares a stage; what the user should know goes to the bundle, and so do pictures that vertices name.
    fn new(
        stage: &'a Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<Self, ExportError> {
        note_asked(stage, options, bundle);
        collision::note(stage, options, bundle);
        let distinct = distinct(stage, options, bundle, monitor)?;
        note_translucency(&distinct, stage, options, bundle);
        let pictures = pictures(&distinct, options, bundle);
        memory::admit(stage, &pictures, own_bytes(&distinct, &pictures), monitor)?;
        let wind_as = wind_as(&distinct, options, bundle, monitor)?;
        let is_quantized = is_quantized(&distinct, options, bundle);
        let layout = Layout::of_meshes(stage, &distinct, &pictures, is_quantized, wind_as);
        Ok(Self { distinct, pictures, layout })
    }
}

fn distinct<'a>(
    stage: &'a Stage<'_>,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<DistinctMeshes<'a>, ExportError> {
    let mut distinct = DistinctMeshes::under_dome(stage, monitor)?;
    if options.is_on("instances") {
        instances::unbake(&mut distinct, stage, instances::Moving::Baked, bundle, monitor)?;
    }
    if with_lightmap(&distinct, options, bundle) {
        let is_parted = nodes::is_parted(stage, &distinct);
        let sharing = if is_parted { Sharing::None } else { Sharing::Models };
        lightmap::unwrap(&mut distinct, sharing, stage, bundle, monitor)?;
    }
    Ok(distinct)
}

/// How vertices are told the wind; writes what they name beside the file.
fn wind_as(
    distinct: &DistinctMeshes<'_>,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<WindAs, ExportError> {
    if is_wind_packed(options, sways(distinct)) {
        return Ok(WindAs::Packed);
    }
    Ok(Pivots::write(distinct, options, bundle, monitor)?.map_or(WindAs::Attributes, WindAs::Pivots))
}

/// The format that was asked for.
fn picture_format(options: &Options) -> PictureFormat {
    let is = |format: &PictureFormat| {
        options.is_word(PICTURE_FORMAT.knob.name, &format.name().to_ascii_lowercase())
    };
    PictureFormat::ALL.into_iter().find(is).unwrap_or(PictureFormat::Png)
}

/// The pictures that are written, in the format that was asked for where that serves them.
fn pictures<'a>(
    distinct: &DistinctMeshes<'a>,
    options: &Options,
    bundle: &mut Bundle,
) -> Vec<NamedPicture<'a>> {
    let mut pictures = match options.is_on("pictures") {
        true if options.is_on("translucency") => pictures::with_passing(&distinct.materials),
        true => pictures::of_materials(&distinct.materials),
        false => Vec::new(),
    };
    let format = picture_format(options);
    for named in &mut pictures {
        named.store_as(format);
    }
    // Where nothing else shows that it was asked for, all stays as it is.
    if format == PictureFormat::Jpeg && pictures.iter().any(|named| named.format == format) {
        for named in &mut pictures {
            named.is_rounded = named.is_normal;
        }
    }
    if format != PictureFormat::Png && pictures.iter().all(|named| named.format != format) {
        bundle.note(format!(
            "picture_format changes nothing: there is no picture that {} could hold",
            format.name()
        ));
    }
    pictures
}

/// Tangents are all made before any is written, a mesh after the other; where copies stand is there
/// as it is written too.
fn own_bytes(distinct: &DistinctMeshes<'_>, pictures: &[NamedPicture<'_>]) -> u64 {
    let tangents =
        if pictures.is_empty() { 0 } else { memory::largest(distinct, memory::per_vertex::<[f32; 4]>) };
    tangents
        + lightmap::held_bytes(distinct)
        + 2 * instances::bytes(distinct)
        + pictures::rounding_bytes(pictures)
}

/// How the embedded buffer's URI begins.
const DATA_URI: &str = "data:application/octet-stream;base64,";

/// Where `needle` first is; the caller has put it there.
fn find(haystack: &[u8], needle: &[u8]) -> usize {
    haystack.windows(needle.len()).position(|window| window == needle).unwrap_or_default()
}

impl Exporter for Glb {
    fn format(&self) -> &'static Format {
        &GLB
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_binary(file)
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        traces::in_binary(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &GLB, bundle);
        let binary = Binary::new(stage, GLB.id, options, bundle, monitor)?;
        bundle.write_main(Some(binary.bytes()), monitor, |out| binary.write(out))
    }
}

/// A GLB that is laid out.
pub(crate) struct Binary<'a> {
    distinct: DistinctMeshes<'a>,
    layout: Layout,
    json: Vec<u8>,
    length: u32,
}

impl<'a> Binary<'a> {
    /// Lays out a stage for a format, with its options; what the user should know goes to the bundle.
    pub fn new(
        stage: &'a Stage<'_>,
        format: &'static str,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<Self, ExportError> {
        let Prepared { distinct, pictures, mut layout } = Prepared::new(stage, options, bundle, monitor)?;
        let sources = embedded(&pictures, &mut layout)?;
        let document = document(stage, &distinct, &pictures, sources, options, &mut layout, monitor)?;
        let mut json = json(&document)?;
        // Both chunks end at a multiple of four (4.4.3): the buffer does anyway.
        json.resize(json.len().next_multiple_of(4), b' ');
        let bytes = 12 + 8 + json.len() as u64 + 8 + layout.bytes();
        let too_large = |_| ExportError::TooLarge {
            format,
            amount: format!("{bytes} bytes"),
            limit: "4 GiB",
            advice: "write .gltf instead, or lower the resolution",
        };
        let length = u32::try_from(bytes).map_err(too_large)?;
        Ok(Self { distinct, layout, json, length })
    }

    /// Bytes of the file.
    pub fn bytes(&self) -> u64 {
        self.length.into()
    }

    /// Writes the file.
    pub fn write(&self, out: &mut impl ByteSink) -> Result<(), ExportError> {
        out.put(b"glTF")?;
        // Each fits where the whole does.
        for word in [2, self.length, self.json.len() as u32] {
            out.put(&word.to_le_bytes())?;
        }
        out.put(b"JSON")?;
        out.put(&self.json)?;
        out.put(&(self.layout.bytes() as u32).to_le_bytes())?;
        out.put(b"BIN\0")?;
        self.layout.write(&self.distinct, out)
    }
}

/// Pictures into the buffer.
fn embedded(pictures: &[NamedPicture<'_>], layout: &mut Layout) -> Result<Vec<ImageSource>, ExportError> {
    let put = |file: Cow<'_, [u8]>| ImageSource::BufferView(layout.push_blob(file.into_owned()));
    Ok(pictures::compress(pictures)?.into_iter().map(put).collect())
}

/// The document, but for the buffer's URI. `sources` tells where each picture is.
fn document(
    stage: &Stage<'_>,
    distinct: &DistinctMeshes<'_>,
    pictures: &[NamedPicture<'_>],
    sources: Vec<ImageSource>,
    options: &Options,
    layout: &mut Layout,
    monitor: &dyn Monitor,
) -> Result<Document, ExportError> {
    let materials = materials(distinct, pictures, layout.quanta.as_ref(), options.is_on("translucency"));
    let has_translucent = materials
        .iter()
        .any(|material| material.extensions.as_ref().is_some_and(|all| all.diffuse_transmission.is_some()));
    let mut standing = Standing { binds: bones::lay_out(distinct, layout), ..Default::default() };
    if options.is_on("instances") {
        if nodes::are_instances(stage, options) {
            standing.plants = nodes::lay_out_instances(stage, layout);
        }
        standing.pieces = nodes::lay_out_copies(distinct, layout);
    }
    let mut graph = nodes::nodes(stage, distinct, layout, &standing, options.is_word("lods", "siblings"));
    let shapes = collision::add(stage, distinct, options, layout, &mut graph);
    let SceneGraph { nodes, roots, meshes, skins, rigs, cameras, lights, mut extensions, mut required } =
        graph;
    if has_translucent {
        extensions.push(DIFFUSE_TRANSMISSION);
    }
    let animation = animation::animation(distinct, &meshes, &nodes, &rigs, layout);
    if options.is_word("compress", "meshopt") {
        let bytes = stage.bytes() + layout.compressing_bytes();
        monitor.admit("compressing the meshes", bytes, "write without compress, or with quantize")?;
        layout.compress(distinct, monitor)?;
        extensions.push(meshopt::EXTENSION);
        required.push(meshopt::EXTENSION);
    }
    let fallback = layout.stands_for().map(|byte_length| Buffer {
        byte_length,
        uri: None,
        extensions: Some(BufferExtensions { fallback: Fallback::new() }),
    });
    let buffer = Buffer { byte_length: layout.bytes(), uri: None, extensions: None };
    let images = pictures.iter().zip(sources).map(|(named, source)| Image {
        name: named.name.clone(),
        mime_type: named.format.media_type(),
        source,
    });
    let (wraps, textures) = textures(pictures);
    if pictures.iter().any(|named| named.format == PictureFormat::Webp) {
        extensions.push(WEBP);
        required.push(WEBP);
    }
    Ok(Document {
        asset: Asset { version: "2.0", generator: GENERATOR },
        buffers: std::iter::once(buffer).chain(fallback).collect(),
        scene: 0,
        extensions_used: extensions,
        extensions_required: required,
        scenes: [SceneRoot { name: stage.name.clone(), nodes: roots }],
        nodes,
        cameras,
        extensions: (lights.is_some() || !shapes.is_empty()).then(|| DocumentExtensions {
            lights: lights.map(|lights| LightList { lights }),
            shapes: (!shapes.is_empty()).then_some(ShapeList { shapes }),
        }),
        meshes,
        materials,
        textures,
        images: images.collect(),
        samplers: wraps.into_iter().map(Sampler::new).collect(),
        skins,
        animations: animation.into_iter().collect(),
        accessors: std::mem::take(&mut layout.accessors),
        buffer_views: std::mem::take(&mut layout.views),
    })
}

/// The materials, each with the pictures that are written. With quantized meshes textures lie in their ranges.
fn materials(
    distinct: &DistinctMeshes<'_>,
    pictures: &[NamedPicture<'_>],
    quanta: Option<&Quanta>,
    is_translucent: bool,
) -> Vec<Material> {
    let texture = |look: usize, picture| {
        let index = pictures::index_of(pictures, picture)?;
        let range = quanta.and_then(|quanta| quanta.range(look));
        let extensions = range.map(|Range { offset, scale }| TextureExtensions {
            transform: TextureTransform { offset: offset.to_array(), scale: scale.to_array() },
        });
        Some(TextureInfo { index, extensions })
    };
    let unlit = distinct.dome.as_ref().map(|dome| dome.material);
    distinct
        .materials
        .iter()
        .enumerate()
        .map(|(index, NamedMaterial { name, material, .. })| {
            let base_color_texture = texture(index, material.base_color_picture.as_ref());
            // The two are multiplied, and the picture is to be used as it is.
            // Without its picture there is nothing to cut.
            let cutout = material.cutout.filter(|_| base_color_texture.is_some());
            let [r, g, b] = if base_color_texture.is_some() { [1.0; 3] } else { material.base_color };
            Material {
                name: name.clone(),
                pbr_metallic_roughness: PbrMetallicRoughness {
                    base_color_factor: [r, g, b, 1.0],
                    base_color_texture,
                    metallic_factor: 0.0,
                    roughness_factor: material.roughness,
                },
                normal_texture: texture(index, material.normal_picture.as_ref()),
                double_sided: material.double_sided,
                alpha_mode: cutout.map(|_| "MASK"),
                alpha_cutoff: cutout,
                extensions: if unlit == Some(index) {
                    Some(MaterialExtensions::unlit())
                } else {
                    let through = material.translucency.filter(|_| is_translucent);
                    let [color, share] = [&material.base_color_picture, &material.passing_picture]
                        .map(|picture| texture(index, picture.as_ref()));
                    through.map(|through| passing(through, color, share, material.base_color))
                },
            }
        })
        .collect()
}

/// A texture for each picture, and how its sampler wraps: samplers are those of all ways to wrap.
fn textures(pictures: &[NamedPicture<'_>]) -> (Vec<Wrap>, Vec<Texture>) {
    let mut wraps: Vec<Wrap> = pictures.iter().map(|named| named.wrap).collect();
    wraps.sort_unstable_by_key(|wrap| *wrap == Wrap::Clamp);
    wraps.dedup();
    let sampler = |wrap| wraps.iter().position(|known| *known == wrap).unwrap_or_default();
    let texture = |(source, named): (usize, &NamedPicture<'_>)| match named.format {
        PictureFormat::Webp => Texture::of_webp(sampler(named.wrap), source),
        PictureFormat::Png | PictureFormat::Jpeg => Texture::new(sampler(named.wrap), source),
    };
    let textures = (0..).zip(pictures).map(texture).collect();
    (wraps, textures)
}

/// Light that passes, in the colours of a texture or in one.
fn passing(
    through: Translucency,
    color_texture: Option<TextureInfo>,
    share_texture: Option<TextureInfo>,
    color: [f32; 3],
) -> MaterialExtensions {
    let Translucency { share, tint } = through;
    let color = if color_texture.is_some() { tint } else { [0, 1, 2].map(|i| tint[i] * color[i]) };
    MaterialExtensions::diffuse_transmission(DiffuseTransmission {
        share,
        share_texture,
        color,
        color_texture,
    })
}

/// The recipe letter by letter: parsing and printing again could round a number.
fn recipe(recipe: &str) -> Option<Box<RawValue>> {
    RawValue::from_string(recipe.to_owned()).or_else(|_| serde_json::value::to_raw_value(recipe)).ok()
}

fn json(document: &Document) -> Result<Vec<u8>, ExportError> {
    serde_json::to_vec(document).map_err(|e| ExportError::Io {
        doing: "describing",
        what: "the glTF document".to_owned(),
        source: e.into(),
    })
}

/// A relative URI (RFC 3986): everything but the unreserved characters as `%XX` of its UTF-8.
pub(crate) fn percent_encoded(name: &str) -> String {
    let mut uri = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            uri.push(byte.into());
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_of_unreserved_characters() {
        assert_eq!(percent_encoded("a-b_c.d~e.bin"), "a-b_c.d~e.bin");
        assert_eq!(percent_encoded("Ö l#%"), "%C3%96%20l%23%25");
    }

    #[test]
    fn the_recipe_keeps_its_letters() {
        let with = |text: &str| {
            let extras = document::Extras { linden: recipe(text), ..document::Extras::default() };
            serde_json::to_string(&extras).unwrap()
        };
        let recipe_text = r#"{"z":0.30000000000000004,"a":18446744073709551615}"#;
        assert_eq!(with(recipe_text), format!(r#"{{"linden":{recipe_text}}}"#));
        assert_eq!(with("no json"), r#"{"linden":"no json"}"#);
    }
}
