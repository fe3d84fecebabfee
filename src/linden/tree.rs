//! A tree to be grown, and a grown one.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use linden_exporters::{
    Batch, Bundle, ExportError, Exporter, MemoryFile, Options, Output, Written, for_path,
};
use linden_pipeline::dress::{Levels, levels};
use linden_pipeline::grow::{Grown, grow};
use linden_pipeline::monitor::{Monitor, Quiet};
use linden_pipeline::picture::Picture;
use linden_pipeline::provenance::Provenance;
use linden_pipeline::recipe::Recipe;
use linden_pipeline::report::Report;
use linden_pipeline::skeleton::{Measures, Skeleton};
use linden_raster::{Camera, Size, Style, Surface, draw_surface};

use crate::Error;

/// Who watches work: reports progress, cancels, limits memory.
pub(crate) type Watcher = Arc<dyn Monitor + Send + Sync>;

/// A tree to be grown: a recipe, and who watches.
#[derive(Clone)]
pub struct Tree {
    recipe: Recipe,
    watcher: Watcher,
    /// The knobs that were turned.
    turned: Vec<&'static str>,
    /// Files that it was read from, which no export replaces.
    sources: Vec<PathBuf>,
    /// What the recipe's document says of the tree that it is from.
    provenance: Option<Provenance>,
    /// What is to be known of how it was read.
    read_notes: Vec<String>,
}

impl fmt::Debug for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { recipe, watcher: _, turned, sources, provenance: _, read_notes: _ } = self;
        let mut shown = f.debug_struct("Tree");
        shown
            .field("recipe", recipe)
            .field("turned", turned)
            .field("sources", sources)
            .finish_non_exhaustive()
    }
}

impl Tree {
    /// The tree of a recipe.
    pub fn of(recipe: Recipe) -> Self {
        let (turned, sources, read_notes) = (Vec::new(), Vec::new(), Vec::new());
        Self { recipe, watcher: Arc::new(Quiet), turned, sources, provenance: None, read_notes }
    }

    /// Read from files, which no export is to replace.
    pub(crate) fn sparing(self, sources: Vec<PathBuf>) -> Self {
        Self { sources, ..self }
    }

    /// With what is to be known of how it was read: what of a file was left out.
    pub(crate) fn noting(self, read_notes: Vec<String>) -> Self {
        Self { read_notes, ..self }
    }

    /// As its document, a recipe, says of itself.
    pub(crate) fn with_provenance(self, json: &str) -> Self {
        Self { provenance: Some(Provenance::of(json, &self.recipe)), ..self }
    }

    /// With another seed: another tree of the same kind.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.recipe.preset.set_seed(seed);
        self
    }

    /// With a knob turned, as `--set knob=value` does. A knob that changes nothing as the others stand is said
    /// among [`GrownTree::notes`], one that a format cannot hold among [`Exported::notes`].
    ///
    /// ```
    /// let fir = linden::tree("fir")?.set("points", "50")?.set("junction_detail", "64")?.grow()?;
    /// assert_eq!(fir.notes(), ["junction_detail changes nothing: it is for junction=watertight"]);
    ///
    /// let error = linden::tree("fir")?.set("pionts", "500").err().unwrap();
    /// assert!(error.to_string().contains("did you mean 'points'"));
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Knob`]: an unknown name, or a value that the knob does not take.
    pub fn set(mut self, knob: &str, value: &str) -> Result<Self, Error> {
        self.recipe.preset.set(knob, value)?;
        self.turned.extend(self.recipe.preset.find_knob(knob).map(|row| row.knob.name));
        Ok(self)
    }

    /// With another value of a constant of its grammar (`#define`), as `--define name=value` does.
    ///
    /// ```
    /// let honda = linden::tree("abop-honda-a")?.define("r1", "0.8")?.grow()?;
    /// assert!(honda.measures().height_m < linden::tree("abop-honda-a")?.grow()?.measures().height_m);
    /// assert!(linden::tree("fir")?.define("r1", "0.8").is_err());
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Define`]: no grammar, an unknown name, or a value that it does not take.
    pub fn define(mut self, name: &str, value: &str) -> Result<Self, Error> {
        self.recipe.preset.define(name, value)?;
        Ok(self)
    }

    /// With an edit of its wood, as `--edit text` does: of one axis, named by its path in the tree as it grows. What is
    /// edited is found by the path alone; an axis that is not there is said among [`GrownTree::notes`].
    ///
    /// ```
    /// let whole = linden::tree("fir")?.set("points", "300")?;
    /// let cut = whole.clone().edit("cut stem 0.5")?.grow()?;
    /// assert!(cut.measures().height_m < whole.clone().grow()?.measures().height_m);
    /// let notes = whole.edit("remove stem2")?.grow()?.notes().join("");
    /// assert!(notes.starts_with("edit 1 (remove stem2) was left out: the tree has no stem2: it has 1 stem"));
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Edit`]: no operation or axis, or a value that the operation does not take.
    pub fn edit(mut self, text: &str) -> Result<Self, Error> {
        self.recipe.preset.edit(text)?;
        Ok(self)
    }

    /// With a monitor, which hears of progress, can cancel, and limits memory. Without one there is no progress
    /// and no limit. An [`Arc`] of one is a monitor too, of which a button or another thread keeps a copy.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    /// use linden::{Monitor, monitor::Phase};
    ///
    /// /// Ends work when the button is pressed.
    /// #[derive(Default)]
    /// struct Button(AtomicBool);
    ///
    /// impl Monitor for Button {
    ///     fn is_cancelled(&self) -> bool {
    ///         self.0.load(Ordering::Relaxed)
    ///     }
    ///
    ///     fn advance(&self, _phase: Phase, _done: u64, _total: Option<u64>) {}
    /// }
    ///
    /// let button = Arc::new(Button::default());
    /// let fir = linden::tree("fir")?.watched(button.clone());
    /// button.0.store(true, Ordering::Relaxed);
    /// assert!(fir.grow().err().unwrap().is_cancelled());
    /// # Ok::<(), linden::Error>(())
    /// ```
    #[must_use]
    pub fn watched(self, watcher: impl Monitor + Send + 'static) -> Self {
        Self { watcher: Arc::new(watcher), ..self }
    }

    pub(crate) fn watched_by(self, watcher: Watcher) -> Self {
        Self { watcher, ..self }
    }

    /// Everything that decides the tree.
    pub const fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The same, to be changed.
    pub const fn recipe_mut(&mut self) -> &mut Recipe {
        &mut self.recipe
    }

    /// Grows it.
    ///
    /// # Errors
    /// [`Error::Grow`]: limits, contradictions, nothing in reach, files that are missing, cancelled.
    pub fn grow(self) -> Result<GrownTree, Error> {
        let mut grown = grow(&self.recipe, &*self.watcher)?;
        grown.notes.extend(self.read_notes.iter().cloned());
        grown.notes.extend(self.recipe.preset.idle_notes(self.turned.iter().copied()));
        if let Some(provenance) = &self.provenance {
            let tree_note = provenance.tree_note(&self.recipe, &grown);
            grown.notes.extend(provenance.version_note().into_iter().chain(tree_note));
        }
        Ok(GrownTree { tree: self, grown })
    }
}

/// A grown tree: measured, drawn and written as often as you like. Clones share its wood and its leaves.
#[derive(Clone)]
pub struct GrownTree {
    tree: Tree,
    grown: Grown,
}

impl fmt::Debug for GrownTree {
    /// The recipe and how much grew: the nodes themselves would be millions of lines.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tree, grown } = self;
        let mut shown = f.debug_struct("GrownTree");
        shown.field("tree", tree).field("nodes", &grown.skeleton.positions.len());
        shown.field("organs", &grown.organs.len()).field("notes", &grown.notes).finish_non_exhaustive()
    }
}

impl GrownTree {
    /// The axial tree.
    pub fn skeleton(&self) -> &Skeleton {
        &self.grown.skeleton
    }

    /// What grew, and how it came about.
    pub const fn grown(&self) -> &Grown {
        &self.grown
    }

    /// Everything that decided the tree.
    pub const fn recipe(&self) -> &Recipe {
        &self.tree.recipe
    }

    /// Height, width, length, stem: metres.
    pub fn measures(&self) -> Measures {
        self.grown.skeleton.measures()
    }

    /// Every number of the tree, as `linden stats` says them. Where a budget of triangles is set, they are those of the
    /// finest level, which has less wood and fewer leaves: [`GrownTree::report_whole`] measures all that grew.
    ///
    /// ```
    /// let report = linden::tree("simple")?.set("points", "50")?.grow()?.report()?;
    /// assert!(report.height_m > 0.0 && report.crown_width_least_m <= report.crown_width_most_m);
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Report`].
    pub fn report(&self) -> Result<Report, Error> {
        Ok(Report::of(&self.tree.recipe, &self.grown, &*self.tree.watcher)?)
    }

    /// Every number of the whole tree as it grew, whatever budget of triangles and levels of detail its files have.
    ///
    /// ```
    /// let fir = linden::tree("dressed-simple")?.set("triangles", "3000")?.grow()?;
    /// assert!(fir.report()?.segments < fir.report_whole()?.segments);
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Report`].
    pub fn report_whole(&self) -> Result<Report, Error> {
        let mut recipe = self.tree.recipe.clone();
        recipe.preset.dressing.detail.ask_for_all();
        Ok(Report::of(&recipe, &self.grown, &*self.tree.watcher)?)
    }

    /// What the user should know: limits that were hit, meshes that are open, knobs that change nothing; of a
    /// recipe that another version made, that it is one, and whether the tree is still the same.
    pub fn notes(&self) -> &[String] {
        &self.grown.notes
    }

    /// Surface, leaves and materials, in the levels of detail and within the budgets that the knobs ask for.
    ///
    /// # Errors
    /// [`Error::Dress`].
    pub fn levels(&self) -> Result<Levels, Error> {
        Ok(levels(&self.tree.recipe, &self.grown, &*self.tree.watcher)?)
    }

    /// A picture of the finest level from its side, `width × height` pixels, in front of a plain ground.
    ///
    /// ```
    /// let picture = linden::tree("simple")?.set("points", "50")?.grow()?.draw(60, 80)?;
    /// assert_eq!((picture.width(), picture.height()), (60, 80));
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Draw`]: a size of 0 or beyond 8192; [`Error::Dress`].
    pub fn draw(&self, width: u32, height: u32) -> Result<Picture, Error> {
        let size = Size::new(width, height)?;
        let levels = self.levels()?;
        let Some(finest) = levels.levels.first() else {
            return Err(linden_raster::RasterError::Empty.into());
        };
        let scene = &finest.scene;
        let surface = Surface { parts: &scene.parts, materials: &scene.materials, skeleton: &scene.skeleton };
        Ok(draw_surface(&surface, &Camera::default(), &Style::studio(), size, &*self.tree.watcher)?)
    }

    /// Writes it in the format of the path's ending, as `linden export` does: with levels of detail, budgets and
    /// wind; a format that holds one level gets a file for each (`oak_LOD0.obj`). Files appear whole or not at
    /// all. Gives what was written, and with it what the format could not hold.
    ///
    /// # Errors
    /// [`Error::Export`]: an ending of no format, a disk that refuses, a tree too large for the format, a file that
    /// the tree was read from; [`Error::Dress`].
    pub fn export(&self, path: impl AsRef<Path>) -> Result<Exported, Error> {
        let exporter = for_path(path.as_ref())?;
        self.export_as(exporter, Options::new(exporter.format()), path)
    }

    /// The same in a format that is named, one of your own for instance, with its options.
    ///
    /// # Errors
    /// As [`GrownTree::export`].
    pub fn export_as(
        &self,
        exporter: &'static dyn Exporter,
        options: Options,
        path: impl AsRef<Path>,
    ) -> Result<Exported, Error> {
        let sources = self.tree.sources.clone();
        let create = |output: &Output| Bundle::create(&output.path);
        let (batch, notes) = self.written(exporter, options, path.as_ref(), sources, create)?;
        Ok(Exported { files: batch.commit()?, notes })
    }

    /// The files that [`export`](Self::export) would write under this name, in memory: a server or a page need no disk.
    ///
    /// ```
    /// let fir = linden::tree("fir")?.set("points", "100")?.grow()?;
    /// let obj = fir.export_to_memory("fir.obj")?;
    /// let names: Vec<&str> = obj.files.iter().map(|file| file.name.as_str()).collect();
    /// assert!(names.starts_with(&["fir.obj"]) && names.contains(&"fir.mtl"), "{names:?}");
    /// let glb = fir.export_to_memory("fir.glb")?;
    /// assert!(glb.files.len() == 1 && glb.files[0].bytes.starts_with(b"glTF"));
    /// # Ok::<(), linden::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`GrownTree::export`], but for what disks refuse.
    pub fn export_to_memory(&self, name: &str) -> Result<InMemory, Error> {
        let exporter = for_path(Path::new(name))?;
        self.export_to_memory_as(exporter, Options::new(exporter.format()), name)
    }

    /// The same in a format that is named, with its options.
    ///
    /// # Errors
    /// As [`GrownTree::export_to_memory`].
    pub fn export_to_memory_as(
        &self,
        exporter: &'static dyn Exporter,
        options: Options,
        name: &str,
    ) -> Result<InMemory, Error> {
        let keep = |output: &Output| {
            Ok(Bundle::in_memory(&output.path.file_name().unwrap_or_default().to_string_lossy()))
        };
        let (batch, notes) = self.written(exporter, options, Path::new(name), Vec::new(), keep)?;
        Ok(InMemory { files: batch.into_files(), notes })
    }

    /// Writes all levels into what `bundle` makes of each file; with what the user should know.
    fn written(
        &self,
        exporter: &'static dyn Exporter,
        options: Options,
        path: &Path,
        sources: Vec<PathBuf>,
        bundle: impl Fn(&Output) -> Result<Bundle, ExportError>,
    ) -> Result<(Batch, Vec<String>), Error> {
        let planned = self.tree.recipe.preset.dressing.detail.levels();
        let outputs = Output::new(exporter, options, path.to_owned()).in_levels(planned);
        let mut batch = Batch::open(outputs, sources, bundle)?;
        let levels = self.levels()?;
        let mut notes = levels.notes.clone();
        let stage = levels.stage().turned_by(self.tree.turned.iter().copied());
        batch.write(&stage, &*self.tree.watcher, |said| notes.extend_from_slice(said))?;
        Ok((batch, notes))
    }
}

/// Files that were written into memory.
#[derive(Clone, Debug)]
pub struct InMemory {
    /// The main one first; they refer to each other by their names.
    pub files: Vec<MemoryFile>,
    /// What the user should know: what a format could not hold, budgets that were not met.
    pub notes: Vec<String>,
}

/// What was written.
#[derive(Debug)]
pub struct Exported {
    /// The files, the main one first.
    pub files: Vec<Written>,
    /// What the user should know: what a format could not hold, budgets that were not met.
    pub notes: Vec<String>,
}
