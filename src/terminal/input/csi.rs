//! What a control sequence, SS3 or a control character says: keys, the mouse, focus, short replies.

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};

use super::{Reply, Said};

/// Parameters that a sequence may have; no sequence of ours has more, DA1 has about twenty.
const PARAMETERS: usize = 64;

/// The key of an ASCII byte that stands alone.
///
/// 0x08 is Backspace: some terminals send it for that key, and the others for Ctrl with it.
pub(super) fn typed(byte: u8) -> Option<KeyEvent> {
    Some(match byte {
        0x00 => ctrl(' '),
        0x08 | 0x7f => KeyCode::Backspace.into(),
        b'\t' => KeyCode::Tab.into(),
        b'\r' => KeyCode::Enter.into(),
        0x1b => KeyCode::Esc.into(),
        0x01..=0x1a => ctrl(char::from(byte - 1 + b'a')),
        0x1c..=0x1f => ctrl(char::from(byte + 0x40)),
        0x20..=0x7e => character(char::from(byte)),
        _ => return None,
    })
}

/// A character that was typed, with Shift when it is a capital.
pub(super) fn character(c: char) -> KeyEvent {
    with(KeyModifiers::NONE, KeyCode::Char(c))
}

/// Ctrl and a character.
fn ctrl(c: char) -> KeyEvent {
    KeyEvent::new(KeyCode::Char(c), KeyModifiers::CONTROL)
}

/// The same key with Alt.
pub(super) fn alt(key: KeyEvent) -> KeyEvent {
    KeyEvent::new(key.code, key.modifiers | KeyModifiers::ALT)
}

/// A key with what was held, as crossterm says it: Shift beside a capital, and Shift-Tab by a name of its own.
fn with(held: KeyModifiers, code: KeyCode) -> KeyEvent {
    match code {
        KeyCode::Char(c) if c.is_uppercase() => KeyEvent::new(code, held | KeyModifiers::SHIFT),
        KeyCode::Char(_) => KeyEvent::new(code, held - KeyModifiers::SHIFT),
        KeyCode::Tab if held.contains(KeyModifiers::SHIFT) => KeyEvent::new(KeyCode::BackTab, held),
        _ => KeyEvent::new(code, held),
    }
}

/// The key of SS3 (xterm ctlseqs, "PC-Style Function Keys" and "VT220-Style Function Keys").
///
/// Some terminals put a modifier between: `ESC O 5 A`, `ESC O 1 ; 2 P`.
pub(super) fn ss3(parameters: &[u8], last: u8) -> Option<KeyEvent> {
    let parameters = Parameters::parse(parameters)?;
    let held = match parameters.len() {
        0 => KeyModifiers::NONE,
        n => held(parameters.get(n - 1)?)?,
    };
    let code = match last {
        // rxvt: Ctrl with an arrow.
        b'a'..=b'd' => return Some(KeyEvent::new(arrow(last - 0x20)?, KeyModifiers::CONTROL)),
        // The keypad in application mode: `*` `+` `,` `-` `.` `/` and the digits.
        b'j'..=b'y' => KeyCode::Char(char::from(last - 0x40)),
        b'X' => KeyCode::Char('='),
        b' ' => KeyCode::Char(' '),
        b'I' => KeyCode::Tab,
        b'M' => KeyCode::Enter,
        _ => named_by_letter(last)?,
    };
    Some(with(held, code))
}

/// Whether these are one or two digits, and nothing else.
pub(super) fn is_small_number(parameters: &[u8]) -> bool {
    matches!(parameters.len(), 1 | 2) && parameters.iter().all(u8::is_ascii_digit)
}

/// The keys of rxvt that end with what they are held with: `$` Shift, `^` Ctrl, `@` both
/// (urxvt(7), "Key Codes").
pub(super) fn rxvt(parameters: &[u8], last: u8) -> Option<KeyEvent> {
    let parameters = Parameters::parse(parameters).filter(|p| p.len() == 1)?;
    let code = named_by_number(parameters.get(0)?)?;
    Some(with(
        match last {
            b'$' => KeyModifiers::SHIFT,
            b'^' => KeyModifiers::CONTROL,
            _ => KeyModifiers::SHIFT | KeyModifiers::CONTROL,
        },
        code,
    ))
}

/// What a control sequence says: its parameters and intermediate bytes, and its last byte.
pub(super) fn decode(body: &[u8], last: u8) -> Option<Said> {
    let (prefix, rest) = match body.first() {
        Some(first @ b'<'..=b'?') => (Some(*first), &body[1..]),
        _ => (None, body),
    };
    let split = rest.iter().position(|byte| matches!(byte, 0x20..=0x2f)).unwrap_or(rest.len());
    let (parameters, intermediates) = rest.split_at(split);
    let parameters = Parameters::parse(parameters)?;
    match (prefix, intermediates) {
        (None, b"") => plain(&parameters, last),
        (Some(b'<'), b"") => mouse(&parameters, last).map(|mouse| Said::Event(Event::Mouse(mouse))),
        (Some(b'?'), b"") if last == b'c' => Some(Said::Reply(Reply::Attributes(parameters.small()))),
        (Some(b'?'), b"$") if last == b'y' => {
            let number = parameters.get(0)?.try_into().ok()?;
            // 0 is an unknown mode, 4 one that can never be set (DEC STD 070, DECRPM).
            let known = matches!(parameters.get(1)?, 1..=3);
            Some(Said::Reply(Reply::Mode { number, known }))
        }
        _ => None,
    }
}

fn plain(parameters: &Parameters, last: u8) -> Option<Said> {
    let count = parameters.len();
    let key = match last {
        b'I' | b'O' if count == 0 => {
            return Some(Said::Event(if last == b'I' { Event::FocusGained } else { Event::FocusLost }));
        }
        b'n' if count == 1 && parameters.get(0) == Some(0) => return Some(Said::Reply(Reply::Status)),
        b't' if count == 3 && parameters.get(0) == Some(6) => {
            let (height, width) = (parameters.get(1)?.try_into().ok()?, parameters.get(2)?.try_into().ok()?);
            return (width > 0 && height > 0).then_some(Said::Reply(Reply::CellPixels { width, height }));
        }
        b'Z' => with(parameters.held()? | KeyModifiers::SHIFT, KeyCode::Tab),
        b'u' => coded(parameters.get(0)?, parameters.sub(0, 1), parameters.held()?)?,
        b'~' => match parameters.get(0)? {
            // xterm's modifyOtherKeys, format 0.
            27 => coded(parameters.get(2)?, None, parameters.held()?)?,
            number => with(parameters.held()?, named_by_number(number)?),
        },
        b'^' | b'@' if count == 1 => {
            let code = named_by_number(parameters.get(0)?)?;
            let shift = if last == b'@' { KeyModifiers::SHIFT } else { KeyModifiers::NONE };
            with(shift | KeyModifiers::CONTROL, code)
        }
        // rxvt: Shift with an arrow.
        b'a'..=b'd' if count == 0 => KeyEvent::new(arrow(last - 0x20)?, KeyModifiers::SHIFT),
        // `CSI 1 ; m R` is F3, and any other with R says where the cursor is.
        _ if count > 0 && parameters.get(0) != Some(1) => return None,
        _ => with(parameters.held()?, named_by_letter(last)?),
    };
    Some(Said::Event(Event::Key(key)))
}

/// SGR mouse reports (xterm ctlseqs, "Extended coordinates", 1006).
fn mouse(parameters: &Parameters, last: u8) -> Option<MouseEvent> {
    const MOTION: u32 = 32;
    let state = parameters.get(0).filter(|_| parameters.len() == 3)?;
    let cell = |at: u32| u16::try_from(at.checked_sub(1)?).ok();
    let (column, row) = (cell(parameters.get(1)?)?, cell(parameters.get(2)?)?);
    let (which, is_release) = (state & 3, last == b'm');
    if !is_release && last != b'M' {
        return None;
    }
    let button = match which {
        0 => Some(MouseButton::Left),
        1 => Some(MouseButton::Middle),
        2 => Some(MouseButton::Right),
        _ => None,
    };
    let kind = match (state & !(3 | 4 | 8 | 16), is_release) {
        (0, false) => MouseEventKind::Down(button?),
        (0 | MOTION, true) => MouseEventKind::Up(button?),
        (MOTION, false) => MouseEventKind::Drag(button?),
        (64, false) if which == 0 => MouseEventKind::ScrollUp,
        (64, false) if which == 1 => MouseEventKind::ScrollDown,
        _ => return None,
    };
    let held = [(4, KeyModifiers::SHIFT), (8, KeyModifiers::ALT), (16, KeyModifiers::CONTROL)];
    let modifiers = held.into_iter().filter(|(bit, _)| state & bit != 0).map(|(_, held)| held).collect();
    Some(MouseEvent { kind, column, row, modifiers })
}

/// A key by its code point (<https://sw.kovidgoyal.net/kitty/keyboard-protocol/>, and fixterms
/// before it), with what it is with Shift when the terminal says so.
fn coded(code: u32, shifted: Option<u32>, held: KeyModifiers) -> Option<KeyEvent> {
    let code = match code {
        8 | 127 => KeyCode::Backspace,
        9 => KeyCode::Tab,
        13 | 57414 => KeyCode::Enter,
        27 => KeyCode::Esc,
        57399..=57408 => KeyCode::Char(char::from_digit(code - 57399, 10)?),
        57409..=57413 => KeyCode::Char(['.', '/', '*', '-', '+'][code as usize - 57409]),
        57415 => KeyCode::Char('='),
        57416 => KeyCode::Char(','),
        57417 => KeyCode::Left,
        57418 => KeyCode::Right,
        57419 => KeyCode::Up,
        57420 => KeyCode::Down,
        57421 => KeyCode::PageUp,
        57422 => KeyCode::PageDown,
        57423 => KeyCode::Home,
        57424 => KeyCode::End,
        57425 => KeyCode::Insert,
        57426 => KeyCode::Delete,
        // The rest of the block that kitty took for keys without characters.
        57344..=63743 => return None,
        _ => {
            let plain = char::from_u32(code).filter(|c| !c.is_control())?;
            let mut upper = plain.to_uppercase();
            let c = match (
                held.contains(KeyModifiers::SHIFT),
                shifted.and_then(char::from_u32),
                upper.next(),
                upper.next(),
            ) {
                (true, Some(shifted), ..) if !shifted.is_control() => shifted,
                (true, _, Some(upper), None) => upper,
                _ => plain,
            };
            KeyCode::Char(c)
        }
    };
    Some(with(held, code))
}

/// The key of a last byte (xterm ctlseqs, "PC-Style Function Keys").
fn named_by_letter(last: u8) -> Option<KeyCode> {
    Some(match last {
        b'A'..=b'D' => return arrow(last),
        b'F' => KeyCode::End,
        b'H' => KeyCode::Home,
        b'P'..=b'S' => KeyCode::F(last - b'P' + 1),
        _ => return None,
    })
}

fn arrow(letter: u8) -> Option<KeyCode> {
    Some(match letter {
        b'A' => KeyCode::Up,
        b'B' => KeyCode::Down,
        b'C' => KeyCode::Right,
        b'D' => KeyCode::Left,
        _ => return None,
    })
}

/// The key of `CSI n ~` (xterm ctlseqs, "VT220-Style Function Keys"; 7 and 8 are rxvt's).
fn named_by_number(number: u32) -> Option<KeyCode> {
    let function = |first: u32, code: u32| KeyCode::F((code - first) as u8);
    Some(match number {
        1 | 7 => KeyCode::Home,
        2 => KeyCode::Insert,
        3 => KeyCode::Delete,
        4 | 8 => KeyCode::End,
        5 => KeyCode::PageUp,
        6 => KeyCode::PageDown,
        11..=15 => function(10, number),
        17..=21 => function(11, number),
        23 | 24 => function(12, number),
        _ => return None,
    })
}

/// What was held beside a key, from the parameter that is 1 more than the sum of Shift 1, Alt 2, Ctrl 4,
/// and others.
///
/// `None` with Super (8) or Hyper (16): such a key belongs to the desktop. Meta (32) is Alt; Caps Lock
/// (64) and Num Lock (128) are no matter.
fn held(parameter: u32) -> Option<KeyModifiers> {
    let held = parameter.saturating_sub(1);
    let known = [(1, KeyModifiers::SHIFT), (2 | 32, KeyModifiers::ALT), (4, KeyModifiers::CONTROL)];
    let named = known.into_iter().filter(|(bits, _)| held & bits != 0).map(|(_, modifier)| modifier);
    (held & (8 | 16) == 0).then(|| named.collect())
}

/// Numbers between `;`, each perhaps with others behind `:`. One left out is `None`.
struct Parameters(Vec<Vec<Option<u32>>>);

impl Parameters {
    /// `None` for anything but digits, `;` and `:`, too many of them, and numbers that are too large.
    fn parse(bytes: &[u8]) -> Option<Self> {
        if bytes.is_empty() {
            return Some(Self(Vec::new()));
        }
        let number = |digits: &[u8]| match digits {
            b"" => Some(None),
            _ => std::str::from_utf8(digits).ok().filter(|d| !d.starts_with('+'))?.parse().ok().map(Some),
        };
        let all: Vec<Vec<_>> = bytes
            .split(|byte| *byte == b';')
            .map(|parameter| parameter.split(|byte| *byte == b':').map(number).collect::<Option<_>>())
            .collect::<Option<_>>()?;
        (all.len() <= PARAMETERS).then_some(Self(all))
    }

    fn len(&self) -> usize {
        self.0.len()
    }

    fn get(&self, at: usize) -> Option<u32> {
        self.sub(at, 0)
    }

    fn sub(&self, at: usize, within: usize) -> Option<u32> {
        *self.0.get(at)?.get(within)?
    }

    /// What was held, as the second parameter has it; `None` when the key is not ours or went up
    /// (kitty: event type 3).
    fn held(&self) -> Option<KeyModifiers> {
        if self.sub(1, 1) == Some(3) {
            return None;
        }
        self.get(1).map_or(Some(KeyModifiers::NONE), held)
    }

    /// All that fit into 16 bits.
    fn small(&self) -> Vec<u16> {
        self.0.iter().filter_map(|parameter| (*parameter.first()?)?.try_into().ok()).collect()
    }
}
