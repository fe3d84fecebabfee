//! Shadow propagation: a grid of shade that every node adds to.
//!
//! Pałubicki et al. 2009, section 4.2.1 (shadow propagation): a node in voxel (i, j, k) adds `a·b^−q` to the
//! voxels (i ± p, j − q, k ± p), 0 ≤ p ≤ q ≤ depth, a pyramid that hangs below it. Shade is counted in
//! integers, [`FULL_LIGHT`] to the full light of the sky: sums are the same in any order, and what is taken out again
//! leaves nothing behind. The ground, y = 0, takes none.

use std::cmp::Reverse;

use glam::DVec3;
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::Monitor;
#[cfg(test)]
use linden_base::monitor::Quiet;

use crate::SelfOrganizing;
use crate::light::{FULL_LIGHT, Voxel};
use crate::plane::Plane;
use crate::tree::Nodes;

/// Voxels along the edge of a brick.
const EDGE: i32 = 8;
/// log2 of that.
const SHIFT: u32 = 3;
/// log2 of the edge of the tiles in which shade is added, voxels.
const TILE_SHIFT: u32 = 8;
/// Voxels of a brick: rows along z, x running faster than y. Of 32 bytes, so that a row is a vector of many machines.
type Brick = [[u32; EDGE as usize]; (EDGE * EDGE) as usize];
/// Where the index has no brick.
const NO_BRICK: u32 = u32::MAX;

const DOING: &str = "keeping the light of a growing tree";
const ADVICE: &str = "lower years or vigor, or raise internode";

/// A grid of shade, and what each node adds to it.
#[derive(Clone, Debug)]
pub(crate) struct Shadow {
    pub grid: LightGrid,
    pub pyramid: Pyramid,
}

impl Shadow {
    pub fn new(settings: &SelfOrganizing) -> Self {
        let SelfOrganizing { shade, shade_falloff, shade_depth, light_from, .. } = *settings;
        let pyramid = Pyramid::new(shade, shade_falloff, shade_depth, light_from);
        Self { grid: LightGrid::default(), pyramid }
    }

    /// The light of a bud in a node's voxel: `max(1 − shade + own shade, 0)`.
    pub fn light(&self, nodes: &Nodes, node: usize) -> u32 {
        // A foot has no leaves, and casts no shade.
        let cast = if nodes.is_foot(node) { 0 } else { self.pyramid.at_node() };
        (FULL_LIGHT + cast).saturating_sub(self.grid.shade(nodes.voxel(node))).min(FULL_LIGHT)
    }

    /// Where less shade is; zero where all is alike.
    pub fn brighter(&self, voxel: Voxel) -> DVec3 {
        DVec3::from_array(self.grid.gradient(voxel).map(|part| part as f64)).normalize_or_zero()
    }
}

/// The pyramid of shade below a node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pyramid {
    layers: Vec<Layer>,
}

/// One layer of a pyramid: a square of 2q + 1 voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layer {
    /// The shade in each voxel.
    pub shade: u32,
    /// How far the square is moved away from the light, voxels.
    pub x: i32,
    pub z: i32,
}

impl Pyramid {
    /// `shade · falloff^−q` in layer q, from 0 to `depth`; each layer is moved by what the direction to the
    /// light, tilted by 45° at most, asks for.
    pub fn new(shade: f64, falloff: f64, depth: u32, to_light: [f64; 3]) -> Self {
        let [x, y, z] = to_light;
        let level = libm::hypot(x, z);
        // tan of the tilt, at most 1.
        let slope = if level > 0.0 { 1.0 / level.max(y) } else { 0.0 };
        let mut weight = shade * f64::from(FULL_LIGHT);
        let layers = (0..=depth).map(|q| {
            let moved = |along: f64| -libm::round(f64::from(q) * along * slope) as i32;
            let layer = Layer { shade: libm::round(weight) as u32, x: moved(x), z: moved(z) };
            weight /= falloff;
            layer
        });
        Self { layers: layers.collect() }
    }

    /// The shade in the node's voxel.
    pub fn at_node(&self) -> u32 {
        self.layers[0].shade
    }

    /// The layers below the node's.
    pub fn depth(&self) -> i32 {
        self.layers.len() as i32 - 1
    }

    /// What a node shades of a level that its pyramid reaches: from and to along x and z, and the shade there.
    pub fn square(&self, [x, above, z]: Voxel, y: i32) -> ([[i32; 2]; 2], u32) {
        let q = above - y;
        let layer = self.layers[q as usize];
        let (x, z) = (x + layer.x, z + layer.z);
        ([[x - q, x + q], [z - q, z + q]], layer.shade)
    }

    /// The corners of the box around the pyramid of a voxel.
    fn reach(&self, [x, y, z]: Voxel) -> [Voxel; 2] {
        let mut corners = [[x, y, z]; 2];
        for (q, layer) in (0..).zip(&self.layers) {
            corners[0][0] = corners[0][0].min(x + layer.x - q);
            corners[1][0] = corners[1][0].max(x + layer.x + q);
            corners[0][2] = corners[0][2].min(z + layer.z - q);
            corners[1][2] = corners[1][2].max(z + layer.z + q);
            corners[0][1] = (y - q).max(0);
        }
        corners
    }
}

/// A node that begins or ceases to cast shade.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    pub voxel: Voxel,
    /// Whether its shade, which was there, is to go.
    pub is_gone: bool,
}

/// Bricks by number, in stacks that stay where they are: a list would have to be copied as it grows.
#[derive(Clone, Debug, Default)]
struct Bricks {
    stacks: Vec<Box<[Brick]>>,
    count: u32,
}

impl Bricks {
    /// Bricks of a stack.
    const STACK: u32 = 64;
    const STACK_BYTES: u64 = bytes_of::<Brick>(Self::STACK as usize);

    fn is_full(&self) -> bool {
        self.count as usize == self.stacks.len() * Self::STACK as usize
    }

    fn bytes(&self) -> u64 {
        self.stacks.len() as u64 * Self::STACK_BYTES
    }

    fn get(&self, brick: u32) -> &Brick {
        &self.stacks[(brick / Self::STACK) as usize][(brick % Self::STACK) as usize]
    }

    fn get_mut(&mut self, brick: u32) -> Option<&mut Brick> {
        self.stacks.get_mut((brick / Self::STACK) as usize)?.get_mut((brick % Self::STACK) as usize)
    }

    /// Adds a brick without shade; its number.
    fn push(&mut self) -> u32 {
        if self.is_full() {
            let bright = [[0; EDGE as usize]; (EDGE * EDGE) as usize];
            self.stacks.push(vec![bright; Self::STACK as usize].into());
        }
        self.count += 1;
        self.count - 1
    }
}

/// The shade in all voxels. Bricks of 8³ appear where something is shaded; without one, there is no shade.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightGrid {
    /// The brick at the index' corner.
    origin: Voxel,
    /// Bricks along x, y and z.
    size: [i32; 3],
    /// Numbers of bricks, or [`NO_BRICK`]; z runs fastest, then x.
    index: Vec<u32>,
    bricks: Bricks,
}

impl LightGrid {
    /// The shade in a voxel.
    pub fn shade(&self, voxel: Voxel) -> u32 {
        match self.slot(voxel.map(|v| v >> SHIFT)).map(|slot| self.index[slot]) {
            None | Some(NO_BRICK) => 0,
            Some(brick) => {
                let [x, y, z] = voxel.map(|v| v & (EDGE - 1));
                self.bricks.get(brick)[(y * EDGE + x) as usize][z as usize]
            }
        }
    }

    /// Where less shade is: the negative of the central difference.
    pub fn gradient(&self, [x, y, z]: Voxel) -> [i64; 3] {
        let at = |voxel| i64::from(self.shade(voxel));
        [
            at([x - 1, y, z]) - at([x + 1, y, z]),
            at([x, y - 1, z]) - at([x, y + 1, z]),
            at([x, y, z - 1]) - at([x, y, z + 1]),
        ]
    }

    /// Adds the pyramids of nodes, and takes out those of others: in tiles, whose tables stay in the processor's caches,
    /// level by level. Sums are the same in any order.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn change(
        &mut self,
        changes: &mut [Change],
        pyramid: &Pyramid,
        monitor: &dyn Monitor,
    ) -> Result<(), OverMemory> {
        let tile = |change: &Change| [change.voxel[0] >> TILE_SHIFT, change.voxel[2] >> TILE_SHIFT];
        // From the top of a tile down.
        changes.sort_unstable_by_key(|change| (tile(change), Reverse(change.voxel[1]), change.voxel));
        let mut last = [[0; 3]; 2];
        for change in changes.iter().filter(|change| !change.is_gone) {
            let bricks = pyramid.reach(change.voxel).map(|corner| corner.map(|v| v >> SHIFT));
            if bricks != last {
                self.cover(bricks, monitor)?;
                last = bricks;
            }
        }
        let mut plane = Plane::default();
        for tile in changes.chunk_by(|a, b| tile(a) == tile(b)) {
            let (Some(highest), Some(lowest)) = (tile.first(), tile.last()) else { continue };
            let ground = (lowest.voxel[1] - pyramid.depth()).max(0);
            let (mut first, mut end) = (0, 0);
            for y in (ground..=highest.voxel[1]).rev() {
                first += tile[first..].iter().take_while(|node| node.voxel[1] > y + pyramid.depth()).count();
                end += tile[end..].iter().take_while(|node| node.voxel[1] >= y).count();
                plane.draw(y, &tile[first..end], pyramid, EDGE);
                self.add_plane(y, &plane);
            }
        }
        Ok(())
    }

    /// Adds shade to a level, whose bricks are there where it is shaded.
    fn add_plane(&mut self, y: i32, plane: &Plane) {
        let bricks = plane.size.map(|size| size as i32 / EDGE);
        for brick_x in 0..bricks[0] {
            for brick_z in 0..bricks[1] {
                let at = [(plane.low[0] >> SHIFT) + brick_x, y >> SHIFT, (plane.low[1] >> SHIFT) + brick_z];
                let Some(brick) = self.brick_mut(at) else { continue };
                for x in 0..EDGE {
                    let row = &mut brick[((y & (EDGE - 1)) * EDGE + x) as usize];
                    let shades = &plane.row((brick_x * EDGE + x) as usize)[(brick_z * EDGE) as usize..];
                    for (voxel, shade) in row.iter_mut().zip(shades) {
                        *voxel = voxel.wrapping_add(*shade);
                    }
                }
            }
        }
    }

    /// Adds the pyramid of a node.
    #[cfg(test)]
    pub fn add(&mut self, voxel: Voxel, pyramid: &Pyramid, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        self.change(&mut [Change { voxel, is_gone: false }], pyramid, monitor)
    }

    /// Takes out the pyramid of a node that was added.
    #[cfg(test)]
    pub fn remove(&mut self, voxel: Voxel, pyramid: &Pyramid) {
        self.change(&mut [Change { voxel, is_gone: true }], pyramid, &Quiet).unwrap();
    }

    /// Adds shade to all voxels between two, both included.
    ///
    /// # Errors
    /// [`OverMemory`].
    #[cfg(test)]
    pub fn add_box(
        &mut self,
        low: Voxel,
        high: Voxel,
        shade: u32,
        monitor: &dyn Monitor,
    ) -> Result<(), OverMemory> {
        self.cover([low, high].map(|corner| corner.map(|v| v >> SHIFT)), monitor)?;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let brick = self.brick_mut([x, y, z].map(|v| v >> SHIFT)).unwrap();
                    let [x, y, z] = [x, y, z].map(|v| v & (EDGE - 1));
                    brick[(y * EDGE + x) as usize][z as usize] += shade;
                }
            }
        }
        Ok(())
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<u32>(self.index.capacity()) + self.bricks.bytes()
    }

    fn brick_mut(&mut self, brick: Voxel) -> Option<&mut Brick> {
        let slot = self.slot(brick)?;
        self.bricks.get_mut(self.index[slot])
    }

    /// Where the index has a brick.
    fn slot(&self, brick: Voxel) -> Option<usize> {
        let at = |axis: usize| brick[axis] - self.origin[axis];
        let is_inside = (0..3).all(|axis| (0..self.size[axis]).contains(&at(axis)));
        is_inside.then(|| {
            let row = at(1) as usize * self.size[0] as usize + at(0) as usize;
            row * self.size[2] as usize + at(2) as usize
        })
    }

    /// Makes all bricks from one to another.
    fn cover(&mut self, [low, high]: [Voxel; 2], monitor: &dyn Monitor) -> Result<(), OverMemory> {
        if self.slot(low).is_none() || self.slot(high).is_none() {
            self.widen(low, high, monitor)?;
        }
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                for z in low[2]..=high[2] {
                    if let Some(slot) = self.slot([x, y, z])
                        && self.index[slot] == NO_BRICK
                    {
                        self.index[slot] = self.new_brick(monitor)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn new_brick(&mut self, monitor: &dyn Monitor) -> Result<u32, OverMemory> {
        if self.bricks.is_full() {
            monitor.admit(DOING, self.bytes() + Bricks::STACK_BYTES, ADVICE)?;
        }
        Ok(self.bricks.push())
    }

    /// Makes the index hold a box of bricks, with some room towards where it grew.
    fn widen(&mut self, low: Voxel, high: Voxel, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let (mut origin, mut size) = (low, [0; 3]);
        for axis in 0..3 {
            let (first, last) = if self.index.is_empty() {
                (low[axis] - 4, high[axis] + 4)
            } else {
                let (first, last) = (self.origin[axis], self.origin[axis] + self.size[axis] - 1);
                let room = 4 + self.size[axis] / 2;
                let first = if low[axis] < first { low[axis] - room } else { first };
                (first, if high[axis] > last { high[axis] + room } else { last })
            };
            // There is nothing below the ground.
            origin[axis] = if axis == 1 { first.max(0) } else { first };
            size[axis] = last - origin[axis] + 1;
        }
        let slots = size.iter().fold(1_usize, |slots, &edge| slots.saturating_mul(edge as usize));
        monitor.admit(DOING, self.bytes().saturating_add(bytes_of::<u32>(slots)), ADVICE)?;
        let wider =
            Self { origin, size, index: vec![NO_BRICK; slots], bricks: std::mem::take(&mut self.bricks) };
        let old = std::mem::replace(self, wider);
        let mut numbers = old.index.iter();
        for y in 0..old.size[1] {
            for x in 0..old.size[0] {
                for z in 0..old.size[2] {
                    let place = [old.origin[0] + x, old.origin[1] + y, old.origin[2] + z];
                    if let (Some(&number), Some(slot)) = (numbers.next(), self.slot(place)) {
                        self.index[slot] = number;
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Small;
    use linden_base::random::Key;

    const UP: [f64; 3] = [0.0, 1.0, 0.0];

    /// The definition: the sum over all nodes of what they add to a voxel.
    pub(crate) fn by_definition(nodes: &[Voxel], pyramid: &Pyramid, [x, y, z]: Voxel) -> u32 {
        let from = |&[i, j, k]: &Voxel| {
            let q = j - y;
            let layer = usize::try_from(q).ok().and_then(|q| pyramid.layers.get(q));
            layer.filter(|layer| (x - i - layer.x).abs() <= q && (z - k - layer.z).abs() <= q)
        };
        nodes.iter().filter_map(from).map(|layer| layer.shade).sum()
    }

    #[test]
    fn shade_is_what_the_definition_says_in_every_voxel_and_vanishes_with_the_nodes() {
        for to_light in [UP, [0.6, 1.0, -0.3], [-5.0, 1.0, 0.0]] {
            let pyramid = Pyramid::new(0.1, 1.5, 5, to_light);
            let key = Key::new(3);
            let nodes: Vec<Voxel> = (0..60)
                .map(|i| {
                    let at = |axis: u64, low, high| {
                        libm::floor(key.child(i).child(axis).between(low, high)) as i32
                    };
                    [at(0, -20.0, 20.0), at(1, 0.0, 30.0), at(2, -40.0, 9.0)]
                })
                .collect();
            let mut grid = LightGrid::default();
            for &node in &nodes {
                grid.add(node, &pyramid, &Quiet).unwrap();
            }
            let all = |grid: &LightGrid, nodes: &[Voxel]| {
                for x in -30..30 {
                    for y in 0..32 {
                        for z in -50..20 {
                            let voxel = [x, y, z];
                            assert_eq!(grid.shade(voxel), by_definition(nodes, &pyramid, voxel), "{voxel:?}");
                        }
                    }
                }
            };
            all(&grid, &nodes);
            nodes[20..].iter().rev().for_each(|&node| grid.remove(node, &pyramid));
            all(&grid, &nodes[..20]);
        }
    }

    #[test]
    fn a_pyramid_falls_off_and_leans_away_from_the_light() {
        let pyramid = Pyramid::new(0.5, 2.0, 3, [3.0, 1.0, 0.0]);
        let shades: Vec<u32> = pyramid.layers.iter().map(|layer| layer.shade).collect();
        assert_eq!(shades, [32768, 16384, 8192, 4096]);
        // 72° from upright, taken as 45°.
        let moved: Vec<i32> = pyramid.layers.iter().map(|layer| layer.x).collect();
        assert_eq!(moved, [0, -1, -2, -3]);
    }

    #[test]
    fn it_is_brighter_away_from_a_shaded_box() {
        let mut grid = LightGrid::default();
        grid.add_box([-9, 0, -9], [-1, 20, 9], 500, &Quiet).unwrap();
        assert_eq!([grid.shade([-1, 20, 9]), grid.shade([0, 20, 9]), grid.shade([-1, 21, 9])], [500, 0, 0]);
        assert_eq!(grid.gradient([0, 5, 0]), [500, 0, 0]);
        assert_eq!(grid.gradient([-3, 20, 0]), [0, 500, 0]);
    }

    #[test]
    fn without_memory_it_says_so() {
        let refused =
            LightGrid::default().add([0, 9, 0], &Pyramid::new(0.1, 1.5, 5, UP), &Small).unwrap_err();
        assert!(refused.to_string().contains("raise internode"), "{refused}");
    }
}
