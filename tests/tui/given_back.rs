//! The terminal is given back, however the program ends. (Panics are tested where the terminal is
//! taken, in `src/terminal/tests/pty`: the program has no key that makes it panic.)

use std::time::{Duration, Instant};

use rustix::process::Signal;

use crate::harness::{Answers, End, Home, PROGRAM, Setup, Workbench, eventually, find};

/// What was turned on is off, and the screen is the one that was there before.
#[track_caller]
fn is_given_back(workbench: &Workbench) {
    let screen = workbench.screen();
    assert!(!screen.is_alternate(), "the alternate screen is left");
    assert!(!screen.hides_cursor(), "the cursor is shown");
    assert!(!screen.pastes_in_brackets() && !screen.hears_mouse());
    let bytes = workbench.bytes();
    let last = |mode: &str| {
        let set = format!("\x1b[?{mode}h");
        let at = bytes.windows(set.len()).rposition(|window| window == set.as_bytes());
        let reset = format!("\x1b[?{mode}l");
        (at, bytes.windows(reset.len()).rposition(|window| window == reset.as_bytes()))
    };
    for mode in ["1049", "2004", "1004", "1000", "1002", "1006"] {
        let (set, reset) = last(mode);
        assert!(set.is_some() && set < reset, "mode {mode}: {set:?} {reset:?}");
    }
    assert!(last("25").1 < last("25").0, "the cursor is shown last");
    assert_eq!(find(&bytes, b"\x1b[?1003h"), None, "motion alone is nothing to us");
}

#[test]
fn by_keys() {
    for (key, answers) in
        [("q", Answers::Mute), ("\x03", Answers::Mute), ("q", Answers::Kitty), ("q", Answers::Sixel)]
    {
        let home = Home::new();
        let mut workbench = Setup::new(100, 30).args(&["open", "fir"]).answers(answers).start(&home);
        workbench.wait_for_tree();
        assert!(workbench.is_raw() && workbench.screen().is_alternate());
        workbench.keys(key);
        assert_eq!(workbench.wait_exit(), End::Code(0), "{key:?}");
        is_given_back(&workbench);
        let leave = workbench.bytes().windows(8).rposition(|w| w == b"\x1b[?1049l").unwrap();
        let deleted = find(&workbench.bytes(), b"\x1b_Ga=d,d=A,q=2\x1b\\").is_some_and(|at| at < leave);
        assert_eq!(deleted, answers == Answers::Kitty, "pictures are taken along");
    }
}

#[test]
fn by_keys_in_the_middle_of_everything() {
    // At once, while a tree grows, and with a dialog open.
    for keys in ["q", "\x03", "?\x03\x03", ":\x03q", "/abc\x1b[13~\x03q"] {
        let home = Home::new();
        let mut workbench = Setup::new(100, 30)
            .args(&["open", "sphere", "--set", "points=2000000", "--set", "step=0.02"])
            .start(&home);
        workbench.wait_for_text("linden");
        workbench.keys(keys);
        assert_eq!(workbench.wait_exit(), End::Code(0), "{keys:?}");
        is_given_back(&workbench);
    }
}

#[test]
fn by_signals_which_the_parent_is_told() {
    for signal in [Signal::TERM, Signal::HUP, Signal::INT] {
        let home = Home::new();
        let mut workbench = Workbench::open(&home, 100, 30, &["open", "fir"]);
        workbench.signal(signal);
        assert_eq!(workbench.wait_exit(), End::Signal(signal.as_raw()));
        is_given_back(&workbench);
        assert!(home.file("state/session.toml").exists(), "what was on screen is kept all the same");
    }
}

#[test]
fn ctrl_z_stops_and_fg_brings_back() {
    let home = Home::new();
    let script =
        "set -m; $LINDEN open fir; echo \"stopped:$?.\"; read -r line; fg >/dev/null; echo \"back:$?.\"";
    let mut shell = Setup::new(100, 30).start_shell(&home, script);
    let linden = shell.process().child(PROGRAM);
    shell.wait_for("a tree", |screen| screen.row(0).contains(" nodes"));
    shell.keys("\x1a");
    shell.wait_for_text("stopped:");
    eventually("stopped", || (linden.state() == Some('T')).then_some(()));
    assert!(!shell.is_raw());
    is_given_back(&shell);
    let before = shell.sent();
    shell.keys("\n");
    // All of it is painted anew, though nothing changed.
    let screen = shell.wait_for("the workbench", |screen| {
        screen.is_alternate() && screen.row(0).contains(" nodes") && screen.footer().contains("Next preset")
    });
    assert!(screen.text().contains("Presets") && screen.hides_cursor());
    assert!(find(&shell.bytes_from(before), b"\x1b[?1049h").is_some());
    eventually("raw", || shell.is_raw().then_some(()));
    shell.keys("q");
    shell.wait_for_text("back:0.");
    assert_eq!(shell.wait_exit(), End::Code(0));
    is_given_back(&shell);
}

#[test]
fn without_a_shell_ctrl_z_says_why_it_does_not_stop() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 100, 30, &["open", "fir"]);
    workbench.keys("\x1a");
    workbench.wait_for_text("runs without a shell");
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
}

#[test]
fn stopped_and_continued_by_others_it_paints_all() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 100, 30, &["open", "fir"]);
    let screen = workbench.screen();
    workbench.signal(Signal::STOP);
    eventually("stopped", || (workbench.process().state() == Some('T')).then_some(()));
    let before = workbench.sent();
    workbench.signal(Signal::CONT);
    eventually("painted", || (workbench.sent() > before + 1000).then_some(()));
    workbench.settle();
    let after = workbench.screen();
    assert_eq!(after.columns(0, 28), screen.columns(0, 28));
    // Cells that look nearly alike may be another pair of glyph and colours, and one that is hardly covered none.
    let [then, now] = [&screen, &after].map(|screen| screen.painted(28..99, 2..27));
    assert!(then > 300 && now.abs_diff(then) <= then / 100, "{then} {now}");
}

#[test]
fn when_the_line_is_cut_it_ends_and_does_not_spin() {
    for args in [&["open", "fir"][..], &["open", "sphere", "--set", "points=2000000", "--set", "step=0.02"]] {
        let home = Home::new();
        let mut workbench = Setup::new(100, 30).args(args).start(&home);
        workbench.wait_for_text("linden");
        if args.len() == 2 {
            workbench.wait_for_tree();
        }
        workbench.hang_up();
        let cut = Instant::now();
        let end = workbench.wait_exit();
        // The system's SIGHUP, or our own after reading failed.
        assert_eq!(end, End::Signal(Signal::HUP.as_raw()));
        // Within a second on a machine that has time; this is a limit for hanging.
        assert!(cut.elapsed() < Duration::from_secs(20), "{:?}", cut.elapsed());
    }
}
