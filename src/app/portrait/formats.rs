//! Pictures as formats of the export dialog.

use std::io;

use linden::Monitor;
use linden::knob::{Kind, Knob, Value, integer, names, real, real_or_auto};
use linden::monitor::Holding;
use linden::scene::Scene;
use linden::stage::Stage;
use linden_exporters::writing::fit;
use linden_exporters::{
    Bundle, Encoding, ExportError, Exporter, Format, Holds, LooksIn, OptionSpec, Options, Readable, recipe_in,
};
use linden_raster::{Background, Camera, MAX_SIDE, Paint, RasterError, Size, Style};

use super::{FILE_SIZE, PITCH_DEG, Portrait, admit, file_style, format_of, on_background, write_picture};

/// A picture of pixels.
pub static PNG: &dyn Exporter = &Png;
/// A flat drawing.
pub static SVG: &dyn Exporter = &Svg;

struct Png;
struct Svg;

pub(super) const SIDE: Kind = integer(1, MAX_SIDE as u64);
/// The endings of pictures, that of the usual format first.
pub(super) const PICTURES: &[&str] = &["png", "jpg", "jpeg", "webp"];

const PAINTS: [&str; Paint::ALL.len()] = names(&Paint::ALL);

const WIDTH: OptionSpec = OptionSpec::new(Knob::new("width", SIDE, "px", "pixels in a row"), "800");
const HEIGHT: OptionSpec = OptionSpec::new(Knob::new("height", SIDE, "px", "rows of pixels"), "1000");
const YAW: OptionSpec = OptionSpec::new(
    Knob::new(
        "yaw",
        real_or_auto(-360.0, 360.0),
        "°",
        "turn round the tree; auto: 30, or the broad side of a flat tree",
    ),
    "auto",
);
const PITCH: OptionSpec = OptionSpec::new(Knob::new("pitch", real(-90.0, 90.0), "°", "look from above"), "8");
pub(super) const ZOOM: OptionSpec =
    OptionSpec::new(Knob::new("zoom", real(0.01, 1000.0), "", "closer (above 1) or farther (below 1)"), "1");
const BACKGROUND: OptionSpec = OptionSpec::choice(
    "background",
    &["auto", "studio", "transparent"],
    "auto: paper below a flat drawing, else the studio",
);
const PERSON: OptionSpec =
    OptionSpec::switch("person", false, "a person of 1.75 m beside the tree; tiny plants have none");

static PNG_FORMAT: Format = Format {
    id: "png",
    name: "Picture (PNG, JPEG, WebP)",
    extensions: PICTURES,
    media_type: "image/png",
    self_contained: true,
    help: "a picture of the tree, as 'linden preview' draws it; a name in .jpg or .webp has that format",
    options: &[
        OptionSpec::choice(
            "look",
            &["surface", "skeleton", "turtle"],
            "the surface as it is exported, the skeleton's strokes, or a flat drawing",
        ),
        OptionSpec::choice("color", &PAINTS, "what colour tells of a skeleton"),
        WIDTH,
        HEIGHT,
        YAW,
        PITCH,
        ZOOM,
        BACKGROUND,
        PERSON,
    ],
    holds: Holds { levels: LooksIn::Nothing, ..Holds::MESH },
    levels_by: None,
    encoding: |_| Encoding::Packed,
    estimate: None,
};

static SVG_FORMAT: Format = Format {
    id: "svg",
    name: "Flat drawing (SVG)",
    extensions: &["svg"],
    media_type: "image/svg+xml",
    self_contained: true,
    help: "a flat drawing as in a book, in strokes that scale; carries the recipe",
    options: &[WIDTH, HEIGHT, YAW, PITCH, ZOOM, BACKGROUND, PERSON],
    holds: Holds::ORGANS,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: None,
};

impl Exporter for Png {
    fn format(&self) -> &'static Format {
        &PNG_FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe_in(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &PNG_FORMAT, bundle);
        let scene = only_tree(stage, &PNG_FORMAT)?;
        let is_flat = options.is_word("look", "turtle");
        let shows_surface = options.is_word("look", "surface");
        let paint = paint(options);
        if paint != Paint::Wood && !options.is_word("look", "skeleton") {
            bundle.note("png.color changes nothing: it is for png.look=skeleton");
        }
        let portrait = Portrait { scene: shows_surface.then_some(scene), is_flat, ..of_scene(scene) };
        let size = size(options)?;
        admit(format_of(bundle), size, scene.bytes(), monitor)?;
        let style = Style { paint, ..style(&portrait, options) };
        let holding = Holding::new(monitor, scene.bytes());
        let picture = portrait.draw(&camera(&portrait, options), &style, size, &holding).map_err(refused)?;
        write_picture(&picture, Some(&stage.recipe), bundle, monitor)
    }
}

impl Exporter for Svg {
    fn format(&self) -> &'static Format {
        &SVG_FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe_in(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &SVG_FORMAT, bundle);
        let scene = only_tree(stage, &SVG_FORMAT)?;
        let portrait = Portrait { is_flat: true, ..of_scene(scene) };
        let style = style(&portrait, options);
        let camera = camera(&portrait, options);
        let holding = Holding::new(monitor, scene.bytes());
        let svg = portrait.svg(&camera, &style, size(options)?, &stage.recipe, &holding).map_err(refused)?;
        bundle.write_main(Some(svg.len() as u64), monitor, |sink| sink.write(svg.as_bytes()))
    }
}

/// The tree on a stage that holds no other.
fn only_tree<'a>(stage: &Stage<'a>, format: &Format) -> Result<&'a Scene, ExportError> {
    let first = stage.finest().next().filter(|_| stage.is_single());
    first.map(|(_, scene)| scene).ok_or(ExportError::Holds {
        format: format.id,
        what: "several trees",
        advice: "draw each by itself, or a forest with 'linden preview'",
    })
}

/// A scene's skeleton with its organs.
fn of_scene(scene: &Scene) -> Portrait<'_> {
    Portrait {
        skeleton: &scene.skeleton,
        organs: scene.organs.as_grown(),
        leaf_colors: scene.organs.colors(),
        scene: None,
        is_flat: false,
        slice: None,
    }
}

pub(super) fn background(options: &Options) -> Option<Background> {
    if options.is_word("background", "studio") {
        Some(Style::studio().background)
    } else {
        options.is_word("background", "transparent").then_some(Background::Transparent)
    }
}

fn style<'a>(portrait: &Portrait<'a>, options: &Options) -> Style<'a> {
    let style = Style { person: options.is_on("person"), ..file_style(portrait.is_flat) };
    on_background(portrait.styled(style), background(options))
}

fn camera(portrait: &Portrait<'_>, options: &Options) -> Camera {
    let pitch = number(options, "pitch").unwrap_or(PITCH_DEG);
    portrait.camera(number(options, "yaw"), pitch, number(options, "zoom").unwrap_or(1.0))
}

fn size(options: &Options) -> Result<Size, ExportError> {
    let side = |name, usual| whole(options, name).unwrap_or(usual);
    Size::new(side("width", FILE_SIZE.0), side("height", FILE_SIZE.1)).map_err(refused)
}

/// A whole number among the options.
pub(super) fn whole(options: &Options, name: &str) -> Option<u32> {
    match options.value(name) {
        Some(Value::Integer(n)) => Some(u32::try_from(*n).unwrap_or(u32::MAX)),
        _ => None,
    }
}

pub(super) fn number(options: &Options, name: &str) -> Option<f32> {
    match options.value(name) {
        Some(Value::Real(x)) => Some(*x as f32),
        _ => None,
    }
}

fn paint(options: &Options) -> Paint {
    match options.value("color") {
        Some(Value::Word(word)) => Paint::named(word).unwrap_or_default(),
        _ => Paint::default(),
    }
}

fn refused(error: RasterError) -> ExportError {
    match error {
        RasterError::Cancelled(cancelled) => cancelled.into(),
        RasterError::Memory(over) => over.into(),
        other => broken(other),
    }
}

#[expect(clippy::needless_pass_by_value, reason = "an error is handed over")]
pub(super) fn broken(error: impl ToString) -> ExportError {
    ExportError::Scene { what: "the picture".to_owned(), problem: error.to_string() }
}
