//! Words with the origins of their modules, against rewriting by definition and against what grows.

use linden::Quiet;
use linden::lsystem::{
    Grammar, LsystemError, MAX_TRACED, Stems, Traced, TurtleSettings, derive_string, grow, trace,
};

/// ABOP's figure 1.24: axiom and rules, one symbol a predecessor.
const FIGURES: [(&str, &[(char, &str)]); 6] = [
    ("F", &[('F', "F[+F]F[-F]F")]),
    ("F", &[('F', "F[+F]F[-F][F]")]),
    ("F", &[('F', "FF-[-F+F+F]+[+F-F-F]")]),
    ("X", &[('X', "F[+X]F[-X]+X"), ('F', "FF")]),
    ("X", &[('X', "F[+X][-X]FX"), ('F', "FF")]),
    ("X", &[('X', "F-[[X]+X]+F[+FX]-X"), ('F', "FF")]),
];

fn grammar(axiom: &str, rules: &[(char, &str)]) -> Grammar {
    let rules: Vec<String> = rules.iter().map(|(from, to)| format!("{from} -> {to}")).collect();
    Grammar::new(axiom, &rules).unwrap()
}

fn settings(derivations: u32) -> TurtleSettings {
    TurtleSettings { derivations, ..TurtleSettings::default() }
}

fn word(grammar: &Grammar, derivations: u32) -> Traced {
    trace(grammar, &settings(derivations), &Quiet).unwrap()
}

/// Grammars beyond plain ones: with arguments, conditions, constants, contexts, cuts, organs.
fn others() -> Vec<Grammar> {
    let of = |axiom: &str, rules: &[&str]| Grammar::new(axiom, rules).unwrap();
    vec![
        of(
            "A(1,10)",
            &[
                "#define r 0.9",
                "A(l,w) : l > 0.7 -> !(w)F(l)[&(45)B(l*0.6,w*0.707)]/(137.5)A(l*r,w*0.707)",
                "B(l,w) -> !(w)F(l)[-(45)$B(l*0.6,w*0.707)]+(-l)B(l*r/1000,w*0.707)",
            ],
        ),
        of("F[+b]aFaF", &["#ignore +-F", "a < b -> a", "b > [a] -> bb", "a -> b", "b < a > a -> F"]),
        of("X", &["X -> F[+X%Y]-X", "Y -> FX", "F -> F~LF"]),
        of("X", &["X -> F[{+F-F-F}]'X", "F -> FfF"]),
    ]
}

#[test]
fn parents_and_rules_are_those_of_rewriting_by_definition() {
    for (axiom, rules) in FIGURES {
        let grammar = grammar(axiom, rules);
        let mut letters: Vec<char> = axiom.chars().collect();
        for step in 1..=3 {
            let mut next = Vec::new();
            for (parent, letter) in (0_u32..).zip(&letters) {
                match rules.iter().position(|(from, _)| from == letter) {
                    None => next.push((*letter, Some(parent), None)),
                    Some(rule) => {
                        next.extend(rules[rule].1.chars().map(|to| (to, Some(parent), Some(rule as u32))));
                    }
                }
            }
            let traced = word(&grammar, step);
            let found: Vec<_> = traced.modules.iter().map(|m| (m.symbol, m.parent, m.rule)).collect();
            assert_eq!(found, next, "{axiom} after {step} steps");
            letters = next.into_iter().map(|(letter, ..)| letter).collect();
        }
    }
}

#[test]
fn a_word_is_an_axiom_again_from_which_derivation_goes_on() {
    let plain = FIGURES.map(|(axiom, rules)| grammar(axiom, rules));
    for grammar in plain.into_iter().chain(others()) {
        let text = grammar.to_string();
        let rules: Vec<&str> = text.lines().skip(1).collect();
        for first in 0..3 {
            let begun = word(&grammar, first).to_string();
            let other = Grammar::new(&begun, &rules).unwrap();
            assert_eq!(other.axiom().len(), word(&grammar, first).modules.len());
            assert_eq!(word(&other, 3 - first).to_string(), word(&grammar, 3).to_string(), "{text}");
        }
    }
}

#[test]
fn words_are_those_that_grow_also_by_chance() {
    let chance = ["F -> (0.33) F[+F]F[-F]F", "F -> (0.33) F[+F]F", "F -> (0.34) F[-F(ran(2))]F"];
    let mut all = others();
    all.push(Grammar::new("F", &chance).unwrap());
    for grammar in all {
        for derivations in 0..5 {
            for seed in [0, 7] {
                let settings = TurtleSettings { seed, ..settings(derivations) };
                let traced = trace(&grammar, &settings, &Quiet).unwrap();
                assert_eq!(traced.to_string(), derive_string(&grammar, &settings).unwrap());
            }
        }
    }
}

#[test]
fn the_next_rule_of_a_module_is_the_rule_of_what_it_becomes() {
    for grammar in others() {
        for step in 0..4 {
            let (now, next) = (word(&grammar, step), word(&grammar, step + 1));
            for module in &next.modules {
                let parent = &now.modules[module.parent.unwrap() as usize];
                assert_eq!(module.rule, parent.next_rule, "{grammar} after {step} steps");
                let kept = (parent.symbol, &parent.arguments, parent.birth);
                let is_written = module.rule.is_some();
                assert!(is_written || (module.symbol, &module.arguments, module.birth) == kept);
                assert!(!is_written || module.birth == step + 1);
            }
        }
    }
}

#[test]
fn each_node_of_the_wood_belongs_to_the_module_that_drew_it() {
    let mut all: Vec<Grammar> = FIGURES.iter().map(|(axiom, rules)| grammar(axiom, rules)).collect();
    let is_plain = all.len();
    all.extend(others());
    for (index, grammar) in all.iter().enumerate() {
        let habit = if index % 2 == 0 { Stems::One } else { Stems::Several { stems: 2, lean_deg: 15.0 } };
        let settings = TurtleSettings { habit, ..settings(4) };
        let grown = grow(grammar, &settings, &Quiet).unwrap();
        let traced = trace(grammar, &settings, &Quiet).unwrap();
        let stems = if habit == Stems::One { 1 } else { 2 };
        let nodes = grown.branching.positions.len() as u32 / stems;
        let mut next = 0;
        for module in traced.modules.iter().filter(|module| !module.nodes.is_empty()) {
            assert!("FG".contains(module.symbol), "{}", module.symbol);
            assert_eq!(module.nodes.start, next, "in the order of the word, without gaps");
            next = module.nodes.end;
            let births = &grown.branching.births[module.nodes.start as usize..next as usize];
            assert!(births.iter().all(|&birth| birth == module.birth));
        }
        assert_eq!(next, nodes, "{grammar}");
        for module in &traced.modules {
            if let Some(node) = module.nodes.clone().next_back() {
                let end = grown.branching.positions[node as usize];
                let at = module.at.unwrap();
                assert!(at.distance(end) <= 1e-6 * end.length(), "{at}: its segment ends at {end}");
            }
        }
        let of_nodes: Vec<Option<usize>> = (0..=nodes).map(|node| traced.module_of(node)).collect();
        let drawn =
            traced.modules.iter().enumerate().flat_map(|(i, module)| module.nodes.clone().map(move |_| i));
        assert!(of_nodes.into_iter().eq(drawn.map(Some).chain([None])), "the inverse of the modules' nodes");
        if index < is_plain {
            let drawing = traced.modules.iter().filter(|module| !module.nodes.is_empty()).count();
            assert_eq!(drawing, traced.to_string().matches('F').count());
            assert_eq!(drawing as u32, nodes - 1, "a segment ends in each node but the foot");
        }
    }
}

#[test]
fn the_turtle_stands_where_turning_and_walking_by_definition_leads() {
    // In a plane: heading (cos, sin), left is +, a branch goes back to where it left.
    let (axiom, rules) = FIGURES[5];
    let grammar = grammar(axiom, rules);
    let settings =
        TurtleSettings { derivations: 3, angle_deg: 90.0, segment_m: 0.5, ..TurtleSettings::default() };
    let traced = trace(&grammar, &settings, &Quiet).unwrap();
    let (mut x, mut y, mut quarter, mut stack) = (0.0, 0.0, 1_usize, Vec::new());
    for module in &traced.modules {
        match module.symbol {
            'F' => {
                let way = [[0.5, 0.0], [0.0, 0.5], [-0.5, 0.0], [0.0, -0.5]][quarter % 4];
                (x, y) = (x + way[0], y + way[1]);
            }
            '+' => quarter += 1,
            '-' => quarter += 3,
            '[' => stack.push((x, y, quarter)),
            ']' => (x, y, quarter) = stack.pop().unwrap(),
            _ => {}
        }
        let at = module.at.unwrap();
        assert!((at.x - x).abs() < 1e-5 && (at.y - y).abs() < 1e-5 && at.z.abs() < 1e-5, "{at} {x} {y}");
    }
    let actions: Vec<&str> =
        traced.modules.iter().take(4).map(linden::lsystem::TracedModule::action).collect();
    assert_eq!(actions, ["draws a segment"; 4]);
}

#[test]
fn polygons_and_organs_belong_to_the_modules_that_made_them() {
    let grammar = Grammar::new("F[{+F-F-F}]F~L[{-F+F+F}]F~K(2)", &["F -> FF"]).unwrap();
    let traced = word(&grammar, 1);
    let made = |of: fn(&linden::lsystem::TracedModule) -> Option<u32>| -> Vec<(char, u32)> {
        traced.modules.iter().filter_map(|module| Some((module.symbol, of(module)?))).collect()
    };
    assert_eq!(made(|module| module.polygon), [('}', 0), ('}', 1)]);
    assert_eq!(made(|module| module.placed), [('L', 0), ('K', 1)]);
}

#[test]
fn a_word_that_cannot_be_drawn_is_a_word() {
    let grammar = Grammar::new("F{A", &["A -> +F-F}"]).unwrap();
    let axiom = word(&grammar, 0);
    let undrawn = axiom.undrawn.as_ref().map(LsystemError::cause);
    assert_eq!((axiom.to_string(), undrawn), ("F{A".to_owned(), Some(&LsystemError::PolygonUnclosed)));
    assert!(axiom.modules.iter().all(|module| module.nodes.is_empty()));
    assert_eq!(axiom.module_of(0), None);
    assert_eq!(word(&grammar, 1).undrawn, None);
}

#[test]
fn long_words_are_refused_with_the_steps_that_fit() {
    let doubling = grammar("F", &[('F', "FF")]);
    let error = trace(&doubling, &settings(20), &Quiet).unwrap_err();
    assert_eq!(error, LsystemError::TooManyToTrace { derivations: 20, limit: MAX_TRACED, fits: Some(19) });
    assert_eq!(word(&doubling, 19).modules.len(), 1 << 19);
    // A limit of the user's own that is lower is named as theirs.
    let low = TurtleSettings { symbol_limit: 100, ..settings(7) };
    let error = trace(&doubling, &low, &Quiet).unwrap_err();
    assert!(matches!(error, LsystemError::TooManySymbols { limit: 100, .. }), "{error}");
}

#[test]
fn rules_have_the_lines_that_a_grammar_is_shown_with() {
    for grammar in others() {
        let text = grammar.to_string();
        let lines: Vec<&str> = text.lines().collect();
        for (index, rule) in grammar.productions().iter().enumerate() {
            assert_eq!(lines[grammar.line_of(index) - 1], rule.to_string());
        }
    }
}
