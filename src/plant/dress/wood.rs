//! The wood in its barks: swept, parted by thickness, with relief and moss on it.

use glam::{Vec2, Vec3};

use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_skeleton::{AxisKind, Skeleton};

use super::bark::{bark_material, foot_m, has_dead, heights, stretch};
use super::{BLOWING, BLOWING_ADVICE, DEAD, DressError, Wardrobe};
use crate::foot_bark::{self, Foot};
use crate::moss::{self, Mossy};
use crate::scene::{Material, Part};
use crate::settings::Dressing;
use crate::surface::relief::{self, Heights, ReliefError};
use crate::surface::{self, Junction, SurfaceError};
use crate::wind::Blown;
use crate::wood_parts::{self, Cuts};
use crate::{Body, Specimen};

/// For messages about memory.
const PARTING: &str = "parting the wood by its bark";
const PARTING_ADVICE: &str =
    "lower sides, or let all wood have one bark (limb_radius=0, foot_height=0, moss=0)";

/// What is known of a triangle of the trunk: the number that [`Foot::numbers`] gives it, and whether the wood is thick
/// enough for moss.
const FOOT: u8 = 3;
const THICK: u8 = 4;
/// Wood that hangs as low as the foot's bark has it from this thickness on, in radii of the foot: it is young.
const FOOT_RADII: f32 = 1.0 / 4.0;

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
        let (mut parts, mut marks) = self.by_thickness(wood, specimen, skeleton, monitor)?;
        if let Some(trunk) = parts.first_mut().filter(|part| part.material == 0) {
            stretch(&mut trunk.mesh, &self.trunk.bark);
        }
        if let Some(heights) = heights(specimen, blown.is_some()) {
            lay(&heights, (&mut parts, &mut marks), specimen, skeleton, monitor)?;
        }
        let mut materials = vec![self.trunk.bark.clone()];
        if parts.iter().any(|part| part.material > 0) {
            materials.extend(self.thin_barks.iter().map(|(_, _, bark)| bark.clone()));
            let color = specimen.dressing.bark.dead_color;
            let dead = || bark_material(format!("bark_{DEAD}"), color, None);
            materials.extend(has_dead(skeleton).then(dead));
        }
        self.part_trunk(&mut parts, &mut materials, &marks, specimen, skeleton, monitor)?;
        Ok((parts, materials))
    }

    /// The wood, in as many parts as it has barks, and for each triangle of the first what it is thick enough for, where
    /// that has anything to bear. A solid has no tubes to tell thick from thin: it is one, and bare.
    fn by_thickness(
        &self,
        wood: Part,
        specimen: &Specimen<'_>,
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<Part>, Vec<u8>), SurfaceError> {
        let Dressing { tubes, bark, .. } = specimen.dressing;
        let is_whole = self.cuts == Cuts::None;
        let (has_moss, has_foot) =
            (!is_whole && !self.trunk.mossy.is_empty(), !is_whole && !self.foot.is_empty());
        let has_dead = has_dead(skeleton);
        let is_plain = self.thin_barks.is_empty() && !has_moss && !has_foot && !has_dead;
        if is_plain || tubes.junction == Junction::Watertight {
            return Ok((vec![wood], Vec::new()));
        }
        let counts = surface::count(skeleton, tubes, monitor)?;
        // Of each triangle whether it is thin, and what it is thick enough for.
        let bytes = 3 * wood.mesh.triangles.len() as u64;
        monitor.admit(
            PARTING,
            wood.bytes() + wood_parts::bytes_for(&wood) + std::mem::size_of_val(&counts[..]) as u64 + bytes,
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
        let foot_radius_m = skeleton.foot_radius_m();
        let is_thicker = |least_m: f32| -> Result<Vec<bool>, SurfaceError> {
            let thin = surface::classes(&wood.mesh, &counts, skeleton, &[least_m], monitor)?;
            Ok(thin.into_iter().map(|thin| thin == 0).collect())
        };
        let mut marks = vec![0; if has_moss || has_foot { classes.len() } else { 0 }];
        if let Some(foot) = Foot::of(tubes, foot_m(skeleton)).filter(|_| has_foot) {
            let numbers = foot.numbers(&wood.mesh, &counts, skeleton, monitor)?;
            let worn = numbers.into_iter().zip(is_thicker(FOOT_RADII * foot_radius_m)?);
            marks.iter_mut().zip(worn).for_each(|(mark, (number, is))| *mark = if is { number } else { 0 });
        }
        if has_moss {
            let thick = is_thicker(bark.moss.least_radius_m(foot_radius_m))?;
            marks.iter_mut().zip(thick).for_each(|(mark, is)| *mark |= if is { THICK } else { 0 });
        }
        let mut of = classes.iter();
        marks.retain(|_| of.next() == Some(&0));
        if limits_m.is_empty() && !has_dead {
            return Ok((vec![wood], marks));
        }
        let names = self.thin_barks.iter().map(|(name, _, _)| *name).chain(has_dead.then_some(DEAD));
        let names: Vec<&str> = names.collect();
        Ok((wood_parts::cut(&wood, &classes, &names), marks))
    }

    /// Parts the trunk where its foot has a bark of its own, and each piece by how much moss is on it, as the `marks` of
    /// its triangles say.
    fn part_trunk(
        &self,
        parts: &mut Vec<Part>,
        materials: &mut Vec<Material>,
        marks: &[u8],
        specimen: &Specimen<'_>,
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<(), SurfaceError> {
        let trunk = parts.first().filter(|part| part.material == 0 && !marks.is_empty());
        let Some(trunk) = trunk else { return Ok(()) };
        let parted: u64 = parts.iter().map(Part::bytes).sum();
        let cuts = 1 + u64::from(!self.foot.is_empty());
        monitor.admit(PARTING, parted + cuts * moss::bytes_to_cut(trunk), PARTING_ADVICE)?;
        let foot_m = foot_m(skeleton);
        let mossy = Mossy::on(specimen, foot_m, skeleton.foot_radius_m());
        let all = parts.iter().map(|part| part.mesh.triangles.len()).sum();
        // Moss covers the whole trunk, whatever its barks.
        let is_thick: Vec<bool> = marks.iter().map(|mark| mark & THICK > 0).collect();
        let covering = mossy.cover(&trunk.mesh, &is_thick, (self.cuts, all));
        let foot = Foot::of(&specimen.dressing.tubes, foot_m);
        let trunk = parts.remove(0);
        let mut cut = Vec::new();
        for (mut part, number) in by_foot(trunk, marks) {
            let coat = match number.checked_sub(1).map(usize::from) {
                None => &self.trunk,
                Some(coat) => {
                    part.material = materials.len();
                    materials.push(self.foot[coat].bark.clone());
                    &self.foot[coat]
                }
            };
            if let Some(foot) = foot.as_ref().filter(|_| number == foot_bark::EDGE) {
                foot.stretch(&mut part.mesh);
            }
            let its = covering.steps.iter().zip(marks).filter(|(_, mark)| *mark & FOOT == number);
            let its: Vec<u8> = its.map(|(step, _)| *step).collect();
            if its.iter().all(|step| *step == 0) {
                cut.push(part);
                continue;
            }
            cut.extend(covering.cut(&part, &its, materials.len()));
            materials.extend(covering.kept.iter().map(|&step| coat.mossy[step].clone()));
        }
        parts.splice(..0, cut);
        Ok(())
    }
}

/// The trunk with its own bark, then that with the foot's and the edge, as far as there are any; each with its number.
fn by_foot(trunk: Part, marks: &[u8]) -> Vec<(Part, u8)> {
    let numbers: Vec<u8> = marks.iter().map(|mark| mark & FOOT).collect();
    if numbers.iter().all(|number| *number == 0) {
        return vec![(trunk, 0)];
    }
    let parts = wood_parts::cut(&trunk, &numbers, &foot_bark::NAMES);
    let number = |part: Part| {
        let number = part.material as u8;
        (part, number)
    };
    parts.into_iter().map(number).collect()
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

/// Lays the relief of the bark on the trunk, where wood has that bark or the foot's.
fn lay(
    (trunk, foot): &(Heights, Option<Heights>),
    (parts, marks): (&mut [Part], &mut Vec<u8>),
    specimen: &Specimen<'_>,
    skeleton: &Skeleton,
    monitor: &dyn Monitor,
) -> Result<(), ReliefError> {
    let wood = parts.split_first_mut().filter(|(part, _)| part.material == 0);
    let Some((wood, thin)) = wood else { return Ok(()) };
    let Dressing { bark, tubes, .. } = specimen.dressing;
    let foot_m = foot_m(skeleton);
    let of_foot = foot.as_ref().zip(Foot::of(tubes, foot_m));
    let offset = |place: Vec3, uv: Vec2| match &of_foot {
        None => trunk.offset(uv),
        Some((heights, foot)) => {
            let share = foot.share(place.y);
            (1.0 - share) * trunk.offset(uv) + share * heights.offset(uv)
        }
    };
    // Roots go below it.
    let ground_m = (tubes.features.roots.count > 0).then_some(foot_m);
    let thin: Vec<&Mesh> = thin.iter().map(|part| &part.mesh).collect();
    relief::lay(&mut wood.mesh, &thin, offset, (ground_m, bark.relief_height_m), marks, monitor)
}
