//! The first frame, and what is asked after it.

use crate::harness::{Answers, End, Home, Setup, Token, find, tokens};

/// Whether a token asks the terminal something.
fn asks(token: &Token<'_>) -> bool {
    match token {
        Token::Csi(_, b'c') | Token::Csi(b"5" | b"6", b'n') | Token::Csi(b"16", b't') => true,
        Token::Csi(body, end) => {
            (*end == b'q' && body.starts_with(b">")) || (*end == b'p' && body.ends_with(b"$"))
        }
        Token::String(b']', body) => body.ends_with(b"?"),
        Token::String(b'P', body) => body.starts_with(b"$q"),
        Token::String(b'_', body) => find(body, b"a=q").is_some(),
        _ => false,
    }
}

#[test]
fn the_first_frame_is_whole_and_comes_before_the_first_query() {
    let home = Home::new();
    let workbench = Setup::new(120, 40).start(&home);
    workbench.wait_for_bytes("a query", |bytes| tokens(bytes).0.iter().any(asks));
    let bytes = workbench.bytes();
    let (all, _) = tokens(&bytes);
    let first = all.iter().position(asks).unwrap();
    let before: Vec<Token<'_>> = all[..first].to_vec();
    // What stands before it, on a screen of its own.
    let mut parser = vt100::Parser::new(40.try_into().unwrap(), 120.try_into().unwrap(), 0);
    let length = bytes.len() - find_rest(&bytes, before.len());
    parser.process(&bytes[..length]);
    let rows: Vec<String> = parser.screen().rows(0, 120).collect();
    assert!(rows[0].contains("linden"), "{}", rows[0]);
    assert!(
        rows[1].contains("Presets") && rows[1].contains("Picture") && rows[1].contains("Shape"),
        "{}",
        rows[1]
    );
    assert!(rows.iter().any(|row| row.contains("English oak")), "the list is there: {rows:#?}");
    assert!(rows[39].contains("Welcome") && rows[39].contains("? all keys"), "{}", rows[39]);
    assert!(parser.screen().alternate_screen() && parser.screen().hide_cursor());
}

/// Where the bytes after the first `count` tokens begin.
fn find_rest(bytes: &[u8], count: usize) -> usize {
    let mut low = 0;
    let mut high = bytes.len();
    while low < high {
        let middle = usize::midpoint(low, high);
        if tokens(&bytes[..middle]).0.len() > count { high = middle } else { low = middle + 1 }
    }
    bytes.len() - (low - 1)
}

#[test]
fn a_mute_terminal_gets_a_tree_without_an_answer() {
    let home = Home::new();
    let mut workbench = Setup::new(120, 40).args(&["open", "fir"]).start(&home);
    workbench.wait_for_tree();
    let screen = workbench.screen();
    assert!(screen.row(0).contains("Fir"), "{}", screen.row(0));
    assert!(screen.painted(30..80, 3..36) > 60, "a picture:\n{}", screen.text());
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
}

#[test]
fn what_the_terminal_answers_is_not_shown_and_not_typed() {
    for answers in [Answers::Plain, Answers::TrueColor, Answers::Kitty, Answers::Sixel, Answers::Iterm2] {
        let home = Home::new();
        let workbench = Setup::new(120, 40).args(&["open", "fir"]).answers(answers).start(&home);
        workbench.wait_for_tree();
        let screen = workbench.screen();
        assert!(screen.footer().contains("Next preset"), "{answers:?}: {}", screen.footer());
        assert!(screen.row(0).contains("Fir"), "{answers:?}: {}", screen.row(0));
        let bytes = workbench.bytes();
        let has = |kind, begin: &[u8]| {
            tokens(&bytes).0.iter().any(
                |token| matches!(token, Token::String(of_kind, body) if *of_kind == kind && body.starts_with(begin)),
            )
        };
        // A picture as the terminal said that it has it.
        assert_eq!(
            has(b'_', b"Ga=t") || has(b'_', b"Gi=") && has(b'_', b"Ga=p"),
            answers == Answers::Kitty,
            "{answers:?}"
        );
        assert_eq!(has(b']', b"1337;File="), answers == Answers::Iterm2, "{answers:?}");
    }
}

#[test]
fn replies_that_come_late_or_broken_are_not_typed() {
    let home = Home::new();
    let workbench = Setup::new(120, 40).args(&["open", "fir"]).start(&home);
    workbench.wait_for_tree();
    // By then they are not waited for any more.
    std::thread::sleep(std::time::Duration::from_secs(3));
    workbench.settle();
    let before = workbench.screen();
    for late in [
        "\x1b_Gi=31;ENOTSUP:q\x1b\\",
        "\x1bP>|q quit q 1.0\x1b\\",
        "\x1bP1$r0;48;5;59m\x1b\\",
        "\x1b[6;20;10t\x1b[?2026;2$y",
        "\x1b[0n\x1b[12;40R\x1b[?1;2c",
        // Garbage in the forms of replies.
        "\x1b[?;9;$y\x1b[?q\x1bP!q\x1b\\\x1b]q;qqq\x07\x1b_q\x1b\\\x1b^q\x1b\\\x1b[999999999999999999;q",
    ] {
        workbench.keys(late);
    }
    workbench.settle();
    let after = workbench.screen();
    assert_eq!(after.text(), before.text());
    // In two pieces, with a pause in between.
    for half in ["\x1b]11;rgb:1010/10", "10/1212\x1b\\"] {
        workbench.keys(half);
        workbench.settle();
    }
    assert_eq!(workbench.screen().text(), before.text());
    // And it still listens.
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
}

#[test]
fn without_a_terminal_it_says_what_to_do_instead() {
    use std::process::{Command, Stdio};
    let home = Home::new();
    for (input, output) in [("pipe", "pipe"), ("null", "pipe")] {
        let input = if input == "null" { Stdio::null() } else { Stdio::piped() };
        assert_eq!(output, "pipe");
        let said = Command::new(crate::harness::PROGRAM)
            .env("LINDEN_CONFIG_DIR", home.file("config"))
            .stdin(input)
            .output()
            .unwrap();
        let told = String::from_utf8(said.stderr).unwrap();
        assert_eq!(said.status.code(), Some(2), "{told}");
        for command in ["linden list", "linden preview", "linden export"] {
            assert!(told.contains(command), "{told}");
        }
        assert!(said.stdout.is_empty() && !told.contains('\x1b'), "{told}");
    }
    // Only one of the two is a terminal.
    for (script, stream) in [
        ("$LINDEN </dev/null; echo \"code:$?.\"", "input"),
        ("$LINDEN | cat; echo \"code:${PIPESTATUS[0]}.\"", "output"),
    ] {
        let mut shell = Setup::new(100, 30).start_shell(&home, script);
        let screen = shell.wait_for_text("code:2.");
        for said in ["linden list", "linden preview", "linden export", stream] {
            assert!(screen.text().contains(said), "{}", screen.text());
        }
        assert_eq!(shell.wait_exit(), End::Code(0));
    }
}
