//! How trees stand: a table of knobs.

use linden_base::knob::{Kind, Knob, Value, nearest, printable};

/// How trees stand. Lengths are metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// The root of all random choices.
    pub seed: u64,
    /// The side of the square.
    pub area_m: f64,
    /// No two trees stand nearer.
    pub spacing_m: f64,
    /// How many trees there are; `None`: as many as fit.
    pub trees: Option<u64>,
    /// How many trees of each kind are grown.
    pub distinct: u64,
    /// Sizes lie within this share below and above, but for trees that compete for light.
    pub size_spread: f64,
    /// The most triangles that a grown tree has in its finest level, unless its preset has a budget; 0: all
    /// that there are.
    pub triangles: u64,
    /// Whether the trees grow together, each into the space or the light that the others leave: all of one kind, which
    /// must fill a crown or grow by light. None is a copy of another then.
    pub compete: bool,
    /// How places are chosen.
    pub places: Places,
}

/// How the places of trees are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Places {
    /// Chance, on the square.
    Scattered,
    /// The trees themselves: each kind once, with its seed, where its mesh, its scan or its `root` has it.
    Given,
}

/// The words of [`Places`].
const PLACES: [&str; 2] = ["scattered", "given"];

/// The setting that counts trees.
const TREES: &str = "trees";

/// The settings that mean nothing where the places are given.
pub const SCATTERING: [&str; 6] = ["area", "spacing", TREES, "distinct", "size_spread", "compete"];

/// Enough that a tree is whole from a few metres on, and a forest of a dozen distinct ones stays well
/// below 200 MB.
const TRIANGLES: u64 = 150_000;

impl Default for Layout {
    fn default() -> Self {
        Self {
            seed: 1,
            area_m: 60.0,
            spacing_m: 5.0,
            trees: None,
            distinct: 3,
            size_spread: 0.2,
            triangles: TRIANGLES,
            compete: false,
            places: Places::Scattered,
        }
    }
}

/// A setting of a forest.
#[derive(Debug)]
pub struct ForestKnob {
    /// Name, kind and help.
    pub knob: Knob,
    read: fn(&Layout) -> Value,
    write: fn(&mut Layout, Value),
}

impl ForestKnob {
    /// What its kind leaves open.
    fn check(&self, value: &Value) -> Result<(), String> {
        match (value, counted(&self.knob)) {
            (Value::Real(n), Some(kind)) => {
                kind.parse(&n.to_string()).map(drop).map_err(|problem| format!("{problem}, or auto"))
            }
            _ => Ok(()),
        }
    }
}

/// The kind of a setting's whole numbers where its own leaves them open: trees are counted, though `auto` makes their number
/// no [`Kind::Integer`].
pub fn counted(knob: &Knob) -> Option<Kind> {
    match knob.kind {
        Kind::Real { min, max, auto: true, .. } if knob.name == TREES => {
            Some(Kind::Integer { min: min as u64, max: max as u64 })
        }
        _ => None,
    }
}

/// All settings of forests.
pub static FOREST_KNOBS: &[ForestKnob] = &[
    ForestKnob {
        knob: Knob::new(
            "area",
            Kind::Real { min: 1.0, max: 10_000.0, auto: false, names: &[] },
            "m",
            "side of the square of ground that the trees stand on",
        ),
        read: |layout| Value::Real(layout.area_m),
        write: |layout, value| layout.area_m = real(&value, layout.area_m),
    },
    ForestKnob {
        knob: Knob::new(
            "spacing",
            Kind::Real { min: 0.05, max: 1000.0, auto: false, names: &[] },
            "m",
            "no two trees stand nearer than this",
        ),
        read: |layout| Value::Real(layout.spacing_m),
        write: |layout, value| layout.spacing_m = real(&value, layout.spacing_m),
    },
    ForestKnob {
        knob: Knob::new(
            TREES,
            Kind::Real { min: 1.0, max: 1e6, auto: true, names: &[] },
            "",
            "how many trees there are; auto: as many as fit",
        ),
        read: |layout| layout.trees.map_or(Value::Auto, |n| Value::Real(n as f64)),
        write: |layout, value| {
            layout.trees = if let Value::Real(n) = value { Some(libm::round(n) as u64) } else { None };
        },
    },
    ForestKnob {
        knob: Knob::new(
            "distinct",
            Kind::Integer { min: 1, max: 64 },
            "",
            "how many different trees of each kind are grown; all others are copies of these",
        ),
        read: |layout| Value::Integer(layout.distinct),
        write: |layout, value| layout.distinct = integer(&value, layout.distinct),
    },
    ForestKnob {
        knob: Knob::new(
            "size_spread",
            Kind::Real { min: 0.0, max: 0.9, auto: false, names: &[] },
            "",
            "trees are up to this share smaller or larger than they grow",
        ),
        read: |layout| Value::Real(layout.size_spread),
        write: |layout, value| layout.size_spread = real(&value, layout.size_spread),
    },
    ForestKnob {
        knob: Knob::new(
            "triangles",
            Kind::Integer { min: 0, max: u32::MAX as u64 },
            "",
            "the most that each grown tree has in its finest level; 0: all that there are",
        ),
        read: |layout| Value::Integer(layout.triangles),
        write: |layout, value| layout.triangles = integer(&value, layout.triangles),
    },
    ForestKnob {
        knob: Knob::new(
            "compete",
            Kind::Switch,
            "",
            "whether the trees grow together, each into the space or the light that the others leave: all of one kind, none a copy",
        ),
        read: |layout| Value::Switch(layout.compete),
        write: |layout, value| {
            layout.compete = if let Value::Switch(on) = value { on } else { layout.compete }
        },
    },
    ForestKnob {
        knob: Knob::new(
            "places",
            Kind::Choice(&PLACES),
            "",
            "scattered: by chance on the square; given: each kind once, where its mesh, its scan or its root has it",
        ),
        read: |layout| {
            let word = if layout.places == Places::Given { PLACES[1] } else { PLACES[0] };
            Value::Word(word.to_owned())
        },
        write: |layout, value| {
            let is_given = matches!(value, Value::Word(word) if word == PLACES[1]);
            layout.places = if is_given { Places::Given } else { Places::Scattered };
        },
    },
    ForestKnob {
        knob: Knob::new(
            "seed",
            Kind::Integer { min: 0, max: u64::MAX },
            "",
            "the root of all random choices: places, turns, sizes and the seeds of the trees",
        ),
        read: |layout| Value::Integer(layout.seed),
        write: |layout, value| layout.seed = integer(&value, layout.seed),
    },
];

fn real(value: &Value, otherwise: f64) -> f64 {
    if let Value::Real(x) = value { *x } else { otherwise }
}

fn integer(value: &Value, otherwise: u64) -> u64 {
    if let Value::Integer(n) = value { *n } else { otherwise }
}

/// A mistake in a setting of a forest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// There is no such knob.
    #[error("a forest has no knob '{}'{}; it has: {}", printable(.name), linden_base::knob::did_you_mean(*.nearest), .known.join(", "))]
    Unknown {
        /// What was typed.
        name: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
        /// All there are.
        known: Vec<&'static str>,
    },
    /// It does not take that value.
    #[error("knob '{name}' of a forest: {problem}")]
    Value {
        /// The knob.
        name: &'static str,
        /// What was found and what was expected.
        problem: String,
    },
}

impl Layout {
    /// All knobs with their values.
    pub fn knobs(&self) -> impl Iterator<Item = (&'static ForestKnob, Value)> {
        FOREST_KNOBS.iter().map(|knob| (knob, (knob.read)(self)))
    }

    /// Whether each field has a value that its knob takes: fields are public, and a program may have put anything there.
    ///
    /// # Errors
    /// [`LayoutError::Value`] of the first that has not.
    pub fn check(&self) -> Result<(), LayoutError> {
        self.knobs().try_for_each(|(knob, value)| {
            let bad = |problem| LayoutError::Value { name: knob.knob.name, problem };
            knob.knob.kind.check(&value).map_err(bad)
        })
    }

    /// Turns a knob.
    ///
    /// # Errors
    /// An unknown name, or a value that the knob does not take.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), LayoutError> {
        let knob = Self::find(name)?;
        let bad = |problem| LayoutError::Value { name: knob.knob.name, problem };
        let value = knob.knob.kind.parse(text).map_err(bad)?;
        knob.check(&value).map_err(bad)?;
        (knob.write)(self, value);
        Ok(())
    }

    /// The knob of this name.
    pub(super) fn find(name: &str) -> Result<&'static ForestKnob, LayoutError> {
        let known = || FOREST_KNOBS.iter().map(|row| row.knob.name);
        FOREST_KNOBS.iter().find(|row| row.knob.name == name).ok_or_else(|| LayoutError::Unknown {
            name: name.to_owned(),
            nearest: nearest(name, known()),
            known: known().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_reads_what_it_writes() {
        let mut layout = Layout::default();
        let typed = [
            ("area", "12.5"),
            ("spacing", "2"),
            ("trees", "40"),
            ("distinct", "2"),
            ("size_spread", "0.5"),
            ("triangles", "2000"),
            ("compete", "true"),
            ("places", "given"),
            ("seed", "18446744073709551615"),
        ];
        assert_eq!(typed.len(), FOREST_KNOBS.len());
        for (name, text) in typed {
            layout.set(name, text).unwrap();
        }
        for ((knob, value), (name, text)) in layout.knobs().zip(typed) {
            assert_eq!((knob.knob.name, value.to_string().as_str()), (name, text));
        }
        assert!(layout.set("trees", "2.5").unwrap_err().to_string().contains("2.5 is not a whole number"));
        layout.set("trees", "auto").unwrap();
        assert_eq!(layout.trees, None);
        let said = layout.set("spacign", "2").unwrap_err().to_string();
        assert!(said.contains("did you mean 'spacing'"), "{said}");
        let said = layout.set("area", "0").unwrap_err().to_string();
        assert!(said.contains("'area'") && said.contains('1'), "{said}");
    }
}
