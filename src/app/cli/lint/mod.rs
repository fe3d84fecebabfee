//! `linden lint`: faults in models of trees, whoever made them.

mod files;
mod text;

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use linden::recipe::VERSION;
use linden_lint::{Asset, Config, PROFILES, RULES, ReadError, Report, Severity, lint};
use serde::Serialize;

pub use self::files::{read as read_file, whole as whole_of};

use self::files::Model;
use crate::exit::{sentence, usage};
use crate::paths::show;
use crate::progress::Progress;
use crate::source;

/// Look for faults in models of trees, whoever made them
///
/// Triangles and draw calls against a budget, levels of detail, geometry, normals, texture coordinates, pictures, alpha
/// modes, pivots, names, meshes for collisions. What a file cannot say is named as not looked at. In folders all models are
/// looked at, also in folders below; what holds no mesh, like points, is passed over.
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Lint {
    /// Models: GLB, glTF, OBJ, PLY, USD (text, binary, packages), or folders with such files. Files as `oak_LOD0.obj`,
    /// `oak_LOD1.obj` are levels of one
    #[arg(value_name = "PATH", required_unless_present = "rules")]
    files: Vec<PathBuf>,

    /// Rules and their limits: a TOML file
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,

    /// The budgets to begin with, before those of --config and --set
    #[arg(long, value_name = "NAME", add = super::complete::words(profiles))]
    profile: Option<String>,

    /// Turn a rule off or to info, warn or error, like uv-overlap=warn, or set a limit, like triangles.max=8000; may be
    /// given several times
    #[arg(long, short, value_name = "RULE[.LIMIT]=VALUE")]
    set: Vec<String>,

    /// Exit with 1 on warnings, too
    #[arg(long, value_enum, value_name = "WHAT")]
    deny: Option<Deny>,

    /// Explain all rules, as they are with this configuration, and look at nothing
    #[arg(long)]
    rules: bool,

    /// Machine-readable
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Deny {
    Warnings,
}

fn profiles() -> Vec<String> {
    PROFILES.iter().map(|profile| profile.id.to_owned()).collect()
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct LintReport<'a> {
    linden: &'static str,
    profile: &'static str,
    files: &'a [Report],
    failed: &'a [Failed],
    passed_over: &'a [Failed],
    errors: usize,
    warnings: usize,
}

/// A file that is no model, and why.
#[derive(Serialize)]
struct Failed {
    file: String,
    error: String,
}

impl Lint {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let config = self.configuration(&progress)?;
        if self.rules {
            progress.clear();
            return if self.json {
                super::print_json(&text::rules_json(&config))
            } else {
                super::print(&text::rules(&config))
            };
        }
        let found = files::find(&self.files, &progress)?;
        let mut failed: Vec<Failed> =
            found.failed.into_iter().map(|(file, error)| Failed { file, error }).collect();
        let (mut reports, mut passed_over) = (Vec::new(), Vec::new());
        for model in found.models {
            match read(&model, &progress) {
                Ok(asset) => reports.push(lint(&asset, &config)),
                Err(error) => {
                    linden::Monitor::check(&progress)?;
                    let is_bare = matches!(
                        error.downcast_ref(),
                        Some(ReadError::NoTriangles(_) | ReadError::Elsewhere { .. })
                    );
                    let list = if is_bare && model.is_by_the_way { &mut passed_over } else { &mut failed };
                    list.push(Failed { file: model.shown(), error: sentence(&error) });
                }
            }
        }
        let count = |severity| reports.iter().map(|report| report.count(severity)).sum::<usize>();
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warn));
        progress.clear();
        if self.json {
            let profile = config.profile();
            super::print_json(&LintReport {
                linden: VERSION,
                profile,
                files: &reports,
                failed: &failed,
                passed_over: &passed_over,
                errors,
                warnings,
            })?;
        } else {
            super::print(&text::table(&reports))?;
        }
        let without = |Failed { file, error }: &Failed| format!("{file}: passed over: {error}");
        super::notes(&passed_over.iter().map(without).collect::<Vec<_>>(), &progress);
        for Failed { file, error } in &failed {
            crate::exit::say(&format!("error: {file}: {error}"));
        }
        match (failed.len(), errors, warnings) {
            (0, 0, 0) => Ok(()),
            (0, 0, _) if self.deny.is_none() => Ok(()),
            (0, 0, _) => bail!("{}", text::count(warnings, "warning")),
            (0, _, _) => bail!("{}, {}", text::count(errors, "error"), text::count(warnings, "warning")),
            (unread, _, _) => {
                bail!("{} could not be looked at", text::count(unread, "file"))
            }
        }
    }

    fn configuration(&self, progress: &Progress) -> anyhow::Result<Config> {
        let mut config = match &self.config {
            None => Config::default(),
            Some(path) => {
                let shown = show(path);
                let content = source::open_file(path, progress)?;
                let bytes = content.bytes(progress).with_context(|| format!("reading {shown}"))?;
                let text = source::document(&bytes, &shown, progress)?;
                Config::parse(text).map_err(|error| usage(format!("{shown}: {error}")))?
            }
        };
        if let Some(profile) = &self.profile {
            config = config.with_profile(profile).map_err(usage)?;
        }
        for (name, value) in super::split_pairs(&self.set, "--set", "RULE=LEVEL or RULE.LIMIT=NUMBER")? {
            match name.split_once('.') {
                None => config.set_level(&name, &value).map_err(usage)?,
                Some((rule, limit)) => {
                    let number = value.parse().map_err(|_| {
                        usage(format!("--set {name}: '{}' is no number", linden::knob::excerpt(&value)))
                    })?;
                    config.set_limit(rule, limit, number).map_err(usage)?;
                }
            }
        }
        Ok(config)
    }
}

/// A file, or the files of all levels.
fn read(model: &Model, progress: &Progress) -> anyhow::Result<Asset> {
    let mut levels = Vec::new();
    for (number, path) in &model.files {
        let read = files::read(path, model.is_by_the_way, progress);
        levels.push((*number, read.with_context(|| format!("reading {}", show(path)))?));
    }
    let mut assets = levels;
    match (assets.len(), assets.pop()) {
        (1, Some((_, only))) => Ok(only),
        (_, last) => {
            assets.extend(last);
            Ok(Asset::join(&model.shown(), assets))
        }
    }
}

fn after_help() -> String {
    let mut text = "Rules ('linden lint --rules' explains them):\n".to_owned();
    for rule in RULES {
        text.push_str(&format!("  {:18}{:6}{}\n", rule.id, rule.severity.word(), rule.checks));
    }
    text.push_str("\nProfiles:\n");
    for profile in PROFILES {
        text.push_str(&format!("  {:18}{}\n", profile.id, profile.help));
    }
    text + "\nExit codes: 0 no errors, 1 errors (with --deny warnings also warnings), 2 wrong usage."
}
