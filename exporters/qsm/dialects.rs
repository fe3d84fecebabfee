//! The tables of other programs: the columns that their readers go by, metres, Z up.
//!
//! | dialect | columns | several trees |
//! |---|---|---|
//! | simpleforest | those of `SimpleForest`'s detailed table up to `treeID`, `, ` between; parent −1: none | `treeID`; ids go on |
//! | treeqsm | `TreeQSM`'s text (`save_model_text.m`), tabs; parent 0: none | one after the other: each a stem more |
//! | raycloudtools | `x,y,z,radius,parent_id`, `, ` between segments | a line each, also each stem of a stool |
//! | archi | those of aRchi's QSM, and `axisX` … `branch_ID`, which rTwig asks for; parent 0: none | one after the other |
//!
//! What was never fitted has no `mad` and no `SurfCov`: 0 and 1 are written.

use linden_pipeline::skeleton::{Cylinder, NO_PARENT, Skeleton};
use linden_pipeline::stage::Place;

use super::placed;
use crate::writing::records::Text;

/// A dialect of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    SimpleForest,
    TreeQsm,
    Raycloudtools,
    Archi,
}

/// All words of the option, ours first.
pub(super) const WORDS: &[&str] = &["linden", "simpleforest", "treeqsm", "raycloudtools", "archi"];

impl Dialect {
    /// Of a word; `None` for ours.
    pub fn of(word: &str) -> Option<Self> {
        match word {
            "simpleforest" => Some(Self::SimpleForest),
            "treeqsm" => Some(Self::TreeQsm),
            "raycloudtools" => Some(Self::Raycloudtools),
            "archi" => Some(Self::Archi),
            _ => None,
        }
    }

    /// Whether a line is its header.
    pub fn heads(self, line: &[u8]) -> bool {
        self.header().trim_end().as_bytes() == line.trim_ascii_end()
    }

    pub const fn header(self) -> &'static str {
        match self {
            Self::SimpleForest => {
                "type, ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, volume, growthVolume, length, \
                 growthLength, segmentID, parentSegmentID, segmentMedianRadius, segmentGrowthVolume, \
                 segmentGrowthLength, branchOrder, reverseBranchOrder, reversePipeBranchorder, \
                 reverseSummedBranchOrder, branchID, treeID\n"
            }
            Self::TreeQsm => {
                "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\t\
                 position_in_branch\tmad\tSurfCov\tadded\tUnmodRadius (m)\n"
            }
            Self::Raycloudtools => "x,y,z,radius,parent_id\n",
            Self::Archi => {
                "startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,extension_ID,radius_cyl,length,volume,axis_ID,\
                 segment_ID,node_ID,branching_order,axisX,axisY,axisZ,branch_ID\n"
            }
        }
    }
}

/// What earlier trees of the file have taken.
#[derive(Clone, Copy, Default)]
pub(super) struct Taken {
    pub cylinders: u32,
    pub branches: u32,
    pub segments: u32,
}

/// One tree's cylinders, with what the dialects say of them besides.
pub(super) struct Sheet {
    pub cylinders: Vec<Cylinder>,
    pub orders: Vec<u32>,
    /// Where each ends.
    ends: Vec<[f32; 3]>,
    /// The next of its axis.
    pub extensions: Vec<Option<u32>>,
    /// The run between forks that each is of, from 0 in the order of the first cylinders.
    segments: Vec<u32>,
    /// The first and the middle cylinder of each run.
    runs: Vec<[u32; 2]>,
    /// Length and volume of each and of all above.
    growth: Vec<[f64; 2]>,
    /// Of each run, 1 at the tips: by the longest way to one, and by the sum of what it bears.
    reverse: Vec<[u32; 2]>,
}

pub(super) fn z_up(p: [f32; 3]) -> [f32; 3] {
    // No zero below zero.
    [p[0] + 0.0, 0.0 - p[2], p[1] + 0.0]
}

impl Sheet {
    pub fn new(skeleton: &Skeleton, place: &Place) -> Self {
        let cylinders: Vec<Cylinder> = skeleton.cylinders().into_iter().map(|c| placed(c, place)).collect();
        let orders = cylinders.iter().map(|c| skeleton.axes[c.axis as usize].order).collect();
        let motion = place.motion();
        let end = |c: &Cylinder| {
            let at = skeleton.positions[c.node as usize];
            motion.as_ref().map_or(at, |motion| motion.point(at)).to_array()
        };
        let ends = cylinders.iter().map(end).collect();
        let mut children = vec![0_u32; cylinders.len()];
        let mut extensions = vec![None; cylinders.len()];
        for (index, cylinder) in (0_u32..).zip(&cylinders) {
            let Some(parent) = cylinder.parent else { continue };
            children[parent as usize] += 1;
            if cylinders[parent as usize].axis == cylinder.axis {
                extensions[parent as usize] = Some(index);
            }
        }
        let mut segments: Vec<u32> = Vec::with_capacity(cylinders.len());
        let mut members: Vec<Vec<u32>> = Vec::new();
        for (index, cylinder) in (0_u32..).zip(&cylinders) {
            let below = cylinder.parent.filter(|&parent| children[parent as usize] == 1);
            let segment = below.map_or(members.len() as u32, |parent| segments[parent as usize]);
            if segment as usize == members.len() {
                members.push(Vec::new());
            }
            members[segment as usize].push(index);
            segments.push(segment);
        }
        let runs: Vec<[u32; 2]> = members.iter().map(|all| [all[0], all[all.len() / 2]]).collect();
        let mut growth: Vec<[f64; 2]> =
            cylinders.iter().map(|c| [f64::from(c.length_m), c.volume_m3()]).collect();
        let mut reverse = vec![[0_u32; 2]; runs.len()];
        for (index, cylinder) in cylinders.iter().enumerate().rev() {
            let run = segments[index] as usize;
            if children[index] == 0 {
                reverse[run] = [1, 1];
            }
            let Some(parent) = cylinder.parent else { continue };
            let parent = parent as usize;
            let [length_m, volume_m3] = growth[index];
            growth[parent] = [growth[parent][0] + length_m, growth[parent][1] + volume_m3];
            let below = segments[parent] as usize;
            if below != run {
                let [by_way, by_sum] = reverse[run];
                reverse[below] =
                    [reverse[below][0].max(by_way + 1), reverse[below][1].saturating_add(by_sum)];
            }
        }
        Self { cylinders, orders, ends, extensions, segments, runs, growth, reverse }
    }

    /// The most that one takes, with its lines, while it is made.
    pub fn bytes(nodes: usize) -> u64 {
        const PER_NODE: u64 = 320;
        nodes as u64 * PER_NODE
    }

    pub fn len(&self) -> usize {
        self.cylinders.len()
    }

    /// What the next tree finds taken.
    pub fn after(&self, taken: Taken) -> Taken {
        let branches = self.cylinders.iter().map(|c| c.axis + 1).max().unwrap_or(0);
        Taken {
            cylinders: taken.cylinders + self.cylinders.len() as u32,
            branches: taken.branches + branches,
            segments: taken.segments + self.runs.len() as u32,
        }
    }

    /// One row of a dialect with rows.
    pub fn row(&self, dialect: Dialect, text: &mut Text, index: usize, taken: Taken, tree: u32) {
        match dialect {
            Dialect::SimpleForest => self.simple_forest(text, index, taken, tree),
            Dialect::TreeQsm => self.tree_qsm(text, index, taken),
            Dialect::Archi => self.archi(text, index, taken),
            Dialect::Raycloudtools => {}
        }
    }

    fn simple_forest(&self, text: &mut Text, index: usize, taken: Taken, tree: u32) {
        let cylinder = &self.cylinders[index];
        let run = self.segments[index] as usize;
        let [first, middle] = self.runs[run].map(|at| at as usize);
        text.bytes(b"cylinder");
        integers(text, b", ", &[taken.cylinders + index as u32 + 1]);
        parent(text, b", ", cylinder.parent.map(|parent| taken.cylinders + parent + 1), b"-1");
        for place in [cylinder.start.to_array(), self.ends[index]] {
            floats(text, b", ", &z_up(place));
        }
        let [growth_m, growth_m3] = self.growth[index];
        let of_run = self.growth[middle];
        let volume_m3 = cylinder.volume_m3() as f32;
        floats(
            text,
            b", ",
            &[cylinder.radius_m, volume_m3, growth_m3 as f32, cylinder.length_m, growth_m as f32],
        );
        integers(text, b", ", &[taken.segments + run as u32 + 1]);
        let below = self.cylinders[first].parent.map(|parent| self.segments[parent as usize]);
        parent(text, b", ", below.map(|below| taken.segments + below + 1), b"-1");
        floats(text, b", ", &[self.cylinders[middle].radius_m, of_run[1] as f32, of_run[0] as f32]);
        let [by_way, by_sum] = self.reverse[run];
        // The pipe's order is the root of the pipes that a run bears.
        let pipes = (f64::from(by_sum)).sqrt() as f32;
        integers(text, b", ", &[self.orders[index], by_way]);
        floats(text, b", ", &[pipes]);
        integers(text, b", ", &[by_sum, taken.branches + cylinder.axis + 1, tree]);
        text.byte(b'\n');
    }

    fn tree_qsm(&self, text: &mut Text, index: usize, taken: Taken) {
        let cylinder = &self.cylinders[index];
        let tab = b"\t";
        text.float(cylinder.radius_m);
        floats(text, tab, &[cylinder.length_m]);
        floats(text, tab, &z_up(cylinder.start.to_array()));
        floats(text, tab, &z_up(cylinder.direction.to_array()));
        let id = |place: Option<u32>| place.map_or(0, |place| taken.cylinders + place + 1);
        integers(
            text,
            tab,
            &[
                id(cylinder.parent),
                id(self.extensions[index]),
                taken.branches + cylinder.axis + 1,
                self.orders[index],
                cylinder.place + 1,
                0,
                1,
                0,
            ],
        );
        floats(text, tab, &[cylinder.radius_m]);
        text.byte(b'\n');
    }

    fn archi(&self, text: &mut Text, index: usize, taken: Taken) {
        let cylinder = &self.cylinders[index];
        text.floats(z_up(cylinder.start.to_array()), b",");
        floats(text, b",", &z_up(self.ends[index]));
        let id = |place: Option<u32>| place.map_or(0, |place| taken.cylinders + place + 1);
        integers(
            text,
            b",",
            &[taken.cylinders + index as u32 + 1, id(cylinder.parent), id(self.extensions[index])],
        );
        floats(text, b",", &[cylinder.radius_m, cylinder.length_m, cylinder.volume_m3() as f32]);
        let [first, _] = self.runs[self.segments[index] as usize];
        let segment = taken.segments + self.segments[index] + 1;
        // A segment begins at the node where its first cylinder does: the last cylinder below it.
        let node = id(self.cylinders[first as usize].parent);
        let branch = taken.branches + cylinder.axis + 1;
        integers(text, b",", &[branch, segment, node, self.orders[index]]);
        floats(text, b",", &z_up(cylinder.direction.to_array()));
        integers(text, b",", &[branch]);
        text.byte(b'\n');
    }

    /// The lines of raycloudtools: one for each stem, its segments one after another.
    pub fn lines(&self, skeleton: &Skeleton, place: &Place, text: &mut Text) {
        // The foot below each cylinder, and its number in the line of that.
        let mut feet: Vec<u32> = Vec::with_capacity(self.cylinders.len());
        for cylinder in &self.cylinders {
            feet.push(match cylinder.parent {
                Some(parent) => feet[parent as usize],
                None => cylinder.parent_node,
            });
        }
        let mut order: Vec<u32> = (0..self.cylinders.len() as u32).collect();
        // By nodes, of which parents come first, and not by axes, which the file does not say: whoever reads it finds the same order.
        order.sort_by_key(|&index| (feet[index as usize], self.cylinders[index as usize].node));
        let mut numbers = vec![0_u32; self.cylinders.len()];
        for line in order.chunk_by(|&a, &b| feet[a as usize] == feet[b as usize]) {
            let foot = feet[line[0] as usize] as usize;
            debug_assert_eq!(skeleton.parents[foot], NO_PARENT);
            let motion = place.motion();
            let at = skeleton.positions[foot];
            let at = motion.as_ref().map_or(at, |motion| motion.point(at));
            text.floats(z_up(at.to_array()), b",");
            floats(text, b",", &[skeleton.radii[foot] * place.scale]);
            text.bytes(b",-1");
            for (number, &index) in (1..).zip(line) {
                let index = index as usize;
                numbers[index] = number;
                floats(text, b", ", &z_up(self.ends[index])[..1]);
                let [_, y, z] = z_up(self.ends[index]);
                let cylinder = &self.cylinders[index];
                floats(text, b",", &[y, z, cylinder.radius_m]);
                integers(text, b",", &[cylinder.parent.map_or(0, |parent| numbers[parent as usize])]);
            }
            text.byte(b'\n');
        }
    }
}

fn parent<const B: usize>(text: &mut Text, before: &[u8; B], id: Option<u32>, none: &[u8]) {
    match id {
        Some(id) => integers(text, before, &[id]),
        None => {
            text.bytes(before);
            text.slice(none);
        }
    }
}

fn integers<const B: usize>(text: &mut Text, before: &[u8; B], numbers: &[u32]) {
    for &number in numbers {
        text.bytes(before);
        text.integer(number);
    }
}

fn floats<const B: usize>(text: &mut Text, before: &[u8; B], numbers: &[f32]) {
    for &number in numbers {
        text.bytes(before);
        text.float(number);
    }
}
