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
    /// How probable so large a distance is between samples of one distribution. By Kolmogorov's limit with Stephens'
    /// correction for small samples (Stephens 1970, J. R. Stat. Soc. B 32: 115), which is rough below ten values.
    pub p: f64,
}

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
        let (mut i, mut j, mut distance) = (0, 0, 0.0_f64);
        while i < a.len() && j < b.len() {
            let at = a[i].min(b[j]);
            // Equal values step both at once.
            i += a[i..].iter().take_while(|x| **x <= at).count();
            j += b[j..].iter().take_while(|x| **x <= at).count();
            distance = distance.max((i as f64 / a.len() as f64 - j as f64 / b.len() as f64).abs());
        }
        let root = (a.len() as f64 * b.len() as f64 / (a.len() + b.len()) as f64).sqrt();
        Parting { distance, p: kolmogorov((root + 0.12 + 0.11 / root) * distance) }
    }
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
