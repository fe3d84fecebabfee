//! Whether anything in a derivation is left to chance.

use std::collections::BTreeSet;

use crate::{Expression, Grammar, Module};

/// Whether a derivation meets a module that may become one thing or another. Which conditions hold and
/// which contexts there are is not looked into: a choice that a rule could lead to counts.
pub(crate) fn chooses(grammar: &Grammar, derivations: u32) -> bool {
    // A module with an argument is another one than the bare symbol.
    let class = |module: &Module| (module.symbol, module.arguments.len());
    let rules = |(symbol, arity): (char, usize)| {
        grammar.productions().iter().filter(move |rule| {
            let pattern = &rule.predecessor;
            (pattern.symbol, pattern.parameters.len()) == (symbol, arity) && rule.probability > 0.0
        })
    };
    let random = |modules: &[Module]| modules.iter().any(|m| m.arguments.iter().any(Expression::is_random));
    let mut seen: BTreeSet<(char, usize)> = BTreeSet::new();
    let mut front: Vec<_> = grammar.axiom().iter().map(class).collect();
    if random(grammar.axiom()) {
        return true;
    }
    for _ in 0..derivations {
        front.retain(|class| seen.insert(*class));
        if front.is_empty() {
            return false;
        }
        let met = || front.iter().flat_map(|&class| rules(class));
        if met().any(|rule| {
            // Less than 1 and not never: there are others.
            rule.probability < 1.0 - 1e-6
                || random(&rule.successor)
                || rule.condition.as_ref().is_some_and(Expression::is_random)
        }) {
            return true;
        }
        front = met().flat_map(|rule| &rule.successor).map(class).collect();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_that_is_never_met_does_not_count() {
        let of = |axiom: &str, rules: &[&str], derivations| {
            chooses(&Grammar::new(axiom, rules).unwrap(), derivations)
        };
        let rules = ["A -> FB", "B -> (0.5) F", "B -> (0.5) [+F]", "C -> (1) F", "C -> (0) FF"];
        assert!(of("A", &rules, 2));
        assert!(!of("A", &rules, 1), "B is there after one step and not rewritten");
        assert!(!of("B", &rules, 0));
        assert!(!of("C", &rules, 9), "a rule that is never chosen");
        assert!(!of("F", &rules, 9), "out of reach");
    }
}
