//! Knobs that are looked for by their names.

use super::*;

#[test]
fn a_knob_is_found_by_letters_of_its_name() {
    let mut bench = FormBench::new("dressed-simple");
    bench.on("points").keys("/").typed("lefo");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("leaf_form")));
    bench.keys("enter");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("leaf_form")));
    bench.keys("/").typed("season").keys("esc");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("leaf_form")), "given up");
    bench.keys("/").typed("zzq");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("leaf_form")));
    let (buffer, _) = bench.paint(100, 30);
    assert!(text(&buffer).contains("no knob matches"));
    // In the list the same key filters presets.
    bench.keys("esc").model.focus_on(Pane::Presets);
    bench.keys("/").typed("oak");
    assert_eq!(bench.model.library.filter, "oak");
}

#[test]
fn the_palette_turns_knobs_and_shows_presets() {
    let mut bench = FormBench::new("dressed-simple");
    bench.keys(":").typed("season 0.8\n");
    assert_eq!((bench.value("season"), bench.model.dialogs.is_empty()), ("0.8".to_owned(), true));
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("season")));
    // What a knob does not take is said, and the palette stays.
    bench.keys(":").typed("season 8\n");
    assert!(bench.said().contains("season") && !bench.model.dialogs.is_empty(), "{}", bench.said());
    assert_eq!(bench.value("season"), "0.8");
    bench.keys("esc");
    // A name alone goes there.
    bench.model.focus_on(Pane::Presets);
    bench.keys(":").typed("leaf_form\n");
    let at = (bench.model.focus, bench.model.form.selected);
    assert_eq!(at, (Pane::Shape, Some(FormSpot::Knob("leaf_form"))));
    bench.keys(":").typed("weeping-w\n");
    let shown = bench.model.library.entry().map(|entry| entry.id.clone());
    assert_eq!(shown.as_deref(), Some("weeping-willow"));
    assert_eq!(bench.model.loading, Some(TreePlace::Builtin("weeping-willow")));
}

#[test]
fn a_knob_is_found_by_its_whole_name_and_arrows_go_through_the_others() {
    let mut bench = FormBench::new("silver-birch");
    bench.keys("/").typed("age");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("age")));
    bench.keys("down");
    let second = bench.model.form.selected;
    assert_ne!(second, Some(FormSpot::Knob("age")));
    bench.keys("up");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("age")));
    bench.keys("down enter");
    assert_eq!(bench.model.form.selected, second);
}
