//! What covers the ground of a setting: grass, and leaves that have fallen, as few patches in many places.
//!
//! A patch is some steps wide and holds single blades or leaves; the same few patches, turned and sized at
//! keyed random, lie all over the ground round the plants. They belong to the setting, as sun and ground do:
//! the plants, their recipe and their measures know nothing of them.

mod grass;
mod litter;

use glam::{Quat, Vec2, Vec3};

use super::{Setting, Stage};
use crate::foliage::Placement;
use crate::scene::Material;
use crate::texture::leaf::LeafError;
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::Monitor;
use linden_base::random::Key;

/// A kind of ground cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GroundCover {
    /// A meadow, a hand high.
    Grass,
    /// Leaves of the plants themselves, brown, below and round their crowns.
    Litter,
}

impl GroundCover {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::Grass, Self::Litter];

    /// As it is named on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Grass => "grass",
            Self::Litter => "litter",
        }
    }

    /// The kind with a name.
    ///
    /// # Errors
    /// [`UnknownGroundCover`].
    pub fn parse(name: &str) -> Result<Self, UnknownGroundCover> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name.trim());
        found.ok_or_else(|| UnknownGroundCover(name.chars().filter(|c| !c.is_control()).take(40).collect()))
    }

    /// The kinds whose names stand in a list with commas, each once.
    ///
    /// # Errors
    /// [`UnknownGroundCover`].
    pub fn parse_list(names: &str) -> Result<Vec<Self>, UnknownGroundCover> {
        let mut kinds = names.split(',').map(Self::parse).collect::<Result<Vec<_>, _>>()?;
        kinds.sort_unstable();
        kinds.dedup();
        Ok(kinds)
    }
}

/// A name that no ground cover has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no ground cover: there are grass and litter")]
pub struct UnknownGroundCover(String);

/// A mesh that lies in many places on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundPatch {
    /// What it is a patch of.
    pub kind: GroundCover,
    /// Upper-case identifier, unique within the setting: `Ground_grass_1`.
    pub name: String,
    /// Standing on the plane at height 0, round the origin; not empty.
    pub mesh: Mesh,
    /// Its look.
    pub material: Material,
    /// Where it lies; at least one.
    pub placements: Vec<Placement>,
}

impl GroundPatch {
    /// The box round all its copies, metres.
    pub fn bounds(&self) -> Option<Bounds> {
        Placement::bounds(&self.placements, self.mesh.bounds()?)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let picture = self.material.base_color_picture.as_ref().map_or(0, |picture| picture.bytes());
        self.mesh.bytes() + picture + linden_base::memory::bytes_of::<Placement>(self.placements.len())
    }
}

/// How many places a kind has at most: more of them lie farther apart and are larger.
const MOST_PLACES: f32 = 900.0;
/// Different patches of a kind.
const VARIANTS: usize = 4;
/// No two places are nearer, metres.
const LEAST_SPACING_M: f32 = 0.5;

impl Stage<'_> {
    /// The same with kinds of cover on the ground of its setting, where it has one. Litter needs plants with leaves,
    /// and lies where they stand; with none of them it is left out.
    pub(super) fn on_ground_of(
        mut self,
        kinds: &[GroundCover],
        monitor: &dyn Monitor,
    ) -> Result<Self, LeafError> {
        let Some(setting) = &self.setting else { return Ok(self) };
        let mut covers = Vec::new();
        for kind in GroundCover::ALL.into_iter().filter(|kind| kinds.contains(kind)) {
            covers.extend(match kind {
                GroundCover::Grass => grass::patches(&Meadow::seen_in(setting), Key::new(0).named("grass")),
                GroundCover::Litter => litter::patches(&self, Key::new(0).named("litter"), monitor)?,
            });
        }
        if let Some(setting) = &mut self.setting {
            setting.ground.cover = covers;
        }
        Ok(self)
    }
}

/// A round piece of ground that is to be covered.
#[derive(Clone, Copy, Debug)]
struct Meadow {
    middle: Vec2,
    radius_m: f32,
    /// From place to place.
    spacing_m: f32,
}

impl Meadow {
    /// The ground from behind the camera to as far behind the plants.
    fn seen_in(setting: &Setting) -> Self {
        let camera = &setting.camera;
        let middle = Vec2::new(camera.target.x, camera.target.z);
        let eye = Vec2::new(camera.position.x, camera.position.z);
        Self::new(middle, 1.1 * eye.distance(middle))
    }

    fn new(middle: Vec2, radius_m: f32) -> Self {
        let area_m2 = std::f32::consts::PI * radius_m * radius_m;
        Self { middle, radius_m, spacing_m: libm::sqrtf(area_m2 / MOST_PLACES).max(LEAST_SPACING_M) }
    }

    /// How far a patch reaches from its middle, so that neighbours overlap, metres.
    fn reach_m(&self) -> f32 {
        0.8 * self.spacing_m
    }

    /// Places on a jittered grid (Cook 1986, "Stochastic sampling in computer graphics", section 3), each with its
    /// distance from the middle as a share of the radius.
    fn places(&self, key: Key) -> impl Iterator<Item = (Vec2, f32, Key)> + '_ {
        let steps = libm::ceilf(self.radius_m / self.spacing_m) as i32;
        (-steps..=steps).flat_map(move |row| {
            (-steps..=steps).filter_map(move |column| {
                let key = key.child(row.unsigned_abs().into()).child((row < 0).into());
                let key = key.child(column.unsigned_abs().into()).child((column < 0).into());
                let jitter = |name| key.named(name).between(-0.5, 0.5) as f32;
                let cell = Vec2::new(column as f32 + jitter("x"), row as f32 + jitter("z"));
                let share = cell.length() * self.spacing_m / self.radius_m;
                (share <= 1.0).then_some((self.middle + cell * self.spacing_m, share, key))
            })
        })
    }
}

/// A placement on the ground, turned and sized by chance.
fn lying(at: Vec2, key: Key) -> Placement {
    Placement {
        position: Vec3::new(at.x, 0.0, at.y),
        rotation: Quat::from_rotation_y(key.named("turn").between(0.0, std::f64::consts::TAU) as f32),
        scale: key.named("size").between(0.85, 1.2) as f32,
    }
}

/// One of so many variants.
fn variant(key: Key, of: usize) -> usize {
    ((key.named("variant").unit() * of as f64) as usize).min(of.saturating_sub(1))
}

#[cfg(test)]
mod tests;
