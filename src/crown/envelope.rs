//! A crown envelope: the inside of any triangle mesh.
//!
//! Inside is where the generalized winding number is at least a half, either way round: for a closed mesh
//! its interior, also where the mesh is inside out or cut into parts, and without the cavities
//! that inner parts of opposite orientation make; for a mesh with holes the space that the surface
//! surrounds at least by half.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::entry::{Entry, entry};
use super::shells::{Shell, shells};
use super::skin::Skin;
use super::topology::Surface;
use super::winding::WindingTree;
use super::{Crown, units};
use linden_base::input::TriangleMesh;
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;

/// Findings about a mesh; `closed`, `inverted` and the counts are for warnings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeReport {
    /// Whether the surface has no edge: inside and outside are exact.
    pub closed: bool,
    /// Edges with one triangle: the rims of holes.
    pub boundary_edges: usize,
    /// Edges with three or more triangles: inner walls, or bodies that touch.
    pub non_manifold_edges: usize,
    /// Whether the triangles look inward (clockwise from outside); treated as if they did not.
    pub inverted: bool,
    /// The enclosed volume: of the polyhedron if it is closed and in one part, otherwise an estimate
    /// by probes with a standard error of about 1 %.
    pub volume_m3: f64,
    /// Parts that share no edge.
    pub components: usize,
    /// Triangles used.
    pub triangles: usize,
    /// Triangles left out: without area of their own, or there twice.
    pub dropped_triangles: usize,
    /// Triangles turned around to agree with their neighbours.
    pub turned_triangles: usize,
}

impl EnvelopeReport {
    /// One line for each thing that a user should know, none for a clean mesh.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.closed {
            let edges = self.boundary_edges.max(1);
            let s = if edges == 1 { "" } else { "s" };
            let how = if self.boundary_edges > 0 { "open" } else { "not orientable" };
            warnings.push(format!(
                "the envelope is {how} at {edges} edge{s}: points are drawn where its surface encloses them at least half"
            ));
        }
        if self.inverted {
            warnings
                .push("the envelope's faces look inward; it is used as if they looked outward".to_owned());
        }
        if self.turned_triangles > 0 {
            let turned = self.turned_triangles;
            warnings.push(format!(
                "{turned} of the envelope's triangles were turned to agree with their neighbours"
            ));
        }
        warnings
    }
}

/// Why a mesh is no crown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvelopeError {
    /// An index of no vertex, or a coordinate that is no finite number.
    #[error("the crown mesh's triangle {triangle} has a corner that is no vertex or no finite position")]
    Broken {
        /// Counted from 0.
        triangle: usize,
    },
    /// No volume inside.
    #[error(
        "the crown mesh ({triangles} triangles, {boundary_edges} open edges) encloses no volume to speak of; \
         it must be a closed surface such as a sphere, not a sheet"
    )]
    NothingEnclosed {
        /// Triangles of the mesh.
        triangles: usize,
        /// Edges with one triangle.
        boundary_edges: usize,
    },
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A mesh as a crown.
pub struct Envelope {
    surface: Surface,
    tree: WindingTree,
    cells: Cells,
    bounds: Bounds,
    foot: DVec3,
    report: EnvelopeReport,
}

/// Cells along the longest way through the box; the grid has at most this many cubed.
const CELLS: u32 = 32;

/// Draws that probe the cells before any point is asked for.
const PROBES: u64 = 1 << 15;

/// With fewer hits among the probes the mesh encloses next to nothing, and drawing its points
/// would take for ever.
const LEAST_HITS: u64 = PROBES / 1000;

impl Envelope {
    /// Takes a mesh, Y up, metres. The centre of its base (the middle of the underside of its box)
    /// becomes the origin; [`Envelope::foot`] tells where it was.
    ///
    /// # Errors
    /// [`EnvelopeError`]: broken indices or positions, nothing enclosed, cancelled.
    pub fn new(mesh: &TriangleMesh, monitor: &dyn Monitor) -> Result<Self, EnvelopeError> {
        let is_sound = |corner: u32| mesh.positions.get(corner as usize).is_some_and(|p| p.is_finite());
        if let Some(triangle) = mesh.triangles.iter().position(|t| !t.iter().all(|&c| is_sound(c))) {
            return Err(EnvelopeError::Broken { triangle });
        }
        monitor.check()?;
        let mut surface = Surface::new(&mesh.positions, &mesh.triangles);
        let nothing = EnvelopeError::NothingEnclosed {
            triangles: mesh.triangles.len(),
            boundary_edges: surface.boundary_edges,
        };
        let used = || surface.triangles.iter().flatten().map(|&v| surface.positions[v as usize]);
        let low = used().fold(DVec3::INFINITY, DVec3::min);
        let high = used().fold(DVec3::NEG_INFINITY, DVec3::max);
        if !(high - low).cmpgt(DVec3::ZERO).all() {
            return Err(nothing);
        }
        let foot = DVec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
        for p in &mut surface.positions {
            *p -= foot;
        }
        monitor.check()?;
        let corners = |t: &[u32; 3]| t.map(|v| surface.positions[v as usize]);
        let triangles: Vec<[DVec3; 3]> = surface.triangles.iter().map(corners).collect();
        let tree = WindingTree::new(triangles.clone());
        monitor.check()?;
        let cells =
            Cells::new(low - foot, high - foot, surface.closed.then_some(&triangles), &tree, monitor)?;
        let probes = cells.probe(&tree, monitor)?;
        // A sheet, however bent, surrounds by three quarters only what a sharp fold of it holds; an
        // open bowl a good part of its inside.
        if probes.hits < LEAST_HITS || 10 * probes.deep < probes.hits {
            return Err(nothing);
        }
        let exact = surface.closed && surface.components == 1;
        let report = EnvelopeReport {
            closed: surface.closed,
            boundary_edges: surface.boundary_edges,
            non_manifold_edges: surface.non_manifold_edges,
            inverted: 2 * probes.inverted > probes.hits,
            volume_m3: if exact { surface.signed_volume_m3().abs() } else { probes.volume_m3 },
            components: surface.components,
            triangles: surface.triangles.len(),
            dropped_triangles: surface.dropped_triangles,
            turned_triangles: surface.turned_triangles,
        };
        let bounds = Bounds { min: (low - foot).as_vec3(), max: (high - foot).as_vec3() };
        Ok(Self { surface, tree, cells, bounds, foot, report })
    }

    /// Findings about the mesh.
    pub fn report(&self) -> EnvelopeReport {
        self.report
    }

    /// The closed parts that stand apart, each a crown of its own; one or none where there is nothing to tell
    /// apart.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn shells(&self, monitor: &dyn Monitor) -> Result<Vec<Shell>, Cancelled> {
        if self.surface.components > 1 { shells(&self.surface, monitor) } else { Ok(Vec::new()) }
    }

    /// Where a trunk enters it.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn entry(&self, monitor: &dyn Monitor) -> Result<Entry, Cancelled> {
        let Bounds { min, max } = self.bounds;
        entry([min.as_dvec3(), max.as_dvec3()], DVec3::ZERO, |p| self.contains(p), monitor)
    }

    /// Where the crown's origin lies in the mesh's own coordinates.
    pub fn foot(&self) -> DVec3 {
        self.foot
    }
}

impl Crown for Envelope {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn contains(&self, p: DVec3) -> bool {
        self.tree.winding(p).abs() >= 0.5
    }

    /// Rejection from the grid's cells that are not wholly outside: at most 1000 attempts on average,
    /// two for anything round.
    fn sample(&self, key: Key) -> DVec3 {
        let mut attempt = 0;
        loop {
            let (point, sure) = self.cells.draw(key.child(attempt));
            if sure || self.contains(point) {
                return point;
            }
            attempt += 1;
        }
    }

    /// Cuts by seven level planes and two upright ones.
    fn outline(&self) -> Vec<Vec<Vec3>> {
        const LEVELS: u32 = 8;
        let height = f64::from(self.bounds.max.y);
        let level = |i: u32| (DVec3::Y, height * f64::from(i) / f64::from(LEVELS));
        let planes = (1..LEVELS).map(level).chain([(DVec3::X, 0.0), (DVec3::Z, 0.0)]);
        planes.flat_map(|(normal, distance)| self.surface.cut(normal, distance)).collect()
    }

    fn skin(&self) -> Skin {
        Skin {
            positions: self.surface.positions.iter().map(|place| place.as_vec3()).collect(),
            triangles: self.surface.triangles.clone(),
        }
    }

    fn volume_m3(&self) -> f64 {
        self.report.volume_m3
    }
}

/// The cells of a grid that are not wholly outside, all of one size.
struct Cells {
    min: DVec3,
    cell: DVec3,
    count: [u32; 3],
    /// Cells wholly inside come first: a point there needs no test.
    kept: Vec<u32>,
    inside: usize,
}

struct Probes {
    hits: u64,
    /// Hits that the surface surrounds by three quarters or more.
    deep: u64,
    inverted: u64,
    volume_m3: f64,
}

impl Cells {
    /// `closed` holds the triangles of a surface without holes: cells that none of their boxes touch
    /// lie wholly on one side. Without it, every cell is kept for testing.
    fn new(
        min: DVec3,
        max: DVec3,
        closed: Option<&Vec<[DVec3; 3]>>,
        tree: &WindingTree,
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        // Flat boxes get fewer cells across, but enough of them.
        let size = max - min;
        let count = (size / size.max_element() * f64::from(CELLS))
            .ceil()
            .clamp(DVec3::splat(4.0), DVec3::splat(32.0));
        let mut cells = Self {
            min,
            cell: size / count,
            count: count.to_array().map(|n| n as u32),
            kept: Vec::new(),
            inside: 0,
        };
        let total = cells.count.iter().product::<u32>();
        let Some(triangles) = closed else {
            cells.kept = (0..total).collect();
            return Ok(cells);
        };
        let mut touched = vec![false; total as usize];
        for (i, triangle) in triangles.iter().enumerate() {
            if i % 1024 == 0 {
                monitor.check()?;
            }
            let [x, y, z] = cells.touched_by(triangle);
            for x in x {
                for y in y.clone() {
                    for z in z.clone() {
                        touched[cells.index(x, y, z) as usize] = true;
                    }
                }
            }
        }
        let is_inside: Vec<bool> = (0..total)
            .into_par_iter()
            .map(|index| {
                monitor.check()?;
                let centre = cells.corner(index) + 0.5 * cells.cell;
                Ok(!touched[index as usize] && tree.winding(centre).abs() >= 0.5)
            })
            .collect::<Result<_, Cancelled>>()?;
        cells.kept = (0..total).filter(|&index| is_inside[index as usize]).collect();
        cells.inside = cells.kept.len();
        cells.kept.extend((0..total).filter(|&index| touched[index as usize]));
        Ok(cells)
    }

    /// The ranges of cells that a triangle's box touches, and a hair more against rounding.
    fn touched_by(&self, triangle: &[DVec3; 3]) -> [Range<u32>; 3] {
        let low = triangle[0].min(triangle[1]).min(triangle[2]);
        let high = triangle[0].max(triangle[1]).max(triangle[2]);
        [0, 1, 2].map(|axis| {
            let cell = |x: f64, hair: f64| ((x - self.min[axis]) / self.cell[axis] + hair).floor();
            let last = self.count[axis] - 1;
            let first = (cell(low[axis], -1e-9).max(0.0) as u32).min(last);
            first..(cell(high[axis], 1e-9).max(0.0) as u32).min(last) + 1
        })
    }

    fn index(&self, x: u32, y: u32, z: u32) -> u32 {
        let [_, ny, nz] = self.count;
        (x * ny + y) * nz + z
    }

    fn corner(&self, index: u32) -> DVec3 {
        let [_, ny, nz] = self.count;
        let at = [index / nz / ny, index / nz % ny, index % nz].map(f64::from);
        self.min + self.cell * DVec3::from(at)
    }

    /// A point uniform in the kept cells, and whether its cell lies wholly inside.
    fn draw(&self, key: Key) -> (DVec3, bool) {
        let slot = (key.unit() * self.kept.len() as f64) as usize;
        let point = self.corner(self.kept[slot]) + self.cell * DVec3::from(units(key));
        (point, slot < self.inside)
    }

    fn probe(&self, tree: &WindingTree, monitor: &dyn Monitor) -> Result<Probes, Cancelled> {
        let key = Key::new(0).named("envelope probes");
        let one = |i: u64| {
            monitor.check()?;
            let (point, _) = self.draw(key.child(i));
            let winding = tree.winding(point);
            let depth = winding.abs();
            Ok([depth >= 0.5, depth >= 0.75, winding <= -0.5].map(u64::from))
        };
        let sum = |a: [u64; 3], b: [u64; 3]| Ok([a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        let [hits, deep, inverted] = (0..PROBES).into_par_iter().map(one).try_reduce(|| [0; 3], sum)?;
        let kept_m3 = self.cell.element_product() * self.kept.len() as f64;
        Ok(Probes { hits, deep, inverted, volume_m3: kept_m3 * hits as f64 / PROBES as f64 })
    }
}
