//! The Z-order of cells in a grid (Morton 1966): those near each other in space are mostly near each other in it.

use glam::DVec3;
use rayon::prelude::*;

/// Bits of each coordinate.
pub(super) const BITS: u32 = 21;

/// Cells in a row at most.
pub(super) const MOST: f64 = ((1 << BITS) - 1) as f64;

/// The number of the cell that a place lies in, in cells from the grid's corner: 0 to [`MOST`] along each axis.
pub(super) fn number(place: DVec3) -> u64 {
    let [x, y, z] = place.to_array().map(|cell| spread(cell as u64));
    x | y << 1 | z << 2
}

/// Sorts numbered points, each of which has an index of its own.
pub(super) fn sort(order: &mut [(u64, u32)]) {
    // Alone the sort of the standard library is the faster one.
    if rayon::current_num_threads() == 1 {
        order.sort_unstable();
    } else {
        order.par_sort_unstable();
    }
}

/// The bits of a coordinate, two free ones behind each.
fn spread(x: u64) -> u64 {
    let mut x = x & ((1 << BITS) - 1);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_of_the_three_coordinates_take_turns() {
        let cell = [0b1_0000_0000_0000_1011_0110_u64, 0b0_1100_0000_1000_0000_0001, (1 << BITS) - 1];
        let cell = cell.map(|x| x & ((1 << BITS) - 1));
        let expected = (0..BITS).fold(0_u64, |all, bit| {
            (0..3).fold(all, |all, axis| all | ((cell[axis] >> bit & 1) << (3 * bit + axis as u32)))
        });
        assert_eq!(number(DVec3::from(cell.map(|x| x as f64 + 0.5))), expected);
        assert_eq!(number(DVec3::splat(MOST)), (1 << (3 * BITS)) - 1);
    }
}
