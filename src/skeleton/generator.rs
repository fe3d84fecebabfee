//! What grows the axial tree: the trait that every generator implements.
//!
//! A generator is a crate of its own: a type of settings with a table of knobs, and one static that
//! implements [`Generator`]. One line in linden's registry makes it a table of documents, a section of the
//! workbench's form and of every listing of knobs. It knows no document, no file and no other generator:
//! values come in by [`Settings::set`] and [`Generator::read`], files by their names in [`Task::inputs`].

use std::any::Any;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use linden_base::document::{Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

use crate::organs::Organs;
use crate::publication::Publication;
use crate::{AxisRule, Branching, RadiusFit, Skeleton, Wood};

pub use crate::obstruction::{FaceEdge, Obstruction, Obstructs};

/// A way to grow trees.
pub trait Generator: Sync {
    /// What scripts call it, and the key of its table in documents: lower-case letters.
    fn id(&self) -> &'static str;

    /// What people call it.
    fn name(&self) -> &'static str;

    /// One line: how it grows trees.
    fn help(&self) -> &'static str;

    /// What its method is from: for those who cite a tree of it.
    fn publications(&self) -> &'static [Publication] {
        &[]
    }

    /// All knobs that settings of it may have, each once, in the order of documents and forms. The first is
    /// turned before the others, wherever it stands in a document: it may decide which others there are.
    fn knobs(&self) -> Vec<Knob>;

    /// Whether documents may declare knobs of numbers of their own in its table, which [`Settings::knobs`] have then too.
    fn takes_declared_knobs(&self) -> bool {
        false
    }

    /// What its table holds besides knobs.
    fn keys(&self) -> &'static [TableKey];

    /// The settings that a table describes, before its knobs are turned. Entries that are knobs are not
    /// looked at.
    ///
    /// # Errors
    /// [`Fault`]: what is wrong with one of [`Generator::keys`], and where.
    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault>;

    /// Knobs that its table had once and that mean nothing any more: they are passed over.
    fn former_knobs(&self) -> &'static [&'static str] {
        &[]
    }

    /// What to do instead, where `typed` is no value of a knob: an end for the message.
    fn value_hint(&self, _knob: &str, _typed: &str, _asked: Asked) -> Option<&'static str> {
        None
    }

    /// What to write instead of a key that its table does not have.
    fn key_hint(&self, _key: &str) -> Option<&'static str> {
        None
    }
}

impl fmt::Debug for dyn Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// Where a value was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// On a command line or in a form.
    Directly,
    /// In a document.
    InDocument,
}

/// Steps in which a tree grew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// How many.
    pub count: u32,
    /// What one of them is called, like `derivation`.
    pub unit: &'static str,
}

impl Steps {
    /// How many of `count` steps a tree has behind it after a share of its growth: one at least, where there are any.
    ///
    /// ```
    /// use linden_skeleton::generator::Steps;
    /// assert_eq!([0.0, 0.2, 0.21, 1.0].map(|age| Steps::after(age, 5)), [1, 1, 2, 5]);
    /// assert_eq!(Steps::after(0.3, 0), 0);
    /// ```
    pub fn after(age: f64, count: u32) -> u32 {
        // Shares of whole numbers come out a little above them.
        let step = libm::ceil(age * f64::from(count) - 1e-9) as u32;
        step.clamp(count.min(1), count)
    }

    /// The number of steps and the share of them that settings of `count` steps have for the tree at a step. What is not
    /// drawn yet has no age, and no tree is older than it is whole.
    ///
    /// ```
    /// use linden_skeleton::generator::Steps;
    /// let (count, age) = Steps::at(3, 7);
    /// assert_eq!((count, Steps::after(age, count)), (7, 3));
    /// assert_eq!([Steps::at(0, 7), Steps::at(9, 7)], [(0, 1.0), (9, 1.0)]);
    /// ```
    pub fn at(step: u32, count: u32) -> (u32, f64) {
        if (1..count).contains(&step) { (count, f64::from(step) / f64::from(count)) } else { (step, 1.0) }
    }
}

/// A key of a generator's table that is no knob.
#[derive(Clone, Copy)]
pub struct TableKey {
    /// The key.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// The type of its value.
    pub content: KeyContent,
}

/// The type of a value in a generator's table.
#[derive(Clone, Copy)]
pub enum KeyContent {
    /// Text.
    Text,
    /// A list of texts.
    Texts,
    /// The name of a file, relative to the document.
    File,
    /// A list of tables.
    Tables(Tables),
}

/// A list of tables in a document, as a schema describes it.
#[derive(Clone, Copy)]
pub struct Tables {
    /// The knobs that each may have.
    pub knobs: fn() -> Vec<Knob>,
    /// Keys that each must have.
    pub required: &'static [&'static str],
    /// Keys of which each must have exactly one, if there are any.
    pub one_of: &'static [&'static str],
    /// Keys that name files, with a line of help.
    pub files: &'static [(&'static str, &'static str)],
    /// The most tables.
    pub most: usize,
}

/// The settings of a generator: what a tree is to grow like.
pub trait Settings: Any + fmt::Debug + Send + Sync + Duplicate {
    /// The generator that they are for.
    fn generator(&self) -> &'static dyn Generator;

    /// The knobs that these settings have, with their values: some of [`Generator::knobs`], in that order, and behind them
    /// those that the document declared.
    fn knobs(&self) -> Vec<(Knob, Value)>;

    /// Whether a knob's value is what [`Settings::written`] says already, so that documents need not name the knob.
    fn is_written(&self, _knob: &str) -> bool {
        false
    }

    /// Turns a knob to a value that its kind has checked; whether these settings have such a knob.
    fn set(&mut self, knob: &str, value: Value) -> bool;

    /// What documents have besides knobs: the entries of [`Generator::keys`] that these settings have.
    fn written(&self) -> Vec<(&'static str, Written)> {
        Vec::new()
    }

    /// Gives a key of [`Settings::written`] another text, where that is no file; whether these settings have such a key.
    fn set_text(&mut self, _key: &str, _text: &str) -> bool {
        false
    }

    /// The trees that their input tells apart, where a knob picks one of several and is not turned.
    ///
    /// # Errors
    /// [`GeneratorError`]: the input cannot be divided as they ask for, memory, cancelled.
    fn trees(&self, _inputs: &Inputs, _monitor: &dyn Monitor) -> Result<Option<InputTrees>, GeneratorError> {
        Ok(None)
    }

    /// The same with every knob at its default.
    fn plain(&self) -> Box<dyn Settings>;

    /// The files that they need, by the names that documents have for them.
    fn inputs(&self) -> Vec<&str> {
        Vec::new()
    }

    /// The sides of the cubes that the points of their file may be thinned to while they are read, in the file's units; with
    /// other points than these settings would keep they do not grow.
    fn thinning(&self) -> Option<f64> {
        None
    }

    /// Gives files other names: `renamed` has the new one of an old one, if it changes.
    fn rename_inputs(&mut self, _renamed: &dyn Fn(&str) -> Option<String>) {}

    /// What a page says of them besides knobs, with the files that they need at hand: a grammar, what the
    /// tree grows in.
    fn describe(&self, _inputs: &Inputs) -> Vec<Passage> {
        Vec::new()
    }

    /// Why a knob of theirs changes nothing as they stand, and what would let it.
    fn idle(&self, _knob: &str, _wood: &Wood) -> Option<&'static str> {
        None
    }

    /// What they leave to others, and what not.
    fn traits(&self, _wood: &Wood) -> Traits {
        Traits::default()
    }

    /// Grows a tree.
    ///
    /// # Errors
    /// [`GeneratorError`]: limits, contradictions, nothing to grow into, files of the wrong kind, cancelled.
    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError>;

    /// Polylines that draw what the tree grows in, metres, where the tree of [`Settings::grow`] stands.
    ///
    /// # Errors
    /// Those of growing that have to do with it.
    fn outline(&self, _task: &Task<'_>, _monitor: &dyn Monitor) -> Result<Vec<Vec<Vec3>>, GeneratorError> {
        Ok(Vec::new())
    }

    /// What stands in the tree's way, and what takes light from it, where the tree of [`Settings::grow`] stands.
    ///
    /// # Errors
    /// Those of growing that have to do with it.
    fn obstructions(
        &self,
        _task: &Task<'_>,
        _monitor: &dyn Monitor,
    ) -> Result<Vec<Obstruction>, GeneratorError> {
        Ok(Vec::new())
    }

    /// Whether another seed may give another skeleton.
    fn draws(&self) -> bool {
        true
    }

    /// The steps in which the tree grew, where births do not tell what it was like in each.
    fn steps(&self) -> Option<Steps> {
        None
    }

    /// The settings of the tree as it was after some of [`Settings::steps`].
    fn at_step(&self, _step: u32) -> Option<Box<dyn Settings>> {
        None
    }

    /// The settings of the whole tree, where these are of a younger one that is grown anew.
    fn whole(&self) -> Option<Box<dyn Settings>> {
        None
    }

    /// Leaves the tree where its input has it, unless it was told to stand elsewhere. The place of its root
    /// where it has no such input.
    fn stay(&mut self) -> Option<[f64; 3]> {
        Some([0.0; 3])
    }

    /// Lowers limits, so that no tree much larger than `size` is grown. Whether a tree with as many nodes as
    /// `size` has is one that was cut short.
    ///
    /// # Errors
    /// What is too large to begin with: `2000000 points`.
    fn limit(&mut self, _inputs: &Inputs, _size: &SampleSize) -> Result<bool, String> {
        Ok(false)
    }

    /// Plans a small tree of which this one is a multiple, for forecasts; by default the whole tree is
    /// grown, as far as a forecast's limit of memory lets it.
    ///
    /// # Errors
    /// As growing.
    fn sampler<'a>(
        &'a self,
        _task: &Task<'a>,
        _size: SampleSize,
        _monitor: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(Whole { settings: Some(self.duplicate()) }))
    }
}

/// Copies and compares settings behind a pointer; every type that is [`Clone`] and [`PartialEq`] does.
pub trait Duplicate {
    /// A copy.
    fn duplicate(&self) -> Box<dyn Settings>;

    /// Whether others are of the same type and equal.
    fn equals(&self, other: &dyn Settings) -> bool;
}

impl<T: Settings + Clone + PartialEq> Duplicate for T {
    fn duplicate(&self) -> Box<dyn Settings> {
        Box::new(self.clone())
    }

    fn equals(&self, other: &dyn Settings) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<T>() == Some(self)
    }
}

impl Clone for Box<dyn Settings> {
    fn clone(&self) -> Self {
        (**self).duplicate()
    }
}

impl PartialEq for Box<dyn Settings> {
    fn eq(&self, other: &Self) -> bool {
        (**self).equals(&**other)
    }
}

// Without it, a derived comparison of a struct that holds one would move out of it (rust-lang/rust#31740).
impl PartialEq<&Self> for Box<dyn Settings> {
    fn eq(&self, other: &&Self) -> bool {
        (**self).equals(&***other)
    }
}

impl dyn Settings {
    /// The settings as a type of a generator's, if they are.
    pub fn downcast_ref<T: Settings>(&self) -> Option<&T> {
        let any: &dyn Any = self;
        any.downcast_ref()
    }

    /// The settings as a type of a generator's, if they are.
    pub fn downcast_mut<T: Settings>(&mut self) -> Option<&mut T> {
        let any: &mut dyn Any = self;
        any.downcast_mut()
    }
}

/// An entry of a table that is no knob.
#[derive(Clone, Debug, PartialEq)]
pub enum Written {
    /// Text, or a file's name.
    Text(String),
    /// A list of texts.
    Texts(Vec<String>),
    /// A list of tables: names and values.
    Tables(Vec<Vec<(&'static str, Value)>>),
}

/// Lines of a page under a heading. Text of a document's is in them as it is: a terminal needs it made
/// printable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Passage {
    /// In lower case.
    pub heading: &'static str,
    /// Without indents but those that tell lines from lines of theirs.
    pub lines: Vec<String>,
}

/// The traits of a generator's trees, from which it follows which knobs of wood and foliage have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Traits {
    /// Where radii come from.
    pub radii: RadiiFrom,
    /// What [`AxisRule::Auto`] stands for: [`AxisRule::Grammar`] where it says which child continues an
    /// axis ([`Branching::edges`]).
    pub axes: AxisRule,
    /// Whether they place leaves and the like.
    pub places_organs: bool,
    /// Whether it is known of each node whether it was of use, so that pruning goes by that.
    pub knows_use: bool,
    /// Whether births tell old wood from young.
    pub tells_age: bool,
}

impl Default for Traits {
    /// Bare wood, thickened by its rule.
    fn default() -> Self {
        Self {
            radii: RadiiFrom::Rule,
            axes: AxisRule::Thickest,
            places_organs: false,
            knows_use: false,
            tells_age: true,
        }
    }
}

/// Where radii come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadiiFrom {
    /// The wood's rule.
    Rule,
    /// The generator itself.
    Generator,
    /// What was measured of the tree, where there is enough of it.
    Measured,
}

/// The inputs of growth besides the generator's settings.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The number that all random choices follow from.
    pub seed: u64,
    /// The files that [`Settings::inputs`] names.
    pub inputs: &'a Inputs,
    /// How thick the wood is to be.
    pub wood: Wood,
}

impl Task<'_> {
    /// The root of all random choices.
    pub const fn key(&self) -> Key {
        Key::new(self.seed)
    }
}

/// The tree as a generator grows it, before refinement, and notes about it.
#[derive(Default)]
pub struct Branched {
    /// Nodes and their parents.
    pub branching: Branching,
    /// Leaves and other organs that it placed on the nodes.
    pub organs: Organs,
    /// The nodes that were of use, where there is such a thing; else the lengths of twigs decide what is
    /// pruned.
    pub used: Option<Vec<bool>>,
    /// The generator's limit of nodes, which holds for the refined tree too.
    pub most_nodes: u64,
    /// Whether no branch is to be moved to a place.
    pub barred: Option<Barred>,
    /// Measurements that the generator made of the tree.
    pub measured: Option<Box<dyn Measured>>,
    /// The share of its births that is to be shown; `None`: all.
    pub age: Option<f64>,
    /// Length of the derived string, for L-systems.
    pub symbols: Option<u64>,
    /// The attraction points, and how many were reached.
    pub colonized: Option<Colonized>,
    /// Messages for the user: limits that were hit, meshes that are open.
    pub notes: Vec<String>,
}

/// Whether a place, metres, is not to be entered.
pub type Barred = Box<dyn Fn(Vec3) -> bool + Send + Sync>;

/// Measurements of a real tree, where the tree of a generator stands.
pub trait Measured: Send + Sync {
    /// How many points beside them were taken for leaves, and measure nothing.
    fn leaf_points(&self) -> usize {
        0
    }

    /// Bytes that they take.
    fn bytes(&self) -> u64;

    /// Asks for the memory of [`Measured::measure`] and [`Measured::gaps`].
    ///
    /// # Errors
    /// [`OverMemory`].
    fn admit(&self, branching: &Branching, monitor: &dyn Monitor) -> Result<(), OverMemory>;

    /// Gives all nodes radii, metres, and moves them where the wood was measured to be; strands that lie in thicker
    /// wood may go. What bears out the radius of each node that stays; `None` where radii are to follow the wood's
    /// rule.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn measure(
        &self,
        branching: &mut Branching,
        wood: &Wood,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<RadiusFit>>, Cancelled>;

    /// How far the tree and the measurements are apart; `None` where there is nothing to measure from or to.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn gaps(&self, skeleton: &Skeleton, monitor: &dyn Monitor) -> Result<Option<Gaps>, Cancelled>;

    /// The points.
    fn into_points(self: Box<Self>) -> Vec<Vec3>;
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
    /// The place of its foot in the file that it grew into, in the file's axes and units; `None` where it grew into none.
    pub foot: Option<DVec3>,
    /// How the tree compares with the scan that it grew into; `None` for what is no scan.
    pub scan: Option<Scanned>,
}

impl Colonized {
    /// The points that people want to see: those of the scan, where it grew into one, else the attraction points.
    pub fn seen(&self) -> &[Vec3] {
        self.scan.as_ref().map_or(&self.points, |scan| &scan.points)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.points.capacity()) + self.scan.as_ref().map_or(0, Scanned::bytes)
    }
}

/// Trees that an input tells apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputTrees {
    /// The knob that picks one by its number.
    pub knob: &'static str,
    /// What tells them apart, as a message names it: a column, a file.
    pub told_by: String,
    /// What they are made of: `points`.
    pub made_of: &'static str,
    /// The numbers in rising order, with how much of that each tree has.
    pub numbers: Vec<(u32, usize)>,
}

/// A scan, and how near the tree that grew into it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Scanned {
    /// Points of the tree, metres, where it stands: those on wood, without ground, strays, noise
    /// and leaves.
    pub points: Arc<Vec<Vec3>>,
    /// How far each of them is from the bark, metres.
    pub gaps_m: Arc<Vec<f32>>,
    /// Points that were taken for leaves.
    pub leaf_points: usize,
    /// Nodes whose radius was measured on points; the others' are carried on or guessed.
    pub measured_nodes: usize,
    /// Distances both ways.
    pub fit: Fit,
}

impl Scanned {
    /// Bytes that its points take.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Vec3>(self.points.capacity()) + bytes_of::<f32>(self.gaps_m.capacity())
    }
}

/// How far measured points and a skeleton are apart, one by one and in all.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    /// In all.
    pub fit: Fit,
    /// From each point to the bark, metres.
    pub of_points_m: Vec<f32>,
    /// From the bark of the segment below each node to the nearest point, metres; 0 at nodes that have none below.
    pub of_nodes_m: Vec<f32>,
}

/// Distances between measured points and a skeleton, both ways. All are exact: to the nearest point of the
/// nearest segment, not to the nearest node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// From each scanned point to the nearest axis.
    pub points_to_axis: Spread,
    /// From each scanned point to the bark around the nearest axis: how far the distance to the axis is
    /// from the radius there.
    pub points_to_surface: Spread,
    /// From the middle of each segment to the nearest scanned point.
    pub axis_to_points: Spread,
    /// From places on the bark, evenly by area, to the nearest scanned point: wood that no point bears out.
    pub surface_to_points: Spread,
}

/// Many distances in two numbers, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The mean.
    pub mean_m: f64,
    /// 95 % are not above it.
    pub p95_m: f64,
}

impl Spread {
    /// Of some distances, metres; `None` without any.
    pub fn of(mut distances: Vec<f64>) -> Option<Self> {
        // One after the other: the sum is the same on any number of threads.
        let mean_m = distances.iter().sum::<f64>() / distances.len() as f64;
        let rank = (distances.len() * 95).div_ceil(100).checked_sub(1)?;
        let (_, &mut p95_m, _) = distances.select_nth_unstable_by(rank, f64::total_cmp);
        Some(Self { mean_m, p95_m })
    }
}

/// Why nothing grew.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GeneratorError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for what comes next.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// What the generator says.
    #[error(transparent)]
    Failed(Arc<dyn Error + Send + Sync>),
}

impl GeneratorError {
    /// Wraps an error type that the generator defines.
    pub fn failed(error: impl Error + Send + Sync + 'static) -> Self {
        Self::Failed(Arc::new(error))
    }

    /// The wrapped error, where it has the type that the generator defines.
    pub fn downcast_ref<E: Error + 'static>(&self) -> Option<&E> {
        match self {
            Self::Failed(error) => error.downcast_ref(),
            _ => None,
        }
    }
}

/// How large a sample may be.
#[derive(Clone, Copy, Debug)]
pub struct SampleSize {
    /// Attraction points, or points of a scan.
    pub points: usize,
    /// Nodes at which growth stops.
    pub nodes: u32,
    /// Symbols of a derived string.
    pub symbols: u64,
    /// How often refinement will halve all segments.
    pub halvings: u32,
}

/// Plans a sample, growing as often as it needs to.
pub trait Sampler {
    /// What to do next; `grown` is what the last [`SampleStep::Grow`] came to.
    ///
    /// # Errors
    /// As growing.
    fn next(&mut self, grown: Option<&Skeleton>) -> Result<SampleStep, GeneratorError>;
}

/// A step of a [`Sampler`].
pub enum SampleStep {
    /// Grow these.
    Grow {
        /// Smaller settings.
        settings: Box<dyn Settings>,
        /// What stands in place of some inputs.
        inputs: Inputs,
    },
    /// What grew last is the sample.
    Done(Multiple),
}

/// The tree as a multiple of its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiple {
    /// Nodes of the tree ÷ nodes of the sample.
    pub wood_times: f64,
    /// Leaves of the tree ÷ leaves of the sample.
    pub leaf_times: f64,
    /// Points that the tree grows into ÷ those of the sample.
    pub point_times: f64,
    /// Tips of the tree on each of its stems ÷ tips of the sample.
    pub crowding: f64,
    /// Distances of the sample ÷ those of the tree.
    pub coarser: f64,
}

impl Multiple {
    /// Where the sample is the whole tree.
    pub const ONE: Self =
        Self { wood_times: 1.0, leaf_times: 1.0, point_times: 1.0, crowding: 1.0, coarser: 1.0 };
}

/// Grows the whole tree.
struct Whole {
    settings: Option<Box<dyn Settings>>,
}

impl Sampler for Whole {
    fn next(&mut self, _: Option<&Skeleton>) -> Result<SampleStep, GeneratorError> {
        Ok(match self.settings.take() {
            Some(settings) => SampleStep::Grow { settings, inputs: Inputs::new() },
            None => SampleStep::Done(Multiple::ONE),
        })
    }
}
