//! Every built-in preset before every client.

use linden::Quiet;
use linden::dress::levels;
use linden::grow::grow;
use linden::preset::builtins;
use linden_exporters::REGISTRY;
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;
use rayon::prelude::*;

use crate::outside::{exported, run};

/// As much as shows every part and every material; a million leaves teach a validator nothing.
const SMALL: [(&str, &str); 3] = [("triangles", "8000"), ("bark_size", "128"), ("leaf_size", "256")];

/// The formats that hold all of a plant: every preset is written in these.
const FULL: [&str; 2] = ["glb", "usdc"];

/// Of the others each preset has those whose turn it is: writers see scenes, not presets.
const TURNS: usize = 4;

#[test]
fn every_preset_passes_every_client() {
    let dir = exported("presets");
    builtins().par_iter().enumerate().for_each(|(turn, builtin)| {
        let mut recipe = recipe(builtin);
        for (knob, value) in SMALL {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let levels = levels(&recipe, &grown, &Quiet).unwrap();
        let scene = &levels.levels[0].scene;
        for (number, exporter) in REGISTRY.iter().enumerate() {
            let format = exporter.format();
            if !FULL.contains(&format.id) && (number + turn) % TURNS != 0 {
                continue;
            }
            let name = match format.extensions.first() {
                Some(ending) => format!("{}.{ending}", builtin.id),
                None => format!("{}_skeleton.ply", builtin.id),
            };
            export(scene, format.id, &[], &dir.join(name)).unwrap();
        }
    });
    run("check.py", &dir);
}
