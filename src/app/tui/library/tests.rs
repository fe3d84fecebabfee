//! Changed trees whose files go away.

use std::path::{Path, PathBuf};

use linden::Quiet;

use crate::tui::effect::Effect;
use crate::tui::layout::Pane;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::tree::TreePlace;
use crate::tui::update::Msg;

const DOCUMENT: &str = "id = \"mine\"\n[colonization]\ncrown = \"sphere\"\npoints = 200\n";

/// The user's presets are read again, as the runtime does after a change.
fn relist(bench: &mut FormBench, dir: &Path) {
    let (presets, complaints) = crate::config::presets::list(&dir.join("presets"), &Quiet);
    bench.send(Msg::Presets(presets, complaints));
}

/// A preset of the user's on screen and in the list: its folder, its file.
fn own_preset() -> (tempfile::TempDir, PathBuf, FormBench) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("presets/mine.toml");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, DOCUMENT).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    relist(&mut bench, dir.path());
    (dir, path, bench)
}

/// The same, changed, and then its file went: its folder, its file, the value that was turned.
fn own_preset_gone() -> (tempfile::TempDir, PathBuf, String, FormBench) {
    let (dir, path, mut bench) = own_preset();
    bench.model.library.select_place(&TreePlace::File(path.clone()));
    bench.on("points").keys("right");
    let turned = bench.value("points");
    std::fs::remove_file(&path).unwrap();
    relist(&mut bench, dir.path());
    (dir, path, turned, bench)
}

#[test]
fn a_changed_tree_stays_in_the_list_when_its_file_goes() {
    let (dir, path, turned, mut bench) = own_preset_gone();
    let place = TreePlace::File(path.clone());
    assert_eq!(bench.model.library.entry().map(|entry| &entry.place), Some(&place));
    let (buffer, _) = bench.paint(140, 60);
    assert!(text(&buffer).contains("! mine"), "{}", text(&buffer));
    // Another one, and back.
    bench.model.library.select_place(&TreePlace::Builtin("fir"));
    let mut effects = Vec::new();
    super::show_selected(&mut bench.model, &mut effects);
    let fir = crate::source::forest::AnySource::read(Path::new("fir"), &Quiet).unwrap();
    bench.send(Msg::Loaded(TreePlace::Builtin("fir"), Ok(fir)));
    relist(&mut bench, dir.path());
    bench.keys(";");
    assert_eq!((&bench.tree().place, bench.value("points")), (&place, turned.clone()));
    // Saved anew it is as any other.
    let saved =
        crate::tui::shape::save::write(path.parent().unwrap(), "mine", &place, bench.tree().recipe(), true);
    bench.send(Msg::Saved(saved));
    relist(&mut bench, dir.path());
    assert!(std::fs::read_to_string(&path).unwrap().contains(&turned));
    assert_eq!(bench.model.library.entry().map(|entry| (&entry.place, &entry.fault)), Some((&place, &None)));
}

#[test]
fn one_that_is_as_saved_goes_with_its_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("presets/mine.toml");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, DOCUMENT).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    relist(&mut bench, dir.path());
    let listed = bench.model.library.len();
    std::fs::remove_file(&path).unwrap();
    relist(&mut bench, dir.path());
    assert_eq!(bench.model.library.len(), listed - 1);
}

#[test]
fn a_preset_is_removed_after_a_question() {
    let (dir, path, mut bench) = own_preset();
    let place = TreePlace::File(path.clone());
    bench.model.focus_on(Pane::Presets);
    bench.model.library.select_place(&TreePlace::Builtin("fir"));
    bench.keys("delete");
    assert!(bench.said().contains("built in"), "{}", bench.said());
    bench.model.library.select_place(&place);
    bench.model.library.step(-1);
    let last = bench.model.library.entry().unwrap().id.clone();
    bench.model.library.select_place(&place);
    bench.keys("n delete");
    let (buffer, _) = bench.paint(120, 40);
    assert!(
        text(&buffer).contains("remove 'mine'? y or n") && text(&buffer).contains("are lost"),
        "{}",
        text(&buffer)
    );
    bench.keys("enter n");
    assert!(bench.effects.is_empty() && bench.model.dialogs.is_empty());
    bench.keys("delete y");
    assert!(matches!(bench.effects.pop(), Some(Effect::Remove(other)) if other == path));
    let kept = crate::config::presets::put_away(&path).unwrap();
    bench.send(Msg::Removed(Ok((path, kept))));
    relist(&mut bench, dir.path());
    assert!(bench.model.library.places().all(|(_, other)| *other != place) && bench.model.tree.is_none());
    let neighbour = bench.model.library.entry().map(|entry| entry.id.clone());
    assert_eq!(neighbour.as_deref(), Some(last.as_str()), "the one before the last of the list");
    let loaded = bench.effects.iter().find_map(|effect| match effect {
        Effect::Load(TreePlace::Builtin(id)) => Some(*id),
        _ => None,
    });
    assert_eq!(loaded, Some(last.as_str()), "its neighbour is shown");
    assert!(bench.said().contains(".removed") && bench.said().contains("u (undo) brings it back"));
    // One key brings it back to where it was.
    bench.effects.clear();
    bench.keys("u");
    let [Effect::PutBack { kept, path }] = &bench.effects[..] else { panic!("{:?}", bench.effects) };
    crate::config::presets::put_back(kept, path).unwrap();
    let path = path.clone();
    bench.send(Msg::PutBack(Ok(path.clone())));
    assert!(matches!(&bench.effects[1], Effect::Load(other) if *other == place), "{:?}", bench.effects);
    assert!(path.exists() && bench.said().starts_with("brought back"), "{}", bench.said());
    bench.keys("u");
    assert!(!matches!(bench.effects.last(), Some(Effect::PutBack { .. })), "once");
}

#[test]
fn a_preset_is_renamed_and_keeps_all_that_is_known_of_it() {
    let (dir, path, mut bench) = own_preset();
    bench.on("points").keys("right");
    bench.model.focus_on(Pane::Presets);
    bench.model.library.select_place(&TreePlace::Builtin("fir"));
    bench.keys("r");
    assert!(bench.said().contains("only presets of yours"), "{}", bench.said());
    bench.model.library.select_place(&TreePlace::File(path.clone()));
    bench.model.library.toggle_favourite();
    bench.model.library.tag(vec!["hedge".to_owned()]);
    let turned = bench.value("points");
    // A name that no file can have is told, and Enter takes it not.
    bench.keys("f2").typed("/x").keys("enter");
    assert!(text(&bench.paint(120, 40).0).contains("cannot be the name of 'mine'"));
    bench.keys("ctrl-u").typed("yours").keys("enter");
    let Some(Effect::Rename { path: asked, id }) = bench.effects.pop() else { panic!("{:?}", bench.effects) };
    assert_eq!((&asked, id.as_str()), (&path, "yours"));
    let to = crate::config::presets::rename(&asked, &id).unwrap();
    bench.send(Msg::Renamed(Ok((path, to.clone()))));
    assert!(bench.said().contains("renamed to 'yours'"), "{}", bench.said());
    relist(&mut bench, dir.path());
    let place = TreePlace::File(to);
    let entry = bench.model.library.entry().unwrap();
    assert_eq!((&entry.place, entry.id.as_str(), entry.is_gone), (&place, "yours", false));
    assert!(bench.model.library.is_favourite(entry) && bench.model.library.given_tags() == ["hedge"]);
    assert_eq!((&bench.tree().place, bench.value("points")), (&place, turned.clone()));
    assert!(bench.tree().is_modified() && bench.tree().preset().id == "yours");
    // Read again, as when its folder is watched, it says nothing new.
    let steps = bench.tree().steps();
    let TreePlace::File(to) = &place else { unreachable!() };
    let read = crate::source::forest::AnySource::read(to, &Quiet).unwrap();
    bench.model.loading = Some(place.clone());
    bench.send(Msg::Loaded(place.clone(), Ok(read)));
    assert!(bench.said().contains("renamed to 'yours'"), "{}", bench.said());
    assert_eq!((bench.tree().steps(), bench.value("points")), (steps, turned));
    assert_eq!((bench.tree().preset().id.as_str(), bench.tree().preset().name.as_str()), ("yours", "yours"));
    assert!(!bench.tree().is_overtaken);
}

#[test]
fn no_preset_is_renamed_to_one_that_is_known_though_its_file_is_gone() {
    let (dir, path, turned, mut bench) = own_preset_gone();
    let other = path.with_file_name("other.toml");
    std::fs::write(&other, DOCUMENT.replace("mine", "other")).unwrap();
    relist(&mut bench, dir.path());
    bench.model.focus_on(Pane::Presets);
    bench.model.library.select_place(&TreePlace::File(other));
    bench.keys("f2 ctrl-u").typed("mine").keys("enter");
    assert!(text(&bench.paint(120, 40).0).contains("there is one of that name"));
    bench.keys("esc");
    assert!(bench.effects.iter().all(|effect| !matches!(effect, Effect::Rename { .. })));
    assert_eq!(bench.value("points"), turned);
}

#[test]
fn only_presets_and_grammars_are_renamed() {
    let (dir, _, mut bench) = own_preset();
    bench.model.focus_on(Pane::Presets);
    for name in ["presets/stem.ply", "presets/.removed/mine.toml"] {
        let path = dir.path().join(name);
        bench.model.library.add_broken(path.clone(), "it is another test's");
        bench.model.library.select_place(&TreePlace::File(path));
        bench.keys("f2");
        assert!(bench.said().contains("only presets of yours") && bench.model.dialogs.is_empty(), "{name}");
    }
}

#[test]
fn what_is_being_read_is_read_from_its_new_name() {
    let (_dir, path, mut bench) = own_preset();
    let from = TreePlace::File(path.clone());
    let changes = crate::tui::tree::Changes { knobs: vec![("points".into(), "300".into())], whole: None };
    bench.model.loading = Some(from.clone());
    bench.model.changes = Some((from.clone(), changes));
    bench.model.library.begin_passing(Some(&from), None);
    let to = crate::config::presets::rename(&path, "yours").unwrap();
    bench.send(Msg::Renamed(Ok((path, to.clone()))));
    let to = TreePlace::File(to);
    assert!(bench.effects.iter().any(|effect| matches!(effect, Effect::Load(place) if *place == to)));
    assert_eq!(bench.model.loading.as_ref(), Some(&to));
    assert_eq!(bench.model.changes.as_ref().map(|(place, _)| place), Some(&to));
    assert_eq!(bench.model.library.passing.as_ref().and_then(|passing| passing.from.as_ref()), Some(&to));
}

#[test]
fn escape_gives_the_tree_and_the_cursor_back_from_the_filter() {
    use crate::tui::testing::Bench;
    let mut bench = Bench::new(120, 40).without_pictures().with_plain("simple");
    bench.run("preset-next");
    bench.settle();
    let cursor = |bench: &Bench| {
        let library = &bench.model.library;
        (bench.model.place().cloned(), library.selected_row(), library.before.clone())
    };
    let before = cursor(&bench);
    assert!(before.2.is_some());
    bench.keys("/");
    for c in ["f", "i", "r"] {
        bench.types(c).settle();
    }
    assert_eq!(bench.model.place(), Some(&TreePlace::Builtin("fir")));
    bench.keys("esc").settle();
    assert_eq!(cursor(&bench), before);
    // Taken, the tree before is the one that the filter was opened on, however many passed by.
    bench.keys("/").types("oa").settle();
    bench.keys("backspace backspace").types("fir").keys("enter").settle();
    assert_eq!(bench.model.place(), Some(&TreePlace::Builtin("fir")));
    assert_eq!(bench.model.library.before, before.0);
    // Given up before anything was read, nothing has changed either.
    let now = cursor(&bench);
    bench.keys("esc /").types("oak").keys("esc").settle();
    assert_eq!((cursor(&bench).0, cursor(&bench).2), (now.0, now.2));
}

#[test]
fn a_tree_whose_file_went_comes_back_whole_and_is_saved_anew() {
    let (dir, path, turned, bench) = own_preset_gone();
    let place = TreePlace::File(path.clone());
    assert_eq!(bench.tree().overrides(), None, "the session has all of it");
    let whole = bench.tree().recipe().to_line();
    let typing = |bench: &mut FormBench| {
        bench.keys("s");
        let shown = text(&bench.paint(120, 40).0);
        assert!(shown.contains("goes to ") && !shown.contains("you will be asked"), "{shown}");
        bench.keys("enter");
        let Some(Effect::Save { id, from, recipe, overwrite, .. }) = bench.effects.pop() else { panic!() };
        crate::tui::shape::save::write(path.parent().unwrap(), &id, &from, &recipe, overwrite)
    };
    // The next start.
    let mut next = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    next.model.tree = None;
    let changes = crate::tui::tree::Changes { knobs: Vec::new(), whole: Some(whole) };
    next.model.library.expect(place.clone(), changes);
    next.model.library.select_place(&place);
    next.model.loading = Some(place.clone());
    next.send(Msg::Gone(place.clone(), "no such file".to_owned()));
    assert!(next.said().contains("writes it anew"), "{}", next.said());
    assert_eq!((&next.tree().place, next.value("points")), (&place, turned.clone()));
    assert!(next.tree().is_modified());
    let saved = typing(&mut next);
    next.send(Msg::Saved(saved));
    assert!(std::fs::read_to_string(&path).unwrap().contains(&turned));
    assert!(!next.tree().is_modified());
    // It goes again, while it is on screen and changed.
    next.on("points").keys("right");
    std::fs::remove_file(&path).unwrap();
    next.model.loading = Some(place.clone());
    next.send(Msg::Gone(place.clone(), "no such file".to_owned()));
    assert!(next.said().starts_with("your changes are kept"), "{}", next.said());
    assert!(next.model.loading.is_none() && next.tree().overrides().is_none());
    // Of knobs alone no tree can be made: why is said.
    let mut next = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    next.model.tree = None;
    let changes = crate::tui::tree::Changes { knobs: vec![("points".into(), "300".into())], whole: None };
    next.model.library.expect(place.clone(), changes);
    next.model.library.select_place(&place);
    next.model.loading = Some(place.clone());
    next.send(Msg::Gone(place.clone(), "no such file".to_owned()));
    next.keys("s");
    assert!(next.said().contains("no such file") && next.said().contains(".removed"), "{}", next.said());
}

#[test]
fn one_that_was_removed_is_saved_where_it_was() {
    let (dir, path, mut bench) = own_preset();
    let kept = crate::config::presets::put_away(&path).unwrap().unwrap();
    relist(&mut bench, dir.path());
    bench.model.tree.as_mut().unwrap().place = TreePlace::File(kept.clone());
    let proposed = |bench: &FormBench, from: &Path| {
        crate::tui::shape::save::proposed(&bench.model, "mine", &TreePlace::File(from.to_owned()))
    };
    assert_eq!(proposed(&bench, &kept), "mine");
    let elsewhere = dir.path().join("other/.removed/bush.toml");
    assert_eq!(proposed(&bench, &elsewhere), dir.path().join("other/bush.toml").to_str().unwrap());
}

#[test]
fn a_click_moves_nothing_under_the_pointer() {
    use crossterm::event::{MouseButton, MouseEventKind};

    use crate::tui::layout::Target;
    use crate::tui::testing::Bench;
    let mut bench = Bench::new(120, 30).without_pictures().with_plain("simple");
    let rows = |bench: &Bench| -> Vec<(u16, usize)> {
        let of_list = bench.model.regions.iter();
        let mut rows: Vec<_> = of_list
            .filter_map(
                |(area, target)| if let Target::Preset(row) = target { Some((area.y, *row)) } else { None },
            )
            .collect();
        rows.sort_unstable();
        rows
    };
    let before = rows(&bench);
    // A row in the upper half, and one in the lower.
    for place in [2, before.len() / 2 + 2] {
        let before = rows(&bench);
        let (y, row) = before[place];
        bench.mouse(MouseEventKind::Down(MouseButton::Left), 3, y);
        let now = rows(&bench);
        assert!(now.contains(&(y, row)), "{row} at {y}: {now:?}");
        let chosen = bench.model.library.entry().map(|entry| entry.id.clone());
        bench.mouse(MouseEventKind::Down(MouseButton::Left), 3, y);
        assert_eq!(
            bench.model.library.entry().map(|entry| entry.id.clone()),
            chosen,
            "twice is the same row"
        );
    }
}

#[test]
fn a_file_that_cannot_be_read_is_what_the_list_shows() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("broken.txt");
    std::fs::write(&path, "axiom = A\nA -> F[+A\n").unwrap();
    let mut bench = FormBench::at(TreePlace::Builtin("fir"), dir.path().to_owned());
    bench.model.tree = None;
    let place = TreePlace::File(path.clone());
    bench.model.loading = Some(place.clone());
    let why = crate::source::forest::AnySource::read(&path, &Quiet).err().unwrap();
    bench.send(Msg::Loaded(place.clone(), Err(crate::exit::sentence(&why))));
    assert_eq!(bench.model.library.entry().map(|entry| &entry.place), Some(&place));
    assert!(bench.said().contains("2:7") && bench.said().contains('['), "{}", bench.said());
    let (buffer, _) = bench.paint(120, 40);
    // In the picture's place stands why; the knobs have nothing else to say.
    let text = text(&buffer);
    assert!(text.matches("choose a preset").count() == 1 && text.contains("that is never closed"), "{text}");
}
