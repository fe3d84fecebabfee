//! Plants at several ages: files, columns, pictures, and what is refused.

use crate::program::Folder;

/// A small plant that grows by years.
const PLANT: &str = "id = \"shrub\"\nname = \"Shrub\"\n\n[self-organizing]\nyears = 12\n\n[bark]\nbark_size = 16\n\n\
                     [age.young]\nage = 0.5\n\n[age.grown]\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("shrub.toml", PLANT);
    folder
}

/// Of a picture, pixels.
fn size(folder: &Folder, name: &str) -> (u32, u32) {
    let reader = png::Decoder::new(std::io::Cursor::new(folder.read(name))).read_info().unwrap();
    (reader.info().width, reader.info().height)
}

fn height(folder: &Folder, args: &[&str]) -> f64 {
    let stats = folder.run(&[&["stats"], args, &["--json"]].concat()).done().json();
    stats["height_m"].as_f64().unwrap()
}

#[test]
fn each_age_has_files_and_usd_one_over_them() {
    let folder = folder();
    folder
        .run(&["export", "shrub.toml", "--ages", "-o", "a.glb", "-o", "a.usda", "--set", "leaf_form=none"])
        .done();
    let names = folder.names();
    for name in ["a_young.glb", "a_grown.glb", "a_young.usda", "a_grown.usda", "a.usda"] {
        assert!(names.iter().any(|found| found == name), "{name} in {names:?}");
    }
    assert!(!names.iter().any(|name| name == "a.glb"), "{names:?}");
    // Each carries the recipe of its age, and is what that grows.
    let young = height(&folder, &["a_young.glb"]);
    assert_eq!(young, height(&folder, &["shrub.toml", "--set", "age=0.5"]));
    assert!(young < height(&folder, &["a_grown.glb"]));
    folder.run(&["verify", "a_young.glb", "a_grown.glb"]).done();
    // The one over them that of the age that is seen first; it does not sway, and says no time.
    let recipe = |file: &str| folder.run(&["recipe", file]).done().out;
    assert_eq!(recipe("a.usda"), recipe("a_grown.usda"));
    let verified = folder.run(&["verify", "a.usda"]).done().out;
    assert!(verified.starts_with("same tree") && verified.contains("ages"), "{verified}");
    assert!(!String::from_utf8(folder.read("a.usda")).unwrap().contains("TimeCode"));
    // With levels and seasons besides.
    let args = ["--ages", "young,y=3y", "--lods", "2", "--seasons", "summer,bare", "-o", "b.obj"];
    let wrote = folder.run(&[&["export", "shrub.toml"], &args[..]].concat());
    assert_eq!(wrote.code, Some(0), "{}", wrote.err);
    let names = folder.names();
    for name in ["b_young_summer_LOD0.obj", "b_young_bare_LOD1.obj", "b_y_summer_LOD1.obj"] {
        assert!(names.iter().any(|found| found == name), "{name} in {names:?}");
    }
}

#[test]
fn a_file_over_ages_that_sway_says_how_long() {
    let folder = folder();
    let args = ["--ages", "--set", "leaf_form=none", "--wind=sway", "-o", "a.usda", "-o", "a.usdc"];
    folder.run(&[&["export", "shrub.toml"], &args[..]].concat()).done();
    let time = |file: &str| {
        let text = String::from_utf8(folder.read(file)).unwrap();
        let lines = text.lines().filter(|line| line.contains("TimeCode") || line.contains("framesPerSecond"));
        lines.map(|line| line.trim().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(time("a.usda"), time("a_grown.usda"));
    assert_eq!(time("a.usda").len(), 3, "{:?}", time("a.usda"));
    let recipe = |file: &str| folder.run(&["recipe", file]).done().out;
    assert_eq!(recipe("a.usdc"), recipe("a_grown.usdc"));
    folder.run(&["verify", "a.usdc"]).done();
}

#[test]
fn an_age_is_named_shared_or_counted_in_years() {
    let folder = folder();
    let whole = height(&folder, &["shrub.toml"]);
    for (age, same) in [("young", "age=0.5"), ("0.25", "age=0.25"), ("4y", "years=4"), ("x=0.3", "age=0.3")] {
        let found = height(&folder, &["shrub.toml", "--age", age]);
        assert_eq!(found, height(&folder, &["shrub.toml", "--set", same]), "{age}");
        assert!(found < whole, "{age}");
    }
    let all = folder.run(&["stats", "shrub.toml", "--ages", "3y,6y,all", "--json"]).done().json();
    let of = |key: &str| all.as_array().unwrap().iter().map(|row| row[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("age"), ["year_3", "year_6", "young", "grown"]);
    let heights: Vec<f64> = of("height_m").iter().map(|height| height.as_f64().unwrap()).collect();
    assert!(heights[0] < heights[1] && heights[1] == heights[2] && heights[2] < heights[3], "{heights:?}");
    let table = folder.run(&["stats", "shrub.toml", "--ages"]).done().out;
    let head = table.lines().nth(2).unwrap_or_default();
    assert_eq!(head.split_whitespace().collect::<Vec<_>>(), ["young", "grown"], "{table}");
    // What is turned by hand holds at all ages.
    let bare =
        folder.run(&["stats", "shrub.toml", "--ages", "--set", "leaf_form=none", "--json"]).done().json();
    assert!(bare.as_array().unwrap().iter().all(|row| row["leaves"] == 0), "{bare}");
    let page = folder.run(&["show", "shrub.toml"]).done().out;
    assert!(page.contains("ages (--ages NAME)") && page.contains("young: age=0.5"), "{page}");
    let shown = folder.run(&["show", "shrub.toml", "--json"]).done().json();
    assert_eq!(shown["ages"][0], serde_json::json!({ "name": "young", "turns": { "age": "0.5" } }));
    folder.run(&["sheet", "shrub.toml", "--ages", "--size", "40x48", "-o", "s.png"]).done();
    assert_eq!(size(&folder, "s.png").0, 80);
}

#[test]
fn what_is_no_age_is_refused() {
    let folder = folder();
    for (args, part) in [
        (&["stats", "shrub.toml", "--age", "yung"][..], "did you mean 'young'"),
        (&["stats", "shrub.toml", "--age", "all"], "expected one age"),
        (&["stats", "shrub.toml", "--age", "2"], "error: --age knob 'age': 2 is outside the range"),
        (&["stats", "shrub.toml", "--age", "2"], "years are 2y"),
        (&["stats", "simple", "--age", "3000"], "does not grow by years"),
        (&["stats", "shrub.toml", "--ages", "young", "--set", "years=4"], "leave one out"),
        (&["stats", "shrub.toml", "--ages", "young", "--age", "young"], "name all of them with --ages"),
        (&["stats", "simple", "--ages"], "names none"),
        (&["export", "shrub.toml", "--ages", "-o", "-", "--format", "obj"], "a stream holds one age"),
        (&["export", "shrub.toml", "simple", "--ages", "-o", "a.glb"], "for one source"),
        (&["open", "shrub.toml", "--age", "young"], "turn the knob age there"),
    ] {
        let said = folder.run(args);
        assert!(said.code == Some(2) && said.err.contains(part), "{args:?}: {:?} {}", said.code, said.err);
    }
    assert_eq!(folder.names(), ["shrub.toml"], "nothing is half written");
}

#[test]
fn an_impostor_is_two_pictures_and_what_a_shader_must_know() {
    let folder = folder();
    folder.run(&["impostor", "shrub.toml", "--frames", "4", "--size", "130", "-o", "i.json"]).done();
    let about: serde_json::Value = serde_json::from_slice(&folder.read("i.json")).unwrap();
    assert_eq!(
        (&about["mapping"], &about["frames"], &about["view_px"]),
        (&"hemi-octahedron".into(), &4.into(), &32.into())
    );
    for key in ["color", "normal_depth"] {
        assert_eq!(size(&folder, about[key].as_str().unwrap()), (128, 128), "{key}");
    }
    let height_m = height(&folder, &["shrub.toml"]);
    let radius_m = about["radius_m"].as_f64().unwrap();
    assert!(radius_m > 0.5 * height_m && radius_m < 1.5 * height_m, "{radius_m} {height_m}");
    folder.run(&["impostor", "shrub.toml", "--whole", "--frames", "3", "--size", "96", "-o", "./"]).done();
    let whole: serde_json::Value = serde_json::from_slice(&folder.read("shrub_impostor.json")).unwrap();
    assert_eq!(whole["mapping"], "octahedron");
    for (args, part) in [
        (&["impostor", "shrub.toml", "-o", "i.png"][..], "name it like oak_impostor.json"),
        (&["impostor", "shrub.toml", "-o", "-"], "pictures beside it"),
        (&["impostor", "shrub.toml", "-o", "j.json", "--frames", "1"], "expected 2 to 32 views"),
        (&["impostor", "shrub.toml", "-o", "j.json", "--size", "20"], "8 pixels or more"),
    ] {
        let said = folder.run(args);
        assert!(said.code == Some(2) && said.err.contains(part), "{args:?}: {}", said.err);
    }
    assert!(!folder.names().iter().any(|name| name.starts_with('j')), "{:?}", folder.names());
}
