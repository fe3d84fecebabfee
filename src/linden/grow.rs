//! Recipe → skeleton: the one way through both generators.

use std::sync::Arc;

use glam::Vec3;

use crate::colonization::crown::CrownError;
use crate::colonization::crown::envelope::EnvelopeError;
use crate::colonization::growth::GrowthError;
use crate::colonization::plant::{Plant, plant};
use crate::colonization::scan::{Fit, Girth, ScanError, fit, girth};
use crate::colonization::scatter::ScatterError;
use crate::knob::printable;
use crate::lsystem::{self, LsystemError};
use crate::monitor::{Cancelled, Monitor, from_cancellable};
use crate::preset::{Generator, Preset, ScanRadius};
use crate::random::Key;
use crate::recipe::Recipe;
use crate::skeleton::{Skeleton, SkeletonError};

/// A grown tree, and how it came about.
#[derive(Clone, Debug)]
pub struct Grown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// Length of the derived string; `None` for space colonization.
    pub symbols: Option<u64>,
    /// What the tree reached for; `None` for L-systems.
    pub colonized: Option<Colonized>,
    /// What the user should know: limits that were hit, meshes that are open.
    pub notes: Vec<String>,
}

/// How space colonization went.
#[derive(Clone, Debug)]
pub struct Colonized {
    /// The attraction points, where the tree stands.
    pub points: Vec<Vec3>,
    /// How many of them were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// How the tree compares with the scan that it grew into; `None` for what is no scan.
    pub scan: Option<Scanned>,
}

/// A scan, and how near the tree that grew into it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scanned {
    /// Points of the tree: without ground, strays and noise.
    pub points: usize,
    /// Nodes whose radius was measured on points; the others' follow by the pipe model.
    pub measured_nodes: usize,
    /// Distances both ways.
    pub fit: Fit,
}

/// Why a recipe did not grow.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GrowError {
    /// Nobody wanted the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The L-system.
    #[error("growing the L-system: {0}")]
    LSystem(LsystemError),
    /// The crown's shape.
    #[error("shaping the crown: {0}")]
    Crown(#[from] CrownError),
    /// The crown's mesh.
    #[error("filling the envelope: {0}")]
    Envelope(EnvelopeError),
    /// The points.
    #[error(transparent)]
    Scatter(ScatterError),
    /// The scan.
    #[error("preparing the points: {0}")]
    Scan(ScanError),
    /// Space colonization.
    #[error(transparent)]
    Growth(GrowthError),
    /// The skeleton.
    #[error("building the skeleton: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The recipe's file is missing or holds something else.
    #[error("the recipe grows into '{}', which must hold {expected}", printable(.file))]
    WrongInput {
        /// As the preset names it.
        file: String,
        /// What it must hold.
        expected: &'static str,
    },
    /// No iteration placed a node.
    #[error(
        "nothing grew: {reached} of {points} points lie within the kill distance ({kill_m} m) of the root or \
         trunk from the start; lower kill or step, or move root away"
    )]
    NothingGrew {
        /// All attraction points.
        points: usize,
        /// Those that were used up at the start.
        reached: usize,
        /// Metres.
        kill_m: f32,
    },
    /// Single precision cannot hold a tree there.
    #[error(
        "the tree would stand {farthest_m:.0} m from the origin, where coordinates in single precision are \
         {gap_m:.1e} m apart, too coarse for steps of {step_m} m; use origin=root, or a nearer root"
    )]
    TooFar {
        /// Largest coordinate of the root, metres.
        farthest_m: f64,
        /// Distance of neighbouring numbers there, metres.
        gap_m: f64,
        /// Length of a segment, metres.
        step_m: f64,
    },
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
    /// A trunk of too many segments.
    #[error(
        "the trunk would have {segments:.0} segments, more than max_nodes={max_nodes}; shorten trunk or lengthen step"
    )]
    TrunkTooLong {
        /// Trunk ÷ step.
        segments: f64,
        /// The limit.
        max_nodes: u32,
    },
}

from_cancellable!(GrowError: LsystemError => LSystem, EnvelopeError => Envelope, ScatterError => Scatter, ScanError => Scan, GrowthError => Growth);

/// Grows the tree of a recipe.
///
/// ```
/// use linden::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
/// let preset = builtin("abop-a").unwrap().load().map_err(|fault| fault.message)?;
/// let grown = grow(&Recipe { preset, input: None }, &Quiet)?;
/// assert_eq!(grown.skeleton.segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GrowError`]: limits, contradictions, nothing in reach, cancelled.
pub fn grow(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    let Preset { seed, generator, wood, .. } = &recipe.preset;
    if let (Some(base_m), Some(tip_m)) = (wood.base_radius_m, wood.tip_radius_m)
        && base_m < tip_m
    {
        return Err(GrowError::Radii { base_m, tip_m });
    }
    let key = Key::new(*seed);
    match generator {
        Generator::LSystem(own) => {
            let settings = lsystem::Settings {
                derivations: own.derivations,
                angle_deg: own.angle_deg,
                segment_m: own.segment_length_m,
                symbol_limit: own.symbol_limit,
                seed: *seed,
            };
            let lsystem::Grown { branching, symbols } = lsystem::grow(&own.grammar, &settings, monitor)?;
            let skeleton = Arc::new(Skeleton::build(branching, wood)?);
            Ok(Grown { skeleton, symbols: Some(symbols), colonized: None, notes: Vec::new() })
        }
        Generator::Colonization(own) => {
            let Plant { mut branching, points, bark, unreached, iterations, notes } =
                plant(own, recipe.input.as_ref(), key, monitor)?;
            let mut measured_nodes = 0;
            if let (Some(bark), ScanRadius::Points) = (&bark, own.scan_radius)
                && let Some(Girth { radii, measured }) =
                    girth(&branching, bark, wood.radius_exponent, monitor)?
            {
                branching.radii = Some(radii);
                measured_nodes = measured;
            }
            let skeleton = Arc::new(Skeleton::build(branching, wood)?);
            let scan = match &bark {
                Some(bark) => fit(bark, &skeleton, monitor)?.map(|fit| Scanned {
                    points: bark.len(),
                    measured_nodes,
                    fit,
                }),
                None => None,
            };
            Ok(Grown {
                skeleton,
                symbols: None,
                colonized: Some(Colonized { points, unreached, iterations, scan }),
                notes,
            })
        }
    }
}
