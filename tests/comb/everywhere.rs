//! A generator of one crate and one line is everywhere: lists, pages, schema, completion, documents, exports.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn linden(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_linden-with-comb"))
        .args(arguments)
        .current_dir(folder)
        .env("XDG_CONFIG_HOME", folder)
        .output()
        .unwrap()
}

fn said(folder: &Path, arguments: &[&str]) -> String {
    let output = linden(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

const DOCUMENT: &str =
    "id = \"comb\"\nsummary = \"a comb\"\n\n[comb]\ncomb_prongs = 5 # once called so\ncomb_depth = 1\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("linden/presets")).unwrap();
    fs::write(folder.path().join("linden/presets/comb.toml"), DOCUMENT).unwrap();
    fs::write(folder.path().join("comb.toml"), DOCUMENT).unwrap();
    folder
}

#[test]
fn lists_and_pages_have_it() {
    let folder = folder();
    let folder = folder.path();
    let listed: serde_json::Value = serde_json::from_str(&said(folder, &["list", "--json"])).unwrap();
    let rows = listed["presets"].as_array().or(listed.as_array()).unwrap();
    let row = rows.iter().find(|row| row["id"] == "comb").unwrap();
    assert_eq!(row["generator"], "comb");
    let page = said(folder, &["show", "comb.toml"]);
    assert!(page.contains("comb_teeth") && page.contains("teeth of a stem"), "{page}");
    let shown: serde_json::Value =
        serde_json::from_str(&said(folder, &["show", "comb.toml", "--json"])).unwrap();
    assert_eq!(shown["generator"], "comb");
    assert!(said(folder, &["man"]).contains("comb_ratio"));
    let schema: serde_json::Value = serde_json::from_str(&said(folder, &["schema"])).unwrap();
    assert_eq!(schema["properties"]["comb"]["properties"]["comb_depth"]["maximum"], 8);
    assert!(schema["oneOf"].to_string().contains("comb"));
}

#[test]
fn it_grows_is_written_and_grows_again_from_what_was_written() {
    let folder = folder();
    let folder = folder.path();
    let measured: serde_json::Value =
        serde_json::from_str(&said(folder, &["stats", "comb.toml", "--json"])).unwrap();
    // 5 segments of the stem, and a comb of 5 on each.
    assert_eq!((&measured["generator"], &measured["segments"]), (&"comb".into(), &30.into()));
    said(folder, &["export", "comb.toml", "--set", "comb_teeth=3", "-o", "comb.glb"]);
    let again: serde_json::Value =
        serde_json::from_str(&said(folder, &["stats", "comb.glb", "--json"])).unwrap();
    assert_eq!(again["segments"], 12);
}

#[test]
fn shells_complete_its_knobs() {
    let folder = folder();
    let completed = |source: &str, word: &str| {
        let line = ["linden", "show", source, "--set", word];
        let output = Command::new(env!("CARGO_BIN_EXE_linden-with-comb"))
            .arg("--")
            .args(line)
            .current_dir(folder.path())
            .env("XDG_CONFIG_HOME", folder.path())
            .envs([("LINDEN_COMPLETE", "bash"), ("_CLAP_IFS", "\n"), ("_CLAP_COMPLETE_INDEX", "4")])
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(completed("comb.toml", "comb_te"), ["comb_teeth="]);
    assert_eq!(completed("fir", "poin"), ["points="]);
    assert!(completed("fir", "comb_te").is_empty());
}

#[test]
fn what_is_wrong_with_its_table_is_said() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("wrong.toml"), "id = \"a\"\n[comb]\ncomb_teath = 3\n").unwrap();
    let output = linden(folder, &["show", "wrong.toml"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("wrong.toml:3:1") && message.contains("did you mean 'comb_teeth'"), "{message}");
    let output = linden(folder, &["show", "comb.toml", "--set", "comb_depth=9"]);
    assert!(String::from_utf8(output.stderr).unwrap().contains("0 to 8"));
}
