//! The preset for a file of parameters that another program grows trees from.

use linden_base::document::Fault;
use linden_base::knob::printable;
use linden_plant::settings::Form;
use linden_plant::texture::leaf::Outline;
use linden_weber_penn::{ParameterFile, ParameterLook, read_parameters};

use super::Preset;

/// The share of the trunk's length that its flare reaches up: an eighth, as Weber and Penn have it.
const FLARE_SHARE: f64 = 0.125;

impl Preset {
    /// The preset for parameters of Arbaro, Sapling or tree-gen, everything else at its default, and what of the
    /// file is left out or read otherwise.
    ///
    /// ```
    /// let xml = r#"<arbaro><species name="aspen"><param name="Leaves" value="8"/></species></arbaro>"#;
    /// let (aspen, notes) = linden_pipeline::preset::Preset::of_tree_parameters("aspen", xml)?;
    /// assert_eq!(aspen.grows_by().id(), "weber-penn");
    /// assert!(notes.is_empty());
    /// # Ok::<(), linden_pipeline::document::Fault>(())
    /// ```
    ///
    /// # Errors
    /// [`Fault`]: what is wrong with the file, and where.
    pub fn of_tree_parameters(id: &str, text: &str) -> Result<(Self, Vec<String>), Fault> {
        let ParameterFile { program, species, seed, settings, look, notes } = read_parameters(text)?;
        let length_m = settings.scale_m * settings.length.first().copied().unwrap_or(1.0);
        let mut preset = Self::of(id, settings);
        preset.name = species.as_deref().map_or_else(|| id.to_owned(), printable);
        preset.summary = format!("parameters of {}, grown by Weber and Penn", program.name());
        preset.source = format!("a file of {}", program.name());
        preset.set_seed(seed.unwrap_or(preset.seed()));
        let ParameterLook { flare, lobes, lobe_depth, leaf_width, leaf_outline } = look;
        let features = &mut preset.dressing.tubes.features;
        features.flare = flare as f32;
        features.flare_height_m = (flare > 0.0).then_some((FLARE_SHARE * length_m).min(100.0) as f32);
        if lobe_depth > 0.0 {
            features.lobes = lobes as u32;
            features.lobe_depth = lobe_depth as f32;
        }
        let leaves = &mut preset.dressing.foliage.first;
        leaves.form = Form::Card;
        leaves.width = Some(leaf_width);
        // Leaves stand where the generator places them, and nowhere else.
        leaves.per_m = 0.0;
        leaves.terminal = false;
        let known = Outline::ALL.iter().find(|(name, ..)| *name == leaf_outline);
        leaves.outline = known.map_or(leaves.outline, |(_, outline, _)| *outline);
        Ok((preset, notes))
    }
}
