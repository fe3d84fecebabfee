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

/// Which of Y and Z points up in `points` (in the file's axes), if it is not `usual`: only where the cloud
/// stands like a tree along the other and does not along this one.
pub fn unusual_up(points: &[DVec3], usual: Up) -> Option<Up> {
    let other = if usual == Up::Y { Up::Z } else { Up::Y };
    (foot_spread(points, usual)? > WIDE && foot_spread(points, other)? < NARROW).then_some(other)
}

/// Whether the cloud (Y up) is narrow where a stem is: what a canopy seen from above is not.
pub fn shows_stem(points: &[Vec3]) -> bool {
    let sample: Vec<DVec3> =
        points.iter().step_by(points.len().div_ceil(SAMPLE).max(1)).map(|p| p.as_dvec3()).collect();
    foot_spread(&sample, Up::Y).is_some_and(|spread| spread < WIDE)
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
    let (low, high) = range(points)?;
    Some(high - low)
}

fn range(points: &[DVec3]) -> Option<(f64, f64)> {
    let mut heights: Vec<f64> = points.iter().map(|p| p.y).collect();
    heights.sort_unstable_by(f64::total_cmp);
    let stray = heights.len() / 200;
    Some((*heights.get(stray)?, *heights.get(heights.len().checked_sub(1 + stray)?)?))
}

/// How wide the cloud is where the stem should be, as a part of how wide it is: median distances from the
/// medians.
fn foot_spread(points: &[DVec3], up: Up) -> Option<f64> {
    let mut points = sample(points);
    up.to_y_up(&mut points);
    let (low, high) = range(&points)?;
    let slice = low + STEM.0 * (high - low)..low + STEM.1 * (high - low);
    let stem: Vec<DVec3> = points.iter().copied().filter(|p| slice.contains(&p.y)).collect();
    let whole = spread(&points)?;
    (whole > 0.0).then_some(spread(&stem)? / whole)
}

fn spread(points: &[DVec3]) -> Option<f64> {
    let (x, z) = (median(points.iter().map(|p| p.x))?, median(points.iter().map(|p| p.z))?);
    median(points.iter().map(|p| DVec3::new(p.x - x, 0.0, p.z - z).length()))
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

    #[test]
    fn the_stem_tells_which_way_is_up() {
        let y_up = tree();
        let z_up: Vec<DVec3> = y_up.iter().map(|p| DVec3::new(p.x, -p.z, p.y)).collect();
        assert_eq!(unusual_up(&y_up, Up::Y), None);
        assert_eq!(unusual_up(&y_up, Up::Z), Some(Up::Y));
        assert_eq!(unusual_up(&z_up, Up::Z), None);
        assert_eq!(unusual_up(&z_up, Up::Y), Some(Up::Z));
        // A ball stands along no axis: nothing is guessed.
        let ball: Vec<DVec3> = y_up.iter().copied().filter(|p| p.y > 2.1).collect();
        assert_eq!((unusual_up(&ball, Up::Y), unusual_up(&ball, Up::Z)), (None, None));
        assert_eq!(unusual_up(&[], Up::Y), None);
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
