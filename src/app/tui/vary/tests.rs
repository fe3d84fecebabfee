use std::cell::RefCell;
use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use linden::Quiet;
use linden::recipe::Recipe;
use linden_terminal::probe::{Capabilities, Environment, Findings, Overrides};
use ratatui::buffer::Buffer;

use super::*;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::paint_gallery;
use crate::tui::commands;
use crate::tui::layout::{Pane, Target};
use crate::tui::model::Config;
use crate::tui::screen;
use crate::tui::testing::key_event;
use crate::tui::tree::{Tree, TreePlace};
use crate::tui::update::{Msg, update};

/// The gallery on top.
fn gallery(model: &Model) -> Option<&Gallery> {
    model.dialogs.top()
}

/// A workbench with a tree on screen that has not grown.
fn model(id: &'static str, set: &[(&str, &str)], size: (u16, u16)) -> Model {
    let config = Config {
        dirs: Dirs::default(),
        theme: Theme::dark(),
        keymap: Keymap::defaults(&commands::key_table()),
        settings: Settings::default(),
        complaints: Vec::new(),
    };
    let environment = Environment::from_pairs([("TERM", "xterm-256color"), ("COLORTERM", "truecolor")]);
    let terminal = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
    let mut model = Model::new(commands::ALL, config, terminal, size, Instant::now());
    let mut preset = linden::preset::builtin(id).unwrap().load().unwrap();
    for (name, text) in set {
        preset.set(name, text).unwrap();
    }
    model.tree = Some(Tree::new(TreePlace::Builtin(id), Recipe::new(preset)));
    model
}

fn fir(size: (u16, u16)) -> Model {
    model("fir", &[("points", "200"), ("seed", "17")], size)
}

fn press(model: &mut Model, keys: &str) {
    for key in keys.split(' ') {
        let now = model.now + Duration::from_millis(20);
        update(model, Msg::Input(key_event(key)), now);
    }
}

/// Opens a sweep of a knob as one does: in the form.
fn sweep(model: &mut Model, name: &str) {
    model.focus_on(Pane::Shape);
    press(model, "g");
    for _ in 0..200 {
        if shape::selected(model).unwrap().0.knob.name == name {
            return press(model, "V");
        }
        press(model, "j");
    }
    panic!("no knob {name}");
}

/// Paints what is wanted, at once.
fn paint(model: &mut Model) -> Vec<Thumbnail> {
    let given = RefCell::new(Vec::new());
    paint_gallery(wanted(model).unwrap(), &Quiet, &|thumbnail| given.borrow_mut().push(thumbnail));
    given.into_inner()
}

fn take_in(model: &mut Model, thumbnails: impl IntoIterator<Item = Thumbnail>) {
    for thumbnail in thumbnails {
        let now = model.now;
        update(model, Msg::Thumbnail(Box::new(thumbnail)), now);
    }
}

fn screen(model: &mut Model) -> Buffer {
    let mut buffer = Buffer::empty(Rect::new(0, 0, model.size.0, model.size.1));
    let view = screen::view(model, &mut buffer);
    model.regions = view.regions;
    for late in view.order.late {
        assert_eq!(late.intersection(buffer.area).area(), late.area(), "{late}");
    }
    buffer
}

fn text(model: &mut Model) -> String {
    let buffer = screen(model);
    let rows = buffer.content.chunks(usize::from(model.size.0).max(1));
    let line = |row: &[ratatui::buffer::Cell]| {
        row.iter().map(ratatui::buffer::Cell::symbol).collect::<String>().trim_end().to_owned()
    };
    rows.map(line).collect::<Vec<_>>().join("\n")
}

fn seed(model: &Model) -> u64 {
    model.tree.as_ref().unwrap().preset().seed()
}

fn values(model: &Model) -> Vec<String> {
    wanted(model).unwrap().values.iter().map(ToString::to_string).collect()
}

#[test]
fn another_seed_is_a_turn_of_the_knob_and_leads_back() {
    let mut model = fir((80, 24));
    press(&mut model, "n");
    assert_eq!(seed(&model), 18);
    press(&mut model, "N");
    assert_eq!(seed(&model), 17);
    model.now += Duration::from_secs(2);
    press(&mut model, "n");
    press(&mut model, "u");
    assert_eq!(seed(&model), 17);

    let mut first = self::model("fir", &[("seed", "0")], (80, 24));
    press(&mut first, "N");
    assert!(first.message.unwrap().text.contains("there is no seed beyond 0"));
}

#[test]
fn a_tree_without_chance_says_so() {
    for keys in ["n", "N", "v"] {
        let mut model = model("abop-a", &[], (80, 24));
        press(&mut model, keys);
        assert!(!model.tree.as_ref().unwrap().can_undo() && model.dialogs.is_empty());
        assert!(model.message.unwrap().text.ends_with("nothing in this tree is left to chance"), "{keys}");
    }
    // The first knob of the form is the seed.
    let mut model = model("abop-a", &[], (80, 24));
    press(&mut model, "V");
    assert!(model.message.as_ref().unwrap().text.ends_with("left to chance") && model.dialogs.is_empty());
    let mut none = fir((80, 24));
    none.tree = None;
    press(&mut none, "v n V");
    assert!(none.dialogs.is_empty());
}

#[test]
fn a_gallery_has_the_trees_that_its_seeds_give() {
    let mut model = fir((80, 24));
    press(&mut model, "v");
    assert_eq!(values(&model), ["17", "18", "19", "20", "21", "22", "23", "24"]);
    let request = wanted(&model).unwrap();
    assert!(Arc::ptr_eq(&request.recipe(0).unwrap(), model.tree.as_ref().unwrap().recipe()));
    for (index, value) in request.values.iter().enumerate() {
        let mut other = fir((80, 24)).tree.unwrap();
        other.set(SEED, &value.to_string(), model.now).unwrap();
        assert!(request.recipe(index).unwrap().preset == *other.preset());
    }
}

#[test]
fn taking_is_one_undo_and_leaving_is_none() {
    let mut model = fir((80, 24));
    // A nudge of the same knob just before is a step of its own.
    press(&mut model, "n v l down enter");
    assert!(model.dialogs.is_empty());
    assert_eq!(seed(&model), 18 + 5);
    press(&mut model, "u");
    assert_eq!(seed(&model), 18);
    press(&mut model, "u");
    assert_eq!(seed(&model), 17);
    assert!(!model.tree.as_ref().unwrap().can_undo());

    press(&mut model, "v right pagedown z esc");
    assert!(model.dialogs.is_empty() && seed(&model) == 17);
    press(&mut model, "v enter");
    assert!(
        model.dialogs.is_empty() && !model.tree.as_ref().unwrap().can_undo(),
        "the same again is no step"
    );
    press(&mut model, "v 3 enter");
    assert_eq!(seed(&model), 19);
}

#[test]
fn a_taken_value_of_any_knob_is_what_the_form_would_have_set() {
    for name in ["kill", "crown", "points", "leaf_terminal", "tropism", "radius_exponent", "sides", "bark"] {
        let mut model = fir((120, 40));
        let before = model.tree.as_ref().unwrap().preset().clone();
        sweep(&mut model, name);
        if name == "tropism" {
            assert!(model.dialogs.is_empty() && model.message.unwrap().text.contains("more than one number"));
            continue;
        }
        // The last of the page.
        let request = wanted(&model).unwrap();
        let count = request.values.len();
        press(&mut model, &vec!["l"; count].join(" "));
        let chosen = |model: &Model| gallery(model).unwrap().chosen.clone();
        if chosen(&model) == knob(&model, name).unwrap().1 {
            press(&mut model, "h");
        }
        let chosen = chosen(&model);
        press(&mut model, "enter");
        let mut preset = before.clone();
        preset.set(name, &chosen.to_string()).unwrap();
        let tree = model.tree.as_mut().unwrap();
        assert!(*tree.preset() == preset && preset != before, "{name} {chosen}");
        tree.undo();
        assert!(*tree.preset() == before && !tree.can_undo(), "{name}");
    }
}

#[test]
fn pages_of_seeds_follow_each_other() {
    let mut model = fir((80, 24));
    press(&mut model, "v l pagedown");
    assert_eq!(values(&model).first().unwrap(), "25");
    press(&mut model, "pageup pageup");
    assert_eq!(values(&model).first().unwrap(), "9");
    press(&mut model, "pageup pageup");
    assert_eq!(values(&model).first().unwrap(), "0", "there is none below");
    press(&mut model, "0");
    assert_eq!(values(&model).first().unwrap(), "17");
    // Over the edge of a page is the next one.
    press(&mut model, "left");
    assert_eq!(values(&model), ["9", "10", "11", "12", "13", "14", "15", "16"]);
    press(&mut model, "right");
    assert_eq!(values(&model).first().unwrap(), "17");

    let mut last = self::model("fir", &[("seed", &u64::MAX.to_string())], (80, 24));
    press(&mut last, "v pagedown right down");
    assert_eq!(*values(&last).last().unwrap(), u64::MAX.to_string());
}

#[test]
fn a_sweep_is_wider_or_narrower() {
    let mut model = fir((80, 24));
    sweep(&mut model, "radius_exponent");
    let numbers = |model: &Model| -> Vec<f64> { values(model).iter().map(|x| x.parse().unwrap()).collect() };
    let reach = |model: &Model| numbers(model).last().unwrap() - numbers(model)[0];
    let usual = reach(&model);
    press(&mut model, "-");
    assert!(reach(&model) < usual);
    press(&mut model, "+ +");
    assert!(reach(&model) > usual);
    assert_eq!(wanted(&model).unwrap().values.len(), 8);
    press(&mut model, "pagedown");
    assert!(model.message.take().unwrap().text.contains("all there is"));
    press(&mut model, "+ + + + + + +");
    assert!(model.message.unwrap().text.contains("no sweep is wider"));

    let mut seeds = fir((80, 24));
    press(&mut seeds, "v +");
    assert!(seeds.message.unwrap().text.contains("only a sweep of numbers"));
}

#[test]
fn every_picture_is_reached_by_arrows_at_every_size() {
    for (width, height) in [(1, 1), (3, 40), (40, 3), (40, 12), (60, 30), (80, 24), (119, 50), (400, 120)] {
        for name in ["seed", "crown", "points", "leaf_terminal"] {
            let mut model = fir((width, height));
            sweep(&mut model, name);
            let place = |model: &Model| {
                let page = gallery(model).unwrap().page(model).unwrap_or_else(|why| panic!("{why}"));
                assert!(page.chosen < page.values.len() && page.values.len() == page.grid.len());
                page.first + page.chosen as u64
            };
            let last = gallery(&model).unwrap().page(&model).unwrap().series.last().min(40);
            let start = place(&model);
            // To the first one, then on to the last, each in turn.
            press(&mut model, &vec!["h"; start as usize + 1].join(" "));
            assert_eq!(place(&model), 0);
            for at in 1..=last {
                press(&mut model, "right");
                assert_eq!(place(&model), at, "{name} at {width}x{height}");
            }
            // Up and down lead from the last page to the first row and back to the last row.
            for _ in 0..=last {
                press(&mut model, "up");
            }
            let columns = gallery(&model).unwrap().page(&model).unwrap().grid.columns as u64;
            assert!(place(&model) < columns);
            for _ in 0..=last {
                press(&mut model, "down");
            }
            assert!(place(&model) + columns > last);
        }
    }
}

#[test]
fn what_comes_too_late_is_dropped() {
    let mut model = fir((80, 24));
    press(&mut model, "v");
    let of_first = paint(&mut model);
    press(&mut model, "pagedown");
    take_in(&mut model, of_first);
    assert!(gallery(&model).unwrap().pictures.is_empty(), "another page");

    let small = paint(&mut model);
    let now = model.now;
    update(&mut model, Msg::Resized(120, 40), now);
    take_in(&mut model, small);
    assert!(gallery(&model).unwrap().pictures.is_empty(), "another size");

    let one_scale = paint(&mut model);
    press(&mut model, "z");
    take_in(&mut model, one_scale);
    assert!(gallery(&model).unwrap().pictures.is_empty(), "another scale");

    let wanted_now = paint(&mut model);
    let n = wanted(&model).unwrap().values.len();
    take_in(&mut model, wanted_now);
    assert_eq!(gallery(&model).unwrap().pictures.len(), n);
    // The same pictures stay while others of another size come, each once.
    let now = model.now;
    update(&mut model, Msg::Resized(100, 40), now);
    let better = paint(&mut model);
    take_in(&mut model, better);
    assert_eq!(gallery(&model).unwrap().pictures.len(), wanted(&model).unwrap().values.len());

    let late = paint(&mut model);
    press(&mut model, "esc");
    take_in(&mut model, late);
    assert!(model.dialogs.is_empty() && wanted(&model).is_none());
}

#[test]
fn another_tree_beneath_is_another_gallery() {
    let mut model = fir((80, 24));
    sweep(&mut model, "kill");
    let before = wanted(&model).unwrap();
    assert!(before.is_of(&wanted(&model).unwrap()));
    let mut other = fir((80, 24)).tree.unwrap();
    std::mem::swap(model.tree.as_mut().unwrap(), &mut other);
    assert!(!before.is_of(&wanted(&model).unwrap()));
    // One that has no such knob.
    model.tree = self::model("abop-a", &[], (80, 24)).tree;
    assert!(wanted(&model).is_none());
    assert!(text(&mut model).contains("this tree has no kill any more"));
    press(&mut model, "l down 3 pagedown + z enter");
    assert!(model.dialogs.is_empty() && !model.tree.unwrap().can_undo());
}

#[test]
fn the_mouse_chooses_then_takes_and_hints_are_pressed() {
    let mut model = fir((120, 40));
    press(&mut model, "v");
    screen(&mut model);
    let at = |model: &Model, wanted: Target| {
        let (area, _) = model.regions.iter().rev().find(|(_, target)| *target == wanted).unwrap();
        (area.x + area.width / 2, area.y)
    };
    let click = |model: &mut Model, (column, row), kind| {
        let mouse = MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE };
        let now = model.now;
        update(model, Msg::Input(Event::Mouse(mouse)), now);
    };
    let cell = at(&model, Target::Dialog(Some(4)));
    click(&mut model, cell, MouseEventKind::ScrollDown);
    assert_eq!(values(&model)[0], format!("{}", 17 + values(&model).len()));
    click(&mut model, cell, MouseEventKind::ScrollUp);
    click(&mut model, cell, MouseEventKind::Down(MouseButton::Left));
    assert_eq!(gallery(&model).unwrap().chosen, Value::Integer(21));
    click(&mut model, cell, MouseEventKind::Down(MouseButton::Left));
    assert!(model.dialogs.is_empty() && seed(&model) == 21);

    model.message = None;
    press(&mut model, "v");
    screen(&mut model);
    let hint = at(&model, Target::Command("gallery-close"));
    click(&mut model, hint, MouseEventKind::Down(MouseButton::Left));
    assert!(model.dialogs.is_empty());
}

#[test]
fn opening_leaves_nothing_moving() {
    let mut model = fir((80, 24));
    model.picture.turn(Some(model.now));
    model.picture.camera.zoom = 3.0;
    press(&mut model, "v");
    assert!(!model.picture.is_turning());
    let camera = wanted(&model).unwrap().camera;
    assert_eq!((camera.yaw_deg, camera.zoom), (model.picture.camera.yaw_deg, 1.0));
}

#[test]
fn no_size_is_too_small_or_too_large() {
    let mut model = fir((80, 24));
    sweep(&mut model, "kill");
    let pictures = paint(&mut model);
    take_in(&mut model, pictures);
    for width in (1..24).chain([35, 36, 37, 71, 72, 80, 110, 200, 400]) {
        for height in (1..14).chain([20, 21, 24, 40, 120]) {
            let now = model.now;
            update(&mut model, Msg::Resized(width, height), now);
            screen(&mut model);
            if let Some(request) = wanted(&model) {
                assert!(request.cells.0 > 0 && request.cells.1 > 0);
            }
        }
    }
}

#[test]
fn what_is_chosen_is_seen_without_colours() {
    let mut model = fir((80, 24));
    model.config.theme = Theme::plain(false);
    press(&mut model, "v l");
    let text = text(&mut model);
    assert_eq!(text.matches('┏').count(), 1);
    let line = text.lines().find(|line| line.contains('┏')).unwrap();
    assert!(line.split('┏').nth(1).unwrap().contains("seed 18"), "{line}");
}

#[test]
fn a_gallery_half_filled_on_a_usual_screen() {
    let mut model = model("abop-stochastic", &[("derivations", "3"), ("seed", "17")], (80, 24));
    press(&mut model, "v right");
    let pictures = paint(&mut model);
    take_in(&mut model, pictures.into_iter().take(3));
    insta::assert_snapshot!(text(&mut model));
}

#[test]
fn a_sweep_with_a_fault_on_a_small_screen() {
    let mut model = model("fir", &[("points", "60"), ("kill", "2D")], (44, 22));
    sweep(&mut model, "kill");
    press(&mut model, "+ z");
    let pictures = paint(&mut model);
    take_in(&mut model, pictures);
    insta::assert_snapshot!(text(&mut model));
}

#[test]
fn a_gallery_on_a_tiny_screen() {
    let mut model = fir((24, 7));
    press(&mut model, "v");
    let pictures = paint(&mut model);
    take_in(&mut model, pictures);
    insta::assert_snapshot!(text(&mut model));
}

#[test]
fn moving_in_a_gallery_of_pixels_sends_no_pixels() {
    use linden_terminal::{Allowance, Frame, Graphic, Screen, ScreenOptions};
    let mut model = fir((120, 40));
    model.terminal.graphics.value = linden_terminal::probe::Graphics::Kitty;
    press(&mut model, "v");
    let pictures = paint(&mut model);
    take_in(&mut model, pictures);
    let mut terminal = Screen::new(ScreenOptions::default());
    let mut show = |model: &mut Model| {
        let shown = graphics(model).unwrap();
        assert_eq!(shown.len(), 12);
        let graphics: Vec<Graphic> = shown
            .into_iter()
            .zip(1..)
            .map(|((area, data), generation)| Graphic { generation, area, layer: 1, data })
            .collect();
        let buffer = screen(model);
        let frame = Frame { buffer: &buffer, cursor: None, first: &[], late: &[], graphics: &graphics };
        terminal.compose(&frame, Allowance::ALL).bytes
    };
    let first = show(&mut model);
    assert!(first.windows(3).filter(|bytes| bytes == b"\x1b_G").count() >= 24);
    for key in ["right", "down", "left", "up"] {
        press(&mut model, key);
        let moved = show(&mut model);
        assert!(!moved.windows(3).any(|bytes| bytes == b"\x1b_G"), "{key}");
        // Two frames of text, and what is chosen.
        assert!(moved.len() < 1400, "{key}: {}", moved.len());
    }
}

#[test]
fn what_is_said_below_a_picture_is_the_difference() {
    let mut model = fir((120, 40));
    press(&mut model, "v");
    let pictures = paint(&mut model);
    let size = |index: usize| pictures[index].result.as_ref().unwrap().size;
    let (now, other) = (size(0), size(1));
    take_in(&mut model, pictures);
    let text = text(&mut model);
    let more_m = other.height_m - now.height_m;
    let more = format!("{:.1} m {}", more_m.abs(), if more_m < 0.0 { "lower" } else { "taller" });
    assert!(text.contains(&more), "{more}\n{text}");
    let percent = ((other.width_m / now.width_m - 1.0) * 100.0).round();
    let word = if percent < 0.0 { "narrower" } else { "wider" };
    assert!(text.contains(&format!("{} % {word}", percent.abs())), "{text}");
    assert!(text.contains(" m wide"), "what is set has its size");
}
