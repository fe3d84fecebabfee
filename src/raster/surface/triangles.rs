//! Triangles → samples.

use glam::{Vec2, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::{Material, Part};
use rayon::prelude::*;

use super::Surface;
use super::samples::Samples;
use super::texels::Texels;
use crate::canvas::{Rows, band_height};
use crate::light::{Air, Lit};
use crate::memory::Ledger;
use crate::strokes::trace::HAIR_PX;
use crate::{RasterError, Size, Style, View};

/// Triangles that one task looks at.
const AT_ONCE: usize = 1 << 13;

/// Whether a part can be drawn: arrays of a length, indices that name vertices, finite places.
pub(super) fn check(part: &Part, materials: &[Material]) -> Option<()> {
    let mesh = &part.mesh;
    let count = mesh.positions.len();
    let lengths = mesh.normals.len() == count && mesh.uvs.len() == count;
    let sound = lengths
        && part.material < materials.len()
        && mesh.triangles.par_iter().all(|t| t.iter().all(|&v| (v as usize) < count))
        && mesh.positions.par_iter().all(|p| p.is_finite());
    sound.then_some(())
}

/// A material's colour from afar, linear light.
pub(super) fn mean_color(material: &Material) -> Vec3 {
    let picture = material.base_color_picture.as_deref();
    let texels = picture.and_then(|picture| Texels::new(picture, u32::MAX));
    texels.map_or(Vec3::from(material.base_color), |texels| texels.mean())
}

/// A vertex in the picture.
#[derive(Clone, Copy, Default)]
struct Vertex {
    /// Samples from the upper left corner.
    at: Vec2,
    /// 1 ÷ metres from the lens.
    nearness: f32,
}

/// A corner of a triangle that is drawn.
#[derive(Clone, Copy)]
struct Corner {
    at: Vec2,
    nearness: f32,
    lit: Lit,
    /// The haze's share.
    haze: f32,
    /// Over the ground, metres; leaves are over it in any case.
    height_m: f32,
    uv: Vec2,
}

/// A picture that cuts outlines is not halved to fewer texels a side: what is left of an atlas of leaves
/// then still has holes between them.
const OUTLINE_TEXELS: f32 = 128.0;

/// A part in the picture.
struct Seen<'a> {
    part: &'a Part,
    vertices: Vec<Vertex>,
    base_color: Vec3,
    texels: Option<Texels>,
    /// Along the side of its picture.
    side: f32,
    /// A leaf.
    is_sheet: bool,
    /// Texels of less alpha are not there.
    cutout: f32,
    /// Pictures are not halved more often.
    coarsest: u32,
}

/// Some triangles of one part, sorted into bands of rows.
struct Bin {
    part: usize,
    bands: Vec<Vec<u32>>,
    /// The smallest number of texels on a sample's side that any of them has.
    finest: f32,
}

impl Bin {
    fn bytes(&self) -> u64 {
        let held: usize = self.bands.iter().map(Vec::capacity).sum();
        bytes_of::<u32>(held) + bytes_of::<Vec<u32>>(self.bands.capacity())
    }
}

/// All triangles that can be seen.
pub(super) struct Triangles<'a> {
    lens: Lens<'a>,
    parts: Vec<Seen<'a>>,
    bins: Vec<Bin>,
    band_height: u32,
}

impl<'a> Triangles<'a> {
    pub fn new(
        (surface, ground_m): (&Surface<'a>, Option<f32>),
        view: &'a View,
        air: &'a Air<'a>,
        style: &Style,
        (size, factor): (Size, u32),
        ledger: &Ledger<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Self, RasterError> {
        let band_height = band_height(size);
        let lens = Lens {
            view,
            air,
            exposure: style.exposure,
            factor,
            ground_m: ground_m.unwrap_or(f32::NEG_INFINITY),
        };
        let mut parts = Vec::with_capacity(surface.parts.len());
        let mut bins = Vec::new();
        for (i, part) in surface.parts.iter().enumerate() {
            let material = &surface.materials[part.material];
            ledger.take(bytes_of::<Vertex>(part.mesh.positions.len()))?;
            let vertices = lens.place(&part.mesh.positions, monitor)?;
            let picture = material.base_color_picture.as_deref();
            let side = picture.map_or(0.0, |p| libm::sqrtf(p.width() as f32 * p.height() as f32));
            let sorter = Sorter {
                part,
                vertices: &vertices,
                texels: side,
                double_sided: material.double_sided,
                // What the skeleton's strokes show in its place. They show no leaves.
                hair: (!surface.skeleton.positions.is_empty() && !material.is_sheet())
                    .then_some(HAIR_PX * factor as f32),
                size: [size.width() * factor, size.height() * factor].map(|n| n as f32),
                scale: view.scale_at_nearness() * factor as f32,
                band: (band_height * factor) as f32,
                bands: size.height().div_ceil(band_height) as usize,
            };
            let sorted = part.mesh.triangles.par_chunks(AT_ONCE).enumerate().map(|(chunk, triangles)| {
                monitor.check()?;
                let bin = sorter.sort(i, chunk * AT_ONCE, triangles);
                ledger.take(bin.bytes())?;
                Ok(bin)
            });
            let sorted = sorted.collect::<Result<Vec<Bin>, RasterError>>()?;
            let finest = sorted.iter().map(|bin| bin.finest).fold(f32::INFINITY, f32::min);
            bins.extend(sorted);
            let coarsest = if material.cutout.is_some() { halvings(side / OUTLINE_TEXELS) } else { u32::MAX };
            let halved = halvings(finest).min(coarsest);
            ledger.take(picture.map_or(0, |picture| Texels::bytes(picture, halved)))?;
            let texels = picture.and_then(|picture| Texels::new(picture, halved));
            let base_color = Vec3::from(material.base_color);
            parts.push(Seen {
                part,
                vertices,
                base_color,
                texels,
                side,
                is_sheet: material.is_sheet(),
                cutout: material.cutout.unwrap_or(0.0),
                coarsest,
            });
        }
        Ok(Self { lens, parts, bins, band_height })
    }

    /// Draws what lies in a band of rows.
    pub fn draw(&self, rows: Rows, samples: &mut Samples, monitor: &dyn Monitor) -> Result<(), RasterError> {
        let band = (rows.top / self.band_height) as usize;
        for bin in &self.bins {
            monitor.check()?;
            let seen = &self.parts[bin.part];
            for &triangle in &bin.bands[band] {
                let corners = seen.part.mesh.triangles[triangle as usize];
                self.triangle(seen, corners.map(|v| self.lens.light(seen, v)), rows, samples);
            }
        }
        Ok(())
    }

    fn triangle(&self, seen: &Seen, corners: [Corner; 3], rows: Rows, samples: &mut Samples) {
        let [a, b, c] = corners;
        let is_in_ground = corners.map(|corner| corner.height_m < 0.0);
        if is_in_ground == [true; 3] {
            return;
        }
        let dips = is_in_ground != [false; 3];
        let (ab, ac) = (b.at - a.at, c.at - a.at);
        let area = ab.perp_dot(ac);
        let first_row = (rows.top * samples.factor) as f32;
        let height = (rows.height * samples.factor) as f32;
        let [top, bottom] = [f32::min, f32::max].map(|of| of(of(a.at.y, b.at.y), c.at.y) - first_row - 0.5);
        let (top, bottom) = (top.ceil().max(0.0), bottom.floor().min(height - 1.0));
        if !(top <= bottom) || area == 0.0 {
            return;
        }
        // Weights of b and c: linear in x and y, 0 and 1 where they should be.
        let over = 1.0 / area;
        let (bx, by) = (ac.y * over, -ac.x * over);
        let (cx, cy) = (-ab.y * over, ab.x * over);
        let slopes = [bx, cx, -(bx + cx)];
        let width = samples.width();
        let halved = seen
            .texels
            .as_ref()
            .map(|_| halvings(fineness(corners.map(|c| c.uv), area) * seen.side).min(seen.coarsest));
        for row in top as u32..=bottom as u32 {
            let y = row as f32 + 0.5 + first_row - a.at.y;
            // Where this row crosses the corner a's column.
            let (wb, wc) = (by * y, cy * y);
            let (mut from, mut to) = (-a.at.x, width as f32 - a.at.x);
            for (weight, slope) in [wb, wc, 1.0 - wb - wc].into_iter().zip(slopes) {
                let zero = -weight / slope;
                if slope > 0.0 {
                    from = from.max(zero);
                } else if slope < 0.0 {
                    to = to.min(zero);
                } else if weight < 0.0 {
                    to = f32::NEG_INFINITY;
                }
            }
            let start = (from + a.at.x - 0.5).ceil().max(0.0);
            let end = (to + a.at.x - 0.5).floor().min(width as f32 - 1.0);
            if !(start <= end) {
                continue;
            }
            let line = row as usize * width as usize;
            for x in start as u32..=end as u32 {
                let dx = x as f32 + 0.5 - a.at.x;
                let (wb, wc) = (wb + bx * dx, wc + cx * dx);
                let mix = |of: fn(&Corner) -> f32| of(&a) + (of(&b) - of(&a)) * wb + (of(&c) - of(&a)) * wc;
                let nearness = mix(|v| v.nearness);
                let at = line + x as usize;
                if nearness <= samples.nearness[at] || (dips && mix(|v| v.height_m) < 0.0) {
                    continue;
                }
                let color = match (&seen.texels, halved) {
                    (Some(texels), Some(halved)) => {
                        let texel = texels.at(a.uv + (b.uv - a.uv) * wb + (c.uv - a.uv) * wc, halved);
                        if texel.w < seen.cutout {
                            continue;
                        }
                        texel.truncate()
                    }
                    _ => seen.base_color,
                };
                samples.nearness[at] = nearness;
                let lit = Lit { sun: mix(|v| v.lit.sun), sky: mix(|v| v.lit.sky) };
                let light = lit.on(color).lerp(self.lens.air.color(), mix(|v| v.haze));
                samples.light[at] = light.extend(1.0);
            }
        }
    }
}

/// Pictures on a sample's side, of a triangle of twice an area in samples.
fn fineness([a, b, c]: [Vec2; 3], area: f32) -> f32 {
    libm::sqrtf(((b - a).perp_dot(c - a) / area).abs())
}

/// How often a picture is to be halved for about one texel a sample.
fn halvings(texels: f32) -> u32 {
    if texels >= 1.0 { libm::log2f(texels) as u32 } else { 0 }
}

/// Where vertices are seen, and in what light.
struct Lens<'a> {
    view: &'a View,
    air: &'a Air<'a>,
    exposure: f32,
    factor: u32,
    /// Wood that is lower is in the ground.
    ground_m: f32,
}

impl Lens<'_> {
    fn place(&self, positions: &[Vec3], monitor: &dyn Monitor) -> Result<Vec<Vertex>, RasterError> {
        let mut vertices = vec![Vertex::default(); positions.len()];
        let chunks = vertices.par_chunks_mut(AT_ONCE).zip(positions.par_chunks(AT_ONCE));
        chunks.try_for_each(|(vertices, positions)| {
            monitor.check()?;
            for (vertex, &place) in vertices.iter_mut().zip(positions) {
                let seen = self.view.project(place);
                *vertex = Vertex { at: seen.at * self.factor as f32, nearness: 1.0 / seen.depth_m };
            }
            Ok::<(), RasterError>(())
        })?;
        Ok(vertices)
    }

    /// Lights a corner. Most triangles of a large tree are hidden twigs, so this waits until one is drawn.
    fn light(&self, seen: &Seen, vertex: u32) -> Corner {
        let (mesh, vertex) = (&seen.part.mesh, vertex as usize);
        let (place, normal) = (mesh.positions[vertex], mesh.normals[vertex]);
        let Lit { sun, sky } =
            if seen.is_sheet { self.air.on_leaf(place, normal) } else { self.air.on_surface(place, normal) };
        let Vertex { at, nearness } = seen.vertices[vertex];
        Corner {
            at,
            nearness,
            lit: Lit { sun: sun * self.exposure, sky: sky * self.exposure },
            haze: self.air.thickness(1.0 / nearness),
            height_m: if seen.is_sheet { f32::INFINITY } else { place.y - self.ground_m },
            uv: mesh.uvs[vertex],
        }
    }
}

/// Finds out which triangles can be seen, and where.
struct Sorter<'a> {
    part: &'a Part,
    vertices: &'a [Vertex],
    /// Along the side of the picture on it; 0 without one.
    texels: f32,
    double_sided: bool,
    /// Wood narrower than this, samples, is left out.
    hair: Option<f32>,
    /// Samples.
    size: [f32; 2],
    /// Samples per metre, for a nearness of 1.
    scale: f32,
    /// Rows of samples in a band.
    band: f32,
    bands: usize,
}

impl Sorter<'_> {
    fn sort(&self, part: usize, first: usize, triangles: &[[u32; 3]]) -> Bin {
        let mut bin = Bin { part, bands: vec![Vec::new(); self.bands], finest: f32::INFINITY };
        for (i, corners) in triangles.iter().enumerate() {
            let seen = corners.map(|v| self.vertices[v as usize]);
            let [a, b, c] = seen.map(|v| v.at);
            // Counter-clockwise from outside, and rows run downwards.
            let area = (b - a).perp_dot(c - a);
            if area == 0.0 || (area > 0.0 && !self.double_sided) {
                continue;
            }
            let (low, high) = (a.min(b).min(c) - 0.5, a.max(b).max(c) - 0.5);
            // Between the samples, or off the picture.
            let (first_x, last_x) = (low.x.ceil().max(0.0), high.x.floor().min(self.size[0] - 1.0));
            let (first_y, last_y) = (low.y.ceil().max(0.0), high.y.floor().min(self.size[1] - 1.0));
            if !(first_x <= last_x && first_y <= last_y) || self.is_hair(*corners, seen) {
                continue;
            }
            if self.texels > 0.0 {
                bin.finest = bin
                    .finest
                    .min(fineness(corners.map(|v| self.part.mesh.uvs[v as usize]), area) * self.texels);
            }
            for band in (first_y / self.band) as usize..=(last_y / self.band) as usize {
                bin.bands[band].push((first + i) as u32);
            }
        }
        bin
    }

    /// Whether a triangle lies on wood that is thinner than a hair. Its normals tell: over an edge
    /// round a bar they turn by as much as the edge is long, in radii.
    fn is_hair(&self, corners: [u32; 3], seen: [Vertex; 3]) -> bool {
        let Some(hair) = self.hair else { return false };
        let mesh = &self.part.mesh;
        [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, k)| {
            // On such a bar no edge that turns is longer than the bar is wide.
            if (seen[i].at - seen[k].at).length_squared() > hair * hair {
                return false;
            }
            let [v, w] = [corners[i], corners[k]].map(|v| v as usize);
            let turn = mesh.normals[v].distance(mesh.normals[w]);
            let length = mesh.positions[v].distance(mesh.positions[w]);
            2.0 * length * self.scale * seen[i].nearness < hair * turn
        })
    }
}
