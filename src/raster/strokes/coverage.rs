//! How much of a pixel a strip covers.

use glam::Vec2;

/// Seen across a strip, a pixel is a trapezoid: its square projected onto the strip's normal. What
/// of it lies on one side of an edge is a difference of four parabolas, and what a strip covers is
/// the exact area. Exact areas of neighbouring pixels add up, whatever the slope: lines neither
/// swell nor rope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Half of the trapezoid's lower and upper side.
    outer: f32,
    inner: f32,
    scale: f32,
}

impl Edge {
    /// For an edge whose normal has length 1.
    pub fn new(normal: Vec2) -> Self {
        let (x, y) = (normal.x.abs(), normal.y.abs());
        // Nearly upright edges are taken for a little slanted ones: the difference cannot be seen, and
        // the parabolas would lose their digits.
        let (wide, narrow) = (x.max(y), x.min(y).max(1e-2));
        Self {
            outer: f32::midpoint(wide, narrow),
            inner: (wide - narrow) / 2.0,
            scale: 0.5 / (wide * narrow),
        }
    }

    /// The share of a pixel that lies before an edge `x` pixels beyond its middle.
    pub fn before(&self, x: f32) -> f32 {
        let square = |x: f32| x.max(0.0) * x.max(0.0);
        if x >= self.outer {
            return 1.0;
        }
        let rising = square(x + self.outer) - square(x + self.inner);
        let falling = square(x - self.inner) - square(x - self.outer);
        (self.scale * (rising - falling)).clamp(0.0, 1.0)
    }

    /// The share of a pixel between two edges, `low` and `high` pixels beyond its middle.
    pub fn between(&self, low: f32, high: f32) -> f32 {
        (self.before(high) - self.before(low)).max(0.0)
    }

    /// How far from an edge a pixel's middle may lie and still be cut by it.
    pub fn reach(&self) -> f32 {
        self.outer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts a grid of points in the unit square.
    fn counted(normal: Vec2, low: f32, high: f32) -> f32 {
        let n = 400;
        let mut inside = 0;
        for i in 0..n {
            for k in 0..n {
                let p = Vec2::new(i as f32 + 0.5, k as f32 + 0.5) / n as f32 - Vec2::splat(0.5);
                let x = p.dot(normal);
                inside += i32::from(x >= low && x < high);
            }
        }
        inside as f32 / (n * n) as f32
    }

    #[test]
    fn areas_are_what_counting_gives() {
        for degrees in [0.0_f32, 0.3, 7.0, 30.0, 45.0, 71.0, 90.0, 133.0, 250.0] {
            let (sin, cos) = libm::sincosf(degrees.to_radians());
            let normal = Vec2::new(cos, sin);
            let edge = Edge::new(normal);
            for (low, high) in [(-0.2, 0.2), (0.1, 0.9), (-2.0, 0.3), (-0.05, 0.0), (0.6, 1.2), (-3.0, 3.0)] {
                let (ours, theirs) = (edge.between(low, high), counted(normal, low, high));
                assert!((ours - theirs).abs() < 0.012, "{degrees}° {low}..{high}: {ours}, not {theirs}");
            }
        }
    }

    #[test]
    fn neighbours_add_up() {
        // A strip of any slope puts the same ink on every pixel row.
        for degrees in [0.0_f32, 3.0, 20.0, 44.0] {
            let (sin, cos) = libm::sincosf(degrees.to_radians());
            let edge = Edge::new(Vec2::new(cos, sin));
            for shift in 0..20 {
                let shift = shift as f32 / 20.0;
                let ink: f32 = (-20..20)
                    .map(|x| (x as f32 + shift) * cos)
                    .map(|middle| edge.between(-0.3 - middle, 0.3 - middle))
                    .sum();
                assert!((ink - 0.6 / cos).abs() < 0.02, "{degrees}° at {shift}: {ink}");
            }
        }
    }
}
