//! Forests: a built-in one's id, a document, or a file that carries a forest's recipe.

use std::path::{Path, PathBuf};

use anyhow::Context;
use linden::Monitor;
use linden::forest::{FOREST_KNOBS, Forest, ForestDocument, ForestKind, TreeSource, builtin_forest};
use linden::preset::{KnobError, builtin};

use crate::config::presets::has_trees;
use crate::exit::usage;
use crate::paths::show;
use crate::source::Source;

/// A forest and what it was read from.
#[derive(Debug)]
pub struct ForestSource {
    /// What grows.
    pub forest: Forest,
    /// One line: what it is.
    pub summary: String,
    /// What the user should know about it.
    pub notes: Vec<String>,
    /// The files that it was read from, which no output may replace.
    pub files: Vec<PathBuf>,
}

/// What a source may be: a tree, or a forest.
#[derive(Debug)]
pub enum AnySource {
    /// A tree.
    Tree(Box<Source>),
    /// Several.
    Forest(Box<ForestSource>),
}

impl AnySource {
    /// Reads a source: a forest, or else a tree with all points of its files.
    pub fn read(source: &Path, monitor: &dyn Monitor) -> anyhow::Result<Self> {
        if let Some(named) = source.to_str()
            && let Some(file) = ForestFile::find(named, monitor)?
        {
            return Ok(Self::Forest(Box::new(file.resolve(monitor)?)));
        }
        Ok(Self::Tree(Box::new(super::resolve_whole(source, monitor)?)))
    }
}

/// A forest's document, as an argument names it.
#[derive(Debug)]
pub struct ForestFile {
    id: String,
    /// `None`: built in.
    path: Option<PathBuf>,
    /// As it stands in the file.
    pub text: String,
    /// What it says.
    pub document: ForestDocument,
}

impl ForestFile {
    /// The document that an argument names, if it is one of a forest.
    pub fn find(argument: &str, monitor: &dyn Monitor) -> anyhow::Result<Option<Self>> {
        if let Ok(builtin) = builtin_forest(argument) {
            let document = builtin.load().map_err(|fault| super::locate(builtin.id, &fault))?;
            let (id, text) = (builtin.id.to_owned(), builtin.text.to_owned());
            return Ok(Some(Self { id, path: None, text, document }));
        }
        let users = super::user_preset(Path::new(argument))?;
        let path = users.as_deref().unwrap_or(Path::new(argument));
        if builtin(argument).is_ok() || !path.is_file() {
            return Ok(None);
        }
        let Some(text) = Self::text(path, monitor)? else { return Ok(None) };
        let document = ForestDocument::parse(&text).map_err(|fault| super::locate(&show(path), &fault))?;
        let stem = || path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let id = document.id.clone().or_else(stem).unwrap_or_else(|| "forest".to_owned());
        Ok(Some(Self { id, path: Some(path.to_owned()), text, document }))
    }

    /// The text of a forest's document, or the recipe that a forest's file carries.
    fn text(path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Option<String>> {
        let shown = show(path);
        let reading = || format!("reading {shown}");
        let mut content = super::open(path, monitor)?;
        if let Some(recipe) = content.recipe(monitor).with_context(reading)? {
            return Ok(Some(recipe).filter(|json| super::is_forest(json)));
        }
        if !path.extension().is_some_and(|ending| ending == "toml" || ending == "json") {
            return Ok(None);
        }
        let bytes = content.bytes(monitor).with_context(reading)?;
        let text = super::document(&bytes, &shown, monitor)?;
        // What tells it from a preset.
        Ok((has_trees(text) || super::is_forest(text)).then(|| text.to_owned()))
    }

    /// As it was named: an id, or a file.
    pub fn shown(&self) -> String {
        self.path.as_deref().map_or_else(|| self.id.clone(), show)
    }

    /// The forest, its kinds read.
    pub fn resolve(self, monitor: &dyn Monitor) -> anyhow::Result<ForestSource> {
        let Self { id, path, document, text } = self;
        let mut files: Vec<PathBuf> = path.iter().cloned().collect();
        let beside = path.as_deref().unwrap_or(Path::new(""));
        let mut kinds = Vec::new();
        let mut notes: Vec<String> = Vec::new();
        for tree in document.trees {
            let source = match &tree.source {
                TreeSource::Recipe(json) => super::of_recipe(beside, json, monitor)?,
                TreeSource::Named(name) => {
                    let place = || super::mention(&show(beside), &text, name);
                    let named = super::named_in(path.as_deref(), name).with_context(place)?;
                    super::resolve(&named, &[], monitor)?
                }
            };
            // Of the same document all kinds say the same.
            let news: Vec<_> = source.notes.into_iter().filter(|note| !notes.contains(note)).collect();
            notes.extend(news);
            files.extend(source.files);
            let mut recipe = source.recipe;
            for (name, value) in &tree.set {
                recipe.preset.set(name, value).map_err(usage)?;
            }
            kinds.push(ForestKind { recipe, share: tree.share, size: tree.size });
        }
        let name = if document.name.trim().is_empty() { id.clone() } else { document.name };
        let name = linden::knob::printable(&name);
        let forest = Forest { id, name, kinds, layout: document.layout };
        Ok(ForestSource { forest, summary: document.summary, notes, files })
    }
}

/// Turns a knob of the forest, or else of all kinds of trees that have it.
pub fn turn(forest: &mut Forest, name: &str, value: &str) -> anyhow::Result<()> {
    if FOREST_KNOBS.iter().any(|row| row.knob.name == name) {
        return forest.layout.set(name, value).map_err(usage);
    }
    let mut unknown = None;
    let mut turned = 0;
    for kind in &mut forest.kinds {
        match kind.recipe.preset.set(name, value) {
            Ok(()) => turned += 1,
            Err(error @ KnobError::Value { .. }) => return Err(usage(error)),
            Err(error) => unknown = unknown.or(Some(error)),
        }
    }
    match unknown.filter(|_| turned == 0) {
        Some(error) => Err(usage(error)),
        None => Ok(()),
    }
}
