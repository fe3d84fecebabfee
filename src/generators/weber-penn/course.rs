//! The course of one stem: its segments, and those of the clones that split from it.
//!
//! Z is up here, as in the paper; a frame's z axis runs along its segment.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use linden_base::random::Key;

use crate::level::Level;

/// What a stem's course follows from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start<'a> {
    pub key: Key,
    /// Metres.
    pub origin: DVec3,
    pub frame: DQuat,
    pub level: &'a Level,
    /// Clones at the end of the first segment.
    pub base_splits: u32,
    /// How far it turns up; 0 for the trunk and its branches.
    pub attraction: f64,
    /// More segments are too many.
    pub most_segments: usize,
}

/// A stem from its foot to its tip, or a clone from where it splits off.
#[derive(Clone, Debug)]
pub(crate) struct Limb {
    pub key: Key,
    /// The limb that it splits from, at the end of the segment before its first.
    pub parent: Option<usize>,
    /// The number of its first segment.
    pub first: u32,
    /// Where its segments begin, and where the last ends.
    pub points: Vec<DVec3>,
    /// How its segments stand.
    pub frames: Vec<DQuat>,
    /// Of each segment: how much of a whole stem's children it bears.
    pub shares: Vec<f64>,
    /// Half turns by which the spiral of its children is behind that of the stem.
    pub half_turns: u32,
}

/// A limb on its way.
struct Growing {
    limb: Limb,
    position: DVec3,
    frame: DQuat,
    /// What splits have bent it and each further segment undoes, radians.
    correction: f64,
    /// What rounding the number of clones left over.
    error: f64,
    share: f64,
}

impl Start<'_> {
    /// The limbs of the stem if it is so long, metres; the stem itself is the first. `None`: they are too many.
    pub fn trace(&self, length_m: f64) -> Option<Vec<Limb>> {
        let segment_m = length_m / f64::from(self.level.segments);
        let whole = Growing {
            limb: Limb {
                key: self.key,
                parent: None,
                first: 0,
                points: Vec::new(),
                frames: Vec::new(),
                shares: Vec::new(),
                half_turns: 0,
            },
            position: self.origin,
            frame: self.frame,
            correction: 0.0,
            error: first_error(self.key),
            share: 1.0,
        };
        let mut limbs: Vec<Limb> = Vec::new();
        let mut waiting = std::collections::VecDeque::from([whole]);
        let mut segments = 0;
        while let Some(growing) = waiting.pop_front() {
            let index = limbs.len();
            let (limb, clones) = self.grow(growing, index, segment_m);
            segments += limb.frames.len();
            limbs.push(limb);
            waiting.extend(clones);
            if segments + waiting.len() > self.most_segments {
                return None;
            }
        }
        Some(limbs)
    }

    /// Grows a limb to its tip; the clones that split from it are to be grown yet.
    fn grow(&self, growing: Growing, index: usize, segment_m: f64) -> (Limb, Vec<Growing>) {
        let Growing { mut limb, mut position, mut frame, mut correction, mut error, mut share } = growing;
        let level = self.level;
        let (bends, splits) = (limb.key.named("bend"), limb.key.named("split"));
        let mut clones = Vec::new();
        limb.points.push(position);
        for segment in limb.first..level.segments {
            if segment > 0 {
                let bend = level.curve_spread.max(0.0) / f64::from(level.segments)
                    * bends.child(segment.into()).between(-1.0, 1.0);
                frame *= DQuat::from_rotation_x(level.turn(segment) + bend + correction);
                frame *= DQuat::from_rotation_x(-self.rise(frame));
            }
            position += frame * DVec3::Z * segment_m;
            limb.points.push(position);
            limb.frames.push(frame);
            limb.shares.push(share);
            if segment + 1 == level.segments {
                break;
            }
            let is_base = self.base_splits > 0 && segment == 0;
            let count = if is_base { self.base_splits } else { diffused(level.seg_splits, &mut error) };
            if count == 0 {
                continue;
            }
            share /= f64::from(count + 1);
            let key = splits.child(segment.into());
            let left = f64::from(level.segments - segment - 1);
            for clone in 1..=count {
                let fork = Fork { key: key.child(clone.into()), clone, count, is_base };
                let (turned, angle) = self.fork(frame, &fork);
                let clone_key = limb.key.named("clone").child(segment.into()).child(clone.into());
                clones.push(Growing {
                    limb: Limb {
                        key: clone_key,
                        parent: Some(index),
                        first: segment + 1,
                        points: Vec::new(),
                        frames: Vec::new(),
                        shares: Vec::new(),
                        half_turns: limb.half_turns + clone,
                    },
                    position,
                    frame: turned,
                    correction: correction - angle / left,
                    error: first_error(clone_key),
                    share,
                });
            }
            let fork = Fork { key: key.child(0), clone: 0, count, is_base };
            let (turned, angle) = self.fork(frame, &fork);
            frame = turned;
            correction -= angle / left;
        }
        (limb, clones)
    }

    /// How far a segment turns up, radians: `A · declination · cos(orientation) / segments`.
    fn rise(&self, frame: DQuat) -> f64 {
        if self.attraction == 0.0 {
            return 0.0;
        }
        let orientation = (frame * DVec3::Y).z;
        self.attraction * declination(frame) * orientation / f64::from(self.level.segments)
    }

    /// The frame of a stem or a clone behind a fork, and how far it was bent, radians.
    fn fork(&self, frame: DQuat, fork: &Fork) -> (DQuat, f64) {
        let level = self.level;
        let drawn = level.split_angle_spread * fork.key.child(0).between(-1.0, 1.0);
        if level.split_angle < 0.0 {
            // A flat fork: all limbs in one plane, evenly apart.
            let place = f64::from(fork.clone) / f64::from(fork.count) - 0.5;
            let angle = (2.0 * place) * (level.split_angle.abs() + drawn);
            return (frame * DQuat::from_rotation_y(angle), 0.0);
        }
        let slope = declination(frame);
        let angle = (level.split_angle + drawn - slope).max(0.0);
        let tilted = frame * DQuat::from_rotation_x(angle);
        if fork.clone == 0 {
            return (tilted, angle);
        }
        let spread = if fork.is_base {
            TAU * f64::from(fork.clone) / f64::from(fork.count + 1)
        } else {
            let (chance, side) = (fork.key.child(1).unit(), fork.key.child(2).unit());
            let degrees = 20.0 + 0.75 * (30.0 + (slope.to_degrees() - 90.0).abs()) * chance * chance;
            degrees.to_radians() * if side < 0.5 { -1.0 } else { 1.0 }
        };
        (DQuat::from_rotation_z(spread) * tilted, angle)
    }
}

/// One way on from where a stem splits; that of number 0 is the stem's.
struct Fork {
    key: Key,
    clone: u32,
    count: u32,
    is_base: bool,
}

/// Angle to the vertical, radians.
fn declination(frame: DQuat) -> f64 {
    libm::acos((frame * DVec3::Z).z.clamp(-1.0, 1.0))
}

/// What rounding leaves over before the first segment. The paper carries it on from stem to stem, in an order
/// that threads do not have; drawn for each limb, every segment splits as often as it is to on average.
fn first_error(key: Key) -> f64 {
    key.named("splits").between(-0.5, 0.5)
}

/// A whole number near `x`; the error that it makes is carried on, so that the mean of many is `x`.
pub(crate) fn diffused(x: f64, error: &mut f64) -> u32 {
    let whole = libm::floor(x + *error + 0.5).max(0.0);
    *error -= whole - x;
    whole as u32
}

/// Places along a limb.
pub(crate) struct Line<'a> {
    limb: &'a Limb,
    segment_m: f64,
    helix: Option<f64>,
    is_smooth: bool,
}

impl<'a> Line<'a> {
    pub fn new(limb: &'a Limb, level: &Level, segment_m: f64, is_smooth: bool) -> Self {
        Self { limb, segment_m, helix: level.helix(), is_smooth }
    }

    /// A segment (counted from the limb's first) and how much of it lies below an offset from the stem's foot.
    fn within(&self, offset_m: f64) -> (usize, f64) {
        let along = offset_m / self.segment_m - f64::from(self.limb.first);
        let last = self.limb.frames.len() - 1;
        let segment = (libm::floor(along).max(0.0) as usize).min(last);
        (segment, (along - segment as f64).clamp(0.0, 1.0))
    }

    /// The direction at the beginning of a segment.
    fn joint(&self, segment: usize) -> DVec3 {
        let along = |at: usize| self.limb.frames[at] * DVec3::Z;
        let last = self.limb.frames.len() - 1;
        if segment == 0 {
            along(0)
        } else if segment > last {
            along(last)
        } else {
            (along(segment - 1) + along(segment)).normalize_or(along(segment))
        }
    }

    /// The place at an offset from the stem's foot, and a frame whose z axis runs along the limb there.
    pub fn at(&self, offset_m: f64) -> (DVec3, DQuat) {
        let (segment, t) = self.within(offset_m);
        let (frame, start, end) =
            (self.limb.frames[segment], self.limb.points[segment], self.limb.points[segment + 1]);
        if let Some(slope) = self.helix {
            let radius_m = libm::tan(slope) * self.segment_m / TAU;
            let (sin, cos) = libm::sincos(TAU * t);
            let off = frame * DVec3::new(radius_m * (cos - 1.0), radius_m * sin, 0.0);
            let way = frame * DVec3::new(-sin * libm::tan(slope), cos * libm::tan(slope), 1.0);
            return (start.lerp(end, t) + off, turned(frame, way));
        }
        if !self.is_smooth {
            return (start.lerp(end, t), frame);
        }
        // Hermite's curve.
        let (m, n) = (self.joint(segment) * self.segment_m, self.joint(segment + 1) * self.segment_m);
        let (t2, t3) = (t * t, t * t * t);
        let place = start * (2.0 * t3 - 3.0 * t2 + 1.0)
            + m * (t3 - 2.0 * t2 + t)
            + end * (3.0 * t2 - 2.0 * t3)
            + n * (t3 - t2);
        let way =
            (end - start) * (6.0 * t - 6.0 * t2) + m * (3.0 * t2 - 4.0 * t + 1.0) + n * (3.0 * t2 - 2.0 * t);
        (place, turned(frame, way))
    }

    /// Offsets between a segment's ends at which the limb is to have nodes to look bent.
    pub fn between(&self, segment: usize) -> impl Iterator<Item = f64> + use<> {
        /// Radians between two nodes.
        const FINEST: f64 = PI / 15.0;
        const MOST: f64 = 6.0;
        const OF_A_TURN: f64 = 6.0;
        let bend = self.joint(segment).angle_between(self.joint(segment + 1));
        let pieces = match self.helix {
            Some(_) => OF_A_TURN,
            None if self.is_smooth => libm::ceil(bend / FINEST).clamp(1.0, MOST),
            None => 1.0,
        };
        let start = f64::from(self.limb.first) + segment as f64;
        let segment_m = self.segment_m;
        (1..pieces as u32).map(move |i| (start + f64::from(i) / pieces) * segment_m)
    }
}

/// A frame turned the shortest way so that its z axis has a direction.
fn turned(frame: DQuat, way: DVec3) -> DQuat {
    let (from, to) = (frame * DVec3::Z, way.normalize_or_zero());
    // Within a segment that is less than a right angle.
    if to == DVec3::ZERO || from.dot(to) < -0.9 { frame } else { DQuat::from_rotation_arc(from, to) * frame }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::WeberPenn;

    fn start(level: &Level) -> Start<'_> {
        Start {
            key: Key::new(3),
            origin: DVec3::ZERO,
            frame: DQuat::IDENTITY,
            level,
            base_splits: 0,
            attraction: 0.0,
            most_segments: 100_000,
        }
    }

    #[test]
    fn the_error_of_rounding_is_carried_on() {
        for x in [0.0, 0.1, 0.4, 0.5, 1.0, 1.7] {
            for first in [-0.5, 0.0, 0.49] {
                let mut error = first;
                let sum: u32 = (0..1000).map(|_| diffused(x, &mut error)).sum();
                assert!((f64::from(sum) - 1000.0 * x).abs() <= 1.0, "{x}: {sum}");
            }
        }
    }

    /// Over many stems the mean is right, too, though each has few segments.
    #[test]
    fn few_segments_split_as_often_as_they_are_to() {
        let settings = WeberPenn {
            seg_splits: vec![0.2],
            curve_res: vec![6.0],
            split_angle_deg: vec![10.0],
            ..WeberPenn::default()
        };
        let level = settings.level(0);
        let clones = |seed: u64| {
            let start = Start { key: Key::new(seed), ..start(&level) };
            start.trace(6.0).unwrap().len() as f64 - 1.0
        };
        let mean = (0..4000).map(clones).sum::<f64>() / 4000.0;
        // Each of five places multiplies the limbs by 1.2.
        let expected = libm::pow(1.2, 5.0) - 1.0;
        assert!((mean / expected - 1.0).abs() < 0.05, "{mean} for {expected}");
    }

    #[test]
    fn stems_bend_by_their_curve() {
        let settings = WeberPenn {
            curve_res: vec![10.0],
            curve_deg: vec![60.0],
            curve_back_deg: vec![-30.0],
            ..WeberPenn::default()
        };
        let mut level = settings.level(0);
        let turn = |level: &Level| {
            let limbs = start(level).trace(10.0).unwrap();
            (limbs[0].frames[0] * DVec3::Z).angle_between(limbs[0].frames[9] * DVec3::Z).to_degrees()
        };
        // Four turns of 12 degrees and five of -6.
        assert!((turn(&level) - 18.0).abs() < 1e-9, "{}", turn(&level));
        level.curve_back = 0.0;
        assert!((turn(&level) - 54.0).abs() < 1e-9);
    }

    #[test]
    fn a_helix_turns_once_a_segment_and_has_its_slope() {
        let settings =
            WeberPenn { curve_spread_deg: vec![-30.0], curve_res: vec![4.0], ..WeberPenn::default() };
        let level = settings.level(0);
        let limbs = start(&level).trace(4.0).unwrap();
        let line = Line::new(&limbs[0], &level, 1.0, true);
        for i in 0..40 {
            let (place, frame) = line.at(f64::from(i) * 0.1);
            assert!(((frame * DVec3::Z).angle_between(DVec3::Z).to_degrees() - 30.0).abs() < 1e-6);
            if i % 10 == 0 {
                assert!((place - DVec3::Z * f64::from(i) * 0.1).length() < 1e-9, "{place}");
            }
        }
    }

    #[test]
    fn a_smooth_stem_goes_through_the_ends_of_its_segments() {
        let settings =
            WeberPenn { curve_spread_deg: vec![300.0], curve_res: vec![8.0], ..WeberPenn::default() };
        let level = settings.level(0);
        let limbs = start(&level).trace(8.0).unwrap();
        let line = Line::new(&limbs[0], &level, 1.0, true);
        for (i, point) in limbs[0].points.iter().enumerate() {
            assert!(line.at(i as f64).0.distance(*point) < 1e-9);
        }
        let near = |offset: f64| (line.at(offset + 1e-6).0 - line.at(offset - 1e-6).0).normalize();
        assert!((1..8).all(|i| near(f64::from(i)).angle_between(line.at(f64::from(i)).1 * DVec3::Z) < 0.01));
    }
}
