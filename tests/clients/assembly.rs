//! Assemblies of files before usd-core, NVIDIA's validator and a reader of tilesets.

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::Path;

use glam::{DVec3, Vec3};
use linden::Quiet;
use linden::scene::{Bounds, Scene};
use linden::stage::Stage;
use linden_exporters::{Assembly, Bundle, Member, MemberPlace};
use linden_tests::fixtures::{export, scene};
use serde_json::json;

use crate::outside::{exported, run};

fn member(index: u64, file: String, scene: &Scene) -> Member {
    let bounds = Stage::of(scene).bounds().unwrap();
    Member { index, source: format!("plant \"{index}\""), seed: u64::MAX - index, file, bounds, wind: None }
}

fn place(member: usize, position: [f64; 3], turn_rad: f64, scale: f64) -> MemberPlace {
    MemberPlace { member, position: DVec3::from(position), turn_rad, scale }
}

fn write(assembly: &Assembly, dir: &Path) {
    let mut usd = Bundle::create(&dir.join(format!("{}.usda", assembly.name))).unwrap();
    assembly.write_usd(&mut usd, &Quiet).unwrap();
    usd.commit().unwrap();
}

fn write_tiles(assembly: &Assembly, dir: &Path) {
    let mut tiles = Bundle::create(&dir.join(format!("{}.json", assembly.name))).unwrap();
    assembly.write_tileset(&mut tiles, &Quiet).unwrap();
    tiles.commit().unwrap();
}

/// What the script compares with: where each member of `files` stands.
fn expected(assembly: &Assembly, files: &[&str]) -> serde_json::Value {
    let placed = |place: &MemberPlace| {
        json!({
            "index": assembly.members[place.member].index,
            "file": files[place.member],
            "position": place.position.to_array(),
            "turn_deg": place.turn_rad.to_degrees(),
            "scale": place.scale,
        })
    };
    json!({ "name": assembly.name, "places": assembly.places.iter().map(placed).collect::<Vec<_>>() })
}

#[test]
fn every_client_takes_assemblies() {
    let dir = exported("clients-assembly");
    let scenes = [scene(9, 7), scene(40, 12)];
    fs::create_dir(dir.join("the plants")).unwrap();
    let mut written = Vec::new();
    for (name, formats) in [("usd", ["usda", "usdz"]), ("gltf", ["glb", "gltf"])] {
        let files: Vec<String> = formats
            .iter()
            .zip(["a", "b"])
            .map(|(format, stem)| format!("./the plants/{stem}.{format}"))
            .collect();
        for ((scene, format), file) in scenes.iter().zip(formats).zip(&files) {
            export(scene, format, &[], &dir.join(file)).unwrap();
        }
        let members = [(0, 3), (1, 14)].map(|(of, index)| member(index, files[of].clone(), &scenes[of]));
        // The second plant stands once, far out, where floats have no centimetres.
        let places = vec![
            place(0, [0.0; 3], 0.0, 1.0),
            place(0, [4.0, 0.5, -3.0], FRAC_PI_2, 1.0),
            place(1, [2_500_000.25, 10.0, 5_000_000.5], 2.2, 1.75),
            place(0, [-20.0, 0.0, 7.0], -0.6, 0.5),
        ];
        let placed = Assembly { name: format!("placed {name}"), members: members.to_vec(), places };
        let row = Assembly::side_by_side(format!("row {name}"), members.to_vec());
        let of: Vec<&str> = files.iter().map(String::as_str).collect();
        for assembly in [&placed, &row] {
            if name == "usd" {
                write(assembly, &dir);
            } else {
                write_tiles(assembly, &dir);
            }
            written.push(expected(assembly, &of));
        }
    }
    // Ten thousand, of which two are there: what is not loaded is not looked for.
    let many = (0..10_000).map(|index| {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::new(1.0, 5.0, 1.0) };
        let file = format!("./no/{index}.usda");
        let none = Member { index, source: "fir".into(), seed: index, file, bounds, wind: None };
        match index {
            5 => member(5, "./the plants/a.usda".to_owned(), &scenes[0]),
            9_998 => member(9_998, "./the plants/b.usdz".to_owned(), &scenes[1]),
            _ => none,
        }
    });
    let many = Assembly::side_by_side("many", many.collect());
    write(&many, &dir);
    write_tiles(&many, &dir);
    let loaded: Vec<_> = [(5, "./the plants/a.usda"), (9_998, "./the plants/b.usdz")]
        .map(|(at, file)| json!({ "prim": format!("tree_{at}"), "file": file, "position": many.places[at].position.to_array() }))
        .to_vec();
    let all = json!({ "assemblies": written, "many": { "count": many.places.len(), "loaded": loaded } });
    fs::write(dir.join("expected.json"), all.to_string()).unwrap();
    run("assembly.py", &dir);
}
