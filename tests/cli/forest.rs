//! `linden forest`: what stands where, in files as another reader sees them.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::program::{Folder, linden};

/// The document of a GLB.
fn glb(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    assert_eq!(&bytes[16..20], b"JSON");
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Trees of a document: mesh and place.
fn trees(document: &Value) -> Vec<(u64, [f64; 3])> {
    let nodes = document["nodes"].as_array().unwrap();
    let root = &nodes[document["scenes"][0]["nodes"][0].as_u64().unwrap() as usize];
    let children =
        root["children"].as_array().unwrap().iter().map(|index| &nodes[index.as_u64().unwrap() as usize]);
    children
        .map(|node| {
            let at = |axis: usize| node["translation"][axis].as_f64().unwrap_or(0.0); // without one: where its own file has it
            (node["mesh"].as_u64().unwrap(), [at(0), at(1), at(2)])
        })
        .collect()
}

/// Few triangles, and pictures in which nobody looks for anything.
const SMALL: [&str; 8] =
    ["--triangles", "3000", "--set", "bark_size=32", "--set", "leaf_size=32", "--set", "card_size=128"];

/// The file of a small forest, on one thread; on two it is the same.
fn exported(folder: &Folder, line: &[&str]) -> Vec<u8> {
    let export = |threads: &str, name: &str| {
        let run = linden()
            .env("RAYON_NUM_THREADS", threads)
            .args(line)
            .args(SMALL)
            .args(["-o", name])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        folder.read(name)
    };
    let one = export("1", "one.glb");
    assert!(one == export("2", "two.glb"), "one thread and two differ");
    one
}

#[test]
fn kinds_in_a_line_make_a_forest_that_keeps_its_spacing_and_shares() {
    let folder = Folder::new();
    let line = ["forest", "oak:2", "silver-birch:1", "--area", "48", "--spacing", "6.5", "--seed", "5"];
    let one = exported(&folder, &line);
    let document = glb(&one);
    let stand = trees(&document);
    assert!((25..50).contains(&stand.len()), "{}", stand.len());
    for (index, (_, [x, y, z])) in stand.iter().enumerate() {
        assert!(x.abs() <= 24.0 && z.abs() <= 24.0 && *y == 0.0, "on the ground of 48 m");
        for (_, [u, _, w]) in &stand[..index] {
            assert!((x - u).hypot(z - w) >= 6.5 - 1e-4, "{x} {z} and {u} {w}");
        }
    }
    // Each distinct tree is there once, however often it stands.
    let names: Vec<&str> =
        document["meshes"].as_array().unwrap().iter().map(|mesh| mesh["name"].as_str().unwrap()).collect();
    let mut counts = BTreeMap::<&str, usize>::new();
    for (mesh, _) in &stand {
        *counts.entry(names[*mesh as usize]).or_default() += 1;
    }
    assert_eq!((names.len(), counts.len()), (6, 6), "three of each kind: {names:?}");
    let of =
        |kind: &str| counts.iter().filter(|(name, _)| name.contains(kind)).map(|(_, n)| n).sum::<usize>();
    assert!((of("oak") as f64 - stand.len() as f64 * 2.0 / 3.0).abs() <= 1.0, "{counts:?}");
    assert_eq!(of("oak") + of("birch"), stand.len());
    // The budget is that of each distinct tree.
    let triangles = |mesh: &Value| -> u64 {
        let indices = mesh["primitives"]
            .as_array()
            .unwrap()
            .iter()
            .map(|primitive| primitive["indices"].as_u64().unwrap());
        indices.map(|index| document["accessors"][index as usize]["count"].as_u64().unwrap() / 3).sum()
    };
    for mesh in document["meshes"].as_array().unwrap() {
        assert!((2850..=3000).contains(&triangles(mesh)), "{} has {}", mesh["name"], triangles(mesh));
    }
    let other = folder
        .run(&[&["forest", "oak:2", "silver-birch:1", "--seed", "6"][..], &SMALL, &["-o", "x.glb"]].concat());
    assert_eq!(other.code, Some(0), "{}", other.err);
    assert_ne!(trees(&glb(&folder.read("x.glb"))), stand);
}

#[test]
fn the_forests_in_the_program_are_listed_described_and_open() {
    let folder = Folder::new();
    let rows = folder.run(&["list", "--json"]).done().json();
    let ids: Vec<&str> = rows
        .as_array()
        .unwrap()
        .iter()
        .filter(|row| row["generator"] == "forest" && row["group"] == "forests")
        .map(|row| row["id"].as_str().unwrap())
        .collect();
    assert_eq!(ids, ["mixed-wood", "orchard"]);
    let text = folder.run(&["list"]).done().out;
    assert!(text.contains("\nforests, for 'linden forest'\n  mixed-wood "), "{text}");

    for id in ids {
        let shown = folder.run(&["show", id, "--json", "--set", "area=30", "--seed", "4"]).done().json();
        assert_eq!(shown["generator"], "forest");
        assert_eq!(shown["recipe"]["seed"], "4");
        let page = folder.run(&["show", id, "--set", "area=30", "--seed", "4"]).done().out;
        let places = shown["places"].as_u64().unwrap();
        assert!(page.contains(&format!("a forest of {places} trees")), "{page}");
        for tree in shown["trees"].as_array().unwrap() {
            assert!(page.contains(&format!("  {}", tree["id"].as_str().unwrap())), "{page}");
        }
        // What is shown is what stands in the file.
        let args = ["forest", id, "--area", "30", "--seed", "4", "-o", "small.glb"];
        folder.run(&[&args[..], &SMALL].concat()).done();
        let document = glb(&folder.read("small.glb"));
        assert_eq!(trees(&document).len() as u64, places, "{id}");
        assert_eq!(document["meshes"].as_array().unwrap().len() as u64, shown["distinct"].as_u64().unwrap());
        // A document of its own lays out the same.
        folder.write("mine.toml", folder.run(&["show", id, "--toml"]).done().out);
        let again =
            folder.run(&["show", "mine.toml", "--json", "--set", "area=30", "--seed", "4"]).done().json();
        assert_eq!((&again["places"], &again["trees"]), (&shown["places"], &shown["trees"]));
    }
    let said = folder.run(&["export", "orchard", "-o", "x.glb"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("linden forest orchard -o orchard.glb"), "{}", said.err);
}

/// Nobody sets a knob: files that programs open.
#[test]
fn the_mixed_wood_as_it_is_stays_a_file_that_opens() {
    let folder = Folder::new();
    folder.run(&["forest", "mixed-wood", "-o", "wood.glb"]).done();
    let bytes = folder.read("wood.glb");
    assert!(bytes.len() < 100 << 20, "{} bytes", bytes.len());
    let document = glb(&bytes);
    assert_eq!(document["meshes"].as_array().unwrap().len(), 8);
    assert!(trees(&document).len() > 80);
}

#[test]
fn levels_planes_and_wind_have_the_flags_of_exports() {
    let folder = Folder::new();
    let forest = ["forest", "dressed-simple", "--area", "10", "--trees", "2"];
    let flags = ["--lods", "2", "--lod-ratio", "0.3", "--billboard", "--wind", "--set", "billboard_size=64"];
    let by_flags = exported(&folder, &[&forest[..], &flags].concat());
    let set = ["lods=2", "lod_ratio=0.3", "billboard=2", "wind=attributes", "billboard_size=64"];
    let knobs: Vec<&str> = set.iter().flat_map(|pair| ["--set", pair]).collect();
    assert!(by_flags == exported(&folder, &[&forest[..], &knobs].concat()));
    assert!(by_flags != exported(&folder, &forest), "they change something");
}

#[test]
fn trees_that_compete_are_all_different_and_one_growth() {
    let folder = Folder::new();
    let line = ["forest", "dressed-simple", "--area", "24", "--spacing", "6", "--trees", "4", "--compete"];
    let one = exported(&folder, &line);
    let document = glb(&one);
    assert_eq!(trees(&document).len(), 1, "they are one growth");
    let count = |primitive: &Value| {
        let index = primitive["indices"].as_u64().unwrap() as usize;
        document["accessors"][index]["count"].as_u64().unwrap() / 3
    };
    let triangles: u64 = document["meshes"][0]["primitives"].as_array().unwrap().iter().map(count).sum();
    assert!((11_400..=12_000).contains(&triangles), "four times the budget of a tree: {triangles}");
    // The recipe that the file carries makes it again.
    let root = document["scenes"][0]["nodes"][0].as_u64().unwrap() as usize;
    folder.write("again.json", document["nodes"][root]["extras"]["linden"].to_string());
    let said = folder.run(&["forest", "again.json", "-o", "again.glb"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(folder.read("again.glb") == one);
}

/// The trees of a table of cylinders: the middles of their segments, and whether each is on a lateral.
fn stems(table: &[u8]) -> Vec<Vec<([f64; 3], bool)>> {
    let text = std::str::from_utf8(table).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|each| *each == name).unwrap();
    let columns = ["start_x_m", "start_y_m", "start_z_m"].map(column);
    let [id, parent, order, tree] = ["id", "parent", "branch_order", "tree"].map(column);
    let mut of = BTreeMap::new();
    let mut trees: Vec<Vec<([f64; 3], bool)>> = Vec::new();
    for line in lines {
        let row: Vec<&str> = line.split(',').collect();
        let number = match row[parent] {
            "0" => {
                trees.push(Vec::new());
                trees.len() - 1
            }
            below => of[&(row[tree], below)],
        };
        of.insert((row[tree], row[id]), number);
        trees[number].push((columns.map(|column| row[column].parse().unwrap()), row[order] != "0"));
    }
    trees
}

/// Of some trees: the mean height of the bases of their crowns ÷ that of the trees, the mean width of a crown ÷ 2, and
/// the share of all voxels of 1 m with wood in them where two trees have some.
fn crowns(trees: &[Vec<([f64; 3], bool)>]) -> [f64; 3] {
    let mut in_voxels: BTreeMap<[i64; 3], std::collections::BTreeSet<usize>> = BTreeMap::new();
    let [mut bases, mut radii] = [0.0; 2];
    let quantile = |mut values: Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[(values.len() as f64 * share) as usize]
    };
    for (number, tree) in trees.iter().enumerate() {
        for (at, _) in tree {
            in_voxels.entry(at.map(|along| along.floor() as i64)).or_default().insert(number);
        }
        let ([x, _, z], _) = tree[0];
        let laterals: Vec<[f64; 3]> =
            tree.iter().filter(|(_, is_lateral)| *is_lateral).map(|(at, _)| *at).collect();
        let height = tree.iter().map(|(at, _)| at[1]).fold(0.0, f64::max);
        bases += quantile(laterals.iter().map(|at| at[1]).collect(), 0.05) / height;
        radii += quantile(laterals.iter().map(|at| (at[0] - x).hypot(at[2] - z)).collect(), 0.95);
    }
    let shared = in_voxels.values().filter(|trees| trees.len() > 1).count();
    let count = trees.len() as f64;
    [bases / count, radii / count, shared as f64 / in_voxels.len() as f64]
}

#[test]
fn trees_that_compete_for_light_have_longer_boles_and_crowns_that_keep_apart() {
    let folder = Folder::new();
    let line = ["forest", "oak", "--area", "15", "--spacing", "2.5", "--trees", "16", "--set", "years=20"];
    // A table of wood is the same without leaves, which take as long as the growth.
    let rest = ["--set", "epicormic=0", "--size-spread", "0", "--distinct", "16", "--seed", "2"];
    let bare = ["--set", "leaf_form=none", "--set", "bark_size=16", "--triangles", "0"];
    let grown = |name: &str, how: &[&str]| {
        let said = folder.run(&[&line[..], &rest, &bare, how, &["-o", name]].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        stems(&folder.read(name))
    };
    let alone = crowns(&grown("alone.csv", &[]));
    let stand = grown("stand.csv", &["--compete"]);
    assert_eq!(stand.len(), 16);
    let together = crowns(&stand);
    println!("alone {alone:?}, together {together:?}");
    assert!(together[0] > 1.25 * alone[0], "boles: {alone:?} {together:?}");
    assert!(together[1] < 0.8 * alone[1], "widths: {alone:?} {together:?}");
    assert!(together[2] < 0.25 * alone[2], "shared voxels: {alone:?} {together:?}");

    // On one thread and two, as meshes in a file that carries its recipe.
    let line = ["forest", "apple", "--area", "14", "--spacing", "3", "--trees", "9", "--compete"];
    let one = exported(&folder, &line);
    let document = glb(&one);
    assert_eq!(trees(&document).len(), 1, "they are one growth");
    let root = document["scenes"][0]["nodes"][0].as_u64().unwrap() as usize;
    folder.write("again.json", document["nodes"][root]["extras"]["linden"].to_string());
    folder.run(&["forest", "again.json", "-o", "again.glb"]).done();
    assert!(folder.read("again.glb") == one);
}

/// A column of a table, lines with `#` aside.
fn column(table: &[u8], separator: &str, name: &str) -> Vec<String> {
    let text = std::str::from_utf8(table).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let at = lines.next().unwrap().split(separator).position(|found| found == name).unwrap();
    lines.map(|line| line.split(separator).nth(at).unwrap().to_owned()).collect()
}

/// The numbers of a column, each once for each run of rows.
fn runs(table: &[u8], separator: &str, name: &str) -> Vec<usize> {
    let mut all: Vec<usize> =
        column(table, separator, name).iter().map(|field| field.parse().unwrap()).collect();
    all.dedup();
    all
}

/// Hazels have several stems on a stool, which are one tree.
#[test]
fn trees_of_a_stand_are_numbered_in_all_tables_and_scans() {
    let folder = Folder::new();
    folder.write(
        "stand.toml",
        "area = 10\nspacing = 3\ntrees = 5\nseed = 3\ncompete = true\n[[tree]]\npreset = \"so-hazel\"\n\
         set = { years = 5, stems = 3 }\n",
    );
    let tables = ["-o", "a.csv", "-o", "a.organs.csv", "-o", "a.mtg"];
    folder.run(&[&["forest", "stand.toml"][..], &tables].concat()).done();
    let all = folder.read("a.csv");
    let numbers: Vec<usize> = (1..=5).collect();
    assert_eq!(runs(&all, ",", "tree"), numbers);
    // Ids and nodes begin again in each, and so does the parent 0 of what stands on the ground: three stems each.
    let [trees, ids, parents, nodes] = ["tree", "id", "parent", "node"].map(|name| column(&all, ",", name));
    for number in &numbers {
        let rows: Vec<usize> = (0..trees.len()).filter(|&row| trees[row] == number.to_string()).collect();
        for (index, &row) in rows.iter().enumerate() {
            assert_eq!(ids[row], (index + 1).to_string());
        }
        let highest = rows.iter().map(|&row| nodes[row].parse::<usize>().unwrap()).max().unwrap();
        let feet = rows.iter().filter(|&&row| parents[row] == "0").count();
        assert!(feet >= 3 && highest < rows.len() + feet, "{number}: {feet} {highest}");
    }

    // An organ's node is one of its tree, near to where the organ is attached.
    let organs = folder.read("a.organs.csv");
    assert_eq!(runs(&organs, ",", "tree"), numbers);
    let ends: BTreeMap<(String, String), [f64; 3]> = {
        let of = |name: &str| -> Vec<f64> {
            column(&all, ",", name).iter().map(|field| field.parse().unwrap()).collect()
        };
        let start = ["start_x_m", "start_y_m", "start_z_m"].map(of);
        let axis = ["axis_x", "axis_y", "axis_z"].map(of);
        let length = of("length_m");
        let end = |row: usize| [0, 1, 2].map(|i| start[i][row] + axis[i][row] * length[row]);
        (0..trees.len()).map(|row| ((trees[row].clone(), nodes[row].clone()), end(row))).collect()
    };
    let places = ["x_m", "y_m", "z_m"].map(|name| column(&organs, ",", name));
    let keys = column(&organs, ",", "tree").into_iter().zip(column(&organs, ",", "node"));
    for (row, key) in keys.enumerate() {
        // No cylinder ends at a foot.
        let Some(end) = ends.get(&key) else { continue };
        let off = |i: usize| (places[i][row].parse::<f64>().unwrap() - end[i]).abs();
        assert!((0..3).all(|i| off(i) < 0.5), "{key:?}");
    }
    let graph = String::from_utf8(folder.read("a.mtg")).unwrap();
    let plants: Vec<&str> = graph.lines().filter(|line| line.starts_with("/P")).collect();
    assert_eq!(plants.len(), 5);
    assert!(plants.iter().zip(1..).all(|(line, number)| line.starts_with(&format!("/P{number}\t"))));

    let simple = ["-o", "s.csv", "--set", "qsm.dialect=simpleforest", "--set", "qsm.comments=false"];
    folder.run(&[&["forest", "stand.toml"][..], &simple].concat()).done();
    assert_eq!(runs(&folder.read("s.csv"), ", ", "treeID"), numbers);
    // Read again, they are the same trees.
    let said = folder.run(&["export", "s.csv", "-o", "back.csv", "--set", "table_place=true"]);
    assert!(said.code == Some(0) && said.err.contains("s.csv tells 5 trees apart"), "{}", said.err);
    assert_eq!(runs(&folder.read("back.csv"), ",", "tree"), numbers);

    let scan = ["scan", "stand.toml", "-o", "p.ply", "--truth", "truth.csv", "--step", "0.5", "--beam", "0"];
    let said = folder.run(&scan);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let truth = folder.read("truth.csv");
    assert_eq!(runs(&truth, ",", "tree"), numbers);
    // Each has the length of its cylinders, and stands at the foot of one of its stems.
    let lengths = column(&all, ",", "length_m");
    let foot = ["foot_x_m", "foot_z_m"].map(|name| column(&truth, ",", name));
    for (index, length) in column(&truth, ",", "length_m").iter().enumerate() {
        let of_tree = |row: &usize| trees[*row] == (index + 1).to_string();
        let rows: Vec<usize> = (0..trees.len()).filter(of_tree).collect();
        let sum: f64 = rows.iter().map(|&row| lengths[row].parse::<f64>().unwrap()).sum();
        assert!((length.parse::<f64>().unwrap() - sum).abs() < 2e-3, "{length} {sum}");
        let near = |row: &usize| {
            let at =
                ["start_x_m", "start_z_m"].map(|name| column(&all, ",", name)[*row].parse::<f64>().unwrap());
            (0..2).all(|i| (at[i] - foot[i][index].parse::<f64>().unwrap()).abs() < 1e-3)
        };
        assert!(rows.iter().filter(|&&row| parents[row] == "0").any(near), "tree {}", index + 1);
    }
    let said = folder.run(&["scan", "grove", "--distance", "1", "-o", "g.ply", "--step", "2"]);
    assert!(said.code == Some(2) && said.err.contains("--distance is for one tree"), "{}", said.err);
}

#[test]
fn trees_that_died_for_want_of_light_are_told() {
    let folder = Folder::new();
    let line = ["forest", "oak", "--area", "5", "--spacing", "0.5", "--trees", "40", "--compete"];
    let rest = ["--set", "years=28", "--size-spread", "0.4", "-o", "close.csv"];
    let said = folder.run(&[&line[..], &rest].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let left = stems(&folder.read("close.csv")).len();
    assert!((5..38).contains(&left), "{left}");
    let died = format!("{} of 40 trees died in the shade of others", 40 - left);
    assert!(said.err.contains(&died), "{died}: {}", said.err);
    assert!(said.err.contains("size_spread changes nothing"), "{}", said.err);
    let said = folder.run(&["forest", "wp-black-oak", "--compete", "-o", "no.glb"]);
    assert!(said.err.contains("that grows by light, like 'oak'"), "{}", said.err);
}

/// A box as OBJ, its base's middle at `at`, 2 m wide and high.
fn box_at([x, y, z]: [f64; 3]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let on = |bit: u32| f64::from(corner >> bit & 1);
        text += &format!("v {} {} {}\n", x - 1.0 + 2.0 * on(0), y + 2.0 * on(1), z - 1.0 + 2.0 * on(2));
    }
    text + "f 3 4 2 1\nf 6 8 7 5\nf 2 6 5 1\nf 7 8 4 3\nf 5 7 3 1\nf 4 8 6 2\n"
}

/// The box around a GLB's mesh, as its accessor has it.
fn width_of(document: &Value, mesh: u64) -> [f64; 2] {
    let accessor = &document["meshes"][mesh as usize]["primitives"][0]["attributes"]["POSITION"];
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    ["min", "max"].map(|end| accessor[end][0].as_f64().unwrap())
}

#[test]
fn several_meshes_are_a_tree_each_where_their_files_have_them() {
    let folder = Folder::new();
    folder.write("left.obj", box_at([-5.0, 1.0, 0.0]));
    folder.write("right.obj", box_at([6.0, 1.0, 0.0]));
    let knobs = ["--set", "points=300", "--seed", "4", "--set", "bark_size=32"];
    let line = [&["export", "left.obj", "right.obj", "-o", "wood.glb"][..], &knobs].concat();
    folder.run(&line).done();
    let document = glb(&folder.read("wood.glb"));
    let stand = trees(&document);
    assert_eq!(stand.len(), 2);
    for ((mesh, at), middle) in stand.iter().zip([-5.0, 6.0]) {
        assert_eq!(*at, [0.0; 3]);
        let [low, high] = width_of(&document, *mesh);
        assert!(low > middle - 1.3 && high < middle + 1.3 && high > middle && low < middle, "{low} {high}");
    }
    let names: Vec<&str> =
        document["meshes"].as_array().unwrap().iter().map(|mesh| mesh["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["left", "right"]);
    // Each is what it is alone.
    folder.run(&[&["export", "right.obj", "-o", "alone.glb"][..], &knobs].concat()).done();
    let alone = glb(&folder.read("alone.glb"));
    assert_eq!(width_of(&alone, 0), width_of(&document, stand[1].0));
    // What the file carries lays the same trees out again.
    let carried = document["nodes"].as_array().unwrap().iter().map(|node| &node["extras"]["linden"]);
    let carried: Vec<&Value> = carried.filter(|forest| forest["places"] == "given").collect();
    folder.write("again.json", carried[0].to_string());
    folder.run(&["forest", "again.json", "-o", "again.glb"]).done();
    assert!(folder.read("again.glb") == folder.read("wood.glb"), "another forest");
    // The two in one file are two trees, too, in every command.
    let both = box_at([-5.0, 1.0, 0.0]) + &box_at([6.0, 1.0, 0.0]).replace("f ", "f -8 ");
    let both = both.lines().map(|line| match line.strip_prefix("f -8 ") {
        // Counted from the last vertex.
        Some(corners) => {
            let from_last = |n: &str| (n.parse::<i32>().unwrap() - 9).to_string();
            format!("f {}\n", corners.split(' ').map(from_last).collect::<Vec<_>>().join(" "))
        }
        None => format!("{line}\n"),
    });
    folder.write("both.obj", both.collect::<String>());
    let stats = folder.run(&["stats", "both.obj", "--json", "--set", "points=300"]);
    assert!(stats.err.contains("2 shells that stand apart"), "{}", stats.err);
    assert_eq!(stats.code, Some(0));
    let report = stats.json();
    assert_eq!((&report["points"], &report["points_unreached"]), (&600.into(), &0.into()));
    let page = folder.run(&["show", "both.obj"]).done().out;
    assert!(page.contains("both.obj: 24 triangles, 2 shells that stand apart"), "{page}");
}

#[test]
fn what_cannot_stand_side_by_side_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let refused = |args: &[&str], code: i32, said: &[&str]| {
        let run = folder.run(&[&["export"], args, &["-o", "x.glb"]].concat());
        assert_eq!(run.code, Some(code), "{args:?}: {}", run.err);
        assert!(said.iter().all(|said| run.err.contains(said)), "{args:?}: {}", run.err);
    };
    refused(&["fir", "oak"], 1, &["'fir' and 'oak' would stand at the same place", "linden forest"]);
    refused(&["fir", "oak", "--set", "spacing=9"], 2, &["'spacing' has no effect"]);
    refused(&["fir", "oak", "--seasons"], 2, &["--seasons is for one source"]);
    refused(&["fir", "nope"], 2, &["no preset and no file 'nope'"]);
    let share = folder.run(&["forest", "fir:x", "-o", "x.glb"]);
    assert!(share.code == Some(2) && share.err.contains("like fir:3"), "{}", share.err);
    assert!(folder.names().is_empty());
}

#[test]
fn a_forests_picture_shows_its_trees_and_carries_its_recipe_on_any_number_of_threads() {
    let folder = Folder::new();
    let preview = |threads: &str, name: &str, line: &[&str]| {
        let run = linden()
            .env("RAYON_NUM_THREADS", threads)
            .args(["preview", "orchard", "--size", "160x90", "--background", "transparent"])
            .args(line)
            .args(["-o", name])
            .current_dir(folder.path())
            .output()
            .unwrap();
        (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
    };
    let area = ["--set", "area=25", "--set", "bark_size=32", "--set", "leaf_size=32"];
    for (threads, name) in [("1", "one.png"), ("2", "two.png")] {
        let (code, said) = preview(threads, name, &area);
        assert_eq!(code, Some(0), "{said}");
    }
    let one = folder.read("one.png");
    assert!(one == folder.read("two.png"), "one thread and two differ");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&one)).read_info().unwrap();
    let mut seen = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut seen).unwrap();
    let covered = seen.chunks_exact(4).filter(|pixel| pixel[3] > 128).count();
    assert!((500..12_000).contains(&covered), "{covered} of 14400 pixels");
    // The recipe is that of the forest, not of what a picture leaves out of it.
    let again = linden().args(["recipe", "one.png"]).current_dir(folder.path()).output().unwrap();
    let recipe: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!((&recipe["area"], &recipe["triangles"]), (&Value::from("25"), &Value::from("150000")));
    for (line, why) in [
        (&["--look", "turtle"][..], "--look is for one tree"),
        (&["--person"], "--person is for one tree"),
        (&["--lod", "1"], "--lod is for one tree"),
        (&["--set", "area=0"], "area"),
    ] {
        let (code, said) = preview("1", "no.png", line);
        assert!(code == Some(2) && said.contains(why), "{line:?}: {code:?} {said}");
    }
    let (code, said) = preview("1", "no.svg", &[]);
    assert!(code == Some(2) && said.contains("one tree"), "{code:?} {said}");
    assert!(!folder.path().join("no.svg").exists());
}

#[test]
fn notes_on_knobs_know_the_budget_that_large_trees_get() {
    let folder = Folder::new();
    let line = [
        "forest",
        "drawn-oak",
        "simple",
        "--area",
        "12",
        "--spacing",
        "5",
        "--set",
        "points=100",
        "-o",
        "a.glb",
    ];
    let notes = |knob: &str| {
        let said = folder.run(&[&line[..], &SMALL, &["--set", knob]].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.err
    };
    // Cards are for those that have a budget, relief for those that are whole without.
    for knob in ["card_size=256", "bark_relief_height=1"] {
        let said = notes(knob);
        assert!(!said.contains("changes nothing"), "{said}");
    }
    assert!(notes("lod_ratio=0.3").contains("lod_ratio changes nothing: there is one level"));
}

#[test]
fn files_of_a_forest_are_called_by_its_id() {
    let folder = Folder::new();
    let text = |id: &str| format!("{id}area = 12\n[[tree]]\npreset = \"fir\"\nset = {{ points = 60 }}\n");
    folder.write("park.toml", text("id = \"garden\"\n"));
    folder.write("yard.toml", text(""));
    for (file, expected) in [("park.toml", "garden.glb"), ("yard.toml", "yard.glb")] {
        let said = folder.run(&[&["forest", file, "--format", "glb"], &SMALL[..]].concat());
        assert!(said.code == Some(0) && said.out.contains(expected), "{}{}", said.out, said.err);
    }
}

/// What frames all of a scene wants to see its trees: the ground reaches to the horizon.
#[test]
fn the_box_of_a_scene_is_that_of_its_plants() {
    let folder = Folder::new();
    let args = ["dressed-simple", "--trees", "3", "--area", "20", "--scene", "-o", "f.usda"];
    folder.run(&[&["forest"], &args[..], &SMALL].concat()).done();
    let text = String::from_utf8(folder.read("f.usda")).unwrap();
    let (_, hint) = text.split_once("float3[] extentsHint = [").unwrap();
    let (hint, _) = hint.split_once(']').unwrap();
    let numbers: Vec<f64> =
        hint.split(|c: char| "(), ".contains(c)).filter_map(|number| number.parse().ok()).collect();
    assert_eq!(numbers.len(), 6, "{hint}");
    assert!(numbers.iter().all(|metres| metres.abs() < 30.0) && numbers[4] > 2.0, "{hint}");
}

#[test]
fn a_table_says_where_each_tree_stands() {
    let folder = Folder::new();
    let line = ["forest", "oak", "silver-birch", "--area", "40", "--table", "wood.csv"];
    let document = glb(&exported(&folder, &line));
    let table = String::from_utf8(folder.read("wood.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["x", "y", "z", "turn", "scale", "source", "name", "mesh"]);
    let stand = trees(&document);
    assert_eq!(rows.len() - 1, stand.len());
    for (row, (mesh, at)) in rows[1..].iter().zip(stand) {
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        for (column, at) in at.into_iter().enumerate() {
            assert!((number(column) - at).abs() < 1e-5, "{row:?}");
        }
        assert_eq!(document["meshes"][mesh as usize]["name"], row[6]);
        assert_eq!(number(7), mesh as f64);
        assert!(
            ["oak", "silver-birch"].contains(&row[5]) && number(4) > 0.5 && number(3).abs() <= 360.0,
            "{row:?}"
        );
    }
}
