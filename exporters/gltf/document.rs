//! The glTF 2.0 document: what of the specification a tree needs, and nothing of where it comes from.
//!
//! <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>, section 5.

use linden_pipeline::scene::Wrap;
use serde::Serialize;
use serde_json::value::RawValue;

use super::facts::TreeFacts;
use super::pivots::PivotExtras;

/// The root. `buffers` stands before everything that carries names from outside: the writer of data
/// URIs materials for the first one.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    pub buffers: Vec<Buffer>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub extensions_used: Vec<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub extensions_required: Vec<&'static str>,
    pub scene: usize,
    pub scenes: [SceneRoot; 1],
    pub nodes: Vec<Node>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<Camera>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<DocumentExtensions>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<Texture>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<Image>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub samplers: Vec<Sampler>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skins: Vec<Skin>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub animations: Vec<Animation>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
}

#[derive(Serialize)]
pub(super) struct Asset {
    pub version: &'static str,
    pub generator: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub byte_length: u64,
    /// None for a GLB's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uri: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<BufferExtensions>,
}

#[derive(Serialize)]
pub(super) struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub fallback: Fallback,
}

#[derive(Serialize)]
pub(super) struct SceneRoot {
    pub name: String,
    pub nodes: Vec<usize>,
}

#[derive(Clone, Default, Serialize)]
pub(super) struct Node {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    /// A unit quaternion: x, y, z, w.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<usize>,
    #[serde(skip_serializing_if = "NodeExtensions::is_empty")]
    pub extensions: NodeExtensions,
    #[serde(skip_serializing_if = "Extras::is_empty")]
    pub extras: Extras,
}

#[derive(Clone, Default, Serialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "MSFT_lod", skip_serializing_if = "Option::is_none")]
    pub lod: Option<Lod>,
    #[serde(rename = "KHR_lights_punctual", skip_serializing_if = "Option::is_none")]
    pub light: Option<LightIndex>,
    #[serde(rename = "EXT_mesh_gpu_instancing", skip_serializing_if = "Option::is_none")]
    pub instancing: Option<Instancing>,
    #[serde(rename = "OMI_physics_body", skip_serializing_if = "Option::is_none")]
    pub body: Option<PhysicsBody>,
}

impl NodeExtensions {
    fn is_empty(&self) -> bool {
        self.lod.is_none() && self.light.is_none() && self.instancing.is_none() && self.body.is_none()
    }
}

/// `OMI_physics_body`: what bears shapes and how it moves, or one of its shapes.
#[derive(Clone, Copy, Serialize)]
pub(super) struct PhysicsBody {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<BodyMotion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collider: Option<Collider>,
}

#[derive(Clone, Copy, Serialize)]
pub(super) struct BodyMotion {
    #[serde(rename = "type")]
    pub kind: &'static str,
}

/// An index into the document's shapes.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Collider {
    pub shape: usize,
}

#[derive(Serialize)]
pub(super) struct ShapeList {
    pub shapes: Vec<Shape>,
}

/// `OMI_physics_shape`.
#[derive(Serialize)]
pub(super) struct Shape {
    #[serde(rename = "type")]
    pub kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capsule: Option<CapsuleShape>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convex: Option<ConvexShape>,
}

/// Along Y of its node; the height is between the middles of its ends, metres.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct CapsuleShape {
    pub height: f32,
    pub radius_bottom: f32,
    pub radius_top: f32,
}

/// The hull of a mesh.
#[derive(Serialize)]
pub(super) struct ConvexShape {
    pub mesh: usize,
}

/// `EXT_mesh_gpu_instancing`: the node's mesh in many places.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Instancing {
    pub attributes: InstanceAttributes,
}

/// Accessors with an item per place.
#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct InstanceAttributes {
    pub translation: usize,
    pub rotation: usize,
    pub scale: usize,
}

#[derive(Clone, Copy, Serialize)]
pub(super) struct LightIndex {
    pub light: usize,
}

#[derive(Serialize)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual", skip_serializing_if = "Option::is_none")]
    pub lights: Option<LightList>,
    #[serde(rename = "OMI_physics_shape", skip_serializing_if = "Option::is_none")]
    pub shapes: Option<ShapeList>,
}

#[derive(Serialize)]
pub(super) struct LightList {
    pub lights: Vec<Light>,
}

/// A light of `KHR_lights_punctual` that shines along -Z of its node.
#[derive(Serialize)]
pub(super) struct Light {
    pub name: String,
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Lux, for a directional one.
    pub intensity: f32,
}

/// A camera that materials along -Z of its node.
#[derive(Serialize)]
pub(super) struct Camera {
    pub name: &'static str,
    #[serde(rename = "type")]
    pub kind: &'static str,
    pub perspective: Perspective,
}

#[derive(Serialize)]
pub(super) struct Perspective {
    #[serde(rename = "aspectRatio")]
    pub aspect_ratio: f32,
    /// Radians.
    pub yfov: f32,
    pub zfar: f32,
    pub znear: f32,
}

/// `MSFT_lod`: the node is the finest level, and these are the others, finer ones first.
#[derive(Clone, Serialize)]
pub(super) struct Lod {
    pub ids: Vec<usize>,
}

/// What no extension says; other programs keep it.
#[derive(Clone, Default, Serialize)]
pub(super) struct Extras {
    /// The recipe, letter by letter: a JSON object where it is one, else a string.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden: Option<Box<RawValue>>,
    /// The tree and its level in plain numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_tree: Option<TreeFacts>,
    /// Down to which share of the picture each level serves (`MSFT_lod` has it in the extras).
    #[serde(rename = "MSFT_screencoverage", skip_serializing_if = "Vec::is_empty")]
    pub screen_coverage: Vec<f32>,
    /// What a mesh's morph targets are called: the extras are where importers look for that.
    #[serde(rename = "targetNames", skip_serializing_if = "Vec::is_empty")]
    pub target_names: Vec<&'static str>,
    /// Where the tree's foot is in the file of the scan that it grew into, in that file's axes and units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_foot_in_file: Option<[f64; 3]>,
    /// What camera, sun and ground were asked for with, where that is not the usual.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_setting: Option<String>,
    /// Where packed pivots of the wind are: `[x, y, z, side]`, a corner and the side of the cube that 0 to 1 means, in
    /// the units of the stored positions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_wind_cube: Option<[f32; 4]>,
    /// Which season the node shows, where there are several to choose from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_season: Option<String>,
    /// The pictures of pivots that `TEXCOORD_1` names texels of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_pivot_painter: Option<PivotExtras>,
    /// With which options there are shapes for physics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linden_collision: Option<String>,
}

impl Extras {
    fn is_empty(&self) -> bool {
        self.linden.is_none()
            && self.linden_tree.is_none()
            && self.linden_foot_in_file.is_none()
            && self.screen_coverage.is_empty()
            && self.target_names.is_empty()
            && self.linden_setting.is_none()
            && self.linden_collision.is_none()
            && self.linden_wind_cube.is_none()
            && self.linden_season.is_none()
            && self.linden_pivot_painter.is_none()
    }
}

#[derive(Serialize)]
pub(super) struct Mesh {
    pub name: String,
    pub primitives: Vec<Primitive>,
    #[serde(skip_serializing_if = "Extras::is_empty")]
    pub extras: Extras,
}

#[derive(Serialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: usize,
    /// None of shapes that are not drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<usize>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<MorphTarget>,
}

/// Accessors of the vertex arrays.
#[derive(Default, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct Attributes {
    pub position: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent: Option<usize>,
    #[serde(rename = "TEXCOORD_0", skip_serializing_if = "Option::is_none")]
    pub texcoord_0: Option<usize>,
    #[serde(rename = "COLOR_0", skip_serializing_if = "Option::is_none")]
    pub color_0: Option<usize>,
    #[serde(rename = "TEXCOORD_1", skip_serializing_if = "Option::is_none")]
    pub texcoord_1: Option<usize>,
    #[serde(rename = "TEXCOORD_2", skip_serializing_if = "Option::is_none")]
    pub texcoord_2: Option<usize>,
    #[serde(rename = "JOINTS_0", skip_serializing_if = "Option::is_none")]
    pub joints_0: Option<usize>,
    #[serde(rename = "WEIGHTS_0", skip_serializing_if = "Option::is_none")]
    pub weights_0: Option<usize>,
    #[serde(rename = "_WIND", skip_serializing_if = "Option::is_none")]
    pub wind: Option<usize>,
    #[serde(rename = "_WINDPIVOT", skip_serializing_if = "Option::is_none")]
    pub wind_pivot: Option<usize>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub name: String,
    pub pbr_metallic_roughness: PbrMetallicRoughness,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_texture: Option<TextureInfo>,
    pub double_sided: bool,
    /// None for what is opaque.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha_mode: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha_cutoff: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<MaterialExtensions>,
}

#[derive(Serialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_unlit", skip_serializing_if = "Option::is_none")]
    pub unlit: Option<Empty>,
    #[serde(rename = "KHR_materials_diffuse_transmission", skip_serializing_if = "Option::is_none")]
    pub diffuse_transmission: Option<DiffuseTransmission>,
}

impl MaterialExtensions {
    pub fn unlit() -> Self {
        Self { unlit: Some(Empty {}), diffuse_transmission: None }
    }

    pub fn diffuse_transmission(through: DiffuseTransmission) -> Self {
        Self { unlit: None, diffuse_transmission: Some(through) }
    }
}

/// `KHR_materials_diffuse_transmission` (release candidate): light that leaves on the other side. Its
/// colour stands for itself, the base colour is not part of it.
#[derive(Serialize)]
pub(super) struct DiffuseTransmission {
    /// Of the light that is not reflected as by a mirror, 0 to 1.
    #[serde(rename = "diffuseTransmissionFactor")]
    pub share: f32,
    /// By which it is multiplied, in alpha.
    #[serde(rename = "diffuseTransmissionTexture", skip_serializing_if = "Option::is_none")]
    pub share_texture: Option<TextureInfo>,
    /// Linear RGB.
    #[serde(rename = "diffuseTransmissionColorFactor")]
    pub color: [f32; 3],
    #[serde(rename = "diffuseTransmissionColorTexture", skip_serializing_if = "Option::is_none")]
    pub color_texture: Option<TextureInfo>,
}

/// `{}`.
#[derive(Serialize)]
pub(super) struct Empty {}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct PbrMetallicRoughness {
    /// Linear RGBA.
    pub base_color_factor: [f32; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: f32,
    pub roughness_factor: f32,
}

#[derive(Serialize)]
pub(super) struct TextureInfo {
    pub index: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<TextureExtensions>,
}

#[derive(Serialize)]
pub(super) struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: TextureTransform,
}

/// `KHR_texture_transform`: what is stored, scaled and then moved.
#[derive(Serialize)]
pub(super) struct TextureTransform {
    pub offset: [f32; 2],
    pub scale: [f32; 2],
}

#[derive(Serialize)]
pub(super) struct Texture {
    pub sampler: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<TextureSources>,
}

impl Texture {
    /// A picture of a format that glTF itself knows.
    pub const fn new(sampler: usize, source: usize) -> Self {
        Self { sampler, source: Some(source), extensions: None }
    }

    /// A WebP picture, and none for readers that do not know the extension: it would double the file.
    pub const fn of_webp(sampler: usize, source: usize) -> Self {
        Self { sampler, source: None, extensions: Some(TextureSources { webp: WebpSource { source } }) }
    }
}

#[derive(Serialize)]
pub(super) struct TextureSources {
    #[serde(rename = "EXT_texture_webp")]
    pub webp: WebpSource,
}

#[derive(Serialize)]
pub(super) struct WebpSource {
    pub source: usize,
}

/// A picture: beside the file, or in the buffer.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image {
    pub name: String,
    pub mime_type: &'static str,
    #[serde(flatten)]
    pub source: ImageSource,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum ImageSource {
    Uri(String),
    BufferView(usize),
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Sampler {
    pub mag_filter: u16,
    pub min_filter: u16,
    pub wrap_s: u16,
    pub wrap_t: u16,
}

impl Sampler {
    /// Trilinear; either repeating both ways (bark goes round and along a branch) or not.
    pub const fn new(wrap: Wrap) -> Self {
        let wrap = match wrap {
            Wrap::Repeat => 10497,
            Wrap::Clamp => 33071,
        };
        Self { mag_filter: 9729, min_filter: 9987, wrap_s: wrap, wrap_t: wrap }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    /// None: all zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer_view: Option<usize>,
    /// Where it begins in its view, where that is not at the beginning.
    #[serde(skip_serializing_if = "is_zero")]
    pub byte_offset: u64,
    pub component_type: ComponentType,
    #[serde(skip_serializing_if = "is_false")]
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub shape: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<Vec<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<Vec<f32>>,
}

/// Component types by their number in OpenGL.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum ComponentType {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
}

impl Serialize for ComponentType {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u16(*self as u16)
    }
}

#[derive(Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    pub byte_offset: u64,
    pub byte_length: u64,
    /// Where items are padded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub byte_stride: Option<u64>,
    /// 34962 for vertices, 34963 for indices, none for pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<u16>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<ViewExtensions>,
}

#[derive(Clone, Serialize)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub compressed: Compressed,
}

/// How `EXT_meshopt_compression` compresses a view.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) enum Mode {
    Attributes,
    Triangles,
}

/// Where a view's compressed bytes are.
#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Compressed {
    pub buffer: usize,
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: u64,
    pub mode: Mode,
    pub count: usize,
}

/// Says that a buffer is nowhere: compressed views only tell with it how long they are.
#[derive(Serialize)]
pub(super) struct Fallback {
    fallback: bool,
}

impl Fallback {
    pub const fn new() -> Self {
        Self { fallback: true }
    }
}

/// A morph target.
#[derive(Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct MorphTarget {
    pub position: usize,
}

/// Nodes that carry vertices with them.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub name: String,
    /// The node that all joints hang on.
    pub skeleton: usize,
    /// Accessor.
    pub inverse_bind_matrices: usize,
    /// Nodes, in the order of the vertices' numbers.
    pub joints: Vec<usize>,
}

/// A loop of morph targets' weights, or of the turns of joints.
#[derive(Serialize)]
pub(super) struct Animation {
    pub name: &'static str,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Serialize)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: ChannelTarget,
}

#[derive(Serialize)]
pub(super) struct ChannelTarget {
    pub node: usize,
    pub path: &'static str,
}

#[derive(Serialize)]
pub(super) struct AnimationSampler {
    pub input: usize,
    pub interpolation: &'static str,
    pub output: usize,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
fn is_false(is_on: &bool) -> bool {
    !is_on
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
fn is_zero(offset: &u64) -> bool {
    *offset == 0
}
