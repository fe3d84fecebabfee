//! Leaves whose under side is drawn.

use glam::Vec2;

use super::*;
use crate::testing::Subject;
use linden_base::monitor::Quiet;
use linden_base::picture::Picture;

/// Few leaves on a twig, so that each has pixels enough.
const SMALL: [(&str, &str); 6] = [
    ("points", "200"),
    ("leaf_size", "128"),
    ("bark_size", "32"),
    ("leaf_colors", "#20a020"),
    ("twig_shoots", "0"),
    ("twig_length", "0.36"),
];

/// What a picture shows at a place.
fn color_at(picture: &Picture, uv: Vec2) -> [u8; 4] {
    let size = Vec2::new(picture.width() as f32, picture.height() as f32);
    let pixel = (Vec2::new(uv.x, 1.0 - uv.y) * size).min(size - 1.0);
    picture.rgba().as_chunks::<4>().0[pixel.y as usize * picture.width() as usize + pixel.x as usize]
}

#[test]
fn each_face_of_a_leaf_is_seen_from_its_own_side_in_its_own_colour() {
    for form in ["curved", "card", "twig", "cross", "tuft"] {
        let with = |more: &[(&str, &str)]| {
            let subject = Subject::builtin("drawn-oak", &[&SMALL[..], &[("leaf_form", form)], more].concat());
            let grown = subject.grow();
            let scene = subject.dress(&grown);
            (grown, scene)
        };
        let (plain, plain_scene) = with(&[]);
        let (grown, scene) = with(&[("back_colors", "#e0d8ff")]);
        let part = scene.parts.iter().find(|part| part.name == "leaves").unwrap();
        let material = &scene.materials[part.material];
        assert!(!material.double_sided && material.is_sheet() && material.translucency.is_none());
        // The same leaves in the same places, of twice as many triangles and the same area.
        assert_eq!(grown.organs.placed.positions, plain.organs.placed.positions);
        let before = plain_scene.parts.iter().find(|part| part.name == "leaves").unwrap();
        let plain_material = &plain_scene.materials[before.material];
        assert!(plain_material.double_sided && plain_material.translucency.is_some());
        assert_eq!(part.mesh.triangles.len(), 2 * before.mesh.triangles.len());
        let ratio = grown.organs.area_m2() / plain.organs.area_m2();
        assert!((ratio - 1.0).abs() < 0.06, "{form}: {ratio}");
        let opaque = |scene: &crate::scene::Scene| {
            let mut area_m2 = 0.0;
            scene.organs.measured().each(0..scene.organs.len(), |_, organ| area_m2 += organ.area_m2);
            area_m2
        };
        let ratio = opaque(&scene) / opaque(&plain_scene);
        assert!((ratio - 1.0).abs() < 0.06, "{form}: {ratio}");

        let picture = material.base_color_picture.as_ref().unwrap();
        for shape in scene.organs.shapes() {
            let mesh = &shape.mesh;
            let (upper, under) = mesh.triangles.split_at(mesh.triangles.len() / 2);
            let mut seen = 0;
            for (upper, under) in upper.iter().zip(under) {
                let normal = |corners: &[u32; 3]| {
                    let [a, b, c] = corners.map(|v| mesh.positions[v as usize]);
                    (b - a).cross(c - a).normalize()
                };
                assert!(normal(upper).dot(normal(under)) < -0.99, "{form}");
                let middle = |corners: &[u32; 3]| {
                    corners.map(|v| mesh.positions[v as usize]).iter().sum::<glam::Vec3>() / 3.0
                };
                let gap = (middle(upper) - middle(under)).dot(normal(upper));
                assert!((5e-4..2e-3).contains(&gap), "{form}: {gap}");
                let at = |corners: &[u32; 3]| {
                    let uv = corners.map(|v| mesh.uvs[v as usize]).iter().sum::<Vec2>() / 3.0;
                    color_at(picture, uv)
                };
                let ([r, g, b, shown], [r2, g2, b2, shown2]) = (at(upper), at(under));
                if shown > 200 && shown2 > 200 {
                    seen += 1;
                    assert!(g > r && g > b && b2 >= g2 && r2 > r && b2 > b, "{form}");
                }
            }
            assert!(seen > 0 || form == "twig", "{form}: nothing is drawn in the middle of any triangle");
        }
    }
}

#[test]
fn both_faces_have_one_outline() {
    let subject = Subject::builtin("drawn-oak", &[&SMALL[..], &[("back_colors", "#e0d8ff")]].concat());
    assert!(subject.recipe.preset.idle("leaf_translucency").is_some());
    let first = &subject.dressing.foliage.first;
    let cover = subject.with(|specimen| cover(specimen, 0, first, 256, &Quiet)).unwrap();
    assert_eq!(cover.backs.len(), cover.cells.len());
    let picture = &cover.base_color;
    for (cell, back) in cover.cells.iter().zip(&cover.backs) {
        let moved = back.attach - cell.attach;
        assert!(
            (back.min - cell.min - moved).length() < 1e-5 && (back.max - cell.max - moved).length() < 1e-5
        );
        let (mut differ, mut drawn) = (0, 0);
        for step in 0..64 * 64 {
            let share = Vec2::new((step % 64) as f32, (step / 64) as f32) / 64.0;
            let uv = cell.min + (cell.max - cell.min) * share;
            let [a, b] = [uv, uv + moved].map(|uv| color_at(picture, uv)[3] > 127);
            drawn += u32::from(a);
            differ += u32::from(a != b);
        }
        // Cells lie at parts of pixels.
        assert!(drawn > 400 && differ * 12 < drawn, "{differ} of {drawn}");
    }
}
