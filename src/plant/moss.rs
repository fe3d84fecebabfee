//! Moss on the wood: which triangles have how much of it, and the materials for that.
//!
//! How much there is at a place follows from the way that the bark faces there, its height over the foot and slow
//! noise. Triangles with enough of it are cut out of the trunk's part into up to [`STEPS`] parts of their own, each
//! with a picture of the bark on which moss covers so much more; the last step below is bare. No triangle is added.

use glam::Vec3;

use crate::Specimen;
use crate::scene::{Material, Part};
use crate::settings::MossSettings;
use crate::texture::{BarkError, Moss};
use crate::wood_parts::{self, Cuts};
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_base::random::Key;

/// How densely moss covers the bark, from the first step to the last.
pub const STEPS: [f32; 4] = [0.06, 0.2, 0.42, 0.74];
/// From which density on a place has each step.
const FROM: [f32; 4] = [0.12, 0.24, 0.42, 0.64];
/// Pictures of dense moss have a quarter of the pixels: it is soft.
const HALVINGS: [u32; 4] = [0, 1, 1, 1];
/// What parts and materials are called, after `wood` and `bark`.
const NAMES: [&str; 4] = ["moss_1", "moss_2", "moss_3", "moss_4"];
/// Radii of the foot, up to which moss is more than half as dense where nothing else is said.
const HEIGHT_RADII: f32 = 8.0;
/// Densities of a place that looks to the side of moss, and to the sky, at the foot; of the foot all round.
const BY_SIDE: f32 = 0.75;
const BY_SKY: f32 = 0.55;
const BY_FOOT: f32 = 0.5;
/// What is left of these far up: high limbs have moss on top, little of it.
const ALOFT: f32 = 0.3;
/// How far noise moves a density.
const NOISE: f32 = 0.22;
/// Waves of the noise, to a metre.
const WAVES_PER_M: f32 = 2.3;

/// A single mossy part has at least this share of the wood's triangles.
const WORTH_A_PART: f32 = 0.03;

/// The materials of mossy bark, a step each; none without moss.
pub(crate) fn materials(
    specimen: &Specimen<'_>,
    bark: &Material,
    monitor: &dyn Monitor,
) -> Result<Vec<Material>, BarkError> {
    let look = &specimen.dressing.bark;
    if look.moss.amount == 0.0 {
        return Ok(Vec::new());
    }
    // Without a picture, where nobody wants colours, the wood is cut all the same: files hold it in one order.
    let picture = bark.base_color_picture.as_ref();
    let step = |((share, halvings), name): ((f32, u32), &str)| {
        let key = Key::new(look.seed).named("moss");
        let moss = Moss { share, color: look.moss.color, halvings, key };
        Ok(Material {
            name: format!("{}_{name}", bark.name),
            base_color: moss.mean(bark.base_color),
            base_color_picture: picture
                .map(|picture| specimen.drawn.mossy(picture, moss, monitor))
                .transpose()?,
            normal_picture: bark.normal_picture.clone(),
            ..bark.clone()
        })
    };
    STEPS.into_iter().zip(HALVINGS).zip(NAMES).map(step).collect()
}

/// A tree that moss grows on.
pub(crate) struct Mossy<'a> {
    pub settings: &'a MossSettings,
    /// Height of its foot, metres.
    pub foot_m: f32,
    /// Of its thickest stem at the foot, metres.
    pub radius_m: f32,
    pub key: Key,
}

impl<'a> Mossy<'a> {
    /// A specimen whose foot is at a height and has a radius.
    pub fn on(specimen: &Specimen<'a>, foot_m: f32, radius_m: f32) -> Self {
        let settings = &specimen.dressing.bark.moss;
        Self { settings, foot_m, radius_m, key: specimen.key().named("moss") }
    }

    /// How much there is at a place whose bark faces so: 0 or less none, 1 all of it.
    pub fn density(&self, place: Vec3, normal: Vec3) -> f32 {
        let settings = self.settings;
        let (east, north) = libm::sincosf(settings.side_deg.to_radians() as f32);
        let side = Vec3::new(east, 0.0, -north);
        let toward = ((normal.dot(side) + 0.2) / 1.2).max(0.0);
        let height_m = settings.height_m.map_or(HEIGHT_RADII * self.radius_m, |height_m| height_m as f32);
        let high = ((place.y - self.foot_m) / height_m.max(1e-3)).max(0.0);
        let low = ALOFT + (1.0 - ALOFT) / (1.0 + high * high);
        // What hangs over is dry.
        let faced = BY_SIDE * toward + BY_SKY * normal.y.max(0.0) - 0.6 * (-normal.y).max(0.0);
        let foot = BY_FOOT * libm::expf(-5.0 * high);
        // Small amounts are thin everywhere.
        let amount = settings.amount;
        amount.sqrt() * (faced.max(0.0) * low + foot) * (0.5 + 0.5 * amount) + NOISE * self.noise(place)
    }

    /// -1 to 1, slow.
    fn noise(&self, place: Vec3) -> f32 {
        let wave = |name: &str, way: Vec3| {
            let phase = self.key.named(name).between(0.0, std::f64::consts::TAU) as f32;
            libm::sinf(WAVES_PER_M * std::f32::consts::TAU * place.dot(way) + phase)
        };
        let slow = wave("first", Vec3::new(0.31, 0.42, 0.12)) + wave("second", Vec3::new(-0.22, 0.35, 0.38));
        let quick = wave("third", Vec3::new(1.1, -0.6, 0.7)) + wave("fourth", Vec3::new(-0.8, -0.9, 1.0));
        0.3 * slow + 0.2 * quick
    }

    /// The step of each triangle of thick wood, 0 for bare bark.
    fn steps(&self, wood: &Mesh, is_thick: &[bool]) -> Vec<u8> {
        let step = |(corners, is_thick): (&[u32; 3], &bool)| {
            if !*is_thick {
                return 0;
            }
            let mean = |of: &[Vec3]| corners.iter().map(|&i| of[i as usize]).sum::<Vec3>() / 3.0;
            let density = self.density(mean(&wood.positions), mean(&wood.normals).normalize_or_zero());
            FROM.iter().filter(|&&from| density >= from).count() as u8
        };
        wood.triangles.iter().zip(is_thick).map(step).collect()
    }

    /// What covers a trunk. Of few steps nothing does where these would be few of the wood's `all` triangles.
    pub fn cover(&self, trunk: &Mesh, is_thick: &[bool], (which, all): (Cuts, usize)) -> Covering {
        let mut steps = self.steps(trunk, is_thick);
        let mut kept: Vec<usize> = (0..NAMES.len()).collect();
        if which == Cuts::Few {
            let most = most_moss(trunk, &steps);
            for step in &mut steps {
                *step = u8::from(usize::from(*step) > most);
            }
            let triangles = steps.iter().filter(|step| **step > 0).count();
            kept = vec![most];
            if (triangles as f32) < WORTH_A_PART * all as f32 {
                kept.clear();
                steps.fill(0);
            }
        }
        Covering { steps, kept }
    }
}

/// The moss on a trunk.
pub(crate) struct Covering {
    /// Of each triangle: 0 for bare bark, else the number of one of the `kept`, from 1.
    pub steps: Vec<u8>,
    /// Which of the [`materials`] there are.
    pub kept: Vec<usize>,
}

impl Covering {
    /// Cuts mossy parts out of a piece of the trunk, whose triangles have these steps. Their materials follow each other
    /// from `first` on.
    pub fn cut(&self, piece: &Part, steps: &[u8], first: usize) -> Vec<Part> {
        let names: Vec<&str> = self.kept.iter().map(|&step| NAMES[step]).collect();
        let mut parts = wood_parts::cut(piece, steps, &names);
        for part in parts.iter_mut().filter(|part| part.material > piece.material) {
            part.material += first - piece.material - 1;
        }
        parts
    }
}

/// The index of the step whose triangles bear most moss.
fn most_moss(wood: &Mesh, steps: &[u8]) -> usize {
    let mut moss = [0.0_f64; STEPS.len()];
    for (corners, &step) in wood.triangles.iter().zip(steps) {
        if let Some(step) = usize::from(step).checked_sub(1) {
            let [a, b, c] = corners.map(|i| wood.positions[i as usize]);
            moss[step] += f64::from(STEPS[step] * (b - a).cross(c - a).length());
        }
    }
    (1..moss.len()).fold(0, |most, step| if moss[step] > moss[most] { step } else { most })
}

/// Bytes that [`Covering::cut`] takes at most, the parts among them.
pub(crate) fn bytes_to_cut(trunk: &Part) -> u64 {
    wood_parts::bytes_for(trunk) + trunk.mesh.triangles.len() as u64
}

/// Bytes of all steps' pictures.
pub(crate) fn bytes(materials: &[Material]) -> u64 {
    let pictures = materials.iter().filter_map(|material| material.base_color_picture.as_ref());
    pictures.map(|picture| picture.rgba().len() as u64).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::{Level, levels};
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;
    use linden_skeleton::NO_PARENT;

    /// Area of what has each step, by step, and the mean normal of what has any.
    fn mossy(knobs: &[(&str, &str)]) -> ([f32; 5], Vec3) {
        let all = [&[("points", "400"), ("bark_size", "64"), ("leaf_size", "32")], knobs].concat();
        let subject = Subject::builtin("drawn-oak", &all);
        let scene = subject.dress(&subject.grow());
        let (mut areas, mut facing) = ([0.0; 5], Vec3::ZERO);
        for part in scene.parts.iter().filter(|part| part.name.starts_with("wood")) {
            let step = part.name.strip_prefix("wood_moss_").map_or(0, |step| step.parse().unwrap());
            assert_eq!(
                scene.materials[part.material].name.ends_with(&format!("moss_{step}")),
                step > 0_usize
            );
            for corners in &part.mesh.triangles {
                let [a, b, c] = corners.map(|i| part.mesh.positions[i as usize]);
                let square = (b - a).cross(c - a) * 0.5;
                areas[step] += square.length();
                if step > 1 {
                    facing += square;
                }
            }
        }
        (areas, facing.normalize_or_zero())
    }

    #[test]
    fn it_grows_where_it_is_told_to_and_more_of_it_is_more() {
        let (none, _) = mossy(&[("moss", "0")]);
        assert_eq!(none[1..], [0.0; 4]);
        let total: f32 = none.iter().sum();
        let mut before = 0.0;
        for amount in ["0.15", "0.4", "1"] {
            let (areas, facing) = mossy(&[("moss", amount)]);
            let covered: f32 = STEPS.iter().zip(&areas[1..]).map(|(share, area)| share * area).sum();
            assert!(covered > 1.3 * before, "{amount}: {covered} after {before}");
            before = covered;
            // The same wood.
            assert!((areas.iter().sum::<f32>() / total - 1.0).abs() < 1e-4, "{areas:?} of {total}");
            assert!(facing.z < -0.1, "{amount}: {facing} is not north");
        }
        for (side, toward) in [("90", Vec3::X), ("180", Vec3::Z), ("270", Vec3::NEG_X)] {
            let (_, facing) = mossy(&[("moss", "0.6"), ("moss_side", side)]);
            assert!(facing.dot(toward) > 0.1, "{side}: {facing}");
        }
    }

    #[test]
    fn levels_of_detail_have_one_mossy_part_at_most() {
        let small = [("bark_size", "64"), ("leaf_size", "32"), ("card_size", "128")];
        let levels_of = |knobs: &[(&str, &str)]| {
            let subject = Subject::builtin("oak", &[&small[..], knobs].concat());
            let grown = subject.grow();
            let levels = subject.with(|specimen| levels(specimen, body(&grown), &Quiet)).unwrap().levels;
            let mossy = |level: &Level| {
                let parts = level.scene.parts.iter().filter(|part| part.name.contains("moss"));
                let materials =
                    level.scene.materials.iter().filter(|material| material.name.contains("moss"));
                (parts.count(), materials.count())
            };
            let found: Vec<_> = levels.iter().map(mossy).collect();
            for level in &levels {
                let wood = level.scene.parts.iter().filter(|part| part.name.starts_with("wood"));
                let all: usize = wood.clone().map(|part| part.mesh.triangles.len()).sum();
                let moss = wood.filter(|part| part.name.contains("moss"));
                let mut moss = moss.map(|part| part.mesh.triangles.len());
                assert!(moss.clone().count() > 1 || moss.all(|triangles| triangles * 40 > all));
                // Each material is worn.
                let is_worn = |i: usize| level.scene.parts.iter().any(|part| part.material == i);
                let unworn = (0..level.scene.materials.len()).filter(|&i| !is_worn(i));
                assert!(unworn.into_iter().all(|i| !level.scene.materials[i].name.contains("moss")));
            }
            found
        };
        let much = [("moss", "0.8"), ("lod_triangles", "20000 10000 4000 1000")];
        assert_eq!(levels_of(&much), [(1, 1), (1, 1), (0, 0), (0, 0)]);
        // The whole tree has all steps.
        let whole =
            levels_of(&[("moss", "0.8"), ("lods", "2"), ("lod_ratio", "0.05"), ("leaf_keep", "0.02")]);
        assert_eq!(whole[0], (4, 4));
    }

    #[test]
    fn a_few_triangles_are_not_worth_a_draw_call() {
        let knobs = [("points", "400"), ("bark_size", "64"), ("leaf_size", "32")];
        let bare = Subject::builtin("drawn-oak", &[&knobs[..], &[("moss", "0")]].concat());
        let grown = bare.grow();
        let trunk = &bare.dress(&grown).parts[0];
        let wood = trunk.mesh.triangles.len();
        Subject::builtin("drawn-oak", &[&knobs[..], &[("moss", "0.4")]].concat()).with(|specimen| {
            let mossy = Mossy::on(specimen, 0.0, grown.skeleton.foot_radius_m());
            let cut = |all| {
                let covering = mossy.cover(&trunk.mesh, &vec![true; wood], (Cuts::Few, all));
                (covering.cut(trunk, &covering.steps, 1), covering.kept)
            };
            let (parts, kept) = cut(wood);
            assert_eq!((parts.len(), kept.len()), (2, 1));
            assert_eq!(parts[1].name, format!("wood_{}", NAMES[kept[0]]));
            // The same moss where all wood is forty times as much.
            let (parts, kept) = cut(40 * wood);
            assert_eq!((parts.len(), kept.len()), (1, 0));
            assert_eq!(parts[0].mesh.triangles.len(), wood);
        });
    }

    #[test]
    fn thin_wood_and_the_undersides_of_limbs_have_none() {
        let subject = Subject::builtin(
            "drawn-oak",
            &[
                ("points", "400"),
                ("bark_size", "64"),
                ("leaf_size", "32"),
                ("moss", "1"),
                ("moss_radius", "0.1"),
            ],
        );
        let grown = subject.grow();
        let scene = subject.dress(&grown);
        let skeleton = &grown.skeleton;
        let mut seen = 0;
        for part in scene.parts.iter().filter(|part| part.name.starts_with("wood_moss")) {
            for corners in &part.mesh.triangles {
                let middle = corners.iter().map(|&i| part.mesh.positions[i as usize]).sum::<Vec3>() / 3.0;
                // Roots and stubs are wood of the trunk, however thin.
                if middle.y < 4.0 {
                    continue;
                }
                // Thick wood is within its radius, and what its collars add. Borders follow the rings: a piece is
                // thick where one of its ends is.
                let is_near = |node: usize| {
                    let below = match skeleton.parents[node] {
                        NO_PARENT => node,
                        parent => parent as usize,
                    };
                    let [from, to] = [below, node].map(|node| skeleton.positions[node]);
                    let radius = skeleton.radii[node].max(skeleton.radii[below]);
                    let way = to - from;
                    let share = (middle - from).dot(way) / way.length_squared().max(1e-9);
                    radius > 0.09 && middle.distance(from + way * share.clamp(0.0, 1.0)) < 2.5 * radius
                };
                assert!((0..skeleton.positions.len()).any(is_near), "{middle}");
                seen += 1;
            }
        }
        assert!(seen > 50, "{seen}");
        let mossy = Mossy {
            settings: &MossSettings { amount: 1.0, ..MossSettings::default() },
            foot_m: 0.0,
            radius_m: 0.3,
            key: Key::new(1),
        };
        for i in 0..50 {
            let place = Vec3::new(i as f32, 6.0, -3.0);
            assert!(mossy.density(place, Vec3::Y) > mossy.density(place, Vec3::NEG_Y));
            assert!(mossy.density(place, Vec3::NEG_Y) < FROM[2]);
        }
    }
}
