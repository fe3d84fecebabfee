//! Every built-in preset in every format, before every client.

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

#[test]
fn every_preset_passes_every_client_in_every_format() {
    let dir = exported("presets");
    builtins().par_iter().for_each(|builtin| {
        let mut recipe = recipe(builtin);
        for (knob, value) in SMALL {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let levels = levels(&recipe, &grown, &Quiet).unwrap();
        let scene = &levels.levels[0].scene;
        for exporter in REGISTRY {
            let format = exporter.format();
            let name = match format.extensions.first() {
                Some(ending) => format!("{}.{ending}", builtin.id),
                None => format!("{}_skeleton.ply", builtin.id),
            };
            export(scene, format.id, &[], &dir.join(name)).unwrap();
        }
    });
    run("check.py", &dir);
}
