//! Edits of the wood, on trees of presets, against what each of them says.

use std::collections::BTreeSet;

use linden::foliage::Organs;
use linden::glam::DVec3;
use linden::grow::{Grown, grow, reedit};
use linden::preset::{Preset, builtin};
use linden::recipe::Recipe;
use linden::skeleton::edit::{AxisPaths, Edit, EditError, Edited, Operation, edit};
use linden::skeleton::{AxisKind, Forks};
use linden::surface::{sweep, topology};
use linden::{NO_PARENT, Quiet, Skeleton};
use proptest::prelude::*;

/// A preset with knobs turned.
fn preset(id: &str, settings: &[(&str, &str)]) -> Preset {
    let mut preset = builtin(id).unwrap().load().unwrap();
    for (knob, value) in settings {
        preset.set(knob, value).unwrap();
    }
    preset
}

fn grown(preset: &Preset) -> Grown {
    grow(&Recipe::new(preset.clone()), &Quiet).unwrap()
}

/// Trees of several kinds, small enough to try much on.
fn trees() -> Vec<(&'static str, Grown)> {
    let bare = ("leaf_form", "none");
    [
        ("drawn-oak", &[("points", "900"), bare][..]),
        ("fir", &[("points", "500"), bare]),
        ("bush-3d", &[("derivations", "4")]),
        ("abop-honda-a", &[("derivations", "6")]),
        ("abop-c", &[("derivations", "3")]),
    ]
    .map(|(id, settings)| (id, grown(&preset(id, settings))))
    .into()
}

fn made(tree: &Grown, edits: &[&str]) -> Edited {
    let edits: Vec<Edit> = edits.iter().map(|text| text.parse().unwrap()).collect();
    edit(&tree.skeleton, &tree.given, &edits, 10_000_000, &Quiet).unwrap()
}

/// Made without anything to be said.
fn done(tree: &Grown, edits: &[&str]) -> Skeleton {
    let edited = made(tree, edits);
    assert!(edited.remarks.is_empty(), "{:?}", edited.remarks);
    sound(&edited.skeleton);
    edited.skeleton
}

/// All that skeletons promise, and that wood gets no thicker upwards than it did.
fn sound(skeleton: &Skeleton) {
    let Skeleton { positions, parents, radii, births, axes, axis_nodes, .. } = skeleton;
    let count = positions.len();
    assert!([parents.len(), radii.len(), births.len(), axis_nodes.len()].iter().all(|len| *len == count));
    assert!(positions.iter().all(|at| at.is_finite()) && radii.iter().all(|r| *r > 0.0 && r.is_finite()));
    let mut seen = BTreeSet::new();
    let mut orders = vec![None; count];
    let mut first = 0;
    for axis in axes {
        assert!(axis.len > 0 && axis.first == first, "{axis:?}");
        first += axis.len;
        let order = if axis.parent == NO_PARENT { 0 } else { orders[axis.parent as usize].unwrap() + 1 };
        assert_eq!(axis.order, order);
        let mut below = axis.parent;
        for &node in skeleton.nodes_of(axis) {
            assert!(seen.insert(node) && parents[node as usize] == below);
            assert!(below == NO_PARENT || below < node);
            orders[node as usize] = Some(axis.order);
            below = node;
        }
    }
    assert_eq!(seen.len(), count);
}

/// An axis with what it bears, by asking every node for all that is below it.
fn borne(skeleton: &Skeleton, axis: u32) -> BTreeSet<u32> {
    let first = skeleton.nodes_of(&skeleton.axes[axis as usize])[0];
    let hangs = |mut node: u32| loop {
        if node == first {
            return true;
        }
        node = skeleton.parents[node as usize];
        if node == NO_PARENT {
            return false;
        }
    };
    (0..skeleton.parents.len() as u32).filter(|&node| hangs(node)).collect()
}

/// The axis that bears most but for stems.
fn limb(tree: &Grown) -> (u32, String) {
    let skeleton = &tree.skeleton;
    let laterals = (0..skeleton.axes.len() as u32).filter(|&axis| skeleton.axes[axis as usize].order == 1);
    let limb = laterals.max_by_key(|&axis| (borne(skeleton, axis).len(), axis)).unwrap();
    (limb, skeleton.axis_path(limb).unwrap().to_string())
}

fn at(skeleton: &Skeleton, node: u32) -> DVec3 {
    skeleton.positions[node as usize].as_dvec3()
}

#[test]
fn every_axis_is_found_by_its_path() {
    for (id, tree) in trees() {
        let skeleton = &tree.skeleton;
        let paths = AxisPaths::new(skeleton);
        let mut seen = BTreeSet::new();
        for axis in 0..skeleton.axes.len() as u32 {
            let path = paths.path(axis).unwrap();
            assert_eq!(paths.find(&path), Some(axis), "{id} {path}");
            assert_eq!(path.to_string().parse(), Ok(path.clone()));
            assert_eq!(path.laterals.len(), skeleton.axes[axis as usize].order as usize);
            // By the definition: the place among all that leave the same axis, from its base up; shoots come last.
            if let Some(parent) = paths.parent(axis) {
                let nodes = skeleton.nodes_of(&skeleton.axes[parent as usize]);
                let place = |lateral: u32| {
                    let leaves = skeleton.axes[lateral as usize].parent;
                    let is_late = skeleton.kind_of(lateral as usize) != AxisKind::Grown;
                    nodes.iter().position(|&node| node == leaves).map(|place| (is_late, place, lateral))
                };
                let before = (0..skeleton.axes.len() as u32).filter_map(place);
                let before = before.filter(|other| Some(*other) < place(axis)).count();
                assert_eq!(path.laterals.last(), Some(&(before as u32 + 1)), "{id} {path}");
            }
            assert!(seen.insert(path));
        }
        assert_eq!(paths.path(skeleton.axes.len() as u32), None);
    }
}

#[test]
fn without_edits_a_tree_stays_to_the_bit() {
    for (id, tree) in trees() {
        let Edited { skeleton, organs, remarks, .. } = made(&tree, &[]);
        assert!(remarks.is_empty() && organs == *tree.given, "{id}");
        let marks = skeleton.marks.clone();
        assert_eq!(Skeleton { marks: tree.skeleton.marks.clone(), ..skeleton }, *tree.skeleton, "{id}");
        let numbers = (0..marks.numbers.len()).map(|axis| tree.skeleton.axis_number(axis));
        assert!(marks.cuts.is_empty() && marks.numbers.iter().copied().eq(numbers), "{id}");
    }
}

#[test]
fn removing_takes_an_axis_and_what_it_bears_and_nothing_else() {
    for (id, tree) in trees() {
        let (axis, path) = limb(&tree);
        let gone = borne(&tree.skeleton, axis);
        let edited = done(&tree, &[&format!("remove {path}")]);
        let old = &tree.skeleton;
        let stay: Vec<u32> = (0..old.parents.len() as u32).filter(|node| !gone.contains(node)).collect();
        assert!(!gone.is_empty() && !stay.is_empty());
        let kept = |node: u32| stay.binary_search(&node).map_or(NO_PARENT, |place| place as u32);
        assert_eq!(
            edited.positions,
            stay.iter().map(|&n| old.positions[n as usize]).collect::<Vec<_>>(),
            "{id}"
        );
        assert_eq!(edited.radii, stay.iter().map(|&n| old.radii[n as usize]).collect::<Vec<_>>(), "{id}");
        assert_eq!(edited.births, stay.iter().map(|&n| old.births[n as usize]).collect::<Vec<_>>(), "{id}");
        let parents: Vec<u32> = stay.iter().map(|&n| kept(old.parents[n as usize])).collect();
        assert_eq!(edited.parents, parents, "{id}");
    }
}

#[test]
fn a_cut_axis_is_as_long_as_was_asked_and_ends_in_no_bud() {
    for (id, tree) in trees() {
        let (axis, path) = limb(&tree);
        let length_m = tree.skeleton.axis_length_m(axis);
        for share in [0.31, 0.77] {
            let edited = made(&tree, &[&format!("cut {path} {share}")]);
            sound(&edited.skeleton);
            let index = edited
                .origins
                .axes
                .iter()
                .position(|origin| *origin == linden::skeleton::edit::AxisOrigin::Grown(axis));
            let index = index.unwrap() as u32;
            let is_m = edited.skeleton.axis_length_m(index);
            // Places are single numbers: a millionth of the tree's size.
            assert!((is_m - share * length_m).abs() < 2e-6 * length_m.max(1.0), "{id}: {is_m} {length_m}");
            let axis = edited.skeleton.axes[index as usize];
            let end = *edited.skeleton.nodes_of(&axis).last().unwrap();
            assert_eq!(edited.skeleton.marks.cuts, [end]);
            assert!(edited.skeleton.parents.iter().all(|&parent| parent != end), "{id}");
        }
    }
}

/// Lengths between the nodes that were there before.
fn ways(skeleton: &Skeleton, axis: u32, places: &[u32]) -> Vec<f64> {
    let axis = skeleton.axes[axis as usize];
    let mut way = 0.0;
    let mut all = Vec::new();
    for &node in skeleton.nodes_of(&axis) {
        way += skeleton.segment_length(node as usize);
        if places.contains(&node) {
            all.push(way);
        }
    }
    all
}

#[test]
fn a_bend_keeps_all_lengths_and_turns_by_its_angle() {
    for (id, tree) in trees() {
        let (axis, path) = limb(&tree);
        let edited = made(&tree, &[&format!("bend {path} 50 at=0.2 over=0.3 round=0.3,1,0.1")]);
        sound(&edited.skeleton);
        let new_axis = edited
            .origins
            .axes
            .iter()
            .position(|origin| *origin == linden::skeleton::edit::AxisOrigin::Grown(axis));
        let new_axis = new_axis.unwrap() as u32;
        let old = &tree.skeleton;
        let new_of = |node: u32| {
            // A node that was there before is its origin, and comes last of those that follow it.
            edited.origins.nodes.iter().rposition(|&origin| origin == node).unwrap() as u32
        };
        let nodes = old.nodes_of(&old.axes[axis as usize]);
        let new_nodes: Vec<u32> = nodes.iter().map(|&node| new_of(node)).collect();
        let (before, after) = (ways(old, axis, nodes), ways(&edited.skeleton, new_axis, &new_nodes));
        assert_eq!(before.len(), after.len());
        for (a, b) in before.iter().zip(&after) {
            assert!((a - b).abs() < 1e-5 * a.max(1.0), "{id}: {a} {b}");
        }
        // Beyond the bend everything turned by the angle: the last segments' directions did, around the axis.
        let around = DVec3::new(0.3, 1.0, 0.1).normalize();
        let direction = |skeleton: &Skeleton, node: u32| {
            (at(skeleton, node) - at(skeleton, skeleton.parents[node as usize])).normalize()
        };
        let tip = *nodes.last().unwrap();
        let across = |d: DVec3| (d - around * d.dot(around)).normalize_or_zero();
        let (from, to) = (across(direction(old, tip)), across(direction(&edited.skeleton, new_of(tip))));
        let (cosine, sine) = (from.dot(to), from.cross(to).dot(around));
        // Of 50 degrees.
        assert!(
            (cosine - 0.642_788).abs() < 0.006 && (sine - 0.766_044).abs() < 0.006,
            "{id}: {cosine} {sine}"
        );
        // What hangs beyond goes along rigidly: all distances among its nodes stay.
        let borne: Vec<u32> = borne(old, axis).into_iter().filter(|node| !nodes.contains(node)).collect();
        for &node in &borne {
            let (a, b) =
                (old.segment_length(node as usize), edited.skeleton.segment_length(new_of(node) as usize));
            assert!((a - b).abs() < 1e-5 * a.max(1.0), "{id}: {a} {b}");
        }
    }
}

#[test]
fn scaling_multiplies_the_volume_and_stays_in_place() {
    for (id, tree) in trees() {
        // Where wood runs on into a lateral, that begins as thick as what bears it.
        if !Forks::new(&tree.skeleton).is_empty() {
            continue;
        }
        let (axis, path) = limb(&tree);
        let old = &tree.skeleton;
        let edited = done(&tree, &[&format!("scale {path} 0.5 thickness=0.8")]);
        let family = borne(old, axis);
        let volume = |skeleton: &Skeleton| -> f64 {
            let all = skeleton.cylinders();
            all.iter().filter(|c| family.contains(&c.node)).map(linden::skeleton::Cylinder::volume_m3).sum()
        };
        let times = volume(&edited) / volume(old);
        assert!((times - 0.5 * 0.8 * 0.8).abs() < 1e-4, "{id}: {times}");
        let base = at(old, old.axes[axis as usize].parent);
        for &node in &family {
            let expected = base + (at(old, node) - base) * 0.5;
            assert!(at(&edited, node).distance(expected) < 1e-5);
        }
        for node in (0..old.parents.len() as u32).filter(|node| !family.contains(node)) {
            assert_eq!(
                (at(&edited, node), edited.radii[node as usize]),
                (at(old, node), old.radii[node as usize])
            );
        }
    }
    let (_, oak) = trees().swap_remove(0);
    let said = made(&oak, &["scale stem/1 thickness=100"]).remarks;
    assert!(said[0].to_string().contains("no axis gets thicker than what bears it"), "{said:?}");
    assert!(!said[0].is_skipped);
}

#[test]
fn a_curve_passes_its_points_and_carries_laterals_at_their_share() {
    for (id, tree) in trees() {
        let (axis, path) = limb(&tree);
        let points = [[0.2, 0.5, 0.0], [0.9, 0.8, 0.3], [1.0, 2.0, -0.4]];
        let listed: Vec<String> = points.concat().iter().map(ToString::to_string).collect();
        let edited = made(&tree, &[&format!("curve {path} {}", listed.join(","))]);
        sound(&edited.skeleton);
        let index = edited
            .origins
            .axes
            .iter()
            .position(|origin| *origin == linden::skeleton::edit::AxisOrigin::Grown(axis));
        let new = edited.skeleton.axes[index.unwrap()];
        let base = at(&edited.skeleton, new.parent);
        for point in points {
            let away = |&node: &u32| at(&edited.skeleton, node).distance(base + DVec3::from(point));
            let least = edited.skeleton.nodes_of(&new).iter().map(away).fold(f64::INFINITY, f64::min);
            assert!(least < 1e-6, "{id}: {least}");
        }
        let tip = *edited.skeleton.nodes_of(&new).last().unwrap();
        assert!(at(&edited.skeleton, tip).distance(base + DVec3::from(points[2])) < 1e-6);
    }
}

#[test]
fn what_is_added_leaves_where_it_should_and_is_named() {
    for (id, tree) in trees() {
        let (_, path) = limb(&tree);
        let edited = made(
            &tree,
            &[
                "add stem 0.4 at=0.6 towards=1,0.2,0 thickness=0.5 lift=0",
                &format!("copy stem {path} at=0.3 turn=90 size=0.5"),
                "bend new 20 at=0.5",
                "remove new2/1",
            ],
        );
        assert!(edited.remarks.iter().all(|remark| !remark.is_skipped), "{id}: {:?}", edited.remarks);
        sound(&edited.skeleton);
        let paths = AxisPaths::new(&tree.skeleton);
        let named = |name: &str| {
            let axes = 0..edited.skeleton.axes.len() as u32;
            axes.filter(|&axis| edited.origins.path(axis, &paths).unwrap().to_string() == name)
                .collect::<Vec<_>>()
        };
        let [new] = named("new")[..] else { panic!("{id}") };
        assert!((edited.skeleton.axis_length_m(new) - 0.4).abs() < 1e-4, "{id}");
        assert!(named("new2/1").is_empty() && named("new2").len() == 1, "{id}");
        let axis = edited.skeleton.axes[new as usize];
        let first = edited.skeleton.nodes_of(&axis)[0];
        let ratio = edited.skeleton.radii[first as usize] / edited.skeleton.radii[axis.parent as usize];
        assert!((ratio - 0.5).abs() < 1e-3, "{id}: {ratio}");
        let last = tree.skeleton.births.iter().max().unwrap();
        assert!(edited.skeleton.births.iter().all(|birth| birth <= last), "{id}");
    }
}

#[test]
fn edits_of_different_axes_commute_and_name_the_tree_as_it_grew() {
    for (id, tree) in trees() {
        let texts = ["remove stem/1", "scale stem/2 0.7", "bend stem/3 25 at=0"];
        let at = |order: [usize; 3]| {
            let edited = done(&tree, &order.map(|i| texts[i]));
            let mut places: Vec<_> = (0..edited.positions.len())
                .map(|i| (edited.positions[i].to_array().map(f32::to_bits), edited.radii[i].to_bits()))
                .collect();
            places.sort_unstable();
            places
        };
        assert!(at([0, 1, 2]) == at([2, 1, 0]) && at([0, 1, 2]) == at([1, 0, 2]), "{id}");
    }
}

#[test]
fn what_cannot_be_made_is_said() {
    let (_, oak) = trees().swap_remove(0);
    for (texts, expected) in [
        (&["remove stem/999"][..], "the tree has no stem/999: stem bears"),
        (&["cut stem2 0.5"], "the tree has no stem2: it has 1 stem"),
        (&["remove stem"], "nothing would be left"),
        (&["cut stem/1 at_m=99"], "so that nothing is cut off"),
        (
            &["remove stem/1", "cut stem/1 0.5"],
            "edit 2 (cut stem/1) was left out: an edit before this one took",
        ),
        (&["bend new 10"], "it is what an edit adds"),
        (&["bend stem/1 30 towards=0,0,0"], "'towards' has no length"),
        (&["curve stem/1 0,0,0"], "the curve has no length"),
    ] {
        let said: Vec<String> = made(&oak, texts).remarks.iter().map(ToString::to_string).collect();
        assert!(said.len() == 1 && said[0].contains(expected), "{texts:?}: {said:?}");
    }
    let lost: Vec<Edit> = (0..6).map(|_| "scale stem 100".parse().unwrap()).collect();
    let error = edit(&oak.skeleton, &Organs::default(), &lost, 1_000_000, &Quiet).unwrap_err();
    assert!(matches!(error, EditError::Lost { number: 4, .. }), "{error}");
    let copies: Vec<Edit> = (0..40).map(|_| "copy stem stem at=0.5".parse().unwrap()).collect();
    let error = edit(&oak.skeleton, &Organs::default(), &copies, 100_000, &Quiet).unwrap_err();
    assert!(matches!(error, EditError::TooManyNodes { .. }), "{error}");
    let nan = Edit::new("stem".parse().unwrap(), Operation::Scale { length: f64::NAN, thickness: 1.0 });
    let error = edit(&oak.skeleton, &Organs::default(), &[nan], 1000, &Quiet).unwrap_err();
    assert!(error.to_string().contains("'length': NaN is outside the range"), "{error}");
}

#[test]
fn edits_survive_other_knobs_and_say_where_not() {
    let mut oak = preset("drawn-oak", &[("points", "900"), ("leaf_form", "none")]);
    let tree = grown(&oak);
    let paths = tree.axis_paths();
    let (axis, path) = limb(&tree);
    let wish = tree.edit_of(axis, Operation::Remove, &paths).unwrap();
    assert!(wish.axis.to_string() == path && wish.near.is_some() && wish.branching.is_some());
    oak.edits.push(wish);
    let whole = tree.skeleton.axes.len();
    for (knob, value) in [("leaf_form", "card"), ("trunk_curve", "0 3 0 2 6 0"), ("base_radius", "0.7")] {
        let mut other = oak.clone();
        other.set(knob, value).unwrap();
        let edited = grown(&other);
        assert!(
            edited.remarks.is_empty() && edited.skeleton.axes.len() < whole,
            "{knob}: {:?}",
            edited.remarks
        );
    }
    // Finer axes have other nodes, and the branches stand where they stood.
    let mut other = oak.clone();
    other.set("decimate_tolerance", "0.3").unwrap();
    assert!(grown(&other).remarks.is_empty());
    let near = oak.edits[0].near.map(DVec3::from).unwrap();
    let mut said = 0;
    for seed in 2..10 {
        let mut seeded = oak.clone();
        seeded.set_seed(seed);
        let mut other = seeded.clone();
        other.edits.clear();
        let (plain, edited) = (grown(&other).skeleton, grown(&seeded));
        // By the definition: whether one of the order begins within both limits.
        let size_m = linden::mesh::Bounds::of(plain.positions.iter().copied()).unwrap().size().max_element();
        let fits = |axis: u32| {
            let most_m = (0.05 * plain.axis_length_m(axis)).min(0.005 * f64::from(size_m));
            plain.axes[axis as usize].order == 1 && plain.beginning(axis).unwrap().distance(near) <= most_m
        };
        let is_there = (0..plain.axes.len() as u32).any(fits);
        assert_eq!(edited.remarks.is_empty(), is_there, "{seed}");
        if let [remark] = &edited.remarks[..] {
            said += 1;
            assert!(remark.to_string().contains("the tree grew otherwise"), "{remark}");
            assert!(edited.notes.contains(&remark.to_string()));
            assert_eq!(edited.skeleton.positions, plain.positions);
        }
    }
    assert!(said >= 6, "{said}");
}

#[test]
fn leaves_of_other_branches_stay_and_threads_change_nothing() {
    let mut oak = preset("drawn-oak", &[("points", "700"), ("leaves_per_m", "8")]);
    let tree = grown(&oak);
    let (axis, path) = limb(&tree);
    let gone = borne(&tree.skeleton, axis);
    oak.edit(&format!("remove {path}")).unwrap();
    let recipe = Recipe::new(oak);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| grow(&recipe, &Quiet).unwrap())
    };
    let (one, four) = (on(1), on(4));
    assert_eq!(one.hash(), four.hash());
    assert_eq!(reedit(&tree, &recipe, &Quiet).unwrap().hash(), one.hash());
    let placed = &tree.organs.placed;
    let stay = (0..placed.len()).filter(|&leaf| !gone.contains(&placed.growth.nodes[leaf]));
    let expected: Vec<_> = stay.map(|leaf| (placed.positions[leaf], placed.headings[leaf])).collect();
    let left = &one.organs.placed;
    let left: Vec<_> = (0..left.len()).map(|leaf| (left.positions[leaf], left.headings[leaf])).collect();
    assert!(!left.is_empty() && left == expected);
}

#[test]
fn a_young_edited_tree_is_the_young_tree_edited() {
    let mut oak = preset("drawn-oak", &[("points", "700"), ("leaf_form", "none")]);
    let tree = grown(&oak);
    let (axis, path) = limb(&tree);
    let gone = borne(&tree.skeleton, axis);
    oak.edit(&format!("remove {path}")).unwrap();
    oak.edit("add stem 2 at=0.5").unwrap();
    let edited = grown(&oak);
    let last = *tree.skeleton.births.iter().max().unwrap();
    for step in [last / 4, last / 2, last * 3 / 4, last] {
        let young = edited.until(step, oak.wood_key());
        sound(&young);
        let plain = tree.until(step, oak.wood_key());
        let there = tree.skeleton.born_by(step);
        let nodes = (0..there.len() as u32).filter(|&node| there[node as usize]);
        let stays: Vec<usize> =
            (0..).zip(nodes).filter(|(_, node)| !gone.contains(node)).map(|(i, _)| i).collect();
        for i in stays {
            let found = young.positions.iter().position(|at| *at == plain.positions[i]).unwrap();
            assert!((young.radii[found] / plain.radii[i] - 1.0).abs() < 1e-5, "step {step}");
        }
    }
    assert_eq!(edited.until(last, oak.wood_key()), *edited.skeleton);
    // The knob `age` shows the same.
    oak.set("age", "0.5").unwrap();
    let aged = grown(&oak);
    let half = (f64::from(last) * 0.5).ceil() as u32;
    assert_eq!(*aged.skeleton, edited.until(half, oak.wood_key()));
}

#[test]
fn organs_of_a_grammar_go_with_their_wood() {
    let plant = preset("abop-bush", &[("derivations", "4")]);
    let tree = grown(&plant);
    assert!(!tree.given.is_empty());
    let (axis, path) = limb(&tree);
    let gone = borne(&tree.skeleton, axis);
    let count = (0..tree.given.len()).filter(|&organ| gone.contains(&tree.given.growth(organ).node)).count();
    let edited = made(&tree, &[&format!("remove {path}")]);
    assert_eq!(edited.organs.len(), tree.given.len() - count);
    // The stem of this one is a point.
    let twice = made(&tree, &[&format!("copy {path} {path} at=0.5")]);
    assert_eq!(twice.organs.len(), tree.given.len() + count);
    // Each stays as far from its node as it was.
    let bent = made(&tree, &[&format!("bend {path} 60 at=0")]);
    let away = |organs: &Organs, skeleton: &Skeleton| -> Vec<f32> {
        let placed = &organs.placed;
        let away =
            |i: usize| placed.positions[i].distance(skeleton.positions[placed.growth.nodes[i] as usize]);
        let mut all: Vec<f32> = (0..placed.len()).map(away).collect();
        all.sort_by(f32::total_cmp);
        all
    };
    let (before, after) = (away(&tree.given, &tree.skeleton), away(&bent.organs, &bent.skeleton));
    assert!(before.len() == after.len() && before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-4));
}

/// Any edit of the first axes of a tree, with any numbers within the ranges, and beyond.
fn edits() -> impl Strategy<Value = Edit> {
    let path = prop_oneof![
        Just("stem".to_owned()),
        (1..40_u32).prop_map(|n| format!("stem/{n}")),
        (1..20_u32, 1..6_u32).prop_map(|(n, m)| format!("stem/{n}/{m}")),
        (1..4_u32).prop_map(|n| format!("new{n}")),
    ];
    let number =
        prop_oneof![0.0..1.0_f64, -200.0..200.0_f64, Just(0.0), Just(1.0), Just(f64::NAN), Just(1e300)];
    let numbers = prop::collection::vec(number, 8);
    (0..7_usize, path.clone(), path, numbers).prop_map(|(word, axis, from, x)| {
        let mut edit = Edit::named(Operation::WORDS[word]).unwrap();
        edit.axis = axis.parse().unwrap();
        edit.set_path("from", from.parse().unwrap());
        let mut next = x.iter().copied().cycle();
        for (knob, _) in edit.clone().knobs() {
            let mut draw = || next.next().unwrap();
            let value = match knob.kind {
                linden::knob::Kind::Vector { .. } => linden::knob::Value::Vector([draw(), draw(), draw()]),
                // Mostly what is in range.
                linden::knob::Kind::Real { min, max, .. } => {
                    let x = draw();
                    linden::knob::Value::Real(if (0.0..=1.0).contains(&x) {
                        min + (max.min(50.0) - min) * x
                    } else {
                        x
                    })
                }
                _ => continue,
            };
            edit.set(knob.name, value);
        }
        if let Operation::Curve { points } = &mut edit.operation {
            *points = x.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
        }
        edit
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn whatever_is_edited_stays_a_tree_with_a_closed_surface(all in prop::collection::vec(edits(), 1..6), which in 0..5_usize) {
        let (_, tree) = &trees()[which];
        // Alone, so that one that is refused does not hide the others.
        let good: Vec<Edit> = all.into_iter().filter(|edit| edit.check().is_ok()).collect();
        match edit(&tree.skeleton, &tree.given, &good, 200_000, &Quiet) {
            Ok(edited) => {
                sound(&edited.skeleton);
                let tubes = preset("oak", &[]).dressing.tubes;
                let mesh = sweep(&edited.skeleton, &tubes, &Quiet).unwrap();
                let checked = topology(&mesh, &Quiet).unwrap();
                prop_assert!(checked.open_edges == 0 && checked.not_finite == 0, "{:?}", checked);
            }
            Err(EditError::Lost { .. } | EditError::TooManyNodes { .. }) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
