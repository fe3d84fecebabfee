//! The wood in its barks: swept, parted by thickness, with relief and moss on it.

use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_skeleton::{AxisKind, Skeleton};

use super::bark::{bark_material, foot_m, has_dead, heights, stretch};
use super::{BLOWING, BLOWING_ADVICE, DEAD, DressError, Wardrobe};
use crate::moss::{self, MossSteps, Mossy};
use crate::scene::{Material, Part};
use crate::settings::Dressing;
use crate::surface::relief::{self, Heights, ReliefError};
use crate::surface::{self, Junction, SurfaceError};
use crate::wind::Blown;
use crate::wood_parts;
use crate::{Body, Specimen};

/// For messages about memory.
const PARTING: &str = "parting the wood by its bark";
const PARTING_ADVICE: &str = "lower sides, or let all wood have one bark (limb_radius=0, moss=0)";

impl Wardrobe {
    /// The parts of the wood and their materials.
    pub(super) fn wood(
        &self,
        specimen: &Specimen<'_>,
        body: Body<'_>,
        blown: Option<Blown<'_>>,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<Part>, Vec<Material>), DressError> {
        let skeleton = body.skeleton;
        let wood = swept(specimen, skeleton, blown, monitor)?;
        let (mut parts, mut is_thick) = self.by_thickness(wood, specimen, skeleton, monitor)?;
        if let Some(trunk) = parts.first_mut().filter(|part| part.material == 0) {
            stretch(&mut trunk.mesh, &self.bark);
        }
        if let Some(heights) = heights(specimen, blown.is_some()) {
            lay(&heights, (&mut parts, &mut is_thick), specimen, skeleton, monitor)?;
        }
        let mut materials = vec![self.bark.clone()];
        if parts.iter().any(|part| part.material > 0) {
            materials.extend(self.thin_barks.iter().map(|(_, _, bark)| bark.clone()));
            let color = specimen.dressing.bark.dead_color;
            let dead = || bark_material(format!("bark_{DEAD}"), color, None);
            materials.extend(has_dead(skeleton).then(dead));
        }
        self.cover_with_moss(&mut parts, &mut materials, &is_thick, specimen, skeleton, monitor)?;
        Ok((parts, materials))
    }

    /// The wood, in as many parts as it has barks, and for each triangle of the first whether it is thick enough for
    /// moss, where any grows. A solid has no tubes to tell thick from thin: it is one, and bare.
    fn by_thickness(
        &self,
        wood: Part,
        specimen: &Specimen<'_>,
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<Part>, Vec<bool>), SurfaceError> {
        let Dressing { tubes, bark, .. } = specimen.dressing;
        let is_bare = self.mossy.is_empty() || self.moss_steps == MossSteps::None;
        let has_dead = has_dead(skeleton);
        if self.thin_barks.is_empty() && is_bare && !has_dead || tubes.junction == Junction::Watertight {
            return Ok((vec![wood], Vec::new()));
        }
        let counts = surface::count(skeleton, tubes, monitor)?;
        // Of each triangle whether it is thin, and whether it is thick: moss grows there.
        let marks = 2 * wood.mesh.triangles.len() as u64;
        monitor.admit(
            PARTING,
            wood.bytes() + wood_parts::bytes_for(&wood) + std::mem::size_of_val(&counts[..]) as u64 + marks,
            PARTING_ADVICE,
        )?;
        let limits_m: Vec<f32> = self.thin_barks.iter().map(|(_, radius_m, _)| *radius_m).collect();
        let mut classes = surface::classes(&wood.mesh, &counts, skeleton, &limits_m, monitor)?;
        if has_dead {
            let dead = limits_m.len() as u8 + 1;
            let mut first = 0;
            for (axis, amount) in counts.iter().enumerate() {
                if skeleton.kind_of(axis) == AxisKind::Dead {
                    classes[first..first + amount.triangles].fill(dead);
                }
                first += amount.triangles;
            }
        }
        let mut is_thick = Vec::new();
        if !is_bare {
            let least_m = bark.moss.least_radius_m(skeleton.foot_radius_m());
            let thin = surface::classes(&wood.mesh, &counts, skeleton, &[least_m], monitor)?;
            let of_trunk = classes.iter().zip(thin).filter(|(class, _)| **class == 0);
            is_thick = of_trunk.map(|(_, thin)| thin == 0).collect();
        }
        if limits_m.is_empty() && !has_dead {
            return Ok((vec![wood], is_thick));
        }
        let names = self.thin_barks.iter().map(|(name, _, _)| *name).chain(has_dead.then_some(DEAD));
        let names: Vec<&str> = names.collect();
        Ok((wood_parts::cut(&wood, &classes, &names), is_thick))
    }

    /// Parts the trunk by how much moss is on it, where it `is_thick` enough for any.
    fn cover_with_moss(
        &self,
        parts: &mut Vec<Part>,
        materials: &mut Vec<Material>,
        is_thick: &[bool],
        specimen: &Specimen<'_>,
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<(), SurfaceError> {
        let trunk = parts.first().filter(|part| part.material == 0 && !is_thick.is_empty());
        let Some(trunk) = trunk else { return Ok(()) };
        let parted: u64 = parts.iter().map(Part::bytes).sum();
        monitor.admit(PARTING, parted + moss::bytes_to_cut(trunk), PARTING_ADVICE)?;
        let mossy = Mossy::on(specimen, foot_m(skeleton), skeleton.foot_radius_m());
        let all = parts.iter().map(|part| part.mesh.triangles.len()).sum();
        let (cut, kept) = mossy.cut(trunk, is_thick, materials.len(), (self.moss_steps, all));
        parts.splice(..1, cut);
        materials.extend(kept.into_iter().map(|step| self.mossy[step].clone()));
        Ok(())
    }
}

/// The wood as one mesh, in the wind where there is any.
fn swept(
    specimen: &Specimen<'_>,
    skeleton: &Skeleton,
    blown: Option<Blown<'_>>,
    monitor: &dyn Monitor,
) -> Result<Part, SurfaceError> {
    let tubes = &specimen.dressing.tubes;
    let mut wood = Part::new("wood", 0, surface::sweep(skeleton, tubes, monitor)?);
    if let Some(blown) = blown {
        let bytes = wood.bytes() + blown.field.bytes_for(wood.mesh.positions.len());
        monitor.admit(BLOWING, bytes, BLOWING_ADVICE)?;
        let tubes = surface::count(skeleton, tubes, monitor)?;
        wood.wind = Some(blown.wood(&wood.mesh, &tubes, monitor)?);
    }
    Ok(wood)
}

/// Lays the relief of the bark on the trunk, where wood has that bark.
fn lay(
    heights: &Heights,
    (parts, is_thick): (&mut [Part], &mut Vec<bool>),
    specimen: &Specimen<'_>,
    skeleton: &Skeleton,
    monitor: &dyn Monitor,
) -> Result<(), ReliefError> {
    let trunk = parts.split_first_mut().filter(|(part, _)| part.material == 0);
    let Some((trunk, thin)) = trunk else { return Ok(()) };
    let Dressing { bark, tubes, .. } = specimen.dressing;
    // Roots go below it.
    let ground_m = (tubes.features.roots.count > 0).then(|| foot_m(skeleton));
    let thin: Vec<&Mesh> = thin.iter().map(|part| &part.mesh).collect();
    relief::lay(&mut trunk.mesh, &thin, heights, (ground_m, bark.relief_height_m), is_thick, monitor)
}
