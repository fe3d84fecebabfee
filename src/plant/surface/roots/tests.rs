//! Roots against what a foot, the ground and the skeleton say.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::super::plan::{Course, Plan};
use super::super::tests::{tree, volume};
use super::super::{
    Features, Junction, SurfaceRoots, Topology, Tubes, count, crowded_edges, sweep, topology,
};
use super::*;
use linden_base::monitor::Quiet;
use linden_skeleton::{Skeleton, Wood};

const RADIUS_M: f32 = 0.3;

fn tubes(roots: u32, ridges: u32) -> Tubes {
    let roots = SurfaceRoots { count: roots, ..SurfaceRoots::default() };
    let features = Features { flare: 0.5, flare_ridges: ridges, roots, ..Features::default() };
    Tubes { sides: 48, features, ..Tubes::default() }
}

/// Stems of 8 m at places, in radii of the first.
fn stems(places: &[(f32, f32)], nodes: u32) -> Skeleton {
    let (mut positions, mut parents) = (Vec::new(), Vec::new());
    for &(x, scale) in places {
        let first = positions.len() as u32;
        positions.extend((0..=nodes).map(|i| Vec3::new(x, 8.0 * scale * i as f32 / nodes as f32, 0.0)));
        parents.extend((0..=nodes).map(|i| if i == 0 { NO_PARENT } else { first + i - 1 }));
    }
    tree(positions, parents, &Wood { tip_radius_m: Some(RADIUS_M.into()), ..Wood::default() })
}

/// The rings of all roots.
fn roots(skeleton: &Skeleton, tubes: &Tubes) -> Vec<Vec<Ring>> {
    let course = Course::new(skeleton, tubes);
    let plan = Plan::new(&course, 0..skeleton.axes.len());
    plan.axes().filter(|(_, form)| form.root.is_some()).map(|(rings, _)| rings.to_vec()).collect()
}

#[test]
fn they_begin_within_the_trunk_and_end_in_the_ground() {
    let pole = stems(&[(0.0, 1.0)], 16);
    for count in [1, 3, 5, 8, 12, 24] {
        for (rise, reach) in [(0.0, 3.0), (0.5, 6.0), (1.0, 18.0)] {
            let mut tubes = tubes(count, 5);
            tubes.features.roots = SurfaceRoots { reach, rise, ..tubes.features.roots };
            let found = roots(&pole, &tubes);
            let out_of_trunk = |rings: &&Vec<Ring>| flat(rings[0].center).length() < 1.5 * RADIUS_M;
            assert_eq!(found.iter().filter(out_of_trunk).count(), count as usize);
            for rings in &found {
                let [first, last] = [rings.first(), rings.last()].map(Option::unwrap);
                // A fork begins within its root, whose middle is this one's.
                let is_fork = flat(first.center).length() >= 1.5 * RADIUS_M;
                if is_fork {
                    let away = |other: &Ring| other.center.distance(first.center);
                    let others = found.iter().filter(|other| other[0].center != first.center).flatten();
                    assert!(others.map(away).fold(f32::INFINITY, f32::min) < first.radius);
                }
                assert!(last.center.y + 2.0 * last.radius < 0.0, "{count} {rise}: ends at {}", last.center.y);
                assert!(last.radius < 0.4 * rings[rings.len() / 2].radius.max(first.radius));
            }
            // Something of them is seen beyond the flare, and nothing is far beyond their reach.
            let seen = found.iter().flatten().filter(|ring| ring.center.y + 0.8 * ring.radius > 0.0);
            let farthest = seen.map(|ring| flat(ring.center).length()).fold(0.0, f32::max);
            assert!(farthest > 1.6 * RADIUS_M && farthest < 1.3 * reach.max(5.0) * RADIUS_M, "{farthest}");
        }
    }
}

#[test]
fn they_are_closed_and_the_trunk_stays_as_it_is() {
    for nodes in [1, 16] {
        for ridges in [0, 5] {
            let pole = stems(&[(0.0, 1.0)], nodes);
            let (bare, rooted) = (tubes(0, ridges), tubes(7, ridges));
            let [without, with] = [bare, rooted].map(|tubes| sweep(&pole, &tubes, &Quiet).unwrap());
            assert_eq!(topology(&with, &Quiet).unwrap(), Topology::default(), "{nodes} {ridges}");
            assert!(with.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
            assert_eq!(with.positions[..without.positions.len()], without.positions);
            assert_eq!(with.triangles[..without.triangles.len()], without.triangles);
            let counted = count(&pole, &rooted, &Quiet).unwrap();
            assert_eq!(counted[0].vertices, with.positions.len());
            assert_eq!(counted[0].vertices - counted[0].roots[0], without.positions.len());
            assert_eq!(counted[0].triangles - counted[0].roots[1], without.triangles.len());
        }
    }
}

/// Where buttresses are, the mesh of the trunk alone says.
#[test]
fn they_continue_the_buttresses() {
    let pole = stems(&[(0.0, 1.0)], 16);
    let foot = sweep(&pole, &tubes(0, 5), &Quiet).unwrap();
    let angle = |place: Vec3| libm::atan2f(-place.z, place.x);
    let mut rim: Vec<(f32, f32)> = foot
        .positions
        .iter()
        .filter(|place| place.y == 0.0 && flat(**place).length() > 0.0)
        .map(|&place| (angle(place), flat(place).length()))
        .collect();
    rim.sort_by(|a, b| a.0.total_cmp(&b.0));
    rim.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-4);
    let n = rim.len();
    let crests: Vec<f32> = (0..n)
        .filter(|&i| rim[i].1 > rim[(i + 1) % n].1 && rim[i].1 >= rim[(i + n - 1) % n].1)
        .map(|i| rim[i].0)
        .collect();
    assert_eq!(crests.len(), 5);
    let found = roots(&pole, &tubes(5, 5));
    let leave: Vec<f32> = found
        .iter()
        .filter(|rings| flat(rings[0].center).length() < 1.5 * RADIUS_M)
        .map(|rings| angle(rings[1].center))
        .collect();
    for crest in crests {
        let nearest = leave.iter().map(|&angle| turn(angle, crest).abs()).fold(PI, f32::min);
        assert!(nearest < TAU / n as f32, "{nearest} from the crest at {crest}");
    }
}

#[test]
fn a_fillet_leaves_no_crease_between_root_and_trunk() {
    let pole = stems(&[(0.0, 1.0)], 16);
    let tubes = tubes(5, 5);
    let (with, counted) = (sweep(&pole, &tubes, &Quiet).unwrap(), count(&pole, &tubes, &Quiet).unwrap());
    let course = Course::new(&pole, &tubes);
    let plan = Plan::new(&course, 0..1);
    let (stem, form) = plan.axes().next().unwrap();
    let host = Host { rings: stem.to_vec(), flare: form.flare };
    // On the bark of the trunk, over the ground: there the root looks where the trunk does.
    let (mut checked, mut off) = (0, 0);
    for vertex in with.positions.len() - counted[0].roots[0]..with.positions.len() {
        let (place, normal) = (with.positions[vertex], with.normals[vertex]);
        let (distance, trunks) = host.near(place);
        if place.y > 0.02 && distance.abs() < 0.01 * RADIUS_M {
            checked += 1;
            off += usize::from(normal.dot(trunks) < 0.85);
        }
    }
    assert!(checked > 40 && off * 10 < checked, "{off} of {checked}");
}

#[test]
fn levels_of_detail_drop_the_thin_ones_first() {
    let pole = stems(&[(0.0, 1.0)], 16);
    let mut before = usize::MAX;
    let mut seen = Vec::new();
    for smallest in 0..=30 {
        let mut tubes = tubes(7, 5);
        tubes.features.roots.smallest_m = smallest as f32 * 0.02 * RADIUS_M;
        let now = roots(&pole, &tubes).len();
        assert!(now <= before);
        before = now;
        seen.push(now);
    }
    seen.dedup();
    // Not all at once.
    assert!(seen[0] >= 7 && seen.len() > 3 && seen.last() == Some(&0), "{seen:?}");
}

#[test]
fn a_level_has_the_roots_of_the_tree() {
    let ways = |nodes: u32| -> Vec<Vec3> {
        let found = roots(&stems(&[(0.0, 1.0)], nodes), &tubes(6, 0));
        found.iter().map(|rings| (rings[rings.len() - 1].center - rings[0].center).normalize()).collect()
    };
    let (all, few) = (ways(16), ways(2));
    assert_eq!(all.len(), few.len());
    assert!(all.iter().zip(&few).all(|(a, b)| a.dot(*b) > 0.99), "{all:?} {few:?}");
}

#[test]
fn stems_of_one_stool_share_the_roots_of_the_thickest_and_others_keep_clear() {
    let tubes = tubes(6, 0);
    let from = |skeleton: &Skeleton, x: f32| {
        let near = |rings: &&Vec<Ring>| (rings[0].center.x - x).abs() < 1.5 * RADIUS_M;
        roots(skeleton, &tubes).iter().filter(near).count()
    };
    let stool = stems(&[(0.0, 1.0), (0.4, 1.0)], 8);
    let lone = stems(&[(0.0, 1.0)], 8);
    assert_eq!(roots(&stool, &tubes).len(), roots(&lone, &tubes).len());
    let far = stems(&[(0.0, 1.0), (20.0, 1.0)], 8);
    assert!([0.0, 20.0].into_iter().all(|x| from(&far, x) >= 6));
    // Between two that are near none runs into the other.
    let near = stems(&[(0.0, 1.0), (1.2, 1.0)], 8);
    let other = Vec3::X * 1.2;
    let own = roots(&near, &tubes);
    let own = own.iter().filter(|rings| rings[0].center.x < 0.6).flatten();
    assert!(own.map(|ring| flat(ring.center - other).length()).fold(f32::INFINITY, f32::min) > RADIUS_M);
}

/// What is over the ground on level ground is over it on a slope, as far: all along each root.
#[test]
fn on_a_slope_they_lie_as_they_do_on_level_ground() {
    let pole = stems(&[(0.0, 1.0)], 16);
    let level = roots(&pole, &tubes(7, 5));
    for slope_deg in [-20.0, 15.0, 35.0_f32] {
        let mut tubes = tubes(7, 5);
        tubes.features.ground_slope_deg = slope_deg;
        let fall = libm::tanf(slope_deg.to_radians());
        let sloping = roots(&pole, &tubes);
        assert_eq!(sloping.len(), level.len());
        for (flat_ones, ones) in level.iter().zip(&sloping) {
            let over = |rings: &[Ring], fall: f32| -> Vec<f32> {
                rings.iter().map(|ring| ring.center.y + fall * ring.center.x + ring.radius).collect()
            };
            let most = |heights: Vec<f32>| heights.into_iter().skip(8).fold(f32::NEG_INFINITY, f32::max);
            let (expected, found) = (most(over(flat_ones, 0.0)), most(over(ones, fall)));
            assert!((found - expected).abs() < 0.25 * RADIUS_M, "{slope_deg}: {found} for {expected}");
            let last = ones.last().unwrap();
            assert!(last.center.y + fall * last.center.x + last.radius < 0.0, "{slope_deg}");
        }
        // The foot has no gap below, on the lower side.
        let mesh = sweep(&pole, &tubes, &Quiet).unwrap();
        assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
        let low = mesh.positions.iter().filter(|at| flat(**at).length() < 1.6 * RADIUS_M);
        let low = low.map(|at| at.y).fold(0.0, f32::min);
        assert!(low <= -1.5 * RADIUS_M * fall.abs(), "{slope_deg}: {low}");
    }
}

#[test]
fn a_stem_that_lies_down_has_none() {
    let positions = vec![Vec3::ZERO, Vec3::new(4.0, 0.3, 0.0)];
    let wood = Wood { tip_radius_m: Some(RADIUS_M.into()), ..Wood::default() };
    assert!(roots(&tree(positions, vec![NO_PARENT, 0], &wood), &tubes(6, 0)).is_empty());
}

#[test]
fn they_are_part_of_the_solid() {
    let pole = stems(&[(0.0, 0.4)], 4);
    let solid = |roots: u32| {
        let tubes = Tubes { junction: Junction::Watertight, junction_detail: 48, ..tubes(roots, 5) };
        sweep(&pole, &tubes, &Quiet).unwrap()
    };
    let [bare, rooted] = [0, 6].map(solid);
    let found = topology(&rooted, &Quiet).unwrap();
    assert!(found.watertight() && crowded_edges(&rooted, &Quiet).unwrap() == 0, "{found:?}");
    let lowest = |mesh: &linden_base::mesh::Mesh| mesh.positions.iter().map(|p| p.y).fold(0.0, f32::min);
    assert!(lowest(&bare) > -0.01 && lowest(&rooted) < -0.02, "{} {}", lowest(&bare), lowest(&rooted));
    assert!(volume(&rooted) > 1.02 * volume(&bare));
}
