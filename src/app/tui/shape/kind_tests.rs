//! Kinds of foliage in the form, as a user has them: added, named, turned, taken away, undone, saved.

use linden::Quiet;
use linden::preset::{Form, LeafKind};

use super::{kinds, save};
use crate::tui::effect::Effect;
use crate::tui::model::FormSpot;
use crate::tui::testing::form::{FormBench, text};
use crate::tui::tree::TreePlace;
use crate::tui::update::Msg;

fn also(bench: &FormBench) -> &[LeafKind] {
    &bench.tree().preset().dressing.foliage.also
}

fn on_kind(bench: &mut FormBench, kind: usize) -> &mut FormBench {
    bench.model.form.selected = Some(FormSpot::Kind(kind));
    bench
}

#[test]
fn each_kind_stands_in_the_form_with_its_knobs() {
    let mut bench = FormBench::new("apple");
    on_kind(&mut bench, 0);
    let screen = text(&bench.paint(100, 40).0);
    assert!(screen.contains("Foliage also.1: blossom"), "{screen}");
    assert!(screen.contains("blossom.leaf_keep=0"), "how a command line names it: {screen}");
    let first = bench.value("leaf_length");
    bench.on("also.1.leaf_length").keys("right");
    assert_ne!(bench.value("also.1.leaf_length"), "0.036");
    assert_eq!(bench.value("leaf_length"), first, "the first kind's stays");
    let screen = text(&bench.paint(100, 40).0);
    assert!(screen.contains("●leaf_length") && screen.contains("─ blossom.leaf_length ─"), "{screen}");
    bench.keys("r");
    assert!(!bench.tree().is_modified());
}

#[test]
fn a_kind_is_added_named_turned_by_its_name_and_taken_away() {
    let mut bench = FormBench::new("oak");
    assert!(also(&bench).is_empty());
    bench.keys("+");
    assert_eq!(also(&bench).len(), 1);
    assert_ne!(also(&bench)[0].form, Form::None, "a document could not say it");
    assert_eq!(bench.tree().preset().kind_labels(), ["blossom"]);
    bench.keys("enter").typed("catkins\n");
    assert_eq!(also(&bench)[0].name.as_deref(), Some("catkins"));
    // The palette turns it by that name, and puts the cursor on it.
    bench.keys(":").typed("catkins.leaf_keep 0.5\n");
    assert_eq!(also(&bench)[0].keep, 0.5, "{}", bench.said());
    assert_eq!(bench.model.form.selected, Some(FormSpot::Knob("also.1.leaf_keep")));
    // From within a kind a copy of it is added, without its name, which no two may have.
    bench.keys("+");
    assert_eq!((also(&bench)[1].keep, also(&bench)[1].name.as_deref()), (0.5, None));
    bench.keys("enter").typed("catkins\n");
    assert_eq!(also(&bench)[1].name, None);
    bench.keys("esc");
    on_kind(&mut bench, 0).keys("delete");
    assert_eq!((also(&bench).len(), also(&bench)[0].name.as_deref()), (1, None), "{}", bench.said());
    bench.keys("u");
    assert_eq!(also(&bench)[0].name.as_deref(), Some("catkins"));
    // By the names that the form has, never by the numbers of documents.
    assert_eq!(bench.said(), "undone: the kind of foliage catkins is there");
    assert_eq!(bench.model.form.selected, Some(FormSpot::Kind(0)));
    bench.keys("u u");
    assert_eq!(bench.said(), "undone: catkins.leaf_keep 0.5 → 1");
    bench.keys("u");
    assert_eq!(bench.said(), "undone: the kind of foliage catkins → blossom");
    bench.keys("u");
    assert_eq!(bench.said(), "undone: the kind of foliage blossom is gone");
    bench.keys("ctrl-r");
    assert_eq!(bench.said(), "done again: the kind of foliage blossom is there");
    bench.keys("ctrl-r ctrl-r");
    assert_eq!(bench.said(), "done again: catkins.leaf_keep 1 → 0.5");
    bench.keys("ctrl-r");
    bench.keys("u u u u");
    assert!(!bench.tree().is_modified() && also(&bench).is_empty());
    bench.keys("ctrl-r ctrl-r ctrl-r ctrl-r ctrl-r");
    assert_eq!(also(&bench).len(), 1);
    assert!(bench.tree().preset().dressing.foliage.first.form != Form::None, "the first is no further kind");
}

#[test]
fn no_more_kinds_are_added_than_a_document_may_have() {
    let mut bench = FormBench::new("oak");
    bench.keys("+ + + + + + + + +");
    assert_eq!(also(&bench).len(), linden::preset::MOST_KINDS - 1);
    assert!(bench.said().contains("8 kinds"), "{}", bench.said());
    assert!(kinds::is_full(&bench.model).is_some());
}

#[test]
fn changed_alone_lists_kinds_and_their_knobs() {
    let mut bench = FormBench::new("apple");
    bench.on("also.1.leaf_keep").keys("left *");
    let screen = text(&bench.paint(100, 40).0);
    let has = |screen: &str, line: &str| screen.contains(line);
    assert!(has(&screen, "Foliage also.1: blossom") && has(&screen, "●leaf_keep"), "{screen}");
    assert!(!has(&screen, "leaf_outline"), "{screen}");
    bench.keys("* u");
    // A kind that has another name alone.
    on_kind(&mut bench, 0).keys("enter").typed("may\n").keys("*");
    let screen = text(&bench.paint(100, 40).0);
    assert!(has(&screen, "Foliage also.1: may") && !has(&screen, "leaf_outline"), "{screen}");
}

#[test]
fn kinds_are_saved_and_read_again() {
    let dir = tempfile::tempdir().unwrap();
    let presets = dir.path().join("presets");
    let mut bench = FormBench::at(TreePlace::Builtin("apple"), dir.path().to_owned());
    bench.on("also.1.leaf_keep").typed("i0.25\n").keys("+ s enter");
    let Some(Effect::Save { id, from, recipe, overwrite, .. }) = bench.effects.pop() else {
        panic!("not saved")
    };
    bench.send(Msg::Saved(save::write(&presets, &id, &from, &recipe, overwrite)));
    let path = presets.join("apple-2.toml");
    let read = crate::source::resolve(&path, &[], &Quiet).unwrap().recipe.preset;
    assert_eq!(read, *bench.tree().preset());
    assert_eq!(
        read.dressing.foliage.also.iter().map(|kind| kind.keep).collect::<Vec<_>>(),
        [0.25, 0.4, 0.25]
    );
    let document = std::fs::read_to_string(path).unwrap();
    assert!(document.contains("[[foliage.also]] # clusters on short spurs"), "{document}");
}
