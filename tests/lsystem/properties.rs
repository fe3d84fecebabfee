//! Random grammars against the definition.

use linden::Quiet;
use linden::lsystem::{Grammar, LsystemError, TurtleSettings, derive_string, forecast, grow, text};
use proptest::prelude::*;

use crate::assert_sound;
use crate::naive::{self, Rules};

/// Balanced strings of every symbol the turtle knows and some letters.
fn word() -> impl Strategy<Value = String> {
    let symbol = prop::sample::select(r"FFFFGfABCABC+-&^\/|$!'%".chars().collect::<Vec<_>>());
    let leaf = prop::collection::vec(symbol, 0..5).prop_map(String::from_iter);
    leaf.prop_recursive(2, 12, 3, |inner| {
        (inner.clone(), inner.clone(), inner).prop_map(|(a, b, c)| format!("{a}[{b}]{c}"))
    })
}

fn rules() -> impl Strategy<Value = Rules> {
    let alternatives = prop_oneof![
        3 => word().prop_map(|a| vec![(1.0, a)]),
        1 => (word(), word()).prop_map(|(a, b)| vec![(0.25, a), (0.75, b)]),
        1 => (word(), word(), word()).prop_map(|(a, b, c)| vec![(0.5, a), (0.0, b), (0.5, c)]),
    ];
    prop::collection::btree_map(prop::sample::select(vec!['F', 'A', 'B', 'C', '+', 'f']), alternatives, 0..4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn streaming_agrees_with_rewriting(axiom in word(), rules in rules(), derivations in 0_u32..4, seed: u64) {
        prop_assume!(!axiom.is_empty());
        let settings = TurtleSettings { derivations, seed, segment_m: 1.0, angle_deg: 33.0, ..TurtleSettings::default() };
        let grammar = Grammar::new(&axiom, &naive::written(&rules)).unwrap();
        let expected = forecast(&grammar, derivations).unwrap();
        prop_assume!(expected.symbols < 100_000);

        let string = naive::derive(&axiom, &rules, &settings);
        prop_assert_eq!(derive_string(&grammar, &settings).unwrap(), naive::text(&string));
        let drawn = naive::draw(&string, &settings);
        if expected.exact {
            prop_assert_eq!(expected.symbols, string.len() as u128);
            let count = string.iter().filter(|l| matches!(l.symbol, 'F' | 'G')).count();
            prop_assert_eq!(expected.segments, count as u128);
        }
        match grow(&grammar, &settings, &Quiet) {
            Err(LsystemError::NothingDrawn { .. }) => prop_assert!(drawn.positions.is_empty()),
            Err(error) => prop_assert!(false, "{}", error),
            Ok(grown) => {
                assert_sound(&grown);
                prop_assert_eq!(&grown.branching.parents, &drawn.parents);
                prop_assert_eq!(&grown.branching.births, &drawn.births);
                prop_assert_eq!(&grown.branching.edges, &drawn.edges);
                for (a, b) in grown.branching.positions.iter().zip(&drawn.positions) {
                    prop_assert!(a.distance(*b) < 1e-4, "{} {}", a, b);
                }
            }
        }
    }

    #[test]
    fn a_grammar_as_text_is_read_back(axiom in word(), rules in rules()) {
        prop_assume!(!axiom.is_empty());
        let grammar = Grammar::new(&axiom, &naive::written(&rules)).unwrap();
        let written = text::write_grammar(&grammar);
        prop_assert_eq!(text::parse_grammar(&written), Ok(grammar.clone()), "{}", written);
        // Comments, blank lines, other line endings and the axiom at the end change nothing.
        let (axiom, rules) = written.split_once('\n').unwrap();
        let rules = rules.replace('\n', " \r\n\n  // F -> nothing\r\n");
        prop_assert_eq!(text::parse_grammar(&format!("{rules}{axiom}")), Ok(grammar));
    }

    #[test]
    fn any_text_is_read_or_refused_with_a_place(text in r"(axiom=|angle=|number of derivations=|F=|[ -~λ\n\r→]){0,20}") {
        if let Err(error) = text::parse(&text) {
            prop_assert!(error.line >= 1 && error.column >= 1);
            prop_assert!(error.line <= text.lines().count().max(1));
        }
        if let Err(error) = text::parse_grammar(&text) {
            let line = text.lines().nth(error.line - 1).unwrap_or_default();
            prop_assert!((1..=line.chars().count() + 1).contains(&error.column), "{}: {:?}", error, line);
        }
        if let Err(error) = Grammar::new(&text, &[&text]) {
            prop_assert!(text.is_char_boundary(error.offset));
        }
    }
}
