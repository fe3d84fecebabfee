//! From an axis' nodes to rings that can be joined without folding.

use glam::{Quat, Vec3};

/// A point of the axis with the wood's radius there, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub position: Vec3,
    pub radius: f32,
}

/// A circle of the tube: centre, radius and an orthonormal frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    pub center: Vec3,
    pub radius: f32,
    /// Unit vector along the axis, toward the apex.
    pub tangent: Vec3,
    /// Unit vector to where the ring's angle is 0; `tangent × side` is where it is 90°.
    pub side: Vec3,
    /// Arc length from the base, metres.
    pub along: f32,
}

/// Cosine of the sharpest turn that a ring can bridge, 143°: beyond it the band on either side is
/// sheared so much that its normals no longer fit its faces.
const SHARPEST_TURN: f32 = -0.8;

/// Takes out stations that coincide and spreads steps of the radius: what wood looks like before
/// features are added. Fewer than two stations are none.
pub(super) fn prepare(stations: &mut Vec<Station>) {
    stations.dedup_by(|next, kept| !distinct(kept, next));
    if stations.len() < 2 {
        stations.clear();
        return;
    }
    soften(stations);
}

/// Makes wood at least so thick that the corners of its rings are apart in `f32`: what is thinner could not
/// be told from a line, and its surface would be open. `sides` gives those of a ring of a radius.
pub(super) fn thicken(stations: &mut [Station], sides: impl Fn(f32) -> u32) {
    for station in stations {
        let resolution_m = station.position.abs().max_element() * f32::EPSILON;
        station.radius = station.radius.max(CORNERS_APART * sides(station.radius) as f32 * resolution_m);
    }
}

/// Steps of single precision around a ring, for each of its corners: half of them are left where a bud
/// narrows.
const CORNERS_APART: f32 = 4.0;

/// Chooses rings along the stations (base to apex) so that no ring cuts through its neighbour, gives
/// them parallel transport frames and appends them to `rings`.
///
/// A station whose ring would cut the previous one (a sharp turn of thick wood) is passed over. The base
/// is always kept, the apex unless it stands on the base; fewer than two stations give no rings.
pub(super) fn rings(stations: &[Station], rings: &mut Vec<Ring>) {
    if stations.len() < 2 {
        return;
    }
    let kept = without_folds(stations);
    let mut along = 0.0;
    let mut side = kept[0].1.any_orthonormal_vector();
    for (i, &(station, tangent)) in kept.iter().enumerate() {
        if i > 0 {
            let (before, before_tangent) = kept[i - 1];
            along += before.position.distance(station.position);
            side = transport(side, before_tangent, tangent);
        }
        rings.push(Ring { center: station.position, radius: station.radius, tangent, side, along });
    }
}

/// Length, in radii, over which a change of radius is spread.
const SOFTNESS: f32 = 2.0;

/// Spreads the pipe model's steps, which end all at once above a fork, along the axis as wood does.
///
/// A first-order low-pass over the arc length, up and then down, so that nothing is shifted. The
/// ends keep their radii, and radii that only shrink still only shrink.
fn soften(stations: &mut [Station]) {
    let share = |length: f32, radius: f32| length / (length + SOFTNESS * radius);
    for i in 1..stations.len() - 1 {
        let (before, here) = (stations[i - 1], stations[i]);
        let share = share(before.position.distance(here.position), here.radius);
        stations[i].radius = before.radius + share * (here.radius - before.radius);
    }
    for i in (1..stations.len() - 1).rev() {
        let (here, after) = (stations[i], stations[i + 1]);
        let share = share(here.position.distance(after.position), here.radius);
        stations[i].radius = after.radius + share * (here.radius - after.radius);
    }
}

/// Whether two stations are far enough apart for a segment between them, in `f32` at that place.
fn distinct(a: &Station, b: &Station) -> bool {
    let magnitude = a.position.abs().max(b.position.abs()).max_element();
    let least = (magnitude * 4.0 * f32::EPSILON).max(a.radius.min(b.radius) * 1e-3);
    a.position.distance(b.position) > least
}

/// Rotates `side` with the tangent: parallel transport by the smallest rotation. Where the axis
/// turns by 180° any rotation is the smallest; `side` is then still orthogonal and stays.
fn transport(side: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let turned = if from.dot(to) > SHARPEST_TURN { Quat::from_rotation_arc(from, to) * side } else { side };
    turned.reject_from_normalized(to).normalize_or(to.any_orthonormal_vector())
}

/// Stations with tangents such that each ring lies wholly ahead of the one before it.
///
/// A stack: a station whose ring cannot stand between its neighbours gives way to the next one.
/// The tangent is the bisector of the two segments, at the ends the segment itself.
fn without_folds(stations: &[Station]) -> Vec<(Station, Vec3)> {
    let mut kept = vec![(stations[0], Vec3::ZERO)];
    for &station in &stations[1..] {
        push(&mut kept, station);
    }
    // The last segment is judged too, now that nothing comes after it; two rings always stand.
    while kept.len() > 2 && !is_ahead(&kept[kept.len() - 2], &kept[kept.len() - 1]) {
        let apex = kept.pop().map_or(stations[0], |(station, _)| station);
        kept.pop();
        push(&mut kept, apex);
    }
    if kept.len() == 1 {
        // The axis returned to its base: end it at the node farthest from there.
        let distance = |s: &&Station| s.position.distance_squared(stations[0].position);
        if let Some(&far) = stations.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))) {
            push(&mut kept, far);
        }
    }
    kept
}

/// Puts a station on the stack and takes those off that cannot stand before it.
fn push(kept: &mut Vec<(Station, Vec3)>, next: Station) {
    while let [.., before, top] = kept.as_mut_slice() {
        let incoming = direction(&before.0, &top.0);
        let outgoing = direction(&top.0, &next);
        let bisector = (incoming + outgoing).normalize_or_zero();
        if incoming.dot(outgoing) > SHARPEST_TURN && is_ahead(before, &(top.0, bisector)) {
            top.1 = bisector;
            kept.push((next, outgoing));
            return;
        }
        kept.pop();
    }
    if distinct(&kept[0].0, &next) {
        kept[0].1 = direction(&kept[0].0, &next);
        kept.push((next, kept[0].1));
    }
}

fn direction(from: &Station, to: &Station) -> Vec3 {
    (to.position - from.position).normalize_or_zero()
}

/// Whether the band between two rings looks outward everywhere.
fn is_ahead((a, ta): &(Station, Vec3), (b, tb): &(Station, Vec3)) -> bool {
    let chord = b.position - a.position;
    let sine = ta.cross(*tb).length();
    let room = 0.02 * a.radius.min(b.radius);
    // Each ring wholly on its side of the other's plane: nothing can cross.
    let apart = chord.dot(*ta) > b.radius * sine + room && chord.dot(*tb) > a.radius * sine + room;
    let length = chord.length();
    let gentle = chord.dot(*ta) > GENTLE * length && chord.dot(*tb) > GENTLE * length;
    apart && (gentle || looks_outward(&(*a, *ta), &(*b, *tb)))
}

/// Cosine of the angle between segment and tangent up to which a band cannot be sheared inside out.
const GENTLE: f32 = 0.8;

/// Compares the faces of a sharply bent band with the directions out of its rings.
fn looks_outward((a, ta): &(Station, Vec3), (b, tb): &(Station, Vec3)) -> bool {
    const SAMPLES: u32 = 24;
    let side_a = ta.any_orthonormal_vector();
    let side_b = transport(side_a, *ta, *tb);
    (0..SAMPLES).all(|k| {
        let (sin, cos) = libm::sincosf(std::f32::consts::TAU * k as f32 / SAMPLES as f32);
        let out = |side: Vec3, tangent: Vec3| side * cos + tangent.cross(side) * sin;
        let (out_a, out_b) = (out(side_a, *ta), out(side_b, *tb));
        let along = (b.position + out_b * b.radius) - (a.position + out_a * a.radius);
        let faces = |tangent: Vec3, outward: Vec3| {
            let normal = tangent.cross(outward).cross(along).normalize_or_zero();
            normal.dot(out_a + out_b) > 0.4
        };
        faces(*ta, out_a) && faces(*tb, out_b)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swept(mut stations: Vec<Station>) -> Vec<Ring> {
        let mut out = Vec::new();
        prepare(&mut stations);
        rings(&stations, &mut out);
        out
    }

    fn along(points: &[(f32, f32, f32)], radius: f32) -> Vec<Ring> {
        let stations = points.iter().map(|&(x, y, z)| Station { position: Vec3::new(x, y, z), radius });
        swept(stations.collect())
    }

    #[test]
    fn frames_stay_orthonormal_and_turn_no_more_than_the_axis() {
        let helix: Vec<(f32, f32, f32)> = (0..60)
            .map(|i| {
                let a = i as f32 * 0.2;
                (libm::cosf(a), 0.1 * i as f32, libm::sinf(a))
            })
            .collect();
        let rings = along(&helix, 0.02);
        assert_eq!(rings.len(), 60);
        for pair in rings.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            assert!((b.side.length() - 1.0).abs() < 1e-5 && b.side.dot(b.tangent).abs() < 1e-5);
            // Parallel transport: the side's change has no part along the binormal, that is, the
            // frame does not spin about the tangent.
            let spin = a.tangent.cross(a.side).dot(b.side);
            assert!(spin.abs() < 0.02, "{spin}");
        }
    }

    #[test]
    fn a_step_of_the_radius_is_spread_and_stays_monotonous() {
        let radius = |i: usize| if i < 20 { 0.2 } else { 0.1 };
        let stations = (0..60).map(|i| Station { position: Vec3::Y * (0.05 * i as f32), radius: radius(i) });
        let out = swept(stations.collect());
        assert_eq!((out[0].radius, out[59].radius), (0.2, 0.1));
        assert!(out.windows(2).all(|pair| pair[1].radius <= pair[0].radius));
        let steepest = out.windows(2).map(|p| p[0].radius - p[1].radius).fold(0.0, f32::max);
        assert!(steepest < 0.025, "a quarter of the step at most, was {steepest}");
        // As much wood is added above the step as is taken below it.
        let moved: f32 = out.iter().enumerate().map(|(i, ring)| ring.radius - radius(i)).sum();
        assert!(moved.abs() < 0.5, "{moved} of a step of 0.1 over 40 rings");
    }

    #[test]
    fn a_fold_back_and_coinciding_nodes_do_not_break_the_frame() {
        for points in [
            &[(0., 0., 0.), (0., 1., 0.), (0., 0.5, 0.), (0., 2., 0.)][..],
            &[(0., 0., 0.), (0., 1., 0.), (0., 1., 0.), (1., 1., 0.)],
            &[(0., 0., 0.), (1., 0., 0.), (1., 1., 0.), (0., 1., 0.), (0., 0., 0.)],
        ] {
            let rings = along(points, 0.3);
            assert!(rings.len() >= 2, "{points:?}");
            for r in &rings {
                assert!((r.tangent.length() - 1.0).abs() < 1e-4 && (r.side.length() - 1.0).abs() < 1e-4);
                assert!(r.side.dot(r.tangent).abs() < 1e-4);
            }
        }
        assert!(along(&[(1., 1., 1.), (1., 1., 1.)], 0.1).is_empty());
    }
}
