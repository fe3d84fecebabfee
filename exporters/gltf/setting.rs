//! Camera and lights.
//!
//! glTF has no sky: a dome shows it that is not lit itself. The light that it adds is told by four directional lights: one from the zenith and three
//! from around, such that level ground gets the sky's light and an upright wall half of it, whichever
//! way it faces: as under an even sky.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use linden_pipeline::stage::{self, Setting};

use super::document::{Camera, Extras, Light, LightIndex, Node, NodeExtensions, Perspective};

/// What lights and a sky that is not lit need.
pub(super) const EXTENSIONS: [&str; 2] = ["KHR_lights_punctual", "KHR_materials_unlit"];

/// How high the three lights from around stand, radians.
const AROUND_RAD: f32 = 0.35;
/// The part of the sky's light on level ground that each of them has where it falls straight.
const AROUND: f32 = 0.5;

pub(super) fn camera(camera: &stage::Camera) -> Camera {
    let perspective = Perspective {
        aspect_ratio: camera.aspect,
        yfov: camera.fov_y_rad,
        zfar: camera.far_m,
        znear: camera.near_m,
    };
    Camera { name: "Camera", kind: "perspective", perspective }
}

/// Where the camera is. Its extras tell what the setting was asked for with.
pub(super) fn camera_node(Setting { camera, surroundings, .. }: &Setting) -> Node {
    let linden_setting = (!surroundings.is_usual()).then(|| surroundings.to_string());
    Node {
        extras: Extras { linden_setting, ..Extras::default() },
        name: "Camera".to_owned(),
        camera: Some(0),
        translation: Some(camera.position.to_array()),
        rotation: Some(camera.rotation().to_array()),
        ..Node::default()
    }
}

/// All lights, and how each is turned.
pub(super) fn lights(setting: &Setting) -> Vec<(Light, Quat)> {
    let light = |name: &str, color: [f32; 3], intensity: f32, toward: Vec3| {
        let light = Light { name: name.to_owned(), kind: "directional", color, intensity };
        (light, Quat::from_rotation_arc(Vec3::Z, toward))
    };
    let Setting { sun, sky, .. } = setting;
    let (height, flat) = libm::sincosf(AROUND_RAD);
    let lux = sky.illuminance_lux;
    let around = (0..3).map(|i| {
        let (sin, cos) = libm::sincosf(TAU * i as f32 / 3.0);
        light(&format!("Sky {}", i + 2), sky.color, AROUND * lux, Vec3::new(flat * sin, height, flat * cos))
    });
    let zenith = (1.0 - 3.0 * AROUND * height) * lux;
    let mut all = vec![
        light("Sun", sun.color, sun.illuminance_lux, sun.toward),
        light("Sky 1", sky.color, zenith, Vec3::Y),
    ];
    all.extend(around);
    all
}

pub(super) fn light_node(light: &Light, rotation: Quat, index: usize) -> Node {
    Node {
        name: light.name.clone(),
        rotation: Some(rotation.to_array()),
        extensions: NodeExtensions { light: Some(LightIndex { light: index }), ..NodeExtensions::default() },
        ..Node::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skys_lights_sum_up_to_the_skys() {
        let setting = Setting::around(&[Vec3::NEG_ONE, Vec3::ONE]).unwrap();
        let lights = lights(&setting);
        // Irradiance by the cosine law, of the sky's lights alone.
        let on = |normal: Vec3| -> f32 {
            let sky = lights.iter().skip(1);
            sky.map(|(light, turn)| (*turn * Vec3::Z).dot(normal).max(0.0) * light.intensity).sum()
        };
        let lux = setting.sky.illuminance_lux;
        assert!((on(Vec3::Y) / lux - 1.0).abs() < 1e-5);
        for i in 0_u8..24 {
            let (sin, cos) = libm::sincosf(f32::from(i) * 0.27);
            let wall = on(Vec3::new(sin, 0.0, cos)) / lux;
            assert!((0.4..0.6).contains(&wall), "{wall}");
        }
    }
}
