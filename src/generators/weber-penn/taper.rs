//! How thick a stem is along its length.

/// The radius at a share `z` of a stem's length, metres, by the paper's taper: 0 a cylinder, 1 a cone, 2 a
/// cylinder with a round end, 3 a string of balls; fractions are between.
pub fn tapered(taper: f64, radius_m: f64, length_m: f64, z: f64) -> f64 {
    let z = z.clamp(0.0, 1.0);
    let unit = if taper < 1.0 {
        taper
    } else if taper < 2.0 {
        2.0 - taper
    } else {
        0.0
    };
    let straight = radius_m * (1.0 - unit * z);
    if taper < 1.0 || straight <= 0.0 {
        return straight.max(0.0);
    }
    let left = (1.0 - z) * length_m;
    let depth = if taper < 2.0 || left < straight { 1.0 } else { taper - 2.0 };
    let across = if taper < 2.0 {
        left
    } else {
        (left - 2.0 * straight * libm::floor(left / (2.0 * straight) + 0.5)).abs()
    };
    if taper < 2.0 && across >= straight {
        return straight;
    }
    let round = (straight * straight - (across - straight) * (across - straight)).max(0.0).sqrt();
    (1.0 - depth) * straight + depth * round
}

/// Shares of a stem's length at which its outline bends, so that nodes between them show its taper; none
/// where it is straight.
pub(crate) fn bends(taper: f64, radius_m: f64, length_m: f64) -> Vec<f64> {
    /// Places in the round end, and in each ball.
    const PLACES: u32 = 6;
    const MOST_BALLS: f64 = 40.0;
    if taper <= 1.0 || !(length_m > 0.0) || !(radius_m > 0.0) {
        return Vec::new();
    }
    let end = (tapered(taper.min(2.0), radius_m, length_m, 0.9) * 1.5).min(0.5 * length_m);
    let rounded = |i: u32| {
        let t = f64::from(i) / f64::from(PLACES);
        // Closer towards the end, where it bends most.
        1.0 - end / length_m * (1.0 - t) * (1.0 - t)
    };
    let mut shares: Vec<f64> = (0..PLACES).map(rounded).collect();
    if taper > 2.0 {
        let balls = (length_m / (2.0 * radius_m)).min(MOST_BALLS);
        let count = libm::ceil(balls) as u32 * PLACES;
        shares.extend((1..count).map(|i| f64::from(i) / f64::from(count)));
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stem 10 m long and 0.5 m in radius.
    fn at(taper: f64, z: f64) -> f64 {
        tapered(taper, 0.5, 10.0, z)
    }

    #[test]
    fn the_three_plain_tapers() {
        assert_eq!([0.0, 0.5, 1.0].map(|z| at(0.0, z)), [0.5, 0.5, 0.5]);
        assert_eq!([0.0, 0.5, 1.0].map(|z| at(1.0, z)), [0.5, 0.25, 0.0]);
        // A cylinder whose last half metre is half a ball.
        assert_eq!([0.0, 0.5, 0.95, 1.0].map(|z| at(2.0, z)), [0.5, 0.5, 0.5, 0.0]);
        let inside = at(2.0, 0.975);
        assert!((inside - (0.25_f64 - 0.0625).sqrt()).abs() < 1e-12, "{inside}");
    }

    #[test]
    fn between_them_it_is_between_them() {
        assert_eq!(at(0.5, 1.0), 0.25);
        assert_eq!(at(1.5, 0.5), 0.375);
        assert_eq!(at(1.5, 1.0), 0.0);
    }

    #[test]
    fn three_is_a_string_of_balls() {
        // Balls of a metre: thickest in their middles, nothing where they touch.
        for ball in 0..10 {
            let touch = f64::from(ball) / 10.0;
            assert!(at(3.0, touch) < 1e-6, "{touch}: {}", at(3.0, touch));
            assert!((at(3.0, touch + 0.05) - 0.5).abs() < 1e-9);
        }
        assert!((at(2.5, 0.3) - 0.25).abs() < 1e-9);
    }
}
