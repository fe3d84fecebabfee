//! Measures a surface without keeping it.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::{Plan, Roundness, SurfaceError, Topology, Tubes, slices, topology, tube};
use crate::monitor::{Monitor, Stage};
use crate::scene::{Bounds, Mesh};
use crate::skeleton::Skeleton;

/// What [`sweep`](super::sweep) gives for a skeleton.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Survey {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// The box around it; `None` for no axes.
    pub bounds: Option<Bounds>,
    /// Whether it is sound: the sum over its pieces, each a few thousand axes. No tube can close
    /// another's hole by lying on it, as long as the two are in different pieces.
    pub topology: Topology,
}

/// Axes that are swept at once: what their mesh takes, and the check of it, fits a few megabytes.
const AXES_PER_PIECE: usize = 2048;

/// Sweeps and checks the tubes of all axes a few at a time, so that trees can be measured whose mesh
/// would not fit the memory.
///
/// # Errors
/// [`SurfaceError::Cancelled`]. A mesh of any size can be surveyed.
pub fn survey(skeleton: &Skeleton, tubes: &Tubes, monitor: &dyn Monitor) -> Result<Survey, SurfaceError> {
    let roundness = Roundness::new(tubes.sides, skeleton.radii.iter().copied().fold(0.0, f32::max));
    let &Tubes { rings, bark_tile_m: tile_m, .. } = tubes;
    let done = AtomicU64::new(0);
    let pieces = skeleton.axes.par_chunks(AXES_PER_PIECE).map(|axes| {
        monitor.check()?;
        let plan = Plan::new(skeleton, axes, rings, &roundness, tile_m);
        let mut mesh = Mesh::zeroed(plan.amount.vertices, plan.amount.triangles);
        for mut target in slices(&mut mesh, std::slice::from_ref(&plan)) {
            let mut first = 0;
            for &end in &plan.ends {
                tube::sweep(&plan.rings[first..end], &roundness, tile_m, &mut target);
                first = end;
            }
        }
        let before = done.fetch_add(axes.len() as u64, Ordering::Relaxed);
        monitor.advance(Stage::Sweep, before + axes.len() as u64, Some(skeleton.axes.len() as u64));
        Ok(Survey {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            bounds: mesh.bounds(),
            topology: topology(&mesh, monitor)?,
        })
    });
    pieces.try_reduce(Survey::default, |a, b| Ok(a.and(b)))
}

impl Survey {
    fn and(self, other: Self) -> Self {
        let bounds = match (self.bounds, other.bounds) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        Self {
            vertices: self.vertices + other.vertices,
            triangles: self.triangles + other.triangles,
            bounds,
            topology: self.topology.and(other.topology),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::gnarled;
    use super::*;
    use crate::Quiet;
    use crate::surface::sweep;

    #[test]
    fn a_survey_says_what_the_mesh_is() {
        for (seed, sides, rings) in [(1, 24, 1), (2, 3, 4), (3, 100, 2)] {
            let skeleton = gnarled(seed);
            let tubes = Tubes { sides, rings, ..Tubes::default() };
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            let survey = survey(&skeleton, &tubes, &Quiet).unwrap();
            assert_eq!((survey.vertices, survey.triangles), (mesh.positions.len(), mesh.triangles.len()));
            assert_eq!(survey.bounds, mesh.bounds());
            assert_eq!(survey.topology, topology(&mesh, &Quiet).unwrap());
        }
    }
}
