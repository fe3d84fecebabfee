//! Stochastic systems: keyed choices.

use linden::lsystem::{Grammar, TurtleSettings, derive_string, forecast, grow};
use linden::{Branching, Quiet};

use crate::naive::{self, Rules};

/// ABOP, Fig. 1.27.
fn chance_weed() -> (Rules, Grammar) {
    let list = [(0.33, "F[+F]F[-F]F"), (0.33, "F[+F]F"), (0.34, "F[-F]F")];
    let rules: Rules = [('F', list.map(|(p, s)| (p, s.to_owned())).to_vec())].into();
    let grammar = Grammar::new("F", &naive::written(&rules)).unwrap();
    (rules, grammar)
}

fn settings(derivations: u32, seed: u64) -> TurtleSettings {
    TurtleSettings { derivations, seed, ..TurtleSettings::default() }
}

#[test]
fn depth_first_chooses_what_breadth_first_chooses() {
    let (rules, grammar) = chance_weed();
    for seed in 0..20 {
        let settings = settings(5, seed);
        let string = naive::derive("F", &rules, &settings);
        assert_eq!(derive_string(&grammar, &settings).unwrap(), naive::text(&string));
        let grown = grow(&grammar, &settings, &Quiet).unwrap();
        assert_eq!(grown.symbols, string.len() as u64);
        assert_eq!(grown.branching.births, naive::draw(&string, &settings).births);
    }
}

#[test]
fn rules_are_chosen_as_often_as_they_say() {
    let grammar = Grammar::new("F", &["F -> (0.2) A", "F -> (0) B", "F -> (0.8) C"]).unwrap();
    let seeds = 10_000;
    let mut chosen = [0_u32; 3];
    for seed in 0..seeds {
        let text = derive_string(&grammar, &settings(1, seed)).unwrap();
        chosen["ABC".find(&text).unwrap()] += 1;
    }
    // 2000 expected, standard deviation 40.
    assert!((1840..2160).contains(&chosen[0]), "{chosen:?}");
    assert_eq!(chosen[1], 0);
}

#[test]
fn siblings_choose_apart_from_each_other() {
    let grammar = Grammar::new("XXXXXXXXXX", &["X -> (0.5) A", "X -> (0.5) B"]).unwrap();
    let mut heads = [0_u32; 10];
    for seed in 0..1000 {
        for (i, c) in derive_string(&grammar, &settings(1, seed)).unwrap().chars().enumerate() {
            heads[i] += u32::from(c == 'A');
        }
    }
    // 500 expected at each place, standard deviation 16; and the places are not one coin.
    assert!(heads.iter().all(|n| (420..580).contains(n)), "{heads:?}");
    let text = derive_string(&grammar, &settings(1, 3)).unwrap();
    assert!(text.contains('A') && text.contains('B'), "{text}");
}

#[test]
fn a_forecast_is_the_mean_of_many_trees() {
    let (_, grammar) = chance_weed();
    let expected = forecast(&grammar, 5).unwrap();
    // Each F gives 0.33 · 5 + 0.33 · 3 + 0.34 · 3 = 3.66 F and 3.99 other symbols: 3.66⁵ = 656.8 F,
    // and 656.8 + 3.99 · (3.66⁵ − 1) / 2.66 = 1640.4 symbols.
    assert_eq!((expected.segments, expected.symbols, expected.exact), (657, 1640, false));
    let seeds = 2000;
    let total: u64 = (0..seeds).map(|seed| grow(&grammar, &settings(5, seed), &Quiet).unwrap().symbols).sum();
    let ratio = total as f64 / seeds as f64 / expected.symbols as f64;
    // One tree's standard deviation is a third of the mean: the mean of 2000 stays within 2.5 %.
    assert!((0.975..1.025).contains(&ratio), "{ratio}");
}

#[test]
fn editing_what_the_turtle_reads_reshuffles_nothing() {
    let (rules, _) = chance_weed();
    let edited: Rules =
        [('F', rules[&'F'].iter().map(|(p, s)| (*p, s.replace('[', "![/"))).collect())].into();
    let grammar = Grammar::new("F", &naive::written(&edited)).unwrap();
    let text = derive_string(&grammar, &settings(4, 9)).unwrap();
    let (_, original) = chance_weed();
    assert_eq!(text.replace(['!', '/'], ""), derive_string(&original, &settings(4, 9)).unwrap());
}

#[test]
fn a_seed_is_one_tree_and_another_seed_another() {
    let (_, grammar) = chance_weed();
    let of = |seed| -> Branching { grow(&grammar, &settings(5, seed), &Quiet).unwrap().branching };
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}
