//! What `UsdPreviewSurface` cannot say of a material: light that passes. A `MaterialX` network around Autodesk's
//! Standard Surface stands beside it, for renderers that know `mtlx` (Karma, Arnold, Omniverse, Storm where it is
//! built with `MaterialX`); all others take the `UsdPreviewSurface` as ever.
//!
//! A thin-walled Standard Surface mixes diffuse reflection in `base_color` and diffuse transmission in
//! `subsurface_color` by `subsurface`. `OpenPBR` says the same in other words, but the graph that `MaterialX` 1.39 has
//! for it applies the subsurface's colour twice (`MaterialX` issue 3027): leaves would be darker than without it.
//! Names of nodes are those of `MaterialX` 1.39.

use std::sync::Arc;

use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Translucency, Wrap};

use super::syntax::{beside, tuple};

/// What a reader sees of it first.
pub(super) const TRACE: &str = "uniform token info:id = \"ND_standard_surface_surfaceshader\"";

/// What the material's prim says, and the shaders in it, not indented; `None` for what nothing passes.
pub(super) struct Network {
    /// The material's output.
    pub output: String,
    /// Its shaders.
    pub shaders: String,
}

/// The network of a material whose prim is at `path`. `file` gives the file of a picture, where it is written.
pub(super) fn network<'f>(
    material: &Material,
    path: &str,
    file: impl Fn(Option<&Arc<Picture>>) -> Option<&'f str>,
) -> Option<Network> {
    let translucency = material.translucency?;
    let wrap = match material.wrap {
        Wrap::Repeat => "periodic",
        Wrap::Clamp => "clamp",
    };
    let color = file(material.base_color_picture.as_ref());
    let normal = file(material.normal_picture.as_ref());
    let passing = file(material.passing_picture.as_ref());
    let from = |shader: &str| format!("<{path}/{shader}.outputs:out>");
    let cut = material.cutout.filter(|_| color.is_some());
    let [base, through, opacity, bump, subsurface] =
        surface_inputs(material, translucency, [color, normal, passing].map(|file| file.is_some()), from);
    let mut shaders = format!(
        r#"
    def Shader "Mtlx_Surface"
    {{
        {TRACE}
        float inputs:base = 1
        color3f {base}
        float inputs:metalness = 0
        {bump}{opacity}float inputs:specular_roughness = {}
        float {subsurface}
        color3f {through}
        bool inputs:thin_walled = 1
        token outputs:out
    }}
"#,
        material.roughness
    );
    let mut node = |name: &str, id: &str, inputs: &[String], out: &str| {
        let inputs = inputs.join("\n        ");
        shaders += &format!(
            "\n    def Shader \"{name}\"\n    {{\n        uniform token info:id = \"{id}\"\n        {inputs}\n        {out} \
             outputs:out\n    }}\n"
        );
    };
    let image = |file: &str, space: &str| {
        vec![
            format!(
                "asset inputs:file = {} (\n            colorSpace = \"{space}\"\n        )",
                beside(file)
            ),
            format!("float2 inputs:texcoord.connect = {}", from("Mtlx_Coordinates")),
            format!("string inputs:uaddressmode = \"{wrap}\""),
            format!("string inputs:vaddressmode = \"{wrap}\""),
        ]
    };
    if color.or(normal).or(passing).is_some() {
        let name = "string inputs:geomprop = \"st\"".to_owned();
        node("Mtlx_Coordinates", "ND_geompropvalue_vector2", &[name], "float2");
    }
    if let Some(file) = color {
        let picture = format!("color4f inputs:in.connect = {}", from("Mtlx_Color"));
        node("Mtlx_Color", "ND_image_color4", &image(file, "srgb_texture"), "color4f");
        node("Mtlx_Rgb", "ND_convert_color4_color3", std::slice::from_ref(&picture), "color3f");
        let tint = [
            format!("color3f inputs:in1.connect = {}", from("Mtlx_Rgb")),
            format!("color3f inputs:in2 = {}", tuple(translucency.tint)),
        ];
        node("Mtlx_Through", "ND_multiply_color3", &tint, "color3f");
        if let Some(threshold) = cut {
            node("Mtlx_Alpha", "ND_extract_color4", &[picture, "int inputs:index = 3".to_owned()], "float");
            let cut = [
                "float inputs:in1 = 1".to_owned(),
                "float inputs:in2 = 0".to_owned(),
                format!("float inputs:value1.connect = {}", from("Mtlx_Alpha")),
                format!("float inputs:value2 = {threshold}"),
            ];
            node("Mtlx_Cut", "ND_ifgreatereq_float", &cut, "float");
            let gray = format!("float inputs:in.connect = {}", from("Mtlx_Cut"));
            node("Mtlx_Opacity", "ND_convert_float_color3", &[gray], "color3f");
        }
    }
    if let Some(file) = passing {
        node("Mtlx_Passing", "ND_image_color4", &image(file, "raw"), "color4f");
        let picture = format!("color4f inputs:in.connect = {}", from("Mtlx_Passing"));
        // The first channel is there in gray pictures, too.
        node("Mtlx_Passes", "ND_extract_color4", &[picture, "int inputs:index = 0".to_owned()], "float");
        let share = [
            format!("float inputs:in1.connect = {}", from("Mtlx_Passes")),
            format!("float inputs:in2 = {}", translucency.share),
        ];
        node("Mtlx_Share", "ND_multiply_float", &share, "float");
    }
    if let Some(file) = normal {
        node("Mtlx_Normal", "ND_image_vector3", &image(file, "raw"), "float3");
        let encoded = format!("float3 inputs:in.connect = {}", from("Mtlx_Normal"));
        node("Mtlx_Bump", "ND_normalmap_float", &[encoded], "float3");
    }
    Some(Network {
        output: format!("token outputs:mtlx:surface.connect = {}", from("Mtlx_Surface")),
        shaders,
    })
}

/// What the surface shader gets: `inputs:…` of its colour, of what passes, of cuts, of normals and of the share that passes;
/// empty without. Told of which of these there are pictures: of colours, normals and what passes.
fn surface_inputs(
    material: &Material,
    translucency: Translucency,
    [has_color, has_normal, has_passing]: [bool; 3],
    from: impl Fn(&str) -> String,
) -> [String; 5] {
    let tinted = [0, 1, 2].map(|i| material.base_color[i] * translucency.tint[i]);
    let either = |is_pictured: bool, input: &str, node: &str, value: String| {
        if is_pictured {
            format!("inputs:{input}.connect = {}", from(node))
        } else {
            format!("inputs:{input} = {value}")
        }
    };
    let line = |is_there: bool, input: &str, node: &str| {
        if is_there { format!("{input}.connect = {}\n        ", from(node)) } else { String::new() }
    };
    let is_cut = material.cutout.is_some() && has_color;
    [
        either(has_color, "base_color", "Mtlx_Rgb", tuple(material.base_color)),
        either(has_color, "subsurface_color", "Mtlx_Through", tuple(tinted)),
        line(is_cut, "color3f inputs:opacity", "Mtlx_Opacity"),
        line(has_normal, "float3 inputs:normal", "Mtlx_Bump"),
        either(has_passing, "subsurface", "Mtlx_Share", translucency.share.to_string()),
    ]
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;

    /// Inputs and outputs of the nodes as `stdlib_defs.mtlx` and `standard_surface.mtlx` of `MaterialX` 1.39.4 define
    /// them, in the types that USD has for theirs.
    const NODES: [(&str, &str, &str); 11] = [
        (
            "ND_standard_surface_surfaceshader",
            "float base, color3f base_color, float metalness, float3 normal, color3f opacity, float \
             specular_roughness, float subsurface, color3f subsurface_color, bool thin_walled",
            "token",
        ),
        ("ND_geompropvalue_vector2", "string geomprop", "float2"),
        (
            "ND_image_color4",
            "asset file, float2 texcoord, string uaddressmode, string vaddressmode",
            "color4f",
        ),
        (
            "ND_image_vector3",
            "asset file, float2 texcoord, string uaddressmode, string vaddressmode",
            "float3",
        ),
        ("ND_convert_color4_color3", "color4f in", "color3f"),
        ("ND_convert_float_color3", "float in", "color3f"),
        ("ND_multiply_color3", "color3f in1, color3f in2", "color3f"),
        ("ND_multiply_float", "float in1, float in2", "float"),
        ("ND_extract_color4", "color4f in, int index", "float"),
        ("ND_ifgreatereq_float", "float value1, float value2, float in1, float in2", "float"),
        ("ND_normalmap_float", "float3 in", "float3"),
    ];

    fn leaf() -> Material {
        let picture = Some(Arc::new(Picture::new(1, 1, vec![255; 4])));
        Material {
            name: "leaves".to_owned(),
            base_color: [0.1, 0.2, 0.05],
            base_color_picture: picture.clone(),
            normal_picture: picture,
            roughness: 0.6,
            double_sided: true,
            cutout: Some(0.5),
            wrap: Wrap::Clamp,
            translucency: Translucency::leaf(0.4),
            passing_picture: None,
        }
    }

    /// Shaders by name: their node, and `type name` of inputs, what each is connected to, and the output's type.
    fn check(network: &Network) {
        let mut outputs = BTreeMap::new();
        let mut connected = BTreeSet::new();
        for shader in network.shaders.split("def Shader \"").skip(1) {
            let name = shader.split('"').next().unwrap();
            let id = shader.split("info:id = \"").nth(1).unwrap().split('"').next().unwrap();
            let (_, inputs, output) = NODES.into_iter().find(|(node, ..)| *node == id).unwrap();
            let known: Vec<&str> = inputs.split(", ").map(str::trim).collect();
            for line in shader.lines().map(str::trim) {
                let Some((kind, rest)) = line.split_once(" inputs:") else { continue };
                let input = rest.split([' ', '.']).next().unwrap();
                assert!(known.contains(&format!("{kind} {input}").as_str()), "{id}: {line}");
                if let Some((_, target)) = rest.split_once(".connect = <") {
                    let target = target.rsplit('/').next().unwrap().split('.').next().unwrap();
                    connected.insert((kind.to_owned(), target.to_owned()));
                }
            }
            assert!(shader.contains(&format!("        {output} outputs:out\n")), "{id}");
            outputs.insert(name.to_owned(), output.to_owned());
        }
        for (kind, target) in connected {
            assert_eq!(outputs.get(&target), Some(&kind), "{target}");
        }
    }

    #[test]
    fn nodes_are_those_of_materialx_and_connections_fit() {
        let leaf = leaf();
        let with = network(&leaf, "/tree/Materials/leaves", |picture| picture.map(|_| "leaves.png")).unwrap();
        check(&with);
        assert!(with.shaders.contains("float inputs:subsurface = 0.4"), "{}", with.shaders);
        assert!(
            with.output.ends_with("</tree/Materials/leaves/Mtlx_Surface.outputs:out>"),
            "{}",
            with.output
        );
        // As much as a picture says, of that.
        let varied = Material { passing_picture: leaf.base_color_picture.clone(), ..leaf.clone() };
        let varied =
            network(&varied, "/tree/Materials/leaves", |picture| picture.map(|_| "leaves.png")).unwrap();
        check(&varied);
        let share = "float inputs:subsurface.connect = </tree/Materials/leaves/Mtlx_Share.outputs:out>";
        assert!(varied.shaders.contains(share) && varied.shaders.contains("float inputs:in2 = 0.4"));
        let without = network(&leaf, "/tree/Materials/leaves", |_| None).unwrap();
        check(&without);
        // What passes is the colour, yellower.
        assert!(without.shaders.contains("color3f inputs:subsurface_color = (0.095, 0.2, 0.025)"));
        assert!(network(&Material { translucency: None, ..leaf }, "/a", |_| None).is_none());
    }
}
