//! Convex hulls against their definition.

use linden::DVec3;
use linden::glam::DVec2;
use linden::hull::{HullPolygon, HullSolid};
use proptest::prelude::*;

/// Small whole numbers, so that points repeat and lie in rows and planes; or any.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-2_i8..=2).prop_map(f64::from), (-1.0_f32..1.0).prop_map(f64::from)]
}

fn points() -> impl Strategy<Value = Vec<DVec3>> {
    let point = prop::array::uniform3(coordinate()).prop_map(DVec3::from);
    let flat = (coordinate(), coordinate()).prop_map(|(x, y)| DVec3::new(x, y, 0.3 * x));
    prop_oneof![prop::collection::vec(point, 0..60), prop::collection::vec(flat, 0..40)]
}

/// A point is a corner unless it lies between or among others: brute force over all half planes through two points.
fn is_on_hull(all: &[DVec2], p: DVec2) -> bool {
    let on_one_side = |q: DVec2| all.iter().all(|&r| (q - p).perp_dot(r - p) >= 0.0);
    all.iter().any(|&q| q != p && on_one_side(q)) || all.iter().all(|&q| q == p)
}

/// The volume by slices: of each plane through three points that has all others on one side, the pyramid to the
/// middle. Each face is counted once, by its plane.
fn volume(points: &[DVec3]) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    let mut sum = 0.0;
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            for &c in &points[j + 1..] {
                let normal = (b - a).cross(c - a);
                if normal.length() < 1e-9 {
                    continue;
                }
                let normal = normal.normalize();
                let heights = || points.iter().map(|&p| normal.dot(p - a));
                let (low, high) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
                if low < -1e-9 && high > 1e-9 {
                    continue;
                }
                let out = if high > 1e-9 { -normal } else { normal };
                let offset = out.dot(a);
                if planes.iter().any(|(n, o)| n.dot(out) > 1.0 - 1e-9 && (o - offset).abs() < 1e-8) {
                    continue;
                }
                planes.push((out, offset));
                // Of the face: its points, in the plane.
                let x = (b - a).normalize();
                let y = out.cross(x);
                let on: Vec<DVec2> = points
                    .iter()
                    .filter(|p| (out.dot(**p) - offset).abs() < 1e-9)
                    .map(|&p| DVec2::new(x.dot(p - a), y.dot(p - a)))
                    .collect();
                sum += shoelace(on) * (offset - out.dot(middle)) / 3.0;
            }
        }
    }
    sum
}

/// Area of the convex polygon of some points: sorted by angle about their middle.
fn shoelace(mut on: Vec<DVec2>) -> f64 {
    let all = on.clone();
    on.retain(|&p| is_on_hull(&all, p));
    let middle = on.iter().sum::<DVec2>() / on.len() as f64;
    on.sort_by(|a, b| (a - middle).to_angle().total_cmp(&(b - middle).to_angle()));
    let next = on.iter().cycle().skip(1);
    on.iter().zip(next).map(|(a, b)| (a - middle).perp_dot(*b - middle)).sum::<f64>() / 2.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_polygon_has_all_points_on_its_left(points in points()) {
        let points: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
        let hull = HullPolygon::of(&points);
        let n = hull.corners.len();
        prop_assert!(hull.corners.iter().all(|corner| points.contains(corner)));
        for i in 0..n {
            let (a, b) = (hull.corners[i], hull.corners[(i + 1) % n]);
            prop_assert!(points.iter().all(|&p| (b - a).perp_dot(p - a) >= -1e-12), "{:?}", hull);
        }
        if n > 2 {
            prop_assert!((hull.area() - shoelace(points.clone())).abs() < 1e-9);
        }
        // Widths by the definition, over many directions.
        let width = |degrees: usize| {
            let side = DVec2::from_angle((degrees as f64 / 4.0).to_radians());
            let of = |p: &DVec2| side.dot(*p);
            points.iter().map(of).reduce(f64::max).unwrap_or(0.0) - points.iter().map(of).reduce(f64::min).unwrap_or(0.0)
        };
        let widths: Vec<f64> = (0..720).map(width).collect();
        let (least, most) = widths.iter().fold((f64::MAX, 0.0_f64), |(l, m), w| (l.min(*w), m.max(*w)));
        let mean = widths.iter().sum::<f64>() / 720.0;
        let scale = most.max(1e-9);
        prop_assert!((hull.mean_width() - mean).abs() < 1e-3 * scale, "{} {}", hull.mean_width(), mean);
        prop_assert!(hull.least_width() <= least + 1e-9 && hull.least_width() > least - 5e-3 * scale);
        prop_assert!(hull.most_width() >= most - 1e-9 && hull.most_width() < most + 1e-4 * scale);
    }

    #[test]
    fn a_solid_is_closed_and_has_all_points_behind_its_faces(points in points()) {
        let hull = HullSolid::of(&points);
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for triangle in &hull.triangles {
            let [a, b, c] = triangle.map(|corner| hull.corners[corner as usize]);
            let normal = (b - a).cross(c - a);
            prop_assert!(points.iter().all(|&p| normal.dot(p - a) <= 1e-9), "{:?}", hull);
            edges.extend([[triangle[0], triangle[1]], [triangle[1], triangle[2]], [triangle[2], triangle[0]]]);
        }
        for &[a, b] in &edges {
            prop_assert_eq!(edges.iter().filter(|edge| **edge == [b, a]).count(), 1);
        }
    }

    #[test]
    fn a_solid_has_the_volume_of_its_definition(points in points().prop_map(|mut p| { p.truncate(14); p })) {
        let hull = HullSolid::of(&points);
        let expected = if hull.triangles.is_empty() { 0.0 } else { volume(&points) };
        prop_assert!((hull.volume() - expected).abs() < 1e-7 * (1.0 + expected), "{} {}", hull.volume(), expected);
    }
}

#[test]
fn many_points_are_taken_in_parts() {
    let key = linden::random::Key::new(5);
    // In a ball; every tenth in one plane.
    let points: Vec<DVec3> = (0..60_000)
        .map(|i| {
            let p = DVec3::from([0, 1, 2].map(|axis| key.child(i).child(axis).between(-1.0, 1.0)));
            let p = p / p.length().max(1.0);
            if i % 10 == 0 { (p * 0.9).with_y(0.25) } else { p }
        })
        .collect();
    let hull = HullSolid::of(&points);
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    assert!((0.97..1.0).contains(&(hull.volume() / ball)), "{}", hull.volume() / ball);
    let disc: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
    let hull = HullPolygon::of(&disc);
    assert!((0.98..1.0).contains(&(hull.area() / std::f64::consts::PI)), "{}", hull.area());
    assert!((1.97..2.0).contains(&hull.mean_width()), "{}", hull.mean_width());
}
