//! Shade of many pyramids at once, level by level.
//!
//! A square of equal shade is four numbers in a table of differences (Crow 1984, *Summed-area tables for texture
//! mapping*, the other way round), whatever its size: what is added at a corner holds for all voxels behind it, and the
//! other corners end that. Summed along both axes the table is the shade.

use crate::shadow::{Change, Pyramid};

/// A level rectangle of voxels, whose differences become shade.
#[derive(Debug, Default)]
pub(crate) struct Plane {
    /// The least x and z.
    pub low: [i32; 2],
    /// Voxels along x and z.
    pub size: [usize; 2],
    /// Rows along z.
    cells: Vec<u32>,
}

impl Plane {
    /// The shade that nodes cast on the level `y`, none of them below it nor further above than the pyramid is deep.
    /// The rectangle begins and ends where bricks of an edge do.
    pub fn draw(&mut self, y: i32, changes: &[Change], pyramid: &Pyramid, edge: i32) {
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for change in changes {
            let (square, _) = pyramid.square(change.voxel, y);
            for axis in 0..2 {
                low[axis] = low[axis].min(square[axis][0]);
                high[axis] = high[axis].max(square[axis][1]);
            }
        }
        self.low = low.map(|low| low.div_euclid(edge) * edge);
        let along = |axis: usize| {
            let bricks = (high[axis] - self.low[axis]).div_euclid(edge) + 1;
            (bricks * edge) as usize
        };
        self.size = if changes.is_empty() { [0, 0] } else { [along(0), along(1)] };
        self.cells.clear();
        self.cells.resize(self.size[0] * self.size[1], 0);
        for change in changes {
            let ([[x0, x1], [z0, z1]], shade) = pyramid.square(change.voxel, y);
            let shade = if change.is_gone { shade.wrapping_neg() } else { shade };
            self.add(x0, z0, shade);
            self.add(x0, z1 + 1, shade.wrapping_neg());
            self.add(x1 + 1, z0, shade.wrapping_neg());
            self.add(x1 + 1, z1 + 1, shade);
        }
        self.sum();
    }

    /// A row along z.
    pub fn row(&self, x: usize) -> &[u32] {
        &self.cells[x * self.size[1]..(x + 1) * self.size[1]]
    }

    /// Adds to a difference; behind the last row or column there is nothing that it would hold for.
    fn add(&mut self, x: i32, z: i32, shade: u32) {
        let (x, z) = ((x - self.low[0]) as usize, (z - self.low[1]) as usize);
        if x < self.size[0] && z < self.size[1] {
            let cell = &mut self.cells[x * self.size[1] + z];
            *cell = cell.wrapping_add(shade);
        }
    }

    fn sum(&mut self) {
        let width = self.size[1];
        for x in 0..self.size[0] {
            let (before, rest) = self.cells.split_at_mut(x * width);
            let row = &mut rest[..width];
            let mut along = 0_u32;
            for cell in &mut *row {
                along = along.wrapping_add(*cell);
                *cell = along;
            }
            if x > 0 {
                for (cell, above) in row.iter_mut().zip(&before[(x - 1) * width..]) {
                    *cell = cell.wrapping_add(*above);
                }
            }
        }
    }
}
