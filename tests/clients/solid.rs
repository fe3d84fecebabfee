//! Wood as one solid, before trimesh: for printing and simulation.

use linden::dress::dress;
use linden::grow::grow;
use linden::preset::{Preset, builtin};
use linden::recipe::{Input, Recipe};
use linden::{NO_PARENT, Quiet};
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;

use crate::outside::{exported, run};

#[test]
fn watertight_wood_is_one_closed_manifold() {
    let dir = exported("solid");
    let features = [("collar", "0.6"), ("flare", "0.8"), ("flare_ridges", "5"), ("ends", "cut")];
    for (id, features) in [("simple", &features[..]), ("grove", &features[..2]), ("abop-honda-a", &[])] {
        let mut recipe = recipe(builtin(id).unwrap());
        // Fewer branches meet in the same ways.
        match id {
            "simple" => recipe.preset.set("points", "120").unwrap(),
            "grove" => {
                recipe.preset.set("points", "160").unwrap();
                // In larger cells, too.
                recipe.preset.set("junction_detail", "16").unwrap();
            }
            _ => recipe.preset.set("derivations", "6").unwrap(),
        }
        for &(knob, value) in [("junction", "watertight"), ("bark_size", "16")].iter().chain(features) {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        let stems = grown.skeleton.axes.iter().filter(|axis| axis.parent == NO_PARENT).count();
        for format in ["ply", "stl"] {
            let name = format!("{id}-{}_{stems}.{format}", features.len());
            export(&scene, format, &[], &dir.join(name)).unwrap();
        }
    }
    // And of a tree that came as cylinders of another program.
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cylinders/treeqsm.txt");
    let mut preset = Preset::of_cylinders("cylinders", "treeqsm.txt", false);
    preset.set("junction", "watertight").unwrap();
    let input = Input::read("treeqsm.txt", &std::fs::read(table).unwrap(), &Quiet).unwrap();
    let recipe = Recipe::with_files(preset, [("treeqsm.txt", input)].into_iter().collect());
    let scene = dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap();
    for format in ["ply", "stl"] {
        export(&scene, format, &[], &dir.join(format!("cylinders_1.{format}"))).unwrap();
    }
    run("solid.py", &dir);
}
