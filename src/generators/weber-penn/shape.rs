//! How long branches are by where they leave the trunk: `ShapeRatio` of the paper, and its envelope.

use std::f64::consts::PI;

use linden_base::words;

words! {
    /// The crown's shape: the paper's numbers 0 to 8, in their order.
    CrownShape {
        /// 0: longest at the base of the crown, a fifth of that at its top.
        Conical = "conical",
        /// 1: longest in the middle.
        Spherical = "spherical",
        /// 2: longest at the base, round above.
        Hemispherical = "hemispherical",
        /// 3: all as long.
        Cylindrical = "cylindrical",
        /// 4: longest at the base, half of that at the top.
        TaperedCylindrical = "tapered-cylindrical",
        /// 5: longest at three tenths of the crown, pointed at both ends.
        Flame = "flame",
        /// 6: longest at the top.
        InverseConical = "inverse-conical",
        /// 7: longest at three tenths of the crown, half of that at both ends.
        TendFlame = "tend-flame",
        /// 8: the pruning envelope's.
        Envelope = "envelope"
    }
}

words! {
    /// Whose reading of the paper is followed where programs differ.
    Dialect {
        /// The paper's.
        Paper = "paper",
        /// That of Arbaro: conical branches shrink to nothing at the top, and the first child of every stem
        /// leaves to the same side.
        Arbaro = "arbaro"
    }
}

/// The pruning envelope: a solid of revolution about the trunk's foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// Widest radius ÷ the tree's scale.
    pub width: f64,
    /// Where it is widest: 0 at the crown's base, 1 at its top.
    pub width_peak: f64,
    /// Curvature below the widest place: 1 a cone, less is fuller.
    pub power_low: f64,
    /// Curvature above it.
    pub power_high: f64,
}

impl Envelope {
    /// The radius as a share of the widest, by the ratio 1 at the crown's base, 0 at its top.
    ///
    /// Above the widest place (r < 1 − P) `(r / (1 − P))^high`, below `((1 − r) / P)^low`. The paper prints 1 − P
    /// below too, which leaves a step for all P but ½; with P the two meet.
    pub fn ratio(&self, r: f64) -> f64 {
        if !(0.0..=1.0).contains(&r) {
            return 0.0;
        }
        let peak = self.width_peak;
        if r < 1.0 - peak {
            libm::pow(r / (1.0 - peak), self.power_high)
        } else if peak > 0.0 {
            libm::pow((1.0 - r) / peak, self.power_low)
        } else {
            0.0
        }
    }
}

impl CrownShape {
    /// The length of a branch as a share of the longest, by the ratio 1 at the crown's base, 0 at its top.
    pub fn ratio(self, r: f64, dialect: Dialect, envelope: &Envelope) -> f64 {
        let r = r.clamp(0.0, 1.0);
        match self {
            Self::Conical if dialect == Dialect::Arbaro => r,
            Self::Conical => 0.2 + 0.8 * r,
            Self::Spherical => 0.2 + 0.8 * libm::sin(PI * r),
            Self::Hemispherical => 0.2 + 0.8 * libm::sin(0.5 * PI * r),
            Self::Cylindrical => 1.0,
            Self::TaperedCylindrical => 0.5 + 0.5 * r,
            Self::Flame if r <= 0.7 => r / 0.7,
            Self::Flame => (1.0 - r) / 0.3,
            Self::InverseConical => 1.0 - 0.8 * r,
            Self::TendFlame if r <= 0.7 => 0.5 + 0.5 * r / 0.7,
            Self::TendFlame => 0.5 + 0.5 * (1.0 - r) / 0.3,
            Self::Envelope => envelope.ratio(r),
        }
    }

    /// The shape of a number of the paper's.
    pub fn of_number(number: f64) -> Option<Self> {
        let whole = libm::round(number);
        ((whole - number).abs() < 1e-6 && (0.0..9.0).contains(&whole)).then(|| Self::ALL[whole as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND: Envelope = Envelope { width: 0.5, width_peak: 0.4, power_low: 0.5, power_high: 0.5 };

    /// The paper's table, by hand, at the crown's base, its middle and its top.
    #[test]
    fn ratios_are_those_of_the_table() {
        let table = [
            (CrownShape::Conical, [1.0, 0.6, 0.2]),
            (CrownShape::Spherical, [0.2, 1.0, 0.2]),
            (CrownShape::Hemispherical, [1.0, 0.765_685_424_949_238, 0.2]),
            (CrownShape::Cylindrical, [1.0, 1.0, 1.0]),
            (CrownShape::TaperedCylindrical, [1.0, 0.75, 0.5]),
            (CrownShape::Flame, [0.0, 0.714_285_714_285_714, 0.0]),
            (CrownShape::InverseConical, [0.2, 0.6, 1.0]),
            (CrownShape::TendFlame, [0.5, 0.857_142_857_142_857, 0.5]),
            // (1 − ½) / 0.6 above, to the power of ½.
            (CrownShape::Envelope, [0.0, 0.912_870_929_175_277, 0.0]),
        ];
        for (number, (shape, expected)) in table.into_iter().enumerate() {
            assert_eq!(CrownShape::of_number(number as f64), Some(shape));
            for (r, expected) in [1.0, 0.5, 0.0].into_iter().zip(expected) {
                let found = shape.ratio(r, Dialect::Paper, &ROUND);
                assert!((found - expected).abs() < 1e-12, "{} at {r}: {found}", shape.word());
            }
        }
        assert_eq!(CrownShape::Conical.ratio(0.0, Dialect::Arbaro, &ROUND), 0.0);
        assert_eq!(CrownShape::of_number(9.0).or(CrownShape::of_number(2.5)), None);
    }

    #[test]
    fn the_envelope_has_no_step_at_its_widest_place() {
        for width_peak in [0.2, 0.4, 0.5, 0.8] {
            let envelope = Envelope { width_peak, ..ROUND };
            let at = 1.0 - width_peak;
            let (above, below) = (envelope.ratio(at - 1e-9), envelope.ratio(at + 1e-9));
            assert!(
                (above - 1.0).abs() < 1e-6 && (below - 1.0).abs() < 1e-6,
                "{width_peak}: {above} {below}"
            );
        }
        assert_eq!((ROUND.ratio(-0.01), ROUND.ratio(1.01)), (0.0, 0.0));
    }
}
