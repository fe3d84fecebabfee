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
    let (wood, long) = (wood_m / (wood_m + leaf_m), leaf_m / (wood_m + leaf_m));
    let leaves = twig.leaves.clamp(1, TwigLook::MAX_LEAVES);
    let main = Shoot {
        foot: Vec2::ZERO,
        heading: 0.0,
        wood,
        bend: key.named("bend").between(-0.08, 0.08) as f32,
        leaves,
        key,
    };
    let drawing = Drawing { look, twig, variant, long };
    let sides = drawing.side_shoots(&main);
    let on_sides: u32 = sides.iter().map(|side| side.leaves).sum();
    let main = Shoot { leaves: leaves - on_sides, ..main };
    // Shoots behind it, the twig itself, shoots before it.
    let is_before = |side: &&Shoot| side.key.named("layer").unit() >= 0.5;
    let mut figure = Figure::default();
    for side in sides.iter().filter(|side| !is_before(side)) {
        drawing.add(side, &mut figure);
    }
    drawing.add(&main, &mut figure);
    for side in sides.iter().filter(is_before) {
        drawing.add(side, &mut figure);
    }
    figure
}

/// What all shoots of a twig have in common.
struct Drawing<'a> {
    look: &'a LeafLook,
    twig: &'a TwigLook,
    variant: u32,
    /// The length of a leaf.
    long: f32,
}

/// A shoot with leaves of its own, the one at its end included.
#[derive(Clone, Copy, Debug)]
struct Shoot {
    foot: Vec2,
    /// To the right of +Y, radians.
    heading: f32,
    /// Its length without its last leaf.
    wood: f32,
    /// How far its end lies to the right of where it began to go, as a share of its length.
    bend: f32,
    leaves: u32,
    key: Key,
}

/// Where side shoots leave a twig, as shares of its length.
const SHOOTS_FROM: f32 = 0.14;
const SHOOTS_TO: f32 = 0.74;

/// How long the lowest and the highest of them are, as shares of the twig, and how much that differs.
const LOW_SHOOT: f32 = 0.58;
const HIGH_SHOOT: f32 = 0.26;
const SHOOT_SPREAD: [f64; 2] = [0.72, 1.2];

/// At which angle, radians, and how they bend back along the twig.
const SHOOT_ANGLE: [f64; 2] = [0.62, 0.92];
const SHOOT_BEND: f32 = 0.1;

/// Where the first leaf stands on a shoot, and over how much of it they do, as shares of its length.
const LEAVES_FROM: f32 = 0.12;
const LEAVES_OVER: f32 = 0.85;

/// Leaves on a side shoot at least.
const LEAST_LEAVES: u32 = 2;

impl Drawing<'_> {
    /// The side shoots of a twig, from its foot on, and their share of its leaves.
    fn side_shoots(&self, main: &Shoot) -> Vec<Shoot> {
        let most = (main.leaves - 1) / (LEAST_LEAVES + 1);
        let count = self.twig.shoots.min(TwigLook::MAX_SHOOTS).min(most);
        let places = match self.twig.arrangement {
            Arrangement::Opposite => count.div_ceil(2),
            _ => count,
        };
        let first_right = main.key.named("first").unit() < 0.5;
        let mut shoots: Vec<Shoot> = (0..count)
            .map(|i| {
                let key = main.key.named("shoot").child(u64::from(i));
                let place = if places == count { i } else { i / 2 };
                let step =
                    (place as f32 + 0.5 + key.named("place").between(-0.3, 0.3) as f32) / places as f32;
                let share = SHOOTS_FROM + (SHOOTS_TO - SHOOTS_FROM) * step;
                let side = if (i % 2 == 0) == first_right { 1.0 } else { -1.0 };
                let [angle, spread] = [("angle", SHOOT_ANGLE), ("length", SHOOT_SPREAD)]
                    .map(|(name, [low, high])| key.named(name).between(low, high) as f32);
                Shoot {
                    foot: main.axis(share),
                    heading: main.heading_at(share) + side * angle,
                    wood: main.wood * (LOW_SHOOT + (HIGH_SHOOT - LOW_SHOOT) * step) * spread,
                    bend: -side * SHOOT_BEND,
                    leaves: 0,
                    key,
                }
            })
            .collect();
        let total: f32 = main.wood + shoots.iter().map(|shoot| shoot.wood).sum::<f32>();
        let mut left = main.leaves - 1 - LEAST_LEAVES * count;
        for shoot in &mut shoots {
            let more = (main.leaves as f32 * shoot.wood / total).round() as u32;
            let more = more.saturating_sub(LEAST_LEAVES).min(left);
            left -= more;
            shoot.leaves = LEAST_LEAVES + more;
        }
        shoots
    }

    /// Draws a shoot over what is there: leaves behind it, the shoot, leaves before it.
    fn add(&self, shoot: &Shoot, figure: &mut Figure) {
        let Self { look, twig, variant, long } = *self;
        let Shoot { wood, bend, leaves, key, .. } = *shoot;
        // Leaves at each place, and places.
        let places = match twig.arrangement {
            Arrangement::Alternate | Arrangement::Spiral => (1, leaves - 1),
            Arrangement::Opposite => (2, leaves.saturating_sub(1).div_ceil(2)),
        };
        // It turns a little at each leaf.
        let zigzag = if twig.arrangement == Arrangement::Alternate { 0.007 * long } else { 0.0 };
        let swing = |t: f32| {
            zigzag * libm::cosf(std::f32::consts::PI * ((t - LEAVES_FROM) / LEAVES_OVER * places.1 as f32))
        };
        let along = |t: f32| {
            shoot.place(Vec2::new(bend * t * t * wood + swing(t), wood * t) - Vec2::new(swing(0.0), 0.0))
        };
        let points: Vec<Vec2> = (0..=48).map(|i| along(i as f32 / 48.0)).collect();
        let [behind, before] = self.leaves(shoot, places, along);
        for leaf in &behind {
            figure.add(leaf, &Affine2::IDENTITY);
        }
        let thick = (0.010 * long).max(0.0025) + 0.004 * wood;
        figure.pieces.push(Piece::stroke(&points, [thick, thick * 0.55], self.bark(key)));
        for leaf in &before {
            figure.add(leaf, &Affine2::IDENTITY);
        }
        let end = points.last().copied().unwrap_or_default();
        let last = Stance::flat(bend, 1.0).turned(shoot.heading);
        figure.add(&one(look, variant, end, last, long, key.named("end")), &Affine2::IDENTITY);
    }

    /// The leaves of a shoot but the one at its end, behind it and before it, from the lowest to the uppermost.
    fn leaves(
        &self,
        shoot: &Shoot,
        (each, places): (u32, u32),
        along: impl Fn(f32) -> Vec2,
    ) -> [Vec<Figure>; 2] {
        let Self { look, twig, variant, long } = *self;
        let angle_deg = if twig.angle_deg.is_nan() { 55.0 } else { twig.angle_deg.clamp(0.0, 180.0) };
        // The share of the shoot at which a leaf stands, by its share of all leaves.
        let tuft = if twig.tuft.is_nan() { 0.0 } else { twig.tuft.clamp(0.0, 1.0) };
        let gathered = |share: f32| 1.0 - libm::powf(1.0 - share, 1.0 + 1.6 * tuft);
        let turn = shoot.key.named("turn").between(0.0, std::f64::consts::TAU) as f32;
        let mut behind = Vec::new();
        let mut before = Vec::new();
        let mut left = shoot.leaves - 1;
        for place in 0..places {
            for side in 0..each.min(left) {
                left -= 1;
                let key = shoot.key.named("leaf").child(u64::from(place)).child(u64::from(side));
                let is_right = if each == 2 { side == 0 } else { place % 2 == 0 };
                let t = LEAVES_FROM + LEAVES_OVER * gathered((place as f32 + 0.5) / places as f32);
                let opening = angle_deg.to_radians() * (1.08 - 0.25 * t)
                    + key.named("angle").between(-0.16, 0.16) as f32;
                // Leaves are smaller at both ends of a shoot.
                let size =
                    long * (0.78 + 0.9 * t - 0.72 * t * t) * key.named("size").between(0.88, 1.05) as f32;
                let stance = if twig.arrangement == Arrangement::Spiral {
                    Stance::around(opening, turn + place as f32 * GOLDEN)
                } else {
                    let is_before = key.named("layer").unit() >= 0.5;
                    Stance::flat(
                        if is_right { opening } else { -opening },
                        if is_before { 1.0 } else { -1.0 },
                    )
                };
                let leaf = one(look, variant, along(t), stance.turned(shoot.heading), size, key);
                if stance.toward < 0.0 { behind.push(leaf) } else { before.push((stance.toward, leaf)) }
            }
        }
        // What rises most is nearest to who looks.
        before.sort_by(|a, b| a.0.total_cmp(&b.0));
        [behind, before.into_iter().map(|(_, leaf)| leaf).collect()]
    }

    fn bark(&self, key: Key) -> Skin {
        let color = Vec3::from(linear(self.twig.color));
        Skin {
            color,
            patch: color,
            mottle: 0.3,
            shadow: 0.35,
            place: Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32),
            ..Skin::default()
        }
    }
}

impl Shoot {
    /// From its own coordinates, in which it grows along +Y from the origin.
    fn place(&self, p: Vec2) -> Vec2 {
        let along = heading(self.heading);
        self.foot + along * p.y - along.perp() * p.x
    }

    /// Its axis at a share of its length.
    fn axis(&self, share: f32) -> Vec2 {
        self.place(Vec2::new(self.bend * share * share, share) * self.wood)
    }

    /// Where it goes there, radians to the right of +Y.
    fn heading_at(&self, share: f32) -> f32 {
        self.heading + libm::atanf(2.0 * self.bend * share)
    }
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

    /// On a shoot that goes elsewhere.
    fn turned(self, heading: f32) -> Self {
        Self { angle: self.angle + heading, ..self }
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
    fn side_shoots_share_the_leaves_and_make_the_twig_broad() {
        let look = LeafLook::new(super::super::Outline::Ovate);
        for arrangement in [Arrangement::Alternate, Arrangement::Opposite, Arrangement::Spiral] {
            for (leaves, shoots, drawn) in [(40, 6, 6), (40, 0, 0), (1, 5, 0), (7, 5, 2), (12, 30, 3)] {
                let of = |variant: u32, shoots: u32| {
                    let twig_look = TwigLook { leaves, arrangement, shoots, ..TwigLook::default() };
                    twig(&look, &twig_look, variant, Key::new(9).child(u64::from(variant)))
                };
                let (straight, branched) = (of(1, 0), of(1, shoots));
                let blades = |figure: &Figure| figure.pieces.iter().filter(|p| !p.veins.is_empty()).count();
                assert_eq!([blades(&straight), blades(&branched)], [leaves as usize; 2]);
                // Wood is what has the bark's mottle.
                let strokes = |figure: &Figure| figure.pieces.iter().filter(|p| p.skin.mottle == 0.3).count();
                assert_eq!(strokes(&branched), drawn + 1, "{arrangement:?} {leaves} {shoots}");
                let width = |figure: &Figure| figure.bounds().1.x - figure.bounds().0.x;
                if drawn == 6 {
                    let broader: f32 = (0..4).map(|v| width(&of(v, shoots)) / width(&of(v, 0))).sum();
                    assert!(broader > 5.0, "{arrangement:?}: {broader}");
                }
                if shoots == 0 {
                    assert_eq!(width(&straight), width(&branched));
                }
            }
        }
    }

    #[test]
    fn side_shoots_begin_on_the_twig() {
        let look = LeafLook::new(super::super::Outline::Ovate);
        let twig_look = TwigLook { leaves: 40, shoots: 6, ..TwigLook::default() };
        let figure = twig(&look, &twig_look, 0, Key::new(3));
        let feet: Vec<Vec2> =
            figure.pieces.iter().filter(|p| p.skin.mottle == 0.3).map(|p| p.frame.translation).collect();
        let main = figure.pieces.iter().find(|p| p.skin.mottle == 0.3 && p.frame.translation == Vec2::ZERO);
        let side = main.expect("the twig").outline.clone();
        for foot in &feet {
            let near = side.iter().map(|p| p.distance(*foot)).fold(f32::INFINITY, f32::min);
            assert!(near < 0.02, "{foot} is {near} off");
        }
        assert!(feet.iter().filter(|foot| foot.y > 0.1).count() == 6, "{feet:?}");
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
