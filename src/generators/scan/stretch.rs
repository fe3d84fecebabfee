//! Stretches of axes, and circles through the points around them.

use glam::{DVec3, Vec3};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{Axis, Branching, NO_PARENT};

use super::circle::{self, Circle, Flat, LEAST_POINTS};
use super::cylinder;
use super::oval;
use super::segments::Nearest;
use super::taper;

/// Points with which a stretch is long enough.
const ENOUGH_POINTS: usize = 80;

/// How far a stretch reaches to either side of its node: at least, and at most while points are few.
const REACH_M: (f64, f64) = (0.04, 0.3);

/// From one circle to the next along an axis, at least: metres, and radii of the last.
const STATION_M: f64 = 0.04;
const STATION_RADII: f64 = 0.5;

/// And reaches of its stretch: what lies nearer would be told by the same points.
const STATION_REACHES: f64 = 0.5;

/// And so many radii at least, as many at most while points are few, and never more than so many metres.
const REACH_RADII: (f64, f64) = (0.3, 1.0);
const FARTHEST_M: f64 = 0.5;

/// Where a lateral starts: the distance from where it leaves its parent, in radii of that.
const BASE: f64 = 1.3;

/// Half of the points lie farther off a circle than this part of its radius: the axis may lead another way than the wood.
const UNEVEN: f64 = 0.04;

/// A node around which a circle was looked for.
#[derive(Clone, Copy)]
pub struct Seen {
    pub node: u32,
    /// The circle, and where its middle is.
    pub circle: Option<(Circle, DVec3)>,
    pub station: Station,
}

/// What a node around which a circle was looked for stands for.
#[derive(Clone, Copy)]
pub struct Station {
    /// Metres along the axis after which the next one is looked for, around the first node that is so far.
    pub length_m: f64,
    /// At how many nodes, itself among them, one would have been looked for had points been enough.
    pub places: u32,
}

/// Indices of points by the node that their nearest segment ends in.
pub struct ByNode {
    starts: Vec<u32>,
    points: Vec<u32>,
}

impl ByNode {
    pub fn new(nearest: &[Nearest], nodes: usize) -> Self {
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

    pub fn of(&self, node: u32) -> &[u32] {
        &self.points[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }
}

/// An axis and the points beside it.
pub struct Stretch<'a> {
    nodes: &'a [u32],
    /// Places of the nodes, and where the segments that end in them begin.
    at: Vec<DVec3>,
    from: Vec<DVec3>,
    /// Metres along the axis to each node.
    along_m: Vec<f64>,
    /// Nodes at the start that lie in the wood that the axis leaves from.
    inside: usize,
    bark: &'a [Vec3],
    by_node: &'a ByNode,
    /// How many points lie beside the nodes before each, and beside all.
    points_before: Vec<u32>,
    /// Points around a node that are looked at.
    most_points: usize,
    /// Whether it stands on the ground.
    is_stem: bool,
}

impl<'a> Stretch<'a> {
    pub fn new(
        axis: &Axis,
        nodes: &'a [u32],
        branching: &Branching,
        (bark, by_node): (&'a [Vec3], &'a ByNode),
        thick_m: impl Fn(u32) -> f64,
        most_points: usize,
    ) -> Self {
        let place = |n: u32| branching.positions[n as usize].as_dvec3();
        let at: Vec<DVec3> = nodes.iter().map(|&n| place(n)).collect();
        let base = if axis.parent == NO_PARENT { at[0] } else { place(axis.parent) };
        let from: Vec<DVec3> = std::iter::once(base).chain(at.iter().copied()).take(at.len()).collect();
        let mut along_m = Vec::with_capacity(at.len());
        let mut sum = 0.0;
        for (a, b) in from.iter().zip(&at) {
            sum += a.distance(*b);
            along_m.push(sum);
        }
        let inside = match axis.parent {
            NO_PARENT => 0,
            fork => at.iter().take_while(|p| p.distance(base) < BASE * thick_m(fork)).count(),
        };
        let mut points_before = vec![0];
        for (i, &node) in nodes.iter().enumerate() {
            points_before.push(points_before[i] + by_node.of(node).len() as u32);
        }
        let is_stem = axis.parent == NO_PARENT;
        Self { nodes, at, from, along_m, inside, bark, by_node, points_before, most_points, is_stem }
    }

    /// The nodes whose segments reach within `reach_m` of the `i`-th, along the axis.
    fn around(&self, i: usize, reach_m: f64) -> std::ops::Range<usize> {
        let at_m = self.along_m[i];
        let from = self.along_m.partition_point(|&along| along < at_m - reach_m).max(self.inside);
        let to = self.along_m.partition_point(|&along| along <= at_m + reach_m);
        from..(to + 1).min(self.nodes.len()).max(from)
    }

    /// The direction of the axis at the `i`-th node, over some of its length.
    fn direction(&self, i: usize, reach_m: f64) -> Option<DVec3> {
        let range = self.around(i, reach_m.max(1e-6));
        let to = range.end.max(i + 1) - 1;
        (self.at[to] - self.from[range.start.min(i)]).try_normalize()
    }

    /// Circles around nodes, one every few centimetres, half a radius or half of the stretch that it takes.
    pub fn circles(&self, monitor: &dyn Monitor) -> Result<Vec<Seen>, Cancelled> {
        let mut found: Vec<Seen> = Vec::new();
        let (mut next_m, mut place_m, mut least_m) = (0.0, 0.0, 0.0);
        for (i, &node) in self.nodes.iter().enumerate() {
            let along_m = self.along_m[i];
            if let Some(last) = found.last_mut()
                && along_m < next_m
            {
                if along_m >= place_m {
                    last.station.places += 1;
                    place_m = along_m + least_m;
                }
                continue;
            }
            // Thousands of points may lie beside one node.
            monitor.check()?;
            let reach_m = if i < self.inside { 0.0 } else { self.reach_m(i) };
            let circle = self.circle(i, reach_m);
            let radius_m = circle.map_or(0.0, |(circle, _)| circle.radius_m);
            least_m = STATION_M.max(STATION_RADII * radius_m.min(FARTHEST_M));
            let length_m = least_m.max(STATION_REACHES * reach_m);
            (place_m, next_m) = (along_m + least_m, along_m + length_m);
            found.push(Seen { node, circle, station: Station { length_m, places: 1 } });
        }
        Ok(found)
    }

    /// How many points lie beside the axis within a reach of the `i`-th node.
    fn count(&self, i: usize, reach_m: f64) -> usize {
        let range = self.around(i, reach_m);
        (self.points_before[range.end] - self.points_before[range.start]) as usize
    }

    /// As far as it takes for enough points.
    fn reach_m(&self, i: usize) -> f64 {
        let mut reach_m = REACH_M.0;
        while reach_m < REACH_M.1 && self.count(i, reach_m) < ENOUGH_POINTS {
            reach_m *= 1.4;
        }
        reach_m
    }

    /// The circle around the `i`-th node, through the points within a reach, or a longer one for thick wood; and its centre.
    fn circle(&self, i: usize, reach_m: f64) -> Option<(Circle, DVec3)> {
        if i < self.inside || self.count(i, reach_m) < LEAST_POINTS {
            return None;
        }
        let found = self.fit(i, reach_m)?;
        // Thick wood shows little of its turn in a short stretch, and its axis turns slowly.
        let [least_m, most_m] =
            [REACH_RADII.0, REACH_RADII.1].map(|radii| (radii * found.0.radius_m).min(FARTHEST_M));
        let mut wanted_m = least_m;
        while wanted_m < most_m && self.count(i, wanted_m) < self.most_points {
            wanted_m = (1.2 * wanted_m).min(most_m);
        }
        if wanted_m > 1.2 * reach_m { self.fit(i, wanted_m) } else { Some(found) }
    }

    fn fit(&self, i: usize, reach_m: f64) -> Option<(Circle, DVec3)> {
        let middle = self.at[i];
        let w = self.direction(i, reach_m)?;
        let (u, v) = w.any_orthonormal_pair();
        let range = self.around(i, reach_m);
        let count = self.count(i, reach_m);
        let stride = count.div_ceil(self.most_points).max(1);
        let mut flat: Vec<Flat> = Vec::with_capacity(count / stride + 1);
        let mut near: Vec<DVec3> = Vec::with_capacity(count / stride + 1);
        let mut along_m: Vec<f64> = Vec::with_capacity(count / stride + 1);
        let mut n = 0;
        for k in range {
            if self.by_node.of(self.nodes[k]).is_empty() {
                continue;
            }
            // Each point is seen along its part of the axis, which may bend, from the axis there.
            let Some(along) = self.direction(k, 0.5 * reach_m) else { continue };
            for &p in self.by_node.of(self.nodes[k]) {
                n += 1;
                if n % stride == 0 {
                    let p = self.bark[p as usize].as_dvec3();
                    let away = (p - self.at[k]).reject_from_normalized(along);
                    flat.push((away.dot(u), away.dot(v)));
                    near.push(p - middle);
                    along_m.push(self.along_m[k] - self.along_m[i] + (p - self.at[k]).dot(along));
                }
            }
        }
        let mut found = taper::at_node(&flat, &along_m, circle::fit(&flat)?);
        if found.mad_m > UNEVEN * found.radius_m {
            let straight = straight(&near, [u, v, w], &found);
            // A stem is an oval sooner than it leads another way than its axis; limbs that part are none.
            let is_proven = straight.as_ref().is_some_and(|&(.., is_proven)| is_proven);
            let oval = (self.is_stem && !is_proven).then(|| oval::of_girth(&flat, &found)).flatten();
            match (oval, straight) {
                (Some(oval), _) => found = oval,
                (None, Some((straight, centre, _))) => return Some((straight, middle + centre)),
                (None, None) => {}
            }
        }
        let centre = middle + u * found.centre.0 + v * found.centre.1;
        Some((found, centre))
    }
}

/// The circle of the straight cylinder on which points lie more closely than on the one that was seen, and its centre, if there is
/// one; and whether the points themselves lead its way. Points and centre are given from the middle of the stretch. Seen askew a
/// cylinder is an oval, through which the circle is too large: what comes out larger is another thing.
fn straight(points: &[DVec3], frame: [DVec3; 3], seen: &Circle) -> Option<(Circle, DVec3, bool)> {
    let ([u, v, _], is_proven) = cylinder::turned(points, frame, seen)?;
    let flat: Vec<Flat> = points.iter().map(|p| (p.dot(u), p.dot(v))).collect();
    let found = circle::fit(&flat)?;
    let is_better = found.mad_m < seen.mad_m && found.radius_m < seen.radius_m;
    is_better.then(|| (found, u * found.centre.0 + v * found.centre.1, is_proven))
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::axes_by_tips;

    use super::super::segments::Segments;
    use super::*;

    /// The stations along a rod of 3 m and 2 cm radius with a node every 20.5 mm and points all round.
    fn stations(points_per_m: u64) -> Vec<(f32, Seen)> {
        let mut branching = Branching::default();
        for i in 0..150_u16 {
            branching.positions.push(Vec3::new(0.0, 0.0205 * f32::from(i), 0.0));
            branching.parents.push(if i == 0 { NO_PARENT } else { u32::from(i) - 1 });
        }
        let bark: Vec<Vec3> = (0..3 * points_per_m)
            .map(|i| {
                let key = Key::new(4).child(i);
                let turn = key.child(1).unit() * std::f64::consts::TAU;
                let y = key.child(0).unit() * 3.0;
                DVec3::new(0.02 * libm::cos(turn), y, 0.02 * libm::sin(turn)).as_vec3()
            })
            .collect();
        let segments = Segments::new(&branching.positions, &branching.parents).unwrap();
        let by_node = ByNode::new(&segments.nearest(&bark, &Quiet).unwrap(), branching.positions.len());
        let (axes, nodes) = axes_by_tips(&branching.positions, &branching.parents, None);
        let stretch = Stretch::new(&axes[0], &nodes, &branching, (&bark, &by_node), |_| 0.0, 240);
        let seen = stretch.circles(&Quiet).unwrap();
        seen.into_iter().map(|seen| (branching.positions[seen.node as usize].y, seen)).collect()
    }

    #[test]
    fn circles_are_as_far_apart_as_points_are_few_and_stand_for_as_many_places() {
        let (dense, sparse) = (stations(4000), stations(100));
        for (seen, apart_m) in [(&dense, 0.041), (&sparse, 0.164)] {
            for pair in seen.windows(2) {
                assert!((pair[1].0 - pair[0].0 - apart_m).abs() < 1e-3, "{} {}", pair[0].0, pair[1].0);
            }
            let middle = &seen[seen.len() / 4..3 * seen.len() / 4];
            for (y, Seen { circle, .. }) in middle {
                let radius_m = circle.unwrap().0.radius_m;
                assert!((radius_m - 0.02).abs() < 0.002, "{y}: {radius_m}");
            }
        }
        let places = |seen: &[(f32, Seen)]| seen.iter().map(|(_, seen)| seen.station.places).sum::<u32>();
        assert_eq!((places(&dense), places(&sparse)), (75, 75));
        assert!(dense.iter().all(|(_, seen)| seen.station.places == 1));
    }
}
