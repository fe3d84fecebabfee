use glam::Vec3;
use linden::grow::grow;
use linden::preset::builtin;
use linden::skeleton::refine::{Refinement, Rider, STEPS, Step, refine};
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
        let done = refine(all.clone(), None, &mut riders, &rule(steps.clone()), 1 << 20, &Quiet).unwrap();
        prop_assert!(done.validate().is_ok());
        let feet = |b: &linden::Branching| -> Vec<Vec3> {
            b.positions.iter().zip(&b.parents).filter(|(_, p)| **p == NO_PARENT).map(|(at, _)| *at).collect()
        };
        prop_assert_eq!(feet(&done), feet(&all));
        prop_assert!(riders.iter().all(|rider| (rider.node as usize) < done.parents.len()));
        let mut single = all.clone();
        for step in &steps {
            single = refine(single, None, &mut [], &rule(vec![*step]), 1 << 20, &Quiet).unwrap();
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
        let done = refine(all.clone(), None, &mut riders, &rule, 1 << 20, &Quiet).unwrap();
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
        let mesh = sweep(&tree, &refined.preset.tubes, &Quiet).unwrap();
        assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default(), "{id}");
    }
}

/// Leaves go where their twigs go.
#[test]
fn organs_follow_refinement() {
    let grammar = linden::lsystem::Grammar::new("A", &["A -> F[+F~L]FA"]).unwrap();
    let preset = linden::preset::Preset::of_grammar("leafy", grammar, 50.0, 4);
    let mut own = linden::recipe::Recipe { preset, inputs: Vec::new() };
    let plain = grow(&own, &Quiet).unwrap();
    assert!(!plain.organs.is_empty());
    own.preset.set("refine", "relocate subdivide").unwrap();
    let grown = grow(&own, &Quiet).unwrap();
    assert_eq!(grown.organs.len(), plain.organs.len());
    for (node, at) in grown.organs.placed.growth.nodes.iter().zip(&grown.organs.placed.positions) {
        assert!(grown.skeleton.positions[*node as usize].distance(*at) < 1e-4);
    }
}
