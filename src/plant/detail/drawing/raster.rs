//! Triangles → samples, without perspective: colours as they are, normals, and the nearest counts.

use std::ops::Range;

use glam::{Vec2, Vec3};

use super::Pixels;
use super::texture::Texture;
use crate::scene::Material;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};

/// Triangles between two looks at the monitor.
const TRIANGLES_PER_CHECK: usize = 1 << 14;

/// What a sample shows.
#[derive(Clone, Copy, Debug)]
pub(in crate::detail) struct Drawn {
    /// Metres towards the viewer; minus infinity where nothing is.
    pub near_m: f32,
    /// Linear, as the material has it.
    pub color: Vec3,
    /// Unit vector: to the right, up, towards the viewer.
    pub normal: Vec3,
    /// The share of light that passes what is nearest, and what passes all behind it: in rows that are counted
    /// ([`ROWS_PER_COUNT`]).
    pub passes: [f32; 2],
}

/// All samples, rows from the top.
pub(in crate::detail) struct Canvas {
    pub size: Pixels,
    pub samples: Vec<Drawn>,
    /// What fell on samples of every so many rows ([`ROWS_PER_COUNT`]), hidden by something nearer or not.
    hits: u64,
}

/// Rows for each in which all is counted: as good for a mean.
pub(super) const ROWS_PER_COUNT: u32 = 4;

impl Canvas {
    pub fn new(size: Pixels) -> Self {
        let nothing =
            Drawn { near_m: f32::NEG_INFINITY, color: Vec3::ZERO, normal: Vec3::Z, passes: [1.0; 2] };
        Self { size, samples: vec![nothing; size.area()], hits: 0 }
    }

    /// How many things lie one behind another where there are any, the mean; 1 of a single layer.
    pub fn layers(&self) -> f32 {
        let rows = self.samples.chunks_exact((self.size.x as usize).max(1)).step_by(ROWS_PER_COUNT as usize);
        let covered = rows.flatten().filter(|sample| sample.near_m > f32::NEG_INFINITY).count();
        if covered == 0 { 1.0 } else { (self.hits as f32 / covered as f32).max(1.0) }
    }
}

/// Where a plane's part of the canvas is, and how it sees.
pub(in crate::detail) struct View {
    /// What corners and nearness are measured from.
    pub origin: Vec3,
    /// Unit vectors of the plane.
    pub right: Vec3,
    pub up: Vec3,
    /// Unit vector to the viewer.
    pub toward: Vec3,
    /// The upper left corner: metres right of the origin and above it.
    pub corner: Vec2,
    /// How much of their tilt normals keep: 1 all, 0 none.
    pub relief: f32,
    /// Whether what is cut out is looked up in pictures as they are. In halved ones leaves narrower than a texel have an
    /// alpha below the threshold everywhere, and vanish.
    pub cuts_whole: bool,
    /// Samples per metre.
    pub scale: f32,
    /// The part's first sample, and how many it has.
    pub first: Pixels,
    pub size: Pixels,
}

/// A corner in the part: samples from its upper left corner, and nearness.
#[derive(Clone, Copy)]
struct Corner {
    at: Vec2,
    near_m: f32,
}

/// Draws a mesh. A material's alpha is tested, and its back is drawn only where it is double-sided: then
/// with the normal that a viewer sees.
pub(in crate::detail) fn draw(
    canvas: &mut Canvas,
    view: &View,
    mesh: &Mesh,
    material: &Material,
    texture: Option<&Texture>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let seen = |vertex: u32| {
        let away = mesh.positions[vertex as usize] - view.origin;
        Corner {
            at: Vec2::new(away.dot(view.right) - view.corner.x, view.corner.y - away.dot(view.up))
                * view.scale,
            near_m: away.dot(view.toward),
        }
    };
    for (index, &triangle) in mesh.triangles.iter().enumerate() {
        if index.is_multiple_of(TRIANGLES_PER_CHECK) {
            monitor.check()?;
        }
        let [a, b, c] = triangle.map(seen);
        // Twice the area; rows run downwards, so that a front has it below zero.
        let (ab, ac) = (b.at - a.at, c.at - a.at);
        let area = ab.perp_dot(ac);
        if area == 0.0 || (area > 0.0 && !material.double_sided) {
            continue;
        }
        let low = a.at.min(b.at).min(c.at);
        let high = a.at.max(b.at).max(c.at);
        let from = (low - 0.5).ceil().max(Vec2::ZERO);
        let to = (high - 0.5).floor().min(view.size.to_vec2() - 1.0);
        if !(from.x <= to.x && from.y <= to.y) {
            continue;
        }
        let uvs = triangle.map(|vertex| mesh.uvs[vertex as usize]);
        let normals = triangle.map(|vertex| mesh.normals[vertex as usize]);
        // Texels that a sample covers choose how much the picture is halved.
        let texture = texture.map(|texture| {
            let covered = ((uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]) / area).abs() * texture.area();
            let halved = texture.halved(covered);
            (halved, if view.cuts_whole { texture.whole() } else { halved })
        });
        // Weights of b and c, and how they change from sample to sample.
        let inverse = 1.0 / area;
        let (across, down) = (Vec2::new(ac.y, -ab.y) * inverse, Vec2::new(-ac.x, ab.x) * inverse);
        for y in from.y as u32..=to.y as u32 {
            let away = Vec2::new(from.x, y as f32) + 0.5 - a.at;
            let first = across * away.x + down * away.y;
            let is_counted = (view.first.y + y).is_multiple_of(ROWS_PER_COUNT);
            let row = (view.first.y + y) as usize * canvas.size.x as usize;
            let row = &mut canvas.samples[row + (view.first.x + from.x as u32) as usize..];
            let inside = inside(first, across, (to.x - from.x) as usize + 1);
            for (x, sample) in inside.clone().zip(&mut row[inside]) {
                let Vec2 { x: s, y: t } = first + across * x as f32;
                if s < 0.0 || t < 0.0 || s + t > 1.0 {
                    continue;
                }
                let near_m = a.near_m + (b.near_m - a.near_m) * s + (c.near_m - a.near_m) * t;
                let is_hidden = near_m <= sample.near_m;
                if is_hidden && !is_counted {
                    continue;
                }
                let color = match texture {
                    None => Vec3::from(material.base_color),
                    Some((halved, cut)) => {
                        let uv = uvs[0] + (uvs[1] - uvs[0]) * s + (uvs[2] - uvs[0]) * t;
                        if material.cutout.is_some_and(|least| cut.at(uv).w < least) {
                            continue;
                        }
                        let color = halved.at(uv);
                        color.truncate() / color.w.max(1e-3)
                    }
                };
                if is_counted {
                    canvas.hits += 1;
                    let passes = material.translucency.map_or(0.0, |through| through.passing(color));
                    let [nearest, behind] = sample.passes;
                    sample.passes =
                        if is_hidden { [nearest, behind * passes] } else { [passes, behind * nearest] };
                }
                if is_hidden {
                    continue;
                }
                let normal = normals[0] + (normals[1] - normals[0]) * s + (normals[2] - normals[0]) * t;
                let mut normal =
                    Vec3::new(normal.dot(view.right), normal.dot(view.up), normal.dot(view.toward));
                if area > 0.0 {
                    normal = -normal;
                }
                // Smooth normals may look away from the viewer at a rim; a picture cannot.
                normal.z = normal.z.max(0.0);
                let normal = Vec3::Z.lerp(normal.normalize_or(Vec3::Z), view.relief);
                *sample = Drawn { near_m, color, normal: normal.normalize_or(Vec3::Z), ..*sample };
            }
        }
    }
    Ok(())
}

/// Which of `count` samples of a row may lie in a triangle: those where both weights, which are `first` and change by
/// `across`, and their sum are between 0 and 1. One too many on either side at most.
fn inside(first: Vec2, across: Vec2, count: usize) -> Range<usize> {
    let (mut low, mut high) = (0.0_f32, count as f32);
    // Each must not be below 0.
    let weights = [(first.x, across.x), (first.y, across.y), (1.0 - first.x - first.y, -across.x - across.y)];
    for (start, change) in weights {
        let root = -start / change;
        if change > 0.0 {
            low = low.max(root);
        } else if change < 0.0 {
            high = high.min(root);
        } else if start < 0.0 {
            return 0..0;
        }
    }
    // Rounded outwards, and a sample more for what rounding does to the weights.
    let from = ((low.floor() - 1.0).max(0.0) as usize).min(count);
    from..((high.ceil() + 2.0).max(0.0) as usize).clamp(from, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Translucency;
    use crate::testing::plain;
    use linden_base::random::Key;

    /// A square of so many samples a side, from a corner and so near.
    fn square(corner: f32, side: f32, near_m: f32) -> Mesh {
        let (low, high) = (corner, corner + side);
        let positions =
            [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Vec3::new(x, y, near_m));
        Mesh {
            positions: positions.to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    #[test]
    fn what_is_hidden_counts_as_a_layer() {
        let view = View {
            origin: Vec3::ZERO,
            right: Vec3::X,
            up: Vec3::Y,
            toward: Vec3::Z,
            corner: Vec2::new(0.0, 16.0),
            relief: 1.0,
            cuts_whole: false,
            scale: 1.0,
            first: Pixels::new(0, 0),
            size: Pixels::new(16, 16),
        };
        let mut canvas = Canvas::new(view.size);
        assert_eq!(canvas.layers(), 1.0);
        let material = plain([0.5; 3], false);
        let mut lay = |mesh: &Mesh, layers: f32| {
            draw(&mut canvas, &view, mesh, &material, None, &linden_base::monitor::Quiet).unwrap();
            // Samples on the edge that two triangles share are in both.
            let found = canvas.layers();
            assert!((found / layers - 1.0).abs() < 0.07, "{found} {layers}");
        };
        lay(&square(0.0, 16.0, 2.0), 1.0);
        // Behind it, and before it.
        lay(&square(0.0, 16.0, 1.0), 2.0);
        lay(&square(0.0, 16.0, 3.0), 3.0);
        // A quarter of it.
        lay(&square(0.0, 8.0, 0.0), 3.25);
    }

    #[test]
    fn light_passes_what_is_nearest_and_each_thing_behind_it_in_any_order() {
        let view = View {
            origin: Vec3::ZERO,
            right: Vec3::X,
            up: Vec3::Y,
            toward: Vec3::Z,
            corner: Vec2::new(0.0, 8.0),
            relief: 1.0,
            cuts_whole: false,
            scale: 1.0,
            first: Pixels::new(0, 0),
            size: Pixels::new(8, 8),
        };
        let leaf = |gray: f32| Material {
            translucency: Some(Translucency { share: 0.5, tint: [1.0; 3] }),
            ..plain([gray; 3], true)
        };
        // A leaf of luminance 0.8 passes 0.4; wood, nothing.
        let layers = [(1.0, leaf(0.8)), (2.0, leaf(0.4)), (3.0, leaf(0.6))];
        let wood = (0.5, plain([0.6; 3], true));
        for (order, with_wood, expected) in [
            ([0, 1, 2], false, [0.3, 0.2 * 0.4]),
            ([2, 1, 0], false, [0.3, 0.2 * 0.4]),
            ([1, 2, 0], false, [0.3, 0.2 * 0.4]),
            ([1, 0, 2], true, [0.3, 0.0]),
        ] {
            let mut canvas = Canvas::new(view.size);
            for (near_m, material) in order.map(|i| &layers[i]).into_iter().chain(with_wood.then_some(&wood))
            {
                // Off the diagonal, which two triangles share.
                draw(
                    &mut canvas,
                    &view,
                    &square(0.0, 8.0, *near_m),
                    material,
                    None,
                    &linden_base::monitor::Quiet,
                )
                .unwrap();
            }
            let found = canvas.samples[4 * 8 + 6].passes;
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{order:?}: {found:?}");
        }
    }

    #[test]
    fn no_sample_of_a_triangle_is_passed_over() {
        let mut found = 0;
        for i in 0..20_000 {
            let key = Key::new(4).child(i);
            let unit = |k: u64| key.child(k).between(-1.0, 1.0) as f32;
            // Flat ones and rows along a side among them.
            let across =
                Vec2::new(unit(0), if i % 5 == 0 { 0.0 } else { unit(1) }) * libm::powf(10.0, unit(2) * 2.0);
            let first =
                Vec2::new(unit(3), if i % 7 == 0 { 0.0 } else { unit(4) }) * libm::powf(10.0, 1.0 + unit(5));
            let range = inside(first, across, 50);
            let truly: Vec<usize> = (0..50)
                .filter(|&x| {
                    let Vec2 { x: s, y: t } = first + across * x as f32;
                    s >= 0.0 && t >= 0.0 && s + t <= 1.0
                })
                .collect();
            assert!(truly.iter().all(|x| range.contains(x)), "{first} {across}: {truly:?} not in {range:?}");
            assert!(range.len() <= truly.len() + 5, "{first} {across}: {truly:?} in {range:?}");
            found += truly.len();
        }
        assert!(found > 5_000, "{found}");
    }
}
