//! The multiscale tree graph, read by a reader written from the format's description (tabs tell which axis
//! bears which; `^` goes on from the last vertex of a column), is the tree: for every built-in preset.

use std::collections::BTreeMap;
use std::fs;

use linden::grow::grow;
use linden::preset::builtins;
use linden::{NO_PARENT, Quiet, Skeleton, Vec3};
use linden_tests::fixtures::{RECIPE, export, scene};
use linden_tests::presets::recipe;

#[derive(Debug)]
struct Internode {
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

/// The axes by their names with the internode that bears each, and all internodes.
fn read(text: &str) -> (Vec<Option<usize>>, Vec<Internode>) {
    assert_eq!(text.lines().find(|line| !line.starts_with('#')), Some("CODE:\tFORM-A"));
    let classes = section(text, "CLASSES:");
    assert_eq!(classes[0], "SYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION");
    let scales: BTreeMap<&str, &str> =
        classes[1..].iter().map(|line| line.split_once('\t').unwrap()).collect();
    assert!(scales["P"].starts_with('1') && scales["A"].starts_with('2') && scales["I"].starts_with('3'));
    let known: Vec<&str> =
        section(text, "FEATURES:")[1..].iter().map(|line| line.split('\t').next().unwrap()).collect();
    let code = section(text, "MTG:");
    let head: Vec<&str> = code[0].split('\t').collect();
    assert_eq!(head[0], "ENTITY-CODE");
    let columns = head.iter().position(|name| known.contains(name)).unwrap();
    assert_eq!(head[columns..], known);

    let (mut axes, mut internodes) = (Vec::new(), Vec::<Internode>::new());
    // By column: the axis there, and its last internode.
    let mut open: Vec<(usize, Option<usize>)> = Vec::new();
    for line in &code[2..] {
        let column = line.len() - line.trim_start_matches('\t').len();
        let fields: Vec<&str> = line.split('\t').collect();
        let entity = fields[column];
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
        let (axis, last) = *open.last().unwrap();
        let joined = if entity.starts_with("^/I") { '+' } else { '<' };
        assert!(entity.starts_with(if last.is_some() { "^<I" } else { "^/I" }), "{line}");
        let below = last.or(axes[axis]).map(|node| (node, joined));
        let features: BTreeMap<String, f64> = (known.iter())
            .zip(&fields[columns..])
            .map(|(name, number)| ((*name).to_owned(), number.parse().unwrap()))
            .collect();
        let [x, y, z] = ["XX", "YY", "ZZ"].map(|name| features[name] as f32);
        open.last_mut().unwrap().1 = Some(internodes.len());
        internodes.push(Internode { axis, below, place: Vec3::new(x, z, -y), features });
    }
    (axes, internodes)
}

fn is_foot(skeleton: &Skeleton, node: u32) -> bool {
    skeleton.parents[node as usize] == NO_PARENT
}

#[test]
fn every_preset_is_its_graph() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.mtg");
    for builtin in builtins() {
        let skeleton = grow(&recipe(builtin), &Quiet).unwrap().skeleton;
        let scene = linden::scene::Scene { skeleton: skeleton.clone(), ..scene(3, 5) };
        export(&scene, "mtg", &[], &target).unwrap();
        let text = fs::read_to_string(&target).unwrap();
        fs::remove_file(&target).unwrap();
        let id = builtin.id;
        assert!(text.lines().any(|line| line.strip_prefix("# recipe: ") == Some(RECIPE)), "{id}");
        let (axes, internodes) = read(&text);
        assert_eq!(internodes.len(), skeleton.segments(), "{id}");
        let of = |internode: &Internode| internode.features["node"] as usize;
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
                None => assert!(is_foot(&skeleton, parent), "{id}"),
            }
        }
        assert_eq!(seen.len(), axes.len(), "{id}");
    }
}
