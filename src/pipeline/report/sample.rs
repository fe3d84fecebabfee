//! Samples of one number: where they lie, and whether two are of one distribution.

/// Values of one number, of several trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Ascending, finite; at least one.
    values: Vec<f64>,
}

/// How far two samples are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parting {
    /// The largest distance between their empirical distribution functions, 0 to 1: D of Kolmogorov and Smirnov.
    pub distance: f64,
    /// How probable so large a distance, or a larger one, is between samples of one distribution. Exact, with equal values
    /// too, where the product of the two sizes is at most four million; above, by Kolmogorov's limit with Stephens'
    /// correction (Stephens 1970, J. R. Stat. Soc. B 32: 115).
    pub p: f64,
}

/// The largest product of the sizes of two samples whose p is exact: some 20 ms.
const MOST_EXACT: usize = 4_000_000;

impl Sample {
    /// Of the finite ones of these; `None` where there is none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        (!values.is_empty()).then_some(Self { values })
    }

    /// How many there are.
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Their mean.
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Their standard deviation, with n − 1; `None` of a single one.
    pub fn deviation(&self) -> Option<f64> {
        let mean = self.mean();
        let squares: f64 = self.values.iter().map(|x| (x - mean) * (x - mean)).sum();
        (self.values.len() > 1).then(|| (squares / (self.values.len() - 1) as f64).sqrt())
    }

    /// The value below which a share of them lies, between neighbours in proportion (type 7 of Hyndman & Fan 1996).
    pub fn quantile(&self, share: f64) -> f64 {
        let at = share.clamp(0.0, 1.0) * (self.values.len() - 1) as f64;
        let (low, high) = (self.values[at.floor() as usize], self.values[at.ceil() as usize]);
        low + (high - low) * at.fract()
    }

    /// The two-sample test of Kolmogorov and Smirnov.
    ///
    /// ```
    /// use linden_pipeline::report::Sample;
    /// let low = Sample::of([1.0, 2.0, 3.0]).ok_or("empty")?;
    /// let high = Sample::of([11.0, 12.0]).ok_or("empty")?;
    /// assert_eq!(low.parting(&high).distance, 1.0);
    /// assert_eq!(low.parting(&low).p, 1.0);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn parting(&self, other: &Self) -> Parting {
        let (a, b) = (&self.values, &other.values);
        let (mut i, mut j, mut most) = (0, 0, 0);
        // By how many were passed whether a value is the last of those that are equal: only there do the distributions
        // stand still.
        let mut is_step = vec![false; a.len() + b.len() + 1];
        while i < a.len() || j < b.len() {
            let at =
                a.get(i).copied().unwrap_or(f64::INFINITY).min(b.get(j).copied().unwrap_or(f64::INFINITY));
            // Equal values step both at once.
            i += a[i..].iter().take_while(|x| **x <= at).count();
            j += b[j..].iter().take_while(|x| **x <= at).count();
            is_step[i + j] = true;
            most = most.max(apart(i, j, a.len(), b.len()));
        }
        let product = a.len() as u64 * b.len() as u64;
        let distance = most as f64 / product as f64;
        if product <= MOST_EXACT as u64 {
            return Parting { distance, p: reached(most, a.len(), b.len(), &is_step) };
        }
        let root = (product as f64 / (a.len() + b.len()) as f64).sqrt();
        Parting { distance, p: kolmogorov((root + 0.12 + 0.11 / root) * distance) }
    }

    /// The smallest p that samples of these sizes reach, however far they are apart: where all values of one lie below all of the
    /// other, as in 2 of n + m over n divisions.
    ///
    /// ```
    /// # use linden_pipeline::report::Sample;
    /// let low = Sample::of([1.0, 2.0, 3.0]).ok_or("empty")?;
    /// let high = Sample::of([11.0, 12.0]).ok_or("empty")?;
    /// assert!((low.least_p(&high) - 0.2).abs() < 1e-12);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn least_p(&self, other: &Self) -> f64 {
        let (few, many) = (self.len().min(other.len()), self.len().max(other.len()));
        let share = |k: usize| k as f64 / (many + k) as f64;
        (1..=few).fold(2.0, |p, k| p * share(k))
    }
}

/// How far two empirical distributions are apart behind `i` of `n` values and `j` of `m`, times n·m: a whole number, so that
/// distances are compared without rounding.
fn apart(i: usize, j: usize, n: usize, m: usize) -> u64 {
    (i as u64 * m as u64).abs_diff(j as u64 * n as u64)
}

/// The probability that two samples of one distribution, of `n` and `m` values, are somewhere `most` apart or farther.
///
/// In order, the values of both are a path from (0, 0) to (n, m) that steps right for one of the first sample and up for
/// one of the second, and of one distribution all paths are alike probable. Counted are those that come to a place that
/// is so far from the diagonal (Hodges 1958, *The significance probability of the Smirnov two-sample test*, Arkiv för
/// Matematik 3: 469). A random path to (i, j) comes from the left in i of i + j cases, so that shares are summed instead
/// of counts, as in R's `psmirnov`: no number overflows, and small p lose no digits. Where values are equal, the
/// distributions are compared behind the last of them alone: given which are equal, that is exact too (Schröer & Trenkler
/// 1995, *Exact and randomization distributions of Kolmogorov–Smirnov tests two or three samples*, Computational
/// Statistics & Data Analysis 20: 185).
///
/// Takes time by n·m and memory by m.
fn reached(most: u64, n: usize, m: usize, is_step: &[bool]) -> f64 {
    let is_far = |i: usize, j: usize| is_step[i + j] && apart(i, j, n, m) >= most;
    // Of the paths to (i, j), the share that was far away before or is there, of one i.
    let mut shares = vec![0.0; m + 1];
    for i in 0..=n {
        for j in 0..=m {
            shares[j] = if is_far(i, j) {
                1.0
            } else if j == 0 {
                shares[0]
            } else if i == 0 {
                shares[j - 1]
            } else {
                (i as f64 * shares[j] + j as f64 * shares[j - 1]) / (i + j) as f64
            };
        }
    }
    shares[m].min(1.0)
}

/// The probability that Kolmogorov's statistic exceeds `x`: 2 Σ (−1)^(k−1) exp(−2 k² x²).
fn kolmogorov(x: f64) -> f64 {
    // Below, the series needs many terms, and is 1 to seven digits.
    if x < 0.3 {
        return 1.0;
    }
    let term = |k: i32| {
        let k = f64::from(k);
        libm::exp(-2.0 * k * k * x * x)
    };
    let sum: f64 = (1..=20).map(|k| if k % 2 == 1 { term(k) } else { -term(k) }).sum();
    (2.0 * sum).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(values: &[f64]) -> Sample {
        Sample::of(values.iter().copied()).unwrap()
    }

    #[test]
    fn moments_and_quantiles_are_those_of_the_definitions() {
        let four = sample(&[4.0, 1.0, f64::NAN, 3.0, 2.0]);
        assert_eq!((four.len(), four.mean(), four.quantile(0.5), four.quantile(1.0)), (4, 2.5, 2.5, 4.0));
        assert!((four.deviation().unwrap() - (5.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        // numpy.quantile([1, 2, 3, 4], 0.1)
        assert!((four.quantile(0.1) - 1.3).abs() < 1e-12);
        assert_eq!((sample(&[7.0]).deviation(), Sample::of([f64::NAN])), (None, None));
    }

    #[test]
    fn the_distance_is_that_of_all_thresholds() {
        let a = [0.3, 0.9, 1.2, 1.2, 2.0, 3.7];
        let b = [0.1, 0.9, 1.2, 2.5];
        let share = |all: &[f64], x: f64| all.iter().filter(|y| **y <= x).count() as f64 / all.len() as f64;
        let brute = a.iter().chain(&b).map(|x| (share(&a, *x) - share(&b, *x)).abs()).fold(0.0, f64::max);
        assert!((sample(&a).parting(&sample(&b)).distance - brute).abs() < 1e-12);
    }

    /// The largest distance, over all thresholds, as the definition has it; times n·m.
    fn distance_of(a: &[f64], b: &[f64]) -> u64 {
        let below = |all: &[f64], x: f64| all.iter().filter(|y| **y <= x).count() as u64;
        let apart = |x: &f64| (below(a, *x) * b.len() as u64).abs_diff(below(b, *x) * a.len() as u64);
        a.iter().chain(b).map(apart).max().unwrap()
    }

    /// p by going through all ways to divide the values of both into samples of their sizes.
    fn p_of_all_divisions(a: &[f64], b: &[f64]) -> f64 {
        let all = [a, b].concat();
        let found = distance_of(a, b);
        let (mut far, mut count) = (0_u32, 0_u32);
        for chosen in 0_u32..1 << all.len() {
            if chosen.count_ones() as usize != a.len() {
                continue;
            }
            let (first, second): (Vec<_>, Vec<_>) =
                all.iter().enumerate().partition(|(place, _)| chosen >> place & 1 == 1);
            let values = |of: Vec<(usize, &f64)>| of.into_iter().map(|(_, x)| *x).collect::<Vec<f64>>();
            count += 1;
            far += u32::from(distance_of(&values(first), &values(second)) >= found);
        }
        f64::from(far) / f64::from(count)
    }

    #[test]
    fn p_is_exact_for_small_samples_and_equal_values() {
        use linden_base::random::Key;
        let p = |a: &[f64], b: &[f64]| sample(a).parting(&sample(b)).p;
        // By hand: 2 of 6 divisions, 2 of 13, and 30 of 91, where at least eight of the twelve lie on one side of both.
        assert!((p(&[1.0, 2.0], &[3.0, 4.0]) - 1.0 / 3.0).abs() < 1e-12);
        let twelve: Vec<f64> = (1..=12).map(f64::from).collect();
        assert!((p(&twelve, &[0.5]) - 2.0 / 13.0).abs() < 1e-12);
        let (two_thirds, p_of_two) =
            (sample(&twelve).parting(&sample(&[8.5, 9.5])).distance, p(&twelve, &[8.5, 9.5]));
        assert!((two_thirds - 2.0 / 3.0).abs() < 1e-12 && (p_of_two - 30.0 / 91.0).abs() < 1e-12);
        assert!((sample(&twelve).least_p(&sample(&[0.5])) - 2.0 / 13.0).abs() < 1e-12);
        assert!((sample(&[1.0, 2.0]).least_p(&sample(&[3.0, 4.0])) - 1.0 / 3.0).abs() < 1e-12);
        for trial in 0..60 {
            let key = Key::new(trial);
            // Whole numbers, of which many are equal, in every second trial.
            let value = |i: u64| {
                let x = key.child(i).normal() * 2.0;
                if trial % 2 == 0 { x } else { x.round() }
            };
            let (n, m) = (1 + trial % 5, 1 + trial / 5 % 9);
            let a: Vec<f64> = (0..n).map(value).collect();
            let b: Vec<f64> = (n..n + m).map(value).collect();
            let (found, counted) = (p(&a, &b), p_of_all_divisions(&a, &b));
            assert!((found - counted).abs() < 1e-12, "{a:?} {b:?}: {found}, counted {counted}");
            assert_eq!(found.to_bits(), p(&b, &a).to_bits());
        }
    }

    #[test]
    fn exact_and_limit_meet_in_large_samples() {
        let line = |count: u32, from: f64| (0..count).map(|i| from + f64::from(i)).collect::<Vec<f64>>();
        // 2000 values each are the last that are exact.
        let [last, above] = [2000, 2001].map(|n| sample(&line(n, 0.0)).parting(&sample(&line(n, 80.5))).p);
        assert!((last / above - 1.0).abs() < 0.05, "{last} {above}");
        // 2 ÷ C(200, 100): what a difference from 1 could not hold.
        let tiny = sample(&line(100, 0.0)).parting(&sample(&line(100, 200.0))).p;
        assert!((tiny / 2.208_760_693e-59 - 1.0).abs() < 1e-9, "{tiny:e}");
    }

    #[test]
    fn probabilities_are_kolmogorovs() {
        // Smirnov 1948, Table for estimating the goodness of fit of empirical distributions: 1 − L(x).
        for (x, p) in
            [(0.5, 0.963_945), (0.8, 0.544_142), (1.0, 0.270_000), (1.36, 0.049_486), (1.63, 0.009_846)]
        {
            assert!((kolmogorov(x) - p).abs() < 2e-5, "{x}: {}", kolmogorov(x));
        }
        assert_eq!(kolmogorov(0.1), 1.0);
    }

    #[test]
    fn samples_of_one_distribution_part_as_often_as_p_says() {
        use linden_base::random::Key;
        let drawn = |trial: u64, which: &str| {
            let key = Key::new(trial).named(which);
            Sample::of((0..30).map(|i| key.child(i).normal())).unwrap()
        };
        let parts = |trial: &u64| drawn(*trial, "a").parting(&drawn(*trial, "b")).p < 0.05;
        let parted = (0..2000).filter(parts).count();
        // The test is conservative: not more than it says, and not never.
        assert!((40..=110).contains(&parted), "{parted} of 2000");
    }
}
