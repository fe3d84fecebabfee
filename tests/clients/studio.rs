//! USD as studios put it together: payloads, proxies, labels, what an asset says about itself.

use linden::Quiet;
use linden::dress::levels;
use linden::stage::Stage;
use linden_tests::fixtures::export_stage;

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn usd_is_put_together_as_studios_do() {
    let dir = exported("clients-studio");
    let ways: [(&str, &[(&str, &str)]); 3] = [
        ("still", &[("lods", "3"), ("triangles", "4000")]),
        ("sway", &[("lods", "2"), ("triangles", "2000"), ("wind", "sway")]),
        ("single", &[("triangles", "2000")]),
    ];
    for (way, knobs) in ways {
        let (recipe, grown, scene) = dressed(knobs);
        let levels = levels(&recipe, &grown, &Quiet).unwrap();
        let stage = if way == "single" { Stage::of(&scene) } else { levels.stage() };
        for format in ["usda", "usdc"] {
            for (name, options) in [
                ("whole", &[][..]),
                ("proxy", &[("proxy", "true")]),
                ("payload", &[("payload", "true")]),
                ("both", &[("payload", "true"), ("proxy", "true"), ("collision", "hull")]),
                ("both_instances", &[("payload", "true"), ("proxy", "true"), ("instances", "true")]),
            ] {
                let file = dir.join(format!("{way}-{name}.{format}"));
                export_stage(&stage, format, options, &file).unwrap();
            }
        }
        let file = dir.join(format!("{way}-proxy.usdz"));
        export_stage(&stage, "usdz", &[("proxy", "true"), ("layer", "binary")], &file).unwrap();
        let file = dir.join(format!("{way}-ar.usdz"));
        export_stage(&stage, "usdz", &[("flavor", "ar")], &file).unwrap();
    }
    run("studio.py", &dir);
    run("check.py", &dir);
}
