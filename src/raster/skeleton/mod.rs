//! The axial tree as tapered strokes, and the leaves on it.
//!
//! Each internode is a cone between two balls, as wide as its radii look from the lens. Strokes are
//! drawn far to near, thick ones with light across them. What is thinner than a hair is drawn as a
//! hair and fades instead of vanishing.

#[cfg(test)]
pub(crate) mod sample;
#[cfg(test)]
mod tests;

use glam::Vec3;
use linden_pipeline::picture::Picture;
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};

use crate::backdrop::Backdrop;
use crate::canvas;
use crate::light::{Air, sun};
use crate::memory::{Ledger, picture_bytes};
use crate::shade::{Cells, Shade};
use crate::strokes::paint::BRUSH_BYTES_PER_PIXEL;
use crate::strokes::trace::{self, Tracer};
use crate::strokes::{Runs, leaves, overlay};
use crate::style::foot;
use crate::{Camera, Extent, RasterError, Size, Style, View};

/// How deep shade is: strokes must be told from each other inside a crown too.
const SHADE: f32 = 0.75;

/// Draws the axial tree with [`Style::organs`] on it, framed by the camera.
///
/// # Errors
/// [`RasterError::Empty`] without nodes; [`RasterError::NotFinite`] and
/// [`RasterError::Inconsistent`] with the first node that cannot be drawn;
/// [`RasterError::Cancelled`] soon after the monitor is.
pub fn draw_skeleton(
    skeleton: &Skeleton,
    camera: &Camera,
    style: &Style,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    monitor.check()?;
    let style = &style.suited(skeleton);
    let Framing { tree_extent, foot, framed, view } = Framing::new(skeleton, camera, style, size)?;
    let ledger = Ledger::new(monitor);
    let held = overlay::bytes(style) + trace::bytes(skeleton, style) + Cells::bytes();
    ledger.take(picture_bytes(size) + held)?;
    let air = Air::new(&tree_extent, &view, style, shade(skeleton, style, &tree_extent, &view), SHADE);
    let shadow = style.ground_shadow.then(|| air.shade().shadow_on(foot.y));
    let tracer = Tracer::new(skeleton, &view, &air, style, size);
    let mut pieces = tracer.trace(&ledger, monitor)?;
    pieces.extend(leaves::trace(&tracer, style, &ledger, monitor)?);
    pieces.push(overlay::trace(style, &framed, &view, &air, size, monitor)?);
    let mut runs = Runs::together(pieces, &ledger)?;
    runs.sort(monitor)?;
    let backdrop = Backdrop::new(style, &view, &tree_extent, foot, shadow);
    ledger.take(canvas::band_bytes(size, BRUSH_BYTES_PER_PIXEL))?;
    canvas::compose(size, &backdrop, monitor, |rows, pixels| runs.paint(rows, pixels, monitor))
}

/// Where a skeleton stands in a picture.
pub(crate) struct Framing {
    pub tree_extent: Extent,
    /// The node that the tree stands on.
    pub foot: Vec3,
    /// What the picture shows: the tree, and a person if there is to be one.
    pub framed: Extent,
    pub view: View,
}

impl Framing {
    /// Checks the skeleton first.
    pub fn new(skeleton: &Skeleton, camera: &Camera, style: &Style, size: Size) -> Result<Self, RasterError> {
        check(skeleton)?;
        let tree_extent = style.extent_without_person(skeleton).ok_or(RasterError::Empty)?;
        let foot = foot(skeleton).ok_or(RasterError::Empty)?;
        let framed = framed(camera, style, tree_extent, foot);
        Ok(Self { tree_extent, foot, framed, view: camera.view(framed, size) })
    }
}

/// What the picture frames: the camera's extent or else the tree's, with the person if there is to be
/// one.
pub(crate) fn framed(camera: &Camera, style: &Style, tree_extent: Extent, foot: Vec3) -> Extent {
    match camera.extent {
        None if style.person => tree_extent.with_person(foot.y),
        None => tree_extent,
        // Asked for after the frame was made: beside the tree all the same.
        Some(extent) if style.person && extent.person.is_none() => {
            Extent { person: tree_extent.with_person(foot.y).person, ..extent }
        }
        Some(extent) => extent,
    }
}

/// The shade of the wood and leaves that are there.
fn shade(skeleton: &Skeleton, style: &Style, extent: &Extent, view: &View) -> Shade {
    let cells = Cells::around(extent, style.draft);
    let present = style.until.map(|step| skeleton.born_by(step));
    let is_present = |node: u32| present.as_ref().is_none_or(|present| present[node as usize]);
    cells.add_wood(skeleton, is_present);
    if let Some(organs) = style.organs {
        let is_grown = |organ: usize| {
            let growth = organs.growth(organ);
            let is_carried = (growth.node as usize) < skeleton.positions.len() && is_present(growth.node);
            is_carried && style.until.is_none_or(|step| growth.birth <= step)
        };
        cells.add_organs(organs, is_grown);
    }
    cells.lit(sun(view))
}

pub(crate) fn check(skeleton: &Skeleton) -> Result<(), RasterError> {
    let n = skeleton.positions.len();
    if n == 0 {
        return Err(RasterError::Empty);
    }
    for len in [skeleton.parents.len(), skeleton.radii.len(), skeleton.births.len()] {
        if len != n {
            return Err(RasterError::Inconsistent(len.min(n)));
        }
    }
    for (i, ((p, r), &parent)) in
        skeleton.positions.iter().zip(&skeleton.radii).zip(&skeleton.parents).enumerate()
    {
        if !p.is_finite() || !r.is_finite() {
            return Err(RasterError::NotFinite(i));
        }
        if parent != NO_PARENT && parent as usize >= i {
            return Err(RasterError::Inconsistent(i));
        }
    }
    for axis in &skeleton.axes {
        let end = axis.first as usize + axis.len as usize;
        let leaves_from = axis.parent == NO_PARENT || (axis.parent as usize) < n;
        if end > skeleton.axis_nodes.len() || !leaves_from {
            return Err(RasterError::Inconsistent(n));
        }
    }
    match skeleton.axis_nodes.iter().find(|&&i| i as usize >= n) {
        Some(&i) => Err(RasterError::Inconsistent(i as usize)),
        None => Ok(()),
    }
}
