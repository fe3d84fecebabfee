//! Terminals that can little: no colour sequence, and nothing but ASCII.

use crate::harness::{End, Home, Setup, Token, tokens};

/// What is sent of the panes, a dialog and the palette.
fn tour(term: &str, lang: &str) -> (Vec<u8>, String) {
    let home = Home::new();
    let setup = Setup::new(100, 30).env("TERM", term).env("LANG", lang).args(&["open", "fir"]);
    let mut workbench = setup.start(&home);
    workbench.wait_for_tree();
    let text = workbench.screen().text();
    for key in ["j", "\t", "l", "\t", "j", "l", "?", "q", ":fir", "\x1b", "e", "\x1b", "S", "q", "u"] {
        workbench.keys(key);
        workbench.settle();
    }
    let bytes = workbench.bytes();
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
    (bytes, text)
}

/// Renditions that set a colour.
fn colored(bytes: &[u8]) -> Vec<String> {
    let (all, _) = tokens(bytes);
    let sgr = all.iter().filter_map(|token| match token {
        Token::Csi(body, b'm') => Some(String::from_utf8_lossy(body).into_owned()),
        _ => None,
    });
    let is_color = |n: &str| n.parse::<u16>().is_ok_and(|n| matches!(n, 30..=49 | 90..=107));
    sgr.filter(|rendition| rendition.split([';', ':']).any(is_color)).collect()
}

#[test]
fn a_dumb_terminal_gets_neither_colours_nor_unicode() {
    let (bytes, text) = tour("dumb", "C");
    assert_eq!(colored(&bytes), Vec::<String>::new());
    let beyond: Vec<u8> = bytes.iter().copied().filter(|byte| !byte.is_ascii()).collect();
    assert!(beyond.is_empty(), "{:?}", String::from_utf8_lossy(&beyond));
    assert!(text.contains("Presets") && text.contains("nodes"), "{text}");
}

#[test]
fn without_unicode_all_is_ascii_in_any_terminal() {
    let (bytes, text) = tour("xterm-256color", "C");
    let beyond: Vec<u8> = bytes.iter().copied().filter(|byte| !byte.is_ascii()).collect();
    assert!(beyond.is_empty(), "{:?}", String::from_utf8_lossy(&beyond));
    assert!(!colored(&bytes).is_empty(), "colours it has: {text}");
}
