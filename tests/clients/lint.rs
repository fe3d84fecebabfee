//! `linden_lint` finds in binary USD of usd-core what it finds in text.

use std::fs;
use std::path::Path;

use linden::Quiet;
use linden::dress::levels;
use linden::stage::Stage;
use linden_lint::{Asset, Beside, Config, lint, read};
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

#[test]
fn packed_vertices_are_looked_at_as_plain_ones_are() {
    let dir = exported("clients-lint-packed");
    // Pictures large enough that nothing is measured of them: sums hang on the order of triangles.
    let (recipe, grown, _) = dressed(&[("lods", "2"), ("triangles", "4000"), ("card_size", "1024")]);
    let dressed = levels(&recipe, &grown, &Quiet).unwrap();
    let looked = |name: &str, options: &[(&str, &str)]| {
        let path = dir.join(name);
        export_stage(&dressed.stage(), "glb", options, &path).unwrap();
        read(name, &fs::read(path).unwrap(), &Folder(&dir), &Quiet).unwrap()
    };
    for quantize in ["false", "true"] {
        let quantize = ("quantize", quantize);
        let plain = looked("plain.glb", &[quantize]);
        let packed = looked("packed.glb", &[quantize, ("compress", "meshopt")]);
        assert_eq!((&packed.unseen, packed.meshes.len()), (&plain.unseen, plain.meshes.len()));
        for (one, other) in plain.meshes.iter().zip(&packed.meshes) {
            let (one, other) = (one.geometry.as_ref().unwrap(), other.geometry.as_ref().unwrap());
            assert!(one.positions == other.positions && one.normals == other.normals && one.uvs == other.uvs);
            // The codec turns triangles.
            let turned = |triangle: &[u32; 3]| {
                let [a, b, c] = *triangle;
                [[a, b, c], [b, c, a], [c, a, b]].into_iter().min()
            };
            assert!(one.triangles.iter().map(turned).eq(other.triangles.iter().map(turned)));
        }
        let report = |asset| format!("{:?}", lint(asset, &Config::default()).findings);
        assert_eq!(report(&plain), report(&packed));
    }
}

#[test]
fn levels_in_files_of_their_own_share_their_materials() {
    let dir = exported("clients-lint-levels");
    let (recipe, grown, _) = dressed(&[("lods", "3"), ("triangles", "4000")]);
    let dressed = levels(&recipe, &grown, &Quiet).unwrap();
    let options = [("lods", "files"), ("quantize", "true"), ("compress", "meshopt")];
    let file = |level: usize| {
        let path = dir.join(format!("tree_LOD{level}.glb"));
        export_stage(&dressed.stage().at_level(level), "glb", &options, &path).unwrap();
        (level as u32, read("tree.glb", &fs::read(path).unwrap(), &Folder(&dir), &Quiet).unwrap())
    };
    let files: Vec<(u32, Asset)> = (0..3).map(file).collect();
    let names = |asset: &Asset| asset.materials_by_name().into_keys().map(str::to_owned).collect::<Vec<_>>();
    let all: std::collections::BTreeSet<String> = files.iter().flat_map(|(_, asset)| names(asset)).collect();
    let whole = Asset::join("tree", files);
    assert!(whole.materials.len() > all.len(), "pictures are stretched otherwise in each level");
    assert_eq!(whole.materials_by_name().values().sum::<usize>(), all.len());
    let report = lint(&whole, &Config::default());
    assert!(report.findings.iter().all(|finding| finding.rule != "names"), "{:?}", report.findings);
}
