//! Random grammars of the whole language against its definition.

use linden::lsystem::{Grammar, LsystemError, TurtleSettings, Way, derive_by, forecast, text};
use proptest::prelude::*;

use crate::definition::{self, Definition, Random};

fn grammar(definition: &Definition) -> Grammar {
    let (axiom, rules) = (definition::word_text(&definition.axiom), definition.rules());
    Grammar::new(&axiom, &rules).unwrap_or_else(|error| panic!("{axiom} {rules:#?}: {error}"))
}

/// Strings of the definition grow fast: only as far as one of a few thousand letters.
fn derived(definition: &Definition, derivations: u32, seed: u64) -> Option<(u32, Vec<definition::Letter>)> {
    let mut last = None;
    for step in 0..=derivations {
        let string = definition.derive(step, seed);
        let length = string.len();
        last = Some((step, string));
        if length > 400 {
            break;
        }
    }
    last.filter(|(_, string)| string.len() < 4000)
}

#[test]
fn conditions_that_are_written_otherwise_share_no_chance() {
    for (first, second) in [("-0 >= 2", "0 >= 2"), ("1 > 0", "1 > 0 + 0")] {
        let rules = [format!("A : {first} -> B"), format!("A : {second} -> C")];
        assert!(Grammar::new("A", &rules).is_ok(), "{rules:?}");
    }
    assert!(Grammar::new("A", &["A : 0 >= 2 -> B", "A : (0) >= 2 -> C"]).is_err());
}

fn compare(random: &mut Random, derivations: u32, seed: u64) -> Result<(), TestCaseError> {
    let definition = random.definition();
    let grammar = grammar(&definition);
    let Some((derivations, string)) = derived(&definition, derivations, seed) else { return Ok(()) };
    let settings = TurtleSettings { derivations, seed, ..TurtleSettings::default() };
    for way in [Way::Best, Way::BreadthFirst] {
        let derived = match derive_by(&grammar, &settings, way) {
            // What a cut takes later may be no number either: the definition has it all.
            Err(error)
                if matches!(error.cause(), LsystemError::Value { .. } | LsystemError::Condition { .. }) =>
            {
                continue;
            }
            other => other.unwrap(),
        };
        prop_assert_eq!(&derived.text, &definition::text(&string), "{}", grammar);
        // Brackets have no births in the definition.
        for (birth, letter) in derived.births.iter().zip(&string) {
            prop_assert!(matches!(letter.symbol, '[' | ']') || *birth == letter.birth, "{}", grammar);
        }
        prop_assert_eq!(derived.births.len(), string.len());
    }
    let counted = forecast(&grammar, derivations).unwrap();
    let segments = string.iter().filter(|letter| letter.symbol == 'F').count() as u128;
    let (mut depth, mut deepest) = (0_u64, 0);
    for letter in &string {
        match letter.symbol {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    if counted.exact {
        prop_assert_eq!((counted.symbols, counted.segments), (string.len() as u128, segments), "{}", grammar);
        prop_assert_eq!(counted.depth, deepest, "{}", grammar);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn every_way_agrees_with_the_definition(made: u64, derivations in 0_u32..5, seed: u64) {
        compare(&mut Random::new(made), derivations, seed)?;
    }

    #[test]
    fn systems_without_contexts_agree_with_the_definition(made: u64, derivations in 0_u32..6, seed: u64) {
        let mut random = Random::new(made);
        random.contexts = false;
        random.chance = made % 2 == 0;
        compare(&mut random, derivations, seed)?;
    }

    #[test]
    fn what_is_written_is_read_back(made: u64) {
        let grammar = grammar(&Random::new(made).definition());
        let written = text::write_grammar(&grammar);
        prop_assert_eq!(text::parse_grammar(&written), Ok(grammar), "{}", written);
    }

    /// A lower bound is one, whatever is counted to the end.
    #[test]
    fn lower_bounds_are_lower(made: u64, derivations in 0_u32..12, seed: u64) {
        let mut random = Random::new(made);
        random.chance = false;
        let mut definition = random.definition();
        for group in &mut definition.groups {
            group.alternatives.truncate(1);
            group.alternatives[0].0 = 1.0;
        }
        let grammar = grammar(&definition);
        let counted = forecast(&grammar, derivations).unwrap();
        let settings = TurtleSettings { derivations, seed, symbol_limit: 100_000, ..TurtleSettings::default() };
        if let Ok(derived) = derive_by(&grammar, &settings, Way::Best) {
            let symbols = derived.births.len() as u128;
            prop_assert!(counted.symbols <= symbols && (counted.at_least || counted.symbols == symbols), "{:?} {}", counted, grammar);
            prop_assert!(counted.segments <= derived.text.matches('F').count() as u128);
        }
    }
}
