//! The bark's relief in the mesh: what normals only pretend, where wood is seen from near.
//!
//! Edges are halved until they are short enough for the picture of heights, then vertices move along their normals.
//! Which edges are halved depends on their ends' places alone, and vertices at one place move as one: seams of
//! texture coordinates stay closed. Normals stay those of the round wood, for the picture of normals is on top.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use linden_base::memory::{OverMemory, bytes_of};
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};

/// Heights of a tile of bark, by texture coordinates: square, tileable, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Row by row, V up.
    pub values: Vec<f32>,
    /// Values a row.
    pub side: usize,
    /// From 0 to 1, as a share of the tile.
    pub relief: f32,
}

/// Why there is no relief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReliefError {
    /// It would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Edges to one tile, at least: halving makes them up to twice as many. A ridge of bark is some three of them wide.
const EDGES_PER_TILE: f32 = 24.0;
/// Tiles that the radius of wood must have for its edges to be halved: twigs stay as they are.
const THICK: f32 = 1.0 / 8.0;
/// Tiles that it must have for all of the relief: thin wood has thin bark.
const THICKEST: f32 = 1.0 / 4.0;
/// No edge is halved that is shorter, metres.
const SHORTEST_M: f32 = 0.004;
/// The share of the height over which the relief runs out.
const RUN_OUT: f32 = 0.2;
/// An edge is halved as often at most.
const ROUNDS: usize = 8;

impl Heights {
    /// How far the relief stands out of its middle, in tiles.
    pub fn offset(&self, uv: Vec2) -> f32 {
        self.relief * (self.at(uv) - 0.5)
    }

    /// Bilinear.
    fn at(&self, uv: Vec2) -> f32 {
        let n = self.side as f32;
        let at = (uv - uv.floor()) * n - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        let wrapped = |x: f32| (x as i64).rem_euclid(self.side as i64) as usize;
        let value = |dx: f32, dy: f32| self.values[wrapped(low.y + dy) * self.side + wrapped(low.x + dx)];
        let row = |dy: f32| value(0.0, dy) + (value(1.0, dy) - value(0.0, dy)) * part.x;
        row(0.0) + (row(1.0) - row(0.0)) * part.y
    }
}

/// Lays a relief on the wood that is lower than a height over its foot, metres: how far it stands out, in tiles, is
/// asked by place and texture coordinates. The foot is at `ground_m`, or where
/// the wood is lowest. Where it goes on as wood with another bark, in `others`, it stays as it is. What `tags` say of
/// each triangle, they say of its pieces then.
///
/// # Errors
/// [`ReliefError`].
pub fn lay(
    wood: &mut Mesh,
    others: &[&Mesh],
    offset: impl Fn(Vec3, Vec2) -> f32 + Sync,
    (ground_m, height_m): (Option<f32>, f32),
    tags: &mut Vec<u8>,
    monitor: &dyn Monitor,
) -> Result<(), ReliefError> {
    let lowest_m = || wood.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    let foot_m = ground_m.unwrap_or_else(lowest_m);
    if !foot_m.is_finite() {
        return Ok(());
    }
    let top_m = foot_m + height_m;
    let low = others.iter().flat_map(|mesh| &mesh.positions).filter(|place| place.y < top_m);
    let mut still: Vec<[u32; 3]> = low.map(bits).collect();
    still.par_sort_unstable();
    still.dedup();
    for _ in 0..ROUNDS {
        monitor.check()?;
        if !halve(wood, &still, top_m, tags, monitor)? {
            break;
        }
    }
    let (tiles_m, radii_m) = (tile_lengths(wood), radii(wood));
    let moved = |i: usize| -> Vec3 {
        let left = ((top_m - wood.positions[i].y) / (RUN_OUT * height_m)).clamp(0.0, 1.0);
        let thick = (radii_m[i] / (THICKEST * tiles_m[i]).max(1e-6)).min(1.0);
        wood.normals[i] * (tiles_m[i] * offset(wood.positions[i], wood.uvs[i]) * left * thick)
    };
    let moved: Vec<Vec3> = (0..wood.positions.len()).into_par_iter().map(moved).collect();
    // Vertices at one place, one after the other.
    let place = |i: u32| bits(&wood.positions[i as usize]);
    let mut order: Vec<u32> =
        (0..wood.positions.len() as u32).filter(|&i| wood.positions[i as usize].y < top_m).collect();
    order.par_sort_unstable_by_key(|&i| (place(i), i));
    let mut positions = wood.positions.clone();
    for group in order.chunk_by(|&a, &b| place(a) == place(b)) {
        if still.binary_search(&place(group[0])).is_ok() {
            continue;
        }
        let mut mean = group.iter().map(|&i| moved[i as usize]).sum::<Vec3>() / group.len() as f32;
        if (wood.positions[group[0] as usize].y - foot_m).abs() < 1e-3 {
            // The foot stays on its ground.
            mean.y = 0.0;
        }
        for &i in group {
            positions[i as usize] += mean;
        }
    }
    wood.positions = positions;
    Ok(())
}

/// A place to be compared.
fn bits(place: &Vec3) -> [u32; 3] {
    place.to_array().map(f32::to_bits)
}

/// Metres that a tile is long round the wood, at each vertex: the mean over its triangles.
fn tile_lengths(wood: &Mesh) -> Vec<f32> {
    let mut sums = vec![(0.0_f32, 0.0_f32); wood.positions.len()];
    for triangle in &wood.triangles {
        let Some(length_m) = tile_length(wood, *triangle) else { continue };
        for &corner in triangle {
            let (sum, count) = &mut sums[corner as usize];
            *sum += length_m;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect()
}

/// How thick wood is at each vertex: what its normals turn by, by the way there.
fn radii(wood: &Mesh) -> Vec<f32> {
    let mut turns = vec![0.0_f32; wood.positions.len()];
    for &[a, b, c] in &wood.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]].map(|ends| ends.map(|end| end as usize)) {
            let way_m = wood.positions[a].distance(wood.positions[b]);
            let turn = wood.normals[a].distance(wood.normals[b]) / way_m.max(1e-9);
            turns[a] = turns[a].max(turn);
            turns[b] = turns[b].max(turn);
        }
    }
    turns.into_iter().map(|turn| 1.0 / turn.max(1e-6)).collect()
}

/// The length of the place's change with U.
fn tile_length(wood: &Mesh, [a, b, c]: [u32; 3]) -> Option<f32> {
    let at = |i: u32| (wood.positions[i as usize], wood.uvs[i as usize]);
    let ((a, a_uv), (b, b_uv), (c, c_uv)) = (at(a), at(b), at(c));
    let (first, second) = (b_uv - a_uv, c_uv - a_uv);
    let area = first.perp_dot(second);
    let along = ((b - a) * second.y - (c - a) * first.y) / area;
    (area.abs() > 1e-12 && along.is_finite()).then(|| along.length())
}

/// Halves the edges that are too long; whether there was one.
fn halve(
    wood: &mut Mesh,
    still: &[[u32; 3]],
    top_m: f32,
    tags: &mut Vec<u8>,
    monitor: &dyn Monitor,
) -> Result<bool, ReliefError> {
    let (tiles_m, radii_m) = (tile_lengths(wood), radii(wood));
    let is_long = |a: u32, b: u32| {
        let [p, q] = [a, b].map(|i| wood.positions[i as usize]);
        let tile_m = 0.5 * (tiles_m[a as usize] + tiles_m[b as usize]);
        let is_thick = [a, b].iter().all(|&end| radii_m[end as usize] > THICK * tile_m);
        let is_long = p.y.min(q.y) < top_m && p.distance(q) > (tile_m / EDGES_PER_TILE).max(SHORTEST_M);
        is_thick && is_long && ![p, q].iter().all(|end| still.binary_search(&bits(end)).is_ok())
    };
    let sides = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b)));
    let mut long: Vec<(u32, u32)> = wood
        .triangles
        .par_iter()
        .flat_map_iter(|t| sides(*t).into_iter().filter(|&(a, b)| is_long(a, b)))
        .collect();
    // A vertex on a seam is there twice, with tiles of its own: what one side halves, the other does too.
    let place = |i: u32| bits(&wood.positions[i as usize]);
    let ends = |(a, b): (u32, u32)| {
        let (p, q) = (place(a), place(b));
        if p < q { (p, q) } else { (q, p) }
    };
    let mut places: Vec<_> = long.iter().map(|&edge| ends(edge)).collect();
    places.par_sort_unstable();
    places.dedup();
    let twins = wood.triangles.par_iter().flat_map_iter(|t| {
        sides(*t).into_iter().filter(|&edge| {
            let near = wood.positions[edge.0 as usize].y.min(wood.positions[edge.1 as usize].y) < top_m;
            near && places.binary_search(&ends(edge)).is_ok()
        })
    });
    long = twins.collect();
    long.par_sort_unstable();
    long.dedup();
    if long.is_empty() {
        return Ok(false);
    }
    let vertices = wood.positions.len();
    let more = bytes_of::<([f32; 8], [u32; 10])>(vertices + 4 * long.len());
    monitor.admit("laying the bark's relief", more, "lower bark_relief_height, or enlarge bark_tile")?;
    for &(a, b) in &long {
        let [a, b] = [a as usize, b as usize];
        wood.positions.push(0.5 * (wood.positions[a] + wood.positions[b]));
        wood.normals.push((wood.normals[a] + wood.normals[b]).normalize_or(wood.normals[a]));
        wood.uvs.push(0.5 * (wood.uvs[a] + wood.uvs[b]));
    }
    let middle =
        |a: u32, b: u32| long.binary_search(&(a.min(b), a.max(b))).ok().map(|edge| (vertices + edge) as u32);
    let pieces = |&[a, b, c]: &[u32; 3]| -> Vec<[u32; 3]> {
        match (middle(a, b), middle(b, c), middle(c, a)) {
            (None, None, None) => vec![[a, b, c]],
            (Some(p), None, None) => vec![[a, p, c], [p, b, c]],
            (None, Some(q), None) => vec![[b, q, a], [q, c, a]],
            (None, None, Some(r)) => vec![[c, r, b], [r, a, b]],
            (Some(p), Some(q), None) => vec![[p, b, q], [a, p, q], [a, q, c]],
            (None, Some(q), Some(r)) => vec![[q, c, r], [b, q, r], [b, r, a]],
            (Some(p), None, Some(r)) => vec![[r, a, p], [c, r, p], [c, p, b]],
            (Some(p), Some(q), Some(r)) => vec![[a, p, r], [p, b, q], [r, q, c], [p, q, r]],
        }
    };
    if !tags.is_empty() {
        let tagged = wood.triangles.iter().zip(tags.iter());
        *tags = tagged.flat_map(|(corners, &tag)| std::iter::repeat_n(tag, pieces(corners).len())).collect();
    }
    wood.triangles = wood.triangles.par_iter().flat_map_iter(pieces).collect();
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::f32::consts::TAU;

    use linden_base::monitor::Quiet;

    /// An open tube of a metre's radius and four metres' height, three tiles round, its seam a vertex twice.
    fn tube() -> Mesh {
        let mut mesh = Mesh::default();
        for ring in 0..=4_u32 {
            for side in 0..=12_u32 {
                let (sin, cos) = libm::sincosf(TAU * (side % 12) as f32 / 12.0);
                mesh.positions.push(Vec3::new(cos, ring as f32, -sin));
                mesh.normals.push(Vec3::new(cos, 0.0, -sin));
                mesh.uvs.push(Vec2::new(side as f32 / 4.0, ring as f32 / 2.0));
            }
        }
        for ring in 0..4 {
            for side in 0..12 {
                let a = ring * 13 + side;
                mesh.triangles.extend([[a, a + 1, a + 14], [a, a + 14, a + 13]]);
            }
        }
        mesh
    }

    /// Furrows along V: the height by U alone.
    fn furrows(relief: f32) -> impl Fn(Vec3, Vec2) -> f32 + Sync {
        let side = 32;
        let value = |i: usize| 0.5 + 0.5 * libm::sinf(TAU * (i % side) as f32 / side as f32);
        let heights = Heights { values: (0..side * side).map(value).collect(), side, relief };
        move |_, uv| heights.offset(uv)
    }

    /// Triangles at each edge between two places; no edge between two rims is there.
    fn edges(mesh: &Mesh) -> BTreeMap<[[u32; 3]; 2], usize> {
        let mut edges = BTreeMap::new();
        let place = |i: u32| mesh.positions[i as usize].to_array().map(f32::to_bits);
        for [a, b, c] in &mesh.triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let mut ends = [place(*a), place(*b)];
                ends.sort_unstable();
                *edges.entry(ends).or_default() += 1;
            }
        }
        edges
    }

    #[test]
    fn relief_moves_low_wood_and_opens_no_seam() {
        let plain = tube();
        let mut rough = plain.clone();
        lay(&mut rough, &[], furrows(0.05), (None, 2.0), &mut Vec::new(), &Quiet).unwrap();
        assert!(rough.triangles.len() > 8 * plain.triangles.len(), "{}", rough.triangles.len());
        // Every edge but those of the two rims is between two triangles, seam or not.
        let is_rim = |ends: &[[u32; 3]; 2]| {
            let y = ends.map(|end| f32::from_bits(end[1]));
            y.iter().all(|y| *y < 1e-3) || y.iter().all(|y| *y > 3.999)
        };
        for (ends, count) in edges(&rough) {
            assert_eq!(
                count,
                if is_rim(&ends) { 1 } else { 2 },
                "{:?}",
                ends.map(|end| end.map(f32::from_bits))
            );
        }
        // A tile is a third of the girth, about two metres: ridges and furrows stand out by half a twentieth of it.
        let radius = |p: &Vec3| Vec2::new(p.x, p.z).length();
        let low: Vec<f32> = rough.positions.iter().filter(|p| p.y < 1.0).map(radius).collect();
        let (least, most) = low.iter().fold((9.0_f32, 0.0_f32), |(a, b), &r| (a.min(r), b.max(r)));
        assert!((0.04..0.06).contains(&(most - 1.0)), "{most}");
        assert!(least < 0.965 - 0.03 && least > 0.86, "{least}");
        // Above it runs out.
        let high = rough.positions.iter().filter(|p| p.y > 2.001);
        assert!(high.clone().all(|p| plain.positions.contains(p) || radius(p) > 0.96));
        assert!(rough.positions.iter().any(|p| p.y == 0.0) && rough.positions.iter().all(|p| p.y >= 0.0));
    }

    #[test]
    fn twigs_stay_as_they_are_but_for_a_little() {
        let mut twig = tube();
        for position in &mut twig.positions {
            (position.x, position.z) = (0.01 * position.x, 0.01 * position.z);
        }
        // As textured as the thick one: a hundredth of the tiles round it.
        twig.uvs.iter_mut().for_each(|uv| uv.x *= 0.01);
        let plain = twig.clone();
        lay(&mut twig, &[], furrows(0.05), (None, 2.0), &mut Vec::new(), &Quiet).unwrap();
        assert_eq!(twig.triangles, plain.triangles);
        let most =
            twig.positions.iter().zip(&plain.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(most < 0.2 * 0.01, "{most}");
    }

    #[test]
    fn where_wood_goes_on_with_another_bark_it_stays() {
        let (mut low, mut high) = (tube(), tube());
        low.triangles.truncate(2 * 12);
        high.triangles.drain(..2 * 12);
        // The second ring is in both.
        high.positions.drain(..13);
        lay(&mut low, &[&high], furrows(0.05), (None, 4.0), &mut Vec::new(), &Quiet).unwrap();
        let ring: Vec<Vec3> = tube().positions[13..26].to_vec();
        assert!(low.positions[13..26] == ring[..]);
        assert!(low.positions.iter().filter(|p| p.y == 1.0).all(|p| ring.contains(p)));
        assert!(low.positions.iter().any(|p| Vec2::new(p.x, p.z).length() > 1.03));
    }

    #[test]
    fn it_is_the_same_each_time() {
        let [mut a, mut b] = [tube(), tube()];
        lay(&mut a, &[], furrows(0.05), (None, 2.0), &mut Vec::new(), &Quiet).unwrap();
        lay(&mut b, &[], furrows(0.05), (None, 2.0), &mut Vec::new(), &Quiet).unwrap();
        assert!(a == b);
    }
}
