//! Radii where points show none: by the length of wood that a node bears.
//!
//! After Real Twig (Morales & `MacFarlane` 2024, *Reducing tree volume overestimation in quantitative structure
//! models*): radii that were measured are a function of growth length, which never shrinks with it; what was not
//! measured follows that function.

use linden_skeleton::NO_PARENT;

use super::median::median;

/// Classes of growth length are this wide, as natural logarithms.
const CLASS: f64 = 0.4;

/// Places in a class where the radius was measured, at least.
const LEAST_PLACES: u32 = 4;

/// Wood of which fewer of the nodes that points are around show a circle, of 1, is not known: circles that are rare are such
/// as neighbouring twigs and noise have made round, and thicker than the wood.
const LEAST_SHARE: f64 = 0.3;

/// The exponent where nothing is measured: cross-sections add up at forks (Leonardo's rule, 0.5 where all twigs are alike);
/// scans lose some of the length of twigs, which makes it less.
const USUAL_EXPONENT: f64 = 0.45;

/// How far apart, as a natural logarithm of growth length, measured classes tell as much about the exponent as what is usual.
const TELLING: f64 = 2.0;

/// Between which bounds the exponent lies by which twigs thinner than all that were measured go on.
const EXPONENTS: (f64, f64) = (0.1, 0.6);

/// The thinnest twig: of slender species half of 1.5 mm.
const TWIG_M: f64 = 0.000_75;

/// The length of all wood that a node bears, its own segment included, metres.
pub(crate) fn growth_lengths_m(parents: &[u32], length_m: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut growth = vec![0.0; parents.len()];
    for node in (0..parents.len()).rev() {
        let parent = parents[node];
        if parent != NO_PARENT {
            growth[node] += length_m(node);
            growth[parent as usize] += growth[node];
        }
    }
    growth
}

/// A node that points are around.
#[derive(Clone, Copy)]
pub(crate) struct Looked {
    /// The length of the wood that it bears, metres.
    pub growth_m: f64,
    /// Metres; 0 where no circle is believed.
    pub radius_m: f64,
    /// For how many places it stands: where points are few, one circle is put through a longer stretch.
    pub places: u32,
}

/// Radius by growth length.
pub(crate) struct Allometry {
    /// Logarithms of growth length and radius, both rising.
    classes: Vec<(f64, f64)>,
    exponent: f64,
    /// Numbers of the classes that are not known, rising.
    unknown: Vec<i64>,
}

/// The number of the class of a growth length.
fn class(growth_m: f64) -> i64 {
    (libm::log(growth_m.max(1e-9)) / CLASS).floor() as i64
}

impl Allometry {
    /// From the nodes that points are around; `None` for too few.
    pub fn of(nodes: &[Looked]) -> Option<Self> {
        let mut sorted: Vec<Looked> = nodes.iter().copied().filter(|m| m.growth_m > 0.0).collect();
        sorted.sort_unstable_by(|a, b| {
            a.growth_m.total_cmp(&b.growth_m).then(a.radius_m.total_cmp(&b.radius_m))
        });
        let is_same = |a: &Looked, b: &Looked| class(a.growth_m) == class(b.growth_m);
        let places = |nodes: &[Looked]| nodes.iter().map(|m| m.places).sum::<u32>();
        let mut unknown = Vec::new();
        for same in sorted.chunk_by(is_same) {
            let believed = same.iter().filter(|m| m.radius_m > 0.0).map(|m| m.places).sum::<u32>();
            if f64::from(believed) < LEAST_SHARE * f64::from(places(same)) {
                unknown.push(class(same[0].growth_m));
            }
        }
        sorted.retain(|m| m.radius_m > 0.0 && unknown.binary_search(&class(m.growth_m)).is_err());
        // Class after class: (logarithm of length, radius, weight), merged where the radius would shrink.
        let mut blocks: Vec<(f64, f64, f64)> = Vec::new();
        let least = LEAST_PLACES.min(places(&sorted));
        for same in sorted.chunk_by(is_same) {
            if places(same) < least {
                continue;
            }
            let weight = f64::from(places(same));
            let length = median(same.iter().map(|m| libm::log(m.growth_m)))?;
            let radius_m = median(same.iter().map(|m| m.radius_m))?;
            let mut block = (length, libm::log(radius_m), weight);
            while let Some(before) = blocks.pop_if(|before| before.1 > block.1) {
                let total = before.2 + block.2;
                let mean = |a: f64, b: f64| (a * before.2 + b * block.2) / total;
                block = (mean(before.0, block.0), mean(before.1, block.1), total);
            }
            blocks.push(block);
        }
        let classes: Vec<(f64, f64)> = blocks.iter().map(|b| (b.0, b.1)).collect();
        let (first, last) = (classes.first()?, classes.last()?);
        // The slope between the ends and the usual one, by how much they tell.
        let (span, rise) = (last.0 - first.0, last.1 - first.1);
        let slope = (rise * span + USUAL_EXPONENT * TELLING * TELLING) / (span * span + TELLING * TELLING);
        Some(Self { exponent: slope.clamp(EXPONENTS.0, EXPONENTS.1), classes, unknown })
    }

    /// Whether wood that bears so much shows its circles.
    pub fn is_known(&self, growth_m: f64) -> bool {
        self.unknown.binary_search(&class(growth_m)).is_err()
    }

    /// Metres.
    pub fn radius_m(&self, growth_m: f64) -> f64 {
        let length = libm::log(growth_m.max(1e-4));
        let above = self.classes.partition_point(|class| class.0 < length);
        let on = |class: (f64, f64)| class.1 + self.exponent * (length - class.0);
        let log = match (above.checked_sub(1).map(|i| self.classes[i]), self.classes.get(above)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (length - a.0) / (b.0 - a.0),
            (Some(a), None) => on(a),
            (None, Some(b)) => on(*b),
            (None, None) => return TWIG_M,
        };
        libm::exp(log).max(TWIG_M)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wood_that_bears_more_is_thicker() {
        // r = 3 mm · GL^0.4, with every seventh node three times too thick.
        let law = |growth: f64| 0.003 * libm::pow(growth, 0.4);
        let measured: Vec<Looked> = (1..2000)
            .map(|i| {
                let growth_m = 0.5 * libm::pow(1.004, f64::from(i));
                let times = if i % 7 == 0 { 3.0 } else { 1.0 };
                Looked { growth_m, radius_m: law(growth_m) * times, places: 1 }
            })
            .collect();
        let found = Allometry::of(&measured).unwrap();
        let mut last = 0.0;
        for i in 0..80 {
            let growth = 0.05 * libm::pow(1.15, f64::from(i));
            let radius = found.radius_m(growth);
            assert!(radius >= last && (radius / law(growth) - 1.0).abs() < 0.12, "{growth}: {radius}");
            last = radius;
        }
        assert!(Allometry::of(&[]).is_none());
    }

    /// Twigs that show no circle of their own, but now and then one of several together: ten times as thick.
    #[test]
    fn rare_circles_make_no_twigs_thick() {
        let law = |growth: f64| 0.003 * libm::pow(growth, 0.4);
        let nodes: Vec<Looked> = (1..2000)
            .map(|i| {
                let growth_m = 0.05 * libm::pow(1.005, f64::from(i));
                // Three in ten of such nodes show one, but those that do not stand for longer stretches.
                let (radius_m, places) = match i % 10 {
                    _ if growth_m > 50.0 => (law(growth_m), 1),
                    0..3 => (10.0 * law(growth_m), 1),
                    _ => (0.0, 2),
                };
                Looked { growth_m, radius_m, places }
            })
            .collect();
        let found = Allometry::of(&nodes).unwrap();
        for growth in [0.1, 1.0, 10.0, 30.0, 100.0, 400.0] {
            assert_eq!(found.is_known(growth), growth > 50.0, "{growth}");
            let off = found.radius_m(growth) / law(growth);
            assert!((0.7..1.4).contains(&off), "{growth}: {off}");
        }
    }

    #[test]
    fn growth_length_is_all_wood_above() {
        // 0 - 1 - 2 and 1 - 3, segments of 1, 2 and 4 m.
        let parents = [NO_PARENT, 0, 1, 1];
        assert_eq!(growth_lengths_m(&parents, |n| [0.0, 1.0, 2.0, 4.0][n]), [7.0, 7.0, 2.0, 4.0]);
    }
}
