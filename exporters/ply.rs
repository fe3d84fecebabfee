//! PLY (the Stanford polygon format), as a mesh and as a skeleton.
//!
//! Binary little-endian by default. The recipe stands in the comments that start with `recipe: `; a
//! long one is cut into several, because some readers take only short lines: their texts, joined
//! without anything between, are the recipe.

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::memory::{bytes_grown, bytes_of};
use linden_pipeline::scene::Material;
use linden_pipeline::skeleton::NO_PARENT;
use linden_pipeline::stage::{Motion, Stage};

use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::records::{self, Text};
use crate::writing::{fit, mean_digits, memory, pictures, validate};
use crate::{
    Amounts, Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, Readable, Sink, recipe,
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
    help: "the axial tree: nodes with radius, birth and order, and edges between them",
    options: OPTIONS,
    holds: Holds::SKELETON,
    encoding,
    estimate: Some(|amounts, options| {
        // As text measured over the built-in presets; indices of edges are a small part of it.
        let node = if encoding(options) == Encoding::Text { 50 } else { 32 };
        node * amounts.nodes + amounts.recipe_bytes + 400
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
        let mut head = header(&stage.name, &stage.recipe, ascii);
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
        for i in range {
            let (mut position, mut normal) = (mesh.positions[i], mesh.normals[i]);
            if let Some(motion) = &motion {
                (position, normal) = (motion.point(position), motion.direction(normal));
            }
            let ([x, y, z], [nx, ny, nz], [s, t]) =
                (position.to_array(), normal.to_array(), mesh.uvs[i].to_array());
            let numbers = [x, y, z, nx, ny, nz, s, t];
            let [r, g, b] =
                picture.map_or(plain, |picture| pictures::color_at(picture, material.wrap, mesh.uvs[i]));
            if ascii {
                text.floats(numbers, b" ");
                integers(text, &[r, g, b, 255].map(u32::from));
            } else {
                text.bytes(&bytemuck::cast::<_, [u8; 32]>(numbers));
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
        for triangle in &triangles[range] {
            let triangle = triangle.map(|vertex| before + vertex);
            if ascii {
                text.byte(b'3');
                integers(text, &triangle);
            } else {
                let mut face = [3; 13];
                face[1..].copy_from_slice(&bytemuck::cast::<_, [u8; 12]>(triangle));
                text.bytes(&face);
            }
        }
    })
}

/// Each after a space, and the end of the line.
fn integers(text: &mut Text, numbers: &[u32]) {
    for &n in numbers {
        text.byte(b' ');
        text.integer(n);
    }
    text.byte(b'\n');
}

impl Exporter for PlySkeleton {
    fn format(&self) -> &'static Format {
        &SKELETON
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        in_header(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &SKELETON, bundle);
        let scene = validate::single_tree(stage, SKELETON.id, monitor)?;
        let ascii = encoding(options) == Encoding::Text;
        let skeleton = &scene.skeleton;
        let nodes = skeleton.positions.len();
        if nodes > i32::MAX as usize {
            return Err(too_large(SKELETON.id, format!("{nodes} nodes")));
        }
        // Orders and edges stay while records are formatted; the edges grew one by one.
        let more = bytes_of::<u32>(nodes) + bytes_grown::<[u32; 2]>(nodes) + records::bytes(nodes);
        memory::admit(stage, &[], more, monitor)?;
        let orders = skeleton.orders();
        let edges: Vec<[u32; 2]> = (0..)
            .zip(&skeleton.parents)
            .filter(|&(_, &parent)| parent != NO_PARENT)
            .map(|(node, &parent)| [parent, node])
            .collect();
        let mut head = header(&scene.name, &scene.recipe, ascii);
        head += &format!("element vertex {nodes}\n");
        for name in ["x", "y", "z", "radius"] {
            head += &format!("property float {name}\n");
        }
        head += "property int birth\nproperty int order\n";
        head += &format!(
            "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
            edges.len()
        );
        let bytes = head.len() + nodes * 24 + edges.len() * 8;
        bundle.write_main((!ascii).then_some(bytes as u64), monitor, |out| {
            out.write(head.as_bytes())?;
            records::write(out, nodes, |text, range| {
                for i in range {
                    let [x, y, z] = skeleton.positions[i].to_array();
                    let numbers = [x, y, z, skeleton.radii[i]];
                    // PLY's `int` is signed; no tree lives for two thousand million steps.
                    let labels = [skeleton.births[i], orders[i]].map(|n| n.min(i32::MAX as u32));
                    if ascii {
                        text.floats(numbers, b" ");
                        integers(text, &labels);
                    } else {
                        text.bytes(&bytemuck::cast::<_, [u8; 16]>(numbers));
                        text.bytes(&bytemuck::cast::<_, [u8; 8]>(labels));
                    }
                }
            })?;
            if ascii {
                records::write(out, edges.len(), |text, range| {
                    for [parent, node] in &edges[range] {
                        text.integer(*parent);
                        integers(text, &[*node]);
                    }
                })
            } else {
                out.write(bytemuck::cast_slice(&edges))
            }
        })
    }
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
