//! Rows of a scan that are no points of it: places that stand there several times, `0 0 0` where no pulse
//! came back, and single points far from everything.
//!
//! They go before anything is measured: one row of them among a thousand moves medians, spacing and foot.

use glam::DVec3;

use super::median::median;
use super::neighbours::Neighbours;
use super::{ScanError, frame, z_order};
use linden_base::monitor::Monitor;

/// Indices and marks, and the points that are kept.
const BYTES_PER_POINT: u64 = 40;

/// Spreads off the middle beyond which a point is far.
const FAR_SPREADS: f64 = 5.0;

/// A point is alone with no other within this distance, metres.
const ALONE_M: f64 = 1.0;

/// Points at different places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distinct {
    /// Each place once, in the order of their first rows.
    pub points: Vec<DVec3>,
    /// Rows left out because their place stood there before.
    pub repeated: usize,
    /// Rows `0 0 0` left out: what scanners write where no pulse came back.
    pub no_returns: usize,
}

/// Merges points of the same place (the same bits, the sign of zeros aside).
///
/// `0 0 0` is left out where it stands there several times, and in a scan (`is_scan`) always: the scanner's
/// own place is none that it measures.
///
/// # Errors
/// [`ScanError`]: memory, cancelled.
pub fn distinct(points: &[DVec3], is_scan: bool, monitor: &dyn Monitor) -> Result<Distinct, ScanError> {
    let bytes = points.len() as u64 * BYTES_PER_POINT;
    monitor.admit("looking for points that are there twice", bytes, "thin the points out")?;
    // Adding zero makes -0 and 0 the same.
    let bits = |i: u32| (points[i as usize] + 0.0).to_array().map(f64::to_bits);
    let mix = |i: u32| {
        let [x, y, z] = bits(i);
        // Multiplicative hashing (Knuth): the upper bits depend on all of the lower ones.
        (x ^ y.rotate_left(21) ^ z.rotate_left(42)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    };
    let mut order: Vec<(u64, u32)> = (0..points.len() as u32).map(|i| (mix(i), i)).collect();
    monitor.check()?;
    z_order::sort(&mut order);
    monitor.check()?;
    let mut repeats = Vec::new();
    let mut same: Vec<u32> = Vec::new();
    for mixed in order.chunk_by(|a, b| a.0 == b.0).filter(|mixed| mixed.len() > 1) {
        // Mostly one place, or else sorted out.
        same.clear();
        same.extend(mixed.iter().map(|&(_, i)| i));
        same.sort_unstable_by_key(|&i| (bits(i), i));
        repeats.extend(same.windows(2).filter(|pair| bits(pair[0]) == bits(pair[1])).map(|pair| pair[1]));
    }
    drop(order);
    let mut is_repeat = vec![false; points.len()];
    for &i in &repeats {
        is_repeat[i as usize] = true;
    }
    let origins = points.iter().filter(|p| **p == DVec3::ZERO).count();
    let no_returns = if is_scan || origins > 1 { origins } else { 0 };
    let is_kept = |p: DVec3, is_repeat: bool| !is_repeat && (no_returns == 0 || p != DVec3::ZERO);
    let rows = points.iter().copied().zip(is_repeat);
    let kept: Vec<DVec3> = rows.filter(|&(p, is_repeat)| is_kept(p, is_repeat)).map(|(p, _)| p).collect();
    let repeated = points.len() - kept.len() - no_returns;
    Ok(Distinct { points: kept, repeated, no_returns })
}

/// Leaves out single points far from everything (metres, each place once); how many.
///
/// # Errors
/// [`ScanError`]: cancelled.
pub fn drop_far(points: &mut Vec<DVec3>, monitor: &dyn Monitor) -> Result<usize, ScanError> {
    let sample = frame::sample(points);
    let middle = DVec3::from([0, 1, 2].map(|axis| median(sample.iter().map(|p| p[axis])).unwrap_or(0.0)));
    let spread = median(sample.iter().map(|p| p.distance(middle))).unwrap_or(0.0);
    let far_m = FAR_SPREADS * spread;
    let is_far = |p: &DVec3| p.distance(middle) > far_m;
    monitor.check()?;
    if !points.iter().any(is_far) {
        return Ok(0);
    }
    // Only what is about as far can be near a far point.
    let outer: Vec<DVec3> = points.iter().copied().filter(|p| p.distance(middle) > far_m - ALONE_M).collect();
    let tree = Neighbours::new(&outer, monitor)?;
    let mut found = Vec::new();
    let mut looked_at = 0_usize;
    let mut cancelled = Ok(());
    let before = points.len();
    points.retain(|p| {
        if !is_far(p) || cancelled.is_err() {
            return true;
        }
        looked_at += 1;
        if looked_at.is_multiple_of(1024) {
            cancelled = monitor.check();
        }
        tree.nearest(*p, 2, ALONE_M, &mut found);
        found.len() > 1
    });
    cancelled?;
    Ok(before - points.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    fn cloud(count: u64) -> Vec<DVec3> {
        let key = Key::new(4);
        (0..count)
            .map(|i| DVec3::from([0, 1, 2].map(|axis| key.child(i).child(axis).between(-3.0, 3.0))))
            .collect()
    }

    #[test]
    fn each_place_stays_once_and_in_order() {
        // Enough for a sort of some depth.
        let points = cloud(40_000);
        let mut rows = Vec::new();
        for (i, &p) in points.iter().enumerate() {
            rows.push(p);
            if i % 3 == 0 {
                rows.extend([points[i / 2], DVec3::new(0.0, -0.0, 0.0)]);
            }
        }
        let found = distinct(&rows, false, &Quiet).unwrap();
        assert_eq!(found.points, points);
        let thirds = points.len().div_ceil(3);
        assert_eq!((found.repeated, found.no_returns), (thirds, thirds));
        assert_eq!(distinct(&[], true, &Quiet).unwrap(), Distinct::default());
    }

    #[test]
    fn a_single_origin_is_a_point_unless_a_scanner_wrote_it() {
        let rows = [DVec3::X, DVec3::ZERO, DVec3::Y];
        assert_eq!(distinct(&rows, false, &Quiet).unwrap().points, rows);
        let scanned = distinct(&rows, true, &Quiet).unwrap();
        assert_eq!((scanned.points, scanned.no_returns), (vec![DVec3::X, DVec3::Y], 1));
    }

    #[test]
    fn points_that_differ_in_a_sign_or_the_last_bit_are_two() {
        let rows = [DVec3::X, DVec3::NEG_X, DVec3::new(1.0_f64.next_up(), 0.0, 0.0)];
        assert_eq!(distinct(&rows, true, &Quiet).unwrap().points, rows);
    }

    #[test]
    fn a_far_point_goes_and_a_far_group_stays() {
        let points = cloud(2000);
        let mut with = points.clone();
        with.extend([DVec3::Y * 90.0, DVec3::new(400.0, 0.0, 0.0)]);
        assert_eq!(drop_far(&mut with, &Quiet), Ok(2));
        assert_eq!(with, points);
        with.extend([DVec3::Y * 90.0, DVec3::Y * 90.5]);
        assert_eq!(drop_far(&mut with, &Quiet), Ok(0));
        assert_eq!(drop_far(&mut Vec::new(), &Quiet), Ok(0));
    }
}
