//! Points at random that keep their distance.

use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

/// Candidates around a point before it is given up (Bridson's k).
const CANDIDATES: u64 = 30;
/// Points between two looks at the monitor.
const POINTS_PER_CHECK: usize = 1024;

/// Poisson-disc points in a square of `side` around the origin, no two nearer than `spacing`, and no
/// room for another left (but for the gaps that 30 candidates miss). Metres.
///
/// Bridson, "Fast Poisson disk sampling in arbitrary dimensions" (SIGGRAPH 2007 sketches). Every choice
/// has a key of its own, told by the number of points that were looked at before.
///
/// # Errors
/// [`Cancelled`].
pub fn poisson_disc(
    side: f64,
    spacing: f64,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Vec<[f64; 2]>, Cancelled> {
    // A cell holds one point at most.
    let cell = spacing / std::f64::consts::SQRT_2;
    let across = ((side / cell).ceil() as usize).max(1);
    let mut grid: Vec<u32> = vec![u32::MAX; across * across];
    let place = |x: f64| (((x + 0.5 * side) / cell) as usize).min(across - 1);
    let first = ["x", "z"].map(|axis| key.named(axis).between(-0.5, 0.5) * side);
    let mut points = vec![first];
    grid[place(first[1]) * across + place(first[0])] = 0;
    let mut active = vec![0_usize];
    let mut looked: u64 = 0;
    while !active.is_empty() {
        if looked.is_multiple_of(POINTS_PER_CHECK as u64) {
            monitor.check()?;
        }
        let point_key = key.named("point").child(looked);
        looked += 1;
        let index = (point_key.named("which").unit() * active.len() as f64) as usize;
        let [x, z] = points[active[index]];
        let found = (0..CANDIDATES).find_map(|candidate| {
            let candidate_key = point_key.child(candidate);
            let [x_way, z_way] = candidate_key.named("direction").on_circle().to_array();
            // Evenly by area between one and two spacings.
            let distance = spacing * candidate_key.named("distance").between(1.0, 4.0).sqrt();
            let point = [x + x_way * distance, z + z_way * distance];
            let is_inside = point.iter().all(|x| x.abs() <= 0.5 * side);
            let is_free = |[x, z]: [f64; 2]| {
                let around = |at: usize| at.saturating_sub(2)..=(at + 2).min(across - 1);
                around(place(z)).all(|row| {
                    around(place(x)).all(|column| {
                        let Some(&[u, w]) = points.get(grid[row * across + column] as usize) else {
                            return true;
                        };
                        (u - x) * (u - x) + (w - z) * (w - z) >= spacing * spacing
                    })
                })
            };
            (is_inside && is_free(point)).then_some(point)
        });
        match found {
            Some(point) => {
                grid[place(point[1]) * across + place(point[0])] = points.len() as u32;
                active.push(points.len());
                points.push(point);
            }
            None => {
                active.swap_remove(index);
            }
        }
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;

    #[test]
    fn points_keep_their_distance_and_leave_no_room() {
        for (side, spacing) in [(50.0, 4.0), (20.0, 1.0), (3.0, 4.0), (10.0, 10.0)] {
            let points = poisson_disc(side, spacing, Key::new(5), &Quiet).unwrap();
            let far = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]);
            for (i, &a) in points.iter().enumerate() {
                assert!(a.iter().all(|x| x.abs() <= 0.5 * side));
                assert!(points[..i].iter().all(|&b| far(a, b) >= spacing), "{side} {spacing}");
            }
            // By brute force: hardly a place is left where another would fit.
            let n = 60;
            let coordinate = |i: usize| side * ((i as f64 + 0.5) / f64::from(n) - 0.5);
            let free = (0..n as usize * n as usize)
                .map(|i| [coordinate(i % n as usize), coordinate(i / n as usize)])
                .filter(|&place| points.iter().all(|&point| far(place, point) >= spacing))
                .count();
            assert!(free * 50 < (n * n) as usize, "{side} {spacing}: {free}");
        }
        // Discs put down at random until no other fits cover 0.547 of a plane (Feder 1980): 0.696 points a
        // spacing squared. Thirty candidates stop somewhat short of it.
        let count = poisson_disc(100.0, 2.0, Key::new(1), &Quiet).unwrap().len();
        assert!((1480..1745).contains(&count), "{count}");
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let of = |seed| poisson_disc(20.0, 2.0, Key::new(seed), &Quiet).unwrap();
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }
}
