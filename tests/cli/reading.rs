//! What may be read, how much of it, and for how long; recipes out of what was written.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::program::{Folder, Said, linden};

/// Knobs of a small tree.
const SMALL: [&str; 6] = ["--set", "points=60", "--set", "bark_size=64", "--seed", "7"];

/// A preset that names a file under a key of its leaves.
fn with_leaf(key: &str, file: &str) -> String {
    let form = if key == "leaf_mesh" { "mesh" } else { "card" };
    format!(
        "id = \"p\"\n[lsystem]\naxiom = \"F~LF\"\nrules = []\n[foliage]\nleaf_form = \"{form}\"\n{key} = \"{file}\"\n"
    )
}

/// Runs the program with its configuration below the folder.
fn run(folder: &Folder, args: &[&str]) -> Said {
    let config = folder.file("config");
    Said::new(
        linden()
            .args(args)
            .env("LINDEN_CONFIG_DIR", config)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap(),
    )
}

#[test]
fn a_file_is_the_recipe_that_it_carries() {
    let folder = Folder::new();
    let mut args = vec!["export", "fir"];
    args.extend(SMALL);
    let formats = folder.run(&["list", "--exporters", "--json"]).done().json();
    let mut names = Vec::new();
    for format in formats.as_array().unwrap() {
        let id = format["id"].as_str().unwrap();
        let name = format!("{id}.out");
        let said = folder.run(&[&args[..], &["-o", &name, "--format", id]].concat());
        // Tables of the skeleton have no bark, which is noted.
        assert_eq!(said.code, Some(0), "{id}: {}", said.err);
        // What holds no recipe says so.
        if said.err.contains("holds no recipe") {
            let read = folder.run(&["recipe", &name]);
            assert_eq!((read.code, id), (Some(2), "stl"), "{}", read.err);
        } else {
            names.push(name);
        }
    }
    folder.run(&[&["preview", "fir"], &SMALL[..], &["-o", "preview.png", "--size", "64x64"]].concat()).done();
    names.push("preview.png".to_owned());
    assert!(names.len() > 8);

    let hash = |source: &str| folder.run(&["stats", source, "--json"]).done().json()["skeleton_hash"].clone();
    let first = folder.run(&["recipe", &names[0]]).done().out;
    folder.write("recipe.json", &first);
    let grown = hash("recipe.json");
    for name in &names {
        assert_eq!(folder.run(&["recipe", name]).done().out, first, "{name}");
        assert_eq!(hash(name), grown, "{name}");
        let piped = folder.run_with(&folder.read(name), &["recipe", "-"]).done();
        assert_eq!(piped.out, first, "{name} through a pipe");
    }
    assert_eq!(folder.run(&["recipe", "recipe.json"]).done().out, first);
    // What is written from a file is that file.
    folder.run(&["export", "glb.out", "-o", "again.glb"]).done();
    assert_eq!(folder.read("again.glb"), folder.read("glb.out"));
}

#[test]
fn a_forest_comes_back_from_its_file_and_is_no_tree() {
    let folder = Folder::new();
    let of = |source: &str, to: &str| {
        let args =
            ["forest", source, "--area", "12", "--set", "points=60", "--set", "bark_size=64", "-o", to];
        folder.run(&args).done();
    };
    of("fir", "a.glb");
    folder.run(&["forest", "a.glb", "-o", "b.glb"]).done();
    assert_eq!(folder.read("a.glb"), folder.read("b.glb"));
    assert!(folder.run(&["recipe", "a.glb"]).done().out.contains("\"tree\":[{"));
    assert!(folder.run(&["show", "a.glb"]).done().out.contains("a forest of"));
    let said = folder.run(&["stats", "a.glb"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("a.glb is a forest") && said.err.contains("linden forest"), "{}", said.err);
}

#[test]
fn what_carries_no_recipe_is_said() {
    let folder = Folder::new();
    folder
        .run(&["export", "fir", "--set", "points=60", "--set", "bark_size=64", "-o", "a.gltf", "-o", "a.obj"])
        .done();
    folder.run(&["export", "fir", "--set", "qsm.comments=false", "-o", "a.csv"]).done();
    folder.write("crown.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for name in ["a.bin", "a.mtl", "a.csv", "crown.obj", "a_bark.png"] {
        let said = folder.run(&["recipe", name]);
        assert_eq!(said.code, Some(2), "{name}: {}", said.err);
        assert!(said.err.contains(&format!("{name} carries no recipe")), "{name}: {}", said.err);
    }
    // What is no source is not told to be shown as one.
    folder.run(&["sheet", "fir", "--seeds", "2", "--size", "64x64", "-o", "sh.png"]).done();
    let said = folder.run(&["recipe", "sh.png"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("a sheet and pictures that belong to a model do not"), "{}", said.err);
    assert!(!said.err.contains("linden show sh.png"), "{}", said.err);
    let said = folder.run(&["recipe", "crown.obj"]);
    assert!(said.err.contains("'linden show crown.obj --json'"), "{}", said.err);
    let said = folder.run(&["recipe", "nothing.glb"]);
    assert!(said.code == Some(2) && said.err.contains("'nothing.glb'"), "{}", said.err);
}

#[test]
fn a_recipe_whose_files_are_elsewhere_says_so() {
    let folder = Folder::new();
    let heart = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../presets/crowns/heart.obj");
    for name in ["trees", "out"] {
        std::fs::create_dir(folder.file(name)).unwrap();
    }
    folder.write("trees/hull.obj", std::fs::read(heart).unwrap());
    folder.write("trees/p.toml", "id = \"p\"\n[colonization]\nenvelope = \"hull.obj\"\npoints = 60\ninfluence = inf\n[bark]\nbark_size = 64\n");
    folder.run(&["export", "trees/p.toml", "-o", "out/p.glb"]).done();
    let said = folder.run(&["stats", "out/p.glb"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.err.contains("out/p.glb: 'envelope': reading out/hull.obj") && said.err.contains("put it there"),
        "{}",
        said.err
    );
    // Beside it, and then another one of that name.
    folder.write("out/hull.obj", folder.read("trees/hull.obj"));
    folder.run(&["stats", "out/p.glb"]).done();
    folder.write("out/hull.obj", [&folder.read("trees/hull.obj")[..], b"# other\n"].concat());
    let said = folder.run(&["stats", "out/p.glb"]);
    assert_eq!(said.code, Some(0));
    assert!(said.err.contains("hull.obj is not the file that the recipe was made with"), "{}", said.err);
}

#[test]
fn errors_about_named_files_have_a_place() {
    let folder = Folder::new();
    folder.write("p.toml", with_leaf("leaf_mesh", "none.obj"));
    let said = folder.run(&["stats", "p.toml"]);
    assert!(said.err.contains("p.toml:7:1: 'leaf_mesh': reading none.obj"), "{}", said.err);
    folder.write("none.obj", "v 0 0\n");
    let said = folder.run(&["stats", "p.toml"]);
    assert!(
        said.err.contains("p.toml:7:1: 'leaf_mesh': reading none.obj: ") && said.err.contains("line 1"),
        "{}",
        said.err
    );
    let parts = "id = \"p\"\n[colonization]\ncrown = \"dome\"\n[[colonization.part]]\nrole = \"obstacle\"\n  mesh = \"rock.obj\"\n";
    folder.write("q.toml", parts);
    let said = folder.run(&["stats", "q.toml"]);
    assert!(said.err.contains("q.toml:6:3: 'mesh': reading rock.obj"), "{}", said.err);
}

#[test]
fn documents_name_what_lies_beside_them() {
    let folder = Folder::new();
    for name in ["trees", "secret"] {
        std::fs::create_dir(folder.file(name)).unwrap();
    }
    folder.write("secret/notes.obj", "hunter2 is the password\n");
    let refused = |text: &str, place: &str| {
        folder.write("trees/p.toml", text);
        let said = folder.run(&["stats", "trees/p.toml"]);
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains(place) && said.err.contains("--allow-path "), "{}", said.err);
        assert!(!said.err.contains("hunter2"), "what was refused is not quoted: {}", said.err);
    };
    let secret = folder.file("secret/notes.obj");
    refused(&with_leaf("leaf_mesh", "../secret/notes.obj"), "trees/p.toml:7:1: 'leaf_mesh'");
    refused(&with_leaf("leaf_mesh", secret.to_str().unwrap()), "trees/p.toml:7:1: 'leaf_mesh'");
    refused(&with_leaf("leaf_picture", "/dev/zero"), "trees/p.toml:7:1: 'leaf_picture'");
    refused("id = \"p\"\n[colonization]\nscan = \"/etc/passwd\"\n", "trees/p.toml:3:1: 'scan'");
    // A forest's kinds of trees are files too.
    folder.write("trees/f.toml", "[[tree]]\npreset = \"../secret/notes.obj\"\n");
    let said = folder.run(&["forest", "trees/f.toml", "-o", "f.glb"]);
    assert!(
        said.err.contains("trees/f.toml:2:1: 'preset'") && said.err.contains("--allow-path"),
        "{}",
        said.err
    );
    assert!(!said.err.contains("hunter2"), "{}", said.err);
    // Allowed, it is read, and then its mistakes are said.
    let said = folder.run(&["stats", "trees/p.toml", "--allow-path", "/etc"]);
    assert!(said.code == Some(1) && !said.err.contains("--allow-path"), "{}", said.err);
    let said = folder.run(&["list", "--allow-path", "no-such-folder"]);
    assert!(said.code == Some(2) && said.err.contains("--allow-path no-such-folder"), "{}", said.err);
}

#[test]
fn files_of_a_recipe_in_another_folder_are_found_where_the_user_says_or_stands() {
    let folder = Folder::new();
    let picture = |alpha: u8| linden::picture::Picture::new(2, 2, vec![alpha; 16]).png().unwrap().to_vec();
    for name in ["trees", "build"] {
        std::fs::create_dir(folder.file(name)).unwrap();
    }
    folder.write("trees/leaf.png", picture(90));
    folder.write("trees/p.toml", with_leaf("leaf_picture", "leaf.png"));
    folder.run(&["export", "trees/p.toml", "-o", "build/p.glb", "--set", "bark_size=64"]).done();
    let said = folder.run(&["verify", "build/p.glb"]);
    assert!(said.code == Some(1) && said.out.contains("--allow-path"), "{} {}", said.out, said.err);
    folder.run(&["verify", "build/p.glb", "--allow-path", "trees"]).done();
    // In the working directory, where it is the file that was meant.
    folder.write("leaf.png", picture(91));
    assert_eq!(folder.run(&["verify", "build/p.glb"]).code, Some(1), "another picture is not taken for it");
    // Nor is anything said of it.
    folder.write("leaf.png", "hunter2");
    let said = folder.run(&["stats", "build/p.glb"]);
    assert!(said.code == Some(2) && !said.err.contains("hunter2"), "{}", said.err);
    assert!(said.err.contains("build/leaf.png"), "{}", said.err);
    folder.write("leaf.png", picture(90));
    folder.run(&["verify", "build/p.glb"]).done();
    // In a folder that the user names, another one is taken, and that is said.
    folder.write("leaf.png", picture(91));
    let said = folder.run(&["stats", "build/p.glb", "--allow-path", "."]);
    assert!(said.code == Some(0) && said.err.contains("is not the file"), "{}", said.err);
}

#[test]
fn a_table_whose_recipe_lacks_a_file_is_what_its_rows_say() {
    let folder = Folder::new();
    folder.write("leaf.png", linden::picture::Picture::new(2, 2, vec![90; 16]).png().unwrap());
    folder.write("p.toml", with_leaf("leaf_picture", "leaf.png"));
    std::fs::create_dir(folder.file("out")).unwrap();
    folder.run(&["export", "p.toml", "-o", "out/p.csv"]).done();
    folder.run(&["export", "p.toml", "-o", "out/p.glb", "--set", "bark_size=64"]).done();
    let length = |said: &Said| {
        let report: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        report["total_length_m"].as_f64().unwrap()
    };
    let whole = length(&folder.run(&["stats", "p.toml", "--json"]));
    std::fs::rename(folder.file("leaf.png"), folder.file("moved.png")).unwrap();
    let said = folder.run(&["stats", "out/p.csv", "--json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("leaf.png") && said.err.contains("as they stand in the table"), "{}", said.err);
    assert!((length(&said) / whole - 1.0).abs() < 1e-3);
    // What is no table cannot do without.
    assert_eq!(folder.run(&["stats", "out/p.glb"]).code, Some(2));
}

#[test]
fn what_the_user_names_may_lie_anywhere_and_its_recipe_says_what_to_allow() {
    let folder = Folder::new();
    folder.write("leaf.png", linden::picture::Picture::new(2, 2, vec![90; 16]).png().unwrap());
    std::fs::create_dir(folder.file("out")).unwrap();
    folder.write("out/p.toml", with_leaf("leaf_picture", "nothing.png"));
    let picture = folder.file("leaf.png");
    let set = format!("leaf_picture={}", picture.display());
    // It stands in for one that is not there.
    folder.run(&["export", "out/p.toml", "--set", &set, "-o", "out/p.glb", "--set", "bark_size=64"]).done();
    let said = folder.run(&["stats", "out/p.glb"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("--allow-path"), "{}", said.err);
    let allow = folder.path().display().to_string();
    folder.run(&["stats", "out/p.glb", "--allow-path", &allow]).done();
    folder.run(&["stats", "out/p.glb", "--set", &set]).done();
}

#[test]
fn presets_of_the_users_are_sources_everywhere() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.file("config/presets/moor")).unwrap();
    let document = |id: &str| {
        format!(
            "id = \"{id}\"\nsummary = \"from the moor\"\n[lsystem]\naxiom = \"FF\"\nrules = []\n[bark]\nbark_size = 64\n"
        )
    };
    for path in ["birch-2.toml", "moor/fir.toml", "moor/alder.toml", "alder.toml"] {
        folder
            .write(&format!("config/presets/{path}"), document(path.split(['/', '.']).nth_back(1).unwrap()));
    }
    folder.write("config/presets/broken.toml", "id = \"broken\"\nx = [\n");
    let run = |args: &[&str]| run(&folder, args);

    assert_eq!(run(&["stats", "birch-2", "--json"]).done().json()["segments"], 2);
    run(&["export", "birch-2", "-o", "b.obj"]).done();
    folder.write("wood.toml", "area = 10\n[[tree]]\npreset = \"birch-2\"\n");
    run(&["forest", "wood.toml", "-o", "w.obj"]).done();
    // An id of a built-in preset means that one.
    assert_ne!(run(&["stats", "fir", "--set", "points=60", "--json"]).done().json()["segments"], 2);
    let said = run(&["stats", "alder"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.err.contains("several presets 'alder'") && said.err.contains("moor/alder.toml"),
        "{}",
        said.err
    );
    let said = run(&["stats", "brich-2"]);
    assert!(said.code == Some(2) && said.err.contains("did you mean 'birch-2'"), "{}", said.err);

    let rows = run(&["list", "--json"]).done().json();
    let rows: Vec<_> = rows.as_array().unwrap().iter().filter(|row| !row["path"].is_null()).collect();
    let ids: Vec<_> = rows.iter().map(|row| row["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["alder", "fir", "alder", "birch-2", "broken"]);
    let broken = rows.iter().find(|row| row["id"] == "broken").unwrap();
    assert!(broken["problem"].as_str().unwrap().contains("broken.toml:2:"), "{broken}");
    let text = run(&["list"]).done().out;
    assert!(text.contains("  birch-2 ") && text.contains("from the moor"), "{text}");
    // What an id does not reach is listed by its file.
    assert!(text.contains("presets/moor/fir.toml") && text.contains("presets/alder.toml"), "{text}");
}

/// What the program held at its worst, bytes.
#[cfg(target_os = "linux")]
fn peak_bytes(folder: &Folder, args: &[&str], input: Stdio) -> (Said, u64) {
    // The shell says what its child held: `times` of the standard library knows no memory.
    let script = "import os,sys,resource,subprocess\n\
                  done = subprocess.run(sys.argv[1:])\n\
                  print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=open('peak', 'w'))\n\
                  sys.exit(done.returncode)";
    let output = Command::new("python3")
        .args(["-c", script, env!("CARGO_BIN_EXE_linden")])
        .args(args)
        .current_dir(folder.path())
        .stdin(input)
        .output()
        .unwrap();
    let peak: u64 = String::from_utf8(folder.read("peak")).unwrap().trim().parse().unwrap();
    (Said::new(output), peak << 10)
}

#[cfg(target_os = "linux")]
#[test]
#[allow(clippy::zombie_processes, reason = "it ends when its reader does")]
fn no_input_takes_more_memory_than_is_given() {
    let folder = Folder::new();
    std::fs::File::create(folder.file("sparse.xyz")).unwrap().set_len(3 << 30).unwrap();
    folder.write("big.xyz", "1 2 3\n".repeat(5_000_000));
    folder.write("big.toml", format!("id = \"b\"\nx = [{}]\n", "1,".repeat(5_000_000)));
    folder.write("p.toml", with_leaf("leaf_picture", "sparse.xyz"));
    folder.write("q.toml", with_leaf("leaf_picture", "zero"));
    std::os::unix::fs::symlink("/dev/zero", folder.file("zero")).unwrap();
    let endless = || {
        let child = Command::new("yes").arg("1 2 3").stdout(Stdio::piped()).spawn().unwrap();
        Stdio::from(child.stdout.unwrap())
    };
    for (args, input, says) in [
        (&["show", "/dev/zero"][..], Stdio::null(), "a device"),
        (&["show", "-"], endless(), "memory limit of 64.0 MiB"),
        (&["recipe", "-"], endless(), "memory limit of 64.0 MiB"),
        (&["show", "sparse.xyz"], Stdio::null(), "3.00 GiB"),
        (&["show", "big.xyz"], Stdio::null(), "memory limit of 64.0 MiB"),
        (&["show", "big.toml"], Stdio::null(), "memory limit of 64.0 MiB"),
        (&["show", "p.toml"], Stdio::null(), "3.00 GiB"),
        (&["show", "q.toml"], Stdio::null(), "--allow-path /dev"),
        (&["show", "q.toml", "--allow-path", "/dev"], Stdio::null(), "a device"),
        (&["show", "fir", "--set", "leaf_picture=/dev/zero"], Stdio::null(), "a device"),
    ] {
        let (said, peak) = peak_bytes(&folder, &[args, &["--memory", "64M"]].concat(), input);
        assert!(matches!(said.code, Some(1 | 2)), "{args:?}: {}", said.err);
        assert!(said.err.contains(says), "{args:?}: {}", said.err);
        // The program itself, its threads and its libraries.
        assert!(peak < 96 << 20, "{args:?}: {peak} bytes");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_read_and_waiting_for_its_writer_ends_with_a_signal() {
    let folder = Folder::new();
    assert!(Command::new("mkfifo").arg(folder.file("pipe")).status().unwrap().success());
    folder.write("g.txt", "axiom=F\nangle=20\nnumber of derivations=1\nF=(1)FF\n");
    // With a writer it is a source.
    let mut writer =
        Command::new("sh").args(["-c", "cat g.txt > pipe"]).current_dir(folder.path()).spawn().unwrap();
    let said = folder.run(&["stats", "pipe", "--set", "segment_length=1", "--json"]).done();
    assert_eq!(said.json()["segments"], 2);
    writer.wait().unwrap();
    // A document may not name one.
    folder.write("p.toml", with_leaf("leaf_picture", "pipe"));
    let said = folder.run(&["stats", "p.toml"]);
    assert!(said.code == Some(1) && said.err.contains("it is a pipe"), "{}", said.err);
    for args in [&["stats", "pipe"][..], &["stats", "fir", "--set", "leaf_picture=pipe"], &["recipe", "pipe"]]
    {
        let mut child =
            linden().args(args).current_dir(folder.path()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(300));
        assert!(child.try_wait().unwrap().is_none(), "{args:?}: it waits");
        let status = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
        assert!(status.success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{args:?}");
    }
}
