//! Circles of stems that are no circles: an oval has the diameter that a tape finds, its girth by π.
//!
//! Distances from the axis go round an oval twice: `r + a cos 2θ + b sin 2θ`. Least squares find both, and the circle through
//! points from which that is taken has the mean radius, whichever of the axes more points lie on.

use super::circle::{self, Circle, Flat, SD_PER_MAD, TUKEY, add_row, mad, solve};
use super::median::median;

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

/// A curve round a centre, from which it is `r + a cos 2θ + b sin 2θ` away.
struct Oval {
    centre: Flat,
    r: f64,
    a: f64,
    b: f64,
}

/// A point as an oval has it.
struct Seen {
    /// How far from the centre, and in which direction: the cosine and the sine of the angle, and those of twice the angle.
    away_m: f64,
    once: [f64; 2],
    twice: [f64; 2],
    /// How much farther away the curve is there than the mean.
    bulge_m: f64,
}

impl Oval {
    fn see(&self, p: &Flat) -> Seen {
        let (dx, dy) = (p.0 - self.centre.0, p.1 - self.centre.1);
        let away_m = (dx * dx + dy * dy).sqrt().max(f64::MIN_POSITIVE);
        let (cos, sin) = (dx / away_m, dy / away_m);
        let twice = [cos * cos - sin * sin, 2.0 * cos * sin];
        let bulge_m = self.a * twice[0] + self.b * twice[1];
        Seen { away_m, once: [cos, sin], twice, bulge_m }
    }

    /// How far outside a point is.
    fn off_m(&self, p: &Flat) -> f64 {
        let Seen { away_m, bulge_m, .. } = self.see(p);
        away_m - self.r - bulge_m
    }

    /// The most that it differs from a circle.
    fn bulge_m(&self) -> f64 {
        (self.a * self.a + self.b * self.b).sqrt()
    }

    /// A step of the least squares nearer to the points. `None` where they do not tell.
    fn step(&mut self, flat: &[Flat], reach: f64) -> Option<()> {
        // The normal equations of rows (cos θ, sin θ, 1, cos 2θ, sin 2θ).
        let mut m = [[0.0; 6]; 5];
        for p in flat {
            let Seen { once: [cos, sin], twice: [cos2, sin2], .. } = self.see(p);
            add_row(&mut m, [cos, sin, 1.0, cos2, sin2, self.off_m(p)], reach);
        }
        let [by_x, by_y, by_r, by_a, by_b] = solve(m)?;
        self.centre = (self.centre.0 + by_x, self.centre.1 + by_y);
        (self.r, self.a, self.b) = (self.r + by_r, self.a + by_a, self.b + by_b);
        Some(())
    }

    /// A point moved by as much as makes the oval a circle.
    fn rounded(&self, p: &Flat) -> Flat {
        let Seen { away_m, once: [cos, sin], bulge_m, .. } = self.see(p);
        (self.centre.0 + (away_m - bulge_m) * cos, self.centre.1 + (away_m - bulge_m) * sin)
    }
}

/// The circle of the same girth, where points lie on an oval much more closely than on the one that was `seen`.
pub(crate) fn of_girth(flat: &[Flat], seen: &Circle) -> Option<Circle> {
    if flat.len() < LEAST_POINTS {
        return None;
    }
    let mut oval = Oval { centre: seen.centre, r: seen.radius_m, a: 0.0, b: 0.0 };
    for step in 0..STEPS {
        let mad_m = median(flat.iter().map(|p| oval.off_m(p).abs()))?;
        // At first no part of the oval may count as strays.
        let least_m = if step < STEPS / 2 { START * oval.r } else { 1e-4 * oval.r };
        oval.step(flat, TUKEY * (SD_PER_MAD * mad_m).max(least_m))?;
        if !((0.5..2.0).contains(&(oval.r / seen.radius_m)) && oval.bulge_m() <= MOST * oval.r) {
            return None;
        }
    }
    let inside = flat.iter().filter(|p| oval.off_m(p) < -INSIDE * oval.r).count();
    if inside as f64 > FEW_INSIDE * flat.len() as f64 {
        return None;
    }
    let rounded: Vec<Flat> = flat.iter().map(|p| oval.rounded(p)).collect();
    let mut found = circle::fit(&rounded)?;
    // Of all points: what was seen may be a circle through some of them.
    let seen_m = mad(flat, [seen.centre.0, seen.centre.1, seen.radius_m], &mut Vec::new());
    let is_oval = found.mad_m < CLOSER * seen_m && found.arc_rad >= LEAST_ARC_RAD;
    // The girth of r (1 + q cos 2θ) is 2πr (1 + q²), to the second order: that is what a tape finds.
    let bulge = oval.bulge_m() / oval.r;
    found.radius_m *= 1.0 + bulge * bulge;
    let unsure_m = UNSURE * oval.bulge_m();
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
            let found = of_girth(&flat, &circle::fit(&flat).unwrap()).unwrap();
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
        assert_eq!(of_girth(&round, &circle::fit(&round).unwrap()), None);
        let half = ellipse([0.22, 0.17], 0.5 * TAU);
        assert_eq!(of_girth(&half, &circle::fit(&half).unwrap()), None);
    }
}
