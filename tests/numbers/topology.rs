//! Topology against its definition, walked recursively.

use std::collections::BTreeMap;

use linden::{Branching, NO_PARENT, Skeleton};
use proptest::prelude::*;

fn branchings() -> impl Strategy<Value = Branching> {
    let node = (any::<u16>(), prop::array::uniform3(-1.0_f32..1.0), 0.0..1.0_f64);
    prop::collection::vec(node, 2..120).prop_map(|nodes| {
        let mut all = Branching::default();
        for (i, (parent, step, chance)) in nodes.into_iter().enumerate() {
            let is_foot = i == 0 || (i > 1 && chance < 0.03);
            let parent = if chance < 0.4 { i.saturating_sub(1) } else { usize::from(parent) % i.max(1) };
            let from = if is_foot { linden::Vec3::ZERO } else { all.positions[parent] };
            all.positions.push(from + linden::Vec3::from(step));
            all.parents.push(if is_foot { NO_PARENT } else { parent as u32 });
            all.births.push(0);
        }
        all
    })
}

fn children(all: &Branching, node: u32) -> Vec<u32> {
    (0..all.parents.len() as u32).filter(|&child| all.parents[child as usize] == node).collect()
}

fn strahler(all: &Branching, node: u32) -> u32 {
    let mut orders: Vec<u32> = children(all, node).into_iter().map(|child| strahler(all, child)).collect();
    orders.sort_unstable();
    match orders[..] {
        [] => 1,
        [.., a, b] if a == b => a + 1,
        [.., a] => a,
    }
}

fn length(all: &Branching, node: u32) -> f64 {
    let parent = all.parents[node as usize];
    if parent == NO_PARENT {
        0.0
    } else {
        f64::from(all.positions[node as usize].distance(all.positions[parent as usize]))
    }
}

fn path(all: &Branching, node: u32) -> f64 {
    let parent = all.parents[node as usize];
    if parent == NO_PARENT { 0.0 } else { length(all, node) + path(all, parent) }
}

/// The chains of segments of one order, each from its upper end down.
fn chains(all: &Branching) -> BTreeMap<u32, Vec<f64>> {
    let mut found: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for node in (0..all.parents.len() as u32).filter(|&node| all.parents[node as usize] != NO_PARENT) {
        let order = strahler(all, node);
        if children(all, node).into_iter().any(|child| strahler(all, child) == order) {
            continue;
        }
        let (mut total, mut at) = (0.0, node);
        while all.parents[at as usize] != NO_PARENT && strahler(all, at) == order {
            total += length(all, at);
            at = all.parents[at as usize];
        }
        found.entry(order).or_default().push(total);
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn topology_is_what_a_walk_finds(all in branchings()) {
        prop_assume!(all.validate().is_ok() && all.positions.iter().any(|place| *place != all.positions[0]));
        let tree = Skeleton::build(all.clone(), &linden::skeleton::Wood::default()).unwrap();
        let lists = tree.children();
        let (orders, paths) = (tree.strahler(), tree.path_lengths_m());
        let nodes = all.parents.len() as u32;
        for node in 0..nodes {
            prop_assert_eq!(lists.of(node as usize), &children(&all, node)[..]);
            prop_assert_eq!(orders[node as usize], strahler(&all, node));
            prop_assert!((paths[node as usize] - path(&all, node)).abs() < 1e-9);
        }
        let is_tip = |&node: &u32| children(&all, node).is_empty() && all.parents[node as usize] != NO_PARENT;
        prop_assert_eq!(tree.tips(), (0..nodes).filter(is_tip).collect::<Vec<_>>());
        let streams = tree.streams();
        let chains = chains(&all);
        prop_assert_eq!(streams.len(), chains.len());
        for (stream, (_, lengths)) in streams.iter().zip(&chains) {
            prop_assert_eq!(stream.count, lengths.len());
            prop_assert!((stream.mean_length_m - lengths.iter().sum::<f64>() / lengths.len() as f64).abs() < 1e-9);
        }
        let axis_of = tree.axis_of_nodes();
        for (index, axis) in tree.axes.iter().enumerate() {
            prop_assert!(tree.nodes_of(axis).iter().all(|&node| axis_of[node as usize] as usize == index));
        }
    }
}
