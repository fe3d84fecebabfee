//! What a file holds, whatever its format: pieces that are drawn, in levels of detail, with materials and pictures.

use std::collections::{BTreeMap, BTreeSet};

use glam::{Affine3A, Vec2, Vec3};
use serde::Serialize;

/// A tree's file, or several that hold a level of detail each.
#[derive(Clone, Debug, Default)]
pub struct Asset {
    /// As the caller names it.
    pub name: String,
    /// What it was read from.
    pub format: FileFormat,
    /// Triangles, each mesh of one material.
    pub meshes: Vec<Mesh>,
    /// What they look like.
    pub materials: Vec<Material>,
    /// Pictures that materials name.
    pub textures: Vec<Texture>,
    /// The finest first; at least one.
    pub levels: Vec<Level>,
    /// Pieces for collisions, which are not drawn.
    pub colliders: Vec<Piece>,
    /// What the file does not say, or what cannot be read of it.
    pub unseen: Vec<Unseen>,
}

/// Formats that are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FileFormat {
    /// glTF as text.
    #[default]
    Gltf,
    /// glTF in one file.
    Glb,
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// OpenUSD: text, binary, or a package.
    Usd,
}

/// Triangles of one material.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// As the file calls it.
    pub name: String,
    /// Which of the asset's materials.
    pub material: Option<usize>,
    /// How many there are.
    pub vertices: usize,
    /// How many there are.
    pub triangles: usize,
    /// `None` where it cannot be read; [`Asset::unseen`] says why.
    pub geometry: Option<Geometry>,
}

/// Vertices and triangles, in the units of the mesh.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Places of the vertices.
    pub positions: Vec<Vec3>,
    /// As many as positions.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates of the first and the second set; as many as positions.
    pub uvs: [Option<Vec<Vec2>>; 2],
    /// Indices of positions, each in range.
    pub triangles: Vec<[u32; 3]>,
}

/// How a material uses the transparency of its picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Alpha {
    /// Transparency does not count.
    Opaque,
    /// Cut out: each pixel is there or not.
    Mask,
    /// Mixed with what is behind.
    Blend,
}

#[derive(Clone, Debug, Default, PartialEq)]

/// What a mesh looks like.
pub struct Material {
    /// As the file calls it.
    pub name: String,
    /// `None` where the format cannot say.
    pub alpha: Option<Alpha>,
    /// Whether a picture cuts holes into it, in formats that do not say how.
    pub is_cut: bool,
    /// Whether it is seen from behind; `None` where the format cannot say.
    pub double_sided: Option<bool>,
    /// The picture of colours.
    pub color: Option<TextureUse>,
    /// All other pictures.
    pub others: Vec<TextureUse>,
}

/// A picture on a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// Which of the asset's pictures.
    pub texture: usize,
    /// Which set of texture coordinates.
    pub set: usize,
    /// How often it lies on a unit of texture coordinates (`KHR_texture_transform`).
    pub scale: Vec2,
}

/// A picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texture {
    /// As the file calls it.
    pub name: String,
    /// Pixels.
    pub size: Option<[u32; 2]>,
    /// Why there is no size.
    pub problem: Option<String>,
}

/// What is drawn at one distance.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// 0 is the finest.
    pub number: u32,
    /// All that is drawn.
    pub pieces: Vec<Piece>,
}

/// A mesh in one or more places: one draw call.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Which of the asset's meshes.
    pub mesh: usize,
    /// The node, object or prim.
    pub node: String,
    /// In metres, Y up; at least one.
    pub places: Vec<Affine3A>,
}

/// A part of what can be known of an asset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Aspect {
    /// Positions and triangles.
    Geometry,
    /// Normals of vertices.
    Normals,
    /// Texture coordinates.
    Uvs,
    /// A second set of them.
    SecondUvs,
    /// Materials and which pictures they have.
    Materials,
    /// Whether materials are opaque, cut out or blended.
    Alpha,
    /// The sizes of pictures.
    Pictures,
    /// What things are called.
    Names,
    /// Levels of detail.
    Levels,
    /// Meshes for collisions.
    Colliders,
    /// Where its pieces stand.
    Places,
}

/// What cannot be looked at, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unseen {
    /// What.
    pub aspect: Aspect,
    /// For people.
    pub why: String,
}

/// Words in names of materials and meshes that are cut out of pictures, whatever the format can say.
const FOLIAGE: [&str; 11] = [
    "leaf",
    "leaves",
    "foliage",
    "needle",
    "frond",
    "blossom",
    "flower",
    "petal",
    "card",
    "billboard",
    "twig",
];

impl Asset {
    /// Notes what cannot be looked at, each once.
    pub fn note(&mut self, aspect: Aspect, why: impl Into<String>) {
        let unseen = Unseen { aspect, why: why.into() };
        if !self.unseen.contains(&unseen) {
            self.unseen.push(unseen);
        }
    }

    /// What is drawn near by.
    pub fn finest(&self) -> &[Piece] {
        self.levels.first().map_or(&[], |level| &level.pieces)
    }

    /// All pieces that are drawn at some level.
    pub fn pieces(&self) -> impl Iterator<Item = &Piece> {
        self.levels.iter().flat_map(|level| &level.pieces)
    }

    /// Meshes with their geometry, as far as that is known, in their order; those for collisions too.
    pub fn geometries(&self) -> impl Iterator<Item = (&Mesh, &Geometry)> {
        self.meshes.iter().filter_map(|mesh| Some((mesh, mesh.geometry.as_ref()?)))
    }

    /// Those that are drawn.
    pub fn drawn(&self) -> impl Iterator<Item = (&Mesh, &Geometry)> {
        let is_drawn = |index: usize| self.pieces().any(|piece| piece.mesh == index);
        let drawn: Vec<bool> = (0..self.meshes.len()).map(is_drawn).collect();
        self.meshes
            .iter()
            .zip(drawn)
            .filter_map(|(mesh, is)| Some((mesh, mesh.geometry.as_ref().filter(|_| is)?)))
    }

    /// The material of a mesh.
    pub fn material_of(&self, mesh: &Mesh) -> Option<&Material> {
        self.materials.get(mesh.material?)
    }

    /// How many materials of each name are drawn at most at one level: what levels share has a copy in each file of
    /// one, and differs in how its pictures are stretched alone.
    pub fn materials_by_name(&self) -> BTreeMap<&str, usize> {
        let mut most: BTreeMap<&str, usize> = BTreeMap::new();
        for level in &self.levels {
            let used = level.pieces.iter().filter_map(|piece| self.meshes[piece.mesh].material);
            let used: BTreeSet<usize> = used.collect();
            let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
            for material in used.into_iter().filter_map(|index| self.materials.get(index)) {
                *counts.entry(material.name.trim()).or_default() += 1;
            }
            for (name, count) in counts {
                let most = most.entry(name).or_default();
                *most = count.max(*most);
            }
        }
        most
    }

    /// Materials that no level draws.
    pub fn unused_materials(&self) -> impl Iterator<Item = &Material> {
        let used: BTreeSet<usize> =
            self.pieces().filter_map(|piece| self.meshes[piece.mesh].material).collect();
        self.materials
            .iter()
            .enumerate()
            .filter_map(move |(index, material)| (!used.contains(&index)).then_some(material))
    }

    /// Whether a mesh is made of flat pieces that pictures cut out: leaves, needles, billboards. They are open and seen
    /// from both sides, and their normals often are the crown's.
    pub fn is_foliage(&self, mesh: &Mesh) -> bool {
        let named = |name: &str| {
            let name = name.to_lowercase();
            FOLIAGE.iter().any(|word| name.contains(word))
        };
        self.material_of(mesh).is_some_and(Material::is_cut_out)
            || named(&mesh.name)
            || self.material_of(mesh).is_some_and(|material| named(&material.name))
    }

    /// All triangles of a level, in all places.
    pub fn triangles_of(&self, level: &Level) -> u64 {
        let of = |piece: &Piece| self.meshes[piece.mesh].triangles as u64 * piece.places.len() as u64;
        level.pieces.iter().map(of).sum()
    }

    /// One asset of several files that hold a level each.
    #[must_use]
    pub fn join(name: &str, levels: Vec<(u32, Self)>) -> Self {
        let mut whole = Self { name: name.to_owned(), ..Self::default() };
        for (number, asset) in levels {
            let meshes = whole.meshes.len();
            let textures: Vec<usize> =
                asset.textures.into_iter().map(|texture| place(&mut whole.textures, texture)).collect();
            let moved = |used: TextureUse| TextureUse { texture: textures[used.texture], ..used };
            let materials: Vec<usize> = asset
                .materials
                .into_iter()
                .map(|material| Material {
                    color: material.color.map(moved),
                    others: material.others.iter().copied().map(moved).collect(),
                    ..material
                })
                .map(|material| place(&mut whole.materials, material))
                .collect();
            whole.format = asset.format;
            whole.meshes.extend(asset.meshes.into_iter().map(|mesh| Mesh {
                name: format!("{} (level {number})", mesh.name),
                material: mesh.material.map(|material| materials[material]),
                ..mesh
            }));
            let shift = |piece: Piece| Piece { mesh: piece.mesh + meshes, ..piece };
            let pieces = asset.levels.into_iter().take(1).flat_map(|level| level.pieces).map(shift).collect();
            whole.levels.push(Level { number, pieces });
            whole.colliders.extend(asset.colliders.into_iter().map(shift));
            asset.unseen.into_iter().for_each(|unseen| whole.note(unseen.aspect, unseen.why));
        }
        whole
    }
}

/// The index of what levels may share.
fn place<T: PartialEq>(known: &mut Vec<T>, item: T) -> usize {
    known.iter().position(|other| *other == item).unwrap_or_else(|| {
        known.push(item);
        known.len() - 1
    })
}

impl Material {
    /// Whether holes are cut into it.
    pub fn is_cut_out(&self) -> bool {
        self.is_cut || matches!(self.alpha, Some(Alpha::Mask | Alpha::Blend))
    }

    /// All pictures on it.
    pub fn uses(&self) -> impl Iterator<Item = &TextureUse> {
        self.color.iter().chain(&self.others)
    }
}

impl Geometry {
    /// The places of a triangle's vertices.
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|vertex| self.positions[vertex as usize])
    }
}
