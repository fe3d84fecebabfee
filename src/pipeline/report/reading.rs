//! The value of a number.

use linden_base::mesh::Bounds;
use serde::{Deserialize, Serialize};

/// The box around a tree, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Corners {
    /// The corner with the smallest coordinates.
    pub min: [f32; 3],
    /// The corner with the largest coordinates.
    pub max: [f32; 3],
}

impl From<Bounds> for Corners {
    fn from(bounds: Bounds) -> Self {
        Self { min: bounds.min.to_array(), max: bounds.max.to_array() }
    }
}

/// The value of a number, whatever its type.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Reading {
    /// It does not apply: null.
    Nothing,
    /// How many.
    Count(u64),
    /// In the number's unit.
    Real(f64),
    /// Whether.
    Yes(bool),
    /// A word.
    Text(String),
    /// How many of each.
    Counts(Vec<u64>),
    /// Of each, in the number's unit.
    Reals(Vec<f64>),
    /// Words.
    Texts(Vec<String>),
    /// A box.
    Corners(Corners),
}

impl Reading {
    /// Whether there is nothing to say: it does not apply, or is an empty list.
    pub fn is_nothing(&self) -> bool {
        match self {
            Self::Nothing => true,
            Self::Counts(list) => list.is_empty(),
            Self::Reals(list) => list.is_empty(),
            Self::Texts(list) => list.is_empty(),
            _ => false,
        }
    }

    /// The number that it is; `None` for words, lists and what does not apply.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(*count as f64),
            Self::Real(real) => Some(*real),
            _ => None,
        }
    }

    /// As a field of a table: empty where it does not apply, the items of lists joined by `;`. Numbers are the
    /// shortest that are read back as they are.
    ///
    /// ```
    /// use linden_pipeline::report::Reading;
    /// assert_eq!(Reading::Reals(vec![0.5, 1e-7]).field(), "0.5;0.0000001");
    /// assert_eq!(Reading::Nothing.field(), "");
    /// ```
    pub fn field(&self) -> String {
        fn joined(items: impl Iterator<Item = String>) -> String {
            items.collect::<Vec<_>>().join(";")
        }
        match self {
            Self::Nothing => String::new(),
            Self::Count(count) => count.to_string(),
            Self::Real(real) => real.to_string(),
            Self::Yes(is_so) => is_so.to_string(),
            Self::Text(text) => text.clone(),
            Self::Counts(list) => joined(list.iter().map(u64::to_string)),
            Self::Reals(list) => joined(list.iter().map(f64::to_string)),
            Self::Texts(list) => list.join(";"),
            Self::Corners(Corners { min, max }) => joined(min.iter().chain(max).map(f32::to_string)),
        }
    }
}

macro_rules! readings {
    ($($type:ty: $value:ident => $reading:expr),* $(,)?) => {
        $(impl From<&$type> for Reading {
            fn from($value: &$type) -> Self {
                $reading
            }
        })*
    };
}

readings! {
    usize: count => Self::Count(*count as u64),
    u32: count => Self::Count((*count).into()),
    u64: count => Self::Count(*count),
    f64: real => Self::Real(*real),
    bool: is_so => Self::Yes(*is_so),
    String: text => Self::Text(text.clone()),
    Vec<usize>: list => Self::Counts(list.iter().map(|&count| count as u64).collect()),
    Vec<u32>: list => Self::Counts(list.iter().map(|&count| count.into()).collect()),
    Vec<f64>: list => Self::Reals(list.clone()),
    Vec<String>: list => Self::Texts(list.clone()),
    Corners: corners => Self::Corners(*corners),
}

impl<T> From<&Option<T>> for Reading
where
    for<'a> &'a T: Into<Reading>,
{
    fn from(value: &Option<T>) -> Self {
        value.as_ref().map_or(Self::Nothing, Into::into)
    }
}
