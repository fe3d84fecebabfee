//! One wood with the leaves of each season, before the clients.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use linden::Quiet;
use linden::dress::{Year, year};
use linden::grow::grow;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::season::Season;
use linden_tests::fixtures::export_stage;

use crate::outside::{exported, run};

fn tree(knobs: &[(&str, &str)], seasons: &str) -> (Recipe, Year) {
    let mut recipe = builtin("dressed-simple").unwrap().recipe(&Quiet).unwrap();
    let small = [("points", "120"), ("bark_size", "32"), ("leaf_size", "64"), ("card_size", "128")];
    for (knob, value) in small.iter().chain(knobs) {
        recipe.preset.set(knob, value).unwrap();
    }
    let grown = grow(&recipe, &Quiet).unwrap();
    let year = year(&recipe, &grown, &Season::parse_list(seasons).unwrap(), &Quiet).unwrap();
    (recipe, year)
}

/// Triangles of wood and of leaves in a glTF file, as another reader counts them, and all bytes of the
/// wood's positions.
fn counted(file: &Path) -> (usize, usize, Vec<[f32; 3]>) {
    let (document, buffers, _) = gltf::import(file).unwrap();
    let (mut wood, mut leaves, mut points) = (0, 0, Vec::new());
    for mesh in document.meshes() {
        for primitive in mesh.primitives() {
            let triangles = primitive.indices().unwrap().count() / 3;
            if mesh.name().unwrap().contains("_wood") {
                wood += triangles;
                let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()].0[..]));
                points.extend(reader.read_positions().unwrap());
            } else {
                leaves += triangles;
            }
        }
    }
    (wood, leaves, points)
}

#[test]
fn every_season_is_a_variant_with_the_same_wood() {
    for (name, knobs) in [
        ("plain", &[][..]),
        ("levels", &[("lods", "2"), ("lod_ratio", "0.3")]),
        ("budget", &[("triangles", "9000"), ("season", "0.9"), ("branch_cards", "false")]),
        ("cards", &[("triangles", "9000"), ("season", "0.9")]),
    ] {
        let (_, year) = tree(knobs, "flush,summer,autumn,late=0.9,bare");
        let stage = year.stage();
        let dir = exported(&format!("clients-seasons-{name}"));
        let mut expected = serde_json::Map::new();
        let mut woods = Vec::new();
        for (index, (season, _)) in year.seasons.iter().enumerate() {
            let file = dir.join(format!("{}.glb", season.name));
            // Of the finest level alone: what it has without variants.
            let stage = stage.in_season(index).at_level(0);
            export_stage(&stage, "glb", &[], &file).unwrap();
            let (wood, leaves, points) = counted(&file);
            expected.insert(season.name.clone(), [wood, leaves].to_vec().into());
            woods.push(points);
        }
        assert!(woods[0].len() > 500 && woods.iter().all(|wood| *wood == woods[0]), "{name}");
        let leaves = |season: &str| expected[season][1].as_u64().unwrap();
        // Pieces of foliage are as large in all seasons; of small leaves fewer make one.
        let alike = |a: u64, b: u64| if name == "cards" { 3 * a.abs_diff(b) < a } else { a == b };
        assert!(alike(leaves("summer"), leaves("flush")), "{name}");
        assert!(alike(leaves("summer"), leaves("autumn")), "{name}");
        let times = if name == "cards" { 1 } else { 2 };
        assert!(
            leaves("summer") > times * leaves("late") && leaves("late") > 0 && leaves("bare") == 0,
            "{name}"
        );
        let shown = if ["budget", "cards"].contains(&name) { "late" } else { "summer" };
        assert_eq!(year.seasons[0].0.name, shown, "the recipe's own season is chosen");
        expected.insert("chosen".to_owned(), shown.into());
        fs::write(dir.join("expected.json"), serde_json::to_vec(&expected).unwrap()).unwrap();
        for format in ["usda", "usdc", "usdz"] {
            export_stage(&stage, format, &[], &dir.join(format!("tree.{format}"))).unwrap();
        }
        run("crates.py", &dir);
        run("seasons.py", &dir);
        if name != "levels" {
            continue;
        }
        // All validators once, and what is chosen agrees with the format that holds one season.
        for season in year.seasons.iter().skip(1) {
            fs::remove_file(dir.join(format!("{}.glb", season.0.name))).unwrap();
        }
        run("check.py", &dir);
    }
}

/// What each season shows in a GLB: its meshes' names with the positions that they draw, corner by corner.
type Shown = BTreeMap<String, BTreeMap<String, Vec<[f32; 3]>>>;

/// What the nodes of a GLB show, by the season in their extras or in those above (empty without one), and the accessors
/// of wood.
fn shown(glb: &[u8]) -> (Shown, BTreeSet<usize>) {
    let (document, buffers, _) = gltf::import_slice(glb).unwrap();
    let (mut all, mut wood) = (Shown::new(), BTreeSet::new());
    let roots = document.default_scene().unwrap().nodes();
    let mut open: Vec<(gltf::Node<'_>, String)> = roots.map(|node| (node, String::new())).collect();
    while let Some((node, above)) = open.pop() {
        let told = node.extras().as_ref().and_then(|extras| {
            let extras: serde_json::Value = serde_json::from_str(extras.get()).unwrap();
            extras["linden_season"].as_str().map(str::to_owned)
        });
        let season = told.unwrap_or(above);
        open.extend(node.children().map(|child| (child, season.clone())));
        let Some(mesh) = node.mesh() else { continue };
        let name = mesh.name().unwrap();
        let name = if season.is_empty() { name.to_owned() } else { name.replace(&format!("_{season}"), "") };
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()].0[..]));
            let places: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
            let corners = reader.read_indices().unwrap().into_u32().map(|corner| places[corner as usize]);
            all.entry(season.clone()).or_default().entry(name.clone()).or_default().extend(corners);
            if name.contains("_wood") {
                wood.insert(primitive.get(&gltf::Semantic::Positions).unwrap().index());
            }
        }
    }
    (all, wood)
}

#[test]
fn a_page_shows_each_season_as_its_own_file_does_and_holds_the_wood_once() {
    for (knobs, levels) in
        [(&[][..], 1), (&[("lods", "2"), ("lod_ratio", "0.3")], 2), (&[("wind", "bones")], 1)]
    {
        let (_, year) = tree(knobs, "summer,autumn,bare");
        let (stage, dir) = (year.stage(), exported("clients-seasons-page"));
        let (bare, siblings) = (("pictures", "false"), ("lods", "siblings"));
        let page = dir.join("tree.html");
        let options = [bare, siblings, ("quantize", "false"), ("compress", "none")];
        export_stage(&stage, "html", &options, &page).unwrap();
        let text = fs::read_to_string(&page).unwrap();
        assert!(text.contains("seasons=summer,autumn,bare"), "{knobs:?}");
        let (_, rest) = text.split_once("id=\"tree\">").unwrap();
        let glb = BASE64.decode(rest.split_once("</script>").unwrap().0).unwrap();
        let (found, wood) = shown(&glb);
        assert_eq!(found.len(), 3, "{knobs:?}: {:?}", found.keys());
        assert_eq!(wood.len(), levels, "{knobs:?}: wood is in it once a level");
        for (index, (season, _)) in year.seasons.iter().enumerate() {
            let alone = dir.join(format!("{}.glb", season.name));
            export_stage(&stage.in_season(index), "glb", &[bare, siblings], &alone).unwrap();
            let (expected, _) = shown(&fs::read(alone).unwrap());
            assert!(found[&season.name] == expected[""], "{knobs:?} {}", season.name);
        }
    }
}

#[test]
fn a_budget_is_met_in_the_season_with_most_leaves() {
    let (_, year) = tree(&[("triangles", "9000")], "bare,summer,late=0.9");
    let triangles = |name: &str| {
        let (_, levels) = year.seasons.iter().find(|(season, _)| season.name == name).unwrap();
        levels[0].scene.parts.iter().map(|part| part.mesh.triangles.len()).sum::<usize>()
    };
    assert!((8550..=9000).contains(&triangles("summer")), "{}", triangles("summer"));
    assert!(triangles("bare") < triangles("late") && triangles("late") < triangles("summer"));
}

#[test]
fn a_format_that_holds_one_season_says_which_and_writes_no_other() {
    let (recipe, year) = tree(&[], "summer,autumn");
    let stage = year.stage();
    let grown = grow(&recipe, &Quiet).unwrap();
    assert_eq!(stage.recipe, recipe.to_line_of(grown.hash()));
    let dir = exported("clients-one-season");
    let alone = dir.join("alone.glb");
    let both = dir.join("both.glb");
    export_stage(&stage.in_season(0), "glb", &[], &alone).unwrap();
    export_stage(&stage, "glb", &[], &both).unwrap();
    assert!(fs::read(&alone).unwrap() == fs::read(&both).unwrap());
    for format in ["obj", "ply", "glb", "gltf"] {
        let exporter = linden_exporters::find(format).unwrap();
        let options = linden_exporters::Options::new(exporter.format());
        let mut bundle = linden_exporters::Bundle::create(&dir.join(format!("tree.{format}"))).unwrap();
        exporter.write(&stage, &options, &mut bundle, &Quiet).unwrap();
        let [note] = bundle.notes() else { panic!("{format}: {:?}", bundle.notes()) };
        assert!(note.contains("one season") && note.contains("'summer'"), "{note}");
    }
    // A season's file carries the recipe that grows it.
    let autumn = stage.in_season(1);
    let document: serde_json::Value = serde_json::from_str(&autumn.recipe).unwrap();
    assert_eq!(
        document.pointer("/foliage/season").and_then(serde_json::Value::as_f64),
        Some(0.75),
        "{document}"
    );
}
