//! Lengths and counts of the literature's figures.

use linden::Quiet;
use linden::lsystem::{Forecast, Grammar, TurtleSettings, derive_string, forecast, grow};

use crate::naive::{self, Rules};
use crate::{assert_sound, segments};

/// Derivations, axiom, rules; then length, F and `[`.
type Figure = (u32, &'static str, &'static [(char, &'static str)], [usize; 3]);

/// ABOP, Fig. 1.24 a to f; the counts follow from the growth matrices.
const FIGURE_1_24: [Figure; 6] = [
    (5, "F", &[('F', "F[+F]F[-F]F")], [7811, 3125, 1562]),
    (5, "F", &[('F', "F[+F]F[-F][F]")], [9373, 3125, 2343]),
    (4, "F", &[('F', "FF-[-F+F+F]+[+F-F-F]")], [11116, 4096, 1170]),
    (7, "X", &[('X', "F[+X]F[-X]+X"), ('F', "FF")], [13956, 4118, 2186]),
    (7, "X", &[('X', "F[+X][-X]FX"), ('F', "FF")], [12863, 4118, 2186]),
    (5, "X", &[('X', "F-[[X]+X]+F[+FX]-X"), ('F', "FF")], [6263, 1488, 1023]),
];

fn count(text: &str, symbol: char) -> usize {
    text.chars().filter(|&c| c == symbol).count()
}

#[test]
fn figure_1_24_has_the_published_counts() {
    for (derivations, axiom, rules, [length, segment_count, branches]) in FIGURE_1_24 {
        let rules: Rules = rules.iter().map(|&(p, s)| (p, vec![(1.0, s.to_owned())])).collect();
        let grammar = Grammar::new(axiom, &naive::written(&rules)).unwrap();
        let settings = TurtleSettings { derivations, ..TurtleSettings::default() };

        let text = derive_string(&grammar, &settings).unwrap();
        assert_eq!((text.len(), count(&text, 'F'), count(&text, '[')), (length, segment_count, branches));
        assert_eq!(text, naive::text(&naive::derive(axiom, &rules, &settings)));

        let Forecast { symbols, segments: expected, exact, .. } = forecast(&grammar, derivations).unwrap();
        assert_eq!((symbols, expected, exact), (length as u128, segment_count as u128, true));

        let grown = grow(&grammar, &settings, &Quiet).unwrap();
        assert_sound(&grown);
        assert_eq!((grown.symbols, segments(&grown.branching)), (length as u64, segment_count));
        // One stem: a node for each segment, and its foot.
        assert_eq!(grown.branching.positions.len(), segment_count + 1);
    }
}

#[test]
fn forecast_depth_is_the_deepest_nesting_of_the_string() {
    for (derivations, axiom, rules, _) in FIGURE_1_24 {
        let rules: Vec<String> = rules.iter().map(|(p, s)| format!("{p}={s}")).collect();
        let grammar = Grammar::new(axiom, &rules).unwrap();
        let text =
            derive_string(&grammar, &TurtleSettings { derivations, ..TurtleSettings::default() }).unwrap();
        let mut open = 0;
        let mut deepest = 0;
        for c in text.chars() {
            open += i64::from(c == '[') - i64::from(c == ']');
            deepest = deepest.max(open);
        }
        assert_eq!(forecast(&grammar, derivations).unwrap().depth, deepest as u64);
    }
}

#[test]
fn the_bush_has_216_segments_after_three_derivations() {
    let grammar = Grammar::new("F", &[r"F -> F[-\&^F][^++\&F]||F[--\&^F][+\&F]"]).unwrap();
    let settings = TurtleSettings { derivations: 3, angle_deg: 22.5, ..TurtleSettings::default() };
    assert_eq!(forecast(&grammar, 3).unwrap().segments, 216);
    let grown = grow(&grammar, &settings, &Quiet).unwrap();
    assert_sound(&grown);
    assert_eq!(segments(&grown.branching), 216);
    // It leaves the plane.
    assert!(grown.branching.positions.iter().any(|p| p.z.abs() > 0.05));
}

#[test]
fn zero_derivations_draw_the_axiom() {
    let grammar = Grammar::new("F[+F]F", &["F -> FF"]).unwrap();
    let settings = TurtleSettings { derivations: 0, ..TurtleSettings::default() };
    assert_eq!(derive_string(&grammar, &settings).unwrap(), "F[+F]F");
    let grown = grow(&grammar, &settings, &Quiet).unwrap();
    assert_eq!((grown.symbols, segments(&grown.branching)), (6, 3));
    assert_eq!(grown.branching.births, [0; 4]);
}

#[test]
fn births_are_the_steps_that_wrote_the_symbols() {
    // A -> FA lays one kept segment a step; the axiom's G is older than all.
    let grammar = Grammar::new("GA", &["A -> FA"]).unwrap();
    let grown =
        grow(&grammar, &TurtleSettings { derivations: 3, ..TurtleSettings::default() }, &Quiet).unwrap();
    assert_eq!(grown.branching.births, [0, 0, 1, 2, 3]);
    // A rule that rewrites F replaces it: all are as young as the last step.
    let grammar = Grammar::new("F", &["F -> F[+F]F"]).unwrap();
    let grown =
        grow(&grammar, &TurtleSettings { derivations: 2, ..TurtleSettings::default() }, &Quiet).unwrap();
    assert_eq!(grown.branching.births, [2; 10]);
}

#[test]
fn silent_symbols_draw_nothing() {
    let grammar = Grammar::new("XFXλ7F", &["X -> XX"]).unwrap();
    let settings = TurtleSettings { derivations: 2, ..TurtleSettings::default() };
    assert_eq!(derive_string(&grammar, &settings).unwrap(), "XXXXFXXXXλ7F");
    let grown = grow(&grammar, &settings, &Quiet).unwrap();
    assert_eq!((grown.symbols, segments(&grown.branching)), (12, 2));
}

#[test]
fn a_cut_takes_the_rest_of_its_branch() {
    // ABOP, section 3.2.
    let grammar = Grammar::new::<&str>("a[b%[cd]e[%f]]g[h[%i]j]k", &[]).unwrap();
    let settings = TurtleSettings { derivations: 1, ..TurtleSettings::default() };
    assert_eq!(derive_string(&grammar, &settings).unwrap(), "a[b]g[h[]j]k");
    // A cut that a rule writes reaches past its own word, up to the bracket.
    let grammar = Grammar::new("F[FAF[F]]F", &["A -> B", "B -> F%F"]).unwrap();
    assert_eq!(derive_string(&grammar, &settings).unwrap(), "F[FBF[F]]F");
    let settings = TurtleSettings { derivations: 2, ..settings };
    assert_eq!(derive_string(&grammar, &settings).unwrap(), "F[FF]F");
    let Forecast { symbols, segments, depth, exact, .. } = forecast(&grammar, 2).unwrap();
    assert_eq!((symbols, segments, depth, exact), (6, 4, 1, true));
}
