use super::*;
use crate::jobs::{Watcher, measure};
use crate::tui::testing::Bench;
use crate::tui::update::Msg;

#[test]
fn the_page_measures_the_tree_on_screen_and_no_other() {
    let mut bench = Bench::new(130, 60).without_pictures().with_plain("abop-a");
    assert!(wanted(&bench.model).is_none(), "nobody asked");
    bench.keys("S");
    assert!(bench.screen().contains("measuring"), "{}", bench.screen());
    let shown = wanted(&bench.model).unwrap();
    let figures = measure(Arc::clone(&shown), &Watcher::idle()).unwrap();
    bench.msg(Msg::Measured(Box::new(figures)));
    assert!(wanted(&bench.model).is_none(), "once is enough");
    let screen = bench.screen();
    // Written as in the title.
    let nodes = crate::figures::thousands(shown.grown.skeleton.positions.len() as u64);
    assert!(nodes.contains(' ') && screen.matches(&nodes).count() > 1, "{nodes}: {screen}");
    // The same as the skeleton's own measures, and a line for each format that has an estimate.
    let height = format!("{:.4}", shown.measures.height_m);
    for text in [&height[..5], "Files", "glb", "usda", "to grow", "memory"] {
        assert!(screen.contains(text), "{text}: {screen}");
    }
    // Another tree takes its place: its numbers are asked for.
    bench.keys("esc");
    let tree = bench.model.tree.as_mut().unwrap();
    tree.set("segment_length", "0.5", bench.model.now).unwrap();
    bench.settle();
    bench.keys("S");
    let other = wanted(&bench.model).unwrap();
    assert!(!Arc::ptr_eq(&other, &shown));
    assert!(bench.screen().contains("measuring"));
}
