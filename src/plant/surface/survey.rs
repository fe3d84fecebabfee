//! Measures a surface without keeping it.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::path::Ring;
use super::plain::{Found, PlainTubes};
use super::plan::{Course, Plan, planned_bytes, planned_bytes_of};
use super::target::{Amount, Target};
use super::tube_form::TubeForm;
use super::{
    ADVICE, AXES_PER_TASK, DOING, Junction, Stretch, SurfaceError, Topology, Tubes, sweep, topology, tube,
};
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::{Monitor, Phase};
use linden_base::topology::{Proofs, SurfaceRef};
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
    /// Whether it is sound: the sum over its tubes. No tube closes another's hole by lying on it.
    pub topology: Topology,
}

/// Vertices that are swept between two looks at their stretches, a longer axis apart.
const VERTICES_PER_PIECE: usize = 1 << 19;
/// Nodes whose tubes are these, if all are as thick as the trunk; few enough to be worth a task for each
/// thread.
const NODES_PER_PIECE: [usize; 2] = [1 << 10, 1 << 16];

/// Sweeps and checks the tubes of all axes one by one, so that trees can be measured whose mesh would not fit the
/// memory.
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
    visit: &mut (dyn FnMut(Stretch) + Send),
    monitor: &dyn Monitor,
) -> Result<Survey, SurfaceError> {
    survey_by(skeleton, tubes, &|stretch| stretch, visit, monitor)
}

/// As [`survey`], where what is visited is what `note` makes of each stretch, in any order and on any thread.
///
/// # Errors
/// As [`survey`].
pub fn survey_by<T: Send>(
    skeleton: &Skeleton,
    tubes: &Tubes,
    note: &(impl Fn(Stretch) -> T + Sync),
    visit: &mut (impl FnMut(T) + Send + ?Sized),
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
            tube::stretches(rings, form, &course.roundness, 0.0).map(note).for_each(&mut *visit);
        }
        return Ok(Survey { vertices, triangles, bounds, topology });
    }
    let surveyor = Surveyor { course, benches: Mutex::default(), done: AtomicU64::new(0), monitor };
    let mut whole = Survey::default();
    let around = tubes.rings.max(1) as usize * tubes.sides.max(1) as usize;
    let most = (VERTICES_PER_PIECE / around).clamp(NODES_PER_PIECE[0], NODES_PER_PIECE[1]);
    let mut first = 0;
    let mut seen: Vec<Vec<T>> = Vec::new();
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
        let planned = planned_bytes_of(skeleton, &skeleton.axes[first..end], tubes, surveyor.course.fineness);
        monitor.admit(DOING, planned, ADVICE)?;
        // Stretches are visited in their order, which is one thread's work, beside the next piece.
        let visited = || seen.into_iter().flatten().for_each(&mut *visit);
        let (piece, ()) = rayon::join(|| surveyor.piece(first..end, planned, note), visited);
        let (survey, stretches) = piece?;
        whole = whole.and(survey);
        seen = stretches;
        first = end;
    }
    seen.into_iter().flatten().for_each(visit);
    Ok(whole)
}

/// Sweeps tubes to look at them.
struct Surveyor<'a> {
    course: Course<'a>,
    /// Those that no thread works at.
    benches: Mutex<Vec<Bench>>,
    done: AtomicU64,
    monitor: &'a dyn Monitor,
}

/// What one thread measures with: memory for a tube at a time, which stays in its cache, and what it has proved.
#[derive(Default)]
struct Bench {
    mesh: Mesh,
    proofs: Proofs,
    plain: PlainTubes,
}

impl Surveyor<'_> {
    /// Some axes and their stretches, by all threads.
    fn piece<T: Send>(
        &self,
        axes: Range<usize>,
        planned: u64,
        note: &(impl Fn(Stretch) -> T + Sync),
    ) -> Result<(Survey, Vec<Vec<T>>), SurfaceError> {
        let starts: Vec<usize> = axes.clone().step_by(AXES_PER_TASK).collect();
        let measured = starts.into_par_iter().map(|start| {
            self.monitor.check()?;
            let mut bench = self.benches().pop().unwrap_or_default();
            let axes = start..axes.end.min(start + AXES_PER_TASK);
            let measured = self.task(axes, planned, &mut bench, note);
            self.benches().push(bench);
            measured
        });
        let measured = measured.collect::<Result<Vec<_>, SurfaceError>>()?;
        let whole = measured.iter().fold(Survey::default(), |whole, (survey, _)| whole.and(*survey));
        Ok((whole, measured.into_iter().map(|(_, stretches)| stretches).collect()))
    }

    fn benches(&self) -> MutexGuard<'_, Vec<Bench>> {
        self.benches.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Some axes and their stretches, by one thread.
    fn task<T>(
        &self,
        axes: Range<usize>,
        planned: u64,
        bench: &mut Bench,
        note: &impl Fn(Stretch) -> T,
    ) -> Result<(Survey, Vec<T>), SurfaceError> {
        let Self { course, monitor, .. } = self;
        let plan = Plan::new(course, axes);
        let Amount { vertices, triangles, .. } = plan.amount;
        let bytes = Mesh::bytes_for(vertices, triangles) + Proofs::bytes_for(vertices, triangles);
        let beside = bytes.saturating_mul(rayon::current_num_threads() as u64);
        monitor.admit("measuring the surface", planned.saturating_add(beside), ADVICE)?;
        bench.make_room(vertices, triangles);
        let mut survey = Survey::default();
        let mut stretches = Vec::with_capacity(plan.rings() + plan.len());
        for (rings, form) in plan.axes() {
            let (measured, ease) = bench.measure(rings, form, course, *monitor)?;
            survey = survey.and(measured);
            if form.root.is_none() {
                tube::stretches(rings, form, &course.roundness, ease)
                    .for_each(|stretch| stretches.push(note(stretch)));
            }
        }
        let swept = plan.len() as u64;
        let before = self.done.fetch_add(swept, Ordering::Relaxed);
        monitor.advance(Phase::Sweep, before + swept, Some(course.skeleton.axes.len() as u64));
        Ok((survey, stretches))
    }
}

impl Bench {
    fn make_room(&mut self, vertices: usize, triangles: usize) {
        if self.mesh.positions.len() < vertices || self.mesh.triangles.len() < triangles {
            let [vertices, triangles] =
                [vertices.max(self.mesh.positions.len()), triangles.max(self.mesh.triangles.len())];
            // Not both at once.
            self.mesh = Mesh::default();
            self.mesh = Mesh::zeroed(vertices, triangles);
        }
    }

    /// All of the memory, to be written from its beginning.
    fn target(&mut self) -> Target<'_> {
        let Mesh { positions, normals, uvs, triangles } = &mut self.mesh;
        Target { positions, normals, uvs, triangles, first: 0, done: Amount::default() }
    }

    /// A tube, and the ease that folded nothing.
    fn measure(
        &mut self,
        rings: &[Ring],
        form: &TubeForm,
        course: &Course<'_>,
        monitor: &dyn Monitor,
    ) -> Result<(Survey, f32), SurfaceError> {
        let (roundness, tile_m) = (&course.roundness, course.tubes.bark_tile_m);
        let looked = match self.plain.look(rings, form, roundness, tile_m) {
            Found::Sound(survey) => return Ok((survey, tube::UNFOLDED)),
            Found::New(survey) => Some(survey),
            Found::Unknown => None,
        };
        let mut target = self.target();
        let ease = tube::sweep(rings, form, roundness, tile_m, &mut target);
        let amount = target.done;
        let measured = self.measure_swept(amount, monitor)?;
        if let Some(looked) = looked {
            self.plain.learn(&looked, &measured);
        }
        Ok((measured, ease))
    }

    /// The tube that was written, this much.
    fn measure_swept(&mut self, amount: Amount, monitor: &dyn Monitor) -> Result<Survey, SurfaceError> {
        let Amount { vertices, triangles, .. } = amount;
        let surface = SurfaceRef {
            positions: &self.mesh.positions[..vertices],
            normals: &self.mesh.normals[..vertices],
            uvs: &self.mesh.uvs[..vertices],
            triangles: &self.mesh.triangles[..triangles],
        };
        let topology = self.proofs.topology(surface, monitor)?;
        let bounds = Bounds::of(surface.positions.iter().copied());
        Ok(Survey { vertices, triangles, bounds, topology })
    }
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
