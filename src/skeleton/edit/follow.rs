//! Organs that a generator placed, after the wood that bears them was edited.

use glam::{DQuat, DVec3, Vec3};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::Monitor;

use super::workpiece::NodeMove;
use crate::organs::{OrganOrigins, Organs, PlacedOrgans, Polygons};
use crate::{NO_PARENT, Skeleton};

/// The organs on the nodes of the edited tree, each where its node took it: those of copied wood are copied, those of
/// wood that went are gone.
pub(super) fn follow(
    organs: &Organs,
    grown: &Skeleton,
    moves: &[NodeMove],
    monitor: &dyn Monitor,
) -> Result<Organs, OverMemory> {
    if organs.is_empty() {
        return Ok(organs.clone());
    }
    let polygons = ByNode::new(&organs.polygons.growth, grown.positions.len());
    let placed = ByNode::new(&organs.placed.growth, grown.positions.len());
    let borne = |by: &ByNode| -> usize { moves.iter().map(|to| by.of(to.bears).len()).sum() };
    let (shapes, organ_count) = (borne(&polygons) as u64, borne(&placed) as u64);
    // As much again of polygons, with as many corners as the largest has; and of organs.
    let corners = (0..organs.polygons.ends.len()).map(|i| organs.corners_of(i).len()).max().unwrap_or(0);
    let bytes = shapes * (bytes_of::<Vec3>(corners + 2) + bytes_of::<[u32; 4]>(1))
        + organ_count * PlacedOrgans::BYTES_EACH
        + 2 * bytes_of::<u32>(grown.positions.len());
    monitor.admit(
        "editing what hangs on the wood",
        organs.bytes() + bytes,
        "take edits out of the recipe",
    )?;
    let Organs { need_form, .. } = *organs;
    let mut edited = Organs { shapes: organs.shapes.clone(), need_form, ..Organs::default() };
    for (node, to) in (0..).zip(moves) {
        let carried = Carried { to, from: from(grown, to), node };
        for &polygon in polygons.of(to.bears) {
            carried.polygon(organs, polygon as usize, &mut edited.polygons);
        }
        for &organ in placed.of(to.bears) {
            carried.organ(&organs.placed, organ as usize, &mut edited.placed);
        }
    }
    Ok(edited)
}

fn from(grown: &Skeleton, to: &NodeMove) -> DVec3 {
    grown.positions.get(to.bears as usize).map_or(DVec3::ZERO, |at| at.as_dvec3())
}

/// A node, and where it was.
struct Carried<'a> {
    to: &'a NodeMove,
    from: DVec3,
    node: u32,
}

impl Carried<'_> {
    fn place(&self, at: Vec3) -> Vec3 {
        let NodeMove { at: to, turn, size, .. } = *self.to;
        // What did not move keeps its bits.
        if to == self.from && turn == DQuat::IDENTITY && size == 1.0 {
            return at;
        }
        (to + turn * (at.as_dvec3() - self.from) * size).as_vec3()
    }

    fn direction(&self, along: Vec3) -> Vec3 {
        if self.to.turn == DQuat::IDENTITY { along } else { (self.to.turn * along.as_dvec3()).as_vec3() }
    }

    fn origin(&self, growth: &OrganOrigins, organ: usize, into: &mut OrganOrigins) {
        into.nodes.push(self.node);
        into.colors.push(growth.colors[organ]);
        into.births.push(growth.births[organ]);
    }

    fn polygon(&self, organs: &Organs, polygon: usize, into: &mut Polygons) {
        into.corners.extend(organs.corners_of(polygon).iter().map(|&corner| self.place(corner)));
        into.ends.push(into.corners.len() as u32);
        into.headings.push(self.direction(organs.polygons.headings[polygon]));
        into.ups.push(self.direction(organs.polygons.ups[polygon]));
        self.origin(&organs.polygons.growth, polygon, &mut into.growth);
    }

    fn organ(&self, placed: &PlacedOrgans, organ: usize, into: &mut PlacedOrgans) {
        into.prototypes.push(placed.prototypes[organ]);
        into.positions.push(self.place(placed.positions[organ]));
        into.headings.push(self.direction(placed.headings[organ]));
        into.ups.push(self.direction(placed.ups[organ]));
        into.sizes_m.push((f64::from(placed.sizes_m[organ]) * self.to.size) as f32);
        self.origin(&placed.growth, organ, &mut into.growth);
    }
}

/// The organs of each node.
struct ByNode {
    ends: Vec<u32>,
    organs: Vec<u32>,
}

impl ByNode {
    fn new(growth: &OrganOrigins, nodes: usize) -> Self {
        let mut ends = vec![0_u32; nodes];
        let mut organs: Vec<u32> = (0..growth.nodes.len() as u32).collect();
        organs.sort_by_key(|&organ| growth.nodes[organ as usize]);
        for &node in &growth.nodes {
            if let Some(end) = ends.get_mut(node as usize) {
                *end += 1;
            }
        }
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        Self { ends, organs }
    }

    fn of(&self, node: u32) -> &[u32] {
        if node == NO_PARENT {
            return &[];
        }
        let node = node as usize;
        let first = if node == 0 { 0 } else { self.ends[node - 1] };
        &self.organs[first as usize..self.ends[node] as usize]
    }
}
