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
    assert_eq!(said.out.lines().count(), names.len(), "each file is listed once: {}", said.out);
    assert!(folder.read("fir.glb").starts_with(b"glTF"));
    assert!(folder.read("fir.usda").starts_with(b"#usda 1.0"));
    assert!(folder.read("fir.ply").starts_with(b"ply\n"));
    for name in ["fir.usda", "fir.obj", "fir.ply"] {
        let text = String::from_utf8_lossy(&folder.read(name)).replace("\\\"", "\"");
        assert!(text.contains("\"linden\":\"0."), "{name} carries its recipe");
    }
}

#[test]
fn flags_turn_options_of_every_format_that_has_them() {
    let folder = Folder::new();
    let small = ["--set", "bark_size=64", "--set", "leaf_size=64"];
    let export = |args: &[&str]| folder.run(&[&["export", "dressed-simple"], &small[..], args].concat());
    export(&["-o", "a.glb", "-o", "a.usda", "-o", "a.obj"]).done();
    let flags = ["--instances", "--quantize", "--compress", "meshopt"];
    let said = export(&[&flags[..], &["-o", "b.glb", "-o", "b.usda", "-o", "b.obj"]].concat());
    assert_eq!(said.err.matches("leaf_normals=dome").count(), 1, "{}", said.err);
    let [plain, packed] = ["a.glb", "b.glb"].map(|name| folder.read(name));
    assert!(3 * packed.len() < plain.len(), "{} of {}", packed.len(), plain.len());
    let json = String::from_utf8_lossy(&packed);
    for extension in ["EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "EXT_meshopt_compression"] {
        assert!(json.contains(extension), "{extension}");
    }
    assert!(String::from_utf8_lossy(&folder.read("b.usda")).contains("def PointInstancer"));
    let tree = |name: &str| String::from_utf8_lossy(&folder.read(name)).replace("b.mtl", "a.mtl");
    assert!(tree("a.obj") == tree("b.obj"), "a format without them is as ever");
}

#[test]
fn a_grammar_an_envelope_and_points_grow_without_a_preset() {
    let folder = Folder::new();
    folder.write("treeA.txt", TREE_A);
    // Of what it does not say the user hears, but not who has said it.
    let said = folder.run(&["stats", "treeA.txt"]);
    assert!(said.code == Some(0) && said.err.contains("segment_length (0.1 m)"), "{}", said.err);
    folder.run(&["export", "treeA.txt", "--set", "segment_length=0.1", "-o", "a.glb"]).done();
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
fn an_open_or_inverted_envelope_is_said_so_and_works() {
    let folder = Folder::new();
    folder.write("open.obj", BOX.replace("f 8 7 6 5\n", ""));
    let said = folder.run(&["stats", "open.obj", "--json"]);
    assert!(said.err.contains("open"), "{}", said.err);
    assert!(said.json()["nodes"].as_u64().unwrap() > 100);

    let inverted: String = BOX
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
            None => format!("{line}\n"),
        })
        .collect();
    folder.write("inverted.obj", inverted);
    let said = folder.run(&["stats", "inverted.obj", "--json"]);
    assert!(said.err.contains("look inward"), "{}", said.err);
    assert!(said.json()["nodes"].as_u64().unwrap() > 100);
}

/// Points on the bark of a leaning stem of 3 m with two limbs of 1.5 m, as a scanner gives them: Z
/// up, somewhere in the country, a column of intensities behind.
fn scan() -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let mut limb = |from: [f64; 3], to: [f64; 3], radius: f64| {
        for i in 0..60 {
            let t = f64::from(i) / 60.0;
            for k in 0..8 {
                let (sin, cos) = libm::sincos(f64::from(k + i % 2) * 0.785);
                let [x, y, z] = [0, 1, 2].map(|axis| from[axis] + (to[axis] - from[axis]) * t);
                let (x, y) = (x + radius * cos + 850.0, y + radius * sin + 4_460.0);
                writeln!(text, "{x:.3} {y:.3} {z:.3} {}", i * k).unwrap();
            }
        }
    };
    limb([0.0, 0.0, 12.0], [0.3, 0.0, 15.0], 0.1);
    limb([0.2, 0.0, 14.0], [1.4, 0.0, 14.9], 0.04);
    limb([0.25, 0.0, 14.5], [-0.9, 0.0, 15.4], 0.04);
    text
}

#[test]
fn a_scan_stands_up_at_the_origin_and_looks_like_the_tree() {
    let folder = Folder::new();
    folder.write("scan.xyz", scan());
    let said = folder.run(&["export", "scan.xyz", "-o", "tree.glb"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("moved to the origin") && said.err.contains("origin=keep"), "{}", said.err);
    assert!(folder.read("tree.glb").starts_with(b"glTF"));

    let stats = folder.run(&["stats", "scan.xyz", "--json"]).json();
    let number = |path: &str| stats.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
    assert!((3.1..3.6).contains(&number("/height_m")), "{stats}");
    assert!((1.8..2.6).contains(&(number("/bounds/max/0") - number("/bounds/min/0"))), "{stats}");
    assert!(number("/bounds/max/2") - number("/bounds/min/2") < 0.5, "flat as scanned: {stats}");
    assert!(number("/bounds/min/1").abs() < 0.1, "it stands on the ground: {stats}");
    // 3 m of stem and two limbs of 1.5 m, not a strand for every row of points.
    assert!((5.0..8.0).contains(&number("/total_length_m")), "{stats}");
    assert_eq!(number("/points_unreached"), 0.0);

    let kept = folder.run(&["stats", "scan.xyz", "--json", "--set", "origin=keep"]).json();
    let x = kept.pointer("/bounds/min/0").and_then(serde_json::Value::as_f64).unwrap();
    assert!((848.0..850.5).contains(&x), "{kept}");
    // Taken as Y up, the same points lie on their side.
    let lying = folder.run(&["stats", "scan.xyz", "--json", "--set", "up=y"]).json();
    assert!(lying["height_m"].as_f64().unwrap() < 1.0, "{lying}");
}

/// The points of [`scan`], each row made of x, y and z.
fn table(header: &str, row: impl Fn([f64; 3]) -> String) -> String {
    let number = |field: &str| field.parse::<f64>().unwrap();
    let rows = scan();
    let rows = rows.lines().map(|line| {
        let fields: Vec<&str> = line.split(' ').collect();
        row([number(fields[0]), number(fields[1]), number(fields[2])])
    });
    std::iter::once(header.to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_header_says_which_columns_are_coordinates_or_a_note_which_were_taken() {
    let folder = Folder::new();
    folder.write("scan.xyz", scan());
    let height = |name: &str| folder.run(&["stats", name, "--json"]).json()["height_m"].clone();
    let expected = height("scan.xyz");
    let surveyed = |[x, y, z]: [f64; 3]| format!("7,{x},{y},{z}");
    folder.write("a.csv", table("id,Easting,Northing,Height", surveyed));
    assert_eq!(height("a.csv"), expected);
    folder.write("a.csv", table("altitude (m),NORTHING [m],Easting_m", |[x, y, z]| format!("{z},{y},{x}")));
    assert_eq!(height("a.csv"), expected);

    folder.write("a.csv", table("id,X,Y", |[x, y, _]| format!("7,{x},{y}")));
    let said = folder.run(&["stats", "a.csv"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    let part = "line 1: expected a column named z or height or elevation or altitude in the header, beside 'X' and 'Y'";
    assert!(said.err.contains("a.csv") && said.err.contains(part), "{}", said.err);

    folder.write("a.csv", table("e,n,up", |[x, y, z]| format!("{x},{y},{z}")));
    let said = folder.run(&["stats", "a.csv", "--json"]);
    assert!(said.err.contains("the first three columns, 'e', 'n' and 'up', were taken"), "{}", said.err);
    assert_eq!(said.json()["height_m"], expected);
    let named = folder.run(&["stats", "scan.xyz"]);
    assert!(!named.err.contains("the first three columns"), "{}", named.err);
}

#[test]
fn a_place_that_is_too_far_for_single_precision_is_not_offered() {
    let folder = Folder::new();
    folder.write("utm.csv", table("x,y,z", |[x, y, z]| format!("{},{},{z}", x + 446_000.0, y + 5_428_000.0)));
    let said = folder.run(&["stats", "utm.csv", "--json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("too coarse to leave it there") && !said.err.contains("origin=keep"),
        "{}",
        said.err
    );
    let kept = folder.run(&["stats", "utm.csv", "--set", "origin=keep"]);
    assert_eq!(kept.code, Some(1), "{}", kept.err);
    assert!(kept.err.contains("single precision"), "{}", kept.err);
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
fn the_recipe_of_a_preset_with_a_mesh_of_its_own_needs_no_file_beside() {
    let folder = Folder::new();
    let shown = folder.run(&["show", "heart", "--json", "--seed", "4"]).done().json();
    folder.write("heart.json", shown["recipe"].to_string());
    folder.write("heart.toml", folder.run(&["show", "heart", "--toml", "--seed", "4"]).done().out);
    let hash = |source: &[&str]| {
        folder.run(&[&["stats", "--json"], source].concat()).done().json()["skeleton_hash"].clone()
    };
    let original = hash(&["heart", "--seed", "4"]);
    assert_eq!(hash(&["heart.json"]), original);
    assert_eq!(hash(&["heart.toml"]), original);
    // One that lies there is the one that is meant.
    folder.write("heart.obj", BOX);
    assert_ne!(hash(&["heart.toml"]), original);
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
    folder.run(&["export", "treeA.txt", "--set", "segment_length=1", "--format", "obj,ply-skeleton"]).done();
    let names = folder.names();
    assert!(
        names.contains(&"treeA.obj".to_owned()) && names.contains(&"treeA-skeleton.ply".to_owned()),
        "{names:?}"
    );
    let text = String::from_utf8_lossy(&folder.read("treeA-skeleton.ply")).into_owned();
    assert!(text.contains("element edge 125"), "5^3 segments");

    folder
        .run(&[
            "export",
            "treeA.txt",
            "--set",
            "segment_length=1",
            "-o",
            "x.ply",
            "--set",
            "ply.encoding=ascii",
        ])
        .done();
    assert!(String::from_utf8_lossy(&folder.read("x.ply")).contains("format ascii 1.0"));
}

#[test]
fn stats_finds_presets_closed_and_of_a_trees_height() {
    let folder = Folder::new();
    let rows = folder.run(&["list", "--json"]).done().json();
    let trees = rows.as_array().unwrap().iter().filter(|row| row["generator"] != "forest");
    // The surface of each is looked at beside its preset; here, what the program says of it.
    for row in trees.step_by(4) {
        let id = row["id"].as_str().unwrap();
        // Wood is closed, whatever grows on it.
        let stats = folder.run(&["stats", id, "--set", "leaf_form=none", "--json"]).done().json();
        assert_eq!(stats["watertight"], true, "{id}");
        let height = stats["bounds"]["max"][1].as_f64().unwrap();
        assert!((0.3..40.0).contains(&height), "{id} is {height} m high");
    }
}

#[test]
fn files_go_into_a_directory_under_the_name_of_what_they_hold() {
    let folder = Folder::new();
    std::fs::create_dir(folder.file("there")).unwrap();
    let names = |of: &str| {
        let mut names: Vec<_> = std::fs::read_dir(folder.file(of))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    folder.run(&["export", "older-a", "-o", "there", "--format", "glb,ply-skeleton"]).done();
    // What was written is listed, as of an export.
    for (command, target, name) in [("preview", "there/", "older-a.png"), ("sheet", "there", "sheet.png")] {
        let said = folder.run(&[command, "older-a", "-o", target]).done();
        let listed = said.out.strip_prefix(&format!("there/{name}  "));
        assert!(listed.is_some_and(|size| size.ends_with("KiB\n")), "{}", said.out);
    }
    assert_eq!(names("there"), ["older-a-skeleton.ply", "older-a.glb", "older-a.png", "sheet.png"]);
    folder.run(&["export", "older-a", "-o", "a/b/", "--format", "qsm", "--mkdir", "--no-sync"]).done();
    folder.run(&["preview", "older-a", "-o", "a/c/x.png", "--mkdir"]).done();
    assert_eq!((names("a"), names("a/b")), (vec!["b".into(), "c".into()], vec!["older-a.csv".to_owned()]));
    // What fails leaves no directory behind either.
    let said = folder.run(&["export", "older-a", "-o", "x/y/older.glb", "-o", "x/y/older.glb", "--mkdir"]);
    assert_eq!((said.code, folder.file("x").exists()), (Some(2), false), "{}", said.err);
}
