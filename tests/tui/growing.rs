//! Keys while a tree grows.

use std::time::Instant;

use super::harness::{Home, Setup, Workbench};

/// Some hundred thousand nodes: seconds, on any machine.
pub const LARGE: [&str; 6] = ["open", "sphere", "--set", "points=150000", "--set", "step=0.02"];

/// How far the growing is, as the picture says it.
fn is_growing(workbench: &Workbench) -> bool {
    let text = workbench.screen().text();
    ["growing", "scattering", " of "].iter().any(|word| text.contains(word))
        && !workbench.screen().row(0).contains("nodes")
}

/// A workbench in which a large tree has begun to grow.
pub fn while_it_grows(home: &Home) -> Workbench {
    let workbench = Setup::new(120, 40).args(&LARGE).start(home);
    workbench.wait_for("the preset", |screen| screen.row(0).contains("Sphere"));
    workbench
}

#[test]
fn each_key_is_answered_before_the_tree_has_grown() {
    let home = Home::new();
    let workbench = while_it_grows(&home);
    let mut answered = Vec::new();
    workbench.keys("\t\t");
    workbench.wait_for("the form's hints", |screen| screen.footer().contains("More"));
    for round in 0..20 {
        let before = workbench.sent();
        let row = workbench.screen();
        let pressed = Instant::now();
        workbench.keys(if round % 4 < 2 { "j" } else { "k" });
        workbench.wait_for("the cursor", |screen| !screen.is_same(&row) && workbench.sent() > before);
        answered.push(pressed.elapsed());
    }
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
    workbench.keys("\x1b");
    workbench.wait_for("the form", |screen| screen.footer().contains("More"));
    // All of that while no tree was there yet.
    assert!(is_growing(&workbench), "{answered:?}\n{}", workbench.screen().text());
    let screen = workbench.wait_for("the tree", |screen| screen.row(0).contains(" nodes"));
    let title = screen.row(0);
    let nodes: String = title
        .split("nodes")
        .next()
        .unwrap()
        .chars()
        .rev()
        .take_while(|c| c.is_ascii_digit() || *c == ' ')
        .collect();
    let nodes: String = nodes.chars().rev().filter(char::is_ascii_digit).collect();
    let nodes: u64 = nodes.trim_start_matches('1').parse().unwrap_or(0).max(nodes[1..].parse().unwrap_or(0));
    assert!(nodes >= 100_000, "{title}");
}

#[test]
fn a_knob_that_is_turned_ends_the_growing_of_what_is_no_longer_wanted() {
    let home = Home::new();
    let workbench = while_it_grows(&home);
    // Back to a small tree: another preset.
    workbench.keys("G");
    workbench.wait_for("a small tree", |screen| {
        screen.row(0).contains("nodes") && !screen.row(0).contains("Sphere")
    });
    workbench.settle();
}
