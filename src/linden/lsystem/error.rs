//! What can be wrong with a grammar, and with growing it.

use std::fmt;

use crate::foliage::PROTOTYPES;
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
        "after {derivations} derivations the string has no F or G outside polygons, so there is nothing to draw: \
         use more derivations, or a rule that gives F"
    )]
    NothingDrawn {
        /// What was asked for.
        derivations: u32,
    },
    /// `stems` plants together would be more than the limit.
    #[error(
        "{stems} stems of {} symbols each are more than the limit of {limit}: use fewer stems or derivations, \
         or raise the limit", Amount(*.symbols)
    )]
    TooManyStems {
        /// [`Habit::Shrub`](super::Habit::Shrub)'s.
        stems: u32,
        /// The forecast of one.
        symbols: u128,
        /// [`Settings::symbol_limit`](super::Settings::symbol_limit).
        limit: u64,
    },
    /// `}` without `{`.
    #[error("a '}}' fills a polygon that no '{{' has begun: each needs one before it, which no '%' cuts off")]
    PolygonUnopened,
    /// `{` without `}`.
    #[error("a '{{' begins a polygon that no '}}' fills: each needs one behind it, which no '%' cuts off")]
    PolygonUnclosed,
    /// `.` outside.
    #[error("a '.' records a vertex, but no polygon is open: put it between '{{' and '}}'")]
    VertexOutside,
    /// More vertices than an outline may have.
    #[error(
        "a polygon has more than {limit} vertices, which is no leaf: fill it in pieces, or use fewer derivations"
    )]
    PolygonTooLarge {
        /// [`MAX_CORNERS`](crate::foliage::MAX_CORNERS).
        limit: usize,
    },
    /// What stands behind a `~` is not in the table of organs.
    #[error("'~' is followed by {}, which names no organ; there are: {}", Found(*.found), Organs)]
    UnknownOrgan {
        /// The symbol; `None` at the end of the string.
        found: Option<char>,
    },
    /// An organ of no size, or larger than anything.
    #[error("'~{letter}' is {size} segments large, but must be 0 to {most}")]
    OrganSize {
        /// The organ.
        letter: char,
        /// Its argument.
        size: f64,
        /// The most.
        most: f64,
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

struct Found(Option<char>);

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.map_or("nothing".into(), quoted))
    }
}

/// The table, as a message has it.
struct Organs;

impl fmt::Display for Organs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, own) in PROTOTYPES.iter().enumerate() {
            write!(f, "{}{} ({})", if i == 0 { "" } else { ", " }, own.letter, own.name)?;
        }
        Ok(())
    }
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
