//! Organs → meshes, one for each colour of the grammar's and one for each kind of the preset's.
//!
//! Amounts are counted first, so that each task writes into slices of its own of meshes that are
//! allocated once: parallel, and the same bits for any number of threads.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::outline::Filler;
use super::{Organs, PROTOTYPES};
use crate::texture::leaf::LeafError;
use linden_base::memory::OverMemory;
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::organs::LeafShape;

/// Organs that one task makes triangles of.
const PER_TASK: usize = 2048;

/// All organs of one look.
#[derive(Clone, Debug, PartialEq)]
pub struct Foliage {
    /// The look that they have in common.
    pub look: Look,
    /// Their triangles; not empty.
    pub mesh: Mesh,
}

/// The look that organs of one mesh have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Look {
    /// A grammar's organs and polygons of a colour, by its index.
    Color(usize),
    /// A kind of leaf, counted as [`FoliageSettings::kinds`](crate::settings::FoliageSettings::kinds).
    Kind(usize),
}

/// Why there is no foliage.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FoliageError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// More vertices than an index of 32 bits can name.
    #[error(
        "the foliage would have {vertices} vertices, more than the 4294967294 that mesh formats can index; use fewer derivations or leaves"
    )]
    TooLarge {
        /// How many there would be.
        vertices: u64,
    },
    /// More leaves than anybody can use.
    #[error(
        "about {leaves:.0} leaves would grow, more than the limit of {limit}; lower leaves_per_m or \
         leaf_max_radius, or take twig cards (leaf_form=twig)"
    )]
    TooMany {
        /// About how many there would be.
        leaves: u64,
        /// The limit.
        limit: u64,
    },
    /// A file that is missing or holds something else.
    #[error("leaves need '{}', which must hold {expected}", linden_base::knob::printable(.file))]
    WrongInput {
        /// As the preset names it.
        file: String,
        /// What it must hold.
        expected: &'static str,
    },
    /// A mesh is wanted and none is named.
    #[error("leaf_form=mesh needs a file: leaf_mesh = \"leaf.obj\" in the preset's [foliage]")]
    NoMesh,
    /// Too many triangles for what there are thousands of.
    #[error(
        "the mesh of a leaf has {triangles} triangles, more than the limit of {limit} for what grows in \
         thousands; simplify it"
    )]
    MeshTooLarge {
        /// What it has.
        triangles: usize,
        /// The limit.
        limit: usize,
    },
    /// A mesh without any height.
    #[error(
        "the mesh of a leaf has no height: it must point along +Y from its foot, its upper side to +Z; export it with Y up"
    )]
    MeshFlat,
    /// A form that a kind cannot have in a level of detail.
    #[error(
        "lod_form: kind {kind} of the foliage has leaf_form={form} and cannot become '{wanted}'; give it {form}, branch-card{}",
        if *form == "fan" || *form == "mesh" { "" } else { ", card, cross, tuft or curved" }
    )]
    LodForm {
        /// Counted from 1.
        kind: usize,
        /// What it is made of.
        form: &'static str,
        /// What a level wants of it.
        wanted: &'static str,
    },
    /// The picture.
    #[error("drawing leaves: {0}")]
    Picture(#[source] LeafError),
}

linden_base::from_cancellable!(FoliageError: LeafError => Picture);

/// Makes triangles of all organs. There are `colors` colours, at least one; organs of a grammar with a
/// higher index have the last. A look that no organ has is left out; colours come first.
///
/// The triangles are counter-clockwise seen from an organ's upper side, and the normals point there:
/// the backs are to be drawn too.
///
/// # Errors
/// [`FoliageError`]: too large, or cancelled.
pub fn meshes(organs: &Organs, colors: usize, monitor: &dyn Monitor) -> Result<Vec<Foliage>, FoliageError> {
    meshes_of(organs, &organs.shapes, colors, monitor)
}

/// The same with other shapes in place of [`Organs::shapes`], as many of each kind.
///
/// # Errors
/// As [`meshes`].
pub fn meshes_of(
    organs: &Organs,
    shapes: &[LeafShape],
    colors: usize,
    monitor: &dyn Monitor,
) -> Result<Vec<Foliage>, FoliageError> {
    let colors = colors.max(1);
    let (vertices, triangles) = organs.amount();
    // The largest index is left out: glTF reserves it.
    if vertices >= u32::MAX.into() {
        return Err(FoliageError::TooLarge { vertices });
    }
    let corners = organs.polygons.corners.len();
    // Polygons are filled before it is known how much that gives, in lists that grow one by one.
    let bytes =
        Mesh::bytes_for(vertices as usize, triangles as usize) + Mesh::bytes_for(corners, corners) * 3;
    monitor.admit("shaping the leaves", bytes, "use fewer derivations or leaves")?;
    let baker = Baker::new(organs, shapes, colors);
    let polygons = organs.polygons.ends.len();
    let tasks = |count: usize, first: usize| {
        (0..count.div_ceil(PER_TASK)).map(move |task| {
            let end = count.min((task + 1) * PER_TASK);
            first + task * PER_TASK..first + end
        })
    };
    let ranges: Vec<_> = tasks(polygons, 0).chain(tasks(organs.len() - polygons, polygons)).collect();
    let plans = ranges.into_par_iter().map(|range| {
        monitor.check()?;
        Ok(baker.plan(range))
    });
    let plans = plans.collect::<Result<Vec<Plan>, Cancelled>>()?;

    let mut all: Vec<Mesh> = Vec::new();
    for slot in 0..baker.slots() {
        let of = |count: fn(&Amount) -> usize| plans.iter().map(|plan| count(&plan.amounts[slot])).sum();
        all.push(Mesh::zeroed(of(|amount| amount.vertices), of(|amount| amount.triangles)));
    }
    let targets = split(&mut all, &plans);
    plans.par_iter().zip(targets).try_for_each(|(plan, mut targets)| {
        monitor.check()?;
        baker.fill(plan, &mut targets);
        Ok::<(), Cancelled>(())
    })?;
    let looks = (0..baker.slots()).map(|slot| match slot.checked_sub(colors) {
        None => Look::Color(slot),
        Some(kind) => Look::Kind(kind),
    });
    let all = looks.zip(all).map(|(look, mesh)| Foliage { look, mesh });
    Ok(all.filter(|foliage| !foliage.mesh.triangles.is_empty()).collect())
}

/// How much there is.
#[derive(Clone, Copy, Default)]
struct Amount {
    vertices: usize,
    triangles: usize,
}

impl Amount {
    fn add(&mut self, mesh: &Mesh, times: usize) {
        self.vertices += times * mesh.positions.len();
        self.triangles += times * mesh.triangles.len();
    }
}

/// What one task will write.
struct Plan {
    organs: std::ops::Range<usize>,
    /// By slot.
    amounts: Vec<Amount>,
    /// Polygons, filled already: the slot of each mesh.
    filled: Vec<(usize, Mesh)>,
}

/// Slots are the colours, then the kinds.
struct Baker<'a> {
    organs: &'a Organs,
    colors: usize,
    kinds: usize,
    /// By index of [`super::PlacedOrgans::prototypes`].
    stamps: Vec<Stamp<'a>>,
}

/// What is the same for all organs of a shape.
struct Stamp<'a> {
    mesh: &'a Mesh,
    /// Where its triangles go; `None`: each organ's colour decides.
    slot: Option<usize>,
    /// How one with dome normals is lit.
    dome: Option<Dome>,
}

/// The light of a shape with dome normals.
struct Dome {
    /// The middle of its kind's crown, metres.
    center: Vec3,
    /// Its pieces that hang together, vertices and triangles of each: planes of a card. None of a shape whose faces are
    /// each seen from one side.
    sheets: Vec<(std::ops::Range<usize>, std::ops::Range<usize>)>,
}

impl Dome {
    fn of(shape: &LeafShape, center: Vec3) -> Self {
        let is_sheet = shape.faces == 1;
        Self { center, sheets: if is_sheet { sheets(&shape.mesh) } else { Vec::new() } }
    }
}

/// Where a mesh, whose pieces follow each other, can be cut without a triangle or a vertex being in two.
fn sheets(mesh: &Mesh) -> Vec<(std::ops::Range<usize>, std::ops::Range<usize>)> {
    let mut found: Vec<(std::ops::Range<usize>, std::ops::Range<usize>)> = Vec::new();
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle.map(|vertex| vertex as usize);
        let (low, high) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        match found.last_mut() {
            Some((vertices, triangles)) if low < vertices.end => {
                vertices.end = vertices.end.max(high + 1);
                triangles.end = index + 1;
            }
            // What no triangle has belongs to the piece behind it.
            last => {
                let first = last.map_or(0, |(vertices, _)| vertices.end);
                found.push((first..high + 1, index..index + 1));
            }
        }
    }
    found
}

impl<'a> Baker<'a> {
    fn new(organs: &'a Organs, shapes: &'a [LeafShape], colors: usize) -> Self {
        let centers = centers(organs, shapes);
        let plain =
            PROTOTYPES.iter().map(|prototype| Stamp { mesh: prototype.mesh(), slot: None, dome: None });
        let shaped = shapes.iter().map(|shape| {
            let kind = usize::from(shape.kind);
            let dome = shape.is_dome.then(|| Dome::of(shape, centers[kind]));
            Stamp { mesh: &shape.mesh, slot: Some(colors + kind), dome }
        });
        Self { organs, colors, kinds: centers.len(), stamps: plain.chain(shaped).collect() }
    }

    fn slots(&self) -> usize {
        self.colors + self.kinds
    }

    fn color_slot(&self, color: u32) -> usize {
        (color as usize).min(self.colors - 1)
    }

    fn plan(&self, organs: std::ops::Range<usize>) -> Plan {
        let mut plan = Plan { organs, amounts: vec![Amount::default(); self.slots()], filled: Vec::new() };
        let polygons = self.organs.polygons.ends.len();
        let mut shaper = Shaper::default();
        for organ in plan.organs.start..plan.organs.end.min(polygons) {
            let slot = self.color_slot(self.organs.growth(organ).color);
            let at = plan.filled.iter().position(|(known, _)| *known == slot).unwrap_or_else(|| {
                plan.filled.push((slot, Mesh::default()));
                plan.filled.len() - 1
            });
            shaper.polygon(self.organs, organ, &mut plan.filled[at].1);
        }
        // Most are of shapes whose slot is known: these are counted, and added up afterwards.
        let mut counts = [0_usize; 1 << u8::BITS];
        for placed in self.placed(&plan.organs) {
            counts[usize::from(self.organs.placed.prototypes[placed])] += 1;
            let (slot, stamp) = self.stamp(placed);
            if stamp.slot.is_none() {
                plan.amounts[slot].add(stamp.mesh, 1);
            }
        }
        for (stamp, count) in self.stamps.iter().zip(counts) {
            if let Some(slot) = stamp.slot {
                plan.amounts[slot].add(stamp.mesh, count);
            }
        }
        for (slot, mesh) in &plan.filled {
            plan.amounts[*slot].add(mesh, 1);
        }
        plan
    }

    /// The slot and the shape of an organ of the table.
    fn stamp(&self, placed: usize) -> (usize, &Stamp<'_>) {
        let prototype = usize::from(self.organs.placed.prototypes[placed]);
        // A shape that is not given is drawn as one of the table.
        let stamp = self.stamps.get(prototype).unwrap_or(&self.stamps[prototype % PROTOTYPES.len()]);
        (stamp.slot.unwrap_or_else(|| self.color_slot(self.organs.placed.growth.colors[placed])), stamp)
    }

    fn fill(&self, plan: &Plan, targets: &mut [Target<'_>]) {
        for (slot, mesh) in &plan.filled {
            let target = &mut targets[*slot];
            target.begin(mesh);
            target.positions.take(mesh.positions.len()).copy_from_slice(&mesh.positions);
            target.normals.take(mesh.normals.len()).copy_from_slice(&mesh.normals);
        }
        for placed in self.placed(&plan.organs) {
            let (slot, stamp) = self.stamp(placed);
            self.place(placed, stamp, &mut targets[slot]);
        }
    }

    /// Those of some organs that are in the table.
    fn placed(&self, organs: &std::ops::Range<usize>) -> std::ops::Range<usize> {
        let polygons = self.organs.polygons.ends.len();
        organs.start.max(polygons) - polygons..organs.end.max(polygons) - polygons
    }

    fn place(&self, placed: usize, stamp: &Stamp<'_>, target: &mut Target<'_>) {
        let mesh = stamp.mesh;
        let triangles = target.begin(mesh);
        let organs = &self.organs.placed;
        let (foot, size) = (organs.positions[placed], organs.sizes_m[placed]);
        let (heading, up) = (organs.headings[placed], organs.ups[placed]);
        let side = heading.cross(up);
        let turn = |v: Vec3| side * v.x + heading * v.y + up * v.z;
        let positions = target.positions.take(mesh.positions.len());
        copy(positions, &mesh.positions, |local| foot + turn(local) * size);
        let normals = target.normals.take(mesh.normals.len());
        // Of unit length: so are the shape's, and the frame is orthonormal.
        copy(normals, &mesh.normals, turn);
        let Some(Dome { center, sheets }) = &stamp.dome else { return };
        let mut fronts = triangles;
        for (vertices, of_sheet) in sheets {
            let (normals, positions) = (&mut normals[vertices.clone()], &positions[vertices.clone()]);
            let outward: f32 = normals
                .iter()
                .zip(positions)
                .map(|(face, at)| face.dot((*at - *center).normalize_or_zero()))
                .sum();
            let (sheet, rest) = fronts.split_at_mut(of_sheet.len());
            fronts = rest;
            // Its front looks out of the crown: whoever stands outside sees it, and renderers turn no normal round.
            if outward < 0.0 {
                for normal in normals.iter_mut() {
                    *normal = -*normal;
                }
                for corners in sheet {
                    corners.swap(1, 2);
                }
            }
        }
        for (normal, &at) in normals.iter_mut().zip(&*positions) {
            let face = *normal;
            let out = (at - *center).normalize_or(face);
            let toward = face.dot(out);
            // No farther than across: behind its face nothing is lit.
            let out = if toward < 0.0 { (out - face * toward).normalize_or(face) } else { out };
            *normal = face.lerp(out, DOME).normalize_or(face);
        }
    }
}

/// Copies a list, changed one by one. The short lists of cards, of which there are most, are unrolled.
fn copy<T: Copy, U>(to: &mut [U], from: &[T], change: impl Fn(T) -> U) {
    if !unrolled::<4, _, _>(to, from, &change) && !unrolled::<2, _, _>(to, from, &change) {
        to.iter_mut().zip(from).for_each(|(to, &from)| *to = change(from));
    }
}

/// Copies a list of N; whether it is one.
fn unrolled<const N: usize, T: Copy, U>(to: &mut [U], from: &[T], change: impl Fn(T) -> U) -> bool {
    let (Ok(to), Ok(from)) = (<&mut [U; N]>::try_from(to), <&[T; N]>::try_from(from)) else { return false };
    // `from.map` is not inlined.
    for i in 0..N {
        to[i] = change(from[i]);
    }
    true
}

/// How far dome normals turn from the face's normal to out of the crown, a share.
const DOME: f32 = 0.75;

/// The middle of what each kind takes up.
fn centers(organs: &Organs, shapes: &[LeafShape]) -> Vec<Vec3> {
    let kinds = shapes.iter().map(|shape| usize::from(shape.kind) + 1).max().unwrap_or(0);
    let mut bounds: Vec<Option<Bounds>> = vec![None; kinds];
    if shapes.iter().any(|shape| shape.is_dome) {
        for (&prototype, &at) in organs.placed.prototypes.iter().zip(&organs.placed.positions) {
            let shape = usize::from(prototype).checked_sub(PROTOTYPES.len());
            if let Some(shape) = shape.and_then(|shape| shapes.get(shape)) {
                let kind_bounds = &mut bounds[usize::from(shape.kind)];
                let point = Bounds { min: at, max: at };
                *kind_bounds = Some(kind_bounds.map_or(point, |known| known.union(point)));
            }
        }
    }
    bounds
        .into_iter()
        .map(|found| found.map_or(Vec3::ZERO, |bounds| bounds.min.midpoint(bounds.max)))
        .collect()
}

/// A slice of which the front is taken, piece after piece.
struct Rest<'a, T>(&'a mut [T]);

impl<'a, T> Rest<'a, T> {
    fn take(&mut self, count: usize) -> &'a mut [T] {
        let (front, rest) = std::mem::take(&mut self.0).split_at_mut(count);
        self.0 = rest;
        front
    }
}

/// Where a task writes in one slot's mesh.
struct Target<'a> {
    positions: Rest<'a, Vec3>,
    normals: Rest<'a, Vec3>,
    uvs: Rest<'a, Vec2>,
    triangles: Rest<'a, [u32; 3]>,
    /// Index of the next vertex in the whole mesh.
    next: u32,
}

impl<'a> Target<'a> {
    /// What is the same wherever a mesh goes: texture coordinates and triangles, which it hands back.
    fn begin(&mut self, mesh: &Mesh) -> &'a mut [[u32; 3]] {
        let first = self.next;
        let triangles = self.triangles.take(mesh.triangles.len());
        copy(triangles, &mesh.triangles, |local| local.map(|v| first + v));
        copy(self.uvs.take(mesh.uvs.len()), &mesh.uvs, |uv| uv);
        self.next += mesh.positions.len() as u32;
        triangles
    }
}

/// Cuts all meshes into the slices that each task fills.
fn split<'a>(all: &'a mut [Mesh], plans: &[Plan]) -> Vec<Vec<Target<'a>>> {
    let mut rest: Vec<Target<'a>> = all
        .iter_mut()
        .map(|Mesh { positions, normals, uvs, triangles }| Target {
            positions: Rest(positions),
            normals: Rest(normals),
            uvs: Rest(uvs),
            triangles: Rest(triangles),
            next: 0,
        })
        .collect();
    let one = |target: &mut Target<'a>, amount: &Amount| {
        let next = target.next;
        target.next += amount.vertices as u32;
        Target {
            positions: Rest(target.positions.take(amount.vertices)),
            normals: Rest(target.normals.take(amount.vertices)),
            uvs: Rest(target.uvs.take(amount.vertices)),
            triangles: Rest(target.triangles.take(amount.triangles)),
            next,
        }
    };
    plans
        .iter()
        .map(|plan| rest.iter_mut().zip(&plan.amounts).map(|(t, amount)| one(t, amount)).collect())
        .collect()
}

/// Makes triangles of one organ after the other, for pictures that show no pictures: leaves are
/// rhombs.
#[derive(Default)]
pub struct Shaper {
    filler: Filler,
}

impl Shaper {
    /// Adds an organ (the polygons come first, see [`Organs::growth`]) to a mesh. An outline without an
    /// inside adds nothing.
    pub fn add(&mut self, organs: &Organs, organ: usize, mesh: &mut Mesh) {
        let Some(placed) = organ.checked_sub(organs.polygons.ends.len()) else {
            return self.polygon(organs, organ, mesh);
        };
        let sketch = organs.shape(placed).map_or_else(|| organs.mesh(placed), |shape| &shape.sketch);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(sketch.positions.iter().map(|&p| organs.place(placed, p)));
        mesh.normals.extend(sketch.normals.iter().map(|&n| organs.turn(placed, n).normalize_or(Vec3::Y)));
        mesh.uvs.extend_from_slice(&sketch.uvs);
        mesh.triangles.extend(sketch.triangles.iter().map(|t| t.map(|v| first + v)));
    }

    fn polygon(&mut self, organs: &Organs, polygon: usize, mesh: &mut Mesh) {
        let polygons = &organs.polygons;
        let corners = organs.corners_of(polygon);
        let filled = self.filler.fill(corners, polygons.headings[polygon], polygons.ups[polygon]);
        let Some(filled) = filled else { return };
        let first = mesh.positions.len() as u32;
        for &(corner, uv) in &filled.corners {
            mesh.positions.push(corners[corner as usize]);
            mesh.normals.push(filled.normal);
            mesh.uvs.push(uv);
        }
        mesh.triangles.extend(filled.triangles.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|v| first + v)));
    }
}
