//! Pictures that need no stage, for they grow what they show: contact sheets, and forests from simpler trees. The
//! export dialog writes them, byte for byte as `linden sheet` and `linden preview` do.

use std::io;
use std::sync::Arc;

use linden::Monitor;
use linden::forest::Forest;
use linden::grow::grow;
use linden::knob::{Kind, Knob, integer, real};
use linden::monitor::Holding;
use linden::picture::Picture;
use linden::recipe::Recipe;
use linden::stage::Stage;
use linden_exporters::{
    Bundle, Encoding, ExportError, Exporter, Format, Holds, OptionSpec, Options, Output, Readable, recipe_in,
};
use linden_raster::{Background, Camera, RasterError, Size, Style, draw_stage};

use super::formats::{PICTURES, SIDE, ZOOM, background, number, whole};
use super::sheet::{SheetDrawing, SheetPlan, in_levels};
use super::sitter::PreviewLook;
use super::{admit, format_of, write_picture};
use crate::jobs::{FOREST_PITCH_DEG, FOREST_YAW_DEG, ShownForest};

/// Several trees of a preset side by side.
pub static SHEET: &dyn Exporter = &Apart(&SHEET_FORMAT);
/// A forest in pixels.
pub static FOREST_PNG: &dyn Exporter = &Apart(&FOREST_FORMAT);

/// Pixels of a forest's file by default.
pub const FOREST_SIZE: (u32, u32) = (1400, 900);
/// Pixels of a tree on a sheet by default.
const CELL: (u32, u32) = (240, 288);

/// A format that is written by [`write_apart`].
struct Apart(&'static Format);

static SHEET_FORMAT: Format = Format {
    id: "png-sheet",
    name: "Contact sheet",
    extensions: &[],
    media_type: "image/png",
    self_contained: true,
    help: "the tree with this and the next seeds side by side, as 'linden sheet' draws them",
    options: &[
        OptionSpec::new(
            Knob::new("seeds", integer(1, 1000), "", "trees, with this seed and those that follow"),
            "9",
        ),
        OptionSpec::new(
            Knob::new("columns", integer(0, 1000), "", "trees in a row; 0: a sheet a little wider than high"),
            "0",
        ),
        OptionSpec::new(Knob::new("width", SIDE, "px", "pixels in a row of a tree"), "240"),
        OptionSpec::new(Knob::new("height", SIDE, "px", "rows of pixels of a tree"), "288"),
        OptionSpec::choice(
            "look",
            &["auto", "skeleton", "surface", "turtle"],
            "auto: the surface of a plant whose leaves have pictures, else the skeleton",
        ),
        OptionSpec::switch("lods", false, "each tree in all its levels of detail, a row each"),
        OptionSpec::switch("labels", true, "its name below each tree, and what tells it from the others"),
    ],
    holds: Holds::MESH,
    levels_by: None,
    encoding: |_| Encoding::Packed,
    estimate: None,
};

static FOREST_FORMAT: Format = Format {
    id: "png",
    name: "Picture (PNG, JPEG, WebP)",
    extensions: PICTURES,
    media_type: "image/png",
    self_contained: true,
    help: "a picture of the forest, as 'linden preview' draws it; a name in .jpg or .webp has that format",
    options: &[
        OptionSpec::new(Knob::new("width", SIDE, "px", "pixels in a row"), "1400"),
        OptionSpec::new(Knob::new("height", SIDE, "px", "rows of pixels"), "900"),
        OptionSpec::new(Knob::new("yaw", ANGLE, "°", "turn round the forest"), "30"),
        OptionSpec::new(Knob::new("pitch", real(-90.0, 90.0), "°", "look from above"), "22"),
        ZOOM,
        OptionSpec::choice("background", &["auto", "studio", "transparent"], "auto: the studio"),
    ],
    holds: Holds::MESH,
    levels_by: None,
    encoding: |_| Encoding::Packed,
    estimate: None,
};

const ANGLE: Kind = real(-360.0, 360.0);

impl Exporter for Apart {
    fn format(&self) -> &'static Format {
        self.0
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe_in(file)
    }

    fn write(&self, _: &Stage<'_>, _: &Options, _: &mut Bundle, _: &dyn Monitor) -> Result<(), ExportError> {
        Err(ExportError::Holds {
            format: self.0.id,
            what: "a stage",
            advice: "it grows what it shows: 'linden sheet' and 'linden preview' draw it",
        })
    }
}

/// What a picture is drawn of.
pub enum Sitters<'a> {
    /// A tree.
    Tree(&'a Recipe),
    /// A forest.
    Forest(&'a Arc<Forest>),
}

/// Draws and writes an output that is one of these formats; whether it is one.
///
/// # Errors
/// Those of growing, drawing and writing.
pub fn write_apart(
    output: &Output,
    sitters: &Sitters<'_>,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> anyhow::Result<bool> {
    let format = output.exporter.format();
    match sitters {
        Sitters::Tree(recipe) if std::ptr::eq(format, &raw const SHEET_FORMAT) => {
            sheet(recipe, &output.options, bundle, monitor)?;
        }
        Sitters::Forest(forest) if std::ptr::eq(format, &raw const FOREST_FORMAT) => {
            forest_picture(forest, &output.options, bundle, monitor)?;
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// Whether a format is one of these.
pub fn is_apart(format: &Format) -> bool {
    [&raw const SHEET_FORMAT, &raw const FOREST_FORMAT].into_iter().any(|known| std::ptr::eq(format, known))
}

fn sheet(
    recipe: &Recipe,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> anyhow::Result<()> {
    let side = |name, usual| whole(options, name).unwrap_or(usual);
    let look = |word| options.is_word("look", word);
    let plan = SheetPlan {
        seeds: side("seeds", 1).into(),
        lods: options.is_on("lods"),
        size: (side("width", CELL.0), side("height", CELL.1)),
        columns: whole(options, "columns").filter(|&columns| columns > 0),
        look: [
            ("skeleton", PreviewLook::Skeleton),
            ("surface", PreviewLook::Surface),
            ("turtle", PreviewLook::Turtle),
        ]
        .into_iter()
        .find_map(|(word, meant)| look(word).then_some(meant)),
        names: options.is_on("labels"),
    };
    let mut recipe = recipe.clone();
    if plan.lods {
        in_levels(&mut recipe);
    }
    let mut drawing = SheetDrawing::new(plan, 1, recipe.preset.dressing.detail.levels())?;
    admit(format_of(bundle), drawing.size(), 0, monitor)?;
    let holding = Holding::new(monitor, drawing.bytes());
    let first = recipe.preset.seed();
    let mut said: Vec<String> = Vec::new();
    for step in 0..plan.seeds {
        recipe.preset.set_seed(first.wrapping_add(step));
        let grown = grow(&recipe, &holding)?;
        said.extend_from_slice(&grown.notes);
        let say = &mut |notes: &[String]| said.extend_from_slice(notes);
        drawing.lay(&recipe, &grown, say, &holding)?;
    }
    said.dedup();
    for note in said {
        bundle.note(note);
    }
    write_picture(&drawing.finish(), None, bundle, monitor)?;
    Ok(())
}

fn forest_picture(
    forest: &Arc<Forest>,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> anyhow::Result<()> {
    let side = |name, usual| whole(options, name).unwrap_or(usual);
    let size = Size::new(side("width", FOREST_SIZE.0), side("height", FOREST_SIZE.1))?;
    admit(format_of(bundle), size, 0, monitor)?;
    let shown = ShownForest::grow(forest, monitor)?;
    let camera = Camera {
        zoom: number(options, "zoom").unwrap_or(1.0),
        extent: shown.beside,
        ..Camera::orbit(
            number(options, "yaw").unwrap_or(FOREST_YAW_DEG),
            number(options, "pitch").unwrap_or(FOREST_PITCH_DEG),
        )
    };
    let style = Style { obstructions: &shown.obstructions, ..Style::studio() };
    let picture = draw_forest(&shown, &camera, style, background(options), size, monitor)?;
    admit(format_of(bundle), size, shown.grown.bytes(), monitor)?;
    write_picture(&picture, Some(&shown.forest.to_line()), bundle, monitor)?;
    Ok(())
}

/// Draws a forest that grew for pictures.
///
/// # Errors
/// Those of the drawing.
pub fn draw_forest(
    shown: &ShownForest,
    camera: &Camera,
    style: Style<'_>,
    background: Option<Background>,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    let style = super::on_background(style, background);
    draw_stage(&shown.grown.stage(), camera, &style, size, &Holding::new(monitor, shown.grown.bytes()))
}
