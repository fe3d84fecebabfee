//! How long work is watched and stopped.
//!
//! Every loop that can take longer than a few milliseconds is given a [`Monitor`]: it reports how
//! far it is and asks whether anybody still wants the result. Work that allocates in proportion to
//! what the user asks for also asks whether there is memory for it ([`Monitor::admit`]).

use crate::memory::OverMemory;

/// Watches a piece of work. Called from any thread, often: all methods must be cheap.
pub trait Monitor: Sync {
    /// Whether the result is no longer wanted. The work then returns [`Cancelled`] soon.
    fn is_cancelled(&self) -> bool;

    /// `done` of `total` units (see `phase`) are finished; `total` is `None` where nobody can know.
    fn advance(&self, phase: Phase, done: u64, total: Option<u64>);

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

/// What is being done, for a progress line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Refining a branching; unit: steps.
    Refine,
    /// Growing leaves; unit: axes.
    Sprout,
    /// Sweeping tubes; unit: axes.
    Sweep,
    /// Contouring wood into one solid; unit: blocks of cells.
    Solidify,
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
            Self::Refine => ("refining", "steps"),
            Self::Sprout => ("leafing", "axes"),
            Self::Sweep => ("surfacing", "axes"),
            Self::Solidify => ("making one solid", "blocks"),
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
