//! Lists of tables in a document, like `[[colonization.part]]`, and what is wrong with an item.

use super::{Datum, Entry, Fault, Node, TextPlace};
use crate::knob::{did_you_mean, excerpt, nearest};

/// A list of tables.
pub struct List {
    /// Its key.
    pub key: &'static str,
    /// What stands above each item: `[[colonization.part]]`.
    pub heading: &'static str,
    /// What an item is called: `part`.
    pub one: &'static str,
    /// Most items, and what has so many.
    pub most: (usize, &'static str),
}

impl List {
    /// Reads all items; `item` is given each with its number from 1, its entries and its place.
    ///
    /// # Errors
    /// [`Fault`]: no list of tables, too many, or the first that `item` finds.
    pub fn read<T>(
        &self,
        node: &Node,
        item: impl Fn(usize, &[Entry], Option<TextPlace>) -> Result<T, Fault>,
    ) -> Result<Vec<T>, Fault> {
        let expected = || format!("tables, each headed {}", self.heading);
        let Datum::List(items) = &node.datum else { return Err(node.mismatch(self.key, &expected())) };
        let (most, whose) = self.most;
        if items.len() > most {
            let message =
                format!("{} {}s are more than the {most} that {whose} may have", items.len(), self.one);
            return Err(Fault::new(node.place, message));
        }
        let each = items.iter().enumerate().map(|(i, node)| {
            let Datum::Table(entries) = &node.datum else {
                return Err(node.mismatch(self.key, &expected()));
            };
            // Entries come in the order of their names.
            let first = entries.iter().filter_map(|entry| entry.place).min_by_key(|p| (p.line, p.column));
            item(i + 1, entries, first.or(node.place))
        });
        each.collect()
    }

    /// What is wrong with an entry that no item has.
    pub fn unknown(&self, number: usize, entry: &Entry, known: &[&str]) -> Fault {
        let meant = nearest(&entry.key, known.iter().copied());
        let instead = if meant.is_some() {
            did_you_mean(meant)
        } else {
            format!("; it may have: {}", known.join(", "))
        };
        let (one, key) = (self.one, excerpt(&entry.key));
        Fault::new(entry.place, format!("{one} {number} has no '{key}'{instead}"))
    }
}
