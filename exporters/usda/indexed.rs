//! Values that repeat, each once.

use glam::Vec2;
use rayon::prelude::*;

/// The different values in the order of their first use, and for each of `values` which one it is;
/// `None` where no value repeats.
pub(super) fn indexed(values: &[Vec2]) -> Option<(Vec<Vec2>, Vec<u32>)> {
    // `+ 0.0` makes the two zeros one.
    let bits = |x: f32| u64::from((x + 0.0).to_bits());
    let mut sorted: Vec<(u64, u32)> = values
        .par_iter()
        .zip(0u32..values.len() as u32)
        .map(|(v, i)| (bits(v.x) << 32 | bits(v.y), i))
        .collect();
    sorted.par_sort_unstable();
    // Each value's first use; equal ones stand together, the first use first.
    let mut first_use = vec![0; values.len()];
    let runs = sorted.chunk_by(|a, b| a.0 == b.0);
    let mut different = 0;
    for run in runs {
        different += 1;
        for &(_, i) in run {
            first_use[i as usize] = run[0].1;
        }
    }
    if different == values.len() {
        return None;
    }
    let mut once = Vec::with_capacity(different);
    let mut indices = first_use;
    for i in 0..values.len() {
        // What comes before `i` has its final number already.
        let first = indices[i] as usize;
        indices[i] = if first == i {
            once.push(values[i]);
            once.len() as u32 - 1
        } else {
            indices[first]
        };
    }
    Some((once, indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_lead_to_the_values_and_no_value_is_twice() {
        let grid: Vec<_> =
            (0u16..200).map(|i| Vec2::new(f32::from(i * 7 % 5), f32::from(i % 3) - 1.0)).collect();
        let (once, indices) = indexed(&grid).unwrap();
        assert_eq!(once.len(), 15);
        assert!(indices.iter().zip(&grid).all(|(&index, value)| once[index as usize] == *value));
        assert_eq!(indices[..3], [0, 1, 2], "in the order of first use");
    }

    #[test]
    fn the_two_zeros_are_one() {
        assert_eq!(indexed(&[Vec2::new(0.0, 1.0), Vec2::new(-0.0, 1.0)]).unwrap().1, [0, 0]);
    }

    #[test]
    fn different_values_need_no_indices() {
        assert!(indexed(&[Vec2::ZERO, Vec2::X, Vec2::Y]).is_none());
        assert!(indexed(&[]).is_none());
    }
}
