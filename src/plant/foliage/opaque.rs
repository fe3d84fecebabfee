//! What a picture leaves of the triangles that show it.

use glam::{DVec2, Vec2};

use super::RIM;
use linden_base::mesh::Mesh;
use linden_base::picture::Picture;

/// The share of each triangle that a picture does not cut out.
pub(crate) fn opaque_shares(mesh: &Mesh, picture: Option<&Picture>) -> Vec<f64> {
    let Some(picture) = picture else { return vec![1.0; mesh.triangles.len()] };
    let share = |triangle: &[u32; 3]| opaque_share(picture, triangle.map(|v| mesh.uvs[v as usize]));
    mesh.triangles.iter().map(share).collect()
}

/// The share of the pixels whose middles lie in a triangle (texture coordinates, V up) that are not cut out; for a
/// triangle between all of them, whether the pixel in its middle is.
fn opaque_share(picture: &Picture, corners: [Vec2; 3]) -> f64 {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let size = Vec2::new(width as f32, height as f32);
    let corners = corners.map(|uv| (Vec2::new(uv.x, 1.0 - uv.y) * size).as_dvec2());
    let is_opaque = |x: usize, y: usize| f32::from(picture.rgba()[4 * (y * width + x) + 3]) >= RIM * 255.0;
    let (mut all, mut opaque) = (0_u64, 0_u64);
    let lines = corners.map(|corner| corner.y);
    let (low, high) =
        (lines.into_iter().fold(f64::MAX, f64::min), lines.into_iter().fold(f64::MIN, f64::max));
    for y in (low - 0.5).ceil().max(0.0) as usize..((high - 0.5).ceil().max(0.0) as usize).min(height) {
        let middle = y as f64 + 0.5;
        // Where the triangle's edges cross the row of middles.
        let crossings = (0..3).filter_map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            ((a.y > middle) != (b.y > middle)).then(|| a.x + (middle - a.y) / (b.y - a.y) * (b.x - a.x))
        });
        let (left, right) = crossings.fold((f64::MAX, f64::MIN), |(l, r), x| (l.min(x), r.max(x)));
        if left > right {
            continue;
        }
        let columns =
            (left - 0.5).ceil().max(0.0) as usize..((right - 0.5).ceil().max(0.0) as usize).min(width);
        all += columns.len() as u64;
        opaque += columns.filter(|&x| is_opaque(x, y)).count() as u64;
    }
    if all > 0 {
        return opaque as f64 / all as f64;
    }
    let middle = corners.iter().sum::<DVec2>() / 3.0;
    let pixel = |at: f64, count: usize| (at.max(0.0) as usize).min(count.saturating_sub(1));
    if width * height > 0 && is_opaque(pixel(middle.x, width), pixel(middle.y, height)) { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_opaque_share_is_that_of_the_pixels() {
        // Left half opaque.
        let rgba = (0..64 * 64).flat_map(|i| [0, 0, 0, if i % 64 < 32 { 255 } else { 0 }]).collect();
        let picture = Picture::new(64, 64, rgba);
        let of = |corners: [[f32; 2]; 3]| opaque_share(&picture, corners.map(Vec2::from));
        assert_eq!(of([[0.0, 0.0], [0.5, 0.0], [0.5, 1.0]]), 1.0);
        assert_eq!(of([[0.5, 0.0], [1.0, 0.0], [1.0, 1.0]]), 0.0);
        assert!((of([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) - 0.75).abs() < 0.01);
        assert!((of([[1.0, 0.0], [0.0, 0.0], [1.0, 1.0]]) - 0.25).abs() < 0.01);
        assert_eq!(of([[0.2, 0.5], [0.2, 0.5], [0.2, 0.5]]), 1.0, "no pixel's middle in it");
        assert_eq!(of([[0.8, 0.5], [0.8, 0.5], [0.8, 0.5]]), 0.0);
    }
}
