//! How fine foliage and bare twigs are in the pixels of its cards, and what follows from that: how many different cards there are, and how
//! much wider needles are drawn than they are.
//!
//! In fewer pixels than a needle is wide, a spray of needles is a blot whose outline reads as a lobed leaf. Fewer cards have
//! more pixels each; what is still missing is made up by needles that are wider and fewer, which cover as much.

use super::{FEWEST_CARDS, MOST_CARDS, PLANES, Pieces};
use crate::detail::silhouette::Silhouette;
use crate::foliage::needle_width;
use crate::settings::{Dressing, FoliageSettings};
use crate::{Body, Specimen};
use linden_skeleton::organs::{Organs, PROTOTYPES};

/// The pixels that a needle is wide on a card, at the least.
const NEEDLE_PX: f32 = 1.3;
/// Needles are drawn no more than this many times wider: beyond it they are straps.
const MOST_SCALE: f32 = 2.5;
/// Side of the pictures of needles that are drawn on cards, pixels: sprays of them have more pixels there than leaves.
const NEEDLES_PX: u32 = 320;
/// Different cards of the finest level where needles would have fewer pixels with more: with their images in a mirror as many
/// as others have. With 12 a pine of 20000 triangles covers 0.01 less of what both cover.
const FEWEST_FINE: usize = MOST_CARDS / 2;
/// A cell with its margins and what is lost around it, radii of its piece squared: 6 to 14 for a spruce and a pine in three
/// budgets.
const CELL: f32 = 10.0;
/// Pixels of a radius on the cards of further levels, in those of the finest one: they serve from where the tree is small.
const SHARES: [f32; 4] = [1.0, 0.75, 0.6, 0.5];

/// How cards are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grain {
    /// Different cards of the finest level.
    pub cards: usize,
    /// How many times wider needles are drawn, and fewer.
    pub needle_scale: f32,
    /// Whether most of the foliage is needles, or bare twigs: then each card is there in a mirror too. Those of
    /// further levels are smaller, but for bare twigs.
    pub is_fine: bool,
    /// Whether what cards show is mostly wood: see [`Silhouette`].
    pub is_bare: bool,
}

impl Grain {
    /// What suits the finest of some levels, on a picture of `size_px` pixels a side.
    pub fn of(levels: &[Pieces], specimen: &Specimen<'_>, body: Body<'_>, size_px: u32) -> Self {
        let Body { skeleton, organs, .. } = body;
        // Bare twigs are as fine.
        if Silhouette::of(skeleton, organs).is_mostly_wood() {
            return Self { cards: FEWEST_FINE, needle_scale: 1.0, is_fine: true, is_bare: true };
        }
        let needle = levels.first().and_then(|level| Some(needle_m(specimen, organs)? / level.radius_m()?));
        needle
            .map_or(Self { cards: MOST_CARDS, needle_scale: 1.0, is_fine: false, is_bare: false }, |needle| {
                Self::of_needles(needle, levels.len(), size_px)
            })
    }

    /// Shapes of each card.
    pub const fn faces(&self) -> usize {
        if self.is_fine { 2 } else { 1 }
    }

    /// How large cards of a level are, 0 for the finest, beside those of the finest one.
    pub fn share(&self, level: usize) -> f32 {
        // The larger pieces of further levels have more of them.
        if self.is_fine && !self.is_bare { share(level) } else { 1.0 }
    }

    /// How leaves are drawn that are to be on cards; `None`: as they are.
    pub fn dressing(&self, asked: &Dressing) -> Option<Dressing> {
        (self.needle_scale > 1.0).then(|| {
            let mut dressing = asked.clone();
            let FoliageSettings { size_px, needle_scale, .. } = &mut dressing.foliage;
            *size_px = NEEDLES_PX.min(2 * *size_px);
            *needle_scale = self.needle_scale;
            dressing
        })
    }

    /// Where needles are so wide, in radii of the pieces.
    fn of_needles(needle: f32, levels: usize, size_px: u32) -> Self {
        let wide_px = |cards: usize| needle * radius_px(cards, levels, size_px);
        let fits = |cards: &usize| wide_px(*cards) >= NEEDLE_PX;
        let cards = (FEWEST_FINE..=MOST_CARDS).rev().find(fits).unwrap_or(FEWEST_FINE);
        Self {
            cards,
            needle_scale: (NEEDLE_PX / wide_px(cards)).clamp(1.0, MOST_SCALE),
            is_fine: true,
            is_bare: false,
        }
    }
}

/// How many different cards the level after one of so many has.
pub(super) fn next(cards: usize) -> usize {
    (cards * 2 / 3).max(FEWEST_CARDS)
}

/// How large cards of needles are in a level, 0 for the finest, beside those of the finest one.
fn share(level: usize) -> f32 {
    SHARES[level.min(SHARES.len() - 1)]
}

/// About how many pixels a piece's radius has on the cards of the finest level.
fn radius_px(cards: usize, levels: usize, size_px: u32) -> f32 {
    let (mut cells, mut cards) = (0.0, cards);
    for level in 0..levels {
        cells += (PLANES * cards) as f32 * share(level) * share(level);
        cards = next(cards);
    }
    size_px as f32 / (cells * CELL).sqrt()
}

/// How wide needles are, metres, where most of the foliage is made of them; the mean.
fn needle_m(specimen: &Specimen<'_>, organs: &Organs) -> Option<f32> {
    let kinds: Vec<Option<f32>> = specimen.dressing.foliage.kinds().map(needle_width).collect();
    let placed = &organs.placed;
    let (mut all, mut needles, mut wide) = (0.0, 0.0, 0.0);
    for (&prototype, &size_m) in placed.prototypes.iter().zip(&placed.sizes_m) {
        let weight = f64::from(size_m * size_m);
        all += weight;
        let shape = usize::from(prototype).checked_sub(PROTOTYPES.len()).and_then(|at| organs.shapes.get(at));
        if let Some(share) = shape.and_then(|shape| *kinds.get(usize::from(shape.kind))?) {
            needles += weight;
            wide += weight * f64::from(size_m * share);
        }
    }
    (needles > all / 2.0).then(|| (wide / needles) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needles_have_their_pixels_by_fewer_cards_and_then_by_their_width() {
        for (needle, levels, size_px) in
            [(0.0109, 1, 1024), (0.0067, 1, 1024), (0.0109, 3, 1024), (0.02, 1, 2048)]
        {
            let grain = Grain::of_needles(needle, levels, size_px);
            let wide_px = |cards: usize| needle * radius_px(cards, levels, size_px);
            let drawn_px = wide_px(grain.cards) * grain.needle_scale;
            let is_most = grain.needle_scale == MOST_SCALE;
            assert!(drawn_px > 0.999 * NEEDLE_PX || is_most, "{needle}: {drawn_px} pixels");
            assert!((FEWEST_FINE..=MOST_CARDS).contains(&grain.cards));
            assert!(grain.needle_scale == 1.0 || grain.cards == FEWEST_FINE, "fewer cards come first");
            // No fewer than they need.
            assert!(grain.cards == MOST_CARDS || wide_px(grain.cards + 1) < NEEDLE_PX);
        }
        assert_eq!(Grain::of_needles(0.1, 1, 1024).cards, MOST_CARDS, "as wide as leaves");
        assert!(
            Grain::of_needles(0.0109, 1, 2048).needle_scale < Grain::of_needles(0.0109, 1, 1024).needle_scale
        );
    }
}
