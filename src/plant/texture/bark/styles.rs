//! The styles: height and tint at a place, from the noises there.

use glam::Vec3;

use super::surface::{Noises, Spot, Surface};
use crate::texture::periodic::smoothstep;

/// Yellow-green grey, relative to grey bark: crustose lichen.
const LICHEN: Vec3 = Vec3::new(1.12, 1.25, 0.98);

impl Surface {
    /// Interlaced ridges of corky layers with furrows between them, cracked across.
    pub(super) fn ridged(&self, u: f32, v: f32, noises: Noises) -> Spot {
        const LAYERS: f32 = 3.0;
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let fibre = self.fibres.at(u + 0.012 * sway, v);
        // The furrows' edges are ragged: the grain bends them, and fibres stick out of them.
        let (bu, bv) = (u + 0.025 * sway + 0.012 * grain, v + 0.07 * lift + 0.01 * fibre);
        let [a, b] = [0, 1].map(|i| self.folds[i].at(bu, bv).abs());
        let away = a.min(b) + 0.045 * grain + 0.04 * fibre;
        // Furrows gape in some places and are closed in others; ridges are round above them.
        let gape = 0.05 + 0.06 * smoothstep(-0.35, 0.35, blotch + 0.6 * lift);
        let wall = smoothstep(0.25 * gape, gape, away);
        let crown = smoothstep(gape, gape + 0.26, away);
        // Short cracks run across the ridges; most end before the furrow.
        let strength = smoothstep(-0.25, 0.35, lift - blotch + 0.35 * fibre);
        let crack = if strength > 0.0 && wall > 0.2 {
            let crack = self.cracks.at(bu + 0.014 * grain, v + 0.05 * sway + 0.014 * grain);
            strength * wall * (1.0 - smoothstep(0.0, 0.009, crack.border + 0.008 * grain + 0.003 * fibre))
        } else {
            0.0
        };
        // What stands out is worn down to lower layers in places, along ragged edges.
        let stack = (0.62 * crown + 0.42 * flake + 0.16 * grain + 0.10 * fibre + 0.35) * LAYERS;
        let level = (stack.floor() / LAYERS).clamp(0.0, 1.0);
        let torn = stack - stack.floor();
        let step = smoothstep(0.0, 0.22, torn);
        let rough = self.roughness * (0.17 * grain + 0.16 * fibre);
        let height = wall * (0.34 + 0.22 * crown + 0.34 * (level - 0.12 * (1.0 - step))) - 0.20 * crack
            + rough * (0.25 + 0.75 * wall);
        // Light does not reach the bottom; the wall below a ridge's edge is in half shade.
        let dark = 0.10 + 0.90 * smoothstep(-0.02, 0.62, height) * (0.45 + 0.55 * wall);
        // Furrows show the inner bark: redder. Fresh edges are warm, what stood long is grey.
        let inner = Vec3::new(1.24, 0.96, 0.76).lerp(Vec3::ONE, smoothstep(0.05, 0.55, height));
        let age = (0.75 * level + 0.5 * blotch + 0.3).clamp(0.0, 1.0);
        let weathered = Vec3::new(1.10, 0.99, 0.88).lerp(Vec3::new(0.98, 1.0, 1.03), age);
        let rim = (1.0 - smoothstep(0.06, 0.22, torn)) - 0.5 * smoothstep(0.82, 1.0, torn);
        let light = 0.86 + 0.22 * level + 1.5 * rough - 0.10 * rim * wall - 0.30 * crack + 0.10 * blotch;
        let tint = weathered * inner * dark * light.max(0.05);
        let lichen = 0.45 * smoothstep(0.10, 0.40, blotch + 0.3 * grain) * smoothstep(0.55, 0.9, height);
        Spot { height, tint: tint.lerp(LICHEN * tint.max_element(), lichen) }
    }

    /// Thick plates of many thin scales.
    pub(super) fn plated(&self, u: f32, v: f32, noises: Noises) -> Spot {
        const LAYERS: f32 = 4.0;
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.08 * sway + 0.022 * grain, v + 0.09 * lift + 0.022 * grain);
        let plate = self.cells.at(bu, bv);
        let character = self.character[0][plate.index];
        // Fissures gape in some places and are closed in others.
        let gape = smoothstep(-0.45, 0.35, blotch + 0.5 * lift);
        let body =
            smoothstep(0.1, 1.0, (plate.border + 0.012 * (flake + 0.5 * grain)) / (0.007 + 0.030 * gape));
        // A plate is a stack of thin scales, torn off along lines of equal height as on a map.
        let stack = (flake * 1.5 + 0.5 + 0.30 * grain + 0.25 * (character - 0.5)) * LAYERS;
        let layer = stack.floor();
        let torn = stack - layer;
        let level = (layer / LAYERS).clamp(0.0, 1.0);
        let step = smoothstep(0.0, 0.16, torn);
        let rough = self.roughness * (0.10 * grain + 0.05 * self.fibres.at(u + 0.05 * lift, bv));
        // Plates bulge towards their middle.
        let bulge = 0.20 * (plate.border / 0.10).min(1.0);
        let height =
            body * (0.34 + bulge + 0.34 * (level - 0.14 * (1.0 - step))) + rough * (0.3 + 0.7 * body);
        let dark = 0.12 + 0.88 * smoothstep(0.0, 0.42, height) * (0.55 + 0.45 * body);
        // Freshly torn scales are orange, old ones grey with a breath of violet.
        let (fresh, old) = (Vec3::new(1.34, 0.95, 0.66), Vec3::new(0.96, 0.99, 1.05));
        let age = (0.9 * level + 0.7 * blotch + 0.5 * (character - 0.5) + 0.12).clamp(0.0, 1.0);
        // The edge of a scale catches light, what is under it lies in its shade.
        let rim = (1.0 - smoothstep(0.05, 0.16, torn)) - 0.45 * smoothstep(0.86, 1.0, torn);
        let tint =
            fresh.lerp(old, age) * dark * (0.90 + 0.16 * character + 1.3 * rough - 0.10 * rim + 0.22 * level);
        let lichen = 0.22 * smoothstep(0.15, 0.45, sway - blotch) * smoothstep(0.5, 0.9, height);
        Spot { height, tint: tint.lerp(LICHEN * tint.max_element(), lichen) }
    }

    /// Thin and whole: wrinkles and lenticels across, lichen in crusts.
    pub(super) fn smooth(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.03 * sway, v + 0.02 * lift);
        // Lenticels: corky lips across the branch, on some of the places.
        let place = self.cells.at(bu, bv);
        let character = self.character[0][place.index];
        let wide = 0.14 + 0.24 * character;
        let [x, y] = [place.offset[0] / wide, place.offset[1] / (0.10 + 0.08 * character)];
        let inside = (1.0 - x * x - y * y).max(0.0);
        let is_lenticel = character > 0.72;
        let lenticel = if is_lenticel { inside } else { 0.0 };
        let wrinkle = self.fibres.at(bu, bv + 0.012 * sway);
        let wrinkles = smoothstep(0.15, 0.95, wrinkle.abs()) * (0.55 + 0.45 * lift);
        let grain = self.roughness * 0.08 * grain;
        let height = 0.5 + 0.30 * sway + 0.30 * lenticel - 0.22 * wrinkles + grain;
        let slit = if is_lenticel && inside > 0.5 { 1.0 - (y * y / 0.12).min(1.0) } else { 0.0 };
        // Pale crusts with a rim, darker ones, green algae without an edge.
        let pale =
            smoothstep(0.10, 0.14, blotch) * (0.16 + 0.10 * smoothstep(0.20, 0.26, blotch + 0.2 * grain));
        let rim = smoothstep(0.07, 0.11, blotch) - smoothstep(0.11, 0.16, blotch);
        let dark = 0.13 * smoothstep(0.16, 0.22, flake);
        let algae = 0.34 * smoothstep(-0.05, 0.45, lift - blotch);
        let light =
            0.92 + pale - 0.07 * rim - dark + 0.14 * sway - 0.16 * wrinkles - 0.16 * lenticel - 0.30 * slit
                + 1.5 * grain;
        let tint = Vec3::splat(light).lerp(Vec3::new(0.90, 1.03, 0.76) * light, algae);
        Spot { height, tint }
    }

    /// White skin that rolls off across the branch, with lenticels and scars.
    pub(super) fn birch(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.02 * sway, v + 0.025 * lift);
        // Lenticels: dark lines across, from dots to a quarter of the girth.
        let place = self.cells.at(bu, bv);
        let character = self.character[0][place.index];
        let wide = 0.05 + 0.46 * character * character;
        let [x, y] = [place.offset[0] / wide, (place.offset[1] + 0.05 * grain) / (0.10 + 0.10 * character)];
        let inside = if character > 0.25 { (1.0 - x * x - y * y).max(0.0) } else { 0.0 };
        let line = smoothstep(0.0, 0.35, inside);
        // Scars of shed branches: black lozenges with wings that hang down on both sides.
        let scar_place = self.cracks.at(u + 0.02 * grain, v + 0.008 * grain);
        let kind = self.character[1][scar_place.index];
        let [sx, sy] =
            [scar_place.offset[0] / (0.16 + 0.16 * kind), scar_place.offset[1] / (0.07 + 0.05 * kind)];
        let winged = sy + (0.7 + 1.2 * kind) * sx.abs() + 1.1 * grain;
        let scar = if kind > 0.45 {
            let body = 1.0 - smoothstep(0.6, 1.0, sx.abs() * (1.2 - 0.4 * kind) + winged.abs());
            let cleft = 1.0
                - smoothstep(
                    0.5,
                    1.0,
                    sx * sx * (9.0 - 6.0 * kind) + (sy - 0.5) * (sy - 0.5) * 1.4 - 1.2 * grain,
                );
            body.max(cleft)
        } else {
            0.0
        };
        // The skin comes off in sheets whose edges run across; young skin under it is tan.
        let sheet = (flake * 3.2 + 0.6 * lift + 0.12 * grain) * 1.6;
        let torn = sheet - sheet.floor();
        let curl = 1.0 - smoothstep(0.0, 0.10, torn);
        let under = smoothstep(0.80, 0.97, torn) * smoothstep(0.05, 0.3, blotch + 0.2);
        let fibre = self.fibres.at(bu, bv);
        let rough = self.roughness * (0.06 * grain + 0.05 * fibre);
        let height =
            0.55 + 0.16 * sway + 0.18 * curl - 0.14 * under - 0.28 * line - 0.35 * scar * (1.0 + grain)
                + rough * (1.0 + 3.0 * scar);
        // Grey shades run down from scars; the rest is chalk with bands of rose and cream.
        let band = 0.5 + 0.5 * fibre;
        let mut tint = Vec3::new(1.0, 0.985, 0.955)
            .lerp(Vec3::new(0.985, 0.94, 0.88), 0.35 * band + 0.25 * blotch)
            * (1.02 + 0.10 * sway + 1.1 * rough - 0.10 * smoothstep(0.0, 0.5, -blotch));
        tint = tint.lerp(Vec3::new(0.80, 0.62, 0.47), 0.75 * under);
        tint *= 1.0 + 0.06 * curl;
        tint = tint.lerp(Vec3::new(0.17, 0.145, 0.125), 0.88 * line);
        tint = tint.lerp(Vec3::new(0.075, 0.068, 0.064) * (1.0 + 2.0 * rough), scar.min(1.0));
        Spot { height, tint }
    }

    /// Layers of thin plates, fallen in different years.
    pub(super) fn peeling(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.045 * sway + 0.004 * grain, v + 0.05 * lift + 0.004 * grain);
        // From the youngest, cream, to the oldest, grey-brown; each covers what its own noise says.
        let layers = [
            (flake * 1.3 + 0.10, Vec3::new(1.10, 1.12, 0.84)),
            (self.folds[0].at(bu, bv) + 0.3 * blotch, Vec3::new(0.80, 0.83, 0.60)),
            (self.folds[1].at(bu + 0.3, bv + 0.6) - 0.20 + 0.25 * lift, Vec3::new(0.60, 0.54, 0.46)),
            (self.folds[1].at(bu + 0.77, bv + 0.21) - 0.40, Vec3::new(0.40, 0.37, 0.34)),
        ];
        let rough = self.roughness * (0.05 * grain + 0.03 * self.fibres.at(bu, bv));
        let mut height = 0.30 + 0.12 * sway;
        let mut tint = Vec3::new(1.40, 1.36, 1.08);
        for (i, (covers, color)) in layers.into_iter().enumerate() {
            let covers = covers + 0.03 * grain;
            let sheet = smoothstep(0.0, 0.022, covers);
            // Old plates are rough, and shade what they end above.
            let sheet_tint = color * (1.0 + 0.10 * i as f32 * grain + 0.10 * blotch);
            let shade = 1.0 - 0.30 * smoothstep(-0.07, 0.0, covers) * (1.0 - sheet);
            tint = (tint * shade).lerp(sheet_tint, sheet);
            // What lies under a plate does not show through.
            height += (0.30 + 0.15 * (i + 1) as f32 + 0.10 * sway - height) * sheet;
        }
        // Dots of cork.
        let height = height + rough;
        Spot { height, tint: tint * (1.0 + 1.4 * rough) }
    }

    /// Skin that dries and is shed in long ribbons, down to the pale young one.
    pub(super) fn ribbon(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.035 * sway + 0.003 * grain, v + 0.05 * lift);
        let fibre = self.fibres.at(bu, bv);
        // From the youngest to the oldest: each covers strips that run far up, and ends in long points.
        let layers = [
            (self.folds[0].at(bu, bv) + 0.5 * blotch + 0.06, Vec3::new(0.96, 0.93, 0.84)),
            (self.folds[1].at(bu + 0.31, bv + 0.62) + 0.45 * lift - 0.12, Vec3::new(0.78, 0.80, 0.78)),
            (self.folds[1].at(bu + 0.77, bv + 0.21) + 0.6 * flake - 0.42, Vec3::new(0.66, 0.50, 0.37)),
        ];
        let rough = self.roughness * (0.03 * grain + 0.05 * fibre);
        let mut height = 0.30 + 0.10 * sway;
        let mut tint =
            Vec3::new(1.12, 1.08, 0.96).lerp(Vec3::new(0.98, 1.05, 0.90), smoothstep(0.0, 0.4, lift));
        for (i, (covers, color)) in layers.into_iter().enumerate() {
            let covers = covers + 0.02 * fibre + 0.015 * grain;
            let sheet = smoothstep(0.0, 0.02, covers);
            // The edge curls up, and shades what it leaves.
            let curl = smoothstep(0.0, 0.02, covers) * (1.0 - smoothstep(0.02, 0.09, covers));
            let shade = 1.0 - 0.28 * smoothstep(-0.08, 0.0, covers) * (1.0 - sheet);
            let color = color * (1.0 + 0.10 * blotch + 0.10 * curl);
            tint = (tint * shade).lerp(color, sheet);
            height += (0.34 + 0.14 * (i + 1) as f32 + 0.16 * curl + 0.08 * sway - height) * sheet;
        }
        Spot { height: height + rough, tint: tint * (1.0 + 1.3 * rough + 0.05 * fibre) }
    }

    /// The stem of a grass: smooth, with fine lines along it and a bloom in clouds.
    pub(super) fn culm(&self, u: f32, v: f32, noises: Noises) -> Spot {
        let Noises { sway, grain, blotch, flake, .. } = noises;
        let line = self.fibres.at(u + 0.004 * sway, v);
        let rough = self.roughness * (0.012 * grain + 0.03 * line);
        let bloom = 0.10 * smoothstep(0.0, 0.5, blotch + 0.3 * flake);
        // Yellower where the sun was, and some specks.
        let sun = smoothstep(-0.3, 0.4, sway);
        let speck = 0.10 * smoothstep(0.1, 0.6, flake + 0.4 * grain);
        let tint = Vec3::new(0.94, 1.0, 0.96).lerp(Vec3::new(1.10, 1.03, 0.84), 0.6 * sun);
        let tint = tint.lerp(Vec3::new(1.12, 1.14, 1.22), bloom) * (1.0 + 1.4 * rough - speck);
        Spot { height: 0.5 + 0.2 * sway + rough, tint }
    }

    /// Bases of leaves that were cut off or fell: lozenges in a spiral, each of which stands out towards its upper end, where it
    /// broke, and hides the foot of those above.
    pub(super) fn palm(&self, u: f32, v: f32, noises: Noises) -> Spot {
        /// Round the picture, and how many rows there are up it; an even number.
        const ACROSS: f32 = 3.0;
        const ROWS: f32 = 12.0;
        let Noises { sway, lift, grain, blotch, flake } = noises;
        let (bu, bv) = (u + 0.030 * sway + 0.006 * grain, v + 0.018 * lift + 0.004 * grain);
        // Both families of lines between lozenges are those where one of these is whole.
        let (right, left) = (ACROSS * bu + 0.5 * ROWS * bv, ACROSS * bu - 0.5 * ROWS * bv);
        let (a, b) = (right - right.floor(), left - left.floor());
        let (row, place) = ((right.floor() - left.floor()) as i32, (right.floor() + left.floor()) as i32);
        let (row, column) =
            (row.rem_euclid(ROWS as i32), (place - (row & 1)).div_euclid(2).rem_euclid(ACROSS as i32));
        let character = self.character[0][(row * ACROSS as i32 + column) as usize % self.character[0].len()];
        // -1 the lower corner, 1 the upper one; the sides likewise. How far off the edges above and below.
        let (rise, side) = (a - b, a + b - 1.0);
        let (upper, lower) = ((1.0 - a).min(b), a.min(1.0 - b));
        let edge = 0.03 + 0.04 * flake.max(0.0);
        let body = smoothstep(0.0, edge, upper + 0.02 * grain);
        // The broken end: a lip across, ragged, with the ends of fibres in it.
        let ragged = rise + 0.22 * side * side + 0.16 * flake + 0.10 * grain + 0.25 * (character - 0.5);
        let broken = smoothstep(0.28, 0.42, ragged) * (1.0 - 0.7 * smoothstep(0.75, 1.0, side.abs()));
        let fibre = self.fibres.at(bu + 0.01 * sway, bv);
        let rough = self.roughness * (0.08 * fibre + 0.09 * grain);
        let keel = 0.12 * (1.0 - side * side);
        let slope = 0.14 + 0.48 * smoothstep(0.0, 0.6, lower) + keel + 0.16 * (character - 0.5);
        let height = body * (slope + 0.06 * broken * (1.0 + fibre)) + rough * (0.3 + 0.7 * body);
        // Its foot lies in the shade of the ends below.
        let shade = 0.30 + 0.70 * smoothstep(-0.02, 0.24, lower + 0.05 * grain);
        let dark = 0.12 + 0.88 * smoothstep(0.02, 0.36, height) * shade;
        let weathered = Vec3::new(1.0, 0.99, 0.97).lerp(Vec3::new(1.06, 1.08, 1.10), 0.5 + 0.5 * blotch);
        let torn = Vec3::new(1.34, 1.12, 0.84) * (0.95 + 0.30 * fibre);
        let tint = weathered.lerp(torn, 0.60 * broken) * dark * (0.90 + 0.2 * character + 1.3 * rough);
        Spot { height, tint }
    }
}
