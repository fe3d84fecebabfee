//! The multiscale tree graph, read by a reader written from the format's description (tabs tell which axis
//! bears which; `^` goes on from the last vertex of a column), is the tree: for every built-in preset.

use std::collections::BTreeMap;
use std::fs;

use linden::canopy::canopy;
use linden::foliage::Organs;
use linden::recipe::Recipe;
use linden::{NO_PARENT, Quiet, Skeleton, Vec3};
use linden_tests::fixtures::{RECIPE, export, scene};
use linden_tests::presets::{Plant, plants};

#[derive(Debug)]
struct Internode {
    /// Counted from 0.
    plant: usize,
    axis: usize,
    /// The internode below, of any axis, and how it is joined to that.
    below: Option<(usize, char)>,
    place: Vec3,
    features: BTreeMap<String, f64>,
}

/// What stands under a heading.
fn section<'a>(text: &'a str, heading: &str) -> Vec<&'a str> {
    let lines = text.lines().skip_while(|line| *line != heading).skip(1);
    lines.take_while(|line| !line.is_empty()).collect()
}

#[derive(Debug)]
struct Organ {
    class: char,
    kind: String,
    /// The internode that it is joined to.
    bearer: usize,
    features: BTreeMap<String, f64>,
}

/// The axes by their names with the internode that bears each, all internodes, and all organs.
fn read(text: &str) -> (Vec<Option<usize>>, Vec<Internode>, Vec<Organ>) {
    assert_eq!(text.lines().find(|line| !line.starts_with('#')), Some("CODE:\tFORM-A"));
    let classes = section(text, "CLASSES:");
    assert_eq!(classes[0], "SYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION");
    let scales: BTreeMap<&str, &str> =
        classes[1..].iter().map(|line| line.split_once('\t').unwrap()).collect();
    for (class, scale) in [('P', 1), ('A', 2), ('I', 3), ('L', 3), ('B', 3), ('F', 3)] {
        assert!(scales[&*class.to_string()].starts_with(&scale.to_string()), "{class}");
    }
    let known: Vec<&str> =
        section(text, "FEATURES:")[1..].iter().map(|line| line.split('\t').next().unwrap()).collect();
    let code = section(text, "MTG:");
    let head: Vec<&str> = code[0].split('\t').collect();
    assert_eq!(head[0], "ENTITY-CODE");
    let columns = head.iter().position(|name| known.contains(name)).unwrap();
    assert_eq!(head[columns..], known);

    let (mut axes, mut internodes, mut organs) = (Vec::new(), Vec::<Internode>::new(), Vec::new());
    let number = |name: &str, text: &str| Some((name.to_owned(), text.parse().ok()?));
    // By column: the axis there, and its last internode.
    let mut open: Vec<(usize, Option<usize>)> = Vec::new();
    let mut plant = 0;
    assert!(code[1].starts_with("/P1\t"));
    for line in &code[2..] {
        let column = line.len() - line.trim_start_matches('\t').len();
        let fields: Vec<&str> = line.split('\t').collect();
        let entity = fields[column];
        if let Some(number) = entity.strip_prefix("/P") {
            plant += 1;
            assert_eq!(number.parse(), Ok(plant + 1));
            open.clear();
            continue;
        }
        open.truncate(column);
        if let Some(number) = entity.strip_prefix("+A").or(entity.strip_prefix("/A")) {
            number.parse::<u32>().unwrap();
            open.truncate(column - 1);
            let bearer = open.last().and_then(|&(_, last)| last);
            assert_eq!(entity.starts_with('+'), bearer.is_some(), "{line}");
            open.push((axes.len(), None));
            axes.push(bearer);
            continue;
        }
        let features: BTreeMap<String, f64> =
            known.iter().zip(&fields[columns..]).filter_map(|(name, text)| number(name, text)).collect();
        if let Some(class) =
            ["+L", "+B", "+F"].iter().find_map(|class| entity.strip_prefix(*class).and(class.chars().last()))
        {
            // In the column to the right of what bears it.
            open.truncate(column - 1);
            let bearer = open.last().and_then(|&(_, last)| last).unwrap();
            let kind = fields[columns + known.iter().position(|name| *name == "kind").unwrap()].to_owned();
            organs.push(Organ { class, kind, bearer, features });
            continue;
        }
        let (axis, last) = *open.last().unwrap();
        let joined = if entity.starts_with("^/I") { '+' } else { '<' };
        assert!(entity.starts_with(if last.is_some() { "^<I" } else { "^/I" }), "{line}");
        let below = last.or(axes[axis]).map(|node| (node, joined));
        let [x, y, z] = ["XX", "YY", "ZZ"].map(|name| features[name] as f32);
        open.last_mut().unwrap().1 = Some(internodes.len());
        internodes.push(Internode { plant, axis, below, place: Vec3::new(x, z, -y), features });
    }
    (axes, internodes, organs)
}

fn is_foot(skeleton: &Skeleton, node: u32) -> bool {
    skeleton.parents[node as usize] == NO_PARENT
}

#[test]
fn every_preset_is_its_graph() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.mtg");
    for &Plant { id, ref grown, .. } in plants() {
        let skeleton = &grown.skeleton;
        let scene = linden::scene::Scene { skeleton: skeleton.clone(), ..scene(3, 5) };
        export(&scene, "mtg", &[], &target).unwrap();
        let text = fs::read_to_string(&target).unwrap();
        fs::remove_file(&target).unwrap();
        assert!(text.lines().any(|line| line.strip_prefix("# recipe: ") == Some(RECIPE)), "{id}");
        let (axes, internodes, organs) = read(&text);
        assert!(organs.is_empty(), "{id}");
        assert_eq!(internodes.len(), skeleton.segments(), "{id}");
        // Nodes are numbered anew in each of several trees.
        let index = skeleton.tree_index();
        let names: BTreeMap<[u32; 2], usize> = match &index {
            Some(index) => index.nodes.iter().copied().zip(0..).collect(),
            None => (0..skeleton.parents.len()).map(|node| ([0, node as u32], node)).collect(),
        };
        let of = |internode: &Internode| names[&[internode.plant as u32, internode.features["node"] as u32]];
        let plants = internodes.last().unwrap().plant + 1;
        assert_eq!(plants, index.as_ref().map_or(1, |index| index.count), "{id}");
        let mut axis_of = vec![usize::MAX; skeleton.parents.len()];
        for (index, axis) in skeleton.axes.iter().enumerate() {
            skeleton.nodes_of(axis).iter().for_each(|&node| axis_of[node as usize] = index);
        }
        let mut seen = BTreeMap::new();
        for internode in &internodes {
            let node = of(internode);
            assert_eq!(internode.place, skeleton.positions[node], "{id}");
            let number = |name: &str| internode.features[name];
            assert_eq!(number("radius") as f32, skeleton.radii[node], "{id}");
            assert_eq!(number("birth") as u32, skeleton.births[node], "{id}");
            assert_eq!(number("order") as u32, skeleton.axes[axis_of[node]].order, "{id}");
            // One axis there is one axis here.
            assert_eq!(*seen.entry(internode.axis).or_insert(axis_of[node]), axis_of[node], "{id}");
            let parent = skeleton.parents[node];
            match internode.below {
                Some((below, joined)) => {
                    assert_eq!(of(&internodes[below]), parent as usize, "{id}");
                    let continues = axis_of[parent as usize] == axis_of[node];
                    assert_eq!(joined == '<', continues, "{id}");
                }
                None => assert!(is_foot(skeleton, parent), "{id}"),
            }
        }
        assert_eq!(seen.len(), axes.len(), "{id}");
    }
}

/// What [`canopy`] counts and measures of each kind.
pub fn crops(recipe: &Recipe, organs: &Organs) -> BTreeMap<String, (usize, f64)> {
    let canopy = recipe.with_specimen(|specimen| canopy(specimen, organs, 0.0, &Quiet)).unwrap();
    let mut crops: BTreeMap<String, (usize, f64)> = BTreeMap::new();
    for crop in canopy.crops {
        let sum = crops.entry(crop.name).or_default();
        *sum = (sum.0 + crop.organs, sum.1 + crop.area_m2);
    }
    crops
}

/// Whether counts are equal and areas nearly so.
pub fn assert_same(found: &BTreeMap<String, (usize, f64)>, expected: &BTreeMap<String, (usize, f64)>) {
    assert!(!expected.is_empty() && found.keys().eq(expected.keys()), "{found:?} {expected:?}");
    for (kind, (count, area)) in expected {
        assert_eq!(found[kind].0, *count, "{kind}");
        assert!((found[kind].1 - area).abs() < 1e-4 * area, "{kind}: {} {area}", found[kind].1);
    }
}

#[test]
fn organs_are_joined_to_the_internodes_that_bear_them() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.mtg");
    for (recipe, grown, scene) in [crate::foliage::scene(), crate::instances::dressed(&[])] {
        let skeleton = &grown.skeleton;
        export(&scene, "mtg", &[], &target).unwrap();
        let (_, internodes, organs) = read(&fs::read_to_string(&target).unwrap());
        assert_eq!(internodes.len(), skeleton.segments());
        let mut found: BTreeMap<String, (usize, f64)> = BTreeMap::new();
        let mut seen = vec![false; grown.organs.len()];
        for Organ { class, kind, bearer, features } in &organs {
            let sum = found.entry(kind.clone()).or_default();
            *sum = (sum.0 + 1, sum.1 + features["area"]);
            let expected = match kind.as_str() {
                "blossom" => 'B',
                "berry" | "fruit" => 'F',
                _ => 'L',
            };
            assert_eq!(*class, expected, "{kind}");
            let organ = features["organ"] as usize;
            assert!(!std::mem::replace(&mut seen[organ], true), "once");
            let hanging = grown.organs.growth(organ);
            assert_eq!(features["node"] as u32, hanging.node);
            assert_eq!(features["birth"] as u32, hanging.birth);
            // Its internode ends at its node; the lowest begins at a foot.
            let node = internodes[*bearer].features["node"] as u32;
            let begins = skeleton.parents[node as usize];
            assert!(node == hanging.node || is_foot(skeleton, begins) && begins == hanging.node);
            if let Some(placed) = organ.checked_sub(grown.organs.polygons.ends.len()) {
                let [x, y, z] = ["XX", "YY", "ZZ"].map(|name| features[name] as f32);
                assert_eq!(Vec3::new(x, z, -y), grown.organs.placed.positions[placed]);
                assert_eq!(features["length"] as f32, grown.organs.placed.sizes_m[placed]);
                // Its frame: along it, and out of its upper side.
                let (headings, ups) = (&grown.organs.placed.headings, &grown.organs.placed.ups);
                for (names, expected) in [(["dx", "dy", "dz"], headings), (["nx", "ny", "nz"], ups)] {
                    let [x, y, z] = names.map(|name| features[name] as f32);
                    assert!(expected[placed].distance(Vec3::new(x, z, -y)) < 1e-4);
                }
            }
        }
        assert_same(&found, &crops(&recipe, &grown.organs));

        // Without them the wood is the same.
        export(&scene, "mtg", &[("organs", "false")], &target).unwrap();
        let (_, wood, none) = read(&fs::read_to_string(&target).unwrap());
        assert!(none.is_empty());
        let joined = |internodes: &[Internode]| -> Vec<_> {
            internodes.iter().map(|internode| (internode.axis, internode.below, internode.place)).collect()
        };
        assert_eq!(joined(&wood), joined(&internodes));
    }
}
