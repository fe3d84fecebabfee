//! Files of levels say in plain numbers which they are: `linden_tree`.

use linden::Quiet;
use linden::dress::levels;
use linden::stage::{Place, Plant, Stage};
use linden_tests::fixtures::export_stage;
use serde_json::Value;

use crate::instances::dressed;
use crate::outside::{exported, run};

fn document(path: &std::path::Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn each_file_says_its_level_and_for_which_distance_it_is() {
    let dir = exported("clients-levels");
    let (recipe, grown, _) = dressed(&[
        ("lod_triangles", "4000,1000"),
        ("billboard", "2"),
        ("billboard_size", "64"),
        ("season", "0.75"),
    ]);
    let dressed = levels(&recipe, &grown, &Quiet).unwrap();
    let (stage, mut from) = (dressed.stage(), 1.0);
    assert_eq!(stage.levels(), 3);
    for (level, of) in dressed.levels.iter().enumerate() {
        let options =
            [&[("lods", "files")][..], &[("lods", "files"), ("quantize", "true"), ("compress", "meshopt")]];
        for (name, options) in ["plain", "packed"].into_iter().zip(options) {
            let path = dir.join(format!("{name}_LOD{level}.glb"));
            export_stage(&stage.at_level(level), "glb", options, &path).unwrap();
            let document = document(&path);
            let told = &document["nodes"][0]["extras"]["linden_tree"];
            let triangles: usize = of.scene.parts.iter().map(|part| part.mesh.triangles.len()).sum();
            assert_eq!(
                (&told["level"], &told["levels"], &told["triangles"]),
                (&level.into(), &3.into(), &triangles.into())
            );
            let number = |key: &str| told[key].as_f64().unwrap() as f32;
            assert_eq!((number("screen_from"), number("screen_to")), (from, of.coverage), "{name} {level}");
            let points = || of.scene.parts.iter().flat_map(|part| &part.mesh.positions);
            assert_eq!(number("height_m"), points().map(|point| point.y).fold(0.0, f32::max));
            let reach_m = points().map(|point| point.x.hypot(point.z)).fold(0.0, f32::max);
            assert!((number("reach_m") - reach_m).abs() < 1e-5);
            assert_eq!(
                (&told["season"], &told["unit"], &told["up"]),
                (&"autumn".into(), &"m".into(), &"+Y".into())
            );
            let low = points().map(|point| point.x).fold(f32::MAX, f32::min);
            assert_eq!(told["bounds_m"]["min"][0].as_f64().unwrap() as f32, low);
        }
        from = of.coverage;
    }
    // All in one: the finest's, and how many there are.
    export_stage(&stage, "glb", &[], &dir.join("all.glb")).unwrap();
    let told = &document(&dir.join("all.glb"))["nodes"][0]["extras"]["linden_tree"];
    assert_eq!(
        (&told["level"], &told["levels"], &told["screen_to"]),
        (&Value::Null, &3.into(), &Value::Null)
    );
}

#[test]
fn parts_of_a_forest_of_instances_have_names_and_trees_their_numbers() {
    let dir = exported("clients-levels-forest");
    let (recipe, grown, one) = dressed(&[("lods", "2"), ("triangles", "2000")]);
    let dressed = levels(&recipe, &grown, &Quiet).unwrap();
    let mut stage = Stage { name: "wood".to_owned(), ..dressed.stage() };
    stage.plants[0].name = "Oak 1".to_owned();
    stage.plants.push(Plant { name: "Oak 2".to_owned(), ..Plant::of(&one) });
    let at = |plant, x| Place { position: glam::Vec3::X * x, ..Place::origin(plant) };
    stage.places = vec![at(0, 0.0), at(1, 9.0), at(0, 20.0)];
    let on = ("instances", "true");
    export_stage(&stage, "glb", &[on], &dir.join("wood.glb")).unwrap();
    export_stage(&stage.at_level(1), "glb", &[on, ("quantize", "true")], &dir.join("wood_LOD1.glb")).unwrap();
    run("check.py", &dir);
    for (file, ending, level) in [("wood.glb", "_LOD1", 0), ("wood_LOD1.glb", "", 1)] {
        let document = document(&dir.join(file));
        let nodes = document["nodes"].as_array().unwrap();
        let named =
            |name: &str| nodes.iter().find(|node| node["name"] == name).unwrap_or_else(|| panic!("{name}"));
        let part = named(&format!("oak_1_wood{ending}"));
        assert!(part["extensions"]["EXT_mesh_gpu_instancing"].is_object());
        let mesh = &document["meshes"][part["mesh"].as_u64().unwrap() as usize];
        assert_eq!((&mesh["name"], mesh["primitives"].as_array().unwrap().len()), (&part["name"], 1));
        assert!(named("oak_2_leaves")["extensions"]["EXT_mesh_gpu_instancing"].is_object());
        let tree = named(if ending.is_empty() { "Oak 1" } else { "Oak 1_LOD0" });
        let told = &tree["extras"]["linden_tree"];
        assert_eq!((&told["level"], &told["levels"]), (&level.into(), &2.into()), "{file}");
        assert!(tree["extras"]["linden"].is_object());
        assert_eq!(named("Oak 2")["extras"]["linden_tree"]["levels"], 1);
    }
}
