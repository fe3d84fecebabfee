//! What the points around a place lie on, by the eigenvalues of their covariance.

use glam::{DMat3, DVec3};

use super::neighbours::Neighbours;

/// Sweeps of Jacobi's method: it converges quadratically.
const SWEEPS: usize = 6;

/// The points around a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// How little they are a surface: the least eigenvalue of their covariance ÷ the largest.
    pub scatter: f64,
    /// Across the surface.
    pub normal: DVec3,
}

impl Patch {
    /// Those within `reach_m` of a place, of some `points` that `tree` is of and that weigh so much each.
    pub fn around(
        at: DVec3,
        reach_m: f64,
        (tree, points): (&Neighbours, &[DVec3]),
        weight: impl Fn(usize) -> f64,
    ) -> Self {
        let limit = reach_m * reach_m;
        let (mut total, mut sum, mut products) = (0.0, DVec3::ZERO, DMat3::ZERO);
        tree.search(at, limit, |point, _| {
            let (away, weight) = (points[point as usize] - at, weight(point as usize));
            total += weight;
            sum += away * weight;
            products += DMat3::from_cols(away * away.x, away * away.y, away * away.z) * weight;
            limit
        });
        let mean = sum / f64::max(total, 1.0);
        let of_mean = DMat3::from_cols(mean * mean.x, mean * mean.y, mean * mean.z);
        let (values, vectors) = eigen(products * (1.0 / f64::max(total, 1.0)) - of_mean);
        let mut order = [0, 1, 2];
        order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
        let [least, _, largest] = order.map(|n| values[n].max(0.0));
        let of_largest = |value: f64| value / largest.max(f64::MIN_POSITIVE);
        Self { scatter: of_largest(least), normal: vectors.col(order[0]) }
    }
}

/// Eigenvalues of a symmetric matrix and, as columns, their vectors (Jacobi 1846).
pub(crate) fn eigen(mut a: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(p)[q];
            if off == 0.0 {
                continue;
            }
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * off);
            let tan = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (tan * tan + 1.0).sqrt();
            let sin = tan * cos;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            a = turn.transpose() * a * turn;
            vectors *= turn;
        }
    }
    (DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        let key = Key::new(8);
        for i in 0..200 {
            let of = |n: u64| key.child(i).child(n).between(-1.0, 1.0);
            let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(of);
            let m = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(b, d, e), DVec3::new(c, e, f));
            let (values, vectors) = eigen(m);
            for k in 0..3 {
                let off = m * vectors.col(k) - vectors.col(k) * values[k];
                assert!(off.length() < 1e-9 && (vectors.col(k).length() - 1.0).abs() < 1e-9, "{m}: {off}");
            }
        }
    }

    #[test]
    fn a_wall_is_flat_and_a_cloud_is_not() {
        let key = Key::new(3);
        let unit = |i: u64, n: u64| key.child(i).child(n).between(-1.0, 1.0);
        let patch = |points: &[DVec3]| {
            let tree = Neighbours::new(points, &Quiet).unwrap();
            Patch::around(DVec3::ZERO, 0.8, (&tree, points), |_| 1.0)
        };
        let wall: Vec<DVec3> = (0..3000).map(|i| DVec3::new(unit(i, 0), unit(i, 1), 0.0)).collect();
        assert!(patch(&wall).scatter < 1e-6 && patch(&wall).normal.z.abs() > 0.999);
        let cloud: Vec<DVec3> = (0..3000).map(|i| DVec3::new(unit(i, 0), unit(i, 1), unit(i, 2))).collect();
        assert!(patch(&cloud).scatter > 0.7);
        let line: Vec<DVec3> = (0..30).map(|i| DVec3::splat(unit(i, 0))).collect();
        assert!(patch(&line).scatter < 1e-6);
        assert!(patch(&[DVec3::ZERO]).scatter == 0.0);
    }
}
