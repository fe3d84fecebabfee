//! Leaves against the definitions of what knobs say.

mod files;
mod kinds;
mod meshes;
mod places;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;
use linden_base::monitor::{Monitor, Quiet};
use linden_pipeline::preset::Preset;
use linden_pipeline::recipe::Recipe;
use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};

use super::*;
use crate::testing::Subject;

/// A recipe whose `[foliage]` says this. Without jitter, spread and terminal leaves.
fn recipe(foliage: &str) -> Subject {
    let plain = "leaf_jitter = 0\nleaf_size_spread = 0\nleaf_terminal = false\nleaf_droop = 0\nleaf_level = 0\nleaf_size = 32";
    let first = foliage.lines().take_while(|line| !line.starts_with('['));
    let keys: Vec<&str> = first.map(|line| line.split('=').next().unwrap_or("").trim()).collect();
    let kept = plain.lines().filter(|line| !keys.contains(&line.split('=').next().unwrap().trim()));
    let plain: Vec<&str> = kept.collect();
    let text =
        format!("id = \"a\"\n[colonization]\ncrown = \"sphere\"\n[foliage]\n{}\n{foliage}", plain.join("\n"));
    let preset = Preset::from_toml(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    Subject::of(Recipe::new(preset))
}

fn built(positions: Vec<Vec3>, parents: Vec<u32>, radii: Vec<f32>) -> Skeleton {
    let births = (0..positions.len() as u32).collect();
    let branching = Branching { positions, parents, births, radii: Some(radii), edges: None };
    Skeleton::build(branching, &Wood::default()).unwrap()
}

/// Twigs of a centimetre that stand apart and lean: each of `segments` segments of 0.1 m.
fn twigs(count: u32, segments: u32) -> Skeleton {
    let (mut positions, mut parents) = (Vec::new(), Vec::new());
    for twig in 0..count {
        let lean = Vec3::new(0.6, 0.8, 0.0);
        for node in 0..=segments {
            parents.push(if node == 0 { NO_PARENT } else { positions.len() as u32 - 1 });
            positions.push(Vec3::Z * twig as f32 * 5.0 + lean * (0.1 * node as f32));
        }
    }
    let radii = vec![0.01; positions.len()];
    built(positions, parents, radii)
}

/// An axis that bends and tapers, with a lateral; each segment divided into `pieces`.
fn bent(pieces: u32) -> Skeleton {
    let main = [(0., 0., 0.), (0.1, 1., 0.), (0.5, 1.8, 0.3), (1.3, 2.2, 0.4), (2.2, 2.3, 0.1)];
    let side = [(0.5, 1.8, 0.3), (0.3, 2.3, 1.1), (0.6, 2.4, 2.0)];
    let (mut positions, mut parents) = (vec![Vec3::from(main[0])], vec![NO_PARENT]);
    let mut radii = vec![0.05_f32];
    let mut births = vec![0];
    let mut grow = |line: &[(f32, f32, f32)], mut from: u32, thick: f32, first_birth: u32| {
        let mut last = from;
        for (i, pair) in line.windows(2).enumerate() {
            let (a, b) = (Vec3::from(pair[0]), Vec3::from(pair[1]));
            let radius = |t: f32| thick * (1.0 - 0.2 * (i as f32 + t));
            for piece in 1..=pieces {
                let t = piece as f32 / pieces as f32;
                parents.push(from);
                positions.push(a.lerp(b, t));
                radii.push(if last == 0 || i > 0 || thick > 0.04 { radius(t) } else { thick * 0.8 });
                births.push(first_birth + i as u32);
                from = positions.len() as u32 - 1;
            }
            last = from;
        }
    };
    grow(&main, 0, 0.05, 1);
    grow(&side, 2 * pieces, 0.02, 5);
    let branching = Branching { positions, parents, births, radii: Some(radii), edges: None };
    Skeleton::build(branching, &Wood::default()).unwrap()
}

fn sprout(
    subject: &Subject,
    skeleton: &Skeleton,
    given: &Arc<Organs>,
    monitor: &dyn Monitor,
) -> Result<Arc<Organs>, FoliageError> {
    subject.with(|specimen| super::sprout(specimen, skeleton, given, monitor))
}

fn grown(recipe: &Subject, skeleton: &Skeleton) -> Arc<Organs> {
    sprout(recipe, skeleton, &Arc::default(), &Quiet).unwrap()
}

/// What identifies a leaf, whatever its size and variant.
fn poses(organs: &Organs) -> BTreeSet<[u32; 9]> {
    let placed = &organs.placed;
    let bits = |v: Vec3| v.to_array().map(f32::to_bits);
    (0..placed.len())
        .map(|i| {
            let [p, h, u] = [placed.positions[i], placed.headings[i], placed.ups[i]].map(bits);
            [p[0], p[1], p[2], h[0], h[1], h[2], u[0], u[1], u[2]]
        })
        .collect()
}

#[test]
fn any_number_of_threads_gives_the_same_leaves() {
    let tree = twigs(1500, 6);
    let subject =
        recipe("leaf_form = \"curved\"\nleaf_jitter = 40\nleaf_normals = \"dome\"\nleaf_size_spread = 0.4");
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let organs = grown(&subject, &tree);
            let meshes = meshes(&organs, 1, &Quiet).unwrap();
            (organs, meshes)
        })
    };
    let one = on(1);
    assert!(one.0.len() > 30_000);
    assert!(one == on(3));
}

/// Grants eight mebibytes.
struct Small;

impl Monitor for Small {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: linden_base::monitor::Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        8 << 20
    }
}

#[test]
fn too_many_leaves_are_refused_before_they_grow() {
    let tree = twigs(2000, 10);
    let subject = recipe("leaf_form = \"card\"\nleaves_per_m = 100000");
    let error = sprout(&subject, &tree, &Arc::default(), &Quiet).unwrap_err();
    assert!(matches!(error, FoliageError::TooMany { .. }), "{error}");
    let subject = recipe("leaf_form = \"card\"\nleaves_per_m = 1000");
    let error = sprout(&subject, &tree, &Arc::default(), &Small).unwrap_err();
    assert!(matches!(error, FoliageError::Memory(_)), "{error}");
}

#[test]
fn no_knob_of_leaves_changes_the_wood() {
    use linden_base::knob::Kind;
    use linden_pipeline::grow::{GrowError, grow};
    use linden_pipeline::preset::{KNOBS, Section, builtin};
    let mut preset = builtin("sphere").unwrap().load().unwrap();
    for (knob, value) in [("points", "60"), ("leaf_form", "card"), ("leaf_size", "32"), ("leaves_per_m", "5")]
    {
        preset.set(knob, value).unwrap();
    }
    let hash = |preset: &Preset| {
        let recipe = Recipe::new(preset.clone());
        match grow(&recipe, &Quiet) {
            Ok(grown) => Some(grown.skeleton.hash()),
            // The mesh that is not there, and far too many leaves.
            Err(GrowError::Foliage(_)) => None,
            Err(other) => panic!("{other}"),
        }
    };
    let wood = hash(&preset).unwrap();
    let mut turned = 0;
    for knob in KNOBS.iter().filter(|knob| knob.section == Section::Foliage) {
        let values = match knob.knob.kind {
            Kind::Choice(words) => words.iter().map(|&word| word.to_owned()).collect(),
            Kind::Switch => vec!["true".to_owned(), "false".to_owned()],
            Kind::Real { min, max, .. } => vec![min.to_string(), (min + (max - min) * 0.1).to_string()],
            Kind::Integer { min, max } => vec![(min + 1).to_string(), (min + 20).min(max).to_string()],
            Kind::Reals { max, .. } => vec![if max < 3.0 { "0.2 0.6" } else { "2 3" }.to_owned()],
            Kind::Colors { .. } => vec!["#123456 #abcdef".to_owned()],
            Kind::Sequence { words, .. } => vec![words.join(" ")],
            other => panic!("a value of {other:?}"),
        };
        for value in values {
            let mut other = preset.clone();
            other.set(knob.knob.name, &value).unwrap();
            if let Some(hash) = hash(&other) {
                assert_eq!(hash, wood, "{}={value}", knob.knob.name);
                turned += 1;
            }
        }
    }
    assert!(turned > 60, "{turned}");
}
