//! `linden sheet`: a contact sheet of several trees.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::HumanCount;
use linden::knob::printable;
use linden::monitor::Holding;
use linden::picture::Picture;
use linden::preset::builtins;
use linden_raster::drawing::label::Label;
use linden_raster::{Background, Camera, Size, Style};

use super::placing::{PictureTarget, Placing};
use super::preview::{PreviewLook, PreviewSubject, size};
use crate::exit::usage;
use crate::forecast::{Outlook, announce};
use crate::progress::Progress;
use crate::source::{self, Source};
use crate::viewpoint::broad_side;

/// Draw several trees side by side on one picture
#[derive(Args)]
pub struct Sheet {
    /// Presets' ids or files, in the order of the sheet
    #[arg(value_name = "SOURCE", required_unless_present = "group", add = super::complete::sources())]
    sources: Vec<PathBuf>,

    /// All built-in presets of a group, like Plants; may be given several times
    #[arg(long, value_name = "GROUP", add = super::complete::groups())]
    group: Vec<String>,

    /// Write this picture in the format of its ending (.png, .jpg, .jpeg, .webp), or sheet.png into a directory;
    /// - is standard output, as PNG
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    placing: Placing,

    /// So many trees of each source, with its seed and those that follow
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,

    /// Each tree in all its levels of detail: so many, or the triangles of each, like 50000,15000,4000; when
    /// not said as its knobs have it, or 4
    #[arg(long, value_name = "N|LIST", num_args = 0..=1, default_missing_value = "")]
    lods: Option<String>,

    /// Turn a knob of every tree; may be given several times
    #[arg(long = "set", short, value_name = "KNOB=VALUE", add = super::complete::settings())]
    settings: Vec<String>,

    /// Give a constant of every tree's grammar ('#define') another value; may be given several times
    #[arg(long = "define", value_name = "NAME=VALUE", add = super::complete::constants())]
    defines: Vec<String>,

    /// Width x height of each tree, pixels
    #[arg(long, value_name = "WxH", default_value = "240x288", value_parser = size)]
    size: (u32, u32),

    /// Trees in a row; when not given, a sheet that is a little wider than high
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    columns: Option<u32>,

    /// The skeleton's strokes, the surface, or flat drawings; when not given, as 'linden preview' has it
    #[arg(long, value_enum)]
    look: Option<PreviewLook>,

    /// What stands below each tree: its name and what tells it from the others, or nothing
    #[arg(long, value_enum, default_value_t)]
    labels: Labels,
}

/// What stands below the trees of a sheet.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Labels {
    /// Its name, and its seed and level of detail where they differ
    #[default]
    Names,
    /// Nothing
    None,
}

impl Sheet {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let target = PictureTarget::open(&self.output, "sheet", &self.placing)?;
        let sources = self.sources()?;
        let mut settings = super::pairs(&self.settings)?;
        settings.extend(self.lods.as_deref().filter(|text| !text.is_empty()).map(super::lods));
        let mut trees = Vec::with_capacity(sources.len());
        for path in &sources {
            let mut source = source::resolve(path, &settings, &progress)?;
            super::define(&mut source, &self.defines)?;
            super::notes(&source.notes, &progress);
            super::notes(&super::idle(&source.recipe.preset, &settings), &progress);
            if self.lods.is_some() && source.recipe.preset.dressing.detail.levels() == 1 {
                source.recipe.preset.dressing.detail.lods = USUAL_LEVELS;
            }
            trees.push(source);
        }
        // A tree with fewer levels than another leaves the rest of its places empty.
        let levels =
            trees.iter().map(|source| source.recipe.preset.dressing.detail.levels()).max().unwrap_or(1);
        let levels = if self.lods.is_some() { levels as u64 } else { 1 };
        let count = u32::try_from(sources.len() as u64 * self.seeds * levels).unwrap_or(u32::MAX);
        let (width, height) = self.size;
        let columns = self.columns.unwrap_or_else(|| match levels {
            1 => columns(count, self.size),
            // A tree a row.
            levels => levels as u32,
        });
        let columns = columns.min(count);
        let rows = count.div_ceil(columns);
        let lines = match self.labels {
            Labels::None => 0,
            Labels::Names => 1 + u32::from(self.seeds > 1) + u32::from(self.lods.is_some()),
        };
        let capitals = capitals(width);
        let below = Label::rows(lines, capitals);
        let high = height.saturating_add(below);
        let whole = Size::new(columns.saturating_mul(width), rows.saturating_mul(high)).map_err(usage)?;
        let cell = Size::new(width, height).map_err(usage)?;

        let style = if self.look == Some(PreviewLook::Turtle) { Style::paper() } else { Style::studio() };
        let paper = paper(&style);

        target.admit(whole, 0, &progress)?;
        let holding = Holding::new(&progress, u64::from(whole.width()) * u64::from(whole.height()) * 4);
        let mut sheet = Mosaic::new(whole.width(), whole.height());
        let mut place = 0;
        let (mut seconds, mut announced) = (0.0, false);
        for mut source in trees {
            if let Some(outlook) = Outlook::of(&source.recipe, &progress).filter(|_| !announced) {
                let shows_surface = self.lods.is_some()
                    || PreviewSubject::shows_surface(&source, &outlook.sample.grown, self.look, None);
                let pixels = f64::from(width) * f64::from(height) * levels as f64;
                let each = outlook.picture_s(&source.recipe, pixels, shows_surface);
                // What is known so far, taken for all that follow.
                seconds += each * self.seeds as f64;
                let trees = f64::from(count) / levels as f64;
                let done = (f64::from(place) / levels as f64).max(1.0);
                let all = seconds * (trees / (done + self.seeds as f64 - 1.0)).max(1.0);
                announced = announce(all, &format!("{trees} trees, {} each", outlook.amount()));
            }
            let first = source.recipe.preset.seed;
            for step in 0..self.seeds {
                source.recipe.preset.seed = first.wrapping_add(step);
                let grown = super::grown_beside(&source, &holding, &progress)?;
                let sitters = if self.lods.is_some() {
                    PreviewSubject::of_levels(&source, &grown, &progress, &holding)?
                } else {
                    vec![PreviewSubject::new(&source, &grown, self.look, None, &progress, &holding)?]
                };
                let obstructions = linden::grow::obstructions(&source.recipe, &holding)
                    .with_context(|| source.shown.clone())?;
                let camera = Camera::orbit(broad_side(&grown.skeleton), PITCH_DEG);
                for ((level, at), sitter) in (place..).enumerate().zip(&sitters) {
                    let style = Style { obstructions: &obstructions, ..sitter.styled(style) };
                    let mut picture = sitter.draw(&camera, &style, cell, &holding)?;
                    if lines > 0 {
                        let lines = self.label(&source, level, sitter);
                        let label = Label { lines, height: capitals, color: style.ink };
                        picture = label.below(&picture, below, paper);
                    }
                    sheet.lay(&picture, at % columns * width, at / columns * high);
                }
                place += levels as u32;
            }
        }
        target.write(&sheet.finish(), None, &progress)
    }

    /// What stands below a tree: what it is, and what tells it from its neighbours.
    fn label(&self, source: &Source, level: usize, sitter: &PreviewSubject<'_>) -> Vec<String> {
        let preset = &source.recipe.preset;
        let mut lines = vec![printable(&preset.name)];
        if self.seeds > 1 {
            lines.push(format!("seed {}", preset.seed));
        }
        if self.lods.is_some() {
            lines.push(format!("level {level}, {} triangles", HumanCount(sitter.triangles())));
        }
        lines
    }

    /// What is asked for: groups first, then the sources.
    fn sources(&self) -> anyhow::Result<Vec<PathBuf>> {
        let mut sources = Vec::new();
        for group in &self.group {
            let before = sources.len();
            for builtin in builtins() {
                if builtin.heading()?.group.eq_ignore_ascii_case(group) {
                    sources.push(PathBuf::from(builtin.id));
                }
            }
            if sources.len() == before {
                let shown = linden::knob::printable(group);
                return Err(usage(format!(
                    "no built-in preset is of the group '{shown}': see 'linden list'"
                )));
            }
        }
        sources.extend(self.sources.iter().cloned());
        Ok(sources)
    }
}

/// Levels of detail of a tree that says nothing of them.
const USUAL_LEVELS: u32 = 4;

/// As `linden preview` looks from above.
pub(super) const PITCH_DEG: f32 = 8.0;

/// What labels stand on: the colour that pictures end with.
pub(super) fn paper(style: &Style<'_>) -> [u8; 3] {
    match style.background {
        Background::Plain(color) | Background::Gradient(_, color) => color,
        Background::Landscape(landscape) => landscape.ground,
        Background::Transparent => [255; 3],
    }
}

/// The height of a label's capitals below pictures of a width, pixels.
pub(super) fn capitals(width: u32) -> f32 {
    (width as f32 / 26.0).clamp(6.0, 24.0)
}

/// How many in a row give a sheet that is nearest to half as wide again as it is high.
pub(super) fn columns(count: u32, (width, height): (u32, u32)) -> u32 {
    let aspect = |columns: u32| {
        let rows = count.div_ceil(columns);
        f64::from(columns) * f64::from(width) / (f64::from(rows) * f64::from(height))
    };
    let off = |columns: &u32| (aspect(*columns) - 1.5).abs();
    (1..=count.max(1)).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1)
}

/// A picture that is put together from others; white where none lies.
pub(super) struct Mosaic {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Mosaic {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgba: vec![255; width as usize * height as usize * 4] }
    }

    /// Copies a picture that fits, its upper left corner at a column and a row.
    pub fn lay(&mut self, picture: &Picture, column: u32, row: u32) {
        let bytes = picture.width() as usize * 4;
        for (line, pixels) in picture.rgba().chunks_exact(bytes).enumerate() {
            let at = ((row as usize + line) * self.width as usize + column as usize) * 4;
            self.rgba[at..at + bytes].copy_from_slice(pixels);
        }
    }

    pub fn finish(self) -> Picture {
        Picture::new(self.width, self.height, self.rgba)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_are_a_little_wider_than_high() {
        assert_eq!(columns(1, (240, 288)), 1);
        // 7 x 240 by 4 x 288 is 1.46.
        assert_eq!(columns(28, (240, 288)), 7);
        assert_eq!(columns(6, (100, 100)), 3);
    }

    #[test]
    fn pictures_lie_where_they_were_laid() {
        let mut sheet = Mosaic::new(3, 2);
        sheet.lay(&Picture::new(1, 2, vec![1, 2, 3, 4, 5, 6, 7, 8]), 2, 0);
        let rgba = sheet.finish().rgba().to_vec();
        assert_eq!((&rgba[8..12], &rgba[20..24]), (&[1, 2, 3, 4][..], &[5, 6, 7, 8][..]));
        assert!(rgba[..8].iter().chain(&rgba[12..20]).all(|&byte| byte == 255));
    }
}
