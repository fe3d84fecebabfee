//! Shapes for physics: as nodes with `OMI_physics_body`, or as meshes by the names that engines look for.
//!
//! | `collision_as` | is |
//! |---|---|
//! | `omi` | `OMI_physics_shape` and `OMI_physics_body`, static: nothing that is drawn |
//! | `unreal` | convex meshes called `UCX_MESH_00`, which Unreal takes out of what is drawn |
//! | `godot` | convex meshes called `NAME-convcolonly`, which Godot does the same with |

use linden_pipeline::stage::{Place, Stage};

use super::buffer::Layout;
use super::document::{
    Attributes, BodyMotion, CapsuleShape, Collider, ConvexShape, Extras, Mesh, Node, NodeExtensions,
    PhysicsBody, Primitive, Shape,
};
use super::nodes::{SceneGraph, are_instances, placed};
use crate::collision::{self, Capsule, Colliders, Solid};
use crate::writing::distinct::DistinctMeshes;
use crate::{Bundle, OptionSpec, Options};

/// What the shapes are.
pub(super) const AS: OptionSpec = OptionSpec::choice(
    "collision_as",
    &["omi", "unreal", "godot"],
    "how shapes for physics are told: by OMI_physics_body; as meshes called UCX_…, or NAME-convcolonly",
)
.once_a_plant();

/// Whose shapes are told by extensions.
pub(super) const EXTENSIONS: [&str; 2] = ["OMI_physics_body", "OMI_physics_shape"];

/// Says what becomes of shapes that were asked for.
pub(super) fn note(stage: &Stage<'_>, options: &Options, bundle: &mut Bundle) {
    if collision::is_wanted(options) && are_instances(stage, options) {
        bundle.note("collision is left out: trees that are instances have no nodes that could bear shapes");
    }
}

/// Adds the shapes of all plants, and a node with them wherever a plant stands. Gives what the document lists.
pub(super) fn add(
    stage: &Stage<'_>,
    distinct: &DistinctMeshes<'_>,
    options: &Options,
    layout: &mut Layout,
    graph: &mut SceneGraph,
) -> Vec<Shape> {
    if !collision::is_wanted(options) || are_instances(stage, options) {
        return Vec::new();
    }
    let mut shapes = Shapes { way: Way::of(options), list: Vec::new(), told: collision::told(options) };
    let of_plants: Vec<Vec<Node>> = (0..distinct.plants())
        .map(|plant| {
            let model = &distinct.models[distinct.model(plant, 0, 0)];
            let colliders = Colliders::of(model.scene, options);
            // Unreal looks for the name of the mesh that is drawn.
            let wood = model.parts.first().map_or("wood", |part| &*part.name);
            let mesh =
                if stage.is_single() { model.full_name(wood) } else { stage.plants[plant].name.clone() };
            shapes.nodes(&colliders, &model.full_name("collision"), &mesh, layout, &mut graph.meshes)
        })
        .collect();
    for (number, place) in (1..).zip(&stage.places) {
        let nodes = &of_plants[place.plant];
        if nodes.is_empty() {
            continue;
        }
        let first = graph.nodes.len();
        graph.nodes.extend(nodes.iter().cloned());
        let model = &distinct.models[distinct.model(place.plant, 0, 0)];
        let name = model.full_name("collision");
        let name = if stage.is_single() { name } else { format!("{name}_{number}") };
        let children = (first..graph.nodes.len()).collect();
        let group = graph.nodes.len();
        graph.nodes.push(shapes.group(place, name, children));
        graph.nodes[0].children.push(group);
    }
    if !shapes.list.is_empty() {
        graph.extensions.extend(EXTENSIONS);
    }
    shapes.list
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Omi,
    Unreal,
    Godot,
}

impl Way {
    fn of(options: &Options) -> Self {
        let is = |word| options.is_word(AS.knob.name, word);
        if is("unreal") {
            Self::Unreal
        } else if is("godot") {
            Self::Godot
        } else {
            Self::Omi
        }
    }
}

struct Shapes {
    way: Way,
    list: Vec<Shape>,
    /// The options in a few words.
    told: Option<String>,
}

impl Shapes {
    /// A node for each shape of a plant that is called `name`, and whose mesh is called `mesh`.
    fn nodes(
        &mut self,
        colliders: &Colliders,
        name: &str,
        mesh: &str,
        layout: &mut Layout,
        meshes: &mut Vec<Mesh>,
    ) -> Vec<Node> {
        let Colliders { capsules, crown } = colliders;
        let named = |number: usize| match self.way {
            Way::Omi => format!("{name}_{number:02}"),
            Way::Unreal => format!("UCX_{mesh}_{number:02}"),
            Way::Godot => format!("{name}_{number:02}-convcolonly"),
        };
        let names: Vec<String> = (0..=capsules.len()).map(named).collect();
        let mut nodes = Vec::new();
        for (capsule, name) in capsules.iter().zip(&names) {
            nodes.push(match self.way {
                Way::Omi => self.capsule(capsule, name),
                Way::Unreal | Way::Godot => drawn(&Solid::of(capsule), name, layout, meshes),
            });
        }
        if let (Some(crown), Some(name)) = (crown, names.last()) {
            let node = drawn(crown, name, layout, meshes);
            nodes.push(match self.way {
                Way::Unreal | Way::Godot => node,
                Way::Omi => {
                    let convex = node.mesh.map(|mesh| ConvexShape { mesh });
                    self.list.push(Shape { kind: "convex", capsule: None, convex });
                    Node { mesh: None, extensions: self.collider(), ..node }
                }
            });
        }
        nodes
    }

    fn capsule(&mut self, capsule: &Capsule, name: &str) -> Node {
        let radius = capsule.radius_m;
        let shape = CapsuleShape { height: capsule.length_m(), radius_bottom: radius, radius_top: radius };
        self.list.push(Shape { kind: "capsule", capsule: Some(shape), convex: None });
        Node {
            name: name.to_owned(),
            translation: Some(capsule.middle().to_array()),
            rotation: Some(capsule.rotation().to_array()),
            extensions: self.collider(),
            ..Node::default()
        }
    }

    /// That a node has the shape that was listed last.
    fn collider(&self) -> NodeExtensions {
        let collider = Some(Collider { shape: self.list.len() - 1 });
        NodeExtensions { body: Some(PhysicsBody { motion: None, collider }), ..NodeExtensions::default() }
    }

    /// What bears the shapes of a plant where it stands.
    fn group(&self, place: &Place, name: String, children: Vec<usize>) -> Node {
        let motion = Some(BodyMotion { kind: "static" }).filter(|_| self.way == Way::Omi);
        let body = motion.map(|motion| PhysicsBody { motion: Some(motion), collider: None });
        let extensions = NodeExtensions { body, ..NodeExtensions::default() };
        let extras = Extras { linden_collision: self.told.clone(), ..Extras::default() };
        placed(place, None, Node { name, children, extensions, extras, ..Node::default() })
    }
}

/// A shape as a mesh, which has a node of its name.
fn drawn(solid: &Solid, name: &str, layout: &mut Layout, meshes: &mut Vec<Mesh>) -> Node {
    let (position, indices) = layout.push_solid(solid);
    let attributes = Attributes { position, ..Attributes::default() };
    let primitive = Primitive { attributes, indices, material: None, targets: Vec::new() };
    meshes.push(Mesh { name: name.to_owned(), primitives: vec![primitive], extras: Extras::default() });
    Node { name: name.to_owned(), mesh: Some(meshes.len() - 1), ..Node::default() }
}
