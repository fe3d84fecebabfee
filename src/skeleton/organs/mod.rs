//! What grows on the wood: leaves, blossoms, fruit, as places and shapes.
//!
//! A generator may leave [`Organs`] behind beside the wood: polygons, which are shapes of their own, and
//! places where an organ of the table [`PROTOTYPES`] grows. Foliage adds leaves of the kinds that a plant's
//! settings describe ([`Organs::shapes`]).

mod area;
mod hash;
mod prototype;

use std::sync::Arc;

use glam::Vec3;
use linden_base::memory::bytes_of;
use linden_base::mesh::{Bounds, Mesh};

use crate::refine::Rider;

pub use prototype::{OrganClass, PROTOTYPES, Prototype, prototype};

/// The most corners that one polygon may have: far more than any leaf's outline, few enough for the
/// triangulation, whose worst case is cubic.
pub const MAX_CORNERS: usize = 1000;

/// The corners of a box: a bit for each axis.
const ALL_CORNERS: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
/// Two that are opposite, and two others.
const DIAGONALS: [u32; 4] = [0, 7, 1, 6];

/// Everything that grows on the wood.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Organs {
    /// Shapes of their own.
    pub polygons: Polygons,
    /// Organs of the table, and of the preset's kinds.
    pub placed: PlacedOrgans,
    /// The variants of the preset's kinds, those of one kind after those of the other.
    pub shapes: Arc<[LeafShape]>,
    /// Whether the leaves and needles that a generator placed are there only where the preset's first kind has a form:
    /// it gave them no shape of their own, as a grammar's `~L` has.
    pub need_form: bool,
}

/// Filled outlines, lying in a plane or nearly so. Where nothing else is said, the arrays have an entry
/// per polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    /// The corners of all polygons, one polygon after the other, metres.
    pub corners: Vec<Vec3>,
    /// Where each polygon's corners end in `corners`.
    pub ends: Vec<u32>,
    /// Unit vectors: where the outline was begun towards, V of the picture on it.
    pub headings: Vec<Vec3>,
    /// Unit vectors: the side that counts as the upper one.
    pub ups: Vec<Vec3>,
    /// How each hangs on the wood.
    pub growth: OrganOrigins,
}

/// A variant of a kind of leaf, as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafShape {
    /// The kind, counted as in the settings of the foliage.
    pub kind: u8,
    /// Its triangles, with the texture coordinates of one cell of the kind's picture.
    pub mesh: Mesh,
    /// Fewer triangles that have about its outline without any picture.
    pub sketch: Mesh,
    /// Mean colour, sRGB.
    pub color: [u8; 3],
    /// Whether its normals point out of the crown.
    pub is_dome: bool,
    /// How often it is there: 1, seen from both sides, or 2, its upper side and then the same from below, each seen from
    /// its own side.
    pub faces: u8,
    /// What stands for `mesh` in each level of detail, finest first, the last in all further ones, with texture
    /// coordinates of the same cell. Empty: `mesh` in all.
    pub lods: Vec<Mesh>,
}

/// Organs of [`PROTOTYPES`] and [`Organs::shapes`], each with its frame. Where nothing else is said, the
/// arrays have an entry per organ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacedOrgans {
    /// Indices into [`PROTOTYPES`], and beyond these into [`Organs::shapes`].
    pub prototypes: Vec<u8>,
    /// Where they are attached, metres.
    pub positions: Vec<Vec3>,
    /// Unit vectors along the organs.
    pub headings: Vec<Vec3>,
    /// Unit vectors, square to the headings: their upper sides.
    pub ups: Vec<Vec3>,
    /// Size of one unit of the prototype, metres.
    pub sizes_m: Vec<f32>,
    /// How each hangs on the wood.
    pub growth: OrganOrigins,
}

impl PlacedOrgans {
    /// Bytes of one organ.
    pub const BYTES_EACH: u64 = bytes_of::<([f32; 3], [f32; 3], [f32; 3], f32, u32, u32, u32)>(1) + 1;

    /// How many there are.
    pub fn len(&self) -> usize {
        self.prototypes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.prototypes.is_empty()
    }

    /// Makes room for more.
    pub fn reserve(&mut self, more: usize) {
        let Self { prototypes, positions, headings, ups, sizes_m, growth } = self;
        let OrganOrigins { nodes, colors, births } = growth;
        prototypes.reserve_exact(more);
        for list in [positions, headings, ups] {
            list.reserve_exact(more);
        }
        for list in [nodes, colors, births] {
            list.reserve_exact(more);
        }
        sizes_m.reserve_exact(more);
    }

    /// Adds others.
    pub fn append(&mut self, mut other: Self) {
        self.prototypes.append(&mut other.prototypes);
        self.positions.append(&mut other.positions);
        self.headings.append(&mut other.headings);
        self.ups.append(&mut other.ups);
        self.sizes_m.append(&mut other.sizes_m);
        self.growth.nodes.append(&mut other.growth.nodes);
        self.growth.colors.append(&mut other.growth.colors);
        self.growth.births.append(&mut other.growth.births);
    }
}

/// Where and when organs appeared on the tree, an entry per organ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OrganOrigins {
    /// The node of the skeleton that it hangs on.
    pub nodes: Vec<u32>,
    /// The turtle's colour index, from 0.
    pub colors: Vec<u32>,
    /// The derivation step in which it appeared.
    pub births: Vec<u32>,
}

/// Where and when one organ appeared: an entry of [`OrganOrigins`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hanging {
    /// The node of the skeleton that it hangs on.
    pub node: u32,
    /// The turtle's colour index, from 0.
    pub color: u32,
    /// The derivation step in which it appeared.
    pub birth: u32,
}

impl Organs {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.polygons.ends.len() + self.placed.prototypes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes that they take, reserved places included.
    pub fn bytes(&self) -> u64 {
        let growth = |growth: &OrganOrigins| {
            growth.nodes.capacity() + growth.colors.capacity() + growth.births.capacity()
        };
        let Self { polygons, placed, shapes: _, need_form: _ } = self;
        let vectors = [&polygons.corners, &polygons.headings, &polygons.ups]
            .into_iter()
            .chain([&placed.positions, &placed.headings, &placed.ups])
            .map(Vec::capacity)
            .sum();
        let words = polygons.ends.capacity() + placed.sizes_m.capacity();
        bytes_of::<Vec3>(vectors)
            + bytes_of::<u32>(words + growth(&polygons.growth) + growth(&placed.growth))
            + bytes_of::<u8>(placed.prototypes.capacity())
    }

    /// How an organ hangs on the wood: the polygons are counted first, then the organs of the table.
    pub fn growth(&self, organ: usize) -> Hanging {
        let (all, at) = match organ.checked_sub(self.polygons.ends.len()) {
            None => (&self.polygons.growth, organ),
            Some(placed) => (&self.placed.growth, placed),
        };
        Hanging { node: all.nodes[at], color: all.colors[at], birth: all.births[at] }
    }

    /// How many nodes bear any.
    pub fn sites(&self) -> u64 {
        let nodes = self.polygons.growth.nodes.iter().chain(&self.placed.growth.nodes);
        let mut nodes: Vec<u32> = nodes.copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.len() as u64
    }

    /// The organs as refinement takes them along: the polygons, then those of `placed`.
    pub fn riders(&self) -> Vec<Rider> {
        let nodes = self.polygons.growth.nodes.iter().chain(&self.placed.growth.nodes);
        nodes.map(|&node| Rider { node, moved: Vec3::ZERO }).collect()
    }

    /// Goes where refinement took the [`riders`](Self::riders).
    pub fn follow(&mut self, riders: &[Rider]) {
        let (polygons, placed) = riders.split_at(self.polygons.growth.nodes.len());
        let mut start = 0;
        for (polygon, rider) in polygons.iter().enumerate() {
            self.polygons.growth.nodes[polygon] = rider.node;
            let end = self.polygons.ends[polygon] as usize;
            self.polygons.corners[start..end].iter_mut().for_each(|corner| *corner += rider.moved);
            start = end;
        }
        for (organ, rider) in placed.iter().enumerate() {
            self.placed.growth.nodes[organ] = rider.node;
            self.placed.positions[organ] += rider.moved;
        }
    }

    /// The corners of a polygon.
    pub fn corners_of(&self, polygon: usize) -> &[Vec3] {
        let ends = &self.polygons.ends;
        let start = if polygon == 0 { 0 } else { ends[polygon - 1] as usize };
        &self.polygons.corners[start..ends[polygon] as usize]
    }

    /// The variant that an organ of `placed` is, `None` for one of [`PROTOTYPES`].
    pub fn shape(&self, placed: usize) -> Option<&LeafShape> {
        self.shapes.get(usize::from(self.placed.prototypes[placed]).checked_sub(PROTOTYPES.len())?)
    }

    /// The mesh of an organ of `placed`.
    pub fn mesh(&self, placed: usize) -> &Mesh {
        self.prototype_mesh(self.placed.prototypes[placed])
    }

    /// The mesh of what [`PlacedOrgans::prototypes`] has by this number.
    pub fn prototype_mesh(&self, prototype: u8) -> &Mesh {
        let prototype = usize::from(prototype);
        let shape = prototype.checked_sub(PROTOTYPES.len()).and_then(|shape| self.shapes.get(shape));
        shape.map_or_else(|| PROTOTYPES[prototype % PROTOTYPES.len()].mesh(), |shape| &shape.mesh)
    }

    /// The mean colour of an organ (the polygons are counted first), sRGB, where its kind has one:
    /// otherwise its colour index decides.
    pub fn color(&self, organ: usize) -> Option<[u8; 3]> {
        self.shape(organ.checked_sub(self.polygons.ends.len())?).map(|shape| shape.color)
    }

    /// Points that span what the organs take up: the corners of the polygons, of each organ of the
    /// table the corners of a box around it, and of each leaf, which are many and small, the ends of
    /// two diagonals.
    pub fn hull(&self) -> impl Iterator<Item = Vec3> {
        let boxes: Vec<Option<Bounds>> = PROTOTYPES
            .iter()
            .map(|prototype| prototype.mesh().bounds())
            .chain(self.shapes.iter().map(|shape| shape.mesh.bounds()))
            .collect();
        let placed = (0..self.placed.prototypes.len()).flat_map(move |i| {
            let prototype = usize::from(self.placed.prototypes[i]);
            let bounds = boxes.get(prototype).copied().flatten();
            let corner = move |n: u32, Bounds { min, max }: Bounds| {
                let pick = |axis: u32, low: f32, high: f32| if n >> axis & 1 == 0 { low } else { high };
                self.place(i, Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z)))
            };
            let corners: &[u32] = if prototype < PROTOTYPES.len() { &ALL_CORNERS } else { &DIAGONALS };
            bounds.into_iter().flat_map(move |bounds| corners.iter().map(move |&n| corner(n, bounds)))
        });
        self.polygons.corners.iter().copied().chain(placed)
    }

    /// About how many vertices and triangles the meshes have: exact for organs of the table, for
    /// leaves, and for polygons in which no corner is superfluous.
    pub fn amount(&self) -> (u64, u64) {
        let (plain, leaves) = (self.plain_amount(), self.leaf_amount());
        (plain.0 + leaves.0, plain.1 + leaves.1)
    }

    /// The part of [`Self::amount`] that has one colour and no picture.
    pub fn plain_amount(&self) -> (u64, u64) {
        let corners = self.polygons.corners.len() as u64;
        let filled = (corners, corners.saturating_sub(2 * self.polygons.ends.len() as u64));
        self.sum(0, PROTOTYPES.iter().map(Prototype::mesh), filled)
    }

    /// The part of [`Self::amount`] that has pictures.
    fn leaf_amount(&self) -> (u64, u64) {
        self.sum(PROTOTYPES.len(), self.shapes.iter().map(|shape| &shape.mesh), (0, 0))
    }

    /// What is placed of the meshes of the prototypes from `first` on.
    fn sum<'a>(
        &self,
        first: usize,
        meshes: impl Iterator<Item = &'a Mesh>,
        (vertices, triangles): (u64, u64),
    ) -> (u64, u64) {
        let mut counts = [0_u64; 256];
        for &prototype in &self.placed.prototypes {
            counts[usize::from(prototype)] += 1;
        }
        meshes.zip(&counts[first..]).fold((vertices, triangles), |(vertices, triangles), (mesh, count)| {
            (vertices + count * mesh.positions.len() as u64, triangles + count * mesh.triangles.len() as u64)
        })
    }

    /// Where a point of the prototype is on an organ.
    pub fn place(&self, organ: usize, local: Vec3) -> Vec3 {
        self.placed.positions[organ] + self.turn(organ, local) * self.placed.sizes_m[organ]
    }

    /// A direction of the prototype on an organ.
    pub fn turn(&self, organ: usize, local: Vec3) -> Vec3 {
        let (heading, up) = (self.placed.headings[organ], self.placed.ups[organ]);
        heading.cross(up) * local.x + heading * local.y + up * local.z
    }
}
