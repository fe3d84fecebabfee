//! Each writer beside a naive one of the same content: `cargo bench -p linden-tests --bench writers`.
//!
//! Naive is what one writes first: `writeln!` (text) or a `write_all` per number (binary) into a
//! `BufWriter`. Both write files, round after round in turn, so that a busy machine slows both. `plain
//! write` is a single `write` of as many bytes that are ready in memory: nothing can be faster.

// A benchmark prints, and stops at the first surprise.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use linden::Quiet;
use linden::dress::dress;
use linden::grow::grow;
use linden::picture::Picture;
use linden::preset::builtin;
use linden::scene::Scene;
use linden_tests::fixtures::{export, large};
use linden_tests::presets::recipe;

const TRIANGLES: usize = 1_000_000;
const ROUNDS: usize = 9;

type Naive = fn(&Scene, &mut BufWriter<File>);

fn main() {
    // `cargo test --benches` only wants to know whether it runs.
    let (triangles, rounds) =
        if std::env::args().any(|a| a == "--bench") { (TRIANGLES, ROUNDS) } else { (2000, 1) };
    let scene = large(triangles);
    let count =
        |of: fn(&linden::scene::Mesh) -> usize| scene.parts.iter().map(|part| of(&part.mesh)).sum::<usize>();
    println!(
        "{} triangles, {} vertices, {} threads, medians of {rounds} rounds",
        count(|mesh| mesh.triangles.len()),
        count(|mesh| mesh.positions.len()),
        rayon::current_num_threads()
    );
    println!(
        "{:12} {:>8} {:>9} {:>9} {:>11} {:>8} {:>8} {:>16}",
        "format", "MB", "ours ms", "naive ms", "plain write", "× naive", "× plain", "fastest × naive"
    );
    let bare = &[("pictures", "false")][..];
    compare(&scene, rounds, "obj", "obj", bare, naive_obj);
    compare(&scene, rounds, "usda", "usda", bare, naive_usda);
    compare(&scene, rounds, "ply ascii", "ply", &[("encoding", "ascii")], naive_ply_ascii);
    compare(&scene, rounds, "ply", "ply", &[], naive_ply);
    compare(&scene, rounds, "glb", "glb", bare, naive_glb);
    compare(&scene, rounds, "glb tangents", "glb", &[], naive_glb);
    println!(
        "{:24} {:>9} {:>9} {:>9} {:>9} {:>8}",
        "texture", "bytes", "usual", "ours ms", "usual ms", "× usual"
    );
    for id in ["oak", "silver-birch", "norway-spruce"] {
        textures(id, rounds);
    }
}

/// Pictures of bark and leaves as files, beside what the encoder does unless it is told otherwise.
fn textures(id: &str, rounds: usize) {
    let mut recipe = recipe(builtin(id).unwrap());
    recipe.preset.set("points", "300").unwrap();
    let scene = dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap();
    for material in scene.materials {
        for (kind, picture) in [("", material.base_color_picture), ("_normal", material.normal_picture)] {
            let Some(picture) = picture else { continue };
            let (mut times, mut bytes) = ([const { Vec::new() }; 2], [0; 2]);
            for _ in 0..rounds {
                // A copy has no file yet.
                let fresh = Picture::new(picture.width(), picture.height(), picture.rgba().to_vec());
                let start = Instant::now();
                bytes[0] = fresh.png().unwrap().len();
                times[0].push(start.elapsed());
                let start = Instant::now();
                bytes[1] = fresh.srgb_png().unwrap().len();
                times[1].push(start.elapsed());
            }
            for rounds in &mut times {
                rounds.sort();
            }
            let [ours, usual] = times.map(|times| times[times.len() / 2].as_secs_f64() * 1e3);
            let title = format!("{id} {}{kind}", material.name);
            println!("{title:24} {:9} {:9} {ours:9.1} {usual:9.1} {:8.1}", bytes[0], bytes[1], usual / ours);
        }
    }
}

fn compare(scene: &Scene, rounds: usize, title: &str, format: &str, options: &[(&str, &str)], naive: Naive) {
    let dir = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let target = dir.path().join(format!("tree.{format}"));
    let mut times = [const { Vec::new() }; 3];
    let mut bytes = 0;
    for _ in 0..rounds {
        times[0].push(timed(&target, |target| {
            export(scene, format, options, target).unwrap();
        }));
        let ready = fs::read(&target).unwrap();
        bytes = ready.len();
        times[1].push(timed(&target, |target| {
            let mut out = BufWriter::new(File::create(target).unwrap());
            naive(scene, &mut out);
            out.flush().unwrap();
        }));
        times[2].push(timed(&target, |target| fs::write(target, &ready).unwrap()));
    }
    for rounds in &mut times {
        rounds.sort();
    }
    let [ours, naive, plain] = times.each_ref().map(|times| times[times.len() / 2].as_secs_f64() * 1e3);
    // What other programs on the machine take away, they take from some rounds only.
    let fastest = times[1][0].as_secs_f64() / times[0][0].as_secs_f64();
    println!(
        "{title:12} {:8.1} {ours:9.1} {naive:9.1} {plain:11.1} {:8.1} {:8.1} {fastest:16.1}",
        bytes as f64 / 1e6,
        naive / ours,
        ours / plain
    );
}

fn timed(target: &Path, work: impl FnOnce(&Path)) -> Duration {
    // Every round makes a new file: replacing one costs the freeing of its pages.
    let _ = fs::remove_file(target);
    let start = Instant::now();
    work(target);
    start.elapsed()
}

fn naive_obj(scene: &Scene, out: &mut BufWriter<File>) {
    let mut before = 1;
    for part in &scene.parts {
        writeln!(out, "o {}", part.name).unwrap();
        for p in &part.mesh.positions {
            writeln!(out, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for t in &part.mesh.uvs {
            writeln!(out, "vt {} {}", t.x, t.y).unwrap();
        }
        for n in &part.mesh.normals {
            writeln!(out, "vn {} {} {}", n.x, n.y, n.z).unwrap();
        }
        for [a, b, c] in part.mesh.triangles.iter().map(|t| t.map(|v| v + before)) {
            writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}").unwrap();
        }
        before += part.mesh.positions.len() as u32;
    }
}

fn naive_usda(scene: &Scene, out: &mut BufWriter<File>) {
    writeln!(out, "#usda 1.0").unwrap();
    for part in &scene.parts {
        writeln!(out, "def Mesh \"{}\" {{\nint[] faceVertexCounts = [", part.name).unwrap();
        for _ in &part.mesh.triangles {
            write!(out, "3, ").unwrap();
        }
        writeln!(out, "]\nint[] faceVertexIndices = [").unwrap();
        for [a, b, c] in &part.mesh.triangles {
            write!(out, "{a}, {b}, {c}, ").unwrap();
        }
        writeln!(out, "]\npoint3f[] points = [").unwrap();
        for p in &part.mesh.positions {
            write!(out, "({}, {}, {}), ", p.x, p.y, p.z).unwrap();
        }
        writeln!(out, "]\nnormal3f[] normals = [").unwrap();
        for n in &part.mesh.normals {
            write!(out, "({}, {}, {}), ", n.x, n.y, n.z).unwrap();
        }
        writeln!(out, "]\ntexCoord2f[] primvars:st = [").unwrap();
        for t in &part.mesh.uvs {
            write!(out, "({}, {}), ", t.x, t.y).unwrap();
        }
        writeln!(out, "]\n}}").unwrap();
    }
}

fn naive_ply_ascii(scene: &Scene, out: &mut BufWriter<File>) {
    let mut before = 0;
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        for ((p, n), t) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.uvs) {
            writeln!(out, "{} {} {} {} {} {} {} {} 120 90 60 255", p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y)
                .unwrap();
        }
        for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + before)) {
            writeln!(out, "3 {a} {b} {c}").unwrap();
        }
        before += mesh.positions.len() as u32;
    }
}

fn naive_ply(scene: &Scene, out: &mut BufWriter<File>) {
    let mut before = 0;
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        for ((p, n), t) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.uvs) {
            for number in [p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y] {
                out.write_all(&number.to_le_bytes()).unwrap();
            }
            out.write_all(&[120, 90, 60, 255]).unwrap();
        }
        for triangle in &mesh.triangles {
            out.write_all(&[3]).unwrap();
            for vertex in triangle {
                out.write_all(&(vertex + before).to_le_bytes()).unwrap();
            }
        }
        before += mesh.positions.len() as u32;
    }
}

fn naive_glb(scene: &Scene, out: &mut BufWriter<File>) {
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        for number in mesh.positions.iter().chain(&mesh.normals).flat_map(glam::Vec3::to_array) {
            out.write_all(&number.to_le_bytes()).unwrap();
        }
        for number in mesh.uvs.iter().flat_map(|t| [t.x, 1.0 - t.y]) {
            out.write_all(&number.to_le_bytes()).unwrap();
        }
        for vertex in mesh.triangles.iter().flatten() {
            out.write_all(&vertex.to_le_bytes()).unwrap();
        }
    }
}
