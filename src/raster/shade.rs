//! The shade that a tree throws on itself and on the ground: how much of the sun and of the sky reaches a place.
//!
//! Leaves and wood are added up as area in cubic cells; light is swallowed on its way through them by
//! Beer and Lambert's law, as in models of canopies. Cells are coarse, so that shade is soft; sums are
//! of integers, so that the order in which threads add does not matter.

use std::f32::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Vec2, Vec3};
use linden_pipeline::foliage::Organs;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Part};
use linden_pipeline::{NO_PARENT, Skeleton};
use rayon::prelude::*;

use crate::Extent;

/// Cells along the longest side, and those of a draft.
const CELLS: u32 = 32;
const DRAFT_CELLS: u32 = 18;
/// Triangles, nodes or organs that are looked at, of more each so many-th for all; and those of a draft.
const LOOKS: usize = 1 << 18;
const DRAFT_LOOKS: usize = 1 << 14;
/// What is cut out and longer than so many cells is looked at in parts.
const LARGE: f32 = 8.0;
/// Light is not followed any deeper.
const DEEPEST: f32 = 6.0;
/// One cell swallows no more than this: leaves of a cell hide each other.
const DENSEST: f32 = 1.6;
/// What area hides on average, seen from any side: of a leaf, and of wood that is closed round itself.
const LEAF_SHARE: f32 = 0.36;
const WOOD_SHARE: f32 = 0.25;
/// The same of a plane that stands for a crown: all the leaves that are drawn on it.
const PLANE_SHARE: f32 = 1.0;
/// The area of cells is counted in this share of a cell's side.
const UNIT: f32 = 1.0 / 65_536.0;
/// Cells of the shadow on the ground, along the longer side.
const GROUND_CELLS: u32 = 112;
/// Whence the sky shines: upwards, and from around at 40 degrees.
const SKY: [Vec3; 5] = [
    Vec3::Y,
    Vec3::new(0.766, 0.643, 0.0),
    Vec3::new(-0.766, 0.643, 0.0),
    Vec3::new(0.0, 0.643, 0.766),
    Vec3::new(0.0, 0.643, -0.766),
];

/// Cubic cells around a tree, while what hides light is added to them.
pub(crate) struct Cells {
    low: Vec3,
    per_m: f32,
    counts: [u32; 3],
    looks: usize,
    /// Hidden area of each cell, in [`UNIT`]s of a cell's side.
    hidden: Vec<AtomicU64>,
}

impl Cells {
    /// Empty ones.
    pub fn around(extent: &Extent, draft: bool) -> Self {
        let reach = extent.radius().max(1e-6);
        let low = Vec3::new(extent.x - reach, extent.bottom, extent.z - reach);
        let size = Vec3::new(2.0 * reach, extent.height().max(1e-6), 2.0 * reach);
        let (cells, looks) = if draft { (DRAFT_CELLS, DRAFT_LOOKS) } else { (CELLS, LOOKS) };
        let per_m = cells as f32 / size.max_element();
        let counts = size.to_array().map(|side| ((side * per_m).ceil() as u32).clamp(1, cells));
        let all = counts.iter().product::<u32>() as usize;
        Self { low, per_m, counts, looks, hidden: (0..all).map(|_| AtomicU64::new(0)).collect() }
    }

    /// Bytes that the cells take, and what is made of them.
    pub fn bytes() -> u64 {
        let ground = GROUND_CELLS as usize;
        bytes_of::<(u64, f32, [f32; 2])>((CELLS * CELLS * CELLS) as usize) + bytes_of::<f32>(ground * ground)
    }

    fn add(&self, at: Vec3, hidden_m2: f32) {
        let place = ((at - self.low) * self.per_m).max(Vec3::ZERO).to_array();
        let [x, y, z] = std::array::from_fn(|i| (place[i] as u32).min(self.counts[i] - 1));
        let at = (x + self.counts[0] * (y + self.counts[1] * z)) as usize;
        let units = (hidden_m2 * self.per_m * self.per_m / UNIT) as u64;
        self.hidden[at].fetch_add(units.min(1 << 40), Ordering::Relaxed);
    }

    /// Adds the triangles of a part.
    pub fn add_part(&self, part: &Part, material: &Material) {
        let mesh = &part.mesh;
        let every = mesh.triangles.len().div_ceil(self.looks).max(1);
        let share = match (material.is_sheet(), material.double_sided) {
            (true, true) => LEAF_SHARE,
            // Of two faces.
            (true, false) => LEAF_SHARE / 2.0,
            (false, _) => WOOD_SHARE,
        };
        let share = share * every as f32;
        (0..mesh.triangles.len().div_ceil(every)).into_par_iter().with_min_len(4096).for_each(|i| {
            let corners = mesh.triangles[i * every];
            let [a, b, c] = corners.map(|v| mesh.positions[v as usize]);
            let area_m2 = (b - a).cross(c - a).length() / 2.0;
            let longest_m = (b - a).length().max((c - b).length()).max((a - c).length());
            match &material.base_color_picture {
                Some(picture) if material.cutout.is_some() && longest_m * self.per_m > LARGE => {
                    let uvs = corners.map(|v| mesh.uvs.get(v as usize).copied().unwrap_or_default());
                    let hidden_m2 = area_m2 * PLANE_SHARE * every as f32;
                    self.add_cut_out([a, b, c], uvs, hidden_m2, material, picture);
                }
                _ => self.add((a + b + c) / 3.0, area_m2 * share),
            }
        });
    }

    /// Adds a triangle that goes through many cells where its picture leaves something of it: a plane of a billboard.
    fn add_cut_out(
        &self,
        corners: [Vec3; 3],
        uvs: [Vec2; 3],
        hidden_m2: f32,
        material: &Material,
        picture: &Picture,
    ) {
        let threshold = material.cutout.unwrap_or_default() * 255.0;
        let [width, height] = [picture.width(), picture.height()];
        let is_left = |uv: Vec2| {
            let texel = |share: f32, size: u32| ((share * size as f32) as u32).min(size - 1) as usize;
            let at = texel(uv.x, width) + texel(1.0 - uv.y, height) * width as usize;
            picture.rgba().get(4 * at + 3).is_some_and(|&alpha| f32::from(alpha) >= threshold)
        };
        // It is cut into as many parts along each side, all alike: those that stand as it does, and those between.
        let parts = 4 * CELLS;
        let hidden_m2 = hidden_m2 / (parts * parts) as f32;
        let place = |at: [f32; 3]| {
            let sum = |of: [Vec3; 3]| (0..3).map(|i| of[i] * at[i]).sum::<Vec3>();
            let uv = (0..3).map(|i| uvs[i] * at[i]).sum::<Vec2>();
            (sum(corners), uv)
        };
        for i in 0..parts {
            for k in 0..2 * (parts - i) - 1 {
                let third = if k % 2 == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
                let along = [i as f32 + third, (k / 2) as f32 + third].map(|x| x / parts as f32);
                let (at, uv) = place([1.0 - along[0] - along[1], along[0], along[1]]);
                if is_left(uv) {
                    self.add(at, hidden_m2);
                }
            }
        }
    }

    /// Adds the wood of a skeleton.
    pub fn add_wood(&self, skeleton: &Skeleton, is_present: impl Fn(u32) -> bool + Sync) {
        let every = skeleton.positions.len().div_ceil(self.looks).max(1);
        skeleton.axes.par_iter().with_min_len(256).for_each(|axis| {
            let nodes = skeleton.nodes_of(axis).iter().zip(axis.first as usize..);
            for (&node, _) in nodes.filter(|&(&node, at)| at.is_multiple_of(every) && is_present(node)) {
                let node = node as usize;
                let parent = skeleton.parents[node];
                if parent != NO_PARENT {
                    let (from, to) = (skeleton.positions[parent as usize], skeleton.positions[node]);
                    let around_m2 = TAU * skeleton.radii[node].max(0.0) * from.distance(to);
                    self.add((from + to) / 2.0, around_m2 * WOOD_SHARE * every as f32);
                }
            }
        });
    }

    /// Adds leaves and other organs.
    pub fn add_organs(&self, organs: &Organs, is_present: impl Fn(usize) -> bool) {
        let every = organs.len().div_ceil(self.looks).max(1);
        let areas: Vec<f32> = organs.areas_m2().into_iter().map(|area| area as f32).collect();
        let polygons = organs.polygons.ends.len();
        for organ in (0..organs.len()).step_by(every).filter(|&organ| is_present(organ)) {
            let at = match organ.checked_sub(polygons) {
                Some(placed) => organs.placed.positions[placed],
                None => {
                    let corners = organs.corners_of(organ);
                    corners.iter().sum::<Vec3>() / corners.len().max(1) as f32
                }
            };
            self.add(at, areas[organ] * LEAF_SHARE * every as f32);
        }
    }

    /// What light is left in each cell, under a sun in a direction (length 1).
    pub fn lit(self, sun: Vec3) -> Shade {
        let Self { low, per_m, counts, hidden, .. } = self;
        let share = |units: AtomicU64| (units.into_inner() as f32 * UNIT).min(DENSEST);
        let dense: Vec<f32> = hidden.into_iter().map(share).collect();
        let mut shade = Shade { low, per_m, counts, sun, dense, light: Vec::new() };
        let [across, up, _] = counts;
        shade.light = (0..shade.dense.len() as u32)
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let place = [i % across, i / across % up, i / (across * up)];
                let middle = Vec3::from(place.map(|cell| cell as f32 + 0.5));
                [shade.sun_in_cells(middle), shade.sky_in_cells(middle)]
            })
            .collect();
        shade
    }
}

/// How much light is left in the cells of a tree.
pub(crate) struct Shade {
    low: Vec3,
    per_m: f32,
    counts: [u32; 3],
    sun: Vec3,
    /// What a way through each cell swallows.
    dense: Vec<f32>,
    /// Shares of the sun and of the sky in the middle of each cell.
    light: Vec<[f32; 2]>,
}

impl Shade {
    /// Shares of the sun and of the sky that reach a place.
    pub fn at(&self, place: Vec3) -> [f32; 2] {
        let place = (place - self.low) * self.per_m - Vec3::splat(0.5);
        let most = Vec3::from(self.counts.map(|n| (n - 1) as f32));
        let place = place.clamp(Vec3::ZERO, most);
        let (first, share) = (place.floor(), place - place.floor());
        let next = (first + Vec3::ONE).min(most);
        let [x0, y0, z0] = first.to_array().map(|at| at as u32);
        let [x1, y1, z1] = next.to_array().map(|at| at as u32);
        let light = |x: u32, y: u32, z: u32| {
            Vec2::from(self.light[(x + self.counts[0] * (y + self.counts[1] * z)) as usize])
        };
        let row = |y: u32, z: u32| light(x0, y, z).lerp(light(x1, y, z), share.x);
        let layer = |z: u32| row(y0, z).lerp(row(y1, z), share.y);
        layer(z0).lerp(layer(z1), share.z).to_array()
    }

    fn sun_in_cells(&self, from: Vec3) -> f32 {
        libm::expf(-self.swallowed(from, self.sun))
    }

    fn sky_in_cells(&self, from: Vec3) -> f32 {
        SKY.iter().map(|&way| libm::expf(-self.swallowed(from, way))).sum::<f32>() / SKY.len() as f32
    }

    /// What is swallowed from a place on, in cells; half of the cell in which it begins.
    fn swallowed(&self, from: Vec3, way: Vec3) -> f32 {
        let most = Vec3::from(self.counts.map(|n| n as f32));
        let (mut at, mut sum, mut share) = (from, 0.0, 0.5);
        while sum < DEEPEST && at.cmpge(Vec3::ZERO).all() && at.cmplt(most).all() {
            let [x, y, z] = at.to_array().map(|at| at as u32);
            sum += share * self.dense[(x + self.counts[0] * (y + self.counts[1] * z)) as usize];
            share = 1.0;
            at += way;
        }
        sum
    }

    /// Goes on from a place outside to where the cells begin.
    fn entered(&self, from: Vec3, way: Vec3) -> Vec3 {
        let most = Vec3::from(self.counts.map(|n| n as f32)) - Vec3::splat(1e-3);
        let mut enters = 0.0_f32;
        for axis in 0..3 {
            let side = if way[axis] > 0.0 { 0.0 } else { most[axis] };
            let outside = if way[axis] > 0.0 { from[axis] < 0.0 } else { from[axis] > most[axis] };
            if outside && way[axis].abs() > 1e-6 {
                enters = enters.max((side - from[axis]) / way[axis]);
            }
        }
        from + way * (enters + 1e-3)
    }

    /// The shadow on the plane at a height.
    pub fn shadow_on(&self, ground_m: f32) -> Shadow {
        let high = self.low + Vec3::from(self.counts.map(|n| n as f32)) / self.per_m;
        let thrown = -Vec2::new(self.sun.x, self.sun.z) / self.sun.y.max(0.1) * (high.y - ground_m).max(0.0);
        let (near, far) = (Vec2::new(self.low.x, self.low.z), Vec2::new(high.x, high.z));
        // The sky's shadow reaches a little beyond the crown.
        let margin = (far - near) * 0.2;
        let (low, high) = (near.min(near + thrown) - margin, far.max(far + thrown) + margin);
        let per_m = GROUND_CELLS as f32 / (high - low).max_element().max(1e-6);
        let counts = ((high - low) * per_m).ceil().max(Vec2::ONE);
        let (across, down) = (counts.x as u32, counts.y as u32);
        let dark = (0..across * down)
            .into_par_iter()
            .with_min_len(128)
            .map(|i| {
                let flat = low + (Vec2::new((i % across) as f32, (i / across) as f32) + 0.5) / per_m;
                let place = (Vec3::new(flat.x, ground_m, flat.y) - self.low) * self.per_m;
                let left = |way: Vec3| libm::expf(-self.swallowed(self.entered(place, way), way));
                let sky = SKY.iter().map(|&way| left(way)).sum::<f32>() / SKY.len() as f32;
                1.0 - (0.6 * left(self.sun) + 0.4 * sky)
            })
            .collect();
        Shadow { low, per_m, counts: [across, down], dark }
    }
}

/// How much of the sky each node of a tree sees, from 0 to 1.
pub(crate) fn sky_shares(skeleton: &Skeleton, organs: Option<&Organs>) -> Vec<f32> {
    let organs = organs.filter(|organs| !organs.is_empty());
    let hull: Vec<Vec3> = organs.into_iter().flat_map(Organs::hull).collect();
    let Some(extent) = Extent::of(skeleton, &hull) else { return Vec::new() };
    let cells = Cells::around(&extent, false);
    cells.add_wood(skeleton, |_| true);
    if let Some(organs) = organs {
        cells.add_organs(organs, |_| true);
    }
    let shade = cells.lit(Vec3::Y);
    skeleton.positions.par_iter().map(|&place| shade.at(place)[1]).collect()
}

/// A soft shadow on level ground.
pub(crate) struct Shadow {
    low: Vec2,
    per_m: f32,
    counts: [u32; 2],
    dark: Vec<f32>,
}

impl Shadow {
    /// The share of light that is missing at a place, X and Z.
    pub fn at(&self, place: Vec2) -> f32 {
        let place = (place - self.low) * self.per_m - Vec2::splat(0.5);
        let [across, down] = self.counts;
        let most = Vec2::new(across as f32, down as f32);
        if !(place.cmpge(Vec2::splat(-1.0)).all() && place.cmplt(most).all()) {
            return 0.0;
        }
        let (first, share) = (place.floor(), place - place.floor());
        let (x, y) = (first.x as i32, first.y as i32);
        let dark = |x: i32, y: i32| {
            let is_inside = x >= 0 && y >= 0 && (x as u32) < across && (y as u32) < down;
            if is_inside { self.dark[(x as u32 + across * y as u32) as usize] } else { 0.0 }
        };
        let row = |y: i32| dark(x, y) + (dark(x + 1, y) - dark(x, y)) * share.x;
        row(y) + (row(y + 1) - row(y)) * share.y
    }
}

#[cfg(test)]
mod tests {
    use linden_pipeline::dress::dress;
    use linden_pipeline::grow::grow;
    use linden_pipeline::recipe::Recipe;
    use linden_pipeline::scene::Wrap;
    use linden_pipeline::{Quiet, preset};

    use super::*;
    use crate::extent::RINGS;

    const BOX: Extent = Extent { x: 0.0, z: 0.0, bottom: 0.0, top: 2.0, radii: [1.0; RINGS], person: None };

    /// Cells with a level sheet of leaves over them, which hides a share of what is straight below.
    fn below_a_sheet(hidden: f32) -> Shade {
        let cells = Cells::around(&BOX, false);
        let side_m = 1.0 / cells.per_m;
        let across = |i: u32| -1.0 + (i as f32 + 0.5) * side_m;
        for (i, k) in (0..CELLS).flat_map(|i| (0..CELLS).map(move |k| (i, k))) {
            cells.add(Vec3::new(across(i), 1.51, across(k)), hidden * side_m * side_m);
        }
        cells.lit(Vec3::Y)
    }

    #[test]
    fn light_is_swallowed_by_the_law_of_beer_and_lambert() {
        for hidden in [0.0, 0.3, 1.2] {
            let shade = below_a_sheet(hidden);
            let [below, above] = [0.3, 1.9].map(|y| shade.at(Vec3::new(0.1, y, -0.2)));
            assert!((below[0] - libm::expf(-hidden)).abs() < 0.01, "{below:?}");
            assert!((above[0] - 1.0).abs() < 1e-3 && above[1] > 0.99);
            // Four of the sky's five ways go out below the sheet.
            assert!((below[1] - (4.0 + libm::expf(-hidden)) / 5.0).abs() < 0.01, "{below:?}");
        }
    }

    #[test]
    fn a_plane_throws_the_shadow_of_what_its_picture_shows() {
        // Of two metres square, the upper half cut out.
        let alpha = |i: usize| if i < 32 { 0 } else { 255 };
        let rgba: Vec<u8> = (0..64).flat_map(|i| [90, 120, 60, alpha(i)]).collect();
        let material = Material {
            name: "billboard".to_owned(),
            base_color: [0.2; 3],
            base_color_picture: Some(Picture::new(8, 8, rgba).into()),
            normal_picture: None,
            roughness: 0.9,
            double_sided: true,
            cutout: Some(0.5),
            wrap: Wrap::Clamp,
            translucency: None,
            passing_picture: None,
        };
        let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 2.0), (-1.0, 2.0_f32)];
        let mesh = linden_pipeline::mesh::Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: corners.map(|(x, y)| Vec2::new(0.5 + x / 2.0, y / 2.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let cells = Cells::around(&BOX, false);
        cells.add_part(&Part::new("billboard", 0, mesh), &material);
        let side_m = 1.0 / cells.per_m;
        let hidden_m2: f32 = {
            let units = cells.hidden.iter().map(|units| units.load(Ordering::Relaxed)).sum::<u64>();
            units as f32 * UNIT * side_m * side_m
        };
        assert!((hidden_m2 - 2.0 * PLANE_SHARE).abs() < 0.02, "{hidden_m2} m²");
        // The sun is behind it, half as high as far away.
        let sun = Vec3::new(0.0, 0.447, -0.894);
        let shadow = cells.lit(sun).shadow_on(0.0);
        let dark = |x: f32, z: f32| shadow.at(Vec2::new(x, z));
        assert!(dark(0.3, 1.0) > 0.35 && dark(-0.7, 0.3) > 0.35, "{} {}", dark(0.3, 1.0), dark(-0.7, 0.3));
        assert!(dark(0.3, 3.0) < 0.2, "what is cut out throws none: {}", dark(0.3, 3.0));
    }

    #[test]
    fn the_shadow_lies_away_from_the_sun() {
        let cells = Cells::around(&BOX, false);
        for i in 0..400 {
            let (x, z) = (i / 20, i % 20);
            cells.add(Vec3::new(0.02 * x as f32 - 0.2, 1.0, 0.02 * z as f32 - 0.2), 0.01);
        }
        let shadow = cells.lit(Vec3::new(-0.6, 0.8, 0.0)).shadow_on(0.0);
        // One metre above the ground: three quarters of a metre beyond it.
        let dark = |x: f32| shadow.at(Vec2::new(x, 0.0));
        assert!(dark(0.75) > 0.3 && dark(-0.75) < 0.1, "{} {}", dark(0.75), dark(-0.75));
        assert_eq!(shadow.at(Vec2::new(50.0, -3.0)), 0.0);
    }

    #[test]
    fn strokes_and_surface_throw_the_same_shade() {
        for id in ["umbrella-thorn", "fir"] {
            let mut recipe = Recipe::new(preset::builtin(id).unwrap().load().unwrap());
            recipe.preset.set("points", "700").unwrap();
            let grown = grow(&recipe, &Quiet).unwrap();
            let scene = dress(&recipe, &grown, &Quiet).unwrap();
            let hull: Vec<Vec3> = grown.organs.hull().collect();
            let extent = Extent::of(&grown.skeleton, &hull).unwrap();
            let sum =
                |cells: Cells| cells.hidden.into_iter().map(|units| units.into_inner() as f64).sum::<f64>();
            let strokes = Cells::around(&extent, false);
            strokes.add_wood(&grown.skeleton, |_| true);
            strokes.add_organs(&grown.organs, |_| true);
            let surface = Cells::around(&extent, false);
            for part in &scene.parts {
                surface.add_part(part, &scene.materials[part.material]);
            }
            let ratio = sum(strokes) / sum(surface);
            assert!((0.7..1.4).contains(&ratio), "{id}: {ratio}");
        }
    }
}
