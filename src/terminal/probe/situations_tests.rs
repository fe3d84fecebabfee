//! Terminals as people have them: what they set, what they answer, and what follows.
//!
//! Answers are those that the terminals' sources and documentation give, not recordings.

use super::environment::printable;
use super::*;
use crate::cells::Glyphs;
use crate::color::ColorDepth;
use crate::input::{Parser, Reply, Said};
use crate::tty::WindowSize;

use ColorDepth::{Ansi16, Ansi256, None as NoColors, True};
use Graphics::{Cells, Iterm2, Kitty, Sixel};
use Multiplexer::{Screen, Tmux, Zellij};

/// What a situation is expected to come to: graphics, colours, synchronized, multiplexer.
type Expected = (Graphics, ColorDepth, bool, Option<Multiplexer>);

struct Situation {
    name: &'static str,
    environment: &'static [(&'static str, &'static str)],
    /// What the terminal sends back, as bytes.
    answers: &'static str,
    expected: Expected,
}

const XTERM: (&str, &str) = ("TERM", "xterm-256color");
const TRUE_COLOR: (&str, &str) = ("COLORTERM", "truecolor");
const SSH: (&str, &str) = ("SSH_CONNECTION", "10.0.0.2 50000 10.0.0.1 22");

const KITTY_OK: &str = "\x1b_Gi=31;OK\x1b\\";

const SITUATIONS: [Situation; 34] = [
    Situation {
        name: "kitty",
        environment: &[("TERM", "xterm-kitty"), TRUE_COLOR, ("KITTY_WINDOW_ID", "1")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|kitty(0.39.1)\x1b\\\x1b]11;rgb:0000/0000/0000\x1b\\\x1bP1$r48:2:12:34:56m\x1b\\\x1b[6;20;10t\x1b[?2026;2$y\x1b[?62;52;c",
        expected: (Kitty, True, true, None),
    },
    Situation {
        name: "kitty over SSH",
        environment: &[("TERM", "xterm-kitty"), SSH],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|kitty(0.39.1)\x1b\\\x1bP1$r48:2:12:34:56m\x1b\\\x1b[?2026;2$y\x1b[?62;52;c",
        expected: (Kitty, True, true, None),
    },
    Situation {
        name: "ghostty",
        environment: &[("TERM", "xterm-ghostty"), TRUE_COLOR, ("TERM_PROGRAM", "ghostty")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|ghostty 1.1.3\x1b\\\x1b[?2026;2$y\x1b[?62;22;52c",
        expected: (Kitty, True, true, None),
    },
    Situation {
        name: "foot",
        environment: &[("TERM", "foot"), TRUE_COLOR],
        answers: "\x1bP>|foot(1.16.2)\x1b\\\x1b]11;rgb:1818/1818/1818\x1b\\\x1bP1$r0;48:2::12:34:56m\x1b\\\x1b[?2026;2$y\x1b[?62;4;22;28c",
        expected: (Sixel, True, true, None),
    },
    Situation {
        name: "foot over SSH, COLORTERM lost",
        environment: &[XTERM, SSH],
        answers: "\x1bP>|foot(1.16.2)\x1b\\\x1bP1$r0;48:2::12:34:56m\x1b\\\x1b[?2026;2$y\x1b[?62;4;22;28c",
        expected: (Sixel, True, true, None),
    },
    Situation {
        name: "WezTerm, kitty graphics on",
        environment: &[XTERM, TRUE_COLOR, ("TERM_PROGRAM", "WezTerm")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|WezTerm 20240203-110809-5046fc22\x1b\\\x1b[?2026;2$y\x1b[?65;4;6;18;22c",
        expected: (Kitty, True, true, None),
    },
    Situation {
        name: "WezTerm, kitty graphics off, over SSH",
        environment: &[XTERM, SSH],
        answers: "\x1bP>|WezTerm 20240203-110809-5046fc22\x1b\\\x1b[?2026;2$y\x1b[?65;4;6;18;22c",
        expected: (Iterm2, True, true, None),
    },
    Situation {
        name: "iTerm2",
        environment: &[XTERM, TRUE_COLOR, ("TERM_PROGRAM", "iTerm.app"), ("LC_TERMINAL", "iTerm2")],
        answers: "\x1bP>|iTerm2 3.4.23\x1b\\\x1b[?2026;2$y\x1b[?64;1;2;4;6;17;18;21;22c",
        expected: (Iterm2, True, true, None),
    },
    Situation {
        name: "an older iTerm2 over SSH, known by what SSH forwards",
        environment: &[XTERM, SSH, ("LC_TERMINAL", "iTerm2"), ("LC_TERMINAL_VERSION", "3.3.0")],
        answers: "\x1b[?62;4c",
        expected: (Iterm2, True, false, None),
    },
    Situation {
        name: "xterm started from iTerm2, whose variables it hands down",
        environment: &[XTERM, ("TERM_PROGRAM", "iTerm.app"), ("LC_TERMINAL", "iTerm2")],
        answers: "\x1bP>|XTerm(390)\x1b\\\x1b[?64;1;2;6;9;15;16;17;18;21;22;28c",
        expected: (Cells, Ansi256, false, None),
    },
    Situation {
        name: "Konsole",
        environment: &[XTERM, TRUE_COLOR, ("KONSOLE_VERSION", "240202")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|Konsole 24.02.2\x1b\\\x1b[?2026;2$y\x1b[?62;1;4c",
        expected: (Kitty, True, true, None),
    },
    Situation {
        name: "mintty",
        environment: &[XTERM, ("TERM_PROGRAM", "mintty")],
        answers: "\x1bP>|mintty 3.7.1\x1b\\\x1b[?2026;2$y\x1b[?64;1;2;4;6;9;15;21;22;28;29c",
        expected: (Iterm2, True, true, None),
    },
    Situation {
        name: "Windows Terminal 1.22 with WSL",
        environment: &[XTERM, ("WT_SESSION", "6f2d")],
        answers: "\x1b]11;rgb:0c0c/0c0c/0c0c\x1b\\\x1b[6;20;10t\x1b[?2026;2$y\x1b[?61;4;6;7;14;21;22;23;24;28;32;42c",
        expected: (Sixel, True, true, None),
    },
    Situation {
        name: "Windows Terminal 1.16 over SSH",
        environment: &[XTERM, SSH],
        answers: "\x1bP1$r0;48;2;12;34;56m\x1b\\\x1b[?61;6;7;22;23;24;28;32;42c",
        expected: (Cells, True, false, None),
    },
    Situation {
        name: "xterm -ti vt340: sixel",
        environment: &[XTERM],
        answers: "\x1bP>|XTerm(390)\x1b\\\x1b]11;rgb:ffff/ffff/ffff\x1b\\\x1bP1$r0;48:2::12:34:56m\x1b\\\x1b[6;13;6t\x1b[?2026;0$y\x1b[?63;1;2;4;6;9;15;16;22;28c",
        expected: (Sixel, True, false, None),
    },
    Situation {
        name: "xterm without sixel and 24 bits",
        environment: &[("TERM", "xterm")],
        answers: "\x1bP>|XTerm(390)\x1b\\\x1bP1$r0;48;5;23m\x1b\\\x1b[?2026;0$y\x1b[?64;1;2;6;9;15;16;17;18;21;22;28c",
        expected: (Cells, Ansi16, false, None),
    },
    Situation {
        name: "GNOME Terminal (VTE)",
        environment: &[XTERM, TRUE_COLOR, ("VTE_VERSION", "7600")],
        answers: "\x1bP>|VTE(7600)\x1b\\\x1b]11;rgb:1e1e/1e1e/1e1e\x1b\\\x1b[?2026;2$y\x1b[?61;1;21;22;28c",
        expected: (Cells, True, true, None),
    },
    Situation {
        name: "Alacritty",
        environment: &[("TERM", "alacritty"), TRUE_COLOR],
        answers: "\x1b]11;rgb:1818/1818/1818\x1b\\\x1b[?2026;2$y\x1b[?6c",
        expected: (Cells, True, true, None),
    },
    Situation {
        name: "VS Code with images",
        environment: &[XTERM, TRUE_COLOR, ("TERM_PROGRAM", "vscode"), ("TERM_PROGRAM_VERSION", "1.98.0")],
        answers: "\x1b]11;rgb:1f1f/1f1f/1f1f\x1b\\\x1b[?62;4;9;22c",
        expected: (Sixel, True, false, None),
    },
    Situation {
        name: "VS Code without images",
        environment: &[XTERM, TRUE_COLOR, ("TERM_PROGRAM", "vscode")],
        answers: "\x1b]11;rgb:1f1f/1f1f/1f1f\x1b\\\x1b[?1;2c",
        expected: (Cells, True, false, None),
    },
    Situation {
        name: "Terminal.app",
        environment: &[XTERM, ("TERM_PROGRAM", "Apple_Terminal"), ("TERM_PROGRAM_VERSION", "453")],
        answers: "\x1b]11;rgb:ffff/ffff/ffff\x07\x1b[?1;2c",
        expected: (Cells, Ansi256, false, None),
    },
    Situation {
        name: "tmux 3.5 with sixel, inside a terminal with sixel",
        environment: &[("TERM", "tmux-256color"), TRUE_COLOR, ("TMUX", "/tmp/tmux-1000/default,1,0")],
        answers: "\x1bP>|tmux 3.5a\x1b\\\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[6;20;10t\x1b[?1;2;4c",
        expected: (Sixel, True, false, Some(Tmux)),
    },
    Situation {
        name: "tmux 3.5 without sixel inside kitty, whose answers come through",
        environment: &[
            ("TERM", "tmux-256color"),
            ("TMUX", "/tmp/tmux-1000/default,1,0"),
            ("KITTY_WINDOW_ID", "1"),
        ],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|tmux 3.5a\x1b\\\x1b[?2026;2$y\x1bP1$r48:2:12:34:56m\x1b\\\x1b[?1;2c",
        expected: (Cells, Ansi256, false, Some(Tmux)),
    },
    Situation {
        name: "tmux that calls itself screen, at the other end of SSH",
        environment: &[("TERM", "screen-256color"), SSH],
        answers: "\x1bP>|tmux 3.5a\x1b\\\x1b[?1;2;4c",
        expected: (Sixel, Ansi256, false, Some(Tmux)),
    },
    Situation {
        name: "screen, with what it inherited",
        environment: &[
            ("TERM", "screen.xterm-256color"),
            TRUE_COLOR,
            ("STY", "1234.pts-0"),
            ("TERM_PROGRAM", "iTerm.app"),
        ],
        answers: "\x1b[?1;2;4c",
        expected: (Cells, Ansi256, false, Some(Screen)),
    },
    Situation {
        name: "Zellij",
        environment: &[XTERM, TRUE_COLOR, ("ZELLIJ", "0")],
        answers: "\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[?62;4;22c",
        expected: (Sixel, True, false, Some(Zellij)),
    },
    Situation {
        name: "mosh, which lets nothing through",
        environment: &[XTERM, SSH],
        answers: "\x1b[?62c",
        expected: (Cells, Ansi256, false, None),
    },
    Situation {
        name: "the Linux console",
        environment: &[("TERM", "linux")],
        answers: "\x1b[?6c",
        expected: (Cells, Ansi16, false, None),
    },
    Situation {
        name: "a mute terminal, whatever its variables say",
        environment: &[XTERM, ("TERM_PROGRAM", "iTerm.app"), ("KITTY_WINDOW_ID", "1")],
        answers: "",
        expected: (Cells, Ansi256, false, None),
    },
    Situation {
        name: "NO_COLOR in kitty",
        environment: &[("TERM", "xterm-kitty"), TRUE_COLOR, ("NO_COLOR", "1")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|kitty(0.39.1)\x1b\\\x1b[?2026;2$y\x1b[?62;52;c",
        expected: (Cells, NoColors, true, None),
    },
    Situation {
        name: "a dumb terminal",
        environment: &[("TERM", "dumb")],
        answers: "",
        expected: (Cells, NoColors, false, None),
    },
    Situation { name: "no TERM", environment: &[], answers: "", expected: (Cells, NoColors, false, None) },
    Situation {
        name: "FORCE_COLOR=1 is a wish, not a lack",
        environment: &[("TERM", "xterm-kitty"), ("FORCE_COLOR", "1")],
        answers: "\x1b_Gi=31;OK\x1b\\\x1bP>|kitty(0.39.1)\x1b\\\x1bP1$r48:2:12:34:56m\x1b\\\x1b[?62;52;c",
        expected: (Kitty, Ansi16, false, None),
    },
    Situation {
        name: "a VT340: class 4 terminals are none of sixel's",
        environment: &[("TERM", "vt340")],
        answers: "\x1b[?4;1;2c",
        expected: (Cells, Ansi16, false, None),
    },
];

fn findings(answers: &str) -> Findings {
    let (mut parser, mut events, mut findings) = (Parser::default(), Vec::new(), Findings::default());
    parser.feed(answers.as_bytes(), &mut events);
    for event in &events {
        let Said::Reply(reply) = event else { panic!("{event:?}") };
        findings.take(reply);
    }
    findings.give_up();
    findings
}

#[test]
fn situations() {
    for Situation { name, environment, answers, expected } in SITUATIONS {
        let environment = Environment::from_pairs(environment.iter().copied());
        let found = Capabilities::conclude(&findings(answers), &environment, &Overrides::default());
        let got =
            (found.graphics.value, found.colors.value, found.synchronized.value, found.multiplexer.value);
        assert_eq!(got, expected, "{name}: {found:#?}");
        assert_eq!(found.remote.value, environment.get("SSH_CONNECTION").is_some(), "{name}");
        for (row, value, why) in found.rows() {
            assert!(!value.is_empty() && !why.is_empty(), "{name}: {row}");
        }
    }
}

#[test]
fn before_any_answer_nothing_is_promised() {
    let environment = Environment::from_pairs([XTERM, ("TERM_PROGRAM", "WezTerm"), TRUE_COLOR]);
    let found = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
    assert_eq!((found.graphics.value, found.colors.value), (Cells, True));
    assert_eq!(found.graphics.why, "the terminal has not answered yet");
    assert!(found.dark.value && !found.synchronized.value);
}

#[test]
fn late_answers_count_and_the_first_of_a_kind() {
    let mut findings = Findings::default();
    assert!(!findings.is_settled());
    findings.give_up();
    assert!(findings.is_settled() && !findings.is_complete());
    assert!(findings.take(&Reply::KittyGraphics { id: 31, ok: true }));
    assert!(!findings.take(&Reply::KittyGraphics { id: 2, ok: false }), "that is about another image");
    assert!(!findings.take(&Reply::Status) && !findings.take(&Reply::Mode { number: 1004, known: true }));
    assert!(findings.take(&Reply::Attributes(vec![62])));
    assert!(findings.is_complete());
    let found = Capabilities::conclude(&findings, &Environment::default(), &Overrides::default());
    assert_eq!(found.graphics.why, "pictures have colours, and there are to be none");
    let environment = Environment::from_pairs([XTERM]);
    let found = Capabilities::conclude(&findings, &environment, &Overrides::default());
    assert_eq!(found.graphics.value, Kitty);
}

#[test]
fn glyphs_follow_colors_and_fonts() {
    for (environment, expected) in [
        (&[XTERM][..], Glyphs::Quadrants),
        (&[("TERM", "linux")], Glyphs::Halves),
        (&[XTERM, ("NO_COLOR", "1")], Glyphs::Braille),
    ] {
        let environment = Environment::from_pairs(environment.iter().copied());
        let found = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
        assert_eq!(found.glyphs.value, expected, "{environment:?}");
    }
}

#[test]
fn dark_or_light() {
    let dark = |answers: &str, environment: &[(&'static str, &'static str)]| {
        let environment = Environment::from_pairs(environment.iter().copied());
        Capabilities::conclude(&findings(answers), &environment, &Overrides::default()).dark.value
    };
    assert!(!dark("\x1b]11;rgb:fdfd/f6f6/e3e3\x1b\\", &[("COLORFGBG", "15;0")]));
    assert!(dark("\x1b]11;rgb:0000/2b2b/3636\x1b\\", &[("COLORFGBG", "0;15")]));
    for (colors, expected) in [
        ("15;0", true),
        ("0;15", false),
        ("0;7", false),
        ("7;8", true),
        ("0;default;15", false),
        ("0;default", true),
        ("x", true),
    ] {
        assert_eq!(dark("", &[("COLORFGBG", colors)]), expected, "{colors}");
    }
}

#[test]
fn the_cell_is_what_the_terminal_says_then_what_the_system_knows() {
    let mut findings = Findings::default();
    let cell = |findings: &Findings| {
        Capabilities::conclude(findings, &Environment::default(), &Overrides::default()).cell_px.value
    };
    findings.take_window(WindowSize { columns: 80, rows: 24, width_px: 0, height_px: 0 });
    assert_eq!(cell(&findings), None);
    findings.take_window(WindowSize { columns: 80, rows: 24, width_px: 810, height_px: 480 });
    assert_eq!(cell(&findings), Some((10, 20)));
    for (width, height) in [(65535, 65535), (300, 600), (1, 200), (90, 18)] {
        assert!(!findings.take(&Reply::CellPixels { width, height }), "no font has such a cell");
    }
    findings.take(&Reply::CellPixels { width: 9, height: 18 });
    assert_eq!(cell(&findings), Some((9, 18)));
}

#[test]
fn what_is_insisted_on_comes_first() {
    let kitty = Environment::from_pairs([("TERM", "xterm-kitty"), TRUE_COLOR]);
    let findings = findings(&format!("{KITTY_OK}\x1b[?62c"));
    for (name, graphics, glyphs) in [
        ("kitty", Kitty, Glyphs::Quadrants),
        ("sixel", Sixel, Glyphs::Quadrants),
        ("iterm2", Iterm2, Glyphs::Quadrants),
        ("quadrants", Cells, Glyphs::Quadrants),
        ("halves", Cells, Glyphs::Halves),
        ("braille", Cells, Glyphs::Braille),
        ("ascii", Cells, Glyphs::Ascii),
        ("auto", Kitty, Glyphs::Quadrants),
    ] {
        let mut overrides = Overrides::default();
        overrides.set_graphics("sixel", "graphics").unwrap();
        overrides.set_graphics(name, "--graphics").unwrap();
        let found = Capabilities::conclude(&findings, &kitty, &overrides);
        assert_eq!((found.graphics.value, found.glyphs.value), (graphics, glyphs), "{name}");
        assert_eq!(found.graphics.why.contains("--graphics asks for it"), name != "auto", "{name}");
    }
    for (name, colors) in [("truecolor", True), ("256", Ansi256), ("16", Ansi16), ("none", NoColors)] {
        let environment =
            Environment::from_pairs([("TERM", "xterm"), ("LINDEN_COLORS", name), ("NO_COLOR", "1")]);
        let overrides = Overrides::from_environment(&environment).unwrap();
        let found = Capabilities::conclude(&findings, &environment, &overrides);
        assert_eq!(found.colors.value, colors);
        assert_eq!(found.colors.why, "LINDEN_COLORS asks for it");
    }
    // NO_COLOR is about text; who asks for pictures gets them.
    let environment = Environment::from_pairs([XTERM, ("LINDEN_GRAPHICS", "kitty"), ("NO_COLOR", "1")]);
    let overrides = Overrides::from_environment(&environment).unwrap();
    assert_eq!(Capabilities::conclude(&findings, &environment, &overrides).graphics.value, Kitty);
}

#[test]
fn a_bad_override_names_what_is_allowed() {
    let environment = Environment::from_pairs([("LINDEN_GRAPHICS", "Kitty\x1b[31m")]);
    assert_eq!(
        Overrides::from_environment(&environment).unwrap_err().to_string(),
        "LINDEN_GRAPHICS: 'Kitty\\u{1b}[31m' is none of kitty, sixel, iterm2, quadrants, halves, braille, ascii, auto"
    );
    let environment = Environment::from_pairs([("LINDEN_COLORS", "8")]);
    assert_eq!(
        Overrides::from_environment(&environment).unwrap_err().to_string(),
        "LINDEN_COLORS: '8' is none of truecolor, 256, 16, none, auto"
    );
    let unset = Environment::from_pairs([("LINDEN_COLORS", "")]);
    assert_eq!(Overrides::from_environment(&unset), Ok(Overrides::default()));
}

#[test]
fn nothing_that_a_terminal_says_of_itself_is_shown_raw() {
    let evil = "x\x1b]0;owned\x07\u{202e}\u{200b}\u{9b}31m";
    let mut findings = Findings::default();
    findings.take(&Reply::Version(format!("kitty{evil}")));
    findings.take(&Reply::Attributes(vec![1]));
    let environment = Environment::from_pairs([("TERM", evil), ("COLORFGBG", evil), ("COLORTERM", evil)]);
    let found = Capabilities::conclude(&findings, &environment, &Overrides::default());
    for (row, value, why) in found.rows() {
        let shown = format!("{value}{why}");
        assert!(
            !shown.chars().any(|c| c.is_control() || matches!(c, '\u{202e}' | '\u{200b}')),
            "{row}: {shown:?}"
        );
    }
    assert_eq!(printable("ä\u{2066}\n"), "ä\\u{2066}\\u{a}");
    assert_eq!(printable(&"a".repeat(500)).chars().count(), 61);
}

#[test]
fn what_is_asked() {
    let asked = |environment: &[(&'static str, &'static str)]| {
        String::from_utf8(queries(&Environment::from_pairs(environment.iter().copied()))).unwrap()
    };
    assert_eq!(
        asked(&[XTERM]),
        "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[>0q\x1b]11;?\x1b\\\x1b[48;2;12;34;56m\x1bP$qm\x1b\\\x1b[m\x1b[16t\x1b[?2026$p\x1b[c"
    );
    assert_eq!(asked(&[("TERM", "dumb")]), "");
    assert_eq!(asked(&[]), "");
    for environment in [
        &[("TERM", "linux")][..],
        &[XTERM, ("TERM_PROGRAM", "Apple_Terminal")],
        &[("TERM", "screen"), ("STY", "1")],
        &[("TERM", "screen-256color")],
        &[("TERM", "tmux-256color"), ("TMUX", "x")],
        &[XTERM, ("ZELLIJ", "0")],
    ] {
        let asked = asked(environment);
        assert!(asked.ends_with("\x1b[c"), "{environment:?}");
        assert!(!asked.contains("\x1b_") && !asked.contains("\x1bP"), "{environment:?}");
    }
}

#[test]
fn what_is_not_unicode_says_so() {
    let unicode = |pairs: &[(&'static str, &str)]| {
        let environment = Environment::from_pairs(pairs.iter().copied());
        let found = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
        assert_eq!(found.glyphs.value == Glyphs::Ascii, !found.unicode.value, "{pairs:?}");
        (found.unicode.value, found.unicode.why)
    };
    for (pairs, expected) in [
        (&[("TERM", "xterm")][..], true),
        (&[("TERM", "xterm"), ("LANG", "C")], false),
        (&[("TERM", "xterm"), ("LANG", "POSIX")], false),
        (&[("TERM", "xterm"), ("LANG", "C.UTF-8")], true),
        (&[("TERM", "xterm"), ("LANG", "de_DE.utf8")], true),
        (&[("TERM", "xterm"), ("LANG", "de_DE@euro")], true),
        (&[("TERM", "xterm"), ("LANG", "de_DE.ISO-8859-15@euro")], false),
        (&[("TERM", "xterm"), ("LANG", "en_US.UTF-8"), ("LC_ALL", "C")], false),
        (&[("TERM", "xterm"), ("LC_CTYPE", "en_US.UTF-8"), ("LANG", "C")], true),
        (&[("TERM", "dumb"), ("LANG", "en_US.UTF-8")], false),
    ] {
        assert_eq!(unicode(pairs).0, expected, "{pairs:?}");
    }
    assert_eq!(unicode(&[("LANG", "C")]).1, "LANG=C");
}
