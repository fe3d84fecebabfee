//! What the levels of detail of a tree amount to, each within its budget of triangles.

use std::collections::BTreeSet;

use linden_pipeline::detail::{Amount, Shares, shares};
use linden_pipeline::foliage::{Organs, PROTOTYPES};

/// Of a card's two planes.
const TRIANGLES_A_CARD: u64 = 4;
/// Different cards of a level.
const MESHES: u64 = 24;
/// What a document says of a mesh that is copied takes as much as so many of its places.
const PLACES_A_MESH: u64 = 36;

/// Vertices and triangles of one or more levels of detail.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LevelAmounts {
    pub vertices: u64,
    pub triangles: u64,
    /// The leaves' and organs' part of these.
    pub leaf_vertices: u64,
    pub leaf_triangles: u64,
    /// Vertices of what has no pictures.
    pub plain_vertices: u64,
    /// Leaves and other organs.
    pub organs: u64,
    /// Nodes that bear them.
    pub sites: u64,
    /// Whether branch cards stand for the leaves.
    pub in_cards: bool,
    /// What instances leave out and put in its place.
    pub instanced: Instanced,
}

impl LevelAmounts {
    /// What is left of them within a budget of triangles, `with_cards` where these may stand for leaves.
    pub fn within(&self, budget: u64, with_cards: bool) -> Self {
        if budget >= self.triangles {
            return *self;
        }
        let wood = self.triangles - self.leaf_triangles;
        let tree = Amount { wood, leaves: self.leaf_triangles, sites: self.sites };
        let Shares { wood: for_wood, in_cards } = shares(budget, tree, with_cards);
        let part = |share: u64, all: u64| {
            move |count: u64| (count as f64 * (share as f64 / all.max(1) as f64)) as u64
        };
        let (of_wood, of_leaves) = (part(for_wood, wood), part(budget - for_wood, self.leaf_triangles));
        if in_cards {
            let leaf_triangles = budget - for_wood;
            // Rectangles; instances are written all the same, once each of a few.
            let leaf_vertices = 2 * leaf_triangles;
            let copies = leaf_triangles / TRIANGLES_A_CARD + MESHES * PLACES_A_MESH;
            return Self {
                vertices: of_wood(self.vertices - self.leaf_vertices) + leaf_vertices,
                triangles: budget,
                leaf_vertices,
                leaf_triangles,
                plain_vertices: 0,
                organs: self.organs,
                sites: self.sites,
                in_cards: true,
                instanced: Instanced {
                    vertices: if self.instanced.copies > 0 {
                        leaf_vertices - leaf_vertices.min(200)
                    } else {
                        0
                    },
                    triangles: if self.instanced.copies > 0 {
                        leaf_triangles - leaf_triangles.min(100)
                    } else {
                        0
                    },
                    plain_vertices: 0,
                    copies: if self.instanced.copies > 0 { copies } else { 0 },
                },
            };
        }
        let leaf_vertices = of_leaves(self.leaf_vertices);
        let instanced = self.instanced;
        let left = |all: u64, copies: u64| of_leaves(all).saturating_sub(all - copies);
        Self {
            vertices: of_wood(self.vertices - self.leaf_vertices) + leaf_vertices,
            triangles: budget,
            leaf_vertices,
            leaf_triangles: budget - for_wood,
            plain_vertices: of_leaves(self.plain_vertices),
            organs: of_leaves(self.organs),
            sites: self.sites,
            in_cards: false,
            // One of each shape is written however few there are.
            instanced: Instanced {
                vertices: left(self.leaf_vertices, instanced.vertices),
                triangles: left(self.leaf_triangles, instanced.triangles),
                plain_vertices: left(self.plain_vertices, instanced.plain_vertices),
                copies: of_leaves(instanced.copies),
            },
        }
    }

    /// The sum of both.
    pub fn and(self, other: Self) -> Self {
        let (a, b) = (self.instanced, other.instanced);
        Self {
            vertices: self.vertices + other.vertices,
            triangles: self.triangles + other.triangles,
            plain_vertices: self.plain_vertices + other.plain_vertices,
            leaf_vertices: self.leaf_vertices + other.leaf_vertices,
            leaf_triangles: self.leaf_triangles + other.leaf_triangles,
            organs: self.organs + other.organs,
            sites: self.sites,
            in_cards: self.in_cards || other.in_cards,
            instanced: Instanced {
                vertices: a.vertices + b.vertices,
                triangles: a.triangles + b.triangles,
                plain_vertices: a.plain_vertices + b.plain_vertices,
                copies: a.copies + b.copies,
            },
        }
    }
}

/// Foliage as few meshes in many places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Instanced {
    /// Vertices and triangles that are not written then, and those of the first that have no pictures.
    pub vertices: u64,
    pub triangles: u64,
    pub plain_vertices: u64,
    /// Places.
    pub copies: u64,
}

impl Instanced {
    /// No instances.
    pub const NONE: Self = Self { vertices: 0, triangles: 0, plain_vertices: 0, copies: 0 };

    /// Counts the organs of a tree, of which there are `times` as many.
    pub fn of(organs: &Organs, times: f64) -> Self {
        let mut sum = Self::default();
        let mut seen = BTreeSet::new();
        for (organ, &prototype) in organs.placed.prototypes.iter().enumerate() {
            sum.copies += 1;
            if !seen.insert(prototype) {
                let mesh = organs.mesh(organ);
                let vertices = mesh.positions.len() as u64;
                sum.vertices += vertices;
                sum.triangles += mesh.triangles.len() as u64;
                sum.plain_vertices += if usize::from(prototype) < PROTOTYPES.len() { vertices } else { 0 };
            }
        }
        let of = |count: u64| (count as f64 * times) as u64;
        Self {
            vertices: of(sum.vertices),
            triangles: of(sum.triangles),
            plain_vertices: of(sum.plain_vertices),
            copies: of(sum.copies),
        }
    }
}
