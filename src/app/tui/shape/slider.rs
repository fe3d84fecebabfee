//! The scale on which a knob's value is drawn between the ends of its range.

use linden::knob::{Kind, Value};

/// The range of a knob, and how it is spread over a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub low: f64,
    pub high: f64,
    spread: Spread,
}

/// What is as far apart on a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spread {
    /// Equal differences.
    Even,
    /// Equal ratios.
    Decades,
    /// The exponent of a share of the range, which brings small values away from the lower end.
    Power(f64),
    /// Equal ratios of what is one more, which zero has a place among.
    Counts,
}

/// From this ratio of its ends on a range is drawn by decades.
const DECADES: f64 = 100.0;

/// A usual value nearer to the lower end than this share of the range is drawn in the middle.
const CROWDED: f64 = 0.1;

impl Scale {
    /// Of a knob that `usual` is a common value of, as that of the saved preset; `None` where its range has no end.
    pub fn new(kind: &Kind, usual: Option<&Value>) -> Option<Self> {
        let (low, high) = match *kind {
            Kind::Real { min, max, .. } | Kind::Length { min, max, .. } => (min, max),
            // A number without a range is a name, not an amount: the seed.
            Kind::Integer { min, max } if max < u64::MAX => (min as f64, max as f64),
            _ => return None,
        };
        let is_range = low.is_finite() && high.is_finite() && high > low;
        let spread = if low > 0.0 && high / low >= DECADES {
            Spread::Decades
        } else {
            let share = usual.and_then(number).map_or(1.0, |usual| (usual - low) / (high - low));
            if low >= 0.0 && share > 0.0 && share < CROWDED {
                Spread::Power(libm::log(0.5) / libm::log(share))
            } else if low == 0.0 && share == 0.0 && high >= DECADES {
                Spread::Counts
            } else {
                Spread::Even
            }
        };
        is_range.then_some(Self { low, high, spread })
    }

    /// How far along the bar a value stands, 0 to 1; `None` of what is no number.
    pub fn share(&self, value: &Value) -> Option<f64> {
        let even = |x: f64| ((x - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        let x = number(value)?;
        Some(match self.spread {
            Spread::Even => even(x),
            Spread::Decades => (libm::log(x / self.low) / libm::log(self.high / self.low)).clamp(0.0, 1.0),
            Spread::Power(exponent) => libm::pow(even(x), exponent),
            Spread::Counts => (libm::log1p(x.max(0.0)) / libm::log1p(self.high)).clamp(0.0, 1.0),
        })
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Real(x) => Some(*x),
        Value::Integer(n) => Some(*n as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(low: f64, high: f64, usual: Option<f64>, at: f64) -> f64 {
        let kind = Kind::Real { min: low, max: high, auto: false, names: &[] };
        let usual = usual.map(Value::Real);
        Scale::new(&kind, usual.as_ref()).unwrap().share(&Value::Real(at)).unwrap()
    }

    #[test]
    fn wide_ranges_are_drawn_by_decades() {
        let points = Kind::Integer { min: 1, max: 100_000_000 };
        let scale = Scale::new(&points, Some(&Value::Integer(1040))).unwrap();
        let shares =
            [1, 100, 10_000, 1_000_000, 100_000_000].map(|n| scale.share(&Value::Integer(n)).unwrap());
        for (found, expected) in shares.into_iter().zip([0.0, 0.25, 0.5, 0.75, 1.0]) {
            assert!((found - expected).abs() < 1e-9, "{shares:?}");
        }
        // Thirty-six years of a thousand, four more, and a tenth of a metre of ten are told apart.
        assert!(share(1.0, 1000.0, None, 36.0) > 0.5);
        assert!((0.4..0.7).contains(&share(0.001, 10.0, None, 0.263)));
    }

    #[test]
    fn from_zero_the_usual_value_is_in_the_middle() {
        assert!((share(0.0, 1000.0, Some(2.0), 2.0) - 0.5).abs() < 1e-9);
        assert!(
            share(0.0, 1000.0, Some(2.0), 0.0) < 1e-9
                && (share(0.0, 1000.0, Some(2.0), 1000.0) - 1.0).abs() < 1e-9
        );
        assert!(share(0.0, 1000.0, Some(2.0), 3.0) > 0.52, "half more is seen");
    }

    #[test]
    fn where_zero_is_usual_a_wide_range_is_drawn_by_decades_too() {
        let triangles = u32::MAX.into();
        assert!(share(0.0, triangles, Some(0.0), 0.0) < 1e-9);
        assert!((0.4..0.6).contains(&share(0.0, triangles, Some(0.0), 50_000.0)));
        assert!((share(0.0, 1.0, Some(0.0), 0.25) - 0.25).abs() < 1e-9, "a share is a share");
    }

    #[test]
    fn shares_and_angles_are_drawn_evenly() {
        assert!((share(0.0, 1.0, Some(0.3), 0.25) - 0.25).abs() < 1e-9);
        assert!((share(-180.0, 180.0, Some(-170.0), 0.0) - 0.5).abs() < 1e-9);
        assert!((share(0.0, 1.0, None, 0.02) - 0.02).abs() < 1e-9);
    }

    #[test]
    fn what_has_no_end_and_no_number_has_no_place() {
        assert_eq!(Scale::new(&Kind::Integer { min: 0, max: u64::MAX }, None), None);
        assert_eq!(Scale::new(&Kind::Length { min: 0.0, max: f64::INFINITY, auto: true }, None), None);
        assert_eq!(Scale::new(&Kind::Switch, None), None);
        let scale = Scale::new(&Kind::Length { min: 0.0, max: 10.0, auto: true }, None).unwrap();
        assert_eq!(scale.share(&Value::Auto), None);
    }
}
