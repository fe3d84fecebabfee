//! A grammar: the axiom, the productions and the directives, as they were written.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

use linden_base::knob::excerpt;

use super::error::GrammarPart;
pub use super::expression::Expression;

/// A bracketed L-system: deterministic or stochastic, with or without parameters, conditions and
/// contexts (ABOP, sections 1.6 to 1.10).
///
/// Valid by construction: the axiom is not empty, brackets balance in the axiom and in every
/// successor, every name is known, and the probabilities of rules for the same predecessor, contexts
/// and condition sum to 1 within 10⁻⁶.
///
/// ```
/// let grammar = linden_lsystem::Grammar::new("X", &["X -> F[+X]F[-X]+X", "F -> FF"])?;
/// assert_eq!(grammar.to_string(), "X\nX -> F[+X]F[-X]+X\nF -> FF\n");
///
/// let error = linden_lsystem::Grammar::new("F", &["F -> F[+F"]).unwrap_err();
/// assert_eq!(error.to_string(), "rule 1, column 7: '[' opens a branch that is never closed");
/// # Ok::<(), linden_lsystem::GrammarError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grammar {
    pub(super) axiom: Vec<Module>,
    pub(super) definitions: Vec<Definition>,
    pub(super) ignored: Vec<char>,
    pub(super) productions: Vec<Production>,
}

/// A symbol with its arguments: one letter of the derived string.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Module {
    /// The symbol, one character.
    pub symbol: char,
    /// What stands in brackets after it. On symbols of the turtle the first is what the turtle
    /// reads: degrees for a rotation, lengths in segments for `F`, `G` and `f`.
    pub arguments: Vec<Expression>,
}

/// A constant: `#define name value`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Definition {
    /// Letters, digits and `_`.
    pub name: String,
    /// Of numbers and of names defined before.
    pub value: Expression,
}

/// A rule: what may become of one symbol in one derivation step.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Production {
    /// What must stand before it on the way to the root, nearest last; empty for anything.
    pub left: Vec<Pattern>,
    /// What is rewritten.
    pub predecessor: Pattern,
    /// What must stand behind it, brackets included; empty for anything.
    pub right: Vec<Pattern>,
    /// What must hold for its parameters.
    pub condition: Option<Expression>,
    /// 0 to 1; a production with probability 0 is never chosen.
    pub probability: f64,
    /// The probability where it was not written as a number.
    pub(super) written_probability: Option<Expression>,
    /// What it is rewritten to; may be empty.
    pub successor: Vec<Module>,
}

/// What a production matches: a symbol and a number of arguments. A module with an argument is another
/// module than the bare symbol, as in ABOP: `F -> FF` rewrites `F`, and leaves `F(2)` alone.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Pattern {
    /// The symbol; in a right context also `[` and `]`.
    pub symbol: char,
    /// What the rule calls the arguments.
    pub parameters: Vec<String>,
}

impl Pattern {
    /// The symbol and the number of arguments.
    pub(super) fn class(&self) -> (char, usize) {
        (self.symbol, self.parameters.len())
    }
}

impl Production {
    /// Whether another production shares out its probability with this one: the same predecessor in
    /// the same contexts under the same condition, whatever the parameters are called.
    pub(super) fn competes_with(&self, other: &Self) -> bool {
        let same =
            |a: &[Pattern], b: &[Pattern]| a.iter().map(Pattern::class).eq(b.iter().map(Pattern::class));
        self.predecessor.class() == other.predecessor.class()
            && same(&self.left, &other.left)
            && same(&self.right, &other.right)
            && match (&self.condition, &other.condition) {
                (None, None) => true,
                (Some(a), Some(b)) => a.is_same(b),
                _ => false,
            }
    }

    /// The left side of the arrow.
    pub(super) fn head(&self) -> String {
        let mut text = String::new();
        for pattern in &self.left {
            let _ = write!(text, "{pattern}");
        }
        if !self.left.is_empty() {
            text.push_str(" < ");
        }
        let _ = write!(text, "{}", self.predecessor);
        if !self.right.is_empty() {
            text.push_str(" > ");
        }
        for pattern in &self.right {
            let _ = write!(text, "{pattern}");
        }
        if let Some(condition) = &self.condition {
            let _ = write!(text, " : {condition}");
        }
        text
    }
}

impl Grammar {
    /// The string before the first derivation step; not empty.
    pub fn axiom(&self) -> &[Module] {
        &self.axiom
    }

    /// The constants, in the order given.
    pub fn definitions(&self) -> &[Definition] {
        &self.definitions
    }

    /// The symbols that contexts pass over.
    pub fn ignored(&self) -> &[char] {
        &self.ignored
    }

    /// The rules, in the order given.
    pub fn productions(&self) -> &[Production] {
        &self.productions
    }

    /// The line of a rule in this grammar as it is shown, from 1 for the axiom.
    pub fn line_of(&self, production: usize) -> usize {
        2 + self.definitions.len() + usize::from(!self.ignored.is_empty()) + production
    }

    /// A rule as messages name it, `rule 2 (F -> FF)`. It is counted as [`Grammar::new`] counts lines that begin with all
    /// directives.
    pub(super) fn rule_shown(&self, production: usize) -> String {
        let part = GrammarPart::Rule(self.line_of(production) - 2);
        match self.productions.get(production) {
            Some(rule) => format!("{part} ({})", excerpt(rule.to_string().trim_end())),
            None => part.to_string(),
        }
    }
}

/// The productions that share out their probability, in the order of their first ones.
pub(super) fn groups(productions: &[Production]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    // By predecessor, so that a thousand rules for a thousand symbols are not compared with each other.
    let mut of_class: BTreeMap<(char, usize), Vec<usize>> = BTreeMap::new();
    for (i, production) in productions.iter().enumerate() {
        let known = of_class.entry(production.predecessor.class()).or_default();
        let found = known.iter().find(|&&group| production.competes_with(&productions[groups[group][0]]));
        match found {
            Some(&group) => groups[group].push(i),
            None => {
                known.push(groups.len());
                groups.push(vec![i]);
            }
        }
    }
    groups
}

impl fmt::Display for Grammar {
    /// The axiom, the directives and the rules, a line each, as [`Grammar::new`] reads them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.axiom.iter().try_for_each(|module| module.fmt(f))?;
        f.write_char('\n')?;
        self.definitions.iter().try_for_each(|definition| writeln!(f, "{definition}"))?;
        if !self.ignored.is_empty() {
            writeln!(f, "#ignore {}", self.ignored.iter().collect::<String>())?;
        }
        self.productions.iter().try_for_each(|production| writeln!(f, "{production}"))
    }
}

impl fmt::Display for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#define {} {}", self.name, self.value)
    }
}

impl fmt::Display for Production {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -> ", self.head())?;
        match &self.written_probability {
            Some(written) => write!(f, "({written}) ")?,
            None if self.probability != 1.0 => write!(f, "({}) ", self.probability)?,
            None => {}
        }
        self.successor.iter().try_for_each(|module| module.fmt(f))
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char(self.symbol)?;
        if self.parameters.is_empty() { Ok(()) } else { write!(f, "({})", self.parameters.join(",")) }
    }
}

impl fmt::Display for Module {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char(self.symbol)?;
        for (i, argument) in self.arguments.iter().enumerate() {
            write!(f, "{}{argument}", if i == 0 { '(' } else { ',' })?;
        }
        if self.arguments.is_empty() { Ok(()) } else { f.write_char(')') }
    }
}
