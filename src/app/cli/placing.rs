//! Puts files into their places: shared by all commands that write any.

use std::path::{Path, PathBuf};

use clap::Args;
use linden_exporters::{Bundle, ExportError, MadeFolders, make_folders};

use crate::exit::{ReaderGone, usage};
use crate::progress::Progress;
use linden_exporters::plain_stem;

/// How files come into their places.
#[derive(Args)]
pub struct Placing {
    /// Make directories that are missing; they go again when nothing is written
    #[arg(long)]
    mkdir: bool,

    /// Do not wait until files are on the disk: faster for many of them, but a power cut soon afterwards
    /// can take them
    #[arg(long)]
    no_sync: bool,
}

impl Placing {
    /// Folders that are missing for these targets, made if that is asked for.
    pub fn folders<'p>(
        &self,
        targets: impl IntoIterator<Item = &'p Path>,
    ) -> anyhow::Result<Vec<MadeFolders>> {
        let targets = targets.into_iter().filter(|path| self.mkdir && !is_dash(path));
        targets.map(|path| make_folders(path).map_err(explained)).collect()
    }

    /// A bundle for a target; `-` is standard output.
    pub fn bundle(&self, target: &Path) -> Result<Bundle, ExportError> {
        let bundle = if is_dash(target) { Bundle::stdout() } else { Bundle::create(target)? };
        Ok(if self.no_sync { bundle.unsynced() } else { bundle })
    }
}

/// Whether a target is standard output.
pub fn is_dash(target: &Path) -> bool {
    target == Path::new("-")
}

/// Whether a target names a folder, for files that are named after what they hold.
pub fn is_folder(target: &Path) -> bool {
    let last = target.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|&byte| std::path::is_separator(byte.into())) || target.is_dir()
}

/// What an error means on a command line.
pub fn explained(error: ExportError) -> anyhow::Error {
    match error {
        ExportError::SameTarget { .. } => usage(error),
        ExportError::NoFolder { .. } => anyhow::anyhow!("{error}, or add --mkdir"),
        _ => error.into(),
    }
}

/// What an error of writing means where standard output is all that is written: its reader may stop.
pub fn as_sole_output(error: ExportError) -> anyhow::Error {
    match &error {
        ExportError::Io { source, .. } if source.kind() == std::io::ErrorKind::BrokenPipe => {
            ReaderGone.into()
        }
        _ => explained(error),
    }
}

/// What is said of a pipe without a reader.
pub fn waiting(pipe: &str) -> String {
    format!("{pipe} is a pipe that no program reads yet; waiting for one")
}

/// A PNG file that is to be, with its folders.
pub struct PngTarget {
    bundle: Bundle,
    is_stdout: bool,
    folders: Vec<MadeFolders>,
}

impl PngTarget {
    /// Tries the place. In a folder the file has the name of what it shows.
    pub fn open(target: &Path, name: &str, placing: &Placing) -> anyhow::Result<Self> {
        let path = if is_folder(target) {
            target.join(format!("{}.png", plain_stem(name)))
        } else {
            target.to_owned()
        };
        let is_png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        // Devices and pipes have fixed names; any other file would be lost to a typing mistake.
        let is_stream = path.metadata().is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
        if !is_png && !is_stream && !is_dash(&path) {
            return Err(usage(format!(
                "previews are PNG files: name it like {}.png",
                crate::paths::show(&path)
            )));
        }
        let folders = placing.folders([path.as_path()])?;
        let bundle = placing.bundle(&path).map_err(explained)?;
        Ok(Self { bundle, is_stdout: is_dash(&path), folders })
    }

    /// Writes the file and puts it in its place.
    pub fn write(self, png: &[u8], progress: &Progress) -> anyhow::Result<()> {
        let Self { mut bundle, is_stdout, folders } = self;
        if let Some(pipe) = bundle.unread_pipe() {
            super::notes(&[waiting(pipe)], progress);
        }
        let done = bundle.write_main(Some(png.len() as u64), progress, |sink| sink.write(png));
        done.map_err(if is_stdout { as_sole_output } else { explained })?;
        bundle.commit().map_err(explained)?;
        folders.into_iter().for_each(MadeFolders::keep);
        Ok(())
    }
}

/// Where a file goes that is called `name` in a folder.
pub fn in_folder(target: &Path, name: impl FnOnce() -> String) -> PathBuf {
    if is_folder(target) { target.join(name()) } else { target.to_owned() }
}
