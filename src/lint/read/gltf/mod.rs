//! glTF 2.0, as text and binary.
//!
//! By a few structures of our own rather than the crate gltf 1.4.1: its readers take positions for floats, which
//! quantized files (`KHR_mesh_quantization`) do not have, its checks refuse files that require extensions which it does
//! not know, and what passes unchecked may panic. The tests hold this against that crate.

mod accessor;
mod document;
mod meshopt;
mod scene;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{Vec2, Vec3};
use linden_base::monitor::Monitor;

use self::accessor::{Buffers, Values};
use self::document::{Document, Image, Primitive, TextureInfo};
use super::{ADVICE, Beside, READING, ReadError, picture, shown};
use crate::asset::{Alpha, Aspect, Asset, Geometry, Material, Mesh, Texture, TextureUse};

/// The types of a GLB's chunks.
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";

pub(super) fn read(
    asset: &mut Asset,
    bytes: &[u8],
    beside: &dyn Beside,
    monitor: &dyn Monitor,
) -> Result<(), ReadError> {
    let (json, binary) = chunks(bytes)?;
    let document: Document =
        serde_json::from_slice(json).map_err(|error| broken(format!("its document: {error}")))?;
    let sources = buffers(&document, binary, beside, monitor)?;
    let buffers = Buffers::new(&document, &sources, monitor)?;
    textures(asset, &document, &buffers, beside);
    materials(asset, &document);
    // Meshes by the document's, each primitive one of ours.
    // Many primitives may be made of the same accessors.
    let mut held = 0;
    let mut pieces = Vec::with_capacity(document.meshes.len());
    for (index, mesh) in document.meshes.iter().enumerate() {
        monitor.check()?;
        let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {index}"));
        let mut of_mesh = Vec::new();
        for primitive in mesh.primitives.iter().filter(|primitive| (4..=6).contains(&primitive.mode)) {
            let mut read = primitive_mesh(asset, primitive, &buffers, &mut held, monitor)?;
            read.name = match asset.material_of(&read) {
                Some(material) if mesh.primitives.len() > 1 => format!("{name}, {}", material.name),
                _ => name.clone(),
            };
            of_mesh.push(asset.meshes.len());
            asset.meshes.push(read);
        }
        pieces.push(of_mesh);
    }
    scene::read(asset, &document, &buffers, &pieces)?;
    let physics =
        |name: &&String| name.contains("physics") || name.contains("collider") || name.contains("collision");
    if let Some(extension) = document.extensions_used.iter().find(physics) {
        asset.note(Aspect::Colliders, format!("{} is not read", shown(extension)));
    }
    Ok(())
}

fn broken(problem: impl AsRef<str>) -> ReadError {
    ReadError::broken("glTF", problem)
}

fn beyond(problem: impl AsRef<str>) -> ReadError {
    ReadError::beyond("glTF", problem)
}

/// The document and the binary chunk of a GLB; a `.gltf` is all document.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok()).map(u32::from_le_bytes);
        word.ok_or_else(|| broken("it ends within its header"))
    };
    let version = word(4)?;
    if version != 2 {
        let problem = format!("version {version} is not read, only 2");
        // What is not as long as it says is no whole file of any version.
        let may_be_whole = version > 2 && word(8).is_ok_and(|length| length as usize == bytes.len());
        return Err(if may_be_whole { beyond(problem) } else { broken(problem) });
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while at < bytes.len() {
        let length = word(at)? as usize;
        let kind = bytes.get(at + 4..at + 8).ok_or_else(|| broken("it ends within a chunk's header"))?;
        let end = (at + 8).checked_add(length).filter(|&end| end <= bytes.len());
        let end = end.ok_or_else(|| broken(format!("a chunk of {length} bytes is longer than the file")))?;
        let data = &bytes[at + 8..end];
        match kind {
            JSON => json = json.or(Some(data)),
            BIN => binary = binary.or(Some(data)),
            _ => {}
        }
        at = end;
    }
    Ok((json.ok_or_else(|| broken("it has no document"))?, binary))
}

/// The content of each buffer; `None` for those that only say what another one decodes to.
fn buffers(
    document: &Document,
    binary: Option<&[u8]>,
    beside: &dyn Beside,
    monitor: &dyn Monitor,
) -> Result<Vec<Option<Vec<u8>>>, ReadError> {
    let mut buffers = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        monitor.check()?;
        let content = match &buffer.uri {
            Some(uri) => Some(content(uri, beside).map_err(NoContent::of_buffer)?),
            None if index == 0 => binary.map(<[u8]>::to_vec),
            None => None,
        };
        monitor.admit(READING, 4 * content.as_ref().map_or(0, Vec::len) as u64, ADVICE)?;
        buffers.push(content);
    }
    Ok(buffers)
}

/// Why a URI has no content.
enum NoContent {
    /// It is data, which is broken.
    Data(String),
    /// It names a file that is not there, or may not be read.
    Beside(String),
}

impl NoContent {
    fn of_buffer(self) -> ReadError {
        match self {
            Self::Data(why) => broken(format!("its buffer {why}")),
            Self::Beside(why) => beyond(format!("its buffer {why}")),
        }
    }

    fn why(self) -> String {
        match self {
            Self::Data(why) | Self::Beside(why) => why,
        }
    }
}

/// What a URI names.
fn content(uri: &str, beside: &dyn Beside) -> Result<Vec<u8>, NoContent> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, data) = data
            .split_once(";base64,")
            .ok_or_else(|| NoContent::Data("is data in an unknown way".to_owned()))?;
        let decoded = STANDARD.decode(data);
        return decoded.map_err(|error| NoContent::Data(format!("is no base64: {error}")));
    }
    let name = decoded(uri);
    match beside.read(&name).map_err(NoContent::Beside)? {
        Some(bytes) => Ok(bytes),
        None => Err(NoContent::Beside(format!("{} is not there", shown(&name)))),
    }
}

/// A URI's `%20` as a space.
fn decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let code = (*first == b'%').then(|| after.get(..2)).flatten();
        let code = code.and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn textures(asset: &mut Asset, document: &Document, buffers: &Buffers<'_>, beside: &dyn Beside) {
    for (index, texture) in document.textures.iter().enumerate() {
        let image = texture.source().and_then(|image| document.images.get(image));
        let texture = match image {
            Some(image) => picture(asset, index, image, buffers, beside),
            None => Texture {
                name: format!("texture {index}"),
                problem: Some("it has no picture".to_owned()),
                size: None,
            },
        };
        asset.textures.push(texture);
    }
}

fn picture(
    asset: &mut Asset,
    index: usize,
    image: &Image,
    buffers: &Buffers<'_>,
    beside: &dyn Beside,
) -> Texture {
    let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map(decoded);
    let name = image.name.clone().or(file).unwrap_or_else(|| format!("texture {index}"));
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => content(uri, beside).map_err(NoContent::why),
        (None, Some(view)) => {
            buffers.view(view).map(<[u8]>::to_vec).ok_or("its bytes are not there".to_owned())
        }
        (None, None) => Err("it has no picture".to_owned()),
    };
    match bytes {
        Ok(bytes) => picture::texture(asset, &name, &bytes),
        Err(problem) => Texture { name: shown(&name), problem: Some(problem), size: None },
    }
}

fn materials(asset: &mut Asset, document: &Document) {
    let textures = asset.textures.len();
    let used = |info: &TextureInfo| {
        let transform = info.extensions.transform.as_ref();
        let set = transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord);
        let scale = transform.and_then(|transform| transform.scale).map_or(Vec2::ONE, Vec2::from);
        (info.index < textures).then_some(TextureUse { texture: info.index, set, scale })
    };
    for material in &document.materials {
        let pbr = &material.pbr_metallic_roughness;
        let others = [
            &pbr.metallic_roughness_texture,
            &material.normal_texture,
            &material.occlusion_texture,
            &material.emissive_texture,
        ];
        asset.materials.push(Material {
            name: material.name.clone().unwrap_or_default(),
            alpha: Some(match material.alpha_mode.as_deref() {
                Some("MASK") => Alpha::Mask,
                Some("BLEND") => Alpha::Blend,
                _ => Alpha::Opaque,
            }),
            is_cut: false,
            double_sided: Some(material.double_sided),
            color: pbr.base_color_texture.as_ref().and_then(used),
            others: others.into_iter().flatten().filter_map(used).collect(),
        });
    }
}

fn primitive_mesh(
    asset: &mut Asset,
    primitive: &Primitive,
    buffers: &Buffers<'_>,
    held: &mut u64,
    monitor: &dyn Monitor,
) -> Result<Mesh, ReadError> {
    let attribute = |name: &str| primitive.attributes.get(name).copied();
    let position = attribute("POSITION").ok_or_else(|| broken("a primitive has no positions"))?;
    let vertices = buffers.count(position)?;
    let corners = primitive.indices.map_or(Ok(vertices), |indices| buffers.count(indices))?;
    let triangles = if primitive.mode == 4 { corners / 3 } else { corners.saturating_sub(2) };
    let material = primitive.material.filter(|&material| material < asset.materials.len());
    let mut mesh = Mesh { name: String::new(), material, vertices, triangles, geometry: None };
    let accessors = [
        Some(position),
        primitive.indices,
        attribute("NORMAL"),
        attribute("TEXCOORD_0"),
        attribute("TEXCOORD_1"),
    ];
    let packed = accessors.into_iter().flatten().find_map(|index| buffers.packed(index));
    let packed = packed.or_else(|| primitive.extensions.draco.as_ref().map(|_| "KHR_draco_mesh_compression"));
    if let Some(packed) = packed {
        for aspect in [Aspect::Geometry, Aspect::Normals, Aspect::Uvs, Aspect::SecondUvs] {
            asset.note(aspect, format!("{packed} is not unpacked"));
        }
        return Ok(mesh);
    }
    *held += 48 * vertices as u64 + 16 * corners as u64;
    monitor.admit(READING, *held, ADVICE)?;
    let positions: Vec<Vec3> = buffers.values(position)?.vectors();
    let indices = match primitive.indices {
        Some(indices) => buffers.indices(indices)?,
        None => (0..vertices as u32).collect(),
    };
    if let Some(index) = indices.iter().find(|&&index| index as usize >= positions.len()) {
        return Err(broken(format!("an index names vertex {index}, there are {vertices}")));
    }
    let as_many = |values: &Values| values.count == vertices;
    let normals = attribute("NORMAL").map(|index| buffers.values(index)).transpose()?;
    let uvs = |name: &str| {
        let values = attribute(name).map(|index| buffers.values(index)).transpose()?;
        Ok::<_, ReadError>(values.filter(as_many).map(|values| values.pairs()))
    };
    let geometry = Geometry {
        normals: normals.filter(as_many).map(|values| values.vectors()),
        uvs: [uvs("TEXCOORD_0")?, uvs("TEXCOORD_1")?],
        triangles: triangles_of(primitive.mode, &indices),
        positions,
    };
    mesh.triangles = geometry.triangles.len();
    mesh.geometry = Some(geometry);
    Ok(mesh)
}

/// Lists (4), strips (5) and fans (6).
fn triangles_of(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
            .collect(),
        6 => indices.windows(2).skip(1).map(|pair| [indices[0], pair[0], pair[1]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}
