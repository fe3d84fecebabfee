//! Text fitted into cells: broken into lines, or cut.

use std::borrow::Cow;

use unicode_width::UnicodeWidthStr;

/// Cells of a path that say which it is.
const LEAST_PATH: usize = 24;
/// Cells that it loses at a time, at least.
const LEAST_CUT: usize = 4;

/// Breaks a text at its spaces into lines of at most `width` cells; words that are longer are broken
/// where they must be. Printable whatever it is given. Never empty: no text is one empty line.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let text = linden::knob::printable(text);
    let words: Vec<&str> = text.split(' ').filter(|word| !word.is_empty()).collect();
    // A line is as full as it can be, so that it stays as it is while text comes in behind it.
    let options = textwrap::Options::new(width.max(1))
        .word_separator(textwrap::WordSeparator::AsciiSpace)
        .word_splitter(textwrap::WordSplitter::NoHyphenation)
        .wrap_algorithm(textwrap::WrapAlgorithm::FirstFit);
    textwrap::wrap(&words.join(" "), options).into_iter().map(Cow::into_owned).collect()
}

/// The same in at most `most` lines: long paths lose their middles where it takes that, and the last line ends with an
/// ellipsis when more would follow.
pub fn wrapped_within(text: &str, width: usize, most: usize) -> Vec<String> {
    let mut lines = wrapped(text, width);
    if lines.len() > most {
        let mut shorter = linden::knob::printable(text);
        while let Some(path) = longest_path(&shorter)
            && lines.len() > most
        {
            // What breaking at spaces takes is not known beforehand.
            let over = shorter.width().saturating_sub(width * most).max(LEAST_CUT);
            let room = path.width().saturating_sub(over).max(LEAST_PATH);
            shorter = shorter.replacen(path, &without_middle(path, room), 1);
            lines = wrapped(&shorter, width);
        }
    }
    if lines.len() > most {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            while last.width() + 1 > width.max(1) && last.pop().is_some() {}
            last.truncate(last.trim_end_matches([' ', ',', ':', ';']).len());
            last.push('…');
        }
    }
    lines
}

/// The same with its longest path shortened in the middle first: what is said of a path stands behind it.
pub fn clipped_in_paths(text: &str, width: usize) -> String {
    let text = linden::knob::printable(text);
    let over = text.width().saturating_sub(width);
    let Some(path) = longest_path(&text).filter(|_| over > 0) else { return clipped(&text, width) };
    let room = path.width().saturating_sub(over).max(LEAST_PATH);
    clipped(&text.replacen(path, &without_middle(path, room), 1), width)
}

/// The longest path in a text that can be shortened.
fn longest_path(text: &str) -> Option<&str> {
    let longest = text.split(' ').filter(|word| word.contains('/')).max_by_key(|word| word.width());
    longest.filter(|path| path.width() > LEAST_PATH)
}

/// A text in at most `width` cells, an ellipsis in its middle where something is left out.
pub fn without_middle(text: &str, width: usize) -> String {
    if text.width() <= width {
        return text.to_owned();
    }
    let tail_room = width.saturating_sub(1).div_ceil(2);
    let mut tail = text;
    while tail.width() > tail_room {
        let mut chars = tail.chars();
        chars.next();
        tail = chars.as_str();
    }
    // What `clipped` ends with stands in the middle then.
    clipped(text, width.saturating_sub(tail.width())) + tail
}

/// Text from outside or of any length in at most `width` cells, cut with an ellipsis; printable.
pub fn clipped(text: &str, width: usize) -> String {
    let text = linden::knob::printable(text);
    if text.width() <= width {
        return text;
    }
    let mut kept = String::new();
    for c in text.chars() {
        if kept.width() + c.to_string().width() + 1 > width {
            break;
        }
        kept.push(c);
    }
    if width > 0 {
        kept.push('…');
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_at_spaces_and_long_words_where_they_must() {
        assert_eq!(wrapped("a bc def", 4), ["a bc", "def"]);
        assert_eq!(wrapped("abcdefgh i", 3), ["abc", "def", "gh", "i"]);
        assert_eq!(wrapped("", 5), [""]);
        assert_eq!(wrapped("年輪 の木", 4), ["年輪", "の木"]);
        assert_eq!(wrapped("a\u{1b}b", 20), ["a\\u{1b}b"]);
    }

    #[test]
    fn no_line_is_too_wide_and_no_word_is_lost() {
        let text = "one two  three-and-a-half 年輪年輪年輪 five";
        for width in 2..40 {
            let lines = wrapped(text, width);
            assert!(lines.iter().all(|line| line.width() <= width), "{width}: {lines:?}");
            let joined: String = lines.concat().split(' ').collect();
            assert_eq!(joined, text.split(' ').collect::<String>(), "{width}");
        }
    }

    #[test]
    fn what_is_cut_says_so() {
        assert_eq!(wrapped_within("one two three", 5, 2), ["one", "two…"]);
        assert_eq!(wrapped_within("one two", 7, 1), ["one two"]);
        assert_eq!(wrapped_within("one, two", 4, 1), ["one…"]);
    }

    #[test]
    fn paths_lose_their_middles_before_a_text_loses_its_end() {
        let (from, to) = ("very/long/".repeat(9), "other/folders/".repeat(6));
        let text = format!("moving /home/me/{from}oak.toml to /srv/{to}oak.toml: there is no space left");
        for (width, most) in [(60, 2), (40, 3), (78, 2)] {
            let lines = wrapped_within(&text, width, most);
            let shown = lines.join(" ");
            assert!(lines.len() <= most && lines.iter().all(|line| line.width() <= width), "{lines:?}");
            assert!(shown.ends_with("oak.toml: there is no space left"), "{lines:?}");
            assert!(shown.starts_with("moving /home/me/") && shown.matches('…').count() == 2, "{lines:?}");
        }
        assert!(wrapped_within(&text, 20, 1)[0].ends_with('…'), "there is room for none of it");
        assert_eq!(without_middle("replace 'abcdefghijkl'? y or n", 20), "replace '…l'? y or n");
        assert_eq!(without_middle("short", 9), "short");
    }

    #[test]
    fn a_long_path_makes_room_for_what_is_said_of_it() {
        let text = format!("writing /home/me/{}/fir.glb: no space", "long/".repeat(20));
        let cut = clipped_in_paths(&text, 60);
        assert!(
            cut.width() <= 60 && cut.ends_with("/fir.glb: no space") && cut.starts_with("writing /home"),
            "{cut}"
        );
        assert_eq!(clipped_in_paths("a/b: short", 60), "a/b: short");
        assert_eq!(clipped_in_paths(&text, 10), "writing /…", "no room for either");
    }
}
