//! Lists of tables in a document, like `[[colonization.part]]`: a table of rows for what each item may
//! say, and what is wrong with an item that says something else.

use super::document::{Datum, Entry, Fault, Node, Place};
use crate::knob::{Knob, Value, did_you_mean, excerpt, nearest};

/// A row: a knob of something that documents may hold several of.
pub struct Field<T> {
    /// Name, kind, unit, help.
    pub knob: Knob,
    pub(super) read: fn(&T) -> Value,
    pub(super) write: fn(&mut T, Value),
}

// Derived, these would ask the same of T.
impl<T> Clone for Field<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Field<T> {}

/// A row: name, kind, unit, help, and the field that it reads and writes.
macro_rules! field {
    ($name:literal, $kind:expr, $unit:literal, $help:literal, $field:ident) => {
        $crate::preset::item::Field {
            knob: $crate::knob::Knob { name: $name, kind: $kind, unit: $unit, help: $help },
            read: |item| $crate::preset::setting::Setting::to_value(&item.$field),
            write: |item, value| $crate::preset::setting::assign(&mut item.$field, value),
        }
    };
}
pub(super) use field;

/// A list of tables.
pub(crate) struct List {
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
    pub fn read<T>(
        &self,
        node: &Node,
        item: impl Fn(usize, &[Entry], Option<Place>) -> Result<T, Fault>,
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
