//! Bytes from a terminal → events: the frames.
//!
//! A sequence is framed first, as ECMA-48 (5th edition, sections 5.4 and 5.6) delimits it, and only a
//! whole frame is looked at. What is framed and not understood is dropped, so that late replies and
//! unknown keys are never typed as text. How the bytes are cut into reads changes
//! nothing; only silence does, because a lone ESC is a key and the start of everything else.
//!
//! Nothing grows with what is sent: frames keep at most [`STRING_LIMIT`] bytes, pastes
//! [`PASTE_LIMIT`], and what is beyond is still framed, but not kept.

use std::time::Duration;

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers};

use super::reply::StringKind;
use super::{Said, csi, reply};

/// Bytes kept of a DCS, OSC or APC; a longer one is dropped.
pub const STRING_LIMIT: usize = 64 * 1024;
/// Bytes kept of a paste; the rest of a longer one is dropped.
pub const PASTE_LIMIT: usize = 1024 * 1024;
/// Bytes kept of the parameters of a control sequence; a longer one is dropped.
const SEQUENCE_LIMIT: usize = 256;

/// Silence after which ESC is the key: a sequence's other bytes follow at once, a hand does not.
const KEY_TIMEOUT: Duration = Duration::from_millis(40);
/// Silence after which a sequence that has begun is given up. Long, because the rest of a reply that
/// a slow link has cut in two would be typed as keys.
const SEQUENCE_TIMEOUT: Duration = Duration::from_secs(1);
/// Silence after which a paste is taken to be over, although its end never came.
const PASTE_TIMEOUT: Duration = Duration::from_secs(5);

/// The end of a bracketed paste (xterm ctlseqs, "Bracketed Paste Mode").
const PASTE_END: &[u8] = b"\x1b[201~";

/// Makes events of bytes.
///
/// ```
/// use crossterm::event::{Event, KeyCode};
/// use linden_terminal::input::{Parser, Said};
/// let key = |code: KeyCode| Said::Event(Event::Key(code.into()));
/// let (mut parser, mut said) = (Parser::default(), Vec::new());
/// parser.feed(b"q\x1b[", &mut said);
/// parser.feed(b"A\x1b", &mut said);
/// assert_eq!(said, [KeyCode::Char('q'), KeyCode::Up].map(key));
/// assert!(parser.is_pending());
/// parser.flush(&mut said);
/// assert_eq!(said[2], key(KeyCode::Esc));
/// ```
#[derive(Debug, Default)]
pub struct Parser {
    state: State,
    /// What the frame that has begun holds so far.
    held: Vec<u8>,
    /// Whether more came than is kept.
    overflown: bool,
    /// Whether a second ESC stands before the frame: Alt to some terminals, a key to others.
    escaped: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// Between frames.
    #[default]
    Ground,
    /// After ESC.
    Escape,
    /// In a control sequence.
    Csi,
    /// After `CSI [`, which the Linux console puts before F1 to F5.
    ConsoleFunction,
    /// In an X10 mouse report, with as many bytes to come.
    X10(u8),
    /// After SS3.
    Ss3,
    /// In a string.
    String(StringKind),
    /// After an ESC in a string: its end, or the end of it.
    StringEscape(StringKind),
    /// In a paste, with as many bytes of its end seen.
    Paste(usize),
    /// In a character of as many bytes, behind ESC or not.
    Utf8 { length: u8, alt: bool },
}

fn said(key: KeyEvent) -> Said {
    Said::Event(Event::Key(key))
}

impl Parser {
    /// Takes what was read and appends what it says.
    pub fn feed(&mut self, bytes: &[u8], out: &mut Vec<Said>) {
        for &byte in bytes {
            self.step(byte, out);
        }
    }

    /// Whether something has begun and not ended.
    pub fn is_pending(&self) -> bool {
        self.state != State::Ground
    }

    /// After how long a silence [`Self::flush`] is due; `None` when nothing is pending.
    pub fn timeout(&self) -> Option<Duration> {
        match self.state {
            State::Ground => None,
            State::Paste(_) => Some(PASTE_TIMEOUT),
            _ if self.may_be_key() => Some(KEY_TIMEOUT),
            _ => Some(SEQUENCE_TIMEOUT),
        }
    }

    /// Nothing more is coming: a lone ESC was the key, `ESC [` was Alt-[, a paste is over, and any
    /// other unfinished sequence is thrown away.
    pub fn flush(&mut self, out: &mut Vec<Said>) {
        let state = self.state;
        match state {
            State::Paste(seen) => {
                self.keep(&PASTE_END[..seen], PASTE_LIMIT);
                self.end_paste(out);
            }
            _ if self.may_be_key() => {
                let introducer = match state {
                    State::Csi => Some(b'['),
                    State::Ss3 => Some(b'O'),
                    State::String(kind) => Some(kind.introducer()),
                    _ => None,
                };
                let key = match introducer {
                    Some(byte) => csi::alt(csi::character(char::from(byte))),
                    None => KeyCode::Esc.into(),
                };
                self.release_escape(out);
                out.push(said(key));
            }
            _ => self.release_escape(out),
        }
        self.reset();
    }

    /// Whether what came so far may be a key that someone pressed, and nothing more.
    fn may_be_key(&self) -> bool {
        match self.state {
            State::Escape | State::StringEscape(_) => true,
            State::Csi | State::Ss3 | State::String(_) => self.held.is_empty(),
            _ => false,
        }
    }

    fn reset(&mut self) {
        self.state = State::Ground;
        self.held.clear();
        self.overflown = false;
        self.escaped = false;
    }

    /// Keeps bytes of a frame, up to a limit.
    fn keep(&mut self, bytes: &[u8], limit: usize) {
        let room = limit.saturating_sub(self.held.len());
        self.overflown |= bytes.len() > room;
        self.held.extend_from_slice(&bytes[..bytes.len().min(room)]);
    }

    /// Releases the ESC that came before what is no key: it was the key Escape.
    fn release_escape(&mut self, out: &mut Vec<Said>) {
        if std::mem::take(&mut self.escaped) {
            out.push(said(KeyCode::Esc.into()));
        }
    }

    /// The frame is over and said this, if anything.
    fn end(&mut self, event: Option<Said>, out: &mut Vec<Said>) {
        match event {
            Some(Said::Event(Event::Key(key)))
                if self.escaped && !key.modifiers.contains(KeyModifiers::ALT) =>
            {
                out.push(said(csi::alt(key)));
            }
            event => {
                self.release_escape(out);
                out.extend(event);
            }
        }
        self.reset();
    }

    /// Drops the frame and takes the byte as if it had not been.
    fn abort(&mut self, byte: u8, out: &mut Vec<Said>) {
        self.release_escape(out);
        self.reset();
        self.ground(byte, out);
    }

    fn step(&mut self, byte: u8, out: &mut Vec<Said>) {
        match self.state {
            State::Ground => self.ground(byte, out),
            State::Escape => self.escape(byte, out),
            State::Csi => self.control_sequence(byte, out),
            State::ConsoleFunction => match byte {
                b'A'..=b'E' => {
                    self.end(Some(said(KeyCode::F(byte - b'A' + 1).into())), out);
                }
                0x20..=0x7e => self.end(None, out),
                _ => self.abort(byte, out),
            },
            State::X10(left) => match byte {
                0x00..=0x1f => self.abort(byte, out),
                _ if left > 1 => self.state = State::X10(left - 1),
                _ => self.end(None, out),
            },
            State::Ss3 => match byte {
                b'0'..=b'9' | b';' => self.keep(&[byte], SEQUENCE_LIMIT),
                0x20..=0x7e => {
                    let key = csi::ss3(&self.held, byte).filter(|_| !self.overflown);
                    self.end(key.map(said), out);
                }
                _ => self.abort(byte, out),
            },
            State::String(kind) => self.string(kind, byte, out),
            State::StringEscape(kind) => match byte {
                b'\\' => self.end_string(kind, out),
                _ => {
                    self.release_escape(out);
                    self.reset();
                    self.escape(byte, out);
                }
            },
            State::Paste(seen) => self.paste(seen, byte, out),
            State::Utf8 { length, alt } => self.character(length, alt, byte, out),
        }
    }

    fn ground(&mut self, byte: u8, out: &mut Vec<Said>) {
        match byte {
            0x1b => self.state = State::Escape,
            0x80.. => self.lead(byte, false),
            _ => out.extend(csi::typed(byte).map(said)),
        }
    }

    fn escape(&mut self, byte: u8, out: &mut Vec<Said>) {
        self.state = match byte {
            b'[' => State::Csi,
            b'O' => State::Ss3,
            0x1b => {
                self.release_escape(out);
                self.escaped = true;
                State::Escape
            }
            _ if let Some(kind) = StringKind::introduced_by(byte) => State::String(kind),
            0x80.. => {
                self.release_escape(out);
                self.lead(byte, true);
                return;
            }
            _ => {
                self.release_escape(out);
                let key = csi::typed(byte).map(|key| said(csi::alt(key)));
                return self.end(key, out);
            }
        };
    }

    /// The first byte of a character; one that is none is dropped.
    fn lead(&mut self, byte: u8, alt: bool) {
        self.reset();
        let length = match byte {
            0xc2..=0xdf => 2,
            0xe0..=0xef => 3,
            0xf0..=0xf4 => 4,
            _ => return,
        };
        self.held.push(byte);
        self.state = State::Utf8 { length, alt };
    }

    fn character(&mut self, length: u8, alt: bool, byte: u8, out: &mut Vec<Said>) {
        if !matches!(byte, 0x80..=0xbf) {
            return self.abort(byte, out);
        }
        self.held.push(byte);
        if self.held.len() < usize::from(length) {
            return;
        }
        let c = std::str::from_utf8(&self.held).ok().and_then(|text| text.chars().next());
        let key = c.filter(|c| !c.is_control()).map(csi::character);
        self.end(key.map(|key| said(if alt { csi::alt(key) } else { key })), out);
    }

    fn control_sequence(&mut self, byte: u8, out: &mut Vec<Said>) {
        match byte {
            b'[' if self.held.is_empty() => self.state = State::ConsoleFunction,
            b'M' if self.held.is_empty() => self.state = State::X10(3),
            // rxvt ends `CSI 3 $` with what is an intermediate byte everywhere else.
            b'$' if csi::is_small_number(&self.held) => {
                let key = csi::rxvt(&self.held, byte);
                self.end(key.map(said), out);
            }
            0x20..=0x3f => self.keep(&[byte], SEQUENCE_LIMIT),
            b'~' if self.held == b"200" => {
                self.release_escape(out);
                self.reset();
                self.state = State::Paste(0);
            }
            0x40..=0x7e => {
                let event = if self.overflown { None } else { csi::decode(&self.held, byte) };
                self.end(event, out);
            }
            0x18 | 0x1a => self.end(None, out),
            _ => self.abort(byte, out),
        }
    }

    fn string(&mut self, kind: StringKind, byte: u8, out: &mut Vec<Said>) {
        match byte {
            0x1b => self.state = State::StringEscape(kind),
            0x07 if kind == StringKind::Osc => self.end_string(kind, out),
            // CAN and SUB end any sequence (ECMA-48 8.3.6, DEC STD 070).
            0x18 | 0x1a => self.end(None, out),
            // Nobody answers Ctrl-C: this is a hand at a keyboard that has gone dead.
            0x03 => self.abort(byte, out),
            _ => self.keep(&[byte], STRING_LIMIT),
        }
    }

    fn end_string(&mut self, kind: StringKind, out: &mut Vec<Said>) {
        let reply = if self.overflown { None } else { reply::decode(kind, &self.held) };
        self.end(reply.map(Said::Reply), out);
    }

    fn paste(&mut self, seen: usize, byte: u8, out: &mut Vec<Said>) {
        if byte == PASTE_END[seen] {
            if seen + 1 == PASTE_END.len() {
                return self.end_paste(out);
            }
            self.state = State::Paste(seen + 1);
            return;
        }
        // No part of the end but its first byte can begin another end.
        self.keep(&PASTE_END[..seen], PASTE_LIMIT);
        if byte == PASTE_END[0] {
            self.state = State::Paste(1);
        } else {
            self.keep(&[byte], PASTE_LIMIT);
            self.state = State::Paste(0);
        }
    }

    fn end_paste(&mut self, out: &mut Vec<Said>) {
        let mut bytes = std::mem::take(&mut self.held);
        if self.overflown {
            // The cut may have gone through a character.
            while bytes.last().is_some_and(|byte| matches!(byte, 0x80..=0xbf)) {
                bytes.pop();
            }
            bytes.pop_if(|byte| *byte >= 0xc0);
        }
        let text = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(wrong) => String::from_utf8_lossy(wrong.as_bytes()).into_owned(),
        };
        self.end(Some(Said::Event(Event::Paste(text))), out);
    }
}

#[cfg(test)]
#[path = "parser_tests.rs"]
mod tests;
