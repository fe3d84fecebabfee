//! Measures the tree on screen: all numbers, and what its files would take.

use std::sync::Arc;
use std::time::{Duration, Instant};

use linden::report::{Report, ReportError};
use linden_exporters::Estimate;

use super::{ShownTree, Watcher};

/// A tree that was measured.
#[derive(Debug)]
pub struct Measured {
    /// The tree.
    pub shown: Arc<ShownTree>,
    /// Its numbers, or why there are none.
    pub figures: Result<MeasuredFigures, String>,
}

/// What was measured.
#[derive(Debug)]
pub struct MeasuredFigures {
    /// All numbers.
    pub report: Report,
    /// What files would hold.
    pub estimate: Estimate,
    /// How long measuring took.
    pub took: Duration,
}

/// Measures a tree; `None` when it was cancelled.
pub fn measure(shown: Arc<ShownTree>, watcher: &Watcher<'_>) -> Option<Measured> {
    let started = Instant::now();
    let figures = match Report::of(&shown.recipe, &shown.grown, watcher) {
        Ok(report) => {
            let estimate = Estimate::new(&shown.recipe, &shown.grown, watcher).ok()?;
            Ok(MeasuredFigures { report, estimate, took: started.elapsed() })
        }
        Err(ReportError::Cancelled(_)) => return None,
        Err(error) => Err(error.to_string()),
    };
    Some(Measured { shown, figures })
}
