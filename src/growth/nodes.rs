//! The growing nodes: where they are and what they grow next.

use glam::{DVec3, Vec3};

use super::axes::Axes;
use super::influence::Influences;
use super::lists::reserve;
use super::obstacle::{self, Obstacle};
use super::{Attraction, GrowthRule, NONE};
use linden_skeleton::{Branching, NO_PARENT};

/// What is left of a unit vector when something of about the same length cancels it.
const VANISHING: f64 = 1e-9;

/// Of a node: 24 are the result, 36 serve growth, and a little for the sets that it may stand in.
const BYTES: u64 = 64;
/// More for habits that ask for its place on the axes; each may begin one.
const AXES_BYTES: u64 = 17;
/// More for [`Attraction::All`].
const SURROUNDINGS_BYTES: u64 = 32;
/// For [`Attraction::All`], of a node that has points of its own: its pulls while they are gathered, in a list
/// of each chunk and then in one of all.
const GATHERED_BYTES: u64 = 80;
/// Nodes, 60 bytes each: 24 are the result, 36 serve growth. Habits may need more.
pub(super) struct Nodes<'a> {
    pub branching: Branching,
    pub influences: Influences,
    rule: &'a GrowthRule,
    obstacles: &'a [Obstacle<'a>],
    axes: Option<Axes>,
    /// The last child of each node, or [`NONE`].
    youngest: Vec<u32>,
    /// The child that the same parent grew before, or [`NONE`].
    elder: Vec<u32>,
}

/// What comes of a node that is asked to grow.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Shoot {
    /// A child at this place.
    Child(Vec3),
    /// Nothing: no direction, or no new place.
    Nothing,
    /// Nothing, because of an obstacle or of the children that there are.
    Blocked,
}

impl<'a> Nodes<'a> {
    /// Parents of `start` come before their children.
    pub fn new(start: &Branching, rule: &'a GrowthRule, obstacles: &'a [Obstacle<'a>]) -> Self {
        let mut nodes = Self {
            branching: Branching { radii: None, edges: None, ..start.clone() },
            influences: Influences::default(),
            rule,
            obstacles,
            axes: rule.habit.needs_axes().then(Axes::default),
            youngest: Vec::new(),
            elder: Vec::new(),
        };
        for &parent in &start.parents {
            nodes.adopt(parent);
        }
        nodes
    }

    pub fn len(&self) -> usize {
        self.branching.positions.len()
    }

    /// The peak while `more` are added.
    pub fn bytes_with(&self, more: usize) -> u64 {
        const LARGEST: u64 = 32;
        let (len, capacity) = (self.len() as u64, self.branching.positions.capacity() as u64);
        let room =
            if capacity - len < more as u64 { len + (more as u64).max(len / 4).max(64) } else { capacity };
        let mut bytes = BYTES;
        if self.axes.is_some() {
            bytes += AXES_BYTES;
        }
        if self.rule.habit.attraction == Attraction::All {
            bytes += SURROUNDINGS_BYTES;
        }
        // The largest list moves while the others are there.
        room * bytes + if room == capacity { 0 } else { len * LARGEST }
    }

    /// What is taken for a while when each of `points` is felt by a node of its own at most.
    pub fn bytes_gathered(&self, points: usize) -> u64 {
        let gathers = self.rule.habit.attraction == Attraction::All;
        if gathers { self.len().min(points) as u64 * GATHERED_BYTES } else { 0 }
    }

    fn adopt(&mut self, parent: u32) {
        let index = self.youngest.len() as u32;
        self.influences.add_node();
        self.youngest.push(NONE);
        let elder = if parent == NO_PARENT {
            NONE
        } else {
            std::mem::replace(&mut self.youngest[parent as usize], index)
        };
        self.elder.push(elder);
        match &mut self.axes {
            Some(axes) if parent == NO_PARENT => axes.add_root(),
            Some(axes) => axes.add_child(parent, elder == NONE),
            None => (),
        }
    }

    /// Adds children, each with its parent.
    pub fn extend(&mut self, children: &[(u32, Vec3)], birth: u32) {
        let more = children.len();
        reserve(&mut self.branching.positions, more);
        reserve(&mut self.branching.parents, more);
        reserve(&mut self.branching.births, more);
        self.influences.reserve(more);
        reserve(&mut self.youngest, more);
        reserve(&mut self.elder, more);
        if let Some(axes) = &mut self.axes {
            axes.reserve(more);
        }
        for &(parent, position) in children {
            self.branching.positions.push(position);
            self.branching.parents.push(parent);
            self.branching.births.push(birth);
            self.adopt(parent);
        }
    }

    /// Whether apical control lets `node` grow in the iteration after `iterations`.
    pub fn waits(&self, node: u32, iterations: u32) -> bool {
        let share = self.rule.habit.apical_control;
        let Some(axes) = self.axes.as_ref().filter(|_| share > 0.0) else { return false };
        self.youngest[node as usize] != NONE
            && (iterations == 0 || self.branching.births[axes.tip(node) as usize] == iterations)
            && axes.is_near_tip(node, share)
    }

    /// The shoot that `node` grows where `sum` pulls it.
    pub fn pulled(&self, node: u32, sum: DVec3) -> Shoot {
        let Some(pull) = unit(sum) else { return Shoot::Nothing };
        let bent = pull + self.bend(node);
        // Tropism that cancels the pull leaves rounding, which points nowhere.
        match unit(bent) {
            Some(direction) if bent.abs().max_element() > VANISHING => self.child(node, direction),
            _ => Shoot::Nothing,
        }
    }

    /// The shoot that `node` grows towards `point`.
    pub fn drawn(&self, node: u32, point: Vec3) -> Shoot {
        let offset = point.as_dvec3() - self.branching.positions[node as usize].as_dvec3();
        unit(offset).map_or(Shoot::Nothing, |direction| self.child(node, direction))
    }

    /// What is added to the unit pull at `node`: as it suits the axis that the child will be on.
    fn bend(&self, node: u32) -> DVec3 {
        let Some(axes) = &self.axes else { return self.rule.tropism.as_dvec3() };
        let positions = &self.branching.positions;
        let lever = positions[node as usize].as_dvec3() - positions[axes.root(node) as usize].as_dvec3();
        let lateral = self.youngest[node as usize] != NONE;
        self.rule.bend(
            axes.order(node).saturating_add(u8::from(lateral)),
            (lever.x * lever.x + lever.z * lever.z).sqrt(),
        )
    }

    /// One step from `node`, unless rounding loses it or that child exists.
    fn child(&self, node: u32, direction: DVec3) -> Shoot {
        let positions = &self.branching.positions;
        let from = positions[node as usize];
        if self.is_full(node) {
            return Shoot::Blocked;
        }
        let place = |direction: DVec3| (from.as_dvec3() + f64::from(self.rule.step) * direction).as_vec3();
        let straight = place(direction);
        let child = if self.obstacles.is_empty() {
            straight
        } else if let Some(child) = obstacle::turned(self.obstacles, from, direction, straight, place) {
            child
        } else {
            return Shoot::Blocked;
        };
        if child == from || self.children(node).any(|sibling| positions[sibling as usize] == child) {
            // Aside it would go, but it has been there.
            return if child == straight { Shoot::Nothing } else { Shoot::Blocked };
        }
        Shoot::Child(child)
    }

    fn is_full(&self, node: u32) -> bool {
        let most = self.rule.habit.max_children;
        most != u32::MAX && self.children(node).count() >= most as usize
    }

    /// The youngest first.
    fn children(&self, node: u32) -> impl Iterator<Item = u32> {
        let known = |child: u32| (child != NONE).then_some(child);
        std::iter::successors(known(self.youngest[node as usize]), move |&child| {
            known(self.elder[child as usize])
        })
    }
}

/// `None` for the zero vector.
fn unit(vector: DVec3) -> Option<DVec3> {
    let length = (vector.x * vector.x + vector.y * vector.y + vector.z * vector.z).sqrt();
    (length > 0.0).then(|| vector / length)
}
