//! New laterals: drawn, or copied.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

use super::workpiece::{WorkAxis, WorkNode, Workpiece};
use super::{
    Along, AxisOrigin, AxisPath, AxisRoot, Bench, EditError, Job, Left, Operation, direction, is_stem,
    square_to,
};
use crate::NO_PARENT;

/// Nothing is added nearer to a tip, in lengths of the axis: there it would be the tip.
const BELOW_TIP: f64 = 0.01;
/// A node of the axis is taken that is no farther away, in radii of the axis there.
const SNAP_PER_RADIUS: f64 = 0.25;
/// The angle at which a lateral leaves that is told nothing, radians.
const LEAVES_RAD: f64 = 50.0 * std::f64::consts::PI / 180.0;
/// Neighbours are laterals no farther along, in lengths of the axis.
const NEIGHBOURS: f64 = 0.1;
/// What random choices for new axes follow from: numbers that grown axes do not reach.
const NEW_NUMBERS: u32 = 1 << 31;

/// Where a lateral is to leave.
struct Site {
    node: u32,
    at: DVec3,
    /// Along the axis that bears it.
    tangent: DVec3,
    radius_m: f64,
}

impl Job<'_> {
    /// What is to be copied.
    pub(super) fn copied(&self) -> Option<(&AxisPath, Option<[f64; 3]>)> {
        match &self.edit.operation {
            Operation::Copy { from, from_near, .. } => Some((from, *from_near)),
            _ => None,
        }
    }

    fn path(&self) -> AxisPath {
        AxisPath { root: AxisRoot::New(self.added), laterals: Vec::new() }
    }

    const fn number(&self, axis: u32) -> u32 {
        NEW_NUMBERS.wrapping_add(self.added << 16).wrapping_add(axis)
    }
}

impl Bench<'_> {
    fn site(&mut self, axis: u32, at: Along) -> Site {
        let work = &mut self.work;
        let length_m = work.length_m(axis);
        let along_m = at.of(length_m).min(length_m * (1.0 - BELOW_TIP));
        let line = work.line(axis);
        let ways = work.ways(&line);
        let above = ways.partition_point(|&way| way < along_m).min(line.len() - 1);
        let snap_m = SNAP_PER_RADIUS * work.nodes[line[above] as usize].radius_m;
        // Neither the tip nor another axis' node.
        let room_m = along_m.min(length_m - along_m) * 0.5;
        let mut node = work.split(axis, along_m, snap_m.min(room_m));
        if work.axis_of[node as usize] != axis {
            node = line[1];
        }
        let tangent = tangent_at(work, axis, node);
        let WorkNode { at, radius_m, .. } = work.nodes[node as usize];
        Site { node, at, tangent, radius_m }
    }

    /// Adds a lateral with a gentle curve.
    pub(super) fn add(&mut self, job: Job<'_>, bearer: u32) -> Result<(), Left> {
        let Operation::Add { at, towards, length_m, thickness, radius_m, lift_deg } =
            job.edit.operation.clone()
        else {
            return Ok(());
        };
        if !(self.work.length_m(bearer) > 0.0) {
            return Err("the axis has no length that a lateral could leave from".to_owned());
        }
        let site = self.site(bearer, at);
        let heading = match towards {
            Some(towards) => {
                direction(towards).ok_or("'towards' has no length, and so no direction; give it one")?
            }
            None => self.gap(bearer, &site),
        };
        let wanted_m = radius_m.unwrap_or(thickness * site.radius_m);
        if wanted_m > site.radius_m {
            let radius_m = site.radius_m;
            let why = format!("its radius became {radius_m:.4} m: no axis gets thicker than what bears it");
            self.remark(job, false, why);
        }
        let base_m = wanted_m.min(site.radius_m);
        let tips = self.work.tips;
        let tip_m = (tips.radii_m / f64::from(tips.count)).min(base_m);
        let pieces = self.pieces(bearer, length_m);
        // It turns in the plane of its direction and the vertical; what is upright has none.
        let around = heading.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::ZERO);
        let lift_rad = lift_deg.to_radians();
        let axis = self.new_axis(job, job.path(), 0, site.node);
        let WorkNode { birth, origin, .. } = self.work.nodes[site.node as usize];
        let later = self.work.last_birth.saturating_sub(birth + 1);
        let (mut at, mut parent) = (site.at, site.node);
        for piece in 0..pieces {
            let middle = (f64::from(piece) + 0.5) / f64::from(pieces);
            let turn = if around == DVec3::ZERO {
                DQuat::IDENTITY
            } else {
                DQuat::from_axis_angle(around, lift_rad * middle)
            };
            at += turn * heading * (length_m / f64::from(pieces));
            let share = f64::from(piece) / f64::from(pieces - 1);
            let node = WorkNode {
                at,
                radius_m: base_m + (tip_m - base_m) * share,
                parent,
                birth: (birth + 1 + (f64::from(later) * share) as u32).min(self.work.last_birth),
                origin,
                bears: NO_PARENT,
                turn: DQuat::IDENTITY,
                size: 1.0,
            };
            parent = self.work.push(node, axis);
            self.work.axes[axis as usize].nodes.push(parent);
        }
        Ok(())
    }

    /// As many as the bearing axis has on such a length.
    fn pieces(&self, bearer: u32, length_m: f64) -> u32 {
        let nodes = self.work.line(bearer).len() as f64 - 1.0;
        let of_bearer_m = self.work.length_m(bearer) / nodes.max(1.0);
        libm::ceil(length_m / of_bearer_m).clamp(6.0, 64.0) as u32
    }

    /// A direction off an axis, between those of the laterals near a place.
    fn gap(&self, bearer: u32, site: &Site) -> DVec3 {
        let work = &self.work;
        let (x, y) = {
            let x = square_to(site.tangent);
            (x, site.tangent.cross(x))
        };
        let reach_m = NEIGHBOURS * work.length_m(bearer);
        let laterals = work.axes[bearer as usize].laterals.iter();
        let near = laterals
            .map(|&lateral| &work.axes[lateral as usize])
            .filter(|lateral| !lateral.is_gone && work.at(lateral.parent).distance(site.at) <= reach_m);
        let mut azimuths: Vec<f64> = near
            .filter_map(|lateral| {
                let out = work.at(*lateral.nodes.last()?) - work.at(lateral.parent);
                let azimuth = libm::atan2(out.dot(y), out.dot(x));
                azimuth.is_finite().then_some(azimuth)
            })
            .collect();
        azimuths.sort_by(f64::total_cmp);
        let mut widest = (0.0, 0.0);
        for (i, &azimuth) in azimuths.iter().enumerate() {
            let next = azimuths.get(i + 1).copied().unwrap_or(azimuths[0] + TAU);
            if next - azimuth > widest.0 {
                widest = (next - azimuth, azimuth + 0.5 * (next - azimuth));
            }
        }
        let (sin, cos) = (libm::sin(widest.1), libm::cos(widest.1));
        site.tangent * libm::cos(LEAVES_RAD) + (x * cos + y * sin) * libm::sin(LEAVES_RAD)
    }

    /// An axis without nodes that leaves from a node.
    fn new_axis(&mut self, job: Job<'_>, path: AxisPath, number: u32, parent: u32) -> u32 {
        let bearer = self.work.axis_of[parent as usize] as usize;
        let axis = self.work.axes.len() as u32;
        self.finder.added.insert(path.clone(), axis);
        self.work.axes[bearer].laterals.push(axis);
        self.work.axes.push(WorkAxis {
            parent,
            order: self.work.axes[bearer].order + 1,
            nodes: Vec::new(),
            laterals: Vec::new(),
            is_gone: false,
            is_cut: false,
            origin: AxisOrigin::Added(path),
            number: job.number(number),
        });
        axis
    }

    /// Whether there is room for a copy of an axis.
    pub(super) fn admit_copy(&self, job: Job<'_>, from: u32) -> Result<(), EditError> {
        let family = self.work.family(from);
        let copied: usize = family.iter().map(|&axis| self.work.axes[axis as usize].nodes.len()).sum();
        let more = self.work.nodes.len() - self.work.grown.positions.len() + copied;
        let nodes = (self.work.grown.positions.len() + more) as u64;
        if nodes > self.most_nodes {
            let (number, edit) = (job.number, job.edit.to_string());
            return Err(EditError::TooManyNodes { number, edit, nodes, limit: self.most_nodes });
        }
        Ok(Workpiece::admit(self.work.grown, more, self.monitor)?)
    }

    /// Adds a copy of an axis and of all that it bears.
    pub(super) fn copy(&mut self, job: Job<'_>, bearer: u32) -> Result<(), Left> {
        let Operation::Copy { at, from, from_near, towards, size, turn_deg } = &job.edit.operation else {
            return Ok(());
        };
        let from = self.find(from, *from_near, job.edit.branching)?;
        let source = self.work.line(from);
        if source.len() < 2 || !(self.work.length_m(bearer) > 0.0) {
            return Err("an axis without length cannot be copied, nor bear a copy".to_owned());
        }
        let family = self.work.family(from);
        let from_stem = is_stem(&self.work, from);
        let site = self.site(bearer, *at);
        let base = self.work.at(source[0]);
        let chord = source.last().map_or(DVec3::Y, |&tip| self.work.at(tip) - base);
        let chord = chord.try_normalize().unwrap_or(DVec3::Y);
        let (to, around) = match towards {
            Some(towards) => {
                let to =
                    direction(*towards).ok_or("'towards' has no length, and so no direction; give it one")?;
                (upright(chord, to), to)
            }
            None if from_stem => (DQuat::IDENTITY, site.tangent),
            None => {
                let bore = self.work.axis_of[source[0] as usize];
                let tangent = tangent_at(&self.work, bore, source[0]);
                (DQuat::from_rotation_arc(tangent, site.tangent), site.tangent)
            }
        };
        let turn = DQuat::from_axis_angle(around, turn_deg.to_radians()) * to;
        let first = self.work.nodes[source[1] as usize];
        let thinner = (site.radius_m / (first.radius_m * size)).min(1.0);
        let placed = Placed {
            turn,
            size: *size,
            radius: size * thinner,
            from: base,
            to: site.at,
            births: i64::from(self.work.nodes[site.node as usize].birth) + 1 - i64::from(first.birth),
            origin: self.work.nodes[site.node as usize].origin,
        };
        // The foot of a stem is where its copy leaves.
        let mut new_nodes = BTreeMap::from([(source[0], site.node)]);
        let mut paths = BTreeMap::from([(from, job.path())]);
        for (number, &axis) in (0..).zip(&family) {
            let Some(path) = paths.get(&axis).cloned() else { continue };
            for (lateral, number) in self.numbered(axis, from) {
                paths.insert(lateral, path.lateral(number));
            }
            let leaves = if axis == from { source[0] } else { self.work.axes[axis as usize].parent };
            let Some(&parent) = new_nodes.get(&leaves) else { continue };
            let new = self.new_axis(job, path, number, parent);
            let skipped = usize::from(axis == from && from_stem);
            let nodes = self.work.axes[axis as usize].nodes[skipped..].to_vec();
            let is_cut = self.work.axes[axis as usize].is_cut;
            let mut below = parent;
            for node in nodes {
                below = self.work.push(self.copied(node, below, &placed), new);
                new_nodes.insert(node, below);
                self.work.axes[new as usize].nodes.push(below);
            }
            self.work.axes[new as usize].is_cut = is_cut;
        }
        Ok(())
    }

    fn copied(&self, node: u32, parent: u32, placed: &Placed) -> WorkNode {
        let old = self.work.nodes[node as usize];
        let birth = i64::from(old.birth) + placed.births;
        WorkNode {
            at: placed.to + placed.turn * (old.at - placed.from) * placed.size,
            radius_m: old.radius_m * placed.radius,
            parent,
            birth: birth.clamp(0, self.work.last_birth.into()) as u32,
            origin: placed.origin,
            bears: old.bears,
            turn: (placed.turn * old.turn).normalize(),
            size: old.size * placed.size,
        }
    }

    /// The laterals of an axis with their numbers from its base up, from 1; those that leave at one node as they came.
    fn numbered(&self, axis: u32, root: u32) -> Vec<(u32, u32)> {
        let line = self.work.line(axis);
        let places: BTreeMap<u32, usize> =
            line.iter().enumerate().map(|(place, &node)| (node, place)).collect();
        let laterals = self.work.axes[axis as usize].laterals.iter();
        let mut stay: Vec<(usize, u32)> = laterals
            .filter(|&&lateral| lateral != root && !self.work.axes[lateral as usize].is_gone)
            .filter_map(|&lateral| Some((*places.get(&self.work.axes[lateral as usize].parent)?, lateral)))
            .collect();
        stay.sort_unstable();
        stay.into_iter().zip(1..).map(|((_, lateral), number)| (lateral, number)).collect()
    }
}

/// How a copy stands to what is copied.
struct Placed {
    turn: DQuat,
    size: f64,
    radius: f64,
    from: DVec3,
    to: DVec3,
    births: i64,
    origin: u32,
}

/// The turn from one direction to another that keeps what looks up looking up.
fn upright(from: DVec3, to: DVec3) -> DQuat {
    let frame = |along: DVec3| {
        let side = square_to(along);
        DMat3::from_cols(along, side, along.cross(side))
    };
    DQuat::from_mat3(&(frame(to) * frame(from).transpose())).normalize()
}

/// Along an axis at one of its nodes, or at the one that it leaves from.
fn tangent_at(work: &Workpiece<'_>, axis: u32, node: u32) -> DVec3 {
    let line = work.line(axis);
    let place = line.iter().position(|&other| other == node).unwrap_or(0);
    let (before, after) = (place.saturating_sub(1), (place + 1).min(line.len() - 1));
    (work.at(line[after]) - work.at(line[before])).try_normalize().unwrap_or(DVec3::Y)
}
