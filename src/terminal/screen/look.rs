//! What a cell looks like: two cells that look the same need no bytes between them.

use ratatui::buffer::{Cell, CellWidth};
use ratatui::style::{Color, Modifier};

use crate::color::{ColorDepth, is_bright};

/// The characters that are a cell's quarters: bit 0 is the upper left, bit 3 the lower right.
pub(crate) const QUADRANTS: [&str; 16] =
    [" ", "▘", "▝", "▀", "▖", "▌", "▞", "▛", "▗", "▚", "▐", "▜", "▄", "▙", "▟", "█"];

/// All four quarters.
const FULL: u8 = 15;

/// Modifiers that show where there is no ink.
const VISIBLE_ON_BLANK: Modifier = Modifier::REVERSED
    .union(Modifier::UNDERLINED)
    .union(Modifier::SLOW_BLINK)
    .union(Modifier::RAPID_BLINK)
    .union(Modifier::CROSSED_OUT);

/// A cell as it is seen, in a terminal's own colours. Equal looks are the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look<'a> {
    /// Quarters in two colours. `None` is a colour that nothing has. Where both can be exchanged,
    /// the upper left quarter has the paper, so that a look has one form; a bright one of the 16 is ink.
    Quarters { drawn: u8, ink: Option<Color>, paper: Option<Color> },
    /// Anything else.
    Text { symbol: &'a str, ink: Color, paper: Color, underline: Color, modifier: Modifier },
}

impl<'a> Look<'a> {
    /// How a cell looks on a terminal with these colours.
    pub fn of(cell: &'a Cell, room: u16, colors: ColorDepth) -> Self {
        let symbol = symbol(cell, room);
        let quadrant = quadrant(symbol);
        let modifier = if quadrant == Some(0) { cell.modifier & VISIBLE_ON_BLANK } else { cell.modifier };
        let (ink, paper) = (colors.map(cell.fg), colors.map(cell.bg));
        if modifier.is_empty()
            && let Some(drawn) = quadrant
        {
            return Self::quarters(drawn, ink, paper);
        }
        let underline = if modifier.contains(Modifier::UNDERLINED) && colors >= ColorDepth::Ansi256 {
            colors.map(cell.underline_color)
        } else {
            Color::Reset
        };
        Self::Text { symbol, ink, paper, underline, modifier }
    }

    fn quarters(drawn: u8, ink: Color, paper: Color) -> Self {
        let is_reset = |color: Color| color == Color::Reset;
        match drawn {
            0 => Self::blank(paper),
            _ if ink == paper && !is_reset(ink) => Self::blank(paper),
            FULL if !is_reset(ink) && !is_bright(ink) => Self::blank(ink),
            FULL => Self::Quarters { drawn, ink: Some(ink), paper: None },
            _ if !is_reset(ink) && !is_reset(paper) && turns(drawn, ink, paper) => {
                Self::Quarters { drawn: FULL & !drawn, ink: Some(paper), paper: Some(ink) }
            }
            _ => Self::Quarters { drawn, ink: Some(ink), paper: Some(paper) },
        }
    }

    /// Nothing but paper.
    pub const fn blank(paper: Color) -> Self {
        Self::Quarters { drawn: 0, ink: None, paper: Some(paper) }
    }

    /// The same picture with ink and paper exchanged, where a terminal can show it so: its own
    /// foreground is no paper, its own background no ink, and a bright one of the 16 is not sure to be paper.
    pub fn exchanged(self) -> Option<Self> {
        let Self::Quarters { drawn, ink, paper } = self else { return None };
        let known = |color: Option<Color>| color != Some(Color::Reset);
        let stays = ink.is_some_and(is_bright);
        (known(ink) && known(paper) && !stays).then_some(Self::Quarters {
            drawn: FULL & !drawn,
            ink: paper,
            paper: ink,
        })
    }

    /// The paper, if there is nothing else.
    pub fn blank_paper(self) -> Option<Color> {
        match self {
            Self::Quarters { drawn: 0, paper, .. } => paper,
            _ => None,
        }
    }
}

/// Whether what is drawn takes its one form by exchanging ink and paper.
fn turns(drawn: u8, ink: Color, paper: Color) -> bool {
    match (is_bright(ink), is_bright(paper)) {
        (true, false) => false,
        (false, true) => true,
        _ => drawn & 1 == 1,
    }
}

/// Which quarters a symbol draws: the inverse of [`QUADRANTS`], by its bytes.
fn quadrant(symbol: &str) -> Option<u8> {
    // U+2596 to U+259F.
    const CORNERS: [u8; 10] = [4, 8, 1, 13, 9, 7, 11, 2, 6, 14];
    match *symbol.as_bytes() {
        [b' '] => Some(0),
        [0xe2, 0x96, last] => match last {
            0x80 => Some(3),
            0x84 => Some(12),
            0x88 => Some(FULL),
            0x8c => Some(5),
            0x90 => Some(10),
            0x96..=0x9f => Some(CORNERS[usize::from(last - 0x96)]),
            _ => None,
        },
        _ => None,
    }
}

/// What is printed for a cell, in at most `room` columns: nothing that could be a command to the
/// terminal, and nothing that would run over the edge.
fn symbol(cell: &Cell, room: u16) -> &str {
    if (1..=room).contains(&width(cell)) { cell.symbol() } else { " " }
}

/// Columns that a cell's symbol takes: 0 for what cannot be printed.
pub(crate) fn width(cell: &Cell) -> u16 {
    let symbol = cell.symbol();
    match symbol.as_bytes() {
        [] => 0,
        [byte] => u16::from(!byte.is_ascii_control()),
        // Blocks, lines and braille, which pictures are made of: U+2500..U+259F, U+2800..U+28FF.
        [0xe2, 0x94..=0x96 | 0xa0..=0xa3, _] => 1,
        _ if symbol.chars().any(char::is_control) => 0,
        _ => cell.cell_width(),
    }
}

/// Whether terminals disagree about the columns that a symbol takes: sequences of several characters.
pub(crate) fn is_doubtful(symbol: &str) -> bool {
    symbol.chars().nth(1).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(symbol: &'static str, ink: Color, paper: Color) -> Look<'static> {
        let cell = Box::leak(Box::new(Cell::new(symbol)));
        cell.set_fg(ink).set_bg(paper);
        Look::of(cell, 2, ColorDepth::True)
    }

    #[test]
    fn the_same_picture_has_one_look() {
        let (a, b) = (Color::Rgb(1, 2, 3), Color::Rgb(4, 5, 6));
        assert_eq!(look("▀", a, b), look("▄", b, a));
        assert_eq!(look("▛", a, b), look("▗", b, a));
        assert_eq!(look("█", a, b), look(" ", b, a));
        assert_eq!(look("▚", a, a), look(" ", b, a));
        assert_eq!(look("█", a, b).exchanged().and_then(Look::exchanged), Some(look(" ", b, a)));
    }

    #[test]
    fn quadrants_are_found_by_their_bytes() {
        for (drawn, symbol) in QUADRANTS.into_iter().enumerate() {
            assert_eq!(quadrant(symbol), Some(drawn as u8), "{symbol}");
        }
        assert!(["a", "▁", "▏", "▒", "■", "木"].iter().all(|other| quadrant(other).is_none()));
    }

    #[test]
    fn the_terminals_own_colours_are_not_exchanged() {
        let a = Color::Rgb(1, 2, 3);
        assert_ne!(look("▀", a, Color::Reset), look("▄", Color::Reset, a));
        assert_ne!(look("█", Color::Reset, a), look(" ", a, Color::Reset));
        assert_eq!(look("▀", a, Color::Reset).exchanged(), None);
    }

    #[test]
    fn bright_ones_of_the_16_are_ink() {
        let (bright, dark) = (Color::Indexed(10), Color::Indexed(2));
        let drawn = Look::Quarters { drawn: 1, ink: Some(bright), paper: Some(dark) };
        assert_eq!((look("▘", bright, dark), look("▟", dark, bright)), (drawn, drawn));
        assert_eq!(drawn.exchanged(), None);
        let full = look("█", bright, dark);
        assert_eq!(full, Look::Quarters { drawn: FULL, ink: Some(bright), paper: None });
        assert_eq!(full.exchanged(), None);
    }

    #[test]
    fn commands_to_the_terminal_are_blank() {
        for bad in ["\u{1b}", "\u{7f}", "\n", "\u{9b}", "a\u{1b}[2J", "", "\u{301}"] {
            let mut cell = Cell::EMPTY;
            cell.set_symbol(bad);
            assert_eq!(Look::of(&cell, 2, ColorDepth::True), Look::blank(Color::Reset), "{bad:?}");
        }
    }
}
