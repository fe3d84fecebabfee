//! What an exporter is given: everything that can be seen, and where it came from.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::foliage::{DressedOrgans, Instances};
use crate::wind::PartWind;
pub use linden_base::mesh::{Bounds, Mesh};
use linden_base::picture::Picture;
use linden_skeleton::Skeleton;

/// One tree, dressed: meshes, materials, the skeleton beneath and the recipe that grew it.
///
/// Metres, Y up, counter-clockwise triangles seen from outside.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The tree's name: not empty; printable characters only, but any of them (an exporter makes
    /// an identifier of it).
    pub name: String,
    /// The recipe, one line of printable ASCII (JSON): enough to grow the same tree again.
    pub recipe: String,
    /// Parts refer to these by index.
    pub materials: Vec<Material>,
    /// The parts of the surface; at least one, none of them empty.
    pub parts: Vec<Part>,
    /// The axial tree beneath.
    pub skeleton: Arc<Skeleton>,
    /// What grows on the wood, one by one: the parts show it.
    pub organs: DressedOrgans,
    /// Where its foot is in the file that it was grown from, a scan or a table of cylinders, in that file's axes and units: far
    /// from the origin where they are those of a country. `None` of what has no place in a file.
    pub foot_in_file: Option<DVec3>,
}

impl Scene {
    /// Triangles of all its parts.
    pub fn triangles(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }

    /// Bytes that it takes: skeleton, meshes and pixels.
    pub fn bytes(&self) -> u64 {
        let pixels = |picture: &Arc<Picture>| picture.rgba().len() as u64;
        let pictures = self.materials.iter().flat_map(Material::pictures);
        self.skeleton.bytes()
            + pictures.map(pixels).sum::<u64>()
            + self.parts.iter().map(Part::bytes).sum::<u64>()
            // Parts hold on to the same organs.
            + self.organs.bytes()
    }
}

/// A mesh with one material: the wood, say.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Lower-case ASCII identifier, unique within the scene: `wood`.
    pub name: String,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// The geometry.
    pub mesh: Mesh,
    /// How its vertices swing; `None`: they do not.
    pub wind: Option<PartWind>,
    /// The copies of few meshes that its mesh was baked from, where it was.
    pub instances: Option<Instances>,
}

impl Part {
    /// Without wind, of one piece.
    pub fn new(name: impl Into<String>, material: usize, mesh: Mesh) -> Self {
        Self { name: name.into(), material, mesh, wind: None, instances: None }
    }

    /// Bytes that it takes, without what it shares with other parts.
    pub fn bytes(&self) -> u64 {
        self.mesh.bytes() + self.wind.as_ref().map_or(0, PartWind::bytes)
    }
}

/// How a surface looks, in the terms that glTF and `UsdPreviewSurface` share.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Lower-case ASCII identifier, unique within the scene: `bark`.
    pub name: String,
    /// Linear RGB 0..1: the colour where there is no picture; with one, pictures are used as they are.
    pub base_color: [f32; 3],
    /// sRGB colours, tileable.
    pub base_color_picture: Option<Arc<Picture>>,
    /// Tangent-space normals (OpenGL convention: green points up), tileable.
    pub normal_picture: Option<Arc<Picture>>,
    /// 0 mirror .. 1 chalk.
    pub roughness: f32,
    /// Whether the back is drawn too.
    pub double_sided: bool,
    /// Where the base colour picture's alpha is below this (above 0, below 1), nothing is drawn: cut
    /// out, never blended. `None`: all is opaque.
    pub cutout: Option<f32>,
    /// How pictures continue beyond their edges.
    pub wrap: Wrap,
    /// What passes through it: foliage. `None`: nothing.
    pub translucency: Option<Translucency>,
    /// How much of that passes where, the same in each channel (glTF asks for alpha, others read the first): all of it
    /// through a single leaf, less where several lie one behind another, nothing through wood. As large as the base colour
    /// picture. `None`: all of it everywhere.
    pub passing_picture: Option<Arc<Picture>>,
}

impl Material {
    /// Whether light comes to it from both sides: a leaf. What is closed, as wood is, is seen from outside alone; so are the
    /// two faces of a leaf whose under side is drawn, and these are cut out.
    pub fn is_sheet(&self) -> bool {
        self.double_sided || self.cutout.is_some()
    }

    /// All pictures of it.
    pub fn pictures(&self) -> impl Iterator<Item = &Arc<Picture>> {
        [&self.base_color_picture, &self.normal_picture, &self.passing_picture].into_iter().flatten()
    }
}

/// Light that a thin surface scatters out of its other side: leaves.
///
/// The base colour is all that the surface scatters, to both sides together. `share` of that leaves on the
/// other side, in the base colour times `tint`; the rest is reflected in the base colour. Programs that know
/// of no translucency reflect all of it, so that foliage is as bright there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translucency {
    /// Above 0, below 1.
    pub share: f32,
    /// Linear RGB 0..1, by which light that has passed differs from light that comes back.
    pub tint: [f32; 3],
}

impl Translucency {
    /// Green leaves absorb most of the blue in their depth, and some of the red: reflectance and transmittance
    /// of broad leaves at 450, 550 and 650 nm are about 5, 12, 5 % and 1, 11, 4 % (Jacquemoud & Baret 1990,
    /// "PROSPECT: a model of leaf optical properties spectra", figure 5).
    pub const LEAF_TINT: [f32; 3] = [0.95, 1.0, 0.5];

    /// How much of the light that falls on a surface of a colour, linear, leaves on its other side: luminance (ITU-R
    /// BT.709).
    pub fn passing(&self, color: Vec3) -> f32 {
        const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);
        self.share * (color * Vec3::from(self.tint)).dot(LUMINANCE)
    }

    /// A leaf's; `None` where no light passes.
    pub fn leaf(share: f32) -> Option<Self> {
        (share > 0.0).then_some(Self { share, tint: Self::LEAF_TINT })
    }
}

/// How a picture continues at texture coordinates outside of 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again: bark.
    #[default]
    Repeat,
    /// The picture's edge: leaves.
    Clamp,
}
