//! A grammar: the axiom and the productions, as they were written.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

use super::error::{GrammarError, Part, Problem};
use super::parse;

/// How far the probabilities of one predecessor may be from 1 in sum: what thirds written with six
/// decimals need, and a hair for the rounding of the sum.
const PROBABILITY_TOLERANCE: f64 = 1e-6 + 1e-12;

/// A stochastic or deterministic bracketed 0L-system.
///
/// Valid by construction: the axiom is not empty, brackets balance in the axiom and in every
/// successor, and the probabilities of each predecessor sum to 1 within 10⁻⁶.
///
/// ```
/// let grammar = linden::lsystem::Grammar::new("X", &["X -> F[+X]F[-X]+X", "F -> FF"])?;
/// assert_eq!(grammar.to_string(), "X\nX -> F[+X]F[-X]+X\nF -> FF\n");
///
/// let error = linden::lsystem::Grammar::new("F", &["F -> F[+F"]).unwrap_err();
/// assert_eq!(error.to_string(), "rule 1, column 7: '[' opens a branch that is never closed");
/// # Ok::<(), linden::lsystem::GrammarError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grammar {
    axiom: Vec<Module>,
    productions: Vec<Production>,
}

/// A symbol with its arguments: one letter of the derived string.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Module {
    /// The symbol, one character.
    pub symbol: char,
    /// What stands in brackets after it. Today at most one number, on symbols of the turtle: degrees
    /// for a rotation, lengths in segments for `F`, `G` and `f`.
    pub arguments: Vec<Expression>,
}

/// An argument.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Expression {
    /// A number as it stands.
    Number(f64),
}

/// A rule: what may become of one symbol in one derivation step.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Production {
    /// What is rewritten.
    pub predecessor: Predecessor,
    /// 0 to 1; a production with probability 0 is never chosen.
    pub probability: f64,
    /// What it is rewritten to; may be empty.
    pub successor: Vec<Module>,
}

/// What a production matches. A module with an argument is another module than the bare symbol, as
/// in ABOP: `F -> FF` rewrites `F`, and leaves `F(2)` alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Predecessor {
    /// The symbol.
    pub symbol: char,
}

impl Grammar {
    /// Reads an axiom and rules such as `F -> F[+F]F`.
    ///
    /// A rule is a symbol, an arrow (`->`, `→` or `=`), a probability in brackets when it is not 1
    /// (`F -> (0.33) F[+F]F`), and the successor. Blanks count for nothing. Several rules for one
    /// symbol make the system stochastic; symbols without a rule are kept.
    ///
    /// # Errors
    /// The first thing that cannot be understood, with its place.
    pub fn new<R: AsRef<str>>(axiom: &str, rules: &[R]) -> Result<Self, GrammarError> {
        let modules = parse::axiom(axiom).map_err(|e| e.within(Part::Axiom, axiom))?;
        let productions = rules
            .iter()
            .map(AsRef::as_ref)
            .enumerate()
            .map(|(i, rule)| parse::rule(rule).map_err(|e| e.within(Part::Rule(i), rule)))
            .collect::<Result<Vec<_>, _>>()?;
        check_probabilities(&productions)?;
        Ok(Self { axiom: modules, productions })
    }

    /// The string before the first derivation step; not empty.
    pub fn axiom(&self) -> &[Module] {
        &self.axiom
    }

    /// The rules, in the order given.
    pub fn productions(&self) -> &[Production] {
        &self.productions
    }
}

fn check_probabilities(productions: &[Production]) -> Result<(), GrammarError> {
    let mut sums: BTreeMap<char, (usize, f64)> = BTreeMap::new();
    for (i, production) in productions.iter().enumerate() {
        sums.entry(production.predecessor.symbol).or_insert((i, 0.0)).1 += production.probability;
    }
    let wrong = sums
        .into_iter()
        .filter(|&(_, (_, sum))| (sum - 1.0).abs() > PROBABILITY_TOLERANCE)
        .min_by_key(|&(_, (first, _))| first);
    match wrong {
        None => Ok(()),
        Some((predecessor, (first, sum))) => Err(GrammarError {
            part: Part::Rule(first),
            offset: 0,
            column: 1,
            problem: Problem::Probabilities { predecessor, sum },
        }),
    }
}

impl fmt::Display for Grammar {
    /// The axiom and the rules, a line each, as [`Grammar::new`] reads them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.axiom.iter().try_for_each(|module| module.fmt(f))?;
        f.write_char('\n')?;
        self.productions.iter().try_for_each(|production| writeln!(f, "{production}"))
    }
}

impl fmt::Display for Production {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -> ", self.predecessor.symbol)?;
        if self.probability != 1.0 {
            write!(f, "({}) ", self.probability)?;
        }
        self.successor.iter().try_for_each(|module| module.fmt(f))
    }
}

impl fmt::Display for Module {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char(self.symbol)?;
        for (i, Expression::Number(number)) in self.arguments.iter().enumerate() {
            write!(f, "{}{number}", if i == 0 { '(' } else { ',' })?;
        }
        if self.arguments.is_empty() { Ok(()) } else { f.write_char(')') }
    }
}
