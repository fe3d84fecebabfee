//! Words completed while a knob's value is typed.

use linden::preset::knob_named;

/// The words that a knob takes, `auto` among them.
pub fn words(name: &str) -> Vec<&'static str> {
    knob_named(name).map_or_else(Vec::new, |knob| knob.kind.words())
}

/// What Tab or Down (`forward`), or Up, make of what was typed: the first word that begins so, and
/// from a whole word the next one.
pub fn complete(name: &str, typed: &str, forward: bool) -> Option<&'static str> {
    let words = words(name);
    let typed = typed.trim();
    if let Some(at) = words.iter().position(|word| *word == typed) {
        let next = if forward { at + 1 } else { at + words.len() - 1 };
        return Some(words[next % words.len()]);
    }
    let mut meant = words.iter().filter(|word| word.starts_with(typed));
    if forward { meant.next().copied() } else { meant.next_back().copied() }
}

/// What is meant by what was typed: a word, when it is the only one that begins so.
pub fn completed<'a>(name: &str, typed: &'a str) -> &'a str {
    let words = words(name);
    let start = typed.trim();
    let mut meant = words.iter().filter(|word| word.starts_with(start));
    match (meant.next(), meant.next()) {
        (Some(word), None) if !start.is_empty() => word,
        _ => typed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_completed_and_gone_through() {
        assert_eq!(complete("crown", "cy", true), Some("cylinder"));
        let all = words("crown");
        let mut word = all[0];
        for expected in all[1..].iter().chain(&all[..1]) {
            word = complete("crown", word, true).unwrap();
            assert_eq!(word, *expected);
            assert_eq!(
                all.iter().position(|w| *w == complete("crown", word, false).unwrap()).unwrap() + 1,
                if word == all[0] { all.len() } else { all.iter().position(|w| *w == word).unwrap() }
            );
        }
        assert_eq!(complete("step", "", true), Some("auto"));
        assert_eq!(complete("points", "", true), None);
        assert_eq!(complete("nothing", "x", false), None);
    }

    #[test]
    fn what_can_only_be_one_word_is_that_word() {
        assert_eq!(completed("crown", "cyl"), "cylinder");
        assert_eq!(completed("crown", ""), "");
        assert_eq!(completed("step", "au"), "auto");
        assert_eq!(completed("step", "0.1"), "0.1");
        assert_eq!(completed("contract", "f"), "false");
    }
}
