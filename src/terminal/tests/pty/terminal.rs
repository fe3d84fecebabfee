//! A terminal for tests: the other end of a pseudo-terminal.

use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use linden_terminal::Tty;
use portable_pty::{Child, CommandBuilder, MasterPty, PtyPair, PtySize, native_pty_system};
use rustix::fs::{Mode, OFlags};
use rustix::process::Pid;

/// Longer than anything here takes on any machine: what is not there by then does not come.
const PATIENCE: Duration = Duration::from_secs(30);

/// Looks again and again until there is something.
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

pub struct Terminal {
    pair: PtyPair,
    keyboard: Box<dyn Write + Send>,
    shown: Arc<Mutex<Vec<u8>>>,
}

impl Terminal {
    /// 100×30 cells of 9×18 pixels. Reads what it is shown, unless it stands still.
    pub fn new(stands_still: bool) -> Self {
        let size = PtySize { rows: 30, cols: 100, pixel_width: 900, pixel_height: 540 };
        let pair = native_pty_system().openpty(size).unwrap();
        let keyboard = pair.master.take_writer().unwrap();
        let shown = Arc::new(Mutex::new(Vec::new()));
        if !stands_still {
            let (mut reader, all) = (pair.master.try_clone_reader().unwrap(), Arc::clone(&shown));
            std::thread::spawn(move || {
                let mut bytes = [0; 4096];
                while let Ok(count @ 1..) = reader.read(&mut bytes) {
                    all.lock().unwrap().extend_from_slice(&bytes[..count]);
                }
            });
        }
        Self { pair, keyboard, shown }
    }

    fn master(&self) -> &dyn MasterPty {
        &*self.pair.master
    }

    fn path(&self) -> PathBuf {
        self.master().tty_name().unwrap()
    }

    /// One more descriptor of the program's end, in this process.
    pub fn end(&self) -> OwnedFd {
        rustix::fs::open(self.path(), OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap()
    }

    pub fn tty(&self) -> Tty {
        Tty::over(self.end(), self.end()).unwrap()
    }

    pub fn press(&mut self, bytes: &str) {
        self.keyboard.write_all(bytes.as_bytes()).unwrap();
    }

    pub fn resize(&self, columns: u16, rows: u16) {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        self.master().resize(size).unwrap();
    }

    /// Whether the program's end is in raw mode.
    pub fn is_raw(&self) -> bool {
        let modes = rustix::termios::tcgetattr(self.end()).unwrap().local_modes;
        !modes.contains(rustix::termios::LocalModes::ICANON)
    }

    /// Makes the program's end raw, as a session would.
    pub fn make_raw(&self) {
        let end = self.end();
        let mut modes = rustix::termios::tcgetattr(&end).unwrap();
        modes.make_raw();
        rustix::termios::tcsetattr(&end, rustix::termios::OptionalActions::Now, &modes).unwrap();
    }

    /// All settings, as text to compare.
    pub fn settings(&self) -> String {
        format!("{:?}", rustix::termios::tcgetattr(self.end()).unwrap())
    }

    pub fn shown(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned()
    }

    pub fn wait_for(&self, text: &str) {
        let is_shown = || self.shown().contains(text);
        let end = Instant::now() + PATIENCE;
        while !is_shown() && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(is_shown(), "{text:?} is not in {:?}", self.shown());
    }

    /// Where a text is shown first.
    pub fn position(&self, text: &str) -> usize {
        let shown = self.shown();
        shown.find(text).unwrap_or_else(|| panic!("{text:?} is not in {shown:?}"))
    }

    /// Starts a role of this test's own program on the terminal, told to a log.
    pub fn start(&self, role: &str, log: &Path) -> Program {
        let program = std::env::current_exe().unwrap();
        let mut command = CommandBuilder::new(program);
        command.args(super::child::ARGUMENTS);
        self.spawn(command, role, log)
    }

    /// The same under a shell with job control, as on a user's terminal: `$CHILD` starts the role.
    pub fn start_in_shell(&self, script: &str, role: &str, log: &Path) -> Program {
        let program = std::env::current_exe().unwrap();
        let mut command = CommandBuilder::new("bash");
        command.args(["--norc", "--noprofile", "-c", script]);
        command.env("CHILD", format!("{} {}", program.display(), super::child::ARGUMENTS.join(" ")));
        self.spawn(command, role, log)
    }

    fn spawn(&self, mut command: CommandBuilder, role: &str, log: &Path) -> Program {
        command.env(super::child::ROLE, role);
        command.env(super::child::LOG, log);
        command.env("TERM", "xterm");
        command.cwd(std::env::current_dir().unwrap());
        Program(self.pair.slave.spawn_command(command).unwrap())
    }

    /// The line is cut. Only for one that stands still: what reads it would keep it open.
    pub fn hang_up(self) {
        drop(self);
    }
}

pub struct Program(Box<dyn Child + Send + Sync>);

impl Program {
    pub fn wait(&mut self) -> u32 {
        eventually("the program's end", || self.0.try_wait().unwrap()).exit_code()
    }

    pub fn pid(&self) -> Pid {
        Pid::from_raw(self.0.process_id().unwrap() as i32).unwrap()
    }

    /// A shell's only child.
    pub fn child(&self) -> Pid {
        let output =
            Command::new("ps").args(["-o", "pid=", "--ppid", &self.pid().to_string()]).output().unwrap();
        Pid::from_raw(String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()).unwrap()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
    }
}
