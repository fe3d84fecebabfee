//! OpenUSD as text (`.usda`; `.usd` too, because readers tell text from binary by content), and in binary (`.usdc`),
//! which is the same layer in another form: see [`layer`].
//!
//! ```text
//! /fir                  Xform, component, the recipe
//!     /Geometry/fir_wood  Mesh per part
//!     /Geometry/Skeleton  BasisCurves, a curve per axis
//!     /Materials/fir_bark UsdPreviewSurface; for leaves a MaterialX surface too
//! ```
//!
//! With `payload`, that is a small layer with the plant's head, and a file beside it with everything within: see
//! [`payload`]. With `proxy`, the coarsest level stands beside the others for viewports, thinned: see [`proxy`].
//!
//! With `instances`, foliage is a `PointInstancer` per part, which holds its prototypes.
//!
//! Several plants, or one with what stands around it, are an [`assembly`].
//!
//! The recipe stands twice: in the root's `customData` (what USD has it for) and as the attribute
//! `userProperties:linden:recipe` (what importers keep). The skeleton has purpose `guide`: it lies
//! inside the wood, and a renderer that drew it would show it through every gap.

pub(crate) mod ages;
mod assembly;
mod binary;
mod bones;
mod collision;
mod estimate;
mod extent;
mod indexed;
mod instancer;
mod layer;
mod material;
mod materialx;
mod mesh;
mod nanite;
mod nanite_wind;
pub(crate) mod package;
mod payload;
pub(crate) mod payloads;
mod plant;
mod proxy;
mod skeleton;
mod syntax;
mod wind;

use std::io;
use std::sync::Arc;

use linden_pipeline::memory::{bytes_grown, bytes_of};
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Mesh, Wrap};
use linden_pipeline::stage::{Stage, Surroundings};
use linden_pipeline::wind::Bones;
use linden_pipeline::{Monitor, Vec3};

pub(crate) use self::binary::Usdc;
use self::layer::Layer;
use self::nanite::{NANITE, Nanite};
use self::package::Package;
use self::payload::Split;
use self::plant::{Component, Head};
use self::syntax::identifier;
pub(crate) use self::syntax::{quoted, unquoted};
use crate::collision::{COLLISION, Colliders, MOST, told};
use crate::options::{OptionSpec, Options};
use crate::usdc::Names;
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::instances::{self, Moving};
use crate::writing::lightmap::{self, LIGHTMAP_UV, Sharing};
use crate::writing::pictures::{self, NamedPicture};
use crate::writing::{fit, memory, note_asked};
use crate::{
    Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Gatherer, Holds, LooksIn, Readable, Sink,
    Traces, UsdForm, recipe, traces,
};

const MATERIALX: OptionSpec = OptionSpec::switch(
    "materialx",
    true,
    "for leaves a MaterialX surface beside UsdPreviewSurface, which knows of no light that passes through",
);

/// OpenUSD as text.
pub(crate) struct Usda;

const INSTANCES: OptionSpec = OptionSpec::switch(
    "instances",
    false,
    "leaves (in a forest whole trees) as few meshes in many places, by a PointInstancer",
);

const LODS: OptionSpec = OptionSpec::choice(
    "lods",
    &["variants", "files"],
    "levels of detail: variants of the set lod; or a file each, for programs that let nobody choose",
);

/// What becomes of levels: an assembly is one, of which its reader makes others.
fn levels_by(options: &Options) -> LooksIn {
    match Nanite::asked(options) {
        _ if options.is_word(LODS.knob.name, "files") => LooksIn::Files,
        Some(_) => LooksIn::Nothing,
        None => LooksIn::One,
    }
}

const PROXY: OptionSpec = OptionSpec::switch(
    "proxy",
    false,
    "the coarsest level, thinned to 5000 triangles, for viewports (purpose proxy), all else of purpose render",
);

const PAYLOAD: OptionSpec = OptionSpec::switch(
    "payload",
    false,
    "a plant's geometry and materials in a file of their own that a small layer loads as its payload",
);

/// Of a layer with its pictures beside it.
static OPTIONS: [OptionSpec; 11] = [
    OptionSpec::switch("pictures", true, "bark pictures beside the file; without, one colour"),
    OptionSpec::switch("skeleton", true, "the skeleton too, as guide curves: one per axis"),
    INSTANCES,
    MATERIALX,
    LODS,
    LIGHTMAP_UV,
    COLLISION,
    MOST,
    PROXY,
    PAYLOAD,
    NANITE,
];

static FORMAT: Format = Format {
    id: "usda",
    name: "OpenUSD (text)",
    extensions: &["usda", "usd"],
    media_type: "model/vnd.usda",
    self_contained: false,
    help: "for film pipelines: mesh, UsdPreviewSurface and the skeleton as curves; pictures lie beside it",
    options: &OPTIONS,
    holds: Holds::SCENE,
    levels_by: Some(levels_by),
    encoding: |_| Encoding::Text,
    estimate: Some(estimate::bytes),
};

/// OpenUSD in one file.
pub(crate) struct Usdz;

static PACKAGE: Format = Format {
    id: "usdz",
    name: "OpenUSD (package)",
    extensions: &["usdz"],
    media_type: "model/vnd.usdz+zip",
    self_contained: true,
    help: "USD and its pictures in one file, for phones and handing on",
    options: &[
        OptionSpec::choice(
            "flavor",
            &["full", "ar"],
            "ar leaves out what augmented reality on phones refuses: curves, instancers, lights, setting",
        ),
        OptionSpec::choice(
            "layer",
            &["text", "binary"],
            "what is in the package beside the pictures: usda, or usdc in a quarter of the bytes",
        ),
        OptionSpec::switch("pictures", true, "pictures in the package; without, one colour"),
        OptionSpec::switch("skeleton", true, "the skeleton too, as guide curves: one per axis"),
        INSTANCES,
        MATERIALX,
        LODS,
        LIGHTMAP_UV,
        COLLISION,
        MOST,
        PROXY,
    ],
    holds: Holds::SCENE,
    levels_by: Some(levels_by),
    encoding: |options| if is_binary(options) { Encoding::Binary } else { Encoding::Text },
    estimate: Some(|amounts, options| {
        if is_binary(options) {
            estimate::binary_bytes(amounts, options)
        } else {
            estimate::bytes(amounts, options)
        }
    }),
};

/// What is said of meshes for others than renderers.
struct Said {
    /// What they are, for those who learn from pictures.
    labels: bool,
    /// A thinned level for viewports.
    proxy: bool,
}

/// What all writers of prims need.
struct Writing<'a> {
    stage: &'a Stage<'a>,
    distinct: DistinctMeshes<'a>,
    pictures: Vec<NamedPicture<'a>>,
    /// The files of `pictures`.
    files: Vec<String>,
    /// The file of the sky's picture.
    sky: Option<String>,
    with_skeleton: bool,
    with_instances: bool,
    with_materialx: bool,
    said: Said,
    /// Which of Unreal's assemblies it is.
    nanite: Option<Nanite>,
    /// Shapes for physics of each plant, and the options that they were asked for with.
    collision: Option<(Vec<Colliders>, String)>,
}

impl<'a> Writing<'a> {
    fn new(
        stage: &'a Stage<'_>,
        nanite: Option<Nanite>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<Self, ExportError> {
        let mut distinct = DistinctMeshes::in_setting(stage, monitor)?;
        let is_ar = options.is_word("flavor", "ar");
        let with_instances = (options.is_on("instances") && !is_ar) || nanite.is_some();
        if with_instances {
            let moving = nanite.map_or(Moving::Baked, |_| Moving::Bound);
            instances::unbake(&mut distinct, stage, moving, bundle, monitor)?;
        }
        if let Some(nanite) = nanite {
            nanite.lay_out(&mut distinct, bundle);
        }
        if options.is_on(LIGHTMAP_UV.knob.name) {
            lightmap::unwrap(&mut distinct, Sharing::None, stage, bundle, monitor)?;
        }
        let with_materialx = options.is_on("materialx") && !is_ar;
        let mut pictures = match options.is_on("pictures") {
            true if with_materialx => pictures::with_passing(&distinct.materials),
            true => pictures::of_materials(&distinct.materials),
            false => Vec::new(),
        };
        if !pictures.is_empty() {
            let skies = stage.setting.iter().map(|setting| &setting.sky.picture);
            pictures.extend(skies.map(|sky| NamedPicture::png(SKY, sky, Wrap::Clamp)));
        }
        let with_skeleton = options.is_on("skeleton") && !is_ar && nanite.is_none();
        note_materialx(&distinct, stage, options, bundle);
        let with_proxy = options.is_on("proxy");
        if with_proxy && (0..distinct.plants()).all(|plant| distinct.levels(plant) == 1) {
            bundle.note("proxy=true changes nothing: there is one level of detail in it");
        }
        let told = told(options);
        if told.is_some() && is_ar {
            bundle.note("usdz.flavor=ar: collision is left out, which phones do not know");
        }
        let colliders = |_: &String| {
            let first = |plant| distinct.models[distinct.model(plant, 0, 0)].scene;
            (0..distinct.plants()).map(|plant| Colliders::of(first(plant), options)).collect()
        };
        let collision = told.filter(|_| !is_ar && nanite.is_none()).map(|told| (colliders(&told), told));
        Ok(Self {
            stage,
            distinct,
            pictures,
            files: Vec::new(),
            sky: None,
            with_skeleton,
            with_instances,
            with_materialx,
            // Phones know less of USD.
            said: Said { labels: !is_ar, proxy: with_proxy },
            nanite,
            collision,
        })
    }

    /// Says what each picture's file is called, or the way to it.
    fn name_files(&mut self, files: Vec<String>) {
        self.files = files;
        let is_sky = self.pictures.last().is_some_and(|named| named.stem() == SKY);
        self.sky = self.files.last().filter(|_| is_sky).cloned();
    }

    /// The file of a picture, where it is written.
    fn file(&self, picture: Option<&Arc<Picture>>) -> Option<&str> {
        pictures::index_of(&self.pictures, picture).map(|index| self.files[index].as_str())
    }
}

/// Says where `materialx`, or what it is for, changes nothing.
fn note_materialx(distinct: &DistinctMeshes<'_>, stage: &Stage<'_>, options: &Options, bundle: &mut Bundle) {
    let is_on = options.is_on("materialx");
    let is_translucent = distinct.materials.iter().any(|named| named.material.translucency.is_some());
    if !is_on && !is_translucent {
        bundle.note("materialx=false changes nothing: there are no leaves that light passes through");
    }
    let is_ar = options.is_word("flavor", "ar");
    let is_turned = stage.turned.iter().any(|name| name == "leaf_translucency");
    if is_translucent && is_ar && !is_on {
        bundle.note("materialx=false changes nothing: usdz.flavor=ar leaves it out anyway");
    }
    if is_turned && (is_ar || !is_on) {
        bundle.note(
            "leaf_translucency changes nothing in it: UsdPreviewSurface has no word for it, materialx has",
        );
    }
}

/// What the name of the sky's picture ends with, but for its ending.
const SKY: &str = "_sky";

impl Exporter for Usda {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn gatherer(&self) -> Option<Gatherer> {
        Some(|ages, bundle, monitor| ages.write_usd(UsdForm::Text, bundle, monitor))
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        in_layer(file)
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        in_text(&FORMAT, file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        write_beside(&FORMAT, stage, options, bundle, monitor, |writing, bundle| {
            let Some(split) = Split::of(writing, "_payload.usda", options, bundle) else {
                return bundle.write_main(None, monitor, |out| write_layer(&mut Layer::new(out), writing));
            };
            bundle.write_side(&split.suffix, None, monitor, |out| {
                Split::write_payload(&mut Layer::new(out), writing)
            })?;
            bundle.write_main(None, monitor, |out| split.write_interface(&mut Layer::new(out), writing))
        })
    }
}

/// Writes a layer and its pictures beside it.
fn write_beside(
    format: &'static Format,
    stage: &Stage<'_>,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
    write: impl FnOnce(&Writing<'_>, &mut Bundle) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let stage = fit(stage, format, bundle);
    note_asked(&stage, options, bundle);
    let (nanite, stage) = Nanite::fit(stage, options, bundle);
    let mut writing = Writing::new(&stage, nanite, options, bundle, monitor)?;
    if !writing.pictures.is_empty() && !bundle.takes_side_files() {
        bundle.note("USD keeps pictures in files beside it: left out of a single stream, one colour instead");
        writing.pictures.clear();
    }
    // A binary layer is held whole, in memory that grows.
    let is_binary = (format.encoding)(options) == Encoding::Binary;
    let held = if is_binary { 2 * layer_bytes(&writing, true) } else { 0 };
    memory::admit(&stage, &writing.pictures, own_bytes(&writing.distinct) + held, monitor)?;
    write_wind(&writing, bundle, monitor)?;
    let mut files = Vec::with_capacity(writing.pictures.len());
    for (named, png) in writing.pictures.iter().zip(pictures::compress(&writing.pictures)?) {
        files.push(bundle.write_picture(&named.suffix, &png, monitor)?);
    }
    writing.name_files(files);
    write(&writing, bundle)
}

/// Writes the wind of a skeletal assembly beside it.
fn write_wind(writing: &Writing<'_>, bundle: &mut Bundle, monitor: &dyn Monitor) -> Result<(), ExportError> {
    let pieces: Vec<_> = writing.distinct.parts().collect();
    let Some(bones) = bones::of(&pieces).filter(|_| writing.nanite.is_some()) else { return Ok(()) };
    if !bundle.takes_side_files() {
        bundle.note("nanite: the wind is a file beside it: left out of a single stream");
        return Ok(());
    }
    let text = nanite_wind::describe(bones);
    bundle.write_side(nanite_wind::SUFFIX, Some(text.len() as u64), monitor, |out| out.write(text.as_bytes()))
}

/// What a layer takes, rather more than less.
fn layer_bytes(writing: &Writing<'_>, is_binary: bool) -> u64 {
    let distinct = &writing.distinct;
    let nodes = distinct.models.iter().map(|model| model.scene.skeleton.positions.len() as u64).sum::<u64>();
    let placements = distinct.placements() as u64;
    let bound = nanite::bytes(distinct);
    if is_binary {
        let meshes = distinct.parts().map(binary::mesh_bytes).sum::<u64>();
        return meshes + binary::BYTES_PER_NODE * nodes + binary::PLACEMENT_BYTES * placements + bound;
    }
    let meshes = distinct.parts().map(text_bytes).sum::<u64>();
    meshes + CURVE_BYTES_PER_NODE * nodes + PLACEMENT_BYTES * placements + bound
}

impl Exporter for Usdz {
    fn format(&self) -> &'static Format {
        &PACKAGE
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        if let Some(names) = binary_names(file)? {
            return Ok(names.recipe());
        }
        file.rewind()?;
        package::first(file, in_layer)
    }

    /// The layer is stored as it is.
    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        if let Some(names) = binary_names(file)? {
            return Ok(binary::traces(&PACKAGE, &names).with("layer", "binary"));
        }
        file.rewind()?;
        in_text(&PACKAGE, file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let is_ar = options.is_word("flavor", "ar");
        let mut stage = fit(stage, &PACKAGE, bundle);
        if is_ar && (stage.setting.take().is_some() || options.is_on("instances")) {
            bundle.note("usdz.flavor=ar: scene and instances are left out, which phones refuse");
        }
        note_asked(&stage, options, bundle);
        let mut writing = Writing::new(&stage, None, options, bundle, monitor)?;
        // The package is held whole: sizes and sums stand before the data.
        let is_binary = is_binary(options);
        let layer = layer_bytes(&writing, is_binary);
        let held = if is_binary { 3 * layer } else { layer };
        memory::admit(&stage, &writing.pictures, own_bytes(&writing.distinct) + held, monitor)?;
        let files = writing.pictures.iter().map(|named| named.suffix.trim_start_matches('_').to_owned());
        writing.name_files(files.collect());
        let pictures = pictures::compress(&writing.pictures)?;
        let files: usize = pictures.iter().map(|png| png.len()).sum();
        let mut package = Package::with_capacity(layer as usize + files);
        if is_binary {
            package.push("tree.usdc", &Layer::binary(monitor, |layer| write_layer(layer, &writing))?)?;
        } else {
            package.push_with("tree.usda", |bytes| {
                Sink::gather("the USD layer", bytes, monitor, |out| {
                    write_layer(&mut Layer::new(out), &writing)
                })
            })?;
        }
        for (file, png) in writing.files.iter().zip(pictures) {
            package.push(file, &png)?;
        }
        let bytes = package.finish()?;
        bundle.write_main(Some(bytes.len() as u64), monitor, |out| out.write(&bytes))
    }
}

/// The names in the binary layer that a package begins with; `None` where it begins with text.
fn binary_names(file: &mut dyn Readable) -> io::Result<Option<Names>> {
    match package::first(file, Names::read) {
        // Text that is shorter than a crate file's head.
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        read => read,
    }
}

fn is_binary(options: &Options) -> bool {
    options.is_word("layer", "binary")
}

/// Whether a package is for phones: such a one has no labels.
fn flavored(traces: Traces, format: &Format, has_labels: bool) -> Traces {
    if format.id == PACKAGE.id && !has_labels { traces.with("flavor", "ar") } else { traces }
}

fn in_text(format: &'static Format, file: &mut dyn Readable) -> io::Result<Traces> {
    if let Some(literal) = traces::behind(file, payload::TOLD_TRACE)? {
        let told = recipe::text(&literal).and_then(|literal| unquoted(&literal)).unwrap_or_default();
        return Ok(payload::traces(format, &told));
    }
    file.rewind()?;
    let seen = traces::beginnings(
        file,
        [
            "uniform token info:id = \"UsdUVTexture\"",
            materialx::TRACE,
            "def BasisCurves ",
            collision::PRIM_TRACE,
            plant::PROXY_TRACE,
            mesh::LIGHTMAP_TRACE,
            assembly::COVER_TRACE,
            plant::LABELS_TRACE,
            "def PointInstancer ",
            "def Camera ",
            "variantSet \"season\"",
            nanite::TRACE,
            ages::TRACE,
            assembly::LAST_TRACE,
        ],
    );
    let [
        pictures,
        materialx,
        skeleton,
        collision,
        proxy,
        lightmap,
        _,
        labels,
        instances,
        camera,
        seasons,
        is_nanite,
        ages,
        _,
    ] = seen?;
    let told = if camera { traces::behind(file, assembly::SETTING_TRACE)? } else { None };
    let text = told.as_deref().and_then(recipe::text).and_then(|literal| unquoted(&literal));
    let surroundings = text.map_or(Ok(Surroundings::default()), |text| Surroundings::parse(&text));
    let setting = surroundings.ok().filter(|_| camera);
    let traces = Traces::none(format)
        .with_switch("pictures", pictures)
        .with_switch("skeleton", skeleton)
        .with_switch("instances", instances)
        .with_switch("proxy", proxy)
        .with_switch(LIGHTMAP_UV.knob.name, lightmap);
    let traces = flavored(traces, format, labels);
    let shapes = if collision { traces::behind(file, collision::TOLD_TRACE)? } else { None };
    let shapes = shapes.as_deref().and_then(recipe::text).and_then(|literal| unquoted(&literal));
    let traces = match shapes.as_deref().and_then(|told| told.split_once(' ')) {
        Some((shapes, most)) => traces.with("collision", shapes).with("collision_most", most),
        None => traces,
    };
    let mesh_type = if is_nanite { traces::behind(file, nanite::TRACE)? } else { None };
    let mesh_type = mesh_type.as_deref().and_then(recipe::text).and_then(|literal| unquoted(&literal));
    let traces = nanite::traced(traces, mesh_type.as_deref());
    // Without leaves it does not show.
    let traces = traces.with_shown("materialx", materialx);
    Ok(Traces { setting, seasons: seasons || ages, ..traces })
}

/// The recipe of a layer: the root's stands before those of the trees below it.
fn in_layer(file: &mut dyn Readable) -> io::Result<Option<String>> {
    if !recipe::begins(file, b"#usda ")? {
        return Ok(None);
    }
    for line in recipe::lines(file) {
        let line = line?;
        if let Some(literal) = line.trim_ascii_start().strip_prefix(b"string recipe = ") {
            return Ok(recipe::text(literal).and_then(|literal| unquoted(&literal)));
        }
    }
    Ok(None)
}

/// What a node of the skeleton takes as text (measured).
const CURVE_BYTES_PER_NODE: u64 = 55;

/// What a copy's place takes as text, rather more than less.
const PLACEMENT_BYTES: u64 = 120;

/// Of wind, rather more than less: a vector of four numbers, one of three with the comma behind its index.
const WIND_BYTES: u64 = 46;
const OFFSET_BYTES: u64 = 40;
/// A joint and its weight.
const INFLUENCE_BYTES: u64 = 17;

/// What a mesh takes as text, rather more than less: a vertex was measured to take 85 bytes and a
/// triangle 9 and its three indices, of which each has the digits of the last one at most.
fn text_bytes(piece: &MeshPart<'_>) -> u64 {
    let mesh = &piece.mesh;
    let (vertices, triangles) = (mesh.positions.len() as u64, mesh.triangles.len() as u64);
    let digits = u64::from(vertices.max(1).ilog10()) + 1;
    let moved = piece.wind.map_or(0, |wind| {
        if wind.bones.is_some() {
            return INFLUENCE_BYTES * bones::influences(&wind.bindings) as u64 * vertices;
        }
        let offsets = wind.targets.iter().flat_map(|target| &target.offsets);
        let moved = offsets.filter(|offset| **offset != Vec3::ZERO).count() as u64;
        2 * WIND_BYTES * vertices + (OFFSET_BYTES + digits) * moved
    });
    // An index for each corner, with what stands between two.
    let corners = 3 * (digits + 2) * triangles;
    let second = piece.lightmap.as_ref().map_or(0, |set| 28 * set.len() as u64 + corners);
    4096 + 92 * vertices + (9 + 3 * digits) * triangles + corners + moved + second
}

/// What writing takes: of one mesh after the other, its texture coordinates each once (a table of
/// indices, at most half full, the values, an index a vertex).
fn own_bytes(distinct: &DistinctMeshes<'_>) -> u64 {
    let indexed = |mesh: &Mesh| {
        let table = bytes_of::<u32>((2 * mesh.positions.len()).next_power_of_two());
        // Which vertices a target moves, in a list that grows.
        table + memory::per_vertex::<([f32; 2], u32)>(mesh).max(bytes_grown::<u32>(mesh.positions.len()))
    };
    let turns = |plant: usize| {
        let pieces: Vec<&MeshPart<'_>> =
            distinct.models_of(plant).iter().flat_map(|model| &model.parts).collect();
        let frames = |bones: &Bones| bones.joints.len() as u64 * u64::from(bones.sway.frames() + 1);
        bones::of(&pieces).map_or(0, frames)
    };
    memory::largest(distinct, indexed)
        + lightmap::held_bytes(distinct)
        + memory::formatting(distinct)
        + 2 * instances::bytes(distinct)
        + 2 * nanite::bytes(distinct)
        + bones::TURN_BYTES * (0..distinct.plants()).map(turns).max().unwrap_or(0)
}

fn write_layer(layer: &mut Layer<'_, '_>, writing: &Writing<'_>) -> Result<(), ExportError> {
    let stage = writing.stage;
    let root = identifier(&stage.name);
    open_layer(layer, writing, &root)?;
    if !stage.is_single() || stage.setting.is_some() {
        return assembly::write(layer, writing, &root);
    }
    let component = Component::new(writing, 0, format!("/{root}"));
    head(writing, &root, &component).open(layer)?;
    component.write(layer)?;
    layer.close()
}

/// The head of a plant that is all there is.
fn head<'a>(writing: &'a Writing<'_>, prim: &'a str, component: &Component<'_>) -> Head<'a> {
    Head {
        prim,
        name: &writing.stage.name,
        recipe: &writing.stage.recipe,
        // Unreal makes one mesh of all within a component.
        kind: if writing.nanite.is_some() { "group" } else { "component" },
        nanite: writing.nanite,
        variants: component.variants(),
        bounds: component.bounds(),
        is_labelled: writing.said.labels,
        foot_in_file: recipe::foot_in_file(writing.stage),
    }
}

/// What stands before the first prim.
fn open_layer(layer: &mut Layer<'_, '_>, writing: &Writing<'_>, root: &str) -> Result<(), ExportError> {
    let generator = quoted(GENERATOR);
    let pieces: Vec<_> = writing.distinct.parts().collect();
    let time = wind::sway(&pieces).map_or_else(String::new, |sway| wind::time(sway.into()));
    layer.lines(&format!(
        r#"#usda 1.0
(
    defaultPrim = "{root}"
    doc = {generator}
{time}    metersPerUnit = 1
    upAxis = "Y"
)
"#
    ))?;
    layer.lines("\n")
}
