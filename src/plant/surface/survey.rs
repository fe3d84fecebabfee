//! Measures a surface without keeping it.

use super::plan::{Course, Plan, planned_bytes, planned_bytes_of};
use super::{
    ADVICE, DOING, Junction, Stretch, SurfaceError, Topology, Tubes, sweep, sweep_some, topology, tube,
};
use rayon::prelude::*;

use linden_base::mesh::Bounds;
use linden_base::monitor::Monitor;
use linden_base::topology::topology_bytes;
use linden_skeleton::Skeleton;

/// Measurements of the mesh that [`sweep`](super::sweep) gives for a skeleton.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Survey {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// The box around it; `None` for no axes.
    pub bounds: Option<Bounds>,
    /// Whether it is sound: the sum over its pieces, each some ten thousand nodes. No tube can close
    /// another's hole by lying on it, as long as the two are in different pieces.
    pub topology: Topology,
}

/// Vertices that are swept at once, a longer axis apart: their mesh, and the check of it, takes some tens
/// of megabytes.
const VERTICES_PER_PIECE: usize = 1 << 19;
/// Nodes whose tubes are these, if all are as thick as the trunk; few enough to be worth a task for each
/// thread.
const NODES_PER_PIECE: [usize; 2] = [1 << 10, 1 << 16];

/// Sweeps and checks the tubes of all axes a few at a time, so that trees can be measured whose mesh
/// would not fit the memory.
///
/// Visits the stretches of all tubes in the order of [`Skeleton::axes`], each from base to apex: what the mesh
/// holds. A lateral begins on its parent's centre line. With [`Junction::Watertight`] it is the
/// tubes that are made one solid, without their collars. Surface roots are in the mesh and not among them.
///
/// # Errors
/// [`SurfaceError::Cancelled`], or memory. A mesh of any size can be surveyed.
pub fn survey(
    skeleton: &Skeleton,
    tubes: &Tubes,
    visit: &mut dyn FnMut(Stretch),
    monitor: &dyn Monitor,
) -> Result<Survey, SurfaceError> {
    let tubes = &tubes.settled();
    let course = Course::new(skeleton, tubes);
    if tubes.junction == Junction::Watertight {
        // There is no part of a solid, and no solid that is not kept whole on the way.
        let mesh = sweep(skeleton, tubes, monitor)?;
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        let topology = topology(&mesh, monitor)?;
        let bounds = mesh.bounds();
        drop(mesh);
        monitor.admit(DOING, planned_bytes(skeleton, tubes), ADVICE)?;
        let plan = Plan::new(&course, 0..skeleton.axes.len());
        for (rings, form) in plan.axes().filter(|(_, form)| form.root.is_none()) {
            tube::stretches(rings, form, &course.roundness, 0.0).for_each(&mut *visit);
        }
        return Ok(Survey { vertices, triangles, bounds, topology });
    }
    let mut whole = Survey::default();
    let around = tubes.rings.max(1) as usize * tubes.sides.max(1) as usize;
    let most = (VERTICES_PER_PIECE / around).clamp(NODES_PER_PIECE[0], NODES_PER_PIECE[1]);
    let mut first = 0;
    // One after the other, each by all threads: pieces beside each other would pile up.
    while first < skeleton.axes.len() {
        let (mut end, mut nodes) = (first, 0);
        for axis in &skeleton.axes[first..] {
            if end > first && nodes + axis.len as usize > most {
                break;
            }
            nodes += axis.len as usize;
            end += 1;
        }
        monitor.admit(DOING, planned_bytes_of(nodes, &skeleton.axes[first..end], tubes), ADVICE)?;
        let (mesh, swept) = sweep_some(&course, first..end, monitor)?;
        let stretches: Vec<Vec<Stretch>> = swept.par_iter().map(|swept| swept.stretches(&course)).collect();
        drop(swept);
        stretches.into_iter().flatten().for_each(&mut *visit);
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        let bytes = mesh.bytes() + topology_bytes(vertices, triangles);
        monitor.admit("measuring the surface", bytes, ADVICE)?;
        whole = whole.and(Survey {
            vertices,
            triangles,
            bounds: mesh.bounds(),
            topology: topology(&mesh, monitor)?,
        });
        first = end;
    }
    Ok(whole)
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
    use linden_base::monitor::Quiet;

    #[test]
    fn a_survey_says_what_the_mesh_is() {
        for (seed, sides, rings) in [(1, 24, 1), (2, 3, 4), (3, 100, 2)] {
            let skeleton = gnarled(seed);
            let tubes = Tubes { sides, rings, ..Tubes::default() };
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            let survey = survey(&skeleton, &tubes, &mut |_| (), &Quiet).unwrap();
            assert_eq!((survey.vertices, survey.triangles), (mesh.positions.len(), mesh.triangles.len()));
            assert_eq!(survey.bounds, mesh.bounds());
            assert_eq!(survey.topology, topology(&mesh, &Quiet).unwrap());
        }
    }
}
