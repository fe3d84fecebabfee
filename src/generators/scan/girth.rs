//! How thick wood is, from the points on its bark.
//!
//! Points belong to the segment that is nearest. Around each node those of a stretch of its axis are
//! seen along the axis, and a circle is put through them (Kåsa 1976, *A circle fitting procedure and its
//! error analysis*; four rounds, each without what lies far off the circle before): a stem that was seen
//! from one side has its axis off its middle, where the mean distance is no radius.
//!
//! A circle is believed where it holds enough points, is as round as bark is (leaves fill the disc, bark
//! its rim), is thicker than the error of the points and no thicker than wood can be there. Along an axis
//! believed radii are made to shrink towards the tip by the least change (pool adjacent violators, Ayer et
//! al. 1955). Where nothing is believed the pipe model goes on from the nearest that is.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::segments::{Nearest, Segments};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Axis, Branching, NO_PARENT, axes_by_tips, count_tips};

/// Bytes for each point of what measures a tree: the nearest segments of all points, and the search for points
/// near segments.
pub(crate) const MEASURING_BYTES_PER_POINT: u64 = 120;

/// Points that a circle is put through at least.
const LEAST_POINTS: usize = 12;

/// Points with which a stretch is long enough.
const ENOUGH_POINTS: usize = 60;

/// Most segments of a stretch to either side.
const WIDEST: usize = 4;

/// Where a lateral starts: the distance from where it leaves its parent, in radii of that.
const BASE: f64 = 1.3;

/// Most of `Σ r_child^n`, in units of the parent's `r^n`.
const CARRIED: f64 = 1.5;

/// Half of the points lie nearer to a believed circle than this part of its radius.
const ROUND: f64 = 0.18;

/// Least believed radius, in standard errors of the points.
const CLEAR: f64 = 2.0;

/// Fits of a circle, each without what lay far off the one before.
const ROUNDS: usize = 4;

/// Standard deviations off a circle beyond which a point is no part of it.
const STRAY: f64 = 2.5;

/// The pipe model of the stoutest tree: base radius ÷ height. Four times what wood is given unasked; an old
/// oak in the open comes near it. Leaves around a twig soon look thicker.
const STOUT_PER_HEIGHT: f64 = 1.0 / 15.0;

/// From the median of absolute deviations to the standard deviation of a normal error.
const SD_PER_MAD: f64 = 1.4826;

/// Radii, and how much of the tree they were seen on.
pub struct Girth {
    /// Metres, one per node.
    pub radii: Vec<f32>,
    /// Nodes whose radius points bear out.
    pub measured: usize,
}

/// A circle through the points of a stretch.
#[derive(Clone, Copy)]
struct Circle {
    radius_m: f64,
    /// Median distance of the points from it.
    off_m: f64,
    points: usize,
}

/// Radii for a branching from points on its bark, where it stands; `None` where no circle is believed.
/// `exponent` is the pipe model's.
///
/// # Errors
/// [`Cancelled`].
pub fn girth(
    branching: &Branching,
    bark: &[Vec3],
    exponent: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Girth>, Cancelled> {
    let Branching { positions, parents, .. } = branching;
    let Some(segments) = Segments::new(positions, parents) else { return Ok(None) };
    let nearest = segments.nearest(bark, monitor)?;
    let by_node = ByNode::new(&nearest, positions.len());
    let tips = count_tips(parents);
    let (axes, axis_nodes) = axes_by_tips(positions, parents, None);

    let round = |c: &&Circle| c.off_m < ROUND * c.radius_m;
    // Order by order: where a lateral leaves thick wood, the bark around its start is its parent's.
    let mut circles: Vec<Vec<Option<Circle>>> = vec![Vec::new(); axes.len()];
    let mut thick = vec![0.0; positions.len()];
    for order in 0..=axes.iter().map(|axis| axis.order).max().unwrap_or(0) {
        let of_order = |axis: &Axis| axis.order == order;
        let found: Vec<(usize, Vec<Option<Circle>>)> = axes
            .par_iter()
            .enumerate()
            .filter(|(_, axis)| of_order(axis))
            .map(|(index, axis)| {
                monitor.check()?;
                let nodes = &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
                let inside = match axis.parent {
                    NO_PARENT => 0,
                    fork => {
                        let at = positions[fork as usize];
                        let reach = BASE * thick[fork as usize];
                        let is_inside = |&n: &u32| f64::from(positions[n as usize].distance(at)) < reach;
                        nodes.iter().take_while(|n| is_inside(n)).count()
                    }
                };
                let stretch = Stretch { nodes, inside, positions, parents, bark, by_node: &by_node };
                // Thousands of points may lie beside one node.
                let circle = |i| monitor.check().map(|()| stretch.circle(i));
                Ok((index, (0..nodes.len()).map(circle).collect::<Result<_, Cancelled>>()?))
            })
            .collect::<Result<_, Cancelled>>()?;
        for (index, found) in found {
            let nodes = &axis_nodes[axes[index].first as usize..];
            for (&node, circle) in nodes.iter().zip(&found) {
                thick[node as usize] = circle.as_ref().filter(round).map_or(0.0, |c| c.radius_m);
            }
            circles[index] = found;
        }
    }
    // The error of the points, seen where wood is thick enough to show it.
    let mut errors: Vec<f64> = circles.iter().flatten().flatten().filter(round).map(|c| c.off_m).collect();
    errors.sort_unstable_by(f64::total_cmp);
    let Some(error_m) = errors.get(errors.len() / 4).map(|off| SD_PER_MAD * off) else { return Ok(None) };
    let pipe = |node: u32| libm::pow(f64::from(tips[node as usize]), 1.0 / exponent);
    let thickest = (0..).zip(parents).filter(|(_, parent)| **parent == NO_PARENT).map(|(n, _)| pipe(n));
    let unit_m = STOUT_PER_HEIGHT * height_m(positions) / thickest.fold(1.0, f64::max);
    let believed = |node: u32, c: &Circle| {
        round(&c) && c.radius_m > CLEAR * error_m && c.radius_m <= unit_m * pipe(node)
    };

    let mut seen = vec![None; positions.len()];
    for (axis, circles) in axes.iter().zip(&circles) {
        let nodes = &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
        let (places, known): (Vec<usize>, Vec<Circle>) = circles
            .iter()
            .enumerate()
            .filter_map(|(i, circle)| circle.filter(|c| believed(nodes[i], c)).map(|circle| (i, circle)))
            .unzip();
        for (place, radius_m) in places.iter().zip(shrinking(&known)) {
            seen[nodes[*place] as usize] = Some(radius_m);
        }
    }
    let measured = seen.iter().flatten().count();
    if measured == 0 {
        return Ok(None);
    }
    let radii = filled(&seen, parents, &tips, exponent);
    Ok(Some(Girth { radii, measured }))
}

/// Indices of points by the node that their nearest segment ends in.
struct ByNode {
    starts: Vec<u32>,
    points: Vec<u32>,
}

impl ByNode {
    fn new(nearest: &[Nearest], nodes: usize) -> Self {
        // What lies beyond the end of a twig is not beside it.
        let beside = || nearest.iter().zip(0_u32..).filter(|(n, _)| n.t > 0.0 && n.t < 1.0);
        let mut starts = vec![0_u32; nodes + 1];
        for (n, _) in beside() {
            starts[n.node as usize + 1] += 1;
        }
        for i in 0..nodes {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut points = vec![0; starts[nodes] as usize];
        for (n, index) in beside() {
            let slot = &mut next[n.node as usize];
            points[*slot as usize] = index;
            *slot += 1;
        }
        Self { starts, points }
    }

    fn of(&self, node: u32) -> &[u32] {
        &self.points[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }
}

/// An axis and the points beside it.
struct Stretch<'a> {
    nodes: &'a [u32],
    /// So many at the start lie in the wood that the axis leaves from.
    inside: usize,
    positions: &'a [Vec3],
    parents: &'a [u32],
    bark: &'a [Vec3],
    by_node: &'a ByNode,
}

impl Stretch<'_> {
    /// The circle around the `i`-th node, through the points of as many segments around it as it takes.
    fn circle(&self, i: usize) -> Option<Circle> {
        if i < self.inside {
            return None;
        }
        let mut half = 0;
        let count = |half: usize| -> usize { self.around(i, half).map(|n| self.by_node.of(n).len()).sum() };
        while half < WIDEST && count(half) < ENOUGH_POINTS {
            half += 1;
        }
        if count(half) < LEAST_POINTS {
            return None;
        }
        // Each point is seen along its own segment: the axis may bend.
        let mut flat = Vec::new();
        let (u, v) = self.direction(self.nodes[i])?.any_orthonormal_pair();
        for node in self.around(i, half) {
            let Some(along) = self.direction(node) else { continue };
            let from = self.positions[self.parents[node as usize] as usize].as_dvec3();
            for &p in self.by_node.of(node) {
                let away = (self.bark[p as usize].as_dvec3() - from).reject_from_normalized(along);
                flat.push((away.dot(u), away.dot(v)));
            }
        }
        through(&flat)
    }

    /// The nodes up to `half` before and after the `i`-th that end a segment.
    fn around(&self, i: usize, half: usize) -> impl Iterator<Item = u32> {
        let range = i.saturating_sub(half).max(self.inside)..(i + half + 1).min(self.nodes.len());
        self.nodes[range].iter().copied().filter(|&n| self.parents[n as usize] != NO_PARENT)
    }

    fn direction(&self, node: u32) -> Option<DVec3> {
        // The foot of a stem ends no segment: it looks as the one above.
        let node = if self.parents[node as usize] == NO_PARENT { *self.nodes.get(1)? } else { node };
        let parent = self.parents[node as usize];
        (self.positions[node as usize].as_dvec3() - self.positions[parent as usize].as_dvec3())
            .try_normalize()
    }
}

/// The circle through points of a plane; around the origin with the median distance where no fit is
/// better.
fn through(flat: &[(f64, f64)]) -> Option<Circle> {
    let mut scratch = Vec::with_capacity(flat.len());
    let mut about = |centre: (f64, f64)| {
        scratch.clear();
        scratch.extend(flat.iter().map(|&p| distance(centre, p)));
        let radius_m = median(&mut scratch)?;
        for away in &mut scratch {
            *away = (*away - radius_m).abs();
        }
        Some(Circle { radius_m, off_m: median(&mut scratch)?, points: flat.len() })
    };
    let start = about((0.0, 0.0))?;
    let (mut best, mut last, mut centre) = (start, start, (0.0, 0.0));
    let mut kept = Vec::with_capacity(flat.len());
    for _ in 0..ROUNDS {
        let far = STRAY * SD_PER_MAD * last.off_m;
        kept.clear();
        kept.extend(flat.iter().filter(|&&p| (distance(centre, p) - last.radius_m).abs() <= far));
        let Some(fitted) = kasa(&kept).filter(|_| kept.len() >= LEAST_POINTS) else { break };
        // A shallow arc fits circles of any size: not far from the axis that the points gave.
        if distance(fitted, (0.0, 0.0)) > 0.8 * start.radius_m {
            break;
        }
        centre = fitted;
        last = about(centre)?;
        if last.off_m < best.off_m && last.radius_m < 2.0 * start.radius_m {
            best = last;
        }
    }
    Some(best)
}

/// The centre of the circle for which `Σ (|p−c|² − r²)²` is least; `None` for points in a line.
fn kasa(flat: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = flat.len() as f64;
    let (mx, my) = flat.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(x, y) in flat {
        let (x, y) = (x - mx, y - my);
        let z = x * x + y * y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
        xz += x * z;
        yz += y * z;
    }
    let determinant = xx * yy - xy * xy;
    if !(determinant > 1e-9 * (xx + yy) * (xx + yy)) {
        return None;
    }
    let cx = 0.5 * (xz * yy - yz * xy) / determinant;
    let cy = 0.5 * (yz * xx - xz * xy) / determinant;
    Some((cx + mx, cy + my))
}

/// Not the platform's: square roots are the same on every machine, and no distance here comes near the
/// ends of the range.
fn distance((x, y): (f64, f64), (u, v): (f64, f64)) -> f64 {
    ((u - x) * (u - x) + (v - y) * (v - y)).sqrt()
}

fn height_m(positions: &[Vec3]) -> f64 {
    let heights = || positions.iter().map(|p| p.y);
    f64::from(heights().fold(f32::MIN, f32::max)) - f64::from(heights().fold(f32::MAX, f32::min))
}

fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The radii that shrink (or stay) from each to the next, nearest to those given in the least squares
/// weighted by points.
fn shrinking(circles: &[Circle]) -> Vec<f64> {
    // Blocks of equal radius: (mean, weight, how many).
    let mut blocks: Vec<(f64, f64, usize)> = Vec::new();
    for circle in circles {
        let mut block = (circle.radius_m, circle.points as f64, 1);
        while let Some(before) = blocks.pop_if(|before| before.0 < block.0) {
            let weight = before.1 + block.1;
            block = ((before.0 * before.1 + block.0 * block.1) / weight, weight, before.2 + block.2);
        }
        blocks.push(block);
    }
    blocks.iter().flat_map(|&(radius_m, _, count)| std::iter::repeat_n(radius_m, count)).collect()
}

/// Radii for all nodes: seen ones as they are, between and beyond them the pipe model `tips^(1/n)` times
/// what the nearest seen node below (without one, above) says. Never thicker than the parent, nor thicker
/// together than the pipe model lets siblings be, with some play: leaves that look like bark make no limbs.
fn filled(seen: &[Option<f64>], parents: &[u32], tips: &[u32], exponent: f64) -> Vec<f32> {
    let pipe = |node: usize| libm::pow(f64::from(tips[node]), 1.0 / exponent);
    let mut scale: Vec<Option<f64>> = (0..).zip(seen).map(|(n, r)| r.map(|r| r / pipe(n))).collect();
    // Down to the foot from the thickest seen child, then up to the tips.
    let mut above: Vec<Option<(u32, f64)>> = vec![None; seen.len()];
    for node in (0..seen.len()).rev() {
        if scale[node].is_none() {
            scale[node] = above[node].map(|(_, scale)| scale);
        }
        let parent = parents[node];
        if let (Some(factor), true) = (scale[node], parent != NO_PARENT) {
            let best = &mut above[parent as usize];
            if seen[parent as usize].is_none() && best.is_none_or(|(most, _)| most < tips[node]) {
                *best = Some((tips[node], factor));
            }
        }
    }
    let mut children: Vec<(u32, u32)> =
        parents.iter().copied().zip(0..).filter(|&(parent, _)| parent != NO_PARENT).collect();
    children.sort_unstable();
    let fallback = scale.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut radii: Vec<f64> = (0..).zip(&scale).map(|(n, s)| s.unwrap_or(fallback) * pipe(n)).collect();
    // What hangs on a node goes by that, not by what it bears itself; together they carry no more than it.
    for fork in children.chunk_by(|a, b| a.0 == b.0) {
        let parent = fork[0].0 as usize;
        let mut carried = 0.0;
        for &(_, child) in fork {
            let child = child as usize;
            let wanted = seen[child].unwrap_or(radii[parent] / pipe(parent) * pipe(child));
            radii[child] = wanted.min(radii[parent]);
            if seen[child].is_some() {
                carried += libm::pow(radii[child], exponent);
            }
        }
        let most = CARRIED * libm::pow(radii[parent], exponent);
        if carried > most {
            let share = libm::pow(most / carried, 1.0 / exponent);
            for &(_, child) in fork.iter().filter(|(_, child)| seen[*child as usize].is_some()) {
                radii[child as usize] *= share;
            }
        }
    }
    radii.iter().map(|&r| r as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    const TAU: f64 = std::f64::consts::TAU;

    /// Points of a circle's arc, with an error.
    fn arc(centre: (f64, f64), radius: f64, turn: f64, error: f64, count: u64) -> Vec<(f64, f64)> {
        let key = Key::new(3);
        let one = |i: u64| {
            let (a, r) =
                (turn * key.child(i).child(0).unit(), radius + key.child(i).child(1).between(-error, error));
            (centre.0 + r * libm::cos(a), centre.1 + r * libm::sin(a))
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn a_circle_is_found_from_half_of_it_and_past_strays() {
        let mut flat = arc((0.05, -0.03), 0.15, 0.5 * TAU, 0.004, 80);
        flat.extend([(0.5, 0.4), (0.02, 0.6), (-0.4, 0.0)]);
        let circle = through(&flat).unwrap();
        assert!((circle.radius_m - 0.15).abs() < 0.003, "{}", circle.radius_m);
        assert!(circle.off_m < 0.005);
        // A full disc, as leaves are, is not round.
        let disc: Vec<(f64, f64)> = arc((0.0, 0.0), 0.1, TAU, 0.1, 200);
        let circle = through(&disc).unwrap();
        assert!(circle.off_m > ROUND * circle.radius_m);
        assert!(through(&[(0.0, 0.0); 20]).unwrap().radius_m == 0.0);
    }

    #[test]
    fn shrinking_is_the_least_change() {
        let circle = |radius_m, points| Circle { radius_m, off_m: 0.0, points };
        let given = [circle(5.0, 1), circle(3.0, 1), circle(4.0, 3), circle(1.0, 1), circle(2.0, 1)];
        assert_eq!(shrinking(&given), [5.0, 3.75, 3.75, 1.5, 1.5]);
        assert_eq!(shrinking(&[]), [0.0; 0]);
    }

    /// A pole of 3 m whose radius goes from 0.1 to 0.05 m, a thin lateral that was not seen.
    #[test]
    fn radii_come_from_the_bark_and_go_on_by_the_pipe_model() {
        let mut branching = Branching::default();
        for i in 0..31_u16 {
            branching.positions.push(Vec3::Y * f32::from(i) * 0.1);
            branching.parents.push(if i == 0 { NO_PARENT } else { u32::from(i) - 1 });
        }
        for i in 0..5_u16 {
            branching.positions.push(Vec3::new(0.1 + f32::from(i) * 0.1, 1.55, 0.0));
            branching.parents.push(if i == 0 { 15 } else { 30 + u32::from(i) });
        }
        branching.births = vec![0; branching.positions.len()];
        let key = Key::new(8);
        let bark: Vec<Vec3> = (0..6000)
            .map(|i| {
                let key = key.child(i);
                let (h, turn) = (key.child(0).unit() * 3.0, key.child(1).unit() * TAU);
                let r = 0.1 - h / 60.0 + key.child(2).between(-0.004, 0.004);
                DVec3::new(r * libm::cos(turn), h, r * libm::sin(turn)).as_vec3()
            })
            .collect();
        let Girth { radii, measured } = girth(&branching, &bark, 2.0, &Quiet).unwrap().unwrap();
        assert!(measured > 25, "{measured}");
        for (i, radius) in radii.iter().enumerate().take(30).skip(1) {
            let expected = 0.1 - i as f32 / 600.0;
            assert!((radius - expected).abs() < 0.01, "{i}: {radius} {expected}");
        }
        for (node, &parent) in branching.parents.iter().enumerate().filter(|(_, p)| **p != NO_PARENT) {
            assert!(radii[node] <= radii[parent as usize] && radii[node] > 0.0);
        }
        // One of two tips by the pipe model with n = 2.
        let expected = radii[15] / 2.0_f32.sqrt();
        assert!((radii[35] / expected - 1.0).abs() < 0.01, "{} {expected}", radii[35]);
        assert!(girth(&branching, &[], 2.0, &Quiet).unwrap().is_none());
    }
}
