//! Saving: what is asked, what is written, and that it reads back as what was on screen.

use std::path::Path;

use linden::Quiet;

use super::save;
use crate::tui::effect::Effect;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::tree::TreePlace;
use crate::tui::update::Msg;

fn written(dir: &Path, name: &str) -> String {
    std::fs::read_to_string(dir.join(name)).unwrap()
}

/// Does what the model asks for, as the runtime does.
fn save(bench: &mut FormBench, dir: &Path) {
    let Some(Effect::Save { id, from, recipe, overwrite, .. }) = bench.effects.pop() else {
        panic!("nothing was to be saved: {}", bench.said())
    };
    bench.send(Msg::Saved(save::write(dir, &id, &from, &recipe, overwrite)));
    bench.list(dir);
}

#[test]
fn a_copy_is_saved_with_its_mesh_and_is_what_was_on_screen() {
    let dir = tempfile::tempdir().unwrap();
    let presets = dir.path().join("presets");
    let mut bench = FormBench::at(TreePlace::Builtin("heart"), dir.path().to_owned());
    bench.on("points").keys("right");
    bench.keys("s enter");
    save(&mut bench, &presets);
    assert!(bench.said().starts_with("saved as 'heart-2' in "), "{}", bench.said());
    let mut names: Vec<_> = std::fs::read_dir(&presets).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["heart-2.obj", "heart-2.toml"]);

    let read = crate::source::resolve(&presets.join("heart-2.toml"), &[], &Quiet).unwrap();
    assert!(read.files.contains(&presets.join("heart-2.obj")), "its own mesh, not the built-in one");
    let tree = bench.tree();
    assert!(read.recipe.preset == *tree.preset(), "what is read is what is on screen");
    assert!(!tree.is_modified());
    // What its author wrote is there, but for what was changed.
    let [first, now] = [linden::preset::builtin("heart").unwrap().text, &written(&presets, "heart-2.toml")]
        .map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>());
    let gone: Vec<&String> = first.iter().filter(|line| !now.contains(line)).collect();
    assert!(gone.len() <= 4 && now.len() <= first.len() + 1, "{gone:?} of {first:?}");
    let of = |recipe: &linden::recipe::Recipe| recipe.input("heart-2.obj").unwrap().hash;
    assert_eq!(of(tree.recipe()), of(&read.recipe));
    let preset = tree.preset();
    assert_eq!((preset.id.as_str(), preset.name.as_str()), ("heart-2", "heart-2"));
    assert!(preset.source.starts_with("linden; any closed OBJ"));

    // Undo leads back to changes of the new preset, and saving it again asks, then replaces it.
    bench.keys("u");
    assert_eq!((bench.tree().preset().id.as_str(), bench.value("points").as_str()), ("heart-2", "3000"));
    assert!(bench.tree().is_modified());
    bench.keys("s enter");
    let (buffer, _) = bench.paint(80, 24);
    let shown = text(&buffer);
    assert!(shown.contains("replace 'heart-2'? y or n") && shown.contains("comments stay"), "{shown}");
    bench.typed("n");
    assert!(bench.effects.iter().all(|effect| !matches!(effect, Effect::Save { .. })));
    // Its owner writes into it meanwhile: that stays.
    let mine = format!("# mine\n{}", written(&presets, "heart-2.toml"));
    std::fs::write(presets.join("heart-2.toml"), &mine).unwrap();
    bench.keys("s enter").typed("y");
    save(&mut bench, &presets);
    assert!(written(&presets, "heart-2.toml").starts_with("# mine\n"));
    let read = crate::source::resolve(&presets.join("heart-2.toml"), &[], &Quiet).unwrap();
    assert!(read.recipe.preset == *bench.tree().preset());
    assert_eq!(std::fs::read_dir(&presets).unwrap().count(), 2);
    // The next copy has a number of its own.
    bench.keys("s ctrl-u").typed("heart-3").keys("enter");
    save(&mut bench, &presets);
    // It lies in the same folder: one mesh is enough.
    assert_eq!(std::fs::read_dir(&presets).unwrap().count(), 3);
    assert!(crate::source::resolve(&presets.join("heart-3.toml"), &[], &Quiet).is_ok());
}

#[test]
fn an_id_is_checked_while_it_is_typed() {
    let dir = tempfile::tempdir().unwrap();
    let mut bench = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    bench.keys("s ctrl-u").typed("a/b");
    assert!(bench.problem().unwrap().contains("file names cannot have"));
    let (buffer, _) = bench.paint(100, 24);
    assert!(text(&buffer).contains("'a/b' cannot be a preset's id"));
    bench.keys("enter");
    assert!(bench.effects.is_empty() && !bench.model.dialogs.is_empty());
    bench.keys("ctrl-u").typed("fir");
    assert_eq!(bench.problem(), None);
    let (buffer, _) = bench.paint(100, 24);
    assert!(text(&buffer).contains("means the built-in one"));
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn what_cannot_be_saved_whole_is_not_saved() {
    let dir = tempfile::tempdir().unwrap();
    let source = dir.path().join("crown.obj");
    std::fs::write(&source, linden::preset::builtin_file("heart.obj").unwrap()).unwrap();
    let place = TreePlace::File(source.clone());
    let recipe = crate::source::resolve(&source, &[], &Quiet).unwrap().recipe;
    let presets = dir.path().join("presets");
    // The mesh changes after it was read.
    std::fs::write(&source, [linden::preset::builtin_file("heart.obj").unwrap(), b"# more\n"].concat())
        .unwrap();
    let error = save::write(&presets, "copy", &place, &recipe, false).unwrap_err();
    assert!(error.contains("not the file any more"), "{error}");
    std::fs::remove_file(&source).unwrap();
    let error = save::write(&presets, "copy", &place, &recipe, true).unwrap_err();
    assert!(error.contains("crown.obj, which the preset needs"), "{error}");
    assert!(!presets.exists());
    // A file of that name belongs to the user.
    let heart = crate::source::resolve(Path::new("heart"), &[], &Quiet).unwrap().recipe;
    std::fs::create_dir(&presets).unwrap();
    std::fs::write(presets.join("mine.obj"), "v 0 0 0").unwrap();
    let error = save::write(&presets, "mine", &TreePlace::Builtin("heart"), &heart, false).unwrap_err();
    assert!(error.contains("another file"), "{error}");
    assert!(!presets.join("mine.toml").exists());
    // Replaced is all of it or nothing.
    std::fs::create_dir(presets.join("mine.toml")).unwrap();
    let error = save::write(&presets, "mine", &TreePlace::Builtin("heart"), &heart, true).unwrap_err();
    assert!(error.contains("mine.toml"), "{error}");
    assert_eq!(written(&presets, "mine.obj"), "v 0 0 0");
    std::fs::remove_dir(presets.join("mine.toml")).unwrap();
    save::write(&presets, "mine", &TreePlace::Builtin("heart"), &heart, true).unwrap();
    assert!(written(&presets, "mine.toml").contains("mine.obj"));
    assert_ne!(written(&presets, "mine.obj"), "v 0 0 0");
    assert_eq!(std::fs::read_dir(&presets).unwrap().count(), 2);
}

#[test]
fn what_is_saved_is_the_tree_that_the_line_was_opened_for() {
    let dir = tempfile::tempdir().unwrap();
    let mut bench = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    bench.on("points").keys("right");
    let recipe = bench.tree().recipe().clone();
    bench.keys("s ctrl-u").typed("mytree");
    // Another tree comes on screen while the name is typed.
    let other = crate::source::resolve(Path::new("older-c"), &[], &Quiet).unwrap();
    bench.model.tree = Some(crate::tui::tree::Tree::new(TreePlace::Builtin("older-c"), other.recipe));
    bench.keys("enter");
    let Some(Effect::Save { id, from, recipe: saved, .. }) = bench.effects.pop() else { panic!() };
    assert_eq!((id.as_str(), from), ("mytree", TreePlace::Builtin("fir")));
    assert!(std::sync::Arc::ptr_eq(&saved, &recipe));
}

#[test]
fn an_opened_file_is_saved_back_and_a_path_is_a_place() {
    let dir = tempfile::tempdir().unwrap();
    let species = dir.path().join("species");
    std::fs::create_dir(&species).unwrap();
    let path = species.join("mine.toml");
    let document =
        "id = \"bush\" # mine\nname = \"Bush\"\n\n[colonization]\ncrown = \"sphere\"\npoints = 200\n";
    std::fs::write(&path, document).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    let preset = bench.tree().preset().clone();
    bench.model.library.add_file(path.clone(), &preset);
    bench.on("points").keys("right s");
    let shown = text(&bench.paint(120, 24).0);
    assert!(shown.contains("species/mine.toml") && shown.contains("you will be asked"), "{shown}");
    bench.keys("enter");
    assert!(bench.effects.is_empty());
    let shown = text(&bench.paint(60, 24).0);
    assert!(shown.contains("replace 'mine.toml'? y or n") && shown.contains("comments stay"), "{shown}");
    bench.typed("y");
    let write = |bench: &mut FormBench| {
        let Some(Effect::Save { dir, id, from, recipe, overwrite, .. }) = bench.effects.pop() else {
            panic!()
        };
        bench.effects.clear();
        let saved = save::write(&dir.unwrap(), &id, &from, &recipe, overwrite);
        bench.send(Msg::Saved(saved));
    };
    write(&mut bench);
    let points = bench.value("points");
    assert_eq!(written(&species, "mine.toml"), document.replace("200", &points), "its id stays, too");
    assert!(!bench.tree().is_modified());
    // Elsewhere it is a copy, with or without the ending.
    let copy = species.join("copy");
    bench.keys("s ctrl-u").typed(copy.to_str().unwrap()).keys("enter");
    write(&mut bench);
    assert!(written(&species, "copy.toml").contains(&format!("points = {points}")));
    assert_eq!(bench.tree().place, TreePlace::File(species.join("copy.toml")));
    for typed in ["/", "./", "/tmp/a:b", "x/"] {
        assert!(save::problem(typed).is_some(), "{typed}");
    }
}

#[test]
fn what_others_changed_of_a_file_meanwhile_stays() {
    let dir = tempfile::tempdir().unwrap();
    let presets = dir.path().join("presets");
    std::fs::create_dir(&presets).unwrap();
    let path = presets.join("mine.toml");
    std::fs::write(&path, "id = \"mine\"\n[colonization]\ncrown = \"sphere\"\npoints = 200\n").unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    bench.list(&presets);
    bench.on("seed").keys("right");
    let seed = bench.value("seed");
    let tree = bench.tree();
    let over = save::over(&presets, "mine", &tree.place, tree.saved(), tree.recipe()).unwrap();
    assert!(std::sync::Arc::ptr_eq(&over, tree.recipe()), "the file is as it was");
    // Another workbench saves, and this one has not heard of it.
    let theirs = written(&presets, "mine.toml").replace("200", "1080");
    std::fs::write(&path, &theirs).unwrap();
    let tree = bench.tree();
    let over = save::over(&presets, "mine", &tree.place, tree.saved(), tree.recipe()).unwrap();
    let read = |name: &str, of: &linden::preset::Preset| {
        of.all_knobs().into_iter().find(|(row, _)| row.knob.name == name).unwrap().1.to_string()
    };
    assert_eq!((read("points", &over.preset), read("seed", &over.preset)), ("1080".to_owned(), seed.clone()));
    // It hears of it: its own change alone is one, also on the way back.
    let changed = crate::source::forest::AnySource::read(&path, &Quiet).unwrap();
    bench.model.loading = Some(TreePlace::File(path.clone()));
    bench.send(Msg::Loaded(TreePlace::File(path.clone()), Ok(changed)));
    assert_eq!((bench.value("points"), bench.value("seed")), ("1080".to_owned(), seed.clone()));
    assert_eq!(bench.tree().turned(), ["seed"]);
    bench.keys("s enter");
    let shown = text(&bench.paint(140, 24).0);
    assert!(shown.contains("changed on disk since you opened it"), "{shown}");
    bench.typed("y");
    save(&mut bench, &presets);
    let now = written(&presets, "mine.toml");
    assert!(now.contains("points = 1080") && now.contains(&format!("seed = {seed}")), "{now}");
    bench.keys("u");
    assert_eq!(bench.value("points"), "1080", "nothing of theirs is taken back");
}

#[test]
fn a_missing_directory_is_asked_about() {
    let dir = tempfile::tempdir().unwrap();
    let mut bench = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    let ask = |bench: &mut FormBench| {
        bench.send(Msg::NoFolder(dir.path().join("evil"), Box::new(Effect::Redraw)));
        let shown = text(&bench.paint(120, 24).0);
        assert!(shown.contains("make it? y or n") && shown.contains("/evil"), "{shown}");
    };
    ask(&mut bench);
    bench.typed("n");
    assert!(bench.effects.is_empty() && bench.said() == "not saved", "{}", bench.said());
    ask(&mut bench);
    bench.typed("y");
    assert!(matches!(&bench.effects[..], [Effect::Redraw]), "{:?}", bench.effects);
}
