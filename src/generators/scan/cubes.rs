//! Points by the cubes of a grid: thinning, and what hardly any points are near.

use glam::DVec3;

use super::retain_unmarked;
use super::z_order;

/// Fewer points near a cube, its own among them, are noise;
const LEAST_NEAR: u32 = 3;

/// in a dense cloud fewer than this part of the median.
const NEAR_PART: f64 = 0.02;

/// See [`Cubes::noise`].
const MOST_NOISE: u64 = 25;

/// The mean of the points in each cube of a grid, in its Z-order.
pub(super) fn thin(points: &[DVec3], cube_m: f64) -> Vec<DVec3> {
    Cubes::new(points, cube_m).means
}

/// Points by the cubes of a grid.
pub(super) struct Cubes {
    /// Of the points in each cube that holds any, in the Z-order of cubes.
    pub means: Vec<DVec3>,
    /// Indices of points, cube by cube.
    pub members: Vec<u32>,
    /// Where each cube's members end.
    pub ends: Vec<u32>,
}

impl Cubes {
    /// Cubes `cube_m` metres long; longer ones where more than two million would stand in a row.
    pub fn new(points: &[DVec3], cube_m: f64) -> Self {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let cube_m = cube_m.max((high - low).max_element() / z_order::MOST);
        let number = |p: &DVec3| z_order::number((*p - low) / cube_m);
        let mut order: Vec<(u64, u32)> = points.iter().map(number).zip(0..).collect();
        z_order::sort(&mut order);
        let mean = |same: &[(u64, u32)]| {
            same.iter().map(|&(_, i)| points[i as usize]).sum::<DVec3>() / same.len() as f64
        };
        let mut end = 0;
        let (means, ends) = order
            .chunk_by(|a, b| a.0 == b.0)
            .map(|same| {
                end += same.len() as u32;
                (mean(same), end)
            })
            .unzip();
        Self { means, members: order.iter().map(|&(_, i)| i).collect(), ends }
    }

    /// The points in a cube.
    pub fn count(&self, cube: usize) -> u32 {
        self.ends[cube] - if cube == 0 { 0 } else { self.ends[cube - 1] }
    }

    /// Puts the points, and what is known of each, into the order of the cubes.
    pub fn order(&mut self, points: &mut Vec<DVec3>, marks: Option<&mut Vec<bool>>) {
        *points = self.members.iter().map(|&i| points[i as usize]).collect();
        if let Some(marks) = marks {
            *marks = self.members.iter().map(|&i| marks[i as usize]).collect();
        }
        self.members = (0..points.len() as u32).collect();
    }

    /// Radius outlier removal: the cubes that hardly any points are near, given how many are. `None` where there are none, and
    /// for a cloud that would lose more than one point in [`MOST_NOISE`]: it is thin, not noisy.
    pub fn noise(&self, near: &[u32]) -> Option<Vec<bool>> {
        let mut sorted = near.to_vec();
        let middle = sorted.len() / 2;
        let median = if sorted.is_empty() { 0 } else { *sorted.select_nth_unstable(middle).1 };
        let least = LEAST_NEAR.max((NEAR_PART * f64::from(median)) as u32);
        let lost: u64 = (0..near.len()).filter(|&c| near[c] < least).map(|c| u64::from(self.count(c))).sum();
        let is_noisy = lost > 0 && lost * MOST_NOISE <= self.members.len() as u64;
        is_noisy.then(|| near.iter().map(|&near| near < least).collect())
    }

    /// Takes out the cubes that are marked, and their points. These stand in the [order](Self::order) of the cubes.
    pub fn drop_marked(
        &mut self,
        is_marked: &[bool],
        points: &mut Vec<DVec3>,
        marks: Option<&mut Vec<bool>>,
    ) {
        let of_points: Vec<bool> = (0..is_marked.len())
            .flat_map(|c| std::iter::repeat_n(is_marked[c], self.count(c) as usize))
            .collect();
        retain_unmarked(points, &of_points);
        if let Some(marks) = marks {
            retain_unmarked(marks, &of_points);
        }
        self.members.truncate(points.len());
        let (mut start, mut stays) = (0, 0);
        for (end, &is_marked) in self.ends.iter_mut().zip(is_marked) {
            stays += if is_marked { 0 } else { *end - start };
            start = std::mem::replace(end, stays);
        }
        retain_unmarked(&mut self.ends, is_marked);
        retain_unmarked(&mut self.means, is_marked);
    }

    /// For each of some nodes whether more than half of its points are so; `nodes` are means of cubes in their order, some of
    /// which may be missing.
    pub fn most(&self, nodes: &[DVec3], is_so: &[bool]) -> Vec<bool> {
        let mut left = nodes.iter().peekable();
        let mut start = 0;
        let mut of_nodes = Vec::with_capacity(nodes.len());
        for (mean, &end) in self.means.iter().zip(&self.ends) {
            if left.next_if(|node| *node == mean).is_some() {
                let members = &self.members[start as usize..end as usize];
                let so = members.iter().filter(|&&i| is_so[i as usize]).count();
                of_nodes.push(2 * so > members.len());
            }
            start = end;
        }
        of_nodes
    }

    /// Takes the points of cubes that are leaves out of a list; the others keep their order. `nodes` are means of cubes in
    /// their order, some of which may be missing; what those stand for goes as well.
    pub fn keep_wood(&self, points: &mut Vec<DVec3>, nodes: &[DVec3], is_leaf: &[bool]) {
        let mut is_wood = vec![false; points.len()];
        let mut left = nodes.iter().zip(is_leaf).peekable();
        let mut start = 0;
        for (mean, &end) in self.means.iter().zip(&self.ends) {
            if let Some((_, leaf)) = left.next_if(|(node, _)| *node == mean) {
                for &i in &self.members[start as usize..end as usize] {
                    is_wood[i as usize] = !leaf;
                }
            }
            start = end;
        }
        let mut marks = is_wood.iter();
        points.retain(|_| marks.next().is_some_and(|&wood| wood));
    }
}
