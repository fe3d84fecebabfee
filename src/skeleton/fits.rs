//! How sure the radius of a node is that was measured on a real tree.

use linden_base::words;

words! {
    /// Where a radius comes from.
    RadiusSource {
        /// A circle through points around it.
        Measured = "measured",
        /// Measured ones below and above it on the same axis.
        Carried = "carried",
        /// The length of wood that it bears.
        Guessed = "guessed"
    }
}

/// What bears out the radius of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusFit {
    /// Where it comes from.
    pub source: RadiusSource,
    /// Points that a circle went through; 0 without one. The other numbers are of that circle, too.
    pub inliers: u32,
    /// The median distance of the points from it, metres.
    pub mad_m: f32,
    /// How much of the turn they cover.
    pub arc_rad: f32,
    /// The standard error of the radius, metres: by noise, by how circles nearby scatter, and by what no circle explains.
    pub se_m: f32,
    /// From the bark of the segment below to the nearest point, metres.
    pub gap_m: f32,
}

impl RadiusFit {
    /// A guess.
    pub const GUESSED: Self =
        Self { source: RadiusSource::Guessed, inliers: 0, mad_m: 0.0, arc_rad: 0.0, se_m: 0.0, gap_m: 0.0 };

    /// How much of the turn its points cover, degrees, as it is written: to a tenth.
    pub fn arc_deg(&self) -> f64 {
        libm::round(f64::from(self.arc_rad).to_degrees() * 10.0) / 10.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_are_written_to_a_tenth_of_a_degree() {
        for (degrees, written) in [(150.0_f64, "150"), (230.0, "230"), (123.456, "123.5"), (0.0, "0")] {
            let fit = RadiusFit { arc_rad: degrees.to_radians() as f32, ..RadiusFit::GUESSED };
            assert_eq!(
                (fit.arc_deg().to_string(), (fit.arc_deg() as f32).to_string()),
                (written.into(), written.into())
            );
        }
    }
}
