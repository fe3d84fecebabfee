//! Circles through points of a cross-section, whole or in part, and how sure they are.
//!
//! Scanners see stems from one side: an arc of 140 to 180°. On arcs the circle of Kåsa (1976) comes out too
//! small; Taubin's (1991, *Estimation of planar curves, surfaces and nonplanar space curves defined by implicit
//! equations*) does not, and is where the least squares of distances start from (Chernov & Lesort 2005, *Least
//! squares fitting of circles*).

use std::f64::consts::{PI, TAU};

use linden_base::random::Key;

/// A place in a cross-section, metres.
pub(crate) type Flat = (f64, f64);

/// Sectors of the turn that coverage is counted in.
const SECTORS: usize = 36;

/// Steps of the least squares.
const STEPS: usize = 8;

/// From the median of absolute deviations to the standard deviation of a normal error.
pub(crate) const SD_PER_MAD: f64 = 1.4826;

/// Residuals of so many standard deviations and more have no weight (Tukey's biweight).
pub(crate) const TUKEY: f64 = 4.685;

/// Points that a circle is put through at least.
pub(crate) const LEAST_POINTS: usize = 12;

/// A circle and what bears it out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub centre: Flat,
    pub radius_m: f64,
    /// Median distance of its points from it.
    pub mad_m: f64,
    /// Points that are not far off it.
    pub inliers: usize,
    /// How much of the turn they cover.
    pub arc_rad: f64,
    /// Standard error of the radius.
    pub se_m: f64,
}

impl Circle {
    /// The share of its radius that the radius may be off by, as far as noise goes.
    pub fn relative_se(&self) -> f64 {
        self.se_m / self.radius_m
    }
}

/// The circle through an arc, from points that may hold strays; `None` for too few points or points in a line.
pub(crate) fn fit(flat: &[Flat]) -> Option<Circle> {
    let mut scratch = Vec::with_capacity(flat.len());
    let mut start = taubin(flat).filter(|_| flat.len() >= LEAST_POINTS)?;
    let mut sd_m = SD_PER_MAD * mad(flat, start, &mut scratch);
    // Strays draw it to them: then the circle through three points that half of all are nearest to (least median
    // of squares, Rousseeuw 1984).
    if sd_m > UNEVEN * start[2]
        && let Some(other) = least_median(flat, &mut scratch)
    {
        let other_sd_m = SD_PER_MAD * mad(flat, other, &mut scratch);
        if other_sd_m < sd_m {
            (start, sd_m) = (other, other_sd_m);
        }
    }
    for _ in 0..2 {
        let on: Vec<Flat> = flat.iter().copied().filter(|&p| off(p, start).abs() <= 2.5 * sd_m).collect();
        let Some(better) = taubin(&on).filter(|_| on.len() >= LEAST_POINTS) else { break };
        let better_sd_m = SD_PER_MAD * mad(flat, better, &mut scratch);
        if better_sd_m > sd_m {
            break;
        }
        (start, sd_m) = (better, better_sd_m);
    }
    Some(refined(flat, start, sd_m, &mut scratch))
}

/// Residuals of so many radii and more have strays among them.
const UNEVEN: f64 = 0.08;

fn least_median(flat: &[Flat], scratch: &mut Vec<u64>) -> Option<[f64; 3]> {
    const DRAWS: u64 = 30;
    const SAMPLE: usize = 60;
    let sample: Vec<Flat> = flat.iter().copied().step_by(flat.len().div_ceil(SAMPLE)).collect();
    let key = Key::new(flat.len() as u64);
    let mut best: Option<(f64, [f64; 3])> = None;
    for draw in 0..DRAWS {
        let key = key.child(draw);
        let pick = |n: u64| sample[(key.child(n).unit() * sample.len() as f64) as usize % sample.len()];
        let Some(circle) = through_three(pick(0), pick(1), pick(2)) else { continue };
        // Whether the median is less is counted sooner than it is found.
        let is_nearer =
            |least: f64| 2 * sample.iter().filter(|&&p| off(p, circle).abs() < least).count() > sample.len();
        if best.is_none_or(|(least, _)| is_nearer(least)) {
            best = Some((mad(&sample, circle, scratch), circle));
        }
    }
    best.map(|(_, circle)| circle)
}

/// The circle that most points lie on among those through three of them (RANSAC, Fischler & Bolles 1981), then
/// refined. `near_m` is how far off a point may lie, `radii` what the radius may be.
pub(crate) fn consensus(flat: &[Flat], near_m: f64, radii: [f64; 2], key: Key) -> Option<Circle> {
    const DRAWS: u64 = 80;
    if flat.len() < LEAST_POINTS {
        return None;
    }
    let mut best: Option<(f64, [f64; 3])> = None;
    for draw in 0..DRAWS {
        let key = key.child(draw);
        let pick = |n: u64| flat[(key.child(n).unit() * flat.len() as f64) as usize % flat.len()];
        let Some(circle) = through_three(pick(0), pick(1), pick(2)) else { continue };
        if !(radii[0]..=radii[1]).contains(&circle[2]) {
            continue;
        }
        let score = score(flat, circle, near_m);
        if best.is_none_or(|(most, _)| score > most) {
            best = Some((score, circle));
        }
    }
    let (_, circle) = best?;
    let mut scratch = Vec::with_capacity(flat.len());
    let on: Vec<Flat> = flat.iter().copied().filter(|&p| off(p, circle).abs() <= near_m).collect();
    let start = taubin(&on).filter(|c| on.len() >= LEAST_POINTS && (0.5..2.0).contains(&(c[2] / circle[2])));
    let start = start.unwrap_or(circle);
    let sd_m = SD_PER_MAD * mad(&on, start, &mut scratch);
    let found = refined(&on, start, sd_m, &mut scratch);
    (radii[0]..=radii[1]).contains(&found.radius_m).then_some(found)
}

/// Filled sectors first, then points on it; bark has none inside, leaves have many.
fn score(flat: &[Flat], circle: [f64; 3], near_m: f64) -> f64 {
    let (mut on, mut inside, mut sectors) = (0_usize, 0_usize, 0_u64);
    for &p in flat {
        let off = off(p, circle);
        if off.abs() <= near_m {
            on += 1;
            sectors |= 1 << sector(p, circle);
        } else if off < -0.2 * circle[2] {
            inside += 1;
        }
    }
    let share = (on as f64 - inside as f64) / flat.len() as f64;
    f64::from(sectors.count_ones()) / SECTORS as f64 + 2.0 * share
}

/// Least squares of distances with Tukey's weights, by Gauss and Newton.
fn refined(flat: &[Flat], start: [f64; 3], sd_m: f64, scratch: &mut Vec<u64>) -> Circle {
    let mut circle = start;
    let reach = TUKEY * sd_m.max(1e-4 * start[2]);
    for _ in 0..STEPS {
        let Some(step) = newton(flat, circle, reach) else { break };
        let next = [0, 1, 2].map(|i| circle[i] + step[i]);
        if !(next[2] > 0.25 * start[2] && next[2] < 4.0 * start[2]) {
            break;
        }
        circle = next;
        if step.iter().all(|s| s.abs() < 1e-4 * circle[2]) {
            break;
        }
    }
    let on: Vec<Flat> = flat.iter().copied().filter(|&p| off(p, circle).abs() <= reach).collect();
    let mad_m = mad(flat, circle, scratch);
    let mut sectors = 0_u64;
    for &p in &on {
        sectors |= 1 << sector(p, circle);
    }
    let filled = f64::from(sectors.count_ones());
    let arc_rad = TAU * filled / SECTORS as f64;
    // Neighbours err together: no more than a few independent points a sector.
    let independent = (on.len() as f64).min(6.0 * filled).max(1.0);
    let se_m = arc_factor(arc_rad) * SD_PER_MAD * mad(&on, circle, scratch) / independent.sqrt();
    Circle { centre: (circle[0], circle[1]), radius_m: circle[2], mad_m, inliers: on.len(), arc_rad, se_m }
}

/// How many times as uncertain the radius of an arc is as of a whole circle with as many points:
/// `1/√(1 − s²/q)`, `s = sin α/α`, `q = ½ + sin 2α/4α`, α half of the arc, seen evenly.
pub(crate) fn arc_factor(arc_rad: f64) -> f64 {
    let half = (0.5 * arc_rad).clamp(0.05, PI);
    let s = libm::sin(half) / half;
    let q = 0.5 + libm::sin(2.0 * half) / (4.0 * half);
    (1.0 - s * s / q).max(1e-9).sqrt().recip()
}

/// One step for centre and radius; `None` where the points do not tell.
fn newton(flat: &[Flat], [x, y, r]: [f64; 3], reach: f64) -> Option<[f64; 3]> {
    let per_reach = reach.recip();
    // The normal equations of rows (u, v, 1), where (u, v) leads from the centre to the point.
    let [uu, uv, vv, u, v, one, u_off, v_off, off] = sums(flat, |(px, py)| {
        let (dx, dy) = (px - x, py - y);
        let d = (dx * dx + dy * dy).sqrt();
        let per_d = d.max(f64::MIN_POSITIVE).recip();
        let (u, v, off) = (dx * per_d, dy * per_d, d - r);
        let residual = off * per_reach;
        let root = (1.0 - residual * residual).max(0.0);
        let weight = if d > 0.0 { root * root } else { 0.0 };
        let (wu, wv, w_off) = (weight * u, weight * v, weight * off);
        [wu * u, wu * v, wv * v, wu, wv, weight, w_off * u, w_off * v, w_off]
    });
    solve([[uu, uv, u, u_off], [uv, vv, v, v_off], [u, v, one, off]])
}

/// What `of` makes of points, summed up; by turns in two sums, which processors add at once.
fn sums<const N: usize>(flat: &[Flat], of: impl Fn(Flat) -> [f64; N]) -> [f64; N] {
    let (pairs, rest) = flat.as_chunks::<2>();
    let mut both = [[0.0; 2]; N];
    for &[a, b] in pairs {
        let (a, b) = (of(a), of(b));
        for (i, both) in both.iter_mut().enumerate() {
            *both = [both[0] + a[i], both[1] + b[i]];
        }
    }
    let mut sums = both.map(|[a, b]| a + b);
    for &point in rest {
        for (sum, more) in sums.iter_mut().zip(of(point)) {
            *sum += more;
        }
    }
    sums
}

/// Adds the row of a point to the normal equations of `N` unknowns, by Tukey's weight of the residual that it ends with: beyond
/// the reach it has none.
pub(crate) fn add_row<const N: usize, const ROW: usize>(
    m: &mut [[f64; ROW]; N],
    row: [f64; ROW],
    reach: f64,
) {
    let off = row[ROW - 1] / reach;
    let root = (1.0 - off * off).max(0.0);
    if !(root > 0.0) {
        return;
    }
    for (sums, a) in m.iter_mut().zip(row) {
        for (sum, b) in sums.iter_mut().zip(row) {
            *sum += root * root * a * b;
        }
    }
}

/// Solves `N` equations of `N + 1` numbers each (Gauss, with pivots).
pub(crate) fn solve<const N: usize, const ROW: usize>(mut m: [[f64; ROW]; N]) -> Option<[f64; N]> {
    for i in 0..N {
        let pivot = (i..N).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        if !(m[i][i].abs() > 1e-9) {
            return None;
        }
        for j in (0..N).filter(|&j| j != i) {
            let factor = m[j][i] / m[i][i];
            let pivot = m[i];
            for (number, pivot) in m[j].iter_mut().zip(pivot).skip(i) {
                *number -= factor * pivot;
            }
        }
    }
    Some(std::array::from_fn(|i| m[i][N] / m[i][i]))
}

/// Taubin's circle: Newton's steps on the characteristic cubic (Chernov 2010, *Circular and linear regression*).
pub(crate) fn taubin(flat: &[Flat]) -> Option<[f64; 3]> {
    let per_point = (flat.len() as f64).recip();
    let [mx, my] = sums(flat, |(x, y)| [x, y]).map(|sum| sum * per_point);
    let of_point = |(x, y): Flat| {
        let (x, y) = (x - mx, y - my);
        let z = x * x + y * y;
        [x * x, x * y, y * y, x * z, y * z, z * z]
    };
    let [xx, xy, yy, xz, yz, zz] = sums(flat, of_point).map(|sum| sum * per_point);
    let z = xx + yy;
    let covariance = xx * yy - xy * xy;
    if !(covariance > 1e-9 * z * z) {
        return None;
    }
    let variance = zz - z * z;
    let a3 = 4.0 * z;
    let a2 = -3.0 * z * z - zz;
    let a1 = variance * z + 4.0 * covariance * z - xz * xz - yz * yz;
    let a0 = xz * (xz * yy - yz * xy) + yz * (yz * xx - xz * xy) - variance * covariance;
    let mut root = 0.0;
    for _ in 0..30 {
        let value = a0 + root * (a1 + root * (a2 + root * a3));
        let slope = a1 + root * (2.0 * a2 + 3.0 * a3 * root);
        let next = root - value / slope;
        if !next.is_finite() || (next - root).abs() <= 1e-12 * next.abs().max(1e-300) {
            break;
        }
        root = next.max(0.0);
    }
    let determinant = root * root - root * z + covariance;
    let x = (xz * (yy - root) - yz * xy) / (2.0 * determinant);
    let y = (yz * (xx - root) - xz * xy) / (2.0 * determinant);
    let radius = (x * x + y * y + z).sqrt();
    radius.is_finite().then_some([x + mx, y + my, radius])
}

fn through_three(a: Flat, b: Flat, c: Flat) -> Option<[f64; 3]> {
    let (bx, by, cx, cy) = (b.0 - a.0, b.1 - a.1, c.0 - a.0, c.1 - a.1);
    let cross = 2.0 * (bx * cy - by * cx);
    let (bb, cc) = (bx * bx + by * by, cx * cx + cy * cy);
    if !(cross.abs() > 1e-6 * (bb + cc)) {
        return None;
    }
    let (x, y) = ((cy * bb - by * cc) / cross, (bx * cc - cx * bb) / cross);
    Some([a.0 + x, a.1 + y, (x * x + y * y).sqrt()])
}

/// Distance of a point off a circle: less than 0 inside.
fn off((x, y): Flat, [cx, cy, r]: [f64; 3]) -> f64 {
    // Not the platform's hypotenuse: square roots are the same on every machine.
    ((x - cx) * (x - cx) + (y - cy) * (y - cy)).sqrt() - r
}

fn sector((x, y): Flat, [cx, cy, _]: [f64; 3]) -> usize {
    let turn = turn(x - cx, y - cy);
    ((turn * SECTORS as f64) as usize).min(SECTORS - 1)
}

/// The direction of a place as a part of the turn, to 10⁻⁵ radians: the polynomial 4.4.49 of Abramowitz & Stegun (1964).
fn turn(x: f64, y: f64) -> f64 {
    let (wide, high) = (x.abs(), y.abs());
    let t = wide.min(high) / wide.max(high).max(f64::MIN_POSITIVE);
    let s = t * t;
    let angle = t * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let angle = if high > wide { 0.5 * PI - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    0.5 + if y < 0.0 { -angle } else { angle } / TAU
}

/// Median distance of points off a circle.
pub(crate) fn mad(flat: &[Flat], circle: [f64; 3], scratch: &mut Vec<u64>) -> f64 {
    scratch.clear();
    scratch.extend(flat.iter().map(|&p| off(p, circle).abs().to_bits()));
    // Bits of non-negative floats order as the floats do.
    let middle = scratch.len() / 2;
    if scratch.is_empty() { 0.0 } else { f64::from_bits(*scratch.select_nth_unstable(middle).1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::median::median;

    /// Points of a circle's arc around its direction +x, with a normal error.
    fn arc(centre: Flat, radius: f64, turn: f64, sd: f64, count: u64, key: Key) -> Vec<Flat> {
        let one = |i: u64| {
            let unit = |n: u64| key.child(i).child(n).unit();
            let normal = (-2.0 * libm::log(1.0 - unit(1))).sqrt() * libm::cos(TAU * unit(2));
            let (a, r) = (turn * (unit(0) - 0.5), radius + sd * normal);
            (centre.0 + r * libm::cos(a), centre.1 + r * libm::sin(a))
        };
        (0..count).map(one).collect()
    }

    /// Arc in degrees, radius ÷ standard deviation, and what Kåsa's circle is off by (Monte Carlo; percent).
    #[test]
    fn arcs_have_no_bias_where_kasas_circle_is_too_small() {
        for (degrees, per_sd, kasa_off) in [(180.0_f64, 15.0, -1.7), (120.0, 15.0, -10.7), (90.0, 50.0, -4.1)]
        {
            let radii: Vec<f64> = (0..300)
                .map(|i| {
                    let flat = arc((3.0, -2.0), 0.3, degrees.to_radians(), 0.3 / per_sd, 100, Key::new(i));
                    refined(&flat, taubin(&flat).unwrap(), 0.3 / per_sd, &mut Vec::new()).radius_m
                })
                .collect();
            let off = 100.0 * (median(radii).unwrap() / 0.3 - 1.0);
            assert!(off.abs() < 1.5 && off > 0.5 * kasa_off, "{degrees}: {off}");
        }
    }

    /// The closed form against the factors that simulations gave.
    #[test]
    fn short_arcs_are_less_sure() {
        for (degrees, factor) in [(360.0_f64, 1.0), (180.0, 2.3), (120.0, 5.6), (90.0, 10.3), (60.0, 24.0)] {
            let found = arc_factor(degrees.to_radians());
            assert!((found / factor - 1.0).abs() < 0.05, "{degrees}: {found}");
        }
    }

    #[test]
    fn the_standard_error_holds_what_it_says() {
        // Of 200 half circles two thirds or more are within one error, nearly all within three.
        let within = |times: f64| {
            let is_within = |&i: &u64| {
                let flat = arc((0.0, 0.0), 0.2, PI, 0.004, 150, Key::new(i));
                let circle = fit(&flat).unwrap();
                (circle.radius_m - 0.2).abs() < times * circle.se_m
            };
            (0..200).filter(is_within).count()
        };
        assert!(within(1.0) > 110 && within(3.0) > 190, "{} {}", within(1.0), within(3.0));
    }

    #[test]
    fn turns_are_those_of_the_arc_tangent() {
        for i in 0..5000_u32 {
            let a = TAU * (f64::from(i) / 5000.0 - 0.5);
            let found = turn(0.3 * libm::cos(a), 0.3 * libm::sin(a));
            assert!((TAU * (found - 0.5) - a).abs() < 1.2e-5, "{a}: {found}");
        }
        assert!((0.0..=1.0).contains(&turn(0.0, 0.0)));
    }

    #[test]
    fn strays_leaves_and_lines_are_no_part_of_a_circle() {
        let mut flat = arc((0.05, -0.03), 0.15, PI, 0.002, 80, Key::new(3));
        flat.extend([(0.5, 0.4), (0.02, 0.6), (-0.4, 0.0)]);
        assert!((fit(&flat).unwrap().radius_m - 0.15).abs() < 0.003);
        // Half of the points are a thicket at one side.
        let thicket = (0..60).map(|i| (0.3 + 0.004 * f64::from(i % 8), 0.01 * f64::from(i / 8)));
        flat.extend(thicket);
        let found = consensus(&flat, 0.006, [0.02, 1.0], Key::new(5)).unwrap();
        assert!((found.radius_m - 0.15).abs() < 0.005 && found.arc_rad < 1.2 * PI, "{found:?}");
        assert!(fit(&[(0.0, 0.0); 20]).is_none());
        let line: Vec<Flat> = (0..30).map(|i| (0.1 * f64::from(i), 0.2 * f64::from(i))).collect();
        assert!(fit(&line).is_none());
    }
}
