//! What a session writes to the terminal, spelled here and nowhere else.
//!
//! Numbers of modes as in xterm ctlseqs, "DEC Private Mode Set (DECSET)".

/// Takes the terminal: the alternate screen (1049 keeps the cursor's place), no cursor (25), pasted
/// text in brackets (2004), focus (1004).
pub(crate) const ENTER: &[u8] = b"\x1b[?1049h\x1b[?25l\x1b[?2004h\x1b[?1004h";

/// Buttons (1000), drags (1002), cells beyond 223 (1006). Not 1003: motion alone is nothing to us,
/// and over a slow link it is many bytes.
pub(crate) const MOUSE_ON: &[u8] = b"\x1b[?1000h\x1b[?1002h\x1b[?1006h";

/// Undoes [`MOUSE_ON`].
pub(crate) const MOUSE_OFF: &[u8] = b"\x1b[?1006l\x1b[?1002l\x1b[?1000l";

/// Makes the terminal say nothing more on its own.
///
/// Begins with ST, which ends a picture that was cut off and is nothing otherwise, then ends a
/// synchronized update (2026); then mouse, focus and paste, whether or not they were on.
pub(crate) const QUIET: &[u8] = b"\x1b\\\x1b[?2026l\x1b[?1006l\x1b[?1002l\x1b[?1000l\x1b[?1004l\x1b[?2004l";

/// Gives the terminal back: cursor, plain rendition, the screen that was there before.
pub(crate) const LEAVE: &[u8] = b"\x1b[?25h\x1b[m\x1b[?1049l";

/// Deletes all images and their data, without an answer
/// (<https://sw.kovidgoyal.net/kitty/graphics-protocol/#deleting-images>).
pub(crate) const DELETE_IMAGES: &[u8] = b"\x1b_Ga=d,d=A,q=2\x1b\\";

/// DSR 6: where is the cursor?
pub(crate) const ASK_CURSOR: &[u8] = b"\x1b[6n";

/// Whether an answer to [`ASK_CURSOR`] is in it: `CSI row ; column R`.
pub(crate) fn tells_cursor(bytes: &[u8]) -> bool {
    let is_answer = |body: &[u8]| {
        let mut numbers = body.split(|byte| *byte == b';');
        let mut is_number =
            || numbers.next().is_some_and(|n| !n.is_empty() && n.iter().all(u8::is_ascii_digit));
        is_number() && is_number()
    };
    bytes.split(|byte| *byte == 0x1b).any(|sequence| {
        let body = sequence.strip_prefix(b"[");
        body.and_then(|body| Some(&body[..body.iter().position(|byte| *byte == b'R')?]))
            .is_some_and(is_answer)
    })
}
