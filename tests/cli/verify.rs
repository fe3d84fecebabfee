//! `verify`: what linden wrote is what its recipe grows, and any change is found.

use std::fs;

use serde_json::Value;

use crate::program::{Folder, Said};

/// Pictures are as small as they can be: that they are drawn again to the byte is seen of any size.
const SMALL: [&str; 10] = [
    "--set",
    "points=60",
    "--set",
    "bark_size=64",
    "--set",
    "leaf_size=32",
    "--set",
    "card_size=128",
    "--seed",
    "7",
];

fn export(folder: &Folder, source: &str, args: &[&str]) {
    // Instances and the like say what they leave out.
    let said = folder.run(&[&["export", source], &SMALL[..], args].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
}

fn verify(folder: &Folder, args: &[&str]) -> (Said, Value) {
    let said = folder.run(&[&["verify", "--json"], args].concat());
    let report = serde_json::from_str(&said.out).unwrap_or_default();
    (said, report)
}

/// The outcome and the reason of the only file.
fn only(folder: &Folder, file: &str) -> (Option<i32>, String, String) {
    let (said, report) = verify(folder, &[file]);
    let row = &report["files"][0];
    let text = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
    (said.code, text("outcome"), text("reason"))
}

#[test]
fn every_format_and_option_is_seen_and_gives_the_same_bytes() {
    let folder = Folder::new();
    for (ending, set) in [
        ("obj", &[][..]),
        ("obj", &["obj.lines=true"]),
        ("obj", &["obj.pictures=false"]),
        ("ply", &[]),
        ("ply", &["ply.encoding=ascii"]),
        ("gltf", &[]),
        ("gltf", &["gltf.embed=true", "gltf.picture_format=webp"]),
        ("gltf", &["gltf.picture_format=jpeg"]),
        ("glb", &[]),
        ("glb", &["glb.pictures=false"]),
        ("glb", &["glb.picture_format=jpeg", "glb.instances=true"]),
        ("glb", &["glb.quantize=true", "glb.compress=meshopt", "wind=attributes"]),
        ("glb", &["glb.quantize=true", "wind=bones", "lods=2"]),
        ("glb", &["glb.lightmap_uv=true", "glb.quantize=true", "wind=bones", "lods=2"]),
        ("glb", &["glb.lightmap_uv=true", "glb.wind_as=packed", "wind=attributes"]),
        ("glb", &["glb.wind_as=pivot-painter", "glb.quantize=true", "wind=attributes", "lods=2"]),
        ("gltf", &["gltf.wind_as=pivot-painter", "wind=sway"]),
        ("usda", &["usda.lightmap_uv=true", "usda.proxy=true", "lods=2"]),
        ("usdc", &["wind=bones"]),
        ("usda", &["usda.nanite=skeletal", "wind=bones"]),
        ("usdc", &["usdc.nanite=static", "usdc.lightmap_uv=true"]),
        ("usda", &[]),
        ("usda", &["usda.pictures=false", "usda.skeleton=false", "lods=2"]),
        ("usda", &["usda.instances=true"]),
        ("usdc", &[]),
        ("usdc", &["usdc.pictures=false", "usdc.skeleton=false", "lods=2"]),
        ("usdc", &["usdc.instances=true"]),
        ("usdc", &["usdc.collision=hull", "usdc.collision_most=9"]),
        ("usda", &["usda.payload=true", "usda.proxy=true", "usda.pictures=false", "lods=2"]),
        ("usdc", &["usdc.payload=true", "usdc.collision=capsules"]),
        ("usdc", &["usdc.proxy=true", "lods=2", "usdc.lightmap_uv=true"]),
        ("usdz", &["usdz.proxy=true", "lods=2"]),
        ("usdz", &[]),
        ("usdz", &["usdz.layer=binary", "usdz.materialx=false"]),
        ("usdz", &["usdz.lightmap_uv=true"]),
        ("usdz", &["usdz.flavor=ar"]),
        ("csv", &[]),
        ("csv", &["qsm.dialect=simpleforest"]),
        ("csv", &["qsm.dialect=treeqsm"]),
        ("csv", &["qsm.dialect=raycloudtools"]),
        ("csv", &["qsm.dialect=archi"]),
        ("mtg", &[]),
        ("mtg", &["mtg.organs=false"]),
        ("organs.csv", &[]),
    ] {
        let name = format!("a.{ending}");
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        export(&folder, "dressed-simple", &[&["-o", &name], &set[..]].concat());
        let before = folder.content();
        let (said, report) = verify(&folder, &[&name, "--bytes"]);
        let row = &report["files"][0];
        assert_eq!(row["outcome"], "same-bytes", "{name} {set:?}: {row}");
        assert_eq!(
            (said.code, row["skeleton"].as_bool(), row["organs"].as_bool()),
            (Some(0), Some(true), Some(true))
        );
        assert_eq!(folder.content(), before, "nothing is written");
        for name in folder.names() {
            fs::remove_file(folder.file(&name)).unwrap();
        }
    }
}

#[test]
fn a_flavour_a_scene_and_a_name_without_ending() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "s.ply", "--format", "ply-skeleton"]);
    export(&folder, "fir", &["-o", "scene.glb", "-o", "scene.usda", "--scene"]);
    let around = ["--scene", "--sun", "52,172,9.5", "--cover", "litter,grass"];
    export(&folder, "fir", &[&["-o", "meadow.glb", "-o", "meadow.usda"], &around[..]].concat());
    export(&folder, "fir", &[&["-o", "copies.glb", "--set", "glb.instances=true"], &around[..]].concat());
    export(&folder, "fir", &["-o", "plain", "--format", "glb"]);
    folder.run(&["preview", "fir", "-o", "p.png", "--size", "40x40", "--set", "points=60"]).done();
    folder.write("recipe.json", folder.run(&["recipe", "plain"]).done().out);
    for file in ["s.ply", "scene.glb", "scene.usda", "meadow.glb", "meadow.usda", "copies.glb", "plain"] {
        assert_eq!(only(&folder, file), (Some(0), "same-bytes".to_owned(), String::new()), "{file}");
    }
    for file in ["p.png", "recipe.json"] {
        let (code, outcome, reason) = only(&folder, file);
        assert_eq!((code, outcome.as_str()), (Some(0), "same-tree"), "{file}: {reason}");
        assert_eq!(verify(&folder, &[file, "--bytes"]).0.code, Some(1));
    }
}

#[test]
fn levels_and_seasons_in_files_of_their_own() {
    let folder = Folder::new();
    let args = ["--lods", "2", "--seasons", "summer,autumn", "-o", "a.ply", "-o", "a.obj", "-o", "a.glb"];
    export(&folder, "dressed-simple", &args);
    export(
        &folder,
        "dressed-simple",
        &["--lods", "3", "--billboard", "--set", "billboard_size=64", "-o", "b.obj"],
    );
    let (said, report) = verify(&folder, &["."]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let rows = report["files"].as_array().unwrap();
    assert_eq!(rows.len(), 4 + 4 + 2 + 4, "{report}");
    for row in rows {
        let name = row["file"].as_str().unwrap();
        // Pictures of seasons have names by the other seasons.
        let expected = if name.contains("a_") && row["format"].as_str().is_none_or(|format| format == "obj") {
            "same-tree"
        } else {
            "same-bytes"
        };
        assert!(row["outcome"] == expected || row["outcome"] == "same-bytes", "{row}");
    }
}

/// Ages and seasons with names of the user's share pictures with others that are not known any more.
#[test]
fn one_of_several_ages_or_seasons_is_never_called_changed() {
    let folder = Folder::new();
    for format in ["glb", "gltf", "obj", "usda"] {
        let name = format!("p.{format}");
        export(&folder, "dressed-simple", &["--ages", "young=0.5,old=1", "-o", &name]);
    }
    let seasons = ["--seasons", "spring=0.05,late=0.9", "-o", "s.obj"];
    export(&folder, "dressed-simple", &seasons);
    let (said, report) = verify(&folder, &["."]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let outcome = |name: &str| {
        let rows = report["files"].as_array().unwrap();
        rows.iter()
            .find(|row| row["file"] == format!("./{name}"))
            .unwrap_or_else(|| panic!("{name}: {report}"))["outcome"]
            .clone()
    };
    for file in ["p_young.glb", "p_old.glb"] {
        assert_eq!(outcome(file), "same-bytes", "{file} has its pictures within");
    }
    for file in ["p_young.obj", "p_old.gltf", "p_young.usda", "s_spring.obj", "s_late.obj"] {
        assert!(["same-tree", "same-bytes"].map(Value::from).contains(&outcome(file)), "{file}: {report}");
    }
    // One alone is compared, and one beside another tree that is named alike.
    let other = Folder::new();
    export(&other, "fir", &["-o", "fir_1.obj"]);
    other.write("fir_1.obj", [&other.read("fir_1.obj")[..], b"#"].concat());
    assert_eq!(only(&other, "fir_1.obj").1, "other-bytes");
    other.run(&["export", "fir", "--seed", "2", "--set", "points=60", "-o", "fir_2.obj"]).done();
    assert_eq!(only(&other, "fir_1.obj").1, "other-bytes");
}

/// A budget is met where there are most leaves, and bare twigs have what it left of the wood.
#[test]
fn seasons_within_a_budget_are_verified_together() {
    let folder = Folder::new();
    let args = ["--triangles", "600", "--seasons", "summer,bare", "-o", "s.glb"];
    export(&folder, "dressed-simple", &args);
    let alone = ["--triangles", "600", "--set", "season=bare", "-o", "alone.glb"];
    export(&folder, "dressed-simple", &alone);
    let bare = folder.read("s_bare.glb");
    assert_ne!(folder.read("alone.glb"), bare, "they would be the same anyhow");
    for file in ["s_bare.glb", "s_summer.glb", "alone.glb"] {
        assert_eq!(only(&folder, file), (Some(0), "same-bytes".to_owned(), String::new()), "{file}");
    }
    // Each that is changed, as long as the other is not.
    for file in ["s_bare.glb", "s_summer.glb"] {
        let kept = folder.read(file);
        let mut bytes = kept.clone();
        let at = bytes.len() - 10;
        bytes[at] ^= 1;
        folder.write(file, &bytes);
        let (code, outcome, reason) = only(&folder, file);
        assert_eq!((code, outcome.as_str()), (Some(1), "other-bytes"), "{file}: {reason}");
        assert!(reason.contains(&format!("{file} differs from byte {at} on")), "{reason}");
        folder.write(file, &kept);
    }
    // Alone, too: seasons with a name need not lie beside it.
    fs::remove_file(folder.file("s_summer.glb")).unwrap();
    let whole = folder.read("s_bare.glb");
    assert_eq!(only(&folder, "s_bare.glb"), (Some(0), "same-bytes".to_owned(), String::new()));
    for damaged in [[&whole[..whole.len() - 10], &[0; 10]].concat(), whole[..whole.len() - 100].to_vec()] {
        folder.write("s_bare.glb", &damaged);
        let (code, outcome, reason) = only(&folder, "s_bare.glb");
        assert!(code == Some(1) && outcome != "same-tree", "{outcome}: {reason}");
    }
}

/// Of seasons with as many leaves the budget is met in the one that was asked for first.
#[test]
fn seasons_with_as_many_leaves_are_verified_in_any_order() {
    for list in ["flush,summer,autumn,bare", "bare,autumn,summer,flush"] {
        let folder = Folder::new();
        let args = ["--triangles", "600", "--lods", "2", "--seasons", list, "-o", "s.glb"];
        export(&folder, "dressed-simple", &args);
        let (said, report) = verify(&folder, &[".", "--bytes"]);
        assert_eq!((said.code, report["good"].as_u64()), (Some(0), Some(4)), "{list}: {}", said.out);
    }
}

/// `half_grown` has an underscore of its own.
#[test]
fn ages_of_several_words_are_verified() {
    let folder = Folder::new();
    for name in ["d.usda", "e.obj"] {
        export(&folder, "dressed-simple", &["--ages", "young=0.4,half_grown=0.7,grown=1", "-o", name]);
    }
    let (said, report) = verify(&folder, &["."]);
    assert_eq!((said.code, report["bad"].as_u64()), (Some(0), Some(0)), "{}", said.out);
    assert_eq!(report["good"], 7, "{report}");
}

/// Without its end a file says no recipe any more.
#[test]
fn models_in_folders_that_are_cut_off_fail() {
    let folder = Folder::new();
    let endings = ["glb", "gltf", "usda", "usdc", "usdz", "ply"];
    for ending in endings {
        export(&folder, "fir", &["-o", &format!("a.{ending}")]);
    }
    assert_eq!(verify(&folder, &["."]).0.code, Some(0));
    for ending in endings {
        folder.write(&format!("cut.{ending}"), &folder.read(&format!("a.{ending}"))[..300]);
    }
    folder.write("empty.obj", "");
    let foreign = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("foreign.obj", foreign);
    let (said, report) = verify(&folder, &["."]);
    let failed: Vec<&str> = report["files"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|row| row["outcome"] == "failed")
        .map(|row| row["file"].as_str().unwrap())
        .collect();
    let expected =
        ["./cut.glb", "./cut.gltf", "./cut.ply", "./cut.usda", "./cut.usdc", "./cut.usdz", "./empty.obj"];
    assert_eq!((said.code, failed), (Some(1), expected.to_vec()), "{}", said.out);
    assert_eq!(report["bad"], 7);
    assert_eq!(report["without_recipe"], serde_json::json!(["./foreign.obj"]), "{report}");
    // What anyone may have put there is named, and is no failure.
    for name in expected {
        fs::remove_file(folder.file(name)).unwrap();
    }
    let text = folder.run(&["verify", "."]);
    assert!(text.code == Some(0) && text.out.contains("no recipe   ./foreign.obj"), "{}", text.out);
}

#[test]
fn models_of_others_that_cannot_be_read_are_named_and_are_no_failure() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "a.glb"]);
    folder.write("next.glb", [&b"glTF"[..], &3_u32.to_le_bytes(), &28_u32.to_le_bytes(), &[0; 16]].concat());
    let elsewhere = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"gone.bin","byteLength":4}]}"#;
    folder.write("elsewhere.gltf", elsewhere);
    let (said, report) = verify(&folder, &["."]);
    assert_eq!(said.code, Some(0), "{}", said.out);
    assert_eq!(report["without_recipe"], serde_json::json!(["./elsewhere.gltf", "./next.glb"]));
    // So are those that there is no memory for.
    let sparse = fs::File::create(folder.file("large.ply")).unwrap();
    sparse.set_len(3 << 30).unwrap();
    let (said, report) = verify(&folder, &[".", "--memory=1G"]);
    assert_eq!((said.code, report["without_recipe"].as_array().unwrap().len()), (Some(0), 3), "{}", said.out);
}

/// No other version, and no other program, writes these.
#[test]
fn broken_models_are_no_models_of_others() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "a.glb", "-o", "a.usdz"]);
    let mut cut = folder.read("a.glb")[..2000].to_vec();
    cut[4..8].fill(0xff);
    folder.write("cut.glb", cut);
    let mut old = folder.read("a.glb");
    old[4..8].copy_from_slice(&1_u32.to_le_bytes());
    folder.write("old.glb", old);
    for (name, uri) in [("base", "data:application/octet-stream;base64,%%%"), ("way", "data:,AAAA")] {
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"{uri}","byteLength":4}}]}}"#);
        folder.write(&format!("{name}.gltf"), text);
    }
    // Its first file is called deflated (8).
    let mut packed = folder.read("a.usdz");
    packed[8..10].copy_from_slice(&8_u16.to_le_bytes());
    folder.write("packed.usdz", packed);
    for name in ["a.glb", "a.usdz"] {
        fs::remove_file(folder.file(name)).unwrap();
    }
    let (said, report) = verify(&folder, &["."]);
    let of = |row: &serde_json::Value| (row["file"].clone(), row["outcome"].clone());
    let found: Vec<_> = report["files"].as_array().unwrap().iter().map(of).collect();
    let expected = ["./base.gltf", "./cut.glb", "./old.glb", "./packed.usdz", "./way.gltf"];
    let failed = expected.map(|name| (name.into(), "failed".into()));
    assert_eq!(
        (said.code, found, &report["without_recipe"]),
        (Some(1), failed.to_vec(), &serde_json::json!([]))
    );
}

#[test]
fn a_payload_belongs_to_the_layer_beside_it() {
    let folder = Folder::new();
    let args = ["--set", "usda.payload=true", "--seasons", "summer,bare", "-o", "p.usda"];
    export(&folder, "dressed-simple", &args);
    assert!(folder.file("p_payload.usda").exists(), "{:?}", folder.names());
    let (said, report) = verify(&folder, &["."]);
    assert_eq!((said.code, &report["without_recipe"]), (Some(0), &serde_json::json!([])), "{}", said.out);
    // By itself it is anyone's.
    fs::rename(folder.file("p_payload.usda"), folder.file("q_payload.usda")).unwrap();
    let (_, report) = verify(&folder, &["."]);
    assert_eq!(report["without_recipe"], serde_json::json!(["./q_payload.usda"]));
}

/// A switch that changes nothing in a file may have been on or off.
#[test]
fn options_that_do_not_show_are_not_said() {
    let folder = Folder::new();
    let leafy = ["dressed-simple", "fir"];
    for (at, source) in leafy.into_iter().enumerate() {
        for value in ["true", "false"] {
            let (glb, usd) = (format!("{at}{value}.glb"), format!("{at}{value}.usda"));
            let set = [format!("glb.translucency={value}"), format!("usda.materialx={value}")];
            export(&folder, source, &["-o", &glb, "-o", &usd, "--set", &set[0], "--set", &set[1]]);
            for (file, option) in [(&glb, "translucency"), (&usd, "materialx")] {
                let (_, report) = verify(&folder, &[file, "--bytes"]);
                let row = &report["files"][0];
                let expected = if source == "fir" { Value::Null } else { value.into() };
                assert_eq!(
                    (&row["outcome"], &row["options"][option]),
                    (&"same-bytes".into(), &expected),
                    "{file}"
                );
            }
        }
    }
}

#[test]
fn what_is_not_there_is_a_row_beside_the_others() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "a.gltf"]);
    let (said, report) = verify(&folder, &["missing.glb", "a.gltf"]);
    let rows = report["files"].as_array().unwrap();
    let outcomes: Vec<_> = rows.iter().map(|row| [&row["file"], &row["outcome"]]).collect();
    assert_eq!(outcomes, [["a.gltf", "same-bytes"], ["missing.glb", "missing"]]);
    assert_eq!(said.code, Some(1));
    let (said, report) = verify(&folder, &["missing.glb"]);
    assert_eq!((said.code, report["bad"].as_u64()), (Some(2), Some(1)), "{}", said.err);
    // The file itself is the same: what is beside it is missed.
    let picture = folder.names().into_iter().find(|name| name.ends_with("bark.png")).unwrap();
    fs::remove_file(folder.file(&picture)).unwrap();
    let (code, outcome, reason) = only(&folder, "a.gltf");
    assert_eq!((code, outcome.as_str()), (Some(1), "other-bytes"));
    assert_eq!(reason, format!("{picture}, which belongs to it, is not there"));
}

#[test]
fn what_was_changed_is_found() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "a.obj", "-o", "a.glb", "-o", "a.ply"]);
    assert_eq!(verify(&folder, &["a.obj", "a.glb", "a.ply"]).0.code, Some(0));
    // A bit near the end, and the end itself.
    let mut bytes = folder.read("a.glb");
    let at = bytes.len() - 10;
    bytes[at] ^= 1;
    folder.write("a.glb", &bytes);
    let (code, outcome, reason) = only(&folder, "a.glb");
    assert_eq!((code, outcome.as_str()), (Some(1), "other-bytes"));
    assert!(reason.contains(&format!("a.glb differs from byte {at} on")), "{reason}");
    bytes = folder.read("a.ply");
    bytes.pop();
    folder.write("a.ply", &bytes);
    let (_, outcome, reason) = only(&folder, "a.ply");
    assert!(outcome == "other-bytes" && reason.contains(&format!("{} bytes", bytes.len())), "{reason}");
    // A file beside it.
    let picture = folder.names().into_iter().find(|name| name.ends_with("bark.png")).unwrap();
    let kept = folder.read(&picture);
    fs::remove_file(folder.file(&picture)).unwrap();
    let (_, outcome, reason) = only(&folder, "a.obj");
    assert!(outcome == "other-bytes" && reason.contains(&picture), "{reason}");
    folder.write(&picture, [&kept[..], b" "].concat());
    assert_eq!(only(&folder, "a.obj").1, "other-bytes");
    folder.write(&picture, &kept);
    assert_eq!(only(&folder, "a.obj").1, "same-bytes");
}

#[test]
fn other_trees_versions_and_recipes() {
    let folder = Folder::new();
    export(&folder, "fir", &["-o", "a.obj", "--set", "obj.pictures=false"]);
    let text = String::from_utf8(folder.read("a.obj")).unwrap();
    let line: Value = folder.run(&["recipe", "a.obj"]).done().json();
    let (version, skeleton) = (line["linden"].as_str().unwrap(), line["hash"]["skeleton"].as_str().unwrap());
    let tampered = format!("{:032x}", u128::from_str_radix(skeleton, 16).unwrap() ^ 1);
    folder.write("a.obj", text.replace(skeleton, &tampered));
    let (code, outcome, reason) = only(&folder, "a.obj");
    assert_eq!((code, outcome.as_str(), reason.as_str()), (Some(1), "other-tree", "its skeleton differs"));
    let older = text.replace(&format!("\"linden\":\"{version}\""), "\"linden\":\"0.0.9\"");
    folder.write("a.obj", &older);
    let (code, outcome, reason) = only(&folder, "a.obj");
    assert_eq!((code, outcome.as_str()), (Some(0), "same-tree"));
    assert!(reason.starts_with("made by linden 0.0.9"), "{reason}");
    folder.write("a.obj", older.replace(skeleton, &tampered));
    let (_, outcome, reason) = only(&folder, "a.obj");
    assert!(outcome == "other-tree" && reason.contains("0.0.9"), "{reason}");
    folder.write("a.obj", text.replace("\"points\":60", "\"points\":61"));
    let (code, outcome, reason) = only(&folder, "a.obj");
    assert_eq!((code, outcome.as_str()), (Some(1), "unchecked"), "{reason}");
    folder.write("a.obj", "v 0 0 0\n");
    assert_eq!(only(&folder, "a.obj").1, "unchecked");
    assert_eq!(verify(&folder, &["nothing.glb"]).0.code, Some(2));
}

/// The file that a recipe names is part of what decides.
#[test]
fn an_input_that_was_changed_is_named() {
    let folder = Folder::new();
    folder.write("leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("p.toml", "id = \"p\"\n[lsystem]\naxiom = \"FF[+F]F\"\nrules = []\n[foliage]\nleaf_form = \"mesh\"\nleaf_mesh = \"leaf.obj\"\n");
    folder.run(&["export", "p.toml", "-o", "p.glb", "--set", "bark_size=16"]);
    assert_eq!(only(&folder, "p.glb").1, "same-bytes");
    folder.write("leaf.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
    let (code, outcome, reason) = only(&folder, "p.glb");
    assert_ne!(outcome, "same-bytes");
    assert!(code == Some(1) && reason.contains("leaf.obj is not the file"), "{outcome} {reason}");
    fs::remove_file(folder.file("leaf.obj")).unwrap();
    assert_eq!(only(&folder, "p.glb").1, "failed");
}

#[test]
fn a_batch_is_verified_and_what_is_missing_in_it_is_said() {
    let folder = Folder::new();
    folder.write(
        "m.toml",
        "formats = [\"glb\", \"obj\"]\noptions = { \"glb.quantize\" = true }\n[[trees]]\nsource = \"fir\"\nseeds = \"1..6\"\nset = { points = 60, bark_size = 16 }\n",
    );
    folder.run(&["batch", "m.toml", "--out", "out"]).done();
    let (said, report) = verify(&folder, &["out", "--bytes", "--jobs", "2"]);
    assert_eq!((said.code, report["good"].as_u64()), (Some(0), Some(12)), "{}{}", said.out, said.err);
    let one = verify(&folder, &["out", "--bytes", "--jobs", "1"]).1;
    assert_eq!(one, report, "in any order of work");
    folder.run(&["batch", "m.toml", "--out", "out", "--merge"]).done();
    let rows = report["files"].as_array().unwrap();
    let glb = rows.iter().find(|row| row["format"] == "glb").unwrap();
    let file = &glb["file"].as_str().unwrap().to_owned();
    fs::remove_file(folder.file(file)).unwrap();
    let (said, report) = verify(&folder, &["out"]);
    let bad: Vec<&Value> =
        report["files"].as_array().unwrap().iter().filter(|row| row["outcome"] != "same-bytes").collect();
    assert_eq!((said.code, bad.len(), bad[0]["outcome"].as_str()), (Some(1), 1, Some("missing")), "{report}");
    assert!(bad[0]["file"] == *file);
    let text = folder.run(&["verify", "out"]);
    assert!(
        text.out.contains("11 same bytes, 1 missing") && text.err.contains("1 of 12 files"),
        "{}",
        text.out
    );
    // Of another version trees are compared and no bytes: which pictures are whose is not known then.
    let older = Folder::new();
    older.write(
        "m.toml",
        "formats = [\"obj\"]\n[[trees]]\nsource = \"fir\"\nset = { points = 60, bark_size = 16 }\n",
    );
    older.run(&["batch", "m.toml", "--out", "out"]).done();
    let obj = verify(&older, &["out"]).1["files"][0]["file"].as_str().unwrap().to_owned();
    let text = String::from_utf8(older.read(&obj)).unwrap();
    let (_, version) = text.split_once("\"linden\":\"").unwrap();
    let (version, _) = version.split_once('"').unwrap();
    let same_length = format!("{:9<1$}", "0.0.", version.len());
    older.write(&obj, text.replace(version, &same_length));
    let (said, report) = verify(&older, &["out"]);
    let outcomes: Vec<&str> =
        report["files"].as_array().unwrap().iter().map(|row| row["outcome"].as_str().unwrap()).collect();
    assert_eq!((said.code, outcomes), (Some(0), vec!["same-tree"]), "{report}");
    assert_eq!(verify(&older, &["out", "--bytes"]).0.code, Some(1));
    // Cut off: no recipe is found in it any more, and the index knows it.
    folder.write(file, "");
    assert_eq!(verify(&folder, &["out"]).1["bad"], 1);
}
