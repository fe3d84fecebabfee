//! A surface of revolution: any profile of height and radius, straight or smooth, turned about the
//! axis.
//!
//! The profile may turn back in height (an overhanging edge, a dented top) and cross itself; ends that
//! do not touch the axis are closed by discs. The solid is everything that the closed profile winds
//! around ([`Lathe`]).

use super::lathe::Lathe;
use super::{Crown, CrownError, Dimensions, SIZE_LIMIT_M, Shape, ShapeKnob};
use linden_base::knob::{Kind, Knob, Value};

/// The row of the table of shapes.
pub const SHAPE: Shape = Shape {
    id: "revolution",
    help: "any profile turned about the axis: draw the crown that you see",
    knobs: &[
        ShapeKnob {
            knob: Knob::new(
                "profile_points",
                Kind::Profile { least: 2, most: 64 },
                "m",
                "pairs height,radius that the profile runs through",
            )
            .details(
                "Read them off a photograph from the crown's base to its top: height, and half of the width \
                 there. Heights may turn back, for an edge that overhangs or a dented top. Ends off the \
                 axis are closed by discs.",
            )
            .see_also(&["profile_curve", "profile", "crown"]),
            default: || {
                Value::Profile(vec![[0.0, 0.6], [0.8, 2.6], [3.0, 3.6], [6.0, 2.6], [7.4, 1.2], [8.0, 0.0]])
            },
        },
        ShapeKnob {
            knob: Knob::new(
                "profile_curve",
                Kind::Choice(&["straight", "spline"]),
                "",
                "how the profile runs between its pairs; a spline never leaves the box of two neighbours",
            )
            .see_also(&["profile_points"]),
            default: || Value::Word("spline".to_owned()),
        },
    ],
    build,
};

/// Straight pieces that a spline has between two pairs: the profile is these pieces, and its volume
/// that of theirs.
const PIECES: u32 = 24;

/// A solid that fills less of the cylinder around it is a thread or a sheet.
const LEAST_FILL: f64 = 1e-3;

fn build(dimensions: &Dimensions) -> Result<Box<dyn Crown>, CrownError> {
    let bad = |problem: String| CrownError::BadValue { knob: "profile_points", problem };
    let pairs = dimensions.profile("profile_points")?;
    if pairs.iter().flatten().any(|x| x.is_nan() || x.abs() > SIZE_LIMIT_M) {
        return Err(bad(format!("a height or radius is beyond {SIZE_LIMIT_M} m")));
    }
    if pairs.iter().any(|pair| pair[1] < 0.0) {
        return Err(bad("a radius is below 0".to_owned()));
    }
    let profile = match dimensions.word("profile_curve")? {
        "spline" => spline(pairs),
        _ => pairs.to_vec(),
    };
    let solid = Lathe::new(&profile);
    let fill = solid.volume_m3() / solid.cylinder_m3();
    // NaN when the profile has no height or no radius at all.
    if fill.is_nan() || fill < LEAST_FILL {
        let problem = "the profile is flat or a thread; move its pairs apart in height and radius";
        return Err(CrownError::Hollow { shape: SHAPE.id, problem: problem.to_owned() });
    }
    Ok(Box::new(solid))
}

/// A smooth curve through the pairs: height and radius are each a monotone cubic (Fritsch & Carlson
/// 1980, *Monotone Piecewise Cubic Interpolation*) of the centripetal parameter (Lee 1989), whose knots
/// lie apart by the square root of the chord. Between two pairs neither leaves the range of their
/// values, so that no radius is below 0.
fn spline(pairs: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = pairs.to_vec();
    kept.dedup();
    let mut knots = vec![0.0];
    for pair in kept.windows(2) {
        let chord = libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        knots.push(knots[knots.len() - 1] + chord.sqrt());
    }
    let slopes = [0, 1].map(|axis| {
        let values: Vec<f64> = kept.iter().map(|pair| pair[axis]).collect();
        monotone_slopes(&knots, &values)
    });
    let mut profile = Vec::with_capacity(kept.len() * PIECES as usize);
    for i in 0..kept.len().saturating_sub(1) {
        let width = knots[i + 1] - knots[i];
        for piece in 0..PIECES {
            let t = f64::from(piece) / f64::from(PIECES);
            profile.push([0, 1].map(|axis| {
                let (a, b) = (kept[i][axis], kept[i + 1][axis]);
                let (s, e) = (slopes[axis][i] * width, slopes[axis][i + 1] * width);
                let value = hermite(a, s, b, e, t);
                // Monotone but for rounding.
                value.clamp(a.min(b), a.max(b))
            }));
        }
    }
    profile.extend(kept.last());
    profile
}

fn hermite(a: f64, slope_a: f64, b: f64, slope_b: f64, t: f64) -> f64 {
    let s = 1.0 - t;
    (1.0 + 2.0 * t) * s * s * a + t * s * s * slope_a + t * t * (3.0 - 2.0 * t) * b - t * t * s * slope_b
}

/// Slopes at the knots that keep each piece monotone: the weighted harmonic mean of the neighbouring
/// chords' (Fritsch & Butland 1984), 0 where these have different signs; at the ends the chord's
/// own, which lies in the region that Fritsch & Carlson prove monotone.
fn monotone_slopes(knots: &[f64], values: &[f64]) -> Vec<f64> {
    let widths: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let chords: Vec<f64> =
        values.windows(2).zip(&widths).map(|(pair, width)| (pair[1] - pair[0]) / width).collect();
    (0..values.len())
        .map(|i| match (i.checked_sub(1).and_then(|before| chords.get(before)), chords.get(i)) {
            (Some(&before), Some(&after)) if before * after > 0.0 => {
                let (w1, w2) = (2.0 * widths[i] + widths[i - 1], widths[i] + 2.0 * widths[i - 1]);
                (w1 + w2) / (w1 / before + w2 / after)
            }
            (Some(_), Some(_)) | (None, None) => 0.0,
            (Some(&only), None) | (None, Some(&only)) => only,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{assert_uniform, volume_by_probes};
    use glam::DVec3;
    use linden_base::random::Key;

    fn of(pairs: &[[f64; 2]], curve: &str) -> Result<Box<dyn Crown>, CrownError> {
        SHAPE.of(&[
            ("profile_points", Value::Profile(pairs.to_vec())),
            ("profile_curve", Value::Word(curve.to_owned())),
        ])
    }

    const BACK_AND_FORTH: [[f64; 2]; 5] = [[0.0, 1.0], [-1.0, 4.0], [5.0, 5.0], [7.0, 2.0], [4.0, 0.0]];

    #[test]
    fn points_are_uniform_in_volume() {
        let nine: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 1.0 + f64::from(i % 3)]).collect();
        for pairs in [&BACK_AND_FORTH[..], &nine, &[[0.0, 5.0], [9.0, 0.0]]] {
            for curve in ["straight", "spline"] {
                let crown = of(pairs, curve).unwrap();
                assert_uniform(&*crown);
                let probed = volume_by_probes(&*crown);
                assert!((probed / crown.volume_m3() - 1.0).abs() < 0.02, "{curve}: {probed}");
            }
        }
    }

    #[test]
    fn a_spline_meets_its_pairs_and_never_overshoots() {
        for i in 0..300 {
            let key = Key::new(3).child(i);
            let pairs: Vec<[f64; 2]> = (0..2 + i % 9)
                .map(|k| [0, 1].map(|axis| (key.child(k).child(axis).between(0.0, 9.0)).round()))
                .collect();
            let profile = spline(&pairs);
            let mut distinct = pairs.clone();
            distinct.dedup();
            for (k, pair) in distinct.iter().enumerate() {
                assert_eq!(profile[k * PIECES as usize], *pair);
            }
            for (k, two) in distinct.windows(2).enumerate() {
                let piece = &profile[k * PIECES as usize..=(k + 1) * PIECES as usize];
                for axis in [0, 1] {
                    let (from, to) = (two[0][axis], two[1][axis]);
                    let rises =
                        |pair: &[[f64; 2]]| (pair[1][axis] - pair[0][axis]) * (to - from).signum() >= -1e-9;
                    assert!(piece.windows(2).all(rises), "{pairs:?}");
                }
            }
        }
    }

    #[test]
    fn a_spline_has_no_corner_where_the_profile_goes_on() {
        let profile = spline(&[[0.0, 0.5], [2.0, 3.0], [5.0, 3.5], [8.0, 0.0]]);
        let turn = |at: usize| {
            let way = |i: usize| {
                DVec3::new(profile[i + 1][0] - profile[i][0], profile[i + 1][1] - profile[i][1], 0.0)
            };
            way(at - 1).normalize().dot(way(at).normalize())
        };
        for knot in 1..3 {
            assert!(turn(knot * PIECES as usize) > 0.98, "{}", turn(knot * PIECES as usize));
        }
    }

    #[test]
    fn what_encloses_nothing_is_refused() {
        for flat in [[[0.0, 1.0], [0.0, 3.0]], [[0.0, 0.0], [5.0, 0.0]], [[2.0, 2.0], [2.0, 2.0]]] {
            for curve in ["straight", "spline"] {
                assert!(matches!(of(&flat, curve), Err(CrownError::Hollow { .. })), "{flat:?}");
            }
        }
        for bad in [[[0.0, -1.0], [3.0, 1.0]], [[0.0, 1.0], [1e300, 1.0]], [[0.0, 1.0], [f64::NAN, 1.0]]] {
            assert!(matches!(of(&bad, "spline"), Err(CrownError::BadValue { .. })), "{bad:?}");
        }
        assert!(
            matches!(of(&[[0.0, 1.0]], "spline"), Err(CrownError::BadValue { .. })),
            "one pair is no profile"
        );
    }
}
