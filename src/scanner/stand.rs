//! Where the instrument stands, and which directions it looks in.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use linden_pipeline::mesh::Bounds;
use linden_pipeline::random::Key;

use crate::target::Target;
use crate::{ScannerError, ScannerSettings};

/// The lowest that an instrument on a tripod sees, radians.
const LOWEST: f64 = -PI / 3.0;

/// Radians that a stand is turned by for each metre of its error: 0.02° for 3 mm.
const TURN_PER_M: f64 = 0.02 / 180.0 * PI / 0.003;

/// One place of the instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Where its rays begin.
    pub eye: DVec3,
    /// How far its points are off, as it was registered, metres.
    pub shift: DVec3,
    /// By how much they are turned about the vertical through `eye`, radians.
    pub turn: f64,
}

impl Stand {
    /// The stands that the settings ask for: evenly round the foot of a tree, the first in any direction; spread evenly among
    /// the feet of several, for which the distance says nothing.
    ///
    /// # Errors
    /// [`ScannerError::Nothing`].
    pub fn of(target: &Target, settings: &ScannerSettings, key: Key) -> Result<Vec<Self>, ScannerError> {
        let bounds = target.bounds().ok_or(ScannerError::Nothing)?;
        let foot = target.foot().ok_or(ScannerError::Nothing)?;
        let first = key.named("azimuth").between(0.0, TAU);
        let places = if target.feet().len() > 1 {
            spread(target.feet(), settings.positions, first)
        } else {
            let away_m = settings.distance * f64::from(bounds.size().y);
            let azimuth = |number| first + TAU * f64::from(number) / f64::from(settings.positions);
            (0..settings.positions).map(|number| foot + away_m * towards(azimuth(number))).collect()
        };
        let stands = (0..).zip(places).map(|(number, place)| {
            let key = key.named("registration").child(number);
            let error = |axis: u64| settings.registration_m * key.child(axis).normal();
            let ground_m = foot.y + settings.rise() * (place.x - foot.x);
            Self {
                eye: DVec3::new(place.x, ground_m + settings.height_m, place.z),
                shift: DVec3::new(error(0), error(1), error(2)),
                turn: error(3) * TURN_PER_M,
            }
        });
        Ok(stands.collect())
    }

    /// Where a point is put that lies at `at`.
    pub fn registered(&self, at: DVec3) -> DVec3 {
        let (sin, cos) = libm::sincos(self.turn);
        let DVec3 { x, y, z } = at - self.eye;
        self.eye + DVec3::new(x * cos - z * sin, y, x * sin + z * cos) + self.shift
    }
}

/// The level unit vector of an azimuth.
fn towards(azimuth: f64) -> DVec3 {
    DVec3::new(libm::cos(azimuth), 0.0, libm::sin(azimuth))
}

/// Places among feet: a spiral of equal areas (Vogel 1979, *A better way to construct the sunflower head*) over the disc
/// round them, each moved out of the way of stems.
fn spread(feet: &[Vec3], count: u32, first: f64) -> Vec<DVec3> {
    /// An instrument stands no nearer to the middle of a stem, metres.
    const CLEAR_M: f64 = 1.2;
    let level = |foot: &Vec3| DVec3::new(f64::from(foot.x), 0.0, f64::from(foot.z));
    let middle = feet.iter().map(level).sum::<DVec3>() / feet.len() as f64;
    let radius_m = feet.iter().map(|foot| level(foot).distance(middle)).fold(0.0, f64::max);
    let turn = PI * (3.0 - libm::sqrt(5.0));
    (0..count)
        .map(|number| {
            let out_m = radius_m * libm::sqrt((f64::from(number) + 0.5) / f64::from(count));
            let mut place = middle + out_m * towards(first + turn * f64::from(number));
            // Out of the way of one stem may be in the way of another: some rounds are enough where there is room.
            for _ in 0..16 {
                let off = |foot: &DVec3| foot.distance_squared(place);
                let nearest = feet.iter().map(level).min_by(|a, b| off(a).total_cmp(&off(b)));
                let Some(nearest) = nearest.filter(|foot| foot.distance(place) < CLEAR_M) else { break };
                place = nearest + CLEAR_M * (place - nearest).try_normalize().unwrap_or(DVec3::X);
            }
            place
        })
        .collect()
}

/// The directions of a stand's pulses: rows of even elevation, in each columns of even azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Of the first row and column, radians.
    elevation: f64,
    azimuth: f64,
    step: f64,
    /// Rows.
    pub rows: u64,
    /// Pulses of a row.
    pub columns: u64,
}

impl Grid {
    /// All directions in which a box may be seen. Where it begins within a step is random, or the same directions would be
    /// looked in from all stands.
    pub fn of(stand: &Stand, seen: Bounds, settings: &ScannerSettings, key: Key) -> Self {
        let step = settings.step_deg / 180.0 * PI;
        let (azimuths, elevations) = (azimuths(stand.eye, seen), elevations(stand.eye, seen));
        let count = |(from, to): (f64, f64)| ((to - from).max(0.0) / step) as u64 + 1;
        Self {
            elevation: elevations.0 + step * (key.child(0).unit() - 0.5),
            azimuth: azimuths.0 + step * (key.child(1).unit() - 0.5),
            step,
            rows: count(elevations),
            columns: count(azimuths),
        }
    }

    /// Pulses in all.
    pub const fn pulses(&self) -> u64 {
        self.rows.saturating_mul(self.columns)
    }

    /// The direction of a pulse, a unit vector.
    pub fn direction(&self, row: u64, column: u64) -> DVec3 {
        let (sin_e, cos_e) = libm::sincos(self.elevation + self.step * row as f64);
        let (sin_a, cos_a) = libm::sincos(self.azimuth + self.step * column as f64);
        DVec3::new(cos_e * cos_a, sin_e, cos_e * sin_a)
    }
}

/// The azimuths in which a box is seen: all round from within it.
fn azimuths(eye: DVec3, seen: Bounds) -> (f64, f64) {
    let (min, max) = (seen.min.as_dvec3() - eye, seen.max.as_dvec3() - eye);
    if min.x <= 0.0 && max.x >= 0.0 && min.z <= 0.0 && max.z >= 0.0 {
        return (0.0, TAU);
    }
    let middle = libm::atan2(min.z + max.z, min.x + max.x);
    let (sin, cos) = libm::sincos(middle);
    let off = |x: f64, z: f64| libm::atan2(z * cos - x * sin, x * cos + z * sin);
    let offs = [off(min.x, min.z), off(min.x, max.z), off(max.x, min.z), off(max.x, max.z)];
    let least = offs.iter().copied().fold(0.0, f64::min);
    let most = offs.iter().copied().fold(0.0, f64::max);
    (middle + least, middle + most)
}

/// The elevations in which a box may be seen.
fn elevations(eye: DVec3, seen: Bounds) -> (f64, f64) {
    let (min, max) = (seen.min.as_dvec3() - eye, seen.max.as_dvec3() - eye);
    // Level distances to the nearest and the farthest of the box.
    let near = |low: f64, high: f64| low.max(-high).max(0.0);
    let far = |low: f64, high: f64| high.abs().max(low.abs());
    let nearest = libm::hypot(near(min.x, max.x), near(min.z, max.z));
    let farthest = libm::hypot(far(min.x, max.x), far(min.z, max.z));
    let low = libm::atan2(min.y, if min.y < 0.0 { nearest } else { farthest });
    let high = libm::atan2(max.y, if max.y > 0.0 { nearest } else { farthest });
    (low.max(LOWEST), high.clamp(LOWEST, FRAC_PI_2))
}
