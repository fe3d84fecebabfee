//! How long a message stays in the footer.

use std::time::Duration;

use super::model::Weight;
use super::testing::Bench;
use super::update::Msg;

fn said(bench: &Bench) -> Option<&str> {
    bench.model.message.as_ref().map(|message| message.text.as_str())
}

#[test]
fn what_a_key_did_is_said_until_the_next_one() {
    let mut bench = Bench::grown(100, 30).without_pictures();
    bench.keys("c");
    assert!(said(&bench).is_some_and(|said| said.starts_with("drawn: ")));
    // Time alone, jobs and the mouse on its way take nothing away.
    bench.wait(Duration::from_secs(2));
    bench.mouse(crossterm::event::MouseEventKind::Moved, 50, 10);
    assert!(said(&bench).is_some());
    bench.keys("tab");
    assert_eq!(said(&bench), None, "another key has nothing to do with it");
    // What says something anew stays.
    bench.keys("c");
    let first = said(&bench).map(str::to_owned);
    bench.keys("c");
    assert!(said(&bench).is_some() && said(&bench) != first.as_deref());
    bench.wait(Duration::from_secs(5));
    assert_eq!(said(&bench), None);
}

#[test]
fn what_went_wrong_can_be_read_whatever_is_done() {
    let mut bench = Bench::grown(100, 30).without_pictures();
    bench.keys("u j k");
    assert_eq!(said(&bench), Some("Undo: nothing was changed"));
    assert_eq!(bench.model.message.as_ref().map(|message| message.weight), Some(Weight::Warning));
    bench.wait(Duration::from_secs(3));
    assert!(said(&bench).is_some());
    bench.keys("j");
    assert_eq!(said(&bench), None, "it was read");
    assert!(bench.model.messages.iter().any(|message| message.text == "Undo: nothing was changed"));
}

#[test]
fn news_can_be_read_while_keys_are_pressed() {
    let mut bench = Bench::grown(100, 30).without_pictures();
    bench.msg(Msg::Tick);
    bench.model.say("exported /somewhere/fir.glb");
    bench.keys("j");
    assert_eq!(said(&bench), Some("exported /somewhere/fir.glb"), "nobody knew when it would come");
    bench.wait(Duration::from_secs(2));
    bench.keys("j");
    assert_eq!(said(&bench), None);
}

#[test]
fn a_long_message_takes_two_rows_and_says_what_it_lies_over() {
    let mut bench = Bench::grown(80, 24).without_pictures();
    let path = format!("/home/me/{}oak.glb", "models/of/trees/".repeat(12));
    bench.model.say_error(format!("writing {path}: no space is left on the device"));
    let screen = bench.screen();
    let rows: Vec<&str> = screen.lines().rev().take(2).collect();
    assert!(rows[1].starts_with(" writing /home/me/") && rows[1].contains('…'), "{screen}");
    assert!(rows[1].ends_with("oak.glb:") && rows[0].contains(" no space is left on the device"), "{screen}");
    // Below it no pixels are shown, which would hide it; the picture's last row is its scale.
    let covers = bench.paint().1.covers;
    assert_eq!(covers, [ratatui::layout::Rect::new(0, 22, 80, 1)]);
    let picture = super::picture::area(&bench.model).unwrap();
    assert!(!covers[0].intersects(picture), "{picture}");
    // In the smallest windows one row is all there is.
    bench.msg(Msg::Resized(40, 6));
    let screen = bench.screen();
    assert!(screen.lines().last().is_some_and(|row| row.contains("writing")), "{screen}");
    assert!(!screen.lines().rev().nth(1).is_some_and(|row| row.contains("home")), "{screen}");
}
