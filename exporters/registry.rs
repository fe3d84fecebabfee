//! Formats by id and by a file's ending: linden's, those that a program adds, and plug-ins where it asks for them.

use std::io;
use std::path::Path;

use linden_pipeline::knob::nearest;

use crate::{
    ExportError, Exporter, Format, Readable, gltf, html, mtg, obj, organs, plugin, ply, qsm, recipe, stl,
    threemf, traces, usda,
};

/// Linden's formats. Where two claim an ending, the first has it.
#[rustfmt::skip] // a line for each
pub static REGISTRY: &[&dyn Exporter] = &[
    &obj::Obj,
    &ply::Ply,
    &ply::PlySkeleton,
    &gltf::Gltf,
    &gltf::Glb,
    &usda::Usda,
    &usda::Usdc,
    &usda::Usdz,
    &qsm::Qsm,
    &qsm::Mat,
    &mtg::Mtg,
    &organs::Organs,
    &stl::Stl,
    &threemf::ThreeMf,
    &html::Html,
];

/// What is written where nothing says which format: one file that most programs take.
pub static USUAL: &dyn Exporter = &gltf::Glb;

/// Formats to choose from: linden's, those that a program adds, and at last those of plug-ins, where
/// [`Registry::with_plugins`] allows to run them.
///
/// ```
/// # use std::io;
/// # use linden_pipeline::{Monitor, stage::Stage};
/// # use linden_exporters::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Options, Readable};
/// # struct Tips;
/// # static FORMAT: Format = Format {
/// #     id: "tips", name: "", extensions: &["tips"], media_type: "text/plain", self_contained: true, help: "",
/// #     options: &[], holds: Holds::SKELETON, levels_by: None, encoding: |_| Encoding::Text, estimate: None,
/// # };
/// # impl Exporter for Tips {
/// #     fn format(&self) -> &'static Format { &FORMAT }
/// #     fn recipe(&self, _: &mut dyn Readable) -> io::Result<Option<String>> { Ok(None) }
/// #     fn write(&self, _: &Stage<'_>, _: &Options, bundle: &mut Bundle, monitor: &dyn Monitor) -> Result<(), ExportError> {
/// #         bundle.write_main(None, monitor, |_| Ok(()))
/// #     }
/// # }
/// use std::path::Path;
///
/// use linden_exporters::Registry;
///
/// // `Tips` is an exporter of this program.
/// let registry = Registry::new().with(&Tips);
/// assert_eq!(registry.for_path(Path::new("oak.tips"))?.format().id, "tips");
/// assert_eq!(registry.find("glb")?.format().extensions, ["glb"]);
/// # Ok::<(), linden_exporters::ExportError>(())
/// ```
#[derive(Clone)]
pub struct Registry {
    exporters: Vec<&'static dyn Exporter>,
    runs_plugins: bool,
}

impl Default for Registry {
    fn default() -> Self {
        Self::new()
    }
}

impl Registry {
    /// Linden's formats. No other program is looked for or run.
    pub fn new() -> Self {
        Self { exporters: REGISTRY.to_vec(), runs_plugins: false }
    }

    /// The same with plug-ins, as the program `linden` has them: a format `foo` that is none of the others is the program
    /// `linden-export-foo` on the search path, which runs with all rights of this process when a tree is written in it.
    #[must_use]
    pub fn with_plugins(self) -> Self {
        Self { runs_plugins: true, ..self }
    }

    /// The same with one more format. Ids and endings that are taken stay with those that have them.
    #[must_use]
    pub fn with(mut self, exporter: &'static dyn Exporter) -> Self {
        self.exporters.push(exporter);
        self
    }

    /// All formats, those of plug-ins last. Plug-ins are looked for once for each search path: what is put there or taken away
    /// later is not seen by this program.
    pub fn exporters(&self) -> Vec<&'static dyn Exporter> {
        let is_known = |id: &str| self.exporters.iter().any(|exporter| exporter.format().id == id);
        let plugins = if self.runs_plugins { plugin::all() } else { Vec::new() };
        let plugins = plugins.into_iter().filter(|exporter| !is_known(exporter.format().id));
        self.exporters.iter().copied().chain(plugins).collect()
    }

    fn plugin(&self, id: &str) -> Option<&'static dyn Exporter> {
        if self.runs_plugins { plugin::find(id) } else { None }
    }

    /// The exporter that scripts call `id`.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`] with the nearest name and the list.
    pub fn find(&self, id: &str) -> Result<&'static dyn Exporter, ExportError> {
        let ids = || self.exporters.iter().map(|exporter| exporter.format().id);
        let found = self.exporters.iter().copied().find(|exporter| exporter.format().id == id);
        found.or_else(|| self.plugin(id)).ok_or_else(|| ExportError::UnknownFormat {
            typed: id.to_owned(),
            nearest: nearest(&id.to_lowercase(), ids()),
            known: ids().collect(),
        })
    }

    /// The exporter for a file's ending, in any case: that of the longest, `organs.csv` before `csv`.
    ///
    /// # Errors
    /// [`ExportError::UnknownExtension`] with the nearest ending and the list.
    pub fn for_path(&self, path: &Path) -> Result<&'static dyn Exporter, ExportError> {
        let typed = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        let endings = || self.exporters.iter().flat_map(|exporter| exporter.format().extensions).copied();
        let claims = |exporter: &&dyn Exporter| exporter.format().ending_of(path).map(str::len);
        // The last of several is taken; where two claim an ending, the first has it.
        let claimed = self.exporters.iter().rev().filter(|exporter| claims(exporter).is_some());
        claimed.max_by_key(|exporter| claims(exporter)).copied().or_else(|| self.plugin(&typed)).ok_or_else(
            || {
                let mut known: Vec<_> = endings().collect();
                known.dedup();
                ExportError::UnknownExtension {
                    path: path.to_owned(),
                    nearest: nearest(&typed, endings()).filter(|_| !typed.is_empty()),
                    known,
                }
            },
        )
    }

    /// The format whose ending a file's name has, where a file of `format` is to be called so: whoever opens it by its
    /// ending reads it wrongly. `None` for an ending of `format`'s, and for one of none.
    pub fn misnamed(&self, format: &Format, path: &Path) -> Option<&'static Format> {
        if format.ending_of(path).is_some() || path.extension().is_none() {
            return None;
        }
        let other = self.for_path(path).ok()?.format();
        // A flavour without endings has those of what it is one of: `ply-skeleton` is a .ply.
        let is_flavour = format.extensions.is_empty()
            && format.id.split_once('-').is_some_and(|(of, _)| other.extensions.contains(&of));
        (!is_flavour).then_some(other)
    }

    /// The recipe that a file carries, letter by letter, whichever of these formats it is in, previews included;
    /// `None` where it carries none. It is one line of JSON: a tree's
    /// ([`Preset::from_json`](linden_pipeline::preset::Preset::from_json)) or a forest's
    /// ([`ForestDocument::parse`](linden_pipeline::forest::ForestDocument::parse)).
    ///
    /// # Errors
    /// What reading failed with; a file of another format is no error.
    pub fn recipe_in(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_any(&self.exporters, file)
    }

    /// The exporters that may have written a file, those of its name's ending first: several formats carry
    /// recipes in the same way. None for a file without a recipe.
    ///
    /// # Errors
    /// What reading failed with.
    pub fn writers(&self, path: &Path, file: &mut dyn Readable) -> io::Result<Vec<&'static dyn Exporter>> {
        traces::writers(&self.exporters, path, file)
    }
}

/// All formats of [`Registry::new`].
pub fn exporters() -> Vec<&'static dyn Exporter> {
    Registry::new().exporters()
}

/// The exporters of [`Registry::new`] that may have written a file.
///
/// # Errors
/// As [`Registry::writers`].
pub fn writers(path: &Path, file: &mut dyn Readable) -> io::Result<Vec<&'static dyn Exporter>> {
    Registry::new().writers(path, file)
}

/// The exporter of [`Registry::new`] that scripts call `id`.
///
/// # Errors
/// As [`Registry::find`].
pub fn find(id: &str) -> Result<&'static dyn Exporter, ExportError> {
    Registry::new().find(id)
}

/// The exporter of [`Registry::new`] for a file's ending, in any case.
///
/// # Errors
/// As [`Registry::for_path`].
pub fn for_path(path: &Path) -> Result<&'static dyn Exporter, ExportError> {
    Registry::new().for_path(path)
}

/// The recipe that a file in one of the formats of [`Registry::new`] carries: see [`Registry::recipe_in`].
///
/// ```
/// use std::io::Cursor;
/// let file = b"# linden 0.1.0\n# name: fir\n# recipe: {\"id\":\"fir\"}\nv 0 0 0\n";
/// let recipe = linden_exporters::recipe_in(&mut Cursor::new(file))?;
/// assert_eq!(recipe.as_deref(), Some("{\"id\":\"fir\"}"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// As [`Registry::recipe_in`].
pub fn recipe_in(file: &mut dyn Readable) -> io::Result<Option<String>> {
    recipe::in_any(REGISTRY, file)
}
