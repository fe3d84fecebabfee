//! STL, binary: triangles and nothing else, for slicers, simulations and CAD.
//!
//! 80 bytes of text, the number of triangles, and for each its normal, its three corners and two bytes that
//! are 0. There is no room for the recipe: 80 bytes are too few, the two bytes of each triangle mean colours
//! to some programs, and bytes after the last triangle make others refuse the file.
//!
//! STL knows neither an axis nor a unit. What reads it is Z up with few exceptions (slicers, CAD, Blender), so
//! trees stand along Z here: `(x, y, z)` becomes `(x, -z, y)`. Numbers are metres as in all formats of linden,
//! or millimetres with `unit=mm`: slicers take every number for millimetres.

use std::io;

use linden_pipeline::stage::{Motion, Stage};
use linden_pipeline::{Monitor, Vec3};

use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::{fit, memory, records};
use crate::{
    Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, LooksIn, OptionSpec, Options,
    Readable, Sink,
};

/// Binary STL.
pub(crate) struct Stl;

static FORMAT: Format = Format {
    id: "stl",
    name: "STL (binary)",
    extensions: &["stl"],
    media_type: "model/stl",
    self_contained: true,
    help: "triangles alone, Z up, for printing and simulation: no colours, parts or recipe",
    options: &[OptionSpec::choice(
        "unit",
        &["m", "mm"],
        "what 1 is in the file, which cannot say it; mm for slicers, which take every number for millimetres",
    )],
    holds: Holds {
        surface: true,
        levels: LooksIn::Files,
        seasons: LooksIn::Files,
        recipe: false,
        ..Holds::SKELETON
    },
    levels_by: None,
    encoding: |_| Encoding::Binary,
    estimate: Some(|amounts, _| HEADER as u64 + 4 + TRIANGLE as u64 * amounts.triangles),
};

/// Bytes of the header.
const HEADER: usize = 80;
/// Bytes of a triangle.
const TRIANGLE: usize = 50;

impl Exporter for Stl {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    /// There is none in these files.
    fn recipe(&self, _: &mut dyn Readable) -> io::Result<Option<String>> {
        Ok(None)
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
        memory::admit(stage, &[], memory::formatting(&distinct), monitor)?;
        let parts = || {
            let placed = distinct.placed(stage);
            placed.flat_map(|(place, plant)| plant.parts.iter().map(move |part| (part, place.motion())))
        };
        let triangles: usize = parts().map(|(part, _)| part.mesh.triangles.len()).sum();
        let count = u32::try_from(triangles).map_err(|_| ExportError::TooLarge {
            format: FORMAT.id,
            amount: format!("{triangles} triangles"),
            limit: "4 294 967 295",
            advice: "lower the resolution",
        })?;
        let (unit, per_metre) =
            if options.is_word("unit", "mm") { ("millimetres", 1000.0) } else { ("metres", 1.0) };
        let bytes = HEADER + 4 + TRIANGLE * triangles;
        bundle.write_main(Some(bytes as u64), monitor, |out| {
            out.write(&header(unit))?;
            out.write(&count.to_le_bytes())?;
            parts().try_for_each(|(part, motion)| write_part(out, part, motion, per_metre))
        })
    }
}

/// What wrote the file, and in which unit and axes. A text file would begin with `solid`.
fn header(unit: &str) -> [u8; HEADER] {
    let mut header = [b' '; HEADER];
    let text = format!("binary STL, {GENERATOR}, {unit}, Z up");
    for (to, byte) in header.iter_mut().zip(text.bytes()) {
        *to = byte;
    }
    header
}

fn write_part(
    out: &mut Sink<'_>,
    part: &MeshPart<'_>,
    motion: Option<Motion>,
    per_metre: f32,
) -> Result<(), ExportError> {
    let mesh = &*part.mesh;
    records::write(out, mesh.triangles.len(), |text, range| {
        for triangle in &mesh.triangles[range] {
            let corners = triangle.map(|vertex| {
                let point = mesh.positions[vertex as usize];
                motion.map_or(point, |motion| motion.point(point))
            });
            // A triangle without an area has no normal: that of its first corner is as good.
            let normal = facet_normal(corners).unwrap_or_else(|| {
                let normal = mesh.normals[triangle[0] as usize];
                motion.map_or(normal, |motion| motion.direction(normal))
            });
            let [a, b, c] = corners.map(|corner| z_up(corner * per_metre));
            let mut record = [0; TRIANGLE];
            let numbers: [[f32; 3]; 4] = [z_up(normal), a, b, c];
            record[..48].copy_from_slice(bytemuck::bytes_of(&numbers));
            text.bytes(&record);
        }
    })
}

/// The unit vector out of the side from which the corners run counter-clockwise. In 64 bits, so that the
/// smallest triangles of bark and buds have one too.
fn facet_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a).try_normalize().map(linden_pipeline::DVec3::as_vec3)
}

fn z_up(Vec3 { x, y, z }: Vec3) -> [f32; 3] {
    [x, -z, y]
}

#[cfg(test)]
mod tests {
    use linden_pipeline::Quiet;
    use linden_pipeline::dress::dress;
    use linden_pipeline::grow::grow;
    use linden_pipeline::preset::builtin;
    use linden_pipeline::recipe::Recipe;
    use linden_pipeline::scene::Scene;
    use linden_pipeline::stage::Place;

    use super::*;
    use crate::bundle::test_output::Output;

    fn scene() -> Scene {
        let mut preset = builtin("dressed-simple").unwrap().load().unwrap();
        for (knob, value) in [("points", "60"), ("bark_size", "16"), ("leaf_size", "16")] {
            preset.set(knob, value).unwrap();
        }
        let recipe = Recipe::new(preset);
        dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap()
    }

    /// Normal and corners of each triangle, and what was noted.
    fn written(stage: &Stage<'_>, unit: &str) -> (Vec<[Vec3; 4]>, Vec<String>) {
        let output = Output::default();
        let mut bundle = Bundle::stream("test", output.clone());
        let mut options = Options::new(&FORMAT);
        options.set("unit", unit).unwrap();
        Stl.write(stage, &options, &mut bundle, &Quiet).unwrap();
        let bytes = output.bytes();
        assert!(!bytes.starts_with(b"solid") && bytes[..HEADER].is_ascii());
        let count = u32::from_le_bytes(bytes[HEADER..HEADER + 4].try_into().unwrap());
        let body = &bytes[HEADER + 4..];
        assert_eq!(body.len(), TRIANGLE * count as usize);
        let triangle = |record: &[u8; TRIANGLE]| {
            assert_eq!(record[48..], [0, 0]);
            let number = |at: usize| f32::from_le_bytes(record[at..at + 4].try_into().unwrap());
            [0, 12, 24, 36].map(|at| Vec3::new(number(at), number(at + 4), number(at + 8)))
        };
        let triangles = body.as_chunks::<TRIANGLE>().0.iter().map(triangle).collect();
        (triangles, bundle.notes().to_vec())
    }

    #[test]
    fn triangles_are_those_of_the_scene_turned_upright() {
        let scene = scene();
        let (found, notes) = written(&Stage::of(&scene), "m");
        let meshes = scene.parts.iter().map(|part| &part.mesh);
        let expected: Vec<[Vec3; 3]> = meshes
            .flat_map(|mesh| mesh.triangles.iter().map(|t| t.map(|vertex| mesh.positions[vertex as usize])))
            .collect();
        assert_eq!(found.len(), expected.len());
        for ([normal, corners @ ..], expected) in found.iter().zip(&expected) {
            // Y up again: a quarter turn, no reflection.
            let back = |&Vec3 { x, y, z }: &Vec3| Vec3::new(x, z, -y);
            assert_eq!(&[back(&corners[0]), back(&corners[1]), back(&corners[2])], expected);
            assert!((normal.length() - 1.0).abs() < 1e-5);
            let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            assert!(across.dot(*normal) >= 0.0, "{across} against {normal}");
        }
        let tallest = found.iter().flatten().map(|point| point.z).fold(0.0, f32::max);
        assert!(tallest > 1.0, "a tree stands along Z: {tallest}");
        assert!(notes.iter().any(|note| note.contains("recipe")), "{notes:?}");
    }

    #[test]
    fn millimetres_are_a_thousand_to_the_metre_and_places_are_moved_to() {
        let scene = scene();
        let mut stage = Stage::of(&scene);
        let (metres, _) = written(&stage, "m");
        let (millimetres, _) = written(&stage, "mm");
        for (m, mm) in metres.iter().flat_map(|t| &t[1..]).zip(millimetres.iter().flat_map(|t| &t[1..])) {
            assert!((*mm - *m * 1000.0).length() <= 1e-3 * mm.length().max(1.0));
        }
        stage.places.push(Place { position: Vec3::new(40.0, 0.0, -9.0), ..Place::origin(0) });
        let (both, _) = written(&stage, "m");
        let (first, second) = both.split_at(metres.len());
        assert_eq!(first, metres);
        // East stays X, and what was towards -Z is Y.
        assert!(second[0][1].abs_diff_eq(metres[0][1] + Vec3::new(40.0, 9.0, 0.0), 1e-4));
    }
}
