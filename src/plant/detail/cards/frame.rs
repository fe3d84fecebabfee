//! Which way a piece of foliage lies.

use glam::{DMat3, DVec3, Vec3};

use super::clusters::Mass;

/// How much a piece's upper side is drawn to the sky, as a share of its spread: flat sprays keep their plane, round
/// pieces stand upright.
const UPRIGHT: f64 = 0.25;
/// How much its heading is drawn outwards, the same.
const OUTWARD: f64 = 0.25;

/// The place of a piece: its middle, its size and its own directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::detail) struct Frame {
    pub middle: Vec3,
    /// Away from where it hangs.
    pub heading: Vec3,
    /// Off the plane in which it mostly lies.
    pub up: Vec3,
    /// The root of its mean square distance from the middle, metres.
    pub radius_m: f32,
}

impl Frame {
    /// Of what hangs at `foot`.
    pub fn of(mass: &Mass, foot: Vec3) -> Self {
        let (middle, spread) = (mass.middle(), mass.covariance());
        let trace = (spread.x_axis.x + spread.y_axis.y + spread.z_axis.z).max(1e-12);
        let spread = spread * (1.0 / trace);
        let up = axes(spread - diagonal(DVec3::new(0.0, UPRIGHT, 0.0)))[0];
        let up = if up.y < 0.0 { -up } else { up };
        let flat = |v: DVec3| v - up * v.dot(up);
        let out = flat(middle - foot.as_dvec3());
        let pull = out.normalize_or_zero();
        // In the plane alone: what is off it counts less than nothing.
        let across = DMat3::from_cols(flat(DVec3::X), flat(DVec3::Y), flat(DVec3::Z));
        let in_plane = across * spread * across + outer(pull) * OUTWARD - outer(up);
        let heading = axes(in_plane)[2];
        let heading = if heading.dot(out) < 0.0 { -heading } else { heading };
        let heading = flat(heading).normalize_or(up.any_orthonormal_vector());
        Self {
            middle: middle.as_vec3(),
            heading: heading.as_vec3(),
            up: up.as_vec3(),
            radius_m: trace.sqrt() as f32,
        }
    }

    pub fn side(&self) -> Vec3 {
        self.heading.cross(self.up)
    }

    /// In units of its radius, by its own directions.
    pub fn local(&self, place: Vec3) -> Vec3 {
        self.turned((place - self.middle) / self.radius_m)
    }

    /// A direction, by its own.
    pub fn turned(&self, direction: Vec3) -> Vec3 {
        Vec3::new(direction.dot(self.side()), direction.dot(self.heading), direction.dot(self.up))
    }
}

fn diagonal(v: DVec3) -> DMat3 {
    DMat3::from_diagonal(v)
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// Sweeps of [`axes`]: three make off-diagonals vanish in double precision.
const SWEEPS: usize = 6;

/// The unit eigenvectors of a symmetric matrix by rising eigenvalue, by Jacobi's rotations (Golub & Van Loan, Matrix
/// Computations, 8.5).
fn axes(matrix: DMat3) -> [DVec3; 3] {
    let (mut a, mut v) = (matrix, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a.col(q)[p];
            if off.abs() < 1e-300 {
                continue;
            }
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * off);
            let tan = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (tan * tan + 1.0).sqrt();
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(p)[p], turn.col_mut(q)[q]) = (cos, cos);
            (turn.col_mut(p)[q], turn.col_mut(q)[p]) = (-tan * cos, tan * cos);
            a = turn.transpose() * a * turn;
            v *= turn;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a.col(i)[i].total_cmp(&a.col(j)[j]));
    order.map(|i| v.col(i).normalize_or(DVec3::Y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_eigenvectors_in_rising_order() {
        for seed in 0..50_u32 {
            let r = |k: u32| {
                f64::from((seed * 7 + k).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5
            };
            let (a, b) = (DVec3::new(r(1), r(2), r(3)), DVec3::new(r(4), r(5), r(6)));
            let matrix = outer(a) * 2.0 + outer(b) - diagonal(DVec3::new(r(7), r(8), r(9)));
            let mut before = f64::NEG_INFINITY;
            for axis in axes(matrix) {
                let image = matrix * axis;
                let value = image.dot(axis);
                assert!((image - axis * value).length() < 1e-9, "{seed}");
                assert!(value >= before - 1e-12);
                before = value;
            }
        }
    }
}
