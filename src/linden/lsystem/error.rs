//! What can be wrong with a grammar, and with growing it.

use std::fmt;

use crate::knob::{excerpt, printable};
use crate::memory::OverMemory;
use crate::monitor::Cancelled;

/// What was wrong at one place of a text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Something else should stand here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What may stand here.
        expected: String,
        /// What stands here, printable: `'x'`, or `the end`.
        found: String,
    },
    /// Part of the language in the literature, not of this version.
    #[error("{construct} is not supported yet; take it out, or write the rule without it")]
    Unsupported {
        /// What it is, and how it is written here.
        construct: String,
    },
    /// `]` where no branch is open.
    #[error("']' closes a branch that was never opened")]
    Unopened,
    /// `[` whose `]` is missing.
    #[error("'[' opens a branch that is never closed")]
    Unclosed,
    /// A number outside what is meaningful here.
    #[error("{number} is out of range: {min} to {max}")]
    OutOfRange {
        /// As it was written, printable.
        number: String,
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// The rules of one predecessor must share out the probability 1.
    #[error("the probabilities of the rules for '{predecessor}' sum to {sum}, not to 1")]
    Probabilities {
        /// Whose rules.
        predecessor: char,
        /// What they sum to.
        sum: f64,
    },
    /// A key that may stand once stands twice.
    #[error("'{key}' was already given in line {first_line}; keep one of them")]
    Repeated {
        /// The key.
        key: &'static str,
        /// Where it stood first, from 1.
        first_line: usize,
    },
    /// A key that must stand somewhere does not.
    #[error("no line says '{key}=…'")]
    Missing {
        /// The key.
        key: &'static str,
    },
}

impl Problem {
    pub(super) fn expected(expected: impl Into<String>, found: Option<char>) -> Self {
        Self::Expected { expected: expected.into(), found: found.map_or("the end".into(), quoted) }
    }

    pub(super) fn unsupported(what: &str, written: &str) -> Self {
        Self::Unsupported { construct: format!("{what} ('{}')", excerpt(written)) }
    }
}

/// A character between quotes, printable.
fn quoted(symbol: char) -> String {
    format!("'{}'", printable(symbol.encode_utf8(&mut [0; 4])))
}

/// Which of a grammar's strings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The axiom.
    Axiom,
    /// A rule, counted from 0 in the order given.
    Rule(usize),
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axiom => f.write_str("axiom"),
            Self::Rule(index) => write!(f, "rule {}", index + 1),
        }
    }
}

/// A grammar that cannot be understood, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{part}, column {column}: {problem}")]
pub struct GrammarError {
    /// Which string.
    pub part: Part,
    /// Byte offset in that string (its length when something is missing at the end).
    pub offset: usize,
    /// The same place in characters, from 1.
    pub column: usize,
    /// What is wrong there.
    #[source]
    pub problem: Problem,
}

/// Why an L-system did not grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LsystemError {
    /// Refused before deriving.
    #[error(
        "{derivations} derivations would give {} {} symbols, more than the limit of {limit}: {}",
        if *.exact { "exactly" } else { "about" }, Amount(*.symbols), Advice(*.fits)
    )]
    TooManySymbols {
        /// What was asked for.
        derivations: u32,
        /// How long the string would be, or is expected to be; saturated at `u128::MAX`.
        symbols: u128,
        /// Whether `symbols` is exact, or the expectation of a stochastic system.
        exact: bool,
        /// [`Settings::symbol_limit`](super::Settings::symbol_limit).
        limit: u64,
        /// The most derivations, fewer than asked for, that stay within the limit.
        fits: Option<u32>,
    },
    /// A stochastic system grew past the limit although its expectation did not.
    #[error(
        "with the seed {seed}, {derivations} derivations give more than the limit of {limit} symbols: \
         use fewer derivations, another seed or a higher limit"
    )]
    GrewPastLimit {
        /// What was asked for.
        derivations: u32,
        /// Whose choices.
        seed: u64,
        /// [`Settings::symbol_limit`](super::Settings::symbol_limit).
        limit: u64,
    },
    /// More open branches than [`MAX_NESTING`](super::MAX_NESTING).
    #[error(
        "{derivations} derivations nest branches more than {limit} deep, which is no tree: \
         use fewer derivations"
    )]
    NestedTooDeeply {
        /// What was asked for.
        derivations: u32,
        /// [`MAX_NESTING`](super::MAX_NESTING).
        limit: usize,
    },
    /// The string holds no symbol that draws.
    #[error(
        "after {derivations} derivations the string has no F or G, so there is nothing to draw: \
         use more derivations, or a rule that gives F"
    )]
    NothingDrawn {
        /// What was asked for.
        derivations: u32,
    },
    /// A setting outside its range.
    #[error("{name} is {value}, but must be {expected}")]
    Setting {
        /// Its name in [`Settings`](super::Settings).
        name: &'static str,
        /// As given.
        value: String,
        /// Its range.
        expected: String,
    },
    /// The structure would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wanted the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A count of symbols; past a million in powers of ten, since nobody reads more digits.
struct Amount(u128);

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            u128::MAX => f.write_str("more than 3e38"),
            n if n >= 1_000_000_000_000_000 => write!(f, "{:.1e}", n as f64),
            n => write!(f, "{n}"),
        }
    }
}

struct Advice(Option<u32>);

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(fits) => write!(f, "use {fits} derivations or fewer, or raise the limit"),
            None => f.write_str("shorten the axiom, or raise the limit"),
        }
    }
}
