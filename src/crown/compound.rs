//! A crown made of others: put together, cut away.
//!
//! The solid is what its pieces leave in their order, as in constructive solid geometry:
//! `((first + second) − third) + …`.
//!
//! A point is drawn in one of the pieces that add, chosen by volume, and kept when the solid
//! contains it; of the `m` adding pieces that contain a place each would draw it, so it is kept with a
//! chance of 1 in `m`. That is uniform over the solid, and as exact as the volumes of the pieces.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Crown;
use super::skin::Skin;
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

/// The effect of a piece on those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Its inside belongs to the solid.
    Add,
    /// Its inside does not.
    Subtract,
}

/// A piece, and what it does.
pub struct Piece {
    /// Whether it adds or subtracts.
    pub operation: Operation,
    /// The solid, where it stands.
    pub crown: Box<dyn Crown>,
}

/// Why pieces make no solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompoundError {
    /// Next to nothing is left.
    #[error("nothing to speak of is left of the crown once piece {piece} is subtracted")]
    Nothing {
        /// The piece that takes most of it, from 0.
        piece: usize,
    },
    /// Nothing was there to begin with.
    #[error("no piece adds to the crown")]
    NoPiece,
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Points that measure the volume: a standard error below 0.6 % where half of the pieces is left.
const PROBES: u64 = 1 << 15;

/// With a smaller part of its pieces left, drawing points would take for ever.
const LEAST_LEFT: f64 = 1e-3;

/// Several crowns as one.
pub struct Compound {
    pieces: Vec<Piece>,
    /// Volumes of the adding pieces up to each one; a subtracting piece adds nothing.
    up_to_m3: Vec<f64>,
    bounds: Bounds,
    volume_m3: f64,
}

impl Compound {
    /// Puts pieces together, in their order.
    ///
    /// # Errors
    /// [`CompoundError`]: less than a thousandth of the pieces' volume is left, or cancelled.
    pub fn new(pieces: Vec<Piece>, monitor: &dyn Monitor) -> Result<Self, CompoundError> {
        let adding = || pieces.iter().filter(|piece| piece.operation == Operation::Add);
        let bounds = adding().map(|piece| piece.crown.bounds());
        let bounds = Bounds::of(bounds.flat_map(|b| [b.min, b.max])).ok_or(CompoundError::NoPiece)?;
        let mut total_m3 = 0.0;
        let up_to_m3 = pieces
            .iter()
            .map(|piece| {
                if piece.operation == Operation::Add {
                    total_m3 += piece.crown.volume_m3();
                }
                total_m3
            })
            .collect();
        let mut solid = Self { pieces, up_to_m3, bounds, volume_m3: 0.0 };
        solid.volume_m3 = solid.measure(total_m3, monitor)?;
        Ok(solid)
    }

    /// Which pieces contain a place is asked for at most once each: a mesh takes microseconds.
    ///
    /// Whether the solid contains it, how many adding pieces do, and the last piece that took it away.
    fn ask(&self, p: DVec3) -> (bool, u32, Option<usize>) {
        let (mut inside, mut adding, mut taken_by) = (false, 0, None);
        for (i, Piece { operation, crown }) in self.pieces.iter().enumerate() {
            match operation {
                Operation::Add if crown.contains(p) => {
                    inside = true;
                    adding += 1;
                }
                Operation::Subtract if inside && crown.contains(p) => {
                    inside = false;
                    taken_by = Some(i);
                }
                _ => {}
            }
        }
        (inside, adding, taken_by)
    }

    /// Stratified by pieces: each adding piece is probed in proportion to its volume, a probe counts
    /// 1 in `m`, so that the expected sum is the solid's volume.
    fn measure(&self, total_m3: f64, monitor: &dyn Monitor) -> Result<f64, CompoundError> {
        let mut volume_m3 = 0.0;
        let mut taken = vec![0_u64; self.pieces.len()];
        for (i, piece) in self.pieces.iter().enumerate() {
            if piece.operation == Operation::Subtract {
                continue;
            }
            let piece_m3 = piece.crown.volume_m3();
            let probes = ((piece_m3 / total_m3 * PROBES as f64).ceil() as u64).max(PROBES / 64);
            let key = Key::new(0).named("compound").child(i as u64);
            let answers: Vec<_> = (0..probes)
                .into_par_iter()
                .map(|probe| {
                    monitor.check()?;
                    Ok(self.ask(piece.crown.sample(key.child(probe))))
                })
                .collect::<Result<_, Cancelled>>()?;
            // In the order of the probes: a sum of fractions must not depend on threads.
            let kept: f64 =
                answers.iter().filter(|answer| answer.0).map(|&(_, m, _)| 1.0 / f64::from(m.max(1))).sum();
            volume_m3 += piece_m3 * kept / probes as f64;
            for by in answers.iter().filter_map(|answer| answer.2) {
                taken[by] += 1;
            }
        }
        if volume_m3 < LEAST_LEFT * total_m3 {
            let most = taken.iter().max().copied().unwrap_or(0);
            let piece = taken.iter().position(|&count| count == most).unwrap_or(0);
            return Err(CompoundError::Nothing { piece });
        }
        Ok(volume_m3)
    }
}

impl Crown for Compound {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn contains(&self, p: DVec3) -> bool {
        // The last piece that contains it decides.
        let last = self.pieces.iter().rev().find(|piece| piece.crown.contains(p));
        last.is_some_and(|piece| piece.operation == Operation::Add)
    }

    /// At most 1000 attempts on average, multiplied by how many pieces overlap.
    fn sample(&self, key: Key) -> DVec3 {
        let total = self.up_to_m3.last().copied().unwrap_or(0.0);
        let mut attempt = 0;
        loop {
            let key = key.child(attempt);
            let volume = key.named("piece").unit() * total;
            let slot = self.up_to_m3.partition_point(|&up_to| up_to <= volume).min(self.pieces.len() - 1);
            let p = self.pieces[slot].crown.sample(key);
            let (inside, adding, _) = self.ask(p);
            if inside && key.named("kept").unit() * f64::from(adding) < 1.0 {
                return p;
            }
            attempt += 1;
        }
    }

    /// Pieces that subtract are dashed.
    fn outline(&self) -> Vec<Vec<Vec3>> {
        let lines = |piece: &Piece| {
            let lines = piece.crown.outline();
            match piece.operation {
                Operation::Add => lines,
                Operation::Subtract => dashed(&lines),
            }
        };
        self.pieces.iter().flat_map(lines).collect()
    }

    /// The skins of the pieces that add.
    fn skin(&self) -> Skin {
        let adding = self.pieces.iter().filter(|piece| piece.operation == Operation::Add);
        Skin::together(adding.map(|piece| piece.crown.skin()))
    }

    fn volume_m3(&self) -> f64 {
        self.volume_m3
    }
}

/// Lines as dashes.
pub fn dashed(lines: &[Vec<Vec3>]) -> Vec<Vec<Vec3>> {
    lines.iter().flat_map(|line| dashes(line)).collect()
}

/// Every other piece of a line.
fn dashes(line: &[Vec3]) -> Vec<Vec<Vec3>> {
    /// Dashes of a line at least, with gaps of their length.
    const DASHES: f32 = 12.0;
    let length: f32 = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let dash = length / (2.0 * DASHES - 1.0);
    if dash.is_nan() || dash <= 0.0 {
        return Vec::new();
    }
    let mut dashes = Vec::new();
    let mut before = 0.0;
    for ends in line.windows(2) {
        let piece_length = ends[0].distance(ends[1]);
        let (first, last) =
            ((before / (2.0 * dash)).floor(), ((before + piece_length) / (2.0 * dash)).ceil());
        for i in first as u32..last as u32 {
            let from = (i as f32 * 2.0 * dash - before).max(0.0);
            let to = ((i as f32 * 2.0 + 1.0) * dash - before).min(piece_length);
            if from < to {
                dashes.push(vec![
                    ends[0].lerp(ends[1], from / piece_length),
                    ends[0].lerp(ends[1], to / piece_length),
                ]);
            }
        }
        before += piece_length;
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placed::PlacedCrown;
    use crate::tests::{assert_uniform, volume_by_probes};
    use crate::{shape, units};
    use linden_base::knob::Value;
    use linden_base::monitor::Quiet;

    fn ball(radius: f64, at: [f64; 3]) -> Box<dyn Crown> {
        let ball = shape("sphere").unwrap().of(&[("crown_radius", Value::Real(radius))]).unwrap();
        Box::new(PlacedCrown::new(ball, DVec3::from_array(at), 0.0, 1.0))
    }

    fn add(crown: Box<dyn Crown>) -> Piece {
        Piece { operation: Operation::Add, crown }
    }

    fn subtract(crown: Box<dyn Crown>) -> Piece {
        Piece { operation: Operation::Subtract, crown }
    }

    fn compound(pieces: Vec<Piece>) -> Compound {
        Compound::new(pieces, &Quiet).unwrap()
    }

    /// Pieces that overlap, a bite, and a kernel put back into it.
    fn bitten() -> Compound {
        compound(vec![
            add(ball(3.0, [0.0, 0.0, 0.0])),
            add(ball(2.0, [2.5, 1.0, 0.0])),
            subtract(ball(2.0, [0.0, 2.5, 0.5])),
            add(ball(1.0, [0.0, 3.5, 0.5])),
        ])
    }

    #[test]
    fn inside_is_what_the_pieces_leave_in_their_order() {
        let solid = bitten();
        let (min, size) = (solid.bounds().min.as_dvec3(), solid.bounds().size().as_dvec3());
        let in_ball = |p: DVec3, r: f64, c: [f64; 3]| p.distance(DVec3::from_array(c)) <= r;
        let mut inside = 0;
        for i in 0..20_000 {
            let p = min + size * DVec3::from(units(Key::new(5).child(i)));
            let body = in_ball(p, 3.0, [0.0, 3.0, 0.0]) || in_ball(p, 2.0, [2.5, 3.0, 0.0]);
            let expected = (body && !in_ball(p, 2.0, [0.0, 4.5, 0.5])) || in_ball(p, 1.0, [0.0, 4.5, 0.5]);
            assert_eq!(solid.contains(p), expected, "{p}");
            assert_eq!(solid.ask(p).0, expected, "{p}");
            inside += u32::from(expected);
        }
        assert!(inside > 2000);
    }

    #[test]
    fn points_are_uniform_in_volume() {
        for solid in [
            bitten(),
            // Twice the same: every place has two pieces.
            compound(vec![add(ball(3.0, [0.0; 3])), add(ball(3.0, [0.0; 3]))]),
            // A shell.
            compound(vec![add(ball(3.0, [0.0; 3])), subtract(ball(1.3, [0.0, 1.7, 0.0]))]),
        ] {
            assert_uniform(&solid);
        }
    }

    #[test]
    fn volumes_are_those_of_the_solids() {
        let shell = compound(vec![add(ball(3.0, [0.0; 3])), subtract(ball(2.0, [0.0, 1.0, 0.0]))]);
        let expected = std::f64::consts::PI * 4.0 / 3.0 * (27.0 - 8.0);
        assert!((shell.volume_m3() / expected - 1.0).abs() < 0.01, "{}", shell.volume_m3() / expected);
        let twice = compound(vec![add(ball(3.0, [0.0; 3])), add(ball(3.0, [0.0; 3]))]);
        let one = ball(3.0, [0.0; 3]).volume_m3();
        assert!((twice.volume_m3() / one - 1.0).abs() < 1e-9, "no probe is lost");
        let solid = bitten();
        assert!((volume_by_probes(&solid) / solid.volume_m3() - 1.0).abs() < 0.02);
    }

    #[test]
    fn what_takes_everything_is_named() {
        let pieces = vec![
            add(ball(2.0, [0.0; 3])),
            subtract(ball(0.5, [0.0; 3])),
            subtract(ball(3.0, [0.0, -1.0, 0.0])),
        ];
        assert_eq!(Compound::new(pieces, &Quiet).err(), Some(CompoundError::Nothing { piece: 2 }));
        assert_eq!(Compound::new(Vec::new(), &Quiet).err(), Some(CompoundError::NoPiece));
        let only = vec![subtract(ball(2.0, [0.0; 3]))];
        assert_eq!(Compound::new(only, &Quiet).err(), Some(CompoundError::NoPiece));
    }

    #[test]
    fn dashes_cover_half_of_a_line() {
        let line: Vec<Vec3> = (0..40).map(|i| Vec3::new(i as f32 * 0.3, 0.0, 0.0)).collect();
        let dashes = dashes(&line);
        let drawn: f32 = dashes.iter().map(|dash| dash[0].distance(dash[1])).sum();
        assert!((drawn / 11.7 - 12.0 / 23.0).abs() < 1e-3, "{drawn}");
        assert!(dashes.iter().flatten().all(|p| (0.0..=11.7001).contains(&p.x)));
    }
}
