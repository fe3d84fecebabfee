//! list, show, stats.

use crate::program::Folder;

#[test]
fn the_list_names_the_presets_that_are_promised() {
    let folder = Folder::new();
    let text = folder.run(&["list"]).done().out;
    let rows = folder.run(&["list", "--json"]).done().json();
    let ids: Vec<&str> = rows.as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap()).collect();
    for id in [
        "abop-a",
        "abop-b",
        "abop-c",
        "abop-d",
        "abop-e",
        "abop-f",
        "bush-3d",
        "abop-stochastic",
        "older-a",
        "older-b",
        "older-c",
        "older-d",
        "older-e",
        "older-f",
        "older-c-stochastic",
        "simple",
        "fir",
        "cypress",
        "cylinder",
        "sphere",
        "heart",
    ] {
        assert!(ids.contains(&id) && text.contains(&format!("  {id} ")), "{id}");
    }
    // How large each is stands there without growing it: as 'stats' measures it.
    let of = |id: &str| rows.as_array().unwrap().iter().find(|row| row["id"] == id).unwrap().clone();
    for id in ["simple", "abop-bush", "male-fern"] {
        let (listed, measured) = (of(id), folder.run(&["stats", id, "--json"]).done().json());
        let height = |row: &serde_json::Value| row["height_m"].as_f64().unwrap();
        assert!((height(&listed) - height(&measured)).abs() < 0.006, "{id}: {listed}");
        assert_eq!(listed["leaves"], measured["leaves"], "{id}");
        let line = text.lines().find(|line| line.trim_start().starts_with(id)).unwrap();
        let generator = measured["generator"].as_str().unwrap();
        assert!(line.contains(generator) && line.contains(&format!("{:.2} m", height(&listed))), "{line}");
    }
    assert!(of("orchard")["height_m"].is_null() && of("orchard")["generator"] == "forest");
    let formats = folder.run(&["list", "--exporters", "--json"]).done().json();
    let ids: Vec<&str> = formats.as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap()).collect();
    assert_eq!(
        ids,
        [
            "obj",
            "ply",
            "ply-skeleton",
            "gltf",
            "glb",
            "usda",
            "usdc",
            "usdz",
            "qsm",
            "mat",
            "mtg",
            "organs",
            "stl",
            "3mf",
            "html"
        ]
    );
}

#[test]
fn show_derives_strings() {
    let folder = Folder::new();
    // ABOP, Fig. 1.24 a: F -> F[+F]F[-F]F.
    assert_eq!(folder.run(&["show", "abop-a", "--derive", "0"]).done().out, "F\n");
    assert_eq!(folder.run(&["show", "abop-a", "--derive", "1"]).done().out, "F[+F]F[-F]F\n");
    let twice = folder.run(&["show", "abop-a", "--derive", "2"]).done().out;
    assert_eq!(twice, "F[+F]F[-F]F\n".replace('F', "F[+F]F[-F]F"));
    // A string has no length, and nothing is said of units.
    folder.write("own.txt", "axiom=F\nangle=20\nnumber of derivations=1\nF=F//F // a leaf\n");
    let own = folder.run(&["show", "own.txt", "--derive", "0"]);
    assert_eq!((own.code, own.out.as_str()), (Some(0), "F\n"));
    let note =
        "note: own.txt: line 4: '//' within a rule rolls twice; a comment stands on a line of its own\n";
    assert_eq!(own.err, note);
    assert!(folder.run(&["show", "own.txt"]).err.contains("a grammar has no units"));
    let refused = folder.run(&["show", "fir", "--derive", "1"]);
    assert!(refused.code == Some(2) && refused.err.contains("colonization"), "{}", refused.err);
    let long = folder.run(&["show", "abop-a", "--derive", "30"]);
    assert!(long.code == Some(1) && long.err.contains("limit"), "{}", long.err);
}

#[test]
fn show_derives_module_by_module() {
    let folder = Folder::new();
    let word = |steps: &str| folder.run(&["show", "abop-d", "--derive", steps, "--json"]).done().json();
    // ABOP, Fig. 1.24 d: X -> F[+X]F[-X]+X, F -> FF.
    let (now, next) = (word("1"), word("2"));
    let rules: Vec<&str> =
        now["rules"].as_array().unwrap().iter().map(|row| row["rule"].as_str().unwrap()).collect();
    assert_eq!(rules, ["X -> F[+X]F[-X]+X", "F -> FF"]);
    let page = folder.run(&["show", "abop-d"]).done().out;
    let mut grammar = page.lines().skip_while(|line| *line != "grammar").skip(1);
    for row in now["rules"].as_array().unwrap() {
        let line = row["line"].as_u64().unwrap() as usize;
        assert_eq!(grammar.clone().nth(line - 1).unwrap().trim(), row["rule"].as_str().unwrap());
    }
    assert_eq!(grammar.next().unwrap().trim(), now["axiom"].as_str().unwrap());
    let modules = |word: &serde_json::Value| word["modules"].as_array().unwrap().clone();
    let text: String = modules(&next).iter().map(|row| row["symbol"].as_str().unwrap().to_owned()).collect();
    assert_eq!(text + "\n", folder.run(&["show", "abop-d", "--derive", "2"]).done().out);
    let mut node = 0;
    for row in modules(&next) {
        let parent = &modules(&now)[row["parent"].as_u64().unwrap() as usize];
        assert_eq!(row["rule"], parent["next_rule"]);
        if row["symbol"] == "F" {
            node += 1;
            assert_eq!(row["node"], node, "node 0 is the foot");
        } else {
            assert!(row["node"].is_null());
        }
    }
    // The turtle goes straight up first, and after each branch stands where that began.
    let mut begun = Vec::new();
    for row in modules(&next) {
        match row["symbol"].as_str().unwrap() {
            "[" => begun.push(row["at"].clone()),
            "]" => assert_eq!(Some(&row["at"]), begun.pop().as_ref()),
            _ => {}
        }
    }
    assert!(begun.is_empty());
    let first: Vec<f64> =
        modules(&next)[0]["at"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert!(first[0].abs() < 1e-6 && first[1] > 0.0 && first[2].abs() < 1e-6, "{first:?}");
    assert!(modules(&word("0"))[0]["parent"].is_null());
    let long = folder.run(&["show", "abop-d", "--derive", "12", "--json"]);
    assert!(long.code == Some(1) && long.err.contains("1000000 modules"), "{}", long.err);
    assert!(long.err.contains("derivations or fewer"), "{}", long.err);
    let refused = folder.run(&["show", "fir", "--derive", "1", "--json"]);
    assert!(refused.code == Some(2) && refused.err.contains("colonization"), "{}", refused.err);
}

#[test]
fn show_tells_forecast_and_knobs() {
    let folder = Folder::new();
    let text = folder.run(&["show", "abop-a"]).done().out;
    // ABOP, Fig. 1.24 a: 7811 symbols, 3125 F.
    assert!(text.contains("7,811 symbols, 3,125 segments"), "{text}");
    assert!(text.contains("F -> F[+F]F[-F]F"), "{text}");

    let shown = folder.run(&["show", "fir", "--json", "--set", "points=77", "--seed", "5"]).done().json();
    assert_eq!(shown["generator"], "colonization");
    let knob = |name: &str| {
        let knobs = shown["knobs"].as_array().unwrap();
        knobs.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("no knob {name}")).clone()
    };
    for name in [
        "points",
        "step",
        "influence",
        "kill",
        "max_iterations",
        "max_nodes",
        "root",
        "trunk",
        "tropism",
        "seed",
        "radius_exponent",
        "tip_radius",
        "base_radius",
        "up",
    ] {
        assert!(!knob(name)["help"].as_str().unwrap().is_empty());
    }
    assert_eq!((knob("points")["value"].as_str(), knob("seed")["value"].as_str()), (Some("77"), Some("5")));
    assert_eq!(knob("influence")["value"], "50D");
}

#[test]
fn what_differs_from_the_defaults_is_shown_alone() {
    let folder = Folder::new();
    for id in ["oak", "abop-stochastic", "heart"] {
        let full = folder.run(&["show", id, "--toml"]).done().out;
        let short = folder.run(&["show", id, "--toml", "--changed"]).done().out;
        assert!(3 * short.lines().count() < 2 * full.lines().count(), "{short}");
        folder.write("mine.toml", &short);
        let recipe = |source: &str| folder.run(&["show", source, "--json"]).done().json()["recipe"].clone();
        assert_eq!(recipe("mine.toml"), recipe(id), "{short}");
    }
    let page = folder.run(&["show", "drawn-oak", "--changed", "--set", "gnarl=0.3"]).done().out;
    let names: Vec<&str> = page.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(["crown", "points", "base_radius", "gnarl"].iter().all(|name| names.contains(name)), "{page}");
    assert!(["max_iterations", "width", "lods"].iter().all(|name| !names.contains(name)), "{page}");
    // As the machine has it: the same knobs, each said to have been changed.
    let rows = |args: &[&str]| folder.run(args).done().json()["knobs"].as_array().unwrap().clone();
    let all = rows(&["show", "drawn-oak", "--json"]);
    let changed: Vec<_> = all.iter().filter(|row| row["changed"] == true).cloned().collect();
    assert!(changed.len() < all.len() / 2);
    assert_eq!(rows(&["show", "drawn-oak", "--json", "--changed"]), changed);
    assert_eq!(folder.run(&["show", "mixed-wood", "--changed"]).code, Some(2));
}

#[test]
fn what_show_writes_as_a_document_grows_the_same_tree() {
    let folder = Folder::new();
    for id in ["fir", "cypress", "abop-stochastic"] {
        let document = folder.run(&["show", id, "--toml", "--seed", "9"]).done().out;
        folder.write("mine.toml", &document);
        let hash = |args: &[&str]| folder.run(args).done().json()["skeleton_hash"].clone();
        let original = hash(&["stats", id, "--seed", "9", "--json"]);
        assert_eq!(hash(&["stats", "mine.toml", "--json"]), original, "{id}: {document}");
        assert_ne!(hash(&["stats", id, "--seed", "8", "--json"]), original, "{id}: the seed matters");
    }
}

/// 4 m that lean by 30°, then 4 m upright, or on by as much again: half of the height says how far the stem leans.
#[test]
fn a_stem_leans_as_far_as_it_does_up_to_half_of_the_height() {
    let folder = Folder::new();
    let (sin, cos) = (0.5_f64, 0.75_f64.sqrt());
    // Where it goes on upright, half of the height is above the bend.
    let half_m = 0.5 * (4.0 + 4.0 * cos);
    let upright_deg = (4.0 * sin / half_m).atan().to_degrees();
    for (turned, expected_deg) in [(-30, upright_deg), (0, 30.0), (30, 30.0)] {
        folder.write("s.txt", format!("axiom=+(30)F(4)+({turned})F(4)\nangle=30\nnumber of derivations=1\n"));
        let stats = folder.run(&["stats", "s.txt", "--set", "segment_length=1", "--json"]).done().json();
        let lean_deg = stats["stem_lean_deg"].as_f64().unwrap();
        assert!((lean_deg - expected_deg).abs() < 0.1, "{turned}: {lean_deg}, not {expected_deg}");
    }
}

#[test]
fn stats_carry_every_promised_key_and_add_up() {
    let folder = Folder::new();
    let fir = folder.run(&["stats", "fir", "--json"]).done().json();
    let weed = folder.run(&["stats", "abop-b", "--json"]).done().json();
    for key in [
        "source",
        "seed",
        "generator",
        "nodes",
        "segments",
        "axes",
        "max_order",
        "total_length_m",
        "height_m",
        "crown_width_m",
        "trunk_diameter_m",
        "points",
        "points_unreached",
        "iterations",
        "symbols",
        "triangles",
        "vertices",
        "leaves",
        "watertight",
        "bounds",
        "skeleton_hash",
        "seconds",
    ] {
        assert!(fir.get(key).is_some() && weed.get(key).is_some(), "{key}");
    }
    // ABOP, Fig. 1.24 b.
    assert_eq!((weed["symbols"].as_u64(), weed["segments"].as_u64()), (Some(9373), Some(3125)));
    assert!(weed["points"].is_null() && fir["symbols"].is_null());
    assert_eq!(fir["points"], 1000);
    assert_eq!(fir["watertight"], true);
    let height = fir["height_m"].as_f64().unwrap();
    // A cone of 10 m on a trunk of 2 m.
    assert!((9.0..12.2).contains(&height), "{height}");
    let top = fir["bounds"]["max"][1].as_f64().unwrap() - fir["bounds"]["min"][1].as_f64().unwrap();
    assert!((height - top).abs() < 0.1, "the surface is as high as the skeleton");
    assert!(fir["seconds"]["grow"].is_number() && fir["seconds"]["dress"].is_number());
}
