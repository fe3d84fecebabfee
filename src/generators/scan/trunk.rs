//! The trunk first: circles through slices of the bark, from the foot up.
//!
//! Sections of a cloud that was seen from one side have their middles near the bark. A stem is thick enough for
//! circles: from one that is found above the foot the next are looked for up and down along the axis that the
//! last ones make, each near what the one before lets expect, and their centres are the axis. It ends where no circle
//! is believed over some of its height: at a fork, or where the stem gets lost in its crown.

use glam::DVec3;

use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

use super::circle::{Circle, SD_PER_MAD, consensus};
use super::foot::Foot;
use super::oval;

/// Slices in the height of the tree.
const SLICES: f64 = 120.0;

/// Points of a slice that are looked at.
const MOST_POINTS: usize = 900;

/// The first circle is looked for so far above the foot, as parts of the height.
const STARTS: [f64; 8] = [0.06, 0.05, 0.07, 0.08, 0.04, 0.1, 0.03, 0.02];

/// And also here where so much of its lowest part is hidden above ground that was seen, metres.
const STARTS_ABOVE: [f64; 4] = [0.13, 0.16, 0.2, 0.25];
const HIDDEN_M: f64 = 0.3;

/// No stem is thicker: radius ÷ height.
const STOUTEST: f64 = 0.07;

/// A circle of a stem covers this much of the turn;
const LEAST_ARC_RAD: f64 = 1.4;

/// its points lie this near to it, in radii;
const ROUND: f64 = 0.1;

/// and its radius is this sure.
const SURE: f64 = 0.1;

/// Without a circle over this part of the height the trunk has ended.
const LOST: f64 = 0.15;

/// What is nearer to the axis than so many radii, and some play, is on the trunk.
const NEAR_BARK: f64 = 1.1;

/// A trunk has at least so many circles.
const LEAST_RINGS: usize = 5;

/// Where a trunk was seen, and how thick.
#[derive(Clone, Copy, Debug)]
struct Ring {
    at: DVec3,
    radius_m: f64,
    /// Standard error; infinite where it was carried on from its neighbours.
    se_m: f64,
}

/// The axis of a trunk with its radii, from the foot up.
#[derive(Clone, Debug)]
pub(super) struct Trunk {
    rings: Vec<Ring>,
    /// Metres from the foot to each ring.
    along_m: Vec<f64>,
    /// How far above the foot the lowest circle is.
    unseen_m: f64,
    /// How far off the bark a point may lie and belong to it.
    play_m: f64,
    /// The box that all points on it lie in.
    low: DVec3,
    high: DVec3,
}

impl Trunk {
    /// Follows the stem that stands on a foot. `None` where no row of circles is believed.
    pub fn follow(
        points: &[DVec3],
        foot: &Foot,
        spacing_m: f64,
        monitor: &dyn Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let slices = Slices::new(points, foot, spacing_m);
        let above = STARTS_ABOVE.into_iter().filter(|_| foot.hidden_m > HIDDEN_M);
        for part in STARTS.into_iter().chain(above) {
            monitor.check()?;
            let Some(start) = slices.first(part) else { continue };
            let mut rings = slices.rings(start, -DVec3::Y, monitor)?;
            rings.reverse();
            rings.push(start.1);
            rings.extend(slices.rings(start, DVec3::Y, monitor)?);
            if rings.iter().filter(|ring| ring.se_m.is_finite()).count() >= LEAST_RINGS {
                return Ok(Some(Self::of(rings, foot, start.0, spacing_m)));
            }
        }
        Ok(None)
    }

    fn of(mut rings: Vec<Ring>, foot: &Foot, sd_m: f64, spacing_m: f64) -> Self {
        smooth(&mut rings);
        // Down to the ground, as it leans there.
        let low = rings[0];
        let down_m = low.at.y - foot.root.y;
        // The farther down a hidden foot is, the longer the part that says how it leans.
        let least_m = if foot.is_on_ground { down_m } else { 0.0 };
        let is_long = |ring: &&Ring| ring.at.y - low.at.y >= least_m;
        let next = rings.iter().skip(3).find(is_long).unwrap_or(&rings[rings.len() - 1]);
        let lean = (next.at - low.at) / (next.at.y - low.at.y).max(1e-6);
        let at = if down_m > 0.0 { low.at - lean * down_m } else { low.at };
        let unseen_m = down_m.max(0.0);
        if down_m > 1e-3 {
            rings.insert(0, Ring { at, se_m: f64::INFINITY, ..low });
        }
        let mut along_m = vec![0.0];
        for pair in rings.windows(2) {
            along_m.push(along_m[along_m.len() - 1] + pair[0].at.distance(pair[1].at));
        }
        let play_m = (3.0 * sd_m).max(1.5 * spacing_m);
        let thickest_m = rings.iter().map(|ring| ring.radius_m).fold(0.0, f64::max);
        let reach_m = DVec3::splat(NEAR_BARK * thickest_m + play_m);
        let low = rings.iter().map(|ring| ring.at).fold(DVec3::INFINITY, DVec3::min) - reach_m;
        let high = rings.iter().map(|ring| ring.at).fold(DVec3::NEG_INFINITY, DVec3::max) + reach_m;
        Self { rings, along_m, unseen_m, play_m, low, high }
    }

    /// In the middle of the stem, where it leaves the ground.
    pub fn foot(&self) -> DVec3 {
        self.rings[0].at
    }

    /// How much of it, from the foot up, shows no circles, metres.
    pub fn unseen_m(&self) -> f64 {
        self.unseen_m
    }

    /// How thick it is where it was seen first above the flare of its foot, metres.
    pub fn radius_m(&self) -> f64 {
        let last = self.along_m[self.along_m.len() - 1];
        let at = self.along_m.partition_point(|&along| along < (0.15 * last));
        self.rings[at.min(self.rings.len() - 1)].radius_m
    }

    /// The axis, from the foot up.
    pub fn axis(&self) -> impl Iterator<Item = DVec3> {
        self.rings.iter().map(|ring| ring.at)
    }

    /// The ring that a point on the bark is nearest to, and how far from the foot along the axis; `None` for
    /// points off the trunk.
    pub fn place(&self, p: DVec3) -> Option<(usize, f64)> {
        if p.cmplt(self.low).any() || p.cmpgt(self.high).any() {
            return None;
        }
        let last = self.rings.len() - 1;
        // Rings rise, but for stems that lie: those near in height are looked at first.
        let near = self.rings.partition_point(|ring| ring.at.y < p.y);
        let from = near.saturating_sub(4);
        let segments = from..(near + 3).min(last);
        let nearest = segments
            .map(|i| {
                let (a, b) = (self.rings[i].at, self.rings[i + 1].at);
                let along = b - a;
                let t = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
                ((a + along * t).distance(p), i, t)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (away_m, i, t) = nearest;
        let [low, high] = [self.rings[i], self.rings[i + 1]];
        let radius_m = low.radius_m + (high.radius_m - low.radius_m) * t;
        // Beyond the last ring the stem is others' business.
        let is_beyond = i + 1 == last && t >= 1.0;
        let is_on = !is_beyond && away_m <= NEAR_BARK * radius_m + self.play_m;
        is_on.then(|| {
            let along_m = self.along_m[i] + t * (self.along_m[i + 1] - self.along_m[i]);
            (if t < 0.5 { i } else { i + 1 }, along_m)
        })
    }
}

/// Centres and radii by those around them, each weighing by how sure it is.
fn smooth(rings: &mut [Ring]) {
    let given = rings.to_vec();
    for (i, ring) in rings.iter_mut().enumerate() {
        let reach = 2.min(i).min(given.len() - 1 - i);
        let around = &given[i - reach..=i + reach];
        let weight = |r: &&Ring| {
            let error_m = r.se_m + 0.01 * r.radius_m;
            if r.se_m.is_finite() { 1.0 / (error_m * error_m) } else { 0.0 }
        };
        let total: f64 = around.iter().map(|r| weight(&r)).sum();
        if total > 0.0 {
            let mean =
                |of: &dyn Fn(&Ring) -> f64| around.iter().map(|r| weight(&r) * of(r)).sum::<f64>() / total;
            ring.radius_m = mean(&|r| r.radius_m);
            // Where the axis is straight the mean of places is right for uneven weights only on the line itself.
            let place = DVec3::new(mean(&|r| r.at.x), mean(&|r| r.at.y), mean(&|r| r.at.z));
            let along = (around[around.len() - 1].at - around[0].at).normalize_or(DVec3::Y);
            ring.at += (place - ring.at).reject_from_normalized(along);
        }
    }
}

/// The points near a foot, by height.
struct Slices<'a> {
    points: Vec<DVec3>,
    foot: &'a Foot,
    thick_m: f64,
    spacing_m: f64,
}

impl<'a> Slices<'a> {
    fn new(points: &[DVec3], foot: &'a Foot, spacing_m: f64) -> Self {
        let reach = 0.3 * foot.height_m;
        let is_near = |p: &&DVec3| (p.x - foot.root.x).abs().max((p.z - foot.root.z).abs()) < reach;
        let mut points: Vec<DVec3> = points.iter().filter(is_near).copied().collect();
        points.sort_by(|a, b| a.y.total_cmp(&b.y));
        let thick_m = (foot.height_m / SLICES).max(3.0 * spacing_m);
        Self { points, foot, thick_m, spacing_m }
    }

    /// Points around a place, seen along a direction: not farther than `reach_m` off it.
    fn flat(&self, at: DVec3, along: DVec3, thick_m: f64, reach_m: f64) -> (Vec<(f64, f64)>, [DVec3; 2]) {
        let (u, v) = along.any_orthonormal_pair();
        let level = 1.0 - along.y * along.y;
        let half_m = 0.5 * thick_m + reach_m * level.max(0.0).sqrt();
        let from = self.points.partition_point(|p| p.y < at.y - half_m);
        let to = self.points.partition_point(|p| p.y <= at.y + half_m);
        let mut flat = Vec::new();
        for &p in &self.points[from..to] {
            let away = p - at;
            let (x, y) = (away.dot(u), away.dot(v));
            if away.dot(along).abs() <= 0.5 * thick_m && x * x + y * y <= reach_m * reach_m {
                flat.push((x, y));
            }
        }
        let stride = flat.len().div_ceil(MOST_POINTS).max(1);
        (flat.into_iter().step_by(stride).collect(), [u, v])
    }

    /// A circle to begin with, `part` of the height above the foot, and the standard deviation of its points.
    fn first(&self, part: f64) -> Option<(f64, Ring)> {
        let at = self.foot.root + DVec3::Y * (part * self.foot.height_m);
        let reach_m = (1.5 * self.foot.radius_m).max(1.2 * STOUTEST * self.foot.height_m);
        let (flat, [u, v]) = self.flat(at, DVec3::Y, 1.5 * self.thick_m, reach_m);
        let near_m = (0.5 * self.spacing_m).clamp(0.0003 * self.foot.height_m, 0.002 * self.foot.height_m);
        let key = Key::new(0x7472_756e).child((part * 1000.0) as u64);
        let radii = [(2.0 * self.spacing_m).max(0.001 * self.foot.height_m), STOUTEST * self.foot.height_m];
        let circle = consensus(&flat, near_m, radii, key).map(|circle| whole(&flat, circle));
        let circle = circle.filter(is_believed)?;
        let ring = Ring {
            at: at + u * circle.centre.0 + v * circle.centre.1,
            radius_m: circle.radius_m,
            se_m: circle.se_m,
        };
        Some(((SD_PER_MAD * circle.mad_m).max(0.05 * self.spacing_m), ring))
    }

    /// Circles from a first one on, up or down.
    fn rings(
        &self,
        start: (f64, Ring),
        towards: DVec3,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Ring>, Cancelled> {
        let (sd_m, first) = start;
        let (mut rings, mut believed): (Vec<Ring>, Vec<Ring>) = (vec![], vec![first]);
        let (mut at, mut along, mut radius_m, mut lost) = (first.at, towards, first.radius_m, 0);
        let most = (2.0 * self.foot.height_m / self.thick_m) as u64;
        for round in 0..most {
            monitor.check()?;
            at += along * self.thick_m;
            if towards.y < 0.0 && at.y < self.foot.root.y {
                break;
            }
            let reach_m = 1.5 * radius_m + 4.0 * sd_m;
            let (flat, [u, v]) = self.flat(at, along, 1.5 * self.thick_m, reach_m);
            let near_m = (3.0 * sd_m).max(0.02 * radius_m);
            // Towards the ground it may flare, upwards it gets thinner.
            let radii = if towards.y < 0.0 { [0.85, 1.4] } else { [0.65, 1.12] }.map(|part| part * radius_m);
            let key = Key::new(0x7472_756e).named(if towards.y < 0.0 { "down" } else { "up" }).child(round);
            let is_near = |c: &Circle| {
                let (x, y) = c.centre;
                (x * x + y * y).sqrt() <= (0.35 * radius_m).max(2.0 * sd_m)
            };
            let circle = consensus(&flat, near_m, radii, key).map(|circle| whole(&flat, circle));
            let circle = circle.filter(is_believed).filter(is_near);
            if let Some(circle) = circle {
                at += u * circle.centre.0 + v * circle.centre.1;
                radius_m += 0.4 * (circle.radius_m - radius_m);
                let ring = Ring { at, radius_m: circle.radius_m, se_m: circle.se_m };
                // What was passed over lies between.
                let before = believed[believed.len() - 1].at;
                let count = rings.len();
                for (k, ring) in rings[count - lost..].iter_mut().enumerate() {
                    ring.at = before.lerp(at, (k + 1) as f64 / (lost + 1) as f64);
                }
                rings.push(ring);
                believed.push(ring);
                let back = believed[believed.len().saturating_sub(7)].at;
                along = along.lerp((at - back).normalize_or(along), 0.5).normalize_or(towards);
                lost = 0;
            } else {
                rings.push(Ring { at, radius_m, se_m: f64::INFINITY });
                lost += 1;
                if lost as f64 * self.thick_m > LOST * self.foot.height_m {
                    break;
                }
            }
        }
        rings.truncate(rings.len() - lost);
        Ok(rings)
    }
}

/// The circle that most points lie on is one of the flanks of a stem that is an oval: then that of the oval.
fn whole(flat: &[(f64, f64)], circle: Circle) -> Circle {
    oval::of_girth(flat, &circle).unwrap_or(circle)
}

fn is_believed(circle: &Circle) -> bool {
    circle.arc_rad >= LEAST_ARC_RAD && circle.mad_m <= ROUND * circle.radius_m && circle.relative_se() <= SURE
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use std::f64::consts::PI;

    /// Bark of a leaning stem, 6 m high, 0.3 m thick at its foot, and of a limb that leaves it 3 m up.
    fn bark(turn: f64) -> Vec<DVec3> {
        let mut points = Vec::new();
        let key = Key::new(6);
        for i in 0..20_000_u64 {
            let unit = |n: u64| key.child(i).child(n).unit();
            let (h, a) = (6.0 * unit(0), turn * (unit(1) - 0.5));
            let r = 0.15 - 0.012 * h + 0.004 * (unit(2) - 0.5);
            points.push(DVec3::new(0.05 * h + r * libm::cos(a), h, r * libm::sin(a)));
            if i % 5 == 0 {
                let (l, r) = (2.0 * unit(0), 0.05);
                points.push(DVec3::new(r * libm::cos(a) + 0.15, 3.0 + 0.7 * l + r * libm::sin(a), l));
            }
        }
        points
    }

    /// All around, half and 150° of it seen: the axis is in the middle of the wood, not of the points.
    #[test]
    fn the_axis_of_a_half_seen_stem_is_in_its_middle() {
        for turn in [2.0 * PI, PI, 150.0_f64.to_radians()] {
            let points = bark(turn);
            let foot = Foot::find(&points);
            let trunk = Trunk::follow(&points, &foot, 0.012, &Quiet).unwrap().unwrap();
            let top = trunk.axis().last().unwrap();
            assert!(top.y > 5.0 && trunk.foot().y < 0.1, "{turn}: {top}");
            for (ring, along_m) in trunk.rings.iter().zip(&trunk.along_m) {
                let away = DVec3::new(ring.at.x - 0.05 * ring.at.y, 0.0, ring.at.z);
                let off_m = away.length();
                let radius_m = 0.15 - 0.012 * ring.at.y;
                assert!(off_m < 0.02, "{turn}: {off_m} off at {}", ring.at);
                assert!((ring.radius_m / radius_m - 1.0).abs() < 0.12, "{turn}: {ring:?} {radius_m}");
                assert!((along_m - ring.at.y).abs() < 0.1);
            }
            assert!(trunk.place(DVec3::new(0.1 + 0.126, 2.0, 0.0)).is_some());
            assert!(trunk.place(DVec3::new(0.15, 3.7, 1.0)).is_none());
        }
    }

    /// Seen above nettles only, on ground that is known: the axis goes straight on down to that.
    #[test]
    fn a_hidden_foot_is_below_what_is_seen_of_the_stem() {
        for from_m in [0.5, 1.0, 1.5] {
            let mut points = bark(2.0 * PI);
            points.retain(|p| p.y > from_m);
            let ground: Vec<DVec3> = (0..400_u32)
                .map(|i| DVec3::new(f64::from(i % 20) - 10.0, 0.0, f64::from(i / 20) - 10.0) * 0.3)
                .collect();
            let unknown = Foot::find(&points);
            assert!((unknown.root.y - from_m).abs() < 0.1, "{from_m}: {}", unknown.root);
            let foot = unknown.on_ground(&ground);
            let trunk = Trunk::follow(&points, &foot, 0.012, &Quiet).unwrap().unwrap();
            let DVec3 { x, y, z } = trunk.foot();
            assert!(x.abs() < 0.03 && y.abs() < 1e-6 && z.abs() < 0.03, "{from_m}: {x} {y} {z}");
            assert!((trunk.unseen_m() - from_m).abs() < 0.1, "{from_m}: {}", trunk.unseen_m());
        }
    }

    /// A stem whose section is an ellipse: the axis is its own, and the radius is the mean.
    #[test]
    fn the_axis_of_an_oval_stem_is_in_its_middle() {
        for ratio in [0.85, 0.75_f64] {
            let points: Vec<DVec3> = (0..12_000_u64)
                .map(|i| {
                    let unit = |n: u64| Key::new(7).child(i).child(n).unit();
                    let (h, a) = (6.0 * unit(0), 2.0 * PI * unit(1));
                    let r = 0.18 - 0.012 * h + 0.004 * (unit(2) - 0.5);
                    DVec3::new(r / ratio.sqrt() * libm::cos(a), h, r * ratio.sqrt() * libm::sin(a))
                })
                .collect();
            let foot = Foot::find(&points);
            let trunk = Trunk::follow(&points, &foot, 0.012, &Quiet).unwrap().unwrap();
            assert!(trunk.foot().with_y(0.0).length() < 0.02, "{ratio}: {}", trunk.foot());
            for ring in trunk.rings.iter().filter(|ring| ring.at.y < 5.0) {
                let off_m = ring.at.with_y(0.0).length();
                let radius_m = 0.18 - 0.012 * ring.at.y;
                assert!(off_m < 0.02, "{ratio}: {off_m} off at {}", ring.at);
                assert!((ring.radius_m / radius_m - 1.0).abs() < 0.1, "{ratio}: {ring:?} {radius_m}");
            }
        }
    }

    #[test]
    fn twigs_alone_are_no_trunk() {
        let points: Vec<DVec3> = (0..4000_u64)
            .map(|i| {
                let unit = |n: u64| Key::new(2).child(i).child(n).unit() - 0.5;
                DVec3::new(4.0 * unit(0), 5.0 + 5.0 * unit(1), 4.0 * unit(2))
            })
            .collect();
        assert!(Trunk::follow(&points, &Foot::find(&points), 0.05, &Quiet).unwrap().is_none());
    }
}
