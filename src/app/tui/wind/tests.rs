use std::time::Duration;

use crate::jobs::PictureLook;
use crate::tui::testing::Bench;
use crate::tui::update::wake_at;

/// Longer than a frame.
const MOMENT: Duration = Duration::from_millis(400);

/// The frame of the picture on screen.
fn seen(bench: &Bench) -> Option<u32> {
    bench.model.picture.painted.as_ref().and_then(|painted| painted.request.wind)
}

#[test]
fn frames_follow_the_clock_and_each_waits_for_the_picture_of_the_one_before() {
    let mut bench = Bench::grown(130, 34);
    assert!(wake_at(&bench.model).is_none(), "nothing moves");
    let calm = bench.drawn.clone();
    bench.keys("w");
    assert!(bench.model.wind.is_blowing());
    assert_eq!(bench.model.wind.frame(), Some(0));
    for _ in 0..3 {
        bench.wait(MOMENT);
    }
    assert_eq!(bench.model.wind.frame(), Some(0), "no picture came");
    let (mut frames, mut pictures) = (Vec::new(), Vec::new());
    for _ in 0..4 {
        bench.settle();
        frames.push(seen(&bench).unwrap());
        pictures.push(bench.drawn.clone());
        bench.wait(MOMENT);
    }
    assert!(frames.windows(2).all(|two| two[0] != two[1]), "{frames:?}");
    assert!(pictures.windows(2).all(|two| two[0] != two[1]) && pictures[1] != calm, "the tree moves");
    bench.keys("w").settle();
    assert!(!bench.model.wind.is_blowing());
    assert_eq!((seen(&bench), super::next_frame(&bench.model)), (None, None));
    assert!(bench.drawn == calm, "as it grew");
}

#[test]
fn the_surface_sways_too_and_growth_another_tree_or_a_gallery_ends_it() {
    let mut bench = Bench::grown(130, 34);
    bench.model.picture.look = PictureLook::Surface;
    bench.settle();
    let calm = bench.drawn.clone();
    bench.keys("w").settle();
    bench.wait(MOMENT);
    bench.settle();
    assert!(bench.drawn != calm);
    bench.keys("p");
    assert!(!bench.model.wind.is_blowing() && bench.model.growth.is_playing());
    bench.keys("w");
    assert!(bench.model.wind.is_blowing() && !bench.model.growth.is_playing());
    bench.keys("j").settle();
    assert!(!bench.model.wind.is_blowing(), "another tree is shown as it is");
}

#[test]
fn where_the_wind_is_set_to_nothing_a_breeze_is_shown_and_said() {
    let mut bench = Bench::grown(130, 34);
    bench.keys("w");
    let said =
        |bench: &Bench| bench.model.message.as_ref().map(|message| message.text.clone()).unwrap_or_default();
    assert!(said(&bench).contains("wind_strength 0.4"), "{}", said(&bench));
    bench.keys("w");
    let now = bench.model.now;
    bench.model.tree.as_mut().unwrap().set("wind_strength", "0", now).unwrap();
    bench.settle();
    bench.keys("w").settle();
    assert!(said(&bench).contains("wind_strength is 0"), "{}", said(&bench));
    let before = bench.drawn.clone();
    bench.wait(MOMENT);
    bench.settle();
    assert!(bench.drawn != before, "it moves all the same");
}
