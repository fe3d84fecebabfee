//! Pictures on what is drawn, halved until their texels are about as large as samples.

use std::sync::Arc;

use glam::{Vec2, Vec4};

use crate::scene::{Material, Wrap};
use linden_base::color::linear;
use linden_base::memory::bytes_of;
use linden_base::picture::Picture;

/// A picture in linear light at several sizes, each half the last. Colours carry their alpha with them
/// (premultiplied), so that what is cut out does not tint what is not.
pub(in crate::detail) struct Texture {
    levels: Vec<Level>,
    repeats: bool,
}

struct Level {
    width: u32,
    height: u32,
    texels: Vec<Vec4>,
}

impl Texture {
    /// A material's colours; `None` where it has no picture.
    pub fn of(material: &Material) -> Option<Self> {
        let first = Level::of(material.base_color_picture.as_deref()?)?;
        let mut levels = vec![first];
        while let Some(next) = levels.last().and_then(Level::halved) {
            levels.push(next);
        }
        Some(Self { levels, repeats: material.wrap == Wrap::Repeat })
    }

    /// Bytes that a material's picture takes here.
    pub fn bytes_of(material: &Material) -> u64 {
        let texels = |picture: &Arc<Picture>| u64::from(picture.width()) * u64::from(picture.height());
        bytes_of::<Vec4>(1) * material.base_color_picture.as_ref().map_or(0, texels) * 4 / 3
    }

    /// Texels on the side of the whole, squared: its area.
    pub fn area(&self) -> f32 {
        self.levels[0].width as f32 * self.levels[0].height as f32
    }

    /// As it is, in its full size.
    pub fn whole(&self) -> Halved<'_> {
        Halved { level: &self.levels[0], repeats: self.repeats }
    }

    /// As it is looked at where a sample is as large as so many texels (an area).
    pub fn halved(&self, texels: f32) -> Halved<'_> {
        let halved = if texels > 1.0 { (0.5 * libm::log2f(texels)) as usize } else { 0 };
        Halved { level: &self.levels[halved.min(self.levels.len() - 1)], repeats: self.repeats }
    }
}

/// A picture in one of its sizes.
#[derive(Clone, Copy)]
pub(in crate::detail) struct Halved<'a> {
    level: &'a Level,
    repeats: bool,
}

impl Halved<'_> {
    /// The colour at a place, V up.
    pub fn at(self, uv: Vec2) -> Vec4 {
        self.level.at(uv, self.repeats)
    }
}

impl Level {
    fn of(picture: &Picture) -> Option<Self> {
        let (width, height) = (picture.width(), picture.height());
        let pixels = picture.rgba().as_chunks::<4>().0;
        if width == 0 || pixels.len() != width as usize * height as usize {
            return None;
        }
        let texel = |&[r, g, b, a]: &[u8; 4]| {
            let [r, g, b] = linear([r, g, b]);
            Vec4::new(r, g, b, 1.0) * (f32::from(a) / 255.0)
        };
        Some(Self { width, height, texels: pixels.iter().map(texel).collect() })
    }

    fn halved(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let texel = |x: u32, y: u32| {
            self.texels[(y.min(self.height - 1) * self.width + x.min(self.width - 1)) as usize]
        };
        let four =
            |x: u32, y: u32| (texel(x, y) + texel(x + 1, y) + texel(x, y + 1) + texel(x + 1, y + 1)) / 4.0;
        let texels =
            (0..height).flat_map(|y| (0..width).map(move |x| (2 * x, 2 * y))).map(|(x, y)| four(x, y));
        Some(Self { width, height, texels: texels.collect() })
    }

    /// Between the four nearest texels.
    fn at(&self, uv: Vec2, repeats: bool) -> Vec4 {
        let split = |x: f32, n: u32| {
            // Half a texel before the first, at the least.
            let x = if repeats { x - x.floor() } else { x.clamp(0.0, 1.0) } * n as f32 + 0.5;
            let high = x as u32;
            let way = x - high as f32;
            if repeats {
                let wrap = |i: u32| if i >= n { i - n } else { i };
                return (wrap(high + n - 1), wrap(high), way);
            }
            (high.saturating_sub(1), high.min(n - 1), way)
        };
        let (x0, x1, s) = split(uv.x, self.width);
        let (y0, y1, t) = split(1.0 - uv.y, self.height);
        let texel = |x: u32, y: u32| self.texels[(y * self.width + x) as usize];
        texel(x0, y0).lerp(texel(x1, y0), s).lerp(texel(x0, y1).lerp(texel(x1, y1), s), t)
    }
}
