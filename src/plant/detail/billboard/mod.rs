//! The last level of detail: a few crossed planes with pictures of the tree on them.
//!
//! Each plane stands upright on the axis through the foot and shows the tree as it is seen from far
//! away at a right angle to it: colours without light (a renderer adds that), alpha, and normals in the
//! plane's own tangent space. All planes share one pair of pictures.
//!
//! A plane has two faces, each seen from its own side, and both are lit alike, by normals that depend on the place alone: up
//! on the axis, and away from it at the edges. So neither a plane that is seen from behind nor one that crosses another is told
//! from it by its light.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::drawing::{
    self, CUTOUT, Canvas, Drawn, Finished, MARGIN_PX, Pile, Pixels, Resolved, SAMPLES, Texture, View,
    key_of_mesh, light_within, look_of, mean,
};
use crate::foliage::DressedOrgans;
use crate::scene::{Material, Part, Scene, Wrap};
use crate::texture::DrawnPictures;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::{Picture, PictureKey};

/// How the planes are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Billboard {
    /// How many upright planes cross each other, 1 to 4, at equal angles.
    pub planes: u32,
    /// Height of the picture, pixels, of which a wide tree may not fill all; it is a quarter as wide up to twice as wide.
    pub size_px: u32,
}

/// Why there are no planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BillboardError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] OverMemory),
}

/// How much of the light that the crown takes from itself is drawn as lost. All of it, as normals that look up are lit by all of
/// the sky: so an oak, a birch and a spruce are as bright as their level of 4000 triangles beside them (three.js, a sun 45° high
/// and a sky).
const SHADE_SHARE: f32 = 1.0;
/// How much of their tilt leaves keep: the faces' normals are the crown's already.
const RELIEF: f32 = 0.9;
/// Of normals: how much of them points out of the crown, at the foot and at the top, where it looks up in the middle.
const OUTWARD: [f32; 2] = [2.0, 0.9];
/// The same, towards the viewer: the lit side is a little brighter than the other.
const TOWARD: f32 = 0.25;
/// Half of the gap between the faces of a plane, in heights of the picture: nothing that is seen, enough to tell which is nearer.
const GAP: f32 = 5e-5;
/// A picture may be so much coarser than its height allows, before it gets twice as wide.
const COARSER: f32 = 1.2;
/// Neither leaves nor bark shine from afar.
const ROUGHNESS: f32 = 0.9;

/// Draws a scene onto crossed planes, which become a scene of their own: with the same name, recipe and
/// skeleton, one part `billboard` and one material.
///
/// # Errors
/// [`BillboardError`]: memory, or cancelled.
pub fn billboard(scene: &Scene, how: &Billboard, monitor: &dyn Monitor) -> Result<Scene, BillboardError> {
    kept_billboard(scene, *how, &DrawnPictures::new(0), monitor)
}

/// The same with pictures that are not drawn again where they are `drawn` already.
pub(super) fn kept_billboard(
    scene: &Scene,
    how: Billboard,
    drawn: &DrawnPictures,
    monitor: &dyn Monitor,
) -> Result<Scene, BillboardError> {
    let planes = how.planes.clamp(1, 4);
    let vertices = || scene.parts.iter().flat_map(|part| &part.mesh.positions).copied();
    let bounds = Bounds::of(vertices()).unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    let foot = scene.skeleton.positions.first().copied().unwrap_or_default();
    let frames: Vec<Frame> = (0..planes).map(|k| Frame::new(k, planes, foot, &bounds, vertices())).collect();
    let sheet = Sheet::new(&frames, how.size_px.max(4 * MARGIN_PX));
    let pixels = sheet.size.area() as u64;
    let samples = pixels * u64::from(SAMPLES * SAMPLES);
    let bytes = bytes_of::<Drawn>(1) * samples
        + Pile::bytes(sheet.size)
        + scene.materials.iter().map(Texture::bytes_of).sum::<u64>();
    monitor.admit("drawing the billboard", scene.bytes() + bytes, "lower billboard_size")?;

    let decided_by = || decided_by(scene, &frames, &sheet, foot);
    let [color, normal, passing] =
        drawn.billboard(decided_by, monitor, || draw(scene, &frames, &sheet, foot, monitor))?;
    // Mostly of leaves, where there are any.
    let translucency = scene.materials.iter().find_map(|material| material.translucency);
    let material = Material {
        name: "billboard".to_owned(),
        base_color: mean(&color),
        base_color_picture: Some(color),
        normal_picture: Some(normal),
        roughness: ROUGHNESS,
        double_sided: false,
        cutout: Some(CUTOUT),
        wrap: Wrap::Clamp,
        translucency,
        passing_picture: translucency.map(|_| passing),
    };
    Ok(Scene {
        name: scene.name.clone(),
        recipe: scene.recipe.clone(),
        materials: vec![material],
        parts: vec![Part::new("billboard", 0, sheet.mesh(&frames, foot))],
        skeleton: Arc::clone(&scene.skeleton),
        organs: DressedOrgans::default(),
        foot_in_file: scene.foot_in_file,
    })
}

/// All that is seen on the planes: a key of it.
fn decided_by(scene: &Scene, frames: &[Frame], sheet: &Sheet, foot: Vec3) -> PictureKey {
    let parts: Vec<_> = scene.parts.iter().map(|part| (part.material, key_of_mesh(&part.mesh))).collect();
    let looks: Vec<_> = scene.materials.iter().map(look_of).collect();
    PictureKey::of(&[format!("{parts:?} {looks:?} {frames:?} {sheet:?} {foot:?}").as_bytes()])
}

/// Draws colours, normals and what passes.
fn draw(
    scene: &Scene,
    frames: &[Frame],
    sheet: &Sheet,
    foot: Vec3,
    monitor: &dyn Monitor,
) -> Result<[Arc<Picture>; 3], BillboardError> {
    let textures: Vec<Option<Texture>> = scene.materials.iter().map(Texture::of).collect();
    let mut drawn = Canvas::new(sheet.size.times(SAMPLES));
    for (frame, cell) in frames.iter().zip(&sheet.cells) {
        let view = View {
            // Heights are the tree's own.
            origin: foot.with_y(0.0),
            right: frame.right,
            up: Vec3::Y,
            toward: frame.toward,
            relief: RELIEF,
            cuts_whole: false,
            // Where the upper left corner of the cell is, and how many samples a metre has.
            corner: Vec2::new(frame.low.x, frame.high.y),
            scale: SAMPLES as f32 / sheet.texel_m,
            first: cell.inner().times(SAMPLES),
            size: Pixels::new(cell.size.x - 2 * MARGIN_PX, cell.size.y - 2 * MARGIN_PX).times(SAMPLES),
        };
        for part in &scene.parts {
            let (material, texture) = (&scene.materials[part.material], textures[part.material].as_ref());
            drawing::draw(&mut drawn, &view, &part.mesh, material, texture, monitor)?;
        }
    }
    let mut pile = Pile::new(sheet.size, SAMPLES);
    let resolved = Resolved::of(&drawn, SAMPLES);
    let lost = Vec3::ONE - light_within(drawn.layers(), resolved.mean_color());
    pile.lay(&resolved, Pixels::new(0, 0), Vec3::ONE - SHADE_SHARE * lost);
    drop(drawn);
    let Finished { color, normal, passing } = pile.finish(CUTOUT, false, monitor)?;
    Ok([color, normal, passing].map(Arc::new))
}

/// An upright plane, and what it must hold.
#[derive(Debug)]
struct Frame {
    right: Vec3,
    /// Unit vector: from the tree to its viewer.
    toward: Vec3,
    /// Corners of the box round the tree: metres to the right of the foot, and height.
    low: Vec2,
    high: Vec2,
}

impl Frame {
    fn new(k: u32, planes: u32, foot: Vec3, bounds: &Bounds, vertices: impl Iterator<Item = Vec3>) -> Self {
        let (sin, cos) = libm::sincosf(PI * k as f32 / planes as f32);
        let (right, toward) = (Vec3::new(cos, 0.0, -sin), Vec3::new(sin, 0.0, cos));
        let across = vertices.map(|place| (place - foot).dot(right));
        let (low, high) = across.fold((0.0, 0.0), |(low, high): (f32, f32), x| (low.min(x), high.max(x)));
        Self { right, toward, low: Vec2::new(low, bounds.min.y), high: Vec2::new(high, bounds.max.y) }
    }

    fn size(&self) -> Vec2 {
        (self.high - self.low).max(Vec2::splat(1e-6))
    }
}

/// Where the planes' pictures lie in the common one.
#[derive(Debug)]
struct Sheet {
    size: Pixels,
    cells: Vec<Cell>,
    /// Edge of a pixel, metres.
    texel_m: f32,
}

#[derive(Debug)]
struct Cell {
    first: Pixels,
    size: Pixels,
}

impl Cell {
    /// The first pixel behind the margin.
    fn inner(&self) -> Pixels {
        Pixels::new(self.first.x + MARGIN_PX, self.first.y + MARGIN_PX)
    }
}

impl Sheet {
    /// As wide as its height, twice, half or a quarter of that: powers of two where the height is one, which all engines take as
    /// they are.
    fn new(frames: &[Frame], size_px: u32) -> Self {
        let margins = 2 * MARGIN_PX;
        let height_m = frames.iter().map(|frame| frame.size().y).fold(0.0, f32::max);
        let width_m: f32 = frames.iter().map(|frame| frame.size().x).sum();
        let all_margins = margins * frames.len() as u32;
        let at_full_height = height_m / (size_px - margins) as f32;
        let at_width = |width: u32| width_m / width.saturating_sub(all_margins).max(1) as f32;
        let widths = [size_px / 4, size_px / 2, size_px, 2 * size_px];
        let fits = |width: &u32| *width > 2 * all_margins && at_width(*width) < COARSER * at_full_height;
        let width = widths.into_iter().find(fits).unwrap_or(2 * size_px);
        let mut texel_m = at_full_height.max(at_width(width));
        loop {
            // What is a whole number of pixels but for rounding takes no more.
            let pixels = |metres: f32| (metres / texel_m - 1e-3).ceil() as u32 + margins;
            let mut next = 0;
            let cells = frames.iter().map(|frame| {
                let size = Pixels::new(pixels(frame.size().x), pixels(height_m));
                let first = Pixels::new(next, 0);
                next += size.x;
                Cell { first, size }
            });
            let cells: Vec<Cell> = cells.collect();
            // Each rounds up.
            if next <= width || texel_m > 2.0 * at_width(width) {
                let size = Pixels::new(width.max(next), size_px);
                return Self { size, cells, texel_m };
            }
            texel_m *= 1.001;
        }
    }

    /// Two rectangles for each plane: its front and its back.
    fn mesh(&self, frames: &[Frame], foot: Vec3) -> Mesh {
        let mut mesh = Mesh::default();
        for (frame, cell) in frames.iter().zip(&self.cells) {
            // The cell's edges without the margin, in pixels from the upper left corner.
            let upper_left = cell.inner().to_vec2();
            let lower_right = upper_left + frame.size() / self.texel_m;
            for toward in [frame.toward, -frame.toward] {
                let first = mesh.positions.len() as u32;
                let gap = toward * (GAP * frame.size().y);
                for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0_f32)] {
                    let at = frame.low + frame.size() * Vec2::new(x, y);
                    let place = Vec3::new(foot.x, 0.0, foot.z) + frame.right * at.x + Vec3::Y * at.y;
                    mesh.positions.push(place + gap);
                    let outward = OUTWARD[0] + (OUTWARD[1] - OUTWARD[0]) * y;
                    let out = frame.right * (at.x.signum() * outward) + Vec3::Y + toward * TOWARD;
                    mesh.normals.push(out.normalize());
                    let pixel = Vec2::new(
                        upper_left.x + (lower_right.x - upper_left.x) * x,
                        lower_right.y + (upper_left.y - lower_right.y) * y,
                    );
                    let uv = pixel / self.size.to_vec2();
                    mesh.uvs.push(Vec2::new(uv.x, 1.0 - uv.y));
                }
                let triangles = [[first, first + 1, first + 2], [first, first + 2, first + 3]];
                let is_front = toward == frame.toward;
                mesh.triangles
                    .extend(triangles.map(|[a, b, c]| if is_front { [a, b, c] } else { [a, c, b] }));
            }
        }
        mesh
    }
}

#[cfg(test)]
mod tests;
