//! Everything but Unix, Windows first: what the standard library knows, and Ctrl-C.

use std::fs::{Metadata, OpenOptions};
use std::io;
use std::path::Path;
use std::time::Duration;

/// Stands for a terminal that is gone: the code of 128 + 1 that shells of Unix expect.
pub const HANGUP: i32 = 1;
/// Stands for Ctrl-C, Ctrl-Break, a console that is closed.
const INTERRUPT: i32 = 2;

/// Calls `hear` when the process is asked to end, on a thread of its own.
pub fn on_signals(mut hear: impl FnMut(i32) + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(move || hear(INTERRUPT)).map_err(io::Error::other)
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
