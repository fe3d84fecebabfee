//! Forests, settings, levels, seasons, packages, instances and vertices in fewer bits, before every
//! client.

use glam::Vec3;
use linden::Quiet;
use linden::scene::Scene;
use linden::stage::{Level, Place, Plant, Season, Stage, Surroundings};
use linden_tests::fixtures::{export_stage, scene};

use crate::instances::dressed;
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
    let leafy = dressed(&[]).2;
    for (name, stage) in
        [("wood", wood(&trees)), ("tree", Stage::of(&trees[0])), ("leafy", Stage::of(&leafy))]
    {
        let by = Surroundings::parse("sun=52,172,15.5 cover=grass,litter").unwrap();
        let stage = stage.surrounded(&by, &Quiet).unwrap();
        for format in ["obj", "gltf", "glb", "usda", "usdz"] {
            export_stage(&stage, format, &[], &dir.join(format!("{name}.{format}"))).unwrap();
        }
        for (format, option) in [("glb", ("quantize", "true")), ("usdz", ("flavor", "ar"))] {
            export_stage(&stage, format, &[option], &dir.join(format!("{name}_{}.{format}", option.0)))
                .unwrap();
        }
        export_stage(&stage, "glb", &[("instances", "true")], &dir.join(format!("{name}_instances.glb")))
            .unwrap();
        let (document, ..) = gltf::import(dir.join(format!("{name}.glb"))).unwrap();
        assert_eq!(document.cameras().count(), 1);
        let nodes: Vec<_> = document.nodes().filter_map(|node| node.name().map(str::to_owned)).collect();
        let is_there = |wanted: &str| nodes.iter().any(|name| name == wanted);
        assert!(["Camera", "Sun", "Sky", "Ground", "Ground_grass_1"].into_iter().all(is_there));
        // The others have no leaves to shed.
        assert_eq!(is_there("Ground_litter_1"), name == "leafy");
    }
    run("check.py", &dir);
}

#[test]
fn tables_hold_each_tree_of_a_forest_as_if_it_were_alone() {
    let trees = trees();
    let wood = wood(&trees);
    let dir = tempfile::tempdir().unwrap();
    let text = |stage: &Stage<'_>, format: &str, options: &[(&str, &str)]| {
        let target = dir.path().join("wood.any");
        export_stage(stage, format, options, &target).unwrap();
        std::fs::read_to_string(target).unwrap()
    };
    let comments = ("comments", "false");
    let table = |stage: &Stage<'_>| -> Vec<Vec<f64>> {
        let text = text(stage, "qsm", &[comments]);
        text.lines().skip(1).map(|row| row.split(',').map(|field| field.parse().unwrap()).collect()).collect()
    };
    let all = table(&wood);
    for (number, place) in (1..).zip(&wood.places) {
        let alone = table(&Stage::of(&trees[place.plant]));
        let rows: Vec<&Vec<f64>> = all.iter().filter(|row| row.last() == Some(&f64::from(number))).collect();
        assert_eq!(rows.len(), alone.len());
        for (row, alone) in rows.into_iter().zip(&alone) {
            assert_eq!((&row[..5], &row[13..16]), (&alone[..5], &alone[13..16]), "numbers begin again");
            let vector = |row: &[f64], from: usize| Vec3::from([0, 1, 2].map(|axis| row[from + axis] as f32));
            let start = place.position + place.rotation() * vector(alone, 5) * place.scale;
            assert!(vector(row, 5).distance(start) < 1e-5);
            assert!(vector(row, 8).distance(place.rotation() * vector(alone, 8)) < 1e-5);
            for size in [11, 12, 16, 17] {
                assert!((row[size] - alone[size] * f64::from(place.scale)).abs() < 1e-6);
            }
        }
    }
    // A vertex of the PLY names one of its tree; that of the graph begins where the plant before has ended.
    let skeleton = text(&wood, "ply-skeleton", &[("encoding", "ascii")]);
    let numbers = skeleton.split_once("end_header\n").unwrap().1;
    let nodes: usize = wood.places.iter().map(|place| trees[place.plant].skeleton.positions.len()).sum();
    let vertices: Vec<Vec<f64>> =
        numbers.lines().take(nodes).map(|row| row.split(' ').map(|n| n.parse().unwrap()).collect()).collect();
    assert_eq!(vertices.iter().filter(|row| row[6] < 0.0).count(), wood.places.len());
    for row in vertices.iter().filter(|row| row[6] >= 0.0) {
        assert_eq!(vertices[row[6] as usize][11], row[11], "a parent in its tree");
    }
    let edges: Vec<&str> = numbers.lines().skip(nodes).collect();
    let named = (0..).zip(&vertices).filter(|(_, row)| row[6] >= 0.0);
    assert!(named.map(|(node, row): (u32, _)| format!("{} {node}", row[6])).eq(edges));
    let graph = text(&wood, "mtg", &[]);
    let plants: Vec<&str> = graph.lines().filter(|line| line.starts_with("/P")).collect();
    assert_eq!(plants.len(), wood.places.len());
    for (line, place) in plants.iter().zip(&wood.places) {
        let at: Vec<f32> = line.split('\t').filter_map(|field| field.parse().ok()).collect();
        let foot = place.position + place.rotation() * trees[place.plant].skeleton.positions[0] * place.scale;
        assert!(Vec3::new(at[0], at[2], -at[1]).distance(foot) < 1e-5, "{line}");
    }
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
fn what_stands_nowhere_is_refused() {
    let trees = trees();
    let wood = wood(&trees);
    let dir = tempfile::tempdir().unwrap();
    let mut broken = wood.clone();
    broken.places[1].scale = f32::NAN;
    let mut nowhere = wood.clone();
    nowhere.places.retain(|place| place.plant == 0);
    for (stage, expected) in [(broken, "place 1"), (nowhere, "plant 1 stands nowhere")] {
        for format in ["obj", "ply", "gltf", "glb", "usda", "usdz", "qsm", "mtg", "organs", "ply-skeleton"] {
            let said =
                export_stage(&stage, format, &[], &dir.path().join("wood.any")).unwrap_err().to_string();
            assert!(said.contains(expected), "{format}: {said}");
        }
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing is left behind");
}
