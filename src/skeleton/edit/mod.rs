//! Editing the wood: single axes of a grown tree are taken away, cut, bent, scaled, added, copied, redrawn.
//!
//! An [`Edit`] names an axis by its [`AxisPath`] in the tree as it grew: paths do not shift because an edit before
//! took something away. [`edit`] makes all edits in their order and gives the skeleton that results, which is like a
//! grown one to all that comes after. It draws nothing. Radii stay as grown but where an edit says otherwise: a
//! trunk does not get thinner because a limb was cut.

mod add;
mod bend;
mod curve;
mod cut;
mod follow;
mod path;
mod table;
#[cfg(test)]
mod tests;
mod workpiece;
mod young;

use std::fmt;

use glam::DVec3;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor};

use self::path::{Finder, Missing};
use self::workpiece::Workpiece;
use crate::organs::Organs;
use crate::{NO_PARENT, Skeleton};

pub use curve::curve_through;
pub use path::{AxisPath, AxisPaths, AxisRoot};
pub use table::{EDIT_KNOBS, EDIT_PATHS, EditKnob, EditPath};

/// The most edits of one tree.
pub const MOST_EDITS: usize = 1000;

/// The most control points of a curve.
pub const MOST_POINTS: usize = 64;

/// One edit of the wood: what is done to which axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The axis; of an edit that adds wood, the one that is to bear it.
    pub axis: AxisPath,
    /// Where it began when the edit was made ([`Skeleton::beginning`]), metres; `None`: the path alone decides.
    pub near: Option<[f64; 3]>,
    /// How the tree branched then ([`AxisPaths::fingerprint`]): where it does so still, the path alone decides.
    pub branching: Option<u32>,
    /// What is done.
    pub operation: Operation,
}

/// A place along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// The share of its length, from where it leaves (0) to its tip (1).
    pub share: f64,
    /// The way from where it leaves, metres; it holds in place of the share.
    pub metres: Option<f64>,
}

impl Along {
    /// At a share of an axis' length.
    pub const fn share(share: f64) -> Self {
        Self { share, metres: None }
    }

    /// At a distance from where an axis leaves, metres.
    pub const fn metres(metres: f64) -> Self {
        Self { share: 0.5, metres: Some(metres) }
    }

    fn of(self, length_m: f64) -> f64 {
        self.metres.unwrap_or(self.share * length_m)
    }
}

/// What is done to an axis. Places are in metres and directions in the tree's frame, Y up.
#[derive(Clone, Debug, PartialEq)]
pub enum Operation {
    /// The axis goes, with all that it bears.
    Remove,
    /// The axis ends at a place. What stands beyond goes; laterals below stay.
    Cut {
        /// Where it ends.
        at: Along,
    },
    /// The axis turns from a place on; all that it bears there goes along.
    Bend {
        /// Where the bend begins.
        at: Along,
        /// How far it turns, degrees; towards a direction, no farther than to it.
        angle_deg: f64,
        /// The direction to turn to; `None`, where there is nothing to turn around either: down.
        towards: Option<[f64; 3]>,
        /// The direction to turn around, by the right hand; it holds in place of `towards`.
        round: Option<[f64; 3]>,
        /// The share of the axis' length over which it turns; 0 is a kink.
        over: f64,
    },
    /// The axis and all that it bears get larger or smaller about the place where it leaves.
    Scale {
        /// New length ÷ old one.
        length: f64,
        /// New thickness ÷ old one; no axis gets thicker than what bears it.
        thickness: f64,
    },
    /// A new lateral.
    Add {
        /// Where it leaves.
        at: Along,
        /// Where it sets out to; `None`: 50° off, into the widest gap between its neighbours.
        towards: Option<[f64; 3]>,
        /// Its length, metres.
        length_m: f64,
        /// Its radius at the base ÷ that of the axis there, at most 1.
        thickness: f64,
        /// Its radius at the base, metres; it holds in place of `thickness`, up to what bears it.
        radius_m: Option<f64>,
        /// How far it turns up over its length (down, below 0), degrees.
        lift_deg: f64,
    },
    /// A copy of an axis and of all that it bears, as they stand when the edit is made, as a new lateral.
    Copy {
        /// Where it leaves.
        at: Along,
        /// The axis that is copied.
        from: AxisPath,
        /// Where that began when the edit was made, as [`Edit::near`].
        from_near: Option<[f64; 3]>,
        /// Where it points, base to tip; `None`: as the other stands to the axis that bears it.
        towards: Option<[f64; 3]>,
        /// Its size ÷ that of the other.
        size: f64,
        /// How far it is turned around the axis that bears it (towards a direction: around that), degrees.
        turn_deg: f64,
    },
    /// The axis runs along a curve through control points (centripetal Catmull–Rom), stretched to its length. Laterals
    /// stay at their share of it, and turn as the axis turns there.
    Curve {
        /// The points after its base, metres from there.
        points: Vec<[f64; 3]>,
    },
}

impl Operation {
    /// Whether it adds an axis, which `new` means then.
    pub const fn adds(&self) -> bool {
        matches!(self, Self::Add { .. } | Self::Copy { .. })
    }
}

impl Edit {
    /// An edit that goes by the path alone.
    pub const fn new(axis: AxisPath, operation: Operation) -> Self {
        Self { axis, near: None, branching: None, operation }
    }

    /// An edit of an axis of a tree as grown, which is found again when other knobs change the tree a little.
    #[must_use]
    pub fn witnessed(mut self, grown: &Skeleton, paths: &AxisPaths) -> Self {
        let near = |path: &AxisPath| {
            let at = grown.beginning(paths.find(path)?)?;
            // A tenth of a millimetre tells axes apart, and reads well.
            Some(at.to_array().map(|x| libm::round(x * 1e4) / 1e4))
        };
        self.near = near(&self.axis);
        self.branching = Some(paths.fingerprint());
        if let Operation::Copy { from, from_near, .. } = &mut self.operation {
            *from_near = near(from);
        }
        self
    }
}

/// Why a tree was not edited.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// Nobody wanted the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// A number that is none, or out of its range.
    #[error("edit {number} ({edit}): {problem}")]
    Value {
        /// Which edit, from 1.
        number: usize,
        /// It, in short.
        edit: String,
        /// What is wrong.
        problem: String,
    },
    /// More edits than there may be.
    #[error("{count} edits are more than the {MOST_EDITS} that a tree may have; take some out")]
    TooManyEdits {
        /// How many there are.
        count: usize,
    },
    /// Copies of copies.
    #[error(
        "edit {number} ({edit}) would give {nodes} nodes, more than the limit of {limit}; copy less, or raise \
         max_nodes or symbol_limit"
    )]
    TooManyNodes {
        /// Which edit, from 1.
        number: usize,
        /// It, in short.
        edit: String,
        /// How many there would be.
        nodes: u64,
        /// The limit.
        limit: u64,
    },
    /// Places or radii that no number holds.
    #[error(
        "edit {number} ({edit}) takes wood farther away than a million kilometres, or makes it too thick or thin \
         for numbers; scale less"
    )]
    Lost {
        /// Which edit, from 1.
        number: usize,
        /// It, in short.
        edit: String,
    },
}

/// What is to be known of an edit that was not made, or not as it says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Which edit, from 1.
    pub number: usize,
    /// It, in short.
    pub edit: String,
    /// Whether it was left out as a whole.
    pub is_skipped: bool,
    /// Why, and what to do.
    pub why: String,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let done = if self.is_skipped { " was left out" } else { "" };
        write!(f, "edit {} ({}){done}: {}", self.number, self.edit, self.why)
    }
}

/// Where an axis of an edited tree is from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisOrigin {
    /// Grown, with this index among the axes of the tree as grown.
    Grown(u32),
    /// Added, by this path.
    Added(AxisPath),
}

/// Where nodes and axes of an edited tree are from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origins {
    /// For each node one of the tree as grown: it itself, or the one whose thickening it follows.
    pub nodes: Vec<u32>,
    /// For each node its radius ÷ that of the one in `nodes`.
    pub factors: Vec<f32>,
    /// For each axis where it is from.
    pub axes: Vec<AxisOrigin>,
}

impl Origins {
    /// The path by which edits name an axis of the edited tree.
    pub fn path(&self, axis: u32, paths: &AxisPaths) -> Option<AxisPath> {
        match self.axes.get(axis as usize)? {
            AxisOrigin::Grown(axis) => paths.path(*axis),
            AxisOrigin::Added(path) => Some(path.clone()),
        }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        bytes_of::<u32>(self.nodes.capacity() + self.factors.capacity())
            + bytes_of::<AxisOrigin>(self.axes.capacity())
    }
}

/// An edited tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The wood.
    pub skeleton: Skeleton,
    /// The organs that the generator placed, where they are now.
    pub organs: Organs,
    /// Where nodes and axes are from.
    pub origins: Origins,
    /// What is to be known of edits that were not made, or not as they say.
    pub remarks: Vec<Remark>,
}

/// Makes edits of a tree, in their order. `organs` are what hangs on its nodes; `most_nodes` limits what edits add.
///
/// ```
/// use glam::Vec3;
/// use linden_base::monitor::Quiet;
/// use linden_skeleton::edit::edit;
/// use linden_skeleton::organs::Organs;
/// use linden_skeleton::{Branching, NO_PARENT, Skeleton};
/// let fork = Branching {
///     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::X + Vec3::Y],
///     parents: vec![NO_PARENT, 0, 1, 1],
///     births: vec![0, 1, 2, 2],
///     radii: None,
///     edges: None,
/// };
/// let tree = Skeleton::build(fork, &Default::default())?;
/// let edits = ["remove stem/1".parse()?, "cut stem 0.75".parse()?];
/// let edited = edit(&tree, &Organs::default(), &edits, 1000, &Quiet)?;
/// assert_eq!(edited.skeleton.positions, [Vec3::ZERO, Vec3::Y, Vec3::Y * 1.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EditError`]: numbers out of range, too many nodes, too much memory, cancelled. An axis that is not there is
/// no error: see [`Edited::remarks`].
pub fn edit(
    grown: &Skeleton,
    organs: &Organs,
    edits: &[Edit],
    most_nodes: u64,
    monitor: &dyn Monitor,
) -> Result<Edited, EditError> {
    if edits.len() > MOST_EDITS {
        return Err(EditError::TooManyEdits { count: edits.len() });
    }
    for (number, edit) in (1..).zip(edits) {
        edit.check().map_err(|problem| EditError::Value { number, edit: edit.to_string(), problem })?;
    }
    let finding = AxisPaths::bytes_for(grown);
    monitor.admit("finding the axes to edit", grown.bytes() + finding, "grow a smaller tree")?;
    Workpiece::admit(grown, 0, monitor)?;
    let mut bench = Bench {
        work: Workpiece::new(grown),
        finder: Finder::new(grown),
        most_nodes: most_nodes.max(grown.positions.len() as u64),
        remarks: Vec::new(),
        monitor,
    };
    let mut added = 0;
    for (number, edit) in (1..).zip(edits) {
        monitor.check()?;
        added += u32::from(edit.operation.adds());
        bench.make(Job { number, edit, added })?;
    }
    let Bench { work, remarks, .. } = bench;
    let (skeleton, origins, moves) = work.finish();
    let organs = follow::follow(organs, grown, &moves, monitor)?;
    Ok(Edited { skeleton, organs, origins, remarks })
}

/// One edit on the bench.
#[derive(Clone, Copy)]
struct Job<'a> {
    number: usize,
    edit: &'a Edit,
    /// How many edits up to this one add wood.
    added: u32,
}

/// Why an edit is left out.
type Left = String;

/// A tree being edited.
struct Bench<'a> {
    work: Workpiece<'a>,
    finder: Finder<'a>,
    most_nodes: u64,
    remarks: Vec<Remark>,
    monitor: &'a dyn Monitor,
}

impl Bench<'_> {
    fn make(&mut self, job: Job<'_>) -> Result<(), EditError> {
        // A copy asks before it is made.
        if let Some((path, near)) = job.copied()
            && let Ok(from) = self.find(path, near, job.edit.branching)
        {
            self.admit_copy(job, from)?;
        }
        match self.apply(job) {
            Ok(()) => {}
            Err(why) => self.remark(job, true, why),
        }
        let nodes = self.work.nodes.len() as u64;
        let (number, edit) = (job.number, job.edit.to_string());
        if self.work.is_lost {
            return Err(EditError::Lost { number, edit });
        }
        if nodes > self.most_nodes.saturating_add(MOST_SPLITS) {
            return Err(EditError::TooManyNodes { number, edit, nodes, limit: self.most_nodes });
        }
        Ok(())
    }

    fn remark(&mut self, job: Job<'_>, is_skipped: bool, why: String) {
        self.remarks.push(Remark { number: job.number, edit: job.edit.to_string(), is_skipped, why });
    }

    fn apply(&mut self, job: Job<'_>) -> Result<(), Left> {
        let Edit { axis, near, branching, operation } = job.edit;
        let axis = self.find(axis, *near, *branching)?;
        match operation {
            Operation::Remove => self.remove(axis),
            Operation::Cut { at } => self.cut(axis, *at),
            Operation::Bend { at, angle_deg, towards, round, over } => {
                self.bend(axis, *at, *angle_deg, (*towards, *round), *over)
            }
            Operation::Scale { length, thickness } => {
                self.scale(job, axis, *length, *thickness);
                Ok(())
            }
            Operation::Add { .. } => self.add(job, axis),
            Operation::Copy { .. } => self.copy(job, axis),
            Operation::Curve { points } => self.redraw(axis, points),
        }
    }

    /// The axis of a path, if it is there still.
    fn find(&self, path: &AxisPath, near: Option<[f64; 3]>, branching: Option<u32>) -> Result<u32, Left> {
        let look = "'linden show SOURCE --axes' lists the axes";
        let axis = self.finder.find(path, near, branching).map_err(|missing| match missing {
            Missing::Count(None) => {
                format!("the tree has no {path}: it has {}; {look}", count(self.finder.paths.stems(), "stem"))
            }
            Missing::Count(Some((on, laterals))) => {
                format!("the tree has no {path}: {on} bears {}; {look}", count(laterals, "lateral"))
            }
            Missing::NotAdded => format!(
                "there is no {path}: it is what an edit adds, which has to come before this one and be made"
            ),
            Missing::Elsewhere { within_m } => format!(
                "the tree grew otherwise, and no axis of that order begins within {within_m:.2} m of where {path} \
                 did; take the edit out, or give it the path of another axis and its 'near'; {look}"
            ),
        })?;
        if self.work.axes[axis as usize].is_gone {
            return Err(format!("an edit before this one took {path} away; take this one out"));
        }
        Ok(axis)
    }
}

/// How many nodes one edit may put between others.
const MOST_SPLITS: u64 = 64 * MOST_POINTS as u64;

fn count(number: usize, what: &str) -> String {
    match number {
        0 => format!("no {what}"),
        1 => format!("1 {what}"),
        _ => format!("{number} {what}s"),
    }
}

/// A direction as a unit vector; `None` where it has no length.
fn direction(vector: [f64; 3]) -> Option<DVec3> {
    DVec3::from(vector).try_normalize()
}

/// A direction square to another one, the same for the same.
fn square_to(direction: DVec3) -> DVec3 {
    let level = direction.cross(DVec3::Y);
    level.try_normalize().unwrap_or(DVec3::X)
}

fn is_stem(work: &Workpiece<'_>, axis: u32) -> bool {
    work.axes[axis as usize].parent == NO_PARENT
}
