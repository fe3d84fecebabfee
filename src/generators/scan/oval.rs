//! Circles of stems that are no circles: an oval has the diameter that a tape finds, its girth by π.
//!
//! Distances from the axis go round an oval twice: `r + a cos 2θ + b sin 2θ`. Least squares find both, and the circle through
//! points from which that is taken has the mean radius, whichever of the axes more points lie on.

use super::circle::{self, Circle, Flat, SD_PER_MAD, TUKEY, mad, solve};

/// Steps of the least squares.
const STEPS: usize = 6;

/// The part of the turn that must be seen, radians: less of an oval is as well an arc of a circle.
const LEAST_ARC_RAD: f64 = 4.7;

/// Points that tell an oval from limbs and strays.
const LEAST_POINTS: usize = 60;

/// The most that an oval differs from its circle, as a part of the radius: axes as 3 to 5.
const MOST: f64 = 0.25;

/// Bark has nothing within: of all points no larger part is farther inside than this part of the radius.
const INSIDE: f64 = 0.2;
const FEW_INSIDE: f64 = 0.04;

/// How much more closely points must lie on the oval than on the circle.
const CLOSER: f64 = 0.6;

/// How far the radius of an oval may be off, as a part of what it differs from its circle.
const UNSURE: f64 = 0.06;

/// The points of half of all inliers lie no farther off a start, in radii.
const START: f64 = 0.1;

/// The circle of the same girth, where points lie on an oval much more closely than on the one that was `seen`.
pub(crate) fn mean(flat: &[Flat], seen: &Circle) -> Option<Circle> {
    if flat.len() < LEAST_POINTS {
        return None;
    }
    let (mut x, mut y) = seen.centre;
    let (mut r, mut a, mut b) = (seen.radius_m, 0.0, 0.0);
    let round = |p: &Flat, x: f64, y: f64| {
        let (dx, dy) = (p.0 - x, p.1 - y);
        let d = (dx * dx + dy * dy).sqrt().max(f64::MIN_POSITIVE);
        let (cos, sin) = (dx / d, dy / d);
        (d, cos, sin, cos * cos - sin * sin, 2.0 * cos * sin)
    };
    let mut offs_m: Vec<f64> = Vec::with_capacity(flat.len());
    for step in 0..STEPS {
        let off = |p: &Flat| {
            let (d, .., cos2, sin2) = round(p, x, y);
            d - r - a * cos2 - b * sin2
        };
        offs_m.clear();
        offs_m.extend(flat.iter().map(|p| off(p).abs()));
        let middle = offs_m.len() / 2;
        let mad_m = *offs_m.select_nth_unstable_by(middle, f64::total_cmp).1;
        // At first no part of the oval may count as strays.
        let least_m = if step < STEPS / 2 { START * r } else { 1e-4 * r };
        let reach = TUKEY * (SD_PER_MAD * mad_m).max(least_m);
        let mut m = [[0.0; 6]; 5];
        for p in flat {
            let (d, cos, sin, cos2, sin2) = round(p, x, y);
            let off = d - r - a * cos2 - b * sin2;
            let root = (1.0 - (off / reach) * (off / reach)).max(0.0);
            if root > 0.0 {
                let row = [cos, sin, 1.0, cos2, sin2, off];
                for (sums, s) in m.iter_mut().zip(row) {
                    for (sum, t) in sums.iter_mut().zip(row) {
                        *sum += root * root * s * t;
                    }
                }
            }
        }
        let [by_x, by_y, by_r, by_a, by_b] = solve(m)?;
        (x, y, r, a, b) = (x + by_x, y + by_y, r + by_r, a + by_a, b + by_b);
        if !((0.5..2.0).contains(&(r / seen.radius_m)) && (a * a + b * b).sqrt() <= MOST * r) {
            return None;
        }
    }
    let is_inside = |p: &&Flat| {
        let (d, .., cos2, sin2) = round(p, x, y);
        d - r - a * cos2 - b * sin2 < -INSIDE * r
    };
    if flat.iter().filter(is_inside).count() as f64 > FEW_INSIDE * flat.len() as f64 {
        return None;
    }
    let rounded: Vec<Flat> = flat
        .iter()
        .map(|p| {
            let (d, cos, sin, cos2, sin2) = round(p, x, y);
            let d = d - a * cos2 - b * sin2;
            (x + d * cos, y + d * sin)
        })
        .collect();
    let mut found = circle::fit(&rounded)?;
    // Of all points: what was seen may be a circle through some of them.
    let seen_m = mad(flat, [seen.centre.0, seen.centre.1, seen.radius_m], &mut Vec::new());
    let is_oval = found.mad_m < CLOSER * seen_m && found.arc_rad >= LEAST_ARC_RAD;
    // The girth of r (1 + q cos 2θ) is 2πr (1 + q²), to the second order: that is what a tape finds.
    found.radius_m *= 1.0 + (a * a + b * b) / (r * r);
    let unsure_m = UNSURE * (a * a + b * b).sqrt();
    found.se_m = (found.se_m * found.se_m + unsure_m * unsure_m).sqrt();
    (is_oval && found.inliers >= LEAST_POINTS / 2).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;
    use std::f64::consts::TAU;

    /// Points of an ellipse with an error of 2 mm.
    fn ellipse(half_axes_m: [f64; 2], turn: f64) -> Vec<Flat> {
        let [a, b] = half_axes_m;
        (0..200)
            .map(|i| {
                let key = Key::new(9).child(i);
                let (at, off) = (turn * key.child(0).unit(), key.child(1).between(-0.0035, 0.0035));
                ((a + off) * libm::cos(at) + 0.3, (b + off) * libm::sin(at) - 0.2)
            })
            .collect()
    }

    #[test]
    fn an_oval_has_the_radius_that_a_tape_finds() {
        for ratio in [0.85, 0.8, 0.75_f64] {
            let half_axes_m = [0.19 / ratio.sqrt(), 0.19 * ratio.sqrt()];
            let flat = ellipse(half_axes_m, TAU);
            let found = mean(&flat, &circle::fit(&flat).unwrap()).unwrap();
            // Its girth by π (Ramanujan 1914, to 1e-5 here).
            let [a, b] = half_axes_m;
            let h = ((a - b) / (a + b)) * ((a - b) / (a + b));
            let by_tape_m = 0.5 * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
            let off = found.radius_m / by_tape_m - 1.0;
            assert!(off.abs() < 0.012, "{ratio}: {off}");
            assert!(
                found.se_m > 0.3 * (found.radius_m - by_tape_m).abs() && found.arc_rad > 5.5,
                "{found:?}"
            );
            let (x, y) = found.centre;
            assert!((x - 0.3).abs() < 0.003 && (y + 0.2).abs() < 0.003, "{ratio}: {x} {y}");
        }
    }

    #[test]
    fn what_is_round_or_seen_from_one_side_is_no_oval() {
        let round = ellipse([0.2, 0.2], TAU);
        assert_eq!(mean(&round, &circle::fit(&round).unwrap()), None);
        let half = ellipse([0.22, 0.17], 0.5 * TAU);
        assert_eq!(mean(&half, &circle::fit(&half).unwrap()), None);
    }
}
