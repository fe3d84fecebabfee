use std::f32::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{Vec2, Vec3};
use linden_pipeline::foliage::DressedOrgans;
use linden_pipeline::monitor::Phase;
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Mesh, Part, Scene};
use linden_pipeline::skeleton::{Branching, Wood};
use linden_pipeline::stage::{Level, Place, Plant, Stage};
use linden_pipeline::surface::{Tubes, sweep};
use linden_pipeline::{Monitor, NO_PARENT, Quiet, Skeleton};

use super::{Surface, draw_stage, draw_surface, stage_extent};
use crate::skeleton::sample;
use crate::{Camera, Extent, RasterError, Size, Style, draw_skeleton};

fn material(base_color: [f32; 3]) -> Material {
    Material {
        name: "plain".to_owned(),
        base_color,
        base_color_picture: None,
        normal_picture: None,
        roughness: 1.0,
        double_sided: false,
        cutout: None,
        wrap: linden_pipeline::scene::Wrap::Repeat,
        translucency: None,
        passing_picture: None,
    }
}

fn part(mesh: Mesh, material: usize) -> Part {
    Part::new("part", material, mesh)
}

/// A ball of many triangles, counter-clockwise from outside.
fn ball(middle: Vec3, radius: f32) -> Mesh {
    let (rings, sides) = (60_u32, 120_u32);
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for k in 0..=sides {
            let (sin_a, cos_a) = libm::sincosf(PI * i as f32 / rings as f32);
            let (sin_b, cos_b) = libm::sincosf(2.0 * PI * k as f32 / sides as f32);
            let normal = Vec3::new(sin_a * cos_b, cos_a, -sin_a * sin_b);
            mesh.positions.push(middle + normal * radius);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    for i in 0..rings {
        for k in 0..sides {
            let (a, b) = (i * (sides + 1) + k, (i + 1) * (sides + 1) + k);
            mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    mesh
}

fn size(width: u32, height: u32) -> Size {
    Size::new(width, height).unwrap()
}

fn draw(parts: &[Part], materials: &[Material], skeleton: &Skeleton, camera: &Camera, size: Size) -> Picture {
    let surface = Surface { parts, materials, skeleton };
    draw_surface(&surface, camera, &Style::over_dark(), size, &Quiet).unwrap()
}

fn ink(picture: &Picture) -> f32 {
    picture.rgba().chunks_exact(4).map(|p| f32::from(p[3]) / 255.0).sum()
}

/// A grown tree and its skin.
fn tree(depth: u32) -> (Skeleton, Vec<Part>) {
    let skeleton = sample::tree(7, depth);
    let mesh = sweep(&skeleton, &Tubes::default(), &Quiet).unwrap();
    (skeleton, vec![part(mesh, 0)])
}

#[test]
fn a_balls_silhouette_is_the_circle_of_its_tangents() {
    let (middle, radius) = (Vec3::new(1.0, 2.0, 3.0), 1.5);
    let parts = [part(ball(middle, radius), 0)];
    let none = Skeleton::default();
    for (w, h) in [(100, 120), (300, 280)] {
        for pitch in [0.0, 35.0, -60.0] {
            let camera = Camera::orbit(25.0, pitch);
            let picture = draw(&parts, &[material([0.5; 3])], &none, &camera, size(w, h));
            let view = camera.view(Extent::of(&none, &parts[0].mesh.positions).unwrap(), size(w, h));
            let seen = view.project(middle);
            // The lens' rays that touch a ball at distance d make a cone of sine r/d; the ball is near
            // the picture's middle, where the cone is cut in a circle.
            let sine = radius / seen.depth_m;
            let radius_px = sine / (1.0 - sine * sine).sqrt() * seen.scale * seen.depth_m;
            let expected = PI * radius_px * radius_px;
            let found = ink(&picture);
            assert!((found / expected - 1.0).abs() < 0.01, "{w}x{h} pitch {pitch}: {found}, not {expected}");
            for y in 0..h {
                for x in 0..w {
                    let away = Vec2::new(x as f32 + 0.5, y as f32 + 0.5).distance(seen.at) - radius_px;
                    let alpha = picture.rgba()[((y * w + x) * 4 + 3) as usize];
                    if away < -1.5 {
                        assert_eq!(alpha, 255, "{x} {y} is inside");
                    } else if away > 1.5 {
                        assert_eq!(alpha, 0, "{x} {y} is outside");
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_nearer_hides_what_is_farther() {
    // Through each other: the nearer half of each ball is seen, in any order of the parts.
    let red = part(ball(Vec3::Z * 0.5, 1.0), 0);
    let blue = part(ball(Vec3::NEG_Z * 0.5, 1.0), 1);
    let materials = [material([1.0, 0.0, 0.0]), material([0.0, 0.0, 1.0])];
    let none = Skeleton::default();
    let pixel = |parts: &[Part], yaw: f32, x: u32| {
        let picture = draw(parts, &materials, &none, &Camera::orbit(yaw, 0.0), size(80, 80));
        let at = ((40 * 80 + x) * 4) as usize;
        [picture.rgba()[at], picture.rgba()[at + 2]]
    };
    for parts in [[red.clone(), blue.clone()], [blue, red]] {
        let ([red, blue], [red_behind, blue_behind]) = (pixel(&parts, 0.0, 40), pixel(&parts, 180.0, 40));
        assert!(red > 2 * blue && blue_behind > 2 * red_behind, "{red} {blue} {red_behind} {blue_behind}");
        // From +X, where +Z is on the left.
        let (left, right) = (pixel(&parts, 90.0, 30), pixel(&parts, 90.0, 50));
        assert!(left[0] > 2 * left[1] && right[1] > 2 * right[0], "{left:?} {right:?}");
    }
}

#[test]
fn backs_are_not_drawn_unless_they_are_to_be() {
    let mut inside_out = ball(Vec3::ZERO, 1.0);
    for triangle in &mut inside_out.triangles {
        triangle.swap(1, 2);
    }
    inside_out.triangles.truncate(60 * 120);
    let parts = [part(inside_out, 0)];
    let none = Skeleton::default();
    let seen = |double_sided, pitch| {
        let materials = [Material { double_sided, ..material([0.5; 3]) }];
        ink(&draw(&parts, &materials, &none, &Camera::orbit(0.0, pitch), size(60, 60)))
    };
    // The upper half of a ball, which looks inward.
    assert!(seen(false, 60.0) < 0.5 * seen(true, 60.0));
    assert!(seen(false, -90.0) > 0.95 * seen(true, -90.0));
}

#[test]
fn what_is_cut_out_is_not_drawn_and_hides_nothing() {
    let red = part(ball(Vec3::ZERO, 1.0), 0);
    let mut front = ball(Vec3::ZERO, 1.2);
    front.uvs.fill(glam::Vec2::splat(0.5));
    let none = Skeleton::default();
    let seen = |alpha: u8| {
        let picture = linden_pipeline::picture::Picture::new(1, 1, vec![0, 0, 255, alpha]);
        let blue = Material {
            base_color_picture: Some(std::sync::Arc::new(picture)),
            cutout: Some(0.5),
            ..material([1.0; 3])
        };
        let materials = [material([1.0, 0.0, 0.0]), blue];
        let picture = draw(
            &[red.clone(), part(front.clone(), 1)],
            &materials,
            &none,
            &Camera::orbit(0.0, 0.0),
            size(80, 80),
        );
        let at = ((40 * 80 + 40) * 4) as usize;
        (picture.rgba()[at], picture.rgba()[at + 2])
    };
    let ((red, blue), (red_through, blue_through)) = (seen(200), seen(100));
    assert!(blue > 2 * red && red_through > 2 * blue_through, "{red} {blue} {red_through} {blue_through}");
}

#[test]
fn twigs_thinner_than_a_hair_are_strokes() {
    // A stem that no sample would find reliably.
    let branching = Branching {
        positions: (0..9).map(|i| Vec3::new(0.02 * (i % 2) as f32, i as f32 * 0.25, 0.0)).collect(),
        parents: (0..9_u32).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect(),
        births: vec![0; 9],
        radii: None,
        edges: None,
    };
    let mut before = f32::INFINITY;
    for radius_m in [0.01, 0.004, 0.001, 0.0003] {
        let wood = Wood { tip_radius_m: Some(radius_m), ..Wood::default() };
        let skeleton = Skeleton::build(branching.clone(), &wood).unwrap();
        let parts = [part(sweep(&skeleton, &Tubes::default(), &Quiet).unwrap(), 0)];
        let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
        for yaw in 0..24 {
            let camera = Camera::orbit(yaw as f32 * 3.7, 5.0);
            let shaded = ink(&draw(&parts, &[material([0.5; 3])], &skeleton, &camera, size(48, 54)));
            let strokes = draw_skeleton(&skeleton, &camera, &Style::over_dark(), size(48, 54), &Quiet);
            assert!((shaded / ink(&strokes.unwrap()) - 1.0).abs() < 0.02, "{radius_m} m, yaw {yaw}");
            (least, most) = (least.min(shaded), most.max(shaded));
        }
        assert!(most / least < 1.1, "{radius_m} m: between {least} and {most}");
        assert!(most < before && least > 0.0);
        before = most;
    }
}

#[test]
fn a_tree_covers_what_its_skeleton_covers() {
    let (skeleton, parts) = tree(2);
    for (w, h) in [(64, 72), (128, 144), (500, 600)] {
        let camera = Camera::default();
        let shaded = ink(&draw(&parts, &[material([0.4; 3])], &skeleton, &camera, size(w, h)));
        let strokes = draw_skeleton(&skeleton, &camera, &Style::over_dark(), size(w, h), &Quiet).unwrap();
        let ratio = shaded / ink(&strokes);
        assert!((0.93..1.07).contains(&ratio), "{w}x{h}: {ratio}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (skeleton, parts) = tree(2);
    let materials = [material([0.4; 3])];
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw(&parts, &materials, &skeleton, &Camera::default(), size(150, 180)))
    };
    let one = with(1);
    assert!([2, 3, 8].into_iter().all(|threads| with(threads) == one));
}

/// A ball that is half in the ground, beside a tree: from above half of it is seen.
#[test]
fn what_is_in_the_ground_is_not_seen_from_above() {
    let (skeleton, _) = tree(2);
    let foot = skeleton.positions[0];
    let place = Vec3::new(foot.x + 0.5, foot.y, foot.z);
    let whole = [part(ball(place + Vec3::Y * 2.0, 0.3), 0)];
    let half = [part(ball(place, 0.3), 0)];
    let ink_of = |parts: &[Part], pitch: f32| {
        let camera = Camera::orbit(0.0, pitch);
        let bare = ink(&draw(&[], &[material([0.4; 3])], &skeleton, &camera, size(500, 600)));
        ink(&draw(parts, &[material([0.4; 3])], &skeleton, &camera, size(500, 600))) - bare
    };
    // As good as level: the upper half. From above: the whole of the circle's far half and an ellipse.
    let share = ink_of(&half, 1.0) / ink_of(&whole, 1.0);
    assert!((0.4..0.65).contains(&share), "{share}");
    let share = ink_of(&half, -40.0) / ink_of(&whole, -40.0);
    assert!(share > 0.85, "seen from below it is whole: {share}");
}

#[test]
fn cancelling_stops_soon() {
    /// Cancels at the n-th look, and counts the looks.
    struct After(u32, AtomicU32);
    impl Monitor for After {
        fn is_cancelled(&self) -> bool {
            self.1.fetch_add(1, Ordering::Relaxed) >= self.0
        }
        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
    }
    let (skeleton, parts) = tree(2);
    let materials = [material([0.4; 3])];
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &skeleton };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let mut looks = 0;
    for after in 0.. {
        let monitor = After(after, AtomicU32::new(0));
        let result = pool.install(|| {
            draw_surface(&surface, &Camera::default(), &Style::studio(), size(90, 300), &monitor)
        });
        let looked = monitor.1.into_inner();
        if result.is_ok() {
            looks = looked;
            break;
        }
        assert_eq!(result, Err(linden_pipeline::Cancelled.into()));
        // Whoever was at work elsewhere looks once more.
        assert!(looked <= after + 4, "{looked} looks after {after}");
    }
    assert!(looks > 20, "{looks} looks in all");
}

#[test]
fn meshes_that_contradict_themselves_are_refused() {
    let sound = part(ball(Vec3::ZERO, 1.0), 0);
    let spoilt: [fn(&mut Part); 5] = [
        |part| part.material = 1,
        |part| part.mesh.triangles[7][2] = 1_000_000,
        |part| part.mesh.positions[3].x = f32::NAN,
        |part| part.mesh.normals.truncate(5),
        |part| part.mesh.uvs.clear(),
    ];
    let materials = [material([0.5; 3])];
    let draw = |parts: &[Part]| {
        let surface = Surface { parts, materials: &materials, skeleton: &Skeleton::default() };
        draw_surface(&surface, &Camera::default(), &Style::studio(), size(9, 9), &Quiet)
    };
    for spoil in spoilt {
        let mut parts = [sound.clone(), sound.clone()];
        spoil(&mut parts[1]);
        assert_eq!(draw(&parts), Err(RasterError::Mesh(1)));
    }
    assert_eq!(draw(&[]), Err(RasterError::Empty));
    // Strange normals and places on pictures are nothing to stop for.
    let mut strange = sound;
    strange.mesh.normals[50] = Vec3::NAN;
    strange.mesh.uvs[70] = Vec2::splat(f32::INFINITY);
    assert!(draw(&[strange]).is_ok());
}

#[test]
fn any_camera_and_any_size_are_harmless() {
    let (skeleton, parts) = tree(1);
    let letter = Picture::new(3, 5, (0..60).map(|i| i * 4).collect());
    let bark = Material { base_color_picture: Some(std::sync::Arc::new(letter)), ..material([0.4; 3]) };
    let tiny = Extent { bottom: 0.5, top: 0.6, ..Extent::of(&skeleton, &[]).unwrap() };
    for zoom in [0.01, 1.0, 1000.0] {
        for extent in [None, Some(Extent { radii: [1e-3; crate::extent::RINGS], ..tiny })] {
            for (w, h) in [(1, 1), (70, 3), (5, 200)] {
                let camera = Camera { zoom, extent, pan: Vec2::new(0.3, -0.9), ..Camera::default() };
                let picture = draw(&parts, std::slice::from_ref(&bark), &skeleton, &camera, size(w, h));
                assert_eq!(picture.rgba().len(), (w * h * 4) as usize);
            }
        }
    }
}

/// A tree whose twigs carry leaves, lit.
fn leafy() -> (Skeleton, Vec<Part>, Vec<Material>) {
    let (skeleton, mut parts) = tree(2);
    let mut leaves = Mesh::default();
    for &twig in skeleton.positions.iter().skip(40).step_by(3) {
        let first = leaves.positions.len() as u32;
        let corners = [Vec3::ZERO, Vec3::new(0.12, 0.03, 0.0), Vec3::new(0.12, 0.05, 0.12), Vec3::Z * 0.12];
        leaves.positions.extend(corners.map(|corner| twig + corner));
        leaves.normals.extend([Vec3::Y; 4]);
        leaves.uvs.extend([Vec2::ZERO; 4]);
        leaves.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    parts.push(part(leaves, 1));
    let leaf = Material { double_sided: true, ..material([0.08, 0.2, 0.04]) };
    (skeleton, parts, vec![material([0.16, 0.1, 0.06]), leaf])
}

/// The mean colour of the blocks of a picture that a tree fills, and which they are.
fn blocks(picture: &Picture, tree: &Picture) -> Vec<Option<Vec3>> {
    const SIDE: u32 = 15;
    let (across, down) = (tree.width() / SIDE, tree.height() / SIDE);
    let places = |x: u32, y: u32| (0..SIDE * SIDE).map(move |i| (x * SIDE + i % SIDE, y * SIDE + i / SIDE));
    let of = |x, y| {
        let at = places(x, y).map(|(x, y)| ((y * tree.width() + x) * 4) as usize);
        let inside: Vec<usize> = at.filter(|&at| tree.rgba()[at + 3] > 250).collect();
        let sum: Vec3 =
            inside.iter().map(|&at| Vec3::from([0, 1, 2].map(|c| f32::from(picture.rgba()[at + c])))).sum();
        (inside.len() > 60).then(|| sum / inside.len() as f32)
    };
    (0..down).flat_map(|y| (0..across).map(move |x| of(x, y))).collect()
}

#[test]
fn a_picture_file_and_a_terminal_show_the_same_tree() {
    let (skeleton, parts, materials) = leafy();
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &skeleton };
    let with =
        |style: &Style| draw_surface(&surface, &Camera::default(), style, size(300, 360), &Quiet).unwrap();
    let tree = with(&Style::over_light());
    let colors = |style: &Style| blocks(&with(style), &tree);
    let file = colors(&Style::studio());
    assert!(file.iter().flatten().count() > 20);
    let light = colors(&Style::landscape([250; 3], false));
    for (file, terminal) in file.iter().zip(&light) {
        let (Some(file), Some(terminal)) = (file, terminal) else { continue };
        assert!((*file - *terminal).abs().max_element() < 24.0, "{file} {terminal}");
    }
    // At dusk all is brighter or darker together: what is lit in one is lit in the other.
    let dark = colors(&Style::landscape([16, 16, 18], true));
    let pairs: Vec<(f32, f32)> =
        file.iter().zip(&dark).filter_map(|(a, b)| Some((a.as_ref()?.y, b.as_ref()?.y))).collect();
    let mean = |of: fn(&(f32, f32)) -> f32| pairs.iter().map(of).sum::<f32>() / pairs.len() as f32;
    let (a, b) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let both: f32 = pairs.iter().map(|pair| (pair.0 - a) * (pair.1 - b)).sum();
    let [own_a, own_b] = [
        pairs.iter().map(|pair| (pair.0 - a) * (pair.0 - a)).sum::<f32>(),
        pairs.iter().map(|pair| (pair.1 - b) * (pair.1 - b)).sum::<f32>(),
    ];
    assert!(both / (own_a * own_b).sqrt() > 0.9, "{both} {own_a} {own_b}");
}

#[test]
fn a_lit_picture_is_the_same_on_any_number_of_threads() {
    let (skeleton, parts, materials) = leafy();
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &skeleton };
    let with = |threads, style: &Style| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw_surface(&surface, &Camera::default(), style, size(150, 180), &Quiet).unwrap())
    };
    for style in [Style::studio(), Style::landscape([16, 16, 18], true)] {
        let one = with(1, &style);
        assert!([2, 5].into_iter().all(|threads| with(threads, &style) == one));
    }
}

#[test]
fn a_crown_is_brighter_on_the_suns_side_and_darker_within() {
    let (skeleton, parts, materials) = leafy();
    let surface = Surface { parts: &parts, materials: &materials, skeleton: &skeleton };
    let picture =
        draw_surface(&surface, &Camera::front(), &Style::over_light(), size(300, 360), &Quiet).unwrap();
    let light = |left: bool| {
        let mut sum = (0.0_f32, 0.0_f32);
        for (i, pixel) in picture.rgba().chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] == 255) {
            if (i % 300 < 150) == left {
                sum = (sum.0 + f32::from(pixel[1]), sum.1 + 1.0);
            }
        }
        sum.0 / sum.1
    };
    assert!(light(true) > 1.08 * light(false), "{} {}", light(true), light(false));
}

/// A scene of one ball.
fn scene(radius: f32) -> Scene {
    let (skeleton, name) = (Arc::new(Skeleton::default()), "ball".to_owned());
    let parts = vec![part(ball(Vec3::new(0.0, radius, 0.0), radius), 0)];
    let materials = vec![material([0.2, 0.5, 0.1])];
    Scene {
        name,
        recipe: "{}".to_owned(),
        skeleton,
        organs: DressedOrgans::default(),
        parts,
        materials,
        foot_in_file: None,
    }
}

#[test]
fn a_stage_is_its_plants_where_they_stand() {
    let (near, far) = (scene(1.0), scene(2.0));
    let level = |scene, coverage| Level { scene, coverage };
    let plants = vec![
        Plant::in_levels("small".to_owned(), vec![level(&near, 0.0)]),
        Plant::in_levels("large".to_owned(), vec![level(&far, 0.0)]),
    ];
    let turned = Place { plant: 1, position: Vec3::new(6.0, 0.0, -2.0), turn_rad: 1.0, scale: 0.5 };
    let places = vec![Place::origin(0), turned, Place { position: Vec3::new(-5.0, 0.0, 0.0), ..turned }];
    let stage = Stage { plants, places, ..Stage::of(&near) };
    // Balls are the same from all sides, so that their places and sizes say all.
    let at = |x: f32, z: f32| part(ball(Vec3::new(x, 1.0, z), 1.0), 0);
    let parts = [at(0.0, 0.0), at(6.0, -2.0), at(-5.0, 0.0)];
    let extent = stage_extent(&stage);
    let camera = Camera { extent, ..Camera::default() };
    let of_parts = draw(&parts, &near.materials, &Skeleton::default(), &camera, size(300, 200));
    let of_stage =
        draw_stage(&stage, &Camera::default(), &Style::over_dark(), size(300, 200), &Quiet).unwrap();
    let differing = of_parts.rgba().iter().zip(of_stage.rgba()).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    assert!(ink(&of_parts) > 2000.0);
    assert!(differing * 100 < of_parts.rgba().len(), "{differing} of {}", of_parts.rgba().len());
}

#[test]
fn plants_that_are_small_in_the_picture_are_drawn_coarsely_and_drafts_altogether() {
    let (fine, coarse) = (scene(1.0), Scene { materials: vec![material([0.9, 0.0, 0.0])], ..scene(1.0) });
    let levels = vec![Level { scene: &fine, coverage: 0.5 }, Level { scene: &coarse, coverage: 0.0 }];
    let stage = |places: Vec<Place>| Stage {
        plants: vec![Plant::in_levels("ball".to_owned(), levels.clone())],
        places,
        ..Stage::of(&fine)
    };
    let red = |stage: &Stage<'_>, draft: bool| {
        let style = Style { draft, ..Style::over_dark() };
        let picture = draw_stage(stage, &Camera::default(), &style, size(200, 200), &Quiet).unwrap();
        let is_red = |p: &[u8]| p[3] > 128 && p[0] > p[1];
        picture.rgba().chunks_exact(4).filter(|p| is_red(p)).count()
    };
    let alone = stage(vec![Place::origin(0)]);
    let place = |i: u8| Place { position: Vec3::X * f32::from(i) * 3.0, ..Place::origin(0) };
    let row = stage((0..8).map(place).collect());
    assert_eq!(red(&alone, false), 0, "it fills the picture");
    assert!(red(&alone, true) > 1000 && red(&row, false) > 100);
}
