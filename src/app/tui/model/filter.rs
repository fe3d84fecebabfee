//! The filter of the list: which entries it leaves, and in which order.

use std::collections::BTreeSet;

use super::FORESTS;
use super::entry::{GroupHeading, ListRow, PresetEntry};
use crate::tui::ranking::Ranking;

/// Groups that stand before all others.
const FIRST: [&str; 4] = [FAVOURITES, "Plants", FORESTS, "crowns"];
/// The group of those that were marked.
const FAVOURITES: &str = "Favourites";

/// What decides how entries are listed.
#[derive(Clone, Copy, Debug)]
pub struct Listing<'l> {
    /// What was typed into the filter.
    pub filter: &'l str,
    /// Groups whose entries are hidden, where nothing is filtered.
    pub folded: &'l BTreeSet<String>,
    /// Keys of entries ([`PresetEntry::key`]) that stand in a group of their own.
    pub favourites: &'l BTreeSet<String>,
}

impl Listing<'_> {
    /// The rows of the list: all groups with their headings, or the matches, the best first.
    pub fn rows(self, entries: &[PresetEntry]) -> Vec<ListRow> {
        if self.filter.trim().is_empty() {
            return self.grouped(entries);
        }
        let mut ranking = Ranking::of(self.filter);
        let mut found: Vec<(u32, usize, Vec<u32>)> = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let (id, marks) = ranking.marked(&entry.id).unzip();
            // A hit in the id is meant more often than one in the name or the group.
            let about = ranking.score(&format!("{} {}", entry.name, entry.group));
            if let Some(score) = id.map(|score| 2 * score).into_iter().chain(about).max() {
                found.push((score, i, marks.unwrap_or_default()));
            }
        }
        found.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, i, marks)| ListRow::Entry(i, marks)).collect()
    }

    /// The group that an entry is listed in.
    pub fn group_of(self, entry: &PresetEntry) -> &str {
        if self.favourites.contains(&entry.key()) { FAVOURITES } else { &entry.group }
    }

    fn grouped(self, entries: &[PresetEntry]) -> Vec<ListRow> {
        let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let group = self.group_of(entry);
            match groups.iter_mut().find(|(name, _)| *name == group) {
                Some((_, members)) => members.push(i),
                None => groups.push((group, vec![i])),
            }
        }
        // Plants in leaf first, whoever comes for a tree; the rest as it is listed.
        groups.sort_by_key(|(group, _)| FIRST.iter().position(|first| first == group).unwrap_or(FIRST.len()));
        let mut rows = Vec::with_capacity(entries.len() + groups.len());
        for (group, members) in groups {
            let is_folded = self.folded.contains(group);
            rows.push(ListRow::Heading(GroupHeading {
                group: group.to_owned(),
                members: members.len(),
                is_folded,
            }));
            if !is_folded {
                rows.extend(members.into_iter().map(|i| ListRow::Entry(i, Vec::new())));
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::model::Library;

    fn rows(filter: &str) -> Vec<ListRow> {
        let none = BTreeSet::new();
        Listing { filter, folded: &none, favourites: &none }.rows(&Library::builtin().entries)
    }

    fn ids(filter: &str) -> Vec<String> {
        let library = Library::builtin();
        let rows = rows(filter);
        rows.iter()
            .filter_map(
                |row| if let ListRow::Entry(i, _) = row { Some(library.get(*i).id.clone()) } else { None },
            )
            .collect()
    }

    #[test]
    fn without_a_filter_everything_is_there_once() {
        let mut all = ids("");
        assert_eq!(all.len(), linden::preset::builtins().len() + linden::forest::builtin_forests().len());
        all.sort();
        all.dedup();
        assert_eq!(all.len(), linden::preset::builtins().len() + linden::forest::builtin_forests().len());
    }

    #[test]
    fn plants_come_first_and_the_books_weeds_after() {
        let rows = rows("");
        let headings: Vec<&str> = rows
            .iter()
            .filter_map(
                |row| if let ListRow::Heading(heading) = row { Some(heading.group.as_str()) } else { None },
            )
            .collect();
        assert_eq!(headings, ["Plants", "Forests", "crowns", "abop", "older"]);
    }

    #[test]
    fn the_best_match_comes_first_and_what_does_not_match_is_gone() {
        assert_eq!(ids("fir")[0], "fir");
        assert_eq!(ids("bush")[0], "bush-3d");
        assert_eq!(ids("abpc")[0], "abop-c", "letters may be left out");
        assert!(ids("zzqx").is_empty());
    }

    #[test]
    fn matched_letters_are_marked() {
        let ListRow::Entry(_, marks) = &rows("fir")[0] else { panic!() };
        assert_eq!(marks, &[0, 1, 2]);
    }
}
