//! The instrument, its stands and its errors.

use std::ops::RangeInclusive;

use linden_pipeline::stage::Place;

use crate::ScannerError;

/// How a tree is scanned. The defaults are those of a scanner on a tripod in still air.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ScannerSettings {
    /// Stands, evenly round the tree, or spread among several trees; 1 to 64.
    pub positions: u32,
    /// From the tree's middle to each stand, in heights of the tree; 0.1 to 20. Means nothing to several trees.
    pub distance: f64,
    /// Of the instrument above the ground at the foot of the tree, metres; 0 to 1000.
    pub height_m: f64,
    /// Between neighbouring pulses, in azimuth and in elevation, degrees; 0.001 to 10.
    pub step_deg: f64,
    /// Standard deviation of a range, metres; 0 to 1.
    pub noise_m: f64,
    /// Divergence of the beam: its whole angle, radians; 0 to 0.1. 0: a pulse is one ray without width.
    pub beam_rad: f64,
    /// Standard deviation of a stand's place as it was registered, along each axis, metres; 0 to 1. Stands are turned too:
    /// by 0.02° where this is 3 mm, and in proportion.
    pub registration_m: f64,
    /// Whether the ground at the foot of the tree gives points; it hides what is below in any case.
    pub ground: bool,
    /// By how much the ground, and what stands on it, rises along x, degrees; -60 to 60.
    pub slope_deg: f64,
    /// The root of all random choices.
    pub seed: u64,
}

impl Default for ScannerSettings {
    fn default() -> Self {
        Self {
            positions: 4,
            distance: 0.8,
            height_m: 1.6,
            step_deg: 0.06,
            noise_m: 0.002,
            beam_rad: 0.35e-3,
            registration_m: 0.003,
            ground: false,
            slope_deg: 0.0,
            seed: 1,
        }
    }
}

impl ScannerSettings {
    /// Metres that the ground rises along each metre of x.
    pub fn rise(&self) -> f64 {
        libm::tan(self.slope_deg.to_radians())
    }

    /// A place on level ground, raised to the slope.
    pub fn on_slope(&self, place: Place) -> Place {
        let mut raised = place;
        raised.position.y += self.rise() as f32 * place.position.x;
        raised
    }

    /// Whether all settings are within their ranges.
    ///
    /// # Errors
    /// [`ScannerError::Setting`] for the first that is not, in the units of the command line.
    pub fn check(&self) -> Result<(), ScannerError> {
        let Self {
            positions,
            distance,
            height_m,
            step_deg,
            noise_m,
            beam_rad,
            registration_m,
            slope_deg,
            ..
        } = *self;
        let rows: [(&str, f64, RangeInclusive<f64>, &str); 8] = [
            ("positions", positions.into(), 1.0..=64.0, "a whole number from 1 to 64"),
            ("distance", distance, 0.1..=20.0, "0.1 to 20 heights of the tree"),
            ("height", height_m, 0.0..=1000.0, "0 to 1000 m"),
            ("step", step_deg, 0.001..=10.0, "0.001 to 10 degrees"),
            ("noise", 1e3 * noise_m, 0.0..=1000.0, "0 to 1000 mm"),
            ("beam", 1e3 * beam_rad, 0.0..=100.0, "0 to 100 mrad"),
            ("registration", 1e3 * registration_m, 0.0..=1000.0, "0 to 1000 mm"),
            ("slope", slope_deg, -60.0..=60.0, "-60 to 60 degrees"),
        ];
        match rows.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
            Some((name, value, _, expected)) => Err(ScannerError::Setting { name, value, expected }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_its_range_is_named() {
        assert_eq!(ScannerSettings::default().check(), Ok(()));
        let wrong = [
            ("positions", ScannerSettings { positions: 0, ..ScannerSettings::default() }),
            ("distance", ScannerSettings { distance: f64::NAN, ..ScannerSettings::default() }),
            ("step", ScannerSettings { step_deg: 0.0, ..ScannerSettings::default() }),
            ("noise", ScannerSettings { noise_m: -0.001, ..ScannerSettings::default() }),
            ("beam", ScannerSettings { beam_rad: f64::INFINITY, ..ScannerSettings::default() }),
        ];
        for (name, settings) in wrong {
            let error = settings.check().unwrap_err();
            assert!(matches!(error, ScannerError::Setting { name: found, .. } if found == name), "{error}");
        }
    }
}
