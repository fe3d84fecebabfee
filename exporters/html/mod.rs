//! A page that shows a tree in any browser, without the net: all is in it.
//!
//! A GLB as base64, and three.js with the viewer, packed by gzip, which browsers unpack themselves
//! (`DecompressionStream`). `viewer/bundle.sh` makes the latter of its npm package. The recipe is the one line that
//! starts with `<script type="application/json" id="recipe">`.

use std::io;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use linden_pipeline::Monitor;
use linden_pipeline::stage::Stage;

use crate::gltf::{self, Base64, Binary};
use crate::markup::escaped;
use crate::options::{OptionSpec, Options};
use crate::writing::fit;
use crate::{Amounts, Bundle, ExportError, Exporter, Format, GENERATOR, Holds, Readable, Traces, recipe};

/// A web page.
pub(crate) struct Html;

/// three.js 0.187 (MIT) with `viewer/viewer.mjs`, by gzip.
const VIEWER: &[u8] = include_bytes!("viewer/viewer.js.gz");

static FORMAT: Format = Format {
    id: "html",
    name: "Web page",
    extensions: &["html", "htm"],
    media_type: "text/html",
    self_contained: true,
    help: "a page that shows the tree in any browser, offline: turned, in wind, in each season and level, light or dark",
    options: &[
        OptionSpec::switch("pictures", true, "with bark pictures; without, one colour"),
        OptionSpec::choice(
            "picture_format",
            &["webp", "jpeg", "png"],
            "webp without loss; jpeg: colours of bark with some loss, in a fifth of the bytes",
        ),
        OptionSpec::switch(
            "instances",
            false,
            "leaves as few meshes in many places: a fraction of the bytes",
        ),
        OptionSpec::switch("quantize", true, "vertices in fewer bits; those that sway have all of them"),
        OptionSpec::choice(
            "compress",
            &["meshopt", "none"],
            "meshopt: vertices and indices in fewer bytes, without loss",
        ),
        OptionSpec::choice(
            "lods",
            &["siblings", "files"],
            "levels of detail: to choose from in the page; or a page each",
        ),
    ],
    holds: Holds { setting: false, translucency: false, ..Holds::SCENE },
    levels_by: None,
    encoding: gltf::encoding,
    estimate: Some(estimate),
};

fn estimate(amounts: &Amounts, options: &Options) -> u64 {
    // Packed meshes leave pictures the largest part: those of cards stay PNG, which JPEG's mean is low for.
    let more = if options.is_word("picture_format", "jpeg") { 1.08 } else { 1.0 };
    let tree = (gltf::estimate(amounts, options) as f64 * more) as u64;
    (tree + VIEWER.len() as u64).div_ceil(3) * 4 + amounts.recipe_bytes + 2600
}

const RECIPE: &str = "<script type=\"application/json\" id=\"recipe\">";
const OPTIONS: &str = "<meta name=\"linden-options\" content=\"";
/// What names the seasons of a page behind its options, where it has several.
const SEASONS: &str = "seasons";

impl Exporter for Html {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        if !recipe::begins(file, b"<!DOCTYPE html>\n")? {
            return Ok(None);
        }
        let found = recipe::line_behind(file, RECIPE)?;
        Ok(found.and_then(|line| Some(line.strip_suffix("</script>")?.replace("\\u003c", "<"))))
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        let mut traces = Traces::none(&FORMAT);
        let told = recipe::line_behind(file, OPTIONS)?.unwrap_or_default();
        for (name, value) in told.trim_end_matches("\">").split(' ').filter_map(|word| word.split_once('=')) {
            match name {
                SEASONS => traces.seasons = true,
                _ => traces = traces.with(name, value),
            }
        }
        Ok(traces)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let mut stage = fit(stage, &FORMAT, bundle);
        stage.setting = None;
        let (name, recipe) = recipe::of_stage(&stage);
        let head = head(name, recipe, options, &stage);
        let tree = Binary::new(&stage, FORMAT.id, options, bundle, monitor)?;
        let foot = foot();
        let bytes = head.len() as u64 + tree.bytes().div_ceil(3) * 4 + foot.len() as u64;
        bundle.write_main(Some(bytes), monitor, |out| {
            out.write(head.as_bytes())?;
            let mut encoder = Base64::new(out);
            tree.write(&mut encoder)?;
            encoder.finish()?;
            out.write(foot.as_bytes())
        })
    }
}

fn head(name: &str, recipe: &str, options: &Options, stage: &Stage<'_>) -> String {
    let title = escaped(&linden_pipeline::knob::printable(name));
    let mut told: Vec<String> = options.iter().map(|(name, value)| format!("{name}={value}")).collect();
    if let Some(plant) = stage.plants.iter().find(|plant| plant.seasons.len() > 1) {
        let names: Vec<&str> = plant.seasons.iter().map(|season| season.name.as_str()).collect();
        told.push(format!("{SEASONS}={}", escaped(&names.join(","))));
    }
    // Nothing in a script may look like its end.
    let recipe = recipe.replace('<', "\\u003c");
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="{}">
{OPTIONS}{}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
{RECIPE}{recipe}</script>
<style>
:root {{ color-scheme: light dark; --ink: #24292e; --paper: #e9ecef; }}
[data-theme=dark] {{ --ink: #dfe4e2; --paper: #15181a; }}
body {{ margin: 0; overflow: hidden; background: var(--paper); color: var(--ink); font: 15px system-ui, sans-serif; }}
canvas {{ display: block; width: 100vw; height: 100vh; touch-action: none; }}
h1 {{ position: fixed; left: 16px; top: 12px; margin: 0; font-size: 17px; font-weight: 600; pointer-events: none; }}
p {{ position: fixed; left: 16px; top: 36px; margin: 0; }}
nav {{ position: fixed; left: 12px; bottom: 12px; display: flex; flex-wrap: wrap; gap: 6px; }}
button {{ font: inherit; color: inherit; background: transparent; border: 1px solid currentColor; border-radius: 6px; padding: 4px 10px; opacity: .75; }}
button[aria-pressed=true] {{ background: var(--ink); color: var(--paper); opacity: 1; }}
</style>
</head>
<body>
<canvas aria-label="{title}"></canvas>
<h1>{title}</h1>
<p></p>
<nav></nav>
<script type="application/base64" id="tree">"#,
        escaped(GENERATOR),
        told.join(" "),
    )
}

fn foot() -> String {
    format!(
        r#"</script>
<script>
// three.js and the viewer, packed.
const packed = Uint8Array.from(atob("{}"), (letter) => letter.charCodeAt(0));
new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text().then((text) => {{
  const script = document.createElement("script");
  script.textContent = text;
  document.body.append(script);
}});
</script>
</body>
</html>
"#,
        STANDARD.encode(VIEWER)
    )
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use linden_pipeline::Quiet;
    use linden_pipeline::dress::dress;
    use linden_pipeline::grow::grow;
    use linden_pipeline::preset::builtin;
    use linden_pipeline::recipe::Recipe;

    use super::*;

    fn written(id: &str, options: &[(&str, &str)]) -> (String, Vec<u8>) {
        let mut preset = builtin("older-f").unwrap().load().unwrap();
        "A </script> & tree".clone_into(&mut preset.name);
        let recipe = Recipe::new(preset);
        let scene = dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap();
        let exporter = crate::find(id).unwrap();
        let mut values = Options::new(exporter.format());
        for (name, value) in options {
            values.set(name, value).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("tree.any");
        let mut bundle = Bundle::create(&target).unwrap();
        exporter.write(&Stage::of(&scene), &values, &mut bundle, &Quiet).unwrap();
        bundle.commit().unwrap();
        (scene.recipe, std::fs::read(target).unwrap())
    }

    #[test]
    fn a_page_holds_the_glb_its_recipe_and_its_options() {
        let same = [("quantize", "true"), ("compress", "meshopt"), ("picture_format", "jpeg")];
        let (recipe, page) = written("html", &[("picture_format", "jpeg")]);
        let text = String::from_utf8(page.clone()).unwrap();
        let (_, rest) = text.split_once("id=\"tree\">").unwrap();
        let (tree, _) = rest.split_once("</script>").unwrap();
        assert!(STANDARD.decode(tree).unwrap() == written("glb", &same).1);
        assert_eq!(Html.recipe(&mut Cursor::new(&page)).unwrap(), Some(recipe));
        let traces = Html.traces(&mut Cursor::new(&page)).unwrap();
        assert!(traces.options[0].is_word("picture_format", "jpeg") && traces.options[0].is_on("quantize"));
        assert!(text.contains("<title>A &lt;/script&gt; &amp; tree</title>"));
        assert_eq!(text.matches("</script>").count(), 3, "the recipe ends no script");
    }
}
