//! Which points of a file are the tree's, where several are told apart.

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;
use linden_base::input::{Cloud, LeafColumn, TreeColumn, Up};
use linden_base::knob::{excerpt, printable};
use linden_base::monitor::Monitor;

use crate::plot::{PlotRule, tell_apart};
use crate::settings::Segmentation;
use crate::{ScanGrowthError, ScanSettings, crowns};

/// Numbers of trees that a message names.
const MOST_NAMED: usize = 12;

/// Columns that tell trees apart, the likeliest first.
pub(crate) enum Columns<'a> {
    /// Those of the file.
    File(&'a [TreeColumn]),
    /// One that was worked out.
    Told(Arc<TreeColumn>),
}

impl Columns<'_> {
    pub fn all(&self) -> &[TreeColumn] {
        match self {
            Self::File(columns) => columns,
            Self::Told(column) => std::slice::from_ref(column),
        }
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
    if by_paths && settings.instance.is_some() {
        return refused("instance names a column that tells trees apart; leave out one of both");
    }
    let column = match cloud.cell {
        Some(_) if by_paths => {
            return refused(
                "a grid of heights shows no stems; segmentation=column tells its trees apart by their tops",
            );
        }
        Some(cell) => {
            let scale = settings.scale.unwrap_or(1.0);
            cloud.segmentation_cache.get(format!("tops {scale}"), || {
                let told = crowns::tell_apart(&cloud.positions, cell, scale);
                told.map_err(|problem| {
                    ScanGrowthError::Trees(format!("{}: {problem}", printable(&settings.file)))
                })
            })?
        }
        None if by_paths => {
            let rule = plot_rule(settings, usual);
            let work_out = || tell_apart(&cloud.positions, &rule, monitor).map_err(ScanGrowthError::from);
            let column = cloud.segmentation_cache.get(format!("{rule:?}"), work_out)?;
            if column.numbers.iter().all(|&number| number == 0) {
                return refused(
                    "no stem of a tree stands on the ground there; are scale= and up= right, and is it seen 0.4 to 3 m above the ground?",
                );
            }
            column
        }
        None => return Ok(Columns::File(&cloud.trees)),
    };
    Ok(Columns::Told(column))
}

/// How a plot's trees are found.
fn plot_rule(settings: &ScanSettings, usual: Up) -> PlotRule {
    PlotRule { up: settings.growth.given_up().unwrap_or(usual), scale: settings.scale }
}

/// The column that tells trees apart; `None` where the file has none and none is asked for.
pub(crate) fn column<'a>(
    settings: &ScanSettings,
    columns: &'a [TreeColumn],
) -> Result<Option<&'a TreeColumn>, ScanGrowthError> {
    let column = TreeColumn::find(columns, settings.instance.as_deref());
    let names = || columns.iter().map(|column| format!("'{}'", excerpt(&column.name))).collect::<Vec<_>>();
    match (&settings.instance, column) {
        (Some(name), None) if columns.is_empty() => Err(ScanGrowthError::Trees(format!(
            "instance: '{}' of {} is no column of trees: the file says of no point which tree it belongs to",
            excerpt(name),
            printable(&settings.file)
        ))),
        (Some(name), None) => Err(ScanGrowthError::Trees(format!(
            "instance: {} has no column '{}' of trees; it has {}",
            printable(&settings.file),
            excerpt(name),
            names().join(", ")
        ))),
        (_, column) => Ok(column),
    }
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
    /// What is to be said of the others.
    pub note: Option<String>,
}

/// The points that are grown into, and what is to be said of the others.
pub(crate) fn chosen<'a>(
    settings: &ScanSettings,
    cloud: &'a Cloud,
    usual: Up,
    monitor: &dyn Monitor,
) -> Result<Chosen<'a>, ScanGrowthError> {
    let columns = columns(settings, cloud, usual, monitor)?;
    let column = column(settings, columns.all())?;
    let Some(wanted) = wanted(settings) else {
        return Ok(Chosen {
            points: Cow::Borrowed(&cloud.positions),
            is_leaf: cloud.leaves.as_ref().map(|column| Cow::Borrowed(&column.is_leaf[..])),
            note: column.and_then(|column| several(settings, column)),
        });
    };
    let Some(column) = column else {
        return Err(ScanGrowthError::Trees(format!(
            "tree={wanted}: {} says of no point which tree it belongs to; tree=auto takes all points, \
             segmentation=paths finds the trees by their stems",
            printable(&settings.file)
        )));
    };
    let is_wanted = column.numbers.iter().map(|&number| number == wanted);
    let points: Vec<DVec3> = cloud
        .positions
        .iter()
        .zip(is_wanted)
        .filter_map(|(&point, is_wanted)| is_wanted.then_some(point))
        .collect();
    if points.is_empty() {
        let numbers = column.counts().into_iter().map(|(number, _)| number.to_string());
        return Err(ScanGrowthError::Trees(format!(
            "tree={wanted}: no point of {} has this number in '{}'; it numbers {}",
            printable(&settings.file),
            excerpt(&column.name),
            the_first(numbers)
        )));
    }
    let is_leaf = cloud.leaves.as_ref().map(|leaves| {
        let rows = column.numbers.iter().zip(&leaves.is_leaf);
        rows.filter(|(number, _)| **number == wanted).map(|(_, leaf)| *leaf).collect()
    });
    Ok(Chosen { points: Cow::Owned(points), is_leaf: is_leaf.map(Cow::Owned), note: None })
}

/// What is said where several trees are about to be grown as one, or none of those that were looked for is picked.
fn several(settings: &ScanSettings, column: &TreeColumn) -> Option<String> {
    let count = column.counts().len();
    let (name, file) = (excerpt(&column.name), printable(&settings.file));
    let trees = if count == 1 { "tree" } else { "trees" };
    (count > 1 || settings.segmentation == Segmentation::Paths).then(|| {
        format!(
            "'{name}' of {file} tells {count} {trees} apart, and all of its points were taken for one; tree=N takes one \
             of them, 'linden export {file} -o trees/' grows each"
        )
    })
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
