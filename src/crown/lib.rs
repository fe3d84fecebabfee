//! Crown shapes: the solids that attraction points are drawn in.
//!
//! A [`Crown`] is a solid in coordinates of its own: the centre of its base at the origin, Y up,
//! metres; planting the tree moves it onto the trunk. Each shape is one file that ends in
//! one [`Shape`] row; [`SHAPES`] lists the rows, and the command line, the schema and the help are
//! made from it. A mesh read from a file is a crown too ([`envelope::Envelope`]), without a row: its
//! dimensions are the file's.
//!
//! Every sample is uniform in volume, but for [`favor::Favored`], and depends on its key alone.
//! Crowns are put together from others by [`compound::Compound`] and moved by [`placed::PlacedCrown`].

pub mod bezier;
pub mod clumps;
pub mod compound;
pub mod cone;
pub mod cuboid;
pub mod cylinder;
pub mod dome;
pub mod ellipsoid;
pub mod entry;
pub mod envelope;
pub mod favor;
pub mod lathe;
pub mod placed;
pub mod revolution;
mod section;
pub mod shells;
pub mod skin;
pub mod solid;
pub mod sphere;
mod topology;
pub mod uneven;
pub mod weber_penn;
mod winding;

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};

use linden_base::knob::{Kind, Knob, Value, did_you_mean, nearest, printable};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

use self::skin::Skin;

/// A solid that attraction points are drawn in.
pub trait Crown: Sync + Send {
    /// A box around the solid.
    fn bounds(&self) -> Bounds;

    /// Whether a point lies in the solid (which side the surface itself counts to is not defined).
    fn contains(&self, p: DVec3) -> bool;

    /// A point of the solid, uniform in volume, that depends on `key` alone.
    fn sample(&self, key: Key) -> DVec3;

    /// Polylines that draw the solid.
    fn outline(&self) -> Vec<Vec<Vec3>>;

    /// Triangles that draw its surface.
    fn skin(&self) -> Skin;

    /// The volume in cubic metres.
    fn volume_m3(&self) -> f64;
}

impl<C: Crown + ?Sized> Crown for Arc<C> {
    fn bounds(&self) -> Bounds {
        (**self).bounds()
    }

    fn contains(&self, p: DVec3) -> bool {
        (**self).contains(p)
    }

    fn sample(&self, key: Key) -> DVec3 {
        (**self).sample(key)
    }

    fn outline(&self) -> Vec<Vec<Vec3>> {
        (**self).outline()
    }

    fn skin(&self) -> Skin {
        (**self).skin()
    }

    fn volume_m3(&self) -> f64 {
        (**self).volume_m3()
    }
}

/// All shapes that are described by knobs. A new shape is its own file and one line here.
pub const SHAPES: &[Shape] = &[
    cone::SHAPE,
    cylinder::SHAPE,
    dome::SHAPE,
    sphere::SHAPE,
    ellipsoid::SHAPE,
    weber_penn::SHAPE,
    bezier::SHAPE,
    revolution::SHAPE,
];

/// One row of [`SHAPES`].
pub struct Shape {
    /// Its name in recipes: `cone`.
    pub id: &'static str,
    /// One line: what it looks like.
    pub help: &'static str,
    /// Its dimensions.
    pub knobs: &'static [ShapeKnob],
    /// Builds the solid.
    pub build: fn(&Dimensions) -> Result<Box<dyn Crown>, CrownError>,
}

/// A dimension of a shape and its default.
pub struct ShapeKnob {
    /// Its name, range and help.
    pub knob: Knob,
    /// Its value where none is set.
    pub default: fn() -> Value,
}

/// Why a crown cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrownError {
    /// No shape of this name.
    #[error("no crown shape is called '{name}'{}; the shapes are: {}", did_you_mean(*.hint), shape_names())]
    UnknownShape {
        /// What was asked for, printable.
        name: String,
        /// A name that may be meant.
        hint: Option<&'static str>,
    },
    /// The shape is not measured by this.
    #[error("crown shape '{shape}' has no knob '{knob}'; it has: {}", .known.join(", "))]
    UnknownKnob {
        /// The shape.
        shape: &'static str,
        /// What was set, printable.
        knob: String,
        /// What it has.
        known: Vec<&'static str>,
    },
    /// A value out of its range or of the wrong kind.
    #[error("crown knob '{knob}': {problem}")]
    BadValue {
        /// The knob.
        knob: &'static str,
        /// What was wrong, with what was expected.
        problem: String,
    },
    /// The dimensions make no solid.
    #[error("crown shape '{shape}' encloses no volume to speak of: {problem}")]
    Hollow {
        /// The shape.
        shape: &'static str,
        /// Why, and what to change.
        problem: String,
    },
}

fn shape_names() -> String {
    SHAPES.iter().map(|shape| shape.id).collect::<Vec<_>>().join(", ")
}

/// The shape of a name.
///
/// # Errors
/// [`CrownError::UnknownShape`], with the nearest name.
pub fn shape(id: &str) -> Result<&'static Shape, CrownError> {
    SHAPES.iter().find(|shape| shape.id == id).ok_or_else(|| CrownError::UnknownShape {
        name: printable(id),
        hint: nearest(id, SHAPES.iter().map(|shape| shape.id)),
    })
}

impl Shape {
    /// Builds the solid from what was set; the rest takes its default.
    ///
    /// ```
    /// use linden_base::knob::Value;
    /// let cone = linden_crown::shape("cone")?.of(&[("crown_height", Value::Real(10.0))])?;
    /// assert!(cone.contains(glam::DVec3::new(0.0, 9.9, 0.0)));
    /// # Ok::<(), linden_crown::CrownError>(())
    /// ```
    ///
    /// # Errors
    /// A name that is no knob of the shape, a value out of range, or dimensions that enclose nothing.
    pub fn of(&self, set: &[(&str, Value)]) -> Result<Box<dyn Crown>, CrownError> {
        (self.build)(&Dimensions::of(self, set)?)
    }

    /// Every dimension of the shape in the order of its knobs: what was set and fits, else its default.
    /// Presets hold them so, whichever of them a document names and in what order.
    pub fn complete(&self, set: &[(&'static str, Value)]) -> Vec<(&'static str, Value)> {
        let value = |dimension: &ShapeKnob| {
            let fits = |(name, value): &&(&str, Value)| {
                *name == dimension.knob.name && dimension.knob.kind.check(value).is_ok()
            };
            set.iter().rev().find(fits).map_or_else(dimension.default, |(_, value)| value.clone())
        };
        self.knobs.iter().map(|dimension| (dimension.knob.name, value(dimension))).collect()
    }
}

/// The value of each knob of one shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimensions {
    values: Vec<(&'static str, Value)>,
}

impl Dimensions {
    /// What was set, and defaults for the rest.
    ///
    /// # Errors
    /// A name that is no knob of the shape, or a value out of its range.
    pub fn of(shape: &Shape, set: &[(&str, Value)]) -> Result<Self, CrownError> {
        if let Some((name, _)) = set.iter().find(|(name, _)| shape.knobs.iter().all(|k| k.knob.name != *name))
        {
            let known = shape.knobs.iter().map(|k| k.knob.name).collect();
            return Err(CrownError::UnknownKnob { shape: shape.id, knob: printable(name), known });
        }
        let value_of = |k: &ShapeKnob| {
            // The last setting counts, as on a command line.
            let value = set.iter().rev().find(|(name, _)| *name == k.knob.name);
            let value = value.map_or_else(k.default, |(_, value)| value.clone());
            let checked = k.knob.kind.check(&value);
            checked.map_err(|problem| CrownError::BadValue { knob: k.knob.name, problem })?;
            Ok((k.knob.name, value))
        };
        Ok(Self { values: shape.knobs.iter().map(value_of).collect::<Result<_, _>>()? })
    }

    fn value(&self, knob: &'static str) -> Option<&Value> {
        self.values.iter().find(|(name, _)| *name == knob).map(|(_, value)| value)
    }

    /// A length in metres.
    ///
    /// # Errors
    /// [`CrownError::BadValue`] when the knob holds no plain number.
    pub fn metres(&self, knob: &'static str) -> Result<f64, CrownError> {
        match self.value(knob) {
            Some(&Value::Real(x)) => Ok(x),
            other => Err(wrong_kind(knob, other, "a length in metres")),
        }
    }

    /// One of the knob's words.
    ///
    /// # Errors
    /// [`CrownError::BadValue`] when the knob holds no word.
    pub fn word(&self, knob: &'static str) -> Result<&str, CrownError> {
        match self.value(knob) {
            Some(Value::Word(word)) => Ok(word),
            other => Err(wrong_kind(knob, other, "a word")),
        }
    }

    /// Pairs height, radius in metres.
    ///
    /// # Errors
    /// [`CrownError::BadValue`] when the knob holds no profile.
    pub fn profile(&self, knob: &'static str) -> Result<&[[f64; 2]], CrownError> {
        match self.value(knob) {
            Some(Value::Profile(pairs)) => Ok(pairs),
            other => Err(wrong_kind(knob, other, "pairs height,radius; …")),
        }
    }
}

fn wrong_kind(knob: &'static str, found: Option<&Value>, expected: &str) -> CrownError {
    let found = found.map_or("nothing".to_owned(), |value| printable(&value.to_string()));
    CrownError::BadValue { knob, problem: format!("expected {expected}, found {found}") }
}

/// No crown is taller or wider: the tallest trees have 116 m.
pub const SIZE_LIMIT_M: f64 = 200.0;

/// Crowns from a bonsai's to the tallest tree's.
const SIZE: Kind = Kind::Real { min: 0.01, max: SIZE_LIMIT_M, auto: false, names: &[] };

/// `crown_height`, which several shapes share.
pub const CROWN_HEIGHT: Knob = Knob::new("crown_height", SIZE, "m", "from the crown's base to its top")
    .details(
        "The base stands on the trunk: the tree is as high as both together. A poplar's crown is four \
         times as high as wide, an old oak's wider than high.",
    )
    .see_also(&["crown_radius", "crown_base", "trunk"]);

/// `crown_radius`, which several shapes share.
pub const CROWN_RADIUS: Knob = Knob::new("crown_radius", SIZE, "m", "of the crown where it is widest")
    .details(
        "Half of the tree's spread. The same number of points fills a wider crown more thinly, and with \
         step=auto segments get longer with it.",
    )
    .see_also(&["crown_height", "points"]);

/// The three coordinates, uniform in `[0, 1)`, that one point is made of.
fn units(key: Key) -> [f64; 3] {
    [0, 1, 2].map(|axis| key.child(axis).unit())
}

/// The point at `height`, `radius` from the axis, after the fraction `turn` of a full turn.
fn around(height: f64, radius: f64, turn: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * turn);
    DVec3::new(radius * cos, height, radius * sin)
}

/// The point at `height`, `across` from the axis.
fn level(height: f64, across: DVec2) -> DVec3 {
    DVec3::new(across.x, height, across.y)
}

/// Squared distance from the Y axis.
fn radius_squared(p: DVec3) -> f64 {
    DVec2::new(p.x, p.z).length_squared()
}

/// The box around a solid of revolution.
fn round_bounds(low: f64, high: f64, radius: f64) -> Bounds {
    let (low, high, radius) = (low as f32, high as f32, radius as f32);
    Bounds { min: Vec3::new(-radius, low, -radius), max: Vec3::new(radius, high, radius) }
}

/// Draws a solid of revolution: the profile itself first, then other meridians along `profile` (height, radius) and rings of `rings`.
fn revolve(profile: &[(f64, f64)], rings: &[(f64, f64)]) -> Vec<Vec<Vec3>> {
    const MERIDIANS: u32 = 8;
    const SIDES: u32 = 48;
    let meridian = |i: u32| {
        let turn = f64::from(i) / f64::from(MERIDIANS);
        profile.iter().map(|&(height, radius)| around(height, radius, turn).as_vec3()).collect()
    };
    let ring = |&(height, radius): &(f64, f64)| {
        (0..=SIDES).map(|i| around(height, radius, f64::from(i) / f64::from(SIDES)).as_vec3()).collect()
    };
    (0..MERIDIANS).map(meridian).chain(rings.iter().map(ring)).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Counts of samples in the cells of a grid that lie wholly inside the solid (all of 5³ probes
    /// inside) are multinomial with equal chances: chi-square per degree of freedom, and how many
    /// cells. Knows nothing of how the shape draws its points.
    pub(crate) fn chi_square_per_freedom(crown: &dyn Crown, cells_per_side: usize) -> (f64, usize) {
        const POINTS: u64 = 120_000;
        let (min, size) = (crown.bounds().min.as_dvec3(), crown.bounds().size().as_dvec3());
        let cell = size / cells_per_side as f64;
        let n = cells_per_side;
        let mut counts = vec![0_u32; n * n * n];
        for i in 0..POINTS {
            let p = crown.sample(Key::new(11).child(i));
            assert!(crown.contains(p), "sample {i} at {p} lies outside");
            let at = ((p - min) / cell).floor().clamp(DVec3::ZERO, DVec3::splat(n as f64 - 1.0));
            counts[(at.x as usize * n + at.y as usize) * n + at.z as usize] += 1;
        }
        let inside = |index: usize| {
            let corner =
                min + cell * DVec3::new((index / n / n) as f64, (index / n % n) as f64, (index % n) as f64);
            (0..125).all(|k| {
                let fraction = DVec3::new(f64::from(k / 25), f64::from(k / 5 % 5), f64::from(k % 5)) / 4.0;
                crown.contains(corner + cell * (fraction * 0.999_999 + 5e-7))
            })
        };
        let expected = POINTS as f64 * cell.x * cell.y * cell.z / crown.volume_m3();
        let chosen: Vec<f64> = (0..n * n * n).filter(|&i| inside(i)).map(|i| f64::from(counts[i])).collect();
        let sum: f64 = chosen.iter().map(|&count| (count - expected) * (count - expected) / expected).sum();
        (sum / chosen.len() as f64, chosen.len())
    }

    /// As above, and fails when the points are not uniform. The statistic is near 1, with standard
    /// deviation √(2 / cells); it was checked to reject samples drawn by equal slices of height.
    pub(crate) fn assert_uniform(crown: &dyn Crown) {
        let (statistic, cells) = chi_square_per_freedom(crown, 10);
        assert!(cells >= 40, "only {cells} whole cells");
        assert!(
            (statistic - 1.0).abs() < 4.5 * (2.0 / cells as f64).sqrt(),
            "{statistic} over {cells} cells"
        );
    }

    /// The volume by points uniform in the box: knows nothing but box and `contains`. Its standard
    /// error is below 0.5 % where the solid fills a fifth of its box.
    pub(crate) fn volume_by_probes(crown: &dyn Crown) -> f64 {
        const PROBES: u64 = 200_000;
        let (min, size) = (crown.bounds().min.as_dvec3(), crown.bounds().size().as_dvec3());
        let place = |i: u64| min + size * DVec3::from(units(Key::new(29).child(i)));
        let hits = (0..PROBES).filter(|&i| crown.contains(place(i))).count();
        size.element_product() * hits as f64 / PROBES as f64
    }

    #[test]
    fn every_shape_is_filled_uniformly_and_knows_its_volume() {
        for shape in SHAPES {
            let crown = shape.of(&[]).unwrap();
            assert_uniform(&*crown);
            let probed = volume_by_probes(&*crown);
            assert!((probed / crown.volume_m3() - 1.0).abs() < 0.02, "{}: {probed}", shape.id);
        }
    }

    /// A cone whose points are drawn by equal slices of height: too many near the apex.
    struct SlicedCone(Box<dyn Crown>);

    impl Crown for SlicedCone {
        fn bounds(&self) -> Bounds {
            self.0.bounds()
        }
        fn contains(&self, p: DVec3) -> bool {
            self.0.contains(p)
        }
        fn sample(&self, key: Key) -> DVec3 {
            let [up, across, turn] = units(key);
            around(10.0 * up, 5.0 * (1.0 - up) * across.sqrt(), turn)
        }
        fn outline(&self) -> Vec<Vec<Vec3>> {
            self.0.outline()
        }

        fn skin(&self) -> Skin {
            self.0.skin()
        }
        fn volume_m3(&self) -> f64 {
            self.0.volume_m3()
        }
    }

    #[test]
    fn the_statistic_rejects_equal_slices_of_height() {
        let (statistic, _) = chi_square_per_freedom(&SlicedCone(cone::SHAPE.of(&[]).unwrap()), 10);
        assert!(statistic > 10.0, "{statistic}");
    }

    #[test]
    fn every_shape_builds_from_its_defaults_and_fills_its_box() {
        for shape in SHAPES {
            let crown = shape.of(&[]).unwrap();
            let bounds = crown.bounds();
            let (min, max) = (bounds.min.as_dvec3() - 1e-5, bounds.max.as_dvec3() + 1e-5);
            let mut seen = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for i in 0..20_000 {
                let p = crown.sample(Key::new(3).child(i));
                assert!(p.cmpge(min).all() && p.cmple(max).all(), "{}: {p}", shape.id);
                seen = (seen.0.min(p), seen.1.max(p));
            }
            let fill = (seen.1 - seen.0) / (max - min);
            assert!(fill.min_element() > 0.8, "{}: the points fill {fill} of the box", shape.id);
            for p in crown.outline().iter().flatten() {
                assert!(p.as_dvec3().cmpge(min).all() && p.as_dvec3().cmple(max).all(), "{}", shape.id);
            }
            assert!(!crown.outline().is_empty());
        }
    }

    #[test]
    fn shape_ids_and_knobs_are_unique() {
        for (i, shape) in SHAPES.iter().enumerate() {
            assert!(SHAPES[..i].iter().all(|other| other.id != shape.id));
            for (k, knob) in shape.knobs.iter().enumerate() {
                assert!(shape.knobs[..k].iter().all(|other| other.knob.name != knob.knob.name));
                assert_eq!(knob.knob.kind.check(&(knob.default)()), Ok(()), "{}", knob.knob.name);
            }
        }
    }

    #[test]
    fn errors_name_what_is_meant() {
        let error = shape("cine").err().unwrap();
        assert!(error.to_string().contains("did you mean 'cone'"), "{error}");
        let dome = shape("dome").unwrap();
        let error = dome.of(&[("crown_height", Value::Real(3.0))]).err().unwrap();
        assert!(matches!(&error, CrownError::UnknownKnob { knob, .. } if knob == "crown_height"), "{error}");
        for bad in [Value::Real(-1.0), Value::Real(f64::NAN), Value::Auto, Value::Word("wide".into())] {
            let error = dome.of(&[("crown_radius", bad)]).err().unwrap();
            assert!(matches!(error, CrownError::BadValue { knob: "crown_radius", .. }), "{error}");
        }
    }
}
