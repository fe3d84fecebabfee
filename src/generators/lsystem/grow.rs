//! Growing: from a grammar and settings to a branching structure, within limits.

use super::derive::{Way, derive, with_writer};
use super::error::LsystemError;
use super::flat::{Flat, Walker};
use super::forecast::{self, Forecast};
use super::grammar::Grammar;
use super::program::Program;
use super::turtle::Turtle;
use super::turtle_settings::{MAX_NESTING, Stems, TurtleSettings};
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_skeleton::Branching;
use linden_skeleton::organs::Organs;

/// Between neighbouring stems of a shrub, seen from above: the golden angle, with which any number of
/// stems is spread evenly.
const GOLDEN_ANGLE_DEG: f64 = 137.507_764_050_037_85;

/// A tree as the turtle drew it.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// One node for each segment at its far end, and one for each stem's foot.
    ///
    /// A node's birth is the derivation step in which the symbol that drew its segment came into
    /// being: 0 for a symbol of the axiom, k for one that the k-th step wrote. A symbol that no rule
    /// rewrites is kept and keeps its step. A symbol that a rule rewrites is replaced, also where
    /// the successor holds the same symbol: with `F -> F[+F]F`, every segment is born in the last
    /// step. A foot is born with the first segment that stands on it. Births therefore need not
    /// rise from parent to child: with `A -> AF`, the oldest segments are at the top.
    ///
    /// Radii are there where the grammar holds a `!`: a node's is that of the segment that ends in it,
    /// a foot's that of its first segment.
    pub branching: Branching,
    /// Polygons and organs.
    pub organs: Organs,
    /// The length of the derived string, of all stems together.
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
/// | `!` | thinner: the width times [`TurtleSettings::width_ratio`]; `!(w)`: a diameter of w segment widths |
/// | `'` | the next colour for organs; `'(c)`: colour c, from 0 |
/// | `{` `}` | begin, fill a polygon: between them `F`, `G` and `f` draw no wood |
/// | `.` | the turtle's place is a vertex of the polygon; so are the ends of `F` and `f`, not those of `G` |
/// | `~` | the organ of the letter after it ([`PROTOTYPES`][organs]); its argument: its size in segments |
///
/// [organs]: linden_skeleton::organs::PROTOTYPES
///
/// The vertices of a polygon may be recorded across brackets, and polygons may be nested: what is
/// recorded belongs to the innermost. The first edge of a polygon also starts at a vertex. A polygon of
/// fewer than three different vertices is nothing.
///
/// Rotations keep the words of ABOP's appendix C: left is towards +L, down towards −U, a roll to the
/// left lowers L.
///
/// # Errors
/// A setting out of range, a result over a limit (before deriving, by the [`forecast`](super::forecast())),
/// nothing to draw, or cancellation.
pub fn grow(
    grammar: &Grammar,
    settings: &TurtleSettings,
    monitor: &dyn Monitor,
) -> Result<Drawn, LsystemError> {
    grow_by(grammar, settings, Way::Best, monitor)
}

/// As [`grow`], by a way of one's choice.
///
/// Macros draw each subtree once and place copies of it. They are exact for systems without chance,
/// contexts, cuts and arguments whose only turns are `+`, `-` and `|` by an angle of whole hundredths
/// of a degree, and which hold no `f`, `!` and organs; with one stem, no tropism and no variation.
/// These are drawn in steps on a grid of 2^-k m that is fine enough for every sum of steps to be free
/// of rounding.
///
/// # Errors
/// As [`grow`].
pub fn grow_by(
    grammar: &Grammar,
    settings: &TurtleSettings,
    way: Way,
    monitor: &dyn Monitor,
) -> Result<Drawn, LsystemError> {
    let program = Program::compile(grammar);
    let forecast = settings.admit(&program)?;
    let nothing = |has_organs| LsystemError::NothingDrawn { derivations: settings.derivations, has_organs };
    // An expectation may be rounded to nothing; whether there are organs the turtle finds out.
    if forecast.segments == 0 && forecast.exact && !program.writes_organs() {
        return Err(nothing(false));
    }
    let (stems, lean_deg) = settings.stems();
    let limit = settings.symbol_limit;
    if forecast.symbols.saturating_mul(stems.into()) > limit.into() {
        return Err(LsystemError::TooManyStems { stems, symbols: forecast.symbols, limit });
    }
    let total = forecast.exact.then_some(forecast.symbols as u64);
    if let Some(flat) = Flat::of(&program, settings, &forecast) {
        if way == Way::Best {
            let symbols = forecast.symbols as u64;
            return Ok(Drawn { branching: flat.draw(monitor)?, organs: Organs::default(), symbols });
        }
        let mut walker = Walker::new(flat, monitor)?;
        let symbols = derive(&program, settings, way, total, monitor, &mut walker)?;
        return Ok(Drawn { branching: walker.into_branching(), organs: Organs::default(), symbols });
    }
    // Exact, or unknown: an expectation is no reason to allocate.
    let (segments, depth) = if forecast.exact {
        (forecast.segments as usize * stems as usize, forecast.depth as usize)
    } else {
        (0, 0)
    };
    let mut turtle = Turtle::new(&program, settings, segments, depth, monitor)?;
    let mut symbols = 0;
    for stem in 0..stems {
        // The first stem is that of the tree.
        let seed = if stem == 0 {
            settings.seed
        } else {
            Key::new(settings.seed).named("stem").child(stem.into()).bits()
        };
        // Chance may make each longer than it is expected to be; together they stay within the limit.
        let stem_settings = TurtleSettings { seed, symbol_limit: limit - symbols, ..*settings };
        turtle.start(GOLDEN_ANGLE_DEG * f64::from(stem), lean_deg, Key::new(seed).named("turtle"));
        let derived = derive(&program, &stem_settings, way, total, monitor, &mut turtle);
        let drawn = derived.and_then(|count| turtle.finish().map(|()| count));
        symbols += drawn.map_err(|error| {
            // Users know their own seed and limit, not those of a stem.
            match error {
                LsystemError::GrewPastLimit { derivations, seed, fits, .. } => {
                    let seed = seed.map(|_| settings.seed);
                    LsystemError::GrewPastLimit { derivations, seed, limit, fits }
                }
                other => with_writer(other, &program, &stem_settings, monitor).of(grammar),
            }
        })?;
    }
    let (branching, organs) = turtle.into_parts();
    if branching.positions.is_empty() {
        return Err(nothing(!organs.is_empty()));
    }
    Ok(Drawn { branching, organs, symbols })
}

impl TurtleSettings {
    /// How many stems there are, and how far each leans, degrees.
    pub(super) fn stems(&self) -> (u32, f64) {
        match self.habit {
            Stems::One => (1, 0.0),
            Stems::Several { stems, lean_deg } => (stems, lean_deg),
        }
    }

    /// Checks the settings, and what the derivation would give.
    pub(super) fn admit(&self, program: &Program) -> Result<Forecast, LsystemError> {
        let &Self { derivations, symbol_limit: limit, .. } = self;
        self.check()?;
        let forecast = forecast::of_program(program, derivations);
        let Forecast { symbols, depth, exact, at_least, .. } = forecast;
        if symbols > limit.into() {
            let fits = forecast::most_within(program, derivations, limit);
            return Err(LsystemError::TooManySymbols { derivations, symbols, exact, at_least, limit, fits });
        }
        // The most that a stochastic system can nest may be far from what it does: then the turtle
        // counts.
        if (exact || at_least && !program.random) && depth > MAX_NESTING as u64 {
            return Err(LsystemError::NestedTooDeeply { derivations, limit: MAX_NESTING });
        }
        Ok(forecast)
    }
}
