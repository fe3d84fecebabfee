//! Lone limbs: what hangs below a gap of the crown.
//!
//! Foresters begin a crown where its limbs follow each other, and leave out those that hang alone below a gap (US Forest
//! Service, *Forest Inventory and Analysis national core field guide*, crown ratio). Competition for light alone leaves
//! such limbs: one that reached out of the shade keeps its light, and looks like a forgotten one.

use crate::SelfOrganizing;
use crate::sums::Sums;
use crate::tree::{DEAD, LATERAL, Nodes, SHED};

/// A limb with fewer of its tree's living internodes than one in this many closes no gap.
const OF_A_LIMB: u64 = 1000;

/// What hangs below a gap is a storey of the crown where it has more than one in this many of the living internodes.
const OF_A_STOREY: u64 = 5;

/// The nodes of trunks whose limbs hang lone below the crown.
#[derive(Debug)]
pub(crate) struct Lone(Vec<bool>);

impl Lone {
    /// The limbs below a stretch of trunk that bears none, longer than [`SelfOrganizing::crown_gap_m`], where they are
    /// a small part of the tree. The trunk is the first axis, and the highest limb begins the crown.
    pub fn of(nodes: &Nodes, sums: &Sums, settings: &SelfOrganizing) -> Self {
        if settings.crown_gap_m == 0.0 {
            return Self(Vec::new());
        }
        let gap = (settings.crown_gap_m / settings.internode_m) as f32;
        let living = of_trees(nodes, sums);
        // Bare trunk from a node up to the lowest limb of the crown, once there is one.
        let mut bare: Vec<Option<f32>> = vec![None; nodes.len()];
        let mut lone = vec![false; nodes.len()];
        let (is_trunk, is_there) = (|node: usize| living[node] > 0, |node| !nodes.is(node, DEAD | SHED));
        // From the tips down.
        for node in (0..nodes.len()).rev().filter(|&node| !nodes.is_foot(node) && is_there(node)) {
            let parent = nodes.parents[node] as usize;
            let (all, above) = (living[parent], u64::from(sums.internodes[node]));
            if is_trunk(node) {
                // Its limbs, and where they are the crown's, were seen before: they have higher numbers.
                let length = nodes.places[node].distance(nodes.places[parent]);
                let stretch = bare[node].map(|bare| bare + length);
                let is_wide = stretch.is_some_and(|stretch| stretch > gap);
                lone[parent] = lone[node] || is_wide && (all - above) * OF_A_STOREY <= all;
                bare[parent] = bare[parent].or(stretch);
            } else if is_trunk(parent) && above * OF_A_LIMB >= all {
                bare[parent] = Some(0.0);
            }
        }
        Self(lone)
    }

    pub fn is_any(&self) -> bool {
        self.0.contains(&true)
    }

    /// Whether limbs at a node are lone.
    pub fn holds(&self, node: usize) -> bool {
        self.0.get(node).copied().unwrap_or(false)
    }
}

/// Of each node of a trunk the living internodes of its tree; of all others 0.
fn of_trees(nodes: &Nodes, sums: &Sums) -> Vec<u64> {
    let mut living = vec![0_u64; nodes.len()];
    for node in 0..nodes.len() {
        living[node] = match nodes.parents[node] as usize {
            _ if nodes.is_foot(node) => sums.internodes[node].into(),
            _ if nodes.is(node, LATERAL) => 0,
            parent => living[parent],
        };
    }
    living
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

    /// Up to which height limbs of a trunk are lone, where it bears limbs of so many internodes at some heights.
    fn lone(limbs: &[(u32, u32)], crown_gap_m: f64) -> Option<usize> {
        let settings = SelfOrganizing { internode_m: 0.5, crown_gap_m, ..SelfOrganizing::default() };
        let mut growth = Growth::new(&settings);
        growth.plant(DVec3::ZERO, DVec3::Y, DVec3::X, Key::new(1));
        let mut nodes = growth.nodes;
        let mut push = |parent, height: u32, flags| {
            let (place, direction, side, key) =
                (DVec3::Y * f64::from(height), DVec3::Y, DVec3::X, Key::new(2));
            let (birth, order, buds) = (PARTS, u8::from(flags == LATERAL), 0);
            nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
        };
        (0..TRUNK).for_each(|height| push(height, height + 1, 0));
        limbs.iter().for_each(|&(height, _)| push(height, height, LATERAL));
        let mut internodes = vec![0; nodes.len()];
        for (number, &(_, size)) in limbs.iter().enumerate() {
            internodes[TRUNK as usize + 1 + number] = size;
        }
        for node in (1..nodes.len()).rev() {
            internodes[node] += u32::from(!nodes.is(node, LATERAL));
            internodes[nodes.parents[node] as usize] += internodes[node];
        }
        let lone = Lone::of(&nodes, &Sums { internodes, ..Sums::default() }, &settings);
        let highest = (0..nodes.len()).rev().find(|&node| lone.holds(node))?;
        assert!((0..highest).all(|node| lone.holds(node)));
        Some(highest)
    }

    #[test]
    fn a_limb_below_a_long_gap_is_lone_where_the_crown_is_much_larger() {
        // The crown's lowest limb at 12; 7 internodes below it one with a tenth of the tree.
        let crown = [(16, 400), (14, 400), (12, 300)];
        let with = |low: &[(u32, u32)]| [&crown[..], low].concat();
        assert_eq!(lone(&with(&[(5, 120)]), 3.4), Some(5), "3.5 m of bare trunk");
        assert_eq!(lone(&with(&[(5, 120)]), 3.6), None, "the crown goes on");
        assert_eq!(lone(&with(&[(5, 120), (9, 5)]), 3.4), None, "a limb between closes the gap");
        assert_eq!(lone(&with(&[(5, 120), (9, 1)]), 3.4), Some(5), "a twig does not");
        assert_eq!(lone(&with(&[(5, 400)]), 3.4), None, "a quarter of the tree is a storey");
        assert_eq!(lone(&with(&[(5, 120)]), 0.0), None);
        assert_eq!(lone(&[(5, 120)], 0.5), Some(3), "above the highest limb is no gap");
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
        // By the definition, from the skeleton alone: limbs on the first axis, from the highest down.
        let lone_limbs = |crown_gap_m, seed| {
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
            (1..limbs.len())
                .filter(|&limb| (limbs[limb - 1].0 - limbs[limb].0) * settings.internode_m > 1.3)
                .filter(|&limb| limbs[limb..].iter().map(|(_, size)| size).sum::<u64>() * 6 < all)
                .count()
        };
        let all = |crown_gap_m| (0..8).map(|seed| lone_limbs(crown_gap_m, seed)).sum::<usize>();
        let (without, with) = (all(0.0), all(1.0));
        println!("{without} {with}");
        assert!(without > 0 && with == 0, "{without} {with}");
    }
}
