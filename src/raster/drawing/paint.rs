//! Shapes → pixels, by tiny-skia.

use linden_pipeline::Monitor;
use linden_pipeline::picture::Picture;
use tiny_skia::{
    Color, FillRule, GradientStop, LineCap, LineJoin, LinearGradient, Paint, Path, PathBuilder, Pixmap,
    Point, Rect, SpreadMode, Stroke, Transform,
};

use super::{Drawing, Kind, Shape, text};
use crate::{Background, Landscape, RasterError};

/// Shapes between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 8;
/// The power of a width below a pixel that it is drawn with.
const FADE: f32 = 0.75;

impl Drawing {
    /// The drawing as pixels.
    ///
    /// # Errors
    /// [`RasterError::Cancelled`] soon after the monitor is; [`RasterError::Size`] for a size that no picture
    /// can have.
    pub fn picture(&self, monitor: &dyn Monitor) -> Result<Picture, RasterError> {
        let (width, height) = (self.size.width(), self.size.height());
        let mut pixels = Pixmap::new(width, height).ok_or(RasterError::Size { width, height })?;
        self.lay_background(&mut pixels);
        for (i, shape) in self.shapes.iter().enumerate() {
            if i % CHECK_EVERY == 0 {
                monitor.check()?;
            }
            self.lay(shape, &mut pixels);
        }
        for word in &self.words {
            if let (Some(path), _) = text::outlines(&word.text, word.at, word.height) {
                fill(&mut pixels, &path, &ink(word.color, 1.0));
            }
        }
        monitor.check()?;
        let mut rgba = pixels.take();
        for pixel in rgba.as_chunks_mut::<4>().0 {
            straighten(pixel);
        }
        Ok(Picture::new(width, height, rgba))
    }

    fn lay_background(&self, pixels: &mut Pixmap) {
        let (wide, high) = (pixels.width() as f32, pixels.height() as f32);
        match self.background {
            Background::Transparent => {}
            Background::Plain(color) => pixels.fill(opaque(color)),
            Background::Gradient(top, bottom)
            | Background::Landscape(Landscape { sky: top, horizon: bottom, .. }) => {
                let stops = vec![GradientStop::new(0.0, opaque(top)), GradientStop::new(1.0, opaque(bottom))];
                let (from, to) = (Point::from_xy(0.0, 0.0), Point::from_xy(0.0, high));
                let gradient = LinearGradient::new(from, to, stops, SpreadMode::Pad, Transform::identity());
                if let (Some(shader), Some(all)) = (gradient, Rect::from_xywh(0.0, 0.0, wide, high)) {
                    let paint = Paint { shader, anti_alias: false, ..Paint::default() };
                    pixels.fill_rect(all, &paint, Transform::identity(), None);
                }
            }
        }
    }

    fn lay(&self, shape: &Shape, pixels: &mut Pixmap) {
        let mut builder = PathBuilder::new();
        for line in self.lines_of(shape) {
            let mut points = line.iter();
            if let Some(first) = points.next() {
                builder.move_to(first.x, first.y);
            }
            for point in points {
                builder.line_to(point.x, point.y);
            }
            if shape.kind == Kind::Rings {
                builder.close();
            }
        }
        // None where a place is not finite: such a shape is nowhere.
        let Some(path) = builder.finish() else { return };
        let paint = ink(shape.color, shape.alpha);
        match shape.kind {
            Kind::Rings => fill(pixels, &path, &paint),
            Kind::Lines { width } => {
                let (line_cap, line_join) = (LineCap::Round, LineJoin::Round);
                // Below a pixel ink fades less than the width does, so that twigs show.
                let width = if width < 1.0 { libm::powf(width, FADE) } else { width };
                let stroke = Stroke { width, line_cap, line_join, ..Stroke::default() };
                pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
            }
        }
    }
}

fn fill(pixels: &mut Pixmap, path: &Path, paint: &Paint<'_>) {
    pixels.fill_path(path, paint, FillRule::Winding, Transform::identity(), None);
}

fn opaque([r, g, b]: [u8; 3]) -> Color {
    Color::from_rgba8(r, g, b, 255)
}

pub(super) fn ink([r, g, b]: [u8; 3], alpha: f32) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    paint
}

/// A pixel that was premultiplied as one that is not.
fn straighten(pixel: &mut [u8; 4]) {
    let alpha = u32::from(pixel[3]);
    if alpha != 0 && alpha != 255 {
        for channel in &mut pixel[..3] {
            *channel = ((u32::from(*channel) * 255 + alpha / 2) / alpha).min(255) as u8;
        }
    }
}
