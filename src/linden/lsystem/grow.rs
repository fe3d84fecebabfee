//! Growing: from a grammar and settings to a branching structure, within limits.

use super::derive::derive;
use super::error::LsystemError;
use super::forecast::{self, Forecast};
use super::grammar::Grammar;
use super::program::Program;
use super::turtle::Turtle;
use crate::monitor::Monitor;
use crate::skeleton::Branching;

/// The most derivation steps: far more than any tree has, few enough to walk through.
pub const MAX_DERIVATIONS: u32 = 10_000;
/// The most branches open at once: the turtle remembers a state for each.
pub const MAX_NESTING: usize = 100_000;
/// The highest [`Settings::symbol_limit`]: nodes are numbered in 32 bits, and a symbol makes at most
/// two of them.
pub const MAX_SYMBOLS: u64 = 1 << 30;

pub(super) const ANGLE_RANGE_DEG: [f64; 2] = [-360.0, 360.0];
const SEGMENT_RANGE_M: [f64; 2] = [1e-6, 1e6];

/// How a grammar is grown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Derivation steps, 0 to [`MAX_DERIVATIONS`]; 0 draws the axiom.
    pub derivations: u32,
    /// The turn of each rotation that names no angle of its own, −360 to 360 degrees.
    pub angle_deg: f64,
    /// The length of `F`, `G` and `f`, and the unit of their arguments; 10⁻⁶ to 10⁶ m.
    pub segment_m: f64,
    /// Longer strings are refused; 1 to [`MAX_SYMBOLS`].
    pub symbol_limit: u64,
    /// The root of all random choices.
    pub seed: u64,
}

impl Default for Settings {
    /// Four derivations of decimetre segments, at 25.7 degrees, of up to 50 million symbols.
    fn default() -> Self {
        Self { derivations: 4, angle_deg: 25.7, segment_m: 0.1, symbol_limit: 50_000_000, seed: 0 }
    }
}

/// What grew.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// One node for each segment at its far end, and one for each stem's foot.
    ///
    /// A node's birth is the derivation step in which the symbol that drew its segment came into
    /// being: 0 for a symbol of the axiom, k for one that the k-th step wrote. A symbol that no rule
    /// rewrites is kept and keeps its step. A symbol that a rule rewrites is replaced, also where
    /// the successor holds the same symbol: with `F -> F[+F]F`, every segment is born in the last
    /// step. A foot is born with the first segment that stands on it. Births therefore need not
    /// rise from parent to child: with `A -> AF`, the oldest segments are at the top.
    pub branching: Branching,
    /// The length of the derived string.
    pub symbols: u64,
}

/// Derives a grammar and walks the turtle along the result.
///
/// The turtle stands at the origin and looks up: H = +Y, L = −X, U = +Z, so that a system without
/// pitch and roll lies in the XY plane and `+` turns left in a picture seen from +Z.
///
/// | symbol | action |
/// |---|---|
/// | `F` `G` | draw a segment forward; `F(2)`: two segment lengths long |
/// | `f` | move forward; the next segment is the foot of a new stem |
/// | `+` `-` | turn left, right about U; `+(30)`: by 30 degrees |
/// | `&` `^` | pitch down, up about L |
/// | `\` `/` | roll left, right about H |
/// | `\|` | turn by 180 degrees about U |
/// | `$` | roll until L is horizontal; nothing when H is vertical |
/// | `[` `]` | begin, end a branch |
/// | `%` | cut the rest of the branch, in every derivation step and here |
/// | `!` `'` | thinner, next colour: counted, but a [`Branching`] has neither widths nor colours |
///
/// Rotations keep the words of ABOP's appendix C: left is towards +L, down towards −U, a roll to the
/// left lowers L.
///
/// # Errors
/// A setting out of range, a result over a limit (before deriving, by the [`forecast`](super::forecast())),
/// nothing to draw, or cancellation.
pub fn grow(grammar: &Grammar, settings: &Settings, monitor: &dyn Monitor) -> Result<Grown, LsystemError> {
    let program = Program::compile(grammar);
    let forecast = settings.admit(&program)?;
    let nothing = LsystemError::NothingDrawn { derivations: settings.derivations };
    if forecast.segments == 0 {
        return Err(nothing);
    }
    let total = forecast.exact.then_some(forecast.symbols as u64);
    // Exact, or unknown: an expectation is no reason to allocate.
    let (segments, depth) =
        if forecast.exact { (forecast.segments as usize, forecast.depth as usize) } else { (0, 0) };
    let mut turtle = Turtle::new(&program, settings, segments, depth, monitor)?;
    let symbols = derive(&program, settings, total, monitor, &mut turtle)?;
    let branching = turtle.into_branching();
    if branching.positions.is_empty() { Err(nothing) } else { Ok(Grown { branching, symbols }) }
}

impl Settings {
    /// Checks the settings, and what the derivation would give.
    pub(super) fn admit(&self, program: &Program) -> Result<Forecast, LsystemError> {
        let &Self { derivations, symbol_limit: limit, .. } = self;
        check_derivations(derivations)?;
        check_real("angle_deg", self.angle_deg, ANGLE_RANGE_DEG)?;
        check_real("segment_m", self.segment_m, SEGMENT_RANGE_M)?;
        check_whole("symbol_limit", limit, 1, MAX_SYMBOLS)?;
        let forecast = forecast::of_program(program, derivations);
        let Forecast { symbols, depth, exact, .. } = forecast;
        if symbols > limit.into() {
            let fits = forecast::most_within(program, derivations, limit);
            return Err(LsystemError::TooManySymbols { derivations, symbols, exact, limit, fits });
        }
        // The most that a stochastic system can nest may be far from what it does: then the turtle
        // counts.
        if exact && depth > MAX_NESTING as u64 {
            return Err(LsystemError::NestedTooDeeply { derivations, limit: MAX_NESTING });
        }
        Ok(forecast)
    }
}

pub(super) fn check_derivations(derivations: u32) -> Result<(), LsystemError> {
    check_whole("derivations", derivations.into(), 0, MAX_DERIVATIONS.into())
}

fn check_whole(name: &'static str, value: u64, min: u64, max: u64) -> Result<(), LsystemError> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(LsystemError::Setting { name, value: value.to_string(), expected: format!("{min} to {max}") })
}

fn check_real(name: &'static str, value: f64, [min, max]: [f64; 2]) -> Result<(), LsystemError> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(LsystemError::Setting { name, value: value.to_string(), expected: format!("{min} to {max}") })
}
