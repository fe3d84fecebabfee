//! Exporters: a [`Stage`] becomes the files that 3D programs read.
//!
//! Takes a finished stage, gives bytes; it changes nothing on it, draws no random numbers and
//! reads no clock, so the same stage gives the same bytes on any machine and any number of threads.
//! Files appear whole or not at all: an exporter writes into a [`Bundle`], and nothing is in its
//! place before the bundle is committed.
//!
//! A format is one module with one [`Exporter`], and one line in [`REGISTRY`]; all that is known of it
//! stands in its [`Format`]. A program adds formats with a [`Registry`], and writes them with the tools in
//! [`writing`], of which all of linden's are made.
//!
//! | module | is |
//! |---|---|
//! | [`Format`], [`Options`] | facts about a format, and its settings |
//! | [`Assembly`], [`Member`] | files of plants put together, without their meshes |
//! | [`Batch`], [`Output`] | what is written where, all of it together: levels and seasons in files of their own where a format holds one |
//! | [`Bundle`], [`Sink`] | the files of an export, whole or not at all |
//! | [`Estimate`], [`Amounts`] | bytes and seconds, told before anything is written |
//! | [`Registry`] | formats by id and ending; recipes out of files |
//! | [`writing`] | what formats are written with |
//!
//! ```
//! use linden_pipeline::{Quiet, dress::dress, grow::grow, preset::builtin, recipe::Recipe, stage::Stage};
//! use linden_exporters::{Bundle, Options, for_path};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let recipe = Recipe::new(builtin("fir").unwrap().load()?);
//! let scene = dress(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
//!
//! let folder = tempfile::tempdir()?;
//! let target = folder.path().join("fir.glb");
//! let exporter = for_path(&target)?;
//! let mut bundle = Bundle::create(&target)?;
//! exporter.write(&Stage::of(&scene), &Options::new(exporter.format()), &mut bundle, &Quiet)?;
//! assert!(!target.exists(), "nothing is in its place before the commit");
//! bundle.commit()?;
//! assert!(target.exists());
//! # Ok(())
//! # }
//! ```

// Headers are a few lines, built once; what is long goes through `writing::records`.
#![allow(clippy::format_push_string)]

// Arrays go into the files as they lie in memory, and every format here is little-endian.
#[cfg(target_endian = "big")]
compile_error!("linden-exporters writes arrays as they lie in memory and needs a little-endian target");

mod assembly;
mod batch;
mod bundle;
mod collision;
mod error;
mod estimate;
mod format;
mod gltf;
mod html;
mod markup;
mod mtg;
mod obj;
mod options;
mod organs;
mod plugin;
mod ply;
mod profile;
mod qsm;
mod recipe;
mod registry;
mod stl;
mod system;
mod threemf;
mod traces;
mod usda;
mod usdc;
mod workplace;
pub mod writing;

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::stage::Stage;

pub use assembly::{AgeFile, AgeSet, Assembly, Member, MemberPlace, WindLoop};
pub use batch::{Batch, Output, default_name, plain_stem};
pub use bundle::{
    Bundle, Existing, MadeFolders, MemoryFile, Pictures, Sink, Written, abandon, commit_all, ensure_distinct,
    ensure_spared, examine, make_folders, write_file,
};
pub use error::ExportError;
pub use estimate::{Amounts, Estimate};
pub use format::{Encoding, Format, Holds, LooksIn};
pub use options::{OptionSpec, Options};
pub use plugin::program_on_path;
pub use profile::{PROFILES, Profile};
pub use recipe::Readable;
pub use registry::{REGISTRY, Registry, USUAL, exporters, find, for_path, recipe_in, writers};
pub use traces::Traces;
pub use usda::ages::UsdForm;

/// What wrote a file, as files say it: `linden 0.2.0 (abc1234)`.
pub const GENERATOR: &str = linden_pipeline::recipe::PROGRAM;

/// Writes one file over those of a plant at several ages.
pub type Gatherer = fn(&AgeSet, &mut Bundle, &dyn Monitor) -> Result<(), ExportError>;

/// Writes stages in one format: see [`writing`] for one of a few lines.
pub trait Exporter: Sync {
    /// What the format is called and can do.
    fn format(&self) -> &'static Format;

    /// What writes one file over those of a plant at several ages, in formats that can name other files.
    fn gatherer(&self) -> Option<Gatherer> {
        None
    }

    /// The recipe that a file of this format carries, read from its beginning: as [`Exporter::write`] put
    /// it there, letter by letter. `None` for files of other formats and those without a recipe. Reads
    /// no more of the file than that takes, and never its mesh.
    ///
    /// # Errors
    /// What reading failed with.
    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>>;

    /// What a file of this format, read from its beginning, shows of the options that it was written with; where
    /// a format says nothing of that, the defaults.
    ///
    /// # Errors
    /// What reading failed with.
    fn traces(&self, _file: &mut dyn Readable) -> io::Result<Traces> {
        Ok(Traces::none(self.format()))
    }

    /// Writes `stage` into `bundle`, which the caller then commits.
    ///
    /// `options` are made by [`Options::new`] from this exporter's format.
    ///
    /// # Errors
    /// [`ExportError::Scene`] when a scene breaks a promise of its types (a coordinate that is not
    /// finite, say), [`ExportError::Io`] when the disk refuses, [`ExportError::TooLarge`] when the
    /// format cannot hold so much, [`ExportError::Holds`] when it cannot hold what is on the stage, and
    /// [`ExportError::Cancelled`].
    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError>;
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn formats_are_found_by_id_and_by_ending() {
        for exporter in REGISTRY {
            assert_eq!(find(exporter.format().id).unwrap().format().id, exporter.format().id);
        }
        let by = |path: &str| for_path(Path::new(path)).unwrap().format().id;
        assert_eq!(by("a/fir.ply"), "ply");
        assert_eq!(by("fir.v2.GLB"), "glb");
        assert_eq!(by("fir.gltf"), "gltf");
        assert_eq!(by("fir.obj"), "obj");
        assert_eq!(by("fir.usda"), "usda");
        assert_eq!(by("fir.usd"), "usda");
        assert_eq!((by("fir.csv"), by("fir.Organs.csv"), by("organs.csv")), ("qsm", "organs", "organs"));
    }

    #[test]
    fn ids_are_unique() {
        let mut ids: Vec<_> = REGISTRY.iter().map(|e| e.format().id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), REGISTRY.len());
    }

    #[test]
    fn what_a_format_holds_agrees_with_its_options() {
        for exporter in REGISTRY {
            let Format { id, options, holds, .. } = exporter.format();
            let has = |name| options.iter().any(|spec| spec.knob.name == name);
            assert_eq!((holds.pictures, holds.instances), (has("pictures"), has("instances")), "{id}");
            assert!(!(holds.surface && holds.organs), "{id}");
            assert!(holds.surface || !(holds.colors || holds.wind || holds.setting), "{id}");
            assert!(holds.colors || !holds.pictures, "{id}");
            assert!(holds.pictures || !holds.normals, "{id}");
        }
    }

    #[test]
    fn an_unknown_format_names_the_nearest_and_all() {
        let said = find("gtlf").err().unwrap().to_string();
        assert_eq!(
            said,
            "no export format is called 'gtlf' (did you mean 'gltf'?); there are: obj, ply, ply-skeleton, gltf, glb, usda, usdc, usdz, qsm, mat, mtg, organs, stl, 3mf, html"
        );
        let said = for_path(Path::new("fir.usdd")).err().unwrap().to_string();
        assert!(said.contains("did you mean '.usda'?") && said.contains(".glb"), "{said}");
        let said = for_path(Path::new("fir.FBX")).err().unwrap().to_string();
        assert!(said.contains("Unity") && said.contains("glb") && !said.contains("did you mean"), "{said}");
        let said = find("amf").err().unwrap().to_string();
        assert!(said.contains("slicers read 3mf"), "{said}");
        let said = for_path(Path::new("fir")).err().unwrap().to_string();
        assert!(said.contains("no ending") && !said.contains("did you mean"), "{said}");
    }

    #[test]
    fn text_from_outside_is_shown_printable() {
        let said = find("\u{1b}[2J").err().unwrap().to_string();
        assert!(!said.contains('\u{1b}'), "{said:?}");
    }
}
