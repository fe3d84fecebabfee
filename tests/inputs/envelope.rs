//! Envelopes against formulas: inside, volume, uniformity, and what broken meshes are told.

use std::f64::consts::PI;
use std::sync::Arc;

use linden::colonization::crown::Crown;
use linden::colonization::crown::envelope::{Envelope, EnvelopeError};
use linden::colonization::scatter::scatter;
use linden::grow::{Grown, grow};
use linden::input::{TriangleMesh, Up};
use linden::preset::{Preset, Space};
use linden::random::Key;
use linden::recipe::{Geometry, Input, Recipe};
use linden::skeleton::{NO_PARENT, Skeleton};
use linden::{DVec3, Quiet};

use crate::shapes::{ball, in_box, inside_out, together, torus};

fn envelope(mesh: &TriangleMesh) -> Envelope {
    Envelope::new(mesh, &Quiet).unwrap()
}

/// How deep a point lies in the torus of the formula, which rests on y = 0 as envelopes do.
fn depth_in_torus(p: DVec3) -> f64 {
    1.0 - libm::hypot(libm::hypot(p.x, p.z) - 3.0, p.y - 1.0)
}

#[test]
fn a_torus_holds_what_its_formula_holds() {
    let torus = envelope(&torus(160, 80));
    let report = torus.report();
    assert!(report.closed && report.warnings().len() == usize::from(report.inverted));
    assert_eq!((report.components, report.boundary_edges, report.triangles), (1, 0, 160 * 80 * 2));
    assert!((report.volume_m3 / (2.0 * PI * PI * 3.0) - 1.0).abs() < 2e-3, "{}", report.volume_m3);
    let mut inside = 0;
    for i in 0..20_000 {
        let p = in_box(Key::new(1).child(i), DVec3::new(-4.2, -0.2, -4.2), DVec3::new(4.2, 2.2, 4.2));
        let depth = depth_in_torus(p);
        // The polyhedron lies within 2e-3 of the surface.
        if depth.abs() > 3e-3 {
            assert_eq!(torus.contains(p), depth > 0.0, "{p}");
            inside += u32::from(depth > 0.0);
        }
    }
    assert!(inside > 3000);
}

#[test]
fn points_are_inside_and_uniform() {
    let torus = envelope(&torus(160, 80));
    let points = scatter(&torus, 60_000, Key::new(2), &Quiet).unwrap();
    // Equal volumes: 12 sectors × 4 shells of the tube's section, each halved by the tube's axis circle
    // (by Pappus, a half section at distance c from the axis sweeps area × 2π c).
    let mut counts = [[[0.0_f64; 2]; 4]; 12];
    for p in &points {
        assert!(depth_in_torus(*p) > -1e-9, "{p}");
        let turn = (libm::atan2(p.z, p.x) / (2.0 * PI) + 0.5) * 12.0;
        let across = libm::hypot(p.x, p.z) - 3.0;
        let shell = (across * across + (p.y - 1.0) * (p.y - 1.0)) * 4.0;
        counts[(turn as usize).min(11)][(shell as usize).min(3)][usize::from(across > 0.0)] += 1.0;
    }
    let mut chi_square = 0.0;
    for shell in 0..4 {
        // Area of the half ring and the distance of its centroid from the tube's middle.
        let (inner, outer) = ((f64::from(shell) / 4.0).sqrt(), (f64::from(shell + 1) / 4.0).sqrt());
        let area = PI * 0.25 / 2.0;
        let centroid = 2.0 / 3.0 * (outer * outer * outer - inner * inner * inner) / area;
        for half in 0..2 {
            let distance = if half == 1 { 3.0 + centroid } else { 3.0 - centroid };
            let part = area * 2.0 * PI * distance / 12.0 / (2.0 * PI * PI * 3.0);
            let expected = part * points.len() as f64;
            for sector in &counts {
                let count = sector[shell as usize][half];
                chi_square += (count - expected) * (count - expected) / expected;
            }
        }
    }
    // 96 bins: mean 95, standard deviation 13.8; the polyhedron's outer shell is 0.3 % smaller.
    assert!((40.0..165.0).contains(&chi_square), "{chi_square}");
}

#[test]
fn an_inverted_mesh_works_and_is_said() {
    let outward = ball(DVec3::ZERO, 2.0, 24, 32);
    let (out, inverted) = (envelope(&outward), envelope(&inside_out(outward)));
    assert_ne!(out.report().inverted, inverted.report().inverted);
    assert!((out.report().volume_m3 - inverted.report().volume_m3).abs() < 1e-9);
    for i in 0..2000 {
        let p = in_box(Key::new(3).child(i), DVec3::new(-2.5, -0.5, -2.5), DVec3::new(2.5, 4.5, 2.5));
        assert_eq!(out.contains(p), inverted.contains(p));
        let q = inverted.sample(Key::new(4).child(i));
        assert!((q - DVec3::Y * 2.0).length() <= 2.0 + 1e-9);
    }
    let warned = [&out, &inverted].map(|e| e.report().warnings().iter().any(|w| w.contains("inward")));
    assert!(warned[0] != warned[1]);
}

#[test]
fn a_hole_is_closed_by_the_half_rule() {
    let mut mesh = ball(DVec3::ZERO, 2.0, 24, 32);
    let whole = envelope(&mesh).report().volume_m3;
    // Takes off the polar cap: the top two rings of triangles.
    mesh.triangles.retain(|t| t.iter().all(|&v| mesh.positions[v as usize].y < 1.9));
    let open = envelope(&mesh);
    let report = open.report();
    assert!(!report.closed);
    assert_eq!(report.boundary_edges, 32);
    assert!(report.warnings()[0].contains("open at 32 edges"), "{:?}", report.warnings());
    assert!((report.volume_m3 / whole - 1.0).abs() < 0.05, "{} of {whole}", report.volume_m3);
    for p in scatter(&open, 5000, Key::new(5), &Quiet).unwrap() {
        assert!((p - DVec3::Y * 2.0).length() < 2.01, "{p}");
    }
}

#[test]
fn an_open_bowl_is_a_crown() {
    let mut mesh = ball(DVec3::ZERO, 2.0, 24, 32);
    mesh.triangles.retain(|t| t.iter().all(|&v| mesh.positions[v as usize].y < 0.01));
    let bowl = envelope(&mesh);
    assert!(!bowl.report().closed);
    assert!(bowl.contains(DVec3::new(0.0, 1.0, 0.0)) && !bowl.contains(DVec3::new(0.0, 3.0, 0.0)));
}

#[test]
fn cavities_stay_empty_and_parts_count() {
    let (shell, hole) = (ball(DVec3::ZERO, 2.0, 24, 32), inside_out(ball(DVec3::ZERO, 1.0, 24, 32)));
    let hollow = envelope(&together(shell.clone(), &hole));
    assert!(hollow.report().closed);
    assert_eq!(hollow.report().components, 2);
    for p in scatter(&hollow, 3000, Key::new(6), &Quiet).unwrap() {
        assert!((p - DVec3::Y * 2.0).length() > 0.97, "{p}");
    }
    assert!((hollow.report().volume_m3 / (4.0 / 3.0 * PI * 7.0) - 1.0).abs() < 0.04);
    // Two bodies that look different ways are both solid.
    let far = inside_out(ball(DVec3::new(5.0, 0.0, 0.0), 1.0, 24, 32));
    let two = envelope(&together(shell, &far));
    let at = |p: DVec3| two.contains(p - two.foot());
    assert!(at(DVec3::ZERO) && at(DVec3::new(5.0, 0.0, 0.0)) && !at(DVec3::new(3.0, 0.0, 0.0)));
}

#[test]
fn the_base_centre_becomes_the_origin() {
    let centre = DVec3::new(446_000.0, 120.0, -5_400_000.0);
    let far = envelope(&ball(centre, 2.0, 24, 32));
    assert!((far.foot() - (centre - DVec3::Y * 2.0)).length() < 1e-6);
    let bounds = far.bounds();
    assert!(
        (bounds.max.y - 4.0).abs() < 1e-4 && bounds.min.y.abs() < 1e-4 && (bounds.max.x - 2.0).abs() < 0.02
    );
    assert!(far.contains(DVec3::new(0.0, 0.1, 0.0)) && !far.contains(DVec3::new(0.0, 4.1, 0.0)));
    let outline = far.outline();
    assert!(outline.iter().map(Vec::len).sum::<usize>() > 100);
    for p in outline.iter().flatten() {
        assert!(((p.as_dvec3() - DVec3::Y * 2.0).length() - 2.0).abs() < 0.05, "{p}");
    }
}

#[test]
fn what_encloses_nothing_is_refused_at_once() {
    let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.0, 1.0), DVec3::Z];
    let sheet = TriangleMesh { positions: square.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
    let mut bent = sheet.clone();
    bent.positions[1].y = 0.1;
    let mut doubled = bent.clone();
    doubled.triangles.extend([[2, 1, 0], [3, 2, 0]]);
    let point = TriangleMesh { positions: vec![DVec3::ONE; 3], triangles: vec![[0, 1, 2]] };
    let mut folded = sheet.clone();
    folded.positions[1].y = 0.9;
    for mesh in [sheet, bent, folded, doubled, point, TriangleMesh::default()] {
        let error = Envelope::new(&mesh, &Quiet).err().unwrap();
        assert!(matches!(error, EnvelopeError::NothingEnclosed { .. }), "{error}");
    }
}

#[test]
fn broken_meshes_are_refused() {
    let mut mesh = ball(DVec3::ZERO, 1.0, 6, 8);
    mesh.triangles[3][1] = 1_000_000;
    assert_eq!(Envelope::new(&mesh, &Quiet).err(), Some(EnvelopeError::Broken { triangle: 3 }));
    mesh.triangles[3][1] = 0;
    mesh.positions[0].z = f64::NAN;
    assert!(matches!(Envelope::new(&mesh, &Quiet).err(), Some(EnvelopeError::Broken { .. })));
}

#[test]
fn points_do_not_depend_on_threads() {
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let torus = envelope(&torus(60, 30));
            (scatter(&torus, 4000, Key::new(7), &Quiet).unwrap(), torus.report())
        })
    };
    assert_eq!(draw(1), draw(4));
}

/// The tree that grows in a mesh, as a command line grows it.
fn grown_in(mesh: TriangleMesh, knobs: &[(&str, &str)]) -> Grown {
    let mut preset =
        Preset::of("mine", linden::preset::Colonization::of(Space::Envelope { file: "mine.obj".into() }));
    for (knob, value) in knobs {
        preset.set(knob, value).unwrap();
    }
    let mut recipe = Recipe::new(preset);
    let geometry = Geometry::Mesh(Arc::new(mesh));
    recipe.inputs.insert("mine.obj", Input { hash: 0, up: Up::Y, geometry });
    grow(&recipe, &Quiet).unwrap()
}

/// Where its stems stand.
fn feet(grown: &Grown) -> Vec<DVec3> {
    let Skeleton { positions, parents, .. } = &*grown.skeleton;
    let roots = positions.iter().zip(parents).filter(|(_, parent)| **parent == NO_PARENT);
    roots.map(|(p, _)| p.as_dvec3()).collect()
}

#[test]
fn shells_that_stand_apart_are_told_from_crowns_of_several_balls() {
    let count = |mesh: &TriangleMesh| envelope(mesh).shells(&Quiet).unwrap().len();
    let at = |x: f64, y: f64, radius| ball(DVec3::new(x, y, 0.0), radius, 24, 32);
    let apart = together(at(0.0, 3.0, 2.0), &at(5.0, 3.0, 2.0));
    assert_eq!(count(&apart), 2);
    // The middle one holds the others together, whatever their order in the file.
    assert_eq!(count(&together(apart.clone(), &at(2.5, 3.0, 1.0))), 1);
    assert_eq!(count(&together(at(2.5, 3.0, 1.0), &apart)), 1);
    // A cavity, the same ball twice as thick, and a ball in a ball beside another.
    assert_eq!(count(&together(at(0.0, 3.0, 2.0), &inside_out(at(0.0, 3.0, 1.0)))), 1);
    assert_eq!(count(&together(at(0.0, 3.0, 2.0), &at(0.0, 3.0, 1.0))), 1);
    assert_eq!(count(&together(apart.clone(), &inside_out(at(5.0, 3.0, 1.0)))), 2);
    // Boxes that meet, balls that do not.
    assert_eq!(count(&together(at(0.0, 3.0, 2.0), &at(3.0, 6.0, 2.0))), 2);
    // In order of the file, each with the middle of its underside and its volume.
    let shells = envelope(&apart).shells(&Quiet).unwrap();
    for (shell, x) in shells.iter().zip([-2.5, 2.5]) {
        let below = shell.entry(&Quiet).unwrap().below;
        assert!((below - DVec3::X * x).length() < 0.02, "{below}");
        assert!((shell.volume_m3() / (4.0 / 3.0 * PI * 8.0) - 1.0).abs() < 0.03);
        assert!(shell.contains(DVec3::new(x, 2.0, 0.0)) && !shell.contains(DVec3::new(-x, 2.0, 0.0)));
    }
    // One that is open has no inside.
    let mut open = apart;
    open.triangles.pop();
    assert_eq!(count(&open), 0);
}

#[test]
fn each_shell_of_a_mesh_is_a_tree_with_a_root_below_it() {
    let at = |x: f64, y: f64, radius| ball(DVec3::new(x, y, 1.0), radius, 24, 32);
    // The first hangs 1 m over the ground, the second 2 m, the third stands on it.
    let mesh = together(together(at(-7.0, 3.0, 2.0), &at(0.0, 4.5, 2.5)), &at(8.0, 2.0, 2.0));
    let grown = grown_in(mesh.clone(), &[("points", "600")]);
    let mut found = feet(&grown);
    found.sort_by(|a, b| a.x.total_cmp(&b.x));
    let below = [-7.0, 0.0, 8.0].map(|x| DVec3::new(x, 0.0, 1.0));
    assert_eq!(found.len(), 3);
    for (foot, below) in found.iter().zip(below) {
        assert!((*foot - below).length() < 0.05, "{foot} {below}");
    }
    let colonized = grown.colonized.as_ref().unwrap();
    assert_eq!(colonized.points.len(), 1800, "for each tree as many as for one");
    assert!(colonized.unreached * 100 < colonized.points.len(), "{} not reached", colonized.unreached);
    assert!(grown.notes.iter().any(|note| note.contains("3 shells that stand apart")), "{:?}", grown.notes);
    assert!(!grown.notes.iter().any(|note| note.contains("raise influence")), "{:?}", grown.notes);

    // One place that is given is one tree, as it was.
    let one = grown_in(mesh.clone(), &[("points", "600"), ("root", "0,0,1"), ("influence", "inf")]);
    assert_eq!((feet(&one).len(), one.colonized.unwrap().points.len()), (1, 600));
    // A crumb too small for points bears no tree, and that is said.
    let crumbs = grown_in(together(mesh, &at(20.0, 1.0, 0.1)), &[("points", "600")]);
    assert_eq!(feet(&crumbs).len(), 3);
    assert!(
        crumbs.notes.iter().any(|note| note.contains("1 of the envelope's 4 shells")),
        "{:?}",
        crumbs.notes
    );
}
