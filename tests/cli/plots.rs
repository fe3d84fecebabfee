//! `linden export PLOT -o FOLDER/`: a scan, or a table of cylinders, that tells several trees apart.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use linden::Quiet;
use linden::input::read_ply_with;

use crate::program::Folder;

/// Trees with their numbers, and where they stand in a survey: east and north, metres.
const TREES: [(&str, u32, [f64; 2]); 2] = [("abop-honda-a", 7, [0.0, 0.0]), ("simple", 21, [9.0, -4.5])];

/// The survey's corner.
const CORNER: [f64; 3] = [446_000.0, 5_428_000.0, 300.0];

/// A table of points of [`TREES`] with a column `treeID`, and ground that belongs to none.
fn plot(folder: &Folder) -> String {
    let mut text = "x,y,z,intensity,treeID\n".to_owned();
    for (preset, number, [east, north]) in TREES {
        let file = format!("{preset}.ply");
        succeed(folder, &["scan", preset, "--step=0.5", "--positions=3", "-o", &file]);
        let (data, _) = read_ply_with(&folder.read(&file), &[], &Quiet).unwrap();
        for p in data.positions {
            let [x, y, z] = [CORNER[0] + east + p.x, CORNER[1] + north - p.z, CORNER[2] + p.y];
            let _ = writeln!(text, "{x:.4},{y:.4},{z:.4},0.5,{number}");
        }
    }
    for i in 0..400 {
        let (x, y) = (f64::from(i % 20) - 5.0, f64::from(i / 20) - 10.0);
        let _ = writeln!(text, "{},{},{},0.5,0", CORNER[0] + x, CORNER[1] + y, CORNER[2]);
    }
    text
}

/// Runs what may say something on standard error.
fn succeed(folder: &Folder, arguments: &[&str]) {
    let said = folder.run(arguments);
    assert_eq!(said.code, Some(0), "{arguments:?}: {}", said.err);
}

/// The table of a folder: a row's cells by the columns' names, by its number.
fn table(bytes: &[u8]) -> BTreeMap<u32, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(bytes);
    let header = reader.headers().unwrap().clone();
    let rows = reader.records().map(|record| {
        let record = record.unwrap();
        let row: BTreeMap<String, String> =
            header.iter().zip(record.iter()).map(|(name, cell)| (name.to_owned(), cell.to_owned())).collect();
        // No name stands twice.
        assert_eq!(row.len(), header.len());
        (row["number"].parse().unwrap(), row)
    });
    rows.collect()
}

#[test]
fn each_tree_of_a_plot_is_grown_by_itself_where_it_stands() {
    let folder = Folder::new();
    let text = plot(&folder);
    folder.write("plot.csv", text.as_bytes());
    let said = folder.run(&["export", "plot.csv", "-o", "trees/", "--format", "glb,qsm"]);
    assert!(said.code == Some(0) && said.err.contains("'treeID' tells 2 trees apart"), "{}", said.err);
    assert!(said.out == "2 trees written into trees/, with trees/trees.csv\n", "{}", said.out);
    let rows = table(&folder.read("trees/trees.csv"));
    assert_eq!(rows.len(), 2);
    for (preset, number, [east, north]) in TREES {
        let row = &rows[&number];
        assert_eq!(
            (row["files"].as_str(), row["error"].as_str()),
            (&*format!("{number}.glb {number}.csv"), "")
        );
        // The points of this tree alone, in a file of their own, are the same tree.
        let own = |line: &&str| line.starts_with('x') || line.ends_with(&format!(",{number}"));
        let alone: Vec<&str> = text.lines().filter(own).collect();
        assert_eq!(row["input_points"], (alone.len() - 1).to_string());
        folder.write("alone.csv", alone.join("\n").as_bytes());
        let alone = folder.run(&["stats", "alone.csv", "--json"]).json();
        assert_eq!(row["skeleton_hash"], alone["skeleton_hash"].as_str().unwrap());
        let foot = |axis: &str| row[&format!("foot_{axis}")].parse::<f64>().unwrap();
        let place = [CORNER[0] + east, CORNER[1] + north, CORNER[2]];
        for (axis, expected) in ["x", "y", "z"].into_iter().zip(place) {
            assert!(
                (foot(axis) - expected).abs() < 0.1,
                "{preset}: {axis} is {}, not {expected}",
                foot(axis)
            );
        }
        let of_stats: Vec<f64> = serde_json::from_value(alone["scan"]["foot"].clone()).unwrap();
        assert!((of_stats[1] - foot("y")).abs() < 1e-3);
        let truth = folder.run(&["stats", preset, "--json"]).json()["height_m"].as_f64().unwrap();
        let height: f64 = row["height_m"].parse().unwrap();
        assert!((height / truth - 1.0).abs() < 0.1, "{preset}: {height} of {truth}");
        // One of them, asked for: the same file.
        let one = format!("--set=tree={number}");
        succeed(&folder, &["export", "plot.csv", &one, "-o", "one.glb"]);
        assert!(folder.read("one.glb") == folder.read(&format!("trees/{number}.glb")), "{preset}");
    }
    let mut command = crate::program::linden();
    command.args(["export", "plot.csv", "-o", "again/", "--mkdir", "--format", "glb,qsm"]);
    let done = command.current_dir(folder.path()).env("RAYON_NUM_THREADS", "1").output().unwrap();
    assert!(done.status.success());
    for name in ["7.glb", "21.glb", "trees.csv"] {
        assert!(folder.read(&format!("trees/{name}")) == folder.read(&format!("again/{name}")), "{name}");
    }
}

#[test]
fn one_numbered_tree_among_other_points_is_a_folder_of_one() {
    let folder = Folder::new();
    let text = plot(&folder);
    let lines = |is_one: &dyn Fn(&str) -> bool| -> String {
        text.lines().filter(|line| line.starts_with('x') || is_one(line)).collect::<Vec<_>>().join("\n")
    };
    folder.write("single.csv", lines(&|line| !line.ends_with(",21")).as_bytes());
    let said = folder.run(&["export", "single.csv", "-o", "trees/"]);
    assert!(
        said.code == Some(0) && said.err.contains("'treeID' tells one tree from other points"),
        "{}",
        said.err
    );
    let rows = table(&folder.read("trees/trees.csv"));
    assert_eq!((rows.len(), rows[&7]["files"].as_str()), (1, "7.glb"));
    // Where nothing tells points apart, the file's name is the tree's.
    folder.write("alone.csv", lines(&|line| line.ends_with(",7")).as_bytes());
    succeed(&folder, &["export", "alone.csv", "-o", "alone/", "--format", "glb", "--mkdir"]);
    assert!(folder.read("alone/alone.glb").starts_with(b"glTF"));
    let one = folder.run(&["stats", "single.csv", "--json"]).json();
    let alone = folder.run(&["stats", "alone.csv", "--json"]).json();
    assert_eq!(one["skeleton_hash"], alone["skeleton_hash"]);
}

#[test]
fn what_is_wrong_with_a_tree_stops_no_other() {
    let folder = Folder::new();
    let mut text = plot(&folder);
    for x in 0..3 {
        let _ = writeln!(text, "{x},0,0,0.5,1000");
    }
    folder.write("plot.csv", text.as_bytes());
    let said = folder.run(&["export", "plot.csv", "-o", "trees/", "--no-sync"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("tree 1000: ") && said.err.contains("1 of 3 trees failed"), "{}", said.err);
    let rows = table(&folder.read("trees/trees.csv"));
    assert!(rows[&1000]["error"].contains("points") && rows[&1000]["files"].is_empty(), "{rows:?}");
    assert!(rows[&7]["error"].is_empty() && folder.read("trees/7.glb").starts_with(b"glTF"));
    // What took how long is told, and which files were left alone, though not all trees were written.
    let kept = folder.run(&["export", "plot.csv", "-o", "trees/", "--no-sync", "--if-changed", "--timings"]);
    let left =
        "note: trees/7.glb, trees/21.glb had their bytes already and were left alone; 1 of 3 written\n";
    assert!(kept.err.contains(left) && kept.err.contains("step "), "{}", kept.err);
    assert!(kept.err.contains("\n3 files of ") && kept.out.is_empty(), "{}{}", kept.err, kept.out);
    // The same as one document, which lists what was written.
    let said = folder.run(&["export", "plot.csv", "-o", "again/", "--no-sync", "--json"]);
    let document = said.json();
    let files = document["files"].as_array().unwrap();
    let paths: Vec<&str> = files.iter().map(|file| file["path"].as_str().unwrap()).collect();
    assert_eq!((said.code, paths), (Some(1), vec!["again/7.glb", "again/21.glb", "again/trees.csv"]));
    for file in files {
        let bytes = folder.read(file["path"].as_str().unwrap()).len() as u64;
        assert_eq!(file["bytes"].as_u64(), Some(bytes), "{file}");
    }
}

#[test]
fn one_tree_is_asked_for_by_its_number() {
    let folder = Folder::new();
    folder.write("plot.csv", plot(&folder).as_bytes());
    let shown = folder.run(&["show", "plot.csv"]).out;
    assert!(shown.contains("'treeID': 2 trees: 7 ("), "{shown}");
    for (set, code, expected) in [
        (
            &["--set=tree=8"][..],
            1,
            "tree=8: no point of plot.csv has this number in 'treeID'; it numbers 7, 21",
        ),
        (
            &["--set=tree=7", "--set=instance=stand"],
            1,
            "plot.csv has no column 'stand' of trees; it has 'treeID'",
        ),
        (&["--set=tree=7", "--set=instance=TREEid"], 0, ""),
        (&["--set=tree=0"], 2, "tree"),
        (&[], 0, "'treeID' of plot.csv tells 2 trees apart, and all of its points were taken for one"),
    ] {
        let said = folder.run(&[&["stats", "plot.csv", "--json"], set].concat());
        assert!(
            said.code == Some(code) && said.err.contains(expected),
            "{set:?}: {:?} {}",
            said.code,
            said.err
        );
    }
    // No column at all.
    folder.write("plain.csv", b"x,y,z\n0,0,0\n0,0,1\n0,0,2\n");
    let said = folder.run(&["stats", "plain.csv", "--set=tree=1"]);
    assert!(said.err.contains("plain.csv says of no point which tree it belongs to"), "{}", said.err);
    // A preset says both.
    folder.write(
        "mine.toml",
        b"id = \"mine\"\n[scan]\nfile = \"plot.csv\"\ninstance = \"treeID\"\ntree = 21\n",
    );
    let stats = folder.run(&["stats", "mine.toml", "--json"]).json();
    let by_flag = folder.run(&["stats", "plot.csv", "--json", "--set=tree=21"]).json();
    assert_eq!(stats["skeleton_hash"], by_flag["skeleton_hash"]);
}

#[test]
fn crowns_of_a_canopy_are_grown_under_their_tops() {
    // Two domes on cells of half a metre, rows from the north: place, height, width.
    const DOMES: [([f64; 2], f64, f64); 2] = [([9.0, 11.0], 18.0, 8.0), ([21.0, 8.0], 12.0, 6.0)];
    let folder = Folder::new();
    let mut grid =
        "ncols 60\nnrows 40\nxllcorner 5000\nyllcorner 7000\ncellsize 0.5\nNODATA_value -9999\n".to_owned();
    for row in 0..40_u32 {
        for column in 0..60_u32 {
            let (x, y) = (0.5 * f64::from(column) + 0.25, 0.5 * f64::from(39 - row) + 0.25);
            let height = |([at_x, at_y], height, width): &([f64; 2], f64, f64)| {
                let r = 2.0 * (x - at_x).hypot(y - at_y) / width;
                if r <= 1.0 { height * (1.0 - 0.5 * r * r) } else { 0.0 }
            };
            let _ = write!(grid, "{:.2} ", DOMES.iter().map(height).fold(0.0, f64::max));
        }
        grid.push('\n');
    }
    folder.write("canopy.asc", grid.as_bytes());
    let said = folder.run(&["export", "canopy.asc", "-o", "trees/", "--no-sync"]);
    assert!(said.code == Some(0) && said.err.contains("'crown' tells 2 trees apart"), "{}", said.err);
    let rows = table(&folder.read("trees/trees.csv"));
    assert_eq!(rows.len(), 2);
    for ((_, row), ([x, y], height, width)) in rows.iter().zip(DOMES) {
        let of = |name: &str| row[name].parse::<f64>().unwrap_or_else(|_| panic!("{name}: {}", row[name]));
        assert!(
            (of("foot_x") - 5000.0 - x).abs() < 0.5 && (of("foot_y") - 7000.0 - y).abs() < 0.5,
            "{row:?}"
        );
        assert!(of("foot_z").abs() < 1e-6);
        assert!((of("height_m") / height - 1.0).abs() < 0.08, "{} of {height}", of("height_m"));
        assert!((of("crown_width_m") / width - 1.0).abs() < 0.2, "{} of {width}", of("crown_width_m"));
        assert!(row["notes"].contains("the crown was filled from"), "{}", row["notes"]);
    }
    // Crowns that begin higher, and heights above the sea.
    let high = folder.run(&["stats", "canopy.asc", "--json", "--set=tree=1", "--set=trunk=12"]);
    assert!(high.err.contains("filled from 12.0 m up to 17."), "{}", high.err);
    folder.write("sea.asc", grid.replace("0.00 ", "400.00 ").as_bytes());
    let said = folder.run(&["stats", "sea.asc"]);
    assert!(said.code == Some(1) && said.err.contains("heights above ground"), "{}", said.err);
}

#[test]
fn trees_of_a_table_of_cylinders_are_told_apart_too() {
    let folder = Folder::new();
    let fixture = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/cylinders/raycloudtools.txt");
    folder.write("two.txt", std::fs::read(fixture).unwrap());
    succeed(&folder, &["export", "two.txt", "-o", "trees/", "--format", "qsm"]);
    let rows = table(&folder.read("trees/trees.csv"));
    assert_eq!(rows.keys().collect::<Vec<_>>(), [&1, &2]);
    for (number, volume) in [(1, 0.0241), (2, 0.04)] {
        let found: f64 = rows[&number]["cylinder_volume_m3"].parse().unwrap();
        assert!((found - std::f64::consts::PI * volume).abs() < 1e-6, "{number}: {found}");
    }
}

#[test]
fn trees_of_a_table_of_cylinders_keep_their_places_in_the_table_of_trees() {
    let folder = Folder::new();
    let forest = ["forest", "simple", "--set", "points=30", "--area", "20", "--spacing", "6", "--trees", "3"];
    let dialect = ["--format", "qsm", "--set", "qsm.dialect=raycloudtools", "--set", "qsm.comments=false"];
    succeed(&folder, &[&forest[..], &dialect, &["-o", "plot.txt"]].concat());
    succeed(&folder, &["export", "plot.txt", "-o", "trees/", "--format", "ply-skeleton", "--mkdir"]);
    let rows = table(&folder.read("trees/trees.csv"));
    let text = String::from_utf8(folder.read("plot.txt")).unwrap();
    let lines: Vec<&str> =
        text.lines().filter(|line| line.starts_with(|c: char| c == '-' || c.is_ascii_digit())).collect();
    assert_eq!((rows.len(), lines.len()), (3, 3), "{text}");
    for (number, line) in (1..).zip(lines) {
        let start: Vec<f64> = line.split([',', ' ']).take(3).map(|number| number.parse().unwrap()).collect();
        for (axis, expected) in ["foot_x", "foot_y", "foot_z"].into_iter().zip(start) {
            let found: f64 = rows[&number][axis].parse().unwrap();
            assert!((found - expected).abs() < 1e-3, "{number}: {axis} is {found}, not {expected}");
        }
    }
    let ply = String::from_utf8_lossy(&folder.read("trees/2-skeleton.ply")).into_owned();
    assert!(ply.contains("foot in the file that it was grown from"), "{}", &ply[..400]);
}

/// A small wood, its trees near enough to touch.
const WOOD: &str = r#"
name = "Three"
area = 7
spacing = 4
trees = 4
distinct = 1
seed = 4
[[tree]]
preset = "simple"
set = { points = 60 }
"#;

#[test]
fn a_plot_that_nobody_segmented_is_divided_by_its_stems() {
    let folder = Folder::new();
    folder.write("wood.toml", WOOD);
    let scan = ["scan", "wood.toml", "-o", "plot.laz", "--truth", "truth.csv", "--ground", "--slope=12"];
    let said = folder.run(&[&scan[..], &["--positions=5", "--step=0.3", "--beam=0"]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    // What is known: where each tree stands, in the axes of LAZ, and how it measures.
    let truth = String::from_utf8(folder.read("truth.csv")).unwrap();
    let rows: Vec<Vec<&str>> = truth.lines().map(|line| line.split(',').collect()).collect();
    let of = |row: &Vec<&str>, name: &str| -> f64 {
        row[rows[0].iter().position(|found| *found == name).unwrap()].parse().unwrap()
    };
    let trees: Vec<([f64; 3], f64, f64)> = rows[1..]
        .iter()
        .map(|row| {
            let foot = [of(row, "foot_x_m"), -of(row, "foot_z_m"), of(row, "foot_y_m")];
            (foot, of(row, "height_m"), of(row, "dbh_m"))
        })
        .collect();
    assert!(trees.len() >= 3, "{truth}");
    // They stand on the slope: the tangent of 12°.
    for ([x, _, z], ..) in &trees {
        assert!((z - x * 0.212_556_6).abs() < 1e-3, "{truth}");
    }
    // The file's own column has as many as were scanned; their stems are to give as many without it.
    let by_column = folder.run(&["show", "plot.laz"]).out;
    assert!(by_column.contains(&format!("'treeID': {} trees", trees.len())), "{by_column}");
    let of_threads = |threads: &str, folder_name: &str| {
        let mut command = crate::program::linden();
        command.args([
            "export",
            "plot.laz",
            "--set=segmentation=paths",
            "--format=ply-skeleton",
            "--mkdir",
            "-o",
        ]);
        let done = command.arg(folder_name).current_dir(folder.path()).env("RAYON_NUM_THREADS", threads);
        let done = done.output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        folder.read(&format!("{folder_name}trees.csv"))
    };
    let written = of_threads("2", "trees/");
    let found = table(&written);
    assert_eq!(found.len(), trees.len());
    for (number, row) in &found {
        let cell = |name: &str| row[name].parse::<f64>().unwrap_or_else(|_| panic!("{name} of {row:?}"));
        let foot = ["foot_x", "foot_y", "foot_z"].map(cell);
        let off = |tree: &&([f64; 3], f64, f64)| {
            let (x, y) = (tree.0[0] - foot[0], tree.0[1] - foot[1]);
            (x * x + y * y).sqrt()
        };
        let nearest = trees.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        assert!(off(&nearest) < 0.2 && (nearest.0[2] - foot[2]).abs() < 0.3, "{number}: {foot:?} {truth}");
        assert!((cell("height_m") / nearest.1 - 1.0).abs() < 0.12, "{number}: {row:?}");
        assert!((cell("trunk_diameter_m") / nearest.2 - 1.0).abs() < 0.2, "{number}: {row:?} {truth}");
    }
    assert!(of_threads("1", "again/") == written);
    // One of them, asked for: the same.
    succeed(
        &folder,
        &[
            "export",
            "plot.laz",
            "--set=segmentation=paths",
            "--set=tree=2",
            "-o",
            "two.ply",
            "--format=ply-skeleton",
        ],
    );
    assert!(folder.read("two.ply") == folder.read(&format!("trees/{}", found[&2]["files"])));
}

#[test]
fn what_shows_no_stems_is_not_divided_by_them() {
    let folder = Folder::new();
    folder.write("plot.csv", plot(&folder).as_bytes());
    let level = (0..400).fold(String::new(), |text, i| text + &format!("{} {} 0\n", i % 20, i / 20));
    folder.write("ground.xyz", &level);
    folder.write("canopy.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n9 0\n0 0\n");
    for (arguments, expected) in [
        (
            &["ground.xyz"][..],
            "ground.xyz: no stem of a tree stands on the ground there; are scale= and up= right",
        ),
        (&["canopy.asc"], "canopy.asc: a grid of heights shows no stems; segmentation=column"),
        (
            &["plot.csv", "--set=instance=treeID"],
            "instance names a column that tells trees apart; leave out one of both",
        ),
    ] {
        for output in ["trees/", "one.glb"] {
            let rest = ["--set=segmentation=paths", "--mkdir", "-o", output];
            let said = folder.run(&[&["export"], arguments, &rest].concat());
            assert!(said.code == Some(1) && said.err.contains(expected), "{arguments:?}: {}", said.err);
            assert!(!folder.names().iter().any(|name| name == "trees" || name == "one.glb"));
        }
    }
    let said = folder.run(&["show", "ground.xyz", "--set=segmentation=paths"]);
    assert!(said.code == Some(0) && said.out.contains("no stem of a tree stands"), "{}", said.out);
    // Without a column, what would help is said.
    let said = folder.run(&["stats", "ground.xyz", "--set=tree=1"]);
    assert!(said.err.contains("segmentation=paths finds the trees by their stems"), "{}", said.err);
}

#[test]
fn points_are_thinned_while_they_are_read() {
    let folder = Folder::new();
    let text = plot(&folder);
    folder.write("plot.csv", text.as_bytes());
    // Each point two hundred times, which is more than the memory holds.
    let (header, rows) = text.split_once('\n').unwrap();
    folder.write("large.csv", format!("{header}\n{}", rows.repeat(200)).as_bytes());
    let stats =
        |file: &str, more: &[&str]| folder.run(&[&["stats", file, "--json", "--set=tree=21"], more].concat());
    let said = stats("large.csv", &["--memory=28M"]);
    assert!(said.code == Some(1) && said.err.contains("reading points or a mesh would take"), "{}", said.err);
    let of_large = stats("large.csv", &["--memory=28M", "--set=thin=0.01"]);
    let of_plot = stats("plot.csv", &["--set=thin=0.01"]);
    let note = of_large.err.lines().find(|line| line.contains("thin=0.01: ")).expect(&of_large.err);
    let counts: Vec<u64> = note.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [kept, all] = counts[..] else { panic!("{note}") };
    assert_eq!(all, 200 * rows.lines().count() as u64);
    assert!(
        of_plot.err.contains(&format!("thin=0.01: {kept} of {} points were kept", all / 200)),
        "{}",
        of_plot.err
    );
    assert_eq!(of_large.json()["skeleton_hash"], of_plot.json()["skeleton_hash"]);
    assert_ne!(of_plot.json()["skeleton_hash"], stats("plot.csv", &[]).json()["skeleton_hash"]);
    // It is part of the recipe, and of each tree's.
    succeed(&folder, &["export", "plot.csv", "-o", "trees/", "--set=thin=0.01", "--mkdir"]);
    succeed(&folder, &["export", "plot.csv", "-o", "one.glb", "--set=thin=0.01", "--set=tree=21"]);
    succeed(&folder, &["export", "one.glb", "-o", "again.glb"]);
    assert!(folder.read("one.glb") == folder.read("again.glb"));
    assert!(folder.read("one.glb") == folder.read("trees/21.glb"));
    let preset = "id = \"mine\"\nname = \"Mine\"\ngroup = \"mine\"\nsummary = \"a scan\"\nsource = \"a scanner\"\n\
                  [scan]\nfile = \"plot.csv\"\nthin = 0.01\ntree = 21\n";
    folder.write("mine.toml", preset.as_bytes());
    let of_preset = folder.run(&["stats", "mine.toml", "--json"]);
    assert_eq!(of_preset.json()["skeleton_hash"], of_plot.json()["skeleton_hash"]);
}
