//! Leaves, needles, flowers and fruit as cut-out pictures, drawn from numbers.
//!
//! An atlas of variants that differ in shape and tint: which one an organ shows is its own tint, in
//! any file format. Nothing here knows of trees or meshes; a [`Cell`] says where in the picture a
//! variant is, where it is held, and how long one leaf is there.

mod atlas;
mod blade;
mod compound;
mod conifer;
mod coverage;
mod field;
mod figure;
mod flower;
mod mip;
mod outline;
mod paint;
mod tint;
mod twig;

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use self::tint::Tint;

use linden_base::color::{code, linear, luminance};
use linden_base::input::UserPicture;
use linden_base::memory::OverMemory;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::Picture;
use linden_base::random::Key;

pub(crate) use mip::{cutout, keep_coverage};
pub use outline::{Margin, Outline, Veins};

/// The mean colour of what a picture shows, linear light; white where it shows nothing.
fn mean_color(picture: &Picture) -> Vec3 {
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for pixel in picture.rgba().chunks_exact(4) {
        let share = f64::from(pixel[3]) / 255.0;
        sum += share * Vec3::from(linear([pixel[0], pixel[1], pixel[2]])).as_dvec3();
        weight += share;
    }
    if weight > 0.0 { (sum / weight).as_vec3() } else { Vec3::ONE }
}

/// What leaf to draw.
///
/// ```
/// use linden_base::{monitor::Quiet, random::Key};
/// use linden_plant::texture::leaf::{LeafLook, Outline};
/// let oak = LeafLook { size_px: 128, ..LeafLook::new(Outline::Lobed) };
/// let pictures = oak.draw(Key::new(7).named("leaf"), &Quiet).unwrap();
/// assert_eq!(pictures.cells.len(), 4);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeafLook {
    /// The shape, as it is seen from far.
    pub outline: Outline,
    /// Width as a share of the blade's length.
    pub width: f32,
    /// Lobes or leaflets, as [`Outline`] says for each.
    pub lobes: u32,
    /// How deep the bays between lobes are: 0 none, 1 down to the midrib.
    pub lobe_depth: f32,
    /// The shape of the edge.
    pub margin: Margin,
    /// Teeth along one side of a blade.
    pub teeth: u32,
    /// How far teeth stand out, as a share of the blade's length.
    pub tooth_depth: f32,
    /// The end of the blade: 0 round, 0.5 as its outline has it, 1 drawn out into a long tip.
    pub tip: f32,
    /// The petiole as a share of the whole length.
    pub petiole: f32,
    /// How veins run.
    pub veins: Veins,
    /// How strongly veins show: 0 not at all, 1 usual, up to 2.
    pub vein_strength: f32,
    /// Colours of the upper side in summer, sRGB, at least one: variants take them in turn.
    pub colors: Vec<[u8; 3]>,
    /// Colours of the under side in summer, sRGB; none: it is not drawn.
    pub back_colors: Vec<[u8; 3]>,
    /// Colours in autumn, sRGB, from the first change to the last; none: leaves stay as in summer.
    pub autumn_colors: Vec<[u8; 3]>,
    /// Colour of the veins, sRGB; `None`: paler than the blade.
    pub vein_color: Option<[u8; 3]>,
    /// Colours of the upper side when it has just unfolded, sRGB; none: green ones are lighter and yellower.
    pub young_colors: Vec<[u8; 3]>,
    /// How much of its youth is over: 0 just unfolded, 1 and beyond as in summer; `None`: as leaves that unfold
    /// at season 0 are, whose youth lasts to 0.25.
    pub ripeness: Option<f32>,
    /// The seasons from which and to which it goes through its autumn colours.
    pub turning: [f32; 2],
    /// Rows of petals, of [`LeafLook::lobes`] each: 1 to [`LeafLook::MOST_PETAL_ROWS`].
    pub petal_rows: u32,
    /// Whether a spot of the colour of stalks is drawn beside it: see [`Cell::stalk`].
    pub has_stalk_color: bool,
    /// How much variants differ in tint: 0 not at all, 1 widely.
    pub color_spread: f32,
    /// How much the last variants, leaves of the sun, are lighter and yellower than the first, leaves of the shade:
    /// 0 not at all, 1 by half.
    pub shade: f32,
    /// 0 flush, 0.35 summer, 0.75 autumn, 1 withered.
    pub season: f32,
    /// Needles are this many times wider and fewer, 1 to [`LeafLook::MOST_NEEDLE_SCALE`]: for pictures that are seen in
    /// few pixels, in which the true ones would run into a blot.
    pub needle_scale: f32,
    /// How many different leaves: 1 to [`LeafLook::MAX_VARIANTS`].
    pub variants: u32,
    /// The picture's side, pixels: 1 to [`LeafLook::MAX_SIZE_PX`].
    pub size_px: u32,
}

/// A twig to compose from drawn leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct TwigLook {
    /// Leaves on the twig, the one at its end included: 1 to [`TwigLook::MAX_LEAVES`].
    pub leaves: u32,
    /// How they stand.
    pub arrangement: Arrangement,
    /// The twig without its last leaf, metres.
    pub length_m: f32,
    /// A leaf from the foot of its petiole to its tip, metres.
    pub leaf_length_m: f32,
    /// Colour of the wood, sRGB.
    pub color: [u8; 3],
    /// Between the twig and its leaves, degrees.
    pub angle_deg: f32,
    /// How far leaves gather at its end: 0 evenly along it, 1 nearly all in its last third.
    pub tuft: f32,
    /// Side shoots, which share the leaves with it: 0 to [`TwigLook::MAX_SHOOTS`], and no more than have two leaves each.
    pub shoots: u32,
}

impl TwigLook {
    /// The most leaves on one twig.
    pub const MAX_LEAVES: u32 = 200;
    /// The most side shoots.
    pub const MAX_SHOOTS: u32 = 24;
}

impl Default for TwigLook {
    /// Nine leaves of 8 cm on 20 cm of a brown twig.
    fn default() -> Self {
        Self {
            leaves: 9,
            arrangement: Arrangement::Alternate,
            length_m: 0.2,
            leaf_length_m: 0.08,
            color: [104, 84, 62],
            angle_deg: 55.0,
            tuft: 0.0,
            shoots: 0,
        }
    }
}

/// How leaves stand along a twig that lies flat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// Left and right in turn.
    #[default]
    Alternate,
    /// In pairs.
    Opposite,
    /// Around it, each 137.5 degrees on: some are seen along their length.
    Spiral,
}

/// The pictures of an atlas, both square.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafPictures {
    /// sRGB with alpha, not premultiplied, one half at the rim of the leaf: what is below that outside
    /// of it keeps smaller copies of the picture from losing it. Colours go on far outside, so that
    /// they have no rim.
    pub base_color: Arc<Picture>,
    /// The alpha below which nothing is to be drawn, so that smaller copies keep thin leaves.
    pub cutout: f32,
    /// Tangent-space normals; OpenGL convention, green points up.
    pub normal: Arc<Picture>,
    /// Where each variant is; they do not touch.
    pub cells: Vec<Cell>,
    /// Where the under side of each is, if it is drawn: as it is seen through the upper one, so that the two cover
    /// each other.
    pub backs: Vec<Cell>,
}

/// One variant's place in an atlas. Texture coordinates: 0 to 1, V up, the origin in the lower left
/// corner of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Lower left corner of what is drawn.
    pub min: Vec2,
    /// Upper right corner of what is drawn.
    pub max: Vec2,
    /// Where the foot of the petiole, or of the twig, is. From there the leaf points up.
    pub attach: Vec2,
    /// What one length is in the picture: of the leaf from the foot of its petiole to its tip, or of
    /// the twig from its foot to the tip of its last leaf. A corner `uv` of a card for a leaf of `l`
    /// metres lies at `(uv - attach) / unit * l`.
    pub unit: Vec2,
    /// A convex outline around what is drawn, counter-clockwise: less to shade than the rectangle.
    pub outline: Vec<Vec2>,
    /// Mean colour, sRGB: for surfaces without pictures.
    pub color: [u8; 3],
    /// Where the picture has the colour of stalks, for those that are no part of it.
    pub stalk: Vec2,
}

impl Cell {
    /// The whole of a user's picture, held in the middle of its lower edge; its height is the leaf's length.
    pub fn whole(picture: &UserPicture) -> Self {
        let (width, height) = (picture.picture.width(), picture.picture.height());
        Self {
            min: Vec2::ZERO,
            max: Vec2::ONE,
            attach: Vec2::new(0.5, 0.0),
            unit: Vec2::new(height as f32 / width as f32, 1.0),
            outline: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            color: picture.mean_color,
            stalk: Vec2::new(0.5, 0.5 / height.max(1) as f32),
        }
    }
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LeafError {
    /// The size is 0 or too large.
    #[error("a leaf picture of {0}×{0} pixels cannot be drawn: choose 1 to {max}", max = LeafLook::MAX_SIZE_PX)]
    Size(u32),
    /// There are none or too many.
    #[error("an atlas of {0} leaves cannot be drawn: choose 1 to {max}", max = LeafLook::MAX_VARIANTS)]
    Variants(u32),
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants the picture any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl LeafLook {
    /// The largest side, pixels.
    pub const MAX_SIZE_PX: u32 = 4096;
    /// The most variants.
    pub const MAX_VARIANTS: u32 = 64;
    /// The most lobes, leaflets or needles; more are as many.
    pub const MOST_LOBES: u32 = 400;
    /// The most rows of petals; more are as many.
    pub const MOST_PETAL_ROWS: u32 = 8;
    /// The most that needles may be wider; more is as much.
    pub const MOST_NEEDLE_SCALE: f32 = 8.0;
    /// The most teeth along one side; more are as many.
    pub const MOST_TEETH: u32 = 100;

    /// The usual leaf of an outline: four variants on 1024 pixels, in summer.
    pub fn new(outline: Outline) -> Self {
        let usual = outline.usual();
        Self {
            outline,
            width: usual.width,
            lobes: usual.lobes,
            lobe_depth: usual.lobe_depth,
            margin: usual.margin,
            teeth: usual.teeth,
            tooth_depth: usual.tooth_depth,
            tip: 0.5,
            petiole: usual.petiole,
            veins: usual.veins,
            vein_strength: 1.0,
            colors: usual.colors.to_vec(),
            back_colors: Vec::new(),
            autumn_colors: usual.autumn_colors.to_vec(),
            vein_color: None,
            young_colors: Vec::new(),
            ripeness: None,
            turning: [0.54, 1.0],
            petal_rows: 1,
            has_stalk_color: false,
            color_spread: 0.5,
            shade: 0.0,
            season: 0.35,
            needle_scale: 1.0,
            variants: 4,
            size_px: 1024,
        }
    }

    /// The same with its summer colours from the darkest to the lightest, if leaves of the shade differ.
    #[must_use]
    pub fn from_shade_to_sun(mut self) -> Self {
        if self.shade > 0.0 {
            let light = |color: &[u8; 3]| luminance(linear(*color));
            self.colors.sort_by(|a, b| light(a).total_cmp(&light(b)));
        }
        self
    }

    /// How wide its needles are, as a share of its whole length; `None`: it has none.
    pub(crate) fn needle_width(&self) -> Option<f32> {
        let look = self.bounded();
        conifer::needle_radius(&look).map(|radius| 2.0 * radius)
    }

    /// Draws an atlas of single leaves.
    ///
    /// # Errors
    /// [`LeafError`]: a size or count out of range, too little memory, or cancelled.
    pub fn draw(&self, key: Key, monitor: &dyn Monitor) -> Result<LeafPictures, LeafError> {
        self.atlas(None, key, monitor)
    }

    /// Draws an atlas of twigs that bear such leaves.
    ///
    /// # Errors
    /// [`LeafError`]: a size or count out of range, too little memory, or cancelled.
    pub fn draw_twig(
        &self,
        twig: &TwigLook,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<LeafPictures, LeafError> {
        self.atlas(Some(twig), key, monitor)
    }

    /// Its colours in its season, sRGB, for what has a shape of its own: one for each of [`LeafLook::colors`].
    pub(crate) fn plain_colors(&self) -> Vec<[u8; 3]> {
        if self.young_colors.is_empty() && self.autumn_colors.is_empty() {
            return self.colors.clone();
        }
        let look = Self { color_spread: 0.0, ..self.bounded() };
        let of = |variant: u32| {
            let blade = Tint::new(&look, variant, Key::new(0)).blade;
            blade.to_array().map(code)
        };
        (0..self.colors.len() as u32).map(of).collect()
    }

    /// A picture of somebody's that shows such a leaf in summer, in the season of this look: drawn over with the colours that
    /// were given for it, as far as it has turned. `None`: it is as it was.
    pub(crate) fn in_season(&self, picture: &Picture) -> Option<Picture> {
        if self.young_colors.is_empty() && self.autumn_colors.is_empty() {
            return None;
        }
        let mean = mean_color(picture);
        let ripeness = if self.young_colors.is_empty() { Some(1.0) } else { self.ripeness };
        let colors = vec![mean.to_array().map(code)];
        let look = Self { colors, ripeness, color_spread: 0.0, shade: 0.0, variants: 1, ..self.bounded() };
        let now = Tint::new(&look, 0, Key::new(0)).blade;
        // Where it has turned by half of its brightness, nothing of the summer's green is left.
        let turned = (2.0 * (now - mean).abs().max_element() / mean.max_element().max(1e-3)).min(1.0);
        if turned < 0.02 {
            return None;
        }
        let bright = luminance(mean.to_array()).max(1e-3);
        let mut rgba = picture.rgba().to_vec();
        for pixel in rgba.chunks_exact_mut(4) {
            let was = Vec3::from(linear([pixel[0], pixel[1], pixel[2]]));
            // Veins and spots stay as much lighter and darker as they are.
            let drawn_over = now * (luminance(was.to_array()) / bright);
            pixel[..3].copy_from_slice(&was.lerp(drawn_over, turned).to_array().map(code));
        }
        Some(Picture::new(picture.width(), picture.height(), rgba))
    }

    /// With numbers that can be drawn: out of range, the nearest that is in it.
    fn bounded(&self) -> Self {
        let usual = self.outline.usual();
        let within = |x: f32, low: f32, high: f32, otherwise: f32| {
            if x.is_nan() { otherwise } else { x.clamp(low, high) }
        };
        Self {
            width: within(self.width, 0.01, 2.0, usual.width),
            lobes: self.lobes.min(Self::MOST_LOBES),
            lobe_depth: within(self.lobe_depth, 0.0, 0.95, usual.lobe_depth),
            teeth: self.teeth.min(Self::MOST_TEETH),
            tooth_depth: within(self.tooth_depth, 0.0, 0.3, usual.tooth_depth),
            tip: within(self.tip, 0.0, 1.0, 0.5),
            petiole: within(self.petiole, 0.0, 0.9, usual.petiole),
            vein_strength: within(self.vein_strength, 0.0, 2.0, 1.0),
            color_spread: within(self.color_spread, 0.0, 1.0, 0.5),
            shade: within(self.shade, 0.0, 1.0, 0.0),
            season: within(self.season, 0.0, 1.0, 0.35),
            ripeness: self.ripeness.map(|ripeness| within(ripeness, 0.0, 1e3, 1.0)),
            turning: self.turning.map(|season| within(season, 0.0, 1.0, 0.54)),
            petal_rows: self.petal_rows.clamp(1, Self::MOST_PETAL_ROWS),
            needle_scale: within(self.needle_scale, 1.0, Self::MOST_NEEDLE_SCALE, 1.0),
            ..self.clone()
        }
    }

    fn atlas(
        &self,
        twig: Option<&TwigLook>,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<LeafPictures, LeafError> {
        if !(1..=Self::MAX_SIZE_PX).contains(&self.size_px) {
            return Err(LeafError::Size(self.size_px));
        }
        if !(1..=Self::MAX_VARIANTS).contains(&self.variants) {
            return Err(LeafError::Variants(self.variants));
        }
        let look = &self.bounded();
        let sides = if look.back_colors.is_empty() { 1 } else { 2 };
        // A twig's leaves are like the first; some are there twice while it is put together.
        let first = compound::leaf(look, &Tint::new(look, 0, key.named("tint")), key).bytes();
        let leaves = twig.map_or(1, |twig| u64::from(twig.leaves.clamp(1, TwigLook::MAX_LEAVES)));
        let bytes = first * leaves * u64::from(sides * self.variants) * 3 / 2;
        monitor.admit("drawing leaves", bytes, "lower leaf_size or twig_leaves")?;
        let under = &Self { colors: look.back_colors.clone(), ..look.clone() };
        // All upper sides, then the same figures from below: no outline hangs on a colour.
        let figures: Vec<_> = (0..sides * self.variants)
            .into_par_iter()
            .map(|figure| {
                monitor.check()?;
                let variant = figure % self.variants;
                let is_under = figure >= self.variants;
                let look = if is_under { under } else { look };
                let key = key.child(u64::from(variant));
                let figure = match twig {
                    Some(twig) => twig::twig(look, twig, variant, key),
                    None => {
                        let tint = Tint::new(look, variant, key.named("tint"));
                        let figure = compound::leaf(look, &tint, key);
                        if look.has_stalk_color {
                            flower::with_stalk_color(figure, look, &tint, key.named("stalk"))
                        } else {
                            figure
                        }
                    }
                };
                Ok(if is_under { figure.turned_over() } else { figure })
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut pictures = atlas::draw(&figures, self.size_px, key, monitor)?;
        pictures.backs = pictures.cells.split_off(self.variants as usize);
        Ok(pictures)
    }
}

#[cfg(test)]
mod tests;
