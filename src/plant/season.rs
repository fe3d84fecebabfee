//! Seasons that a plant is shown in: names for values of the knob `season`.

use linden_base::knob::{did_you_mean, excerpt, nearest};

/// A season: what files call it, and when in the year it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Season {
    /// Lower-case ASCII identifier: `summer`.
    pub name: String,
    /// The knob `season`: 0 leaves unfold, 1 bare.
    pub season: f64,
}

/// The seasons that have names, in the order of the year. In autumn all leaves have turned and none has
/// fallen yet.
pub const SEASONS: [(&str, f64); 4] = [("flush", 0.0), ("summer", 0.35), ("autumn", 0.75), ("bare", 1.0)];

/// The same with other words for three of them: what the knob `season` is called by.
pub const SEASON_WORDS: [(&str, f64); 7] = [
    SEASONS[0],
    SEASONS[1],
    SEASONS[2],
    SEASONS[3],
    ("spring", SEASONS[0].1),
    ("fall", SEASONS[2].1),
    ("winter", SEASONS[3].1),
];

/// Why a list of seasons is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeasonError {
    /// Nothing is listed.
    #[error("no season is named; there are: {}", names())]
    Empty,
    /// Neither a known name nor a name with a value.
    #[error(
        "no season is called '{}'{}; there are: {}; or give a name a value of the knob season, like late_spring=0.1",
        excerpt(.name),
        did_you_mean(*.nearest),
        names()
    )]
    Unknown {
        /// As typed.
        name: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
    },
    /// Files could not call it so.
    #[error(
        "'{}' cannot name a season: take a lower-case letter, then lower-case letters, digits or _, at most {MOST_LETTERS}",
        excerpt(.0)
    )]
    Name(String),
    /// No value of the knob `season`.
    #[error("season {name}: '{}' is not 0 to 1 (0 leaves unfold, 0.35 summer, 0.75 autumn, 1 bare)", excerpt(.value))]
    Value {
        /// The season.
        name: String,
        /// As typed.
        value: String,
    },
    /// Two of the same name.
    #[error("season {0} is named twice; give each a name of its own")]
    Twice(String),
}

/// The longest name: it becomes part of the names of files.
const MOST_LETTERS: usize = 32;

/// Whether files and variants can be called so: a lower-case letter, then lower-case letters,
/// digits or `_`, 32 at most.
///
/// ```
/// use linden_plant::season::is_name;
/// assert!(is_name("late_2") && !is_name("2_late") && !is_name("Late"));
/// ```
pub fn is_name(name: &str) -> bool {
    let starts = name.starts_with(|first: char| first.is_ascii_lowercase());
    let rest = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    starts && name.chars().all(rest) && name.len() <= MOST_LETTERS
}

fn names() -> String {
    SEASONS.map(|(name, at)| format!("{name} ({at})")).join(", ")
        + ", and spring, fall, winter for flush, autumn, bare"
}

impl Season {
    /// All that have names.
    pub fn all() -> Vec<Self> {
        SEASONS.map(|(name, season)| Self { name: name.to_owned(), season }).to_vec()
    }

    /// Reads a list like `summer,autumn`, `spring=0.05,summer` or `all,bloom=0.15`. Those of other words have these names.
    ///
    /// # Errors
    /// [`SeasonError`].
    pub fn parse_list(text: &str) -> Result<Vec<Self>, SeasonError> {
        let mut seasons: Vec<Self> = Vec::new();
        for item in text.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let named = if item == "all" { Self::all() } else { vec![Self::parse(item)?] };
            for season in named {
                if seasons.iter().any(|before| before.name == season.name) {
                    return Err(SeasonError::Twice(season.name));
                }
                seasons.push(season);
            }
        }
        if seasons.is_empty() { Err(SeasonError::Empty) } else { Ok(seasons) }
    }

    fn parse(item: &str) -> Result<Self, SeasonError> {
        let Some((name, value)) = item.split_once('=') else {
            let known = SEASON_WORDS.into_iter().find(|(name, _)| *name == item);
            let Some((name, season)) = known else {
                let nearest = nearest(&item.to_lowercase(), SEASON_WORDS.map(|(name, _)| name));
                return Err(SeasonError::Unknown { name: item.to_owned(), nearest });
            };
            return Ok(Self { name: name.to_owned(), season });
        };
        let (name, value) = (name.trim(), value.trim());
        if !is_name(name) {
            return Err(SeasonError::Name(name.to_owned()));
        }
        let season = value.parse().ok().filter(|season| (0.0..=1.0).contains(season));
        let name = name.to_owned();
        match season {
            Some(season) => Ok(Self { name, season }),
            None => Err(SeasonError::Value { name, value: value.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_have_names_and_values() {
        let season = |name: &str, season| Season { name: name.to_owned(), season };
        assert_eq!(
            Season::parse_list("bare, summer").unwrap(),
            [season("bare", 1.0), season("summer", 0.35)]
        );
        assert_eq!(
            Season::parse_list("spring=0.05,late_2=.9").unwrap(),
            [season("spring", 0.05), season("late_2", 0.9)]
        );
        assert_eq!(
            Season::parse_list("spring,fall,winter").unwrap(),
            [season("spring", 0.0), season("fall", 0.75), season("winter", 1.0)]
        );
        assert_eq!(SEASON_WORDS[..SEASONS.len()], SEASONS);
        let all = SEASONS.map(|(name, _)| name).join(",");
        assert_eq!(Season::parse_list(&all).unwrap(), Season::all());
        let more = Season::parse_list("all,bloom=0.15").unwrap();
        assert_eq!(more, [Season::all(), vec![season("bloom", 0.15)]].concat());
        assert_eq!(Season::parse_list("bare,all"), Err(SeasonError::Twice("bare".to_owned())));
        assert!(SEASONS.windows(2).all(|two| two[0].1 < two[1].1), "the order of the year");
    }

    #[test]
    fn what_is_no_list_is_told() {
        for (text, expected) in [
            ("", "no season is named"),
            (" , ", "no season is named"),
            ("atumn", "did you mean 'autumn'"),
            ("0.5", "like late_spring=0.1"),
            ("summer,summer", "summer is named twice"),
            ("summer,summer=0.4", "summer is named twice"),
            ("late=1.5", "'1.5' is not 0 to 1"),
            ("late=nan", "'nan' is not 0 to 1"),
            ("late=", "'' is not 0 to 1"),
            ("Late=0.5", "'Late' cannot name a season"),
            ("a/b=0.5", "cannot name a season"),
            ("=0.5", "'' cannot name a season"),
            ("\u{1b}[2J", "\\u{1b}"),
            ("x=\u{1b}[2J", "\\u{1b}"),
        ] {
            let said = Season::parse_list(text).unwrap_err().to_string();
            assert!(said.contains(expected), "{text:?}: {said}");
            assert!(!said.contains('\u{1b}'), "{said:?}");
        }
    }
}
