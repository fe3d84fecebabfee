//! What may go wrong between a name and a file.
//!
//! A message is whole: it has the words of its `source` in it, so that whoever prints a chain of sources says them twice.

use std::io;
use std::path::{Path, PathBuf};

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_exporters::ExportError;
use linden_pipeline::document::Fault;
use linden_pipeline::dress::DetailError;
use linden_pipeline::forest::{ForestError, GrownForestError, LayoutError};
use linden_pipeline::grow::GrowError;
use linden_pipeline::input::InputError;
use linden_pipeline::lsystem::GrammarError;
use linden_pipeline::preset::{DefineError, KnobError, RecipeError, ShortEditError, UnknownPreset};
use linden_pipeline::report::ReportError;
use linden_raster::RasterError;

use crate::trust::NotAllowed;

/// What may go wrong between a name and a file. Each says what was being done, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A monitor said that the result is no longer wanted: [`Error::is_cancelled`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// No built-in preset has that id.
    #[error(transparent)]
    Unknown(#[from] UnknownPreset),
    /// A built-in preset that cannot be had.
    #[error(transparent)]
    Builtin(#[from] RecipeError),
    /// A file that cannot be read.
    #[error("reading {}: {error}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        error: io::Error,
    },
    /// A document that is wrong somewhere.
    #[error("{}:{fault}", .path.display())]
    Document {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        #[source]
        fault: Fault,
    },
    /// A document that names a file elsewhere; [`read_allowing`](crate::read_allowing) lets it.
    #[error("{}: {error}; put it beside the document, or allow its folder if you trust it", .document.display())]
    NotAllowed {
        /// The document.
        document: PathBuf,
        /// What it names.
        #[source]
        error: NotAllowed,
    },
    /// A grammar that is wrong somewhere.
    #[error(transparent)]
    Grammar(#[from] GrammarError),
    /// A mesh, points or a picture that cannot be used.
    #[error("reading {}: {error}", .path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        error: InputError,
    },
    /// There is no memory for a file.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// A knob that there is not, or a value that it does not take.
    #[error(transparent)]
    Knob(#[from] KnobError),
    /// A constant that the grammar has not, or a value that it does not take.
    #[error(transparent)]
    Define(#[from] DefineError),
    /// An edit of the wood that is none.
    #[error(transparent)]
    Edit(#[from] ShortEditError),
    /// Nothing grew.
    #[error(transparent)]
    Grow(GrowError),
    /// A setting of a forest that there is not, or a value that it does not take.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// A forest that cannot be laid out, or a tree of it that did not grow.
    #[error(transparent)]
    Forest(GrownForestError),
    /// Surface, leaves or levels of detail.
    #[error(transparent)]
    Dress(DetailError),
    /// A tree that is not measured.
    #[error(transparent)]
    Report(ReportError),
    /// A picture.
    #[error(transparent)]
    Draw(RasterError),
    /// A file that is not written.
    #[error(transparent)]
    Export(ExportError),
    /// A picture's file that is not written.
    #[error("writing a picture: {0}")]
    Picture(#[from] linden_pipeline::picture::PictureError),
    /// A folder or file that the system refuses.
    #[error(transparent)]
    Io(#[from] io::Error),
}

linden_base::from_cancellable!(
    Error:
    GrowError => Grow,
    DetailError => Dress,
    ReportError => Report,
    RasterError => Draw,
    ExportError => Export
);

impl From<ForestError> for Error {
    fn from(error: ForestError) -> Self {
        GrownForestError::from(error).into()
    }
}

impl From<GrownForestError> for Error {
    fn from(error: GrownForestError) -> Self {
        if error.is_cancelled() { Self::Cancelled(Cancelled) } else { Self::Forest(error) }
    }
}

impl Error {
    pub(crate) fn of_input(path: &Path, error: InputError) -> Self {
        match error {
            InputError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            InputError::Memory(over) => Self::Memory(over),
            error => Self::Input { path: path.to_owned(), error },
        }
    }

    /// Whether a file is not there.
    pub(crate) fn is_missing(&self) -> bool {
        matches!(self, Self::Read { error, .. } if error.kind() == io::ErrorKind::NotFound)
    }

    /// Whether it is no fault: a [monitor](crate::Monitor) said that the result is no longer wanted. Nothing is written then.
    pub const fn is_cancelled(&self) -> bool {
        matches!(self, Self::Cancelled(_))
    }
}
