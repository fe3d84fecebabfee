//! Samples of L-systems: fewer derivations, one stem of a shrub.

use linden_base::input::Inputs;
use linden_base::monitor::Monitor;
use linden_skeleton::Skeleton;
use linden_skeleton::generator::{GeneratorError, Multiple, SampleSize, SampleStep, Sampler};

use crate::{Forecast, LSystem, LsystemError, StemHabit, forecast, grow};

pub(crate) struct Fewer {
    smaller: Option<LSystem>,
    multiple: Multiple,
}

impl Fewer {
    pub fn new(settings: &LSystem, size: SampleSize, monitor: &dyn Monitor) -> Result<Self, GeneratorError> {
        let limit = size.symbols >> size.halvings.min(12);
        let whole = settings.forecast()?;
        let mut smaller = LSystem { derivations: settings.derivations_grown(), age: 1.0, ..settings.clone() };
        let (mut times, mut crowding) = (1.0, 1.0);
        if whole.at_least || whole.symbols > limit.into() {
            if smaller.habit == StemHabit::Shrub {
                times = f64::from(smaller.stems);
                smaller.habit = StemHabit::Tree;
            }
            crowding = fewer(&mut smaller, limit, monitor)?;
            times *= crowding;
        }
        smaller.symbol_limit = limit.max(settings.symbol_limit);
        let multiple = Multiple { wood_times: times, leaf_times: times, crowding, ..Multiple::ONE };
        Ok(Self { smaller: Some(smaller), multiple })
    }
}

impl Sampler for Fewer {
    fn next(&mut self, _: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        Ok(match self.smaller.take() {
            Some(smaller) => SampleStep::Grow { settings: Box::new(smaller), inputs: Inputs::new() },
            None => SampleStep::Done(self.multiple),
        })
    }
}

/// Takes derivations away until no more than `limit` symbols are left. Gives how many times as many the
/// others would make of them.
fn fewer(small: &mut LSystem, limit: u64, monitor: &dyn Monitor) -> Result<f64, GeneratorError> {
    let wanted = small.derivations;
    let at = |derivations: u32| LSystem { derivations, ..small.clone() };
    let whole = forecast(&small.grammar, wanted)?;
    if !whole.at_least {
        let most = most(wanted, |derivations| {
            let forecast = forecast(&small.grammar, derivations)?;
            Ok(!forecast.at_least && forecast.symbols <= limit.into())
        })?;
        let part = forecast(&small.grammar, most)?;
        let count = |forecast: &Forecast| match forecast.segments {
            0 => forecast.symbols as f64,
            segments => segments as f64,
        };
        let times = count(&whole) / count(&part).max(1.0);
        small.derivations = most;
        return Ok(times);
    }
    // By deriving: how many segments there are, `None` beyond the limit.
    let segments = |derivations: u32| -> Result<Option<f64>, GeneratorError> {
        let fewer = LSystem { symbol_limit: limit, ..at(derivations) };
        match grow(&fewer.grammar, &fewer.turtle(0), monitor) {
            Ok(grown) => Ok(Some(grown.branching.positions.len() as f64)),
            Err(LsystemError::NothingDrawn { .. }) => Ok(Some(0.0)),
            Err(
                LsystemError::TooManySymbols { .. }
                | LsystemError::GrewPastLimit { .. }
                | LsystemError::NestedTooDeeply { .. }
                | LsystemError::Memory(_),
            ) => Ok(None),
            Err(error) => Err(error.into()),
        }
    };
    let most = most(wanted, |derivations| Ok(segments(derivations)?.is_some()))?;
    if most == wanted {
        return Ok(1.0);
    }
    // What is nested or cut may come back in every other step.
    let apart = if most >= 8 { 2 } else { 1 };
    let mut counts = [0.0; 3];
    for (back, count) in (0..).zip(&mut counts) {
        *count = match most.checked_sub(back * apart) {
            Some(derivations) => segments(derivations)?.unwrap_or(0.0),
            None => 0.0,
        };
    }
    small.derivations = most;
    Ok(extrapolated(counts, f64::from(most), f64::from(apart), f64::from(wanted)))
}

/// The most derivations that fit: the first guess is all of them.
fn most(wanted: u32, fits: impl Fn(u32) -> Result<bool, GeneratorError>) -> Result<u32, GeneratorError> {
    if fits(wanted)? {
        return Ok(wanted);
    }
    let (mut low, mut high) = (0, wanted);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if fits(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(low)
}

/// How many times as much there is after `wanted` derivations as after `at`, from what there was then and
/// `apart` and twice `apart` before: growth by `exp(a·n)·n^p` with neither below 0.
fn extrapolated([now, before, first]: [f64; 3], at: f64, apart: f64, wanted: f64) -> f64 {
    if !(now > before && before > 0.0) {
        return 1.0;
    }
    let last = libm::log(now / before);
    let (u, v) = (libm::log(at / (at - apart)), libm::log((at - apart) / (at - 2.0 * apart)));
    let mut power = 0.0;
    if first > 0.0 && at > 2.0 * apart && v > u {
        power = ((libm::log(before / first) - last) / (v - u)).clamp(0.0, last / u);
    }
    let rate = (last - power * u) / apart;
    libm::exp(rate * (wanted - at) + power * libm::log(wanted / at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_and_exponentials_go_on() {
        let of = |f: fn(f64) -> f64, at: f64, wanted: f64| {
            let counts = [f(at), f(at - 1.0), f(at - 2.0)];
            extrapolated(counts, at, 1.0, wanted) / (f(wanted) / f(at))
        };
        for ratio in [
            of(|n| libm::pow(2.0, n), 8.0, 20.0),
            of(|n| n * n * n, 20.0, 60.0),
            of(|n| n, 50.0, 9000.0),
            of(|n| n * n * libm::pow(1.5, n), 12.0, 30.0),
        ] {
            assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
        }
        assert_eq!(extrapolated([5.0, 5.0, 3.0], 4.0, 1.0, 100.0), 1.0);
    }
}
