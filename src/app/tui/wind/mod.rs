//! Plays the wind: the sway loop of exports in the picture.
//!
//! The frame on screen follows the clock; how a tree stands at a frame is the painter's business. A frame
//! is asked for only when the picture of the one before has come, so a slow tree shows fewer frames of
//! the same wind, and nothing piles up.

mod commands;

use std::time::Instant;

use linden::preset::Preset;
use linden::wind::Sway;

pub use commands::COMMANDS;

use super::model::{Breeze, Model};
use super::picture;
use crate::jobs::wind_strength;

/// When the next frame is due.
pub fn next_frame(model: &Model) -> Option<Instant> {
    let (_, last) = model.wind.frame.filter(|_| !model.wind.waits)?;
    Some(last + picture::frame_time(model))
}

/// The preset that is on screen.
fn preset(model: &Model) -> Option<&Preset> {
    Some(&model.tree.as_ref()?.shown.as_ref()?.recipe.preset)
}

/// Lets the wind blow, or not.
fn blow_or_stop(model: &mut Model) {
    if model.wind.is_blowing() {
        return model.wind.stop();
    }
    let Some(preset) = preset(model) else { return };
    let (wanted, strength) = (preset.dressing.wind.blow.strength, wind_strength(preset));
    let said = if wanted > 0.0 {
        format!("wind_strength {strength}, {} Hz; w ends it", preset.dressing.wind.blow.frequency_hz)
    } else {
        format!("wind_strength is 0: a breeze of {strength} is shown; w ends it")
    };
    // A tree that grows is not the one that the wind knows.
    model.growth.stop();
    let now = model.now;
    model.wind = Breeze { since: Some(now), frame: Some((0, now)), waits: false };
    model.say(said);
}

/// Time has passed.
pub fn tick(model: &mut Model) {
    if next_frame(model).is_some_and(|due| due <= model.now) {
        advance(model);
    }
}

/// A picture is there: what waited for it goes on.
pub fn seen(model: &mut Model) {
    if model.wind.waits {
        advance(model);
    }
}

/// The frame of now, once the picture of the last one was seen.
fn advance(model: &mut Model) {
    let Some(since) = model.wind.since else { return };
    let Some(preset) = preset(model) else { return model.wind.stop() };
    let sway = Sway::new(&preset.dressing.wind.blow);
    let painted = model.picture.painted.as_ref();
    let is_seen = painted.is_some_and(|painted| painted.request.wind == model.wind.frame());
    model.wind.waits = !is_seen;
    if is_seen {
        let seconds = model.now.saturating_duration_since(since).as_secs_f64();
        let frame = (seconds * f64::from(sway.frames_per_second())) as u64 % u64::from(sway.frames().max(1));
        model.wind.frame = Some((frame as u32, model.now));
    }
}

#[cfg(test)]
mod tests;
