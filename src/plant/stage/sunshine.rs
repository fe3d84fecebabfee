//! Where the sun stands at a place on a day and hour, and what of its light comes through the air.

use glam::Vec3;

use super::Sun;
use linden_base::color::luminance;

/// A moment in the year at some latitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Degrees, north above 0: -90 to 90.
    pub latitude_deg: f32,
    /// Of the year, from 1 to 366: 172 is the longest in the north.
    pub day: u16,
    /// Of the sun's own time, 0 to 24: at 12 it is highest.
    pub hour: f32,
}

/// Why there is no such moment, or no sun in it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SunError {
    /// It cannot be read.
    #[error(
        "'{0}' is no latitude, day and hour: give degrees, the day of the year and the sun's hour, like 52,172,15.5"
    )]
    Format(String),
    /// Out of range.
    #[error("{what} {value} is not {range}")]
    Range {
        /// What it is.
        what: &'static str,
        /// As given.
        value: f32,
        /// What may be given.
        range: &'static str,
    },
    /// It is night, or nearly.
    #[error(
        "the sun stands {elevation_deg:.1} degrees high at that latitude, day and hour: below 2 it gives no picture; \
         take an hour nearer to 12"
    )]
    Night {
        /// Of its middle, over the horizon.
        elevation_deg: f32,
    },
}

/// The lowest sun that gives a picture, degrees.
const LOWEST_DEG: f32 = 2.0;
/// The tilt of the earth's axis, degrees.
const TILT_DEG: f32 = 23.44;
/// How much of red, green and blue light one thickness of hazy air takes, as optical depths: Rayleigh's of 0.04, 0.1
/// and 0.2 at 650, 550 and 450 nm, and haze.
const AIR: [f32; 3] = [0.16, 0.23, 0.37];

impl Moment {
    /// Reads `latitude,day,hour` of a moment at which the sun is up.
    ///
    /// # Errors
    /// [`SunError`].
    pub fn parse(text: &str) -> Result<Self, SunError> {
        let wrong = || SunError::Format(text.chars().filter(|c| !c.is_control()).take(40).collect());
        let numbers: Vec<f32> = text
            .split(',')
            .map(|number| number.trim().parse().ok().filter(|x: &f32| x.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(wrong)?;
        let [latitude_deg, day, hour] = numbers[..] else { return Err(wrong()) };
        let range = |what, value: f32, low: f32, high: f32, range| {
            if (low..=high).contains(&value) { Ok(()) } else { Err(SunError::Range { what, value, range }) }
        };
        range("latitude", latitude_deg, -90.0, 90.0, "-90 to 90 degrees")?;
        range("day", day, 1.0, 366.0, "1 to 366")?;
        range("hour", hour, 0.0, 24.0, "0 to 24")?;
        let moment = Self { latitude_deg, day: day as u16, hour };
        moment.by_day()?;
        Ok(moment)
    }

    /// Where the sun is, a unit vector: X is east, Z south, Y up. Cooper 1969 for the declination; the hours are the
    /// sun's own, so that there is no equation of time.
    pub fn toward_sun(&self) -> Vec3 {
        let turns = (f32::from(self.day) + 284.0) / 365.0;
        let declination = TILT_DEG.to_radians() * libm::sinf(std::f32::consts::TAU * turns);
        let hour_angle = (15.0 * (self.hour - 12.0)).to_radians();
        let (sin_lat, cos_lat) = libm::sincosf(self.latitude_deg.to_radians());
        let (sin_dec, cos_dec) = libm::sincosf(declination);
        let (sin_hour, cos_hour) = libm::sincosf(hour_angle);
        let up = sin_lat * sin_dec + cos_lat * cos_dec * cos_hour;
        let south = sin_lat * cos_dec * cos_hour - cos_lat * sin_dec;
        Vec3::new(-cos_dec * sin_hour, up, south)
    }

    /// Where the sun is, if it is up.
    fn by_day(&self) -> Result<Vec3, SunError> {
        let toward = self.toward_sun();
        let elevation_deg = libm::asinf(toward.y.clamp(-1.0, 1.0)).to_degrees();
        if elevation_deg < LOWEST_DEG { Err(SunError::Night { elevation_deg }) } else { Ok(toward) }
    }

    /// The sun as it shines then, as bright as `usual` where it stands as high as that one.
    ///
    /// # Errors
    /// [`SunError::Night`].
    pub fn sun(&self, usual: &Sun) -> Result<Sun, SunError> {
        let toward = self.by_day()?;
        let light = through_air(toward.y);
        let (most, then) = (light.into_iter().fold(f32::MIN_POSITIVE, f32::max), through_air(usual.toward.y));
        Ok(Sun {
            toward,
            illuminance_lux: usual.illuminance_lux * luminance(light) / luminance(then),
            color: light.map(|channel| channel / most),
            ..*usual
        })
    }
}

/// What is left of white light that comes through the air, by the sine of its elevation.
fn through_air(sine: f32) -> [f32; 3] {
    // Kasten & Young 1989: thicknesses of air on the way.
    let degrees = libm::asinf(sine.clamp(0.0, 1.0)).to_degrees();
    let thicknesses = 1.0 / (sine.max(0.0) + 0.50572 * libm::powf(degrees + 6.07995, -1.6364));
    AIR.map(|depth| libm::expf(-depth * thicknesses))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(latitude_deg: f32, day: u16, hour: f32) -> Vec3 {
        Moment { latitude_deg, day, hour }.toward_sun()
    }

    fn elevation_deg(toward: Vec3) -> f32 {
        libm::asinf(toward.y).to_degrees()
    }

    #[test]
    fn the_sun_stands_where_almanacs_have_it() {
        // At noon its zenith distance is latitude less declination: +23.4 on 21 June, -23.4 on 21 December.
        for (latitude, day, height) in
            [(52.0, 172, 61.4), (52.0, 355, 14.6), (23.44, 172, 90.0), (0.0, 81, 90.0), (-34.0, 355, 79.4)]
        {
            let toward = at(latitude, day, 12.0);
            assert!((elevation_deg(toward) - height).abs() < 0.6, "{latitude} {day}: {toward}");
            assert!(toward.x.abs() < 1e-5 && (toward.length() - 1.0).abs() < 1e-5);
        }
        // From the south in the north, from the north in the south.
        assert!(at(52.0, 172, 12.0).z > 0.0 && at(-34.0, 355, 12.0).z < 0.0);
        // It rises in the east, and at the equinox at six everywhere.
        assert!(at(52.0, 81, 6.0).x > 0.99 && at(52.0, 81, 18.0).x < -0.99);
        assert!(elevation_deg(at(52.0, 81, 6.0)).abs() < 0.5);
        // Beyond the polar circle at midnight in June.
        assert!(at(70.0, 172, 0.0).y > 0.0 && at(60.0, 172, 0.0).y < 0.0);
    }

    #[test]
    fn a_low_sun_is_red_and_dim() {
        let usual = Sun::afternoon();
        let sun = |hour| Moment { latitude_deg: 52.0, day: 172, hour }.sun(&usual).unwrap();
        let (noon, evening) = (sun(12.0), sun(19.5));
        assert!(evening.illuminance_lux < 0.5 * noon.illuminance_lux);
        assert!(evening.color[2] < 0.6 * noon.color[2] && evening.color[0] == 1.0);
        let night = Moment::parse("52,355,20").unwrap_err();
        assert!(night.to_string().contains("nearer to 12"), "{night}");
    }

    #[test]
    fn what_is_no_moment_is_told() {
        assert_eq!(
            Moment::parse("52, 172, 15.5").unwrap(),
            Moment { latitude_deg: 52.0, day: 172, hour: 15.5 }
        );
        for (text, expected) in [
            ("", "like 52,172,15.5"),
            ("52,172", "like 52,172,15.5"),
            ("52,172,nan", "like 52,172,15.5"),
            ("95,172,12", "latitude 95 is not -90 to 90 degrees"),
            ("52,0,12", "day 0 is not 1 to 366"),
            ("52,172,25", "hour 25 is not 0 to 24"),
        ] {
            assert!(Moment::parse(text).unwrap_err().to_string().contains(expected), "{text}");
        }
    }
}
