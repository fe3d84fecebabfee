//! A simulated laser scanner: grown trees → the points that a scanner on a tripod measures on them, and what each
//! of them lies on.
//!
//! Takes skeletons and organs, gives points and tables; opens no file, reads no clock. The same tree and settings give
//! the same points on any number of threads: what is random is keyed by stand, row and column of a pulse.
//! Lengths are metres, Y is up.
//!
//! | module | is |
//! |---|---|
//! | [`settings`] | the instrument, its stands and its errors |
//! | [`target`] | the triangles that are scanned, and what each of them is |
//! | [`rays`] | the first triangle on a ray |
//! | [`stand`] | where the instrument stands, which directions it looks in |
//! | [`pulse`] | one pulse: the rays of its beam, their echoes, the error of their range |
//! | [`ply`], [`laz`] | points with their truth as PLY, as LAZ |
//! | [`sizes`] | what a forester measures on a tree, for the table of truth |
//!
//! ```
//! use linden_pipeline::{Quiet, grow::grow, preset::builtin, recipe::Recipe};
//! use linden_scanner::{ScannerSettings, scan, target::Target};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let recipe = Recipe::new(builtin("simple").unwrap().load()?);
//! let mut target = Target::default();
//! target.add(&grow(&recipe, &Quiet)?, &recipe.preset.dressing.tubes, false, &Quiet)?;
//! let mut settings = ScannerSettings::default();
//! (settings.positions, settings.step_deg) = (2, 1.0);
//! let scan = scan(&target, &settings, &Quiet)?;
//! assert!(scan.points.iter().all(|point| scan.truth(point).tree == 1));
//! # Ok(())
//! # }
//! ```

pub mod laz;
pub mod ply;
pub mod pulse;
pub mod rays;
pub mod settings;
pub mod sizes;
pub mod stand;
pub mod target;

use glam::Vec3;
use linden_pipeline::memory::{OverMemory, bytes_of};
use linden_pipeline::monitor::Phase;
use linden_pipeline::random::Key;
use linden_pipeline::surface::SurfaceError;
use linden_pipeline::{Cancelled, Monitor};
use rayon::prelude::*;

pub use settings::ScannerSettings;
pub use target::{Target, Truth, WhatIsHit};

use pulse::Caster;
use rays::Rays;
use stand::{Grid, Stand};

/// Pulses that one scan may send: some hours on one core.
pub const MOST_PULSES: u64 = 20_000_000_000;

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanPoint {
    /// As measured, with all errors.
    pub position: Vec3,
    /// Index into [`Scan::truths`].
    pub truth: u32,
    /// The stand that it was measured from, from 0.
    pub stand: u16,
    /// Which echo of its pulse it is, from 0, the nearest first.
    pub echo: u8,
}

/// All points of all stands: stand by stand, from below to above, in each row by azimuth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// What was measured.
    pub points: Vec<ScanPoint>,
    /// What points lie on.
    pub truths: Vec<Truth>,
    /// Where the instrument stood.
    pub stands: Vec<Stand>,
    /// Pulses that were sent.
    pub pulses: u64,
}

impl Scan {
    /// What a point lies on.
    pub fn truth(&self, point: &ScanPoint) -> Truth {
        self.truths.get(point.truth as usize).copied().unwrap_or(Truth::GROUND)
    }
}

/// Why there is no scan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScannerError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// There is no surface to be scanned.
    #[error("sweeping the surface to be scanned: {0}")]
    Surface(#[source] SurfaceError),
    /// A setting is out of its range.
    #[error("the scanner's {name} is {value}; expected {expected}")]
    Setting {
        /// As the command line has it.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What may be.
        expected: &'static str,
    },
    /// The crate las refuses to write the points.
    #[error("writing the scan as LAZ: {0}; write it as PLY")]
    Laz(String),
    /// There is nothing to look at.
    #[error("there is nothing to scan: no tree was given, or one without any wood")]
    Nothing,
    /// It would not end.
    #[error(
        "the scan would send {pulses} pulses, more than {MOST_PULSES}; take a larger step or fewer positions"
    )]
    TooFine {
        /// How many there would be.
        pulses: u64,
    },
}

linden_base::from_cancellable!(ScannerError: SurfaceError => Surface);

/// Scans a target from all stands.
///
/// # Errors
/// [`ScannerError`].
pub fn scan(
    target: &Target,
    settings: &ScannerSettings,
    monitor: &dyn Monitor,
) -> Result<Scan, ScannerError> {
    settings.check()?;
    let key = Key::new(settings.seed).named("scanner");
    let stands = Stand::of(target, settings, key)?;
    // It hides what is below, roots, be it scanned or not.
    let ground = target.ground(&stands, settings.rise());
    let seen = target.bounds_with(ground.filter(|_| settings.ground)).ok_or(ScannerError::Nothing)?;
    let grids: Vec<Grid> = stands
        .iter()
        .zip(0..)
        .map(|(stand, number)| Grid::of(stand, seen, settings, key.named("grid").child(number)))
        .collect();
    let pulses = grids.iter().fold(0_u64, |sum, grid| sum.saturating_add(grid.pulses()));
    if pulses > MOST_PULSES {
        return Err(ScannerError::TooFine { pulses });
    }
    let total: u64 = grids.iter().map(|grid| grid.rows).sum();
    let rays = Rays::new(target, ground, &stands, monitor)?;
    let mut truths = target.truths.clone();
    truths.push(Truth::GROUND);
    let mut scan = Scan { points: Vec::new(), truths, stands: Vec::new(), pulses };
    let mut done = 0;
    for (number, (stand, grid)) in (0..).zip(stands.iter().zip(&grids)) {
        let caster =
            Caster { rays: &rays, stand, settings, number, key: key.named("pulse").child(number.into()) };
        // A batch of rows at a time: between two of them memory is asked for and progress said.
        let batch = (rayon::current_num_threads() as u64 * 16).max(16);
        for first in (0..grid.rows).step_by(batch as usize) {
            monitor.check()?;
            let rows = first..(first + batch).min(grid.rows);
            done += rows.end - rows.start;
            let of_rows: Vec<Vec<ScanPoint>> =
                rows.into_par_iter().map(|row| caster.row(grid, row)).collect();
            let more: usize = of_rows.iter().map(Vec::len).sum();
            let held = bytes_of::<ScanPoint>(2 * (scan.points.len() + more));
            monitor.admit(
                "scanning",
                rays.bytes().saturating_add(held),
                "take a larger step or fewer positions",
            )?;
            scan.points.extend(of_rows.into_iter().flatten());
            monitor.advance(Phase::Scan, done, Some(total));
        }
    }
    scan.stands = stands;
    Ok(scan)
}
