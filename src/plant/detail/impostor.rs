//! A plant seen from all around, in one picture: what octahedral impostors are drawn from.
//!
//! Directions lie on an octahedron that is unfolded onto a square (Praun & Hoppe 2003, "Spherical parametrization and
//! remeshing", section 5.2), or on its upper half, turned by an eighth (Brucks 2018, "Octahedral impostors"), and a grid
//! of them is seen without perspective. A program draws one rectangle that faces the viewer, and mixes the views
//! that are next to where it looks from.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::drawing::{
    self, CUTOUT, Canvas, Drawn, Finished, Pile, Pixels, Plane, Resolved, SAMPLES, Texture, View,
};
use crate::scene::Scene;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_base::picture::Picture;

/// How a plant is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImpostorView {
    /// Views along a side of the picture, 2 to [`MOST_FRAMES`].
    pub frames: u32,
    /// Side of the picture, pixels; what the views do not fill evenly is left out.
    pub size_px: u32,
    /// Whether it is seen from below too.
    pub is_whole: bool,
}

/// The most views along a side.
pub const MOST_FRAMES: u32 = 32;

/// Pixels of a view below which nothing is to be seen on it.
pub const LEAST_PX: u32 = 8;

/// Pixels between what is drawn and the edge of its view.
const MARGIN_PX: u32 = 2;

/// A plant from all around.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// sRGB and alpha; views row by row, the first in the upper left corner.
    pub color: Arc<Picture>,
    /// The normal in the plant's axes, `rgb * 2 - 1`; in alpha how near it is: 0 a radius behind the centre, 1 a radius before it.
    pub normal_depth: Arc<Picture>,
    /// Views along a side.
    pub frames: u32,
    /// Whether it is seen from below too.
    pub is_whole: bool,
    /// What all views look at, metres, Y up.
    pub centre_m: Vec3,
    /// Half of what a view shows, to its edges, metres.
    pub radius_m: f32,
}

/// Why there are no views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpostorError {
    /// A grid that cannot be drawn.
    #[error(
        "{frames} views along {size_px} pixels: expected 2 to {MOST_FRAMES} views of {LEAST_PX} pixels or more each"
    )]
    Frames {
        /// Views along a side.
        frames: u32,
        /// Pixels along a side.
        size_px: u32,
    },
    /// Nothing is to be seen.
    #[error("there is nothing to be seen: no wood and no leaves")]
    Empty,
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no memory for it.
    #[error(transparent)]
    Memory(#[from] OverMemory),
}

/// From where a view sees: the unit vector to its viewer, of the view at a column and row.
///
/// ```
/// use linden_plant::detail::impostor::direction;
/// // The middle of the upper half is straight above; its corners are at the horizon.
/// assert!((direction([1, 1], 3, false) - glam::Vec3::Y).length() < 1e-6);
/// assert!(direction([0, 0], 3, false).y.abs() < 1e-6);
/// ```
pub fn direction([column, row]: [u32; 2], frames: u32, is_whole: bool) -> Vec3 {
    let at = Vec2::new(column as f32, row as f32) / (frames.max(2) - 1) as f32 * 2.0 - 1.0;
    let (x, z) = if is_whole { (at.x, at.y) } else { (0.5 * (at.x + at.y), 0.5 * (at.x - at.y)) };
    let y = 1.0 - x.abs() - z.abs();
    let folded =
        |a: f32, b: f32| if y < 0.0 { (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 } } else { a };
    Vec3::new(folded(x, z), y, folded(z, x)).normalize_or(Vec3::Y)
}

/// Right and up of a view, unit vectors; seen from straight above or below, north (-Z) is up.
///
/// ```
/// use glam::Vec3;
/// assert_eq!(linden_plant::detail::impostor::frame(Vec3::Z), [Vec3::X, Vec3::Y]);
/// ```
pub fn frame(toward: Vec3) -> [Vec3; 2] {
    let right = Vec3::Y.cross(toward).try_normalize().unwrap_or(Vec3::X);
    [right, toward.cross(right)]
}

/// Draws a scene from all around.
///
/// # Errors
/// [`ImpostorError`].
pub fn impostor(scene: &Scene, how: &ImpostorView, monitor: &dyn Monitor) -> Result<Impostor, ImpostorError> {
    let ImpostorView { frames, size_px, is_whole } = *how;
    let side = size_px / frames.max(1);
    if !(2..=MOST_FRAMES).contains(&frames) || side < LEAST_PX {
        return Err(ImpostorError::Frames { frames, size_px });
    }
    let vertices = || scene.parts.iter().flat_map(|part| &part.mesh.positions).copied();
    let bounds = Bounds::of(vertices()).ok_or(ImpostorError::Empty)?;
    let centre_m = (bounds.min + bounds.max) / 2.0;
    let reach_m = vertices().map(|place| place.distance(centre_m)).fold(1e-3, f32::max);
    // What reaches farthest is a margin away from the edge.
    let radius_m = reach_m * side as f32 / (side - 2 * MARGIN_PX) as f32;
    let (size, view) = (Pixels::new(side * frames, side * frames), Pixels::new(side, side));
    let samples = view.times(SAMPLES);
    let each = bytes_of::<Drawn>(samples.area()) + 2 * Resolved::bytes(view.area());
    let bytes = each * rayon::current_num_threads() as u64
        + Pile::bytes(size)
        + 2 * bytes_of::<Vec4>(size.area())
        + scene.materials.iter().map(Texture::bytes_of).sum::<u64>();
    monitor.admit("drawing the impostor", scene.bytes() + bytes, "lower its size")?;

    let textures = scene.materials.iter().map(Texture::of).collect();
    let views = Views { scene, textures, how, samples, centre_m, radius_m, monitor };
    let mut pile = Pile::new(size, SAMPLES);
    let mut depths = Plane::new(size);
    // Of a few at a time, laid in their order.
    monitor.advance(Phase::View, 0, Some(frames.into()));
    for row in 0..frames {
        monitor.check()?;
        let seen = (row * frames..(row + 1) * frames).into_par_iter().map(|number| views.seen(number));
        for (corner, resolved, near) in seen.collect::<Result<Vec<_>, Cancelled>>()? {
            pile.lay(&resolved, corner, Vec3::ONE);
            for (y, line) in near.chunks_exact(side as usize).enumerate() {
                let first = (corner.y as usize + y) * size.x as usize + corner.x as usize;
                depths.values[first..first + line.len()].copy_from_slice(line);
            }
        }
        monitor.advance(Phase::View, (row + 1).into(), Some(frames.into()));
    }
    let Finished { color, normal, .. } = pile.finish(CUTOUT, false, monitor)?;
    depths.fill(monitor)?;
    let normal_depth = Arc::new(with_depth(&normal, &depths, radius_m));
    Ok(Impostor { color: Arc::new(color), normal_depth, frames, is_whole, centre_m, radius_m })
}

/// A scene as it is looked at from all around.
struct Views<'a> {
    scene: &'a Scene,
    /// Of each material.
    textures: Vec<Option<Texture>>,
    how: &'a ImpostorView,
    /// Of a view.
    samples: Pixels,
    centre_m: Vec3,
    radius_m: f32,
    monitor: &'a dyn Monitor,
}

impl Views<'_> {
    /// A view by its number: where it lies on the picture, what is seen, and for each pixel the sum and the number of the
    /// depths of its samples.
    fn seen(&self, number: u32) -> Result<(Pixels, Resolved, Vec<Vec4>), Cancelled> {
        let ImpostorView { frames, size_px, is_whole } = *self.how;
        let (side, samples) = (size_px / frames, self.samples);
        let at = [number % frames, number / frames];
        let toward = direction(at, frames, is_whole);
        let [right, up] = frame(toward);
        let view = View {
            origin: self.centre_m,
            right,
            up,
            toward,
            corner: Vec2::new(-self.radius_m, self.radius_m),
            relief: 1.0,
            cuts_whole: true,
            scale: samples.x as f32 / (2.0 * self.radius_m),
            first: Pixels::new(0, 0),
            size: samples,
        };
        let mut drawn = Canvas::new(samples);
        for part in &self.scene.parts {
            let (material, texture) =
                (&self.scene.materials[part.material], self.textures[part.material].as_ref());
            drawing::draw(&mut drawn, &view, &part.mesh, material, texture, self.monitor)?;
        }
        let mut near = vec![Vec4::ZERO; side as usize * side as usize];
        for (index, sample) in drawn.samples.iter_mut().enumerate() {
            if sample.near_m == f32::NEG_INFINITY {
                continue;
            }
            let (x, y) = (index as u32 % samples.x / SAMPLES, index as u32 / samples.x / SAMPLES);
            near[(y * side + x) as usize] += Vec4::new(sample.near_m, 0.0, 0.0, 1.0);
            let Vec3 { x, y, z } = sample.normal;
            sample.normal = right * x + up * y + toward * z;
        }
        Ok((Pixels::new(at[0] * side, at[1] * side), Resolved::of(&drawn, SAMPLES), near))
    }
}

/// Normals with the depths as alpha: nothing is as far as the ball's back, all as its front.
fn with_depth(normal: &Picture, depths: &Plane, radius_m: f32) -> Picture {
    let mut pixels = normal.rgba().to_vec();
    for (pixel, depth) in pixels.as_chunks_mut::<4>().0.iter_mut().zip(&depths.values) {
        let near = (0.5 + 0.5 * depth.x / radius_m).clamp(0.0, 1.0);
        pixel[3] = libm::roundf(near * 255.0) as u8;
    }
    Picture::new(normal.width(), normal.height(), pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foliage::DressedOrgans;
    use crate::scene::Part;
    use crate::testing::plain;
    use linden_base::mesh::Mesh;
    use linden_base::monitor::Quiet;
    use linden_skeleton::Skeleton;

    /// Boxes of one colour each, with normals of their sides.
    fn boxes(all: &[(Vec3, Vec3, [f32; 3])]) -> Scene {
        let (mut materials, mut parts) = (Vec::new(), Vec::new());
        for (number, &(low, high, base_color)) in all.iter().enumerate() {
            let mut mesh = Mesh::default();
            for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0_f32)]) {
                let mut normal = Vec3::ZERO;
                normal[axis] = sign;
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let first = mesh.positions.len() as u32;
                for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0_f32)] {
                    let mut at = if sign > 0.0 { high } else { low };
                    at[a] = low[a] + (high[a] - low[a]) * s;
                    at[b] = low[b] + (high[b] - low[b]) * t;
                    mesh.positions.push(at);
                    mesh.normals.push(normal);
                    mesh.uvs.push(Vec2::ZERO);
                }
                let faces = if sign > 0.0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
                mesh.triangles.extend(faces.map(|face| face.map(|corner: u32| first + corner)));
            }
            materials.push(plain(base_color, false));
            parts.push(Part::new(format!("part{number}"), number, mesh));
        }
        Scene {
            name: "test".to_owned(),
            recipe: "{}".to_owned(),
            materials,
            parts,
            skeleton: Arc::new(Skeleton { positions: vec![Vec3::ZERO], ..Skeleton::default() }),
            organs: DressedOrgans::default(),
            foot_in_file: None,
        }
    }

    fn pixel(picture: &Picture, [x, y]: [u32; 2]) -> [u8; 4] {
        picture.rgba().as_chunks::<4>().0[(y * picture.width() + x) as usize]
    }

    #[test]
    fn directions_go_all_around_and_none_twice() {
        for (is_whole, frames) in [(false, 9), (true, 9), (false, 8), (true, 8)] {
            let all: Vec<Vec3> = (0..frames * frames)
                .map(|number| direction([number % frames, number / frames], frames, is_whole))
                .collect();
            assert!(all.iter().all(|way| (way.length() - 1.0).abs() < 1e-5));
            assert_eq!(all.iter().any(|way| way.y < -0.1), is_whole);
            // Whatever the viewer's direction, a view is not far away from it.
            for i in 0..2000 {
                let key = linden_base::random::Key::new(i);
                let turn = key.child(0).on_circle().as_vec2();
                let up = key.child(1).between(if is_whole { -1.0 } else { 0.0 }, 1.0) as f32;
                let way = Vec3::new(turn.x, 0.0, turn.y) * (1.0 - up * up).sqrt() + Vec3::Y * up;
                let nearest = all.iter().map(|other| other.angle_between(way)).fold(f32::INFINITY, f32::min);
                let most = if is_whole { 26.0_f32 } else { 20.0 };
                assert!(nearest < most.to_radians(), "{way}: {} of {is_whole}", nearest.to_degrees());
            }
            // Inner ones are all different; the border of the whole is sewn together.
            let inner = |number: &usize| {
                let at = [*number as u32 % frames, *number as u32 / frames];
                at.iter().all(|&place| place > 0 && place + 1 < frames)
            };
            let inner: Vec<Vec3> = (0..all.len()).filter(inner).map(|number| all[number]).collect();
            for (i, a) in inner.iter().enumerate() {
                assert!(inner[..i].iter().all(|b| a.distance(*b) > 0.05));
            }
        }
    }

    #[test]
    fn each_view_shows_what_its_viewer_sees() {
        // A trunk, and a head that is not in the middle.
        let all = [
            (Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, 2.0, 0.2), [1.0, 0.0, 0.0]),
            (Vec3::new(-0.5, 2.0, -0.5), Vec3::new(1.5, 3.0, 0.7), [0.0, 1.0, 0.0]),
        ];
        let how = ImpostorView { frames: 5, size_px: 5 * 64 + 3, is_whole: true };
        let seen = impostor(&boxes(&all), &how, &Quiet).unwrap();
        assert_eq!((seen.color.width(), seen.color.height()), (320, 320));
        // By rays through the boxes.
        let (mut wrong, mut count) = (0, 0);
        for number in 0..25_u32 {
            let at = [number % 5, number / 5];
            let toward = direction(at, 5, true);
            let [right, up] = frame(toward);
            assert!((right.cross(up) - toward).length() < 1e-5, "right-handed");
            for (x, y) in (0..64).step_by(3).flat_map(|y| (0..64).step_by(3).map(move |x| (x, y))) {
                let plane = Vec2::new(x as f32 + 0.5, 63.5 - y as f32) / 32.0 - 1.0;
                let from = seen.centre_m + (right * plane.x + up * plane.y + toward) * seen.radius_m;
                let hit = all.iter().filter_map(|&(low, high, color)| {
                    let (mut near, mut far, mut into) = (f32::NEG_INFINITY, f32::INFINITY, 0);
                    for axis in 0..3 {
                        let [a, b] = [low, high].map(|corner| corner[axis] - from[axis]);
                        if toward[axis].abs() < 1e-6 {
                            // Along this side: within it or beside the box.
                            far = if a < 0.0 && b > 0.0 { far } else { f32::NEG_INFINITY };
                            continue;
                        }
                        let [a, b] = [a, b].map(|way| way / -toward[axis]);
                        if a.min(b) > near {
                            (near, into) = (a.min(b), axis);
                        }
                        far = far.min(a.max(b));
                    }
                    (near < far).then_some((near, color, into))
                });
                let hit = hit.min_by(|a, b| a.0.total_cmp(&b.0));
                let place = [at[0] * 64 + x, at[1] * 64 + y];
                let (found, normal) = (pixel(&seen.color, place), pixel(&seen.normal_depth, place));
                count += 1;
                let is_right = match hit {
                    None => found[3] < 128,
                    Some((near, color, axis)) => {
                        let expected = (1.0 - near / (2.0 * seen.radius_m)) * 255.0;
                        let side = if toward[axis] > 0.0 { 255 } else { 0 };
                        found[3] >= 128
                            && [found[0] > 128, found[1] > 128] == [color[0] > 0.5, color[1] > 0.5]
                            && normal[axis].abs_diff(side) < 40
                            && (f32::from(normal[3]) - expected).abs() < 8.0
                    }
                };
                wrong += u32::from(!is_right);
            }
        }
        // Edges lie between pixels.
        assert!(count > 10_000 && wrong * 25 < count, "{wrong} of {count}");
    }

    #[test]
    fn views_fill_their_places_and_no_more() {
        let all = [(Vec3::splat(-1.0), Vec3::splat(1.0), [0.5; 3])];
        let how = ImpostorView { frames: 4, size_px: 128, is_whole: false };
        let seen = impostor(&boxes(&all), &how, &Quiet).unwrap();
        let is_edge = |place: u32| matches!(place % 32, 0 | 31);
        for (y, x) in (0..128).flat_map(|y| (0..128).map(move |x| (y, x))) {
            let is_free = pixel(&seen.color, [x, y])[3] == 0;
            assert!(is_free || !is_edge(x) && !is_edge(y), "{x} {y}");
        }
        // Any number of threads gives the same bytes.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let again = pool.install(|| impostor(&boxes(&all), &how, &Quiet)).unwrap();
        assert!(
            again.color.rgba() == seen.color.rgba() && again.normal_depth.rgba() == seen.normal_depth.rgba()
        );
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let all = [(Vec3::splat(-1.0), Vec3::splat(1.0), [0.5; 3])];
        for (frames, size_px) in [(0, 512), (1, 512), (33, 4096), (16, 100)] {
            let refused = impostor(&boxes(&all), &ImpostorView { frames, size_px, is_whole: false }, &Quiet);
            assert_eq!(refused.err(), Some(ImpostorError::Frames { frames, size_px }));
        }
        let how = ImpostorView { frames: 4, size_px: 128, is_whole: false };
        assert_eq!(impostor(&boxes(&[]), &how, &Quiet).err(), Some(ImpostorError::Empty));
    }
}
