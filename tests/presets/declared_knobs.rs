//! Knobs that grammars bring along: each grows another tree, at both ends of its range.

use linden::Quiet;
use linden::grow::grow;
use linden::knob::Kind;
use linden::preset::{LSystem, Preset, builtins};
use linden::recipe::Recipe;

fn tree(preset: &Preset, what: &str) -> String {
    let grown = grow(&Recipe::new(preset.clone()), &Quiet).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(grown.skeleton.positions.iter().all(|position| position.is_finite()), "{what}");
    format!("{:?} {:?}", grown.hash(), grown.organs.hash())
}

#[test]
fn each_knob_of_a_grammar_grows_another_tree_at_both_ends() {
    let mut turned = 0;
    for builtin in builtins() {
        let preset = builtin.load().unwrap();
        let Some(settings) = preset.settings::<LSystem>() else { continue };
        let knobs: Vec<_> = settings.exposed.iter().map(|exposed| exposed.knob).collect();
        if knobs.is_empty() {
            continue;
        }
        let usual = tree(&preset, builtin.id);
        for knob in knobs {
            let Kind::Real { min, max, .. } = knob.kind else { panic!("{}", knob.name) };
            for end in [min, max] {
                let what = format!("{}: {}={end}", builtin.id, knob.name);
                let mut other = preset.clone();
                other.set(knob.name, &end.to_string()).unwrap();
                // Some rules have the end of a range for their default.
                if other != preset {
                    assert_ne!(tree(&other, &what), usual, "{what} has no effect");
                    turned += 1;
                }
            }
        }
    }
    assert!(turned > 200, "{turned}");
}
