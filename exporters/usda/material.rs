//! A material as a `UsdPreviewSurface` network.

use std::sync::Arc;

use linden::picture::Picture;
use linden::scene::Material;

use super::syntax::tuple;

/// The prim at `path`. `file` gives the file of a picture, where it is written.
pub(super) fn describe<'f>(
    material: &Material,
    name: &str,
    path: &str,
    file: impl Fn(Option<&Arc<Picture>>) -> Option<&'f str>,
) -> String {
    let color = file(material.base_color_picture.as_ref());
    let normal = file(material.normal_picture.as_ref());
    let diffuse = match color {
        Some(_) => format!("inputs:diffuseColor.connect = <{path}/Color.outputs:rgb>"),
        None => format!("inputs:diffuseColor = {}", tuple(material.base_color)),
    };
    let bump = match normal {
        Some(_) => format!("\n                normal3f inputs:normal.connect = <{path}/Normal.outputs:rgb>"),
        None => String::new(),
    };
    let mut text = format!(
        r#"        def Material "{name}"
        {{
            token outputs:surface.connect = <{path}/Surface.outputs:surface>

            def Shader "Surface"
            {{
                uniform token info:id = "UsdPreviewSurface"
                color3f {diffuse}
                float inputs:metallic = 0{bump}
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
        text += &texture("Color", path, file, "sRGB", &format!("float4 inputs:fallback = {fallback}"));
    }
    if let Some(file) = normal {
        // 0..1 in the picture is -1..1 in the vector (UsdPreviewSurface specification, "Normal").
        let decode = "float4 inputs:bias = (-1, -1, -1, 0)
                float4 inputs:fallback = (0.5, 0.5, 1, 1)
                float4 inputs:scale = (2, 2, 2, 1)";
        text += &texture("Normal", path, file, "raw", decode);
    }
    text + "        }\n\n"
}

fn texture(name: &str, path: &str, file: &str, color_space: &str, more: &str) -> String {
    // Names of side files hold nothing that ends or changes an asset path; see `Bundle::side_name`.
    format!(
        r#"
            def Shader "{name}"
            {{
                uniform token info:id = "UsdUVTexture"
                {more}
                asset inputs:file = @./{file}@
                token inputs:sourceColorSpace = "{color_space}"
                float2 inputs:st.connect = <{path}/Coordinates.outputs:result>
                token inputs:wrapS = "repeat"
                token inputs:wrapT = "repeat"
                float3 outputs:rgb
            }}
"#
    )
}
