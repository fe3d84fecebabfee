//! What work will take is said before it is done, and kept to.

use std::process::Command;

use crate::program::Folder;

#[test]
fn a_picture_that_is_too_large_is_refused_before_anything_grows() {
    let folder = Folder::new();
    for (command, labels) in [("preview", &[][..]), ("sheet", &["--labels", "none"])] {
        let args = [command, "simple", "-o", "a.png", "--size", "8000x8000", "--memory", "32M"];
        let said = folder.run(&[&args[..], labels].concat());
        assert_eq!(said.code, Some(1), "{command}: {}", said.err);
        assert!(said.err.contains("drawing the picture would take 732 MiB"), "{command}: {}", said.err);
        assert!(said.err.contains("32.0 MiB") && said.err.contains("--size"), "{command}: {}", said.err);
    }
    assert!(folder.names().is_empty());
    folder.run(&["preview", "simple", "-o", "a.png", "--size", "400x400", "--memory", "32M"]).done();
}

#[test]
fn show_says_how_large_every_generator_grows() {
    let folder = Folder::new();
    // Forecasts are of what grows alive.
    let alive: &[&str] = &["--set", "dead_twigs=0"];
    for (source, knobs) in [("fir", &[][..]), ("abop-bush", &[]), ("norway-spruce", alive)] {
        let told = folder.run(&[&["show", source, "--json"], knobs].concat()).done().json();
        let forecast = told["forecast"].clone();
        let stats = folder.run(&[&["stats", source, "--json"], knobs].concat()).done().json();
        // Grown as they are.
        for key in ["nodes", "symbols", "segments"] {
            if source == "fir" && key != "nodes" {
                assert!(forecast[key].is_null(), "{source}: {forecast}");
            } else {
                assert_eq!(forecast[key].as_f64(), stats[key].as_f64(), "{source}: {key}");
            }
        }
        let triangles = forecast["triangles"].as_f64().unwrap() / stats["triangles"].as_f64().unwrap();
        assert!((0.5..2.0).contains(&triangles), "{source}: {triangles}");
        assert!(forecast["bytes"]["glb"].as_u64().unwrap() > 10_000, "{forecast}");
        assert!(forecast["seconds"].as_f64().unwrap() > 0.0, "{forecast}");
    }
    let page = folder.run(&["show", "fir"]).done().out;
    assert!(page.contains("1,055 nodes, 22,116 triangles") && page.contains("as glb, in about"), "{page}");
    // Of a sample: two digits.
    let page = folder.run(&["show", "fir", "--set", "points=10000000"]).done().out;
    assert!(page.contains("\n  about ") && page.contains("00 nodes, "), "{page}");
    let forest = folder.run(&["show", "orchard", "--json"]).done().json();
    assert!(forest["forecast"]["triangles"].as_f64().unwrap() > 10_000.0, "{forest}");
}

/// What follows is refused at once, without a wait.
#[test]
fn long_work_is_announced() {
    let folder = Folder::new();
    let long = ["--set", "points=100000000", "--memory", "32M"];
    for command in [
        &["stats", "sphere"][..],
        &["export", "sphere", "-o", "a.glb"],
        &["preview", "sphere", "-o", "a.png"],
        &["sheet", "sphere", "-o", "a.png"],
        &["forest", "sphere", "-o", "a.glb", "--area", "20"],
        &["impostor", "sphere", "-o", "a.json"],
    ] {
        let said = folder.run(&[command, &long].concat());
        assert_eq!(said.code, Some(1), "{command:?}: {}", said.err);
        let note = said.err.lines().next().unwrap();
        assert!(note.starts_with("note: this will take about "), "{command:?}: {}", said.err);
        assert!(note.contains("nodes") && said.err.contains("lower points"), "{command:?}: {}", said.err);
    }
    assert!(folder.names().is_empty());
}

/// Views take longer than the tree that they show, by their pixels.
#[test]
fn an_impostor_is_announced_by_its_views() {
    let folder = Folder::new();
    let args = ["impostor", "dressed-simple", "-o", "a.json", "--set", "points=60", "--set", "leaf_size=128"];
    let said = folder.run(&[&args[..], &["--size", "8192", "--memory", "64M"]].concat());
    assert_eq!(said.code, Some(1), "{}", said.err);
    let note = said.err.lines().find(|line| line.starts_with("note: this will take about ")).unwrap();
    assert!(note.contains(" min: ") && note.ends_with(", 64 views"), "{note}");
    let said = folder.run(&[&args[..], &["--size", "256", "--frames", "4"]].concat()).done();
    assert!(!said.err.contains("this will take"), "{}", said.err);
}

/// A small sample of `tests/memory/limits.py`, which counts resident memory.
#[test]
fn commands_keep_to_the_memory_limit() {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/memory/limits.py");
    let linden = env!("CARGO_BIN_EXE_linden");
    let done = Command::new("python3")
        .args([script, "--linden", linden, "--every", "1500", "--seconds", "60"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&done.stdout);
    assert!(
        done.status.success() && said.contains("| export"),
        "{said}{}",
        String::from_utf8_lossy(&done.stderr)
    );
}
