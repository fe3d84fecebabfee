//! The cylinder table, read as any CSV reader would, is the tree: for every built-in preset.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::fs;
use std::rc::Rc;
use std::sync::Arc;

use linden::skeleton::Forks;
use linden::{DVec3, NO_PARENT, Skeleton};
use linden_tests::fixtures::{RECIPE, export, scene};
use linden_tests::presets::{Plant, plants};

struct Row {
    columns: Rc<HashMap<String, usize>>,
    fields: Vec<f64>,
}

impl Row {
    fn number(&self, column: &str) -> f64 {
        self.fields[self.columns[column]]
    }

    fn index(&self, column: &str) -> usize {
        let number = self.number(column);
        assert_eq!(number.fract(), 0.0, "{column}");
        number as usize
    }

    fn place(&self, column: &str, unit: &str) -> DVec3 {
        DVec3::from(["x", "y", "z"].map(|axis| self.number(&format!("{column}_{axis}{unit}"))))
    }

    fn end(&self) -> DVec3 {
        self.place("start", "_m") + self.place("axis", "") * self.number("length_m")
    }
}

/// Comments, header, rows.
fn read(text: &str) -> (Vec<&str>, Vec<Row>) {
    let comments: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("# ")).collect();
    let mut lines = text.lines().skip(comments.len());
    let header = lines.next().unwrap().split(',').map(str::to_owned);
    let columns: Rc<HashMap<String, usize>> = Rc::new(header.zip(0..).collect());
    let row = |line: &str| {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(fields.len(), columns.len(), "{line}");
        Row { columns: Rc::clone(&columns), fields }
    };
    (comments, lines.map(row).collect())
}

fn table(skeleton: Arc<Skeleton>, options: &[(&str, &str)]) -> String {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.csv");
    let scene = linden::scene::Scene { skeleton, ..scene(3, 5) };
    export(&scene, "qsm", options, &target).unwrap();
    fs::read_to_string(target).unwrap()
}

/// Frusta between the radii of a segment's nodes, a lateral's first as thick as its first node, but where an
/// axis that ended goes on.
fn frusta_m3(skeleton: &Skeleton) -> f64 {
    let mut bases = vec![false; skeleton.positions.len()];
    let forks = Forks::new(skeleton);
    let laterals = (0..).zip(&skeleton.axes).filter(|(_, axis)| axis.parent != NO_PARENT);
    for (_, axis) in laterals.filter(|(index, _)| !forks.runs_on(*index)) {
        bases[skeleton.nodes_of(axis)[0] as usize] = true;
    }
    let of = |node: usize| {
        let parent = skeleton.parents[node] as usize;
        let upper = f64::from(skeleton.radii[node]);
        let lower = if bases[node] { upper } else { f64::from(skeleton.radii[parent]) };
        let length = f64::from(skeleton.positions[node].distance(skeleton.positions[parent]));
        PI / 3.0 * length * (lower * lower + lower * upper + upper * upper)
    };
    (0..skeleton.positions.len()).filter(|&node| skeleton.parents[node] != NO_PARENT).map(of).sum()
}

#[test]
fn every_preset_is_its_table_of_cylinders() {
    let mut several = Vec::new();
    for &Plant { id, ref grown, .. } in plants() {
        let skeleton = &grown.skeleton;
        let text = table(Arc::clone(skeleton), &[]);
        let (comments, rows) = read(&text);
        assert!(comments.iter().any(|line| line.strip_prefix("recipe: ") == Some(RECIPE)));
        assert_eq!(rows.len(), skeleton.segments(), "{id}");
        // Several trees are as many tables, one after the other.
        let trees: Vec<Skeleton> = match skeleton.tree_index() {
            Some(index) => skeleton.split(&index),
            None => vec![Skeleton::clone(skeleton)],
        };
        if trees.len() > 1 {
            several.push((id, trees.len()));
        }
        let tables: Vec<&[Row]> = rows.chunk_by(|a, b| a.index("tree") == b.index("tree")).collect();
        assert_eq!(tables.len(), trees.len(), "{id}");
        for (number, (rows, tree)) in (1..).zip(tables.into_iter().zip(&trees)) {
            assert_eq!(rows[0].index("tree"), number, "{id}");
            check(id, tree, rows);
        }
    }
    // The stems of a stool are one tree.
    assert_eq!(several, [("clipped-arch", 2), ("grove", 3)]);
}

/// The rows of a tree against its skeleton.
fn check(id: &str, skeleton: &Skeleton, rows: &[Row]) {
    let measures = skeleton.measures();
    assert_eq!(rows.len(), skeleton.segments(), "{id}");

    let length: f64 = rows.iter().map(|row| row.number("length_m")).sum();
    assert!((length / measures.total_length_m - 1.0).abs() < 1e-6, "{id}: {length} {measures:?}");
    let volume: f64 = rows
        .iter()
        .map(|row| PI * row.number("radius_m") * row.number("radius_m") * row.number("length_m"))
        .sum();
    for expected in [measures.wood_volume_m3, frusta_m3(skeleton)] {
        assert!((volume / expected - 1.0).abs() < 1e-5, "{id}: {volume} {expected}");
    }
    let order = rows.iter().map(|row| row.index("branch_order")).max().unwrap();
    assert_eq!(order, measures.max_order as usize, "{id}");

    // Nodes are the tree's, and the frusta between both radii hold what the cylinders hold.
    let mut frusta = 0.0;
    for row in rows {
        let (node, parent) = (row.index("node"), row.index("parent_node"));
        assert_eq!(skeleton.parents[node] as usize, parent, "{id}");
        assert_eq!(row.index("parent") == 0, skeleton.parents[parent] == NO_PARENT, "{id}");
        let [lower, upper] = ["start_radius_m", "end_radius_m"].map(|name| row.number(name));
        assert_eq!(upper as f32, skeleton.radii[node], "{id}");
        frusta += PI / 3.0 * row.number("length_m") * (lower * lower + lower * upper + upper * upper);
    }
    assert!((frusta / measures.wood_volume_m3 - 1.0).abs() < 1e-5, "{id}: {frusta}");

    // Each stands on the one that it names, and continues its branch or starts the next order.
    let size = f64::from(skeleton.positions.iter().fold(0.0_f32, |m, p| m.max(p.abs().max_element())));
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row.index("id"), i + 1, "{id}");
        assert!((row.place("axis", "").length() - 1.0).abs() < 1e-5, "{id} {i}");
        let Some(below) = row.index("parent").checked_sub(1).map(|parent| &rows[parent]) else {
            continue;
        };
        assert!(row.index("parent") <= i, "{id}: parents come first");
        assert!(below.end().distance(row.place("start", "_m")) < 1e-5 * (1.0 + size), "{id} {i}");
        let continues = below.index("branch") == row.index("branch");
        let steps = ["branch_order", "position_in_branch"].map(|c| row.number(c) - below.number(c));
        if continues {
            assert_eq!(steps, [0.0, 1.0], "{id} {i}");
        } else {
            assert_eq!((steps[0], row.index("position_in_branch")), (1.0, 1), "{id} {i}");
        }
    }
}

#[test]
fn a_bare_table_starts_with_its_header() {
    let text = table(Arc::clone(&scene(3, 5).skeleton), &[("comments", "false")]);
    assert!(text.starts_with("id,parent,branch,"), "{text}");
    assert!(!text.contains('#'));
}
