//! Keys while a tree grows.

use crate::harness::{Home, Workbench};

/// How far the growing is, as the picture says it.
fn is_growing(workbench: &Workbench) -> bool {
    let text = workbench.screen().text();
    ["growing", "scattering", " of "].iter().any(|word| text.contains(word))
        && !workbench.screen().row(0).contains("nodes")
}

#[test]
fn each_key_is_answered_before_the_tree_has_grown() {
    let home = Home::new();
    // So large that no machine is done with it before all keys are answered, however late its terminal.
    let workbench = Workbench::while_it_grows(&home, 1_000_000);
    workbench.keys("\t\t");
    workbench.wait_for("the form's hints", |screen| screen.footer().contains("More"));
    for round in 0..20 {
        let before = workbench.screen().form_cursor();
        workbench.keys(if round % 4 < 2 { "j" } else { "k" });
        workbench.wait_for("the cursor", |screen| screen.form_cursor() != before);
    }
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
    workbench.keys("\x1b");
    workbench.wait_for("the form", |screen| screen.footer().contains("More"));
    // All of that while no tree was there yet.
    assert!(is_growing(&workbench), "{}", workbench.screen().text());
}

#[test]
fn a_knob_that_is_turned_ends_the_growing_of_what_is_no_longer_wanted() {
    let home = Home::new();
    let workbench = Workbench::while_it_grows(&home, 150_000);
    // Back to a small tree: another preset.
    workbench.keys("G");
    workbench.wait_for("a small tree", |screen| {
        screen.row(0).contains("nodes") && !screen.row(0).contains("Sphere")
    });
    workbench.settle();
}
