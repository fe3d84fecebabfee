//! Words and texts of users as messages have them.

/// Text from outside, safe to show: what cannot be seen or turns the order of letters around becomes
/// `\u{…}`. That is control characters, separators of lines, and all that Unicode calls
/// `Default_Ignorable_Code_Point` or `Bidi_Control` (`DerivedCoreProperties.txt`, `PropList.txt` 17.0): soft
/// hyphens, Hangul fillers, joiners, variation selectors, tags.
///
/// ```
/// assert_eq!(linden_base::knob::printable("a\u{1b}[2J"), "a\\u{1b}[2J");
/// ```
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || is_hidden(c) { shown.extend(c.escape_unicode()) } else { shown.push(c) }
    }
    shown
}

/// Whether a character is of those that [`printable`] names, control characters aside.
const fn is_hidden(c: char) -> bool {
    matches!(c,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}'
        | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}'
        | '\u{fff0}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}'
        | '\u{e0000}'..='\u{e0fff}')
}

/// Text from outside as messages quote it: [`printable`], and cut off where it becomes a page.
///
/// ```
/// assert_eq!(linden_base::knob::excerpt("kill"), "kill");
/// assert!(linden_base::knob::excerpt(&"A".repeat(5000)).len() < 70);
/// ```
pub fn excerpt(text: &str) -> String {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => printable(&text[..end]) + "…",
        None => printable(text),
    }
}

/// The name nearest to what was typed, when one is near enough to be meant: a third of the longer one may
/// be wrong. A hint that is far off is worse than none.
///
/// ```
/// use linden_base::knob::nearest;
///
/// assert_eq!(nearest("pionts", ["points", "prunes"]), Some("points"));
/// assert_eq!(nearest("nope", ["abop-e", "oak"]), None);
/// ```
pub fn nearest<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = typed.chars().take(256).count();
    let allowed = |name: &str| length.max(name.chars().count()) / 3;
    names
        .into_iter()
        // Comparing takes memory of the product of both lengths, and what was typed may be a whole file.
        .filter(|name| typed.chars().nth(name.chars().count() + allowed(name)).is_none())
        .map(|name| (strsim::damerau_levenshtein(typed, name), name))
        .filter(|&(distance, name)| distance <= allowed(name))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// What [`nearest`] found, as messages have it behind the name that was typed; nothing for nothing.
///
/// ```
/// assert_eq!(linden_base::knob::did_you_mean(Some("fir")), " (did you mean 'fir'?)");
/// ```
pub fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|name| format!(" (did you mean '{name}'?)")).unwrap_or_default()
}

/// Some words as a sentence has them, with `last` before the last of them.
///
/// ```
/// use linden_base::knob::listed;
///
/// assert_eq!(listed(["bark", "moss", "season"], "and"), "bark, moss and season");
/// assert_eq!(listed(["glb", "usdc"], "or"), "glb or usdc");
/// ```
pub fn listed(words: impl IntoIterator<Item = impl AsRef<str>>, last: &str) -> String {
    let words: Vec<_> = words.into_iter().collect();
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_from_outside_cannot_drive_the_terminal() {
        assert_eq!(printable("ok ü\u{1b}]0;x\u{7}\u{202e}"), "ok ü\\u{1b}]0;x\\u{7}\\u{202e}");
    }

    #[test]
    fn what_cannot_be_seen_is_shown_as_what_it_is() {
        let hidden = [
            '\u{ad}',
            '\u{115f}',
            '\u{1160}',
            '\u{3164}',
            '\u{ffa0}',
            '\u{17b4}',
            '\u{180e}',
            '\u{200d}',
            '\u{2028}',
            '\u{2066}',
            '\u{206f}',
            '\u{fe0f}',
            '\u{feff}',
            '\u{fff9}',
            '\u{1d173}',
            '\u{e0001}',
            '\u{e0041}',
            '\u{e01ef}',
            '\u{34f}',
            '\u{85}',
        ];
        for c in hidden {
            assert_eq!(printable(&format!("a{c}b")), format!("a\\u{{{:x}}}b", u32::from(c)));
        }
        let shown = "Öl 木 한글 مرحبا ½ — … 🌳 e\u{301} \u{a0}\u{3000}";
        assert_eq!(printable(shown), shown);
    }

    #[test]
    fn the_nearest_name_is_one_that_may_be_meant() {
        assert_eq!(nearest("pionts", ["points", "step"]), Some("points"));
        assert_eq!(nearest("zzz", ["points", "step"]), None);
        assert_eq!(nearest("pointsss", ["points"]), Some("points"));
        assert_eq!(nearest("nope", ["abop-e", "oak"]), None, "three letters of four");
        assert_eq!(nearest("fbx", ["obj", "ply", "glb"]), None);
        assert_eq!(nearest("fri", ["oak", "fir"]), Some("fir"));
    }

    #[test]
    fn a_name_as_long_as_a_file_is_compared_with_nothing() {
        // A table of distances to it would take gigabytes.
        assert_eq!(nearest(&"A".repeat(100_000_000), ["points", "step"]), None);
    }

    #[test]
    fn words_are_listed_as_a_sentence_has_them() {
        assert_eq!(listed([""; 0], "and"), "");
        assert_eq!(listed(["a"], "and"), "a");
        assert_eq!(listed(["a", "b"], "or"), "a or b");
        assert_eq!(listed(vec!["a".to_owned(), "b".to_owned(), "c".to_owned()], "and"), "a, b and c");
    }
}
