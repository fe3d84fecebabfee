//! SOURCE: a preset's id, a file told by its content, or `-`; with overrides it becomes a recipe.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use anyhow::{Context, bail};
use linden::forest::builtin_forest;
use linden::input::{InputKind, sniff};
use linden::knob::{did_you_mean, printable};
use linden::lsystem::text;
use linden::preset::{Fault, Preset, RecipeError, Space, builtin, builtin_file};
use linden::recipe::{Input, Inputs, Recipe};
use linden::{Cancelled, Monitor};

use crate::exit::usage;

/// A recipe and what it is called.
#[derive(Debug)]
pub struct Source {
    /// As the user gave it, printable.
    pub shown: String,
    /// What grows.
    pub recipe: Recipe,
    /// What the user should know about it.
    pub notes: Vec<String>,
    /// The files that it was read from, which no output may replace.
    pub files: Vec<PathBuf>,
}

/// Reads SOURCE and turns the knobs.
pub fn resolve(source: &Path, set: &[(String, String)], monitor: &dyn Monitor) -> anyhow::Result<Source> {
    let shown = if source == Path::new("-") { "standard input".to_owned() } else { show(source) };
    let mut files = Vec::new();
    let (mut recipe, notes) = load(source, &mut files, monitor)?;
    for (name, value) in set {
        if Preset::file_keys().any(|(_, key, _)| key == name) {
            put_file(&mut recipe, (name, value), &mut files, monitor)?;
        } else {
            recipe.preset.set(name, value).map_err(usage)?;
        }
    }
    Ok(Source { shown, recipe, notes, files })
}

/// Reads a file that is named on the command line, in place of the one that the preset names.
fn put_file(
    recipe: &mut Recipe,
    (key, file): (&str, &str),
    files: &mut Vec<PathBuf>,
    monitor: &dyn Monitor,
) -> anyhow::Result<()> {
    let path = PathBuf::from(file);
    let reading = || format!("reading {} for '{key}'", show(&path));
    let bytes = fs::read(&path).with_context(reading)?;
    let input = Input::read(file, &bytes, monitor).with_context(reading)?;
    recipe.put_file(key, file, &input);
    files.push(path);
    Ok(())
}

/// Reads a source; `files` takes what it was read from.
fn load(
    path: &Path,
    files: &mut Vec<PathBuf>,
    monitor: &dyn Monitor,
) -> anyhow::Result<(Recipe, Vec<String>)> {
    // What is not Unicode is no id, but may be a file.
    let hint = match path.to_str().map_or(Err(None), builtin) {
        Ok(found) => {
            let recipe = found.recipe(monitor).map_err(|error| match error {
                RecipeError::Document(fault) => locate(found.id, &fault),
                RecipeError::Input(error) => error.into(),
            })?;
            return Ok((recipe, Vec::new()));
        }
        Err(hint) => hint,
    };
    if path == Path::new("-") {
        return read(None, &standard_input(monitor)?, files, monitor);
    }
    ensure_is_file(path, hint)?;
    let bytes = fs::read(path).with_context(|| format!("reading {}", show(path)))?;
    files.push(path.to_owned());
    read(Some(path), &bytes, files, monitor)
}

/// A recipe that stands in a document, with the files that it needs: beside that, or built in.
pub fn of_recipe(document: &Path, json: &str, monitor: &dyn Monitor) -> anyhow::Result<Source> {
    let mut files = Vec::new();
    let shown = show(document);
    let preset = Preset::from_json(json).map_err(|fault| locate(&shown, &fault))?;
    let inputs = read_beside(Some(document), &preset, &shown, &mut files, monitor)?;
    Ok(Source { shown, recipe: Recipe { preset, inputs }, notes: Vec::new(), files })
}

/// Whether there is such a source at all, without reading it: for what is read later.
pub fn ensure_there(path: &Path) -> anyhow::Result<()> {
    match path.to_str().map_or(Err(None), builtin) {
        Ok(_) => Ok(()),
        Err(hint) => ensure_is_file(path, hint),
    }
}

fn ensure_is_file(path: &Path, hint: Option<&str>) -> anyhow::Result<()> {
    if !path.exists() {
        let forest = path.to_str().map(builtin_forest);
        if let Some(Ok(forest)) = forest {
            let id = forest.id;
            return Err(usage(format!(
                "'{id}' is a forest, which 'linden forest {id} -o {id}.glb' writes and 'linden show {id}' describes"
            )));
        }
        let hint = hint.or(forest.and_then(|forest| forest.err().flatten()));
        return Err(usage(format!(
            "there is no preset and no file '{}'{}; 'linden list' shows the presets",
            show(path),
            did_you_mean(hint)
        )));
    }
    if path.is_dir() {
        return Err(usage(format!("'{}' is a directory; name a file in it", show(path))));
    }
    Ok(())
}

/// Makes a recipe of a file's content.
fn read(
    path: Option<&Path>,
    bytes: &[u8],
    files: &mut Vec<PathBuf>,
    monitor: &dyn Monitor,
) -> anyhow::Result<(Recipe, Vec<String>)> {
    let shown = path.map_or_else(|| "standard input".to_owned(), show);
    let reading = || format!("reading {shown}");
    let name = path.and_then(Path::file_name).map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let kind = sniff(bytes, &name).with_context(reading)?;
    let id = id_from(&name);
    let preset = match kind {
        InputKind::Preset => {
            Preset::from_toml(utf8(bytes, &shown)?).map_err(|fault| locate(&shown, &fault))?
        }
        InputKind::Recipe => {
            Preset::from_json(utf8(bytes, &shown)?).map_err(|fault| locate(&shown, &fault))?
        }
        InputKind::Grammar => {
            let own = text::parse(utf8(bytes, &shown)?).map_err(|error| {
                anyhow::anyhow!("{shown}:{}:{}: {}", error.line, error.column, error.problem)
            })?;
            Preset::of_grammar(&id, own.grammar, own.angle_deg, own.derivations)
        }
        InputKind::ObjMesh | InputKind::PlyMesh => {
            Preset::of_space(&id, Space::Envelope { file: name.clone() })
        }
        InputKind::PlyPoints | InputKind::XyzPoints => {
            Preset::of_space(&id, Space::Points { file: name.clone() })
        }
    };
    let mut notes = Vec::new();
    let inputs = match kind {
        InputKind::Preset | InputKind::Recipe => {
            let inputs = read_beside(path, &preset, &shown, files, monitor)?;
            if kind == InputKind::Recipe {
                notes.extend(other_files(bytes, &inputs));
            }
            inputs
        }
        InputKind::Grammar => Inputs::new(),
        InputKind::ObjMesh | InputKind::PlyMesh | InputKind::PlyPoints | InputKind::XyzPoints => {
            let input = Input::read(&name, bytes, monitor).with_context(reading)?;
            [(name, input)].into_iter().collect()
        }
    };
    Ok((Recipe { preset, inputs }, notes))
}

/// Reads the files that a preset names: beside its document, or else the built-in ones.
fn read_beside(
    path: Option<&Path>,
    preset: &Preset,
    shown: &str,
    files: &mut Vec<PathBuf>,
    monitor: &dyn Monitor,
) -> anyhow::Result<Inputs> {
    let folder = path.and_then(Path::parent).map_or_else(PathBuf::new, Path::to_owned);
    let mut inputs = Inputs::new();
    for file in preset.files() {
        let beside = folder.join(file);
        let content = match (fs::read(&beside), builtin_file(file)) {
            (Ok(content), _) => {
                files.push(beside.clone());
                content
            }
            (Err(error), Some(content)) if error.kind() == ErrorKind::NotFound => content.to_vec(),
            (Err(error), _) => {
                let reading = format!("reading {}, which {shown} needs", show(&beside));
                return Err(anyhow::Error::new(error).context(reading));
            }
        };
        let input =
            Input::read(file, &content, monitor).with_context(|| format!("reading {}", show(&beside)))?;
        inputs.insert(file, input);
    }
    Ok(inputs)
}

/// Notes about files that are not those that a recipe was made with.
fn other_files(recipe: &[u8], inputs: &Inputs) -> Vec<String> {
    let Ok(document) = serde_json::from_slice::<serde_json::Value>(recipe) else { return Vec::new() };
    // Recipes of before there were parts have one, by itself.
    let then = match (document.get("inputs"), document.get("input")) {
        (Some(serde_json::Value::Array(inputs)), _) => inputs.iter().collect(),
        (_, Some(input)) => vec![input],
        _ => Vec::new(),
    };
    let hash_then = |name: &str| {
        let text = |input: &serde_json::Value, key| input.get(key)?.as_str().map(str::to_owned);
        // Earlier versions wrote names as they are shown.
        let is_it = |file: String| file == name || file == printable(name);
        then.iter().find(|input| text(input, "file").is_some_and(is_it)).and_then(|input| text(input, "xxh3"))
    };
    let is_other =
        |(name, input): &(&str, &Input)| hash_then(name).is_some_and(|then| then != input.hash_text());
    let note = |(name, _)| {
        let name = printable(name);
        format!("{name} is not the file that the recipe was made with; another tree will grow")
    };
    inputs.iter().filter(is_other).map(note).collect()
}

/// Text, or where it stops being one.
pub fn utf8<'a>(bytes: &'a [u8], shown: &str) -> anyhow::Result<&'a str> {
    std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count() + 1;
        anyhow::anyhow!("reading {shown}, line {line}: not UTF-8 text; save the file as UTF-8")
    })
}

/// A fault with its file before it, as compilers and editors have it: `my.toml:3:7: …`.
pub fn locate(shown: &str, fault: &Fault) -> anyhow::Error {
    match fault.place {
        Some(place) => anyhow::anyhow!("{shown}:{place}: {}", fault.message),
        None => anyhow::anyhow!("{shown}: {}", fault.message),
    }
}

/// An id from a file's name: `My tree.v2.txt` gives `My tree.v2`.
fn id_from(name: &str) -> String {
    let stem = Path::new(name).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    if stem.is_empty() { "tree".to_owned() } else { stem }
}

/// A path, safe to show.
pub fn show(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

/// All of standard input. A thread reads it, so that Ctrl-C is heard while nothing comes.
fn standard_input(monitor: &dyn Monitor) -> anyhow::Result<Vec<u8>> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let read = std::io::stdin().lock().read_to_end(&mut bytes);
        let _ = sender.send(read.map(|_| bytes));
    });
    loop {
        match receiver.recv_timeout(Duration::from_millis(20)) {
            Ok(read) => return read.context("reading standard input"),
            Err(mpsc::RecvTimeoutError::Timeout) if monitor.is_cancelled() => bail!(Cancelled),
            Err(mpsc::RecvTimeoutError::Timeout) => {}
            Err(mpsc::RecvTimeoutError::Disconnected) => bail!("reading standard input: the reader stopped"),
        }
    }
}
