//! The solid against the tubes that it is made of.

use glam::DVec3;

use super::*;
use crate::surface::tests::{gnarled, tree, volume};
use crate::surface::{Features, Junction, Tubes, crowded_edges, survey, sweep, topology};
use linden_base::monitor::Quiet;
use linden_base::random::Key;
use linden_skeleton::{NO_PARENT, Skeleton, Wood};

fn watertight(junction_detail: u32) -> Tubes {
    Tubes { junction: Junction::Watertight, junction_detail, ..Tubes::default() }
}

fn cross() -> Skeleton {
    let wood = Wood { tip_radius_m: Some(0.2), base_radius_m: Some(0.2), ..Wood::default() };
    let places = [[0., 0., 0.], [0., 2., 0.], [0., 4., 0.], [2., 2.5, 0.3], [-1.5, 2.2, 0.4]];
    tree(places.map(glam::Vec3::from).to_vec(), vec![NO_PARENT, 0, 1, 1, 1], &wood)
}

/// Solid angles of all triangles (van Oosterom & Strackee 1983), in turns: how often a mesh goes round
/// a point.
fn winding(mesh: &Mesh, point: DVec3) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3() - point);
        let (x, y, z) = (a.length(), b.length(), c.length());
        let below = x * y * z + a.dot(b) * z + a.dot(c) * y + b.dot(c) * x;
        2.0 * libm::atan2(a.dot(b.cross(c)), below)
    };
    mesh.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn the_solid_holds_what_the_tubes_hold_and_nothing_is_inside_it() {
    let skeleton = cross();
    // Buds are round in one and pointed in the other; cuts are flat in both.
    let features = Features { ends: Ends::Cut, ..Features::default() };
    let solid = sweep(&skeleton, &Tubes { features, ..watertight(24) }, &Quiet).unwrap();
    let tubes = sweep(&skeleton, &Tubes { sides: 64, features, ..Tubes::default() }, &Quiet).unwrap();
    assert!(volume(&solid) < volume(&tubes), "what tubes share counts once");
    let bounds = tubes.bounds().unwrap();
    let (mut inside, mut checked) = (0, 0);
    for i in 0..600_u64 {
        let key = Key::new(i);
        let between =
            |axis: usize| key.child(axis as u64).between(bounds.min[axis].into(), bounds.max[axis].into());
        let node = skeleton.positions[1 + (i % 4) as usize].as_dvec3();
        let aside = DVec3::new(between(0), between(1), between(2)) * 0.15;
        let point = if i % 2 == 0 { DVec3::new(between(0), between(1), between(2)) } else { node + aside };
        // Round ends and corners of polygons: no nearer to the surface than a cell.
        let edge = solid.positions.iter().map(|p| p.as_dvec3().distance(point)).fold(9.0, f64::min);
        if edge < 0.05 {
            continue;
        }
        let (of_solid, of_tubes) = (winding(&solid, point), winding(&tubes, point));
        assert_eq!(of_solid > 0.5, of_tubes > 0.5, "{point}: {of_solid} {of_tubes}");
        assert!(of_solid.abs() < 0.01 || (of_solid - 1.0).abs() < 0.01, "{point}: {of_solid}");
        inside += usize::from(of_solid > 0.5);
        checked += 1;
    }
    assert!(inside > 20 && checked > 300, "{inside} of {checked}");
}

#[test]
fn a_pole_has_its_radius_and_its_flat_foot() {
    let wood = Wood { tip_radius_m: Some(0.1), base_radius_m: Some(0.1), ..Wood::default() };
    let pole = tree(vec![glam::Vec3::ZERO, glam::Vec3::Y * 2.0], vec![NO_PARENT, 0], &wood);
    let solid = sweep(&pole, &watertight(40), &Quiet).unwrap();
    let side = solid.positions.iter().filter(|p| p.y > 0.1 && p.y < 1.9);
    for p in side {
        assert!((glam::Vec3::new(p.x, 0.0, p.z).length() - 0.1).abs() < 4e-4, "{p}");
    }
    let expected = std::f64::consts::PI * 0.01 * (2.0 + 0.1 * 2.0 / 3.0);
    assert!((volume(&solid) / expected - 1.0).abs() < 0.01, "{} is not {expected}", volume(&solid));
    let found = topology(&solid, &Quiet).unwrap();
    assert!(found.watertight() && found.flipped == 0, "{found:?}");
}

/// However close its rings are: each is the middle of a ball that would bulge below it.
#[test]
fn a_flared_foot_is_flat_too() {
    let wood = Wood { tip_radius_m: Some(0.1), base_radius_m: Some(0.1), ..Wood::default() };
    let pole = tree(vec![glam::Vec3::ZERO, glam::Vec3::Y * 2.0], vec![NO_PARENT, 0], &wood);
    let features = Features { flare: 0.6, ..Features::default() };
    let solid = sweep(&pole, &Tubes { features, ..watertight(40) }, &Quiet).unwrap();
    assert!(solid.positions.iter().all(|p| p.y > -0.002));
    let foot = solid.positions.iter().filter(|p| p.y < 0.002).map(|p| p.with_y(0.0).length());
    assert!((foot.fold(0.0, f32::max) / 0.16 - 1.0).abs() < 0.05);
}

#[test]
fn gnarled_wood_becomes_one_solid_on_any_number_of_threads() {
    let features = Features { collar: 0.7, flare: 0.8, flare_ridges: 5, ..Features::default() };
    for seed in 0..3 {
        let skeleton = gnarled(seed);
        // Coarse, so that every cell is torn.
        for detail in [6, 13] {
            for features in [Features::default(), features] {
                let tubes = Tubes { features, ..watertight(detail) };
                let on = |threads| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    pool.install(|| sweep(&skeleton, &tubes, &Quiet).unwrap())
                };
                let solid = on(1);
                assert_eq!(solid, on(2), "seed {seed}");
                assert!(topology(&solid, &Quiet).unwrap().watertight(), "seed {seed}");
                assert_eq!(crowded_edges(&solid, &Quiet), Ok(0), "seed {seed}");
                assert!(volume(&solid) > 0.0);
            }
        }
    }
}

#[test]
fn too_fine_a_solid_is_refused_before_work_begins() {
    let poles: Vec<glam::Vec3> = (0..3000).map(|i| glam::Vec3::Y * i as f32).collect();
    let parents = (0..3000_u32).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect();
    let pole = tree(poles, parents, &Wood { tip_radius_m: Some(0.1), ..Wood::default() });
    let refused = survey(&pole, &watertight(256), &mut |_| (), &Quiet).unwrap_err();
    assert!(matches!(refused, SurfaceError::TooFine { .. }), "{refused}");
    assert!(refused.to_string().contains("junction_detail"), "{refused}");
}
