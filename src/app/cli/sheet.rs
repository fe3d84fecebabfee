//! `linden sheet`: a contact sheet of several trees.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, ValueEnum};
use linden::grow::grow;
use linden::monitor::{Holding, Monitor as _};
use linden::preset::builtins;
use linden_raster::{Extent, Style};

use super::ages::aged;
use super::outputs::list;
use super::placing::{PictureTarget, Placing};
use super::preview::size;
use crate::exit::usage;
use crate::forecast::{Outlook, announce};
use crate::portrait::sheet::{SheetDrawing, SheetPlan, in_levels};
use crate::portrait::{PreviewLook, Sitter};
use crate::progress::Progress;
use crate::source::{self, Source};

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

    /// The root of all random choices of each source's first tree, from which --seeds counts on; the same as --set seed=N
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = super::whole)]
    seed: Option<u64>,

    /// So many trees of each source, with its seed and those that follow
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,

    /// Each tree in all its levels of detail: so many, or the triangles of each, like 50000,15000,4000; when
    /// not said as its knobs have it, or 4
    #[arg(long, value_name = "N|LIST", num_args = 0..=1, default_missing_value = "")]
    lods: Option<String>,

    /// Each tree at several ages, a row each where no number of columns is given: names that the source has for them ('linden
    /// show'), names with a share of its growth like half=0.5, or years like 10y where it grows by them; all that it
    /// names when none is given
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "all", conflicts_with = "lods")]
    ages: Option<String>,

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

    /// All trees in one scale, as high beside each other as they are; without, each fills its picture. Each grows twice, first
    /// to be measured
    #[arg(long)]
    one_scale: bool,

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
        settings.extend(self.seed.map(super::seeded));
        settings.extend(self.lods.as_deref().filter(|text| !text.is_empty()).map(super::lods));
        let (mut trees, mut columns) = (Vec::with_capacity(sources.len()), self.columns);
        for path in &sources {
            let mut source = source::resolve(path, &settings, &progress)?;
            super::define(&mut source, &self.defines)?;
            target.spare(&source.files)?;
            super::notes(&source.notes, &progress);
            super::notes(&super::idle(&source.recipe.preset, &settings), &progress);
            if self.lods.is_some() {
                in_levels(&mut source.recipe);
            }
            let Some(list) = &self.ages else {
                trees.push(source);
                continue;
            };
            let ages = aged(&source, list, &settings).with_context(|| source.shown.clone())?;
            columns = columns.or(u32::try_from(ages.len()).ok());
            for (age, mut source) in ages {
                source.recipe.preset.name =
                    format!("{}, {}", source.recipe.preset.name, age.replace('_', " "));
                trees.push(source);
            }
        }
        // A tree with fewer levels than another leaves the rest of its places empty.
        let levels =
            trees.iter().map(|source| source.recipe.preset.dressing.detail.levels()).max().unwrap_or(1);
        let plan = SheetPlan {
            seeds: self.seeds,
            lods: self.lods.is_some(),
            size: self.size,
            columns,
            look: self.look,
            names: self.labels == Labels::Names,
        };
        let (width, height) = self.size;
        let mut sheet = SheetDrawing::new(plan, trees.len(), levels)?;
        if self.one_scale {
            sheet = sheet.in_one_scale(&self.extents(&trees, &progress)?);
        }
        let (levels, count) = (sheet.levels(), sheet.count());
        target.admit(sheet.size(), 0, &progress)?;
        let holding = Holding::new(&progress, sheet.bytes());
        let (mut seconds, mut announced) = (0.0, false);
        let (mut number, of_all) = (0, trees.len() * self.seeds as usize);
        for mut source in trees {
            if let Some(outlook) = Outlook::of(&source.recipe, &progress).filter(|_| !announced) {
                let shows_surface = self.lods.is_some()
                    || Sitter::shows_surface(&source.recipe, &outlook.sample.grown, self.look, None);
                let pixels = f64::from(width) * f64::from(height) * levels as f64;
                let each = outlook.picture_s(&source.recipe, pixels, shows_surface);
                // What is known so far, taken for all that follow.
                seconds += each * self.seeds as f64;
                let trees = f64::from(count) / levels as f64;
                let done = (f64::from(sheet.drawn()) / levels as f64).max(1.0);
                let all = seconds * (trees / (done + self.seeds as f64 - 1.0)).max(1.0);
                announced = announce(all, &format!("{trees} trees, {} each", outlook.amount()));
            }
            let first = source.recipe.preset.seed();
            for step in 0..self.seeds {
                number += 1;
                progress.among("tree", number, of_all);
                source.recipe.preset.set_seed(first.wrapping_add(step));
                let grown = super::grown_beside(&source, &holding, &progress)?;
                let say = &mut |notes: &[String]| super::notes(notes, &progress);
                sheet.lay(&source.recipe, &grown, say, &holding).with_context(|| source.shown.clone())?;
            }
        }
        list(&target.write(&sheet.finish(), None, &progress)?)
    }

    /// How far each tree reaches.
    fn extents(&self, trees: &[Source], progress: &Progress) -> anyhow::Result<Vec<Extent>> {
        let mut extents = Vec::new();
        let of_all = trees.len() * self.seeds as usize;
        for source in trees {
            let mut recipe = source.recipe.clone();
            let first = recipe.preset.seed();
            for step in 0..self.seeds {
                progress.among("measuring tree", extents.len() + 1, of_all);
                recipe.preset.set_seed(first.wrapping_add(step));
                let grown = grow(&recipe, progress).with_context(|| source.shown.clone())?;
                let style = Style { organs: Some(&grown.organs), ..Style::studio() };
                extents.extend(style.extent(&grown.skeleton));
            }
        }
        Ok(extents)
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
