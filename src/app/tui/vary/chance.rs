//! Whether anything in a tree is left to chance: if not, another seed gives the same tree.

use std::collections::BTreeSet;

use linden::lsystem::{Expression, Grammar, Module};
use linden::preset::{Generator, Preset, Space};

/// Whether another seed may give another skeleton. (Bark is drawn by chance too, and looks alike with
/// every seed.)
pub fn has_chance(preset: &Preset) -> bool {
    match &preset.generator {
        Generator::LSystem(lsystem) => {
            [lsystem.angle_jitter_deg, lsystem.branch_roll_deg, lsystem.length_jitter]
                .iter()
                .any(|&most| most > 0.0)
                || chooses(&lsystem.grammar, lsystem.derivations)
        }
        // Points are scattered, or at least jittered. A scan that is contracted is taken as it is.
        Generator::Colonization(colonization) => {
            !(colonization.contract && matches!(colonization.space, Space::Points { .. }))
        }
    }
}

/// Whether a derivation meets a module that may become one thing or another. Which conditions hold and
/// which contexts there are is not looked into: a choice that a rule could lead to counts.
fn chooses(grammar: &Grammar, derivations: u32) -> bool {
    // A module with an argument is another one than the bare symbol.
    let class = |module: &Module| (module.symbol, module.arguments.len());
    let rules = |(symbol, arity): (char, usize)| {
        grammar.productions().iter().filter(move |rule| {
            let matched = &rule.predecessor;
            (matched.symbol, matched.parameters.len()) == (symbol, arity) && rule.probability > 0.0
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
    use std::sync::Arc;

    use linden::Quiet;
    use linden::grow::grow;
    use linden::recipe::Recipe;

    use super::*;

    #[test]
    fn trees_without_chance_are_the_same_from_every_seed_and_others_are_not() {
        let mut counts = [0; 2];
        for builtin in linden::preset::builtins() {
            let preset = builtin.load().unwrap();
            if !preset.files().is_empty() {
                continue;
            }
            let grown = |seed| {
                let mut preset = preset.clone();
                preset.seed = seed;
                Arc::clone(&grow(&Recipe::new(preset), &Quiet).unwrap().skeleton)
            };
            let first = grown(1);
            let differs = (2..6).any(|seed| grown(seed).positions != first.positions);
            assert_eq!(has_chance(&preset), differs, "{}", builtin.id);
            counts[usize::from(differs)] += 1;
        }
        assert!(counts[0] > 3 && counts[1] > 3, "{counts:?}");
    }

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
