//! The table of organs, read as any CSV reader would, against the mesh, the instances and the numbers of the same tree.

use std::collections::BTreeMap;
use std::fs;

use linden::dress::dress;
use linden::glam::{Quat, Vec3};
use linden::grow::{Grown, grow};
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden::stage::{Place, Stage};
use linden::{NO_PARENT, Quiet};
use linden_exporters::{Bundle, Options, find};
use linden_tests::fixtures::{export, export_stage};

use crate::instances::dressed;
use crate::mtg::{assert_same, crops};

struct Row {
    kind: String,
    numbers: BTreeMap<String, f64>,
}

impl Row {
    fn number(&self, column: &str) -> f64 {
        self.numbers[column]
    }

    fn position(&self) -> Vec3 {
        Vec3::from(["x_m", "y_m", "z_m"].map(|column| self.number(column) as f32))
    }

    fn turn(&self) -> Quat {
        Quat::from_array(["qx", "qy", "qz", "qw"].map(|column| self.number(column) as f32))
    }

    fn size(&self) -> f32 {
        self.number("size_m") as f32
    }
}

fn text(stage: &Stage<'_>) -> String {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.organs.csv");
    export_stage(stage, "organs", &[], &target).unwrap();
    fs::read_to_string(target).unwrap()
}

fn table(stage: &Stage<'_>) -> Vec<Row> {
    let text = text(stage);
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), header.len(), "{line}");
        let named = || header.iter().zip(&fields);
        let kind = named().find(|(column, _)| **column == "kind").unwrap().1.to_string();
        let numbers = named().filter_map(|(column, field)| Some(((*column).to_owned(), field.parse().ok()?)));
        let numbers: BTreeMap<String, f64> = numbers.collect();
        assert_eq!(numbers.len(), header.len() - 1, "{line}");
        Row { kind, numbers }
    };
    lines.map(row).collect()
}

/// Where a copy stands: moved, turned, and how large it is.
type Placed = (Vec3, Quat, f32);

/// The meshes of a GLB that stand in many places, with their names, vertices and places.
fn instances(scene: &Scene) -> Vec<(String, Vec<Vec3>, Vec<Placed>)> {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.glb");
    export(scene, "glb", &[("instances", "true")], &target).unwrap();
    let bytes = fs::read(&target).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let (json, blob) = (&bytes[20..20 + length], &bytes[28 + length..]);
    let json: serde_json::Value = serde_json::from_slice(json).unwrap();
    let floats = |accessor: &serde_json::Value, width: usize| -> Vec<f32> {
        let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
        assert_eq!(accessor["componentType"], 5126);
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let from: u64 = [view, accessor].iter().map(|of| of["byteOffset"].as_u64().unwrap_or(0)).sum();
        let count = width * accessor["count"].as_u64().unwrap() as usize;
        bytemuck::pod_collect_to_vec(&blob[from as usize..][..4 * count])
    };
    let of_node = |node: &serde_json::Value| {
        let attributes = node.get("extensions")?.get("EXT_mesh_gpu_instancing")?.get("attributes")?;
        let [at, turn, size] = [("TRANSLATION", 3), ("ROTATION", 4), ("SCALE", 3)]
            .map(|(name, width)| floats(&attributes[name], width));
        let place =
            |i: usize| (Vec3::from_slice(&at[3 * i..]), Quat::from_slice(&turn[4 * i..]), size[3 * i]);
        let mesh = &json["meshes"][node["mesh"].as_u64().unwrap() as usize];
        let positions = floats(&mesh["primitives"][0]["attributes"]["POSITION"], 3);
        let positions = positions.chunks(3).map(Vec3::from_slice).collect();
        Some((mesh["name"].as_str().unwrap().to_owned(), positions, (0..at.len() / 3).map(place).collect()))
    };
    json["nodes"].as_array().unwrap().iter().filter_map(of_node).collect()
}

fn check(recipe: &Recipe, grown: &Grown, scene: &Scene) {
    let rows = table(&Stage::of(scene));
    assert_eq!(rows.len(), grown.organs.len());
    let skeleton = &grown.skeleton;
    let mut found: BTreeMap<String, (usize, f64)> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate() {
        let hanging = grown.organs.growth(index);
        let whole = |column: &str| row.number(column) as u32;
        assert_eq!(
            ["id", "node", "birth", "tree"].map(whole),
            [index as u32, hanging.node, hanging.birth, 1],
            "{index}"
        );
        assert!((row.turn().length() - 1.0).abs() < 1e-5, "{index}");
        let sum = found.entry(row.kind.clone()).or_default();
        *sum = (sum.0 + 1, sum.1 + row.number("area_m2"));
    }
    assert_same(&found, &crops(recipe, &grown.organs));

    // An outline is as its corners have it.
    let outlines = rows.iter().filter(|row| row.kind == "polygon").count();
    for (index, area) in grown.organs.areas_m2().into_iter().enumerate().take(outlines) {
        assert!((rows[index].number("area_m2") - area).abs() < 1e-3 * area + 1e-9, "{index}");
        assert_eq!(rows[index].position(), grown.organs.corners_of(index)[0]);
        assert_eq!(rows[index].number("size_m"), 1.0);
    }

    // Every other stands where a copy does, and the copies are all of the mesh that is no outline.
    let copies = instances(scene);
    let mut shapes: Vec<Option<usize>> = vec![None; rows.len()];
    let mut groups: BTreeMap<(&str, u32, [u32; 3]), Vec<usize>> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate().filter(|(_, row)| row.kind != "polygon") {
        // A grammar's shapes are a part for each colour.
        let color = if row.number("variant") == 0.0 {
            ["red", "green", "blue"].map(|column| row.number(column) as u32)
        } else {
            [0; 3]
        };
        groups.entry((&row.kind, row.number("variant") as u32, color)).or_default().push(index);
    }
    assert_eq!(groups.len(), copies.len());
    for (name, group) in &groups {
        let is_same = |&i: &usize| {
            let places: &[Placed] = &copies[i].2;
            // A blossom and a berry may have one place.
            let suffix = if name.1 == 0 { name.0.to_owned() } else { format!("variant_{}", name.1) };
            copies[i].0.ends_with(&format!("_{suffix}"))
                && places.len() == group.len()
                && places.iter().zip(group).all(|((at, turn, size), &row)| {
                    let row = &rows[row];
                    (*at, *turn, *size) == (row.position(), row.turn(), row.size())
                })
        };
        let of = (0..copies.len()).find(is_same).unwrap_or_else(|| panic!("no copies are {name:?}"));
        for &row in group {
            shapes[row] = Some(of);
        }
    }
    // Meshes are called after the plant and the part.
    let part_of = |name: &str| {
        let parts = scene.parts.iter().enumerate().filter(|(_, part)| name.contains(&part.name));
        parts.max_by_key(|(_, part)| part.name.len()).unwrap().0
    };
    let mut next: Vec<usize> = scene.parts.iter().map(|part| part.mesh.positions.len()).collect();
    for &shape in shapes.iter().flatten() {
        next[part_of(&copies[shape].0)] -= copies[shape].1.len();
    }
    for (row, shape) in rows.iter().zip(&shapes) {
        let Some(shape) = shape else { continue };
        let part = part_of(&copies[*shape].0);
        for &local in &copies[*shape].1 {
            let placed = row.position() + row.turn() * (local * row.size());
            let baked = scene.parts[part].mesh.positions[next[part]];
            assert!(
                placed.distance(baked) < 1e-5 * (1.0 + row.size()),
                "{placed} {baked} {} {}",
                row.kind,
                row.size()
            );
            next[part] += 1;
        }
    }
    let ends = scene.parts.iter().map(|part| part.mesh.positions.len());
    assert!(next.into_iter().eq(ends));

    // Leaves stand on the bark of their segment.
    let offset_m =
        recipe.preset.dressing.foliage.kinds().map(|kind| kind.offset_m).fold(0.0, f64::max) as f32;
    for row in rows.iter().filter(|row| row.number("variant") > 0.0) {
        let node = row.number("node") as usize;
        let parent = skeleton.parents[node];
        assert_ne!(parent, NO_PARENT);
        let (a, b) = (skeleton.positions[parent as usize], skeleton.positions[node]);
        let along = ((row.position() - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let thickest = skeleton.radii[node].max(skeleton.radii[parent as usize]);
        assert!(row.position().distance(a.lerp(b, along)) < thickest + offset_m + 1e-4, "{node}");
    }
}

#[test]
fn rows_are_the_organs_of_the_mesh() {
    for settings in [&[][..], &[("leaf_form", "card"), ("season", "0.8")], &[("leaf_form", "twig")]] {
        let (recipe, grown, scene) = dressed(settings);
        check(&recipe, &grown, &scene);
    }
    let (recipe, grown, scene) = crate::foliage::scene();
    assert!(!grown.organs.polygons.ends.is_empty());
    check(&recipe, &grown, &scene);
}

#[test]
fn a_forest_has_the_rows_of_each_tree_where_it_stands() {
    let (_, _, scene) = dressed(&[]);
    let alone = table(&Stage::of(&scene));
    let mut stage = Stage::of(&scene);
    let place = Place { plant: 0, position: Vec3::new(4.0, 0.5, -2.0), turn_rad: 2.0, scale: 1.5 };
    stage.places.push(place);
    let both = table(&stage);
    assert_eq!(both.len(), 2 * alone.len());
    for (row, alone) in both[alone.len()..].iter().zip(&alone) {
        assert_eq!((row.number("tree"), row.number("id")), (2.0, alone.number("id")));
        let local = Vec3::new(0.1, 0.7, -0.2);
        let [placed, before] = [row, alone].map(|row| row.position() + row.turn() * (local * row.size()));
        let moved = place.position + place.rotation() * (before * place.scale);
        assert!(placed.distance(moved) < 1e-4);
        assert!((row.number("area_m2") / alone.number("area_m2") - 2.25).abs() < 1e-4);
    }
}

#[test]
fn a_bare_tree_has_a_header_alone_and_says_so() {
    let (mut recipe, _, _) = dressed(&[]);
    recipe.preset.set("season", "1").unwrap();
    for kind in recipe.preset.dressing.foliage.kinds_mut() {
        kind.evergreen = false;
    }
    let grown = grow(&recipe, &Quiet).unwrap();
    let scene = dress(&recipe, &grown, &Quiet).unwrap();
    let exporter = find("organs").unwrap();
    let dir = tempfile::tempdir().unwrap();
    let mut bundle = Bundle::create(&dir.path().join("bare.organs.csv")).unwrap();
    let mut options = Options::new(exporter.format());
    options.set("comments", "false").unwrap();
    exporter.write(&Stage::of(&scene), &options, &mut bundle, &Quiet).unwrap();
    assert!(bundle.notes()[0].contains("nothing grows on the wood"), "{:?}", bundle.notes());
    let written = bundle.commit().unwrap();
    let text = fs::read_to_string(&written[0].path).unwrap();
    assert!(text.starts_with("id,node,kind,") && text.lines().count() == 1, "{text}");
}

#[test]
fn tables_are_the_same_on_any_number_of_threads() {
    let (_, grown, scene) = dressed(&[("leaves_per_m", "300")]);
    assert!(grown.organs.len() > 10_000, "{}", grown.organs.len());
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| text(&Stage::of(&scene)))
    };
    assert!(with(1) == with(3));
}
