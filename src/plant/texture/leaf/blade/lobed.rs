//! Rounded lobes on both sides of a midrib: oak.

use glam::Vec2;

use super::BladeLook;
use crate::texture::leaf::figure::heading;
use linden_base::random::Key;

/// Points along one side.
const STEPS: usize = 220;
/// How many lobes' widths the end of the blade takes.
const END: f32 = 0.62;

/// Where a lobe leaves the midrib, and where it ends: a vein runs there.
pub(in super::super) type Lobe = [Vec2; 2];

/// The outline, and its lobes.
pub(super) fn outline(look: &BladeLook, key: Key) -> (Vec<Vec2>, Vec<Lobe>) {
    let (right, mut lobes) = side(look, 1.0, key.named("right"));
    let (left, more) = side(look, -1.0, key.named("left"));
    lobes.extend(more);
    let mut outline = right;
    outline.extend(left.into_iter().rev().skip(1));
    outline.pop();
    (outline, lobes)
}

fn side(look: &BladeLook, sign: f32, key: Key) -> (Vec<Vec2>, Vec<Lobe>) {
    let count = look.lobes.clamp(1, 20);
    let phases = count as f32 + END;
    let uneven =
        |lobe: f32, name: &str| look.variation * key.child(lobe as u64).named(name).between(-1.0, 1.0) as f32;
    let place = |phase: f32, depth: f32| -> [Vec2; 2] {
        let t = (phase / phases).clamp(0.0, 1.0);
        let lobe = phase.floor();
        // 0 in a bay, 1 on a lobe; bays are narrower than lobes.
        let bay = 0.5 + 0.5 * libm::cosf(std::f32::consts::TAU * phase);
        let size = 1.0 + 0.13 * uneven(lobe, "size") * (1.0 - bay);
        // Where nothing is left of the width, the last lobe closes over the tip.
        let in_bay = libm::powf(bay, 1.5) * depth;
        // The blade begins as a wedge.
        let reach = envelope(t) * size * (1.0 - in_bay) * libm::sqrtf((phase / 0.5).clamp(0.0, 1.0));
        // Lobes lean towards the tip, the more the nearer to it they are.
        let lean = 1.10 - 0.35 * t - 0.75 * t * t * t * t * t * t;
        let stem = 0.02 + 0.80 * t + 0.018 * uneven(lobe, "place") * (1.0 - bay);
        let direction = heading(lean.max(0.0));
        let from = Vec2::new(0.0, stem);
        [from, from + Vec2::new(sign * direction.x * reach * look.width, direction.y * reach * 0.42)]
    };
    // The foot and the tip are no bays.
    let depth_at = |phase: f32| {
        let ends = (phase / 0.5).min(1.0) * ((phases - phase) / END).min(1.0);
        look.lobe_depth.clamp(0.0, 0.95) * ends
    };
    let mut points: Vec<Vec2> = (0..=STEPS)
        .map(|i| {
            let phase = phases * i as f32 / STEPS as f32;
            place(phase, depth_at(phase))[1]
        })
        .collect();
    if let [first, .., last] = &mut points[..] {
        *first = Vec2::ZERO;
        last.x = 0.0;
    }
    let top = points.iter().fold(0.0_f32, |top, p| top.max(p.y)).max(1e-3);
    let scaled = |p: Vec2| Vec2::new(p.x, p.y / top);
    let lobes = (0..count).map(|lobe| place(lobe as f32 + 0.5, 0.0).map(scaled)).collect();
    (points.into_iter().map(scaled).collect(), lobes)
}

/// How far lobes reach on the way from foot to tip, as a share of the blade's width: widest above the
/// middle, small at the foot.
fn envelope(t: f32) -> f32 {
    let below = 0.2 + 0.42 * libm::powf(t / 0.6, 1.2);
    let above = 0.62 * libm::sqrtf((1.0 - ((t - 0.6) / 0.62) * ((t - 0.6) / 0.62)).max(0.0));
    if t < 0.6 { below } else { above }
}
