//! Straight cylinders through points of a stretch, where its axis does not tell which way they lead.
//!
//! Growth goes to and fro, and at forks across the wood: seen along such an axis the points of a round limb are an
//! oval, or fill it. Least squares of the distances from a cylinder turn the direction (Lukács, Martin & Marshall 1998,
//! *Faithful least-squares fitting of spheres, cylinders, cones and tori for reliable segmentation*; `TreeQSM`, Raumonen
//! et al. 2013, does the same).

use glam::DVec3;

use super::circle::{Circle, Flat, SD_PER_MAD, TUKEY, add_row, mad, solve};

/// Steps of the least squares.
const STEPS: usize = 6;

/// A step turns the axis by no more than this along each direction across it, as a tangent.
const MOST_TURN: f64 = 0.4;

/// A circle that is larger than this many times the spread of its points is put through a patch of them.
const WIDE: f64 = 2.5;

/// Turns up to this, as a tangent, need no proof;
const SMALL: f64 = 0.2;

/// and beyond it points lead aside along the stretch by this part of what the turn says: an upright oval looks like a rod seen
/// askew, but for that.
const PROVEN: f64 = 0.35;

/// A smaller turn changes nothing that is measured.
const LEAST_TURN: f64 = 2e-3;

/// Two directions across the cylinder that points lie on, given from a place near its axis, and the direction along it: by
/// turning those in which `start` was seen; and whether the points themselves lead that way. `None` where they do not tell.
pub(crate) fn turned(
    points: &[DVec3],
    [mut u, mut v, mut w]: [DVec3; 3],
    start: &Circle,
) -> Option<([DVec3; 3], bool)> {
    let mut flat: Vec<Flat> = points.iter().map(|p| (p.dot(u), p.dot(v))).collect();
    let mut scratch = Vec::with_capacity(points.len());
    let mut circle = [start.centre.0, start.centre.1, start.radius_m];
    // Of a rod that is seen from one side the points fill the plane, and the circle through them says nothing.
    let [x, y] =
        [0, 1].map(|axis| flat.iter().map(|p| [p.0, p.1][axis]).sum::<f64>() / flat.len().max(1) as f64);
    let spread_m = mad(&flat, [x, y, 0.0], &mut scratch);
    let is_patch = circle[2] > WIDE * spread_m;
    if is_patch {
        circle = [x, y, spread_m];
    }
    let start_m = circle[2];
    let frame = [u, v, w];
    let mut leads = None;
    for _ in 0..STEPS {
        flat.clear();
        flat.extend(points.iter().map(|p| (p.dot(u), p.dot(v))));
        let [x, y, r] = circle;
        let reach = TUKEY * (SD_PER_MAD * mad(&flat, circle, &mut scratch)).max(1e-4 * r);
        // The normal equations of rows (n, z n, 1), where n leads from the axis to the point and z along it.
        let mut m = [[0.0; 6]; 5];
        for (p, &(px, py)) in points.iter().zip(&flat) {
            let (dx, dy) = (px - x, py - y);
            let d = (dx * dx + dy * dy).sqrt();
            let off = d - r;
            if !(d > 0.0) {
                continue;
            }
            let (nx, ny, z) = (dx / d, dy / d, p.dot(w));
            let row = [nx, ny, nx * z, ny * z, 1.0, off];
            add_row(&mut m, row, reach);
        }
        let [by_x, by_y, turn_x, turn_y, by_r] = solve(m)?;
        // At first: how far the wood leads aside, before any turn has made a circle of what is none.
        leads.get_or_insert((turn_x, turn_y));
        circle = [x + by_x, y + by_y, r + by_r];
        if !(circle[2] > 0.25 * start_m && circle[2] < 4.0 * start_m) {
            return None;
        }
        let [turn_x, turn_y] = [turn_x, turn_y].map(|turn| turn.clamp(-MOST_TURN, MOST_TURN));
        w = (w + u * turn_x + v * turn_y).try_normalize()?;
        u = u.reject_from_normalized(w).try_normalize()?;
        v = w.cross(u);
        if turn_x.abs() + turn_y.abs() < LEAST_TURN {
            break;
        }
    }
    let along = w.dot(frame[2]);
    let aside = [w.dot(frame[0]) / along, w.dot(frame[1]) / along];
    let squared = aside[0] * aside[0] + aside[1] * aside[1];
    let is_proven = is_patch
        || squared < SMALL * SMALL
        || leads.is_some_and(|(x, y)| x * aside[0] + y * aside[1] >= PROVEN * squared);
    Some(([u, v, w], is_proven))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circle::fit;
    use linden_base::random::Key;
    use std::f64::consts::TAU;

    /// Points of a rod of 5 cm radius and half a metre that leads along `axis`, their error 3 mm.
    fn rod(axis: DVec3, turn: f64) -> Vec<DVec3> {
        let (u, v) = axis.any_orthonormal_pair();
        (0..200)
            .map(|i| {
                let unit = |n: u64| Key::new(5).child(i).child(n).unit();
                let (a, r) = (turn * unit(0), 0.05 + 0.005 * (unit(1) - 0.5));
                axis * (0.5 * (unit(2) - 0.5)) + u * (r * libm::cos(a)) + v * (r * libm::sin(a))
            })
            .collect()
    }

    #[test]
    fn a_rod_that_is_seen_askew_is_turned_to_its_axis() {
        for (turn, most_off) in [(TAU, 0.02), (0.5 * TAU, 0.06)] {
            for askew in [DVec3::new(0.3, 1.0, 0.0), DVec3::new(-0.2, 1.0, 0.35)].map(DVec3::normalize) {
                let points = rod(DVec3::Y, turn);
                let (u, v) = askew.any_orthonormal_pair();
                let seen = |u: DVec3, v: DVec3| {
                    fit(&points.iter().map(|p| (p.dot(u), p.dot(v))).collect::<Vec<_>>()).unwrap()
                };
                let before = seen(u, v);
                let ([u, v, w], is_proven) = turned(&points, [u, v, askew], &before).unwrap();
                assert!(is_proven);
                let after = seen(u, v);
                assert!(w.dot(DVec3::Y) > 0.995, "{askew}: {w}");
                assert!(after.mad_m < 0.003 && after.mad_m < 0.5 * before.mad_m, "{after:?} {before:?}");
                assert!((after.radius_m / 0.05 - 1.0).abs() < most_off, "{}", after.radius_m);
            }
        }
        assert!(turned(&[], [DVec3::X, DVec3::Z, DVec3::Y], &fit_of_one()).is_none());
    }

    /// Its section is an ellipse of 21 by 15 cm, and nothing leads aside.
    #[test]
    fn an_upright_oval_is_no_rod_seen_askew() {
        let points: Vec<DVec3> = (0..200)
            .map(|i| {
                let unit = |n: u64| Key::new(6).child(i).child(n).unit();
                let (a, off) = (TAU * unit(0), 0.004 * (unit(1) - 0.5));
                DVec3::new((0.105 + off) * libm::cos(a), 0.2 * (unit(2) - 0.5), (0.075 + off) * libm::sin(a))
            })
            .collect();
        let flat: Vec<Flat> = points.iter().map(|p| (p.x, p.z)).collect();
        let frame = [DVec3::X, DVec3::Z, DVec3::Y];
        let found = turned(&points, frame, &fit(&flat).unwrap());
        assert!(found.is_none_or(|([.., w], is_proven)| w.y > 0.97 || !is_proven), "{found:?}");
    }

    fn fit_of_one() -> Circle {
        Circle { centre: (0.0, 0.0), radius_m: 0.1, mad_m: 0.0, inliers: 0, arc_rad: 0.0, se_m: 0.0 }
    }
}
