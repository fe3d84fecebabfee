//! Radii where points show none: by the length of wood that a node bears.
//!
//! After Real Twig (Morales & `MacFarlane` 2024, *Reducing tree volume overestimation in quantitative structure
//! models*): radii that were measured are a function of growth length, which never shrinks with it; what was not
//! measured follows that function, and below all that was measured a line (of logarithms) towards a twig.

use linden_skeleton::NO_PARENT;

use super::median::median;

/// Classes of growth length are this wide, as natural logarithms.
const CLASS: f64 = 0.4;

/// Places in a class where the radius was measured, at least.
const LEAST_PLACES: u32 = 4;

/// Wood of which fewer of the nodes that points are around show a circle, of 1, is not known: circles that are rare are such
/// as neighbouring twigs and noise have made round, and thicker than the wood.
const LEAST_SHARE: f64 = 0.3;

/// Wood that is thicker than what bears it lets expect, by more than this as a natural logarithm, is not known either: its
/// circles are put through several twigs at once.
const TOO_THICK: f64 = 0.5;

/// The exponent where nothing is measured: cross-sections add up at forks (Leonardo's rule, 0.5 where all twigs are alike);
/// scans lose some of the length of twigs, which makes it less. And its standard deviation.
const USUAL_EXPONENT: (f64, f64) = (0.45, 0.11);

/// The standard deviation of how much thicker the wood of one end of what was measured is against that of the other, as a
/// natural logarithm.
const MEASURED_SD: f64 = 0.22;

/// A twig: the length of wood that it bears, and its radius, metres (Real Twig's table of species has 0.7 to 3 mm).
const TWIG_GROWTH_M: f64 = 0.3;
const TWIG_RADIUS_M: f64 = 0.0015;

/// The standard deviation of its natural logarithm: of any species, and where it is given.
const TWIG_SD: f64 = 0.4;
const GIVEN_TWIG_SD: f64 = 0.15;

/// Between which bounds the exponent lies by which twigs thinner than all that were measured go on.
const EXPONENTS: (f64, f64) = (0.1, 0.6);

/// The exponent of trees whose twigs are all alike; and how much steeper the way to a usual twig is, where that is as likely
/// to be none of the tree's.
const LEONARDO: f64 = 0.5;
const STEEP: f64 = 0.14;

/// The thinnest twig, where none is given: of slender species half of 1.5 mm.
const THINNEST_M: f64 = 0.000_75;

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
    /// Whether its circle is a stem's, such as chance makes none.
    pub is_sure: bool,
}

/// Radius by growth length.
pub(crate) struct Allometry {
    /// Growth length and radius both rise.
    classes: Vec<Class>,
    exponent: f64,
    /// Metres; no wood is thinner.
    thinnest_m: f64,
    /// Numbers of the classes that are not known, rising.
    unknown: Vec<i64>,
}

/// The number of the class of a growth length's logarithm.
fn number(length: f64) -> i64 {
    (length / CLASS).floor() as i64
}

/// The same of a growth length.
fn class(growth_m: f64) -> i64 {
    number(libm::log(growth_m.max(1e-9)))
}

/// Wood that bears about as much, by what was measured of it.
struct Class {
    /// The logarithm of the growth length,
    length: f64,
    /// and that of the radius.
    radius: f64,
    /// How many places it stands for.
    weight: f64,
}

impl Class {
    fn merged(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        let mean = |a: f64, b: f64| (a * self.weight + b * other.weight) / weight;
        Self { length: mean(self.length, other.length), radius: mean(self.radius, other.radius), weight }
    }
}

/// Where wood ends.
#[derive(Clone, Copy)]
struct Twig {
    /// The logarithm of its radius, and the standard deviation of that.
    radius: f64,
    sd: f64,
    is_given: bool,
}

impl Twig {
    fn of(given_m: Option<f64>) -> Self {
        let (radius_m, sd) = given_m.map_or((TWIG_RADIUS_M, TWIG_SD), |radius_m| (radius_m, GIVEN_TWIG_SD));
        Self { radius: libm::log(radius_m), sd, is_given: given_m.is_some() }
    }
}

/// By which exponent of growth length radii go on from the thinnest wood that was measured: the slope from the thickest to
/// it, that from it to a twig, and the usual one, by how sure they are.
fn exponent(thinnest: &Class, thickest: &Class, twig: Twig) -> f64 {
    let squared = |x: f64| x * x;
    let (span, rise) = (thickest.length - thinnest.length, thickest.radius - thinnest.radius);
    // Where what was measured bears less than a twig there is no way to one.
    let to_twig = (thinnest.length - libm::log(TWIG_GROWTH_M)).max(0.0);
    let fall = thinnest.radius - twig.radius;
    // A slope that steep has another reason: the tree has no such twigs.
    let steepness = ((fall / to_twig - LEONARDO) / STEEP).max(0.0);
    let trust = if twig.is_given { 1.0 } else { 1.0 / (1.0 + squared(squared(steepness))) };
    let (of_span, of_twig) = (squared(1.0 / MEASURED_SD), trust * squared(1.0 / twig.sd));
    let of_usual = squared(1.0 / USUAL_EXPONENT.1);
    let sum = of_span * rise * span + of_twig * fall * to_twig + of_usual * USUAL_EXPONENT.0;
    let weight = of_span * span * span + of_twig * to_twig * to_twig + of_usual;
    (sum / weight).clamp(EXPONENTS.0, EXPONENTS.1)
}

impl Allometry {
    /// From the nodes that points are around, and the radius of twigs in metres where it is known; `None` for too few nodes.
    pub fn of(nodes: &[Looked], twig_m: Option<f64>) -> Option<Self> {
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
        // Of a stem that is seen below its crown alone most circles fail, but those that are seen are its own.
        sorted.retain(|m| {
            m.radius_m > 0.0 && (m.is_sure || unknown.binary_search(&class(m.growth_m)).is_err())
        });
        let least = LEAST_PLACES.min(places(&sorted));
        let mut measured: Vec<Class> = Vec::new();
        for same in sorted.chunk_by(is_same).filter(|same| places(same) >= least) {
            measured.push(Class {
                length: median(same.iter().map(|m| libm::log(m.growth_m)))?,
                radius: libm::log(median(same.iter().map(|m| m.radius_m))?),
                weight: f64::from(places(same)),
            });
        }
        let twig = Twig::of(twig_m);
        // From the stem outwards.
        let mut kept: Vec<Class> = Vec::new();
        for class in measured.into_iter().rev() {
            if let (Some(stem), Some(before)) = (kept.first(), kept.last()) {
                let usual = before.radius + exponent(before, stem, twig) * (class.length - before.length);
                if class.radius > usual + TOO_THICK {
                    unknown.push(number(class.length));
                    continue;
                }
            }
            kept.push(class);
        }
        unknown.sort_unstable();
        // Merged where the radius would shrink.
        let mut classes: Vec<Class> = Vec::new();
        for mut class in kept.into_iter().rev() {
            while let Some(before) = classes.pop_if(|before| before.radius > class.radius) {
                class = before.merged(&class);
            }
            classes.push(class);
        }
        let (first, last) = (classes.first()?, classes.last()?);
        let exponent = exponent(first, last, twig);
        Some(Self { classes, exponent, thinnest_m: twig_m.unwrap_or(THINNEST_M), unknown })
    }

    /// Whether wood that bears so much shows its circles.
    pub fn is_known(&self, growth_m: f64) -> bool {
        self.unknown.binary_search(&class(growth_m)).is_err()
    }

    /// Metres.
    pub fn radius_m(&self, growth_m: f64) -> f64 {
        let length = libm::log(growth_m.max(1e-4));
        let above = self.classes.partition_point(|class| class.length < length);
        let on = |class: &Class| class.radius + self.exponent * (length - class.length);
        let log = match (above.checked_sub(1).map(|i| &self.classes[i]), self.classes.get(above)) {
            (Some(a), Some(b)) => {
                a.radius + (b.radius - a.radius) * (length - a.length) / (b.length - a.length)
            }
            (Some(a), None) => on(a),
            (None, Some(b)) => on(b),
            (None, None) => return self.thinnest_m,
        };
        libm::exp(log).max(self.thinnest_m)
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
                Looked { growth_m, radius_m: law(growth_m) * times, places: 1, is_sure: false }
            })
            .collect();
        let found = Allometry::of(&measured, None).unwrap();
        let mut last = 0.0;
        for i in 0..80 {
            let growth = 0.05 * libm::pow(1.15, f64::from(i));
            let radius = found.radius_m(growth);
            assert!(radius >= last && (radius / law(growth) - 1.0).abs() < 0.12, "{growth}: {radius}");
            last = radius;
        }
        assert!(Allometry::of(&[], None).is_none());
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
                Looked { growth_m, radius_m, places, is_sure: false }
            })
            .collect();
        let found = Allometry::of(&nodes, None).unwrap();
        for growth in [0.1, 1.0, 10.0, 30.0, 100.0, 400.0] {
            assert_eq!(found.is_known(growth), growth > 50.0, "{growth}");
            let off = found.radius_m(growth) / law(growth);
            assert!((0.7..1.4).contains(&off), "{growth}: {off}");
        }
    }

    /// A few bundles of twigs far out pass for wood as thick as the stem.
    #[test]
    fn chance_circles_far_out_are_not_believed() {
        let law = |growth: f64| 0.003 * libm::pow(growth, 0.45);
        let stem = (0..60).map(|i| 600.0 + 20.0 * f64::from(i)).map(|growth_m| (growth_m, law(growth_m)));
        let bundles = (0..6).map(|i| (55.0 + 4.0 * f64::from(i), 0.8 * law(1000.0)));
        let nodes = |of: Vec<(f64, f64)>| -> Vec<Looked> {
            of.into_iter()
                .map(|(growth_m, radius_m)| Looked { growth_m, radius_m, places: 1, is_sure: false })
                .collect()
        };
        let found = Allometry::of(&nodes(stem.clone().chain(bundles).collect()), None).unwrap();
        let alone = Allometry::of(&nodes(stem.collect()), None).unwrap();
        assert!(!found.is_known(60.0) && found.is_known(700.0));
        for growth_m in [1.0, 60.0, 300.0, 1000.0] {
            assert_eq!(found.radius_m(growth_m), alone.radius_m(growth_m));
        }
    }

    /// Of a tree of which only the stem shows circles, all else follows from it and from its twigs.
    #[test]
    fn wood_that_is_too_thin_to_be_measured_tapers_to_a_twig() {
        let law = |twig_m: f64, growth_m: f64| {
            let exponent = libm::log(0.2 / twig_m) / libm::log(2000.0 / TWIG_GROWTH_M);
            0.2 * libm::pow(growth_m / 2000.0, exponent)
        };
        let off = |twig_m: f64, given: Option<f64>, growth_m: f64| {
            let measured: Vec<Looked> = (0..40)
                .map(|i| {
                    let growth_m = 2000.0 - 25.0 * f64::from(i);
                    Looked { growth_m, radius_m: law(twig_m, growth_m), places: 1, is_sure: false }
                })
                .collect();
            Allometry::of(&measured, given).unwrap().radius_m(growth_m) / law(twig_m, growth_m)
        };
        for (twig_m, growth_m) in
            [0.001, 0.0015, 0.003].into_iter().flat_map(|t| [0.5, 5.0, 50.0].map(|g| (t, g)))
        {
            let (alone, told) = (off(twig_m, None, growth_m), off(twig_m, Some(twig_m), growth_m));
            assert!((0.55..1.75).contains(&alone), "{twig_m} {growth_m}: {alone}");
            assert!((0.94..1.1).contains(&told), "{twig_m} {growth_m}: {told}");
        }
    }

    /// Wood of 2 cm with a hand of wood beyond it ends in no twig, and goes on as usual.
    #[test]
    fn trees_with_thick_ends_have_no_twigs_to_taper_to() {
        let ends = [Looked { growth_m: 0.1, radius_m: 0.01, places: 9, is_sure: false }; 9];
        let usual = 0.01 * libm::pow(0.2, USUAL_EXPONENT.0);
        let found = Allometry::of(&ends, None).unwrap().radius_m(0.02);
        assert!((found / usual - 1.0).abs() < 0.01, "{found} {usual}");
    }

    #[test]
    fn growth_length_is_all_wood_above() {
        // 0 - 1 - 2 and 1 - 3, segments of 1, 2 and 4 m.
        let parents = [NO_PARENT, 0, 1, 1];
        assert_eq!(growth_lengths_m(&parents, |n| [0.0, 1.0, 2.0, 4.0][n]), [7.0, 7.0, 2.0, 4.0]);
    }
}
