//! The terminal is taken and given back, whatever happens; seen from the other end of it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod child;
mod terminal;

use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use crossterm::event::{Event, KeyCode, KeyEvent};
use linden_terminal::input::Said;
use linden_terminal::probe::{Environment, Graphics, Overrides, ask};
use linden_terminal::tty::{OpenError, Stream};
use linden_terminal::{Capabilities, Incoming, MAX_CELLS, Tty, WindowSize, listen};
use rustix::process::{Signal, kill_process};

use terminal::{Program, Terminal, eventually};

/// All that takes the terminal and gives it back, in order.
const TAKEN: &str = "\x1b[?1049h\x1b[?25l\x1b[?2004h\x1b[?1004h\x1b[?1000h\x1b[?1002h\x1b[?1006h";
const QUIET: &str = "\x1b\\\x1b[?2026l\x1b[?1006l\x1b[?1002l\x1b[?1000l\x1b[?1004l\x1b[?2004l";
const GIVEN_BACK: &str = "\x1b[?25h\x1b[m\x1b[?1049l";

/// What a child tells beside the terminal.
struct Log(tempfile::TempDir);

impl Log {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> PathBuf {
        self.0.path().join("log")
    }

    fn text(&self) -> String {
        std::fs::read_to_string(self.path()).unwrap_or_default()
    }

    fn wait_for(&self, line: &str) {
        eventually(line, || self.text().contains(line).then_some(()));
    }
}

fn start(role: &str) -> (Terminal, Log, Program) {
    let (terminal, log) = (Terminal::new(false), Log::new());
    let program = terminal.start(role, &log.path());
    log.wait_for("ready");
    (terminal, log, program)
}

#[test]
fn the_terminal_is_taken_and_given_back() {
    let (mut terminal, log) = (Terminal::new(false), Log::new());
    let before = terminal.settings();
    let mut program = terminal.start("loop", &log.path());
    log.wait_for("ready");
    assert!(terminal.is_raw());
    terminal.press("q");
    assert_eq!(program.wait(), 0);
    assert_eq!(terminal.settings(), before);
    terminal.wait_for(&format!("{QUIET}{GIVEN_BACK}"));
    assert!(terminal.position(TAKEN) < terminal.position(QUIET));
    assert_eq!(terminal.shown().matches(GIVEN_BACK).count(), 1, "given back once");
}

#[test]
fn a_terminal_is_asked_and_left_as_it_was() {
    let mut terminal = Terminal::new(false);
    let before = terminal.settings();
    let tty = terminal.tty();
    let environment = Environment::from_pairs([("TERM", "xterm-256color")]);
    let asking = std::thread::spawn(move || ask(&tty, &environment, Duration::from_secs(20)));
    terminal.wait_for("\x1b[c");
    assert!(terminal.is_raw());
    terminal.press("x\x1bP>|there 2.0\x1b\\\x1b]11;rgb:ffff/ff");
    terminal.press("ff/eeee\x1b\\\x1b[?62;4c");
    let findings = asking.join().unwrap().unwrap();
    assert!(findings.is_complete());
    let found = Capabilities::conclude(
        &findings,
        &Environment::from_pairs([("TERM", "xterm-256color")]),
        &Overrides::default(),
    );
    assert_eq!((found.name.value.as_str(), found.dark.value), ("there 2.0", false));
    assert_eq!(found.graphics.value, Graphics::Sixel);
    assert_eq!(found.cell_px.value, Some((9, 18)), "the system knows it");
    assert_eq!(terminal.settings(), before);
}

#[test]
fn a_terminal_that_says_nothing_is_not_waited_for_longer_than_asked() {
    let terminal = Terminal::new(false);
    let before = terminal.settings();
    let environment = Environment::from_pairs([("TERM", "xterm-256color")]);
    let findings = ask(&terminal.tty(), &environment, Duration::from_millis(50)).unwrap();
    assert!(findings.is_settled() && !findings.is_complete());
    assert_eq!(terminal.settings(), before);
}

#[test]
fn replies_on_their_way_are_not_typed_at_the_shell() {
    let (mut terminal, log) = (Terminal::new(false), Log::new());
    // What the shell finds on its line after the program.
    let script = "$CHILD; IFS= read -r -n 1 -t 0.5 typed; printf 'typed:%q.' \"$typed\"";
    let mut program = terminal.start_in_shell(script, "replies", &log.path());
    log.wait_for("ready");
    terminal.press("q");
    terminal.wait_for("\x1b[6n");
    terminal.press("\x1bP>|slow 1.0\x1b\\\x1b[?62;4c\x1b[12;");
    terminal.press("1R");
    assert_eq!(program.wait(), 0);
    terminal.wait_for("typed:''.");
    let order = [QUIET, "\x1b[6n", "\x1b_Ga=d,d=A,q=2\x1b\\", GIVEN_BACK].map(|text| terminal.position(text));
    assert!(order.is_sorted(), "{order:?}");
}

#[test]
fn a_mute_terminal_is_given_back_too() {
    let (mut terminal, _log, mut program) = start("replies");
    terminal.press("q");
    assert_eq!(program.wait(), 0);
    terminal.wait_for(GIVEN_BACK);
}

#[test]
fn a_panic_is_told_on_the_users_own_screen() {
    let (mut terminal, log, mut program) = start("panic");
    log.wait_for("Some(\"other\")");
    terminal.press("q");
    assert_ne!(program.wait(), 0);
    terminal.wait_for("the thread of the session");
    assert!(terminal.position(GIVEN_BACK) < terminal.position("the thread of the session"));
    assert!(!terminal.shown().contains("in a thread"), "panics of other threads are not printed");
    assert_eq!(log.text().matches("in a thread").count(), 2, "but told");
    assert!(!terminal.is_raw());
}

#[test]
fn a_line_that_stands_still_is_not_waited_for() {
    let (terminal, log) = (Terminal::new(true), Log::new());
    let before = terminal.settings();
    let mut program = terminal.start("stalled", &log.path());
    log.wait_for("restored");
    assert_eq!(terminal.settings(), before);
    drop(terminal);
    assert_eq!(program.wait(), 7);
}

#[test]
fn signals_are_passed_on() {
    let (mut terminal, log, mut program) = start("loop");
    terminal.resize(120, 40);
    log.wait_for("Resized");
    // The shell's way: continued after a stop that was not ours.
    kill_process(program.pid(), Signal::CONT).unwrap();
    log.wait_for("Continued");
    // A session's leader has no shell to return to.
    terminal.press("\x1a");
    log.wait_for("suspended: false");
    kill_process(program.pid(), Signal::TSTP).unwrap();
    eventually("SIGTSTP", || (log.text().matches("suspended: false").count() == 2).then_some(()));
    kill_process(program.pid(), Signal::TERM).unwrap();
    log.wait_for("Terminate(15)");
    program.wait();
    terminal.wait_for(GIVEN_BACK);
    assert!(!terminal.is_raw());
}

#[test]
fn the_signal_ends_the_program_after_the_terminal_is_given_back() {
    for signal in [Signal::TERM, Signal::INT, Signal::HUP, Signal::QUIT] {
        let (terminal, log) = (Terminal::new(false), Log::new());
        let script = "ulimit -c 0; $CHILD; echo \"status:$?.\"";
        let mut shell =
            terminal.start_in_shell(&format!("trap : INT QUIT HUP TERM; {script}"), "raise", &log.path());
        log.wait_for("ready");
        kill_process(shell.child(), signal).unwrap();
        terminal.wait_for(&format!("status:{}.", 128 + signal.as_raw()));
        shell.wait();
        assert!(terminal.position(GIVEN_BACK) < terminal.position("status:"));
    }
}

#[test]
fn without_a_listener_signals_have_their_effect() {
    let (_terminal, log, mut program) = start("deaf");
    log.wait_for("deaf");
    kill_process(program.pid(), Signal::TERM).unwrap();
    assert_ne!(program.wait(), 0);
}

#[test]
fn ctrl_z_and_back() {
    // The second is a script between the shell and us: it has to stop with us.
    for child in ["$CHILD", "sh -c \"$CHILD; true\""] {
        let (mut terminal, log) = (Terminal::new(false), Log::new());
        let script = format!(
            "set -m; {child}; echo \"stopped:$?.\"; stty -a | grep -o '[ -]icanon'; read -r line; fg >/dev/null; echo back."
        );
        let mut shell = terminal.start_in_shell(&script, "loop", &log.path());
        log.wait_for("ready");
        terminal.press("\x1a");
        // 128 + SIGSTOP: SIGTSTP itself was caught.
        terminal.wait_for("stopped:147.");
        terminal.wait_for(" icanon");
        assert!(terminal.position(GIVEN_BACK) < terminal.position("stopped:147."));
        assert!(!terminal.is_raw());
        terminal.press("\n");
        log.wait_for("suspended: true");
        log.wait_for("Continued");
        eventually("taken again", || terminal.is_raw().then_some(()));
        eventually("taken again", || (terminal.shown().matches(TAKEN).count() >= 2).then_some(()));
        terminal.press("q");
        terminal.wait_for("back.");
        shell.wait();
        assert!(!terminal.is_raw());
    }
}

#[test]
fn stopped_by_others_and_ended_in_the_background() {
    let (mut terminal, log) = (Terminal::new(false), Log::new());
    // Bash may not have heard yet that the job goes on, and then says 147 (stopped).
    let script = "set -m; $CHILD; stty sane; echo stopped.; read -r line; kill %1; \
                  while wait %1; s=$?; [ $s = 147 ]; do sleep 0.01; done; echo \"ended:$s.\"";
    let mut shell = terminal.start_in_shell(script, "loop", &log.path());
    log.wait_for("ready");
    kill_process(shell.child(), Signal::STOP).unwrap();
    terminal.wait_for("stopped.");
    // The shell has the terminal, and had no help in getting it.
    assert!(!terminal.is_raw() && !terminal.shown().contains(GIVEN_BACK));
    let shells = terminal.settings();
    terminal.press("\n");
    terminal.wait_for("ended:0.");
    shell.wait();
    assert!(terminal.position(GIVEN_BACK) < terminal.position("ended:0."));
    assert_eq!(terminal.settings(), shells, "what is the shell's was left to it");
}

#[test]
fn an_editor_has_the_terminal_for_itself() {
    let (mut terminal, log, mut program) = start("pause");
    terminal.wait_for("editing");
    terminal.press("hello\n");
    // Its Ctrl-C ends it, and not us.
    terminal.wait_for("[hello]");
    log.wait_for("editor: signal: 2");
    eventually("taken again", || terminal.is_raw().then_some(()));
    terminal.press("q");
    assert_eq!(program.wait(), 0);
    assert!(!log.text().contains("Terminate"), "{}", log.text());
    assert!(!log.text().contains("'h'"), "what was typed at the editor was not ours: {}", log.text());
}

#[test]
fn a_hangup_is_told_once_and_ends_the_program() {
    let (terminal, log) = (Terminal::new(true), Log::new());
    let mut program = terminal.start("loop", &log.path());
    log.wait_for("ready");
    terminal.hang_up();
    program.wait();
    let told = log.text();
    assert!(told.contains("Hangup") || told.contains("Terminate(1)"), "{told}");
}

/// What comes next, which is not long in coming.
fn next(incoming: &Receiver<Incoming>) -> Incoming {
    incoming.recv_timeout(Duration::from_secs(30)).unwrap()
}

fn key(code: KeyCode) -> Incoming {
    Incoming::Input(vec![Said::Event(Event::Key(KeyEvent::from(code)))])
}

#[test]
fn the_input_thread_ends_with_the_terminal() {
    let terminal = Terminal::new(true);
    let (send, incoming) = channel();
    let listener = listen(terminal.tty(), move |what| send.send(what).is_ok()).unwrap();
    terminal.hang_up();
    let mut told = Vec::new();
    // Signals of the process and an end of file that the pseudo-terminal's crate types come too.
    while !told.contains(&Incoming::Hangup) {
        told.push(next(&incoming));
    }
    drop(listener);
    // Until both threads have ended.
    told.extend(incoming);
    assert_eq!(told.iter().filter(|what| **what == Incoming::Hangup).count(), 1, "{told:?}");
}

#[test]
fn escape_comes_by_itself_and_a_pause_leaves_the_rest_to_others() {
    let mut terminal = Terminal::new(false);
    let tty = terminal.tty();
    terminal.make_raw();
    let (send, incoming) = channel();
    let listener = listen(tty, move |what| send.send(what).is_ok()).unwrap();
    terminal.press("\x1b");
    assert_eq!(next(&incoming), key(KeyCode::Esc));
    terminal.press("\x1b[A");
    assert_eq!(next(&incoming), key(KeyCode::Up));
    listener.pause();
    terminal.press("xyz");
    let mut bytes = [0; 3];
    let editor = terminal.end();
    let mut count = 0;
    while count < 3 {
        count += rustix::io::read(&editor, &mut bytes[count..]).unwrap();
    }
    assert_eq!(&bytes, b"xyz");
    listener.resume();
    assert_eq!(next(&incoming), Incoming::Resized);
    terminal.press("j");
    assert_eq!(next(&incoming), key(KeyCode::Char('j')));
    drop(listener);
    assert_eq!(incoming.recv_timeout(Duration::from_secs(30)), Err(RecvTimeoutError::Disconnected));
}

#[test]
fn which_stream_is_no_terminal() {
    let terminal = Terminal::new(false);
    let file = || OwnedFd::from(tempfile::tempfile().unwrap());
    let refused = |input, output| match Tty::over(input, output) {
        Err(error @ OpenError::NotATerminal(stream)) => (stream, error.to_string()),
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(file(), terminal.end()), (Stream::Input, "standard input is not a terminal".into()));
    assert_eq!(refused(terminal.end(), file()), (Stream::Output, "standard output is not a terminal".into()));
}

#[test]
fn how_large_it_is() {
    let terminal = Terminal::new(false);
    let tty = terminal.tty();
    assert_eq!(tty.size(), WindowSize { columns: 100, rows: 30, width_px: 900, height_px: 540 });
    assert_eq!(tty.size().cell_px(), Some((9, 18)));
    terminal.resize(0, 0);
    assert_eq!(tty.size(), WindowSize { columns: 80, rows: 24, width_px: 0, height_px: 0 });
    assert_eq!(tty.size().cell_px(), None);
    terminal.resize(u16::MAX, u16::MAX);
    assert_eq!((tty.size().columns, tty.size().rows), (MAX_CELLS, MAX_CELLS), "no screen has so many");
    terminal.resize(200, 60);
    assert_eq!((tty.size().columns, tty.size().rows, tty.size().cell_px()), (200, 60, None));
}
