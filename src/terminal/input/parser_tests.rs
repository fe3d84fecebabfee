//! Sequences as the specifications have them, and what holds for any bytes.

use proptest::prelude::*;

use crossterm::event::{MouseButton, MouseEvent, MouseEventKind};

use super::*;
use crate::input::{Reply, Shortcut};

/// All at once, and whatever is left after a silence.
fn events(bytes: &[u8]) -> Vec<Said> {
    let (mut parser, mut out) = (Parser::default(), Vec::new());
    parser.feed(bytes, &mut out);
    parser.flush(&mut out);
    assert!(!parser.is_pending() && parser.timeout().is_none());
    out
}

/// Keys by their names.
fn keys(names: &str) -> Vec<Said> {
    names.split_whitespace().map(|name| said(name.parse::<Shortcut>().unwrap().into())).collect()
}

fn assert_keys(table: &[(&str, &str)]) {
    for (bytes, names) in table {
        assert_eq!(events(bytes.as_bytes()), keys(names), "{bytes:?}");
    }
}

fn mouse(kind: MouseEventKind, column: u16, row: u16) -> MouseEvent {
    MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE }
}

#[test]
fn characters_and_control_characters() {
    assert_keys(&[
        ("qG?~", "q G ? ~"),
        (" ", "space"),
        ("é", "é"),
        ("日本", "日 本"),
        ("🌳", "🌳"),
        ("\r\t", "enter tab"),
        ("\u{7f}\u{8}", "backspace backspace"),
        ("\0", "ctrl-space"),
        ("\u{1}\u{3}\n\u{12}\u{1a}", "ctrl-a ctrl-c ctrl-j ctrl-r ctrl-z"),
        ("\u{1c}\u{1d}\u{1e}\u{1f}", "ctrl-\\ ctrl-] ctrl-^ ctrl-_"),
        ("\x1b", "esc"),
        ("\x1bx\x1bG\x1b/", "alt-x alt-G alt-/"),
        ("\x1bé", "alt-é"),
        ("\x1b\r\x1b\u{7f}\x1b\u{3}", "alt-enter alt-backspace ctrl-alt-c"),
        ("\x1b\x1b", "esc esc"),
        ("\x1b\x1bx", "esc alt-x"),
        ("\x1b[", "alt-["),
        ("\x1bO", "alt-O"),
        ("\x1b]", "alt-]"),
        ("\x1b_", "alt-_"),
    ]);
}

/// xterm ctlseqs, "PC-Style Function Keys" and "VT220-Style Function Keys".
#[test]
fn keys_of_xterm() {
    assert_keys(&[
        ("\x1b[A\x1b[B\x1b[C\x1b[D", "up down right left"),
        ("\x1bOA\x1bOB\x1bOC\x1bOD", "up down right left"),
        ("\x1b[H\x1b[F\x1bOH\x1bOF", "home end home end"),
        ("\x1b[1~\x1b[2~\x1b[3~\x1b[4~\x1b[5~\x1b[6~", "home insert delete end pageup pagedown"),
        ("\x1bOP\x1bOQ\x1bOR\x1bOS", "f1 f2 f3 f4"),
        ("\x1b[11~\x1b[12~\x1b[13~\x1b[14~\x1b[15~", "f1 f2 f3 f4 f5"),
        ("\x1b[17~\x1b[18~\x1b[19~\x1b[20~\x1b[21~\x1b[23~\x1b[24~", "f6 f7 f8 f9 f10 f11 f12"),
        ("\x1b[Z", "shift-tab"),
        ("\x1b[1;2A\x1b[1;3B\x1b[1;5C\x1b[1;6D", "shift-up alt-down ctrl-right ctrl-shift-left"),
        ("\x1b[1;5H\x1b[1;4F\x1b[1;7H", "ctrl-home alt-shift-end ctrl-alt-home"),
        ("\x1b[3;5~\x1b[5;2~\x1b[6;3~", "ctrl-delete shift-pageup alt-pagedown"),
        ("\x1b[1;2P\x1b[1;5Q\x1b[1;2R\x1b[1;3S", "shift-f1 ctrl-f2 shift-f3 alt-f4"),
        ("\x1b[15;2~", "shift-f5"),
        // Meta is beyond what is told apart; with Super it is the desktop's.
        ("\x1b[1;33A\x1b[1;9A", "alt-up"),
        ("\x1b[27;5;13~\x1b[27;6;114~\x1b[27;2;13~", "ctrl-enter ctrl-R shift-enter"),
        // The keypad in application mode.
        ("\x1bOM\x1bOk\x1bOm\x1bOp\x1bOy\x1bOX\x1bOj", "enter + - 0 9 = *"),
        ("\x1b\x1b[A\x1b\x1bOB", "alt-up alt-down"),
    ]);
}

/// urxvt(7), "Key Codes"; `ESC O 5 A` is from older xterms.
#[test]
fn keys_of_others() {
    assert_keys(&[
        ("\x1b[a\x1b[b\x1b[c\x1b[d", "shift-up shift-down shift-right shift-left"),
        ("\x1bOa\x1bOb\x1bOc\x1bOd", "ctrl-up ctrl-down ctrl-right ctrl-left"),
        ("\x1b[7~\x1b[8~\x1b[7$\x1b[8^\x1b[3@", "home end shift-home ctrl-end ctrl-shift-delete"),
        ("\x1b[5$x", "shift-pageup x"),
        ("\x1b[[A\x1b[[E", "f1 f5"),
        ("\x1bO5A\x1bO1;2P", "ctrl-up shift-f1"),
    ]);
}

/// <https://sw.kovidgoyal.net/kitty/keyboard-protocol/>
#[test]
fn keys_of_kitty() {
    assert_keys(&[
        ("\x1b[97u", "a"),
        ("\x1b[97;5u\x1b[97;3u\x1b[32;5u", "ctrl-a alt-a ctrl-space"),
        ("\x1b[97;2u\x1b[97:65;2u\x1b[49:33;2u", "A A !"),
        ("\x1b[27u\x1b[13;2u\x1b[9;2u\x1b[127;5u", "esc shift-enter shift-tab ctrl-backspace"),
        ("\x1b[97;1:1u\x1b[97;1:2u\x1b[97;1:3u", "a a"),
        ("\x1b[1;1:3A\x1b[3;1:3~\x1b[1;1:1B", "down"),
        ("\x1b[97;65u\x1b[97;129u", "a a"),
        ("\x1b[97;9u\x1b[57358u\x1b[57441;2u", ""),
        ("\x1b[57399u\x1b[57413u\x1b[57414u\x1b[57419;5u", "0 + enter ctrl-up"),
    ]);
}

/// xterm ctlseqs, "Mouse Tracking".
#[test]
fn the_mouse() {
    use MouseEventKind::{Down, Drag, ScrollDown, ScrollUp, Up};
    for (bytes, expected) in [
        ("\x1b[<0;1;1M", Some(mouse(Down(MouseButton::Left), 0, 0))),
        ("\x1b[<1;80;24M", Some(mouse(Down(MouseButton::Middle), 79, 23))),
        ("\x1b[<2;300;200M", Some(mouse(Down(MouseButton::Right), 299, 199))),
        ("\x1b[<0;5;6m", Some(mouse(Up(MouseButton::Left), 4, 5))),
        ("\x1b[<32;5;6M", Some(mouse(Drag(MouseButton::Left), 4, 5))),
        ("\x1b[<34;5;6M", Some(mouse(Drag(MouseButton::Right), 4, 5))),
        ("\x1b[<64;5;6M", Some(mouse(ScrollUp, 4, 5))),
        ("\x1b[<65;5;6M", Some(mouse(ScrollDown, 4, 5))),
        (
            "\x1b[<4;5;6M",
            Some(MouseEvent { modifiers: KeyModifiers::SHIFT, ..mouse(Down(MouseButton::Left), 4, 5) }),
        ),
        (
            "\x1b[<56;5;6M",
            Some(MouseEvent {
                modifiers: KeyModifiers::ALT | KeyModifiers::CONTROL,
                ..mouse(Drag(MouseButton::Left), 4, 5)
            }),
        ),
        ("\x1b[<81;5;6M", Some(MouseEvent { modifiers: KeyModifiers::CONTROL, ..mouse(ScrollDown, 4, 5) })),
        // Mere motion, a wheel sideways, more buttons, cells that do not exist.
        ("\x1b[<35;5;6M", None),
        ("\x1b[<66;5;6M", None),
        ("\x1b[<128;5;6M", None),
        ("\x1b[<0;0;6M", None),
        ("\x1b[<0;65537;6M", None),
        ("\x1b[<0;5M", None),
        // X10 and urxvt.
        ("\x1b[M !!", None),
        ("\x1b[M qq", None),
        ("\x1b[32;5;6M", None),
    ] {
        let expected: Vec<_> = expected.map(|mouse| Said::Event(Event::Mouse(mouse))).into_iter().collect();
        assert_eq!(events(bytes.as_bytes()), expected, "{bytes:?}");
    }
}

#[test]
fn focus_and_pasted_text() {
    assert_eq!(events(b"\x1b[I\x1b[O"), [Event::FocusGained, Event::FocusLost].map(Said::Event));
    for (bytes, text) in [
        ("\x1b[200~q\rΩ\x1b[201~", "q\rΩ"),
        ("\x1b[200~\x1b[201~", ""),
        ("\x1b[200~\x1b[A\x03\x1b[20\x1b\x1b[201~", "\x1b[A\x03\x1b[20\x1b"),
        // No end: what came is the text.
        ("\x1b[200~half\x1b[2", "half\x1b[2"),
    ] {
        assert_eq!(events(bytes.as_bytes()), [Said::Event(Event::Paste(text.to_owned()))], "{bytes:?}");
    }
    assert_eq!(events(b"\x1b[200~\xff\x1b[201~\x1b[201~q")[1..], keys("q"), "a stray end is nothing");
}

#[test]
fn replies() {
    let reply = |bytes: &str| match &events(bytes.as_bytes())[..] {
        [] => None,
        [Said::Reply(reply)] => Some(reply.clone()),
        other => panic!("{bytes:?}: {other:?}"),
    };
    for (bytes, expected) in [
        // xterm ctlseqs: DSR, DA1, DECRPM, XTWINOPS 16, XTVERSION, DECRQSS, OSC 11.
        ("\x1b[0n", Some(Reply::Status)),
        ("\x1b[3n", None),
        ("\x1b[?64;1;2;4c", Some(Reply::Attributes(vec![64, 1, 2, 4]))),
        ("\x1b[?6c", Some(Reply::Attributes(vec![6]))),
        ("\x1b[?2026;2$y", Some(Reply::Mode { number: 2026, known: true })),
        ("\x1b[?2026;1$y", Some(Reply::Mode { number: 2026, known: true })),
        ("\x1b[?2026;0$y", Some(Reply::Mode { number: 2026, known: false })),
        ("\x1b[?2026;4$y", Some(Reply::Mode { number: 2026, known: false })),
        ("\x1b[6;20;10t", Some(Reply::CellPixels { width: 10, height: 20 })),
        ("\x1b[6;0;10t", None),
        ("\x1bP>|XTerm(390)\x1b\\", Some(Reply::Version("XTerm(390)".into()))),
        ("\x1bP1$r0;48:2::12:34:56m\x1b\\", Some(Reply::Rendition("0;48:2::12:34:56".into()))),
        ("\x1bP0$r\x1b\\", None),
        ("\x1bP1$r2 q\x1b\\", None),
        ("\x1b]11;rgb:1d1d/2020/ffff\x07", Some(Reply::Background([0x1d, 0x20, 0xff]))),
        ("\x1b]11;rgb:1d/20/ff\x1b\\", Some(Reply::Background([0x1d, 0x20, 0xff]))),
        ("\x1b]11;rgb:0/8/f\x1b\\", Some(Reply::Background([0, 0x88, 0xff]))),
        ("\x1b]11;rgb:fff/000/800\x1b\\", Some(Reply::Background([255, 0, 128]))),
        ("\x1b]11;rgba:0000/8080/ffff/c0c0\x1b\\", Some(Reply::Background([0, 128, 255]))),
        ("\x1b]11;rgb:+1/20/ff\x1b\\", None),
        ("\x1b]11;rgb:12345/20/ff\x1b\\", None),
        ("\x1b]11;rgb:1/2\x1b\\", None),
        ("\x1b]10;rgb:1/2/3\x1b\\", None),
        // kitty graphics, "Querying support".
        ("\x1b_Gi=31;OK\x1b\\", Some(Reply::KittyGraphics { id: 31, ok: true })),
        ("\x1b_Gi=31;ENOTSUPPORTED:no\x1b\\", Some(Reply::KittyGraphics { id: 31, ok: false })),
        ("\x1b_other\x1b\\", None),
    ] {
        assert_eq!(reply(bytes), expected, "{bytes:?}");
    }
}

#[test]
fn what_is_not_understood_is_not_typed() {
    for bytes in [
        &b"\x1b[>64;20;0c"[..],
        b"\x1b[12;40R",
        b"\x1b[?1;2;3S",
        b"\x1b[999~",
        b"\x1b[99999999999999999999A",
        b"\x1b[+1A",
        b"\x1b[1;2;q",
        b"\x1b[?0u",
        b"\x1b[29~",
        b"\x1bOz",
        b"\x1b]52;c;cXVpdA==\x07",
        b"\x1b^quit\x1b\\",
        b"\x1bXquit\x1b\\",
        b"\x1bPquit\x18",
        b"\x1b[?6;4",
        b"\x1b]11;rgb:1d1d/20",
        b"\x80\x9b\xc0\xff",
        b"\xc2\x9b",
        b"\xed\xa0\x80",
    ] {
        assert_eq!(events(bytes), [], "{}", bytes.escape_ascii());
    }
    assert_eq!(events(b"\xe6\x97q"), keys("q"), "half a character");
}

#[test]
fn replies_between_keys_stay_apart() {
    let found = events(b"a\x1b[0nb\x1b\x1b[0nc\x1b\x1b]11;rgb:0/0/0\x07");
    let black = Said::Reply(Reply::Background([0; 3]));
    let status = || vec![Said::Reply(Reply::Status)];
    let expected = [keys("a"), status(), keys("b esc"), status(), keys("c esc"), vec![black]].concat();
    assert_eq!(found, expected);
}

#[test]
fn a_string_without_an_end_is_got_out_of() {
    let long = vec![b'x'; 4 * STRING_LIMIT];
    for begin in ["\x1bP>|", "\x1b]", "\x1b_G", "\x1b^"] {
        for (end, names) in [
            ("\u{3}q", "ctrl-c q"),
            ("\x1b\x1b[A", "alt-up"),
            ("\x1b[Aq", "up q"),
            ("\x1b", "esc"),
            ("\x1b\\q", "q"),
        ] {
            let (mut parser, mut out) = (Parser::default(), Vec::new());
            parser.feed(begin.as_bytes(), &mut out);
            parser.feed(&long, &mut out);
            assert!(parser.held.capacity() <= 2 * STRING_LIMIT);
            parser.feed(end.as_bytes(), &mut out);
            parser.flush(&mut out);
            assert_eq!(out, keys(names), "{begin:?} {end:?}");
        }
    }
}

#[test]
fn a_paste_without_an_end_does_not_grow() {
    let (mut parser, mut out) = (Parser::default(), Vec::new());
    parser.feed(b"\x1b[200~a", &mut out);
    // Three bytes each: the limit falls into a character.
    let piece = "木".repeat(10_000);
    for _ in 0..100 {
        parser.feed(piece.as_bytes(), &mut out);
        assert!(parser.held.capacity() <= 2 * PASTE_LIMIT);
    }
    assert_eq!(out, []);
    parser.feed(b"\x1b[201~q", &mut out);
    let Said::Event(Event::Paste(text)) = &out[0] else { panic!("{:?}", out[0]) };
    assert!((PASTE_LIMIT - 3..=PASTE_LIMIT).contains(&text.len()) && !text.contains('\u{fffd}'));
    assert_eq!(out[1..], keys("q"));
    assert!(parser.held.capacity() < PASTE_LIMIT, "what was pasted is not kept");
}

#[test]
fn silence_is_waited_for_as_long_as_it_says_something() {
    let timeout = |bytes: &[u8]| {
        let mut parser = Parser::default();
        parser.feed(bytes, &mut Vec::new());
        parser.timeout()
    };
    assert_eq!(timeout(b"q"), None);
    for (bytes, expected) in [
        (&b"\x1b"[..], KEY_TIMEOUT),
        (b"\x1b[", KEY_TIMEOUT),
        (b"\x1b[?6", SEQUENCE_TIMEOUT),
        (b"\x1bP>|x", SEQUENCE_TIMEOUT),
        (b"\x1bP>|x\x1b", KEY_TIMEOUT),
        (b"\x1b[200~", PASTE_TIMEOUT),
    ] {
        assert_eq!(timeout(bytes), Some(expected), "{}", bytes.escape_ascii());
    }
}

/// Whole sequences, halves of them, and noise.
fn pieces() -> impl Strategy<Value = Vec<u8>> {
    let known = prop::sample::select(vec![
        &b"\x1b"[..],
        b"\x1b[",
        b"\x1b[1;5A",
        b"\x1b[<0;12;7M",
        b"\x1b[M #~",
        b"\x1b[200~",
        b"\x1b[201~",
        b"\x1b[3$",
        b"\x1b[[",
        b"\x1bO",
        b"\x1bP>|foot(1.16.2)",
        b"\x1b\\",
        b"\x1b]11;rgb:1/2/3",
        b"\x07",
        b"\x1b_Gi=31;OK\x1b\\",
        b"\x1b[?62;4c",
        b"\x1b[97;2:3u",
        b"\xf0\x9f\x8c\xb3",
        b"\xc3\xa9",
        b"\x03\x18\x00",
        b"q",
    ]);
    let piece = prop_oneof![
        3 => known.prop_map(<[u8]>::to_vec),
        1 => prop::collection::vec(any::<u8>(), 1..6),
        1 => prop::collection::vec(0x20..0x7f_u8, 1..4),
    ];
    prop::collection::vec(piece, 0..24).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn how_bytes_are_cut_changes_nothing(bytes in pieces(), cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..12)) {
        let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(bytes.len() + 1)).collect();
        cuts.sort_unstable();
        let (mut parser, mut out) = (Parser::default(), Vec::new());
        let mut from = 0;
        for cut in cuts.into_iter().chain([bytes.len()]) {
            parser.feed(&bytes[from..cut], &mut out);
            from = cut;
        }
        parser.flush(&mut out);
        prop_assert_eq!(out, events(&bytes));
    }

    #[test]
    fn any_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..4096)) {
        let found = events(&bytes);
        prop_assert!(found.len() <= 2 * bytes.len());
    }

    /// Whatever came before, one key after a silence is that key.
    #[test]
    fn silence_brings_it_back(bytes in pieces()) {
        let (mut parser, mut out) = (Parser::default(), Vec::new());
        parser.feed(&bytes, &mut out);
        parser.flush(&mut out);
        out.clear();
        parser.feed(b"q", &mut out);
        prop_assert_eq!(out, keys("q"));
    }
}
