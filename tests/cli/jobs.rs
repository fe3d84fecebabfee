//! The jobs that linden is judged by.

use std::path::Path;

use crate::program::Folder;

/// A closed box of 2 × 3 × 2 m, one metre above the ground.
const BOX: &str = "\
v -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\nv -1 4 -1\nv 1 4 -1\nv 1 4 1\nv -1 4 1
f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";

const TREE_A: &str = "// tree A\naxiom=F\nangle=25.7\nnumber of derivations=3\n\nF=(1)F[+F]F[-F]F\n";

#[test]
fn a_preset_becomes_four_files_at_once() {
    let folder = Folder::new();
    let said = folder
        .run(&["export", "fir", "-o", "fir.glb", "-o", "fir.usda", "-o", "fir.obj", "-o", "fir.ply"])
        .done();
    let names = folder.names();
    for name in ["fir.glb", "fir.usda", "fir.obj", "fir.mtl", "fir.ply"] {
        assert!(names.iter().any(|n| n == name), "{name} in {names:?}");
        assert!(said.out.contains(name), "{name} in {}", said.out);
    }
    assert!(
        names.iter().any(|n| Path::new(n).extension().is_some_and(|e| e == "png")),
        "the bark's picture: {names:?}"
    );
    assert!(folder.read("fir.glb").starts_with(b"glTF"));
    assert!(folder.read("fir.usda").starts_with(b"#usda 1.0"));
    assert!(folder.read("fir.ply").starts_with(b"ply\n"));
    for name in ["fir.usda", "fir.obj", "fir.ply"] {
        let text = String::from_utf8_lossy(&folder.read(name)).replace("\\\"", "\"");
        assert!(text.contains("\"linden\":\"0."), "{name} carries its recipe");
    }
}

#[test]
fn a_grammar_an_envelope_and_points_grow_without_a_preset() {
    let folder = Folder::new();
    folder.write("treeA.txt", TREE_A);
    folder.run(&["export", "treeA.txt", "-o", "a.glb"]).done();
    assert!(folder.read("a.glb").starts_with(b"glTF"));

    folder.write("envelope.obj", BOX);
    folder.run(&["export", "envelope.obj", "-o", "tree.usda"]).done();
    let stats = folder.run(&["stats", "envelope.obj", "--json"]).done().json();
    // The crown fills the box, its trunk stands on the ground below.
    let bounds = |end: &str, axis: usize| stats["bounds"][end][axis].as_f64().unwrap();
    assert!(bounds("min", 1).abs() < 0.1 && (3.5..4.2).contains(&bounds("max", 1)), "{stats}");
    assert!(bounds("min", 0) > -1.2 && bounds("max", 0) < 1.2, "{stats}");
}

#[test]
fn a_recipe_from_a_file_grows_the_same_tree_again() {
    let folder = Folder::new();
    folder.write("envelope.obj", BOX);
    let args = ["export", "envelope.obj", "-o", "one.obj", "--seed", "3", "--set", "points=300"];
    folder.run(&args).done();
    let text = String::from_utf8(folder.read("one.obj")).unwrap();
    let line = text.lines().find(|line| line.contains("{\"linden\"")).expect("a recipe");
    folder.write("recipe.json", &line[line.find('{').unwrap()..]);
    folder.run(&["export", "recipe.json", "-o", "two.obj"]).done();
    let again = String::from_utf8(folder.read("two.obj")).unwrap();
    let vertices =
        |text: &str| text.lines().filter(|l| l.starts_with("v ")).map(str::to_owned).collect::<Vec<_>>();
    assert!(vertices(&text).len() > 100);
    assert_eq!(vertices(&text), vertices(&again));

    // Another envelope under the same name is noticed.
    folder.write("envelope.obj", BOX.replace("4 -1", "5 -1").replace("4 1", "5 1"));
    let said = folder.run(&["stats", "recipe.json", "--json"]);
    assert!(said.err.contains("not the file that the recipe was made with"), "{}", said.err);
}

#[test]
fn the_same_export_is_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    let export = |threads: &str, name: &str| {
        let status = crate::program::linden()
            .env("RAYON_NUM_THREADS", threads)
            .args(["export", "simple", "-o", &format!("{name}.glb"), "-o", &format!("{name}.usda")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(status.status.success());
        folder.read(&format!("{name}.glb"))
    };
    assert!(export("1", "one") == export("3", "three"), "one thread and three differ");
}

#[test]
fn formats_are_chosen_by_ending_or_by_name() {
    let folder = Folder::new();
    folder.write("treeA.txt", TREE_A);
    folder.run(&["export", "treeA.txt", "--format", "obj,ply-skeleton"]).done();
    let names = folder.names();
    assert!(
        names.contains(&"treeA.obj".to_owned()) && names.contains(&"treeA-skeleton.ply".to_owned()),
        "{names:?}"
    );
    let text = String::from_utf8_lossy(&folder.read("treeA-skeleton.ply")).into_owned();
    assert!(text.contains("element edge 125"), "5^3 segments");

    folder.run(&["export", "treeA.txt", "-o", "x.ply", "--set", "ply.encoding=ascii"]).done();
    assert!(String::from_utf8_lossy(&folder.read("x.ply")).contains("format ascii 1.0"));
}

#[test]
fn every_preset_stays_closed_and_sound() {
    let folder = Folder::new();
    let rows = folder.run(&["list", "--json"]).done().json();
    for row in rows.as_array().unwrap() {
        let id = row["id"].as_str().unwrap();
        let stats = folder.run(&["stats", id, "--json"]).done().json();
        assert_eq!(stats["watertight"], true, "{id}");
        let height = stats["height_m"].as_f64().unwrap();
        assert!((1.0..20.0).contains(&height), "{id} is {height} m high");
    }
}
