//! What a session writes to the terminal.
//!
//! Crossterm's commands where there is one. Spelled here is what it has not, or has otherwise: numbers of
//! modes as in xterm ctlseqs, "DEC Private Mode Set (DECSET)".

use std::io;

use crossterm::cursor::{Hide, Show};
use crossterm::event::{DisableBracketedPaste, DisableFocusChange, EnableBracketedPaste, EnableFocusChange};
use crossterm::queue;
use crossterm::style::Print;
use crossterm::terminal::{EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen};

/// No reports of the mouse: cells beyond 223 (1006), drags (1002), buttons (1000).
pub(crate) const MOUSE_OFF: &str = "\x1b[?1006l\x1b[?1002l\x1b[?1000l";

/// Deletes all images and their data, without an answer
/// (<https://sw.kovidgoyal.net/kitty/graphics-protocol/#deleting-images>).
pub(crate) const DELETE_IMAGES: &[u8] = b"\x1b_Ga=d,d=A,q=2\x1b\\";

/// Takes the terminal: the alternate screen, which keeps the cursor's place, no cursor, pasted text in
/// brackets, focus.
pub(crate) fn enter() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    queue!(bytes, EnterAlternateScreen, Hide, EnableBracketedPaste, EnableFocusChange)?;
    Ok(bytes)
}

/// Makes the terminal say nothing more on its own.
///
/// Begins with ST, which ends a picture that was cut off and is nothing otherwise, then ends a
/// synchronized update; then mouse, focus and paste, whether or not they were on.
pub(crate) fn quiet() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    queue!(
        bytes,
        Print("\x1b\\"),
        EndSynchronizedUpdate,
        Print(MOUSE_OFF),
        DisableFocusChange,
        DisableBracketedPaste
    )?;
    Ok(bytes)
}

/// Gives the terminal back: cursor, plain rendition, the screen that was there before.
pub(crate) fn leave() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    queue!(bytes, Show, Print("\x1b[m"), LeaveAlternateScreen)?;
    Ok(bytes)
}
