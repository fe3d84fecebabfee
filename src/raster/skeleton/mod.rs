//! The axial tree as tapered strokes, and the leaves on it.
//!
//! Each internode is a cone between two balls, as wide as its radii look from the lens. Strokes are
//! drawn far to near, thick ones with light across them. What is thinner than a hair is drawn as a
//! hair and fades instead of vanishing.

#[cfg(test)]
pub(crate) mod sample;
#[cfg(test)]
mod tests;

use glam::{Vec2, Vec3};
use linden_pipeline::picture::Picture;
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};

use crate::canvas::{self, Backdrop};
use crate::light::Air;
use crate::memory::{Ledger, picture_bytes};
use crate::strokes::paint::BRUSH_BYTES_PER_PIXEL;
use crate::strokes::trace::{self, Tracer};
use crate::strokes::{Runs, leaves, overlay};
use crate::style::foot;
use crate::{Camera, Extent, RasterError, Size, Style, View};

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
    let Framing { tree_extent, foot, framed, view } = Framing::new(skeleton, camera, style, size)?;
    let air = Air::new(&tree_extent, &view, style);
    let ledger = Ledger::new(monitor);
    ledger.take(picture_bytes(size) + overlay::bytes(style) + trace::bytes(skeleton, style))?;
    let tracer = Tracer::new(skeleton, &view, &air, style, size);
    let mut pieces = tracer.trace(&ledger, monitor)?;
    pieces.extend(leaves::trace(&tracer, style, &ledger, monitor)?);
    pieces.push(overlay::trace(style, &framed, &view, &air, size, monitor)?);
    let mut runs = Runs::together(pieces, &ledger)?;
    runs.sort(monitor)?;
    let shadow_m = style.ground_shadow.then(|| match style.until {
        Some(step) => reach_m(skeleton, step, Vec2::new(foot.x, foot.z)),
        None => tree_extent.radius(),
    });
    let backdrop = Backdrop::new(style.background, &view, foot, shadow_m);
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

/// How far a tree reached from its foot at a step, level, metres.
fn reach_m(skeleton: &Skeleton, step: u32, foot: Vec2) -> f32 {
    let present = skeleton.born_by(step);
    let nodes = skeleton.positions.iter().zip(&skeleton.radii).zip(present);
    nodes
        .filter(|(_, there)| *there)
        .map(|((p, r), _)| Vec2::new(p.x, p.z).distance(foot) + r)
        .fold(0.0, f32::max)
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
