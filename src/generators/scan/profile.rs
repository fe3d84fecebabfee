//! How the radii of an axis go from its foot to its tip, of the circles that are believed.
//!
//! Wood gets thinner towards its tip. Circles that contradict most others are left out: one of a buttress at the foot
//! would draw the whole bole to it. One that lies off the line through its neighbours is put on it. What then still grows is made to
//! shrink by the least change (pool adjacent violators, Ayer et al. 1955, *An empirical distribution function for sampling
//! with incomplete information*), each circle by how sure it is.

use super::circle::{Circle, SD_PER_MAD};
use super::median::median;

/// So many times as thick as one nearer to the foot may a circle be that goes along with it.
const PLAY: f64 = 1.1;

/// Circles on either side that a line is put through.
const REACH: usize = 3;

/// A circle is off the line by more than so many standard deviations of those around it,
const OFF: f64 = 2.0;

/// and by more than this part of the radius: a flare is no line.
const BENT: f64 = 0.01;

/// The part of the points' spread about a circle that is no chance, and that its radius may be wrong by: bark is no circle, and stands
/// of a scanner are not quite in one place.
const MISFIT: f64 = 0.3;

/// How far along the axis the place of a circle is sure, metres: where wood gets thinner, its radius is as unsure.
const PLACE_M: f64 = 0.05;

/// A circle around a node of an axis.
#[derive(Clone, Copy)]
pub(crate) struct Ring {
    pub node: u32,
    /// From the start of the axis, metres.
    pub along_m: f64,
    pub circle: Circle,
}

/// The radius of an axis at a circle.
#[derive(Clone, Copy)]
pub(crate) struct Believed {
    pub ring: Ring,
    pub radius_m: f64,
    /// Its standard error, metres: of the circle, by how those around it scatter, by how far it was moved to go along with them, and
    /// by what no circle explains.
    pub se_m: f64,
}

/// The circles of an axis, from its start on, that go along with each other, and the radius at each.
pub(crate) fn of(rings: &[Ring]) -> impl Iterator<Item = Believed> + use<> {
    let rings = consistent(rings);
    let lines: Vec<Line> = (0..rings.len()).map(|i| Line::around(&rings, i)).collect();
    let radii_m = rings.iter().zip(&lines).map(|(ring, line)| line.radius_m(ring));
    let shrunk = shrinking(radii_m.zip(&rings).map(|(radius_m, ring)| (radius_m, ring.circle.se_m)));
    rings.into_iter().zip(lines).zip(shrunk).map(|((ring, line), radius_m)| {
        let Circle { se_m, mad_m, radius_m: own_m, .. } = ring.circle;
        let misfit_m = MISFIT * SD_PER_MAD * mad_m;
        let errors_m = [se_m, line.spread_m, misfit_m, PLACE_M * line.slope, own_m - radius_m];
        Believed { ring, radius_m, se_m: errors_m.iter().map(|error| error * error).sum::<f64>().sqrt() }
    })
}

/// The longest row of circles in which none is thicker than the one before it.
fn consistent(rings: &[Ring]) -> Vec<Ring> {
    // For each the longest row that ends in it, and the one before it there.
    let mut rows: Vec<(usize, Option<usize>)> = Vec::with_capacity(rings.len());
    let radius_m = |i: usize| rings[i].circle.radius_m;
    for i in 0..rings.len() {
        let before = (0..i).filter(|&k| radius_m(i) <= PLAY * radius_m(k)).max_by_key(|&k| rows[k].0);
        rows.push((before.map_or(1, |k| rows[k].0 + 1), before));
    }
    let last = (0..rows.len()).max_by_key(|&i| rows[i].0);
    let mut row: Vec<Ring> = std::iter::successors(last, |&i| rows[i].1).map(|i| rings[i]).collect();
    row.reverse();
    row
}

/// The line through the circles around one (by repeated medians, Siegel 1982, *Robust regression using repeated medians*).
struct Line {
    /// Radius by length.
    slope: f64,
    /// The radius at the circle.
    at_m: f64,
    /// The standard deviation of the circles off it.
    spread_m: f64,
}

impl Line {
    fn around(rings: &[Ring], i: usize) -> Self {
        let around = || rings.iter().take(i + REACH + 1).skip(i.saturating_sub(REACH));
        let own_m = rings[i].circle.radius_m;
        let slope_from = |from: &Ring| {
            let others = around().filter(|ring| ring.along_m != from.along_m);
            let slope = |to: &Ring| (to.circle.radius_m - from.circle.radius_m) / (to.along_m - from.along_m);
            median(others.map(slope))
        };
        let slope = median(around().filter_map(slope_from)).unwrap_or(0.0);
        let at_own = |ring: &Ring| ring.circle.radius_m - slope * (ring.along_m - rings[i].along_m);
        let at_m = median(around().map(at_own)).unwrap_or(own_m);
        let spread_m = SD_PER_MAD * median(around().map(|ring| (at_own(ring) - at_m).abs())).unwrap_or(0.0);
        Self { slope, at_m, spread_m }
    }

    /// The radius of its circle, or its own where the circle lies off it.
    fn radius_m(&self, ring: &Ring) -> f64 {
        let own_m = ring.circle.radius_m;
        // Few circles far apart, or in a heap before a gap, make a steep line: where it runs out of the wood it says nothing.
        let is_off = (own_m - self.at_m).abs() > (OFF * self.spread_m).max(BENT * self.at_m);
        if is_off && self.at_m > 0.0 { self.at_m } else { own_m }
    }
}

/// The radii that shrink (or stay) from each to the next, nearest to those given in the least squares weighted by how sure they
/// are: each with its standard error.
fn shrinking(radii: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    // Blocks of equal radius: (mean, weight, how many).
    let mut blocks: Vec<(f64, f64, usize)> = Vec::new();
    for (radius_m, se_m) in radii {
        let error_m = se_m + 0.02 * radius_m;
        let mut block = (radius_m, (error_m * error_m).recip(), 1);
        while let Some(before) = blocks.pop_if(|before| before.0 < block.0) {
            let weight = before.1 + block.1;
            block = ((before.0 * before.1 + block.0 * block.1) / weight, weight, before.2 + block.2);
        }
        blocks.push(block);
    }
    blocks.iter().flat_map(|&(radius_m, _, count)| std::iter::repeat_n(radius_m, count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn rings(radii_m: &[f64]) -> Vec<Ring> {
        let circle = |radius_m| Circle {
            centre: (0.0, 0.0),
            radius_m,
            mad_m: 0.0,
            inliers: 20,
            arc_rad: TAU,
            se_m: 1e-4,
        };
        let ring = |(&radius_m, node): (&f64, u32)| Ring {
            node,
            along_m: 0.2 * f64::from(node),
            circle: circle(radius_m),
        };
        radii_m.iter().zip(0..).map(ring).collect()
    }

    #[test]
    fn shrinking_is_the_least_change() {
        // As sure as their weights: 1, 1, 3, 1, 1.
        let given = [(5.0, 1.0), (3.0, 1.0), (4.0, 3.0), (1.0, 1.0), (2.0, 1.0_f64)];
        let found = shrinking(given.iter().map(|&(r, weight)| (r, weight.sqrt().recip() - 0.02 * r)));
        for (found, expected) in found.iter().zip([5.0, 3.75, 3.75, 1.5, 1.5]) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        assert_eq!(shrinking(std::iter::empty()), [0.0; 0]);
    }

    #[test]
    fn circles_of_buttresses_do_not_draw_the_bole_to_them() {
        let bole: Vec<f64> = (0..20).map(|i| 0.4 - 0.01 * f64::from(i)).collect();
        let found: Vec<Believed> = of(&rings(&[&[0.19, 0.2, 0.12], &bole[..]].concat())).collect();
        assert_eq!(
            found.iter().map(|found| found.ring.node).collect::<Vec<_>>(),
            (3..23).collect::<Vec<_>>()
        );
        for (Believed { radius_m: found, .. }, expected) in found.iter().zip(&bole) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        // A clump of leaves further out is left out as well.
        let kept: Vec<u32> =
            of(&rings(&[0.4, 0.39, 0.38, 0.7, 0.8, 0.37, 0.36])).map(|found| found.ring.node).collect();
        assert_eq!(kept, [0, 1, 2, 5, 6]);
        assert_eq!(of(&[]).count(), 0);
    }

    /// As those of slices of a fluted stem do, each of which is sure of itself.
    #[test]
    fn circles_that_scatter_are_as_unsure_as_that() {
        let even: Vec<f64> = (0..15).map(|i| 0.2 - 0.001 * f64::from(i)).collect();
        let off_m = [0.0, 6.0, -5.0, 3.0, -7.0, 4.0, -2.0].map(|mm| 0.001 * mm);
        let uneven: Vec<f64> = even.iter().zip(off_m.iter().cycle()).map(|(r, off)| r + off).collect();
        let se_m = |radii: &[f64]| of(&rings(radii)).nth(5).unwrap().se_m;
        assert!(se_m(&even) < 5e-4, "{}", se_m(&even));
        assert!((0.003..0.012).contains(&se_m(&uneven)), "{}", se_m(&uneven));
    }

    /// Those of a heap after a gap, at the same places as steep as they are far from it.
    #[test]
    fn a_line_that_runs_out_of_the_wood_says_nothing() {
        let mut given = rings(&[0.3, 0.2, 0.1, 0.1]);
        for (ring, along_m) in given.iter_mut().zip([0.0, 0.1, 0.2, 3.0]) {
            ring.along_m = along_m;
        }
        let found: Vec<f64> = of(&given).map(|found| found.radius_m).collect();
        assert!(found.iter().all(|&radius_m| radius_m >= 0.1 - 1e-9), "{found:?}");
    }

    #[test]
    fn one_that_is_off_the_line_is_put_on_it_and_a_flare_keeps_its_shape() {
        let given = [0.2, 0.19, 0.18, 0.186, 0.16, 0.15, 0.14];
        let found: Vec<f64> = of(&rings(&given)).map(|found| found.radius_m).collect();
        for (i, found) in (0..7).zip(found) {
            assert!((found - (0.2 - 0.01 * f64::from(i))).abs() < 1e-9, "{i}: {found}");
        }
        let flare = [0.47, 0.43, 0.407, 0.396, 0.389, 0.383, 0.381];
        let found: Vec<f64> = of(&rings(&flare)).map(|found| found.radius_m).collect();
        assert_eq!(found[2..], flare[2..]);
    }
}
