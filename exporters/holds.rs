//! What formats can hold, and what is said of the rest: nothing that was asked for is left out in silence.

use linden::preset::{KNOBS, Section};
use linden::stage::{Plant, Stage};

use crate::{Bundle, Format, REGISTRY};

/// Where a format has levels of detail, or seasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LooksIn {
    /// All in one file.
    One,
    /// It holds one: each takes a file of its own.
    Files,
    /// Nothing in it depends on them.
    Nothing,
}

/// What a format holds beside the axial tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact for itself, none follows from another")]
pub struct Holds {
    /// The surface, with what covers it: leaves, colours.
    pub surface: bool,
    /// Levels of detail.
    pub levels: LooksIn,
    /// Seasons.
    pub seasons: LooksIn,
    /// How the plant moves in the wind.
    pub wind: bool,
    /// Pictures of normals: how deep the bark is.
    pub normals: bool,
    /// Camera, sun, sky and ground.
    pub setting: bool,
}

impl Holds {
    /// The axial tree alone.
    pub const SKELETON: Self = Self {
        surface: false,
        levels: LooksIn::Nothing,
        seasons: LooksIn::Nothing,
        wind: false,
        normals: false,
        setting: false,
    };

    /// One plant in one look, at rest.
    pub const MESH: Self = Self {
        surface: true,
        levels: LooksIn::Files,
        seasons: LooksIn::Files,
        normals: true,
        ..Self::SKELETON
    };

    /// Everything in one file.
    pub const SCENE: Self =
        Self { levels: LooksIn::One, seasons: LooksIn::One, wind: true, setting: true, ..Self::MESH };
}

/// The knob that shows in pictures of normals alone.
const RELIEF: &str = "bark_relief";

/// `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The formats that hold something: `gltf, glb, usda and usdz`.
fn holders(holds: impl Fn(&Holds) -> bool) -> String {
    let formats = REGISTRY.iter().map(|exporter| exporter.format());
    listed(&formats.filter(|format| holds(&format.holds)).map(|format| format.id).collect::<Vec<_>>())
}

/// The stage as far as a format holds it: in one season where it holds one. What it does not hold of what
/// is on the stage, or of the knobs that were turned for it, is noted by name.
pub(crate) fn fit<'a>(stage: &Stage<'a>, format: &Format, bundle: &mut Bundle) -> Stage<'a> {
    let Format { id, holds, .. } = format;
    let mut parts = stage.plants.iter().flat_map(Plant::scenes).flat_map(|scene| &scene.parts);
    let has_wind = parts.any(|part| part.wind.is_some());
    let turned = |section: &dyn Fn(Section) -> bool| -> Vec<&'static str> {
        let is_turned = |name: &str| stage.turned.iter().any(|turned| turned == name);
        let rows = KNOBS.iter().filter(|row| section(row.section) && is_turned(row.knob.name));
        rows.map(|row| row.knob.name).collect()
    };
    if !holds.surface {
        let mut names = turned(&Section::covers);
        for (is_there, name) in [
            (stage.levels() > 1, "lods"),
            (has_wind, "wind"),
            (stage.seasons() > 1, "seasons"),
            (stage.setting.is_some(), "scene"),
        ] {
            if is_there && !names.contains(&name) {
                names.push(name);
            }
        }
        if !names.is_empty() {
            let change = if names.len() == 1 { "changes" } else { "change" };
            bundle.note(format!("{id} holds the skeleton alone: {} {change} nothing in it", listed(&names)));
        }
        return stage.in_season(0);
    }
    if !holds.normals && stage.turned.iter().any(|name| name == RELIEF) {
        let others = holders(|own| own.normals);
        bundle.note(format!(
            "{id} holds no pictures of normals: {RELIEF} changes nothing in it; {others} hold them"
        ));
    }
    if has_wind && !holds.wind {
        let mut names = turned(&|section| section == Section::Wind);
        if !names.contains(&"wind") {
            names.insert(0, "wind");
        }
        let are = if names.len() == 1 { "is" } else { "are" };
        let others = holders(|own| own.wind);
        bundle.note(format!("{id} holds no wind: {} {are} left out; {others} hold it", listed(&names)));
    }
    if stage.setting.is_some() && !holds.setting {
        let others = holders(|own| own.setting);
        bundle.note(format!(
            "{id} holds no camera, sun, sky and ground: scene is left out; {others} hold them"
        ));
    }
    if stage.levels() > 1 && holds.levels == LooksIn::Files {
        let others = holders(|own| own.levels == LooksIn::One);
        bundle.note(format!(
            "{id} holds one level of detail: of lods the finest was written; give each a file, or write {others}"
        ));
    }
    if stage.seasons() > 1 && holds.seasons == LooksIn::Files {
        let shown = stage.plants.iter().find_map(|plant| plant.seasons.first());
        let others = holders(|own| own.seasons == LooksIn::One);
        bundle.note(format!(
            "{id} holds one season: of seasons '{}' was written; give each a file, or write {others}",
            shown.map_or("", |season| season.name.as_str()),
        ));
        return stage.in_season(0);
    }
    stage.clone()
}
