//! `linden export`: grow a source and write it in one or more formats.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use linden::detail::levels;
use linden_exporters::{Bundle, Exporter, Options, REGISTRY, find, for_path};

use super::Growing;
use crate::exit::usage;
use crate::progress::Progress;
use crate::targets::{Batch, Output, default_name};

/// Grow a source and write it for 3D programs
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Export {
    #[command(flatten)]
    growing: Growing,

    /// Write this file, in the format of its ending; may be given several times; - is standard output
    #[arg(short, long, value_name = "PATH")]
    output: Vec<PathBuf>,

    /// Write these formats: one for all outputs, or one for each; without -o to SOURCE.ENDING
    #[arg(long, value_name = "FORMAT", value_delimiter = ',')]
    format: Vec<String>,

    #[command(flatten)]
    budget: super::Budget,

    /// So many levels of detail, the same tree with fewer triangles each time; the same as --set lods=N
    #[arg(long, value_name = "N")]
    lods: Option<u32>,

    /// Triangles of a level / triangles of the one before; the same as --set lod_ratio=X
    #[arg(long, value_name = "X")]
    lod_ratio: Option<f64>,

    /// A last level of crossed planes with pictures of the tree, two or as many as said; the same as
    /// --set billboard=N
    #[arg(long, value_name = "PLANES", num_args = 0..=1, default_missing_value = "2")]
    billboard: Option<u32>,

    /// Wind: a sway loop that viewers play, or the attributes at the vertices alone; the same as
    /// --set wind=WORD
    #[arg(long, value_name = "WORD", num_args = 0..=1, default_missing_value = "sway")]
    wind: Option<String>,
}

impl Export {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let (own, of_formats): (Vec<_>, Vec<_>) =
            self.growing.pairs()?.into_iter().partition(|(name, _)| !name.contains('.'));
        let flags = [
            ("lods", self.lods.map(|n| n.to_string())),
            ("lod_ratio", self.lod_ratio.map(|x| x.to_string())),
            ("billboard", self.billboard.map(|n| n.to_string())),
            ("wind", self.wind.clone()),
        ];
        let flags = flags.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let own: Vec<_> = own.into_iter().chain(self.budget.pair()).chain(flags).collect();
        let source = self.growing.resolve_with(&own, &progress)?;
        let outputs = self.outputs(&source.recipe.preset.id)?;
        check_formats(&of_formats, &outputs)?;
        let mut batch = Vec::new();
        for (exporter, path) in outputs {
            let mut options = Options::new(exporter.format());
            for (name, value) in &of_formats {
                if let Some((_, name)) = name.split_once('.').filter(|(id, _)| *id == exporter.format().id) {
                    options.set(name, value).map_err(usage)?;
                }
            }
            batch
                .extend(Output::new(exporter, options, path).in_levels(source.recipe.preset.detail.levels()));
        }
        // Every target is tried before anything grows.
        let mut batch = Batch::open(batch, source.files.clone(), |output| {
            if output.path == Path::new("-") {
                Ok(Bundle::stream("standard output", std::io::stdout()))
            } else {
                Bundle::create(&output.path)
            }
        })?;
        let streams = batch.streams();
        if streams > 1 {
            return Err(usage("only one output can be standard output: name files for the others"));
        }
        let grown = super::grown(&source, &progress)?;
        let levels = levels(&source.recipe, &grown, &progress).with_context(|| source.shown.clone())?;
        super::notes(&levels.notes, &progress);
        batch.write(&levels.stage(), &progress, |notes| super::notes(notes, &progress))?;
        let written = batch.commit()?;
        progress.clear();
        // The list of files is the result, unless a file itself is.
        let mut lines = String::new();
        for file in written {
            let size = indicatif::BinaryBytes(file.bytes);
            lines.push_str(&format!("{}  {size}\n", crate::source::show(&file.path)));
        }
        if streams == 0 { super::print(&lines) } else { Ok(()) }
    }

    /// Which format goes where.
    fn outputs(&self, id: &str) -> anyhow::Result<Vec<(&'static dyn Exporter, PathBuf)>> {
        let formats =
            self.format.iter().map(|id| find(id.trim())).collect::<Result<Vec<_>, _>>().map_err(usage)?;
        match (self.output.as_slice(), formats.as_slice()) {
            ([], []) => Err(usage(format!(
                "say where to write: linden export {0} -o {0}.glb; formats: {1}",
                crate::source::show(&self.growing.source),
                ids().join(", ")
            ))),
            ([], formats) => Ok(formats.iter().map(|&e| (e, default_name(id, e).into())).collect()),
            (paths, []) => paths
                .iter()
                .map(|path| {
                    if path == Path::new("-") {
                        return Err(usage(
                            "standard output has no ending: name its format, like --format obj",
                        ));
                    }
                    Ok((for_path(path).map_err(usage)?, path.clone()))
                })
                .collect(),
            (paths, [one]) => Ok(paths.iter().map(|path| (*one, path.clone())).collect()),
            (paths, formats) if paths.len() == formats.len() => {
                Ok(formats.iter().copied().zip(paths.iter().cloned()).collect())
            }
            (paths, formats) => Err(usage(format!(
                "{} formats for {} outputs: name one format for all outputs or one for each",
                formats.len(),
                paths.len()
            ))),
        }
    }
}

/// Each `FORMAT.OPTION` must belong to a format that is written.
fn check_formats(
    settings: &[(String, String)],
    outputs: &[(&'static dyn Exporter, PathBuf)],
) -> anyhow::Result<()> {
    for (name, _) in settings {
        let id = name.split_once('.').map_or("", |(id, _)| id);
        let exporter = find(id).map_err(usage)?;
        if outputs.iter().all(|(own, _)| own.format().id != exporter.format().id) {
            return Err(usage(format!("--set {name}: no output is written as {id}")));
        }
    }
    Ok(())
}

fn ids() -> Vec<&'static str> {
    REGISTRY.iter().map(|exporter| exporter.format().id).collect()
}

/// All formats with what they are good for and their options.
pub fn format_table() -> String {
    let mut text = String::new();
    for format in REGISTRY.iter().map(|exporter| exporter.format()) {
        text.push_str(&format!("  {:14}{}\n", format.id, format.help));
        for spec in format.options {
            let name = format!("{}.{}", format.id, spec.knob.name);
            text.push_str(&format!(
                "  {:14}  {name}={}: {} ({})\n",
                "", spec.default, spec.knob.help, spec.knob.kind
            ));
        }
    }
    text
}

fn after_help() -> String {
    format!(
        "Formats, and options of formats (--set FORMAT.OPTION=VALUE):\n{}\n\
         Files appear whole or not at all. Existing files are replaced.",
        format_table()
    )
}
