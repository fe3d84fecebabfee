//! 3MF, for printers: triangles with their unit, parts with names and colours, and the recipe.
//!
//! <https://3mf.io/spec>, the core specification 1.3: a ZIP archive (OPC) with the model as XML, here stored as it is and
//! first, so that the recipe is found without the directory. Z is up: `(x, y, z)` becomes `(x, -z, y)`; numbers are
//! millimetres, as the file says. Vertices that share their place are one, so that a closed surface is closed for slicers too;
//! there are no normals and no texture coordinates.

use std::io;

use linden_pipeline::knob::listed;
use linden_pipeline::stage::{Motion, Stage};
use linden_pipeline::{Monitor, Vec3};

use crate::markup::{escaped, unescaped};
use crate::usda::package::{self, Package};
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::{fit, mean_digits, memory, pictures::srgb, records, turned_colors};
use crate::{
    Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, LooksIn, OptionSpec, Options,
    Readable, Sink, recipe,
};

/// 3D Manufacturing Format.
pub(crate) struct ThreeMf;

static FORMAT: Format = Format {
    id: "3mf",
    name: "3MF",
    extensions: &["3mf"],
    media_type: "model/3mf",
    self_contained: true,
    help: "for slicers: triangles in millimetres, Z up, parts with their colours, and the recipe",
    options: &[SCALE],
    holds: Holds {
        surface: true,
        colors: true,
        levels: LooksIn::Files,
        seasons: LooksIn::Files,
        ..Holds::SKELETON
    },
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, _| {
        // `<vertex x="" y="" z=""/>` and `<triangle v1="" v2="" v3=""/>`. Of wood two thirds of the vertices at most
        // share their place with another one: seams, caps, and strands that run in each other.
        let faces = amounts.triangles as f64 * (3.0 * mean_digits(amounts.vertices) + 33.0);
        let wood = (amounts.vertices - amounts.leaf_vertices) as f64;
        let vertices = 14.0 * wood + 42.0 * amounts.leaf_vertices as f64;
        (vertices + faces) as u64 + amounts.recipe_bytes + 2000
    }),
};

/// How many metres of the plant are one of the print.
const SCALE: OptionSpec = OptionSpec::count(
    "scale",
    (1, 10_000),
    "100",
    "the print is one part in so many: 100 makes 10 cm of 10 m",
);

const MODEL: &str = "3D/3dmodel.model";
const RECIPE: &str = "<metadata name=\"linden:recipe\">";
const END: &str = "</metadata>";

impl Exporter for ThreeMf {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        package::first(file, |file| Ok(told(file, RECIPE)?.map(|text| unescaped(&text))))
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<crate::Traces> {
        let told = package::first(file, |file| told(file, "<metadata name=\"linden:scale\">"))?;
        let traces = crate::Traces::none(&FORMAT);
        Ok(match told {
            Some(scale) => traces.with(SCALE.knob.name, &scale),
            None => traces,
        })
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let colors = turned_colors(stage);
        if !colors.is_empty() {
            bundle.note(format!(
                "3mf has one colour for each part, and no pictures: what else is to be seen of {} is left out",
                listed(&colors, "and")
            ));
        }
        let distinct = DistinctMeshes::of(stage, monitor)?;
        let text = distinct.placed(stage).flat_map(|(_, plant)| &plant.parts).map(text_bytes).sum::<u64>();
        let welding = memory::largest(&distinct, memory::per_vertex::<(u32, u32, Vec3)>);
        // A quarter more: while points are welded, the list of them grows.
        memory::admit(stage, &[], memory::formatting(&distinct) + welding + text + text / 4, monitor)?;
        let scale = options.number(SCALE.knob.name).max(1);
        let mut package = Package::with_capacity(text as usize);
        package.push_with(MODEL, |bytes| {
            Sink::gather("the 3MF model", bytes, monitor, |out| write_model(out, stage, &distinct, scale))
        })?;
        package.push("[Content_Types].xml", CONTENT_TYPES.as_bytes())?;
        package.push("_rels/.rels", RELATIONS.as_bytes())?;
        let bytes = package.finish()?;
        bundle.write_main(Some(bytes.len() as u64), monitor, |out| out.write(&bytes))
    }
}

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// What a part takes as text, rather more than less.
fn text_bytes(part: &MeshPart<'_>) -> u64 {
    512 + 64 * part.mesh.positions.len() as u64 + 60 * part.mesh.triangles.len() as u64
}

fn write_model(
    out: &mut Sink<'_>,
    stage: &Stage<'_>,
    distinct: &DistinctMeshes<'_>,
    scale: usize,
) -> Result<(), ExportError> {
    let (name, recipe) = recipe::of_stage(stage);
    let title = escaped(&linden_pipeline::knob::printable(name));
    let mut head = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:linden=\"urn:linden\">\n<metadata name=\"Title\">{title}{END}\n\
         <metadata name=\"Application\">{}{END}\n<metadata name=\"linden:scale\">{scale}{END}\n{RECIPE}{}{END}\n{}\
         <resources>\n<basematerials id=\"1\">\n",
        escaped(GENERATOR),
        escaped(recipe),
        recipe::foot_in_file(stage).map_or_else(String::new, |[x, y, z]| {
            format!("<metadata name=\"linden:footInFile\">{x} {y} {z}{END}\n")
        }),
    );
    for named in &distinct.materials {
        let [r, g, b] = named.material.base_color.map(srgb);
        head +=
            &format!("<base name=\"{}\" displaycolor=\"#{r:02X}{g:02X}{b:02X}\"/>\n", escaped(&named.name));
    }
    head += "</basematerials>\n";
    out.write(head.as_bytes())?;
    let mut objects = 1;
    for (place, plant) in distinct.placed(stage) {
        for part in &plant.parts {
            objects += 1;
            let name = escaped(&plant.full_name(&part.name));
            write_object(out, objects, &name, part, place.motion(), 1000.0 / scale as f32)?;
        }
    }
    let mut foot = "</resources>\n<build>\n".to_owned();
    for id in 2..=objects {
        foot += &format!("<item objectid=\"{id}\"/>\n");
    }
    foot += "</build>\n</model>\n";
    out.write(foot.as_bytes())
}

fn write_object(
    out: &mut Sink<'_>,
    id: usize,
    name: &str,
    part: &MeshPart<'_>,
    motion: Option<Motion>,
    per_metre: f32,
) -> Result<(), ExportError> {
    let (points, triangles) = welded(&part.mesh.positions, &part.mesh.triangles);
    out.write(
        format!(
            "<object id=\"{id}\" name=\"{name}\" type=\"model\" pid=\"1\" pindex=\"{}\">\n<mesh>\n<vertices>\n",
            part.material
        )
        .as_bytes(),
    )?;
    records::write(out, points.len(), |text, range| {
        for &point in &points[range] {
            let Vec3 { x, y, z } = per_metre * motion.map_or(point, |motion| motion.point(point));
            text.bytes(b"<vertex x=\"");
            text.float(x);
            text.bytes(b"\" y=\"");
            text.float(-z);
            text.bytes(b"\" z=\"");
            text.float(y);
            text.bytes(b"\"/>\n");
        }
    })?;
    out.write(b"</vertices>\n<triangles>\n")?;
    records::write(out, triangles.len(), |text, range| {
        for triangle in &triangles[range] {
            let [a, b, c] = *triangle;
            text.bytes(b"<triangle v1=\"");
            text.integer(a);
            text.bytes(b"\" v2=\"");
            text.integer(b);
            text.bytes(b"\" v3=\"");
            text.integer(c);
            text.bytes(b"\"/>\n");
        }
    })?;
    out.write(b"</triangles>\n</mesh>\n</object>\n")
}

/// The points, each place once, and the triangles that have three of them.
fn welded(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    // `+ 0.0` makes the two zeros one.
    let key = |index: u32| (positions[index as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut sorted: Vec<u32> = (0..positions.len() as u32).collect();
    sorted.sort_by_key(|&index| (key(index), index));
    // The first of those that share a place, by its index.
    let mut first = vec![0; positions.len()];
    for same in sorted.chunk_by(|&a, &b| key(a) == key(b)) {
        for &index in same {
            first[index as usize] = same[0];
        }
    }
    let mut numbers = vec![0; positions.len()];
    let mut points = Vec::new();
    for (index, &first) in first.iter().enumerate() {
        if first as usize == index {
            numbers[index] = points.len() as u32;
            points.push(positions[index]);
        }
    }
    let of = |triangle: &[u32; 3]| triangle.map(|corner| numbers[first[corner as usize] as usize]);
    let is_flat = |[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
    (points, triangles.iter().map(of).filter(|triangle| !is_flat(triangle)).collect())
}

/// What a metadata of a name holds, in the first lines of a model.
fn told(file: &mut dyn Readable, beginning: &str) -> io::Result<Option<String>> {
    let line = recipe::line_behind(file, beginning)?;
    Ok(line.and_then(|line| Some(line.strip_suffix(END)?.to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_points_once_and_flat_triangles_go() {
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        let positions = [at(0.0), at(1.0), at(-0.0), at(2.0), at(1.0)];
        let (points, triangles) = welded(&positions, &[[0, 1, 3], [2, 4, 3], [0, 2, 1]]);
        assert_eq!(points, [at(0.0), at(1.0), at(2.0)]);
        assert_eq!(triangles, [[0, 1, 2], [0, 1, 2]]);
    }
}
