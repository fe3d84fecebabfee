//! Draws pieces of foliage as they are seen from their own sides, side by side on one picture.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use linden_base::color::code;
use linden_base::memory::bytes_of;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::{Picture, PictureKey};
use rayon::prelude::*;

use super::grain::Grain;
use super::laterals::Laterals;
use super::model::{CardSubject, Model, built, thicken};
use super::sheet::Sheet;
use super::sight::{Plane, Sight};
use crate::detail::DetailError;
use crate::detail::drawing::{
    self, CUTOUT, Canvas, Drawn, Finished, MARGIN_PX, Pile, Pixels, Resolved, SAMPLES, Texture, View,
    key_of_mesh, light_within, look_of,
};
use crate::dress::Wardrobe;
use crate::foliage::Cover;
use crate::scene::{Material, Translucency};
use crate::texture::leaf::Cell;
use crate::{Body, Specimen};

/// How much of their tilt leaves keep on a card, whose normals are the crown's already.
const RELIEF: f32 = 0.4;

/// Cells that are drawn before they are laid, at the most: for any number of cores that machines have.
const CELLS_AT_ONCE: usize = 16;

/// The share of all cells that are, so that few large ones do not take more memory than many small ones.
const SHARE_AT_ONCE: usize = 4;

/// The drawn cards.
pub(super) struct DrawnCards {
    /// One for each model, in units of its radius, by its own directions.
    pub meshes: Vec<Mesh>,
    pub cover: Cover,
}

impl DrawnCards {
    /// The mean colour, sRGB.
    pub fn color(&self) -> [u8; 3] {
        self.cover.cells.first().map_or([0; 3], |cell| cell.color)
    }
}

/// Draws the pieces of some levels.
///
/// # Errors
/// [`DetailError`]: memory, or cancelled.
pub(super) fn draw<'a>(
    models: impl Iterator<Item = CardSubject<'a>>,
    specimen: &Specimen<'_>,
    body: Body<'_>,
    wardrobe: &Wardrobe,
    (size_px, grain): (u32, Grain),
    monitor: &dyn Monitor,
) -> Result<DrawnCards, DetailError> {
    let models: Vec<CardSubject<'_>> = models.collect();
    let (limits_m, mut materials) = barks(wardrobe, grain);
    let (mut drawn, sights) =
        built(&models, specimen, body, wardrobe, (&mut materials, &limits_m, grain), monitor)?;
    let sheet = Sheet::new(&sights, size_px);
    // Where nothing else is shown, fewer wide twigs cover what all thin ones do.
    let laterals = grain.is_bare.then(|| Laterals::of(body.skeleton));
    thicken(&mut drawn, &models, (&sights, sheet.scale), body.skeleton, &limits_m, laterals.as_ref());
    let size = Pixels::new(size_px, size_px);
    // Of the cells that are drawn at once, samples and what becomes of them.
    let mut largest: Vec<usize> = sights.iter().map(|sight| sheet.pixels(sight).area()).collect();
    largest.sort_unstable_by(|a, b| b.cmp(a));
    let cells_at_once = (sights.len() / SHARE_AT_ONCE).clamp(1, CELLS_AT_ONCE);
    let at_once: usize = largest.iter().take(cells_at_once).sum();
    let bytes = bytes_of::<Drawn>(at_once * (SAMPLES * SAMPLES) as usize)
        + Resolved::bytes(at_once)
        + Pile::bytes(size)
        + materials.iter().map(Texture::bytes_of).sum::<u64>();
    monitor.admit("drawing branch cards", bytes, "lower card_size").map_err(DetailError::from)?;
    let corners: Vec<Pixels> =
        sheet.cells.iter().map(|first| Pixels::new(first.x + MARGIN_PX, first.y + MARGIN_PX)).collect();
    let mut meshes = vec![Mesh::default(); drawn.len()];
    for (sight, corner) in sights.iter().zip(&corners) {
        add_plane(&mut meshes[sight.model], sight, *corner, sheet.scale * sight.share, size_px);
    }
    let decided_by = || decided_by(&drawn, &sights, &materials, size_px);
    // Mostly of leaves, where there are any.
    let translucency = materials.iter().find_map(|material| material.translucency);
    let pictures = specimen.drawn.cards(decided_by, monitor, || {
        let textures = materials.par_iter().map(Texture::of).collect();
        let painter = Painter { drawn: &drawn, materials: &materials, textures, sheet: &sheet, monitor };
        let mut pile = Pile::new(size, SAMPLES);
        let placed: Vec<(&Sight, &Pixels)> = sights.iter().zip(&corners).collect();
        for some in placed.chunks(cells_at_once) {
            let cells = some.par_iter().map(|(sight, _)| painter.cell(sight));
            let cells = cells.collect::<Result<Vec<(Resolved, Vec3)>, Cancelled>>()?;
            for ((_, corner), (cell, light)) in some.iter().zip(cells) {
                pile.lay(&cell, **corner, light);
            }
        }
        let Finished { color, normal, passing } = pile.finish(CUTOUT, true, monitor)?;
        Ok::<_, DetailError>([color, normal, passing].map(Arc::new))
    })?;
    Ok(DrawnCards { meshes, cover: cover(pictures, translucency) })
}

/// The barks of thin wood without their pictures, and the largest radius that wears each, metres. Among leaves all look
/// alike.
fn barks(wardrobe: &Wardrobe, grain: Grain) -> (Vec<f32>, Vec<Material>) {
    let plain = |bark: &Material| Material {
        base_color_picture: None,
        normal_picture: None,
        passing_picture: None,
        ..bark.clone()
    };
    if grain.is_bare {
        wardrobe.barks().map(|(most_m, bark)| (most_m, plain(bark))).unzip()
    } else {
        (vec![f32::INFINITY], vec![plain(wardrobe.twig_bark())])
    }
}

/// Draws cells, each by itself.
struct Painter<'a> {
    drawn: &'a [Model],
    materials: &'a [Material],
    /// Of each material.
    textures: Vec<Option<Texture>>,
    sheet: &'a Sheet,
    monitor: &'a dyn Monitor,
}

impl Painter<'_> {
    /// What is seen of a piece, and how much light is left within it.
    fn cell(&self, sight: &Sight) -> Result<(Resolved, Vec3), Cancelled> {
        let cell = self.sheet.pixels(sight);
        let inner = Pixels::new(cell.x - 2 * MARGIN_PX, cell.y - 2 * MARGIN_PX).times(SAMPLES);
        let Plane { right, up, toward } = sight.plane;
        let view = View {
            origin: Vec3::ZERO,
            right,
            up,
            toward,
            relief: RELIEF,
            cuts_whole: false,
            corner: Vec2::new(sight.low.x, sight.high.y),
            scale: self.sheet.scale * sight.share * SAMPLES as f32,
            first: Pixels::new(0, 0),
            size: inner,
        };
        let model = &self.drawn[sight.model];
        let mut canvas = Canvas::new(inner);
        for (material, mesh) in &model.parts {
            let texture = self.textures[*material].as_ref();
            drawing::draw(&mut canvas, &view, mesh, &self.materials[*material], texture, self.monitor)?;
        }
        let cell = Resolved::of(&canvas, SAMPLES);
        let lost = Vec3::ONE - light_within(canvas.layers(), cell.mean_color());
        Ok((cell, Vec3::ONE - model.shade_share * lost))
    }
}

/// All that is seen on the cards: a key of it.
fn decided_by(drawn: &[Model], sights: &[Sight], materials: &[Material], size_px: u32) -> PictureKey {
    let parts: Vec<Vec<(usize, [u8; 16])>> = drawn
        .par_iter()
        .map(|model| model.parts.iter().map(|(material, mesh)| (*material, key_of_mesh(mesh))).collect())
        .collect();
    let looks: Vec<_> = materials.iter().map(look_of).collect();
    let shades: Vec<f32> = drawn.iter().map(|model| model.shade_share).collect();
    PictureKey::of(&[format!("{size_px} {parts:?} {sights:?} {looks:?} {shades:?}").as_bytes()])
}

/// Adds a rectangle with what is seen of it.
fn add_plane(mesh: &mut Mesh, sight: &Sight, inner: Pixels, scale: f32, size_px: u32) {
    let Plane { right, up, toward } = sight.plane;
    let first = mesh.positions.len() as u32;
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0_f32)] {
        let at = sight.low + sight.size() * Vec2::new(x, y);
        mesh.positions.push(right * at.x + up * at.y);
        mesh.normals.push(toward);
        let pixel = inner.to_vec2() + sight.size() * scale * Vec2::new(x, 1.0 - y);
        let uv = pixel / size_px as f32;
        mesh.uvs.push(Vec2::new(uv.x, 1.0 - uv.y));
    }
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// What covers the cards: a picture that is one cell.
fn cover([color, normal, passing]: [Arc<Picture>; 3], translucency: Option<Translucency>) -> Cover {
    let whole = Cell {
        min: Vec2::ZERO,
        max: Vec2::ONE,
        attach: Vec2::splat(0.5),
        unit: Vec2::ONE,
        outline: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        color: drawing::mean(&color).map(code),
        stalk: Vec2::splat(0.5),
    };
    Cover {
        base_color: color,
        normal: Some(normal),
        cutout: Some(CUTOUT),
        cells: vec![whole],
        backs: Vec::new(),
        translucency,
        passing: translucency.map(|_| passing),
    }
}
