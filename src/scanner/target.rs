//! The triangles that are scanned, and what each of them is.

use glam::{DVec3, Vec3};
use linden_pipeline::foliage::Shaper;
use linden_pipeline::grow::Grown;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::mesh::{Bounds, Mesh};
use linden_pipeline::skeleton::TreeIndex;
use linden_pipeline::stage::Place;
use linden_pipeline::surface::{Junction, Tubes, count, sweep};
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};

use crate::ScannerError;
use crate::stand::Stand;

/// What a pulse fell on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhatIsHit {
    /// The ground.
    Ground,
    /// Wood.
    Wood,
    /// A leaf, blossom or fruit.
    Leaf,
}

impl WhatIsHit {
    /// Its number in files: 0, 1, 2.
    pub const fn number(self) -> u8 {
        match self {
            Self::Ground => 0,
            Self::Wood => 1,
            Self::Leaf => 2,
        }
    }
}

/// What a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Of the trees of a target, counted from 1 as tables of the same trees count them; 0 for ground.
    pub tree: u32,
    /// What it is.
    pub what: WhatIsHit,
    /// Index among [`Skeleton::axes`] of the wood, or of the wood that bears the leaf, where a skeleton holds several trees
    /// among those of its tree ([`Skeleton::split`]); -1 for ground.
    pub axis: i32,
    /// The order of that axis, 0 for a stem; -1 for ground.
    pub order: i32,
}

impl Truth {
    /// Of the ground.
    pub const GROUND: Self = Self { tree: 0, what: WhatIsHit::Ground, axis: -1, order: -1 };
}

/// Level or sloping ground: what lies within a distance of its middle, seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its middle.
    pub middle: DVec3,
    /// Metres.
    pub radius_m: f64,
    /// Metres that it rises along each metre of x.
    pub rise: f64,
}

/// Triangles with their truths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// Corners, metres.
    pub triangles: Vec<[Vec3; 3]>,
    /// Of each triangle, an index into `truths`.
    pub owners: Vec<u32>,
    /// What triangles are.
    pub truths: Vec<Truth>,
    /// The foot of each tree, the first of several stems'.
    feet: Vec<Vec3>,
}

impl Target {
    /// Adds a tree where it stands, or the trees of a stand, with leaves or without. Wood that would be one solid is scanned as the tubes that it
    /// is made of: from outside they look alike.
    ///
    /// # Errors
    /// [`ScannerError`]: too large, or cancelled.
    pub fn add(
        &mut self,
        grown: &Grown,
        tubes: &Tubes,
        leaves: bool,
        monitor: &dyn Monitor,
    ) -> Result<(), ScannerError> {
        self.add_at(&Place::origin(0), grown, tubes, leaves, monitor)
    }

    /// The same at a place of a forest.
    ///
    /// # Errors
    /// [`ScannerError`]: too large, or cancelled.
    pub fn add_at(
        &mut self,
        place: &Place,
        grown: &Grown,
        tubes: &Tubes,
        leaves: bool,
        monitor: &dyn Monitor,
    ) -> Result<(), ScannerError> {
        let first = self.triangles.len();
        let skeleton = &grown.skeleton;
        let mut tubes = *tubes;
        if tubes.junction == Junction::Watertight {
            tubes.junction = Junction::Overlap;
        }
        let trees = Trees { index: skeleton.tree_index(), before: self.feet.len() as u32, skeleton };
        let first_foot = self.feet.len();
        self.feet.extend(trees.feet());
        let mesh = sweep(skeleton, &tubes, monitor)?;
        let of_axes = count(skeleton, &tubes, monitor)?;
        self.admit(mesh.triangles.len(), monitor)?;
        let mut at = 0;
        for (axis, amount) in (0..).zip(of_axes) {
            let triangles = mesh.triangles.get(at..at + amount.triangles).unwrap_or_default();
            at += amount.triangles;
            self.add_mesh(&mesh, triangles, trees.truth(axis, WhatIsHit::Wood));
        }
        drop(mesh);
        if leaves {
            self.add_leaves(grown, &trees, monitor)?;
        }
        if let Some(motion) = place.motion() {
            let feet = self.feet[first_foot..].iter_mut();
            for corner in self.triangles[first..].iter_mut().flatten().chain(feet) {
                *corner = motion.point(*corner);
            }
        }
        Ok(())
    }

    fn add_leaves(
        &mut self,
        grown: &Grown,
        trees: &Trees<'_>,
        monitor: &dyn Monitor,
    ) -> Result<(), ScannerError> {
        const PER_CHECK: usize = 4096;
        let (organs, skeleton) = (&*grown.organs, &*grown.skeleton);
        let mut axis_of = vec![0; skeleton.positions.len()];
        for (index, axis) in (0..).zip(&skeleton.axes) {
            for &node in skeleton.nodes_of(axis) {
                axis_of[node as usize] = index;
            }
        }
        let mut shaper = Shaper::default();
        let mut mesh = Mesh::default();
        for organ in 0..organs.len() {
            if organ.is_multiple_of(PER_CHECK) {
                monitor.check()?;
                self.admit(PER_CHECK, monitor)?;
            }
            mesh.positions.clear();
            mesh.normals.clear();
            mesh.uvs.clear();
            mesh.triangles.clear();
            shaper.add(organs, organ, &mut mesh);
            let axis = axis_of.get(organs.growth(organ).node as usize).copied().unwrap_or(0);
            self.add_mesh(&mesh, &mesh.triangles, trees.truth(axis, WhatIsHit::Leaf));
        }
        Ok(())
    }

    fn add_mesh(&mut self, mesh: &Mesh, triangles: &[[u32; 3]], truth: Truth) {
        if self.truths.last() != Some(&truth) {
            self.truths.push(truth);
        }
        let owner = self.truths.len() as u32 - 1;
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize])));
        self.owners.resize(self.triangles.len(), owner);
    }

    /// Asks for memory for so many more triangles, and for the tree of boxes around all of them.
    fn admit(&self, more: usize, monitor: &dyn Monitor) -> Result<(), ScannerError> {
        let bytes = bytes_of::<[u8; Self::BYTES_EACH]>(self.triangles.len() + more);
        Ok(monitor.admit("scanning a surface", bytes, "lower sides or scan without leaves")?)
    }

    /// Of a triangle: here, among the rays', and in the tree of boxes while that is built.
    const BYTES_EACH: usize = 300;

    /// The box around all triangles.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.triangles.iter().flatten().copied())
    }

    /// The same with the ground.
    pub fn bounds_with(&self, ground: Option<Ground>) -> Option<Bounds> {
        let bounds = self.bounds()?;
        Some(ground.map_or(bounds, |Ground { middle, radius_m, rise }| {
            let out = DVec3::new(radius_m, radius_m * rise.abs(), radius_m);
            let (min, max) = ((middle - out).as_vec3(), (middle + out).as_vec3());
            bounds.union(Bounds { min, max })
        }))
    }

    /// The foot of each tree, in the order of their numbers.
    pub fn feet(&self) -> &[Vec3] {
        &self.feet
    }

    /// Where the lowest tree stands, of equals the first.
    pub fn foot(&self) -> Option<DVec3> {
        let lowest = self.feet.iter().reduce(|lowest, foot| if foot.y < lowest.y { foot } else { lowest });
        lowest.copied().map(Vec3::as_dvec3)
    }

    /// Ground through the foot of the lowest tree, as wide as the trees and a metre. Stands round a tree by itself have none
    /// under them.
    pub fn ground(&self, stands: &[Stand], rise: f64) -> Option<Ground> {
        let (bounds, foot) = (self.bounds()?, self.foot()?);
        let middle = (bounds.min + bounds.max).as_dvec3() * 0.5;
        let middle = DVec3::new(middle.x, foot.y + rise * (middle.x - foot.x), middle.z);
        let size = bounds.size().as_dvec3();
        let widest_m = 0.5 * libm::hypot(size.x, size.z) + 1.0;
        let off = |stand: &Stand| DVec3::new(stand.eye.x, middle.y, stand.eye.z).distance(middle);
        let nearest_m = stands.iter().map(off).fold(f64::INFINITY, f64::min);
        let radius_m = if self.feet.len() > 1 { widest_m } else { widest_m.min(0.9 * nearest_m) };
        Some(Ground { middle, radius_m, rise })
    }
}

/// The trees of a skeleton that is being added.
struct Trees<'a> {
    skeleton: &'a Skeleton,
    /// `None`: it is one.
    index: Option<TreeIndex>,
    /// How many trees were added before.
    before: u32,
}

impl Trees<'_> {
    /// The first foot of each.
    fn feet(&self) -> Vec<Vec3> {
        let Skeleton { positions, parents, .. } = self.skeleton;
        let Some(index) = &self.index else {
            let foot = self.skeleton.axes.iter().find_map(|axis| self.skeleton.nodes_of(axis).first());
            return vec![foot.map_or(Vec3::ZERO, |&foot| positions[foot as usize])];
        };
        let mut feet = Vec::with_capacity(index.count);
        let nodes = parents.iter().zip(positions).zip(&index.nodes);
        for ((_, &position), [tree, _]) in nodes.filter(|((parent, _), _)| **parent == NO_PARENT) {
            // They are numbered as their first feet come up.
            if *tree as usize == feet.len() {
                feet.push(position);
            }
        }
        feet
    }

    fn truth(&self, axis: u32, what: WhatIsHit) -> Truth {
        let order = self.skeleton.axes.get(axis as usize).map_or(0, |axis| axis.order);
        let whole = [0, axis];
        let [tree, axis] = match &self.index {
            Some(index) => index.axes.get(axis as usize).copied().unwrap_or(whole),
            None => whole,
        };
        Truth { tree: self.before + tree + 1, what, axis: axis as i32, order: order as i32 }
    }
}
