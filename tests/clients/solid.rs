//! Wood as one solid, before trimesh: for printing and simulation.

use linden::dress::dress;
use linden::grow::grow;
use linden::preset::builtin;
use linden::{NO_PARENT, Quiet};
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;

use crate::outside::{exported, run};

#[test]
fn watertight_wood_is_one_closed_manifold() {
    let dir = exported("solid");
    let features = [("collar", "0.6"), ("flare", "0.8"), ("flare_ridges", "5"), ("ends", "cut")];
    for (id, features) in
        [("simple", &[][..]), ("simple", &features[..]), ("grove", &features[..2]), ("abop-honda-a", &[])]
    {
        let mut recipe = recipe(builtin(id).unwrap());
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
    run("solid.py", &dir);
}
