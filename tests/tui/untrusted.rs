//! Nothing that comes from a file reaches the terminal raw.

use std::os::unix::ffi::OsStrExt as _;

use crate::harness::{Answers, Home, Setup, Token, Workbench, find, tokens};

/// What a file may try: colours and clearing, the clipboard, the title, C1 controls, writing that
/// runs the other way, invisible characters.
const EVIL: &str = "\u{1b}[31mEVIL\u{1b}[2J\u{1b}]52;c;ZXZpbA==\u{7}\u{1b}]0;evil\u{7}\u{1b}P$qm\u{1b}\\\u{9b}31m\u{9d}0;evil\u{9c}\u{202e}live\u{2066}\u{200b}\u{feff}\r\n\u{8}\u{7f}";

/// The same for TOML, which takes control characters only as escapes.
fn in_toml(text: &str) -> String {
    text.chars()
        .map(|c| {
            if c.is_control() || c == '\\' || c as u32 > 0x2000 {
                format!("\\u{:04x}", c as u32)
            } else {
                c.to_string()
            }
        })
        .collect()
}

/// Fails when anything of [`EVIL`] is in what was sent as it stood in the file.
#[track_caller]
fn is_clean(workbench: &Workbench) {
    let bytes = workbench.bytes();
    for raw in [
        "\u{1b}[31mEVIL",
        "\u{1b}]52;",
        "\u{1b}]0;",
        "\u{9b}",
        "\u{9c}",
        "\u{9d}",
        "\u{202e}",
        "\u{2066}",
        "\u{200b}",
        "\u{feff}",
        "\u{7f}",
    ] {
        assert_eq!(find(&bytes, raw.as_bytes()), None, "{raw:?} is sent");
    }
    // Bytes that are C1 controls to a terminal that does not read UTF-8 come only within characters.
    let text = String::from_utf8(bytes.clone()).expect("all of it is UTF-8");
    assert!(!text.chars().any(|c| ('\u{80}'..'\u{a0}').contains(&c)));
    for token in tokens(&bytes).0 {
        match token {
            Token::Control(byte) => assert!(b"\r\n\x08".contains(&byte), "control {byte:#x}"),
            Token::Escape(body) => panic!("ESC {body:?}"),
            _ => {}
        }
    }
}

/// Looks at everything that could show it.
fn tour(workbench: &Workbench) -> String {
    let mut seen = String::new();
    for key in [
        "", "G", "k", "k", "k", "k", "\t", "\t", "\x1b[Z", "m", "q", "?", "q", ":", "\x1b", "/EVIL", "\r",
        "\x1b[Z", "\t", "y",
    ] {
        workbench.keys(key);
        workbench.settle();
        seen += &workbench.screen().text();
        // The copied line is sent as base64, which is meant.
        if key == "\t" {
            is_clean(workbench);
        }
    }
    seen
}

#[test]
fn names_and_comments_of_presets_are_shown_without_what_they_could_do() {
    let home = Home::new();
    let evil = in_toml(EVIL);
    let body = "id = \"evil\"\n[colonization]\ncrown = \"sphere\"\npoints = 100\n";
    home.write(
        "config/presets/evil.toml",
        format!("name = \"{evil}\"\ngroup = \"{evil}\"\nsummary = \"{evil}\"\nsource = \"{evil}\"\n{body}"),
    );
    // Errors quote what is wrong.
    home.write("config/presets/key.toml", format!("\"{evil}\" = 1\n{body}"));
    home.write("config/presets/value.toml", format!("{body}kill = \"{evil}\"\n"));
    home.write("config/presets/word.toml", body.replace("sphere", &evil));
    // A grammar may have the bytes themselves.
    home.write(
        "config/presets/rules.txt",
        format!("axiom=F{EVIL}\nangle=20\niterations=2\nF->F[+F]{EVIL}\n"),
    );
    home.write("config/presets/broken.txt", EVIL);
    home.write("config/presets/latin.toml", b"name = \"\x9b31m\xff\"\n");
    // Names of files too.
    let name =
        std::ffi::OsStr::from_bytes(b"a\x1b[31mEVIL\x1b]52;c;ZXZpbA==\x07\xc2\x9b31m\xe2\x80\xae.toml");
    std::fs::write(home.file("config/presets").join(name), body).unwrap();
    let name = std::ffi::OsStr::from_bytes(b"\x1b[31mEVIL\x9b31m\xff.toml");
    std::fs::write(home.file("config/presets").join(name), "what").unwrap();
    let workbench = Setup::new(120, 40).start(&home);
    workbench.wait_for_tree();
    workbench.keys("G");
    workbench.wait_for_text("EVIL");
    workbench.settle();
    let seen = tour(&workbench);
    assert!(seen.contains("EVIL") && seen.contains("\\u{1b}"), "it is shown, as text:\n{seen}");
}

#[test]
fn a_file_that_is_opened_is_shown_without_what_it_could_do() {
    let home = Home::new();
    let body = format!(
        "id = \"evil\"\nname = \"{0}\"\nsummary = \"{0}\"\n[colonization]\ncrown = \"sphere\"\npoints = 100\n",
        in_toml(EVIL)
    );
    for name in ["a\u{1b}[31mEVIL\u{1b}]0;evil\u{7}\u{202e}.toml", "\u{9b}31m.toml"] {
        home.write(name, &body);
        // So wide that a long name has room in the title.
        let workbench = Setup::new(400, 40).args(&["open", name]).start(&home);
        workbench.wait_for_tree();
        is_clean(&workbench);
        assert!(workbench.screen().row(0).contains("EVIL"), "{}", workbench.screen().row(0));
    }
    // One that is not there is named in an error.
    let workbench = Setup::new(120, 40).args(&["open", "no\u{1b}[31mEVIL\u{9b}31m.toml"]).start(&home);
    workbench.wait_for_text("EVIL");
    is_clean(&workbench);
}

#[test]
fn settings_themes_and_keymaps_are_quoted_without_what_they_could_do() {
    let home = Home::new();
    let evil = in_toml(EVIL);
    home.write("config/config.toml", format!("theme = \"{evil}\"\neditor = \"{evil}\"\n\"{evil}\" = 1\n"));
    home.write("config/keymap.toml", format!("[\"{evil}\"]\n\"{evil}\" = \"{evil}\"\n"));
    home.write(
        "state/session.toml",
        format!(
            "version = 1\nsource = \"{evil}\"\nfilter = \"{evil}\"\nknobs = [[\"{evil}\", \"{evil}\"]]\n"
        ),
    );
    let workbench = Setup::new(120, 40).start(&home);
    workbench.wait_for_text("Presets");
    workbench.settle();
    let seen = tour(&workbench);
    assert!(seen.contains("EVIL"), "{seen}");
}

#[test]
fn what_the_terminal_and_the_environment_say_is_not_repeated() {
    let home = Home::new();
    let setup =
        Setup::new(120, 40).env("TERM_PROGRAM", EVIL).env("COLORTERM", EVIL).env("LINDEN_COLORS", EVIL);
    let workbench = setup.answers(Answers::Plain).args(&["open", "fir"]).start(&home);
    workbench.wait_for_tree();
    workbench.keys("\x1bP>|EVIL\x1b[31mEVIL\x1b\\\x1b[200~\x1b[31mEVIL\x1b]52;c;ZXZpbA==\x07\x1b[201~");
    workbench.keys("/");
    workbench.keys("\x1b[200~a\x1b[31mEVIL\x07\u{202e}\u{9b}31m\x1b[201~");
    workbench.settle();
    workbench.keys("m");
    workbench.settle();
    is_clean(&workbench);
}
