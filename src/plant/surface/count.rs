//! How much each axis' tube will be, without making it.

use rayon::prelude::*;

use super::plan::{Course, Plan};
use super::target::Amount;
use super::{AXES_PER_TASK, Junction, SurfaceError, Tubes};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::Skeleton;

/// Vertices and triangles of each axis' tube, in the order of [`Skeleton::axes`]: exactly what
/// [`sweep`](super::sweep) writes, tube after tube.
///
/// # Errors
/// [`SurfaceError::Cancelled`], or [`SurfaceError::OneSolid`] for [`Junction::Watertight`].
pub fn count(skeleton: &Skeleton, tubes: &Tubes, monitor: &dyn Monitor) -> Result<Vec<Amount>, SurfaceError> {
    let tubes = &tubes.settled();
    if tubes.junction == Junction::Watertight {
        return Err(SurfaceError::OneSolid);
    }
    let course = Course::new(skeleton, tubes);
    let starts: Vec<usize> = (0..skeleton.axes.len()).step_by(AXES_PER_TASK).collect();
    let counted = starts
        .into_par_iter()
        .map(|start| {
            monitor.check()?;
            let axes = start..skeleton.axes.len().min(start + AXES_PER_TASK);
            Ok(axes.map(|axis| Plan::new(&course, axis..axis + 1).amount).collect())
        })
        .collect::<Result<Vec<Vec<Amount>>, Cancelled>>()?;
    Ok(counted.concat())
}

#[cfg(test)]
mod tests {
    use super::super::tests::gnarled;
    use super::*;
    use crate::surface::sweep;
    use linden_base::monitor::Quiet;

    #[test]
    fn the_counts_are_those_of_the_mesh() {
        for (seed, sides, rings) in [(1, 24, 1), (2, 3, 4), (3, 100, 2)] {
            let skeleton = gnarled(seed);
            let junction = if seed == 1 { Junction::Blend } else { Junction::Overlap };
            let tubes = Tubes { sides, rings, junction, ..Tubes::default() };
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            let counts = count(&skeleton, &tubes, &Quiet).unwrap();
            assert_eq!(counts.len(), skeleton.axes.len());
            assert_eq!(counts.iter().map(|tube| tube.vertices).sum::<usize>(), mesh.positions.len());
            assert_eq!(counts.iter().map(|tube| tube.triangles).sum::<usize>(), mesh.triangles.len());
            // A tube's triangles name its own vertices and no others.
            let (mut vertex, mut triangle) = (0, 0);
            for tube in counts {
                let range = vertex..vertex + tube.vertices;
                let triangles = &mesh.triangles[triangle..triangle + tube.triangles];
                assert!(triangles.iter().flatten().all(|&v| range.contains(&(v as usize))));
                (vertex, triangle) = (range.end, triangle + tube.triangles);
            }
        }
    }
}
