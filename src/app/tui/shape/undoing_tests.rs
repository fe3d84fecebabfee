//! Undo and redo: what is said, and where the cursor is afterwards.

use linden::Quiet;

use super::save;
use crate::tui::effect::Effect;
use crate::tui::testing::Bench;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::tree::TreePlace;
use crate::tui::update::Msg;

#[test]
fn what_is_undone_is_said_and_the_cursor_goes_there() {
    let mut bench = FormBench::new("fir");
    bench.on("points").keys("right");
    let turned = bench.value("points");
    bench.on("seed").keys("u");
    assert_eq!(bench.said(), format!("undone: points {turned} → 1000"));
    assert_eq!(super::selected(&bench.model).unwrap().0.knob.name, "points");
    bench.on("seed").keys("ctrl-r");
    assert_eq!(bench.said(), format!("done again: points 1000 → {turned}"));
    assert_eq!(super::selected(&bench.model).unwrap().0.knob.name, "points");
    // Several at once.
    bench.on("seed").keys("right R");
    assert_eq!(bench.said(), "all as the saved preset has it; 'Undo' brings your changes back");
    bench.keys("u");
    assert_eq!(bench.said(), format!("undone: seed 1 → 2, points 1000 → {turned}"));
    assert_eq!(super::selected(&bench.model).unwrap().0.knob.name, "seed");
}

#[test]
fn seeds_one_goes_through_fast_are_steps_of_their_own() {
    let mut bench = Bench::new(120, 40).with_plain("fir").without_pictures();
    bench.keys("n n u");
    assert_eq!(bench.model.tree.as_ref().unwrap().preset().seed(), 2);
    let said = &bench.model.message.as_ref().unwrap().text;
    assert_eq!(said, "undone: seed 3 → 2");
}

#[test]
fn changes_are_saved_before_the_file_is_opened_where_that_is_wanted() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    let document =
        "id = \"bush\" # mine\nname = \"Bush\"\n\n[colonization]\ncrown = \"sphere\"\npoints = 200\n";
    std::fs::write(&path, document).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    bench.keys("E");
    assert!(matches!(bench.effects.pop(), Some(Effect::EditFile(_))), "nothing was changed");
    bench.on("points").keys("right E");
    let (buffer, _) = bench.paint(100, 24);
    assert!(text(&buffer).contains("save first? y or n"), "{}", text(&buffer));
    bench.keys("enter esc");
    assert!(bench.effects.is_empty() && bench.model.dialogs.is_empty());
    bench.keys("E n");
    assert!(matches!(bench.effects.pop(), Some(Effect::EditFile(_))));
    bench.keys("E y");
    let Some(Effect::WriteBack { path, recipe }) = bench.effects.pop() else { panic!("not saved") };
    bench.send(Msg::Saved(save::write_back(&path, &recipe)));
    assert!(!bench.tree().is_modified());
    let now = std::fs::read_to_string(&path).unwrap();
    assert_eq!(now, document.replace("200", &bench.value("points")), "its id and name stay, too");
    let read = crate::source::resolve(&path, &[], &Quiet).unwrap();
    assert!(read.recipe.preset == *bench.tree().preset());
}

#[test]
fn finding_a_knob_says_how_many_there_are_and_goes_round() {
    let mut bench = Bench::new(120, 40).with_plain("fir").without_pictures();
    bench.keys("shift-tab /").types("height");
    let spot = |bench: &Bench| bench.model.form.selected;
    let row = |bench: &Bench| bench.screen().lines().rev().nth(1).unwrap().trim().to_owned();
    let (first, said) = (spot(&bench), row(&bench));
    let count: usize = said.strip_prefix("1 of ").unwrap_or_else(|| panic!("{said}")).parse().unwrap();
    assert!(count > 1);
    bench.keys("up");
    assert_eq!(row(&bench), format!("{count} of {count}"), "from the first to the last");
    bench.keys("down");
    assert_eq!((spot(&bench), row(&bench)), (first, said));
}
