//! PLY (the Stanford polygon format), as a mesh and as a skeleton.
//!
//! Binary little-endian by default. The recipe stands in the comments that start with `recipe: `; a
//! long one is cut into several, because some readers take only short lines: their texts, joined
//! without anything between, are the recipe.
//!
//! A skeleton's vertices have, beside place and radius, `birth`, `order` (of the axis: 0 on stems), `parent` (a vertex of
//! the file, -1 at a foot), `axis` (counted from 0 in each tree), `position_in_axis` (segments of the axis up to there),
//! `strahler` (the order of Strahler of the segment that ends there), `branches` (1 where that segment begins a lateral
//! axis, 0 where it succeeds another) and `tree` (counted from 1).

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::Material;
use linden_pipeline::skeleton::{NO_PARENT, Skeleton};
use linden_pipeline::stage::{Motion, Place, Stage};

use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::recent::{RecentFloats, RecentIntegers};
use crate::writing::records::{self, Text};
use crate::writing::{fit, mean_digits, memory, pictures, trees, validate};
use crate::{
    Amounts, Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, Readable, Sink, Traces,
    recipe, traces,
};

/// A mesh with normals, texture coordinates and vertex colours.
pub(crate) struct Ply;

/// Nodes with radii, and edges between them.
pub(crate) struct PlySkeleton;

const OPTIONS: &[OptionSpec] = &[OptionSpec::choice(
    "encoding",
    &["binary", "ascii"],
    "binary is little-endian, small and fast; ascii can be read by eye",
)];

static MESH: Format = Format {
    id: "ply",
    name: "PLY mesh",
    extensions: &["ply"],
    media_type: "application/ply",
    self_contained: true,
    help: "mesh with normals, texture coordinates and vertex colours in one small file",
    options: OPTIONS,
    // Colours at the vertices.
    holds: Holds { pictures: false, normals: false, ..Holds::MESH },
    levels_by: None,
    encoding,
    estimate: Some(|amounts, options| {
        let Amounts { vertices, triangles, recipe_bytes, .. } = *amounts;
        let elements = match encoding(options) {
            // Measured over the built-in presets, but for the digits of indices.
            Encoding::Text => {
                (94.0 * vertices as f64 + triangles as f64 * (3.0 * mean_digits(vertices) + 5.0)) as u64
            }
            _ => vertices * 36 + triangles * 13,
        };
        elements + recipe_bytes + 500
    }),
};

static SKELETON: Format = Format {
    id: "ply-skeleton",
    name: "PLY skeleton",
    // `.ply` alone means the mesh.
    extensions: &[],
    media_type: "application/ply",
    self_contained: true,
    help: "the axial tree: nodes with radius, birth, parent, axis and orders, and edges between them",
    options: OPTIONS,
    holds: Holds::SKELETON,
    levels_by: None,
    encoding,
    estimate: Some(|amounts, options| {
        // As text measured over the built-in presets; indices of edges are a small part of it.
        let node = match encoding(options) {
            Encoding::Text => 62.0 + mean_digits(amounts.nodes) + mean_digits(amounts.axes),
            _ => 56.0,
        };
        (node * amounts.nodes as f64) as u64 + amounts.recipe_bytes + 600
    }),
};

fn encoding(options: &Options) -> Encoding {
    if options.is_word("encoding", "ascii") { Encoding::Text } else { Encoding::Binary }
}

/// Some readers take lines of 255 bytes at most.
const LINE: usize = 200;

impl Exporter for Ply {
    fn format(&self) -> &'static Format {
        &MESH
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        in_header(file)
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        encoded(&MESH, file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &MESH, bundle);
        let distinct = DistinctMeshes::of(stage, monitor)?;
        memory::admit(stage, &[], memory::formatting(&distinct), monitor)?;
        let ascii = encoding(options) == Encoding::Text;
        let meshes = || distinct.placed(stage).flat_map(|(_, model)| &model.parts).map(|piece| &*piece.mesh);
        let vertices: usize = meshes().map(|mesh| mesh.positions.len()).sum();
        let faces: usize = meshes().map(|mesh| mesh.triangles.len()).sum();
        if vertices > i32::MAX as usize || faces > i32::MAX as usize {
            return Err(too_large(MESH.id, format!("{vertices} vertices and {faces} triangles")));
        }
        let mut head = header(&stage.name, &stage.recipe, ascii) + &recipe::foot_comment(stage, "comment");
        // Readers see one mesh: which vertices belong together is told here.
        let mut first = 0;
        for piece in distinct.placed(stage).take(1).flat_map(|(_, model)| &model.parts) {
            let count = piece.mesh.positions.len();
            head += &format!("comment part {}: {count} vertices from {first}\n", piece.name);
            first += count;
        }
        head += &format!("element vertex {vertices}\n");
        for name in ["x", "y", "z", "nx", "ny", "nz", "s", "t"] {
            head += &format!("property float {name}\n");
        }
        for name in ["red", "green", "blue", "alpha"] {
            head += &format!("property uchar {name}\n");
        }
        head += &format!("element face {faces}\nproperty list uchar int vertex_indices\nend_header\n");
        let bytes = head.len() + vertices * 36 + faces * 13;
        bundle.write_main((!ascii).then_some(bytes as u64), monitor, |out| {
            out.write(head.as_bytes())?;
            for (place, model) in distinct.placed(stage) {
                for piece in &model.parts {
                    write_vertices(
                        out,
                        piece,
                        place.motion(),
                        distinct.materials[piece.material].material,
                        ascii,
                    )?;
                }
            }
            let mut before = 0;
            for piece in distinct.placed(stage).flat_map(|(_, model)| &model.parts) {
                write_faces(out, piece, before, ascii)?;
                before += piece.mesh.positions.len() as u32;
            }
            Ok(())
        })
    }
}

fn write_vertices(
    out: &mut Sink<'_>,
    piece: &MeshPart<'_>,
    motion: Option<Motion>,
    material: &Material,
    ascii: bool,
) -> Result<(), ExportError> {
    let mesh = &*piece.mesh;
    let plain = material.base_color.map(pictures::srgb);
    let picture = material.base_color_picture.as_deref();
    records::write(out, mesh.positions.len(), |text, range| {
        let (mut coordinates, mut colors) = (RecentFloats::default(), RecentIntegers::default());
        for i in range {
            let (mut position, mut normal) = (mesh.positions[i], mesh.normals[i]);
            if let Some(motion) = &motion {
                (position, normal) = (motion.point(position), motion.direction(normal));
            }
            let ([x, y, z], [nx, ny, nz], [s, t]) =
                (position.to_array(), normal.to_array(), mesh.uvs[i].to_array());
            let [r, g, b] =
                picture.map_or(plain, |picture| pictures::color_at(picture, material.wrap, mesh.uvs[i]));
            if ascii {
                text.tuple((b"", b" ", b" "), [x, y, z, nx, ny, nz]);
                text.recent_tuple(&mut coordinates, (b"", b" ", b" "), [s, t]);
                text.recent_integers(&mut colors, (b"", b" ", b"\n"), [r, g, b, 255].map(u32::from));
            } else {
                text.bytes(&bytemuck::cast::<_, [u8; 32]>([x, y, z, nx, ny, nz, s, t]));
                text.bytes(&[r, g, b, 255]);
            }
        }
    })
}

fn write_faces(
    out: &mut Sink<'_>,
    piece: &MeshPart<'_>,
    before: u32,
    ascii: bool,
) -> Result<(), ExportError> {
    let triangles = &piece.mesh.triangles;
    records::write(out, triangles.len(), |text, range| {
        let mut recent = RecentIntegers::default();
        for triangle in &triangles[range] {
            let triangle = triangle.map(|vertex| before + vertex);
            if ascii {
                text.recent_integers(&mut recent, (b"3 ", b" ", b"\n"), triangle);
            } else {
                let mut face = [3; 13];
                face[1..].copy_from_slice(&bytemuck::cast::<_, [u8; 12]>(triangle));
                text.bytes(&face);
            }
        }
    })
}

impl Exporter for PlySkeleton {
    fn format(&self) -> &'static Format {
        &SKELETON
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        in_header(file)
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        encoded(&SKELETON, file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &SKELETON, bundle);
        if stage.turned.iter().any(|name| name == "width_steps") {
            bundle.note(
                "ply-skeleton holds a radius for each node: width_steps, how wood goes from one to the next, changes nothing in it; qsm holds the cylinders",
            );
        }
        let plants = validate::trees(stage, monitor)?;
        let ascii = encoding(options) == Encoding::Text;
        let sum = |count: fn(&Skeleton) -> usize| -> usize {
            plants.iter().map(|(_, scene)| count(&scene.skeleton)).sum()
        };
        let (nodes, edges) = (sum(|skeleton| skeleton.positions.len()), sum(Skeleton::segments));
        if nodes > i32::MAX as usize {
            return Err(too_large(SKELETON.id, format!("{nodes} nodes")));
        }
        let most = plants.iter().map(|(_, scene)| scene.skeleton.positions.len()).max().unwrap_or(0);
        // The topology of a tree while its records are formatted; Strahler's orders are counted with another list.
        let more = bytes_of::<[u32; 4]>(most) + records::bytes(most);
        memory::admit(stage, &[], trees::bytes(&plants) + more, monitor)?;
        let (name, recipe) = recipe::of_stage(stage);
        let mut head = header(name, recipe, ascii) + &recipe::foot_comment(stage, "comment");
        head += &format!("element vertex {nodes}\n");
        for name in ["x", "y", "z", "radius"] {
            head += &format!("property float {name}\n");
        }
        for name in LABELS {
            head += &format!("property int {name}\n");
        }
        head += &format!("element edge {edges}\nproperty int vertex1\nproperty int vertex2\nend_header\n");
        let bytes = head.len() + nodes * 48 + edges * 8;
        bundle.write_main((!ascii).then_some(bytes as u64), monitor, |out| {
            out.write(head.as_bytes())?;
            let mut before = 0;
            for tree in trees::numbered(&plants) {
                let topology = Topology::of(&tree.skeleton, before, tree.number);
                records::write(out, tree.skeleton.positions.len(), |text, range| {
                    for node in range {
                        write_node(text, &topology, tree.place, node, ascii);
                    }
                })?;
                before += tree.skeleton.positions.len() as u32;
            }
            before = 0;
            for tree in trees::numbered(&plants) {
                let parents = &tree.skeleton.parents;
                records::write(out, parents.len(), |text, range| {
                    for node in range.filter(|&node| parents[node] != NO_PARENT) {
                        let ends = [before + parents[node], before + node as u32];
                        if ascii {
                            text.integer(ends[0]);
                            text.byte(b' ');
                            text.integer(ends[1]);
                            text.byte(b'\n');
                        } else {
                            text.bytes(&bytemuck::cast::<_, [u8; 8]>(ends));
                        }
                    }
                })?;
                before += parents.len() as u32;
            }
            Ok(())
        })
    }
}

/// What is said of a node by whole numbers.
const LABELS: [&str; 8] =
    ["birth", "order", "parent", "axis", "position_in_axis", "strahler", "branches", "tree"];

/// How the nodes of a tree are joined.
struct Topology<'a> {
    skeleton: &'a Skeleton,
    axes: Vec<u32>,
    places: Vec<u32>,
    strahler: Vec<u32>,
    /// Vertices of the file that come first.
    before: u32,
    tree: u32,
}

impl<'a> Topology<'a> {
    fn of(skeleton: &'a Skeleton, before: u32, tree: u32) -> Self {
        let mut places = vec![0; skeleton.positions.len()];
        for axis in &skeleton.axes {
            // A lateral's first segment begins at a node of another axis.
            let first = u32::from(axis.parent != NO_PARENT);
            for (place, &node) in (first..).zip(skeleton.nodes_of(axis)) {
                places[node as usize] = place;
            }
        }
        let (axes, strahler) = (skeleton.axis_of_nodes(), skeleton.strahler());
        Self { skeleton, axes, places, strahler, before, tree }
    }

    /// As [`LABELS`] names them; a parent of -1 is none.
    fn labels(&self, node: usize) -> [i32; 8] {
        let Skeleton { parents, births, axes, .. } = self.skeleton;
        let (axis, parent) = (self.axes[node], parents[node]);
        let order = axes.get(axis as usize).map_or(0, |axis| axis.order);
        let is_foot = parent == NO_PARENT;
        let branches = !is_foot && self.axes[parent as usize] != axis;
        // PLY's `int` is signed; no tree lives for two thousand million steps.
        let [birth, order, axis, place, strahler, tree] =
            [births[node], order, axis, self.places[node], self.strahler[node], self.tree]
                .map(|n| i32::try_from(n).unwrap_or(i32::MAX));
        let parent = if is_foot { -1 } else { (self.before + parent) as i32 };
        [birth, order, parent, axis, place, strahler, branches.into(), tree]
    }
}

fn write_node(text: &mut Text, topology: &Topology<'_>, place: &Place, node: usize, ascii: bool) {
    let skeleton = topology.skeleton;
    let position = skeleton.positions[node];
    let [x, y, z] = place.motion().map_or(position, |motion| motion.point(position)).to_array();
    let numbers = [x, y, z, skeleton.radii[node] * place.scale];
    let labels = topology.labels(node);
    if !ascii {
        text.bytes(&bytemuck::cast::<_, [u8; 16]>(numbers));
        text.bytes(&bytemuck::cast::<_, [u8; 32]>(labels));
        return;
    }
    text.floats(numbers, b" ");
    for label in labels {
        text.byte(b' ');
        if label < 0 {
            text.byte(b'-');
        }
        text.integer(label.unsigned_abs());
    }
    text.byte(b'\n');
}

fn header(name: &str, recipe: &str, ascii: bool) -> String {
    let encoding = if ascii { "ascii" } else { "binary_little_endian" };
    let mut head = format!("ply\nformat {encoding} 1.0\ncomment {GENERATOR}\n");
    let mut name = linden_pipeline::knob::printable(name);
    while name.len() > LINE {
        name.pop();
    }
    head += &format!("comment name: {name}\n");
    // ASCII, as has been checked: any byte is the end of a character.
    let mut rest = recipe;
    while let Some((line, after)) =
        rest.split_at_checked(LINE.min(rest.len())).filter(|(line, _)| !line.is_empty())
    {
        head += &format!("comment recipe: {line}\n");
        rest = after;
    }
    head += "comment units: metres, up axis: Y, triangles counter-clockwise from outside\n";
    head
}

fn encoded(format: &'static Format, file: &mut dyn Readable) -> io::Result<Traces> {
    let [is_ascii, _end] = traces::beginnings(file, ["format ascii", "end_header"])?;
    Ok(Traces::none(format).with("encoding", if is_ascii { "ascii" } else { "binary" }))
}

/// The recipe in a header: its comments, put together.
fn in_header(file: &mut dyn Readable) -> io::Result<Option<String>> {
    if !recipe::begins(file, b"ply\n")? {
        return Ok(None);
    }
    let mut found = Vec::new();
    for line in recipe::lines(file) {
        let line = line?;
        match line.strip_prefix(b"comment recipe: ") {
            Some(piece) => found.extend(piece),
            // A recipe stands in one place.
            None if !found.is_empty() || line.starts_with(b"element ") => break,
            None => {}
        }
    }
    Ok(recipe::text(&found))
}

fn too_large(format: &'static str, amount: String) -> ExportError {
    ExportError::TooLarge { format, amount, limit: "2 147 483 647 of each", advice: "lower the resolution" }
}
