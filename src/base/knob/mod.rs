//! A knob: a named, bounded, explained setting.
//!
//! Presets, exporters and crown shapes all describe their settings by [`Knob`]s; the command line,
//! the schema, the help and the workbench's form are made from these tables.

mod field;
mod kept;
mod spread;
mod wording;

use std::fmt;

pub use field::{
    Field, FieldValue, Length, assign, integer, length_or_auto, names, real, real_or_auto, set, values,
};
pub use kept::kept;
pub use spread::{MOST_DEVIATIONS, Spread};
pub use wording::{did_you_mean, excerpt, listed, nearest, printable};

/// No coordinate is farther from 0 than this, in documents, on command lines and in input files: it is more
/// than a place on Earth in millimetres needs, and beyond it growth would walk for ever.
pub const FARTHEST: f64 = 1e9;

/// What a knob is, apart from its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// What scripts call it: `kill`.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// `m`, `deg`, … or empty for a plain number.
    pub unit: &'static str,
    /// One line: what turning it does.
    pub help: &'static str,
    /// Names that it had before: documents and recipes that have these mean this knob.
    pub aliases: &'static [&'static str],
    /// What one line cannot say: how it works together with others, where its range comes from. May be empty.
    pub details: &'static str,
    /// Knobs that are turned together with it.
    pub see_also: &'static [&'static str],
}

impl Knob {
    /// A knob with a name, the values that it takes, its unit and a line of help.
    pub const fn new(name: &'static str, kind: Kind, unit: &'static str, help: &'static str) -> Self {
        Self { name, kind, unit, help, aliases: &[], details: "", see_also: &[] }
    }

    /// With names that it had before.
    #[must_use]
    pub const fn aliases(self, aliases: &'static [&'static str]) -> Self {
        Self { aliases, ..self }
    }

    /// With what one line cannot say.
    #[must_use]
    pub const fn details(self, details: &'static str) -> Self {
        Self { details, ..self }
    }

    /// With knobs that are turned together with it.
    #[must_use]
    pub const fn see_also(self, see_also: &'static [&'static str]) -> Self {
        Self { see_also, ..self }
    }

    /// Whether a name is the knob's, or was once.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || self.aliases.contains(&name)
    }
}

/// What values a knob takes. Ranges include both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A finite number.
    Real {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
        /// Whether `auto` is a value too.
        auto: bool,
        /// Words that stand for some of the numbers.
        names: &'static [(&'static str, f64)],
    },
    /// A whole number.
    Integer {
        /// Smallest.
        min: u64,
        /// Largest.
        max: u64,
    },
    /// A length in metres (`0.4`) or in steps (`17D`); `inf` where `max` is infinite.
    Length {
        /// Smallest, metres or steps.
        min: f64,
        /// Largest, metres or steps.
        max: f64,
        /// Whether `auto` is a value too.
        auto: bool,
    },
    /// One of some words.
    Choice(&'static [&'static str]),
    /// `true` or `false`.
    Switch,
    /// `x,y,z`, each within ±[`FARTHEST`].
    Vector {
        /// Whether `auto` is a value too.
        auto: bool,
    },
    /// An sRGB colour, `#rrggbb`.
    Color {
        /// Whether `auto` is a value too.
        auto: bool,
    },
    /// Pairs `height,radius; height,radius; …` in metres, each within ±[`FARTHEST`].
    Profile {
        /// Fewest pairs.
        least: usize,
        /// Most pairs.
        most: usize,
    },
    /// Numbers separated by blanks or commas: one per branching order, say, the last for all
    /// further ones.
    Reals {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
        /// Most numbers; at least one is needed.
        most: usize,
    },
    /// Some of some words, in the order in which they count, each at most once; or `none`.
    Words(&'static [&'static str]),
    /// A list of words that may repeat, one for each level of detail, say, the last for all further ones; or `none`.
    Sequence {
        /// Of these.
        words: &'static [&'static str],
        /// Most words.
        most: usize,
    },
    /// One or more sRGB colours, `#rrggbb #rrggbb …`.
    Colors {
        /// Most colours.
        most: usize,
        /// Whether `auto` is a value too.
        auto: bool,
    },
}

/// A knob's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Linden decides, from what it is given.
    Auto,
    /// For [`Kind::Real`], and a [`Kind::Length`] in metres.
    Real(f64),
    /// For [`Kind::Integer`].
    Integer(u64),
    /// For a [`Kind::Length`] in units of the step.
    Steps(f64),
    /// For [`Kind::Choice`].
    Word(String),
    /// For [`Kind::Switch`].
    Switch(bool),
    /// For [`Kind::Vector`].
    Vector([f64; 3]),
    /// For [`Kind::Color`]: red, green, blue.
    Color([u8; 3]),
    /// For [`Kind::Profile`]: height, radius.
    Profile(Vec<[f64; 2]>),
    /// For [`Kind::Reals`].
    Reals(Vec<f64>),
    /// For [`Kind::Words`] and [`Kind::Sequence`]; empty for `none`.
    Words(Vec<String>),
    /// For [`Kind::Colors`].
    Colors(Vec<[u8; 3]>),
}

impl fmt::Display for Value {
    /// As [`Kind::parse`] reads it back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Real(x) => write!(f, "{x}"),
            Self::Integer(n) => write!(f, "{n}"),
            Self::Steps(x) => write!(f, "{x}D"),
            Self::Word(word) => f.write_str(word),
            Self::Switch(on) => write!(f, "{on}"),
            Self::Vector([x, y, z]) => write!(f, "{x},{y},{z}"),
            Self::Color([r, g, b]) => write!(f, "#{r:02x}{g:02x}{b:02x}"),
            Self::Profile(pairs) => {
                for (i, [height, radius]) in pairs.iter().enumerate() {
                    write!(f, "{}{height},{radius}", if i == 0 { "" } else { "; " })?;
                }
                Ok(())
            }
            Self::Reals(numbers) => write_list(f, numbers),
            Self::Words(words) if words.is_empty() => f.write_str(NO_WORDS),
            Self::Words(words) => write_list(f, words),
            Self::Colors(colors) => write_list(f, colors.iter().map(|&color| Self::Color(color))),
        }
    }
}

/// What stands for an empty list of words.
const NO_WORDS: &str = "none";

/// Separated by blanks, as [`Kind::parse`] takes lists apart.
fn write_list<T: fmt::Display>(
    f: &mut fmt::Formatter<'_>,
    items: impl IntoIterator<Item = T>,
) -> fmt::Result {
    for (i, item) in items.into_iter().enumerate() {
        write!(f, "{}{item}", if i == 0 { "" } else { " " })?;
    }
    Ok(())
}

impl fmt::Display for Kind {
    /// What a user may type, with the range: `0.001 to 10, or auto`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_auto = |auto: bool| if auto { ", or auto" } else { "" };
        match *self {
            Self::Real { min, max, auto, names } => {
                write!(f, "{} to {}{}", Short(min), Short(max), or_auto(auto))?;
                for (i, (name, _)) in names.iter().enumerate() {
                    write!(f, "{}{name}", if i == 0 { ", or " } else { " | " })?;
                }
                Ok(())
            }
            Self::Integer { min, max } => write!(f, "a whole number, {min} to {max}"),
            Self::Length { min, max, auto } => {
                write!(f, "{} to {}, or in steps like 17D{}", Short(min), Short(max), or_auto(auto))
            }
            Self::Choice(words) => f.write_str(&words.join(" | ")),
            Self::Switch => f.write_str("true | false"),
            Self::Vector { auto } => write!(f, "x,y,z within ±{}{}", Short(FARTHEST), or_auto(auto)),
            Self::Color { auto } => write!(f, "a colour #rrggbb{}", or_auto(auto)),
            Self::Profile { least, most } if least == most => write!(f, "{least} pairs height,radius; …"),
            Self::Profile { least, most } => write!(f, "{least} to {most} pairs height,radius; …"),
            Self::Reals { min, max, most } => {
                write!(f, "up to {most} numbers, {} to {}, like 1 0.5", Short(min), Short(max))
            }
            Self::Words(words) => write!(f, "some of: {}; or {NO_WORDS}", words.join(" ")),
            Self::Sequence { words, most } => {
                write!(f, "up to {most} in a row of: {}; or {NO_WORDS}", words.join(" "))
            }
            Self::Colors { most, auto } => write!(f, "up to {most} colours #rrggbb{}", or_auto(auto)),
        }
    }
}

/// A range's end without a tail of zeros.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.abs() >= 1e6 && self.0.is_finite() {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

impl Kind {
    /// The words that it takes, `auto` among them: what can be completed while a value is typed. None for
    /// lists.
    pub fn words(&self) -> Vec<&'static str> {
        let auto = |auto: bool| auto.then_some("auto");
        match *self {
            Self::Choice(words) => words.to_vec(),
            Self::Switch => vec!["true", "false"],
            Self::Real { auto: is_auto, names, .. } => {
                auto(is_auto).into_iter().chain(names.iter().map(|(name, _)| *name)).collect()
            }
            Self::Length { auto: is_auto, .. }
            | Self::Vector { auto: is_auto }
            | Self::Color { auto: is_auto } => auto(is_auto).into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// Reads what a user typed.
    ///
    /// # Errors
    /// What was expected instead, without the knob's name.
    pub fn parse(&self, text: &str) -> Result<Value, String> {
        let text = text.trim();
        let value = self.read(text).ok_or_else(|| match self {
            Self::Integer { min, max } if text.parse::<f64>().is_ok() => {
                format!("{} is not a whole number from {min} to {max}", excerpt(text))
            }
            _ => {
                let meant = nearest(&text.to_lowercase(), self.words());
                format!("'{}' is not {self}{}", excerpt(text), did_you_mean(meant))
            }
        })?;
        self.check(&value)?;
        Ok(value)
    }

    fn read(&self, text: &str) -> Option<Value> {
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| !x.is_nan());
        match self {
            Self::Real { auto: true, .. }
            | Self::Length { auto: true, .. }
            | Self::Vector { auto: true }
            | Self::Color { auto: true }
            | Self::Colors { auto: true, .. }
                if text == "auto" =>
            {
                Some(Value::Auto)
            }
            Self::Real { names, .. } => {
                let named = names.iter().find(|(name, _)| *name == text).map(|(_, x)| *x);
                named.or_else(|| number(text)).map(Value::Real)
            }
            Self::Integer { .. } => whole(text).map(Value::Integer),
            Self::Length { .. } => match text.strip_suffix('D') {
                Some(steps) => number(steps).map(Value::Steps),
                None => number(text.strip_suffix('m').unwrap_or(text)).map(Value::Real),
            },
            Self::Choice(words) => words.contains(&text).then(|| Value::Word(text.to_owned())),
            Self::Switch => text.parse().ok().map(Value::Switch),
            Self::Vector { .. } => numbers(text, ',').map(Value::Vector),
            Self::Color { .. } => color(text).map(Value::Color),
            Self::Profile { .. } => {
                text.split(';').map(|pair| numbers(pair, ',')).collect::<Option<_>>().map(Value::Profile)
            }
            Self::Reals { .. } => items(text).map(number).collect::<Option<_>>().map(Value::Reals),
            Self::Words(_) | Self::Sequence { .. } if text == NO_WORDS => Some(Value::Words(Vec::new())),
            Self::Words(words) | Self::Sequence { words, .. } => {
                let known = |word: &str| words.contains(&word).then(|| word.to_owned());
                items(text).map(known).collect::<Option<_>>().map(Value::Words)
            }
            Self::Colors { .. } => items(text).map(color).collect::<Option<_>>().map(Value::Colors),
        }
    }

    /// Whether a value lies in the range.
    ///
    /// # Errors
    /// What was expected instead, without the knob's name.
    pub fn check(&self, value: &Value) -> Result<(), String> {
        let fits = match (self, value) {
            (
                Self::Real { auto, .. }
                | Self::Length { auto, .. }
                | Self::Vector { auto }
                | Self::Color { auto }
                | Self::Colors { auto, .. },
                Value::Auto,
            ) => *auto,
            (Self::Real { min, max, .. } | Self::Length { min, max, .. }, Value::Real(x))
            | (Self::Length { min, max, .. }, Value::Steps(x)) => min <= x && x <= max,
            (Self::Integer { min, max }, Value::Integer(n)) => min <= n && n <= max,
            (Self::Choice(words), Value::Word(word)) => words.contains(&word.as_str()),
            (Self::Switch, Value::Switch(_)) | (Self::Color { .. }, Value::Color(_)) => true,
            (Self::Vector { .. }, Value::Vector(v)) => v.iter().copied().all(is_place),
            (Self::Profile { least, most }, Value::Profile(pairs)) => {
                (least..=most).contains(&&pairs.len()) && pairs.iter().flatten().copied().all(is_place)
            }
            (Self::Reals { min, max, most }, Value::Reals(numbers)) => {
                (1..=*most).contains(&numbers.len()) && numbers.iter().all(|x| min <= x && x <= max)
            }
            (Self::Words(words), Value::Words(chosen)) => chosen
                .iter()
                .enumerate()
                .all(|(i, word)| words.contains(&word.as_str()) && !chosen[..i].contains(word)),
            (Self::Sequence { words, most }, Value::Words(chosen)) => {
                chosen.len() <= *most && chosen.iter().all(|word| words.contains(&word.as_str()))
            }
            (Self::Colors { most, .. }, Value::Colors(colors)) => (1..=*most).contains(&colors.len()),
            _ => false,
        };
        if fits {
            Ok(())
        } else {
            Err(format!("{} is outside the range: {self}", excerpt(&value.to_string())))
        }
    }
}

/// Whether a coordinate is finite and near enough to be one.
fn is_place(x: f64) -> bool {
    x.abs() <= FARTHEST
}

/// The items of a list, which blanks or commas separate.
fn items(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|item| !item.is_empty())
}

/// A whole number, also as `1_000_000`, `1e6` or `2.5e3`; `None` for what is none, or has more than 64 bits.
fn whole(text: &str) -> Option<u64> {
    let text = text.replace('_', "");
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((&text, "0"));
    let (integer, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    let zeros = exponent.parse::<u32>().ok()?.checked_sub(u32::try_from(fraction.len()).ok()?)?;
    let number = format!("{integer}{fraction}").parse::<u64>().ok()?;
    number.checked_mul(10_u64.checked_pow(zeros)?)
}

/// Exactly `N` numbers between separators.
fn numbers<const N: usize>(text: &str, separator: char) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = text.split(separator).map(|t| t.trim().parse().ok()).collect();
    all?.try_into().ok()
}

/// `#rrggbb`.
fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.is_ascii())?;
    let byte = |i: usize| u8::from_str_radix(&digits[i..i + 2], 16).ok();
    Some([byte(0)?, byte(2)?, byte(4)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_read_back() {
        let kinds = [
            (Kind::Real { min: -1.0, max: 1.0, auto: true, names: &[] }, vec!["auto", "-0.5", "1"]),
            (Kind::Integer { min: 0, max: u64::MAX }, vec!["0", "18446744073709551615"]),
            (Kind::Length { min: 0.0, max: f64::INFINITY, auto: false }, vec!["0.4", "17D", "inf"]),
            (Kind::Choice(&["a", "b"]), vec!["b"]),
            (Kind::Switch, vec!["true"]),
            (Kind::Vector { auto: true }, vec!["auto", "0,-1,0.5"]),
            (Kind::Color { auto: true }, vec!["auto", "#0a80ff"]),
            (Kind::Profile { least: 2, most: 2 }, vec!["0,2; 1,0.5"]),
            (Kind::Profile { least: 1, most: 3 }, vec!["0,2", "0,2; 1,0.5; 2,0"]),
            (Kind::Reals { min: -1.0, max: 1.0, most: 3 }, vec!["0.5", "1 0.5 -0.25"]),
            (Kind::Words(&["a", "b"]), vec!["none", "b a"]),
            (Kind::Sequence { words: &["a", "b"], most: 3 }, vec!["none", "b", "a a b"]),
            (Kind::Colors { most: 2, auto: false }, vec!["#0a80ff", "#0a80ff #000000"]),
            (Kind::Colors { most: 2, auto: true }, vec!["auto", "#0a80ff"]),
        ];
        for (kind, texts) in kinds {
            for text in texts {
                let value = kind.parse(text).unwrap();
                assert_eq!(value.to_string(), text, "{kind:?}");
                assert!(kind.parse("nonsense").unwrap_err().contains("nonsense"), "{kind:?}");
            }
        }
    }

    #[test]
    fn a_word_that_is_nearly_one_is_named() {
        let season =
            Kind::Real { min: 0.0, max: 1.0, auto: false, names: &[("summer", 0.35), ("bare", 1.0)] };
        let said = |kind: Kind, text: &str| kind.parse(text).unwrap_err();
        assert_eq!(said(season, "Sumer"), "'Sumer' is not 0 to 1, or summer | bare (did you mean 'summer'?)");
        assert_eq!(said(season, "leafs"), "'leafs' is not 0 to 1, or summer | bare");
        assert!(said(Kind::Choice(&["card", "curved"]), "curvd").ends_with("(did you mean 'curved'?)"));
    }

    #[test]
    fn names_stand_for_their_numbers() {
        let kind = Kind::Real { min: 0.0, max: 1.0, auto: false, names: &[("low", 0.25), ("high", 0.75)] };
        assert_eq!(kind.parse("high"), Ok(Value::Real(0.75)));
        assert_eq!(kind.parse(" 0.5 "), Ok(Value::Real(0.5)));
        assert_eq!(
            kind.parse("hihg").unwrap_err(),
            "'hihg' is not 0 to 1, or low | high (did you mean 'high'?)"
        );
        assert_eq!(kind.words(), ["low", "high"]);
    }

    #[test]
    fn values_out_of_range_and_nan_are_refused() {
        let real = Kind::Real { min: 0.0, max: 1.0, auto: false, names: &[] };
        for text in ["1.1", "-1", "nan", "inf", "auto", ""] {
            assert!(real.parse(text).is_err(), "{text}");
        }
        for far in ["0,inf,0", "0,nan,0", "3.6,1e60,0", "0,0,-1.1e9"] {
            assert!(Kind::Vector { auto: false }.parse(far).is_err(), "{far}");
        }
        assert!(Kind::Vector { auto: false }.parse("1e9,-1e9,0").is_ok());
        assert!(Kind::Profile { least: 1, most: 1 }.parse("0,1e60").is_err());
        assert!(Kind::Profile { least: 2, most: 3 }.parse("0,1").is_err());
        assert!(Kind::Profile { least: 1, most: 1 }.parse("0,1; 2,1").is_err());
        let reals = Kind::Reals { min: 0.0, max: 1.0, most: 2 };
        for text in ["", "2", "nan", "0 0 0", "0;1"] {
            assert!(reals.parse(text).is_err(), "{text}");
        }
        assert_eq!(reals.parse("0.5, 1"), Ok(Value::Reals(vec![0.5, 1.0])), "commas separate, too");
        assert!(Kind::Words(&["a", "b"]).parse("a a").is_err(), "each at most once");
        assert!(Kind::Words(&["a", "b"]).parse("a none").is_err());
        let sequence = Kind::Sequence { words: &["a", "b"], most: 3 };
        for text in ["a a a a", "c", "a none"] {
            assert!(sequence.parse(text).is_err(), "{text}");
        }
        assert!(Kind::Colors { most: 1, auto: true }.parse("#000000 #ffffff").is_err());
        assert!(Kind::Length { min: 1.0, max: 9.0, auto: false }.parse("10D").is_err());
        assert!(Kind::Color { auto: false }.parse("#12345é").is_err());
    }

    #[test]
    fn whole_numbers_are_taken_as_people_and_programs_write_them() {
        let kind = Kind::Integer { min: 1, max: 100_000_000 };
        for (text, number) in
            [("1e6", 1_000_000), ("1E+3", 1000), ("2.5e3", 2500), ("1_000", 1000), ("3.0", 3), ("1.50e1", 15)]
        {
            assert_eq!(kind.parse(text), Ok(Value::Integer(number)), "{text}");
        }
        assert_eq!(
            kind.parse("1e9").unwrap_err(),
            "1000000000 is outside the range: a whole number, 1 to 100000000"
        );
        for text in ["1.5", "-1", "1e-3", "1e99", "25e-1"] {
            let said = kind.parse(text).unwrap_err();
            assert_eq!(said, format!("{text} is not a whole number from 1 to 100000000"));
        }
        for text in ["e3", "1e", ".", "e", "1e1e1", "inf", "+", "0x10", ""] {
            assert!(kind.parse(text).is_err(), "{text}");
        }
    }
}
