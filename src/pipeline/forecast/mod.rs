//! How large a tree will be, before it is grown: from a small one like it.
//!
//! What is little work is grown as it is, and every count is exact. A larger tree is taken for a
//! multiple of a smaller one:
//!
//! - **colonization**: fewer points in the same crown; step, kill and influence are longer by as much
//!   as the points are farther apart. Growth is similar at any scale, so that nodes go with the points.
//! - **L-systems**: fewer derivations. How much the others give is counted by the growth matrix
//!   ([`lsystem::forecast`](linden_lsystem::forecast())); where that would take too long, followed from
//!   how the string grew so far.
//! - **scans**: a part of the points, in steps that suit them; wood is as long in any steps.
//!
//! Takes some ten milliseconds at most, whatever the settings, by counting its work: how many points,
//! symbols, nodes and leaves it may take is fixed below. Reads no clock: seconds follow from rates, see
//! `linden_exporters::Estimate`.

use std::sync::Arc;

use linden_base::memory::OverMemory;
use linden_base::monitor::{Monitor, Phase};
use linden_plant::foliage::{FoliageError, GROWING, Organs};
use linden_plant::settings::Form;
use linden_skeleton::generator::{Multiple, SampleSize, SampleStep};
use linden_skeleton::refine::Refinement;
use linden_skeleton::{NO_PARENT, SideWood, Skeleton, Width};

use crate::grow::{GrowError, Grown, grow, sprout};
use crate::preset::Preset;
use crate::recipe::Recipe;

/// Attraction points, or points of a scan, of a sample.
const POINTS: usize = 4000;
/// Nodes at which a sample stops to grow.
const NODES: u32 = 40_000;
/// Symbols of a sample.
const SYMBOLS: u64 = 120_000;
/// Leaves of a sample.
const LEAVES: u64 = 80_000;
/// How often leaves are thinned until they are few enough.
const ROUNDS: usize = 6;
/// What a sample may take at most: only nonsense needs more.
const SAMPLE_BYTES: u64 = 128 << 20;

/// Most times that a tree is larger than its sample.
const MOST_TIMES: f64 = 1e9;

/// A small tree, and how many times as much a large one has.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The recipe of the sample.
    pub recipe: Recipe,
    /// The sample.
    pub grown: Grown,
    /// Nodes of the tree ÷ nodes of the sample; so do axes and the wood's triangles. 1 where the sample
    /// is the tree.
    pub wood_times: f64,
    /// Leaves of the tree ÷ leaves of the sample.
    pub leaf_times: f64,
    /// Points that the tree grows into ÷ those of the sample: they take time, be the tree larger or not.
    pub point_times: f64,
    /// How many times as much work the tree is, where that does not go with these.
    work_times: Option<f64>,
}

impl Sample {
    /// Whether the sample is the tree itself, and counts are exact.
    pub fn is_whole(&self) -> bool {
        self.wood_times == 1.0 && self.leaf_times == 1.0
    }

    /// How many times as much work the tree is.
    pub fn work_times(&self) -> f64 {
        self.work_times.unwrap_or_else(|| self.wood_times.max(self.leaf_times).max(self.point_times))
    }

    /// Nodes of the tree's skeleton.
    pub fn nodes(&self) -> f64 {
        self.wood_times * self.grown.skeleton.positions.len() as f64
    }

    /// Segments drawn: nodes that stand on another.
    pub fn segments(&self) -> f64 {
        self.nodes() - self.wood_times.min(1.0) * feet(&self.grown.skeleton) as f64
    }

    /// Leaves and other organs.
    pub fn leaves(&self) -> f64 {
        self.leaf_times * self.grown.organs.len() as f64
    }

    /// Symbols of the derived string; `None` for what is no L-system.
    pub fn symbols(&self) -> Option<f64> {
        self.grown.symbols.map(|symbols| symbols as f64 * self.wood_times)
    }

    /// Bytes that nodes and skeleton take while the skeleton is built, about; `None` beyond counting.
    pub fn skeleton_bytes(&self) -> Option<u64> {
        let nodes = self.nodes();
        (nodes < 1e15).then(|| Skeleton::build_bytes(nodes as usize)).flatten()
    }
}

/// Grows a tree of which a recipe's is a multiple.
///
/// ```
/// use linden_pipeline::{Quiet, forecast::sample, preset::builtin, recipe::Recipe};
/// let preset = builtin("abop-a")?.load()?;
/// let mut recipe = Recipe::new(preset);
/// assert_eq!(sample(&recipe, &Quiet)?.nodes(), 3126.0); // grown as it is
/// recipe.preset.set("derivations", "9")?;
/// let nodes = sample(&recipe, &Quiet)?.nodes();
/// assert!((nodes / 1_953_126.0 - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GrowError`] where not even the sample grows.
pub fn sample(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Sample, GrowError> {
    let monitor = &Sparing { monitor };
    let foliage = recipe.preset.dressing.foliage.clone();
    let mut bare = recipe.clone();
    bare.preset.dressing.foliage.first.form = Form::None;
    bare.preset.dressing.foliage.also.clear();
    // They name axes of the whole tree.
    bare.preset.edits.clear();
    // A few on the trunk, which a multiple of the sample would have more of.
    bare.preset.refinement.side = SideWood::default();
    let (mut recipe, mut grown, multiple) = small(bare, monitor)?;
    let Multiple { wood_times, mut leaf_times, point_times, crowding, coarser, work_times } = multiple;
    // More could not be counted in bytes, and nothing is so large.
    let wood_times = wood_times.min(MOST_TIMES);
    recipe.preset.dressing.foliage = foliage;
    adapt(&mut recipe.preset, &grown, crowding, coarser);
    for round in 0.. {
        // Of very many, a part: the same in fewer places.
        let part = match leaves(&recipe, &grown, monitor) {
            Ok(organs) => {
                grown.organs = organs;
                break;
            }
            Err(FoliageError::Memory(over)) if over.doing == GROWING && round < ROUNDS => {
                0.8 * over.limit_bytes as f64 / over.needs_bytes as f64
            }
            Err(FoliageError::TooMany { leaves, .. }) if round < ROUNDS => LEAVES as f64 / leaves as f64,
            Err(error) => return Err(error.into()),
        };
        leaf_times /= part;
        thin(&mut recipe.preset, part);
    }
    let leaf_times = leaf_times.min(MOST_TIMES);
    Ok(Sample { recipe, grown, wood_times, leaf_times, point_times, work_times })
}

/// How often refinement halves all segments.
fn halvings(refinement: &Refinement) -> u32 {
    let times = refinement.steps.iter().filter(|step| step.name == "subdivide").count();
    refinement.subdivisions.saturating_mul(times as u32)
}

/// Grows a sample of a recipe without leaves, as its generator plans it.
fn small(mut recipe: Recipe, monitor: &dyn Monitor) -> Result<(Recipe, Grown, Multiple), GrowError> {
    recipe.check_inputs()?;
    let whole = recipe.preset.generator.clone();
    let inputs = recipe.inputs.clone();
    let halvings = halvings(&recipe.preset.refinement);
    let size = SampleSize { points: POINTS, nodes: NODES, symbols: SYMBOLS, halvings };
    let task = linden_skeleton::generator::Task { inputs: &inputs, ..recipe.task() };
    let mut sampler = whole.sampler(&task, size, monitor)?;
    let mut grown: Option<Grown> = None;
    loop {
        match (sampler.next(grown.as_ref().map(|grown| &*grown.skeleton))?, grown.take()) {
            (SampleStep::Grow { settings, inputs }, _) => {
                recipe.preset.generator = settings;
                for (name, input) in inputs.iter() {
                    recipe.inputs.insert(name, input.clone());
                }
                grown = Some(grow(&recipe, monitor)?);
            }
            (SampleStep::Done(multiple), Some(grown)) => return Ok((recipe, grown, multiple)),
            // A sampler that grew nothing: the whole tree is the sample.
            (SampleStep::Done(_), None) => {
                recipe.preset.generator = whole.clone();
                let grown = grow(&recipe, monitor)?;
                return Ok((recipe, grown, Multiple::ONE));
            }
        }
    }
}

fn leaves(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Arc<Organs>, FoliageError> {
    sprout(recipe, &grown.skeleton, &grown.given, &Leaves { monitor })
}

/// Makes twigs of the sample as the tree's are: as many leaves a segment, as many sides.
fn adapt(preset: &mut Preset, grown: &Grown, crowding: f64, coarser: f64) {
    // By the pipe model, and by what grammars say, tips are thicker where there are fewer of them on the
    // same trunk, in shares of which sides are counted: with the root of the thickness.
    if crowding > 1.0 && !matches!(grown.wood.width, Width::Order | Width::Taper) {
        let thicker = libm::pow(crowding, 1.0 / preset.wood.radius_exponent.max(0.1));
        preset.dressing.tubes.sides =
            ((f64::from(preset.dressing.tubes.sides) / thicker.sqrt()).round() as u32).max(3);
        if preset.wood.tip_radius_m.is_none() && coarser > 1.0 {
            for kind in preset.dressing.foliage.kinds_mut() {
                kind.max_radius_m = kind.max_radius_m.map(|radius| radius * thicker);
            }
        }
    }
    for kind in preset.dressing.foliage.kinds_mut() {
        kind.per_m /= coarser;
    }
}

/// Leaves a part of the leaves.
fn thin(preset: &mut Preset, part: f64) {
    for kind in preset.dressing.foliage.kinds_mut() {
        // Ends of twigs bear few beside those along them.
        kind.terminal = false;
        if kind.grid.first().is_some_and(|&along| along > 0.0) {
            kind.keep *= part;
        } else {
            kind.per_m *= part;
        }
    }
}

/// Nodes that stand on the ground or on bare trunks.
fn feet(skeleton: &Skeleton) -> usize {
    skeleton.parents.iter().filter(|&&parent| parent == NO_PARENT).count()
}

/// Keeps a sample small, and says nothing of its progress.
struct Sparing<'a> {
    monitor: &'a dyn Monitor,
}

impl Monitor for Sparing<'_> {
    fn is_cancelled(&self) -> bool {
        self.monitor.is_cancelled()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.monitor.memory_limit().min(SAMPLE_BYTES)
    }
}

/// The same for leaves: by what [`sprout`] asks for, some 140 bytes a leaf.
struct Leaves<'a> {
    monitor: &'a dyn Monitor,
}

impl Monitor for Leaves<'_> {
    fn is_cancelled(&self) -> bool {
        self.monitor.is_cancelled()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.monitor.memory_limit()
    }

    fn admit(&self, doing: &'static str, bytes: u64, advice: &'static str) -> Result<(), OverMemory> {
        let limit_bytes = self.memory_limit().min(LEAVES * 140);
        if doing == GROWING && bytes > limit_bytes {
            return Err(OverMemory { doing, needs_bytes: bytes, limit_bytes, advice });
        }
        self.monitor.admit(doing, bytes, advice)
    }
}
