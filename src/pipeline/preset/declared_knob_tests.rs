//! Constants of a grammar that a document makes knobs.

use glam::DVec3;
use linden_base::knob::Value;
use linden_lsystem::{Grammar, LSystem};

use crate::Quiet;
use crate::grow::grow;
use crate::preset::{Preset, builtins};
use crate::recipe::Recipe;

/// A stem with one branch whose angle and length are knobs.
const BRANCH: &str = r##"id = "branch"

[lsystem]
axiom = "F(1)[+(limb)F(half)]F(1)"
rules = [
  "#define limb 45", # of the trunk
  "#define long 1.5",
  "#define half long/2",
]
knobs = [
  "limb 10..80 deg: angle of the branch", # to the trunk
  "long 0.5..4 m: twice the branch's length",
]
segment_length = 1
"##;

fn branch() -> Preset {
    Preset::from_toml(BRANCH).unwrap()
}

/// The value that a knob has.
fn value(preset: &Preset, name: &str) -> Option<f64> {
    let found = preset.knobs().into_iter().find(|(row, _)| row.knob.name == name);
    found.and_then(|(_, value)| if let Value::Real(number) = value { Some(number) } else { None })
}

/// From where the branch leaves the stem to its tip.
fn limb(preset: &Preset) -> DVec3 {
    let grown = grow(&Recipe::new(preset.clone()), &Quiet).unwrap();
    let nodes = grown.skeleton.positions.iter().map(|position| position.as_dvec3());
    let tip = nodes.max_by(|a, b| a.x.hypot(a.z).total_cmp(&b.x.hypot(b.z))).unwrap();
    tip - DVec3::Y
}

fn assert_limb(preset: &Preset, degrees: f64, length: f64) {
    let limb = limb(preset);
    let angle = limb.angle_between(DVec3::Y).to_degrees();
    assert!((angle - degrees).abs() < 1e-3, "{angle} degrees instead of {degrees}");
    assert!((limb.length() - length).abs() < 1e-4, "{} m instead of {length}", limb.length());
}

fn message(document: &str) -> String {
    Preset::from_toml(document).unwrap_err().to_string()
}

#[test]
fn a_declared_constant_is_a_knob_that_turns_what_is_grown() {
    let mut preset = branch();
    assert_eq!(
        (value(&preset, "limb"), value(&preset, "long"), value(&preset, "half")),
        (Some(45.0), Some(1.5), None)
    );
    assert_limb(&preset, 45.0, 0.75);
    preset.set("limb", "70").unwrap();
    // What follows from a knob follows.
    preset.set("long", "3").unwrap();
    assert_limb(&preset, 70.0, 1.5);
    let said = preset.set("limb", "81").unwrap_err().to_string();
    assert!(said.contains("knob 'limb' (in deg)") && said.contains("outside the range: 10 to 80"), "{said}");
    assert_limb(&preset, 70.0, 1.5);
    let said = preset.set("limp", "20").unwrap_err().to_string();
    assert!(said.contains("did you mean 'limb' (in deg): 10 to 80"), "{said}");
}

#[test]
fn rules_stay_as_they_are_written_and_the_value_stands_under_its_name() {
    let mut preset = branch();
    assert_eq!(preset.edit_toml(BRANCH).unwrap(), BRANCH);
    preset.set("limb", "70").unwrap();
    let edited = preset.edit_toml(BRANCH).unwrap();
    assert_eq!(edited, format!("{BRANCH}limb = 70\n"));
    let whole = preset.to_toml().unwrap();
    assert!(whole.contains("#define limb 45") && whole.contains("\nlimb = 70.0\n"), "{whole}");
    let line = Recipe::new(preset.clone()).to_line();
    let read = [&edited, &whole, &preset.to_toml_changed().unwrap()].map(|text| Preset::from_toml(text));
    for read in read.into_iter().chain([Preset::from_json(&line)]) {
        let read = read.unwrap();
        assert_eq!(read, preset);
        assert_limb(&read, 70.0, 0.75);
    }
    // Turned back, the document is as it was.
    preset.set("limb", "45").unwrap();
    assert_eq!(preset, branch());
    assert_eq!(preset.edit_toml(&edited).unwrap(), BRANCH);
}

#[test]
fn each_seed_draws_it_where_it_has_a_spread() {
    let text = format!("{BRANCH}limb = \"45 ± 5\"\n");
    let mut preset = Preset::from_toml(&text).unwrap();
    let of = |preset: &mut Preset, seed| {
        preset.set_seed(seed);
        value(preset, "limb").unwrap()
    };
    let drawn: Vec<f64> = (0..50).map(|seed| of(&mut preset, seed)).collect();
    let mean = drawn.iter().sum::<f64>() / 50.0;
    assert!((mean - 45.0).abs() < 3.0 && drawn.iter().any(|limb| (limb - mean).abs() > 3.0), "{drawn:?}");
    assert_limb(&preset, drawn[49], 0.75);
    assert_eq!(of(&mut preset, 7), drawn[7]);
    let written = preset.to_toml().unwrap();
    assert!(written.contains("#define limb 45") && written.contains("limb = \"45 ± 5\""), "{written}");
    assert_eq!(Preset::from_toml(&written).unwrap(), preset);
}

#[test]
fn ages_turn_it() {
    let text = format!("{BRANCH}\n[age.young]\nlimb = 20\n");
    let preset = Preset::from_toml(&text).unwrap();
    let young = preset.at_age(&preset.ages_of("young").unwrap()[0]).unwrap();
    assert_limb(&young, 20.0, 0.75);
    assert_limb(&preset, 45.0, 0.75);
    assert_eq!(preset.edit_toml(&text).unwrap(), text);
    let said = message(&text.replace("limb = 20", "limb = 90"));
    assert!(
        said.contains("limb") && said.contains("outside the range: 10 to 80") && said.starts_with("17:8: "),
        "{said}"
    );
}

#[test]
fn what_defines_a_constant_turns_its_knob() {
    let mut preset = branch();
    preset.define("limb", "70").unwrap();
    assert_limb(&preset, 70.0, 0.75);
    let said = preset.define("limb", "5").unwrap_err().to_string();
    assert!(said.contains("knob 'limb'") && said.contains("outside the range: 10 to 80"), "{said}");
    // One that is no knob is defined anew; what is a knob stays one.
    preset.define("half", "long").unwrap();
    preset.set("long", "2").unwrap();
    assert_limb(&preset, 70.0, 2.0);
    let written = preset.to_toml().unwrap();
    assert!(written.contains("#define half long\"") && written.contains("#define limb 45"), "{written}");
    assert_eq!(Preset::from_toml(&written).unwrap(), preset);
}

#[test]
fn a_grammar_that_has_lost_the_constant_has_lost_the_knob() {
    let mut preset = branch();
    preset.set("limb", "70").unwrap();
    let settings = preset.settings_mut::<LSystem>().unwrap();
    settings.grammar = Grammar::new("F(1)[+(30)F(long)]F(1)", &["#define long 2"]).unwrap();
    assert_eq!((value(&preset, "limb"), value(&preset, "long")), (None, Some(2.0)));
    assert!(preset.set("limb", "50").is_err());
    assert_limb(&preset, 30.0, 2.0);
    let written = preset.to_toml().unwrap();
    assert!(!written.contains("\"limb") && !written.contains("\nlimb ="), "{written}");
    assert_limb(&Preset::from_toml(&written).unwrap(), 30.0, 2.0);
}

#[test]
fn a_number_that_the_other_constants_cannot_have_is_said_when_it_grows() {
    let text = BRANCH.replace("long/2", "1/((long-1)*(long-1))");
    let mut preset = Preset::from_toml(&text).unwrap();
    preset.set("long", "1").unwrap();
    let said = grow(&Recipe::new(preset.clone()), &Quiet).unwrap_err().to_string();
    assert!(said.contains("long=1: rule 3, column 14") && said.contains("inf"), "{said}");
    // Another knob that can be turned hides nothing.
    preset.set("limb", "50").unwrap();
    assert!(grow(&Recipe::new(preset.clone()), &Quiet).is_err());
    preset.set("long", "3").unwrap();
    assert_limb(&preset, 50.0, 0.25);
}

#[test]
fn faults_name_the_declaration_and_its_line() {
    let limb = "limb 10..80 deg: angle of the branch";
    let long = "long 0.5..4 m: twice the branch's length";
    for (declaration, expected) in [
        ("limb 10..80 deg", "has no ':'"),
        ("limb 10..80 deg: ", "nothing behind its ':'"),
        ("limb: an angle", "no name and range"),
        ("limb 10..80 deg more: an angle", "more than a name, a range and a unit"),
        ("limb 10-80: an angle", "no range LEAST..MOST"),
        ("limb a..80: an angle", "no numbers"),
        ("limb 0..inf: an angle", "no numbers"),
        ("limb 80..10: an angle", "empty range"),
        ("limb 10..80 degrees-of-arc: an angle", "12 characters"),
        ("limb 10..80: \u{200b}", "cannot be seen"),
        ("limp 10..80: an angle", "did you mean 'limb'?"),
        ("half -1..1: a length", "half = -1 is out of range"),
        ("half 0.1..1: a length", "follows from other constants"),
        ("limb 50..80: an angle", "outside of its range 50 to 80"),
        (long, "'long' is the name of another knob"),
    ] {
        let said = message(&BRANCH.replace(limb, declaration));
        assert!(said.contains("knobs, text") && said.contains(expected), "{declaration}: {said}");
        let line = if declaration == long { "12:3: " } else { "11:3: " };
        assert!(said.starts_with(line), "{declaration}: {said}");
    }
    let many: Vec<String> = (0..65).map(|i| format!("\"#define x{i} 1\",\n")).collect();
    let declared: Vec<String> = (0..65).map(|i| format!("\"x{i} 0..2: some\",\n")).collect();
    let text = BRANCH
        .replace("\n]\nknobs = [\n", &format!("\n{}]\nknobs = [\n{}", many.concat(), declared.concat()));
    assert!(message(&text).contains("more than 64 constants"), "{}", message(&text));
}

#[test]
fn it_is_called_as_no_other_knob_or_key_is() {
    for name in ["derivations", "angle", "seed", "flare", "leaf_keep", "rules", "knobs", "name", "width"] {
        let said = message(&BRANCH.replace("long", name));
        assert!(said.contains(&format!("'{name}'")) && said.contains("another"), "{name}: {said}");
    }
}

#[test]
fn the_knobs_of_built_in_grammars_stand_at_what_their_rules_define() {
    let mut found = 0;
    for builtin in builtins() {
        let preset = builtin.load().unwrap();
        let Some(settings) = preset.settings::<LSystem>() else { continue };
        for exposed in &settings.exposed {
            found += 1;
            if !builtin.text.contains(&format!("\n{} = ", exposed.knob.name)) {
                let written: f64 = exposed.written.parse().unwrap();
                assert_eq!(value(&preset, exposed.knob.name), Some(written), "{}", builtin.id);
            }
        }
    }
    assert!(found >= 50, "{found}");
}
