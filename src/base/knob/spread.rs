//! A spread: the distribution that each tree draws a knob's value from.

use std::fmt;
use std::ops::RangeInclusive;

use super::{Kind, Value, excerpt, items};
use crate::random::Key;

/// Values of a normal distribution lie within so many standard deviations of the mean: what lies farther out is drawn
/// again. One draw in 370 is.
pub const MOST_DEVIATIONS: f64 = 3.0;

/// So many draws outside the knob's range, and the mean is taken.
const MOST_DRAWS: u64 = 64;

/// The distribution that a knob's value is drawn from: normal (`4 ± 0.6`, mean and standard deviation) or uniform
/// (`2..5`). In a list of numbers, each may have its own: `45±5 60 50..70`.
///
/// ```
/// use linden_base::knob::{Spread, real};
/// use linden_base::random::Key;
///
/// let spread = Spread::parse(&real(0.0, 10.0), "4 +- 0.6")?;
/// assert_eq!(spread.to_string(), "4 ± 0.6");
/// let key = Key::new(7).named("trunk");
/// assert_eq!(spread.draw(key), spread.draw(key), "the same place, the same value");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    kind: Kind,
    parts: Vec<Part>,
    /// Of ranges whole numbers alone are drawn, though the knob takes others.
    is_whole: bool,
}

/// One number's distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    shape: Shape,
    /// Of lengths: in steps, not metres.
    in_steps: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Fixed(f64),
    Normal { mean: f64, deviation: f64 },
    Uniform { low: f64, high: f64 },
}

/// What stands between mean and deviation; the first is how it is written.
const PLUS_MINUS: [&str; 3] = ["±", "+/-", "+-"];

/// What stands between two ends.
const TO: &str = "..";

impl Spread {
    /// Whether a text has the form of a spread, right or wrong; no value of a number has.
    pub fn is_meant(text: &str) -> bool {
        text.contains(TO) || PLUS_MINUS.iter().any(|sign| text.contains(sign))
    }

    /// Reads a spread for a knob that takes numbers.
    ///
    /// # Errors
    /// What was expected instead, without the knob's name.
    pub fn parse(kind: &Kind, text: &str) -> Result<Self, String> {
        let joined = joined(text);
        let parts = match kind {
            Kind::Real { .. } | Kind::Integer { .. } | Kind::Length { .. } => vec![part(kind, &joined)?],
            Kind::Reals { min, max, most } => {
                let one = super::real(*min, *max);
                let parts: Vec<Part> =
                    items(&joined).map(|item| part(&one, item)).collect::<Result<_, _>>()?;
                if parts.is_empty() || parts.len() > *most {
                    return Err(format!("'{}' is not {kind}", excerpt(text)));
                }
                parts
            }
            _ => {
                return Err(format!(
                    "'{}' is a spread, which numbers alone have; expected {kind}",
                    excerpt(text)
                ));
            }
        };
        Ok(Self { kind: *kind, parts, is_whole: false })
    }

    /// The same; of ranges only whole numbers are drawn, both ends as often as what lies between them.
    #[must_use]
    pub fn of_whole_numbers(self) -> Self {
        Self { is_whole: true, ..self }
    }

    /// The value in the middle: means, and the middles of ranges.
    pub fn middle(&self) -> Value {
        self.value(|_, part| part.shape.middle())
    }

    /// The same spread about another middle, as wide, its ends within the knob's range; `None` for a list, and where the
    /// middle is no number or in another unit.
    ///
    /// ```
    /// use linden_base::knob::{Spread, Value, real};
    /// let about = |text: &str, middle: f64| {
    ///     let spread = Spread::parse(&real(0.0, 10.0), text)?;
    ///     Ok::<_, String>(spread.about(&Value::Real(middle)).map(|moved| moved.to_string()))
    /// };
    /// assert_eq!(about("4 ± 0.6", 4.1)?.as_deref(), Some("4.1 ± 0.6"));
    /// assert_eq!(about("2..5", 3.6)?.as_deref(), Some("2.1..5.1"));
    /// assert_eq!(about("2..5", 9.5)?.as_deref(), Some("8..10"));
    /// # Ok::<(), String>(())
    /// ```
    #[must_use]
    pub fn about(&self, middle: &Value) -> Option<Self> {
        let [part] = &self.parts[..] else { return None };
        let (to, in_steps) = match *middle {
            Value::Real(x) => (x, false),
            Value::Steps(x) => (x, true),
            Value::Integer(n) => (n as f64, false),
            _ => return None,
        };
        let Numbers { range, .. } = self.range();
        let moved = |x: f64, width: f64| {
            rounded(x + to - part.shape.middle(), width).clamp(*range.start(), *range.end())
        };
        let shape = match part.shape {
            Shape::Fixed(_) => Shape::Fixed(to),
            Shape::Normal { deviation, .. } => Shape::Normal { mean: to, deviation },
            Shape::Uniform { low, high } => {
                Shape::Uniform { low: moved(low, high - low), high: moved(high, high - low) }
            }
        };
        let is_empty = matches!(shape, Shape::Uniform { low, high } if low >= high);
        let fits = in_steps == part.in_steps && !matches!(self.kind, Kind::Reals { .. }) && !is_empty;
        fits.then(|| Self { parts: vec![Part { shape, in_steps }], ..*self })
    }

    /// The value drawn at a place: within the knob's range, and rounded to what a spread of its width can tell apart (a
    /// thousandth of it, or less).
    pub fn draw(&self, key: Key) -> Value {
        // One value has the key, values of a list have its children.
        let is_list = matches!(self.kind, Kind::Reals { .. });
        self.value(|i, part| part.draw(if is_list { key.child(i as u64) } else { key }, self.range()))
    }

    /// The value below which a share of all draws lies, with six digits that count, within the knob's range; of a list, by the
    /// share of each number. Draws of strata of shares are a stratified sample of the spread.
    ///
    /// ```
    /// use linden_base::knob::{Spread, real};
    ///
    /// let spread = Spread::parse(&real(0.0, 10.0), "2..5")?;
    /// assert_eq!(spread.quantile(|_| 0.25).to_string(), "2.75");
    /// # Ok::<(), String>(())
    /// ```
    pub fn quantile(&self, share: impl Fn(usize) -> f64) -> Value {
        self.value(|i, part| part.quantile(share(i), &self.range()))
    }

    fn value(&self, mut number: impl FnMut(usize, &Part) -> f64) -> Value {
        let mut numbers = self.parts.iter().enumerate().map(|(i, part)| number(i, part));
        match self.kind {
            Kind::Reals { .. } => Value::Reals(numbers.collect()),
            Kind::Integer { .. } => Value::Integer(numbers.next().unwrap_or(0.0) as u64),
            _ => {
                let x = numbers.next().unwrap_or(0.0);
                if self.parts.first().is_some_and(|part| part.in_steps) {
                    Value::Steps(x)
                } else {
                    Value::Real(x)
                }
            }
        }
    }

    fn range(&self) -> Numbers {
        match self.kind {
            Kind::Integer { min, max } => Numbers { range: min as f64..=max as f64, whole: true },
            Kind::Real { min, max, .. } | Kind::Length { min, max, .. } | Kind::Reals { min, max, .. } => {
                Numbers { range: min..=max, whole: self.is_whole }
            }
            _ => Numbers { range: f64::NEG_INFINITY..=f64::INFINITY, whole: self.is_whole },
        }
    }
}

impl fmt::Display for Spread {
    /// As [`Spread::parse`] reads it back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_list = matches!(self.kind, Kind::Reals { .. });
        for (i, Part { shape, in_steps }) in self.parts.iter().enumerate() {
            let unit = if *in_steps { "D" } else { "" };
            // Blanks separate the items of a list.
            let (gap, blank) = (if i == 0 { "" } else { " " }, if is_list { "" } else { " " });
            match shape {
                Shape::Fixed(x) => write!(f, "{gap}{x}{unit}")?,
                Shape::Normal { mean, deviation } => {
                    write!(f, "{gap}{mean}{unit}{blank}{}{blank}{deviation}{unit}", PLUS_MINUS[0])?;
                }
                Shape::Uniform { low, high } => write!(f, "{gap}{low}{unit}{TO}{high}{unit}")?,
            }
        }
        Ok(())
    }
}

/// What numbers a knob takes.
struct Numbers {
    range: RangeInclusive<f64>,
    whole: bool,
}

impl Part {
    fn draw(&self, key: Key, Numbers { range, whole }: Numbers) -> f64 {
        match self.shape {
            Shape::Fixed(x) => x,
            Shape::Normal { mean, deviation } => {
                let draws = (0..MOST_DRAWS).map(|i| key.child(i).normal());
                let near = draws.filter(|z| z.abs() <= MOST_DEVIATIONS);
                let mut values = near.map(|z| {
                    let x = mean + z * deviation;
                    if whole { x.round() } else { rounded(x, deviation) }
                });
                values.find(|x| range.contains(x) && self.shape.reach().contains(x)).unwrap_or(mean)
            }
            // Both ends of whole numbers are as likely as what lies between them.
            Shape::Uniform { low, high } if whole => key.between(low, high + 1.0).floor().clamp(low, high),
            Shape::Uniform { low, high } => rounded(key.between(low, high), high - low).clamp(low, high),
        }
    }

    fn quantile(&self, share: f64, Numbers { range, whole }: &Numbers) -> f64 {
        let x = match self.shape {
            Shape::Fixed(x) => x,
            Shape::Normal { mean, deviation } => {
                let x = mean + deviation * normal_quantile(share).clamp(-MOST_DEVIATIONS, MOST_DEVIATIONS);
                if *whole { x.round() } else { six_digits(x) }
            }
            Shape::Uniform { low, high } if *whole => (low + (share * (high - low + 1.0)).floor()).min(high),
            Shape::Uniform { low, high } => six_digits(low + share * (high - low)),
        };
        x.clamp(*range.start(), *range.end())
    }
}

impl Shape {
    fn middle(self) -> f64 {
        match self {
            Self::Fixed(x) | Self::Normal { mean: x, .. } => x,
            Self::Uniform { low, high } => low + (high - low) / 2.0,
        }
    }

    /// Where values may lie.
    fn reach(self) -> RangeInclusive<f64> {
        match self {
            Self::Fixed(x) => x..=x,
            Self::Normal { mean, deviation } => {
                mean - MOST_DEVIATIONS * deviation..=mean + MOST_DEVIATIONS * deviation
            }
            Self::Uniform { low, high } => low..=high,
        }
    }
}

/// Without blanks around the signs, which separate items elsewhere.
fn joined(text: &str) -> String {
    let mut joined = text.trim().to_owned();
    for sign in PLUS_MINUS {
        joined = joined.replace(sign, PLUS_MINUS[0]);
    }
    for sign in [PLUS_MINUS[0], TO] {
        joined = joined.split(sign).map(str::trim).collect::<Vec<_>>().join(sign);
    }
    joined
}

fn part(kind: &Kind, text: &str) -> Result<Part, String> {
    let number = |text: &str| -> Result<(f64, bool), String> {
        match kind.parse(text)? {
            Value::Real(x) if x.is_finite() => Ok((x, false)),
            Value::Steps(x) if x.is_finite() => Ok((x, true)),
            Value::Integer(n) => Ok((n as f64, false)),
            _ => Err(format!("'{}' is no number that something can be spread around", excerpt(text))),
        }
    };
    let one_unit = |a: bool, b: bool| {
        let said = format!("'{}' mixes metres and steps; give both numbers in one unit", excerpt(text));
        if a == b { Ok(a) } else { Err(said) }
    };
    if let Some((low, high)) = text.split_once(TO) {
        let ((low, steps), (high, also)) = (number(low)?, number(high)?);
        let in_steps = one_unit(steps, also)?;
        if low >= high {
            return Err(format!("'{}' is empty: the first number must be the smaller one", excerpt(text)));
        }
        return Ok(Part { shape: Shape::Uniform { low, high }, in_steps });
    }
    if let Some((mean, deviation)) = text.split_once(PLUS_MINUS[0]) {
        let (mean, in_steps) = number(mean)?;
        let (deviation, steps) = width(kind, deviation).ok_or_else(|| {
            format!("'{}' has no standard deviation above 0 behind {}", excerpt(text), PLUS_MINUS[0])
        })?;
        // `17D ± 2` can only mean steps.
        one_unit(in_steps, steps || in_steps)?;
        return Ok(Part { shape: Shape::Normal { mean, deviation }, in_steps });
    }
    let (x, in_steps) = number(text)?;
    Ok(Part { shape: Shape::Fixed(x), in_steps })
}

/// A standard deviation, with the unit that the knob's numbers may have, and whether that is steps. It may lie outside of the
/// knob's range, and be a fraction where values are whole.
fn width(kind: &Kind, text: &str) -> Option<(f64, bool)> {
    let (width, in_steps) = match kind {
        Kind::Length { .. } => match kind.read(text)? {
            Value::Real(x) => (x, false),
            Value::Steps(x) => (x, true),
            _ => return None,
        },
        _ => (text.parse().ok()?, false),
    };
    (width.is_finite() && width > 0.0).then_some((width, in_steps))
}

/// A number with so many digits that a thousandth of `width` shows, and no more.
fn rounded(x: f64, width: f64) -> f64 {
    const MOST_DIGITS: usize = 12;
    let mut digits = 3;
    let mut shown = width;
    while shown < 1.0 && digits < MOST_DIGITS {
        shown *= 10.0;
        digits += 1;
    }
    format!("{x:.digits$}").parse().unwrap_or(x)
}

/// A number with six digits that count.
fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// The inverse of the normal distribution between [`MOST_DEVIATIONS`], by bisection of its integral (Abramowitz & Stegun 1964,
/// 7.1.1).
fn normal_quantile(share: f64) -> f64 {
    let below = |z: f64| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
    let (mut low, mut high) = (-MOST_DEVIATIONS, MOST_DEVIATIONS);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if below(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::knob::{integer, real};

    const LENGTH: Kind = Kind::Length { min: 0.0, max: 100.0, auto: true };
    const LIST: Kind = Kind::Reals { min: 0.0, max: 90.0, most: 4 };

    fn root() -> Key {
        Key::new(3).named("spread")
    }

    fn reals(spread: &Spread, count: u64) -> Vec<f64> {
        let number = |value| match value {
            Value::Real(x) | Value::Steps(x) => x,
            Value::Integer(n) => n as f64,
            other => panic!("{other:?}"),
        };
        (0..count).map(|i| number(spread.draw(root().child(i)))).collect()
    }

    #[test]
    fn what_is_shown_is_read_back() {
        for (kind, text, shown) in [
            (real(0.0, 10.0), "4±0.6", "4 ± 0.6"),
            (real(-10.0, 10.0), " -4 +/- 0.6 ", "-4 ± 0.6"),
            (real(-10.0, 10.0), "-4 .. -1", "-4..-1"),
            (integer(1, 9), "2..5", "2..5"),
            (LENGTH, "17D ± 2D", "17D ± 2D"),
            (LENGTH, "17D ± 2", "17D ± 2D"),
            (LENGTH, "17m ± 2m", "17 ± 2"),
            (integer(1, 9), "4 ± 0.5", "4 ± 0.5"),
            (LENGTH, "0.5m..1m", "0.5..1"),
            (LIST, "45 ± 5, 60 50 .. 70", "45±5 60 50..70"),
        ] {
            let spread = Spread::parse(&kind, text).unwrap();
            assert_eq!(spread.to_string(), shown);
            assert_eq!(Spread::parse(&kind, shown), Ok(spread), "{shown}");
            assert!(Spread::is_meant(text) && Spread::is_meant(shown));
        }
    }

    #[test]
    fn faults_are_said() {
        for (kind, text, said) in [
            (real(0.0, 10.0), "4 ± 0", "'4±0' has no standard deviation above 0 behind ±"),
            (real(0.0, 10.0), "4 ± x", "'4±x' has no standard deviation above 0 behind ±"),
            (real(0.0, 90.0), "30 ± 5m", "'30±5m' has no standard deviation above 0 behind ±"),
            (real(0.0, 90.0), "30 ± 5D", "'30±5D' has no standard deviation above 0 behind ±"),
            (LENGTH, "1 ± 5mm", "'1±5mm' has no standard deviation above 0 behind ±"),
            (LENGTH, "1D ± 5Dm", "'1D±5Dm' has no standard deviation above 0 behind ±"),
            (LENGTH, "1 ± auto", "'1±auto' has no standard deviation above 0 behind ±"),
            (real(0.0, 10.0), "11 ± 1", "11 is outside the range: 0 to 10"),
            (real(0.0, 10.0), "5..2", "'5..2' is empty: the first number must be the smaller one"),
            (real(0.0, 10.0), "2..50", "50 is outside the range: 0 to 10"),
            (LENGTH, "2..5D", "'2..5D' mixes metres and steps; give both numbers in one unit"),
            (LENGTH, "2 ± 1D", "'2±1D' mixes metres and steps; give both numbers in one unit"),
            (LENGTH, "auto..5", "'auto' is no number that something can be spread around"),
            (Kind::Switch, "1..2", "'1..2' is a spread, which numbers alone have; expected true | false"),
        ] {
            assert_eq!(Spread::parse(&kind, text).unwrap_err(), said);
        }
        assert!(Spread::parse(&LIST, "1±1 2 3 4 5").is_err(), "too many");
    }

    #[test]
    fn a_normal_spread_has_its_mean_and_deviation() {
        let spread = Spread::parse(&real(0.0, 10.0), "4 ± 0.6").unwrap();
        let drawn = reals(&spread, 20_000);
        let mean = drawn.iter().sum::<f64>() / 20_000.0;
        let deviation = (drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 20_000.0).sqrt();
        // Cut at three deviations, a normal distribution keeps 0.9866 of its own.
        assert!((mean - 4.0).abs() < 0.015, "{mean}");
        assert!((deviation / 0.6 - 0.9866).abs() < 0.015, "{deviation}");
        assert!(drawn.iter().all(|x| (x - 4.0).abs() <= 1.8));
    }

    #[test]
    fn a_uniform_spread_is_even_and_reaches_both_ends() {
        let whole = reals(&Spread::parse(&integer(0, 9), "2..5").unwrap(), 8000);
        for n in 2..=5 {
            let share = whole.iter().filter(|x| **x == f64::from(n)).count();
            assert!((1850..2150).contains(&share), "{n}: {share}");
        }
        let drawn = reals(&Spread::parse(&LENGTH, "1D..3D").unwrap(), 8000);
        let low = drawn.iter().filter(|x| **x < 2.0).count();
        assert!((3800..4200).contains(&low) && drawn.iter().all(|x| (1.0..=3.0).contains(x)), "{low}");
    }

    #[test]
    fn quantiles_are_those_of_the_distribution() {
        let of = |kind: &Kind, text: &str, share: f64| {
            Spread::parse(kind, text).unwrap().quantile(|_| share).to_string()
        };
        let any = real(-100.0, 100.0);
        // The normal distribution's table: 0.8413 of it is below one deviation.
        let normal = [0.0, 0.158_655, 0.5, 0.841_345, 1.0].map(|share| of(&any, "10 ± 2", share));
        assert_eq!(normal, ["4", "8", "10", "12", "16"]);
        assert_eq!([0.0, 0.5, 0.75, 1.0].map(|share| of(&any, "-4..4", share)), ["-4", "0", "2", "4"]);
        assert_eq!(of(&LENGTH, "1D..3D", 0.25), "1.5D");
        assert_eq!(of(&LENGTH, "0.5m..1m", 0.5), "0.75");
        // Whole where the knob is, or where it is asked for; within the knob's range.
        assert_eq!(
            [0.0, 0.3, 0.99, 1.0].map(|share| of(&integer(1, 9), "2..4", share)),
            ["2", "2", "4", "4"]
        );
        assert_eq!(of(&integer(1, 9), "4 ± 2.2", 0.6), "5");
        assert_eq!(of(&integer(3, 9), "4 ± 2", 0.0), "3");
        let whole = Spread::parse(&any, "-4..-1").unwrap().of_whole_numbers();
        assert_eq!(
            [0.0, 0.24, 0.26, 1.0].map(|share| whole.quantile(|_| share).to_string()),
            ["-4", "-4", "-3", "-1"]
        );
        // Numbers of a list have a share each.
        let list = Spread::parse(&LIST, "50..70 60 10..20").unwrap();
        assert_eq!(list.quantile(|i| if i == 0 { 0.25 } else { 0.5 }).to_string(), "55 60 15");
    }

    #[test]
    fn nothing_is_drawn_outside_the_range() {
        let spread = Spread::parse(&real(0.0, 1.0), "0.05 ± 0.4").unwrap();
        assert!(reals(&spread, 4000).iter().all(|x| (0.0..=1.0).contains(x)));
        let Value::Reals(list) = Spread::parse(&LIST, "45±5 60 50..70").unwrap().draw(root()) else {
            panic!()
        };
        assert!(list.len() == 3 && list[1] == 60.0 && (50.0..=70.0).contains(&list[2]));
    }

    #[test]
    fn draws_have_no_more_digits_than_show() {
        for (text, most) in [("4 ± 0.6", 4), ("4000 ± 600", 3), ("0.01 ± 0.002", 6)] {
            for x in reals(&Spread::parse(&real(0.0, 1e4), text).unwrap(), 50) {
                let digits = x.to_string().split_once('.').map_or(0, |(_, fraction)| fraction.len());
                assert!(digits <= most, "{x}");
            }
        }
    }
}
