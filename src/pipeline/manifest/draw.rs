//! Values that are drawn.

use linden_base::random::Key;

/// A distribution. Values are written with six digits that count, whole numbers as such.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw {
    /// `a..b`: evenly between both, both included.
    Even {
        /// The least.
        low: f64,
        /// The largest.
        high: f64,
        /// Whether both are written without a point: whole numbers are drawn.
        is_whole: bool,
    },
    /// `m ± s`: normally, by mean and standard deviation, cut off at three of these.
    Normal {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        sd: f64,
    },
}

/// Beyond so many standard deviations nothing is drawn.
const WIDEST: f64 = 3.0;

impl Draw {
    /// Reads `a..b` or `m ± s` (or `m +- s`); `None` for anything else.
    pub(super) fn parse(text: &str) -> Option<Result<Self, String>> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let split = |by: &str| text.split_once(by).and_then(|(a, b)| Some((number(a)?, number(b)?)));
        if let Some((mean, sd)) = split("±").or_else(|| split("+-")) {
            let wrong = || format!("'{text}' has a standard deviation below 0");
            return Some(if sd < 0.0 { Err(wrong()) } else { Ok(Self::Normal { mean, sd }) });
        }
        let (low, high) = split("..")?;
        if low > high {
            return Some(Err(format!("'{text}' runs from {low} down to {high}: write the smaller first")));
        }
        let is_whole = !text.replace("..", " ").contains(['.', 'e', 'E']);
        Some(Ok(Self::Even { low, high, is_whole }))
    }

    /// The value below which a share of all draws lies.
    pub(super) fn at(self, share: f64) -> String {
        match self {
            Self::Even { low, high, is_whole: true } => {
                (low + (share * (high - low + 1.0)).floor()).min(high).to_string()
            }
            Self::Even { low, high, .. } => written(low + share * (high - low)),
            Self::Normal { mean, sd } => written(mean + sd * quantile(share).clamp(-WIDEST, WIDEST)),
        }
    }
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

/// A number with six digits that count.
fn written(x: f64) -> String {
    format!("{x:.5e}").parse::<f64>().map_or_else(|_| x.to_string(), |rounded| rounded.to_string())
}

/// The inverse of the normal distribution, by bisection of its integral (Abramowitz & Stegun 1964, 7.1.1).
fn quantile(share: f64) -> f64 {
    let below = |z: f64| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
    let (mut low, mut high) = (-WIDEST, WIDEST);
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

    fn read(text: &str) -> Draw {
        Draw::parse(text).unwrap().unwrap()
    }

    #[test]
    fn distributions_are_read_and_nothing_else_is() {
        assert_eq!(read("3000..6000"), Draw::Even { low: 3000.0, high: 6000.0, is_whole: true });
        assert_eq!(read("0.5 .. 2"), Draw::Even { low: 0.5, high: 2.0, is_whole: false });
        assert_eq!(read("20 ± 2.5"), Draw::Normal { mean: 20.0, sd: 2.5 });
        assert_eq!(read("20+-2.5"), Draw::Normal { mean: 20.0, sd: 2.5 });
        for text in ["3", "oak", "0.5:0.9:0.1", "..", "a..b", "17D"] {
            assert_eq!(Draw::parse(text), None, "{text}");
        }
        assert!(Draw::parse("3..1").unwrap().is_err() && Draw::parse("3 ± -1").unwrap().is_err());
    }

    #[test]
    fn draws_have_the_moments_of_their_distribution() {
        let key = Key::new(7);
        let of = |draw: Draw| -> (f64, f64) {
            let all: Vec<f64> = (0..4000).map(|i| draw.at(key.child(i).unit()).parse().unwrap()).collect();
            let mean = all.iter().sum::<f64>() / 4000.0;
            let squares: f64 = all.iter().map(|x| (x - mean) * (x - mean)).sum();
            (mean, (squares / 3999.0).sqrt())
        };
        let (mean, sd) = of(read("10 ± 2"));
        assert!((mean - 10.0).abs() < 0.1 && (sd - 2.0).abs() < 0.1, "{mean} {sd}");
        let (mean, sd) = of(read("0..1.0"));
        assert!((mean - 0.5).abs() < 0.02 && (sd - 12_f64.sqrt().recip()).abs() < 0.01, "{mean} {sd}");
        // A die.
        let (mean, sd) = of(read("1..6"));
        assert!((mean - 3.5).abs() < 0.1 && (sd - (35.0_f64 / 12.0).sqrt()).abs() < 0.05, "{mean} {sd}");
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
