//! Knobs that are turned, typed, reset and compared.

use super::*;

#[test]
fn keys_go_through_the_form_and_turn_knobs() {
    let mut bench = FormBench::new("fir");
    assert_eq!(bench.value("seed"), "1");
    bench.keys("right right left L");
    assert_eq!(bench.value("seed"), "12");
    bench.keys("j");
    let below = selected(&bench.model).unwrap().0.knob.name;
    assert_ne!(below, "seed");
    bench.keys("k");
    assert_eq!(selected(&bench.model).unwrap().0.knob.name, "seed");
    bench.keys("G");
    assert_eq!(selected(&bench.model).unwrap().0.knob.name, "gustiness");
    bench.keys("pageup pageup pageup pageup pageup pagedown g");
    assert_eq!(selected(&bench.model).unwrap().0.knob.name, "seed");
    bench.on("points").keys("alt-right");
    assert_eq!(bench.value("points"), "1002");
    bench.keys("alt-left H");
    assert_eq!(bench.value("points"), "800");
}

#[test]
fn a_value_is_typed_and_what_is_wrong_is_said_at_once() {
    let mut bench = FormBench::new("fir");
    bench.on("kill").keys("enter ctrl-u").typed("17D").keys("enter");
    assert_eq!(bench.value("kill"), "17D");
    bench.keys("i ctrl-u").typed("-1");
    let problem = bench.problem().unwrap();
    assert!(problem.contains("outside the range"), "{problem}");
    // What is wrong is not taken, and the line stays.
    bench.keys("enter");
    assert_eq!(bench.value("kill"), "17D");
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty());
    bench.on("step").keys("enter ctrl-u").typed("au").keys("enter");
    assert_eq!(bench.value("step"), "auto");
    assert_eq!(bench.tree().overrides().unwrap().len(), 2);
}

#[test]
fn choices_are_completed_while_they_are_typed_and_switches_flip() {
    let mut bench = FormBench::new("fir");
    bench.on("crown").keys("enter ctrl-u").typed("cyl");
    assert_eq!(bench.problem(), None);
    let (buffer, _) = bench.paint(100, 40);
    assert!(text(&buffer).contains("cylinder"));
    bench.keys("enter");
    assert_eq!(bench.value("crown"), "cylinder");
    bench.keys("enter down");
    bench.keys("enter");
    assert_ne!(bench.value("crown"), "cylinder");
    let before = bench.value("leaf_terminal");
    bench.on("leaf_terminal").keys("enter");
    assert_ne!(bench.value("leaf_terminal"), before);
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn reset_revert_compare_undo_and_redo() {
    let mut bench = FormBench::new("fir");
    bench.keys("r");
    assert_eq!(bench.said(), "Reset: this is as saved");
    bench.on("points").keys("right right").on("seed").keys("right");
    bench.keys("r");
    assert_eq!((bench.value("seed"), bench.value("points")), ("1".to_owned(), "1040".to_owned()));
    bench.keys("b");
    assert!(bench.tree().compares);
    assert!(Arc::ptr_eq(bench.tree().wanted(), bench.tree().saved()));
    let (buffer, _) = bench.on("points").paint(100, 40);
    let shown = text(&buffer);
    assert!(shown.contains("○ as saved") && shown.contains("yours: 1040"), "{shown}");
    bench.keys("b R");
    assert!(!bench.tree().is_modified());
    bench.keys("u");
    assert_eq!(bench.value("points"), "1040");
    bench.keys("u u u u");
    assert!(!bench.tree().is_modified() && !bench.tree().can_undo());
    bench.keys("ctrl-r ctrl-r");
    assert_eq!(bench.value("points"), "1040");
    bench.keys("ctrl-r ctrl-r ctrl-r ctrl-r");
    assert_eq!(bench.said(), "Redo: nothing was undone");
}

#[test]
fn what_was_changed_is_listed_alone_on_a_key() {
    let mut bench = FormBench::new("fir");
    bench.on("points").keys("*");
    assert!(bench.said().contains("nothing differs"), "{}", bench.said());
    bench.keys("right").on("leaf_form").keys("right").on("points").keys("*");
    let shown = |bench: &mut FormBench| text(&bench.paint(120, 40).0);
    let screen = shown(&mut bench);
    assert!(screen.contains("●points") && screen.contains("●leaf_form"), "{screen}");
    assert!(!screen.contains(" seed  ") && !screen.contains("influence"), "{screen}");
    // Down goes to the next that was changed; a knob that is looked for brings all back.
    bench.keys("down");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("leaf_form")));
    bench.keys("/").typed("influ").keys("enter");
    assert!(shown(&mut bench).contains("influence"));
    bench.keys("* u u");
    assert!(shown(&mut bench).contains("nothing differs"), "{}", shown(&mut bench));
    bench.keys("*");
    assert!(shown(&mut bench).contains("influence"));
}

#[test]
fn what_is_typed_takes_the_place_of_the_value_unless_one_moves_in_it_first() {
    let mut bench = FormBench::new("fir");
    bench.on("points").keys("enter").typed("55").keys("enter");
    assert_eq!(bench.value("points"), "55");
    bench.keys("enter end").typed("5").keys("enter");
    assert_eq!(bench.value("points"), "555");
    bench.keys("enter backspace").typed("7").keys("enter");
    assert_eq!(bench.value("points"), "7");
}

#[test]
fn a_range_with_two_ends_has_a_slider() {
    let mut bench = FormBench::new("oak");
    bench.on("season");
    let screen = text(&bench.paint(120, 40).0);
    assert!(screen.contains("●───") || screen.contains("━●"), "{screen}");
}

#[test]
fn what_is_auto_is_nudged_from_what_it_is_now() {
    let mut bench = FormBench::new("fir");
    bench.on("base_radius").keys("enter ctrl-u").typed("auto").keys("enter").grow();
    assert_eq!(bench.value("base_radius"), "auto");
    let (buffer, _) = bench.paint(100, 40);
    assert!(text(&buffer).contains("0.177 m"), "{}", text(&buffer));
    bench.keys("right");
    let value: f64 = bench.value("base_radius").parse().unwrap();
    let grown = f64::from(bench.tree().shown.as_ref().unwrap().grown.skeleton.radii[0]);
    assert!((value / grown - 1.0).abs() < 0.06, "{value} {grown}");
    bench.on("trunk").keys("enter ctrl-u").typed("auto").keys("enter right");
    assert!(bench.said().contains("trunk is typed"), "{}", bench.said());
}

#[test]
fn a_nudge_moves_a_spread_and_keeps_its_width() {
    let mut bench = FormBench::new("fir");
    for (knob, typed, up, down) in [
        ("base_radius", "0.2 ± 0.02", "0.205 ± 0.02", "0.195 ± 0.02"),
        ("trunk", "2..3", "2.05..3.05", "1.95..2.95"),
        ("points", "5000..6000", "5100..6100", "4900..5900"),
    ] {
        for (key, expected) in [("right", up), ("left", down)] {
            bench.on(knob).keys("enter ctrl-u").typed(typed).keys(&format!("enter {key}"));
            let preset = bench.tree().preset();
            let row = preset.find_knob(knob).unwrap();
            assert_eq!(preset.text_of(&row).as_deref(), Some(expected), "{}", bench.said());
        }
    }
}

#[test]
fn a_tree_that_cannot_grow_marks_the_knob() {
    for (preset, sets, culprit) in [
        ("abop-a", &[("derivations", "30")][..], "derivations"),
        ("abop-a", &[("derivations", "0"), ("symbol_limit", "1")], "derivations"),
        ("abop-stochastic", &[("derivations", "40")], "derivations"),
        ("fir", &[("base_radius", "0.001"), ("tip_radius", "0.1")], "base_radius"),
        ("fir", &[("kill", "0.001")], "kill"),
        ("fir", &[("influence", "1D")], "influence"),
        ("fir", &[("trunk", "1000"), ("max_nodes", "100")], "trunk"),
    ] {
        let mut bench = FormBench::new(preset);
        for (name, value) in sets {
            let now = bench.model.now;
            bench.model.tree.as_mut().unwrap().set(name, value, now).unwrap();
        }
        bench.grow();
        let Some(fault) = bench.tree().fault.clone() else {
            assert_eq!(sets[0].1, "0", "{preset} {sets:?}");
            continue;
        };
        assert_eq!(view::culprit(bench.tree()), Some(culprit), "{fault}");
        let (buffer, _) = bench.on(culprit).paint(100, 40);
        let shown = text(&buffer);
        assert!(shown.contains(&format!("✗{culprit}")), "{shown}");
        // The last good tree stays, and turning back heals.
        bench.keys("R").grow();
        assert_eq!(bench.tree().fault, None);
    }
}

/// Presses the mouse on what means `wanted`.
fn press_on(bench: &mut FormBench, wanted: Target) {
    let (_, view) = bench.paint(120, 60);
    let (area, _) = *view.regions.iter().rev().find(|(_, target)| *target == wanted).unwrap();
    bench.press(area.x + 1, area.y);
}

/// The row of a knob.
fn row_of(bench: &FormBench, name: &str) -> Target {
    let rows = listed(&bench.model, bench.tree());
    let at = rows
        .iter()
        .position(|row| row.spot().is_some_and(|spot| matches!(spot, FormSpot::Knob(it) if it == name)));
    Target::Knob(at.unwrap())
}

#[test]
fn a_click_on_another_knob_takes_what_was_typed_for_the_first_one() {
    let mut bench = FormBench::new("silver-birch");
    let internode = bench.value("internode");
    bench.on("age").keys("enter ctrl-u").typed("0.5");
    let row = row_of(&bench, "internode");
    press_on(&mut bench, row);
    assert_eq!((bench.value("age").as_str(), bench.value("internode")), ("0.5", internode.clone()));
    assert!(bench.model.dialogs.is_empty());
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("internode")));
    // What cannot be taken is given up.
    bench.on("age").keys("enter ctrl-u").typed("zzz");
    let row = row_of(&bench, "internode");
    press_on(&mut bench, row);
    assert_eq!((bench.value("age").as_str(), bench.value("internode")), ("0.5", internode));
    assert!(bench.model.dialogs.is_empty());
    // In the line itself the mouse ends nothing.
    bench.on("age").keys("enter");
    bench.paint(120, 60);
    let (column, line) = bench.paint(120, 60).1.cursor.unwrap();
    bench.press(column, line);
    assert!(bench.model.dialogs.top::<value::ValueLine>().is_some());
}

#[test]
fn a_choice_that_brings_other_knobs_leaves_the_click_on_the_knob_that_was_meant() {
    let mut bench = FormBench::new("fir");
    bench.on("crown").keys("enter ctrl-u").typed("cylinder");
    let row = row_of(&bench, "kill");
    press_on(&mut bench, row);
    assert_eq!(bench.value("crown"), "cylinder");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("kill")));
}

#[test]
fn saving_and_exporting_end_the_comparison() {
    for key in ["s", "y", "Y", "e"] {
        let mut bench = FormBench::new("fir");
        bench.on("seed").keys("right b");
        assert!(bench.tree().compares);
        bench.keys(key);
        assert!(!bench.tree().compares, "{key}");
        assert_eq!(bench.tree().wanted().preset.seed(), 2, "{key}");
    }
}

#[test]
fn a_tree_that_did_not_grow_is_not_shown_as_if_it_had() {
    let mut bench = FormBench::new("older-c");
    bench.grow();
    let shown = |bench: &mut FormBench| text(&bench.paint(120, 30).0);
    assert!(shown(&mut bench).contains(" m tall"));
    bench.on("seed").keys("right");
    let grows = shown(&mut bench);
    assert!(grows.contains("seed 2") && !grows.contains(" m tall"), "figures of another seed:\n{grows}");
    bench.send(Msg::Grown(Err("points: nothing to reach".to_owned())));
    let failed = shown(&mut bench);
    assert_eq!(failed.matches("✗ did not grow").count(), 2, "the title and the picture's heading:\n{failed}");
}

#[test]
fn only_what_keys_turn_offers_more_and_less() {
    let mut bench = FormBench::new("silver-birch");
    let offered = |bench: &FormBench| {
        let hints = crate::tui::chrome::footer::hints(&bench.model);
        hints.iter().map(|hint| hint.command.id).filter(|id| id.starts_with("knob-")).collect::<Vec<_>>()
    };
    assert!(offered(bench.on("seed")).contains(&"knob-more"));
    let color = bench.tree().preset().knobs().into_iter();
    let color = color.map(|(row, _)| row.knob).find(|knob| matches!(knob.kind, Kind::Color { .. })).unwrap();
    let offers = offered(bench.on(color.name));
    assert!(!offers.contains(&"knob-more") && !offers.contains(&"knob-less"), "{offers:?}");
    assert!(offers.contains(&"knob-type"), "{offers:?}");
}

#[test]
fn what_opens_shows_its_keys_and_not_what_was_said_before() {
    let mut bench = FormBench::new("fir");
    bench.keys("*");
    assert!(!bench.said().is_empty());
    bench.keys("e");
    assert_eq!(bench.said(), "");
}
