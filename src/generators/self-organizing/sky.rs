//! Light from all of the sky, through the leaves that are in its way.
//!
//! Beer and Lambert's law on a grid: of the light from a direction, `exp(−depth)` passes leaves of that optical depth
//! (Monsi & Saeki 1953). The sky has 25 directions in four rings; paths go from voxel to voxel, so that what lies on
//! them is a whole number of leafy nodes, the same in any order. Shade has no end, as the pyramids of
//! [`shadow`](crate::shadow) have: a crown is lit from outside, and no storeys form in it.

use std::ops::Range;

use glam::DVec3;
use linden_base::memory::bytes_of;
use linden_base::monitor::{Cancelled, Monitor};
use rayon::prelude::*;

use crate::barriers::Barriers;
use crate::grow::CENTRE;
use crate::light::{FULL_LIGHT, Voxel};
use crate::tree::{APEX, DEAD, Nodes};
use crate::{SelfOrganizing, SelfOrganizingError};

/// The edge of a voxel, internodes.
const EDGE: i32 = 2;
/// The longest table of what passes, half nodes.
const MOST_HALVES: u32 = 1 << 16;

const DOING: &str = "keeping the light of a growing tree";
const ADVICE: &str = "lower years or vigor, or raise internode";

/// A direction of the sky, as the steps of a path from a voxel to the level above.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Direction {
    /// To the voxel of the level above that the path comes from, along x and z.
    to: [i32; 2],
    /// Whether it goes sideways from every other level alone.
    is_steep: bool,
    /// The voxel of its own level that a flat path passes, halfway.
    between: Option<[i32; 2]>,
    /// To the sky, of length 1.
    towards: DVec3,
    /// Its part of all light, of [`FULL_LIGHT`].
    weight: u32,
}

/// The sky's directions, of which those near `light_from`'s side are brighter.
fn directions(light_from: [f64; 3]) -> Vec<Direction> {
    /// Sideways for each level up, and the highest and lowest angle from the zenith of the ring, degrees.
    const RINGS: [(f64, [f64; 2]); 4] =
        [(0.0, [0.0, 13.0]), (0.5, [13.0, 36.0]), (1.0, [36.0, 56.0]), (2.0, [56.0, 80.0])];
    let [x, y, z] = light_from;
    let level = libm::hypot(x, z);
    // 1 for light that is tilted by 45° or more.
    let tilt = if level > 0.0 { (level / y.max(level)) / level } else { 0.0 };
    let mut found = Vec::new();
    for (slope, [high, low]) in RINGS {
        let [high, low] = [high, low].map(f64::to_radians);
        let angle = 0.5 * (high + low);
        // Moon & Spencer 1942: an overcast sky is three times as bright above as at the horizon.
        let brightness = (1.0 + 2.0 * libm::cos(angle)) / 3.0;
        let light = (libm::cos(high) - libm::cos(low)) * brightness;
        let around: &[[i32; 2]] = match slope {
            0.0 => &[[0, 0]],
            _ => &[[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]],
        };
        for &[dx, dz] in around {
            let towards = DVec3::new(f64::from(dx) * slope, 1.0, f64::from(dz) * slope).normalize();
            let side = (towards.x * x + towards.z * z) * tilt;
            let part = light / around.len() as f64 * (1.0 + 2.0 * side).max(0.0);
            let steps = slope.max(1.0) as i32;
            let to = [dx * steps, dz * steps];
            let between = (slope > 1.0).then_some([dx * steps / 2, dz * steps / 2]);
            found.push((Direction { to, is_steep: slope == 0.5, between, towards, weight: 0 }, part));
        }
    }
    let all: f64 = found.iter().map(|(_, part)| part).sum();
    let weighed = |(direction, part): (Direction, f64)| {
        let weight = libm::round(part / all * f64::from(FULL_LIGHT)) as u32;
        Direction { weight, ..direction }
    };
    found.into_iter().map(weighed).filter(|direction| direction.weight > 0).collect()
}

/// The sky as a growing tree sees it.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    directions: Vec<Direction>,
    /// For each direction, what passes so many half nodes, of [`FULL_LIGHT`]; more of them let pass what the last ones do.
    passing: Vec<Vec<u32>>,
    leaf_years: u32,
    /// The least leafy voxel, and how many there are along x, y and z.
    low: Voxel,
    size: [usize; 3],
    /// Leafy nodes in each voxel, and [`DARK`] where an obstacle is; level by level, z runs fastest.
    leafy: Vec<u32>,
    /// The place in `lit` of each voxel with a bud in it; [`NO_BUD`] for the others.
    places: Vec<u32>,
    /// What the voxels with buds get, and from where.
    lit: Vec<Lit>,
    /// The voxels of obstacles' surfaces, sorted.
    walls: Vec<Voxel>,
}

/// Of a voxel whose light nobody asks for.
const NO_BUD: u32 = u32::MAX;

/// The light of a voxel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Lit {
    /// Of [`FULL_LIGHT`].
    light: u32,
    /// The sum of directions, each as bright as it is.
    from: [f32; 3],
}

/// Goes over the lines of a level of voxels: each with the range of those that lie so many steps along x and z, as far as both
/// are there.
fn shifted(
    level: &mut [u32],
    [wide, deep]: [usize; 2],
    [dx, dz]: [i32; 2],
    mut line: impl FnMut(&mut [u32], Range<usize>),
) {
    /// Where both a place and the one so many steps on are on a line of so many.
    fn on_both(count: usize, step: i32) -> Range<usize> {
        let away = step.unsigned_abs() as usize;
        if step < 0 { away.min(count)..count } else { 0..count.saturating_sub(away) }
    }
    let beside = |at: usize, step: i32| (at as i64 + i64::from(step)) as usize;
    let across = on_both(deep, dz);
    if across.is_empty() {
        return;
    }
    for x in on_both(wide, dx) {
        let first = beside(x, dx) * deep + beside(across.start, dz);
        line(&mut level[x * deep..][across.clone()], first..first + across.len());
    }
}

/// What is added to places: a foot, half an internode off a corner, is in the middle of its voxel.
const IN_VOXEL: DVec3 = DVec3::new(0.5, 0.0, 0.5);

/// Half nodes on a path that an obstacle ends; more than all others together.
const DARK: u32 = 1 << 29;

/// The voxel of a node.
fn voxel(nodes: &Nodes, node: usize) -> Voxel {
    let [x, y, z] = (nodes.places[node].as_dvec3() + IN_VOXEL).to_array();
    [x, y, z].map(|along| libm::floor(along / f64::from(EDGE)) as i32)
}

/// The least box around voxels; `None` without any.
fn around<'a>(mut voxels: impl Iterator<Item = &'a Voxel>) -> Option<[Voxel; 2]> {
    let &first = voxels.next()?;
    Some(voxels.fold([first; 2], |[low, high], voxel| {
        let each = |pick: fn(i32, i32) -> i32, of: Voxel| [0, 1, 2].map(|axis| pick(of[axis], voxel[axis]));
        [each(i32::min, low), each(i32::max, high)]
    }))
}

impl Sky {
    pub fn new(settings: &SelfOrganizing) -> Self {
        let directions = directions(settings.light_from);
        let passing = |direction: &Direction| {
            // Of half a node, where the path crosses its voxel.
            let depth = settings.shade / direction.towards.y / f64::from(2 * EDGE * EDGE);
            let passing =
                |halves: f64| libm::round(f64::from(FULL_LIGHT) * libm::exp(-depth * halves)) as u32;
            let mut passing: Vec<u32> =
                (0..MOST_HALVES).map(f64::from).map(passing).take_while(|&light| light > 0).collect();
            if passing.len() < MOST_HALVES as usize {
                passing.push(0);
            }
            passing
        };
        let passing = directions.iter().map(passing).collect();
        let (low, size) = ([0; 3], [0; 3]);
        let leaf_years = settings.leaf_years;
        let (leafy, places, lit, walls) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { directions, passing, leaf_years, low, size, leafy, places, lit, walls }
    }

    /// Lets no light pass the surfaces of solids.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: too little memory, cancelled.
    pub fn stand_behind(
        &mut self,
        barriers: &Barriers,
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        self.walls = barriers.surface(EDGE, IN_VOXEL + CENTRE, monitor)?;
        Ok(())
    }

    /// Works the light of all voxels with buds out, as it is at the beginning of a year.
    ///
    /// # Errors
    /// [`SelfOrganizingError`]: too little memory, cancelled.
    pub fn shine(
        &mut self,
        nodes: &Nodes,
        year: u32,
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        let is_leafy = |&node: &usize| {
            !nodes.is_foot(node) && !nodes.is(node, DEAD) && year - nodes.year(node) <= self.leaf_years
        };
        let voxels: Vec<Voxel> = (0..nodes.len()).filter(is_leafy).map(|node| voxel(nodes, node)).collect();
        let walls = self.walls_near(nodes);
        // With no obstacle near, what is beyond the leaves is in full light.
        let all = if walls.is_empty() { 0 } else { nodes.len() };
        let all: Vec<Voxel> = (0..all).map(|node| voxel(nodes, node)).collect();
        let Some([mut low, high]) = around(voxels.iter().chain(&all).chain(&walls)) else {
            self.size = [0; 3];
            return Ok(());
        };
        // Light falls down to the ground, where buds may be that have no leaf beside them.
        low[1] = 0;
        let size = [0, 1, 2].map(|axis| (high[axis] - low[axis] + 1) as usize);
        let count = size.iter().fold(1_usize, |count, &edge| count.saturating_mul(edge));
        let has_bud = |&node: &usize| nodes.is(node, APEX) || nodes.buds[node] != 0;
        let with_buds = (0..nodes.len()).filter(has_bud);
        let directions = self.directions.len();
        // Two levels of paths, and what passes to each bud.
        let paths =
            size[0].saturating_mul(size[2]).saturating_mul(2).saturating_add(with_buds.clone().count());
        let voxel_bytes = bytes_of::<[u32; 2]>(count);
        let path_bytes = bytes_of::<u32>(paths.saturating_mul(directions));
        let lit_bytes = bytes_of::<Lit>(with_buds.clone().count());
        let held = bytes_of::<Voxel>(self.walls.len() + walls.len());
        let bytes = voxel_bytes.saturating_add(path_bytes).saturating_add(lit_bytes).saturating_add(held);
        monitor.admit(DOING, bytes, ADVICE)?;
        (self.low, self.size) = (low, size);
        self.leafy.clear();
        self.leafy.resize(count, 0);
        for voxel in voxels {
            if let Some(slot) = self.slot(voxel) {
                self.leafy[slot] += 1;
            }
        }
        let has_walls = !walls.is_empty();
        for wall in walls {
            if let Some(slot) = self.slot(wall) {
                self.leafy[slot] |= DARK;
            }
        }
        let mut asked: Vec<usize> = with_buds.filter_map(|node| self.slot(voxel(nodes, node))).collect();
        asked.sort_unstable();
        asked.dedup();
        self.places.clear();
        self.places.resize(count, NO_BUD);
        for (place, &slot) in (0..).zip(&asked) {
            self.places[slot] = place;
        }
        Ok(self.shine_on(&asked, has_walls, monitor)?)
    }

    /// The voxels of obstacles that may be in the way of light to nodes: the flattest paths climb a level in two steps
    /// sideways.
    fn walls_near(&self, nodes: &Nodes) -> Vec<Voxel> {
        if self.walls.is_empty() {
            return Vec::new();
        }
        let all: Vec<Voxel> = (0..nodes.len()).map(|node| voxel(nodes, node)).collect();
        let Some([low, high]) = around(all.iter()) else { return Vec::new() };
        let is_near = |wall: &&Voxel| {
            let reach = 2 * (wall[1] + 1);
            [0, 2].iter().all(|&axis| (low[axis] - reach..=high[axis] + reach).contains(&wall[axis]))
        };
        self.walls.iter().filter(is_near).copied().collect()
    }

    /// Works the light of some voxels out, which are in rising order.
    fn shine_on(&mut self, asked: &[usize], has_walls: bool, monitor: &dyn Monitor) -> Result<(), Cancelled> {
        // Each direction by itself, on any thread; then one after the other, as floats do not sum up alike in any order.
        let paths = self.directions.par_iter().zip(&self.passing);
        let passing: Vec<Vec<u32>> = paths
            .map(|(direction, passing)| self.passing_from((direction, passing), asked, has_walls, monitor))
            .collect::<Result<_, Cancelled>>()?;
        self.lit.clear();
        self.lit.resize(asked.len(), Lit::default());
        for (direction, passing) in self.directions.iter().zip(passing) {
            let towards = direction.towards.as_vec3() * (direction.weight as f32 / FULL_LIGHT as f32);
            for (lit, passes) in self.lit.iter_mut().zip(passing) {
                lit.light += ((u64::from(passes) * u64::from(direction.weight)) >> 16) as u32;
                let bright = passes as f32 / FULL_LIGHT as f32;
                lit.from[0] += towards.x * bright;
                lit.from[1] += towards.y * bright;
                lit.from[2] += towards.z * bright;
            }
        }
        Ok(())
    }

    /// What passes from a direction to each of some voxels, of [`FULL_LIGHT`]. From the highest level down: a path goes on
    /// with what it had in the level above.
    fn passing_from(
        &self,
        (direction, passing): (&Direction, &Vec<u32>),
        asked: &[usize],
        has_walls: bool,
        monitor: &dyn Monitor,
    ) -> Result<Vec<u32>, Cancelled> {
        let [wide, tall, deep] = self.size;
        let level = wide * deep;
        let mut above = vec![0_u32; level];
        let mut here = vec![0_u32; level];
        let mut passes = vec![0; asked.len()];
        let mut end = asked.len();
        for y in (0..tall).rev() {
            if end == 0 {
                break;
            }
            monitor.check()?;
            let is_even = (self.low[1] + y as i32) % 2 == 0;
            let to = if direction.is_steep && is_even { [0, 0] } else { direction.to };
            here.fill(0);
            if y + 1 < tall {
                // Half of a voxel's nodes is met twice, where the path does not pass another one halfway.
                let times = if direction.between.is_some() { 1 } else { 2 };
                let upper = &self.leafy[(y + 1) * level..][..level];
                shifted(&mut here, [wide, deep], to, |line, from| {
                    for ((slot, above), upper) in line.iter_mut().zip(&above[from.clone()]).zip(&upper[from])
                    {
                        *slot = above + times * upper;
                    }
                });
            }
            let leafy = &self.leafy[y * level..][..level];
            if let Some(between) = direction.between {
                shifted(&mut here, [wide, deep], between, |line, from| {
                    for (slot, leafy) in line.iter_mut().zip(&leafy[from]) {
                        *slot += leafy;
                    }
                });
            }
            if has_walls {
                for halves in &mut here {
                    *halves = (*halves).min(DARK);
                }
            }
            let start = asked[..end].partition_point(|&slot| slot < y * level);
            for (passes, &slot) in passes[start..end].iter_mut().zip(&asked[start..end]) {
                // What is beside a node shades it as from halfway through its voxel.
                let beside = (leafy[slot - y * level] & !DARK).saturating_sub(1);
                let halves = here[slot - y * level];
                let is_ended = halves >= DARK;
                *passes =
                    if is_ended { 0 } else { passing[((halves + beside) as usize).min(passing.len() - 1)] };
            }
            end = start;
            std::mem::swap(&mut above, &mut here);
        }
        Ok(passes)
    }

    /// The light of a bud at a node, of [`FULL_LIGHT`].
    pub fn light(&self, nodes: &Nodes, node: usize) -> u32 {
        self.lit(nodes, node).map_or(FULL_LIGHT, |lit| lit.light.min(FULL_LIGHT))
    }

    /// The mean direction that light comes from to a bud at a node, of length 1; none in the dark.
    pub fn brighter(&self, nodes: &Nodes, node: usize) -> DVec3 {
        let lit = self.lit(nodes, node);
        lit.map_or(DVec3::Y, |lit| DVec3::from(lit.from.map(f64::from)).normalize_or_zero())
    }

    /// The light of a bud among the leaves; `None`: it is outside of them, in the open.
    fn lit(&self, nodes: &Nodes, node: usize) -> Option<&Lit> {
        let place = self.places[self.slot(voxel(nodes, node))?];
        debug_assert_ne!(place, NO_BUD, "there is no bud");
        self.lit.get(place as usize)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Lit>(self.lit.capacity())
            + bytes_of::<u32>(self.leafy.capacity() + self.places.capacity())
            + bytes_of::<Voxel>(self.walls.capacity())
    }

    fn slot(&self, voxel: Voxel) -> Option<usize> {
        let at = |axis: usize| {
            usize::try_from(voxel[axis] - self.low[axis]).ok().filter(|&at| at < self.size[axis])
        };
        let (x, y, z) = (at(0)?, at(1)?, at(2)?);
        Some((y * self.size[0] + x) * self.size[2] + z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LightModel;
    use crate::light::Small;
    use crate::tree::{Node, PARTS};
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::NO_PARENT;

    fn settings() -> SelfOrganizing {
        SelfOrganizing { light: LightModel::Sky, shade: 0.6, leaf_years: 2, ..SelfOrganizing::default() }
    }

    /// A foot, and nodes at places, all of a year.
    fn nodes(places: impl IntoIterator<Item = DVec3>, year: u32) -> Nodes {
        let mut nodes = Nodes::default();
        let node = |parent, place, birth| Node {
            parent,
            place,
            direction: DVec3::Y,
            side: DVec3::X,
            key: Key::new(1),
            birth,
            order: 0,
            flags: 0,
            buds: 1,
        };
        nodes.push(&node(NO_PARENT, DVec3::new(0.5, 0.0, 0.5), 0));
        places.into_iter().for_each(|place| nodes.push(&node(0, place, year * PARTS)));
        nodes
    }

    fn shone(nodes: &Nodes, settings: &SelfOrganizing) -> Sky {
        let mut sky = Sky::new(settings);
        sky.shine(nodes, 2, &Quiet).unwrap();
        sky
    }

    /// The law itself: each direction's path is walked from the voxel up to the top, counting nodes on it.
    fn by_definition(sky: &Sky, settings: &SelfOrganizing, leaves: &[Voxel], from: Voxel) -> f64 {
        let leaves_in = |at: Voxel| leaves.iter().filter(|&&leaf| leaf == at).count() as f64;
        let top = leaves.iter().chain(&sky.walls).map(|voxel| voxel[1]).max().unwrap();
        let path = |direction: &Direction| {
            let slope = libm::hypot(direction.towards.x, direction.towards.z) / direction.towards.y;
            let level_m = libm::sqrt(1.0 + slope * slope);
            let mut leafy = 0.5 * (leaves_in(from) - 1.0).max(0.0);
            let [mut x, mut y, mut z] = from;
            let is_wall = |at: Voxel| sky.walls.contains(&at);
            while y <= top {
                let [dx, dz] = direction.to;
                let is_steep = direction.is_steep && y % 2 == 0;
                let next = if is_steep { [x, y + 1, z] } else { [x + dx, y + 1, z + dz] };
                if is_wall(next) || direction.between.is_some_and(|[mx, mz]| is_wall([x + mx, y, z + mz])) {
                    return 0.0;
                }
                if let Some([mx, mz]) = direction.between {
                    leafy += 0.5 * (leaves_in([x + mx, y, z + mz]) + leaves_in([x + dx, y + 1, z + dz]));
                }
                if !(direction.is_steep && y % 2 == 0) {
                    (x, z) = (x + dx, z + dz);
                }
                y += 1;
                if direction.between.is_none() {
                    leafy += leaves_in([x, y, z]);
                }
            }
            f64::from(direction.weight) * libm::exp(-settings.shade * leafy * level_m / 4.0)
        };
        sky.directions.iter().map(path).sum()
    }

    #[test]
    fn light_is_what_passes_the_leaves_on_all_paths_in_every_voxel() {
        for light_from in [[0.0, 1.0, 0.0], [0.7, 1.0, -0.2]] {
            let settings = SelfOrganizing { light_from, ..settings() };
            let key = Key::new(8);
            let places = (0..400).map(|i| {
                let at = |axis: u64, high| key.child(i).child(axis).between(0.0, high);
                DVec3::new(at(0, 16.0), at(1, 20.0), at(2, 12.0))
            });
            let nodes = nodes(places, 1);
            let sky = shone(&nodes, &settings);
            let leaves: Vec<Voxel> = (1..nodes.len()).map(|node| voxel(&nodes, node)).collect();
            let mut least = FULL_LIGHT;
            for node in 1..nodes.len() {
                let light = sky.light(&nodes, node);
                let expected = by_definition(&sky, &settings, &leaves, voxel(&nodes, node));
                // Each direction is rounded down.
                assert!((f64::from(light) - expected).abs() < 40.0, "{node}: {light} {expected}");
                least = least.min(light);
            }
            assert!(least < FULL_LIGHT * 6 / 10, "{least}");
        }
    }

    #[test]
    fn no_light_passes_a_wall_on_any_path() {
        let key = Key::new(9);
        let places = (0..200).map(|i| {
            let at = |axis: u64, high| key.child(i).child(axis).between(0.0, high);
            DVec3::new(at(0, 16.0), at(1, 20.0), at(2, 12.0))
        });
        let nodes = nodes(places, 1);
        let settings = settings();
        let mut sky = Sky::new(&settings);
        // One stands beside the crown, some float above and in it, one is too far away for any path.
        sky.walls = (0..30).flat_map(|y| (-5..4).map(move |z| [10, y, z])).collect();
        sky.walls.extend([[3, 12, 2], [4, 6, 2], [4, 6, 3], [-2, 11, 9], [900, 3, 3]]);
        sky.walls.sort_unstable();
        sky.shine(&nodes, 2, &Quiet).unwrap();
        assert!(sky.size[0] < 100, "what no path meets is left out: {:?}", sky.size);
        let leaves: Vec<Voxel> = (1..nodes.len()).map(|node| voxel(&nodes, node)).collect();
        let mut in_shade = 0;
        for node in 1..nodes.len() {
            let light = sky.light(&nodes, node);
            let expected = by_definition(&sky, &settings, &leaves, voxel(&nodes, node));
            assert!((f64::from(light) - expected).abs() < 40.0, "{node}: {light} {expected}");
            let bare = Sky { walls: Vec::new(), ..sky.clone() };
            let without = by_definition(&bare, &settings, &leaves, voxel(&nodes, node));
            in_shade += usize::from(expected < 0.8 * without);
        }
        assert!(in_shade > 50, "{in_shade}");
    }

    #[test]
    fn a_lone_bud_has_all_light_and_below_a_roof_it_stays_dark_at_any_depth() {
        let lone = nodes([DVec3::new(0.5, 7.0, 0.5)], 1);
        let sky = shone(&lone, &settings());
        assert!(FULL_LIGHT - sky.light(&lone, 1) < 40, "{}", sky.light(&lone, 1));
        assert!(sky.brighter(&lone, 1).distance(DVec3::Y) < 1e-6);

        let wide = (-150..150).flat_map(|x| (-150..150).map(move |z| [f64::from(x), f64::from(z)]));
        let below = [28.0, 20.0, 10.0].map(|y| DVec3::new(0.5, y, 0.5));
        let roof = nodes(below.into_iter().chain(wide.map(|[x, z]| DVec3::new(x, 30.0, z))), 1);
        let sky = shone(&roof, &SelfOrganizing { shade: 0.8, ..settings() });
        let [near, far, farther] = [1, 2, 3].map(|node| sky.light(&roof, node));
        assert!(near < FULL_LIGHT / 2, "{near}");
        assert!(far.abs_diff(near) < FULL_LIGHT / 20 && farther.abs_diff(near) < FULL_LIGHT / 10);
    }

    #[test]
    fn leaves_that_take_hardly_anything_darken_nothing() {
        let many =
            nodes((0..40_000).map(|_| DVec3::new(0.5, 9.0, 0.5)).chain([DVec3::new(0.5, 2.0, 0.5)]), 1);
        let sky = shone(&many, &SelfOrganizing { shade: 1e-9, ..settings() });
        assert!(FULL_LIGHT - sky.light(&many, 40_001) < 40, "{}", sky.light(&many, 40_001));
    }

    #[test]
    fn leaves_fall_and_those_on_one_side_leave_the_other_brighter() {
        let wall = (0..20).flat_map(|y| (-20..20).map(move |z| DVec3::new(4.5, f64::from(y), f64::from(z))));
        let places: Vec<DVec3> = std::iter::once(DVec3::new(0.5, 2.0, 0.5)).chain(wall).collect();
        let young = nodes(places.iter().copied(), 1);
        let sky = shone(&young, &settings());
        assert!(sky.light(&young, 1) < FULL_LIGHT * 9 / 10);
        assert!(sky.brighter(&young, 1).x < -0.02, "{}", sky.brighter(&young, 1));
        let mut bare = Sky::new(&settings());
        bare.shine(&young, 4, &Quiet).unwrap();
        assert_eq!(bare.light(&young, 1), FULL_LIGHT);

        let lone = nodes([DVec3::new(0.5, 7.0, 0.5)], 1);
        let tilted = shone(&lone, &SelfOrganizing { light_from: [1.0, 1.0, 0.0], ..settings() });
        assert!(tilted.brighter(&lone, 1).x > 0.3, "{}", tilted.brighter(&lone, 1));
    }

    #[test]
    fn without_memory_it_says_so() {
        let far = nodes([DVec3::new(0.5, 90.0, 0.5), DVec3::new(200.0, 9.0, 200.0)], 1);
        let refused = Sky::new(&settings()).shine(&far, 2, &Small).unwrap_err();
        assert!(refused.to_string().contains("raise internode"), "{refused}");
    }
}
