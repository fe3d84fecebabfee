//! How thick wood is, from the points on its bark.
//!
//! Points belong to the segment that is nearest. Around each node those of a stretch of its axis (as long in
//! metres whatever the steps are) are seen along the axis, and a circle is put through them ([`circle`](super::circle)).
//! Of wood that was seen from one side the axis lies near the bark at first: it is moved to the centres, strands
//! that run inside thicker wood are taken out, the points are given to segments anew, and all is measured again.
//!
//! A circle is believed where it holds enough points, covers enough of the turn, is as round as bark is (leaves fill
//! the disc, bark its rim), is thicker than the error of the points and no thicker than wood can be there. Along an
//! axis believed radii shrink towards the tip ([`profile`]). Between believed ones radii are carried on; elsewhere the
//! length of wood that a node bears decides ([`Allometry`]). No wood is thicker than what bears it.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::allometry::{Allometry, Looked, growth_lengths_m};
use super::circle::{Circle, LEAST_POINTS, SD_PER_MAD};
use super::profile::{self, Believed, Ring};
use super::segments::{Nearest, Segments};
use super::stretch::{ByNode, Seen, Station, Stretch};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Axis, Branching, NO_PARENT, RadiusFit, RadiusSource, Wood, axes_by_tips, count_tips};

/// Bytes for each point of what measures a tree: the nearest segments of all points, and the search for points
/// near segments.
pub(crate) const MEASURING_BYTES_PER_POINT: u64 = 208;

/// Half of the points lie nearer to a believed circle than this part of its radius.
const ROUND: f64 = 0.12;

/// What no chance makes round on a stem, neither twigs beside it nor leaves: so many points, over so much of the turn (radians), of
/// which half lie so near to the circle and whose radius is so sure, as parts of the radius.
const SURE_POINTS: usize = 40;
const SURE_ARC_RAD: f64 = 3.5;
const SURE_ROUND: f64 = 0.06;
const SURE_SE: f64 = 0.02;

/// Least believed radius, in standard errors of the points.
const CLEAR: f64 = 3.0;

/// The arc that a believed circle covers, radians;
const LEAST_ARC_RAD: f64 = 1.5;

/// and how sure its radius is.
const SURE: f64 = 0.06;

/// The base radius of the stoutest tree ÷ its height: four times what wood is given unasked; an old oak in the open
/// comes near it. Leaves around a twig soon look thicker.
const STOUT_PER_HEIGHT: f64 = 1.0 / 15.0;

/// Thinner axes stay where growth has led them.
const RECENTRED_M: f64 = 0.015;

/// Points that tell where axes are, and those of each circle at most.
const FIRST_POINTS: usize = 150_000;
const FIRST_POINTS_PER_CIRCLE: usize = 100;

/// Points of each circle at most that tell how thick wood is.
const POINTS_PER_CIRCLE: usize = 240;

/// How often each node is averaged with its neighbours on its axis: growth goes to and fro by a part of its step.
const SMOOTHING: usize = 2;

/// Radii, and what bears them out, one per node.
pub struct Girth {
    /// Metres.
    pub radii: Vec<f32>,
    /// Where each is from.
    pub fits: Vec<RadiusFit>,
    /// Nodes whose radius points bear out.
    pub measured: usize,
    /// Where each point is nearest to the wood.
    pub(crate) placed: Placed,
}

/// Points by the segments that they are nearest to, and where these were.
pub(crate) struct Placed {
    positions: Vec<Vec3>,
    parents: Vec<u32>,
    nearest: Vec<Nearest>,
}

impl Placed {
    /// The nearest segment of each point, if the wood is still the same.
    pub fn nearest(&self, positions: &[Vec3], parents: &[u32]) -> Option<&[Nearest]> {
        (self.positions == positions && self.parents == parents).then_some(&self.nearest)
    }

    pub fn bytes(&self) -> u64 {
        let of_nodes = bytes_of::<Vec3>(self.positions.capacity()) + bytes_of::<u32>(self.parents.capacity());
        of_nodes + bytes_of::<Nearest>(self.nearest.capacity())
    }
}

/// Radii for a branching from points on its bark, where it stands; `None` where no circle is believed. Nodes are
/// moved into the middle of the wood; strands inside thicker wood go. Of `wood` the pipe model's exponent and the radius of
/// twigs are looked at.
///
/// # Errors
/// [`Cancelled`].
pub fn girth(
    branching: &mut Branching,
    bark: &[Vec3],
    wood: &Wood,
    monitor: &dyn Monitor,
) -> Result<Option<Girth>, Cancelled> {
    let (exponent, twig_m) = (wood.radius_exponent, wood.tip_radius_m);
    smooth(branching);
    let part: Vec<Vec3> = bark.iter().copied().step_by(bark.len().div_ceil(FIRST_POINTS).max(1)).collect();
    let Some(first) = Round::new(branching, &part, exponent, FIRST_POINTS_PER_CIRCLE, monitor)? else {
        return Ok(None);
    };
    let Some(girth) = first.girth(branching, twig_m) else { return Ok(None) };
    first.recentre(branching);
    first.drop_buried(branching, &girth.radii);
    let Some(second) = Round::new(branching, bark, exponent, POINTS_PER_CIRCLE, monitor)? else {
        return Ok(None);
    };
    let Some(mut girth) = second.girth(branching, twig_m) else { return Ok(None) };
    girth.placed.nearest = second.nearest;
    Ok(Some(girth))
}

/// Takes zigzag out of axes; feet and tips stay.
fn smooth(branching: &mut Branching) {
    let (axes, axis_nodes) = axes_by_tips(&branching.positions, &branching.parents, None);
    for _ in 0..SMOOTHING {
        let old = branching.positions.clone();
        for axis in &axes {
            let nodes = &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
            let base = (axis.parent != NO_PARENT).then_some(axis.parent);
            let chain: Vec<u32> = base.into_iter().chain(nodes.iter().copied()).collect();
            for three in chain.windows(3) {
                let [a, b, c] = [three[0], three[1], three[2]].map(|n| old[n as usize]);
                branching.positions[three[1] as usize] = 0.25 * (a + c) + 0.5 * b;
            }
        }
    }
}

/// Circles around all nodes.
struct Round {
    axes: Vec<Axis>,
    axis_nodes: Vec<u32>,
    /// For each node its circle, and where the centre of that is.
    circles: Vec<Option<(Circle, DVec3)>>,
    /// For each point its segment.
    nearest: Vec<Nearest>,
    /// For each node around which a circle was looked for what it stands for.
    looked: Vec<Option<Station>>,
    /// Standard deviation of the points off the bark.
    error_m: f64,
    /// For each node what no radius is above.
    most_m: Vec<f64>,
}

impl Round {
    fn new(
        branching: &Branching,
        bark: &[Vec3],
        exponent: f64,
        most_points: usize,
        monitor: &dyn Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let Branching { positions, parents, .. } = branching;
        let Some(segments) = Segments::new(positions, parents) else { return Ok(None) };
        let nearest = segments.nearest(bark, monitor)?;
        let by_node = ByNode::new(&nearest, positions.len());
        let tips = count_tips(parents);
        let (axes, axis_nodes) = axes_by_tips(positions, parents, None);
        let mut circles: Vec<Option<(Circle, DVec3)>> = vec![None; positions.len()];
        let mut looked = vec![None; positions.len()];
        // Order by order: where a lateral leaves thick wood, the bark around its start is its parent's.
        for order in 0..=axes.iter().map(|axis| axis.order).max().unwrap_or(0) {
            let found: Vec<Seen> = axes
                .par_iter()
                .filter(|axis| axis.order == order)
                .map(|axis| {
                    let thick = |fork: u32| circles[fork as usize].map_or(0.0, |(circle, _)| circle.radius_m);
                    let nodes = &axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
                    let stretch = Stretch::new(axis, nodes, branching, (bark, &by_node), thick, most_points);
                    stretch.circles(monitor)
                })
                .collect::<Result<Vec<_>, Cancelled>>()?
                .concat();
            for Seen { node, circle, station } in found {
                looked[node as usize] = Some(station);
                // A thing of leaves is no wood to leave from.
                circles[node as usize] = circle.filter(|(c, _)| c.mad_m < 1.5 * ROUND * c.radius_m);
            }
        }
        // The error of the points, seen where wood is thick enough to show it.
        let mut errors: Vec<f64> = circles.iter().flatten().map(|(c, _)| c.mad_m).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let Some(error_m) = errors.get(errors.len() / 4).map(|off| SD_PER_MAD * off) else { return Ok(None) };
        let pipe = |node: usize| libm::pow(f64::from(tips[node]), 1.0 / exponent);
        let feet = (0..parents.len()).filter(|&n| parents[n] == NO_PARENT).map(pipe);
        let unit_m = STOUT_PER_HEIGHT * height_m(positions) / feet.fold(1.0, f64::max);
        let most_m = (0..parents.len()).map(|node| unit_m * pipe(node)).collect();
        Ok(Some(Self { axes, axis_nodes, circles, nearest, looked, error_m, most_m }))
    }

    fn nodes(&self, axis: &Axis) -> &[u32] {
        &self.axis_nodes[axis.first as usize..(axis.first + axis.len) as usize]
    }

    /// The circle around a node, if it is believed; its radius without what noise adds to it.
    fn believed(&self, node: u32) -> Option<Circle> {
        let (mut c, _) = self.circles[node as usize]?;
        let sd_m = SD_PER_MAD * c.mad_m;
        c.radius_m -= sd_m * sd_m / (2.0 * c.radius_m);
        let is_believed = c.inliers >= LEAST_POINTS
            && c.arc_rad >= LEAST_ARC_RAD
            && c.mad_m <= (ROUND * c.radius_m).max(0.8 * self.error_m)
            && c.relative_se() <= SURE
            && c.radius_m >= CLEAR * self.error_m
            && c.radius_m <= self.most_m[node as usize];
        is_believed.then_some(c)
    }

    /// Whether the circle around a node of a stem is believed however few others are.
    fn is_sure(&self, node: u32) -> bool {
        self.believed(node).is_some_and(|circle| {
            circle.inliers >= SURE_POINTS
                && circle.arc_rad >= SURE_ARC_RAD
                && circle.mad_m <= SURE_ROUND * circle.radius_m
                && circle.relative_se() <= SURE_SE
        })
    }

    /// Moves nodes to the centres of their circles, and those between them with them.
    fn recentre(&self, branching: &mut Branching) {
        let given = branching.positions.clone();
        for axis in &self.axes {
            let nodes = self.nodes(axis);
            let moves: Vec<Option<(f64, DVec3)>> = nodes
                .iter()
                .map(|&node| {
                    let circle = self.believed(node).filter(|c| c.radius_m >= RECENTRED_M)?;
                    let (_, centre) = self.circles[node as usize]?;
                    let by = centre - given[node as usize].as_dvec3();
                    let most_m = 1.5 * circle.radius_m;
                    let error_m = circle.se_m + 0.02 * circle.radius_m;
                    Some((1.0 / (error_m * error_m), by.clamp_length_max(most_m)))
                })
                .collect();
            for (i, &node) in nodes.iter().enumerate() {
                if branching.parents[node as usize] == NO_PARENT {
                    continue;
                }
                // By how sure each is, over the next few on either side.
                let around = i.saturating_sub(3)..(i + 4).min(nodes.len());
                let (mut weight, mut sum) = (0.0, DVec3::ZERO);
                for (w, by) in moves[around].iter().flatten() {
                    (weight, sum) = (weight + w, sum + *by * *w);
                }
                if weight > 0.0 {
                    branching.positions[node as usize] += (sum / weight).as_vec3();
                }
            }
        }
    }

    /// Takes out laterals that lie in the wood that bears them from end to end.
    fn drop_buried(&self, branching: &mut Branching, radii: &[f32]) {
        let Branching { positions, .. } = &*branching;
        let mut axis_of = vec![0_u32; positions.len()];
        let mut place = vec![0_usize; positions.len()];
        for (index, axis) in (0..).zip(&self.axes) {
            for (i, &node) in self.nodes(axis).iter().enumerate() {
                (axis_of[node as usize], place[node as usize]) = (index, i);
            }
        }
        let mut keep = vec![true; positions.len()];
        let mut bears = vec![false; self.axes.len()];
        // Laterals come after what bears them.
        for (index, axis) in self.axes.iter().enumerate().rev() {
            if axis.parent == NO_PARENT {
                continue;
            }
            let under = axis_of[axis.parent as usize] as usize;
            let nodes = self.nodes(axis);
            let bearer = self.nodes(&self.axes[under]);
            let fork = place[axis.parent as usize];
            let reach = nodes.len() + 8;
            let near = fork.saturating_sub(reach)..(fork + reach).min(bearer.len());
            let is_buried = |&node: &u32| {
                let p = positions[node as usize].as_dvec3();
                bearer[near.clone()].windows(2).any(|pair| {
                    let [a, b] = [pair[0], pair[1]].map(|n| positions[n as usize].as_dvec3());
                    let along = b - a;
                    let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
                    let radius_m = f64::from(radii[pair[1] as usize]);
                    (a + along * t).distance(p) <= 1.1 * radius_m + self.error_m
                })
            };
            if !bears[index] && nodes.iter().all(is_buried) {
                for &node in nodes {
                    keep[node as usize] = false;
                }
            } else {
                bears[under] = true;
            }
        }
        branching.retain(&keep);
    }

    /// Metres from the start of an axis to each of its nodes, along it.
    fn along_m(&self, axis: &Axis, branching: &Branching) -> Vec<f64> {
        let Branching { positions, parents, .. } = branching;
        let mut along_m = 0.0;
        let nodes = self.nodes(axis).iter().map(|&node| node as usize);
        nodes
            .map(|node| {
                if parents[node] != NO_PARENT {
                    along_m += f64::from(positions[node].distance(positions[parents[node] as usize]));
                }
                along_m
            })
            .collect()
    }

    /// Radii of nodes whose circles are believed, shrinking along each axis, and what bears them out.
    fn believed_radii(&self, branching: &Branching) -> (Vec<Option<f64>>, Vec<RadiusFit>) {
        let mut seen: Vec<Option<f64>> = vec![None; branching.positions.len()];
        let mut fits = vec![RadiusFit::GUESSED; branching.positions.len()];
        for axis in &self.axes {
            let nodes = self.nodes(axis);
            let along_m = self.along_m(axis, branching);
            let believed: Vec<Ring> = nodes
                .iter()
                .zip(along_m)
                .filter_map(|(&node, along_m)| Some(Ring { node, along_m, circle: self.believed(node)? }))
                .collect();
            for Believed { ring: Ring { node, circle, .. }, radius_m, se_m } in profile::of(&believed) {
                seen[node as usize] = Some(radius_m);
                fits[node as usize] = RadiusFit {
                    source: RadiusSource::Measured,
                    inliers: circle.inliers as u32,
                    mad_m: circle.mad_m as f32,
                    arc_rad: circle.arc_rad as f32,
                    se_m: se_m as f32,
                    gap_m: 0.0,
                };
            }
        }
        (seen, fits)
    }

    /// Radii of all nodes; `None` where no circle is believed.
    fn girth(&self, branching: &Branching, twig_m: Option<f64>) -> Option<Girth> {
        let Branching { positions, parents, .. } = branching;
        let length_m = |node: usize| f64::from(positions[node].distance(positions[parents[node] as usize]));
        let growth_m = growth_lengths_m(parents, length_m);
        let (mut seen, mut fits) = self.believed_radii(branching);
        let mut is_sure = vec![false; positions.len()];
        for axis in self.axes.iter().filter(|axis| axis.parent == NO_PARENT) {
            for &node in self.nodes(axis) {
                is_sure[node as usize] = self.is_sure(node);
            }
        }
        let known: Vec<Looked> = (0..positions.len())
            .filter_map(|node| {
                let places = self.looked[node]?.places;
                let (growth_m, radius_m) = (growth_m[node], seen[node].unwrap_or(0.0));
                Some(Looked { growth_m, radius_m, places, is_sure: is_sure[node] })
            })
            .collect();
        let allometry = Allometry::of(&known, twig_m)?;
        let is_unknown = |&node: &usize| !allometry.is_known(growth_m[node]) && !is_sure[node];
        for node in (0..positions.len()).filter(is_unknown) {
            (seen[node], fits[node]) = (None, RadiusFit::GUESSED);
        }
        let least = least_radii(parents, &seen);
        let mut radii = vec![0.0_f64; positions.len()];
        for axis in &self.axes {
            let nodes = self.nodes(axis);
            let most_m = if axis.parent == NO_PARENT { f64::INFINITY } else { radii[axis.parent as usize] };
            let guess = |node: u32| allometry.radius_m(growth_m[node as usize]);
            let along_m = self.along_m(axis, branching);
            let known: Vec<usize> = (0..nodes.len()).filter(|&i| seen[nodes[i] as usize].is_some()).collect();
            let radius = |i: usize| seen[nodes[i] as usize].unwrap_or(0.0);
            let mut next = 0;
            let mut last_m = most_m;
            for (i, &node) in nodes.iter().enumerate() {
                while known.get(next).is_some_and(|&k| k < i) {
                    next += 1;
                }
                let (before, after) = (next.checked_sub(1).map(|k| known[k]), known.get(next).copied());
                let radius_m = match (before, after) {
                    (_, Some(k)) if k == i => radius(i),
                    (Some(a), Some(b)) => {
                        let apart_m = along_m[b] - along_m[a];
                        let nearer = if along_m[i] - along_m[a] < 0.5 * apart_m { a } else { b };
                        // The next looked at is the first node that is so far away.
                        let station = self.looked[nodes[a] as usize];
                        let is_seen = station.is_some_and(|station| apart_m <= 2.0 * station.length_m);
                        fits[node as usize] = if is_seen {
                            fits[nodes[nearer] as usize]
                        } else {
                            RadiusFit { source: RadiusSource::Carried, ..RadiusFit::GUESSED }
                        };
                        let share = (along_m[i] - along_m[a]) / (along_m[b] - along_m[a]).max(1e-9);
                        radius(a) + (radius(b) - radius(a)) * share
                    }
                    (Some(a), None) => guess(node) * (radius(a) / guess(nodes[a])).clamp(0.67, 1.5),
                    (None, Some(b)) => {
                        let times = (radius(b) / guess(nodes[b])).clamp(0.67, 1.5);
                        // No clamp, which panics where its bounds cross: wood is thicker than nothing, whatever circles say.
                        (guess(node) * times).min(1.3 * radius(b)).max(radius(b))
                    }
                    (None, None) => guess(node).max(least[node as usize]),
                };
                last_m = radius_m.min(last_m);
                radii[node as usize] = last_m;
            }
        }
        let measured = fits.iter().filter(|fit| fit.source == RadiusSource::Measured).count();
        let placed = Placed { positions: positions.clone(), parents: parents.clone(), nearest: Vec::new() };
        Some(Girth { radii: radii.iter().map(|&r| r as f32).collect(), fits, measured, placed })
    }
}

/// Radii that nodes have at least: those that were seen on the wood that they bear.
fn least_radii(parents: &[u32], seen: &[Option<f64>]) -> Vec<f64> {
    let mut least = vec![0.0_f64; parents.len()];
    for node in (0..parents.len()).rev() {
        let own = seen[node].unwrap_or(least[node]);
        if parents[node] != NO_PARENT {
            let below = &mut least[parents[node] as usize];
            *below = below.max(own);
        }
    }
    least
}

fn height_m(positions: &[Vec3]) -> f64 {
    let heights = || positions.iter().map(|p| p.y);
    f64::from(heights().fold(f32::MIN, f32::max)) - f64::from(heights().fold(f32::MAX, f32::min))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use std::f64::consts::{PI, TAU};

    /// A pole of 3 m whose radius goes from 0.1 to 0.05 m, its bark seen over a part of the turn; its axis `aside_m` off
    /// towards what was seen.
    fn pole(step_m: f32, turn: f64, aside_m: f32) -> (Branching, Vec<Vec3>) {
        let mut branching = Branching::default();
        let nodes = (3.0 / step_m).round() as u32;
        for i in 0..=nodes {
            branching.positions.push(Vec3::new(aside_m, i as f32 * step_m, 0.0));
            branching.parents.push(if i == 0 { NO_PARENT } else { i - 1 });
        }
        branching.births = vec![0; branching.positions.len()];
        let key = Key::new(8);
        let bark = (0..9000)
            .map(|i| {
                let key = key.child(i);
                let (h, a) = (key.child(0).unit() * 3.0, (key.child(1).unit() - 0.5) * turn);
                let r = radius_m(h) + key.child(2).between(-0.003, 0.003);
                DVec3::new(r * libm::cos(a), h, r * libm::sin(a)).as_vec3()
            })
            .collect();
        (branching, bark)
    }

    fn radius_m(height_m: f64) -> f64 {
        0.1 - height_m / 60.0
    }

    #[test]
    fn radii_come_from_the_bark_and_go_on_by_what_wood_bears() {
        let (mut branching, bark) = pole(0.1, TAU, 0.0);
        // A thin lateral that was not seen.
        for i in 0..5_u16 {
            branching.positions.push(Vec3::new(0.1 + f32::from(i) * 0.1, 1.55, 0.0));
            branching.parents.push(if i == 0 { 15 } else { 30 + u32::from(i) });
        }
        branching.births = vec![0; branching.positions.len()];
        let Girth { radii, fits, measured, .. } =
            girth(&mut branching, &bark, &Wood::default(), &Quiet).unwrap().unwrap();
        assert!(measured > 25, "{measured}");
        for i in 1..30 {
            let expected = radius_m(f64::from(branching.positions[i].y)) as f32;
            assert!((radii[i] / expected - 1.0).abs() < 0.04, "{i}: {} {expected}", radii[i]);
            assert!(fits[i].source == RadiusSource::Measured && fits[i].se_m < 0.002, "{:?}", fits[i]);
            assert!(
                fits[i].arc_rad > 6.0 && fits[i].inliers >= 100 && fits[i].mad_m < 0.004,
                "{:?}",
                fits[i]
            );
        }
        for (node, &parent) in branching.parents.iter().enumerate().filter(|(_, p)| **p != NO_PARENT) {
            assert!(radii[node] <= radii[parent as usize] && radii[node] > 0.0);
        }
        assert!(fits[33..].iter().all(|fit| fit.source == RadiusSource::Guessed));
        assert!(girth(&mut branching, &[], &Wood::default(), &Quiet).unwrap().is_none());
    }

    /// The mean distance of these points from the axis says 0.06 m where the radius is 0.1.
    #[test]
    fn an_axis_near_the_bark_of_a_half_seen_pole_goes_to_its_middle() {
        let (mut branching, bark) = pole(0.1, PI, 0.06);
        let Girth { radii, .. } = girth(&mut branching, &bark, &Wood::default(), &Quiet).unwrap().unwrap();
        for (p, radius) in branching.positions.iter().zip(radii).take(27).skip(3) {
            assert!(p.x.abs() < 0.015 && p.z.abs() < 0.01, "{p}");
            let expected = radius_m(f64::from(p.y)) as f32;
            assert!((radius / expected - 1.0).abs() < 0.08, "{p}: {radius} {expected}");
        }
    }

    #[test]
    fn radii_do_not_hang_on_the_steps() {
        let of = |step_m: f32| {
            let (mut branching, bark) = pole(step_m, TAU, 0.0);
            let Girth { radii, .. } =
                girth(&mut branching, &bark, &Wood::default(), &Quiet).unwrap().unwrap();
            [0.6, 1.2, 1.8, 2.4].map(|h: f32| radii[(h / step_m).round() as usize])
        };
        let fine = of(0.02);
        for step_m in [0.05, 0.1, 0.2] {
            for (coarse, fine) in of(step_m).iter().zip(fine) {
                assert!((coarse / fine - 1.0).abs() < 0.03, "{step_m}: {coarse} {fine}");
            }
        }
    }

    #[test]
    fn strands_inside_thicker_wood_are_taken_out() {
        let (mut branching, bark) = pole(0.1, TAU, 0.0);
        for i in 0..6_u16 {
            // One strand along the bark, one twig out of it.
            branching.positions.push(Vec3::new(0.07, 1.05 + f32::from(i) * 0.1, 0.0));
            branching.parents.push(if i == 0 { 10 } else { 30 + u32::from(i) });
        }
        for i in 0..3_u16 {
            branching.positions.push(Vec3::new(0.0, 1.5, 0.12 * f32::from(i + 1)));
            branching.parents.push(if i == 0 { 15 } else { 36 + u32::from(i) });
        }
        branching.births = vec![0; branching.positions.len()];
        let Girth { radii, .. } = girth(&mut branching, &bark, &Wood::default(), &Quiet).unwrap().unwrap();
        assert_eq!((branching.positions.len(), radii.len()), (34, 34));
        assert!(branching.validate().is_ok());
        assert_eq!(branching.parents[31..], [15, 31, 32]);
    }
}
