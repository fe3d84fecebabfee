//! Cells in the few colours of a palette: what one entry cannot show, some of them do side by side.
//!
//! The parts of a cell share two entries, by an ordered dither, and the cells of a square of four have pairs that make
//! up for what the others lack: a leaf's green is green and black in one cell, yellow and grey in the next. Patterns
//! stand still while a tree moves, which those of a diffused error do not.

use std::sync::LazyLock;

use super::{BAYER, Split, TRANSPARENT, mean, split};
use crate::color::{self, ColorDepth, HUE_WEIGHT, difference, oklab_of_light};
use crate::grid::{Light, bytes, decode};

/// A palette, and the pairs that were found for colours: pictures have few.
pub(super) struct Dither {
    palette: &'static Mixes,
    found: Vec<Option<([u8; 3], [Pair; SQUARE])>>,
}

impl Dither {
    /// Where there are too few colours to show a picture as it is.
    pub fn new(colors: ColorDepth) -> Option<Self> {
        static OF_16: LazyLock<Mixes> = LazyLock::new(|| Mixes::new(ColorDepth::Ansi16));
        static OF_256: LazyLock<Mixes> = LazyLock::new(|| Mixes::new(ColorDepth::Ansi256));
        let palette = match colors {
            ColorDepth::Ansi16 => &*OF_16,
            ColorDepth::Ansi256 => &*OF_256,
            ColorDepth::None | ColorDepth::True => return None,
        };
        Some(Self { palette, found: vec![None; PLACES] })
    }

    /// Gives each part of the cell in a column and row one of two entries, such that the cell and those
    /// around it have the picture's colour between them.
    pub fn split(&mut self, cell: &[Light], behind: [f32; 3], (column, row): (usize, usize)) -> Split {
        if cell.iter().any(|part| part.alpha < TRANSPARENT) {
            let found = split(cell, behind);
            let ink = self.one(mean(cell, found.drawn, behind), behind, (column, row));
            return Split { ink, ..found };
        }
        let all = (1 << cell.len()) - 1;
        let pair = self.pair(mean(cell, all, behind), (column, row));
        let across = cell.len() / 2;
        let drawn = cell.iter().enumerate().fold(0, |drawn, (i, part)| {
            let at = (column * across + i % across, row * 2 + i / across);
            let share = self.palette.nearest(pair, self.palette.wanted(part.over(behind))).share;
            drawn | u32::from(share > threshold(at)) << i
        });
        let [paper, ink] = pair.map(|entry| self.palette.entries[entry].srgb);
        Split { drawn, ink, paper: Some(paper) }
    }

    /// One entry for all that is drawn in the cell in a column and row: none in which it would be lost.
    pub fn one(&mut self, light: [f32; 3], behind: [f32; 3], place: (usize, usize)) -> [u8; 3] {
        let pair = self.pair(light, place);
        let share = self.palette.nearest(pair, self.palette.wanted(light)).share;
        let entries = &self.palette.entries;
        let chosen = &entries[pair[usize::from(share > threshold(place))]];
        let (wanted, behind) = (self.palette.wanted(light), oklab_of_light(behind));
        let is_seen = |entry: &&Entry| difference(entry.lab, behind) > UNSEEN;
        if is_seen(&chosen) {
            return chosen.srgb;
        }
        let away = |entry: &Entry| difference(entry.lab, wanted) + GAUDY * off_color(entry.lab, wanted);
        let seen = entries.iter().filter(is_seen).min_by(|a, b| away(a).total_cmp(&away(b)));
        seen.unwrap_or(chosen).srgb
    }

    /// The pair for a colour in a place.
    fn pair(&mut self, light: [f32; 3], (column, row): (usize, usize)) -> Pair {
        // Finer steps than a palette can show only take time.
        let rounded = bytes(light).map(|c| c & !3);
        let at =
            rounded.iter().fold(0, |hash: usize, &c| hash.wrapping_mul(131).wrapping_add((c >> 2).into()))
                % PLACES;
        let pairs = match self.found[at] {
            Some((known, pairs)) if known == rounded => pairs,
            _ => self.palette.square(self.palette.wanted(rounded.map(|c| decode(f32::from(c) / 255.0)))),
        };
        self.found[at] = Some((rounded, pairs));
        // One after another along the diagonals.
        pairs[[0, 1, 3, 2][row % 2 * 2 + column % 2]]
    }
}

/// Colours that are remembered.
const PLACES: usize = 4096;

/// Cells that have a colour between them.
const SQUARE: usize = 4;

/// Entries of a palette, the lower number first.
type Pair = [usize; 2];

/// Shares of the second entry for which mixes are known: none to all of it, in quarters.
const SHARES: usize = 5;

/// Entries that are tried for a colour, of a large palette those that look nearest.
const TRIED: usize = 16;

/// How much a mix of entries that differ is avoided: they are seen as grain.
const GRAIN: f32 = 0.03;

/// How much entries of another hue than the picture's are avoided: red and green make olive, but are not seen as that.
const ASTRAY: f32 = 0.4;

/// How much more than its lightness the colour of an entry counts that stands alone, for want of one that is seen.
const GAUDY: f32 = 10.0;

/// What differs less from the background is lost in it.
const UNSEEN: f32 = 0.05;

struct Entry {
    srgb: [u8; 3],
    lab: [f32; 3],
}

/// The entries of a palette and how any two of them look mixed.
struct Mixes {
    entries: Vec<Entry>,
    /// Of all pairs, from the first entry alone to the second alone.
    looks: Vec<[[f32; 3]; SHARES]>,
    toning: Toning,
}

/// How a picture is brought nearer to what a palette has.
#[derive(Clone, Copy)]
struct Toning {
    /// Of lightness, the exponent: below 1 shade is lighter.
    lift: f32,
    /// Of the chroma of greens, the factor, and of other hues.
    green: f32,
    other: f32,
}

/// Sixteen colours are gaudy or grey: leaves are green rather than grey, bark is grey rather than red, and shade is not
/// all black.
const FEW: Toning = Toning { lift: 0.88, green: 1.8, other: 1.1 };
const MANY: Toning = Toning { lift: 1.0, green: 1.15, other: 1.0 };

/// Where a mix looks nearest to a colour.
struct Nearest {
    share: f32,
    look: [f32; 3],
    away: f32,
}

impl Mixes {
    fn new(colors: ColorDepth) -> Self {
        let light = |srgb: [u8; 3]| srgb.map(|c| decode(f32::from(c) / 255.0));
        let palette = color::palette(colors);
        let looks = (0..palette.len()).flat_map(|second| (0..=second).map(move |first| [first, second]));
        let looks = looks.map(|pair| {
            let [from, to] = pair.map(|entry| light(palette[entry]));
            std::array::from_fn(|i| {
                let share = i as f32 / (SHARES - 1) as f32;
                oklab_of_light(std::array::from_fn(|c| from[c] + (to[c] - from[c]) * share))
            })
        });
        let looks = looks.collect();
        let entries = palette.iter().map(|&srgb| Entry { srgb, lab: oklab_of_light(light(srgb)) }).collect();
        Self { entries, looks, toning: if colors == ColorDepth::Ansi16 { FEW } else { MANY } }
    }

    /// The colour that is to be shown for light.
    fn wanted(&self, light: [f32; 3]) -> [f32; 3] {
        let [lightness, a, b] = oklab_of_light(light);
        let Toning { lift, green, other } = self.toning;
        let chroma = libm::hypotf(a, b);
        let is_green = if chroma > 0.0 { (0.5 - a / chroma).clamp(0.0, 1.0) } else { 0.0 };
        let gain = other + (green - other) * is_green;
        [libm::powf(lightness, lift), a * gain, b * gain]
    }

    fn looks(&self, [first, second]: Pair) -> &[[f32; 3]; SHARES] {
        &self.looks[second * (second + 1) / 2 + first]
    }

    /// Pairs that have a colour between them, each making up for what those before it lack.
    fn square(&self, wanted: [f32; 3]) -> [Pair; SQUARE] {
        let mut lack = [0.0; 3];
        std::array::from_fn(|_| {
            let target = std::array::from_fn(|c| wanted[c] + lack[c]);
            let pair = self.best(target);
            let look = self.nearest(pair, target).look;
            lack = std::array::from_fn(|c| target[c] - look[c]);
            pair
        })
    }

    /// The pair whose mixes come nearest to a colour.
    fn best(&self, target: [f32; 3]) -> Pair {
        let near = self.near(target);
        let pairs = near
            .iter()
            .enumerate()
            .flat_map(|(at, &one)| near[..=at].iter().map(move |&other| [one.min(other), one.max(other)]));
        let pairs = pairs.filter(|&[first, second]| first == second || !self.is_bright(first));
        let cost = |pair: Pair| {
            let [first, second] = pair.map(|entry| self.entries[entry].lab);
            let astray = off_hue(first, target) + off_hue(second, target);
            self.nearest(pair, target).away + GRAIN * difference(first, second) + ASTRAY * astray
        };
        pairs
            .map(|pair| (cost(pair), pair))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or([0; 2], |(_, pair)| pair)
    }

    /// Whether an entry is one that cannot be relied on as paper.
    fn is_bright(&self, entry: usize) -> bool {
        self.entries.len() == 16 && entry >= 8
    }

    /// The entries that look nearest to a colour.
    fn near(&self, target: [f32; 3]) -> Vec<usize> {
        let mut near: Vec<usize> = (0..self.entries.len()).collect();
        if near.len() > TRIED {
            let distance = |&entry: &usize| difference(self.entries[entry].lab, target);
            near.select_nth_unstable_by(TRIED, |a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            near.truncate(TRIED);
        }
        near
    }

    /// The mix of a pair that looks nearest to a colour.
    fn nearest(&self, pair: Pair, target: [f32; 3]) -> Nearest {
        let ends = self.looks(pair).windows(2).enumerate();
        let mixes = ends.map(|(i, ends)| {
            let along = along(ends[0], ends[1], target);
            let look = std::array::from_fn(|c| ends[0][c] + (ends[1][c] - ends[0][c]) * along);
            let share = (i as f32 + along) / (SHARES - 1) as f32;
            Nearest { share, look, away: difference(look, target) }
        });
        let first = Nearest { share: 0.0, look: target, away: f32::INFINITY };
        mixes.fold(first, |best, mix| if mix.away < best.away { mix } else { best })
    }
}

/// How far colours are apart whatever their lightness, squared.
fn off_color([_, a, b]: [f32; 3], [_, c, d]: [f32; 3]) -> f32 {
    (a - c) * (a - c) + (b - d) * (b - d)
}

/// How far the hue of a colour is from that of another, the more the more chroma they have.
fn off_hue([_, a, b]: [f32; 3], [_, c, d]: [f32; 3]) -> f32 {
    libm::sqrtf((a * a + b * b) * (c * c + d * d)) - (a * c + b * d)
}

/// Where between two colours a third lies nearest, 0 to 1.
fn along(from: [f32; 3], to: [f32; 3], target: [f32; 3]) -> f32 {
    let weight = [1.0, HUE_WEIGHT, HUE_WEIGHT];
    let along = |v: [f32; 3]| (0..3).map(|c| weight[c] * (v[c] - from[c]) * (to[c] - from[c])).sum::<f32>();
    let length = along(to);
    if length > 0.0 { (along(target) / length).clamp(0.0, 1.0) } else { 0.0 }
}

/// Of an ordered dither, above 0 and below 1. Parts are taller than wide: what is drawn of few lies in rows unless
/// every other cell is turned over.
fn threshold((x, y): (usize, usize)) -> f32 {
    (f32::from(BAYER[(y ^ (x / 2 % 2)) % 4][x % 4]) + 0.5) / 16.0
}

#[cfg(test)]
#[path = "dither_tests.rs"]
mod tests;
