//! `linden cache`: the folder of drawn pictures.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand};
use indicatif::BinaryBytes;
use serde::Serialize;

use crate::cache::{self, Contents, FolderStore};
use crate::config::dirs::{Dirs, NO_CACHE};
use crate::exit::usage;
use crate::paths::show;

/// Show where drawn pictures are kept, and how many; or remove them
///
/// Pictures of bark, leaves and branch cards are kept from one run to the next, as they were drawn and compressed, so
/// that the next export takes half of the time. Files are the same with them and without. The oldest give way
/// where there are too many bytes ('cache' in config.toml, `LINDEN_CACHE`).
#[derive(Args)]
pub struct Cache {
    /// Machine-readable
    #[arg(long)]
    json: bool,

    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Subcommand)]
enum Action {
    /// Remove all kept pictures, and nothing else
    Clear,
}

/// The names and meanings of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Report {
    /// `null` where no folder is known.
    path: Option<String>,
    entries: u64,
    bytes: u64,
    /// At most so many; 0: nothing is kept.
    limit_bytes: u64,
}

impl Cache {
    pub fn run(self) -> anyhow::Result<()> {
        let folder = Dirs::of_environment().pictures();
        match self.action {
            Some(Action::Clear) if self.json => Err(usage(
                "--json is for 'linden cache'; 'linden cache clear' says nothing that a script needs",
            )),
            Some(Action::Clear) => clear(folder),
            None => self.report(folder.as_deref()),
        }
    }

    fn report(&self, folder: Option<&Path>) -> anyhow::Result<()> {
        let contents = match folder {
            Some(folder) => FolderStore::contents(folder)
                .with_context(|| format!("looking at the kept pictures in {}", show(folder)))?,
            None => Contents::default(),
        };
        let path = folder.map(show);
        let limit_bytes = cache::room();
        if self.json {
            let (entries, bytes) = (contents.entries, contents.bytes);
            return super::print_json(&Report { path, entries, bytes, limit_bytes });
        }
        let Some(path) = path else { return super::print(&format!("nothing is kept: {NO_CACHE}\n")) };
        let entries = indicatif::HumanCount(contents.entries);
        let what = if contents.entries == 1 { "entry" } else { "entries" };
        let limit = match limit_bytes {
            0 => "off: nothing is read or kept".to_owned(),
            bytes => format!("at most {}", BinaryBytes(bytes)),
        };
        super::print(&format!("{path}\n{entries} {what}, {}, {limit}\n", BinaryBytes(contents.bytes)))
    }
}

fn clear(folder: Option<PathBuf>) -> anyhow::Result<()> {
    let Some(folder) = folder else { return super::print(&format!("nothing is kept: {NO_CACHE}\n")) };
    let removed = FolderStore::clear(&folder)
        .with_context(|| format!("removing the kept pictures in {}", show(&folder)))?;
    let entries = indicatif::HumanCount(removed.entries);
    let what = if removed.entries == 1 { "entry" } else { "entries" };
    super::print(&format!("{entries} {what} removed, {}\n", BinaryBytes(removed.bytes)))
}
