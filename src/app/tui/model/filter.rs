//! The filter of the list: which entries it leaves, and in which order.

use super::entry::{ListRow, PresetEntry};
use crate::tui::ranking::Ranking;

/// Groups that stand before all others.
const FIRST: [&str; 2] = ["Plants", "crowns"];

/// The rows of the list: all groups with their headings, or the matches, the best first.
pub fn rows(entries: &[PresetEntry], filter: &str) -> Vec<ListRow> {
    if filter.trim().is_empty() {
        return grouped(entries);
    }
    let mut ranking = Ranking::of(filter);
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

fn grouped(entries: &[PresetEntry]) -> Vec<ListRow> {
    let mut groups: Vec<&str> = Vec::new();
    for entry in entries {
        if !groups.contains(&entry.group.as_str()) {
            groups.push(&entry.group);
        }
    }
    // Plants in leaf first, whoever comes for a tree; the rest as it is listed.
    groups.sort_by_key(|group| FIRST.iter().position(|first| first == group).unwrap_or(FIRST.len()));
    let mut rows = Vec::with_capacity(entries.len() + groups.len());
    for group in groups {
        rows.push(ListRow::Heading(group.to_owned()));
        let members = entries.iter().enumerate().filter(|(_, entry)| entry.group == group);
        rows.extend(members.map(|(i, _)| ListRow::Entry(i, Vec::new())));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::model::Library;

    fn ids(filter: &str) -> Vec<String> {
        let library = Library::builtin();
        let rows = rows(&library.entries, filter);
        rows.iter()
            .filter_map(
                |row| if let ListRow::Entry(i, _) = row { Some(library.get(*i).id.clone()) } else { None },
            )
            .collect()
    }

    #[test]
    fn without_a_filter_everything_is_there_once() {
        let mut all = ids("");
        assert_eq!(all.len(), linden::preset::builtins().len());
        all.sort();
        all.dedup();
        assert_eq!(all.len(), linden::preset::builtins().len());
    }

    #[test]
    fn plants_come_first_and_the_books_weeds_after() {
        let library = Library::builtin();
        let rows = rows(&library.entries, "");
        let headings: Vec<&str> = rows
            .iter()
            .filter_map(|row| if let ListRow::Heading(group) = row { Some(group.as_str()) } else { None })
            .collect();
        assert_eq!(headings, ["Plants", "crowns", "abop", "older"]);
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
        let library = Library::builtin();
        let ListRow::Entry(_, marks) = &rows(&library.entries, "fir")[0] else { panic!() };
        assert_eq!(marks, &[0, 1, 2]);
    }
}
