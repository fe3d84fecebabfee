//! The bark of the foot: which triangles of the trunk have it, and the materials for that.
//!
//! It begins at the ground. Above, over [`FOOT_EDGE_TILES`] tiles of bark, the trunk's own is torn open over it: a part with a
//! picture of both, which begins and ends at a ring.

use linden_base::color::linear;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_skeleton::{NO_PARENT, Skeleton};

use crate::Specimen;
use crate::dress::bark_material;
use crate::scene::Material;
use crate::surface::{Amount, FOOT_EDGE_TILES, Tubes};
use crate::texture::{BarkError, Torn};

/// What parts and materials are called, after `wood` and `bark`: all of it, and the edge where it ends.
pub const NAMES: [&str; 2] = ["foot", "foot_edge"];
/// The numbers of these.
pub const WHOLE: u8 = 1;
pub const EDGE: u8 = 2;

/// The materials of the foot; none where its bark is the trunk's.
pub(crate) fn materials(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<Vec<Material>, BarkError> {
    let look = &specimen.dressing.bark;
    let Some(lower) = specimen.dressing.foot_bark().filter(|_| look.is_drawn()) else {
        return Ok(Vec::new());
    };
    let upper = look.bark();
    let torn = Torn { tiles: FOOT_EDGE_TILES, key: Key::new(look.seed).named("torn") };
    let (mut whole, mut edge) = (None, None);
    if specimen.wanted.colors {
        whole = Some(specimen.drawn.bark(&lower, monitor)?);
        edge = Some(specimen.drawn.torn((&upper, &lower), torn, monitor)?);
    }
    let material = |name: &str, pictures| bark_material(format!("bark_{name}"), lower.color, pictures);
    let (whole, mut edge) = (material(NAMES[0], whole), material(NAMES[1], edge));
    let above = linear(upper.color);
    edge.base_color = std::array::from_fn(|channel| f32::midpoint(edge.base_color[channel], above[channel]));
    Ok(vec![whole, edge])
}

/// Where the foot's bark is on a tree.
pub(crate) struct Foot {
    /// Height of the ground there, metres.
    ground_m: f32,
    tile_m: f32,
    /// Between which heights the edge is, in tiles over the foot.
    edge: [f32; 2],
}

impl Foot {
    /// Of a tree whose foot is at a height; `None` where it has no bark of its own.
    pub fn of(tubes: &Tubes, ground_m: f32) -> Option<Self> {
        let edge = tubes.foot_edge()?.map(|tiles| tiles as f32);
        Some(Self { ground_m, tile_m: tubes.bark_tile_m, edge })
    }

    /// How much of the bark there is at a height, metres: 0 none, 1 nothing else.
    pub fn share(&self, height_m: f32) -> f32 {
        let [from, to] = self.edge;
        (1.0 - ((height_m - self.ground_m) / self.tile_m - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// The number of each triangle of tubes, which are `counts` one after another: 0 for the trunk's bark, else [`WHOLE`]
    /// or [`EDGE`]. Stems change at their rings. Roots are the foot's, and other wood that is as low as the middle of the edge.
    pub fn numbers(
        &self,
        mesh: &Mesh,
        counts: &[Amount],
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<Vec<u8>, Cancelled> {
        let mut numbers = Vec::with_capacity(mesh.triangles.len());
        let mean = |corners: &[u32; 3], of: &dyn Fn(usize) -> f32| {
            corners.iter().map(|&corner| of(corner as usize)).sum::<f32>() / 3.0
        };
        let (mut vertex, mut triangle) = (0, 0);
        for (axis, amount) in skeleton.axes.iter().zip(counts) {
            monitor.check()?;
            let is_stem = axis.parent == NO_PARENT;
            let roots_from = vertex + amount.vertices - amount.roots[0];
            let tube = vertex..roots_from - amount.stubs;
            for corners in &mesh.triangles[triangle..triangle + amount.triangles] {
                let first = corners[0] as usize;
                numbers.push(if is_stem && tube.contains(&first) {
                    let tiles = mean(corners, &|i| mesh.uvs[i].y);
                    match self.edge {
                        [from, _] if tiles < from => WHOLE,
                        [_, to] if tiles < to => EDGE,
                        _ => 0,
                    }
                } else {
                    let height_m = mean(corners, &|i| mesh.positions[i].y);
                    u8::from(first >= roots_from || self.share(height_m) > 0.5) * WHOLE
                });
            }
            vertex += amount.vertices;
            triangle += amount.triangles;
        }
        Ok(numbers)
    }

    /// Lays the picture of the edge on its part, once from ring to ring.
    pub fn stretch(&self, edge: &mut Mesh) {
        let [from, to] = self.edge;
        edge.uvs.iter_mut().for_each(|uv| uv.y = ((uv.y - from) / (to - from)).clamp(0.0, 1.0));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::detail::levels;
    use crate::scene::Scene;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;

    const SMALL: [(&str, &str); 6] = [
        ("points", "400"),
        ("bark_size", "64"),
        ("leaf_size", "32"),
        ("card_size", "128"),
        ("moss", "0"),
        ("bark_tile", "0.4"),
    ];

    fn oak(knobs: &[(&str, &str)]) -> Subject {
        Subject::builtin("drawn-oak", &[&SMALL[..], knobs].concat())
    }

    fn area(mesh: &Mesh) -> f32 {
        let corners = mesh.triangles.iter().map(|corners| corners.map(|i| mesh.positions[i as usize]));
        corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    fn wood<'a>(scene: &'a Scene, name: &str) -> &'a Mesh {
        let part = scene.parts.iter().find(|part| part.name == name);
        let part = part.unwrap_or_else(|| panic!("no {name}"));
        assert_eq!(scene.materials[part.material].name, name.replacen("wood", "bark", 1));
        &part.mesh
    }

    /// V of both parts at each place that both have.
    fn border(lower: &Mesh, upper: &Mesh) -> Vec<[f32; 2]> {
        let at = |place: &Vec3| upper.positions.iter().position(|other| other == place);
        let shared = lower.positions.iter().zip(&lower.uvs);
        shared.filter_map(|(place, uv)| Some([uv.y, upper.uvs[at(place)?].y])).collect()
    }

    #[test]
    fn it_changes_at_rings_where_pictures_begin_and_end() {
        let bare = oak(&[("surface_roots", "0"), ("flare", "0")]);
        let grown = bare.grow();
        let all: f32 = bare.dress(&grown).parts[..1].iter().map(|part| area(&part.mesh)).sum();
        // 1.9 m are 4.75 tiles: the edge is from the third to the fifth.
        let subject = oak(&[("surface_roots", "0"), ("flare", "0"), ("foot_height", "1.9")]);
        let scene = subject.dress(&grown);
        let parts = ["wood", "wood_foot", "wood_foot_edge"].map(|name| wood(&scene, name));
        let areas = parts.map(area);
        assert!((areas.iter().sum::<f32>() / all - 1.0).abs() < 1e-3, "{areas:?} of {all}");
        let [trunk, foot, edge] = parts;
        let below = border(foot, edge);
        let above = border(edge, trunk);
        assert!(below.len() >= 24 && above.len() >= 24, "{} {}", below.len(), above.len());
        for [foot, edge] in below {
            assert!((foot - 3.0).abs() < 1e-3 && edge.abs() < 1e-3, "{foot} {edge}");
        }
        for [edge, trunk] in above {
            assert!((edge - 1.0).abs() < 1e-3 && (trunk - 5.0).abs() < 1e-3, "{edge} {trunk}");
        }
        // Each of its two tiles is as high as any: a picture is not stretched on it.
        let m_of = |[a, b]: [usize; 2]| edge.positions[a].distance(edge.positions[b]);
        let span = |[a, b]: [usize; 2]| 2.0 * (edge.uvs[a].y - edge.uvs[b].y).abs();
        let (mut length_m, mut tiles) = (0.0, 0.0);
        for corners in &edge.triangles {
            let corners = corners.map(|i| i as usize);
            // Up the stem: an edge that goes nowhere round it.
            for pair in [[0, 1], [1, 2], [2, 0]].map(|pair| pair.map(|i| corners[i])) {
                if (edge.uvs[pair[0]].x - edge.uvs[pair[1]].x).abs() < 1e-6 {
                    length_m += m_of(pair);
                    tiles += span(pair);
                }
            }
        }
        assert!((length_m / tiles / 0.4 - 1.0).abs() < 0.05, "{length_m} m are {tiles} tiles");
    }

    #[test]
    fn roots_have_it_and_what_is_thin_or_high_has_not() {
        let subject = oak(&[("foot_height", "0.8"), ("surface_roots", "6"), ("root_reach", "6")]);
        let scene = subject.dress(&subject.grow());
        let foot = wood(&scene, "wood_foot");
        let radius_m = |place: &Vec3| libm::hypotf(place.x, place.z);
        let reach_m = foot.positions.iter().map(radius_m).fold(0.0, f32::max);
        let trunk_m = subject.grow().skeleton.foot_radius_m();
        assert!(reach_m > 3.0 * trunk_m, "{reach_m} of {trunk_m}: no roots");
        let highest = |name| wood(&scene, name).positions.iter().map(|place| place.y).fold(0.0, f32::max);
        assert!(highest("wood_foot") <= highest("wood_foot_edge") && highest("wood_foot_edge") < 0.9);
        // Nothing of the trunk's own bark is left of the roots.
        let trunk = wood(&scene, "wood");
        assert!(trunk.positions.iter().all(|place| place.y > 0.7 || radius_m(place) > 3.0 * trunk_m));
    }

    #[test]
    fn moss_grows_on_it_and_small_levels_have_neither() {
        let subject = oak(&[("foot_height", "2"), ("moss", "0.8"), ("lod_triangles", "20000 6000 1000")]);
        let grown = subject.grow();
        let whole = oak(&[("foot_height", "2"), ("moss", "0.8")]).dress(&grown);
        for name in ["wood_foot_moss_2", "wood_foot_edge_moss_2"] {
            assert!(area(wood(&whole, name)) > 0.0);
        }
        let levels = subject.with(|specimen| levels(specimen, body(&grown), &Quiet)).unwrap().levels;
        let has = |name: &str| {
            levels
                .iter()
                .map(|level| level.scene.parts.iter().any(|part| part.name == name))
                .collect::<Vec<_>>()
        };
        assert_eq!(has("wood_foot"), [true, true, false]);
        assert_eq!(has("wood_foot_edge"), [true, true, false]);
        for level in &levels {
            let is_worn = |i: usize| level.scene.parts.iter().any(|part| part.material == i);
            let unworn = (0..level.scene.materials.len()).filter(|&i| !is_worn(i));
            assert!(unworn.into_iter().all(|i| !level.scene.materials[i].name.contains("foot")));
        }
    }
}
