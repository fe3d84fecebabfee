//! `linden recipe`: the recipe out of a file that linden wrote.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use linden::input::{InputKind, sniff};

use crate::exit::usage;
use crate::progress::Progress;
use crate::source;

/// Print the recipe that a file of linden's carries
///
/// Every file that linden writes carries the recipe of its tree or forest: one line of JSON, which grows
/// the same again. Only a cylinder table without comments has none.
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
        Err(usage(format!(
            "{shown} carries no recipe: it is none of the main files that linden writes, or another program \
             has written it anew; 'linden show {shown} --json' has the recipe of what a source grows"
        )))
    }
}
