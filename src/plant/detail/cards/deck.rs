//! A few pieces that stand for all: the prototypes of branch cards.

use glam::{Vec2, Vec4};
use rayon::prelude::*;

use super::clusters::Cut;
use super::frame::Frame;
use super::{Pieces, Rod, rods};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::Skeleton;
use linden_skeleton::organs::Organs;

/// Squares along the side of the grid that tells pieces apart, on each of three planes.
const GRID: usize = 6;
/// How far that grid reaches from the middle, radii.
const REACH: f32 = 2.0;
const CELLS: usize = 3 * GRID * GRID;
/// Numbers of a [`Look`]: cells, a direction, and one more that makes them fours.
const LOOK: usize = CELLS + 4;
/// How much the mean direction counts beside the cells: what hangs from a level shoot is no shoot that hangs, though
/// both may lie in the same cells.
const DIRECTION: f32 = 0.3;
/// The fewest prototypes of which one is the top.
const LEAST_WITH_TOP: usize = 6;
/// Rounds of moving groups to their means.
const ROUNDS: usize = 8;

/// What stands for a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::detail) struct Card {
    /// An index into [`Deck::prototypes`].
    pub prototype: u8,
    /// Whether its left is the piece's right.
    pub is_mirrored: bool,
}

impl Card {
    /// Its number among shapes of which each prototype has as many, the second in a mirror.
    pub fn shape(self, faces: usize) -> usize {
        faces * usize::from(self.prototype) + usize::from(self.is_mirrored)
    }
}

/// Pieces, and which of them stands for each.
pub(in crate::detail) struct Deck {
    pub frames: Vec<Frame>,
    /// By piece.
    pub card_of: Vec<Card>,
    /// Pieces.
    pub prototypes: Vec<u32>,
    /// By prototype how much denser the pieces are that it stands for: their weight to an area of cards, as a share of its.
    pub densities: Vec<f32>,
}

/// Where a piece has its foliage, and which way that points on the whole, as it lies.
type Look = [f32; LOOK];

impl Deck {
    /// Chooses up to `most` prototypes, such that each piece is much like its own, or where it may, like that in a mirror:
    /// k-means over where foliage is (Lloyd 1982), begun with pieces evenly chosen, ended with the piece nearest to each
    /// mean. The top of a tree with one leader, which is seen against the sky, stands for itself.
    pub fn new(
        pieces: &Pieces,
        skeleton: &Skeleton,
        organs: &Organs,
        (most, may_mirror): (usize, bool),
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let Pieces { cut, is_thin, forms } = pieces;
        let frames: Vec<Frame> = cut
            .pieces
            .iter()
            .map(|(node, mass)| {
                let parent = skeleton.parents[*node as usize];
                let foot = skeleton.positions[if parent == u32::MAX { *node } else { parent } as usize];
                Frame::of(mass, foot)
            })
            .collect();
        let looks = looks(cut, &frames, rods(skeleton, organs, forms, is_thin));
        monitor.check()?;
        let count = frames.len();
        let top = (most >= LEAST_WITH_TOP && count > most).then(|| leader(cut, skeleton)).flatten();
        let groups = (most - usize::from(top.is_some())).clamp(1, usize::from(u8::MAX) - 1).min(count);
        let mut means: Vec<Look> = (0..groups).map(|i| looks[(2 * i + 1) * count / (2 * groups)]).collect();
        let mut group_of = vec![(0, false); count];
        for _ in 0..ROUNDS {
            monitor.check()?;
            group_of = looks.par_iter().map(|look| nearest(look, &means, may_mirror)).collect();
            let mut sums = vec![([0.0_f32; LOOK], 0.0_f32); groups];
            for (look, &(group, is_mirrored)) in looks.iter().zip(&group_of) {
                let (sum, count) = &mut sums[group];
                sum.iter_mut().zip(turned(look, is_mirrored)).for_each(|(sum, value)| *sum += value);
                *count += 1.0;
            }
            for (mean, (sum, count)) in means.iter_mut().zip(sums) {
                if count > 0.0 {
                    *mean = sum.map(|value| value / count);
                }
            }
        }
        let mut best: Vec<Option<(f32, u32)>> = vec![None; groups];
        for (piece, (look, &(group, is_mirrored))) in looks.iter().zip(&group_of).enumerate() {
            let away = distance(&turned(look, is_mirrored), &means[group]);
            if best[group].is_none_or(|(least, _)| away < least) {
                best[group] = Some((away, piece as u32));
            }
        }
        let mut number = vec![(0, false); groups];
        let mut prototypes = Vec::with_capacity(groups);
        for (group, found) in best.into_iter().enumerate() {
            if let Some((_, piece)) = found {
                number[group] = (prototypes.len() as u8, group_of[piece as usize].1);
                prototypes.push(piece);
            }
        }
        let card = |(group, is_mirrored): (usize, bool)| {
            let (prototype, as_drawn) = number[group];
            Card { prototype, is_mirrored: is_mirrored != as_drawn }
        };
        let mut card_of: Vec<Card> = group_of.into_iter().map(card).collect();
        if let Some(top) = top.filter(|&top| prototypes[usize::from(card_of[top as usize].prototype)] != top)
        {
            card_of[top as usize] = Card { prototype: prototypes.len() as u8, is_mirrored: false };
            prototypes.push(top);
        }
        let densities = densities(cut, &frames, &card_of, &prototypes);
        Ok(Self { frames, card_of, prototypes, densities })
    }
}

/// See [`Deck::densities`].
fn densities(cut: &Cut, frames: &[Frame], card_of: &[Card], prototypes: &[u32]) -> Vec<f32> {
    let area_m2 = |piece: usize| f64::from(frames[piece].radius_m) * f64::from(frames[piece].radius_m);
    let mut sums = vec![(0.0, 0.0); prototypes.len()];
    for (piece, card) in card_of.iter().enumerate() {
        let (weight, cards_m2) = &mut sums[usize::from(card.prototype)];
        *weight += cut.pieces[piece].1.weight;
        *cards_m2 += area_m2(piece);
    }
    let density = |(&prototype, (weight, cards_m2)): (&u32, (f64, f64))| {
        let prototype = prototype as usize;
        let shown = cut.pieces[prototype].1.weight / area_m2(prototype) * cards_m2;
        (weight / shown.max(f64::MIN_POSITIVE)) as f32
    };
    prototypes.iter().zip(sums).map(density).collect()
}

/// The piece that reaches highest, where it is what a stem ends in: the top of a tree with one leader.
fn leader(cut: &Cut, skeleton: &Skeleton) -> Option<u32> {
    let highest = cut.highest()?;
    let (node, _) = cut.pieces[highest as usize];
    let mut stems = skeleton.axes.iter().filter(|axis| axis.order == 0);
    stems.any(|stem| skeleton.nodes_of(stem).contains(&node)).then_some(highest)
}

/// Squared. Four sums at a time, which is what makes it fast.
fn distance(a: &Look, b: &Look) -> f32 {
    const { assert!(LOOK.is_multiple_of(4)) };
    let pairs = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
    let squares = pairs.fold(Vec4::ZERO, |sum, (&a, &b)| {
        let away = Vec4::from(a) - Vec4::from(b);
        sum + away * away
    });
    squares.element_sum()
}

/// The nearest mean, and whether that is the nearest to the look in a mirror.
fn nearest(look: &Look, means: &[Look], may_mirror: bool) -> (usize, bool) {
    let of = |look: &Look| {
        let away = means.iter().map(|mean| distance(look, mean)).enumerate();
        away.min_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or((0, f32::INFINITY))
    };
    let (group, away) = of(look);
    let (other, mirrored) = if may_mirror { of(&turned(look, true)) } else { (0, f32::INFINITY) };
    if mirrored < away { (other, true) } else { (group, false) }
}

/// A look as it is, or with left and right changed.
fn turned(look: &Look, is_mirrored: bool) -> Look {
    if !is_mirrored {
        return *look;
    }
    let mut turned = *look;
    // The planes in which columns go from left to right: see `looks`.
    for plane in [0, 2] {
        for row in turned[plane * GRID * GRID..][..GRID * GRID].chunks_exact_mut(GRID) {
            row.reverse();
        }
    }
    turned[CELLS] = -turned[CELLS];
    turned
}

/// The share of each piece's foliage in each square of the grids, and its mean direction.
fn looks(cut: &Cut, frames: &[Frame], rods: impl Iterator<Item = Rod>) -> Vec<Look> {
    let mut looks = vec![[0.0; LOOK]; frames.len()];
    for Rod { node, from, to, weight } in rods {
        let Some(&piece) = cut.piece_of.get(node as usize) else { continue };
        let Some(frame) = frames.get(piece as usize) else { continue };
        let weight = weight / cut.pieces[piece as usize].1.weight as f32;
        let direction = frame.turned((to - from).normalize_or_zero()) * (DIRECTION * weight);
        let sums = looks[piece as usize][CELLS..].iter_mut();
        sums.zip(direction.to_array()).for_each(|(sum, part)| *sum += part);
        for share in [0.25, 0.75] {
            let at = frame.local(from.lerp(to, share));
            let planes = [Vec2::new(at.x, at.y), Vec2::new(at.y, at.z), Vec2::new(at.x, at.z)];
            for (plane, at) in planes.into_iter().enumerate() {
                splat(&mut looks[piece as usize][plane * GRID * GRID..], at, weight / 2.0);
            }
        }
    }
    looks
}

/// Adds to the four squares around a place.
fn splat(grid: &mut [f32], at: Vec2, weight: f32) {
    let side = GRID as f32;
    let place = ((at / REACH * 0.5 + 0.5) * side - 0.5).clamp(Vec2::ZERO, Vec2::splat(side - 1.001));
    let cell = place.y as usize * GRID + place.x as usize;
    let (s, t) = (place.x.fract(), place.y.fract());
    grid[cell] += (1.0 - s) * (1.0 - t) * weight;
    grid[cell + 1] += s * (1.0 - t) * weight;
    grid[cell + GRID] += (1.0 - s) * t * weight;
    grid[cell + GRID + 1] += s * t * weight;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::Simplifier;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;

    #[test]
    fn cards_stand_for_as_much_as_their_pieces_have() {
        let subject = Subject::builtin("hazel", &[("season", "1")]);
        let grown = subject.grow();
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        let detail = simplifier.within(3000, true, &Quiet).unwrap();
        let pieces = simplifier.pieces(&detail, &Quiet).unwrap();
        let deck = Deck::new(&pieces, &grown.skeleton, &grown.organs, (8, true), &Quiet).unwrap();
        let weight = |piece: usize| pieces.cut.pieces[piece].1.weight;
        let (mut shown, mut unlike) = (0.0, 0);
        for (piece, card) in deck.card_of.iter().enumerate() {
            let (prototype, density) = (
                deck.prototypes[usize::from(card.prototype)] as usize,
                deck.densities[usize::from(card.prototype)],
            );
            let scale = f64::from(deck.frames[piece].radius_m / deck.frames[prototype].radius_m);
            shown += weight(prototype) * scale * scale * f64::from(density);
            unlike += usize::from((density - 1.0).abs() > 0.05);
        }
        let all: f64 = (0..deck.card_of.len()).map(weight).sum();
        assert!((shown / all - 1.0).abs() < 1e-4, "{shown} of {all}");
        assert!(unlike > deck.card_of.len() / 4, "{unlike} of {}", deck.card_of.len());
    }

    #[test]
    fn a_piece_and_its_image_in_a_mirror_are_told_apart_and_share_a_card() {
        // Foliage at one place and what points to one side.
        let mut look = [0.0; LOOK];
        for (plane, at) in
            [Vec2::new(0.9, 0.4), Vec2::new(0.4, -0.3), Vec2::new(0.9, -0.3)].into_iter().enumerate()
        {
            splat(&mut look[plane * GRID * GRID..], at, 1.0);
        }
        look[CELLS] = 0.2;
        let mut image = [0.0; LOOK];
        for (plane, at) in
            [Vec2::new(-0.9, 0.4), Vec2::new(0.4, -0.3), Vec2::new(-0.9, -0.3)].into_iter().enumerate()
        {
            splat(&mut image[plane * GRID * GRID..], at, 1.0);
        }
        image[CELLS] = -0.2;
        assert!(distance(&turned(&look, true), &image) < 1e-6 && distance(&look, &image) > 0.5);
        let means = [[0.0; LOOK], look];
        assert_eq!(nearest(&look, &means, true), (1, false));
        assert_eq!(nearest(&image, &means, true), (1, true));
        assert_eq!(nearest(&image, &means, false), (0, false));
    }
}
