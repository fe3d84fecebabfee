//! Plays growth: derivation by derivation, year by year, iteration by iteration.
//!
//! The step on screen is a number; what a tree looked like then is the painter's business. A step is
//! shown only when the picture of the one before has come, so a slow tree plays slower, not ragged.

pub mod bar;
mod commands;

use std::time::Duration;

pub use commands::COMMANDS;
use linden::knob::Value;
use linden::preset::Preset;
use linden::skeleton::generator::Steps;

use super::model::Model;
use super::picture;
use crate::jobs::ShownTree;

/// A whole growth by iterations takes about so long.
const WHOLE: Duration = Duration::from_secs(8);
/// A derivation or a year is looked at for so long at most.
const LONGEST: Duration = Duration::from_millis(900);

/// The tree whose growth is played.
fn shown(model: &Model) -> Option<&ShownTree> {
    model.tree.as_ref()?.shown.as_deref()
}

/// What is on screen while growth is played or paused, `year 3 of 24`, with the setting that makes a tree of it where
/// there is one; `None` for the grown tree.
pub fn younger(model: &Model) -> Option<(String, Option<String>)> {
    let (step, tree) = (model.growth.step()?, shown(model)?);
    let unit = regrown(tree).map_or("iteration", |steps| steps.unit);
    let preset = &tree.recipe.preset;
    let made_by = match preset.generator.at_step(step) {
        Some(generator) => {
            let mut young: Preset = preset.clone();
            young.generator = generator;
            // Where no tree is of fewer years than one, no setting makes the one of none.
            let is_older = step == 0 && preset.generator.at_step(1).is_some_and(|one| one == young.generator);
            young.knobs().into_iter().find(|(knob, _)| !is_older && preset.differs(knob, &young))
        }
        // An age is a share of the iterations.
        None => preset.knobs().into_iter().find(|(knob, _)| knob.knob.name == "age").map(|(knob, age)| {
            let share = f64::from(step) / f64::from(last_step(tree).max(1));
            (knob, if let Value::Real(age) = age { Value::Real(age * share) } else { age })
        }),
    };
    let made_by = made_by.map(|(knob, value)| format!("{}={}", knob.knob.name, shortened(&value)));
    Some((format!("{unit} {step} of {}", last_step(tree)), made_by))
}

/// A value in few digits: not above it, so that a share of steps is of no later one.
fn shortened(value: &Value) -> String {
    match value {
        Value::Real(x) => ((x * 1e4 + 1e-6).floor() / 1e4).to_string(),
        other => other.to_string(),
    }
}

/// That files have the grown tree, while a younger one is on screen.
pub fn warning(model: &Model) -> Option<String> {
    let (on_screen, made_by) = younger(model)?;
    Some(match made_by {
        Some(made_by) => format!("of the grown tree, not {on_screen}: {made_by} makes that one"),
        None => format!("of the grown tree, not {on_screen}"),
    })
}

/// The steps to which the tree is grown again; without, steps are iterations.
fn regrown(shown: &ShownTree) -> Option<Steps> {
    shown.recipe.preset.generator.steps()
}

/// The last step: the grown tree.
pub fn last_step(shown: &ShownTree) -> u32 {
    regrown(shown).map_or(shown.steps, |steps| steps.count)
}

/// Steps at once, and the pause after them.
fn tempo(model: &Model, shown: &ShownTree) -> (u32, Duration) {
    let frame = picture::frame_time(model);
    if let Some(steps) = regrown(shown) {
        return (1, (WHOLE / steps.count.max(1)).clamp(frame, LONGEST));
    }
    let frames = (WHOLE.as_millis() / frame.as_millis()).max(1) as u32;
    (last_step(shown).div_ceil(frames).max(1), frame)
}

/// Goes to a step; the last one is the grown tree.
pub fn go_to(model: &mut Model, step: u32) {
    let Some(last) = shown(model).map(last_step) else { return };
    model.growth.step = (step < last).then_some(step);
    if model.growth.step.is_some() {
        model.wind.stop();
    }
    if model.growth.step.is_none() {
        model.growth.pause();
    }
}

/// Plays from here, from the start when the tree is grown; or pauses.
fn play_or_pause(model: &mut Model) {
    if model.growth.is_playing() {
        return model.growth.pause();
    }
    let Some(tree) = shown(model) else { return };
    let (_, pause) = tempo(model, tree);
    let now = model.now;
    model.wind.stop();
    model.growth.step = Some(model.growth.step.unwrap_or(0));
    model.growth.playing = Some(now);
    model.growth.pause = pause;
}

/// Some steps on or back; pauses.
fn step_by(model: &mut Model, by: i64) {
    let Some(tree) = shown(model) else { return };
    let last = last_step(tree);
    // One key is one derivation or year, or a hundredth of many iterations.
    let stride = if regrown(tree).is_some() { 1 } else { i64::from(last.div_ceil(100).max(1)) };
    let at = i64::from(model.growth.step.unwrap_or(last));
    model.growth.pause();
    go_to(model, (at + by * stride).clamp(0, i64::from(last)) as u32);
}

/// Time has passed.
pub fn tick(model: &mut Model) {
    if model.growth.next_frame().is_some_and(|due| due <= model.now) {
        advance(model);
    }
}

/// A picture is there: what waited for it goes on.
pub fn seen(model: &mut Model) {
    if model.growth.waits {
        advance(model);
    }
}

/// The next step, once the picture of this one was seen.
fn advance(model: &mut Model) {
    let Some(tree) = shown(model) else { return model.growth.stop() };
    let painted = model.picture.painted.as_ref();
    let is_seen = painted.is_some_and(|painted| painted.request.stage == model.growth.step);
    let (steps, pause) = tempo(model, tree);
    model.growth.waits = !is_seen;
    if is_seen {
        let next = model.growth.step.unwrap_or(0).saturating_add(steps);
        model.growth.playing = Some(model.now);
        model.growth.pause = pause;
        go_to(model, next);
    }
}

#[cfg(test)]
mod tests;
