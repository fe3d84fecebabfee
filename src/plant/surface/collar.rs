//! Where a lateral leaves its parent: the wood of both runs into one another.
//!
//! A fillet, as a sculptor would lay it: the lateral's surface widens towards its parent's along a
//! quarter of a circle and meets it at a tangent. Each vertex goes outward from the lateral's axis by
//! as much as its distance from the parent's surface asks for where it then is, so that collars follow
//! the parent's girth and fill acute crotches. Normals turn into the parent's.

use glam::Vec3;

use super::path::Station;
use super::spread;
use linden_base::memory::bytes_of;

/// The collar of one lateral.
#[derive(Clone, Debug)]
pub(super) struct Collar {
    /// The parent's axis near the junction, base to apex.
    spine: Vec<Station>,
    /// The fillet's radius, metres.
    pub fillet_m: f32,
    /// Where the collar starts and ends along the lateral, metres.
    from_m: f32,
    to_m: f32,
}

/// Stations that a collar adds at most.
pub(super) const MOST_RINGS: usize = 14;

/// How far a lateral sets out along its parent, at its very base and for a collar of 1: the slope of its
/// course against the straight one.
const UPSWEEP: f32 = 0.8;

impl Collar {
    /// The collar round the base of a lateral, which is given more stations there and sets out along
    /// its parent. `None` where the lateral does not get out of its parent.
    ///
    /// `up` is the unit vector along the parent's axis at the junction, `sides` those of the lateral's
    /// rings, `strength` 0 to 1.
    pub fn new(
        spine: Vec<Station>,
        up: Vec3,
        stations: &mut Vec<Station>,
        fillet_m: f32,
        sides: u32,
        strength: f32,
    ) -> Option<Self> {
        let mut collar = Self { spine, fillet_m, from_m: 0.0, to_m: 0.0 };
        if !(fillet_m > 0.0) || stations.len() < 2 {
            return None;
        }
        collar.reach(stations)?;
        let Self { from_m, to_m, .. } = collar;
        // Enough to show the curve on wood with these sides.
        let rings = (sides as usize).clamp(4, MOST_RINGS);
        spread::insert(
            stations,
            (0..=rings).map(|i| {
                // Closer at the parent's surface, where the fillet bends most.
                let t = i as f32 / rings as f32;
                from_m + (to_m - from_m) * t * (0.5 + 0.5 * t)
            }),
        );
        let length = length(stations);
        let reach = (1.5 * to_m).min(length);
        let mut along = 0.0;
        let straight = stations.clone();
        // A lateral that leaves steeply is on its way already.
        let setting_out = (straight[1].position - straight[0].position).normalize_or_zero();
        let up = up.reject_from(setting_out);
        for i in 1..stations.len() {
            along += straight[i - 1].position.distance(straight[i].position);
            if along >= reach {
                break;
            }
            let t = along / reach;
            stations[i].position += up * (UPSWEEP * strength * reach * t * (1.0 - t) * (1.0 - t));
        }
        Some(collar)
    }

    pub fn bytes(&self) -> u64 {
        bytes_of::<Self>(1) + bytes_of::<Station>(self.spine.capacity())
    }

    /// Finds where along the lateral its surface starts to leave the parent's and where the last of it is
    /// as far out as the fillet reaches.
    fn reach(&mut self, stations: &[Station]) -> Option<()> {
        /// Looks along the way out.
        const STEPS: u32 = 64;
        let length = length(stations);
        let thickest = self.spine.iter().map(|station| station.radius).fold(0.0, f32::max);
        let farthest = length.min(6.0 * (thickest + self.fillet_m));
        let (mut from, mut to) = (None, None);
        for i in 0..=STEPS {
            let along = farthest * i as f32 / STEPS as f32;
            let (center, radius, direction) = at(stations, along);
            let (distance, out) = self.distance(center, EVERYWHERE);
            // How much deeper than its centre a ring's deepest point lies, at most.
            let tilt = radius * direction.cross(out).length();
            if from.is_none() && distance > -(radius + 0.3 * self.fillet_m) {
                from = Some(along);
            }
            if distance - tilt >= self.fillet_m {
                to = Some(along);
                break;
            }
        }
        self.from_m = from?;
        // A collar that never ends still has to end before the apex.
        self.to_m = to.unwrap_or(farthest.min(length * 0.9));
        (self.to_m > self.from_m && to.is_some()).then_some(())
    }

    /// Whether the collar has a part in a ring at an arc length, metres.
    pub fn shapes(&self, along_m: f32) -> bool {
        along_m > self.from_m * 0.5 && along_m <= self.to_m * 1.05
    }

    /// Where a vertex of the bare tube goes, and its normal. `ease` is the share of the fillet's radius
    /// that is used: at 0 the tube stays bare.
    pub fn place(&self, center: Vec3, out: Vec3, radius_m: f32, normal: Vec3, ease: f32) -> (Vec3, Vec3) {
        /// Each halves what is left to find.
        const ROUNDS: u32 = 8;
        if ease == 0.0 {
            return (center + out * radius_m, normal);
        }
        let (mut least, mut most) = (0.0_f32, self.fillet_m * ease);
        let near = self.near(center + out * radius_m, most);
        for _ in 0..ROUNDS {
            let wide = f32::midpoint(least, most);
            if wide < self.width(center + out * (radius_m + wide), out, ease, near).0 {
                least = wide;
            } else {
                most = wide;
            }
        }
        let place = center + out * (radius_m + f32::midpoint(least, most));
        // On the quarter circle the normal turns from the lateral's to the parent's.
        let (_, share, parents) = self.width(place, out, ease, near);
        let turned = normal * (1.0 - share * share).sqrt() + parents * share;
        (place, turned.normalize_or(normal))
    }

    /// How far the fillet reaches out from the lateral in the direction `out` and at a place's distance
    /// from the parent, metres; which share of the quarter circle that is, 0 at the lateral's end of it
    /// and 1 at the parent's; and the parent's normal.
    ///
    /// Where both surfaces look the same way there is no corner to fill: the radius of the fillet goes
    /// with the sine of the angle between their normals, but an acute crotch keeps the whole of it.
    fn width(&self, place: Vec3, out: Vec3, ease: f32, near: Near) -> (f32, f32, Vec3) {
        let (distance, parents) = self.distance(place, near);
        let alike = parents.dot(out).clamp(0.0, 1.0);
        let fillet = self.fillet_m * ease * (1.0 - alike * alike).sqrt();
        if !(distance < fillet) {
            return (0.0, 0.0, parents);
        }
        let share = 1.0 - distance / fillet;
        if share > 1.0 {
            // Below the surface, where it is hidden, the collar is a wall that goes straight on.
            return (fillet, (1.0 - 4.0 * (share - 1.0)).max(0.0), parents);
        }
        (fillet * (1.0 - (1.0 - share * share).sqrt()), share, parents)
    }

    /// Which pieces of the parent can be nearest to places within `reach_m` of a point.
    fn near(&self, point: Vec3, reach_m: f32) -> Near {
        /// What rounding may add, as a share.
        const CARE: f32 = 1e-3;
        let pieces = self.spine.len().saturating_sub(1);
        if pieces > Near::BITS as usize {
            return EVERYWHERE;
        }
        // A piece's distance changes by as much as the place, and by what the radius changes on the way.
        let mut farthest_m = f32::INFINITY;
        let mut least_m = [0.0; Near::BITS as usize];
        for (pair, least_m) in self.spine.windows(2).zip(&mut least_m) {
            let length_m = pair[0].position.distance(pair[1].position);
            let slope = (pair[1].radius - pair[0].onward).abs() / length_m;
            let change_m = reach_m * (1.0 + if slope.is_finite() { slope } else { 0.0 });
            let (distance_m, _) = from_piece(point, &pair[0], &pair[1]);
            let care_m = CARE * (distance_m.abs() + change_m);
            *least_m = distance_m - change_m - care_m;
            farthest_m = farthest_m.min(distance_m + change_m + care_m);
        }
        (0..pieces).filter(|&i| least_m[i] <= farthest_m).fold(0, |near, i| near | (1 << i))
    }

    /// Signed distance from the parent's surface, metres, and the unit vector away from its axis. Only the near
    /// pieces of the parent are looked at.
    fn distance(&self, point: Vec3, near: Near) -> (f32, Vec3) {
        let mut nearest = (f32::INFINITY, Vec3::ZERO, 0.0);
        let mut look = |i: usize| {
            let (distance, out) = from_piece(point, &self.spine[i], &self.spine[i + 1]);
            if distance < nearest.0 {
                nearest = (distance, out, out.length());
            }
        };
        let pieces = self.spine.len().saturating_sub(1);
        if near == EVERYWHERE {
            (0..pieces).for_each(look);
        } else {
            let mut left = near;
            while left != 0 {
                look(left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        let (distance, out, length) = nearest;
        (distance, if length > 0.0 { out / length } else { Vec3::ZERO })
    }
}

/// Pieces of a spine, a bit for each.
type Near = u64;
/// All of them, however many there are.
const EVERYWHERE: Near = Near::MAX;

/// Signed distance from the surface of a piece of wood, metres, and the way out from its axis.
fn from_piece(point: Vec3, base: &Station, apex: &Station) -> (f32, Vec3) {
    let along = apex.position - base.position;
    let squared = along.length_squared();
    let from = point - base.position;
    let t = if squared > 0.0 { (from.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let out = from - along * t;
    (out.length() - (base.onward + (apex.radius - base.onward) * t), out)
}

/// Arc length, metres.
fn length(stations: &[Station]) -> f32 {
    stations.windows(2).map(|pair| pair[0].position.distance(pair[1].position)).sum()
}

/// Position, radius and direction at an arc length; the apex beyond it.
fn at(stations: &[Station], along_m: f32) -> (Vec3, f32, Vec3) {
    let mut start = 0.0;
    let mut last = (stations[0].position, stations[0].radius, Vec3::Y);
    for pair in stations.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = from.position.distance(to.position);
        let direction = (to.position - from.position).normalize_or(Vec3::Y);
        if along_m <= start + length && length > 0.0 {
            let here = from.toward(&to, (along_m - start) / length);
            return (here.position, here.radius, direction);
        }
        start += length;
        last = (to.position, to.radius, direction);
    }
    last
}
