//! Every built-in preset in every format, before every client.

use linden::Quiet;
use linden::dress::dress;
use linden::grow::grow;
use linden::preset::builtins;
use linden_exporters::REGISTRY;
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;

use crate::outside::{exported, run};

#[test]
fn every_preset_passes_every_client_in_every_format() {
    let dir = exported("presets");
    for builtin in builtins() {
        let recipe = recipe(builtin);
        let grown = grow(&recipe, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        for exporter in REGISTRY {
            let format = exporter.format();
            let name = match format.extensions.first() {
                Some(ending) => format!("{}.{ending}", builtin.id),
                None => format!("{}_skeleton.ply", builtin.id),
            };
            export(&scene, format.id, &[], &dir.join(name)).unwrap();
        }
    }
    run("check.py", &dir);
}
