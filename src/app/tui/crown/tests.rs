use crossterm::event::{MouseButton, MouseEventKind};
use linden::grow::grow;
use linden::knob::Value;

use super::*;
use crate::tui::testing::Bench;

fn with_crown(columns: u16, rows: u16, crown: &str) -> Bench {
    let mut bench = Bench::new(columns, rows).without_pictures().with_tree();
    bench.keys("/").types("simple").keys("enter").settle();
    let now = bench.model.now;
    bench.model.tree.as_mut().unwrap().set("crown", crown, now).unwrap();
    bench.settle();
    bench
}

fn value(bench: &Bench, knob: &str) -> Value {
    let knobs = bench.model.tree.as_ref().unwrap().preset().knobs();
    knobs.into_iter().find(|(row, _)| row.knob.name == knob).unwrap().1
}

fn pick(bench: &Bench) -> &CrownPick {
    bench.model.dialogs.find::<CrownPick>().unwrap()
}

/// The cell in which a handle is drawn.
fn cell_of(bench: &Bench, handle: usize) -> (u16, u16) {
    let request = picture::wanted(&bench.model).unwrap();
    let at = request.marks.as_ref().unwrap().handles[handle].at;
    let (view, _) = picture::pointed_at(&bench.model, request.area.x, request.area.y).unwrap();
    let (px, (wide, high)) = (view.project(at).at, request.medium.cell_px);
    let cell = |px: f32, one: u16| (px / f32::from(one)) as u16;
    (request.area.x + cell(px.x, wide), request.area.y + cell(px.y, high))
}

fn press(bench: &mut Bench, handle: usize) -> (u16, u16) {
    let (column, row) = cell_of(bench, handle);
    bench.mouse(MouseEventKind::Down(MouseButton::Left), column, row);
    (column, row)
}

const DRAG: MouseEventKind = MouseEventKind::Drag(MouseButton::Left);
const UP: MouseEventKind = MouseEventKind::Up(MouseButton::Left);

#[test]
fn a_point_of_a_profile_follows_the_mouse_and_one_drag_is_one_step_of_undo() {
    let mut bench = with_crown(120, 40, "bezier");
    let before = value(&bench, "profile");
    bench.keys("A");
    let (column, row) = press(&mut bench, 2);
    assert_eq!(pick(&bench).picked, 2);
    for way in 1..=4 {
        bench.mouse(DRAG, column + way, row - way / 2);
    }
    // The handle is under the pointer, but for the step by which it moves and for the cell.
    let (at_column, at_row) = cell_of(&bench, 2);
    assert!((i32::from(at_column) - i32::from(column + 4)).abs() <= 1, "{at_column} {column}");
    assert!((i32::from(at_row) - i32::from(row - 2)).abs() <= 1, "{at_row} {row}");
    bench.mouse(UP, column + 4, row - 2);
    assert!(bench.model.picture.frozen.is_none());
    let (Value::Profile(was), Value::Profile(is)) = (before.clone(), value(&bench, "profile")) else {
        panic!()
    };
    assert!(is[2][0] > was[2][0] && is[2][1] > was[2][1], "{is:?}");
    assert_eq!([is[0], is[1], is[3]], [was[0], was[1], was[3]], "the others stay");
    // The tree grows into it.
    bench.settle();
    let tree = bench.model.tree.as_ref().unwrap();
    let anew = grow(tree.recipe(), &linden::Quiet).unwrap();
    assert_eq!(tree.shown.as_ref().unwrap().grown.hash(), anew.hash());
    bench.keys("u");
    assert_eq!(value(&bench, "profile"), before, "one step");
    bench.keys("ctrl-r");
    assert_eq!(value(&bench, "profile"), Value::Profile(is));
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty() && !bench.model.picture.outline);
}

#[test]
fn two_drags_are_two_steps_and_a_press_beside_the_handles_turns_the_tree() {
    let mut bench = with_crown(120, 40, "revolution");
    bench.keys("A");
    let states: Vec<Value> = (0..2)
        .map(|_| {
            let (column, row) = press(&mut bench, 2);
            bench.mouse(DRAG, column - 2, row);
            bench.mouse(UP, column - 2, row);
            value(&bench, "profile_points")
        })
        .collect();
    assert_ne!(states[0], states[1]);
    bench.keys("u");
    assert_eq!(value(&bench, "profile_points"), states[0]);
    let (area, yaw) = (picture::area(&bench.model).unwrap(), bench.model.picture.camera.yaw_deg);
    bench.mouse(MouseEventKind::Down(MouseButton::Left), area.x, area.y);
    bench.mouse(DRAG, area.x + 5, area.y);
    assert!((bench.model.picture.camera.yaw_deg - yaw).abs() > 1.0);
    assert_eq!(value(&bench, "profile_points"), states[0]);
}

#[test]
fn keys_pick_handles_and_move_them_only_the_ways_that_they_go() {
    let mut bench = with_crown(120, 40, "cone");
    bench.keys("A");
    let handles = pick(&bench).draft.handles.clone();
    let names: Vec<&str> = handles.iter().map(|handle| handle.knob).collect();
    assert_eq!(names, ["crown_height", "crown_radius", "crown_base"]);
    let [height, radius] = ["crown_height", "crown_radius"].map(|knob| value(&bench, knob));
    bench.keys("up up");
    let Value::Real(higher) = value(&bench, "crown_height") else { panic!() };
    let step_m = 2.0 * STEPS_A_KEY * pick(&bench).draft.grain_m();
    assert!((higher - handles[0].height_m - step_m).abs() < 1e-9, "{higher}");
    bench.keys("right");
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("crown_height moves up and down alone"), "{said}");
    assert_eq!(value(&bench, "crown_radius"), radius);
    bench.keys("u");
    assert_eq!(value(&bench, "crown_height"), height, "keys that follow each other are one step");
    bench.keys("tab left");
    let Value::Real(narrower) = value(&bench, "crown_radius") else { panic!() };
    assert!(narrower < handles[1].radius_m, "{narrower}");
    bench.keys("shift-tab shift-tab");
    assert_eq!(pick(&bench).handle().unwrap().knob, "crown_base");
    for _ in 0..400 {
        bench.keys("down");
    }
    assert_eq!(value(&bench, "crown_base"), Value::Real(0.0), "no farther than the knob goes");
}

#[test]
fn points_of_a_profile_come_and_go() {
    let mut bench = with_crown(120, 40, "revolution");
    let count = |bench: &Bench| match value(bench, "profile_points") {
        Value::Profile(pairs) => pairs.len(),
        _ => 0,
    };
    let before = count(&bench);
    bench.keys("A a");
    assert_eq!((count(&bench), pick(&bench).picked), (before + 1, 1));
    bench.keys("x x");
    assert_eq!(count(&bench), before - 1);
    bench.keys("u u u");
    assert_eq!(count(&bench), before);
}

#[test]
fn what_has_no_profile_says_so() {
    let mut bench = Bench::new(120, 40).without_pictures().with_tree();
    bench.keys("A");
    assert!(bench.model.dialogs.is_empty());
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("fills no crown shape"), "{said}");
    bench.keys("/").types("heart").keys("enter").settle();
    bench.keys("A");
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("is a mesh and has no profile"), "{said}");
}

#[test]
fn what_is_picked_and_how_to_leave_are_told_on_small_screens() {
    for (columns, rows) in [(120, 40), (60, 18), (40, 12)] {
        let mut bench = with_crown(columns, rows, "cone");
        bench.model.focus_on(crate::tui::layout::Pane::Picture);
        bench.keys("A");
        bench.model.message = None;
        let screen = bench.screen();
        for words in ["crown_height 1", "Esc Done", "Next handle"] {
            assert!(screen.contains(words), "{columns}x{rows} {words}\n{screen}");
        }
    }
}

#[test]
fn handles_are_letters_where_pictures_are_characters() {
    for (says, signs) in [(&[][..], ['○', '●']), (&[("LC_ALL", "C")], ['o', '@'])] {
        let mut bench = Bench::on(120, 40, &[&[("COLORTERM", "truecolor")][..], says].concat(), "auto");
        bench = bench.with_plain("simple");
        bench.keys("A tab").settle();
        let lines: Vec<Vec<char>> = bench.screen().lines().map(|line| line.chars().collect()).collect();
        for handle in 0..pick(&bench).draft.handles.len() {
            let (column, row) = cell_of(&bench, handle);
            let sign = signs[usize::from(handle == pick(&bench).picked)];
            assert_eq!(lines[row as usize][column as usize], sign, "{handle}\n{}", bench.screen());
        }
    }
}
