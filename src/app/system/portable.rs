//! Everything but Unix, Windows first: what the standard library knows, and Ctrl-C.

use std::fs::{Metadata, OpenOptions};
use std::io;
use std::path::Path;
use std::time::Duration;

use signal_hook::consts::SIGINT;

/// Whether a key that is held with Ctrl and Alt types a character: Windows says `AltGr` so.
pub const CTRL_ALT_TYPES: bool = true;
/// Whether terminals quote a path that is dropped on them as shells take it: here `\` parts folders.
pub const QUOTES_DROPPED: bool = false;
/// Stands for a terminal that is gone: the code of 128 + 1 that shells of Unix expect.
pub const HANGUP: i32 = 1;

/// Calls `hear` when Ctrl-C, Ctrl-Break or the closing of the console asks the process to end, on a thread
/// of its own.
#[cfg(windows)]
pub fn on_signals(mut hear: impl FnMut(i32) + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(move || hear(SIGINT)).map_err(io::Error::other)
}

/// Calls `hear` when Ctrl-C or the like asks the process to end, on a thread of its own.
#[cfg(not(windows))]
pub fn on_signals(mut hear: impl FnMut(i32) + Send + 'static) -> io::Result<()> {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    /// How often it is looked whether a signal came: they set a flag, and nothing waits for it.
    const LOOK: Duration = Duration::from_millis(50);
    let asked = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&asked))?;
    }
    let listen = move || loop {
        std::thread::sleep(LOOK);
        if asked.swap(false, Ordering::Relaxed) {
            hear(SIGINT);
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map(drop)
}

/// Ends at once, with the code that shells expect.
pub fn exit_by(signal: i32) -> ! {
    std::process::exit(128 + signal)
}

/// Ends as the signal would have ended us, where there are any: with its code.
pub fn end_by(signal: i32) -> io::Result<()> {
    exit_by(signal)
}

/// There are no such limits.
pub fn outlive_file_limits() {}

/// All threads are equal.
pub fn lower_priority() {}

/// Is not told.
pub fn cpu_time() -> Option<Duration> {
    None
}

/// Is not told.
pub fn peak_memory() -> Option<u64> {
    None
}

/// Whether files can be made in a directory: tried, since permissions here are more than a bit.
pub fn is_writable(directory: &Path) -> bool {
    tempfile::tempfile_in(directory).is_ok()
}

/// Opening waits for nothing here.
pub fn opens_at_once(_: &mut OpenOptions) {}

/// Pipes with names are no files here.
pub fn is_pipe(_: &Metadata) -> bool {
    false
}
