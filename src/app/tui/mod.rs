//! The workbench: browse, see, shape, vary and export trees in a terminal.
//!
//! State, update and view are values and functions without a terminal, a clock or a thread:
//! [`Model`](model::Model) is all there is, [`update`](update::update) takes a message and gives
//! [effects](effect::Effect), [`view`](frame::view) paints cells into a buffer. The
//! [runtime](runtime) joins them to the terminal and to the [jobs](crate::jobs).
//!
//! | room | is |
//! |---|---|
//! | [`command`] | the one table of commands |
//! | [`library`] | the list of presets |
//! | [`picture`], [`growth`], [`wind`] | the picture and how it is looked at; growth and wind played |
//! | [`shape`] | the form of knobs, undo, comparison, saving, the grammar's editor |
//! | [`vary`] | seeds, galleries, sweeps |
//! | [`export`] | the dialog |
//! | [`around`] | help, palette, typed lines, messages, leaving |
//! | [`frame`] | where the panes are |

mod around;
mod command;
mod effect;
mod export;
mod frame;
mod growth;
mod library;
mod model;
mod picture;
mod runtime;
mod shape;
#[cfg(test)]
mod testing;
mod tree;
mod update;
mod vary;
mod wind;
mod wrap;

pub use command::key_table;
pub use runtime::{End, Start, run};

#[cfg(test)]
mod hint_tests;
#[cfg(test)]
mod keys_tests;
#[cfg(test)]
mod pace_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
mod small_tests;
#[cfg(test)]
mod view_tests;
