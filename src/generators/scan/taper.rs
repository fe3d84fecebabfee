//! Circles of stretches along which wood gets thinner.
//!
//! A stretch of a stem is a piece of a cone. Where a limb, a shadow or the edge of the crown takes away points of one end
//! of it, the circle through all of them is that of the other end. Least squares of the distances from a cone say how
//! fast the radius changes along the axis (Lukács, Martin & Marshall 1998, *Faithful least-squares fitting of spheres, cylinders,
//! cones and tori for reliable segmentation*); by that each point is moved to where it would be beside the node.

use super::circle::{self, Circle, Flat, SD_PER_MAD, TUKEY, add_row, solve};

/// How often the change of the radius is looked for, with points moved by what was found before.
const ROUNDS: usize = 2;

/// Steps of the least squares.
const STEPS: usize = 6;

/// Thinner wood loses less along its stretch than its points err: what looks like a cone there is a clump, metres.
const THICK_M: f64 = 0.05;

/// No wood gets thinner, or thicker, faster: metres of radius to a metre of its length.
const STEEPEST: f64 = 0.6;

/// The circle at the node of a stretch, if points lie more closely on it than on the one that was `seen` of a cylinder. Points are
/// given across the axis, and how far along it each lies from the node, metres.
pub(crate) fn at_node(flat: &[Flat], along_m: &[f64], seen: Circle) -> Circle {
    let mut best = seen;
    let rounds = if seen.radius_m < THICK_M { 0 } else { ROUNDS };
    for _ in 0..rounds {
        let Some(slope) = slope(flat, along_m, &best) else { break };
        let (x, y) = best.centre;
        let moved: Vec<Flat> = flat
            .iter()
            .zip(along_m)
            .map(|(p, along_m)| {
                let (dx, dy) = (p.0 - x, p.1 - y);
                let by = -slope * along_m / (dx * dx + dy * dy).sqrt().max(f64::MIN_POSITIVE);
                (p.0 + dx * by, p.1 + dy * by)
            })
            .collect();
        let Some(found) = circle::fit(&moved).filter(|found| found.mad_m < best.mad_m) else { break };
        best = found;
    }
    best
}

/// By how many metres the radius changes with each metre along the axis; `None` where the points do not tell.
fn slope(flat: &[Flat], along_m: &[f64], circle: &Circle) -> Option<f64> {
    let [mut x, mut y, mut r, mut slope] = [circle.centre.0, circle.centre.1, circle.radius_m, 0.0];
    let mut offs_m: Vec<f64> = Vec::with_capacity(flat.len());
    for _ in 0..STEPS {
        let from_axis = |p: &Flat| ((p.0 - x) * (p.0 - x) + (p.1 - y) * (p.1 - y)).sqrt();
        offs_m.clear();
        offs_m
            .extend(flat.iter().zip(along_m).map(|(p, along_m)| (from_axis(p) - r - slope * along_m).abs()));
        let middle = offs_m.len() / 2;
        let mad_m = *offs_m.select_nth_unstable_by(middle, f64::total_cmp).1;
        let reach = TUKEY * (SD_PER_MAD * mad_m).max(1e-4 * r);
        // The normal equations of rows (n, 1, z), where n leads from the axis to the point and z along it.
        let mut m = [[0.0; 5]; 4];
        for (p, &along_m) in flat.iter().zip(along_m) {
            let d = from_axis(p);
            let off = d - r - slope * along_m;
            if !(d > 0.0) {
                continue;
            }
            let row = [(p.0 - x) / d, (p.1 - y) / d, 1.0, along_m, off];
            add_row(&mut m, row, reach);
        }
        let [by_x, by_y, by_r, by_slope] = solve(m)?;
        [x, y, r, slope] = [x + by_x, y + by_y, r + by_r, slope + by_slope];
        if !((0.25..4.0).contains(&(r / circle.radius_m)) && slope.abs() < STEEPEST) {
            return None;
        }
    }
    Some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;
    use std::f64::consts::TAU;

    /// Points of 40 cm of a stem that is 20 cm thick in its middle and loses 5 cm a metre on each side, 1 mm off it; of its upper
    /// half only a part of the turn is seen.
    fn half_hidden() -> (Vec<Flat>, Vec<f64>) {
        (0..600)
            .filter_map(|i| {
                let unit = |n: u64| Key::new(9).child(i).child(n).unit();
                let (turn, along_m) = (TAU * unit(0), 0.4 * (unit(1) - 0.5));
                let r = 0.1 - 0.05 * along_m + 0.002 * (unit(2) - 0.5);
                (along_m < 0.0 || turn < 0.15 * TAU)
                    .then(|| ((r * libm::cos(turn) + 0.02, r * libm::sin(turn) - 0.01), along_m))
            })
            .unzip()
    }

    #[test]
    fn the_end_that_is_seen_better_does_not_make_it_thicker() {
        let (flat, along_m) = half_hidden();
        let seen = circle::fit(&flat).unwrap();
        let found = at_node(&flat, &along_m, seen);
        assert!(seen.radius_m > 0.103, "{seen:?}");
        assert!((found.radius_m - 0.1).abs() < 4e-4 && found.mad_m < 0.5 * seen.mad_m, "{found:?}");
        assert!((found.centre.0 - 0.02).abs() < 5e-4 && (found.centre.1 + 0.01).abs() < 5e-4, "{found:?}");
    }

    #[test]
    fn what_is_no_cone_stays_as_it_was_seen() {
        // Beside the node all of them: nothing tells how fast the radius changes.
        let (flat, along_m) = half_hidden();
        let level = vec![0.0; along_m.len()];
        let seen = circle::fit(&flat).unwrap();
        assert_eq!(at_node(&flat, &level, seen), seen);
    }
}
