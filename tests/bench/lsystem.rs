//! Derivation and turtle: ABOP's Fig. 1.24 a after 8 steps, 976 561 symbols and 390 625 segments.
//!
//! `cargo bench -p linden-tests --bench lsystem`. Beside linden stand what a program writes first
//! (whole strings through a map, then the turtle) and the crate symbios with its 3D turtle; the same
//! run on the same machine gives the ratios.
#![expect(clippy::expect_used, reason = "a benchmark that cannot run stops")]

use divan::counter::ItemsCount;
use linden::lsystem::{Grammar, TurtleSettings, Way, derive_string, forecast, grow, grow_by};
use linden::skeleton::{Skeleton, Wood};
use linden::{DVec3, NO_PARENT, Quiet};

const RULE: &str = "F[+F]F[-F]F";
const DERIVATIONS: u32 = 8;
const SYMBOLS: u64 = 976_561;
const ANGLE_DEG: f64 = 25.7;

fn main() {
    divan::main();
}

fn weed() -> (Grammar, TurtleSettings) {
    let grammar = Grammar::new("F", &[format!("F -> {RULE}")]).expect("the rule is ABOP's");
    let settings = TurtleSettings {
        derivations: DERIVATIONS,
        angle_deg: ANGLE_DEG,
        segment_m: 0.02,
        ..TurtleSettings::default()
    };
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

const WAYS: [(u32, Way); 4] = [(8, Way::Best), (8, Way::Walk), (10, Way::Best), (10, Way::Walk)];

/// Placing copies of what was drawn once, and walking all of it: the same nodes.
#[divan::bench(name = "grow: linden, by macros (Best) and by walking", args = WAYS)]
fn grow_ways(bencher: divan::Bencher, (derivations, way): (u32, Way)) {
    let (grammar, settings) = weed();
    let settings = TurtleSettings { derivations, ..settings };
    let symbols = forecast(&grammar, derivations).expect("it is in range").symbols;
    bencher
        .counter(ItemsCount::new(symbols as u64))
        .bench(|| grow_by(&grammar, &settings, way, &Quiet).expect("it is within the limit"));
}

/// An angle that is no part of a circle: the turtle walks in space.
#[divan::bench(name = "grow: linden, walked in space")]
fn grow_in_space(bencher: divan::Bencher) {
    let (grammar, settings) = weed();
    let settings = TurtleSettings { angle_deg: 360.0 / 14.0, ..settings };
    bencher
        .counter(ItemsCount::new(SYMBOLS))
        .bench(|| grow(&grammar, &settings, &Quiet).expect("it is within the limit"));
}

#[divan::bench(name = "grow: linden, stochastic (ABOP 1.27, 10 steps)")]
fn grow_stochastic(bencher: divan::Bencher) {
    let rules = ["F -> (0.33) F[+F]F[-F]F", "F -> (0.33) F[+F]F", "F -> (0.34) F[-F]F"];
    let grammar = Grammar::new("F", &rules).expect("the rules are ABOP's");
    let settings = TurtleSettings { derivations: 10, ..TurtleSettings::default() };
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

/// Every kind of counting at its longest: growth so slow that nothing saturates, with chance, with
/// cuts, with conditions that need 20 or 3000 different modules, and with contexts.
const SLOW: [(&str, &str, &[&str]); 7] = [
    ("linear growth", "A", &["A -> F[+L]B", "B -> F[-L]A", "L -> FFL"]),
    ("chance", "A", &["A -> (0.5) F[+L]A", "A -> (0.5) FA", "L -> (0.1) FFL", "L -> (0.9) L"]),
    ("chance and cuts", "A", &["A -> (0.9) F[+L]A", "A -> (0.1) A%", "L -> FFL"]),
    ("counters", "A(0)", &["A(t) : t < 19 -> A(t+1)", "A(t) : t >= 19 -> F[+A(5)]A(0)"]),
    ("long counters", "A(0)", &["A(t) : t < 3000 -> A(t+1)", "A(t) : t >= 3000 -> F[+A(5)]A(0)"]),
    ("numbers without end", "A(0)", &["A(t) : t >= 0 -> F[+A(t+1)]A(t+2)"]),
    ("contexts", "FA", &["F < A -> FBA", "A < B -> F", "F > B -> FF"]),
];

#[divan::bench(name = "forecast: 10 000 derivations", args = SLOW.map(|(name, ..)| name))]
fn forecast_slow(bencher: divan::Bencher, name: &str) {
    let found = SLOW.iter().find(|(other, ..)| *other == name);
    let (_, axiom, rules) = found.expect("the arguments are the table's");
    let grammar = Grammar::new(axiom, rules).expect("the rules are balanced");
    bencher.bench(|| forecast(&grammar, 10_000));
}

/// ABOP, Fig. 2.6 a.
fn honda(derivations: u32) -> (Grammar, TurtleSettings, u64) {
    let rules = [
        "#define r1 0.9",
        "#define r2 0.6",
        "#define wr 0.707",
        "A(l,w) -> !(w)F(l)[&(45)B(l*r2,w*wr)]/(137.5)A(l*r1,w*wr)",
        "B(l,w) -> !(w)F(l)[-(45)$C(l*r2,w*wr)]C(l*r1,w*wr)",
        "C(l,w) -> !(w)F(l)[+(45)$B(l*r2,w*wr)]B(l*r1,w*wr)",
    ];
    let grammar = Grammar::new("A(1,10)", &rules).expect("the rules are ABOP's");
    let symbols = forecast(&grammar, derivations).expect("it is in range").symbols as u64;
    (grammar, TurtleSettings { derivations, symbol_limit: 1 << 30, ..TurtleSettings::default() }, symbols)
}

#[divan::bench(name = "grow: linden, parametric (ABOP 2.6 a)", args = [12, 20])]
fn grow_honda(bencher: divan::Bencher, derivations: u32) {
    let (grammar, settings, symbols) = honda(derivations);
    bencher.counter(ItemsCount::new(symbols)).bench(|| {
        let grown = grow(&grammar, &settings, &Quiet).expect("it is within the limit");
        assert_eq!(grown.symbols, symbols);
        grown
    });
}

#[divan::bench(name = "grow: symbios, parametric (ABOP 2.6 a)", args = [12])]
fn grow_honda_symbios(bencher: divan::Bencher, derivations: usize) {
    use symbios_turtle_3d::{TurtleConfig, TurtleInterpreter};
    let (_, _, symbols) = honda(derivations as u32);
    bencher.counter(ItemsCount::new(symbols)).bench(|| {
        let source = "omega: A(1,10)\n\
            A(l,w) -> !(w) F(l) [ &(45) B(l*0.6,w*0.707) ] /(137.5) A(l*0.9,w*0.707)\n\
            B(l,w) -> !(w) F(l) [ -(45) $ C(l*0.6,w*0.707) ] C(l*0.9,w*0.707)\n\
            C(l,w) -> !(w) F(l) [ +(45) $ B(l*0.6,w*0.707) ] B(l*0.9,w*0.707)";
        let mut system = symbios::System::from_source(source).expect("the rules are ABOP's");
        system.derive(derivations).expect("it is within the limit");
        assert_eq!(system.state.len() as u64, symbols);
        let mut turtle = TurtleInterpreter::new(TurtleConfig::default());
        turtle.populate_standard_symbols(&system.interner);
        turtle.build_skeleton(&system.state)
    });
}

/// From a grammar to the axes and radii of the tree.
#[divan::bench(name = "skeleton: linden")]
fn skeleton_linden(bencher: divan::Bencher) {
    let (grammar, settings) = weed();
    bencher.counter(ItemsCount::new(SYMBOLS)).bench(|| {
        let grown = grow(&grammar, &settings, &Quiet).expect("it is within the limit");
        Skeleton::build(grown.branching, &Wood::default()).expect("what grew is a tree")
    });
}

const CELLS: usize = 100_000;
const STEPS: u32 = 50;

/// Something diffuses along a row of cells: each looks at both neighbours in every step. On one thread and
/// on two.
#[divan::bench(name = "derive: linden, contexts", args = [1, 2])]
fn derive_contexts(bencher: divan::Bencher, threads: usize) {
    let axiom: String =
        (0..CELLS).flat_map(|cell| ['M', '(', char::from(b'0' + (cell % 7) as u8), ')']).collect();
    let grammar = Grammar::new(&axiom, &["M(a) < M(x) > M(b) -> M((a+x+b)/3)"]).expect("it is balanced");
    let settings = TurtleSettings { derivations: STEPS, ..TurtleSettings::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    bencher
        .counter(ItemsCount::new(CELLS * STEPS as usize))
        .bench_local(|| pool.install(|| derive_string(&grammar, &settings)));
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
