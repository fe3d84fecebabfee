//! Even light over a picture of bark. Light that varies slowly repeats with the picture, and from afar a trunk has rings of light
//! and dark, one above the other; so it is divided by its slow waves. Details and hues stay.

use std::f32::consts::{SQRT_2, TAU};

use rayon::prelude::*;

use super::surface::Spot;
use linden_base::color::luminance;

/// Waves to a picture, each way: finer ones are furrows, plates and scars.
const WAVES: usize = 3;
/// One, and a cosine and a sine for each wave.
const TERMS: usize = 1 + 2 * WAVES;
/// However dark a place is, it is made lighter by no more than this.
const MOST_GAIN: f32 = 2.5;

/// Evens out the light of `n` rows of `n` places.
pub(super) fn even(spots: &mut [Spot], n: usize) {
    if n < TERMS + 1 {
        return;
    }
    let waves = waves(n);
    // Summed row by row in their order: the same bits whatever the threads do.
    let rows: Vec<[f32; TERMS]> = spots
        .par_chunks(n)
        .map(|row| mean(row.iter().map(|spot| luminance(spot.tint.to_array())).zip(&waves), n))
        .collect();
    let of_term = |term: usize| mean(rows.iter().map(|row| row[term]).zip(&waves), n);
    let slow: [[f32; TERMS]; TERMS] = std::array::from_fn(of_term);
    let whole = slow[0][0];
    if whole.is_nan() || whole <= 0.0 {
        return;
    }
    spots.par_chunks_mut(n).zip(&waves).for_each(|(row, up)| {
        let across: [f32; TERMS] = std::array::from_fn(|term| dot(&slow[term], up));
        for (spot, around) in row.iter_mut().zip(&waves) {
            spot.tint *= (whole / dot(&across, around).max(whole / MOST_GAIN)).min(MOST_GAIN);
        }
    });
}

/// The terms at each of `n` places, of which the mean square is 1 and that of the product of two is 0.
fn waves(n: usize) -> Vec<[f32; TERMS]> {
    let at = |i: usize| {
        let place = (i as f32 + 0.5) / n as f32;
        let mut terms = [1.0; TERMS];
        for wave in 1..=WAVES {
            let (sine, cosine) = libm::sincosf(TAU * place * wave as f32);
            terms[2 * wave - 1] = SQRT_2 * cosine;
            terms[2 * wave] = SQRT_2 * sine;
        }
        terms
    };
    (0..n).map(at).collect()
}

/// How much of each term there is in values.
fn mean<'a>(values: impl Iterator<Item = (f32, &'a [f32; TERMS])>, n: usize) -> [f32; TERMS] {
    let mut sums = [0.0; TERMS];
    for (value, terms) in values {
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += value * term;
        }
    }
    sums.map(|sum| sum / n as f32)
}

fn dot(a: &[f32; TERMS], b: &[f32; TERMS]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
