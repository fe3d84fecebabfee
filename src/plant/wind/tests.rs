use glam::Vec3;

use super::*;
use crate::detail;
use crate::scene::Scene;
use crate::testing::{Subject, body};
use linden_base::monitor::Quiet;
use linden_pipeline::grow::Grown;

fn grown(id: &str, knobs: &[(&str, &str)]) -> (Subject, Grown) {
    let subject = Subject::builtin(id, &[&[("bark_size", "16")], knobs].concat());
    let grown = subject.grow();
    (subject, grown)
}

fn windy(id: &str, knobs: &[(&str, &str)]) -> (Grown, Scene) {
    let (recipe, grown) = grown(id, &[&[("wind", "sway")], knobs].concat());
    let scene = recipe.dress(&grown);
    (grown, scene)
}

fn offset(wind: &PartWind, motion: Motion, vertex: usize) -> Vec3 {
    wind.targets
        .iter()
        .find(|target| target.motion == motion)
        .map_or(Vec3::ZERO, |target| target.offsets[vertex])
}

#[test]
fn without_wind_nothing_changes_and_with_it_only_wind_is_added() {
    let (recipe, tree) = grown("abop-flower", &[]);
    let calm = recipe.dress(&tree);
    assert!(calm.parts.iter().all(|part| part.wind.is_none()));
    let (same, blown) = windy("abop-flower", &[]);
    assert_eq!(same.skeleton.hash(), tree.skeleton.hash());
    for (a, b) in calm.parts.iter().zip(&blown.parts) {
        assert_eq!(a.mesh, b.mesh);
    }
}

#[test]
fn every_vertex_has_its_wind_and_the_foot_stands_still() {
    for id in ["abop-flower", "fir", "older-shrub"] {
        let (tree, scene) = windy(id, &[("wind_strength", "1")]);
        let feet: Vec<Vec3> = tree
            .skeleton
            .axes
            .iter()
            .filter(|axis| axis.parent == linden_skeleton::NO_PARENT)
            .map(|axis| tree.skeleton.positions[tree.skeleton.nodes_of(axis)[0] as usize])
            .collect();
        for part in &scene.parts {
            let wind = part.wind.as_ref().unwrap();
            let count = part.mesh.positions.len();
            assert_eq!((wind.motions.len(), wind.pivots.len()), (count, count), "{id} {}", part.name);
            assert_eq!(wind.targets.len(), if part.name == "wood" { 4 } else { 6 });
            let mut moves = 0;
            for (vertex, &place) in part.mesh.positions.iter().enumerate() {
                let [level, phase, sway, flutter] = wind.motions[vertex];
                assert!((0.0..1.0).contains(&phase) && (0.0..=1.0).contains(&sway));
                assert!((0.0..=1.0).contains(&flutter) && (part.name != "wood" || flutter == 0.0));
                let [x, y, z, distance] = wind.pivots[vertex];
                assert!((place.distance(Vec3::new(x, y, z)) - distance).abs() < 1e-4);
                let moved: Vec3 = Motion::ALL.map(|motion| offset(wind, motion, vertex).abs()).iter().sum();
                assert!(moved.is_finite());
                moves += usize::from(moved != Vec3::ZERO);
                if level == 0.0 && feet.iter().any(|foot| place.y <= foot.y) {
                    assert_eq!((moved, sway), (Vec3::ZERO, 0.0), "{id}: {place}");
                }
            }
            assert!(moves > count / 2, "{id} {}: {moves} of {count}", part.name);
        }
    }
}

#[test]
fn roots_on_the_ground_stand_still() {
    let (_, bare) = windy("fir", &[("wind_strength", "1")]);
    let (_, rooted) = windy("fir", &[("wind_strength", "1"), ("surface_roots", "6"), ("root_reach", "15")]);
    let known: std::collections::BTreeSet<_> =
        bare.parts[0].mesh.positions.iter().map(|place| place.to_array().map(f32::to_bits)).collect();
    let wind = rooted.parts[0].wind.as_ref().unwrap();
    let mut roots = 0;
    for (vertex, place) in rooted.parts[0].mesh.positions.iter().enumerate() {
        if known.contains(&place.to_array().map(f32::to_bits)) {
            continue;
        }
        roots += 1;
        assert_eq!(wind.motions[vertex][2], 0.0, "{place}");
        assert!(Motion::ALL.iter().all(|&motion| offset(wind, motion, vertex) == Vec3::ZERO), "{place}");
    }
    assert!(roots > 500, "{roots}");
    // A trunk moves as it did.
    assert_eq!(wind.motions.len() - roots, bare.parts[0].mesh.positions.len());
}

/// Where a branch begins, it goes with its parent: no gap opens.
#[test]
fn branches_go_where_their_parents_go() {
    let (recipe, tree) = grown("fir", &[("wind", "sway"), ("wind_strength", "1")]);
    let field = recipe.with(|specimen| Field::of(specimen, &tree.skeleton)).unwrap();
    let mesh = crate::surface::sweep(&tree.skeleton, &recipe.dressing.tubes, &Quiet).unwrap();
    let tubes = crate::surface::count(&tree.skeleton, &recipe.dressing.tubes, &Quiet).unwrap();
    let wind = Blown { field: &field, axes: None }.wood(&mesh, &tubes, &Quiet).unwrap();
    let (mut first, mut firsts) = (0, Vec::new());
    for tube in &tubes {
        firsts.push(first);
        first += tube.vertices;
    }
    let mut checked = 0;
    for (index, axis) in
        tree.skeleton.axes.iter().enumerate().filter(|(_, axis)| axis.parent != linden_skeleton::NO_PARENT)
    {
        if tubes[index].vertices == 0 {
            continue;
        }
        // The parent's vertex that is nearest to the branch's first one.
        let parent =
            tree.skeleton.axes.iter().position(|other| tree.skeleton.nodes_of(other).contains(&axis.parent));
        let parent = parent.unwrap();
        let range = firsts[parent]..firsts[parent] + tubes[parent].vertices;
        let foot = tree.skeleton.positions[axis.parent as usize];
        let nearest = range.min_by(|&a, &b| {
            let away = |v: usize| mesh.positions[v].distance(foot);
            away(a).total_cmp(&away(b))
        });
        let nearest = nearest.unwrap();
        for motion in Motion::ALL {
            let gap = offset(&wind, motion, firsts[index]).distance(offset(&wind, motion, nearest));
            let away = mesh.positions[nearest].distance(foot);
            assert!(gap <= 0.5 * away + 1e-4, "axis {index}: {gap} at {away}");
        }
        checked += 1;
    }
    assert!(checked > 100);
}

#[test]
fn two_targets_hold_any_phase() {
    let (_, scene) = windy("fir", &[("wind_strength", "1"), ("gustiness", "0")]);
    let wind = scene.parts[0].wind.as_ref().unwrap();
    let sway = wind.sway.as_ref().unwrap();
    let at = |vertex: usize, frame: u32| -> Vec3 {
        Motion::ALL.map(|motion| offset(wind, motion, vertex) * sway.weight(motion, frame)).iter().sum()
    };
    // Without the stem a vertex goes to and fro in one sine of its own phase: the mean of its way is
    // zero, and the mean of its square is half of the amplitude's.
    for vertex in (0..wind.motions.len()).step_by(997) {
        let stem = offset(wind, Motion::Stem, vertex);
        let way: Vec<f32> = (0..sway.frames())
            .map(|frame| (at(vertex, frame) - stem * (sway.weight(Motion::Stem, frame) - 0.5)).x)
            .collect();
        let ends = [Motion::BranchSine, Motion::BranchCosine].map(|motion| offset(wind, motion, vertex).x);
        // A target goes from one end of 1.6 amplitudes to the other.
        let amplitude = ends[0].hypot(ends[1]) / 3.2;
        let mean = way.iter().sum::<f32>() / way.len() as f32;
        let power = way.iter().map(|x| x * x).sum::<f32>() / way.len() as f32;
        assert!(mean.abs() <= 1e-3 * amplitude + 1e-6, "{mean} of {amplitude}");
        assert!((power - amplitude * amplitude / 2.0).abs() <= 1e-2 * amplitude * amplitude + 1e-9);
    }
}

#[test]
fn a_loop_closes_and_shows_every_period() {
    for frequency_hz in [0.05, 0.3, 0.77, 1.0] {
        let sway = Sway::new(&Blow { frequency_hz, ..Blow::default() });
        assert!(sway.frames() >= 32);
        let wanted = 2.0 * 24.0 / frequency_hz;
        assert!((f64::from(sway.frames()) / wanted - 1.0).abs() < 0.02, "{frequency_hz}");
        for motion in Motion::ALL {
            assert_eq!(sway.weight(motion, 0), sway.weight(motion, sway.frames()));
            let step = (0..sway.frames())
                .map(|frame| (sway.weight(motion, frame + 1) - sway.weight(motion, frame)).abs())
                .fold(0.0, f32::max);
            assert!(step < 0.4, "{motion:?} goes on smoothly: {step}");
            let weights = (0..sway.frames()).map(|frame| sway.weight(motion, frame));
            assert!(weights.clone().all(|weight| (0.0..=1.0).contains(&weight)));
            let moves = weights.clone().any(|weight| weight != sway.weight(motion, 0));
            assert_eq!(moves, motion != Motion::Begin);
        }
    }
}

#[test]
fn all_levels_swing_alike() {
    let (recipe, tree) = grown("fir", &[("wind", "sway"), ("lods", "3"), ("lod_ratio", "0.2")]);
    let all = recipe.with(|specimen| detail::levels(specimen, body(&tree), &Quiet)).unwrap().levels;
    assert_eq!(all.len(), 3);
    let key = |wind: &PartWind, vertex: usize| {
        let [x, y, z, _] = wind.pivots[vertex];
        ([x, y, z].map(f32::to_bits), wind.motions[vertex][0].to_bits())
    };
    let finest = all[0].scene.parts[0].wind.as_ref().unwrap();
    let mut phases = std::collections::BTreeMap::<_, Vec<u32>>::new();
    for vertex in 0..finest.motions.len() {
        phases.entry(key(finest, vertex)).or_default().push(finest.motions[vertex][1].to_bits());
    }
    for level in &all[1..] {
        let wind = level.scene.parts[0].wind.as_ref().unwrap();
        assert_eq!(level.scene.skeleton.hash(), tree.skeleton.hash());
        for vertex in 0..wind.motions.len() {
            let known = &phases[&key(wind, vertex)];
            assert!(known.contains(&wind.motions[vertex][1].to_bits()), "an axis keeps its phase");
        }
    }
}

/// Two ways to the same place: morph targets of the surface, and the skeleton itself.
#[test]
fn pictures_that_move_show_what_the_targets_say() {
    for id in ["fir", "abop-flower"] {
        let (recipe, tree) = grown(id, &[("wind", "sway"), ("wind_strength", "0.8")]);
        let (blow, seed) = (&recipe.dressing.wind.blow, recipe.recipe.preset.seed());
        let scene = recipe.dress(&tree);
        let wood = &scene.parts[0];
        let frames = wood.wind.as_ref().unwrap().sway.as_ref().unwrap().frames();
        let feet: Vec<usize> = (0..tree.skeleton.positions.len())
            .filter(|i| tree.skeleton.parents[*i] == linden_skeleton::NO_PARENT)
            .collect();
        let mut way = 0.0_f32;
        for frame in [0, frames / 3, frames / 2, frames] {
            let (blown, leaves) = blown(blow, seed, &tree.skeleton, &tree.organs, frame, &Quiet).unwrap();
            assert_eq!(blown.parents, tree.skeleton.parents);
            for &foot in &feet {
                assert_eq!(blown.positions[foot], tree.skeleton.positions[foot], "{id}: it stands still");
            }
            let moved = wood.wind.as_ref().unwrap().moved(&wood.mesh.positions, frame).unwrap();
            // The vertices around a node swing as it does, but for the thickness of the wood.
            let thick = tree.skeleton.radii.iter().copied().fold(0.0, f32::max);
            for (vertex, place) in wood.mesh.positions.iter().enumerate().step_by(211) {
                let distance = |node: &usize| tree.skeleton.positions[*node].distance(*place);
                let nearest =
                    (0..blown.positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                let shift = blown.positions[nearest] - tree.skeleton.positions[nearest];
                let gap = (moved[vertex] - *place).distance(shift);
                assert!(gap <= 0.6 * distance(&nearest).max(thick) + 1e-3, "{id} {frame}: {gap}");
                way = way.max(shift.length());
            }
            for (heading, up) in leaves.placed.headings.iter().zip(&leaves.placed.ups) {
                assert!((heading.length() - 1.0).abs() < 1e-4 && heading.dot(*up).abs() < 1e-3);
            }
        }
        assert!(way > 0.01, "{id} moves: {way}");
        let at = |frame| blown(blow, seed, &tree.skeleton, &tree.organs, frame, &Quiet).unwrap().0.positions;
        assert!(at(0) == at(frames) && at(0) != at(frames / 3), "a loop");
    }
}
