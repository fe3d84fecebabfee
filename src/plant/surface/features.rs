//! What makes tubes wood: a foot that flares, collars where branches leave, ends that tell their story.

use super::path::Station;
use super::{Stubs, SurfaceRoots, Tubes, spread};

linden_base::words! {
    /// How an axis ends.
    #[derive(Default)]
    Ends {
        /// Drawn together to a point, one radius beyond the last node.
        #[default]
        Bud = "bud",
        /// Sawn off: a flat disc.
        Cut = "cut",
        /// Snapped: a rim of splinters round a hollow.
        Broken = "broken",
    }
}

/// Features that the surface adds to the bare tubes. By default none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// How much wider than its tube a stem's foot is, as a share of the radius.
    pub flare: f32,
    /// How high the flare reaches, metres; `None`: [`FLARE_RADII`] radii of the foot.
    pub flare_height_m: Option<f32>,
    /// Buttresses round the foot; 0: it flares evenly.
    pub flare_ridges: u32,
    /// How much of the flare is buttresses, 0 to 1.
    pub flare_depth: f32,
    /// Of flare and lobes nothing is shown that is smaller, metres; 0: all.
    pub flare_smallest_m: f32,
    /// How far the foot of a stem that stands on the ground goes on into it, in radii of the foot. A stem that leans goes
    /// as far as it needs to be closed all around, whatever this says.
    pub foot_depth: f32,
    /// How high over the foot the last of its own bark is, metres, about; 0: it has none. See [`Tubes::foot_edge`].
    pub foot_height_m: f32,
    /// How steep the ground falls towards +X, degrees: the foot and the roots follow it.
    pub ground_slope_deg: f32,
    /// Lobes round a stem, all along it; 0: it is round.
    pub lobes: u32,
    /// How far lobes stand out, as a share of the radius.
    pub lobe_depth: f32,
    /// Roots on the ground round the foot.
    pub roots: SurfaceRoots,
    /// What is left of limbs that the bole has shed.
    pub stubs: Stubs,
    /// How far the wood of an axis swells round the foot of a lateral: the fillet's radius is this
    /// share of the axis' radius there, of no more than [`COLLAR_RADII`] radii of the lateral.
    pub collar: f32,
    /// How much of its radius a twig loses between its last fork and its bud, 0 to 1.
    pub twig_taper: f32,
    /// How axes end that are thicker than `ends_above_m` there; all others end in buds.
    pub ends: Ends,
    /// Radius, metres.
    pub ends_above_m: f32,
}

impl Default for Features {
    fn default() -> Self {
        Self {
            flare: 0.0,
            flare_height_m: None,
            flare_ridges: 0,
            flare_depth: 0.6,
            flare_smallest_m: 0.0,
            foot_depth: 0.0,
            foot_height_m: 0.0,
            ground_slope_deg: 0.0,
            lobes: 0,
            lobe_depth: 0.1,
            roots: SurfaceRoots::default(),
            stubs: Stubs::default(),
            collar: 0.0,
            twig_taper: 0.0,
            ends: Ends::Bud,
            ends_above_m: 0.0,
        }
    }
}

impl Features {
    /// How far the ground falls on a metre towards +X.
    pub(super) fn fall(&self) -> f32 {
        libm::tanf(self.ground_slope_deg.to_radians())
    }
}

/// Height of a flare by default, in radii: a butt swell of a trunk 0.6 m thick reaches to about 1.5 m.
pub const FLARE_RADII: f32 = 5.0;

/// Most width of a collar, in radii of the lateral: a twig on a trunk lifts little bark.
pub const COLLAR_RADII: f32 = 2.0;

/// Rings within a flare, those of the axis aside, and the fewest where little of it is seen.
const FLARE_RINGS: usize = 10;
const FEWEST_FLARE_RINGS: usize = 2;
/// Sides of a buttress, and the fewest that show that there is one.
const RIDGE_SIDES: u32 = 12;
const FEWEST_RIDGE_SIDES: u32 = 4;
/// Sides of a lobe.
const LOBE_SIDES: u32 = 6;

/// The foot of one stem, and the lobes all along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flare {
    share: f32,
    /// 0 where the stem has none.
    lobes: u32,
    lobe_depth: f32,
    pub height_m: f32,
    ridges: u32,
    depth: f32,
    /// Rings along it.
    rings: usize,
    /// Sides of a buttress.
    ridge_sides: u32,
}

impl Flare {
    pub fn new(features: &Features, foot_radius_m: f32) -> Option<Self> {
        let height_m = features.flare_height_m.unwrap_or(foot_radius_m * FLARE_RADII);
        let Features { flare: share, flare_ridges, flare_depth: depth, flare_smallest_m, .. } = *features;
        // A curve of height h, drawn in n straight pieces, is h (π/n)² / 2 from them, about.
        let pieces = |height_m: f32| {
            std::f32::consts::PI * libm::sqrtf(0.5 * height_m / flare_smallest_m.max(f32::MIN_POSITIVE))
        };
        let swell_m = share * foot_radius_m;
        let is_ridged = depth * swell_m >= flare_smallest_m;
        let Features { lobes, lobe_depth, .. } = *features;
        let is_lobed = lobes > 0 && lobe_depth > 0.0 && lobe_depth * foot_radius_m >= flare_smallest_m;
        let is_flared = share > 0.0 && height_m > 0.0;
        (is_flared || is_lobed).then(|| Self {
            share: if is_flared { share } else { 0.0 },
            lobes: if is_lobed { lobes } else { 0 },
            lobe_depth,
            height_m: if is_flared { height_m } else { 0.0 },
            ridges: if is_ridged { flare_ridges } else { 0 },
            depth,
            rings: (pieces(swell_m) as usize).clamp(FEWEST_FLARE_RINGS, FLARE_RINGS),
            ridge_sides: (pieces(depth * swell_m) as u32).clamp(FEWEST_RIDGE_SIDES, RIDGE_SIDES),
        })
    }

    /// Widens the stations at the foot and puts more of them there.
    pub fn widen(&self, stations: &mut Vec<Station>) {
        if self.share == 0.0 {
            return;
        }
        let steps = (1..=self.rings).map(|i| {
            // Closer at the foot, where the profile bends most.
            let t = i as f32 / self.rings as f32;
            self.height_m * t * (0.4 + 0.6 * t)
        });
        spread::insert(stations, steps);
        let mut along = 0.0;
        for i in 0..stations.len() {
            if i > 0 {
                along += stations[i - 1].position.distance(stations[i].position);
            }
            stations[i].scale(self.wider(along));
        }
    }

    /// How much wider the wood is at a height, as a share of its radius.
    fn swell(&self, along_m: f32) -> f32 {
        if self.share == 0.0 {
            return 0.0;
        }
        let rest = (1.0 - along_m / self.height_m).max(0.0);
        // Steep at the ground and without a crease at the upper end.
        self.share * rest * rest * (0.15 + 0.85 * rest)
    }

    /// How many times as wide as without it the wood is at a height.
    pub fn wider(&self, along_m: f32) -> f32 {
        1.0 + self.swell(along_m)
    }

    /// Whether the foot is no circle.
    pub fn has_ridges(&self) -> bool {
        self.ridges > 0 || self.lobes > 0
    }

    /// Whether the stem is anything but a round tube at a height.
    pub fn shapes(&self, along_m: f32) -> bool {
        self.lobes > 0 || along_m < self.height_m
    }

    /// Sides that buttresses and lobes need.
    pub fn least_sides(&self, along_m: f32) -> u32 {
        let ridges = if along_m < self.height_m { self.ridges * self.ridge_sides } else { 0 };
        ridges.max(self.lobes * LOBE_SIDES)
    }

    /// Change of the mean radius by buttresses and lobes at a height and in a direction `(cos, sin)`: a factor,
    /// and its derivative by the angle.
    pub fn ridge(&self, along_m: f32, corner: (f32, f32)) -> (f32, f32) {
        let (ridge, ridge_by_angle) = self.buttress(along_m, corner);
        if self.lobes == 0 {
            return (ridge, ridge_by_angle);
        }
        // Weber & Penn 1995, section 4.1: `1 + LobeDepth · sin(Lobes · angle)`.
        let count = self.lobes as f32;
        let (sin, cos) = libm::sincosf(count * libm::atan2f(corner.1, corner.0));
        let (lobe, lobe_by_angle) = (1.0 + self.lobe_depth * sin, self.lobe_depth * count * cos);
        (ridge * lobe, ridge_by_angle * lobe + ridge * lobe_by_angle)
    }

    fn buttress(&self, along_m: f32, (cos, sin): (f32, f32)) -> (f32, f32) {
        if self.ridges == 0 || along_m >= self.height_m {
            return (1.0, 0.0);
        }
        let angle = libm::atan2f(sin, cos);
        let rest = (1.0 - along_m / self.height_m).max(0.0);
        let amplitude = self.depth * self.share * rest * rest / (1.0 + self.share * rest * rest);
        // Buttresses of a tree are neither equally far apart nor equally strong.
        let count = self.ridges as f32;
        let phase = count * angle + 0.9 * libm::sinf(angle + 1.0) + 0.5 * libm::sinf(2.0 * angle);
        let phase_by_angle = count + 0.9 * libm::cosf(angle + 1.0) + libm::cosf(2.0 * angle);
        let strength = 1.0 + 0.3 * libm::sinf(angle * 2.0 + 0.7);
        let strength_by_angle = 0.6 * libm::cosf(angle * 2.0 + 0.7);
        // Narrow crests and wide hollows: the square of a raised cosine, around its mean of 3/8.
        let raised = f32::midpoint(1.0, libm::cosf(phase));
        let wave = 2.0 * (raised * raised - 0.375);
        let wave_by_angle = -2.0 * raised * libm::sinf(phase) * phase_by_angle;
        (1.0 + amplitude * strength * wave, amplitude * (strength * wave_by_angle + strength_by_angle * wave))
    }
}

/// Lets the last stretch of equal thickness, a twig beyond its last fork, taper to its bud.
pub(super) fn taper_twig(stations: &mut [Station], taper: f32) {
    /// Relative, of radii that count as equal.
    const EQUAL: f32 = 1e-3;
    let Some(apex) = stations.last().copied() else { return };
    if taper <= 0.0 {
        return;
    }
    let thick = stations.iter().rposition(|station| station.radius > apex.radius * (1.0 + EQUAL));
    let first = thick.unwrap_or(0);
    let way = |pair: &[Station]| pair[0].position.distance(pair[1].position);
    let total: f32 = stations[first..].windows(2).map(way).sum();
    if !(total > 0.0) {
        return;
    }
    let mut along = 0.0;
    for i in first + 1..stations.len() {
        along += stations[i - 1].position.distance(stations[i].position);
        // A bud has a thickness, too.
        stations[i].scale((1.0 - taper * along / total).max(0.05));
    }
}

impl Tubes {
    /// Whether laterals have collars.
    pub fn has_collars(&self) -> bool {
        self.settled().features.collar > 0.0
    }

    /// Fillet of the junction of a lateral, metres.
    pub fn collar_m(&self, parent_radius_m: f32, lateral_radius_m: f32) -> f32 {
        self.settled().features.collar * parent_radius_m.min(COLLAR_RADII * lateral_radius_m)
    }
}
