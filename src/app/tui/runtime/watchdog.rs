//! Ends the process when the terminal is gone and the loop does not hear it.
//!
//! Nothing in the loop takes long. Should something all the same (a disk that does not answer), the
//! process must not live on without a terminal, nor keep it from a user who has asked it to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use linden_terminal::{Incoming, session};

use crate::jobs::THREAD_PREFIX;
use crate::system::{HANGUP, end_by};

/// How long the loop may take to hear that it is over.
const HEARING: Duration = Duration::from_millis(800);
/// How long it may take to leave then: exports take their files away.
const LEAVING: Duration = Duration::from_secs(4);

/// Whether the loop has heard.
#[derive(Clone, Default)]
pub struct Watchdog(Arc<AtomicBool>);

impl Watchdog {
    /// The loop is leaving.
    pub fn heard(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// Watches from now on, if what came asks us to end.
    pub fn watch(&self, incoming: &Incoming) {
        let signal = match incoming {
            Incoming::Hangup => HANGUP,
            Incoming::Terminate(signal) => *signal,
            _ => return,
        };
        let heard = Arc::clone(&self.0);
        let watch = move || {
            std::thread::sleep(HEARING);
            if heard.load(Ordering::Acquire) {
                std::thread::sleep(LEAVING);
            }
            // The process is still there.
            session::restore();
            linden_exporters::abandon();
            // What does not end it by itself ends here.
            let _ = end_by(signal);
            std::process::exit(1);
        };
        // Without a thread there is no watchdog, and the loop hears as ever.
        drop(std::thread::Builder::new().name(format!("{THREAD_PREFIX}watchdog")).spawn(watch));
    }
}
