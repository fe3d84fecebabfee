//! Names of axes: `stem/12/3`, the third lateral of the stem's twelfth.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use linden_base::knob::excerpt;
use linden_base::memory::bytes_of;
use linden_base::mesh::Bounds;
use xxhash_rust::xxh3::Xxh3;

use crate::{NO_PARENT, Skeleton};

/// The most laterals of laterals that a path may go through: more than any tree has orders.
const MOST_STEPS: usize = 4096;

/// The place of an axis in the tree: a stem, and which lateral to take from there on, each counted from 1 at the
/// base of its parent (of those that leave at one node, as the tree grew them). Epicormic shoots and dead twigs are
/// counted after all that grew, so that another number of them moves no path of a limb.
///
/// `stem` is the first stem, `stem2` the second. `new`, `new2` … are the axes that the first, second … edit
/// that adds wood adds.
///
/// ```
/// use linden_skeleton::edit::AxisPath;
/// let path: AxisPath = "stem/12/3".parse()?;
/// assert_eq!(path.to_string(), "stem/12/3");
/// assert_eq!(path.parent().map(|parent| parent.to_string()), Some("stem/12".to_owned()));
/// assert!("stem/0".parse::<AxisPath>().is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AxisPath {
    /// Where it starts.
    pub root: AxisRoot,
    /// Which lateral to take, from 1, one after the other.
    pub laterals: Vec<u32>,
}

/// Where a path starts; numbers count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AxisRoot {
    /// A stem of the tree as grown.
    Stem(u32),
    /// What an edit added: 1 is the first edit that adds something.
    New(u32),
}

impl AxisPath {
    /// The first stem.
    pub const STEM: Self = Self { root: AxisRoot::Stem(1), laterals: Vec::new() };

    /// The path of the axis that this one leaves from; `None` for where a path starts.
    pub fn parent(&self) -> Option<Self> {
        let (_, laterals) = self.laterals.split_last()?;
        Some(Self { root: self.root, laterals: laterals.to_vec() })
    }

    /// The path of a lateral, from 1, of this one.
    #[must_use]
    pub fn lateral(&self, number: u32) -> Self {
        let mut laterals = self.laterals.clone();
        laterals.push(number);
        Self { root: self.root, laterals }
    }
}

impl fmt::Display for AxisPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.root {
            AxisRoot::Stem(1) => f.write_str("stem")?,
            AxisRoot::Stem(number) => write!(f, "stem{number}")?,
            AxisRoot::New(1) => f.write_str("new")?,
            AxisRoot::New(number) => write!(f, "new{number}")?,
        }
        self.laterals.iter().try_for_each(|lateral| write!(f, "/{lateral}"))
    }
}

impl FromStr for AxisPath {
    type Err = String;

    /// Reads what [`fmt::Display`] writes.
    fn from_str(text: &str) -> Result<Self, String> {
        let path = || {
            let mut words = text.trim().split('/');
            let root = words.next()?;
            let count = |digits: &str| if digits.is_empty() { Some(1) } else { number(digits) };
            let root = match root.strip_prefix("stem") {
                Some(digits) => AxisRoot::Stem(count(digits)?),
                None => AxisRoot::New(count(root.strip_prefix("new")?)?),
            };
            let laterals = words.take(MOST_STEPS + 1).map(number).collect::<Option<Vec<u32>>>()?;
            (laterals.len() <= MOST_STEPS).then_some(Self { root, laterals })
        };
        path().ok_or_else(|| {
            format!(
                "'{}' is no axis; expected one like stem, stem/12 or stem2/4/1 (the first lateral of the fourth \
                 of the second stem), or new for what an edit added",
                excerpt(text)
            )
        })
    }
}

/// A number from 1, without a sign.
fn number(digits: &str) -> Option<u32> {
    let is_plain = digits.bytes().all(|byte| byte.is_ascii_digit()) && !digits.starts_with('0');
    digits.parse().ok().filter(|_| is_plain)
}

/// The paths of all axes of a skeleton, and the way back.
#[derive(Clone, Debug)]
pub struct AxisPaths {
    stems: Vec<u32>,
    /// Laterals of all axes, axis by axis, from the base up; side wood after what grew.
    laterals: Vec<u32>,
    /// Where those of each axis end in `laterals`.
    ends: Vec<u32>,
    /// Parent axis of each axis, [`NO_PARENT`] of stems.
    parents: Vec<u32>,
    /// For each axis its number among the laterals of its parent, or among stems, from 1.
    numbers: Vec<u32>,
    /// Of each axis whether it is side wood.
    are_side_wood: Vec<bool>,
}

impl AxisPaths {
    /// Finds those of a skeleton.
    pub fn new(skeleton: &Skeleton) -> Self {
        let count = skeleton.axes.len();
        // Where each node stands in the list of all axes' nodes: it rises from the base of an axis to its apex.
        let mut places = vec![0_u32; skeleton.axis_nodes.len()];
        for (place, &node) in (0..).zip(&skeleton.axis_nodes) {
            places[node as usize] = place;
        }
        let axis_of = skeleton.axis_of_nodes();
        let (mut stems, mut leaving, mut parents) = (Vec::new(), Vec::new(), vec![NO_PARENT; count]);
        for (index, axis) in (0_u32..).zip(&skeleton.axes) {
            if axis.parent == NO_PARENT {
                stems.push(index);
            } else {
                parents[index as usize] = axis_of[axis.parent as usize];
                let is_side_wood = skeleton.is_side_wood(index as usize);
                leaving.push((is_side_wood, places[axis.parent as usize], index));
            }
        }
        drop((axis_of, places));
        leaving.sort_unstable();
        let (mut ends, mut numbers) = (vec![0_u32; count], vec![0_u32; count]);
        for (number, &stem) in (1..).zip(&stems) {
            numbers[stem as usize] = number;
        }
        for &(.., lateral) in &leaving {
            let parent = parents[lateral as usize] as usize;
            ends[parent] += 1;
            numbers[lateral as usize] = ends[parent];
        }
        // Nodes stand axis by axis, and so do the laterals that leave there; but axes may stand in any order.
        let mut by_axis: Vec<u32> = leaving.iter().map(|&(.., lateral)| lateral).collect();
        by_axis.sort_by_key(|&lateral| parents[lateral as usize]);
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum;
        }
        let are_side_wood = (0..count).map(|axis| skeleton.is_side_wood(axis)).collect();
        Self { stems, laterals: by_axis, ends, parents, numbers, are_side_wood }
    }

    /// The laterals of an axis from its base up, side wood after what grew, as indices of [`Skeleton::axes`].
    pub fn laterals(&self, axis: u32) -> &[u32] {
        let axis = axis as usize;
        let Some(&end) = self.ends.get(axis) else { return &[] };
        let first = if axis == 0 { 0 } else { self.ends[axis - 1] };
        &self.laterals[first as usize..end as usize]
    }

    /// The axis that an axis leaves from; `None` for a stem.
    pub fn parent(&self, axis: u32) -> Option<u32> {
        self.parents.get(axis as usize).copied().filter(|&parent| parent != NO_PARENT)
    }

    /// The path of an axis; `None` where there is no such axis.
    pub fn path(&self, axis: u32) -> Option<AxisPath> {
        let mut laterals = Vec::new();
        let (mut axis, mut number) = (axis, *self.numbers.get(axis as usize)?);
        while let Some(parent) = self.parent(axis) {
            laterals.push(number);
            axis = parent;
            number = self.numbers[axis as usize];
        }
        laterals.reverse();
        Some(AxisPath { root: AxisRoot::Stem(number), laterals })
    }

    /// The axis of a path; `None` where the tree has none.
    pub fn find(&self, path: &AxisPath) -> Option<u32> {
        self.follow(path).ok()
    }

    /// The axis of a path, or the last one on the way and how many steps led there.
    pub(super) fn follow(&self, path: &AxisPath) -> Result<u32, (Option<u32>, usize)> {
        let nth = |list: &[u32], number: u32| list.get((number as usize).checked_sub(1)?).copied();
        let AxisRoot::Stem(stem) = path.root else { return Err((None, 0)) };
        let mut axis = nth(&self.stems, stem).ok_or((None, 0))?;
        for (steps, &number) in path.laterals.iter().enumerate() {
            axis = nth(self.laterals(axis), number).ok_or((Some(axis), steps))?;
        }
        Ok(axis)
    }

    /// How many stems there are.
    pub fn stems(&self) -> usize {
        self.stems.len()
    }

    /// A fingerprint of how axes bear axes, wherever they are: equal where each axis has as many laterals as
    /// before, so that all paths mean the same axes. Side wood does not count.
    pub fn fingerprint(&self) -> u32 {
        let mut hasher = Xxh3::new();
        let mut open: Vec<u32> = self.stems.iter().rev().copied().collect();
        hasher.update(&(self.stems.len() as u64).to_le_bytes());
        while let Some(axis) = open.pop() {
            let laterals = self.laterals(axis);
            let grown = laterals.partition_point(|&lateral| !self.are_side_wood[lateral as usize]);
            let laterals = &laterals[..grown];
            hasher.update(&(laterals.len() as u32).to_le_bytes());
            open.extend(laterals.iter().rev());
        }
        hasher.digest() as u32
    }

    /// Bytes that those of a skeleton take at most while they are found.
    pub fn bytes_for(skeleton: &Skeleton) -> u64 {
        bytes_of::<[u32; 2]>(skeleton.axis_nodes.len()) + bytes_of::<[u32; 9]>(skeleton.axes.len())
    }
}

impl Skeleton {
    /// The path of one axis. Those of many are had from [`AxisPaths`], which looks through the tree once.
    pub fn axis_path(&self, axis: u32) -> Option<AxisPath> {
        AxisPaths::new(self).path(axis)
    }

    /// The axis of a path.
    pub fn find_axis(&self, path: &AxisPath) -> Option<u32> {
        AxisPaths::new(self).find(path)
    }

    /// The place that tells an axis from others, metres: its first node, of a stem its foot.
    pub fn beginning(&self, axis: u32) -> Option<DVec3> {
        let first = self.nodes_of(self.axes.get(axis as usize)?).first()?;
        Some(self.positions[*first as usize].as_dvec3())
    }

    /// The length of an axis from where it leaves, metres.
    pub fn axis_length_m(&self, axis: u32) -> f64 {
        let nodes = self.axes.get(axis as usize).map_or(&[][..], |axis| self.nodes_of(axis));
        nodes.iter().map(|&node| self.segment_length(node as usize)).sum()
    }
}

/// How far the beginning of an axis may be from where it was, in lengths of the axis.
const NEAR_PER_LENGTH: f64 = 0.05;
/// The same in sizes of the tree.
const NEAR_PER_TREE: f64 = 0.005;

/// Finds axes that edits name, also where the tree is not quite the one that they were made for.
pub(super) struct Finder<'a> {
    skeleton: &'a Skeleton,
    pub paths: AxisPaths,
    fingerprint: u32,
    size_m: f64,
    /// Axes that were added, with their paths.
    pub added: BTreeMap<AxisPath, u32>,
}

/// Why an axis was not found.
pub(super) enum Missing {
    /// The last axis on the way bears this many laterals; `None`: no such stem.
    Count(Option<(AxisPath, usize)>),
    /// It was not added, or not by an edit before this one.
    NotAdded,
    /// None begins near enough to the place.
    Elsewhere {
        /// How near one of the order would have to begin, metres.
        within_m: f64,
    },
}

impl<'a> Finder<'a> {
    pub fn new(skeleton: &'a Skeleton) -> Self {
        let paths = AxisPaths::new(skeleton);
        let size = Bounds::of(skeleton.positions.iter().copied()).map_or(0.0, |b| b.size().max_element());
        let fingerprint = paths.fingerprint();
        Self { skeleton, paths, fingerprint, size_m: size.into(), added: BTreeMap::new() }
    }

    /// The axis of a path. Where the branching is not the one that the edit was made for, the axis of that order
    /// which begins nearest to where it began then, if it is near enough; without a place, the path alone.
    pub fn find(
        &self,
        path: &AxisPath,
        near: Option<[f64; 3]>,
        branching: Option<u32>,
    ) -> Result<u32, Missing> {
        if let AxisRoot::New(_) = path.root {
            return self.added.get(path).copied().ok_or(Missing::NotAdded);
        }
        let found = self.paths.follow(path);
        let is_known = branching == Some(self.fingerprint)
            && !found.is_ok_and(|axis| self.paths.are_side_wood[axis as usize]);
        let Some(near) = near.map(DVec3::from).filter(|_| !is_known) else {
            return found.map_err(|(last, steps)| {
                Missing::Count(last.map(|axis| {
                    let way = AxisPath { root: path.root, laterals: path.laterals[..steps].to_vec() };
                    (way, self.paths.laterals(axis).len())
                }))
            });
        };
        let order = path.laterals.len() as u32;
        let within_m = |axis: u32| {
            let length_m = self.skeleton.axis_length_m(axis);
            (NEAR_PER_LENGTH * length_m).min(NEAR_PER_TREE * self.size_m)
        };
        let of_order = (0_u32..).zip(&self.skeleton.axes).filter(|(_, axis)| axis.order == order);
        let distances = of_order.filter_map(|(index, _)| {
            let distance_m = self.skeleton.beginning(index)?.distance(near);
            (distance_m <= within_m(index)).then_some((distance_m, found != Ok(index), index))
        });
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        nearest.map(|(_, _, axis)| axis).ok_or(Missing::Elsewhere { within_m: NEAR_PER_TREE * self.size_m })
    }
}
