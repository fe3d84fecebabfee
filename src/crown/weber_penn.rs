//! The eight crowns of Weber and Penn: radius as a function of height.
//!
//! Weber & Penn 1995, *Creation and Rendering of Realistic Trees*, the table of `ShapeRatio`. In the
//! paper it scales the length of the trunk's branches by where they leave it; here it is the radius
//! of the crown there. Its argument is 1 at the crown's base and 0 at its top.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::skin::Skin;
use super::{
    CROWN_HEIGHT, CROWN_RADIUS, Crown, CrownError, Dimensions, Shape, ShapeKnob, level, radius_squared,
    revolve, round_bounds,
};
use linden_base::knob::{Kind, Knob, Value};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "weber-penn",
    help: "one of the eight crowns of Weber & Penn 1995, from conical to flame",
    knobs: &[
        ShapeKnob { knob: CROWN_HEIGHT, default: || Value::Real(9.0) },
        ShapeKnob { knob: CROWN_RADIUS, default: || Value::Real(3.5) },
        ShapeKnob {
            knob: Knob::new(
                "profile_kind",
                Kind::Choice(&KIND_NAMES),
                "",
                "which of the eight: how the radius changes with height",
            )
            .details(
                "The paper's ShapeRatio, there for the length of branches, here for the crown's radius. \
                 conical narrows from the base to a fifth at the top, tapered-cylindrical to a half; flame \
                 is widest at three tenths of its height and pointed at both ends, tend-flame ends half as \
                 wide as it is there; inverse-conical is widest at the top; spherical and hemispherical are \
                 round.",
            )
            .see_also(&["crown_height", "crown_radius", "crown"]),
            default: || Value::Word("flame".to_owned()),
        },
    ],
    build,
};

/// Straight pieces of the paper's function: up to which ratio, and the radius's share at both ends.
type Straight = &'static [(f64, f64, f64)];

/// The radius's share of the widest, by the ratio.
#[derive(Clone, Copy, Debug)]
enum Share {
    /// Pieces, the first from 0, the last up to 1.
    Straight(Straight),
    /// `0.2 + 0.8 sin(k · ratio)`, with `k`.
    Sine(f64),
}

/// Name and share, in the paper's order of its numbers 0 to 7.
const KINDS: [(&str, Share); 8] = [
    ("conical", Share::Straight(&[(1.0, 0.2, 1.0)])),
    ("spherical", Share::Sine(PI)),
    ("hemispherical", Share::Sine(0.5 * PI)),
    ("cylindrical", Share::Straight(&[(1.0, 1.0, 1.0)])),
    ("tapered-cylindrical", Share::Straight(&[(1.0, 0.5, 1.0)])),
    ("flame", Share::Straight(&[(0.7, 0.0, 1.0), (1.0, 1.0, 0.0)])),
    ("inverse-conical", Share::Straight(&[(1.0, 1.0, 0.2)])),
    ("tend-flame", Share::Straight(&[(0.7, 0.5, 1.0), (1.0, 1.0, 0.5)])),
];

const KIND_NAMES: [&str; KINDS.len()] = {
    let mut names = [""; KINDS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = KINDS[i].0;
        i += 1;
    }
    names
};

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    let kind = dimensions.word("profile_kind")?;
    let known = KINDS.iter().find(|(name, _)| *name == kind);
    let &(_, share) = known.ok_or_else(|| CrownError::BadValue {
        knob: "profile_kind",
        problem: format!("expected one of: {}", KIND_NAMES.join(", ")),
    })?;
    Ok(Box::new(WeberPenn {
        height_m: dimensions.metres(CROWN_HEIGHT.name)?,
        radius_m: dimensions.metres(CROWN_RADIUS.name)?,
        share,
    }))
}

impl Share {
    fn at(self, ratio: f64) -> f64 {
        match self {
            Self::Sine(k) => 0.2 + 0.8 * libm::sin(k * ratio),
            Self::Straight(pieces) => {
                let mut from = 0.0;
                for &(to, low, high) in pieces {
                    if ratio <= to {
                        return low + (high - low) * (ratio - from) / (to - from);
                    }
                    from = to;
                }
                pieces.last().map_or(0.0, |&(_, _, high)| high)
            }
        }
    }

    /// The integral of the share's square from 0 to a ratio.
    fn squares(self, ratio: f64) -> f64 {
        match self {
            Self::Sine(k) => {
                let (sin2, cos) = (libm::sin(2.0 * k * ratio), libm::cos(k * ratio));
                0.04 * ratio + 0.32 * (1.0 - cos) / k + 0.64 * (0.5 * ratio - 0.25 * sin2 / k)
            }
            Self::Straight(pieces) => {
                let (mut from, mut sum) = (0.0, 0.0);
                for &(to, low, _) in pieces {
                    let end = ratio.clamp(from, to);
                    // Shares at both ends of the part below `ratio`: a frustum.
                    let (a, b) = (low, self.at(end));
                    sum += (end - from) * (a * a + a * b + b * b) / 3.0;
                    from = to;
                }
                sum
            }
        }
    }

    /// The ratio up to which the integral has a value.
    fn ratio_of(self, squares: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        // 52 halvings use up the significand.
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if self.squares(middle) < squares { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

struct WeberPenn {
    height_m: f64,
    radius_m: f64,
    share: Share,
}

impl WeberPenn {
    /// Height and radius at a ratio.
    fn at(&self, ratio: f64) -> (f64, f64) {
        (self.height_m * (1.0 - ratio), self.radius_m * self.share.at(ratio))
    }
}

impl Crown for WeberPenn {
    fn bounds(&self) -> Bounds {
        // Each of the functions reaches 1.
        round_bounds(0.0, self.height_m, self.radius_m)
    }

    fn contains(&self, p: DVec3) -> bool {
        let ratio = 1.0 - p.y / self.height_m;
        if !(0.0..=1.0).contains(&ratio) {
            return false;
        }
        let (_, radius) = self.at(ratio);
        radius_squared(p) <= radius * radius
    }

    /// The volume above a ratio grows as the integral of the share's square does.
    fn sample(&self, key: Key) -> DVec3 {
        let (height, radius) = self.at(self.share.ratio_of(key.child(0).unit() * self.share.squares(1.0)));
        level(height, radius * key.child(1).in_disc())
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        let mut profile: Vec<(f64, f64)> = (0..=40).map(|i| self.at(f64::from(i) / 40.0)).collect();
        profile.insert(0, (self.height_m, 0.0));
        profile.push((0.0, 0.0));
        revolve(&profile, &[0.0, 0.3, 0.5, 0.7, 1.0].map(|ratio| self.at(ratio)))
    }

    fn skin(&self) -> Skin {
        Skin::revolved(&(0..=24).map(|i| self.at(f64::from(i) / 24.0)).collect::<Vec<_>>())
    }

    fn volume_m3(&self) -> f64 {
        PI * self.radius_m * self.radius_m * self.height_m * self.share.squares(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{assert_uniform, volume_by_probes};

    fn of(kind: &str) -> Box<dyn Crown> {
        SHAPE.of(&[("profile_kind", Value::Word(kind.to_owned()))]).unwrap()
    }

    /// The paper's table at the ratios 0, 0.35, 0.7, 0.85 and 1, worked out by hand.
    #[test]
    fn shares_are_those_of_the_paper() {
        let expected = [
            [0.2, 0.48, 0.76, 0.88, 1.0],
            [0.2, 0.912_805_2, 0.847_213_6, 0.563_192_4, 0.2],
            [0.2, 0.617_998_9, 0.912_805_2, 0.977_895_9, 1.0],
            [1.0, 1.0, 1.0, 1.0, 1.0],
            [0.5, 0.675, 0.85, 0.925, 1.0],
            [0.0, 0.5, 1.0, 0.5, 0.0],
            [1.0, 0.72, 0.44, 0.32, 0.2],
            [0.5, 0.75, 1.0, 0.75, 0.5],
        ];
        for ((name, share), row) in KINDS.into_iter().zip(expected) {
            for (ratio, expected) in [0.0, 0.35, 0.7, 0.85, 1.0].into_iter().zip(row) {
                assert!((share.at(ratio) - expected).abs() < 1e-6, "{name} at {ratio}: {}", share.at(ratio));
            }
        }
    }

    #[test]
    fn the_integral_of_squares_is_that_of_the_function() {
        const SLICES: i32 = 20_000;
        for (name, share) in KINDS {
            for end in [0.3, 0.7, 0.9, 1.0] {
                let at = |i: i32| share.at(end * (f64::from(i) + 0.5) / f64::from(SLICES));
                let slice = |i: i32| at(i) * at(i);
                let sum = (0..SLICES).map(slice).sum::<f64>() * end / f64::from(SLICES);
                assert!((share.squares(end) - sum).abs() < 1e-7, "{name} to {end}");
                // Where the radius is 0 the integral hardly changes with the ratio.
                let back = share.squares(share.ratio_of(sum));
                assert!((back - sum).abs() < 1e-7, "{name} back to {end}");
            }
        }
    }

    #[test]
    fn points_are_uniform_in_volume() {
        for kind in KIND_NAMES {
            let crown = of(kind);
            assert_uniform(&*crown);
            let probed = volume_by_probes(&*crown);
            assert!((probed / crown.volume_m3() - 1.0).abs() < 0.02, "{kind}: {probed}");
        }
    }

    #[test]
    fn the_conical_one_stands_on_its_wide_end_and_the_inverse_one_does_not() {
        let at = |kind: &str, height: f64| of(kind).contains(DVec3::new(3.0, height, 0.0));
        assert!(at("conical", 0.1) && !at("conical", 8.9));
        assert!(!at("inverse-conical", 0.1) && at("inverse-conical", 8.9));
    }
}
