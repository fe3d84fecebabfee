//! Grows and measures the trees of a sweep, one on each thread, and hands them on in their order.

use std::time::Instant;

use linden::grow::grow;
use linden::report::Report;

use super::rows::Row;
use super::{Item, Plan};
use crate::cli::crew::{Crew, Share};
use crate::exit::sentence;
use crate::progress::Progress;

/// What is to be done.
pub struct Work<'a> {
    pub plan: &'a Plan,
    /// The first item that is not done yet.
    pub first: usize,
}

impl Work<'_> {
    /// Does it, and gives each row to `take` in the order of the items, until that says false or fails.
    pub fn run(
        &self,
        progress: &Progress,
        mut take: impl FnMut(&Item, Row, [f64; 2]) -> anyhow::Result<bool>,
    ) -> anyhow::Result<()> {
        let crew = Crew { in_order: true, ..Crew::of_threads(progress) };
        let work = |index: usize, share: &Share<'_>| {
            let item = self.plan.item(index);
            let (row, times) = self.measure(&item, share);
            (item, row, times)
        };
        crew.run(self.first..self.plan.len(), work, |(item, row, times)| take(&item, row, times))
    }

    fn measure(&self, item: &Item, job: &Share<'_>) -> (Row, [f64; 2]) {
        let recipe = match self.plan.recipe(item) {
            Ok(recipe) => recipe,
            Err(error) => {
                let row = Row { measured: Err(sentence(&error)), recipe: self.plan.base.to_line() };
                return (row, [0.0; 2]);
            }
        };
        let started = Instant::now();
        let grown = grow(&recipe, job).map_err(anyhow::Error::from);
        let grow_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let measured = grown.and_then(|grown| Ok(Report::of(&recipe, &grown, job)?));
        let times = [grow_s, started.elapsed().as_secs_f64()];
        let line = |error: anyhow::Error| sentence(&error).replace(['\n', '\r'], " ");
        (Row { measured: measured.map_err(line), recipe: recipe.to_line() }, times)
    }
}
