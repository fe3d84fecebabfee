//! Which of the things that a sweep varies change nothing in its trees.

use linden::report::{NUMBERS, Report};
use xxhash_rust::xxh3::Xxh3;

use super::Plan;

/// The one number that tells recipes apart, and not trees.
const OF_RECIPE: &str = "recipe_hash";

/// Compares each tree with the one before it along each axis, as rows come in the order of the plan.
pub struct Effects {
    axes: Vec<Along>,
    /// A hash of the numbers of each tree so far, `None` for one that failed; kept while they are needed.
    trees: Vec<Option<u64>>,
}

/// An axis, or the seeds, of which there are several values.
struct Along {
    /// What is said to change nothing.
    name: String,
    values: usize,
    /// From a tree to the one with the next value, all else alike.
    stride: usize,
    /// Whether two trees along it were compared.
    is_compared: bool,
    /// Whether two differed.
    is_effective: bool,
}

impl Effects {
    pub fn of(plan: &Plan) -> Self {
        let mut stride = 1;
        let mut along = |name: &str, values: usize| {
            let along =
                Along { name: name.to_owned(), values, stride, is_compared: false, is_effective: false };
            stride = stride.saturating_mul(values);
            along
        };
        // Seeds run fastest, then the last axis.
        let mut axes = vec![along("seed", usize::try_from(plan.seeds).unwrap_or(usize::MAX))];
        axes.extend(plan.axes.iter().rev().map(|axis| along(axis.what.name(), axis.values.len())));
        axes.reverse();
        axes.retain(|along| along.values > 1);
        Self { axes, trees: Vec::new() }
    }

    /// Takes the next tree.
    pub fn take(&mut self, measured: Option<&Report>) {
        // Mostly each axis has shown an effect after a few trees, and nothing needs to be kept.
        if self.axes.iter().all(|along| along.is_effective) {
            self.trees = Vec::new();
            return;
        }
        let index = self.trees.len();
        let tree = measured.map(fingerprint);
        let has_one_before = |along: &&mut Along| !(index / along.stride).is_multiple_of(along.values);
        for along in self.axes.iter_mut().filter(has_one_before) {
            let before = self.trees[index - along.stride];
            along.is_compared |= tree.is_some() && before.is_some();
            along.is_effective |= tree != before;
        }
        self.trees.push(tree);
    }

    /// What is said of those that change nothing.
    pub fn notes(&self) -> Vec<String> {
        let idle = self.axes.iter().filter(|along| along.is_compared && !along.is_effective);
        idle.map(|Along { name, .. }| {
            format!(
                "{name} changes nothing in this table: trees that differ by it alone have the same skeleton, organs and \
                 numbers"
            )
        })
        .collect()
    }
}

/// A hash of all that a row says of a tree, its recipe left out.
fn fingerprint(report: &Report) -> u64 {
    let mut hash = Xxh3::new();
    for number in NUMBERS.iter().filter(|number| number.name != OF_RECIPE) {
        hash.update((number.reading)(report).field().as_bytes());
        // No field has it.
        hash.update(&[0]);
    }
    hash.digest()
}
