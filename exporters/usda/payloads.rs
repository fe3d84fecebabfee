//! An assembly of files as a layer that is small however large they are.
//!
//! ```text
//! /forest               Xform, assembly
//!     /Trees              Xform, group
//!         /tree_12          Xform, component: a payload, its box, its place
//!         /tree_12_2        the same tree once more: both are instanceable
//! ```

use linden_pipeline::Monitor;

use super::layer::Layer;
use super::syntax::{identifier, quoted};
use super::wind::time;
use crate::assembly::{Assembly, Box3, Member, MemberPlace, WindLoop};
use crate::{Bundle, ExportError, GENERATOR};

impl Assembly {
    /// Writes an OpenUSD layer as text: an assembly, with a component for each place that holds the file as its
    /// payload. What stands in several places is instanceable.
    ///
    /// # Errors
    /// [`ExportError::Io`] and [`ExportError::Cancelled`].
    pub fn write_usd(&self, bundle: &mut Bundle, monitor: &dyn Monitor) -> Result<(), ExportError> {
        bundle.write_main(None, monitor, |out| write_layer(&mut Layer::new(out), self))
    }
}

/// What stands before the first prim, `root`, of a layer that names others; `wind` is the longest loop of these.
pub(super) fn begin(
    layer: &mut Layer<'_, '_>,
    root: &str,
    wind: Option<WindLoop>,
) -> Result<(), ExportError> {
    let generator = quoted(GENERATOR);
    let time = wind.map_or_else(String::new, time);
    layer.lines(&format!(
        r#"#usda 1.0
(
    defaultPrim = "{root}"
    doc = {generator}
{time}    metersPerUnit = 1
    upAxis = "Y"
)

"#
    ))
}

fn write_layer(layer: &mut Layer<'_, '_>, assembly: &Assembly) -> Result<(), ExportError> {
    let root = identifier(&assembly.name);
    let (name, generator) = (quoted(&assembly.name), quoted(GENERATOR));
    begin(layer, &root, WindLoop::longest(assembly.placed().filter_map(|(_, member)| member.wind)))?;
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
    kind = "assembly"
)"#
    ))?;
    let whole = assembly.placed().map(|(place, member)| place.around(member.bounds)).reduce(Box3::union);
    if let Some(Box3 { min, max }) = whole {
        // Floats hold fewer digits: outward, so that nothing sticks out.
        let (min, max) = (min.to_array().map(below), max.to_array().map(above));
        layer.lines(&extents_hint(min, max))?;
        layer.lines("\n")?;
    }
    layer.open("def Xform \"Trees\" (\n    kind = \"group\"\n)")?;
    let mut places = vec![0_u32; assembly.members.len()];
    for (place, _) in assembly.placed() {
        places[place.member] += 1;
    }
    let mut written = vec![0_u32; assembly.members.len()];
    for (place, member) in assembly.placed() {
        written[place.member] += 1;
        let prim = match written[place.member] {
            1 => format!("tree_{}", member.index),
            again => format!("tree_{}_{again}", member.index),
        };
        write_place(layer, &prim, place, member, places[place.member] > 1)?;
    }
    layer.close()?;
    layer.close()
}

fn write_place(
    layer: &mut Layer<'_, '_>,
    prim: &str,
    place: &MemberPlace,
    member: &Member,
    is_instanceable: bool,
) -> Result<(), ExportError> {
    let Member { index, source, seed, file, bounds, .. } = member;
    let (name, source) = (quoted(&format!("{source} {index}")), quoted(source));
    let instanceable = if is_instanceable { "    instanceable = true\n" } else { "" };
    let file = asset(file);
    layer.open(&format!(
        r#"def Xform "{prim}" (
    prepend apiSchemas = ["GeomModelAPI"]
    customData = {{
        dictionary linden = {{
            uint64 index = {index}
            uint64 seed = {seed}
            string source = {source}
        }}
    }}
    displayName = {name}
{instanceable}    kind = "component"
    prepend payload = {file}
)"#
    ))?;
    layer.lines(&extents_hint(bounds.min.to_array(), bounds.max.to_array()))?;
    let MemberPlace { position, turn_rad, scale, .. } = place;
    layer.lines(&format!(
        r#"double3 xformOp:translate = ({}, {}, {})
float xformOp:rotateY = {}
float3 xformOp:scale = ({scale}, {scale}, {scale})
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY", "xformOp:scale"]"#,
        position.x,
        position.y,
        position.z,
        turn_rad.to_degrees() as f32,
    ))?;
    layer.close()?;
    layer.lines("\n")
}

/// The box of a model whose payload is not loaded.
pub(super) fn extents_hint(min: [f32; 3], max: [f32; 3]) -> String {
    let corner = super::syntax::tuple;
    format!("float3[] extentsHint = [{}, {}]", corner(min), corner(max))
}

/// The path of a file as a literal. A path that has an `@` stands between three of them.
pub(super) fn asset(path: &str) -> String {
    let path: String = path.chars().filter(|c| !c.is_ascii_control()).collect();
    if path.contains('@') { format!("@@@{}@@@", path.replace("@@@", "\\@@@")) } else { format!("@{path}@") }
}

fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

fn above(x: f64) -> f32 {
    -below(-x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_literals() {
        assert_eq!(asset("./ab/cdef.usda"), "@./ab/cdef.usda@");
        assert_eq!(asset("../a@b/c.usda"), "@@@../a@b/c.usda@@@");
    }

    #[test]
    fn floats_are_outward() {
        for x in [0.1, -0.1, 1e8 + 1.0, 3.0] {
            assert!(f64::from(below(x)) <= x && f64::from(above(x)) >= x);
            assert!((f64::from(above(x)) - f64::from(below(x))).abs() <= x.abs() * 2e-7);
        }
    }
}
