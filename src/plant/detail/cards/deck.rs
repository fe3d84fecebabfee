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

/// Pieces, and which of them stands for each.
pub(in crate::detail) struct Deck {
    pub frames: Vec<Frame>,
    /// By piece, an index into `prototypes`.
    pub card_of: Vec<u8>,
    /// Pieces.
    pub prototypes: Vec<u32>,
}

/// Where a piece has its foliage, and which way that points on the whole, as it lies.
type Look = [f32; LOOK];

impl Deck {
    /// Chooses up to `most` prototypes, such that each piece is much like its own: k-means over where foliage is (Lloyd
    /// 1982), begun with pieces evenly chosen, ended with the piece nearest to each mean. The top of a tree with
    /// one leader, which is seen against the sky, stands for itself.
    pub fn new(
        pieces: &Pieces,
        skeleton: &Skeleton,
        organs: &Organs,
        most: usize,
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
        let mut group_of = vec![0; count];
        for _ in 0..ROUNDS {
            monitor.check()?;
            group_of = looks.par_iter().map(|look| nearest(look, &means)).collect();
            let mut sums = vec![([0.0_f32; LOOK], 0.0_f32); groups];
            for (look, &group) in looks.iter().zip(&group_of) {
                let (sum, count) = &mut sums[group];
                sum.iter_mut().zip(look).for_each(|(sum, value)| *sum += value);
                *count += 1.0;
            }
            for (mean, (sum, count)) in means.iter_mut().zip(sums) {
                if count > 0.0 {
                    *mean = sum.map(|value| value / count);
                }
            }
        }
        let mut best: Vec<Option<(f32, u32)>> = vec![None; groups];
        for (piece, (look, &group)) in looks.iter().zip(&group_of).enumerate() {
            let away = distance(look, &means[group]);
            if best[group].is_none_or(|(least, _)| away < least) {
                best[group] = Some((away, piece as u32));
            }
        }
        let mut number = vec![0; groups];
        let mut prototypes = Vec::with_capacity(groups);
        for (group, found) in best.into_iter().enumerate() {
            if let Some((_, piece)) = found {
                number[group] = prototypes.len() as u8;
                prototypes.push(piece);
            }
        }
        let mut card_of: Vec<u8> = group_of.into_iter().map(|group| number[group]).collect();
        if let Some(top) = top.filter(|&top| prototypes[usize::from(card_of[top as usize])] != top) {
            card_of[top as usize] = prototypes.len() as u8;
            prototypes.push(top);
        }
        Ok(Self { frames, card_of, prototypes })
    }
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

fn nearest(look: &Look, means: &[Look]) -> usize {
    let away = |&i: &usize| distance(look, &means[i]);
    (0..means.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
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
