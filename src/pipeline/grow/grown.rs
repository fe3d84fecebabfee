//! A grown tree, and what can be asked of it.

use std::sync::Arc;

use linden_base::memory::OverMemory;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_plant::Body;
use linden_plant::foliage::Organs;
use linden_skeleton::edit::{AxisPath, AxisPaths, Edit, Operation, Origins, Remark};
use linden_skeleton::generator::Colonized;
use linden_skeleton::{Skeleton, Wood};

use super::shape::admit_until;
use crate::provenance::TreeHash;

/// A grown tree, and how it came about.
#[derive(Clone, Debug)]
pub struct Grown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// The tree before its wood was edited and before it was made younger.
    pub as_grown: AsGrown,
    /// Where nodes and axes of `skeleton` are from; `None`: it is the tree as grown.
    pub origins: Option<Arc<Origins>>,
    /// What is to be known of edits of the wood that were not made, or not as they say; among the notes, too.
    pub remarks: Vec<Remark>,
    /// The settings that its radii were made by, with the rule settled: for [`Skeleton::until`].
    pub wood: Wood,
    /// Leaves and other organs on it.
    pub organs: Arc<Organs>,
    /// The organs that its generator placed: without the leaves of the preset.
    pub given: Arc<Organs>,
    /// Length of the derived string; `None` for what is no L-system.
    pub symbols: Option<u64>,
    /// The attraction points, and how many were reached; `None` for L-systems.
    pub colonized: Option<Colonized>,
    /// The place of its foot in the file that it was grown from, points or cylinders, in the file's axes and units; `None` of what
    /// has no place in a file.
    pub foot: Option<glam::DVec3>,
    /// Messages for the user: limits that were hit, meshes that are open.
    pub notes: Vec<String>,
}

impl Grown {
    /// A tree that is nothing but its wood and what grows on it.
    pub fn of(skeleton: Arc<Skeleton>, wood: Wood, organs: Arc<Organs>, given: Arc<Organs>) -> Self {
        let most_nodes = skeleton.positions.len() as u64;
        let (as_skeleton, as_given) = (Arc::clone(&skeleton), Arc::clone(&given));
        let as_grown = AsGrown { skeleton: as_skeleton, given: as_given, age: None, most_nodes };
        let (origins, symbols, colonized, foot) = (None, None, None, None);
        let (remarks, notes) = (Vec::new(), Vec::new());
        Self { skeleton, as_grown, origins, remarks, wood, organs, given, symbols, colonized, foot, notes }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.body().bytes()
            + bytes_beside(&self.as_grown, &self.skeleton, &self.given, self.origins.as_deref())
            + self.colonized.as_ref().map_or(0, Colonized::bytes)
    }

    /// The paths of all axes of the tree as grown: what [`Grown::axis_path`] goes by.
    pub fn axis_paths(&self) -> AxisPaths {
        AxisPaths::new(&self.as_grown.skeleton)
    }

    /// The path by which edits name an axis of the skeleton (with `paths` those of [`Grown::axis_paths`]); `None` where
    /// there is no such axis.
    ///
    /// ```
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
    /// let mut fir = builtin("fir")?.load()?;
    /// fir.edit("remove stem/1")?;
    /// let grown = grow(&Recipe::new(fir), &Quiet)?;
    /// let paths = grown.axis_paths();
    /// let of = |axis| grown.axis_path(axis, &paths).map(|path| path.to_string());
    /// assert_eq!(of(0).as_deref(), Some("stem"));
    /// assert!((0..grown.skeleton.axes.len() as u32).all(|axis| of(axis).as_deref() != Some("stem/1")));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn axis_path(&self, axis: u32, paths: &AxisPaths) -> Option<AxisPath> {
        match &self.origins {
            Some(origins) => origins.path(axis, paths),
            None => paths.path(axis),
        }
    }

    /// An edit of an axis of the skeleton, which finds it again when other knobs change the tree a little; `None` where
    /// there is no such axis.
    pub fn edit_of(&self, axis: u32, operation: Operation, paths: &AxisPaths) -> Option<Edit> {
        let path = self.axis_path(axis, paths)?;
        Some(Edit::new(path, operation).witnessed(&self.as_grown.skeleton, paths))
    }

    /// The tree at a step of its growth, edited as it is: [`Skeleton::until`].
    pub fn until(&self, step: u32, key: Key) -> Skeleton {
        match self.origins.as_ref().filter(|_| !self.skeleton.marks.is_empty()) {
            Some(origins) => {
                origins.until((&self.skeleton, &self.as_grown.skeleton), step, &self.wood, key).0
            }
            None => self.skeleton.until(step, &self.wood, key),
        }
    }

    /// Asks for the memory that [`Grown::until`] takes, the skeleton included.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn admit_until(&self, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        admit_until((&self.skeleton, &self.as_grown.skeleton), &self.wood, monitor)
    }

    /// The fingerprints of the tree.
    ///
    /// ```
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
    /// let fir = Recipe::new(builtin("fir")?.load()?);
    /// assert_eq!(grow(&fir, &Quiet)?.hash(), grow(&fir, &Quiet)?.hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hash(&self) -> TreeHash {
        TreeHash { skeleton: self.skeleton.hash(), organs: self.organs.hash() }
    }

    /// The tree as it is dressed.
    pub fn body(&self) -> Body<'_> {
        let Self { skeleton, organs, given, foot, .. } = self;
        Body { skeleton, organs, given, foot_in_file: *foot }
    }
}

/// A tree as it grew: edits of the wood name its axes.
#[derive(Clone, Debug)]
pub struct AsGrown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// The organs that its generator placed.
    pub given: Arc<Organs>,
    /// The share of its births that is to be shown; `None`: all.
    pub age: Option<f64>,
    /// The most nodes that it may have.
    pub most_nodes: u64,
}

/// Bytes that a tree takes as it grew, where it is another one now, and what is known of where that is from.
pub(super) fn bytes_beside(
    as_grown: &AsGrown,
    skeleton: &Arc<Skeleton>,
    given: &Arc<Organs>,
    origins: Option<&Origins>,
) -> u64 {
    let wood = if Arc::ptr_eq(&as_grown.skeleton, skeleton) { 0 } else { as_grown.skeleton.bytes() };
    let organs = if Arc::ptr_eq(&as_grown.given, given) { 0 } else { as_grown.given.bytes() };
    wood + organs + origins.map_or(0, Origins::bytes)
}
