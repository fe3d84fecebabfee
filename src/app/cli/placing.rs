//! Puts files into their places: shared by all commands that write any.

use std::path::{Path, PathBuf};

use clap::Args;
use linden::Monitor;
use linden::memory::OverMemory;
use linden::picture::{Picture, PictureFormat};
use linden_exporters::{Bundle, ExportError, MadeFolders, Written, ensure_spared, make_folders, plain_stem};
use linden_raster::Size;

use crate::exit::{ReaderGone, usage};
use crate::portrait;
use crate::progress::Progress;

/// How files come into their places.
#[derive(Args, Default)]
pub struct Placing {
    /// Make directories that are missing; they go again when nothing is written
    #[arg(long)]
    mkdir: bool,

    /// Do not wait until files are on the disk: faster for many of them, but a power cut soon afterwards
    /// can take them
    #[arg(long)]
    no_sync: bool,

    /// Leave a file alone that would be written with the bytes that it has: its time stays, and what watches it does nothing
    #[arg(long)]
    if_changed: bool,
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
        let bundle = if self.if_changed { bundle.sparing_same() } else { bundle };
        Ok(if self.no_sync { bundle.unsynced() } else { bundle })
    }

    /// The same for what is made of `sources`, none of which it may replace.
    pub fn bundle_beside(&self, target: &Path, sources: &[PathBuf]) -> Result<Bundle, ExportError> {
        let bundle = self.bundle(target)?;
        ensure_spared(std::slice::from_ref(&bundle), sources)?;
        Ok(bundle)
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

/// What a picture's file holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PictureKind {
    Pixels(PictureFormat),
    /// Strokes.
    Svg,
}

/// A picture's file that is to be, with its folders.
pub struct PictureTarget {
    bundle: Bundle,
    kind: PictureKind,
    is_stdout: bool,
    folders: Vec<MadeFolders>,
}

impl PictureTarget {
    /// Tries the place. In a folder the file has the name of what it shows, and is a PNG.
    pub fn open(target: &Path, name: &str, placing: &Placing) -> anyhow::Result<Self> {
        let opened = Self::open_or_svg(target, name, placing)?;
        if opened.is_svg() {
            return Err(usage(format!(
                "{} is no picture of pixels: an SVG is a single drawing, of 'linden preview'",
                crate::paths::show(target)
            )));
        }
        Ok(opened)
    }

    /// The same where an SVG can be written too.
    pub fn open_or_svg(target: &Path, name: &str, placing: &Placing) -> anyhow::Result<Self> {
        let path = in_folder(target, || format!("{}.png", plain_stem(name)));
        // Devices and pipes have fixed names; any other file would be lost to a typing mistake.
        let is_stream = || path.metadata().is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
        let is_svg = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
        let kind = match PictureFormat::of_name(&path) {
            Some(format) => PictureKind::Pixels(format),
            None if is_svg => PictureKind::Svg,
            None if is_dash(&path) || is_stream() => PictureKind::Pixels(PictureFormat::Png),
            None => return Err(usage(unknown_ending(&path))),
        };
        let folders = placing.folders([path.as_path()])?;
        let bundle = placing.bundle(&path).map_err(explained)?;
        Ok(Self { bundle, kind, is_stdout: is_dash(&path), folders })
    }

    /// Whether it is to be an SVG.
    pub fn is_svg(&self) -> bool {
        self.kind == PictureKind::Svg
    }

    /// Asks for what a picture of this size takes while it is written, beside `held_bytes`.
    pub fn admit(&self, size: Size, held_bytes: u64, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let PictureKind::Pixels(format) = self.kind else { return Ok(()) };
        portrait::admit(format, size, held_bytes, monitor)
    }

    /// Refuses to replace one of the files that what it shows is made of.
    pub fn spare(&self, sources: &[PathBuf]) -> anyhow::Result<()> {
        ensure_spared(std::slice::from_ref(&self.bundle), sources).map_err(explained)
    }

    /// Writes the file, with the recipe of what it shows, and puts it in its place; gives what can be listed: nothing
    /// that went to standard output.
    pub fn write(
        self,
        picture: &Picture,
        recipe: Option<&str>,
        progress: &Progress,
    ) -> anyhow::Result<Vec<Written>> {
        let format = if let PictureKind::Pixels(format) = self.kind { format } else { PictureFormat::Png };
        let bytes = picture.preview(format, recipe)?;
        progress.clear();
        super::notes(&portrait::losses(picture, format, recipe), progress);
        self.put(&bytes, progress)
    }

    /// The same with the text of an SVG.
    pub fn write_svg(self, svg: &str, progress: &Progress) -> anyhow::Result<Vec<Written>> {
        progress.clear();
        self.put(svg.as_bytes(), progress)
    }

    fn put(self, bytes: &[u8], progress: &Progress) -> anyhow::Result<Vec<Written>> {
        let Self { mut bundle, is_stdout, folders, .. } = self;
        if let Some(pipe) = bundle.unread_pipe() {
            super::notes(&[waiting(pipe)], progress);
        }
        let done = bundle.write_main(Some(bytes.len() as u64), progress, |sink| sink.write(bytes));
        done.map_err(if is_stdout { as_sole_output } else { explained })?;
        let written = bundle.commit().map_err(explained)?;
        folders.into_iter().for_each(MadeFolders::keep);
        progress.clear();
        Ok(if is_stdout { Vec::new() } else { written })
    }
}

/// The file is not known for a picture by its name.
fn unknown_ending(path: &Path) -> String {
    let known: Vec<String> = PictureFormat::ALL
        .iter()
        .map(|format| {
            let endings: Vec<String> = format.endings().iter().map(|ending| format!(".{ending}")).collect();
            format!("{} ({})", format.name(), endings.join(", "))
        })
        .collect();
    format!(
        "the ending of {} is none of a picture's: {}, or SVG (.svg) for a flat drawing; name it like {0}.png",
        crate::paths::show(path),
        known.join(", ")
    )
}

/// Where a file goes that is called `name` in a folder.
pub fn in_folder(target: &Path, name: impl FnOnce() -> String) -> PathBuf {
    if is_folder(target) { target.join(name()) } else { target.to_owned() }
}
