//! What grows the axial tree: the trait that every generator implements.
//!
//! A generator is a crate of its own: a type of settings with a table of knobs, and one static that
//! implements [`Generator`]. One line in linden's registry makes it a table of documents, a section of the
//! workbench's form and of every listing of knobs. It knows no document, no file and no other generator:
//! values come in by [`Settings::set`] and [`Generator::read`], files by their names in [`Task::inputs`].

mod branched;
mod sample;
mod scanned;
mod steps;
mod table;

use std::any::Any;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

use glam::Vec3;
use linden_base::document::{Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value};
use linden_base::memory::OverMemory;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

use crate::publication::Publication;
use crate::{AxisRule, Wood};

pub use crate::obstruction::{FaceEdge, Obstruction, Obstructs};
pub use branched::{Barred, Branched, Colonized, InputTrees, Measured};
pub use sample::{Multiple, SampleSize, SampleStep, Sampler};
pub use scanned::{Fit, Gaps, Scanned, Spread};
pub use steps::Steps;
pub use table::{KeyContent, Passage, TableKey, Tables, Written};

/// A way to grow trees.
pub trait Generator: Sync {
    /// What scripts call it, and the key of its table in documents: lower-case letters.
    fn id(&self) -> &'static str;

    /// What people call it.
    fn name(&self) -> &'static str;

    /// One line: how it grows trees.
    fn help(&self) -> &'static str;

    /// What its method is from, whatever its knobs say. [`Settings::publications`] is for those who cite a tree.
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

    /// What the method is from that grows a tree of these settings: those of the generator, and those of what its knobs
    /// ask for.
    fn publications(&self) -> Vec<Publication> {
        self.generator().publications().to_vec()
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
        Ok(Box::new(sample::Whole::new(self.duplicate())))
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

/// The traits of a generator's trees, from which it follows which knobs of wood and foliage have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Traits {
    /// Where radii come from.
    pub radii: RadiiFrom,
    /// What [`AxisRule::Auto`] stands for: [`AxisRule::Grammar`] where it says which child continues an
    /// axis ([`Branching::edges`](crate::Branching::edges)).
    pub axes: AxisRule,
    /// What they bear.
    pub bears: Bears,
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
            bears: Bears::Nothing,
            knows_use: false,
            tells_age: true,
        }
    }
}

/// What a generator places on the wood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bears {
    /// Nothing.
    Nothing,
    /// Organs with shapes of their own.
    Organs,
    /// Leaves that are there only where the first kind of foliage has a form
    /// ([`Organs::need_form`](crate::organs::Organs::need_form)).
    Leaves,
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
    #[error("{doing}{error}")]
    Failed {
        /// What was being done, with a colon and a blank behind it; nothing where the error says so itself.
        doing: &'static str,
        /// The error in the type that the generator defines.
        #[source]
        error: Arc<dyn Error + Send + Sync>,
    },
}

impl GeneratorError {
    /// Wraps an error type that the generator defines.
    pub fn failed(error: impl Error + Send + Sync + 'static) -> Self {
        Self::failed_while("", error)
    }

    /// The same, with what was being done before its words: `growing the L-system: `.
    pub fn failed_while(doing: &'static str, error: impl Error + Send + Sync + 'static) -> Self {
        Self::Failed { doing, error: Arc::new(error) }
    }

    /// The wrapped error, where it has the type that the generator defines.
    pub fn downcast_ref<E: Error + 'static>(&self) -> Option<&E> {
        match self {
            Self::Failed { error, .. } => error.downcast_ref(),
            _ => None,
        }
    }
}
