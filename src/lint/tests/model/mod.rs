//! A small tree without any fault, made by hand and written as glTF: a trunk, cards, two levels, a collider.

#![allow(dead_code, reason = "each test takes what it needs")]

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{Vec2, Vec3};
use linden_base::monitor::Quiet;
use linden_lint::{Asset, NoFiles, read};
use serde_json::{Value, json};

/// A mesh in a node of the same name.
#[derive(Clone, Default)]
pub struct Part {
    pub name: String,
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    /// The second set.
    pub light: Vec<Vec2>,
    pub triangles: Vec<[u32; 3]>,
    pub material: usize,
}

pub struct Model {
    pub parts: Vec<Part>,
    /// As the document has them.
    pub materials: Vec<Value>,
    /// Pixels of each picture.
    pub pictures: Vec<[u32; 2]>,
    /// Changes of the document after all else.
    pub edit: fn(&mut Value),
}

/// A box with a cell of the picture for each side.
pub fn solid(name: &str, low: Vec3, high: Vec3) -> Part {
    let mut part = Part { name: name.to_owned(), ..Part::default() };
    for side in 0..6_u32 {
        let (axis, is_high) = (side as usize / 2, side % 2 == 1);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let first = part.positions.len() as u32;
        for (a, b) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let mut at = [0.0; 3];
            at[axis] = if is_high { high[axis] } else { low[axis] };
            at[u] = low[u] + a * (high[u] - low[u]);
            at[v] = low[v] + b * (high[v] - low[v]);
            part.positions.push(Vec3::from(at));
            let mut normal = [0.0; 3];
            normal[axis] = if is_high { 1.0 } else { -1.0 };
            part.normals.push(Vec3::from(normal));
            let cell = Vec2::new((side % 3) as f32, (side / 3) as f32);
            part.uvs.push((cell + Vec2::new(0.1 + 0.8 * a, 0.1 + 0.8 * b)) / Vec2::new(3.0, 2.0));
        }
        let corners = if is_high { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
        part.triangles.extend(corners.map(|corners| corners.map(|corner: u32| first + corner)));
    }
    part.light.clone_from(&part.uvs);
    part
}

/// Upright squares side by side, each with a cell of the picture.
pub fn cards(name: &str, count: usize) -> Part {
    let mut part = Part { name: name.to_owned(), material: 1, ..Part::default() };
    for card in 0..count {
        // The outermost ones first, so that fewer reach as far.
        let x = if card % 2 == 0 { -1.0 } else { 1.0 } * (1.0 - 0.1 * (card / 2) as f32);
        let first = part.positions.len() as u32;
        for (a, b) in [(-0.1, 0.0), (0.1, 0.0), (0.1, 0.2), (-0.1, 0.2)] {
            part.positions.push(Vec3::new(x + a, 2.8 + b, 0.01 * card as f32));
            part.normals.push(Vec3::Z);
            let cell = Vec2::new((card % 4) as f32, (card / 4) as f32);
            part.uvs.push((cell + Vec2::new(0.5 + 4.0 * a, 0.1 + 4.0 * b)) / 4.0);
        }
        part.triangles
            .extend([[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|corner: u32| first + corner)));
    }
    part
}

impl Model {
    pub fn clean() -> Self {
        let trunk = |name: &str| solid(name, Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 2.9, 0.1));
        let mut collider = trunk("UCX_oak");
        (collider.uvs, collider.light) = (Vec::new(), Vec::new());
        let material = |name: &str, texture: usize| json!({"name": name, "pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}});
        let mut leaves = material("oak_leaves", 1);
        leaves["alphaMode"] = "MASK".into();
        leaves["doubleSided"] = true.into();
        Self {
            parts: vec![
                trunk("oak_trunk_LOD0"),
                cards("oak_leaves_LOD0", 10),
                trunk("oak_trunk_LOD1"),
                cards("oak_leaves_LOD1", 2),
                collider,
            ],
            materials: vec![material("oak_bark", 0), leaves],
            pictures: vec![[512, 1024], [256, 256]],
            edit: |_| (),
        }
    }

    pub fn part(&mut self, name: &str) -> &mut Part {
        self.parts.iter_mut().find(|part| part.name == name).unwrap()
    }

    /// As a `.gltf` with everything inside.
    pub fn gltf(&self) -> Vec<u8> {
        let mut file = Writer::default();
        let mut meshes = Vec::new();
        for part in &self.parts {
            let mut attributes =
                json!({"POSITION": file.floats("VEC3", part.positions.iter().flat_map(Vec3::to_array))});
            let bounds = |pick: fn(Vec3, Vec3) -> Vec3| {
                part.positions
                    .iter()
                    .copied()
                    .filter(|at| at.is_finite())
                    .reduce(pick)
                    .map(|at| at.to_array())
            };
            if let Some(accessor) = file.accessors.last_mut() {
                (accessor["min"], accessor["max"]) = (json!(bounds(Vec3::min)), json!(bounds(Vec3::max)));
            }
            for (name, kind, values) in [
                ("NORMAL", "VEC3", part.normals.iter().flat_map(Vec3::to_array).collect::<Vec<f32>>()),
                ("TEXCOORD_0", "VEC2", part.uvs.iter().flat_map(Vec2::to_array).collect()),
                ("TEXCOORD_1", "VEC2", part.light.iter().flat_map(Vec2::to_array).collect()),
            ] {
                if !values.is_empty() {
                    attributes[name] = file.floats(kind, values).into();
                }
            }
            let indices = file.indices(part.triangles.iter().flatten().copied());
            let primitive = json!({"attributes": attributes, "indices": indices, "material": part.material});
            meshes.push(json!({"name": part.name, "primitives": [primitive]}));
        }
        let images: Vec<Value> = self.pictures.iter().map(|&size| json!({"uri": picture(size)})).collect();
        let nodes: Vec<Value> =
            self.parts.iter().enumerate().map(|(i, part)| json!({"name": part.name, "mesh": i})).collect();
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&file.bytes));
        let mut document = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
            "nodes": nodes, "meshes": meshes, "materials": self.materials,
            "textures": (0..images.len()).map(|i| json!({"source": i})).collect::<Vec<_>>(), "images": images,
            "accessors": file.accessors, "bufferViews": file.views,
            "buffers": [{"byteLength": file.bytes.len(), "uri": uri}],
        });
        (self.edit)(&mut document);
        serde_json::to_vec(&document).unwrap()
    }

    pub fn read(&self) -> Asset {
        read("oak.gltf", &self.gltf(), &NoFiles, &Quiet).unwrap()
    }
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Writer {
    fn floats(&mut self, kind: &str, values: impl IntoIterator<Item = f32>) -> usize {
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        let width = if kind == "VEC3" { 3 } else { 2 };
        self.accessor(kind, 5126, bytes.len() / 4 / width, &bytes)
    }

    fn indices(&mut self, values: impl IntoIterator<Item = u32>) -> usize {
        let bytes: Vec<u8> = values.into_iter().flat_map(u32::to_le_bytes).collect();
        self.accessor("SCALAR", 5125, bytes.len() / 4, &bytes)
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({"bufferView": view, "type": kind, "componentType": component, "count": count}));
        self.accessors.len() - 1
    }
}

fn picture([width, height]: [u32; 2]) -> String {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(width, height).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    format!("data:image/png;base64,{}", STANDARD.encode(bytes.into_inner()))
}
