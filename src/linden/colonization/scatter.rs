//! Attraction points: where a crown wants branches.

use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::allocation::try_zeroed_vec;
use glam::DVec3;
use rayon::prelude::*;

use super::crown::Crown;
use crate::memory::{OverMemory, bytes_of};
use crate::monitor::{Cancelled, Monitor, Phase};
use crate::random::Key;

/// Points between two looks at the monitor: a millisecond or two in a mesh.
const CHUNK: usize = 512;

/// Why there are no points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScatterError {
    /// Nobody wants them any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// They would take more memory than there may be.
    #[error(transparent)]
    Over(#[from] OverMemory),
    /// There is no memory for them.
    #[error("scattering {count} points in the crown: no memory for {} MB; ask for fewer points", .count / 41_667)]
    Memory {
        /// How many were asked for.
        count: usize,
    },
}

/// Draws `count` points, uniform in the crown's volume; point `i` depends on `key.child(i)` alone,
/// so fewer points are a prefix of more, and any number of threads gives the same.
///
/// # Errors
/// [`ScatterError`]: cancelled, or more points than memory holds.
pub fn scatter(
    crown: &dyn Crown,
    count: usize,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Vec<DVec3>, ScatterError> {
    monitor.admit("scattering points in the crown", bytes_of::<DVec3>(count), "lower points")?;
    // Memory that nobody has touched yet: its pages come as the points do, and Ctrl-C is heard.
    let mut points: Vec<DVec3> = try_zeroed_vec(count).map_err(|()| ScatterError::Memory { count })?;
    let done = AtomicU64::new(0);
    points.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, points)| {
        monitor.check()?;
        let first = (chunk * CHUNK) as u64;
        for (i, point) in points.iter_mut().enumerate() {
            *point = crown.sample(key.child(first + i as u64));
        }
        let before = done.fetch_add(points.len() as u64, Ordering::Relaxed);
        monitor.advance(Phase::Scatter, before + points.len() as u64, Some(count as u64));
        Ok::<(), ScatterError>(())
    })?;
    Ok(points)
}

/// Moves each point by less than `amplitude_m`, uniformly in a ball; point `i` by `key.child(i)`.
///
/// Exact symmetry (a lattice, a mirrored model) makes pulls cancel and growth stall; a
/// thousandth of the points' spacing is enough against that and cannot be seen.
pub fn jitter(points: &mut [DVec3], amplitude_m: f64, key: Key) {
    points.par_iter_mut().enumerate().for_each(|(i, point)| {
        let key = key.child(i as u64);
        // Half of the cube lies in the ball: two attempts on average.
        let mut attempt = 0;
        let offset = loop {
            let key = key.child(attempt);
            let offset = DVec3::from([0, 1, 2].map(|axis| key.child(axis).between(-1.0, 1.0)));
            if offset.length_squared() < 1.0 {
                break offset;
            }
            attempt += 1;
        };
        *point += amplitude_m * offset;
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colonization::crown::SHAPES;
    use crate::monitor::Quiet;

    #[test]
    fn the_same_for_any_number_of_threads_and_a_prefix_of_more() {
        for shape in SHAPES {
            let crown = shape.of(&[]).unwrap();
            let draw = |threads: usize, count: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| scatter(crown.as_ref(), count, Key::new(9), &Quiet)).unwrap()
            };
            let (one, three, more) = (draw(1, 5000), draw(3, 5000), draw(2, 6000));
            let bits =
                |points: &[DVec3]| points.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
            assert_eq!(bits(&one), bits(&three), "{}", shape.id);
            assert_eq!(bits(&one), bits(&more[..5000]), "{}", shape.id);
            assert_ne!(one, scatter(crown.as_ref(), 5000, Key::new(10), &Quiet).unwrap());
        }
    }

    #[test]
    fn stops_when_cancelled_and_refuses_the_impossible() {
        struct Done;
        impl Monitor for Done {
            fn is_cancelled(&self) -> bool {
                true
            }
            fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
        }
        let crown = SHAPES[0].of(&[]).unwrap();
        let scatter_in = |count, monitor: &dyn Monitor| scatter(crown.as_ref(), count, Key::new(1), monitor);
        assert_eq!(scatter_in(100, &Done), Err(ScatterError::Cancelled(Cancelled)));
        assert_eq!(scatter_in(usize::MAX, &Quiet), Err(ScatterError::Memory { count: usize::MAX }));
        assert_eq!(scatter_in(0, &Quiet), Ok(Vec::new()));
    }

    #[test]
    fn jitter_moves_every_point_a_little_and_breaks_symmetry() {
        let lattice: Vec<DVec3> = (0..1000).map(|i| DVec3::new(f64::from(i), 2.0, 3.0)).collect();
        let mut moved = lattice.clone();
        jitter(&mut moved, 1e-3, Key::new(4));
        let far = lattice.iter().zip(&moved).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 1e-3 && far > 0.9e-3, "{far}");
        let mean: DVec3 = lattice.iter().zip(&moved).map(|(a, b)| *b - *a).sum::<DVec3>() / 1000.0;
        // The standard deviation of a coordinate in a unit ball is √(1/5), of the mean of 1000 √(1/5000).
        assert!(mean.length() < 5.0 * 1e-3 / 5000.0_f64.sqrt(), "{mean}");
        assert!(moved.iter().zip(&lattice).all(|(a, b)| a != b));
    }
}
