//! Lone limbs: what hangs below a gap of the crown.
//!
//! Foresters begin a crown where its limbs follow each other, and leave out those that hang alone below a gap (US Forest
//! Service, *Forest Inventory and Analysis national core field guide*, crown ratio). Competition for light alone leaves
//! such limbs: one that reached out of the shade keeps its light, and looks like a forgotten one.

use crate::SelfOrganizing;
use crate::tree::{DEAD, LATERAL, Nodes, SHED};

/// A limb closes a gap where its share of its stem's twigs is at least one in this many.
const OF_A_LIMB: u32 = 1000;

/// What hangs below a gap is a storey of the crown where its share of the stem's twigs is more than one in this many.
const OF_A_STOREY: u32 = 5;

/// Limbs that hang alone below the crown of their stem.
#[derive(Debug, Default)]
pub(crate) struct Lone {
    /// Of each node, whether such a limb begins with it; empty where there is none.
    begins: Vec<bool>,
}

impl Lone {
    /// The limbs below a stretch of trunk that bears none, longer than [`SelfOrganizing::crown_gap_m`], where all of them
    /// are a small part of the crown. Dead and shed wood does not count. A trunk is the axis that begins at a foot, and
    /// its highest limb begins the crown; stems that buds grew as by reiteration are no limbs, and close gaps.
    pub fn of(nodes: &Nodes, settings: &SelfOrganizing) -> Self {
        // What goes on where an apex died is no longer the trunk.
        if settings.crown_gap_m == 0.0 || settings.sympodial {
            return Self::default();
        }
        let gap = (settings.crown_gap_m / settings.internode_m) as f32;
        let twigs = twigs(nodes);
        // Bare trunk from a node up to the lowest limb of the crown: less than 0 until there is one.
        let mut bare = vec![-1.0_f32; nodes.len()];
        let mut is_below = vec![false; nodes.len()];
        // From the tips down: what a node bears has higher numbers.
        for node in (0..nodes.len()).rev().filter(|&node| !nodes.is_foot(node) && is_there(nodes, node)) {
            let parent = nodes.parents[node] as usize;
            let all = twigs.of_stem[parent];
            if all == 0 {
                continue;
            }
            let above = twigs.counted[node];
            if nodes.is(node, LATERAL) {
                if u64::from(above) * u64::from(OF_A_LIMB) >= u64::from(all) {
                    bare[parent] = 0.0;
                }
            } else if bare[node] >= 0.0 {
                let stretch = bare[node] + nodes.places[node].distance(nodes.places[parent]);
                is_below[parent] = is_below[node] || stretch > gap && all - above <= all / OF_A_STOREY;
                if bare[parent] < 0.0 {
                    bare[parent] = stretch;
                }
            }
        }
        let is_lone = |node| {
            !nodes.is_foot(node)
                && is_below[nodes.parents[node] as usize]
                && nodes.is(node, LATERAL)
                && nodes.orders[node] > 0
                && is_there(nodes, node)
        };
        let begins: Vec<bool> = (0..nodes.len()).map(is_lone).collect();
        if begins.contains(&true) { Self { begins } } else { Self::default() }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.begins.is_empty()
    }

    /// Whether such a limb begins with a node.
    pub fn begins_with(&self, node: usize) -> bool {
        self.begins.get(node).copied().unwrap_or(false)
    }
}

fn is_there(nodes: &Nodes, node: usize) -> bool {
    !nodes.is(node, DEAD | SHED)
}

/// Internodes of what trunks bear.
struct Twigs {
    /// From each node on, without the trunk's own.
    counted: Vec<u32>,
    /// Of each node of a trunk all that its stem bears; of others 0.
    of_stem: Vec<u32>,
}

fn twigs(nodes: &Nodes) -> Twigs {
    let parent = |node: usize| nodes.parents[node] as usize;
    let mut is_trunk = vec![false; nodes.len()];
    for node in 0..nodes.len() {
        is_trunk[node] = nodes.is_foot(node) || !nodes.is(node, LATERAL) && is_trunk[parent(node)];
    }
    let counts = |node: usize| u32::from(!is_trunk[node] && is_there(nodes, node));
    let mut counted: Vec<u32> = (0..nodes.len()).map(counts).collect();
    for node in (0..nodes.len()).rev().filter(|&node| !nodes.is_foot(node)) {
        counted[parent(node)] += counted[node];
    }
    let mut of_stem = vec![0; nodes.len()];
    for node in (0..nodes.len()).filter(|&node| is_trunk[node]) {
        of_stem[node] = if nodes.is_foot(node) { counted[node] } else { of_stem[parent(node)] };
    }
    Twigs { counted, of_stem }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grow::Growth;
    use crate::tree::{Node, PARTS};
    use glam::DVec3;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// Internodes of a trunk.
    const TRUNK: u32 = 20;

    /// Adds a trunk with limbs of so many internodes at some heights, in internodes; where each limb begins.
    fn plant(growth: &mut Growth<'_>, limbs: &[(u32, u32)], order: u8) -> Vec<usize> {
        let foot = growth.nodes.len() as u32;
        growth.plant(DVec3::ZERO, DVec3::Y, DVec3::X, Key::new(1));
        let mut push = |parent, height: u32, order, flags| {
            let (place, direction, side, key) =
                (DVec3::Y * f64::from(height), DVec3::Y, DVec3::X, Key::new(2));
            let (birth, buds) = (PARTS, 0);
            growth.nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
            growth.nodes.len() - 1
        };
        (0..TRUNK).for_each(|height| _ = push(foot + height, height + 1, 0, 0));
        let mut limb = |&(height, size): &(u32, u32)| {
            let first = push(foot + height, height, order, LATERAL);
            (1..size).for_each(|i| _ = push((first as u32) + i - 1, height, order, 0));
            first
        };
        limbs.iter().map(&mut limb).collect()
    }

    /// The heights of the lone ones among limbs of a trunk.
    fn lone(limbs: &[(u32, u32)], crown_gap_m: f64) -> Vec<u32> {
        let settings = SelfOrganizing { internode_m: 0.5, crown_gap_m, ..SelfOrganizing::default() };
        let mut growth = Growth::new(&settings);
        let first = plant(&mut growth, limbs, 1);
        let lone = Lone::of(&growth.nodes, &settings);
        let found = (0..growth.nodes.len()).filter(|&node| lone.begins_with(node)).count();
        let lone = |&(first, _): &(&usize, &(u32, u32))| lone.begins_with(*first);
        let heights: Vec<u32> =
            first.iter().zip(limbs).filter(lone).map(|(_, (height, _))| *height).collect();
        assert_eq!(heights.len(), found);
        heights
    }

    #[test]
    fn a_limb_below_a_long_gap_is_lone_where_the_crown_is_much_larger() {
        // The crown's lowest limb is at 12; 3.5 m below it is one with a tenth of all twigs.
        let crown = [(16, 400), (14, 400), (12, 300)];
        let with = |low: &[(u32, u32)]| [&crown[..], low].concat();
        let none: Vec<u32> = Vec::new();
        assert_eq!(lone(&with(&[(5, 120)]), 3.4), [5], "3.5 m of bare trunk");
        assert_eq!(lone(&with(&[(5, 120)]), 3.6), none, "the crown goes on");
        assert_eq!(lone(&with(&[(5, 120), (9, 5)]), 3.4), none, "a limb between closes the gap");
        assert_eq!(lone(&with(&[(5, 120), (9, 1)]), 3.4), [5], "a twig does not");
        assert_eq!(lone(&with(&[(5, 120), (3, 9), (2, 40)]), 3.4), [5, 3, 2], "and all that is below");
        assert_eq!(lone(&with(&[(5, 400)]), 3.4), none, "a quarter of all twigs is a storey");
        assert_eq!(lone(&with(&[(9, 300), (2, 30)]), 3.4), [2], "below the lowest storey");
        assert_eq!(lone(&with(&[(5, 120)]), 0.0), none);
        assert_eq!(lone(&[(5, 120)], 0.5), none, "above the highest limb is no gap");
        // Tiers that are as far apart as the gap is long are a crown.
        let tiers: Vec<(u32, u32)> = (1..5).map(|tier| (4 * tier, 100)).collect();
        assert_eq!(lone(&tiers, 2.0), none);
    }

    #[test]
    fn each_stem_has_a_crown_of_its_own_and_other_stems_are_no_limbs() {
        let settings = SelfOrganizing { internode_m: 0.5, crown_gap_m: 3.4, ..SelfOrganizing::default() };
        let mut growth = Growth::new(&settings);
        let full = plant(&mut growth, &[(16, 400), (5, 20)], 1);
        // With all twigs of both, its limb would be none of a storey.
        let other = plant(&mut growth, &[(16, 40), (5, 20)], 1);
        let stem = plant(&mut growth, &[(16, 400), (5, 20)], 0);
        let lone = Lone::of(&growth.nodes, &settings);
        assert!(lone.begins_with(full[1]) && !lone.begins_with(other[1]) && !lone.begins_with(stem[1]));
        // What is dead or shed is not there.
        for flag in [DEAD, SHED] {
            let mut nodes = growth.nodes.clone();
            (full[0]..full[1]).for_each(|node| nodes.flags[node] |= flag);
            assert!(!Lone::of(&nodes, &settings).begins_with(full[1]), "the highest limb that is left");
        }
    }

    #[test]
    fn no_grown_tree_has_a_lone_limb() {
        let settings = |crown_gap_m| SelfOrganizing {
            years: 31,
            internode_m: 0.254,
            leader: vec![0.547, 0.51],
            mature_leader: Some(0.495),
            mature_from: 12,
            mature_to: 26,
            longest_shoot: 6.0,
            light: crate::LightModel::Sky,
            shade: 0.4,
            leaf_years: 2,
            light_pull: 0.12,
            upward: vec![0.15, 0.3],
            phyllotaxis: crate::Phyllotaxis::Opposite,
            branching_angle_deg: vec![36.0, 40.0],
            jitter: 0.16,
            shed: 0.235,
            bole_m: 4.5,
            sag: 1.2,
            righting: 1.0,
            crown_gap_m,
            ..SelfOrganizing::default()
        };
        // From the skeleton alone: limbs on the first axis, from the highest down. Shoots that grew and sank since the last
        // limbs were shed move both measures a little, so that gaps are a third longer here, and storeys a sixth.
        let grown = |crown_gap_m, seed| {
            let settings = settings(crown_gap_m);
            let mut growth = Growth::new(&settings);
            growth.plant(DVec3::new(0.5, 0.0, 0.5), DVec3::Y, DVec3::X, Key::new(seed));
            (0..settings.years).for_each(|_| growth.grow_year(&Quiet).unwrap());
            let nodes = &growth.nodes;
            let mut sizes = vec![1_u64; nodes.len()];
            for node in (1..nodes.len()).rev() {
                sizes[nodes.parents[node] as usize] += sizes[node];
            }
            let all = sizes[0];
            let mut limbs: Vec<(f64, u64)> = (1..nodes.len())
                .filter(|&node| nodes.is(node, LATERAL) && nodes.orders[nodes.parents[node] as usize] == 0)
                .map(|node| (f64::from(nodes.places[nodes.parents[node] as usize].y), sizes[node]))
                .filter(|(_, size)| size * 1000 >= all)
                .collect();
            limbs.sort_by(|a, b| b.0.total_cmp(&a.0));
            let lone = (1..limbs.len())
                .filter(|&limb| (limbs[limb - 1].0 - limbs[limb].0) * settings.internode_m > 1.3)
                .filter(|&limb| limbs[limb..].iter().map(|(_, size)| size).sum::<u64>() * 6 < all)
                .count();
            (lone, all)
        };
        let all = |crown_gap_m| {
            let trees: Vec<(usize, u64)> = (0..8).map(|seed| grown(crown_gap_m, seed)).collect();
            trees.iter().fold((0, 0), |sum, tree| (sum.0 + tree.0, sum.1 + tree.1))
        };
        let [(without, whole), (with, left)] = [0.0, 1.0].map(all);
        assert!(without > 0 && with == 0, "{without} {with}");
        assert!(left * 10 > whole * 7 && left < whole, "crowns stay: {left} of {whole} nodes");
    }
}
