//! Which points of a file are the tree's, where several are told apart.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;
use linden_base::input::{Cloud, LeafColumn, TreeColumn, UnnumberedColumn, Up};
use linden_base::knob::{excerpt, printable};
use linden_base::monitor::Monitor;

use crate::plot::{PlotRule, tell_apart};
use crate::settings::Segmentation;
use crate::{ScanGrowthError, ScanSettings, crowns};

/// Numbers of trees that a message names.
const MOST_NAMED: usize = 12;

/// The name that takes no column: all points are one tree.
const NO_COLUMN: &str = "none";

/// Columns that tell trees apart, the likeliest first.
pub(crate) enum Columns<'a> {
    /// Those of the file.
    File(&'a Cloud),
    /// One that was worked out.
    Told(Arc<TreeColumn>),
}

impl Columns<'_> {
    pub fn all(&self) -> &[TreeColumn] {
        match self {
            Self::File(cloud) => &cloud.trees,
            Self::Told(column) => std::slice::from_ref(column),
        }
    }

    /// The one of a name; those of classes are trees for who names them.
    fn named(&self, name: &str) -> Option<&TreeColumn> {
        let classes = match self {
            Self::File(cloud) => &cloud.classes[..],
            Self::Told(_) => &[],
        };
        TreeColumn::find(self.all(), Some(name)).or_else(|| TreeColumn::find(classes, Some(name)))
    }
}

/// The columns that tell the points' trees apart: the file's own, that of a grid's tops, or that of the stems that are found.
/// `usual` is the axis that points up in such files.
pub(crate) fn columns<'a>(
    settings: &ScanSettings,
    cloud: &'a Cloud,
    usual: Up,
    monitor: &dyn Monitor,
) -> Result<Columns<'a>, ScanGrowthError> {
    let refused = |problem: &str| {
        Err(ScanGrowthError::Trees(format!("segmentation=paths: {}: {problem}", printable(&settings.file))))
    };
    let by_paths = settings.segmentation == Segmentation::Paths;
    if by_paths && settings.instance.as_ref().is_some_and(|name| name != NO_COLUMN) {
        return refused("instance names a column that tells trees apart; leave out one of both");
    }
    let column = match cloud.cell {
        Some(_) if by_paths => {
            return refused(
                "a grid of heights shows no stems; segmentation=column tells its trees apart by their tops",
            );
        }
        Some(cell) => {
            let scale = settings.scale_of(cloud).unwrap_or(1.0);
            cloud.segmentation_cache.get(format!("tops {scale}"), || {
                let told = crowns::tell_apart(&cloud.positions, cell, scale);
                told.map_err(|problem| {
                    ScanGrowthError::Trees(format!("{}: {problem}", printable(&settings.file)))
                })
            })?
        }
        None if by_paths => {
            let rule = plot_rule(settings, cloud, usual);
            let work_out = || tell_apart(&cloud.positions, &rule, monitor).map_err(ScanGrowthError::from);
            let column = cloud.segmentation_cache.get(format!("{rule:?}"), work_out)?;
            if column.numbers.iter().all(|&number| number == 0) {
                return refused(
                    "no stem of a tree stands on the ground there; are scale= and up= right, and is it seen 0.4 to 3 m above the ground?",
                );
            }
            column
        }
        None => return Ok(Columns::File(cloud)),
    };
    Ok(Columns::Told(column))
}

/// How a plot's trees are found.
fn plot_rule(settings: &ScanSettings, cloud: &Cloud, usual: Up) -> PlotRule {
    PlotRule { up: settings.growth.given_up().unwrap_or(usual), scale: settings.scale_of(cloud) }
}

/// The column that tells trees apart; `None` where the file has none and none is asked for, or none is to be used.
pub(crate) fn column<'a>(
    settings: &ScanSettings,
    cloud: &Cloud,
    columns: &'a Columns<'_>,
) -> Result<Option<&'a TreeColumn>, ScanGrowthError> {
    let Some(name) = &settings.instance else { return Ok(columns.all().first()) };
    if let Some(column) = columns.named(name) {
        return Ok(Some(column));
    }
    if name == NO_COLUMN {
        // It is about the columns of files.
        return Ok(match columns {
            Columns::File(_) => None,
            Columns::Told(column) => Some(column),
        });
    }
    let (shown, file) = (excerpt(name), printable(&settings.file));
    let odd = cloud.unnumbered.iter().find(|column| column.name.eq_ignore_ascii_case(name));
    Err(ScanGrowthError::Trees(match odd {
        Some(column) => format!("instance: {}; write whole numbers", no_numbers(column)),
        None if columns.all().is_empty() => format!(
            "instance: '{shown}' of {file} is no column of trees: the file says of no point which tree it belongs to"
        ),
        None => {
            let names = columns.all().iter().map(|column| format!("'{}'", excerpt(&column.name)));
            let names: Vec<String> = names.collect();
            format!("instance: {file} has no column '{shown}' of trees; it has {}", names.join(", "))
        }
    }))
}

/// The number that is asked for.
pub(crate) fn wanted(settings: &ScanSettings) -> Option<u32> {
    settings.tree.map(|number| libm::round(number) as u32)
}

/// The points that are grown into.
pub(crate) struct Chosen<'a> {
    pub points: Cow<'a, [DVec3]>,
    /// Whether each lies on a leaf, where the file says so.
    pub is_leaf: Option<Cow<'a, [bool]>>,
    /// Points near them that the file classes as ground.
    pub ground: Vec<DVec3>,
    /// Points near them that are of no tree, where the file does not class the ground.
    pub others: Vec<DVec3>,
    /// What is to be said of columns and of the other points.
    pub notes: Vec<String>,
}

impl<'a> Chosen<'a> {
    /// All of a file that are not on the ground.
    fn all(cloud: &'a Cloud) -> Self {
        match &cloud.is_ground {
            Some(is_ground) => Self::of(cloud, |at| !is_ground[at]),
            None => Self {
                points: Cow::Borrowed(&cloud.positions),
                is_leaf: cloud.leaves.as_ref().map(|column| Cow::Borrowed(&column.is_leaf[..])),
                ground: Vec::new(),
                others: Vec::new(),
                notes: Vec::new(),
            },
        }
    }

    /// Those of a number.
    fn of_tree(cloud: &'a Cloud, column: &TreeColumn, wanted: u32) -> Self {
        let is_ground = |at: usize| cloud.is_ground.as_ref().is_some_and(|marks| marks[at]);
        let chosen = Self::of(cloud, |at| column.numbers[at] == wanted && !is_ground(at));
        let others = others_near(cloud, column, &chosen.points);
        Self { others, ..chosen }
    }

    fn of(cloud: &'a Cloud, is_wanted: impl Fn(usize) -> bool) -> Self {
        let wanted = || (0..cloud.positions.len()).filter(|&at| is_wanted(at));
        let points: Vec<DVec3> = wanted().map(|at| cloud.positions[at]).collect();
        let is_leaf = cloud.leaves.as_ref().map(|leaves| wanted().map(|at| leaves.is_leaf[at]).collect());
        let ground = ground_near(cloud, &points);
        Self {
            points: Cow::Owned(points),
            is_leaf: is_leaf.map(Cow::Owned),
            ground,
            others: Vec::new(),
            notes: Vec::new(),
        }
    }
}

/// Points on the ground that are looked at.
const MOST_GROUND: usize = 100_000;

/// The points that a file classes as ground, evenly through those in the box around some points.
fn ground_near(cloud: &Cloud, points: &[DVec3]) -> Vec<DVec3> {
    let Some(is_ground) = &cloud.is_ground else { return Vec::new() };
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    // A trunk may stand at the edge of its crown, and the ground below all of it.
    let reach = (high - low).max_element();
    let is_near = |p: &DVec3| p.cmpge(low - reach).all() && p.cmple(high + reach).all();
    let rows = cloud.positions.iter().zip(is_ground);
    let ground: Vec<DVec3> =
        rows.filter(|(p, is_ground)| **is_ground && is_near(p)).map(|(p, _)| *p).collect();
    let every = ground.len().div_ceil(MOST_GROUND).max(1);
    ground.into_iter().step_by(every).collect()
}

/// How far beyond a tree's points others are looked for, as a part of their extent.
const BESIDE: f64 = 0.1;

/// The points of no tree in the box around some points, where the file does not say which of them lie on the ground.
fn others_near(cloud: &Cloud, column: &TreeColumn, points: &[DVec3]) -> Vec<DVec3> {
    if cloud.is_ground.is_some() {
        return Vec::new();
    }
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let reach = BESIDE * (high - low).max_element();
    let is_near = |p: &DVec3| p.cmpge(low - reach).all() && p.cmple(high + reach).all();
    let rows = cloud.positions.iter().zip(&column.numbers);
    rows.filter(|(p, number)| **number == 0 && is_near(p)).map(|(p, _)| *p).collect()
}

/// The points that are grown into, and what is to be said of the others.
pub(crate) fn chosen<'a>(
    settings: &ScanSettings,
    cloud: &'a Cloud,
    usual: Up,
    monitor: &dyn Monitor,
) -> Result<Chosen<'a>, ScanGrowthError> {
    let columns = columns(settings, cloud, usual, monitor)?;
    let column = column(settings, cloud, &columns)?;
    let chosen = match (wanted(settings), column) {
        (None, None) => Chosen::all(cloud),
        (None, Some(column)) => unasked(settings, cloud, column),
        (Some(wanted), Some(column)) => {
            let chosen = Chosen::of_tree(cloud, column, wanted);
            if chosen.points.is_empty() {
                let numbers = column.counts().into_iter().map(|(number, _)| number.to_string());
                return Err(ScanGrowthError::Trees(format!(
                    "tree={wanted}: no point of {} has this number in '{}'; it numbers {}",
                    printable(&settings.file),
                    excerpt(&column.name),
                    the_first(numbers)
                )));
            }
            chosen
        }
        (Some(wanted), None) => {
            let why = cloud.unnumbered.first().map(|column| format!(" ({})", no_numbers(column)));
            return Err(ScanGrowthError::Trees(format!(
                "tree={wanted}: {} says of no point which tree it belongs to{}; tree=auto takes all points, \
                 segmentation=paths finds the trees by their stems",
                printable(&settings.file),
                why.unwrap_or_default()
            )));
        }
    };
    let mut notes = column_notes(settings, cloud, column);
    if let (None, Some(marks)) = (wanted(settings), &cloud.is_ground) {
        let count = marks.iter().filter(|mark| **mark).count();
        notes.push(format!(
            "{count} points that the file classes as ground (class 2) were left out; the tree stands on them"
        ));
    }
    notes.extend(chosen.notes);
    Ok(Chosen { notes, ..chosen })
}

/// The points where no tree is asked for: those of the only one, or all.
fn unasked<'a>(settings: &ScanSettings, cloud: &'a Cloud, column: &TreeColumn) -> Chosen<'a> {
    let of_file = settings.segmentation == Segmentation::Column && cloud.cell.is_none();
    let (name, file) = (excerpt(&column.name), printable(&settings.file));
    let on_ground = cloud.is_ground.as_ref().map_or(0, |marks| marks.iter().filter(|mark| **mark).count());
    match (&column.counts()[..], column.unnumbered_points().saturating_sub(on_ground)) {
        (&[(only, _)], others) if of_file && others > 0 => {
            let note = format!(
                "{others} of {} points are of no tree by '{name}' of {file} and were left out: it numbers one tree, {only}; \
                 instance={NO_COLUMN} takes all points",
                column.numbers.len()
            );
            Chosen { notes: vec![note], ..Chosen::of_tree(cloud, column, only) }
        }
        (counts, _) => {
            let count = counts.len();
            let trees = if count == 1 { "tree" } else { "trees" };
            let is_several = count > 1 || settings.segmentation == Segmentation::Paths;
            let note = is_several.then(|| {
                format!(
                    "'{name}' of {file} tells {count} {trees} apart, and all of its points were taken for one; tree=N takes \
                     one of them, 'linden export {file} -o trees/' grows each"
                )
            });
            Chosen { notes: note.into_iter().collect(), ..Chosen::all(cloud) }
        }
    }
}

/// What is to be said of the columns of a file: of those that are ignored, and of numbers that seem to be classes.
fn column_notes(settings: &ScanSettings, cloud: &Cloud, used: Option<&TreeColumn>) -> Vec<String> {
    if cloud.cell.is_some() {
        return Vec::new();
    }
    let mut notes = Vec::new();
    if settings.segmentation == Segmentation::Column && settings.instance.is_none() {
        notes.extend(cloud.unnumbered.iter().map(|column| format!("{}: it was ignored", no_numbers(column))));
    }
    let is_used = |column: &TreeColumn| used.is_some_and(|used| used.name == column.name);
    for column in cloud.classes.iter().filter(|column| !is_used(column)) {
        let name = excerpt(&column.name);
        let taken = if cloud.leaves.as_ref().is_some_and(|leaves| leaves.name == column.name) {
            "it was taken for wood (1) and leaf (2); leaf_points=none takes all for wood"
        } else {
            "it was ignored; where it tells wood from leaf, name it wood_leaf (1 wood, 2 leaf) or is_leaf (0, 1)"
        };
        notes.push(format!(
            "the numbers of '{name}' lie at the same places, as those of classes do and trees do not: {taken}, and \
             instance={name} takes it for trees"
        ));
    }
    if settings.segmentation == Segmentation::Column
        && let Some(column) = used
        && let Some([a, b]) = column.mixed_numbers(&cloud.positions)
    {
        let name = excerpt(&column.name);
        notes.push(format!(
            "{a} and {b} of '{name}' lie at the same places, as classes such as wood and leaf do and trees do not; if they are \
             no trees, instance={NO_COLUMN} takes all points for one"
        ));
    }
    notes
}

/// What is wrong with a column whose values number nothing.
fn no_numbers(column: &UnnumberedColumn) -> String {
    let UnnumberedColumn { name, value } = column;
    let problem = if value.fract() == 0.0 { "too large (at most 4294967295)" } else { "no whole number" };
    format!("'{}' numbers no trees: it holds {value}, which is {problem}", excerpt(name))
}

/// The first of some texts in a row, and how many more there are.
fn the_first(mut texts: impl Iterator<Item = String>) -> String {
    let shown: Vec<String> = texts.by_ref().take(MOST_NAMED).collect();
    let rest = texts.count();
    if rest == 0 { shown.join(", ") } else { format!("{} and {rest} more", shown.join(", ")) }
}

/// A column as a page shows it: its trees with their points.
pub(crate) fn line(column: &TreeColumn) -> String {
    let counts = column.counts();
    let trees = counts.iter().map(|(number, points)| format!("{number} ({points} points)"));
    format!("'{}': {} trees: {}", excerpt(&column.name), counts.len(), the_first(trees))
}

/// The column that tells wood from leaves as a page shows it.
pub(crate) fn leaf_line(column: &LeafColumn) -> String {
    let leaves = column.is_leaf.iter().filter(|leaf| **leaf).count();
    format!("'{}': {leaves} of {} points", excerpt(&column.name), column.is_leaf.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_a_dozen() {
        let of = |count: u32| the_first((1..=count).map(|number| number.to_string()));
        assert_eq!(of(2), "1, 2");
        assert!(of(12).ends_with("11, 12"));
        assert!(of(15).ends_with("11, 12 and 3 more"));
    }
}
