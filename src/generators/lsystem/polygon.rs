//! Polygons while the turtle draws them, and organs where it places them.

use glam::{DVec3, Vec3};

use super::error::LsystemError;
use super::frame::Frame;
use linden_base::memory::bytes_of;
use linden_skeleton::organs::{MAX_CORNERS, OrganOrigins, Organs};

/// Collects what grows beside the wood.
#[derive(Default)]
pub(super) struct Herbarium {
    organs: Organs,
    /// Polygons that were begun and not filled yet, the innermost last.
    open: Vec<Open>,
    /// Their corners: each has those from its `first` up to the next one's.
    corners: Vec<Vec3>,
}

struct Open {
    first: usize,
    heading: Vec3,
    up: Vec3,
    node: u32,
    color: u32,
}

impl Herbarium {
    /// Whether moves are edges now, instead of wood.
    pub fn is_outlining(&self) -> bool {
        !self.open.is_empty()
    }

    /// How many polygons are open.
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// Bytes that it takes, reserved places included.
    pub fn bytes(&self) -> u64 {
        self.organs.bytes()
            + bytes_of::<Vec3>(self.corners.capacity())
            + bytes_of::<Open>(self.open.capacity())
    }

    /// How many polygons were filled, and how many organs were placed.
    pub fn counts(&self) -> [usize; 2] {
        [self.organs.polygons.ends.len(), self.organs.placed.prototypes.len()]
    }

    /// Whether a list may move to a larger place with the next organ.
    pub fn is_full(&self) -> bool {
        let Organs { polygons, placed, .. } = &self.organs;
        polygons.ends.len() == polygons.ends.capacity()
            || polygons.corners.capacity() - polygons.corners.len() < self.corners.len()
            || placed.prototypes.len() == placed.prototypes.capacity()
    }

    /// `{`
    pub fn begin(&mut self, frame: &Frame, node: u32, color: u32) {
        let (heading, up) = (frame.heading.as_vec3(), frame.up.as_vec3());
        self.open.push(Open { first: self.corners.len(), heading, up, node, color });
    }

    /// An edge of the innermost polygon: where it is the first, it starts at a corner, too.
    pub fn edge(&mut self, from: DVec3, to: DVec3) -> Result<(), LsystemError> {
        let Some(open) = self.open.last() else { return Err(LsystemError::VertexOutside) };
        if open.first == self.corners.len() {
            self.corner(from)?;
        }
        self.corner(to)
    }

    /// `.`
    pub fn corner(&mut self, position: DVec3) -> Result<(), LsystemError> {
        let Some(open) = self.open.last() else { return Err(LsystemError::VertexOutside) };
        if self.corners.len() - open.first == MAX_CORNERS {
            return Err(LsystemError::PolygonTooLarge { limit: MAX_CORNERS });
        }
        self.corners.push(position.as_vec3());
        Ok(())
    }

    /// `}`; a polygon of fewer than three different corners has nothing to fill.
    pub fn end(&mut self, birth: u32) -> Result<(), LsystemError> {
        let Some(open) = self.open.pop() else { return Err(LsystemError::PolygonUnopened) };
        let corners = &self.corners[open.first..];
        if distinct(corners) >= 3 {
            let polygons = &mut self.organs.polygons;
            polygons.corners.extend_from_slice(corners);
            polygons.ends.push(polygons.corners.len() as u32);
            polygons.headings.push(open.heading);
            polygons.ups.push(open.up);
            add(&mut polygons.growth, open.node, open.color, birth);
        }
        self.corners.truncate(open.first);
        Ok(())
    }

    /// An organ of the table.
    pub fn place(&mut self, prototype: u8, size_m: f64, at: DVec3, frame: &Frame, growth: [u32; 3]) {
        let placed = &mut self.organs.placed;
        placed.prototypes.push(prototype);
        placed.positions.push(at.as_vec3());
        placed.headings.push(frame.heading.as_vec3());
        placed.ups.push(frame.up.as_vec3());
        placed.sizes_m.push(size_m as f32);
        let [node, color, birth] = growth;
        add(&mut placed.growth, node, color, birth);
    }

    /// The end of a plant: every polygon is filled.
    pub fn check_closed(&self) -> Result<(), LsystemError> {
        if self.open.is_empty() { Ok(()) } else { Err(LsystemError::PolygonUnclosed) }
    }

    pub fn into_organs(self) -> Organs {
        self.organs
    }
}

fn add(growth: &mut OrganOrigins, node: u32, color: u32, birth: u32) {
    growth.nodes.push(node);
    growth.colors.push(color);
    growth.births.push(birth);
}

/// How many different corners there are, 3 when more.
fn distinct(corners: &[Vec3]) -> usize {
    let Some(&first) = corners.first() else { return 0 };
    let Some(&second) = corners.iter().find(|&&c| c != first) else { return 1 };
    if corners.iter().any(|&c| c != first && c != second) { 3 } else { 2 }
}
