//! What differs between systems: signals, priorities, permissions, kinds of files.
//!
//! Both files have the same names and signatures; the rest of the program asks for no system.
//! `--cfg linden_portable` builds `portable` on Unix too, as in `linden_terminal`.

#[cfg(all(unix, not(linden_portable)))]
#[path = "unix.rs"]
mod desk;
#[cfg(not(all(unix, not(linden_portable))))]
#[path = "portable.rs"]
mod desk;

/// Where systems keep what belongs to a user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Linux and the BSDs: in folders of the home directory whose names begin with a dot.
    Xdg,
    /// macOS: in its Library.
    Apple,
    /// Windows: where its variables say.
    Windows,
}

/// This system's.
pub const FAMILY: Family = if cfg!(windows) {
    Family::Windows
} else if cfg!(target_os = "macos") {
    Family::Apple
} else {
    Family::Xdg
};

pub use desk::{
    CTRL_ALT_TYPES, HANGUP, QUOTES_DROPPED, cpu_time, end_by, exit_by, is_pipe, is_writable, lower_priority,
    on_signals, opens_at_once, outlive_file_limits, peak_memory,
};
