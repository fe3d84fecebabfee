//! Kinds of foliage by name on the command line.

use crate::program::Folder;

const SMALL: [&str; 8] =
    ["--set", "points=300", "--set", "leaf_size=32", "--set", "bark_size=32", "--set", "also.1.leaf_count=1"];

fn export(folder: &Folder, file: &str, more: &[&str]) -> Vec<u8> {
    let said = folder.run(&[&["export", "drawn-apple", "-o", file], &SMALL[..], more].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    folder.read(file)
}

#[test]
fn a_kind_is_turned_by_its_label_and_by_its_number() {
    let folder = Folder::new();
    let plain = export(&folder, "a.glb", &[]);
    let label = export(&folder, "b.glb", &["--set", "blossom.leaf_keep=0", "--set", "glb.instances=false"]);
    let number = export(&folder, "c.glb", &["--set", "also.1.leaf_keep=0"]);
    assert_eq!(label, number);
    assert!(number.len() < plain.len(), "{} of {}: no blossom is left", number.len(), plain.len());
    let recipe = folder.run(&["recipe", "b.glb"]);
    let recipe: serde_json::Value = serde_json::from_str(&recipe.out).unwrap();
    assert_eq!(recipe["foliage"]["also"][0]["leaf_keep"], 0.0);
    assert_eq!(recipe["foliage"]["leaf_keep"], 1.0);
}

#[test]
fn show_lists_kinds_with_their_knobs() {
    let folder = Folder::new();
    let page = folder.run(&["show", "apple", "--set", "blossom.leaf_keep=0.25"]).out;
    let (_, kind) = page.split_once("foliage.also 1, 'blossom'").expect(&page);
    let row = kind.lines().find(|line| line.trim_start().starts_with("leaf_keep ")).expect(kind);
    assert!(row.split_whitespace().nth(1) == Some("0.25"), "{row}");
    let json = folder.run(&["show", "apple", "--json"]).out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let kinds = [("also.1", "blossom"), ("also.2", "fruit")];
    let kinds = kinds.map(|(address, label)| serde_json::json!({ "address": address, "label": label }));
    assert_eq!(json["kinds"], serde_json::json!(kinds));
    let names: Vec<&str> =
        json["knobs"].as_array().unwrap().iter().map(|k| k["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"also.1.leaf_keep"));
    // Each of them is a name that --set takes.
    let knob = json["knobs"].as_array().unwrap().iter().find(|k| k["name"] == "also.1.leaf_colors").unwrap();
    let set = format!("also.1.leaf_colors={}", knob["value"].as_str().unwrap());
    assert_eq!(folder.run(&["show", "apple", "--set", &set]).code, Some(0));
}

#[test]
fn what_is_no_kind_is_said_and_nothing_is_written() {
    let folder = Folder::new();
    for (set, said) in [
        ("blosom.leaf_keep=0", "did you mean 'blossom'?"),
        ("also.3.leaf_keep=0", "'apple' has: blossom (also.1), fruit (also.2)"),
        ("also.1.leaf_kep=0", "did you mean 'leaf_keep'?"),
        ("glbb.instances=false", "glbb"),
    ] {
        let run = folder.run(&["export", "apple", "-o", "x.glb", "--set", set]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        assert!(run.err.contains(said), "{set}: {}", run.err);
        assert!(!folder.file("x.glb").exists());
    }
    let note =
        folder.run(&["stats", "drawn-apple", "--set", "points=100", "--set", "blossom.twig_leaves=3"]).err;
    assert!(note.contains("blossom.twig_leaves changes nothing: it is for leaf_form=twig"), "{note}");
}
