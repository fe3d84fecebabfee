//! Cells → bytes: the shortest way from what a terminal's pen and cursor are to what they must be.

use ratatui::style::{Color, Modifier};

use super::look::{Look, QUADRANTS};
use crate::color::{push_color, push_number};

/// What is set for the next character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pen {
    ink: Color,
    paper: Color,
    underline: Color,
    modifier: Modifier,
}

const PLAIN: Pen =
    Pen { ink: Color::Reset, paper: Color::Reset, underline: Color::Reset, modifier: Modifier::empty() };

/// What a pen must be; `None` where it does not show.
#[derive(Clone, Copy)]
struct Wanted {
    ink: Option<Color>,
    paper: Option<Color>,
    underline: Color,
    modifier: Modifier,
    /// Modifiers that may be on all the same, because nothing shows them.
    unseen: Modifier,
}

/// Modifiers that change letters alone: between bold words blanks may be bold too.
const OF_LETTERS: Modifier = Modifier::BOLD.union(Modifier::ITALIC);

/// What switches a modifier on and off (ECMA-48 8.3.117).
const MODIFIERS: [(Modifier, u8, u8); 9] = [
    (Modifier::BOLD, 1, 22),
    (Modifier::DIM, 2, 22),
    (Modifier::ITALIC, 3, 23),
    (Modifier::UNDERLINED, 4, 24),
    (Modifier::SLOW_BLINK, 5, 25),
    (Modifier::RAPID_BLINK, 6, 25),
    (Modifier::REVERSED, 7, 27),
    (Modifier::HIDDEN, 8, 28),
    (Modifier::CROSSED_OUT, 9, 29),
];

/// A terminal's pen and cursor, as far as they are known. Each call appends the bytes that bring
/// them where they must be.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    pen: Pen,
    row: Option<u16>,
    /// Unknown after the last column: terminals wrap at different moments.
    column: Option<u16>,
}

impl Encoder {
    /// A terminal whose pen is plain, and whose cursor is anywhere.
    pub const fn new() -> Self {
        Self { pen: PLAIN, row: None, column: None }
    }

    /// Where the cursor is, if that is known: column, row.
    pub fn cursor(&self) -> Option<(u16, u16)> {
        self.column.zip(self.row)
    }

    /// Something else has moved the cursor.
    pub fn lose_cursor(&mut self) {
        (self.row, self.column) = (None, None);
    }

    /// The cursor has moved on over what was printed.
    pub fn advance(&mut self, columns: u16, width: u16) {
        self.column = self.column.map(|column| column + columns).filter(|&column| column < width);
    }

    /// The column is no longer known, the row is.
    pub fn lose_column(&mut self) {
        self.column = None;
    }

    /// Moves the cursor.
    pub fn go(&mut self, out: &mut Vec<u8>, column: u16, row: u16) {
        if self.cursor() == Some((column, row)) {
            return;
        }
        let mut best = Move::absolute(column, row);
        if let Some(from) = self.row {
            let down = row.checked_sub(from);
            if let Some(down @ 0..4) = down {
                best = best.or(Move::line(down, column));
            }
            if let Some(at) = self.column {
                if row == from {
                    best = best.or(Move::across(at, column));
                }
                if at == column {
                    best = best.or(Move::vertical(from, row));
                }
            }
        }
        out.extend_from_slice(&best.bytes[..best.len]);
        (self.row, self.column) = (Some(row), Some(column));
    }

    /// Sets the pen for a look and prints it at the cursor, in whichever form is shorter.
    pub fn print(&mut self, out: &mut Vec<u8>, look: Look<'_>) {
        let from = out.len();
        let before = self.pen;
        self.print_as(out, look);
        let Some(other) = look.exchanged() else { return };
        // Both ways are written, one stays.
        let (middle, after) = (out.len(), self.pen);
        self.pen = before;
        self.print_as(out, other);
        if out.len() - middle < middle - from {
            out.drain(from..middle);
        } else {
            out.truncate(middle);
            self.pen = after;
        }
    }

    fn print_as(&mut self, out: &mut Vec<u8>, look: Look<'_>) {
        self.select(out, Wanted::of(look));
        match look {
            Look::Quarters { drawn, .. } => out.extend_from_slice(QUADRANTS[usize::from(drawn)].as_bytes()),
            Look::Text { symbol, .. } => out.extend_from_slice(symbol.as_bytes()),
        }
    }

    /// Erases cells from the cursor on, which does not move (ECMA-48 8.3.38 ECH, 8.3.41 EL).
    /// With another paper than the terminal's own it must be one that erases in the pen's colour.
    pub fn erase(&mut self, out: &mut Vec<u8>, paper: Color, cells: Option<u16>) {
        // What is erased takes the paper alone, but some terminals take underlining too.
        self.select(
            out,
            Wanted {
                ink: None,
                paper: Some(paper),
                underline: Color::Reset,
                modifier: Modifier::empty(),
                unseen: OF_LETTERS,
            },
        );
        out.extend_from_slice(b"\x1b[");
        match cells {
            Some(n) => {
                push_number(out, n);
                out.push(b'X');
            }
            None => out.push(b'K'),
        }
    }

    /// Whether the pen is right for a look as it is.
    pub fn fits(&self, look: Look<'_>) -> bool {
        let wanted = Wanted::of(look);
        wanted.ink.is_none_or(|ink| ink == self.pen.ink)
            && wanted.paper.is_none_or(|paper| paper == self.pen.paper)
            && wanted.modifier == self.pen.modifier - wanted.unseen
            && wanted.underline == self.pen.underline
    }

    /// A plain pen.
    pub fn plain(&mut self, out: &mut Vec<u8>) {
        if self.pen != PLAIN {
            out.extend_from_slice(b"\x1b[m");
            self.pen = PLAIN;
        }
    }

    fn select(&mut self, out: &mut Vec<u8>, wanted: Wanted) {
        let target = Pen {
            ink: wanted.ink.unwrap_or(self.pen.ink),
            paper: wanted.paper.unwrap_or(self.pen.paper),
            underline: wanted.underline,
            modifier: wanted.modifier | (self.pen.modifier & wanted.unseen),
        };
        if target == self.pen {
            return;
        }
        let from = out.len();
        difference(out, self.pen, target);
        // Nothing is switched off: a plain pen is of no use.
        let gone = |from: Color, to: Color| from != to && to == Color::Reset;
        if (self.pen.modifier - target.modifier).is_empty()
            && !gone(self.pen.ink, target.ink)
            && !gone(self.pen.paper, target.paper)
            && !gone(self.pen.underline, target.underline)
        {
            self.pen = target;
            return;
        }
        let middle = out.len();
        // From a plain pen it may be shorter, and what does not show is not set again; a colour
        // that may be wanted again is worth more than two bytes.
        let bare = Pen {
            ink: wanted.ink.unwrap_or(Color::Reset),
            paper: wanted.paper.unwrap_or(Color::Reset),
            modifier: wanted.modifier,
            ..target
        };
        let lost = if bare == target { 0 } else { 6 };
        out.extend_from_slice(b"\x1b[");
        let parameters = out.len();
        difference(out, PLAIN, bare);
        if out.len() > parameters {
            // "ESC [" of the difference becomes "0;" of one sequence.
            out.drain(parameters..parameters + 2);
            out.splice(parameters..parameters, *b";");
        } else {
            out.push(b'm');
        }
        if out.len() - middle + lost < middle - from {
            out.drain(from..middle);
            self.pen = bare;
        } else {
            out.truncate(middle);
            self.pen = target;
        }
    }
}

impl Wanted {
    fn of(look: Look<'_>) -> Self {
        match look {
            Look::Quarters { ink, paper, drawn } => Self {
                ink,
                paper,
                underline: Color::Reset,
                modifier: Modifier::empty(),
                unseen: if drawn == 0 { OF_LETTERS } else { Modifier::empty() },
            },
            Look::Text { ink, paper, underline, modifier, symbol } => {
                // Reversed and struck-out blanks show the ink.
                let ink = (symbol != " " || !modifier.is_empty()).then_some(ink);
                Self { ink, paper: Some(paper), underline, modifier, unseen: Modifier::empty() }
            }
        }
    }
}

/// One sequence that changes a pen into another; a colour of the underline needs a second one, with
/// colons: a terminal that does not know it would take its numbers for other attributes.
fn difference(out: &mut Vec<u8>, from: Pen, to: Pen) {
    let start = out.len();
    let next = |out: &mut Vec<u8>| {
        if out.len() == start { out.extend_from_slice(b"\x1b[") } else { out.push(b';') }
    };
    let removed = from.modifier - to.modifier;
    let mut added = to.modifier - from.modifier;
    let mut off = 0;
    for (modifier, _, code) in MODIFIERS {
        if removed.contains(modifier) {
            if off != code {
                next(out);
                push_number(out, code.into());
                off = code;
            }
            // One code switches two of them off; what stays is set again.
            let pair = MODIFIERS.iter().filter(|(_, _, other)| *other == code);
            added |= pair.fold(Modifier::empty(), |all, (m, ..)| all | *m) & to.modifier;
        }
    }
    for (modifier, code, _) in MODIFIERS {
        if added.contains(modifier) {
            next(out);
            push_number(out, code.into());
        }
    }
    for (from, to, base) in [(from.ink, to.ink, 30), (from.paper, to.paper, 40)] {
        if from != to {
            next(out);
            push_color(out, to, base);
        }
    }
    if out.len() > start {
        out.push(b'm');
    }
    if from.underline != to.underline {
        out.extend_from_slice(b"\x1b[5");
        match to.underline {
            Color::Indexed(entry) => {
                out.extend_from_slice(b"8:5:");
                push_number(out, entry.into());
            }
            Color::Rgb(r, g, b) => {
                out.extend_from_slice(b"8:2:");
                for c in [r, g, b] {
                    out.push(b':');
                    push_number(out, c.into());
                }
            }
            _ => out.push(b'9'),
        }
        out.push(b'm');
    }
}

/// One way to move the cursor.
#[derive(Clone, Copy)]
struct Move {
    bytes: [u8; 16],
    len: usize,
}

impl Move {
    fn new(write: impl FnOnce(&mut Vec<u8>)) -> Self {
        let mut written = Vec::with_capacity(16);
        write(&mut written);
        let mut bytes = [0; 16];
        bytes[..written.len()].copy_from_slice(&written);
        Self { bytes, len: written.len() }
    }

    fn or(self, other: Self) -> Self {
        if other.len < self.len { other } else { self }
    }

    /// CUP, whose parameters are 1 where they are left out.
    fn absolute(column: u16, row: u16) -> Self {
        Self::new(|out| {
            out.extend_from_slice(b"\x1b[");
            if row > 0 {
                push_number(out, row + 1);
            }
            if column > 0 {
                out.push(b';');
                push_number(out, column + 1);
            }
            out.push(b'H');
        })
    }

    /// To the start of this line or one below, then right. Never below the last line: a move does
    /// not scroll.
    fn line(down: u16, column: u16) -> Self {
        Self::new(|out| {
            out.push(b'\r');
            out.extend(std::iter::repeat_n(b'\n', down.into()));
            if column > 0 {
                steps(out, column, b'C');
            }
        })
    }

    /// Along the row.
    fn across(from: u16, to: u16) -> Self {
        if to > from {
            return Self::new(|out| steps(out, to - from, b'C'));
        }
        match from - to {
            back @ 0..4 => Self::new(|out| out.extend(std::iter::repeat_n(b'\x08', back.into()))),
            back => Self::new(|out| steps(out, back, b'D')),
        }
    }

    /// Along the column.
    fn vertical(from: u16, to: u16) -> Self {
        Self::new(|out| if to > from { steps(out, to - from, b'B') } else { steps(out, from - to, b'A') })
    }
}

/// A relative move, whose parameter is 1 where it is left out.
fn steps(out: &mut Vec<u8>, n: u16, direction: u8) {
    out.extend_from_slice(b"\x1b[");
    if n != 1 {
        push_number(out, n);
    }
    out.push(direction);
}
