//! OpenUSD as text (`.usda`; `.usd` too, because readers tell text from binary by content).
//!
//! ```text
//! /fir                  Xform, component, the recipe
//!     /Geometry/wood      Mesh per part
//!     /Geometry/Skeleton  BasisCurves, a curve per axis
//!     /Materials/bark     UsdPreviewSurface
//! ```
//!
//! The recipe stands twice: in the root's `customData` (what USD has it for) and as the attribute
//! `userProperties:linden:recipe` (what importers keep). The skeleton has purpose `guide`: it lies
//! inside the wood, and a renderer that drew it would show it through every gap.

mod indexed;
mod material;
mod syntax;

use glam::Vec3;
use linden::Monitor;
use linden::memory::bytes_of;
use linden::scene::{Bounds, Mesh};
use linden::skeleton::{Axis, NO_PARENT, Skeleton};
use linden::stage::Stage;

use self::syntax::{Names, identifier, quoted, tuple};
use crate::cast::{Cast, Piece};
use crate::chunks::{self, Text};
use crate::memory;
use crate::options::{OptionSpec, Options};
use crate::{Bundle, ExportError, Exporter, Format, GENERATOR, Sink, picture};

/// OpenUSD as text.
pub(crate) struct Usda;

static FORMAT: Format = Format {
    id: "usda",
    name: "OpenUSD (text)",
    extensions: &["usda", "usd"],
    media_type: "model/vnd.usda",
    self_contained: false,
    help: "for film pipelines: mesh, UsdPreviewSurface and the skeleton as curves; pictures lie beside it",
    options: &[
        OptionSpec::switch("pictures", true, "bark pictures beside the file; without, one colour"),
        OptionSpec::switch("skeleton", true, "the skeleton too, as guide curves: one per axis"),
    ],
};

impl Exporter for Usda {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let cast = Cast::of(stage, monitor)?;
        let Some((_, model)) = cast.placed(stage).next().filter(|_| stage.is_plain()) else {
            let advice = "write its trees one by one, or the whole as glb";
            return Err(ExportError::Holds { format: FORMAT.id, what: "several trees or levels", advice });
        };
        let mut pictures =
            if options.is_on("pictures") { picture::pictures(&cast.looks) } else { Vec::new() };
        if !pictures.is_empty() && !bundle.takes_side_files() {
            bundle.note(
                "USD keeps pictures in files beside it: left out of a single stream, one colour instead",
            );
            pictures.clear();
        }
        // Texture coordinates each once: a table of indices, at most half full, the values, an index a vertex.
        let indexed = |mesh: &Mesh| {
            let vertices = mesh.positions.len();
            bytes_of::<u32>((2 * vertices).next_power_of_two()) + memory::per_vertex::<([f32; 2], u32)>(mesh)
        };
        let own = memory::largest(&cast, indexed) + memory::formatting(&cast);
        memory::admit(stage, &pictures, own, monitor)?;
        for (named, png) in pictures.iter().zip(picture::compress(&pictures)?) {
            bundle.write_side(&named.suffix, Some(png.len() as u64), monitor, |out| out.write(png))?;
        }
        let files: Vec<_> = pictures.iter().map(|named| bundle.side_name(&named.suffix)).collect();
        let root = identifier(&stage.name);
        let mut names = Names::default();
        let materials: Vec<_> = cast.looks.iter().map(|look| names.unique(&look.name)).collect();
        let head = header(stage, &root);
        bundle.write_main(None, monitor, |out| {
            out.write(head.as_bytes())?;
            out.write(b"    def Scope \"Geometry\"\n    {\n")?;
            let mut names = Names::default();
            for piece in &model.pieces {
                let binding = format!("/{root}/Materials/{}", materials[piece.look]);
                write_mesh(out, &cast, piece, &names.unique(piece.name), &binding)?;
            }
            if options.is_on("skeleton") {
                write_skeleton(out, &model.scene.skeleton, &names.unique("Skeleton"))?;
            }
            out.write(b"    }\n\n    def Scope \"Materials\"\n    {\n")?;
            for (look, name) in cast.looks.iter().zip(&materials) {
                let text = material::describe(
                    look.material,
                    name,
                    &format!("/{root}/Materials/{name}"),
                    |picture| picture::index_of(&pictures, picture).map(|index| files[index].as_str()),
                );
                out.write(text.as_bytes())?;
            }
            out.write(b"    }\n}\n")
        })
    }
}

/// The layer's metadata and the root prim up to its children.
fn header(stage: &Stage<'_>, root: &str) -> String {
    let name = quoted(&stage.name);
    let recipe = quoted(&stage.recipe);
    let generator = quoted(GENERATOR);
    format!(
        r#"#usda 1.0
(
    defaultPrim = "{root}"
    doc = {generator}
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "{root}" (
    assetInfo = {{
        string name = {name}
        string version = "1"
    }}
    customData = {{
        dictionary linden = {{
            string generator = {generator}
            string recipe = {recipe}
        }}
    }}
    displayName = {name}
    kind = "component"
)
{{
    custom string userProperties:linden:recipe = {recipe}

"#
    )
}

fn write_mesh(
    out: &mut Sink<'_>,
    cast: &Cast<'_>,
    &Piece { mesh, bounds, look, .. }: &Piece<'_>,
    name: &str,
    material: &str,
) -> Result<(), ExportError> {
    let material_of = cast.looks[look].material;
    let head = format!(
        r#"        def Mesh "{name}" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {{
            uniform bool doubleSided = {}
            float3[] extent = [{}, {}]
            uniform token orientation = "rightHanded"
            uniform token subdivisionScheme = "none"
            rel material:binding = <{material}>
            color3f[] primvars:displayColor = [{}] (
                interpolation = "constant"
            )
"#,
        u8::from(material_of.double_sided),
        tuple(bounds.min.to_array()),
        tuple(bounds.max.to_array()),
        tuple(material_of.base_color),
    );
    out.write(head.as_bytes())?;
    let vertex = " (\n                interpolation = \"vertex\"\n            )";
    array(out, "int[] faceVertexCounts", mesh.triangles.len(), "", |text, _| text.byte(b'3'))?;
    array(out, "int[] faceVertexIndices", mesh.triangles.len(), "", |text, i| {
        let [a, b, c] = mesh.triangles[i];
        text.integer(a);
        text.bytes(b", ");
        text.integer(b);
        text.bytes(b", ");
        text.integer(c);
    })?;
    let count = mesh.positions.len();
    array(out, "point3f[] points", count, "", |text, i| vector(text, mesh.positions[i].to_array()))?;
    array(out, "normal3f[] normals", count, vertex, |text, i| vector(text, mesh.normals[i].to_array()))?;
    let st = "texCoord2f[] primvars:st";
    if let Some((once, indices)) = indexed::indexed(&mesh.uvs) {
        array(out, st, once.len(), vertex, |text, i| vector(text, once[i].to_array()))?;
        array(out, "int[] primvars:st:indices", indices.len(), "", |text, i| text.integer(indices[i]))?;
    } else {
        array(out, st, count, vertex, |text, i| vector(text, mesh.uvs[i].to_array()))?;
    }
    out.write(b"        }\n\n")
}

/// Each axis as a chain of straight pieces from the node that it leaves from, as wide as the wood.
fn write_skeleton(out: &mut Sink<'_>, skeleton: &Skeleton, name: &str) -> Result<(), ExportError> {
    // Foot (where the axis leaves its parent) and nodes; a curve needs two points.
    let foot = |axis: &Axis| (axis.parent != NO_PARENT).then_some(axis.parent);
    let mut axes = Vec::with_capacity(skeleton.axes.len());
    let mut nodes = Vec::with_capacity(skeleton.positions.len() + skeleton.axes.len());
    let mut radii = Vec::with_capacity(nodes.capacity());
    for axis in &skeleton.axes {
        let own = skeleton.nodes_of(axis);
        if own.len() + usize::from(foot(axis).is_some()) < 2 || own.is_empty() {
            continue;
        }
        axes.push((axis, (own.len() + usize::from(foot(axis).is_some())) as u32));
        nodes.extend(foot(axis));
        nodes.extend(own);
        // At its foot an axis is as thick as itself, not as the trunk that it leaves.
        let thickness = own.iter().map(|&node| skeleton.radii[node as usize]);
        radii.extend(foot(axis).and(thickness.clone().next()).into_iter().chain(thickness));
    }
    let points = nodes.iter().map(|&node| skeleton.positions[node as usize]);
    let Some(Bounds { min, max }) = Bounds::of(points) else { return Ok(()) };
    // By the widest curve all round, as UsdGeomCurves computes it.
    let reach = Vec3::splat(radii.iter().copied().fold(0.0, f32::max));
    let head = format!(
        r#"        def BasisCurves "{name}"
        {{
            float3[] extent = [{}, {}]
            uniform token purpose = "guide"
            uniform token type = "linear"
            uniform token wrap = "nonperiodic"
"#,
        tuple((min - reach).to_array()),
        tuple((max + reach).to_array()),
    );
    out.write(head.as_bytes())?;
    let per = |what| format!(" (\n                interpolation = \"{what}\"\n            )");
    let node = |i: usize| nodes[i] as usize;
    array(out, "int[] curveVertexCounts", axes.len(), "", |text, i| text.integer(axes[i].1))?;
    array(out, "point3f[] points", nodes.len(), "", |text, i| {
        vector(text, skeleton.positions[node(i)].to_array());
    })?;
    array(out, "float[] widths", nodes.len(), &per("vertex"), |text, i| text.float(2.0 * radii[i]))?;
    array(out, "int[] primvars:linden:order", axes.len(), &per("uniform"), |text, i| {
        text.integer(axes[i].0.order);
    })?;
    array(out, "int[] primvars:linden:birth", nodes.len(), &per("vertex"), |text, i| {
        text.integer(skeleton.births[node(i)].min(i32::MAX as u32));
    })?;
    out.write(b"        }\n\n")
}

/// An attribute of many elements: `item` formats one.
fn array(
    out: &mut Sink<'_>,
    declaration: &str,
    count: usize,
    metadata: &str,
    item: impl Fn(&mut Text, usize) + Sync,
) -> Result<(), ExportError> {
    // Editors and diff choke on a line of a hundred megabytes.
    const PER_LINE: usize = 64;
    out.write(format!("            {declaration} = [").as_bytes())?;
    chunks::write(out, count, |text, range| {
        for i in range {
            if i > 0 {
                text.bytes(if i % PER_LINE == 0 { b",\n" } else { b", " });
            }
            item(text, i);
        }
    })?;
    out.write(format!("]{metadata}\n").as_bytes())
}

fn vector<const N: usize>(text: &mut Text, numbers: [f32; N]) {
    text.byte(b'(');
    text.floats(numbers, b", ");
    text.byte(b')');
}
