//! Where roots run: out of the trunk, over the ground and into it.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use super::host::Host;
use super::{FILLET_SIDES, Root, SurfaceRoots, heading, turn};
use crate::surface::features::Flare;
use crate::surface::path::{self, Ring, Station};
use linden_base::random::Key;

/// How high over the foot a root leaves the trunk, in radii of the trunk.
const LEAVES: f32 = 1.8;
/// How far in front of the foot it has come down to the ground, in radii of the trunk.
const COMES_DOWN: f32 = 1.1;
/// How it comes down: steeply from the trunk, then ever flatter.
const FALL: f32 = 3.2;
/// Its radius within the trunk, as a share of that where it is out of it.
const EMERGES: f32 = 0.5;
/// At this share of its run the soil has closed over it, at a rise of 0 and of 1.
const CLOSES: [f32; 2] = [0.3, 0.85];
/// How far its crest is under the ground at its end, in radii of the trunk, and in its own at its base.
const DEEP: [f32; 2] = [0.12, 0.5];
/// How high its crest is over its middle, in its radii.
const CREST: f32 = 0.95;
/// Its radius at the very end, as a share of that at its base.
const TIP: f32 = 0.11;
/// A fork's radius, as a share of that of the root there.
const FORK: f32 = 0.72;
/// How many roots fork.
const FORKING: f64 = 0.5;
/// The fillet towards the trunk, in radii of the root; that of a fork.
const FILLETS: [f32; 2] = [1.0, 0.6];
/// Under the trunk's bark, in radii of the trunk: more than rings of polygons differ from what they stand for.
const SUNK: f32 = 0.025;
/// Rings of a root at most.
pub(in crate::surface) const MOST_RINGS: usize = 64;

/// How many tubes there are at most of so many roots: each forks once.
pub(in crate::surface) const fn most_roots(count: u32) -> usize {
    2 * count as usize
}

/// A root with its rings.
pub(in crate::surface) struct Laid {
    pub rings: Vec<Ring>,
    pub root: Root,
    pub is_bent: bool,
}

/// A stem's foot, from which roots run.
pub(super) struct Foot {
    host: Arc<Host>,
    center: Vec3,
    radius_m: f32,
    /// Of the stem.
    height_m: f32,
    /// How far the ground falls on a metre towards +X.
    fall: f32,
    key: Key,
}

/// One root to be laid.
struct Run {
    key: Key,
    /// Stations before it is on the ground, and those from there on.
    stations: Vec<Station>,
    /// Its index there.
    on_ground: usize,
    heading: f32,
    base_m: f32,
    /// How far it runs on the ground, metres.
    length_m: f32,
    fork: Option<Fork>,
}

/// Where a root forks.
#[derive(Clone, Copy)]
struct Fork {
    share: f32,
    /// Radians; the root itself turns the other way.
    aside: f32,
}

impl Foot {
    pub fn new(rings: &[Ring], flare: Option<Flare>, [radius_m, fall]: [f32; 2], key: Key) -> Self {
        let near_m = 3.0 * LEAVES * radius_m;
        let low = rings.iter().take_while(|ring| ring.along < near_m).count();
        let height_m = rings.last().map_or(0.0, |ring| ring.along);
        let rings = rings[..(low + 1).min(rings.len())].to_vec();
        let center = rings.first().map_or(Vec3::ZERO, |ring| ring.center);
        Self { host: Arc::new(Host { rings, flare }), center, radius_m, height_m, fall, key }
    }

    /// The height of the ground below or above a place.
    fn ground_m(&self, place: Vec3) -> f32 {
        self.center.y - self.fall * (place.x - self.center.x)
    }

    /// As many roots as are asked for, each with its fork behind it.
    pub fn roots(
        &self,
        count: u32,
        settings: &SurfaceRoots,
        sides: u32,
        is_free: &dyn Fn(Vec3, f32) -> bool,
    ) -> Vec<Laid> {
        let mut laid = Vec::new();
        // Many roots are thin ones.
        let usual_m = self.radius_m * (1.0 / (count.max(1) as f32).sqrt()).min(0.5);
        for (index, (angle, strength)) in (0..).zip(self.headings(count)) {
            let key = self.key.child(index);
            let base_m = usual_m * strength * key.named("thickness").between(0.6, 1.15) as f32;
            let reach = settings.reach * key.named("reach").between(0.65, 1.25) as f32;
            if base_m < settings.smallest_m || !is_free(heading(angle), 0.8 * reach * self.radius_m) {
                continue;
            }
            let run = self.run(key, angle, base_m, reach, settings, sides);
            let fork = run.fork.and_then(|fork| self.fork(&run, fork, settings, sides));
            let whole = self.lay(&run, &self.host, FILLETS[0], sides);
            let Some(whole) = whole else { continue };
            let branch = fork.and_then(|fork| {
                let host = Host { rings: whole.rings.clone(), flare: None };
                self.lay(&fork, &Arc::new(host), FILLETS[1], sides)
            });
            laid.push(whole);
            laid.extend(branch);
        }
        laid
    }

    /// Where roots leave the trunk, and how strong each is against the others: on the buttresses, the strongest
    /// first, then in the widest gaps.
    fn headings(&self, count: u32) -> Vec<(f32, f32)> {
        let mut crests = self.crests();
        crests.truncate(count as usize);
        let turned = self.key.named("turn").between(0.0, f64::from(TAU)) as f32;
        let mut taken: Vec<(f32, f32)> = crests;
        if taken.is_empty() {
            // A round foot: evenly, and then not quite.
            return (0..count)
                .map(|index| {
                    let apart = TAU / count as f32;
                    let aside = self.key.named("aside").child(index.into()).between(-0.3, 0.3) as f32;
                    (turned + apart * (index as f32 + aside), 1.0)
                })
                .collect();
        }
        while taken.len() < count as usize {
            let mut angles: Vec<f32> = taken.iter().map(|&(angle, _)| angle.rem_euclid(TAU)).collect();
            angles.sort_by(f32::total_cmp);
            let gap = |i: usize| {
                let next = if i + 1 < angles.len() { angles[i + 1] } else { angles[0] + TAU };
                next - angles[i]
            };
            let widest = (1..angles.len()).fold(0, |best, i| if gap(i) > gap(best) { i } else { best });
            let within = self.key.named("between").child(taken.len() as u64).between(0.4, 0.6) as f32;
            taken.push((angles[widest] + gap(widest) * within, 0.75));
        }
        taken
    }

    /// The buttresses: where the foot reaches farthest, as directions along the ground, the strongest first.
    fn crests(&self) -> Vec<(f32, f32)> {
        const LOOKS: usize = 360;
        let (Some(flare), Some(base)) = (self.host.flare, self.host.rings.first()) else { return Vec::new() };
        if !flare.has_ridges() {
            return Vec::new();
        }
        let factor = |i: usize| {
            let (sin, cos) = libm::sincosf(TAU * (i % LOOKS) as f32 / LOOKS as f32);
            flare.ridge(base.along, (cos, sin)).0
        };
        let is_crest =
            |&i: &usize| factor(i) > 1.0 && factor(i) >= factor(i + LOOKS - 1) && factor(i) > factor(i + 1);
        let mut crests: Vec<(f32, f32)> = (0..LOOKS)
            .filter(is_crest)
            .map(|i| {
                let (sin, cos) = libm::sincosf(TAU * i as f32 / LOOKS as f32);
                let out = base.side * cos + base.tangent.cross(base.side) * sin;
                (libm::atan2f(-out.z, out.x), factor(i))
            })
            .collect();
        crests.sort_by(|a, b| b.1.total_cmp(&a.1));
        let strongest = crests.first().map_or(1.0, |crest| crest.1);
        crests.into_iter().map(|(angle, factor)| (angle, (factor / strongest).max(0.5))).collect()
    }

    /// The course of a root from within the trunk.
    fn run(&self, key: Key, angle: f32, base_m: f32, reach: f32, settings: &SurfaceRoots, sides: u32) -> Run {
        let Self { radius_m, .. } = *self;
        let between = |name: &str, low: f64, high: f64| key.named(name).between(low, high) as f32;
        let out = heading(angle);
        let leaves_m = (LEAVES * between("leaves", 0.8, 1.2) * radius_m).min(0.5 * self.height_m);
        // As thick as it is there, and a hand's breadth below the bark.
        let over_foot_m = (leaves_m - self.fall * out.x * radius_m).max(0.0);
        let within_m = self.host.reach_m(over_foot_m, out) - 1.35 * EMERGES * base_m - 0.12 * radius_m;
        let foot_m = self.host.reach_m(0.0, out);
        let down_m = foot_m + COMES_DOWN * between("down", 0.8, 1.25) * radius_m;
        let lies_m = lies(base_m * 0.85, settings.rise);
        // Where it bends most rings are closest.
        let steps = steps(sides, 12);
        let mut stations: Vec<Station> = (0..=steps)
            .map(|i| {
                let t = i as f32 / steps as f32;
                let t = t * (0.6 + 0.4 * t);
                let height = lies_m + (leaves_m - lies_m) * libm::powf(1.0 - t, FALL);
                let flat = self.center + out * (within_m + (down_m - within_m) * t);
                let place = flat.with_y(self.ground_m(flat) + height);
                let swells = EMERGES + (1.0 - EMERGES) * smooth(t / 0.65);
                Station::new(place, base_m * swells * (1.0 - 0.15 * t))
            })
            .collect();
        let on_ground = stations.len() - 1;
        let length_m = (reach * radius_m - down_m).max(1.2 * radius_m);
        let forks = key.named("forks").unit() < FORKING;
        let fork = forks.then(|| {
            let side = if key.named("side").unit() < 0.5 { -1.0 } else { 1.0 };
            Fork { share: between("fork", 0.12, 0.42), aside: side * between("aside", 0.5, 0.85) }
        });
        let mut run = Run { key, stations: Vec::new(), on_ground, heading: angle, base_m, length_m, fork };
        self.on_ground(&mut stations, &run, (0.85, 1.0), settings, sides);
        run.stations = stations;
        run
    }

    /// Goes on over the ground from the last station, which has `first` of the run's radius, and dives.
    fn on_ground(
        &self,
        stations: &mut Vec<Station>,
        run: &Run,
        (first, settles): (f32, f32),
        settings: &SurfaceRoots,
        sides: u32,
    ) {
        let Some(&from) = stations.last() else { return };
        let Run { key, base_m, length_m, .. } = *run;
        let between = |name: &str, low: f64, high: f64| key.named(name).between(low, high) as f32;
        let phase = |name: &str| between(name, 0.0, f64::from(TAU));
        let waves = Waves {
            swing: between("swing", 0.25, 0.5),
            rounds: [between("wander", 0.7, 1.4), between("wiggle", 2.2, 3.4)],
            phases: [phase("wander phase"), phase("wiggle phase")],
        };
        let rolls_m = between("roll", 2.2, 3.4) * self.radius_m.min(3.2 * base_m);
        let roll_phase = phase("roll phase");
        let high = between("high", 0.1, 0.35);
        let [buried, bare] = CLOSES;
        let closes = (buried + (bare - buried) * settings.rise) * between("closes", 0.7, 1.25);
        // Of the crest, over the ground.
        let seen_m = lies(first * base_m, settings.rise) + CREST * first * base_m;
        let deep_m = DEEP[0] * self.radius_m + DEEP[1] * base_m;
        let steps =
            steps(sides, 20).max((steps(sides, 8) as f32 * length_m / rolls_m) as usize).min(MOST_RINGS - 16);
        let begins_m = from.position.y - self.ground_m(from.position);
        let mut place = from.position;
        let mut before = 0.0;
        for i in 1..=steps {
            let u = i as f32 / steps as f32;
            let step = (u - before) * length_m;
            let middle = f32::midpoint(u, before);
            let mut angle = run.heading + waves.at(middle);
            if let Some(fork) = run.fork {
                // The two of a fork make way for one another.
                angle -= 0.35 * fork.aside * smooth((middle - fork.share) / 0.4);
            }
            place += heading(angle) * step;
            // Fast at first, as roots do close to the foot, then ever slower.
            let left = 0.45 * (1.0 - u) + 0.55 * libm::powf(1.0 - u, 3.0);
            let radius = base_m * (TIP + (first - TIP) * left);
            let knots = 1.0 + 0.09 * libm::sinf(TAU * u * length_m / (0.55 * rolls_m) + 2.0 * roll_phase);
            let rolls = libm::sinf(TAU * u * length_m / rolls_m + roll_phase) - 0.25;
            // It sinks with its crest, so that what is seen of it runs out thin and flat.
            let open = (1.0 - u / closes).max(0.0);
            let sunk = ((u - 0.8 * closes) / (1.0 - 0.8 * closes)).max(0.0);
            let crest_m = seen_m * libm::powf(open, 1.25) + high * radius * rolls * smooth(u / 0.15) * open
                - deep_m * libm::powf(sunk, 1.4);
            let lies_m = crest_m - CREST * radius;
            // A fork starts at the height of the root that it leaves.
            let settled = smooth(u / settles.max(1e-3) * 6.0);
            let height = if settles < 1.0 { begins_m * (1.0 - settled) + lies_m * settled } else { lies_m };
            place.y = self.ground_m(place) + height;
            stations.push(Station::new(place, radius * knots));
            before = u;
        }
    }

    /// The course of a fork, from the middle of its root. `None` where it would be thinner than the settings want.
    fn fork(&self, run: &Run, fork: Fork, settings: &SurfaceRoots, sides: u32) -> Option<Run> {
        let on = run.stations.len() - 1 - run.on_ground;
        let at = run.on_ground + (fork.share * on as f32) as usize;
        let (from, next) = (*run.stations.get(at)?, *run.stations.get(at + 1)?);
        let base_m = FORK * from.radius;
        if base_m < settings.smallest_m {
            return None;
        }
        let way = next.position - from.position;
        let ahead = libm::atan2f(-way.z, way.x);
        let key = run.key.named("fork");
        let length_m = run.length_m * (1.0 - fork.share) * key.named("length").between(0.6, 0.95) as f32;
        let heading = run.heading + turn(run.heading, ahead) + fork.aside;
        let mut branch =
            Run { key, stations: Vec::new(), on_ground: 0, heading, base_m, length_m, fork: None };
        let mut stations = vec![Station::new(from.position, base_m)];
        self.on_ground(&mut stations, &branch, (1.0, 0.9), settings, sides);
        branch.stations = stations;
        Some(branch)
    }

    /// Rings over a course. `None` where no two can stand.
    fn lay(&self, run: &Run, host: &Arc<Host>, fillet: f32, sides: u32) -> Option<Laid> {
        let mut stations = run.stations.clone();
        path::thicken(&mut stations, |_| sides);
        path::prepare(&mut stations, 0.0);
        let mut rings = Vec::new();
        let is_bent = path::rings(&stations, 0.0, |_| 1.5, &mut Vec::new(), &mut rings);
        let length_m = rings.last()?.along;
        let fillet_m = fillet * run.base_m;
        let is_near = |ring: &&Ring| host.near(ring.center).0 < fillet_m + 2.0 * ring.radius;
        let clear_m = rings.iter().rfind(is_near).map_or(0.0, |ring| ring.along + run.base_m);
        let phase = |name: &str| run.key.named(name).between(0.0, f64::from(TAU)) as f32;
        let upright = if run.on_ground > 0 { [1.45, 0.8] } else { [0.95, 0.8] };
        let root = Root {
            host: Arc::clone(host),
            fillet_m,
            clear_m,
            sunk_m: SUNK * if run.on_ground > 0 { self.radius_m } else { run.base_m },
            length_m,
            upright,
            phases: [phase("lump"), phase("second lump")],
            base_m: run.base_m,
            sides: FILLET_SIDES,
        };
        Some(Laid { rings, root, is_bent })
    }
}

/// How a root leaves its heading.
struct Waves {
    swing: f32,
    rounds: [f32; 2],
    phases: [f32; 2],
}

impl Waves {
    /// Radians at a share of the run: at its begin none.
    fn at(&self, u: f32) -> f32 {
        let Self { swing, rounds: [slow, fast], phases: [first, second] } = *self;
        let wave = |rounds: f32, phase: f32| libm::sinf(TAU * rounds * u + phase);
        swing * smooth(u / 0.2) * (wave(slow, first) + 0.35 * wave(fast, second))
    }
}

/// Height of the middle of a root that lies on the ground.
fn lies(radius_m: f32, rise: f32) -> f32 {
    radius_m * (1.6 * rise - 0.9)
}

/// From 0 to 1 without a corner.
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Rings for a stretch that takes `usual` at 24 sides.
fn steps(sides: u32, usual: usize) -> usize {
    (usual * sides as usize / 24).clamp(usual / 3, 2 * usual).max(2)
}
