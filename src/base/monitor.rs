//! How long work is watched and stopped.
//!
//! Every loop that can take longer than a few milliseconds is given a [`Monitor`]: it reports how
//! far it is and asks whether anybody still wants the result. Work that allocates in proportion to
//! what the user asks for also asks whether there is memory for it ([`Monitor::admit`]).

use std::sync::Arc;

use crate::memory::OverMemory;

/// Watches a piece of work. Called from any thread, often: all methods must be cheap.
pub trait Monitor: Sync {
    /// Whether the result is no longer wanted. The work then returns [`Cancelled`] soon.
    fn is_cancelled(&self) -> bool;

    /// `done` of `total` units (see `phase`) are finished; `total` is `None` where nobody can know.
    fn advance(&self, phase: Phase, done: u64, total: Option<u64>);

    /// What follows is about one of several, `number` from 1: tree 3 of 24.
    fn among(&self, _what: &'static str, _number: usize, _count: usize) {}

    /// `Err(Cancelled)` when the result is no longer wanted: for `?` inside loops.
    ///
    /// # Errors
    /// [`Cancelled`], and nothing else.
    fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Bytes that the work may hold at once. See [`memory`](crate::memory).
    fn memory_limit(&self) -> u64 {
        u64::MAX
    }

    /// Whether `bytes` may be held at once: asked before they are allocated. `doing` and `advice` are
    /// for the message: `sweeping the surface`, `lower sides`.
    ///
    /// # Errors
    /// [`OverMemory`], and nothing else.
    fn admit(&self, doing: &'static str, bytes: u64, advice: &'static str) -> Result<(), OverMemory> {
        let limit_bytes = self.memory_limit();
        if bytes > limit_bytes {
            return Err(OverMemory { doing, needs_bytes: bytes, limit_bytes, advice });
        }
        Ok(())
    }
}

/// Whoever keeps a copy may say that the result is no longer wanted, or look how far the work is.
impl<M: Monitor + Send + ?Sized> Monitor for Arc<M> {
    fn is_cancelled(&self) -> bool {
        (**self).is_cancelled()
    }

    fn advance(&self, phase: Phase, done: u64, total: Option<u64>) {
        (**self).advance(phase, done, total);
    }

    fn among(&self, what: &'static str, number: usize, count: usize) {
        (**self).among(what, number, count);
    }

    fn check(&self) -> Result<(), Cancelled> {
        (**self).check()
    }

    fn memory_limit(&self) -> u64 {
        (**self).memory_limit()
    }

    fn admit(&self, doing: &'static str, bytes: u64, advice: &'static str) -> Result<(), OverMemory> {
        (**self).admit(doing, bytes, advice)
    }
}

/// What is being done, for a progress line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// Reading a file; unit: bytes.
    Read,
    /// Drawing attraction points; unit: points.
    Scatter,
    /// Rewriting an L-system; unit: symbols.
    Derive,
    /// Walking the turtle; unit: symbols.
    Turtle,
    /// Growing by space colonization; unit: attraction points that are decided.
    Grow,
    /// Growing stems on stems; unit: stems of a level.
    Branch,
    /// Growing by light; unit: years.
    Age,
    /// Refining a branching; unit: steps.
    Refine,
    /// Growing leaves; unit: axes.
    Sprout,
    /// Sweeping tubes; unit: axes.
    Sweep,
    /// Contouring wood into one solid; unit: blocks of cells.
    Solidify,
    /// Drawing a plant from many sides; unit: rows of views.
    View,
    /// Casting the rays of a simulated scanner; unit: rows of pulses.
    Scan,
    /// Growing and measuring many trees; unit: trees.
    Measure,
    /// Writing files; unit: bytes.
    Write,
}

impl Phase {
    /// What is going on, and the unit that is counted.
    pub const fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Read => ("reading", "bytes"),
            Self::Scatter => ("scattering", "points"),
            Self::Derive => ("deriving", "symbols"),
            Self::Turtle => ("drawing", "symbols"),
            Self::Grow => ("growing", "points"),
            Self::Age => ("growing", "years"),
            Self::Branch => ("branching", "stems"),
            Self::Refine => ("refining", "steps"),
            Self::Sprout => ("leafing", "axes"),
            Self::Sweep => ("surfacing", "axes"),
            Self::Solidify => ("making one solid", "blocks"),
            Self::View => ("drawing", "rows of views"),
            Self::Scan => ("scanning", "rows"),
            Self::Measure => ("measuring", "trees"),
            Self::Write => ("writing", "bytes"),
        }
    }
}

/// The work was stopped because its result was no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Wraps errors of single stages in the error of the whole. What each calls `Cancelled` becomes the
/// whole's own `Cancelled`, so that callers look in one place.
///
/// ```
/// use linden_base::monitor::Cancelled;
/// #[derive(Debug)]
/// enum StageError { Cancelled(Cancelled), TooLarge }
/// #[derive(Debug)]
/// enum WholeError { Cancelled(Cancelled), Stage(StageError) }
/// linden_base::from_cancellable!(WholeError: StageError => Stage);
/// assert!(matches!(WholeError::from(StageError::Cancelled(Cancelled)), WholeError::Cancelled(_)));
/// assert!(matches!(WholeError::from(StageError::TooLarge), WholeError::Stage(_)));
/// ```
#[macro_export]
macro_rules! from_cancellable {
    ($whole:ident: $($error:ident => $variant:ident),*) => {$(
        impl From<$error> for $whole {
            fn from(error: $error) -> Self {
                if let $error::Cancelled(cancelled) = error { Self::Cancelled(cancelled) } else { Self::$variant(error) }
            }
        }
    )*};
}

/// Watches nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Monitor for Quiet {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
}

/// A monitor for a stage while the caller keeps some memory: what the stage asks for is asked on top
/// of that.
pub struct Holding<'a> {
    monitor: &'a dyn Monitor,
    bytes: u64,
}

impl<'a> Holding<'a> {
    /// `bytes` are held beside what `monitor` knows of.
    pub fn new(monitor: &'a dyn Monitor, bytes: u64) -> Self {
        Self { monitor, bytes }
    }
}

impl Monitor for Holding<'_> {
    fn is_cancelled(&self) -> bool {
        self.monitor.is_cancelled()
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        self.monitor.advance(stage, done, total);
    }

    fn among(&self, what: &'static str, number: usize, count: usize) {
        self.monitor.among(what, number, count);
    }

    fn memory_limit(&self) -> u64 {
        self.monitor.memory_limit()
    }

    fn admit(&self, doing: &'static str, bytes: u64, advice: &'static str) -> Result<(), OverMemory> {
        self.monitor.admit(doing, self.bytes.saturating_add(bytes), advice)
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// Admits so many bytes, and is never cancelled.
    pub struct Limited(pub u64);

    impl Monitor for Limited {
        fn is_cancelled(&self) -> bool {
            false
        }

        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

        fn memory_limit(&self) -> u64 {
            self.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::Limited;
    use super::*;

    #[test]
    fn what_is_held_counts_and_the_limit_itself_fits() {
        let limited = Limited(1000);
        let holding = Holding::new(&limited, 300);
        let deeper = Holding::new(&holding, 100);
        assert_eq!(deeper.admit("drawing", 600, "draw less"), Ok(()));
        let refused = deeper.admit("drawing", 601, "draw less").unwrap_err();
        assert_eq!((refused.needs_bytes, refused.limit_bytes), (1001, 1000));
        assert!(deeper.admit("drawing", u64::MAX, "draw less").is_err(), "no overflow");
        assert_eq!(Quiet.admit("drawing", u64::MAX, "draw less"), Ok(()));
    }

    #[test]
    fn both_figures_and_what_to_do_are_said() {
        let refused = Limited(4 << 30).admit("sweeping the surface", 53 << 27, "lower sides").unwrap_err();
        assert_eq!(
            refused.to_string(),
            "sweeping the surface would take 6.62 GiB, more than the memory limit of 4.00 GiB; lower sides, or \
             raise the limit 'memory'"
        );
    }
}
