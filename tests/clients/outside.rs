//! Runs `check.py`: usd-core, NVIDIA's and Khronos' validators, trimesh and our own comparison.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::Command;

use linden_tests::fixtures::{export, scene};

/// Programs that are not Rust; made by `tests/clients/setup.sh`.
fn python() -> PathBuf {
    let python = target().join("clients/venv/bin/python");
    assert!(
        python.is_file() && target().join("clients/complete").is_file(),
        "the outside clients are not installed: run tests/clients/setup.sh once (needs python3, npm and the net)"
    );
    python
}

/// The build directory: the client programs live in it too.
fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("cargo's tmp lies in target").to_owned()
}

pub fn run(script: &str, dir: &Path) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("clients").join(script);
    let output = Command::new(python()).arg(script).arg(dir).output().unwrap();
    assert!(
        output.status.success(),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// A folder for files. It stays where a test fails, to look at them, and goes where it passes: all together they are
/// gigabytes.
pub struct Exported(PathBuf);

impl Deref for Exported {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Exported {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = fs::remove_dir_all(&self.0);
        }
    }
}

pub fn exported(name: &str) -> Exported {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).unwrap();
    Exported(dir)
}

#[test]
fn every_client_takes_every_format() {
    let dir = exported("clients");
    // Enough vertices for 32-bit indices in one part, few enough for 16 bits in the other.
    let scene = scene(330, 200);
    for (format, file, options) in [
        ("obj", "tree.obj", &[][..]),
        ("ply", "tree.ply", &[]),
        ("ply-skeleton", "tree_skeleton.ply", &[]),
        ("gltf", "tree.gltf", &[]),
        ("glb", "tree.glb", &[]),
        ("usda", "tree.usda", &[]),
        ("usdc", "tree.usdc", &[]),
        ("usdz", "tree.usdz", &[]),
        ("stl", "tree.stl", &[]),
    ] {
        export(&scene, format, options, &dir.join(file)).unwrap();
    }
    run("check.py", &dir);
}

#[test]
fn every_client_takes_every_option() {
    let dir = exported("clients-options");
    let scene = scene(9, 7);
    for (format, file, options) in [
        ("obj", "ob\u{e9}.lines.obj", &[("lines", "true"), ("pictures", "false")][..]),
        ("ply", "ascii.ply", &[("encoding", "ascii")]),
        ("ply-skeleton", "ascii_skeleton.ply", &[("encoding", "ascii")]),
        ("gltf", "embedded.gltf", &[("embed", "true")]),
        ("gltf", "plain #1.gltf", &[("pictures", "false")]),
        ("gltf", "odd name #2.gltf", &[]),
        ("glb", "plain.glb", &[("pictures", "false")]),
        ("glb", "quantized.glb", &[("quantize", "true")]),
        ("glb", "lightmap.glb", &[("lightmap_uv", "true")]),
        (
            "glb",
            "lightmap_small.glb",
            &[("lightmap_uv", "true"), ("quantize", "true"), ("instances", "true")],
        ),
        ("usda", "lightmap.usda", &[("lightmap_uv", "true")]),
        ("glb", "jpeg.glb", &[("picture_format", "jpeg")]),
        ("gltf", "jpeg.gltf", &[("picture_format", "jpeg")]),
        ("glb", "webp.glb", &[("picture_format", "webp")]),
        ("gltf", "webp.gltf", &[("picture_format", "webp")]),
        ("usdz", "ar.usdz", &[("flavor", "ar")]),
        ("usdz", "binary.usdz", &[("layer", "binary")]),
        ("usdz", "binary_ar.usdz", &[("layer", "binary"), ("flavor", "ar")]),
        ("usdc", "plain.usdc", &[("pictures", "false"), ("skeleton", "false")]),
        ("obj", "odd name #2.obj", &[]),
        ("usda", "odd name #2.usda", &[]),
        ("usda", "plain.usda", &[("pictures", "false"), ("skeleton", "false")]),
    ] {
        export(&scene, format, options, &dir.join(file)).unwrap();
    }
    run("check.py", &dir);
}

#[test]
fn the_checks_catch_broken_files() {
    let dir = exported("clients-broken");
    let scene = scene(9, 7);
    for (format, file) in [
        ("obj", "tree.obj"),
        ("ply", "tree.ply"),
        ("ply-skeleton", "tree_skeleton.ply"),
        ("gltf", "tree.gltf"),
        ("glb", "tree.glb"),
        ("usda", "tree.usda"),
        ("stl", "tree.stl"),
    ] {
        export(&scene, format, &[], &dir.join(file)).unwrap();
    }
    run("test_check.py", &dir);
}
