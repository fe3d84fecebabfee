//! A year's shoot: its internodes, their directions, their buds.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

use crate::barriers::Barriers;
use crate::settings::of_order;
use crate::tree::{APEX, LATERAL, Node, Nodes, PARTS};
use crate::{Phyllotaxis, SelfOrganizing};

/// Shares are rounded to this part of an internode before they are compared with 1: the rounding of sums that
/// are equal in exact arithmetic then costs no internode.
const GRAIN: f64 = (1 << 20) as f64;

/// A bud that grows this year.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shoot {
    /// Where the bud is.
    pub node: u32,
    /// Which lateral bud; `None` for the apex.
    pub bud: Option<u32>,
    pub internodes: u32,
    /// Of each, in voxels.
    pub length: f64,
    /// Where less shade is, of length 1, or none.
    pub brighter: DVec3,
}

/// The internodes of a shoot that gets a share, and how long each is: ⌊v⌋ of v/⌊v⌋. `None` for a bud that stays
/// dormant.
pub(crate) fn internodes(share: f64, settings: &SelfOrganizing) -> Option<(u32, f64)> {
    let share = libm::round(share.min(settings.longest_shoot) * GRAIN) / GRAIN;
    let count = libm::floor(share);
    (count >= 1.0).then(|| (count as u32, share / count))
}

impl Shoot {
    /// The nodes of the shoot, the first on its bud's node, each on the one before; `first` is the number that the
    /// first will have. Fewer where it meets the ground or an obstacle that it cannot turn away from, or, in a
    /// branch, what grazes below the bole's height.
    pub fn grow(
        &self,
        nodes: &Nodes,
        first: u32,
        year: u32,
        bole: f64,
        settings: &SelfOrganizing,
        barriers: &Barriers,
    ) -> Vec<Node> {
        let mut last = self.bud_of(nodes, year, settings);
        let mut grown = Vec::with_capacity(self.internodes as usize);
        for i in 0..self.internodes {
            let is_end = i + 1 == self.internodes;
            let is_first = i == 0;
            let key = last.key.child(0);
            let wanted = self.direction(&last, settings);
            let Some(direction) = barriers.turned(last.place, wanted, self.length) else { break };
            let place = last.place + direction * self.length;
            let is_cut = last.order > 0 && place.y < bole;
            if place.y < 0.0 || is_cut || !place.is_finite() {
                break;
            }
            let turned = DQuat::from_rotation_arc(last.direction, direction) * last.side;
            let side = across(DQuat::from_axis_angle(direction, settings.turn()) * turned, direction);
            let flags = if is_first { last.flags } else { 0 };
            let apex = if is_end && !settings.sympodial { APEX } else { 0 };
            let parent = if is_first { self.node } else { first + i - 1 };
            let birth = year * PARTS + i * PARTS / self.internodes;
            let buds = settings.buds_of(last.order, is_end);
            last = Node { parent, place, direction, side, key, birth, flags: flags | apex, buds, ..last };
            grown.push(last);
        }
        grown
    }

    /// What the shoot continues: the place and the frame of its bud.
    fn bud_of(&self, nodes: &Nodes, year: u32, settings: &SelfOrganizing) -> Node {
        let node = self.node as usize;
        let (direction, side) = (nodes.directions[node].as_dvec3(), nodes.sides[node].as_dvec3());
        let axis = Node {
            parent: self.node,
            place: nodes.places[node].as_dvec3(),
            direction,
            side,
            key: nodes.keys[node],
            birth: 0,
            order: nodes.orders[node],
            flags: 0,
            buds: 0,
        };
        let Some(bud) = self.bud else { return axis };
        let around = TAU * f64::from(bud) / f64::from(settings.buds_at_node());
        let side = DQuat::from_axis_angle(direction, around) * side;
        let angle = of_order(&settings.branching_angle_deg, axis.order).to_radians();
        let (sin, cos) = libm::sincos(angle);
        let lateral = (direction * cos + side * sin).normalize_or(side);
        // The first buds of a lateral stand to the sides of the plane in which it leaves.
        let is_left = settings.phyllotaxis == Phyllotaxis::Spiral && settings.divergence_deg < 0.0;
        let handed = if is_left { -1.0 } else { 1.0 };
        let level = across(direction.cross(lateral) * handed, lateral);
        let waited = year - nodes.year(node);
        let is_stem = settings.reiteration > 0 && waited >= settings.reiteration;
        let order = if is_stem { 0 } else { axis.order + 1 };
        let key = axis.key.child(u64::from(bud) + 1);
        Node { direction: lateral, side: level, key, order, flags: LATERAL, ..axis }
    }

    /// `normalize(d + ξ·V + η·T)` (Pałubicki et al. 2009, section 4.4), T by order, and what is drawn.
    fn direction(&self, last: &Node, settings: &SelfOrganizing) -> DVec3 {
        let d = last.direction;
        let level = DVec3::new(d.x, 0.0, d.z).normalize_or_zero();
        let drawn = if settings.jitter > 0.0 { last.key.named("jitter").in_ball() } else { DVec3::ZERO };
        let turned = d
            + self.brighter * settings.light_pull
            + DVec3::Y * of_order(&settings.upward, last.order)
            + level * of_order(&settings.sideways, last.order)
            + drawn * settings.jitter;
        turned.normalize_or(d)
    }
}

/// The part of a vector that is across a direction, of length 1.
pub(crate) fn across(vector: DVec3, direction: DVec3) -> DVec3 {
    let across = vector - direction * direction.dot(vector);
    across.normalize_or(direction.any_orthonormal_vector())
}

impl SelfOrganizing {
    /// Lateral buds at a node that has any.
    fn buds_at_node(&self) -> u32 {
        match self.phyllotaxis {
            Phyllotaxis::Spiral | Phyllotaxis::Alternate => 1,
            Phyllotaxis::Opposite => 2,
            Phyllotaxis::Whorled => self.whorl,
        }
    }

    /// The dormant buds of a new node.
    fn buds_of(&self, order: u8, is_end: bool) -> u8 {
        if u32::from(order) >= self.max_order || (self.phyllotaxis == Phyllotaxis::Whorled && !is_end) {
            return 0;
        }
        u8::MAX >> (u8::BITS - self.buds_at_node().clamp(1, u8::BITS))
    }

    /// From the buds of a node to those of the next, about the shoot.
    fn turn(&self) -> f64 {
        match self.phyllotaxis {
            Phyllotaxis::Spiral => self.divergence_deg.to_radians(),
            Phyllotaxis::Alternate => PI,
            Phyllotaxis::Opposite => PI / 2.0,
            // Between the buds of the whorl before, where shoots have an odd number of internodes.
            Phyllotaxis::Whorled => PI / f64::from(self.whorl),
        }
    }
}
