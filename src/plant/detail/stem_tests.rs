//! Stems in levels of detail, cut across as people see them from beside.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::*;
use crate::testing::{Subject, body};
use linden_base::mesh::Mesh;
use linden_base::monitor::Quiet;

/// Where an edge crosses a plane: the places of its ends.
type Crossing = [[u32; 3]; 2];

/// The outlines of a mesh in a level plane, each as the places of its corners in turn.
fn outlines(mesh: &Mesh, height_m: f32) -> Vec<Vec<Vec2>> {
    let mut places: BTreeMap<Crossing, Vec2> = BTreeMap::new();
    let mut next: BTreeMap<Crossing, Vec<Crossing>> = BTreeMap::new();
    for corners in &mesh.triangles {
        let corners = corners.map(|i| mesh.positions[i as usize]);
        let mut ends = Vec::new();
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
            if low.y < height_m && high.y >= height_m {
                let at = low.lerp(high, (height_m - low.y) / (high.y - low.y));
                let key = [low, high].map(|end: Vec3| end.to_array().map(f32::to_bits));
                places.insert(key, Vec2::new(at.x, at.z));
                ends.push(key);
            }
        }
        if let [a, b] = ends[..] {
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
    }
    let mut found = Vec::new();
    while let Some((&first, _)) = next.first_key_value() {
        let (mut outline, mut here) = (Vec::new(), first);
        while let Some(ways) = next.remove(&here) {
            outline.push(places[&here]);
            let Some(&on) = ways.iter().find(|way| next.contains_key(*way)) else { break };
            here = on;
        }
        found.push(outline);
    }
    found
}

/// Corners where an outline turns: cuts through a side's two triangles lie in a line.
fn sides(outline: &[Vec2]) -> usize {
    let at = |i: usize| outline[i % outline.len()];
    let apart: Vec<Vec2> = (0..outline.len()).filter(|&i| at(i).distance(at(i + 1)) > 1e-4).map(at).collect();
    let at = |i: usize| apart[i % apart.len()];
    let turns = |i: usize| (at(i + 1) - at(i)).angle_to(at(i + 2) - at(i + 1)).abs() > 0.08;
    (0..apart.len()).filter(|&i| turns(i)).count()
}

/// The sides of the widest wood at a height.
fn sides_at(mesh: &Mesh, height_m: f32) -> usize {
    let width = |outline: &Vec<Vec2>| outline.iter().map(|at| at.distance(outline[0])).fold(0.0, f32::max);
    let all = outlines(mesh, height_m);
    let widest = all.iter().max_by(|a, b| width(a).total_cmp(&width(b)));
    widest.map_or(0, |outline| sides(outline))
}

/// A level's wood, and its triangles in all.
fn level(simplifier: &Simplifier<'_>, budget: u64) -> (Mesh, u64) {
    let detail = simplifier.within(budget, true, &Quiet).unwrap();
    let thin = simplifier.simplified(&detail, &Quiet).unwrap();
    let mesh = surface::sweep(&thin.skeleton, &thin.tubes, &Quiet).unwrap();
    (mesh, simplifier.triangles(&detail, &Quiet).unwrap())
}

#[test]
fn stems_are_round_where_people_stand_beside_them_and_budgets_are_met() {
    for id in ["silver-birch", "scots-pine", "oak"] {
        let subject = Subject::builtin(id, &[]);
        let grown = subject.grow();
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        for (budget, least) in [(20_000, 10), (10_000, 8), (5000, 8), (4000, 6), (1500, 6), (600, 5)] {
            let (mesh, triangles) = level(&simplifier, budget);
            assert!(triangles.abs_diff(budget) * 20 <= budget, "{id} {budget}: {triangles}");
            for height_m in [0.3, 0.8, 1.3] {
                let found = sides_at(&mesh, height_m);
                assert!(found >= least, "{id} {budget}: {found} sides at {height_m} m");
            }
        }
    }
}

#[test]
fn no_more_sides_than_asked_for() {
    let subject =
        Subject::builtin("scots-pine", &[("sides", "4"), ("surface_roots", "0"), ("flare_ridges", "0")]);
    let grown = subject.grow();
    let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
    assert_eq!(sides_at(&level(&simplifier, 10_000).0, 1.3), 4);
}

#[test]
fn a_foot_keeps_buttresses_and_roots_in_coarser_levels() {
    let subject = Subject::builtin("oak", &[]);
    let grown = subject.grow();
    let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
    for (budget, roots) in [(20_000, 3), (10_000, 3), (5000, 2), (4000, 1)] {
        let (mesh, _) = level(&simplifier, budget);
        // Roots have outlines of their own, beyond the trunk's.
        let found = outlines(&mesh, 0.02).len();
        assert!(found > roots, "{budget}: {found}");
        assert!(sides_at(&mesh, 0.3) >= 12, "{budget}: {}", sides_at(&mesh, 0.3));
    }
    // The flare stays wide, and has its buttresses.
    let (mesh, _) = level(&simplifier, 2000);
    assert!(sides_at(&mesh, 0.1) >= 12, "{}", sides_at(&mesh, 0.1));
}
