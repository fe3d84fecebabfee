//! Bending and scaling an axis.

use glam::{DQuat, DVec3};

use super::{Along, Bench, Job, Left, direction, is_stem, square_to};
use crate::NO_PARENT;

/// A bend is divided so that no node turns farther, radians.
const TURN_PER_NODE: f64 = 0.1;

impl Bench<'_> {
    /// Turns an axis from a place on, over a part of its length. What it bears goes along rigidly.
    pub(super) fn bend(
        &mut self,
        axis: u32,
        at: Along,
        angle_deg: f64,
        (towards, round): (Option<[f64; 3]>, Option<[f64; 3]>),
        over: f64,
    ) -> Result<(), Left> {
        let work = &mut self.work;
        let length_m = work.length_m(axis);
        let from_m = at.of(length_m);
        if !(from_m < length_m) {
            return Err(format!(
                "the axis is {length_m:.3} m long, so that nothing bends beyond {from_m:.3} m"
            ));
        }
        let to_m = (from_m + over * length_m).min(length_m);
        let (around, angle_rad) = {
            let line = work.line(axis);
            let ways = work.ways(&line);
            let heading = heading(&line.iter().map(|&node| work.at(node)).collect::<Vec<_>>(), &ways, from_m);
            turn(heading, angle_deg.to_radians(), towards, round)?
        };
        let pieces = libm::ceil(angle_rad.abs() / TURN_PER_NODE).clamp(1.0, 64.0);
        let gap_m = (to_m - from_m) / pieces;
        work.split(axis, from_m, 0.1 * gap_m);
        for piece in 1..=pieces as u32 {
            // What has nodes enough gets none.
            work.split(axis, from_m + gap_m * f64::from(piece), 0.5 * gap_m);
        }
        let share = |way: f64| {
            let t = if to_m > from_m {
                ((way - from_m) / (to_m - from_m)).clamp(0.0, 1.0)
            } else {
                f64::from(u8::from(way > from_m))
            };
            DQuat::from_axis_angle(around, angle_rad * t * t * (3.0 - 2.0 * t))
        };
        let line = work.line(axis);
        let ways = work.ways(&line);
        let old: Vec<DVec3> = line.iter().map(|&node| work.at(node)).collect();
        let mut new = old.clone();
        for i in 1..line.len() {
            new[i] = new[i - 1] + share(0.5 * (ways[i - 1] + ways[i])) * (old[i] - old[i - 1]);
        }
        let is_lateral = !is_stem(work, axis);
        let turns: Vec<DQuat> = ways.iter().map(|&way| share(way)).collect();
        self.carry(axis, is_lateral, &line, (&old, &new), &turns);
        Ok(())
    }

    /// Moves the nodes of an axis, and what leaves from them as they turn. The first of `line` stays where it is
    /// if it is another axis'.
    pub(super) fn carry(
        &mut self,
        axis: u32,
        is_lateral: bool,
        line: &[u32],
        (old, new): (&[DVec3], &[DVec3]),
        turns: &[DQuat],
    ) {
        for i in usize::from(is_lateral)..line.len() {
            if old[i] == new[i] && turns[i] == DQuat::IDENTITY {
                continue;
            }
            let (node, turn) = (line[i], turns[i]);
            self.work.place(node, new[i]);
            self.work.turn(node, turn, 1.0);
            let families: Vec<u32> = self
                .work
                .laterals_at(axis, node)
                .into_iter()
                .flat_map(|lateral| self.work.family(lateral))
                .collect();
            self.work.move_axes(&families, |at| new[i] + turn * (at - old[i]), turn, 1.0);
        }
    }

    /// Makes an axis and all that it bears larger or smaller about the place where it leaves.
    pub(super) fn scale(&mut self, job: Job<'_>, axis: u32, length: f64, thickness: f64) {
        let line = self.work.line(axis);
        let (Some(&base), parent) = (line.first(), self.work.axes[axis as usize].parent) else {
            return;
        };
        let base_at = self.work.at(base);
        let mut times = thickness;
        if parent != NO_PARENT {
            let first = self.work.nodes[line[1] as usize].radius_m;
            let most = (self.work.nodes[base as usize].radius_m / first).max(1.0);
            if times > most {
                times = most;
                self.remark(
                    job,
                    false,
                    format!("thickness became {most:.3}: no axis gets thicker than what bears it"),
                );
            }
        }
        let family = self.work.family(axis);
        self.work.move_axes(&family, |at| base_at + (at - base_at) * length, DQuat::IDENTITY, length);
        for axis in family {
            for i in 0..self.work.axes[axis as usize].nodes.len() {
                let node = self.work.axes[axis as usize].nodes[i];
                self.work.thicken(node, self.work.nodes[node as usize].radius_m * times);
            }
        }
    }
}

/// Where a line leads from a place on: to its end.
fn heading(line: &[DVec3], ways: &[f64], from_m: f64) -> DVec3 {
    let above = ways.partition_point(|&way| way <= from_m).clamp(1, line.len() - 1);
    let span = ways[above] - ways[above - 1];
    let t = if span > 0.0 { (from_m - ways[above - 1]) / span } else { 0.0 };
    let from = line[above - 1].lerp(line[above], t.clamp(0.0, 1.0));
    let along = line[above] - line[above - 1];
    let chord = line.last().map_or(DVec3::ZERO, |&end| end - from);
    chord.try_normalize().or_else(|| along.try_normalize()).unwrap_or(DVec3::Y)
}

/// The axis and the angle, radians, of a turn.
fn turn(
    heading: DVec3,
    angle_rad: f64,
    towards: Option<[f64; 3]>,
    round: Option<[f64; 3]>,
) -> Result<(DVec3, f64), Left> {
    if let Some(round) = round {
        let around = direction(round).ok_or("'round' has no length, and so no direction; give it one")?;
        return Ok((around, angle_rad));
    }
    let towards = direction(towards.unwrap_or([0.0, -1.0, 0.0]))
        .ok_or("'towards' has no length, and so no direction; give it one")?;
    let across = heading.cross(towards);
    let most = libm::atan2(across.length(), heading.dot(towards));
    // What looks the other way has to turn somewhere.
    let around = across.try_normalize().unwrap_or_else(|| square_to(heading));
    Ok((around, angle_rad.min(most)))
}
