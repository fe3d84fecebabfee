//! What a cloud says of its axes and units.
//!
//! A tree is narrow near the ground and wide above, along one axis only; and none is 150 m high.

use glam::{DVec3, Vec3};

use super::median::median;
use linden_base::input::Up;

/// Points looked at.
const SAMPLE: usize = 50_000;

/// Between these parts of the height a tree is a stem: above ground and grass, below most crowns.
const STEM: (f64, f64) = (0.05, 0.18);

/// A stem's spread is below this part of the whole tree's, where the axis is right;
const NARROW: f64 = 0.2;

/// and above this part of it where it is not.
const WIDE: f64 = 0.35;

/// What points say of the axis that is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpGuess {
    /// The tree stands along the usual axis.
    Usual,
    /// It stands along this one, which is not the usual one.
    Other(Up),
    /// It may stand along either.
    Undecided,
}

/// Which of Y and Z points up in `points` (in the file's axes), where it is `usual` in such files.
///
/// By coordinates that are no heights, as the northings of a map are; by a stem below a crown where there is one; else by how
/// much more the cloud looks like a tree that stands along one axis than along the other: slender and narrow at an end, narrow at
/// its foot, and with level slices about one axis. What would be wider than high stands along no other axis than the usual one by
/// its looks alone: it is a plot, or a tree with the ground around it.
pub fn guess_up(points: &[DVec3], usual: Up) -> UpGuess {
    let other = if usual == Up::Y { Up::Z } else { Up::Y };
    match [usual, other].map(|axis| is_of_map(points, axis)) {
        [true, false] => return UpGuess::Other(other),
        [false, true] => return UpGuess::Usual,
        _ => {}
    }
    let (Some(of_usual), Some(of_other)) = (Standing::along(points, usual), Standing::along(points, other))
    else {
        return UpGuess::Usual;
    };
    let steady = (of_other.wandering() - of_usual.wandering()).clamp(-MOST_STEADY, MOST_STEADY);
    let upright = of_usual.evidence() - of_other.evidence() + steady;
    // The tip of a limb is as narrow as a foot.
    let has_stem = of_usual.foot > WIDE && of_other.foot < NARROW && upright < 0.0;
    match upright {
        _ if has_stem && of_other.slender >= LEAST_WITH_STEM => UpGuess::Other(other),
        upright if upright <= LYING && of_other.slender >= LEAST_SLENDER => UpGuess::Other(other),
        upright if upright < DOUBTFUL => UpGuess::Undecided,
        _ => UpGuess::Usual,
    }
}

/// By so much more evidence for the other axis a tree lies along the usual one, and by so much for it that nothing needs to
/// be said. Trees of linden, bare, in leaf and with ground, have 0.25 (cedar) to 3.2 for their own, but for a bare date palm
/// (0); a strip of a plot has 0.5 against it at most.
const LYING: f64 = -0.6;
const DOUBTFUL: f64 = 0.2;

/// By so many times higher than wide a cloud stands along the other axis by its looks; and by so many where it has a stem.
const LEAST_SLENDER: f64 = 1.1;
const LEAST_WITH_STEM: f64 = 0.6;

/// Coordinates are those of a map, and no heights, where they are larger than this, and than so many times the extent along
/// that axis: a northing has millions of metres, a tree in millimetres far above the sea has not.
const MAP: f64 = 100_000.0;
const MAP_PER_EXTENT: f64 = 200.0;

/// Whether the coordinates along an axis are those of a map.
fn is_of_map(points: &[DVec3], axis: Up) -> bool {
    let along = sample(points).into_iter().map(|p| if axis == Up::Y { p.y } else { p.z });
    range(along).is_some_and(|(low, high)| {
        let nearest = if low <= 0.0 && high >= 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        nearest > MAP && nearest > MAP_PER_EXTENT * (high - low)
    })
}

/// How much slices about one axis say at most: a single leaning stem has none.
const MOST_STEADY: f64 = 1.2;

/// Slices of a bare stem that leans wander far beside their own width.
const SLIM: f64 = 0.25;

/// Level slices through the height of a cloud.
const LEVELS: usize = 20;

/// Fewer points of a slice say nothing.
const LEAST_OF_LEVEL: usize = 8;

/// A tree is narrower at one of its ends than this part of its widest slice; a row of trees has two wide ones.
const NARROW_END: f64 = 0.6;

/// How a cloud stands along an axis.
struct Standing {
    /// How wide it is at the foot, as a part of its width.
    foot: f64,
    /// Its height by its larger width.
    slender: f64,
    /// The width of the narrower end, as a part of the widest slice.
    end: f64,
    /// How far the middles of slices are from one axis, as a part of the slices' widths, of a slim stem of [`SLIM`] of the widest.
    wander: f64,
}

impl Standing {
    fn along(points: &[DVec3], up: Up) -> Option<Self> {
        let mut points = sample(points);
        up.to_y_up(&mut points);
        let foot = foot_spread(&points)?;
        let [width, height, depth] = [0, 1, 2].map(|axis| range(points.iter().map(|p| p[axis])));
        let (low, high) = height?;
        let wide = [width?, depth?].iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let mut levels = vec![Vec::new(); LEVELS];
        for &p in &points {
            let level = (p.y - low) / (high - low) * LEVELS as f64;
            if let Some(level) = levels.get_mut(level as usize).filter(|_| level >= 0.0) {
                level.push(p);
            }
        }
        levels.retain(|level: &Vec<DVec3>| level.len() >= LEAST_OF_LEVEL);
        let widths: Vec<f64> = levels.iter().filter_map(|level| spread(level)).collect();
        let middles: Vec<(f64, f64)> = levels.iter().filter_map(|level| middle(level)).collect();
        let axis = (median(middles.iter().map(|at| at.0))?, median(middles.iter().map(|at| at.1))?);
        let off = median(middles.iter().map(|at| libm::hypot(at.0 - axis.0, at.1 - axis.1)))?;
        let mean = |ends: &[f64]| ends.iter().sum::<f64>() / ends.len() as f64;
        let count = widths.len().min(2);
        let ends = mean(&widths[..count]).min(mean(&widths[widths.len() - count..]));
        let widest = widths.iter().copied().fold(0.0, f64::max);
        let usual_width = median(widths.iter().copied())?;
        (wide > 0.0 && widest > 0.0 && usual_width > 0.0).then(|| Self {
            foot,
            slender: (high - low) / wide,
            end: ends / widest,
            wander: off / usual_width.max(SLIM * widest),
        })
    }

    /// That a tree stands along this axis, by its shape.
    fn evidence(&self) -> f64 {
        let slender = if self.end <= NARROW_END { libm::log(self.slender).clamp(0.0, 1.5) } else { 0.0 };
        slender + libm::log(0.5 / self.foot).clamp(0.0, 1.5)
    }

    /// That none does, by its slices.
    fn wandering(&self) -> f64 {
        libm::log(self.wander + 0.05)
    }
}

/// Whether the cloud (Y up) is narrow where a stem is: what a canopy seen from above is not.
pub fn shows_stem(points: &[Vec3]) -> bool {
    let sample: Vec<DVec3> =
        points.iter().step_by(points.len().div_ceil(SAMPLE).max(1)).map(|p| p.as_dvec3()).collect();
    foot_spread(&sample).is_some_and(|spread| spread < WIDE)
}

/// Metres for a unit of `points` (Y up): 1, or what centimetres or millimetres are if the tree would be
/// impossibly high.
pub fn likely_scale(points: &[DVec3]) -> f64 {
    linden_base::input::likely_scale(height(&sample(points)).unwrap_or(0.0))
}

/// Evenly through the list.
pub(super) fn sample(points: &[DVec3]) -> Vec<DVec3> {
    points.iter().copied().step_by(points.len().div_ceil(SAMPLE).max(1)).collect()
}

/// From the lowest to the highest point, five strays in a thousand aside at either end.
fn height(points: &[DVec3]) -> Option<f64> {
    let (low, high) = range(points.iter().map(|p| p.y))?;
    Some(high - low)
}

pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let stray = values.len() / 200;
    Some((*values.get(stray)?, *values.get(values.len().checked_sub(1 + stray)?)?))
}

/// How wide the cloud (Y up) is where the stem should be, as a part of how wide it is: median distances from the medians.
fn foot_spread(points: &[DVec3]) -> Option<f64> {
    let (low, high) = range(points.iter().map(|p| p.y))?;
    let slice = low + STEM.0 * (high - low)..low + STEM.1 * (high - low);
    let stem: Vec<DVec3> = points.iter().copied().filter(|p| slice.contains(&p.y)).collect();
    let whole = spread(points)?;
    (whole > 0.0).then_some(spread(&stem)? / whole)
}

fn spread(points: &[DVec3]) -> Option<f64> {
    let (x, z) = middle(points)?;
    median(points.iter().map(|p| libm::hypot(p.x - x, p.z - z)))
}

fn middle(points: &[DVec3]) -> Option<(f64, f64)> {
    Some((median(points.iter().map(|p| p.x))?, median(points.iter().map(|p| p.z))?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;

    /// A stem of 2 m under a ball of 3 m radius, Y up, with some ground.
    fn tree() -> Vec<DVec3> {
        let key = Key::new(1);
        (0..6000)
            .map(|i| {
                let key = key.child(i);
                let at = DVec3::from([0, 1, 2].map(|axis| key.child(axis).between(-1.0, 1.0)));
                match i % 10 {
                    0 => DVec3::new(0.1 * at.x, 1.0 + at.y, 0.1 * at.z),
                    1 => DVec3::new(4.0 * at.x, 0.02 * at.y, 4.0 * at.z),
                    _ => DVec3::Y * 5.0 + 3.0 * at.normalize_or(DVec3::Y),
                }
            })
            .collect()
    }

    /// As a file with Z up has it.
    fn z_up(y_up: &[DVec3]) -> Vec<DVec3> {
        y_up.iter().map(|p| DVec3::new(p.x, -p.z, p.y)).collect()
    }

    #[test]
    fn the_stem_tells_which_way_is_up() {
        let y_up = tree();
        let z_up = z_up(&y_up);
        assert_eq!(guess_up(&y_up, Up::Y), UpGuess::Usual);
        assert_eq!(guess_up(&y_up, Up::Z), UpGuess::Other(Up::Y));
        assert_eq!(guess_up(&z_up, Up::Z), UpGuess::Usual);
        assert_eq!(guess_up(&z_up, Up::Y), UpGuess::Other(Up::Z));
        // A ball stands along no axis.
        let ball: Vec<DVec3> = y_up.iter().copied().filter(|p| p.y > 2.1).collect();
        assert_eq!([Up::Y, Up::Z].map(|usual| guess_up(&ball, usual)), [UpGuess::Undecided; 2]);
        assert_eq!(guess_up(&[], Up::Y), UpGuess::Usual);
    }

    #[test]
    fn cones_and_columns_without_a_bare_stem_stand_too() {
        // Radius by the height, of 1: a spruce to the ground, a column, a spindle, all on uneven sides.
        type Profile<'a> = &'a dyn Fn(f64) -> f64;
        let shapes: [(&str, f64, Profile<'_>); 3] = [
            ("cone", 0.15, &|t| 1.0 - t),
            ("column", 0.08, &|t| if t < 0.9 { 1.0 } else { 10.0 * (1.0 - t) }),
            ("spindle", 0.06, &|t| 4.0 * t.max(0.05) * (1.0 - t)),
        ];
        for (name, wide, radius) in shapes {
            let key = Key::new(7).named(name);
            let y_up: Vec<DVec3> = (0..4000)
                .map(|i| {
                    let [t, turn, out] = [0, 1, 2].map(|k| key.child(i).child(k).unit());
                    let (reach, turn) = (20.0 * wide * radius(t) * out.sqrt() + 0.1, 5.0 * turn);
                    DVec3::new(reach * libm::cos(turn), 20.0 * t, reach * libm::sin(turn))
                })
                .collect();
            let z_up = z_up(&y_up);
            for (points, usual, guess) in [
                (&y_up, Up::Y, UpGuess::Usual),
                (&y_up, Up::Z, UpGuess::Other(Up::Y)),
                (&z_up, Up::Z, UpGuess::Usual),
                (&z_up, Up::Y, UpGuess::Other(Up::Z)),
            ] {
                assert_eq!(guess_up(points, usual), guess, "{name}, {usual:?}");
            }
        }
    }

    #[test]
    fn a_strip_of_trees_does_not_stand_on_its_end() {
        // 8 m by 100 m, Z up: trunks and crowns of 15 m every 5 m, and ground.
        let key = Key::new(9);
        let strip: Vec<DVec3> = (0..12_000)
            .map(|i| {
                let key = key.child(i);
                let at = DVec3::from([0, 1, 2].map(|axis| key.child(axis).between(-1.0, 1.0)));
                let tree =
                    DVec3::new(4.0 * f64::from(i as u32 % 2) - 2.0, 5.0 * f64::from(i as u32 % 20), 0.0);
                match i % 4 {
                    0 => DVec3::new(4.0 * at.x, 50.0 + 50.0 * at.y, 0.03 * at.z),
                    _ => tree + DVec3::Z * 10.0 + DVec3::new(2.0, 2.0, 5.0) * at.normalize_or(DVec3::Z),
                }
            })
            .collect();
        assert!(!matches!(guess_up(&strip, Up::Z), UpGuess::Other(_)));
    }

    /// Spires that lie along y, wider and wider from west to east.
    #[test]
    fn what_is_wider_than_high_is_not_laid_down() {
        let key = Key::new(5);
        let lying = |wide: f64| -> Vec<DVec3> {
            (0..8000)
                .map(|i| {
                    let [t, turn, out] = [0, 1, 2].map(|k| key.child(i).child(k).unit());
                    let (reach, turn) = (2.5 * (1.0 - t) * out.sqrt() + 0.1, 7.0 * turn);
                    DVec3::new(wide * reach * libm::cos(turn), 20.0 * t, reach * libm::sin(turn))
                })
                .collect()
        };
        assert_eq!(guess_up(&lying(1.0), Up::Z), UpGuess::Other(Up::Y));
        assert_eq!(guess_up(&lying(3.0), Up::Z), UpGuess::Other(Up::Y));
        for wide in [4.4, 6.0] {
            assert_eq!(guess_up(&lying(wide), Up::Z), UpGuess::Undecided);
        }
    }

    #[test]
    fn a_northing_is_no_height() {
        let lying: Vec<DVec3> = tree();
        let at = |corner: DVec3| lying.iter().map(|p| *p + corner).collect::<Vec<DVec3>>();
        let survey = at(DVec3::new(458_000.0, 5_428_000.0, 300.0));
        assert_eq!(guess_up(&survey, Up::Z), UpGuess::Usual);
        assert_eq!(guess_up(&survey, Up::Y), UpGuess::Other(Up::Z));
        // Far above the sea, in millimetres: the stem tells.
        let high: Vec<DVec3> = lying.iter().map(|p| 1000.0 * (*p + DVec3::Y * 900.0)).collect();
        assert_eq!(guess_up(&high, Up::Z), UpGuess::Other(Up::Y));
    }

    #[test]
    fn impossible_heights_are_other_units() {
        for (unit, scale) in [(1.0, 1.0), (100.0, 0.01), (1000.0, 0.001), (15.0, 1.0)] {
            let points: Vec<DVec3> = tree().iter().map(|p| *p * unit).collect();
            assert_eq!(likely_scale(&points), scale, "{unit}");
        }
        assert_eq!(likely_scale(&[]), 1.0);
    }
}
