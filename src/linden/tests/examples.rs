//! The examples do what they say. `cargo test` builds them beside this test.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs an example in a folder; what it printed.
fn run(folder: &Path, name: &str, file: &str) -> String {
    let test = env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap().join("examples");
    let program = built.join(format!("{name}{}", env::consts::EXE_SUFFIX));
    let output = Command::new(&program).arg(file).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn beginning(file: PathBuf) -> Vec<u8> {
    let bytes = std::fs::read(file).unwrap();
    bytes[..bytes.len().min(64)].to_vec()
}

#[test]
fn a_preset_becomes_a_file_and_so_does_a_forest() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["minimal", "forest"] {
        let said = run(folder.path(), name, "a.glb");
        assert!(said.contains("a.glb") && said.contains("bytes"), "{said}");
        assert!(beginning(folder.path().join("a.glb")).starts_with(b"glTF"));
        std::fs::remove_file(folder.path().join("a.glb")).unwrap();
    }
}

#[test]
fn no_tree_of_the_forest_has_more_triangles_than_its_budget() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), "forest", "a.glb");
    let counts = said.lines().filter_map(|line| line.strip_suffix(" triangles")?.rsplit_once(": "));
    let counts: Vec<u64> = counts.map(|(_, count)| count.parse().unwrap()).collect();
    assert!(counts.len() >= 2 && counts.iter().all(|count| (1000..=4000).contains(count)), "{said}");
}

#[test]
fn a_hundred_trees_are_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), "sweep", "");
    let rows: Vec<Vec<&str>> = said.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.len() == 101 && rows.iter().all(|row| row.len() == rows[0].len()), "{said}");
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let (length, volume) = (column("total_length_m"), column("wood_volume_m3"));
    // The same seed has the same axes, as thick as the exponent makes them.
    assert_eq!(rows[1][length], rows[21][length]);
    assert_ne!(rows[1][volume], rows[21][volume]);
    assert_ne!(rows[1][length], rows[2][length]);
}

#[test]
fn a_grammar_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), "grammar", "weed.png");
    // ABOP, Fig. 1.24 d: in each of 7 derivations an X leaves 2 F and 3 X, and every F becomes two.
    let (mut x, mut f) = (1_u32, 0);
    for _ in 0..7 {
        (x, f) = (3 * x, 2 * f + 2 * x);
    }
    assert!(said.starts_with(&format!("{f} segments")), "{said}, not {f}");
    assert!(beginning(folder.path().join("weed.png")).starts_with(b"\x89PNG"));
}

#[test]
fn a_renderer_gets_buffers_and_a_program_its_own_format() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), "mesh", "");
    assert!(said.contains("8 floats a vertex") && said.contains("bark"), "{said}");
    run(folder.path(), "exporter", "fir.axes");
    assert!(beginning(folder.path().join("fir.axes")).starts_with(b"axis,order,x,y,z,radius\n0,0,"));
}
