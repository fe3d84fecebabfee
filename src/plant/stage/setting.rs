//! What stands around plants for a picture of them: camera, sun, sky, ground.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::{GroundPatch, Surroundings};
use crate::scene::{Material, Wrap};
use crate::texture::{GROUND_TILE_M, ground};
use linden_base::color::{encode, luminance};
use linden_base::mesh::{Bounds, Mesh};
use linden_base::picture::Picture;
use linden_base::random::Key;

/// Everything around the plants.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Who looks.
    pub camera: Camera,
    /// The sun.
    pub sun: Sun,
    /// The rest of the light.
    pub sky: Sky,
    /// The ground that they stand on.
    pub ground: Ground,
    /// What it was asked for with: files carry it.
    pub surroundings: Surroundings,
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it is, metres.
    pub position: Vec3,
    /// The place in the middle of its picture, metres.
    pub target: Vec3,
    /// The angle that the picture's height covers, radians.
    pub fov_y_rad: f32,
    /// Width of the picture by its height.
    pub aspect: f32,
    /// Nothing nearer is seen, metres.
    pub near_m: f32,
    /// Nothing farther is seen, metres.
    pub far_m: f32,
}

/// Light from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it is, a unit vector.
    pub toward: Vec3,
    /// Of a surface that faces it, lux.
    pub illuminance_lux: f32,
    /// The angle that its disc covers, radians.
    pub diameter_rad: f32,
    /// Linear RGB, the largest 1.
    pub color: [f32; 3],
}

/// Light from all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// Colours by direction, sRGB: longitude across, latitude up, the zenith along the upper edge.
    pub picture: Arc<Picture>,
    /// Illuminance of a surface that faces up, lux.
    pub illuminance_lux: f32,
    /// Mean of the upper half as a surface that faces up sees it, by luminance, where white is 1.
    pub mean: f32,
    /// The colour of that mean, linear RGB, the largest 1.
    pub color: [f32; 3],
    /// What shows it where a format has no sky: a dome over the ground that is seen from inside, and
    /// neither lit nor in the way of light.
    pub dome: Mesh,
    /// The look of the dome.
    pub material: Material,
}

/// A disc to stand on, and what covers it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// The geometry, facing up.
    pub mesh: Mesh,
    /// Its look.
    pub material: Material,
    /// What grows and lies on it, on request.
    pub cover: Vec<GroundPatch>,
}

/// Eyes of somebody who stands, metres.
const EYE_M: f32 = 1.65;
/// As a lens of 40 mm before 36 mm of film.
const FOV_RAD: f32 = 0.85;
/// The part of the picture, either way, that plants take.
const FILLED: f32 = 0.86;
/// The ground reaches as many of the plants' sizes: seen from the height of a wood's camera, its edge lies half a
/// degree below the horizon.
const GROUND_SIZES: f32 = 24.0;
/// Down to which latitude the sky keeps the colour of the horizon, radians: beyond the edge of the ground it is what
/// haze makes of the ground there.
const HAZE_RAD: f32 = 0.14;
/// Hazy sunshine. The sun of a clear noon is ten times that; programs whose exposure is made for lamps
/// (Blender divides lux by 683) show that one as plain white.
const SUN_LUX: f32 = 10_000.0;
/// What a hazy sky adds on level ground (CIE clear skies have a sixth to a third of the sun's).
const SKY_LUX: f32 = 3000.0;
/// The sun's diameter as seen from the earth, softened by haze.
const SUN_DIAMETER_RAD: f32 = 0.016;

impl Setting {
    /// A picture of some points (a box's corners, a crown's outermost twigs): seen from eye height and a
    /// little from the right, with the sun behind the viewer's left shoulder. What is much wider than high
    /// is looked down at. `None` without points.
    pub fn around(points: &[Vec3]) -> Option<Self> {
        let bounds = Bounds::of(points.iter().copied())?;
        let radius_m = GROUND_SIZES * bounds.size().max_element().max(0.1);
        let middle = Vec3 { y: 0.0, ..0.5 * (bounds.min + bounds.max) };
        Some(Self {
            camera: Camera::framing(points, bounds),
            sun: Sun::afternoon(),
            sky: Sky::hazy(middle, radius_m),
            ground: Ground::disc(middle, radius_m),
            surroundings: Surroundings::default(),
        })
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let Self { sky, ground, .. } = self;
        let pictures = ground.material.base_color_picture.iter().chain([&sky.picture]);
        ground.mesh.bytes()
            + ground.cover.iter().map(GroundPatch::bytes).sum::<u64>()
            + sky.dome.bytes()
            + pictures.map(|picture| picture.rgba().len() as u64).sum::<u64>()
    }
}

impl Camera {
    /// A camera from which points fill a square picture; a wider picture shows more at its sides.
    fn framing(points: &[Vec3], bounds: Bounds) -> Self {
        let size = bounds.size().max(Vec3::splat(1e-3));
        let middle = 0.5 * (bounds.min + bounds.max);
        let height = bounds.max.y.max(1e-3);
        let width = libm::hypotf(size.x, size.z);
        // Three-quarter view: neither along an axis nor along a diagonal.
        let (sin, cos) = libm::sincosf(0.55);
        // A wood is seen from above its nearest crowns, a tree from where somebody stands.
        let is_wide = width > 3.0 * height;
        let eye = if is_wide { height + 0.16 * width } else { EYE_M.min(0.55 * height) };
        let camera = |target: Vec3, distance: f32| Self {
            position: Vec3::new(target.x + sin * distance, eye, target.z + cos * distance),
            target,
            fov_y_rad: FOV_RAD,
            aspect: 1.0,
            near_m: 0.0,
            far_m: 0.0,
        };
        let mut target = middle;
        let mut distance = 0.0;
        // What is near looks larger, so the middle of the box is not the middle of the picture.
        for _ in 0..4 {
            // From twice as far as needed for a ball around it, halve the doubt.
            let (mut near, mut far) = (0.0, size.length() / libm::sinf(0.5 * FOV_RAD));
            for _ in 0..24 {
                let between = 0.5 * (near + far);
                let reach = camera(target, between).reach(points);
                if reach.iter().flatten().all(|x| x.abs() <= FILLED) { far = between } else { near = between }
            }
            distance = far;
            let found = camera(target, distance);
            let [across, up] = found.reach(points).map(|[low, high]| 0.5 * (low + high));
            let half = libm::tanf(0.5 * FOV_RAD) * found.position.distance(target);
            let turn = found.rotation();
            target += turn * Vec3::X * (across * half) + Vec3::Y * (up * half);
        }
        let reach = distance + size.length();
        Self { near_m: 1e-3 * reach, far_m: 100.0 * reach, ..camera(target, distance) }
    }

    /// From the camera's axes (it looks along -Z, Y is up) to the world's.
    pub fn rotation(&self) -> Quat {
        let back = (self.position - self.target).normalize_or(Vec3::Z);
        let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
        Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back))
    }

    /// Where points lie in the picture, smallest and largest, across and up: -1 to 1 is inside. Infinite
    /// where one is behind the camera.
    fn reach(&self, points: &[Vec3]) -> [[f32; 2]; 2] {
        let turn = self.rotation();
        let (right, up, back) = (turn * Vec3::X, turn * Vec3::Y, turn * Vec3::Z);
        let half = libm::tanf(0.5 * self.fov_y_rad);
        let mut reach = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        for &point in points {
            let seen = point - self.position;
            let depth = -seen.dot(back);
            if depth <= 0.0 {
                return [[f32::NEG_INFINITY, f32::INFINITY]; 2];
            }
            let place = [seen.dot(right) / (half * self.aspect * depth), seen.dot(up) / (half * depth)];
            for ([low, high], x) in reach.iter_mut().zip(place) {
                (*low, *high) = (low.min(x), high.max(x));
            }
        }
        reach
    }
}

impl Sun {
    /// Behind the left shoulder of somebody who looks as [`Camera::framing`] does.
    pub(super) fn afternoon() -> Self {
        let toward = Vec3::new(-0.3, 0.85, 0.95).normalize();
        Self { toward, illuminance_lux: SUN_LUX, diameter_rad: SUN_DIAMETER_RAD, color: [1.0, 0.96, 0.88] }
    }

    /// From the axes of a light (it shines along -Z) to the world's.
    pub fn rotation(&self) -> Quat {
        Quat::from_rotation_arc(Vec3::Z, self.toward)
    }
}

impl Sky {
    /// A dome that is blue above, pale along the horizon and the ground's colour below.
    fn hazy(middle: Vec3, radius_m: f32) -> Self {
        const WIDTH: u32 = 64;
        const HEIGHT: u32 = 128;
        let color = |latitude: f32| -> [f32; 3] {
            const ZENITH: [f32; 3] = [0.22, 0.42, 0.86];
            const HORIZON: [f32; 3] = [0.8, 0.88, 0.97];
            const BELOW: [f32; 3] = [0.2, 0.2, 0.15];
            let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
            if latitude < 0.0 {
                return mix(HORIZON, BELOW, ((-latitude - HAZE_RAD) * 6.0).clamp(0.0, 1.0));
            }
            mix(HORIZON, ZENITH, libm::powf(libm::sinf(latitude), 0.6))
        };
        let row = |y: u32| color(PI * (0.5 - (y as f32 + 0.5) / HEIGHT as f32));
        let pixel = |c: [f32; 3]| {
            let [r, g, b] = c.map(|x| libm::roundf(255.0 * encode(x)) as u8);
            [r, g, b, 255]
        };
        let rgba = (0..HEIGHT).flat_map(|y| [pixel(row(y)); WIDTH as usize]).flatten().collect();
        // Weighted as a surface that faces up sees it.
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for y in 0..HEIGHT / 2 {
            let latitude = PI * (0.5 - (y as f32 + 0.5) / HEIGHT as f32);
            let weight = libm::sinf(latitude) * libm::cosf(latitude);
            sum = [0, 1, 2].map(|i| sum[i] + row(y)[i] * weight);
            weights += weight;
        }
        let most = sum.into_iter().fold(f32::MIN_POSITIVE, f32::max);
        let picture = Arc::new(Picture::new(WIDTH, HEIGHT, rgba));
        let material = Material {
            name: "sky".to_owned(),
            base_color: sum.map(|x| x / most),
            base_color_picture: Some(Arc::clone(&picture)),
            normal_picture: None,
            roughness: 1.0,
            double_sided: false,
            cutout: None,
            wrap: Wrap::Clamp,
            translucency: None,
            passing_picture: None,
        };
        Self {
            picture,
            illuminance_lux: SKY_LUX,
            mean: luminance(sum) / weights,
            color: sum.map(|x| x / most),
            dome: dome(middle, radius_m),
            material,
        }
    }
}

/// The sky as a mesh, for formats that know no other: a dome over the ground, seen from inside.
fn dome(middle: Vec3, radius_m: f32) -> Mesh {
    const ACROSS: u32 = 64;
    const UP: u32 = 16;
    let mut mesh = Mesh::default();
    for up in 0..=UP {
        // From a little below the horizon.
        // Nor quite to the zenith, where triangles would have no area; the hole is too small for a pixel.
        let latitude = -0.02 + (0.5 * PI + 0.019) * up as f32 / UP as f32;
        let (sin, cos) = libm::sincosf(latitude);
        for across in 0..=ACROSS {
            let (x, z) = libm::sincosf(TAU * (across % ACROSS) as f32 / ACROSS as f32);
            let out = Vec3::new(cos * x, sin, cos * z);
            mesh.positions.push(middle + out * radius_m);
            mesh.normals.push(-out);
            mesh.uvs.push(Vec2::new(across as f32 / ACROSS as f32, 0.5 + latitude / PI));
        }
    }
    for up in 0..UP {
        for across in 0..ACROSS {
            let a = up * (ACROSS + 1) + across;
            let b = a + ACROSS + 1;
            mesh.triangles.extend([[a, b + 1, a + 1], [a, b, b + 1]]);
        }
    }
    mesh
}

impl Ground {
    /// A disc at height 0.
    fn disc(middle: Vec3, radius: f32) -> Self {
        const SIDES: u32 = 96;
        let points = (0..SIDES).map(|i| {
            let (sin, cos) = libm::sincosf(TAU * i as f32 / SIDES as f32);
            Vec3::new(middle.x + radius * sin, 0.0, middle.z + radius * cos)
        });
        let positions: Vec<Vec3> =
            std::iter::once(Vec3::new(middle.x, 0.0, middle.z)).chain(points).collect();
        let (picture, mean) = ground(Key::new(0));
        let mesh = Mesh {
            normals: vec![Vec3::Y; positions.len()],
            uvs: positions.iter().map(|p| Vec2::new(p.x, -p.z) / GROUND_TILE_M).collect(),
            triangles: (1..=SIDES).map(|i| [0, i, i % SIDES + 1]).collect(),
            positions,
        };
        let material = Material {
            name: "ground".to_owned(),
            base_color: mean,
            base_color_picture: Some(Arc::new(picture)),
            normal_picture: None,
            roughness: 1.0,
            double_sided: false,
            cutout: None,
            wrap: Wrap::Repeat,
            translucency: None,
            passing_picture: None,
        };
        Self { mesh, material, cover: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(min: Vec3, max: Vec3) -> [Vec3; 8] {
        Bounds { min, max }.corners()
    }

    #[test]
    fn everything_is_in_the_picture_and_fills_it() {
        for (min, max) in [
            (Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 12.0, 3.0)),
            (Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.2, 0.15)),
            (Vec3::new(-30.0, 0.0, -40.0), Vec3::new(30.0, 9.0, 20.0)),
            (Vec3::ZERO, Vec3::ZERO),
        ] {
            let corners = corners(min, max);
            let camera = Setting::around(&corners).unwrap().camera;
            let to_camera = camera.rotation().inverse();
            let mut most = 0.0_f32;
            for corner in corners {
                let p = to_camera * (corner - camera.position);
                assert!(-p.z > camera.near_m && -p.z < camera.far_m, "{max}: {p}");
                let half = libm::tanf(0.5 * camera.fov_y_rad) * -p.z;
                most = most.max(p.x.abs() / half).max(p.y.abs() / half);
            }
            assert!(most < 0.9, "{max}: {most}");
            assert!(most > 0.8 || max == Vec3::ZERO, "{max}: {most}");
        }
        assert!(Setting::around(&[]).is_none());
    }

    /// Twice the area of each triangle, along its normal, and where it is.
    fn faces(mesh: &Mesh) -> impl Iterator<Item = (Vec3, Vec3)> {
        mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            ((b - a).cross(c - a), a)
        })
    }

    #[test]
    fn ground_and_sky_are_seen_from_within() {
        let points = corners(Vec3::new(-3.0, 0.0, 1.0), Vec3::new(3.0, 12.0, 4.0));
        let Setting { ground, sun, sky, camera, .. } = Setting::around(&points).unwrap();
        assert!(faces(&ground.mesh).all(|(face, _)| face.y > 0.0));
        let middle = Vec3::new(0.0, 0.0, 2.5);
        assert!(faces(&sky.dome).all(|(face, at)| face.dot(middle - at) > 0.0));
        let bounds = ground.mesh.bounds().unwrap();
        assert!(bounds.min.y == 0.0 && bounds.max.y == 0.0);
        assert!(bounds.min.x < camera.position.x && camera.position.z < bounds.max.z);
        // It shines down, and onto the side that is seen.
        assert!((sun.rotation() * Vec3::NEG_Z).distance(-sun.toward) < 1e-6);
        assert!(sun.toward.dot((camera.position - camera.target).normalize()) > 0.3);
    }
}
