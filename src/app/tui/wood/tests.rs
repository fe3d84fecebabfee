use linden_raster::Size;

use super::*;
use crate::jobs::Framed;
use crate::tui::layout::Pane;
use crate::tui::testing::Bench;

/// The axes of the tree on screen, and what is picked.
fn state(bench: &Bench) -> (usize, String) {
    let shown = bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap();
    let pick = bench.model.dialogs.find::<WoodPick>().map(|pick| pick.path.to_string());
    (shown.grown.skeleton.axes.len(), pick.unwrap_or_default())
}

fn fir() -> Bench {
    let mut bench = Bench::new(120, 40).without_pictures().with_tree();
    bench.keys("/").types("fir").keys("enter").settle();
    bench
}

#[test]
fn an_axis_is_picked_by_keys_taken_away_and_given_back() {
    let mut bench = fir();
    let (all, _) = state(&bench);
    bench.keys("a");
    assert_eq!(state(&bench).1, "stem");
    assert!(bench.screen().contains(" stem · "), "{}", bench.screen());
    bench.keys("l");
    let on_path = state(&bench).1;
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let skeleton = &shown.grown.skeleton;
    let longest = (1..skeleton.axes.len() as u32)
        .filter(|axis| skeleton.axes[*axis as usize].order == 1)
        .max_by(|a, b| skeleton.axis_length_m(*a).total_cmp(&skeleton.axis_length_m(*b)));
    assert_eq!(skeleton.axis_path(longest.unwrap()).unwrap().to_string(), on_path, "the longest limb");
    let marks = marks(&bench.model, &shown).unwrap();
    let nodes = skeleton.nodes_of(&skeleton.axes[longest.unwrap() as usize]);
    let tip = skeleton.positions[*nodes.last().unwrap() as usize];
    assert!(marks.bare && marks.lines.len() == 1);
    assert_eq!((marks.lines[0].len(), marks.lines[0].last()), (nodes.len() + 1, Some(&tip)));
    let pick = bench.model.dialogs.find::<WoodPick>().unwrap();
    let next = pick.beside(true).or(pick.beside(false)).unwrap();
    let next = skeleton.axis_path(next).unwrap().to_string();
    bench.keys("x").settle();
    let tree = bench.model.tree.as_ref().unwrap();
    let edits: Vec<String> = tree.preset().edits.iter().map(|edit| edit.plain().to_string()).collect();
    assert!(tree.preset().edits[0].near.is_some(), "it is found again after other changes");
    assert!(edits[0].starts_with(&format!("remove {on_path}")), "{edits:?}");
    let (fewer, on) = state(&bench);
    assert!(fewer < all && on == next, "{fewer} of {all}, on {on}: the next one, {next}");
    let said = |bench: &Bench| bench.model.message.clone().unwrap().text;
    bench.keys("u").settle();
    assert_eq!(state(&bench).0, all);
    assert_eq!(said(&bench), format!("undone: remove {on_path}"));
    bench.keys("ctrl-r").settle();
    assert_eq!(said(&bench), format!("done again: remove {on_path}"));
    bench.keys("u").settle();
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn an_edit_is_typed_and_what_is_wrong_with_it_is_said() {
    let mut bench = fir();
    bench.keys("a l c");
    let on_path = state(&bench).1;
    assert!(bench.screen().contains(&format!("cut {on_path} 0.5")), "{}", bench.screen());
    bench.keys("backspace backspace backspace").types("7 m");
    assert!(bench.screen().contains("cut"), "{}", bench.screen());
    bench.keys("enter");
    assert!(bench.model.tree.as_ref().unwrap().preset().edits.is_empty(), "that is no share");
    bench.keys("backspace backspace backspace").types("0.25").keys("enter").settle();
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let pick = bench.model.dialogs.find::<WoodPick>().unwrap();
    let before = linden::grow::grow(bench.model.tree.as_ref().unwrap().saved(), &linden::Quiet).unwrap();
    let path: AxisPath = on_path.parse().unwrap();
    let whole = before.skeleton.axis_length_m(before.skeleton.find_axis(&path).unwrap());
    let cut = shown.grown.skeleton.axis_length_m(pick.axis);
    assert!((cut / whole - 0.25).abs() < 1e-4, "{cut} of {whole}");
}

#[test]
fn the_mouse_picks_what_is_drawn_there() {
    let mut bench = Bench::new(120, 40).with_tree();
    bench.keys("/").types("fir").keys("enter").settle();
    bench.keys("a");
    let request = picture::wanted(&bench.model).unwrap();
    let shown = Arc::clone(request.subject.tree().unwrap());
    let (wide, high) = request.medium.cell_px;
    let size = Size::new(
        u32::from(request.area.width) * u32::from(wide),
        u32::from(request.area.height) * u32::from(high),
    );
    let view = request.camera.view(shown.extent(Framed::Tree, false), size.unwrap());
    // The tip of the lowest long limb: nothing else is near.
    let skeleton = &shown.grown.skeleton;
    let tip = |axis: &u32| {
        let nodes = skeleton.nodes_of(&skeleton.axes[*axis as usize]);
        view.project(skeleton.positions[*nodes.last().unwrap() as usize]).at
    };
    let widest = (0..skeleton.axes.len() as u32).max_by(|a, b| tip(a).x.total_cmp(&tip(b).x)).unwrap();
    let at = tip(&widest);
    let cell = |px: f32, one: u16| (px / f32::from(one)) as u16;
    let (column, row) = (request.area.x + cell(at.x, wide), request.area.y + cell(at.y, high));
    bench.mouse(crossterm::event::MouseEventKind::Down(crossterm::event::MouseButton::Left), column, row);
    assert_eq!(bench.model.dialogs.find::<WoodPick>().map(|pick| pick.axis), Some(widest));
}

#[test]
fn a_click_on_a_long_segment_picks_it_though_a_node_of_another_axis_is_nearer() {
    let mut bench = Bench::new(120, 40).with_tree();
    // A limb of one segment, and on it a twig that comes back to a tenth of a metre below its middle.
    let grammar = "axiom = F(1)[+(90)F(1)[+(90)F(0.5)+(90)F(0.5)+(90)F(0.4)]]F(1)\nX -> X\n";
    shape::grammar::take_text(&mut bench.model, grammar);
    bench.settle();
    bench.keys("a").settle();
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let skeleton = &shown.grown.skeleton;
    let limb = (0..3).find(|&axis| skeleton.axes[axis].order == 1).unwrap() as u32;
    let middle = line_of(skeleton, limb).iter().take(2).sum::<Vec3>() / 2.0;
    let nearest = (0..skeleton.positions.len())
        .min_by(|&a, &b| {
            let far = |node: usize| skeleton.positions[node].distance(middle);
            far(a).total_cmp(&far(b))
        })
        .unwrap();
    assert_ne!(skeleton.axis_of_nodes()[nearest], limb, "the node next to it is the twig's");
    let area = picture::area(&bench.model).unwrap();
    let (wide, high) = picture::wanted(&bench.model).unwrap().medium.cell_px;
    let (view, _) = picture::pointed_at(&bench.model, area.x, area.y).unwrap();
    let at = view.project(middle).at;
    let cell = |px: f32, one: u16| (px / f32::from(one)) as u16;
    let press = crossterm::event::MouseEventKind::Down(crossterm::event::MouseButton::Left);
    bench.mouse(press, area.x + cell(at.x, wide), area.y + cell(at.y, high));
    assert_eq!(bench.model.dialogs.find::<WoodPick>().map(|pick| pick.axis), Some(limb));
}

#[test]
fn edits_stand_in_the_form_where_they_are_typed_anew_and_taken_away() {
    let mut bench = fir();
    let (all, _) = state(&bench);
    for text in ["remove stem/3", "scale stem/5 0.5", "remove stem/7"] {
        add(&mut bench.model, text, None).unwrap();
    }
    bench.settle();
    let edits = |bench: &Bench| -> Vec<String> {
        let preset = bench.model.tree.as_ref().unwrap().preset();
        preset.edits.iter().map(ToString::to_string).collect()
    };
    let before = edits(&bench);
    assert!(before.len() == 3 && state(&bench).0 < all, "{before:?}");
    bench.model.focus_on(Pane::Shape);
    bench.keys("G");
    let screen = bench.screen();
    assert!(screen.contains("Edits of the wood") && screen.contains(&format!("●{}", before[2])), "{screen}");
    // The one in the middle, in its place.
    bench.keys("k enter ctrl-u").types("scale stem/5 0.7").keys("enter").settle();
    let after = edits(&bench);
    assert_eq!([&after[0], &after[2]], [&before[0], &before[2]]);
    assert!(after.len() == 3 && after[1].contains("0.7"), "{after:?}");
    assert!(bench.model.tree.as_ref().unwrap().preset().edits[1].near.is_some(), "it is found again");
    bench.keys("delete").settle();
    assert_eq!(edits(&bench), [before[0].clone(), before[2].clone()]);
    bench.keys("u u").settle();
    assert_eq!(edits(&bench), before);
    // What changed alone: the edits, below their heading.
    bench.keys("*");
    let screen = bench.screen();
    assert!(screen.contains("Edits of the wood") && !screen.contains("crown_base"), "{screen}");
    bench.keys("g");
    assert!(bench.screen().contains("Delete takes it"), "{}", bench.screen());
}

#[test]
fn changed_alone_lists_the_edits_that_the_document_has_not() {
    let mut bench = fir();
    add(&mut bench.model, "remove stem/3", None).unwrap();
    bench.settle();
    bench.model.focus_on(Pane::Shape);
    bench.keys("*");
    let screen = bench.screen();
    assert!(screen.contains("Edits of the wood") && screen.contains("●remove stem/3"), "{screen}");
    assert!(!screen.contains("crown_height"), "knobs are as they were: {screen}");
    // One that is saved is none of them; another beside it is.
    let tree = bench.model.tree.as_mut().unwrap();
    let (place, recipe) = (tree.place.clone(), std::sync::Arc::clone(tree.recipe()));
    tree.saved_as(place, recipe);
    add(&mut bench.model, "cut stem/5 0.5", None).unwrap();
    bench.settle();
    let screen = bench.screen();
    assert!(screen.contains("●cut stem/5") && !screen.contains("remove stem/3"), "{screen}");
}

#[test]
fn an_edit_that_was_not_made_says_so_in_the_form() {
    let mut bench = fir();
    add(&mut bench.model, "remove stem/9999", None).unwrap();
    bench.settle();
    let said = bench.model.message.as_ref().map(|message| message.text.clone()).unwrap_or_default();
    assert!(said.starts_with("edit 1 (remove stem/9999) was left out: "), "{said}");
    bench.model.focus_on(Pane::Shape);
    bench.keys("G");
    let shown = bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap();
    let why: String = shown.grown.remarks[0].why.chars().take(24).collect();
    assert!(bench.screen().contains(&why), "{why}: {}", bench.screen());
}

/// The points of the curve that the preset has, metres from the base.
fn points(bench: &Bench) -> Vec<[f64; 3]> {
    let edits = &bench.model.tree.as_ref().unwrap().preset().edits;
    match edits.last().map(|edit| &edit.operation) {
        Some(Operation::Curve { points }) => points.clone(),
        _ => Vec::new(),
    }
}

/// The cell in which a control point is drawn.
fn cell_of(bench: &Bench, handle: usize) -> (u16, u16) {
    let request = picture::wanted(&bench.model).unwrap();
    let at = request.marks.as_ref().unwrap().handles[handle].at;
    let (view, _) = picture::pointed_at(&bench.model, request.area.x, request.area.y).unwrap();
    let (px, (wide, high)) = (view.project(at).at, request.medium.cell_px);
    let cell = |px: f32, one: u16| (px / f32::from(one)) as u16;
    (request.area.x + cell(px.x, wide), request.area.y + cell(px.y, high))
}

#[test]
fn a_control_point_is_dragged_and_the_edit_is_the_one_that_is_typed() {
    use crossterm::event::{MouseButton, MouseEventKind};
    let mut bench = fir();
    bench.keys("a l w");
    let on_path = state(&bench).1;
    assert!(points(&bench).is_empty(), "nothing is changed before a point has moved");
    let (column, row) = cell_of(&bench, 2);
    bench.mouse(MouseEventKind::Down(MouseButton::Left), column, row);
    for way in 1..=3 {
        bench.mouse(MouseEventKind::Drag(MouseButton::Left), column, row - way);
    }
    bench.mouse(MouseEventKind::Up(MouseButton::Left), column, row - 3);
    bench.settle();
    assert_eq!(cell_of(&bench, 2), (column, row - 3), "the point is where the pointer let go");
    let drawn = bench.model.tree.as_ref().unwrap().preset().edits.clone();
    assert_eq!(drawn.len(), 1);
    assert!(drawn[0].near.is_some() && drawn[0].axis.to_string() == on_path);
    // The tip of the grown axis is that point.
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let axis = shown.grown.skeleton.find_axis(&on_path.parse().unwrap()).unwrap();
    let line = line_of(&shown.grown.skeleton, axis);
    let last = points(&bench)[2].map(|x| x as f32);
    assert!(line.last().unwrap().distance(line[0] + Vec3::from(last)) < 1e-3);
    let typed = drawn[0].to_string();
    // One drag is one step, and the same edit typed gives the same.
    bench.keys("u enter");
    assert!(points(&bench).is_empty());
    add(&mut bench.model, &typed, None).unwrap();
    assert_eq!(bench.model.tree.as_ref().unwrap().preset().edits, drawn);
}

#[test]
fn points_move_by_keys_come_and_go_and_are_given_up() {
    let mut bench = fir();
    bench.keys("a l w up up");
    let once = points(&bench);
    assert_eq!(once.len(), 3);
    bench.keys("u");
    assert!(points(&bench).is_empty(), "keys that follow each other are one step");
    bench.keys("ctrl-r a").settle();
    assert_eq!(points(&bench).len(), 4);
    assert!(bench.screen().contains("point 3 of 4"), "{}", bench.screen());
    bench.keys("x tab x").settle();
    assert_eq!(points(&bench).len(), 2);
    // Drawn anew, the edit is the same one.
    bench.keys("enter w down");
    let tree = bench.model.tree.as_ref().unwrap();
    assert_eq!((tree.preset().edits.len(), points(&bench).len()), (1, 2));
    let now = points(&bench);
    bench.keys("left esc");
    assert!(bench.model.dialogs.top::<WoodPick>().is_some());
    assert_ne!(points(&bench), now, "given up: as it was when drawing began");
    bench.keys("w x x");
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("a curve needs a point"), "{said}");
}

#[test]
fn points_are_typed_as_well() {
    let mut bench = fir();
    bench.keys("a l w i ctrl-u");
    let on_path = state(&bench).1;
    bench.types(&format!("curve {on_path} 0.2,0.1,0,0.5,0.4,0.1")).keys("enter").settle();
    assert_eq!(points(&bench), [[0.2, 0.1, 0.0], [0.5, 0.4, 0.1]]);
    assert!(bench.screen().contains("point 2 of 2"), "{}", bench.screen());
}

#[test]
fn what_is_drawn_and_how_to_leave_are_told_on_small_screens() {
    for (columns, rows) in [(120, 40), (60, 18), (40, 12)] {
        let mut bench = Bench::new(columns, rows).without_pictures().with_tree();
        bench.keys("/").types("fir").keys("enter").settle();
        bench.model.focus_on(Pane::Picture);
        bench.keys("a l w");
        bench.model.message = None;
        let screen = bench.screen();
        for words in ["point ", "Esc Cancel", "Enter Done"] {
            assert!(screen.contains(words), "{columns}x{rows} {words}\n{screen}");
        }
    }
}

#[test]
fn the_numbers_of_a_point_are_whole_on_usual_screens() {
    for columns in [80, 120] {
        let mut bench = Bench::new(columns, 30).without_pictures().with_plain("fir");
        bench.keys("a l l w");
        let screen = bench.screen();
        let line =
            screen.lines().find(|line| line.contains("point 3 of 3: ")).unwrap_or_else(|| panic!("{screen}"));
        assert!(line.contains(" m · stem"), "{line}");
    }
}
