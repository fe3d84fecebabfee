//! The skin of the wood: one closed tube per axis.
//!
//! An axis becomes a sequence of stations, smooth (`curve`) and with what makes it wood (`features`,
//! `collar`), then of rings in parallel transport frames (`path`); neighbouring rings are joined
//! (`tube`), both ends are closed (`ends`). A lateral starts on its parent's centre line, inside the
//! parent's tube; on request all wood is one solid (`solid`). Spends none of the seed; the mesh is
//! bit-identical for any number of threads.

mod collar;
mod count;
mod curve;
mod ends;
mod features;
mod path;
mod plain;
mod plan;
pub mod relief;
mod roots;
mod solid;
mod spread;
mod stretch;
mod stubs;
mod survey;
mod target;
mod thickness;
mod tube;
mod tube_form;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use self::plan::{Course, Plan};
use self::target::Target;
use linden_base::memory::OverMemory;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_skeleton::Skeleton;

pub use count::count;
pub use features::{COLLAR_RADII, Ends, FLARE_RADII, Features};
pub use linden_base::topology::{Topology, crowded_edges, topology};
pub(crate) use plan::bends;
pub use roots::SurfaceRoots;
pub use solid::MOST_SOLID_TRIANGLES;
pub use stretch::Stretch;
pub use stubs::Stubs;
pub use survey::{Survey, survey, survey_by};
pub use target::Amount;
pub(crate) use thickness::classes;

/// How the skin is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tubes {
    /// Sides of the thickest ring; thinner ones have fewer, down to 3, with the same relative
    /// deviation from a circle. 3 to 128.
    pub sides: u32,
    /// The fewest sides of a stem where it is at least [`STOUT`] times as thick as at its foot; 0: as its thickness asks
    /// for.
    pub stem_sides: u32,
    /// Rings per segment, at least 1: with more, the tube follows a smooth curve through the nodes.
    pub rings: u32,
    /// Wood of at least this share of the thickest radius has as many rings as its curve needs, so that it has no
    /// corners; 0: none has.
    pub smooth_wood: f32,
    /// Length, in radii, over which a change of the radius is spread, above zero or 0 for none: the pipe
    /// model's steps end all at once above a fork, those of wood do not.
    pub width_smoothing: f32,
    /// Edge of the square of bark that the picture shows, metres.
    pub bark_tile_m: f32,
    /// Features that are added to the bare tubes.
    pub features: Features,
    /// How tubes meet.
    pub junction: Junction,
    /// For [`Junction::Watertight`]: cells of the lattice across the thickest wood, 4 to 512. Wood
    /// thinner than two cells is made as thick.
    pub junction_detail: u32,
}

linden_base::words! {
    /// How tubes meet.
    #[derive(Default)]
    Junction {
        /// Each is closed, and a lateral starts within its parent.
        #[default]
        Overlap = "overlap",
        /// The same with collars: of [`BLEND_COLLAR`] where [`Features::collar`] is 0.
        Blend = "blend",
        /// All are one solid: closed, without edges of more than two triangles, nothing inside.
        Watertight = "watertight",
    }
}

/// From this share of its thickness at the foot on a stem has [`Tubes::stem_sides`]: what people stand beside.
pub const STOUT: f32 = 0.45;

/// The collar of [`Junction::Blend`], where the settings have none.
pub const BLEND_COLLAR: f32 = 0.6;

impl Tubes {
    /// With what the junction asks for.
    fn settled(&self) -> Self {
        let mut tubes = *self;
        if tubes.junction == Junction::Blend && tubes.features.collar == 0.0 {
            tubes.features.collar = BLEND_COLLAR;
        }
        tubes
    }

    /// Between which heights over the foot a stem's bark changes from that of the foot to its own, in tiles of bark, where
    /// the foot has its own: stems that stand on the ground have a ring at each. What is lower than half a tile is nothing, and a
    /// solid has one bark.
    pub fn foot_edge(&self) -> Option<[u32; 2]> {
        let tiles = libm::roundf(self.features.foot_height_m / self.bark_tile_m) as u32;
        let is_parted = tiles > 0 && self.junction != Junction::Watertight;
        is_parted.then_some([tiles.saturating_sub(FOOT_EDGE_TILES), tiles])
    }
}

/// Over how many tiles of bark that of the foot ends, at most.
const FOOT_EDGE_TILES: u32 = 2;

impl Default for Tubes {
    fn default() -> Self {
        Self {
            sides: 24,
            stem_sides: 0,
            rings: 1,
            smooth_wood: 0.0,
            width_smoothing: 2.0,
            bark_tile_m: 0.5,
            features: Features::default(),
            junction: Junction::Overlap,
            junction_detail: 32,
        }
    }
}

/// Why there is no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// More vertices than an index of 32 bits can name.
    #[error(
        "the surface would have {vertices} vertices, more than the 4294967294 that mesh formats can index; grow a smaller tree or lower the knobs 'sides' and 'rings'"
    )]
    TooLarge {
        /// How many there would be.
        vertices: usize,
    },
    /// A solid would take too long.
    #[error(
        "junction=watertight would make about {triangles} triangles, more than {limit}; lower junction_detail, grow a smaller tree, or use junction=blend"
    )]
    TooFine {
        /// About how many there would be.
        triangles: u64,
        /// [`MOST_SOLID_TRIANGLES`].
        limit: usize,
    },
    /// Somebody asked for the tubes of a solid.
    #[error(
        "junction=watertight makes one surface of all wood, without axes that could be thinned out to a budget or moved by wind one by one; use junction=blend for these"
    )]
    OneSolid,
    /// The solid does not hold in single precision.
    #[error(
        "the solid would not be watertight ({edges} edges and {triangles} triangles fail the check); lower junction_detail, or use junction=blend"
    )]
    NotWatertight {
        /// Edges that are open or have more than two triangles.
        edges: usize,
        /// Triangles without area.
        triangles: usize,
    },
}

/// For messages about memory.
const DOING: &str = "sweeping the surface";
const ADVICE: &str = "lower sides or grow a smaller tree";

/// Axes that one task sweeps: enough to amortise it, few enough to share the work and to cancel.
const AXES_PER_TASK: usize = 128;

/// Sweeps the tubes of all axes.
///
/// Texture coordinates: U runs round the girth in whole pictures (below one picture in halves of
/// it, 1/2, 1/4 …), V is the arc length divided by [`Tubes::bark_tile_m`], so that the density of
/// texels stays near one picture per tile on thick and thin wood alike.
///
/// # Errors
/// [`SurfaceError`]: cancelled, more vertices than 32-bit indices can name, too much memory, or too fine a
/// solid.
pub fn sweep(skeleton: &Skeleton, tubes: &Tubes, monitor: &dyn Monitor) -> Result<Mesh, SurfaceError> {
    let tubes = &tubes.settled();
    monitor.admit(DOING, plan::planned_bytes(skeleton, tubes), ADVICE)?;
    let course = Course::new(skeleton, tubes);
    match tubes.junction {
        Junction::Watertight => solid::solidify(&course, monitor),
        Junction::Overlap | Junction::Blend => sweep_all(&course, monitor),
    }
}

/// Sweeps the tubes of all axes into one mesh.
fn sweep_all(course: &Course<'_>, monitor: &dyn Monitor) -> Result<Mesh, SurfaceError> {
    let all = course.skeleton.axes.len();
    let tile_m = course.tubes.bark_tile_m;
    let starts: Vec<usize> = (0..all).step_by(AXES_PER_TASK).collect();
    let plans = starts
        .into_par_iter()
        .map(|start| {
            monitor.check()?;
            Ok(Plan::new(course, start..all.min(start + AXES_PER_TASK)))
        })
        .collect::<Result<Vec<Plan>, Cancelled>>()?;

    let vertices: usize = plans.iter().map(|plan| plan.amount.vertices).sum();
    let triangles = plans.iter().map(|plan| plan.amount.triangles).sum();
    // The largest index is left out: glTF reserves it.
    if vertices >= u32::MAX as usize {
        return Err(SurfaceError::TooLarge { vertices });
    }
    let planned: u64 = plans.iter().map(Plan::bytes).sum();
    monitor.admit(DOING, planned + Mesh::bytes_for(vertices, triangles), ADVICE)?;
    let mut mesh = Mesh::zeroed(vertices, triangles);
    let done = AtomicU64::new(0);
    slices(&mut mesh, &plans).into_par_iter().zip(plans).try_for_each(|(mut target, plan)| {
        monitor.check()?;
        for (rings, form) in plan.axes() {
            tube::sweep(rings, form, &course.roundness, tile_m, &mut target);
        }
        let swept = plan.len() as u64;
        let before = done.fetch_add(swept, Ordering::Relaxed);
        monitor.advance(Phase::Sweep, before + swept, Some(all as u64));
        Ok::<(), Cancelled>(())
    })?;
    Ok(mesh)
}

/// Cuts the mesh into the slices that each plan fills, in order.
fn slices<'a>(mesh: &'a mut Mesh, plans: &[Plan]) -> Vec<Target<'a>> {
    let Mesh { positions, normals, uvs, triangles } = mesh;
    let mut rest = (&mut positions[..], &mut normals[..], &mut uvs[..], &mut triangles[..]);
    let mut first = 0;
    plans
        .iter()
        .map(|plan| {
            let Amount { vertices, triangles, .. } = plan.amount;
            let (positions, p) = std::mem::take(&mut rest.0).split_at_mut(vertices);
            let (normals, n) = std::mem::take(&mut rest.1).split_at_mut(vertices);
            let (uvs, u) = std::mem::take(&mut rest.2).split_at_mut(vertices);
            let (triangles, t) = std::mem::take(&mut rest.3).split_at_mut(triangles);
            rest = (p, n, u, t);
            let target = Target { positions, normals, uvs, triangles, first, done: Amount::default() };
            first += vertices as u32;
            target
        })
        .collect()
}

#[cfg(test)]
mod features_tests;

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::{DVec3, Vec3};

    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::{Branching, NO_PARENT, Wood};

    pub(super) fn tree(positions: Vec<Vec3>, parents: Vec<u32>, wood: &Wood) -> Skeleton {
        let births = vec![0; positions.len()];
        Skeleton::build(Branching { positions, parents, births, radii: None, edges: None }, wood).unwrap()
    }

    pub(super) fn volume(mesh: &Mesh) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
    }

    #[test]
    fn a_pole_is_the_prism_that_geometry_says() {
        let wood = Wood { tip_radius_m: Some(0.1), ..Wood::default() };
        let pole = tree(vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 4.0], vec![NO_PARENT, 0, 1], &wood);
        let mesh = sweep(&pole, &Tubes { sides: 16, bark_tile_m: 0.25, ..Tubes::default() }, &Quiet).unwrap();
        // The polygons have the circle's area; the bud is a pyramid, one radius high.
        assert!((volume(&mesh) - PI * 0.1 * 0.1 * (4.0 + 0.1 / 3.0)).abs() < 1e-6);
        // Bands of 2 × 16 over two segments, the tip's 16, the base's 14.
        assert_eq!(mesh.triangles.len(), 2 * 2 * 16 + 16 + 14);
        assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default());
    }

    /// Random walks that branch, with thick wood on short steps: everything that folds a tube.
    pub(super) fn gnarled(seed: u64) -> Skeleton {
        let key = Key::new(seed);
        let mut positions = vec![Vec3::ZERO];
        let mut parents = vec![NO_PARENT];
        for i in 1..400_u32 {
            let k = key.child(u64::from(i));
            let parent =
                if k.child(0).unit() < 0.8 { i - 1 } else { (k.child(1).unit() * f64::from(i)) as u32 };
            let component = |j| k.child(j).between(-1.0, 1.0) as f32;
            let step = Vec3::new(component(2), component(3) + 0.5, component(4)) * 0.1;
            positions.push(positions[parent as usize] + step);
            parents.push(parent);
        }
        tree(positions, parents, &Wood { tip_radius_m: Some(0.01), ..Wood::default() })
    }

    #[test]
    fn gnarled_wood_stays_closed_and_unfolded() {
        for seed in 0..400 {
            let skeleton = gnarled(seed);
            let mesh = sweep(&skeleton, &Tubes::default(), &Quiet).unwrap();
            assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default(), "seed {seed}");
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
            assert!(volume(&mesh) > 0.0);
        }
    }

    #[test]
    fn more_rings_stay_closed_and_a_pole_stays_a_pole() {
        for seed in 0..60 {
            for rings in [2, 5] {
                let mesh = sweep(&gnarled(seed), &Tubes { rings, ..Tubes::default() }, &Quiet).unwrap();
                assert_eq!(topology(&mesh, &Quiet).unwrap(), Topology::default(), "seed {seed}, {rings}");
            }
        }
        let wood = Wood { tip_radius_m: Some(0.1), ..Wood::default() };
        let pole = tree(vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 4.0], vec![NO_PARENT, 0, 1], &wood);
        let with = |rings| sweep(&pole, &Tubes { sides: 16, rings, ..Tubes::default() }, &Quiet).unwrap();
        // Two segments of three bands of 2 × 16, the tip's 16, the base's 14.
        assert_eq!(with(3).triangles.len(), 6 * 2 * 16 + 16 + 14);
        assert!((volume(&with(3)) - volume(&with(1))).abs() < 1e-5);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_mesh() {
        let skeleton = gnarled(3);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sweep(&skeleton, &Tubes::default(), &Quiet).unwrap())
        };
        assert_eq!(on(1), on(3));
    }

    /// Density of the picture along both directions, from each triangle's own geometry.
    #[test]
    fn texels_are_near_square_and_equally_dense_on_thick_and_thin_wood() {
        // A cone-like stem from 40 cm to 4 mm, thinner by a few hundredths with each segment.
        let mut positions = vec![Vec3::ZERO];
        let mut parents = vec![NO_PARENT];
        for i in 1..=40_u32 {
            positions.push(Vec3::Y * (0.5 * i as f32));
            parents.push(i - 1);
        }
        for at in 0..40_u32 {
            for _ in 0..(40 - at) * (40 - at) / 4 {
                positions.push(positions[at as usize] + Vec3::new(1.0, 0.3, 0.0));
                parents.push(at);
            }
        }
        let skeleton = tree(positions, parents, &Wood { base_radius_m: Some(0.4), ..Wood::default() });
        let tile = 0.5;
        let mesh =
            sweep(&skeleton, &Tubes { sides: 24, bark_tile_m: tile, ..Tubes::default() }, &Quiet).unwrap();
        let (mut checked, mut areas, mut pictures) = (0, 0.0, 0.0);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
            let [ta, tb, tc] = t.map(|i| mesh.uvs[i as usize].as_dvec2());
            let area = (b - a).cross(c - a).length();
            let flat = (tb - ta).perp_dot(tc - ta).abs();
            // The gradient of V over the triangle: pictures per metre along the axis.
            let along = ((c - a) * (tb - ta).y - (b - a) * (tc - ta).y).length() / area;
            let density = flat / area * f64::from(tile) * f64::from(tile);
            // A single triangle may deviate where a segment tapers to half, the whole may not.
            assert!((0.5..2.0).contains(&density), "{density} pictures per tile");
            areas += area;
            pictures += area * density;
            let is_side = mesh.normals[t[0] as usize].as_dvec3().dot(DVec3::Y).abs() < 0.5;
            if is_side && mesh.positions[t[0] as usize].x.abs() < 0.5 {
                assert!((0.7..1.3).contains(&(along * f64::from(tile))), "{along} along");
                checked += 1;
            }
        }
        assert!(checked > 500);
        assert!((0.8..1.25).contains(&(pictures / areas)), "{} pictures per tile", pictures / areas);
    }
}
