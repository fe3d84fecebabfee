//! Work that is kept: through a kill, beside another workbench, and when the disk takes nothing.

use rustix::process::Signal;

use crate::harness::{End, Home, Setup, Workbench, eventually};

/// Waits until the session says something.
#[track_caller]
fn kept(home: &Home, words: &str) {
    let path = home.file("state/session.toml");
    let says = || std::fs::read_to_string(&path).is_ok_and(|text| text.contains(words)).then_some(());
    eventually(words, says);
}

#[test]
fn what_was_changed_outlives_a_kill_and_other_sources() {
    let home = Home::new();
    let first = Workbench::open(&home, 140, 40, &["open", "fir"]);
    first.keys("n");
    first.wait_for_text("seed 2");
    kept(&home, "source = \"fir\"\nknobs = [[\"seed\", \"2\"]]");
    first.signal(Signal::KILL);
    // Nobody gives the terminal back then.
    assert_eq!(first.process().wait(String::new), End::Signal(Signal::KILL.as_raw()));
    // Another one is opened, and changed.
    let mut second = Workbench::open(&home, 140, 40, &["open", "sphere"]);
    assert!(!second.screen().row(0).contains("modified"), "{}", second.screen().row(0));
    second.keys("n");
    second.wait_for_text("seed 2");
    second.keys("q");
    assert_eq!(second.wait_exit(), End::Code(0));
    let mut third = Workbench::open(&home, 140, 40, &["open", "fir"]);
    let title = third.screen().row(0);
    assert!(title.contains("modified") && title.contains("seed 2"), "{title}");
    // As saved again it is kept no longer.
    third.keys("R");
    third.wait_for("the fir as saved", |screen| !screen.row(0).contains("modified"));
    third.keys("q");
    assert_eq!(third.wait_exit(), End::Code(0));
    let text = std::fs::read_to_string(home.file("state/session.toml")).unwrap();
    assert!(
        text.contains("[[trees]]\nsource = \"sphere\"") && text.matches("[[trees]]").count() == 1,
        "{text}"
    );
}

#[test]
fn two_workbenches_keep_what_each_of_them_made() {
    let home = Home::new();
    let mut first = Workbench::open(&home, 140, 40, &["open", "fir"]);
    let mut second = Workbench::open(&home, 140, 40, &["open", "sphere"]);
    first.keys("*");
    first.wait_for_text("fir is a favourite now");
    first.keys("q");
    assert_eq!(first.wait_exit(), End::Code(0));
    second.keys("n");
    second.wait_for_text("seed 2");
    second.keys("q");
    assert_eq!(second.wait_exit(), End::Code(0));
    let text = std::fs::read_to_string(home.file("state/session.toml")).unwrap();
    assert!(text.contains("favourites = [\"fir\"]") && text.contains("source = \"sphere\""), "{text}");
}

#[test]
fn work_that_cannot_be_kept_is_not_left_without_a_question() {
    let home = Home::new();
    // A file where the folder should be, as a disk that takes nothing.
    std::fs::write(home.file("state"), "").unwrap();
    let mut workbench = Setup::new(140, 40).args(&["open", "fir"]).start(&home);
    workbench.wait_for_tree();
    workbench.keys("n");
    workbench.wait_for("another tree", |screen| screen.row(0).contains("seed 2"));
    workbench.keys("q");
    workbench.wait_for_text("once more leaves without the changes of a tree");
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
    assert!(workbench.screen().text().contains("not kept"), "{}", workbench.screen().text());
}
