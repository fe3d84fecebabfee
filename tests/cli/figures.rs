//! What `stats` says of a plant is what the files hold, each counted from its own bytes.

use serde_json::Value;

use crate::program::Folder;

/// Both generators, leaves of several forms, one plant with two kinds.
const PLANTS: [&str; 5] = ["date-palm", "dressed-honda-a", "dressed-simple", "male-fern", "sunflower"];

struct Count {
    triangles: u64,
    min: [f64; 3],
    max: [f64; 3],
}

impl Count {
    fn new() -> Self {
        Self { triangles: 0, min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] }
    }

    fn take(&mut self, point: [f64; 3]) {
        for (axis, &x) in point.iter().enumerate() {
            self.min[axis] = self.min[axis].min(x);
            self.max[axis] = self.max[axis].max(x);
        }
    }
}

fn vector(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap())
}

/// From the accessors; and the triangles of all parts but the wood.
fn of_glb(bytes: &[u8]) -> (Count, u64) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let (mut count, mut leaves) = (Count::new(), 0);
    for mesh in json["meshes"].as_array().unwrap() {
        for primitive in mesh["primitives"].as_array().unwrap() {
            let accessor = |index: &Value| &json["accessors"][index.as_u64().unwrap() as usize];
            let triangles = accessor(&primitive["indices"])["count"].as_u64().unwrap() / 3;
            count.triangles += triangles;
            leaves +=
                if mesh["name"].as_str().is_some_and(|name| name.ends_with("_wood")) { 0 } else { triangles };
            let positions = accessor(&primitive["attributes"]["POSITION"]);
            count.take(vector(&positions["min"]));
            count.take(vector(&positions["max"]));
        }
    }
    (count, leaves)
}

fn of_obj(text: &str) -> Count {
    let mut count = Count::new();
    for line in text.lines() {
        if let Some(numbers) = line.strip_prefix("v ") {
            let numbers: Vec<f64> = numbers.split(' ').take(3).map(|n| n.parse().unwrap()).collect();
            count.take([numbers[0], numbers[1], numbers[2]]);
        }
        count.triangles += u64::from(line.starts_with("f "));
    }
    count
}

#[test]
fn stats_and_every_format_agree_on_dressed_plants() {
    let folder = Folder::new();
    for plant in PLANTS {
        let stats = folder.run(&["stats", plant, "--json"]).done().json();
        folder.run(&["export", plant, "-o", "a.glb", "-o", "a.obj", "-o", "a.ply", "-o", "a.usda"]).done();
        let (glb, leaf_triangles) = of_glb(&folder.read("a.glb"));
        let obj = of_obj(&String::from_utf8(folder.read("a.obj")).unwrap());
        let triangles = stats["triangles"].as_u64().unwrap();
        assert_eq!((glb.triangles, obj.triangles), (triangles, triangles), "{plant}");
        let ply = String::from_utf8_lossy(&folder.read("a.ply")).into_owned();
        assert!(ply.contains(&format!("element face {triangles}\n")), "{plant}");
        let usda = String::from_utf8(folder.read("a.usda")).unwrap();
        let lists = usda.split("int[] faceVertexCounts = [").skip(1);
        let in_usda: usize = lists.map(|list| list[..list.find(']').unwrap()].matches('3').count()).sum();
        assert_eq!(in_usda as u64, triangles, "{plant}");

        let bounds = &stats["bounds"];
        for count in [&glb, &obj] {
            for (found, told) in [(count.min, vector(&bounds["min"])), (count.max, vector(&bounds["max"]))] {
                let off = found.iter().zip(told).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-4, "{plant}: {found:?}, told {told:?}");
            }
        }
        let leaves = stats["leaves"].as_u64().unwrap();
        assert!(leaves > 0 && leaf_triangles >= leaves, "{plant}: {leaves}");
        // Of one kind, all have the same number of triangles.
        if plant.starts_with("dressed") || plant == "male-fern" {
            assert_eq!(leaf_triangles % leaves, 0, "{plant}: {leaf_triangles} of {leaves}");
        }
    }
}

#[test]
fn timings_add_up_and_name_the_files() {
    let folder = Folder::new();
    let args = ["export", "simple", "--set", "bark_size=32", "--format", "glb,obj"];
    let found = folder.run(&[&args[..], &["--timings", "--json"]].concat()).done().json();
    let number =
        |of: &serde_json::Value, name: &str| of[name].as_f64().unwrap_or_else(|| panic!("{name} in {of}"));
    let steps = found["steps"].as_array().unwrap();
    let names: Vec<&str> = steps.iter().map(|step| step["step"].as_str().unwrap()).collect();
    assert_eq!(names, ["read", "grow", "dress", "write", "commit"]);
    for name in ["seconds", "cpu_seconds"] {
        let sum: f64 = steps.iter().map(|step| number(step, name)).sum();
        assert!((sum - number(&found, name)).abs() < 1e-6 && sum > 0.0, "{found}");
    }
    // What a process of this kind needs at least, and what a tree of this size cannot.
    assert!((1e6..1e9).contains(&number(&found, "peak_memory_bytes")), "{found}");
    assert!(number(&found, "threads") >= 1.0);
    let files = found["files"].as_array().unwrap();
    assert!(files.len() >= 3, "{found}");
    for file in files {
        let there = std::fs::metadata(folder.file(file["path"].as_str().unwrap())).unwrap().len();
        assert_eq!(file["bytes"].as_u64(), Some(there), "{file}");
    }
    let table = folder.run(&[&args[..], &["--timings"]].concat());
    assert_eq!(table.code, Some(0));
    assert!(table.err.contains("commit") && table.err.contains("threads"), "{}", table.err);
    assert!(table.out.contains("simple.glb"), "{}", table.out);
    let said = folder.run(&["export", "simple", "--format", "glb", "-o", "-", "--timings", "--json"]);
    assert!(said.code == Some(2) && said.err.contains("standard output"), "{}", said.err);
}

#[test]
fn triangles_are_told_where_some_number_of_them_is_asked_for() {
    let folder = Folder::new();
    let args = ["export", "simple", "--set", "bark_size=32", "-o", "t.glb"];
    let asked = ["--triangles", "4000", "--lods", "2"];
    assert!(!folder.run(&args).done().out.contains("triangles"));
    let told = folder.run(&[&args[..], &asked].concat()).done().out;
    let found = folder.run(&[&args[..], &asked, &["--timings", "--json"]].concat()).done().json();
    let levels: Vec<u64> =
        found["triangles"].as_array().unwrap().iter().filter_map(serde_json::Value::as_u64).collect();
    assert!(levels.len() == 2 && (3800..=4200).contains(&levels[0]), "{found}");
    // More than the tree has is no budget that was missed.
    let said = folder.run(&[&args[..], &["--triangles", "99999999"]].concat());
    assert!(
        said.code == Some(0) && said.err.contains("has no more than") && said.err.lines().count() == 1,
        "{}",
        said.err
    );
    let said = folder.run(&["export", "simple", "--triangles", "4000", "--format", "mtg", "-o", "t.mtg"]);
    assert!(said.code == Some(0) && !said.err.contains("not met"), "{}", said.err);
    let digits: String = told.chars().filter(char::is_ascii_digit).collect();
    assert!(
        digits.ends_with(&format!("{}{}", levels[0], levels[1])) && told.ends_with(" triangles\n"),
        "{told}"
    );
}

#[test]
fn files_are_listed_for_programs_and_stay_where_nothing_changes() {
    let folder = Folder::new();
    let args = ["export", "simple", "--set", "bark_size=32", "--if-changed", "--json", "-o", "a.obj"];
    let times = || {
        let found = folder.run(&args).done().json();
        let files =
            found["files"].as_array().unwrap().iter().map(|file| file["path"].as_str().unwrap().to_owned());
        let time = |path: String| (std::fs::metadata(folder.file(&path)).unwrap().modified().unwrap(), path);
        files.map(time).collect::<Vec<_>>()
    };
    let first = times();
    assert!(first.len() >= 3, "{first:?}");
    assert_eq!(times(), first);
}

/// A skeleton has no surface whose triangles could be counted.
#[test]
fn triangles_are_told_of_files_that_have_some() {
    let folder = Folder::new();
    let told = |output: &str| {
        let args = ["export", "dressed-simple", "--set", "points=60", "--set", "bark_size=16", "--lods", "3"];
        let said = folder.run(&[&args[..], &["-o", output]].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out
    };
    assert!(!told("s.csv").contains("triangle"));
    assert!(told("s.obj").contains(" / ") && told("s.glb").contains(" triangles"));
}
