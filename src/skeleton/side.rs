//! Wood that no generator grows: epicormic shoots out of old wood, and dead twigs.
//!
//! Both are thin laterals of nodes that are there, added when the tree has its radii: nothing that grew moves or gets
//! thicker for them. Places follow from the axis that bears them, so that another length moves none. They are born
//! with the tree's last step: a younger tree has none. Their axes come last and are told by their numbers
//! ([`Skeleton::kind_of`]), which levels of detail and edits keep.

use glam::Vec3;

use crate::{Axis, Forks, NO_PARENT, Skeleton};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::Monitor;
use linden_base::random::{GOLDEN_ANGLE, Key};

/// Shoots and dead twigs of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct SideWood {
    /// Burls with epicormic shoots on a metre of thick wood.
    pub epicormic_per_m: f64,
    /// Mean length of such a shoot, metres.
    pub epicormic_length_m: f64,
    /// Where they are, from and to a share of the tree's height.
    pub epicormic_range: Vec<f64>,
    /// Dead twigs on a metre of stem.
    pub dead_per_m: f64,
    /// Their mean length, metres.
    pub dead_length_m: f64,
    /// Where they are, from and to a share of the tree's height.
    pub dead_range: Vec<f64>,
    /// Limbs that leave their stem below this share of the tree's height are dead with all that they bear.
    pub dead_below: f64,
}

impl Default for SideWood {
    /// None of either.
    fn default() -> Self {
        Self {
            epicormic_per_m: 0.0,
            epicormic_length_m: 0.4,
            epicormic_range: vec![0.05, 0.5],
            dead_per_m: 0.0,
            dead_length_m: 0.7,
            dead_range: vec![0.05, 0.4],
            dead_below: 0.0,
        }
    }
}

/// What an axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// The generator or an edit made it.
    Grown,
    /// An epicormic shoot, or the burl that it stands on.
    Shoot,
    /// A dead twig: nothing grows on it.
    Dead,
}

/// Numbers of limbs that grew and are dead begin with this one …
const KILLED: u32 = 0b001 << KIND_SHIFT;
/// … those of shoots with this one …
const SHOOT: u32 = 0b010 << KIND_SHIFT;
/// … and those of dead twigs with this one; no tree has so many axes, and edits number theirs behind.
const DEAD: u32 = 0b011 << KIND_SHIFT;
const KIND_SHIFT: u32 = 29;

/// Laterals of this share of the thickest foot's radius bear shoots.
const LIMB: f32 = 0.2;
/// Burls on a metre of limb ÷ those of a metre of stem.
const LIMBS_SHOOT: f64 = 0.4;
/// Thinner wood than this share of the foot's has no burls.
const LEAST: f32 = 0.09;
/// More burls, or dead twigs, an axis does not have.
const MOST: u64 = 2000;
/// Shoots of a burl, at least and at most.
const SHOOTS: [f64; 2] = [3.0, 7.0];
/// Radius of a burl ÷ that of the wood that it stands on, and the largest, metres.
const BURL: (f32, f32) = (0.22, 0.07);
/// Dead twigs on a metre of the inner parts of limbs ÷ those of a metre of stem.
const ON_LIMBS: f64 = 0.5;
/// The inner part of a limb, as a share of its length.
const INNER: f32 = 0.45;
/// Side twigs of a dead twig at most.
const SIDE_TWIGS: f64 = 5.0;

impl Skeleton {
    /// What an axis is.
    pub fn kind_of(&self, axis: usize) -> AxisKind {
        match self.kind_bits(axis) {
            KILLED | DEAD => AxisKind::Dead,
            SHOOT => AxisKind::Shoot,
            _ => AxisKind::Grown,
        }
    }

    /// Whether an axis is a shoot or a dead twig that stands on the finished tree: neither grown nor made by an edit.
    pub(crate) fn is_side_wood(&self, axis: usize) -> bool {
        matches!(self.kind_bits(axis), SHOOT | DEAD)
    }

    /// Marks axes that grew, and all that they bear, as dead.
    pub(crate) fn kill(&mut self, dies: impl Fn(&Self, &Axis) -> bool) {
        if self.marks.numbers.is_empty() {
            self.marks.numbers = (0..self.axes.len() as u32).collect();
        }
        let axis_of = self.axis_of_nodes();
        let mut is_dead = vec![false; self.axes.len()];
        // What bears comes before what it bears.
        for axis in 0..self.axes.len() {
            let parent = self.axes[axis].parent;
            let is_borne_by_dead = parent != NO_PARENT && is_dead[axis_of[parent as usize] as usize];
            is_dead[axis] = is_borne_by_dead || dies(self, &self.axes[axis]);
            if is_dead[axis] {
                self.marks.numbers[axis] = KILLED | axis as u32;
            }
        }
    }

    fn kind_bits(&self, axis: usize) -> u32 {
        self.marks.numbers.get(axis).map_or(0, |number| number >> KIND_SHIFT << KIND_SHIFT)
    }
}

impl SideWood {
    /// Whether there is none.
    pub fn is_idle(&self) -> bool {
        self.epicormic_per_m == 0.0 && self.dead_per_m == 0.0 && self.dead_below == 0.0
    }

    /// Adds it to a tree, as long as that has no more than `most_nodes` nodes. Whether all of it was added.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn add_to(
        &self,
        tree: &mut Skeleton,
        key: Key,
        most_nodes: u64,
        monitor: &dyn Monitor,
    ) -> Result<bool, OverMemory> {
        if self.is_idle() || tree.axes.is_empty() {
            return Ok(true);
        }
        monitor.admit(
            "adding side shoots and dead twigs",
            self.bytes_for(tree),
            "lower epicormic or dead_twigs",
        )?;
        let mut site = Site::new(tree, most_nodes);
        if self.dead_below > 0.0 {
            site.kill_below(self.dead_below);
        }
        if self.epicormic_per_m > 0.0 {
            self.shoots(&mut site, key.named("epicormic"));
        }
        if self.dead_per_m > 0.0 {
            self.dead(&mut site, key.named("dead twigs"));
        }
        Ok(site.has_room)
    }

    /// Bytes that a tree takes with it, beside those that it has, at most.
    fn bytes_for(&self, tree: &Skeleton) -> u64 {
        let bearing = tree.axes.iter().filter(|axis| axis.order < 2);
        let metres: f64 = bearing
            .flat_map(|axis| tree.nodes_of(axis))
            .map(|&node| tree.segment_length(node as usize))
            .sum();
        // Nodes of a burl with all its shoots, of a twig with all its side twigs.
        let nodes = metres * (self.epicormic_per_m * 30.0 + self.dead_per_m * 15.0);
        tree.bytes() + bytes_of::<[u32; 12]>(nodes.min(1e12) as usize)
    }

    fn shoots(&self, site: &mut Site<'_>, key: Key) {
        let least_m = LIMB * site.foot_radius_m;
        for axis in 0..site.grown {
            let is_stem = site.tree.axes[axis].parent == NO_PARENT;
            let is_dead = site.tree.kind_of(axis) == AxisKind::Dead;
            if is_dead || !is_stem && site.radius_at_base(axis) < least_m {
                continue;
            }
            let key = key.child(axis as u64);
            let burl_m = LEAST * site.foot_radius_m;
            let thick = |place: &Place| place.radius_m >= burl_m;
            let per_m = self.epicormic_per_m * if is_stem { 1.0 } else { LIMBS_SHOOT };
            let places = site.places(axis, per_m, &self.epicormic_range, (0.0, 1.0), key);
            for (index, place) in places.into_iter().filter(|(_, place)| thick(place)) {
                self.burl(site, &place, key.child(index));
            }
        }
    }

    fn burl(&self, site: &mut Site<'_>, place: &Place, key: Key) {
        let azimuth = key.named("azimuth").between(0.0, std::f64::consts::TAU) as f32;
        // Old limbs sprout on their upper sides.
        let around = place.around(azimuth);
        let out = (around + Vec3::Y * 0.5).reject_from_normalized(place.tangent).normalize_or(around);
        let bark = place.center + out * place.radius_m;
        let burl_m = (place.radius_m * BURL.0).min(BURL.1) * key.named("burl").between(0.6, 1.1) as f32;
        let boss = bark + out * (0.35 * burl_m);
        site.axis(place, &[(bark - out * burl_m, burl_m), (boss, 0.75 * burl_m)], SHOOT);
        let count = key.named("count").between(SHOOTS[0], SHOOTS[1] + 1.0) as u64;
        for shoot in 0..count {
            let key = key.named("shoot").child(shoot);
            let spread = key.named("spread").in_ball().as_vec3() * 0.9;
            let way = (out + spread + Vec3::Y * 0.25).normalize_or(out);
            let length_m = (self.epicormic_length_m * key.named("length").between(0.4, 1.4)) as f32;
            // They turn to the light.
            let up = Vec3::Y * (0.35 * length_m);
            let from = boss + spread.reject_from_normalized(out) * burl_m;
            // Of one or a few years: thinner than what bears old wood.
            let base_m = (0.001 + 0.01 * length_m).min(1.4 * site.tip_m).min(0.4 * place.radius_m);
            let tip_m = 0.5 * base_m;
            let at = |t: f32| (from + way * (length_m * t) + up * (t * t), base_m + (tip_m - base_m) * t);
            let nodes = [(from, base_m), at(0.35), at(0.7), at(1.0)];
            site.axis(place, &nodes, SHOOT);
        }
    }

    fn dead(&self, site: &mut Site<'_>, key: Key) {
        for axis in 0..site.grown {
            let Axis { order, parent, .. } = site.tree.axes[axis];
            let key = key.child(axis as u64);
            let (per_m, part, size) = match order {
                0 => (self.dead_per_m, (0.0, 1.0), 1.0),
                // Inside of the crown the living limbs are bare, and hung with what died.
                1 if parent != NO_PARENT => (ON_LIMBS * self.dead_per_m, (0.08, INNER), 0.45),
                _ => continue,
            };
            let turn = key.named("turn").between(0.0, std::f64::consts::TAU);
            for (index, place) in site.places(axis, per_m, &self.dead_range, part, key) {
                let key = key.child(index);
                let azimuth = turn + GOLDEN_ANGLE * index as f64 + key.named("aside").between(-0.5, 0.5);
                let around = place.around(azimuth as f32);
                let out = if order == 0 { around } else { (around - Vec3::Y * 0.6).normalize_or(around) };
                self.dead_twig(site, &place, out, size, key);
            }
        }
    }

    fn dead_twig(&self, site: &mut Site<'_>, place: &Place, out: Vec3, size: f64, key: Key) {
        let length_m = (size * self.dead_length_m * key.named("length").between(0.35, 1.5)) as f32;
        let level = Vec3::new(out.x, 0.0, out.z).normalize_or(out);
        let way = (level + Vec3::Y * key.named("rise").between(-0.35, 0.25) as f32).normalize_or(out);
        let droop = Vec3::NEG_Y * (length_m * key.named("droop").between(0.15, 0.6) as f32);
        let aside = way.cross(Vec3::Y).normalize_or(place.tangent);
        let sway = aside * (length_m * key.named("sway").between(-0.2, 0.2) as f32);
        let base_m = (0.008 * length_m).max(site.tip_m).min(0.5 * place.radius_m);
        let tip_m = 0.4 * base_m;
        let from = place.center + out * (0.9 * place.radius_m);
        let at = |t: f32| from + way * (length_m * t) + (droop + sway) * (t * t);
        let radius = |t: f32| base_m + (tip_m - base_m) * t;
        let nodes = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| (at(t), radius(t)));
        let Some(first) = site.axis(place, &nodes, DEAD) else { return };
        let count = (SIDE_TWIGS * key.named("count").unit() * size.min(1.0)) as u64;
        for twig in 0..count {
            let key = key.named("side").child(twig);
            // Nodes of the twig itself, but for its first and last.
            let node = 1 + (key.named("node").unit() * 3.0) as u32;
            let t = 0.25 * node as f32;
            let side = if twig.is_multiple_of(2) { aside } else { -aside };
            let fan = key.named("fan").between(0.4, 1.0) as f32;
            let way =
                (way + side * fan - Vec3::Y * key.named("hang").between(0.1, 0.9) as f32).normalize_or(way);
            let reach_m = length_m * (1.15 - t) * key.named("reach").between(0.25, 0.55) as f32;
            let hang = Vec3::NEG_Y * (0.25 * reach_m);
            let (base_m, start) = (0.6 * radius(t), at(t));
            let host = Place { node: first + node, order: place.order + 1, ..*place };
            let along = [0.5, 1.0]
                .map(|s: f32| (start + way * (reach_m * s) + hang * (s * s), base_m * (1.0 - 0.5 * s)));
            site.axis(&host, &along, DEAD);
        }
    }
}

/// Where wood leaves an axis.
#[derive(Clone, Copy, Debug)]
struct Place {
    node: u32,
    center: Vec3,
    radius_m: f32,
    tangent: Vec3,
    /// Of the axis.
    order: u32,
}

impl Place {
    /// A unit vector square to the axis.
    fn around(&self, azimuth: f32) -> Vec3 {
        let side = if self.tangent.y.abs() > 0.99 { Vec3::X } else { self.tangent.cross(Vec3::Y) };
        let side =
            side.reject_from_normalized(self.tangent).normalize_or(self.tangent.any_orthonormal_vector());
        let (sin, cos) = libm::sincosf(azimuth);
        side * cos + self.tangent.cross(side) * sin
    }
}

/// A tree that wood is added to.
struct Site<'a> {
    tree: &'a mut Skeleton,
    /// How many axes it had.
    grown: usize,
    foot_radius_m: f32,
    floor_m: f32,
    height_m: f32,
    /// Mean radius of its tips.
    tip_m: f32,
    born: u32,
    most_nodes: u64,
    has_room: bool,
}

impl<'a> Site<'a> {
    fn new(tree: &'a mut Skeleton, most_nodes: u64) -> Self {
        let grown = tree.axes.len();
        // What is added is no measure of twigs.
        let tips = tree.grown_tips(&Forks::new(tree));
        tree.marks.tips = Some(tips);
        if tree.marks.numbers.is_empty() {
            tree.marks.numbers = (0..grown as u32).collect();
        }
        let heights = tree.positions.iter().map(|at| at.y);
        let (low, high) = heights.fold((f32::MAX, f32::MIN), |(low, high), y| (low.min(y), high.max(y)));
        let foot_radius_m = tree.foot_radius_m();
        let born = tree.births.iter().copied().max().unwrap_or(0);
        let tip_m = (tips.radii_m / f64::from(tips.count)) as f32;
        let (floor_m, height_m) = (low, high - low);
        Self { grown, foot_radius_m, floor_m, height_m, tip_m, born, most_nodes, has_room: true, tree }
    }

    /// Marks limbs that leave a stem below a share of the height, and all that they bear, as dead.
    fn kill_below(&mut self, share: f64) {
        let top_m = self.floor_m + share as f32 * self.height_m;
        let is_low = |tree: &Skeleton, axis: &Axis| {
            axis.order == 1 && axis.parent != NO_PARENT && tree.positions[axis.parent as usize].y < top_m
        };
        self.tree.kill(is_low);
    }

    fn radius_at_base(&self, axis: usize) -> f32 {
        let first = self.tree.nodes_of(&self.tree.axes[axis]).first();
        first.map_or(0.0, |&node| self.tree.radii[node as usize])
    }

    /// Places on an axis, so many a metre, with their numbers: at its inner nodes that are nearest, within a range of
    /// the tree's height and a part of the axis.
    fn places(
        &self,
        axis: usize,
        per_m: f64,
        range: &[f64],
        (from, to): (f32, f32),
        key: Key,
    ) -> Vec<(u64, Place)> {
        let share = |i: usize, usual: f64| range.get(i).copied().unwrap_or(usual) as f32;
        let heights = [share(0, 0.0), share(1, 1.0)].map(|share| self.floor_m + share * self.height_m);
        let Axis { order, .. } = self.tree.axes[axis];
        let nodes = self.tree.nodes_of(&self.tree.axes[axis]);
        let at = |i: usize| self.tree.positions[nodes[i] as usize];
        let mut along = vec![0.0_f32; nodes.len()];
        for i in 1..nodes.len() {
            along[i] = along[i - 1] + at(i - 1).distance(at(i));
        }
        let length_m = along.last().copied().unwrap_or(0.0);
        let mut places = Vec::new();
        for index in 0..MOST {
            let key = key.named("place").child(index);
            let metres = ((index as f64 + key.unit()) / per_m) as f32;
            if metres >= to * length_m || nodes.len() < 3 {
                break;
            }
            let above = along.partition_point(|&place| place < metres);
            let near = if above > 0 && metres - along[above - 1] < along[above.min(nodes.len() - 1)] - metres
            {
                above - 1
            } else {
                above
            };
            let near = near.clamp(1, nodes.len() - 2);
            let center = at(near);
            if metres < from * length_m || center.y < heights[0] || center.y > heights[1] {
                continue;
            }
            let tangent = (at(near + 1) - at(near - 1)).normalize_or(Vec3::Y);
            let (node, radius_m) = (nodes[near], self.tree.radii[nodes[near] as usize]);
            places.push((index, Place { node, center, radius_m, tangent, order }));
        }
        places
    }

    /// Adds an axis that leaves at a place; its first node.
    fn axis(&mut self, place: &Place, nodes: &[(Vec3, f32)], kind: u32) -> Option<u32> {
        let tree = &mut *self.tree;
        let first = tree.positions.len() as u32;
        if u64::from(first) + nodes.len() as u64 > self.most_nodes.min(1 << KIND_SHIFT) {
            self.has_room = false;
            return None;
        }
        let (index, mut parent) = (tree.axes.len() as u32, place.node);
        tree.axes.push(Axis {
            order: place.order + 1,
            parent: place.node,
            first: tree.axis_nodes.len() as u32,
            len: nodes.len() as u32,
        });
        tree.marks.numbers.push(kind | index);
        for &(position, radius) in nodes {
            let node = tree.positions.len() as u32;
            tree.positions.push(position);
            tree.radii.push(radius.max(f32::MIN_POSITIVE));
            tree.births.push(self.born);
            tree.parents.push(parent);
            tree.axis_nodes.push(node);
            parent = node;
        }
        Some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Branching, Wood};
    use linden_base::monitor::Quiet;

    /// A stem of 10 m with a limb of 4 m at half its height.
    fn tree() -> Skeleton {
        let stem = (0..=40).map(|i| Vec3::Y * (0.25 * i as f32));
        let limb = (1..=16).map(|i| Vec3::new(0.25 * i as f32, 5.0, 0.0));
        let parents = (0..41).map(|i: u32| i.checked_sub(1).unwrap_or(NO_PARENT));
        let limbs = (0..16).map(|i: u32| if i == 0 { 20 } else { 40 + i });
        let branching = Branching {
            positions: stem.chain(limb).collect(),
            parents: parents.chain(limbs).collect(),
            births: (0..57).collect(),
            radii: None,
            edges: None,
        };
        Skeleton::build(branching, &Wood { base_radius_m: Some(0.3), ..Wood::default() }).unwrap()
    }

    fn with(side: &SideWood) -> Skeleton {
        let mut grown = tree();
        assert!(side.add_to(&mut grown, Key::new(3), 100_000, &Quiet).unwrap());
        grown
    }

    fn shooting(per_m: f64) -> SideWood {
        SideWood { epicormic_per_m: per_m, epicormic_range: vec![0.2, 0.8], ..SideWood::default() }
    }

    fn dying(per_m: f64) -> SideWood {
        SideWood { dead_per_m: per_m, dead_range: vec![0.1, 0.6], ..SideWood::default() }
    }

    #[test]
    fn what_grew_stays_and_what_is_added_is_a_tree() {
        let grown = tree();
        assert_eq!(with(&SideWood::default()), grown);
        for side in [shooting(2.0), dying(5.0)] {
            let more = with(&side);
            let [nodes, axes] = [grown.positions.len(), grown.axes.len()];
            assert!(more.axes.len() > axes + 20);
            assert_eq!(more.positions[..nodes], grown.positions);
            assert_eq!((&more.radii[..nodes], &more.axes[..axes]), (&grown.radii[..], &grown.axes[..]));
            assert!((0..axes).all(|axis| more.kind_of(axis) == AxisKind::Grown));
            assert_eq!(more.axis_nodes.len(), more.positions.len());
            for (index, axis) in more.axes.iter().enumerate().skip(axes) {
                assert_ne!(more.kind_of(index), AxisKind::Grown);
                let first = more.nodes_of(axis)[0];
                assert!(more.parents[first as usize] == axis.parent && axis.parent < first);
                let bearer = more.axes.iter().find(|bearer| more.nodes_of(bearer).contains(&axis.parent));
                assert_eq!(axis.order, bearer.unwrap().order + 1);
                // Thinner than what bears it.
                assert!(more.radii[first as usize] < more.radii[axis.parent as usize]);
            }
            // A younger tree has none of it.
            assert_eq!(more.until(55, &Wood::default(), Key::new(0)).axes.len(), axes);
        }
    }

    #[test]
    fn they_are_as_many_as_asked_for_where_they_are_asked_for() {
        for per_m in [0.5, 2.0, 6.0] {
            let more = with(&dying(per_m));
            let on_stem: Vec<f32> = more
                .axes
                .iter()
                .enumerate()
                .filter(|(index, axis)| more.kind_of(*index) == AxisKind::Dead && axis.parent < 41)
                .map(|(_, axis)| more.positions[axis.parent as usize].y)
                .collect();
            let expected = per_m * 5.0;
            assert!(
                (on_stem.len() as f64 - expected).abs() <= 2.0 + 0.3 * per_m,
                "{} for {expected}",
                on_stem.len()
            );
            assert!(on_stem.iter().all(|y| (0.99..=6.01).contains(y)));
            let on_limb = more.axes.iter().any(|axis| (41..57).contains(&axis.parent));
            assert!(on_limb || per_m < 4.0, "limbs have some");
        }
        let burls = |per_m: f64| {
            let more = with(&shooting(per_m));
            let thick = more
                .axes
                .iter()
                .enumerate()
                .filter(|(index, axis)| more.kind_of(*index) == AxisKind::Shoot && axis.len == 2);
            thick.count() as f64
        };
        // Six metres of stem, and of the limb as much as is thick.
        assert!((5.0..=8.0).contains(&burls(1.0)), "{}", burls(1.0));
        assert!(burls(3.0) > 2.5 * burls(1.0));
    }

    #[test]
    fn dead_twigs_hang_and_shoots_rise() {
        let rise = |side: &SideWood| {
            let more = with(side);
            let ends = more
                .axes
                .iter()
                .enumerate()
                .filter(|(index, axis)| more.kind_of(*index) != AxisKind::Grown && axis.len > 2);
            let rises: Vec<f32> = ends
                .map(|(_, axis)| {
                    let nodes = more.nodes_of(axis);
                    let [from, to] =
                        [nodes[0], nodes[nodes.len() - 1]].map(|node| more.positions[node as usize]);
                    (to.y - from.y) / from.distance(to)
                })
                .collect();
            rises.iter().sum::<f32>() / rises.len() as f32
        };
        assert!(rise(&dying(6.0)) < -0.15 && rise(&shooting(2.0)) > 0.3);
    }

    #[test]
    fn low_limbs_die_with_what_they_bear_and_nothing_else() {
        let kinds = |below: f64| {
            let dead = with(&SideWood { dead_below: below, ..SideWood::default() });
            assert_eq!(
                (&dead.positions, &dead.radii, &dead.axes),
                (&tree().positions, &tree().radii, &tree().axes)
            );
            [0, 1].map(|axis| dead.kind_of(axis))
        };
        // Dead wood does not sprout.
        let sprouts = |below: f64| {
            let more = with(&SideWood { dead_below: below, ..shooting(6.0) });
            more.axes.iter().any(|axis| (41..57).contains(&axis.parent))
        };
        assert!(sprouts(0.45) && !sprouts(0.55));
        // The limb leaves at half of the height.
        assert_eq!(kinds(0.45), [AxisKind::Grown; 2]);
        assert_eq!(kinds(0.55), [AxisKind::Grown, AxisKind::Dead]);
    }

    #[test]
    fn another_length_moves_none_and_a_limit_is_kept() {
        let feet = |length_m: f64| {
            let more = with(&SideWood { dead_length_m: length_m, ..dying(4.0) });
            more.axes.iter().map(|axis| axis.parent).filter(|&parent| parent < 57).collect::<Vec<_>>()
        };
        assert_eq!(feet(0.4), feet(1.5));
        let mut full = tree();
        assert!(!dying(50.0).add_to(&mut full, Key::new(1), 200, &Quiet).unwrap());
        assert!(full.positions.len() <= 200);
    }
}
