//! The real program on a pseudo-terminal.
//!
//! Nothing here knows the program's insides: keys go in, bytes come out, and the test's own terminal
//! shows them, over a link of a given rate and round trip if asked to.

mod process;
mod sequences;
mod shown;
mod terminal;

use std::collections::BTreeMap;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use portable_pty::{CommandBuilder, MasterPty, PtySize, native_pty_system};
use rustix::fs::{Mode, OFlags};
use rustix::process::{Pid, Signal, kill_process};

pub use process::{End, Process};
pub use sequences::{Token, tokens};
pub use shown::{Shown, form_cursor, list_cursor};
pub use terminal::{Answers, Link};
use terminal::{Keyboard, Monitor};

/// Longer than anything here takes on any machine: what is not there by then does not come.
pub const PATIENCE: Duration = Duration::from_mins(1);
/// A program that has done nothing for so long waits for something; longer than the pause between a
/// draft and the full picture.
const REST: Duration = Duration::from_millis(400);

/// The program that this build made.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_linden");

/// Folders for configuration and state, which vanish with the value.
pub struct Home(tempfile::TempDir);

impl Home {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// A file below it: `config/presets/a.toml`, `state/session.toml`.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file as editors do: beside it, then renamed.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.file(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let beside = path.with_file_name(".being-written");
        std::fs::write(&beside, content).unwrap();
        std::fs::rename(beside, &path).unwrap();
        path
    }
}

/// What a workbench is started with.
pub struct Setup {
    size: (u16, u16),
    environment: BTreeMap<String, String>,
    args: Vec<String>,
    answers: Answers,
    link: Option<Link>,
}

impl Setup {
    /// A mute terminal of this size, `TERM=xterm-256color`, and nothing else in the
    /// environment.
    pub fn new(columns: u16, rows: u16) -> Self {
        Self {
            size: (columns, rows),
            environment: BTreeMap::from([("TERM".to_owned(), "xterm-256color".to_owned())]),
            args: Vec::new(),
            answers: Answers::Mute,
            link: None,
        }
    }

    pub fn env(mut self, name: &str, value: &str) -> Self {
        self.environment.insert(name.to_owned(), value.to_owned());
        self
    }

    /// The terminal is on another machine.
    pub fn over_ssh(self) -> Self {
        self.env("SSH_CONNECTION", "192.0.2.1 50000 192.0.2.2 22")
    }

    pub fn args(mut self, args: &[&str]) -> Self {
        self.args.extend(args.iter().map(|arg| (*arg).to_owned()));
        self
    }

    pub fn answers(mut self, answers: Answers) -> Self {
        self.answers = answers;
        self
    }

    pub fn link(mut self, link: Link) -> Self {
        self.link = Some(link);
        self
    }

    /// Starts the program.
    pub fn start(&self, home: &Home) -> Workbench {
        self.spawn(home, PROGRAM, &self.args.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Starts a shell with job control, as on a user's terminal; `$LINDEN` is the program.
    pub fn start_shell(&self, home: &Home, script: &str) -> Workbench {
        self.spawn(home, "bash", &["--norc", "--noprofile", "-c", script])
    }

    /// Starts another program, to compare with.
    pub fn spawn(&self, home: &Home, program: &str, args: &[&str]) -> Workbench {
        let (columns, rows) = self.size;
        let pair = native_pty_system().openpty(pty_size(columns, rows)).unwrap();
        let name = pair.master.tty_name().unwrap();
        let far =
            rustix::fs::open(name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap();
        let mut command = CommandBuilder::new(program);
        command.args(args);
        command.env_clear();
        command.env("LANG", "C.UTF-8");
        for (name, value) in &self.environment {
            command.env(name, value);
        }
        command.env("PATH", std::env::var_os("PATH").unwrap_or_default());
        command.env("HOME", home.path());
        command.env("LINDEN", PROGRAM);
        command.env("LINDEN_CONFIG_DIR", home.file("config"));
        command.env("LINDEN_STATE_DIR", home.file("state"));
        command.cwd(home.path());
        let before = settings(&far);
        let keyboard = Keyboard::new(pair.master.take_writer().unwrap(), self.link);
        let monitor = Monitor::new(
            pair.master.try_clone_reader().unwrap(),
            self.size,
            self.answers,
            self.link,
            &keyboard,
        );
        let started = Instant::now();
        let child = pair.slave.spawn_command(command).unwrap();
        let process = Process::new(Pid::from_raw(child.process_id().unwrap() as i32).unwrap());
        Workbench {
            master: Some(pair.master),
            far: Some(far),
            before,
            keyboard: Some(keyboard),
            monitor,
            process,
            started,
        }
    }
}

fn pty_size(columns: u16, rows: u16) -> PtySize {
    let [pixel_width, pixel_height] = [columns.saturating_mul(10), rows.saturating_mul(20)];
    PtySize { rows, cols: columns, pixel_width, pixel_height }
}

/// All settings of a terminal, as text to compare.
fn settings(fd: &OwnedFd) -> String {
    format!("{:?}", rustix::termios::tcgetattr(fd).unwrap())
}

/// The program, running.
pub struct Workbench {
    master: Option<Box<dyn MasterPty + Send>>,
    /// One more descriptor of the program's end: what is set there outlives the program.
    far: Option<OwnedFd>,
    before: String,
    keyboard: Option<Keyboard>,
    monitor: Monitor,
    process: Process,
    pub started: Instant,
}

impl Workbench {
    /// Starts the program on a mute terminal and waits for its first tree.
    pub fn open(home: &Home, columns: u16, rows: u16, args: &[&str]) -> Self {
        let workbench = Setup::new(columns, rows).args(args).start(home);
        workbench.wait_for_tree();
        workbench
    }

    /// Starts the program on `points` points, which take about as many nodes; they have begun to grow.
    pub fn while_it_grows(home: &Home, points: u32) -> Self {
        let points = format!("points={points}");
        let args = ["open", "sphere", "--set", &points, "--set", "step=0.02"];
        let workbench = Setup::new(120, 40).args(&args).start(home);
        workbench.wait_for("the preset", |screen| screen.row(0).contains("Sphere"));
        workbench
    }

    /// Types text, or any other bytes that a terminal sends.
    pub fn keys(&self, text: &str) {
        self.keyboard.as_ref().unwrap().press(text.as_bytes());
    }

    /// What is on the screen now.
    pub fn screen(&self) -> Shown {
        self.monitor.screen()
    }

    /// All bytes that the program has sent.
    pub fn bytes(&self) -> Vec<u8> {
        self.monitor.sent(0)
    }

    /// Bytes that the program sent after the first `from`.
    pub fn bytes_from(&self, from: usize) -> Vec<u8> {
        self.monitor.sent(from)
    }

    /// How many bytes the program has sent.
    pub fn sent(&self) -> usize {
        self.monitor.sent_count()
    }

    /// Sent, and not yet shown: the queue of the link.
    pub fn queued(&self) -> usize {
        self.monitor.queued()
    }

    /// When the byte of that number was sent, and when it was shown.
    pub fn times_of(&self, byte: usize) -> (Instant, Option<Instant>) {
        self.monitor.times_of(byte)
    }

    /// How long a byte is in the queue of a link, which takes the bytes as they were sent. Computed
    /// from when they were, so that it does not matter how late this test's own terminal was.
    pub fn queue_of(&self, byte: usize, link: Link) -> Duration {
        let (mut free, mut start) = (self.started, 0);
        for (came, bytes) in self.monitor.pieces(0) {
            let until = bytes.min(byte + 1 - start);
            free = free.max(came) + link.time_of(until);
            start += bytes;
            if start > byte {
                return free.saturating_duration_since(came);
            }
        }
        Duration::ZERO
    }

    /// The bytes in the pieces in which they came, with times.
    pub fn pieces_from(&self, from: usize) -> Vec<(Instant, usize)> {
        self.monitor.pieces(from)
    }

    /// Waits until the screen is as it should be.
    #[track_caller]
    pub fn wait_for(&self, what: &str, is: impl Fn(&Shown) -> bool) -> Shown {
        let end = Instant::now() + PATIENCE;
        loop {
            let generation = self.monitor.generation();
            let screen = self.screen();
            if is(&screen) {
                return screen;
            }
            assert!(Instant::now() < end, "waited in vain for {what}:\n{}", screen.text());
            self.monitor.wait_for_change(generation, Duration::from_millis(200));
        }
    }

    /// Waits until a text is on the screen.
    #[track_caller]
    pub fn wait_for_text(&self, text: &str) -> Shown {
        self.wait_for(&format!("{text:?}"), |screen| screen.text().contains(text))
    }

    /// Waits until the program has sent something.
    #[track_caller]
    pub fn wait_for_bytes(&self, what: &str, is: impl Fn(&[u8]) -> bool) {
        eventually(what, || is(&self.bytes()).then_some(()));
    }

    /// Waits until a tree is measured in the title and the program rests.
    #[track_caller]
    pub fn wait_for_tree(&self) {
        self.wait_for("a tree", |screen| screen.row(0).contains(" nodes"));
        self.settle();
    }

    /// Waits until the program waits: each thread sleeps and nothing is sent for a while. That is
    /// also so on a machine that is busy, where a program that is not given its turn does not sleep.
    #[track_caller]
    pub fn settle(&self) {
        let end = Instant::now() + PATIENCE;
        let mut since = Instant::now();
        let mut last = (self.sent(), self.process.switches());
        while since.elapsed() < REST {
            std::thread::sleep(Duration::from_millis(20));
            let now = (self.sent(), self.process.switches());
            if now != last || !self.process.sleeps() || self.queued() > 0 {
                since = Instant::now();
            }
            last = now;
            assert_ne!(self.process.state(), Some('Z'), "it has ended");
            assert!(Instant::now() < end, "it never rests:\n{}", self.screen().text());
        }
    }

    /// Changes the window's size; the screen is the terminal's own from now on.
    pub fn resize(&self, columns: u16, rows: u16) {
        self.monitor.resize(columns, rows);
        self.master.as_ref().unwrap().resize(pty_size(columns, rows)).unwrap();
    }

    /// Claims another size than the screen has.
    pub fn claim(&self, columns: u16, rows: u16) {
        self.master.as_ref().unwrap().resize(pty_size(columns, rows)).unwrap();
    }

    pub fn signal(&self, signal: Signal) {
        kill_process(self.process.pid(), signal).unwrap();
    }

    pub fn process(&self) -> &Process {
        &self.process
    }

    /// Whether the terminal is in raw mode.
    pub fn is_raw(&self) -> bool {
        let modes = rustix::termios::tcgetattr(self.far.as_ref().unwrap()).unwrap().local_modes;
        !modes.contains(rustix::termios::LocalModes::ICANON)
    }

    /// Waits for the program's end, and for its last byte.
    #[track_caller]
    pub fn wait_exit(&mut self) -> End {
        let end = self.process.wait(|| self.screen().text());
        // When no process has that end open any more, reading ends after the last byte.
        if let Some(far) = self.far.take() {
            assert_eq!(settings(&far), self.before, "the terminal's settings are as they were");
        }
        self.monitor.wait_for_end();
        end
    }

    /// Cuts the line, as when a window is closed or a connection is lost.
    pub fn hang_up(&mut self) {
        self.monitor.stop_reading();
        // Something has to be read for that to be noticed.
        self.keys("\x0c");
        self.monitor.wait_for_end();
        drop(self.keyboard.take());
        self.far = None;
        self.master = None;
    }
}

impl Drop for Workbench {
    fn drop(&mut self) {
        self.process.kill();
        if std::thread::panicking() {
            print!("{}", self.screen().text() + "\n");
        }
    }
}

/// Looks again and again until there is something.
#[track_caller]
pub fn eventually<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let end = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < end, "{what}: waited in vain");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Where a sequence of bytes is first.
pub fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes.windows(wanted.len()).position(|window| window == wanted)
}

/// Shares a value between the threads of a terminal.
type Shared<T> = Arc<T>;
