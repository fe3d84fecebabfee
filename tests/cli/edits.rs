//! Edits of the wood: `--edit`, `show --axes`, and files that carry them.

use crate::program::Folder;

const SMALL: [&str; 6] = ["--set", "points=300", "--set", "leaf_form=none", "--set", "bark_size=16"];

fn with<'a>(before: &[&'a str], after: &[&'a str]) -> Vec<&'a str> {
    before.iter().chain(&SMALL).chain(after).copied().collect()
}

#[test]
fn show_lists_axes_and_edits_take_them() {
    let folder = Folder::new();
    let list = folder.run(&with(&["show", "drawn-oak"], &["--axes", "--json"])).done().json();
    let axes = list["axes"].as_array().unwrap();
    let paths: Vec<&str> = axes.iter().map(|row| row["path"].as_str().unwrap()).collect();
    assert!(paths[0] == "stem" && paths[1] == "stem/1" && axes[0]["order"] == 0 && axes[1]["order"] == 1);
    let text = folder.run(&with(&["show", "drawn-oak"], &["--axes"])).done().out;
    assert_eq!(text.lines().count(), axes.len() + 2, "a heading, the axes, the fingerprint");
    assert!(text.ends_with(&format!("{} axes; branching = {}\n", axes.len(), list["branching"])), "{text}");
    let edits = ["--edit", "remove stem/1", "--edit", "add stem 0.5 at=0.5 towards=1,0,0"];
    let edited =
        folder.run(&with(&with(&["show", "drawn-oak"], &["--axes", "--json"]), &edits)).done().json();
    let left: Vec<&str> =
        edited["axes"].as_array().unwrap().iter().map(|row| row["path"].as_str().unwrap()).collect();
    assert!(!left.contains(&"stem/1") && left.contains(&"stem/2") && left.contains(&"new"));
    assert_eq!(edited["branching"], list["branching"]);
}

#[test]
fn edited_trees_are_written_verified_and_grown_again() {
    let folder = Folder::new();
    let edit = ["--edit", "cut stem 0.5", "-o", "cut.glb"];
    folder.run(&with(&["export", "drawn-oak"], &edit)).done();
    folder.run(&["verify", "cut.glb"]).done();
    let nodes = |source: &str| {
        let args = if source == "drawn-oak" {
            with(&["stats", "drawn-oak", "--json"], &[])
        } else {
            vec!["stats", source, "--json"]
        };
        folder.run(&args).done().json()["nodes"].as_f64().unwrap()
    };
    assert!(nodes("cut.glb") < nodes("drawn-oak"));
    // A document that show writes is the same tree.
    let toml = folder.run(&with(&["show", "drawn-oak", "--toml"], &["--edit", "cut stem 0.5"])).done().out;
    assert!(toml.contains("[[edit]]\ndo = \"cut\"\naxis = \"stem\"\n"), "{toml}");
    folder.write("cut.toml", &toml);
    assert_eq!(nodes("cut.toml"), nodes("cut.glb"));
}

#[test]
fn what_is_wrong_with_an_edit_is_said() {
    let folder = Folder::new();
    for (args, code, expected) in [
        (&["stats", "fir", "--edit", "cutt stem 0.5"][..], 2, "did you mean 'cut'?"),
        (&["stats", "fir", "--edit", "cut stem 1.5"], 2, "'at': 1.5 is outside the range: 0 to 1"),
        (
            &["export", "fir", "drawn-oak", "--edit", "cut stem 0.5", "-o", "x.glb"],
            2,
            "export each by itself",
        ),
        (&["show", "mixed-wood", "--edit", "cut stem 0.5"], 2, "a forest has several trees"),
        (&["show", "mixed-wood", "--axes"], 2, "a forest has several"),
        (
            &["stats", "fir", "--set", "points=100", "--edit", "remove stem2"],
            0,
            "note: edit 1 (remove stem2) was left out",
        ),
    ] {
        let said = folder.run(args);
        assert!(
            said.code == Some(code) && said.err.contains(expected),
            "{args:?}: {:?} {}",
            said.code,
            said.err
        );
    }
}
