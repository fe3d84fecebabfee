//! A plane through places.

use glam::DVec3;

/// A plane that is not upright.
pub(crate) struct Plane {
    middle: DVec3,
    /// How it rises along x and z.
    pub slope: [f64; 2],
}

impl Plane {
    /// Through places, by least squares; `None` of none. Level where they lie on one line: where the determinant of their
    /// spread is no more than a share, `line`, of what it could be.
    pub fn through(places: &[DVec3], line: f64) -> Option<Self> {
        let middle = places.iter().copied().reduce(|a, b| a + b)? / places.len() as f64;
        let (mut xx, mut xz, mut zz, mut xy, mut zy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &p in places {
            let off = p - middle;
            (xx, xz, zz) = (xx + off.x * off.x, xz + off.x * off.z, zz + off.z * off.z);
            (xy, zy) = (xy + off.x * off.y, zy + off.z * off.y);
        }
        let determinant = xx * zz - xz * xz;
        let is_line = determinant <= line * xx * zz;
        let slope =
            [(xy * zz - zy * xz), (zy * xx - xy * xz)].map(|d| if is_line { 0.0 } else { d / determinant });
        Some(Self { middle, slope })
    }

    pub fn height_m(&self, p: DVec3) -> f64 {
        self.middle.y + self.slope[0] * (p.x - self.middle.x) + self.slope[1] * (p.z - self.middle.z)
    }
}
