//! How a preset's typed fields become a knob's value and back.

use crate::colonization::Meet;
use crate::knob::Value;
use crate::texture::BarkStyle;

/// A length that may be given in units of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Linden decides.
    Auto,
    /// Metres; may be infinite.
    Metres(f64),
    /// Multiples of the step.
    Steps(f64),
}

/// A field that is one of some words: the type, its words in a table, and the way back.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$own:meta])* $variant:ident = $word:literal),* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$own])* $variant),* }

        impl $name {
            /// The words of all variants.
            pub const WORDS: &[&'static str] = &[$($word),*];
        }

        impl Setting for $name {
            fn to_value(&self) -> Value {
                Value::Word(match self { $(Self::$variant => $word),* }.to_owned())
            }

            fn from_value(value: Value) -> Option<Self> {
                match String::from_value(value)?.as_str() {
                    $($word => Some(Self::$variant),)*
                    _ => None,
                }
            }
        }
    };
}

pub(super) use words;

words! {
    /// Which axis of an input file points up.
    UpAxis {
        /// The one that is usual for the format: z for XYZ, y for PLY and OBJ.
        Auto = "auto",
        /// y.
        Y = "y",
        /// z.
        Z = "z"
    }
}

words! {
    /// Where the radii of a scanned tree come from.
    ScanRadius {
        /// The points on its bark, where there are enough.
        Points = "points",
        /// The pipe model.
        Pipe = "pipe"
    }
}

words! {
    /// Whether a tree is moved to stand on the origin.
    Origin {
        /// Moved when it grows into given points, kept in a mesh.
        Auto = "auto",
        /// Moved.
        Root = "root",
        /// Kept where its input is.
        Keep = "keep"
    }
}

words! {
    /// How an L-system's plant stands.
    Habit {
        /// On one upright stem.
        Tree = "tree",
        /// On several that lean.
        Shrub = "shrub"
    }
}

words! {
    /// What a part of a crown does.
    Role {
        /// Its inside belongs to the crown of the tree above it in the document.
        Add = "add",
        /// Its inside does not.
        Subtract = "subtract",
        /// Another tree with a root of its own, which competes for the same points.
        Tree = "tree",
        /// A solid without points, which branches do not enter.
        Obstacle = "obstacle",
        /// A place where fewer points are.
        Shade = "shade"
    }
}

words! {
    /// Which attraction points pull at a node.
    Pull {
        /// Those to which it is the nearest node.
        Nearest = "nearest",
        /// All in reach.
        All = "all"
    }
}

/// A field that a knob turns.
pub(super) trait Setting: Sized {
    fn to_value(&self) -> Value;

    /// `None` when the value is of another kind. A knob checks kind and range before, so that this
    /// does not happen for values that passed [`crate::knob::Kind::check`].
    fn from_value(value: Value) -> Option<Self>;
}

/// Writes a checked value into a field.
pub(super) fn assign<T: Setting>(field: &mut T, value: Value) {
    if let Some(new) = T::from_value(value) {
        *field = new;
    }
}

impl Setting for f64 {
    fn to_value(&self) -> Value {
        Value::Real(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Real(x) = value { Some(x) } else { None }
    }
}

impl Setting for f32 {
    fn to_value(&self) -> Value {
        // By way of the shortest text: 0.1 stays 0.1.
        Value::Real(self.to_string().parse().unwrap_or(f64::from(*self)))
    }

    fn from_value(value: Value) -> Option<Self> {
        f64::from_value(value).map(|x| x as Self)
    }
}

impl Setting for u64 {
    fn to_value(&self) -> Value {
        Value::Integer(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Integer(n) = value { Some(n) } else { None }
    }
}

impl Setting for u32 {
    fn to_value(&self) -> Value {
        Value::Integer(u64::from(*self))
    }

    fn from_value(value: Value) -> Option<Self> {
        u64::from_value(value).and_then(|n| n.try_into().ok())
    }
}

impl Setting for String {
    fn to_value(&self) -> Value {
        Value::Word(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Word(word) = value { Some(word) } else { None }
    }
}

impl Setting for bool {
    fn to_value(&self) -> Value {
        Value::Switch(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Switch(on) = value { Some(on) } else { None }
    }
}

impl Setting for [u8; 3] {
    fn to_value(&self) -> Value {
        Value::Color(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Color(color) = value { Some(color) } else { None }
    }
}

impl Setting for BarkStyle {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, style, _)| style == self).map_or("", |(name, _, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        String::from_value(value).and_then(|name| Self::named(&name))
    }
}

/// The words of [`Meet`].
pub(super) const MEETINGS: &[&str] = &["around", "stop"];

impl Setting for Meet {
    fn to_value(&self) -> Value {
        let word = match self {
            Self::Around => MEETINGS[0],
            Self::Stop => MEETINGS[1],
        };
        Value::Word(word.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        let word = String::from_value(value)?;
        [Self::Around, Self::Stop]
            .into_iter()
            .zip(MEETINGS)
            .find(|(_, own)| **own == word)
            .map(|(meet, _)| meet)
    }
}

impl Setting for [f64; 3] {
    fn to_value(&self) -> Value {
        Value::Vector(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Vector(v) = value { Some(v) } else { None }
    }
}

/// Numbers per branching order, say.
impl Setting for Vec<f64> {
    fn to_value(&self) -> Value {
        Value::Reals(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Reals(numbers) = value { Some(numbers) } else { None }
    }
}

impl Setting for Vec<[u8; 3]> {
    fn to_value(&self) -> Value {
        Value::Colors(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Colors(colors) = value { Some(colors) } else { None }
    }
}

impl Setting for Length {
    fn to_value(&self) -> Value {
        match *self {
            Self::Auto => Value::Auto,
            Self::Metres(x) => Value::Real(x),
            Self::Steps(x) => Value::Steps(x),
        }
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Auto => Some(Self::Auto),
            Value::Real(x) => Some(Self::Metres(x)),
            Value::Steps(x) => Some(Self::Steps(x)),
            _ => None,
        }
    }
}

/// `None` is `auto`.
impl<T: Setting> Setting for Option<T> {
    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::Auto, T::to_value)
    }

    fn from_value(value: Value) -> Option<Self> {
        if value == Value::Auto { Some(None) } else { T::from_value(value).map(Some) }
    }
}
