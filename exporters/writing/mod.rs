//! What formats are written with: the tools of linden's formats, for those of others.
//!
//! Takes a stage and gives what a file wants: meshes and materials each once ([`distinct`]), checked
//! ([`validate`]), pictures as files ([`pictures`]), and millions of records in parallel ([`records`]).
//! Memory is asked for before it is taken ([`memory`]), and what a format cannot hold is noted ([`fit`]).
//! Nothing here opens a file: a [`Bundle`](crate::Bundle) does.
//!
//! | step of an exporter | with |
//! |---|---|
//! | leave out what the format cannot hold, and say so | [`fit`] |
//! | check and list meshes and materials | [`distinct::DistinctMeshes`], or [`validate::single_tree`] for a skeleton |
//! | list and compress pictures | [`pictures`] |
//! | ask for the memory | [`memory::admit`] |
//! | number the trees of a forest | [`trees`] |
//! | begin a text with its recipe | [`comments`] |
//! | write | [`Bundle::write_main`](crate::Bundle::write_main), [`records::write`] |
//!
//! A format of a few lines, the tips of a tree as `x y z`:
//!
//! ```
//! use std::io;
//!
//! use linden_pipeline::{Monitor, Quiet, dress::dress, grow::grow, preset::builtin, recipe::Recipe, stage::Stage};
//! use linden_exporters::writing::{comments, fit, memory, recipe_in_comments, records, validate};
//! use linden_exporters::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Options, Readable};
//!
//! struct Tips;
//!
//! static FORMAT: Format = Format {
//!     id: "tips",
//!     name: "Points (tips)",
//!     extensions: &["tips"],
//!     media_type: "text/plain",
//!     self_contained: true,
//!     help: "the nodes of a tree, one a line",
//!     options: &[],
//!     holds: Holds::SKELETON,
//!     levels_by: None,
//!     encoding: |_| Encoding::Text,
//!     estimate: Some(|amounts, _| amounts.recipe_bytes + 30 * amounts.nodes),
//! };
//!
//! impl Exporter for Tips {
//!     fn format(&self) -> &'static Format {
//!         &FORMAT
//!     }
//!
//!     fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
//!         recipe_in_comments(file)
//!     }
//!
//!     fn write(
//!         &self,
//!         stage: &Stage<'_>,
//!         _: &Options,
//!         bundle: &mut Bundle,
//!         monitor: &dyn Monitor,
//!     ) -> Result<(), ExportError> {
//!         let stage = fit(stage, &FORMAT, bundle);
//!         let scene = validate::single_tree(&stage, FORMAT.id, monitor)?;
//!         let nodes = &scene.skeleton.positions;
//!         memory::admit(&stage, &[], records::bytes(nodes.len()), monitor)?;
//!         bundle.write_main(None, monitor, |out| {
//!             out.write(comments(&scene.name, &scene.recipe, "metres").as_bytes())?;
//!             records::write(out, nodes.len(), |text, range| {
//!                 for node in &nodes[range] {
//!                     text.floats(node.to_array(), b" ");
//!                     text.byte(b'\n');
//!                 }
//!             })
//!         })
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let recipe = Recipe::new(builtin("older-f").unwrap().load()?);
//! let scene = dress(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
//! let folder = tempfile::tempdir()?;
//! let mut bundle = Bundle::create(&folder.path().join("fern.tips"))?;
//! Tips.write(&Stage::of(&scene), &Options::new(&FORMAT), &mut bundle, &Quiet)?;
//! let written = bundle.commit()?;
//! let text = std::fs::read_to_string(&written[0].path)?;
//! assert_eq!(text.lines().count(), 4 + scene.skeleton.positions.len());
//! # Ok(())
//! # }
//! ```

mod asked;
mod decimal;
pub mod distinct;
pub(crate) mod exr;
mod fit;
pub mod instances;
pub(crate) mod lightmap;
pub mod memory;
mod names;
pub mod pictures;
pub(crate) mod recent;
pub mod records;
pub mod trees;
pub mod validate;

pub(crate) use self::asked::{ONE_LEVEL, has_bones, note_asked};
pub use self::fit::fit;
pub(crate) use self::fit::turned_colors;
pub use self::names::{identifier, one_word};
pub use crate::estimate::mean_digits;
pub use crate::recipe::{comments, in_comments as recipe_in_comments};
