//! Recipe → skeleton: the one way through both generators.

use std::sync::Arc;

use glam::Vec3;

use crate::colonization::PartError;
use crate::colonization::crown::envelope::EnvelopeError;
use crate::colonization::crown::placed::Placed;
use crate::colonization::crown::{Crown, CrownError};
use crate::colonization::growth::{GrowthError, NodeSet};
use crate::colonization::plant::{Plant, plant};
use crate::colonization::scan::{Fit, Girth, ScanError, fit, girth};
use crate::colonization::scatter::ScatterError;
use crate::foliage::{FoliageError, Organs, sprout};
use crate::knob::printable;
use crate::lsystem::{self, LsystemError};
use crate::memory::{Holding, OverMemory, bytes_of};
use crate::monitor::{Cancelled, Monitor, from_cancellable};
use crate::preset::{Generator, Preset, ScanRadius};
use crate::random::Key;
use crate::recipe::{InputsError, Recipe};
use crate::skeleton::refine::{RefineError, Room, refine};
use crate::skeleton::{Branching, NO_PARENT, Skeleton, SkeletonError, Width, Wood};

/// A grown tree, and how it came about.
#[derive(Clone, Debug)]
pub struct Grown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// What its radii were made by, with the rule settled: for [`Skeleton::until`].
    pub wood: Wood,
    /// What grows on it.
    pub organs: Arc<Organs>,
    /// What its grammar placed: without the leaves of the preset.
    pub given: Arc<Organs>,
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
    /// Whether the points of a scan showed a crown without a stem, and were grown into as they are.
    pub is_canopy: bool,
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

impl Grown {
    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let points = self.colonized.as_ref().map_or(0, |own| own.points.capacity());
        let given = if Arc::ptr_eq(&self.organs, &self.given) { 0 } else { self.given.bytes() };
        self.skeleton.bytes() + self.organs.bytes() + given + bytes_of::<Vec3>(points)
    }
}

/// Why a recipe did not grow.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GrowError {
    /// Nobody wanted the result any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// The L-system.
    #[error("growing the L-system: {0}")]
    LSystem(LsystemError),
    /// The crown's shape.
    #[error("shaping the crown: {0}")]
    Crown(#[from] CrownError),
    /// A part of the crown.
    #[error("shaping the crown, part {number} ({what}): {problem}")]
    Part {
        /// Counted from 1, in the order of the document.
        number: usize,
        /// Its role and what it is, printable.
        what: String,
        /// Why, and what to do.
        problem: PartError,
    },
    /// Obstacles and shade take all points away.
    #[error(
        "all {points} attraction points lie in obstacles or shade; make these smaller, move them, or ask for \
         more points"
    )]
    NoRoom {
        /// How many were scattered.
        points: usize,
    },
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
    /// Refinement.
    #[error("refining: {0}")]
    Refine(RefineError),
    /// The skeleton.
    #[error("building the skeleton: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The leaves.
    #[error("growing leaves: {0}")]
    Foliage(FoliageError),
    /// Files that are missing, or that the preset does not name.
    #[error(transparent)]
    Inputs(#[from] InputsError),
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
    /// Obstacles stand in every way.
    #[error("nothing grew: obstacles stand in the way of every first step; move root, or what is in the way")]
    WalledIn,
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

from_cancellable!(GrowError: LsystemError => LSystem, EnvelopeError => Envelope, ScatterError => Scatter, ScanError => Scan, GrowthError => Growth, RefineError => Refine, FoliageError => Foliage);

/// Grows the tree of a recipe.
///
/// ```
/// use linden::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
/// let preset = builtin("abop-a").unwrap().load().map_err(|fault| fault.message)?;
/// let grown = grow(&Recipe::new(preset), &Quiet)?;
/// assert_eq!(grown.skeleton.segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GrowError`]: limits, contradictions, nothing in reach, cancelled.
pub fn grow(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    recipe.check_inputs()?;
    let Preset { seed, generator, wood, .. } = &recipe.preset;
    if let (Some(base_m), Some(tip_m)) = (wood.base_radius_m, wood.tip_radius_m)
        && base_m < tip_m
    {
        return Err(GrowError::Radii { base_m, tip_m });
    }
    let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
    let key = Key::new(*seed);
    match generator {
        Generator::LSystem(own) => {
            let settings = own.settings(*seed);
            let lsystem::Grown { mut branching, mut organs, symbols } =
                lsystem::grow(&own.grammar, &settings, monitor)?;
            // Without a '!' the turtle's width is the same everywhere.
            if wood.width == Width::Grammar && branching.radii.is_none() {
                let radius_m = (0.5 * own.segment_width_m) as f32;
                branching.radii = Some(vec![radius_m; branching.positions.len()]);
            }
            let monitor = &Holding::new(monitor, organs.bytes());
            let raw = Raw {
                branching,
                captured: None,
                bark: None,
                solids: Vec::new(),
                most_nodes: own.symbol_limit,
            };
            let Built { skeleton, wood, .. } = build(raw, &mut organs, &recipe.preset, monitor)?;
            let given = Arc::new(organs);
            let monitor = Holding::new(monitor, skeleton.bytes());
            Ok(Grown {
                organs: sprout(recipe, &skeleton, &given, &monitor)?,
                given,
                skeleton,
                wood,
                symbols: Some(symbols),
                colonized: None,
                notes: Vec::new(),
            })
        }
        Generator::Colonization(own) => {
            let Plant {
                branching,
                captured,
                points,
                bark,
                is_canopy,
                solids,
                unreached,
                iterations,
                notes,
                ..
            } = plant(own, recipe, key, monitor)?;
            let held = bark.as_ref().map_or(0, Vec::capacity) + points.capacity();
            let monitor = &Holding::new(monitor, bytes_of::<Vec3>(held));
            if let Some(bark) = &bark {
                let bytes = bark.len() as u64 * MEASURING_BYTES_PER_POINT;
                monitor.admit("measuring the scan", bytes + branching.bytes(), "thin the points out")?;
            }
            let measured = bark.as_deref().filter(|_| own.scan_radius == ScanRadius::Points);
            let (captured, most_nodes) = (Some(captured), own.max_nodes.into());
            let raw = Raw { branching, captured, bark: measured, solids, most_nodes };
            let Built { skeleton, wood, measured_nodes } =
                build(raw, &mut Organs::default(), &recipe.preset, monitor)?;
            let scan = match &bark {
                Some(bark) => fit(bark, &skeleton, monitor)?.map(|fit| Scanned {
                    points: bark.len(),
                    measured_nodes,
                    fit,
                }),
                None => None,
            };
            let skeleton = aged(skeleton, own.age, &wood, &recipe.preset, monitor)?;
            let given = Arc::default();
            let monitor = Holding::new(monitor, skeleton.bytes());
            Ok(Grown {
                organs: sprout(recipe, &skeleton, &given, &monitor)?,
                given,
                skeleton,
                wood,
                symbols: None,
                colonized: Some(Colonized { points, unreached, iterations, is_canopy, scan }),
                notes,
            })
        }
    }
}

/// The tree as it was after a share of its births; the first segment at least.
fn aged(
    skeleton: Arc<Skeleton>,
    age: f64,
    wood: &Wood,
    preset: &Preset,
    monitor: &dyn Monitor,
) -> Result<Arc<Skeleton>, OverMemory> {
    if age >= 1.0 {
        return Ok(skeleton);
    }
    skeleton.admit_until(wood, monitor)?;
    let last = skeleton.births.iter().copied().max().unwrap_or(0);
    let on_foot = |&node: &usize| {
        let parent = skeleton.parents[node];
        parent != NO_PARENT && skeleton.parents[parent as usize] == NO_PARENT
    };
    let first = (0..skeleton.parents.len()).filter(on_foot).map(|node| skeleton.births[node]).min();
    let step = (libm::ceil(age * f64::from(last)) as u32).max(first.unwrap_or(0));
    Ok(Arc::new(skeleton.until(step, wood, preset.wood_key())))
}

/// The nearest segments of all points, and the search for points near segments.
pub(crate) const MEASURING_BYTES_PER_POINT: u64 = 120;

/// What a generator leaves behind.
struct Raw<'a> {
    branching: Branching,
    /// The nodes that were of use, where there is such a thing.
    captured: Option<NodeSet>,
    /// Points on the bark, metres, that are to say how thick the wood is.
    bark: Option<&'a [Vec3]>,
    /// What no branch is to enter, at the same place.
    solids: Vec<Placed>,
    /// The generator's own limit holds for the refined tree too.
    most_nodes: u64,
}

/// What becomes of it.
struct Built {
    skeleton: Arc<Skeleton>,
    /// With its rule settled.
    wood: Wood,
    /// Nodes whose radius was measured.
    measured_nodes: usize,
}

/// What both generators' branchings go through: refinement, which takes the organs along, then axes
/// and radii.
fn build(
    Raw { mut branching, captured, bark, solids, most_nodes }: Raw,
    organs: &mut Organs,
    preset: &Preset,
    monitor: &dyn Monitor,
) -> Result<Built, GrowError> {
    if !preset.refinement.is_idle() {
        let is_barred = |p: Vec3| solids.iter().any(|solid| solid.contains(p.as_dvec3()));
        let room = Room { most_nodes, is_barred: &is_barred, key: preset.wood_key(), wood: preset.wood };
        branching.validate()?;
        let nodes = branching.parents.len();
        let captured = captured.map(|set| (0..nodes).map(|node| set.contains(node)).collect());
        let mut riders = organs.riders();
        branching = refine(branching, captured, &mut riders, &preset.refinement, room, monitor)?;
        organs.follow(&riders);
    }
    let mut measured_nodes = 0;
    // What the user says of the foot counts more than what was measured.
    if let Some(bark) = bark.filter(|_| preset.wood.base_radius_m.is_none())
        && let Some(Girth { radii, measured }) =
            girth(&branching, bark, preset.wood.radius_exponent, monitor)?
    {
        branching.radii = Some(radii);
        measured_nodes = measured;
    }
    branching.admit_build(&preset.wood, monitor)?;
    let wood = preset.wood.settled(branching.radii.is_some());
    let skeleton = Skeleton::build_keyed(branching, &wood, preset.wood_key())?;
    Ok(Built { skeleton: Arc::new(skeleton), wood, measured_nodes })
}
