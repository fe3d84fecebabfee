//! Names that come from documents, for tables of names that are constants.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

static KEPT: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// Keeps a text as long as the program runs, each text once: the names of [knobs](super::Knob) that a document brings
/// along. Memory grows with the number of different texts, and with nothing else.
///
/// ```
/// use linden_base::knob::kept;
/// let name = String::from("limb_angle");
/// assert!(std::ptr::eq(kept(&name), kept("limb_angle")));
/// ```
pub fn kept(text: &str) -> &'static str {
    // Nothing that panics is done with it.
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = all.get(text) {
        return found;
    }
    let new: &'static str = Box::leak(text.to_owned().into_boxed_str());
    all.insert(new);
    new
}
