//! Headings in the plane, and the step along each.

use glam::DVec2;

use super::super::frame::Turn;

/// Parts of the finest circle: hundredths of a degree.
const FINEST: u32 = 36_000;
/// Parts of it that are a degree.
const DEGREE: f64 = 100.0;

/// The coarsest circle of an even number of equal parts on which an angle is a whole number of parts:
/// how many there are, and how many the angle is. `None` for an angle with more than two decimals.
pub(super) fn divide(angle_deg: f64) -> Option<(u32, u32)> {
    let hundredths = (angle_deg * DEGREE).round();
    if hundredths / DEGREE != angle_deg {
        return None;
    }
    let turn = hundredths.rem_euclid(f64::from(FINEST)) as u32;
    // Half a turn is a whole number of parts, too.
    let (mut common, mut rest) = (FINEST / 2, turn);
    while rest != 0 {
        (common, rest) = (rest, common % rest);
    }
    Some((FINEST / common, turn / common))
}

/// A circle of equal parts. A heading is a number of parts, counted from straight up to the left.
pub(super) struct Circle {
    /// By heading: one segment, on the grid; zero until it is first asked for.
    steps: Vec<DVec2>,
    segment_m: f64,
    grid_m: f64,
}

impl Circle {
    pub fn new(parts: u32) -> Self {
        Self { steps: vec![DVec2::ZERO; parts as usize], segment_m: 0.0, grid_m: 0.0 }
    }

    /// `reach` is the most segments between any place and the foot.
    pub fn set_step(&mut self, segment_m: f64, reach: u64) {
        self.segment_m = segment_m;
        // Below 2^(e+1); one power more for what rounding to the grid adds.
        let exponent = libm::ilogb(segment_m * reach as f64) + 2;
        self.grid_m = libm::scalbn(1.0, exponent - 53);
    }

    /// A heading, turned to the left.
    pub fn turned(&self, heading: u32, parts: u32) -> u32 {
        let sum = heading + parts;
        let all = self.steps.len() as u32;
        if sum < all { sum } else { sum - all }
    }

    /// One segment along a heading.
    pub fn step(&mut self, heading: u32) -> DVec2 {
        let step = self.steps[heading as usize];
        if step == DVec2::ZERO { self.find(heading) } else { step }
    }

    #[cold]
    fn find(&mut self, heading: u32) -> DVec2 {
        let [sin, cos] = Turn::by_degrees(f64::from(heading) * 360.0 / self.steps.len() as f64).sin_cos();
        let on_grid = |share: f64| libm::rint(self.segment_m * share / self.grid_m) * self.grid_m;
        // Up is +Y and left is -X; a zero has no sign.
        let step = DVec2::new(0.0 - on_grid(sin), 0.0 + on_grid(cos));
        self.steps[heading as usize] = step;
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_the_coarsest_even_ones() {
        for (angle_deg, circle) in [
            (90.0, (4, 1)),
            (-90.0, (4, 3)),
            (22.5, (16, 1)),
            (20.0, (18, 1)),
            (72.0, (10, 2)),
            (25.7, (3600, 257)),
            (0.0, (2, 0)),
            (-360.0, (2, 0)),
            (180.0, (2, 1)),
            (0.01, (36_000, 1)),
        ] {
            assert_eq!(divide(angle_deg), Some(circle), "{angle_deg}");
        }
        assert_eq!(divide(360.0 / 7.0), None);
        assert_eq!(divide(25.701), None);
    }

    #[test]
    fn any_sum_of_steps_within_the_reach_is_exact() {
        for (angle_deg, segment_m, reach) in [(25.7, 0.02, 1000_u64), (13.37, 1e6, 1 << 22), (1.0, 1e-6, 1)] {
            let (parts, turn) = divide(angle_deg).unwrap();
            let mut circle = Circle::new(parts);
            circle.set_step(segment_m, reach);
            let mut heading = 0;
            for _ in 0..parts {
                let step = circle.step(heading);
                assert!((step.length() - segment_m).abs() <= circle.grid_m);
                for length in step.abs().to_array() {
                    let units = length / circle.grid_m;
                    assert_eq!(units.fract(), 0.0);
                    assert!(units * reach as f64 <= 9_007_199_254_740_992.0);
                }
                heading = circle.turned(heading, turn);
            }
        }
    }
}
