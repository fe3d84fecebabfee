//! How much of each pixel a polygon covers, exactly.
//!
//! Each edge adds its signed area to the pixels it crosses and its height to all that are right of
//! it, so that a running sum along a row is the coverage (the accumulation buffer of Levien's
//! font-rs, 2016). Where a polygon covers a place twice it counts once.

use std::ops::Range;

use glam::Vec2;

/// Coverage 0..1 of the pixels of some rows, `width` to a row. Corners in pixels, Y down.
pub(super) fn coverage(corners: &[Vec2], width: usize, rows: Range<usize>) -> Vec<f32> {
    // One more column: what is right of the picture.
    let stride = width + 1;
    let mut sums = vec![0.0_f32; stride * rows.len()];
    let (top, bottom) = (rows.start as f32, rows.end as f32);
    let last = corners.last().copied();
    for (from, &to) in last.iter().chain(corners).zip(corners) {
        edge(&mut sums, stride, *from - Vec2::new(0.0, top), to - Vec2::new(0.0, top), bottom - top);
    }
    let mut out = Vec::with_capacity(width * rows.len());
    for row in sums.chunks_exact(stride) {
        let mut sum = 0.0;
        out.extend(row[..width].iter().map(|part| {
            sum += part;
            sum.abs().min(1.0)
        }));
    }
    out
}

/// Adds an edge to the sums of rows 0 to `height`: what is left or right of the picture runs along its
/// border instead.
fn edge(sums: &mut [f32], stride: usize, a: Vec2, b: Vec2, height: f32) {
    if a.y == b.y {
        return;
    }
    let most = (stride - 1) as f32;
    let mut from = a;
    let mut cuts = [0.0, most].map(|x| (x - a.x) / (b.x - a.x));
    if b.x < a.x {
        cuts.swap(0, 1);
    }
    for to in cuts.into_iter().filter(|t| *t > 0.0 && *t < 1.0).map(|t| a.lerp(b, t)).chain([b]) {
        let inside = |p: Vec2| Vec2::new(p.x.clamp(0.0, most), p.y);
        bounded(sums, stride, inside(from), inside(to), height);
        from = to;
    }
}

/// Adds an edge between columns of the picture.
fn bounded(sums: &mut [f32], stride: usize, a: Vec2, b: Vec2, height: f32) {
    let (sign, a, b) = if a.y < b.y { (1.0, a, b) } else { (-1.0, b, a) };
    let (from, to) = (a.y.max(0.0), b.y.min(height));
    if !(from < to) {
        return;
    }
    let slope = (b.x - a.x) / (b.y - a.y);
    let (least, most) = (a.x.min(b.x), a.x.max(b.x));
    for row in from as usize..(to.ceil() as usize).min(height as usize) {
        let (y0, y1) = (from.max(row as f32), to.min((row + 1) as f32));
        let tall = y1 - y0;
        if !(tall > 0.0) {
            continue;
        }
        // Rounding must not lead out of the row.
        let at = |y: f32| (a.x + (y - a.y) * slope).clamp(least, most);
        let (p, q) = (at(y0), at(y1));
        let (left, right) = (p.min(q), p.max(q));
        let line = &mut sums[row * stride..][..stride];
        // The edge leaves the row over some pixels: each takes its part of the height, and of that the
        // area on its right; the rest is the next one's.
        let (first, last) = (left as usize, right as usize);
        for x in first..=last {
            let (x0, x1) = (left.max(x as f32), right.min((x + 1) as f32));
            let part = if first == last { tall } else { tall * (x1 - x0) / (right - left) };
            let share = 1.0 - (f32::midpoint(x0, x1) - x as f32);
            line[x] += sign * part * share;
            if x + 1 < stride {
                line[x + 1] += sign * part * (1.0 - share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::random::Key;

    #[test]
    fn coverage_is_what_many_samples_find() {
        const WIDTH: usize = 12;
        for seed in 0..20 {
            let key = Key::new(seed);
            // A star around the middle does not cross itself; it may stick out of the picture.
            let corners: Vec<Vec2> = (0..9)
                .map(|i| {
                    let (s, c) = libm::sincosf(i as f32 / 9.0 * std::f32::consts::TAU);
                    Vec2::splat(6.0) + Vec2::new(c, s) * key.child(i).between(1.0, 9.0) as f32
                })
                .collect();
            let found = coverage(&corners, WIDTH, 2..11);
            let inside = |p: Vec2| {
                let crossings = (0..9).filter(|&i| {
                    let (a, b) = (corners[i], corners[(i + 1) % 9]);
                    (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
                });
                crossings.count() % 2 == 1
            };
            for (i, found) in found.into_iter().enumerate() {
                let corner = Vec2::new((i % WIDTH) as f32, (i / WIDTH + 2) as f32);
                let hits = (0..400).filter(|k| {
                    inside(corner + Vec2::new((k % 20) as f32 + 0.5, (k / 20) as f32 + 0.5) / 20.0)
                });
                let expected = hits.count() as f32 / 400.0;
                assert!((found - expected).abs() < 0.05, "{seed} {i}: {found} {expected}");
            }
        }
    }

    #[test]
    fn rows_do_not_depend_on_how_they_are_cut() {
        let corners = [Vec2::new(0.3, 0.2), Vec2::new(7.1, 3.9), Vec2::new(2.0, 7.7)];
        let all = coverage(&corners, 8, 0..8);
        let cut: Vec<f32> = [0..3, 3..4, 4..8].into_iter().flat_map(|r| coverage(&corners, 8, r)).collect();
        assert!(all.iter().zip(&cut).all(|(a, b)| (a - b).abs() < 1e-5), "{all:?} {cut:?}");
    }
}
