use std::sync::Arc;
use std::time::Duration;

use linden::recipe::Recipe;

use crate::jobs::{Watcher, grow_shown, stage};
use crate::tui::testing::Bench;

/// Longer than any step is looked at.
const STEP: Duration = Duration::from_secs(1);

#[test]
fn every_derivation_is_seen_once_and_the_last_is_the_grown_tree() {
    let mut bench = Bench::grown(130, 34);
    bench.keys("p");
    let mut seen = Vec::new();
    while bench.model.growth.is_playing() {
        bench.settle();
        seen.push(bench.model.picture.painted.as_ref().and_then(|painted| painted.request.stage));
        bench.wait(STEP);
        assert!(seen.len() < 10, "{seen:?}");
    }
    assert_eq!(seen, [Some(0), Some(1)], "the second derivation is the grown tree");
    assert_eq!(bench.model.growth.step(), None);
}

#[test]
fn a_step_waits_for_the_picture_of_the_one_before_and_wakes_nobody() {
    let mut bench = Bench::grown(130, 34);
    bench.keys("p");
    for _ in 0..3 {
        bench.wait(STEP);
    }
    assert_eq!(bench.model.growth.step(), Some(0), "no picture came");
    assert!(bench.model.growth.is_playing() && bench.model.growth.next_frame().is_none());
    bench.settle();
    assert_eq!(bench.model.growth.step(), Some(1), "the picture came, and the next step was due");
}

#[test]
fn keys_and_the_bar_go_where_they_say() {
    let mut bench = Bench::grown(130, 34);
    for (keys, step) in [
        (",", Some(1)),
        (",", Some(0)),
        (",", Some(0)),
        (".", Some(1)),
        (".", None),
        ("(", Some(0)),
        (")", None),
    ] {
        bench.keys(keys);
        assert_eq!(bench.model.growth.step(), step, "{keys}");
        assert!(!bench.model.growth.is_playing());
    }
    bench.keys("p p");
    assert!(!bench.model.growth.is_playing(), "the second pauses");
    bench.keys("j").settle();
    assert_eq!(bench.model.growth.step(), None, "another tree is shown as it is");
}

#[test]
fn a_stage_of_colonization_has_what_was_born_until_then() {
    let preset = linden::preset::builtin("fir").unwrap().load().unwrap();
    let recipe = Arc::new(Recipe::new(preset));
    let shown = grow_shown(&recipe, &Watcher::idle()).unwrap().unwrap();
    let births = &shown.grown.skeleton.births;
    for step in [1, shown.steps / 2, shown.steps] {
        let young = stage(&shown, step, &Watcher::idle()).unwrap().unwrap();
        let expected = births.iter().filter(|birth| **birth <= step).count();
        assert_eq!(young.skeleton.positions.len(), expected, "{step}");
    }
}

#[test]
fn the_age_that_is_told_is_of_the_step_on_screen() {
    use linden::knob::Value;
    use linden::skeleton::generator::Steps;
    for count in [2, 7, 24, 44, 392] {
        for step in 1..count {
            let told = super::shortened(&Value::Real(f64::from(step) / f64::from(count)));
            assert!(told.len() <= 6, "{told}");
            assert_eq!(Steps::after(told.parse().unwrap(), count), step, "{told} of {count}");
        }
    }
    let mut bench = Bench::new(140, 30).without_pictures().with_plain("so-hazel");
    bench.model.growth.step = Some(0);
    let (on_screen, made_by) = super::younger(&bench.model).unwrap();
    assert!(on_screen.starts_with("year 0 of "), "{on_screen}");
    assert_eq!(made_by, None, "no age is of no year");
    assert!(bench.screen().contains("grown: "), "whose numbers they are: {}", bench.screen());
    bench.model.growth.step = Some(1);
    assert!(super::younger(&bench.model).unwrap().1.is_some_and(|made_by| made_by.starts_with("age=0.")));
    let mut bench = Bench::new(100, 30).without_pictures().with_plain("grove");
    let last = super::last_step(super::shown(&bench.model).unwrap());
    bench.model.growth.step = Some(last / 2);
    let (_, made_by) = super::younger(&bench.model).unwrap();
    assert!(made_by.is_some_and(|made_by| made_by.starts_with("age=0.")), "iterations have an age too");
}
