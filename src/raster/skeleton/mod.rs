//! The axial tree as tapered strokes.
//!
//! Each internode is the outline of a cone between two balls, as wide as its radii look from the
//! lens. Strokes are drawn far to near; thick ones one by one with light across them, thin ones in
//! groups of like depth and colour, so that a million twigs cost some thousand fills. What is
//! thinner than a hair is drawn as a hair and fades instead of vanishing.

mod paint;
mod strokes;
#[cfg(test)]
mod tests;

use glam::Vec3;
use linden::picture::Picture;
use linden::{Monitor, NO_PARENT, Skeleton};

use crate::canvas::{self, Backdrop};
use crate::{Camera, Extent, RasterError, Size, Style};

/// Draws the axial tree, framed by the camera.
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
    check(skeleton)?;
    let extent = Extent::of(skeleton, style.points).ok_or(RasterError::Empty)?;
    let view = camera.view(extent, size);
    let strokes = strokes::trace(skeleton, extent, &view, style, size, monitor)?;
    let groups = paint::Order::new(&strokes, monitor)?;
    let foot = foot(skeleton);
    let backdrop = Backdrop::new(style.background, &view, foot, style.ground_shadow.then_some(extent));
    canvas::compose(size, &backdrop, |tile| groups.draw(&strokes, tile, monitor))
}

/// The node that the tree stands on.
fn foot(skeleton: &Skeleton) -> Vec3 {
    skeleton.positions.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a }).unwrap_or_default()
}

fn check(skeleton: &Skeleton) -> Result<(), RasterError> {
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
