//! Features against geometry: what a formula or the bare tube says.

use std::f64::consts::PI;

use glam::Vec3;

use super::tests::{gnarled, tree, volume};
use super::*;
use linden_base::monitor::Quiet;
use linden_skeleton::{NO_PARENT, Wood};

pub(super) const ALL: Features = Features {
    flare: 1.0,
    flare_height_m: None,
    flare_ridges: 5,
    flare_depth: 0.8,
    flare_smallest_m: 0.0,
    foot_depth: 0.0,
    foot_height_m: 0.0,
    ground_slope_deg: 0.0,
    lobes: 7,
    lobe_depth: 0.2,
    roots: SurfaceRoots { count: 5, reach: 4.0, rise: 0.5, smallest_m: 0.0 },
    stubs: Stubs { per_m: 2.0, length_m: 0.1, smallest_m: 0.0 },
    collar: 0.8,
    twig_taper: 0.9,
    ends: Ends::Broken,
    ends_above_m: 0.0,
};

fn with(features: Features) -> Tubes {
    Tubes { features, ..Tubes::default() }
}

/// A pole of 4 m, 0.1 m thick all along.
fn pole() -> Skeleton {
    let wood = Wood { tip_radius_m: Some(0.1), ..Wood::default() };
    tree(vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 4.0], vec![NO_PARENT, 0, 1], &wood)
}

/// Seen from all around, nothing of the foot is above the ground, and it ends level; what is counted begins at the ground.
#[test]
fn a_leaning_stem_goes_on_into_the_ground() {
    let wood = Wood { tip_radius_m: Some(0.3), ..Wood::default() };
    for lean_deg in [0.0_f32, 5.0, 20.0, 40.0] {
        let (sin, cos) = libm::sincosf(lean_deg.to_radians());
        let along = Vec3::new(sin, cos, 0.0);
        let skeleton = tree(vec![Vec3::ZERO, along, along * 5.0], vec![NO_PARENT, 0, 1], &wood);
        for flare in [0.0, 0.5] {
            let tubes = with(Features { flare, flare_ridges: 5, flare_depth: 0.6, ..Features::default() });
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default(), "{lean_deg} {flare}");
            let base: Vec<Vec3> = mesh
                .positions
                .iter()
                .zip(&mesh.normals)
                .filter(|(_, normal)| normal.y < -0.99)
                .map(|(place, _)| *place)
                .collect();
            assert!(base.len() > 5 && base.iter().all(|at| at.y < 1e-6), "{lean_deg} {flare}: {base:?}");
            let low = base.iter().map(|at| at.y).fold(0.0, f32::min);
            assert!(
                base.iter().all(|at| (at.y - low).abs() < 1e-5) && low > -0.3,
                "{lean_deg} {flare}: {low}"
            );
            assert_eq!(low < -0.01, lean_deg > 0.0);
            // All around it there is wall from there up to above the ground.
            let turn = |at: &Vec3| libm::atan2f(at.z, at.x).to_degrees();
            let seen: Vec<&Vec3> = mesh.positions.iter().filter(|at| at.y < 1.2).collect();
            for sector in (-180..180).step_by(90).map(|from| from as f32..from as f32 + 90.0) {
                let at = || seen.iter().filter(|at| sector.contains(&turn(at)));
                assert!(at().any(|at| at.y <= 1e-6) && at().any(|at| at.y > 0.0), "{lean_deg} {sector:?}");
            }
        }
        let drawn = |skeleton: &Skeleton| {
            let mut length_m = 0.0;
            survey_by(
                skeleton,
                &Tubes::default(),
                &|stretch| stretch.length_m,
                &mut |l: f64| length_m += l,
                &Quiet,
            )
            .unwrap();
            length_m
        };
        let upright = drawn(&tree(vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 5.0], vec![NO_PARENT, 0, 1], &wood));
        assert!((drawn(&skeleton) - upright).abs() < 1e-4, "{lean_deg}");
    }
}

/// What stands at a slope of which the tangent is the depth shows no gap on the lower side, and nothing above the ground changes.
#[test]
fn a_foot_goes_on_into_the_ground_as_deep_as_asked() {
    let wood = Wood { tip_radius_m: Some(0.3), ..Wood::default() };
    for lean_deg in [0.0_f32, 5.0, 20.0] {
        let (sin, cos) = libm::sincosf(lean_deg.to_radians());
        let along = Vec3::new(sin, cos, 0.0);
        let skeleton = tree(vec![Vec3::ZERO, along, along * 5.0], vec![NO_PARENT, 0, 1], &wood);
        for flare_ridges in [0, 5] {
            let features = Features { flare: 0.5, flare_ridges, ..Features::default() };
            let sunk = |foot_depth: f32| {
                let tubes = with(Features { foot_depth, ..features });
                let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
                assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
                assert_eq!(mesh.positions.len(), count(&skeleton, &tubes, &Quiet).unwrap()[0].vertices);
                mesh
            };
            let low = |mesh: &Mesh| mesh.positions.iter().map(|at| at.y).fold(0.0, f32::min);
            let foot_m = 1.5 * 0.3;
            for depth in [0.5, 2.0] {
                let found = low(&sunk(depth));
                assert!((found + depth * foot_m).abs() < 1e-4, "{lean_deg} {flare_ridges}: {found}");
            }
            // One that leans is closed all around, however shallow it is to be.
            assert!(low(&sunk(1e-3)) <= low(&sunk(0.0)) + 1e-6);
            // Above the ground it is the same.
            let above = |mesh: &Mesh| -> Vec<Vec3> {
                mesh.positions.iter().copied().filter(|at| at.y > 0.4).collect()
            };
            let [shallow, deep] = [0.5, 2.0].map(|depth| above(&sunk(depth)));
            assert!(shallow.len() > 20 && shallow.len() == deep.len());
            assert!(shallow.iter().zip(&deep).all(|(a, b)| a.distance(*b) < 1e-5));
        }
    }
}

/// As coordinates tell: where a ring stands twice, bark breaks off. From one thickness to half of it, it does so once.
#[test]
fn bark_keeps_its_pictures_along_a_stem() {
    let wood = Wood { width: linden_skeleton::Width::Grammar, ..Wood::default() };
    let count = 40;
    let at = |i: usize| Vec3::Y * (0.25 * i as f32);
    let branching = linden_skeleton::Branching {
        positions: (0..count).map(at).collect(),
        parents: (0..count as u32).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect(),
        births: vec![0; count],
        radii: Some((0..count).map(|i| 0.4 - 0.25 * i as f32 / count as f32).collect()),
        edges: None,
    };
    let skeleton = Skeleton::build(branching, &wood).unwrap();
    let tubes = Tubes { bark_tile_m: 0.5, sides: 16, ..Tubes::default() };
    let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
    let mut pictures = std::collections::BTreeMap::new();
    for ((uv, at), normal) in mesh.uvs.iter().zip(&mesh.positions).zip(&mesh.normals) {
        if normal.y.abs() < 0.5 {
            let most: &mut f32 = pictures.entry((at.y * 1e3) as i64).or_default();
            *most = most.max(uv.x);
        }
    }
    let pictures: Vec<f32> = pictures.into_values().collect();
    let changes = pictures.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(pictures.len() >= count && pictures[0] == 5.0 && changes <= 1, "{pictures:?}");
}

#[test]
fn gnarled_wood_with_everything_stays_closed() {
    let (mut triangles, mut flipped) = (0, 0);
    for seed in 0..60 {
        let skeleton = gnarled(seed);
        let round = Features { lobes: 0, ..ALL };
        for tubes in [with(round), Tubes { rings: 3, ..with(Features { ends: Ends::Cut, ..round }) }] {
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            let found = topology(&mesh, &Quiet).unwrap();
            assert_eq!(Topology { flipped: 0, ..found }, Topology::default(), "seed {seed}");
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "seed {seed}");
            triangles += mesh.triangles.len();
            flipped += found.flipped;
        }
    }
    // The rest is where wood turns within its own thickness.
    assert!(flipped * 10_000 < triangles, "{flipped} of {triangles} triangles are folded");
}

/// Lobes reach farther out, so that more of them cross where wood turns within its own thickness.
#[test]
fn lobed_gnarled_wood_stays_closed() {
    let (mut triangles, mut flipped) = (0, 0);
    for seed in 0..20 {
        let mesh = sweep(&gnarled(seed), &with(ALL), &Quiet).unwrap();
        let found = topology(&mesh, &Quiet).unwrap();
        assert_eq!(Topology { flipped: 0, ..found }, Topology::default(), "seed {seed}");
        triangles += mesh.triangles.len();
        flipped += found.flipped;
    }
    assert!(flipped * 3_000 < triangles, "{flipped} of {triangles} triangles are folded");
}

/// Of a trunk that does not taper: what the formula says, all the way up.
#[test]
fn lobes_are_a_sine_round_the_stem() {
    let tubes = with(Features { lobes: 5, lobe_depth: 0.2, ..Features::default() });
    let mesh = sweep(&pole(), &tubes, &Quiet).unwrap();
    assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
    let radius = |p: &Vec3| libm::hypotf(p.x, p.z);
    let all = |y: f32| mesh.positions.iter().filter(move |p| (p.y - y).abs() < 1e-5 && radius(p) > 0.01);
    for y in [0.0, 1.0, 4.0] {
        let (least, most) = all(y).map(radius).fold((9.0_f32, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
        assert!((least - 0.08).abs() < 0.004 && (most - 0.12).abs() < 0.004, "{y}: {least} {most}");
    }
    // Twice as much as the squares of a sine of 0.2 have on average is the area's gain.
    let plain = sweep(&pole(), &with(Features::default()), &Quiet).unwrap();
    let gain = volume(&mesh) / volume(&plain);
    assert!((gain - 1.02).abs() < 0.02, "{gain}");
    let off = with(Features { lobes: 0, lobe_depth: 0.2, ..Features::default() });
    assert_eq!(sweep(&pole(), &off, &Quiet).unwrap().positions, plain.positions);
}

/// Of a trunk that does not taper, whatever its foot is like.
#[test]
fn a_flare_has_no_seam_of_pictures_round_it() {
    for flare in [0.5, 2.0] {
        let tubes = with(Features { flare, flare_ridges: 5, ..Features::default() });
        let tubes = Tubes { bark_tile_m: 0.1, ..tubes };
        let mesh = sweep(&pole(), &tubes, &Quiet).unwrap();
        // Rings close where the first one does: after as many pictures as go round the trunk.
        let wall = |i: &usize| mesh.normals[*i].y.abs() < 0.9 && mesh.positions[*i].y < 3.9;
        let most = (0..mesh.positions.len()).filter(wall).map(|i| mesh.uvs[i].x).fold(0.0, f32::max);
        assert_eq!(most, 6.0, "{flare}: 2 π · 0.1 m is six pictures of 0.1 m");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_features() {
    let skeleton = gnarled(7);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sweep(&skeleton, &with(ALL), &Quiet).unwrap())
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn a_survey_with_features_is_of_the_mesh() {
    let skeleton = gnarled(11);
    let mesh = sweep(&skeleton, &with(ALL), &Quiet).unwrap();
    let found = survey(&skeleton, &with(ALL), &mut |_| (), &Quiet).unwrap();
    assert_eq!((found.vertices, found.triangles), (mesh.positions.len(), mesh.triangles.len()));
    assert_eq!(found.bounds, mesh.bounds());
}

#[test]
fn a_cut_pole_is_a_prism_and_a_broken_one_is_longer() {
    let of = |ends| {
        let tubes = Tubes { sides: 16, ..with(Features { ends, ..Features::default() }) };
        sweep(&pole(), &tubes, &Quiet).unwrap()
    };
    let cut = of(Ends::Cut);
    assert!((volume(&cut) - 4.0 * PI * 0.01).abs() < 1e-6);
    assert_eq!(cut.bounds().unwrap().max.y, 4.0);
    let top = cut.positions.iter().zip(&cut.normals).filter(|(p, n)| p.y == 4.0 && n.y > 0.99);
    assert_eq!(top.count(), 16, "the cut has normals of its own");
    let broken = of(Ends::Broken);
    assert_eq!(topology(&broken, &Quiet).unwrap(), Topology::default());
    assert!(broken.bounds().unwrap().max.y > 4.1 && volume(&broken) > volume(&cut));
    let bud = Features { ends: Ends::Broken, ends_above_m: 0.2, ..Features::default() };
    assert_eq!(sweep(&pole(), &with(bud), &Quiet), sweep(&pole(), &Tubes::default(), &Quiet));
}

#[test]
fn a_foot_is_wider_by_its_flare_and_the_wood_above_stays() {
    let flared = Features { flare: 0.5, flare_height_m: Some(0.4), ..Features::default() };
    let mesh = sweep(&pole(), &with(flared), &Quiet).unwrap();
    // Of a polygon of 24 sides with the circle's area: 12 r² sin 15° = π.
    let corner = (std::f32::consts::PI / 12.0 / libm::sinf(std::f32::consts::PI / 12.0)).sqrt();
    for p in &mesh.positions {
        let radius = Vec3::new(p.x, 0.0, p.z).length() / corner;
        if p.y == 0.0 {
            assert!((radius - 0.15).abs() < 1e-6, "{radius}");
        } else if p.y > 0.4 && p.y <= 4.0 {
            assert!((radius - 0.1).abs() < 1e-6, "{radius} at {}", p.y);
        }
    }
    let ridged = Features { flare_ridges: 4, flare_depth: 0.6, ..flared };
    let mesh = sweep(&pole(), &with(ridged), &Quiet).unwrap();
    assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
    let foot: Vec<f32> = (mesh.positions.iter().zip(&mesh.normals))
        .filter(|(p, n)| p.y == 0.0 && n.y > -0.9)
        .map(|(p, _)| p.length())
        .collect();
    // Walking round the foot, the radius goes through its mean twice for each buttress.
    let mean = foot.iter().sum::<f32>() / foot.len() as f32;
    let crossings = foot.windows(2).filter(|pair| (pair[0] > mean) != (pair[1] > mean)).count();
    assert_eq!(crossings, 8);
}

/// Its surface is where the whole one is, within what may be left out, and it takes fewer triangles for it.
#[test]
fn a_foot_seen_from_afar_has_fewer_sides_and_the_same_shape() {
    let whole = Features {
        flare: 1.0,
        flare_height_m: Some(0.6),
        flare_ridges: 5,
        flare_depth: 0.6,
        ..Features::default()
    };
    let of = |smallest: f32| {
        let flared = Features { flare_smallest_m: smallest, ..whole };
        let mesh = sweep(&pole(), &with(flared), &Quiet).unwrap();
        assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
        mesh
    };
    let fine = of(0.0);
    let mut last = fine.triangles.len();
    for smallest in [0.003, 0.01, 0.03, 0.2] {
        let coarse = of(smallest);
        assert!(coarse.triangles.len() < last, "{smallest}: {} of {last}", coarse.triangles.len());
        last = coarse.triangles.len();
        for p in fine.positions.iter().filter(|p| p.y > 0.0 && p.y < 1.0) {
            let nearest = coarse.triangles.iter().map(|corners| {
                let [a, b, c] = corners.map(|i| coarse.positions[i as usize]);
                // Dense enough for what is measured here.
                let places =
                    (0..=12).flat_map(|i| (0..=12 - i).map(move |j| (i as f32 / 12.0, j as f32 / 12.0)));
                places
                    .map(|(u, v)| (a + (b - a) * u + (c - a) * v).distance(*p))
                    .fold(f32::INFINITY, f32::min)
            });
            let away = nearest.fold(f32::INFINITY, f32::min);
            assert!(away < 1.5 * smallest + 0.012, "{smallest}: {away} m at {p}");
        }
    }
    assert!(last < 24 * 2 * 9, "without buttresses: {last}");
}

/// A lateral at a right angle: in the plane of both axes the fillet is a quarter of a circle that
/// touches both cylinders.
#[test]
fn a_collar_is_a_quarter_circle_between_two_cylinders() {
    let branching = linden_skeleton::Branching {
        positions: vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::Y * 4.0, Vec3::new(2.0, 2.0, 0.0)],
        parents: vec![NO_PARENT, 0, 1, 1],
        births: vec![0; 4],
        radii: Some(vec![0.4, 0.4, 0.4, 0.1]),
        edges: None,
    };
    let skeleton = Skeleton::build(branching, &Wood::default()).unwrap();
    let collar = Features { collar: 0.5, ..Features::default() };
    let fillet = 0.5 * (0.1 * COLLAR_RADII);
    let mesh = sweep(&skeleton, &Tubes { sides: 64, ..with(collar) }, &Quiet).unwrap();
    let found = topology(&mesh, &Quiet).unwrap();
    assert!(found.watertight() && found.flipped < 4, "but for what lies inside the pole: {found:?}");
    // The lateral sets out upward, so the lower side is looked at, where it is near straight in the end.
    let mut checked = 0;
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        let outside = Vec3::new(p.x, 0.0, p.z).length() - 0.4;
        if outside <= 1e-4 || p.z.abs() > 0.01 {
            continue;
        }
        // Distances from both bare surfaces; along the course of the lateral, as its rings say.
        let course = mesh.positions.iter().filter(|q| (q.x - p.x).abs() < 0.012 && q.x > 0.41);
        let (low, high) = course.fold((9.0_f32, -9.0_f32), |(l, h), q| (l.min(q.y), h.max(q.y)));
        let wide = (high - low) / 2.0 - 0.1;
        if p.x > 1.9 {
            continue;
        }
        if outside > fillet * 1.3 {
            assert!(wide.abs() < 0.03, "{wide} at {outside}");
        } else if (p.y - low).abs() < 1e-3 && outside < fillet {
            let from_circle = ((fillet - wide).hypot(fillet - outside) - fillet).abs();
            assert!(from_circle < 0.25 * fillet, "{from_circle} at {outside}, {wide}");
            assert!(n.y < 0.0);
            checked += 1;
        }
    }
    assert!(checked > 3, "{checked}");
}

#[test]
fn twigs_taper_from_their_last_fork() {
    let half = Features { twig_taper: 0.5, ..Features::default() };
    let mesh = sweep(&pole(), &with(half), &Quiet).unwrap();
    let radius = |y: f32| {
        let at = mesh.positions.iter().filter(|p| p.y == y).map(|p| Vec3::new(p.x, 0.0, p.z).length());
        at.fold(0.0, f32::max)
    };
    // Corners stand a little farther out than the circle.
    assert!((1.0..1.02).contains(&(radius(0.0) / 0.1)) && (1.0..1.02).contains(&(radius(4.0) / 0.05)));
    assert!(radius(1.0) < 0.1 && radius(1.0) > 0.06);
}
