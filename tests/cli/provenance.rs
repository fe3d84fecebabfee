//! Which version, which recipe, which tree: in files, in tables, in notes and in citations.

use std::process::{Command, Stdio};

use linden::preset::Preset;
use linden::recipe::Recipe;
use serde_json::Value;

use crate::program::{Folder, Said, linden};

const SMALL: [&str; 6] = ["--set", "points=60", "--set", "bark_size=64", "--seed", "7"];

/// Hashes of trees do not hang on pictures.
const SMALL_LEAVES: [&str; 2] = ["--set", "leaf_size=32"];

/// The commit that this build is of: what packagers said, or the checkout's.
fn commit() -> Option<String> {
    if let Some(said) = option_env!("LINDEN_COMMIT") {
        return Some(said.to_owned()).filter(|said| !said.is_empty());
    }
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let done = Command::new("git").args(["-C", root, "rev-parse", "--short=7", "HEAD"]).output().ok()?;
    let is_here = std::path::Path::new(root).join(".git").exists() && done.status.success();
    is_here.then(|| String::from_utf8(done.stdout).unwrap().trim().to_owned())
}

#[test]
fn the_version_names_the_commit() {
    let folder = Folder::new();
    let expected = match commit() {
        Some(commit) => format!("linden {} ({commit})", env!("CARGO_PKG_VERSION")),
        None => format!("linden {}", env!("CARGO_PKG_VERSION")),
    };
    assert_eq!(folder.run(&["--version"]).done().out.trim_end(), expected);
    let version = expected.trim_start_matches("linden ");
    folder.run(&[&["export", "fir", "-o", "a.obj", "-o", "a.stl"], &SMALL[..]].concat());
    let text = |name: &str| String::from_utf8_lossy(&folder.read(name)[..200]).into_owned();
    assert!(text("a.obj").starts_with(&format!("# {expected}\n")), "{}", text("a.obj"));
    assert!(
        text("a.stl").contains(&format!("{expected}, metres, Z up ")),
        "a header of 80 bytes: {}",
        text("a.stl")
    );
    assert_eq!(carried(&folder, "a.obj")["linden"], version);
    assert_eq!(folder.run(&["stats", "a.obj", "--json"]).done().json()["linden_version"], version);
    assert_eq!(folder.run(&["doctor", "--json"]).json()["linden"], version);
}

/// The recipe that a file carries.
fn carried(folder: &Folder, file: &str) -> Value {
    folder.run(&["recipe", file]).done().json()
}

/// As `stats` says the hashes that a file has.
fn hashes(stats: &Value) -> Value {
    let of = |name: &str| stats[format!("{name}_hash")].clone();
    serde_json::json!({"recipe": of("recipe"), "skeleton": of("skeleton"), "organs": of("organs")})
}

#[test]
fn every_file_has_the_hashes_that_stats_says() {
    let folder = Folder::new();
    let formats = folder.run(&["list", "--exporters", "--json"]).done().json();
    let mut checked = 0;
    // Whatever level a file holds, its hashes are the whole tree's.
    for knobs in [&[][..], &["--set", "triangles=2000", "--set", "lods=2", "--set", "card_size=128"]] {
        let args = [&["dressed-simple"], &SMALL[..], &SMALL_LEAVES, knobs].concat();
        let stats = folder.run(&[&["stats", "--json"], &args[..]].concat()).done().json();
        for format in formats.as_array().unwrap() {
            let id = format["id"].as_str().unwrap();
            let name = format!("{id}.{}", format["extensions"][0].as_str().unwrap_or(id));
            let said = folder.run(&[&["export"], &args[..], &["-o", &name, "--format", id]].concat());
            assert_eq!(said.code, Some(0), "{id}: {}", said.err);
            let files: Vec<String> = folder
                .names()
                .into_iter()
                .filter(|file| file.starts_with(&format!("{id}.")) || file.starts_with(&format!("{id}_LOD")))
                .collect();
            for file in files {
                let said = folder.run(&["recipe", &file]);
                if said.code == Some(0) {
                    let line = said.json();
                    assert_eq!(line["hash"], hashes(&stats), "{file}");
                    let read = Recipe::new(Preset::from_json(&said.out).unwrap());
                    assert_eq!(
                        Value::from(linden::provenance::hash_text(read.hash())),
                        line["hash"]["recipe"]
                    );
                    checked += 1;
                }
            }
            for name in folder.names() {
                std::fs::remove_file(folder.file(&name)).unwrap();
            }
        }
        folder.run(&[&["preview", "-o", "p.png", "--size", "40x40"], &args[..]].concat()).done();
        assert_eq!(carried(&folder, "p.png")["hash"], hashes(&stats));
    }
    assert!(checked >= 18, "{checked} files");
}

/// A recipe with one text in place of another.
fn edited(folder: &Folder, to: &str, replaced: &[(&str, &str)]) {
    let mut text = folder.run(&["recipe", "a.glb"]).done().out;
    for (from, to) in replaced {
        assert_eq!(text.matches(from).count(), 1, "{from} in {text}");
        text = text.replace(from, to);
    }
    folder.write(to, text);
}

fn notes(said: &Said) -> Vec<&str> {
    assert_eq!(said.code, Some(0), "{}", said.err);
    said.err.lines().filter(|line| line.starts_with("note: ")).collect()
}

#[test]
fn a_recipe_of_another_version_says_so_and_whether_the_tree_is_the_same() {
    let folder = Folder::new();
    folder.run(&[&["export", "fir", "-o", "a.glb"], &SMALL[..]].concat()).done();
    let line = carried(&folder, "a.glb");
    let (version, skeleton) = (line["linden"].as_str().unwrap(), line["hash"]["skeleton"].as_str().unwrap());
    let tampered = format!("{:032x}", u128::from_str_radix(skeleton, 16).unwrap() ^ 1);
    let older = (&*format!("\"linden\":\"{version}\""), "\"linden\":\"0.0.9\"");
    let other_tree = (skeleton, &*tampered);
    edited(&folder, "older.json", &[older]);
    edited(&folder, "tampered.json", &[other_tree]);
    edited(&folder, "both.json", &[older, other_tree]);
    edited(&folder, "seed.json", &[older, other_tree, ("\"seed\":7", "\"seed\":8")]);

    let made = |file: &str| format!("note: {file}: made by linden 0.0.9, this is linden {version}");
    let same = "note: older.json: the same tree as linden 0.0.9 grew, bit for bit";
    let differs = |file: &str| {
        format!("note: {file}: not the tree that the recipe was made with: its skeleton differs")
    };
    let stats = |file: &str, more: &[&str]| folder.run(&[&["stats", file, "--json"], more].concat());
    assert!(notes(&stats("a.glb", &[])).is_empty());
    assert_eq!(notes(&stats("older.json", &[])), [&*made("older.json"), same]);
    assert_eq!(notes(&stats("tampered.json", &[])), [differs("tampered.json")]);
    assert_eq!(notes(&stats("both.json", &[])), [made("both.json"), differs("both.json")]);
    // Turned or edited, it is another recipe: nothing is known of its tree.
    assert_eq!(notes(&stats("both.json", &["--seed", "9"])), [made("both.json")]);
    assert_eq!(notes(&stats("seed.json", &[])), [made("seed.json")]);
    assert!(notes(&stats("tampered.json", &["--set", "points=70"])).is_empty());

    for command in [
        &["export", "older.json", "-o", "b.glb"][..],
        &["preview", "older.json", "-o", "b.png", "--size", "20x20"],
        &["sheet", "older.json", "-o", "s.png", "--size", "20x20"],
        &["cite", "older.json"],
    ] {
        assert_eq!(notes(&folder.run(command)), [&*made("older.json"), same], "{command:?}");
    }
    for command in [
        &["sweep", "older.json", "-o", "t.csv"][..],
        &["forest", "older.json", "--area", "12", "-o", "f.glb"],
    ] {
        assert_eq!(notes(&folder.run(command)), [made("older.json")], "{command:?}");
    }
    // What was written anew is of this version.
    assert_eq!(folder.read("b.glb"), folder.read("a.glb"));
    // A forest says it once, however many kinds it has.
    folder.run(&["forest", "a.glb", "fir", "--area", "12", "--set", "bark_size=64", "-o", "w.glb"]).done();
    let forest = folder.run(&["recipe", "w.glb"]).done().out;
    assert_eq!(forest.matches(older.0).count(), 3, "the forest and its kinds");
    folder.write("w.json", forest.replace(older.0, older.1));
    assert_eq!(notes(&folder.run(&["forest", "w.json", "-o", "v.glb"])), [made("w.json")]);
    assert_eq!(folder.read("v.glb"), folder.read("w.glb"));
    let hash = |file: &str| folder.run(&["cite", file, "--format", "json"]).json()["hash"]["recipe"].clone();
    assert!(hash("w.glb") == hash("w.json") && carried(&folder, "w.glb")["hash"]["recipe"] == hash("w.glb"));
}

#[test]
fn any_number_of_threads_says_the_same_hashes() {
    let folder = Folder::new();
    let on = |threads: &str| {
        let mut command = linden();
        command.args(["stats", "dressed-simple", "--json"]).env("RAYON_NUM_THREADS", threads);
        let said = Said::new(command.current_dir(folder.path()).stdin(Stdio::null()).output().unwrap());
        hashes(&said.done().json())
    };
    let one = on("1");
    assert_eq!(one, on("3"));
    assert!(one["organs"].as_str().is_some_and(|hash| hash.len() == 32));
}

#[test]
fn a_citation_names_everything_that_makes_the_tree() {
    let folder = Folder::new();
    folder.run(&[&["export", "heart", "-o", "a.glb"], &SMALL[..]].concat()).done();
    let cited = folder.run(&[&["cite", "heart", "--format", "json"], &SMALL[..]].concat()).done().json();
    assert_eq!(cited["hash"], carried(&folder, "a.glb")["hash"]);
    assert_eq!(cited["recipe"]["hash"], cited["hash"]);
    assert_eq!(cited["trees"][0]["origin"], folder.run(&["show", "heart", "--json"]).done().json()["origin"]);
    assert_eq!(cited["trees"][0]["inputs"][0]["file"], "heart.obj");
    assert_eq!(cited["publications"][0]["key"], "runions2007");
    // Its command grows it again.
    let words = shell_words::split(cited["command"].as_str().unwrap()).unwrap();
    let words: Vec<&str> = words[1..].iter().map(String::as_str).chain(["--json"]).collect();
    assert_eq!(hashes(&folder.run(&words).done().json()), cited["hash"]);

    let text = folder.run(&["cite", "a.glb"]).done().out;
    let bibtex = folder.run(&["cite", "a.glb", "--format", "bibtex"]).done().out;
    for name in ["recipe", "skeleton", "organs"] {
        let hash = cited["hash"][name].as_str().unwrap();
        assert!(text.contains(hash) && bibtex.contains(hash), "{name}: {text}\n{bibtex}");
    }
    let version = cited["program"]["version"].as_str().unwrap();
    for said in ["Runions, Lane & Prusinkiewicz 2007", version, "MIT OR Apache-2.0", "linden stats a.glb"] {
        assert!(text.contains(said), "{said} in {text}");
    }
    assert!(
        bibtex.contains("@misc{linden-heart,") && bibtex.contains("@inproceedings{runions2007,"),
        "{bibtex}"
    );
    assert_eq!(bibtex.matches('{').count(), bibtex.matches('}').count());

    folder.write("weed.l", "axiom=F\nangle=25.7\nnumber of derivations=4\nF=(1)F[+F]F[-F]F\n");
    let weed = folder.run(&["cite", "weed.l", "--set", "segment_length=0.1"]).done().out;
    assert!(weed.contains("The Algorithmic Beauty of Plants") && weed.contains("(weed)"), "{weed}");
    let wood = folder.run(&["cite", "mixed-wood"]).done().out;
    for kind in ["oak", "silver-birch", "scots-pine", "hazel"] {
        let origin =
            folder.run(&["show", kind, "--json"]).done().json()["origin"].as_str().unwrap().to_owned();
        assert!(wood.contains(&format!("({kind})")) && wood.contains(&origin), "{kind}: {wood}");
    }
    assert!(!wood.contains("skeleton"), "{wood}");
    for (args, expected) in [
        (&["cite", "frr"][..], "did you mean 'fir'?"),
        (&["cite", "fir", "--set", "pionts=3"], "did you mean 'points'"),
        (&["cite", "mixed-wood", "--define", "a=1"], "a forest has several trees"),
        (&["cite", "fir", "--format", "ris"], "bibtex"),
    ] {
        let said = folder.run(args);
        assert_eq!(said.code, Some(2), "{args:?}: {}", said.err);
        assert!(said.err.contains(expected), "{args:?}: {}", said.err);
    }
}

/// What `cite` says of the first tree as changed.
fn changes(cited: &Value) -> Value {
    let of = |name: &str| cited["trees"][0][name].clone();
    serde_json::json!({"age": of("age"), "changed": of("changed"), "edits": of("edits")})
}

#[test]
fn a_citation_names_what_is_not_as_in_the_preset() {
    let folder = Folder::new();
    let cite = |args: &[&str]| {
        let said = folder.run(&[&["cite", "--format", "json"], args].concat());
        assert_eq!(said.code, Some(0), "{args:?}: {}", said.err);
        changes(&said.json())
    };
    let nothing = serde_json::json!({"age": null, "changed": {}, "edits": []});
    assert_eq!(cite(&["abop-honda-a", "--seed", "3"]), nothing);
    assert_eq!(
        cite(&["abop-honda-a", "--define", "r1=0.8", "--set", "derivations=6", "--edit", "cut stem 0.4"]),
        serde_json::json!({
            "age": null, "changed": {"derivations": "6", "r1": "0.8"}, "edits": ["cut stem 0.4"]
        })
    );
    // Files say it too, of the age that they were grown at.
    let export =
        ["export", "silver-birch", "--age", "young", "--set", "leaf_form=none", "--set", "bark_size=64"];
    assert_eq!(folder.run(&[&export[..], &["-o", "young.obj"]].concat()).code, Some(0));
    let young = cite(&["young.obj"]);
    assert_eq!(young["changed"], serde_json::json!({"bark_size": "64", "leaf_form": "none"}));
    assert!(young["age"].as_str().unwrap().starts_with("young (age=0.3, "), "{young}");
    assert_eq!(
        cite(&["silver-birch", "--age", "young", "--set", "leaf_form=none", "--set", "bark_size=64"]),
        young
    );
    for (args, age) in [(["--set", "age=0.2"], "0.2"), (["--age", "4y"], "4y")] {
        let aged = cite(&[&["silver-birch", "--set", "leaf_form=none"], &args[..]].concat());
        assert_eq!(aged["age"], age);
        assert_eq!(aged["changed"], serde_json::json!({"leaf_form": "none"}));
    }
    let text = folder.run(&["cite", "young.obj"]).done().out;
    assert!(text.contains("\nage            young (age=0.3, "), "{text}");
    assert!(text.contains("\nchanged        leaf_form=none\n"), "{text}");
    // Of a document of the user's it is what flags turn.
    folder.write("weed.l", "axiom=F\nangle=25.7\nnumber of derivations=4\nF=(1)F[+F]F[-F]F\n");
    assert_eq!(
        cite(&["weed.l", "--set", "segment_length=0.1", "--seed", "4", "--set", "age=0.5"]),
        serde_json::json!({"age": "0.5", "changed": {"segment_length": "0.1"}, "edits": []})
    );
    folder.write(
        "mine.toml",
        "id = \"mine\"\n[lsystem]\naxiom = \"A(3)\"\nderivations = 3\nrules = [\"#define r 0.7\", \"A(x) -> F(x)A(x*r)\"]\n",
    );
    assert_eq!(
        cite(&["mine.toml", "--define", "r=0.8"]),
        serde_json::json!({"age": null, "changed": {"define.r": "0.8"}, "edits": []})
    );
}

#[test]
fn a_citation_of_a_scanned_tree_names_its_knobs_without_the_scan() {
    let folder = Folder::new();
    let scan =
        ["scan", "simple", "--set=points=60", "--step=0.4", "--positions=3", "--beam=0", "-o", "plot.laz"];
    assert_eq!(folder.run(&scan).code, Some(0));
    let knobs = ["--set", "thin=0.1", "--edit", "cut stem 0.4"];
    let export = [&["export", "plot.laz", "--set", "leaf_form=none", "-o", "tree.obj"], &knobs[..]].concat();
    assert_eq!(folder.run(&export).code, Some(0));
    let said = folder.run(&["cite", "tree.obj", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let with_scan = said.json();
    let turned = changes(&with_scan);
    assert_eq!(turned["changed"]["thin"], "0.1", "{turned}");
    assert_eq!(turned["edits"], serde_json::json!(["cut stem 0.4"]));
    std::fs::remove_file(folder.file("plot.laz")).unwrap();
    let said = folder.run(&["cite", "tree.obj", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("Cited is what tree.obj says"), "{}", said.err);
    assert_eq!(said.json(), with_scan);
    assert_eq!(with_scan["hash"], carried(&folder, "tree.obj")["hash"]);
    // With a knob turned it is another tree, and of one that was changed by hand nothing is known.
    assert_ne!(folder.run(&["cite", "tree.obj", "--seed", "9"]).code, Some(0));
    let other = folder.run(&["recipe", "tree.obj"]).done().out.replace("\"seed\":1", "\"seed\":2");
    folder.write("other.json", other);
    assert_ne!(folder.run(&["cite", "other.json"]).code, Some(0));
}

#[test]
fn entries_have_fields_that_styles_know() {
    let folder = Folder::new();
    let small = ["--set", "leaf_form=none", "--set", "age=0.2"];
    let bibtex =
        folder.run(&[&["cite", "silver-birch", "--format", "bibtex"], &small[..]].concat()).done().out;
    let (program, paper) = bibtex.split_once("\n\n").unwrap();
    let version = folder.run(&["--version"]).done().out.trim().trim_start_matches("linden ").to_owned();
    for field in [
        "  author = {{The linden developers}},\n".to_owned(),
        "  title = {{linden}},\n".to_owned(),
        format!("  version = {{{version}}},\n"),
        format!("  note = {{version {version}; tree: Silver birch (silver-birch); "),
    ] {
        assert!(program.contains(&field), "{field} in {program}");
    }
    assert!(
        program.contains("; age: 0.2; changed: leaf\\_form=none; ") && !program.contains("year"),
        "{program}"
    );
    let journal =
        "  journal = {ACM Transactions on Graphics},\n  volume = {28},\n  number = {3},\n  year = {2009},\n";
    assert!(paper.starts_with("@article{palubicki2009,\n") && paper.contains(journal), "{paper}");
}
