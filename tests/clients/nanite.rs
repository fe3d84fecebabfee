//! Unreal's Nanite assemblies: what the schema asks for is there, all is bound to what bears it, and it is the same tree.

use linden::Quiet;
use linden::dress::{Level, levels};
use linden::stage::Stage;
use linden_tests::fixtures::{export, export_stage};

use crate::instances::dressed;
use crate::outside::{exported, run};

const SKELETAL: (&str, &str) = ("nanite", "skeletal");
const STATIC: (&str, &str) = ("nanite", "static");

#[test]
fn assemblies_are_whole_and_bound_to_what_bears_them() {
    let dir = exported("clients-nanite");
    let flat = ("leaf_normals", "flat");
    let (_, _, scene) = dressed(&[("wind", "bones"), ("bones", "60"), flat]);
    for (format, name, nanite) in [
        ("usda", "skeletal.usda", SKELETAL),
        ("usdc", "skeletal_binary.usdc", SKELETAL),
        ("usda", "static.usda", STATIC),
        ("usdc", "static_binary.usdc", STATIC),
    ] {
        export(&scene, format, &[nanite], &dir.join(name)).unwrap();
    }
    export(&scene, "usdc", &[], &dir.join("curves.usdc")).unwrap();
    run("nanite.py", &dir);
    // What the others are compared with is baked.
    export(&scene, "obj", &[], &dir.join("baked.obj")).unwrap();
    run("check.py", &dir);
}

#[test]
fn of_several_levels_the_finest_is_in_it() {
    let dir = exported("clients-nanite-levels");
    let (recipe, grown, scene) = dressed(&[("wind", "bones"), ("bones", "60"), ("lods", "2")]);
    let all = levels(&recipe, &grown, &Quiet).unwrap().levels;
    let stage = Stage::of_levels(&all[0].scene, all.iter().map(Level::on_stage).collect());
    export_stage(&stage, "usda", &[SKELETAL], &dir.join("levels.usda")).unwrap();
    export(&scene, "usda", &[SKELETAL], &dir.join("one.usda")).unwrap();
    let read = |name: &str| std::fs::read(dir.join(name)).unwrap();
    assert_eq!(read("levels_wind.json"), read("one_wind.json"));
    export(&scene, "usdc", &[], &dir.join("curves.usdc")).unwrap();
    run("nanite.py", &dir);
}
