//! Derivation and turtle: ABOP's Fig. 1.24 a after 8 steps, 976 561 symbols and 390 625 segments.
//!
//! `cargo bench -p linden-tests --bench lsystem`. Beside linden stand what a program writes first
//! (whole strings through a map, then the turtle) and the crate symbios with its 3D turtle; the same
//! run on the same machine gives the ratios.
#![expect(clippy::expect_used, reason = "a benchmark that cannot run stops")]

use divan::counter::ItemsCount;
use linden::lsystem::{Grammar, Settings, derive_string, forecast, grow};
use linden::{DVec3, NO_PARENT, Quiet};

const RULE: &str = "F[+F]F[-F]F";
const DERIVATIONS: u32 = 8;
const SYMBOLS: u64 = 976_561;
const ANGLE_DEG: f64 = 25.7;

fn main() {
    divan::main();
}

fn weed() -> (Grammar, Settings) {
    let grammar = Grammar::new("F", &[format!("F -> {RULE}")]).expect("the rule is ABOP's");
    let settings =
        Settings { derivations: DERIVATIONS, angle_deg: ANGLE_DEG, segment_m: 0.02, ..Settings::default() };
    (grammar, settings)
}

#[divan::bench(name = "grow: linden")]
fn grow_linden(bencher: divan::Bencher) {
    let (grammar, settings) = weed();
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(|| {
        let grown = grow(&grammar, &settings, &Quiet).expect("it is within the limit");
        assert_eq!(grown.symbols, SYMBOLS);
        grown
    });
}

#[divan::bench(name = "grow: linden, stochastic (ABOP 1.27, 10 steps)")]
fn grow_stochastic(bencher: divan::Bencher) {
    let rules = ["F -> (0.33) F[+F]F[-F]F", "F -> (0.33) F[+F]F", "F -> (0.34) F[-F]F"];
    let grammar = Grammar::new("F", &rules).expect("the rules are ABOP's");
    let settings = Settings { derivations: 10, ..Settings::default() };
    let symbols = grow(&grammar, &settings, &Quiet).expect("it is within the limit").symbols;
    bencher.counter(ItemsCount::new(symbols)).bench(|| grow(&grammar, &settings, &Quiet));
}

#[divan::bench(name = "grow: naive strings")]
fn grow_naive(bencher: divan::Bencher) {
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(|| {
        let string = naive_string();
        assert_eq!(string.len() as u64, SYMBOLS);
        naive_turtle(&string)
    });
}

#[divan::bench(name = "grow: symbios")]
fn grow_symbios(bencher: divan::Bencher) {
    use symbios_turtle_3d::{TurtleConfig, TurtleInterpreter};
    let config = TurtleConfig {
        default_step: 0.02,
        default_angle: (ANGLE_DEG as f32).to_radians(),
        ..TurtleConfig::default()
    };
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(|| {
        let source = "omega: F\nF -> F [ + F ] F [ - F ] F";
        let mut system = symbios::System::from_source(source).expect("the rule is ABOP's");
        system.derive(DERIVATIONS as usize).expect("it is within the limit");
        assert_eq!(system.state.len() as u64, SYMBOLS);
        let mut turtle = TurtleInterpreter::new(config.clone());
        turtle.populate_standard_symbols(&system.interner);
        let skeleton = turtle.build_skeleton(&system.state);
        assert!(skeleton.strands.len() > 100_000);
        skeleton
    });
}

#[divan::bench(name = "derive: linden, as a string")]
fn derive_linden(bencher: divan::Bencher) {
    let (grammar, settings) = weed();
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(|| derive_string(&grammar, &settings));
}

#[divan::bench(name = "derive: naive strings")]
fn derive_naive(bencher: divan::Bencher) {
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(naive_string);
}

#[divan::bench(name = "forecast: ABOP f", args = [5, 10_000])]
fn forecast_abop(bencher: divan::Bencher, derivations: u32) {
    let grammar = Grammar::new("X", &["X -> F-[[X]+X]+F[+FX]-X", "F -> FF"]).expect("the rules are ABOP's");
    bencher.bench(|| forecast(&grammar, derivations));
}

/// Grows by a few symbols a step, so that nothing saturates: the slowest kind of forecast.
#[divan::bench(name = "forecast: linear growth", args = [10_000])]
fn forecast_linear(bencher: divan::Bencher, derivations: u32) {
    let grammar = Grammar::new("A", &["A -> F[+L]B", "B -> F[-L]A", "L -> FFL"]).expect("it is balanced");
    bencher.bench(|| forecast(&grammar, derivations));
}

/// What a program writes first.
fn naive_string() -> String {
    let rules = std::collections::HashMap::from([('F', RULE)]);
    let mut string = "F".to_owned();
    for _ in 0..DERIVATIONS {
        let mut next = String::new();
        for symbol in string.chars() {
            match rules.get(&symbol) {
                Some(successor) => next.push_str(successor),
                None => next.push(symbol),
            }
        }
        string = next;
    }
    string
}

fn naive_turtle(string: &str) -> Vec<(DVec3, u32)> {
    let mut nodes = vec![(DVec3::ZERO, NO_PARENT)];
    let mut stack = Vec::new();
    let mut state = (DVec3::ZERO, DVec3::Y, DVec3::NEG_X, 0_u32);
    for symbol in string.chars() {
        let (position, heading, left, node) = &mut state;
        match symbol {
            'F' => {
                *position += *heading * 0.02;
                nodes.push((*position, *node));
                *node = nodes.len() as u32 - 1;
            }
            '[' => stack.push(state),
            ']' => state = stack.pop().expect("the rule is balanced"),
            '+' | '-' => {
                let angle = if symbol == '+' { ANGLE_DEG } else { -ANGLE_DEG };
                let (sin, cos) = libm::sincos(angle.to_radians());
                (*heading, *left) = (*heading * cos + *left * sin, *left * cos - *heading * sin);
            }
            _ => {}
        }
    }
    nodes
}
