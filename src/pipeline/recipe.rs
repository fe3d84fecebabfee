//! A recipe: a preset, resolved, with the files it needs. Everything to grow the same tree again.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use linden_base::knob::{did_you_mean, nearest, printable};
use linden_plant::foliage::Organs;
use linden_plant::settings::Dressing;
use linden_plant::texture::DrawnPictures;
use linden_plant::{Specimen, Wanted};
use linden_skeleton::Skeleton;
use linden_skeleton::generator::Task;
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::preset::Preset;
use crate::provenance::{TreeHash, document_hash, hash_text};

pub use linden_base::input::{Geometry, Input, Inputs};

/// The version of linden that a recipe names, with the commit that it was built from where that is known:
/// `0.2.0 (abc1234)`. Another one may grow another tree. Changes that were not committed do not show in it.
pub const VERSION: &str = env!("VERSION_AND_COMMIT");

/// What wrote a file, as files say it: `linden 0.2.0 (abc1234)`.
pub const PROGRAM: &str = concat!("linden ", env!("VERSION_AND_COMMIT"));

/// Everything that decides a tree.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// With all overrides applied.
    pub preset: Preset,
    /// Contents of the files that the preset names. Missing and unknown ones are errors when the tree is
    /// to grow ([`Recipe::check_inputs`]).
    pub inputs: Inputs,
    /// What was drawn for it and for those that were made of it.
    drawn: Arc<DrawnPictures>,
    /// What of the tree is dressed.
    wanted: Wanted,
}

/// A recipe whose files are not those that its preset names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InputsError {
    /// A file that the preset names is not there.
    #[error("'{}' needs the file '{}', which was not given", printable(.preset), printable(.file))]
    Missing {
        /// The preset's id.
        preset: String,
        /// As the preset names it.
        file: String,
    },
    /// A file that the preset does not name.
    #[error(
        "'{}' names no file '{}'{}; {}",
        printable(.preset),
        printable(.file),
        did_you_mean(.nearest.as_deref()),
        Named(.known)
    )]
    Unknown {
        /// The preset's id.
        preset: String,
        /// As it was given.
        file: String,
        /// What may have been meant.
        nearest: Option<String>,
        /// The files that the preset names.
        known: Vec<String>,
    },
}

struct Named<'a>(&'a [String]);

impl std::fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() {
            return f.write_str("it needs none");
        }
        let names: Vec<String> = self.0.iter().map(|name| printable(name)).collect();
        write!(f, "it needs: {}", names.join(", "))
    }
}

impl Recipe {
    /// Of a preset that needs no files, or whose files are yet to be put into [`Recipe::inputs`].
    pub fn new(preset: Preset) -> Self {
        Self::with_files(preset, Inputs::new())
    }

    /// Of a preset and the files that it names.
    pub fn with_files(preset: Preset, inputs: Inputs) -> Self {
        Self { preset, inputs, drawn: Arc::default(), wanted: Wanted::ALL }
    }

    /// The same files and another preset, which names them too: this recipe, changed. What was drawn for one of
    /// them serves the other, as it does for a clone.
    #[must_use]
    pub fn with_preset(&self, preset: Preset) -> Self {
        Self { preset, inputs: self.inputs.clone(), drawn: Arc::clone(&self.drawn), wanted: self.wanted }
    }

    /// Draws bark and leaves into `drawn`, and takes them from there: for trees that may look alike.
    #[must_use]
    pub fn drawn_into(self, drawn: &Arc<DrawnPictures>) -> Self {
        Self { drawn: Arc::clone(drawn), ..self }
    }

    /// The same tree, dressed only as far as somebody looks at it: what formats hold, say. The recipe's line and
    /// fingerprint stay what they are.
    #[must_use]
    pub fn wanting(self, wanted: Wanted) -> Self {
        Self { wanted, ..self }
    }

    /// What of the tree is dressed.
    pub(crate) const fn wanted(&self) -> Wanted {
        self.wanted
    }

    /// The content of a file that the preset names.
    pub fn input(&self, file: &str) -> Option<&Input> {
        self.inputs.get(file)
    }

    /// Whether there is each file that the preset names, and no other.
    ///
    /// # Errors
    /// [`InputsError`]: the first that is missing or unknown.
    pub fn check_inputs(&self) -> Result<(), InputsError> {
        let known = self.preset.files();
        let preset = || self.preset.id.clone();
        // What is there under a wrong name says more than what is missing for that.
        if let Some((file, _)) = self.inputs.iter().find(|(file, _)| !known.contains(file)) {
            return Err(InputsError::Unknown {
                preset: preset(),
                nearest: nearest(file, known.iter().copied()).map(str::to_owned),
                file: file.to_owned(),
                known: known.into_iter().map(str::to_owned).collect(),
            });
        }
        match known.into_iter().find(|file| self.inputs.get(file).is_none()) {
            Some(file) => Err(InputsError::Missing { preset: preset(), file: file.to_owned() }),
            None => Ok(()),
        }
    }

    /// Gives a key that names a file ([`Preset::file_keys`]) another one, `file`, which held `input`.
    /// Whether there is such a key.
    pub fn put_file(&mut self, key: &str, file: &str, input: &Input) -> bool {
        if !self.preset.put_file(key, file) {
            return false;
        }
        self.inputs.insert(file, input.clone());
        let known = self.preset.files();
        self.inputs.retain(|name| known.contains(&name));
        true
    }

    /// Gives files other names, in the preset and in what was read: `names` has the new ones by the old.
    pub fn rename_files(&mut self, names: &BTreeMap<String, String>) {
        self.preset.rename_files(names);
        self.inputs.rename(|name| names.get(name).cloned());
    }

    /// The inputs of growth besides the generator's settings.
    pub const fn task(&self) -> Task<'_> {
        Task { seed: self.preset.seed(), inputs: &self.inputs, wood: self.preset.wood }
    }

    /// Does something with what says how this recipe's tree looks; lines of the recipe know of no tree.
    pub fn with_specimen<R>(&self, work: impl FnOnce(&Specimen<'_>) -> R) -> R {
        self.with_lines(&|dressing, _| self.in_dressing(dressing).to_line(), work)
    }

    /// Does something with what is needed to dress this recipe's tree, which grew to `skeleton`.
    pub fn with_specimen_of<R>(&self, skeleton: &Skeleton, dress: impl FnOnce(&Specimen<'_>) -> R) -> R {
        let hash = OnceCell::new();
        let line = |dressing: &Dressing, organs: &Organs| {
            let skeleton = *hash.get_or_init(|| skeleton.hash());
            self.in_dressing(dressing).to_line_of(TreeHash { skeleton, organs: organs.hash() })
        };
        self.with_lines(&line, dress)
    }

    fn with_lines<R>(
        &self,
        recipe: &dyn Fn(&Dressing, &Organs) -> String,
        work: impl FnOnce(&Specimen<'_>) -> R,
    ) -> R {
        let Preset { id, name, dressing, .. } = &self.preset;
        let name = printable(if name.trim().is_empty() { id } else { name });
        let Self { inputs, drawn, wanted, .. } = self;
        work(&Specimen {
            name: &name,
            seed: self.preset.seed(),
            dressing,
            inputs,
            drawn,
            wanted: *wanted,
            recipe,
        })
    }

    fn in_dressing(&self, dressing: &Dressing) -> Cow<'_, Self> {
        if *dressing == self.preset.dressing {
            return Cow::Borrowed(self);
        }
        let mut preset = self.preset.clone();
        preset.dressing = dressing.clone();
        Cow::Owned(self.with_preset(preset))
    }

    /// A 128-bit fingerprint of everything that decides the tree and its looks, files included: XXH3 of the
    /// recipe as JSON without white space, keys sorted, and without the keys that say who wrote it or what it is
    /// called (`linden`, `hash`, `id`, `name`, `group`, `summary`, `source`, `about`). The same whatever build
    /// says it, as long as presets have the same knobs.
    ///
    /// ```
    /// use linden_pipeline::{preset::builtin, recipe::Recipe};
    /// let fir = Recipe::new(builtin("fir")?.load()?);
    /// let mut other = fir.clone();
    /// other.preset.name = "Abies alba".to_owned();
    /// assert_eq!(other.hash(), fir.hash());
    /// other.preset.set_seed(fir.preset.seed() + 1);
    /// assert_ne!(other.hash(), fir.hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn hash(&self) -> u128 {
        // What was written a moment ago is JSON.
        serde_json::to_string(&Content(self)).ok().and_then(|json| document_hash(&json)).unwrap_or_default()
    }

    /// One line of printable ASCII (JSON), with this version and the recipe's hash. It is a preset document
    /// too: [`Preset::from_json`] reads it.
    pub fn to_line(&self) -> String {
        ascii_line(self)
    }

    /// The same with the hashes of the tree that it grew, as every exported file carries it.
    pub fn to_line_of(&self, tree: TreeHash) -> String {
        ascii_line(&Document { recipe: self, tree: Some(tree) })
    }
}

/// JSON as one line of printable ASCII, which `serde_json` has no option for.
pub(crate) fn ascii_line(value: &impl Serialize) -> String {
    // Neither maps with other keys than text nor failing writers: there is nothing to fail.
    let json = serde_json::to_string(value).unwrap_or_default();
    let mut line = String::with_capacity(json.len());
    for c in json.chars() {
        if (' '..='~').contains(&c) {
            line.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                line.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    line
}

impl Serialize for Recipe {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Document { recipe: self, tree: None }.serialize(serializer)
    }
}

/// A recipe with what it says of the program and of the tree.
struct Document<'a> {
    recipe: &'a Recipe,
    tree: Option<TreeHash>,
}

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("linden", VERSION)?;
        map.serialize_entry("hash", &Hashes { recipe: self.recipe.hash(), tree: self.tree })?;
        self.recipe.serialize_into(&mut map)?;
        map.end()
    }
}

/// As documents have them.
pub(crate) struct Hashes {
    pub recipe: u128,
    pub tree: Option<TreeHash>,
}

impl Serialize for Hashes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("recipe", &hash_text(self.recipe))?;
        if let Some(TreeHash { skeleton, organs }) = self.tree {
            map.serialize_entry("skeleton", &hash_text(skeleton))?;
            map.serialize_entry("organs", &hash_text(organs))?;
        }
        map.end()
    }
}

/// A recipe alone.
struct Content<'a>(&'a Recipe);

impl Serialize for Content<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.0.serialize_into(&mut map)?;
        map.end()
    }
}

impl Recipe {
    fn serialize_into<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        self.preset.serialize_into(map)?;
        let files = self.preset.files().into_iter();
        let files: Vec<_> = files.filter_map(|file| Some(NamedInput(file, self.input(file)?))).collect();
        if files.is_empty() { Ok(()) } else { map.serialize_entry("inputs", &files) }
    }
}

/// As recipes carry it.
struct NamedInput<'a>(&'a str, &'a Input);

impl Serialize for NamedInput<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let Self(name, input) = self;
        map.serialize_entry("file", name)?;
        map.serialize_entry("kind", input.kind())?;
        map.serialize_entry("xxh3", &input.hash_text())?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;

    /// A leaf of one triangle, and a fruit of two.
    const LEAF: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const FRUIT: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";

    fn preset() -> Preset {
        let text = "id = \"apple\"\n[lsystem]\naxiom = \"F~L\"\nrules = []\n[foliage]\nleaf_form = \"mesh\"\n\
                    leaf_mesh = \"leaf.obj\"\n[[foliage.also]]\nleaf_form = \"mesh\"\nleaf_mesh = \"fruit.obj\"\n";
        Preset::from_toml(text).unwrap()
    }

    fn read(bytes: &[u8]) -> Input {
        Input::read("a.obj", bytes, &Quiet).unwrap()
    }

    fn triangles(recipe: &Recipe, file: &str) -> Option<usize> {
        match &recipe.input(file)?.geometry {
            Geometry::Mesh(mesh) => Some(mesh.triangles.len()),
            _ => None,
        }
    }

    #[test]
    fn a_file_is_found_by_its_name_alone() {
        let mut recipe = Recipe::new(preset());
        assert_eq!(recipe.preset.files(), ["leaf.obj", "fruit.obj"]);
        recipe.inputs.insert("fruit.obj", read(FRUIT));
        assert_eq!((triangles(&recipe, "leaf.obj"), triangles(&recipe, "fruit.obj")), (None, Some(2)));
        let missing = InputsError::Missing { preset: "apple".to_owned(), file: "leaf.obj".to_owned() };
        assert_eq!(recipe.check_inputs(), Err(missing));
        let said = crate::grow::grow(&recipe, &Quiet).unwrap_err().to_string();
        assert_eq!(said, "'apple' needs the file 'leaf.obj', which was not given");
        recipe.inputs.insert("leaf.obj", read(LEAF));
        assert_eq!(recipe.check_inputs(), Ok(()));
        assert_eq!(triangles(&recipe, "leaf.obj"), Some(1));
    }

    #[test]
    fn a_file_that_the_preset_does_not_name_is_an_error() {
        let mut recipe = Recipe::new(preset());
        recipe.inputs = [("leaf.obj", read(LEAF)), ("friut.obj", read(FRUIT))].into_iter().collect();
        assert_eq!(
            recipe.check_inputs().unwrap_err().to_string(),
            "'apple' names no file 'friut.obj' (did you mean 'fruit.obj'?); it needs: leaf.obj, fruit.obj"
        );
    }

    #[test]
    fn renaming_keeps_what_was_read_with_its_name() {
        let inputs = [("fruit.obj", read(FRUIT)), ("leaf.obj", read(LEAF))].into_iter().collect();
        let mut recipe = Recipe::with_files(preset(), inputs);
        // Each gets the other's name.
        let names = [("leaf.obj", "fruit.obj"), ("fruit.obj", "leaf.obj")];
        recipe.rename_files(&names.map(|(from, to)| (from.to_owned(), to.to_owned())).into());
        assert_eq!(recipe.preset.files(), ["fruit.obj", "leaf.obj"]);
        assert_eq!((triangles(&recipe, "fruit.obj"), triangles(&recipe, "leaf.obj")), (Some(1), Some(2)));
        assert_eq!(recipe.check_inputs(), Ok(()));
    }

    #[test]
    fn a_file_put_in_anothers_place_takes_that_out() {
        let inputs = [("fruit.obj", read(FRUIT)), ("leaf.obj", read(LEAF))].into_iter().collect();
        let mut recipe = Recipe::with_files(preset(), inputs);
        assert!(recipe.put_file("leaf_mesh", "fruit.obj", &read(FRUIT)));
        assert_eq!(recipe.inputs.iter().map(|(name, _)| name).collect::<Vec<_>>(), ["fruit.obj"]);
        assert_eq!(recipe.check_inputs(), Ok(()));
        let line = recipe.to_line();
        assert_eq!(line.matches("\"file\":\"fruit.obj\"").count(), 1, "{line}");
    }
}
