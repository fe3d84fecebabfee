//! A terrestrial laser scanner that looks at a tree which linden grew.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use linden::grow::Fit;
use linden::grow::{Grown, grow};
use linden::input::Up;
use linden::preset::{Preset, builtin};
use linden::random::Key;
use linden::recipe::{Geometry, Input, Recipe};
use linden::skeleton::Axis;
use linden::surface::sweep;
use linden::{DVec3, NO_PARENT, Quiet, Skeleton};
use linden_tests::presets::recipe;

/// A tree to be scanned.
pub fn tree(id: &str, settings: &[(&str, &str)]) -> (Arc<Skeleton>, Recipe) {
    let mut recipe = recipe(builtin(id).unwrap());
    // What is scanned has nothing that growing back would not do.
    recipe.preset.set("refine", "none").unwrap();
    for (knob, value) in settings {
        recipe.preset.set(knob, value).unwrap();
    }
    (grow(&recipe, &Quiet).unwrap().skeleton, recipe)
}

/// Standard normal, three times (Box & Muller 1958).
fn normal(key: Key) -> DVec3 {
    let one = |axis: u64| {
        let (a, b) = (key.child(axis).child(0).unit(), key.child(axis).child(1).unit());
        (-2.0 * libm::log(1.0 - a)).sqrt() * libm::cos(TAU * b)
    };
    DVec3::new(one(0), one(1), one(2))
}

/// A point on the bark and the direction out of it.
#[derive(Clone, Copy)]
pub struct Hit {
    pub at: DVec3,
    pub normal: DVec3,
}

/// Points on the swept surface, uniform by area, about `spacing_m` apart.
pub fn bark((skeleton, recipe): &(Arc<Skeleton>, Recipe), spacing_m: f64, key: Key) -> Vec<Hit> {
    let mesh = sweep(skeleton, &recipe.preset.dressing.tubes, &Quiet).unwrap();
    let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize].as_dvec3());
    let mut hits = Vec::new();
    let mut owed = 0.0;
    for (i, triangle) in (0..).zip(&mesh.triangles) {
        let [a, b, c] = corners(triangle);
        let cross = (b - a).cross(c - a);
        owed += 0.5 * cross.length() / (spacing_m * spacing_m);
        for k in 0.. {
            if owed < 1.0 {
                break;
            }
            owed -= 1.0;
            let key = key.child(i).child(k);
            let (u, v) = (key.child(0).unit(), key.child(1).unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            hits.push(Hit { at: a + (b - a) * u + (c - a) * v, normal: cross.normalize_or_zero() });
        }
    }
    hits
}

/// Discs of a leaf's size around each tip, seen as `per_leaf` points each.
pub fn leaves(skeleton: &Skeleton, per_tip: u64, per_leaf: u64, radius_m: f64, key: Key) -> Vec<Hit> {
    let mut is_tip = vec![true; skeleton.positions.len()];
    for &parent in skeleton.parents.iter().filter(|&&p| p != NO_PARENT) {
        is_tip[parent as usize] = false;
    }
    let mut hits = Vec::new();
    for node in (0..is_tip.len()).filter(|&node| is_tip[node]) {
        for leaf in 0..per_tip {
            let key = key.child(node as u64).child(leaf);
            let out = normal(key.named("facing")).normalize_or(DVec3::Y);
            let (u, v) = out.any_orthonormal_pair();
            let at = skeleton.positions[node].as_dvec3() + 1.5 * radius_m * normal(key.named("place"));
            for k in 0..per_leaf {
                let key = key.named("point").child(k);
                let (r, turn) = (radius_m * key.child(0).unit().sqrt(), TAU * key.child(1).unit());
                hits.push(Hit {
                    at: at + r * (u * libm::cos(turn) + v * libm::sin(turn)),
                    normal: DVec3::ZERO,
                });
            }
        }
    }
    hits
}

/// What three scanners around the tree see of it: what faces them (leaves have two faces), the first
/// thing in each beam, thinned out with the square of the distance.
pub fn seen(hits: &[Hit], distance_m: f64, key: Key) -> Vec<Hit> {
    /// Beam width, radians, and how far behind the first thing a point of the same beam still counts.
    const BEAM: f64 = 2e-3;
    const DEPTH_M: f64 = 0.05;
    let mut kept = Vec::new();
    for sensor in 0..3_u64 {
        let turn = TAU / 3.0 * sensor as f64 + 0.3;
        let eye = DVec3::new(distance_m * libm::cos(turn), 1.6, distance_m * libm::sin(turn));
        let beam = |at: DVec3| {
            let to = (at - eye).normalize();
            let (azimuth, height) = (libm::atan2(to.z, to.x), libm::asin(to.y));
            ((azimuth / BEAM) as i32, (height / BEAM) as i32)
        };
        let mut first: BTreeMap<(i32, i32), f64> = BTreeMap::new();
        let faces = |hit: &Hit| hit.normal == DVec3::ZERO || hit.normal.dot(eye - hit.at) > 0.0;
        for hit in hits.iter().filter(|hit| faces(hit)) {
            let depth = first.entry(beam(hit.at)).or_insert(f64::INFINITY);
            *depth = depth.min(hit.at.distance(eye));
        }
        let nearest = hits.iter().map(|hit| hit.at.distance(eye)).fold(f64::INFINITY, f64::min);
        for (i, hit) in (0..).zip(hits) {
            let distance = hit.at.distance(eye);
            let falloff = (nearest / distance) * (nearest / distance);
            if faces(hit)
                && distance < first[&beam(hit.at)] + DEPTH_M
                && key.child(sensor).child(i).unit() < falloff
            {
                kept.push(*hit);
            }
        }
    }
    kept
}

/// Without what lies in a few cones from the far side of the crown, and without half a metre of the stem.
pub fn with_gaps(hits: &[Hit], centre: DVec3, away_m: f64) -> Vec<Hit> {
    let hidden = |at: DVec3| {
        (0..4).any(|cone| {
            let turn = PI * (0.25 + 0.5 * f64::from(cone));
            let eye = centre + away_m * DVec3::new(libm::cos(turn), 0.1, libm::sin(turn));
            let (to, axis) = ((at - eye).normalize(), (centre - eye).normalize());
            // 5° wide, from just behind the stem on.
            to.dot(axis) > libm::cos(PI / 36.0) && at.distance(eye) < 0.85 * away_m
        })
    };
    hits.iter().copied().filter(|hit| !(0.9..1.4).contains(&hit.at.y) && !hidden(hit.at)).collect()
}

/// The coordinates as the scanner gives them: each off by a normal error.
pub fn measured(hits: &[Hit], sd_m: f64, key: Key) -> Vec<DVec3> {
    (0..).zip(hits).map(|(i, hit)| hit.at + sd_m * normal(key.child(i))).collect()
}

/// Grows a tree back into a scan (Y up), where the scan is.
pub fn grown_back(points: Vec<DVec3>, settings: &[(&str, &str)]) -> Grown {
    let mut preset = Preset::of("scan", linden::preset::ScanSettings::of("scan.ply".to_owned()));
    for (knob, value) in [("origin", "keep")].iter().chain(settings) {
        preset.set(knob, value).unwrap();
    }
    let geometry = Geometry::Points(Arc::new(points.into()));
    let input = Input { hash: 0, up: Up::Y, geometry };
    grow(&Recipe::with_files(preset, [("scan.ply", input)].into_iter().collect()), &Quiet).unwrap()
}

/// What is compared.
#[derive(Clone, Debug)]
pub struct Sizes {
    pub length_m: f64,
    /// Of orders 0, 1 and 2.
    pub order_m: [f64; 3],
    /// First-order axes of more than a metre.
    pub limbs: usize,
    pub breast_m: f64,
    /// Radii of the stem 0.5, 1.0, 1.5 m and 2 m up.
    pub stem_m: [f64; 4],
    pub volume_m3: f64,
}

fn length_m(skeleton: &Skeleton, axis: &Axis) -> f64 {
    let nodes = skeleton.nodes_of(axis);
    let first = (axis.parent != NO_PARENT).then_some(axis.parent);
    let chain: Vec<u32> = first.into_iter().chain(nodes.iter().copied()).collect();
    let at = |n: u32| skeleton.positions[n as usize].as_dvec3();
    chain.windows(2).map(|pair| at(pair[0]).distance(at(pair[1]))).sum()
}

pub fn sizes(skeleton: &Skeleton) -> Sizes {
    let measures = skeleton.measures();
    let lengths: Vec<(u32, f64)> = skeleton.axes.iter().map(|a| (a.order, length_m(skeleton, a))).collect();
    let order = |n: u32| lengths.iter().filter(|l| l.0 == n).map(|l| l.1).sum();
    let stem = skeleton.nodes_of(&skeleton.axes[0]);
    let foot = skeleton.positions[stem[0] as usize].y;
    let radius_at = |height: f32| {
        let above = stem.iter().position(|&n| skeleton.positions[n as usize].y - foot >= height);
        let [a, b] = [above.unwrap_or(1).max(1) - 1, above.unwrap_or(1).max(1)].map(|i| stem[i] as usize);
        let (low, high) = (skeleton.positions[a].y - foot, skeleton.positions[b].y - foot);
        let t = ((height - low) / (high - low)).clamp(0.0, 1.0);
        f64::from(skeleton.radii[a] + (skeleton.radii[b] - skeleton.radii[a]) * t)
    };
    Sizes {
        length_m: measures.total_length_m,
        order_m: [order(0), order(1), order(2)],
        limbs: lengths.iter().filter(|l| l.0 == 1 && l.1 > 1.0).count(),
        breast_m: measures.trunk_diameter_m,
        stem_m: [0.5, 1.0, 1.5, 2.0].map(radius_at),
        volume_m3: measures.wood_volume_m3,
    }
}

/// One line of the table.
pub fn line(what: &str, sizes: &Sizes, fit: Option<&Fit>) -> String {
    let Sizes { length_m, order_m, limbs, breast_m, stem_m, volume_m3 } = sizes;
    let [a, b, c] = order_m;
    let stem = stem_m.map(|r| format!("{:.0}", 1e3 * r)).join(" ");
    let fit = fit.map_or(String::new(), |fit| {
        let pair = |s: linden::grow::Spread| format!("{:.1}/{:.1}", 1e3 * s.mean_m, 1e3 * s.p95_m);
        format!(
            "surface {} axis {} back {}",
            pair(fit.points_to_surface),
            pair(fit.points_to_axis),
            pair(fit.surface_to_points)
        )
    });
    format!(
        "{what:24} {length_m:7.1} m  orders {a:5.1} {b:5.1} {c:5.1}  limbs {limbs:3}  dbh {:5.0} mm  stem {stem} mm  {volume_m3:.3} m3  {fit}",
        1e3 * breast_m
    )
}
