//! The light that buds get, in one way or the other.

use glam::{DVec3, Vec3};
use linden_base::memory::OverMemory;
use linden_base::monitor::Monitor;

use crate::barriers::Barriers;
use crate::grow::CENTRE;
use crate::shadow::{Change, Shadow};
use crate::sky::Sky;
use crate::tree::Nodes;
use crate::{LightModel, SelfOrganizing, SelfOrganizingError};

/// The light of an open place, in whole parts: sums are the same in any order.
pub(crate) const FULL_LIGHT: u32 = 1 << 16;

/// A voxel's place.
pub(crate) type Voxel = [i32; 3];

/// The light of trees as they stand.
#[derive(Clone, Debug)]
pub(crate) enum Light {
    Shadow(Shadow),
    Sky(Sky),
}

impl Light {
    pub fn new(settings: &SelfOrganizing) -> Self {
        match settings.light {
            LightModel::Shadow => Self::Shadow(Shadow::new(settings)),
            LightModel::Sky => Self::Sky(Sky::new(settings)),
        }
    }

    /// Obstacles stand there from now on. For shadow, those parts alone that trees on some feet, metres, may come to.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: too little memory, cancelled.
    pub fn stand_behind(
        &mut self,
        barriers: &Barriers,
        settings: &SelfOrganizing,
        feet: &[Vec3],
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        if barriers.is_empty() {
            return Ok(());
        }
        match self {
            Self::Shadow(shadow) => {
                let reach = f64::from(settings.years_grown()) * settings.longest_shoot
                    + 2.0 * f64::from(settings.shade_depth + 2);
                let near = |voxel: &Voxel| {
                    let at = DVec3::from(voxel.map(f64::from));
                    let is_near = |foot: &Vec3| {
                        let foot = foot.as_dvec3() / settings.internode_m;
                        (at.x - foot.x).abs() <= reach && (at.z - foot.z).abs() <= reach && at.y <= reach
                    };
                    feet.iter().any(is_near)
                };
                let surface = barriers.surface(1, CENTRE, monitor)?;
                let change = |voxel| Change { voxel, is_gone: false };
                let mut changes: Vec<Change> = surface.into_iter().filter(near).map(change).collect();
                shadow.grid.change(&mut changes, &shadow.pyramid, monitor)?;
                Ok(())
            }
            Self::Sky(sky) => sky.stand_behind(barriers, monitor),
        }
    }

    /// A year begins: what is worked out from all nodes is.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: too little memory, cancelled.
    pub fn begin(
        &mut self,
        nodes: &Nodes,
        year: u32,
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        match self {
            Self::Shadow(_) => Ok(()),
            Self::Sky(sky) => sky.shine(nodes, year, monitor),
        }
    }

    /// The light of a bud at a node, of [`FULL_LIGHT`].
    pub fn at(&self, nodes: &Nodes, node: usize) -> u32 {
        match self {
            Self::Shadow(shadow) => shadow.light(nodes, node),
            Self::Sky(sky) => sky.light(nodes, node),
        }
    }

    /// The direction in which there is more light, of length 1; zero where all are alike.
    pub fn brighter(&self, nodes: &Nodes, node: usize) -> DVec3 {
        match self {
            Self::Shadow(shadow) => shadow.brighter(nodes.voxel(node)),
            Self::Sky(sky) => sky.brighter(nodes, node),
        }
    }

    /// Takes in what came, went or moved.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn change(&mut self, changes: &mut [Change], monitor: &dyn Monitor) -> Result<(), OverMemory> {
        match self {
            Self::Shadow(shadow) => shadow.grid.change(changes, &shadow.pyramid, monitor),
            Self::Sky(_) => Ok(()),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Shadow(shadow) => shadow.grid.bytes(),
            Self::Sky(sky) => sky.bytes(),
        }
    }

    #[cfg(test)]
    pub fn shadow(&mut self) -> &mut Shadow {
        match self {
            Self::Shadow(shadow) => shadow,
            Self::Sky(_) => panic!("light comes from the sky"),
        }
    }
}

/// A monitor of a machine with little memory.
#[cfg(test)]
pub(crate) struct Small;

#[cfg(test)]
impl Monitor for Small {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: linden_base::monitor::Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        100_000
    }
}
