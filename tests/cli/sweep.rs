//! `sweep`, and the constants that `--define` sets.

use std::collections::BTreeMap;
use std::process::Stdio;

use linden::report::NUMBERS;

use crate::program::{Folder, Said, linden};

/// All of it changes the trees: turns that are jittered are others for each seed.
const SWEEP: [&str; 9] = [
    "sweep",
    "abop-honda-a",
    "--define",
    "r1=0.7:0.9:0.1",
    "--set",
    "angle_jitter=3,5",
    "--seeds",
    "2",
    "-o",
];

fn sweep(folder: &Folder, file: &str, further: &[&str]) -> Said {
    let args: Vec<&str> = SWEEP.iter().copied().chain([file]).chain(further.iter().copied()).collect();
    folder.run(&args)
}

fn text(folder: &Folder, file: &str) -> String {
    String::from_utf8(folder.read(file)).unwrap()
}

/// The fields of a line of CSV.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    let mut chars = line.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                fields.last_mut().unwrap().push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

/// The rows of a table, by column.
fn rows(table: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = table.lines();
    let header = fields(lines.next().unwrap());
    let row = |line: &str| {
        let fields = fields(line);
        assert_eq!(fields.len(), header.len(), "{line}");
        header.iter().cloned().zip(fields).collect()
    };
    lines.map(row).collect()
}

#[test]
fn a_sweep_is_the_product_of_its_values_with_what_stats_says_of_each() {
    let folder = Folder::new();
    sweep(&folder, "table.csv", &[]).done();
    let table = text(&folder, "table.csv");
    let rows = rows(&table);
    let keys = |row: &BTreeMap<String, String>| {
        ["item", "define.r1", "set.angle_jitter", "seed"].map(|key| row[key].clone()).join(" ")
    };
    let expected: Vec<String> = ["0.7", "0.8", "0.9"]
        .iter()
        .flat_map(|r1| {
            ["3", "5"].iter().flat_map(move |n| [1, 2].iter().map(move |seed| format!("{r1} {n} {seed}")))
        })
        .enumerate()
        .map(|(i, key)| format!("{} {key}", i + 1))
        .collect();
    assert_eq!(rows.iter().map(keys).collect::<Vec<_>>(), expected);

    let row = &rows[6];
    let stats = folder
        .run(&["stats", "abop-honda-a", "--define", "r1=0.8", "--set", "angle_jitter=5", "--json"])
        .done()
        .json();
    for number in NUMBERS {
        let (found, told) = (&row[number.name], &stats[number.name]);
        match told {
            serde_json::Value::Number(told) => {
                assert_eq!(found.parse::<f64>().ok(), told.as_f64(), "{}", number.name);
            }
            serde_json::Value::Null => assert_eq!(found, "", "{}", number.name),
            serde_json::Value::String(told) => assert_eq!(found, told, "{}", number.name),
            _ => {}
        }
    }
    // What a row says of itself grows the same tree.
    folder.write("again.json", &row["recipe"]);
    let again = folder.run(&["stats", "again.json", "--json"]).done().json();
    assert_eq!(again["skeleton_hash"], row["skeleton_hash"].as_str());
    assert_eq!(row["error"], "");
}

#[test]
fn what_changes_nothing_in_a_sweep_is_noted() {
    let folder = Folder::new();
    let sweep = |args: &[&str], file: &str| {
        let said = folder.run(&[&["sweep", "abop-honda-a", "-o", file], args].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.err
    };
    let note = |name: &str| {
        format!(
            "note: {name} changes nothing in this table: trees that differ by it alone have the same skeleton, organs and \
             numbers\n"
        )
    };
    // Its turns have angles of their own, and there is no chance in it.
    let idle = ["--define", "r1=0.7,0.8", "--set", "angle=20,30", "--set", "derivations=4,5", "--seeds", "2"];
    let expected = note("angle") + &note("seed");
    assert_eq!(sweep(&idle, "a.csv"), expected);
    assert_eq!(sweep(&idle, "a.jsonl"), expected);
    // What changes the surface alone is no less a change.
    assert_eq!(sweep(&["--set", "derivations=4", "--set", "sides=6,8"], "b.csv"), "");
    // Of a table that was begun before nothing is said.
    let whole = text(&folder, "a.csv");
    folder.write("a.csv", &whole[..whole.len() / 2]);
    assert_eq!(sweep(&[&idle[..], &["--resume"]].concat(), "a.csv"), "");
    assert!(text(&folder, "a.csv") == whole);
}

#[test]
fn a_table_has_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    for file in ["table.csv", "table.jsonl"] {
        let of = |threads: &str| {
            let args: Vec<&str> = SWEEP.iter().copied().chain([file, "--overwrite"]).collect();
            let output = linden()
                .args(args)
                .current_dir(folder.path())
                .env("RAYON_NUM_THREADS", threads)
                .stdin(Stdio::null())
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            text(&folder, file)
        };
        assert!(of("1") == of("4"), "{file}");
    }
    let lines = text(&folder, "table.jsonl");
    let first: serde_json::Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    assert_eq!((first["define.r1"].as_f64(), first["seed"].as_u64()), (Some(0.7), Some(1)));
    assert!(first["error"].is_null() && first["recipe"]["lsystem"].is_object() && first["dbh_m"].is_number());
    assert_eq!(lines.lines().count(), 12);
    let printed = folder.run(&[&SWEEP[..], &["-"]].concat()).done().out;
    assert!(printed == text(&folder, "table.csv"));
}

#[test]
fn what_was_stopped_is_resumed_and_nothing_is_lost_by_accident() {
    let folder = Folder::new();
    for file in ["table.csv", "table.jsonl"] {
        sweep(&folder, file, &[]).done();
        let whole = text(&folder, file);
        // In the middle of a row, after one, in the header, before all.
        for at in [whole.len() / 2, whole[..whole.len() / 2].rfind('\n').unwrap() + 1, 10, 0] {
            folder.write(file, &whole[..at]);
            sweep(&folder, file, &["--resume"]).done();
            assert!(text(&folder, file) == whole, "{file} from {at}");
        }
        let said = sweep(&folder, file, &[]);
        assert_eq!(said.code, Some(2));
        assert!(said.err.contains("is there already: --resume keeps its rows"), "{}", said.err);
        for other in [&["--set", "angle=20"][..], &["--seed", "7"]] {
            let said = sweep(&folder, file, &[&["--resume"], other].concat());
            assert_eq!(said.code, Some(1), "{other:?}: {}", said.err);
            assert!(said.err.contains("take another file, or --overwrite"), "{}", said.err);
        }
        assert!(text(&folder, file) == whole, "left as it was");
    }
}

#[test]
fn a_tree_that_fails_has_a_row_that_says_why() {
    let folder = Folder::new();
    let sweep = |further: &[&str]| {
        let args = ["sweep", "abop-a", "--set", "symbol_limit=5000,100000", "-o", "table.csv", "--overwrite"];
        folder.run(&[&args, further].concat())
    };
    let said = sweep(&[]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("1 of 2 trees failed; the column 'error' says why"), "{}", said.err);
    let table = rows(&text(&folder, "table.csv"));
    assert!(table[0]["error"].contains("limit of 5000") && table[0]["height_m"].is_empty(), "{:?}", table[0]);
    assert!(table[1]["error"].is_empty() && table[1]["segments"] == "3125");
    let said = sweep(&["--fail-fast"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("tree 1: "), "{}", said.err);
    assert_eq!(rows(&text(&folder, "table.csv")).len(), 1);
}

#[test]
fn mistakes_of_the_command_line_are_said_before_anything_grows() {
    let folder = Folder::new();
    for (args, expected) in [
        (&["--define", "r11=0.5"][..], "did you mean 'r1'?"),
        (&["--define", "r1=0.5:0.9"], "has no step"),
        (&["--define", "r1=0.5:0.9:0"], "never comes from"),
        (&["--define", "r1=x"], "'x' is not 0.5 to 1"),
        (&["--set", "angel=20:40:5"], "did you mean 'angle'"),
        (&["--set", "angle=20:4000:5"], "knob 'angle'"),
        (&["--set", "seed=1:5:1"], "--seeds N"),
        (&["--set", "angle=1", "--set", "angle=2"], "varied twice"),
        (&["--age", "ancient"], "--age"),
        (&["--age", "0.5", "--set", "derivations=4,5"], "both say how old it is"),
        (&["--edit", "prune stem/1"], "prune"),
    ] {
        let said = folder.run(&[&["sweep", "abop-honda-a", "-o", "t.csv"], args].concat());
        assert!(said.code == Some(2) && said.err.contains(expected), "{args:?}: {}", said.err);
    }
    let said = folder.run(&["sweep", "abop-honda-a", "-o", "t.xlsx"]);
    assert!(said.code == Some(2) && said.err.contains(".csv or .jsonl"), "{}", said.err);
    let said = folder.run(&["sweep", "fir", "--define", "r=1", "-o", "t.csv"]);
    assert!(said.code == Some(2) && said.err.contains("grows by no grammar"), "{}", said.err);
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

#[test]
fn trees_are_of_the_age_and_have_the_edits_that_were_named() {
    let folder = Folder::new();
    let heights = |further: &[&str]| -> Vec<f64> {
        let args = [&["sweep", "abop-honda-a", "--set", "angle_jitter=0,2", "-o", "-"], further].concat();
        let table = folder.run(&args).done().out;
        rows(&table).iter().map(|row| row["height_m"].parse().unwrap()).collect()
    };
    let grown = heights(&[]);
    let young = heights(&["--age", "0.5"]);
    assert!(young.iter().zip(&grown).all(|(young, grown)| *young < 0.9 * grown), "{young:?} {grown:?}");
    let cut = heights(&["--edit", "cut stem 0.3"]);
    assert!(cut.iter().zip(&grown).all(|(cut, grown)| cut < grown), "{cut:?} {grown:?}");
    // As other commands have it.
    let args = [
        "stats",
        "abop-honda-a",
        "--set",
        "angle_jitter=2",
        "--age",
        "0.5",
        "--edit",
        "cut stem 0.3",
        "--json",
    ];
    let stats = folder.run(&args).done().json();
    let both = heights(&["--age", "0.5", "--edit", "cut stem 0.3"]);
    assert_eq!(stats["height_m"].as_f64(), Some(both[1]));
}

#[test]
fn constants_are_shown_set_and_kept_in_the_recipe() {
    let folder = Folder::new();
    let shown = folder.run(&["show", "abop-honda-a", "--define", "r1=0.75"]).done().out;
    assert!(shown.contains("constants (--define NAME=VALUE)\n  r1 = 0.75\n"), "{shown}");
    let json = folder.run(&["show", "abop-honda-a", "--json"]).done().json();
    assert_eq!(
        (json["constants"][0]["name"].as_str(), json["constants"][0]["value"].as_f64()),
        (Some("r1"), Some(0.9))
    );
    let hash = |args: &[&str]| folder.run(args).done().json()["skeleton_hash"].as_str().unwrap().to_owned();
    let defined = hash(&["stats", "abop-honda-a", "--define", "r1=0.75", "--json"]);
    assert_ne!(defined, hash(&["stats", "abop-honda-a", "--json"]));
    folder.run(&["export", "abop-honda-a", "--define", "r1=0.75", "-o", "honda.glb"]).done();
    assert_eq!(hash(&["stats", "honda.glb", "--json"]), defined);
    // A preset with that line says the same.
    let document = folder.run(&["show", "abop-honda-a", "--toml"]).done().out;
    folder.write("mine.toml", document.replace("#define r1 0.9", "#define r1 0.75"));
    assert_eq!(hash(&["stats", "mine.toml", "--json"]), defined);
    for (args, expected) in [
        (&["stats", "abop-honda-a", "--define", "R1=1"][..], "did you mean 'r1'?"),
        (&["stats", "abop-honda-a", "--define", "r1"], "expected NAME=VALUE"),
        (&["stats", "oak", "--define", "r1=1"], "grows by no grammar"),
        (&["export", "abop-a", "abop-b", "--define", "r1=1", "-o", "x.glb"], "export each by itself"),
    ] {
        let said = folder.run(args);
        assert!(said.code == Some(2) && said.err.contains(expected), "{args:?}: {}", said.err);
    }
}

#[test]
fn numbers_of_a_reduced_tree_are_all_of_that_tree() {
    let folder = Folder::new();
    let whole = folder.run(&["stats", "dressed-simple", "--json"]).done().json();
    let few = folder.run(&["stats", "dressed-simple", "--triangles", "3000", "--json"]).done().json();
    assert_eq!((whole["tree"].as_str(), few["tree"].as_str()), (Some("whole"), Some("reduced")));
    assert!((few["triangles"].as_f64().unwrap() / 3000.0 - 1.0).abs() < 0.06);
    for name in ["nodes", "segments", "axes", "total_length_m", "wood_volume_m3", "tips"] {
        assert!(few[name].as_f64() < whole[name].as_f64(), "{name}: {} {}", few[name], whole[name]);
    }
    // Branch cards stand for all leaves; without them, some are left out.
    assert_eq!(few["leaves"], whole["leaves"]);
    let thinned = ["stats", "dressed-simple", "--triangles", "3000", "--set", "branch_cards=false", "--json"];
    assert!(folder.run(&thinned).done().json()["leaves"].as_f64() < whole["leaves"].as_f64());
    // Which tree it is does not change.
    assert_eq!(few["skeleton_hash"], whole["skeleton_hash"]);
}

#[test]
fn breast_height_is_said_only_where_there_is_one() {
    let folder = Folder::new();
    let small = folder.run(&["stats", "male-fern", "--json"]).done().json();
    assert!(small["dbh_m"].is_null() && small["trunk_diameter_at_m"] == 0.0, "{small}");
    let tall = folder.run(&["stats", "fir", "--json"]).done().json();
    assert!(tall["dbh_m"] == tall["trunk_diameter_m"] && tall["trunk_diameter_at_m"] == 1.3, "{tall}");
    // Turned about the upright, it is as wide.
    let widths = ["crown_width_m", "crown_width_least_m", "crown_width_most_m", "crown_projection_m2"];
    assert!(widths.iter().all(|name| tall[name].as_f64().unwrap() > 0.0));
    let [mean, least, most] = [0, 1, 2].map(|i| tall[widths[i]].as_f64().unwrap());
    assert!(least <= mean && mean <= most);
}

#[test]
fn the_schema_of_numbers_is_their_table() {
    let folder = Folder::new();
    let schema = folder.run(&["schema", "--stats"]).done().json();
    let stats = folder.run(&["stats", "abop-a", "--json"]).done().json();
    let rows = schema.as_array().unwrap();
    assert_eq!(rows.len(), NUMBERS.len());
    for row in rows {
        let name = row["name"].as_str().unwrap();
        assert!(stats.get(name).is_some(), "{name}");
        assert!(
            !row["definition"].as_str().unwrap().is_empty() && !row["includes"].as_str().unwrap().is_empty()
        );
    }
}
