//! Why a recipe does not grow.

use linden_base::memory::OverMemory;
use linden_base::monitor::Cancelled;
use linden_plant::foliage::FoliageError;
use linden_skeleton::SkeletonError;
use linden_skeleton::edit::EditError;
use linden_skeleton::generator::GeneratorError;
use linden_skeleton::refine::RefineError;

use crate::recipe::InputsError;

/// Why a recipe did not grow.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GrowError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// What the generator says; [`GrowError::generator`] has it in the type that the generator defines.
    #[error(transparent)]
    Generator(GeneratorError),
    /// Refinement.
    #[error("refining: {0}")]
    Refine(#[source] RefineError),
    /// Edits of the wood.
    #[error("editing the wood: {0}")]
    Edit(#[source] EditError),
    /// The skeleton.
    #[error("building the skeleton: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The leaves.
    #[error("growing leaves: {0}")]
    Foliage(#[source] FoliageError),
    /// Files that are missing, or that the preset does not name.
    #[error(transparent)]
    Inputs(#[from] InputsError),
    /// A tree that is thinner at its base than at its tips.
    #[error(
        "base_radius is {base_m} m and tip_radius {tip_m} m: wood is not thinner at its base; change one of them"
    )]
    Radii {
        /// Metres.
        base_m: f64,
        /// Metres.
        tip_m: f64,
    },
}

linden_base::from_cancellable!(GrowError: RefineError => Refine, EditError => Edit, FoliageError => Foliage);

impl From<GeneratorError> for GrowError {
    fn from(error: GeneratorError) -> Self {
        match error {
            GeneratorError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            GeneratorError::Memory(over) => Self::Memory(over),
            other => Self::Generator(other),
        }
    }
}

impl GrowError {
    /// The generator's error, where it has the type that the generator defines.
    ///
    /// ```
    /// use linden_pipeline::colonization::ColonizationError;
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
    /// let mut fir = builtin("fir")?.load()?;
    /// fir.set("kill", "0.5D")?;
    /// let error = grow(&Recipe::new(fir), &Quiet).unwrap_err();
    /// assert!(matches!(error.generator(), Some(ColonizationError::Stand(_))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn generator<E: std::error::Error + 'static>(&self) -> Option<&E> {
        match self {
            Self::Generator(error) => error.downcast_ref(),
            _ => None,
        }
    }
}
