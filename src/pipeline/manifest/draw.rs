//! Values that are drawn: which texts are spreads, and the strata of Latin hypercubes.

use linden_base::knob::{Kind, Spread, real};
use linden_base::random::Key;

use crate::preset::knob_named;

/// Of what kind a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// A knob with this name.
    Knob,
    /// A constant of a grammar.
    Constant,
}

/// The spread that a text is for a knob or a constant, read as presets and `--set` read it, but that of two plain whole numbers
/// (`2..4`) whole ones are drawn; `None` where it is none, as paths with two points.
pub(super) fn spread(of: Of, name: &str, text: &str) -> Option<Result<Spread, String>> {
    if !Spread::is_meant(text) {
        return None;
    }
    let kind = knob_named(name).filter(|_| of == Of::Knob).map(|knob| knob.kind);
    let spread = match kind {
        Some(Kind::Real { .. } | Kind::Integer { .. } | Kind::Length { .. } | Kind::Reals { .. }) => {
            Spread::parse(&kind?, text)
        }
        // Of constants, and of knobs that a preset itself has, only the preset knows the range.
        None if is_of_numbers(text) => Spread::parse(&real(f64::NEG_INFINITY, f64::INFINITY), text),
        // Words, and paths with two points.
        Some(_) | None => return None,
    };
    let of_whole_numbers = |spread: Spread| if is_whole(text) { spread.of_whole_numbers() } else { spread };
    Some(spread.map(of_whole_numbers))
}

/// Whether both sides of a sign are plain numbers.
fn is_of_numbers(text: &str) -> bool {
    let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
    let sides = ["±", "+/-", "+-", ".."].iter().find_map(|sign| text.split_once(sign));
    sides.is_some_and(|(a, b)| is_number(a) && is_number(b))
}

/// Whether a text is a range from one whole number to another, written without point, exponent and unit.
fn is_whole(text: &str) -> bool {
    let is_whole = |text: &str| text.trim().parse::<i128>().is_ok();
    text.split_once("..").is_some_and(|(a, b)| is_whole(a) && is_whole(b))
}

/// The share of the `sample`-th of `samples` in one dimension of a Latin hypercube.
pub(super) fn stratum(key: Key, sample: u64, samples: u64) -> f64 {
    let rank = permuted(key, sample, samples);
    (rank as f64 + key.named("within").child(sample).unit()) / samples as f64
}

/// Where a permutation of `0..count` puts `index`: a Feistel network on as many bits as `count` needs, walked until it
/// stays within (Black & Rogaway 2002, *Ciphers with arbitrary finite domains*, cycle walking). No list is needed.
fn permuted(key: Key, mut index: u64, count: u64) -> u64 {
    const ROUNDS: u64 = 4;
    let half = (u64::BITS - count.leading_zeros()).div_ceil(2).max(1);
    let mask = (1 << half) - 1;
    loop {
        let (mut left, mut right) = (index >> half, index & mask);
        for round in 0..ROUNDS {
            (left, right) = (right, left ^ (key.child(round).child(right).bits() & mask));
        }
        index = left << half | right;
        if index < count {
            return index;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(of: Of, name: &str, text: &str) -> Option<Result<String, String>> {
        spread(of, name, text).map(|spread| spread.map(|spread| spread.quantile(|_| 0.3).to_string()))
    }

    #[test]
    fn spreads_are_read_by_the_kind_of_the_knob() {
        let some = |text: &str| Some(Ok(text.to_owned()));
        for (name, text, expected) in [
            ("points", "3000..6000", some("3900")),
            ("points", "20 ± 2.5", some("19")),
            ("crown_height", "0.5 .. 2.5", some("1.1")),
            ("crown_height", "5..15", some("8")),
            ("base_radius", "0.1..0.3", some("0.16")),
            ("kill", "0.5m..1.5m", some("0.8")),
            ("kill", "2D..4D", some("2.6D")),
            ("kill", "10D +/- 1", some("9.4756D")),
            ("season", "0.5 ± 0.1", some("0.44756")),
            ("a_constant_of_its_own", "1 +/- 0.1", some("0.94756")),
            // Values that are no spread.
            ("points", "3", None),
            ("leaf_mesh", "../leaf.obj", None),
            ("a_constant_of_its_own", "a..b", None),
        ] {
            let found = read(Of::Knob, name, text);
            assert_eq!(found, expected, "{name} {text}");
        }
        for (name, text, said) in [
            ("points", "3..1", "must be the smaller one"),
            ("points", "3 ± 0", "no standard deviation above 0"),
            ("season", "0.1..7", "7 is outside the range"),
            ("kill", "2..4D", "mixes metres and steps"),
            ("a_constant_of_its_own", "3 ± -1", "no standard deviation above 0"),
        ] {
            let error = read(Of::Knob, name, text).unwrap().unwrap_err();
            assert!(error.contains(said), "{name} {text}: {error}");
        }
        // A constant that is called like a knob is none.
        assert_eq!(read(Of::Constant, "season", "5..15"), some("8"));
    }

    #[test]
    fn plain_draws_are_as_they_were() {
        // What a share was before spreads had quantiles.
        let written = |x: f64| format!("{x:.5e}").parse::<f64>().unwrap().to_string();
        let key = Key::new(7);
        for i in 0..2000 {
            let share = key.child(i).unit();
            let at = |text: &str| {
                spread(Of::Constant, "a", text).unwrap().unwrap().quantile(|_| share).to_string()
            };
            assert_eq!(at("0.7..0.95"), written(0.7 + share * (0.95 - 0.7)));
            assert_eq!(at("3..8"), (3.0 + (share * 6.0).floor()).min(8.0).to_string());
            assert_eq!(at("-2..1.0"), written(-2.0 + share * 3.0));
        }
        let at = |share: f64| {
            spread(Of::Constant, "a", "40 +- 5").unwrap().unwrap().quantile(|_| share).to_string()
        };
        assert_eq!([0.01, 0.2, 0.7, 0.999].map(at), ["28.3683", "35.7919", "42.622", "55"]);
    }

    #[test]
    fn a_latin_hypercube_has_one_sample_in_each_stratum() {
        for count in [1_u64, 2, 3, 20, 64, 100, 1000] {
            for seed in 0..3 {
                let stratum = |sample| (count as f64 * stratum(Key::new(seed), sample, count)) as u64;
                let mut strata: Vec<u64> = (0..count).map(stratum).collect();
                assert!(count < 20 || !strata.is_sorted());
                strata.sort_unstable();
                assert_eq!(strata, (0..count).collect::<Vec<_>>());
            }
        }
    }
}
