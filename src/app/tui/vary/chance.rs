//! Whether anything in a tree is left to chance: if not, another seed gives the same tree.

use std::collections::BTreeSet;

use linden::lsystem::Grammar;
use linden::preset::{Generator, Preset, Space};

/// Whether another seed may give another skeleton. (Bark is drawn by chance too, and looks alike with
/// every seed.)
pub fn has_chance(preset: &Preset) -> bool {
    match &preset.generator {
        Generator::LSystem(own) => chooses(&own.grammar, own.derivations),
        // Points are scattered, or at least jittered. A scan that is contracted is taken as it is.
        Generator::Colonization(own) => !(own.contract && matches!(own.space, Space::Points { .. })),
    }
}

/// Whether a derivation meets a symbol that may become one thing or another.
fn chooses(grammar: &Grammar, derivations: u32) -> bool {
    let rewritten = |symbol: char| {
        grammar
            .productions()
            .iter()
            .filter(move |rule| rule.predecessor.symbol == symbol && rule.probability > 0.0)
    };
    // A module with an argument is another one than the bare symbol, and is kept.
    let bare = |modules: &[linden::lsystem::Module]| -> Vec<char> {
        modules.iter().filter(|module| module.arguments.is_empty()).map(|module| module.symbol).collect()
    };
    let mut seen: BTreeSet<char> = BTreeSet::new();
    let mut front = bare(grammar.axiom());
    for _ in 0..derivations {
        front.retain(|symbol| seen.insert(*symbol));
        if front.is_empty() {
            return false;
        }
        if front.iter().any(|&symbol| rewritten(symbol).nth(1).is_some()) {
            return true;
        }
        front = front
            .iter()
            .flat_map(|&symbol| rewritten(symbol))
            .flat_map(|rule| bare(&rule.successor))
            .collect();
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
            if preset.space().is_some_and(|space| space.file().is_some()) {
                continue;
            }
            let grown = |seed| {
                let mut preset = preset.clone();
                preset.seed = seed;
                Arc::clone(&grow(&Recipe { preset, inputs: Vec::new() }, &Quiet).unwrap().skeleton)
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
