//! How the weights of the motions go over a loop.

use std::f64::consts::TAU;

use super::{Blow, Motion};

/// Frames per second: the film's, which viewers of USD assume.
const FRAMES_PER_SECOND: u32 = 24;
/// Periods of the stems, and the most of branches and leaves, in a loop: without a common divisor, so
/// that it is long before anything looks the same.
const STEM_PERIODS: u32 = 2;
const BRANCH_PERIODS: u32 = 5;
const LEAF_PERIODS: u32 = 13;
/// Frames that show a period well when what is between them is straight.
const FRAMES_PER_PERIOD: u32 = 12;
/// The fewest frames of a loop.
const FEWEST_FRAMES: u32 = 4 * FRAMES_PER_PERIOD;
/// How far stems lean with the wind, as a share of how far they go.
const LEAN: f64 = 0.4;

/// How much stronger the strongest gust is than the mean.
const GUST: f64 = 0.6;
/// The most that a motion goes beyond its amplitude, to either side.
pub(super) const MOST: f32 = 1.0 + GUST as f32;

/// A loop: the last frame is the first again.
#[derive(Clone, Debug, PartialEq)]
pub struct Sway {
    frames: u32,
    gustiness: f64,
}

impl Sway {
    /// The loop that is nearest to the frequency: whole periods of everything in whole frames.
    pub fn new(blow: &Blow) -> Self {
        let frames = f64::from(STEM_PERIODS * FRAMES_PER_SECOND) / blow.frequency_hz.max(1e-3);
        Self { frames: (frames.round() as u32).max(FEWEST_FRAMES), gustiness: blow.gustiness }
    }

    /// Frames after the first one; at `frames` everything is as at 0.
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// How much gusts come and go, 0 to 1.
    pub const fn gustiness(&self) -> f64 {
        self.gustiness
    }

    /// Frames in a second.
    pub const fn frames_per_second(&self) -> u32 {
        FRAMES_PER_SECOND
    }

    /// How far a motion is out at a frame, in amplitudes: ±1 without gusts.
    pub(super) fn swing(&self, motion: Motion, frame: u32) -> f32 {
        (self.weight(motion, frame) - 0.5) * 2.0 * MOST
    }

    /// A motion's weight at a frame, 0 to 1: ½ is no motion.
    pub fn weight(&self, motion: Motion, frame: u32) -> f32 {
        let share = f64::from(frame % self.frames) / f64::from(self.frames);
        let angle = |periods: u32| TAU * f64::from(periods) * share;
        // One gust comes and goes in a loop, and a smaller one within it.
        let gust = 0.7 * libm::sin(angle(1) - 1.0) + 0.3 * libm::sin(angle(3));
        let gust = 1.0 + GUST * self.gustiness * gust;
        let most = self.frames / FRAMES_PER_PERIOD;
        let (branches, leaves) = (angle(BRANCH_PERIODS.min(most)), angle(LEAF_PERIODS.min(most)));
        let weight = match motion {
            Motion::Begin => return 1.0,
            Motion::Stem => LEAN + (1.0 - LEAN) * libm::sin(angle(STEM_PERIODS)),
            Motion::BranchSine => libm::sin(branches),
            Motion::BranchCosine => libm::cos(branches),
            Motion::LeafSine => libm::sin(leaves),
            Motion::LeafCosine => libm::cos(leaves),
        };
        (0.5 + gust * weight / (2.0 * f64::from(MOST))) as f32
    }
}
