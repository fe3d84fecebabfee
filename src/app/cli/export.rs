//! `linden export`: grow a source and write it in one or more formats.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use linden::dress::dress;
use linden_exporters::{
    Bundle, Exporter, Options, REGISTRY, commit_all, ensure_distinct, ensure_spared, find, for_path,
};

use super::Growing;
use crate::exit::usage;
use crate::progress::Progress;

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
}

/// One output: who writes it, with which options.
struct Job {
    exporter: &'static dyn Exporter,
    options: Options,
}

impl Export {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let (own, of_formats): (Vec<_>, Vec<_>) =
            self.growing.pairs()?.into_iter().partition(|(name, _)| !name.contains('.'));
        let source = self.growing.resolve_with(&own, &progress)?;
        let outputs = self.outputs(&source.recipe.preset.id)?;
        check_formats(&of_formats, &outputs)?;
        // Every target is tried before anything grows.
        let mut jobs = Vec::new();
        let mut bundles = Vec::new();
        for (exporter, path) in outputs {
            let mut options = Options::new(exporter.format());
            for (name, value) in &of_formats {
                if let Some((_, name)) = name.split_once('.').filter(|(id, _)| *id == exporter.format().id) {
                    options.set(name, value).map_err(usage)?;
                }
            }
            bundles.push(if path == Path::new("-") {
                Bundle::stream("standard output", std::io::stdout())
            } else {
                Bundle::create(&path)?
            });
            jobs.push(Job { exporter, options });
        }
        let streams = bundles.iter().filter(|bundle| !bundle.takes_side_files()).count();
        if streams > 1 {
            return Err(usage("only one output can be standard output: name files for the others"));
        }
        ensure_distinct(&bundles)?;
        ensure_spared(&bundles, &source.files)?;
        let grown = super::grown(&source, &progress)?;
        let scene = dress(&source.recipe, &grown, &progress).with_context(|| source.shown.clone())?;
        for (Job { exporter, options }, bundle) in jobs.iter().zip(&mut bundles) {
            exporter.write(&scene, options, bundle, &progress)?;
            super::notes(bundle.notes(), &progress);
        }
        ensure_spared(&bundles, &source.files)?;
        let written = commit_all(bundles)?;
        progress.clear();
        // The list of files is the result, unless a file itself is.
        let mut lines = String::new();
        // Formats may share a picture beside them.
        let mut listed = BTreeSet::new();
        for file in written.iter().filter(|file| listed.insert(&file.path)) {
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
            ([], formats) => Ok(formats.iter().map(|&e| (e, default_path(id, e))).collect()),
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

/// `fir.glb`, or `fir-skeleton.ply` where another format has the plain name.
fn default_path(id: &str, exporter: &dyn Exporter) -> PathBuf {
    let format = exporter.format();
    let stem: String =
        id.chars().map(|c| if std::path::is_separator(c) || c.is_control() { '-' } else { c }).collect();
    match format.extensions.first() {
        Some(ending) => PathBuf::from(format!("{stem}.{ending}")),
        // A second flavour of an ending: `ply-skeleton`.
        None => {
            let (ending, flavour) = format.id.split_once('-').unwrap_or((format.id, "flavour"));
            PathBuf::from(format!("{stem}-{flavour}.{ending}"))
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
