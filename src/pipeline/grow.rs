//! Recipe → skeleton: the one way through all generators.

use std::sync::Arc;

use linden_base::input::Geometry;
use linden_base::memory::OverMemory;
use linden_base::monitor::Holding;
use linden_base::monitor::{Cancelled, Monitor};
use linden_plant::Body;
use linden_plant::foliage::{self, FoliageError, Organs};
use linden_skeleton::edit::{AxisPath, AxisPaths, Edit, EditError, Edited, Operation, Origins, Remark, edit};
use linden_skeleton::generator::{Branched, GeneratorError};
use linden_skeleton::refine::{RefineError, Room, refine};
use linden_skeleton::{
    AxisRule, BREAST_HEIGHT_M, Girth, NO_PARENT, RadiusFit, RadiusSource, Skeleton, SkeletonError, Wood,
};

use crate::preset::{Form, Preset};
use crate::provenance::TreeHash;
use crate::recipe::{InputsError, Recipe};
use crate::report::breast_fit;

pub use linden_skeleton::generator::{Colonized, Fit, Gaps, Obstruction, Obstructs, Scanned, Spread};

/// A grown tree, and how it came about.
#[derive(Clone, Debug)]
pub struct Grown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// The tree before its wood was edited and before it was made younger.
    pub as_grown: AsGrown,
    /// Where nodes and axes of `skeleton` are from; `None`: it is the tree as grown.
    pub origins: Option<Arc<Origins>>,
    /// What is to be known of edits of the wood that were not made, or not as they say; among the notes, too.
    pub remarks: Vec<Remark>,
    /// The settings that its radii were made by, with the rule settled: for [`Skeleton::until`].
    pub wood: Wood,
    /// Leaves and other organs on it.
    pub organs: Arc<Organs>,
    /// The organs that its generator placed: without the leaves of the preset.
    pub given: Arc<Organs>,
    /// Length of the derived string; `None` for what is no L-system.
    pub symbols: Option<u64>,
    /// The attraction points, and how many were reached; `None` for L-systems.
    pub colonized: Option<Colonized>,
    /// The place of its foot in the file that it was grown from, points or cylinders, in the file's axes and units; `None` of what
    /// has no place in a file.
    pub foot: Option<glam::DVec3>,
    /// Messages for the user: limits that were hit, meshes that are open.
    pub notes: Vec<String>,
}

/// A tree as it grew: edits of the wood name its axes.
#[derive(Clone, Debug)]
pub struct AsGrown {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// The organs that its generator placed.
    pub given: Arc<Organs>,
    /// The share of its births that is to be shown; `None`: all.
    pub age: Option<f64>,
    /// The most nodes that it may have.
    pub most_nodes: u64,
}

/// Bytes that a tree takes as it grew, where it is another one now, and what is known of where that is from.
fn bytes_beside(
    as_grown: &AsGrown,
    skeleton: &Arc<Skeleton>,
    given: &Arc<Organs>,
    origins: Option<&Origins>,
) -> u64 {
    let wood = if Arc::ptr_eq(&as_grown.skeleton, skeleton) { 0 } else { as_grown.skeleton.bytes() };
    let organs = if Arc::ptr_eq(&as_grown.given, given) { 0 } else { as_grown.given.bytes() };
    wood + organs + origins.map_or(0, Origins::bytes)
}

impl Grown {
    /// A tree that is nothing but its wood and what grows on it.
    pub fn of(skeleton: Arc<Skeleton>, wood: Wood, organs: Arc<Organs>, given: Arc<Organs>) -> Self {
        let most_nodes = skeleton.positions.len() as u64;
        let (as_skeleton, as_given) = (Arc::clone(&skeleton), Arc::clone(&given));
        let as_grown = AsGrown { skeleton: as_skeleton, given: as_given, age: None, most_nodes };
        let (origins, symbols, colonized, foot) = (None, None, None, None);
        let (remarks, notes) = (Vec::new(), Vec::new());
        Self { skeleton, as_grown, origins, remarks, wood, organs, given, symbols, colonized, foot, notes }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.body().bytes()
            + bytes_beside(&self.as_grown, &self.skeleton, &self.given, self.origins.as_deref())
            + self.colonized.as_ref().map_or(0, Colonized::bytes)
    }

    /// The paths of all axes of the tree as grown: what [`Grown::axis_path`] goes by.
    pub fn axis_paths(&self) -> AxisPaths {
        AxisPaths::new(&self.as_grown.skeleton)
    }

    /// The path by which edits name an axis of the skeleton (with `paths` those of [`Grown::axis_paths`]); `None` where
    /// there is no such axis.
    ///
    /// ```
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
    /// let mut fir = builtin("fir")?.load()?;
    /// fir.edit("remove stem/1")?;
    /// let grown = grow(&Recipe::new(fir), &Quiet)?;
    /// let paths = grown.axis_paths();
    /// let of = |axis| grown.axis_path(axis, &paths).map(|path| path.to_string());
    /// assert_eq!(of(0).as_deref(), Some("stem"));
    /// assert!((0..grown.skeleton.axes.len() as u32).all(|axis| of(axis).as_deref() != Some("stem/1")));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn axis_path(&self, axis: u32, paths: &AxisPaths) -> Option<AxisPath> {
        match &self.origins {
            Some(origins) => origins.path(axis, paths),
            None => paths.path(axis),
        }
    }

    /// An edit of an axis of the skeleton, which finds it again when other knobs change the tree a little; `None` where
    /// there is no such axis.
    pub fn edit_of(&self, axis: u32, operation: Operation, paths: &AxisPaths) -> Option<Edit> {
        let path = self.axis_path(axis, paths)?;
        Some(Edit::new(path, operation).witnessed(&self.as_grown.skeleton, paths))
    }

    /// The tree at a step of its growth, edited as it is: [`Skeleton::until`].
    pub fn until(&self, step: u32, key: linden_base::random::Key) -> Skeleton {
        match self.origins.as_ref().filter(|_| !self.skeleton.marks.is_empty()) {
            Some(origins) => {
                origins.until((&self.skeleton, &self.as_grown.skeleton), step, &self.wood, key).0
            }
            None => self.skeleton.until(step, &self.wood, key),
        }
    }

    /// Asks for the memory that [`Grown::until`] takes, the skeleton included.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn admit_until(&self, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        admit_until((&self.skeleton, &self.as_grown.skeleton), &self.wood, monitor)
    }

    /// The fingerprints of the tree.
    ///
    /// ```
    /// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
    /// let fir = Recipe::new(builtin("fir")?.load()?);
    /// assert_eq!(grow(&fir, &Quiet)?.hash(), grow(&fir, &Quiet)?.hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hash(&self) -> TreeHash {
        TreeHash { skeleton: self.skeleton.hash(), organs: self.organs.hash() }
    }

    /// The tree as it is dressed.
    pub fn body(&self) -> Body<'_> {
        let Self { skeleton, organs, given, foot, .. } = self;
        Body { skeleton, organs, given, foot_in_file: *foot }
    }
}

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

/// Grows the tree of a recipe.
///
/// ```
/// use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
/// let grown = grow(&Recipe::new(builtin("abop-a")?.load()?), &Quiet)?;
/// assert_eq!(grown.skeleton.segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GrowError`]: limits, contradictions, nothing in reach, cancelled.
pub fn grow(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    let girth = || whole_girth(recipe, monitor);
    grow_as(recipe, &girth, monitor)
}

/// What the thickness of a recipe's whole tree goes by, where the recipe is of a younger one whose thickness follows from
/// that: the whole one is grown to find it out.
///
/// # Errors
/// As [`grow`].
pub fn whole_girth(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Option<Girth>, GrowError> {
    let Preset { generator, wood, .. } = &recipe.preset;
    let Some(whole) = generator.whole().filter(|_| wood.base_radius_m.is_some()) else { return Ok(None) };
    let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
    Ok(Some(Girth::of(&whole.grow(&recipe.task(), monitor)?.branching)))
}

/// The same as [`grow`] for who knows [`whole_girth`] already, of this recipe or of the same tree at another age.
///
/// # Errors
/// As [`grow`], and those of `girth`.
pub fn grow_as(
    recipe: &Recipe,
    girth: &dyn Fn() -> Result<Option<Girth>, GrowError>,
    monitor: &dyn Monitor,
) -> Result<Grown, GrowError> {
    recipe.check_inputs()?;
    let Preset { generator, wood, .. } = &recipe.preset;
    if let (Some(base_m), Some(tip_m)) = (wood.base_radius_m, wood.tip_radius_m)
        && base_m < tip_m
    {
        return Err(GrowError::Radii { base_m, tip_m });
    }
    let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
    let whole = if generator.whole().is_some() { girth()? } else { None };
    let mut branched = generator.grow(&recipe.task(), monitor)?;
    let wood = whole.map_or(*wood, |whole| wood.when_young(&whole, &Girth::of(&branched.branching)));
    let colonized = branched.colonized.take();
    let is_canopy = colonized.as_ref().is_some_and(|colonized| colonized.is_canopy);
    let measured = branched.measured.as_ref().map_or(0, |measured| measured.bytes());
    let held = branched.organs.bytes() + measured + colonized.as_ref().map_or(0, Colonized::bytes);
    let monitor: &dyn Monitor = &Holding::new(monitor, held);
    if let Some(measured) = &branched.measured {
        measured.admit(&branched.branching, monitor)?;
    }
    let Built { mut skeleton, wood, organs, measured_nodes } =
        build(&mut branched, &recipe.preset, &wood, is_canopy, monitor)?;
    let mut scan = None;
    if let Some(measured) = branched.measured.take()
        && let Some(Gaps { fit, of_points_m, of_nodes_m }) = measured.gaps(&skeleton, monitor)?
    {
        for (fit, gap_m) in Arc::make_mut(&mut skeleton).fits.iter_mut().zip(of_nodes_m) {
            fit.gap_m = gap_m;
        }
        let leaf_points = measured.leaf_points();
        let (points, gaps_m) = (Arc::new(measured.into_points()), Arc::new(of_points_m));
        scan = Some(Scanned { points, gaps_m, leaf_points, measured_nodes, fit });
    }
    branched.notes.extend(scan.as_ref().and_then(|scan| far_note(&skeleton, &scan.fit)));
    branched.notes.extend(stout_note(&skeleton).filter(|_| scan.is_some()));
    let as_grown =
        AsGrown { skeleton, given: Arc::new(organs), age: branched.age, most_nodes: branched.most_nodes };
    let Shaped { skeleton, given, origins, remarks } = shape(&as_grown, &wood, &recipe.preset, monitor)?;
    let beside = bytes_beside(&as_grown, &skeleton, &given, origins.as_deref());
    let monitor = Holding::new(monitor, skeleton.bytes() + beside);
    let mut notes = branched.notes;
    notes.extend(remarks.iter().map(ToString::to_string));
    notes.extend(mesh_notes(recipe));
    notes.extend(unregistered_note(&recipe.preset));
    Ok(Grown {
        organs: sprout(recipe, &skeleton, &given, &monitor)?,
        given,
        skeleton,
        as_grown,
        origins,
        remarks,
        wood,
        symbols: branched.symbols,
        colonized: colonized.map(|colonized| Colonized { scan, ..colonized }),
        foot: branched.foot,
        notes,
    })
}

/// The tree of a recipe that differs in its edits and in what covers the wood alone from the one that `grown` grew
/// from: the same as of [`grow`], without growing it again.
///
/// ```
/// use linden_pipeline::{Quiet, grow::{grow, reedit}, preset::builtin, recipe::Recipe};
/// let mut fir = builtin("fir")?.load()?;
/// let grown = grow(&Recipe::new(fir.clone()), &Quiet)?;
/// fir.edit("cut stem 0.5")?;
/// let recipe = Recipe::new(fir);
/// assert_eq!(reedit(&grown, &recipe, &Quiet)?.hash(), grow(&recipe, &Quiet)?.hash());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`grow`], as far as it has to do with edits and leaves.
pub fn reedit(grown: &Grown, recipe: &Recipe, monitor: &dyn Monitor) -> Result<Grown, GrowError> {
    recipe.check_inputs()?;
    let as_grown = grown.as_grown.clone();
    let held = recipe.inputs.bytes() + grown.bytes();
    let monitor = Holding::new(monitor, held);
    let Shaped { skeleton, given, origins, remarks } =
        shape(&as_grown, &grown.wood, &recipe.preset, &monitor)?;
    let before: Vec<String> = grown.remarks.iter().map(ToString::to_string).collect();
    let of_growth = grown.notes.iter().filter(|note| !before.contains(note) && !note.starts_with(MESH_NOTE));
    let notes = of_growth.cloned().chain(remarks.iter().map(ToString::to_string)).chain(mesh_notes(recipe));
    let notes = notes.collect();
    let monitor = Holding::new(&monitor, skeleton.bytes());
    Ok(Grown {
        organs: sprout(recipe, &skeleton, &given, &monitor)?,
        given,
        skeleton,
        as_grown,
        origins,
        remarks,
        wood: grown.wood,
        symbols: grown.symbols,
        colonized: grown.colonized.clone(),
        foot: grown.foot,
        notes,
    })
}

/// What becomes of a tree as it grew.
struct Shaped {
    skeleton: Arc<Skeleton>,
    given: Arc<Organs>,
    origins: Option<Arc<Origins>>,
    remarks: Vec<Remark>,
}

/// Edits the wood, and then makes the tree as young as it is to be shown.
fn shape(
    as_grown: &AsGrown,
    wood: &Wood,
    preset: &Preset,
    monitor: &dyn Monitor,
) -> Result<Shaped, GrowError> {
    let AsGrown { skeleton: grown, given, age, most_nodes } = as_grown;
    let mut shaped =
        Shaped { skeleton: Arc::clone(grown), given: Arc::clone(given), origins: None, remarks: Vec::new() };
    if !preset.edits.is_empty() {
        let Edited { skeleton, organs, origins, remarks } =
            edit(grown, given, &preset.edits, *most_nodes, monitor)?;
        shaped.remarks = remarks;
        shaped.skeleton = Arc::new(skeleton);
        shaped.given = Arc::new(organs);
        shaped.origins = Some(Arc::new(origins));
    }
    let Some(age) = *age else { return Ok(shaped) };
    let held = shaped.origins.as_ref().map_or(0, |origins| origins.bytes());
    admit_until((&shaped.skeleton, grown), wood, &Holding::new(monitor, held))?;
    let (step, key) = (step_of(grown, age), preset.wood_key());
    let (young, origins) = match &shaped.origins {
        Some(origins) => origins.until((&shaped.skeleton, grown), step, wood, key),
        None => {
            let young = grown.until(step, wood, key);
            let origins = Origins::of_young(grown, &young, step);
            (young, origins)
        }
    };
    shaped.skeleton = Arc::new(young);
    shaped.origins = Some(Arc::new(origins));
    Ok(shaped)
}

/// Asks for the memory of a tree that was edited and as it grew, and of a younger one.
fn admit_until(
    (skeleton, grown): (&Skeleton, &Skeleton),
    wood: &Wood,
    monitor: &dyn Monitor,
) -> Result<(), OverMemory> {
    if skeleton.marks.is_empty() {
        return skeleton.admit_until(wood, monitor);
    }
    // Both trees young, and where their nodes are from.
    grown.admit_until(wood, &Holding::new(monitor, 3 * skeleton.bytes()))
}

/// Everything that grows on a skeleton: what its generator placed, and the leaves of the recipe.
///
/// # Errors
/// [`FoliageError`]: files that are missing, too many leaves, too little memory, or cancelled.
pub fn sprout(
    recipe: &Recipe,
    skeleton: &Skeleton,
    given: &Arc<Organs>,
    monitor: &dyn Monitor,
) -> Result<Arc<Organs>, FoliageError> {
    recipe.with_specimen(|specimen| foliage::sprout(specimen, skeleton, given, monitor))
}

/// What is to be known of a generator that the registry does not have: its table means nothing in a document.
fn unregistered_note(preset: &Preset) -> Option<String> {
    let id = preset.grows_by().id();
    crate::generators::find(id).is_none().then(|| {
        format!(
            "the generator '{id}' is not registered: recipes and files of this tree cannot be read again; call \
             generators::register before anything else"
        )
    })
}

/// How the notes of [`mesh_notes`] begin.
const MESH_NOTE: &str = "leaf_mesh: ";

/// What is to be known of the users' meshes of leaves.
fn mesh_notes(recipe: &Recipe) -> Vec<String> {
    let kinds = recipe.preset.dressing.foliage.kinds().filter(|kind| kind.form == Form::Mesh);
    let note = |file: &String| match recipe.inputs.get(file).map(|input| &input.geometry) {
        Some(Geometry::Mesh(mesh)) => foliage::mesh_note(file, mesh),
        _ => None,
    };
    kinds.filter_map(|kind| kind.mesh.as_ref()).filter_map(note).collect()
}

/// Polylines that draw what a recipe's tree grows in, metres, where the tree of [`grow`] stands: its crown,
/// obstacles, and, dashed, what is subtracted or shaded. None for what grows in nothing.
///
/// ```
/// use linden_pipeline::{Quiet, grow::outline, preset::builtin, recipe::Recipe};
/// assert!(!outline(&Recipe::new(builtin("cypress")?.load()?), &Quiet)?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of growing that have to do with the crown: its dimensions, its mesh; cancelled.
pub fn outline(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Vec<glam::Vec3>>, GrowError> {
    Ok(recipe.preset.generator.outline(&recipe.task(), monitor)?)
}

/// What stands in the way of a recipe's tree and what takes light from it, where the tree of [`grow`] stands. None
/// for what grows by itself.
///
/// ```
/// use linden_pipeline::{Quiet, grow::{Obstructs, obstructions}, preset::builtin};
/// let stone = &obstructions(&builtin("around-the-stone")?.recipe(&Quiet)?, &Quiet)?[0];
/// assert!(stone.effect == Obstructs::Branches && !stone.triangles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`outline`].
pub fn obstructions(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Obstruction>, GrowError> {
    Ok(recipe.preset.generator.obstructions(&recipe.task(), monitor)?)
}

/// The step after a share of a tree's births, at which it has its first segment at least.
fn step_of(skeleton: &Skeleton, age: f64) -> u32 {
    let last = skeleton.births.iter().copied().max().unwrap_or(0);
    let on_foot = |&node: &usize| {
        let parent = skeleton.parents[node];
        parent != NO_PARENT && skeleton.parents[parent as usize] == NO_PARENT
    };
    let first = (0..skeleton.parents.len()).filter(on_foot).map(|node| skeleton.births[node]).min();
    (libm::ceil(age * f64::from(last)) as u32).max(first.unwrap_or(0))
}

/// What becomes of what a generator leaves behind.
struct Built {
    skeleton: Arc<Skeleton>,
    /// With its rule settled.
    wood: Wood,
    /// What the generator placed, where refinement took it.
    organs: Organs,
    /// Nodes whose radius was measured.
    measured_nodes: usize,
}

/// What is said of a scan whose trunk shows no circle at breast height.
fn trunk_note(skeleton: &Skeleton) -> Option<String> {
    let axes = skeleton.trunk();
    let nodes: Vec<u32> =
        axes.iter().flat_map(|&axis| skeleton.nodes_of(&skeleton.axes[axis as usize])).copied().collect();
    let source = |node: &u32| skeleton.fits.get(*node as usize).map(|fit| fit.source);
    if skeleton.fits.is_empty() {
        return None;
    }
    if !nodes.iter().any(|node| source(node) == Some(RadiusSource::Measured)) {
        return Some(
            "no circle was believed on the trunk: its diameter is a guess by the wood that it bears; give base_radius \
             if you know it"
                .to_owned(),
        );
    }
    let at_breast = breast_fit(skeleton, &nodes).filter(|_| is_higher_than_breast(skeleton, &nodes))?;
    let how = match at_breast.source {
        RadiusSource::Measured => return None,
        RadiusSource::Carried => "carried on from circles above and below",
        RadiusSource::Guessed => "a guess by circles elsewhere and the wood that it bears",
    };
    Some(format!("no circle was believed at breast height: the diameter there is {how}"))
}

/// Points are farther from the tree on average than this part of its height: in scans from four sides they are nearer than 0.01, also
/// where volumes are off by a third.
const FAR_PER_HEIGHT: f64 = 0.012;

/// What is said of a tree whose points lie far from it.
fn far_note(skeleton: &Skeleton, fit: &Fit) -> Option<String> {
    let Spread { mean_m, p95_m } = fit.points_to_surface;
    let height_m = height_m(skeleton);
    (mean_m > FAR_PER_HEIGHT * height_m).then(|| {
        format!(
            "the points lie {mean_m:.2} m from the tree's surface on average (95 % within {p95_m:.2} m), far for a tree of {height_m:.1} m: \
             its volume and lengths are a guess; a denser scan from more sides comes nearer, leaf_points=paths for a tree in leaf"
        )
    })
}

/// No stem is thicker at breast height than this part of its tree's height.
const STOUTEST_PER_HEIGHT: f64 = 0.2;

/// What is said of a scan that is too stout for a tree.
fn stout_note(skeleton: &Skeleton) -> Option<String> {
    let measures = skeleton.measures();
    let (dbh_m, height_m) = (measures.trunk_diameter_m, measures.height_m);
    let is_at_breast = measures.trunk_diameter_at_m == BREAST_HEIGHT_M;
    (is_at_breast && dbh_m > STOUTEST_PER_HEIGHT * height_m).then(|| {
        format!(
            "{dbh_m:.2} m at breast height are too thick for a tree of {height_m:.1} m: is it one tree, whole, and in the unit that scale= \
             says?"
        )
    })
}

fn height_m(skeleton: &Skeleton) -> f64 {
    let heights = || skeleton.positions.iter().map(|at| f64::from(at.y));
    heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
}

fn is_higher_than_breast(skeleton: &Skeleton, trunk: &[u32]) -> bool {
    skeleton.climbed_m(trunk).last().is_some_and(|&climbed_m| climbed_m >= BREAST_HEIGHT_M)
}

/// What all generators' branchings go through: refinement, which takes the organs along, then axes
/// and radii.
fn build(
    branched: &mut Branched,
    preset: &Preset,
    wood: &Wood,
    is_canopy: bool,
    monitor: &dyn Monitor,
) -> Result<Built, GrowError> {
    let mut branching = std::mem::take(&mut branched.branching);
    let mut organs = std::mem::take(&mut branched.organs);
    if preset.wood.axes == AxisRule::Thickest {
        branching.edges = None;
    }
    if !preset.refinement.is_idle() {
        let is_barred = |p: glam::Vec3| branched.barred.as_ref().is_some_and(|barred| barred(p));
        let room = Room {
            most_nodes: branched.most_nodes,
            is_barred: &is_barred,
            key: preset.wood_key(),
            wood: *wood,
        };
        branching.validate()?;
        let used = branched.used.take();
        let mut riders = organs.riders();
        branching = refine(branching, used, &mut riders, &preset.refinement, room, monitor)?;
        organs.follow(&riders);
    }
    let found = match &branched.measured {
        Some(measured) => measured.measure(&mut branching, wood, monitor)?,
        None => None,
    };
    let is_measured = found.is_some();
    // A scan says of each radius where it is from, also where nobody measures it.
    let is_scan = branched.measured.is_some() || is_canopy;
    let guessed = || vec![RadiusFit::GUESSED; if is_scan { branching.positions.len() } else { 0 }];
    let fits = found.unwrap_or_else(guessed);
    branching.admit_build(wood, monitor)?;
    let wood = wood.settled(branching.radii.is_some(), branching.edges.is_some());
    let mut skeleton = Skeleton::build_keyed(branching, &wood, preset.wood_key())?;
    let measured_nodes = fits.iter().filter(|fit| fit.source == RadiusSource::Measured).count();
    skeleton.fits = fits;
    // No step of refinement takes a foot away, or puts it before another.
    skeleton.trees = std::mem::take(&mut branched.trees);
    branched.notes.extend(trunk_note(&skeleton).filter(|_| is_measured));
    let side = &preset.refinement.side;
    if !side.add_to(&mut skeleton, preset.wood_key().named("side"), branched.most_nodes, monitor)? {
        branched.notes.push(
            "epicormic, dead_twigs: some are left out, for the tree has as many nodes as it may; raise max_nodes or \
             symbol_limit"
                .to_owned(),
        );
    }
    Ok(Built { skeleton: Arc::new(skeleton), wood, organs, measured_nodes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::builtin;
    use glam::Vec3;
    use linden_base::mesh::Bounds;
    use linden_base::monitor::Quiet;
    use linden_colonization::ColonizationError;

    fn recipe(id: &str, settings: &[(&str, &str)]) -> Recipe {
        let row = builtin(id).unwrap();
        let mut preset = row.load().unwrap_or_else(|fault| panic!("{id}: {fault}"));
        for (knob, value) in settings {
            preset.set(knob, value).unwrap();
        }
        Recipe::with_files(preset, row.recipe(&Quiet).unwrap().inputs)
    }

    #[test]
    fn the_outline_stands_where_the_points_are() {
        let cases: [(&str, &[(&str, &str)]); 7] = [
            ("fir", &[]),
            ("cypress", &[("crown_base", "3")]),
            ("sphere", &[("root", "5,2,-3")]),
            ("sphere", &[("root", "5,2,-3"), ("origin", "root")]),
            ("heart", &[]),
            ("heart", &[("origin", "root")]),
            ("simple", &[("origin", "keep")]),
        ];
        for (id, settings) in cases {
            let recipe = recipe(id, settings);
            let points = grow(&recipe, &Quiet).unwrap().colonized.unwrap().points;
            let lines = outline(&recipe, &Quiet).unwrap();
            let bounds = |places: &mut dyn Iterator<Item = Vec3>| Bounds::of(places).unwrap();
            let (inner, outer) = (bounds(&mut points.into_iter()), bounds(&mut lines.into_iter().flatten()));
            // Many points in a solid come near its box on all sides; cuts through a mesh miss its ends
            // by at most an eighth.
            let slack = outer.size().max_element() * 0.15;
            for (a, b) in [(inner.min, outer.min), (inner.max, outer.max)] {
                assert!((a - b).abs().max_element() < slack, "{id} {settings:?}: {a} {b}");
            }
        }
    }

    /// Whether a place is inside of triangles: a ray crosses them an odd number of times.
    fn is_inside(solid: &Obstruction, place: Vec3) -> bool {
        let way = Vec3::new(0.83, 0.41, 0.377);
        let crosses = |triangle: &u32| {
            let [a, b, c] = solid.corners(*triangle);
            let (ab, ac) = (b - a, c - a);
            let across = way.cross(ac);
            let (det, from) = (ab.dot(across), place - a);
            let u = from.dot(across) / det;
            let v = way.dot(from.cross(ab)) / det;
            let t = ac.dot(from.cross(ab)) / det;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
        };
        (0..solid.triangles.len() as u32).filter(crosses).count() % 2 == 1
    }

    #[test]
    fn obstructions_stand_where_growth_meets_them() {
        let cases: [(&str, &[(&str, &str)]); 4] = [
            ("around-the-stone", &[("points", "1500")]),
            ("around-the-stone", &[("points", "1500"), ("root", "5,2,-3")]),
            ("street-lamp", &[("points", "1500")]),
            ("street-lamp", &[("points", "1500"), ("root", "5,2,-3"), ("origin", "root")]),
        ];
        for (id, settings) in cases {
            let recipe = recipe(id, settings);
            let grown = grow(&recipe, &Quiet).unwrap();
            let all = obstructions(&recipe, &Quiet).unwrap();
            assert_eq!(all.len(), 1, "{id}");
            let solid = &all[0];
            let wanted = if id == "street-lamp" { Obstructs::Light } else { Obstructs::Branches };
            assert_eq!(solid.effect, wanted);
            // No point is in either; nor is wood in the stone, which it comes near.
            let points = grown.colonized.unwrap().points;
            let wood = if wanted == Obstructs::Branches { &grown.skeleton.positions[..] } else { &[] };
            let entered = points.iter().chain(wood).filter(|place| is_inside(solid, **place)).count();
            assert!(entered <= points.len() / 500, "{id} {settings:?}: {entered} places are inside");
            let bounds = Bounds::of(solid.positions.iter().copied()).unwrap();
            let near =
                points.iter().filter(|p| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()).count();
            assert!(near > 10, "{id} {settings:?}: {near} points are around it");
        }
        assert_eq!(obstructions(&recipe("fir", &[]), &Quiet).unwrap(), []);
    }

    #[test]
    fn a_wall_is_shown_where_a_tree_that_grows_by_light_keeps_out_of_it() {
        let text = "id = \"walled\"\n[self-organizing]\nyears = 24\nsag = 0.4\nlight = \"sky\"\nshade = 0.3\n\
                    [[self-organizing.obstacle]]\nbox = [0.3, 6, 9]\nat = [0.9, 0, 0]\nturn = 20\n";
        for refine in ["refine = []", "refine = [\"relocate\", \"smooth\", \"subdivide\"]\ngnarl = 1"] {
            let preset = Preset::from_toml(&format!("{text}[wood]\n{refine}\n")).unwrap();
            let recipe = Recipe::new(preset);
            let grown = grow(&recipe, &Quiet).unwrap();
            let all = obstructions(&recipe, &Quiet).unwrap();
            let [wall] = all.as_slice() else { panic!("{} obstructions", all.len()) };
            assert_eq!(wall.effect, Obstructs::Branches);
            let entered = grown.skeleton.positions.iter().filter(|place| is_inside(wall, **place)).count();
            assert_eq!(entered, 0, "{refine}: of {} nodes", grown.skeleton.positions.len());
            let bounds = Bounds::of(wall.positions.iter().copied()).unwrap();
            let lines = Bounds::of(outline(&recipe, &Quiet).unwrap().into_iter().flatten()).unwrap();
            assert!((lines.min - bounds.min).length() < 1e-4 && (lines.max - bounds.max).length() < 1e-4);
            assert!(grown.skeleton.positions.len() > 1000);
        }
    }

    /// A wire of 3 m with a fork: far thinner than its points are exact.
    #[test]
    fn a_scan_without_a_circle_says_that_all_is_guessed() {
        let key = linden_base::random::Key::new(4);
        let mut rows = String::new();
        for i in 0..3000_u64 {
            let along = i as f64 * 1e-3;
            let out = (along - 2.0).max(0.0) * if i % 2 == 0 { 0.5 } else { -0.5 };
            let [x, y] = ["x", "y"].map(|name| 2e-3 * key.named(name).child(i).normal());
            rows.push_str(&format!("{} {y} {along}\n", x + out));
        }
        let grown = |radius: &str| {
            let mut preset = Preset::of_points("wire", "wire.xyz");
            preset.set("scan_radius", radius).unwrap();
            let mut recipe = Recipe::new(preset);
            let input = crate::recipe::Input::read("wire.xyz", rows.as_bytes(), &Quiet).unwrap();
            recipe.inputs.insert("wire.xyz", input);
            let grown = grow(&recipe, &Quiet).unwrap();
            let report = crate::report::Report::of(&recipe, &grown, &Quiet).unwrap();
            let is_noted =
                grown.notes.iter().any(|note| note.contains("no circle was believed on the trunk"));
            (report.dbh_m.is_some(), report.dbh_source, report.measured_volume_share, is_noted)
        };
        let guessed = |is_noted| (true, Some("guessed".to_owned()), Some(0.0), is_noted);
        assert_eq!(grown("points"), guessed(true));
        // None was looked for.
        assert_eq!(grown("pipe"), guessed(false));
    }

    #[test]
    fn points_far_from_the_tree_and_stout_poles_are_noted() {
        let tree = |radius_m: f32| {
            let branching = linden_skeleton::Branching {
                positions: vec![Vec3::ZERO, 2.0 * Vec3::Y, 10.0 * Vec3::Y],
                parents: vec![NO_PARENT, 0, 1],
                births: vec![0; 3],
                radii: Some(vec![radius_m; 3]),
                edges: None,
            };
            Skeleton::build(branching, &Wood::default()).unwrap()
        };
        let fit = |mean_m: f64| {
            let spread = Spread { mean_m, p95_m: 2.0 * mean_m };
            Fit {
                points_to_surface: spread,
                points_to_axis: spread,
                axis_to_points: spread,
                surface_to_points: spread,
            }
        };
        assert_eq!(far_note(&tree(0.2), &fit(0.08)), None);
        assert!(far_note(&tree(0.2), &fit(0.14)).unwrap().contains("0.14 m from the tree's surface"));
        assert_eq!(stout_note(&tree(0.9)), None);
        assert!(stout_note(&tree(1.1)).unwrap().contains("2.20 m at breast height"));
    }

    #[test]
    fn what_has_no_crown_has_no_outline() {
        assert_eq!(outline(&recipe("abop-c", &[]), &Quiet).unwrap(), Vec::<Vec<Vec3>>::new());
        let missing = Recipe::new(recipe("heart", &[]).preset);
        let error = outline(&missing, &Quiet).unwrap_err();
        assert!(matches!(error.generator(), Some(ColonizationError::WrongInput { .. })));
    }
}
