//! Obstacles as they stand: what is inside of them, how shoots turn aside, where their surfaces take light.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use linden_base::input::{Geometry, Inputs};
use linden_base::memory::bytes_of;
use linden_base::mesh::Bounds;
use linden_base::monitor::Monitor;
use linden_crown::cuboid::Cuboid;
use linden_crown::envelope::Envelope;
use linden_crown::placed::PlacedCrown;
use linden_crown::skin::Skin;
use linden_crown::solid::Solid;
use linden_crown::{Crown, shape};
use linden_growth::{Meet, fan};

use crate::error::ObstacleError;
use crate::grow::CENTRE;
use crate::light::Voxel;
use crate::obstacle::{Obstacle, ObstacleSolid};
use crate::{SelfOrganizing, SelfOrganizingError};

/// Places at which an internode of 1 is looked at; thinner walls may be grown through.
const LOOKS: f64 = 8.0;

const DOING: &str = "placing the obstacles of a tree";
const ADVICE: &str = "make them smaller, or raise internode";

/// Solids beside trees, ready to be asked.
#[derive(Clone)]
pub struct Barriers {
    solids: Vec<Barrier>,
    /// Metres in an internode.
    internode_m: f64,
    /// What is to be known of their meshes.
    pub(crate) notes: Vec<String>,
}

#[derive(Clone)]
struct Barrier {
    solid: Arc<dyn Crown>,
    bounds: Bounds,
    meet: Meet,
}

impl Barrier {
    fn holds(&self, place: DVec3) -> bool {
        let Bounds { min, max } = self.bounds;
        place.cmpge(min.as_dvec3()).all() && place.cmple(max.as_dvec3()).all() && self.solid.contains(place)
    }
}

impl Default for Barriers {
    /// None.
    fn default() -> Self {
        Self::none()
    }
}

impl Barriers {
    /// None.
    pub const fn none() -> Self {
        Self { solids: Vec::new(), internode_m: 1.0, notes: Vec::new() }
    }

    /// The obstacles of some settings, with the files that they name.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: a file that is missing or no mesh, a solid that encloses nothing, cancelled.
    pub fn new(
        settings: &SelfOrganizing,
        inputs: &Inputs,
        monitor: &dyn Monitor,
    ) -> Result<Self, SelfOrganizingError> {
        let mut all = Self { internode_m: settings.internode_m, ..Self::default() };
        let mut meshes: Vec<(&str, Arc<Envelope>)> = Vec::new();
        for (number, obstacle) in (1..).zip(&settings.obstacles) {
            monitor.check()?;
            let failed = |problem| match problem {
                ObstacleError::Cancelled(cancelled) => SelfOrganizingError::Cancelled(cancelled),
                problem => SelfOrganizingError::Obstacle { number, what: obstacle.describe(), problem },
            };
            let (crown, foot) = match &obstacle.solid {
                ObstacleSolid::Box(size) => {
                    (Box::new(Cuboid { size: DVec3::from(*size) }) as Box<dyn Crown>, None)
                }
                ObstacleSolid::Solid(Solid::Shape { shape: id, dimensions }) => {
                    let crown = shape(id).and_then(|shape| shape.of(dimensions));
                    (crown.map_err(|error| failed(error.into()))?, None)
                }
                ObstacleSolid::Solid(Solid::Mesh { file }) => {
                    let known =
                        meshes.iter().find(|(name, _)| name == file).map(|(_, mesh)| Arc::clone(mesh));
                    let mesh = match known {
                        Some(mesh) => mesh,
                        None => {
                            let mesh = Arc::new(envelope(file, inputs, monitor).map_err(failed)?);
                            let warnings = mesh.report().warnings();
                            all.notes.extend(
                                warnings.into_iter().map(|note| format!("obstacle {number}: {note}")),
                            );
                            meshes.push((file, Arc::clone(&mesh)));
                            mesh
                        }
                    };
                    let foot = mesh.foot();
                    (Box::new(mesh) as Box<dyn Crown>, Some(foot))
                }
            };
            let at = obstacle.at.map(DVec3::from).or(foot).unwrap_or_default();
            let solid: Arc<dyn Crown> =
                Arc::new(PlacedCrown::new(crown, at, obstacle.turn_deg, obstacle.scale));
            all.solids.push(Barrier { bounds: solid.bounds(), solid, meet: obstacle.meet });
        }
        Ok(all)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Whether a place, metres, is inside of one.
    pub fn hold(&self, place: DVec3) -> bool {
        self.solids.iter().any(|barrier| barrier.holds(place))
    }

    /// Polylines that draw them, metres.
    pub(crate) fn outline(&self) -> Vec<Vec<Vec3>> {
        self.solids.iter().flat_map(|barrier| barrier.solid.outline()).collect()
    }

    /// Triangles that draw them, metres.
    pub(crate) fn skins(&self) -> Vec<Skin> {
        self.solids.iter().map(|barrier| barrier.solid.skin()).collect()
    }

    /// Which of them holds a place in voxels, as it is once it is rounded to metres.
    fn of_voxels(&self, place: DVec3) -> impl Iterator<Item = &Barrier> {
        let place = in_metres(place.as_vec3(), self.internode_m).as_dvec3();
        self.solids.iter().filter(move |barrier| barrier.holds(place))
    }

    /// Whether a node may stand at a place in voxels.
    pub(crate) fn bar(&self, place: DVec3) -> bool {
        !self.is_empty() && self.of_voxels(place).next().is_some()
    }

    /// What an internode meets that leads from one place in voxels to another.
    fn met(&self, from: DVec3, to: DVec3) -> Option<Meet> {
        let looks = libm::ceil((to - from).length() * LOOKS).max(1.0);
        let place = |look: u32| from.lerp(to, f64::from(look) / looks);
        let met = |look| self.of_voxels(place(look)).map(|barrier| barrier.meet);
        let mut all = (1..=looks as u32).flat_map(met);
        let first = all.next()?;
        Some(if first == Meet::Stop || all.any(|meet| meet == Meet::Stop) {
            Meet::Stop
        } else {
            Meet::Around
        })
    }

    /// The direction in which an internode leads that would lead in a unit `direction` from a place in voxels, as
    /// near to that as may be; `None` where it ends.
    pub(crate) fn turned(&self, from: DVec3, direction: DVec3, length: f64) -> Option<DVec3> {
        if self.is_empty() {
            return Some(direction);
        }
        let met = |direction: DVec3| self.met(from, from + direction * length);
        match met(direction) {
            None => Some(direction),
            Some(Meet::Stop) => None,
            Some(Meet::Around) => fan(direction).find(|&aside| met(aside).is_none()),
        }
    }

    /// The voxels above the ground that their surfaces pass through, sorted; a voxel has an edge of `edge` internodes, and
    /// `offset` is what is added to places in internodes first. What is inside needs none: nothing grows there, and all light
    /// comes through the surface.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: too little memory, cancelled.
    pub(crate) fn surface(
        &self,
        edge: i32,
        offset: DVec3,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Voxel>, SelfOrganizingError> {
        let mut voxels: Vec<Voxel> = Vec::new();
        let mut of_triangle: Vec<Voxel> = Vec::new();
        for skin in self.skins() {
            let corner = |corner: u32| {
                (skin.positions[corner as usize].as_dvec3() / self.internode_m + offset) / f64::from(edge)
            };
            for (number, triangle) in skin.triangles.iter().enumerate() {
                if number % 256 == 0 {
                    monitor.check()?;
                }
                let [a, b, c] = triangle.map(corner);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                // A place in half a voxel in each direction.
                let steps = libm::ceil(2.0 * longest).max(1.0);
                let places = 0.5 * (steps + 1.0) * (steps + 2.0);
                let bytes = |count: f64| (count * size_of::<Voxel>() as f64) as u64;
                // Lists may move to places twice as large.
                monitor.admit(DOING, bytes(places) + 2 * bytes_of::<Voxel>(voxels.len()), ADVICE)?;
                of_triangle.clear();
                for i in 0..=steps as u32 {
                    for j in 0..=(steps as u32 - i) {
                        let (along, across) = (f64::from(i) / steps, f64::from(j) / steps);
                        let place = a + (b - a) * along + (c - a) * across;
                        let voxel = place.to_array().map(|at| libm::floor(at) as i32);
                        if voxel[1] >= 0 && of_triangle.last() != Some(&voxel) {
                            of_triangle.push(voxel);
                        }
                    }
                }
                of_triangle.sort_unstable();
                of_triangle.dedup();
                voxels.append(&mut of_triangle);
            }
        }
        voxels.sort_unstable();
        voxels.dedup();
        Ok(voxels)
    }
}

/// A place in voxels as the grown tree has it.
pub(crate) fn in_metres(place: Vec3, internode_m: f64) -> Vec3 {
    ((place.as_dvec3() - CENTRE) * internode_m).as_vec3()
}

fn envelope(file: &str, inputs: &Inputs, monitor: &dyn Monitor) -> Result<Envelope, ObstacleError> {
    let Some((Geometry::Mesh(mesh), up)) = inputs.get(file).map(|input| (&input.geometry, input.up)) else {
        return Err(ObstacleError::NoMesh);
    };
    let mut mesh = (**mesh).clone();
    up.to_y_up(&mut mesh.positions);
    Ok(Envelope::new(&mesh, monitor)?)
}

impl Obstacle {
    /// Whether it stands where its file has it.
    pub fn is_unplaced(&self) -> bool {
        self.at.is_none() && self.file().is_some()
    }
}
