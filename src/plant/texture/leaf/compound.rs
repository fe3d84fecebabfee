//! Whole leaves: a blade on its petiole, or leaflets in their order.

use glam::{Vec2, Vec3};

use super::LeafLook;
use super::blade::BladeLook;
use super::figure::{Figure, Piece, Skin, frame, heading};
use super::outline::{Margin, Outline, Veins};
use super::tint::Tint;
use super::{conifer, flower};
use linden_base::random::Key;

/// Half a petiole's width.
const PETIOLE: f32 = 0.0085;

/// One leaf, or what stands for it: a spray of needles, a flower.
pub(super) fn leaf(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    match look.outline {
        Outline::Fan => fan(look, tint, key),
        Outline::Pinnate => pinnate(look, tint, key),
        Outline::Bipinnate => bipinnate(look, tint, key),
        Outline::Palm => palm(look, tint, key),
        Outline::Fern => fern(look, tint, key),
        Outline::Needle => conifer::needle(look, tint, key),
        Outline::Pine => conifer::pine(look, tint, key),
        Outline::Spruce => conifer::spruce(look, tint, key),
        Outline::Larch => conifer::larch(look, tint, key),
        Outline::Scale => conifer::scale(look, tint, key),
        Outline::Blossom => flower::blossom(look, tint, key),
        Outline::Fruit => flower::fruit(look, tint, key),
        Outline::Petal => flower::petal(look, tint, key),
        _ => single(look, tint, key),
    }
}

/// A curved stalk from the origin to a point.
fn stalk(to: Vec2, radius: [f32; 2], skin: Skin, key: Key) -> Piece {
    let bow = to.perp() * key.named("bow").between(-0.06, 0.06) as f32;
    let points: Vec<Vec2> = (0..=10)
        .map(|i| {
            let t = i as f32 / 10.0;
            to * t + bow * (4.0 * t * (1.0 - t))
        })
        .collect();
    Piece::stroke(&points, radius, skin)
}

fn single(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let foot = look.petiole;
    let mut figure = Figure::default();
    if foot > 0.0 {
        // A little into the blade, where it becomes the midrib.
        let end = Vec2::new(0.0, foot + 0.02);
        figure.pieces.push(stalk(
            end,
            [PETIOLE * 1.15, PETIOLE * 0.75],
            tint.stalk(key),
            key.named("petiole"),
        ));
    }
    let blade = BladeLook::of(look, look.outline).blade(key.named("blade"));
    let frame = frame(Vec2::new(0.0, foot), Vec2::new(0.0, 1.0 - foot), 1.0);
    figure.pieces.push(blade.piece(frame, tint.blade(look, key)));
    figure
}

/// A leaflet of a compound leaf: turned, tilted and tinted a little on its own.
fn leaflet(
    look: &LeafLook,
    leaflet_look: BladeLook,
    tint: &Tint,
    foot: Vec2,
    along: Vec2,
    key: Key,
) -> Piece {
    let mut skin = tint.blade(look, key);
    let light = 1.0 + 0.16 * key.named("light").between(-1.0, 1.0) as f32;
    (skin.color, skin.patch, skin.foot) = (skin.color * light, skin.patch * light, skin.foot * light);
    skin.lean = Vec2::new(
        key.named("lean u").between(-0.22, 0.22) as f32,
        key.named("lean v").between(-0.22, 0.22) as f32,
    );
    leaflet_look.blade(key.named("blade")).piece(frame(foot, along, 1.0), skin)
}

fn fan(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let (foot, count) = (look.petiole, look.lobes.clamp(1, 31));
    let center = Vec2::new(0.0, foot);
    // Chestnut leaflets end in a drawn-out tip.
    let leaflet_look = BladeLook { tip: (look.tip + 0.35).min(1.0), ..BladeLook::of(look, Outline::Obovate) };
    let mut figure = Figure::default();
    figure.pieces.push(stalk(center, [PETIOLE * 1.2, PETIOLE], tint.stalk(key), key.named("petiole")));
    let half = (count as f32 - 1.0) / 2.0;
    // From the outermost, which lie lowest, to the middle one.
    let mut order: Vec<u32> = (0..count).collect();
    order.sort_by(|a, b| (*b as f32 - half).abs().total_cmp(&(*a as f32 - half).abs()));
    for leaflet_index in order {
        let key = key.named("leaflet").child(u64::from(leaflet_index));
        let side = if half > 0.0 { (leaflet_index as f32 - half) / half } else { 0.0 };
        let angle = side * (0.6 * half).min(2.3) + key.named("angle").between(-0.05, 0.05) as f32;
        let length = (1.0 - foot)
            * (1.0 - 0.06 * side.abs() - 0.34 * side * side)
            * key.named("length").between(0.95, 1.03) as f32;
        figure.pieces.push(leaflet(
            look,
            leaflet_look,
            tint,
            center + heading(angle) * 0.012,
            heading(angle) * length,
            key,
        ));
    }
    figure
}

fn pinnate(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let (foot, pairs) = (look.petiole, look.lobes.clamp(1, 40));
    // Leaflets as long as their room along the rachis lets them overlap a little.
    let room = (1.0 - foot) / (pairs as f32 + 1.2);
    let long = (room * 1.18 / look.width.clamp(0.1, 1.5)).clamp(0.12, 0.42);
    let end = 1.0 - long * 0.92;
    let leaflet_look = BladeLook::of(look, Outline::Ovate);
    let leaflet_look = BladeLook {
        veins: if look.veins == Veins::None { Veins::None } else { Veins::Pinnate },
        ..leaflet_look
    };
    let mut figure = Figure::default();
    let tip = Vec2::new(0.0, end);
    figure.pieces.push(Piece::stroke(
        &[Vec2::ZERO, tip * 0.5, tip],
        [PETIOLE, PETIOLE * 0.45],
        tint.stalk(key),
    ));
    for pair in 0..pairs {
        for (name, sign) in [("right", 1.0), ("left", -1.0)] {
            let key = key.named(name).child(u64::from(pair));
            let t = (pair as f32 + key.named("place").between(-0.08, 0.08) as f32) / pairs as f32;
            let at = Vec2::new(0.0, foot + (end - foot - room * 0.35) * t.max(0.0));
            let angle = 1.12 - 0.28 * t + key.named("angle").between(-0.08, 0.08) as f32;
            // The lowest pair is smaller than the middle ones.
            let size = (0.84 + 0.5 * t - 0.42 * t * t) * key.named("size").between(0.93, 1.05) as f32;
            let along = Vec2::new(sign, 1.0) * heading(angle) * long * size;
            figure.pieces.push(leaflet(look, leaflet_look, tint, at + along * 0.02, along, key));
        }
    }
    let key = key.named("end");
    figure.pieces.push(leaflet(look, leaflet_look, tint, tip, Vec2::new(0.0, 1.0 - end), key));
    figure
}

fn bipinnate(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let (foot, branches) = (look.petiole, look.lobes.clamp(1, 30));
    let mut figure = Figure::default();
    let tip = Vec2::new(0.0, 0.86);
    figure.pieces.push(Piece::stroke(
        &[Vec2::ZERO, tip * 0.5, tip],
        [PETIOLE * 0.8, PETIOLE * 0.35],
        tint.stalk(key),
    ));
    let leaflet_look = BladeLook {
        width: look.width.clamp(0.1, 0.8),
        margin: Margin::Entire,
        veins: Veins::None,
        tip: 0.4,
        variation: 0.4,
        ..BladeLook::of(look, Outline::Elliptic)
    };
    for branch in 0..branches {
        for (name, sign) in [("right", 1.0), ("left", -1.0)] {
            let key = key.named(name).child(u64::from(branch));
            let t = (branch as f32 + 0.5) / branches as f32;
            let at = Vec2::new(
                0.0,
                foot + (0.86 - foot) * (branch as f32 / (branches as f32 - 0.5).max(1.0)).min(1.0),
            );
            let angle = 1.05 - 0.68 * t * t + key.named("angle").between(-0.05, 0.05) as f32;
            let long =
                (0.36 - 0.30 * (t - 0.45) * (t - 0.45) * 2.2) * key.named("size").between(0.92, 1.05) as f32;
            let along = Vec2::new(sign, 1.0) * heading(angle) * long;
            pinna(&mut figure, look, leaflet_look, tint, at, along, key);
        }
    }
    figure
}

/// A branch of a twice pinnate leaf: small leaflets in pairs, all pointing ahead.
fn pinna(
    figure: &mut Figure,
    look: &LeafLook,
    leaflet_look: BladeLook,
    tint: &Tint,
    foot: Vec2,
    along: Vec2,
    key: Key,
) {
    const PAIRS: u32 = 13;
    let stroke = Piece::stroke(&[foot, foot + along], [0.0032, 0.0016], tint.stalk(key));
    figure.pieces.push(stroke);
    let long = along.length() * 1.5 / PAIRS as f32 / leaflet_look.width.max(0.2) * 0.62;
    for pair in 0..PAIRS {
        for sign in [1.0_f32, -1.0] {
            let key = key.child(u64::from(pair)).named(if sign > 0.0 { "right" } else { "left" });
            let t = (pair as f32 + 0.6) / PAIRS as f32;
            let direction = along.normalize_or(Vec2::Y).rotate(Vec2::from_angle(-sign * 1.05));
            let size = long * (1.0 - 0.5 * t * t) * key.between(0.9, 1.08) as f32;
            figure.pieces.push(leaflet(look, leaflet_look, tint, foot + along * t, direction * size, key));
        }
    }
}

fn palm(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let (foot, pairs) = (look.petiole, look.lobes.clamp(2, 120));
    let mut figure = Figure::default();
    let points: Vec<Vec2> = (0..=8).map(|i| Vec2::new(0.0, 0.94 * i as f32 / 8.0)).collect();
    let leaflet_look = BladeLook {
        width: look.width.clamp(0.02, 0.4),
        margin: Margin::Entire,
        tip: 0.75,
        variation: 1.0,
        ..BladeLook::of(look, Outline::Linear)
    };
    for pair in 0..pairs {
        for (name, sign) in [("right", 1.0), ("left", -1.0)] {
            let key = key.named(name).child(u64::from(pair));
            let t = (pair as f32 + 0.5 + key.named("place").between(-0.3, 0.3) as f32) / pairs as f32;
            let at = Vec2::new(0.0, foot + (0.94 - foot) * t);
            let angle = 1.15 - 0.85 * t + key.named("angle").between(-0.09, 0.09) as f32;
            let long = 0.40
                * libm::powf(4.0 * (t * 0.86 + 0.1) * (0.98 - t * 0.86), 0.6)
                * key.named("size").between(0.9, 1.05) as f32;
            let along = Vec2::new(sign, 1.0) * heading(angle) * long.max(0.05);
            figure.pieces.push(leaflet(look, leaflet_look, tint, at, along, key));
        }
    }
    let rachis = Skin { color: tint.stalk * Vec3::new(0.95, 1.05, 0.8), ..tint.stalk(key) };
    figure.pieces.push(Piece::stroke(&points, [0.014, 0.003], rachis));
    figure
}

fn fern(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let (foot, pairs) = (look.petiole, look.lobes.clamp(2, 60));
    let mut figure = Figure::default();
    let room = (1.0 - foot) / pairs as f32;
    let points: Vec<Vec2> = (0..=8).map(|i| Vec2::new(0.0, 0.985 * i as f32 / 8.0)).collect();
    figure.pieces.push(Piece::stroke(&points, [0.007, 0.0016], tint.stalk(key)));
    for pair in 0..pairs {
        for (name, sign) in [("right", 1.0), ("left", -1.0)] {
            let key = key.named(name).child(u64::from(pair));
            // Alternate, and closer together towards the tip.
            let t = ((pair as f32 + if sign > 0.0 { 0.25 } else { 0.5 }) / pairs as f32).min(1.0);
            let y = foot + (0.985 - foot) * (1.0 - libm::powf(1.0 - t, 1.25));
            let angle = 1.33 - 0.5 * t + key.named("angle").between(-0.05, 0.05) as f32;
            let long = 0.30
                * libm::powf(1.0 - t, 0.75)
                * (0.62 + 0.38 * (t * 5.0).min(1.0))
                * key.named("size").between(0.94, 1.04) as f32;
            if long < 0.012 {
                continue;
            }
            let teeth = ((long / room * 2.6) as u32).clamp(2, 16);
            let leaflet_look = BladeLook {
                width: (look.width * 0.30 / long.max(0.06)).clamp(0.12, 0.42),
                margin: Margin::Crenate,
                teeth,
                tooth_depth: look.width * 0.28 * (0.30 / long.max(0.06)).min(2.0),
                tip: 0.7,
                variation: 0.5,
                ..BladeLook::of(look, Outline::Lanceolate)
            };
            let along = Vec2::new(sign, 1.0) * heading(angle) * long;
            figure.pieces.push(leaflet(look, leaflet_look, tint, Vec2::new(0.0, y), along, key));
        }
    }
    figure
}
