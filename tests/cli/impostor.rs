//! Impostors, drawn by the shader of docs/impostors/viewer.html.

use std::path::Path;
use std::process::Command;

use crate::program::Folder;

/// As `tests/clients/impostor.py` says: Chromium beside a rasterizer of its own, and shaders that are broken.
#[test]
#[ignore = "needs Chromium: cargo test -p linden-cli --test cli -- impostor --ignored"]
fn the_viewer_shows_the_plant_from_all_sides() {
    let clients = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().join("clients");
    assert!(
        clients.join("complete").is_file(),
        "the outside clients are not installed: run tests/clients/setup.sh once (needs python3, npm and the net)"
    );
    let folder = Folder::new();
    // An umbrella: where its views do not mind the depth, stem and crown come apart.
    let plant = ["dressed-aono-d", "--set", "triangles=3000"];
    for (name, how) in [("half.json", &["--size=768"][..]), ("whole.json", &["--size=768", "--whole"])] {
        folder.run(&[&["impostor"], &plant[..], how, &["-o", name]].concat()).done();
    }
    folder.run(&[&["export"], &plant[..], &["-o", "plant.glb"]].concat()).done();
    let output = Command::new(clients.join("venv/bin/python"))
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/clients/impostor.py"))
        .arg(folder.path())
        // Between views; from so far away that all is seen without perspective; from below.
        .args(["half:30:8:2.6", "half:130:38:20", "whole:200:-30:2.6"])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}
