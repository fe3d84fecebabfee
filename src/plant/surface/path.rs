//! From an axis' nodes to rings that can be joined without folding.

use glam::{Quat, Vec3};

/// A point of the axis with the wood's radius there, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub position: Vec3,
    pub radius: f32,
    /// Of the wood above, which differs where it steps.
    pub onward: f32,
}

impl Station {
    pub const fn new(position: Vec3, radius: f32) -> Self {
        Self { position, radius, onward: radius }
    }

    /// On the straight line to the next station, a share of the way.
    pub fn toward(&self, next: &Self, share: f32) -> Self {
        let position = self.position.lerp(next.position, share);
        Self::new(position, self.onward + (next.radius - self.onward) * share)
    }

    pub fn scale(&mut self, factor: f32) {
        self.radius *= factor;
        self.onward *= factor;
    }

    fn steps(&self) -> bool {
        self.radius != self.onward
    }
}

/// Gives each segment the radius that it ends with.
pub(super) fn step(stations: &mut [Station]) {
    let upper: Vec<f32> = stations.iter().skip(1).map(|station| station.radius).collect();
    for (station, onward) in stations.iter_mut().zip(upper) {
        station.onward = onward;
    }
    if let Some(base) = stations.first_mut() {
        base.radius = base.onward;
    }
}

/// A ring of the tube: centre, radius and an orthonormal frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    pub center: Vec3,
    /// Of the wood below and that of the wood above, which differ where it steps.
    pub radius: f32,
    pub onward: f32,
    /// Unit vector along the axis, toward the apex.
    pub tangent: Vec3,
    /// Unit vector to where the ring's angle is 0; `tangent × side` is where it is 90°.
    pub side: Vec3,
    /// Where the axis bends: how much wider the ring is within the bend, as a vector in the ring's plane. A
    /// circle of either segment, cut off by that plane, is longer there.
    pub mitre: Vec3,
    /// Arc length from the base, metres; less than 0 where a stem goes on into the ground.
    pub along: f32,
}

impl Ring {
    pub fn steps(&self) -> bool {
        self.radius != self.onward
    }

    /// The direction out of the ring at `(cos, sin)`, unit, and the place of a circle of radius 1 there,
    /// from the centre.
    pub fn outward(&self, (cos, sin): (f32, f32)) -> (Vec3, Vec3) {
        let out = self.side * cos + self.tangent.cross(self.side) * sin;
        let widest = self.mitre.length_squared();
        // Most rings stand in no bend.
        if widest == 0.0 {
            (out, out)
        } else {
            (out, out + self.mitre * (self.mitre.dot(out) / widest.sqrt()))
        }
    }
}

/// The most that a stem leans at its foot for its tube to go on into the ground, as the cosine: 60°.
const LEANS: f32 = 0.5;
/// Where one side of the foot rises less than this, in radii, the tube stays as it is.
const LEVEL: f32 = 0.01;

/// Lets the tube of a stem go on straight down into the ground, level where it ends: `depth` radii, on ground that falls or where
/// it leans no less than it needs to be closed all around. Across its axis its foot would stand on one side alone. Says how far
/// down, metres.
pub(super) fn sink(stations: &mut Vec<Station>, depth: f32, fall: f32) -> f32 {
    let [foot, next, ..] = stations.as_slice() else { return 0.0 };
    let up = (next.position - foot.position).normalize_or_zero();
    let sine = (up.x * up.x + up.z * up.z).sqrt();
    let depth = depth.max(WIDEST_FOOT * fall.abs());
    if up.y < LEANS || (sine < LEVEL && depth <= 0.0) {
        return 0.0;
    }
    // At the foot the ring stands across the bisector: half as steep. Below it there is room for its lower side.
    let tangent_of_half = sine / (1.0 + up.y);
    let needed = if sine < LEVEL { 0.0 } else { WIDEST_FOOT * tangent_of_half + 0.05 };
    let below_m = foot.onward * needed.max(depth);
    let under = Station::new(foot.position - Vec3::Y * below_m, foot.onward);
    stations.insert(0, under);
    below_m
}

/// The corners of a foot, in radii: of few sides they stand out, and so do buttresses.
const WIDEST_FOOT: f32 = 1.5;

/// Cosine of the sharpest turn that a ring can bridge, 143°: beyond it the band on either side is
/// sheared so much that its normals no longer fit its faces.
const SHARPEST_TURN: f32 = -0.8;

/// Takes out stations that coincide and spreads steps of the radius: what wood looks like before
/// features are added. `softness` is the length, in radii, over which a change is spread, 0 for none. Fewer
/// than two stations are none.
pub(super) fn prepare(stations: &mut Vec<Station>, softness: f32) {
    stations.dedup_by(|next, kept| {
        let coincide = !distinct(kept, next);
        if coincide && (next.steps() || kept.steps()) {
            kept.onward = next.onward;
        }
        coincide
    });
    if stations.len() < 2 {
        stations.clear();
        return;
    }
    if softness > 0.0 {
        soften(stations, softness);
    }
}

/// Makes wood at least so thick that the corners of its rings are apart in `f32`: what is thinner could not
/// be told from a line, and its surface would be open. `sides` gives those of a ring of a radius.
pub(super) fn thicken(stations: &mut [Station], sides: impl Fn(f32) -> u32) {
    for station in stations {
        let resolution_m = station.position.abs().max_element() * f32::EPSILON;
        for radius in [&mut station.radius, &mut station.onward] {
            *radius = radius.max(CORNERS_APART * sides(*radius) as f32 * resolution_m);
        }
    }
}

/// Steps of single precision around a ring, for each of its corners: half of them are left where a bud
/// narrows.
const CORNERS_APART: f32 = 4.0;

/// Chooses rings along the stations (base to apex) so that no ring cuts through its neighbour, gives
/// them parallel transport frames and appends them to `rings`.
///
/// A station whose ring would cut the previous one (a sharp turn of thick wood) is passed over. The base
/// is always kept, the apex unless it stands on the base; fewer than two stations give no rings. Nothing
/// steps at either end. `reach` is how far the corners of a ring stand, in radii; `kept` is memory to work in. The first station is
/// `below_m` below the foot from which rings are measured.
///
/// Whether the axis bends so much somewhere that its tube has to be looked at: what is checked here are rings,
/// not the triangles between rings of few and other numbers of sides.
pub(super) fn rings(
    stations: &[Station],
    below_m: f32,
    reach: impl Fn(f32) -> f32,
    kept: &mut Vec<Kept>,
    rings: &mut Vec<Ring>,
) -> bool {
    if stations.len() < 2 {
        return false;
    }
    let widest = |radius: f32| radius * reach(radius);
    without_folds(stations, widest, kept);
    // One ring alone would be a disc that nothing closes.
    if kept.len() < 2 {
        return false;
    }
    let last = kept.len() - 1;
    let is_bent = kept.windows(2).any(|pair| !is_gentle(&pair[0], &pair[1], GENTLEST));
    let mut along = -below_m;
    let mut side = kept[0].tangent.any_orthonormal_vector();
    for (i, here) in kept.iter().enumerate() {
        if i > 0 {
            let before = &kept[i - 1];
            along += before.position.distance(here.position);
            side = transport(side, before.tangent, here.tangent);
        }
        let mitre = if i == 0 || i == last { Vec3::ZERO } else { mitre([&kept[i - 1], here, &kept[i + 1]]) };
        let Station { radius, onward, .. } = stations[here.index];
        let [radius, onward] = match i {
            0 => [onward; 2],
            _ if i == last => [radius; 2],
            _ => [radius, onward],
        };
        rings.push(Ring { center: here.position, radius, onward, tangent: here.tangent, side, mitre, along });
    }
    is_bent
}

/// A station that stays, as wide as its ring will be.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    index: usize,
    position: Vec3,
    /// To the farthest corners of the ring below and of the one above, metres.
    radius: f32,
    onward: f32,
    tangent: Vec3,
    /// The direction to it from the one below it on the stack.
    incoming: Vec3,
}

/// The widest that a ring gets in a bend, against a circle: at 96°.
const WIDEST_MITRE: f32 = 1.5;

/// How much wider a ring is within the bend of its axis, no more than leaves it clear of its neighbours.
fn mitre([before, here, after]: [&Kept; 3]) -> Vec3 {
    let toward = after.incoming;
    let within = toward.reject_from_normalized(here.tangent).normalize_or_zero();
    let radius = here.radius.max(here.onward);
    let room = |other: &Kept| {
        let distance = (here.position - other.position).dot(other.tangent).abs();
        let sine = here.tangent.cross(other.tangent).length();
        if sine > 0.0 { distance / (radius * sine) } else { f32::INFINITY }
    };
    // Half of the room: a neighbour's ring may be wider, too.
    let room = f32::midpoint(1.0, room(before).min(room(after)));
    let wider = (1.0 / toward.dot(here.tangent)).min(WIDEST_MITRE).min(room);
    within * (wider - 1.0).max(0.0)
}

/// Spreads the pipe model's steps, which end all at once above a fork, along the axis as wood does.
///
/// A first-order low-pass over the arc length, up and then down, so that nothing is shifted. The
/// ends keep their radii, and radii that only shrink still only shrink.
fn soften(stations: &mut [Station], softness: f32) {
    let share = |length: f32, radius: f32| length / (length + softness * radius);
    for i in 1..stations.len() - 1 {
        let (before, here) = (stations[i - 1], stations[i]);
        let share = share(before.position.distance(here.position), here.radius);
        stations[i].radius = before.radius + share * (here.radius - before.radius);
    }
    for i in (1..stations.len() - 1).rev() {
        let (here, after) = (stations[i], stations[i + 1]);
        let share = share(here.position.distance(after.position), here.radius);
        stations[i] = Station::new(here.position, after.radius + share * (here.radius - after.radius));
    }
}

/// Whether two stations are far enough apart for a segment between them, in `f32` at that place.
fn distinct(a: &Station, b: &Station) -> bool {
    are_distinct([a.position, b.position], a.radius.min(b.radius))
}

fn are_distinct([a, b]: [Vec3; 2], radius: f32) -> bool {
    let magnitude = a.abs().max(b.abs()).max_element();
    a.distance(b) > (magnitude * 4.0 * f32::EPSILON).max(radius * 1e-3)
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
fn without_folds(stations: &[Station], widest: impl Fn(f32) -> f32, kept: &mut Vec<Kept>) {
    let whole = |index: usize| {
        let Station { position, radius, onward } = stations[index];
        let (tangent, incoming) = (Vec3::ZERO, Vec3::ZERO);
        Kept { index, position, radius: widest(radius), onward: widest(onward), tangent, incoming }
    };
    kept.clear();
    kept.push(whole(0));
    for index in 1..stations.len() {
        push(kept, whole(index));
    }
    // The last segment is judged too, now that nothing comes after it; two rings always stand.
    while kept.len() > 2 && !is_ahead(&kept[kept.len() - 2], &kept[kept.len() - 1]) {
        let apex = kept.pop().unwrap_or(kept[0]);
        kept.pop();
        push(kept, apex);
    }
    if kept.len() == 1 {
        // The axis returned to its base: end it at the node farthest from there.
        let distance = |&index: &usize| stations[index].position.distance_squared(stations[0].position);
        let far = (0..stations.len()).max_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(far) = far {
            // However near that is: a tube has two rings.
            let (base, apex) = (&mut kept[0], whole(far));
            let tangent = direction(base, &apex);
            if tangent != Vec3::ZERO {
                base.tangent = tangent;
                kept.push(Kept { tangent, incoming: tangent, ..apex });
            }
        }
    }
}

/// Puts a station on the stack and takes those off that cannot stand before it.
fn push(kept: &mut Vec<Kept>, next: Kept) {
    while let [.., before, top] = kept.as_mut_slice() {
        let incoming = top.incoming;
        let outgoing = direction(top, &next);
        let bisector = (incoming + outgoing).normalize_or_zero();
        if incoming.dot(outgoing) > SHARPEST_TURN && is_ahead(before, &Kept { tangent: bisector, ..*top }) {
            top.tangent = bisector;
            kept.push(Kept { tangent: outgoing, incoming: outgoing, ..next });
            return;
        }
        kept.pop();
    }
    let base = &mut kept[0];
    if are_distinct([base.position, next.position], base.radius.min(next.radius)) {
        base.tangent = direction(base, &next);
        let tangent = base.tangent;
        kept.push(Kept { tangent, incoming: tangent, ..next });
    }
}

fn direction(from: &Kept, to: &Kept) -> Vec3 {
    (to.position - from.position).normalize_or_zero()
}

/// Whether the band between two rings looks outward everywhere.
fn is_ahead(a: &Kept, b: &Kept) -> bool {
    let chord = b.position - a.position;
    let sine = a.tangent.cross(b.tangent).length();
    let room = 0.02 * a.onward.min(b.radius);
    // Each ring wholly on its side of the other's plane: nothing can cross.
    let [ahead_of_a, ahead_of_b] = [chord.dot(a.tangent), chord.dot(b.tangent)];
    let apart = ahead_of_a > b.radius * sine + room && ahead_of_b > a.onward * sine + room;
    apart && (is_gentle(a, b, GENTLE) || looks_outward(a, b))
}

fn is_gentle(a: &Kept, b: &Kept, cosine: f32) -> bool {
    let chord = b.position - a.position;
    chord.dot(a.tangent).min(chord.dot(b.tangent)) > cosine * chord.length()
}

/// Cosine of the angle between segment and tangent up to which a band cannot be sheared inside out.
const GENTLE: f32 = 0.8;
/// The same for rings that are wider than circles, of any number of sides.
const GENTLEST: f32 = 0.97;

/// Compares the faces of a sharply bent band with the directions out of its rings.
fn looks_outward(a: &Kept, b: &Kept) -> bool {
    const SAMPLES: u32 = 24;
    let (ta, tb) = (a.tangent, b.tangent);
    let side_a = ta.any_orthonormal_vector();
    let side_b = transport(side_a, ta, tb);
    (0..SAMPLES).all(|k| {
        let (sin, cos) = libm::sincosf(std::f32::consts::TAU * k as f32 / SAMPLES as f32);
        let out = |side: Vec3, tangent: Vec3| side * cos + tangent.cross(side) * sin;
        let (out_a, out_b) = (out(side_a, ta), out(side_b, tb));
        let along = (b.position + out_b * b.radius) - (a.position + out_a * a.onward);
        let faces = |tangent: Vec3, outward: Vec3| {
            let normal = tangent.cross(outward).cross(along).normalize_or_zero();
            normal.dot(out_a + out_b) > 0.4
        };
        faces(ta, out_a) && faces(tb, out_b)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swept(mut stations: Vec<Station>) -> Vec<Ring> {
        let mut out = Vec::new();
        prepare(&mut stations, 2.0);
        rings(&stations, 0.0, |_| 1.0, &mut Vec::new(), &mut out);
        out
    }

    fn along(points: &[(f32, f32, f32)], radius: f32) -> Vec<Ring> {
        let stations = points.iter().map(|&(x, y, z)| Station::new(Vec3::new(x, y, z), radius));
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
        let stations = (0..60).map(|i| Station::new(Vec3::Y * (0.05 * i as f32), radius(i)));
        let out = swept(stations.collect());
        assert_eq!((out[0].radius, out[59].radius), (0.2, 0.1));
        assert!(out.windows(2).all(|pair| pair[1].radius <= pair[0].radius));
        let steepest = out.windows(2).map(|p| p[0].radius - p[1].radius).fold(0.0, f32::max);
        assert!(steepest < 0.025, "a quarter of the step at most, was {steepest}");
        // As much wood is added above the step as is taken below it.
        let moved: f32 = out.iter().enumerate().map(|(i, ring)| ring.radius - radius(i)).sum();
        assert!(moved.abs() < 0.5, "{moved} of a step of 0.1 over 40 rings");
    }

    /// Rings are wider than circles: stations that are just distinct are not, by what is laid.
    #[test]
    fn an_axis_that_is_shorter_than_its_rings_are_wide_has_two_or_none() {
        for micrometres in 1..400 {
            let far = micrometres as f32 * 1e-6;
            let mut stations: Vec<Station> =
                [0.0, far].map(|y| Station::new(Vec3::new(0.3, y, 0.1), 0.02)).to_vec();
            prepare(&mut stations, 0.0);
            let mut laid = Vec::new();
            rings(&stations, 0.0, |_| 1.2, &mut Vec::new(), &mut laid);
            assert!(laid.len() == stations.len(), "{far} m: {} rings of {}", laid.len(), stations.len());
            assert!(laid.iter().all(|ring| (ring.tangent.length() - 1.0).abs() < 1e-4), "{far} m");
        }
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
