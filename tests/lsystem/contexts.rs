//! Rules that look at what stands around a module (ABOP, section 1.8).

use linden::lsystem::{Grammar, TurtleSettings, Way, derive_by, derive_string, forecast};

fn derived(axiom: &str, rules: &[&str], derivations: u32) -> String {
    let grammar = Grammar::new(axiom, rules).unwrap();
    let settings = TurtleSettings { derivations, ..TurtleSettings::default() };
    derive_by(&grammar, &settings, Way::Best).unwrap().text
}

#[test]
fn abops_example_is_found_across_branches() {
    let rule = "BC < S > G[H]M -> X";
    assert_eq!(derived("ABC[DE][SG[HI[JK]L]MNO]", &[rule], 1), "ABC[DE][XG[HI[JK]L]MNO]");
    // Each part of the context counts.
    for other in
        ["AB[DE][SG[HI[JK]L]MNO]", "ABC[DE][SG[I[JK]L]MNO]", "ABC[DE][SG[HI[JK]L]NO]", "ABC[DE]S[G[H]M]"]
    {
        assert_eq!(derived(other, &[rule], 1), other);
    }
}

#[test]
fn signals_run_up_and_down() {
    // ABOP, p. 31: a signal b moves along a string of a.
    let rules = ["b < a -> b", "b -> a"];
    for (step, text) in ["baaaaaaaa", "abaaaaaaa", "aabaaaaaa", "aaabaaaaa", "aaaabaaaa"].iter().enumerate() {
        assert_eq!(derived("baaaaaaaa", &rules, step as u32), *text);
    }
    // ABOP, Fig. 1.30 a and b: up into every branch, down along the axis only.
    let up = ["#ignore +-", "J < I -> J"];
    assert_eq!(derived("J[+I]I[-I]I[+I]I", &up, 1), "J[+J]J[-I]I[+I]I");
    assert_eq!(derived("J[+I]I[-I]I[+I]I", &up, 2), "J[+J]J[-J]J[+I]I");
    assert_eq!(derived("J[+I]I[-I]I[+I]I", &up, 3), "J[+J]J[-J]J[+J]J");
    let down = ["#ignore: +-", "I > J -> J"];
    assert_eq!(derived("I[+I]I[-I]I[+I]J", &down, 1), "I[+I]I[-I]J[+I]J");
    assert_eq!(derived("I[+I]I[-I]I[+I]J", &down, 3), "J[+I]J[-I]J[+I]J");
}

#[test]
fn branches_of_a_right_context_are_sought_in_order() {
    let rule = "A > [X][Y]B -> C";
    for (text, found) in [
        ("A[X][Y]B", true),
        ("A[Z][X][Z][Y][Z]B", true),
        ("A[Y][X]B", false),
        ("A[X]B", false),
        ("A[X][Y]", false),
        ("A[XQ[R]][Y[S]T]B", true),
        ("A[[X]][Y]B", false),
    ] {
        assert_eq!(derived(text, &[rule], 1).starts_with('C'), found, "{text}");
    }
    // A pattern within a pattern: the second branch is the one that holds both.
    assert_eq!(derived("A[P[Q]R][P[S]T]", &["A > [P[S]T] -> C"], 1), "C[P[Q]R][P[S]T]");
    assert_eq!(derived("A[P[Q][S]T]", &["A > [P[S]T] -> C"], 1), "C[P[Q][S]T]");
    // A branch has an end: nothing of its own axis follows it.
    assert_eq!(derived("[A]B", &["A > B -> C"], 1), "[A]B");
    assert_eq!(derived("B[A]", &["B < A -> C"], 1), "B[C]");
}

#[test]
fn ignored_symbols_are_passed_over_and_others_are_not() {
    assert_eq!(derived("A+F-B", &["#ignore +-F", "A < B -> C"], 1), "A+F-C");
    assert_eq!(derived("A+F-B", &["#ignore +-", "A < B -> C"], 1), "A+F-B");
    assert_eq!(derived("A+[-X]B", &["#ignore +", "#ignore -", "A > [X]B -> C"], 1), "C+[-X]B");
    // An ignored symbol may be rewritten.
    assert_eq!(derived("A+B", &["#ignore +", "A < + > B -> -"], 1), "A-B");
}

/// A second at most, where each looking through all that follow it would take many minutes.
#[test]
fn long_rows_of_ignored_symbols_are_passed_over_at_once() {
    let axiom = format!("A{}[B]", "x".repeat(1_000_000));
    let rewritten = derived(&axiom, &["#ignore x", "x > [B] -> y", "A > [C] -> D"], 1);
    assert_eq!(rewritten, format!("A{}[B]", "y".repeat(1_000_000)));
}

#[test]
fn contexts_bind_parameters() {
    let rules = ["A(x) < B(y) > C(z)[D(u)] : x+y+z+u > 9 -> S(x,y,z,u)"];
    assert_eq!(derived("A(1)B(2)C(3)[D(4)]", &rules, 1), "A(1)S(1,2,3,4)C(3)[D(4)]");
    assert_eq!(derived("A(1)B(2)C(3)[D(3)]", &rules, 1), "A(1)B(2)C(3)[D(3)]");
    // Diffusion: every cell becomes the mean of itself and its neighbours.
    let rules = ["M(a) < M(x) > M(b) -> M((a+x+b)/3)"];
    assert_eq!(derived("M(0)M(3)M(0)M(0)", &rules, 1), "M(0)M(1)M(1)M(0)");
}

/// What neighbours become is computed together, but where something is left to chance.
#[test]
fn neighbours_are_computed_as_each_alone() {
    let axiom = (0..100).map(|cell| format!("M({})", cell * cell % 17)).collect::<Vec<_>>().concat();
    let rules =
        ["M(a) < M(x) > M(b) -> M((a+x+b)/3)N(x-a,-b)", "N(p,q) < M(x) > N(r,s) -> M(min(x,p)+r*s)F(x-q)"];
    let chance = [&rules[..], &["Z -> (0.5) Z", "Z -> (0.5) ZZ"]].concat();
    for derivations in 1..=4 {
        assert_eq!(derived(&axiom, &rules, derivations), derived(&axiom, &chance, derivations));
    }
}

#[test]
fn the_first_neighbour_that_gets_no_number_is_named() {
    let axiom = (0..30).map(|cell| format!("M({cell})")).collect::<Vec<_>>().concat();
    let grammar = Grammar::new(&axiom, &["M(a) < M(x) -> M(1/((x-7)*(12-x)))N(a/(x-9))"]).unwrap();
    let error = |derivations| {
        let settings = TurtleSettings { derivations, ..TurtleSettings::default() };
        derive_string(&grammar, &settings).unwrap_err().to_string()
    };
    assert!(error(1).contains("gives M(inf)"), "{}", error(1));
    assert!(error(2).contains("derivation 1 gives M(inf)"), "{}", error(2));
    let grammar = Grammar::new(&axiom, &["M(a) < M(x) -> M(1/((x-7)*(12-x)))N(a/(x-5))"]).unwrap();
    let settings = TurtleSettings { derivations: 2, ..TurtleSettings::default() };
    let error = derive_string(&grammar, &settings).unwrap_err().to_string();
    assert!(error.contains("derivation 1 gives N(inf)"), "{error}");
}

#[test]
fn rules_with_contexts_come_first() {
    // Though written last.
    assert_eq!(derived("bab", &["a -> x", "b < a -> y"], 1), "byb");
    assert_eq!(derived("cab", &["a -> x", "b < a -> y"], 1), "cxb");
}

#[test]
fn anabaena_keeps_its_heterocysts_apart() {
    // ABOP, section 1.8 has no table of steps; by hand: a vegetative cell next to a heterocyst divides.
    let rules = ["H < v -> vw", "w -> v"];
    assert_eq!(derived("HvvH", &rules, 1), "HvwvH");
    assert_eq!(derived("HvvH", &rules, 2), "HvwvvH");
}

#[test]
fn a_cut_takes_the_rest_of_its_branch_in_every_way() {
    let rules = ["A > B -> C%D", "B -> E"];
    assert_eq!(derived("[AB[X]Y]Z", &rules, 1), "[C]Z");
    assert_eq!(derived("[AB[X]Y]Z", &rules, 2), "[C]Z");
    assert_eq!(derived("AB", &rules, 3), "C");
}

#[test]
fn threads_do_not_matter() {
    // Long enough for many chunks.
    let rules = [
        "#ignore +",
        "A(a) < A(x) > A(b) -> (0.5) A(x+ran(1))A(a)",
        "A(a) < A(x) > A(b) -> (0.5) A(b)[+A(x)]A(1)",
    ];
    let grammar = Grammar::new("A(1)A(2)A(3)A(4)A(5)", &rules).unwrap();
    let settings = TurtleSettings { derivations: 15, symbol_limit: 3_000_000, ..TurtleSettings::default() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| derive_by(&grammar, &settings, Way::Best).unwrap())
    };
    let one = on(1);
    assert!(one.births.len() > 20_000, "{}", one.births.len());
    assert!(on(2) == one && on(8) == one);
}

#[test]
fn forecasts_of_contexts_are_exact_as_far_as_they_go() {
    let grammar = Grammar::new("baaaF", &["b < a -> b", "b -> a"]).unwrap();
    let counted = forecast(&grammar, 3).unwrap();
    assert_eq!((counted.symbols, counted.segments, counted.exact, counted.at_least), (5, 1, true, false));
    let grammar = Grammar::new("FA", &["F < A -> FAA", "A < A -> FA"]).unwrap();
    let counted = forecast(&grammar, 100).unwrap();
    assert!(counted.at_least && !counted.exact && counted.symbols > 100, "{counted:?}");
}
