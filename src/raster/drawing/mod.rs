//! Flat drawings, as in a book: strokes that taper, round joins, filled leaves, no light and no haze.
//!
//! A [`Drawing`] is shapes in pixels, drawn one over the other. It becomes a [`Picture`] by tiny-skia, or
//! an SVG that shows the same: for papers, where it stays sharp and can be edited.
//!
//! ```
//! # use linden_pipeline::{Skeleton, Quiet};
//! # let skeleton = Skeleton {
//! #     positions: vec![glam::Vec3::ZERO, glam::Vec3::Y], parents: vec![u32::MAX, 0], radii: vec![0.1, 0.05],
//! #     births: vec![0, 1], axes: vec![linden_pipeline::skeleton::Axis { order: 0, parent: u32::MAX, first: 0, len: 2 }],
//! #     axis_nodes: vec![0, 1], ..Skeleton::default()
//! # };
//! use linden_raster::{Camera, Drawing, Size, Style};
//! let drawing = Drawing::new(&skeleton, &Camera::front(), &Style::paper(), Size::new(200, 250)?, &Quiet)?;
//! assert!(drawing.svg(None).starts_with("<svg"));
//! assert_eq!(drawing.picture(&Quiet)?.width(), 200);
//! # Ok::<(), linden_raster::RasterError>(())
//! ```

mod beside;
pub mod label;
mod obstructions;
mod outline;
mod paint;
pub mod slice;
mod svg;
#[cfg(test)]
mod tests;
mod text;
mod trace;

use std::ops::Range;

use glam::Vec2;
use linden_pipeline::picture::Picture;
use linden_pipeline::{Monitor, Skeleton};

use crate::memory::{Ledger, picture_bytes};
use crate::skeleton::Framing;
use crate::{Background, Camera, RasterError, Size, Style};

/// Shapes in the picture's plane, the lowest first.
#[derive(Clone, Debug)]
pub struct Drawing {
    size: Size,
    background: Background,
    shapes: Vec<Shape>,
    /// Corners of all shapes, pixels, right and down from the upper left corner.
    points: Vec<Vec2>,
    /// Where each polyline or ring of all shapes ends among the points.
    ends: Vec<u32>,
    words: Vec<Word>,
}

/// What is drawn in one colour.
#[derive(Clone, Debug, PartialEq)]
struct Shape {
    kind: Kind,
    /// sRGB.
    color: [u8; 3],
    /// How much of what is below it hides.
    alpha: f32,
    /// Its polylines or rings, among [`Drawing::ends`].
    lines: Range<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Polylines of an even width, pixels, with round joins and ends.
    Lines { width: f32 },
    /// Rings that all run round the same way: inside is what lies within any of them.
    Rings,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
struct Word {
    text: String,
    /// Where the line begins: the left end of its base line, pixels.
    at: Vec2,
    /// The height of its capitals, pixels.
    height: f32,
    color: [u8; 3],
}

/// [`Drawing::new`] as pixels.
///
/// # Errors
/// Those of [`crate::draw_skeleton`].
pub fn draw_flat(
    skeleton: &Skeleton,
    camera: &Camera,
    style: &Style,
    size: Size,
    monitor: &dyn Monitor,
) -> Result<Picture, RasterError> {
    Drawing::new(skeleton, camera, style, size, monitor)?.picture(monitor)
}

impl Drawing {
    /// Draws a skeleton with [`Style::organs`] on it, framed by the camera as [`crate::draw_skeleton`]
    /// frames it, and a scale where there is room. Of the style, light, haze and shadow mean nothing here.
    ///
    /// # Errors
    /// Those of [`crate::draw_skeleton`].
    pub fn new(
        skeleton: &Skeleton,
        camera: &Camera,
        style: &Style,
        size: Size,
        monitor: &dyn Monitor,
    ) -> Result<Self, RasterError> {
        monitor.check()?;
        let style = &style.suited(skeleton);
        let Framing { framed, view, .. } = Framing::new(skeleton, camera, style, size)?;
        let ledger = Ledger::new(monitor);
        ledger.take(picture_bytes(size))?;
        let mut drawing = Self::empty(size, style.background);
        obstructions::trace(&mut drawing, &framed, &view, style, monitor)?;
        trace::wood(&mut drawing, skeleton, &view, style, &ledger, monitor)?;
        trace::organs(&mut drawing, skeleton, &view, style, &ledger, monitor)?;
        let mut beside = Self::empty(size, style.background);
        beside::trace(&mut beside, &framed, &view, style, monitor)?;
        // The drawing is there twice while it moves to where both have room, beside what is added to it.
        ledger.take(drawing.bytes() + 2 * beside.bytes())?;
        drawing.append(beside);
        Ok(drawing)
    }

    const fn empty(size: Size, background: Background) -> Self {
        Self { size, background, shapes: Vec::new(), points: Vec::new(), ends: Vec::new(), words: Vec::new() }
    }

    /// Adds another drawing's shapes over its own; the lists get no more room than they need.
    fn append(&mut self, over: Self) {
        let (points, ends) = (self.points.len() as u32, self.ends.len() as u32);
        self.shapes.reserve_exact(over.shapes.len());
        self.points.reserve_exact(over.points.len());
        self.ends.reserve_exact(over.ends.len());
        self.shapes.extend(
            over.shapes
                .into_iter()
                .map(|shape| Shape { lines: shape.lines.start + ends..shape.lines.end + ends, ..shape }),
        );
        self.points.extend(over.points);
        self.ends.extend(over.ends.into_iter().map(|end| end + points));
        self.words.extend(over.words);
    }

    /// How large it is, pixels.
    pub const fn size(&self) -> Size {
        self.size
    }

    /// Bytes that it takes.
    fn bytes(&self) -> u64 {
        use linden_pipeline::memory::bytes_of;
        bytes_of::<Shape>(self.shapes.capacity())
            + bytes_of::<Vec2>(self.points.capacity())
            + bytes_of::<u32>(self.ends.capacity())
    }

    /// Adds a shape; `add` gives its polylines or rings. One without any is none.
    fn shape(&mut self, kind: Kind, color: [u8; 3], alpha: f32, add: impl FnOnce(&mut Self)) {
        let first = self.ends.len() as u32;
        add(self);
        let lines = first..self.ends.len() as u32;
        if !lines.is_empty() {
            self.shapes.push(Shape { kind, color, alpha, lines });
        }
    }

    /// Ends the polyline or ring of the points that were added since the last one.
    fn end_line(&mut self) {
        self.ends.push(self.points.len() as u32);
    }

    /// The polylines or rings of a shape.
    fn lines_of<'a>(&'a self, shape: &Shape) -> impl Iterator<Item = &'a [Vec2]> + 'a {
        let (first, last) = (shape.lines.start as usize, shape.lines.end as usize);
        (first..last).map(|i| {
            let from = if i == 0 { 0 } else { self.ends[i - 1] as usize };
            &self.points[from..self.ends[i] as usize]
        })
    }
}
