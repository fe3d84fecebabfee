//! list, show, stats, preview, completions, man, schema, help.

use std::collections::BTreeSet;
use std::path::Path;

use crate::program::Folder;

const COMMANDS: [&str; 23] = [
    "open",
    "list",
    "show",
    "stats",
    "sweep",
    "calibrate",
    "batch",
    "bench",
    "preview",
    "sheet",
    "export",
    "impostor",
    "scan",
    "recipe",
    "verify",
    "lint",
    "cite",
    "forest",
    "doctor",
    "cache",
    "completions",
    "man",
    "schema",
];

#[test]
fn help_names_every_command_and_every_command_has_help_and_a_manual() {
    let folder = Folder::new();
    let help = folder.run(&["--help"]).done().out;
    for command in COMMANDS {
        assert!(help.lines().any(|line| line.trim_start().starts_with(command)), "{command} in {help}");
        let page = folder.run(&[command, "--help"]).done().out;
        assert!(page.contains(&format!("Usage: linden {command}")), "{page}");
        let manual = folder.run(&["man", command]).done().out;
        assert!(manual.contains(&format!(".TH linden-{command}")), "{manual}");
    }
    assert!(folder.run(&["--version"]).done().out.starts_with("linden 0."));
}

#[test]
fn without_a_command_it_is_a_matter_of_usage() {
    let said = Folder::new().run(&[]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("linden export fir -o fir.glb"), "{}", said.err);
}

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

/// A picture's width and height, and its pixels.
pub fn pixels(png: &[u8]) -> ((u32, u32), Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    ((info.width, info.height), bytes)
}

#[test]
fn a_sheet_is_made_of_the_previews_of_its_trees() {
    let folder = Folder::new();
    let sheet =
        ["sheet", "fir", "older-shrub", "--seeds", "2", "--size", "60x70", "--columns", "3", "-o", "s.png"];
    folder.run(&[&sheet[..], &["--labels", "none"]].concat()).done();
    let (size, whole) = pixels(&folder.read("s.png"));
    assert_eq!(size, (180, 140));
    let channels = whole.len() / (180 * 140);
    for (place, (id, seed)) in
        [("fir", "1"), ("fir", "2"), ("older-shrub", "1"), ("older-shrub", "2")].iter().enumerate()
    {
        let png = folder.run(&["preview", id, "--seed", seed, "--size", "60x70", "-o", "-"]).done().bytes;
        let (size, preview) = pixels(&png);
        assert_eq!((size, preview.len()), ((60, 70), 60 * 70 * channels));
        let (left, top) = (place % 3 * 60, place / 3 * 70);
        for (row, line) in preview.chunks(60 * channels).enumerate() {
            let at = ((top + row) * 180 + left) * channels;
            assert_eq!(&whole[at..at + line.len()], line, "{id} {seed}, row {row}");
        }
    }
    let last = &whole[((70 * 180) + 120) * channels..][..3];
    assert_eq!(last, [255; 3], "nothing lies there");

    // With labels each picture is the same, and has letters below it: a name, and a seed.
    folder.run(&sheet).done();
    let ((wide, high), labelled) = pixels(&folder.read("s.png"));
    let below = high as usize / 2 - 70;
    assert!(wide == 180 && high % 2 == 0 && below > 12, "{wide}x{high}");
    let line = 180 * channels;
    assert_eq!(labelled[..70 * line], whole[..70 * line]);
    assert_eq!(labelled[(70 + below) * line..][..70 * line], whole[70 * line..]);
    for place in 0..3 {
        let inked = |rows: std::ops::Range<usize>| {
            let columns = place * 60..(place + 1) * 60;
            rows.flat_map(|y| columns.clone().map(move |x| (y * 180 + x) * channels))
                .filter(|&at| labelled[at] < 110)
                .count()
        };
        let middle = 70 + below / 2;
        assert!(inked(70..middle) > 5 && inked(middle..70 + below) > 5, "two lines below tree {place}");
    }

    let said = folder.run(&["sheet", "--group", "Weeds", "-o", "w.png"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("Weeds") && said.err.contains("linden list"), "{}", said.err);
    let said = folder.run(&["sheet", "fir", "--seeds", "900", "-o", "w.png"]);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert_eq!(folder.names(), ["s.png"]);
}

#[test]
fn trees_of_a_sheet_are_in_one_scale_where_that_is_asked_for() {
    let folder = Folder::new();
    for (id, times) in [("low", 1.0), ("high", 4.0)] {
        let [height, radius, step, trunk] = [2.0, 1.0, 0.1, 0.5].map(|metres| metres * times);
        let text = format!(
            "id = \"{id}\"\n[colonization]\ncrown = \"cone\"\ncrown_height = {height:?}\ncrown_radius = {radius:?}\n\
             points = 60\nstep = {step:?}\ntrunk = {trunk:?}\n"
        );
        folder.write(&format!("{id}.toml"), text);
    }
    let sheet = ["sheet", "low.toml", "high.toml", "--columns", "2", "--size", "60x70", "--labels", "none"];
    // Rows in which a tree, and not its ground alone, is seen.
    let rows = |more: &[&str]| {
        folder.run(&[&sheet[..], more, &["-o", "s.png"]].concat()).done();
        let ((wide, high), whole) = pixels(&folder.read("s.png"));
        let channels = whole.len() / (wide * high) as usize;
        let is_inked = |x: usize, y: usize| whole[(y * wide as usize + x) * channels] < 110;
        [0..60, 60..120].map(|columns| (0..70).filter(|&y| columns.clone().any(|x| is_inked(x, y))).count())
    };
    let ([low, high], [low_of_one, high_of_one]) = (rows(&[]), rows(&["--one-scale"]));
    assert!(low.abs_diff(high) < 6, "each fills its picture: {low}, {high}");
    assert!(high_of_one.abs_diff(high) < 6 && 3 * low_of_one < high_of_one, "{low_of_one}, {high_of_one}");
}

#[test]
fn wood_whose_bark_is_described_is_shown_with_it() {
    let folder = Folder::new();
    let draw = |source: &str, more: &[&str]| {
        let words = ["preview", source, "--size", "60x80", "-o", "p.png"];
        assert_eq!(folder.run(&[&words[..], more].concat()).code, Some(0));
        folder.read("p.png")
    };
    let bare = ["--set", "leaf_form=none", "--set", "bark_size=32", "--set", "age=0.2"];
    let surface = [&bare[..], &["--look", "surface"]].concat();
    assert!(draw("silver-birch", &bare) == draw("silver-birch", &surface));
    folder.write("weed.l", "axiom=F\nangle=25.7\nnumber of derivations=3\nF=F[+F]F[-F]F\n");
    assert!(draw("weed.l", &[]) == draw("weed.l", &["--look", "skeleton"]));
}

#[test]
fn flat_drawings_are_pictures_and_svg() {
    let folder = Folder::new();
    // A plane weed of ABOP: every segment is drawn, and its thickness does not vary much.
    let flat = ["preview", "older-a", "--look", "turtle", "--size", "300x360"];
    folder.run(&[&flat[..], &["-o", "flat.png"]].concat()).done();
    let (size, rgb) = pixels(&folder.read("flat.png"));
    assert_eq!((size, rgb.len()), ((300, 360), 300 * 360 * 3), "on paper");
    assert_eq!(rgb[..3], [255; 3]);
    let svg = |args: &[&str]| {
        folder.run(&[&["preview", "older-a", "--size", "300x360", "-o", "a.svg"], args].concat()).done();
        String::from_utf8(folder.read("a.svg")).unwrap()
    };
    let (usual, named) = (svg(&[]), svg(&["--look", "turtle"]));
    assert_eq!(usual, named, "an SVG is a flat drawing");
    assert!(usual.starts_with("<svg xmlns=") && usual.contains("viewBox=\"0 0 300 360\""));
    assert!(usual.contains("<path ") && usual.contains("older-a"), "strokes, and the recipe");
    // Its quotes are letters that XML has for itself.
    let named = ["preview", "older-a", "--set", "derivations=3", "--set", "angle=21.5", "-o"];
    let recipe = |file: &str| {
        folder.run(&[&named[..], &[file]].concat()).done();
        folder.run(&["recipe", file]).done().out
    };
    assert_eq!(recipe("a.svg"), recipe("flat.png"), "the recipe comes back");
    // Other colours are other strokes.
    assert_ne!(usual, svg(&["--color", "order"]));
    for (args, expected) in [
        (&["preview", "older-a", "--look", "surface", "-o", "b.svg"][..], "--look turtle"),
        (&["preview", "fir", "--lod", "1", "-o", "b.svg"], "--lod is a level of the surface"),
        (&["sheet", "older-a", "-o", "b.svg"], "linden preview"),
        (&["preview", "older-a", "-o", "b.svgz"], ".svg"),
    ] {
        let said = folder.run(args);
        assert_eq!(said.code, Some(2), "{args:?}");
        assert!(said.err.contains(expected), "{args:?}: {}", said.err);
    }
    assert_eq!(folder.names(), ["a.svg", "flat.png"]);
}

#[test]
fn previews_have_the_size_and_the_background_that_was_asked_for() {
    let folder = Folder::new();
    folder
        .run(&["preview", "fir", "-o", "fir.png", "--size", "120x90", "--background", "transparent"])
        .done();
    let (size, rgba) = pixels(&folder.read("fir.png"));
    assert_eq!(size, (120, 90));
    let opaque = rgba.chunks(4).filter(|p| p[3] > 200).count();
    assert_eq!(rgba[3], 0, "the corner is empty");
    assert!((50..5000).contains(&opaque), "{opaque} pixels of tree");

    let turned = |yaw: &str| folder.run(&["preview", "fir", "-o", "-", "--yaw", yaw]).done().bytes;
    assert!(turned("0").starts_with(b"\x89PNG"));
    assert_ne!(turned("0"), turned("90"));
    assert_eq!(turned("45"), turned("45"), "the same picture again");
}

#[test]
fn a_preview_shows_what_stands_in_the_way_and_a_tree_alone_where_that_is_asked_for() {
    let folder = Folder::new();
    let draw = |id: &str, more: &[&str]| {
        let drawn = folder
            .run(&[&["preview", id, "--size", "80x96", "--set", "points=300", "-o", "-"], more].concat());
        assert_eq!(drawn.code, Some(0), "{}", drawn.err);
        (drawn.bytes, drawn.err)
    };
    for id in ["around-the-stone", "street-lamp"] {
        for look in ["skeleton", "surface", "turtle"] {
            let [(with, said), (without, _)] =
                [&["--look", look][..], &["--look", look, "--alone"]].map(|more| draw(id, more));
            assert_ne!(with, without, "{id} {look}");
            assert!(!said.contains("--alone"), "{said}");
        }
    }
    let [(with, _), (without, said)] = [&[][..], &["--alone"]].map(|more| draw("fir", more));
    assert_eq!(with, without);
    assert!(said.contains("--alone changes nothing"), "{said}");
}

#[test]
fn a_preview_is_in_the_format_of_its_ending_and_carries_its_recipe() {
    let folder = Folder::new();
    let preview = |file: &str, background: &str| {
        let size = ["--size", "60x70", "--background", background];
        folder.run(&[&["preview", "fir", "--seed", "3", "-o", file][..], &size].concat())
    };
    let read = |file: &str| {
        let found = linden::input::read_picture("", &folder.read(file), &linden::Quiet).unwrap();
        ([found.picture.width(), found.picture.height()], found.picture.rgba().to_vec())
    };
    let opening = |file: &str| folder.read(file)[..12].to_vec();
    for background in ["studio", "transparent"] {
        for file in ["a.png", "a.webp", "a.jpg", "a.JPEG"] {
            let said = preview(file, background);
            assert_eq!(said.code, Some(0), "{file}: {}", said.err);
            let said = said.err;
            let is_white = background == "transparent" && file.to_lowercase().contains("jp");
            assert_eq!(said.contains("the background is white"), is_white, "{file}: {said}");
        }
        let (png, jpeg) = (read("a.png"), read("a.jpg"));
        assert!(png == read("a.webp"), "without loss");
        assert!(opening("a.webp").starts_with(b"RIFF") && opening("a.jpg").starts_with(b"\xff\xd8\xff"));
        assert_eq!(folder.read("a.jpg"), folder.read("a.JPEG"));
        let over_white = |pixel: &[u8]| {
            let alpha = f64::from(pixel[3]) / 255.0;
            [0, 1, 2].map(|i| 255.0 + (f64::from(pixel[i]) - 255.0) * alpha)
        };
        let shown = png.1.chunks(4).flat_map(over_white);
        let off: f64 = shown
            .zip(jpeg.1.chunks(4).flat_map(|p| p[..3].to_vec()))
            .map(|(a, b)| (a - f64::from(b)).abs())
            .sum();
        assert_eq!(png.0, jpeg.0);
        assert!(off / 60.0 / 70.0 / 3.0 < 6.0, "{background}: off by {off}");
    }
    let recipe = folder.run(&["recipe", "a.png"]).done().out;
    assert!(recipe.contains("fir"));
    for file in ["a.jpg", "a.webp"] {
        assert_eq!(folder.run(&["recipe", file]).done().out, recipe, "{file}");
    }
    folder.run(&["sheet", "fir", "--size", "40x40", "--labels", "none", "-o", "sheet.webp"]).done();
    assert_eq!(read("sheet.webp").0, [40, 40]);
}

#[test]
fn a_preview_without_a_file_is_text_of_the_terminals_size() {
    let folder = Folder::new();
    let plain = folder.run(&["preview", "cypress", "--size", "40x20"]).done().out;
    assert!(!plain.contains('\u{1b}'), "no colours in a pipe");
    assert_eq!(plain.lines().count(), 20);
    assert!(plain.lines().all(|line| line.chars().count() <= 40));
    assert!(plain.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count() > 40, "{plain}");
}

/// All names of variables that stand in the program's code as text, apart from tests and what builds it.
fn variables() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "tests" {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs")
                && !name.contains("tests")
                && name != "build.rs"
            {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let texts = code.split('"').skip(1).step_by(2);
                found.extend(
                    texts
                        .filter(|text| {
                            let is_name = |c: char| c.is_ascii_uppercase() || c == '_';
                            text.strip_prefix("LINDEN_").is_some_and(|rest| rest.chars().all(is_name))
                        })
                        .map(str::to_owned),
                );
            }
        }
    }
    found
}

#[test]
fn the_manual_has_formats_knobs_variables_files_and_a_page_for_each_reference() {
    let folder = Folder::new();
    // As a reader sees it: dashes are escaped in roff.
    let manual = folder.run(&["man"]).done().out.replace('\\', "");
    for format in folder.run(&["list", "--exporters", "--json"]).done().json().as_array().unwrap() {
        let id = format["id"].as_str().unwrap();
        assert!(manual.contains(&format!("fB{id}fR")), "{id}");
    }
    for source in ["oak", "abop-a", "fir"] {
        for knob in folder.run(&["show", source, "--json"]).done().json()["knobs"].as_array().unwrap() {
            let name = knob["name"].as_str().unwrap();
            assert!(manual.contains(&format!("fB{name}fR")), "{name}");
        }
    }
    let variables = variables();
    assert!(variables.len() >= 6, "{variables:?}");
    for name in variables {
        assert!(manual.contains(&name), "{name}");
    }
    for text in ["config.toml", "session.toml", ".SH FORMATS", ".SH KNOBS", ".SH ENVIRONMENT", ".SH FILES"] {
        assert!(manual.contains(text), "{text}");
    }
    assert!(manual.contains(".SH \"EXIT STATUS\""), "{manual}");
    // Every page that is referred to is written.
    folder.run(&["man", "-o", "man1"]).done();
    let mut names: Vec<String> = std::fs::read_dir(folder.file("man1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut expected: Vec<String> = COMMANDS.iter().map(|command| format!("linden-{command}.1")).collect();
    expected.push("linden.1".to_owned());
    expected.sort();
    assert_eq!(names, expected);
    for command in COMMANDS {
        assert!(manual.contains(&format!("linden-{command}(1)")), "{command}");
        let page = String::from_utf8(folder.read(&format!("man1/linden-{command}.1"))).unwrap();
        assert_eq!(page, folder.run(&["man", command]).done().out, "{command}");
    }
}

#[test]
fn a_knob_is_explained_by_its_name() {
    let folder = Folder::new();
    let text = folder.run(&["list", "--knobs", "kill"]).done().out;
    for part in ["kill  [colonization] [scan]", "to reach it", "Runions et al. 2007", "see also: influence"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let pages = folder.run(&["list", "--knobs", "tropism", "--json"]).done().json();
    let sections: Vec<&serde_json::Value> =
        pages.as_array().unwrap().iter().map(|page| &page["sections"][0]).collect();
    assert_eq!(sections, ["lsystem", "colonization"], "two knobs of one name");
    assert!(pages[0]["details"].as_str().unwrap().contains("ABOP"));

    let all = folder.run(&["list", "--knobs"]).done().out;
    let rows = folder.run(&["list", "--knobs", "--json"]).done().json();
    for row in rows.as_array().unwrap() {
        assert!(all.contains(&format!("  {} ", row["name"].as_str().unwrap())), "{row}");
    }
    let said = folder.run(&["list", "--knobs", "kil"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("did you mean 'kill'?"), "{}", said.err);

    let schema = folder.run(&["schema"]).done().json();
    let described = &schema["properties"]["scan"]["properties"]["kill"]["description"];
    assert!(described.as_str().unwrap().contains("Runions et al. 2007"), "{described}");
}

#[test]
fn the_schema_fits_the_documents_that_show_writes() {
    let folder = Folder::new();
    let schema = folder.run(&["schema"]).done().json();
    for id in ["fir", "cypress", "heart", "abop-d"] {
        let document = folder.run(&["show", id, "--json"]).done().json()["recipe"].clone();
        for (section, keys) in document.as_object().unwrap() {
            if ["linden", "hash", "inputs"].contains(&section.as_str()) {
                continue;
            }
            let described = &schema["properties"][section];
            assert!(described.is_object(), "{section}");
            for key in keys.as_object().into_iter().flatten().map(|(key, _)| key) {
                assert!(described["properties"][key].is_object(), "{section}.{key}");
            }
        }
    }
    assert!(schema["$defs"]["export options"]["properties"]["obj"].is_object());
}

/// In documents and by their schema.
#[test]
fn one_number_is_a_list_of_one() {
    let folder = Folder::new();
    let hash = |angle: &str| {
        let head = "id = \"x\"\nname = \"X\"\ngroup = \"mine\"\nsummary = \"x\"\nsource = \"x\"\n";
        folder.write("x.toml", format!("{head}[self-organizing]\nyears = 6\nbranching_angle = {angle}\n"));
        let stats = folder.run(&["stats", "x.toml", "--json"]).done().json();
        stats["skeleton_hash"].as_str().unwrap().to_owned()
    };
    assert!(hash("35") == hash("[35]") && hash("35.0") == hash("[35]") && hash("35") != hash("[35, 70]"));
    let schema = folder.run(&["schema"]).done().json();
    let forms = &schema["properties"]["self-organizing"]["properties"]["branching_angle"]["anyOf"];
    let types: Vec<&str> =
        forms.as_array().unwrap().iter().filter_map(|form| form["type"].as_str()).collect();
    assert_eq!(types, ["number", "array"]);
}

/// Flags of the terminal count before a command and behind it, where they mean something, and are
/// refused by name where they do not.
#[test]
fn flags_of_the_terminal_are_for_the_commands_that_show_pictures() {
    let folder = Folder::new();
    let preview = ["preview", "cypress", "--size", "20x10", "--colors", "256"];
    let shown =
        |before: &[&str], behind: &[&str]| folder.run(&[before, &preview, behind].concat()).done().bytes;
    let halves = shown(&[], &["--graphics", "halves"]);
    assert_eq!(shown(&["--graphics", "halves"], &[]), halves);
    assert_eq!(shown(&["--graphics=braille"], &["--graphics=halves"]), halves, "the nearer one counts");
    let text = String::from_utf8(halves.clone()).unwrap();
    assert!(text.contains('▀') && text.contains("\x1b[38;5;") && !text.contains('▙'), "{text}");
    assert_ne!(shown(&[], &["--graphics", "quadrants"]), halves);
    for (how, begins) in
        [("kitty", "\x1b_Ga=t,f=100"), ("iterm2", "\x1b]1337;File=inline=1"), ("sixel", "\x1bP")]
    {
        let bytes = shown(&["--graphics", how], &[]);
        let text = String::from_utf8_lossy(&bytes);
        // Room for it, the picture, and on from the line below.
        assert!(text.starts_with(&format!("{}\x1b[10A\x1b7{begins}", "\n".repeat(10))), "{text:.60}");
        assert!(text.ends_with("\x1b8\x1b[10B\r"), "{how}");
    }
    let colored = folder.run(&["--colors", "16", "doctor", "--json"]).json();
    let findings = colored["terminal"]["findings"].as_array().unwrap();
    assert!(findings.iter().any(|row| row["why"] == "--colors asks for it"), "{colored}");

    let said = |args: &[&str], fragment: &str| {
        let said = folder.run(args);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{args:?}");
        assert!(said.err.contains(fragment), "{args:?}: {}", said.err);
    };
    said(&["--graphics", "sixel", "list"], "--graphics has no effect here: it is for linden, linden open,");
    said(&["--stats", "export", "fir", "-o", "x.glb"], "--stats has no effect here");
    said(&["--log", "x", "doctor"], "--log has no effect here: it is for linden and linden open");
    said(&["list", "--graphics", "sixel"], "'--graphics'");
    said(&["--graphics", "crayons", "preview", "fir"], "--graphics: 'crayons' is none of kitty");
    said(&["preview", "fir", "-o", "x.png", "--graphics", "sixel"], "no effect on a file");
    assert_eq!(folder.run(&["--memory", "1G", "list"]).done().code, Some(0));
    assert!(folder.names().is_empty());
}
