//! Attraction points and a root, ready to grow, and where they lie in the input's coordinates.

use std::sync::Arc;

use glam::DVec3;

use crate::colonization::crown::Crown;
use crate::colonization::crown::shells::Inside;
use crate::colonization::growth::Meet;
use crate::input::Up;
use crate::preset::{Colonization, Length, Origin, UpAxis};

/// Steps between neighbouring points where no step is given.
const STEPS_PER_SPACING: f64 = 3.0;
/// Kill distance where none is given: about the points' spacing.
pub(crate) const KILL_STEPS: f64 = 3.0;
/// Influence where none is given: the upper end of the range that RLP07 shows (8D to 17D).
pub(crate) const INFLUENCE_STEPS: f64 = 17.0;

/// Points and root in coordinates near the origin, where `f32` is precise.
pub(super) struct Site {
    pub points: Vec<DVec3>,
    /// What was scanned of the tree, where the points are attraction points made of a scan.
    pub bark: Option<Vec<DVec3>>,
    pub root: DVec3,
    /// What else stands there.
    pub grove: Grove,
    /// Where these coordinates have their origin in the input's (turned to Y up).
    pub origin: DVec3,
    /// What suits these points where the user gives none.
    pub suggested: Suggested,
    /// Whether the tree is moved to stand on the origin unless the user says otherwise.
    pub moves_to_root: bool,
    pub notes: Vec<String>,
}

/// What stands beside the first tree, in the coordinates of the [`Site`].
#[derive(Default)]
pub(super) struct Grove {
    /// The first tree's own crown, where others compete with it; `None`: all points are its own.
    pub own: Option<Arc<dyn Inside>>,
    /// The other trees.
    pub others: Vec<Stem>,
    /// What branches do not enter.
    pub obstacles: Vec<Obstacle>,
}

/// Another tree.
pub(super) struct Stem {
    pub root: DVec3,
    /// Height of the bare trunk, metres; `None`: until the first point of its crown is in reach.
    pub trunk_m: Option<f64>,
    /// What its trunk leads to; `None`: any point.
    pub crown: Option<Arc<dyn Inside>>,
}

/// A solid that branches do not enter.
pub(super) struct Obstacle {
    pub solid: Box<dyn Crown>,
    pub meet: Meet,
}

/// Distances in metres.
pub(super) struct Suggested {
    pub step: f64,
    pub kill: Length,
    pub influence: Length,
}

impl Suggested {
    /// For points that fill a volume.
    pub fn for_volume(spacing_m: f64) -> Self {
        Self {
            step: spacing_m / STEPS_PER_SPACING,
            kill: Length::Steps(KILL_STEPS),
            influence: Length::Steps(INFLUENCE_STEPS),
        }
    }
}

impl Colonization {
    /// Whether the tree is moved to stand on the origin.
    pub(super) fn moves_to_root(&self, unless_told: bool) -> bool {
        match self.origin {
            Origin::Root => true,
            Origin::Keep => false,
            Origin::Auto => unless_told,
        }
    }

    /// From the coordinates of the [`Site`] to where the tree is to stand.
    pub(super) fn shift(&self, root: DVec3, origin: DVec3, moves_unless_told: bool) -> DVec3 {
        if self.moves_to_root(moves_unless_told) { -root } else { origin }
    }

    /// The axis that points up in an input file.
    pub(super) fn up(&self, default: Up) -> Up {
        self.given_up().unwrap_or(default)
    }

    /// The axis that the user says points up.
    pub(super) fn given_up(&self) -> Option<Up> {
        match self.up {
            UpAxis::Y => Some(Up::Y),
            UpAxis::Z => Some(Up::Z),
            UpAxis::Auto => None,
        }
    }

    /// The root that the user gave, turned to Y up.
    pub(super) fn given_root(&self, up: Up) -> Option<DVec3> {
        self.root.map(|root| {
            let mut place = [DVec3::from_array(root)];
            up.to_y_up(&mut place);
            place[0]
        })
    }
}
