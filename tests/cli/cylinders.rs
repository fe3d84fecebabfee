//! Tables of cylinders, of this program and of others: what they become, and what is written back.

use std::f64::consts::PI;
use std::fs;

use serde_json::Value;

use crate::program::Folder;

/// A pole of two cylinders and a lateral, as each program has them (`tests/fixtures/cylinders`).
const DIALECTS: &[&str] = &[
    "linden.csv",
    "simpleforest.csv",
    "rtwig.csv",
    "archi.csv",
    "treeqsm.txt",
    // By scipy (make.py beside them): packed, as it is, and the variables of version 2.0.
    "treeqsm.mat",
    "treeqsm-plain.mat",
    "treeqsm-2.0.mat",
    "raycloudtools.txt",
];

const WRITTEN: &[&str] = &["linden", "simpleforest", "treeqsm", "raycloudtools", "archi"];

fn fixture(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/cylinders");
    fs::read(std::path::Path::new(folder).join(name)).unwrap()
}

fn number(stats: &Value, name: &str) -> f64 {
    stats[name].as_f64().unwrap_or_else(|| panic!("{name} in {stats}"))
}

#[test]
fn each_dialect_is_the_tree_that_its_columns_say() {
    let folder = Folder::new();
    for name in DIALECTS {
        // The content says what it is.
        folder.write("tree.xyz", fixture(name));
        let stats = folder.run(&["stats", "tree.xyz", "--json", "--set", "table_tree=1"]).json();
        assert_eq!(stats["generator"], "qsm", "{name}");
        // π (0.1² 2 + 0.05² 1 + 0.04² 1), 2 + 1 + 1 and 2 + 1 metres.
        let of = |column: &str, expected: f64| {
            let found = number(&stats, column);
            assert!((found - expected).abs() < 1e-6, "{name}: {column} is {found}, not {expected}");
        };
        of("cylinder_volume_m3", PI * 0.0241);
        of("total_length_m", 4.0);
        of("height_m", 3.0);
        assert_eq!(stats["segments"], 3, "{name}");
    }
    folder.write("two.txt", fixture("raycloudtools.txt"));
    let both = folder.run(&["stats", "two.txt", "--json"]).json();
    assert!((number(&both, "cylinder_volume_m3") - PI * (0.0241 + 0.04)).abs() < 1e-6);
    let said = folder.run(&["stats", "two.txt", "--json", "--set", "table_tree=3"]);
    assert!(said.code == Some(1) && said.err.contains("has 2 trees"), "{}", said.err);
    // The second stands 10 m away, and is moved to the origin unless told otherwise.
    folder.run(&["export", "two.txt", "-o", "b.csv", "--set=table_tree=2", "--set=qsm.comments=false"]);
    let moved = String::from_utf8(folder.read("b.csv")).unwrap();
    assert!(moved.lines().nth(1).unwrap().starts_with("1,0,1,0,1,0,0,0,0,1,0,1,0.2,"), "{moved}");
    let keep = ["--set=table_tree=2", "--set=table_place=true", "--set=qsm.comments=false"];
    folder.run(&[&["export", "two.txt", "-o", "b.csv"], &keep[..]].concat()).done();
    let kept = String::from_utf8(folder.read("b.csv")).unwrap();
    assert!(kept.lines().nth(1).unwrap().starts_with("1,0,1,0,1,10,0,0,0,1,0,1,0.2,"), "{kept}");
}

#[test]
fn what_was_written_comes_back_as_it_was() {
    let folder = Folder::new();
    let bare = "--set=qsm.comments=false";
    for source in ["simple", "abop-c"] {
        let volume = number(&folder.run(&["stats", source, "--json"]).json(), "cylinder_volume_m3");
        for dialect in WRITTEN {
            let said = format!("--set=qsm.dialect={dialect}");
            folder.run(&["export", source, "-o", "a.csv", bare, &said]).done();
            folder.run(&["export", "a.csv", "-o", "b.csv", bare, &said]).done();
            folder.run(&["export", "b.csv", "-o", "c.csv", bare, &said]).done();
            let [a, b, c] =
                ["a.csv", "b.csv", "c.csv"].map(|name| String::from_utf8(folder.read(name)).unwrap());
            let fields = |text: &str| -> Vec<String> {
                text.split(['\n', '\t', ',']).map(|field| field.trim().to_owned()).collect()
            };
            // An end that a direction and a length say is known to single precision: to the printed digit where it stands
            // there itself. The foot's radius of raycloudtools is none of a cylinder.
            let (first, second) = (fields(&a), fields(&b));
            assert_eq!(first.len(), second.len(), "{source}, {dialect}");
            let says_ends = matches!(*dialect, "simpleforest" | "archi");
            for (index, (x, y)) in first.iter().zip(&second).enumerate() {
                let near = || {
                    let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
                    (x - y).abs() <= 3e-7 * x.abs().max(1.0)
                };
                assert!(x == y || !says_ends && near(), "{source}, {dialect}, field {index}: {x} {y}");
            }
            let changed = first.iter().zip(&second).filter(|(x, y)| x != y).count();
            assert!(changed * 200 < first.len(), "{source}, {dialect}: {changed} fields");
            if !matches!(*dialect, "linden" | "treeqsm") {
                assert_eq!(b, c, "{source}, {dialect}");
            }
            let back = number(&folder.run(&["stats", "a.csv", "--json"]).json(), "cylinder_volume_m3");
            assert!((back / volume - 1.0).abs() < 1e-6, "{source}, {dialect}: {back} {volume}");
        }
    }
}

#[test]
fn models_of_matlab_files_are_trees() {
    let folder = Folder::new();
    folder.write("two.mat", fixture("two.mat"));
    let volume = |args: &[&str]| {
        let said = folder.run(&[&["stats"], args, &["--json"]].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        // Which of several was taken is said where nothing was asked for.
        assert_eq!(said.err.contains("table_tree"), args == ["two.mat"], "{args:?}: {}", said.err);
        number(&said.json(), "cylinder_volume_m3")
    };
    // The second is twice as thick.
    let one = PI * 0.0241;
    for (args, times) in [
        // Models of one tree: the first.
        (&["two.mat"][..], 1.0),
        (&["two.mat", "--set", "table_tree=1"], 1.0),
        (&["two.mat", "--set", "table_tree=2"], 4.0),
    ] {
        let found = volume(args);
        assert!((found - times * one).abs() < 1e-6, "{args:?}: {found}");
    }
    // The best of several models is named.
    folder.write("opt.mat", fixture("opt.mat"));
    assert!((volume(&["opt.mat"]) - 4.0 * one).abs() < 1e-6);
    let plain = fixture("treeqsm-plain.mat");
    let find = |part: &[u8]| plain.windows(part.len()).position(|window| window == part).unwrap();
    let with = |at: usize, bytes: &[u8]| {
        let mut mended = plain.clone();
        mended[at..at + bytes.len()].copy_from_slice(bytes);
        mended
    };
    // Small whole numbers stand in their tags.
    let parents = find(&[4, 0, 0, 0, 6, 0, 0, 0, 0, 0, 1, 0, 1, 0]) + 8;
    let radii = find(&0.05_f32.to_le_bytes());
    let hdf5 = [&b"MATLAB 7.3 MAT-file, Platform: GLNXA64"[..], &[0; 600]].concat();
    for (bytes, part) in [
        (with(parents, &[0, 0, 9, 0]), "cylinder 2: expected the id of a cylinder as parent, found '9'"),
        (with(parents, &[2, 0, 1, 0]), "own child"),
        (with(radii, &f32::NAN.to_le_bytes()), "cylinder 2: expected a finite number as radius"),
        (with(radii, &(-1.0_f32).to_le_bytes()), "cylinder 2: expected metres from 0 to 100 as radius"),
        (with(find(b"axis"), b"axes"), "no variable of it holds a model"),
        (plain[..plain.len() / 2].to_vec(), "cut off"),
        (with(126, b"??"), "order of its bytes"),
        (hdf5, "save('qsm.mat', 'QSM', '-v7')"),
    ] {
        folder.write("bad.mat", bytes);
        let said = folder.run(&["stats", "bad.mat"]);
        assert_eq!(said.code, Some(1), "{part}: {}", said.err);
        assert!(said.err.contains("bad.mat") && said.err.contains(part), "{part}: {}", said.err);
    }
}

#[test]
fn models_for_matlab_come_back_as_they_were() {
    let folder = Folder::new();
    let bare = ["--set=mat.recipe=false", "--set=qsm.comments=false", "--set=qsm.dialect=treeqsm"];
    for source in ["simple", "abop-c"] {
        folder.run(&[&["export", source, "-o", "a.mat", "-o", "a.csv"], &bare[..]].concat()).done();
        folder.run(&[&["export", "a.mat", "-o", "b.mat", "-o", "b.csv"], &bare[..]].concat()).done();
        let [text, back] = ["a.csv", "a.mat"].map(|file| {
            let stats = folder.run(&["stats", file, "--json"]).done().json();
            ["cylinder_volume_m3", "total_length_m", "height_m", "segments"].map(|name| number(&stats, name))
        });
        // Text has the shortest digits of what is written there in single precision.
        assert!(
            text.iter().zip(back).all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
            "{source}: {text:?} {back:?}"
        );
        let [a, b] = ["a.mat", "b.mat"].map(|name| folder.read(name));
        assert_eq!(a.len(), b.len(), "{source}");
    }
    // With its recipe it is the plant again.
    folder.run(&["export", "simple", "-o", "a.mat"]).done();
    let recipe = folder.run(&["recipe", "a.mat"]).done().out;
    assert!(recipe.contains("\"simple\""), "{recipe}");
    folder.run(&["verify", "a.mat"]).done();
}

#[test]
fn readers_find_the_columns_that_they_ask_for() {
    let folder = Folder::new();
    let header = |dialect: &str| {
        folder.write("tree.csv", fixture("archi.csv"));
        let said = format!("--set=qsm.dialect={dialect}");
        folder.run(&["export", "tree.csv", "-o", "a.csv", "--set=qsm.comments=false", &said]).done();
        let text = String::from_utf8(folder.read("a.csv")).unwrap();
        let lines: Vec<Vec<String>> = text
            .lines()
            .map(|line| line.split([',', '\t']).map(|field| field.trim().to_owned()).collect())
            .collect();
        lines
    };
    // rTwig tells SimpleForest and aRchi by these.
    let simple = header("simpleforest");
    for column in
        ["ID", "parentID", "growthLength", "segmentID", "parentSegmentID", "branchOrder", "branchID"]
    {
        assert!(simple[0].iter().any(|name| name == column), "{column}");
    }
    let of = |row: usize, column: &str| {
        let at = simple[0].iter().position(|name| name == column).unwrap();
        simple[row][at].parse::<f64>().unwrap()
    };
    // Above the fork: 1 m each; at the foot all 4 m, and two runs on a third.
    assert_eq!([of(1, "growthLength"), of(2, "growthLength"), of(3, "growthLength")], [4.0, 1.0, 1.0]);
    assert_eq!([of(1, "reverseBranchOrder"), of(3, "reverseBranchOrder")], [2.0, 1.0]);
    assert_eq!([of(1, "parentID"), of(3, "parentID")], [-1.0, 1.0]);
    assert!((of(1, "growthVolume") - PI * 0.0241).abs() < 1e-6);
    let archi = header("archi");
    for column in ["cyl_ID", "parent_ID", "branching_order", "axisX", "radius_cyl", "branch_ID"] {
        assert!(archi[0].iter().any(|name| name == column), "{column}");
    }
    // TreeQSM has 17 numbers below 13 names.
    let treeqsm = header("treeqsm");
    assert_eq!((treeqsm[0].len(), treeqsm[1].len()), (13, 17));
    // The stem's extension is its second cylinder.
    assert_eq!(treeqsm[1][8..11], ["0", "2", "1"]);
    let ray = header("raycloudtools");
    assert_eq!(ray[0], ["x", "y", "z", "radius", "parent_id"]);
    assert_eq!((ray.len(), ray[1].len()), (2, 4 * 5));
}

#[test]
fn the_trees_of_a_forest_stay_apart() {
    let folder = Folder::new();
    folder.write("two.txt", fixture("raycloudtools.txt"));
    for dialect in WRITTEN {
        let said = format!("--set=qsm.dialect={dialect}");
        let place = "--set=table_place=true";
        let args = ["export", "two.txt", "two.txt", "-o", "a.csv", "--set=qsm.comments=false", place, &said];
        let wrote = folder.run(&args);
        assert_eq!(wrote.code, Some(0), "{dialect}: {}", wrote.err);
        // What was in steps is read in steps.
        let stats = folder.run(&["stats", "a.csv", "--json", "--set", "width_steps=cylinder"]).json();
        let volume = number(&stats, "cylinder_volume_m3");
        assert!((volume - 2.0 * PI * 0.0641).abs() < 1e-5, "{dialect}: {volume}");
    }
}

#[test]
fn a_broken_table_is_said_with_file_and_line() {
    let folder = Folder::new();
    let whole = String::from_utf8(fixture("rtwig.csv")).unwrap();
    for (from, to, part) in [
        ("2,1,0,0,2", "2,7,0,0,2", "line 3: expected the id of a cylinder as parent, found '7'"),
        ("1,0,0,0,0", "1,3,0,0,0", "own child"),
        (",0.04,", ",NaN,", "line 4: expected a finite number in column 'radius'"),
        (",1,0,2,0.04", ",1,0,2e30,0.04", "column 'end_z'"),
        ("1,1,2,0,1\n", "1\n", "line 3: expected 19 columns"),
    ] {
        assert!(whole.contains(from), "{from}");
        folder.write("tree.csv", whole.replacen(from, to, 1));
        let said = folder.run(&["export", "tree.csv", "-o", "a.glb"]);
        assert_eq!(said.code, Some(1), "{to}: {}", said.err);
        assert!(said.err.contains("tree.csv") && said.err.contains(part), "{to}: {}", said.err);
        assert_eq!(folder.names(), ["tree.csv"]);
    }
    for name in DIALECTS {
        let bytes = fixture(name);
        for end in (0..bytes.len()).step_by(97) {
            folder.write("tree.csv", &bytes[..end]);
            let said = folder.run(&["stats", "tree.csv"]);
            assert!(matches!(said.code, Some(0..=2)), "{name} to {end}: {:?} {}", said.code, said.err);
            assert!(!said.err.contains("panicked"), "{}", said.err);
        }
    }
}

#[test]
fn a_table_with_another_name_for_the_radius_is_no_cloud() {
    let folder = Folder::new();
    let radius = "a column named radius_m or radius or radius_cyl";
    for (fixture_name, from, to, parts) in [
        ("linden.csv", "radius_m", "r_m", [radius, "cylinders of linden", "found 'r_m'"]),
        (
            "archi.csv",
            "radius_cyl",
            "Diameter",
            [radius, "cylinders of aRchi", "found 'Diameter', of which a radius is half"],
        ),
        ("simpleforest.csv", " radius,", " r,", [radius, "cylinders of SimpleForest", "found 'r'"]),
        ("rtwig.csv", ",radius,", ",r,", [radius, "cylinders of rTwig", "found 'r'"]),
        ("treeqsm.txt", "radius (m)", "R (m)", [radius, "cylinders of TreeQSM", "found 'R (m)'"]),
        (
            "raycloudtools.txt",
            "radius,parent_id",
            "r,parent_id",
            ["a column named radius right after x, y and z", "cylinders of raycloudtools", "found 'r'"],
        ),
    ] {
        let whole = String::from_utf8(fixture(fixture_name)).unwrap();
        assert!(whole.contains(from), "{fixture_name}");
        folder.write("tree.csv", whole.replacen(from, to, 1));
        let said = folder.run(&["export", "tree.csv", "-o", "a.glb"]);
        assert_eq!(said.code, Some(1), "{fixture_name}: {}", said.err);
        for part in ["tree.csv"].iter().chain(&parts) {
            assert!(said.err.contains(part), "{fixture_name}, {part}: {}", said.err);
        }
        assert_eq!(folder.names(), ["tree.csv"]);
    }
}

#[test]
fn semicolons_leave_commas_to_decimals() {
    let folder = Folder::new();
    for name in ["rtwig.csv", "simpleforest.csv"] {
        let text = String::from_utf8(fixture(name)).unwrap().replace(',', ";").replace('.', ",");
        folder.write("tree.csv", text);
        let stats = folder.run(&["stats", "tree.csv", "--json"]).done().json();
        assert_eq!(stats["generator"], "qsm", "{name}");
        assert!((number(&stats, "cylinder_volume_m3") - PI * 0.0241).abs() < 1e-6, "{name}: {stats}");
    }
}

#[test]
fn a_tree_that_is_too_large_is_in_another_unit() {
    let folder = Folder::new();
    let table = |unit: f64| {
        let mut text = "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,radius\n".to_owned();
        for (ids, metres) in [
            ("1,0", [5.0, 6.0, 0.0, 5.0, 6.0, 20.0, 1.0]),
            ("2,1", [5.0, 6.0, 20.0, 5.0, 6.0, 30.0, 0.5]),
            ("3,1", [5.0, 6.0, 20.0, 15.0, 6.0, 20.0, 0.25]),
        ] {
            let numbers = metres.map(|x| (x * unit).to_string()).join(",");
            text += &format!("{ids},{numbers}\n");
        }
        folder.write("tree.csv", text);
        let said = folder.run(&["stats", "tree.csv", "--json"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        let stats = said.json();
        for (column, expected) in
            [("cylinder_volume_m3", PI * (20.0 + 2.5 + 0.625)), ("total_length_m", 40.0), ("height_m", 30.0)]
        {
            let found = number(&stats, column);
            assert!(
                (found - expected).abs() < 1e-4 * expected,
                "{unit}: {column} is {found}, not {expected}"
            );
        }
        said.err
    };
    let metres = table(1.0);
    assert!(!metres.contains("taken for"), "{metres}");
    let centimetres = table(100.0);
    assert!(centimetres.contains("the table was taken for centimetres (times 0.01)"), "{centimetres}");
    assert!(centimetres.contains("the foot at 500, 600, 0 of the table"), "{centimetres}");
    let millimetres = table(1000.0);
    assert!(millimetres.contains("the table was taken for millimetres (times 0.001)"), "{millimetres}");
    assert!(millimetres.contains("the foot at 5000, 6000, 0 of the table"), "{millimetres}");
}
