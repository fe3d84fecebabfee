//! Pictures made of characters: RGBA pixels → text with colours.
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

use std::fmt::Write;

use crate::color::{Color, ColorDepth};
use crate::grid::{Image, Light, bytes, decode, encode};

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
}

impl Glyphs {
    /// Parts per cell, across and down.
    pub const fn parts(self) -> (u16, u16) {
        match self {
            Self::Quadrants => (2, 2),
            Self::Halves => (1, 2),
            Self::Braille => (2, 4),
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
    let (across, down) = style.glyphs.parts();
    let (across, down) = (usize::from(across), usize::from(down));
    let (columns, rows) = (usize::from(columns), usize::from(rows));
    let parts = image.averaged(columns * across, rows * down);
    let behind = style.background.map(|c| decode(f32::from(c) / 255.0));
    let monochrome = style.colors == ColorDepth::None || style.glyphs == Glyphs::Braille;
    let ink = if monochrome { inked(&parts, columns * across, behind) } else { Vec::new() };

    let mut pen = Pen::new(style.colors, columns * rows * 10);
    let mut cell = Vec::with_capacity(across * down);
    for row in 0..rows {
        for column in 0..columns {
            let places = (0..across * down)
                .map(|i| (row * down + i / across) * columns * across + column * across + i % across);
            cell.clear();
            cell.extend(places.clone().map(|at| parts[at]));
            if monochrome {
                let drawn = places.enumerate().fold(0, |drawn, (i, at)| drawn | u32::from(ink[at]) << i);
                pen.monochrome(style.glyphs, drawn, mean(&cell, drawn, behind));
            } else {
                pen.two_colors(style.glyphs, &split(&cell, behind));
            }
        }
        pen.end_line();
    }
    pen.text
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
    let drawn = |(i, c): (usize, &f32)| {
        let threshold = f32::from(BAYER[i / width % 4][i % width % 4]) / 16.0;
        c / most > 0.28 + 0.4 * threshold
    };
    contrast.iter().enumerate().map(drawn).collect()
}

/// Steps of a channel by which neighbouring cells may differ and still share a colour.
const INDISTINCT: u8 = 3;

/// Writes cells and remembers which colours are set.
struct Pen {
    text: String,
    colors: ColorDepth,
    ink: Color,
    paper: Color,
    /// Empty cells that are written only when something follows them on the line.
    pending: usize,
}

impl Pen {
    fn new(colors: ColorDepth, capacity: usize) -> Self {
        let (ink, paper) = (Color::Default, Color::Default);
        Self { text: String::with_capacity(capacity), colors, ink, paper, pending: 0 }
    }

    fn two_colors(&mut self, glyphs: Glyphs, split: &Split) {
        let all = match glyphs {
            Glyphs::Quadrants => 0b1111,
            Glyphs::Halves => 0b11,
            Glyphs::Braille => 0xff,
        };
        let ink = self.settle(self.colors.nearest(split.ink));
        let Some(paper) = split.paper else {
            if split.drawn == 0 {
                self.pending += 1;
            } else {
                self.put(glyph(glyphs, split.drawn), Some(ink), Some(Color::Default));
            }
            return;
        };
        let paper = self.settle(self.colors.nearest(paper));
        if split.drawn == 0 || ink == paper {
            // One colour: whichever way it is set already.
            if self.ink == paper {
                self.put(glyph(glyphs, all), None, None);
            } else {
                self.put(' ', None, Some(paper));
            }
            return;
        }
        let changes = |ink, paper| u32::from(self.ink != ink) + u32::from(self.paper != paper);
        if changes(paper, ink) < changes(ink, paper) {
            self.put(glyph(glyphs, all & !split.drawn), Some(paper), Some(ink));
        } else {
            self.put(glyph(glyphs, split.drawn), Some(ink), Some(paper));
        }
    }

    fn monochrome(&mut self, glyphs: Glyphs, drawn: u32, ink: [f32; 3]) {
        if drawn == 0 {
            self.pending += 1;
        } else {
            let ink = self.settle(self.colors.nearest(bytes(ink)));
            self.put(glyph(glyphs, drawn), Some(ink), Some(Color::Default));
        }
    }

    /// A colour that is set already where it differs by less than can be seen: it costs no bytes.
    fn settle(&self, color: Color) -> Color {
        let near = |set: Color| match (set, color) {
            (Color::Rgb(a), Color::Rgb(b)) => (0..3).all(|i| a[i].abs_diff(b[i]) <= INDISTINCT),
            _ => false,
        };
        [self.ink, self.paper].into_iter().find(|&set| near(set)).unwrap_or(color)
    }

    /// A character in some colours; `None` where it does not matter.
    fn put(&mut self, character: char, ink: Option<Color>, paper: Option<Color>) {
        if self.pending > 0 {
            self.select(None, Some(Color::Default));
            self.text.extend(std::iter::repeat_n(' ', self.pending));
            self.pending = 0;
        }
        self.select(ink, paper);
        self.text.push(character);
    }

    fn select(&mut self, ink: Option<Color>, paper: Option<Color>) {
        let ink = ink.filter(|&c| c != self.ink);
        let paper = paper.filter(|&c| c != self.paper);
        if ink.is_none() && paper.is_none() {
            return;
        }
        self.text.push_str("\u{1b}[");
        if let Some(c) = ink {
            self.ink = c;
            self.code(c, 30);
        }
        if let Some(c) = paper {
            if ink.is_some() {
                self.text.push(';');
            }
            self.paper = c;
            self.code(c, 40);
        }
        self.text.push('m');
    }

    /// The parameters of "select graphic rendition" (ECMA-48 8.3.117; ISO 8613-6 for 38 and 48):
    /// `base` is 30 for ink, 40 for paper.
    fn code(&mut self, color: Color, base: u16) {
        // Writing to a String cannot fail.
        let _ = match color {
            Color::Default => write!(self.text, "{}", base + 9),
            Color::Indexed(i) if self.colors == ColorDepth::Ansi16 => {
                write!(self.text, "{}", base + u16::from(i) + if i < 8 { 0 } else { 52 })
            }
            Color::Indexed(i) => write!(self.text, "{};5;{i}", base + 8),
            Color::Rgb([r, g, b]) => write!(self.text, "{};2;{r};{g};{b}", base + 8),
        };
    }

    fn end_line(&mut self) {
        self.pending = 0;
        if self.ink != Color::Default || self.paper != Color::Default {
            self.text.push_str("\u{1b}[0m");
            (self.ink, self.paper) = (Color::Default, Color::Default);
        }
        self.text.push('\n');
    }
}

/// The character whose parts are drawn. Parts count from the upper left, row by row.
fn glyph(glyphs: Glyphs, drawn: u32) -> char {
    const QUADRANTS: [char; 16] =
        [' ', '▘', '▝', '▀', '▖', '▌', '▞', '▛', '▗', '▚', '▐', '▜', '▄', '▙', '▟', '█'];
    const HALVES: [char; 4] = [' ', '▀', '▄', '█'];
    // Unicode numbers the dots down the left column, then down the right one, the lowest row last.
    const DOTS: [u32; 8] = [0x01, 0x08, 0x02, 0x10, 0x04, 0x20, 0x40, 0x80];
    match glyphs {
        Glyphs::Quadrants => QUADRANTS[(drawn & 15) as usize],
        Glyphs::Halves => HALVES[(drawn & 3) as usize],
        Glyphs::Braille => {
            let dots = (0..8).filter(|i| drawn >> i & 1 == 1).fold(0, |dots, i| dots | DOTS[i]);
            char::from_u32(0x2800 + dots).unwrap_or(' ')
        }
    }
}

#[cfg(test)]
#[path = "cells_tests.rs"]
mod tests;
