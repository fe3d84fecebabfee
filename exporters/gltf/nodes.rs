//! The scene graph: what stands where, in which levels of detail.
//!
//! A tree alone has a node and a mesh per part. In a forest a plant is one mesh with a primitive per
//! part, so that a place is a single node, and nodes of the same plant share its mesh; where its places are instances,
//! there is a node and a mesh per part again, for primitives have no names.

use glam::Vec3;
use linden_pipeline::foliage::Placement;
use linden_pipeline::stage::{Place, Stage};
use linden_pipeline::wind::Bones;

use super::bones::{self, Rig};
use super::buffer::{Layout, PrimitiveArrays};
use super::document::{
    Camera, Extras, InstanceAttributes, Instancing, Light, Lod, Mesh, MorphTarget, Node, NodeExtensions,
    Primitive, Skin,
};
use super::facts::TreeFacts;
use super::quantize::{self, Cube};
use super::{recipe, setting};
use crate::Options;
use crate::writing::distinct::{DistinctMeshes, MeshCopies, MeshPart};
use crate::writing::has_bones;
use crate::writing::identifier;

/// The graph and what it refers to. The first node carries the recipe and all plants.
pub(super) struct SceneGraph {
    pub nodes: Vec<Node>,
    /// Those that no other node carries.
    pub roots: Vec<usize>,
    pub meshes: Vec<Mesh>,
    pub skins: Vec<Skin>,
    /// The trees that have joints.
    pub rigs: Vec<Rig>,
    pub cameras: Vec<Camera>,
    pub lights: Option<Vec<Light>>,
    pub extensions: Vec<&'static str>,
    /// Those without which a reader would show something else.
    pub required: Vec<&'static str>,
}

/// What says that a mesh stands in many places.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Whether trees stand as instances: what moves by joints of its own cannot.
pub(super) fn are_instances(stage: &Stage<'_>, options: &Options) -> bool {
    options.is_on("instances") && !stage.is_single() && !has_bones(stage)
}

/// Lays out where each plant stands, for a node per plant instead of one per place.
pub(super) fn lay_out_instances(stage: &Stage<'_>, layout: &mut Layout) -> Vec<Instancing> {
    (0..stage.plants.len())
        .map(|plant| {
            let cube = layout.quanta.as_ref().map(|quanta| quanta.cube(plant));
            let places = || stage.places.iter().filter(|place| place.plant == plant);
            let moves: Vec<Move> = places().map(|place| Move::new(place, cube)).collect();
            let translations: Vec<_> = moves.iter().map(|moved| moved.translation.to_array()).collect();
            let rotations: Vec<_> = places().map(|place| place.rotation().to_array()).collect();
            let scales: Vec<_> = moves.iter().map(|moved| [moved.scale; 3]).collect();
            let attributes = InstanceAttributes {
                translation: layout.push_vectors(&translations, "VEC3"),
                rotation: layout.push_vectors(&rotations, "VEC4"),
                scale: layout.push_vectors(&scales, "VEC3"),
            };
            Instancing { attributes }
        })
        .collect()
}

/// Lays out where pieces stand that stand in many places: an entry for each piece.
pub(super) fn lay_out_copies(distinct: &DistinctMeshes<'_>, layout: &mut Layout) -> Vec<Option<Instancing>> {
    let cubes: Vec<Option<Cube>> = layout.primitives.iter().map(PrimitiveArrays::cube).collect();
    let of_piece = |(piece, cube): (&MeshPart<'_>, Option<Cube>)| {
        let placements = &piece.copies.as_ref()?.placements;
        // The cube is within the copy: what is stored is first put where the mesh has it.
        let moved = |placement: &Placement| {
            cube.map_or(placement.position, |cube| placement.point(cube.corner)).to_array()
        };
        let scale = |placement: &Placement| [placement.scale * cube.map_or(1.0, |cube| cube.side); 3];
        let translations: Vec<_> = placements.iter().map(moved).collect();
        let rotations: Vec<_> = placements.iter().map(|placement| placement.rotation.to_array()).collect();
        let scales: Vec<_> = placements.iter().map(scale).collect();
        let attributes = InstanceAttributes {
            translation: layout.push_vectors(&translations, "VEC3"),
            rotation: layout.push_vectors(&rotations, "VEC4"),
            scale: layout.push_vectors(&scales, "VEC3"),
        };
        Some(Instancing { attributes })
    };
    distinct.parts().zip(cubes).map(of_piece).collect()
}

/// Where things stand that stand in many places, where instances were asked for.
#[derive(Default)]
pub(super) struct Standing {
    /// An entry for each plant; none where each place has a node.
    pub plants: Vec<Instancing>,
    /// Leaves of a plant that stands alone, cover of the ground: an entry for each piece; none where each copy has a
    /// node.
    pub pieces: Vec<Option<Instancing>>,
    /// Inverse bind matrices of each plant with joints.
    pub binds: Vec<Option<usize>>,
}

/// Builds the graph; `layout` is that of the meshes. Levels are siblings below one node, or else those of `MSFT_lod`.
pub(super) fn nodes(
    stage: &Stage<'_>,
    distinct: &DistinctMeshes<'_>,
    layout: &Layout,
    standing: &Standing,
    are_siblings: bool,
) -> SceneGraph {
    let (instances, copies) = (standing.plants.as_slice(), standing.pieces.as_slice());
    let arrays = &layout.primitives;
    let root = Node {
        name: stage.name.clone(),
        extras: Extras {
            linden: recipe(&stage.recipe),
            linden_tree: stage.is_single().then(|| of_whole(stage, distinct)).flatten(),
            linden_foot_in_file: crate::recipe::foot_in_file(stage),
            ..Extras::default()
        },
        ..Node::default()
    };
    let mut graph = Graph {
        stage,
        distinct,
        layout,
        copies,
        are_siblings,
        are_instances: !instances.is_empty(),
        binds: &standing.binds,
        bones: bones::of_plants(distinct),
        nodes: vec![root],
        skinned: Vec::new(),
        meshes: Vec::new(),
        skins: Vec::new(),
        rigs: Vec::new(),
        first_mesh: Vec::new(),
    };
    graph.add_meshes(arrays);
    graph.nodes[0].children = if instances.is_empty() { graph.plants() } else { graph.instances(instances) };
    let mut extensions = Vec::new();
    if graph.nodes.iter().any(|node| node.extensions.lod.is_some()) {
        extensions.push("MSFT_lod");
    }
    let mut required = Vec::new();
    if layout.quanta.is_some() {
        extensions.extend(quantize::EXTENSIONS);
        required.extend(quantize::EXTENSIONS);
    }
    let Graph { mut nodes, mut meshes, skinned, skins, rigs, .. } = graph;
    let (mut cameras, mut lights) = (Vec::new(), None);
    let mut roots: Vec<usize> = std::iter::once(0).chain(skinned).collect();
    if let Some(setting) = &stage.setting {
        extensions.extend(setting::EXTENSIONS);
        let first = nodes.len();
        add_surroundings(distinct, (arrays, copies), &mut nodes, &mut meshes);
        nodes.push(setting::camera_node(setting));
        cameras.push(setting::camera(&setting.camera));
        let shining = setting::lights(setting);
        nodes.extend(
            shining
                .iter()
                .enumerate()
                .map(|(index, (light, rotation))| setting::light_node(light, *rotation, index)),
        );
        lights = Some(shining.into_iter().map(|(light, _)| light).collect());
        roots.extend(first..nodes.len());
    }
    if nodes.iter().any(|node| node.extensions.instancing.is_some()) {
        extensions.push(INSTANCING);
        required.push(INSTANCING);
    }
    SceneGraph { nodes, roots, meshes, skins, rigs, cameras, lights, extensions, required }
}

/// Adds what stands around the plants: a mesh for each piece, and a node for each of its places unless these are instances.
fn add_surroundings(
    distinct: &DistinctMeshes<'_>,
    (arrays, copies): (&[PrimitiveArrays], &[Option<Instancing>]),
    nodes: &mut Vec<Node>,
    meshes: &mut Vec<Mesh>,
) {
    let offset = arrays.len() - distinct.surroundings().count();
    for (piece, index) in distinct.surroundings().zip(offset..) {
        let name = piece.name.to_string();
        let mesh = Some(meshes.len());
        let node = || Node { name: name.clone(), mesh, ..Node::default() };
        let instancing = copies.get(index).copied().flatten();
        let extensions = NodeExtensions { instancing, ..NodeExtensions::default() };
        match &piece.copies {
            Some(MeshCopies { placements, .. }) if instancing.is_none() => {
                nodes.extend(placements.iter().map(|at| Node {
                    translation: Some(at.position.to_array()),
                    rotation: Some(at.rotation.to_array()),
                    scale: Some([at.scale; 3]),
                    ..node()
                }));
            }
            _ => nodes.push(Node { extensions, ..node() }),
        }
        let primitives = vec![primitive(piece, &arrays[index])];
        meshes.push(Mesh { name, primitives, extras: Extras::default() });
    }
}

struct Graph<'a> {
    stage: &'a Stage<'a>,
    distinct: &'a DistinctMeshes<'a>,
    layout: &'a Layout,
    /// By piece, and so by mesh where each has its own.
    copies: &'a [Option<Instancing>],
    are_siblings: bool,
    /// Trees of a forest have all of their places in one node for each part.
    are_instances: bool,
    /// By plant: accessors of inverse bind matrices, and the joints.
    binds: &'a [Option<usize>],
    bones: Vec<Option<&'a Bones>>,
    nodes: Vec<Node>,
    /// Nodes of plants with joints: roots of the scene.
    skinned: Vec<usize>,
    meshes: Vec<Mesh>,
    skins: Vec<Skin>,
    rigs: Vec<Rig>,
    /// The first mesh of each model.
    first_mesh: Vec<usize>,
}

impl Graph<'_> {
    fn add_meshes(&mut self, arrays: &[PrimitiveArrays]) {
        let is_parted = self.are_instances || is_parted(self.stage, self.distinct);
        let mut arrays = arrays.iter();
        for (plant, stage_plant) in self.stage.plants.iter().enumerate() {
            let levels = self.distinct.levels(plant);
            for (index, model) in self.distinct.models_of(plant).iter().enumerate() {
                let in_season = self.season(plant, index / levels).map(|season| format!("_{season}"));
                let suffix = in_season.unwrap_or_default() + &suffix(index % levels, levels);
                // All parts of a plant have the same.
                let (mut linden_wind_cube, mut swings) = (None, false);
                let primitives = model.parts.iter().zip(&mut arrays).map(|(piece, arrays)| {
                    linden_wind_cube = linden_wind_cube.or(arrays.wind_cube());
                    swings |= arrays.wind.texels.is_some();
                    (primitive(piece, arrays), arrays.wind.names())
                });
                let primitives: Vec<(Primitive, Vec<&'static str>)> = primitives.collect();
                let told = swings.then(|| self.layout.wind_as.told(plant)).flatten();
                self.first_mesh.push(self.meshes.len());
                if is_parted {
                    self.meshes.extend(model.parts.iter().zip(primitives).map(
                        |(piece, (primitive, target_names))| Mesh {
                            name: if self.are_instances {
                                // Trees of a kind have numbers: `english_oak_2_wood`.
                                format!("{}_{}{suffix}", identifier(&stage_plant.name), piece.name)
                            } else {
                                format!("{}{suffix}", model.full_name(&piece.name))
                            },
                            primitives: vec![primitive],
                            extras: Extras {
                                target_names,
                                linden_pivot_painter: told.clone(),
                                linden_wind_cube,
                                ..Extras::default()
                            },
                        },
                    ));
                } else {
                    // The forest's recipe is the root's; each tree has its own beside.
                    let is_single = self.stage.is_single();
                    let linden = if is_single { None } else { recipe(&model.scene.recipe) };
                    let level = index % levels;
                    let facts = || TreeFacts::of_level(stage_plant, level, model);
                    let linden_tree = if is_single { None } else { facts() };
                    let (primitives, names): (Vec<_>, Vec<_>) = primitives.into_iter().unzip();
                    let target_names = names.into_iter().next().unwrap_or_default();
                    let extras = Extras {
                        linden,
                        linden_tree,
                        target_names,
                        linden_pivot_painter: told,
                        linden_wind_cube,
                        ..Extras::default()
                    };
                    // A billboard, say, is called so.
                    let name = match model.parts.as_slice() {
                        [only] if self.stage.is_single() => model.full_name(&only.name),
                        _ => stage_plant.name.clone(),
                    };
                    self.meshes.push(Mesh { name: format!("{name}{suffix}"), primitives, extras });
                }
            }
        }
    }

    /// The nodes of all places.
    fn plants(&mut self) -> Vec<usize> {
        let stage = self.stage;
        if stage.is_single() {
            if let (Some(bones), Some(bind)) = (self.bones[0], self.binds[0]) {
                let place = &stage.places[0];
                self.rig(place, bones, bind, &stage.plants[0].name);
                return vec![self.rigs[0].first];
            }
            if self.distinct.levels(0) == 1 {
                return self
                    .in_seasons(0, |graph, season| graph.parts(0, graph.distinct.model(0, season, 0)));
            }
            let (place, name) = (&stage.places[0], &stage.plants[0].name);
            return self
                .in_seasons(0, |graph, season| vec![graph.levels(place, name, season, Self::assembly)]);
        }
        let numbered = (1..).zip(&stage.places);
        numbered
            .flat_map(|(number, place)| {
                let name = format!("{}_{number}", stage.plants[place.plant].name);
                if let (Some(bones), Some(bind)) = (self.bones[place.plant], self.binds[place.plant]) {
                    let first = self.rig(place, bones, bind, &name);
                    let node = Node { name, children: vec![first], ..Node::default() };
                    return vec![self.push(placed(place, None, node))];
                }
                let plant = place.plant;
                self.in_seasons(plant, |graph, season| vec![graph.levels(place, &name, season, Self::shared)])
            })
            .collect()
    }

    /// The name of a plant's season, where it has several.
    fn season(&self, plant: usize, season: usize) -> Option<&str> {
        let seasons = &self.stage.plants[plant].seasons;
        (seasons.len() > 1).then(|| seasons[season].name.as_str())
    }

    /// The nodes of each season of a plant, which say so where there are several.
    fn in_seasons(
        &mut self,
        plant: usize,
        mut make: impl FnMut(&mut Self, usize) -> Vec<usize>,
    ) -> Vec<usize> {
        let mut all = Vec::new();
        for season in 0..self.distinct.seasons(plant) {
            let made = make(self, season);
            let name = self.season(plant, season).map(str::to_owned);
            for &node in &made {
                self.nodes[node].extras.linden_season.clone_from(&name);
            }
            all.extend(made);
        }
        all
    }

    /// The joints of a tree and, as roots of the scene, its meshes; gives the joint that all others hang on.
    fn rig(&mut self, place: &Place, bones: &Bones, bind: usize, name: &str) -> usize {
        let model = &self.distinct.models[self.distinct.model(place.plant, 0, 0)];
        let rig = Rig::add(place.plant, bones, |joint| model.full_name(joint), &mut self.nodes);
        let first = rig.first;
        self.skins.push(rig.skin(bones, name.to_owned(), bind));
        self.rigs.push(rig);
        let before = self.nodes.len();
        let skinned = self.in_seasons(place.plant, |graph, season| graph.skinned(place, name, season, first));
        self.skinned.extend(skinned);
        let skin = Some(self.skins.len() - 1);
        for index in before..self.nodes.len() {
            let Some(mesh) = self.nodes[index].mesh else { continue };
            let is_bound = |primitive: &Primitive| primitive.attributes.joints_0.is_some();
            // A billboard is not.
            if self.meshes[mesh].primitives.iter().all(is_bound) {
                let node = &mut self.nodes[index];
                (node.skin, node.translation, node.rotation, node.scale) = (skin, None, None, None);
            }
        }
        first
    }

    /// The meshes of a tree with joints in a season; `first` is the joint that all others hang on.
    fn skinned(&mut self, place: &Place, name: &str, season: usize, first: usize) -> Vec<usize> {
        if is_parted(self.stage, self.distinct) {
            return self.parts(0, self.distinct.model(0, season, 0));
        }
        // Of a level's node with one mesh none is below another.
        let finest = self.levels(place, name, season, Self::shared);
        if !self.are_siblings || self.distinct.levels(place.plant) == 1 {
            return vec![finest];
        }
        let group = self.nodes.pop().unwrap_or_default();
        self.nodes[first].extras.screen_coverage = group.extras.screen_coverage;
        group.children
    }

    /// A node for each plant, with all its places.
    fn instances(&mut self, instances: &[Instancing]) -> Vec<usize> {
        let stage = self.stage;
        let mut finest = Vec::new();
        for (plant, (stage_plant, instancing)) in stage.plants.iter().zip(instances).enumerate() {
            // A node without places would show the plant once.
            if stage.places.iter().all(|place| place.plant != plant) {
                continue;
            }
            let first = self.nodes.len();
            let place = Place::origin(plant);
            finest.extend(self.in_seasons(plant, |graph, season| {
                vec![graph.levels(&place, &stage_plant.name, season, Self::instanced)]
            }));
            for node in self.nodes[first..].iter_mut().filter(|node| node.mesh.is_some()) {
                node.extensions.instancing = Some(*instancing);
            }
        }
        finest
    }

    fn push(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// A node for each part of a model.
    fn parts(&mut self, plant: usize, model: usize) -> Vec<usize> {
        let cube = self.cube(plant);
        let first = self.first_mesh[model];
        let count = self.distinct.models[model].parts.len();
        (first..first + count)
            .map(|mesh| {
                let name = self.meshes[mesh].name.clone();
                let node = Node { name, mesh: Some(mesh), ..Node::default() };
                match self.copies.get(mesh).copied().flatten() {
                    Some(instancing) => {
                        let instancing = Some(instancing);
                        let extensions = NodeExtensions { instancing, ..NodeExtensions::default() };
                        self.push(Node { extensions, ..node })
                    }
                    None => self.push(placed(&Place::origin(plant), cube, node)),
                }
            })
            .collect()
    }

    /// A tree alone: its parts below a node.
    fn assembly(&mut self, place: &Place, model: usize, name: String) -> Node {
        let node = Node { name, children: self.parts(place.plant, model), ..Node::default() };
        placed(place, None, node)
    }

    /// A tree among others: the mesh that they share.
    fn shared(&mut self, place: &Place, model: usize, name: String) -> Node {
        let node = Node { name, mesh: Some(self.first_mesh[model]), ..Node::default() };
        placed(place, self.cube(place.plant), node)
    }

    /// A tree in many places: the instances of its parts put these where it stands.
    fn instanced(&mut self, place: &Place, model: usize, name: String) -> Node {
        let first = self.first_mesh[model];
        let of_plant = &self.distinct.models[model];
        let level = (0..self.distinct.levels(place.plant))
            .find(|&level| self.distinct.model(place.plant, 0, level) == model);
        let facts = TreeFacts::of_level(&self.stage.plants[place.plant], level.unwrap_or(0), of_plant);
        let extras =
            Extras { linden: recipe(&of_plant.scene.recipe), linden_tree: facts, ..Extras::default() };
        let part =
            |mesh: usize| Node { name: self.meshes[mesh].name.clone(), mesh: Some(mesh), ..Node::default() };
        let parts: Vec<Node> = (first..first + of_plant.parts.len()).map(part).collect();
        let children = parts.into_iter().map(|part| self.push(part)).collect();
        Node { name, children, extras, ..Node::default() }
    }

    /// What a plant's positions are told in, where they are in fewer bits.
    fn cube(&self, plant: usize) -> Option<Cube> {
        self.layout.quanta.as_ref().map(|quanta| quanta.cube(plant))
    }

    /// A place's plant in all levels of a season; gives the node of the finest, which names the others, or the one that has all
    /// below it.
    fn levels(
        &mut self,
        place: &Place,
        name: &str,
        season: usize,
        make: impl Fn(&mut Self, &Place, usize, String) -> Node,
    ) -> usize {
        let levels = self.distinct.levels(place.plant);
        let name = &self
            .season(place.plant, season)
            .map_or_else(|| name.to_owned(), |season| format!("{name}_{season}"));
        let of_levels: Vec<usize> = (0..levels)
            .map(|level| {
                let model = self.distinct.model(place.plant, season, level);
                let node = make(self, place, model, format!("{name}{}", suffix(level, levels)));
                self.push(node)
            })
            .collect();
        let coverage = self.stage.plants[place.plant].levels().iter().map(|level| level.coverage);
        if self.are_siblings && levels > 1 {
            let extras = Extras { screen_coverage: coverage.collect(), ..Extras::default() };
            return self.push(Node { name: name.clone(), children: of_levels, extras, ..Node::default() });
        }
        let (finest, others) = (of_levels[0], &of_levels[1..]);
        if !others.is_empty() {
            let node = &mut self.nodes[finest];
            node.extras.screen_coverage = coverage.collect();
            node.extensions =
                NodeExtensions { lod: Some(Lod { ids: others.to_vec() }), ..NodeExtensions::default() };
        }
        finest
    }
}

/// Whether each part is a mesh. A level of detail of what has joints is one, because its node can have nothing
/// below it.
pub(super) fn is_parted(stage: &Stage<'_>, distinct: &DistinctMeshes<'_>) -> bool {
    stage.is_single() && (!has_bones(stage) || distinct.levels(0) == 1)
}

/// What is said of a tree that stands alone: of the level that is in the file, or of all.
fn of_whole(stage: &Stage<'_>, distinct: &DistinctMeshes<'_>) -> Option<TreeFacts> {
    let (plant, model) = (&stage.plants[0], &distinct.models[distinct.model(0, 0, 0)]);
    if distinct.levels(0) > 1 {
        TreeFacts::of_tree(plant, model)
    } else {
        TreeFacts::of_level(plant, 0, model)
    }
}

/// What the name of a level ends in.
fn suffix(level: usize, levels: usize) -> String {
    if levels > 1 { format!("_LOD{level}") } else { String::new() }
}

fn primitive(piece: &MeshPart<'_>, arrays: &PrimitiveArrays) -> Primitive {
    let targets = arrays.wind.targets.iter().map(|&position| MorphTarget { position });
    Primitive {
        attributes: arrays.attributes(),
        indices: arrays.indices,
        material: Some(piece.material),
        targets: targets.collect(),
    }
}

/// How a mesh is moved and scaled to a place.
struct Move {
    translation: Vec3,
    scale: f32,
}

impl Move {
    /// The place's own, after that of the cube which positions are told in.
    fn new(place: &Place, cube: Option<Cube>) -> Self {
        let corner = |point: Vec3| place.motion().map_or(point, |motion| motion.point(point));
        match cube {
            Some(Cube { corner: at, side }) => Self { translation: corner(at), scale: place.scale * side },
            None => Self { translation: place.position, scale: place.scale },
        }
    }
}

/// A node where its plant stands.
pub(super) fn placed(place: &Place, cube: Option<Cube>, node: Node) -> Node {
    if place.is_origin() && cube.is_none() {
        return node;
    }
    let Move { translation, scale } = Move::new(place, cube);
    Node {
        translation: Some(translation.to_array()),
        rotation: (place.turn_rad != 0.0).then(|| place.rotation().to_array()),
        scale: (scale != 1.0).then_some([scale; 3]),
        ..node
    }
}
