//! A stream of bytes cut into what a terminal takes them for (ECMA-48, xterm ctlseqs).

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token<'a> {
    /// Printable characters.
    Text(&'a [u8]),
    /// One byte below 32, or 127.
    Control(u8),
    /// `ESC` and what belongs to it.
    Escape(&'a [u8]),
    /// `CSI`: parameters with intermediate bytes, and the last byte.
    Csi(&'a [u8], u8),
    /// A string: `]` OSC, `P` DCS, `_` APC, `^` PM, `X` SOS; and what is in it.
    String(u8, &'a [u8]),
}

/// The whole tokens at the beginning of some bytes, and how many bytes they are.
pub fn tokens(bytes: &[u8]) -> (Vec<Token<'_>>, usize) {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some((token, length)) = next(&bytes[at..]) {
        found.push(token);
        at += length;
    }
    (found, at)
}

/// The first token, if all of it is there.
fn next(bytes: &[u8]) -> Option<(Token<'_>, usize)> {
    let first = *bytes.first()?;
    if first != 0x1b {
        if first < 0x20 || first == 0x7f {
            return Some((Token::Control(first), 1));
        }
        let end = bytes.iter().position(|byte| *byte < 0x20 || *byte == 0x7f).unwrap_or(bytes.len());
        return Some((Token::Text(&bytes[..end]), end));
    }
    match *bytes.get(1)? {
        b'[' => {
            let length = bytes[2..].iter().position(|byte| (0x40..0x7f).contains(byte))?;
            Some((Token::Csi(&bytes[2..2 + length], bytes[2 + length]), length + 3))
        }
        kind @ (b']' | b'P' | b'_' | b'^' | b'X') => {
            let body = &bytes[2..];
            let end = body.iter().position(|byte| *byte == 0x1b || (kind == b']' && *byte == 7))?;
            // BEL is one byte, ST two.
            let terminator = if body[end] == 7 { 1 } else { 2 };
            (body.len() >= end + terminator)
                .then(|| (Token::String(kind, &body[..end]), 2 + end + terminator))
        }
        _ => {
            let length = bytes[1..].iter().position(|byte| !(0x20..0x30).contains(byte))? + 2;
            Some((Token::Escape(&bytes[1..length]), length))
        }
    }
}
