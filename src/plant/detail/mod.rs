//! The same tree with fewer triangles: levels of detail and budgets.
//!
//! Everything here starts from one grown tree. Randomness was spent when it grew and meshing uses none,
//! so each level is the same tree seen from farther away: wood that is too thin to be seen is left
//! out, axes keep the nodes that shape them, tubes have fewer sides, and of the leaves an even share
//! stays, enlarged. The leaves of a coarser level are among those of every finer one.
//!
//! Counting is exact and needs no mesh, so that a budget of triangles can be solved for
//! ([`Simplifier::within`]).

pub mod billboard;
mod cards;
mod drawing;
mod exposure;
mod forms;
pub mod impostor;
mod leaves;
mod levels;
mod silhouette;
mod solve;
#[cfg(test)]
mod stem_tests;
mod wood;

use std::sync::Arc;

use crate::Body;
use crate::dress::DressError;
use crate::foliage::FoliageError;
use crate::settings::FoliageSettings;
use crate::surface::{self, SurfaceError, Tubes};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::Skeleton;
use linden_skeleton::organs::Organs;

use self::billboard::BillboardError;
use self::cards::{Burden, Pieces, TRIANGLES};
use self::exposure::Exposure;
use self::forms::LevelForms;
use self::leaves::{Leaves, Which};
use self::silhouette::Silhouette;
use self::wood::Wood;

pub use levels::{Finest, Level, Levels, Year, finest, levels, year};
pub use solve::{Amount, Shares, shares};

/// How much of a tree is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Sides of the thickest ring, 3 to 128: see [`Tubes::sides`].
    pub sides: u32,
    /// The fewest sides of stems where they are stout: see [`Tubes::stem_sides`].
    pub stem_sides: u32,
    /// Rings per segment: see [`Tubes::rings`].
    pub rings: u32,
    /// Nodes are passed over as long as their axis stays within this distance of where it was, metres;
    /// 0 keeps all.
    pub tolerance_m: f32,
    /// Axes that are thinner at their base, metres, are left out with all that leaves from them; 0 keeps
    /// all. Of axes that are equally thick some stay a little longer, so that not all go at once, and those
    /// that are seen past the foliage some times longer than those that are hidden in it.
    pub smallest_radius_m: f32,
    /// Buttresses that stand out less are left out, metres; 0 keeps all.
    pub smallest_ridge_m: f32,
    /// Roots on the ground that are thinner are left out, radius in metres; 0 keeps all.
    pub smallest_root_m: f32,
    /// Whether stems have rings where their bark changes: see [`Tubes::foot_edge`].
    pub foot_edge: bool,
    /// Share of the leaves that is kept, 0 to 1; with branch cards, of those beside them.
    pub leaf_share: f64,
    /// Branch cards stand for pieces of foliage of about this size, metres, in place of all leaves; 0: leaves as
    /// they are.
    pub card_m: f32,
}

/// Where nodes may be passed over, wood is smooth from a radius on that is greater by this many times the distance
/// that its axis may then be off.
const SMOOTH_FROM: f32 = 20.0;

impl Detail {
    /// Everything that there is.
    pub const fn full(tubes: &Tubes) -> Self {
        Self {
            sides: tubes.sides,
            stem_sides: 0,
            rings: tubes.rings,
            tolerance_m: 0.0,
            smallest_radius_m: 0.0,
            smallest_ridge_m: 0.0,
            smallest_root_m: 0.0,
            foot_edge: true,
            leaf_share: 1.0,
            card_m: 0.0,
        }
    }
}

/// Why there is no such level.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DetailError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Fewer triangles than the tree's stem.
    #[error(
        "triangles={budget} is less than this tree can do with: its stem and one leaf alone have {least} triangles; ask for at least as many"
    )]
    TooFew {
        /// What was asked for.
        budget: u64,
        /// The least that there can be.
        least: u64,
    },
    /// Levels that do not get coarser.
    #[error(
        "lod_triangles: {after} triangles follow {before}; list the levels from the finest to the coarsest"
    )]
    NotFewer {
        /// The budget of a level.
        before: u64,
        /// The budget of the next one.
        after: u64,
    },
    /// Counting the surface.
    #[error("counting the surface: {0}")]
    Surface(#[source] SurfaceError),
    /// Counting the foliage.
    #[error("counting the foliage: {0}")]
    Foliage(#[source] FoliageError),
    /// Dressing a level.
    #[error(transparent)]
    Dress(DressError),
    /// Drawing the cards.
    #[error(transparent)]
    Billboard(BillboardError),
}

linden_base::from_cancellable!(
    DetailError: SurfaceError => Surface, FoliageError => Foliage, DressError => Dress,
    BillboardError => Billboard
);

/// A grown tree, prepared to be shown with less.
pub struct Simplifier<'a> {
    tubes: Tubes,
    wood: Arc<Wood<'a>>,
    leaves: Arc<Leaves<'a>>,
    organs: &'a Organs,
    skeleton: &'a Skeleton,
    silhouette: Silhouette,
}

/// A tree with less of it: what [`crate::dress`] takes in place of the whole.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The wood that is shown.
    pub skeleton: Skeleton,
    /// For each of its axes the axis of the whole tree.
    pub axes: Vec<u32>,
    /// The leaves that are shown, still hanging on the nodes of the whole tree; without those that cards stand for.
    pub organs: Organs,
    /// How it is swept.
    pub tubes: Tubes,
}

impl<'a> Simplifier<'a> {
    /// Finds out what matters of a tree. Takes some 100 ns a node.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`], or memory.
    pub fn new(tubes: &Tubes, body: Body<'a>, monitor: &dyn Monitor) -> Result<Self, DetailError> {
        Self::with_exposure(tubes, body, &Exposure::of(body, monitor)?, monitor)
    }

    /// The same where it is known what is seen past the foliage.
    fn with_exposure(
        tubes: &Tubes,
        body: Body<'a>,
        exposure: &Exposure,
        monitor: &dyn Monitor,
    ) -> Result<Self, DetailError> {
        let nodes = body.skeleton.positions.len() + body.skeleton.axes.len();
        let bytes = body.skeleton.bytes()
            + bytes_of::<[u32; 4]>(nodes + body.organs.len())
            + Burden::bytes_for(body.skeleton.positions.len());
        monitor.admit("preparing levels of detail", bytes, "grow a smaller tree")?;
        Ok(Self {
            tubes: *tubes,
            wood: Arc::new(Wood::new(body.skeleton, exposure, monitor)?),
            leaves: Arc::new(Leaves::new(body.organs, LevelForms::plain(body.organs), monitor)?),
            organs: body.organs,
            skeleton: body.skeleton,
            silhouette: Silhouette::of(body.skeleton, body.organs),
        })
    }

    /// The same tree with its foliage as a level has it, 0 for the finest.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`].
    pub fn in_level(
        &self,
        foliage: &FoliageSettings,
        level: usize,
        monitor: &dyn Monitor,
    ) -> Result<Self, DetailError> {
        let forms = LevelForms::of(foliage, self.organs, level);
        let leaves = if forms == *self.leaves.forms() {
            Arc::clone(&self.leaves)
        } else {
            Arc::new(Leaves::new(self.organs, forms, monitor)?)
        };
        Ok(Self { tubes: self.tubes, wood: Arc::clone(&self.wood), leaves, ..*self })
    }

    /// What there is with this detail.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`].
    pub fn simplified(&self, detail: &Detail, monitor: &dyn Monitor) -> Result<Simplified, DetailError> {
        monitor.check()?;
        let (skeleton, axes) = self.wood.thinned(detail);
        let organs = self.leaves.thinned(detail);
        let tubes = self.tubes(detail);
        Ok(Simplified { skeleton, axes, organs, tubes })
    }

    /// How a level's wood is swept: stubs go as limbs of their thickness do, roots and buttresses later.
    fn tubes(&self, detail: &Detail) -> Tubes {
        let Detail { sides, stem_sides, rings, .. } = *detail;
        let mut tubes = Tubes { sides, stem_sides, rings, ..self.tubes };
        if tubes.smooth_wood > 0.0 {
            tubes.smooth_wood +=
                SMOOTH_FROM * detail.tolerance_m / self.wood.thickest_m().max(f32::MIN_POSITIVE);
        }
        if !detail.foot_edge {
            tubes.features.foot_height_m = 0.0;
        }
        tubes.features.flare_smallest_m = detail.smallest_ridge_m;
        tubes.features.roots.smallest_m = detail.smallest_root_m;
        tubes.features.stubs.smallest_m = detail.smallest_radius_m;
        tubes
    }

    /// What the cards of a level stand for.
    fn pieces(&self, detail: &Detail, monitor: &dyn Monitor) -> Result<Pieces, DetailError> {
        let cut = self.burden(detail).cut(detail.card_m, monitor)?;
        Ok(Pieces { cut, is_thin: self.wood.thin_nodes(detail), forms: self.leaves.forms().clone() })
    }

    /// What cards would stand for.
    fn burden(&self, detail: &Detail) -> Burden {
        Burden::new(self.skeleton, self.organs, self.leaves.forms(), &self.wood.thin_nodes(detail))
    }

    /// Vertices and triangles of a level's branch cards; `None` where there are none.
    fn cards(&self, detail: &Detail, monitor: &dyn Monitor) -> Result<Option<[u64; 2]>, Cancelled> {
        if detail.card_m == 0.0 {
            return Ok(None);
        }
        let triangles = TRIANGLES * self.burden(detail).count(detail.card_m, monitor)? as u64;
        Ok(Some([2 * triangles, triangles]))
    }

    /// How many triangles a level has, exactly.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`].
    pub fn triangles(&self, detail: &Detail, monitor: &dyn Monitor) -> Result<u64, DetailError> {
        let wood = self.wood_triangles(detail, monitor)?;
        let (cards, which) = match self.cards(detail, monitor)? {
            Some([_, cards]) => (cards, Which::BesideCards),
            None => (0, Which::All),
        };
        Ok(wood + cards + self.leaves.triangles(detail.leaf_share, which))
    }

    fn wood_triangles(&self, detail: &Detail, monitor: &dyn Monitor) -> Result<u64, DetailError> {
        monitor.check()?;
        let tubes = self.tubes(detail);
        let (skeleton, _) = self.wood.thinned(detail);
        let counts = surface::count(&skeleton, &tubes, monitor)?;
        Ok(counts.iter().map(|tube| tube.triangles as u64).sum())
    }
}
