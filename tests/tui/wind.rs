//! The wind in the picture: it moves, it stops, keys are heard meanwhile.

use std::time::Duration;

use crate::harness::{Home, Workbench, eventually};

/// The picture: what is between the lists, without the rows of title and messages.
fn picture(workbench: &Workbench) -> Vec<String> {
    workbench.screen().columns(40, 80).into_iter().skip(2).take(28).collect()
}

#[test]
fn the_tree_sways_until_the_wind_is_ended_and_keys_are_heard() {
    let home = Home::new();
    let args = ["open", "dressed-honda-a", "--set", "wind_strength=1"];
    let workbench = Workbench::open(&home, 120, 36, &args);
    // Cells are chosen by what was there before, too: both pictures are drawn on an empty screen.
    std::thread::sleep(Duration::from_secs(1));
    workbench.keys("\x0c");
    workbench.settle();
    let calm = picture(&workbench);
    workbench.keys("w");
    workbench.wait_for_text("wind_strength 1");
    // Several frames, each another picture.
    let mut seen = vec![calm.clone()];
    eventually("five pictures of the tree", || {
        let now = picture(&workbench);
        if !seen.contains(&now) {
            seen.push(now);
        }
        std::thread::sleep(Duration::from_millis(20));
        (seen.len() > 5).then_some(())
    });
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
    workbench.keys("\x1b");
    workbench.wait_for("the help to go", |screen| !screen.text().contains("╭ Help"));
    workbench.keys("w");
    workbench.settle();
    workbench.keys("\x0c");
    workbench.settle();
    assert_eq!(picture(&workbench), calm, "as it grew");
    let before = (workbench.sent(), workbench.process().ticks());
    std::thread::sleep(Duration::from_secs(1));
    // The message goes; nothing else happens.
    assert!(workbench.sent() - before.0 < 1000, "{} bytes", workbench.sent() - before.0);
    assert!(workbench.process().ticks() - before.1 <= 2, "nothing is drawn in a calm");
}
