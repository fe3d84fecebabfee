//! L-systems: grammar, forecast, derivation, turtle.
//!
//! ```text
//! text ──parse──► Grammar ──compile──► Program ──┬── forecast ──► how much it would be
//!                                                └── derive ────► turtle ──► Branching
//! ```
//!
//! The L-systems of ABOP (Prusinkiewicz & Lindenmayer, *The Algorithmic Beauty of Plants*, 1990):
//! bracketed, stochastic, parametric and context-sensitive, with its turtle in three dimensions. A
//! [`Grammar`] is valid by construction: brackets balance, probabilities sum to one, every symbol and
//! every name has a meaning. What is not understood is an error with its place, never passed over.
//!
//! Without contexts the derived string is never in memory: derivation walks the tree of rewritings
//! depth first and hands each symbol to the turtle as it comes into being. With contexts two buffers
//! take turns, filled in parallel. Flat systems are drawn by macros: what comes up again is a copy of
//! what was drawn once, with the same bits ([`grow_by`]). No function here recurses, so neither derivations
//! nor brackets can exhaust the call stack.
//!
//! ```
//! use linden_base::monitor::Quiet;
//! use linden_lsystem::{Grammar, TurtleSettings, forecast, grow};
//!
//! let weed = Grammar::new("F", &["F -> F[+F]F[-F]F"])?;
//! assert_eq!(forecast(&weed, 5)?.segments, 3125); // ABOP, Fig. 1.24 a
//! let usual = TurtleSettings::default();
//! let settings = TurtleSettings { derivations: 5, angle_deg: 25.7, segment_m: 0.02, ..usual };
//! let grown = grow(&weed, &settings, &Quiet)?;
//! assert_eq!(grown.branching.positions.len(), 3126); // one node a segment, and the foot
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chance;
mod command;
mod context;
mod define;
mod derive;
mod error;
mod exposed;
mod expression;
mod flat;
mod forecast;
mod frame;
mod generator;
mod grammar;
mod grow;
mod parse;
mod polygon;
mod program;
mod reader;
mod sample;
mod settings;
pub mod text;
mod turtle;
mod turtle_settings;
mod unused;
mod variation;

pub use define::DefineError;
pub use derive::trace::{MAX_TRACED, Traced, TracedModule, trace};
pub use derive::{Derived, Way, derive_by, derive_string};
pub use error::{GrammarError, GrammarPart, LsystemError, Problem, Writer};
pub use exposed::{ExposeError, Exposed, MOST_EXPOSED};
pub use forecast::{Forecast, forecast};
pub use generator::GENERATOR;
pub use grammar::{Definition, Expression, Grammar, Module, Pattern, Production};
pub use grow::{Drawn, grow, grow_by};
pub use settings::{LSystem, StemHabit};
pub use turtle_settings::{MAX_DERIVATIONS, MAX_NESTING, MAX_STEMS, MAX_SYMBOLS, Stems, TurtleSettings};
pub use variation::Variation;
