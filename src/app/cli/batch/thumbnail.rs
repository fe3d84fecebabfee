//! A small picture of each tree, as one more format of a manifest: drawn while the tree is there, so that a sheet of
//! ten thousand takes no tree to be grown again.

use std::io;

use linden::Monitor;
use linden::picture::{Picture, PictureFormat};
use linden::stage::Stage;
use linden_exporters::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Options, Readable};
use linden_raster::{Camera, RasterError, Size, Style, Surface, draw_surface};

use crate::portrait::PITCH_DEG;
use crate::portrait::sheet::paper;
use crate::viewpoint::broad_side;

/// Width and height, pixels.
pub const SIZE: (u32, u32) = (200, 240);

/// A picture as `linden sheet` shows a tree.
pub struct Thumbnail;

static FORMAT: Format = Format {
    id: "thumbnail",
    name: "Thumbnail",
    extensions: &["png"],
    media_type: "image/png",
    self_contained: true,
    help: "a small picture, for contact sheets",
    options: &[],
    holds: Holds::SCENE,
    levels_by: None,
    encoding: |_| Encoding::Binary,
    estimate: Some(|amounts, _| 40_000 + amounts.recipe_bytes),
};

impl Exporter for Thumbnail {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        linden_exporters::recipe_in(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        _: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let style = Style::studio();
        let scene = stage.plants.first().and_then(|plant| plant.levels().first()).map(|level| level.scene);
        let drawn = Size::new(SIZE.0, SIZE.1).and_then(|size| {
            let Some(scene) = scene else { return Err(RasterError::Empty) };
            let camera = Camera::orbit(broad_side(&scene.skeleton), PITCH_DEG);
            draw_surface(&Surface::from(scene), &camera, &style, size, monitor)
        });
        let picture = match drawn {
            Ok(picture) => picture,
            // A grammar may draw nothing at all, which is no fault.
            Err(RasterError::Empty) => blank(&style),
            Err(RasterError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(RasterError::Memory(over)) => return Err(over.into()),
            Err(other) => return Err(failed(&other)),
        };
        let png = picture.preview(PictureFormat::Png, Some(&stage.recipe)).map_err(|error| failed(&error))?;
        bundle.write_main(Some(png.len() as u64), monitor, |out| out.write(&png))
    }
}

fn failed(error: &dyn std::error::Error) -> ExportError {
    ExportError::Scene { what: "the thumbnail".to_owned(), problem: error.to_string() }
}

fn blank(style: &Style<'_>) -> Picture {
    let [r, g, b] = paper(style);
    Picture::new(SIZE.0, SIZE.1, [r, g, b, 255].repeat((SIZE.0 * SIZE.1) as usize))
}
