//! Which points of a file are the tree's, where the file says which tree each belongs to.

use std::borrow::Cow;

use glam::DVec3;
use linden_base::input::{Cloud, TreeColumn};
use linden_base::knob::{excerpt, printable};

use crate::{ScanGrowthError, ScanSettings, crowns};

/// Numbers of trees that a message names.
const MOST_NAMED: usize = 12;

/// The columns of a file that tell trees apart, which a grid of heights does by its tops.
pub(crate) fn columns<'a>(
    settings: &ScanSettings,
    cloud: &'a Cloud,
) -> Result<Cow<'a, [TreeColumn]>, ScanGrowthError> {
    let Some(cell) = cloud.cell else { return Ok(Cow::Borrowed(&cloud.trees)) };
    let told = crowns::tell_apart(&cloud.positions, cell, settings.scale.unwrap_or(1.0));
    let column =
        told.map_err(|problem| ScanGrowthError::Trees(format!("{}: {problem}", printable(&settings.file))))?;
    Ok(Cow::Owned(vec![column]))
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

/// The points that are grown into, and what is to be said of the others.
pub(crate) fn chosen<'a>(
    settings: &ScanSettings,
    cloud: &'a Cloud,
) -> Result<(Cow<'a, [DVec3]>, Option<String>), ScanGrowthError> {
    let columns = columns(settings, cloud)?;
    let column = column(settings, &columns)?;
    let Some(wanted) = wanted(settings) else {
        return Ok((Cow::Borrowed(&cloud.positions), column.and_then(|column| several(settings, column))));
    };
    let Some(column) = column else {
        return Err(ScanGrowthError::Trees(format!(
            "tree={wanted}: {} says of no point which tree it belongs to; tree=auto takes all points",
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
    Ok((Cow::Owned(points), None))
}

/// What is said where several trees are about to be grown as one.
fn several(settings: &ScanSettings, column: &TreeColumn) -> Option<String> {
    let count = column.counts().len();
    let (name, file) = (excerpt(&column.name), printable(&settings.file));
    (count > 1).then(|| {
        format!(
            "'{name}' of {file} tells {count} trees apart, and all of its points were taken for one; tree=N takes one \
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
