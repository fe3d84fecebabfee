//! Trees that sway by joints, before every client: valid, and usd-core skins them as we do.

use glam::Vec3;
use linden::Quiet;
use linden::dress::{Level, levels};
use linden::stage::{Place, Stage};
use linden_tests::fixtures::{export, export_stage};

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn every_client_takes_what_has_joints() {
    let dir = exported("clients-bones");
    let bones = ("wind", "bones");
    let (_, _, scene) = dressed(&[bones, ("bones", "60")]);
    for format in ["usda", "usdc"] {
        let stem = dir.join(format!("tree_{format}"));
        export(&scene, format, &[], &stem.with_extension(format)).unwrap();
        export(&scene, "glb", &[], &stem.with_extension("glb")).unwrap();
    }
    run("bones.py", &dir);
    export(&scene, "gltf", &[("quantize", "true")], &dir.join("quantized.gltf")).unwrap();
    export(&scene, "usdz", &[], &dir.join("tree.usdz")).unwrap();
    let (recipe, grown, _) = dressed(&[bones, ("lods", "2")]);
    let all = levels(&recipe, &grown, &Quiet).unwrap().levels;
    let stage = Stage::of_levels(&all[0].scene, all.iter().map(Level::on_stage).collect());
    for (file, options) in [
        ("msft.glb", &[][..]),
        ("siblings.glb", &[("lods", "siblings"), ("quantize", "true")]),
        ("levels.usda", &[]),
    ] {
        export_stage(&stage, &file[file.len() - 4..].replace('.', ""), options, &dir.join(file)).unwrap();
    }
    let mut wood = Stage::of(&scene);
    wood.places = vec![Place::origin(0), Place { position: Vec3::X * 9.0, scale: 0.7, ..Place::origin(0) }];
    // By other names, so that they are not compared: check.py looks at nodes, and where what is bound stands its joints
    // say. tests/bones goes by these.
    export_stage(&wood, "glb", &[], &dir.join("grove.glb")).unwrap();
    export_stage(&wood, "usda", &[], &dir.join("wood.usda")).unwrap();
    run("check.py", &dir);
}
