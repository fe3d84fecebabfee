//! Flat systems: copies placed by addition against walking, and both against the definition.

use linden::Quiet;
use linden::lsystem::{Drawn, Grammar, LsystemError, TurtleSettings, Way, grow_by};
use proptest::prelude::*;

use crate::assert_sound;
use crate::naive::{self, Rules};

/// Derivations, angle in degrees, axiom, rules.
type Figure = (u32, f64, &'static str, &'static [(char, &'static str)]);

/// ABOP, Fig. 1.24 a to f, with angles and enough derivations for many blocks.
const FIGURES: [Figure; 6] = [
    (7, 25.7, "F", &[('F', "F[+F]F[-F]F")]),
    (7, 20.0, "F", &[('F', "F[+F]F[-F][F]")]),
    (5, 22.5, "F", &[('F', "FF-[-F+F+F]+[+F-F-F]")]),
    (9, 20.0, "X", &[('X', "F[+X]F[-X]+X"), ('F', "FF")]),
    (9, 25.7, "X", &[('X', "F[+X][-X]FX"), ('F', "FF")]),
    (7, 22.5, "X", &[('X', "F-[[X]+X]+F[+FX]-X"), ('F', "FF")]),
];

fn single(rules: &[(char, &str)]) -> Rules {
    rules.iter().map(|&(symbol, successor)| (symbol, vec![(1.0, successor.to_owned())])).collect()
}

/// The same to the bit.
fn assert_same(a: &Drawn, b: &Drawn) {
    let bits = |grown: &Drawn| -> Vec<[u32; 3]> {
        grown.branching.positions.iter().map(|position| position.to_array().map(f32::to_bits)).collect()
    };
    assert!(a == b && bits(a) == bits(b), "the ways differ");
}

/// Grows by every way and on one and more threads; gives the farthest that a node is from where the
/// definition has it, in sizes of the tree.
fn compare(axiom: &str, rules: &Rules, settings: &TurtleSettings) -> Option<f64> {
    let grammar = Grammar::new(axiom, &naive::written(rules)).unwrap();
    let grown = match grow_by(&grammar, settings, Way::Best, &Quiet) {
        Err(LsystemError::NothingDrawn { .. }) => return None,
        other => other.unwrap(),
    };
    assert_sound(&grown);
    for way in [Way::Walk, Way::BreadthFirst] {
        assert_same(&grown, &grow_by(&grammar, settings, way, &Quiet).unwrap());
    }
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_same(&grown, &pool.install(|| grow_by(&grammar, settings, Way::Best, &Quiet)).unwrap());
    }
    let string = naive::derive(axiom, rules, settings);
    let drawn = naive::draw(&string, settings);
    assert_eq!(grown.symbols, string.len() as u64);
    assert_eq!(grown.branching.parents, drawn.parents);
    assert_eq!(grown.branching.births, drawn.births);
    assert_eq!(grown.branching.edges, drawn.edges);
    let size = drawn.positions.iter().map(|position| position.length()).fold(0.0, f32::max);
    let pairs = grown.branching.positions.iter().zip(&drawn.positions);
    let farthest = pairs.map(|(a, b)| a.as_dvec3().distance(b.as_dvec3())).fold(0.0, f64::max);
    Some(farthest / f64::from(size))
}

#[test]
fn the_figures_are_the_same_by_every_way() {
    for (derivations, angle_deg, axiom, rules) in FIGURES {
        let settings =
            TurtleSettings { derivations, angle_deg, segment_m: 0.02, ..TurtleSettings::default() };
        let error = compare(axiom, &single(rules), &settings).unwrap();
        assert!(error < 1e-6, "{axiom} {rules:?}: {error}");
    }
}

#[test]
fn more_blocks_than_are_kept_change_nothing() {
    // A heading of its own for nearly every subtree.
    let rules = single(&[('A', "F[+F]A-B"), ('B', "[B]+FA+"), ('C', "C+D"), ('D', "AAAA")]);
    for angle_deg in [0.01, 1.37, 359.99] {
        let settings = TurtleSettings { derivations: 16, angle_deg, ..TurtleSettings::default() };
        assert!(compare("C", &rules, &settings).unwrap() < 1e-6);
    }
}

/// Balanced strings of what flat systems know.
fn word() -> impl Strategy<Value = String> {
    let symbol = prop::sample::select("FFFGABCABC++--|".chars().collect::<Vec<_>>());
    let leaf = prop::collection::vec(symbol, 0..5).prop_map(String::from_iter);
    leaf.prop_recursive(2, 12, 3, |inner| {
        (inner.clone(), inner.clone(), inner).prop_map(|(a, b, c)| format!("{a}[{b}]{c}"))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn random_systems_are_the_same_by_every_way(
        axiom in word(),
        rules in prop::collection::btree_map(prop::sample::select(vec!['F', 'A', 'B', 'C', '+', '|']), word(), 0..5),
        angle_deg in (-36_000_i32..=36_000).prop_map(|hundredths| f64::from(hundredths) / 100.0),
        segment_m in 0.001_f64..10.0,
    ) {
        prop_assume!(!axiom.is_empty());
        let rules: Rules = rules.into_iter().map(|(symbol, successor)| (symbol, vec![(1.0, successor)])).collect();
        let grammar = Grammar::new(&axiom, &naive::written(&rules)).unwrap();
        // As many derivations as give some thousand symbols.
        let few = |n: &u32| linden::lsystem::forecast(&grammar, *n).unwrap().symbols < 8000;
        let derivations = (0..9).take_while(few).last().unwrap_or(0);
        let settings = TurtleSettings { derivations, angle_deg, segment_m, ..TurtleSettings::default() };
        if let Some(error) = compare(&axiom, &rules, &settings) {
            // A tree that coils up is small beside the way along it.
            prop_assert!(error < 1e-5, "{} {}", error, grammar);
        }
    }
}
