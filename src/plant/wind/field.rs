//! How each axis of a tree swings, and with it every place on it.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use super::rig::Rig;
use super::sway::MOST;
use super::{AxisPivot, Binding, Blow, Blown, BoneSettings, Motion, PartWind, Sway, Target, Wind};
use crate::Specimen;
use crate::foliage::{Look, Shaper};
use crate::settings::WindSettings;
use crate::surface::Amount;
use linden_base::memory::bytes_of;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_skeleton::organs::{Organs, PROTOTYPES};
use linden_skeleton::{NO_PARENT, Skeleton};

/// How far the top of a stem goes in a storm, as a share of its height.
const STEM_SWING: f32 = 0.05;
/// How far the tip of the most flexible branch goes, as a share of its length.
const BRANCH_SWING: f32 = 0.22;
/// How far the tip of a leaf goes, as a share of its length.
pub(super) const LEAF_SWING: f32 = 0.35;
/// A branch of this share of its stem's radius is half as flexible as a twig.
const HALF_FLEXIBLE: f32 = 0.15;
/// The share of the swing that goes up and down, so that branches along the wind swing too.
const HEAVE: f32 = 0.5;
/// Gusts run over the tree: metres per period of the branches.
const WAVE_M: f32 = 9.0;
/// How much of a period the phases of neighbours differ by chance.
const CHANCE: f32 = 0.45;
/// Axes or leaves between two looks at the monitor.
pub(super) const PER_CHECK: usize = 1024;

/// How everything on a tree swings.
pub(crate) struct Field<'a> {
    pub(super) whole: &'a Skeleton,
    pub(super) axes: Vec<AxisSwing>,
    /// The axis of each node.
    pub(super) axis_of: Vec<u32>,
    key: Key,
    direction: Vec3,
    pub(super) strength: f32,
    /// For attributes.
    hierarchy: Option<Arc<[AxisPivot]>>,
    /// `None`: no loop of morph targets.
    sway: Option<Arc<Sway>>,
    /// The joints in place of all else.
    rig: Option<Rig>,
}

/// How an axis swings.
#[derive(Clone, Copy)]
pub(super) struct AxisSwing {
    level: u32,
    pub(super) pivot: Vec3,
    /// What is nearer to the pivot does not move by itself: the stem's base, the inside of the parent.
    pub(super) still_m: f32,
    /// How far its farthest node is from the pivot.
    reach_m: f32,
    /// 0 to 1.
    flexible: f32,
    /// 0 to 1 of a period.
    phase: f32,
    /// Where its tip goes, metres.
    tip: Vec3,
    /// Where its pivot goes: with the stem, with the sine and with the cosine of the branches.
    carried: [Vec3; 3],
}

impl AxisSwing {
    /// How much a place swings about the pivot: the bend of a beam that is held at one end.
    pub(super) fn share(&self, place: Vec3) -> f32 {
        let out = place.distance(self.pivot) - self.still_m;
        let share = out.max(0.0) / (self.reach_m - self.still_m).max(1e-6);
        (share * share).min(1.5)
    }

    /// How far its tip goes in a storm from any side, metres.
    pub(super) fn way(&self) -> f32 {
        self.reach_m * if self.level == 0 { STEM_SWING } else { BRANCH_SWING * self.flexible }
    }

    /// Where a place goes: with the stem, with the sine and with the cosine of the branches.
    pub(super) fn moved(&self, place: Vec3) -> [Vec3; 3] {
        let swing = self.tip * self.share(place);
        if self.level == 0 {
            return [swing, Vec3::ZERO, Vec3::ZERO];
        }
        let (sin, cos) = libm::sincosf(TAU * self.phase);
        let [stem, with_sine, with_cosine] = self.carried;
        [stem, with_sine + swing * cos, with_cosine + swing * sin]
    }
}

impl<'a> Field<'a> {
    /// The field of wind round a tree, if there is wind.
    pub fn of(specimen: &Specimen<'_>, whole: &'a Skeleton) -> Option<Self> {
        let WindSettings { wind, blow, bones } = &specimen.dressing.wind;
        let key = specimen.key().named("wind");
        let field = || {
            let field = Self::new(whole, blow, *wind, key);
            match wind {
                Wind::Bones => field.with_bones(blow, *bones),
                _ => Self { hierarchy: Some(field.hierarchy()), ..field },
            }
        };
        (*wind != Wind::Off).then(field)
    }

    /// Without bones.
    pub(super) fn new(whole: &'a Skeleton, blow: &Blow, wind: Wind, key: Key) -> Self {
        let (sin, cos) = libm::sincos(blow.direction_deg.to_radians());
        let mut field = Self {
            whole,
            axes: Vec::with_capacity(whole.axes.len()),
            axis_of: vec![0; whole.positions.len()],
            key,
            direction: Vec3::new(cos as f32, 0.0, -sin as f32),
            strength: blow.strength as f32,
            hierarchy: None,
            sway: (wind == Wind::Sway).then(|| Arc::new(Sway::new(blow))),
            rig: None,
        };
        let thickest_m = whole.radii.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        for index in 0..whole.axes.len() {
            let swing = field.axis(index, thickest_m);
            field.axes.push(swing);
        }
        field
    }

    /// The same by joints that turn.
    fn with_bones(mut self, blow: &Blow, bones: BoneSettings) -> Self {
        self.rig = Some(Rig::new(&self, bones, &Arc::new(Sway::new(blow))));
        self
    }

    /// Its parent's swing is known.
    fn axis(&mut self, index: usize, thickest_m: f32) -> AxisSwing {
        let (axis, whole) = (&self.whole.axes[index], self.whole);
        let nodes = whole.nodes_of(axis);
        for &node in nodes {
            self.axis_of[node as usize] = index as u32;
        }
        let foot = if axis.parent == NO_PARENT { nodes.first().copied() } else { Some(axis.parent) };
        let foot = foot.unwrap_or_default() as usize;
        let pivot = whole.positions[foot];
        let mut places = nodes.iter().map(|&node| whole.positions[node as usize]);
        let reach_m = places.clone().map(|place| place.distance(pivot)).fold(0.0, f32::max);
        if axis.parent == NO_PARENT {
            return AxisSwing {
                level: 0,
                pivot,
                // Root flares and buttresses are wider than the node says.
                still_m: STILL_RADII * whole.radii[foot],
                reach_m: reach_m.max(2.0 * STILL_RADII * whole.radii[foot]),
                flexible: 1.0,
                phase: 0.0,
                tip: self.direction * (STEM_SWING * reach_m * self.strength),
                carried: [Vec3::ZERO; 3],
            };
        }
        let base_m = nodes.first().map_or(0.0, |&node| whole.radii[node as usize]);
        let flexible = 1.0 / (1.0 + base_m / (HALF_FLEXIBLE * thickest_m));
        let along = places.next_back().map_or(Vec3::Y, |tip| tip - pivot).normalize_or(Vec3::Y);
        let across = (self.direction + Vec3::Y * HEAVE).reject_from_normalized(along);
        AxisSwing {
            level: axis.order,
            pivot,
            still_m: whole.radii[foot].min(0.5 * reach_m),
            reach_m,
            flexible,
            phase: self.phase(pivot, along),
            tip: across.normalize_or_zero() * (BRANCH_SWING * flexible * reach_m * self.strength),
            carried: self.axes[self.axis_of[foot] as usize].moved(pivot),
        }
    }

    /// The wave that runs with the wind, and a little chance of the place and direction.
    pub(super) fn phase(&self, place: Vec3, heading: Vec3) -> f32 {
        let bits = |key: Key, x: f32| key.child(u64::from(x.to_bits()));
        let numbers = place.to_array().into_iter().chain(heading.to_array());
        let chance = numbers.fold(self.key, bits).unit() as f32;
        let phase = CHANCE * chance - place.dot(self.direction) / WAVE_M;
        phase - phase.floor()
    }

    /// The axis of a node.
    fn axis_at(&self, node: u32) -> usize {
        self.axis_of[node as usize] as usize
    }

    /// How a node swings, and a leaf's foot with it.
    pub(super) fn of_node(&self, node: u32) -> &AxisSwing {
        &self.axes[self.axis_at(node)]
    }

    /// The wind of a part with `vertices` vertices that move in these ways, empty.
    fn empty(&self, vertices: usize, motions: &[Motion]) -> PartWind {
        let [attributes, bindings] = if self.rig.is_some() { [0, vertices] } else { [vertices, 0] };
        PartWind {
            motions: Vec::with_capacity(attributes),
            pivots: Vec::with_capacity(attributes),
            axes: Vec::with_capacity(attributes),
            hierarchy: self.hierarchy.clone(),
            targets: self.targets(vertices, motions),
            sway: self.sway.clone(),
            bindings: Vec::with_capacity(bindings),
            bones: self.rig.as_ref().map(|rig| Arc::clone(&rig.bones)),
        }
    }

    fn targets(&self, vertices: usize, motions: &[Motion]) -> Vec<Target> {
        let motions = if self.sway.is_some() { motions } else { &[] };
        motions.iter().map(|&motion| Target { motion, offsets: Vec::with_capacity(vertices) }).collect()
    }
}

impl Field<'_> {
    /// Bytes of what a part of `vertices` vertices is given.
    pub fn bytes_for(&self, vertices: usize) -> u64 {
        if let Some(rig) = &self.rig {
            return bytes_of::<Binding>(vertices) + rig.bones.bytes();
        }
        let targets = if self.sway.is_some() { Motion::ALL.len() } else { 0 };
        let axes = self.hierarchy.as_ref().map_or(0, |axes| bytes_of::<AxisPivot>(axes.len()));
        bytes_of::<([f32; 8], u32)>(vertices) + axes + bytes_of::<Vec3>(vertices * targets)
    }
}

/// From amplitudes to targets: all motions at their begin, then each from one end to the other.
fn ends<const N: usize>(moved: [Vec3; N]) -> impl Iterator<Item = Vec3> {
    let begin = moved.iter().copied().sum::<Vec3>() * -MOST;
    std::iter::once(begin).chain(moved.into_iter().map(|motion| motion * (2.0 * MOST)))
}

/// Around a stem's foot nothing moves, in radii of it.
const STILL_RADII: f32 = 2.5;

impl Blown<'_> {
    /// How swept wood swings. `tubes` says how many vertices each of the level's axes has; the first
    /// axis' come first.
    pub fn wood(&self, mesh: &Mesh, tubes: &[Amount], monitor: &dyn Monitor) -> Result<PartWind, Cancelled> {
        let count = mesh.positions.len();
        let mut wind = self.field.empty(count, &Motion::ALL[..4]);
        for (index, tube) in tubes.iter().enumerate() {
            if index.is_multiple_of(PER_CHECK) {
                monitor.check()?;
            }
            let axis = self.axes.map_or(index, |axes| axes[index] as usize);
            let swing = &self.field.axes[axis];
            let first = wind.motions.len().max(wind.bindings.len());
            let (roots_from, last) = (first + tube.vertices - tube.roots[0], first + tube.vertices);
            if let Some(rig) = &self.field.rig {
                let trunk = &mesh.positions[first..roots_from.min(count)];
                wind.bindings.extend(trunk.iter().map(|&place| rig.bind(axis, place)));
                wind.bindings.resize(last.min(count), Binding::STILL);
                continue;
            }
            for &place in &mesh.positions[first..roots_from.min(count)] {
                let sway = swing.share(place).min(1.0) * swing.flexible;
                wind.motions.push([swing.level as f32, swing.phase, sway, 0.0]);
                wind.axes.push(axis as u32);
                wind.pivots.push(swing.pivot.extend(place.distance(swing.pivot)).to_array());
                for (target, moved) in wind.targets.iter_mut().zip(ends(swing.moved(place))) {
                    target.offsets.push(moved);
                }
            }
            for &place in &mesh.positions[roots_from.min(count)..last.min(count)] {
                wind.motions.push([swing.level as f32, swing.phase, 0.0, 0.0]);
                wind.axes.push(axis as u32);
                wind.pivots.push(swing.pivot.extend(place.distance(swing.pivot)).to_array());
                wind.targets.iter_mut().for_each(|target| target.offsets.push(Vec3::ZERO));
            }
        }
        Ok(wind)
    }

    /// How the organs of one look swing, in the order in which foliage meshes have them. There are
    /// `colors` colours.
    pub fn leaves(
        &self,
        mesh: &Mesh,
        organs: &Organs,
        look: Look,
        colors: usize,
        monitor: &dyn Monitor,
    ) -> Result<PartWind, Cancelled> {
        let count = mesh.positions.len();
        let mut wind = self.field.empty(count, &Motion::ALL);
        let polygons = organs.polygons.ends.len();
        let (mut shaper, mut scratch) = (Shaper::default(), Mesh::default());
        for organ in 0..organs.len() {
            if organ.is_multiple_of(PER_CHECK) {
                monitor.check()?;
            }
            let hanging = organs.growth(organ);
            let color = Look::Color((hanging.color as usize).min(colors.saturating_sub(1)));
            let leaf = match organ.checked_sub(polygons) {
                None if color == look => {
                    scratch.positions.clear();
                    scratch.triangles.clear();
                    scratch.normals.clear();
                    scratch.uvs.clear();
                    shaper.add(organs, organ, &mut scratch);
                    let corners = organs.corners_of(organ);
                    let foot = corners.first().copied().unwrap_or_default();
                    let size_m = corners.iter().map(|p| p.distance(foot)).fold(0.0, f32::max);
                    Leaf { foot, up: organs.polygons.ups[organ], size_m, vertices: scratch.positions.len() }
                }
                Some(placed) => {
                    let all_placed = &organs.placed;
                    let kind = organs.shape(placed).map(|shape| Look::Kind(usize::from(shape.kind)));
                    if kind.unwrap_or(color) != look {
                        continue;
                    }
                    debug_assert!(
                        kind.is_some() || usize::from(all_placed.prototypes[placed]) < PROTOTYPES.len()
                    );
                    Leaf {
                        foot: all_placed.positions[placed],
                        up: all_placed.ups[placed],
                        size_m: all_placed.sizes_m[placed],
                        vertices: organs.mesh(placed).positions.len(),
                    }
                }
                None => continue,
            };
            self.leaf(&leaf, hanging.node, mesh, &mut wind);
        }
        Ok(wind)
    }

    fn leaf(&self, leaf: &Leaf, node: u32, mesh: &Mesh, wind: &mut PartWind) {
        if let Some(rig) = &self.field.rig {
            // It keeps its shape and goes as its foot does.
            let binding = rig.bind(self.field.axis_at(node), leaf.foot);
            let last = (wind.bindings.len() + leaf.vertices).min(mesh.positions.len());
            wind.bindings.resize(last, binding);
            return;
        }
        let (twig, axis) = (self.field.of_node(node), self.field.axis_at(node) as u32);
        let carried = twig.moved(leaf.foot);
        let sway = twig.share(leaf.foot).min(1.0) * twig.flexible;
        let phase = self.field.phase(leaf.foot, leaf.up);
        let (sin, cos) = libm::sincosf(TAU * phase);
        let flap = leaf.up * (LEAF_SWING * leaf.size_m * self.field.strength);
        let first = wind.motions.len();
        let last = (first + leaf.vertices).min(mesh.positions.len());
        for &place in &mesh.positions[first..last] {
            let distance_m = place.distance(leaf.foot);
            let flutter = (distance_m / leaf.size_m.max(1e-6)).min(1.0);
            wind.motions.push([twig.level as f32 + 1.0, phase, sway, flutter]);
            wind.pivots.push(leaf.foot.extend(distance_m).to_array());
            wind.axes.push(axis);
            let swing = flap * flutter;
            let [stem, with_sine, with_cosine] = carried;
            let moved = [stem, with_sine, with_cosine, swing * cos, swing * sin];
            for (target, moved) in wind.targets.iter_mut().zip(ends(moved)) {
                target.offsets.push(moved);
            }
        }
    }
}

/// A leaf as wind sees it.
struct Leaf {
    foot: Vec3,
    up: Vec3,
    size_m: f32,
    vertices: usize,
}
