//! Polygons, as appendix C and chapter 5 of ABOP have them.

use linden::lsystem::{Grammar, LsystemError, TurtleSettings, grow};
use linden::{Quiet, Vec3};

use crate::drawn_with;

/// The polygons of an axiom, as lists of corners.
fn polygons(axiom: &str, angle_deg: f64) -> Vec<Vec<Vec3>> {
    let organs = drawn_with(axiom, |s| s.angle_deg = angle_deg).organs;
    (0..organs.polygons.ends.len()).map(|i| organs.corners_of(i).to_vec()).collect()
}

#[track_caller]
fn assert_corners(polygon: &[Vec3], expected: &[(f32, f32)]) {
    assert_eq!(polygon.len(), expected.len(), "{polygon:?}");
    for (corner, &(x, y)) in polygon.iter().zip(expected) {
        assert!(corner.distance(Vec3::new(x, y, 0.0)) < 1e-6, "{corner} is not {x} {y}");
    }
}

fn area(polygon: &[Vec3]) -> f32 {
    let ring = polygon.iter().zip(polygon.iter().cycle().skip(1));
    ring.map(|(a, b)| (*a - polygon[0]).cross(*b - polygon[0])).sum::<Vec3>().length() / 2.0
}

#[test]
fn edges_record_their_ends_and_the_first_its_start() {
    let square = &polygons("F{+f+f+f}", 90.0)[0];
    assert_corners(square, &[(0., 1.), (-1., 1.), (-1., 0.), (0., 0.)]);
    // F inside draws no wood.
    assert_eq!(polygons("F{+F+F+F}", 90.0)[0], *square);
    assert_eq!(drawn_with("F{+F+F+G}", |_| ()).branching.positions.len(), 2);
}

#[test]
fn the_leaf_of_the_bush_is_a_hexagon() {
    // ABOP, Fig. 1.25: two edges that open by δ and one straight, and the same the other way round.
    let leaf = &polygons("F{-f+f+f-|-f+f+f}", 22.5)[0];
    assert_eq!(leaf.len(), 7);
    assert!(leaf[0].distance(leaf[6]) < 1e-6, "it closes");
    // Edges at −δ, 0, δ to the heading, then back at the same angles: with x across,
    // corners (0, 0), (s, c), (s, 1+c), (0, 1+2c), (−s, 1+c), (−s, c): 2 s (1 + c).
    let (sin, cos) = libm::sincosf(22.5_f32.to_radians());
    assert!((area(leaf) - 2.0 * sin * (1.0 + cos)).abs() < 1e-5, "{}", area(leaf));
}

#[test]
fn dots_record_and_g_does_not() {
    // A fan of ribs, as the leaves of ABOP's section 5.1: only the dots are corners.
    let fan = &polygons("F{[+G.][G.][-G.]}", 90.0)[0];
    assert_corners(fan, &[(-1., 1.), (0., 2.), (1., 1.)]);
}

#[test]
fn vertices_are_recorded_across_brackets() {
    // The polygon is begun within a bracket, goes on behind it and is filled there.
    let polygon = &polygons("F[[+G{.].G.G.}]F", 90.0)[0];
    assert_eq!(polygon.len(), 4);
    let polygon = &polygons("F[[+{G.].G.G.}]F", 90.0)[0];
    assert_corners(polygon, &[(-1., 1.), (0., 1.), (0., 2.), (0., 3.)]);
    // The cordate leaf of ABOP's section 5.1. After the ribs are n, n−1, … long, each half is a fan of
    // triangles between neighbouring ribs.
    let rules = ["A -> [+A{.].C.}", "B -> [-B{.].C.}", "C -> GC"];
    let grammar = Grammar::new("F[A][B]", &rules).unwrap();
    let settings =
        TurtleSettings { derivations: 8, angle_deg: 16.0, segment_m: 1.0, ..TurtleSettings::default() };
    let grown = grow(&grammar, &settings, &Quiet).unwrap();
    assert_eq!(grown.branching.positions.len(), 2, "its ribs are no wood");
    let corners: Vec<Vec<Vec3>> =
        (0..grown.organs.len()).map(|i| grown.organs.corners_of(i).to_vec()).collect();
    assert!(corners.iter().all(|outline| outline.iter().all(|p| p.z.abs() < 1e-5)), "it is flat");
    let whole: f32 = corners.iter().map(|outline| area(outline)).sum();
    // From the origin of the leaf, rib k (k = 1 the innermost) of length k at the angle 16°·(8 − k): a
    // triangle between neighbours has the area ½·a·b·sin 16°. The innermost are 0 and 1 long.
    let half: f32 = (1..8).map(|k| 0.5 * (k * (k - 1)) as f32 * libm::sinf(16_f32.to_radians())).sum();
    assert!((whole / (2.0 * half) - 1.0).abs() < 1e-4, "{whole} is not {}", 2.0 * half);
}

#[test]
fn polygons_nest() {
    let both = polygons("F{f[-f{+f+f+f}].f-f-f}", 90.0);
    assert_eq!(both.len(), 2);
    // The inner one is filled first; its edges are not the outer one's.
    assert_corners(&both[0], &[(1., 2.), (1., 3.), (0., 3.), (0., 2.)]);
    assert_corners(&both[1], &[(0., 1.), (0., 2.), (1., 2.), (0., 2.), (0., 3.), (1., 3.), (1., 2.)]);
}

#[test]
fn fewer_than_three_vertices_are_nothing() {
    for axiom in ["F{}", "F{.}", "F{f}", "F{.f.}", "F{...}", "F{GGG}"] {
        assert!(polygons(axiom, 90.0).is_empty(), "{axiom}");
    }
}

#[test]
fn braces_that_do_not_match_are_errors() {
    let error = |axiom: &str| {
        let grammar = Grammar::new::<&str>(axiom, &[]).unwrap();
        let settings = TurtleSettings { derivations: 0, ..TurtleSettings::default() };
        let error = grow(&grammar, &settings, &Quiet).unwrap_err();
        assert!(error.to_string().starts_with("axiom: a"), "{error}");
        error.cause().clone()
    };
    assert_eq!(error("Ff}"), LsystemError::PolygonUnopened);
    assert_eq!(error("F{f"), LsystemError::PolygonUnclosed);
    assert_eq!(error("F{f{f}"), LsystemError::PolygonUnclosed);
    assert_eq!(error("F."), LsystemError::VertexOutside);
    assert!(error("F}").to_string().contains("'}' fills a polygon that no '{' has begun"));
    let long = format!("F{{{}}}", "f+".repeat(2000));
    assert!(matches!(error(&long), LsystemError::PolygonTooLarge { limit: 1000 }));
}

#[test]
fn wood_goes_on_where_an_outline_closed() {
    let grown = drawn_with("F{+f+f+f+f+}F", |s| s.angle_deg = 90.0);
    assert_eq!(grown.branching.parents.len(), 3);
    assert_eq!(grown.branching.parents[2], 1);
    // One that leads elsewhere is like a move.
    let grown = drawn_with("F{+f+f}F", |s| s.angle_deg = 90.0);
    assert_eq!(grown.branching.parents.len(), 4);
    assert_eq!(grown.branching.parents[2], linden::NO_PARENT);
}

#[test]
fn polygons_know_their_place_colour_and_step() {
    let grown = drawn_with("F[+F'{f+f+f}]F''{f-f-f}'(1){f+f+f}", |_| ());
    let growth = &grown.organs.polygons.growth;
    assert_eq!(growth.nodes, [2, 3, 3]);
    assert_eq!(growth.colors, [1, 2, 1]);
    let grammar = Grammar::new("FA", &["A -> [B]FA", "B -> {f+f+f}"]).unwrap();
    let grown =
        grow(&grammar, &TurtleSettings { derivations: 4, ..TurtleSettings::default() }, &Quiet).unwrap();
    assert_eq!(grown.organs.polygons.growth.births, [2, 3, 4]);
}
