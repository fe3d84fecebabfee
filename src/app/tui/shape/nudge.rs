//! Nudges: how far a key turns a knob.

use linden::knob::{Kind, Value};

/// How far a key nudges a knob.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nudge {
    /// Alt: a tenth of the usual.
    Fine,
    /// The usual.
    Usual,
    /// Shift: ten times the usual.
    Coarse,
}

impl Nudge {
    const fn factor(self) -> f64 {
        match self {
            Self::Fine => 0.1,
            Self::Usual => 1.0,
            Self::Coarse => 10.0,
        }
    }
}

/// The value one nudge up or down from here, as [`linden::preset::Preset::set`] reads it; `None` where
/// there is no such thing (a list of numbers has to be typed).
///
/// Numbers move by 1 to 3 % of themselves on round numbers, within their range: 0.02 m and 20 000
/// points are both some forty keys away from their double, and four with Shift. Whole numbers move by
/// one at least.
pub fn nudged(kind: &Kind, value: &Value, up: bool, nudge: Nudge) -> Option<String> {
    let value = match (kind, value) {
        (Kind::Real { min, max, .. }, Value::Real(x)) => Value::Real(real(*x, [*min, *max], up, nudge)),
        (Kind::Length { min, max, .. }, Value::Real(x)) if x.is_finite() => {
            Value::Real(real(*x, [*min, *max], up, nudge))
        }
        (Kind::Length { min, max, .. }, Value::Steps(x)) if x.is_finite() => {
            Value::Steps(real(*x, [*min, *max], up, nudge))
        }
        (Kind::Integer { min, max }, Value::Integer(n)) => {
            Value::Integer(whole(*n, *max, up, nudge).clamp(*min, *max))
        }
        (Kind::Choice(words), Value::Word(word)) => {
            let at = words.iter().position(|w| w == word)?;
            let next = if up { at + 1 } else { at + words.len() - 1 };
            Value::Word(words[next % words.len()].to_owned())
        }
        (Kind::Switch, Value::Switch(on)) => Value::Switch(!on),
        _ => return None,
    };
    Some(value.to_string())
}

fn real(x: f64, [min, max]: [f64; 2], up: bool, nudge: Nudge) -> f64 {
    let step = round_step(scale(x, min, max)) * nudge.factor();
    let sign = if up { 1.0 } else { -1.0 };
    // On the grid of the step, so that 0.1 + 0.2 stays 0.3.
    let moved = (x / step + sign).round() * step;
    // As many digits as the step has: products of floats have a tail.
    let digits = (-libm::floor(libm::log10(step))).max(0.0) + 1.0;
    format!("{moved:.*}", digits as usize).parse().unwrap_or(moved).clamp(min, max)
}

fn whole(n: u64, max: u64, up: bool, nudge: Nudge) -> u64 {
    let step = match nudge {
        // A number without a range is a name, not an amount: the seed.
        Nudge::Fine | Nudge::Usual if max == u64::MAX => 1,
        Nudge::Coarse if max == u64::MAX => 10,
        Nudge::Coarse => ((round_step(n as f64) * 10.0) as u64).max(2),
        Nudge::Fine | Nudge::Usual => ((round_step(n as f64) * nudge.factor()) as u64).max(1),
    };
    let n =
        if max == u64::MAX || step < 10 { n } else { n / step * step + (n % step + step / 2) / step * step };
    if up { n.saturating_add(step) } else { n.saturating_sub(step) }
}

/// How large a number counts as: as it is, but zero can be left, reached and passed.
fn scale(x: f64, min: f64, max: f64) -> f64 {
    let range = max - min;
    let least = if min < 0.0 {
        // An angle goes through zero in steps that can be seen.
        (range / 100.0).min(10.0)
    } else if x == 0.0 {
        (range / 20.0).min(1.0)
    } else {
        (range / 1000.0).min(0.01)
    };
    x.abs().max(least)
}

/// 1, 2 or 5 times a power of ten: 1 to 3 % of a number above zero.
fn round_step(x: f64) -> f64 {
    let about = x.max(f64::MIN_POSITIVE) * 0.03;
    let power = libm::pow(10.0, libm::floor(libm::log10(about)));
    let lead = about / power;
    power
        * if lead >= 5.0 {
            5.0
        } else if lead >= 2.0 {
            2.0
        } else {
            1.0
        }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_of_every_preset_can_be_nudged_and_stays_in_its_range() {
        for builtin in linden::preset::builtins() {
            let preset = builtin.load().unwrap();
            for (row, value) in preset.knobs() {
                for up in [true, false] {
                    for nudge in [Nudge::Fine, Nudge::Usual, Nudge::Coarse] {
                        let mut text = value.to_string();
                        for _ in 0..40 {
                            let value = row.knob.kind.parse(&text).unwrap();
                            let Some(next) = nudged(&row.knob.kind, &value, up, nudge) else { break };
                            assert!(
                                row.knob.kind.parse(&next).is_ok(),
                                "{} {}: {next}",
                                builtin.id,
                                row.knob.name
                            );
                            let has_digits = next.contains(|c: char| c.is_ascii_digit());
                            assert!(!has_digits || next.len() < 14, "{} {text} -> {next}", row.knob.name);
                            text = next;
                        }
                    }
                }
            }
        }
    }

    /// What the keys do to the knobs that people turn most: down, up; fine, usual, coarse.
    #[test]
    fn nudges_feel_right() {
        let kind = |preset: &str, name: &str| {
            let preset = linden::preset::builtin(preset).unwrap().load().unwrap();
            preset.knobs().into_iter().find(|(row, _)| row.knob.name == name).unwrap().0.knob.kind
        };
        #[rustfmt::skip]
        let table = [
            ("abop-a", "angle", "25.7", ["25.65", "25.75", "25", "26", "20", "30"]),
            ("abop-a", "angle", "0", ["-0.02", "0.02", "-0.2", "0.2", "-2", "2"]),
            ("abop-a", "derivations", "5", ["4", "6", "4", "6", "3", "7"]),
            ("abop-a", "segment_length", "0.02", ["0.01995", "0.02005", "0.0195", "0.0205", "0.015", "0.025"]),
            ("abop-a", "symbol_limit", "50000000", ["49900000", "50100000", "49000000", "51000000", "40000000", "60000000"]),
            ("fir", "seed", "1", ["0", "2", "0", "2", "0", "11"]),
            ("fir", "seed", "123456", ["123455", "123457", "123455", "123457", "123446", "123466"]),
            ("fir", "points", "20000", ["19950", "20050", "19500", "20500", "15000", "25000"]),
            ("fir", "points", "1", ["1", "2", "1", "2", "1", "3"]),
            ("fir", "step", "0.05", ["0.0499", "0.0501", "0.049", "0.051", "0.04", "0.06"]),
            ("fir", "kill", "2D", ["1.995D", "2.005D", "1.95D", "2.05D", "1.5D", "2.5D"]),
            ("fir", "kill", "0.1", ["0.0998", "0.1002", "0.098", "0.102", "0.08", "0.12"]),
            ("fir", "trunk", "0", ["0", "0.002", "0", "0.02", "0", "0.2"]),
            ("fir", "radius_exponent", "2", ["1.995", "2.005", "1.95", "2.05", "1.5", "2.5"]),
            ("fir", "bark_relief", "0.02", ["0.01995", "0.02005", "0.0195", "0.0205", "0.015", "0.025"]),
            ("fir", "sides", "8", ["7", "9", "7", "9", "6", "10"]),
            ("fir", "bark_size", "512", ["511", "513", "500", "520", "400", "600"]),
        ];
        let both = |nudge| [(false, nudge), (true, nudge)];
        for (preset, name, from, expected) in table {
            let kind = kind(preset, name);
            let value = kind.parse(from).unwrap();
            let nudges = [Nudge::Fine, Nudge::Usual, Nudge::Coarse].into_iter().flat_map(both);
            let found: Vec<_> = nudges.map(|(up, nudge)| nudged(&kind, &value, up, nudge).unwrap()).collect();
            assert_eq!(found, expected, "{name} {from}");
        }
    }

    #[test]
    fn words_and_switches_go_round_and_lists_are_typed() {
        let kind = Kind::Choice(&["a", "b", "c"]);
        let next = |word: &str, up| nudged(&kind, &Value::Word(word.to_owned()), up, Nudge::Usual).unwrap();
        assert_eq!((next("c", true), next("a", false)), ("a".to_owned(), "c".to_owned()));
        assert_eq!(nudged(&Kind::Switch, &Value::Switch(true), false, Nudge::Fine).unwrap(), "false");
        let kind = Kind::Vector { auto: true };
        assert_eq!(nudged(&kind, &Value::Vector([0.0; 3]), true, Nudge::Usual), None);
        let kind = Kind::Length { min: 0.0, max: f64::INFINITY, auto: true };
        assert_eq!(nudged(&kind, &Value::Real(f64::INFINITY), true, Nudge::Usual), None);
        assert_eq!(nudged(&kind, &Value::Auto, true, Nudge::Usual), None);
    }

    #[test]
    fn what_goes_up_comes_down() {
        let kind = Kind::Real { min: 0.0, max: 1e6, auto: false, names: &[] };
        for from in ["26", "0.0205", "3000", "0.3"] {
            let up = nudged(&kind, &kind.parse(from).unwrap(), true, Nudge::Usual).unwrap();
            assert_eq!(nudged(&kind, &kind.parse(&up).unwrap(), false, Nudge::Usual).unwrap(), from);
        }
    }
}
