//! Blades of grass in tufts.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{GroundCover, GroundPatch, Meadow, VARIANTS, lying, variant};
use crate::foliage::Placement;
use crate::scene::{Material, Translucency, Wrap};
use linden_base::color::encode;
use linden_base::mesh::Mesh;
use linden_base::picture::Picture;
use linden_base::random::Key;

/// Blades of a patch; where places lie far apart each square metre has fewer.
const BLADES: usize = 420;
/// Blades that rise from one foot.
const TUFT: usize = 7;
/// Length of a blade, shortest and longest, metres.
const LENGTHS_M: [f64; 2] = [0.07, 0.24];
/// Hues of the picture: columns of it.
const HUES: usize = 8;
/// Side of the picture's columns, and their height, pixels.
const COLUMN_PX: usize = 4;
const HEIGHT_PX: usize = 32;
/// Linear colours of blades at their foot and at their tip, fresh and dry.
const FOOT: [f32; 3] = [0.03, 0.045, 0.012];
const FRESH: [f32; 3] = [0.095, 0.15, 0.032];
const DRY: [f32; 3] = [0.2, 0.17, 0.075];

/// Patches with their places on a meadow, thinner toward its edge.
pub(super) fn patches(meadow: &Meadow, key: Key) -> Vec<GroundPatch> {
    let mut placements: Vec<Vec<Placement>> = vec![Vec::new(); VARIANTS];
    for (at, share, key) in meadow.places(key.named("places")) {
        // Beyond two thirds of the way places are left out one by one, so that there is no edge.
        if key.named("kept").unit() < f64::from(3.0 * (1.0 - share)) {
            placements[variant(key, VARIANTS)].push(lying(at, key));
        }
    }
    let material = material();
    placements
        .into_iter()
        .enumerate()
        .filter(|(_, placements)| !placements.is_empty())
        .map(|(index, placements)| GroundPatch {
            kind: GroundCover::Grass,
            name: format!("Ground_grass_{}", index + 1),
            mesh: patch(meadow.reach_m(), key.child(index as u64)),
            material: material.clone(),
            placements,
        })
        .collect()
}

fn patch(reach_m: f32, key: Key) -> Mesh {
    let mut mesh = Mesh::default();
    for tuft in 0..BLADES / TUFT {
        let key = key.child(tuft as u64);
        let foot = key.named("foot").in_disc().as_vec2() * reach_m;
        for blade_of_tuft in 0..TUFT {
            blade(&mut mesh, foot, key.child(blade_of_tuft as u64));
        }
    }
    mesh
}

/// A blade of three triangles that bends over, two pieces and a tip.
fn blade(mesh: &mut Mesh, tuft: Vec2, key: Key) {
    let foot = tuft + key.named("foot").in_disc().as_vec2() * 0.05;
    let length = key.named("length").between(LENGTHS_M[0], LENGTHS_M[1]) as f32;
    let half = 0.022 * length + 0.0015;
    let (sin, cos) = libm::sincosf(key.named("turn").between(0.0, TAU.into()) as f32);
    let (out, side) = (Vec3::new(sin, 0.0, cos), Vec3::new(cos, 0.0, -sin));
    // From the vertical: at the foot, in the middle, and at the tip.
    let lean = key.named("lean").between(0.05, 0.5) as f32;
    let bend = key.named("bend").between(0.3, 1.1) as f32;
    let toward = |angle: f32| out * libm::sinf(angle) + Vec3::Y * libm::cosf(angle);
    let start = Vec3::new(foot.x, 0.0, foot.y);
    let middle = start + toward(lean) * (0.55 * length);
    let tip = middle + toward(lean + bend) * (0.45 * length);
    // Lit as the meadow is, more than as each blade would be: that is how it looks from some steps away.
    let normal = |angle: f32| (out * -libm::cosf(angle) + Vec3::Y * (1.5 + libm::sinf(angle))).normalize();
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([
        start - side * half,
        start + side * half,
        middle - side * (0.8 * half),
        middle + side * (0.8 * half),
        tip,
    ]);
    let [low, high] = [normal(lean), normal(lean + bend)];
    mesh.normals.extend([low, low, low, low, high]);
    let hue = ((key.named("hue").unit() * HUES as f64) as usize).min(HUES - 1);
    let u = (hue as f32 + 0.5) / HUES as f32;
    mesh.uvs.extend([0.0, 0.0, 0.55, 0.55, 0.98].map(|v| Vec2::new(u, v)));
    mesh.triangles.extend([
        [first, first + 3, first + 1],
        [first, first + 2, first + 3],
        [first + 2, first + 4, first + 3],
    ]);
}

fn material() -> Material {
    let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t);
    // Every fourth hue has a dry tip.
    let tip = |hue: usize| mix(FRESH, DRY, [0.1, 0.25, 0.0, 0.75, 0.3, 0.15, 0.5, 0.05][hue % 8]);
    let mut rgba = Vec::with_capacity(4 * HUES * COLUMN_PX * HEIGHT_PX);
    for row in 0..HEIGHT_PX {
        // The upper edge of the picture is the tip.
        let height = 1.0 - (row as f32 + 0.5) / HEIGHT_PX as f32;
        for hue in 0..HUES {
            let [r, g, b] =
                mix(FOOT, tip(hue), libm::powf(height, 0.7)).map(|x| libm::roundf(255.0 * encode(x)) as u8);
            rgba.extend([[r, g, b, 255]; COLUMN_PX].concat());
        }
    }
    Material {
        name: "grass".to_owned(),
        base_color: mix(FOOT, FRESH, 0.6),
        base_color_picture: Some(Arc::new(Picture::new((HUES * COLUMN_PX) as u32, HEIGHT_PX as u32, rgba))),
        normal_picture: None,
        roughness: 0.8,
        double_sided: true,
        cutout: None,
        wrap: Wrap::Clamp,
        translucency: Translucency::leaf(0.35),
        passing_picture: None,
    }
}
