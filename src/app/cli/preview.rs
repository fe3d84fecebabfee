//! `linden preview`: a picture of the skeleton or the surface, in the terminal or as a file.

mod forest;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use linden::Skeleton;
use linden::grow::{Colonized, Obstruction};
use linden::picture::Picture;
use linden::recipe::Recipe;
use linden_raster::{Background, Camera, Paint, Size, Style};
use linden_terminal::graphics::encode;
use linden_terminal::probe::{Capabilities, Environment, Findings, Graphics, Overrides};
use linden_terminal::tty::takes_sequences;
use linden_terminal::{
    CellStyle, ColorDepth, Glyphs, Image, MAX_CELLS, Protocol, TerminalSize, Tty, draw_cells,
};
use ratatui::layout::Rect;

use super::outputs::list;
use super::placing::{PictureTarget, Placing, is_folder};
use super::{GrowArgs, workbench};
use crate::exit::usage;
use crate::forecast::Outlook;
use crate::portrait::{FILE_SIZE, PITCH_DEG, PreviewLook, Sitter, file_style, on_background};
use crate::progress::Progress;
use crate::source::Source;
use crate::source::forest::ForestFile;

/// Draw a source: in the terminal, or as a picture's file
#[derive(Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches that have nothing to do with each other")]
pub struct Preview {
    #[command(flatten)]
    growing: GrowArgs,

    #[command(flatten)]
    budget: super::Budget,

    /// Write a picture in the format of its ending (.png, .jpg, .jpeg, .webp, or .svg of a flat drawing), or
    /// SOURCE.png into a directory; - is standard output, as PNG
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    placing: Placing,

    /// Width x height: pixels of a file (800x1000 when not given), columns and rows of a terminal
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,

    /// Turn round the tree, degrees; when not given 30, or the broad side of a flat tree
    #[arg(long, allow_negative_numbers = true, value_parser = angle)]
    yaw: Option<f32>,

    /// Look from above, degrees; when not given 8, of a forest 22
    #[arg(long, allow_negative_numbers = true, value_parser = angle)]
    pitch: Option<f32>,

    /// Stand before it and look level, with eyes so high, metres (1.65 when not said): trunks stay upright, and
    /// a forest fills the picture
    #[arg(
        long,
        value_name = "M",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1.65",
        value_parser = eye,
        conflicts_with = "pitch"
    )]
    eye: Option<f32>,

    /// Fog: how much of the farthest place it hides, 0 to 1 (0.75 when not said)
    #[arg(long, value_name = "X", num_args = 0..=1, require_equals = true, default_missing_value = "0.75", value_parser = fog)]
    fog: Option<f32>,

    /// Closer (above 1) or farther (below 1)
    #[arg(long, default_value_t = 1.0, value_parser = zoom)]
    zoom: f32,

    /// The skeleton's strokes; the surface as it would be exported, which is usual for a plant whose leaves
    /// have pictures or whose bark is described; or a flat drawing as in a book, which is usual for .svg
    #[arg(long, alias = "style", value_enum)]
    look: Option<PreviewLook>,

    /// What colour tells of a skeleton: wood (when not given), order, radius, birth or light; of a scan also source
    /// (measured or guessed) and distance (from the points)
    #[arg(long, value_parser = paint)]
    color: Option<Paint>,

    /// 'studio', 'transparent' or #rrggbb; a terminal shows its own unless another is given
    #[arg(long, value_parser = background)]
    background: Option<Background>,

    /// Show this level of detail, the finest is 0: of --set lods=N, `lod_triangles=LIST` or billboard=PLANES
    #[arg(long, value_name = "N")]
    lod: Option<usize>,

    /// Show the points that were scanned, or the attraction points
    #[arg(long)]
    points: bool,

    /// Show a level cut at this height above the foot, from above, with the points of a scan this near to it
    /// (0.1 m when not said)
    #[arg(long, value_name = "M[,THICK]", value_parser = slice, conflicts_with_all = ["lod", "eye", "pitch", "outline", "person", "look", "fog", "alone"])]
    slice: Option<(f32, f32)>,

    /// Show the crown's outline
    #[arg(long)]
    outline: bool,

    /// Show the tree alone, without what stands in its way and what takes light from it
    #[arg(long)]
    alone: bool,

    /// Stand a person of 1.75 m beside the tree; tiny plants have none
    #[arg(long)]
    person: bool,

    #[command(flatten)]
    pub(super) terminal: workbench::TerminalLook,
}

impl Preview {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        if let (Some(flag), Some(_)) = (self.terminal.given(), &self.output) {
            return Err(usage(format!(
                "{flag} has no effect on a file: it says how a terminal shows pictures"
            )));
        }
        let overrides = self.terminal.overrides()?;
        if let Some(named) = self.growing.source.to_str()
            && let Some(file) = ForestFile::find(named, &progress)?
        {
            return self.forest(file, &overrides, &progress);
        }
        // A place that cannot be written to is found before anything grows.
        let open = |path: &Path, id: &str| PictureTarget::open_or_svg(path, id, &self.placing);
        let named = self.output.as_deref().filter(|path| !is_folder(path));
        let mut target = named.map(|path| open(path, "")).transpose()?;
        let pairs: Vec<_> = self.growing.pairs()?.into_iter().chain(self.budget.pair()).collect();
        let source = self.growing.resolve_with(&pairs, &progress)?;
        let is_svg = target.as_ref().is_some_and(PictureTarget::is_svg);
        let look = self.chosen_look(is_svg)?;
        if self.lod.is_some() && look.is_some_and(|look| look != PreviewLook::Surface) {
            return Err(usage(
                "--lod is a level of the surface: leave out --look, --color, --points and --outline, and .svg",
            ));
        }
        if let Some(folder) = self.output.as_deref().filter(|path| is_folder(path)) {
            target = Some(open(folder, &source.recipe.preset.id)?);
        }
        if let Some(target) = &target {
            target.spare(&source.files)?;
            let (width, height) = self.size.unwrap_or(FILE_SIZE);
            target.admit(Size::new(width, height).map_err(usage)?, 0, &progress)?;
        }
        self.announce(&source.recipe, look, target.is_some(), &progress);
        let grown = super::grown(&source, &progress)?;
        if let Some(why) = self.color.and_then(|paint| paint.hindrance(&grown.skeleton)) {
            super::notes(&[format!("--color changes nothing: {why}")], &progress);
        }
        let scan = grown.colonized.as_ref().and_then(|colonized| colonized.scan.as_ref());
        let shows_points = self.points || (self.slice.is_some() && scan.is_some());
        let points = grown.colonized.as_ref().filter(|_| shows_points).map(Colonized::seen);
        let outline = if self.outline {
            linden::grow::outline(&source.recipe, &progress).with_context(|| source.shown.clone())?
        } else {
            Vec::new()
        };
        let obstructions = self.obstructions(&source, &progress)?;
        let say = &mut |notes: &[String]| super::notes(notes, &progress);
        let sitter = Sitter::new(&source.recipe, &grown, look, self.lod, say, &progress);
        let sitter = sitter.with_context(|| source.shown.clone())?;
        let sitter = self.sliced(sitter, &grown.skeleton, &progress);
        let portrait = sitter.portrait();
        // A cut has no broad side.
        let yaw_deg = self.yaw.or(self.slice.map(|_| 0.0));
        let camera = portrait.camera(yaw_deg, self.pitch.unwrap_or(PITCH_DEG), self.zoom);
        let camera = Camera { eye_m: self.eye, ..camera };
        let styled = |style: Style<'static>| {
            let style = Style {
                paint: self.color.unwrap_or_default(),
                points: points.unwrap_or_default(),
                point_gaps_m: scan.map_or(&[], |scan| &scan.gaps_m),
                outline: &outline,
                obstructions: &obstructions,
                person: self.person,
                haze_amount: self.fog.unwrap_or(style.haze_amount),
                ..sitter.styled(style)
            };
            on_background(style, self.background)
        };
        let draw = |style: Style<'static>, (width, height): (u32, u32)| -> anyhow::Result<Picture> {
            let size = Size::new(width, height).map_err(usage)?;
            sitter.draw(&camera, &styled(style), size, &progress).with_context(|| source.shown.clone())
        };
        let Some(target) = target else { return self.show(&overrides, &progress, draw) };
        let style = file_style(look == Some(PreviewLook::Turtle) || self.slice.is_some());
        if is_svg {
            let (width, height) = self.size.unwrap_or(FILE_SIZE);
            let size = Size::new(width, height).map_err(usage)?;
            let recipe = source.recipe.to_line_of(grown.hash());
            let svg = portrait.svg(&camera, &styled(style), size, &recipe, &progress);
            let svg = svg.with_context(|| source.shown.clone())?;
            return list(&target.write_svg(&svg, &progress)?);
        }
        let picture = draw(style, self.size.unwrap_or(FILE_SIZE))?;
        target.admit(Size::new(picture.width(), picture.height())?, sitter.bytes(), &progress)?;
        list(&target.write(&picture, Some(&source.recipe.to_line_of(grown.hash())), &progress)?)
    }
}

impl Preview {
    /// Says how long it will take, where that is long.
    fn announce(&self, recipe: &Recipe, look: Option<PreviewLook>, is_file: bool, progress: &Progress) {
        let Some(outlook) = Outlook::of(recipe, progress) else { return };
        let (width, height) = self.size.filter(|_| is_file).unwrap_or(FILE_SIZE);
        let pixels = f64::from(width) * f64::from(height);
        let shows_surface = Sitter::shows_surface(recipe, &outlook.sample.grown, look, self.lod);
        outlook.announce(outlook.picture_s(recipe, pixels, shows_surface));
    }

    /// What stands in the tree's way and what takes light from it, unless the tree is to be alone.
    fn obstructions(&self, source: &Source, progress: &Progress) -> anyhow::Result<Vec<Obstruction>> {
        if !self.alone {
            return linden::grow::obstructions(&source.recipe, progress)
                .with_context(|| source.shown.clone());
        }
        if !source.recipe.preset.has_obstructions() {
            super::notes(&["--alone changes nothing: nothing stands beside this tree".into()], progress);
        }
        Ok(Vec::new())
    }

    /// A tree that is drawn, cut where that was asked for; says so where there is nothing to cut.
    fn sliced<'a>(&self, sitter: Sitter<'a>, skeleton: &Skeleton, progress: &Progress) -> Sitter<'a> {
        let Some((height_m, thickness_m)) = self.slice else { return sitter };
        let sitter = sitter.cut(height_m, thickness_m);
        if sitter.portrait().slice.is_some_and(|slice| slice.cuts(skeleton).is_empty()) {
            super::notes(&["--slice: no wood is cut there".into()], progress);
        }
        sitter
    }

    /// Shows a picture in the terminal, as pixels or as characters.
    fn show(
        &self,
        overrides: &Overrides,
        progress: &Progress,
        draw: impl Fn(Style<'static>, (u32, u32)) -> anyhow::Result<Picture>,
    ) -> anyhow::Result<()> {
        let terminal = TerminalSize::of_stdout();
        // The last row is for the prompt.
        let (columns, rows) =
            self.size.unwrap_or((terminal.columns.into(), terminal.rows.saturating_sub(1).into()));
        let (columns, rows) = (cells(columns)?, cells(rows)?);
        let (protocol, style) = in_terminal(overrides);
        if let Some(protocol) = protocol {
            let area = Rect::new(0, 0, columns, rows);
            let (wide, high) = Tty::open().ok().and_then(|tty| tty.size().cell_px()).unwrap_or((10, 20));
            let size = (u32::from(columns) * u32::from(wide), u32::from(rows) * u32::from(high));
            let picture = draw(Style::over_dark(), size)?;
            let encoded = encode(protocol, picture.rgba(), size, area, usize::MAX)?;
            progress.clear();
            return super::print_bytes(&encoded.at_cursor(KITTY_IDS + std::process::id(), area));
        }
        let picture = draw(
            Style::over_dark(),
            linden_terminal::cells::square_pixels(columns, rows, terminal.cell_aspect),
        )?;
        let image = Image::new(picture.width(), picture.height(), picture.rgba())?;
        progress.clear();
        super::print(&draw_cells(&image, columns, rows, &style))
    }

    /// Colours that tell something are those of a skeleton; so are points and outlines inside a crown. An SVG
    /// is a flat drawing.
    fn chosen_look(&self, is_svg: bool) -> anyhow::Result<Option<PreviewLook>> {
        if is_svg {
            return match self.look {
                None | Some(PreviewLook::Turtle) => Ok(Some(PreviewLook::Turtle)),
                Some(_) => Err(usage("an SVG is a flat drawing: leave --look out, or say --look turtle")),
            };
        }
        let of_skeleton = self.color.is_some() || self.points || self.outline || self.slice.is_some();
        Ok(self.look.or(of_skeleton.then_some(PreviewLook::Skeleton)))
    }
}

/// The pictures of the workbench have smaller numbers.
const KITTY_IDS: u32 = 10_000;

/// How the terminal is shown pictures: in a protocol for pixels, or as characters. What the flags leave
/// open, the environment may say, and else what is certain of any terminal.
fn in_terminal(flags: &Overrides) -> (Option<Protocol>, CellStyle) {
    let is_terminal = std::io::stdout().is_terminal() && takes_sequences();
    let environment = Environment::of_process();
    // What is wrong there is said by the workbench and by 'linden doctor'.
    let said = Overrides::from_environment(&environment).unwrap_or_default();
    let overrides = flags.clone().or(if is_terminal { said } else { Overrides::default() });
    let colors = overrides
        .colors()
        .unwrap_or_else(|| ColorDepth::detect(|name| std::env::var(name).ok(), is_terminal));
    let (graphics, glyphs) = overrides.graphics().unwrap_or((Graphics::Cells, None));
    let known = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
    let usual = match colors {
        _ if !known.unicode.value => Glyphs::Ascii,
        ColorDepth::None => Glyphs::Braille,
        _ => Glyphs::Quadrants,
    };
    let style = CellStyle { glyphs: glyphs.unwrap_or(usual), colors, ..CellStyle::default() };
    let protocol = match graphics {
        Graphics::Kitty => Some(Protocol::Kitty),
        Graphics::Sixel => Some(Protocol::Sixel),
        Graphics::Iterm2 => Some(Protocol::Iterm2),
        Graphics::Cells => None,
    };
    (protocol, style)
}

fn cells(n: u32) -> anyhow::Result<u16> {
    u16::try_from(n.max(1))
        .ok()
        .filter(|&n| n <= MAX_CELLS)
        .ok_or_else(|| usage(format!("{n} is too many cells: at most {MAX_CELLS}")))
}

pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let pair = text
        .split_once(['x', '×', ','])
        .and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
    pair.ok_or_else(|| "expected WIDTHxHEIGHT, like 800x1000".to_owned())
}

fn angle(text: &str) -> Result<f32, String> {
    finite(text).ok_or_else(|| "expected degrees, like 30".to_owned())
}

fn zoom(text: &str) -> Result<f32, String> {
    finite(text)
        .filter(|z| (0.01..=1000.0).contains(z))
        .ok_or_else(|| "expected a number from 0.01 to 1000".to_owned())
}

fn slice(text: &str) -> Result<(f32, f32), String> {
    let (height, thickness) = text.split_once(',').unwrap_or((text, "0.1"));
    let pair = (finite(height.trim()), finite(thickness.trim()));
    match pair {
        (Some(height_m), Some(thickness_m)) if height_m >= 0.0 && thickness_m > 0.0 => {
            Ok((height_m, thickness_m))
        }
        _ => Err("expected metres above the foot, like 1.3, or with a thickness, like 1.3,0.05".to_owned()),
    }
}

fn eye(text: &str) -> Result<f32, String> {
    finite(text)
        .filter(|m| (0.01..=1000.0).contains(m))
        .ok_or_else(|| "expected metres from 0.01 to 1000, like 1.65".to_owned())
}

fn fog(text: &str) -> Result<f32, String> {
    finite(text)
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| "expected a share from 0 to 1, like 0.75".to_owned())
}

fn finite(text: &str) -> Option<f32> {
    text.parse().ok().filter(|x: &f32| x.is_finite())
}

fn paint(text: &str) -> Result<Paint, String> {
    Paint::named(text).ok_or_else(|| {
        let known: Vec<String> =
            Paint::ALL.iter().map(|(name, _, help)| format!("{name} ({help})")).collect();
        format!("expected one of: {}", known.join(", "))
    })
}

fn background(text: &str) -> Result<Background, String> {
    use linden::knob::{Kind, Value};
    match text {
        "transparent" => Ok(Background::Transparent),
        "studio" => Ok(Style::studio().background),
        _ => match (Kind::Color { auto: false }).parse(text) {
            Ok(Value::Color(color)) => Ok(Background::Plain(color)),
            _ => Err("expected 'studio', 'transparent' or a colour #rrggbb".to_owned()),
        },
    }
}
