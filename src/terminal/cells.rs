//! Pictures made of characters: RGBA pixels → a grid of cells → text, or a part of a screen.
//!
//! A cell of text has two colours, ink and paper, and a character that says which part has which.
//! For each cell the split with the least error in linear light is taken. Where the picture is
//! transparent no paper is set: the terminal's own background stays.
//!
//! ```
//! use linden_terminal::{CellStyle, ColorDepth, Glyphs, Image, draw_cells};
//! let red_over_nothing = [255, 0, 0, 255, 0, 0, 0, 0];
//! let image = Image::new(1, 2, &red_over_nothing).unwrap();
//! let style = CellStyle { glyphs: Glyphs::Halves, colors: ColorDepth::True, ..CellStyle::default() };
//! assert_eq!(draw_cells(&image, 1, 1, &style), "\u{1b}[38;2;255;0;0m▀\u{1b}[0m\n");
//! ```

mod dither;
mod settle;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};

use crate::color::{ColorDepth, push_color};
use crate::grid::{Image, Light, bytes, decode, encode};
use crate::screen::paint_cost;
use dither::Dither;
use settle::{Level, Nearest, Rows, settle};

/// Which characters a picture is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glyphs {
    /// 2×2 parts per cell: the default, and most fonts have them.
    #[default]
    Quadrants,
    /// 1×2 parts per cell: `▀` and `▄`, in every font.
    Halves,
    /// 2×4 dots per cell, one colour: what there is without colours.
    Braille,
    /// Letters and signs, the more of a cell is drawn the darker: what there is without Unicode.
    Ascii,
}

impl Glyphs {
    /// Parts per cell, across and down.
    pub const fn parts(self) -> (u16, u16) {
        match self {
            Self::Quadrants => (2, 2),
            Self::Halves => (1, 2),
            Self::Braille | Self::Ascii => (2, 4),
        }
    }
}

/// How cells are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStyle {
    /// Which characters.
    pub glyphs: Glyphs,
    /// How many colours.
    pub colors: ColorDepth,
    /// What the terminal's background is taken to be (sRGB): translucent pixels are blended with it,
    /// and without colours what differs from it is drawn.
    pub background: [u8; 3],
}

impl CellStyle {
    /// Whether cells have one colour, over the terminal's own background.
    fn is_monochrome(self) -> bool {
        self.colors == ColorDepth::None || matches!(self.glyphs, Glyphs::Braille | Glyphs::Ascii)
    }
}

impl Default for CellStyle {
    /// Quadrants in 24 bits on a dark terminal.
    fn default() -> Self {
        Self { glyphs: Glyphs::Quadrants, colors: ColorDepth::True, background: [16, 16, 18] }
    }
}

/// The size of a picture with square pixels for an area of cells whose width is `cell_aspect` times
/// their height: no character shows more than that.
pub fn square_pixels(columns: u16, rows: u16, cell_aspect: f32) -> (u32, u32) {
    let width = u32::from(columns) * 2;
    let height = (f32::from(rows) * 2.0 / cell_aspect.clamp(0.1, 10.0) + 0.5) as u32;
    (width.max(1), height.max(1))
}

/// Draws a picture into `columns × rows` cells, whatever its size: each part of a cell shows the
/// mean of the pixels beneath it.
///
/// One line per row, each ended by a newline. A line with colours ends with a reset; empty cells at
/// its end are left out. Equal neighbours repeat no escape sequence. With [`ColorDepth::None`] there
/// is none at all, and the parts that are drawn are those that differ from the background.
pub fn draw_cells(image: &Image, columns: u16, rows: u16, style: &CellStyle) -> String {
    let seen = Seen::of(image, columns, rows, *style);
    CellPicture {
        columns,
        rows,
        cells: settle(&seen, &mut Nearest::new(style.colors), *style, Level::FINE, Rows::Apart),
        tolerance: Level::FINE.tolerance,
    }
    .text()
}

/// One cell of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureCell {
    /// The character in it.
    pub character: char,
    /// The character's colour; `None` where it does not show.
    pub ink: Option<Color>,
    /// The colour behind it, [`Color::Reset`] for the terminal's own; `None` where it does not show.
    pub paper: Option<Color>,
}

/// A picture as cells, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellPicture {
    columns: u16,
    rows: u16,
    cells: Vec<PictureCell>,
    tolerance: u8,
}

impl CellPicture {
    /// Draws a picture into `columns × rows` cells, whatever its size: each part of a cell shows the
    /// mean of the pixels beneath it.
    ///
    /// Colours that no eye tells apart are made the same where that saves bytes. If painting the
    /// cells on an empty screen takes more than `budget` bytes, colours that differ more are made
    /// the same too, as little as must be; and at last details are left out, so that a picture of
    /// 400×120 cells still fits into 16 KB.
    pub fn draw(image: &Image, columns: u16, rows: u16, style: &CellStyle, budget: usize) -> Self {
        let seen = Seen::of(image, columns, rows, *style);
        let mut nearest = Nearest::new(style.colors);
        let mut at = |level: Level| {
            let cells = settle(&seen, &mut nearest, *style, level, Rows::Joined);
            Self { columns, rows, cells, tolerance: level.tolerance }
        };
        let fits = |picture: &Self| paint_cost(&picture.buffer(), style.colors) <= budget;
        let fine = at(Level::FINE);
        if budget >= fine.cells.len() * MOST_PER_CELL || fits(&fine) {
            return fine;
        }
        // The least level that fits, between one that does not and one that does, or is the last.
        let (mut over, mut best) = (0, None);
        let mut under = Level::LADDER.len() - 1;
        while under - over > 1 {
            let middle = usize::midpoint(over, under);
            let picture = at(Level::LADDER[middle]);
            if fits(&picture) {
                (under, best) = (middle, Some(picture));
            } else {
                over = middle;
            }
        }
        best.unwrap_or_else(|| at(Level::LADDER[under]))
    }

    /// Cells across.
    pub const fn columns(&self) -> u16 {
        self.columns
    }

    /// Cells down.
    pub const fn rows(&self) -> u16 {
        self.rows
    }

    /// The cells, row by row from the top.
    pub fn cells(&self) -> &[PictureCell] {
        &self.cells
    }

    /// Steps of a channel by which neighbours may differ and were still given one colour.
    pub const fn tolerance(&self) -> u8 {
        self.tolerance
    }

    /// Puts the picture into an area, from its upper left; what does not fit is left out, and cells
    /// that the picture has not are left as they are.
    pub fn put(&self, buffer: &mut Buffer, area: Rect) {
        let inside = area.intersection(buffer.area);
        for row in inside.top()..inside.bottom().min(area.y.saturating_add(self.rows)) {
            for column in inside.left()..inside.right().min(area.x.saturating_add(self.columns)) {
                let at = usize::from(row - area.y) * usize::from(self.columns) + usize::from(column - area.x);
                let cell = self.cells[at];
                let shown = &mut buffer[(column, row)];
                shown.reset();
                shown.set_char(cell.character);
                shown.set_fg(cell.ink.unwrap_or(Color::Reset)).set_bg(cell.paper.unwrap_or(Color::Reset));
                shown.modifier = Modifier::empty();
            }
        }
    }

    fn buffer(&self) -> Buffer {
        let area = Rect::new(0, 0, self.columns, self.rows);
        let mut buffer = Buffer::empty(area);
        self.put(&mut buffer, area);
        buffer
    }

    /// As [`draw_cells`] gives it.
    fn text(&self) -> String {
        let mut out = Vec::with_capacity(self.cells.len() * 10);
        for row in self.cells.chunks(usize::from(self.columns).max(1)) {
            let (mut ink, mut paper) = (Color::Reset, Color::Reset);
            let end = row.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
            for cell in &row[..end] {
                let new_ink = cell.ink.filter(|&c| c != ink);
                let new_paper = cell.paper.filter(|&c| c != paper);
                if new_ink.is_some() || new_paper.is_some() {
                    out.extend_from_slice(b"\x1b[");
                    if let Some(color) = new_ink {
                        ink = color;
                        push_color(&mut out, color, 30);
                    }
                    if let Some(color) = new_paper {
                        if new_ink.is_some() {
                            out.push(b';');
                        }
                        paper = color;
                        push_color(&mut out, color, 40);
                    }
                    out.push(b'm');
                }
                out.extend_from_slice(cell.character.encode_utf8(&mut [0; 4]).as_bytes());
            }
            if ink != Color::Reset || paper != Color::Reset {
                out.extend_from_slice(b"\x1b[0m");
            }
            out.push(b'\n');
        }
        if self.columns == 0 {
            out.resize(usize::from(self.rows), b'\n');
        }
        String::from_utf8(out).unwrap_or_default()
    }
}

impl PictureCell {
    /// A cell that nothing is drawn in.
    const EMPTY: Self = Self { character: ' ', ink: None, paper: Some(Color::Reset) };

    fn is_empty(self) -> bool {
        self == Self::EMPTY
    }
}

/// Bytes that a picture may cost that is followed by a better one soon.
pub const DRAFT_BUDGET: usize = 16 << 10;

/// Bytes that a picture may cost that stays: what no eye can tell from more, and at most 100 KB.
pub const fn full_budget(columns: u16, rows: u16) -> usize {
    // 19.6 KB for 64×36 cells.
    let bytes = columns as usize * rows as usize * 17 / 2;
    if bytes < 100 << 10 { bytes } else { 100 << 10 }
}

/// No cell costs more: two colours of three numbers, a character of three bytes, and a move.
const MOST_PER_CELL: usize = 52;

/// A picture's cells before their colours are made those of a terminal.
struct Seen {
    columns: usize,
    splits: Vec<Split>,
}

impl Seen {
    fn of(image: &Image, columns: u16, rows: u16, style: CellStyle) -> Self {
        let (across, down) = style.glyphs.parts();
        let (across, down) = (usize::from(across), usize::from(down));
        let (columns, rows) = (usize::from(columns), usize::from(rows));
        let parts = image.averaged(columns * across, rows * down);
        let behind = style.background.map(|c| decode(f32::from(c) / 255.0));
        let monochrome = style.is_monochrome();
        let ink = if monochrome { inked(&parts, columns * across, behind) } else { Vec::new() };

        let mut dither = Dither::new(style.colors);

        let mut splits = Vec::with_capacity(columns * rows);
        let mut cell = Vec::with_capacity(across * down);
        for row in 0..rows {
            for column in 0..columns {
                let places = (0..across * down)
                    .map(|i| (row * down + i / across) * columns * across + column * across + i % across);
                cell.clear();
                cell.extend(places.clone().map(|at| parts[at]));
                splits.push(if monochrome {
                    let drawn = places.enumerate().fold(0, |drawn, (i, at)| drawn | u32::from(ink[at]) << i);
                    let light = mean(&cell, drawn, behind);
                    let ink = dither
                        .as_mut()
                        .map_or_else(|| bytes(light), |few| few.one(light, behind, (column, row)));
                    Split { drawn, ink, paper: None }
                } else if let Some(few) = &mut dither {
                    few.split(&cell, behind, (column, row))
                } else {
                    split(&cell, behind)
                });
            }
        }
        Self { columns, splits }
    }
}

/// Fainter than this a part counts as transparent.
const TRANSPARENT: f32 = 0.05;

/// The best ink and paper of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Split {
    /// Bit i is set where part i has ink.
    drawn: u32,
    /// sRGB.
    ink: [u8; 3],
    /// sRGB; `None` for the terminal's own background.
    paper: Option<[u8; 3]>,
}

/// Tries all ways to give parts ink or paper; each colour is the mean of its parts, which makes the
/// squared error least.
fn split(cell: &[Light], behind: [f32; 3]) -> Split {
    let see_through = cell.iter().any(|part| part.alpha < TRANSPARENT);
    let all = (1_u32 << cell.len()) - 1;
    // With two colours, a way and its opposite are the same: the last part always has paper.
    let ways = if see_through { 0..=all } else { 0..=all >> 1 };
    let (mut best, mut least) = (0, f32::INFINITY);
    for drawn in ways {
        let ink = mean(cell, drawn, behind);
        let paper = if see_through { behind } else { mean(cell, all & !drawn, behind) };
        let error: f32 = cell
            .iter()
            .enumerate()
            .map(|(i, part)| {
                let shown = if drawn >> i & 1 == 1 { ink } else { paper };
                part.over(behind).iter().zip(shown).map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
            })
            .sum();
        // Strictly: among equals the way with the fewest changes, which costs the fewest bytes.
        if error < least - 1e-9 {
            (best, least) = (drawn, error);
        }
    }
    Split {
        drawn: best,
        ink: bytes(mean(cell, best, behind)),
        paper: (!see_through).then(|| bytes(mean(cell, all & !best, behind))),
    }
}

/// The mean of some parts of a cell over the background, linear light.
fn mean(cell: &[Light], which: u32, behind: [f32; 3]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for (_, part) in cell.iter().enumerate().filter(|(i, _)| which >> i & 1 == 1) {
        let seen = part.over(behind);
        sum = std::array::from_fn(|c| sum[c] + seen[c]);
    }
    sum.map(|c| c / which.count_ones().max(1) as f32)
}

/// Thresholds of an ordered dither (Bayer 1973), in sixteenths.
const BAYER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The share of the brightest that what is there has at least, where something is not.
const PRESENT: f32 = 0.34;

/// Which parts to draw when there is one colour: those whose lightness differs from the
/// background's, dithered gently so that lines stay lines.
fn inked(parts: &[Light], width: usize, behind: [f32; 3]) -> Vec<bool> {
    let lightness = |rgb: [f32; 3]| encode(0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
    let base = lightness(behind);
    let contrast: Vec<f32> = parts.iter().map(|part| (lightness(part.over(behind)) - base).abs()).collect();
    let most = contrast.iter().copied().fold(0.0_f32, f32::max);
    if most < 0.02 {
        return vec![false; parts.len()];
    }
    // Before nothing, what is as dark as the background is there too: it has a few dots.
    let least = if parts.iter().any(|part| part.alpha < TRANSPARENT) { PRESENT } else { 0.0 };
    let drawn = |(i, c): (usize, &f32)| {
        let threshold = f32::from(BAYER[i / width % 4][i % width % 4]) / 16.0;
        (c / most) * (1.0 - least) + parts[i].alpha * least > 0.28 + 0.4 * threshold
    };
    contrast.iter().enumerate().map(drawn).collect()
}

/// The character whose parts are drawn. Parts count from the upper left, row by row.
fn glyph(glyphs: Glyphs, drawn: u32) -> char {
    const QUADRANTS: [char; 16] =
        [' ', '▘', '▝', '▀', '▖', '▌', '▞', '▛', '▗', '▚', '▐', '▜', '▄', '▙', '▟', '█'];
    const HALVES: [char; 4] = [' ', '▀', '▄', '█'];
    // Unicode numbers the dots down the left column, then down the right one, the lowest row last.
    // From nothing to all of a cell.
    const RAMP: [char; 9] = [' ', '.', ':', '-', '=', '+', '*', '#', '@'];
    const DOTS: [u32; 8] = [0x01, 0x08, 0x02, 0x10, 0x04, 0x20, 0x40, 0x80];
    match glyphs {
        Glyphs::Quadrants => QUADRANTS[(drawn & 15) as usize],
        Glyphs::Halves => HALVES[(drawn & 3) as usize],
        Glyphs::Ascii => RAMP[(drawn & 255).count_ones() as usize],
        Glyphs::Braille => {
            let dots = (0..8).filter(|i| drawn >> i & 1 == 1).fold(0, |dots, i| dots | DOTS[i]);
            char::from_u32(0x2800 + dots).unwrap_or(' ')
        }
    }
}

#[cfg(test)]
#[path = "cells/tests.rs"]
mod tests;
