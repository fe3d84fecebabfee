use crossterm::event::{MouseButton, MouseEventKind};

use super::*;
use crate::tui::testing::Bench;

/// ABOP's first plant, F -> F[+F]F[-F]F, derived twice, with its word on screen.
fn looking() -> Bench {
    let mut bench = Bench::grown(120, 40);
    bench.keys("d").settle();
    bench
}

fn debugger(bench: &Bench) -> &Debugger {
    bench.model.dialogs.find::<Debugger>().unwrap()
}

/// The step, the word's length, the cursor's module and its symbol.
fn state(bench: &Bench) -> (u32, usize, usize, char) {
    let debugger = debugger(bench);
    let symbol = debugger.module().map_or(' ', |module| module.symbol);
    (debugger.step, debugger.modules().len(), debugger.cursor, symbol)
}

#[test]
fn the_word_stands_beside_the_tree_and_the_cursor_follows_a_module_through_steps() {
    let mut bench = looking();
    // The rule's word has 11 modules, of which 5 are an F: 5 * 11 + 6 after two steps.
    assert_eq!(state(&bench), (2, 61, 0, 'F'));
    let screen = bench.screen();
    for text in ["Derivation 2 of 2 · 61 modules", "draws a segment", "F -> F[+F]F[-F]F", "F[+F]F[-F]F[+F["]
    {
        assert!(screen.contains(text), "{text}: {screen}");
    }
    // The third F, back to the F of the axiom's word that wrote it, and on to what that becomes.
    bench.keys("l l l").settle();
    assert_eq!(state(&bench), (2, 61, 3, 'F'));
    bench.keys(",").settle();
    assert_eq!(state(&bench), (1, 11, 0, 'F'));
    bench.keys("l l l .").settle();
    // Before it stand what F, [ and + became: 11 + 1 + 1 modules.
    assert_eq!(state(&bench), (2, 61, 13, 'F'));
    bench.keys("( ").settle();
    assert_eq!(state(&bench), (0, 1, 0, 'F'));
    assert!(bench.screen().contains("stands since the axiom"), "{}", bench.screen());
    bench.keys(", ) .").settle();
    assert_eq!(state(&bench).0, 3, "one step beyond the tree");
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn keys_find_brackets_and_symbols_of_a_kind() {
    let mut bench = looking();
    let word: Vec<char> = debugger(&bench).modules().iter().map(|module| module.symbol).collect();
    let at = |bench: &Bench| debugger(bench).cursor;
    bench.keys("l b");
    // From its opening to the ] that closes as many as were opened.
    let depth = |to: usize| {
        let count = |symbol| word[1..=to].iter().filter(|c| **c == symbol).count() as i32;
        count('[') - count(']')
    };
    let closing = (2..word.len()).find(|&to| depth(to) == 0).unwrap();
    assert_eq!(at(&bench), closing);
    bench.keys("b");
    assert_eq!(at(&bench), 1);
    bench.keys("n");
    assert_eq!(at(&bench), (2..word.len()).find(|&i| word[i] == '[').unwrap());
    bench.keys("N end");
    assert_eq!(at(&bench), 60);
    bench.keys("l");
    assert_eq!(at(&bench), 60, "there is no further");
    assert!(bench.screen().contains("this is the last module"));
    bench.keys("home j");
    let debugger = debugger(&bench);
    assert_eq!(debugger.cursor, debugger.lines[1], "straight below");
}

#[test]
fn lines_hold_every_module_once_and_fit() {
    let bench = looking();
    let debugger = debugger(&bench);
    let width = usize::from(view::areas(&bench.model).word.width);
    let mut next = 0;
    for line in 0..debugger.lines.len() {
        let modules = debugger.line(line);
        assert_eq!(modules.start, next);
        next = modules.end;
        let text: String = debugger.modules()[modules].iter().map(ToString::to_string).collect();
        assert!(!text.is_empty() && text.len() <= width, "{text}");
        assert!(bench.screen().contains(&text), "{text}");
    }
    assert_eq!(next, debugger.modules().len());
}

#[test]
fn arguments_are_short_in_the_word_and_whole_above_it() {
    let mut bench = Bench::new(120, 40).without_pictures().with("abop-honda-a");
    bench.keys("d").settle();
    // The widths of ABOP, Fig. 2.6 a, go by 0.707: 10, then 7.07.
    let screen = bench.screen();
    assert!(["!(10)F(1)", "!(7.07)"].iter().all(|text| screen.contains(text)), "{screen}");
    let width = debugger(&bench).modules().iter().position(|module| module.to_string().len() > 12).unwrap();
    bench.model.dialogs.top_mut::<Debugger>().unwrap().go_to(width);
    let whole = debugger(&bench).module().unwrap().to_string();
    assert!(bench.screen().contains(&whole), "{whole}: {}", bench.screen());
}

#[test]
fn the_picture_marks_the_segment_or_the_branch_of_a_module() {
    let mut bench = looking();
    let marked = |bench: &Bench| shown(&bench.model).unwrap().1.lines;
    let skeleton = Arc::clone(&debugger(&bench).word.as_ref().unwrap().plant.as_ref().unwrap().skeleton);
    let near = |a: Vec3, b: Vec3| a.distance(b) < 1e-5;
    let has_segment = |line: &[Vec3]| {
        let ends = |node: usize| skeleton.positions.get(skeleton.parents[node] as usize).copied();
        (0..skeleton.positions.len()).any(|node| {
            near(skeleton.positions[node], line[1]) && ends(node).is_some_and(|from| near(from, line[0]))
        })
    };
    let lines = marked(&bench);
    assert!(lines.len() == 1 && lines[0].len() == 2 && has_segment(&lines[0]), "{lines:?}");
    // The first bracket: a whole branch of five segments, each of the skeleton.
    let mut branch = looking();
    branch.keys(",").settle();
    branch.keys("l .").settle();
    branch.keys("b b");
    assert_eq!(state(&branch).3, '[');
    let lines = marked(&branch);
    let segments: Vec<&[Vec3]> = lines.iter().flat_map(|line| line.windows(2)).collect();
    assert_eq!(segments.len(), 5, "F[+F]F[-F]F is what +F became: {lines:?}");
    assert!(segments.iter().all(|segment| has_segment(segment)));
    // A turn is a cross where the turtle stands: at the end of the first segment.
    bench.keys("l l");
    let lines = marked(&bench);
    let middle = lines[0].iter().sum::<Vec3>() / 2.0;
    assert_eq!((state(&bench).3, lines.len()), ('+', 3));
    assert!(has_segment(&[Vec3::ZERO, middle]), "{middle}");
    // What is marked is another picture.
    let before = picture::wanted(&bench.model).unwrap();
    bench.keys("l");
    assert!(!picture::wanted(&bench.model).unwrap().is_of(&before));
}

#[test]
fn the_mouse_finds_the_module_of_a_segment_and_of_a_letter() {
    let mut bench = looking();
    let word = Arc::clone(debugger(&bench).word.as_ref().unwrap());
    let area = picture::area(&bench.model).unwrap();
    let (wide, high) = picture::wanted(&bench.model).unwrap().medium.cell_px;
    // The last F is the tip of the plant: nothing else is drawn that high.
    let (view, _) = picture::pointed_at(&bench.model, area.x, area.y).unwrap();
    let tip = view.project(word.traced.modules[60].at.unwrap()).at;
    let cell = |px: f32, one: u16| (px / f32::from(one)) as u16;
    let press = MouseEventKind::Down(MouseButton::Left);
    bench.mouse(press, area.x + cell(tip.x, wide), area.y + cell(tip.y, high));
    assert_eq!(state(&bench).2, 60);
    let letters = view::areas(&bench.model).word;
    bench.mouse(press, letters.x + 3, letters.y);
    assert_eq!(state(&bench).2, 3);
    bench.mouse(MouseEventKind::ScrollDown, letters.x, letters.y);
    assert!(state(&bench).2 > 3);
}

#[test]
fn a_rule_is_edited_from_its_module_and_the_word_follows() {
    let mut bench = looking();
    bench.keys("e");
    assert!(bench.screen().contains("axiom = F"), "{}", bench.screen());
    // At the end of the rule's line.
    bench.types("F").keys("esc").settle();
    assert_eq!(state(&bench).1, 6 * 12 + 6, "F[+F]F[-F]FF has six F of 12 modules");
    bench.keys("u").settle();
    assert_eq!(state(&bench).1, 61);
}

#[test]
fn words_that_are_too_long_are_refused_and_those_that_cannot_be_drawn_say_why() {
    let mut bench = looking();
    for _ in 0..9 {
        bench.keys(".").settle();
    }
    let (step, modules, ..) = state(&bench);
    assert!((61..=1_000_000).contains(&modules) && step >= 8, "{step} {modules}");
    let fault = debugger(&bench).fault.clone().unwrap();
    assert!(fault.contains("1000000 modules"), "{fault}");
    bench.keys(",").settle();
    assert!(debugger(&bench).fault.is_none());
}

#[test]
fn a_word_that_the_turtle_cannot_draw_is_looked_at_all_the_same() {
    let mut bench = Bench::grown(120, 40).without_pictures();
    shape::grammar::take_text(&mut bench.model, "axiom = F\nF -> F{F\n");
    bench.settle();
    assert!(bench.model.tree.as_ref().unwrap().fault.is_some(), "no tree grows");
    bench.keys("d").settle();
    // FF would be two; each F has a { and an F behind it: F{F{F{F.
    let word = debugger(&bench).word.as_ref().unwrap();
    assert_eq!(word.traced.to_string(), "F{F{F{F");
    let why = word.traced.undrawn.as_ref().unwrap().to_string();
    assert!(word.plant.is_none() && bench.screen().contains(&why[..20]), "{why}: {}", bench.screen());
    bench.keys("( .").settle();
    assert_eq!(state(&bench).0, 1);
}

#[test]
fn a_tree_of_too_many_modules_is_looked_at_as_far_as_can_be() {
    let mut bench = Bench::grown(120, 40).without_pictures();
    // 100 modules for each, up to a hundred million: none is drawn.
    shape::grammar::take_text(&mut bench.model, &format!("axiom = FX\nX -> {}\n", "X".repeat(100)));
    let now = bench.model.now;
    bench.model.tree.as_mut().unwrap().set("derivations", "4", now).unwrap();
    bench.keys("d").settle();
    assert_eq!((state(&bench).0, state(&bench).1), (2, 10_001));
}

#[test]
fn what_grows_without_a_grammar_has_no_derivation() {
    let mut bench = Bench::new(120, 40).without_pictures().with_tree();
    bench.keys("/").types("fir").keys("enter").settle();
    bench.keys("d");
    assert!(bench.model.dialogs.is_empty());
    assert!(bench.screen().contains("grows without a grammar"), "{}", bench.screen());
}

#[test]
fn small_screens_show_what_they_can() {
    for (columns, rows) in [(200, 60), (80, 24), (60, 18), (40, 12), (20, 5), (4, 2), (1, 1)] {
        let mut bench = Bench::grown(columns, rows).without_pictures();
        bench.keys("d").settle();
        bench.keys("l l j . b n v").settle();
        bench.keys(", ,").settle();
        let screen = bench.screen();
        if columns >= 40 {
            assert!(screen.contains("F[+F]"), "{columns}x{rows}: {screen}");
        }
    }
}

#[test]
fn a_click_means_the_letter_that_stands_there_also_above_a_warning() {
    let mut bench = Bench::grown(120, 40).without_pictures();
    // Each module says which it is, and the open brace keeps a warning below them.
    shape::grammar::take_text(&mut bench.model, "axiom = {A(1)\nA(n) -> F(n)A(n+1)\n");
    let now = bench.model.now;
    bench.model.tree.as_mut().unwrap().set("derivations", "400", now).unwrap();
    bench.keys("d").settle();
    bench.keys("G").settle();
    let area = view::areas(&bench.model).word;
    let row = bench.screen().lines().nth(area.y.into()).unwrap().to_owned();
    bench.mouse(MouseEventKind::Down(MouseButton::Left), area.x, area.y);
    let pointed = debugger(&bench).module().unwrap().to_string();
    assert!(row.contains(&format!("│ {pointed}")), "{pointed}: {row}");
}
