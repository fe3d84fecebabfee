//! Seeds, galleries, sweeps.

pub mod view;

use linden_terminal::input::Mouse;

use super::command::Command;
use super::effect::Effects;
use super::model::Model;
use crate::jobs::Thumbnail;

/// A grid of live pictures.
pub struct Gallery {}

/// A picture is there.
pub fn thumbnail(_model: &mut Model, _thumbnail: Thumbnail) {}

/// The mouse on a picture.
pub fn clicked(_model: &mut Model, _cell: usize, _mouse: Mouse, _effects: &mut Effects) {}

/// The rows of this room.
pub const COMMANDS: &[Command] = &[];
