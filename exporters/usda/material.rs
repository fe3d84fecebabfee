//! A material as a `UsdPreviewSurface` network, and what else there is of it beside.

use std::sync::Arc;

use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Wrap};

use super::materialx;
use super::syntax::{beside, tuple};

/// The prim at `path`, not indented, `with_materialx` beside where that says more. `file` gives the file of a
/// picture, where it is written.
pub(super) fn describe<'f>(
    material: &Material,
    name: &str,
    path: &str,
    with_materialx: bool,
    file: impl Fn(Option<&Arc<Picture>>) -> Option<&'f str>,
) -> String {
    let color = file(material.base_color_picture.as_ref());
    let normal = file(material.normal_picture.as_ref());
    let diffuse = match color {
        Some(_) => format!("inputs:diffuseColor.connect = <{path}/Color.outputs:rgb>"),
        None => format!("inputs:diffuseColor = {}", tuple(material.base_color)),
    };
    let bump = match normal {
        Some(_) => format!("\n        normal3f inputs:normal.connect = <{path}/Normal.outputs:rgb>"),
        None => String::new(),
    };
    // Cut out where the alpha is below the threshold, not blended (UsdPreviewSurface, opacityThreshold).
    let cut = match material.cutout.filter(|_| color.is_some()) {
        Some(threshold) => format!(
            "\n        float inputs:opacity.connect = <{path}/Color.outputs:a>\n        float \
             inputs:opacityThreshold = {threshold}"
        ),
        None => String::new(),
    };
    let network = if with_materialx { materialx::network(material, path, &file) } else { None };
    let also = network.as_ref().map(|network| format!("\n    {}", network.output)).unwrap_or_default();
    let mut text = format!(
        r#"def Material "{name}"
{{{also}
    token outputs:surface.connect = <{path}/Surface.outputs:surface>

    def Shader "Surface"
    {{
        uniform token info:id = "UsdPreviewSurface"
        color3f {diffuse}
        float inputs:metallic = 0{bump}{cut}
        float inputs:roughness = {}
        token outputs:surface
    }}
"#,
        material.roughness
    );
    if color.or(normal).is_some() {
        text += r#"
    def Shader "Coordinates"
    {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
"#;
    }
    if let Some(file) = color {
        let fallback = tuple(material.base_color).replace(')', ", 1)");
        let more = format!("float4 inputs:fallback = {fallback}");
        let alpha = material.cutout.is_some();
        let reading = Reading { color_space: "sRGB", wrap: material.wrap, alpha, more: &more };
        text += &texture("Color", path, file, &reading);
    }
    if let Some(file) = normal {
        // 0..1 in the picture is -1..1 in the vector (UsdPreviewSurface specification, "Normal").
        let decode = "float4 inputs:bias = (-1, -1, -1, 0)
        float4 inputs:fallback = (0.5, 0.5, 1, 1)
        float4 inputs:scale = (2, 2, 2, 1)";
        let reading = Reading { color_space: "raw", wrap: material.wrap, alpha: false, more: decode };
        text += &texture("Normal", path, file, &reading);
    }
    text + &network.map(|network| network.shaders).unwrap_or_default() + "}\n\n"
}

/// How a picture is read.
struct Reading<'a> {
    color_space: &'a str,
    wrap: Wrap,
    /// Whether its alpha is used.
    alpha: bool,
    more: &'a str,
}

fn texture(name: &str, path: &str, file: &str, reading: &Reading<'_>) -> String {
    let Reading { color_space, more, .. } = reading;
    let wrap = match reading.wrap {
        Wrap::Repeat => "repeat",
        Wrap::Clamp => "clamp",
    };
    let alpha = if reading.alpha { "\n        float outputs:a" } else { "" };
    let asset = beside(file);
    format!(
        r#"
    def Shader "{name}"
    {{
        uniform token info:id = "UsdUVTexture"
        {more}
        asset inputs:file = {asset}
        token inputs:sourceColorSpace = "{color_space}"
        float2 inputs:st.connect = <{path}/Coordinates.outputs:result>
        token inputs:wrapS = "{wrap}"
        token inputs:wrapT = "{wrap}"
        float3 outputs:rgb{alpha}
    }}
"#
    )
}
