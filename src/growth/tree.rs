//! The bounding-volume tree over the attraction points.
//!
//! Points never move, so the tree is built once: leaves of [`LEAF`] points below inner nodes that
//! are [`FAN`] wide, both as structures of arrays whose lanes fill vector registers. The lowest
//! three levels form clusters of up to [`CLUSTER`] points: what one thread works on at a time, small
//! enough for its second-level cache. How points are dealt to leaves decides the speed only,
//! never the result.
//!
//! Where a tree is full (all clusters but the last few leaves are), it takes 22 bytes a point.

use glam::Vec3;
use rayon::prelude::*;

use super::NONE;
use linden_base::monitor::{Cancelled, Monitor};

/// Points per leaf: two AVX2 registers per coordinate.
pub(super) const LEAF: usize = 16;
/// Children per inner node: one AVX2 register per side of the boxes.
pub(super) const FAN: usize = 8;
/// Most points of one cluster: three levels of inner nodes.
const CLUSTER: usize = LEAF * FAN * FAN * FAN;
/// Levels over as many items as can be counted.
const MOST_LEVELS: usize = 12;
/// Clusters that there should be at least, so that threads find work of equal size.
const CLUSTERS: usize = 64;

/// How many points are looked at between two questions to the monitor.
pub(super) const SLICE: usize = 1 << 16;

/// Squared distance of lanes that can never be captured: dead points and padding.
pub(super) const DEAD: f32 = -1.0;

/// Up to [`LEAF`] points and what is known of each.
#[derive(Clone)]
pub(super) struct Leaf {
    pub x: [f32; LEAF],
    pub y: [f32; LEAF],
    pub z: [f32; LEAF],
    /// Squared distance to the nearest node; just above the squared influence distance while none
    /// is in reach; [`DEAD`].
    pub d2: [f32; LEAF],
    /// The nearest node, or [`NONE`].
    pub nearest: [u32; LEAF],
}

impl Leaf {
    fn of(points: &[Vec3], d2: f32) -> Self {
        let mut leaf =
            Self { x: [0.0; LEAF], y: [0.0; LEAF], z: [0.0; LEAF], d2: [DEAD; LEAF], nearest: [NONE; LEAF] };
        for (lane, p) in points.iter().enumerate() {
            (leaf.x[lane], leaf.y[lane], leaf.z[lane], leaf.d2[lane]) = (p.x, p.y, p.z, d2);
        }
        leaf
    }

    pub fn point(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }
}

/// The boxes of up to [`FAN`] children.
#[derive(Clone)]
pub(super) struct Inner {
    low: [[f32; FAN]; 3],
    high: [[f32; FAN]; 3],
    /// The largest `d2` below each child: a node farther from the box than this captures nothing.
    pub reach: [f32; FAN],
}

impl Inner {
    fn over(boxes: &[Box3], d2: f32) -> Self {
        let mut inner = Self { low: [[f32::MAX; FAN]; 3], high: [[f32::MIN; FAN]; 3], reach: [DEAD; FAN] };
        for (child, b) in boxes.iter().enumerate() {
            for axis in 0..3 {
                inner.low[axis][child] = b.low[axis];
                inner.high[axis][child] = b.high[axis];
            }
            inner.reach[child] = d2;
        }
        inner
    }

    /// One bit per child in which `node` might be nearer to a point than what that point has.
    ///
    /// Exact, not merely close: rounding is monotonic, so the rounded distance to the box is never
    /// above the rounded distance to a point inside, computed in the same order.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn entered_by(&self, node: Vec3) -> u32 {
        let mut entered = 0;
        for child in 0..FAN {
            entered |= u32::from(self.distance2(child, node) < self.reach[child]) << child;
        }
        entered
    }

    /// One bit per child that may have a live point not farther from `node` than `distance2` says.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    fn within(&self, node: Vec3, distance2: f32) -> u32 {
        let mut near = 0;
        for child in 0..FAN {
            let most = if self.reach[child] >= 0.0 { distance2 } else { DEAD };
            near |= u32::from(self.distance2(child, node) <= most) << child;
        }
        near
    }

    /// Squared distance from `node` to a child's box.
    ///
    /// In a loop whose only result is a mask this fills vector registers with the eight children;
    /// written with comparisons for `max`, or with an array between, it does not (rustc 1.95).
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    fn distance2(&self, child: usize, node: Vec3) -> f32 {
        let x = (self.low[0][child] - node.x).max(node.x - self.high[0][child]).max(0.0);
        let y = (self.low[1][child] - node.y).max(node.y - self.high[1][child]).max(0.0);
        let z = (self.low[2][child] - node.z).max(node.z - self.high[2][child]).max(0.0);
        x * x + y * y + z * z
    }

    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn farthest_reach(&self) -> f32 {
        largest(&self.reach)
    }
}

/// The largest of some lanes that are not NaN.
#[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
#[inline(always)]
pub(super) fn largest<const LANES: usize>(lanes: &[f32; LANES]) -> f32 {
    let mut halves = *lanes;
    let mut width = LANES / 2;
    while width > 0 {
        for lane in 0..width {
            halves[lane] =
                if halves[lane + width] > halves[lane] { halves[lane + width] } else { halves[lane] };
        }
        width /= 2;
    }
    halves[0]
}

/// Levels of inner nodes over numbered items (leaves or clusters); item `i` is child `i % 8` of
/// node `i / 8`, and so on up to the one root.
#[derive(Clone)]
pub(super) struct Pyramid {
    /// The items' parents first, the root last.
    pub levels: Vec<Vec<Inner>>,
}

impl Pyramid {
    /// `boxes` is not empty.
    fn over(mut boxes: Vec<Box3>, d2: f32) -> Self {
        let mut levels = Vec::new();
        loop {
            levels.push(boxes.chunks(FAN).map(|children| Inner::over(children, d2)).collect());
            boxes = boxes.chunks(FAN).map(Box3::around_boxes).collect();
            if boxes.len() <= 1 {
                return Self { levels };
            }
        }
    }

    /// The items that may have live points not farther from `node` than `distance2` says.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn within(&self, node: Vec3, distance2: f32) -> Within<'_> {
        let mut within =
            Within { levels: &self.levels, node, distance2, open: [(0, 0); MOST_LEVELS], depth: 0 };
        within.enter(0);
        within
    }

    /// The largest `d2` of all.
    pub fn reach(&self) -> f32 {
        self.levels.last().and_then(|level| level.first()).map_or(DEAD, Inner::farthest_reach)
    }
}

/// A walk down a [`Pyramid`].
pub(super) struct Within<'a> {
    levels: &'a [Vec<Inner>],
    node: Vec3,
    distance2: f32,
    /// From the root down: an inner node, and which of its children are still to be entered.
    open: [(u32, u32); MOST_LEVELS],
    depth: usize,
}

impl Within<'_> {
    /// The inner node `index` of the level that is `depth` below the root.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    fn enter(&mut self, index: u32) {
        let inner = &self.levels[self.levels.len() - 1 - self.depth][index as usize];
        self.open[self.depth] = (index, inner.within(self.node, self.distance2));
        self.depth += 1;
    }

    /// Not an iterator: the adapters would be compiled apart, without the vectors.
    #[allow(clippy::inline_always, reason = "must be compiled with the caller's vector instructions")]
    #[inline(always)]
    pub fn next(&mut self) -> Option<usize> {
        while self.depth > 0 {
            let (index, children) = &mut self.open[self.depth - 1];
            if *children == 0 {
                self.depth -= 1;
                continue;
            }
            let child = *index * FAN as u32 + children.trailing_zeros();
            *children &= *children - 1;
            if self.depth == self.levels.len() {
                return Some(child as usize);
            }
            self.enter(child);
        }
        None
    }
}

/// Up to [`CLUSTER`] points that lie together.
#[derive(Clone)]
pub(super) struct Cluster {
    pub leaves: Vec<Leaf>,
    pub pyramid: Pyramid,
}

impl Cluster {
    /// Reorders `points`, which are not empty.
    fn of(points: &mut [Vec3], d2: f32) -> (Self, Box3) {
        arrange(points);
        let leaves = points.chunks(LEAF).map(|lanes| Leaf::of(lanes, d2)).collect();
        let boxes: Vec<Box3> = points.chunks(LEAF).map(Box3::around).collect();
        let whole = Box3::around_boxes(&boxes);
        (Self { leaves, pyramid: Pyramid::over(boxes, d2) }, whole)
    }
}

/// All points.
#[derive(Clone)]
pub(super) struct PointTree {
    pub clusters: Vec<Cluster>,
    /// Over the clusters.
    pub top: Pyramid,
}

impl PointTree {
    /// `points` is not empty; each starts without a nearest node, at the squared distance `d2`.
    pub fn over(points: &[Vec3], d2: f32, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let given = points;
        let mut points = Vec::with_capacity(given.len());
        for slice in given.chunks(SLICE) {
            monitor.check()?;
            points.extend_from_slice(slice);
        }
        let mut parts = Vec::new();
        let capacity = [CLUSTER, CLUSTER / FAN]
            .into_iter()
            .find(|capacity| points.len() / capacity >= CLUSTERS)
            .unwrap_or(CLUSTER / FAN / FAN);
        part(&mut points, capacity, &mut parts, monitor)?;
        let built: Vec<(Cluster, Box3)> = parts
            .into_par_iter()
            .map(|points| monitor.check().map(|()| Cluster::of(points, d2)))
            .collect::<Result<_, _>>()?;
        let (clusters, boxes): (Vec<_>, Vec<_>) = built.into_iter().unzip();
        Ok(Self { clusters, top: Pyramid::over(boxes, d2) })
    }
}

/// Cuts points into clusters, halving the widest extent at about its median.
fn part<'a>(
    points: &'a mut [Vec3],
    capacity: usize,
    parts: &mut Vec<&'a mut [Vec3]>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    if points.len() <= capacity {
        parts.push(points);
        return Ok(());
    }
    let axis = Box3::watched(points, monitor)?.widest();
    let mut sample: Vec<f32> = points.iter().step_by(points.len().div_ceil(256)).map(|p| p[axis]).collect();
    let middle = sample.len() / 2;
    let (_, &mut median, _) = sample.select_nth_unstable_by(middle, f32::total_cmp);

    // Not the standard selection: one call on ten million points would be deaf to the monitor.
    let mut below = 0;
    for start in (0..points.len()).step_by(SLICE) {
        monitor.check()?;
        for i in start..points.len().min(start + SLICE) {
            let small = points[i][axis] < median;
            points.swap(i, below);
            below += usize::from(small);
        }
    }
    // Many equal coordinates: any halves will do.
    let cut = if below == 0 { points.len() / 2 } else { below };
    let (low, high) = points.split_at_mut(cut);
    if low.len() + high.len() < 4 * CLUSTER {
        part(low, capacity, parts, monitor)?;
        return part(high, capacity, parts, monitor);
    }
    let mut more = Vec::new();
    let (a, b) =
        rayon::join(|| part(low, capacity, parts, monitor), || part(high, capacity, &mut more, monitor));
    parts.append(&mut more);
    a.and(b)
}

/// Sorts the points of one cluster so that each aligned run of `LEAF · FAN^k` lies together.
fn arrange(points: &mut [Vec3]) {
    if points.len() <= LEAF {
        return;
    }
    let mut run = LEAF;
    while run * FAN < points.len() {
        run *= FAN;
    }
    let cut = points.len().div_ceil(run) / 2 * run;
    let axis = Box3::around(points).widest();
    // A comparison for each axis: looking the axis up in each would take a third of the time.
    match axis {
        0 => points.select_nth_unstable_by(cut, |a, b| a.x.total_cmp(&b.x)),
        1 => points.select_nth_unstable_by(cut, |a, b| a.y.total_cmp(&b.y)),
        _ => points.select_nth_unstable_by(cut, |a, b| a.z.total_cmp(&b.z)),
    };
    let (low, high) = points.split_at_mut(cut);
    arrange(low);
    arrange(high);
}

/// An axis-aligned box, metres.
#[derive(Clone, Copy)]
struct Box3 {
    low: Vec3,
    high: Vec3,
}

impl Box3 {
    const EMPTY: Self = Self { low: Vec3::MAX, high: Vec3::MIN };

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| b.union(Self { low: p, high: p }))
    }

    fn around_boxes(boxes: &[Self]) -> Self {
        boxes.iter().fold(Self::EMPTY, |all, &b| all.union(b))
    }

    fn watched(points: &[Vec3], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let mut all = Self::EMPTY;
        for slice in points.chunks(SLICE) {
            monitor.check()?;
            all = all.union(Self::around(slice));
        }
        Ok(all)
    }

    fn widest(self) -> usize {
        let size = self.high - self.low;
        if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        }
    }
}
