//! What is measured of a tree: every number with its name, its unit and its definition.
//!
//! [`NUMBERS`] is the table: a row makes a field of [`Report`], a line of `linden stats`, a column of `linden sweep`,
//! an entry of `linden schema --stats` and a row of `docs/numbers.md`. All numbers of a report are of one tree: the
//! whole, or, where its recipe sets a budget of triangles, the finest level within that.
//!
//! Sums run in one order: the same recipe gives the same numbers to the last bit, on any number of threads.

mod figures;
mod reading;
mod sample;
mod table;

use linden_base::monitor::{Cancelled, Monitor};
use linden_plant::detail::DetailError;
use linden_plant::foliage::FoliageError;
use linden_plant::surface::SurfaceError;

use crate::grow::Grown;
use crate::recipe::Recipe;
use figures::Figures;
pub(crate) use figures::breast_fit;

pub use figures::DIAMETERS_M;
pub use reading::{Corners, Reading};
pub use sample::{Parting, Sample};
pub use table::{Group, NUMBERS, Number, Of, Report};

/// Why a tree was not measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Reducing it to its budget of triangles, or there is no memory.
    #[error(transparent)]
    Detail(DetailError),
    /// Its leaves.
    #[error(transparent)]
    Foliage(FoliageError),
    /// Its surface.
    #[error(transparent)]
    Surface(SurfaceError),
}

linden_base::from_cancellable!(
    ReportError: DetailError => Detail, FoliageError => Foliage, SurfaceError => Surface
);

impl Report {
    /// Measures a grown tree.
    ///
    /// ```
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe, report::Report};
    /// let recipe = Recipe::new(builtin("abop-a")?.load()?);
    /// let report = Report::of(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
    /// assert_eq!((report.segments, report.leaf_count, report.leaf_area_index), (3125, 0, None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ReportError`]: a budget of triangles that cannot be met, files that are missing, memory, cancelled.
    pub fn of(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Self, ReportError> {
        Ok(Self::read(&Figures::new(recipe, grown, monitor)?))
    }
}
