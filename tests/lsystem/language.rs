//! Rules as presets write them.

use linden::lsystem::{Expression, Grammar, GrammarPart, Problem, text};

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
        ("F(-1)", "F -> F", "axiom, column 3: -1 is out of range: 0 to 1000000"),
        ("F(1e9)", "F -> F", "axiom, column 3: 1e9 is out of range: 0 to 1000000"),
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
fn conditions_are_read_as_the_book_prints_them() {
    let read = |condition: &str| Grammar::new("A(1)", &[format!("A(x) : {condition} -> F(x)")]).unwrap();
    for (printed, written) in [
        ("x = 3", "x == 3"),
        ("x = 1 & x > 0 | !(x = 7)", "x == 1 && x > 0 || !(x == 7)"),
        ("x≥1&x≤2|x≠4", "x>=1 && x<=2 || x!=4"),
    ] {
        assert_eq!(read(printed), read(written), "{printed}");
    }
}

#[test]
fn places_are_bytes_for_programs_and_columns_for_people() {
    let error = Grammar::new("F", &["F -> F", "λ → λλ]"]).unwrap_err();
    assert_eq!((error.part, error.offset, error.column), (GrammarPart::Rule(1), 11, 7));
    assert_eq!(error.problem, Problem::Unopened);
}

#[expect(clippy::too_many_lines, reason = "a table")]
#[test]
fn what_the_wider_language_gets_wrong_is_told_with_its_place() {
    for (axiom, rule, message) in [
        (
            "F",
            "A(l) -> F(lenght)",
            "rule 1, column 11: unknown name 'lenght' (known: l); '#define lenght …' would make it a constant",
        ),
        (
            "F",
            "A(length) -> F(lenght)",
            "rule 1, column 16: unknown name 'lenght' (did you mean 'length'?); '#define lenght …' would make it a constant",
        ),
        (
            "F",
            "A(l,w) -> F(q)",
            "rule 1, column 13: unknown name 'q' (known: l, w); '#define q …' would make it a constant",
        ),
        ("F", "A(l) -> F(sine(l))", "rule 1, column 11: unknown function 'sine' (did you mean 'sin'?)"),
        ("F", "A(l) -> F(min(l))", "rule 1, column 16: 'min' takes 2 arguments, found 1"),
        ("F", "A(l) -> F(abs(l,1))", "rule 1, column 16: 'abs' takes 1 argument, found 2"),
        (
            "F",
            "A(l) -> F(l=3)",
            "rule 1, column 12: expected an operator ('==' compares; behind a condition the arrow is '->'), found '='",
        ),
        (
            "F",
            "A(l) : 1 < l < 3 -> F",
            "rule 1, column 14: expected one comparison (join two with '&&'), found '<'",
        ),
        ("F", "A(l) : l > 3", "rule 1, column 13: expected '->' or '→', found the end"),
        ("F", "A(l) : (l > 3 -> F", "rule 1, column 15: expected ')', found '-'"),
        ("F", "A(l) -> F(l+)", "rule 1, column 13: expected a number, found ')'"),
        ("F", "A(l) -> F(l l)", "rule 1, column 13: expected an operator, ',' or ')', found 'l'"),
        ("F", "A(3) -> F", "rule 1, column 3: expected the name of a parameter, found '3'"),
        ("F", "A(x,x) -> F", "rule 1, column 5: 'x' is already defined; use another name"),
        ("F", "A(x) < B(x) -> F", "rule 1, column 10: 'x' is already defined; use another name"),
        (
            "F",
            "A(sin) -> F",
            "rule 1, column 3: expected the name of a parameter ('sin' is a function), found 's'",
        ),
        ("F", "|(x) -> F", "rule 1, column 2: expected no number after '|', found '('"),
        ("F", "A < -> F", "rule 1, column 9: expected '->', '→' or '=' after '-', found the end"),
        ("F", "A > -> F", "rule 1, column 5: expected the right context, found '-'"),
        ("F", "A > [B -> F", "rule 1, column 5: '[' opens a branch that is never closed"),
        ("F", "A > B% -> F", "rule 1, column 6: expected a symbol of the right context, found '%'"),
        (
            "F",
            "[B] < A -> F",
            "rule 1, column 1: expected a symbol that can be rewritten (brackets and '%' cannot), found '['",
        ),
        (
            "F",
            "A < B < C -> F",
            "rule 1, column 7: '<' ends a left context, before the symbol to rewrite; it is no symbol",
        ),
        ("F", "A -> B:C", "rule 1, column 7: ':' begins a condition, before the arrow; it is no symbol"),
        (
            "F",
            "A -> #B",
            "rule 1, column 6: '#' begins a line of its own, '#define' or '#ignore'; it is no symbol",
        ),
        (
            "F",
            "#include F",
            "rule 1, column 1: expected '#define name value' or '#ignore symbols', found '#include'",
        ),
        ("F", "#define 3 4", "rule 1, column 9: expected a name, as in '#define r 0.9', found '3'"),
        (
            "F",
            "#define sin 4",
            "rule 1, column 9: expected a name of your own ('sin' is a function), found 's'",
        ),
        ("F", "#define r", "rule 1, column 10: expected a number, found the end"),
        ("F", "#define r 1/0", "rule 1, column 11: '1/0' is inf, which is no number to compute with"),
        (
            "F",
            "#define r ran(2)",
            "rule 1, column 11: 'ran(2)' depends on chance, but must be a constant here",
        ),
        ("F", "#define r 2 3", "rule 1, column 13: expected an operator, ',' or ')', found '3'"),
        (
            "F",
            "#ignore +[",
            "rule 1, column 10: expected a symbol that can be ignored (brackets and '%' cannot), found '['",
        ),
        ("F(2-3)", "F -> F", "axiom, column 3: 2-3 = -1 is out of range: 0 to 1000000"),
        (
            "F",
            "A(x) : x > 1 -> (0.5) F",
            "rule 1, column 1: the probabilities of the rules for 'A(x) : x>1' sum to 0.5, not to 1",
        ),
        (
            "F",
            "A < B(x) > [C]D -> (0.5+0.1) F",
            "rule 1, column 1: the probabilities of the rules for 'A < B(x) > [C]D' sum to 0.6, not to 1",
        ),
        (
            "F",
            "F(a) : a>0.5 = F(a/2)",
            "rule 1, column 14: expected '->' (behind ':' a '=' compares), found '='",
        ),
        (
            "F",
            "F : * = FF",
            "rule 1, column 7: expected an operator ('==' compares; behind a condition the arrow is '->'), found '='",
        ),
        ("F", "F(a) : 1/0 -> F", "rule 1, column 8: '1/0' is inf, which is no number to compute with"),
        (
            "F",
            "F(a) : sqrt(0-3) -> F",
            "rule 1, column 8: 'sqrt(0-3)' is NaN, which is no number to compute with",
        ),
        (
            "F",
            "F(a) : 1/0 > 3 -> F",
            "rule 1, column 8: '1/0 > 3' is NaN, which is no number to compute with",
        ),
        (
            "F",
            "F -> F(sqrt 2)",
            "rule 1, column 13: expected '(' after the function 'sqrt', as in sqrt(x), found '2'",
        ),
        ("F", "F => FF", "rule 1, column 3: expected the arrow '->', found '=>'"),
        ("F", "F --> FF", "rule 1, column 3: expected the arrow '->', found '-->'"),
        ("F", "F(a) : a > 1 => F", "rule 1, column 14: expected the arrow '->', found '=>'"),
        ("F", "F(a) : a > 1 --> F", "rule 1, column 14: expected the arrow '->', found '-->'"),
        ("F", "F : * ⇒ F", "rule 1, column 7: expected the arrow '->', found '⇒'"),
        (
            "F",
            "#consider F",
            "rule 1, column 1: expected '#ignore' with the symbols that contexts pass over, all but those to consider, \
             found '#consider'",
        ),
        ("F", "A -> (2*0.7) F", "rule 1, column 7: 2*0.7 = 1.4 is out of range: 0 to 1"),
    ] {
        assert_eq!(refusal(axiom, &[rule]), message, "{rule}");
    }
    for (rules, message) in [
        (
            &["F -> F[+F]", "A -> F", "F -> FF"][..],
            "rule 1, column 1: the probabilities of the rules for 'F' sum to 2, not to 1: there is also 'F -> FF'; \
             write (0.5) behind each arrow",
        ),
        (
            &["F -> F[+F]", "F -> FF", "F -> F"],
            "rule 1, column 1: the probabilities of the rules for 'F' sum to 3, not to 1: there is also 'F -> FF'; \
             write (1/3) behind each arrow",
        ),
        (
            &["F -> (0.5) F[+F]", "F -> FF"],
            "rule 1, column 1: the probabilities of the rules for 'F' sum to 1.5, not to 1: there is also 'F -> FF'",
        ),
    ] {
        assert_eq!(refusal("F", rules), message);
    }
    assert_eq!(
        refusal("F", &["#define r 1", "#define r 2"]),
        "rule 2, column 9: 'r' is already defined; use another name"
    );
    let deep = format!("A(x) -> F({}x{})", "1+(".repeat(40), ")".repeat(40));
    assert!(refusal("F", &[&deep]).contains("more than 32 operands wait"));
    // What opens before an operand is limited too: each is a pass over it when the expression is written.
    for open in ["-", "!", "(", "abs(", "-(!abs("] {
        let said = refusal(&format!("F({}1", open.repeat(1_000_000)), &[]);
        assert!(said.contains("more than 256 signs, brackets and functions are open"), "{open}: {said}");
    }
    let signs = format!("F({}1)", "-".repeat(256));
    let grammar = Grammar::new::<&str>(&signs, &[]).expect("256 signs are allowed");
    assert_eq!(text::parse_grammar(&text::write_grammar(&grammar)).unwrap(), grammar);
}

#[test]
fn rules_are_written_back_as_they_were() {
    let lines = [
        "#define r1 0.9",
        "#define half (r1+0.1)/2",
        "#ignore +-F/",
        "A(l,w) : l>r1&&!(w<1||w>=3) -> (half) !(w)F(l*-2^(w-1))[&(45)B(-(l+1)/2-(1-w))]",
        "A(l,w) : l>r1&&!(w<1||w>=3) -> (1-half) {.~L(2)f.}",
        "BC(x) < S > G[H(y)]M -> S(x,max(y,0.5))",
        "F -> FF",
    ];
    let grammar = Grammar::new("A(1,10)", &lines).unwrap();
    assert_eq!(grammar.to_string(), format!("A(1,10)\n{}\n", lines.join("\n")));
    // The older format's arrow, ABOP's, and blanks anywhere.
    let same = Grammar::new("F", &["A ( l , w ) : l > 1 → F ( l * 2 )", "B(x) = F(x)"]).unwrap();
    assert_eq!(same, Grammar::new("F", &["A(l,w):l>1->F(l*2)", "B(x)->F(x)"]).unwrap());
}

#[test]
fn long_texts_do_not_exhaust_the_call_stack() {
    let sum = format!("A(x) -> B({}x)", "1+".repeat(200_000));
    let grammar = Grammar::new("A(1)", &[sum]).unwrap();
    assert_eq!(Grammar::new("A(1)", &[grammar.productions()[0].to_string()]).unwrap(), grammar);
    assert!(
        refusal("F", &[&format!("A(x) -> B({}x)", "-(".repeat(200_000))]).contains("more than 256 signs")
    );
}

/// What ABOP writes in front of a rule, and for a context or a condition that there is not.
#[test]
fn labels_and_stars_of_abop_are_read() {
    let plain = Grammar::new("F(1)", &["F(x) -> F(x)F", "F < F(x) : x > 1 -> A", "p > p -> p1"]).unwrap();
    let as_printed = ["p1 : * < F(x) > * : * → F(x)F", "p12: F < F(x) > * : x > 1 -> A", "p > p -> p1"];
    for axiom in ["ω : F(1)", "omega: F(1)"] {
        assert_eq!(Grammar::new(axiom, &as_printed).unwrap(), plain);
    }
    // None of them is a label.
    let bare = Grammar::new("p1", &["p : 1 -> F", "p1 < F -> FF", "ω : * -> p1"]).unwrap();
    assert_eq!(bare.to_string(), "p1\np : 1 -> F\np1 < F -> FF\nω -> p1\n");
    assert_eq!(refusal("F", &["* > F -> F"]), "rule 1, column 1: expected a symbol, found '*'");
    assert_eq!(
        refusal("F", &["p1 : F -> F]"]),
        "rule 1, column 12: ']' closes a branch that was never opened"
    );
}

/// What can be no organ, whatever is derived, is refused with its place; what may become one is not.
#[test]
fn organs_that_there_are_not_are_refused_with_their_place() {
    let organs = "L (leaf), K (blossom), B (berry), N (needle)";
    for (axiom, rule, place, found) in [
        ("F~X", "F -> FF", "axiom, column 3", "'X'"),
        ("F", "F -> F~X(1)F", "rule 1, column 8", "'X'"),
        ("F", "F -> F[~]", "rule 1, column 9", "']'"),
        ("FL~", "F -> FF", "axiom, column 4", "nothing"),
        ("F", "F -> F~", "rule 1, column 8", "nothing"),
    ] {
        let message =
            format!("{place}: '~' is followed by {found}, which names no organ; there are: {organs}");
        assert_eq!(refusal(axiom, &[rule]), message);
    }
    assert_eq!(refusal("F~L(-1)", &["F -> F"]), "axiom, column 5: -1 is out of range: 0 to 1000000");
    for (axiom, rules) in [
        ("F~X", &["X -> L"][..]),
        ("F~X", &["~ -> F"]),
        ("F~L(-1)", &["L(x) -> L(x+2)"]),
        // L follows the ~ in the string.
        ("FXL", &["X -> F~"]),
        // A cut may take it away.
        ("FX~Y", &["X -> F%"]),
    ] {
        assert!(Grammar::new(axiom, rules).is_ok(), "{axiom} {rules:?}");
    }
}
