//! Veins: a midrib, ribs to both sides or into the lobes, and finer ones between them.

use glam::Vec2;

use super::BladeLook;
use super::lobed::Lobe;
use crate::texture::leaf::figure::{Vein, heading};
use crate::texture::leaf::outline::{Outline, Veins};
use linden_base::random::Key;

/// Half the midrib's width at the foot, lengths.
const MIDRIB: f32 = 0.0075;
/// Half a rib's width where it begins.
const RIB: f32 = 0.0034;
/// Half the width of the veins between ribs.
const CROSS: f32 = 0.0011;

/// All veins, the midrib first.
pub(super) fn veins(look: &BladeLook, outline: &[Vec2], lobes: &[Lobe], key: Key) -> Vec<Vein> {
    let midrib = line(&[Vec2::ZERO, Vec2::new(0.0, 0.5), Vec2::new(0.0, 0.985)], MIDRIB, true);
    match look.veins {
        Veins::None => Vec::new(),
        Veins::Parallel => parallel(look, midrib),
        Veins::Palmate => palmate(look, outline, lobes, key),
        Veins::Pinnate => {
            let mut all = vec![midrib];
            let ribs = if lobes.is_empty() { ribs(look, outline, key) } else { into_lobes(lobes) };
            finer(&mut all, &ribs, outline, key.named("cross"));
            all.extend(ribs.into_iter().flatten());
            all
        }
    }
}

fn line(points: &[Vec2], radius: f32, is_rib: bool) -> Vein {
    Vein { points: points.to_vec(), radius: [radius, radius * 0.3], is_rib }
}

/// How many ribs a side usually has: beech 7, birch 6, willow some 15.
const fn rib_count(outline: Outline) -> usize {
    match outline {
        Outline::Lanceolate => 15,
        Outline::Linear | Outline::Deltoid => 5,
        Outline::Rhombic | Outline::Cordate | Outline::Orbicular => 6,
        Outline::Obovate | Outline::Elliptic => 8,
        _ => 7,
    }
}

/// Ribs from the midrib to the edge: those of the right side, those of the left one.
fn ribs(look: &BladeLook, outline: &[Vec2], key: Key) -> [Vec<Vein>; 2] {
    let count = rib_count(look.outline);
    // Several ribs of broad bases leave the foot itself.
    let from_foot = matches!(look.outline, Outline::Cordate | Outline::Orbicular | Outline::Deltoid);
    ["right", "left"].map(|name| {
        let sign = if name == "right" { 1.0 } else { -1.0 };
        let key = key.named(name);
        (0..count)
            .filter_map(|i| {
                let t = (i as f32 + 0.35) / count as f32;
                let uneven = key.child(i as u64).between(-0.25, 0.25) as f32 / count as f32;
                let (start, angle) = if from_foot {
                    let low = (1.0 - t * 3.2).max(0.0);
                    ((t - 0.13).max(0.0) * 0.98, 0.82 - 0.22 * t + 0.95 * low)
                } else {
                    (0.02 + 0.88 * t, 0.95 - 0.3 * t)
                };
                let narrow = (look.width / 0.5).clamp(0.45, 1.0);
                rib(Vec2::new(0.0, start + look.variation * uneven), angle * narrow, sign, outline)
            })
            .collect()
    })
}

/// A rib that leaves at an angle from the midrib and turns towards the tip, up to the edge.
fn rib(start: Vec2, angle: f32, sign: f32, outline: &[Vec2]) -> Option<Vein> {
    const STEPS: usize = 8;
    let far = Vec2::new(sign, 0.0) * heading(angle).x * 2.0 + Vec2::Y * heading(angle).y * 2.0;
    let reach = crossing(start, start + far, outline)?;
    let length = reach * 2.0;
    if length < 0.02 {
        return None;
    }
    let mut points = vec![start];
    let (mut at, step) = (start, length / STEPS as f32);
    for i in 0..STEPS {
        let turn = angle * (1.0 - 0.36 * (i as f32 / STEPS as f32));
        let direction = heading(turn);
        let next = at + Vec2::new(sign * direction.x, direction.y) * step;
        if let Some(share) = crossing(at, next, outline) {
            // It ends a little before the edge.
            points.push(at.lerp(next, share * 0.8));
            break;
        }
        points.push(next);
        at = next;
    }
    Some(line(&points, RIB * (0.6 + 0.8 * length.min(0.5)), true))
}

/// Where a segment first leaves the outline, as a share of it.
fn crossing(a: Vec2, b: Vec2, outline: &[Vec2]) -> Option<f32> {
    let way = b - a;
    let last = outline.last().copied()?;
    let mut first: Option<f32> = None;
    let mut from = last;
    for &to in outline {
        let edge = to - from;
        let across = way.perp_dot(edge);
        if across != 0.0 {
            let t = (from - a).perp_dot(edge) / across;
            let s = (from - a).perp_dot(way) / across;
            // Not where it begins, on the edge itself at the foot.
            if t > 1e-3 && t <= 1.0 && (0.0..=1.0).contains(&s) {
                first = Some(first.map_or(t, |known: f32| known.min(t)));
            }
        }
        from = to;
    }
    first
}

fn into_lobes(lobes: &[Lobe]) -> [Vec<Vein>; 2] {
    [1.0, -1.0].map(|sign: f32| {
        lobes
            .iter()
            .filter(|[_, tip]| tip.x * sign > 0.0)
            .map(|&[from, tip]| {
                let end = from.lerp(tip, 0.95);
                let bow = from.midpoint(end) + Vec2::new(0.0, -0.03 * from.distance(end));
                Vein {
                    radius: [RIB * 1.2, RIB * 0.4],
                    ..line(&super::curve(&[from, bow, end], 6), RIB, true)
                }
            })
            .collect()
    })
}

/// Rungs between neighbouring ribs of a side (percurrent tertiary veins), and short ones to the edge.
fn finer(all: &mut Vec<Vein>, ribs: &[Vec<Vein>; 2], outline: &[Vec2], key: Key) {
    for (side, ribs) in ribs.iter().enumerate() {
        for (i, pair) in ribs.windows(2).enumerate() {
            rungs(all, &pair[0], &pair[1], outline, key.child(side as u64).child(i as u64));
        }
    }
}

fn rungs(all: &mut Vec<Vein>, low: &Vein, high: &Vein, outline: &[Vec2], key: Key) {
    let length = along(low, 1.0).distance(along(low, 0.0));
    let count = (length / 0.026) as u64;
    for rung in 0..count {
        let rung_key = key.child(rung);
        let t = (rung as f32 + 0.5 + rung_key.named("from").between(-0.3, 0.3) as f32) / count as f32;
        let a = along(low, t);
        let b = along(high, (t - 0.06 + rung_key.named("to").between(-0.07, 0.07) as f32).clamp(0.0, 1.0));
        if a.distance(b) > 0.3 || crossing(a, b, outline).is_some() {
            continue;
        }
        let bow = (b - a).perp() * rung_key.named("bow").between(-0.16, 0.16) as f32;
        let knee = a.lerp(b, rung_key.named("knee").between(0.35, 0.65) as f32) + bow;
        // Some stop halfway and fork into the net.
        let points = if rung_key.named("stop").unit() < 0.2 { vec![a, knee] } else { vec![a, knee, b] };
        all.push(Vein { points, radius: [CROSS, CROSS * 0.7], is_rib: false });
    }
}

/// The place on a vein at a share of its points.
fn along(vein: &Vein, share: f32) -> Vec2 {
    let last = vein.points.len() - 1;
    let at = share.clamp(0.0, 1.0) * last as f32;
    let i = (at as usize).min(last.saturating_sub(1));
    vein.points[i].lerp(vein.points[(i + 1).min(last)], at - i as f32)
}

/// A main vein into each lobe with ribs of its own.
fn palmate(look: &BladeLook, outline: &[Vec2], lobes: &[Lobe], key: Key) -> Vec<Vein> {
    let mut all = Vec::new();
    for (i, &[from, tip]) in lobes.iter().enumerate() {
        let main = from.lerp(tip, 0.985);
        let radius = MIDRIB * (0.55 + 0.45 * main.length());
        all.push(line(&[from, from.midpoint(main), main], radius, true));
        let direction = (tip - from).normalize_or(Vec2::Y);
        let sides = [1.0_f32, -1.0].map(|sign| {
            let key = key.child(i as u64).named(if sign > 0.0 { "right" } else { "left" });
            let mut ribs = Vec::new();
            let count = 5 + 2 * usize::from(i == 0);
            for rib in 0..count {
                let uneven = look.variation * key.child(rib as u64).between(-0.03, 0.03) as f32;
                let start = from.lerp(main, 0.22 + 0.68 * (rib as f32 / count as f32) + uneven);
                let out = direction.rotate(Vec2::from_angle(-sign * 0.78));
                if let Some(reach) = crossing(start, start + out, outline) {
                    let end = start + out * reach * 0.94;
                    let bow = start.midpoint(end) + direction * (-0.05 * start.distance(end));
                    // Short of the neighbouring lobe's own ribs.
                    let is_short = reach < 0.42;
                    if is_short {
                        ribs.push(line(&super::curve(&[start, bow, end], 5), RIB * 0.9, true));
                    }
                }
            }
            ribs
        });
        finer(&mut all, &sides, outline, key.child(i as u64).named("cross"));
        all.extend(sides.into_iter().flatten());
    }
    all
}

/// Lines side by side, from foot to tip.
fn parallel(look: &BladeLook, midrib: Vein) -> Vec<Vein> {
    let mut all = vec![midrib];
    let half = look.width / 2.0;
    for (sign, i) in [1.0, -1.0].into_iter().flat_map(|sign| (1..=3).map(move |i| (sign, i))) {
        let away = sign * half * i as f32 / 4.0;
        let points = [[0.1, 0.01], [0.85, 0.2], [1.0, 0.45], [0.8, 0.75], [0.1, 0.985]];
        let points = points.map(|[x, y]| Vec2::new(away * x, y));
        all.push(line(&super::curve(&points, 6), CROSS * 1.4, false));
    }
    all
}
