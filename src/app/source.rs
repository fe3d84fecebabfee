//! SOURCE: a preset's id, a file told by its content, or `-`; with overrides it becomes a recipe.

pub mod forest;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::Context;
use linden::Monitor;
use linden::forest::builtin_forest;
use linden::grow::Grown;
use linden::input::{InputKind, sniff};
use linden::knob::{did_you_mean, nearest, printable};
use linden::lsystem::text;
use linden::preset::{Fault, Preset, RecipeError, SourceKind, builtin, builtin_file, builtins};
use linden::provenance::Provenance;
use linden::recipe::{Input, Inputs, Recipe};

use crate::config::dirs::Dirs;
use crate::config::presets;
use crate::exit::usage;
use crate::paths::show;
use crate::reading::{self, Content};
use crate::trust;

/// A recipe and what it is called.
#[derive(Clone, Debug)]
pub struct Source {
    /// As the user gave it, printable.
    pub shown: String,
    /// What grows.
    pub recipe: Recipe,
    /// What its document says of the tree that it is from, where it is a recipe.
    pub provenance: Option<Provenance>,
    /// What the user should know about it.
    pub notes: Vec<String>,
    /// The files that it was read from, which no output may replace.
    pub files: Vec<PathBuf>,
}

impl Source {
    /// Whether the tree that grew is the one that the recipe was made with, where there is anything to say.
    pub fn tree_note(&self, grown: &Grown) -> Option<String> {
        let note = self.provenance.as_ref()?.tree_note(&self.recipe, grown)?;
        Some(format!("{}: {note}", self.shown))
    }

    /// Without the note that a grammar has no units.
    pub fn without_units(mut self) -> Self {
        self.notes.retain(|note| !note.ends_with(UNITS));
        self
    }
}

/// Reads SOURCE and turns the knobs.
pub fn resolve(source: &Path, set: &[(String, String)], monitor: &dyn Monitor) -> anyhow::Result<Source> {
    Reader::new(monitor).resolve(source, set)
}

/// Reads SOURCE with all points of its files, so that the knob that thins them can still be turned either way.
pub fn resolve_whole(source: &Path, monitor: &dyn Monitor) -> anyhow::Result<Source> {
    Reader { keeps_points: true, ..Reader::new(monitor) }.resolve(source, &[])
}

/// What a grammar without a preset does not say.
const UNITS: &str = "a grammar has no units: a unit of F is segment_length (0.1 m), one of ! is segment_width \
                     (0.01 m thick); --set segment_length=1 reads metres";

/// Knobs that say how old a plant is: `--age` and `--ages` turn them.
pub const OF_AGE: [&str; 3] = ["age", "years", "derivations"];

/// Whether `--set` names a file by this key.
pub fn is_file_key(name: &str) -> bool {
    Preset::is_file_key(name)
}

/// A recipe that stands in a document, with the files that it needs: beside that, or built in.
pub fn of_recipe(document: &Path, json: &str, monitor: &dyn Monitor) -> anyhow::Result<Source> {
    let mut reader = Reader::new(monitor);
    let shown = show(document);
    let recipe = reader.recipe(Some(document), &shown, json)?;
    Ok(reader.finish(shown, recipe))
}

/// The recipe of a tree that a file carries or is, whether or not the files that it names are there; `None` of any other, and
/// of standard input, which is read once.
pub fn carried_recipe(source: &Path, monitor: &dyn Monitor) -> anyhow::Result<Option<String>> {
    if is_standard_input(source) {
        return Ok(None);
    }
    let mut content = open(source, monitor)?;
    let json = match content.recipe(monitor)? {
        Some(json) => json,
        None => {
            let bytes = content.bytes(monitor)?;
            let is_recipe =
                sniff(&bytes, &file_name(Some(source))).is_ok_and(|kind| kind == InputKind::Recipe);
            if !is_recipe {
                return Ok(None);
            }
            document(&bytes, &show(source), monitor)?.to_owned()
        }
    };
    Ok((!is_forest(&json)).then_some(json))
}

/// As a message names SOURCE.
pub fn shown(source: &Path) -> String {
    if is_standard_input(source) { "standard input".to_owned() } else { show(source) }
}

fn is_standard_input(source: &Path) -> bool {
    source == Path::new("-")
}

/// Opens a file, a pipe, or standard input.
pub fn open(source: &Path, monitor: &dyn Monitor) -> anyhow::Result<Content> {
    if is_standard_input(source) {
        return reading::standard_input(monitor);
    }
    ensure_is_file(source)?;
    reading::open(source, monitor).with_context(|| format!("reading {}", show(source)))
}

/// Opens what an argument names as a file alone, and no preset's id can mean: a manifest, a configuration.
pub fn open_file(path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Content> {
    let is_missing = path.metadata().is_err_and(|error| is_absent(&error));
    if is_missing && !is_standard_input(path) {
        return Err(usage(format!("there is no file '{}'", show(path))));
    }
    open(path, monitor)
}

/// The preset of the user's that an id means: an id is first that of what is built in, then of a preset of
/// the user's; a file of such a name is given as ./NAME.
///
/// # Errors
/// More than one file of that id.
pub fn user_preset(id: &Path) -> anyhow::Result<Option<PathBuf>> {
    let Some(id) = id.to_str().filter(|id| builtin(id).is_err() && builtin_forest(id).is_err()) else {
        return Ok(None);
    };
    let Some(dir) = Dirs::of_environment().presets() else { return Ok(None) };
    match presets::find(&dir, id).as_slice() {
        [] => Ok(None),
        [path] => Ok(Some(path.clone())),
        several => {
            let files: Vec<String> = several.iter().map(|path| show(path)).collect();
            let id = printable(id);
            Err(usage(format!("there are several presets '{id}'; name the file: {}", files.join(", "))))
        }
    }
}

/// What a document (`None`: standard input) means by the name of a tree: the id of a preset, or a file that it may name.
///
/// # Errors
/// Several presets of the user's with that id, no such preset or file, and a file elsewhere.
pub fn named_in(document: Option<&Path>, name: &str) -> anyhow::Result<PathBuf> {
    if builtin(name).is_ok() || user_preset(Path::new(name))?.is_some() {
        return Ok(name.into());
    }
    let path = crate::trust::beside(document, name).map_err(usage)?;
    // What is no file was meant for an id, and is shown as it was typed.
    match path.metadata() {
        Err(error) if is_absent(&error) => Err(not_there(Path::new(name))),
        _ => Ok(path),
    }
}

/// Whether there is such a source at all, a tree or a forest, without reading it: for what is read later.
pub fn ensure_there(source: &Path) -> anyhow::Result<()> {
    let is_built_in = source.to_str().is_some_and(|id| builtin(id).is_ok() || builtin_forest(id).is_ok());
    if is_built_in || user_preset(source)?.is_some() { Ok(()) } else { ensure_is_file(source) }
}

/// There is no such source.
fn not_there(source: &Path) -> anyhow::Error {
    let forest = source.to_str().map(builtin_forest);
    if let Some(Ok(forest)) = forest {
        let id = forest.id;
        return usage(format!(
            "'{id}' is a forest, which 'linden forest {id} -o {id}.glb' writes and 'linden show {id}' describes"
        ));
    }
    let users = Dirs::of_environment().presets().map_or_else(Vec::new, |dir| presets::ids(&dir));
    let known = builtins().iter().map(|builtin| builtin.id).chain(users.iter().map(String::as_str));
    let hint = source.to_str().and_then(|typed| nearest(typed, known));
    let hint = hint.or(forest.and_then(|forest| forest.err().flatten()));
    usage(format!(
        "there is no preset and no file '{}'{}; 'linden list' shows the presets",
        show(source),
        did_you_mean(hint)
    ))
}

/// Whether there is no such file, which will be so the next time as well; others may be there but for a fault of the disk.
fn is_absent(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

fn ensure_is_file(path: &Path) -> anyhow::Result<()> {
    let about = match path.metadata() {
        Ok(about) => about,
        Err(error) if is_absent(&error) => return Err(not_there(path)),
        Err(error) => return Err(error).with_context(|| format!("reading '{}'", show(path))),
    };
    match reading::what(&about) {
        Some("a directory") => Err(usage(format!("'{}' is a directory; name a file in it", show(path)))),
        Some(what) if !crate::system::is_pipe(&about) => {
            let shown = show(path);
            Err(usage(format!("'{shown}' is {what}; name a file or a pipe, or give - for standard input")))
        }
        _ => Ok(()),
    }
}

/// Reads a source and what it needs.
struct Reader<'a> {
    monitor: &'a dyn Monitor,
    /// Files that the user puts in the place of those that the preset names: key, name, content.
    given: Vec<(String, String, Input)>,
    /// Knobs that the user turns, of which some say how files are read.
    knobs: Vec<(String, String)>,
    /// Whether all points are kept, whatever the knobs say.
    keeps_points: bool,
    provenance: Option<Provenance>,
    notes: Vec<String>,
    /// Whether it read a grammar that comes without a preset.
    is_bare_grammar: bool,
    /// What was read.
    files: Vec<PathBuf>,
}

/// A preset with the text that it stands in.
struct NamedDocument<'a> {
    /// `None`: standard input.
    path: Option<&'a Path>,
    shown: &'a str,
    text: &'a str,
}

impl<'a> Reader<'a> {
    fn new(monitor: &'a dyn Monitor) -> Self {
        Self {
            monitor,
            given: Vec::new(),
            knobs: Vec::new(),
            keeps_points: false,
            provenance: None,
            notes: Vec::new(),
            is_bare_grammar: false,
            files: Vec::new(),
        }
    }

    /// Reads SOURCE and turns the knobs.
    fn resolve(mut self, source: &Path, set: &[(String, String)]) -> anyhow::Result<Source> {
        let (files, knobs): (Vec<_>, Vec<_>) = set.iter().partition(|(name, _)| is_file_key(name));
        self.knobs = knobs.iter().map(|&knob| knob.clone()).collect();
        for (key, file) in files {
            self.give(key, file)?;
        }
        let mut recipe = self.load(source)?;
        let foliage = recipe.preset.dressing.foliage.clone();
        for (name, value) in &knobs {
            recipe.preset.set(name, value).map_err(usage)?;
        }
        self.notes.extend(recipe.preset.dressing.foliage.form_notes(&foliage));
        if self.is_bare_grammar && !knobs.iter().any(|(name, _)| name == "segment_length") {
            self.notes.push(format!("{}: {UNITS}", shown(source)));
        }
        Ok(self.finish(shown(source), recipe))
    }

    fn finish(self, shown: String, recipe: Recipe) -> Source {
        let Self { provenance, notes, files, .. } = self;
        Source { shown, recipe: crate::cache::kept(recipe), provenance, notes, files }
    }

    /// Reads a file that is named on the command line, in place of the one that the preset names.
    fn give(&mut self, key: &str, file: &str) -> anyhow::Result<()> {
        let path = PathBuf::from(file);
        let reading = || format!("reading {} for '{key}'", show(&path));
        let content = reading::open(&path, self.monitor).map_err(|error| {
            let is_absent = error.downcast_ref().is_some_and(is_absent);
            if is_absent { usage(format!("{}: {error}", reading())) } else { error.context(reading()) }
        })?;
        let cube = self.thinning(&Preset::of_points("points", file));
        let input = content.input(file, cube, self.monitor).with_context(reading)?;
        self.given.push((key.to_owned(), file.to_owned(), input));
        self.files.push(path);
        Ok(())
    }

    /// The sides of the cubes that a preset's points are thinned to, with the knobs that the user turns. What is wrong with
    /// these is said when they are turned.
    fn thinning(&self, preset: &Preset) -> Option<f64> {
        if self.keeps_points {
            return None;
        }
        let mut preset = preset.clone();
        for (name, value) in &self.knobs {
            let _ = preset.set(name, value);
        }
        preset.generator.thinning()
    }

    fn load(&mut self, source: &Path) -> anyhow::Result<Recipe> {
        // What is not Unicode is no id, but may be a file.
        if let Some(Ok(found)) = source.to_str().map(builtin) {
            let recipe = found.recipe(self.monitor).map_err(|error| match error {
                RecipeError::Document(fault) => locate(found.id, &fault),
                RecipeError::Input(error) => error.into(),
                other => other.into(),
            })?;
            return self.replaced(recipe);
        }
        let users = user_preset(source)?;
        let path = users.as_deref().unwrap_or(source);
        let mut content = open(path, self.monitor)?;
        let path = (!is_standard_input(path)).then_some(path);
        self.files.extend(path.map(Path::to_owned));
        let shown = path.map_or_else(|| shown(source), show);
        let reading = || format!("reading {shown}");
        let name = file_name(path);
        match content.recipe(self.monitor).with_context(reading)? {
            Some(json) => {
                self.recipe(path, &shown, &json).or_else(|error| match error.downcast::<MissingFile>() {
                    Ok(missing) => self.table_without(missing, path, &shown, content),
                    Err(other) => Err(other),
                })
            }
            None if content.is_streamed(&name).with_context(reading)? => {
                self.grown_into(Preset::of_points(&id_from(&name), &name), &name, content, &shown)
            }
            None => self.read(path, &shown, content.bytes(self.monitor).with_context(reading)?),
        }
    }

    /// The cylinders of a table whose recipe cannot be grown again, for lack of a file.
    fn table_without(
        &mut self,
        missing: MissingFile,
        path: Option<&Path>,
        shown: &str,
        content: Content,
    ) -> anyhow::Result<Recipe> {
        let bytes = content.bytes(self.monitor).with_context(|| format!("reading {shown}"))?;
        if !matches!(sniff(&bytes, &file_name(path)), Ok(InputKind::Cylinders { .. })) {
            return Err(missing.into());
        }
        self.notes.push(format!("{missing}; until then its cylinders grow as they stand in the table"));
        self.read(path, shown, bytes)
    }

    /// A preset with the one file that it is made for.
    fn grown_into(
        &self,
        preset: Preset,
        name: &str,
        content: Content,
        shown: &str,
    ) -> anyhow::Result<Recipe> {
        let cube = self.thinning(&preset);
        let input = content.input(name, cube, self.monitor).with_context(|| format!("reading {shown}"))?;
        let mut recipe = Recipe::new(preset);
        recipe.inputs.insert(name.to_owned(), input);
        self.replaced(recipe)
    }

    /// Makes a recipe of a file's content.
    fn read(&mut self, path: Option<&Path>, shown: &str, content: Vec<u8>) -> anyhow::Result<Recipe> {
        let reading = || format!("reading {shown}");
        let name = file_name(path);
        let bytes = &content[..];
        let kind = SourceKind::from(sniff(bytes, &name).with_context(reading)?);
        let id = id_from(&name);
        let preset = match kind {
            SourceKind::Preset => {
                let text = document(bytes, shown, self.monitor)?;
                let preset = Preset::from_toml(text).map_err(|fault| locate(shown, &fault))?;
                return self.furnished(preset, &NamedDocument { path, shown, text });
            }
            SourceKind::Recipe => return self.recipe(path, shown, document(bytes, shown, self.monitor)?),
            SourceKind::Grammar => {
                let parsed = text::parse(utf8(bytes, shown)?).map_err(|error| {
                    usage(format!("{shown}:{}:{}: {}", error.line, error.column, error.problem))
                })?;
                self.notes.extend(parsed.notes.into_iter().map(|note| format!("{shown}: {note}")));
                let preset = Preset::of_grammar(&id, parsed.grammar, parsed.angle_deg, parsed.derivations);
                self.is_bare_grammar = true;
                return self.replaced(Recipe::new(preset));
            }
            SourceKind::TreeParameters => {
                let (preset, notes) = Preset::of_tree_parameters(&id, utf8(bytes, shown)?)
                    .map_err(|fault| locate(shown, &fault))?;
                self.notes.extend(notes.into_iter().map(|note| format!("{shown}: {note}")));
                return self.replaced(Recipe::new(preset));
            }
            SourceKind::Data(kind) => Preset::of_data(&id, &name, kind),
        };
        self.grown_into(preset, &name, Content::Bytes(content), shown)
    }

    /// Reads a tree's recipe, and says which of its files are others by now.
    fn recipe(&mut self, path: Option<&Path>, shown: &str, json: &str) -> anyhow::Result<Recipe> {
        if is_forest(json) {
            return Err(usage(format!(
                "{shown} is a forest, which 'linden forest' grows and 'linden show' describes"
            )));
        }
        let preset = Preset::from_json(json).map_err(|fault| locate(shown, &fault))?;
        let recipe = self.furnished(preset, &NamedDocument { path, shown, text: json })?;
        let provenance = Provenance::of(json, &recipe);
        self.notes.extend(provenance.version_note().map(|note| format!("{shown}: {note}")));
        self.notes.extend(other_files(json, &recipe.inputs));
        // With other files it is another recipe.
        self.provenance = Some(provenance).filter(|_| self.given.is_empty());
        Ok(recipe)
    }

    /// The recipe with the files that the user gave.
    fn replaced(&self, mut recipe: Recipe) -> anyhow::Result<Recipe> {
        for (key, file, input) in &self.given {
            recipe.preset.check_kind_of(key).map_err(usage)?;
            recipe.put_file(key, file, input);
        }
        Ok(recipe)
    }

    /// A preset with the files that it names: those that the user gave, else beside its document, else
    /// built in.
    fn furnished(&mut self, preset: Preset, document: &NamedDocument<'_>) -> anyhow::Result<Recipe> {
        let mut recipe = self.replaced(Recipe::new(preset))?;
        let files: Vec<String> = recipe.preset.files().into_iter().map(str::to_owned).collect();
        for file in files {
            if recipe.input(&file).is_none() {
                let input = self.named(&file, self.thinning(&recipe.preset), document)?;
                recipe.inputs.insert(file, input);
            }
        }
        Ok(recipe)
    }

    /// Reads a file that a document names.
    fn named(
        &mut self,
        file: &str,
        cube: Option<f64>,
        document: &NamedDocument<'_>,
    ) -> anyhow::Result<Input> {
        let NamedDocument { path, shown, text } = *document;
        let place = || mention(shown, text, file);
        let allowed = trust::beside(path, file).with_context(place)?;
        // As the user knows it, links not followed.
        let beside = path.and_then(Path::parent).unwrap_or(Path::new("")).join(file);
        let content = match (reading::open_regular(&allowed), builtin_file(file)) {
            (Ok(file), _) => {
                self.files.push(beside.clone());
                Content::File(file)
            }
            (Err(error), built_in) => {
                let is_missing = error.kind() == ErrorKind::NotFound;
                match built_in.filter(|_| is_missing) {
                    Some(content) => Content::Bytes(content.to_vec()),
                    None if is_missing => {
                        if let Some(input) = self.elsewhere(file, cube, text)? {
                            return Ok(input);
                        }
                        let said = format!(
                            "{error}; put it there, name one that is there, or say with --allow-path where it is"
                        );
                        let said = format!("{}: reading {}: {said}", place(), show(&beside));
                        return Err(MissingFile(said).into());
                    }
                    None => {
                        let reading = format!("{}: reading {}", place(), show(&beside));
                        return Err(anyhow::Error::from(error).context(reading));
                    }
                }
            }
        };
        let reading = || format!("{}: reading {}", place(), show(&beside));
        content.input(file, cube, self.monitor).with_context(reading)
    }

    /// The file of a document that was written into another folder than its preset's.
    fn elsewhere(&mut self, file: &str, cube: Option<f64>, document: &str) -> anyhow::Result<Option<Input>> {
        for found in trust::elsewhere(file) {
            let reading = || format!("reading {}", show(&found.path));
            let input = reading::open_regular(&found.path)
                .map_err(anyhow::Error::from)
                .and_then(|opened| Content::File(opened).input(file, cube, self.monitor));
            // What is wrong with a file that nobody allowed is not said, for it would quote from it.
            let input = match input {
                Ok(input) => input,
                Err(error) if found.is_allowed => return Err(error.context(reading())),
                Err(_) => continue,
            };
            if found.is_allowed || hash_then(document, file).as_deref() == Some(&*input.hash_text()) {
                self.files.push(found.path);
                return Ok(Some(input));
            }
        }
        Ok(None)
    }
}

/// A file that a document names and that is not there.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct MissingFile(String);

/// A path's last part; empty for standard input.
fn file_name(path: Option<&Path>) -> String {
    path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Where a document names a file, and under which key: `my.toml:3:1: 'leaf_mesh'`.
pub fn mention(shown: &str, text: &str, file: &str) -> String {
    match linden::preset::mention(text, file) {
        Some((key, Some(place))) => format!("{shown}:{place}: '{key}'"),
        Some((key, None)) => format!("{shown}: '{key}'"),
        None => shown.to_owned(),
    }
}

/// Whether a recipe is a forest's.
pub fn is_forest(json: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct OfForest {
        #[serde(rename = "tree")]
        _trees: serde::de::IgnoredAny,
    }
    serde_json::from_str::<OfForest>(json).is_ok()
}

/// What a byte of a document becomes at its worst while it is read: a list of numbers of one digit.
const DOCUMENT_BYTES: u64 = 100;

/// A document's text.
pub fn document<'a>(bytes: &'a [u8], shown: &str, monitor: &dyn Monitor) -> anyhow::Result<&'a str> {
    let needed = (bytes.len() as u64).saturating_mul(DOCUMENT_BYTES);
    monitor
        .admit("reading a document", needed, "take a shorter one")
        .with_context(|| format!("reading {shown}"))?;
    utf8(bytes, shown)
}

/// Notes about files that are not those that a recipe was made with.
fn other_files(recipe: &str, inputs: &Inputs) -> Vec<String> {
    let is_other = |(name, input): &(&str, &Input)| {
        hash_then(recipe, name).is_some_and(|then| then != input.hash_text())
    };
    let note = |(name, _)| {
        let name = printable(name);
        format!("{name} is not the file that the recipe was made with; another tree will grow")
    };
    inputs.iter().filter(is_other).map(note).collect()
}

/// The hash of a file when a recipe was made with it.
fn hash_then(recipe: &str, name: &str) -> Option<String> {
    let document: serde_json::Value = serde_json::from_str(recipe).ok()?;
    // Recipes of before there were parts have one, by itself.
    let then = match (document.get("inputs"), document.get("input")) {
        (Some(serde_json::Value::Array(inputs)), _) => inputs.iter().collect(),
        (_, Some(input)) => vec![input],
        _ => Vec::new(),
    };
    let text = |input: &serde_json::Value, key| input.get(key)?.as_str().map(str::to_owned);
    // Earlier versions wrote names as they are shown.
    let is_it = |file: String| file == name || file == printable(name);
    then.iter().find(|input| text(input, "file").is_some_and(is_it)).and_then(|input| text(input, "xxh3"))
}

/// Text, or where it stops being one.
pub fn utf8<'a>(bytes: &'a [u8], shown: &str) -> anyhow::Result<&'a str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count() + 1;
        usage(format!("reading {shown}, line {line}: not UTF-8 text; save the file as UTF-8"))
    })
}

/// A fault with its file before it, as compilers and editors have it: `my.toml:3:7: …`.
pub fn locate(shown: &str, fault: &Fault) -> anyhow::Error {
    match fault.place {
        Some(place) => usage(format!("{shown}:{place}: {}", fault.message)),
        None => usage(format!("{shown}: {}", fault.message)),
    }
}

/// An id from a file's name: `My tree.v2.txt` gives `My tree.v2`.
fn id_from(name: &str) -> String {
    let stem = Path::new(name).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    if stem.is_empty() { "tree".to_owned() } else { stem }
}

#[cfg(test)]
mod tests {
    use linden::recipe::Geometry;

    use super::*;
    use crate::source::forest::AnySource;

    #[test]
    fn points_are_thinned_as_the_user_says_and_kept_where_the_knob_can_be_turned() {
        let folder = tempfile::tempdir().unwrap();
        let points: Vec<String> = (0..100).map(|i| format!("0 0 {}", 0.01 * f64::from(i))).collect();
        std::fs::write(folder.path().join("stem.xyz"), points.join("\n")).unwrap();
        let preset = folder.path().join("stem.toml");
        std::fs::write(&preset, "id = \"stem\"\n[scan]\nfile = \"stem.xyz\"\nthin = 0.05\n").unwrap();
        let kept = |recipe: &Recipe| match &recipe.input("stem.xyz").unwrap().geometry {
            Geometry::Points(cloud) => (cloud.positions.len(), cloud.thinned.map(|thinned| thinned.cube)),
            _ => panic!("no points"),
        };
        let set = |thin: &str| [("thin".to_owned(), thin.to_owned())];
        assert_eq!(kept(&resolve(&preset, &[], &linden::Quiet).unwrap().recipe).1, Some(0.05));
        assert_eq!(kept(&resolve(&preset, &set("0.2"), &linden::Quiet).unwrap().recipe), (5, Some(0.2)));
        assert_eq!(kept(&resolve(&preset, &set("0"), &linden::Quiet).unwrap().recipe), (100, None));
        // The workbench turns it afterwards.
        let AnySource::Tree(opened) = AnySource::read(&preset, &linden::Quiet).unwrap() else {
            panic!("a forest")
        };
        assert_eq!(kept(&opened.recipe), (100, None));
    }
}
