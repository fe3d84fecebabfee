//! The feet of all stems in a cloud.
//!
//! Above ground and grass, below the crown, a slice of the cloud shows a stem as a slim column. Columns
//! of the slice that hang together are one stem: one that forks higher up is one tree to growth, those that
//! stand apart have a root each.

use glam::DVec3;

use super::foot::Foot;
use super::neighbours::Neighbours;
use linden_base::monitor::{Cancelled, Monitor};

/// The slice, as parts of the height above the foot.
const SLICE: (f64, f64) = (0.045, 0.11);

/// Points of a slice that are not farther apart hang together, as a part of the height.
const APART: f64 = 0.012;

/// A stem is not wider, as a part of the height, where stems are looked for unasked.
const SLIM: f64 = 0.09;

/// The share of the slice's height that a stem spans at least.
const SPANS: f64 = 0.7;

/// And has this part of the points of the stem with the most.
const WEIGHT: f64 = 0.2;

/// All feet, the surest first; `wanted` says how many at most (0 is 1), `None` leaves it to the cloud. At least one:
/// the one that [`Foot::find`] finds.
pub(super) fn feet(
    points: &[DVec3],
    wanted: Option<usize>,
    monitor: &dyn Monitor,
) -> Result<Vec<Foot>, Cancelled> {
    let main = Foot::find(points);
    if wanted == Some(1) {
        return Ok(vec![main]);
    }
    let height_m = main.height_m.max(f64::MIN_POSITIVE);
    let (low, high) = (main.root.y + SLICE.0 * height_m, main.root.y + SLICE.1 * height_m);
    let slice: Vec<DVec3> = points.iter().copied().filter(|p| (low..high).contains(&p.y)).collect();
    monitor.check()?;
    let slice = super::thin(&slice, APART / 3.0 * height_m);
    let mut columns: Vec<Column> = columns(&slice, APART * height_m, monitor)?
        .into_iter()
        .filter(|column| column.top - column.bottom >= SPANS * (high - low))
        .filter(|column| wanted.is_some() || column.width <= SLIM * height_m)
        .collect();
    columns.sort_by(|a, b| b.points.cmp(&a.points).then(a.centre.x.total_cmp(&b.centre.x)));
    let level = |a: DVec3, b: DVec3| DVec3::new(a.x - b.x, 0.0, a.z - b.z).length();
    let is_main = |column: &Column| level(column.centre, main.root) <= main.radius_m + 0.5 * column.width;
    let most = columns.first().map_or(0, |column| column.points);
    let enough = |column: &&Column| column.points as f64 >= WEIGHT * most as f64;
    let others: Vec<Foot> = columns
        .iter()
        .filter(|column| !is_main(column))
        .filter(|column| wanted.is_some() || enough(column))
        .take(wanted.map_or(usize::MAX, |wanted| wanted.saturating_sub(1)))
        .map(|column| Foot {
            root: column.foot(points, &main),
            radius_m: column.width.clamp(0.5 * main.radius_m, 2.0 * main.radius_m),
            ..main
        })
        .collect();
    Ok(std::iter::once(main).chain(others).collect())
}

/// Points of the slice that hang together.
struct Column {
    centre: DVec3,
    width: f64,
    bottom: f64,
    top: f64,
    points: usize,
}

impl Column {
    /// Straight below the column, at its lowest point near the height of the main foot.
    fn foot(&self, points: &[DVec3], main: &Foot) -> DVec3 {
        let near = |p: &&DVec3| {
            let away = DVec3::new(p.x - self.centre.x, 0.0, p.z - self.centre.z).length();
            away <= self.width && p.y < self.bottom && p.y >= main.floor_m
        };
        let lowest = points.iter().filter(near).map(|p| p.y).fold(f64::INFINITY, f64::min);
        let y = if lowest.is_finite() { lowest } else { main.root.y };
        DVec3::new(self.centre.x, y, self.centre.z)
    }
}

fn columns(points: &[DVec3], apart_m: f64, monitor: &dyn Monitor) -> Result<Vec<Column>, Cancelled> {
    let tree = Neighbours::new(points, monitor)?;
    let mut column_of = vec![u32::MAX; points.len()];
    let mut columns = Vec::new();
    for first in 0..points.len() {
        if column_of[first] != u32::MAX {
            continue;
        }
        let column = columns.len() as u32;
        column_of[first] = column;
        let mut members = vec![first as u32];
        let mut next = 0;
        while let Some(&at) = members.get(next) {
            next += 1;
            monitor.check()?;
            let limit = apart_m * apart_m;
            tree.search(points[at as usize], limit, |to, _| {
                if column_of[to as usize] == u32::MAX {
                    column_of[to as usize] = column;
                    members.push(to);
                }
                limit
            });
        }
        let places = || members.iter().map(|&i| points[i as usize]);
        let low = places().fold(DVec3::INFINITY, DVec3::min);
        let high = places().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = high - low;
        columns.push(Column {
            centre: low.midpoint(high),
            width: size.x.max(size.z),
            bottom: low.y,
            top: high.y,
            points: members.len(),
        });
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;

    use super::*;

    /// Two bare stems, six metres high.
    fn stems() -> Vec<DVec3> {
        let around = |x: f64| {
            (0..4000).map(move |i| {
                let (sin, cos) = libm::sincos(f64::from(i) * 2.4);
                DVec3::new(x + 0.1 * cos, 0.0015 * f64::from(i), 0.1 * sin)
            })
        };
        around(0.0).chain(around(2.0)).collect()
    }

    #[test]
    fn as_many_feet_as_are_wanted_but_one_at_least() {
        let points = stems();
        for (wanted, count) in [(Some(0), 1), (Some(1), 1), (Some(2), 2), (None, 2)] {
            assert_eq!(feet(&points, wanted, &Quiet).unwrap().len(), count, "{wanted:?}");
        }
    }
}
