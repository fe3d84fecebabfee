//! `--json` of what writes several trees: one document, which says what lies on the disk.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use xxhash_rust::xxh3::xxh3_128;

use crate::program::{Folder, Said};

/// Bare wood, drawn small.
const SMALL: [&str; 3] = ["--set=bark_size=16", "--set=leaf_form=none", "--triangles=600"];

/// Two small trees that stand apart.
fn folder() -> Folder {
    let folder = Folder::new();
    for (id, x) in [("left", 0), ("right", 9)] {
        let preset = format!(
            "id = \"{id}\"\n[colonization]\ncrown = \"cone\"\npoints = 60\nroot = [{x}, 0, 0]\n\
             [age.young]\nage = 0.6\n[age.grown]\n"
        );
        folder.write(&format!("{id}.toml"), preset);
    }
    folder
}

/// The files that a document lists, by their paths: each is there and as long as it says, and nothing else was written.
fn listed(folder: &Folder, said: &Said, before: &BTreeSet<String>) -> BTreeMap<String, Value> {
    let files = said.json()["files"].as_array().unwrap().clone();
    let listed: BTreeMap<String, Value> =
        files.into_iter().map(|file| (file["path"].as_str().unwrap().to_owned(), file)).collect();
    for (path, file) in &listed {
        assert_eq!(file["bytes"].as_u64(), Some(folder.read(path).len() as u64), "{path}");
        assert_eq!(file["kept"], false, "{path}");
    }
    let written: BTreeSet<String> =
        folder.names().into_iter().filter(|name| !before.contains(name)).collect();
    let folders = listed.keys().map(|path| path.split('/').next().unwrap_or_default().to_owned());
    assert_eq!(folders.collect::<BTreeSet<_>>(), written);
    listed
}

/// Runs a command whose document must be all that is on standard output.
fn told(folder: &Folder, args: &[&str]) -> (Said, BTreeMap<String, Value>) {
    let before = folder.names().into_iter().collect();
    let said = folder.run(args);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let listed = listed(folder, &said, &before);
    let document = said.json();
    for key in
        ["linden", "source", "sources", "threads", "seconds", "cpu_seconds", "peak_memory_bytes", "cache"]
    {
        assert!(document.get(key).is_some(), "{key} in {document}");
    }
    (said, listed)
}

#[test]
fn several_sources_are_one_document() {
    let folder = folder();
    let line =
        ["export", "left.toml", "right.toml", "-o", "both.obj", "-o", "both.glb", "--json", "--lods=2"];
    let (said, files) = told(&folder, &[&line[..], &SMALL].concat());
    let document = said.json();
    assert_eq!(document["source"], "left.toml right.toml");
    assert_eq!(document["sources"], serde_json::json!(["left.toml", "right.toml"]));
    assert_eq!((&document["places"], &document["distinct"]), (&2.into(), &2.into()));
    assert!(files.contains_key("both.glb") && files.contains_key("both_LOD1.obj"), "{files:?}");
    assert_eq!(document["triangles"].as_array().unwrap().len(), 2);
    let steps = document["steps"].as_array().unwrap();
    let sum: f64 = steps.iter().map(|step| step["seconds"].as_f64().unwrap()).sum();
    assert!((sum - document["seconds"].as_f64().unwrap()).abs() < 1e-6);
    let table = folder.run(&[&line[..7], &["--timings"], &SMALL].concat());
    assert!(
        table.code == Some(0) && table.err.contains("step") && table.out.contains("both.glb"),
        "{table:?}"
    );
}

#[test]
fn ages_are_one_document() {
    let folder = folder();
    let line = [
        "export",
        "left.toml",
        "--ages",
        "-o",
        "a.usda",
        "--json",
        "--set=bark_size=16",
        "--set=leaf_form=none",
    ];
    let (said, files) = told(&folder, &line);
    let document = said.json();
    for name in ["a.usda", "a_young.usda", "a_grown.usda"] {
        assert!(files.contains_key(name), "{name} in {files:?}");
    }
    let ages = document["ages"].as_array().unwrap();
    assert_eq!(ages.iter().map(|age| age["age"].clone()).collect::<Vec<_>>(), ["young", "grown"]);
    assert!(ages[0]["triangles"][0].as_u64() < ages[1]["triangles"][0].as_u64(), "{document}");
    assert_eq!(document["triangles"], ages[1]["triangles"]);
    let grown = document["steps"].as_array().unwrap().iter().filter(|step| step["step"] == "grow");
    assert_eq!(grown.map(|step| step["age"].clone()).collect::<Vec<_>>(), ["young", "grown"]);
}

#[test]
fn a_forest_is_one_document() {
    let folder = folder();
    let line =
        ["forest", "left.toml:2", "right.toml", "--area=20", "-o", "w.gltf", "--table=w.csv", "--json"];
    let (said, files) = told(&folder, &[&line[..], &["--set=bark_size=16", "--set=leaf_form=none"]].concat());
    let document = said.json();
    assert_eq!(document["sources"], serde_json::json!(["left.toml:2", "right.toml"]));
    let rows = String::from_utf8(folder.read("w.csv")).unwrap().lines().count() - 1;
    assert_eq!(document["places"].as_u64(), Some(rows as u64));
    assert!(files.contains_key("w.gltf") && files.contains_key("w.csv"), "{files:?}");
    let stream = folder.run(&["forest", "left.toml", "-o", "-", "--format", "glb", "--json", "--area=20"]);
    assert!(stream.code == Some(2) && stream.err.contains("--json"), "{}", stream.err);
}

const MANIFEST: &str = "formats = [\"gltf\"]\n[[trees]]\nsource = \"left.toml\"\nages = [\"young\", 0.8, \"grown\"]\n\
                        seeds = \"1..2\"\nset = { bark_size = 16, leaf_form = \"none\" }\n";

#[test]
fn a_batch_is_one_document() {
    let folder = folder();
    folder.write("m.toml", MANIFEST);
    let forecast = folder.run(&["batch", "m.toml", "--dry-run", "--json"]).done().json();
    assert_eq!((&forecast["forecast"]["trees"], &forecast["files"]), (&6.into(), &serde_json::json!([])));
    assert!(forecast["forecast"]["bytes"].as_u64() > Some(0), "{forecast}");

    let (said, files) = told(&folder, &["batch", "m.toml", "--json"]);
    let document = said.json();
    assert_eq!(
        (&document["source"], &document["sources"]),
        (&"m.toml".into(), &serde_json::json!(["left.toml"]))
    );
    assert_eq!((&document["failed"], &document["there"]), (&0.into(), &0.into()));
    let trees = document["trees"].as_array().unwrap();
    assert_eq!(
        trees.iter().map(|tree| tree["index"].as_u64().unwrap()).collect::<Vec<_>>(),
        [0, 1, 2, 3, 4, 5]
    );
    assert_eq!(trees[4]["age"], "0.8");
    // Each tree is that of its age and seed, by its hash and by its file.
    for (tree, age) in trees.iter().zip(["young", "0.8", "grown"].into_iter().cycle()) {
        let (seed, path) =
            (tree["seed"].to_string(), format!("out/{}", tree["files"][0]["path"].as_str().unwrap()));
        let args = ["stats", "left.toml", "--age", age, "--seed", &seed, "--set=leaf_form=none", "--json"];
        assert_eq!(tree["skeleton_hash"], folder.run(&args).done().json()["skeleton_hash"], "{tree}");
        assert_eq!(
            tree["skeleton_hash"],
            folder.run(&["stats", &path, "--json"]).done().json()["skeleton_hash"]
        );
        assert!(files.contains_key(&path), "{path} in {files:?}");
    }
    // Pictures are listed once, and are what their names say.
    let pictures: Vec<&String> = files.keys().filter(|path| path.starts_with("out/pictures/")).collect();
    assert!(!pictures.is_empty());
    for path in pictures {
        assert_eq!(*path, format!("out/pictures/{:032x}.png", xxh3_128(&folder.read(path))));
    }

    // What is there is left out, and what a merge made is listed.
    let again = folder.run(&["batch", "m.toml", "--resume", "--json"]);
    let document = again.json();
    assert_eq!(
        (again.code, &document["there"], &document["trees"]),
        (Some(0), &6.into(), &serde_json::json!([]))
    );
    let merged = folder.run(&["batch", "m.toml", "--merge", "--tiles=tiles.json", "--json"]).done().json();
    assert_eq!((&merged["whole"], &merged["missing"]), (&6.into(), &serde_json::json!([])));
    let files = merged["files"].as_array().unwrap();
    assert_eq!(
        files.iter().map(|file| file["path"].clone()).collect::<Vec<_>>(),
        ["out/index.jsonl", "tiles.json"]
    );
    for file in files {
        assert_eq!(file["bytes"].as_u64(), Some(folder.read(file["path"].as_str().unwrap()).len() as u64));
    }
}

#[test]
fn a_batch_that_fails_in_part_is_a_document_all_the_same() {
    let folder = folder();
    folder.write("m.toml", MANIFEST.replace("bark_size = 16", "kill = [\"1D\", \"0.1D\"], bark_size = 16"));
    let said = folder.run(&["batch", "m.toml", "--json"]);
    let document = said.json();
    assert_eq!((said.code, &document["failed"]), (Some(1), &6.into()), "{}", said.err);
    let trees = document["trees"].as_array().unwrap();
    assert_eq!(trees.len(), 12);
    assert_eq!(trees.iter().filter(|tree| tree["error"].is_string()).count(), 6);
    // Only what was written is listed.
    for file in document["files"].as_array().unwrap() {
        assert_eq!(file["bytes"].as_u64(), Some(folder.read(file["path"].as_str().unwrap()).len() as u64));
    }
}

#[test]
fn files_that_are_left_alone_are_named() {
    let folder = folder();
    let line = [&["export", "left.toml", "--if-changed", "-o", "a.obj", "-o", "a.ply"], &SMALL[..]].concat();
    folder.run(&line).done();
    let second = folder.run(&line);
    let said = "note: a.obj, ";
    assert!(second.err.contains(said) && second.err.contains("were left alone; 0 of"), "{}", second.err);
    std::fs::remove_file(folder.file("a.ply")).unwrap();
    let third = folder.run(&[&line[..], &["--json"]].concat()).done().json();
    let kept = |path: &str| {
        third["files"].as_array().unwrap().iter().find(|f| f["path"] == path).unwrap()["kept"].clone()
    };
    assert_eq!([kept("a.obj"), kept("a.mtl"), kept("a.ply")], [true, true, false]);
    std::fs::remove_file(folder.file("a.ply")).unwrap();
    let told = folder.run(&line).err;
    assert!(told.contains("a.obj") && told.contains("; 1 of"), "{told}");
}

#[test]
fn sources_stand_behind_options_without_a_value() {
    let folder = folder();
    // An age may be called like a file: where a source is missing, it is the source.
    std::fs::rename(folder.file("left.toml"), folder.file("young")).unwrap();
    for line in [
        &["export", "--ages", "right.toml", "-o", "a.obj"][..],
        &["export", "--wind", "right.toml", "-o", "b.glb"],
        &["export", "--billboard", "right.toml", "-o", "c.glb", "--set=billboard_size=64"],
        &["export", "--seasons", "right.toml", "-o", "d.glb"],
        &["export", "--ages", "young", "-o", "e.obj"],
        &["stats", "--ages", "right.toml"],
        &["sheet", "--ages", "right.toml", "-o", "f.png", "--size=40x48"],
    ] {
        let said =
            folder.run(&[line, if line[0] == "export" { &["--set=bark_size=16"] } else { &[] }].concat());
        assert_eq!(said.code, Some(0), "{line:?}: {}", said.err);
    }
    for name in ["a_young.obj", "a_grown.obj", "b.glb", "c.glb", "d.glb", "e_young.obj", "f.png"] {
        assert!(folder.file(name).exists(), "{name} in {:?}", folder.names());
    }
    // The old way: a list behind the option and the source before it.
    let old = ["export", "right.toml", "--ages", "young", "-o", "g.obj", "--set=bark_size=16"];
    assert_eq!(folder.run(&old).code, Some(0));
    assert!(folder.file("g_young.obj").exists() && !folder.file("g_grown.obj").exists());
    let wrong = folder.run(&["export", "--ages", "rihgt", "-o", "h.obj"]);
    assert_eq!(wrong.code, Some(2));
    assert!(
        wrong.err.contains("'rihgt' is taken for the value of --ages; write the source before --ages\n"),
        "{}",
        wrong.err
    );
    // No file that is a source becomes one that is written.
    let right = folder.read("right.toml");
    let lost = folder.run(&["export", "abop-a", "-o", "--wind", "right.toml", "--format=glb"]);
    assert!(lost.code == Some(2) && lost.err.contains("a value is required for '--output"), "{}", lost.err);
    assert_eq!(folder.read("right.toml"), right);
    let other = folder.run(&["sheet", "right.toml", "--ages", "young"]);
    assert!(other.code == Some(2) && !other.err.contains("is taken for"), "{}", other.err);
}
