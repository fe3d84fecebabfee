//! `lint`: the same of all formats, what our own files are, and exit codes.

use serde_json::Value;

use crate::program::{Folder, Said};

fn lint(folder: &Folder, args: &[&str]) -> (Said, Value) {
    let said = folder.run(&[&["lint", "--json"], args].concat());
    let report = serde_json::from_str(&said.out).unwrap_or_default();
    (said, report)
}

fn rules(report: &Value) -> Vec<String> {
    let findings = report["files"][0]["findings"].as_array().unwrap().iter();
    findings.map(|finding| finding["rule"].as_str().unwrap().to_owned()).collect()
}

const SMALL: [&str; 4] = ["--set", "points=60", "--set", "bark_size=64"];

/// For plants with leaves, where it does not matter what pictures show.
const PICTURES: [&str; 6] = ["--set", "bark_size=64", "--set", "leaf_size=32", "--set", "card_size=128"];

#[test]
fn all_formats_of_a_tree_have_the_same_counts() {
    let folder = Folder::new();
    let outputs = [
        "-o", "a.glb", "-o", "a.gltf", "-o", "a.obj", "-o", "a.ply", "-o", "a.usda", "-o", "a.usdc", "-o",
        "a.usdz",
    ];
    folder.run(&[&["export", "dressed-simple"], &SMALL[..], &outputs].concat()).done();
    let numbers = |file: &str, key: &str| {
        let (said, report) = lint(&folder, &[file]);
        assert!(said.code == Some(0), "{file}: {}{}", said.out, said.err);
        assert!(!rules(&report).iter().any(|rule| rule == "degenerate" || rule == "winding"), "{report}");
        report["files"][0]["numbers"][key].clone()
    };
    let stats = folder.run(&["stats", "a.glb", "--json"]).done().json();
    for file in ["a.glb", "a.gltf", "a.obj", "a.ply", "a.usda", "a.usdc", "a.usdz"] {
        assert_eq!(numbers(file, "triangles")[0], stats["triangles"], "{file}");
        let height = numbers(file, "height_m").as_f64().unwrap();
        let expected = numbers("a.glb", "height_m").as_f64().unwrap();
        assert!((height - expected).abs() < 1e-4, "{file}: {height} {expected}");
        assert_eq!(numbers(file, "draw_calls")[0], if file == "a.ply" { 1 } else { 2 }, "{file}");
        // OBJ has no roughness, but a picture of what is cut out.
        let materials = if file == "a.ply" { 0 } else { 2 };
        assert_eq!(numbers(file, "materials"), materials, "{file}");
    }
}

#[test]
fn levels_are_seen_in_one_file_and_in_several() {
    let folder = Folder::new();
    let args = ["export", "fir", "--lods", "3", "-o", "a.glb", "-o", "a.obj", "-o", "a.usda", "-o", "q.glb"];
    folder.run(&[&args[..], &SMALL[..]].concat()).done();
    let triangles = |files: &[&str]| {
        let (_, report) = lint(&folder, files);
        assert_eq!(report["files"].as_array().unwrap().len(), 1, "{report}");
        report["files"][0]["numbers"]["triangles"].clone()
    };
    let levels = triangles(&["a.glb"]);
    assert_eq!(levels.as_array().unwrap().len(), 3);
    assert_eq!(triangles(&["a_LOD1.obj", "a_LOD0.obj", "a_LOD2.obj"]), levels);
    assert_eq!(triangles(&["a.usda"]), levels);
    let (_, report) = lint(&folder, &["a_LOD0.obj", "a_LOD2.obj"]);
    assert!(rules(&report).contains(&"lod-chain".to_owned()), "{report}");
}

/// Models in binary have the reports of the same as text, beside their pictures and in packages.
#[test]
fn binary_usd_has_the_report_of_text() {
    let folder = Folder::new();
    // The options are those of layers by themselves.
    for (source, args, options) in [
        ("drawn-oak", &["--lods", "3", "--set", "points=400"][..], &["proxy=true", "lightmap_uv=true"][..]),
        ("apple", &["--set", "season=0.6", "--instances"], &["collision=capsules"]),
        ("fir", &[], &["materialx=false", "pictures=false"]),
        ("drawn-oak", &["--set", "points=400"], &["payload=true"]),
        ("dressed-simple", &["--wind=bones", "--lods", "2", "--set", "points=60"], &[]),
        ("dressed-simple", &["--wind=sway", "--scene", "--set", "points=60"], &[]),
        ("dressed-simple", &["--wind=bones", "--set", "points=60"], &["nanite=skeletal"]),
    ] {
        let export = |more: &[&str]| {
            let small = ["export", source, "--triangles", "3000"];
            let said = folder.run(&[&small[..], &PICTURES, args, more].concat());
            assert_eq!(said.code, Some(0), "{source} {args:?}: {}", said.err);
        };
        let of_formats = ["usda", "usdc"].iter().flat_map(|format| {
            options.iter().flat_map(move |option| ["--set".to_owned(), format!("{format}.{option}")])
        });
        let of_formats = of_formats.collect::<Vec<_>>();
        let of_formats = of_formats.iter().map(String::as_str).collect::<Vec<_>>();
        let text = ["-o", "a.usda", "-o", "a.usdc", "-o", "text.usdz", "--set", "usdz.layer=text"];
        export(&[&text[..], &of_formats].concat());
        export(&["-o", "binary.usdz", "--set", "usdz.layer=binary"]);
        // A layer whose model is in its payload is looked at with it.
        for (text, binary) in [("a.usda", "a.usdc"), ("text.usdz", "binary.usdz")] {
            let report = |file: &str| {
                let (said, mut report) = lint(&folder, &["--set", "uv-overlap=warn", file]);
                assert_eq!(said.code, Some(0), "{source} {args:?} {file}: {}{}", said.out, said.err);
                report["files"][0]["file"].take();
                report
            };
            let (text, binary) = (report(text), report(binary));
            assert!(text["files"][0]["numbers"]["triangles"][0].as_u64() > Some(100), "{text}");
            assert_eq!(binary, text, "{source} {args:?} {options:?}");
        }
        for name in folder.names() {
            std::fs::remove_file(folder.file(&name)).unwrap();
        }
    }
}

/// A layer over others is what it shows: its own payload, or the last of several ages, with the variants that it chooses.
#[test]
fn a_layer_is_looked_at_with_its_payload() {
    let folder = Folder::new();
    let small = ["--triangles", "3000", "--lods", "2", "--set", "bark_size=16", "--set", "leaf_size=16"];
    let seasons = ["--seasons", "bare,summer", "--set", "usda.payload=true", "--set", "usdc.payload=true"];
    let age = ["--ages", "young=0.4,grown=0.5"];
    // Seasons without blossom are noted.
    let export = |args: &[&[&str]]| {
        let said = folder.run(&[&["export", "rowan"], &small[..], &args.concat()].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
    };
    export(&[&["-o", "a.usda", "-o", "a.usdc"], &seasons]);
    export(&[&["-o", "whole.usda"], &seasons[..2]]);
    export(&[&["-o", "b.usda"], &age, &seasons[2..4]]);
    let numbers = |file: &str| lint(&folder, &[file]).1["files"][0]["numbers"].clone();
    let whole = numbers("whole.usda");
    assert!(whole["triangles"][0].as_u64() > Some(1000), "{whole}");
    assert_eq!((numbers("a.usda"), numbers("a.usdc")), (whole.clone(), whole.clone()));
    assert_eq!(numbers("b.usda"), numbers("b_grown.usda"));
    // In a folder once.
    let found = lint(&folder, &["."]).1;
    let mut files: Vec<&str> =
        found["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    files.sort_unstable();
    assert_eq!(files, ["./a.usda", "./a.usdc", "./b_grown.usda", "./b_young.usda", "./whole.usda"]);
    assert!(found["passed_over"][0]["error"].as_str().unwrap().contains("./b_grown.usda"), "{found}");
    std::fs::remove_file(folder.file("a_payload.usda")).unwrap();
    let said = folder.run(&["lint", "a.usda"]);
    assert!(said.err.contains("payload ./a_payload.usda, which is not there"), "{}", said.err);
}

/// Folders, files by their names, and what is not there, in one line.
#[test]
fn folders_are_looked_through_and_what_is_missing_stops_nothing() {
    let folder = Folder::new();
    let model = "o tree\nv 0 0 0\nv 1 0 0\nv 0 2 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
    std::fs::create_dir_all(folder.file("trees/oaks")).unwrap();
    std::fs::create_dir(folder.file("none")).unwrap();
    for name in ["trees/a.obj", "trees/oaks/b_LOD0.obj", "trees/oaks/b_LOD1.obj"] {
        folder.write(name, model);
    }
    // Neither a model nor called like one.
    folder.write("trees/trees.csv", "number\n1\n");
    folder.write("none/notes.txt", "no tree");
    folder.write("trees/points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n");
    let files = |report: &Value, key: &str| -> Vec<String> {
        report[key].as_array().unwrap().iter().map(|row| row["file"].as_str().unwrap().to_owned()).collect()
    };
    let (said, report) = lint(&folder, &["trees", "trees/a.obj"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    assert_eq!(files(&report, "files"), ["trees/a.obj", "trees/oaks/b.obj"]);
    assert_eq!(files(&report, "passed_over"), ["trees/points.ply"]);
    assert!(said.err.contains("note: trees/points.ply: passed over: "), "{}", said.err);
    let (said, report) = lint(&folder, &["trees/points.ply"]);
    assert_eq!((said.code, files(&report, "failed").len()), (Some(1), 1), "{}", said.err);

    folder.write("trees/broken.glb", "glTF");
    let (said, report) = lint(&folder, &["missing.glb", "none", "trees"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert_eq!(files(&report, "files"), ["trees/a.obj", "trees/oaks/b.obj"]);
    assert_eq!(files(&report, "failed"), ["missing.glb", "none", "trees/broken.glb"]);
    for part in [
        "missing.glb: there is no such file or folder",
        "none: there is no model in the folder",
        "3 files could not be looked at",
    ] {
        assert!(said.err.contains(part), "{}", said.err);
    }
}

#[test]
fn exit_codes_are_for_scripts() {
    let folder = Folder::new();
    folder
        .write("a.obj", "o tree\nv 0 0 0\nv 1 0 0\nv 0 2 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 1//1 2//1\n");
    let (said, report) = lint(&folder, &["a.obj"]);
    assert_eq!(
        (said.code, report["warnings"].as_u64(), rules(&report)[0].as_str()),
        (Some(0), Some(2), "degenerate")
    );
    assert_eq!(folder.run(&["lint", "a.obj", "--deny", "warnings"]).code, Some(1));
    assert_eq!(folder.run(&["lint", "a.obj", "--set", "degenerate=error"]).code, Some(1));
    let off = ["lint", "a.obj", "--deny", "warnings", "--set", "degenerate=off", "--set", "pivot=off"];
    assert_eq!(folder.run(&off).done().code, Some(0));
    folder.write("r.toml", "profile = \"film\"\n[rules]\ndegenerate = \"error\"\n");
    assert_eq!(folder.run(&["lint", "a.obj", "--config", "r.toml"]).code, Some(1));
    folder.write("r.toml", "[rules]\ndegenrate = \"error\"\n");
    for (args, expected) in [
        (&["a.obj", "--config", "r.toml"][..], "did you mean 'degenerate'?"),
        (&["a.obj", "--config", "none.toml"], "there is no file 'none.toml'\n"),
        (&["a.obj", "--profile", "desk"], "desktop"),
        (&["a.obj", "--set", "triangles.max=many"], "no number"),
        (&[], "required"),
    ] {
        let said = folder.run(&[&["lint"], args].concat());
        assert!(said.code == Some(2) && said.err.contains(expected), "{args:?}: {}", said.err);
    }
    folder.write("broken.glb", "glTF");
    let said = folder.run(&["lint", "broken.glb", "a.obj"]);
    assert!(
        said.code == Some(1) && said.err.contains("broken.glb: reading broken.glb: glTF: it ends"),
        "{}",
        said.err
    );
    assert!(said.out.contains("a.obj: OBJ, 2 triangles"), "{}", said.out);
    let text = folder.run(&["lint", "--rules", "--profile", "mobile"]).done().out;
    assert!(text.contains("triangles.max = 10000 triangles") && text.contains("Mend: "), "{text}");
    let rows = folder.run(&["lint", "--rules", "--json"]).done().json();
    assert!(rows.as_array().unwrap().iter().any(|row| row["id"] == "uv-overlap" && row["level"] == "off"));
}

/// A stranger's file names nothing outside of its folder.
#[test]
fn what_lies_outside_is_not_read() {
    let folder = Folder::new();
    std::fs::create_dir(folder.file("models")).unwrap();
    folder.write("secret.png", "secret");
    folder.write("models/a.mtl", "newmtl bark\nmap_Kd ../secret.png\n");
    folder.write("models/a.obj", "mtllib a.mtl\no tree\nusemtl bark\nv 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    let (_, report) = lint(&folder, &["models/a.obj"]);
    let missing = report["files"][0]["findings"].as_array().unwrap().iter();
    let missing: Vec<&Value> = missing.filter(|finding| finding["rule"] == "texture-missing").collect();
    assert!(
        missing.len() == 1 && missing[0]["message"].as_str().unwrap().contains("--allow-path"),
        "{report}"
    );
}

#[test]
fn the_second_set_of_texture_coordinates_shares_no_texel() {
    let folder = Folder::new();
    let on = ["--set", "glb.lightmap_uv=true", "--set", "usda.lightmap_uv=true"];
    for (source, args) in [
        // Limbs, moss, cards of twigs; levels down to a billboard.
        ("oak", &["--triangles", "9000", "--lods", "3"][..]),
        // Balls that fruits are.
        ("apple", &["--set", "season=0.6", "--triangles", "9000"]),
        // Parts of a level that are one mesh.
        ("dressed-simple", &["--wind=bones", "--lods", "2", "--set", "points=60"]),
        ("dressed-simple", &["--instances", "--set", "points=60"]),
        ("dressed-simple", &["--scene", "--set", "points=60"]),
        // Blades in one piece, flat stems.
        ("abop-cordate", &[]),
        ("abop-a", &[]),
    ] {
        let outputs = ["-o", "a.glb", "-o", "a.usda"];
        let said = folder.run(&[&["export", source], args, &PICTURES, &outputs, &on].concat());
        assert!(said.code == Some(0) && !said.err.contains("lightmap_uv"), "{source} {args:?}: {}", said.err);
        for file in ["a.glb", "a.usda"] {
            let (_, report) = lint(&folder, &["--set", "lightmap-overlap.share=0", file]);
            let rules = rules(&report);
            assert!(!rules.contains(&"lightmap-overlap".to_owned()), "{source} {args:?} {file}: {report}");
            let unseen = report["files"][0]["unseen"].to_string();
            assert!(!unseen.contains("second set"), "{source} {args:?} {file}: {unseen}");
        }
        for name in folder.names() {
            std::fs::remove_file(folder.file(&name)).unwrap();
        }
    }
    // The rule sees them: bark that repeats is not for baked light.
    folder.run(&[&["export", "oak", "-o", "a.glb", "--triangles", "9000"][..], &PICTURES].concat()).done();
    let (_, report) = lint(&folder, &["--set", "uv-overlap=warn", "a.glb"]);
    assert!(rules(&report).contains(&"uv-overlap".to_owned()), "{report}");
}
