//! Trees from files, and the files that they were read from.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::fs;
use std::path::{Path, PathBuf};

use linden::export::Written;
use linden::{Error, Tree, read, read_allowing, tree};

/// A fir of few points; what was written of it.
fn fir(path: PathBuf) -> Vec<Written> {
    tree("fir").unwrap().set("points", "60").unwrap().grow().unwrap().export(path).unwrap().files
}

#[test]
fn files_in_memory_are_those_on_the_disk() {
    let fir = tree("fir").unwrap().set("points", "60").unwrap().set("lods", "2").unwrap().grow().unwrap();
    for exporter in linden::export::REGISTRY {
        let format = exporter.format();
        let folder = tempfile::tempdir().unwrap();
        let name = format!("fir.{}", format.extensions.first().unwrap_or(&format.id));
        let options = || linden::export::Options::new(format);
        let on_disk = fir.export_as(*exporter, options(), folder.path().join(&name)).unwrap();
        let in_memory = fir.export_to_memory_as(*exporter, options(), &name).unwrap();
        assert_eq!(in_memory.notes, on_disk.notes, "{}", format.id);
        let written = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(in_memory.files.len(), written, "{}", format.id);
        for file in &in_memory.files {
            assert!(fs::read(folder.path().join(&file.name)).unwrap() == file.bytes, "{}", file.name);
        }
    }
}

#[test]
fn every_written_file_is_a_tree_again() {
    let mut read_back = 0;
    for exporter in linden::export::REGISTRY {
        let format = exporter.format();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("fir.{}", format.extensions.first().unwrap_or(&format.id)));
        let options = linden::export::Options::new(format);
        let fir = tree("fir").unwrap().set("points", "60").unwrap().grow().unwrap();
        fir.export_as(*exporter, options, &path).unwrap();
        if !format.holds.recipe {
            continue;
        }
        let again = read(&path).unwrap();
        assert_eq!(again.recipe().preset, fir.recipe().preset, "{}", format.id);
        read_back += 1;
    }
    assert!(read_back >= 7, "{read_back}");
}

#[test]
fn a_file_that_a_tree_was_read_from_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fir.glb");
    fir(path.clone());
    let before = fs::read(&path).unwrap();
    let again = read(&path).unwrap().seed(9).grow().unwrap();
    let refused = again.export(&path).unwrap_err();
    assert!(matches!(refused, Error::Export(_)), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), before);
    again.export(folder.path().join("other.glb")).unwrap();
}

#[test]
fn a_document_names_no_file_elsewhere_but_with_leave() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path().join("here");
    let elsewhere = folder.path().join("elsewhere");
    fs::create_dir(&here).unwrap();
    fs::create_dir(&elsewhere).unwrap();
    let rows: Vec<String> = (0..40).map(|row| format!("0 {} 0", f64::from(row) * 0.1)).collect();
    let cloud = rows.join("\n");
    fs::write(elsewhere.join("pole.xyz"), &cloud).unwrap();
    let document = here.join("pole.toml");
    fs::write(&document, "id = \"pole\"\n[scan]\nfile = \"../elsewhere/pole.xyz\"\n").unwrap();

    let refused = read(&document).err().unwrap();
    let Error::NotAllowed { error, .. } = &refused else { panic!("{refused}") };
    assert_eq!(error.folder, elsewhere);
    read_allowing(&document, &[elsewhere.as_path()]).unwrap();
    let missing = read_allowing(&document, &[Path::new("/no/such/folder")]).err().unwrap();
    assert!(matches!(missing, Error::Read { .. }), "{missing}");

    fs::write(here.join("beside.xyz"), &cloud).unwrap();
    fs::write(&document, "id = \"pole\"\n[scan]\nfile = \"beside.xyz\"\n").unwrap();
    read(&document).unwrap();
}

#[test]
fn a_copy_of_a_built_in_preset_finds_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let around = tree("around-the-stone").unwrap();
    let path = folder.path().join("copy.toml");
    fs::write(&path, around.recipe().preset.to_toml().unwrap()).unwrap();
    let copy = read(&path).unwrap();
    let hashes = |tree: &Tree| -> Vec<_> {
        tree.recipe().inputs.iter().map(|(name, input)| (name.to_owned(), input.hash_text())).collect()
    };
    assert_eq!(hashes(&copy), hashes(&around));
    assert!(!hashes(&copy).is_empty());
}

/// Grants so many bytes, and cancels after so many looks.
struct Grants {
    bytes: u64,
    looks: std::sync::atomic::AtomicUsize,
}

impl Grants {
    fn of(bytes: u64, looks: usize) -> Self {
        Self { bytes, looks: looks.into() }
    }
}

impl linden::Monitor for Grants {
    fn is_cancelled(&self) -> bool {
        use std::sync::atomic::Ordering::Relaxed;
        self.looks.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_err()
    }

    fn advance(&self, _: linden::monitor::Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.bytes
    }
}

#[test]
fn reading_is_watched_and_limited() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pole.xyz");
    let rows: Vec<String> = (0..40_000).map(|row| format!("0 {} 0", f64::from(row) * 0.001)).collect();
    fs::write(&path, rows.join("\n")).unwrap();
    let read = |bytes, looks| linden::Reading::new().watched(Grants::of(bytes, looks)).read(&path);
    let length = fs::metadata(&path).unwrap().len();
    let error = read(length - 1, usize::MAX).err().unwrap();
    assert!(matches!(error, Error::Memory(_)), "{error}");
    let error = read(length + 1000, usize::MAX).err().unwrap();
    assert!(matches!(error, Error::Memory(_)), "the points besides: {error}");
    assert!(read(u64::MAX, 1).err().unwrap().is_cancelled());
    let tree = read(u64::MAX, 100).unwrap();
    assert!(tree.grow().err().unwrap().is_cancelled(), "the tree is watched, too");
}

#[test]
fn the_library_runs_no_plug_ins_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let run = |asks: &str| {
        let mut command = std::process::Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", "finds_plug_ins_on_the_path"]);
        command.env("PATH", folder.path()).env("LINDEN_TEST_ASKS", asks).output().unwrap()
    };
    let program = folder.path().join(format!("linden-export-pwn{}", std::env::consts::EXE_SUFFIX));
    fs::copy(std::env::current_exe().unwrap(), program).unwrap();
    for asks in ["no", "yes"] {
        let output = run(asks);
        assert!(output.status.success(), "{asks}: {}", String::from_utf8_lossy(&output.stdout));
    }
}

/// For [`the_library_runs_no_plug_ins_unasked`], which runs it with a program on the search path.
#[test]
fn finds_plug_ins_on_the_path() {
    use linden::export::Registry;
    let Ok(asks) = std::env::var("LINDEN_TEST_ASKS") else { return };
    let asks = asks == "yes";
    let registry = if asks { Registry::new().with_plugins() } else { Registry::new() };
    assert_eq!(registry.find("pwn").is_ok(), asks);
    assert_eq!(registry.for_path(Path::new("x.pwn")).is_ok(), asks);
    assert_eq!(registry.exporters().iter().any(|exporter| exporter.format().id == "pwn"), asks);
    let tree = tree("fir").unwrap().set("points", "60").unwrap().grow().unwrap();
    assert!(matches!(tree.export_to_memory("x.pwn"), Err(Error::Export(_))));
}

#[test]
fn trees_are_debugged_and_cloned() {
    let tree = tree("fir").unwrap().set("points", "60").unwrap();
    assert!(format!("{tree:?}").contains("\"points\""));
    let grown = tree.grow().unwrap();
    let shown = format!("{grown:?}");
    assert!(shown.contains("nodes: ") && !shown.contains("positions"), "{shown}");
    assert_eq!(grown.clone().grown().hash(), grown.grown().hash());
}

#[cfg(unix)]
#[test]
fn devices_and_folders_are_refused_before_they_are_read() {
    for path in ["/dev/zero", "/"] {
        let refused = read(path).err().unwrap();
        assert!(matches!(refused, Error::Read { .. }), "{refused}");
        assert!(refused.to_string().contains("no regular file"), "{refused}");
    }
}

#[test]
fn a_recipe_says_who_made_it_and_whether_its_tree_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let tree = tree("fir").unwrap().set("points", "60").unwrap();
    let grown = tree.clone().grow().unwrap();
    let line = grown.recipe().to_line_of(grown.grown().hash());
    let notes = |line: &str, seed: u64| {
        let path = folder.path().join("fir.json");
        fs::write(&path, line).unwrap();
        read(&path).unwrap().seed(seed).grow().unwrap().notes().to_vec()
    };
    assert!(notes(&line, 1).is_empty());
    let older = line.replace(linden::recipe::VERSION, "0.0.9");
    let said = notes(&older, 1);
    assert!(said.len() == 2 && said[0].contains("0.0.9") && said[1].contains("the same tree"), "{said:?}");
    assert_eq!(notes(&older, 2).len(), 1, "of another seed no tree is known");
}
