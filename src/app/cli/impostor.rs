//! `linden impostor`: a source from all around, as pictures that engines draw it from far away with.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use linden::detail::impostor::{Impostor as Drawn, ImpostorError, ImpostorView, impostor};
use linden::dress::dress;
use linden::knob::printable;
use linden::recipe::VERSION;
use serde::Serialize;

use super::GrowArgs;
use super::outputs::list;
use super::placing::{Placing, explained, is_dash, is_folder};
use crate::exit::usage;
use crate::forecast::Outlook;
use crate::paths::show;
use crate::progress::Progress;
use crate::source::Source;

/// The picture of colours, behind the name of the main file.
const COLOR: &str = "_color.png";
/// That of normals and depth.
const NORMAL_DEPTH: &str = "_normal_depth.png";

/// Draw a source from all around, for octahedral impostors
///
/// The plant is seen without perspective from a grid of directions, an octahedron that is unfolded onto a square; a shader
/// draws one rectangle that faces the viewer and mixes the views next to where it looks from (docs/impostors.md has one).
/// Three files: NAME.json with what the shader needs to know, `NAME_color.png` with alpha, `NAME_normal_depth.png` with normals
/// in the plant's axes and in alpha how near it is.
#[derive(Args)]
pub struct Impostor {
    #[command(flatten)]
    growing: GrowArgs,

    /// Write this file (.json), with the pictures beside it, or `SOURCE_impostor.json` into this directory
    #[arg(short, long, value_name = "PATH")]
    output: PathBuf,

    /// Views along a side of the pictures: 2 to 32
    #[arg(long, value_name = "N", default_value_t = 8)]
    frames: u32,

    /// Side of the pictures, pixels
    #[arg(long, value_name = "PX", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(16..=16384))]
    size: u32,

    /// From below too: for what hangs or flies; without, from the horizon up
    #[arg(long)]
    whole: bool,

    #[command(flatten)]
    placing: Placing,
}

/// What the main file says.
#[derive(Serialize)]
struct Described<'a> {
    generator: String,
    source: &'a str,
    seed: u64,
    /// Of each picture, rows from the top: `octahedron`, or `hemi-octahedron`, its upper half.
    mapping: &'static str,
    /// Views along a side.
    frames: u32,
    /// Side of a view, pixels.
    view_px: u32,
    up: &'static str,
    /// What all views look at, in the plant's coordinates.
    centre_m: [f32; 3],
    /// Half of what a view shows, to its edges.
    radius_m: f32,
    color: String,
    normal_depth: String,
}

impl Impostor {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let source = self.growing.resolve(&progress)?;
        let id = &source.recipe.preset.id;
        let output = if is_folder(&self.output) {
            self.output.join(format!("{}_impostor.json", linden_exporters::plain_stem(id)))
        } else {
            self.output.clone()
        };
        let is_json = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        if is_dash(&output) || !is_json {
            let shown = show(&output);
            return Err(usage(format!(
                "-o {shown}: an impostor is a .json with pictures beside it; name it like oak_impostor.json"
            )));
        }
        // All places are tried before anything grows.
        let folders = self.placing.folders([output.as_path()])?;
        let mut bundle = self.placing.bundle_beside(&output, &source.files).map_err(explained)?;
        let how = ImpostorView { frames: self.frames, size_px: self.size, is_whole: self.whole };
        if let Some(outlook) = Outlook::of(&source.recipe, &progress) {
            let views = f64::from(self.frames) * f64::from(self.frames);
            let pixels = f64::from(self.size) * f64::from(self.size);
            let seconds = outlook.impostor_s(&source.recipe, views, pixels);
            outlook.announce_with(seconds, &format!(", {views} views"));
        }
        let grown = super::grown_and_drawn(&source, &progress)?;
        let scene = dress(&source.recipe, &grown, &progress).with_context(|| source.shown.clone())?;
        drop(grown);
        let drawn = impostor(&scene, &how, &progress).map_err(|error| match error {
            ImpostorError::Frames { .. } => usage(format!("--frames, --size: {error}")),
            other => anyhow::Error::from(other).context(source.shown.clone()),
        })?;
        drop(scene);
        for (suffix, picture) in [(COLOR, &drawn.color), (NORMAL_DEPTH, &drawn.normal_depth)] {
            let png = picture.png().with_context(|| format!("packing {}", bundle.side_name(suffix)))?;
            let write = bundle.write_side(suffix, Some(png.len() as u64), &progress, |out| out.write(png));
            write.map_err(explained)?;
        }
        let text = described(&drawn, &source, &bundle)?;
        let write = bundle.write_main(Some(text.len() as u64), &progress, |out| out.write(text.as_bytes()));
        write.map_err(explained)?;
        let written = bundle.commit().map_err(explained)?;
        folders.into_iter().for_each(linden_exporters::MadeFolders::keep);
        progress.clear();
        list(&written)
    }
}

fn described(drawn: &Drawn, source: &Source, bundle: &linden_exporters::Bundle) -> anyhow::Result<String> {
    let described = Described {
        generator: format!("linden {VERSION}"),
        source: &printable(&source.recipe.preset.id),
        seed: source.recipe.preset.seed(),
        mapping: if drawn.is_whole { "octahedron" } else { "hemi-octahedron" },
        frames: drawn.frames,
        view_px: drawn.color.width() / drawn.frames,
        up: "+Y",
        centre_m: drawn.centre_m.to_array(),
        radius_m: drawn.radius_m,
        color: bundle.side_name(COLOR),
        normal_depth: bundle.side_name(NORMAL_DEPTH),
    };
    Ok(serde_json::to_string_pretty(&described)? + "\n")
}
