use glam::Vec3;
use linden::grow::grow;
use linden::preset::builtin;
use linden::skeleton::refine::{Refinement, Rider, Room, STEPS, Step, refine};
use linden::surface::{Topology, sweep, topology};
use linden::{NO_PARENT, Quiet};
use linden_tests::presets::recipe;
use proptest::prelude::*;

use crate::branchings;

fn steps() -> impl Strategy<Value = Vec<Step>> {
    prop::collection::vec(prop::sample::select(STEPS.to_vec()), 0..7)
}

proptest! {
    /// Any steps in any order: a sound tree on the same feet, riders on nodes that exist, and each
    /// step the same whether taken at once or one after the other.
    #[test]
    fn any_order_of_steps_gives_a_tree(all in branchings(), steps in steps(), nodes in 1..4_u32) {
        let rule = |steps: Vec<Step>| Refinement { steps, prune_nodes: nodes, ..Refinement::default() };
        let mut riders: Vec<Rider> =
            (0..all.parents.len() as u32).map(|node| Rider { node, moved: Vec3::ZERO }).collect();
        let done = refine(all.clone(), None, &mut riders, &rule(steps.clone()), Room::open(1 << 20), &Quiet).unwrap();
        prop_assert!(done.validate().is_ok());
        let feet = |b: &linden::Branching| -> Vec<Vec3> {
            b.positions.iter().zip(&b.parents).filter(|(_, p)| **p == NO_PARENT).map(|(at, _)| *at).collect()
        };
        prop_assert_eq!(feet(&done), feet(&all));
        prop_assert!(riders.iter().all(|rider| (rider.node as usize) < done.parents.len()));
        let mut single = all.clone();
        for step in &steps {
            single = refine(single, None, &mut [], &rule(vec![*step]), Room::open(1 << 20), &Quiet).unwrap();
        }
        prop_assert_eq!(single, done);
    }

    /// Where no node is dropped, a rider is where its node is.
    #[test]
    fn riders_stay_with_their_nodes(all in branchings()) {
        let steps = ["relocate", "subdivide", "smooth"].into_iter().filter_map(Step::named).collect();
        let rule = Refinement { steps, ..Refinement::default() };
        let mut riders: Vec<Rider> =
            (0..all.parents.len() as u32).map(|node| Rider { node, moved: Vec3::ZERO }).collect();
        let done = refine(all.clone(), None, &mut riders, &rule, Room::open(1 << 20), &Quiet).unwrap();
        for (rider, start) in riders.iter().zip(&all.positions) {
            prop_assert!(done.positions[rider.node as usize].distance(*start + rider.moved) < 1e-4);
        }
    }
}

/// Through the whole of growing, for both generators, with the surface that follows.
#[test]
fn presets_grow_refined() {
    for id in ["simple", "abop-a"] {
        let mut refined = recipe(builtin(id).unwrap());
        refined.preset.set("refine", "none").unwrap();
        let plain = grow(&refined, &Quiet).unwrap().skeleton;
        refined.preset.set("refine", "prune decimate relocate subdivide").unwrap();
        let tree = grow(&refined, &Quiet).unwrap().skeleton;
        assert!(tree.axes.len() < plain.axes.len(), "{id}: twigs are pruned");
        assert!(tree.measures().total_length_m < plain.measures().total_length_m, "{id}");
        let mesh = sweep(&tree, &refined.preset.dressing.tubes, &Quiet).unwrap();
        assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default(), "{id}");
    }
}

/// Leaves go where their twigs go.
#[test]
fn organs_follow_refinement() {
    let grammar = linden::lsystem::Grammar::new("A", &["A -> F[+F~L]FA"]).unwrap();
    let preset = linden::preset::Preset::of_grammar("leafy", grammar, 50.0, 4);
    let mut recipe = linden::recipe::Recipe::new(preset);
    let plain = grow(&recipe, &Quiet).unwrap();
    assert!(!plain.organs.is_empty());
    recipe.preset.set("refine", "relocate subdivide").unwrap();
    let grown = grow(&recipe, &Quiet).unwrap();
    assert_eq!(grown.organs.len(), plain.organs.len());
    for (node, at) in grown.organs.placed.growth.nodes.iter().zip(&grown.organs.placed.positions) {
        assert!(grown.skeleton.positions[*node as usize].distance(*at) < 1e-4);
    }
}

/// Obstacles: no step takes a node into one that stood outside, and what is far from it goes where it
/// would have gone.
#[test]
fn refinement_stays_out_of_what_is_barred() {
    let (centre, radius) = (glam::Vec3::new(0.0, 4.0, 0.4), 1.2);
    let is_barred = |p: glam::Vec3| p.distance(centre) < radius;
    let all = grow(&recipe(builtin("simple").unwrap()), &Quiet).unwrap();
    let mut kept_out = 0;
    for step in ["relocate", "smooth", "subdivide"] {
        let only = Refinement { steps: vec![Step::named(step).unwrap()], ..Refinement::default() };
        let mut outside = branching_of(&all.skeleton);
        // What stands inside goes to the surface first.
        for p in outside.positions.iter_mut().filter(|p| is_barred(**p)) {
            *p = centre + (*p - centre).normalize_or(glam::Vec3::Y) * radius * 1.0001;
        }
        let room = Room { is_barred: &is_barred, ..Room::open(1 << 20) };
        let held = refine(outside.clone(), None, &mut [], &only, room, &Quiet).unwrap();
        assert!(held.positions.iter().all(|p| !is_barred(*p)), "{step}");
        let free = refine(outside, None, &mut [], &only, Room::open(1 << 20), &Quiet).unwrap();
        kept_out += free.positions.iter().filter(|p| is_barred(**p)).count();
        if step == "relocate" {
            for (held, free) in held.positions.iter().zip(&free.positions) {
                assert!(held == free || is_barred(*free), "{step}: {held} is not {free}");
            }
        }
    }
    assert!(kept_out > 20, "{kept_out} would have gone in");
}

fn branching_of(skeleton: &linden::Skeleton) -> linden::Branching {
    linden::Branching {
        positions: skeleton.positions.clone(),
        parents: skeleton.parents.clone(),
        births: vec![0; skeleton.parents.len()],
        radii: None,
        edges: None,
    }
}
