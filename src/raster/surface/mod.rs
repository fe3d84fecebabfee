//! Meshes, shaded: a depth buffer, several samples a pixel, light per vertex.
//!
//! What is too thin for samples to find it reliably is not left to them: wood that looks thinner
//! than a hair is drawn from the skeleton, as strokes that fade ([`crate::skeleton`] has the same),
//! and its triangles are left out. So twigs neither vanish nor sparkle when the camera turns.

mod samples;
mod stage;
#[cfg(test)]
mod tests;
mod texels;
mod triangles;

use glam::Vec3;
use linden_pipeline::dress::thinnest_barks;
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Part, Scene};
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};

pub use self::stage::{draw_stage, stage_extent};

use self::samples::Samples;
use self::triangles::Triangles;
use crate::backdrop::Backdrop;
use crate::canvas;
use crate::light::{Air, sun};
use crate::memory::{Ledger, picture_bytes};
use crate::shade::Cells;
use crate::skeleton::{check, framed};
use crate::strokes::paint::BRUSH_BYTES_PER_PIXEL;
use crate::strokes::trace::{self, Tracer};
use crate::strokes::{Runs, overlay};
use crate::style::foot;
use crate::{Camera, Extent, RasterError, Size, Style};

/// Parts of a scene to be drawn, and what belongs to them.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// The meshes.
    pub parts: &'a [Part],
    /// Parts refer to these by index.
    pub materials: &'a [Material],
    /// The axial tree that the wood was swept from: it frames the picture, and where the wood is
    /// thinner than a hair it is drawn instead. May be empty; then the meshes are all there is.
    pub skeleton: &'a Skeleton,
}

impl<'a> From<&'a Scene> for Surface<'a> {
    fn from(scene: &'a Scene) -> Self {
        Self { parts: &scene.parts, materials: &scene.materials, skeleton: &scene.skeleton }
    }
}

/// Draws a surface in the colours of its materials, framed as [`crate::draw_skeleton`] frames its
/// skeleton. [`Style::paint`] and [`Style::until`] mean nothing here.
///
/// Where the skeleton stands on its foot, wood that is lower is in the ground: it is not seen from above.
///
/// # Errors
/// [`RasterError::Empty`] with neither triangles nor nodes; [`RasterError::Mesh`] with the first
/// part that cannot be drawn; those of the skeleton; [`RasterError::Cancelled`] soon after the
/// monitor is.
pub fn draw_surface(
    surface: &Surface,
    camera: &Camera,
    style: &Style,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    draw_on_ground(surface, ground_m(surface.skeleton), camera, style, size, monitor)
}

/// The height that a plant stands on: `None` where anything but the foot of a stem is lowest.
pub(crate) fn ground_m(skeleton: &Skeleton) -> Option<f32> {
    let foot_m = foot(skeleton)?.y;
    let stands = |(parent, place): (&u32, &Vec3)| *parent == NO_PARENT && place.y <= foot_m;
    skeleton.parents.iter().zip(&skeleton.positions).any(stands).then_some(foot_m)
}

/// As [`draw_surface`], with the ground at a height.
fn draw_on_ground(
    surface: &Surface,
    ground_m: Option<f32>,
    camera: &Camera,
    style: &Style,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    let has_skeleton = !surface.skeleton.positions.is_empty();
    if has_skeleton {
        check(surface.skeleton)?;
    }
    for (i, part) in surface.parts.iter().enumerate() {
        monitor.check()?;
        triangles::check(part, surface.materials).ok_or(RasterError::Mesh(i))?;
    }
    let vertices = || surface.parts.iter().flat_map(|part| &part.mesh.positions).copied();
    let (tree_extent, foot) = if let (Some(tree_extent), Some(foot)) =
        (style.extent_without_person(surface.skeleton).filter(|_| has_skeleton), foot(surface.skeleton))
    {
        (tree_extent, foot)
    } else {
        let all: Vec<Vec3> = vertices().collect();
        let lowest = vertices().reduce(|a, b| if b.y < a.y { b } else { a });
        let tree_extent = Extent::of(surface.skeleton, &all).ok_or(RasterError::Empty)?;
        let lowest = lowest.ok_or(RasterError::Empty)?;
        (tree_extent, ground_m.map_or(lowest, |ground_m| lowest.with_y(ground_m)))
    };
    let framed = framed(camera, style, tree_extent, foot);
    let view = camera.view(framed, size);
    let cells = Cells::around(&tree_extent, style.draft);
    for part in surface.parts {
        cells.add_part(part, &surface.materials[part.material]);
    }
    monitor.check()?;
    let air = Air::new(&tree_extent, &view, style, cells.lit(sun(&view)), 1.0);
    let shadow = style.ground_shadow.then(|| air.shade().shadow_on(foot.y));

    let ledger = Ledger::new(monitor);
    let factor = samples_per_side(size, style.draft);
    let samples = samples::BYTES * u64::from(factor * factor);
    // Strokes and triangles come and stay; the bands are asked for beside them before they are made.
    let bands = canvas::band_bytes(size, BRUSH_BYTES_PER_PIXEL + samples);
    ledger.take(
        picture_bytes(size)
            + bands
            + overlay::bytes(style)
            + trace::bytes(surface.skeleton, style)
            + Cells::bytes(),
    )?;
    let mut pieces = Vec::new();
    if has_skeleton {
        let [bark, dead] = thinnest_barks(surface.materials).map(|bark| bark.map(triangles::mean_color));
        let tracer = Tracer::new(surface.skeleton, &view, &air, style, size);
        let exposed = |color: Vec3| color * style.exposure;
        let hairs = tracer.only_hairs(exposed(bark.unwrap_or(Vec3::ONE)), dead.map(exposed));
        pieces = hairs.trace(&ledger, monitor)?;
    }
    pieces.push(overlay::trace(style, &framed, &view, &air, size, monitor)?);
    let mut runs = Runs::together(pieces, &ledger)?;
    runs.sort(monitor)?;

    let ground_m = ground_m.filter(|ground_m| view.eye().y > *ground_m);
    let triangles =
        Triangles::new((surface, ground_m), &view, &air, style, (size, factor), &ledger, monitor)?;
    let backdrop = Backdrop::new(style, &view, &tree_extent, foot, shadow);
    canvas::compose(size, &backdrop, monitor, |rows, pixels| {
        let mut samples = Samples::new(rows, factor);
        triangles.draw(rows, &mut samples, monitor)?;
        runs.paint(rows, &mut samples, monitor)?;
        samples.resolve(pixels);
        Ok(())
    })
}

/// Samples along a pixel's side.
fn samples_per_side(size: Size, draft: bool) -> u32 {
    let full = match size.width().max(size.height()) {
        0..=256 => 4,
        257..=2048 => 3,
        _ => 2,
    };
    if draft { full / 2 } else { full }
}
