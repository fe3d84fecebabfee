//! The commands of the picture.

use glam::Vec2;
use linden_raster::Camera;

use super::{levels, turn_by, zoom_by};
use crate::config::settings::Scenery;
use crate::jobs::{Medium, PictureLook};
use crate::tui::command::Context;
use crate::tui::effect::Effects;
use crate::tui::model::{Command, Model, free, without_picture, without_tree};

/// Degrees a key.
const TURN_DEG: f32 = 6.0;
/// Share of the picture's half a key.
const PAN: f32 = 0.08;
/// Breast height, metres.
const BREAST_M: f32 = 1.3;
/// Metres that a key moves a slice.
const SLICE_STEP_M: f32 = 0.1;
/// Closer by a key.
const ZOOM: f32 = 1.2;

pub fn orbit(model: &mut Model, yaw: f32, pitch: f32) {
    let camera = &mut model.picture.camera;
    turn_by(camera, yaw);
    camera.pitch_deg = (camera.pitch_deg + pitch).clamp(-90.0, 90.0);
}

fn pan(model: &mut Model, right: f32, up: f32) {
    // The tree moves against the camera.
    model.picture.camera.pan -= Vec2::new(right, up) * PAN;
}

fn look_from(model: &mut Model, from: Camera) {
    model.picture.turn(None);
    let camera = &mut model.picture.camera;
    (camera.yaw_deg, camera.pitch_deg) = (from.yaw_deg, from.pitch_deg);
}

fn has_no_points(model: &Model) -> Option<String> {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    match shown.map(|shown| shown.grown.colonized.is_some()) {
        Some(true) => None,
        Some(false) => Some(
            "this tree does not grow by space colonization; it has no attraction points and no crown"
                .to_owned(),
        ),
        None => without_tree(model),
    }
}

fn has_no_crown(model: &Model) -> Option<String> {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    has_no_points(model).or_else(|| {
        shown
            .is_some_and(|shown| shown.outline.is_empty())
            .then(|| "given points have no crown around them".to_owned())
    })
}

fn stands_alone(model: &Model) -> Option<String> {
    without_picture(model).or_else(|| {
        let why = "nothing stands in the way here or takes light";
        super::beside(model).is_empty().then(|| why.to_owned())
    })
}

fn has_no_landscape(model: &Model) -> Option<String> {
    let has_one = Medium::of(&model.terminal, Scenery::Lit).landscape;
    (!has_one).then(|| {
        "this terminal shows no landscape; that takes pixels, or 24-bit colours and no network between"
            .to_owned()
    })
}

fn has_one_level(model: &Model) -> Option<String> {
    without_tree(model).or_else(|| {
        let why = "this tree has one level of detail; lods, lod_triangles and billboard make more";
        (levels(model) <= 1).then(|| why.to_owned())
    })
}

/// Goes on to the next level of detail, in the look that has such.
fn next_level(model: &mut Model) {
    let next = model.picture.level.map_or(0, |level| level + 1);
    model.picture.level = Some(next).filter(|next| *next < levels(model));
    if model.picture.level.is_some() {
        (model.picture.look, model.picture.is_look_chosen) = (PictureLook::Surface, true);
        model.picture.slice_m = None;
        model.growth.stop();
        model.wind.stop();
    } else {
        model.say("all that grew is shown again");
    }
}

fn cycle_look(model: &mut Model, by: usize) {
    model.picture.is_look_chosen = true;
    let all = PictureLook::ALL;
    let at = all.iter().position(|look| *look == model.picture.look).unwrap_or(0);
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    let mut others = (1..=all.len()).map(|step| all[(at + step * by) % all.len()]);
    // Some are for scans alone.
    let next = others.find(|look| shown.is_none_or(|shown| look.hindrance(shown).is_none()));
    model.picture.look = next.unwrap_or(model.picture.look);
    let name = model.picture.look.name();
    model.say(format!("drawn: {name}"));
}

fn is_whole(model: &Model) -> Option<String> {
    without_tree(model)
        .or_else(|| model.picture.slice_m.is_none().then(|| "the tree is whole; Z cuts it".to_owned()))
}

/// Cuts the tree at breast height, or a low one in its middle; or shows all of it again.
fn toggle_slice(model: &mut Model) {
    let Some(shown) = model.tree.as_ref().and_then(|tree| tree.shown.as_ref()) else { return };
    let height_m = shown.measures.height_m as f32;
    let first_m = if height_m > BREAST_M { BREAST_M } else { height_m / 2.0 };
    let picture = &mut model.picture;
    picture.slice_m = if picture.slice_m.is_some() { None } else { Some(first_m) };
    (picture.camera.zoom, picture.camera.pan, picture.level) = (1.0, Vec2::ZERO, None);
    if picture.slice_m.is_none() {
        model.say("the whole tree again");
    }
}

fn move_slice(model: &mut Model, by_m: f32) {
    let Some(shown) = model.tree.as_ref().and_then(|tree| tree.shown.as_ref()) else { return };
    let height_m = shown.measures.height_m as f32;
    if let Some(slice_m) = &mut model.picture.slice_m {
        // In steps of a centimetre, so that 1.3 m is found again.
        *slice_m = (((*slice_m + by_m) * 100.0).round() / 100.0).clamp(0.0, height_m);
    }
}

/// Rows that turn the tree and come closer, for dialogs that leave the picture in sight: left, right, up, down,
/// closer, farther.
pub const fn camera_rows(context: Context, ids: [&'static str; 6]) -> [Command; 6] {
    const fn row(
        context: Context,
        id: &'static str,
        keys: &'static [&'static str],
        [title, help]: [&'static str; 2],
        run: fn(&mut Model, &mut Effects),
    ) -> Command {
        Command { id, context, keys, title, help, hint: None, hindrance: free, run }
    }
    let [left, right, up, down, closer, farther] = ids;
    [
        row(context, left, &["shift-left", "H"], ["Orbit left", "Turns the tree"], |m, _| {
            orbit(m, TURN_DEG, 0.0);
        }),
        row(
            context,
            right,
            &["shift-right", "L"],
            ["Orbit right", "Turns the tree the other way"],
            |m, _| {
                orbit(m, -TURN_DEG, 0.0);
            },
        ),
        row(context, up, &["shift-up", "K"], ["From above", "Looks from farther above"], |m, _| {
            orbit(m, 0.0, TURN_DEG);
        }),
        row(context, down, &["shift-down", "J"], ["From below", "Looks from farther below"], |m, _| {
            orbit(m, 0.0, -TURN_DEG);
        }),
        row(context, closer, &["+", "="], ["Closer", "Comes closer"], |m, _| zoom_by(m, ZOOM)),
        row(context, farther, &["-"], ["Farther", "Goes farther away"], |m, _| zoom_by(m, 1.0 / ZOOM)),
    ]
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "orbit-left",
        context: Context::PICTURE,
        keys: &["left", "h"],
        title: "Orbit left",
        help: "Goes round the tree to the left",
        hint: None,
        hindrance: free,
        run: |model, _| orbit(model, -TURN_DEG, 0.0),
    },
    Command {
        id: "orbit-right",
        context: Context::PICTURE,
        keys: &["right", "l"],
        title: "Orbit",
        help: "Goes round the tree to the right",
        hint: Some(10),
        hindrance: free,
        run: |model, _| orbit(model, TURN_DEG, 0.0),
    },
    Command {
        id: "orbit-up",
        context: Context::PICTURE,
        keys: &["up", "k"],
        title: "Orbit up",
        help: "Looks more from above",
        hint: None,
        hindrance: free,
        run: |model, _| orbit(model, 0.0, TURN_DEG),
    },
    Command {
        id: "orbit-down",
        context: Context::PICTURE,
        keys: &["down", "j"],
        title: "Orbit down",
        help: "Looks more from below",
        hint: None,
        hindrance: free,
        run: |model, _| orbit(model, 0.0, -TURN_DEG),
    },
    Command {
        id: "pan-left",
        context: Context::PICTURE,
        keys: &["shift-left", "H"],
        title: "Pan left",
        help: "Moves the view to the left",
        hint: None,
        hindrance: free,
        run: |model, _| pan(model, -1.0, 0.0),
    },
    Command {
        id: "pan-right",
        context: Context::PICTURE,
        keys: &["shift-right", "L"],
        title: "Pan right",
        help: "Moves the view to the right",
        hint: None,
        hindrance: free,
        run: |model, _| pan(model, 1.0, 0.0),
    },
    Command {
        id: "pan-up",
        context: Context::PICTURE,
        keys: &["shift-up", "K"],
        title: "Pan up",
        help: "Moves the view up",
        hint: None,
        hindrance: free,
        run: |model, _| pan(model, 0.0, 1.0),
    },
    Command {
        id: "pan-down",
        context: Context::PICTURE,
        keys: &["shift-down", "J"],
        title: "Pan down",
        help: "Moves the view down",
        hint: None,
        hindrance: free,
        run: |model, _| pan(model, 0.0, -1.0),
    },
    Command {
        id: "zoom-in",
        context: Context::PICTURE,
        keys: &["+", "="],
        title: "Closer",
        help: "Comes closer",
        hint: Some(12),
        hindrance: free,
        run: |model, _| zoom_by(model, ZOOM),
    },
    Command {
        id: "zoom-out",
        context: Context::PICTURE,
        keys: &["-"],
        title: "Farther",
        help: "Goes away from the tree",
        hint: None,
        hindrance: free,
        run: |model, _| zoom_by(model, 1.0 / ZOOM),
    },
    Command {
        id: "view-reset",
        context: Context::PICTURE,
        keys: &["0", "r"],
        title: "Whole tree",
        help: "Frames the whole tree again",
        hint: Some(14),
        hindrance: without_picture,
        run: |model, _| {
            model.picture.turn(None);
            super::reset(model);
            if model.forest.is_some() {
                super::first_look_at_forest(model);
            }
            if let Some(shown) = model.tree.as_ref().and_then(|tree| tree.shown.clone()) {
                super::first_look(model, &shown);
            }
        },
    },
    Command {
        id: "view-front",
        context: Context::PICTURE,
        keys: &["1"],
        title: "From the front",
        help: "Looks from the front, level",
        hint: None,
        hindrance: free,
        run: |model, _| look_from(model, Camera::front()),
    },
    Command {
        id: "view-side",
        context: Context::PICTURE,
        keys: &["2"],
        title: "From the side",
        help: "Looks from the right side, level",
        hint: None,
        hindrance: free,
        run: |model, _| look_from(model, Camera::side()),
    },
    Command {
        id: "view-top",
        context: Context::PICTURE,
        keys: &["3"],
        title: "From above",
        help: "Looks straight down",
        hint: None,
        hindrance: free,
        run: |model, _| look_from(model, Camera::top()),
    },
    Command {
        id: "turntable",
        context: Context::GLOBAL,
        keys: &["t"],
        title: "Turntable",
        help: "Turns the tree by itself; again, or the mouse, stops it",
        hint: Some(40),
        hindrance: without_picture,
        run: |model, _| {
            let now = model.now;
            model.picture.turn(if model.picture.is_turning() { None } else { Some(now) });
        },
    },
    Command {
        id: "level-next",
        context: Context::GLOBAL,
        keys: &["D"],
        title: "Level of detail",
        help: "Shows the next coarser level of detail as it is exported; after the coarsest, all that grew again",
        hint: None,
        hindrance: has_one_level,
        run: |model, _| next_level(model),
    },
    Command {
        id: "look-next",
        context: Context::GLOBAL,
        keys: &["c"],
        title: "Look",
        help: "Draws the tree otherwise: as skeleton, by axis order, by radius, by birth step, by light, as shaded surface",
        hint: Some(42),
        hindrance: free,
        run: |model, _| cycle_look(model, 1),
    },
    Command {
        id: "look-previous",
        context: Context::GLOBAL,
        keys: &["C"],
        title: "Look back",
        help: "Draws the tree as before in the round of looks",
        hint: None,
        hindrance: free,
        run: |model, _| cycle_look(model, PictureLook::ALL.len() - 1),
    },
    Command {
        id: "scenery",
        context: Context::GLOBAL,
        keys: &["B"],
        title: "Scenery",
        help: "Shows the tree in a landscape, or before the terminal's background",
        hint: None,
        hindrance: has_no_landscape,
        run: |model, _| {
            let scenery = &mut model.config.settings.scenery;
            *scenery = if *scenery == Scenery::Lit { Scenery::Plain } else { Scenery::Lit };
        },
    },
    Command {
        id: "overlay-points",
        context: Context::GLOBAL,
        keys: &["P"],
        title: "Points",
        help: "Shows or hides the points that were scanned, or those that the tree reaches for",
        hint: None,
        hindrance: has_no_points,
        run: |model, _| model.picture.points = !model.picture.points,
    },
    Command {
        id: "slice",
        context: Context::GLOBAL,
        keys: &["Z"],
        title: "Slice",
        help: "Cuts the tree at breast height and looks at the cut from above, with the points of its scan; again: all of it",
        hint: None,
        hindrance: without_tree,
        run: |model, _| toggle_slice(model),
    },
    Command {
        id: "slice-lower",
        context: Context::GLOBAL,
        keys: &["["],
        title: "Slice lower",
        help: "Cuts the tree 10 cm lower",
        hint: None,
        hindrance: is_whole,
        run: |model, _| move_slice(model, -SLICE_STEP_M),
    },
    Command {
        id: "slice-higher",
        context: Context::GLOBAL,
        keys: &["]"],
        title: "Slice higher",
        help: "Cuts the tree 10 cm higher",
        hint: None,
        hindrance: is_whole,
        run: |model, _| move_slice(model, SLICE_STEP_M),
    },
    Command {
        id: "overlay-outline",
        context: Context::GLOBAL,
        keys: &["O"],
        title: "Crown outline",
        help: "Shows or hides the crown that the tree fills",
        hint: None,
        hindrance: has_no_crown,
        run: |model, _| model.picture.outline = !model.picture.outline,
    },
    Command {
        id: "overlay-obstructions",
        context: Context::GLOBAL,
        keys: &["W"],
        title: "Obstacles and shade",
        help: "Shows or hides what stands in the tree's way, and the places where it has less light",
        hint: None,
        hindrance: stands_alone,
        run: |model, _| {
            model.picture.obstructions = !model.picture.obstructions;
            let now = if model.picture.obstructions { "shown" } else { "hidden" };
            model.say(format!("obstacles and shade: {now}"));
        },
    },
    Command {
        id: "overlay-scale",
        context: Context::GLOBAL,
        keys: &["M"],
        title: "Scale and person",
        help: "Shows or hides the scale bar and the person beside the tree",
        hint: None,
        hindrance: free,
        run: |model, _| model.picture.scale = !model.picture.scale,
    },
];
