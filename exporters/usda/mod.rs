//! OpenUSD as text (`.usda`; `.usd` too, because readers tell text from binary by content).
//!
//! ```text
//! /fir                  Xform, component, the recipe
//!     /Geometry/wood      Mesh per part
//!     /Geometry/Skeleton  BasisCurves, a curve per axis
//!     /Materials/bark     UsdPreviewSurface
//! ```
//!
//! Several plants, or one with what stands around it, are an [`assembly`].
//!
//! The recipe stands twice: in the root's `customData` (what USD has it for) and as the attribute
//! `userProperties:linden:recipe` (what importers keep). The skeleton has purpose `guide`: it lies
//! inside the wood, and a renderer that drew it would show it through every gap.

mod assembly;
mod indexed;
mod layer;
mod material;
mod mesh;
mod plant;
mod skeleton;
mod syntax;

use std::sync::Arc;

use linden::Monitor;
use linden::memory::bytes_of;
use linden::picture::Picture;
use linden::scene::{Mesh, Wrap};
use linden::stage::Stage;

use self::layer::Layer;
use self::plant::{Component, Head};
use self::syntax::{identifier, quoted};
use crate::cast::Cast;
use crate::options::{OptionSpec, Options};
use crate::picture::{self, Named};
use crate::{Bundle, ExportError, Exporter, Format, GENERATOR, memory};

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
        OptionSpec::switch(
            "instances",
            false,
            "the trees of a forest by a PointInstancer instead of references",
        ),
    ],
};

/// What all writers of prims need.
struct Writing<'a> {
    stage: &'a Stage<'a>,
    cast: Cast<'a>,
    pictures: Vec<Named<'a>>,
    /// The files of `pictures`.
    files: Vec<String>,
    /// The file of the sky's picture.
    sky: Option<String>,
    with_skeleton: bool,
    with_lights: bool,
}

impl Writing<'_> {
    /// The file of a picture, where it is written.
    fn file(&self, picture: Option<&Arc<Picture>>) -> Option<&str> {
        picture::index_of(&self.pictures, picture).map(|index| self.files[index].as_str())
    }
}

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
        let cast = Cast::in_setting(stage, monitor)?;
        let mut pictures =
            if options.is_on("pictures") { picture::pictures(&cast.looks) } else { Vec::new() };
        if !pictures.is_empty() {
            pictures.extend(stage.setting.as_ref().map(|setting| Named {
                suffix: "_sky.png".to_owned(),
                picture: &setting.sky.picture,
                wrap: Wrap::Clamp,
            }));
        }
        if !pictures.is_empty() && !bundle.takes_side_files() {
            bundle.note(
                "USD keeps pictures in files beside it: left out of a single stream, one colour instead",
            );
            pictures.clear();
        }
        memory::admit(stage, &pictures, own_bytes(&cast), monitor)?;
        for (named, png) in pictures.iter().zip(picture::compress(&pictures)?) {
            bundle.write_side(&named.suffix, Some(png.len() as u64), monitor, |out| out.write(png))?;
        }
        let files: Vec<_> = pictures.iter().map(|named| bundle.side_name(&named.suffix)).collect();
        let sky = stage.setting.as_ref().and_then(|_| files.last().cloned());
        let with_skeleton = options.is_on("skeleton");
        let writing = Writing { stage, cast, pictures, files, sky, with_skeleton, with_lights: true };
        bundle.write_main(None, monitor, |out| {
            write_layer(&mut Layer::new(out), &writing, options.is_on("instances"))
        })
    }
}

/// What writing takes: of one mesh after the other, its texture coordinates each once (a table of
/// indices, at most half full, the values, an index a vertex).
fn own_bytes(cast: &Cast<'_>) -> u64 {
    let indexed = |mesh: &Mesh| {
        let table = bytes_of::<u32>((2 * mesh.positions.len()).next_power_of_two());
        table + memory::per_vertex::<([f32; 2], u32)>(mesh)
    };
    memory::largest(cast, indexed) + memory::formatting(cast)
}

fn write_layer(layer: &mut Layer<'_, '_>, writing: &Writing<'_>, instances: bool) -> Result<(), ExportError> {
    let stage = writing.stage;
    let root = identifier(&stage.name);
    let generator = quoted(GENERATOR);
    layer.lines(&format!(
        r#"#usda 1.0
(
    defaultPrim = "{root}"
    doc = {generator}
    metersPerUnit = 1
    upAxis = "Y"
)
"#
    ))?;
    layer.lines("\n")?;
    if !stage.is_single() || stage.setting.is_some() {
        return assembly::write(layer, writing, &root, instances);
    }
    let component = Component::new(writing, 0, format!("/{root}"));
    let variants = component.variants();
    Head { prim: &root, name: &stage.name, recipe: &stage.recipe, kind: "component", variants }
        .open(layer)?;
    component.write(layer)?;
    layer.close()
}
