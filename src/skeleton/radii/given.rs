//! Radii that the generator gave, fitted to the ends that are asked for.

use rayon::prelude::*;

use super::pipe::count_tips;
use super::{THINNEST_PER_BASE, Wood};
use crate::{NO_PARENT, Skeleton};

/// Scales radii so that the thickest is the base radius, where one is asked for, and makes nothing
/// thinner than the tip radius (a thousandth of the thickest where none is asked for).
pub(super) fn within(mut radii: Vec<f32>, wood: &Wood) -> Vec<f32> {
    let thickest = f64::from(radii.par_iter().copied().reduce(|| 0.0, f32::max));
    let base = wood.base_radius_m.unwrap_or(thickest);
    let thinnest = wood.tip_radius_m.unwrap_or(base * THINNEST_PER_BASE) as f32;
    // 1 exactly where nothing is asked for: then the radii keep their bits.
    let scale = base / thickest;
    radii.par_iter_mut().for_each(|radius| *radius = ((f64::from(*radius) * scale) as f32).max(thinnest));
    radii
}

/// The radii of a younger tree, which has some of the nodes of the whole one, `parents` among themselves: the wood's
/// area goes with the tips that it bears (Leonardo's rule, the pipe model with n = 2). No twig is thinner than the
/// thinnest of the whole tree, and nothing is thicker than what bears it, unless it always was.
pub(super) fn when_young(whole: &Skeleton, nodes: &[u32], parents: &[u32]) -> Vec<f32> {
    let (then, now) = (count_tips(parents), count_tips(&whole.parents));
    let thinnest = whole.radii.iter().copied().fold(f32::INFINITY, f32::min);
    let radius = |(young, &old): (usize, &u32)| {
        let share = f64::from(then[young]) / f64::from(now[old as usize]);
        ((f64::from(whole.radii[old as usize]) * share.sqrt()) as f32).max(thinnest)
    };
    let mut radii: Vec<f32> = nodes.iter().enumerate().map(radius).collect();
    // What was borne by thinner wood in the whole tree stays as much thicker.
    for node in (0..radii.len()).rev().filter(|&node| parents[node] != NO_PARENT) {
        let parent = parents[node] as usize;
        let of_whole = |node: usize| whole.radii[nodes[node] as usize];
        let least = radii[node] * (of_whole(parent) / of_whole(node)).min(1.0);
        radii[parent] = radii[parent].max(least);
    }
    radii
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Branching;
    use glam::Vec3;
    use linden_base::random::Key;

    #[test]
    fn young_wood_is_as_thick_as_the_tips_that_it_bears_ask_for() {
        // A stem of three nodes; two twigs leave it below its top, born late.
        let branching = Branching {
            positions: vec![
                Vec3::ZERO,
                Vec3::Y,
                Vec3::Y * 2.0,
                Vec3::Y * 3.0,
                Vec3::new(1.0, 2.0, 0.0),
                Vec3::new(1.0, 3.0, 0.0),
                Vec3::new(2.0, 2.0, 0.0),
            ],
            parents: vec![NO_PARENT, 0, 1, 2, 1, 4, 4],
            births: vec![0, 1, 2, 3, 2, 3, 3],
            radii: Some(vec![0.4, 0.3, 0.2, 0.1, 0.15, 0.02, 0.02]),
            edges: None,
        };
        let wood = Wood::default().settled(true, false);
        let tree = Skeleton::build(branching, &wood).unwrap();
        let young = tree.until(2, &wood, Key::new(0));
        // Tips of 3 at the foot and at the fork, of 1 above it, of 2 at the twig: now 2, 2, 1, 1.
        let expected =
            [0.4 * (2.0_f32 / 3.0).sqrt(), 0.3 * (2.0_f32 / 3.0).sqrt(), 0.2, 0.15 * 0.5_f32.sqrt()];
        assert_eq!(young.radii.len(), 4);
        for (radius, expected) in young.radii.iter().zip(expected) {
            assert!((radius - expected).abs() < 1e-6, "{:?}", young.radii);
        }
        let first = tree.until(1, &wood, Key::new(0));
        assert!((first.radii[1] - 0.3 * (1.0_f32 / 3.0).sqrt()).abs() < 1e-6, "{:?}", first.radii);
        assert!(first.radii[0] >= first.radii[1]);
    }

    #[test]
    fn nothing_is_thicker_than_what_bears_it_unless_it_always_was() {
        let key = Key::new(5);
        let mut all = Branching { radii: Some(Vec::new()), ..Branching::default() };
        for i in 0..600_u32 {
            let k = key.child(u64::from(i));
            let parent = (k.child(0).unit() * f64::from(i)) as u32;
            let radii = all.radii.as_mut().unwrap();
            let (at, radius) = match i {
                0 => (Vec3::ZERO, 1.0),
                _ => (all.positions[parent as usize] + Vec3::Y, radii[parent as usize] * 0.8),
            };
            radii.push(radius);
            all.positions.push(at + Vec3::X * k.child(1).unit() as f32);
            all.parents.push(if i == 0 { NO_PARENT } else { parent });
            all.births.push(if i == 0 { 0 } else { all.births[parent as usize] + 1 });
        }
        let wood = Wood::default().settled(true, false);
        let tree = Skeleton::build(all, &wood).unwrap();
        let thinnest = tree.radii.iter().copied().fold(f32::INFINITY, f32::min);
        for step in 1..8 {
            let young = tree.until(step, &wood, Key::new(0));
            assert!(young.segments() > 0);
            assert!(young.radii.iter().all(|&radius| radius >= thinnest));
            assert!(young.radii[0] < 1.0, "{step}: {}", young.radii[0]);
            for (node, &parent) in
                young.parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT)
            {
                assert!(young.radii[node] <= young.radii[parent as usize] * 1.000_01, "{step} {node}");
            }
        }
    }

    #[test]
    fn given_radii_are_kept_scaled_and_bounded() {
        let wood = Wood::default();
        assert_eq!(within(vec![0.3, 0.2, 0.0, -1.0], &wood), [0.3, 0.2, 0.0003, 0.0003]);
        let scaled = Wood { base_radius_m: Some(0.6), tip_radius_m: Some(0.5), ..wood };
        assert_eq!(within(vec![0.3, 0.2], &scaled), [0.6, 0.5]);
    }
}
