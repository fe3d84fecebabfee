//! Files of plants put together: which file stands where, without any of their meshes.
//!
//! Where a [`Stage`](linden_pipeline::stage::Stage) holds plants, an assembly names files that hold them, so it is
//! small however many there are, and what reads it loads those that it wants:
//!
//! | written as | is |
//! |---|---|
//! | [`Assembly::write_usd`] | an OpenUSD layer with a payload a plant: opens unloaded |
//! | [`AgeSet::write_usd`] | an OpenUSD layer with a variant an age |
//! | [`Assembly::write_tileset`] | a tileset of 3D Tiles 1.1 over glTF files: streams what is near |
//!
//! ```
//! use linden_exporters::{Assembly, Bundle, Member};
//! use linden_pipeline::{Quiet, Vec3, scene::Bounds};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bounds = Bounds { min: Vec3::new(-2.0, 0.0, -2.0), max: Vec3::new(2.0, 9.0, 2.0) };
//! let file = "./fir.usda".to_owned();
//! let fir = Member { index: 0, source: "fir".to_owned(), seed: 7, file, bounds, wind: None };
//! let row = Assembly::side_by_side("firs", vec![fir.clone(), fir]);
//!
//! let folder = tempfile::tempdir()?;
//! let mut bundle = Bundle::create(&folder.path().join("firs.usda"))?;
//! row.write_usd(&mut bundle, &Quiet)?;
//! bundle.commit()?;
//! # Ok(())
//! # }
//! ```

mod ages;
mod tiles;
mod wind_loop;

use glam::{DVec2, DVec3};
use linden_pipeline::Monitor;
use linden_pipeline::scene::Bounds;

pub use ages::{AgeFile, AgeSet};
pub use wind_loop::WindLoop;
pub(crate) use wind_loop::swaying;

use crate::{Bundle, ExportError};

/// Files of plants, and where they stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// For people.
    pub name: String,
    /// The files.
    pub members: Vec<Member>,
    /// Where they stand: a member may stand in many places, or in none.
    pub places: Vec<MemberPlace>,
}

/// A file of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Its number among those that were grown with it; no two members have the same.
    pub index: u64,
    /// What it was grown from.
    pub source: String,
    /// The root of its random choices.
    pub seed: u64,
    /// The file as the assembly names it: relative to the assembly's folder, with slashes, `./` before it.
    pub file: String,
    /// A box around all that the file holds, Y up.
    pub bounds: Bounds,
    /// How long it sways, if it does.
    pub wind: Option<WindLoop>,
}

/// Where a member stands: scaled, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemberPlace {
    /// Which member.
    pub member: usize,
    /// Of its origin, metres, Y up.
    pub position: DVec3,
    /// About the vertical, from +Z to +X.
    pub turn_rad: f64,
    /// How much larger it stands there than it is in its file; above 0.
    pub scale: f64,
}

/// How much more room a plant gets than it needs.
const ROOM: f64 = 1.1;
/// The least width of that room, by the height.
const SLENDER: f64 = 0.2;

impl Assembly {
    /// Each file once, in rows from left to right, the first in front; so far apart that no two overlap.
    pub fn side_by_side(name: impl Into<String>, members: Vec<Member>) -> Self {
        let in_a_row = members.len().saturating_sub(1).isqrt() + 1;
        let mut places = Vec::with_capacity(members.len());
        let mut front = 0.0;
        for row in members.chunks(in_a_row) {
            let (mut left, mut depth) = (0.0, 0.0_f64);
            for Member { bounds, .. } in row {
                let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
                let size = high - low;
                let room = DVec2::new(size.x, size.z).max(DVec2::splat(SLENDER * size.y)) * ROOM;
                let middle = (low + high) / 2.0;
                let position =
                    DVec3::new(left + room.x / 2.0 - middle.x, 0.0, front - room.y / 2.0 - middle.z);
                places.push(MemberPlace { member: places.len(), position, turn_rad: 0.0, scale: 1.0 });
                left += room.x;
                depth = depth.max(room.y);
            }
            front -= depth;
        }
        Self { name: name.into(), members, places }
    }

    /// Writes a tileset of 3D Tiles 1.1: a quadtree whose leaves are the glTF files at their places. 3D Tiles are
    /// Z up: +Y of the places is +Z there, and +Z is -Y.
    ///
    /// # Errors
    /// [`ExportError::Io`] and [`ExportError::Cancelled`].
    pub fn write_tileset(&self, bundle: &mut Bundle, monitor: &dyn Monitor) -> Result<(), ExportError> {
        tiles::write(self, bundle, monitor)
    }

    /// The places that have a member, with it.
    pub(crate) fn placed(&self) -> impl Iterator<Item = (&MemberPlace, &Member)> {
        self.places.iter().filter_map(|place| Some((place, self.members.get(place.member)?)))
    }
}

impl MemberPlace {
    /// A box around what stands here; Y up.
    pub(crate) fn around(&self, bounds: impl Into<Box3>) -> Box3 {
        let Box3 { min, max } = bounds.into();
        let (low, high) = (min * self.scale, max * self.scale);
        let (sin, cos) = libm::sincos(self.turn_rad);
        let corner = |x: f64, z: f64| DVec2::new(cos * x + sin * z, cos * z - sin * x);
        let corners =
            [corner(low.x, low.z), corner(low.x, high.z), corner(high.x, low.z), corner(high.x, high.z)];
        let least = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let most = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        Box3 {
            min: self.position + DVec3::new(least.x, low.y, least.y),
            max: self.position + DVec3::new(most.x, high.y, most.y),
        }
    }
}

/// An axis-aligned box in doubles: places may be far from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box3 {
    pub min: DVec3,
    pub max: DVec3,
}

impl From<Bounds> for Box3 {
    fn from(Bounds { min, max }: Bounds) -> Self {
        Self { min: min.as_dvec3(), max: max.as_dvec3() }
    }
}

impl Box3 {
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn middle(self) -> DVec3 {
        (self.min + self.max) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use linden_pipeline::Vec3;

    use super::*;

    fn member(index: u64, min: [f32; 3], max: [f32; 3]) -> Member {
        let (min, max) = (Vec3::from(min), Vec3::from(max));
        let bounds = Bounds { min, max };
        Member { index, source: "fir".into(), seed: 1, file: format!("./{index}.glb"), bounds, wind: None }
    }

    #[test]
    fn side_by_side_nothing_overlaps_and_all_are_near() {
        let sizes = [[3.0, 5.0], [0.01, 12.0], [8.0, 2.0], [1.0, 1.0], [2.0, 9.0], [0.5, 0.1], [4.0, 4.0]];
        let members: Vec<Member> = (0..)
            .zip(sizes)
            .map(|(index, [wide, high])| member(index, [-wide, 0.0, -0.3 * wide], [0.5 * wide, high, wide]))
            .collect();
        let row = Assembly::side_by_side("all", members);
        let boxes: Vec<Box3> = row.placed().map(|(place, member)| place.around(member.bounds)).collect();
        assert_eq!(boxes.len(), sizes.len());
        for (i, a) in boxes.iter().enumerate() {
            for b in &boxes[..i] {
                let apart = |axis: usize| a.min[axis] >= b.max[axis] || b.min[axis] >= a.max[axis];
                assert!(apart(0) || apart(2), "{a:?} {b:?}");
            }
        }
        let whole = boxes.into_iter().reduce(Box3::union).unwrap();
        assert!((whole.max - whole.min).max_element() < 40.0, "{whole:?}");
        assert_eq!(Assembly::side_by_side("none", Vec::new()).places, []);
    }

    #[test]
    fn a_box_is_around_what_was_turned() {
        let fir = member(0, [-1.0, 0.0, -2.0], [1.5, 6.0, 3.0]);
        let position = DVec3::new(5e5, 200.0, -5e6);
        let place = MemberPlace { member: 0, position, turn_rad: 0.7, scale: 2.0 };
        let found = place.around(fir.bounds);
        let turn = glam::DQuat::from_rotation_y(0.7);
        for x in [-1.0, 1.5] {
            for z in [-2.0, 3.0] {
                let point = position + turn * (DVec3::new(x, 6.0, z) * 2.0);
                assert!(point.cmpge(found.min - 1e-6).all() && point.cmple(found.max + 1e-6).all());
            }
        }
        let size = found.max - found.min;
        // Of a rectangle of a by b, turned: a cos + b sin.
        assert!((size.x - 2.0 * (2.5 * libm::cos(0.7) + 5.0 * libm::sin(0.7))).abs() < 1e-6);
        assert!((size.y - 12.0).abs() < 1e-6);
    }
}
