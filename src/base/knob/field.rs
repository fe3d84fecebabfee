//! From knobs to the fields of settings and back.
//!
//! Settings are plain structs; a table of [`Field`]s says which knob turns which field. A new knob is a field
//! of the struct and a row of its table.

use super::{Kind, Knob, Value};

/// A row of a table: a knob, and the field of the settings `T` that it turns.
pub struct Field<T: 'static> {
    /// Name, kind, unit, help.
    pub knob: Knob,
    /// The field's value.
    pub read: fn(&T) -> Value,
    /// Sets the field to a value that the knob's kind has checked.
    pub write: fn(&mut T, Value),
}

// Derived, these would ask the same of T.
impl<T> Clone for Field<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Field<T> {}

/// Makes a [`Field`]: name, kind, unit, help, and the way from the settings to the field. What else the
/// [`Knob`] has follows as its builders are called: `aliases(…)`, `details(…)`, `see_also(…)`.
///
/// ```
/// use linden_base::knob::{Field, Value, real, set, values};
///
/// #[derive(Default)]
/// struct Comb { tooth_m: f64 }
///
/// const FIELDS: &[Field<Comb>] =
///     &[linden_base::field!("tooth", real(0.0, 10.0), "m", "length of a tooth", tooth_m)];
///
/// let mut comb = Comb::default();
/// assert!(set(FIELDS, &mut comb, "tooth", Value::Real(2.0)));
/// assert_eq!(comb.tooth_m, 2.0);
/// assert_eq!(values(FIELDS, &comb)[0].1, Value::Real(2.0));
/// ```
#[macro_export]
macro_rules! field {
    ($name:literal, $kind:expr, $unit:literal, $help:literal, $($field:ident).+ $(, $more:ident $arguments:tt)*) => {
        $crate::knob::Field {
            knob: $crate::knob::Knob::new($name, $kind, $unit, $help)$(.$more $arguments)*,
            read: |settings| $crate::knob::FieldValue::to_value(&settings.$($field).+),
            write: |settings, value| $crate::knob::assign(&mut settings.$($field).+, value),
        }
    };
}

/// All knobs of a table with their values.
pub fn values<T>(fields: &[Field<T>], settings: &T) -> Vec<(Knob, Value)> {
    fields.iter().map(|field| (field.knob, (field.read)(settings))).collect()
}

/// Sets the field that a knob's name or alias turns; whether the table has such a knob.
pub fn set<T>(fields: &[Field<T>], settings: &mut T, name: &str, value: Value) -> bool {
    let field = fields.iter().find(|field| field.knob.is_called(name));
    field.inspect(|field| (field.write)(settings, value)).is_some()
}

/// The names of a table of names, values and help, for [`Kind::Choice`].
pub const fn names<T, const N: usize>(table: &[(&'static str, T, &'static str); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = table[i].0;
        i += 1;
    }
    names
}

/// [`Kind::Real`] without `auto`.
pub const fn real(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: false, names: &[] }
}

/// [`Kind::Real`] with `auto`.
pub const fn real_or_auto(min: f64, max: f64) -> Kind {
    Kind::Real { min, max, auto: true, names: &[] }
}

/// [`Kind::Length`] with `auto`.
pub const fn length_or_auto(min: f64, max: f64) -> Kind {
    Kind::Length { min, max, auto: true }
}

/// [`Kind::Integer`].
pub const fn integer(min: u64, max: u64) -> Kind {
    Kind::Integer { min, max }
}

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

/// Makes an enum of a choice among words: the type, its words in a table, and the way back.
///
/// ```
/// linden_base::words! {
///     /// How a shrub stands.
///     ShrubHabit {
///         /// Upright.
///         Upright = "upright",
///         /// Flat on the ground.
///         Creeping = "creeping"
///     }
/// }
/// assert_eq!(ShrubHabit::WORDS, ["upright", "creeping"]);
/// assert_eq!(ShrubHabit::named("creeping"), Some(ShrubHabit::Creeping));
/// assert_eq!(ShrubHabit::Upright.word(), "upright");
/// ```
#[macro_export]
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$about:meta])* $variant:ident = $word:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$about])* $variant),* }

        impl $name {
            /// The words of all variants, in their order.
            pub const WORDS: &[&'static str] = &[$($word),*];
            /// All variants.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The variant's word.
            pub const fn word(self) -> &'static str {
                match self { $(Self::$variant => $word),* }
            }

            /// The variant of a word.
            pub fn named(word: &str) -> Option<Self> {
                match word {
                    $($word => Some(Self::$variant),)*
                    _ => None,
                }
            }
        }

        impl $crate::knob::FieldValue for $name {
            fn to_value(&self) -> $crate::knob::Value {
                $crate::knob::Value::Word(self.word().to_owned())
            }

            fn from_value(value: $crate::knob::Value) -> Option<Self> {
                <String as $crate::knob::FieldValue>::from_value(value).and_then(|word| Self::named(&word))
            }
        }
    };
}

/// A type of fields that knobs turn.
pub trait FieldValue: Sized {
    /// The field's value as a knob has it.
    fn to_value(&self) -> Value;

    /// A field of this value; `None` when the value is of another kind. A knob checks kind and range before, so that this
    /// does not happen for values that passed [`Kind::check`](crate::knob::Kind::check).
    fn from_value(value: Value) -> Option<Self>;
}

/// Writes a checked value into a field.
pub fn assign<T: FieldValue>(field: &mut T, value: Value) {
    if let Some(new) = T::from_value(value) {
        *field = new;
    }
}

impl FieldValue for f64 {
    fn to_value(&self) -> Value {
        Value::Real(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Real(x) = value { Some(x) } else { None }
    }
}

impl FieldValue for f32 {
    fn to_value(&self) -> Value {
        // By way of the shortest text: 0.1 stays 0.1.
        Value::Real(self.to_string().parse().unwrap_or(f64::from(*self)))
    }

    fn from_value(value: Value) -> Option<Self> {
        f64::from_value(value).map(|x| x as Self)
    }
}

impl FieldValue for u64 {
    fn to_value(&self) -> Value {
        Value::Integer(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Integer(n) = value { Some(n) } else { None }
    }
}

impl FieldValue for u32 {
    fn to_value(&self) -> Value {
        Value::Integer(u64::from(*self))
    }

    fn from_value(value: Value) -> Option<Self> {
        u64::from_value(value).and_then(|n| n.try_into().ok())
    }
}

impl FieldValue for String {
    fn to_value(&self) -> Value {
        Value::Word(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Word(word) = value { Some(word) } else { None }
    }
}

impl FieldValue for bool {
    fn to_value(&self) -> Value {
        Value::Switch(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Switch(on) = value { Some(on) } else { None }
    }
}

impl FieldValue for [u8; 3] {
    fn to_value(&self) -> Value {
        Value::Color(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Color(color) = value { Some(color) } else { None }
    }
}

impl FieldValue for [f64; 3] {
    fn to_value(&self) -> Value {
        Value::Vector(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Vector(v) = value { Some(v) } else { None }
    }
}

/// Numbers per branching order, say.
impl FieldValue for Vec<f64> {
    fn to_value(&self) -> Value {
        Value::Reals(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Reals(numbers) = value { Some(numbers) } else { None }
    }
}

impl FieldValue for Vec<[u8; 3]> {
    fn to_value(&self) -> Value {
        Value::Colors(self.clone())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Colors(colors) = value { Some(colors) } else { None }
    }
}

impl FieldValue for Length {
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
impl<T: FieldValue> FieldValue for Option<T> {
    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::Auto, T::to_value)
    }

    fn from_value(value: Value) -> Option<Self> {
        if value == Value::Auto { Some(None) } else { T::from_value(value).map(Some) }
    }
}
