use std::num::NonZeroU16;

use proptest::prelude::*;
use ratatui::style::{Modifier, Style};

use super::*;

/// What one place of a terminal shows, by vt100's account or by a buffer's.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    symbol: String,
    /// The four quarters of a block, or paper and ink.
    colors: Vec<Color>,
    modifier: Modifier,
}

/// The quarters that a block character inks, from its Unicode name.
fn quarters(symbol: &str) -> Option<[bool; 4]> {
    let inked = match symbol {
        " " => "....",
        "█" => "####",
        "▀" => "##..",
        "▄" => "..##",
        "▌" => "#.#.",
        "▐" => ".#.#",
        "▘" => "#...",
        "▝" => ".#..",
        "▖" => "..#.",
        "▗" => "...#",
        "▚" => "#..#",
        "▞" => ".##.",
        "▛" => "###.",
        "▜" => "##.#",
        "▙" => "#.##",
        "▟" => ".###",
        _ => return None,
    };
    let mut each = inked.chars().map(|c| c == '#');
    Some(std::array::from_fn(|_| each.next().unwrap()))
}

impl Seen {
    fn new(symbol: &str, ink: Color, paper: Color, modifier: Modifier) -> Self {
        // The attributes that vt100 knows; on a blank only some show.
        let mut known = Modifier::REVERSED | Modifier::UNDERLINED;
        if symbol != " " {
            known |= Modifier::BOLD | Modifier::DIM | Modifier::ITALIC;
        }
        let modifier = modifier & known;
        match quarters(symbol) {
            Some(inked) if modifier.is_empty() => Self {
                symbol: "block".to_owned(),
                colors: inked.iter().map(|&inked| if inked { ink } else { paper }).collect(),
                modifier,
            },
            _ => Self { symbol: symbol.to_owned(), colors: vec![paper, ink], modifier },
        }
    }

    fn of_buffer(buffer: &Buffer, colors: ColorDepth) -> Vec<Self> {
        let mut seen = Vec::new();
        for row in 0..buffer.area.height {
            let mut column = 0;
            while column < buffer.area.width {
                let cell = &buffer[(column, row)];
                let wide = unicode_columns(cell.symbol());
                let symbol = if wide > buffer.area.width - column { " " } else { cell.symbol() };
                let (ink, paper) = (colors.map(cell.fg), colors.map(cell.bg));
                seen.push(Self::new(symbol, ink, paper, cell.modifier));
                // The second half of a wide character has no look of its own.
                let rest = if symbol == " " { 0 } else { wide - 1 };
                seen.extend((0..rest).map(|_| Self::second_half()));
                column += 1 + rest;
            }
        }
        seen
    }

    fn second_half() -> Self {
        Self { symbol: String::new(), colors: Vec::new(), modifier: Modifier::empty() }
    }

    fn of_terminal(screen: &vt100::Screen) -> Vec<Self> {
        let (rows, columns) = screen.size();
        let color = |color| match color {
            vt100::Color::Default => Color::Reset,
            vt100::Color::Idx(i) => Color::Indexed(i),
            vt100::Color::Rgb(r, g, b) => Color::Rgb(r, g, b),
        };
        (0..rows.get())
            .flat_map(|row| (0..columns.get()).map(move |column| (row, column)))
            .map(|(row, column)| {
                let cell = screen.cell(row, column).unwrap();
                if cell.is_wide_continuation() {
                    return Self::second_half();
                }
                let flags = [
                    (cell.bold(), Modifier::BOLD),
                    (cell.dim(), Modifier::DIM),
                    (cell.italic(), Modifier::ITALIC),
                    (cell.underline(), Modifier::UNDERLINED),
                    (cell.inverse(), Modifier::REVERSED),
                ];
                let modifier = flags.into_iter().filter(|(set, _)| *set).map(|(_, flag)| flag).collect();
                let symbol = if cell.has_contents() { cell.contents() } else { " " };
                Self::new(symbol, color(cell.fgcolor()), color(cell.bgcolor()), modifier)
            })
            .collect()
    }
}

/// For the symbols of these tests.
fn unicode_columns(symbol: &str) -> u16 {
    if ["木", "林", "🌲", "⌨\u{fe0f}"].contains(&symbol) { 2 } else { 1 }
}

/// vt100 with a screen of ours before it.
struct Rig {
    screen: Screen,
    terminal: vt100::Parser,
    colors: ColorDepth,
}

impl Rig {
    fn new(columns: u16, rows: u16, options: ScreenOptions) -> Self {
        let of = |n| NonZeroU16::new(n).unwrap();
        let mut terminal = vt100::Parser::new(of(rows), of(columns), 0);
        // What another program has left there.
        terminal.process("\x1b[31;45mjunk木".as_bytes());
        Self { screen: Screen::new(options), terminal, colors: options.colors }
    }

    fn resize(&mut self, columns: u16, rows: u16) {
        let of = |n| NonZeroU16::new(n).unwrap();
        self.terminal.set_size(of(rows), of(columns));
    }

    fn show(&mut self, buffer: &Buffer, late: &[Rect], paced: usize) -> Composed {
        let frame = Frame { buffer, cursor: None, first: &[], late, graphics: &[] };
        let composed = self.screen.compose(&frame, Allowance { text: usize::MAX, paced, atomic: 0 });
        self.terminal.process(&composed.bytes);
        composed
    }

    fn seen(&self) -> Vec<Seen> {
        Seen::of_terminal(self.terminal.screen())
    }

    fn assert_shows(&self, buffer: &Buffer) {
        let (found, wanted) = (self.seen(), Seen::of_buffer(buffer, self.colors));
        for (at, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            let width = usize::from(buffer.area.width);
            assert_eq!(found, wanted, "column {}, row {}", at % width, at / width);
        }
        assert_eq!(found.len(), wanted.len());
    }
}

fn color() -> impl Strategy<Value = Color> {
    prop_oneof![
        2 => Just(Color::Reset),
        1 => Just(Color::LightBlue),
        1 => Just(Color::Indexed(3)),
        1 => Just(Color::Indexed(200)),
        2 => (0..3_u8, 0..2_u8).prop_map(|(r, b)| Color::Rgb(r * 100, 40, b * 99)),
    ]
}

/// A stroke of equal cells.
fn stroke() -> impl Strategy<Value = (u16, u16, u16, &'static str, Color, Color, Modifier)> {
    let symbols = prop::sample::select(vec![
        " ",
        " ",
        " ",
        "a",
        "b",
        "Z",
        "é",
        "木",
        "林",
        "🌲",
        "⌨\u{fe0f}",
        "▀",
        "▄",
        "█",
        "▚",
        "▟",
        "⣿",
    ]);
    let modifiers = prop::sample::select(vec![
        Modifier::empty(),
        Modifier::empty(),
        Modifier::BOLD,
        Modifier::DIM,
        Modifier::ITALIC | Modifier::UNDERLINED,
        Modifier::REVERSED,
        Modifier::REVERSED | Modifier::BOLD,
    ]);
    (0..40_u16, 0..12_u16, 1..45_u16, symbols, color(), color(), modifiers)
}

#[derive(Clone, Debug)]
struct Step {
    size: Option<(u16, u16)>,
    strokes: Vec<(u16, u16, u16, &'static str, Color, Color, Modifier)>,
    late: Vec<Rect>,
    paced: usize,
    invalidate: bool,
    fresh: bool,
}

fn step() -> impl Strategy<Value = Step> {
    let rect = (0..30_u16, 0..10_u16, 0..40_u16, 0..12_u16).prop_map(|(x, y, w, h)| Rect::new(x, y, w, h));
    (
        prop::option::weighted(0.15, (1..40_u16, 1..12_u16)),
        prop::collection::vec(stroke(), 0..12),
        prop::collection::vec(rect, 0..3),
        prop_oneof![Just(0_usize), 0..600_usize, Just(usize::MAX)],
        prop::bool::weighted(0.05),
        prop::bool::weighted(0.2),
    )
        .prop_map(|(size, strokes, late, paced, invalidate, fresh)| Step {
            size,
            strokes,
            late,
            paced,
            invalidate,
            fresh,
        })
}

fn draw(buffer: &mut Buffer, step: &Step) {
    for &(x, y, n, symbol, ink, paper, modifier) in &step.strokes {
        let style = Style::new().fg(ink).bg(paper).add_modifier(modifier);
        let mut column = x;
        for _ in 0..n {
            if y < buffer.area.height && column < buffer.area.width {
                // As widgets do: a wide character resets the cell it covers.
                buffer.set_stringn(column, y, symbol, 2, style);
                buffer[(column, y)].modifier = modifier;
                if buffer[(column, y)].symbol() != symbol {
                    buffer[(column, y)].set_symbol(symbol).set_style(style);
                }
                // The character whose second half this was is gone.
                if column > 0 && unicode_columns(buffer[(column - 1, y)].symbol()) == 2 {
                    buffer[(column - 1, y)].set_symbol(" ");
                }
            }
            column += unicode_columns(symbol);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the sequence of frames and allowances, the terminal shows the last one, and at no
    /// moment a text that is not the newest.
    #[test]
    fn the_terminal_shows_the_frame(
        size in (1..40_u16, 1..12_u16),
        depth in 0..4_usize,
        synchronized: bool,
        erases_in_color: bool,
        steps in prop::collection::vec(step(), 1..8),
    ) {
        let colors = [ColorDepth::None, ColorDepth::Ansi16, ColorDepth::Ansi256, ColorDepth::True][depth];
        let mut rig = Rig::new(size.0, size.1, ScreenOptions { colors, synchronized, erases_in_color });
        let mut buffer = Buffer::empty(Rect::new(0, 0, size.0, size.1));
        for step in &steps {
            if let Some((columns, rows)) = step.size {
                rig.resize(columns, rows);
                buffer = Buffer::empty(Rect::new(0, 0, columns, rows));
            }
            if step.invalidate {
                rig.terminal.process(b"\x1b[3;2Hsomething else\x1b[44m");
                rig.screen.invalidate();
            }
            if step.fresh {
                buffer.reset();
            }
            draw(&mut buffer, step);
            let composed = rig.show(&buffer, &step.late, step.paced);
            prop_assert!(composed.picture <= step.paced);
            if composed.rest {
                let (found, wanted) = (rig.seen(), Seen::of_buffer(&buffer, colors));
                for (at, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                    let (x, y) = (at as u16 % buffer.area.width, at as u16 / buffer.area.width);
                    let near_late = step.late.iter().any(|r| {
                        (x.saturating_sub(1)..=x + 1).any(|x| r.contains((x, y).into()))
                    });
                    prop_assert!(near_late || found == wanted, "text at {x}, {y}: {found:?} {wanted:?}");
                }
            } else {
                rig.assert_shows(&buffer);
            }
            prop_assert!(rig.terminal.screen().hide_cursor());
        }
        rig.show(&buffer, &[], usize::MAX);
        rig.assert_shows(&buffer);
        prop_assert!(rig.show(&buffer, &[], usize::MAX).bytes.is_empty(), "an unchanged frame costs nothing");
    }
}

fn options(colors: ColorDepth) -> ScreenOptions {
    ScreenOptions { colors, ..ScreenOptions::default() }
}

/// 120×40: borders, a list of which one row is chosen, a picture's place.
fn workbench(chosen: u16) -> Buffer {
    let mut buffer = Buffer::empty(Rect::new(0, 0, 120, 40));
    for row in 0..40 {
        buffer.set_string(28, row, "│", Style::new().fg(Color::Rgb(80, 80, 90)));
    }
    for row in 0..30_u16 {
        let mut style = Style::new().fg(Color::Rgb(200, 200, 190));
        if row == chosen {
            style = Style::new()
                .fg(Color::Rgb(20, 20, 20))
                .bg(Color::Rgb(150, 200, 120))
                .add_modifier(Modifier::BOLD);
        }
        buffer.set_string(1, row + 2, format!("{:<26}", format!("preset number {row}")), style);
    }
    buffer
}

#[test]
fn a_list_move_is_cheap() {
    for colors in [ColorDepth::True, ColorDepth::Ansi256, ColorDepth::Ansi16] {
        let mut rig = Rig::new(120, 40, options(colors));
        rig.show(&workbench(3), &[], usize::MAX);
        let bytes = rig.show(&workbench(4), &[], usize::MAX).bytes;
        rig.assert_shows(&workbench(4));
        assert!(bytes.len() <= 150, "{colors:?}: {} {:?}", bytes.len(), String::from_utf8_lossy(&bytes));
    }
}

#[test]
fn text_comes_first_and_pictures_go_on_where_they_were() {
    let late = [Rect::new(0, 0, 10, 12)];
    let frame = |symbol: &str| {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 20, 12));
        for row in 0..12 {
            buffer.set_string(0, row, symbol.repeat(10), Style::new());
        }
        buffer.set_string(12, 11, "text", Style::new());
        buffer
    };
    let mut rig = Rig::new(20, 12, options(ColorDepth::True));
    let first = rig.show(&frame("x"), &late, 0);
    assert!(first.rest && first.picture == 0);
    assert!(String::from_utf8_lossy(&first.bytes).contains("text"));
    // Ever newer frames: each row is reached all the same.
    let mut reached = [false; 12];
    for symbol in ["a", "b", "c", "d", "e", "f", "g", "h"].repeat(3) {
        rig.show(&frame(symbol), &late, 130);
        let screen = rig.terminal.screen();
        for (row, reached) in reached.iter_mut().enumerate() {
            *reached |= screen.cell(row as u16, 0).unwrap().has_contents();
        }
    }
    assert_eq!(reached, [true; 12]);
}

#[test]
fn nothing_is_cleared_inside_synchronized_output() {
    let mut rig = Rig::new(20, 3, ScreenOptions { synchronized: true, ..ScreenOptions::default() });
    let mut buffer = Buffer::with_lines(["one", "two", "three"]);
    buffer.resize(Rect::new(0, 0, 20, 3));
    for _ in 0..2 {
        rig.screen.invalidate();
        let bytes = rig.show(&buffer, &[], usize::MAX).bytes;
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("\x1b[m\x1b[2J\x1b[?2026h"), "{text:?}");
        assert!(text.ends_with("\x1b[?2026l") && text.matches("\x1b[2J").count() == 1);
    }
    assert!(rig.show(&buffer, &[], usize::MAX).bytes.is_empty());
}

#[test]
fn the_cursor_is_shown_where_it_is_wanted() {
    let mut rig = Rig::new(20, 3, ScreenOptions::default());
    let buffer = Buffer::empty(Rect::new(0, 0, 20, 3));
    let mut at = |cursor| {
        let frame = Frame { buffer: &buffer, cursor, first: &[], late: &[], graphics: &[] };
        let bytes = rig.screen.compose(&frame, Allowance::ALL).bytes;
        rig.terminal.process(&bytes);
        let screen = rig.terminal.screen();
        (bytes.len(), (!screen.hide_cursor()).then_some(screen.cursor_position()))
    };
    assert_eq!(at(Some((7, 2))).1, Some((2, 7)));
    assert_eq!(at(Some((7, 2))), (0, Some((2, 7))));
    assert_eq!(at(Some((8, 2))), (3, Some((2, 8))));
    assert_eq!(at(None).1, None);
    assert_eq!(at(Some((99, 2))).1, None, "outside it is hidden");
}

#[test]
fn without_colours_none_is_said() {
    let mut rig = Rig::new(120, 40, options(ColorDepth::None));
    let bytes = rig.show(&workbench(3), &[], usize::MAX).bytes;
    let text = String::from_utf8(bytes).unwrap();
    for sequence in text.split('\x1b').filter_map(|s| s.split_once('m')).map(|(s, _)| s) {
        let codes = sequence.trim_start_matches('[').split(';').map(|n| n.parse::<u16>().unwrap_or(0));
        assert!(codes.clone().all(|n| n < 30), "{sequence:?}");
    }
    assert!(text.contains("\x1b[1m"), "bold stays");
}

#[test]
fn clusters_of_which_the_width_is_doubtful_do_not_shift_their_row() {
    // A terminal that takes one column for a family, and one that takes two, show what follows in place.
    let mut buffer = Buffer::empty(Rect::new(0, 0, 20, 1));
    buffer.set_string(2, 0, "⌨\u{fe0f}after", Style::new());
    let mut rig = Rig::new(20, 1, ScreenOptions::default());
    let bytes = rig.show(&buffer, &[], usize::MAX).bytes;
    rig.assert_shows(&buffer);
    let text = String::from_utf8(bytes).unwrap();
    let after = text.split_once('\u{fe0f}').unwrap().1;
    assert!(after.starts_with("\r\x1b[4Cafter") || after.starts_with("\x1b[;5Hafter"), "{after:?}");
}

#[test]
fn on_a_slow_link_the_answer_to_a_key_goes_alone_and_before_the_text() {
    let mut rig = Rig::new(40, 6, ScreenOptions::default());
    let screen = |cursor: u16, about: &str| {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 40, 6));
        for row in 0..5 {
            let style = if row == cursor { Style::new().bg(Color::Blue) } else { Style::new() };
            buffer.set_string(0, row, format!("row {row}     "), style);
            buffer.set_string(12, row, format!("{about} of row {cursor}"), Style::new());
        }
        buffer
    };
    rig.show(&screen(1, "something"), &[], 0);
    let after = screen(2, "something else is told");
    let first = [Rect::new(0, 1, 10, 3)];
    let frame = Frame { buffer: &after, cursor: None, first: &first, late: &[], graphics: &[] };
    let mut writes = Vec::new();
    for _ in 0..20 {
        let composed = rig.screen.compose(&frame, Allowance { text: 160, paced: 0, atomic: 0 });
        rig.terminal.process(&composed.bytes);
        writes.push(composed.bytes.len());
        if writes.len() == 1 {
            let screen = rig.terminal.screen();
            assert_eq!(screen.cell(2, 0).unwrap().bgcolor(), vt100::Color::Idx(4), "the cursor is there");
            assert!(!screen.contents().contains("else"), "and nothing else yet");
        }
        if !composed.rest {
            break;
        }
    }
    assert!(writes[0] < 60, "{writes:?}");
    assert!(writes.len() > 2 && writes.iter().all(|bytes| *bytes <= 160 + 20), "{writes:?}");
    rig.assert_shows(&after);
    // Where all may be sent, it goes together.
    let composed = rig.screen.compose(
        &Frame { buffer: &screen(3, "more"), cursor: None, first: &first, late: &[], graphics: &[] },
        Allowance::NONE,
    );
    assert!(!composed.rest);
}
