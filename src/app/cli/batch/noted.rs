//! Notes of all trees of a batch, each kind once.

use std::collections::BTreeMap;

use super::rows::Row;

/// The most kinds of notes that are said; rows have all.
const MOST: usize = 20;

/// Notes by what they say, whatever numbers are in it; of those of one tree that say the same but for these the first, the
/// second and so on are kinds of their own.
#[derive(Default)]
pub struct Noted(BTreeMap<(String, usize), Kind>);

/// Notes that say the same but for their numbers.
struct Kind {
    /// The first tree that has one, with its place among those of this tree: the order does not depend on which tree was
    /// done first.
    first: (usize, usize),
    /// What it says there.
    text: String,
    trees: usize,
    /// Whether all say the same.
    is_one: bool,
}

impl Noted {
    /// Adds those of a tree.
    pub fn add(&mut self, row: &Row) {
        let mut of_row: BTreeMap<String, usize> = BTreeMap::new();
        for (place, note) in row.notes.iter().enumerate() {
            let key = without_numbers(note);
            let alike = of_row.entry(key.clone()).or_default();
            let first = (row.index, place);
            let kind = self.0.entry((key, *alike)).or_insert_with(|| Kind {
                first,
                text: note.clone(),
                trees: 0,
                is_one: true,
            });
            *alike += 1;
            kind.trees += 1;
            kind.is_one &= kind.text == *note;
            if first < kind.first {
                (kind.first, kind.text) = (first, note.clone());
            }
        }
    }

    /// A line for each kind, in the order of the first trees that have them.
    pub fn lines(&self) -> Vec<String> {
        let mut kinds: Vec<&Kind> = self.0.values().collect();
        kinds.sort_unstable_by_key(|kind| kind.first);
        let further = kinds.len().saturating_sub(MOST);
        let lines = kinds.into_iter().take(MOST).map(Kind::line);
        let rest = (further > 0).then(|| format!("{further} further kinds of notes are in the rows"));
        lines.chain(rest).collect()
    }
}

impl Kind {
    fn line(&self) -> String {
        let Self { first: (tree, _), text, trees, is_one } = self;
        match trees {
            1 => format!("tree {tree}: {text}"),
            trees if *is_one => format!("{text} ({trees} trees)"),
            trees => format!("tree {tree}: {text} (alike of {trees} trees)"),
        }
    }
}

/// A text with each number replaced by a sign: `4`, `4.25`, `19 964`.
fn without_numbers(text: &str) -> String {
    let mut key = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        key.push_str(&rest[..at]);
        key.push('#');
        rest = after_number(&rest[at..]);
    }
    key + rest
}

/// What stands behind the number that a text begins with.
fn after_number(text: &str) -> &str {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let mut rest = &text[digits(text)..];
    // Groups of thousands, as counts are written.
    while rest.starts_with(' ') && digits(&rest[1..]) == 3 {
        rest = &rest[4..];
    }
    match rest.strip_prefix('.') {
        Some(fraction) if digits(fraction) > 0 => &fraction[digits(fraction)..],
        _ => rest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(index: usize, notes: &[&str]) -> Row {
        Row { index, notes: notes.iter().map(|&note| note.to_owned()).collect(), ..Row::default() }
    }

    #[test]
    fn each_kind_is_said_once_whichever_tree_comes_first() {
        let rows = [
            row(0, &["a is left out", "3 leaves fell"]),
            row(1, &["a is left out"]),
            row(2, &["12 leaves fell", "4.25 m are bare"]),
        ];
        let expected = [
            "a is left out (2 trees)",
            "tree 0: 3 leaves fell (alike of 2 trees)",
            "tree 2: 4.25 m are bare",
        ];
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let mut noted = Noted::default();
            for at in order {
                noted.add(&rows[at]);
            }
            assert_eq!(noted.lines(), expected);
        }
    }

    #[test]
    fn numbers_are_one_sign_however_they_are_written() {
        for text in ["4 m are bare", "4.25 m are bare", "19 964 m are bare", "1 019 964.5 m are bare"] {
            assert_eq!(without_numbers(text), "# m are bare");
        }
        assert_eq!(without_numbers("level 1: 12 of 300. 7 remain"), "level #: # of #. # remain");
        assert_eq!(without_numbers("10 2000"), "# #");
    }

    #[test]
    fn of_two_notes_of_a_tree_that_differ_in_numbers_alone_both_are_said() {
        let mut noted = Noted::default();
        noted.add(&row(3, &["level 1 is bare", "level 2 is bare"]));
        noted.add(&row(1, &["level 1 is bare"]));
        assert_eq!(noted.lines(), ["level 1 is bare (2 trees)", "tree 3: level 2 is bare"]);
    }

    #[test]
    fn many_kinds_are_counted() {
        let mut noted = Noted::default();
        let notes: Vec<String> = (0..MOST + 2).map(|n| "x".repeat(n + 1)).collect();
        noted.add(&Row { notes, ..Row::default() });
        assert_eq!(noted.lines().len(), MOST + 1);
        assert_eq!(noted.lines()[MOST], "2 further kinds of notes are in the rows");
    }
}
