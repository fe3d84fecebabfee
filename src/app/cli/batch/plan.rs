//! A manifest with its sources read: which tree has which number, and where its files go.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::formats::find;
use anyhow::Context;
use linden::manifest::Manifest;
use linden::recipe::Recipe;
use linden::texture::DrawnPictures;
use linden_exporters::{ExportError, Exporter, Format, Options};
use xxhash_rust::xxh3::xxh3_128;

use super::thumbnail::Thumbnail;
use crate::cache;
use crate::cli::ages;
use crate::cli::crew::room_for_pictures;
use crate::exit::usage;
use crate::paths::show;
use crate::progress::Progress;
use crate::source::{self, OF_AGE, Source};

/// The most trees of one manifest.
const MOST: usize = 10_000_000;

/// A manifest with its sources.
pub struct Plan {
    /// The manifest's file; `None`: its sources were typed.
    path: Option<PathBuf>,
    manifest: Manifest,
    /// By the names that the manifest has for them.
    sources: BTreeMap<String, Source>,
}

/// One tree.
pub struct Tree {
    /// Its number, from 0.
    pub index: usize,
    pub source: String,
    pub age: Option<String>,
    pub set: BTreeMap<String, String>,
    pub define: BTreeMap<String, String>,
    pub recipe: Recipe,
    /// Files that it is read from.
    pub files: Vec<PathBuf>,
    /// Formats, their options, and the main files within the output folder.
    pub outputs: Vec<(&'static dyn Exporter, Options, String)>,
}

impl Tree {
    /// The formats with their options.
    pub fn formats(&self) -> Vec<(&'static Format, &Options)> {
        self.outputs.iter().map(|(exporter, options, _)| (exporter.format(), options)).collect()
    }
}

impl Plan {
    pub fn read(path: &Path, progress: &Progress) -> anyhow::Result<Self> {
        let shown = show(path);
        let content = source::open_file(path, progress)?;
        let bytes = content.bytes(progress).with_context(|| format!("reading {shown}"))?;
        let text = source::document(&bytes, &shown, progress)?;
        let manifest = Manifest::parse(text).map_err(|fault| source::locate(&shown, &fault))?;
        let document = (path != Path::new("-")).then_some(path);
        let named = |name: &str| {
            source::named_in(document, name).with_context(|| source::mention(&shown, text, name))
        };
        Self::of(manifest, Some(path), &named, progress)
    }

    /// Of a manifest whose sources were typed, like arguments.
    pub fn typed(manifest: Manifest, progress: &Progress) -> anyhow::Result<Self> {
        Self::of(manifest, None, &|name| Ok(name.into()), progress)
    }

    /// `named` has what a manifest means by a source.
    fn of(
        manifest: Manifest,
        path: Option<&Path>,
        named: &dyn Fn(&str) -> anyhow::Result<PathBuf>,
        progress: &Progress,
    ) -> anyhow::Result<Self> {
        let drawn = Arc::new(cache::pictures(DrawnPictures::new(room_for_pictures(progress))));
        let mut plan = Self { path: path.map(Path::to_owned), manifest, sources: BTreeMap::new() };
        let names: BTreeSet<&String> = plan.manifest.trees.iter().map(|kind| &kind.source).collect();
        for name in names {
            let mut found = source::resolve(&named(name)?, &[], progress)?;
            found.recipe = found.recipe.drawn_into(&drawn);
            crate::cli::notes(&found.notes, progress);
            plan.sources.insert(name.clone(), found);
        }
        plan.check_options()?;
        if plan.len() > MOST {
            let (shown, trees) = (path.map_or_else(String::new, |path| show(path) + ": "), plan.len());
            return Err(usage(format!("{shown}{trees} trees are more than {MOST}; divide the manifest")));
        }
        // A mistake in a knob or an age is found before anything grows.
        let mut first = 0;
        for (number, kind) in plan.manifest.trees.iter().enumerate() {
            if plan.manifest.trees.len() <= 1000 || number == 0 {
                (0..kind.ages.len().max(1)).try_for_each(|age| plan.tree(first + age).map(drop))?;
            }
            first += kind.count();
        }
        Ok(plan)
    }

    /// How many trees there are.
    pub fn len(&self) -> usize {
        self.manifest.len()
    }

    /// The manifest, and the files that its trees are grown from.
    pub fn files(&self) -> Vec<PathBuf> {
        let of_sources = self.sources.values().flat_map(|source| &source.files);
        of_sources.chain(&self.path).cloned().collect()
    }

    /// What the manifest calls its sources, in the order of their names.
    pub fn source_names(&self) -> impl Iterator<Item = &str> {
        self.sources.keys().map(String::as_str)
    }

    /// Whether trees are grown from what the manifest calls so.
    pub fn has_source(&self, name: &str) -> bool {
        self.sources.contains_key(name)
    }

    /// Each option must belong to a format that is written.
    fn check_options(&self) -> anyhow::Result<()> {
        let kinds = self.manifest.trees.iter().flat_map(|kind| &kind.formats);
        let formats: BTreeSet<&str> = self.manifest.formats.iter().chain(kinds).map(String::as_str).collect();
        for format in &formats {
            exporter(format).map_err(usage)?;
        }
        for name in self.manifest.options.keys() {
            let format = name.split_once('.').map_or("", |(format, _)| format);
            if !formats.contains(format) {
                return Err(usage(format!("options: '{name}' is of no format that is written")));
            }
        }
        Ok(())
    }

    /// The tree with a number.
    pub fn tree(&self, number: usize) -> anyhow::Result<Tree> {
        let item = self.manifest.item(number).with_context(|| format!("there is no tree {number}"))?;
        let naming = || format!("tree {number}");
        let source = self.sources.get(item.source).with_context(naming)?;
        let mut recipe = source.recipe.clone();
        for (name, value) in &item.define {
            recipe.preset.define(name, value).map_err(usage).with_context(naming)?;
        }
        if let Some(age) = item.age {
            if let Some((knob, _)) = item.set.iter().find(|(name, _)| OF_AGE.contains(name)) {
                let message = format!("'{knob}' of 'set' and 'ages' both say how old it is: leave one out");
                return Err(usage(message)).with_context(naming);
            }
            recipe.preset = ages::preset_at(&recipe.preset, "ages", age).with_context(naming)?;
        }
        for (name, value) in &item.set {
            recipe.preset.set(name, value).map_err(usage).with_context(naming)?;
        }
        if let Some(seed) = item.seed {
            recipe.preset.set_seed(seed);
        }
        let line = recipe.to_line();
        let outputs = item.formats.iter().map(|id| {
            let exporter = exporter(id).map_err(usage)?;
            let mut options = Options::new(exporter.format());
            for (name, value) in &self.manifest.options {
                if let Some((_, option)) =
                    name.split_once('.').filter(|(format, _)| *format == exporter.format().id)
                {
                    options.set(option, value).map_err(usage)?;
                }
            }
            let path = address(&line, exporter, &options);
            Ok((exporter, options, path))
        });
        let owned = |pairs: &[(&str, String)]| {
            pairs.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
        };
        Ok(Tree {
            index: number,
            source: item.source.to_owned(),
            age: item.age.map(str::to_owned),
            set: owned(&item.set),
            define: owned(&item.define),
            outputs: outputs.collect::<anyhow::Result<_>>()?,
            files: source.files.clone(),
            recipe,
        })
    }
}

/// A format that trees may be written in: an exporter's, or a picture.
fn exporter(id: &str) -> Result<&'static dyn Exporter, ExportError> {
    if id == Thumbnail.format().id { Ok(&Thumbnail) } else { find(id) }
}

/// The name of a file by all that decides it: `ab/cdef….glb`. The recipe says which linden it is.
fn address(recipe: &str, exporter: &dyn Exporter, options: &Options) -> String {
    let format = exporter.format();
    let mut text = format!("{recipe}\n{}", format.id);
    for (name, value) in options.iter() {
        text += &format!("\n{name}={value}");
    }
    let hash = format!("{:032x}", xxh3_128(text.as_bytes()));
    format!("{}/{}.{}", &hash[..2], &hash[2..], format.usual_ending())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_may_be_in_every_format() {
        let mut ids: Vec<&str> =
            linden_exporters::REGISTRY.iter().map(|exporter| exporter.format().id).collect();
        ids.push(Thumbnail.format().id);
        let text = format!("formats = {ids:?}\n[[trees]]\nsource = \"simple\"\n");
        let plan = Plan::typed(Manifest::parse(&text).unwrap(), &Progress::new()).unwrap();
        let outputs = plan.tree(0).unwrap().outputs;
        let paths: BTreeSet<&String> = outputs.iter().map(|(.., path)| path).collect();
        assert_eq!(paths.len(), ids.len(), "{paths:?}");
        let skeleton = outputs.iter().find(|(exporter, ..)| exporter.format().id == "ply-skeleton");
        assert!(
            skeleton.is_some_and(|(.., path)| Path::new(path).extension() == Some("ply".as_ref())),
            "{paths:?}"
        );
    }
}
