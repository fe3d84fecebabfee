//! `linden recipe`: the recipe out of a file that linden wrote.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use linden::input::{InputKind, is_picture, sniff};

use crate::exit::usage;
use crate::progress::Progress;
use crate::source;

/// Print the recipe that a file of linden's carries
///
/// Every file that linden writes carries the recipe of its tree or forest: one line of JSON, which grows
/// the same again. Contact sheets, pictures that belong to a model and tables without comments have none.
#[derive(Args)]
pub struct Recipe {
    /// A file that linden wrote (a mesh, a scene, a table, a preview), or - for standard input
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

impl Recipe {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let shown = source::shown(&self.file);
        let reading = || format!("reading {shown}");
        let mut content = source::open(&self.file, &progress)?;
        if let Some(recipe) = content.recipe(&progress).with_context(reading)? {
            progress.clear();
            return super::print(&format!("{recipe}\n"));
        }
        let bytes = content.bytes(&progress).with_context(reading)?;
        progress.clear();
        // A recipe by itself, as this command gives it.
        if sniff(&bytes, "").is_ok_and(|kind| kind == InputKind::Recipe) {
            let text = source::document(&bytes, &shown, &progress)?;
            return super::print(&format!("{}\n", text.trim()));
        }
        // What is a source by itself grows by a recipe though it carries none.
        let is_source = sniff(&bytes, &self.file.to_string_lossy()).is_ok();
        Err(usage(if is_picture(&bytes) {
            format!(
                "{shown} carries no recipe: a picture of 'linden preview' does, a sheet and pictures that belong to a \
                 model do not, nor does what another program has written anew; 'linden show SOURCE --json' has the \
                 recipe of what was drawn, by the name of its source"
            )
        } else if is_source {
            format!(
                "{shown} carries no recipe: it is none of the main files that linden writes, or another program \
                 has written it anew; 'linden show {shown} --json' has the recipe of what it grows as a source"
            )
        } else {
            format!(
                "{shown} carries no recipe: it is none of the main files that linden writes, or another program \
                 has written it anew; name the main file of the export, or 'linden show SOURCE --json' has the \
                 recipe of a source"
            )
        }))
    }
}
