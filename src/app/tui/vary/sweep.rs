//! What a gallery shows of a knob: the seeds from here on, the words of a choice, round numbers around
//! the one that is set.

use linden::knob::{Kind, Knob, Value};

/// The knob whose values follow each other without end.
pub const SEED: &str = "seed";
/// How far a sweep reaches: from the value divided by this to the value times this.
pub const SPREADS: [f64; 8] = [1.05, 1.1, 1.25, 1.5, 2.0, 4.0, 10.0, 100.0];
/// The spread that a sweep begins with: from half to double.
pub const USUAL_SPREAD: usize = 4;
/// The fewest values of a sweep, page by page where fewer fit.
const FEWEST: usize = 3;
/// Whole numbers below this are counted, not multiplied: 1 2 3 4 5 6 7 8, not 3 4 5 6 8 10.
const COUNTED_BELOW: u64 = 16;

/// Values in order, of which a page is on screen.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueSeries {
    /// Every seed.
    Seeds,
    /// These; not empty.
    Listed(Vec<Value>),
}

impl ValueSeries {
    /// What a gallery shows of a knob; `most` is how many pictures there is room for.
    ///
    /// # Errors
    /// Why there is nothing to go through, for the user.
    pub fn of(knob: &Knob, current: &Value, spread: usize, most: usize) -> Result<Self, String> {
        let name = knob.name;
        let most = most.max(FEWEST);
        let factor = SPREADS.get(spread).copied().unwrap_or(SPREADS[USUAL_SPREAD]);
        let listed = match (knob.kind, current) {
            (Kind::Integer { .. }, Value::Integer(_)) if name == SEED => return Ok(Self::Seeds),
            (Kind::Integer { min, max }, &Value::Integer(n)) => {
                whole(n, (min, max), factor, most).into_iter().map(Value::Integer).collect()
            }
            (Kind::Real { min, max, .. } | Kind::Length { min, max, .. }, &Value::Real(x))
                if x.is_finite() =>
            {
                real(x, (min, max), factor, most).into_iter().map(Value::Real).collect()
            }
            (Kind::Length { min, max, .. }, &Value::Steps(x)) if x.is_finite() => {
                real(x, (min, max), factor, most).into_iter().map(Value::Steps).collect()
            }
            (Kind::Choice(words), _) => words.iter().map(|word| Value::Word((*word).to_owned())).collect(),
            (Kind::Switch, _) => vec![Value::Switch(false), Value::Switch(true)],
            (_, Value::Auto) => {
                return Err(format!(
                    "{name} is auto: type a number, and a sweep goes from half to double of it"
                ));
            }
            (Kind::Real { .. } | Kind::Length { .. }, _) => {
                return Err(format!("{name} is {current}: type a number to sweep around"));
            }
            _ => {
                return Err(format!(
                    "{name} is more than one number; numbers, choices and switches can be swept"
                ));
            }
        };
        Ok(Self::Listed(listed))
    }

    /// The place of the last value.
    pub fn last(&self) -> u64 {
        match self {
            Self::Seeds => u64::MAX,
            Self::Listed(values) => (values.len() as u64).saturating_sub(1),
        }
    }

    /// The value at a place.
    pub fn at(&self, place: u64) -> Option<Value> {
        match self {
            Self::Seeds => Some(Value::Integer(place)),
            Self::Listed(values) => values.get(usize::try_from(place).ok()?).cloned(),
        }
    }

    /// The place of a value.
    pub fn place(&self, value: &Value) -> Option<u64> {
        match (self, value) {
            (Self::Seeds, Value::Integer(seed)) => Some(*seed),
            (Self::Seeds, _) => None,
            (Self::Listed(values), _) => values.iter().position(|other| other == value).map(|at| at as u64),
        }
    }
}

/// Whole numbers around one of them, at most `most`.
fn whole(n: u64, (min, max): (u64, u64), factor: f64, most: usize) -> Vec<u64> {
    let (low, high) = if n < COUNTED_BELOW {
        let reach = (1.5 * factor).round() as u64;
        (n.saturating_sub(reach), n.saturating_add(reach))
    } else {
        ((n as f64 / factor).round() as u64, (n as f64 * factor).round() as u64)
    };
    let (low, high) = (low.clamp(min, n), high.clamp(n, max));
    if high - low < most as u64 {
        return (low..=high).collect();
    }
    let values = around(n as f64, (low as f64, high as f64), (min as f64, max as f64), most, 1.0);
    let mut values: Vec<u64> = values.into_iter().map(|x| x as u64).collect();
    // Beyond 2⁵³ a detour by way of `f64` loses digits.
    if let Some(nearest) = values.iter_mut().min_by_key(|x| x.abs_diff(n)) {
        *nearest = n;
    }
    values
}

/// Numbers around one of them, at most `most`.
fn real(x: f64, (min, max): (f64, f64), factor: f64, most: usize) -> Vec<f64> {
    let (low, high) = if x == 0.0 {
        // Nothing can be multiplied: a part of the range, or of one.
        let usual = if max - min < f64::INFINITY { ((max - min) / 20.0).min(1.0) } else { 1.0 };
        (-usual * factor / 2.0, usual * factor / 2.0)
    } else {
        ((x / factor).min(x * factor), (x / factor).max(x * factor))
    };
    around(x, (low.clamp(min, x), high.clamp(x, max)), (min, max), most, 0.0)
}

/// At most `most` numbers from about `low` to about `high`, rising and within the range, `x` exactly
/// among them and the others round: in equal ratios where the sign allows it, else in equal steps.
/// They are multiples of at least `least`.
fn around(x: f64, (low, high): (f64, f64), range: (f64, f64), most: usize, least: f64) -> Vec<f64> {
    let others = most.saturating_sub(1);
    let below = match (low < x, x < high) {
        (true, true) => others / 2,
        (true, false) => others,
        (false, _) => 0,
    };
    let above = if x < high { others - below } else { 0 };
    let mut values: Vec<f64> = outwards(x, low, range, below, least);
    values.reverse();
    values.push(x);
    values.extend(outwards(x, high, range, above, least));
    values
}

/// At most `count` round numbers from `x` (left out) to `end`, ever farther from `x`.
fn outwards(x: f64, end: f64, (min, max): (f64, f64), count: usize, least: f64) -> Vec<f64> {
    let exact = |step: usize| {
        let share = step as f64 / count as f64;
        if x * end > 0.0 { x * libm::pow(end / x, share) } else { x + (end - x) * share }
    };
    let mut values: Vec<f64> = Vec::with_capacity(count);
    for step in 1..=count {
        let (before, here) = (exact(step - 1), exact(step));
        // Nearer to itself than to its neighbours, and to zero.
        let tolerance = ((here - before).abs().min(here.abs()) / 4.0).max(least / 2.0);
        let rounded = roundest(here, tolerance).clamp(min, max);
        let last = values.last().copied().unwrap_or(x);
        if (rounded - x).abs() > (last - x).abs() {
            values.push(rounded);
        }
    }
    values
}

/// The roundest number near another one: a multiple of 5, 2 or 1 times the highest power of ten that
/// has one there.
fn roundest(x: f64, tolerance: f64) -> f64 {
    if !(tolerance > 0.0 && tolerance.is_finite()) || x == 0.0 {
        return x;
    }
    let top = libm::floor(libm::log10(x.abs())) as i32 + 1;
    for exponent in (top - 16..=top).rev() {
        for lead in [5.0, 2.0, 1.0] {
            let step = lead * libm::pow(10.0, f64::from(exponent));
            let round = (x / step).round() * step;
            if (round - x).abs() <= tolerance {
                // By way of the text, so that 3 × 0.1 is 0.3.
                let digits = exponent.min(0).unsigned_abs() as usize;
                return format!("{round:.digits$}").parse().unwrap_or(round);
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(knob: &Knob, current: &Value, spread: usize, most: usize) -> String {
        match ValueSeries::of(knob, current, spread, most) {
            Ok(ValueSeries::Seeds) => "seeds".to_owned(),
            Ok(ValueSeries::Listed(values)) => {
                values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
            }
            Err(why) => why,
        }
    }

    fn knob(kind: Kind) -> Knob {
        Knob::new("k", kind, "", "")
    }

    #[test]
    fn sweeps_of_every_knob_of_every_preset_rise_within_the_range_and_hold_what_is_set() {
        let mut swept = 0;
        // Most presets leave most knobs where they are: each value of each knob once.
        let mut seen = std::collections::BTreeSet::new();
        for builtin in linden::preset::builtins() {
            let preset = builtin.load().unwrap();
            for (row, current) in preset.knobs() {
                if !seen.insert((row.knob.name, current.to_string())) {
                    continue;
                }
                for most in [1, 4, 12, 24] {
                    for spread in 0..SPREADS.len() {
                        let name = row.knob.name;
                        let Ok(series) = ValueSeries::of(&row.knob, &current, spread, most) else {
                            assert!(
                                matches!(
                                    current,
                                    Value::Auto
                                        | Value::Vector(_)
                                        | Value::Profile(_)
                                        | Value::Color(_)
                                        | Value::Reals(_)
                                        | Value::Words(_)
                                        | Value::Colors(_)
                                ) || current == Value::Real(f64::INFINITY),
                                "{} {name} = {current}",
                                builtin.id
                            );
                            continue;
                        };
                        let ValueSeries::Listed(values) = &series else {
                            assert_eq!(name, SEED);
                            continue;
                        };
                        swept += 1;
                        assert_eq!(values.iter().filter(|value| **value == current).count(), 1, "{name}");
                        assert_eq!(series.at(series.place(&current).unwrap()), Some(current.clone()));
                        let is_number = !matches!(current, Value::Word(_) | Value::Switch(_));
                        assert!(!is_number || values.len() <= most.max(FEWEST), "{name} {values:?}");
                        assert!(values.len() > 1, "{} {name} = {current}", builtin.id);
                        let number = |value: &Value| match value {
                            Value::Real(x) | Value::Steps(x) => *x,
                            Value::Integer(n) => *n as f64,
                            _ => f64::NAN,
                        };
                        for pair in values.windows(2) {
                            assert!(!is_number || number(&pair[0]) < number(&pair[1]), "{name} {values:?}");
                        }
                        for value in values {
                            let mut turned = preset.clone();
                            turned.set(name, &value.to_string()).unwrap_or_else(|e| panic!("{e}"));
                            assert_eq!(row.read(&turned).as_ref(), Some(value), "{name}");
                            let text = value.to_string();
                            assert!(text.len() <= 10 || *value == current || !is_number, "{name} {text}");
                        }
                    }
                }
            }
        }
        assert!(swept > 1000);
    }

    #[test]
    fn numbers_are_round() {
        let length = knob(Kind::Length { min: 0.0, max: f64::INFINITY, auto: true });
        assert_eq!(words(&length, &Value::Steps(2.0), USUAL_SPREAD, 5), "1D 1.5D 2D 3D 4D");
        let angle = knob(Kind::Real { min: -360.0, max: 360.0, auto: false, names: &[] });
        assert_eq!(words(&angle, &Value::Real(25.7), USUAL_SPREAD, 5), "12 20 25.7 35 50");
        assert_eq!(words(&angle, &Value::Real(-20.0), USUAL_SPREAD, 5), "-40 -30 -20 -15 -10");
        assert_eq!(words(&angle, &Value::Real(0.0), USUAL_SPREAD, 5), "-1 -0.5 0 0.5 1");
        assert_eq!(words(&angle, &Value::Real(300.0), USUAL_SPREAD, 5), "150 200 300 330 360");
        let steps = knob(Kind::Integer { min: 0, max: 10_000 });
        assert_eq!(words(&steps, &Value::Integer(5), USUAL_SPREAD, 8), "2 3 4 5 6 7 8");
        assert_eq!(words(&steps, &Value::Integer(0), USUAL_SPREAD, 8), "0 1 2 3");
        assert_eq!(words(&steps, &Value::Integer(400), USUAL_SPREAD, 5), "200 300 400 600 800");
    }

    #[test]
    fn a_range_ends_where_the_knob_ends() {
        let grain = knob(Kind::Real { min: 0.0, max: 3.0, auto: false, names: &[] });
        assert_eq!(words(&grain, &Value::Real(3.0), USUAL_SPREAD, 5), "1.5 1.8 2.2 2.5 3");
        let huge = knob(Kind::Integer { min: 0, max: u64::MAX });
        let Ok(ValueSeries::Listed(values)) = ValueSeries::of(&huge, &Value::Integer(u64::MAX), 7, 8) else {
            panic!()
        };
        assert_eq!(values.last(), Some(&Value::Integer(u64::MAX)));
    }

    #[test]
    fn what_cannot_be_swept_says_why() {
        let kind = Kind::Length { min: 0.0, max: f64::INFINITY, auto: true };
        assert!(words(&knob(kind), &Value::Auto, 4, 8).contains("k is auto: type a number"));
        assert!(words(&knob(kind), &Value::Real(f64::INFINITY), 4, 8).contains("k is inf"));
        let vector = Kind::Vector { auto: false };
        assert!(words(&knob(vector), &Value::Vector([0.0; 3]), 4, 8).contains("more than one number"));
    }
}
