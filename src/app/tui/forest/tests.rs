use std::path::{Path, PathBuf};

use super::*;
use crate::jobs::Subject;
use crate::tui::effect::Effect;
use crate::tui::testing::Bench;

/// A bench with the orchard chosen in its list, not read yet.
fn orchard(columns: u16, rows: u16) -> Bench {
    let mut bench = Bench::grown(columns, rows);
    bench.keys("/").types("orchard").keys("enter");
    bench
}

fn forest(bench: &Bench) -> &ForestOnScreen {
    bench.model.forest.as_ref().unwrap()
}

#[test]
fn a_forest_is_chosen_in_the_list_and_drawn_and_a_tree_takes_its_place_again() {
    let mut bench = orchard(120, 40);
    assert!(bench.model.tree.is_some(), "until it is read, what was there stays");
    bench.settle();
    assert!(bench.model.tree.is_none());
    let shown = Arc::clone(forest(&bench).shown.as_ref().unwrap());
    // What the command line says of it.
    let plan = linden::forest::builtin_forest("orchard").unwrap().load().unwrap();
    assert_eq!(shown.forest.layout, plan.layout);
    assert_eq!(shown.trees, 31);
    let painted = bench.model.picture.painted.as_ref().unwrap();
    assert!(matches!(&painted.request.subject, Subject::Forest(drawn) if Arc::ptr_eq(drawn, &shown)));
    let inked = bench.drawn.cells().iter().filter(|cell| cell.character != ' ').count();
    assert!(inked > 60, "{inked} cells");
    let screen = bench.screen();
    for text in ["Orchard", "31 trees", "3 of them grown", "40 m × 40 m", "spacing", "6 m", "apple", "100 %"]
    {
        assert!(screen.contains(text), "{text}:\n{screen}");
    }
    bench.keys("esc ;").settle();
    assert!(bench.model.forest.is_none());
    assert_eq!(bench.model.tree.as_ref().unwrap().preset().id, "abop-a");
}

#[test]
fn knobs_of_a_forest_are_turned_typed_undone_and_kept_on_the_shelf() {
    let mut bench = orchard(120, 40);
    bench.settle();
    let seed = forest(&bench).wanted().layout.seed;
    bench.keys("n");
    assert_eq!(forest(&bench).wanted().layout.seed, seed + 1);
    bench.keys(":").types("area 25").keys("enter").settle();
    assert_eq!(forest(&bench).wanted().layout.area_m, 25.0);
    assert_eq!(forest(&bench).overrides(), [("area", "25".to_owned()), ("seed", (seed + 1).to_string())]);
    let shown = forest(&bench).shown.as_ref().unwrap();
    assert!(Arc::ptr_eq(&shown.forest, forest(&bench).wanted()) && shown.trees < 31);
    // The palette has put the cursor there: typed anew, and wrong.
    bench.keys("tab tab").run("knob-type");
    bench.types("0");
    assert!(bench.screen().contains("1 to 10000"), "{}", bench.screen());
    bench.keys("enter esc");
    assert_eq!(forest(&bench).wanted().layout.area_m, 25.0);
    bench.run("knob-more");
    assert!(forest(&bench).wanted().layout.area_m > 25.0);
    bench.keys("u");
    assert_eq!(forest(&bench).wanted().layout.area_m, 25.0);
    // Trees are counted.
    bench.keys(":").types("trees 8").keys("enter").settle();
    bench.keys("tab tab").run("knob-more");
    assert_eq!(forest(&bench).wanted().layout.trees, Some(9));
    bench.keys("u u");
    // Another preset, and back: what was changed is still so.
    bench.keys(":").types("abop-b").keys("enter").settle();
    assert!(bench.model.forest.is_none());
    bench.keys(":").types("orchard").keys("enter").settle();
    assert_eq!(forest(&bench).wanted().layout.area_m, 25.0);
    bench.keys("u u");
    assert!(!forest(&bench).is_modified() && !forest(&bench).can_undo());
    bench.run("redo");
    assert!(forest(&bench).is_modified());
}

#[test]
fn what_is_for_one_tree_says_so() {
    let mut bench = orchard(120, 40);
    bench.settle();
    for id in ["statistics", "gallery", "wind-play", "compare"] {
        bench.run(id);
        let said = bench.model.message.as_ref().map(|message| message.text.clone()).unwrap_or_default();
        assert!(said.contains("a forest is on screen"), "{id}: {said}");
    }
    bench.effects.clear();
    bench.keys("y");
    let copied = bench.effects.iter().find_map(|effect| match effect {
        Effect::Copy(text) => Some(text.as_str()),
        _ => None,
    });
    assert_eq!(copied, Some("linden forest orchard -o orchard.glb"));
}

#[test]
fn a_forests_file_is_opened_and_its_mistakes_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| {
        let path = folder.path().join("grove.toml");
        std::fs::write(&path, text).unwrap();
        path
    };
    let open = |bench: &mut Bench, path: &Path| {
        let mut effects = Vec::new();
        crate::tui::library::open_path(&mut bench.model, path.to_str().unwrap(), &mut effects);
        bench.effects.extend(effects);
        bench.settle();
    };
    let mut bench = Bench::grown(120, 40);
    let path = write("area = 12\nspacing = 6\n[[tree]]\npreset = \"simple\"\n");
    open(&mut bench, &path);
    assert_eq!(forest(&bench).files(), std::slice::from_ref(&path) as &[PathBuf]);
    assert!(bench.model.library.entry().is_some_and(|entry| entry.id == "grove"));
    write("area = 12\nspacing = 6\n[[tree]]\npreset = \"simpel\"\n");
    bench.msg(crate::tui::update::Msg::Changed(vec![path.clone()]));
    bench.settle();
    let said = bench.model.message.as_ref().map(|message| message.text.clone()).unwrap_or_default();
    assert!(said.contains("simpel"), "{said}");
    assert!(forest(&bench).shown.is_some(), "the last good one stays");
    write("area = 30\nspacing = 6\n[[tree]]\npreset = \"simple\"\n");
    bench.msg(crate::tui::update::Msg::Changed(vec![path]));
    bench.settle();
    assert_eq!(forest(&bench).wanted().layout.area_m, 30.0);
}

#[test]
fn a_forest_is_saved_under_a_name() {
    let dir = tempfile::tempdir().unwrap();
    let mut bench = orchard(120, 40);
    bench.model.config.dirs.config = Some(dir.path().to_owned());
    bench.settle();
    bench.keys("n s");
    assert!(bench.screen().contains("save forest as: orchard-2"), "{}", bench.screen());
    let save = |bench: &mut Bench| {
        let Some(Effect::SaveForest { id, from, forest, overwrite, .. }) = bench.effects.pop() else {
            panic!("nothing is to be saved: {:?}", bench.effects)
        };
        let presets = bench.model.config.dirs.presets().unwrap();
        bench.msg(crate::tui::update::Msg::ForestSaved(super::save::write(
            &presets, &id, &from, &forest, overwrite,
        )));
        bench.settle();
    };
    bench.keys("enter");
    save(&mut bench);
    let path = dir.path().join("presets/orchard-2.toml");
    assert_eq!(forest(&bench).place, TreePlace::File(path.clone()));
    assert!(!forest(&bench).is_modified() && forest(&bench).wanted().name == "orchard-2");
    // Over itself, after a question.
    bench.keys("n s enter");
    assert!(bench.screen().contains("replace 'orchard-2'? y or n"), "{}", bench.screen());
    let seed = forest(&bench).wanted().layout.seed;
    bench.keys("y");
    save(&mut bench);
    assert!(std::fs::read_to_string(path).unwrap().contains(&format!("seed = {seed}")));
    assert!(!forest(&bench).is_modified());
}
