//! From an axiom and rules, as they are written, to a grammar.

use super::error::{GrammarError, GrammarPart, Problem};
use super::grammar::{Grammar, Production, groups};
use super::parse::{self, Directive};
use linden_base::knob::excerpt;

/// How far the probabilities of one predecessor may be from 1 in sum: what thirds written with six
/// decimals need, and a hair for the rounding of the sum.
const PROBABILITY_TOLERANCE: f64 = 1e-6 + 1e-12;

impl Grammar {
    /// Reads an axiom and rules such as `F -> F[+F]F`.
    ///
    /// A rule is `left < predecessor > right : condition -> (probability) successor`; all but the
    /// predecessor and the arrow (`->`, `→`, or `=` where there is no condition) may be missing. The
    /// predecessor and the contexts name their parameters, `A(l,w)`; conditions and arguments are
    /// [expressions](super::Expression). Rules with a context come before those without one, else the first
    /// that matches is applied; several rules with the same left side make the system stochastic.
    /// What no rule matches is kept. Blanks count for nothing.
    ///
    /// Between the rules may stand `#define name value`, a constant for every rule and for the axiom,
    /// and `#ignore symbols`, which contexts pass over.
    ///
    /// ```
    /// use linden_lsystem::{Grammar, TurtleSettings, derive_string};
    /// // ABOP, section 1.10.2: a signal of growing age, and what it turns into.
    /// let rules = ["#define old 3", "A(x) : x < old -> A(x+1)", "A(x) : x >= old -> F(x^2)"];
    /// let settings = TurtleSettings { derivations: 3, ..TurtleSettings::default() };
    /// assert_eq!(derive_string(&Grammar::new("A(1)", &rules)?, &settings)?, "F(9)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The first thing that cannot be understood, with its place: directives first, then the axiom,
    /// then the rules.
    pub fn new<R: AsRef<str>>(axiom: &str, rules: &[R]) -> Result<Self, GrammarError> {
        let mut context = parse::Context::default();
        let mut definitions = Vec::new();
        let mut ignored = Vec::new();
        let lines = || rules.iter().map(AsRef::as_ref).enumerate();
        for (i, line) in lines() {
            if !parse::is_directive(line) {
                context.rewritten.extend(parse::rewritten(line));
                continue;
            }
            match parse::directive(line, &context).map_err(|e| e.within(GrammarPart::Rule(i), line))? {
                Directive::Define(definition, value) => {
                    context.constants.push((definition.name.clone(), value));
                    definitions.push(definition);
                }
                Directive::Ignore(symbols) => ignored.extend(symbols),
            }
        }
        let modules = parse::axiom(axiom, &context).map_err(|e| e.within(GrammarPart::Axiom, axiom))?;
        let mut places = Vec::new();
        let mut productions = Vec::new();
        for (i, line) in lines().filter(|(_, line)| !parse::is_directive(line)) {
            productions.push(parse::rule(line, &context).map_err(|e| e.within(GrammarPart::Rule(i), line))?);
            places.push(i);
        }
        check_probabilities(&productions, &places)?;
        Ok(Self { axiom: modules, definitions, ignored, productions })
    }
}

/// `places` are the lines of the productions.
fn check_probabilities(productions: &[Production], places: &[usize]) -> Result<(), GrammarError> {
    for group in groups(productions) {
        let sum: f64 = group.iter().map(|&i| productions[i].probability).sum();
        if (sum - 1.0).abs() > PROBABILITY_TOLERANCE {
            let predecessor = excerpt(&productions[group[0]].head());
            return Err(GrammarError {
                part: GrammarPart::Rule(places[group[0]]),
                offset: 0,
                column: 1,
                problem: Problem::Probabilities { predecessor, sum },
            });
        }
    }
    Ok(())
}
