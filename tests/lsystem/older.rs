//! Files of the older text format, as they were written, and mistakes in them.

use linden::lsystem::{Grammar, forecast, text};

use crate::naive::{self, Rules};

/// File, its text, angle, derivations, rules.
type Fixture = (&'static str, &'static str, f64, u32, &'static [&'static str]);

macro_rules! fixture {
    ($name:literal, $angle:expr, $derivations:expr, $rules:expr) => {
        ($name, include_str!(concat!("../grammars/", $name, ".txt")), $angle, $derivations, $rules)
    };
}

const FIXTURES: [Fixture; 8] = [
    fixture!("treeA", 25.7, 3, &["F -> F[+F]F[-F]F"]),
    fixture!("treeB", 20.0, 3, &["F -> F[+F]F[-F][F]"]),
    fixture!("treeC", 22.5, 2, &["F -> FF[-F+F]F[+F-F]F", "F -> (0) FF"]),
    fixture!("treeD", 20.0, 3, &["F -> G[+F]G[-F]+F", "G -> GG"]),
    fixture!("treeE", 25.7, 3, &["F -> G[+F][F]GF", "G -> GG"]),
    fixture!("treeF", 22.5, 3, &["F -> G-[[F]+F]+G[+GF]-F", "G -> GG"]),
    fixture!("treeC-stochastic", 22.5, 3, &["F -> (0.5) FF-[-F+F+F]+[+F-F-F]", "F -> (0.5) FF"]),
    fixture!("bush3d", 22.5, 3, &[r"F -> F[-\&^F][^++\&F]||F[--\&^F][+\&F]"]),
];

#[test]
fn the_programs_own_trees_are_read_unchanged() {
    for (name, text, angle_deg, derivations, rules) in FIXTURES {
        let read = text::parse(text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((read.angle_deg, read.derivations), (angle_deg, derivations), "{name}");
        assert_eq!(read.grammar, Grammar::new("F", rules).unwrap(), "{name}");
    }
}

#[test]
fn comments_are_kept() {
    let (_, tree_a, ..) = FIXTURES[0];
    assert_eq!(
        text::parse(tree_a).unwrap().comments,
        ["tree A (pag. 25)", "number of derivations => MIN VALUE = 1"]
    );
}

#[test]
fn a_zero_probability_changes_no_forecast() {
    let (_, tree_c, ..) = FIXTURES[2];
    let grammar = text::parse(tree_c).unwrap().grammar;
    let rules: Rules = [('F', vec![(1.0, "FF[-F+F]F[+F-F]F".to_owned())])].into();
    let settings = linden::lsystem::TurtleSettings { derivations: 2, ..Default::default() };
    let expected = naive::derive("F", &rules, &settings).len() as u128;
    let counted = forecast(&grammar, 2).unwrap();
    assert_eq!((counted.symbols, counted.exact), (expected, true));
}

#[test]
fn line_endings_marks_and_blanks_do_not_matter() {
    let plain = "// c\naxiom=F\nangle=20\nnumber of derivations=3\n\nF=(1)F[+F]\n";
    let expected = text::parse(plain).unwrap();
    for same in [
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.trim_end().to_owned(),
        plain.replace('\n', " \t\n"),
        plain.replace('=', " = ").replace("(1)", "( 1 ) "),
        format!("\n\n  {}", plain.replace('\n', "\n  ")),
        plain.replace("(1)", ""),
        "F=(1)F[+F]\nnumber of derivations=3\nangle=20.0\n//c\naxiom=F".to_owned(),
    ] {
        assert_eq!(text::parse(&same).unwrap(), expected, "{same:?}");
    }
}

#[test]
fn two_slashes_are_two_rolls_past_the_beginning() {
    let text = "axiom=F\nangle=20\nnumber of derivations=1\nF=(1)F//F // F";
    let read = text::parse(text).unwrap();
    assert_eq!(read.grammar, Grammar::new("F", &["F -> F//F//F"]).unwrap());
    assert!(read.comments.is_empty());
    assert!(read.notes.is_empty(), "one letter is a symbol");
}

#[test]
fn a_rule_that_seems_to_end_in_a_comment_is_noted() {
    let text = "axiom=A\nangle=20\nnumber of derivations=1\nA -> F // the final leaf\nF -> F//F // FF";
    let note = "line 4: '//' within a rule rolls twice; a comment stands on a line of its own";
    assert_eq!(text::parse(text).unwrap().notes, [note]);
}

/// As ABOP prints its systems, and with the comments of its preprocessor.
#[test]
fn abops_labels_and_comments_are_read() {
    let text = "/* Figure\n   1.24 */\nω : F\nangle=20 /* degrees */\nnumber of derivations=3\n// see /* there\np1 : F /* x */ -> F[+F]";
    let read = text::parse(text).unwrap();
    assert_eq!(read.grammar, Grammar::new("F", &["F -> F[+F]"]).unwrap());
    assert_eq!(read.comments, ["see /* there"]);
    let rule = text::parse_grammar("axiom = ω\nω : * -> F").unwrap();
    assert_eq!(rule, Grammar::new("ω", &["ω -> F"]).unwrap());
}

#[test]
fn mistakes_are_told_with_their_place() {
    let head = "axiom=F\nangle=20\nnumber of derivations=3\n";
    for (text, message) in [
        // All that is missing is told at once.
        (
            "",
            "line 1, column 1: no line says 'axiom=…', 'angle=…' or 'number of derivations=…'; \
             add lines like 'axiom = F', 'angle = 25' and 'number of derivations = 4'",
        ),
        (
            "axiom=F\nF -> F[+F]\n",
            "line 2, column 1: no line says 'angle=…' or 'number of derivations=…'; \
             add lines like 'angle = 25' and 'number of derivations = 4'",
        ),
        // What is wrong in a line comes first.
        ("axiom=F\nF -> F[+F\n", "line 2, column 7: '[' opens a branch that is never closed"),
        (
            "axiom=F\nangle=20\n",
            "line 2, column 1: no line says 'number of derivations=…'; add one like 'number of derivations = 4'",
        ),
        ("axiom=\nangle=20\nnumber of derivations=3", "line 1, column 7: expected a symbol, found the end"),
        ("axiom=F\n  axiom=G\n", "line 2, column 3: 'axiom' was already given in line 1; keep one of them"),
        ("axiom=F\nangle=1e3\nnumber of derivations=3", "line 2, column 7: 1e3 is out of range: -360 to 360"),
        ("axiom=F\nangle=NaN\nnumber of derivations=3", "line 2, column 7: NaN is out of range: -360 to 360"),
        ("axiom=F\nangle=20°\nnumber of derivations=3", "line 2, column 7: expected a number, found '20°'"),
        ("axiom=F\nangle=20\nnumber of derivations= -1", "line 3, column 24: -1 is out of range: 0 to 10000"),
        (
            "axiom=F\nangle=20\nnumber of derivations=99999999999999999999",
            "line 3, column 23: 99999999999999999999 is out of range: 0 to 10000",
        ),
        (
            "axiom=F\nangle=20\nnumber of derivations=2.5",
            "line 3, column 23: expected a whole number, found '2.5'",
        ),
        (
            &format!("{head}leaves=3"),
            "line 4, column 1: expected 'axiom=', 'angle=', 'number of derivations=', a comment '//' or \
             a rule 'F -> …', found 'leaves=3'",
        ),
        (
            "axiom=F\nangle=20\nderivations=2",
            "line 3, column 1: expected 'axiom=', 'angle=', 'number of derivations=', a comment '//' or \
             a rule 'F -> …' (is 'number of derivations=' meant?), found 'derivations=2'",
        ),
        (&format!("{head}F FF"), "line 4, column 3: expected '->', '→' or '=' after 'F', found 'F'"),
        (
            &format!("{head}F=F /* one\ntwo"),
            "line 4, column 5: expected a '*/' that ends the comment, found the end",
        ),
        (
            &format!("{head}/* one\ntwo */ F=F]"),
            "line 5, column 11: ']' closes a branch that was never opened",
        ),
        (&format!("{head}\n F=(1)F[+F]]F"), "line 5, column 12: ']' closes a branch that was never opened"),
        (&format!("{head}F=(1)[F[+F]"), "line 4, column 6: '[' opens a branch that is never closed"),
        (
            &format!("{head}F=(x)F"),
            "line 4, column 4: unknown name 'x'; '#define x …' would make it a constant",
        ),
        (&format!("{head}F=()F"), "line 4, column 4: expected a number, found ')'"),
        (&format!("{head}F=(1.5)F"), "line 4, column 4: 1.5 is out of range: 0 to 1"),
        (&format!("{head}F=(1"), "line 4, column 5: expected ')', found the end"),
        (
            &format!("{head}G=(1)G\nF=(0.5)F\nF=(0.4)FF"),
            "line 5, column 1: the probabilities of the rules for 'F' sum to 0.9, not to 1: \
             there is also 'F -> (0.4) FF'",
        ),
        (&format!("{head}F"), "line 4, column 2: expected '->', '→' or '=' after 'F', found the end"),
        (&format!("{head}F=(1)F\u{1b}F"), "line 4, column 7: expected a symbol, found '\\u{1b}'"),
    ] {
        assert_eq!(text::parse(text).unwrap_err().to_string(), message, "{text:?}");
    }
}

#[test]
fn probabilities_may_miss_one_by_a_millionth() {
    let head = "axiom=F\nangle=20\nnumber of derivations=3\n";
    let thirds = "F=(0.333333)F\nF=(0.333333)FF\nF=(0.333333)FFF\n";
    assert!(text::parse(&format!("{head}{thirds}")).is_ok());
    let coarse = thirds.replace("333333", "33333");
    assert!(text::parse(&format!("{head}{coarse}")).is_err());
}

/// Where a mistake in an edited grammar is, and what is said about it.
#[test]
fn mistakes_in_an_edited_grammar_are_pointed_at() {
    for (text, message) in [
        ("", "line 1, column 1: no line says 'axiom=…'; add one like 'axiom = F'"),
        ("axiom =", "line 1, column 8: expected a symbol, found the end"),
        ("axiom = F\n\nF -> F[+F\n", "line 3, column 7: '[' opens a branch that is never closed"),
        ("axiom = F\n  F -> F]", "line 2, column 9: ']' closes a branch that was never opened"),
        (
            "axiom = F\nF -> (0.5) FF",
            "line 2, column 1: the probabilities of the rules for 'F' sum to 0.5, not to 1",
        ),
        ("axiom = F\naxiom = G", "line 2, column 1: 'axiom' was already given in line 1; keep one of them"),
        (
            "axiom = F\nangle = 3",
            "line 2, column 1: expected 'axiom = …', a rule 'F -> …' or a comment '//' (angle and derivations are \
             knobs of their own), found 'angle = 3'",
        ),
    ] {
        assert_eq!(text::parse_grammar(text).unwrap_err().to_string(), message, "{text:?}");
    }
}
