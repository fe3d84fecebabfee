//! Pictures of a tree in files: `linden preview` and the export dialog draw the same ones.

mod apart;
mod formats;
pub mod sheet;
mod sitter;

use linden::Monitor;
use linden::Skeleton;
use linden::foliage::Organs;
use linden::memory::OverMemory;
use linden::picture::{PNG_BYTES_PER_PIXEL, Picture, PictureFormat};
use linden::scene::Scene;
use linden_exporters::{Bundle, ExportError, Registry};
use linden_raster::memory::admit_png;
use linden_raster::{
    Background, Camera, Drawing, RasterError, Size, Slice, Style, Surface, draw_flat, draw_skeleton,
    draw_surface,
};

use crate::viewpoint::broad_side;

pub use apart::{FOREST_PNG, FOREST_SIZE, SHEET, Sitters, draw_forest, is_apart, write_apart};
pub use formats::{PNG, SVG};
pub use sitter::{PreviewLook, Sitter};

/// What can be exported to, pictures included.
pub fn formats() -> Registry {
    Registry::new().with(PNG).with(SVG).with(SHEET).with_plugins()
}

/// How far from above a tree is looked at by default, degrees.
pub const PITCH_DEG: f32 = 8.0;
/// Pixels of a file by default.
pub const FILE_SIZE: (u32, u32) = (800, 1000);

/// A tree that is drawn.
pub struct Portrait<'a> {
    /// Its wood.
    pub skeleton: &'a Skeleton,
    /// What grows on it.
    pub organs: &'a Organs,
    /// The colours of a grammar's organs, sRGB.
    pub leaf_colors: &'a [[u8; 3]],
    /// Dressed, where its surface is shown.
    pub scene: Option<&'a Scene>,
    /// Whether it is drawn flat.
    pub is_flat: bool,
    /// Where it is cut, for a picture of that alone.
    pub slice: Option<Slice>,
}

impl<'a> Portrait<'a> {
    /// A camera that looks at the tree; at its broad side where no yaw (degrees) is given.
    pub fn camera(&self, yaw_deg: Option<f32>, pitch_deg: f32, zoom: f32) -> Camera {
        let yaw_deg = yaw_deg.unwrap_or_else(|| broad_side(self.skeleton));
        Camera { zoom, ..Camera::orbit(yaw_deg, pitch_deg) }
    }

    /// A style with this tree's leaves.
    pub fn styled<'b>(&self, style: Style<'b>) -> Style<'b>
    where
        'a: 'b,
    {
        Style { organs: Some(self.organs), leaf_colors: self.leaf_colors, ..style }
    }

    /// Draws it in pixels.
    ///
    /// # Errors
    /// Those of the drawing.
    pub fn draw(
        &self,
        camera: &Camera,
        style: &Style<'_>,
        size: Size,
        monitor: &dyn Monitor,
    ) -> Result<Picture, RasterError> {
        if let Some(slice) = self.slice {
            return Drawing::of_slice(self.skeleton, slice, camera, style, size, monitor)?.picture(monitor);
        }
        match self.scene {
            Some(scene) => draw_surface(&Surface::from(scene), camera, style, size, monitor),
            None if self.is_flat => draw_flat(self.skeleton, camera, style, size, monitor),
            None => draw_skeleton(self.skeleton, camera, style, size, monitor),
        }
    }

    /// Draws it flat, as the text of an SVG that carries a recipe.
    ///
    /// # Errors
    /// Those of the drawing.
    pub fn svg(
        &self,
        camera: &Camera,
        style: &Style<'_>,
        size: Size,
        recipe: &str,
        monitor: &dyn Monitor,
    ) -> Result<String, RasterError> {
        let drawing = match self.slice {
            Some(slice) => Drawing::of_slice(self.skeleton, slice, camera, style, size, monitor)?,
            None => Drawing::new(self.skeleton, camera, style, size, monitor)?,
        };
        Ok(drawing.svg(Some(recipe)))
    }
}

/// What a file's picture is painted with by default.
pub fn file_style(is_flat: bool) -> Style<'static> {
    if is_flat { Style::paper() } else { Style::studio() }
}

/// A style on a background, its own where none is given. Nothing transparent is shadowed.
pub fn on_background(style: Style<'_>, background: Option<Background>) -> Style<'_> {
    let ground_shadow = style.ground_shadow && background != Some(Background::Transparent);
    Style { background: background.unwrap_or(style.background), ground_shadow, ..style }
}

/// The format of a picture's file, by its name; PNG where that says nothing.
fn format_of(bundle: &Bundle) -> PictureFormat {
    bundle.main_name().and_then(PictureFormat::of_name).unwrap_or(PictureFormat::Png)
}

/// Asks for what a picture of this size takes while it is written, beside `held_bytes`.
///
/// # Errors
/// That there is too little memory.
pub fn admit(
    format: PictureFormat,
    size: Size,
    held_bytes: u64,
    monitor: &dyn Monitor,
) -> Result<(), OverMemory> {
    let pixels = u64::from(size.width()) * u64::from(size.height());
    let beyond_png = format.encoding_bytes_per_pixel().saturating_sub(PNG_BYTES_PER_PIXEL);
    admit_png(size, held_bytes.saturating_add(pixels * beyond_png), monitor)
}

/// Writes a picture in the format that its file's name tells, with the recipe of what it shows.
fn write_picture(
    picture: &Picture,
    recipe: Option<&str>,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let format = format_of(bundle);
    let bytes = picture.preview(format, recipe).map_err(formats::broken)?;
    for loss in losses(picture, format, recipe) {
        bundle.note(loss);
    }
    bundle.write_main(Some(bytes.len() as u64), monitor, |sink| sink.write(&bytes))
}

/// What a format leaves out of a picture.
pub fn losses(picture: &Picture, format: PictureFormat, recipe: Option<&str>) -> Vec<String> {
    let mut losses = Vec::new();
    if !format.has_alpha() && !picture.is_opaque() {
        losses.push(format!(
            "{} has no transparency: the background is white; write .png or .webp to keep it transparent",
            format.name()
        ));
    }
    if recipe.is_some_and(|recipe| !format.has_room_for(recipe)) {
        losses.push(format!(
            "the recipe is left out, {} has no room for one so long: write .png or .webp to carry it",
            format.name()
        ));
    }
    losses
}
