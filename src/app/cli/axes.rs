//! `linden show --axes`: the axes of a tree, by the paths that edits name them with.

use linden::grow::Grown;
use linden::skeleton::edit::{AxisOrigin, AxisPath, AxisPaths};
use linden::skeleton::{Axis, NO_PARENT, Skeleton};
use serde::Serialize;

/// All axes of a tree.
#[derive(Serialize)]
pub(super) struct AxisList {
    /// Fingerprint of how the tree branches, as edits have it.
    branching: u32,
    axes: Vec<AxisRow>,
}

/// An axis.
#[derive(Serialize)]
struct AxisRow {
    path: String,
    order: u32,
    length_m: f64,
    /// At its base.
    radius_m: f32,
    /// Of the place where it leaves above the lowest node of the tree.
    height_m: f32,
    laterals: usize,
    nodes: u32,
    /// What edits keep to find the axis again: where it began as the tree grew. `null` for what an edit added.
    near: Option<[f64; 3]>,
}

impl AxisList {
    /// Those of a tree as it stands, in the order of their paths.
    pub fn of(grown: &Grown) -> Self {
        let (skeleton, as_grown) = (&*grown.skeleton, &*grown.as_grown.skeleton);
        let paths = grown.axis_paths();
        let standing = AxisPaths::new(skeleton);
        let ground_m = skeleton.positions.iter().map(|at| at.y).fold(f32::INFINITY, f32::min);
        let row = |(index, axis): (u32, &Axis)| {
            let path = grown.axis_path(index, &paths)?;
            let near = match grown.origins.as_ref().map(|origins| &origins.axes[index as usize]) {
                Some(AxisOrigin::Added(_)) => None,
                Some(AxisOrigin::Grown(axis)) => as_grown.beginning(*axis),
                None => as_grown.beginning(index),
            };
            let near = near.map(|at| at.to_array().map(|x| (x * 1e4).round() / 1e4));
            let [base, first] = ends(skeleton, axis)?;
            let row = AxisRow {
                path: path.to_string(),
                order: axis.order,
                length_m: skeleton.axis_length_m(index),
                radius_m: skeleton.radii[first],
                height_m: skeleton.positions[base].y - ground_m,
                laterals: standing.laterals(index).len(),
                nodes: axis.len,
                near,
            };
            Some((path, row))
        };
        let mut rows: Vec<(AxisPath, AxisRow)> = (0..).zip(&skeleton.axes).filter_map(row).collect();
        rows.sort_by(|a, b| a.0.cmp(&b.0));
        Self { branching: paths.fingerprint(), axes: rows.into_iter().map(|(_, row)| row).collect() }
    }

    /// As a table.
    pub fn text(&self) -> String {
        let width = self.axes.iter().map(|row| row.path.len()).max().unwrap_or(0).max(4);
        let mut text =
            format!("{:width$}  order  length m  radius cm  height m  laterals  begins at x,y,z\n", "axis");
        for row in &self.axes {
            let AxisRow { path, order, length_m, radius_m, height_m, laterals, near, .. } = row;
            let near = near.map_or_else(|| "added".to_owned(), |[x, y, z]| format!("{x},{y},{z}"));
            let radius_cm = radius_m * 100.0;
            text.push_str(&format!(
                "{path:width$}  {order:5}  {length_m:8.2}  {radius_cm:9.2}  {height_m:8.2}  {laterals:8}  {near}\n"
            ));
        }
        let count = self.axes.len();
        text + &format!("{count} axes; branching = {}\n", self.branching)
    }
}

/// The node where an axis begins, and the first one of its thickness.
fn ends(skeleton: &Skeleton, axis: &Axis) -> Option<[usize; 2]> {
    let first = *skeleton.nodes_of(axis).first()? as usize;
    Some([if axis.parent == NO_PARENT { first } else { axis.parent as usize }, first])
}
