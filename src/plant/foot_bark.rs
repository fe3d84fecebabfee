//! The bark of the foot: which triangles of the trunk have it, and the materials for that.
//!
//! It begins at the ground. Above, over one or two tiles of bark, the trunk's own is torn open over it: a part with a
//! picture of both, which begins and ends at a ring.

use linden_base::color::linear;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_skeleton::{NO_PARENT, Skeleton};

use crate::Specimen;
use crate::dress::bark_material;
use crate::scene::Material;
use crate::surface::{Amount, Tubes};
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
    let Some([from, to]) = specimen.dressing.tubes.foot_edge() else { return Ok(Vec::new()) };
    let upper = look.bark();
    let torn = Torn { tiles: to - from, key: Key::new(look.seed).named("torn") };
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
    /// or [`EDGE`]. Stems that stand on the ground change at their rings. Roots are the foot's, and other wood that is as low as
    /// the middle of the edge, however thin.
    pub fn numbers(
        &self,
        mesh: &Mesh,
        counts: &[Amount],
        skeleton: &Skeleton,
        monitor: &dyn Monitor,
    ) -> Result<Vec<u8>, Cancelled> {
        let mut numbers = Vec::with_capacity(mesh.triangles.len());
        let (mut vertex, mut triangle) = (0, 0);
        for (axis, amount) in skeleton.axes.iter().zip(counts) {
            monitor.check()?;
            let foot = skeleton.nodes_of(axis).first().filter(|_| axis.parent == NO_PARENT);
            let foot = foot.map(|&node| (skeleton.positions[node as usize].y, skeleton.radii[node as usize]));
            let stands_at_m = foot.filter(|(y, radius_m)| y - self.ground_m <= *radius_m).map(|(y, _)| y);
            let roots_from = vertex + amount.vertices - amount.roots[0];
            let stubs_from = roots_from - amount.stubs;
            for corners in &mesh.triangles[triangle..triangle + amount.triangles] {
                let corners = corners.map(|corner| corner as usize);
                let mean = |of: &dyn Fn(usize) -> f32| corners.into_iter().map(of).sum::<f32>() / 3.0;
                let height_m = mean(&|i| mesh.positions[i].y);
                numbers.push(match stands_at_m {
                    Some(y) if corners[0] < stubs_from => {
                        self.of_stem(mean(&|i| mesh.uvs[i].y), (height_m - y) / self.tile_m)
                    }
                    _ => u8::from(corners[0] >= roots_from || self.share(height_m) > 0.5) * WHOLE,
                });
            }
            vertex += amount.vertices;
            triangle += amount.triangles;
        }
        Ok(numbers)
    }

    /// The number of a stem's triangle at a V of the bark, and at a height over its foot, in tiles. V is the way from the
    /// foot, which is never less than the height: but where the stem ends it runs across the wood.
    fn of_stem(&self, v: f32, height: f32) -> u8 {
        let way = if height > v + 1.0 { height } else { v };
        match self.edge {
            // Where the edge begins at the ground, what is below is the edge, too.
            [from, _] if way < from && from > 0.0 => WHOLE,
            [_, to] if way < to => EDGE,
            _ => 0,
        }
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
    use crate::surface::Junction;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;
    use linden_pipeline::preset::Preset;
    use linden_pipeline::recipe::Recipe;

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
        assert!(trunk.positions.iter().all(|place| place.y > 0.2));
    }

    #[test]
    fn it_is_at_feet_alone() {
        // A thick pole is sawn off high up, across its bark, and a second one hangs in the air.
        let poles = "id = \"poles\"\n[lsystem]\naxiom = \"FFFF[f(8)FF]\"\nrules = []\nderivations = 0\n\
                     segment_length = 1\nsegment_width = 0.2\n[surface]\nfoot_height = 1.5\nends = \"cut\"\n\
                     [bark]\nbark_size = 64\n";
        let subject = Subject::of(Recipe::new(Preset::from_toml(poles).unwrap()));
        let scene = subject.dress(&subject.grow());
        let highest = |name: &str| {
            wood(&scene, name).positions.iter().map(|place| place.y).fold(f32::NEG_INFINITY, f32::max)
        };
        assert!(highest("wood") > 13.0);
        assert!(highest("wood_foot") < 0.6 && highest("wood_foot_edge") < 1.6);
    }

    #[test]
    fn an_edge_is_no_higher_than_is_asked_for() {
        let tubes = |height_m: f32, tile_m: f32| {
            let mut tubes = Tubes { bark_tile_m: tile_m, ..Tubes::default() };
            tubes.features.foot_height_m = height_m;
            tubes
        };
        for (height_m, tile_m, edge) in [
            (0.0, 0.5, None),
            (0.2, 0.5, None),
            (1.8, 10.0, None),
            (0.3, 0.5, Some([0, 1])),
            (0.8, 0.5, Some([0, 2])),
            (1.8, 0.5, Some([2, 4])),
        ] {
            assert_eq!(tubes(height_m, tile_m).foot_edge(), edge, "{height_m} of {tile_m}");
        }
        let solid = Tubes { junction: Junction::Watertight, ..tubes(1.8, 0.5) };
        assert_eq!(solid.foot_edge(), None);
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
        // Levels have one step of it, the same on all barks, down to the ground.
        for level in &levels[..2] {
            let mossy = level.scene.parts.iter().filter(|part| part.name.contains("moss"));
            let steps: Vec<_> = mossy.clone().map(|part| part.name.rsplit('_').next()).collect();
            assert!(steps.len() == 3 && steps.windows(2).all(|pair| pair[0] == pair[1]), "{steps:?}");
            let lowest = mossy.flat_map(|part| &part.mesh.positions).map(|place| place.y);
            assert!(lowest.fold(f32::INFINITY, f32::min) < 0.1);
        }
        for level in &levels {
            let is_worn = |i: usize| level.scene.parts.iter().any(|part| part.material == i);
            let unworn = (0..level.scene.materials.len()).filter(|&i| !is_worn(i));
            assert!(unworn.into_iter().all(|i| !level.scene.materials[i].name.contains("foot")));
        }
    }
}
