//! One pulse: the rays of its beam, their echoes, and the error of their range.

use glam::DVec3;
use linden_pipeline::random::Key;

use crate::rays::{RayEnd, Rays};
use crate::stand::{Grid, Stand};
use crate::{ScanPoint, ScannerSettings};

/// Diameter of the beam where it leaves the instrument, metres: a RIEGL VZ-400 has 7 mm and 0.35 mrad.
const EXIT_M: f64 = 0.007;

/// What is no further behind the first surface of an echo cannot be told from it, metres: the mean of both is
/// measured, a point on neither.
const RESOLUTION_M: f64 = 0.3;

/// Where the rays of a beam lie on its disc of radius 1: one in the middle, six around it, of equal area about.
const BEAM: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [0.75, 0.0],
    [0.375, 0.649_519],
    [-0.375, 0.649_519],
    [-0.75, 0.0],
    [-0.375, -0.649_519],
    [0.375, -0.649_519],
];

/// Beyond this angle of incidence (its cosine, of 80°) half of the rays come back to nobody.
const GRAZING: f64 = 0.173_648;

/// Sends the pulses of a stand.
pub struct Caster<'a> {
    /// What is looked at.
    pub rays: &'a Rays<'a>,
    /// Where from.
    pub stand: &'a Stand,
    /// How.
    pub settings: &'a ScannerSettings,
    /// The stand's number, from 0.
    pub number: u16,
    /// Of all random choices of the stand.
    pub key: Key,
}

impl Caster<'_> {
    /// The points of a row, by azimuth, of each pulse the nearest first.
    pub fn row(&self, grid: &Grid, row: u64) -> Vec<ScanPoint> {
        let mut points = Vec::new();
        let key = self.key.child(row);
        for column in 0..grid.columns {
            self.pulse(grid.direction(row, column), key.child(column), &mut points);
        }
        points
    }

    fn pulse(&self, direction: DVec3, key: Key, points: &mut Vec<ScanPoint>) {
        let eye = self.stand.eye;
        let mut ends = [None; BEAM.len()];
        if self.settings.beam_rad == 0.0 {
            ends[0] = self.came_back(eye, direction, key.child(0));
        } else {
            let (u, v) = direction.any_orthonormal_pair();
            for (number, (end, [x, y])) in (0..).zip(ends.iter_mut().zip(BEAM)) {
                let off = u * x + v * y;
                let origin = eye + off * (0.5 * EXIT_M);
                let slanted = (direction + off * (0.5 * self.settings.beam_rad)).normalize();
                *end = self.came_back(origin, slanted, key.child(number));
            }
        }
        let mut ends: Vec<RayEnd> = ends.into_iter().flatten().collect();
        ends.sort_by(|a, b| a.range_m.total_cmp(&b.range_m));
        let of_one = |a: &RayEnd, b: &RayEnd| b.range_m - a.range_m < RESOLUTION_M;
        for (number, echo) in (0..).zip(ends.chunk_by(of_one)) {
            let mean = echo.iter().map(|end| end.range_m).sum::<f64>() / echo.len() as f64;
            let off = |end: &&RayEnd| (end.range_m - mean).abs();
            let Some(nearest) = echo.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
            let range_m = mean + self.settings.noise_m * key.named("range").child(u64::from(number)).normal();
            points.push(ScanPoint {
                position: self.stand.registered(eye + direction * range_m).as_vec3(),
                truth: self.rays.truth(nearest),
                stand: self.number,
                echo: number,
            });
        }
    }

    /// Where a ray ends, if it comes back.
    fn came_back(&self, origin: DVec3, direction: DVec3, key: Key) -> Option<RayEnd> {
        let end = self.rays.first(origin, direction)?;
        let is_shown = end.triangle.is_some() || self.settings.ground;
        (is_shown && (end.cos_incidence >= GRAZING || key.unit() < 0.5)).then_some(end)
    }
}
