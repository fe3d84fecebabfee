//! Forecasts beside the trees and files that they are of: nodes, triangles, bytes of a GLB, and seconds,
//! whose rates are in `exporters/seconds.rs`.

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "it prints a table")]

use std::time::Instant;

use linden::Quiet;
use linden::dress::levels;
use linden::forecast::sample;
use linden::grow::grow;
use linden::preset::{builtin, builtins};
use linden::recipe::Recipe;
use linden_exporters::{Bundle, Estimate, Options, find};
use linden_tests::presets::recipe;

/// Larger ones, and other seeds, than the presets have.
const TURNED: [(&str, &[(&str, &str)]); 12] = [
    ("abop-a", &[("derivations", "8")]),
    ("wild-cherry", &[("seed", "31"), ("years", "24")]),
    ("fir", &[("points", "200000")]),
    ("sphere", &[("points", "1000000"), ("sides", "3")]),
    ("drawn-oak", &[("points", "60000"), ("seed", "5")]),
    ("oak", &[("sides", "64"), ("rings", "4")]),
    ("oak", &[("bark_size", "2048"), ("leaf_size", "2048")]),
    ("oak", &[("lods", "4"), ("billboard", "2")]),
    ("oak", &[("triangles", "60000")]),
    ("oak", &[("wind", "sway")]),
    ("drawn-beech", &[("points", "50000"), ("leaves_per_m", "90")]),
    ("umbrella-thorn", &[("points", "20000"), ("seed", "3")]),
];

fn main() {
    println!(
        "| tree | nodes | triangles | bytes | show, ms | growing, s | | dressing, s | | writing, s | | all |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    // Threads and tables are made once.
    let first = recipe(builtin("oak").unwrap());
    let _ = sample(&first, &Quiet);
    for builtin in builtins() {
        row(builtin.id, &recipe(builtin));
    }
    for (id, settings) in TURNED {
        let mut recipe = recipe(builtin(id).unwrap());
        for (knob, value) in settings {
            recipe.preset.set(knob, value).unwrap();
        }
        let turned: Vec<String> = settings.iter().map(|(knob, value)| format!("{knob}={value}")).collect();
        row(&format!("{id} {}", turned.join(" ")), &recipe);
    }
}

fn seconds<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let started = Instant::now();
    let done = work();
    (done, started.elapsed().as_secs_f64())
}

/// Forecast ÷ truth of counts; forecast and truth of seconds.
fn row(what: &str, recipe: &Recipe) {
    let exporter = find("glb").unwrap();
    let options = Options::new(exporter.format());
    let (sample, sampled_s) = seconds(|| sample(recipe, &Quiet).unwrap());
    let (estimate, counted_s) = seconds(|| Estimate::of_sample(recipe, &sample, &Quiet).unwrap());
    let (grown, grow_s) = seconds(|| grow(recipe, &Quiet).unwrap());
    let (dressed, dress_s) = seconds(|| levels(recipe, &grown, &Quiet).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let ((), write_s) = seconds(|| {
        let mut bundle = Bundle::create(&folder.path().join("tree.glb")).unwrap();
        exporter.write(&dressed.stage(), &options, &mut bundle, &Quiet).unwrap();
        bundle.commit().unwrap();
    });
    let bytes: u64 =
        folder.path().read_dir().unwrap().map(|entry| entry.unwrap().metadata().unwrap().len()).sum();
    let scene = &dressed.levels[0].scene;
    let triangles: usize = scene.parts.iter().map(|part| part.mesh.triangles.len()).sum();
    let forecast = [
        sampled_s * sample.work_times(),
        estimate.dress_seconds(recipe),
        estimate.compress_seconds(recipe) + estimate.write_seconds(exporter.format(), &options).unwrap(),
    ];
    let truth = [grow_s, dress_s, write_s];
    let times: Vec<String> = forecast.iter().zip(truth).map(|(a, b)| format!("{a:.3} | {b:.3}")).collect();
    println!(
        "| {what} | {:.2} | {:.2} | {:.2} | {:.0} | {} | {:.2} |",
        sample.nodes() / grown.skeleton.positions.len() as f64,
        estimate.triangles as f64 / triangles as f64,
        estimate.bytes(exporter.format(), &options).unwrap() as f64 / bytes as f64,
        (sampled_s + counted_s) * 1e3,
        times.join(" | "),
        forecast.iter().sum::<f64>() / truth.iter().sum::<f64>(),
    );
}
