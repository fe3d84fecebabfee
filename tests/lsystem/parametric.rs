//! Parameters, conditions, arithmetic and constants.

use linden::Quiet;
use linden::lsystem::{
    Grammar, LsystemError, TurtleSettings, Way, derive_by, derive_string, forecast, grow_by, trace,
};

fn derived(axiom: &str, rules: &[&str], derivations: u32) -> String {
    let grammar = Grammar::new(axiom, rules).unwrap();
    let settings = TurtleSettings { derivations, ..TurtleSettings::default() };
    let best = derive_by(&grammar, &settings, Way::Best).unwrap();
    assert_eq!(derive_by(&grammar, &settings, Way::BreadthFirst).unwrap(), best);
    best.text
}

#[test]
fn abops_first_parametric_system() {
    // ABOP, section 1.10.1: the system of which the book lists the first steps.
    let rules = [
        "A(x,y) : y <= 3 -> A(x*2,x+y)",
        "A(x,y) : y > 3 -> B(x)A(x/y,0)",
        "B(x) : x < 1 -> C",
        "B(x) : x >= 1 -> B(x-1)",
    ];
    for (step, text) in [
        "B(2)A(4,4)",
        "B(1)B(4)A(1,0)",
        "B(0)B(3)A(2,1)",
        "CB(2)A(4,3)",
        "CB(1)A(8,7)",
        "CB(0)B(8)A(1.1428571428571428,0)",
    ]
    .iter()
    .enumerate()
    {
        assert_eq!(derived("B(2)A(4,4)", &rules, step as u32), *text);
    }
}

#[test]
fn the_anabaena_of_real_numbers_grows_and_divides() {
    // ABOP, section 1.10.3 in the form A(s): a cell grows by a factor and divides in a ratio.
    let rules =
        ["#define R 1.5", "#define half 2", "A(s) : s >= 2 -> A(s/half)A(s/half)", "A(s) : s < 2 -> A(s*R)"];
    assert_eq!(derived("A(1)", &rules, 1), "A(1.5)");
    assert_eq!(derived("A(1)", &rules, 2), "A(2.25)");
    assert_eq!(derived("A(1)", &rules, 3), "A(1.125)A(1.125)");
}

#[test]
fn a_module_is_matched_by_its_number_of_arguments() {
    let rules = ["F -> a", "F(x) -> b(x)", "F(x,y) -> c(y,x)"];
    assert_eq!(derived("FF(2)F(3,4)F(5,6,7)", &rules, 1), "ab(2)c(4,3)F(5,6,7)");
}

#[test]
fn arithmetic_is_that_of_mathematics() {
    let rules =
        ["#define one 1", "#define three one+2", "A(x,y) -> B(2+3*x, -x^2, 2^3^2, (2+3)*x/y-1, three)"];
    assert_eq!(derived("A(2,4)", &rules, 1), "B(8,-4,512,1.5,3)");
    let rules = ["A(x) -> B(abs(-x), floor(x), ceil(x), sqrt(x*x), min(x,1), max(x,1), pow(x,2))"];
    assert_eq!(derived("A(2.5)", &rules, 1), "B(2.5,2,3,2.5,1,2.5,6.25)");
    let rules = ["A(x) -> B(sin(x), cos(x), tan(2*x-15), exp(0*x), log(exp(x/30)))"];
    assert_eq!(derived("A(90)", &rules, 1), "B(1,0,-0.267949192431123,1,3)");
    let rules = ["A(x,y) -> B(x<y, x<=y, x>y, x>=y, x==y, x!=y, x<y && y<x, x<y || y<x, !x, !(x-x))"];
    assert_eq!(derived("A(1,2)", &rules, 1), "B(1,1,0,0,0,1,0,1,0,1)");
}

#[test]
fn parameters_hide_constants_and_conditions_may_be_a_star() {
    assert_eq!(derived("A(2)", &["#define x 7", "A(x) : * -> B(x)C(x+1)"], 1), "B(2)C(3)");
    assert_eq!(derived("A(x)", &["#define x 7", "A(y) → B(x*y)"], 1), "B(49)");
}

#[test]
fn the_first_condition_that_holds_is_taken_and_none_keeps() {
    let rules = ["A(x) : x > 2 -> B", "A(x) : x > 1 -> C", "A(x) : x == 0 -> D"];
    assert_eq!(derived("A(3)A(2)A(1)A(0)", &rules, 1), "BCA(1)D");
}

#[test]
fn chance_may_depend_on_parameters() {
    let rules =
        ["A(x) : x > 1 -> (0.25) B(ran(x))", "A(y) : y > 1 -> (0.75) C(nran(y,0))", "A(x) : x <= 1 -> D"];
    let grammar = Grammar::new("A(8)A(4)A(1)", &rules).unwrap();
    let mut lengths = [0.0, 0.0];
    let mut chosen = 0;
    for seed in 0..2000 {
        let settings = TurtleSettings { derivations: 1, seed, ..TurtleSettings::default() };
        let text = derive_string(&grammar, &settings).unwrap();
        assert_eq!(derive_by(&grammar, &settings, Way::BreadthFirst).unwrap().text, text);
        assert!(text.ends_with('D'));
        if let Some(rest) = text.strip_prefix("B(") {
            let value: f64 = rest.split_once(')').unwrap().0.parse().unwrap();
            assert!((0.0..8.0).contains(&value));
            lengths[0] += value;
            lengths[1] += value * value;
            chosen += 1;
        } else {
            assert!(text.starts_with("C(8)"), "{text}");
        }
    }
    // 500 expected, standard deviation 19; uniform from 0 to 8: mean 4, standard deviation 2.3.
    assert!((420..580).contains(&chosen), "{chosen}");
    let mean = lengths[0] / f64::from(chosen);
    assert!((3.6..4.4).contains(&mean), "{mean}");
}

#[test]
fn normal_numbers_have_their_mean_and_deviation() {
    let grammar = Grammar::new("A", &["A -> B(nran(10,2))"]).unwrap();
    let of = |seed| -> f64 {
        let text =
            derive_string(&grammar, &TurtleSettings { derivations: 1, seed, ..TurtleSettings::default() })
                .unwrap();
        text[2..text.len() - 1].parse().unwrap()
    };
    let values: Vec<f64> = (0..4000).map(of).collect();
    let mean = values.iter().sum::<f64>() / 4000.0;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / 4000.0;
    // Standard errors: 0.03 and 0.09.
    assert!((9.85..10.15).contains(&mean) && (3.6..4.4).contains(&variance), "{mean} {variance}");
}

#[test]
fn chance_in_conditions_is_asked_in_every_step() {
    let grammar = Grammar::new("A", &["A : ran(1) < 0.5 -> B"]).unwrap();
    let after = |derivations| {
        let left = |seed| {
            derive_string(&grammar, &TurtleSettings { derivations, seed, ..TurtleSettings::default() })
                .unwrap()
                == "A"
        };
        (0..1000).filter(|&seed| left(seed)).count()
    };
    // 500 and 31 expected, standard deviations 16 and 6.
    assert!((420..580).contains(&after(1)), "{}", after(1));
    assert!((8..60).contains(&after(5)), "{}", after(5));
}

#[test]
fn numbers_out_of_range_are_named() {
    let of = |axiom: &str, rule: &str, derivations| {
        let grammar = Grammar::new(axiom, &[rule]).unwrap();
        derive_string(&grammar, &TurtleSettings { derivations, ..TurtleSettings::default() })
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        of("A(3)", "A(x) -> A(x-2)F(x-4)", 1),
        "rule 1 (A(x) -> A(x-2)F(x-4)): derivation 1 gives F(-1): -1 is not 0 to 1000000; \
         mend the rule or use fewer derivations"
    );
    assert_eq!(
        of("A(1)", "A(x) -> A(x-1)B(1/x)", 3),
        "rule 1 (A(x) -> A(x-1)B(1/x)): derivation 2 gives B(inf): inf is not a finite number; \
         mend the rule or use fewer derivations"
    );
    assert!(of("A(0-1)", "A(x) -> B(sqrt(x),1)", 1).contains("gives B(NaN,1): NaN is not a finite number"));
    // A length may shrink to nothing.
    assert_eq!(derived("A(1)", &["A(x) -> F(x-1)"], 1), "F(0)");
    assert_eq!(derived("F(0)", &["F(x) -> F(x+1)"], 2), "F(2)");
    assert_eq!(derived("A", &["#define gap 0", "A -> F(gap)F"], 1), "F(0)F");
}

#[test]
fn hondas_and_aonos_trees_have_their_closed_counts() {
    // ABOP, Fig. 2.6 a: A -> !(w)F(l)[&(a0)B]/(d)A, B -> !F[-$C]C, C -> !F[+$B]B.
    let honda = [
        "#define r1 0.9",
        "#define r2 0.6",
        "#define a0 45",
        "#define a2 45",
        "#define d 137.5",
        "#define wr 0.707",
        "A(l,w) : * -> !(w)F(l)[&(a0)B(l*r2,w*wr)]/(d)A(l*r1,w*wr)",
        "B(l,w) : * -> !(w)F(l)[-(a2)$C(l*r2,w*wr)]C(l*r1,w*wr)",
        "C(l,w) : * -> !(w)F(l)[+(a2)$B(l*r2,w*wr)]B(l*r1,w*wr)",
    ];
    let grammar = Grammar::new("A(1,10)", &honda).unwrap();
    for n in [0, 1, 2, 5, 10] {
        // A lateral born in step k has doubled its apices n - k times: Σ (2^(n-k) - 1) segments, and
        // the stem's own n.
        let segments: u128 = u128::from(n) + (1..=n).map(|k| (1_u128 << (n - k)) - 1).sum::<u128>();
        let counted = forecast(&grammar, n).unwrap();
        assert_eq!((counted.segments, counted.exact), (segments, true), "{n}");
        let text =
            derive_string(&grammar, &TurtleSettings { derivations: n, ..TurtleSettings::default() }).unwrap();
        assert_eq!(text.matches("F(").count() as u128, segments);
    }
    // Fig. 2.7: every apex becomes two.
    let aono = [
        "A(l,w) -> !(w)F(l)[&(5)B(l*.9,w*.7)]/(180)[&(65)B(l*.7,w*.7)]",
        "B(l,w) -> !(w)F(l)[+(5)$B(l*.9,w*.7)][-(65)$B(l*.7,w*.7)]",
    ];
    let grammar = Grammar::new("A(1,10)", &aono).unwrap();
    assert_eq!(forecast(&grammar, 10).unwrap().segments, (1 << 10) - 1);
    // Fig. 2.8: each apex becomes a segment with three more, each of them with an apex: 1 + 4·Σ 3^k.
    let ternary = [
        "#define vr 1.732",
        "A -> !(vr)F(50)[&(18.95)F(50)A]/(94.74)[&(18.95)F(50)A]/(132.63)[&(18.95)F(50)A]",
        "F(l) -> F(l*1.109)",
        "!(w) -> !(w*vr)",
    ];
    let grammar = Grammar::new("!(1)F(200)/(45)A", &ternary).unwrap();
    let n = 6;
    assert_eq!(forecast(&grammar, n).unwrap().segments, 1 + 4 * (3_u128.pow(n) - 1) / 2);
    let text =
        derive_string(&grammar, &TurtleSettings { derivations: 2, ..TurtleSettings::default() }).unwrap();
    // 200·1.109², rewritten in both steps.
    assert!(text.starts_with("!(2.999824)F(245.9762"), "{text}");
}

#[test]
fn a_value_error_is_an_error_of_growing() {
    let grammar = Grammar::new("A(1)", &["A(x) -> F(0-x)A(x)"]).unwrap();
    let error =
        derive_string(&grammar, &TurtleSettings { derivations: 1, ..TurtleSettings::default() }).unwrap_err();
    let LsystemError::Value { module, value, derivation, .. } = error.cause() else { panic!("{error}") };
    assert_eq!((module.as_str(), *value, *derivation), ("F(-1)", -1.0, 1));
}

/// Every way of deriving names the same rule.
#[test]
fn what_goes_wrong_while_growing_names_the_rule_that_wrote_it() {
    let organs = "which names no organ; there are: L (leaf), K (blossom), B (berry), N (needle)";
    for (axiom, rules, steps, message) in [
        (
            "A(1)",
            &["A(x) -> F(x)A(x-1)", "F(x) -> F(x/0)"][..],
            2,
            "rule 2 (F(x) -> F(x/0)): derivation 2 gives F(inf): inf is not a finite number; \
             mend the rule or use fewer derivations",
        ),
        (
            "FF(1/2-1)",
            &["F(x) -> FF(x)"],
            0,
            "axiom: derivation 0 gives F(-0.5): -0.5 is not 0 to 1000000; mend the rule or use fewer derivations",
        ),
        // Written in the first step, and kept ever after.
        (
            "AB",
            &["#define r 2", "A -> A", "B -> F(1)G(r-4)", "G(x) : x > 0 -> F"],
            5,
            "rule 3 (B -> F(1)G(r-4)): derivation 1 gives G(-2): -2 is not 0 to 1000000; mend the rule or use fewer derivations",
        ),
        (
            "FX",
            &["X -> F}", "F -> FF"],
            3,
            "rule 1 (X -> F}): a '}' fills a polygon that no '{' has begun: each needs one before it, which no '%' cuts off",
        ),
        (
            "FX",
            &["X -> [{f]Y", "Y -> {f}F"],
            3,
            "rule 1 (X -> [{f]Y): a '{' begins a polygon that no '}' fills: each needs one behind it, which no '%' cuts off",
        ),
        (
            "FX",
            &["X -> F.F"],
            1,
            "rule 1 (X -> F.F): a '.' records a vertex, but no polygon is open: put it between '{' and '}'",
        ),
        ("FXY", &["X -> F~", "L -> F"], 1, &format!("rule 1 (X -> F~): '~' is followed by 'Y', {organs}")),
        (
            "FX(2)",
            &["X(x) -> F~L(x-3)"],
            1,
            "rule 1 (X(x) -> F~L(x-3)): '~L' is -1 segments large, but must be 0 to 1000000",
        ),
    ] {
        let grammar = Grammar::new(axiom, rules).unwrap();
        let settings = TurtleSettings { derivations: steps, ..TurtleSettings::default() };
        for way in [Way::Best, Way::BreadthFirst] {
            assert_eq!(
                grow_by(&grammar, &settings, way, &Quiet).unwrap_err().to_string(),
                message,
                "{way:?}"
            );
        }
        let undrawn =
            trace(&grammar, &settings, &Quiet).map_or_else(|error| error, |word| word.undrawn.unwrap());
        assert_eq!(undrawn.to_string(), message);
    }
}

/// A condition that divides by 0 is neither true nor false. Which side of '&&' asks first does not matter.
#[test]
fn a_condition_that_is_no_number_is_an_error() {
    let at = |axiom: &str, condition: &str, way| {
        let rules = ["#define r 2".to_owned(), format!("X(a) : {condition} -> F")];
        let settings = TurtleSettings { derivations: 1, ..TurtleSettings::default() };
        derive_by(&Grammar::new(axiom, &rules).unwrap(), &settings, way).map(|derived| derived.text)
    };
    for way in [Way::Best, Way::BreadthFirst] {
        for condition in
            ["1/a > 3", "sqrt(a-1)", "!(1/a > 3)", "a == 0 && 1/a > 3", "a > 0 || log(a) < 1", "1/a == 1/a"]
        {
            let error = at("FX(0)", condition, way).unwrap_err();
            assert!(
                matches!(error.cause(), LsystemError::Condition { derivation: 1, .. }),
                "{condition}: {error}"
            );
        }
        let error = at("FX(0)", "1/a > 3", way).unwrap_err().to_string();
        let message = "rule 2 (X(a) : 1/a>3 -> F): derivation 1 asks its condition of X(0), where it comes to no number: \
                       ask first what it divides by, as in 'x != 0 && 1/x > 3'";
        assert_eq!(error, message);
        for (condition, holds) in [
            ("a != 0 && 1/a > 3", false),
            ("1/a > 3 && a != 0", false),
            ("a == 0 || 1/a > 3", true),
            ("1/a > 3 || a == 0", true),
            ("min(a,1) < r && a >= -a", true),
            ("!a", true),
        ] {
            assert_eq!(
                at("FX(0)", condition, way).unwrap(),
                if holds { "FF" } else { "FX(0)" },
                "{condition}"
            );
        }
    }
}
