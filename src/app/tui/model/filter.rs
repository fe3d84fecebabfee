//! The filter of the list: which entries it leaves, and in which order.

use std::collections::{BTreeMap, BTreeSet};

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
    /// Tags that the user gave, by the keys of entries.
    pub tags: &'l BTreeMap<String, Vec<String>>,
}

impl Listing<'_> {
    /// The rows of the list: all groups with their headings, or the matches, the best first.
    pub fn rows(self, entries: &[PresetEntry]) -> Vec<ListRow> {
        if self.filter.trim().is_empty() {
            return self.grouped(entries);
        }
        let (wanted, words) = split_tags(self.filter);
        let mut ranking = Ranking::of(&words);
        let mut found: Vec<(Option<u32>, usize, Vec<u32>)> = Vec::new();
        for (i, entry) in
            entries.iter().enumerate().filter(|(_, entry)| has_tags(&self.tags_of(entry), &wanted))
        {
            let (id, marks) = ranking.marked(&entry.id).unzip();
            // A hit in the id is meant more often than one in the name or the group.
            let about = ranking.score(&format!("{} {}", entry.name, entry.group));
            let score = id.map(|score| 2 * score).into_iter().chain(about).max();
            // What is told of it is read below the list, and typed again; it comes after all names.
            let PresetEntry { id, name, group, summary, source, .. } = entry;
            if score.is_some() || ranking.is_told(&[id, name, group, summary, source]) {
                found.push((score, i, marks.unwrap_or_default()));
            }
        }
        found.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, i, marks)| ListRow::Entry(i, marks)).collect()
    }

    /// The tags of an entry: its document's, then the user's.
    pub fn tags_of<'e>(self, entry: &'e PresetEntry) -> Vec<&'e str>
    where
        Self: 'e,
    {
        let mut tags: Vec<&str> = entry.tags.iter().map(String::as_str).collect();
        for tag in self.tags.get(&entry.key()).into_iter().flatten() {
            if !tags.contains(&tag.as_str()) {
                tags.push(tag);
            }
        }
        tags
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

/// Tells the tags (`#hedge`) from the other words of what was typed.
pub fn split_tags(typed: &str) -> (Vec<&str>, String) {
    let (tags, words): (Vec<&str>, Vec<&str>) =
        typed.split_whitespace().partition(|word| word.starts_with('#'));
    (tags.into_iter().map(|tag| &tag[1..]).collect(), words.join(" "))
}

/// Whether each of the wanted tags is the beginning of one that there is: they are being typed.
pub fn has_tags(tags: &[&str], wanted: &[&str]) -> bool {
    wanted.iter().all(|wanted| tags.iter().any(|tag| tag.starts_with(wanted)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::model::Library;

    fn rows(filter: &str) -> Vec<ListRow> {
        let none = BTreeSet::new();
        let tags = BTreeMap::new();
        Listing { filter, folded: &none, favourites: &none, tags: &tags }.rows(&Library::builtin().entries)
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
        assert_eq!(
            headings,
            ["Plants", "Forests", "crowns", "abop", "older", "Self-organizing", "Weber & Penn"]
        );
    }

    #[test]
    fn the_best_match_comes_first_and_what_does_not_match_is_gone() {
        assert_eq!(ids("fir")[0], "fir");
        assert_eq!(ids("bush")[0], "bush-3d");
        assert_eq!(ids("abpc")[0], "abop-c", "letters may be left out");
        assert!(ids("zzqx").is_empty());
    }

    #[test]
    fn what_is_told_of_a_preset_is_found_after_all_names() {
        for (typed, id) in [
            ("hawthorn", "so-windswept"),
            ("crataegus", "so-windswept"),
            ("Quercus", "oak"),
            ("bare trunk", "scots-pine"),
        ] {
            assert!(ids(typed).iter().any(|found| found == id), "{typed}: {:?}", ids(typed));
        }
        let library = Library::builtin();
        let told = |id: &str, word: &str| {
            let entry = library.entries.iter().find(|entry| entry.id == id).unwrap();
            entry.name.to_lowercase().contains(word) || entry.id.contains(word)
        };
        let found = ids("birch");
        let first_told = found.iter().position(|id| !told(id, "birch")).unwrap_or(found.len());
        assert!(first_told > 0 && found[first_told..].iter().all(|id| !told(id, "birch")), "{found:?}");
    }

    #[test]
    fn tags_leave_those_that_have_all_of_them() {
        let mut library = Library::builtin();
        for (id, tags) in [("fir", ["conifer", "dark"]), ("scots-pine", ["conifer", "light"])] {
            library.select_place(&crate::tui::tree::TreePlace::Builtin(id));
            library.tag(tags.map(str::to_owned).to_vec());
        }
        let found = |library: &mut Library, filter: &str| -> Vec<String> {
            library.filter_by(filter);
            let ids = library.rows().iter().filter_map(|row| match row {
                ListRow::Entry(i, _) => Some(library.get(*i).id.clone()),
                ListRow::Heading(_) => None,
            });
            let mut ids: Vec<String> = ids.collect();
            ids.sort();
            ids
        };
        assert_eq!(found(&mut library, "#conifer"), ["fir", "scots-pine"]);
        assert_eq!(found(&mut library, "#con #li"), ["scots-pine"], "beginnings count");
        assert_eq!(found(&mut library, "#conifer fir"), ["fir"]);
        assert!(found(&mut library, "#palm").is_empty());
    }

    #[test]
    fn matched_letters_are_marked() {
        let ListRow::Entry(_, marks) = &rows("fir")[0] else { panic!() };
        assert_eq!(marks, &[0, 1, 2]);
    }
}
