//! Flowers and fruit.

use glam::{Vec2, Vec3};

use super::LeafLook;
use super::blade::BladeLook;
use super::figure::{Figure, Piece, Skin, frame, heading};
use super::outline::{Margin, Outline, Veins};
use super::tint::Tint;
use linden_base::color::linear;
use linden_base::random::Key;

/// Rows of petals that hide what is in their middle.
const DOUBLE: u32 = 3;

/// A flower seen from above: petals, stamens around the style. The pedicel is what the leaf's petiole is.
pub(super) fn blossom(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let foot = look.petiole.clamp(0.0, 0.8);
    let radius = (1.0 - foot) / 2.0;
    let center = Vec2::new(0.0, foot + radius);
    let green = Skin { color: Vec3::from(linear([120, 146, 70])), ..tint.stalk(key) };
    let mut figure = Figure::default();
    if foot > 0.0 {
        figure.pieces.push(Piece::stroke(&[Vec2::ZERO, center * 0.5, center], [0.012, 0.012], green));
    }
    for row in 0..look.petal_rows {
        let key = if row == 0 { key } else { key.named("row").child(u64::from(row)) };
        petals(&mut figure, look, tint, (center, radius), row, key);
    }
    if look.petal_rows < DOUBLE {
        stamens(&mut figure, (center, radius), green, key);
    }
    figure
}

/// A row of petals, the outermost first. Inner ones are shorter, stand in the gaps of the row before, and less
/// regularly.
fn petals(
    figure: &mut Figure,
    look: &LeafLook,
    tint: &Tint,
    (center, radius): (Vec2, f32),
    row: u32,
    key: Key,
) {
    let inside = row as f32 / look.petal_rows.max(1) as f32;
    let petals = look.lobes.clamp(3, 40).saturating_sub(row).max(3);
    let petal_look = BladeLook {
        margin: Margin::Entire,
        veins: if look.veins == Veins::None { Veins::None } else { Veins::Parallel },
        tip: 0.3,
        ..BladeLook::of(look, Outline::Obovate)
    };
    let ragged = if row == 0 { 1.0 } else { 3.0 };
    let long = radius * (1.0 - 0.68 * inside);
    let turn = key.named("turn").between(0.0, 1.0) as f32;
    // Every second one first: neighbours overlap.
    let order = (0..petals).step_by(2).chain((1..petals).step_by(2));
    for petal in order {
        let key = key.named("petal").child(u64::from(petal));
        let angle = std::f32::consts::TAU * (petal as f32 + turn) / petals as f32
            + ragged * key.named("angle").between(-0.07, 0.07) as f32;
        let along =
            heading(angle) * long * key.named("long").between(1.0 - 0.06 * f64::from(ragged), 1.0) as f32;
        let mut skin = tint.blade(look, key);
        let light = key.named("light").between(0.93, 1.02) as f32;
        // Inner petals stand up: less light falls between them.
        let light = light * (1.0 - 0.14 * inside);
        (skin.color, skin.patch) = (skin.color * light, skin.color * light);
        // Blossoms are deeper in colour towards the claw; their veins hardly show.
        skin.foot = skin.color * Vec3::new(0.98, 0.72, 0.76);
        skin.foot_reach = 0.55;
        skin.vein = skin.color * Vec3::new(0.96, 0.84, 0.86);
        skin.vein_strength *= 0.5;
        skin.patch_share = 0.0;
        skin.mottle = 0.04;
        (skin.fold, skin.droop, skin.pillow) = (0.05, -0.5, 0.03);
        skin.shadow = 0.22;
        figure.pieces.push(
            petal_look.blade(key.named("blade")).piece(frame(center + along * 0.06, along * 0.94, 1.0), skin),
        );
    }
}

/// One petal, deep in colour towards its claw.
pub(super) fn petal(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let foot = look.petiole.clamp(0.0, 0.8);
    let mut figure = Figure::default();
    if foot > 0.0 {
        figure.pieces.push(Piece::stroke(
            &[Vec2::ZERO, Vec2::new(0.0, foot + 0.02)],
            [0.012, 0.012],
            tint.stalk(key),
        ));
    }
    let petal_look = BladeLook { margin: Margin::Entire, tip: 0.4, ..BladeLook::of(look, Outline::Obovate) };
    let mut skin = tint.blade(look, key);
    skin.foot = skin.color * Vec3::new(0.86, 0.5, 0.62);
    skin.foot_reach = 0.8;
    skin.vein = skin.color * Vec3::new(0.95, 0.82, 0.87);
    skin.vein_strength *= 0.6;
    skin.patch_share = 0.0;
    skin.mottle = 0.05;
    (skin.fold, skin.droop, skin.pillow) = (0.12, 0.2, 0.04);
    let frame = frame(Vec2::new(0.0, foot), Vec2::new(0.0, 1.0 - foot), 1.0);
    figure.pieces.push(petal_look.blade(key.named("blade")).piece(frame, skin));
    figure
}

fn stamens(figure: &mut Figure, (center, radius): (Vec2, f32), green: Skin, key: Key) {
    let filament = Skin { color: Vec3::from(linear([238, 232, 214])), shadow: 0.15, ..Skin::default() };
    let anther = |key: Key| Skin {
        color: Vec3::from(linear([214, 172, 66])) * key.between(0.8, 1.15) as f32,
        shadow: 0.2,
        ..Skin::default()
    };
    figure.pieces.push(Piece::ball(center, radius * 0.11, green));
    for stamen in 0..20_u64 {
        let key = key.named("stamen").child(stamen);
        let angle =
            std::f32::consts::TAU * (stamen as f32 + key.named("angle").between(-0.4, 0.4) as f32) / 20.0;
        let end = center + heading(angle) * radius * key.named("long").between(0.2, 0.42) as f32;
        figure.pieces.push(Piece::stroke(&[center, end], [radius * 0.008, radius * 0.008], filament));
        figure.pieces.push(Piece::ball(end, radius * 0.03, anther(key)));
    }
}

/// Where the picture of a blossom or of a round fruit has nothing: the middle of a spot in its lower left corner.
const CORNER: Vec2 = Vec2::new(-0.44, 0.06);
/// Half the spot's side.
const SPOT: f32 = 0.03;

/// Draws a spot of the colour of stalks where the picture of a member of a cluster has none.
pub(super) fn with_stalk_color(mut figure: Figure, look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    if matches!(look.outline, Outline::Blossom | Outline::Fruit) {
        // The stalks of flowers are green, whatever the flower.
        let color = Vec3::from(linear([116, 136, 66]));
        let skin = Skin { color, patch: color, ..tint.stalk(key) };
        let ends = [CORNER - Vec2::new(0.0, SPOT), CORNER, CORNER + Vec2::new(0.0, SPOT)];
        figure.pieces.push(Piece::stroke(&ends, [SPOT, SPOT], skin));
        figure.stalk = Some(CORNER);
    }
    figure
}

/// Round fruit that hang side by side from one place.
pub(super) fn fruit(look: &LeafLook, tint: &Tint, key: Key) -> Figure {
    let count = look.lobes.clamp(1, 12);
    let stalk = look.petiole.clamp(0.05, 0.9);
    let radius = (1.0 - stalk) / 2.0;
    let mut figure = Figure::default();
    let green = Skin { color: Vec3::from(linear([128, 132, 66])), ..tint.stalk(key) };
    for fruit in 0..count {
        let key = key.named("fruit").child(u64::from(fruit));
        let side = if count > 1 { fruit as f32 / (count as f32 - 1.0) - 0.5 } else { 0.0 };
        let spread = (count as f32 - 1.0) * 1.9 * radius;
        let size = radius * key.named("size").between(0.88, 1.0) as f32;
        let center = Vec2::new(
            side * spread,
            stalk + radius - 0.12 * side.abs() + key.named("low").between(-0.05, 0.0) as f32,
        );
        // The stalk bows outwards and comes from above.
        let top = center - Vec2::new(0.0, size * 0.86);
        let bow = Vec2::new(top.x * 0.9, top.y * 0.45);
        let stalk: Vec<Vec2> =
            (0..=12).map(|i| i as f32 / 12.0).map(|t| bow * (2.0 * t * (1.0 - t)) + top * (t * t)).collect();
        figure.pieces.push(Piece::stroke(&stalk, [0.012, 0.010], green));
        let color = tint.blade * key.named("light").between(0.8, 1.15) as f32;
        // One cheek has seen more sun.
        let skin = Skin {
            color,
            patch: color * Vec3::new(1.25, 0.8, 0.75),
            patch_share: 0.45,
            foot: color * 0.55,
            foot_reach: 0.16,
            mottle: 0.12,
            shadow: 0.35,
            place: Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32),
            ..Skin::default()
        };
        figure.pieces.push(Piece::ball(center, size * look.width.clamp(0.2, 1.0), skin));
    }
    figure
}
