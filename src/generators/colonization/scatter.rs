//! Attraction points: where a crown wants branches.

use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::allocation::try_zeroed_vec;
use glam::DVec3;
use rayon::prelude::*;

use crate::crown::Crown;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_base::random::Key;

/// Points between two looks at the monitor: a millisecond or two in a mesh.
const CHUNK: usize = 512;

/// Why there are no points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
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
    // Memory that is not touched yet: its pages come as the points do, and Ctrl-C is heard.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crown::SHAPES;
    use linden_base::monitor::Quiet;

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
}
