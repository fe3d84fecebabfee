use glam::Vec3;

use super::*;
use crate::scene::Scene;
use crate::stage::{Place, Surroundings};
use crate::testing::Subject;
use linden_base::monitor::Quiet;

fn scene(id: &str, knobs: &[(&str, &str)]) -> Scene {
    let subject = Subject::builtin(id, &[&[("bark_size", "64"), ("leaf_size", "64")], knobs].concat());
    subject.dress(&subject.grow())
}

fn covered<'s>(stage: Stage<'s>, kinds: &[GroundCover]) -> Stage<'s> {
    stage.surrounded(&Surroundings { sun: None, cover: kinds.to_vec() }, &Quiet).unwrap()
}

/// Whether each triangle shows its front where its normals point.
fn winds_with_its_normals(mesh: &Mesh) -> bool {
    mesh.triangles.iter().all(|triangle| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let leaning: Vec3 = triangle.iter().map(|&vertex| mesh.normals[vertex as usize]).sum();
        (b - a).cross(c - a).dot(leaning) > 0.0
    })
}

fn patches<'s>(stage: &'s Stage<'_>, kind: GroundCover) -> Vec<&'s GroundPatch> {
    stage.setting.as_ref().unwrap().ground.cover.iter().filter(|patch| patch.kind == kind).collect()
}

#[test]
fn grass_stands_on_the_ground_and_has_no_edge() {
    let scene = scene("simple", &[("points", "50")]);
    let stage = covered(Stage::of(&scene), &[GroundCover::Grass]);
    let setting = stage.setting.as_ref().unwrap();
    let patches = patches(&stage, GroundCover::Grass);
    assert_eq!(patches.len(), VARIANTS);
    for patch in &patches {
        let bounds = patch.bounds().unwrap();
        assert!(bounds.min.y == 0.0 && (0.1..0.35).contains(&bounds.max.y), "{bounds:?}");
        assert_eq!(patch.mesh.positions.len(), patch.mesh.normals.len());
        assert!(patch.mesh.normals.iter().all(|n| n.y > 0.0 && (n.length() - 1.0).abs() < 1e-5));
        assert!(winds_with_its_normals(&patch.mesh));
    }
    // By rings of the same area: as many in the first two thirds, and ever fewer after.
    let meadow = Meadow::seen_in(setting);
    let mut counts = [0_usize; 9];
    let places = || patches.iter().flat_map(|patch| &patch.placements);
    for at in places() {
        let share = Vec2::new(at.position.x, at.position.z).distance(meadow.middle) / meadow.radius_m;
        assert!(share <= 1.0 && at.position.y == 0.0);
        counts[((share * share * 9.0) as usize).min(8)] += 1;
    }
    assert!(places().count() < MOST_PLACES as usize);
    let inner = counts[..4].iter().sum::<usize>() / 4;
    assert!(counts[..4].iter().all(|&count| count.abs_diff(inner) * 4 < inner), "{counts:?}");
    assert!(counts[8] * 2 < inner && counts[8] < counts[6], "{counts:?}");
}

#[test]
fn leaves_lie_below_the_crown_that_shed_them() {
    let scene = scene("dressed-simple", &[("points", "200")]);
    let mut stage = Stage::of(&scene);
    stage.places.push(Place { position: Vec3::new(40.0, 0.0, 5.0), scale: 0.5, ..Place::origin(0) });
    let stage = covered(stage, &[GroundCover::Litter]);
    assert!(patches(&stage, GroundCover::Grass).is_empty());
    let patches = patches(&stage, GroundCover::Litter);
    assert!(!patches.is_empty());
    let plant = scene.parts.iter().filter_map(|part| part.mesh.bounds()).reduce(Bounds::union).unwrap();
    let crown_m = 0.25 * (plant.size().x + plant.size().z);
    let mut below = [0_usize; 2];
    for at in patches.iter().flat_map(|patch| &patch.placements) {
        let reach =
            |place: &Place| at.position.distance(place.position) <= 1.25 * crown_m * place.scale + 1e-4;
        let tree = stage.places.iter().position(reach).expect("a leaf beyond every crown");
        below[tree] += 1;
    }
    // The same patches on a quarter of the ground.
    assert!(below[0].abs_diff(below[1]) * 3 < below[0], "{below:?}");
    for patch in patches {
        let bounds = patch.mesh.bounds().unwrap();
        assert!(bounds.min.y > 0.0, "{bounds:?}");
        assert!(winds_with_its_normals(&patch.mesh));
        // Brown, and as transparent as the leaf was.
        let brown = |rgba: &[u8]| rgba[0] >= rgba[1] && rgba[1] >= rgba[2];
        let picture = patch.material.base_color_picture.as_ref();
        assert!(picture.is_none_or(|picture| picture.rgba().chunks_exact(4).all(brown)));
        let [r, g, b] = patch.material.base_color;
        assert!(r > g && g > b);
    }
}

#[test]
fn what_has_no_leaves_sheds_none() {
    let scene = scene("dressed-simple", &[("points", "50"), ("leaf_form", "none")]);
    assert!(scene.organs.is_empty());
    let stage = covered(Stage::of(&scene), &GroundCover::ALL);
    assert!(patches(&stage, GroundCover::Litter).is_empty());
    assert!(!patches(&stage, GroundCover::Grass).is_empty());
}

#[test]
fn cover_is_the_same_each_time() {
    let scene = scene("simple", &[("points", "50")]);
    let cover = || covered(Stage::of(&scene), &GroundCover::ALL).setting.unwrap().ground.cover;
    assert_eq!(cover(), cover());
}

#[test]
fn surroundings_are_read_as_they_are_written() {
    for text in ["", "sun=52,172,15.5", "cover=grass", "sun=-34.25,355,9 cover=grass,litter"] {
        assert_eq!(Surroundings::parse(text).unwrap().to_string(), text);
    }
    for (text, expected) in [
        ("cover=moss", "'moss' is no ground cover"),
        ("sun=52", "no latitude, day and hour"),
        ("rain=1", "neither sun= nor cover="),
    ] {
        assert!(Surroundings::parse(text).unwrap_err().to_string().contains(expected), "{text}");
    }
}
