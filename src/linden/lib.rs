//! Trees in three lines: pick or read one, turn knobs, write files.
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("fir.glb");
//! let fir = linden::tree("fir")?.seed(7).set("points", "400")?.grow()?;
//! println!("{:.1} m high", fir.measures().height_m);
//! fir.export(&file)?;
//! # assert!(file.exists());
//! # Ok::<(), linden::Error>(())
//! ```
//!
//! A [`Tree`] is a recipe with its settings, a [`GrownTree`] what grew from it. What these do, the program
//! `linden` does by the same calls: [`GrownTree::export`] writes levels of detail, budgets of triangles, wind
//! and all else that the knobs ask for. Whoever needs the parts has them in the modules:
//!
//! | module | is |
//! |---|---|
//! | [`preset`], [`recipe`], [`generators`] | documents ⇄ settings, and everything to grow the same tree again |
//! | [`grow`](mod@grow), [`dress`](mod@dress) | the steps of the pipeline; each says what it leaves out |
//! | [`forest`], [`forecast`] | many trees; how large a tree will be |
//! | [`export`] | formats, bundles of files, exporters of one's own |
//! | [`raster`] | pictures |
//! | [`scanner`] | a simulated laser scanner |
//! | [`trust`] | which files a document may name |
//! | [`report`], [`manifest`] | every number of a tree; the trees of a batch |
//! | [`lsystem`], [`colonization`], [`scan`], [`qsm`], [`weber_penn`], [`self_organizing`] | the generators |
//! | [`skeleton`], [`surface`], [`foliage`], [`texture`], [`wind`], [`stage`] | what trees are made of |
//!
//! This page's functions open the files that they are given; the modules below open none. Nothing reads a clock
//! or writes to a terminal, and the same recipe gives the same bits on any machine and any number of threads.
//! Lengths are metres, Y is up.

mod error;
mod source;
mod tree;
pub mod trust;

pub use linden_exporters as export;
pub use linden_pipeline::*;
pub use linden_raster as raster;
pub use linden_scanner as scanner;

pub use error::Error;
pub use source::{Reading, grammar, read, read_allowing, tree};
pub use tree::{Exported, GrownTree, InMemory, Tree};

/// For generators of your own: a [knob](knob::Field) of a field, choices by words, keys that name a file.
pub use linden_base::{field, file_key, words};
