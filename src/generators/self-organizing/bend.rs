//! Branches bend under the weight of wood and leaves.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use linden_base::memory::OverMemory;
use linden_base::monitor::Monitor;

use crate::SelfOrganizing;
use crate::grow::Growth;
use crate::shadow::Change;
use crate::tree::{DEAD, Nodes};

/// Young's modulus of green wood, Pa; 5e9 to 12e9 are measured.
const STIFFNESS: f64 = 8e9;
/// Of green wood, kg/m³: 700 to 1100.
const DENSITY: f64 = 900.0;
/// m/s².
const GRAVITY: f64 = 9.81;
/// How much more reaction wood strains as it matures than the wood opposite to it: 0.001 to 0.004 are measured.
const STRAIN: f64 = 2e-3;
/// The most that an internode bends in a year, radians.
const MOST: f64 = 0.3;
/// How far down an internode points at least that such a bend takes past the vertical, a little less than cos [`MOST`].
const STEEP: f32 = 0.95;
/// Pipes of which diameters are kept: nearly all internodes have fewer.
const KEPT: u32 = 256;
/// Changes of light that are made at a time.
const BATCH: usize = 1 << 17;

/// What bending knows of a node, in one list, for large trees need their memory. Until the node is reached, from the tips
/// down, it is what hangs on it: weight in newtons, and weight times place, x and z, in newton metres. Then it is
/// how much the internode turns where it begins, against the one below, and at last, from the feet up, in all.
type Slot = [f64; 4];

impl Growth<'_> {
    /// Bends all internodes by what this year added to their loads.
    ///
    /// The year's growth of the moment M about an internode bends it by the beam's `Δκ = ΔM / (E·I)`,
    /// I = π·d⁴/64, with the wood that it has now; new wood is laid on the bent shape and keeps it, so that nothing
    /// springs back when loads fall. Stems stay upright, as reaction wood keeps them. Limbs arch; shoots that turn up as
    /// they grow make their tips rise, and reaction wood rights them ([`righted`]). Nodes that come to another voxel
    /// take their shade along.
    pub fn bend(&mut self, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let pipes = self.nodes.pipes();
        let mut turns = self.turns(&pipes);
        let before = self.nodes.places.clone();
        let mut changes = Vec::new();
        for node in 0..self.nodes.len() {
            if changes.len() >= BATCH {
                self.light.change(&mut changes, monitor)?;
                changes.clear();
            }
            let nodes = &mut self.nodes;
            if nodes.is_foot(node) {
                continue;
            }
            let parent = nodes.parents[node] as usize;
            let (old, parent_old) = (before[node].as_dvec3(), before[parent].as_dvec3());
            let all = (DQuat::from_array(turns[parent]) * DQuat::from_array(turns[node])).normalize();
            let all = righted(nodes, node, pipes[node], all, self.settings);
            turns[node] = all.to_array();
            if all == DQuat::IDENTITY && nodes.places[parent] == before[parent] {
                continue;
            }
            let mut place = nodes.places[parent].as_dvec3() + all * (old - parent_old);
            // What reaches the ground lies on it.
            place.y = place.y.max(0.0);
            // So does what reaches an obstacle.
            if self.barriers.bar(place) {
                place = old;
            }
            let from = nodes.voxel(node);
            nodes.places[node] = place.as_vec3();
            nodes.directions[node] = (all * nodes.directions[node].as_dvec3()).normalize().as_vec3();
            nodes.sides[node] = (all * nodes.sides[node].as_dvec3()).normalize().as_vec3();
            let to = nodes.voxel(node);
            if to != from && !nodes.is(node, DEAD) {
                changes.push(Change { voxel: from, is_gone: true });
                changes.push(Change { voxel: to, is_gone: false });
            }
        }
        self.light.change(&mut changes, monitor)
    }

    /// How much each internode turns where it begins, against the one below.
    fn turns(&mut self, pipes: &[u32]) -> Vec<Slot> {
        let settings = self.settings;
        let nodes = &mut self.nodes;
        let kept: Vec<f64> = (0..KEPT).map(|pipes| settings.diameter_m(pipes)).collect();
        let diameter_m =
            |pipes: u32| kept.get(pipes as usize).copied().unwrap_or_else(|| settings.diameter_m(pipes));
        let mut slots = vec![Slot::default(); nodes.len()];
        for node in (0..nodes.len()).rev() {
            let [mut weight, mut x, mut z, _] = slots[node];
            slots[node] = DQuat::IDENTITY.to_array();
            if nodes.is_foot(node) {
                continue;
            }
            let parent = nodes.parents[node] as usize;
            let scale = settings.internode_m;
            let (start, end) =
                (nodes.places[parent].as_dvec3() * scale, nodes.places[node].as_dvec3() * scale);
            let diameter = diameter_m(pipes[node]);
            let length = (end - start).length();
            let wood = GRAVITY * DENSITY * PI / 4.0 * diameter * diameter * length;
            let is_dead = nodes.is(node, DEAD);
            let leaves = if is_dead { 0.0 } else { GRAVITY * settings.leaf_weight_kg };
            let middle = (start + end) / 2.0;
            weight += wood + leaves;
            x += wood * middle.x + leaves * end.x;
            z += wood * middle.z + leaves * end.z;
            let below = &mut slots[parent];
            below[0] += weight;
            below[1] += x;
            below[2] += z;
            // Of all beyond about the internode's start: its arm is level.
            let arm = DVec3::new(x - weight * start.x, 0.0, z - weight * start.z);
            let moment = arm.length();
            let more = moment - f64::from(nodes.moments[node]);
            if more <= 0.0 || nodes.orders[node] == 0 {
                continue;
            }
            nodes.moments[node] = moment as f32;
            let square = diameter * diameter;
            let inertia = PI / 64.0 * square * square;
            let angle = (settings.sag * length * more / (STIFFNESS * inertia)).min(MOST);
            let turn = DQuat::from_axis_angle(DVec3::Y.cross(arm / moment), angle);
            slots[node] = until_it_hangs(turn, nodes.directions[node].y).to_array();
        }
        slots
    }
}

/// No internode turns past the direction in which it hangs; how far it rises is the height of its direction.
fn until_it_hangs(turn: DQuat, rise: f32) -> DQuat {
    // Most are far from it: an acos each would be a tenth of all growth.
    if turn == DQuat::IDENTITY || -rise < STEEP {
        return turn;
    }
    let hanging = libm::acos(f64::from(-rise).clamp(-1.0, 1.0));
    let (axis, angle) = turn.to_axis_angle();
    if angle > hanging { DQuat::from_axis_angle(axis, hanging) } else { turn }
}

/// How much an internode is turned in all, where it is turned by `all` before it rights itself.
///
/// Reaction wood rights it: what a year lays around a radius shrinks, or swells, by [`STRAIN`] more on one side than on
/// the other, evenly between, and so bends it by `dκ = 2·Δε·dR/R²` (the ring's moment by its stiffness; after Fournier
/// et al. 1994, *Tree biomechanics*). There is as much of it as the internode is off the inclination A₀ at which it grew,
/// sin(A − A₀) (Bastien et al. 2013, *Unifying model of shoot gravitropism*, PNAS 110), once it stands on what is below.
fn righted(nodes: &mut Nodes, node: usize, pipes: u32, all: DQuat, settings: &SelfOrganizing) -> DQuat {
    let before = std::mem::replace(&mut nodes.pipes_before[node], pipes);
    let is_new = before == 0;
    if settings.righting == 0.0
        || nodes.orders[node] == 0
        || nodes.is(node, DEAD)
        || is_new
        || before >= pipes
    {
        return all;
    }
    let direction = all * nodes.directions[node].as_dvec3();
    let inclination = |rise: f64| libm::acos(rise.clamp(-1.0, 1.0));
    let away = inclination(direction.y) - inclination(nodes.rises[node].into());
    // Upright or hanging, it has no side to turn to.
    let Some(axis) = direction.cross(DVec3::Y).try_normalize().filter(|_| away != 0.0) else { return all };
    let parent = nodes.parents[node] as usize;
    let length_m = f64::from(nodes.places[node].distance(nodes.places[parent])) * settings.internode_m;
    let [was, is] = [before, pipes].map(|pipes| 2.0 / settings.diameter_m(pipes));
    let most = settings.righting * 2.0 * STRAIN * length_m * (was - is);
    let back = (most * libm::sin(away)).clamp(-away.abs(), away.abs());
    (DQuat::from_axis_angle(axis, back) * all).normalize()
}

impl SelfOrganizing {
    /// The pipe model: `d^n = Σ d_tip^n`.
    pub(crate) fn diameter_m(&self, pipes: u32) -> f64 {
        self.twig_diameter_m * libm::pow(f64::from(pipes), 1.0 / self.pipe_exponent)
    }
}
