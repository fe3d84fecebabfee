//! The built-in L-systems: what they say, and what grows of it.

use std::path::Path;

use linden::Quiet;
use linden::lsystem::{Grammar, LSystem, TurtleSettings, grow, text};
use toml::Table;

use crate::{assert_sound, segments};

struct Preset {
    grammar: Grammar,
    settings: TurtleSettings,
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn read(group: &str, id: &str) -> Preset {
    let path = root().join("presets").join(group).join(format!("{id}.toml"));
    let table: Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
    assert_eq!((table["id"].as_str(), table["group"].as_str()), (Some(id), Some(group)));
    let system = &table["lsystem"];
    let rules: Vec<&str> = system["rules"].as_array().unwrap().iter().map(|r| r.as_str().unwrap()).collect();
    let number = |key: &str| system[key].as_float().or(system[key].as_integer().map(|n| n as f64)).unwrap();
    Preset {
        grammar: Grammar::new(system["axiom"].as_str().unwrap(), &rules).unwrap(),
        settings: TurtleSettings {
            derivations: number("derivations") as u32,
            angle_deg: number("angle"),
            segment_m: number("segment_length"),
            ..TurtleSettings::default()
        },
    }
}

const ALL: [(&str, &[&str]); 2] = [
    ("abop", &["abop-a", "abop-b", "abop-c", "abop-d", "abop-e", "abop-f", "bush-3d", "abop-stochastic"]),
    ("older", &["older-a", "older-b", "older-c", "older-d", "older-e", "older-f", "older-c-stochastic"]),
];

#[test]
fn every_preset_stands_as_high_as_a_small_tree() {
    for (group, ids) in ALL {
        for id in ids {
            let Preset { grammar, settings } = read(group, id);
            for seed in 0..5 {
                let grown = grow(&grammar, &TurtleSettings { seed, ..settings }, &Quiet).unwrap();
                assert_sound(&grown);
                let height = |f: fn(f32, f32) -> f32| grown.branching.positions.iter().map(|p| p.y).reduce(f);
                let height_m = height(f32::max).unwrap() - height(f32::min).unwrap();
                assert!((1.5..=6.0).contains(&height_m), "{id}, seed {seed}: {height_m} m high");
            }
        }
    }
}

#[test]
fn abops_presets_have_the_published_segments() {
    let counts = [("a", 3125), ("b", 3125), ("c", 4096), ("d", 4118), ("e", 4118), ("f", 1488)];
    for (letter, count) in counts {
        let Preset { grammar, settings } = read("abop", &format!("abop-{letter}"));
        let grown = grow(&grammar, &settings, &Quiet).unwrap();
        assert_eq!(segments(&grown.branching), count, "abop-{letter}");
    }
    let Preset { grammar, settings } = read("abop", "bush-3d");
    assert_eq!(segments(&grow(&grammar, &settings, &Quiet).unwrap().branching), 216);
}

#[test]
fn the_older_trees_say_what_their_files_say() {
    for (id, file) in [
        ("older-a", "treeA"),
        ("older-b", "treeB"),
        ("older-c", "treeC"),
        ("older-d", "treeD"),
        ("older-e", "treeE"),
        ("older-f", "treeF"),
        ("older-c-stochastic", "treeC-stochastic"),
    ] {
        let file = root().join("tests/grammars").join(format!("{file}.txt"));
        let original = text::parse(&std::fs::read_to_string(file).unwrap()).unwrap();
        let Preset { grammar, settings } = read("older", id);
        assert_eq!(grammar, original.grammar, "{id}");
        assert_eq!((settings.angle_deg, settings.derivations), (original.angle_deg, original.derivations));
    }
}

/// What is built in has no rule that never applies.
#[test]
fn every_rule_of_a_preset_can_apply() {
    let mut count = 0;
    for builtin in linden::preset::builtins() {
        let preset = builtin.load().unwrap();
        let Some(system) = preset.settings::<LSystem>() else { continue };
        assert_eq!(system.grammar.unused(), [""; 0], "{}", preset.id);
        count += 1;
    }
    assert!(count > 15, "{count}");
}
