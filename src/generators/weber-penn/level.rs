//! The parameters of one level of stems.

/// A level's parameters; angles in radians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    pub length: f64,
    pub length_spread: f64,
    pub taper: f64,
    pub down_angle: f64,
    pub down_angle_spread: f64,
    pub rotate: f64,
    pub rotate_spread: f64,
    pub branches: f64,
    pub branch_dist: f64,
    pub seg_splits: f64,
    pub split_angle: f64,
    pub split_angle_spread: f64,
    pub segments: u32,
    pub curve: f64,
    pub curve_back: f64,
    pub curve_spread: f64,
}

impl Level {
    /// How far the stem turns before a segment (not the first), radians, random bends aside.
    pub fn turn(&self, segment: u32) -> f64 {
        let count = f64::from(self.segments);
        if self.curve_back == 0.0 {
            self.curve / count
        } else if 2 * segment < self.segments {
            2.0 * self.curve / count
        } else {
            2.0 * self.curve_back / count
        }
    }

    /// The slope of the helix that stems are, radians; `None`: they are none.
    pub fn helix(&self) -> Option<f64> {
        /// Beyond it a helix would be longer than its stem eleven times.
        const STEEPEST: f64 = 1.48;
        (self.curve_spread < 0.0).then(|| (-self.curve_spread).min(STEEPEST))
    }
}
