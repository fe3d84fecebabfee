//! Needles and scales.

use glam::{Vec2, Vec3};

use super::figure::{Figure, Piece, Skin, heading};
use super::tint::Tint;
use super::{LeafLook, Outline};
use linden_base::color::linear;
use linden_base::random::Key;

/// Half the width of the needles that an outline is made of, as a share of its length; `None`: it has none. Scales are no
/// needles: a spray is its twigs.
pub(super) fn needle_radius(look: &LeafLook) -> Option<f32> {
    let radius = match look.outline {
        Outline::Needle => look.width.clamp(0.004, 1.0) / 2.0,
        Outline::Pine => look.width.clamp(0.004, 0.2) / 4.0,
        Outline::Spruce => (look.width.clamp(0.01, 0.5) * SPRUCE_NEEDLE / 2.0).max(0.002),
        Outline::Larch => (look.width.clamp(0.01, 0.5) * larch_needle(look) / 2.0).max(0.0018),
        _ => return None,
    };
    Some(radius * look.needle_scale)
}

/// How many needles there are in place of `count`, as wide as they are.
fn fewer(look: &LeafLook, count: u32) -> u32 {
    ((count as f32 / look.needle_scale) as u32).max(1)
}

/// A needle of a spruce's shoot, as a share of the shoot.
const SPRUCE_NEEDLE: f32 = 0.17;

/// A needle of a larch's shoot, the same.
fn larch_needle(look: &LeafLook) -> f32 {
    (0.9 / larch_tufts(look) as f32 * 1.55).clamp(0.08, 0.3)
}

fn larch_tufts(look: &LeafLook) -> u32 {
    look.lobes.clamp(1, 60)
}

/// The skin of one needle: each catches the light in its own way.
fn skin(tint: &Tint, key: Key) -> Skin {
    let light = 1.0 + 0.28 * key.named("light").between(-1.0, 1.0) as f32;
    let turned = tint.patch_share > 0.0 && key.named("turned").unit() < f64::from(tint.patch_share);
    let color = if turned { tint.patch } else { tint.blade };
    Skin {
        color: color * light,
        patch: color * light,
        foot: color * light * Vec3::new(1.12, 1.1, 0.8),
        foot_reach: 0.3,
        mottle: 0.06,
        shadow: 0.35,
        lean: Vec2::new(
            key.named("lean u").between(-0.25, 0.25) as f32,
            key.named("lean v").between(-0.25, 0.25) as f32,
        ),
        place: Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32),
        ..Skin::default()
    }
}

/// How much of the light is left at the foot of wide needles of a tuft, which the others hide.
const FOOT_LIGHT: f32 = 0.5;
/// The shortest and the longest of them, in those of true ones: a ragged outline is left of them from afar.
const RAGGED: [f32; 2] = [0.6, 1.15];

/// The skin of a needle in a tuft. Where they are drawn wider than they are, they get darker towards the shoot, as thin
/// ones look that lie over each other.
fn tuft_skin(look: &LeafLook, tint: &Tint, key: Key) -> Skin {
    let skin = skin(tint, key);
    if look.needle_scale > 1.0 {
        Skin { foot: skin.color * FOOT_LIGHT, foot_reach: 1.0, ..skin }
    } else {
        skin
    }
}

/// How long a needle of a tuft is, in the longest of true ones, which are `least` at the least.
fn tuft_length(look: &LeafLook, least: f64, key: Key) -> f32 {
    let [low, high] = if look.needle_scale > 1.0 { RAGGED.map(f64::from) } else { [least, 1.0] };
    key.named("long").between(low, high) as f32
}

/// Bark of young shoots.
fn shoot(key: Key, color: [u8; 3]) -> Skin {
    let color = Vec3::from(linear(color));
    let place = Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32);
    Skin { color, patch: color, mottle: 0.35, shadow: 0.3, place, ..Skin::default() }
}

/// A needle from a point; bowed a little, with parallel edges and a short tip.
fn blade(foot: Vec2, along: Vec2, radius: f32, bow: f32, skin: Skin) -> Piece {
    let across = along.perp() * bow;
    let point = |t: f32| foot + along * t + across * (4.0 * t * (1.0 - t));
    // Bows of few pixels need few corners.
    let count = if along.length() > 0.5 { 16 } else { 4 };
    let points: Vec<Vec2> = (0..=count).map(|i| point(0.88 * i as f32 / count as f32)).collect();
    let mut piece = Piece::stroke(&points, [radius * 0.85, radius], skin);
    // The tip: where the stroke ends, it is drawn out to a point.
    piece.outline[points.len()] = point(1.0);
    piece
}

pub(super) fn needle(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let radius = needle_radius(look).unwrap_or_default();
    let bow = key.named("bow").between(-0.04, 0.04) as f32;
    Figure { pieces: vec![blade(Vec2::ZERO, Vec2::Y, radius, bow, skin(tint, key))], ..Figure::default() }
}

/// The end of a shoot with needles in pairs that spread to all sides.
pub(super) fn pine(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let pairs = fewer(look, (look.lobes / 2).clamp(1, 400));
    let radius = needle_radius(look).unwrap_or_default();
    let top = 0.5;
    let mut figure = Figure::default();
    figure.pieces.push(Piece::stroke(
        &[Vec2::ZERO, Vec2::new(0.0, top)],
        [0.017, 0.011],
        shoot(key, [122, 92, 62]),
    ));
    for pair in 0..pairs {
        let key = key.named("pair").child(u64::from(pair));
        let t = (pair as f32 + 0.5) / pairs as f32;
        let at = Vec2::new(key.named("x").between(-0.01, 0.01) as f32, 0.03 + (top - 0.03) * t);
        // Around the shoot: what points at us or away from us looks shorter and straighter.
        let round = key.named("round").unit() as f32 * std::f32::consts::TAU;
        let (sine, cosine) = libm::sincosf(round);
        let open = (1.12 - 0.62 * t * t) * key.named("open").between(0.8, 1.12) as f32;
        let out = heading(open);
        let seen = Vec2::new(out.x * sine, out.y + 0.10 * cosine.abs());
        let long = 0.50 * tuft_length(look, 0.85, key);
        for (name, part) in [("first", -1.0), ("second", 1.0)] {
            let needle_key = key.named(name);
            let along = seen.rotate(Vec2::from_angle(part * needle_key.between(0.03, 0.11) as f32)) * long;
            let bow = part * needle_key.named("bow").between(0.0, 0.05) as f32;
            figure.pieces.push(blade(at, along, radius, bow, tuft_skin(look, tint, needle_key)));
        }
    }
    let bud = Skin { color: Vec3::from(linear([146, 92, 58])), ..shoot(key, [146, 92, 58]) };
    figure.pieces.push(Piece::ball(Vec2::new(0.0, top + 0.012), 0.018, bud));
    figure
}

/// A shoot with short needles: those of its sides, then those above it.
pub(super) fn spruce(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let count = fewer(look, look.lobes.clamp(1, 1000));
    let long = SPRUCE_NEEDLE;
    let radius = needle_radius(look).unwrap_or_default();
    let top = 0.88;
    let mut figure = Figure::default();
    let upper = count / 3;
    let needles = |figure: &mut Figure, name: &str, count: u32, is_upper: bool| {
        for needle in 0..count {
            let key = key.named(name).child(u64::from(needle));
            let t = ((needle as f32 + key.named("place").unit() as f32) / count as f32).min(1.0);
            let sign = if needle % 2 == 0 { 1.0 } else { -1.0 };
            // Needles at the tip close around the bud.
            let open = (1.08 - 0.62 * t * t * t) * key.named("open").between(0.82, 1.15) as f32;
            let (open, foreshortened) = if is_upper {
                (open * key.named("turn").between(0.0, 0.75) as f32, 0.72)
            } else {
                (open, 1.0)
            };
            let size = long
                * foreshortened
                * (0.82 + 0.18 * (t * 6.0).min(1.0))
                * key.named("long").between(0.85, 1.08) as f32;
            let along = Vec2::new(sign, 1.0) * heading(open) * size * (1.0 - 0.25 * t * t);
            let at = Vec2::new(sign * 0.006, 0.015 + (top - 0.015) * t);
            let mut needle_skin = skin(tint, key);
            if is_upper {
                needle_skin.color *= 1.1;
            }
            figure.pieces.push(blade(at, along, radius, sign * -0.05, needle_skin));
        }
    };
    needles(&mut figure, "side", count - upper, false);
    figure.pieces.push(Piece::stroke(
        &[Vec2::ZERO, Vec2::new(0.0, top)],
        [0.013, 0.008],
        shoot(key, [150, 106, 66]),
    ));
    needles(&mut figure, "upper", upper, true);
    figure
}

/// A shoot with rosettes of soft needles on short shoots.
pub(super) fn larch(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    const NEEDLES: u32 = 30;
    let (tufts, needles) = (larch_tufts(look), fewer(look, NEEDLES));
    let long = larch_needle(look);
    let radius = needle_radius(look).unwrap_or_default();
    let top = 1.0 - long * 0.75;
    let mut figure = Figure::default();
    let wiggle = |t: f32| 0.012 * libm::sinf(t * 9.0 + key.named("wiggle").unit() as f32 * 6.0);
    let points: Vec<Vec2> =
        (0..=12).map(|i| Vec2::new(wiggle(i as f32 / 12.0) - wiggle(0.0), top * i as f32 / 12.0)).collect();
    figure.pieces.push(Piece::stroke(&points, [0.014, 0.008], shoot(key, [156, 122, 84])));
    for tuft in 0..tufts {
        let key = key.named("tuft").child(u64::from(tuft));
        let t = (tuft as f32 + 0.6 + key.named("place").between(-0.2, 0.2) as f32) / tufts as f32;
        let is_last = tuft + 1 == tufts;
        let sign = if tuft % 2 == 0 { 1.0 } else { -1.0 };
        let on = Vec2::new(wiggle(t) - wiggle(0.0), top * if is_last { 1.0 } else { t });
        let side = if is_last { Vec2::ZERO } else { Vec2::new(sign * 0.02, 0.006) };
        let at = on + side;
        figure.pieces.push(Piece::ball(at, 0.012, shoot(key, [112, 84, 58])));
        // A rosette seen askew: an ellipse of needles around a direction.
        let lean = if is_last { 0.0 } else { sign * key.named("lean").between(0.5, 1.0) as f32 };
        for needle in 0..needles {
            let key = key.child(u64::from(needle));
            let spread = key.named("spread").between(-1.0, 1.0) as f32;
            let angle = lean + spread * 1.75;
            let size = long * tuft_length(look, 0.72, key) * (1.0 - 0.18 * spread * spread);
            let bow = spread * 0.06;
            figure.pieces.push(blade(at, heading(angle) * size, radius, bow, tuft_skin(look, tint, key)));
        }
    }
    figure
}

/// A flat spray: branches that branch again, all clad in scales.
pub(super) fn scale(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let branches = look.lobes.clamp(1, 30);
    let mut figure = Figure::default();
    let girth = 0.0115;
    let wide = look.width.clamp(0.1, 2.0);
    for branch in 0..branches {
        for (name, sign) in [("right", 1.0), ("left", -1.0)] {
            let key = key.named(name).child(u64::from(branch));
            let t = (branch as f32 + if sign > 0.0 { 0.35 } else { 0.75 }) / (branches as f32 + 0.5);
            let at = Vec2::new(0.0, 0.10 + 0.80 * t);
            let angle = 0.88 - 0.25 * t + key.named("angle").between(-0.1, 0.1) as f32;
            let long = (0.16 + wide * 0.62 * (1.0 - t) * (0.35 + 0.65 * (t * 4.0).min(1.0)))
                * key.named("long").between(0.85, 1.1) as f32;
            let along = Vec2::new(sign, 1.0) * heading(angle) * long;
            let sub = (long / 0.055) as u32;
            for twig in 0..sub {
                let key = key.child(u64::from(twig));
                let part = if twig % 2 == 0 { 1.0 } else { -1.0 };
                let s = (twig as f32 + 1.2) / (sub as f32 + 1.4);
                let direction = along
                    .normalize_or(Vec2::Y)
                    .rotate(Vec2::from_angle(part * key.between(0.55, 0.8) as f32));
                let size = (0.035 + 0.42 * long * (1.0 - s)) * key.named("long").between(0.8, 1.1) as f32;
                clad(&mut figure, at + along * s, direction * size, girth * 0.82, tint, key);
            }
            clad(&mut figure, at, along, girth, tint, key);
        }
    }
    clad(&mut figure, Vec2::ZERO, Vec2::Y, girth * 1.25, tint, key);
    figure
}

/// A shoot under its scales: pairs that overlap like tiles, the lowest uppermost.
fn clad(figure: &mut Figure, foot: Vec2, along: Vec2, girth: f32, tint: &Tint, key: Key) {
    let length = along.length();
    let direction = along.normalize_or(Vec2::Y);
    let pitch = girth * 1.7;
    let count = ((length / pitch) as u32).max(1);
    for scale in (0..count).rev() {
        let key = key.named("scale").child(u64::from(scale));
        let t = scale as f32 / count as f32;
        let at = foot + along * t;
        let radius = girth * (1.0 - 0.4 * t);
        // Two flanking scales, then the one that faces us.
        for (name, part, wide) in [("right", -0.42, 0.75), ("left", 0.42, 0.75), ("face", 0.0, 0.85)] {
            let scale_key = key.named(name);
            let ahead = direction.rotate(Vec2::from_angle(part)) * pitch * 1.75;
            let mut skin = skin(tint, scale_key);
            skin.foot = skin.color * 0.72;
            skin.foot_reach = 0.75;
            if scale + 1 >= count {
                // Growing tips are lighter.
                skin.color *= Vec3::new(1.3, 1.25, 1.05);
            }
            let r = radius * wide;
            let points = [at, at + ahead * 0.35, at + ahead * 0.7];
            let mut piece = Piece::stroke(&points, [r, r * 0.9], skin);
            piece.outline[points.len()] = at + ahead;
            figure.pieces.push(piece);
        }
    }
}
