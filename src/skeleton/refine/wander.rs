//! Axes that wander: trunks and limbs sway, old wood is gnarled.
//!
//! Each axis is displaced by an offset that starts at zero; whatever hangs on it is carried along, so
//! that laterals leave from where they did. What is drawn belongs to the axis: what grows elsewhere
//! changes nothing here, but for where a bole ends (`trunk_gnarl`).

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::{NODES_PER_CHECK, RefineError, Refinement, Shoots};
use crate::radii::{by_axis, provisional};
use crate::{Axis, Branching, NO_PARENT, axes_by_tips};
use linden_base::monitor::Monitor;
use linden_base::random::Key;

/// Length of a bend of gnarled wood, in radii of the wood.
const BEND_RADII: f64 = 9.0;
/// What is thinner than this share of its stem is no limb: the bole goes on above it.
const LIMB: f64 = 0.15;

/// Displaces all axes.
pub(super) fn wander(
    shoots: &mut Shoots<'_>,
    refinement: &Refinement,
    monitor: &dyn Monitor,
) -> Result<(), RefineError> {
    let Branching { positions, parents, .. } = &shoots.branching;
    // The wood as it stands, whatever the brackets of a grammar say.
    let (axes, axis_nodes) = axes_by_tips(positions, parents, None);
    let keys = by_axis::keys(&axes, &axis_nodes, shoots.room.key.named("wander"));
    // As thick as the wood is before anything is displaced, which changes little.
    let radii = if refinement.gnarl > 0.0 {
        provisional(&shoots.branching, &shoots.room.wood, shoots.room.key)
    } else {
        Vec::new()
    };
    let radius_m = |node: u32| radii.get(node as usize).map_or(0.0, |&radius| f64::from(radius));
    let boles = Boles::new(&axes, &axis_nodes, refinement, radius_m);
    let mut places = positions.clone();
    let mut looked_at = 0;
    for (axis, &key) in axes.iter().zip(&keys) {
        looked_at += axis.len as usize;
        if looked_at >= NODES_PER_CHECK {
            monitor.check()?;
            looked_at = 0;
        }
        let nodes = &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
        let course = Course::new(axis, nodes, positions);
        let carried = match axis.parent {
            NO_PARENT => DVec3::ZERO,
            parent => (places[parent as usize] - positions[parent as usize]).as_dvec3(),
        };
        let sway = Sway::new(&course, key.named("sway"), refinement.sway);
        let mut gnarl = Gnarl::new(key.named("gnarl"), refinement.gnarl);
        let mut bole = boles.of(axis);
        let mut along_m = 0.0;
        let mut before = course.start;
        for &node in nodes {
            let here = positions[node as usize];
            let step_m = f64::from(before.distance(here));
            along_m += step_m;
            before = here;
            let share = bole.go(step_m, node, radius_m(node));
            let aside = carried + sway.at(along_m) + gnarl.go(step_m, radius_m(node)) * share;
            places[node as usize] = here + aside.as_vec3();
        }
    }
    shoots.relocate(places);
    Ok(())
}

/// Where an axis starts, where to, and how long it is.
struct Course {
    start: Vec3,
    direction: Vec3,
    length_m: f64,
}

impl Course {
    fn new(axis: &Axis, nodes: &[u32], positions: &[Vec3]) -> Self {
        let place = |node: u32| positions[node as usize];
        let first = nodes.first().map_or(Vec3::ZERO, |&node| place(node));
        let start = if axis.parent == NO_PARENT { first } else { place(axis.parent) };
        let apex = nodes.last().map_or(start, |&node| place(node));
        let steps = nodes.windows(2).map(|pair| f64::from(place(pair[0]).distance(place(pair[1]))));
        let length_m = f64::from(start.distance(first)) + steps.sum::<f64>();
        Self { start, direction: (apex - start).normalize_or(Vec3::Y), length_m }
    }
}

/// A slow swing to both sides: two waves in each of two directions across the axis.
struct Sway {
    /// Direction, waves along the axis, phase; the direction is as long as the wave is high.
    waves: [(DVec3, f64, f64); 4],
    length_m: f64,
}

impl Sway {
    fn new(course: &Course, key: Key, share: f64) -> Self {
        let (across, aside) = course.direction.any_orthonormal_pair();
        let [across, aside] = [across, aside].map(Vec3::as_dvec3);
        let high_m = share * course.length_m;
        let wave = |index: u64, direction: DVec3, waves: f64, share: f64| {
            let key = key.child(index);
            let stretched = waves * key.named("waves").between(0.8, 1.25);
            (direction * (high_m * share), stretched, key.named("phase").between(0.0, TAU))
        };
        let waves = [
            wave(0, across, 0.7, 0.5),
            wave(1, aside, 0.7, 0.5),
            wave(2, across, 1.7, 0.2),
            wave(3, aside, 1.7, 0.2),
        ];
        Self { waves, length_m: course.length_m }
    }

    /// The offset at an arc length. An axis sets out in its old direction.
    fn at(&self, along_m: f64) -> DVec3 {
        if !(self.length_m > 0.0) {
            return DVec3::ZERO;
        }
        let u = along_m / self.length_m;
        let ease = (u * 3.0).min(1.0);
        let ease = ease * ease * (3.0 - 2.0 * ease);
        let wave = |&(direction, waves, phase): &(DVec3, f64, f64)| {
            direction * (libm::sin(TAU * waves * u + phase) - libm::sin(phase))
        };
        self.waves.iter().map(wave).sum::<DVec3>() * ease
    }
}

/// Where the boles of stems end: at their lowest limbs.
struct Boles {
    /// Whether a limb leaves at a node; empty where boles are as gnarled as all other wood.
    bears_limb: Vec<bool>,
    /// What a bole has of the gnarl.
    share: f64,
}

impl Boles {
    fn new(
        axes: &[Axis],
        axis_nodes: &[u32],
        refinement: &Refinement,
        radius_m: impl Fn(u32) -> f64,
    ) -> Self {
        let share = refinement.trunk_gnarl;
        let mut bears_limb = Vec::new();
        if share < 1.0 && refinement.gnarl > 0.0 {
            bears_limb.resize(axis_nodes.len(), false);
            for axis in axes.iter().filter(|axis| axis.parent != NO_PARENT && axis.len > 0) {
                let first = axis_nodes[axis.first as usize];
                bears_limb[axis.parent as usize] |= radius_m(first) >= LIMB * radius_m(axis.parent);
            }
        }
        Self { bears_limb, share }
    }

    /// That of an axis, which has one only where it stands on the ground.
    fn of(&self, axis: &Axis) -> Bole<'_> {
        let stands = axis.parent == NO_PARENT && !self.bears_limb.is_empty();
        Bole { boles: self, is_below: stands, bends_above: if stands { 0.0 } else { 1.0 } }
    }
}

/// What wood along an axis has of the gnarl.
struct Bole<'a> {
    boles: &'a Boles,
    is_below: bool,
    /// Since the lowest limb, at most one.
    bends_above: f64,
}

impl Bole<'_> {
    /// The share after one more step: that of boles up to the lowest limb, all within a bend above it.
    fn go(&mut self, step_m: f64, node: u32, radius_m: f64) -> f64 {
        if !self.is_below && self.bends_above < 1.0 && radius_m > 0.0 {
            self.bends_above = (self.bends_above + step_m / (BEND_RADII * radius_m)).min(1.0);
        }
        self.is_below = self.is_below && !self.boles.bears_limb[node as usize];
        let t = self.bends_above;
        self.boles.share + (1.0 - self.boles.share) * t * t * (3.0 - 2.0 * t)
    }
}

/// Bends as long as the wood is thick, as high as a share of its radius: value noise along the axis.
struct Gnarl {
    key: Key,
    share: f64,
    /// Bends so far.
    bends: f64,
}

impl Gnarl {
    fn new(key: Key, share: f64) -> Self {
        Self { key, share, bends: 0.0 }
    }

    /// The offset after one more step.
    fn go(&mut self, step_m: f64, radius_m: f64) -> DVec3 {
        if !(self.share > 0.0 && radius_m > 0.0) {
            return DVec3::ZERO;
        }
        self.bends += step_m / (BEND_RADII * radius_m);
        // Sets out from nothing within the first bend.
        self.noise(self.bends) * (2.0 * self.share * radius_m * self.bends.min(1.0))
    }

    fn noise(&self, at: f64) -> DVec3 {
        let (whole, t) = (at.floor(), at - at.floor());
        let draw = |index: f64| {
            let key = self.key.child(index as u64);
            DVec3::from([0, 1, 2].map(|axis| key.child(axis).between(-1.0, 1.0)))
        };
        draw(whole).lerp(draw(whole + 1.0), t * t * (3.0 - 2.0 * t))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{random_tree, refined, straight_with_lateral, tree};
    use super::super::{Room, refine};
    use super::*;
    use crate::Wood;
    use linden_base::mesh::Bounds;
    use linden_base::monitor::Quiet;

    #[test]
    fn a_straight_stem_sways_within_its_share_and_its_lateral_is_carried_rigidly() {
        let all = straight_with_lateral();
        for share in [0.02, 0.1] {
            let swayed = refined(all.clone(), &Refinement { sway: share, ..Refinement::default() });
            let aside: Vec<Vec3> =
                swayed.positions.iter().zip(&all.positions).map(|(now, then)| now - then).collect();
            let length = 9.1;
            assert_eq!(aside[0], Vec3::ZERO, "the foot stays");
            let most = aside[..6].iter().map(|a| a.length()).fold(0.0, f32::max);
            assert!(most > 0.1 * share as f32 * length && most < 2.9 * share as f32 * length, "{most}");
            // The lateral's own swing is a share of its own length.
            for tip in [6, 7, 8] {
                assert!(aside[tip].distance(aside[2]) < 2.9 * share as f32 * 4.0);
            }
            assert_eq!(swayed.parents, all.parents);
        }
    }

    #[test]
    fn what_grows_elsewhere_changes_no_axis() {
        let all = straight_with_lateral();
        let wild = Refinement { sway: 0.1, gnarl: 1.0, ..Refinement::default() };
        let mut more = all.clone();
        // Another lateral, higher on the stem.
        more.positions.push(Vec3::new(1.0, 5.0, 0.0));
        more.parents.push(3);
        more.births.push(99);
        let (a, b) = (
            refined(all, &Refinement { gnarl: 0.0, ..wild.clone() }),
            refined(more, &Refinement { gnarl: 0.0, ..wild }),
        );
        assert_eq!(a.positions[..], b.positions[..a.positions.len()]);
    }

    #[test]
    fn gnarled_wood_moves_by_its_thickness_and_nothing_moves_for_nothing() {
        let all = random_tree(4, 300, 0.9);
        assert_eq!(refined(all.clone(), &Refinement { gnarl: 0.0, ..Refinement::default() }), all);
        let gnarled = refined(all.clone(), &Refinement { gnarl: 0.5, ..Refinement::default() });
        let size = Bounds::of(all.positions.iter().copied()).unwrap().size();
        let radius = size.y / 60.0;
        let most = farthest(&gnarled, &all);
        // Orders add up: a twig is carried by all that it hangs on.
        assert!(most > 0.2 * radius && most < 0.5 * 2.0 * 1.8 * radius * 12.0, "{most} of {radius}");
    }

    /// A bole of 4 m below a limb, and a twig at half of it that ends nothing.
    #[test]
    fn a_bole_is_straight_up_to_its_lowest_limb() {
        let stem = (0..=100).map(|i| Vec3::Y * (i as f32 * 0.1));
        let limb = (1..=60).map(|i| Vec3::new(i as f32 * 0.1, 4.0, 0.0));
        let twig = (1..=3).map(|i| Vec3::new(0.0, 2.0, i as f32 * 0.1));
        let mut parents: Vec<u32> = (0..=100_u32).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect();
        let mut tips = |from: u32, nodes: u32| {
            let first = parents.len() as u32;
            parents.extend((0..nodes).map(|i| if i == 0 { from } else { first + i - 1 }));
        };
        tips(40, 60);
        tips(20, 3);
        let mut places: Vec<Vec3> = stem.chain(limb).chain(twig).collect();
        // Twigs at their ends make limb and stem thick, the stem thicker.
        for (end, count) in [(100, 200), (160, 100)] {
            for i in 0..count {
                places.push(places[end] + Vec3::new(0.2, 0.0, i as f32 * 0.1));
                parents.push(end as u32);
            }
        }
        let all = tree(places, &parents);
        let with = |trunk_gnarl: f64| {
            refined(all.clone(), &Refinement { gnarl: 1.0, trunk_gnarl, ..Refinement::default() })
        };
        let aside = |moved: &Branching, nodes: std::ops::RangeInclusive<usize>| {
            nodes.map(|i| moved.positions[i].distance(all.positions[i])).fold(0.0, f32::max)
        };
        let [straight, half, usual] = [0.0, 0.5, 1.0].map(with);
        assert_eq!(aside(&straight, 0..=40), 0.0);
        assert!(aside(&straight, 41..=100) > 0.0 && aside(&straight, 101..=160) > 0.0);
        for i in 0..=40 {
            let [half, usual] = [&half, &usual].map(|moved| moved.positions[i] - all.positions[i]);
            assert!(half.abs_diff_eq(usual * 0.5, 1e-6), "{i}: {half} and {usual}");
        }
        assert!(aside(&usual, 1..=40) > 0.01);
    }

    fn farthest(moved: &Branching, from: &Branching) -> f32 {
        moved.positions.iter().zip(&from.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
    }

    /// Bends are as long and as high as the wood is thick, whatever decides that.
    #[test]
    fn gnarl_goes_by_the_thickness_that_the_wood_will_have() {
        let stem: Vec<Vec3> = (0..=2000).map(|i| Vec3::Y * (i as f32 * 0.01)).collect();
        let parents: Vec<u32> = (0..=2000_u32).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect();
        let all = tree(stem, &parents);
        let gnarled = |wood: Wood| {
            let refinement = Refinement { gnarl: 0.5, ..Refinement::default() };
            let room = Room { wood, ..Room::open(1 << 20) };
            refine(all.clone(), None, &mut [], &refinement, room, &Quiet).unwrap()
        };
        let usual = farthest(&gnarled(Wood::default()), &all);
        let [slender, thick] = [
            Wood { slenderness: 90.0, ..Wood::default() },
            Wood { base_radius_m: Some(1.0), ..Wood::default() },
        ]
        .map(|wood| farthest(&gnarled(wood), &all));
        // 20 m of stem: a third of a metre through, a third of that, two metres.
        for (most, radius_m) in [(usual, 20.0 / 60.0), (slender, 20.0 / 180.0), (thick, 1.0)] {
            assert!((0.3..=1.8).contains(&(most / radius_m)), "{most} m for {radius_m} m");
        }
    }

    #[test]
    fn the_help_has_the_measures_that_are_computed_with() {
        let details = |name: &str| {
            Refinement::FIELDS.iter().find(|row| row.knob.name == name).map_or("", |row| row.knob.details)
        };
        let limb = format!("at least {LIMB} of the trunk's thickness");
        assert!(details("trunk_gnarl").contains(&limb), "{limb}");
        assert_eq!(BEND_RADII, 9.0, "the help says nine");
        assert!(["gnarl", "trunk_gnarl"].iter().all(|name| details(name).contains("nine radii")));
    }
}
