//! Ctrl-C, SIGTERM and SIGHUP stop the work in an orderly way; a second one stops it at once, and takes
//! away what would be left of it.

use std::sync::atomic::{AtomicU8, Ordering};

use crate::system;

/// The signal that came first, 0 for none.
static RECEIVED: AtomicU8 = AtomicU8::new(0);

/// Listens from now on.
pub fn listen() -> std::io::Result<()> {
    system::on_signals(|signal| {
        let number = u8::try_from(signal).unwrap_or(u8::MAX);
        if RECEIVED.compare_exchange(0, number, Ordering::Relaxed, Ordering::Relaxed).is_err() {
            linden_exporters::abandon();
            system::exit_by(signal);
        }
    })
}

/// The signal that asked us to stop, if one did.
pub fn received() -> Option<u8> {
    match RECEIVED.load(Ordering::Relaxed) {
        0 => None,
        signal => Some(signal),
    }
}
