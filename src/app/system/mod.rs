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

pub use desk::{
    HANGUP, cpu_time, end_by, exit_by, is_pipe, is_writable, lower_priority, on_signals, opens_at_once,
    outlive_file_limits,
};
