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
    let said = calibrate(&folder, "firs.csv", &["--seeds", "24", "--json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let calibration = said.json();
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
fn p_of_few_trees_is_exact() {
    let folder = Folder::new();
    // 100 m are taller than all firs: D is 1, of two and two that is so for 2 of 6 divisions, of twelve and one for 2 of 13.
    for (table, seeds, p) in [("height_m\n100\n101\n", "2", 1.0 / 3.0), ("height_m\n100\n", "12", 2.0 / 13.0)]
    {
        folder.write("firs.csv", table);
        let calibration = calibrate(&folder, "firs.csv", &["--seeds", seeds, "--json"]).done().json();
        let height = of(&calibration, "height_m");
        assert_eq!(height["distance"].as_f64(), Some(1.0));
        assert!((height["p"].as_f64().unwrap() - p).abs() < 1e-12, "{height}");
    }
}

#[test]
fn too_few_trees_to_tell_are_not_said_to_be_of_one_kind() {
    let folder = Folder::new();
    // 15 m thick: of three and two p is 0.2 at its smallest, of three and twenty 0.001.
    folder.write("firs.csv", "tree,dbh_m\n1,15\n2,16\n3,17\n");
    let few = calibrate(&folder, "firs.csv", &["--seeds", "2"]);
    assert!(few.out.contains("1.00  0.20  too few trees to tell\n"), "{}", few.out);
    assert!(
        few.out.contains("\nNothing can part: ") && !few.out.contains("they are of one kind"),
        "{}",
        few.out
    );
    assert!(few.err.contains("note: not compared: tree"), "{}", few.err);
    let json = calibrate(&folder, "firs.csv", &["--seeds", "2", "--json"]).done().json();
    let thickness = of(&json, "dbh_m");
    assert!(thickness["parts"].is_null() && (thickness["least_p"].as_f64().unwrap() - 0.2).abs() < 1e-12);
    let enough = calibrate(&folder, "firs.csv", &["--seeds", "20", "--json"]).done().json();
    assert_eq!(of(&enough, "dbh_m")["parts"], true);
    // Of some numbers they are enough.
    folder.write("firs.csv", "height_m,dbh_m\n9,15\n9.5,\n10,\n8.5,\n");
    let some = calibrate(&folder, "firs.csv", &["--seeds", "12"]).out;
    assert!(
        some.contains("\nToo few trees to tell: dbh_m\n") && some.contains("Nothing else parts"),
        "{some}"
    );
}

#[test]
fn numbers_that_no_grown_tree_has_are_not_compared() {
    let folder = Folder::new();
    // A scan's alone.
    folder.write("firs.csv", "dbh_se_m\n0.1\n0.2\n0.3\n");
    let page = calibrate(&folder, "firs.csv", &["--seeds", "2"]).done().out;
    assert!(page.contains("none has it") && page.contains("\nNothing was compared: "), "{page}");
    assert!(!page.contains("they are of one kind"), "{page}");
    // 100 m are taller than all firs: of four and four p is 2 of 70 divisions, which is enough for one number, not for two.
    folder.write("firs.csv", "height_m,dbh_se_m\n100,0.1\n101,0.2\n102,0.1\n103,0.2\n");
    let calibration = calibrate(&folder, "firs.csv", &["--seeds", "4", "--json"]).done().json();
    assert_eq!(of(&calibration, "height_m")["parts"], true, "{calibration}");
}

#[test]
fn tables_of_spreadsheets_are_read_with_decimal_commas() {
    let folder = Folder::new();
    folder.write("plain.csv", "species,height_m,dbh_cm\nAbies,9.25,20\nAbies,10.5,22.5\n");
    let expected = json(&folder, "plain.csv")["numbers"].clone();
    for table in [
        "species;height_m;dbh_cm\nAbies;9,25;20\nAbies;10,5;22,5\n",
        "\u{feff}species;height_m;dbh_cm\r\nAbies;9.25;20\r\nAbies;10.5;22.5\r\n;;\r\n",
        "species\theight_m\tdbh_cm\nAbies\t9,25\t20\nAbies\t10,5\t22,5\n",
        "# measured in May; by hand\nspecies;\"height_m\";dbh_cm\nAbies, alba;\"9,25\";20\nAbies;10,5;22,5;\n",
    ] {
        folder.write("firs.csv", table);
        let calibration = json(&folder, "firs.csv");
        assert_eq!(calibration["numbers"], expected, "{table}");
        assert_eq!(calibration["measured"], 2, "{table}");
    }
    folder.write("firs.csv", "height_m\n9,25\n10,5\n");
    assert_eq!(of(&json(&folder, "firs.csv"), "height_m"), &expected[0], "one column");
}

#[test]
fn what_is_missing_and_what_no_tree_has_is_noted() {
    let folder = Folder::new();
    folder.write("firs.csv", "height_m,dbh_m,nodes\n9,NA,\n,0.2,nan\nNaN,0.25,\n10,0.3,-\n");
    let noted = |further: &[&str]| {
        let said = calibrate(&folder, "firs.csv", further);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said
    };
    let said = noted(&["--seeds", "2", "--json"]);
    let note = "note: firs.csv: trees without a value (empty, NA, NaN or -) are left out: height_m 2 of 4, dbh_m 1 of 4, \
                nodes 4 of 4\n";
    assert!(said.err.contains(note), "{}", said.err);
    let calibration = said.json();
    assert_eq!(
        (&calibration["measured"], &calibration["left_out"]),
        (&4.into(), &serde_json::json!(["nodes"]))
    );
    let height = of(&calibration, "height_m");
    assert_eq!((&height["measured"]["trees"], &height["missing"]), (&2.into(), &2.into()));

    folder.write("firs.csv", "height_m,dbh_m\n9,20\n1050,22.5\n");
    let said = noted(&["--seeds", "2"]);
    for note in [
        "note: firs.csv: height_m is more than 150 m for 1 of 2 trees, which no tree has (line 3: 1050); if the column is in \
         cm, name it height_cm\n",
        "note: firs.csv: dbh_m is more than 20 m for 1 of 2 trees, which no tree has (line 3: 22.5); if the column is in cm, \
         name it dbh_cm\n",
    ] {
        assert!(said.err.contains(note), "{}", said.err);
    }
    folder.write("firs.csv", "height_m,dbh_m\n11,15\n9,0.2\n12,18\n");
    let said = noted(&["--seeds", "2"]);
    let note = "note: firs.csv: dbh_m is more than a fifth of the height for 2 of 3 trees (line 2: 15 m of 11 m), which few \
                trees are; if the column is in cm, name it dbh_cm\n";
    assert!(said.err.contains(note), "{}", said.err);
    folder.write("firs.csv", "height_m,dbh_cm\n9,20\n150,1999\n");
    let said = noted(&["--seeds", "2"]);
    assert!(!said.err.contains("note: firs.csv"), "{}", said.err);
}

#[test]
fn what_is_wrong_with_a_table_is_said() {
    let folder = Folder::new();
    for (table, said) in [
        (
            "species,height_m\nAbies,\"15,2\"\n",
            "firs.csv:2: height_m is '15,2', expected a number like 12.5, or nothing: decimal commas are read where ';' or \
             tabs stand between columns",
        ),
        (
            "species,height_m,dbh_cm\nAbies,12,40\nAbies,15,2,40\n",
            "firs.csv:3 has 4 fields, the header has 3: decimal commas are read where ';' or tabs stand between columns",
        ),
        (
            "height_m,dbh_cm\ntall,\n",
            "firs.csv:2: height_m is 'tall', expected a number like 12.5, or nothing",
        ),
        ("species;height_m\nAbies;1.015,2\n", "firs.csv:2: height_m is '1.015,2', expected a number"),
        ("height_m,dbh_cm\nNA,\n", "firs.csv: none of its 1 trees has a number in height_m, dbh_cm"),
        ("height_m\n12\ntall\n", "firs.csv:3: height_m is 'tall', expected a number like 12.5, or nothing"),
        ("height\n12\n", "firs.csv has no column that is a number of 'linden stats'"),
        ("height_m,height_cm\n1,1\n", "two columns are height_m; keep one"),
        ("height_m\n", "firs.csv has no measured tree"),
        (
            "height_m,dbh_m\n9,0.2\n-11,0.2\n",
            "firs.csv:3: height_m is -11, which is below 0; correct it, or leave it empty",
        ),
        ("height_m,dbh_cm\n9,0\n", "firs.csv:2: dbh_cm is 0, which is no size of a tree"),
        ("height_m,dbh_m\n1\n", "firs.csv:2 has 1 field, the header has 2"),
        ("", "firs.csv has no column"),
    ] {
        folder.write("firs.csv", table);
        let failed = calibrate(&folder, "firs.csv", &[]);
        assert!(failed.code == Some(2) && failed.err.contains(said), "{}", failed.err);
    }
    let failed = calibrate(&folder, "none.csv", &[]);
    assert!(failed.code == Some(1) && failed.err.contains("reading none.csv"), "{}", failed.err);
}
