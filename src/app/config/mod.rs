//! What the workbench reads and keeps on disk: settings, theme, keymap, the user's presets, the
//! session of last time, and the log.
//!
//! Nothing here keeps linden from starting. Each loader returns what could be read, with defaults for
//! the rest, and a [`Complaint`] for each thing that could not: file, line, column, what was wrong and
//! what to do. A file that is not there is no complaint. Text from files is in complaints only in its
//! printable form; everything else that is returned is as it stood in the file.
//!
//! | module | is | file |
//! |---|---|---|
//! | [`dirs`] | where all of it is | |
//! | [`settings`] | what can be set | `config.toml` |
//! | [`theme`] | the styles by role | `themes/NAME.toml` |
//! | [`keymap`] | which key runs which command | `keymap.toml` |
//! | [`presets`] | the user's presets and grammars | `presets/` |
//! | [`session`] | what is restored next time | `session.toml` |
//! | [`watch`] | tells when one of them changes | |
//! | [`log`] | the log file, on request | |

pub mod dirs;
mod document;
pub mod files;
pub mod keymap;
pub mod log;
pub mod presets;
pub mod session;
pub mod settings;
pub mod theme;
pub mod watch;

use std::fmt;
use std::path::{Path, PathBuf};

use linden::knob::printable;
use linden::preset::{Fault, TextPlace};

use crate::paths::show;

/// Something of the user's that could not be read or kept, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Complaint {
    /// The file or directory.
    pub file: PathBuf,
    /// Line and column in it, both from 1, the column in characters.
    pub place: Option<(usize, usize)>,
    /// What was wrong and what to do. Printable, one line.
    pub message: String,
}

impl Complaint {
    /// About a file as a whole.
    pub fn new(file: &Path, message: impl AsRef<str>) -> Self {
        Self { file: file.to_owned(), place: None, message: printable(message.as_ref().trim()) }
    }

    /// About a place in a file.
    fn at(file: &Path, place: Option<TextPlace>, message: impl AsRef<str>) -> Self {
        Self { place: place.map(|place| (place.line, place.column)), ..Self::new(file, message) }
    }
}

impl fmt::Display for Complaint {
    /// `FILE:LINE:COLUMN: MESSAGE`, as compilers and editors have it; printable.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&show(&self.file))?;
        if let Some((line, column)) = self.place {
            write!(f, ":{line}:{column}")?;
        }
        write!(f, ": {}", self.message)
    }
}

/// What is wrong with a preset's document, as a complaint about its file.
fn of_fault(file: &Path, fault: &Fault) -> Complaint {
    Complaint::at(file, fault.place, &fault.message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complaint_cannot_drive_the_terminal() {
        let place = Some(TextPlace { line: 3, column: 7 });
        let complaint = Complaint::at(Path::new("a\u{1b}[2J.toml"), place, "no '\u{202e}'\nthere");
        assert_eq!(complaint.to_string(), "a\\u{1b}[2J.toml:3:7: no '\\u{202e}'\\u{a}there");
        assert_eq!(Complaint::new(Path::new("x"), "gone").to_string(), "x: gone");
    }
}
