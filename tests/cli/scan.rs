//! `linden scan`: what it writes, what it refuses, and that a tree grows back from it.

use crate::pictures::pixels;
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

#[test]
fn a_scan_is_looked_at_in_slices_with_its_points_and_by_how_sure_its_radii_are() {
    let folder = Folder::new();
    assert_eq!(folder.run(&[&SMALL[..], &["-o", "scan.ply"]].concat()).code, Some(0));
    let draw = |source: &str, args: &[&str]| -> (Vec<[u8; 3]>, String) {
        let size = ["--size", "300x300", "-o", "-"];
        let said = folder.run(&[&["preview", source], args, &size].concat());
        assert_eq!(said.code, Some(0), "{args:?}: {}", said.err);
        let (_, bytes) = pixels(&said.bytes);
        let channels = bytes.len() / (300 * 300);
        (bytes.chunks(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect(), said.err)
    };
    let colors = |picture: &Vec<[u8; 3]>| picture.iter().collect::<std::collections::BTreeSet<_>>().len();
    let blue = |picture: &Vec<[u8; 3]>| {
        picture.iter().filter(|pixel| i32::from(pixel[2]) > i32::from(pixel[0]) + 60).count()
    };
    // The trunk fills the picture, with points round it; a tree that nobody scanned has none.
    let (cut, _) = draw("scan.ply", &["--slice", "1.3,0.6"]);
    let (thin, _) = draw("scan.ply", &["--slice", "1.3,0.02"]);
    let (grown, said) = draw("simple", &["--set=points=60", "--slice=1.3,0.05"]);
    assert!(
        blue(&cut) > 20 && blue(&cut) > 4 * blue(&thin) && blue(&grown) == 0 && !said.contains("no wood"),
        "{} {said}",
        blue(&cut)
    );
    let middle = |picture: &Vec<[u8; 3]>| picture[150 * 300 + 150];
    assert!(middle(&cut) != [255; 3] && middle(&grown) != [255; 3]);
    let (above, said) = draw("scan.ply", &["--slice", "90"]);
    assert!(colors(&above) == 1 && said.contains("no wood is cut there"), "{said}");
    // Measured wood and guessed wood: two ends of a ramp, which wood without measurements does not have.
    let (by_source, said) = draw("scan.ply", &["--color", "source"]);
    assert!(!said.contains("--color changes nothing"), "{said}");
    let (by_distance, _) = draw("scan.ply", &["--color", "distance", "--points"]);
    assert!(by_source != by_distance);
    let (drawn, said) = draw("simple", &["--set=points=60", "--color", "source"]);
    assert!(drawn == draw("simple", &["--set=points=60", "--look", "skeleton"]).0);
    assert!(said.contains("--color changes nothing: it is for trees whose radii were measured"), "{said}");
    let svg = folder.run(&["preview", "scan.ply", "--slice", "1.3", "-o", "cut.svg"]);
    assert_eq!(svg.code, Some(0), "{}", svg.err);
    assert!(String::from_utf8(folder.read("cut.svg")).unwrap().contains("</svg>"));
    for bad in ["x", "1.3,0", "-1", "1.3,0.1,2"] {
        let said = folder.run(&["preview", "scan.ply", &format!("--slice={bad}"), "-o", "x.png"]);
        assert!(said.code == Some(2) && said.err.contains("metres above the foot"), "{bad}: {}", said.err);
    }
}

#[test]
fn files_say_where_a_scanned_tree_stands_in_its_country() {
    let folder = Folder::new();
    // A pole of 4 m and 0.3 m thick, Z up, on a national grid.
    let foot = [481_000.25, 5_523_000.5, 210.0];
    let places = (0..200_u16).flat_map(|ring| (0..24_u16).map(move |side| (ring, side)));
    let rows = places.map(|(ring, side)| {
        let (sin, cos) = libm::sincos(f64::from(side) / 24.0 * std::f64::consts::TAU);
        let z = foot[2] + 0.02 * f64::from(ring);
        format!("{:.4} {:.4} {z:.4}\n", foot[0] + 0.15 * cos, foot[1] + 0.15 * sin)
    });
    folder.write("pole.xyz", rows.collect::<String>());
    let files =
        ["a.glb", "a.gltf", "a.obj", "a.ply", "a.usda", "a.usdc", "a.csv", "a.mtg", "a.3mf", "a.organs.csv"];
    let outputs: Vec<&str> = files.iter().flat_map(|file| ["-o", file]).collect();
    let said = folder.run(&[&["export", "pole.xyz"], &outputs[..]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let told = |text: &str, before: &str, between: &str| -> Vec<f64> {
        let rest = text.split(before).nth(1).unwrap_or_else(|| panic!("no {before}"));
        let numbers = rest.split(['\n', ']', ')', '<']).next().unwrap().split(between);
        numbers.map(|number| number.trim().parse().unwrap()).collect()
    };
    let comment = "foot in the file that it was grown from, its axes and units: ";
    for (file, before, between) in [
        ("a.glb", "\"linden_foot_in_file\":[", ","),
        ("a.gltf", "\"linden_foot_in_file\":[", ","),
        ("a.obj", comment, " "),
        ("a.ply", comment, " "),
        ("a.usda", "userProperties:linden:footInFile = (", ","),
        ("a.csv", comment, " "),
        ("a.mtg", comment, " "),
        ("a.organs.csv", comment, " "),
    ] {
        let bytes = folder.read(file);
        let found = told(&String::from_utf8_lossy(&bytes), before, between);
        assert_eq!(found.len(), 3, "{file}: {found:?}");
        let off = found.iter().zip(foot).map(|(found, true_m)| (found - true_m).abs()).fold(0.0, f64::max);
        assert!(off < 0.05, "{file}: {found:?}");
    }
    // Read back, each carries the recipe still; and what grew into nothing stands nowhere.
    for file in files {
        let said = folder.run(&["recipe", file]);
        assert_eq!(said.code, Some(0), "{file}: {}", said.err);
    }
    folder.run(&["export", "fir", "--set=points=60", "-o", "fir.obj"]).done();
    assert!(!String::from_utf8(folder.read("fir.obj")).unwrap().contains("foot in"));
}

/// A stem that is thicker up to a step below breast height, with bark of points every two centimetres.
fn stepped_stem() -> String {
    let mut text = String::new();
    for level in 0..200 {
        let height = 0.02 * f64::from(level);
        let radius = if height < 1.0 { 0.2 } else { 0.14 };
        for corner in 0..48 {
            let turn = f64::from(corner) / 48.0 * std::f64::consts::TAU;
            let (sin, cos) = libm::sincos(turn);
            text += &format!("{:.4} {:.4} {height:.4}\n", radius * cos, radius * sin);
        }
    }
    text
}

#[test]
fn what_was_measured_at_breast_height_hangs_on_no_surface_and_stays_when_wood_is_edited() {
    let folder = Folder::new();
    folder.write("stem.xyz", stepped_stem());
    let stats = |more: &[&str]| folder.run(&[&["stats", "stem.xyz", "--json"], more].concat()).json();
    let of = |stats: &serde_json::Value| {
        (stats["dbh_m"].clone(), stats["dbh_source"].clone(), stats["dbh_se_m"].clone())
    };
    let usual = stats(&[]);
    let dbh = usual["dbh_m"].as_f64().unwrap();
    assert!((dbh / 0.28 - 1.0).abs() < 0.02, "{dbh}");
    assert_eq!(usual["dbh_source"], "measured");
    assert_eq!(usual["dbh_m"], usual["trunk_diameter_m"]);
    for settings in [["--set", "width_smoothing=0"], ["--set", "flare=1"], ["--edit", "cut stem 0.7"]] {
        let other = stats(&settings);
        assert_eq!(of(&other), of(&usual), "{settings:?}");
        assert_ne!(other["wood_volume_m3"], usual["wood_volume_m3"], "{settings:?}");
    }
    let thicker = stats(&["--edit", "scale stem thickness=1.5"]);
    assert_eq!((&thicker["dbh_source"], &thicker["dbh_se_m"]), (&"guessed".into(), &serde_json::Value::Null));
}
