//! What the system knows of a process.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitOptions, kill_process, waitpid};

use super::PATIENCE;

/// How a process ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Code(i32),
    Signal(i32),
}

/// A child of the test.
pub struct Process {
    pid: Pid,
    reaped: AtomicBool,
}

impl Process {
    pub fn new(pid: Pid) -> Self {
        Self { pid, reaped: AtomicBool::new(false) }
    }

    pub fn pid(&self) -> Pid {
        self.pid
    }

    fn folder(&self) -> PathBuf {
        PathBuf::from(format!("/proc/{}", self.pid))
    }

    /// Waits for its end.
    #[track_caller]
    pub fn wait(&self, screen: impl Fn() -> String) -> End {
        let until = Instant::now() + PATIENCE;
        loop {
            if let Some((_, status)) = waitpid(Some(self.pid), WaitOptions::NOHANG).unwrap() {
                self.reaped.store(true, Ordering::Relaxed);
                return match (status.exit_status(), status.terminating_signal()) {
                    (Some(code), _) => End::Code(code),
                    (None, Some(signal)) => End::Signal(signal),
                    (None, None) => panic!("{status:?}"),
                };
            }
            assert!(Instant::now() < until, "it does not end:\n{}", screen());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    pub fn kill(&self) {
        if !self.reaped.swap(true, Ordering::Relaxed) {
            let _ = kill_process(self.pid, Signal::KILL);
            let _ = waitpid(Some(self.pid), WaitOptions::empty());
        }
    }

    /// A file of each of its threads.
    fn of_threads(&self, name: &str) -> Vec<String> {
        let Ok(tasks) = fs::read_dir(self.folder().join("task")) else { return Vec::new() };
        tasks.filter_map(|task| fs::read_to_string(task.ok()?.path().join(name)).ok()).collect()
    }

    /// Whether each of its threads sleeps.
    pub fn sleeps(&self) -> bool {
        self.of_threads("stat").iter().all(|stat| state(stat) == Some('S'))
    }

    /// `S` sleeps, `R` runs, `T` is stopped.
    pub fn state(&self) -> Option<char> {
        state(&fs::read_to_string(self.folder().join("stat")).ok()?)
    }

    /// How often its threads were given the processor or gave it back: each wake-up counts.
    pub fn switches(&self) -> u64 {
        let of = |status: &String| -> u64 {
            let lines = status.lines().filter(|line| line.contains("ctxt_switches"));
            lines.filter_map(|line| line.split_whitespace().last()?.parse::<u64>().ok()).sum()
        };
        self.of_threads("status").iter().map(of).sum()
    }

    /// The most memory that it has held at once, bytes.
    pub fn peak_bytes(&self) -> u64 {
        let status = fs::read_to_string(self.folder().join("status")).unwrap_or_default();
        let line = status.lines().find(|line| line.starts_with("VmHWM"));
        let kib = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
        kib.unwrap_or(0) * 1024
    }

    /// Its processor time, in ticks of a hundredth of a second.
    pub fn ticks(&self) -> u64 {
        let stat = fs::read_to_string(self.folder().join("stat")).unwrap_or_default();
        let fields: Vec<&str> = after_name(&stat).split_whitespace().collect();
        let of = |at: usize| fields.get(at).and_then(|field| field.parse::<u64>().ok()).unwrap_or(0);
        of(11) + of(12)
    }

    /// Its only child, once there is one that runs that program.
    pub fn child(&self, program: &str) -> Process {
        let pid = super::eventually("the shell's child", || {
            let path = self.folder().join(format!("task/{}/children", self.pid));
            let children = fs::read_to_string(path).ok()?;
            let is_it = |pid: &&str| {
                fs::read_link(format!("/proc/{pid}/exe"))
                    .is_ok_and(|exe| exe == std::path::Path::new(program))
            };
            Pid::from_raw(children.split_whitespace().find(is_it)?.parse().ok()?)
        });
        // Not ours to wait for.
        Process { pid, reaped: AtomicBool::new(true) }
    }
}

/// What follows the name, which may have spaces and parentheses in it.
fn after_name(stat: &str) -> &str {
    stat.rfind(')').map_or("", |end| &stat[end + 1..])
}

fn state(stat: &str) -> Option<char> {
    after_name(stat).trim_start().chars().next()
}
