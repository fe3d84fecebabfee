//! Tropism by ABOP's formula, section 2.1: after each segment, e·|H × T| radians about H × T.

use glam::DVec3;
use linden::Branching;

use crate::drawn_with;

fn bent(axiom: &str, tropism: [f64; 3], e: f64) -> Branching {
    let grown = drawn_with(axiom, |s| {
        s.angle_deg = 90.0;
        s.tropism = tropism;
        s.susceptibility = e;
    });
    grown.branching
}

#[test]
fn in_a_plane_the_angle_follows_a_recurrence() {
    // The angle a from straight up grows by e·sin(a) towards T = −Y with each segment.
    let e = 0.22;
    let branching = bent("+(40)FFFFFFFF", [0.0, -1.0, 0.0], e);
    let (mut angle, mut at) = (40.0_f64.to_radians(), DVec3::ZERO);
    for position in &branching.positions[1..] {
        let (sin, cos) = libm::sincos(angle);
        at += DVec3::new(-sin, cos, 0.0);
        assert!(position.as_dvec3().distance(at) < 1e-6, "{position} is not {at}");
        angle += e * sin;
    }
    assert!(angle > 100.0_f64.to_radians());
}

#[test]
fn the_whole_frame_turns() {
    // H = −X bends by e towards −Y about H × T = Z. L lies in the picture's plane and turns with it:
    // `&` pitches straight away from U, `+` to the left of what H has become.
    let e = 0.3;
    let branching = bent("+F&F", [0.0, -1.0, 0.0], e);
    assert!(branching.positions[2].as_dvec3().distance(DVec3::new(-1.0, 0.0, -1.0)) < 1e-6);
    let branching = bent("+F+F", [0.0, -1.0, 0.0], e);
    // 90° to the left of H = (−cos e, −sin e).
    let expected = DVec3::new(-1.0 + libm::sin(e), -libm::cos(e), 0.0);
    assert!(branching.positions[2].as_dvec3().distance(expected) < 1e-6);
}

#[test]
fn the_length_of_the_vector_counts_and_its_direction_may_be_any() {
    // Rodrigues' formula by hand, for a slanted vector of length 2.
    let t = DVec3::new(-0.61, 0.77, -0.19) * 2.0;
    let e = 0.4;
    let branching = bent("FF", t.to_array(), e);
    let h = DVec3::Y;
    let torque = h.cross(t);
    let (sin, cos) = libm::sincos(e * torque.length());
    let bent = h * cos + torque.normalize().cross(h) * sin;
    assert!(branching.positions[2].as_dvec3().distance(h + bent) < 1e-6);
}

#[test]
fn along_the_vector_and_without_susceptibility_nothing_bends() {
    assert_eq!(bent("FFF", [0.0, -1.0, 0.0], 0.9), bent("FFF", [0.0, -1.0, 0.0], 0.0));
    assert_eq!(bent("+(20)F&F/F", [1.0, 2.0, 3.0], 0.0), bent("+(20)F&F/F", [0.0, -1.0, 0.0], 0.0));
}

#[test]
fn a_branch_does_not_bend_its_parent_and_a_move_does_not_bend() {
    let branching = bent("+F[F]F", [0.0, -1.0, 0.0], 0.5);
    assert_eq!(branching.positions[2], branching.positions[3]);
    let moved = bent("+fF", [0.0, -1.0, 0.0], 0.5);
    assert!(moved.positions[1].as_dvec3().distance(DVec3::new(-2.0, 0.0, 0.0)) < 1e-6);
}
