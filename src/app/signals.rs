//! Ctrl-C, SIGTERM and SIGHUP stop the work in an orderly way; a second one stops it at once, and takes
//! away what would be left of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

/// The signal that came first, 0 for none.
static RECEIVED: AtomicU8 = AtomicU8::new(0);

/// Listens from now on.
pub fn listen() -> std::io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    // Not in a handler: what it does then is more than a handler may do.
    let hear = move || {
        for signal in signals.forever() {
            let number = u8::try_from(signal).unwrap_or(u8::MAX);
            if RECEIVED.compare_exchange(0, number, Ordering::Relaxed, Ordering::Relaxed).is_err() {
                linden_exporters::abandon();
                signal_hook::low_level::exit(128 + signal);
            }
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(hear).map(drop)
}

/// From now on, a file that grows past `ulimit -f` is an error as any other: the signal that comes with
/// it would end us with nothing said.
pub fn outlive_file_limits() {
    #[cfg(unix)]
    {
        // Not ignored but heard, so that a plug-in has it as it was. A program that cannot listen is ended.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)));
    }
}

/// The signal that asked us to stop, if one did.
pub fn received() -> Option<u8> {
    match RECEIVED.load(Ordering::Relaxed) {
        0 => None,
        signal => Some(signal),
    }
}
