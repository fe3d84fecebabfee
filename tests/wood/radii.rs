use linden::random::Key;
use linden::skeleton::{Axis, Span, Width, Wood};
use linden::{Branching, NO_PARENT, Skeleton};
use proptest::prelude::*;

use crate::branchings;

const KEY: Key = Key::new(7);

fn built(all: &Branching, wood: &Wood) -> Skeleton {
    Skeleton::build_keyed(all.clone(), wood, KEY).unwrap()
}

/// The nodes of an axis with the arc length from its first one.
fn along(tree: &Skeleton, axis: &Axis) -> Vec<(u32, f64)> {
    let mut length = 0.0;
    let nodes = tree.nodes_of(axis);
    let mut last = tree.positions[nodes[0] as usize];
    let mut at = |&node: &u32| {
        length += f64::from(tree.positions[node as usize].distance(last));
        last = tree.positions[node as usize];
        (node, length)
    };
    nodes.iter().map(&mut at).collect()
}

proptest! {
    /// `r^n` above a fork is the sum of `r^n` below it, however it is shared.
    #[test]
    fn forks_conserve(all in branchings(), exponent in 1.5..3.0_f64, angle_share in 0.0..=1.0_f64,
                      tip in prop::option::of(0.001..0.1_f64)) {
        // A tree in one place has no height, from which its radii would be.
        prop_assume!(all.positions.iter().any(|place| *place != all.positions[0]));
        let wood = Wood { radius_exponent: exponent, angle_share, tip_radius_m: tip, ..Wood::default() };
        let tree = built(&all, &wood);
        let power = |node: usize| libm::pow(f64::from(tree.radii[node]), exponent);
        let mut above = vec![0.0; all.parents.len()];
        for (node, &parent) in all.parents.iter().enumerate() {
            if parent != NO_PARENT {
                above[parent as usize] += power(node);
                prop_assert!(tree.radii[node] <= tree.radii[parent as usize] * 1.000_001);
            }
        }
        for (node, &above) in above.iter().enumerate() {
            prop_assert!(tree.radii[node] > 0.0);
            if above > 0.0 {
                prop_assert!((power(node) / above - 1.0).abs() < 1e-4, "{} against {above}", power(node));
            }
            prop_assert!(tip.is_none_or(|tip| f64::from(tree.radii[node]) >= tip * 0.999_999));
        }
    }

    /// Each axis: a drawn share of its parent, a drawn share of itself, a straight line between.
    #[test]
    fn tapers_are_straight_between_shares_in_their_ranges(all in branchings(), base in 0.1..1.0_f64) {
        let (taper_base, taper_tip) = (Span { min: 0.5, max: 0.9 }, Span { min: 0.1, max: 0.3 });
        let wood = Wood {
            width: Width::Taper, base_radius_m: Some(base), tip_radius_m: Some(1e-12),
            taper_base, taper_tip, ..Wood::default()
        };
        let tree = built(&all, &wood);
        for axis in &tree.axes {
            let nodes = along(&tree, axis);
            let of = |i: usize| f64::from(tree.radii[nodes[i].0 as usize]);
            let (first, last) = (of(0), of(nodes.len() - 1));
            if nodes.len() > 1 && nodes[nodes.len() - 1].1 > 0.0 {
                let below = match axis.parent {
                    NO_PARENT => { prop_assert_eq!(first as f32, base as f32); None }
                    parent => Some(f64::from(tree.radii[parent as usize])),
                };
                prop_assert!(below.is_none_or(|r| (0.499..0.901).contains(&(first / r))));
                prop_assert!((0.099..0.301).contains(&(last / first)));
                for (i, (_, at)) in nodes.iter().enumerate() {
                    let line = first + (last - first) * at / nodes[nodes.len() - 1].1;
                    prop_assert!((of(i) / line - 1.0).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn orders_are_halved(all in branchings()) {
        let wood = Wood { width: Width::Order, base_radius_m: Some(0.8), ..Wood::default() };
        let tree = built(&all, &wood);
        for axis in &tree.axes {
            let halved = (0..axis.order).fold(0.8_f64, |radius, _| radius / 2.0).max(0.8e-3);
            for &node in tree.nodes_of(axis) {
                prop_assert_eq!(tree.radii[node as usize], halved as f32);
            }
        }
    }

    /// A young tree is whole when it is grown, and no wood is thicker before than after.
    #[test]
    fn young_trees_follow_each_rule(all in branchings(), step in 0..9_u32) {
        for &width in Width::ALL {
            let wood = Wood { width, base_radius_m: Some(0.3), ..Wood::default() }.settled(false, false);
            let tree = built(&all, &wood);
            let young = tree.until(step, &wood, KEY);
            prop_assert!(young.radii.iter().all(|&radius| radius > 0.0 && radius <= 0.300_001));
            prop_assert_eq!(&tree.until(9, &wood, KEY), &tree);
        }
    }
}

/// A lateral more on one axis changes no radius of another one.
#[test]
fn what_is_drawn_for_an_axis_does_not_depend_on_the_others() {
    let stem = (0..8).map(|i| (glam::Vec3::Y * i as f32, if i == 0 { NO_PARENT } else { i - 1 }));
    let twig = |at: u32, first: u32, side: glam::Vec3| {
        (0..3).map(move |i: u32| {
            let place = glam::Vec3::Y * at as f32 + side * (i + 1) as f32;
            (place, if i == 0 { at } else { first + i - 1 })
        })
    };
    let tree = |nodes: Vec<(glam::Vec3, u32)>| {
        let (positions, parents): (Vec<_>, Vec<_>) = nodes.into_iter().unzip();
        let births = vec![0; parents.len()];
        let wood = Wood { width: Width::Taper, ..Wood::default() };
        built(&Branching { positions, parents, births, radii: None, edges: None }, &wood)
    };
    let two: Vec<_> = stem.chain(twig(3, 8, glam::Vec3::X)).chain(twig(5, 11, glam::Vec3::Z)).collect();
    let mut three = two.clone();
    // On the first twig.
    three.push((glam::Vec3::new(1.0, 4.0, 0.0), 8));
    let (two, three) = (tree(two), tree(three));
    assert_eq!(two.radii[..14], three.radii[..14]);
    assert_ne!(two.radii[8], two.radii[11], "each draws its own");
}

#[test]
fn given_radii_are_kept_and_missing_ones_fall_back() {
    let mut all = Branching {
        positions: vec![glam::Vec3::ZERO, glam::Vec3::Y, glam::Vec3::X + glam::Vec3::Y, glam::Vec3::Y * 2.0],
        parents: vec![NO_PARENT, 0, 1, 1],
        births: vec![0; 4],
        radii: Some(vec![0.2, 0.2, 0.3, 0.1]),
        edges: None,
    };
    let auto = built(&all, &Wood::default());
    assert_eq!(auto.radii, [0.2, 0.2, 0.3, 0.1], "also where a child is thicker");
    assert_eq!(auto.nodes_of(&auto.axes[0]), [0, 1, 2], "the thickest continues");
    let pipe = built(&all, &Wood { width: Width::Pipe, ..Wood::default() });
    assert!(pipe.radii[2] < pipe.radii[1]);
    all.radii = None;
    let grammar = Wood { width: Width::Grammar, ..Wood::default() };
    assert_eq!(built(&all, &grammar), built(&all, &Wood::default()), "no radii: the pipe model");
    all.radii = Some(vec![0.1; 3]);
    assert!(Skeleton::build(all.clone(), &grammar).is_err());
    all.radii = Some(vec![f32::NAN; 4]);
    assert!(Skeleton::build(all, &grammar).is_err());
}
