//! Every built-in preset: it loads, it grows the same tree as ever, its surface is sound.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on fails")]

mod ages;
mod declared_knobs;
mod gallery;
mod plants;

use std::fmt::Write as _;
use std::path::Path;

use linden::Quiet;
use linden::grow::{Grown, grow};
use linden::preset::{Heading, Preset, builtins};
use linden::surface::{Topology, sweep, topology};
use linden_tests::presets::{Plant, plants, recipe};

#[test]
fn each_document_says_what_and_whence() {
    for builtin in builtins() {
        let preset = builtin.load().unwrap_or_else(|fault| panic!("{}: {fault}", builtin.id));
        assert_eq!(preset.id, builtin.id, "the id is the file's name");
        for (what, text) in [("name", &preset.name), ("summary", &preset.summary), ("source", &preset.source)]
        {
            assert!(!text.is_empty(), "{} has no {what}", builtin.id);
        }
        assert!(
            !preset.summary.ends_with('.') && preset.summary.len() < 90,
            "{}: {}",
            builtin.id,
            preset.summary
        );
    }
}

/// The document that a preset is written as gives the preset back, as TOML and as a recipe's JSON.
#[test]
fn documents_survive_writing_and_reading() {
    for builtin in builtins() {
        let preset = builtin.load().unwrap();
        assert_eq!(Preset::from_toml(&preset.to_toml().unwrap()).unwrap(), preset, "{}", builtin.id);
        let line = recipe(builtin).to_line();
        assert!(line.bytes().all(|b| (b' '..=b'~').contains(&b)), "printable ASCII: {line}");
        assert_eq!(Preset::from_json(&line).unwrap(), preset, "{}", builtin.id);
    }
}

#[test]
fn a_list_shows_what_the_document_says() {
    for builtin in builtins() {
        let (head, preset) = (builtin.heading().unwrap(), builtin.load().unwrap());
        let Heading { name, group, summary, source, tags, generator } = head;
        assert_eq!(
            (name, group, summary, source, tags, generator),
            (
                preset.name,
                preset.group,
                preset.summary,
                preset.source,
                preset.tags,
                Some(preset.generator.generator().id())
            )
        );
        assert_eq!(builtin.id, preset.id);
    }
}

#[test]
fn each_surface_is_closed_unfolded_and_finite() {
    for Plant { id, recipe, grown } in plants() {
        let mesh = sweep(&grown.skeleton, &recipe.preset.dressing.tubes, &Quiet).unwrap();
        let found = topology(&mesh, &Quiet).unwrap();
        assert_eq!(found, Topology::default(), "{id}");
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{id}");
        assert_eq!(grown.colonized.as_ref().map_or(0, |colonized| colonized.unreached), 0, "{id}");
    }
}

/// Of what is as thick as its height says: the foot of the thickest stem, against the knob.
#[test]
fn slenderness_is_height_by_diameter_at_the_foot() {
    let mut by_height = 0;
    for Plant { id, recipe, grown } in plants() {
        if recipe.preset.idle("slenderness").is_some() {
            continue;
        }
        let mut slender = recipe.clone();
        slender.preset.set("slenderness", "75").unwrap();
        slender.preset.set("refine", "subdivide").unwrap();
        let slender = grow(&slender, &Quiet).map(|grown| (grown, 75.0));
        let as_it_is = (&grown.skeleton, recipe.preset.wood.slenderness);
        let all =
            [as_it_is].into_iter().chain(slender.iter().map(|(grown, wanted)| (&grown.skeleton, *wanted)));
        for (skeleton, wanted) in all {
            let heights = || skeleton.positions.iter().map(|p| p.y);
            let height = heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min);
            let width = |axis: fn(&linden::Vec3) -> f32| {
                let along = || skeleton.positions.iter().map(axis);
                along().fold(f32::MIN, f32::max) - along().fold(f32::MAX, f32::min)
            };
            // What lies has a length instead.
            if height < 0.1 * width(|p| p.x).max(width(|p| p.z)) {
                continue;
            }
            let feet = (0..skeleton.parents.len()).filter(|&i| skeleton.parents[i] == linden::NO_PARENT);
            let foot = feet.map(|i| skeleton.radii[i]).fold(0.0, f32::max);
            let found = f64::from(height / (2.0 * foot));
            assert!((found / wanted - 1.0).abs() < 0.01, "{id}: {found}, not {wanted}");
            by_height += 1;
        }
    }
    assert!(by_height > 40, "{by_height}");
}

/// The same tree again tomorrow. After a change that is meant to change trees:
/// `LINDEN_UPDATE=1 cargo test -p linden-tests --test presets`.
#[test]
fn each_tree_is_the_one_it_was() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut trees = String::from("# preset, nodes, axes, hash of the skeleton\n");
    let mut sizes = String::from("# preset, height in metres, leaves: what 'linden list' says\n");
    for Plant { id, grown: Grown { skeleton, organs, .. }, .. } in plants() {
        writeln!(sizes, "{id} {:.2} {}", skeleton.measures().height_m, organs.len()).unwrap();
        let (nodes, axes) = (skeleton.positions.len(), skeleton.axes.len());
        writeln!(trees, "{id} {nodes} {axes} {:032x}", skeleton.hash()).unwrap();
    }
    as_before(&folder.join("presets/trees.txt"), &trees);
    as_before(&folder.join("../presets/sizes.txt"), &sizes);
}

fn as_before(golden: &Path, text: &str) {
    if std::env::var_os("LINDEN_UPDATE").is_some() {
        std::fs::write(golden, text).unwrap();
    }
    let expected = std::fs::read_to_string(golden).unwrap();
    for (now, then) in text.lines().zip(expected.lines()) {
        assert_eq!(now, then, "a preset grows another tree (see LINDEN_UPDATE above)");
    }
    assert_eq!(
        text.lines().count(),
        expected.lines().count(),
        "presets came or went (see LINDEN_UPDATE above)"
    );
}

#[test]
fn any_number_of_threads_grows_the_same_tree() {
    let on = |threads: usize, id: &str| {
        let builtin = builtins().iter().find(|builtin| builtin.id == id).unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| grow(&recipe(builtin), &Quiet).unwrap().hash())
    };
    for id in ["heart", "sphere", "abop-stochastic", "dressed-simple"] {
        assert_eq!(on(1, id), on(4, id), "{id}");
    }
}
