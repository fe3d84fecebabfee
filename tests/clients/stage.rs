//! Forests, settings, levels, seasons, packages, instances and vertices in fewer bits, before every
//! client.

use glam::Vec3;
use linden::scene::Scene;
use linden::stage::{Level, Place, Plant, Season, Stage};
use linden_tests::fixtures::{export_stage, scene};

use crate::outside::{exported, run};

/// Two kinds of trees; the second has another material of the same name.
fn trees() -> [Scene; 2] {
    let mut other = scene(5, 6);
    "Acer".clone_into(&mut other.name);
    r#"{"preset":"acer"}"#.clone_into(&mut other.recipe);
    other.materials[1].base_color = [0.6, 0.1, 0.1];
    [scene(9, 7), other]
}

fn wood(trees: &[Scene; 2]) -> Stage<'_> {
    let place =
        |plant, x, z, turn_rad, scale| Place { plant, position: Vec3::new(x, 0.25, z), turn_rad, scale };
    Stage {
        name: "A wood".to_owned(),
        recipe: r#"{"forest":[0.1,2]}"#.to_owned(),
        plants: trees.iter().map(Plant::of).collect(),
        places: vec![
            place(0, -4.0, 1.0, 0.5, 1.0),
            place(1, 3.0, -2.5, 2.0, 1.25),
            place(0, 6.0, 5.0, 4.5, 0.75),
            Place::origin(1),
        ],
        setting: None,
        turned: Vec::new(),
    }
}

#[test]
fn every_client_takes_a_forest_by_every_way() {
    let trees = trees();
    let wood = wood(&trees);
    let ways: [(&str, &[(&str, &str)]); 3] =
        [("plain", &[]), ("instances", &[("instances", "true")]), ("quantize", &[("quantize", "true")])];
    for (way, options) in ways {
        let dir = exported(&format!("clients-forest-{way}"));
        for format in ["obj", "ply", "gltf", "glb", "usda", "usdz"] {
            let known = linden_exporters::find(format).unwrap().format().options;
            let known_options: Vec<_> = options
                .iter()
                .copied()
                .filter(|(name, _)| known.iter().any(|row| row.knob.name == *name))
                .collect();
            export_stage(&wood, format, &known_options, &dir.join(format!("wood.{format}"))).unwrap();
        }
        run("check.py", &dir);
    }
}

#[test]
fn every_client_takes_a_setting() {
    let trees = trees();
    let dir = exported("clients-setting");
    for (name, stage) in [("wood", wood(&trees)), ("tree", Stage::of(&trees[0]))] {
        let stage = stage.in_setting();
        for format in ["obj", "gltf", "glb", "usda", "usdz"] {
            export_stage(&stage, format, &[], &dir.join(format!("{name}.{format}"))).unwrap();
        }
        for (format, option) in [("glb", ("quantize", "true")), ("usdz", ("flavor", "ar"))] {
            export_stage(&stage, format, &[option], &dir.join(format!("{name}_{}.{format}", option.0)))
                .unwrap();
        }
        let (document, ..) = gltf::import(dir.join(format!("{name}.glb"))).unwrap();
        assert_eq!(document.cameras().count(), 1);
        let nodes: Vec<_> = document.nodes().filter_map(|node| node.name().map(str::to_owned)).collect();
        assert!(
            ["Camera", "Sun", "Sky", "Ground"].iter().all(|wanted| nodes.iter().any(|name| name == wanted))
        );
    }
    run("check.py", &dir);
}

#[test]
fn levels_and_seasons_are_variants() {
    let [summer, _] = trees();
    let coarse = scene(4, 3);
    let mut autumn = summer.clone();
    autumn.materials[1].base_color = [0.7, 0.4, 0.05];
    let mut bare = coarse.clone();
    bare.materials[1].base_color = [0.7, 0.4, 0.05];
    let season = |name: &str, fine, coarse| Season {
        name: name.to_owned(),
        levels: vec![Level { scene: fine, coverage: 0.5 }, Level { scene: coarse, coverage: 0.1 }],
    };
    let mut stage = Stage::of(&summer);
    stage.plants[0].seasons = vec![season("summer", &summer, &coarse), season("autumn", &autumn, &bare)];
    let dir = exported("clients-variants");
    for format in ["glb", "gltf", "usda", "usdz"] {
        export_stage(&stage, format, &[], &dir.join(format!("tree.{format}"))).unwrap();
    }
    export_stage(&stage.at_level(0), "obj", &[], &dir.join("tree.obj")).unwrap();
    run("check.py", &dir);
    run("variants.py", &dir);

    let (document, ..) = gltf::import(dir.join("tree.glb")).unwrap();
    let names: Vec<_> = document.nodes().filter_map(|node| node.name().map(str::to_owned)).collect();
    for level in ["_LOD0", "_LOD1"] {
        assert!(names.iter().any(|name| name.starts_with("Tilia") && name.ends_with(level)), "{names:?}");
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_or_told() {
    let trees = trees();
    let wood = wood(&trees);
    let dir = tempfile::tempdir().unwrap();
    for format in ["ply-skeleton", "qsm", "mtg"] {
        let said = export_stage(&wood, format, &[], &dir.path().join("wood.any")).unwrap_err().to_string();
        assert!(said.contains("several trees") && said.contains("glb"), "{said}");
    }
    let mut broken = wood.clone();
    broken.places[1].scale = f32::NAN;
    let mut nowhere = wood.clone();
    nowhere.places.retain(|place| place.plant == 0);
    for (stage, expected) in [(broken, "place 1"), (nowhere, "plant 1 stands nowhere")] {
        for format in ["obj", "ply", "gltf", "glb", "usda", "usdz", "qsm", "mtg"] {
            let said =
                export_stage(&stage, format, &[], &dir.path().join("wood.any")).unwrap_err().to_string();
            assert!(said.contains(expected), "{format}: {said}");
        }
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing is left behind");
}
