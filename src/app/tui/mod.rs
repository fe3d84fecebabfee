//! The workbench: browse, see, shape, vary and export trees in a terminal.
//!
//! State, update and view are values and functions without a terminal, a clock or a thread:
//! [`Model`](model::Model) is all there is, [`update`](update::update) takes a message and gives
//! [effects](effect::Effect), [`view`](screen::view) paints cells into a buffer. The
//! [runtime](runtime) joins them to the terminal and to the [jobs](crate::jobs).
//!
//! The floors, from the ground up; a file uses those of its floor's folder and below, never above:
//!
//! | floor | is |
//! |---|---|
//! | [`effect`], [`tree`], [`wrap`] | what is asked of the world; the tree on screen; text in cells |
//! | [`command`], [`layout`], [`dialog`] | what a command and a dialog are; where the panes are |
//! | [`model`] | the state |
//! | [`chrome`] | what frames the panes: footer, palette, pages, typed lines |
//! | [`library`], [`picture`], [`growth`], [`wind`], [`shape`], [`crown`], [`wood`], [`vary`], [`export`] | the rooms: a pane or a dialog with its commands each |
//! | [`commands`] | the one table of commands |
//! | [`screen`], [`update`] | all of it painted; all that can happen |
//! | [`runtime`] | the loop |

mod chrome;
mod command;
mod commands;
mod crown;
mod derivation;
mod dialog;
mod effect;
mod export;
mod forest;
mod growth;
mod layout;
mod library;
mod merge;
mod model;
mod picture;
mod ranking;
mod runtime;
mod screen;
mod shape;
mod statistics;
#[cfg(test)]
mod testing;
mod tree;
mod update;
mod vary;
mod wind;
mod wood;

pub use commands::key_table;
pub use runtime::{End, StartOptions, run};

#[cfg(test)]
mod dialog_tests;
#[cfg(test)]
mod hint_tests;
#[cfg(test)]
mod keys_tests;
#[cfg(test)]
mod message_tests;
#[cfg(test)]
mod pace_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
mod small_tests;
#[cfg(test)]
mod view_tests;
