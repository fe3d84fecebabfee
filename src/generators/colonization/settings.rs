//! What a tree fills, and how it grows there.

use std::collections::BTreeSet;

use linden_base::field;
use linden_base::knob::{Field, Knob, Value, integer, real, real_or_auto, set, values};
use linden_growth::GrowthSettings;

use crate::crown::solid::dimensions_of;
use crate::crown::{self, SHAPES, Shape};
use crate::part::CrownPart;
use crate::shape_knobs::CROWN;

/// Where the attraction points are, and how the tree reaches for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Colonization {
    /// The solid that the crown fills.
    pub space: Space,
    /// Parts besides: pieces of the crown, other trees, obstacles, shade. In the order of the
    /// document, which matters: each adds to or takes from what was there before.
    pub parts: Vec<CrownPart>,
    /// Height of a crown shape's base above the root, metres; `None`: on top of the trunk.
    pub crown_base_m: Option<f64>,
    /// How many attraction points are drawn in a crown.
    pub points: u32,
    /// How far points gather near the crown's surface, 0 to 1; see [`crate::crown::favor`].
    pub shell_density: f64,
    /// How far points gather at the crown's top, 0 to 1.
    pub top_density: f64,
    /// How far points gather in clumps, 0 to 1; see [`crate::crown::clumps`].
    pub clumps: f64,
    /// Distance of clumps, metres; `None`: a fifth of the crown's longest side.
    pub clump_size_m: Option<f64>,
    /// How far the crown is dented, 0 to 1; see [`crate::crown::uneven`].
    pub unevenness: f64,
    /// How it grows into the points.
    pub growth: GrowthSettings,
}

/// The solid that a crown fills.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// One of [`crown::SHAPES`], with the dimensions that were set.
    Shape {
        /// Its id.
        shape: String,
        /// What was set of its knobs.
        dimensions: Vec<(&'static str, Value)>,
    },
    /// The inside of a mesh.
    Envelope {
        /// The file, relative to the preset's.
        file: String,
    },
}

impl Space {
    /// The file that is needed.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Shape { .. } => None,
            Self::Envelope { file } => Some(file),
        }
    }

    /// A shape with every dimension at its default.
    pub fn of_shape(shape: &Shape) -> Self {
        Self::Shape { shape: shape.id.to_owned(), dimensions: shape.complete(&[]) }
    }
}

impl Colonization {
    /// The knobs of the crown, without its shape and the dimensions of that.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "crown_base",
            real_or_auto(0.0, 1e3),
            "m",
            "height of the crown's base above the root; auto: on top of the trunk",
            crown_base_m,
            details(
                "For crown shapes. Lower than the trunk's top, branches leave the upper trunk, too; higher, \
                 the trunk must come within influence of the crown. auto is the height of the trunk, and \
                 without one a quarter of the crown's height."
            ),
            see_also(&["trunk", "crown_height"])
        ),
        field!(
            "points",
            integer(1, 100_000_000),
            "points",
            "how many attraction points are drawn",
            points,
            details(
                "The grain of the crown: 800 give an open tree whose every branch shows, 12000 are the most \
                 in the figures of Runions et al. 2007 (which begin at 375), 100000 fill it with fine \
                 twigs. Growth takes time and memory in proportion. With step=auto segments shrink with the \
                 points' spacing: eight times the points, half the step."
            ),
            see_also(&["step", "kill", "waves", "shell_density"])
        ),
        field!(
            "shell_density",
            real(0.0, 1.0),
            "",
            "how far the points gather near the crown's surface; 0: evenly, 1: the heart has a twentieth of its density",
            shell_density,
            details(
                "Leaves live where light is. At 0.5 to 0.6 most branches end near the surface and the limbs \
                 inside are bare, as in a tree that stands in the open; at 1 hardly any twig ends in the \
                 heart of the crown. Depth is the distance to the surface, compared with that of the \
                 deepest place."
            ),
            see_also(&["top_density", "clumps", "points"])
        ),
        field!(
            "top_density",
            real(0.0, 1.0),
            "",
            "how far the points gather at the crown's top; 0: evenly, 1: the base has a twentieth of its density",
            top_density,
            details(
                "Density rises with the square of the height within the crown. At 0.4 the lower crown is \
                 thinner; at 1 four fifths of the points of a cylinder are in its upper half, as of a \
                 flat-topped acacia."
            ),
            see_also(&["shell_density", "clumps"])
        ),
        field!(
            "clumps",
            real(0.0, 1.0),
            "",
            "how far the points gather in clumps, as leaves do at the ends of limbs; 0: evenly, 1: a twentieth is left between them",
            clumps,
            details(
                "Each cell of a grid of clump_size has a centre somewhere in it (Worley 1996), round which \
                 points are dense up to 0.3 of that size and thin out to 0.5. 0.9 makes heads of leaves at \
                 the ends of limbs with sky between them, as of an old oak or pine; 0.5 only loosens the \
                 crown."
            ),
            see_also(&["clump_size", "shell_density", "top_density"])
        ),
        field!(
            "clump_size",
            real_or_auto(1e-3, 1e3),
            "m",
            "distance of neighbouring clumps; auto: a fifth of the crown's longest side",
            clump_size_m,
            details(
                "auto makes some 60 clumps in a crown like a ball; half as large a size makes eight times \
                 as many. Clumps smaller than a few steps cannot be told apart."
            ),
            see_also(&["clumps", "step", "unevenness"])
        ),
        field!(
            "unevenness",
            real(0.0, 1.0),
            "",
            "how far the crown is dented, another way with each seed: some boughs reach farther, and between them is sky; 0: as its shape says",
            unevenness,
            details(
                "Thirteen lobes look out of the middle of the crown, with its parts put together: the top stays, some \
                 reach a fifth farther at 1, others fall short by up to 0.45, and clefts part them; towards the base \
                 the dents fade. All points lie in what is left. 0.3 takes the compasses out of an outline, 0.5 to 0.7 \
                 is an old tree that lost limbs. Heads within the boughs are what clumps makes."
            ),
            see_also(&["clumps", "shell_density", "crown"])
        ),
    ];

    /// A space with everything else at its default.
    pub fn of(space: Space) -> Self {
        Self {
            space,
            parts: Vec::new(),
            crown_base_m: None,
            points: 2000,
            shell_density: 0.0,
            top_density: 0.0,
            clumps: 0.0,
            clump_size_m: None,
            unevenness: 0.0,
            growth: GrowthSettings::default(),
        }
    }

    /// All knobs that any crown has, in their order.
    pub(crate) fn all_knobs() -> Vec<Knob> {
        let fields = Self::FIELDS.iter().map(|field| field.knob);
        let growth =
            GrowthSettings::FIELDS.iter().chain(GrowthSettings::PLACE_FIELDS).map(|field| field.knob);
        let mut seen = BTreeSet::new();
        let dimensions = SHAPES.iter().flat_map(|shape| shape.knobs).map(|dimension| dimension.knob);
        let dimensions = dimensions.filter(|knob| seen.insert(knob.name));
        std::iter::once(CROWN).chain(fields).chain(growth).chain(dimensions).collect()
    }

    pub(crate) fn turned(&self) -> Vec<(Knob, Value)> {
        let mut all = Vec::new();
        if let Space::Shape { shape, .. } = &self.space {
            all.push((CROWN, Value::Word(shape.clone())));
        }
        all.extend(values(Self::FIELDS, self));
        all.extend(values(GrowthSettings::FIELDS, &self.growth));
        all.extend(values(GrowthSettings::PLACE_FIELDS, &self.growth));
        if let Space::Shape { shape, dimensions } = &self.space {
            all.extend(dimensions_of(shape, dimensions));
        }
        all
    }

    pub(crate) fn turn(&mut self, name: &str, value: Value) -> bool {
        if let Space::Shape { shape, dimensions } = &mut self.space {
            if let (true, Value::Word(word)) = (CROWN.is_called(name), &value) {
                // Another shape keeps the dimensions that it shares with the one before.
                if let Ok(new) = crown::shape(word) {
                    *dimensions = new.complete(dimensions);
                }
                shape.clone_from(word);
                return true;
            }
            let shape = crown::shape(shape).ok();
            let dimension = shape
                .into_iter()
                .flat_map(|shape| shape.knobs)
                .find(|dimension| dimension.knob.is_called(name));
            if let (Some(shape), Some(dimension)) = (shape, dimension) {
                dimensions.push((dimension.knob.name, value));
                *dimensions = shape.complete(dimensions);
                return true;
            }
        }
        set(Self::FIELDS, self, name, value.clone())
            || set(GrowthSettings::FIELDS, &mut self.growth, name, value.clone())
            || set(GrowthSettings::PLACE_FIELDS, &mut self.growth, name, value)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str) -> Option<&'static str> {
        let is_shape = matches!(self.space, Space::Shape { .. });
        match knob {
            "crown_base" if !is_shape => Some("it is for crown shapes, and this crown is a file"),
            "clump_size" if self.clumps == 0.0 => Some("clumps is 0"),
            "up" if self.space.file().is_none() && self.parts.iter().all(|part| part.file().is_none()) => {
                Some("no mesh and no points are read")
            }
            "origin" if is_shape && self.growth.root.is_none_or(|root| root == [0.0; 3]) => {
                Some("the tree stands on the origin anyway")
            }
            _ => self.growth.idle(knob),
        }
    }
}
