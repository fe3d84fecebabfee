//! The turtle's orientation.

use glam::DVec3;

/// Rotations between two re-orthonormalisations. Each rotation adds an error of about 1e-16 to the
/// frame; the error of so few stays below 1e-14.
const MAX_TURNS: u32 = 64;

/// Sine and cosine of an angle, and the angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    sin: f64,
    cos: f64,
    pub degrees: f64,
}

impl Turn {
    pub const HALF: Self = Self { sin: 0.0, cos: -1.0, degrees: 180.0 };

    /// Exact for quarter turns, so that square shapes close.
    pub fn by_degrees(degrees: f64) -> Self {
        let reduced = degrees % 360.0;
        let (sin, cos) = match reduced {
            0.0 => (0.0, 1.0),
            90.0 | -270.0 => (1.0, 0.0),
            180.0 | -180.0 => (0.0, -1.0),
            270.0 | -90.0 => (-1.0, 0.0),
            _ => libm::sincos(reduced.to_radians()),
        };
        Self { sin, cos, degrees }
    }

    pub fn sin_cos(self) -> [f64; 2] {
        [self.sin, self.cos]
    }

    /// Turns two axes of a frame in their plane, the first towards the second.
    #[inline]
    fn apply(self, first: &mut DVec3, second: &mut DVec3) {
        let (a, b) = (*first, *second);
        *first = a * self.cos + b * self.sin;
        *second = b * self.cos - a * self.sin;
    }
}

/// About which of its axes a turtle turns.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axis {
    /// U: the heading towards the left.
    Yaw,
    /// L: down.
    Pitch,
    /// H: to the left.
    Roll,
}

/// H, L and U: right-handed, H × L = U.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub heading: DVec3,
    pub left: DVec3,
    pub up: DVec3,
    /// Rotations since the frame was orthonormal.
    turns: u32,
}

impl Frame {
    /// Looking up, its left at −X.
    pub const START: Self = Self { heading: DVec3::Y, left: DVec3::NEG_X, up: DVec3::Z, turns: 0 };

    #[expect(clippy::inline_always, reason = "a call would send the frame through memory")]
    #[inline(always)]
    pub fn turn(&mut self, axis: Axis, turn: Turn) {
        match axis {
            Axis::Yaw => turn.apply(&mut self.heading, &mut self.left),
            Axis::Pitch => turn.apply(&mut self.up, &mut self.heading),
            Axis::Roll => turn.apply(&mut self.up, &mut self.left),
        }
        self.count_turn();
    }

    #[inline]
    fn count_turn(&mut self) {
        self.turns += 1;
        if self.turns == MAX_TURNS {
            *self = self.orthonormal();
        }
    }

    /// By value, so that a frame can stay in registers where it is turned.
    #[cold]
    fn orthonormal(self) -> Self {
        let heading = self.heading.normalize();
        let left = (self.left - heading * self.left.dot(heading)).normalize();
        Self { heading, left, up: heading.cross(left), turns: 0 }
    }

    /// `$`: L = V × H / |V × H|, U = H × L with V straight up (ABOP, section 2.2.1). With H vertical
    /// every L is horizontal, and the turtle stays as it is.
    pub fn level(&mut self) {
        const VERTICAL: f64 = 1e-9;
        let left = DVec3::Y.cross(self.heading);
        let length = left.length();
        if length > VERTICAL {
            self.left = left / length;
            self.up = self.heading.cross(self.left);
        }
    }

    /// Tropism: a turn of e·|H × T| radians about H × T (ABOP, section 2.1, p. 58), which brings H
    /// nearer to T. With both along one line nothing turns.
    pub fn bend(&mut self, tropism: DVec3, susceptibility: f64) {
        const ALONG: f64 = 1e-12;
        let torque = self.heading.cross(tropism);
        let strength = torque.length();
        if !(strength > ALONG) {
            return;
        }
        let axis = torque / strength;
        let (sin, cos) = libm::sincos(susceptibility * strength);
        for direction in [&mut self.heading, &mut self.left, &mut self.up] {
            *direction =
                *direction * cos + axis.cross(*direction) * sin + axis * (axis.dot(*direction) * (1.0 - cos));
        }
        self.count_turn();
    }
}
