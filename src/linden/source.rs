//! Where trees come from: built-in presets, files, grammars in code.

use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::str;
use std::sync::Arc;

use linden_pipeline::document::Fault;
use linden_pipeline::input::{Input, sniff};
use linden_pipeline::lsystem::{Grammar, text};
use linden_pipeline::monitor::{Holding, Monitor, Phase, Quiet};
use linden_pipeline::preset::{LSystem, Preset, SourceKind, builtin, builtin_file};
use linden_pipeline::recipe::Recipe;

use crate::tree::Watcher;
use crate::{Error, Tree, trust};

/// A built-in preset: `oak`, `abop-a`.
///
/// # Errors
/// [`Error::Unknown`], with the nearest id.
pub fn tree(id: &str) -> Result<Tree, Error> {
    Ok(Tree::of(builtin(id)?.recipe(&Quiet)?))
}

/// A tree from a file, told by its content: a preset (TOML), a recipe (JSON, alone or in any file that linden
/// wrote), a grammar, parameters of Arbaro, Sapling or tree-gen, a mesh that a crown fills (OBJ, PLY), points (PLY,
/// XYZ, LAS and LAZ, E57, PCD, PTX), a grid of heights (`GeoTIFF`), or cylinders (CSV, and the MAT of `TreeQSM`).
///
/// Files that a preset or recipe names are those beside it or below it ([`trust`]), else those that stand beside
/// built-in presets. No export of the tree replaces a file that it was read from. [`Reading`] does the same for a
/// monitor, and with other folders.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let file = folder.path().join("weed.l");
/// std::fs::write(&file, "axiom=F\nangle=25.7\nnumber of derivations=5\nF=(1)F[+F]F[-F]F\n")?;
/// let weed = linden::read(&file)?.set("derivations", "3")?.grow()?;
/// assert_eq!(weed.skeleton().segments(), 125);
/// # Ok::<(), linden::Error>(())
/// ```
///
/// # Errors
/// A file that cannot be read, or is nothing that a tree grows from; [`Error::NotAllowed`].
pub fn read(path: impl AsRef<Path>) -> Result<Tree, Error> {
    Reading::new().read(path)
}

/// As [`read()`], of a document that you trust: it may name files in some other folders too.
///
/// # Errors
/// As [`read()`]; a folder that is not there.
pub fn read_allowing<P: AsRef<Path>>(path: impl AsRef<Path>, folders: &[P]) -> Result<Tree, Error> {
    Reading::new().allowing(folders).read(path)
}

/// How a file is read: who watches, and where documents may name files.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let file = folder.path().join("weed.l");
/// # std::fs::write(&file, "axiom=F\nangle=25.7\nnumber of derivations=3\nF=(1)F[+F]F[-F]F\n")?;
/// use linden::{Monitor, Reading, monitor::Phase};
///
/// /// No more than 100 MB, for the file and for what grows from it.
/// struct Small;
///
/// impl Monitor for Small {
///     fn is_cancelled(&self) -> bool {
///         false
///     }
///
///     fn advance(&self, _phase: Phase, _done: u64, _total: Option<u64>) {}
///
///     fn memory_limit(&self) -> u64 {
///         100_000_000
///     }
/// }
///
/// let weed = Reading::new().watched(Small).read(&file)?.grow()?;
/// assert_eq!(weed.skeleton().segments(), 125);
/// # Ok::<(), linden::Error>(())
/// ```
pub struct Reading {
    folders: Vec<PathBuf>,
    watcher: Watcher,
}

impl Default for Reading {
    fn default() -> Self {
        Self::new()
    }
}

impl Reading {
    /// As [`read()`] does it: without a monitor, and with files beside the document alone.
    pub fn new() -> Self {
        Self { folders: Vec::new(), watcher: Arc::new(Quiet) }
    }

    /// With some other folders where a document that you trust may name files.
    #[must_use]
    pub fn allowing<P: AsRef<Path>>(mut self, folders: &[P]) -> Self {
        self.folders.extend(folders.iter().map(|folder| folder.as_ref().to_owned()));
        self
    }

    /// With a monitor, which hears of progress, can cancel, and limits memory: of reading, and of what becomes of the
    /// tree ([`Tree::watched`]).
    #[must_use]
    pub fn watched(self, watcher: impl Monitor + Send + 'static) -> Self {
        Self { watcher: Arc::new(watcher), ..self }
    }

    /// Reads a tree from a file, as [`read()`] says.
    ///
    /// # Errors
    /// As [`read()`]; a folder that is not there; [`Error::Memory`] of a file that is longer than there is memory, and
    /// [`Error::Cancelled`].
    pub fn read(self, path: impl AsRef<Path>) -> Result<Tree, Error> {
        let real = |folder: &PathBuf| fs::canonicalize(folder).map_err(|error| failed(folder, error));
        let allowed: Vec<PathBuf> = self.folders.iter().map(real).collect::<Result<_, _>>()?;
        Ok(read_watched(path.as_ref(), &allowed, &*self.watcher)?.watched_by(self.watcher))
    }
}

fn read_watched(path: &Path, allowed: &[PathBuf], monitor: &dyn Monitor) -> Result<Tree, Error> {
    let document = |fault| Error::Document { path: path.to_owned(), fault };
    ensure_regular(path).map_err(|error| failed(path, error))?;
    let mut file = BufReader::new(File::open(path).map_err(|error| failed(path, error))?);
    if let Some(json) = linden_exporters::recipe_in(&mut file).map_err(|error| failed(path, error))? {
        let tree = furnished(path, Preset::from_json(&json).map_err(document)?, allowed, monitor)?;
        return Ok(tree.with_provenance(&json));
    }
    drop(file);
    let bytes = load(path, monitor)?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let id =
        Path::new(&name).file_stem().map_or_else(|| "tree".to_owned(), |stem| stem.to_string_lossy().into());
    let input = |error| Error::of_input(path, error);
    let text = || {
        let not_utf8 = |_| Fault::new(None, "this is no UTF-8 text; save the file as UTF-8");
        str::from_utf8(&bytes).map_err(not_utf8).map_err(document)
    };
    let mut notes = Vec::new();
    let preset = match SourceKind::from(sniff(&bytes, &name).map_err(input)?) {
        SourceKind::Preset => {
            return furnished(path, Preset::from_toml(text()?).map_err(document)?, allowed, monitor);
        }
        SourceKind::Recipe => {
            let tree = furnished(path, Preset::from_json(text()?).map_err(document)?, allowed, monitor)?;
            return Ok(tree.with_provenance(text()?));
        }
        SourceKind::Grammar => {
            let found = text::parse(text()?).map_err(|error| {
                let place = linden_pipeline::document::TextPlace { line: error.line, column: error.column };
                document(Fault::new(Some(place), error.problem.to_string()))
            })?;
            notes = found.notes;
            Preset::of_grammar(&id, found.grammar, found.angle_deg, found.derivations)
        }
        SourceKind::TreeParameters => {
            let (preset, notes) = Preset::of_tree_parameters(&id, text()?).map_err(document)?;
            return Ok(Tree::of(Recipe::new(preset)).sparing(vec![path.to_owned()]).noting(notes));
        }
        SourceKind::Data(kind) => Preset::of_data(&id, &name, kind),
    };
    let mut recipe = Recipe::new(preset);
    if recipe.preset.files().contains(&name.as_str()) {
        recipe.inputs.insert(
            name.clone(),
            Input::read(&name, &bytes, &Holding::new(monitor, bytes.len() as u64)).map_err(input)?,
        );
    }
    Ok(Tree::of(recipe).sparing(vec![path.to_owned()]).noting(notes))
}

/// A preset with the files that it names: those beside its document, else those beside built-in presets.
fn furnished(path: &Path, preset: Preset, allowed: &[PathBuf], monitor: &dyn Monitor) -> Result<Tree, Error> {
    let mut recipe = Recipe::new(preset);
    let mut sources = vec![path.to_owned()];
    for file in recipe.preset.files().into_iter().map(str::to_owned).collect::<Vec<_>>() {
        let place = trust::beside(Some(path), &file, allowed)
            .map_err(|error| Error::NotAllowed { document: path.to_owned(), error })?;
        let monitor: &dyn Monitor = &Holding::new(monitor, recipe.inputs.bytes());
        let read = |bytes: &[u8]| {
            let input = Input::read(&file, bytes, &Holding::new(monitor, bytes.len() as u64));
            input.map_err(|error| Error::of_input(&place, error))
        };
        let input = match (load(&place, monitor), builtin_file(&file)) {
            (Ok(bytes), _) => {
                sources.push(place.clone());
                read(&bytes)?
            }
            (Err(error), Some(bytes)) if error.is_missing() => read(bytes)?,
            (Err(error), _) => return Err(error),
        };
        recipe.inputs.insert(file, input);
    }
    Ok(Tree::of(recipe).sparing(sources))
}

/// All of a regular file, whose length is asked for memory before it is read.
fn load(path: &Path, monitor: &dyn Monitor) -> Result<Vec<u8>, Error> {
    let refused = |error| failed(path, error);
    ensure_regular(path).map_err(refused)?;
    let mut file = File::open(path).map_err(refused)?;
    let announced = file.metadata().map_err(refused)?.len();
    let admit = |bytes: u64| monitor.admit("reading a file", bytes, "take a smaller file");
    admit(announced)?;
    let mut bytes = Vec::new();
    loop {
        monitor.check()?;
        let piece = (&mut file).take(PIECE_BYTES).read_to_end(&mut bytes).map_err(refused)?;
        if piece == 0 {
            return Ok(bytes);
        }
        // One that grows meanwhile.
        let there = bytes.len() as u64;
        admit(there.max(announced))?;
        monitor.advance(Phase::Read, there, Some(there.max(announced)));
    }
}

/// Bytes between two looks at the monitor.
const PIECE_BYTES: u64 = 1 << 20;

/// Pipes and devices are refused before they are opened, which may wait for ever or never end.
fn ensure_regular(path: &Path) -> io::Result<()> {
    if fs::metadata(path)?.is_file() {
        return Ok(());
    }
    Err(io::Error::new(ErrorKind::InvalidInput, "it is no regular file; name a file"))
}

fn failed(path: &Path, error: io::Error) -> Error {
    Error::Read { path: path.to_owned(), error }
}

/// A tree from a grammar: an axiom and rules, and lines `#define name value` among them.
///
/// A grammar has no units: one of `F` is the knob `segment_length`, 0.1 m by default, one of `!` is
/// `segment_width`, 0.01 m thick. Angles are degrees, a `+` alone turns by the knob `angle`, 25° by default. It is
/// rewritten 4 times, unless `derivations` says otherwise.
///
/// ```
/// let weed = linden::grammar("F", &["F -> F[+F]F[-F]F"])?;
/// let weed = weed.set("derivations", "5")?.set("angle", "25.7")?.grow()?;
/// assert_eq!(weed.skeleton().segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), linden::Error>(())
/// ```
///
/// # Errors
/// [`Error::Grammar`], with the place.
pub fn grammar<R: AsRef<str>>(axiom: &str, rules: &[R]) -> Result<Tree, Error> {
    Ok(Tree::of(Recipe::new(Preset::of("grammar", LSystem::of(Grammar::new(axiom, rules)?)))))
}
