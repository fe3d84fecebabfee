//! A twig that lies flat, with its leaves.

use glam::{Affine2, Mat2, Vec2, Vec3};

use super::compound::leaf;
use super::figure::{Figure, Piece, Skin, heading};
use super::tint::Tint;
use super::{Arrangement, LeafLook, TwigLook};
use linden_base::color::linear;
use linden_base::random::Key;

/// The twig of a variant. Its length and that of its last leaf are one unit.
pub(super) fn twig(look: &LeafLook, twig: &TwigLook, variant: u32, key: Key) -> Figure {
    let (wood_m, leaf_m) = (positive(twig.length_m, 0.2), positive(twig.leaf_length_m, 0.08));
    let angle_deg = if twig.angle_deg.is_nan() { 55.0 } else { twig.angle_deg.clamp(0.0, 180.0) };
    let (wood, long) = (wood_m / (wood_m + leaf_m), leaf_m / (wood_m + leaf_m));
    let leaves = twig.leaves.clamp(1, TwigLook::MAX_LEAVES);
    let mut figure = Figure::default();
    let bend = key.named("bend").between(-0.08, 0.08) as f32;
    // It turns a little at each leaf.
    let zigzag = if twig.arrangement == Arrangement::Alternate { 0.007 * long } else { 0.0 };
    let axis = |t: f32, place: f32| {
        let turn = libm::cosf(std::f32::consts::PI * place);
        Vec2::new(bend * t * t * wood + zigzag * turn, wood * t)
    };
    let (each, places) = match twig.arrangement {
        Arrangement::Alternate => (1, leaves - 1),
        Arrangement::Opposite => (2, leaves.saturating_sub(1).div_ceil(2)),
    };
    let place_at = |t: f32| (t - 0.12) / 0.85 * places as f32;
    let points: Vec<Vec2> =
        (0..=48).map(|i| i as f32 / 48.0).map(|t| axis(t, place_at(t)) - axis(0.0, place_at(0.0))).collect();
    let origin = axis(0.0, place_at(0.0));
    let bark = Vec3::from(linear(twig.color));
    let skin = Skin {
        color: bark,
        patch: bark,
        mottle: 0.3,
        shadow: 0.35,
        place: Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32),
        ..Skin::default()
    };
    let thick = (0.010 * long).max(0.0025) + 0.004 * wood;
    // Leaves behind the twig, the twig, leaves before it.
    let mut behind = Vec::new();
    let mut before = Vec::new();
    let mut left = leaves - 1;
    for place in 0..places {
        for side in 0..each.min(left) {
            left -= 1;
            let key = key.named("leaf").child(u64::from(place)).child(u64::from(side));
            let is_right = if each == 2 { side == 0 } else { place % 2 == 0 };
            let t = 0.12 + 0.85 * (place as f32 + 0.5) / places as f32;
            let foot = axis(t, place_at(t)) - origin;
            let angle = (angle_deg.to_radians() * (1.08 - 0.25 * t)
                + key.named("angle").between(-0.16, 0.16) as f32)
                * if is_right { 1.0 } else { -1.0 };
            // Leaves are smaller at both ends of a twig.
            let size = long * (0.78 + 0.9 * t - 0.72 * t * t) * key.named("size").between(0.88, 1.05) as f32;
            let leaf = one(look, variant, foot, angle, size, key);
            if key.named("layer").unit() < 0.5 { behind.push(leaf) } else { before.push(leaf) }
        }
    }
    for leaf in &behind {
        figure.add(leaf, &Affine2::IDENTITY);
    }
    let end = points.last().copied().unwrap_or_default();
    figure.pieces.push(Piece::stroke(&points, [thick, thick * 0.55], skin));
    for leaf in &before {
        figure.add(leaf, &Affine2::IDENTITY);
    }
    figure.add(&one(look, variant, end, bend, long, key.named("end")), &Affine2::IDENTITY);
    figure
}

/// A leaf on the twig: rolled about its own axis, so that it looks narrower and catches other light.
fn one(look: &LeafLook, variant: u32, foot: Vec2, angle: f32, size: f32, key: Key) -> Figure {
    let tint = Tint::new(look, variant, key.named("tint"));
    let mut figure = leaf(look, &tint, key.named("shape"));
    let roll = key.named("roll").between(-0.75, 0.75) as f32;
    let nod = key.named("nod").between(-0.45, 0.45) as f32;
    let along = heading(angle);
    for piece in &mut figure.pieces {
        // The normal leans to the side that is turned away, in the figure's directions.
        let lean = Vec2::new(libm::sinf(roll) * 0.55, -libm::sinf(nod) * 0.5);
        piece.skin.lean += along * lean.y - along.perp() * lean.x;
        piece.skin.shadow = piece.skin.shadow.max(0.45);
    }
    let columns = Mat2::from_cols(-along.perp() * size * libm::cosf(roll), along * size * libm::cosf(nod));
    let mut out = Figure::default();
    out.add(&figure, &Affine2::from_mat2_translation(columns, foot));
    out
}

fn positive(x: f32, otherwise: f32) -> f32 {
    if x > 0.0 { x.clamp(1e-3, 1e3) } else { otherwise }
}
