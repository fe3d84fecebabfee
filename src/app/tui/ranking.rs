//! What was typed, against names: letters in their order, as fzf ranks them. Beginnings and starts of words count more,
//! gaps cost.

use nucleo_matcher::chars;
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};

/// What was typed.
pub struct Ranking {
    typed: String,
    pattern: Pattern,
    matcher: Matcher,
    buffer: Vec<char>,
}

impl Ranking {
    /// Of a text: words apart, each of which must match.
    pub fn of(typed: &str) -> Self {
        let mut config = Config::DEFAULT;
        config.prefer_prefix = true;
        let pattern = Pattern::parse(typed, CaseMatching::Ignore, Normalization::Smart);
        let typed = plain(typed);
        Self { typed, pattern, matcher: Matcher::new(config), buffer: Vec::new() }
    }

    /// How well a name matches; `None` where it does not.
    pub fn score(&mut self, name: &str) -> Option<u32> {
        self.pattern.score(Utf32Str::new(name, &mut self.buffer), &mut self.matcher)
    }

    /// Whether each word of what was typed is the beginning of a word in one of these texts, whatever its case and its
    /// accents. What is said of a thing at length has most letters in some order, so that they alone tell nothing.
    pub fn is_told(&self, texts: &[&str]) -> bool {
        let typed = folded(&self.typed);
        let mut wanted: Vec<&str> = typed.split_whitespace().collect();
        for text in texts {
            if wanted.is_empty() {
                break;
            }
            let text = folded(text);
            let begins_word = |at: usize| text[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric());
            wanted.retain(|word| !text.match_indices(*word).any(|(at, _)| begins_word(at)));
        }
        wanted.is_empty()
    }

    /// Whether a name is what was typed, begins with it, or neither: this counts before any score.
    pub fn closeness(&self, name: &str) -> Closeness {
        let name = plain(name);
        if self.typed.is_empty() {
            Closeness::Within
        } else if name == self.typed {
            Closeness::Whole
        } else if name.starts_with(&self.typed) {
            Closeness::Beginning
        } else {
            Closeness::Within
        }
    }

    /// The same with the letters that match, in their order.
    pub fn marked(&mut self, name: &str) -> Option<(u32, Vec<u32>)> {
        let mut marks = Vec::new();
        let text = Utf32Str::new(name, &mut self.buffer);
        let score = self.pattern.indices(text, &mut self.matcher, &mut marks)?;
        marks.sort_unstable();
        marks.dedup();
        Some((score, marks))
    }
}

/// What a name has of what was typed, the closest last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Closeness {
    /// Its letters, somewhere.
    Within,
    /// Its beginning.
    Beginning,
    /// All of it.
    Whole,
}

/// A name as it is compared: in small letters, with spaces for underscores.
fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace('_', " ")
}

/// A text in small letters without accents.
fn folded(text: &str) -> String {
    text.chars().flat_map(char::to_lowercase).map(chars::normalize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beginnings_and_starts_of_words_come_before_letters_within() {
        let names = ["leaf_margin", "relief_m", "clump_size", "leaf_form", "form_leaf_x"];
        let best = |typed: &str| {
            let mut ranking = Ranking::of(typed);
            let mut scored: Vec<_> =
                names.iter().filter_map(|name| Some((ranking.score(name)?, *name))).collect();
            scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
            scored.first().map(|(_, name)| *name)
        };
        assert_eq!(best("lf"), Some("leaf_form"));
        assert_eq!(best("form"), Some("form_leaf_x"));
        assert_eq!(best("leaf m"), Some("leaf_margin"));
        assert_eq!(best("zq"), None);
        for (typed, told) in [
            ("bare TRUNK", true),
            ("runk", false),
            ("trunk palubicki", true),
            ("trunk fir", false),
            ("", true),
        ] {
            let texts = ["A crown on a bare trunk.", "after Pałubicki et al."];
            assert_eq!(Ranking::of(typed).is_told(&texts), told, "{typed}");
        }
        assert_eq!(Ranking::of("lf").marked("leaf_form").map(|(_, marks)| marks), Some(vec![0, 5]));
    }
}
