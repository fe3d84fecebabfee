use super::*;
use linden::monitor::Quiet;
use linden::preset::builtin;
use std::os::unix::fs::{PermissionsExt as _, symlink};

const GRAMMAR: &str = "// a bush\naxiom=F\nangle=20\nnumber of derivations=2\nF=(1)F[+F]F\n";

fn fir() -> &'static str {
    builtin("fir").unwrap().text
}

fn listed(dir: &Path) -> Vec<UserPreset> {
    let (presets, complaints) = list(dir, &Quiet);
    assert_eq!(complaints, []);
    presets
}

fn ids(presets: &[UserPreset]) -> Vec<(&str, &str, bool)> {
    presets.iter().map(|preset| (preset.group.as_str(), preset.id.as_str(), preset.state.is_ok())).collect()
}

#[test]
fn presets_and_grammars_are_listed_by_folder() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::create_dir_all(at("moor/deeper")).unwrap();
    fs::write(at("tall.toml"), fir()).unwrap();
    fs::write(at("bush.txt"), GRAMMAR).unwrap();
    fs::write(at("moor/birch.TOML"), fir()).unwrap();
    fs::write(at("moor/fern.l"), GRAMMAR).unwrap();
    fs::write(at("points.txt"), "0 1 0\n0 2 0\n1 2 0\n").unwrap();
    for unlisted in ["moor/deeper/x.toml", ".hidden.toml", "notes.md", "tall.toml~", "moor/.x.toml.swp"] {
        fs::write(at(unlisted), "nonsense").unwrap();
    }
    let presets = listed(dir.path());
    assert_eq!(
        ids(&presets),
        [
            ("crowns", "tall", true),
            ("moor", "birch", true),
            ("moor", "fern", true),
            ("own", "bush", true),
            ("own", "points", true)
        ]
    );
    assert_eq!((presets[0].name.as_str(), presets[3].summary.as_str()), ("Fir", "a bush"));
    // What is listed as sound grows.
    for preset in &presets {
        crate::source::resolve(&preset.path, &[], &Quiet).unwrap();
    }
}

#[test]
fn no_directory_is_no_complaint_and_a_file_in_its_place_is_one() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(list(&dir.path().join("none"), &Quiet), (vec![], vec![]));
    let file = dir.path().join("presets");
    fs::write(&file, "").unwrap();
    assert_eq!(list(&file, &Quiet).1.len(), 1);
}

#[test]
fn broken_files_are_listed_with_their_place() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::write(at("a.toml"), fir().replace("points = 1000", "pionts = 1000")).unwrap();
    fs::write(at("b.txt"), "axiom=F\nangle=20\nnumber of derivations=2\nF=(1)F[+F\n").unwrap();
    fs::write(at("c.toml"), b"id = \"\xff\"\n").unwrap();
    fs::write(at("d.toml"), "").unwrap();
    fs::create_dir(at("e.toml")).unwrap();
    symlink(at("f.toml"), at("f.toml")).unwrap();
    symlink("/dev/zero", at("g.toml")).unwrap();
    fs::File::create(at("h.toml")).unwrap().set_len(MAX_BYTES + 1).unwrap();
    fs::write(at("i.toml"), "id = \"i\"\n[colonization]\nenvelope = \"i.obj\"\n").unwrap();
    symlink(dir.path(), at("loop")).unwrap();
    let presets: Vec<UserPreset> =
        listed(dir.path()).into_iter().filter(|preset| preset.group != "loop").collect();
    let complaints: Vec<&Complaint> =
        presets.iter().map(|preset| preset.state.as_ref().unwrap_err()).collect();
    assert_eq!(complaints.len(), 9);
    let found: Vec<_> =
        complaints.iter().map(|c| (c.place.map(|(line, _)| line), c.message.clone())).collect();
    for (index, (line, word)) in [
        (Some(11), "did you mean 'points'"),
        (Some(4), "'['"),
        (None, "UTF-8"),
        (None, "empty"),
        (None, "directory"),
        (None, "cannot be read"),
        (None, "device"),
        (None, "64 MiB"),
        (None, "i.obj"),
    ]
    .into_iter()
    .enumerate()
    {
        if line.is_some() {
            assert_eq!(found[index].0, line, "{:?}", found[index]);
        }
        assert!(found[index].1.contains(word), "{word}: {:?}", found[index]);
    }
    // The file that was missing.
    let cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(at("i.obj"), cube).unwrap();
    assert!(listed(dir.path()).iter().any(|preset| preset.id == "i" && preset.state.is_ok()));
}

#[test]
fn what_may_not_be_read_is_complained_about() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("locked");
    fs::create_dir(&folder).unwrap();
    fs::write(dir.path().join("a.toml"), fir()).unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o000)).unwrap();
    fs::set_permissions(dir.path().join("a.toml"), fs::Permissions::from_mode(0o000)).unwrap();
    let locked = fs::read_dir(&folder).is_err();
    let (presets, complaints) = list(dir.path(), &Quiet);
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o700)).unwrap();
    // Root may read everything.
    assert_eq!((presets[0].state.is_err(), complaints.len()), (locked, usize::from(locked)));
}

#[test]
fn a_saved_preset_is_listed_and_not_overwritten_unasked() {
    let dir = tempfile::tempdir().unwrap();
    let presets = dir.path().join("config/presets");
    let path = save(&presets, "my-fir", fir(), false).unwrap();
    assert_eq!(path, presets.join("my-fir.toml"));
    assert_eq!(ids(&listed(&presets)), [("crowns", "my-fir", true)]);
    let other = fir().replace("Fir", "Other");
    let error = save(&presets, "my-fir", &other, false).unwrap_err();
    assert!(matches!(error, SaveError::Exists { .. }) && error.to_string().contains("already"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), fir());
    save(&presets, "my-fir", &other, true).unwrap();
    assert_eq!(listed(&presets)[0].name, "Other");
    assert_eq!(fs::read_dir(&presets).unwrap().count(), 1);
    assert!(matches!(save(&presets, "bad", "id = 3", false), Err(SaveError::Document(_))));
    assert!(matches!(save(Path::new("/dev/null/x"), "a", fir(), false), Err(SaveError::Write { .. })));
}

#[test]
fn ids_that_are_no_file_names_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let long = "a".repeat(101);
    for id in [
        "",
        ".",
        "..",
        "a/b",
        "/a",
        "..\\a",
        "a\0b",
        "a\u{1b}",
        "a\u{202e}b",
        ".a",
        "-a",
        " a",
        "a.",
        "NUL",
        "com1.x",
        &long,
    ] {
        let error = save(dir.path(), id, fir(), true).unwrap_err();
        assert!(matches!(error, SaveError::Id(..)), "{id:?}: {error}");
    }
    for id in ["fir", "Zirbe 2", "b\u{fc}sch", "a.b", "commons"] {
        save(dir.path(), id, fir(), false).unwrap();
    }
    assert_eq!(listed(dir.path()).len(), 5);
}

#[test]
fn what_is_removed_is_kept_where_it_is_not_listed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    for name in ["mine.toml", "mine-2.toml"] {
        std::fs::write(&path, "id = \"mine\"\n").unwrap();
        assert_eq!(put_away(&path), Ok(Some(dir.path().join(".removed").join(name))));
        assert!(list(dir.path(), &linden::Quiet).0.is_empty());
    }
    assert_eq!(put_away(&path), Ok(None));
}

#[test]
fn a_file_is_renamed_but_never_over_another() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str| dir.path().join(name);
    std::fs::write(file("a.txt"), "a").unwrap();
    std::fs::write(file("b.txt"), "b").unwrap();
    let taken = rename(&file("a.txt"), "b").unwrap_err().to_string();
    assert!(taken.contains("a.txt") && taken.contains("there is a file of that name"), "{taken}");
    assert!(rename(&file("a.txt"), "../c").is_err() && rename(&file("none.txt"), "c").is_err());
    assert_eq!(rename(&file("a.txt"), "my c"), Ok(file("my c.txt")));
    assert_eq!(std::fs::read_to_string(file("my c.txt")).unwrap(), "a");
    assert_eq!(std::fs::read_to_string(file("b.txt")).unwrap(), "b");
    assert!(!file("a.txt").exists());
}

#[test]
fn what_is_renamed_says_so_in_its_document_and_keeps_its_comments() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str| dir.path().join(name);
    let tree = "id = \"a\" # old\nname = \"a\"\n\n[colonization]\ncrown = \"sphere\" # round\npoints = 200\n";
    let forest = "id = \"a\"\nname = \"Copse\" # of firs\n\n[[tree]]\npreset = \"fir\"\n";
    let broken = "id = \"a\"\n[colonization\n";
    for (text, renamed) in [
        (tree, tree.replace("\"a\"", "\"b\"")),
        (forest, forest.replace("\"a\"", "\"b\"")),
        (broken, broken.to_owned()),
    ] {
        std::fs::write(file("a.toml"), text).unwrap();
        assert_eq!(rename(&file("a.toml"), "b"), Ok(file("b.toml")));
        assert_eq!(std::fs::read_to_string(file("b.toml")).unwrap(), renamed);
        assert!(!file("a.toml").exists());
        std::fs::remove_file(file("b.toml")).unwrap();
    }
}
