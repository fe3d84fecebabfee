//! The room's commands through its keys, its views, and what undo promises.

use std::sync::Arc;
use std::time::Duration;

use crossterm::event::Event;
use proptest::prelude::*;
use ratatui::style::Modifier;

use super::*;
use crate::config::theme::Theme;
use crate::tui::effect::Effect;
use crate::tui::layout::Target;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::testing::key_event;
use crate::tui::update::Msg;

/// The open editor.
fn editor(bench: &FormBench) -> Option<&grammar::GrammarEditor> {
    bench.model.dialogs.top()
}

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
fn keys_that_are_held_are_one_step_of_undo_and_there_and_back_is_none() {
    let mut bench = FormBench::new("fir");
    let now = bench.model.now;
    let press = |bench: &mut FormBench, key: &str, ms| {
        let event = key_event(key);
        crate::tui::update::update(&mut bench.model, Msg::Input(event), now + Duration::from_millis(ms));
    };
    bench.on("points");
    press(&mut bench, "right", 0);
    press(&mut bench, "right", 300);
    press(&mut bench, "right", 900);
    assert_eq!(bench.value("points"), "1060");
    bench.keys("u");
    assert!(!bench.tree().is_modified() && !bench.tree().can_undo());
    press(&mut bench, "right", 5000);
    press(&mut bench, "left", 5100);
    assert!(!bench.tree().can_undo());
    // The same value typed again is no change that the next one could join.
    press(&mut bench, "right", 9000);
    bench.model.tree.as_mut().unwrap().set("seed", "1", now + Duration::from_secs(20)).unwrap();
    bench.model.tree.as_mut().unwrap().set("seed", "7", now + Duration::from_millis(20_100)).unwrap();
    bench.keys("u");
    assert_eq!((bench.value("seed"), bench.value("points")), ("1".to_owned(), "1020".to_owned()));
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

#[test]
fn the_grammar_is_edited_in_place_and_grows_as_it_is_typed() {
    let mut bench = FormBench::new("abop-a");
    let before = bench.tree().grammar().unwrap().clone();
    bench.keys("x");
    assert!(editor(&bench).is_some());
    bench.keys("down end").typed("[+F]");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
    // What cannot be read keeps the last good grammar, and says where.
    bench.typed("[+F");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
    let (buffer, view) = bench.paint(100, 30);
    let shown = text(&buffer);
    assert!(shown.contains("line 2, column 21: '[' opens a branch that is never closed"), "{shown}");
    let (x, y) = underlined(&buffer).unwrap();
    assert_eq!(buffer[(x, y)].symbol(), "[");
    assert_eq!(view.cursor, Some((x + 3, y)));
    // Done goes to the mistake instead of closing.
    bench.keys("ctrl-s");
    assert_eq!(editor(&bench).unwrap().text.cursor(), (1, 20));
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty() && bench.said().contains("last rules"));
    // The text is there again with its mistake; mended, it grows.
    bench.keys("x end").typed("]").keys("ctrl-s");
    assert!(bench.model.dialogs.is_empty());
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F][+F]\n");
    // Each editing is one step of undo.
    bench.keys("u u");
    assert!(*bench.tree().grammar().unwrap() == before && !bench.tree().can_undo());
    bench.keys("ctrl-r");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
}

/// The cell where the text is wrong.
fn underlined(buffer: &ratatui::buffer::Buffer) -> Option<(u16, u16)> {
    let area = buffer.area;
    let mut cells = (0..area.height).flat_map(|y| (0..area.width).map(move |x| (x, y)));
    let is_wrong =
        |&(x, y): &(u16, u16)| buffer[(x, y)].modifier.contains(Modifier::UNDERLINED | Modifier::BOLD);
    cells.rfind(is_wrong)
}

#[test]
fn the_editors_own_undo_revert_and_comments() {
    let mut bench = FormBench::new("abop-a");
    let before = bench.tree().grammar().unwrap().clone();
    bench.keys("x ctrl-u");
    assert_eq!(bench.said(), "Undo typing: nothing was typed");
    bench.keys("ctrl-end").typed("// mine\n\n");
    bench.send(Msg::Input(Event::Paste("G -> FF\r\nX -> G\n".to_owned())));
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 3);
    bench.keys("ctrl-u");
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 1);
    bench.keys("ctrl-r");
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 3);
    bench.keys("ctrl-x");
    assert!(*bench.tree().grammar().unwrap() == before);
    bench.keys("ctrl-u esc x");
    let text = editor(&bench).unwrap().text.as_str().to_owned();
    assert!(text.contains("// mine\n\nG -> FF\nX -> G\n"), "comments stay with the tree: {text}");
    // Keys that mean something outside are letters here, and nothing panics on any of them.
    bench.keys("q u E / : ? tab f1 f1 f12 insert alt-x");
    assert!(editor(&bench).is_some());
    bench.keys("ctrl-c");
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn enter_on_a_rule_opens_the_editor_there_and_r_gives_the_saved_grammar_back() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.on("derivations").keys("k k");
    let rule = selected_rule(&bench.model).unwrap();
    assert!(selected(&bench.model).is_none() && rule >= 2);
    bench.keys("right");
    assert!(bench.said().contains("typed"));
    bench.keys("enter");
    let (line, column) = editor(&bench).unwrap().text.cursor();
    assert_eq!(line, rule);
    assert!(column > 5);
    bench.typed("F").keys("esc");
    assert!(bench.tree().is_modified());
    let (buffer, _) = bench.paint(100, 40);
    assert!(text(&buffer).contains("●F ->"), "{}", text(&buffer));
    bench.keys("r");
    assert!(!bench.tree().is_modified());
}

#[test]
fn the_mouse_selects_rows_opens_them_and_puts_the_cursor_into_the_text() {
    let mut bench = FormBench::new("abop-a");
    let (buffer, _) = bench.paint(100, 30);
    let lines: Vec<String> = text(&buffer).lines().map(str::to_owned).collect();
    let row = lines.iter().position(|line| line.contains("F -> F[+F]F[-F]F")).unwrap() as u16;
    bench.press(10, row);
    assert_eq!(selected_rule(&bench.model), Some(1));
    bench.press(10, row);
    assert!(editor(&bench).is_some());
    let (_, view) = bench.paint(100, 30);
    let (area, _) = *view
        .regions
        .iter()
        .rev()
        .find(|(_, target)| *target == crate::tui::layout::Target::Dialog(Some(grammar::TEXT)))
        .unwrap();
    bench.press(area.x + 3, area.y);
    assert_eq!(editor(&bench).unwrap().text.cursor(), (0, 3));
    bench.press(area.right() - 1, area.bottom() - 1);
    assert_eq!(editor(&bench).unwrap().text.cursor().0, 2);
}

#[test]
fn an_editor_of_ones_own_takes_the_text_and_loses_nothing() {
    let mut bench = FormBench::new("abop-a");
    bench.keys("E");
    let Some(Effect::Edit(handed)) = bench.effects.pop() else { panic!("no text was handed over") };
    assert!(handed.starts_with("// ") && handed.ends_with("axiom = F\nF -> F[+F]F[-F]F\n"), "{handed}");
    bench.send(Msg::Edited(Ok(handed.clone())));
    assert!(!bench.tree().is_modified() && bench.said() == "the grammar is as it was");
    bench.send(Msg::Edited(Ok(handed.replace("[-F]", "[-FF]"))));
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-FF]F\n");
    assert!(bench.model.dialogs.is_empty());
    bench.keys("u");
    assert!(!bench.tree().is_modified() && !bench.tree().can_undo());
    // A mistake comes back into linden's editor, with the whole text.
    bench.send(Msg::Edited(Ok(handed.replace("[-F]", "[-F"))));
    let opened = editor(&bench).unwrap();
    assert_eq!(opened.text.as_str(), "axiom = F\nF -> F[+F]F[-FF\n");
    assert_eq!(opened.text.cursor(), (1, 11));
    assert!(!bench.tree().is_modified());
    bench.keys("alt-e");
    let Some(Effect::Edit(handed)) = bench.effects.pop() else { panic!("no text was handed over") };
    bench.send(Msg::Edited(Ok(handed.replace("[-FF", "[-F]F"))));
    assert!(editor(&bench).unwrap().fault.is_none());
    bench.send(Msg::Edited(Err("the editor ended with 1".to_owned())));
    assert!(editor(&bench).is_some());
}

#[test]
fn colonized_trees_say_that_they_have_no_grammar() {
    let mut bench = FormBench::new("fir");
    bench.keys("x");
    assert_eq!(bench.said(), "Edit grammar: 'fir' grows without a grammar");
    bench.keys("E");
    assert_eq!(bench.said(), "Edit in $EDITOR: the preset is built in; save it as one of your own first");
    assert!(bench.effects.is_empty());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    std::fs::write(&path, linden::preset::builtin("fir").unwrap().text).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    bench.keys("E");
    assert!(
        matches!(&bench.effects[..], [Effect::EditFile(edited)] if *edited == path),
        "{:?}",
        bench.effects
    );
    let mesh = dir.path().join("crown.obj");
    std::fs::write(&mesh, linden::preset::builtin_file("heart.obj").unwrap()).unwrap();
    let mut bench = FormBench::at(TreePlace::File(mesh), dir.path().to_owned());
    bench.keys("E");
    assert!(bench.said().contains("a mesh or a scan") && bench.effects.is_empty(), "{}", bench.said());
}

/// Whatever is on the form, at the sizes that a pane has.
#[test]
fn the_form_at_three_sizes() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.on("derivations").keys("right");
    for (columns, rows) in [(38, 20), (20, 5), (60, 40)] {
        let (buffer, _) = bench.paint(columns, rows);
        insta::assert_snapshot!(format!("form_{columns}x{rows}"), text(&buffer));
    }
    let mut bench = FormBench::new("cypress");
    bench.on("profile").keys("enter");
    let (buffer, _) = bench.paint(44, 20);
    insta::assert_snapshot!("form_profile_typed", text(&buffer));
}

#[test]
fn the_editor_at_three_sizes() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.keys("x ctrl-end").typed("// F -> λ is no rule\nF -> F[+(3)F");
    for (columns, rows) in [(38, 20), (20, 5), (60, 40)] {
        let (buffer, _) = bench.paint(columns, rows);
        insta::assert_snapshot!(format!("editor_{columns}x{rows}"), text(&buffer));
    }
}

#[test]
fn every_theme_shows_the_cursor_what_was_changed_and_what_is_wrong() {
    for theme in [Theme::dark(), Theme::light(), Theme::plain(false)] {
        let mut bench = FormBench::new("abop-a");
        bench.model.config.theme = theme;
        bench.on("derivations").keys("right").on("angle");
        let (buffer, _) = bench.paint(100, 40);
        let lines: Vec<String> = text(&buffer).lines().map(str::to_owned).collect();
        let y = |name: &str| lines.iter().position(|line| line.contains(name)).unwrap() as u16;
        let style = |name: &str, x: u16| buffer[(x, y(name))].style();
        // A usual knob, the one under the cursor, and the one that was turned: three looks, and marks.
        assert_ne!(style("segment_length", 3), style("angle ", 3));
        assert_ne!(style("segment_length", 21), style("derivations", 21));
        assert!(lines[usize::from(y("derivations"))].contains("●derivations"));
        bench.keys("x down end").typed("]");
        let (buffer, _) = bench.paint(100, 40);
        let (x, y) = underlined(&buffer).unwrap();
        assert_eq!(buffer[(x, y)].symbol(), "]");
    }
}

#[test]
fn nothing_panics_at_any_size() {
    for preset in ["abop-stochastic", "cypress"] {
        let mut bench = FormBench::new(preset);
        let scripts = ["", "enter", "esc x down end F [ ", "esc s", "/ u", "b"];
        for script in scripts {
            bench.keys(script);
            for columns in (1..40).chain([72, 110, 400]) {
                for rows in (1..14).chain([120]) {
                    bench.paint(columns, rows);
                }
            }
        }
    }
}

#[test]
fn what_a_file_says_does_not_reach_the_screen_raw() {
    let mut bench = FormBench::new("abop-a");
    bench.keys("x");
    bench.send(Msg::Input(Event::Paste("// \u{1b}[2J\u{202e}e\u{301}\u{200b}漢\n".to_owned())));
    let (buffer, _) = bench.paint(80, 24);
    let shown = text(&buffer);
    assert!(!shown.contains('\u{1b}') && !shown.contains('\u{202e}'), "{shown}");
    assert!(shown.contains("// ·[2J·e··漢"), "{shown}");
}

#[test]
fn a_grammar_of_any_length_is_listed_in_a_page() {
    let rules: Vec<String> = (0..5000)
        .map(|i| format!("{} -> {}", char::from_u32(0x4e00 + i).unwrap(), "F".repeat(900)))
        .collect();
    let grammar = linden::lsystem::Grammar::new("F", &rules).unwrap();
    let (listed, more) = grammar::lines(&grammar);
    assert_eq!((listed.len(), more), (101, 4900));
    assert!(listed.iter().all(|line| line.len() < 400));
}

#[derive(Clone, Debug)]
enum Deed {
    Key(&'static str),
    Type(&'static str, &'static str),
    Grammar(&'static str),
}

fn deeds() -> impl Strategy<Value = Vec<(Deed, u64)>> {
    let keys = prop::sample::select(vec![
        "right",
        "left",
        "L",
        "H",
        "alt-right",
        "j",
        "k",
        "G",
        "g",
        "r",
        "R",
        "b",
        "u",
        "u",
        "ctrl-r",
        "i esc",
        "x esc",
    ]);
    let values = prop::sample::select(vec![
        ("seed", "7"),
        ("seed", "1"),
        ("derivations", "2"),
        ("angle", "25.7"),
        ("angle", "nonsense"),
        ("bark", "birch"),
    ]);
    let texts = prop::sample::select(vec!["F", "[+F]", "]", "\n", "\n\n// F", "\nG -> F"]);
    let deed = prop_oneof![
        6 => keys.prop_map(Deed::Key),
        2 => values.prop_map(|(name, value)| Deed::Type(name, value)),
        1 => texts.prop_map(Deed::Grammar),
    ];
    prop::collection::vec((deed, prop::sample::select(vec![10_u64, 300, 5000])), 1..40)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Whatever is done to the form: each step back is another tree, the way back ends where it began,
    /// and the way forward leads through the same trees to what was on screen.
    #[test]
    fn undo_and_redo_walk_one_path(deeds in deeds()) {
        let mut bench = FormBench::new("abop-a");
        let start = bench.tree().preset().clone();
        for (deed, ms) in deeds {
            bench.model.now += Duration::from_millis(ms);
            let now = bench.model.now;
            let mut press = |names: &str| for name in names.split_whitespace() {
                let event = key_event(name);
                crate::tui::update::update(&mut bench.model, Msg::Input(event), now);
            };
            match deed {
                Deed::Key(keys) => press(keys),
                Deed::Type(name, value) => {
                    let before = bench.tree().preset().clone();
                    if bench.model.tree.as_mut().unwrap().set(name, value, now).is_err() {
                        prop_assert!(bench.tree().preset() == &before);
                    }
                }
                Deed::Grammar(text) => {
                    press("x ctrl-end backspace");
                    bench.typed(text);
                    bench.keys("esc");
                }
            }
            prop_assert!(bench.model.dialogs.is_empty());
        }
        let end = Arc::clone(bench.tree().recipe());
        let tree = bench.model.tree.as_mut().unwrap();
        let mut path = Vec::new();
        while tree.can_redo() {
            tree.redo();
        }
        let last = Arc::clone(tree.recipe());
        while tree.can_undo() {
            let here = Arc::clone(tree.recipe());
            tree.undo();
            prop_assert!(tree.preset() != &here.preset, "a step that changes nothing");
            path.push(here);
        }
        prop_assert!(*tree.preset() == start && !tree.is_modified());
        for expected in path.iter().rev() {
            tree.redo();
            prop_assert!(Arc::ptr_eq(tree.recipe(), expected));
        }
        prop_assert!(Arc::ptr_eq(tree.recipe(), &last));
        prop_assert!(path.iter().any(|seen| Arc::ptr_eq(seen, &end)) || end.preset == start);
    }
}

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
fn a_line_is_painted_at_its_knob() {
    let mut bench = FormBench::new("fir");
    bench.on("points").keys("enter ctrl-u").typed("4321");
    bench.on("seed");
    let (buffer, _) = bench.paint(120, 60);
    let shown = text(&buffer);
    let row = shown.lines().find(|line| line.contains("4321")).unwrap();
    assert!(row.contains("points") && !row.contains("seed"), "{row}");
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
