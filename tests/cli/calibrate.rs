//! `calibrate`, and what `--set` says with a spread.

use crate::program::{Folder, Said};

/// A crown that grows in no time.
const FIR: [&str; 5] = ["fir", "--set", "points=60", "--set", "crown_height=7..12"];

fn calibrate(folder: &Folder, table: &str, further: &[&str]) -> Said {
    folder.run(&[&["calibrate"], &FIR[..], &["--against", table], further].concat())
}

fn json(folder: &Folder, table: &str) -> serde_json::Value {
    calibrate(folder, table, &["--seeds", "24", "--json"]).done().json()
}

/// The numbers that were compared, by name.
fn of<'a>(calibration: &'a serde_json::Value, name: &str) -> &'a serde_json::Value {
    let all = calibration["numbers"].as_array().unwrap();
    all.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("{name} in {calibration}"))
}

/// Heights of the same firs, as another command measures them.
fn heights(folder: &Folder) -> Vec<f64> {
    let table = folder.run(&[&["sweep"], &FIR[..], &["--seeds", "24", "-o", "-"]].concat()).done().out;
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = header.iter().position(|title| *title == "height_m").unwrap();
    // No field in front of it has a comma.
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn a_spread_makes_seeds_differ() {
    let folder = Folder::new();
    let heights = heights(&folder);
    let (low, high) = heights.iter().fold((f64::MAX, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
    assert!(high - low > 2.0, "{heights:?}");
    let shown = folder.run(&[&["show"], &FIR[..]].concat()).done().out;
    assert!(shown.contains("each seed draws from 7..12"), "{shown}");
    let document = folder.run(&[&["show"], &FIR[..], &["--toml", "--changed"]].concat()).done().out;
    assert!(document.contains("crown_height = \"7..12\""), "{document}");
}

#[test]
fn an_export_with_a_spread_grows_again() {
    let folder = Folder::new();
    folder.run(&[&["export"], &FIR[..], &["--seed", "5", "-o", "fir.obj"]].concat()).done();
    folder.run(&["verify", "fir.obj"]).done();
    let recipe = folder.run(&["recipe", "fir.obj"]).done().out;
    assert!(recipe.contains("7..12"), "{recipe}");
}

#[test]
fn trees_do_not_part_from_themselves() {
    let folder = Folder::new();
    let lines: Vec<String> = heights(&folder).iter().map(f64::to_string).collect();
    folder.write("firs.csv", format!("height_m\n{}\n", lines.join("\n")));
    let row = json(&folder, "firs.csv");
    let height = of(&row, "height_m");
    assert_eq!((height["distance"].as_f64(), height["p"].as_f64()), (Some(0.0), Some(1.0)));
    assert_eq!(height["grown"], height["measured"]);
    let page = calibrate(&folder, "firs.csv", &["--seeds", "24"]).done().out;
    assert!(page.contains("Nothing parts"), "{page}");
}

#[test]
fn trees_twice_as_tall_part_in_any_unit() {
    let folder = Folder::new();
    let heights = heights(&folder);
    let mean = heights.iter().sum::<f64>() / 24.0;
    let lines: Vec<String> =
        heights.iter().map(|height| format!("Abies,{},", 2.0 * height / 0.3048)).collect();
    folder.write("firs.csv", format!("species,Height_ft,dbh_cm\n{}\nAbies,,40\n", lines.join("\n")));
    let calibration = json(&folder, "firs.csv");
    let height = of(&calibration, "height_m");
    assert_eq!(height["parts"], true);
    assert_eq!(height["measured"]["trees"], 24);
    assert!((height["measured"]["mean"].as_f64().unwrap() / mean - 2.0).abs() < 1e-9);
    assert!((height["differs_by"].as_f64().unwrap() + 0.5).abs() < 1e-9);
    assert_eq!(of(&calibration, "dbh_m")["measured"]["mean"], 0.4);
    assert_eq!(calibration["left_out"], serde_json::json!(["species"]));
    let page = calibrate(&folder, "firs.csv", &["--seeds", "24"]);
    assert!(page.out.contains("parts") && page.out.contains("-50 %"), "{}", page.out);
    assert!(page.err.contains("note: not compared: species"), "{}", page.err);
}

#[test]
fn what_is_wrong_with_a_table_is_said() {
    let folder = Folder::new();
    for (table, said) in [
        ("height_m\n12\ntall\n", "firs.csv:3: height_m is 'tall', expected a number like 12.5, or nothing"),
        ("height\n12\n", "firs.csv has no column that is a number of 'linden stats'"),
        ("height_m,height_cm\n1,1\n", "two columns are height_m; keep one"),
        ("height_m\n", "firs.csv has no measured tree"),
        ("height_m,dbh_m\n1\n", "firs.csv"),
        ("", "firs.csv has no column"),
    ] {
        folder.write("firs.csv", table);
        let failed = calibrate(&folder, "firs.csv", &[]);
        assert!(failed.code == Some(2) && failed.err.contains(said), "{}", failed.err);
    }
    let failed = calibrate(&folder, "none.csv", &[]);
    assert!(failed.code == Some(1) && failed.err.contains("reading none.csv"), "{}", failed.err);
}
