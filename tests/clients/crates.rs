//! Binary USD holds what text does: every field, arrays to the bit.

use linden::Quiet;
use linden::dress::levels;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::stage::{Place, Plant, Stage};
use linden_tests::fixtures::export_stage;

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn binary_usd_is_the_text() {
    let dir = exported("clients-crates");
    let both = |name: &str, stage: &Stage<'_>, options: &[(&str, &str)]| {
        for format in ["usda", "usdc"] {
            export_stage(stage, format, options, &dir.join(format!("{name}.{format}"))).unwrap();
        }
    };
    let (recipe, grown, scene) = dressed(&[("lods", "3"), ("triangles", "4000")]);
    let stage = Stage::of(&scene);
    both("plain", &stage, &[]);
    both("bare", &stage, &[("pictures", "false"), ("skeleton", "false"), ("materialx", "false")]);
    both("instances", &stage, &[("instances", "true")]);
    both("capsules", &stage, &[("collision", "capsules")]);
    both("hull", &stage, &[("collision", "hull")]);
    both("setting", &stage.clone().in_setting(), &[]);
    both("levels", &levels(&recipe, &grown, &Quiet).unwrap().stage(), &[]);
    both("proxy", &levels(&recipe, &grown, &Quiet).unwrap().stage(), &[("proxy", "true")]);
    // Texts that have to be quoted.
    let odd = Stage { name: "odd \"name\" \\ \u{f6} #2 @x@ <y>".to_owned(), ..stage.clone() };
    both("odd", &odd, &[]);
    let swaying = dressed(&[("wind", "sway")]).2;
    both("sway", &Stage::of(&swaying), &[]);
    let mut wood = stage.clone();
    wood.plants.push(Plant::of(&swaying));
    wood.places.push(Place { turn_rad: 1.0, scale: 1.5, ..Place::origin(1) });
    wood.places.push(Place::origin(0));
    both("wood", &wood, &[]);
    both("wood_instances", &wood, &[("instances", "true")]);
    for id in ["fir", "older-f", "date-palm"] {
        let mut preset = builtin(id).unwrap().load().unwrap();
        preset.set("bark_size", "64").unwrap();
        let recipe = Recipe::new(preset);
        let grown = linden::grow::grow(&recipe, &Quiet).unwrap();
        let scene = linden::dress::dress(&recipe, &grown, &Quiet).unwrap();
        both(id, &Stage::of(&scene), &[]);
    }
    run("crates.py", &dir);
}
