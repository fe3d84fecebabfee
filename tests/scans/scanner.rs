//! What the scanner promises, by brute force over all triangles.

use linden::grow::{Grown, grow};
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scanner::rays::{Rays, meet};
use linden::scanner::stand::{Grid, Stand};
use linden::scanner::{Scan, ScannerSettings, Target, WhatIsHit, laz, ply, scan};
use linden::stage::Place;
use linden::{DVec3, Quiet, Vec3};
use linden_tests::presets::recipe;

/// A small tree with leaves.
fn small() -> (Recipe, Grown) {
    let mut recipe = recipe(builtin("dressed-simple").unwrap());
    for (knob, value) in [("points", "60"), ("seed", "3")] {
        recipe.preset.set(knob, value).unwrap();
    }
    let grown = grow(&recipe, &Quiet).unwrap();
    (recipe, grown)
}

fn target(leaves: bool) -> Target {
    let (recipe, grown) = small();
    let mut target = Target::default();
    target.add(&grown, &recipe.preset.dressing.tubes, leaves, &Quiet).unwrap();
    target
}

/// Without any error, and coarse.
fn exact() -> ScannerSettings {
    let mut settings = ScannerSettings::default();
    (settings.positions, settings.step_deg) = (2, 0.8);
    (settings.noise_m, settings.beam_rad, settings.registration_m) = (0.0, 0.0, 0.0);
    settings
}

/// Of all triangles, the nearest that a ray meets.
fn nearest(target: &Target, origin: DVec3, direction: DVec3) -> Option<(f64, usize)> {
    let met = (0..)
        .zip(&target.triangles)
        .filter_map(|(index, corners)| Some((meet(origin, direction, corners.map(Vec3::as_dvec3))?, index)));
    met.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How far a point is from a triangle (Ericson 2005, *Real-Time Collision Detection*, 5.1.5).
fn distance(p: DVec3, corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let segment = |a: DVec3, b: DVec3| {
        let along = b - a;
        let t = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.distance(a + along * t)
    };
    let normal = (b - a).cross(c - a);
    let is_within =
        [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(p - *from).dot(normal) >= 0.0);
    if is_within && normal != DVec3::ZERO {
        return (p - a).dot(normal.normalize()).abs();
    }
    segment(a, b).min(segment(b, c)).min(segment(c, a))
}

#[test]
fn the_first_hit_is_the_nearest_of_all_triangles() {
    let target = target(true);
    let settings = exact();
    let stands = Stand::of(&target, &settings, linden::random::Key::new(5)).unwrap();
    let rays = Rays::new(&target, None, &stands, &Quiet).unwrap();
    let (mut hits, mut misses) = (0, 0);
    for (stand, number) in stands.iter().zip(0..) {
        let key = linden::random::Key::new(6).child(number);
        let grid = Grid::of(stand, target.bounds().unwrap(), &settings, key);
        for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column)))
        {
            if (row + column) % 9 != 0 {
                continue;
            }
            let direction = grid.direction(row, column);
            let found = rays.first(stand.eye, direction);
            let wanted = nearest(&target, stand.eye, direction);
            assert_eq!(found.map(|end| end.range_m), wanted.map(|(range_m, _)| range_m), "{row} {column}");
            if found.is_some() { hits += 1 } else { misses += 1 }
        }
    }
    assert!(hits > 60 && misses > 60, "{hits} {misses}");
}

#[test]
fn points_without_errors_lie_on_what_they_are_said_to_lie_on() {
    let target = target(true);
    let scan = scan(&target, &exact(), &Quiet).unwrap();
    assert!(scan.points.len() > 500, "{}", scan.points.len());
    for what in [WhatIsHit::Wood, WhatIsHit::Leaf] {
        assert!(scan.points.iter().any(|point| scan.truth(point).what == what), "{what:?}");
    }
    for point in scan.points.iter().step_by(7) {
        let of_its_own = (0..target.triangles.len()).filter(|&i| target.owners[i] == point.truth);
        let off = of_its_own.map(|i| distance(point.position.as_dvec3(), target.triangles[i]));
        let off = off.fold(f64::INFINITY, f64::min);
        assert!(off < 2e-6, "{point:?} is {off} m off");
    }
}

#[test]
fn errors_are_as_large_as_asked_for() {
    let target = target(false);
    let mut noisy = exact();
    noisy.step_deg = 0.3;
    let clean = scan(&target, &noisy, &Quiet).unwrap();
    noisy.noise_m = 0.005;
    let scan = scan(&target, &noisy, &Quiet).unwrap();
    assert_eq!(scan.points.len(), clean.points.len());
    let (mut sum, mut squares) = (0.0, 0.0);
    for (point, clean) in scan.points.iter().zip(&clean.points) {
        let ray = (clean.position.as_dvec3() - scan.stands[usize::from(point.stand)].eye).normalize();
        let off = point.position.as_dvec3() - clean.position.as_dvec3();
        // Along the ray, and only there.
        assert!((off - ray * off.dot(ray)).length() < 2e-6);
        sum += off.dot(ray);
        squares += off.length_squared();
    }
    let count = scan.points.len() as f64;
    let (mean, sd) = (sum / count, (squares / count).sqrt());
    assert!(count > 1000.0 && mean.abs() < 5.0 * 0.005 / count.sqrt(), "{mean} of {count}");
    assert!((sd / 0.005 - 1.0).abs() < 0.1, "{sd}");
}

#[test]
fn a_beam_mixes_what_it_meets_and_stands_are_off_as_a_whole() {
    let target = target(false);
    let mut settings = exact();
    settings.step_deg = 0.3;
    settings.beam_rad = 3e-3;
    let mixed = scan(&target, &settings, &Quiet).unwrap();
    let off_surface = |scan: &Scan| {
        let off = |p: Vec3| {
            let of_all = target.triangles.iter().map(|&corners| distance(p.as_dvec3(), corners));
            of_all.fold(f64::INFINITY, f64::min)
        };
        let points = || scan.points.iter().step_by(41);
        points().filter(|point| off(point.position) > 0.003).count() as f64 / points().count() as f64
    };
    assert!((0.02..0.9).contains(&off_surface(&mixed)), "{}", off_surface(&mixed));
    assert!(mixed.points.iter().any(|point| point.echo > 0));

    settings.beam_rad = 0.0;
    let clean = scan(&target, &settings, &Quiet).unwrap();
    assert_eq!(off_surface(&clean), 0.0);
    settings.registration_m = 0.02;
    let moved = scan(&target, &settings, &Quiet).unwrap();
    for (point, clean) in moved.points.iter().zip(&clean.points) {
        let stand = &moved.stands[usize::from(point.stand)];
        let off = (stand.registered(clean.position.as_dvec3()) - point.position.as_dvec3()).length();
        assert!(off < 2e-6 && stand.shift.length() > 1e-3, "{off}");
    }
}

#[test]
fn ground_is_level_and_below() {
    let target = target(false);
    let mut settings = exact();
    settings.ground = true;
    let scan = scan(&target, &settings, &Quiet).unwrap();
    let foot = target.foot().unwrap();
    let ground: Vec<_> = scan.points.iter().filter(|p| scan.truth(p).what == WhatIsHit::Ground).collect();
    assert!(ground.len() > 100, "{}", ground.len());
    for point in ground {
        assert!((f64::from(point.position.y) - foot.y).abs() < 1e-5);
        // Nothing stands between.
        let eye = scan.stands[usize::from(point.stand)].eye;
        let to = point.position.as_dvec3() - eye;
        let before = nearest(&target, eye, to.normalize());
        assert!(before.is_none_or(|(range_m, _)| range_m > to.length()));
    }
}

/// Roots run below it, and no scanner sees them.
#[test]
fn nothing_is_seen_below_the_ground_be_it_scanned_or_not() {
    let recipe = recipe(builtin("olive").unwrap());
    let mut target = Target::default();
    target.add(&grow(&recipe, &Quiet).unwrap(), &recipe.preset.dressing.tubes, false, &Quiet).unwrap();
    let (low, foot) = (target.bounds().unwrap().min.y, target.foot().unwrap().y);
    assert!(f64::from(low) < foot - 0.1, "{low}");
    for ground in [false, true] {
        let mut settings = exact();
        (settings.ground, settings.step_deg) = (ground, 0.4);
        let scan = scan(&target, &settings, &Quiet).unwrap();
        let lowest =
            scan.points.iter().map(|point| f64::from(point.position.y)).fold(f64::INFINITY, f64::min);
        assert!(lowest > foot - 1e-4 && lowest < foot + 0.2, "{lowest} {ground}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_file() {
    let target = target(true);
    let mut settings = ScannerSettings::default();
    (settings.positions, settings.step_deg, settings.ground) = (3, 0.5, true);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let scan = pool.install(|| scan(&target, &settings, &Quiet).unwrap());
        [ply::header(&scan, "test").into_bytes(), ply::rows(&scan, 0..scan.points.len())].concat()
    };
    let one = on(1);
    assert!(one.len() > 10_000 && one == on(2));
    let mut other = settings;
    other.seed = 2;
    let other = scan(&target, &other, &Quiet).unwrap();
    assert_ne!(
        one,
        [ply::header(&other, "test").into_bytes(), ply::rows(&other, 0..other.points.len())].concat()
    );
}

/// The reader that trees are grown back through finds the points where they are.
#[test]
fn the_file_is_read_back() {
    let target = target(true);
    let scan = scan(&target, &exact(), &Quiet).unwrap();
    let bytes = [ply::header(&scan, "a\nb").into_bytes(), ply::rows(&scan, 0..scan.points.len())].concat();
    let names = ["tree", "part", "axis", "order", "stand", "echo"];
    let (data, columns) = linden::input::read_ply_with(&bytes, &names, &Quiet).unwrap();
    assert!(data.faces.is_empty() && data.positions.len() == scan.points.len());
    for (i, point) in scan.points.iter().enumerate() {
        let truth = scan.truth(point);
        assert_eq!(data.positions[i].as_vec3(), point.position);
        let found: Vec<f32> = columns.iter().map(|column| column.as_ref().unwrap()[i]).collect();
        let (tree, part) = (truth.tree as f32, f32::from(truth.what.number()));
        let (stand, echo) = (f32::from(point.stand), f32::from(point.echo));
        assert_eq!(found, [tree, part, truth.axis as f32, truth.order as f32, stand, echo]);
    }
}

#[test]
fn the_packed_file_holds_the_same_points_upright_and_the_same_bytes_each_time() {
    let target = target(true);
    let mut settings = exact();
    settings.ground = true;
    let scan = scan(&target, &settings, &Quiet).unwrap();
    let bytes = laz::file(&scan, "test", &Quiet).unwrap();
    assert_eq!(bytes, laz::file(&scan, "test", &Quiet).unwrap());
    let found = linden::input::read_las(&bytes, &Quiet).unwrap();
    assert_eq!(found.positions.len(), scan.points.len());
    let trees: Vec<u32> = scan.points.iter().map(|point| scan.truth(point).tree as u32).collect();
    let columns: Vec<_> = found.trees.iter().map(|column| (&*column.name, &column.numbers)).collect();
    assert_eq!(columns, [("treeID", &trees)]);
    for (found, point) in found.positions.iter().zip(&scan.points) {
        let Vec3 { x, y, z } = point.position;
        assert!(found.distance(Vec3::new(x, -z, y).as_dvec3()) < 1e-4, "{found} {point:?}");
    }
}

/// Four trees a few metres apart on a slope of 20°, with ground, from stands among them.
#[test]
fn sloping_ground_is_where_its_equation_has_it() {
    let (recipe, one) = small();
    let mut settings = exact();
    (settings.positions, settings.ground, settings.slope_deg, settings.height_m) = (7, true, 20.0, 1.6);
    // The tangent of 20°.
    let rise = 0.363_970_23;
    let mut target = Target::default();
    for [x, z] in [[0.0, 0.0], [5.0, 1.0], [1.0, -4.0], [-3.0, 3.0]] {
        let place = Place { position: Vec3::new(x, 0.0, z), turn_rad: 0.7, scale: 1.3, ..Place::origin(0) };
        target.add_at(&settings.on_slope(place), &one, &recipe.preset.dressing.tubes, false, &Quiet).unwrap();
        let foot = target.feet().last().unwrap();
        assert!((foot.y - rise * foot.x).abs() < 0.05, "{foot}");
    }
    let scan = scan(&target, &settings, &Quiet).unwrap();
    let lowest = target.foot().unwrap();
    let plane = |x: f64| lowest.y + f64::from(rise) * (x - lowest.x);
    for stand in &scan.stands {
        assert!((stand.eye.y - plane(stand.eye.x) - 1.6).abs() < 1e-6, "{stand:?}");
        for foot in target.feet() {
            let off = DVec3::new(stand.eye.x - f64::from(foot.x), 0.0, stand.eye.z - f64::from(foot.z));
            assert!(off.length() > 1.19, "{stand:?} {foot}");
        }
    }
    let on_ground: Vec<_> =
        scan.points.iter().filter(|point| scan.truth(point).what == WhatIsHit::Ground).collect();
    assert!(on_ground.len() > 500, "{}", on_ground.len());
    for point in on_ground {
        let p = point.position.as_dvec3();
        assert!((p.y - plane(p.x)).abs() < 1e-4, "{p}");
    }
    let trees: std::collections::BTreeSet<u32> =
        scan.points.iter().map(|point| scan.truth(point).tree).collect();
    assert_eq!(trees.into_iter().collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
}
