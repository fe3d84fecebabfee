//! `linden_lint` finds in binary USD of usd-core what it finds in text.

use std::fs;
use std::path::Path;

use linden::Quiet;
use linden::dress::levels;
use linden::stage::Stage;
use linden_lint::{Beside, Config, lint, read};
use linden_tests::fixtures::export_stage;

use crate::instances::dressed;
use crate::outside::{exported, run};

/// Types of values that models have, and many that nobody looks at.
const TYPES: &str = include_str!("lint.usda");
/// What only newer versions hold.
const NEWER: [&str; 3] = ["payload", "pathExpression", "timecode"];
/// As many as `lint.py` writes.
const VERSIONS: usize = 9;

struct Folder<'a>(&'a Path);

impl Beside for Folder<'_> {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        Ok(fs::read(self.0.join(name)).ok())
    }
}

/// The model, to the last vertex, and the report; or why there is none.
fn looked_at(dir: &Path, bytes: &[u8]) -> String {
    match read("a.usd", bytes, &Folder(dir), &Quiet) {
        Ok(asset) => format!("{:?} {asset:?}", lint(&asset, &Config::default())),
        Err(error) => error.to_string(),
    }
}

#[test]
fn binary_usd_of_usd_core_has_the_report_of_the_text() {
    let dir = exported("clients-lint");
    let (recipe, grown, scene) = dressed(&[("lods", "3"), ("triangles", "4000")]);
    let stage = Stage::of(&scene);
    let write = |name: &str, stage: &Stage<'_>, options: &[(&str, &str)]| {
        export_stage(stage, "usda", options, &dir.join(format!("{name}.usda"))).unwrap();
    };
    write("levels", &levels(&recipe, &grown, &Quiet).unwrap().stage(), &[("lightmap_uv", "true")]);
    write("instances", &stage, &[("instances", "true"), ("collision", "capsules")]);
    write("payload", &stage, &[("payload", "true")]);
    let bones = dressed(&[("wind", "bones")]).2;
    write("bones", &Stage::of(&bones), &[]);
    write("nanite", &Stage::of(&bones), &[("nanite", "skeletal")]);
    let older = without(TYPES, &NEWER);
    fs::write(dir.join("types.usda"), TYPES).unwrap();
    fs::write(dir.join("older.usda"), &older).unwrap();
    run("lint.py", &dir);
    // The parser of text does not know all types.
    for (name, text) in [("types", TYPES), ("older", &older)] {
        fs::write(dir.join(format!("{name}.usda")), without(text, &["some:"])).unwrap();
    }
    let names = ["levels", "instances", "payload", "payload_payload", "bones", "nanite", "types", "older"];
    for name in names {
        let expected = looked_at(&dir, &fs::read(dir.join(format!("{name}.usda"))).unwrap());
        assert!(expected.starts_with("Report"), "{name}: {expected:.200}");
        let mut binaries = 0;
        for entry in fs::read_dir(&*dir).unwrap() {
            let path = entry.unwrap().path();
            let file = path.file_name().unwrap().to_str().unwrap();
            if !file.starts_with(&format!("{name}.0")) {
                continue;
            }
            binaries += 1;
            let found = looked_at(&dir, &fs::read(&path).unwrap());
            assert!(found == expected, "{file}: {found:.2000}\n{expected:.2000}");
        }
        assert_eq!(binaries, VERSIONS, "{name}");
    }
}

/// The lines that have none of some words.
fn without(text: &str, words: &[&str]) -> String {
    let kept = text.lines().filter(|line| !words.iter().any(|word| line.contains(word)));
    kept.collect::<Vec<_>>().join("\n")
}
