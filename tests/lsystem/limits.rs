//! What is refused, and what must not take long or overflow.

use std::sync::atomic::{AtomicU64, Ordering};

use linden::lsystem::{
    Grammar, LsystemError, MAX_NESTING, Stems, TurtleSettings, derive_string, forecast, grow,
};
use linden::monitor::Phase;
use linden::{Cancelled, Monitor, Quiet};

use crate::segments;

fn settings(derivations: u32) -> TurtleSettings {
    TurtleSettings { derivations, ..TurtleSettings::default() }
}

#[test]
fn an_explosion_is_refused_with_what_would_fit() {
    let grammar = Grammar::new("F", &["F -> FF"]).unwrap();
    let error = grow(&grammar, &settings(60), &Quiet).unwrap_err();
    assert_eq!(
        error,
        LsystemError::TooManySymbols {
            derivations: 60,
            symbols: 1 << 60,
            exact: true,
            at_least: false,
            limit: 50_000_000,
            fits: Some(25),
        }
    );
    assert_eq!(
        error.to_string(),
        "60 derivations would give about 1.2e18 symbols, more than the limit of 50000000: \
         use 25 derivations or fewer, or raise symbol_limit"
    );
    // What it names does fit, and one more does not.
    let small = |derivations| TurtleSettings { symbol_limit: 1000, ..settings(derivations) };
    let Err(LsystemError::TooManySymbols { fits: Some(fits), .. }) = grow(&grammar, &small(40), &Quiet)
    else {
        panic!("2^40 symbols were not refused");
    };
    assert!(grow(&grammar, &small(fits), &Quiet).is_ok());
    assert!(grow(&grammar, &small(fits + 1), &Quiet).is_err());
}

#[test]
fn forecasts_saturate() {
    let grammar = Grammar::new("F", &["F -> FF"]).unwrap();
    assert_eq!(forecast(&grammar, 127).unwrap().symbols, 1 << 127);
    assert_eq!(forecast(&grammar, 128).unwrap().symbols, u128::MAX);
    assert_eq!(forecast(&grammar, 10_000).unwrap().symbols, u128::MAX);
    let grammar = Grammar::new("F", &["F -> (0.5) FFFF", "F -> (0.5) FF"]).unwrap();
    assert_eq!(forecast(&grammar, 10_000).unwrap().symbols, u128::MAX);
    let error = grow(&grammar, &settings(10_000), &Quiet).unwrap_err();
    assert!(error.to_string().contains("would give more than 3e38 symbols"), "{error}");
}

#[test]
fn the_limit_is_a_symbol_exactly() {
    let grammar = Grammar::new("F", &["F -> F[+F]F[-F]F"]).unwrap();
    let limited = |symbol_limit| grow(&grammar, &TurtleSettings { symbol_limit, ..settings(5) }, &Quiet);
    assert_eq!(limited(7811).unwrap().symbols, 7811);
    assert!(matches!(limited(7810), Err(LsystemError::TooManySymbols { symbols: 7811, .. })));
}

#[test]
fn a_lucky_seed_is_stopped_while_it_grows() {
    // A hundred symbols are expected of the last step; one seed in ten gives a thousand.
    let grammar = Grammar::new("X", &[&format!("X -> (0.1) {}", "F".repeat(1000)), "X -> (0.9)"]).unwrap();
    let of = |seed| grow(&grammar, &TurtleSettings { seed, symbol_limit: 500, ..settings(1) }, &Quiet);
    let outcomes: Vec<_> = (0..200).map(of).collect();
    let past = |r: &&Result<_, _>| matches!(r, Err(LsystemError::GrewPastLimit { limit: 500, .. }));
    assert!((5..60).contains(&outcomes.iter().filter(past).count()));
    // The others erased themselves.
    let nothing = |r: &&Result<_, _>| matches!(r, Err(LsystemError::NothingDrawn { .. }));
    assert_eq!(outcomes.iter().filter(past).count() + outcomes.iter().filter(nothing).count(), 200);
}

#[test]
fn what_is_hardly_expected_is_drawn_when_it_comes() {
    // A third of a segment is expected, which rounds to none.
    let grammar = Grammar::new("X", &["X -> (0.33) F", "X -> (0.67)"]).unwrap();
    let of = |seed| grow(&grammar, &TurtleSettings { seed, ..settings(1) }, &Quiet);
    let drawn = (0..200).filter(|&seed| of(seed).is_ok()).count();
    assert!((40..95).contains(&drawn), "{drawn}");
}

#[test]
fn a_shrub_that_grows_past_the_limit_is_told_with_what_was_asked_for() {
    let grammar = Grammar::new("X", &[&format!("X -> (0.1) {}", "F".repeat(1000)), "X -> (0.9) F"]).unwrap();
    let habit = Stems::Several { stems: 4, lean_deg: 10.0 };
    let of = |seed| grow(&grammar, &TurtleSettings { seed, habit, symbol_limit: 500, ..settings(1) }, &Quiet);
    let past: Vec<_> = (0..100).filter_map(|seed| of(seed).err().map(|error| (seed, error))).collect();
    assert!(past.len() > 10);
    for (seed, error) in past {
        let (derivations, limit, fits) = (1, 500, None);
        assert_eq!(error, LsystemError::GrewPastLimit { derivations, seed: Some(seed), limit, fits });
    }
}

#[test]
fn a_system_with_contexts_says_how_many_derivations_were_within_the_limit() {
    // Too long for the forecast to count.
    let grammar = Grammar::new("BA", &["A -> AA", "B < A -> AA"]).unwrap();
    let of =
        |n| grow(&grammar, &TurtleSettings { symbol_limit: 1 << 17, ..settings(n) }, &Quiet).unwrap_err();
    let (seed, limit) = (None, 1 << 17);
    assert_eq!(of(20), LsystemError::GrewPastLimit { derivations: 20, seed, limit, fits: Some(16) });
    assert!(matches!(of(16), LsystemError::NothingDrawn { .. }), "what it names does fit");
}

#[test]
fn nothing_to_draw_is_an_error() {
    let nothing = |derivations| LsystemError::NothingDrawn { derivations, has_organs: false };
    let grammar = Grammar::new("X", &["X -> F[+X]"]).unwrap();
    assert_eq!(grow(&grammar, &settings(0), &Quiet), Err(nothing(0)));
    assert!(grow(&grammar, &settings(1), &Quiet).is_ok());
    let grammar = Grammar::new("F", &["F -> f"]).unwrap();
    assert_eq!(grow(&grammar, &settings(1), &Quiet), Err(nothing(1)));
}

/// More derivations never help polygons and organs that stand on nothing.
#[test]
fn organs_without_wood_are_told_what_they_need() {
    for (axiom, rules) in [("X", &["X -> {f+f+f}X"][..]), ("X", &["X -> {F+F+F}"]), ("~L", &[])] {
        let error = grow(&Grammar::new(axiom, rules).unwrap(), &settings(1), &Quiet).unwrap_err();
        assert_eq!(error, LsystemError::NothingDrawn { derivations: 1, has_organs: true }, "{axiom}");
        assert!(
            error.to_string().ends_with("they need wood to stand on: begin the axiom with F(1)"),
            "{error}"
        );
        let standing = Grammar::new(&format!("F(1){axiom}"), rules).unwrap();
        assert!(grow(&standing, &settings(1), &Quiet).is_ok(), "{axiom}");
    }
    // Before the rule that writes them there are none.
    let grammar = Grammar::new("X", &["X -> F{f+f+f}"]).unwrap();
    let nothing = LsystemError::NothingDrawn { derivations: 0, has_organs: false };
    assert_eq!(grow(&grammar, &settings(0), &Quiet), Err(nothing));
}

#[test]
fn deep_derivations_and_deep_branches_need_no_call_stack() {
    let grammar = Grammar::new("A", &["A -> F[+A]"]).unwrap();
    let grown = grow(&grammar, &settings(10_000), &Quiet).unwrap();
    assert_eq!(segments(&grown.branching), 10_000);
    assert_eq!(forecast(&grammar, 10_000).unwrap().depth, 10_000);
}

#[test]
fn absurd_nesting_is_refused() {
    let open = MAX_NESTING / 10_000 + 1;
    let rule = format!("A -> F{}A{}", "[".repeat(open), "]".repeat(open));
    let grammar = Grammar::new("A", &[rule]).unwrap();
    let error = grow(&grammar, &settings(10_000), &Quiet).unwrap_err();
    assert_eq!(error, LsystemError::NestedTooDeeply { derivations: 10_000, limit: MAX_NESTING });
    // In a stochastic system only what does happen counts.
    let rules =
        [format!("A -> (0.999999) F{}A{}", "[".repeat(open), "]".repeat(open)), "A->(0.000001)F".into()];
    let grammar = Grammar::new("A", &rules).unwrap();
    assert_eq!(grow(&grammar, &settings(10_000), &Quiet), Err(error));
    // Polygons nest as well.
    let grammar = Grammar::new::<&str>(&format!("F{}", "{".repeat(MAX_NESTING + 1)), &[]).unwrap();
    let error = grow(&grammar, &settings(0), &Quiet).unwrap_err();
    assert_eq!(error, LsystemError::NestedTooDeeply { derivations: 0, limit: MAX_NESTING });
}

#[test]
fn what_vanishes_is_not_followed() {
    // 2^31 symbols on the way to none: only the first F is left.
    let letters: Vec<char> = ('g'..='z').chain('H'..='T').collect();
    let mut rules: Vec<String> =
        letters.windows(2).map(|pair| format!("{} -> {}{}", pair[0], pair[1], pair[1])).collect();
    rules.push(format!("{} ->", letters[letters.len() - 1]));
    let grammar = Grammar::new("Fg", &rules).unwrap();
    assert_eq!(derive_string(&grammar, &settings(letters.len() as u32)).unwrap(), "F");
    let counted = forecast(&grammar, letters.len() as u32).unwrap();
    assert_eq!(counted.symbols, 1);
}

#[test]
fn settings_out_of_range_are_named() {
    let grammar = Grammar::new("F", &["F -> FF"]).unwrap();
    let good = settings(1);
    for (bad, name) in [
        (TurtleSettings { derivations: 10_001, ..good }, "derivations"),
        (TurtleSettings { angle_deg: f64::NAN, ..good }, "angle_deg"),
        (TurtleSettings { angle_deg: 361.0, ..good }, "angle_deg"),
        (TurtleSettings { segment_m: 0.0, ..good }, "segment_m"),
        (TurtleSettings { segment_m: f64::INFINITY, ..good }, "segment_m"),
        (TurtleSettings { symbol_limit: 0, ..good }, "symbol_limit"),
        (TurtleSettings { symbol_limit: u64::MAX, ..good }, "symbol_limit"),
    ] {
        let error = grow(&grammar, &bad, &Quiet).unwrap_err();
        assert!(matches!(error, LsystemError::Setting { name: n, .. } if n == name), "{error}");
    }
}

/// Cancels when it has been told of some progress.
struct Impatient {
    reports: AtomicU64,
    patience: u64,
}

impl Monitor for Impatient {
    fn is_cancelled(&self) -> bool {
        self.reports.load(Ordering::Relaxed) >= self.patience
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        assert_eq!(stage, Phase::Turtle);
        assert!(done <= total.unwrap());
        self.reports.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn growth_stops_when_nobody_wants_it() {
    let grammar = Grammar::new("F", &["F -> F[+F]F[-F]F"]).unwrap();
    let monitor = Impatient { reports: AtomicU64::new(0), patience: 3 };
    // Five million symbols: some seventy reports, were it not stopped.
    assert_eq!(grow(&grammar, &settings(9), &monitor), Err(LsystemError::Cancelled(Cancelled)));
    assert_eq!(monitor.reports.into_inner(), 3);
}
