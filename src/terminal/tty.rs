//! The terminal itself: where its bytes come from and go to, and how large it is.

use std::fmt;
use std::io;

pub use crate::system::{Tty, takes_sequences};

/// A standard stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Where keys come from.
    Input,
    /// Where the picture goes.
    Output,
}

impl fmt::Display for Stream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "standard input",
            Self::Output => "standard output",
        })
    }
}

/// Why there is no terminal.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The stream is a file, a pipe, or closed.
    #[error("{0} is not a terminal")]
    NotATerminal(Stream),
    /// The system refuses another descriptor.
    #[error("{stream} is a terminal that cannot be opened: {source}")]
    Descriptor {
        /// Which stream.
        stream: Stream,
        /// What the system says.
        source: io::Error,
    },
}

impl From<OpenError> for io::Error {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::NotATerminal(_) => Self::new(io::ErrorKind::Unsupported, error),
            OpenError::Descriptor { ref source, .. } => Self::new(source.kind(), error),
        }
    }
}

/// How large a terminal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowSize {
    /// Characters per row, 1 to [`MAX_CELLS`](crate::MAX_CELLS).
    pub columns: u16,
    /// Rows, 1 to [`MAX_CELLS`](crate::MAX_CELLS).
    pub rows: u16,
    /// Pixels of these columns, 0 when the terminal does not say.
    pub width_px: u16,
    /// Pixels of these rows, 0 when the terminal does not say.
    pub height_px: u16,
}

impl Default for WindowSize {
    /// The VT100's.
    fn default() -> Self {
        Self { columns: 80, rows: 24, width_px: 0, height_px: 0 }
    }
}

impl WindowSize {
    /// Pixels of a cell, across and down, when the terminal says how many it has.
    pub fn cell_px(self) -> Option<(u16, u16)> {
        let cell = (self.width_px.checked_div(self.columns)?, self.height_px.checked_div(self.rows)?);
        (cell.0 > 0 && cell.1 > 0).then_some(cell)
    }
}
