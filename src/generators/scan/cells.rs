//! All neighbours within a fixed reach, of all points at once: points sorted by the cells of a grid, and one sweep
//! along its columns. Where every point asks, and points are about as dense everywhere (thinned ones are), that takes
//! a fraction of what searches in a tree do.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::z_order::{self, BITS};
use linden_base::monitor::{Cancelled, Monitor};

/// Cells in the reach: more fit the ball better and take longer to find.
const CELLS_PER_REACH: f64 = 2.0;

/// Cells from the middle one to the last that the reach may touch.
const REACH_CELLS: u32 = 2;

/// Rows of columns that it may touch.
const ROWS: usize = 2 * REACH_CELLS as usize + 1;

/// Columns between two looks at the monitor.
const COLUMNS_PER_CHECK: usize = 256;

/// Points by the columns (equal x and y) of a grid's cells.
pub(super) struct Cells {
    reach_m: f64,
    /// Column after column, cells in the order of z.
    slots: Vec<Slot>,
    /// In the order of x, then y.
    columns: Vec<Column>,
}

struct Slot {
    /// From the corner of the grid.
    at: Vec3,
    z: u32,
    index: u32,
}

/// A point near another: in the order of how near it is, then of its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Near(u64);

impl Near {
    /// Bits of non-negative floats order as the floats do.
    fn new(squared_m: f32, index: u32) -> Self {
        Self(u64::from(squared_m.to_bits()) << 32 | u64::from(index))
    }

    pub fn index(self) -> u32 {
        self.0 as u32
    }

    /// Its squared distance, in single precision.
    pub fn squared_m(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

struct Column {
    /// x, then y, each in its bits.
    at: u64,
    slots: Range<u32>,
}

impl Cells {
    /// For neighbours nearer than `reach_m` metres.
    pub fn new(points: &[DVec3], reach_m: f64) -> Self {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let cell_m = (reach_m / CELLS_PER_REACH).max((high - low).max_element() / z_order::MOST);
        let key = |p: &DVec3| {
            let [x, y, z] = ((*p - low) / cell_m).to_array().map(|cell| cell as u64);
            x << (2 * BITS) | y << BITS | z
        };
        let mut order: Vec<(u64, u32)> = points.iter().map(key).zip(0..).collect();
        z_order::sort(&mut order);
        let mut columns = Vec::new();
        let mut first = 0;
        for column in order.chunk_by(|a, b| a.0 >> BITS == b.0 >> BITS) {
            let last = first + column.len() as u32;
            columns.push(Column { at: column[0].0 >> BITS, slots: first..last });
            first = last;
        }
        let slot = |&(number, index): &(u64, u32)| {
            let z = (number & ((1 << BITS) - 1)) as u32;
            Slot { at: (points[index as usize] - low).as_vec3(), z, index }
        };
        Self { reach_m, slots: order.iter().map(slot).collect(), columns }
    }

    /// What `of` makes of each point, given its index and all points nearer than the reach, itself among them, in no
    /// particular order.
    pub fn map<T: Copy + Default + Send>(
        &self,
        of: impl Fn(u32, &mut Vec<Near>) -> T + Sync,
        monitor: &dyn Monitor,
    ) -> Result<Vec<T>, Cancelled> {
        let parts: Vec<Vec<T>> = self
            .columns
            .par_chunks(COLUMNS_PER_CHECK)
            .map(|columns| {
                monitor.check()?;
                let (mut found, mut around, mut near) = (Vec::new(), Vec::new(), Vec::new());
                let mut next = [usize::MAX; ROWS];
                for column in columns {
                    self.columns_around(column, &mut next, &mut around);
                    for slot in &self.slots[column.slots.start as usize..column.slots.end as usize] {
                        self.near(slot, &mut around, &mut near);
                        found.push(of(slot.index, &mut near));
                    }
                }
                Ok(found)
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut by_index = vec![T::default(); self.slots.len()];
        for (slot, value) in self.slots.iter().zip(parts.iter().flatten()) {
            by_index[slot.index as usize] = *value;
        }
        Ok(by_index)
    }

    /// The slots of all columns that the reach may touch from one. `next` are the first of these in each row, as they were
    /// for a column before it.
    fn columns_around(&self, column: &Column, next: &mut [usize; ROWS], around: &mut Vec<Range<u32>>) {
        around.clear();
        for (row, next) in (0..).zip(next) {
            // Rows and columns before the first one stand in for those that are not there.
            let middle = (column.at + (row << BITS)).checked_sub(u64::from(REACH_CELLS) << BITS);
            let Some(middle) = middle else { continue };
            let (lowest, highest) =
                (middle.saturating_sub(u64::from(REACH_CELLS)), middle + u64::from(REACH_CELLS));
            if *next == usize::MAX {
                *next = self.columns.partition_point(|other| other.at < lowest);
            }
            while self.columns.get(*next).is_some_and(|other| other.at < lowest) {
                *next += 1;
            }
            let near = self.columns[*next..].iter().take_while(|other| other.at <= highest);
            around.extend(near.map(|other| other.slots.clone()));
        }
    }

    /// The points nearer to one than the reach. Slots that lie below it for good go from `around`: it is asked for one
    /// column's points in their order.
    fn near(&self, slot: &Slot, around: &mut [Range<u32>], near: &mut Vec<Near>) {
        near.clear();
        let limit = (self.reach_m * self.reach_m) as f32;
        let (lowest, highest) = (slot.z.saturating_sub(REACH_CELLS), slot.z.saturating_add(REACH_CELLS));
        for column in around {
            while column.start < column.end && self.slots[column.start as usize].z < lowest {
                column.start += 1;
            }
            for other in &self.slots[column.start as usize..column.end as usize] {
                if other.z > highest {
                    break;
                }
                let squared = other.at.distance_squared(slot.at);
                if squared < limit {
                    near.push(Near::new(squared, other.index));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// On a lattice of the cells' own width, so that many distances equal the reach, and anywhere.
    #[test]
    fn all_within_reach_are_what_a_look_at_all_finds() {
        for (count, lattice) in [(0, 1.0), (1, 1.0), (60, 0.25), (900, 0.25), (900, 1e-6)] {
            let coordinate = |key: Key| (key.unit() * 3.0 / lattice).floor() * lattice - 1.0;
            let point = |i| DVec3::from([0, 1, 2].map(|axis| coordinate(Key::new(7).child(i).child(axis))));
            let points: Vec<DVec3> = (0..count).map(point).collect();
            let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
            for reach_m in [0.25, 0.5, 0.71] {
                let sums = Cells::new(&points, reach_m).map(
                    |index, near| {
                        let mut found: Vec<u32> = near.iter().map(|near| near.index()).collect();
                        found.sort_unstable();
                        let away = |p: &DVec3| {
                            (*p - low).as_vec3().distance_squared((points[index as usize] - low).as_vec3())
                        };
                        let limit = (reach_m * reach_m) as f32;
                        let expected = (0..).zip(&points).filter(|(_, p)| away(p) < limit);
                        assert_eq!(found, expected.map(|(other, _)| other).collect::<Vec<u32>>());
                        assert!(
                            near.iter().all(|near| near.squared_m() == away(&points[near.index() as usize]))
                        );
                        near.len()
                    },
                    &Quiet,
                );
                let sums = sums.unwrap();
                assert!(sums.len() == points.len() && sums.iter().all(|&sum| sum > 0));
            }
        }
    }
}
