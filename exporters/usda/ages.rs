//! A plant at several ages as a layer that holds none of them, with the recipe of the one that is seen first.
//!
//! ```text
//! /oak        Xform, component; the set `age`: each variant a payload, and its box
//! ```

use linden_pipeline::Monitor;
use linden_pipeline::scene::Bounds;

use super::layer::Layer;
use super::payloads::{asset, begin, extents_hint};
use super::syntax::{identifier, quoted};
use crate::assembly::{AgeFile, AgeSet, WindLoop};
use crate::{Bundle, ExportError, GENERATOR};

/// The set of variants, and how its line begins.
pub(super) const SET: &str = "age";
pub(super) const TRACE: &str = "variantSet \"age\"";

/// How a layer of OpenUSD is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UsdForm {
    /// As text, `.usda`.
    Text,
    /// In binary, `.usdc`.
    Binary,
}

impl AgeSet {
    /// Writes an OpenUSD layer in which ages are the variants of the set `age`, each with its file as a payload.
    ///
    /// ```
    /// use linden_exporters::{AgeFile, AgeSet, Bundle, UsdForm};
    /// use linden_pipeline::Quiet;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let file = |age: &str| AgeFile { age: age.to_owned(), file: format!("./ash_{age}.usda"), bounds: None, wind: None };
    /// let (name, recipe) = ("ash".to_owned(), "{}".to_owned());
    /// let ages = AgeSet { name, recipe, ages: vec![file("young"), file("old")] };
    /// let folder = tempfile::tempdir()?;
    /// let mut bundle = Bundle::create(&folder.path().join("ash.usda"))?;
    /// ages.write_usd(UsdForm::Text, &mut bundle, &Quiet)?;
    /// let files = bundle.commit()?;
    /// assert!(std::fs::read_to_string(&files[0].path)?.contains("variantSet \"age\""));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ExportError::Io`] and [`ExportError::Cancelled`].
    pub fn write_usd(
        &self,
        form: UsdForm,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        match form {
            UsdForm::Text => bundle.write_main(None, monitor, |out| write_layer(&mut Layer::new(out), self)),
            UsdForm::Binary => {
                let bytes = Layer::binary(monitor, |layer| write_layer(layer, self))?;
                bundle.write_main(Some(bytes.len() as u64), monitor, |out| out.write(&bytes))
            }
        }
    }
}

fn write_layer(layer: &mut Layer<'_, '_>, set: &AgeSet) -> Result<(), ExportError> {
    let root = identifier(&set.name);
    let (name, generator) = (quoted(&set.name), quoted(GENERATOR));
    begin(layer, &root, WindLoop::longest(set.ages.iter().filter_map(|file| file.wind)))?;
    let recipe = match set.recipe.as_str() {
        "" => String::new(),
        recipe => format!("            string recipe = {}\n", quoted(recipe)),
    };
    let chosen = set.ages.last().map_or("", |file| file.age.as_str());
    layer.open(&format!(
        r#"def Xform "{root}" (
    prepend apiSchemas = ["GeomModelAPI"]
    assetInfo = {{
        string name = {name}
        string version = "1"
    }}
    customData = {{
        dictionary linden = {{
            string generator = {generator}
{recipe}        }}
    }}
    displayName = {name}
    kind = "component"
    prepend variantSets = "{SET}"
    variants = {{
        string {SET} = "{chosen}"
    }}
)"#
    ))?;
    if !set.recipe.is_empty() {
        let recipe = quoted(&set.recipe);
        layer.lines(&format!("custom string userProperties:linden:recipe = {recipe}\n\n"))?;
    }
    layer.open_inline(&format!("{TRACE} ="))?;
    for AgeFile { age, file, bounds, .. } in &set.ages {
        layer.open_inline(&format!("\"{age}\" (\n    prepend payload = {}</{root}>\n)", asset(file)))?;
        if let Some(Bounds { min, max }) = bounds {
            layer.lines(&extents_hint(min.to_array(), max.to_array()))?;
            layer.lines("\n")?;
        }
        layer.close()?;
    }
    layer.close()?;
    layer.close()
}
