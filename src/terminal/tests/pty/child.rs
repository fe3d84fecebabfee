//! Programs that tests start on a terminal: this test's own binary, told which by a variable.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crossterm::event::Event;
use linden_terminal::input::{Said, Shortcut};
use linden_terminal::session::install_panic_hook;
use linden_terminal::{Incoming, Listener, Modes, Session, Tty, listen};

pub const ROLE: &str = "LINDEN_TEST_ROLE";
pub const LOG: &str = "LINDEN_TEST_LOG";

/// Arguments that make the test binary run [`child`] and nothing else, on its main thread.
pub const ARGUMENTS: [&str; 4] = ["child::child", "--exact", "--nocapture", "--test-threads=1"];

fn key(key: Shortcut) -> Said {
    Said::Event(Event::Key(key.into()))
}

struct Program {
    session: Session,
    tty: Tty,
    listener: Listener,
    incoming: Receiver<Incoming>,
    log: File,
}

impl Program {
    fn start() -> Self {
        let log = OpenOptions::new().append(true).create(true).open(std::env::var(LOG).unwrap()).unwrap();
        let tty = Tty::open().unwrap();
        let session = Session::start(tty.clone(), Modes { mouse: true }).unwrap();
        let (send, incoming) = channel();
        let listener = listen(tty.clone(), move |incoming| send.send(incoming).is_ok()).unwrap();
        let mut program = Self { session, tty, listener, incoming, log };
        program.say("ready");
        program
    }

    /// A line for the test, beside the terminal.
    fn say(&mut self, line: &str) {
        writeln!(self.log, "{line}").unwrap();
    }

    /// What comes until `q` or the end, told line by line.
    fn until_q(&mut self) {
        while let Ok(incoming) = self.incoming.recv() {
            self.say(&format!("{incoming:?}"));
            match incoming {
                Incoming::Input(events) if events.contains(&key(Shortcut::char('q'))) => return,
                Incoming::Input(events) if events.contains(&key(Shortcut::ctrl('z'))) => self.suspend(),
                Incoming::Suspend => self.suspend(),
                Incoming::Continued => self.session.resume().unwrap(),
                Incoming::Terminate(_) | Incoming::Hangup => return,
                _ => {}
            }
        }
    }

    fn suspend(&mut self) {
        let was = self.session.suspend().unwrap();
        self.say(&format!("suspended: {was}"));
    }
}

/// Does nothing as a test.
#[test]
fn child() {
    let Ok(role) = std::env::var(ROLE) else { return };
    match role.as_str() {
        "loop" => {
            let mut program = Program::start();
            let second = Session::start(program.tty.clone(), Modes::default()).unwrap_err();
            assert_eq!(second.kind(), std::io::ErrorKind::AlreadyExists);
            program.until_q();
            program.session.restore();
            program.session.restore();
        }
        // The signal ends it, as the shell expects.
        "raise" => {
            let program = Program::start();
            while let Ok(incoming) = program.incoming.recv() {
                if let Incoming::Terminate(signal) = incoming {
                    program.session.restore();
                    drop(program.listener);
                    signal_hook::low_level::raise(signal).unwrap();
                    return;
                }
            }
        }
        // Nobody listens any more: signals do what they do by themselves.
        "deaf" => {
            let mut program = Program::start();
            drop(program.listener);
            program.session.restore();
            let end = std::time::Instant::now() + Duration::from_mins(1);
            writeln!(program.log, "deaf").unwrap();
            while std::time::Instant::now() < end {
                std::thread::sleep(Duration::from_millis(50));
            }
        }
        "replies" => {
            let mut program = Program::start();
            program.session.expect_replies(Some(Duration::from_mins(1)));
            program.session.expect_images(true);
            program.until_q();
        }
        "pause" => {
            let mut program = Program::start();
            program.listener.pause();
            program.session.restore();
            let status = std::process::Command::new("bash")
                .args(["-c", "echo editing; read -r line; echo \"[$line]\"; kill -INT 0; read -r line"])
                .status();
            program.say(&format!("editor: {}", status.unwrap()));
            program.session.resume().unwrap();
            program.listener.resume();
            program.until_q();
        }
        "panic" => {
            let report = std::env::var(LOG).unwrap();
            install_panic_hook("job", move |info| {
                let mut log = OpenOptions::new().append(true).open(&report).unwrap();
                writeln!(log, "{:?} {info}", std::thread::current().name()).unwrap();
            });
            let mut program = Program::start();
            for name in ["job-1", "other"] {
                let thread = std::thread::Builder::new().name(name.into()).spawn(|| panic!("in a thread"));
                assert!(thread.unwrap().join().is_err());
            }
            program.until_q();
            panic!("the thread of the session");
        }
        "stalled" => {
            let mut program = Program::start();
            program.session.expect_replies(Some(Duration::from_mins(1)));
            let mut tty = program.tty.clone();
            let picture = "x".repeat(65536);
            std::thread::spawn(move || while tty.write(picture.as_bytes()).is_ok() {});
            std::thread::sleep(Duration::from_millis(200));
            program.session.restore();
            program.say("restored");
            std::process::exit(7);
        }
        other => panic!("{other}"),
    }
}
