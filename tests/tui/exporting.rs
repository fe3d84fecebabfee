//! Exports from the dialog are the files that the command line writes.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::harness::{Home, Setup, Workbench, eventually};

const FOREST: &str = "area = 14\nspacing = 6\nseed = 4\n[[tree]]\npreset = \"older-c\"\nshare = 2\n[[tree]]\npreset = \"simple\"\n";

/// What the command line writes.
fn written(args: &[&str], to: &Path) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_linden")).args(args).arg("-o").arg(to).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read(to).unwrap()
}

/// What the workbench writes of a source into a folder, with its scene, once it says that it has `grown`; the
/// GLB's bytes.
fn exported(home: &Home, source: &str, grown: &str, into: &Path, name: &str) -> Vec<u8> {
    let workbench = Setup::new(120, 40).args(&["open", source]).start(home);
    workbench.wait_for_text(grown);
    workbench.settle();
    workbench.keys("e");
    workbench.wait_for_text("[x] glb");
    // Where to: below the format.
    workbench.keys("j");
    workbench.settle();
    workbench.keys("\r");
    workbench.settle();
    // All that stands in the line goes first.
    workbench.keys("\x15");
    workbench.settle();
    let target = into.join(name);
    workbench.keys(target.to_str().unwrap());
    workbench.settle();
    workbench.keys("\r");
    workbench.settle();
    // The scene is above the button.
    workbench.keys("Gk");
    workbench.settle();
    workbench.keys(" ");
    workbench.wait_for_text("[x] scene");
    workbench.keys("G");
    workbench.settle();
    workbench.keys("\r");
    workbench.wait_for_text("exported");
    eventually("the file", || fs::read(&target).ok())
}

#[test]
fn a_forest_is_written_as_on_the_command_line() {
    let home = Home::new();
    let forest = home.write("copse.toml", FOREST);
    let source = forest.to_str().unwrap();
    // An opened file stays in the list, also when the user's presets were read after it.
    let there = exported(&home, source, "of them grown", home.path(), "there.glb");
    let here = written(&["forest", source, "--scene"], &home.path().join("here.glb"));
    assert!(there == here, "{} and {} bytes", there.len(), here.len());
    // Another program finds the camera.
    let plain = written(&["forest", source], &home.path().join("plain.glb"));
    let has_camera = |glb: &[u8]| String::from_utf8_lossy(glb).contains("\"cameras\"");
    assert!(has_camera(&there) && !has_camera(&plain));
}

#[test]
fn a_tree_is_written_as_on_the_command_line() {
    let home = Home::new();
    let there = exported(&home, "abop-c", "nodes", home.path(), "there.glb");
    let here = written(&["export", "abop-c", "--scene"], &home.path().join("here.glb"));
    assert!(there == here, "{} and {} bytes", there.len(), here.len());
}

/// Opens the dialog with a format ticked by the palette, and exports. What was ticked last time is ticked too.
fn export(workbench: &Workbench, home: &Home, format: &str, file: &str) -> Vec<u8> {
    workbench.keys(&format!(":{format}"));
    workbench.wait_for_text("exports ");
    workbench.keys("\r");
    workbench.wait_for_text(&format!("[x] {format}"));
    workbench.keys("x");
    eventually("the file", || fs::read(home.file(file)).ok())
}

#[test]
fn a_mesh_and_pictures_are_those_of_the_command_line() {
    let tree = ["older-c", "--set", "seed=3", "--set", "bark_color=#336699"];
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 50, &[&["open"][..], &tree].concat());
    let png = export(&workbench, &home, "png", "older-c.png");
    let glb = fs::read(home.file("older-c.glb")).unwrap();
    for name in ["older-c.png", "older-c.glb"] {
        fs::remove_file(home.file(name)).unwrap();
    }
    let svg = export(&workbench, &home, "svg", "older-c.svg");

    let of = |command: &[&'static str]| [command, &tree].concat();
    assert!(glb == written(&of(&["export"]), &home.file("cli.glb")), "the mesh");
    assert!(png == written(&of(&["preview", "--look", "surface"]), &home.file("cli.png")), "the picture");
    assert!(svg == written(&of(&["preview"]), &home.file("cli.svg")), "the drawing");
}

#[test]
fn what_is_turned_for_an_export_alone_is_in_its_file_and_not_on_screen() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 50, &["open", "dressed-simple"]);
    workbench.keys("e");
    workbench.wait_for_text("[x] glb");
    // Up from the scene and the seasons: the season, the wind, the billboard, its levels.
    workbench.keys("Gkkk");
    workbench.settle();
    for (row, up, value) in [("season", "", "0.6"), ("lods", "kkkk", "2")] {
        workbench.keys(up);
        workbench.settle();
        workbench.keys("\r");
        workbench.settle();
        workbench.keys("\x15");
        workbench.settle();
        workbench.keys(value);
        workbench.settle();
        workbench.keys("\r");
        workbench.wait_for_text(&format!("●{row}"));
    }
    workbench.wait_for_text("its size is known when it is written");
    workbench.keys("x");
    let there = eventually("the file", || fs::read(home.file("dressed-simple.glb")).ok());
    let set = ["--set", "season=0.6", "--set", "lods=2"];
    let here = written(&[&["export", "dressed-simple"][..], &set].concat(), &home.file("cli.glb"));
    assert!(there == here, "{} and {} bytes", there.len(), here.len());
    assert!(there != written(&["export", "dressed-simple"], &home.file("plain.glb")));
    assert!(!workbench.screen().text().contains("modified"), "the tree on screen is as it was");
}

#[test]
fn pictures_of_the_user_are_in_the_file_as_on_the_command_line() {
    let home = Home::new();
    home.write("bark.png", include_bytes!("../fixtures/pictures/turned.png"));
    let mine = home.write(
        "mine.toml",
        "id = \"mine\"\nname = \"Mine\"\n[colonization]\ncrown = \"sphere\"\npoints = 60\n\
         [bark]\nbark_picture = \"bark.png\"\n",
    );
    let workbench = Workbench::open(&home, 120, 50, &["open", "mine.toml"]);
    let glb = export(&workbench, &home, "glb", "mine.glb");
    assert!(glb == written(&["export", mine.to_str().unwrap()], &home.file("cli.glb")));
}

/// Types into the row at the cursor what replaces all that stands there.
fn retype(workbench: &Workbench, text: &str) {
    for keys in ["\r", "\x15", text, "\r"] {
        workbench.keys(keys);
        workbench.settle();
    }
}

#[test]
fn contact_sheets_are_those_of_the_command_line() {
    let home = Home::new();
    let tree = ["older-c", "--set", "seed=3"];
    let workbench = Workbench::open(&home, 120, 50, &[&["open"][..], &tree].concat());
    workbench.keys(":png-sheet");
    workbench.wait_for_text("exports Contact sheet");
    workbench.keys("\r");
    workbench.wait_for_text("[x] png-sheet");
    // Below where it goes: how many, how many in a row.
    for (keys, value) in [("jj", "3"), ("j", "1")] {
        workbench.keys(keys);
        workbench.settle();
        retype(&workbench, value);
    }
    workbench.keys("x");
    let there = eventually("the file", || fs::read(home.file("older-c-sheet.png")).ok());
    let of = |more: &[&'static str]| [&["sheet"][..], &tree, more].concat();
    assert!(there == written(&of(&["--seeds", "3", "--columns", "1"]), &home.file("cli.png")));
    assert!(there != written(&of(&["--seeds", "3"]), &home.file("usual.png")), "as many in a row as usual");
}

#[test]
fn a_name_tells_the_format_of_a_picture() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 50, &["open", "older-c"]);
    for (name, magic) in [("there.jpg", &b"\xff\xd8\xff"[..]), ("there.webp", b"RIFF")] {
        workbench.keys(":png");
        workbench.wait_for_text("exports Picture");
        workbench.keys("\r");
        workbench.wait_for_text("[x] png ");
        workbench.keys("j");
        workbench.settle();
        retype(&workbench, home.file(name).to_str().unwrap());
        workbench.keys("x");
        workbench.settle();
        // The mesh was written with the first one.
        workbench.keys("y");
        let there = eventually("the file", || fs::read(home.file(name)).ok());
        let cli = home.file(&name.replace("there", "cli"));
        assert!(there == written(&["preview", "older-c", "--look", "surface"], &cli), "{name}");
        assert!(there.starts_with(magic), "{name}");
    }
}

#[test]
fn several_seasons_are_those_of_the_command_line() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 50, &["open", "dressed-simple"]);
    workbench.keys("e");
    workbench.wait_for_text("[x] glb");
    workbench.keys("Gkk");
    workbench.settle();
    for keys in ["\r", "sumer", "\r"] {
        workbench.keys(keys);
        workbench.settle();
    }
    workbench.wait_for_text("did you mean 'summer'");
    for keys in ["\x15", "summer,autumn", "\r"] {
        workbench.keys(keys);
        workbench.settle();
    }
    workbench.keys("x");
    workbench.wait_for_text("exported");
    let files = |start: &str| -> Vec<(String, Vec<u8>)> {
        let mut names: Vec<String> = fs::read_dir(home.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| {
                name.starts_with(start) && Path::new(name).extension().is_some_and(|ending| ending == "glb")
            })
            .collect();
        names.sort();
        names
            .into_iter()
            .map(|name| (name[start.len()..].to_owned(), fs::read(home.file(&name)).unwrap()))
            .collect()
    };
    let to = home.file("cli.glb");
    let run = Command::new(env!("CARGO_BIN_EXE_linden"))
        .args(["export", "dressed-simple", "--seasons", "summer,autumn", "-o"])
        .arg(&to)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (there, here) = (files("dressed-simple"), files("cli"));
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert!(!there.is_empty() && there == here, "{:?} and {:?}", names(&there), names(&here));
}

#[test]
fn a_forests_picture_is_that_of_the_command_line() {
    let home = Home::new();
    let forest = home.write("copse.toml", FOREST);
    let source = forest.to_str().unwrap();
    let workbench = Setup::new(120, 50).args(&["open", source]).start(&home);
    workbench.wait_for_text("of them grown");
    workbench.settle();
    workbench.keys("e");
    workbench.wait_for_text("[x] glb");
    // Above the scene and the program that files are for: the last format.
    workbench.keys("Gkkk");
    workbench.settle();
    workbench.keys(" ");
    workbench.wait_for_text("[x] png");
    workbench.keys("x");
    workbench.wait_for_text("exported");
    let there = eventually("the file", || fs::read(home.file("copse.png")).ok());
    assert!(there == written(&["preview", source], &home.file("cli.png")));
}
