//! Every built-in preset before every client.

use linden::Quiet;
use linden::dress::levels;
use linden_exporters::REGISTRY;
use linden_tests::fixtures::export;
use linden_tests::presets::{Plant, plants};
use rayon::prelude::*;

use crate::outside::{exported, run};

/// As much as shows every part and every material; a million leaves teach a validator nothing.
const SMALL: [(&str, &str); 4] =
    [("triangles", "4000"), ("bark_size", "64"), ("leaf_size", "64"), ("card_size", "128")];

/// Every preset is written in the formats that hold all of a plant, glTF or by turns OpenUSD. Of the others each has those
/// whose turn it is: writers see scenes, not presets.
fn has_turn(preset: usize, number: usize, format: &str) -> bool {
    let turns = match format {
        "glb" => 1,
        "usdc" => 2,
        _ => 4,
    };
    (number + preset).is_multiple_of(turns)
}

#[test]
fn every_preset_passes_every_client() {
    let dir = exported("presets");
    plants().par_iter().enumerate().for_each(|(turn, Plant { id, recipe, grown })| {
        // What is grown does not hang on how it is shown.
        let mut recipe = recipe.clone();
        // Some have their pictures as they are.
        let small = if turn.is_multiple_of(16) { &SMALL[..1] } else { &SMALL };
        for (knob, value) in small {
            recipe.preset.set(knob, value).unwrap();
        }
        let levels = levels(&recipe, grown, &Quiet).unwrap();
        let scene = &levels.levels[0].scene;
        for (number, exporter) in REGISTRY.iter().enumerate() {
            let format = exporter.format();
            if !has_turn(turn, number, format.id) {
                continue;
            }
            let name = match format.extensions.first() {
                Some(ending) => format!("{id}.{ending}"),
                None => format!("{id}_skeleton.ply"),
            };
            export(scene, format.id, &[], &dir.join(name)).unwrap();
        }
    });
    run("check.py", &dir);
}
