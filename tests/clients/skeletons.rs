//! The skeleton as PLY: axes, orders and relations follow from their definitions.

use std::fs;

use linden::grow::grow;
use linden::preset::builtin;
use linden::{NO_PARENT, Quiet};
use linden_tests::fixtures::{export, scene};
use linden_tests::presets::recipe;

/// The rows of the vertices by the names of their properties, and the edges.
fn read(text: &str) -> (Vec<Vec<f64>>, Vec<[usize; 2]>, Vec<String>) {
    let (head, body) = text.split_once("end_header\n").unwrap();
    let vertex = head.split("element ").find(|element| element.starts_with("vertex ")).unwrap();
    let count: usize = vertex.lines().next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
    let names = vertex.lines().skip(1).map(|line| line.split(' ').next_back().unwrap().to_owned()).collect();
    let row = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
    let edge = |line: &str| {
        <[usize; 2]>::try_from(row(line).iter().map(|&n| n as usize).collect::<Vec<_>>()).unwrap()
    };
    (body.lines().take(count).map(row).collect(), body.lines().skip(count).map(edge).collect(), names)
}

#[test]
fn topology_follows_from_parents_and_relations() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.ply");
    for id in [
        "simple",
        "grove",
        "abop-a",
        "abop-c",
        "abop-honda-b",
        "abop-ternary-b",
        "older-shrub",
        "weeping-birch",
    ] {
        let skeleton = grow(&recipe(builtin(id).unwrap()), &Quiet).unwrap().skeleton;
        let scene = linden::scene::Scene { skeleton: skeleton.clone(), ..scene(3, 5) };
        export(&scene, "ply-skeleton", &[("encoding", "ascii")], &target).unwrap();
        let (rows, edges, names) = read(&fs::read_to_string(&target).unwrap());
        assert_eq!(rows.len(), skeleton.positions.len(), "{id}");
        let column = |name: &str| names.iter().position(|known| known == name).unwrap();
        let numbers = |name: &str| -> Vec<i64> { rows.iter().map(|row| row[column(name)] as i64).collect() };
        let [parents, axes, places] = ["parent", "axis", "position_in_axis"].map(numbers);
        let [orders, strahler, branches] = ["order", "strahler", "branches"].map(numbers);
        assert!(numbers("tree").iter().all(|&tree| tree == 1), "{id}");

        let mut children: Vec<Vec<usize>> = vec![Vec::new(); rows.len()];
        let mut begun = Vec::new();
        for (node, &parent) in parents.iter().enumerate() {
            let expected = skeleton.parents[node];
            assert_eq!(parent, if expected == NO_PARENT { -1 } else { i64::from(expected) }, "{id} {node}");
            let own = (axes[node], orders[node], places[node]);
            if parent < 0 {
                assert_eq!((own.1, own.2, branches[node]), (0, 0, 0), "{id} {node}: a foot");
                begun.push(own.0);
                continue;
            }
            let below = parent as usize;
            children[below].push(node);
            if branches[node] == 1 {
                begun.push(own.0);
                assert_eq!((own.1, own.2), (orders[below] + 1, 1), "{id} {node}: a lateral begins");
            } else {
                assert_eq!(own, (axes[below], orders[below], places[below] + 1), "{id} {node}: it goes on");
            }
        }
        // Each axis begins once, and no node has two successors.
        begun.sort_unstable();
        assert!(begun.iter().copied().eq(0..skeleton.axes.len() as i64), "{id}");
        for (node, children) in children.iter().enumerate().rev() {
            assert!(children.iter().filter(|&&child| branches[child] == 0).count() <= 1, "{id} {node}");
            let mut above: Vec<i64> = children.iter().map(|&child| strahler[child]).collect();
            above.sort_unstable();
            let expected = match above[..] {
                [] => 1,
                [.., second, first] if second == first => first + 1,
                [.., first] => first,
            };
            assert_eq!(strahler[node], expected, "{id} {node}");
        }
        let joined = parents.iter().enumerate().filter(|(_, parent)| **parent >= 0);
        assert!(edges.iter().copied().eq(joined.map(|(node, &parent)| [parent as usize, node])), "{id}");
    }
}
