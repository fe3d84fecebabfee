//! A plant in two layers: its head, which is small and always read, and all within it, which is loaded when it is wanted.
//!
//! ```text
//! oak.usda            /oak  component: name, box, the names of levels and seasons, the recipe; a payload:
//! oak_payload.usda    /oak  Geometry, Materials, the sets of variants
//! ```
//!
//! What does not show in the small layer is told there, so that the two can be written again from it.

use super::layer::Layer;
use super::plant::Component;
use super::syntax::{beside, identifier, quoted};
use super::{Writing, head, open_layer};
use crate::options::Options;
use crate::traces::Traces;
use crate::{Bundle, ExportError, Format};

/// How the line begins that tells the options.
pub(super) const TOLD_TRACE: &str = "custom string userProperties:linden:payload = ";
/// How what it tells begins.
pub(super) const TOLD_BEGINNING: &str = "payload=true ";
/// What is told of a plant with several seasons.
const SEASONS: &str = "seasons";

/// How a plant is split.
pub(super) struct Split {
    /// What the payload's name ends with.
    pub suffix: String,
    /// The payload from the small layer on.
    payload: String,
    /// The small layer, as USD names it.
    identifier: Option<String>,
    told: String,
}

impl Split {
    /// `None` where it is not asked for, or cannot be: then that is noted.
    pub fn of(writing: &Writing<'_>, suffix: &str, options: &Options, bundle: &mut Bundle) -> Option<Self> {
        // That is noted elsewhere.
        if !options.is_on("payload") || writing.nanite.is_some() {
            return None;
        }
        if !bundle.takes_side_files() {
            bundle.note("payload=true is left out: a single stream holds one layer; name a file instead");
            return None;
        }
        let stage = writing.stage;
        if !stage.is_single() || stage.setting.is_some() {
            bundle.note(
                "payload=true is left out: it is for one plant without a scene; 'linden batch --merge --usd' \
                 puts plants together by payloads",
            );
            return None;
        }
        let mut told = TOLD_BEGINNING.to_owned();
        for (name, value) in options.iter().filter(|(name, _)| *name != "payload") {
            told += &format!("{name}={value} ");
        }
        if stage.plants.iter().any(|plant| plant.seasons.len() > 1) {
            told += SEASONS;
        }
        // A name that no path can have is left out.
        let name = bundle.main_name().and_then(|name| name.to_str());
        let is_plain = |name: &&str| !name.contains(|c: char| c == '@' || c.is_ascii_control());
        Some(Self {
            suffix: suffix.to_owned(),
            payload: bundle.side_name(suffix),
            identifier: name.filter(is_plain).map(beside),
            told: told.trim_end().to_owned(),
        })
    }

    /// The small layer.
    pub fn write_interface(
        &self,
        layer: &mut Layer<'_, '_>,
        writing: &Writing<'_>,
    ) -> Result<(), ExportError> {
        let root = identifier(&writing.stage.name);
        open_layer(layer, writing, &root)?;
        let component = Component::new(writing, 0, format!("/{root}"));
        let payload = format!("{}</{root}>", beside(&self.payload));
        head(writing, &root, &component).open_with(layer, self.identifier.as_deref(), Some(&payload))?;
        layer.lines(&format!("{TOLD_TRACE}{}", quoted(&self.told)))?;
        component.name_variants(layer)?;
        layer.close()
    }

    /// All that is loaded.
    pub fn write_payload(layer: &mut Layer<'_, '_>, writing: &Writing<'_>) -> Result<(), ExportError> {
        let root = identifier(&writing.stage.name);
        open_layer(layer, writing, &root)?;
        let component = Component::new(writing, 0, format!("/{root}"));
        let sets = component
            .variants()
            .first()
            .map_or_else(String::new, |set| format!(" (\n    prepend variantSets = \"{set}\"\n)"));
        layer.open(&format!("def Xform \"{root}\"{sets}"))?;
        component.write(layer)?;
        layer.close()
    }
}

/// What a small layer tells of both.
pub(super) fn traces(format: &'static Format, told: &str) -> Traces {
    let mut traces = Traces::none(format);
    for word in told.split(' ') {
        match word.split_once('=') {
            Some((name, value)) => traces = traces.with(name, value),
            None => traces.seasons |= word == SEASONS,
        }
    }
    traces
}
