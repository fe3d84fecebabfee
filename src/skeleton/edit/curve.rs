//! An axis on a curve that somebody drew.

use glam::{DQuat, DVec3};

use super::{Bench, Left, is_stem};

/// Samples of the curve between two control points.
const SAMPLES: usize = 64;
/// Two points no farther apart are one, metres.
const APART_M: f64 = 1e-9;
/// The curve is divided so that no node turns farther, radians, and each piece between points at least once.
const TURN_PER_NODE: f64 = 0.15;
/// The most nodes that a piece between two control points gets.
const MOST_PER_PIECE: f64 = 24.0;

impl Bench<'_> {
    /// Leads an axis through points, metres from its base. Nodes stay at their share of its length.
    pub(super) fn redraw(&mut self, axis: u32, points: &[[f64; 3]]) -> Result<(), Left> {
        let line = self.work.line(axis);
        let Some(&base) = line.first() else { return Ok(()) };
        let base = self.work.at(base);
        let mut control = vec![base];
        for point in points.iter().map(|&point| base + DVec3::from(point)) {
            // Two points at one place are one.
            if control.last().is_none_or(|last| last.distance(point) > APART_M) {
                control.push(point);
            }
        }
        let length_m = self.work.length_m(axis);
        if control.len() < 2 || !(length_m > 0.0) {
            return Err("the curve has no length; give it points away from the base of the axis".to_owned());
        }
        let samples = sample(&control);
        let ways = lengths(&samples);
        let curve_m = ways.last().copied().unwrap_or(0.0);
        // A node at each control point, and as many between as the curve needs.
        let mut pinned = Vec::new();
        for piece in 0..control.len() - 1 {
            let part = piece * SAMPLES..=(piece + 1) * SAMPLES;
            let count = libm::ceil(turned(&samples[part]) / TURN_PER_NODE).clamp(2.0, MOST_PER_PIECE);
            let (from, to) = (ways[piece * SAMPLES], ways[(piece + 1) * SAMPLES]);
            let gap_m = (to - from) / count / curve_m * length_m;
            for i in 1..count as u32 {
                let way = from + (to - from) * f64::from(i) / count;
                self.work.split(axis, way / curve_m * length_m, 0.5 * gap_m);
            }
            pinned.push((to / curve_m * length_m, control[piece + 1]));
        }
        let pinned: Vec<(u32, DVec3)> =
            pinned.into_iter().map(|(way, at)| (self.work.split(axis, way, 0.0), at)).collect();
        let line = self.work.line(axis);
        let old: Vec<DVec3> = line.iter().map(|&node| self.work.at(node)).collect();
        let old_ways = lengths(&old);
        let mut new: Vec<DVec3> =
            old_ways.iter().map(|way| at(&samples, &ways, way / length_m * curve_m)).collect();
        for (node, at) in pinned {
            if let Some(place) = line.iter().position(|&other| other == node) {
                new[place] = at;
            }
        }
        new[0] = old[0];
        let turns: Vec<DQuat> =
            (0..line.len()).map(|i| DQuat::from_rotation_arc(tangent(&old, i), tangent(&new, i))).collect();
        let is_lateral = !is_stem(&self.work, axis);
        self.carry(axis, is_lateral, &line, (&old, &new), &turns);
        Ok(())
    }
}

/// The curve that an edit with `do = "curve"` leads an axis along: through its base and the points after it, metres.
/// Fewer than two points apart make no curve.
pub fn curve_through(points: &[DVec3]) -> Vec<DVec3> {
    let mut control: Vec<DVec3> = Vec::with_capacity(points.len());
    for &point in points {
        if point.is_finite() && control.last().is_none_or(|last| last.distance(point) > APART_M) {
            control.push(point);
        }
    }
    if control.len() < 2 { Vec::new() } else { sample(&control) }
}

/// Points of the centripetal Catmull–Rom curve through all of `control` (Barry & Goldman 1988; Yuksel, Schaefer &
/// Keyser 2011), [`SAMPLES`] from each to the next. Beyond the ends the curve leads on straight.
fn sample(control: &[DVec3]) -> Vec<DVec3> {
    let last = control.len() - 1;
    let mut padded = vec![2.0 * control[0] - control[1]];
    padded.extend_from_slice(control);
    padded.push(2.0 * control[last] - control[last - 1]);
    let mut samples = vec![control[0]];
    for four in padded.windows(4) {
        let mut knots = [0.0; 4];
        for i in 1..4 {
            knots[i] = knots[i - 1] + four[i].distance(four[i - 1]).sqrt();
        }
        for i in 1..SAMPLES {
            let t = knots[1] + (knots[2] - knots[1]) * i as f64 / SAMPLES as f64;
            samples.push(barry_goldman(four, knots, t));
        }
        samples.push(four[2]);
    }
    samples
}

fn barry_goldman(points: &[DVec3], knots: [f64; 4], t: f64) -> DVec3 {
    let mut level = [points[0], points[1], points[2], points[3]];
    for span in 1..4_usize {
        for i in 0..4 - span {
            // The last level is between the middle two knots.
            let (from, to) = if span == 3 { (knots[1], knots[2]) } else { (knots[i], knots[i + span]) };
            level[i] = level[i] + (level[i + 1] - level[i]) * ((t - from) / (to - from));
        }
    }
    level[0]
}

/// The sum of all turns of a line, radians.
fn turned(line: &[DVec3]) -> f64 {
    let turn = |three: &[DVec3]| {
        let (a, b) = (three[1] - three[0], three[2] - three[1]);
        libm::atan2(a.cross(b).length(), a.dot(b))
    };
    line.windows(3).map(turn).sum()
}

/// Arc lengths from the first point to each.
fn lengths(points: &[DVec3]) -> Vec<f64> {
    let mut along = 0.0;
    let steps = points.windows(2).map(|pair| {
        along += pair[0].distance(pair[1]);
        along
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The point of a line of samples at an arc length.
fn at(samples: &[DVec3], lengths: &[f64], along: f64) -> DVec3 {
    let next = lengths.partition_point(|&length| length < along).clamp(1, samples.len() - 1);
    let (from, to) = (lengths[next - 1], lengths[next]);
    let t = if to > from { ((along - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    samples[next - 1].lerp(samples[next], t)
}

/// Along a line at one of its points.
fn tangent(points: &[DVec3], i: usize) -> DVec3 {
    let (before, after) = (points[i.saturating_sub(1)], points[(i + 1).min(points.len() - 1)]);
    (after - before).try_normalize().unwrap_or(DVec3::Y)
}
