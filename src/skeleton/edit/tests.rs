//! Edits of small trees whose results are known.

use glam::Vec3;
use linden_base::monitor::Quiet;
use linden_base::random::Key;

use super::*;
use crate::{Branching, Edge, WidthSteps, Wood};

/// Two stems: one of four metres with laterals at 1 and 3 m, one bare.
fn pair() -> Branching {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    Branching {
        positions: vec![
            at(0.0, 0.0),
            at(0.0, 1.0),
            at(0.0, 3.0),
            at(0.0, 4.0),
            at(1.0, 1.0),
            at(2.0, 1.0),
            at(1.0, 3.0),
            at(9.0, 0.0),
            at(9.0, 2.0),
        ],
        parents: vec![NO_PARENT, 0, 1, 2, 1, 4, 2, NO_PARENT, 7],
        births: vec![0, 1, 2, 3, 2, 3, 3, 0, 1],
        radii: Some(vec![0.4, 0.4, 0.2, 0.1, 0.1, 0.05, 0.05, 0.2, 0.1]),
        edges: None,
    }
}

fn made(tree: &Skeleton, edits: &[&str]) -> Edited {
    let edits: Vec<Edit> = edits.iter().map(|text| text.parse().unwrap()).collect();
    edit(tree, &Organs::default(), &edits, 100_000, &Quiet).unwrap()
}

fn tree() -> Skeleton {
    Skeleton::build(pair(), &Wood::default()).unwrap()
}

#[test]
fn laterals_count_from_the_base_and_stems_as_they_come() {
    let tree = tree();
    let paths = AxisPaths::new(&tree);
    let mut all: Vec<(String, u32)> = (0..4)
        .map(|axis| (paths.path(axis).unwrap().to_string(), tree.nodes_of(&tree.axes[axis as usize])[0]))
        .collect();
    all.sort();
    let expected = [("stem", 0), ("stem/1", 4), ("stem/2", 6), ("stem2", 7)];
    assert_eq!(all, expected.map(|(path, node)| (path.to_owned(), node)));
    assert_eq!(paths.find(&"stem/3".parse().unwrap()), None);
    assert_eq!(paths.find(&"stem3".parse().unwrap()), None);
}

#[test]
fn trees_of_a_stand_are_kept_apart_by_edits_and_ages() {
    let stand = Skeleton { trees: vec![4, 2], ..tree() };
    let of = |edits: &[&str]| made(&stand, edits);
    assert_eq!(of(&["cut stem 0.5"]).skeleton.trees, [4, 2]);
    // The foot of what is left is the second one's.
    assert_eq!(of(&["remove stem"]).skeleton.trees, [2]);
    let edited = of(&["remove stem/1"]);
    let (young, _) = edited.origins.until((&edited.skeleton, &stand), 1, &Wood::default(), Key::new(0));
    assert_eq!((young.trees.as_slice(), young.segments()), ([4, 2].as_slice(), 2));
}

#[test]
fn random_trees_have_a_path_for_each_axis() {
    for seed in 0..20 {
        let key = Key::new(seed);
        let mut all = Branching::default();
        for i in 0..300_u32 {
            let k = key.child(u64::from(i));
            let is_foot = i == 0 || k.child(4).unit() < 0.02;
            let parent = (k.child(0).unit() * f64::from(i)) as u32;
            let step = Vec3::from([1, 2, 3].map(|n| k.child(n).unit() as f32 - 0.3));
            all.positions.push(if is_foot { step } else { all.positions[parent as usize] + step });
            all.parents.push(if is_foot { NO_PARENT } else { parent });
            all.births.push(i);
        }
        let tree = Skeleton::build(all, &Wood::default()).unwrap();
        let paths = AxisPaths::new(&tree);
        for axis in 0..tree.axes.len() as u32 {
            assert_eq!(paths.find(&paths.path(axis).unwrap()), Some(axis));
        }
        assert_eq!(paths.fingerprint(), AxisPaths::new(&tree.clone()).fingerprint());
    }
}

#[test]
fn one_of_two_stems_may_go_and_not_both() {
    let edited = made(&tree(), &["remove stem2", "remove stem"]);
    assert_eq!(edited.skeleton.positions, tree().positions[..7]);
    assert_eq!(edited.remarks.len(), 1);
    assert!(
        edited.remarks[0].to_string().starts_with("edit 2 (remove stem) was left out: nothing would be left")
    );
}

#[test]
fn a_cut_between_nodes_takes_the_thickness_there() {
    let edited = made(&tree(), &["cut stem at_m=2.5"]).skeleton;
    let end = edited.marks.cuts[0] as usize;
    assert_eq!(edited.positions[end], Vec3::Y * 2.5);
    assert!((edited.radii[end] - 0.25).abs() < 1e-6);
    assert_eq!((edited.births[end], edited.axes.len()), (2, 3), "the upper lateral went");
    // In steps, a segment is as thick all along as its end.
    let steps = Wood { width_steps: WidthSteps::Cylinder, ..Wood::default() };
    let tree = Skeleton::build(pair(), &steps).unwrap();
    let edited = made(&tree, &["cut stem at_m=2.5"]).skeleton;
    assert!((edited.radii[edited.marks.cuts[0] as usize] - 0.2).abs() < 1e-6);
    // A lateral that leaves where the cut is goes with it.
    assert_eq!(made(&tree, &["cut stem at_m=3"]).skeleton.axes.len(), 3);
}

#[test]
fn a_bend_without_a_stretch_is_a_kink_and_turns_to_its_direction() {
    let edited = made(&tree(), &["bend stem 90 at_m=2 over=0 towards=1,0,0"]).skeleton;
    for expected in [Vec3::Y * 2.0, Vec3::new(2.0, 2.0, 0.0), Vec3::new(1.0, 1.0, 0.0)] {
        assert!(edited.positions.iter().any(|at| at.distance(expected) < 1e-5), "{expected}");
    }
    // The upper lateral leaned to +X, and looks down now.
    assert!(edited.positions.iter().any(|at| at.distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-5));
    // No farther than to the direction.
    let far = made(&tree(), &["bend stem 180 at_m=2 over=0 towards=1,0,0"]).skeleton;
    assert_eq!(far.positions.len(), edited.positions.len());
    assert!(far.positions.iter().zip(&edited.positions).all(|(a, b)| a.distance(*b) < 1e-5));
}

#[test]
fn grammars_with_brackets_keep_their_forks() {
    let edges = Some(vec![
        Edge::Succeeds,
        Edge::Succeeds,
        Edge::Branches,
        Edge::Succeeds,
        Edge::Branches,
        Edge::Succeeds,
        Edge::Branches,
        Edge::Succeeds,
        Edge::Succeeds,
    ]);
    let tree = Skeleton::build(Branching { edges, ..pair() }, &Wood::default()).unwrap();
    assert_eq!(tree.axes.len(), 5, "the first stem ends at its fork");
    let edited = made(&tree, &["remove stem/1"]).skeleton;
    assert_eq!(edited.axes.len(), tree.axes.len() - 2);
}
