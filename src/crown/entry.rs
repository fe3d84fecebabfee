//! Where a trunk enters a crown from below.

use glam::DVec3;
use linden_base::monitor::{Cancelled, Monitor};

/// Places along the upright line, and along each side of the grid.
const LINE: u32 = 256;
const GRID: u32 = 32;

/// A body that begins lower than this share of the height begins at the bottom, as round ones do.
const AT_BOTTOM: f64 = 1.0 / 16.0;

/// Where a trunk begins, and how far up it is bare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// On the underside of the crown's box.
    pub below: DVec3,
    /// From there straight up to the body; 0 where it begins at the bottom.
    pub bare_m: f64,
}

/// Of a crown in a box: from the middle of the box's underside, where the body is straight above it; otherwise below
/// the body's lowest place, of several the one nearest to the middle.
///
/// # Errors
/// [`Cancelled`].
pub fn entry(
    [low, high]: [DVec3; 2],
    middle: DVec3,
    contains: impl Fn(DVec3) -> bool,
    monitor: &dyn Monitor,
) -> Result<Entry, Cancelled> {
    let size = high - low;
    let above = |below: DVec3| -> Option<f64> {
        let heights = (0..LINE).map(|i| size.y * (f64::from(i) + 0.5) / f64::from(LINE));
        heights.into_iter().find(|&y| contains(below + DVec3::Y * y))
    };
    let at = |below: DVec3, y: f64| Entry { below, bare_m: if y <= AT_BOTTOM * size.y { 0.0 } else { y } };
    if let Some(y) = above(middle) {
        return Ok(at(middle, y));
    }
    let part = |i: u32| (f64::from(i) + 0.5) / f64::from(GRID);
    for layer in 0..GRID {
        monitor.check()?;
        let places =
            (0..GRID).flat_map(|i| (0..GRID).map(move |j| DVec3::new(part(i), part(layer), part(j))));
        let inside = places.map(|share| low + share * size).filter(|&p| contains(p));
        let away = |p: &DVec3| (*p - middle).with_y(0.0).length_squared();
        if let Some(lowest) = inside.min_by(|a, b| away(a).total_cmp(&away(b))) {
            return Ok(at(lowest.with_y(low.y), lowest.y - low.y));
        }
    }
    // Thinner than the grid.
    Ok(Entry { below: middle, bare_m: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;

    const CORNERS: [DVec3; 2] = [DVec3::new(-4.0, 0.0, -4.0), DVec3::new(4.0, 2.0, 4.0)];

    #[test]
    fn a_ball_is_entered_at_its_lowest_place() {
        let ball = |p: DVec3| p.distance(DVec3::Y) < 1.0;
        let corners = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0)];
        let found = entry(corners, DVec3::ZERO, ball, &Quiet).unwrap();
        assert_eq!(found, Entry { below: DVec3::ZERO, bare_m: 0.0 });
    }

    #[test]
    fn under_a_body_on_legs_the_trunk_is_bare_up_to_the_body() {
        let table = |p: DVec3| p.y > 1.2 || (p.x.abs() > 3.5 && p.z.abs() > 3.5);
        let found = entry(CORNERS, DVec3::ZERO, table, &Quiet).unwrap();
        assert_eq!(found.below, DVec3::ZERO);
        assert!((found.bare_m - 1.2).abs() <= 2.0 / f64::from(LINE), "{found:?}");
    }

    #[test]
    fn without_a_body_in_the_middle_it_is_the_lowest_place_that_counts_then_the_nearest() {
        // A ring that is lowest where x is greatest.
        let ring = |p: DVec3| {
            let r = libm::hypot(p.x, p.z);
            (2.0..4.0).contains(&r) && p.y > 0.5 - 0.125 * p.x && p.y < 2.0
        };
        let found = entry(CORNERS, DVec3::ZERO, ring, &Quiet).unwrap();
        let cell = 8.0 / f64::from(GRID);
        assert!(found.below.distance(DVec3::X * 4.0) < 2.0 * cell, "{found:?}");
        assert_eq!(found.bare_m, 0.0);
        let level = |p: DVec3| (2.0..4.0).contains(&libm::hypot(p.x, p.z));
        let found = entry(CORNERS, DVec3::ZERO, level, &Quiet).unwrap();
        let away = libm::hypot(found.below.x, found.below.z);
        assert!((2.0..2.0 + cell).contains(&away) && level(found.below), "{found:?}");
    }
}
