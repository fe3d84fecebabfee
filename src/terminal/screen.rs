//! What the terminal shows, and the fewest bytes that bring it to what it should show.
//!
//! A frame's text is sent first, and whole where the caller allows that; where not, the cells that answer a key
//! go by themselves before it. Its pictures come after, as many bytes at a time as the caller allows; what was sent is remembered cell by cell, so that a newer frame may take over at any
//! moment. Nothing is sent twice, and a frame that looks like the one before costs no byte.
//!
//! Buffers are ratatui's. [`CellDiffOption`](ratatui::buffer::CellDiffOption)s are not looked at,
//! except for a forced width; control characters are shown as blanks.
//!
//! ```
//! use linden_terminal::{Allowance, Frame, Screen, ScreenOptions};
//! use ratatui::buffer::Buffer;
//! let mut screen = Screen::new(ScreenOptions::default());
//! let buffer = Buffer::with_lines(["linden"]);
//! let frame = Frame { buffer: &buffer, cursor: None, first: &[], late: &[], graphics: &[] };
//! let first = screen.compose(&frame, Allowance::ALL);
//! assert!(first.bytes.starts_with(b"\x1b[m\x1b[2J\x1b[Hlinden") && !first.rest);
//! assert!(screen.compose(&frame, Allowance::ALL).bytes.is_empty());
//! ```

mod encoder;
mod look;
mod plan;

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::Color;

use crate::color::ColorDepth;
use crate::graphics::{Canvas, Graphic, Placement, Protocol};
use encoder::Encoder;
pub(crate) use look::width;
use look::{Look, is_doubtful};
use plan::{Layer, Plan};

/// How a terminal is spoken to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenOptions {
    /// How many colours it shows; with none, bold, reversed and the like stay.
    pub colors: ColorDepth,
    /// Whether it has synchronized output (private mode 2026): a frame appears at once.
    pub synchronized: bool,
    /// Whether erasing takes the pen's background, as nearly all terminals have it (terminfo's `bce`;
    /// GNU screen has not).
    pub erases_in_color: bool,
}

impl Default for ScreenOptions {
    /// 24 bits, erasing in colour, not synchronized.
    fn default() -> Self {
        Self { colors: ColorDepth::True, synchronized: false, erases_in_color: true }
    }
}

/// A picture of the whole screen, to be shown.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The cells. Its area starts at the terminal's upper left.
    pub buffer: &'a Buffer,
    /// Column and row of the cursor, which is hidden without.
    pub cursor: Option<(u16, u16)>,
    /// Areas whose cells come before all others: the row that a key has moved to.
    pub first: &'a [Rect],
    /// Areas whose cells may come later: pictures.
    pub late: &'a [Rect],
    /// Pictures of pixels over some of the cells, side by side. Until one can be shown its cells are.
    pub graphics: &'a [Graphic],
}

/// How many bytes may be sent now beside what comes before all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Of the text.
    pub text: usize,
    /// Of what can be sent piece by piece.
    pub paced: usize,
    /// The largest picture that may be sent in one piece.
    pub atomic: usize,
}

impl Allowance {
    /// Everything.
    pub const ALL: Self = Self { text: usize::MAX, paced: usize::MAX, atomic: usize::MAX };
    /// Text alone.
    pub const NONE: Self = Self { text: usize::MAX, paced: 0, atomic: 0 };
}

/// Bytes to be written in one piece.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Composed {
    /// For the terminal.
    pub bytes: Vec<u8>,
    /// How many of them are pictures'.
    pub picture: usize,
    /// Whether a picture is placed by them, which the terminal answers.
    pub placed: bool,
    /// Whether there is more to send of this frame.
    pub rest: bool,
}

/// What is known of a cell that the terminal shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    /// Nothing.
    No,
    /// It shows the cell of the same place in `shown`.
    Yes,
    /// It is covered by the wide character to its left.
    Covered,
}

/// A terminal's screen, as it is once all that was composed has arrived.
#[derive(Debug)]
pub struct Screen {
    options: ScreenOptions,
    shown: Buffer,
    known: Vec<Known>,
    encoder: Encoder,
    /// Whether the cursor is visible, if that is known.
    cursor: Option<bool>,
    canvas: Canvas,
    /// All must be sent again, from a clear screen.
    invalid: bool,
    /// The row that the last allowance ended in: the next one goes on there, so that frames which
    /// follow each other closely reach the lower rows too.
    resume: u16,
}

/// The longest that one cell can be: a move, two colours of three numbers, modifiers and a
/// character; beyond it there are clusters of many characters, which pictures do not have.
const LONGEST_CELL: usize = 96;

/// A shorter run of blanks is printed.
const SHORTEST_ERASED: u16 = 9;

impl Screen {
    /// A terminal of which nothing is known.
    pub fn new(options: ScreenOptions) -> Self {
        Self {
            options,
            shown: Buffer::empty(Rect::ZERO),
            known: Vec::new(),
            encoder: Encoder::new(),
            cursor: None,
            canvas: Canvas::default(),
            invalid: true,
            resume: 0,
        }
    }

    /// Forgets what the terminal shows (it was resized, or something else has written to it): the next
    /// frame starts from a clear screen.
    pub fn invalidate(&mut self) {
        self.invalid = true;
    }

    /// How the terminal is spoken to from now on. All is sent again if its colours have changed.
    pub fn set_options(&mut self, options: ScreenOptions) {
        self.invalid |= options.colors != self.options.colors;
        self.options = options;
    }

    /// Leaves a plain pen, for bytes that others make and that may set one.
    pub fn put_pen_down(&mut self) -> Vec<u8> {
        let mut out = Vec::new();
        self.encoder.plain(&mut out);
        out
    }

    /// Removes pictures and leaves a plain pen: for the end of the program, before the screen is
    /// given back.
    pub fn farewell(&mut self) -> Vec<u8> {
        let mut out = Vec::new();
        self.canvas.remove_all(&mut out);
        self.encoder.plain(&mut out);
        self.invalid = true;
        out
    }

    /// The bytes that bring the terminal nearer to a frame: all of its text, and of its pictures as
    /// much as is allowed.
    pub fn compose(&mut self, frame: &Frame<'_>, allowance: Allowance) -> Composed {
        let mut cleared = Vec::new();
        if self.invalid || frame.buffer.area != self.shown.area {
            self.clear(frame.buffer.area, &mut cleared);
        }
        // What appears at once.
        let mut out = Vec::new();
        let wanted = self.wanted(frame, allowance.atomic);
        // Commands about pictures stay out of synchronized output.
        let mut bytes = cleared;
        for uncovered in self.canvas.prepare(&wanted, &mut bytes) {
            self.forget(uncovered);
        }
        let plan = Plan::new(frame, &self.canvas.covered(&wanted));
        if self.paint_text(frame.buffer, &plan, allowance.text, &mut out) {
            self.settle_cursor(frame, &mut out);
            self.synchronize(&mut out, &mut bytes);
            return Composed { bytes, picture: 0, placed: false, rest: true };
        }
        let text = out.len();
        let mut rest = self.paint_late(frame.buffer, &plan, allowance.paced, &mut out);
        let mut picture = out.len() - text;
        let mut placed = false;
        let mut atomic = allowance.atomic;
        for graphic in wanted {
            if rest || self.canvas.stands(graphic) || !graphic.data.may_be_sent(atomic) {
                continue;
            }
            let left = allowance.paced.saturating_sub(picture);
            let before = bytes.len() + out.len();
            let (unfinished, is_placed) = self.place(graphic, frame.buffer, left, &mut out, &mut bytes);
            let sent = bytes.len() + out.len() - before;
            (rest, placed) = (unfinished, placed || is_placed);
            picture += sent;
            atomic = atomic.saturating_sub(sent);
        }
        self.settle_cursor(frame, &mut out);
        self.synchronize(&mut out, &mut bytes);
        Composed { bytes, picture, placed, rest }
    }

    /// The pictures of a frame that stand or can be sent now; one that is on its way comes first.
    fn wanted<'a>(&self, frame: &Frame<'a>, atomic: usize) -> Vec<&'a Graphic> {
        let mut wanted: Vec<&Graphic> = frame
            .graphics
            .iter()
            .filter(|graphic| {
                let inside = graphic.area.intersection(frame.buffer.area) == graphic.area;
                let possible = self.canvas.stands(graphic) || graphic.data.may_be_sent(atomic);
                inside && possible && !graphic.area.is_empty() && !self.canvas.has_given_up(graphic)
            })
            .collect();
        wanted.sort_by_key(|graphic| !self.canvas.is_coming(graphic));
        wanted
    }

    /// Moves what was composed to the bytes for the terminal, where it appears at once.
    fn synchronize(&self, out: &mut Vec<u8>, bytes: &mut Vec<u8>) {
        if out.is_empty() {
            return;
        }
        let (begin, end): (&[u8], &[u8]) =
            if self.options.synchronized { (b"\x1b[?2026h", b"\x1b[?2026l") } else { (b"", b"") };
        bytes.extend_from_slice(begin);
        bytes.append(out);
        bytes.extend_from_slice(end);
    }

    /// Takes the terminal's answer to the placement of a picture of kitty's. Whether there is something to send
    /// again.
    pub fn answered(&mut self, id: u32, ok: bool) -> bool {
        self.canvas.answered(id, ok)
    }

    /// All that was composed has been read by the terminal. Whether there is something to send again.
    pub fn is_read(&mut self) -> bool {
        self.canvas.is_read()
    }

    /// Whether the terminal still has to say what became of a picture.
    pub fn awaits(&self) -> bool {
        self.canvas.awaits()
    }

    /// Starts from nothing: outside of synchronized output, in which tmux loses what follows a clear.
    fn clear(&mut self, area: Rect, out: &mut Vec<u8>) {
        self.canvas.remove_all(out);
        out.extend_from_slice(b"\x1b[m\x1b[2J");
        self.encoder = Encoder::new();
        self.cursor = None;
        self.shown = Buffer::empty(area);
        self.known.clear();
        self.known.resize(self.shown.content.len(), Known::Yes);
        self.invalid = false;
        self.resume = 0;
    }

    /// What is shown in an area is no longer known.
    fn forget(&mut self, area: Rect) {
        let area = area.intersection(self.shown.area);
        for row in area.top()..area.bottom() {
            let from = self.shown.index_of(area.x, row);
            self.known[from..from + usize::from(area.width)].fill(Known::No);
        }
    }

    /// Sends what answers a key, and the rest of the text as much as is allowed: when that is not all, after what
    /// answers a key nothing. Whether there is more to send.
    fn paint_text(&mut self, buffer: &Buffer, plan: &Plan, allowed: usize, out: &mut Vec<u8>) -> bool {
        for row in 0..buffer.area.height {
            self.paint_row(buffer, plan, row, Layer::First, usize::MAX, out);
        }
        if !out.is_empty() && allowed < usize::MAX {
            return true;
        }
        let end = out.len().saturating_add(allowed);
        let rest =
            (0..buffer.area.height).find(|row| !self.paint_row(buffer, plan, *row, Layer::Text, end, out));
        rest.is_some()
    }

    /// Whether there is more to send.
    fn paint_late(&mut self, buffer: &Buffer, plan: &Plan, allowed: usize, out: &mut Vec<u8>) -> bool {
        let rows = plan.late_rows.clone();
        if rows.is_empty() {
            return false;
        }
        let end = out.len().saturating_add(allowed);
        let first = if rows.contains(&self.resume) { self.resume } else { rows.start };
        for row in (first..rows.end).chain(rows.start..first) {
            if !self.paint_row(buffer, plan, row, Layer::Late, end, out) {
                self.resume = row;
                return true;
            }
        }
        self.resume = rows.start;
        false
    }

    /// Sends the cells of a row that are of a layer and look otherwise than they should.
    /// Whether it could be finished before the output's end.
    fn paint_row(
        &mut self,
        buffer: &Buffer,
        plan: &Plan,
        row: u16,
        layer: Layer,
        end: usize,
        out: &mut Vec<u8>,
    ) -> bool {
        let columns = buffer.area.width;
        let mut column = 0;
        while column < columns {
            let at = usize::from(row) * usize::from(columns) + usize::from(column);
            let cell = plan.cell(buffer, at);
            let taken = width(cell).clamp(1, columns - column);
            if plan.layers[at] != layer || self.shows(cell, at, taken, columns - column) {
                column += taken;
                continue;
            }
            if out.len().saturating_add(LONGEST_CELL) > end {
                return false;
            }
            let look = Look::of(cell, columns - column, self.options.colors);
            column += match self.blank_run(buffer, plan, look, (column, row), layer) {
                Some(run) => {
                    self.erase(run, (column, row), out);
                    run.cells
                }
                None => self.print(cell, look, (column, row), out),
            };
        }
        true
    }

    /// Whether the terminal shows a cell that takes `taken` columns. A cell that looks the same is
    /// remembered in its newer form.
    fn shows(&mut self, cell: &Cell, at: usize, taken: u16, room: u16) -> bool {
        if self.known[at] != Known::Yes {
            return false;
        }
        let trail = &self.known[at + 1..at + usize::from(taken)];
        let shown = &self.shown.content[at];
        if shown == cell {
            return taken == 1 || width(cell) > room || trail.iter().all(|&known| known == Known::Covered);
        }
        let same = taken == 1
            && width(shown) <= 1
            && Look::of(shown, room, self.options.colors) == Look::of(cell, room, self.options.colors);
        if same {
            self.shown.content[at] = cell.clone();
        }
        same
    }

    /// A run of equal blanks from a cell on that are shorter to erase than to print.
    fn blank_run(
        &self,
        buffer: &Buffer,
        plan: &Plan,
        look: Look<'_>,
        (column, row): (u16, u16),
        layer: Layer,
    ) -> Option<Run> {
        let paper = look.blank_paper()?;
        if paper != Color::Reset && !self.options.erases_in_color {
            return None;
        }
        let columns = buffer.area.width;
        let row_start = usize::from(row) * usize::from(columns);
        let (mut end, mut changed) = (column, column);
        while end < columns {
            let at = row_start + usize::from(end);
            let cell = plan.cell(buffer, at);
            if plan.layers[at] != layer
                || width(cell) > 1
                || Look::of(cell, columns - end, self.options.colors) != look
            {
                break;
            }
            end += 1;
            if self.known[at] != Known::Yes
                || Look::of(&self.shown.content[at], columns - end + 1, self.options.colors) != look
            {
                changed = end;
            }
        }
        let cells = changed - column;
        let to_end = end == columns && cells > 3;
        (to_end || cells >= SHORTEST_ERASED).then_some(Run { cells, to_end, paper })
    }

    fn erase(&mut self, run: Run, (column, row): (u16, u16), out: &mut Vec<u8>) {
        self.encoder.go(out, column, row);
        self.encoder.erase(out, run.paper, (!run.to_end).then_some(run.cells));
        let at = self.shown.index_of(column, row);
        let mut blank = Cell::EMPTY;
        blank.set_bg(run.paper);
        let cells = at..at + usize::from(run.cells);
        self.overwrite(cells.clone());
        self.shown.content[cells].fill(blank);
    }

    /// How many columns the cell takes.
    fn print(&mut self, cell: &Cell, look: Look<'_>, (column, row): (u16, u16), out: &mut Vec<u8>) -> u16 {
        let columns = self.shown.area.width;
        let at = self.shown.index_of(column, row);
        let (taken, doubtful) = match look {
            Look::Text { symbol, .. } if symbol != " " => (width(cell), is_doubtful(symbol)),
            // Also a character that does not fit.
            _ => (1, false),
        };
        if !self.reprint_gap(column, row, out) {
            self.encoder.go(out, column, row);
        }
        if doubtful && taken > 1 {
            // A terminal that takes fewer columns for it shows blanks in the others.
            let blank = Look::of(&Cell::EMPTY, 1, self.options.colors);
            for _ in 0..taken {
                self.encoder.print(out, blank);
            }
            self.encoder.lose_column();
            self.encoder.go(out, column, row);
        }
        self.encoder.print(out, look);
        let cells = at..at + usize::from(taken);
        self.overwrite(cells.clone());
        self.known[cells].fill(Known::Covered);
        self.known[at] = Known::Yes;
        self.shown.content[at] = cell.clone();
        if doubtful {
            self.encoder.lose_column();
        } else {
            self.encoder.advance(taken, columns);
        }
        taken
    }

    /// Prints the few cells between the cursor and a column again where that is shorter than a move.
    fn reprint_gap(&mut self, column: u16, row: u16, out: &mut Vec<u8>) -> bool {
        let Some((from, at_row)) = self.encoder.cursor() else { return false };
        if at_row != row || column <= from || column - from > 3 {
            return false;
        }
        let gap = self.shown.index_of(from, row)..self.shown.index_of(column, row);
        let mut printed = [b' '; 3];
        for (i, at) in gap.clone().enumerate() {
            let look = Look::of(&self.shown.content[at], 1, self.options.colors);
            let symbol = match look {
                Look::Text { symbol, .. } => symbol,
                look if look.blank_paper().is_some() => " ",
                Look::Quarters { .. } => return false,
            };
            match symbol.as_bytes() {
                [byte] if self.known[at] == Known::Yes && self.encoder.fits(look) => printed[i] = *byte,
                _ => return false,
            }
        }
        out.extend_from_slice(&printed[..gap.len()]);
        self.encoder.advance(gap.len() as u16, self.shown.area.width);
        true
    }

    /// Some cells of a row are overwritten. What becomes of the rest of a wide character of which
    /// a part is overwritten is the terminal's choice.
    fn overwrite(&mut self, cells: std::ops::Range<usize>) {
        let columns = usize::from(self.shown.area.width);
        let row = cells.start / columns * columns..cells.start / columns * columns + columns;
        if self.known[cells.start] == Known::Covered {
            for at in (row.start..cells.start).rev() {
                let covered = self.known[at] == Known::Covered;
                self.known[at] = Known::No;
                if !covered {
                    break;
                }
            }
        }
        let covered = |known: &&mut Known| **known == Known::Covered;
        for known in self.known[cells.end..row.end].iter_mut().take_while(covered) {
            *known = Known::No;
        }
        self.known[cells].fill(Known::Yes);
    }

    /// Whether there is more to send of a picture of pixels, and whether it is placed. What was composed before is
    /// moved to `bytes` when something follows that must not be synchronized.
    fn place(
        &mut self,
        graphic: &Graphic,
        buffer: &Buffer,
        allowed: usize,
        out: &mut Vec<u8>,
        bytes: &mut Vec<u8>,
    ) -> (bool, bool) {
        let is_apart = graphic.data.protocol() == Protocol::Kitty;
        let mut pieces = Vec::new();
        let placement = self.canvas.send(graphic, allowed, &mut pieces);
        if !pieces.is_empty() {
            self.synchronize(out, bytes);
            bytes.append(&mut pieces);
        }
        match placement {
            Placement::Standing => (false, false),
            Placement::Unfinished => (true, false),
            Placement::Ready => {
                // Where the picture is transparent, nothing must shine through.
                if self.canvas.needs_fresh_cells(graphic) {
                    self.forget(graphic.area);
                }
                let plan = Plan::beneath(buffer, graphic.area);
                for row in graphic.area.top()..graphic.area.bottom() {
                    self.paint_row(buffer, &plan, row, Layer::Late, usize::MAX, out);
                }
                self.encoder.go(out, graphic.area.x, graphic.area.y);
                if is_apart {
                    self.synchronize(out, bytes);
                    self.canvas.place(graphic, bytes);
                } else {
                    self.canvas.place(graphic, out);
                    self.encoder.lose_cursor();
                }
                (false, is_apart)
            }
        }
    }

    /// Shows or hides the cursor. It is put back where it belongs if anything was written.
    fn settle_cursor(&mut self, frame: &Frame<'_>, out: &mut Vec<u8>) {
        let area = frame.buffer.area;
        let place = frame.cursor.filter(|&(x, y)| x < area.width && y < area.height);
        if let Some((column, row)) = place {
            self.encoder.go(out, column, row);
        }
        if self.cursor != Some(place.is_some()) {
            out.extend_from_slice(if place.is_some() { b"\x1b[?25h" } else { b"\x1b[?25l" });
            self.cursor = Some(place.is_some());
        }
    }
}

/// Bytes that a buffer costs on an empty screen.
pub(crate) fn paint_cost(buffer: &Buffer, colors: ColorDepth) -> usize {
    let mut screen = Screen::new(ScreenOptions { colors, ..ScreenOptions::default() });
    let late = [buffer.area];
    let frame = Frame { buffer, cursor: None, first: &[], late: &late, graphics: &[] };
    screen.compose(&frame, Allowance::ALL).picture
}

/// Blanks of one colour.
#[derive(Clone, Copy)]
struct Run {
    cells: u16,
    /// Whether nothing else follows on the row.
    to_end: bool,
    paper: Color,
}

#[cfg(test)]
#[path = "screen/tests.rs"]
mod tests;
