//! Positions worked out by hand from appendix C of ABOP: the turtle looks up (+Y), its left is −X, its
//! up +Z.

use linden::{Branching, NO_PARENT, Vec3};

use crate::drawn;

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

#[track_caller]
fn assert_nodes(branching: &Branching, expected: &[(Vec3, u32)]) {
    assert_eq!(branching.parents, expected.iter().map(|&(_, parent)| parent).collect::<Vec<_>>());
    for (i, (&(at, _), &position)) in expected.iter().zip(&branching.positions).enumerate() {
        assert!(position.distance(at) < 1e-6, "node {i} is at {position}, not {at}");
    }
}

const FOOT: (Vec3, u32) = (Vec3::ZERO, NO_PARENT);

#[test]
fn plus_turns_left() {
    assert_nodes(&drawn("F+F", 90.0), &[FOOT, (v(0., 1., 0.), 0), (v(-1., 1., 0.), 1)]);
    assert_nodes(&drawn("F-F", 90.0), &[FOOT, (v(0., 1., 0.), 0), (v(1., 1., 0.), 1)]);
    assert_nodes(&drawn("+F", 30.0), &[FOOT, (v(-0.5, 0.866_025_4, 0.), 0)]);
}

#[test]
fn ampersand_pitches_down_away_from_u() {
    assert_nodes(
        &drawn("F[&F]F", 90.0),
        &[FOOT, (v(0., 1., 0.), 0), (v(0., 1., -1.), 1), (v(0., 2., 0.), 1)],
    );
    assert_nodes(&drawn("^F", 90.0), &[FOOT, (v(0., 0., 1.), 0)]);
}

#[test]
fn a_roll_to_the_left_lowers_the_left_side() {
    // Rolled left by 90°: L = −Z, U = −X. Turning left then leads to −Z.
    assert_nodes(&drawn(r"\+F", 90.0), &[FOOT, (v(0., 0., -1.), 0)]);
    assert_nodes(&drawn("/+F", 90.0), &[FOOT, (v(0., 0., 1.), 0)]);
}

#[test]
fn the_bar_turns_around() {
    assert_nodes(&drawn("F|F", 17.0), &[FOOT, (v(0., 1., 0.), 0), (v(0., 0., 0.), 1)]);
    // L turns as well: the next left is +X.
    assert_nodes(&drawn("|+F", 90.0), &[FOOT, (v(1., 0., 0.), 0)]);
}

#[test]
fn dollar_levels_the_left_side() {
    // Pitched to −Z, U = +Y, L = −X; the roll makes L = −Y. `$` brings L = V×H = −X back.
    assert_nodes(&drawn(r"&\$+F", 90.0), &[FOOT, (v(-1., 0., 0.), 0)]);
    assert_nodes(&drawn(r"&\+F", 90.0), &[FOOT, (v(0., -1., 0.), 0)]);
    // With H vertical, nothing is leveled.
    assert_nodes(&drawn(r"\$+F", 90.0), &[FOOT, (v(0., 0., -1.), 0)]);
}

#[test]
fn arguments_replace_the_angle_and_scale_the_length() {
    assert_nodes(&drawn("F(2)+(90)F( 0.5 )", 30.0), &[FOOT, (v(0., 2., 0.), 0), (v(-0.5, 2., 0.), 1)]);
    assert_nodes(&drawn("+(-90)F", 30.0), &[FOOT, (v(1., 0., 0.), 0)]);
    assert_nodes(&drawn("+(450)F", 30.0), &[FOOT, (v(-1., 0., 0.), 0)]);
}

#[test]
fn a_move_starts_a_new_stem() {
    assert_nodes(
        &drawn("Ff(2)F", 0.0),
        &[FOOT, (v(0., 1., 0.), 0), (v(0., 3., 0.), NO_PARENT), (v(0., 4., 0.), 2)],
    );
    // Nothing is drawn from the origin, and the end of a move is no node.
    assert_nodes(&drawn("ffFf", 0.0), &[(v(0., 2., 0.), NO_PARENT), (v(0., 3., 0.), 0)]);
    // A branch that moves does not move its parent.
    assert_nodes(&drawn("F[f]F", 0.0), &[FOOT, (v(0., 1., 0.), 0), (v(0., 2., 0.), 1)]);
}

#[test]
fn branches_at_one_point_share_its_node() {
    assert_nodes(
        &drawn("[F][+F]-F", 90.0),
        &[FOOT, (v(0., 1., 0.), 0), (v(-1., 0., 0.), 0), (v(1., 0., 0.), 0)],
    );
    assert_nodes(
        &drawn("f[F][+F]", 90.0),
        &[(v(0., 1., 0.), NO_PARENT), (v(0., 2., 0.), 0), (v(-1., 1., 0.), 0)],
    );
    // The foot inside the first branch moves on; the one outside stays.
    assert_nodes(
        &drawn("[fF]F", 90.0),
        &[(v(0., 1., 0.), NO_PARENT), (v(0., 2., 0.), 0), (v(0., 0., 0.), NO_PARENT), (v(0., 1., 0.), 2)],
    );
}

#[test]
fn a_pen_that_is_lifted_within_a_branch_comes_back_down() {
    assert_nodes(
        &drawn("f[[f]F]F", 0.0),
        &[(v(0., 1., 0.), NO_PARENT), (v(0., 2., 0.), 0), (v(0., 2., 0.), 0)],
    );
}

#[test]
fn a_square_closes_exactly() {
    let square = drawn("F+F+F+F", 90.0);
    assert_eq!(square.positions[4], Vec3::ZERO);
}

#[test]
fn a_frame_turned_a_million_times_stays_orthonormal() {
    // 360 turns of every kind come back to where they were, 2778 times; the last segment is as long
    // and as straight as the first.
    let turns = "+".repeat(360) + &"&".repeat(360) + &"/".repeat(360);
    let axiom = format!("F{}F", turns.repeat(926));
    let spun = drawn(&axiom, 1.0);
    assert!(spun.positions[2].distance(v(0., 2., 0.)) < 1e-6, "{}", spun.positions[2]);
}
