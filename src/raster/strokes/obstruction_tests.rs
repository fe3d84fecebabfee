//! What stands beside a tree, against rays and in every look.

use glam::{Vec2, Vec3};
use linden_pipeline::grow::{Obstruction, Obstructs};
use linden_pipeline::picture::Picture;
use linden_pipeline::scene::{Material, Mesh, Part, Wrap};
use linden_pipeline::{Monitor, Quiet, Skeleton};

use crate::skeleton::sample::stem;
use crate::{
    Camera, Extent, RasterError, Size, Style, Surface, View, draw_flat, draw_skeleton, draw_surface,
};

/// A box from one corner to the opposite one.
fn block(low: Vec3, high: Vec3) -> Obstruction {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Obstruction::new(Obstructs::Branches, (0..8).map(corner).collect(), triangles)
}

fn size() -> Size {
    Size::new(140, 140).unwrap()
}

/// A thin stem, which leaves most of the picture to what stands beside it.
fn tree(z: f32) -> Skeleton {
    stem(&[(Vec3::new(0.0, 0.0, z), 0.15), (Vec3::new(0.0, 4.0, z), 0.15)])
}

fn camera(yaw_deg: f32, pitch_deg: f32) -> Camera {
    let extent = Extent::of(&tree(0.0), &[Vec3::splat(-2.5), Vec3::new(2.5, 5.0, 2.5)]);
    Camera { extent, ..Camera::orbit(yaw_deg, pitch_deg) }
}

fn pixel(picture: &Picture, at: Vec2) -> [u8; 4] {
    let at = (at.y as usize * picture.width() as usize + at.x as usize) * 4;
    std::array::from_fn(|i| picture.rgba()[at + i])
}

/// Whether a pixel's ray meets a box, and how far from its silhouette that is certain: looked at beside the pixel, too.
fn meets(view: &View, at: Vec2, low: Vec3, high: Vec3) -> Option<bool> {
    let meets = |at: Vec2| {
        let eye = view.place(at, 0.0);
        let ray = view.place(at, 1.0) - eye;
        let (a, b) = ((low - eye) / ray, (high - eye) / ray);
        a.min(b).max_element() <= a.max(b).min_element()
    };
    let around: Vec<bool> = (0..9)
        .map(|i| Vec2::new((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0) * 2.5)
        .map(|off| meets(at + off))
        .collect();
    around.iter().all(|&one| one == around[0]).then_some(around[0])
}

/// A look without light.
type Draw = fn(&Skeleton, &Camera, &Style<'_>, Size, &dyn Monitor) -> Result<Picture, RasterError>;

#[test]
fn a_solid_is_seen_where_rays_meet_it_from_all_sides_and_in_every_look() {
    let (low, high) = (Vec3::new(-1.4, 0.4, -0.7), Vec3::new(1.2, 3.1, 1.0));
    let solids = [block(low, high)];
    let style = Style { obstructions: &solids, ..Style::over_dark() };
    let (bare, tree) = (Style::over_dark(), tree(0.0));
    for (yaw, pitch) in [(0.0, 0.0), (35.0, 20.0), (120.0, -15.0), (200.0, 70.0)] {
        let camera = camera(yaw, pitch);
        let view = camera.view(Extent::of(&tree, &[]).unwrap(), size());
        for draw in [draw_skeleton as Draw, draw_flat as Draw] {
            let [with, without] =
                [&style, &bare].map(|style| draw(&tree, &camera, style, size(), &Quiet).unwrap());
            let (mut inside, mut outside, mut clear) = (0, 0, 0);
            for y in 0..140 {
                for x in 0..140 {
                    let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let [with, without] = [&with, &without].map(|picture| pixel(picture, at));
                    match meets(&view, at, low, high) {
                        // Where the stem is, it may lie before the solid.
                        Some(true) if without[3] == 0 => {
                            assert!(with[3] >= 40, "{yaw} {pitch} {at}: {with:?}");
                            inside += 1;
                            clear += u32::from(with[3] <= 150);
                        }
                        Some(false) => {
                            // Light and haze are those of what is framed.
                            assert_eq!(with[3], without[3], "{yaw} {pitch} {at}");
                            outside += 1;
                        }
                        _ => {}
                    }
                }
            }
            assert!(inside > 500 && outside > 1000, "{inside} {outside}");
            assert!(
                clear > inside * 17 / 20,
                "it can be seen through but for its edges: {clear} of {inside}"
            );
        }
    }
}

/// How much a wall changes what is seen of a stem, or of a surface, at its middle.
fn changed(z: f32, draw: impl Fn(&Style<'_>) -> Picture) -> i32 {
    let walls = [block(Vec3::new(-1.5, 0.5, -0.1), Vec3::new(1.5, 3.5, 0.1))];
    let with = Style { obstructions: &walls, ..Style::over_dark() };
    let view = camera(0.0, 0.0).view(Extent::of(&tree(0.0), &[]).unwrap(), size());
    let at = view.project(Vec3::new(0.0, 2.0, z)).at;
    let [with, without] = [with, Style::over_dark()].map(|style| pixel(&draw(&style), at));
    (0..3).map(|i| (i32::from(with[i]) - i32::from(without[i])).abs()).sum()
}

#[test]
fn wood_before_a_wall_is_as_ever_and_wood_behind_it_is_seen_through_it() {
    let wood = |z: f32| {
        changed(z, |style| draw_skeleton(&tree(z), &camera(0.0, 0.0), style, size(), &Quiet).unwrap())
    };
    let leaf = |z: f32| {
        let corners = [(-0.4, 1.0), (0.4, 1.0), (0.4, 3.0), (-0.4, 3.0)];
        let mesh = Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let parts = [Part::new("leaf", 0, mesh)];
        let materials = [Material {
            name: "red".to_owned(),
            base_color: [0.8, 0.1, 0.1],
            base_color_picture: None,
            normal_picture: None,
            roughness: 1.0,
            double_sided: true,
            cutout: None,
            wrap: Wrap::Repeat,
            translucency: None,
            passing_picture: None,
        }];
        let surface = Surface { parts: &parts, materials: &materials, skeleton: &Skeleton::default() };
        changed(z, |style| draw_surface(&surface, &camera(0.0, 0.0), style, size(), &Quiet).unwrap())
    };
    for (before, behind) in [(wood(1.0), wood(-1.0)), (leaf(1.0), leaf(-1.0))] {
        // Air and shade are those of what is framed, which the wall does not change here.
        assert!(before <= 6, "{before}");
        assert!(behind >= 40, "{behind}");
    }
}

#[test]
fn a_house_behind_a_shrub_is_framed_no_farther_than_half_of_the_shrub() {
    let shrub = Extent::of(&tree(0.0), &[Vec3::new(1.0, 0.0, 1.0), Vec3::new(-1.0, 4.0, -1.0)]).unwrap();
    let near = block(Vec3::new(1.0, 0.0, 0.0), Vec3::new(2.0, 3.0, 1.0));
    assert!(shrub.in_reach(std::slice::from_ref(&near)).eq(near.positions.iter().copied()));
    let house = block(Vec3::new(-90.0, 0.0, -60.0), Vec3::new(80.0, 70.0, -5.0));
    let margin = shrub.height().max(2.0 * shrub.radius()) / 2.0 + shrub.radius() + 1e-4;
    for place in shrub.in_reach(std::slice::from_ref(&house)) {
        assert!(place.x.abs() <= margin && place.z.abs() <= margin, "{place}");
        assert!(place.y <= shrub.top + shrub.height(), "{place}");
    }
    let house = [house];
    let style = Style { obstructions: &house, ..Style::studio() };
    let framed = style.extent(&tree(0.0)).unwrap();
    assert!(framed.radius() < 4.0 * shrub.radius() && framed.top > shrub.top);
}
