//! `linden scan`: what it writes, what it refuses, and that a tree grows back from it.

use crate::program::Folder;

/// A small tree, and few pulses.
const SMALL: [&str; 7] =
    ["scan", "simple", "--set=points=60", "--step=0.4", "--positions=3", "--beam=0", "--distance=1.5"];

#[test]
fn a_scan_has_its_truth_and_grows_back() {
    let folder = Folder::new();
    let said = folder.run(&[&SMALL[..], &["-o", "scan.ply", "--truth", "truth.csv"]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("from 3 stands"), "{}", said.err);
    assert!(said.out.contains("scan.ply") && said.out.contains("truth.csv"), "{}", said.out);
    let ply = String::from_utf8_lossy(&folder.read("scan.ply")[..1200]).into_owned();
    for line in [
        "property int tree",
        "property uchar part",
        "property int axis",
        "property int order",
        "comment stand 2 at",
    ] {
        assert!(ply.contains(line), "{ply}");
    }
    // The same numbers as the tree has by itself.
    let truth = String::from_utf8(folder.read("truth.csv")).unwrap();
    let rows: Vec<Vec<&str>> = truth.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| -> f64 {
        rows[1][rows[0].iter().position(|found| *found == name).unwrap()].parse().unwrap()
    };
    let stats = folder.run(&["stats", "simple", "--set=points=60", "--json"]).json();
    let of = |name: &str| stats[name].as_f64().unwrap_or_else(|| panic!("{name} in {stats}"));
    assert!((column("height_m") - of("height_m")).abs() < 1e-3);
    let of_classes: f64 = ["0_2cm", "2_5cm", "5_10cm", "10_20cm", "20cm_up"]
        .iter()
        .map(|class| column(&format!("length_{class}_m")))
        .sum();
    assert!((column("length_m") - of_classes).abs() < 0.01);
    assert!((column("length_m") - of("total_length_m")).abs() < 0.01);
    // The points carry no recipe: a tree is grown into them.
    let back = folder.run(&["stats", "scan.ply", "--json"]).json();
    assert_eq!(back["generator"], "scan");
    let (height, truth) = (back["height_m"].as_f64().unwrap(), column("height_m"));
    assert!((height / truth - 1.0).abs() < 0.1, "{height} {truth}");
}

#[test]
fn threads_change_nothing_and_standard_output_is_a_file_too() {
    let folder = Folder::new();
    let on = |threads: &str| {
        let mut command = crate::program::linden();
        command.args(SMALL).args(["-o", "-", "--noise", "5"]).current_dir(folder.path());
        command.env("RAYON_NUM_THREADS", threads).output().unwrap().stdout
    };
    let one = on("1");
    assert!(one.starts_with(b"ply\n") && one.len() > 10_000);
    assert!(one == on("2"));
}

#[test]
fn what_cannot_be_scanned_is_said() {
    let folder = Folder::new();
    for (more, part) in [
        (&["--step", "0", "-o", "a.ply"][..], "--step 0: expected 0.001 to 10 degrees"),
        (&["--positions", "65", "-o", "a.ply"], "--positions 65: expected a whole number from 1 to 64"),
        (&["--noise", "-1", "-o", "a.ply"], "--noise -1: expected 0 to 1000 mm"),
        (&["--beam", "nan", "-o", "a.ply"], "--beam NaN: expected 0 to 100 mrad"),
        (&["-o", "a.obj"], "scans are written as PLY or LAZ"),
        (&["-o", "-", "--truth", "-"], "only one of -o and --truth"),
        (&["--step", "0.001", "--positions", "64", "--distance", "0.1", "-o", "a.ply"], "pulses, more than"),
        (&["-o", "no/such/a.ply"], "--mkdir"),
        (&["--slope", "70", "-o", "a.ply"], "--slope 70: expected -60 to 60 degrees"),
    ] {
        let said = folder.run(&[&["scan", "simple", "--set=points=30"], more].concat());
        assert!(said.code != Some(0) && said.err.contains(part), "{more:?}: {}", said.err);
        assert!(folder.names().is_empty(), "{more:?}");
    }
    for (more, part) in [
        (
            &["--distance=2"][..],
            "--distance is for one tree: the stands of orchard are spread among its trees",
        ),
        (&["--age=0.5"], "--age is for one tree"),
        (&["--set=nothing=1"], "nothing"),
    ] {
        let said = folder.run(&[&["scan", "orchard", "-o", "a.ply"], more].concat());
        assert!(said.code == Some(2) && said.err.contains(part), "{more:?}: {}", said.err);
    }
}
