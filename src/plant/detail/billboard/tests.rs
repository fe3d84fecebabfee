use std::collections::BTreeMap;
use std::sync::Mutex;

use glam::{Vec2, Vec3};

use super::*;
use crate::testing::plain;
use linden_base::monitor::Quiet;
use linden_base::picture::{Picture, PictureStore};
use linden_skeleton::Skeleton;

fn scene(materials: Vec<Material>, meshes: Vec<Mesh>) -> Scene {
    let part = |(material, mesh)| Part::new(format!("part{material}"), material, mesh);
    Scene {
        name: "test".to_owned(),
        recipe: "{}".to_owned(),
        materials,
        parts: meshes.into_iter().enumerate().map(part).collect(),
        skeleton: Arc::new(Skeleton { positions: vec![Vec3::ZERO], ..Skeleton::default() }),
        organs: DressedOrgans::default(),
        foot_in_file: None,
    }
}

/// A rectangle in a plane, counter-clockwise from its normal's side.
fn rectangle(corner: Vec3, x: Vec3, y: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + x, corner + x + y, corner + y],
        normals: vec![x.cross(y).normalize(); 4],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

fn pixels(scene: &Scene) -> (u32, u32, Vec<[u8; 4]>, Vec<[u8; 4]>) {
    let material = &scene.materials[0];
    let [color, normal] =
        [&material.base_color_picture, &material.normal_picture].map(|picture| picture.clone().unwrap());
    let all = |picture: &Picture| picture.rgba().as_chunks::<4>().0.to_vec();
    (color.width(), color.height(), all(&color), all(&normal))
}

#[test]
fn a_pixel_shows_what_the_plane_stands_for() {
    // A red square in front of a green one twice as large; from the side both are lines.
    let front = rectangle(Vec3::new(-0.5, 0.5, 0.2), Vec3::X, Vec3::Y);
    let back = rectangle(Vec3::new(-1.0, 0.0, -0.2), Vec3::X * 2.0, Vec3::Y * 2.0);
    let materials = vec![plain([1.0, 0.0, 0.0], false), plain([0.0, 1.0, 0.0], false)];
    let seen =
        billboard(&scene(materials, vec![front, back]), &Billboard { planes: 1, size_px: 208 }, &Quiet);
    let seen = seen.unwrap();
    let (width, height, color, normal) = pixels(&seen);
    assert_eq!((width, height), (208, 208));
    let at = |x: usize, y: usize| color[y * 208 + x];
    // Two metres over 200 pixels, behind a margin of four.
    for (x, y, expected) in [
        (104, 104, [255, 0, 0, 255]),
        (56, 104, [255, 0, 0, 255]),
        (52, 104, [0, 255, 0, 255]),
        (5, 5, [0, 255, 0, 255]),
        (202, 202, [0, 255, 0, 255]),
    ] {
        // A quarter of the back is hidden: some light is lost between the two.
        let lit = at(x, y).into_iter().zip(expected);
        assert!(lit.clone().all(|(is, full)| is <= full && is >= full - full / 9), "{x} {y}: {lit:?}");
    }
    let cut = color.iter().filter(|pixel| pixel[3] < 128).count();
    assert_eq!(cut, 208 * 208 - 200 * 200);
    // Nothing foreign beyond the edge.
    assert!(color.iter().all(|pixel| pixel[2] == 0 && pixel[0].max(pixel[1]) >= 225));
    assert!(normal.iter().all(|&pixel| pixel == [128, 128, 255, 255]));
    // The rectangle is where the squares' outline is, and its coordinates are the margin's inside.
    let mesh = &seen.parts[0].mesh;
    assert!(mesh.positions[0].distance(Vec3::new(-1.0, 0.0, 0.0)) < 2e-4);
    assert!(mesh.positions[2].distance(Vec3::new(1.0, 2.0, 0.0)) < 2e-4);
    assert!((mesh.uvs[0] - Vec2::splat(4.0 / 208.0)).length() < 1e-6);
    assert!((mesh.uvs[2] - Vec2::splat(204.0 / 208.0)).length() < 1e-6);
}

#[test]
fn a_deep_crown_is_darker_than_a_single_layer() {
    let seen = |layers: u16| {
        let layer =
            |i: u16| rectangle(Vec3::new(-1.0, 0.0, 0.1 * f32::from(i)), Vec3::X * 2.0, Vec3::Y * 2.0);
        let all = scene(vec![plain([0.5; 3], false); layers.into()], (0..layers).map(layer).collect());
        let seen = billboard(&all, &Billboard { planes: 1, size_px: 64 }, &Quiet).unwrap();
        let (width, _, color, _) = pixels(&seen);
        color[(32 * width + 32) as usize][0]
    };
    // Half of the light, as an sRGB byte; the diagonal that two triangles share counts as a second layer.
    assert!(seen(1).abs_diff(188) <= 1, "{}", seen(1));
    // Of what falls on twelve layers 1 / (1 + √½) is left where it is seen, and all of the loss is drawn: 0.293.
    assert!(seen(12).abs_diff(147) <= 2, "{}", seen(12));
}

#[test]
fn backs_are_seen_only_where_they_are_to_be() {
    // Looks away from the viewer.
    let turned = rectangle(Vec3::new(1.0, 0.0, 0.0), Vec3::X * -2.0, Vec3::Y * 2.0);
    for double_sided in [false, true] {
        let rectangle_scene = scene(vec![plain([0.5; 3], double_sided)], vec![turned.clone()]);
        let seen = billboard(&rectangle_scene, &Billboard { planes: 1, size_px: 64 }, &Quiet).unwrap();
        let (_, _, color, normal) = pixels(&seen);
        assert_eq!(color.iter().any(|pixel| pixel[3] > 127), double_sided);
        assert!(normal.iter().all(|pixel| pixel[2] == 255), "towards the viewer");
    }
}

/// Each plane sees a ball as a disc, wherever it stands round it, and its picture of normals has nine tenths of the ball's tilt.
#[test]
fn a_ball_is_a_disc_from_everywhere() {
    let (rings, sides) = (48_u32, 96_u32);
    let mut ball = Mesh::default();
    for i in 0..=rings {
        for k in 0..=sides {
            let (sin_a, cos_a) = libm::sincosf(PI * i as f32 / rings as f32);
            let (sin_b, cos_b) = libm::sincosf(2.0 * PI * k as f32 / sides as f32);
            let normal = Vec3::new(sin_a * cos_b, cos_a, -sin_a * sin_b);
            ball.positions.push(normal + Vec3::Y);
            ball.normals.push(normal);
            ball.uvs.push(Vec2::ZERO);
        }
    }
    for i in 0..rings {
        for k in 0..sides {
            let (a, b) = (i * (sides + 1) + k, (i + 1) * (sides + 1) + k);
            ball.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    let ball_scene = scene(vec![plain([0.5; 3], false)], vec![ball]);
    let seen = billboard(&ball_scene, &Billboard { planes: 3, size_px: 128 }, &Quiet).unwrap();
    assert_eq!(seen.parts[0].mesh.triangles.len(), 12);
    let (width, height, color, normal) = pixels(&seen);
    let covered = color.iter().filter(|pixel| pixel[3] > 127).count() as f32;
    assert_eq!((width, height), (256, 128), "powers of two, as engines want them");
    // Three discs; a pixel is as large as two metres divided by what is between the corners.
    let corners: Vec<Vec2> =
        seen.parts[0].mesh.uvs.iter().map(|uv| *uv * Vec2::new(width as f32, height as f32)).collect();
    let radius_px = (corners[2].y - corners[0].y) / 2.0;
    assert!((covered / (3.0 * PI * radius_px * radius_px) - 1.0).abs() < 0.02, "{covered}");
    for plane in corners.chunks(8) {
        // A quarter of the diameter right of the middle the sphere's normal is (½, 0, √¾); of nine tenths of the tilt (0.46, 0, 0.89).
        assert_eq!(plane[..4], plane[4..], "the same picture on both faces");
        let middle = (plane[0] + plane[2]) / 2.0;
        let (x, y) = ((middle.x + radius_px / 2.0) as u32, (height as f32 - middle.y) as u32);
        let [r, g, b, _] = normal[(y * width + x) as usize].map(|code| f32::from(code) / 127.5 - 1.0);
        assert!((r - 0.46).abs() < 0.06 && g.abs() < 0.06 && (b - 0.89).abs() < 0.06, "{r} {g} {b}");
    }
    // The planes stand at equal angles.
    let mesh = &seen.parts[0].mesh;
    let faces: Vec<Vec3> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            (b - a).cross(c - a).normalize()
        })
        .collect();
    for pair in faces.chunks(4).collect::<Vec<_>>().windows(2) {
        assert!((pair[0][0].dot(pair[1][0]) - 0.5).abs() < 1e-5);
        assert!((pair[0][0] + pair[0][2]).length() < 1e-5, "the other face looks the other way");
    }
}

/// Wherever planes cross and from whichever side they are seen, what stands at one place is lit nearly alike.
#[test]
fn light_tells_neither_planes_nor_sides_apart() {
    let materials = vec![plain([0.5; 3], true)];
    let crown = rectangle(Vec3::new(-1.0, 0.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let crossed = rectangle(Vec3::new(0.0, 0.0, 1.0), Vec3::Z * -2.0, Vec3::Y * 2.0);
    let mut both = crown;
    let first = both.positions.len() as u32;
    both.positions.extend(&crossed.positions);
    both.normals.extend(&crossed.normals);
    both.uvs.extend(&crossed.uvs);
    both.triangles.extend(crossed.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    let seen =
        billboard(&scene(materials, vec![both]), &Billboard { planes: 2, size_px: 64 }, &Quiet).unwrap();
    let mesh = &seen.parts[0].mesh;
    assert!(!seen.materials[0].double_sided);
    // As a renderer interpolates them, in the middle of each face.
    let lit: Vec<Vec3> =
        (mesh.normals.chunks(4)).map(|corners| corners.iter().sum::<Vec3>().normalize()).collect();
    assert_eq!(lit.len(), 4);
    for (a, b) in lit.iter().zip(lit.iter().skip(1)) {
        assert!(a.dot(*b) > 0.8, "{a} {b}");
    }
    // At the edges they look away from the axis, on both sides alike.
    for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(normal.dot(at.with_y(0.0).normalize()) > 0.4 && normal.y > 0.4, "{at} {normal}");
    }
    for plane in mesh.normals.chunks(8) {
        for (front, back) in plane[..4].iter().zip(&plane[4..]) {
            assert!(front.dot(*back) > 0.8);
        }
    }
}

#[test]
fn what_a_picture_cuts_out_is_cut_out_there_too() {
    // The left half of the picture is nothing.
    let rgba =
        (0..16 * 16).flat_map(|i| if i % 16 < 8 { [255, 0, 0, 0] } else { [0, 0, 255, 255] }).collect();
    let leafy = Material {
        base_color_picture: Some(Arc::new(Picture::new(16, 16, rgba))),
        cutout: Some(0.5),
        ..plain([1.0; 3], true)
    };
    let card = rectangle(Vec3::new(-1.0, 0.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let seen =
        billboard(&scene(vec![leafy], vec![card]), &Billboard { planes: 1, size_px: 108 }, &Quiet).unwrap();
    let (width, height, color, _) = pixels(&seen);
    for y in 4..height - 4 {
        for x in 4..width - 4 {
            let pixel = color[(y * width + x) as usize];
            assert!(pixel[0] < 16 && pixel[2] > 240, "no colour of what is cut out: {pixel:?}");
            if x.abs_diff(width / 2) > 4 {
                assert_eq!(pixel[3] > 127, x > width / 2, "{x} {y}");
            }
        }
    }
}

/// Entries, and how often one was put.
#[derive(Debug, Default)]
struct Memory(Mutex<(BTreeMap<PictureKey, Vec<u8>>, usize)>);

impl PictureStore for Memory {
    fn get(&self, key: PictureKey) -> Option<Vec<u8>> {
        self.0.lock().unwrap().0.get(&key).cloned()
    }

    fn put(&self, key: PictureKey, parts: &[&[u8]]) {
        let mut kept = self.0.lock().unwrap();
        kept.0.insert(key, parts.concat());
        kept.1 += 1;
    }
}

#[test]
fn what_was_drawn_is_taken_from_a_store_until_something_seen_on_it_differs() {
    let store = Arc::new(Memory::default());
    let puts = || store.0.lock().unwrap().1;
    let drawn = DrawnPictures::default().kept_in(store.clone());
    let square = rectangle(Vec3::new(-1.0, 0.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let how = Billboard { planes: 1, size_px: 64 };
    let of = |material: &Material, mesh: &Mesh| scene(vec![material.clone()], vec![mesh.clone()]);
    let pictures = |scene: &Scene| scene.materials[0].pictures().cloned().collect::<Vec<_>>();
    let gray = plain([0.5; 3], true);
    let plain_scene = of(&gray, &square);
    let expected = billboard(&plain_scene, &how, &Quiet).unwrap();
    for _ in 0..2 {
        let seen = kept_billboard(&plain_scene, how, &drawn, &Quiet).unwrap();
        assert_eq!((pictures(&seen), puts()), (pictures(&expected), 3));
        assert_eq!(seen.parts[0].mesh, expected.parts[0].mesh);
        assert_eq!(seen.materials[0].base_color, expected.materials[0].base_color);
    }
    let moved = |change: fn(&mut Mesh)| {
        let mut mesh = square.clone();
        change(&mut mesh);
        of(&gray, &mesh)
    };
    let worn = |change: fn(&mut Material)| {
        let mut material = gray.clone();
        change(&mut material);
        of(&material, &square)
    };
    let picture = |byte| Some(Arc::new(Picture::new(1, 1, vec![byte, 0, 0, 255])));
    let mut pictured = gray.clone();
    pictured.base_color_picture = picture(7);
    let mut other = gray.clone();
    other.base_color_picture = picture(8);
    let others = [
        (moved(|mesh| mesh.positions[0].z = 0.01), how),
        (moved(|mesh| mesh.normals[0] = Vec3::Y), how),
        (moved(|mesh| mesh.uvs[0].x += 0.01), how),
        (moved(|mesh| mesh.triangles.truncate(1)), how),
        (worn(|material| material.base_color[1] = 0.6), how),
        (worn(|material| material.double_sided = false), how),
        (worn(|material| material.cutout = Some(0.5)), how),
        (of(&pictured, &square), how),
        (of(&other, &square), how),
        (of(&gray, &square), Billboard { planes: 2, ..how }),
        (of(&gray, &square), Billboard { size_px: 80, ..how }),
    ];
    for (index, (scene, how)) in others.iter().enumerate() {
        kept_billboard(scene, *how, &drawn, &Quiet).unwrap();
        assert_eq!(puts(), 3 * (index + 2), "{index}");
    }
}
