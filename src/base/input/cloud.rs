//! Points, with the numbers of the trees that a segmentation gave them to.

use glam::DVec3;

use crate::last::Last;
use crate::memory::bytes_of;

/// Points as a file has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// In the file's units and axes.
    pub positions: Vec<DVec3>,
    /// Columns that tell trees apart, the likeliest first.
    pub trees: Vec<TreeColumn>,
    /// What tells wood from leaves, where the file does.
    pub leaves: Option<LeafColumn>,
    /// How far apart they are in the file's units, where they are the cells of a grid of heights above ground.
    pub cell: Option<f64>,
    /// The names of the columns that were taken for x, y and z, where a table has a header that names none of these;
    /// printable.
    pub unnamed: Option<[String; 3]>,
    /// Of what these are a part, where they were thinned.
    pub thinned: Option<Thinned>,
    /// What they became by thinning last, by the sides of the cubes.
    pub thinning_cache: Last<f64, Self>,
    /// The column that was worked out from the positions last, by the rule for it.
    pub segmentation_cache: Last<String, TreeColumn>,
}

/// How points were thinned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinned {
    /// The sides of the cubes of which one point each was kept, in the file's units.
    pub cube: f64,
    /// How many points there were.
    pub of: u64,
}

/// The number of the tree that each point belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeColumn {
    /// As the file names it.
    pub name: String,
    /// One for each position; 0: of no tree.
    pub numbers: Vec<u32>,
}

/// Which points lie on leaves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeafColumn {
    /// As the file names it.
    pub name: String,
    /// One for each position.
    pub is_leaf: Vec<bool>,
}

impl Cloud {
    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let of_column = |column: &TreeColumn| bytes_of::<u32>(column.numbers.capacity());
        let leaves = self.leaves.as_ref().map_or(0, |column| bytes_of::<bool>(column.is_leaf.capacity()));
        leaves
            + bytes_of::<DVec3>(self.positions.capacity())
            + self.trees.iter().map(of_column).sum::<u64>()
            + self.segmentation_cache.kept().map_or(0, |column| of_column(&column))
            + self.thinning_cache.kept().map_or(0, |cloud| cloud.bytes())
    }
}

impl From<Vec<DVec3>> for Cloud {
    fn from(positions: Vec<DVec3>) -> Self {
        Self { positions, ..Self::default() }
    }
}

impl LeafColumn {
    /// What the file has for a position.
    pub(super) fn number(&self, position: usize) -> u32 {
        let leaf = leaf_number(&self.name).unwrap_or_default();
        if self.is_leaf[position] { leaf } else { leaf.saturating_sub(1) }
    }
}

impl TreeColumn {
    /// The column of a name, whichever case it is written in; without a name the first.
    pub fn find<'a>(columns: &'a [Self], name: Option<&str>) -> Option<&'a Self> {
        let Some(name) = name else { return columns.first() };
        let exact = columns.iter().find(|column| column.name == name);
        exact.or_else(|| columns.iter().find(|column| column.name.eq_ignore_ascii_case(name)))
    }

    /// The trees' numbers in rising order, with how many points each has.
    pub fn counts(&self) -> Vec<(u32, usize)> {
        let mut counts = std::collections::BTreeMap::<u32, usize>::new();
        for run in self.numbers.chunk_by(|a, b| a == b).filter(|run| run[0] != 0) {
            *counts.entry(run[0]).or_default() += run.len();
        }
        counts.into_iter().collect()
    }
}

/// Words that the names of such columns have in them, the likeliest first: those of programs that segment scans of
/// forests, then those of others.
const WORDS: [&str; 8] =
    ["predinstance", "treeid", "tree", "instance", "stem", "segment", "cluster", "label"];

/// How likely a column of this name tells trees apart, 0 the likeliest; `None`: its name says nothing of the kind. Case,
/// blanks, `_`, and the `scalar_` of `CloudCompare` do not count.
fn rank(name: &str) -> Option<usize> {
    // Other facts about trees and stems.
    const OTHERS: [&str; 7] = ["species", "height", "radius", "dbh", "dist", "prob", "score"];
    let plain = plain(name);
    if leaf_number(name).is_some() || OTHERS.iter().any(|word| plain.contains(word)) {
        return None;
    }
    WORDS.iter().position(|word| plain.contains(word))
}

/// The letters and digits of a name in small letters, without the `scalar_` of `CloudCompare`.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|letter| letter.is_alphanumeric());
    let plain: String = letters.map(|letter| letter.to_ascii_lowercase()).collect();
    plain.strip_prefix("scalar").map_or_else(|| plain.clone(), str::to_owned)
}

/// What the numbers of a column of this name say of wood and leaves: 1 wood and 2 leaf, as the scanner of linden and
/// programs that segment forests write them, or 1 leaf and 0 none. `None`: its name says nothing of the kind.
fn leaf_number(name: &str) -> Option<u32> {
    match plain(name).as_str() {
        "part" | "semanticseg" | "woodleaf" | "leafwood" => Some(2),
        "leaf" | "isleaf" => Some(1),
        _ => None,
    }
}

/// Whether a column of this name may tell trees apart, or leaves from wood.
pub(super) fn is_read(name: &str) -> bool {
    rank(name).is_some() || leaf_number(name).is_some()
}

/// Columns that are being read.
#[derive(Default)]
pub(super) struct Columns(Vec<Reading>);

struct Reading {
    column: TreeColumn,
    /// All values so far are whole numbers.
    is_whole: bool,
    /// The largest so far.
    most: u32,
}

impl Columns {
    /// Those of these names.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        let reading =
            |name| Reading { column: TreeColumn { name, numbers: Vec::new() }, is_whole: true, most: 0 };
        Self(names.into_iter().map(reading).collect())
    }

    /// Makes room for so many values of each, which was asked for.
    pub fn reserve_exact(&mut self, rows: usize) {
        for reading in &mut self.0 {
            reading.column.numbers.reserve_exact(rows);
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(|reading| bytes_of::<u32>(reading.column.numbers.capacity())).sum()
    }

    /// Takes the value of a point to a column, and adds it if the point is kept. What is below 1 or no number is of no tree; a
    /// fraction makes the whole column one of something else.
    pub fn take(&mut self, column: usize, value: f64, is_kept: bool) {
        let Some(Reading { column, is_whole, most }) = self.0.get_mut(column) else { return };
        *is_whole &= value.is_nan() || value.fract() == 0.0 && value <= f64::from(u32::MAX);
        let number = if value >= 1.0 { value as u32 } else { 0 };
        *most = number.max(*most);
        if is_kept {
            column.numbers.push(number);
        }
    }

    /// Those that tell trees apart, the likeliest first, and the first that tells wood from leaves: it has both, and no
    /// number beyond them.
    pub fn finish(self) -> (Vec<TreeColumn>, Option<LeafColumn>) {
        let is_one = |reading: &Reading| reading.is_whole && reading.column.numbers.iter().any(|&n| n > 0);
        let found = self.0.into_iter().filter(is_one);
        let (leaves, trees): (Vec<Reading>, Vec<Reading>) =
            found.partition(|reading| leaf_number(&reading.column.name).is_some());
        let mut trees: Vec<TreeColumn> = trees.into_iter().map(|reading| reading.column).collect();
        trees.sort_by_key(|column| rank(&column.name));
        let leaves = leaves.into_iter().find_map(|Reading { column, most, .. }| {
            let TreeColumn { name, numbers } = column;
            let leaf = leaf_number(&name)?;
            let has_both = numbers.contains(&(leaf - 1)) && numbers.contains(&leaf);
            let is_leaf = || numbers.iter().map(|&number| number == leaf).collect();
            (most == leaf && has_both).then(|| LeafColumn { is_leaf: is_leaf(), name })
        });
        (trees, leaves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_segmentations_give_are_known() {
        for name in [
            "PredInstance",
            "PredInstance_SAT",
            "3DT_PredInstance_17",
            "treeID",
            "TreeID",
            "tree_id",
            "tree",
            "scalar_treeID",
            "instance",
            "Tree ID",
            "label",
            "segment",
        ] {
            assert!(rank(name).is_some() && is_read(name), "{name}");
        }
        for name in ["intensity", "red", "classification", "gps_time", "tree_height", "species", "axis", ""] {
            assert!(!is_read(name), "{name}");
        }
    }

    #[test]
    fn wood_and_leaves_are_told_by_a_column_that_has_both() {
        let read = |name: &str, values: &[f64]| {
            let mut columns = Columns::new([name.to_owned()]);
            for &value in values {
                columns.take(0, value, true);
            }
            let (trees, leaves) = columns.finish();
            assert!(trees.is_empty(), "{name}");
            leaves.map(|column| column.is_leaf)
        };
        assert_eq!(read("part", &[0.0, 1.0, 2.0]), Some(vec![false, false, true]));
        assert_eq!(read("scalar_semantic_seg", &[2.0, 1.0]), Some(vec![true, false]));
        assert_eq!(read("is_leaf", &[0.0, 1.0]), Some(vec![false, true]));
        for (name, values) in
            [("part", [0.0, 1.0]), ("part", [1.0, 3.0]), ("leaf", [1.0, 1.0]), ("leaf", [0.5, 1.0])]
        {
            assert_eq!(read(name, &values), None, "{name} {values:?}");
        }
        assert_eq!(rank("semantic_seg"), None);
    }

    #[test]
    fn the_likeliest_column_comes_first_and_fractions_are_no_trees() {
        let mut columns = Columns::new(["label", "instance_share", "treeID", "tree"].map(str::to_owned));
        for (column, values) in
            [(0, [1.0, 2.0, 2.0]), (1, [1.0, 0.5, 2.0]), (2, [f64::NAN, -1.0, 7.0]), (3, [0.0, 0.0, -1.0])]
        {
            for value in values {
                columns.take(column, value, true);
            }
        }
        let (trees, leaves) = columns.finish();
        assert_eq!(leaves, None);
        assert_eq!(trees.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["treeID", "label"]);
        assert_eq!(trees[0].numbers, [0, 0, 7]);
        assert_eq!(trees[1].counts(), [(1, 1), (2, 2)]);
        let find = |name| TreeColumn::find(&trees, name);
        assert_eq!(find(None), find(Some("TREEID")));
        assert_eq!(find(Some("label")).map(|column| column.name.as_str()), Some("label"));
        assert_eq!(find(Some("axis")), None);
    }
}
