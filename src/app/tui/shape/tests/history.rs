//! What undo and redo promise.

use std::time::Duration;

use crate::tui::testing::key_event;

use super::*;

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
