//! Unix.

use std::fs::{Metadata, OpenOptions};
use std::io;
use std::os::unix::fs::{FileTypeExt as _, OpenOptionsExt as _};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rustix::fs::{Access, OFlags};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::low_level;

/// Whether a key that is held with Ctrl and Alt types a character.
pub const CTRL_ALT_TYPES: bool = false;
/// Whether terminals quote a path that is dropped on them as shells take it.
pub const QUOTES_DROPPED: bool = true;
/// The signal of a terminal that is gone.
pub const HANGUP: i32 = SIGHUP;

/// Calls `hear` with each signal that asks the process to end, on a thread of its own: what it does then
/// may be more than a handler may do.
pub fn on_signals(mut hear: impl FnMut(i32) + Send + 'static) -> io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let listen = move || signals.forever().for_each(&mut hear);
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map(drop)
}

/// Ends at once, with the code that shells expect.
pub fn exit_by(signal: i32) -> ! {
    low_level::exit(128 + signal)
}

/// Ends as the signal would have ended us: the program that waits for this one sees which it was. Returns
/// for signals that end no process.
pub fn end_by(signal: i32) -> io::Result<()> {
    low_level::emulate_default_handler(signal)
}

/// From now on, a file that grows past `ulimit -f` is an error as any other: the signal that comes with
/// it would end us with nothing said.
pub fn outlive_file_limits() {
    // Not ignored but heard, so that a plug-in has it as it was. A program that cannot listen is ended.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// Lets the interface come first: on a busy machine keys are answered before trees are grown.
pub fn lower_priority() {
    // On Linux this is the thread's priority; elsewhere, or where it is refused, nothing is lost.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(10);
}

/// What this process has worked, all threads together; `None` where it is not told.
pub fn cpu_time() -> Option<Duration> {
    Duration::try_from(rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime)).ok()
}

/// The most memory that this process had so far, bytes; `None` where it is not told: Linux says it in `/proc`.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// Whether files can be made in a directory, as far as its permissions tell.
pub fn is_writable(directory: &Path) -> bool {
    rustix::fs::access(directory, Access::WRITE_OK | Access::EXEC_OK).is_ok()
}

/// Opening does not wait, whatever has taken the file's place.
pub fn opens_at_once(options: &mut OpenOptions) {
    options.custom_flags(OFlags::NONBLOCK.bits().cast_signed());
}

/// Whether it is a pipe with a name.
pub fn is_pipe(about: &Metadata) -> bool {
    about.file_type().is_fifo()
}
