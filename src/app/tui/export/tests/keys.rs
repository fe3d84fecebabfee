//! Keys and the mouse in the dialog.

use crate::tui::command::Context;

use super::*;

#[test]
fn esc_leaves_the_line_and_then_the_dialog_and_nothing_is_kept() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let before = bench.model.exporting.to_session();
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    bench.retype("x q j k.glb");
    bench.keys("esc");
    assert_eq!(bench.dialog().formats[place_of("glb")].target, bench.at("older-c.glb"));
    bench.keys("esc");
    assert!(!bench.is_open());
    assert_eq!(bench.model.exporting.to_session(), before);
}

#[test]
fn pasted_text_goes_into_the_line_only() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.send(Msg::Input(Event::Paste("x".into())));
    assert!(bench.is_open());
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter ctrl-u");
    bench.send(Msg::Input(Event::Paste("~/a\u{1b}b.glb\n".into())));
    bench.keys("enter");
    assert_eq!(bench.dialog().formats[place_of("glb")].target, "~/ab.glb");
}

#[test]
fn the_mouse_ticks_turns_types_and_presses() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let ply = place_of("ply");
    bench.click_spot(ExportSpot::Format(ply));
    assert!(bench.dialog().formats[ply].chosen);
    bench.click_spot(ExportSpot::Option(ply, 0));
    assert_eq!(bench.dialog().formats[ply].option(0).unwrap().1.to_string(), "ascii");
    bench.click_spot(ExportSpot::Target(ply));
    let typed = bench.at("clicked.ply");
    bench.retype(&typed);
    // A click elsewhere takes what was typed.
    fs::write(&typed, "before").unwrap();
    assert!(bench.click_spot(ExportSpot::Start).is_empty());
    assert_eq!(bench.dialog().start, StartState::Asking);
    let order = ExportBench::order(bench.click(Target::Command("export-yes")));
    assert_eq!(order.outputs[0].path, Path::new(&typed));
    assert_eq!(order.replaces, [Path::new(&typed)]);
}

#[test]
fn every_key_of_the_room_runs_its_command_in_its_place() {
    let mut bench = ExportBench::new();
    for command in COMMANDS {
        while bench.model.dialogs.take().is_some() {}
        if command.context != Context::GLOBAL {
            bench.keys("e");
        }
        if command.context == dialog::LINE {
            bench.go_to(ExportSpot::Target(place_of("glb")));
            bench.keys("enter");
        }
        for key in command.keys {
            assert_eq!(bench.model.command_of(key.parse().unwrap()), Some(command.id), "{key}");
        }
    }
    // While a line is typed all letters are letters.
    for c in ' '..='~' {
        assert_eq!(bench.model.command_of(Shortcut::char(c)), None, "{c}");
    }
    assert_eq!(bench.model.command_of(KeyCode::Left.into()), None);
}

#[test]
fn the_cursor_stays_on_what_it_is_on() {
    let mut bench = ExportBench::new();
    bench.keys("e G");
    assert_eq!(bench.dialog().cursor, ExportSpot::Start);
    bench.keys("k j j j");
    assert_eq!(bench.dialog().cursor, ExportSpot::Start);
    bench.keys("g k");
    assert_eq!(bench.dialog().cursor, ExportSpot::Format(0));
    bench.keys("space space j");
    assert_eq!(bench.dialog().cursor, ExportSpot::Format(1));
}
