//! Cells get the colours of a terminal, and share them with their neighbours where that saves bytes.

use ratatui::style::Color;

use super::{CellStyle, Glyphs, PictureCell, Seen, Split, glyph};
use crate::color::{ColorDepth, is_bright};

/// How much is given up to save bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    /// Steps of a channel (sRGB, of 255) by which colours may differ and still be made the same.
    pub tolerance: u8,
    /// Cells of a row that are drawn as one.
    pub block: u16,
}

impl Level {
    /// Differences that no eye tells apart.
    pub const FINE: Self = Self { tolerance: 3, block: 1 };

    /// From the finest to one that fits into 16 KB at 400×120 cells, whatever the picture.
    pub const LADDER: [Self; 16] = [
        Self::FINE,
        Self { tolerance: 5, block: 1 },
        Self { tolerance: 7, block: 1 },
        Self { tolerance: 10, block: 1 },
        Self { tolerance: 14, block: 1 },
        Self { tolerance: 20, block: 1 },
        Self { tolerance: 28, block: 1 },
        Self { tolerance: 40, block: 1 },
        Self { tolerance: 56, block: 1 },
        Self { tolerance: 80, block: 1 },
        Self { tolerance: 40, block: 2 },
        Self { tolerance: 64, block: 4 },
        Self { tolerance: 100, block: 8 },
        Self { tolerance: 160, block: 16 },
        Self { tolerance: 200, block: 32 },
        Self { tolerance: 255, block: 128 },
    ];
}

/// What is set at the start of a row.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    /// Nothing: lines of text that stand for themselves. What is empty between cells is printed.
    Apart,
    /// What the row above has left. What is empty is jumped over.
    Joined,
}

/// Gives all cells their colours.
pub(super) fn settle(
    seen: &Seen,
    nearest: &mut Nearest,
    style: CellStyle,
    level: Level,
    rows: Rows,
) -> Vec<PictureCell> {
    let tolerance = level.tolerance;
    let mut pen = Pen { style, tolerance, rows, ink: OWN, paper: OWN, pending: false, nearest };
    let mut cells = Vec::with_capacity(seen.splits.len());
    for (row, splits) in seen.splits.chunks(seen.columns.max(1)).enumerate() {
        if rows == Rows::Apart {
            pen.start_row();
        }
        if level.block > 1 {
            pen.blocks(splits, usize::from(level.block), row, &mut cells);
        } else {
            cells.extend(splits.iter().map(|split| pen.cell(split)));
        }
    }
    cells
}

/// A colour as a terminal is told it, and as it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Set {
    color: Color,
    /// `None` for the terminal's own, which looks like nothing else.
    look: Option<[u8; 3]>,
}

impl Set {
    /// Whether it is one that terminals of 16 colours are sure to have as ink alone: behind text the bright ones
    /// blink, or are dark.
    const fn is_ink_alone(self) -> bool {
        is_bright(self.color)
    }
}

const OWN: Set = Set { color: Color::Reset, look: None };

/// Remembers which colours are set.
struct Pen<'a> {
    style: CellStyle,
    tolerance: u8,
    rows: Rows,
    ink: Set,
    paper: Set,
    /// Whether empty cells stand before the next one.
    pending: bool,
    nearest: &'a mut Nearest,
}

impl Pen<'_> {
    fn start_row(&mut self) {
        (self.ink, self.paper, self.pending) = (OWN, OWN, false);
    }

    fn cell(&mut self, split: &Split) -> PictureCell {
        if self.style.is_monochrome() { self.monochrome(split) } else { self.two_colors(split) }
    }

    fn two_colors(&mut self, split: &Split) -> PictureCell {
        let glyphs = self.style.glyphs;
        let all = if glyphs == Glyphs::Quadrants { 0b1111 } else { 0b11 };
        let Some(paper) = split.paper else {
            if split.drawn == 0 {
                self.pending = true;
                return PictureCell::EMPTY;
            }
            let ink = self.settle(split.ink);
            return self.put(glyph(glyphs, split.drawn), Some(ink), Some(OWN));
        };
        let (mut ink, mut paper) = (split.ink, paper);
        if self.tolerance > Level::FINE.tolerance && near(ink, paper, self.tolerance) {
            let (drawn, all) = (split.drawn.count_ones() as u16, u32::count_ones(all) as u16);
            let mixed = |c: usize| (u16::from(ink[c]) * drawn + u16::from(paper[c]) * (all - drawn)) / all;
            paper = [0, 1, 2].map(|c| mixed(c) as u8);
            ink = paper;
        }
        let (ink, paper) = (self.settle(ink), self.settle(paper));
        if split.drawn == 0 || ink == paper {
            return self.one_color(paper);
        }
        let changes = |ink: Set, paper: Set| {
            let bright_paper = u32::from(paper.is_ink_alone()) * 3;
            u32::from(self.ink != ink) + u32::from(self.paper != paper) + bright_paper
        };
        if changes(paper, ink) < changes(ink, paper) {
            self.put(glyph(glyphs, all & !split.drawn), Some(paper), Some(ink))
        } else {
            self.put(glyph(glyphs, split.drawn), Some(ink), Some(paper))
        }
    }

    /// All of a cell in one colour: whichever way it is set already.
    fn one_color(&mut self, color: Set) -> PictureCell {
        let all = glyph(Glyphs::Halves, 0b11);
        if self.ink == color {
            self.put(all, None, None)
        } else if color.is_ink_alone() {
            self.put(all, Some(color), None)
        } else {
            self.put(' ', None, Some(color))
        }
    }

    fn monochrome(&mut self, split: &Split) -> PictureCell {
        if split.drawn == 0 {
            self.pending = true;
            return PictureCell::EMPTY;
        }
        let ink = self.settle(split.ink);
        self.put(glyph(self.style.glyphs, split.drawn), Some(ink), Some(OWN))
    }

    /// Cells of a row drawn several at a time: blocks of one colour, which are erased, not printed;
    /// with one colour only, one cell of each.
    fn blocks(&mut self, splits: &[Split], block: usize, row: usize, cells: &mut Vec<PictureCell>) {
        for block in splits.chunks(block) {
            if self.style.is_monochrome() {
                let kept = row % block.len();
                cells.extend(
                    block.iter().enumerate().map(|(i, split)| {
                        if i == kept { self.monochrome(split) } else { PictureCell::EMPTY }
                    }),
                );
                continue;
            }
            let one = self.mixed(block);
            cells.extend(std::iter::repeat_n(one, block.len()));
        }
    }

    /// The one colour of a block, or none where little is drawn.
    fn mixed(&mut self, block: &[Split]) -> PictureCell {
        let parts = if self.style.glyphs == Glyphs::Quadrants { 4 } else { 2 };
        let (mut sum, mut n) = ([0_u32; 3], 0);
        for split in block {
            let drawn = split.drawn.count_ones();
            for (color, weight) in [(Some(split.ink), drawn), (split.paper, parts - drawn)] {
                if let Some(color) = color {
                    n += weight;
                    sum = std::array::from_fn(|c| sum[c] + u32::from(color[c]) * weight);
                }
            }
        }
        // A quarter is enough: twigs are thin.
        if n * 4 < parts * block.len() as u32 {
            return PictureCell::EMPTY;
        }
        let paper = self.settle(sum.map(|c| (c / n.max(1)) as u8));
        // As paper even where that is bright: what is erased costs no character.
        self.put(' ', None, Some(paper))
    }

    /// A colour that is set already where it differs by little: it costs no bytes.
    fn settle(&mut self, srgb: [u8; 3]) -> Set {
        let color = self.nearest.of(srgb);
        // Entries of a palette are no shades of each other until more is given up than no eye sees.
        let shades = self.style.colors == ColorDepth::True || self.tolerance > Level::FINE.tolerance;
        let same = |set: &Set| set.look.zip(color.look).is_some_and(|(a, b)| near(a, b, self.tolerance));
        [self.ink, self.paper].into_iter().find(|set| shades && same(set)).unwrap_or(color)
    }

    /// A character in some colours; `None` where it does not matter.
    fn put(&mut self, character: char, ink: Option<Set>, paper: Option<Set>) -> PictureCell {
        if self.pending && self.rows == Rows::Apart {
            self.paper = OWN;
        }
        self.pending = false;
        self.ink = ink.unwrap_or(self.ink);
        self.paper = paper.unwrap_or(self.paper);
        // What is printed in colours that are set already shows them.
        let shown = match (ink, paper) {
            (None, None) => (Some(self.ink.color), None),
            (ink, paper) => (ink.map(|set| set.color), paper.map(|set| set.color)),
        };
        PictureCell { character, ink: shown.0, paper: shown.1 }
    }
}

fn near(a: [u8; 3], b: [u8; 3], tolerance: u8) -> bool {
    (0..3).all(|i| a[i].abs_diff(b[i]) <= tolerance)
}

/// The nearest colours of a palette, remembered: pictures have few.
pub(super) struct Nearest {
    colors: ColorDepth,
    found: Vec<Option<([u8; 3], Set)>>,
}

/// Colours that are remembered.
const PLACES: usize = 8192;

impl Nearest {
    pub fn new(colors: ColorDepth) -> Self {
        let palette = matches!(colors, ColorDepth::Ansi16 | ColorDepth::Ansi256);
        Self { colors, found: if palette { vec![None; PLACES] } else { Vec::new() } }
    }

    fn of(&mut self, srgb: [u8; 3]) -> Set {
        let at = srgb.iter().fold(0_usize, |hash, &c| hash.wrapping_mul(131).wrapping_add(c.into())) % PLACES;
        if let Some(Some((known, set))) = self.found.get(at)
            && *known == srgb
        {
            return *set;
        }
        let color = self.colors.nearest(srgb);
        let set = Set { color, look: crate::color::look(color) };
        if let Some(place) = self.found.get_mut(at) {
            *place = Some((srgb, set));
        }
        set
    }
}
