//! Wind as pivots in pictures: what Unreal's material functions of Pivot Painter 2 read.
//!
//! Each piece of a plant has a texel, and `TEXCOORD_1` of its vertices is the middle of that texel. One picture (half
//! floats) has the pivot and the piece that bears this one, the other (bytes) the direction of the piece and how far it
//! reaches along it. What each number means is taken from:
//!
//! - Epic Games, "Pivot Painter Tool 2.0", "… `MAXScript` Reference" and "… Material Functions" (Unreal Engine's
//!   documentation): the pictures, "Parent Index (Int as float)", "X Extent Divided by 2048" in steps of 8, hierarchies
//!   of four levels and 30,000 elements;
//! - G. Vogiatzis, "Pivot Painter for Blender" (github.com/Gvgeo/Pivot-Painter-for-Blender), which takes the place of
//!   that script: pixels in rows from the top, UV set 1, an index plus 1024 as the bits of a half, a root that is its
//!   own parent, Y turned round;
//! - the Unity port `UnityPivotPainter` (github.com/fancyzero/UnityPivotPainter), which unpacks: bits less 1024, and an
//!   extent of `max(8, 2048 alpha)`.
//!
//! Positions are those of the vertices in Unreal, which takes a glTF's (x, y, z) metres for (x, z, y) · 100.

use std::collections::BTreeSet;

use glam::Vec3;
use linden_pipeline::Monitor;
use linden_pipeline::picture::Picture;
use linden_pipeline::wind::{AxisPivot, PartWind};
use serde::Serialize;

use super::byte_sink::ByteSink;
use crate::options::Options;
use crate::writing::distinct::{DistinctMeshes, MeshPart, PlantModel};
use crate::writing::exr;
use crate::writing::identifier;
use crate::{Bundle, ExportError};

/// The deepest level of axes that are pieces: the material functions turn a piece with three that bear it.
const DEEPEST: u32 = 3;
/// The most pieces; above, the bits of an index are no number any more.
const MOST: usize = 30_000;
/// What an index has more as bits, so that none is subnormal: those become zero on the way.
const INDEX_OFFSET: u16 = 1024;
/// The longest reach, and what a byte of 255 means, centimetres.
const LONGEST_CM: f32 = 2048.0;

/// The pictures of all plants.
pub(super) struct Pivots {
    /// By plant; `None` for one that nothing moves.
    tables: Vec<Option<Table>>,
}

/// What a mesh's extras tell about its pictures.
#[derive(Clone, Serialize)]
pub(super) struct PivotExtras {
    /// File of pivots and parents.
    pivots: String,
    /// File of directions and reaches.
    axes: String,
    /// Texels of each.
    size: [u32; 2],
    /// How many are in use, from the first.
    pieces: usize,
}

/// The texels of a plant.
struct Table {
    /// By axis of the plant the texel that its vertices name.
    texels: Vec<u16>,
    told: PivotExtras,
}

impl Pivots {
    /// Writes the pictures of all plants beside the file, where that was asked for and something moves.
    pub fn write(
        distinct: &DistinctMeshes<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<Option<Self>, ExportError> {
        let is_moved = (0..distinct.plants()).any(|plant| hierarchy(distinct.models_of(plant)).is_some());
        if !options.is_word("wind_as", "pivot-painter") || !is_moved {
            return Ok(None);
        }
        if !bundle.takes_side_files() {
            bundle.note(
                "wind_as=pivot-painter is left out, attributes are written: a single stream has no pictures beside it",
            );
            return Ok(None);
        }
        let (mut tables, mut names) = (Vec::new(), BTreeSet::new());
        let mut long = 0;
        for plant in 0..distinct.plants() {
            let models = distinct.models_of(plant);
            let Some(hierarchy) = hierarchy(models) else {
                tables.push(None);
                continue;
            };
            let name = if distinct.plants() == 1 {
                String::new()
            } else {
                let plain = format!("_{}", identifier(&models[0].scene.name));
                if names.insert(plain.clone()) { plain } else { format!("{plain}_{}", plant + 1) }
            };
            let Some(pieces) = Pieces::of(hierarchy, models) else {
                bundle.note(format!(
                    "wind_as=pivot-painter is left out for '{}': it has more than {MOST} stems",
                    models[0].scene.name
                ));
                tables.push(None);
                continue;
            };
            long += pieces.reaches_cm.iter().filter(|reach_cm| **reach_cm > LONGEST_CM).count();
            tables.push(Some(pieces.write(&name, hierarchy, bundle, monitor)?));
        }
        if long > 0 {
            bundle.note(format!(
                "wind_as=pivot-painter: {long} of the stems and branches reach beyond 20.48 m, the most that the format tells: their \
                 gradient is full from there on"
            ));
        }
        Ok(Some(Self { tables }))
    }

    /// What a plant's meshes tell.
    pub fn told(&self, plant: usize) -> Option<&PivotExtras> {
        self.tables[plant].as_ref().map(|table| &table.told)
    }

    /// Whether vertices of a part name texels.
    pub fn has(&self, plant: usize, wind: &PartWind) -> bool {
        self.tables[plant].is_some() && wind.hierarchy.is_some()
    }

    /// Writes the texel of each vertex, its middle: in 65535ths of the picture where `is_short`.
    pub fn write_uvs(
        &self,
        plant: usize,
        wind: &PartWind,
        is_short: bool,
        out: &mut impl ByteSink,
    ) -> Result<(), ExportError> {
        let Some(Table { texels, told }) = &self.tables[plant] else { return Ok(()) };
        let [width, height] = told.size;
        let middle = |place: u32, of: u32| (place as f32 + 0.5) / of as f32;
        let place = |&axis: &u32| {
            let texel = u32::from(texels[axis as usize]);
            [middle(texel % width, width), middle(texel / width, height)]
        };
        for axes in wind.axes.chunks(1 << 15) {
            let places: Vec<[f32; 2]> = axes.iter().map(place).collect();
            if is_short {
                let short = |x: f32| libm::roundf(x * f32::from(u16::MAX)) as u16;
                let steps: Vec<[u16; 2]> = places.iter().map(|place| place.map(short)).collect();
                out.put(bytemuck::cast_slice(&steps))?;
            } else {
                out.put(bytemuck::cast_slice(&places))?;
            }
        }
        Ok(())
    }
}

/// The axes of a plant that moves.
fn hierarchy<'a>(models: &'a [PlantModel<'_>]) -> Option<&'a [AxisPivot]> {
    parts_of(models).find_map(|part| part.wind?.hierarchy.as_deref())
}

fn parts_of<'a, 'b>(models: &'a [PlantModel<'b>]) -> impl Iterator<Item = &'a MeshPart<'b>> {
    models.iter().flat_map(|model| &model.parts)
}

/// Which axes are pieces.
struct Pieces {
    /// By axis the piece that it belongs to: its own, or that of what bears it.
    of_axis: Vec<u16>,
    /// By piece its axis.
    axes: Vec<usize>,
    /// By piece how far its vertices reach along it.
    reaches_cm: Vec<f32>,
}

impl Pieces {
    /// All axes down to the deepest level with which they are not too many; `None` where stems alone are.
    fn of(hierarchy: &[AxisPivot], models: &[PlantModel<'_>]) -> Option<Self> {
        let count = |deepest: u32| hierarchy.iter().filter(|axis| axis.level <= deepest).count();
        let deepest = (0..=DEEPEST).rev().find(|&deepest| count(deepest) <= MOST)?;
        let (mut of_axis, mut axes) = (Vec::with_capacity(hierarchy.len()), Vec::new());
        for (index, axis) in hierarchy.iter().enumerate() {
            // Finer ones go with what bears them, which comes before.
            let piece = if axis.level <= deepest {
                axes.push(index);
                (axes.len() - 1) as u16
            } else {
                of_axis.get(axis.parent as usize).copied().unwrap_or_default()
            };
            of_axis.push(piece);
        }
        let mut reaches_cm = vec![0.0_f32; axes.len()];
        for part in parts_of(models) {
            let Some(wind) = part.wind else { continue };
            for (&place, &axis) in part.mesh.positions.iter().zip(&wind.axes) {
                let piece = usize::from(of_axis[axis as usize]);
                let AxisPivot { pivot, along, .. } = hierarchy[axes[piece]];
                reaches_cm[piece] = reaches_cm[piece].max(100.0 * (place - pivot).dot(along));
            }
        }
        Some(Self { of_axis, axes, reaches_cm })
    }

    /// Writes the two pictures.
    fn write(
        self,
        name: &str,
        hierarchy: &[AxisPivot],
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<Table, ExportError> {
        let count = self.axes.len() as u32;
        let width = libm::ceil(libm::sqrt(f64::from(count))) as u32;
        let width = width.next_power_of_two();
        let height = count.div_ceil(width).next_power_of_two();
        let texels = (width * height) as usize;
        let (mut pivots, mut directions) = (vec![[0; 4]; texels], vec![[0_u8; 4]; texels]);
        for (piece, &axis) in self.axes.iter().enumerate() {
            let AxisPivot { parent, pivot, along, .. } = hierarchy[axis];
            let [x, y, z] = unreal(100.0 * pivot).to_array().map(exr::half);
            pivots[piece] = [x, y, z, INDEX_OFFSET + self.of_axis[parent as usize]];
            let byte = |x: f32| libm::roundf(x.clamp(0.0, 1.0) * 255.0) as u8;
            let [x, y, z] = unreal(along).to_array().map(|x| byte(0.5 + 0.5 * x));
            // Never shorter than it is, and never 0: importers take the colour away where alpha is.
            let reach = libm::ceilf(self.reaches_cm[piece] / LONGEST_CM * 255.0).clamp(1.0, 255.0);
            directions[piece] = [x, y, z, reach as u8];
        }
        let [pivots_suffix, axes_suffix] = ["_pivots.exr", "_axes.png"].map(|end| format!("{name}{end}"));
        let exr = exr::encode(width, height, &pivots);
        bundle.write_side(&pivots_suffix, Some(exr.len() as u64), monitor, |out| out.write(&exr))?;
        let picture = Picture::new(width, height, directions.into_flattened());
        let png = picture.png().map_err(|error| ExportError::Scene {
            what: format!("picture '{axes_suffix}'"),
            problem: error.to_string(),
        })?;
        bundle.write_side(&axes_suffix, Some(png.len() as u64), monitor, |out| out.write(png))?;
        let told = PivotExtras {
            pivots: bundle.side_name(&pivots_suffix),
            axes: bundle.side_name(&axes_suffix),
            size: [width, height],
            pieces: self.axes.len(),
        };
        Ok(Table { texels: self.of_axis, told })
    }
}

/// From glTF's axes to Unreal's: left-handed, Z up.
fn unreal(place: Vec3) -> Vec3 {
    Vec3::new(place.x, place.z, place.y)
}
