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
        let [orders, strahler, branches, trees] = ["order", "strahler", "branches", "tree"].map(numbers);
        // Tree by tree, each with its nodes in their order, and its axes from 0.
        let index = skeleton.tree_index();
        assert_eq!(index.as_ref().map_or(1, |index| index.count), if id == "grove" { 3 } else { 1 });
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&node| index.as_ref().map_or(0, |index| index.nodes[node][0]));
        let tree = |&node: &usize| index.as_ref().map_or(1, |index| i64::from(index.nodes[node][0]) + 1);
        assert!(trees.iter().copied().eq(order.iter().map(tree)), "{id}");
        let mut row_of = vec![0; rows.len()];
        for (row, &node) in order.iter().enumerate() {
            row_of[node] = row as i64;
        }

        let mut children: Vec<Vec<usize>> = vec![Vec::new(); rows.len()];
        let mut begun = Vec::new();
        for (node, &parent) in parents.iter().enumerate() {
            let expected = skeleton.parents[order[node]];
            let expected = if expected == NO_PARENT { -1 } else { row_of[expected as usize] };
            assert_eq!(parent, expected, "{id} {node}");
            let own = (axes[node], orders[node], places[node]);
            if parent < 0 {
                assert_eq!((own.1, own.2, branches[node]), (0, 0, 0), "{id} {node}: a foot");
                begun.push((trees[node], own.0));
                continue;
            }
            let below = parent as usize;
            children[below].push(node);
            if branches[node] == 1 {
                begun.push((trees[node], own.0));
                assert_eq!((own.1, own.2), (orders[below] + 1, 1), "{id} {node}: a lateral begins");
            } else {
                assert_eq!(own, (axes[below], orders[below], places[below] + 1), "{id} {node}: it goes on");
            }
        }
        // Each axis begins once, and no node has two successors.
        begun.sort_unstable();
        assert_eq!(begun.len(), skeleton.axes.len(), "{id}");
        for of_tree in begun.chunk_by(|a, b| a.0 == b.0) {
            assert!(of_tree.iter().map(|(_, axis)| *axis).eq(0..of_tree.len() as i64), "{id}");
        }
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
