//! Wavefront OBJ with its material library (MTL).
//!
//! What every reader agrees on: one index for position, texture coordinate and normal, exactly three
//! numbers after `v`, `o` and `g` per part, names without spaces. The recipe is the one line that
//! starts with `# recipe: `.

use std::io;
use std::sync::Arc;

use glam::Vec3;
use linden_pipeline::Monitor;
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::Material;
use linden_pipeline::skeleton::{NO_PARENT, Skeleton};
use linden_pipeline::stage::{Motion, Place, Stage};

use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, MeshPart, NamedMaterial};
use crate::writing::pictures::{self, NamedPicture};
use crate::writing::recent::{Recent, RecentFloats};
use crate::writing::records::{self, Digits, Text};
use crate::writing::{fit, mean_digits, memory, one_word};
use crate::{
    Amounts, Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, Readable, Sink, Traces,
    recipe, traces,
};

/// Wavefront OBJ.
pub(crate) struct Obj;

static FORMAT: Format = Format {
    id: "obj",
    name: "Wavefront OBJ",
    extensions: &["obj"],
    media_type: "model/obj",
    self_contained: false,
    help: "text that every program reads; materials (.mtl) and pictures lie beside it",
    options: &[
        OptionSpec::switch("pictures", true, "bark pictures beside the file; without, one colour"),
        OptionSpec::switch("lines", false, "the skeleton too, as lines: one per axis"),
    ],
    holds: Holds::MESH,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(estimate),
};

/// Vertices and nodes of the built-in presets, measured; an index takes as many bytes as it has digits.
fn estimate(amounts: &Amounts, options: &Options) -> u64 {
    let Amounts { vertices, triangles, nodes, recipe_bytes, .. } = *amounts;
    // `f a/a/a b/b/b c/c/c`.
    let faces = triangles as f64 * (9.0 * mean_digits(vertices) + 11.0);
    let lines = if options.is_on("lines") { 35.0 * nodes as f64 } else { 0.0 };
    let pictures = if options.is_on("pictures") { amounts.picture_bytes } else { 0 };
    (87.0 * vertices as f64 + faces + lines) as u64 + recipe_bytes + 500 + pictures
}

impl Exporter for Obj {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_comments(file)
    }

    /// Pictures show in the library alone.
    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        let lines = traces::last_line(file)?.starts_with(b"l ");
        Ok(Traces::none(&FORMAT).with_switch("lines", lines).with_either("pictures"))
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let distinct = DistinctMeshes::of(stage, monitor)?;
        let lines = options.is_on("lines");
        let of_model = |plant: &crate::writing::distinct::PlantModel<'_>| {
            let surface: usize = plant.parts.iter().map(|piece| piece.mesh.positions.len()).sum();
            surface + if lines { plant.scene.skeleton.positions.len() } else { 0 }
        };
        let vertices: usize = distinct.placed(stage).map(|(_, model)| of_model(model)).sum();
        if vertices > i32::MAX as usize {
            return Err(ExportError::TooLarge {
                format: FORMAT.id,
                amount: format!("{vertices} vertices"),
                limit: "2 147 483 647",
                advice: "lower the resolution",
            });
        }
        let library = bundle.takes_side_files().then(|| bundle.side_name(".mtl"));
        let with_pictures = library.is_some() && options.is_on("pictures");
        let pictures = if with_pictures { pictures::of_materials(&distinct.materials) } else { Vec::new() };
        memory::admit(stage, &pictures, memory::formatting(&distinct), monitor)?;
        if library.is_some() {
            let mut files = Vec::with_capacity(pictures.len());
            for (named, png) in pictures.iter().zip(pictures::compress(&pictures)?) {
                files.push(bundle.write_picture(&named.suffix, &png, monitor)?);
            }
            // By what they are called, and the file of each.
            let mut cuts: Vec<(String, String)> = Vec::new();
            for NamedMaterial { material, .. } in &distinct.materials {
                let stem = cut_out(material, &pictures);
                let Some(stem) = stem.filter(|stem| cuts.iter().all(|(known, _)| known != stem)) else {
                    continue;
                };
                let Some(picture) = &material.base_color_picture else { continue };
                let opacity = Arc::new(opacity(picture));
                let opacities = [NamedPicture::png(&stem, &opacity, material.wrap)];
                for (named, png) in opacities.iter().zip(pictures::compress(&opacities)?) {
                    let file = bundle.write_picture(&named.suffix, &png, monitor)?;
                    cuts.push((stem.clone(), file));
                }
            }
            let mtl = material_library(&distinct.materials, &pictures, &files, &cuts);
            bundle.write_side(".mtl", Some(mtl.len() as u64), monitor, |out| out.write(mtl.as_bytes()))?;
        } else {
            bundle.note("OBJ keeps materials and pictures in files beside it: left out of a single stream");
        }
        bundle.write_main(None, monitor, |out| {
            let mut head = header(stage);
            if let Some(library) = &library {
                head += &format!("mtllib {library}\n");
            }
            out.write(head.as_bytes())?;
            let mut before = 0;
            for (number, (place, model)) in (1..).zip(distinct.placed(stage)) {
                let name = tree_name(stage, place, number);
                let motion = place.motion();
                for piece in &model.parts {
                    let look = library.is_some().then(|| &distinct.materials[piece.material]);
                    write_piece(out, &name, piece, motion, look, before)?;
                    before += piece.mesh.positions.len() as u32;
                }
            }
            // Skeletons come last: their vertices have neither normal nor texture coordinate, and would
            // set the numbers of the three apart.
            for (number, (place, model)) in (1..).zip(distinct.placed(stage)).filter(|_| lines) {
                let skeleton = &model.scene.skeleton;
                write_lines(out, &tree_name(stage, place, number), skeleton, place.motion(), before)?;
                before += skeleton.positions.len() as u32;
            }
            Ok(())
        })
    }
}

fn header(stage: &Stage<'_>) -> String {
    let units = "metres, up axis: Y, triangles counter-clockwise from outside";
    recipe::comments(&stage.name, &stage.recipe, units) + &recipe::foot_comment(stage, "#")
}

/// What the `number`-th tree is called.
fn tree_name(stage: &Stage<'_>, place: &Place, number: usize) -> String {
    let plant = one_word(&stage.plants[place.plant].name);
    if stage.is_single() { plant } else { format!("{plant}_{number}") }
}

/// A part of the tree that is called `tree`; `look` is left out where there is no material library.
fn write_piece(
    out: &mut Sink<'_>,
    tree: &str,
    piece: &MeshPart<'_>,
    motion: Option<Motion>,
    look: Option<&NamedMaterial<'_>>,
    before: u32,
) -> Result<(), ExportError> {
    let name = one_word(&piece.name);
    // No group behind it: Babylon.js takes an object without faces for a cloud of points, and its material with it.
    out.write(format!("o {tree}_{name}\n").as_bytes())?;
    let mesh = &*piece.mesh;
    let count = mesh.positions.len();
    records::write(out, count, |text, range| {
        points(text, &mesh.positions[range], motion.as_ref());
    })?;
    records::write(out, count, |text, range| {
        let mut recent = RecentFloats::default();
        for uv in &mesh.uvs[range] {
            text.recent_tuple(&mut recent, (b"vt ", b" ", b"\n"), uv.to_array());
        }
    })?;
    records::write(out, count, |text, range| match &motion {
        None => vectors::<3, _>(text, b"vn ", &bytemuck::cast_slice(&mesh.normals)[range]),
        Some(motion) => {
            for &normal in &mesh.normals[range] {
                vectors(text, b"vn ", &[motion.direction(normal).to_array()]);
            }
        }
    })?;
    if let Some(look) = look {
        out.write(format!("usemtl {}\n", one_word(&look.name)).as_bytes())?;
    }
    out.write(b"s 1\n")?;
    records::write(out, mesh.triangles.len(), |text, range| {
        let mut corners = Recent::<_, 256>::new(corner);
        for triangle in &mesh.triangles[range] {
            text.fill::<{ 3 * CORNER_ROOM + 2 }>(|room| {
                room[0] = b'f';
                let mut len = 1;
                for &vertex in triangle {
                    len += corners.put(before + vertex + 1, records::piece(room, len));
                }
                room[len] = b'\n';
                len + 1
            });
        }
    })
}

/// Three numbers of ten digits with what stands before them, and as many bytes as the last one may touch.
const CORNER_ROOM: usize = 3 * 11 + 7;

/// A corner of a face: the same number for position, texture coordinate and normal.
fn corner(vertex: u32, room: &mut [u8; CORNER_ROOM]) -> usize {
    let number = Digits::of(vertex);
    let mut len = 0;
    for before in *b" //" {
        room[len] = before;
        len = number.put(room, len + 1);
    }
    len
}

fn vectors<const N: usize, const K: usize>(text: &mut Text, keyword: &[u8; K], vectors: &[[f32; N]]) {
    for vector in vectors {
        text.tuple((keyword, b" ", b"\n"), *vector);
    }
}

/// Vertices where they stand.
fn points(text: &mut Text, points: &[Vec3], motion: Option<&Motion>) {
    match motion {
        None => vectors::<3, _>(text, b"v ", bytemuck::cast_slice(points)),
        Some(motion) => {
            for &point in points {
                vectors(text, b"v ", &[motion.point(point).to_array()]);
            }
        }
    }
}

/// The skeleton: a polyline per axis, from the node that it leaves from.
fn write_lines(
    out: &mut Sink<'_>,
    tree: &str,
    skeleton: &Skeleton,
    motion: Option<Motion>,
    before: u32,
) -> Result<(), ExportError> {
    out.write(format!("o {tree}_skeleton\n").as_bytes())?;
    records::write(out, skeleton.positions.len(), |text, range| {
        points(text, &skeleton.positions[range], motion.as_ref());
    })?;
    records::write(out, skeleton.axes.len(), |text, range| {
        for axis in &skeleton.axes[range] {
            let foot = (axis.parent != NO_PARENT).then_some(axis.parent);
            let nodes = || foot.iter().chain(skeleton.nodes_of(axis));
            if nodes().count() < 2 {
                continue;
            }
            text.byte(b'l');
            for &node in nodes() {
                text.byte(b' ');
                text.integer(before + node + 1);
            }
            text.byte(b'\n');
        }
    })
}

/// What the opacity of a material is called, but for the ending, where it has one that is written.
fn cut_out(material: &Material, pictures: &[NamedPicture<'_>]) -> Option<String> {
    material.cutout?;
    let color = &pictures[pictures::index_of(pictures, material.base_color_picture.as_ref())?];
    Some(format!("{}_opacity", color.stem()))
}

/// The alpha of a picture in all its channels: readers of `map_d` take the alpha, the green or the mean.
fn opacity(picture: &Picture) -> Picture {
    let rgba = picture.rgba().as_chunks::<4>().0.iter().flat_map(|pixel| [pixel[3]; 4]).collect();
    Picture::new(picture.width(), picture.height(), rgba)
}

/// `files` are those of the pictures, `cuts` those of their opacities by what these are called.
fn material_library(
    materials: &[NamedMaterial<'_>],
    pictures: &[NamedPicture<'_>],
    files: &[String],
    cuts: &[(String, String)],
) -> String {
    let mut mtl = format!("# {GENERATOR}\n");
    let file = |picture: Option<_>| pictures::index_of(pictures, picture).map(|index| &files[index]);
    for NamedMaterial { name, material, .. } in materials {
        let Material { base_color, base_color_picture, normal_picture, roughness, .. } = material;
        let color_file = file(base_color_picture.as_ref());
        // Readers multiply the two, and the picture is to be used as it is.
        let [r, g, b] = if color_file.is_some() { [1.0; 3] } else { *base_color };
        // `Pr` is what readers of today take; `Ns` is the same for the others, as Blender converts it.
        let exponent = 1000.0 * (1.0 - roughness) * (1.0 - roughness);
        mtl += &format!(
            "\nnewmtl {}\nKa 0 0 0\nKd {r} {g} {b}\nKs 0 0 0\nNs {exponent}\nPr {roughness}\nd 1\nillum 1\n",
            one_word(name)
        );
        if let Some(file) = color_file {
            mtl += &format!("map_Kd {file}\n");
        }
        let cut = cut_out(material, pictures);
        if let Some((_, file)) = cuts.iter().find(|(stem, _)| Some(stem) == cut.as_ref()) {
            mtl += &format!("map_d {file}\n");
        }
        if let Some(file) = file(normal_picture.as_ref()) {
            // `norm` is what assimp and others read; Blender takes `map_Bump`, and shows it as a map of normals.
            mtl += &format!("norm {file}\nmap_Bump -bm 1 {file}\n");
        }
    }
    mtl
}
