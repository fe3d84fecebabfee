//! Foliage as few meshes in many places: what [`meshes`](super::meshes()) bakes, before it is baked.

use glam::{Mat3, Quat, Vec3};

use super::{DressedOrgans, Look, PROTOTYPES, PlacedOrgans};
use linden_base::memory::bytes_of;
use linden_base::mesh::{Bounds, Mesh};

/// The placed organs of a part: the end of its mesh are copies of a few meshes, and this tells which
/// stand where. What comes before in that mesh are outlines, which are no copies of anything.
///
/// A copy is turned, moved and as large each way. It has the normals of its own face, where the baked
/// one of a kind with dome normals does not.
#[derive(Clone, Debug, PartialEq)]
pub struct Instances {
    dressed: DressedOrgans,
    look: Look,
}

/// One mesh in many places.
#[derive(Debug)]
pub struct Copies<'a> {
    /// Lower-case ASCII identifier, unique within a part: `leaf`, `variant_2`.
    pub name: String,
    /// In units of its own, the foot at the origin; not empty.
    pub mesh: &'a Mesh,
    /// At least one, in the order of the baked copies.
    pub placements: Vec<Placement>,
    /// By placement: the first vertex of the baked copy, among those of all copies of the part, which lie copy by copy.
    pub firsts: Vec<u32>,
}

/// Where a copy stands: scaled, turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Where its foot is, metres.
    pub position: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Size of one unit of the mesh, metres.
    pub scale: f32,
}

impl Placement {
    /// Of what points along `heading` and shows its upper side to `up`: unit vectors, square to each other.
    pub(super) fn new(position: Vec3, heading: Vec3, up: Vec3, scale: f32) -> Self {
        let turn = Quat::from_mat3(&Mat3::from_cols(heading.cross(up), heading, up));
        Self { position, rotation: turn.normalize(), scale }
    }

    pub(super) fn of_placed(placed: &PlacedOrgans, organ: usize) -> Self {
        Self::new(placed.positions[organ], placed.headings[organ], placed.ups[organ], placed.sizes_m[organ])
    }

    /// Where a point of the mesh is, metres.
    pub fn point(&self, local: Vec3) -> Vec3 {
        self.position + self.rotation * (local * self.scale)
    }

    /// The box around the boxes of all copies of a mesh that lies in a box; `None` without placements.
    pub fn bounds(placements: &[Self], of_mesh: Bounds) -> Option<Bounds> {
        let corners = of_mesh.corners();
        Bounds::of(placements.iter().flat_map(|placement| corners.map(|corner| placement.point(corner))))
    }
}

impl Instances {
    /// Those of a look among the organs of a scene.
    pub(crate) fn of(dressed: &DressedOrgans, look: Look) -> Self {
        Self { dressed: dressed.clone(), look }
    }

    /// The meshes that stand somewhere, each with all its places. Takes about 50 ns and
    /// [`Instances::BYTES`] a copy.
    pub fn copies(&self) -> Vec<Copies<'_>> {
        let DressedOrgans { organs, shapes, .. } = &self.dressed;
        let placed = &organs.placed;
        let meshes = PROTOTYPES.len() + shapes.len();
        let sizes: Vec<u32> = PROTOTYPES
            .iter()
            .map(linden_skeleton::organs::Prototype::mesh)
            .chain(shapes.iter().map(|shape| &shape.mesh))
            .map(|mesh| mesh.positions.len() as u32)
            .collect();
        let mut places: Vec<(Vec<Placement>, Vec<u32>)> = vec![Default::default(); meshes];
        let mut vertices = 0;
        for (organ, &prototype) in placed.prototypes.iter().enumerate() {
            if self.look_of(organ) != self.look {
                continue;
            }
            let prototype = usize::from(prototype);
            if let Some((placements, firsts)) = places.get_mut(prototype) {
                placements.push(Placement::of_placed(placed, organ));
                firsts.push(vertices);
                vertices += sizes[prototype];
            }
        }
        let shapes = (1..).zip(shapes.iter()).map(|(number, variant)| {
            let first = shapes.iter().position(|shape| shape.kind == variant.kind).unwrap_or_default();
            (format!("variant_{}", number - first), &variant.mesh)
        });
        let named =
            PROTOTYPES.iter().map(|prototype| (prototype.name.to_owned(), prototype.mesh())).chain(shapes);
        named
            .zip(places)
            .filter(|((_, mesh), (places, _))| !places.is_empty() && !mesh.triangles.is_empty())
            .map(|((name, mesh), (placements, firsts))| Copies { name, mesh, placements, firsts })
            .collect()
    }

    /// Bytes of a [`Placement`], and of which vertex its copy begins with.
    pub const BYTES: u64 = bytes_of::<(Placement, u32)>(1);

    /// No fewer copies than there are.
    pub fn most(&self) -> usize {
        self.dressed.organs.placed.prototypes.len()
    }

    /// Whether the baked copies have normals that point out of the crown.
    pub fn has_dome_normals(&self) -> bool {
        let Look::Kind(kind) = self.look else { return false };
        self.dressed.shapes.iter().any(|shape| shape.is_dome && usize::from(shape.kind) == kind)
    }

    /// As they are sorted when they are baked.
    fn look_of(&self, organ: usize) -> Look {
        let placed = &self.dressed.organs.placed;
        let shape = usize::from(placed.prototypes[organ]).checked_sub(PROTOTYPES.len());
        match shape.and_then(|shape| self.dressed.shapes.get(shape)) {
            Some(shape) => Look::Kind(usize::from(shape.kind)),
            None => Look::Color(self.dressed.color_slot(placed.growth.colors[organ])),
        }
    }
}
