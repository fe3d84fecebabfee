//! Rules as presets write them.

use linden::lsystem::{Expression, Grammar, Part, Problem};

#[track_caller]
fn refusal(axiom: &str, rules: &[&str]) -> String {
    Grammar::new(axiom, rules).unwrap_err().to_string()
}

#[test]
fn a_rule_is_a_symbol_an_arrow_a_probability_and_a_successor() {
    let plain = Grammar::new("F", &["F->F[+F]"]).unwrap();
    for same in ["F -> F[+F]", " F → F [ + F ] ", "F=(1)F[+F]", "F -> (1.0) F[+F]", "F\t->\n F[+F]"] {
        assert_eq!(Grammar::new(" F ", &[same]).unwrap(), plain, "{same}");
    }
    assert_eq!(plain.productions()[0].predecessor.symbol, 'F');
    assert_eq!(plain.productions()[0].successor.len(), 5);
}

#[test]
fn turtle_symbols_may_be_rewritten_too() {
    let grammar = Grammar::new("F", &["--> -+", "!->!!"]).unwrap();
    assert_eq!(grammar.productions()[0].predecessor.symbol, '-');
    assert_eq!(grammar.productions()[1].successor.len(), 2);
}

#[test]
fn an_empty_successor_erases() {
    assert!(Grammar::new("F", &["F ->"]).unwrap().productions()[0].successor.is_empty());
}

#[test]
fn arguments_are_numbers() {
    let grammar = Grammar::new::<&str>("F(2)+( -30.5 )f(0)", &[]).unwrap();
    let arguments: Vec<_> = grammar.axiom().iter().map(|m| m.arguments.as_slice()).collect();
    assert_eq!(
        arguments,
        [[Expression::number(2.0)], [Expression::number(-30.5)], [Expression::number(0.0)]]
    );
}

#[test]
fn what_is_written_is_read_back() {
    let rules = ["F -> (0.25) F[+(30)F]F", "F -> (0.75) ", r"X -> F\/&^|$!'%f(-2)"];
    let grammar = Grammar::new("FX[F(0.1)]", &rules).unwrap();
    let text = grammar.to_string();
    let (axiom, rules) = text.split_once('\n').unwrap();
    let again = Grammar::new(axiom, &rules.lines().collect::<Vec<_>>()).unwrap();
    assert_eq!(again, grammar);
}

#[test]
fn mistakes_are_told_with_what_was_expected() {
    for (axiom, rule, message) in [
        ("", "F -> F", "axiom, column 1: expected a symbol, found the end"),
        ("F", "", "rule 1, column 1: expected a symbol and an arrow, as in 'F -> FF', found the end"),
        ("F", "F F", "rule 1, column 3: expected '->', '→' or '=' after 'F', found 'F'"),
        ("F", "FF -> F", "rule 1, column 2: expected '->', '→' or '=' after 'F', found 'F'"),
        (
            "F",
            "[ -> F",
            "rule 1, column 1: expected a symbol that can be rewritten (brackets and '%' cannot), found '['",
        ),
        ("F", "F -> F?", "rule 1, column 7: expected a symbol, found '?'"),
        ("F", "F -> F−F", "rule 1, column 7: expected a symbol (is '-' meant?), found '−'"),
        ("F", "F -> λ)", "rule 1, column 7: expected a symbol, found ')'"),
        ("F]", "F -> F", "axiom, column 2: ']' closes a branch that was never opened"),
        ("[[F]", "F -> F", "axiom, column 1: '[' opens a branch that is never closed"),
        ("F", "F -> ]F[", "rule 1, column 6: ']' closes a branch that was never opened"),
        ("|(3)", "F -> F", "axiom, column 2: expected no number after '|', found '('"),
        ("F(0)", "F -> F", "axiom, column 3: 0 is out of range: 0.000001 to 1000000"),
        ("F(1e9)", "F -> F", "axiom, column 3: 1e9 is out of range: 0.000001 to 1000000"),
        (
            "F",
            "F -> (0.5) F",
            "rule 1, column 1: the probabilities of the rules for 'F' sum to 0.5, not to 1",
        ),
    ] {
        assert_eq!(refusal(axiom, &[rule]), message);
    }
}

#[test]
fn places_are_bytes_for_programs_and_columns_for_people() {
    let error = Grammar::new("F", &["F -> F", "λ → λλ]"]).unwrap_err();
    assert_eq!((error.part, error.offset, error.column), (Part::Rule(1), 11, 7));
    assert_eq!(error.problem, Problem::Unopened);
}
