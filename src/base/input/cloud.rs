//! Points, with the numbers of the trees that a segmentation gave them to.

use glam::DVec3;

use super::crs::MapUnits;
use super::mixing::are_mixed;
use crate::last::Last;
use crate::memory::bytes_of;

/// Points as a file has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// In the file's units and axes.
    pub positions: Vec<DVec3>,
    /// Columns that tell trees apart, the likeliest first.
    pub trees: Vec<TreeColumn>,
    /// Columns with a name like theirs that seem to number classes, such as wood and leaf: their numbers lie at the same
    /// places. They tell trees apart where they are asked for by name.
    pub classes: Vec<TreeColumn>,
    /// Columns with a name like theirs whose values number nothing.
    pub unnumbered: Vec<UnnumberedColumn>,
    /// What tells wood from leaves, where the file does.
    pub leaves: Option<LeafColumn>,
    /// How far apart they are in the file's units, where they are the cells of a grid of heights above ground.
    pub cell: Option<f64>,
    /// Which points the file classes as ground, where it classes some so and others not; they are of no tree.
    pub is_ground: Option<Vec<bool>>,
    /// The units of the map that the file says it is drawn on, where they are not metres.
    pub units: Option<MapUnits>,
    /// Whether the file's format itself says that Z is up, as LAS does, and not only custom.
    pub is_z_up: bool,
    /// Rows of a table that were left out, since a coordinate is missing or NaN.
    pub placeless_rows: u64,
    /// Whether the first of four columns counted rows and was passed over, though no header says so.
    pub has_row_numbers: bool,
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

/// A column that is named as if it told trees apart and holds a value that is no number of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct UnnumberedColumn {
    /// As the file names it.
    pub name: String,
    /// The first such value.
    pub value: f64,
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
        let ground = self.is_ground.as_ref().map_or(0, |marks| bytes_of::<bool>(marks.capacity()));
        leaves
            + ground
            + bytes_of::<DVec3>(self.positions.capacity())
            + self.trees.iter().chain(&self.classes).map(of_column).sum::<u64>()
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

    /// Takes what is marked off all trees.
    fn clear(&mut self, marks: &[bool]) {
        for (number, _) in self.numbers.iter_mut().zip(marks).filter(|(_, marked)| **marked) {
            *number = 0;
        }
    }

    /// Points of no tree.
    pub fn unnumbered_points(&self) -> usize {
        self.numbers.iter().filter(|&&number| number == 0).count()
    }

    /// Two numbers whose points lie among each other, where the column has so few that they may be classes of one tree's
    /// points and not trees. Those of no tree do not count.
    pub fn mixed_numbers(&self, positions: &[DVec3]) -> Option<[u32; 2]> {
        let numbers: Vec<u32> = self.counts().into_iter().map(|(number, _)| number).collect();
        self.mixed_of(&numbers, positions)
    }

    /// The same of given numbers.
    fn mixed_of(&self, numbers: &[u32], positions: &[DVec3]) -> Option<[u32; 2]> {
        if numbers.len() > MOST_CLASSES {
            return None;
        }
        let mut sets = vec![Vec::new(); numbers.len()];
        let rows = positions.iter().zip(&self.numbers);
        // Odd, where rows of two numbers take turns.
        for (point, number) in rows.step_by(positions.len().div_ceil(MIXING_SAMPLE) | 1) {
            if let Some(set) = numbers.iter().position(|known| known == number) {
                sets[set].push(*point);
            }
        }
        let pairs = (0..numbers.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let mut mixed = pairs.filter(|&(a, b)| are_mixed(&sets[a], &sets[b]));
        mixed.next().map(|(a, b)| [numbers[a], numbers[b]])
    }

    /// Whether its name hardly says that it numbers trees, and its numbers from 0 are those of classes.
    fn has_classes(&self, positions: &[DVec3]) -> bool {
        if rank(&self.name) != Some(WORDS.len() - 1) {
            return false;
        }
        let mut numbers: Vec<u32> = self.counts().into_iter().map(|(number, _)| number).collect();
        if self.unnumbered_points() > 0 {
            numbers.insert(0, 0);
        }
        self.mixed_of(&numbers, positions).is_some()
    }

    /// Which points lie on leaves, of classes that are 1 and 2.
    fn leaves(&self) -> Option<LeafColumn> {
        let is_one = self.counts().iter().map(|(number, _)| *number).eq([LEAF - 1, LEAF]);
        is_one.then(|| LeafColumn {
            name: self.name.clone(),
            is_leaf: self.numbers.iter().map(|&number| number == LEAF).collect(),
        })
    }
}

/// A column with more numbers has no classes.
const MOST_CLASSES: usize = 6;

/// Points that are looked at for that.
const MIXING_SAMPLE: usize = 300_000;

/// Leaf, where 1 is wood.
const LEAF: u32 = 2;

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
        "part" | "semanticseg" | "woodleaf" | "leafwood" => Some(LEAF),
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
    /// The first value that is no number of a tree.
    odd: Option<f64>,
    /// The largest so far.
    most: u32,
}

/// What columns say.
#[derive(Default)]
pub(super) struct Told {
    /// Those that tell trees apart, the likeliest first.
    pub trees: Vec<TreeColumn>,
    pub classes: Vec<TreeColumn>,
    pub unnumbered: Vec<UnnumberedColumn>,
    /// The first that tells wood from leaves: it has both, and no number beyond them.
    pub leaves: Option<LeafColumn>,
}

impl Columns {
    /// Those of these names.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        let reading = |name| Reading { column: TreeColumn { name, numbers: Vec::new() }, odd: None, most: 0 };
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
    /// fraction, or more than 32 bits hold, makes the whole column one of something else.
    pub fn take(&mut self, column: usize, value: f64, is_kept: bool) {
        let Some(Reading { column, odd, most }) = self.0.get_mut(column) else { return };
        if !value.is_nan() && (value.fract() != 0.0 || value > f64::from(u32::MAX)) {
            odd.get_or_insert(value);
        }
        let number = if value >= 1.0 { value as u32 } else { 0 };
        *most = number.max(*most);
        if is_kept {
            column.numbers.push(number);
        }
    }

    /// What they say of points at these positions, some of which may be on the ground.
    pub fn finish(self, positions: &[DVec3], is_ground: Option<&[bool]>) -> Told {
        let mut told = Told::default();
        for Reading { mut column, odd, most } in self.0 {
            column.clear(is_ground.unwrap_or_default());
            match (leaf_number(&column.name), odd) {
                (Some(leaf), None) => {
                    let TreeColumn { name, numbers } = column;
                    let has_both = numbers.contains(&(leaf - 1)) && numbers.contains(&leaf);
                    if most == leaf && has_both && told.leaves.is_none() {
                        let is_leaf = numbers.iter().map(|&number| number == leaf).collect();
                        told.leaves = Some(LeafColumn { name, is_leaf });
                    }
                }
                (Some(_), Some(_)) => {}
                (None, Some(value)) => {
                    told.unnumbered.push(UnnumberedColumn { name: column.name, value });
                }
                (None, None) if column.numbers.iter().all(|&number| number == 0) => {}
                (None, None) if column.has_classes(positions) => told.classes.push(column),
                (None, None) => told.trees.push(column),
            }
        }
        told.trees.sort_by_key(|column| rank(&column.name));
        told.leaves = told.leaves.or_else(|| told.classes.iter().find_map(TreeColumn::leaves));
        told
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
            let Told { trees, leaves, .. } = columns.finish(&vec![DVec3::ZERO; values.len()], None);
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
        let places = [DVec3::ZERO, 9.0 * DVec3::X, 9.0 * DVec3::Y];
        let Told { trees, leaves, unnumbered, classes } = columns.finish(&places, None);
        assert_eq!((leaves, classes), (None, vec![]));
        assert_eq!(unnumbered, [UnnumberedColumn { name: "instance_share".to_owned(), value: 0.5 }]);
        assert_eq!(trees.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["treeID", "label"]);
        assert_eq!(trees[0].numbers, [0, 0, 7]);
        assert_eq!(trees[1].counts(), [(1, 1), (2, 2)]);
        let find = |name| TreeColumn::find(&trees, name);
        assert_eq!(find(None), find(Some("TREEID")));
        assert_eq!(find(Some("label")).map(|column| column.name.as_str()), Some("label"));
        assert_eq!(find(Some("axis")), None);
    }
}
