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
    // The share of the twig at which a leaf stands, by its share of all leaves.
    let tuft = if twig.tuft.is_nan() { 0.0 } else { twig.tuft.clamp(0.0, 1.0) };
    let gathered = |share: f32| 1.0 - libm::powf(1.0 - share, 1.0 + 1.6 * tuft);
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
        Arrangement::Alternate | Arrangement::Spiral => (1, leaves - 1),
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
    let turn = key.named("turn").between(0.0, std::f64::consts::TAU) as f32;
    // Leaves behind the twig, the twig, leaves before it.
    let mut behind = Vec::new();
    let mut before = Vec::new();
    let mut left = leaves - 1;
    for place in 0..places {
        for side in 0..each.min(left) {
            left -= 1;
            let key = key.named("leaf").child(u64::from(place)).child(u64::from(side));
            let is_right = if each == 2 { side == 0 } else { place % 2 == 0 };
            let t = 0.12 + 0.85 * gathered((place as f32 + 0.5) / places as f32);
            let foot = axis(t, place_at(t)) - origin;
            let opening =
                angle_deg.to_radians() * (1.08 - 0.25 * t) + key.named("angle").between(-0.16, 0.16) as f32;
            // Leaves are smaller at both ends of a twig.
            let size = long * (0.78 + 0.9 * t - 0.72 * t * t) * key.named("size").between(0.88, 1.05) as f32;
            let stance = if twig.arrangement == Arrangement::Spiral {
                Stance::around(opening, turn + place as f32 * GOLDEN)
            } else {
                let is_before = key.named("layer").unit() >= 0.5;
                Stance::flat(if is_right { opening } else { -opening }, if is_before { 1.0 } else { -1.0 })
            };
            let leaf = one(look, variant, foot, stance, size, key);
            if stance.toward < 0.0 { behind.push(leaf) } else { before.push((stance.toward, leaf)) }
        }
    }
    // What rises most is nearest to who looks.
    before.sort_by(|a, b| a.0.total_cmp(&b.0));
    for leaf in &behind {
        figure.add(leaf, &Affine2::IDENTITY);
    }
    let end = points.last().copied().unwrap_or_default();
    figure.pieces.push(Piece::stroke(&points, [thick, thick * 0.55], skin));
    for (_, leaf) in &before {
        figure.add(leaf, &Affine2::IDENTITY);
    }
    figure.add(&one(look, variant, end, Stance::flat(bend, 1.0), long, key.named("end")), &Affine2::IDENTITY);
    figure
}

/// The golden angle, radians.
const GOLDEN: f32 = 2.399_963;
/// How far leaves around a twig stand out of the plane that it lies in: they turn to the light, which lays them down.
const RISE: f32 = 0.8;
/// The light that reaches leaves behind the twig.
const BEHIND: f32 = 0.72;

/// How a leaf stands on the twig, seen from above.
#[derive(Clone, Copy, Debug)]
struct Stance {
    /// Between the twig and the leaf, as one sees it, radians, to the right.
    angle: f32,
    /// The sine of the angle by which the leaf rises out of the plane, to who looks.
    rise: f32,
    /// Positive before the twig, negative behind it.
    toward: f32,
}

impl Stance {
    /// In the twig's plane, or as good as.
    fn flat(angle: f32, toward: f32) -> Self {
        Self { angle, rise: 0.0, toward }
    }

    /// Out of the twig by an angle, at a place round it.
    fn around(opening: f32, azimuth: f32) -> Self {
        let across = libm::sinf(opening) * libm::cosf(azimuth);
        let out = RISE * libm::sinf(opening) * libm::sinf(azimuth);
        let along = libm::cosf(opening);
        let rise = out / libm::sqrtf(across * across + along * along + out * out);
        Self { angle: libm::atan2f(across, along), rise, toward: rise }
    }
}

/// A leaf on the twig: rolled about its own axis, so that it looks narrower and catches other light.
fn one(look: &LeafLook, variant: u32, foot: Vec2, stance: Stance, size: f32, key: Key) -> Figure {
    let tint = Tint::new(look, variant, key.named("tint"));
    let mut figure = leaf(look, &tint, key.named("shape"));
    let roll = key.named("roll").between(-0.75, 0.75) as f32;
    let nod = libm::asinf(0.9 * stance.rise) + key.named("nod").between(-0.45, 0.45) as f32;
    let along = heading(stance.angle);
    let light = if stance.toward < 0.0 { BEHIND } else { 1.0 };
    for piece in &mut figure.pieces {
        // The normal leans to the side that is turned away, in the figure's directions.
        let lean = Vec2::new(libm::sinf(roll) * 0.55, -libm::sinf(nod) * 0.5);
        piece.skin.lean += along * lean.y - along.perp() * lean.x;
        piece.skin.shadow = piece.skin.shadow.max(0.45);
        for color in
            [&mut piece.skin.color, &mut piece.skin.patch, &mut piece.skin.vein, &mut piece.skin.foot]
        {
            *color *= light;
        }
    }
    let columns =
        Mat2::from_cols(-along.perp() * size * libm::cosf(roll), along * size * libm::cosf(nod).max(0.4));
    let mut out = Figure::default();
    out.add(&figure, &Affine2::from_mat2_translation(columns, foot));
    out
}

fn positive(x: f32, otherwise: f32) -> f32 {
    if x > 0.0 { x.clamp(1e-3, 1e3) } else { otherwise }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn leaves_around_a_twig_are_seen_as_they_would_be_turned_in_space() {
        let mut sides = [0_u32; 2];
        for place in 0..24 {
            let (opening, azimuth) = (0.2 + 0.05 * place as f32, place as f32 * GOLDEN);
            // Bent away from the twig to the right, then turned about it, then pressed towards the plane.
            let out = Quat::from_rotation_y(-azimuth) * (Quat::from_rotation_z(-opening) * Vec3::Y);
            let pressed = (out * Vec3::new(1.0, 1.0, RISE)).normalize();
            let seen = Stance::around(opening, azimuth);
            assert!(
                (heading(seen.angle) - pressed.truncate().normalize()).length() < 1e-5,
                "{place}: {seen:?}"
            );
            assert!((seen.rise - pressed.z).abs() < 1e-5, "{place}: {seen:?} {pressed}");
            sides[usize::from(seen.toward < 0.0)] += 1;
        }
        assert!(sides[0].abs_diff(sides[1]) <= 2, "as many before the twig as behind it: {sides:?}");
    }

    #[test]
    fn tufts_hold_the_same_leaves_nearer_to_the_end() {
        let look = LeafLook::new(super::super::Outline::Lobed);
        let feet = |tuft: f32| {
            let twig_look = TwigLook { leaves: 15, tuft, ..TwigLook::default() };
            // Blades are where their midribs begin.
            let mut feet: Vec<f32> = twig(&look, &twig_look, 0, Key::new(1))
                .pieces
                .iter()
                .filter(|piece| !piece.veins.is_empty())
                .map(|piece| piece.frame.translation.y)
                .collect();
            feet.sort_unstable_by(f32::total_cmp);
            feet
        };
        let (even, half, full) = (feet(0.0), feet(0.5), feet(1.0));
        assert_eq!([even.len(), half.len(), full.len()], [15; 3]);
        let lower_half = |feet: &[f32]| feet.iter().filter(|&&y| y < 0.5 * even[14]).count();
        assert!(lower_half(&even) >= 6 && lower_half(&full) <= 4, "{even:?} {full:?}");
        assert!(even.iter().zip(&half).all(|(even, half)| half > &(even - 0.01)));
        assert!(half.iter().zip(&full).all(|(half, full)| full > &(half - 0.01)));
    }
}
