//! A stage as far as a format holds it, and what is said of the rest: nothing that was asked for is left
//! out in silence.

use linden_pipeline::knob::listed;
use linden_pipeline::preset::{KNOBS, Section};
use linden_pipeline::stage::{Plant, Stage};

use crate::{Bundle, Format, Holds, LooksIn, REGISTRY};

/// The knob that shows in pictures of normals alone.
const RELIEF: &str = "bark_relief";

/// The knob that shows in normals alone.
const NORMALS: &str = "leaf_normals";

/// The knob that shows in materials alone.
const TRANSLUCENCY: &str = "leaf_translucency";

/// The knob of the wood that shows in leaves and colours alone.
const KILLING: &str = "dead_below";

/// Knobs of detail that leave out leaves in the finest level.
const BUDGETS: [&str; 2] = ["triangles", "lod_triangles"];

/// Knobs that show in colours and pictures, most of them in these alone.
const SHOWN: [&str; 44] = [
    "bark",
    "bark_color",
    "bark_grain",
    "bark_size",
    "bark_seed",
    "bark_tile",
    "bark_lenticels",
    "limb_radius",
    "limb_bark",
    "limb_color",
    "twig_radius",
    "twig_bark",
    "twig_color",
    "foot_height",
    "foot_bark",
    "foot_color",
    "moss",
    "moss_side",
    "moss_height",
    "moss_radius",
    "moss_color",
    "dead_color",
    "dead_below",
    "leaf_outline",
    "leaf_lobes",
    "leaf_lobe_depth",
    "leaf_margin",
    "leaf_petiole",
    "twig_leaves",
    "twig_tuft",
    "twig_shoots",
    "leaf_normals",
    "leaf_colors",
    "autumn_colors",
    "young_colors",
    "turn_range",
    "petal_rows",
    "leaf_tint_spread",
    "leaf_shade",
    "evergreen",
    "season",
    "leaf_size",
    "leaf_seed",
    "billboard_size",
];

/// The formats that hold something: `gltf, glb, usda and usdz`.
fn holders(holds: impl Fn(&Holds) -> bool) -> String {
    let formats = REGISTRY.iter().map(|exporter| exporter.format());
    listed(formats.filter(|format| holds(&format.holds)).map(|format| format.id), "and")
}

/// The stage as far as a format holds it: in one season where it holds one. What it does not hold of what
/// is on the stage, or of the knobs that were turned for it, is noted by name in the bundle.
///
/// ```
/// use linden_pipeline::{Quiet, dress::dress, grow::grow, preset::builtin, recipe::Recipe, stage::Stage};
/// use linden_exporters::{Bundle, find, writing::fit};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let recipe = Recipe::new(builtin("older-f").unwrap().load()?);
/// let scene = dress(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
/// let stage = Stage::of(&scene).in_setting();
/// let mut bundle = Bundle::stream("nowhere", std::io::sink());
/// let fitted = fit(&stage, find("obj")?.format(), &mut bundle);
/// assert_eq!(fitted.plants.len(), 1);
/// assert!(bundle.notes()[0].starts_with("obj holds no camera, sun, sky and ground"));
/// # Ok(())
/// # }
/// ```
pub fn fit<'a>(stage: &Stage<'a>, format: &Format, bundle: &mut Bundle) -> Stage<'a> {
    let Format { id, holds, .. } = format;
    let mut parts = stage.plants.iter().flat_map(Plant::scenes).flat_map(|scene| &scene.parts);
    let has_wind = parts.any(|part| part.wind.is_some());
    let turned = |of: &dyn Fn(Section, &str) -> bool| -> Vec<&'static str> {
        let is_turned = |name: &str| stage.turned.iter().any(|turned| turned == name);
        let rows = KNOBS.iter().filter(|row| of(row.section, row.knob.name) && is_turned(row.knob.name));
        rows.map(|row| row.knob.name).collect()
    };
    if !holds.recipe {
        let others = holders(|holds| holds.recipe);
        bundle.note(format!(
            "{id} holds no recipe, so that nothing can tell from the file how the tree was grown; {others} hold it"
        ));
    }
    if !holds.surface {
        let without = |section: Section, name: &str| match section {
            Section::Foliage => !holds.organs || [NORMALS, TRANSLUCENCY].contains(&name),
            Section::Detail => !(holds.organs && BUDGETS.contains(&name)),
            // It takes leaves away, and the wood stays.
            Section::Wood if name == KILLING => !holds.organs,
            _ => section.covers(),
        };
        let mut names = turned(&without);
        for (is_there, name) in [
            (stage.levels() > 1, "lods"),
            (has_wind, "wind"),
            (stage.seasons() > 1 && holds.seasons == LooksIn::Nothing, "seasons"),
            (stage.setting.is_some(), "scene"),
        ] {
            if is_there && !names.contains(&name) {
                names.push(name);
            }
        }
        if !names.is_empty() {
            let change = if names.len() == 1 { "changes" } else { "change" };
            let what = if holds.organs { "no surface" } else { "the skeleton alone" };
            bundle.note(format!("{id} holds {what}: {} {change} nothing in it", listed(&names, "and")));
        }
        note_seasons(stage, format, bundle);
        return stage.in_season(0);
    }
    let shown = turned_colors(stage);
    if !holds.colors && !shown.is_empty() {
        let others = holders(|holds| holds.colors);
        bundle.note(format!(
            "{id} holds no colours and pictures: what {} {} of them is left out; {others} hold them",
            listed(&shown, "and"),
            if shown.len() == 1 { "changes" } else { "change" },
        ));
    }
    if !holds.normals && stage.turned.iter().any(|name| name == RELIEF) {
        let others = holders(|holds| holds.normals);
        bundle.note(format!(
            "{id} holds no pictures of normals: {RELIEF} changes nothing in it; {others} hold them"
        ));
    }
    if !holds.translucency && stage.turned.iter().any(|name| name == TRANSLUCENCY) {
        let others = holders(|holds| holds.translucency);
        bundle.note(format!(
            "{id} has no translucent materials: {TRANSLUCENCY} changes nothing in it; {others} have them"
        ));
    }
    if has_wind && !holds.wind {
        let mut names = turned(&|section, _| section == Section::Wind);
        if !names.contains(&"wind") {
            names.insert(0, "wind");
        }
        let are = if names.len() == 1 { "is" } else { "are" };
        let others = holders(|holds| holds.wind);
        bundle
            .note(format!("{id} holds no wind: {} {are} left out; {others} hold it", listed(&names, "and")));
    }
    if stage.setting.is_some() && !holds.setting {
        let others = holders(|holds| holds.setting);
        bundle.note(format!(
            "{id} holds no camera, sun, sky and ground: scene is left out; {others} hold them"
        ));
    }
    if stage.levels() > 1 && holds.levels == LooksIn::Files {
        let others = holders(|holds| holds.levels == LooksIn::One);
        bundle.note(format!(
            "{id} holds one level of detail: of lods the finest was written; give each a file, or write {others}"
        ));
    }
    if note_seasons(stage, format, bundle) { stage.in_season(0) } else { stage.clone() }
}

/// The knobs of colours and pictures that were turned for a stage, in the order of all knobs.
pub(crate) fn turned_colors(stage: &Stage<'_>) -> Vec<&'static str> {
    let is_turned = |name: &str| SHOWN.contains(&name) && stage.turned.iter().any(|turned| turned == name);
    KNOBS.iter().map(|row| row.knob.name).filter(|name| is_turned(name)).collect()
}

/// Notes that a format holds one season of several; whether it is so.
fn note_seasons(stage: &Stage<'_>, format: &Format, bundle: &mut Bundle) -> bool {
    let is_one = stage.seasons() > 1 && format.holds.seasons == LooksIn::Files;
    if is_one {
        let shown = stage.plants.iter().find_map(|plant| plant.seasons.first());
        let others = holders(|holds| holds.seasons == LooksIn::One);
        bundle.note(format!(
            "{} holds one season: of seasons '{}' was written; give each a file, or write {others}",
            format.id,
            shown.map_or("", |season| season.name.as_str()),
        ));
    }
    is_one
}
