//! What differs between systems: the terminal's descriptors, who reads them, signals and job control.
//!
//! | file | is for |
//! |---|---|
//! | `unix` | Linux, macOS, the BSDs: a reader of our own, since crossterm's takes late replies for keys, spins on a dead terminal (crossterm issue 793) and hears no signal but a resize |
//! | `portable` | everything else, Windows first: crossterm's reader; the terminal is asked nothing |
//!
//! Both have the same names and signatures. `--cfg linden_portable` builds `portable` on Unix too, which
//! is how it is compiled and tried where there is no Windows.

#[cfg(all(unix, not(linden_portable)))]
#[path = "unix/mod.rs"]
mod desk;
#[cfg(not(all(unix, not(linden_portable))))]
#[path = "portable.rs"]
mod desk;

pub use desk::{ANSWERS, Listener, Tty, ask, listen, takes_sequences};
pub(crate) use desk::{asked_size, discard_input, drain, is_ours, may_be_written, stands_for, stop, stops};
