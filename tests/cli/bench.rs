//! `bench`: rates that agree with what is written, and nothing left over.

use std::fs;

use crate::program::Folder;

#[test]
fn rates_are_those_of_what_was_written() {
    let folder = Folder::new();
    fs::create_dir(folder.file("disk")).unwrap();
    let knobs = ["--set", "derivations=3", "--set", "bark_size=16"];
    let args =
        ["bench", "abop-honda-a", "bush-3d", "--seconds", "0.2", "--jobs", "2", "--out", "disk", "--json"];
    let found = folder.run(&[&args[..], &knobs].concat()).done().json();
    assert_eq!((&found["jobs"], found["format"].as_str()), (&2.into(), Some("glb")));
    let rates = found["rates"].as_array().unwrap();
    assert_eq!(rates.iter().map(|rate| rate["source"].as_str().unwrap()).collect::<Vec<_>>(), args[1..3]);
    for rate in rates {
        let number = |name: &str| rate[name].as_f64().unwrap_or_else(|| panic!("{name} in {rate}"));
        assert!(number("trees") >= 2.0 && number("seconds") >= 0.2);
        let per_hour = 3600.0 * number("trees") / number("seconds");
        assert!((number("trees_per_hour") - per_hour).abs() < 1e-6 * per_hour);
        // Grammars without chance: each tree is as large as the first.
        let source = rate["source"].as_str().unwrap();
        folder.run(&[&["export", source], &knobs[..], &["-o", "one.glb"]].concat()).done();
        let bytes = fs::metadata(folder.file("one.glb")).unwrap().len() as f64;
        // But for digits of the seed.
        assert!((number("bytes_per_tree") - bytes).abs() < 16.0, "{bytes} are not in {rate}");
        let least = number("least_memory_bytes_per_tree");
        assert!(least > 0.5 * bytes && least < 3.0 * bytes, "{rate}");
    }
    assert_eq!(fs::read_dir(folder.file("disk")).unwrap().count(), 0);
}

#[test]
fn a_table_is_for_people_and_mistakes_are_told_before_anything_grows() {
    let folder = Folder::new();
    let few = ["bench", "abop-a", "--set", "derivations=2", "--set", "bark_size=16", "--seconds", "0"];
    let said = folder.run(&few).done().out;
    let [head, row, ..] = said.lines().collect::<Vec<_>>()[..] else { panic!("{said}") };
    assert!(head.contains("trees/h") && row.starts_with("abop-a "), "{said}");
    for (args, expected) in [
        (&["oka"][..], "oak"),
        (&["fir", "--set", "pionts=3"], "points"),
        (&["oak", "--set", "points"], "KNOB=VALUE"),
        (&["oak", "--format", "gbl"], "glb"),
        (&["oak", "--seconds=-1"], "seconds"),
    ] {
        let said = folder.run(&[&["bench"], args].concat());
        assert!(said.code == Some(2) && said.err.contains(expected), "{}", said.err);
    }
    let said = folder.run(&["bench", "oak", "--out", "nowhere"]);
    assert!(said.code == Some(1) && said.err.contains("nowhere"), "{}", said.err);
}
