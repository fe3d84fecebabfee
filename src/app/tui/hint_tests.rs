//! What the footer offers is what the keys do; what cannot be done says why.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use linden_terminal::input::Shortcut;

use super::chrome::footer::{hints, label_of};
use super::command::Context;
use super::commands;
use super::testing::Bench;

/// How a situation comes about: commands that are run on a workbench with a tree.
type Path = Vec<&'static str>;

/// A workbench in a situation, seen.
fn bench(path: &[&str]) -> Bench {
    let mut bench = unseen(path);
    bench.look();
    bench
}

fn unseen(path: &[&str]) -> Bench {
    // One in which chance has a part: it can be varied.
    let bench = Bench::new(160, 48).unwatched();
    // A crown can be shaped where there is one.
    let shapes = path.first() == Some(&"crown-edit");
    let mut bench = if shapes { bench.with_plain("simple") } else { bench.with("abop-stochastic") };
    for id in path {
        bench.run(id);
    }
    bench.model.message = None;
    bench
}

/// Everything that a command may change.
fn state(bench: &Bench) -> String {
    let model = &bench.model;
    let picture = &model.picture;
    format!(
        "{}\n{:?}\n{:?} {:?} {} {} {}\n{:?} {:?}\n{:?} {:?} {:?}",
        bench.screen(),
        picture.camera,
        model.context(),
        model.focus,
        picture.is_turning(),
        picture.points,
        picture.outline,
        model.growth.step(),
        (model.growth.is_playing(), model.wind.is_blowing()),
        model.tree.as_ref().map(|tree| (tree.overrides(), tree.compares, tree.can_redo())),
        bench.effects,
        // What the jobs are asked for.
        super::export::wanted(model).map(|inquiry| (inquiry.round, inquiry.completes)),
    )
}

fn assert_same(a: &Bench, b: &Bench, what: &str) {
    let (a, b) = (state(a), state(b));
    for (a, b) in a.lines().zip(b.lines()) {
        assert_eq!(a, b, "{what}");
    }
}

/// Situations in every context that can be reached: each pane, then whatever commands open from
/// there, and once more.
fn situations() -> &'static [Path] {
    static ALL: OnceLock<Vec<Path>> = OnceLock::new();
    ALL.get_or_init(find_situations)
}

fn find_situations() -> Vec<Path> {
    // From the seed over the grammar to the first knob of the L-system.
    let knob = || vec!["focus-previous", "knob-next", "knob-next", "knob-next"];
    let panes: [Path; 3] = [vec![], vec!["focus-next"], knob()];
    let mut all: Vec<Path> = panes.to_vec();
    all.push([knob(), vec!["knob-more"]].concat());
    all.push([knob(), vec!["knob-more", "undo"]].concat());
    all.push(vec!["growth-start"]);
    all.push(vec!["focus-next", "zoom-in"]);
    all.push(vec!["help", "page-last"]);
    all.push(vec!["crown-edit"]);
    // The rows of the first format: its options, then its target.
    for row in 1..5 {
        let first = vec!["export", "export-first", "export-toggle"];
        all.push([first, vec!["export-next"; row]].concat());
    }
    let mut seen: BTreeSet<Context> = panes.iter().map(|path| unseen(path).model.context()).collect();
    let mut from = all.clone();
    while let Some(path) = from.pop() {
        let here = unseen(&path);
        for command in commands::all() {
            let is_heard = command.context == here.model.context() || command.context == Context::GLOBAL;
            if !is_heard || (command.hindrance)(&here.model).is_some() {
                continue;
            }
            let mut next = path.clone();
            next.push(command.id);
            if seen.insert(unseen(&next).model.context()) {
                all.push(next.clone());
                from.push(next);
            }
        }
    }
    all
}

#[test]
fn every_context_with_commands_can_be_reached() {
    let reached: BTreeSet<Context> = situations().iter().map(|path| unseen(path).model.context()).collect();
    for command in commands::all() {
        let is_everywhere = [Context::ALWAYS, Context::GLOBAL].contains(&command.context);
        assert!(is_everywhere || reached.contains(&command.context), "{} in {reached:?}", command.id);
    }
}

#[test]
fn every_hinted_key_does_what_it_says() {
    let mut does: BTreeMap<&str, bool> = BTreeMap::new();
    for path in situations() {
        let offered = hints(&bench(path).model);
        assert!(!offered.is_empty(), "{path:?}: nothing is offered");
        for hint in offered {
            let id = hint.command.id;
            let keys = bench(path).model.config.keymap.keys_of(id).to_vec();
            let shown: Vec<&Shortcut> =
                keys.iter().filter(|key| label_of(&key.to_string(), true) == hint.key).collect();
            let [key] = shown[..] else { panic!("{path:?} {id}: {} is {shown:?}", hint.key) };
            let mut pressed = bench(path);
            let before = state(&pressed);
            pressed.press((*key).into());
            let mut run = bench(path);
            run.run(id);
            assert_same(&pressed, &run, &format!("{path:?}: {} is not {id}", hint.key));
            *does.entry(id).or_insert(false) |= state(&pressed) != before;
        }
    }
    // What is at its end already has nothing to do, but somewhere it has.
    for (id, something) in does {
        assert!(something, "{id} is offered and never does anything");
    }
}

#[test]
fn a_click_on_a_hint_runs_it() {
    use crossterm::event::{MouseButton, MouseEventKind};
    for path in situations() {
        for hint in hints(&bench(path).model) {
            let mut clicked = bench(path);
            let target = super::layout::Target::Command(hint.command.id);
            let Some((area, _)) = clicked.model.regions.iter().find(|(_, other)| *other == target) else {
                continue;
            };
            let (x, y) = (area.x, area.y);
            clicked.mouse(MouseEventKind::Down(MouseButton::Left), x, y);
            let mut run = bench(path);
            run.run(hint.command.id);
            assert_same(&clicked, &run, &format!("{path:?}: {}", hint.command.id));
        }
    }
}

#[test]
fn commands_run_everywhere_without_harm_and_those_that_cannot_say_why() {
    let mut paths = situations().to_vec();
    let empty = paths.len();
    paths.push(vec![]);
    for (i, path) in paths.iter().enumerate() {
        let there = || if i == empty { Bench::new(100, 30).unwatched() } else { unseen(path) };
        // What cannot be run changes nothing but the message: one workbench hears of all of it.
        let mut unmoved = there();
        unmoved.look();
        unmoved.screen();
        let before = state(&unmoved);
        for command in commands::all() {
            let Some(why) = (command.hindrance)(&unmoved.model) else {
                let mut bench = there();
                bench.run(command.id);
                bench.screen();
                continue;
            };
            unmoved.run(command.id);
            let said = unmoved.model.message.take().map(|message| message.text);
            assert_eq!(said, Some(format!("{}: {why}", command.title)), "{path:?}");
            assert_eq!(state(&unmoved), before, "{path:?} {}", command.id);
            assert!(why.len() > 5 && !why.ends_with('.'), "{why}");
        }
    }
}

#[test]
fn the_footer_never_cuts_a_hint() {
    for path in situations() {
        let offered = hints(&bench(path).model);
        let words: Vec<String> = offered.iter().map(|hint| format!("{} {}", hint.key, hint.label)).collect();
        let mut bench = bench(path);
        if bench.model.dialogs.last().is_some_and(super::dialog::Dialog::is_prompt) {
            continue;
        }
        for columns in (1..=160).step_by(3) {
            bench.msg(super::update::Msg::Resized(columns, 20));
            let screen = bench.screen();
            let footer = screen.lines().last().unwrap_or_default().to_owned();
            let mut rest = footer.trim();
            while !rest.is_empty() {
                let word =
                    words.iter().filter(|word| rest.starts_with(word.as_str())).max_by_key(|w| w.len());
                let Some(word) = word else { panic!("{path:?} at {columns}: '{rest}' is no hint") };
                rest = rest[word.len()..].trim_start();
            }
        }
    }
}

#[test]
fn the_palette_judges_commands_as_they_will_run() {
    let mut bench = Bench::grown(100, 30);
    bench.keys(":").types("undo");
    assert!(bench.screen().contains("nothing was changed"), "{}", bench.screen());
    bench.keys("enter");
    assert_eq!(
        bench.model.context(),
        super::chrome::prompt::CONTEXT,
        "what cannot be run leaves the palette open"
    );
    assert!(bench.model.message.as_ref().is_some_and(|said| said.text == "Undo: nothing was changed"));
    // A change that comes while it is open counts at once.
    let preset = bench.model.tree.as_ref().map(|tree| tree.preset().clone()).unwrap();
    let mut other = preset.clone();
    other.set("seed", "77").unwrap();
    bench.model.tree.as_mut().unwrap().replace(other);
    bench.wait(std::time::Duration::from_secs(20));
    assert!(!bench.screen().contains("nothing was changed"), "{}", bench.screen());
    bench.keys("enter");
    assert!(bench.model.dialogs.is_empty());
    assert!(*bench.model.tree.as_ref().unwrap().preset() == preset);
}
