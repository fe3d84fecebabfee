//! Trees come while keys are held; and the workbench wakes in time, never for nothing.

use std::sync::Arc;
use std::time::Duration;

use super::testing::Bench;
use super::tree::TreePlace;
use super::update::{Msg, wake_at};
use crate::jobs::{Watcher, grow_shown};
use crate::source::forest::AnySource;

/// Does what the runtime does when it wakes: whether anything is due then that was not done.
fn wakes_for_something(bench: &mut Bench) -> bool {
    let Some(at) = wake_at(&bench.model) else { return true };
    bench.wait(at.saturating_duration_since(bench.model.now));
    wake_at(&bench.model).is_none_or(|next| next > bench.model.now)
}

#[test]
fn the_turntable_sleeps_between_its_frames_here_and_over_a_network() {
    for says in [&[][..], &[("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")]] {
        let mut bench = Bench::on(100, 30, says, "auto").with_tree();
        bench.run("turntable");
        assert!(bench.model.picture.is_turning());
        for _ in 0..5 {
            let yaw = bench.model.picture.camera.yaw_deg;
            assert!(wakes_for_something(&mut bench));
            assert!(bench.model.picture.camera.yaw_deg != yaw, "it woke to turn");
        }
    }
}

#[test]
fn a_workbench_that_is_left_alone_sleeps() {
    let mut bench = Bench::grown(100, 30);
    bench.settle().wait(Duration::from_mins(1));
    assert_eq!(wake_at(&bench.model), None);
}

#[test]
fn a_tree_that_a_held_key_has_overtaken_is_seen_until_the_newer_one_is_there() {
    let mut bench = Bench::grown(100, 30);
    let turn = |bench: &mut Bench, length_m: &str| {
        let now = bench.model.now;
        let tree = bench.model.tree.as_mut().unwrap();
        tree.set("segment_length", length_m, now).unwrap();
        Arc::clone(tree.wanted())
    };
    let grow = |recipe| grow_shown(recipe, &Watcher::idle()).unwrap().unwrap();
    let on_screen = |bench: &Bench| Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let wanted = ["0.2", "0.3"].map(|length_m| turn(&mut bench, length_m));
    let [first, second] = wanted.each_ref().map(grow);
    bench.msg(Msg::Grown(Ok(Arc::clone(&first))));
    assert!(Arc::ptr_eq(&on_screen(&bench), &first), "the newer one has not grown yet");
    bench.msg(Msg::Grown(Ok(Arc::clone(&second))));
    bench.msg(Msg::Grown(Ok(Arc::clone(&first))));
    assert!(Arc::ptr_eq(&on_screen(&bench), &second), "what is wanted stays");

    // Nothing of it comes after an undo, or where another tree was chosen.
    bench.model.tree.as_mut().unwrap().undo();
    bench.msg(Msg::Grown(Ok(Arc::clone(&first))));
    assert!(Arc::ptr_eq(&on_screen(&bench), &second));
    bench.model.loading = Some(TreePlace::Builtin("fir"));
    let fir = crate::source::resolve("fir".as_ref(), &[], &linden::Quiet).unwrap();
    bench.msg(Msg::Loaded(TreePlace::Builtin("fir"), Ok(AnySource::Tree(Box::new(fir)))));
    bench.msg(Msg::Grown(Ok(first)));
    assert!(bench.model.tree.as_ref().unwrap().shown.is_none());
}
