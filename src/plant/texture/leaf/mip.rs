//! Alpha that keeps its coverage in smaller copies of the picture.
//!
//! Programs that show a cut-out picture from afar average its alpha over squares of pixels and cut at
//! one half: needles, which fill no square by half, vanish. Castaño 2010 ("Computing alpha mipmaps")
//! scales the alpha of each copy until as much is left as there was. The copies are not ours to
//! make; instead what is near the leaf, and stays below one half, is raised by one factor for the
//! whole picture, such that the copies keep on average what the picture has. What vanishes in the smallest copies
//! all the same is cut at a lower alpha ([`cutout`]).

use rayon::prelude::*;

use linden_base::picture::Picture;

/// What has an alpha.
pub(crate) trait Cutout: Send + Sync {
    fn alpha(&self) -> f32;
    fn set_alpha(&mut self, alpha: f32);
}

impl Cutout for f32 {
    fn alpha(&self) -> f32 {
        *self
    }

    fn set_alpha(&mut self, alpha: f32) {
        *self = alpha;
    }
}

/// What is not cut out stays below this: one half with room for rounding.
const MOST: f32 = 0.45;
/// Pixels along the side of the squares in which coverage is known.
const BLOCK: usize = 4;
/// How many halvings are looked at, the first being that to a block.
const LEVELS: usize = 3;
/// Steps of the bisection for the factor.
const STEPS: usize = 12;

/// Means over blocks, `width` to a row.
struct Blocks {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

/// Raises the alpha of what is not cut out.
///
/// Rows have `width` pixels.
pub(crate) fn keep_coverage<T: Cutout>(spots: &mut [T], width: usize) {
    // Copies of smaller pictures show nothing.
    if width < 8 * BLOCK || spots.len() / width < 8 * BLOCK {
        return;
    }
    let covered = Blocks::of(spots, width);
    let near = covered.blurred();
    let wanted = covered.values.iter().sum::<f32>() / covered.values.len() as f32;
    let (mut low, mut high) = (0.0, 4.0);
    for _ in 0..STEPS {
        let gain = f32::midpoint(low, high);
        if covered.raised(&near, gain).kept() < wanted {
            low = gain;
        } else {
            high = gain;
        }
    }
    // Where nothing lies between all and nothing, all: rather a thick spray than none.
    let gain = high;
    spots.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
        for (column, spot) in line.iter_mut().enumerate() {
            let alpha = spot.alpha();
            if alpha < 0.5 {
                let halo = (gain * near.at(column as f32, row as f32)).min(MOST);
                spot.set_alpha(alpha.max(halo));
            }
        }
    });
}

impl Blocks {
    fn of<T: Cutout>(spots: &[T], row_len: usize) -> Self {
        let (width, height) = (row_len / BLOCK, spots.len() / row_len / BLOCK);
        let mut values = vec![0.0; width * height];
        values.par_chunks_mut(width).enumerate().for_each(|(row, out)| {
            for line in spots[row * BLOCK * row_len..].chunks(row_len).take(BLOCK) {
                for (out, block) in out.iter_mut().zip(line.chunks_exact(BLOCK)) {
                    *out += block.iter().map(Cutout::alpha).sum::<f32>() / (BLOCK * BLOCK) as f32;
                }
            }
        });
        Self { width, height, values }
    }

    /// The mean of each block and its eight neighbours.
    fn blurred(&self) -> Self {
        let mean = |i: usize| {
            let (x, y) = (i % self.width, i / self.width);
            let rows = [y.saturating_sub(1), y, (y + 1).min(self.height - 1)];
            let columns = [x.saturating_sub(1), x, (x + 1).min(self.width - 1)];
            rows.iter()
                .flat_map(|y| columns.iter().map(move |x| self.values[y * self.width + x]))
                .sum::<f32>()
                / 9.0
        };
        Self { values: (0..self.values.len()).map(mean).collect(), ..*self }
    }

    /// What blocks have when their free parts are raised.
    fn raised(&self, near: &Self, gain: f32) -> Self {
        let values =
            self.values.iter().zip(&near.values).map(|(c, near)| c + (1.0 - c) * (gain * near).min(MOST));
        Self { values: values.collect(), ..*self }
    }

    /// The share that is cut out, on average over the levels.
    fn kept(&self) -> f32 {
        let mut sum = self.share();
        let mut level = self.halved();
        for _ in 1..LEVELS {
            sum += level.share();
            level = level.halved();
        }
        sum / LEVELS as f32
    }

    fn share(&self) -> f32 {
        self.share_above(0.5)
    }

    fn share_above(&self, least: f32) -> f32 {
        self.values.iter().filter(|c| **c >= least).count() as f32 / self.values.len() as f32
    }

    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mean = |i: usize| {
            let corner = i / width * 2 * self.width + i % width * 2;
            let at = |offset: usize| self.values[corner + offset];
            (at(0) + at(1) + at(self.width) + at(self.width + 1)) / 4.0
        };
        Self { width, height, values: (0..width * height).map(mean).collect() }
    }

    /// Between the middles of blocks, at a pixel.
    fn at(&self, column: f32, row: f32) -> f32 {
        let place =
            |pixel: f32, count: usize| ((pixel + 0.5) / BLOCK as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        let (x, y) = (place(column, self.width), place(row, self.height));
        let (left, top) = (x as usize, y as usize);
        let (right, low) = ((left + 1).min(self.width - 1), (top + 1).min(self.height - 1));
        let (fx, fy) = (x - left as f32, y - top as f32);
        let line = |row: usize| {
            let (a, b) = (self.values[row * self.width + left], self.values[row * self.width + right]);
            a + (b - a) * fx
        };
        line(top) + (line(low) - line(top)) * fy
    }
}

/// Where an alpha may be cut, the usual one first.
const CUTOUTS: [f32; 6] = [0.5, 0.45, 0.4, 0.35, 0.3, 0.25];
/// How much of what copies can keep is enough.
const ENOUGH: f32 = 0.98;
/// The side of the smallest copy that is looked at, pixels: a picture holds a few leaves, of two pixels there.
const SMALLEST: usize = 8;

/// The alpha below which a picture is cut out: the greatest of [`CUTOUTS`] at which smaller copies of it, halved again
/// and again, keep as much on average as at any of them. From afar needles stay on their twigs that way, in programs that
/// make copies by plain means.
pub(crate) fn cutout(picture: &Picture) -> f32 {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if width.min(height) < 2 * SMALLEST {
        return CUTOUTS[0];
    }
    let rows = picture.rgba().chunks_exact(4 * width).map(|row| row.as_chunks::<4>().0);
    let whole =
        rows.clone().flatten().filter(|[.., alpha]| *alpha >= 128).count() as f32 / (width * height) as f32;
    // The first copy from bytes, which are many.
    let mut level = Blocks { width: width / 2, height: height / 2, values: Vec::new() };
    level.values.reserve_exact(level.width * level.height);
    let mut above: &[[u8; 4]] = &[];
    for (y, row) in rows.enumerate() {
        if y % 2 == 0 {
            above = row;
            continue;
        }
        let squares = above.as_chunks::<2>().0.iter().zip(row.as_chunks::<2>().0);
        level.values.extend(squares.map(|(above, below)| {
            let sum: u32 = above.iter().chain(below).map(|[.., alpha]| u32::from(*alpha)).sum();
            sum as f32 / (4.0 * 255.0)
        }));
    }
    let mut kept = [0.0_f32; CUTOUTS.len()];
    loop {
        for (kept, at_least) in kept.iter_mut().zip(CUTOUTS) {
            *kept += level.share_above(at_least).min(whole);
        }
        if level.width.min(level.height) < 2 * SMALLEST {
            break;
        }
        level = level.halved();
    }
    let most = kept.into_iter().fold(0.0, f32::max);
    CUTOUTS.into_iter().zip(kept).find(|(_, kept)| *kept >= ENOUGH * most).map_or(CUTOUTS[0], |(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::leaf::paint::Spot;

    const N: usize = 256;

    /// Vertical needles of a pixel, closer together in the middle than outside.
    fn needles() -> Vec<Spot> {
        let mut columns = vec![64_usize];
        while let Some(&last) = columns.last().filter(|x| **x < 192) {
            columns.push(last + 3 + last.abs_diff(128) / 20);
        }
        let alpha = |x: usize| f32::from(columns.contains(&x));
        let inside = |x: usize, y: usize| (64..192).contains(&x) && (64..192).contains(&y);
        (0..N * N)
            .map(|i| (i % N, i / N))
            .map(|(x, y)| Spot { alpha: if inside(x, y) { alpha(x) } else { 0.0 }, ..Spot::default() })
            .collect()
    }

    /// The share that is cut out of a copy, by the definition.
    fn share(spots: &[Spot], square: usize) -> f64 {
        let side = N / square;
        let kept = (0..side * side).filter(|i| {
            let sum: f32 = (0..square * square)
                .map(|k| {
                    let (x, y) = (i % side * square + k % square, i / side * square + k / square);
                    spots[y * N + x].alpha
                })
                .sum();
            sum >= 0.5 * (square * square) as f32
        });
        kept.count() as f64 / (side * side) as f64
    }

    #[test]
    fn needles_do_not_vanish_and_the_picture_itself_stays() {
        let before = needles();
        let mut after = before.clone();
        keep_coverage(&mut after, N);
        let mean = |spots: &[Spot]| [4, 8, 16].map(|square| share(spots, square)).iter().sum::<f64>() / 3.0;
        assert!(mean(&before) < 0.05, "{}", mean(&before));
        assert!(
            mean(&after) > 0.5 * share(&before, 1) && mean(&after) < 1.5 * share(&before, 1),
            "{}",
            mean(&after)
        );
        assert!((0..N * N).all(|i| (before[i].alpha >= 0.5) == (after[i].alpha >= 0.5)));
        assert!((0..N * N).all(|i| after[i].alpha >= before[i].alpha));
    }

    #[test]
    fn whole_leaves_hardly_change() {
        let disc: Vec<Spot> = (0..N * N)
            .map(|i| ((i % N) as f32 - 127.5, (i / N) as f32 - 127.5))
            .map(|(x, y)| Spot { alpha: f32::from(x * x + y * y < 90.0 * 90.0), ..Spot::default() })
            .collect();
        let mut after = disc.clone();
        keep_coverage(&mut after, N);
        for square in [2, 4, 8, 16] {
            let ratio = share(&after, square) / share(&disc, 1);
            assert!((0.93..1.07).contains(&ratio), "{square}: {ratio}");
        }
    }

    /// A picture of an alpha by pixel.
    fn picture(alpha: impl Fn(usize, usize) -> u8) -> Picture {
        let rgba = (0..N * N).flat_map(|i| [0, 0, 0, alpha(i % N, i / N)]).collect();
        Picture::new(N as u32, N as u32, rgba)
    }

    #[test]
    fn what_vanishes_in_small_copies_is_cut_lower_and_nothing_else() {
        let inside = |x: usize, y: usize| (64..192).contains(&x) && (64..192).contains(&y);
        // Two pixels in five.
        let comb = picture(|x, y| if inside(x, y) && x % 5 < 2 { 255 } else { 0 });
        let square = picture(|x, y| if inside(x, y) { 255 } else { 0 });
        let (of_comb, of_square) = (cutout(&comb), cutout(&square));
        assert_eq!(of_square, 0.5);
        assert!(of_comb <= 0.4, "{of_comb}");
        // By the definition, in the copy of a sixteenth: at one half nearly all of the comb is gone.
        let spots: Vec<f32> = comb.rgba().iter().skip(3).step_by(4).map(|&a| f32::from(a) / 255.0).collect();
        let share = |at_least: f32| {
            let sums = (0..16 * 16).map(|i| {
                let cell = (0..256).map(|k| spots[(i / 16 * 16 + k / 16) * N + i % 16 * 16 + k % 16]);
                cell.sum::<f32>() / 256.0
            });
            sums.filter(|&mean| mean >= at_least).count()
        };
        assert!(share(0.5) < 8 && share(of_comb) >= 32, "{} {}", share(0.5), share(of_comb));
        assert_eq!(cutout(&Picture::new(1, 1, vec![0, 0, 0, 255])), 0.5);
    }
}
