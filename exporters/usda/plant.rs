//! A plant as a component: meshes, skeleton, materials; levels of detail and seasons as variants.
//!
//! With both, each variant of `lod` holds what all seasons share and the variants of `season` that hold
//! the rest, so that wood is not there once a season.

use std::collections::BTreeMap;

use linden_pipeline::foliage::Placement;
use linden_pipeline::scene::Bounds;
use linden_pipeline::wind::{Binding, Bones};

use super::layer::Layer;
use super::mesh::MeshPrim;
use super::nanite::Nanite;
use super::syntax::{Names, quoted, tuple};
use super::{Writing, bones, collision, instancer, material, mesh, nanite, proxy, skeleton, wind};
use crate::writing::distinct::{MeshPart, PlantModel};
use crate::{ExportError, GENERATOR};

/// What stands before a model's braces, and its recipe.
pub(super) struct Head<'a> {
    /// The prim's name, an identifier.
    pub prim: &'a str,
    /// As people call it.
    pub name: &'a str,
    /// One line.
    pub recipe: &'a str,
    /// `component`, `assembly`.
    pub kind: &'a str,
    /// Which of Unreal's assemblies it is.
    pub nanite: Option<Nanite>,
    /// Sets of variants that the prim itself has, and what is chosen of all there are.
    pub variants: Variants,
    /// The box of all that it may show: browsers of assets see it without reading a mesh.
    pub bounds: Option<Bounds>,
    /// Whether it says what it is for those who learn from pictures.
    pub is_labelled: bool,
    /// Where its foot is in the file that it was grown from.
    pub foot_in_file: Option<[f64; 3]>,
}

/// The attribute of labels, and how the line begins that has it.
pub(super) const LABELS: &str = "semantics:labels:class";
pub(super) const LABELS_TRACE: &str = "token[] semantics:labels:class = ";
/// The scope of what viewports draw, and how the line begins that has it.
const PROXY: &str = "Proxy";
pub(super) const PROXY_TRACE: &str = "def Scope \"Proxy\"";
/// The relationship that leads to it.
pub(super) const PROXY_PRIM: &str = "proxyPrim";

/// The class of a plant (`UsdSemantics`), which says its name too.
const CLASS: &str = "plant";

/// Sets of variants.
#[derive(Default)]
pub(super) struct Variants {
    sets: Vec<&'static str>,
    chosen: Vec<(&'static str, String)>,
}

impl Variants {
    /// The set that stands on the prim itself.
    pub fn first(&self) -> Option<&'static str> {
        self.sets.first().copied()
    }
}

impl Head<'_> {
    /// Opens the prim.
    pub fn open(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        self.open_with(layer, None, None)
    }

    /// Opens the prim of a layer that others name by `identifier`, with a payload.
    pub fn open_with(
        &self,
        layer: &mut Layer<'_, '_>,
        identifier: Option<&str>,
        payload: Option<&str>,
    ) -> Result<(), ExportError> {
        let Self { prim, kind, variants, .. } = self;
        let name = quoted(self.name);
        let recipe = quoted(self.recipe);
        let generator = quoted(GENERATOR);
        let schemas: Vec<&str> = [
            self.bounds.map(|_| "\"GeomModelAPI\""),
            self.is_labelled.then_some("\"SemanticsLabelsAPI:class\""),
            self.nanite.map(|_| "\"NaniteAssemblyRootAPI\""),
        ]
        .into_iter()
        .flatten()
        .collect();
        let schemas = if schemas.is_empty() {
            String::new()
        } else {
            format!("\n    prepend apiSchemas = [{}]", schemas.join(", "))
        };
        let identifier = identifier
            .map_or_else(String::new, |identifier| format!("        asset identifier = {identifier}\n"));
        let mut text = format!(
            r#"def Xform "{prim}" ({schemas}
    assetInfo = {{
{identifier}        string name = {name}
        string version = "1"
    }}
    customData = {{
        dictionary linden = {{
            string generator = {generator}
            string recipe = {recipe}
        }}
    }}
    displayName = {name}
    kind = "{kind}"
"#
        );
        if let [first, ..] = variants.sets.as_slice() {
            text += &format!("    prepend variantSets = \"{first}\"\n    variants = {{\n");
            for (set, variant) in &variants.chosen {
                text += &format!("        string {set} = \"{variant}\"\n");
            }
            text += "    }\n";
        }
        if let Some(payload) = payload {
            text += &format!("    prepend payload = {payload}\n");
        }
        text += ")";
        layer.open(&text)?;
        if let Some(Bounds { min, max }) = self.bounds {
            let [min, max] = [min, max].map(|corner| tuple(corner.to_array()));
            layer.lines(&format!("float3[] extentsHint = [{min}, {max}]"))?;
        }
        if self.is_labelled {
            layer.lines(&format!("{LABELS_TRACE}[\"{CLASS}\", {name}]"))?;
        }
        if let Some(nanite) = self.nanite {
            layer.lines(&nanite.of_root(&format!("/{prim}")))?;
        }
        layer.lines(&format!("custom string userProperties:linden:recipe = {recipe}"))?;
        if let Some([x, y, z]) = self.foot_in_file {
            layer.lines(&format!("custom double3 userProperties:linden:footInFile = ({x}, {y}, {z})"))?;
        }
        layer.lines("\n")
    }
}

/// The prim that meshes are written below.
struct Below {
    path: String,
    /// Whether they have no wind.
    is_still: bool,
}

/// A plant of the stage, to be written below a prim.
pub(super) struct Component<'a> {
    writing: &'a Writing<'a>,
    plant: usize,
    /// The prim that it is written below.
    path: String,
    /// The prims of its materials, by look.
    materials: BTreeMap<usize, String>,
}

impl<'a> Component<'a> {
    pub fn new(writing: &'a Writing<'a>, plant: usize, path: String) -> Self {
        let mut component = Self { writing, plant, path, materials: BTreeMap::new() };
        let mut names = Names::default();
        for model in component.models() {
            for &look in &model.materials {
                let name = &writing.distinct.materials[look].name;
                component.materials.entry(look).or_insert_with(|| names.unique(name));
            }
        }
        component
    }

    /// The box of all its levels and seasons, at rest.
    pub fn bounds(&self) -> Option<Bounds> {
        let parts = self.models().flat_map(|model| &model.parts);
        parts.map(|part| part.copies.as_ref().map_or(part.bounds, |copies| copies.seen)).reduce(Bounds::union)
    }

    /// The sets that the plant's prim has.
    pub fn variants(&self) -> Variants {
        let Self { writing: Writing { stage, .. }, .. } = self;
        let mut variants = Variants::default();
        if self.levels() > 1 {
            variants.sets.push("lod");
            variants.chosen.push(("lod", "LOD0".to_owned()));
        }
        if self.seasons() > 1 {
            variants.sets.push("season");
            variants.chosen.push(("season", stage.plants[self.plant].seasons[0].name.clone()));
        }
        variants
    }

    /// The sets of variants with their names, and nothing in them: what is not loaded can be chosen from.
    pub fn name_variants(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        let (levels, seasons) = (self.levels(), self.seasons());
        if levels == 1 {
            return if seasons > 1 { self.name_seasons(layer) } else { Ok(()) };
        }
        layer.lines("\n")?;
        layer.open_inline("variantSet \"lod\" =")?;
        for level in 0..levels {
            self.open_level(layer, level)?;
            if seasons > 1 {
                self.name_seasons(layer)?;
            }
            layer.close()?;
        }
        layer.close()
    }

    fn name_seasons(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        layer.lines("\n")?;
        layer.open_inline("variantSet \"season\" =")?;
        for season in &self.writing.stage.plants[self.plant].seasons {
            layer.open_inline(&format!("\"{}\"", season.name))?;
            layer.close()?;
        }
        layer.close()
    }

    /// Begins the variant of a level, which has those of the seasons.
    fn open_level(&self, layer: &mut Layer<'_, '_>, level: usize) -> Result<(), ExportError> {
        let nested = if self.seasons() > 1 { " (\n    prepend variantSets = \"season\"\n)" } else { "" };
        layer.open_inline(&format!("\"LOD{level}\"{nested}"))
    }

    /// Everything within its prim.
    pub fn write(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        if self.writing.nanite.is_some() {
            return self.nanite(layer);
        }
        let (levels, seasons) = (self.levels(), self.seasons());
        let geometry = format!("{}/Geometry", self.path);
        let all: Vec<&MeshPart<'_>> = self.models().flat_map(|model| &model.parts).collect();
        wind::open_geometry(layer, &all)?;
        let with_proxy = self.writing.said.proxy && levels > 1;
        if with_proxy {
            let proxy = format!("{}/{PROXY}", self.path);
            layer.lines(&format!("rel {PROXY_PRIM} = <{proxy}>\nuniform token purpose = \"render\"\n"))?;
        }
        if let Some(sway) = wind::sway(&all) {
            wind::write_rig(layer, &geometry, sway, &all)?;
        }
        let mut names = Names::default();
        if levels == 1 {
            self.parts(layer, &self.all_year(0).collect::<Vec<_>>(), &self.geometry(), &mut names)?;
        }
        if self.writing.with_skeleton {
            // It is the same in all levels and seasons.
            let scene = self.model(0, 0).scene;
            skeleton::write(layer, &scene.skeleton, &names.unique("Skeleton"))?;
        }
        layer.close()?;
        layer.lines("\n")?;
        if levels > 1 {
            layer.open_inline("variantSet \"lod\" =")?;
            for level in 0..levels {
                self.open_level(layer, level)?;
                self.over_geometry(layer, &self.all_year(level).collect::<Vec<_>>())?;
                if seasons > 1 {
                    self.of_seasons(layer, level)?;
                }
                layer.close()?;
            }
            layer.close()?;
            layer.lines("\n")?;
        } else if seasons > 1 {
            self.of_seasons(layer, 0)?;
        }
        if with_proxy {
            self.proxy(layer, levels - 1)?;
        }
        if let Some((colliders, told)) = &self.writing.collision {
            collision::write(layer, &colliders[self.plant], told)?;
        }
        self.materials(layer)
    }

    /// Everything within the prim of an assembly: one level in one season.
    fn nanite(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        let (copies, base): (Vec<_>, Vec<_>) = self.all_year(0).partition(|piece| piece.copies.is_some());
        let geometry = self.geometry();
        if let Some(bones) = bones::of(&base) {
            layer.open("def SkelRoot \"Geometry\" (\n    kind = \"component\"\n)")?;
            wind::rest_extent(layer, &base)?;
            bones::write_rig(layer, &geometry.path, bones, &base, true)?;
            self.parts(layer, &base, &geometry, &mut Names::default())?;
            layer.close()?;
            layer.lines("\n")?;
        }
        // Right below the root, as instancers are looked for there.
        let below = Below { path: self.path.clone(), is_still: false };
        self.parts(layer, &copies, &below, &mut Names::default())?;
        self.materials(layer)
    }

    fn materials(&self, layer: &mut Layer<'_, '_>) -> Result<(), ExportError> {
        layer.open("def Scope \"Materials\"")?;
        for (&look, name) in &self.materials {
            let look = &self.writing.distinct.materials[look];
            let path = format!("{}/Materials/{name}", self.path);
            let text =
                material::describe(look.material, name, &path, self.writing.with_materialx, |picture| {
                    self.writing.file(picture)
                });
            layer.lines(&text)?;
        }
        layer.close()
    }

    /// What viewports draw: a level as it is in the first season, thinned. It stands still.
    fn proxy(&self, layer: &mut Layer<'_, '_>, level: usize) -> Result<(), ExportError> {
        layer.open(PROXY_TRACE)?;
        layer.lines("uniform token purpose = \"proxy\"\n\n")?;
        let below = Below { path: format!("{}/{PROXY}", self.path), is_still: true };
        let parts = &self.model(0, level).parts;
        let is_leaf =
            |piece: &MeshPart<'_>| self.writing.distinct.materials[piece.material].material.is_sheet();
        let thinned = proxy::thinned(parts, is_leaf);
        let pieces: Vec<&MeshPart<'_>> = thinned.as_ref().unwrap_or(parts).iter().collect();
        self.parts(layer, &pieces, &below, &mut Names::default())?;
        layer.close()?;
        layer.lines("\n")
    }

    /// Where the plant's meshes are.
    fn geometry(&self) -> Below {
        Below { path: format!("{}/Geometry", self.path), is_still: false }
    }

    fn of_seasons(&self, layer: &mut Layer<'_, '_>, level: usize) -> Result<(), ExportError> {
        layer.open_inline("variantSet \"season\" =")?;
        for (index, season) in self.writing.stage.plants[self.plant].seasons.iter().enumerate() {
            layer.open_inline(&format!("\"{}\"", season.name))?;
            let changing =
                self.model(index, level).parts.iter().filter(|piece| !self.is_all_year(piece, level));
            self.over_geometry(layer, &changing.collect::<Vec<_>>())?;
            layer.close()?;
        }
        layer.close()?;
        layer.lines("\n")
    }

    fn over_geometry(&self, layer: &mut Layer<'_, '_>, pieces: &[&MeshPart<'_>]) -> Result<(), ExportError> {
        let mut names = Names::default();
        layer.open("over \"Geometry\"")?;
        self.parts(layer, pieces, &self.geometry(), &mut names)?;
        layer.close()?;
        layer.lines("\n")
    }

    /// A mesh for each piece that stands as it is, an instancer for the copies of each part.
    fn parts(
        &self,
        layer: &mut Layer<'_, '_>,
        pieces: &[&MeshPart<'_>],
        below: &Below,
        names: &mut Names,
    ) -> Result<(), ExportError> {
        let is_with = |a: &&MeshPart<'_>, b: &&MeshPart<'_>| {
            a.copied_part().is_some() && a.copied_part() == b.copied_part()
        };
        for together in pieces.chunk_by(is_with) {
            match together[0].copied_part() {
                // A name that none of the parts has, in whichever variant it stands.
                Some(part) => {
                    let name = names.unique(&format!("{part}_instances"));
                    self.instancer(layer, together, below, &name)?;
                }
                None => self.mesh(layer, together[0], below, names)?,
            }
        }
        Ok(())
    }

    fn instancer(
        &self,
        layer: &mut Layer<'_, '_>,
        pieces: &[&MeshPart<'_>],
        below: &Below,
        name: &str,
    ) -> Result<(), ExportError> {
        let path = format!("{}/{name}/Prototypes", below.path);
        let stands = || pieces.iter().filter_map(|piece| piece.copies.as_ref());
        let bounds = stands().map(|copies| copies.seen).reduce(Bounds::union);
        let placed: Vec<(u32, Placement)> = (0..)
            .zip(stands())
            .flat_map(|(i, copies)| copies.placements.iter().map(move |at| (i, *at)))
            .collect();
        let mut names = Names::default();
        let paths: Vec<String> =
            pieces.iter().map(|piece| format!("{path}/{}", names.unique(&self.full_name(piece)))).collect();
        let bindings: Vec<Binding> = stands().flat_map(|copies| copies.bindings.iter().copied()).collect();
        let bones = self.bones().filter(|_| bindings.len() == placed.len());
        let schemas =
            bones.map_or("", |_| " (\n    prepend apiSchemas = [\"NaniteAssemblySkelBindingAPI\"]\n)");
        layer.open(&format!("def PointInstancer \"{name}\"{schemas}"))?;
        instancer::write(layer, bounds, &paths, &placed)?;
        if let Some(bones) = bones {
            nanite::write_bindings(layer, &bindings, bones)?;
        }
        layer.open("def Scope \"Prototypes\"")?;
        let mut names = Names::default();
        let below = Below { path, ..*below };
        for piece in pieces {
            if self.writing.nanite.is_some() {
                self.nanite_part(layer, piece, &names.unique(&self.full_name(piece)), &below)?;
            } else {
                self.mesh(layer, piece, &below, &mut names)?;
            }
        }
        layer.close()?;
        layer.close()?;
        layer.lines("\n")
    }

    /// A part of an assembly, as an Xform called `name`: in a skeletal one a skeletal mesh of one joint.
    fn nanite_part(
        &self,
        layer: &mut Layer<'_, '_>,
        piece: &MeshPart<'_>,
        name: &str,
        below: &Below,
    ) -> Result<(), ExportError> {
        let mut path = format!("{}/{name}", below.path);
        layer.open(&format!("def Xform \"{name}\""))?;
        let is_skeletal = self.writing.nanite == Some(Nanite::Skeletal);
        if is_skeletal {
            path += "/Part";
            layer.open("def SkelRoot \"Part\"")?;
            layer.lines(&format!("float3[] extent = {}", wind::corners(piece.bounds)))?;
            nanite::write_part_rig(layer, &path)?;
        }
        let rig = is_skeletal.then_some(path.as_str());
        self.mesh_with(layer, piece, &Below { path: path.clone(), ..*below }, &mut Names::default(), rig)?;
        if is_skeletal {
            layer.close()?;
        }
        layer.close()?;
        layer.lines("\n")
    }

    /// The joints of the plant.
    fn bones(&self) -> Option<&'a Bones> {
        self.model(0, 0).parts.iter().find_map(|piece| piece.wind?.bones.as_deref())
    }

    /// A mesh below a prim.
    fn mesh(
        &self,
        layer: &mut Layer<'_, '_>,
        piece: &MeshPart<'_>,
        below: &Below,
        names: &mut Names,
    ) -> Result<(), ExportError> {
        self.mesh_with(layer, piece, below, names, None)
    }

    /// The same, bound to the joint of a `rig`.
    fn mesh_with(
        &self,
        layer: &mut Layer<'_, '_>,
        piece: &MeshPart<'_>,
        below: &Below,
        names: &mut Names,
        rig: Option<&str>,
    ) -> Result<(), ExportError> {
        let material = self.materials.get(&piece.material).map_or("", String::as_str);
        let binding = format!("{}/Materials/{material}", self.path);
        let name = names.unique(&self.full_name(piece));
        let prim = MeshPrim {
            parent: &below.path,
            name: &name,
            material: &binding,
            wind: piece.wind.filter(|_| !below.is_still),
            rig,
            label: self.writing.said.labels.then_some(&*piece.name),
        };
        mesh::write(layer, &self.writing.distinct, piece, &prim)
    }

    /// What a piece is called also outside of its plant.
    fn full_name(&self, piece: &MeshPart<'_>) -> String {
        self.model(0, 0).full_name(&piece.name)
    }

    /// The pieces that all seasons share.
    fn all_year(&self, level: usize) -> impl Iterator<Item = &'a MeshPart<'a>> {
        self.model(0, level).parts.iter().filter(move |piece| self.is_all_year(piece, level))
    }

    /// Whether it is the same in all seasons, with all that stands in one instancer with it.
    fn is_all_year(&self, piece: &MeshPart<'_>, level: usize) -> bool {
        let Some(part) = piece.copied_part() else { return self.is_in_all(piece, level) };
        let of_seasons = (0..self.seasons()).flat_map(|season| &self.model(season, level).parts);
        of_seasons.filter(|piece| piece.copied_part() == Some(part)).all(|piece| self.is_in_all(piece, level))
    }

    fn is_in_all(&self, piece: &MeshPart<'_>, level: usize) -> bool {
        let is_in = |season| self.model(season, level).parts.iter().any(|other| other.is_same(piece));
        (0..self.seasons()).all(is_in)
    }

    fn model(&self, season: usize, level: usize) -> &'a PlantModel<'a> {
        let distinct = &self.writing.distinct;
        &distinct.models[distinct.model(self.plant, season, level)]
    }

    fn models(&self) -> impl Iterator<Item = &'a PlantModel<'a>> + use<'a> {
        let first = self.writing.distinct.model(self.plant, 0, 0);
        self.writing.distinct.models[first..first + self.levels() * self.seasons()].iter()
    }

    fn levels(&self) -> usize {
        self.writing.distinct.levels(self.plant)
    }

    fn seasons(&self) -> usize {
        self.writing.distinct.seasons(self.plant)
    }
}
