//! A plant at several ages as a layer that holds none of them.
//!
//! ```text
//! /oak        Xform, component; the set `age`: each variant a payload, and its box
//! ```

use linden_pipeline::Monitor;
use linden_pipeline::scene::Bounds;

use super::layer::Layer;
use super::payloads::{asset, begin, extents_hint};
use super::syntax::{identifier, quoted};
use crate::assembly::{AgeFile, AgeSet};
use crate::{Bundle, ExportError, GENERATOR};

pub(crate) fn write(
    set: &AgeSet,
    is_binary: bool,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    if is_binary {
        let bytes = Layer::binary(monitor, |layer| write_layer(layer, set))?;
        return bundle.write_main(Some(bytes.len() as u64), monitor, |out| out.write(&bytes));
    }
    bundle.write_main(None, monitor, |out| write_layer(&mut Layer::new(out), set))
}

fn write_layer(layer: &mut Layer<'_, '_>, set: &AgeSet) -> Result<(), ExportError> {
    let root = identifier(&set.name);
    let (name, generator) = (quoted(&set.name), quoted(GENERATOR));
    begin(layer, &root)?;
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
        }}
    }}
    displayName = {name}
    kind = "component"
    prepend variantSets = "age"
    variants = {{
        string age = "{chosen}"
    }}
)"#
    ))?;
    layer.open_inline("variantSet \"age\" =")?;
    for AgeFile { age, file, bounds } in &set.ages {
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
