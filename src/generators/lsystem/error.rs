//! What can be wrong with a grammar, and with growing it.

use std::fmt;

use super::grammar::Grammar;
use linden_base::knob::{listed, printable};
use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_skeleton::organs::PROTOTYPES;

/// A mistake at one place of a text.
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
    /// A sign of rules where a symbol should stand.
    #[error("'{sign}' {what}; it is no symbol")]
    Misplaced {
        /// The sign.
        sign: char,
        /// What it does in its place.
        what: &'static str,
    },
    /// A name that is neither a parameter of the rule nor defined.
    #[error("unknown name '{name}'{hint}; '#define {name} …' would make it a constant")]
    UnknownName {
        /// As it was written, printable.
        name: String,
        /// The nearest name or the known ones, in brackets behind a blank; may be empty.
        hint: String,
    },
    /// A name before a bracket that is no function.
    #[error("unknown function '{name}'{hint}")]
    UnknownFunction {
        /// As it was written, printable.
        name: String,
        /// The nearest name or the known ones, in brackets behind a blank.
        hint: String,
    },
    /// A function with too many or too few arguments.
    #[error("'{name}' takes {expected} {}, found {found}", if *.expected == 1 { "argument" } else { "arguments" })]
    WrongArguments {
        /// The function.
        name: &'static str,
        /// How many it takes.
        expected: usize,
        /// How many there are, or at least are.
        found: usize,
    },
    /// An expression that must have one value for all trees.
    #[error("'{written}' depends on chance, but must be a constant here")]
    NotConstant {
        /// As it was written, printable.
        written: String,
    },
    /// A constant that overflows, or has no value at all.
    #[error("'{written}' is {value}, which is no number to compute with")]
    NotFinite {
        /// As it was written, printable.
        written: String,
        /// What it comes to.
        value: f64,
    },
    /// An expression that is nested too deeply.
    #[error("more than {limit} operands wait for their operators; write the expression with fewer brackets")]
    TooDeep {
        /// The most that may.
        limit: usize,
    },
    /// Signs and brackets without end before an operand.
    #[error("more than {limit} signs, brackets and functions are open; write the expression with fewer")]
    TooManyOpen {
        /// The most that may be.
        limit: usize,
    },
    /// A module or a rule with very many parameters.
    #[error("more than {limit} parameters; use fewer")]
    TooManyParameters {
        /// The most there may be.
        limit: usize,
    },
    /// A name that would mean two things.
    #[error("'{name}' is already defined; use another name")]
    Redefined {
        /// The name.
        name: String,
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
    /// The rules of one predecessor, in the same context and under the same condition, must share out
    /// the probability 1.
    #[error(
        "the probabilities of the rules for '{predecessor}' sum to {sum}, not to 1{}{}",
        another.as_ref().map(|rule| format!(": there is also '{rule}'")).unwrap_or_default(),
        match .unwritten {
            0 => String::new(),
            2 => "; write (0.5) behind each arrow".to_owned(),
            count => format!("; write (1/{count}) behind each arrow"),
        }
    )]
    Probabilities {
        /// Whose rules: their left side, printable.
        predecessor: String,
        /// What they sum to.
        sum: f64,
        /// Another rule for it, where there are several: printable.
        another: Option<String>,
        /// How many rules there are, where none of them has a probability; else 0.
        unwritten: usize,
    },
    /// `~` before what is no organ, and never becomes one.
    #[error("{}", NoOrgan(*.found))]
    NoOrgan {
        /// The symbol; `None` at the end.
        found: Option<char>,
    },
    /// A key that may stand once stands twice.
    #[error("'{key}' was already given in line {first_line}; keep one of them")]
    Repeated {
        /// The key.
        key: &'static str,
        /// Where it stood first, from 1.
        first_line: usize,
    },
    /// Keys that must stand somewhere do not.
    #[error(
        "no line says {}; add {} like {}",
        listed(.keys.iter().map(|(key, _)| format!("'{key}=…'")), "or"),
        if .keys.len() == 1 { "one" } else { "lines" },
        listed(.keys.iter().map(|(key, like)| format!("'{key} = {like}'")), "and")
    )]
    Missing {
        /// Each with a value that it may have.
        keys: Vec<(&'static str, &'static str)>,
    },
}

impl Problem {
    pub(super) fn expected(expected: impl Into<String>, found: Option<char>) -> Self {
        Self::Expected { expected: expected.into(), found: found.map_or("the end".into(), quoted) }
    }
}

/// A character between quotes, printable.
fn quoted(symbol: char) -> String {
    format!("'{}'", printable(symbol.encode_utf8(&mut [0; 4])))
}

/// Which of a grammar's strings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrammarPart {
    /// The axiom.
    Axiom,
    /// A rule, counted from 0 in the order given.
    Rule(usize),
}

impl fmt::Display for GrammarPart {
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
    pub part: GrammarPart,
    /// Byte offset in that string (its length when something is missing at the end).
    pub offset: usize,
    /// The same place in characters, from 1.
    pub column: usize,
    /// The mistake.
    #[source]
    pub problem: Problem,
}

/// Why an L-system did not grow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LsystemError {
    /// Refused before deriving.
    #[error(
        "{} would give {} {} symbols, more than the limit of {limit}: {}",
        Derivations(*.derivations), Amount(*.symbols).precision(*.exact, *.at_least), Amount(*.symbols),
        Advice { derivations: *.derivations, fits: *.fits, otherwise: "raise symbol_limit" }
    )]
    TooManySymbols {
        /// What was asked for.
        derivations: u32,
        /// How long the string would be, or is expected to be; saturated at `u128::MAX`.
        symbols: u128,
        /// Whether `symbols` is exact, or the expectation of a stochastic system.
        exact: bool,
        /// Whether it may be more.
        at_least: bool,
        /// [`TurtleSettings::symbol_limit`](super::TurtleSettings::symbol_limit).
        limit: u64,
        /// The most derivations, fewer than asked for, that are known to stay within the limit.
        fits: Option<u32>,
    },
    /// A word that is too long to be listed with its origins.
    #[error(
        "after {} there are more than the {limit} modules that are listed with their origins: {}",
        Derivations(*.derivations),
        Advice { derivations: *.derivations, fits: *.fits, otherwise: "ask for the string alone" }
    )]
    TooManyToTrace {
        /// What was asked for.
        derivations: u32,
        /// [`MAX_TRACED`](super::MAX_TRACED).
        limit: u64,
        /// The most derivations, fewer than asked for, that are known to stay within the limit.
        fits: Option<u32>,
    },
    /// A system grew past the limit although its forecast did not.
    #[error(
        "{}after {} there are more than the limit of {limit} symbols: {}",
        seed.map(|seed| format!("with the seed {seed}, ")).unwrap_or_default(), Derivations(*.derivations),
        Advice {
            derivations: *.derivations,
            fits: *.fits,
            otherwise: if seed.is_some() { "another seed, or raise symbol_limit" } else { "raise symbol_limit" },
        }
    )]
    GrewPastLimit {
        /// What was asked for.
        derivations: u32,
        /// Whose choices, where chance has a say.
        seed: Option<u64>,
        /// [`TurtleSettings::symbol_limit`](super::TurtleSettings::symbol_limit).
        limit: u64,
        /// The most derivations that were within the limit; unknown where the string is derived depth first.
        fits: Option<u32>,
    },
    /// What went wrong with a module, and who wrote it.
    #[error("{writer}: {error}")]
    Written {
        /// The axiom or a rule.
        writer: Writer,
        /// What went wrong.
        #[source]
        error: Box<Self>,
    },
    /// A condition comes to no number.
    #[error(
        "derivation {derivation} asks its condition of {module}, where it comes to no number: ask first what it divides by, \
         as in 'x != 0 && 1/x > 3'"
    )]
    Condition {
        /// The module with its arguments.
        module: String,
        /// The step that asks.
        derivation: u32,
    },
    /// An argument that a rule computed is no number, or one that the turtle cannot take.
    #[error(
        "derivation {derivation} gives {module}: {} is not {expected}; mend the rule or use fewer derivations",
        Short(*.value)
    )]
    Value {
        /// The module with its arguments.
        module: String,
        /// The one that is wrong.
        value: f64,
        /// The step that wrote the module; 0 is the axiom.
        derivation: u32,
        /// What it should be.
        expected: String,
    },
    /// More branches or polygons open at once than [`MAX_NESTING`](super::MAX_NESTING).
    #[error(
        "after {} branches or polygons nest more than {limit} deep, which is no tree: use fewer derivations",
        Derivations(*.derivations)
    )]
    NestedTooDeeply {
        /// What was asked for.
        derivations: u32,
        /// [`MAX_NESTING`](super::MAX_NESTING).
        limit: usize,
    },
    /// The string holds no symbol that draws.
    #[error(
        "after {} the string has {}",
        Derivations(*.derivations),
        if *.has_organs {
            "polygons or organs, but no F or G outside polygons, and they need wood to stand on: begin the axiom with F(1)"
        } else {
            "no F or G outside polygons, so there is nothing to draw: use more derivations, or a rule that gives F"
        }
    )]
    NothingDrawn {
        /// What was asked for.
        derivations: u32,
        /// Whether there are polygons or organs.
        has_organs: bool,
    },
    /// `stems` plants together would be more than the limit.
    #[error(
        "{stems} stems of {} symbols each are more than the limit of {limit}: use fewer stems or derivations, \
         or raise symbol_limit", Amount(*.symbols)
    )]
    TooManyStems {
        /// [`Stems::Several`](super::Stems::Several)'s.
        stems: u32,
        /// The forecast of one.
        symbols: u128,
        /// [`TurtleSettings::symbol_limit`](super::TurtleSettings::symbol_limit).
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
        /// [`MAX_CORNERS`](linden_skeleton::organs::MAX_CORNERS).
        limit: usize,
    },
    /// What stands behind a `~` is not in the table of organs.
    #[error("{}", NoOrgan(*.found))]
    UnknownOrgan {
        /// The symbol; `None` at the end of the string.
        found: Option<char>,
    },
    /// An organ of no size, or larger than anything.
    #[error("'~{letter}' is {} segments large, but must be 0 to {most}", Short(*.size))]
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
        /// Its name in [`TurtleSettings`](super::TurtleSettings).
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

/// The axiom or a rule, as a message names it: `rule 2 (F(x) -> F(x/0))`.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Writer {
    /// The rule's place in [`Grammar::productions`]; none for the axiom.
    pub production: Option<u32>,
    /// Empty until it is known of which grammar the error is.
    shown: String,
}

impl fmt::Display for Writer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.shown)
    }
}

impl LsystemError {
    /// The same, with the production that wrote what is wrong, or the axiom.
    pub(super) fn by(self, production: Option<u32>) -> Self {
        let writer = Writer { production, shown: String::new() };
        Self::Written { writer, error: Box::new(self) }
    }

    /// The same, with the text of the rule.
    pub(super) fn of(mut self, grammar: &Grammar) -> Self {
        if let Self::Written { writer, .. } = &mut self {
            writer.shown = match writer.production {
                None => GrammarPart::Axiom.to_string(),
                Some(production) => grammar.rule_shown(production as usize),
            };
        }
        self
    }

    /// What went wrong, without who wrote it.
    pub fn cause(&self) -> &Self {
        match self {
            Self::Written { error, .. } => error,
            other => other,
        }
    }
}

/// What stands behind a `~` and names no organ, with those that there are.
struct NoOrgan(Option<char>);

impl fmt::Display for NoOrgan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = self.0.map_or("nothing".into(), quoted);
        write!(f, "'~' is followed by {found}, which names no organ; there are: ")?;
        for (i, prototype) in PROTOTYPES.iter().enumerate() {
            write!(f, "{}{} ({})", if i == 0 { "" } else { ", " }, prototype.letter, prototype.name)?;
        }
        Ok(())
    }
}

/// A number of derivations, with its noun.
struct Derivations(u32);

impl fmt::Display for Derivations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} derivation{}", self.0, if self.0 == 1 { "" } else { "s" })
    }
}

/// A count of symbols; from 10¹⁵ on with two digits and a power of ten.
struct Amount(u128);

impl Amount {
    /// From here on it is rounded.
    const ROUNDED: u128 = 1_000_000_000_000_000;

    /// How precise the count that is shown is.
    fn precision(&self, is_exact: bool, is_at_least: bool) -> &'static str {
        match self.0 {
            u128::MAX => "more than",
            _ if is_at_least => "at least",
            n if is_exact && n < Self::ROUNDED => "exactly",
            _ => "about",
        }
    }
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            u128::MAX => f.write_str("3e38"),
            n if n >= Self::ROUNDED => write!(f, "{:.1e}", n as f64),
            n => write!(f, "{n}"),
        }
    }
}

/// A number as people write it: 1e300 without its zeros.
pub(super) struct Short(pub f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number) = *self;
        if number != 0.0 && number.is_finite() && !(1e-6..1e15).contains(&number.abs()) {
            return write!(f, "{number:e}");
        }
        write!(f, "{number}")
    }
}

/// What to do about a string that is too long.
struct Advice {
    /// What was asked for.
    derivations: u32,
    /// The most that fit.
    fits: Option<u32>,
    /// What helps besides.
    otherwise: &'static str,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { derivations, fits, otherwise } = *self;
        match (derivations, fits) {
            (0, _) => write!(f, "shorten the axiom, or {otherwise}"),
            (_, Some(0)) => write!(f, "only the axiom fits; shorten the rules, or {otherwise}"),
            (_, Some(fits)) => write!(f, "use {} or fewer, or {otherwise}", Derivations(fits)),
            (_, None) => write!(f, "use fewer derivations, or {otherwise}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_messages_have_few_digits() {
        let shown =
            [1e300, -1e15, 1e-30, 0.0, -2.5, 137.5, f64::INFINITY].map(|number| Short(number).to_string());
        assert_eq!(shown, ["1e300", "-1e15", "1e-30", "0", "-2.5", "137.5", "inf"]);
        let wrong = LsystemError::OrganSize { letter: 'L', size: 1e308, most: 10.0 };
        assert_eq!(wrong.to_string(), "'~L' is 1e308 segments large, but must be 0 to 10");
        let endless = LsystemError::TooManySymbols {
            derivations: 1000,
            symbols: u128::MAX,
            exact: true,
            at_least: false,
            limit: 100,
            fits: Some(3),
        };
        let start = "1000 derivations would give more than 3e38 symbols, more than the limit of 100";
        assert!(endless.to_string().starts_with(start), "{endless}");
    }

    #[test]
    fn what_is_too_much_is_told_with_what_can_be_done() {
        let said = |derivations, symbols, fits| {
            let (exact, at_least, limit) = (true, false, 100);
            let error = LsystemError::TooManySymbols { derivations, symbols, exact, at_least, limit, fits };
            error.to_string()
        };
        let tail = "symbols, more than the limit of 100";
        for (error, message) in [
            (
                said(9, 512, Some(6)),
                format!(
                    "9 derivations would give exactly 512 {tail}: use 6 derivations or fewer, or raise symbol_limit"
                ),
            ),
            (
                said(100, 23 * 10_u128.pow(27), Some(1)),
                format!(
                    "100 derivations would give about 2.3e28 {tail}: use 1 derivation or fewer, or raise symbol_limit"
                ),
            ),
            (
                said(1, 200, Some(0)),
                format!(
                    "1 derivation would give exactly 200 {tail}: only the axiom fits; shorten the rules, or raise symbol_limit"
                ),
            ),
            (
                said(0, 200, None),
                format!(
                    "0 derivations would give exactly 200 {tail}: shorten the axiom, or raise symbol_limit"
                ),
            ),
            (
                said(1, 200, None),
                format!(
                    "1 derivation would give exactly 200 {tail}: use fewer derivations, or raise symbol_limit"
                ),
            ),
        ] {
            assert_eq!(error, message);
        }
        let grew = LsystemError::GrewPastLimit { derivations: 8, seed: Some(3), limit: 100, fits: Some(5) };
        let message = "with the seed 3, after 8 derivations there are more than the limit of 100 symbols: \
                       use 5 derivations or fewer, or another seed, or raise symbol_limit";
        assert_eq!(grew.to_string(), message);
    }
}
