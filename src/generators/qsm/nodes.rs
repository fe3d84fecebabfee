//! From rows of cylinders to nodes and their parents.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use linden_base::input::{CylinderRow, Up};
use linden_skeleton::{Branching, Edge, NO_PARENT, WidthSteps};

/// What a node takes here and in lists that go with it.
pub(crate) const BYTES_PER_NODE: u64 = 64;

/// What begins this near to a node begins at it, metres: rounding of four decimals, and of directions.
const AT_NODE_M: f64 = 0.002;

/// Cylinders as nodes.
pub(crate) struct Builder {
    up: Up,
    shift: DVec3,
    steps: WidthSteps,
    branching: Branching,
    radii: Vec<f32>,
    edges: Vec<Edge>,
    /// Whether some row has no number of a branch: then nothing says what goes on.
    lacks_branches: bool,
    /// Whether a node goes on already.
    goes_on: Vec<bool>,
    links: usize,
    links_m: f64,
    /// Of each foot the table's tree, from 0.
    trees: Vec<u32>,
}

impl Builder {
    pub fn new(up: Up, shift: DVec3, steps: WidthSteps) -> Self {
        Self {
            up,
            shift,
            steps,
            branching: Branching::default(),
            radii: Vec::new(),
            edges: Vec::new(),
            lacks_branches: false,
            goes_on: Vec::new(),
            links: 0,
            links_m: 0.0,
            trees: Vec::new(),
        }
    }

    fn turned(&self, p: DVec3) -> DVec3 {
        let mut turned = [p];
        self.up.to_y_up(&mut turned);
        // No zero below zero.
        turned[0] + DVec3::ZERO
    }

    fn node(&mut self, place: Vec3, parent: u32, birth: u32, radius_m: f64, goes_on: bool) -> u32 {
        let node = self.branching.positions.len() as u32;
        let is_free = parent == NO_PARENT || !self.goes_on[parent as usize];
        if goes_on && is_free && parent != NO_PARENT {
            self.goes_on[parent as usize] = true;
        }
        self.branching.positions.push(place);
        self.branching.parents.push(parent);
        self.branching.births.push(birth);
        self.radii.push(radius_m as f32);
        self.edges.push(if goes_on && is_free { Edge::Succeeds } else { Edge::Branches });
        self.goes_on.push(false);
        node
    }

    /// Adds a tree; parents before children.
    pub fn add(&mut self, rows: &[CylinderRow]) {
        let first = self.branching.parents.len();
        if !self.add_numbered(rows) {
            self.add_joined(rows);
        }
        let tree = self.trees.last().map_or(0, |tree| tree + 1);
        let added = &self.branching.parents[first..];
        self.trees.extend(added.iter().filter(|parent| **parent == NO_PARENT).map(|_| tree));
    }

    /// A tree whose nodes have numbers, in their order; `false` where these make no tree.
    fn add_numbered(&mut self, rows: &[CylinderRow]) -> bool {
        let mut ends: BTreeMap<u32, usize> = BTreeMap::new();
        let mut feet: BTreeMap<u32, usize> = BTreeMap::new();
        for (index, row) in rows.iter().enumerate() {
            let Some([lower, upper]) = row.nodes else { return false };
            let is_above = match row.parent {
                Some(parent) => rows[parent as usize].nodes.is_some_and(|[_, end]| end == lower),
                None => true,
            };
            if lower >= upper || !is_above || ends.insert(upper, index).is_some() {
                return false;
            }
            if row.parent.is_none() {
                feet.entry(lower).or_insert(index);
            }
        }
        if feet.keys().any(|foot| ends.contains_key(foot)) {
            return false;
        }
        let mut places: BTreeMap<u32, u32> = BTreeMap::new();
        let all: Vec<u32> = {
            let mut all: Vec<u32> = ends.keys().chain(feet.keys()).copied().collect();
            all.sort_unstable();
            all
        };
        for number in all {
            let node = if let Some(&index) = ends.get(&number) {
                let row = &rows[index];
                let lower = row.nodes.map_or(0, |[lower, _]| lower);
                let parent = places.get(&lower).copied().unwrap_or(NO_PARENT);
                let goes_on = match row.parent {
                    Some(parent) => row.branch == rows[parent as usize].branch,
                    None => feet.get(&lower) == Some(&index),
                };
                self.end(row, parent, goes_on)
            } else {
                let row = &rows[feet[&number]];
                self.foot(row)
            };
            places.insert(number, node);
        }
        true
    }

    /// A tree whose cylinders are joined by their places.
    fn add_joined(&mut self, rows: &[CylinderRow]) {
        let mut feet: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        // The nodes at both ends of each row.
        let mut nodes: Vec<[u32; 2]> = Vec::with_capacity(rows.len());
        for row in rows {
            let lower = match row.parent {
                None => {
                    let key = row.start.to_array().map(f64::to_bits);
                    match feet.get(&key) {
                        Some(&foot) => (foot, !self.goes_on[foot as usize]),
                        None => {
                            let foot = self.foot(row);
                            feet.insert(key, foot);
                            (foot, true)
                        }
                    }
                }
                Some(parent) => {
                    let below = &rows[parent as usize];
                    let goes_on = row.branch == below.branch;
                    let [first, last] = nodes[parent as usize];
                    let (to_first, to_last) =
                        (below.start.distance(row.start), below.end.distance(row.start));
                    // Cylinders that were fitted one by one do not quite meet.
                    let slack = if goes_on { AT_NODE_M.max(below.radius_m) } else { AT_NODE_M };
                    if to_last <= slack {
                        (last, goes_on)
                    } else if to_first <= AT_NODE_M {
                        (first, false)
                    } else {
                        let (node, gap_m) =
                            if to_last <= to_first { (last, to_last) } else { (first, to_first) };
                        self.links += 1;
                        self.links_m += gap_m;
                        let place = self.turned(row.start - self.shift).as_vec3();
                        let birth = self.birth(row, node);
                        (self.node(place, node, birth, row.radius_m, goes_on && node == last), true)
                    }
                }
            };
            let upper = self.end(row, lower.0, lower.1);
            nodes.push([lower.0, upper]);
        }
    }

    fn birth(&self, row: &CylinderRow, parent: u32) -> u32 {
        row.birth.unwrap_or_else(|| self.branching.births[parent as usize].saturating_add(1))
    }

    fn foot(&mut self, row: &CylinderRow) -> u32 {
        let place = self.turned(row.start - self.shift).as_vec3();
        self.node(place, NO_PARENT, 0, self.radii_of(row)[0], true)
    }

    fn end(&mut self, row: &CylinderRow, parent: u32, goes_on: bool) -> u32 {
        self.lacks_branches |= row.branch.is_none();
        let mut place = self.turned(row.end - self.shift).as_vec3();
        if let Some((axis, length_m)) = row.along {
            let from = self.branching.positions[parent as usize];
            place = as_written(from, place, self.turned(axis), length_m);
        }
        let birth = self.birth(row, parent);
        self.node(place, parent, birth, self.radii_of(row)[1], goes_on)
    }

    /// At both ends.
    fn radii_of(&self, row: &CylinderRow) -> [f64; 2] {
        let of_ends = row.end_radii_m.filter(|_| self.steps == WidthSteps::Taper);
        of_ends.unwrap_or([row.radius_m; 2])
    }

    pub fn note(&self) -> Option<String> {
        (self.links > 0).then(|| {
            format!(
                "{} cylinders begin away from the ends of those below: segments of their own radius join them, {:.2} m in all",
                self.links, self.links_m
            )
        })
    }

    /// Of each foot the table's tree, from 0.
    pub fn trees(&self) -> &[u32] {
        &self.trees
    }

    pub fn finish(self) -> Branching {
        let Self { mut branching, radii, edges, lacks_branches, .. } = self;
        branching.radii = Some(radii);
        branching.edges = (!lacks_branches).then_some(edges);
        branching
    }
}

/// The place of single precision next to `place` from which direction and length are those that were written: a table of
/// ours then comes out as it went in.
fn as_written(from: Vec3, place: Vec3, axis: DVec3, length_m: f64) -> Vec3 {
    let (axis, length_m) = (axis.as_vec3(), length_m as f32);
    let off = |end: Vec3| {
        let turn = ((end - from).normalize_or(Vec3::Y) - axis).abs();
        let stretch = (end.distance(from) - length_m).abs();
        f64::from(turn.element_sum()) + f64::from(stretch)
    };
    let steps = |x: f32| [x, x.next_up(), x.next_down(), x.next_up().next_up(), x.next_down().next_down()];
    let (mut best, mut least) = (place, off(place));
    for x in steps(place.x) {
        for y in steps(place.y) {
            for z in steps(place.z) {
                let end = Vec3::new(x, y, z);
                let here = off(end);
                if here < least {
                    (best, least) = (end, here);
                }
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use Edge::{Branches, Succeeds};

    fn row(parent: Option<u32>, start: [f64; 3], end: [f64; 3], branch: i64) -> CylinderRow {
        CylinderRow {
            parent,
            start: start.into(),
            end: end.into(),
            along: None,
            radius_m: 0.1,
            end_radii_m: None,
            branch: Some(branch),
            birth: None,
            nodes: None,
        }
    }

    #[test]
    fn what_begins_on_the_bark_is_joined_to_the_nearest_end() {
        let rows = [
            row(None, [0.0; 3], [0.0, 0.0, 2.0], 1),
            // On the bark, 0.3 m below the upper end.
            row(Some(0), [0.1, 0.0, 1.7], [1.1, 0.0, 1.7], 2),
            // At the upper end, but for rounding.
            row(Some(0), [0.0, 0.0, 2.0005], [0.0, 0.0, 3.0], 1),
        ];
        let mut builder = Builder::new(Up::Z, DVec3::ZERO, WidthSteps::Cylinder);
        builder.add(&rows);
        assert_eq!((builder.links, (builder.links_m - 0.1f64.hypot(0.3)).abs() < 1e-12), (1, true));
        let branching = builder.finish();
        branching.validate().unwrap();
        assert_eq!(branching.parents, [NO_PARENT, 0, 1, 2, 1]);
        assert_eq!(branching.positions[3], Vec3::new(1.1, 1.7, 0.0));
        assert_eq!(branching.edges.unwrap(), [Succeeds, Succeeds, Branches, Succeeds, Succeeds]);
    }
}
