//! `batch`: parts of any shape, repeated and broken off, give the same files and the same index.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::time::Duration;

use crate::program::{Folder, Said, linden};

const MANIFEST: &str = r#"
formats = ["glb", "qsm"]
options = { "glb.quantize" = true }
seed = 5

[[trees]]
source = "abop-honda-a"
define = { r1 = ["0.8", "0.9"] }
set = { derivations = [3, 4], bark_size = 16 }

[[trees]]
source = "own.txt"
seeds = "1..4"
samples = 2
set = { angle = "20.0..40.0", bark_size = 16, segment_length = 0.2 }

[[trees]]
source = "fir"
seeds = [3, 9]
formats = ["obj"]
set = { points = "100..200", bark_size = 16, leaf_form = "none" }
"#;
const TREES: usize = 4 + 8 + 2;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("m.toml", MANIFEST);
    folder.write("own.txt", "axiom=F\nangle=20\nnumber of derivations=2\nF=(0.5)F[+F]F\nF=(0.5)FF\n");
    folder
}

fn batch(folder: &Folder, out: &str, further: &[&str]) -> Said {
    folder.run(&[&["batch", "m.toml", "--out", out], further].concat())
}

/// All files below a folder but the parts, which name processes.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let name = entry.path().strip_prefix(root).unwrap().to_string_lossy().into_owned();
            if entry.path().is_dir() {
                if name != "parts" {
                    folders.push(entry.path());
                }
            } else {
                found.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }
    found
}

fn index(folder: &Folder, out: &str) -> Vec<serde_json::Value> {
    let text = String::from_utf8(folder.read(&format!("{out}/index.jsonl"))).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn all_at_once(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    assert_eq!(batch(folder, "whole", &[]).code, Some(0));
    assert_eq!(batch(folder, "whole", &["--merge"]).code, Some(0));
    files(&folder.file("whole"))
}

#[test]
fn a_batch_is_the_trees_of_its_manifest() {
    let folder = folder();
    let whole = all_at_once(&folder);
    let rows = index(&folder, "whole");
    assert_eq!(rows.len(), TREES);
    assert!(rows.iter().enumerate().all(|(number, row)| row["index"] == number));
    let varied = |row: &serde_json::Value| (row["define"]["r1"].clone(), row["set"]["derivations"].clone());
    let firsts: Vec<_> = rows.iter().take(4).map(varied).collect();
    let expected = [("0.8", "3"), ("0.9", "3"), ("0.8", "4"), ("0.9", "4")];
    let firsts: Vec<_> = firsts.iter().map(|(r1, n)| (r1.as_str().unwrap(), n.as_str().unwrap())).collect();
    assert_eq!(firsts, expected);
    // Each file is what export writes for the same tree.
    let row = &rows[2];
    let r1 = format!("r1={}", row["define"]["r1"].as_str().unwrap());
    let derivations = format!("derivations={}", row["set"]["derivations"].as_str().unwrap());
    let args = ["export", "abop-honda-a", "--define", &r1, "--set", &derivations, "--set", "bark_size=16"];
    folder.run(&[&args[..], &["--quantize", "-o", "one.glb"]].concat()).done();
    let path = row["files"][0]["path"].as_str().unwrap();
    assert!(whole[path] == folder.read("one.glb"));
    // What is drawn is within its bounds and differs.
    let angles: BTreeSet<String> = rows[4..12].iter().map(|row| row["set"]["angle"].to_string()).collect();
    assert_eq!(angles.len(), 8);
    assert!(rows[12]["set"]["points"].as_str().unwrap().parse::<u32>().unwrap() >= 100);
    // An OBJ comes with its material and pictures, and each of them is in the row.
    let names: Vec<&str> =
        rows[12]["files"].as_array().unwrap().iter().filter_map(|f| f["path"].as_str()).collect();
    assert!(names.len() > 2 && names.iter().all(|name| whole.contains_key(*name)), "{names:?}");
}

#[test]
fn shards_repeats_and_other_numbers_of_jobs_give_the_same_bytes() {
    let folder = folder();
    let whole = all_at_once(&folder);
    for shard in ["2/3", "0/3", "1/3", "0/3"] {
        assert_eq!(batch(&folder, "parts", &["--shard", shard, "--jobs", "3"]).code, Some(0));
    }
    batch(&folder, "parts", &["--merge"]);
    assert!(files(&folder.file("parts")) == whole);
    // Chunks that overlap, the second time only what is missing.
    let said = batch(&folder, "chunks", &["--only", "0-5", "--jobs", "1"]).out;
    assert!(said.starts_with("6 trees"), "{said}");
    let said = batch(&folder, "chunks", &["--only", "3-13", "--resume"]).out;
    assert!(said.starts_with("8 trees"), "{said}");
    assert!(batch(&folder, "chunks", &["--resume"]).err.contains("there already"));
    batch(&folder, "chunks", &["--merge"]);
    assert!(files(&folder.file("chunks")) == whole);
}

#[test]
fn a_batch_that_is_killed_again_and_again_ends_as_one_that_was_not() {
    let folder = folder();
    let whole = all_at_once(&folder);
    let mut delay = 20;
    for _ in 0..12 {
        let mut child = linden()
            .args(["batch", "m.toml", "--out", "killed", "--resume"])
            .current_dir(folder.path())
            .stderr(std::process::Stdio::null())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(delay));
        let _ = child.kill();
        child.wait().unwrap();
        delay = delay * 5 / 4;
    }
    let said = batch(&folder, "killed", &["--resume"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(batch(&folder, "killed", &["--merge"]).code, Some(0));
    let found = files(&folder.file("killed"));
    for (name, bytes) in &whole {
        assert!(found.get(name) == Some(bytes), "{name}");
    }
    // What a killed worker left behind are temporary files, which the next one to write there sweeps.
    let strange: Vec<&String> =
        found.keys().filter(|name| !whole.contains_key(*name) && !name.contains(".linden-")).collect();
    assert!(strange.is_empty(), "{strange:?}");
}

#[test]
fn a_tree_that_fails_stops_no_other() {
    let folder = Folder::new();
    folder.write(
        "m.toml",
        "formats = [\"qsm\"]\n[[trees]]\nsource = \"abop-a\"\nset = { derivations = [2, 40, 3] }\n",
    );
    let said = batch(&folder, "out", &[]);
    assert!(said.code == Some(1) && said.err.contains("tree 1: "), "{}", said.err);
    let said = batch(&folder, "out", &["--merge"]);
    assert!(said.code == Some(1) && said.out.starts_with("2 of 3 trees"), "{} {}", said.out, said.err);
    let rows = index(&folder, "out");
    assert!(rows[1]["error"].as_str().unwrap().contains("40 derivations"), "{}", rows[1]);
    assert!(rows[0]["error"].is_null() && rows[2]["error"].is_null());
    let said = batch(&folder, "fast", &["--fail-fast", "--jobs", "1"]);
    assert!(said.code == Some(1) && said.err.contains("tree 1: "));
    let said = batch(&folder, "fast", &["--merge"]);
    assert!(said.err.contains("1 are missing: --only 2"), "{}", said.err);
}

/// A value that its knob does not have, behind one that it has.
#[test]
fn a_tree_that_cannot_be_is_a_row_like_any_other() {
    let folder = Folder::new();
    folder.write(
        "m.toml",
        "formats = [\"qsm\"]\n[[trees]]\nsource = \"abop-a\"\nset = { derivations = 2, season = [0.2, 3, 0.8] }\n",
    );
    for further in [&[][..], &["--resume"]] {
        let said = batch(&folder, "out", further);
        assert!(
            said.code == Some(1) && said.err.contains("tree 1: ") && said.err.contains("season"),
            "{}",
            said.err
        );
    }
    let said = batch(&folder, "out", &["--merge"]);
    assert!(said.code == Some(1) && said.out.starts_with("2 of 3 trees"), "{} {}", said.out, said.err);
    let rows = index(&folder, "out");
    assert!(rows.len() == 3 && rows[1]["error"].as_str().unwrap().contains("season"), "{}", rows[1]);
}

#[test]
fn mistakes_are_told_before_anything_grows() {
    let folder = folder();
    for (args, expected) in [
        (&["--shard", "3/3"][..], "shards of 3 are 0/3 to 2/3"),
        (&["--only", "9-20"], "the manifest has 14 trees"),
        (&["--only", "x"], "expected numbers and ranges"),
        (&["--merge"], "there is no such folder; leave --merge out"),
    ] {
        let said = batch(&folder, "out", args);
        assert!(said.code == Some(2) && said.err.contains(expected), "{}", said.err);
    }
    for (text, expected) in [
        ("formats = [\"glb\"]\n[[trees]]\nsource = \"oka\"\n", "oak"),
        (
            "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nseeds = \"0..18446744073709551615\"\n",
            "more than 10000000",
        ),
        // Mistakes of the document itself.
        ("formats = [\"glb\"\n", "m.toml:"),
        ("format = [\"glb\"]\n", "did you mean 'formats'"),
        ("formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nseeds = \"5..1\"\n", "write 1..5"),
        ("formats = [\"qsm\", \"qsm\"]\n[[trees]]\nsource = \"oak\"\n", "qsm twice"),
        ("formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nset = { points = \"9..1\" }\n", "m.toml:4:"),
        ("{\"source\": \"oak\"}\n[]\n", "m.toml:2:1"),
        ("formats = [\"gbl\"]\n[[trees]]\nsource = \"oak\"\n", "glb"),
        ("formats = [\"glb\"]\n[[trees]]\nsource = \"fir\"\nset = { pionts = 3 }\n", "points"),
        (
            "formats = [\"glb\"]\noptions = { \"obj.x\" = 1 }\n[[trees]]\nsource = \"oak\"\n",
            "no format that is written",
        ),
    ] {
        folder.write("m.toml", text);
        let said = batch(&folder, "out", &[]);
        assert!(said.code == Some(2) && said.err.contains(expected), "{text}: {}", said.err);
    }
    assert!(!folder.file("out").exists());
    let said = folder.run(&["batch", "none.toml"]);
    assert!(said.code == Some(2) && said.err.contains("there is no file 'none.toml'"), "{}", said.err);
    assert!(!said.err.contains("preset"), "{}", said.err);
}

/// Farms start as many parts as they like.
#[test]
fn a_shard_without_trees_says_so() {
    let folder = folder();
    let said = batch(&folder, "out", &["--shard", "20/30"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    assert!(said.err.contains("shard 20/30 has no trees: the manifest has only 14"), "{}", said.err);
    assert!(!said.err.contains("there already") && !folder.file("out").exists(), "{}", said.err);
}

#[test]
fn flags_of_other_modes_are_refused() {
    let folder = folder();
    for flag in ["--sheet=s.png", "--usd=all.usda", "--tiles=t.json", "--places=p.csv"] {
        for mode in [&[][..], &["--resume"], &["--dry-run"], &["--shard", "0/2"], &["--template", "slurm"]] {
            let said = batch(&folder, "out", &[mode, &[flag]].concat());
            assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{mode:?} {flag}: {}", said.err);
        }
    }
    for mode in [&[][..], &["--resume"], &["--dry-run"], &["--merge"], &["--only", "0"], &["--shard", "0/2"]]
    {
        let said = batch(&folder, "out", &[mode, &["--parts", "3"]].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{mode:?}: {}", said.err);
    }
    assert!(!folder.file("out").exists());
}

/// As `export` says it of each, but once for all of them.
#[test]
fn what_has_no_effect_is_said_once_and_in_the_rows() {
    let folder = Folder::new();
    folder.write(
        "m.toml",
        "formats = [\"obj\"]\n[[trees]]\nsource = \"dressed-simple\"\nseeds = \"1..4\"\n\
         set = { points = 60, bark_size = 16, leaf_size = 32, wind = \"sway\", lod_ratio = 0.5 }\n",
    );
    let one = folder.run(&[
        "export",
        "dressed-simple",
        "-o",
        "one.obj",
        "--seed",
        "1",
        "--set",
        "points=60",
        "--set",
        "bark_size=16",
        "--set",
        "leaf_size=32",
        "--set",
        "wind=sway",
        "--set",
        "lod_ratio=0.5",
    ]);
    let expected: BTreeSet<&str> = one.err.lines().filter_map(|line| line.strip_prefix("note: ")).collect();
    assert!(expected.len() > 1 && one.err.contains("holds no wind"), "{}", one.err);
    let said = batch(&folder, "whole", &["--jobs", "1"]);
    let of_all: BTreeSet<&str> = said
        .err
        .lines()
        .map(|line| line.strip_prefix("note: ").and_then(|line| line.strip_suffix(" (4 trees)")).expect(line))
        .collect();
    assert_eq!((said.code, of_all), (Some(0), expected.clone()), "{}", said.err);
    assert_eq!(said.err.lines().count(), expected.len(), "{}", said.err);
    assert_eq!(batch(&folder, "again", &["--jobs", "3"]).err, said.err);
    for shard in ["1/2", "0/2"] {
        let said = batch(&folder, "parts", &["--shard", shard]);
        assert!(said.err.lines().all(|line| line.ends_with(" (2 trees)")), "{}", said.err);
        assert_eq!(said.err.lines().count(), expected.len(), "{}", said.err);
    }
    for out in ["whole", "parts"] {
        assert_eq!(batch(&folder, out, &["--merge"]).code, Some(0));
        for row in index(&folder, out) {
            let notes = row["notes"].as_array().unwrap().iter().filter_map(|note| note.as_str());
            assert_eq!(notes.collect::<BTreeSet<_>>(), expected);
            assert!(row["wind_loop"].is_null(), "OBJ does not sway: {row}");
        }
    }
    assert!(files(&folder.file("whole")) == files(&folder.file("parts")));
}

#[test]
fn a_manifest_names_no_files_outside_its_folder() {
    let folder = Folder::new();
    folder.write("secret.txt", "axiom=F\nangle=20\nnumber of derivations=2\nF=FF\n");
    std::fs::create_dir(folder.file("jail")).unwrap();
    folder.write("jail/own.txt", "axiom=F\nangle=20\nnumber of derivations=2\nF=F[+F]F\n");
    let secret = folder.file("secret.txt");
    for name in ["../secret.txt", secret.to_str().unwrap(), "../../../etc/passwd", "/etc/passwd"] {
        folder.write("jail/m.toml", format!("formats = [\"qsm\"]\n[[trees]]\nsource = '{name}'\n"));
        let said = folder.run(&["batch", "jail/m.toml", "--out", "out"]);
        assert!(said.code == Some(2) && said.err.contains("--allow-path"), "{name}: {}", said.err);
        assert!(!folder.file("out").exists(), "{name}");
    }
    folder.write("jail/m.toml", "formats = [\"qsm\"]\n[[trees]]\nsource = \"own.txt\"\n");
    assert_eq!(folder.run(&["batch", "jail/m.toml", "--out", "out"]).code, Some(0));
    folder.write("jail/m.toml", "formats = [\"qsm\"]\n[[trees]]\nsource = \"../secret.txt\"\n");
    let allowed = ["batch", "jail/m.toml", "--out", "allowed", "--allow-path", "."];
    assert_eq!(folder.run(&allowed).code, Some(0));
}

#[test]
fn a_dry_run_says_what_it_will_be() {
    let folder = folder();
    let said = batch(&folder, "out", &["--dry-run"]);
    assert!(said.out.contains("trees    14") && said.out.contains("MiB"), "{}", said.out);
    assert!(!folder.file("out").exists());
}

/// Pictures beside files count once for all trees that share them.
#[test]
fn a_dry_run_says_how_many_bytes_there_will_be() {
    let folder = Folder::new();
    let trees = "[[trees]]\nsource = \"simple\"\nseeds = \"1..12\"\n";
    for formats in ["\"usda\"", "\"glb\", \"obj\""] {
        for bark in ["bark_seed = 2", "bark_seed = \"1..1000\""] {
            let set = format!("set = {{ points = 150, leaf_form = \"none\", bark_size = 256, {bark} }}\n");
            folder.write("m.toml", format!("formats = [{formats}]\n{trees}{set}"));
            let said = batch(&folder, "out", &["--dry-run"]).done().out;
            let words: Vec<&str> = said.split_whitespace().collect();
            let at = words.iter().position(|word| *word == "bytes").unwrap();
            assert_eq!(words[at + 2], "MiB", "{said}");
            let forecast = words[at + 1].parse::<f64>().unwrap() * f64::from(1 << 20);
            batch(&folder, "out", &[]).done();
            let bytes: usize = files(&folder.file("out")).values().map(Vec::len).sum();
            let ratio = forecast / bytes as f64;
            assert!((0.7..1.3).contains(&ratio), "{formats}, {bark}: {ratio}");
            fs::remove_dir_all(folder.file("out")).unwrap();
        }
    }
}

/// The jobs that are printed, with a shell in the place of what would start it: all parts, then the index.
#[test]
fn jobs_that_are_printed_make_the_whole_batch() {
    let folder = folder();
    let whole = all_at_once(&folder);
    let program = Path::new(env!("CARGO_BIN_EXE_linden")).parent().unwrap().to_owned();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let template = |engine: &str| {
        let args = ["batch", "m.toml", "--out", "of it's", "--template", engine, "--parts", "3"];
        let said = folder.run(&args);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out
    };
    let sh = |script: &str, variables: &[(&str, String)]| {
        let mut command = std::process::Command::new("sh");
        command.args(["-c", script]).current_dir(folder.path()).env("PATH", &path);
        let output = command.envs(variables.iter().map(|(name, value)| (name, value))).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let slurm = template("slurm");
    assert!(slurm.contains("--array=0-2\n"), "{slurm}");
    for task in 0..3 {
        sh(&slurm, &[("SLURM_ARRAY_TASK_ID", task.to_string())]);
    }
    let merge = slurm.lines().find_map(|line| line.split_once("--wrap=")).unwrap().1;
    sh(&format!("sh -c {merge}"), &[]);
    assert!(files(&folder.file("of it's")) == whole);

    // GNU parallel, as far as this needs it: a line of a shell for each word it reads.
    fs::remove_dir_all(folder.file("of it's")).unwrap();
    folder.write(
        "parallel",
        "#!/bin/sh\nshift 3\nwhile read n; do sh -c \"$(echo \"$*\" | sed \"s/{}/$n/\")\" || exit; done\n",
    );
    let parallel = template("parallel");
    sh(&format!("chmod +x parallel; export PATH=.:$PATH\n{parallel}"), &[]);
    assert!(files(&folder.file("of it's")) == whole);

    for (engine, expected) in [("openjd", "default: \"0-13\""), ("kubernetes", "completions: 3\n")] {
        assert!(template(engine).contains(expected) && template(engine).contains("\"of it's\""), "{engine}");
    }
}

/// What an OBJ's material, a glTF and a USD refer to, from their own folder.
fn references(path: &str, bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    let ending = Path::new(path).extension().and_then(|ending| ending.to_str());
    let found: Vec<String> = match ending {
        Some("mtl") => text
            .lines()
            .filter(|line| ["map_", "norm "].iter().any(|key| line.starts_with(key)))
            .filter_map(|line| Some(line.split_once(' ')?.1.trim_start_matches("-bm 1 ").to_owned()))
            .collect(),
        Some("gltf") => {
            let document: serde_json::Value = serde_json::from_str(&text).unwrap();
            let uris =
                document["images"].as_array().unwrap().iter().map(|image| image["uri"].as_str().unwrap());
            uris.map(str::to_owned).collect()
        }
        Some("usda") => {
            let assets = text.lines().filter_map(|line| line.split_once("inputs:file = @"));
            assets.filter_map(|(_, rest)| Some(rest.split_once('@')?.0.to_owned())).collect()
        }
        _ => Vec::new(),
    };
    found.into_iter().map(|way| way.strip_prefix("../").expect(&way).to_owned()).collect()
}

#[test]
fn trees_that_look_alike_share_their_pictures() {
    let folder = Folder::new();
    let manifest = r#"
formats = ["obj", "gltf", "usda"]
[[trees]]
source = "dressed-simple"
seeds = "1..4"
set = { points = 60, bark_size = 16, leaf_size = 32, bark_seed = [1, 2] }
"#;
    folder.write("m.toml", manifest);
    assert_eq!(batch(&folder, "out", &["--jobs", "2"]).code, Some(0));
    assert_eq!(batch(&folder, "out", &["--merge"]).code, Some(0));
    let whole = files(&folder.file("out"));
    let pictures: BTreeSet<&String> = whole.keys().filter(|name| name.starts_with("pictures/")).collect();
    let referred: BTreeSet<String> = whole.iter().flat_map(|(path, bytes)| references(path, bytes)).collect();
    assert!(referred.iter().eq(pictures.iter().copied()), "{referred:?} are not {pictures:?}");
    // Two barks and one kind of leaves, colours and normals, and the leaves' opacity for OBJ.
    assert_eq!(pictures.len(), 2 * 2 + 2 + 1);
    let rows = index(&folder, "out");
    for row in &rows {
        let of_row: Vec<&str> =
            row["files"].as_array().unwrap().iter().filter_map(|f| f["path"].as_str()).collect();
        assert_eq!(of_row.iter().filter(|name| name.starts_with("pictures/")).count(), 5, "{of_row:?}");
        assert!(of_row.iter().all(|name| whole.contains_key(*name)));
    }
    // One by one, backwards, with the pictures there already.
    for only in ["6-7", "0-3:3", "1-5"] {
        assert_eq!(batch(&folder, "again", &["--only", only, "--resume"]).code, Some(0));
    }
    assert_eq!(batch(&folder, "again", &["--merge"]).code, Some(0));
    assert!(files(&folder.file("again")) == whole);
    // Their recipes give them again, with the pictures that they share.
    let verified = folder.run(&["verify", "out", "--json"]).done().json();
    let rows = verified["files"].as_array().unwrap();
    assert_eq!(rows.len(), 8 * 3);
    assert!(rows.iter().all(|file| file["outcome"] == "same-bytes"), "{verified}");
    // A picture that is gone is made again.
    fs::remove_file(folder.file("again").join(pictures.first().unwrap())).unwrap();
    assert_eq!(batch(&folder, "again", &["--merge"]).code, Some(1));
    for done in ["--resume", "--merge"] {
        assert_eq!(batch(&folder, "again", &[done]).code, Some(0));
    }
    assert!(files(&folder.file("again")) == whole);
}
