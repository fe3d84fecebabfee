//! As many colours as there are, and no more.

use crate::harness::{Answers, Home, Setup, Token, Workbench, tokens};

/// The parameters of all that set the rendition (SGR), apart from those of the queries after the
/// first frame.
fn renditions(bytes: &[u8]) -> Vec<String> {
    let (all, _) = tokens(bytes);
    let is_query =
        |at: usize| matches!(all.get(at + 1), Some(Token::String(b'P', body)) if body.starts_with(b"$q"));
    let sgr = all.iter().enumerate().filter_map(|(at, token)| match token {
        Token::Csi(body, b'm') if !is_query(at) => Some(String::from_utf8_lossy(body).into_owned()),
        _ => None,
    });
    sgr.collect()
}

/// What of a rendition is a colour: `3…`, `4…`, `9…`, `10…`.
fn colors(rendition: &str) -> Vec<u16> {
    let mut numbers = rendition.split(';').map(|n| n.split(':').next().unwrap().parse::<u16>().unwrap_or(0));
    let mut found = Vec::new();
    while let Some(number) = numbers.next() {
        if matches!(number, 38 | 48 | 58) {
            let kind = numbers.next().unwrap_or(0);
            found.push(1000 * number + kind);
            for _ in 0..if kind == 2 { 3 } else { 1 } {
                numbers.next();
            }
        } else if matches!(number, 30..=37 | 40..=47 | 90..=97 | 100..=107) {
            found.push(number);
        }
    }
    found
}

/// Everything that it shows: the panes, looks, dialogs.
fn tour(workbench: &Workbench) -> Vec<u8> {
    workbench.wait_for_tree();
    for key in [
        "\t", "l", "c", "c", "c", "c", "\t", "j", "l", "?", "q", ":", "\x1b", "/x", "\x1b", "m", "q", "P",
        "O",
    ] {
        workbench.keys(key);
        workbench.settle();
    }
    workbench.bytes()
}

#[test]
fn with_no_color_there_is_none() {
    for (name, value) in [("NO_COLOR", "1"), ("LINDEN_COLORS", "none")] {
        let home = Home::new();
        let setup = Setup::new(120, 40).env(name, value).answers(Answers::TrueColor);
        let workbench = setup.args(&["open", "fir"]).start(&home);
        let bytes = tour(&workbench);
        for rendition in renditions(&bytes) {
            assert_eq!(colors(&rendition), Vec::<u16>::new(), "{name}: {rendition}");
        }
        // The tree is there all the same: in dots.
        workbench.keys("c");
        workbench.settle();
        let dots =
            workbench.screen().text().chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count();
        assert!(dots > 100, "{dots} dots:\n{}", workbench.screen().text());
    }
}

#[test]
fn fewer_colours_are_never_exceeded() {
    for (depth, allowed) in [("256", &[38_005, 48_005, 58_005][..]), ("16", &[])] {
        let home = Home::new();
        let setup = Setup::new(120, 40).answers(Answers::TrueColor);
        let workbench = setup.args(&["open", "fir", "--colors", depth]).start(&home);
        let bytes = tour(&workbench);
        let all: Vec<u16> = renditions(&bytes).iter().flat_map(|r| colors(r)).collect();
        assert!(!all.is_empty());
        let beyond: Vec<_> = all.iter().filter(|c| **c >= 1000 && !allowed.contains(c)).collect();
        assert!(beyond.is_empty(), "{depth}: {beyond:?}");
    }
}

#[test]
fn the_terminal_s_answer_decides_between_256_and_24_bits() {
    for (answers, kind) in [(Answers::Plain, 38_005), (Answers::TrueColor, 38_002)] {
        let home = Home::new();
        let workbench = Setup::new(120, 40).answers(answers).args(&["open", "fir"]).start(&home);
        workbench.wait_for_tree();
        let from = workbench.sent();
        workbench.keys("\x0c");
        workbench.settle();
        let all: Vec<u16> = renditions(&workbench.bytes_from(from)).iter().flat_map(|r| colors(r)).collect();
        let wide: Vec<_> = all.iter().filter(|c| (38_000..39_000).contains(*c)).collect();
        assert!(!wide.is_empty() && wide.iter().all(|c| **c == kind), "{answers:?}: {wide:?}");
    }
}
