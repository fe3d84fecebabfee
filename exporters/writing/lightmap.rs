//! A second set of texture coordinates in which every place of the surface has one of its own, for light that is baked
//! into a picture.
//!
//! Charts are the pieces of the surface that texture coordinates cover without a seam: a branch, a leaf. Each keeps
//! its shape in the first set, stretched to metres so that equal areas get equal shares of the picture, and they are
//! packed on shelves, the highest first (next fit, decreasing height: Coffman et al. 1980, "Performance bounds for
//! level-oriented two-dimensional packing algorithms", section 2). Vertices stay as they are, none is added.
//!
//! Engines have a picture for each mesh: parts that a format puts into one mesh share it ([`Sharing`]).

use glam::{DVec2, Vec2, Vec3};
use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::Mesh;
use linden_pipeline::stage::Stage;
use rayon::prelude::*;

use super::distinct::{DistinctMeshes, MeshPart};
use crate::options::OptionSpec;
use crate::{Bundle, ExportError};

pub(crate) const LIGHTMAP_UV: OptionSpec = OptionSpec::switch(
    "lightmap_uv",
    false,
    "a second set of texture coordinates without overlaps, for baked light",
);

/// Sides of the picture that charts are apart, where few of them are there: two texels of 1024.
const MARGIN: f64 = 2.0 / 1024.0;
/// Most of the picture that margins take each way, of as many charts as there are.
const MARGINS: f64 = 1.0 / 8.0;
/// Halvings that the scale is found by.
const HALVINGS: u32 = 30;

/// Which parts a picture is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sharing {
    /// One each.
    None,
    /// Those of a plant at a level of detail together, but for what stands in many places.
    Models,
}

/// Gives all parts but the sky a [`MeshPart::lightmap`].
///
/// # Errors
/// [`ExportError::Memory`] and [`ExportError::Cancelled`].
pub(crate) fn unwrap(
    distinct: &mut DistinctMeshes<'_>,
    sharing: Sharing,
    stage: &Stage<'_>,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let bytes = stage.bytes().saturating_add(bytes(distinct));
    monitor.admit("laying out light maps", bytes, "write without lightmap_uv, or a coarser level")?;
    let mut folded = 0;
    let mut give = |parts: &mut [&mut MeshPart<'_>]| {
        monitor.check()?;
        let meshes: Vec<&Mesh> = parts.iter().map(|part| &*part.mesh).collect();
        let (sets, folds) = of_meshes(&meshes);
        for (part, set) in parts.iter_mut().zip(sets) {
            part.lightmap = Some(set);
        }
        folded += folds;
        Ok::<(), ExportError>(())
    };
    for model in &mut distinct.models {
        let mut shared = Vec::new();
        for part in &mut model.parts {
            if sharing == Sharing::Models && part.copies.is_none() {
                shared.push(part);
            } else {
                give(&mut [part])?;
            }
        }
        give(&mut shared)?;
    }
    for part in distinct.cover.iter_mut().chain(&mut distinct.ground) {
        give(&mut [part])?;
    }
    if folded > 0 {
        bundle.note(format!(
            "lightmap_uv: {folded} pieces of the surface lie over themselves in their texture coordinates and so in the \
             second set; an engine that makes a set of its own has none of them"
        ));
    }
    Ok(())
}

/// Bytes that the sets take, once they are there.
pub(crate) fn held_bytes(distinct: &DistinctMeshes<'_>) -> u64 {
    distinct.parts().flat_map(|part| &part.lightmap).map(|set| bytes_of::<Vec2>(set.len())).sum()
}

/// Bytes that the sets take, and making them.
fn bytes(distinct: &DistinctMeshes<'_>) -> u64 {
    distinct
        .parts()
        .map(|part| {
            let vertices = part.mesh.positions.len();
            // The set, the chart of each vertex while it is found, and charts of four vertices or more.
            bytes_of::<(Vec2, u32, u32)>(vertices) + bytes_of::<(Sums, Chart, Placed)>(vertices / 4)
        })
        .sum()
}

/// A piece of a mesh whose texture coordinates have no seam.
#[derive(Clone, Copy)]
struct Chart {
    flat: Flat,
    /// Metres.
    low: DVec2,
    /// Metres.
    size: DVec2,
    is_folded: bool,
}

/// How a chart is laid flat.
#[derive(Clone, Copy)]
enum Flat {
    /// As its texture coordinates are, times metres.
    Stretched(DVec2),
    /// Seen along its normal, where it has no texture coordinates: by two axes.
    Seen([Vec3; 2]),
}

impl Flat {
    fn at(self, mesh: &Mesh, vertex: usize) -> DVec2 {
        match self {
            Self::Stretched(metres) => mesh.uvs[vertex].as_dvec2() * metres,
            Self::Seen(axes) => Vec2::from(axes.map(|axis| axis.dot(mesh.positions[vertex]))).as_dvec2(),
        }
    }
}

/// Where a chart is in the picture.
#[derive(Clone, Copy, Default)]
struct Placed {
    corner: DVec2,
    /// Parts of the picture a metre, along its own axes.
    scale: DVec2,
    /// A quarter to the left, so that its long side lies along the shelf.
    is_turned: bool,
}

impl Placed {
    fn of(self, point: DVec2, chart: &Chart) -> Vec2 {
        let at = point - chart.low;
        let at = if self.is_turned { DVec2::new(at.y, chart.size.x - at.x) } else { at };
        (self.corner + at * self.scale).clamp(DVec2::ZERO, DVec2::ONE).as_vec2()
    }
}

/// The second sets of meshes that share a picture, and how many charts lie over themselves.
fn of_meshes(meshes: &[&Mesh]) -> (Vec<Vec<Vec2>>, usize) {
    let found: Vec<(Vec<u32>, Vec<Chart>)> = meshes.par_iter().map(|mesh| charts(mesh)).collect();
    let all: Vec<Chart> = found.iter().flat_map(|(_, charts)| charts).copied().collect();
    let placed = pack(&all);
    let mut first = 0;
    let sets = meshes.iter().zip(&found).map(|(mesh, (of_vertices, charts))| {
        let placed = &placed[first..first + charts.len()];
        first += charts.len();
        let place = |(vertex, &chart): (usize, &u32)| {
            let chart = chart as usize;
            placed[chart].of(charts[chart].flat.at(mesh, vertex), &charts[chart])
        };
        of_vertices.par_iter().enumerate().map(place).collect()
    });
    (sets.collect(), all.iter().filter(|chart| chart.is_folded).count())
}

/// The chart of each vertex, and all charts by their first vertex.
fn charts(mesh: &Mesh) -> (Vec<u32>, Vec<Chart>) {
    let (of_vertices, count) = components(mesh);
    let mut sums = vec![Sums::default(); count];
    for &triangle in &mesh.triangles {
        let sum = &mut sums[of_vertices[triangle[0] as usize] as usize];
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let [ta, tb, tc] = triangle.map(|vertex| mesh.uvs[vertex as usize].as_dvec2());
        let (side, other) = (tb - ta, tc - ta);
        let (edge, edge_other) = (b - a, c - a);
        let area = side.perp_dot(other);
        // The lengths of the position's derivatives times that area (Lengyel 2001, "Computing tangent space basis
        // vectors for an arbitrary mesh").
        let length = |x: f64, y: f64| (edge.as_dvec3() * y - edge_other.as_dvec3() * x).length();
        sum.stretched += DVec2::new(length(side.y, other.y), length(side.x, other.x));
        sum.area += area.abs();
        sum.signed += area;
        sum.normal += edge.cross(edge_other);
    }
    let flats: Vec<Flat> = sums.iter().map(Sums::flat).collect();
    let mut boxes = vec![(DVec2::INFINITY, DVec2::NEG_INFINITY); count];
    for (vertex, &chart) in of_vertices.iter().enumerate() {
        let chart = chart as usize;
        let at = flats[chart].at(mesh, vertex);
        let (low, high) = &mut boxes[chart];
        (*low, *high) = (low.min(at), high.max(at));
    }
    let charts = flats.into_iter().zip(boxes).zip(&sums).map(|((flat, (low, high)), sum)| Chart {
        flat,
        low,
        size: high - low,
        is_folded: sum.is_folded(),
    });
    (of_vertices, charts.collect())
}

/// What the triangles of a chart add up to.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Metres a unit of texture coordinates, each way, times `area`.
    stretched: DVec2,
    /// Twice the area in texture coordinates, and with its sign.
    area: f64,
    signed: f64,
    normal: Vec3,
}

impl Sums {
    fn flat(&self) -> Flat {
        let metres = self.stretched / self.area;
        if metres.is_finite() && metres.cmpgt(DVec2::ZERO).all() {
            return Flat::Stretched(metres);
        }
        let (across, up) = self.normal.normalize_or(Vec3::Z).any_orthonormal_pair();
        Flat::Seen([across, up])
    }

    /// Whether more than a hundredth of it runs against the rest.
    fn is_folded(&self) -> bool {
        self.area - self.signed.abs() > 0.02 * self.area
    }
}

/// By vertex, the number of the component that triangles join it to, and how many there are. Numbers follow the
/// first vertices.
pub(crate) fn components(mesh: &Mesh) -> (Vec<u32>, usize) {
    let mut parents: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let root = |parents: &mut Vec<u32>, mut at: u32| {
        while parents[at as usize] != at {
            let above = parents[parents[at as usize] as usize];
            parents[at as usize] = above;
            at = above;
        }
        at
    };
    for &[a, b, c] in &mesh.triangles {
        let [a, b, c] = [a, b, c].map(|vertex| root(&mut parents, vertex));
        let first = a.min(b).min(c);
        for above in [a, b, c] {
            parents[above as usize] = first;
        }
    }
    // A parent has a smaller number than what is below it.
    let mut count = 0;
    let mut numbers = vec![0; parents.len()];
    for vertex in 0..parents.len() {
        let above = parents[vertex] as usize;
        numbers[vertex] = if above == vertex {
            count += 1;
            count - 1
        } else {
            numbers[above]
        };
    }
    (numbers, count as usize)
}

/// Places of charts in the unit square, as large as they can be together.
fn pack(charts: &[Chart]) -> Vec<Placed> {
    let margin = MARGIN.min(MARGINS / (charts.len().max(1) as f64).sqrt());
    let lying = |chart: &Chart| chart.size.max_element();
    let standing = |chart: &Chart| chart.size.min_element();
    let mut order: Vec<u32> = (0..charts.len() as u32).collect();
    order.par_sort_by(|&a, &b| {
        let [first, second] = [a, b].map(|at| &charts[at as usize]);
        let by_height = standing(second).total_cmp(&standing(first));
        by_height.then(lying(second).total_cmp(&lying(first))).then(a.cmp(&b))
    });
    let widest = 1.0 - margin;
    // The height that shelves take at a scale; `put` is told where each chart begins.
    let shelve = |scale: f64, put: &mut dyn FnMut(usize, DVec2)| {
        let (mut corner, mut height) = (DVec2::ZERO, 0.0);
        for &at in &order {
            let chart = &charts[at as usize];
            let width = (scale * lying(chart)).min(widest) + margin;
            if corner.x > 0.0 && corner.x + width > 1.0 {
                corner = DVec2::new(0.0, corner.y + height);
            }
            if corner.x == 0.0 {
                height = scale * standing(chart) + margin;
            }
            put(at as usize, corner);
            corner.x += width;
        }
        corner.y + height
    };
    let area: f64 = charts.iter().map(|chart| chart.size.x * chart.size.y).sum();
    // Charts that are shortened may take less than their area.
    let tallest = order.first().map_or(0.0, |&at| standing(&charts[at as usize]));
    let mut too_large = if tallest > 0.0 { (1.0 / tallest).max(1.0 / area.sqrt()) } else { 1.0 };
    let mut scale = 0.0;
    for _ in 0..HALVINGS {
        let between = 0.5 * (scale + too_large);
        if shelve(between, &mut |_, _| ()) <= 1.0 {
            scale = between;
        } else {
            too_large = between;
        }
    }
    let mut placed = vec![Placed::default(); charts.len()];
    shelve(scale, &mut |at, corner| {
        let chart = &charts[at];
        let long = lying(chart);
        let along = if scale * long > widest { widest / long } else { scale };
        placed[at] = Placed {
            corner: corner + 0.5 * margin,
            scale: DVec2::new(along, scale),
            is_turned: chart.size.y > chart.size.x,
        };
    });
    placed
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    /// A branch: sides, rings, radius, length; texture coordinates that repeat round it and along.
    fn tube(sides: usize, rings: usize, radius: f32, length: f32, tiles: Vec2) -> Mesh {
        let mut mesh = Mesh::default();
        for ring in 0..=rings {
            for side in 0..=sides {
                let [round, along] = [side as f32 / sides as f32, ring as f32 / rings as f32];
                let (sin, cos) = libm::sincosf(TAU * round);
                mesh.positions.push(Vec3::new(radius * cos, length * along, radius * sin));
                mesh.uvs.push(Vec2::new(round, along) * tiles);
            }
        }
        mesh.normals = vec![Vec3::Y; mesh.positions.len()];
        let at = |ring: usize, side: usize| (ring * (sides + 1) + side) as u32;
        for (ring, side) in (0..rings).flat_map(|ring| (0..sides).map(move |side| (ring, side))) {
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
        mesh
    }

    fn join(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
        meshes.into_iter().fold(Mesh::default(), |mut all, mesh| {
            let first = all.positions.len() as u32;
            all.positions.extend(mesh.positions);
            all.normals.extend(mesh.normals);
            all.uvs.extend(mesh.uvs);
            all.triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|vertex| first + vertex)));
            all
        })
    }

    /// A tree of sorts: a long trunk, branches, and many leaves on one picture.
    fn tree() -> [Mesh; 2] {
        let branches = (0..40_u8).map(|i| {
            let i = f32::from(i);
            tube(5 + i as usize % 4, 3, 0.4 / (1.0 + i), 8.0 / (1.0 + 0.2 * i), Vec2::new(2.0, 0.3 * i + 0.5))
        });
        let leaves = (0..900_u16).map(|i| tube(1, 1 + usize::from(i % 3), 0.02, 0.05, Vec2::ONE));
        // A strip is no tube: one side of it.
        let leaves = leaves.map(|mut leaf| {
            leaf.positions
                .iter_mut()
                .enumerate()
                .for_each(|(i, position)| position.x = 0.03 * (i % 2) as f32);
            leaf
        });
        [join(branches), join(leaves)]
    }

    /// Area of each triangle on the surface, and in the picture.
    fn areas<'a>(mesh: &'a Mesh, set: &'a [Vec2]) -> impl Iterator<Item = (f64, f64)> + 'a {
        mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
            let [p, q, r] = triangle.map(|vertex| set[vertex as usize].as_dvec2());
            (0.5 * (b - a).cross(c - a).length(), 0.5 * (q - p).perp_dot(r - p).abs())
        })
    }

    /// The corners of the box round each component, found by walking over triangles until nothing changes.
    fn boxes(mesh: &Mesh, set: &[Vec2]) -> Vec<(Vec2, Vec2)> {
        let mut least: Vec<usize> = (0..set.len()).collect();
        loop {
            let before = least.clone();
            for triangle in &mesh.triangles {
                let first = triangle.iter().map(|&vertex| least[vertex as usize]).min().unwrap();
                for &vertex in triangle {
                    least[vertex as usize] = first;
                }
            }
            if least == before {
                break;
            }
        }
        let mut boxes = std::collections::BTreeMap::new();
        for (vertex, &at) in set.iter().enumerate() {
            let (low, high) = boxes.entry(least[vertex]).or_insert((at, at));
            (*low, *high) = (low.min(at), high.max(at));
        }
        boxes.into_values().collect()
    }

    #[test]
    fn charts_are_apart_inside_of_the_picture_and_fill_most_of_it() {
        let [wood, leaves] = tree();
        for meshes in [vec![&wood], vec![&leaves], vec![&wood, &leaves]] {
            let (sets, folded) = of_meshes(&meshes);
            assert_eq!(folded, 0);
            let boxes: Vec<_> = meshes.iter().zip(&sets).flat_map(|(mesh, set)| boxes(mesh, set)).collect();
            let margin = MARGIN.min(MARGINS / (boxes.len() as f64).sqrt()) as f32;
            for (i, (low, high)) in boxes.iter().enumerate() {
                let inside = low.cmpge(Vec2::splat(0.49 * margin)).all()
                    && high.cmple(Vec2::splat(1.0 - 0.49 * margin)).all();
                assert!(inside, "{low} {high}");
                for (other_low, other_high) in &boxes[..i] {
                    let gap = (low - other_high).max(other_low - high).max_element();
                    assert!(gap > 0.99 * margin, "{i}: {gap} of {margin}");
                }
            }
            let used: f64 =
                meshes.iter().zip(&sets).flat_map(|(mesh, set)| areas(mesh, set)).map(|(_, used)| used).sum();
            assert!(used > 0.55, "{used}");
        }
    }

    #[test]
    fn equal_areas_of_the_surface_have_equal_shares() {
        // None is so long that it is shortened.
        let branches = (1..9_u8).map(|i| tube(6, 4, 0.1 / f32::from(i), 1.0, Vec2::new(1.0, f32::from(i))));
        let mesh = join(branches);
        let (sets, _) = of_meshes(&[&mesh]);
        let densities: Vec<f64> = areas(&mesh, &sets[0]).map(|(area, used)| used / area).collect();
        assert!(densities.iter().all(|density| (density / densities[0] - 1.0).abs() < 1e-3), "{densities:?}");
    }

    #[test]
    fn what_has_no_texture_coordinates_is_seen_from_before_it_and_folds_are_counted() {
        let mut flat = tube(4, 2, 0.2, 1.0, Vec2::ZERO);
        flat.positions.iter_mut().enumerate().for_each(|(i, position)| position.x = 0.1 * (i % 5) as f32);
        flat.positions.iter_mut().for_each(|position| position.z = 0.0);
        let (sets, folded) = of_meshes(&[&flat]);
        assert_eq!(folded, 0);
        assert!(areas(&flat, &sets[0]).all(|(area, used)| area == 0.0 || used / area > 0.5));
        let mut folded = tube(4, 2, 0.2, 1.0, Vec2::ONE);
        folded.uvs.iter_mut().for_each(|uv| uv.x = (uv.x - 0.5).abs());
        assert_eq!(of_meshes(&[&folded]).1, 1);
        // Nothing to lay out, and points that no triangle joins.
        assert_eq!(of_meshes(&[]).0.len(), 0);
        let alone = Mesh { triangles: Vec::new(), ..flat };
        assert!(of_meshes(&[&alone]).0[0].iter().all(|at| at.is_finite()));
    }
}
