//! Widths: `!(w)` and `!`.

use linden::lsystem::TurtleSettings;

use crate::{drawn, drawn_with};

fn radii(axiom: &str, change: impl FnOnce(&mut TurtleSettings)) -> Vec<f32> {
    drawn_with(axiom, change).branching.radii.unwrap()
}

#[test]
fn a_number_is_a_diameter_in_segment_widths() {
    // A foot is as thick as its first segment, a node as the segment that ends in it.
    let radii = radii("!(4)F!(3)F[!(1)F]F", |s| s.segment_width_m = 0.02);
    assert_eq!(radii, [0.04, 0.04, 0.03, 0.01, 0.03]);
}

#[test]
fn without_a_number_the_ratio_thins() {
    let thinned = radii("F!F[!F]F!!F", |s| (s.segment_width_m, s.width_ratio) = (0.5, 0.5));
    // The first width is 1; a branch does not thin what follows it.
    assert_eq!(thinned, [0.25, 0.25, 0.125, 0.0625, 0.125, 0.031_25]);
    assert_eq!(radii("!F", |s| s.width_ratio = 0.25), [0.001_25; 2]);
}

#[test]
fn a_grammar_without_widths_leaves_radii_to_the_wood() {
    assert_eq!(drawn("F[+F]F", 30.0).radii, None);
}

#[test]
fn wood_never_vanishes_and_never_becomes_infinite() {
    let many = format!("{}F", "!".repeat(5000));
    let thinner = radii(&many, |s| s.width_ratio = 0.01);
    assert!(thinner.iter().all(|&r| r > 0.0 && r < 1e-5));
    let thicker = radii(&many, |s| s.width_ratio = 10.0);
    assert!(thicker.iter().all(|&r| r.is_finite() && r > 1e5));
}
